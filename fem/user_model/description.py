"""The TOML text that says what bare numbers mean: units, reference point, interface, what is known of the mass.

It stands in a file of its own or, in HDF5 and npz, in the data file itself (attribute or array ``description``).
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from fem.structure import Sparse
from geometry import toml_file
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.frames import Array, Integers
from geometry.inertia import Inertia, judge, parallel_axis, six_from_tensor
from geometry.toml_file import quantity, require_known, require_present

# The unit system of a user's model, ``mm-t-N-s``, and what its matrices are multiplied with to be SI.
#
# A finite-element program knows no units; it only needs force = mass × length / time². So a system is three units, and naming
# the force as well is a check that catches the commonest slip (kilograms beside millimetres and newtons).
#
# With displacements and rotations of the user u = u_SI / s (s is the unit of length for translations, 1 for rotations) energies
# agree when M_SI = m L² M / (s_i s_j), K_SI = m L² / T² K / (s_i s_j) and C_SI = m L² / T C / (s_i s_j). A generalised
# coordinate has no unit of its own; s = L m^0.5 leaves modes that are normalised to unit mass so.

KNOWN = ("m-kg-N-s", "mm-t-N-s", "mm-kg-mN-s", "mm-kg-kN-ms", "in-lbf-s", "ft-lbf-s")
"""Systems that a message may propose; any other one that pint can read and that is consistent does as well."""

CONSISTENT = 1e-6
"""A force may differ by this share from mass × length / time²: the standard inch and pound are exact, digits in names are not."""


@dataclass(frozen=True, kw_only=True)
class UnitSystem:
    """What one unit of a model is in SI.

    Attributes
    ----------
    name : as the user wrote it
    length, mass, time : [m], [kg], [s]
    """

    name: str
    length: float
    mass: float
    time: float

    def coordinates(self, components: Integers) -> Array:
        """SI value (n,) of one unit of each degree of freedom, from its component 1 to 6, 0 for a generalised one."""
        scales = np.array([self.length * np.sqrt(self.mass), *3 * [self.length], *3 * [1.0]])
        return np.asarray(scales[components])

    @property
    def energy(self) -> float:
        """[J]"""
        return self.mass * self.length**2 / self.time**2

    @property
    def six(self) -> Array:
        """SI value (6,) of the lever arms of the six motions: none of x, y and z, the unit of length of the rotations."""
        return np.array([1.0, 1.0, 1.0, *3 * [self.length]])


SI = UnitSystem(name="m-kg-N-s", length=1.0, mass=1.0, time=1.0)


def unit_system(text: object, source: str, field: str = "fe_model.units") -> UnitSystem:
    """The system that `text` names: length-mass-force-time, or length-force-time where the mass follows.

    Raises
    ------
    BadInput : not of that form, a unit not known or of another dimension, a force that is not mass × length / time².
    """
    words = [word.strip() for word in text.split("-")] if isinstance(text, str) else []
    if len(words) not in (3, 4):
        problem = f"must be length-mass-force-time, found {text!r}"
        raise BadInput(source=source, field=field, problem=problem, remedy=f"Write one like {', '.join(KNOWN)}")
    dimensions = ("length", "mass", "force", "time") if len(words) == 4 else ("length", "force", "time")
    value = {}
    for name, word in zip(dimensions, words, strict=True):
        size = float(quantity(f"1 {word}", name, source=source, field=field).nominal_value)
        if size <= 0:
            problem = f"one {word!r} is nothing beside the {name} of any structure"
            raise BadInput(source=source, field=field, problem=problem, remedy=f"Write a system like {', '.join(KNOWN)}")
        value[name] = size
    by_newton = value["force"] * value["time"] ** 2 / value["length"]
    mass = value.get("mass", by_newton)
    if abs(by_newton / mass - 1) > CONSISTENT:
        problem = f"the force of {text} is {by_newton / mass:.6g} times mass × length / time²"
        remedy = f"Name the units that the matrices were made with: {', '.join(KNOWN)} are consistent"
        raise BadInput(source=source, field=field, problem=problem, remedy=remedy)
    return UnitSystem(name=str(text), length=value["length"], mass=mass, time=value["time"])


TABLE = "fe_model"
"""The table by which a TOML file is recognised as the description of a model."""

KINDS = ("matrices", "modal")
_TOP = ("format", TABLE, "stated")
_KEYS = ("name", "kind", "units", "reference_point", "file", "grids", "interface", "matrices", "loss_factor", "sha256")
MATRICES = ("stiffness", "mass", "viscous", "structural")


@dataclass(frozen=True, eq=False, kw_only=True)
class Stated:
    """What the user knows of the whole structure from elsewhere, to hold the matrices against.

    Attributes
    ----------
    mass : [kg], None when not stated
    mass_tolerance : [kg], zero when none was stated
    cog : (3,) [m] in the model's frame, None when not stated
    """

    mass: float | None = None
    mass_tolerance: float = 0.0
    cog: Array | None = None


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
    file, grids : the data, and where a Nastran model has its grid points; None where not named
    interface : identifiers of the nodes that the base carries; empty where the data say it otherwise
    matrices : the names in a Nastran file of what we call stiffness, mass, viscous and structural
    loss_factor : of the whole structure, None when not given
    sha256 : of the data file, empty when not given
    stated : what is known from elsewhere
    """

    source: str
    name: str
    kind: str
    units: UnitSystem
    reference_point: Array
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
    """The description in `table`; other files are relative to `path` and lie in its folder or below.

    Raises
    ------
    BadInput : an unknown or missing key, a wrong type, unit or dimension, a file that is not there or elsewhere.
    """
    toml_file.require_known(table, _TOP, source=source)
    toml_file.require_format(table, source)
    toml_file.require_present(table, (TABLE,), source=source)
    model = toml_file.require_table(table[TABLE], source=source, where=TABLE)
    toml_file.require_known(model, _KEYS, source=source, where=TABLE)
    toml_file.require_present(model, ("kind", "units", "reference_point"), source=source, where=TABLE)
    value = model.get("interface", [])
    where = f"{TABLE}.interface"
    if not isinstance(value, list) or not all(isinstance(node, int) and not isinstance(node, bool) for node in value):
        raise _wrong(value, "a list of node numbers", source, where, "Write it like [1, 2, 3]")
    twice = next((node for node in value if value.count(node) > 1), None)
    if twice is not None:
        problem = f"names node {twice} {value.count(twice)} times"
        raise BadInput(source=source, field=where, problem=problem, remedy="Name every interface node once")
    named = toml_file.require_table(model.get("matrices", {}), source=source, where=f"{TABLE}.matrices")
    toml_file.require_known(named, MATRICES, source=source, where=f"{TABLE}.matrices")
    for key, name in named.items():
        if not isinstance(name, str) or not name.isidentifier():
            remedy = 'Write it like { stiffness = "kaa" }'
            raise _wrong(name, "the name of a matrix", source, f"{TABLE}.matrices.{key}", remedy)
    loss = model.get("loss_factor")
    if loss is not None and (isinstance(loss, bool) or not isinstance(loss, int | float) or not 0 <= loss < 2):
        remedy = "It is twice the damping ratio at resonance"
        raise _wrong(loss, "at least 0 and below 2", source, f"{TABLE}.loss_factor", remedy)
    return Description(
        source=source,
        name=_text(model, "name", source) or path.stem,
        kind=toml_file.one_of(model["kind"], KINDS, source=source, where=f"{TABLE}.kind"),
        units=unit_system(model["units"], source),
        reference_point=_point(model["reference_point"], source, f"{TABLE}.reference_point"),
        file=_file(model, "file", source, path),
        grids=_file(model, "grids", source, path),
        interface=tuple(value),
        matrices={key: name.lower() for key, name in named.items()},
        loss_factor=None if loss is None else float(loss),
        sha256=(_text(model, "sha256", source) or "").strip().lower(),
        stated=_stated(table.get("stated", {}), source),
    )


def _text(table: Mapping[str, Any], key: str, source: str) -> str | None:
    found = table.get(key)
    if found is not None and (not isinstance(found, str) or not found.strip() or "\0" in found):
        raise _wrong(found, "text", source, f"{TABLE}.{key}", "Write it in quotes")
    return found


def _point(value: Any, source: str, where: str) -> Array:
    """Three lengths (3,) [m], each with its unit."""
    example = 'Write it like ["0 mm", "0 mm", "120.5 mm"]'
    if not isinstance(value, list) or len(value) != 3:
        raise _wrong(value, "three lengths with their units", source, where, example)
    return np.array([quantity(each, "length", source=source, field=where).nominal_value for each in value], dtype=np.float64)


def _file(table: Mapping[str, Any], key: str, source: str, path: Path) -> Path | None:
    name = _text(table, key, source)
    if name is None:
        return None
    folder, there, where = path.parent.resolve(), path.parent / name, f"{TABLE}.{key}"
    if not there.resolve().is_relative_to(folder):
        problem = f"{name!r} leads out of the folder of the description, to {there.resolve()}"
        raise BadInput(source=source, field=where, problem=problem, remedy="Copy the file beside the description")
    if not there.is_file():
        raise BadInput(source=source, field=where, problem=f"there is no file {name!r}", remedy=f"Looked for {there}")
    return there


def _stated(value: Any, source: str) -> Stated:
    table = toml_file.require_table(value, source=source, where="stated")
    toml_file.require_known(table, ("mass", "cog"), source=source, where="stated")
    cog = _point(table["cog"], source, "stated.cog") if "cog" in table else None
    if "mass" not in table:
        return Stated(cog=cog)
    mass = quantity(table["mass"], "mass", source=source, field="stated.mass")
    if mass.nominal_value <= 0:
        raise _wrong(table["mass"], "positive", source, "stated.mass", "Give the mass of the whole structure")
    return Stated(mass=float(mass.nominal_value), mass_tolerance=float(mass.std_dev), cog=cog)


def _wrong(found: Any, wanted: str, source: str, where: str, remedy: str) -> BadInput:
    return BadInput(source=source, field=where, problem=f"must be {wanted}, found {found!r}", remedy=remedy)


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

    def matrix(self, name: str) -> Sparse:
        """The square matrix `name`, dense or sparse in the file, as a sparse one.

        Raises
        ------
        BadInput : missing, not square, no numbers, complex, not finite, indices that do not fit.
        """
        from scipy.sparse import csr_array, issparse

        if name not in self.arrays and f"{name}/data" in self.arrays:
            found = self._compressed(name)
        else:
            require_present(self.arrays, (name,), source=self.source)
            raw = self.arrays[name]
            self._require_square(name, np.shape(raw))
            if issparse(raw):
                self._require_real(name, raw.data)
                self._require_finite(name, raw.data)
                found = csr_array(raw)
            else:
                found = csr_array(self.numbers(name, (-1, -1)))
        return found

    def refused(self, name: str, problem: str, remedy: str) -> BadInput:
        """The refusal of the array `name`."""
        return BadInput(source=self.source, field=name, problem=problem, remedy=remedy)

    def _compressed(self, name: str) -> Sparse:
        from scipy.sparse import csr_array

        data = self.numbers(f"{name}/data", (-1,))
        indices, indptr = (self.whole(f"{name}/{part}", (-1,)) for part in ("indices", "indptr"))
        shape = tuple(int(side) for side in self.whole(f"{name}/shape", (2,)))
        self._require_square(f"{name}/shape", shape)
        try:
            found = csr_array((data, indices, indptr), shape=shape)
            found.check_format(full_check=True)
        except ValueError as error:
            problem = f"its indices do not fit together: {error}"
            raise self.refused(name, problem, "Write data, indices, indptr and shape of one CSR matrix") from None
        found.sum_duplicates()
        return found

    def _require_square(self, name: str, shape: tuple[int, ...]) -> None:
        if len(shape) != 2 or shape[0] != shape[1] or not 0 < shape[0] <= LARGEST_SIDE:
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
    9.80665: "weight for mass (no division by g)",
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
        raise BadInput(source=source, field=field, problem=f"has no inertia along {axis}", remedy=remedy)
    # Ten parameters of a symmetric matrix that is nearly a rigid body's
    S = (matrix[3:, :3] - matrix[3:, :3].T) / 2
    mass = float(np.trace(matrix[:3, :3]) / 3)
    inertia = Inertia(parameters=np.array([mass, S[2, 1], S[0, 2], S[1, 0], *six_from_tensor(matrix[3:, 3:])]))
    misfit = np.abs(matrix - inertia.mass_matrix) / np.outer(scale, scale)
    if misfit.max() > RIGID:
        row, column = (int(i) for i in np.unravel_index(np.argmax(misfit), misfit.shape))
        problem = (
            f"is not the mass matrix of a rigid body (m 1, -S; S, Theta): row {row + 1}, column {column + 1} is "
            f"{matrix[row, column]:.6g} where {inertia.mass_matrix[row, column]:.6g} belongs, diagonal {_listed(np.diag(matrix))}"
        )
        raise BadInput(source=source, field=field, problem=problem, remedy=remedy)
    verdict = judge(inertia, RIGID)
    if not verdict.physical:
        raise BadInput(source=source, field=field, problem=f"no body has it: {verdict.text}", remedy=remedy)
    return inertia


def require_as_stated(inertia: Inertia, description: Description) -> None:
    """Refuse a model whose mass or CoG is not the stated one; a ratio that a slip of units explains is named.

    `inertia` is about the reference point, its offset from there, in the model's axes.
    """
    stated = description.stated
    if stated.mass is not None and abs(inertia.mass - stated.mass) > max(MASS * stated.mass, 3 * stated.mass_tolerance):
        ratio = inertia.mass / stated.mass
        problem = f"the matrices weigh {inertia.mass:.6g} kg where {stated.mass:.6g} kg are stated, {ratio:.6g} times as much"
        known = description.units.name
        slips = ((slip, words) for factor, words in SLIPS.items() for slip in (factor, 1 / factor))
        named = (
            f"A factor of {slip:.4g} is {words}: check `fe_model.units`, found {known}"
            for slip, words in slips
            if abs(ratio / slip - 1) < MASS
        )
        unnamed = f"Check `fe_model.units`, found {known}, and whether all parts and lumped masses are in the model"
        remedy = next(named, unnamed)
        raise BadInput(source=description.source, field="stated.mass", problem=problem, remedy=remedy)
    if stated.cog is None:
        return
    cog = description.reference_point + inertia.first_moment / inertia.mass
    centred = inertia.tensor - parallel_axis(inertia.mass, inertia.first_moment / inertia.mass)
    radius = float(np.sqrt(np.trace(centred) / (2 * inertia.mass)))
    if np.linalg.norm(cog - stated.cog) > COG * radius:
        problem = f"the matrices have their CoG at ({_listed(cog)}) m where ({_listed(stated.cog)}) m is stated"
        remedy = f"Check the coordinates, their unit ({description.units.name}), and the frame that the CoG is stated in"
        raise BadInput(source=description.source, field="stated.cog", problem=problem, remedy=remedy)


def _listed(values: Array) -> str:
    return ", ".join(f"{value:.6g}" for value in values)
