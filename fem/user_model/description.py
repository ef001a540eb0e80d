"""The TOML text that says what bare numbers mean: units, support, names, what is known of the mass.

It stands in a file of its own or, in HDF5 and npz, in the data file itself (attribute or array ``description``).
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from fem.structure import Sparse
from fem.user_model import parts
from fem.user_model.units import UnitSystem, unit_system
from geometry import toml_file
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.frames import Array, Integers
from geometry.inertia import Inertia, judge, parallel_axis, six_from_tensor
from geometry.toml_file import quantity, require_known, require_present

TABLE = "fe_model"
"""The table by which a TOML file is recognised as the description of a model."""

KINDS = ("matrices", "modal")
_TOP = ("format", TABLE, "stated")
MODEL_FILE = "model"
"""Table by which a description is known to stand in a model file."""
_DATA_KEYS = ("name", "kind", "units", "reference_point", "file", "grids", "interface", "matrices", "loss_factor", "sha256")
_KEYS = (*_DATA_KEYS, *parts.KEYS)
"""Where they are looked for when it is not set."""

MATRICES = ("stiffness", "mass", "viscous", "structural")
PART_MATRICES = ("stiffness", "mass", "membrane", "bending", "geometric")
"""What a part may have of its own, as ``stiffness/NAME`` and so on."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Stated:
    """What the user knows of the whole structure from elsewhere, to hold the matrices against.

    Attributes
    ----------
    mass : [kg], None when not stated
    mass_tolerance : [kg], zero when none was stated
    cog : (3,) [m] in the model's frame, None when not stated
    frequencies : (m, 2) [Hz] eigenfrequencies as another program gives them, ascending, each with its tolerance (zero where
        none was stated)
    """

    mass: float | None = None
    mass_tolerance: float = 0.0
    cog: Array | None = None
    frequencies: Array = field(default_factory=lambda: np.zeros((0, 2)))


@dataclass(frozen=True, eq=False, kw_only=True)
class Description:
    """The content of a description.

    Attributes
    ----------
    source : where the text stands
    name : of the model
    kind : one of `KINDS`
    units : of every number in the data
    reference_point : (3,) [m], in the model's frame
    named : how it is held, and its parts, places, supports and joints
    file, grids : the data, and where a Nastran model has its grid points; None where not named
    interface : identifiers of the nodes that the base carries; empty where the data say it otherwise
    matrices : the names in a Nastran file of what we call stiffness, mass, viscous and structural, stiffness/NAME of a part ...
    loss_factor : of the whole structure, None when not given
    sha256 : of the data file, empty when not given
    stated : what is known from elsewhere
    """

    source: str
    name: str
    kind: str
    units: UnitSystem
    reference_point: Array
    named: parts.Named = field(default_factory=parts.Named)
    file: Path | None = None
    grids: Path | None = None
    interface: tuple[int, ...] = ()
    matrices: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    loss_factor: float | None = None
    sha256: str = ""
    stated: Stated = field(default_factory=Stated)


def read_description(path: Path) -> Description:
    """The description in the file `path`."""
    return parse(toml_file.read(path), str(path), path)


def parse(table: Mapping[str, Any], source: str, path: Path) -> Description:
    """The description in `table`; other files lie in the folder of `path` or below, or in that of `geometry.toml_file.DATA`.

    Raises
    ------
    BadInput : an unknown or missing key, a wrong type, unit or dimension, a file that is not there or elsewhere.
    """
    if MODEL_FILE not in table:  # the file of a model, whose own tables say more
        toml_file.require_known(table, _TOP, source=source)
    toml_file.require_format(table, source)
    toml_file.require_present(table, (TABLE,), source=source)
    model = toml_file.require_table(table[TABLE], source=source, where=TABLE)
    toml_file.require_known(model, _KEYS, source=source, where=TABLE)
    toml_file.require_present(model, ("kind", "units"), source=source, where=TABLE)
    kind = toml_file.one_of(model["kind"], KINDS, source=source, where=f"{TABLE}.kind")
    units = unit_system(model["units"], source)
    named = parts.named(model, units, source, TABLE)
    if named.support == "base" and "reference_point" not in model:  # else the origin will do
        problem, remedy = "is missing: a base moves about a point", 'Add it, or state support = "ground" or "free"'
        raise BadInput(source, f"{TABLE}.reference_point", problem, remedy)
    _require_support(model, named, kind, units, source)
    value, where = model.get("interface", []), f"{TABLE}.interface"
    if not isinstance(value, list) or not all(toml_file.is_whole(node) for node in value):
        raise toml_file.wrong(value, "a list of node numbers", source, where, "Write it like [1, 2, 3]")
    twice = next((node for node in value if value.count(node) > 1), None)
    if twice is not None:
        raise BadInput(source, where, f"names node {twice} {value.count(twice)} times", "Name every interface node once")
    matrix_names = toml_file.require_table(model.get("matrices", {}), source=source, where=f"{TABLE}.matrices")
    for key, name in matrix_names.items():
        what, of_part, _ = key.partition("/")
        known = PART_MATRICES if of_part else MATRICES
        toml_file.require_known({what: name}, known, source=source, where=f"{TABLE}.matrices")
        if not isinstance(name, str) or not name.isidentifier():
            remedy = 'Write it like { stiffness = "kaa" }'
            raise toml_file.wrong(name, "the name of a matrix", source, f"{TABLE}.matrices.{key}", remedy)
    return Description(
        source=source,
        name=_text(model, "name", source) or path.stem,
        kind=kind,
        units=units,
        reference_point=parts.point(model["reference_point"], units, source, f"{TABLE}.reference_point")
        if "reference_point" in model
        else np.zeros(3),
        named=named,
        file=file_of(model, "file", source, path),
        grids=file_of(model, "grids", source, path),
        interface=tuple(value),
        matrices={key: name.lower() for key, name in matrix_names.items()},
        loss_factor=parts.loss_factor(model, source, TABLE),
        sha256=(_text(model, "sha256", source) or "").strip().lower(),
        stated=_stated(table.get("stated", {}), units, source),
    )


def _require_support(model: Mapping[str, Any], named: parts.Named, kind: str, units: UnitSystem, source: str) -> None:
    """Refuse keys that contradict how the structure is held, and what modal data cannot have."""
    if kind == "modal" and (key := next((key for key in parts.KEYS if model.get(key)), None)):
        problem = "belongs to a structure, not to modal data, whose base is the reference point"
        raise BadInput(source, f"{TABLE}.{key}", problem, "Leave it out, or bring matrices")
    if not units.known and (kind == "modal" or named.support == "base"):
        problem = "leaves open what a kilogram is, and a base that moves is about masses in kilograms"
        raise BadInput(source, f"{TABLE}.units", problem, "Name the system, mm-t-N-s for example")
    if named.support != "base" and model.get("interface"):
        problem = f'names nodes that a base carries, and support is "{named.support}"'
        raise BadInput(source, f"{TABLE}.interface", problem, "Leave one of the two out")
    to_ground = [f"joints.{name}" for name, joint in named.joints.items() if parts.GROUND in joint.between]
    if named.support != "ground" and (named.supports or to_ground):
        where = "supports" if named.supports else to_ground[0]
        remedy = 'Write support = "ground"; what holds a base-driven structure is its interface'
        raise BadInput(source, f"{TABLE}.{where}", f'ties it to the ground, and support is "{named.support}"', remedy)


def _text(table: Mapping[str, Any], key: str, source: str) -> str | None:
    found = table.get(key)
    if found is not None and (not isinstance(found, str) or not found.strip() or "\0" in found):
        raise toml_file.wrong(found, "text", source, f"{TABLE}.{key}", "Write it in quotes")
    return found


def file_of(table: Mapping[str, Any], key: str, source: str, path: Path) -> Path | None:
    """The file that `table`, part of the description in `path`, names by `key`; None where it names none.

    Raises
    ------
    BadInput : no text, no such file, one outside of the folder of `path` and of that of `geometry.toml_file.DATA`.
    """
    name = _text(table, key, source)
    if name is None:
        return None
    return toml_file.named_file(name, path.parent, source, f"{TABLE}.{key}")


def _stated(value: Any, units: UnitSystem, source: str) -> Stated:
    table = toml_file.require_table(value, source=source, where="stated")
    toml_file.require_known(table, ("mass", "cog", "frequencies"), source=source, where="stated")
    if {"mass", "cog"} & table.keys() and not units.known:
        problem = "cannot be compared with matrices whose units are not known"
        raise BadInput(source, "stated", problem, "Name their system in fe_model.units")
    cog = parts.point(table["cog"], units, source, "stated.cog") if "cog" in table else None
    where, listed = "stated.frequencies", table.get("frequencies", [])
    if not isinstance(listed, list):
        remedy = 'Write it like ["118.2 Hz", "227 +/- 1 Hz"]'
        raise toml_file.wrong(listed, "a list of frequencies with their unit", source, where, remedy)
    each = [quantity(one, "frequency", source=source, field=where) for one in listed]
    frequencies = np.array(sorted((one.nominal_value, one.std_dev) for one in each), dtype=np.float64).reshape(-1, 2)
    if np.any(frequencies[:, 0] <= 0):
        remedy = "Leave out the rigid motions of a free structure, which are at 0 Hz"
        raise toml_file.wrong(listed, "positive", source, where, remedy)
    if "mass" not in table:
        return Stated(cog=cog, frequencies=frequencies)
    mass = quantity(table["mass"], "mass", source=source, field="stated.mass")
    if mass.nominal_value <= 0:
        raise toml_file.wrong(table["mass"], "positive", source, "stated.mass", "Give the mass of the whole structure")
    return Stated(mass=float(mass.nominal_value), mass_tolerance=float(mass.std_dev), cog=cog, frequencies=frequencies)


# What a user's file holds, as arrays by name, and the judge of every one: there, numbers, finite, real, of the right shape.

LARGEST_BYTES = 4 * 2**30
"""What the arrays of one file may take in memory; it is compared with what the file declares before anything is read."""

LARGEST_SIDE = 300_000
"""Rows of a matrix: K and M are factorised to be judged, and a solid of this size fills gigabytes. Larger models come reduced."""

LARGEST = 1e60
"""Products of three numbers of this size are still far from overflow."""

TOO_LARGE = "Reduce the model (Craig-Bampton), or write K and M as sparse matrices"
"""What to do about more."""

SPARSE = ("data", "indices", "indptr", "shape")
"""A sparse matrix `name` is four arrays name/data, name/indices ...: SciPy's CSR or, the same for a symmetric one, CSC."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Contents:
    """The arrays of one file.

    Attributes
    ----------
    source : the file, for messages
    arrays : by name, in the user's units; matrices may be SciPy's sparse ones
    description : TOML text that the file carries itself, if it does
    """

    source: str
    arrays: Mapping[str, Any] = field(default_factory=dict)
    description: str | None = None

    def __contains__(self, name: str) -> bool:
        return name in self.arrays or f"{name}/data" in self.arrays

    def require(self, needed: Collection[str], optional: Collection[str]) -> None:
        """Refuse a file that lacks an array of `needed`, with the nearest name, or holds one that nobody reads."""
        there = {name.partition("/")[0]: None for name in self.arrays}
        require_present(there, needed, source=self.source)
        require_known(there, (*needed, *optional), source=self.source)

    def shares(self, matrix: str) -> tuple[str, ...]:
        """Names of the parts that `matrix` is given by, arrays matrix/part or matrix/part/data ..., in the order of the file."""
        below = [name.removeprefix(f"{matrix}/").split("/") for name in self.arrays if name.startswith(f"{matrix}/")]
        whole = f"{matrix}/data" in self.arrays
        return tuple(dict.fromkeys(words[0] for words in below if not (whole and len(words) == 1 and words[0] in SPARSE)))

    def numbers(self, name: str, shape: tuple[int, ...]) -> Array:
        """The array `name`, real and finite, of `shape`; -1 there stands for any length.

        Raises
        ------
        BadInput : no numbers, complex, NaN or infinite (how many, the first), or of another shape.
        """
        require_present(self.arrays, (name,), source=self.source)
        array = np.asarray(self.arrays[name])
        self._require_real(name, array)
        if len(array.shape) != len(shape) or any(want not in (-1, found) for want, found in zip(shape, array.shape, strict=True)):
            wanted = " x ".join("n" if want == -1 else str(want) for want in shape)
            found = " x ".join(map(str, array.shape)) or "one number"
            raise self.refused(name, f"must be {wanted}, found {found}", "Check which way round it was written, and every size")
        self._require_finite(name, array)
        return array.astype(np.float64)

    def whole(self, name: str, shape: tuple[int, ...]) -> Integers:
        """The array `name` of whole numbers, of `shape`."""
        array = self.numbers(name, shape)
        if np.any(array != np.round(array)) or np.any(np.abs(array) > 2**52):
            raise self.refused(name, "must hold whole numbers", "Write it as integers")
        return array.astype(np.intp)

    def matrix(self, name: str, shape: tuple[int, int] | None = None) -> Sparse:
        """The matrix `name`, dense or sparse in the file, as a sparse one: square, or of `shape`.

        Raises
        ------
        BadInput : missing, not square, no numbers, complex, not finite, indices that do not fit.
        """
        from scipy.sparse import csr_array, issparse

        if name not in self.arrays and f"{name}/data" in self.arrays:
            found = self._compressed(name, shape)
        else:
            require_present(self.arrays, (name,), source=self.source)
            raw = self.arrays[name]
            self._require_shape(name, np.shape(raw), shape)
            if issparse(raw):
                self._require_real(name, raw.data)
                self._require_finite(name, raw.data)
                found = csr_array(raw)
            else:
                found = csr_array(self.numbers(name, (-1, -1)))
        return found

    def refused(self, name: str, problem: str, remedy: str) -> BadInput:
        """The refusal of the array `name`."""
        return BadInput(self.source, name, problem, remedy)

    def _compressed(self, name: str, wanted: tuple[int, int] | None) -> Sparse:
        from scipy.sparse import csr_array

        data = self.numbers(f"{name}/data", (-1,))
        indices, indptr = (self.whole(f"{name}/{part}", (-1,)) for part in ("indices", "indptr"))
        shape = tuple(int(side) for side in self.whole(f"{name}/shape", (2,)))
        self._require_shape(f"{name}/shape", shape, wanted)
        try:
            found = csr_array((data, indices, indptr), shape=shape)
            found.check_format(full_check=True)
        except ValueError as error:
            problem = f"its indices do not fit together: {error}"
            raise self.refused(name, problem, "Write data, indices, indptr and shape of one CSR matrix") from None
        found.sum_duplicates()
        return found

    def _require_shape(self, name: str, shape: tuple[int, ...], wanted: tuple[int, int] | None) -> None:
        if wanted is not None and shape != wanted:
            found = " x ".join(map(str, shape)) or "one number"
            problem = f"must be {wanted[0]} x {wanted[1]}, found {found}"
            raise self.refused(name, problem, "Write a column for every degree of freedom")
        if wanted is None and (len(shape) != 2 or shape[0] != shape[1] or not 0 < shape[0] <= LARGEST_SIDE):
            found = " x ".join(map(str, shape)) or "one number"
            remedy = "Write the whole matrix, both triangles; reduce a larger model to Craig-Bampton coordinates"
            raise self.refused(name, f"must be square with 1 to {LARGEST_SIDE} rows, found {found}", remedy)

    def _require_real(self, name: str, array: Any) -> None:
        if np.iscomplexobj(array):
            worst = float(np.abs(np.imag(array)).max(initial=0.0))
            problem = f"is complex, its imaginary part reaches {worst:.6g}"
            remedy = "Give K, M and the damping as real matrices: what multiplies i in K is `structural`, C is `viscous`"
            raise self.refused(name, problem, remedy)
        if array.dtype.kind not in "fiu":
            raise self.refused(name, f"must hold numbers, found the type {array.dtype}", "Write it as 64-bit floating point")

    def _require_finite(self, name: str, array: Any) -> None:
        bad = np.argwhere(~np.isfinite(array))
        if len(bad):
            place = ", ".join(map(str, bad[0]))
            problem = f"holds {len(bad)} value(s) that are not finite, the first at [{place}]"
            raise self.refused(name, problem, "Look for what went wrong where it was made; 0 is the first index")
        largest = float(np.abs(array).max(initial=0))
        if largest > LARGEST:
            problem = f"holds {largest:.3g}, which no structure has in any unit"
            raise self.refused(name, problem, "Write it again; the file may be damaged")


# The rigid body that a model is, held against what is known of the structure: the check that finds a slip of units.

MASS = 0.02
"""Share by which the mass of a finite-element model may differ from the stated one, beyond three times its tolerance."""

COG = 0.05
"""Distance between the model's CoG and the stated one, in radii of gyration."""

RIGID = 1e-5
"""How far a mass matrix, scaled to masses and moments of one, may be from that of a rigid body: digits of a printed table."""

SLIPS = {
    1e3: "tonnes read as kilograms, or the other way round",
    1e6: "tonnes and grams confused",
    1e9: "a density per mm³ taken per m³",
    5.7101475: "tonnes and lbf s²/in confused",
    175.126835: "pounds-force and inches (lbf s²/in) for kilograms",
    14.593903: "slugs for kilograms",
    2.2046226: "pounds for kilograms",
    386.08858: "weight for mass in inches and pounds (no WTMASS)",
    toml_file.STANDARD_GRAVITY: "weight for mass (no division by g)",
}
"""Ratios that a mass is off by when units are confused, or their inverse."""


def require_rigid_body(matrix: Array, source: str, field: str, remedy: str) -> Inertia:
    """The (6, 6) mass `matrix` [SI] as ten parameters.

    Raises
    ------
    BadInput : it is not of the form of Eq. 1, or no body has such parameters.
    """
    scale = np.sqrt(np.abs(np.diag(matrix)))
    if np.any(scale == 0):
        axis = MOTIONS[int(np.argmin(scale))]
        raise BadInput(source, field, f"has no inertia along {axis}", remedy)
    # Ten parameters of a symmetric matrix that is nearly a rigid body's
    S, mass = (matrix[3:, :3] - matrix[3:, :3].T) / 2, float(np.trace(matrix[:3, :3]) / 3)
    inertia = Inertia(parameters=np.array([mass, S[2, 1], S[0, 2], S[1, 0], *six_from_tensor(matrix[3:, 3:])]))
    misfit = np.abs(matrix - inertia.mass_matrix) / np.outer(scale, scale)
    if misfit.max() > RIGID:
        row, column = (int(i) for i in np.unravel_index(np.argmax(misfit), misfit.shape))
        problem = (
            f"is not the mass matrix of a rigid body (m 1, -S; S, Theta): row {row + 1}, column {column + 1} is "
            f"{matrix[row, column]:.6g} where {inertia.mass_matrix[row, column]:.6g} belongs, diagonal {_listed(np.diag(matrix))}"
        )
        raise BadInput(source, field, problem, remedy)
    verdict = judge(inertia, RIGID)
    if not verdict.physical:
        raise BadInput(source, field, f"no body has it: {verdict.text}", remedy)
    return inertia


def require_as_stated(inertia: Inertia, description: Description) -> None:
    """Refuse a model whose mass or CoG is not the stated one.

    `inertia` is about the reference point, its offset from there, in the model's axes.

    Raises
    ------
    BadInput : either is not; a ratio of masses that a slip of units explains is named.
    """
    stated = description.stated
    require_stated_mass(inertia.mass, description)
    if stated.cog is None:
        return
    cog = description.reference_point + inertia.first_moment / inertia.mass
    centred = inertia.tensor - parallel_axis(inertia.mass, inertia.first_moment / inertia.mass)
    radius = float(np.sqrt(np.trace(centred) / (2 * inertia.mass)))
    if np.linalg.norm(cog - stated.cog) > COG * radius:
        problem = f"the matrices have their CoG at ({_listed(cog)}) m where ({_listed(stated.cog)}) m is stated"
        remedy = f"Check the coordinates, their unit ({description.units.name}), and the frame that the CoG is stated in"
        raise BadInput(description.source, "stated.cog", problem, remedy)


def require_stated_mass(mass: float, description: Description, least: float = 1.0) -> None:
    """Refuse a model whose `mass` [kg] is not the stated one, or less than the share `least` of it.

    Raises
    ------
    BadInput : it is not; a ratio that a slip of units explains is named.
    """
    stated = description.stated
    if stated.mass is None or least * stated.mass <= mass <= stated.mass:
        return
    if abs(mass - stated.mass) > max(MASS * stated.mass, 3 * stated.mass_tolerance):
        ratio = mass / stated.mass
        problem = f"the matrices weigh {mass:.6g} kg where {stated.mass:.6g} kg are stated, {ratio:.6g} times as much"
        known = description.units.name
        slips = ((slip, words) for factor, words in SLIPS.items() for slip in (factor, 1 / factor))
        named = (
            f"A factor of {slip:.4g} is {words}: check `fe_model.units`, found {known}"
            for slip, words in slips
            if least - MASS < ratio / slip < 1 + MASS
        )
        unnamed = f"Check `fe_model.units`, found {known}, and whether all parts and lumped masses are in the model"
        raise BadInput(description.source, "stated.mass", problem, next(named, unnamed))


def _listed(values: Array) -> str:
    return ", ".join(f"{value:.6g}" for value in values)
