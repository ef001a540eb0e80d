"""The TOML text of a mesh or an assembly: parts with material and section, where it is held, places, springs and masses."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from fem.beam.elements import Section, moduli, rectangle, tube
from fem.mesh import files, shells
from fem.mesh.constraints import NamedSum
from fem.user_model import description as text
from fem.user_model import parts, units
from geometry import toml_file, user_article
from geometry.article import Material
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.frames import Array, axes_along
from geometry.inertia import Inertia

KINDS = ("mesh", "assembly")
"""A mesh with groups, and STEP bodies that are meshed here; a part is a group or a body."""

_KEYS = (
    *("name", "kind", "units", "file", "support", "interface", "reference_point", "places", "parts", "groups"),
    *("springs", "joints", "masses", "links", "equations", "holds", "loss_factor", "size", "left_out"),
)
_PART = ("material", "thickness", "section", "layers", "x_axis", "offset", "loss_factor", "tolerance")
_PLY = ("density", "youngs_modulus", "poisson_ratio", "shear_modulus")
_TIED = ("stiffness", "loss_factor")
_SPRING = ("at", "between", "x_axis", "y_axis", "about", *_TIED)
_LINK = ("at", "nodes", "directions", "mean_of", "weights", "rotations")
_OPEN = ("Iyz", "neutral_axis", "shear")
"""What a section with an area, Iy, Iz and J may have beside."""

UNIT = 1e-3
"""[1] Relative difference of two units of length that are one, by their rounding. By definition."""

SOFT = 1e-9
"""[1] Share of the greatest stiffness of layers below which they have none some way in their plane. By definition."""

At = int | str | tuple[float, float, float]
"""Where something is: the number of a node, the name of a group, box or place, or coordinates [m]."""


@dataclass(frozen=True, kw_only=True)
class Profile:
    """A section as described: `sizes` [m] are width and height, of a `round` one both diameters; area, Iy, Iz and J; or the
    area of a `rod`, which pushes and pulls and does not bend. Of the third kind are the `product` of inertia about y and z,
    where the `neutral_axis` is from the line about which it twists, and the shares of the area in `shear`, infinite of none."""

    sizes: tuple[float, ...]
    material: Material
    round: bool = False
    product: float = 0.0
    neutral_axis: tuple[float, float] = (0.0, 0.0)
    shear: tuple[float, float] = (float("inf"), float("inf"))

    @property
    def rod(self) -> bool:
        return len(self.sizes) == 1

    def times(self, factor: float) -> Section:
        """The section with its height, or the wall of a tube, `factor` times as thick."""
        if self.round:
            outer, inner = self.sizes
            return tube(outer, max(outer - factor * (outer - inner), 0.0), self.material)
        if len(self.sizes) == 2:
            width, height = self.sizes
            return rectangle(width, factor * height, self.material)
        A, Iy, Iz, J = (*self.sizes, 0.0, 0.0, 0.0)[:4]
        (E, G), rho = moduli(self.material), self.material.density
        (c, s), _ = self.turned[1:, 1:]
        cross = 2 * s * c * self.product
        Iy, Iz = s * s * Iz - cross + c * c * Iy, c * c * Iz + cross + s * s * Iy
        return Section(
            axial=E * A,
            torsion=G * J,
            bending_y=E * Iy,
            bending_z=E * Iz,
            shear_y=self.shear[0] * G * A,
            shear_z=self.shear[1] * G * A,
            mass=rho * A,
            rotary_y=rho * Iy,
            rotary_z=rho * Iz,
        )

    @property
    def turned(self) -> Array:
        """Principal axes (3, 3) of the section as rows, along the beam and its y and z, which they are nearest to."""
        if not self.product:
            return np.eye(3)
        _, Iy, Iz, _ = self.sizes
        angle = np.arctan(2 * self.product / (Iz - Iy)) / 2 if Iz != Iy else np.pi / 4
        c, s = np.cos(angle), np.sin(angle)
        return np.array([[1, 0, 0], [0, c, s], [0, -s, c]])


@dataclass(frozen=True, eq=False, kw_only=True)
class PartTable:
    """One part as described.

    Attributes
    ----------
    material : elastic; of layers what is as stiff in their plane, as far as one is, and as heavy
    thickness : of its shells [m], None where it has none
    laminate : of its shells, None where they are of one material
    x_axis : (3,) direction of the fibres whose angle is 0, None for that which an element states, or its first side
    section : of its beams, None where it has none
    z_axis : (3,) direction of the section's z axis, None for the upright one
    reach : [m] how far the surface of its beams is from their axis
    varied : whether its beams have a thickness
    loss_factor : [1], None where none is known
    tolerance : relative standard deviations, by `parts.TOLERANCES`
    """

    material: Material
    thickness: float | None = None
    laminate: shells.Laminate | None = None
    x_axis: Array | None = None
    section: Profile | None = None
    z_axis: Array | None = None
    reach: float = 0.0
    varied: bool = False
    loss_factor: float | None = None
    tolerance: Mapping[str, float]


@dataclass(frozen=True, eq=False, kw_only=True)
class Spring:
    """Six stiffnesses (6,) [N/m, N m/rad] along and about its `axes` (3, 3), else x, y, z, from `at` to the ground or, of two of
    them, to each other; `about` a point (3,) [m] that both reach by rigid arms, where one is stated. Its loss factor [1] is
    None where none is known."""

    at: tuple[At, ...]
    stiffness: Array
    axes: Array | None = None
    about: Array | None = None
    loss_factor: float | None = None

    def as_stiff_as(self, other: "Spring") -> bool:
        """Whether both have the same stiffnesses, along the same axes about the same point."""
        pairs = ((self.stiffness, other.stiffness), (self.axes, other.axes), (self.about, other.about))
        return all(np.array_equal(np.asarray(one), np.asarray(two)) for one, two in pairs)


@dataclass(frozen=True, eq=False, kw_only=True)
class Joint:
    """Six stiffnesses (6,) about the place `at`, between the two parts of `between`; nodes that both have are cut in two. Its
    loss factor [1] is None where none is known."""

    between: tuple[str, str]
    at: At
    stiffness: Array
    loss_factor: float | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class PointMass:
    """A rigid body of `inertia`, about `at`."""

    at: At
    inertia: Inertia


@dataclass(frozen=True, eq=False, kw_only=True)
class Link:
    """The nodes of the groups and numbers in `nodes` ride on a point at (3,) [m] in some `directions`, numbered as `MOTIONS`
    are; or it `follows` their mean motion, by the `weights` of `nodes`, alike where none are stated, and by their `rotations` as
    well. Where they do not ride in all, what moves none of them is held."""

    at: tuple[float, float, float]
    nodes: tuple[int | str, ...]
    directions: tuple[int, ...] = tuple(range(6))
    follows: bool = False
    weights: tuple[float, ...] = ()
    rotations: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class Hold:
    """The groups and numbers of `nodes` that the ground holds in some `directions`, numbered as `MOTIONS` are."""

    nodes: tuple[int | str, ...]
    directions: tuple[int, ...]


SEAM = 6
"""[count] of links between the same parts, or a part and the ground, of which each may give by itself; more are a seam, which
holds as a weld does. Held by test_mesh_structure.py."""

LOWEST = "lowest plane"
"""What an assembly stands on that neither names an interface, nor is free or on springs."""


@dataclass(frozen=True, eq=False, kw_only=True)
class MeshDescription:
    """The content of a description of kind mesh or assembly, in SI.

    Attributes
    ----------
    source, name, kind : where the text stands, what the model is called, one of `KINDS`
    file : mesh or STEP file
    length : unit of the mesh's coordinates [m]
    support : one of `parts.SUPPORTS`
    interface : groups, boxes, links or node numbers that the base carries or the ground holds; `LOWEST` of an assembly
    reference_point : (3,) [m]
    size : largest edge of an element of an assembly [m], None for what thickness asks for
    left_out : cards and keywords of the mesh file that are stated here, or are not meant
    equations : sums of motions of nodes by the name of what has them, each of which is zero; rotations have lengths [m]
    """

    source: str
    name: str
    kind: str
    file: Path
    length: float
    support: str
    interface: tuple[int | str, ...]
    reference_point: Array
    size: float | None
    left_out: tuple[str, ...]
    parts: Mapping[str, PartTable]
    places: Mapping[str, At]
    boxes: Mapping[str, Array]
    springs: Mapping[str, Spring]
    joints: Mapping[str, Joint]
    masses: Mapping[str, PointMass]
    links: Mapping[str, Link]
    equations: Mapping[str, tuple[NamedSum, ...]]
    holds: Mapping[str, Hold]
    stated: text.Stated

    @property
    def riding(self) -> dict[str, Link]:
        """Links on which nodes ride; the others follow theirs."""
        return {name: link for name, link in self.links.items() if not link.follows}

    def sums(self) -> Iterator[tuple[str, NamedSum]]:
        """Every equation with the name of what has it."""
        return ((name, one) for name, several in self.equations.items() for one in several)

    def mesh(self) -> files.MeshFile:
        """What the mesh file holds.

        Raises
        ------
        BadInput : see `files.read`; it states another unit itself.
        """
        found = files.read(self.file, {card.strip("*").upper() for card in self.left_out}.__contains__)
        if found.unit and abs(found.unit / self.length - 1) > UNIT:
            problem = f"is {self.length:g} m, and {self.file.name} itself says {found.unit:g} m (dataset 164)"
            raise self.refused("units", problem, "Correct it, or take that dataset out")
        return found

    def refused(self, field: str, problem: str, remedy: str) -> BadInput:
        """The refusal of a key below ``fe_model``."""
        return BadInput(self.source, f"{text.TABLE}.{field}", problem, remedy)


@dataclass(frozen=True, kw_only=True)
class _Table:
    """A table of the description, read key by key; every refusal says where."""

    source: str
    where: str
    table: Mapping[str, Any]

    def wrong(self, key: str, wanted: str, remedy: str) -> BadInput:
        found = self.table.get(key)
        problem = f"must be {wanted}, found {found!r}" if key in self.table else "is missing"
        return BadInput(self.source, f"{self.where}.{key}", problem, remedy)

    def known(self, keys: tuple[str, ...]) -> "_Table":
        toml_file.require_known(self.table, keys, source=self.source, where=self.where)
        return self

    def inner(self, key: str) -> "_Table":
        """The table under `key`; empty where there is none."""
        where = f"{self.where}.{key}"
        table = toml_file.require_table(self.table.get(key, {}), source=self.source, where=where)
        return _Table(source=self.source, where=where, table=table)

    def tables(self, key: str, keys: tuple[str, ...]) -> dict[str, "_Table"]:
        """The tables below `key` by name."""
        below = self.inner(key)
        return {name: below.inner(name).known(keys) for name in below.table}

    def quantity(self, key: str, dimension: str, *, positive: bool = True) -> float:
        if key not in self.table:
            raise self.wrong(key, "", f'Write it like "1 {toml_file.SI_UNITS[dimension]}"')
        value = self._read(self.table[key], dimension, key)
        if positive and value <= 0:
            raise self.wrong(key, "positive", "Correct it")
        return value

    def quantities(self, key: str, dimensions: tuple[str, ...]) -> Array:
        value = self.table.get(key)
        if not isinstance(value, list) or len(value) != len(dimensions):
            example = ", ".join(f'"1 {toml_file.SI_UNITS[each]}"' for each in dimensions)
            raise self.wrong(key, f"{len(dimensions)} values with their units", f"Write it like [{example}]")
        return np.array([self._read(each, dimension, key) for each, dimension in zip(value, dimensions, strict=True)])

    def number(self, key: str, below: float) -> float | None:
        value = self.table.get(key)
        if key in self.table and (isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value < below):
            raise self.wrong(key, f"a number of at least 0 and below {below:g}", "Correct it")
        return None if value is None else float(value)

    def at(self, key: str) -> At:
        """A node's number, a name, or three lengths with their units."""
        value = self.table.get(key)
        if (isinstance(value, str) and value.strip()) or (isinstance(value, int) and not isinstance(value, bool)):
            return value
        if isinstance(value, list):
            x, y, z = self.quantities(key, 3 * ("length",)).tolist()
            return x, y, z
        remedy = 'Write the number of a node, the name of a group or place, or ["1 m", "0 m", "20 mm"]'
        raise self.wrong(key, "a place", remedy)

    def part(self, whole: float | None) -> PartTable:
        thickness, laminate = self.quantity("thickness", "length") if "thickness" in self.table else None, None
        if "layers" in self.table:
            laminate, thickness, material = self.layers()
        else:
            material = self.material()
            if beside := [key for key in ("x_axis", "offset") if key in self.table]:
                remedy = "State the material and the thickness as its one layer"
                raise self.wrong(beside[0], "left out where there are no `layers`", remedy)
        section, reach, z_axis, varied = None, 0.0, None, False
        if "section" in self.table:
            section, reach, z_axis, varied = self.inner("section").section(material)
        tolerance = self.inner("tolerance").known(parts.TOLERANCES)
        # What is written goes before what a table of materials says of the bare metal
        written = isinstance(self.table.get("material"), dict)
        lost = self.loss(material.loss_factor, whole) if written else self.loss(whole, material.loss_factor)
        return PartTable(
            material=material,
            thickness=thickness,
            laminate=laminate,
            x_axis=self.direction("x_axis"),
            section=section,
            z_axis=z_axis,
            reach=reach,
            varied=varied,
            loss_factor=lost,
            tolerance={key: value for key in tolerance.table if (value := tolerance.number(key, 10.0)) is not None},
        )

    def layers(self) -> tuple[shells.Laminate, float, Material]:
        """The laminate, its thickness [m], and the one material that it is most like."""
        listed = self.table["layers"]
        for key in {"material", "thickness"} & set(self.table):
            raise self.wrong(key, "left out beside `layers`", "State it of each layer")
        if not isinstance(listed, list) or not listed or not all(isinstance(one, dict) for one in listed):
            raise self.wrong("layers", "a list of layers", 'Write [{ material = "aluminium", thickness = "1 mm", angle = 0 }]')
        where = f"{self.where}.layers"
        tables = (_Table(source=self.source, where=f"{where}.{k}", table=one) for k, one in enumerate(listed, start=1))
        several = [one.known(("material", "thickness", "angle")).layer() for one in tables]
        stiff = np.linalg.eigvalsh(sum((one.thickness * one.turned for one in several), np.zeros((3, 3))))
        if not stiff[0] > SOFT * stiff[-1]:
            wanted = "stiff in their plane along it, across it and in shear"
            raise self.wrong("layers", wanted, "State the faces, or a modulus 12")
        offset = self.quantity("offset", "length", positive=False) if "offset" in self.table else 0.0
        made, thickness = shells.Laminate.of(several, offset), float(sum(one.thickness for one in several))
        A, rho = float(np.sqrt(made.membrane[0, 0] * made.membrane[1, 1])), made.masses[0] / thickness
        nu = min(float(made.membrane[0, 1]) / A, 0.49)
        return made, thickness, Material(name=where, density=rho, youngs_modulus=A * (1 - nu**2) / thickness, poisson_ratio=nu)

    def layer(self) -> shells.Layer:
        angle, value = self.table.get("angle", 0.0), self.table.get("material")
        if isinstance(angle, bool) or not isinstance(angle, int | float) or not np.isfinite(angle):
            raise self.wrong("angle", "a number of degrees", "Write angle = 45")
        if isinstance(value, dict) and isinstance(value.get("youngs_modulus"), list):
            own = self.inner("material").known(_PLY)
            E1, E2 = own.quantities("youngs_modulus", 2 * ("pressure",)).tolist()
            count = 3 if isinstance(given := value.get("shear_modulus"), list) and len(given) > 1 else 1
            G12, *across = own.quantities("shear_modulus", count * ("pressure",))
            nu, density = value.get("poisson_ratio"), own.quantity("density", "density", positive=False)
            shrinks = 1 - nu**2 * E2 / max(E1, 1e-300) if isinstance(nu, int | float) else 0.0
            if not shrinks > 0 or min(E1, E2, G12, density) < 0 or min(across, default=1.0) <= 0:
                problem = "of a layer: no modulus or density below 0, and Poisson's ratio of strain across to strain along"
                raise own.wrong("poisson_ratio", problem, "Write two youngs_modulus and three shear_modulus: 12, 13, 23")
            plane = np.array([[E1, nu * E2, 0], [nu * E2, E2, 0], [0, 0, 0]]) / shrinks + np.diag([0, 0, G12])
        else:
            of = self.material()
            E, mu = moduli(of)
            plane, across, density = shells.plane_stress(E, E / (2 * mu) - 1), [mu, mu], of.density
        stiff, turn = np.array(across or [np.inf, np.inf]), float(np.radians(angle))
        thickness = self.quantity("thickness", "length")
        return shells.Layer(plane=plane, across=stiff, angle=turn, thickness=thickness, density=density)

    def direction(self, key: str) -> Array | None:
        if key not in self.table:
            return None
        value = self.table[key]
        plain = isinstance(value, list) and len(value) == 3 and all(isinstance(v, int | float) for v in value)
        if not plain or not 0 < np.linalg.norm(value) < 1e6:
            raise self.wrong(key, "three numbers that are a direction", "Write it like [0, 0, 1]")
        return np.array(value, dtype=np.float64)

    def material(self) -> Material:
        value, where = self.table.get("material"), f"{self.where}.material"
        if isinstance(value, str):
            found = user_article.made_of(value, f"{self.source}, {where}")
        elif isinstance(value, dict):
            found = user_article.own_material(where, value, self.source, where)
        else:
            remedy = 'Write material = "steel", or { density = "7850 kg/m^3", youngs_modulus = "210 GPa", poisson_ratio = 0.3 }'
            raise self.wrong("material", "a name or a table", remedy)
        moduli(found, self.where)
        return found

    def section(self, material: Material) -> tuple[Profile, float, Array | None, bool]:
        z_axis = self.direction("z_axis")
        keys = {key for key in self.table if key not in ("z_axis", *(_OPEN if "Iy" in self.table else ()))}
        if keys == {"width", "height"}:
            width, height = self.quantity("width", "length"), self.quantity("height", "length")
            return Profile(sizes=(width, height), material=material), float(np.hypot(width, height) / 2), z_axis, True
        if keys == {"outer_diameter", "inner_diameter"}:
            outer, inner = self.quantity("outer_diameter", "length"), self.quantity("inner_diameter", "length", positive=False)
            tube(outer, inner, material)
            return Profile(sizes=(outer, inner), material=material, round=True), outer / 2, z_axis, inner > 0
        if keys == {"area", "Iy", "Iz", "J"}:
            A = self.quantity("area", "area")
            Iy, Iz, J = (self.quantity(key, "second moment of area", positive=False) for key in ("Iy", "Iz", "J"))
            product = self.quantity("Iyz", "second moment of area", positive=False) if "Iyz" in self.table else 0.0
            if min(Iy, Iz, J) < 0 or product**2 > Iy * Iz:
                wanted = "of a section: Iy, Iz and J positive, Iyz² below Iy Iz"
                raise self.wrong("Iyz" if product else "Iy", wanted, "Correct it")
            y, z = self.quantities("neutral_axis", 2 * ("length",)).tolist() if "neutral_axis" in self.table else (0.0, 0.0)
            shear = self.table.get("shear", [np.inf, np.inf])
            if not isinstance(shear, list) or len(shear) != 2 or not all(isinstance(k, float | int) and k > 0 for k in shear):
                raise self.wrong("shear", "two positive shares of the area, along y and z", "Write it like [0.83, 0.83]")
            profile = Profile(
                sizes=(A, Iy, Iz, J), material=material, product=product, neutral_axis=(y, z), shear=(shear[0], shear[1])
            )
            return profile, float(np.hypot(y, z) + np.sqrt(3 * max(Iy, Iz) / A)), z_axis, False
        if keys == {"area"}:
            A = self.quantity("area", "area")
            return Profile(sizes=(A,), material=material), float(np.sqrt(A / np.pi)), z_axis, False
        wanted = "width and height, outer_diameter and inner_diameter, area, Iy, Iz and J, or area alone"
        problem = f"must have {wanted}, found {', '.join(keys) or 'none'}"
        raise BadInput(self.source, self.where, problem, "Complete one of the four")

    def box(self) -> Array:
        value = self.table.get("box")
        if not isinstance(value, list) or len(value) != 2:
            raise self.wrong("box", "two corners", 'Write it like [["0 mm", "0 mm", "-1 mm"], ["50 mm", "50 mm", "1 mm"]]')
        corners = [replace(self, table={"box": each}).quantities("box", 3 * ("length",)) for each in value]
        return np.array([np.minimum(*corners), np.maximum(*corners)])

    def stiffness(self) -> Array:
        return parts.six_stiffnesses(self.table.get("stiffness"), units.SI, self.source, f"{self.where}.stiffness")

    def spring(self, whole: float | None) -> Spring:
        x, y = self.direction("x_axis"), self.direction("y_axis")
        try:
            axes = None if x is None and y is None else axes_along(np.zeros(3) if x is None else x, y)
        except ValueError:
            beside = "State both, in the plane of the first two axes"
            raise self.wrong("y_axis", "a direction beside that of `x_axis`", beside) from None
        more: dict[str, Any] = {"axes": axes, "loss_factor": self.loss(whole)}
        more |= {"about": self.quantities("about", 3 * ("length",))} if "about" in self.table else {}
        if "between" not in self.table:
            return Spring(at=(self.at("at"),), stiffness=self.stiffness(), **more)
        ends = self.table["between"]
        if "at" in self.table or not isinstance(ends, list) or len(ends) != 2:
            raise self.wrong("between", "two places, without `at`", 'Write it like between = ["mid-span", "tip"]')
        two = tuple(replace(self, table={"between": end}).at("between") for end in ends)
        return Spring(at=two, stiffness=self.stiffness(), **more)

    def joint(self, whole: float | None) -> Joint:
        ends = self.table.get("between")
        if not isinstance(ends, list) or len(ends) != 2 or not all(isinstance(part, str) for part in ends) or ends[0] == ends[1]:
            raise self.wrong("between", "the names of two parts", 'Write it like between = ["deck", "rail"]')
        return Joint(between=(ends[0], ends[1]), at=self.at("at"), stiffness=self.stiffness(), loss_factor=self.loss(whole))

    def loss(self, *otherwise: float | None) -> float | None:
        """Its own loss factor, else the first that is known of those that hold `otherwise`."""
        stated = (parts.loss_factor(self.table, self.source, self.where), *otherwise)
        return next((each for each in stated if each is not None), None)

    def mass(self) -> PointMass:
        mass, six = self.quantity("mass", "mass"), 6 * ("moment of inertia",)
        cog = self.quantities("cog", 3 * ("length",)) if "cog" in self.table else np.zeros(3)
        moments = self.quantities("moments", six) if "moments" in self.table else np.zeros(6)
        inertia = Inertia(parameters=np.array([mass, 0.0, 0.0, 0.0, *moments]))
        principal, _ = inertia.principal()  # a floor that turns about its axis alone may have no others, which no body has
        if principal[0] < -1e-6 * principal[-1]:
            problem = f"positive about every axis, and the least is {principal[0]:.6g} kg m^2"
            raise self.wrong("moments", problem, "Write Ixx, Iyy, Izz, Ixy, Ixz, Iyz; Ixy = -∫xy dm")
        return PointMass(at=self.at("at"), inertia=inertia.moved(cog))

    def link(self) -> Link:
        at, key = self.at("at"), "mean_of" if "mean_of" in self.table else "nodes"
        if not isinstance(at, tuple):
            raise self.wrong("at", "three coordinates", 'Write it like ["1 m", "0 m", "20 mm"]')
        barred = ("nodes", "directions") if key == "mean_of" else ("weights", "rotations")
        for other in self.table.keys() & barred:
            left = f"left out {'' if key == 'mean_of' else 'but '}beside `mean_of`"
            raise self.wrong(other, left, "Nodes ride on a link, or it follows their mean motion by weights")
        nodes, weights, rotations = self.nodes(key), self.table.get("weights", []), self.table.get("rotations", False)
        if not isinstance(weights, list) or not all(isinstance(one, int | float) and 0 < one < np.inf for one in weights):
            raise self.wrong("weights", "a list of positive numbers", "Write one for each entry of `mean_of`")
        if weights and len(weights) != len(nodes):
            raise self.wrong("weights", f"{len(nodes)} numbers, one for each entry of `mean_of`", "Write one for each")
        if not isinstance(rotations, bool):
            raise self.wrong("rotations", "true or false", "Write rotations = true where rotations of the nodes count")
        ways, follows = self.directions(), key == "mean_of"
        return Link(at=at, nodes=nodes, directions=ways, follows=follows, weights=tuple(weights), rotations=rotations)

    def sums(self) -> Iterator[NamedSum]:
        """Sums of terms ``[coefficient, node, motion]``; of the three translations alike where no motion is said."""
        value = self.table.get("sums")
        for one in value if isinstance(value, list) and value else [None]:
            rows: list[Any] = one if isinstance(one, list) else []
            plain = all(isinstance(row, list) and len(row) in (2, 3) and _is_term(*row) for row in rows)
            if not plain or not rows or len({len(row) for row in rows}) > 1:
                problem = f"must be sums of [coefficient, node, one of {', '.join(MOTIONS)}], found {str(one)[:80]}"
                remedy = 'Write [[[1, 101, "x"], [-0.5, 7, "x"], [-0.5, 8, "x"]]]; the first term follows the others'
                raise BadInput(self.source, f"{self.where}.sums", problem, remedy)
            for way in range(3) if len(rows[0]) == 2 else [None]:
                yield tuple((float(row[0]), row[1], MOTIONS.index(row[2]) if way is None else way) for row in rows)

    def nodes(self, key: str = "nodes") -> tuple[int | str, ...]:
        nodes = self.table.get(key)
        listed: list[Any] = nodes if isinstance(nodes, list) else [nodes]
        if not listed or any(isinstance(node, bool) or not isinstance(node, int | str) for node in listed):
            raise self.wrong(key, "a group, or a list of groups and node numbers", "Name the nodes that are meant")
        return tuple(listed)

    def directions(self) -> tuple[int, ...]:
        named = self.table.get("directions", list(MOTIONS))
        if not isinstance(named, list) or not named or len({*map(str, named)} & {*MOTIONS}) != len(named):
            raise self.wrong("directions", f"a list of some of {', '.join(MOTIONS)}", 'Write it like ["x", "z"]')
        return tuple(sorted(MOTIONS.index(one) for one in named))

    def stated(self) -> text.Stated:
        toml_file.require_table(self.table, source=self.source, where="stated")
        self.known(("mass", "cog"))
        cog = self.quantities("cog", 3 * ("length",)) if "cog" in self.table else None
        if "mass" not in self.table:
            return text.Stated(cog=cog)
        mass = toml_file.quantity(self.table["mass"], "mass", source=self.source, field="stated.mass")
        return text.Stated(mass=self.quantity("mass", "mass"), mass_tolerance=float(mass.std_dev), cog=cog)

    def _read(self, value: Any, dimension: str, key: str) -> float:
        return float(toml_file.quantity(value, dimension, source=self.source, field=f"{self.where}.{key}").nominal_value)


def _is_term(factor: Any, node: Any, motion: Any = MOTIONS[0]) -> bool:
    """Whether a sum may have this coefficient of a node's motion."""
    number = isinstance(factor, float | int) and not isinstance(factor, bool) and np.isfinite(factor) and factor != 0
    return number and isinstance(node, int | str) and not isinstance(node, bool) and motion in MOTIONS


def described(path: Path) -> bool:
    """Whether `path` is meant as the description of a mesh or an assembly, by the word that its kind is nearest to."""
    table = toml_file.read(path).get(text.TABLE)
    kind = table.get("kind") if isinstance(table, dict) else None
    meant = [toml_file.nearest(each, KINDS) for each in KINDS]
    return isinstance(kind, str) and toml_file.nearest(kind, (*KINDS, *text.KINDS)) in meant


def read(path: Path) -> MeshDescription:
    """The description in `path`.

    Raises
    ------
    BadInput : not TOML, an unknown key (the nearest known one is named), a missing one, a wrong value, an unknown material.
    """
    source, whole = str(path), toml_file.read(path)
    toml_file.require_format(whole, source)
    if text.MODEL_FILE not in whole:  # the file of a model, whose own tables say more
        toml_file.require_known(whole, ("format", text.TABLE, "stated"), source=source)
    table = _Table(source=source, where=text.TABLE, table=whole[text.TABLE]).known(_KEYS)
    toml_file.require_present(table.table, ("kind", "file", "parts"), source=source, where=text.TABLE)
    kind = toml_file.one_of(table.table["kind"], KINDS, source=source, where=f"{text.TABLE}.kind")
    loss = parts.loss_factor(table.table, source, text.TABLE)
    support = toml_file.one_of(table.table.get("support", "base"), parts.SUPPORTS, source=source, where=f"{text.TABLE}.support")
    springs = {name: each.spring(loss) for name, each in table.tables("springs", _SPRING).items()}
    interface = table.table.get("interface", [])
    if not isinstance(interface, list) or any(isinstance(each, bool) or not isinstance(each, int | str) for each in interface):
        raise table.wrong("interface", "a list of groups or node numbers", 'Write it like ["foot"]')
    twice = next((each for k, each in enumerate(interface) if each in interface[:k]), None)
    if twice is not None:
        raise BadInput(source, f"{text.TABLE}.interface", f"names {twice!r} twice", "Name it once")
    for name, one in springs.items():
        alike = (other for other, two in springs.items() if two.at == one.at and two.as_stiff_as(one))
        if (first := next(alike)) != name:
            problem = f"is {first} once more: the same stiffness at the same place"
            raise BadInput(source, f"{text.TABLE}.springs.{name}", problem, "Leave one of them out")
    if support == "base" and not interface and kind == "mesh":
        raise table.wrong("interface", "the groups that the base carries", 'Write interface = ["foot"], or support = "free"')
    held = table.tables("holds", ("nodes", "directions")).items()
    holds = {name: Hold(nodes=each.nodes(), directions=each.directions()) for name, each in held}
    if support == "base" and holds:
        raise table.wrong("holds", "left out where a base carries the structure", 'Leave it out, or write support = "ground"')
    if support == "free" and (interface or holds or any(len(spring.at) == 1 for spring in springs.values())):
        key = "interface" if interface else "holds" if holds else "springs"
        raise table.wrong(key, "left out of a free structure", 'Leave it out, or write support = "ground"')
    on_springs = support == "ground" and any(len(spring.at) == 1 for spring in springs.values())
    if not (interface or on_springs or holds or support == "free"):
        if kind == "mesh":
            raise table.wrong("interface", "", "Name the groups that the ground holds, or springs to it")
        interface = [LOWEST]
    unit = table.table.get("units", "mm" if kind == "assembly" else None)
    word = isinstance(unit, str) and "-" not in unit
    length = toml_file.length_unit(unit, source, text.TABLE + ".units").metres if word else units.unit_system(unit, source).length
    of_parts = table.tables("parts", _PART)
    if not of_parts:
        raise table.wrong("parts", "a table a group", 'Write [fe_model.parts.NAME] with material = "steel"')
    left_out = table.table.get("left_out", [])
    if not isinstance(left_out, list) or not all(isinstance(card, str) for card in left_out):
        raise table.wrong("left_out", "a list of cards or keywords of the mesh file", 'Write it like ["CONM2", "RBE2"]')
    point = table.quantities("reference_point", 3 * ("length",)) if "reference_point" in table.table else np.zeros(3)
    where = table.inner("places")
    return MeshDescription(
        source=source,
        name=str(table.table.get("name") or path.stem),
        kind=kind,
        file=text.file_of(table.table, "file", source, path) or path,
        length=length,
        support=support,
        interface=tuple(interface),
        reference_point=point,
        size=table.quantity("size", "length") if "size" in table.table else None,
        left_out=tuple(left_out),
        parts={name: each.part(loss) for name, each in of_parts.items()},
        places={name: where.at(name) for name in where.table},
        boxes={name: each.box() for name, each in table.tables("groups", ("box",)).items()},
        springs=springs,
        joints={name: each.joint(loss) for name, each in table.tables("joints", ("between", "at", *_TIED)).items()},
        masses={name: each.mass() for name, each in table.tables("masses", ("at", "mass", "cog", "moments")).items()},
        links={name: each.link() for name, each in table.tables("links", _LINK).items()},
        equations={name: tuple(each.sums()) for name, each in table.tables("equations", ("sums",)).items()},
        holds=holds,
        stated=_Table(source=source, where="stated", table=whole.get("stated", {})).stated(),
    )
