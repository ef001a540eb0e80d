"""`written`: effects of a model as a snippet for the deck of Nastran, CalculiX and Abaqus, or OpenSees, in its own units."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path

import numpy as np

from fem.mesh import description as described
from fem.mesh import files
from fem.structure import Structure
from fem.user_model import description as matrices
from fem.user_model import reading
from fem.user_model.parts import GROUND, StatedPart
from fem.user_model.units import SI, UnitSystem, unit_system
from geometry import toml_file
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array, rigid_transformation_6
from geometry.inertia import PARAMETERS, Inertia
from geometry.inertia_files import nastran_field
from identification.quality import NORMAL_90
from validation.effects.catalogue import FAMILIES, Named
from validation.effects.effect import STRUCTURE, joints_named, position
from validation.effects.stages import ALONG
from validation.model.model import Added, Model

FIRST_MATERIAL = 9001
"""Number of the first material and, where the mesh says none, of the first node and element: the user's own are not known."""

NEAR = 1e-6
"""Distance of a node from a place, as a share of the structure's size, below which it is the place."""


UNITS = {"m": "m-kg-N-s", "mm": "mm-t-N-s", "in": "in-lbf-s", "ft": "ft-lbf-s"}
"""By a mesh's unit of length, the system that its deck is taken to have."""


@dataclass(frozen=True, kw_only=True)
class NodeOfDeck:
    """A node of the user's: number, (3,) in the deck's unit, whether it turns, and how it stands for a place, in words."""

    node: int
    point: tuple[float, ...]
    turning: bool
    said: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class PropertyValues:
    """Material of a part as found, in the deck's units, the `thickness` where it changes, and a `number` for it."""

    part: str
    modulus: float
    poisson_ratio: float
    density: float
    loss_factor: float
    thickness: float | None
    number: int


@dataclass(frozen=True, eq=False, kw_only=True)
class Deck:
    """What a description tells of the user's own deck.

    Attributes
    ----------
    path, source : of the description; the file with the nodes, for comments
    units : of the deck
    parts : by name, with what is stated of their material
    springs : by name six stiffnesses (6,) [SI] and their one or two ends
    places : by name, where a mesh or matrices say it
    boxes : corners (2, 3) [m] by name
    mesh : None of matrices, of whose nodes the numbers in `places` are known alone
    elements, nodes : hand out numbers that are new
    masses : by name, where and how heavy
    """

    path: Path
    source: str
    units: UnitSystem
    parts: Mapping[str, StatedPart | described.PartTable]
    springs: Mapping[str, tuple[Array, tuple[described.At, ...]]]
    places: Mapping[str, described.At]
    boxes: Mapping[str, Array]
    mesh: files.MeshFile | None
    elements: Iterator[int]
    nodes: Iterator[int]
    masses: Mapping[str, described.PointMass] = field(default_factory=dict)

    def at(self, place: described.At) -> NodeOfDeck:
        """The node at `place`, or the nearest to it.

        Raises
        ------
        CheckFailed : no node is known.
        """
        name = place
        if isinstance(place, str):
            place = self.places.get(place, place)
        if self.mesh is None:
            if isinstance(place, int):
                return NodeOfDeck(node=place, point=(), turning=True)
            raise CheckFailed(f"{self.source} says no number of a node at {place}: put it there by hand.")
        points, by_kind = self.mesh.points * self.units.length, self.mesh.cells.items()
        among = np.unique(np.concatenate([cells.nodes.ravel() for kind, cells in by_kind if kind != files.POINT]))
        wanted = position(place) if isinstance(place, str) else None if isinstance(place, int) else place
        if isinstance(place, int):
            among = np.flatnonzero(self.mesh.node_tags == place)
        elif wanted is None and place in self.boxes:
            low, high = self.boxes[str(place)]
            among = among[((points[among] >= low) & (points[among] <= high)).all(axis=1)]
        elif wanted is None:
            among = self.mesh.nodes_of(str(place))
        if not len(among):
            raise CheckFailed(f"{self.source} has no node at {place}: put it there by hand.")
        target = points[among].mean(axis=0) if wanted is None else np.array(wanted)
        away = np.linalg.norm(points[among] - target, axis=1)
        index = int(among[np.argmin(away)])
        said = [f"node {self.mesh.node_tags[index]} stands for {name}"]
        if wanted is None and len(among) > 1:
            said[0] += f": of its {len(among)} nodes the nearest to their middle, which all of them carry in massline"
        elif away.min() > NEAR * np.ptp(points, axis=0).max():
            said[0] += f": the nearest, {1e3 * away.min():.4g} mm from it"
        turning = any(np.any(cells.nodes == index) for kind, cells in by_kind if files.DIMENSION[kind] in (1, 2))
        tag, point = int(self.mesh.node_tags[index]), self.mesh.points[index]
        return NodeOfDeck(node=tag, point=tuple(point.tolist()), turning=turning, said=tuple(said))

    @classmethod
    def of(cls, model: Model) -> "Deck":
        """What the FE model of `model` says of its deck.

        Raises
        ------
        BadInput : it has none of the user's own, or its units or nodes are not known.
        """
        path = Path(model.own.get(model.article, next(iter(model.own.values()), "")))
        if path.suffix != ".toml" or not reading.is_model(path):
            problem = "has no FE model of your own that a TOML describes, and massline's own beams stand in no deck"
            raise BadInput(model.source, "fe_model", problem, "Bring a mesh: docs/own-model.md")
        table = toml_file.read(path)[matrices.TABLE]
        new = count(FIRST_MATERIAL)
        if described.described(path):
            found = described.read(path)
            if found.kind != "mesh":
                problem = "is an assembly, which massline meshes anew each time: its nodes stand in no deck"
                raise BadInput(str(path), "fe_model.kind", problem, 'Bring your mesh, kind = "mesh"')
            length, mesh = str(table["units"]), found.mesh()
            system = length if "-" in length else UNITS.get(length, f"{length}-N-s")
            return cls(
                path=path,
                source=found.file.name,
                units=unit_system(system, str(path)),
                parts=found.parts,
                springs={name: (one.stiffness, one.at) for name, one in found.springs.items()},
                places=found.places,
                boxes=found.boxes,
                mesh=mesh,
                elements=count(1 + max(int(cells.tags.max()) for cells in mesh.cells.values())),
                nodes=count(1 + int(mesh.node_tags.max())),
                masses=found.masses,
            )
        if table.get("kind") == "frame":
            return cls(
                path=path,
                source=path.name,
                units=SI,
                parts={},
                springs={},
                places={},
                boxes={},
                mesh=None,
                elements=new,
                nodes=new,
            )
        about = matrices.read_description(path)
        if not about.units.known:
            raise BadInput(str(path), "fe_model.units", "of its matrices nobody knows the units", "State them, as in mm-t-N-s")
        places = {name: place.node for name, place in about.named.places.items() if place.node is not None}
        springs = {
            name: (one.stiffness, tuple(end for end in one.between if end != GROUND))
            for name, one in about.named.joints.items()
            if one.stiffness is not None and set(one.between) <= {*places, GROUND}
        }
        return cls(
            path=path,
            source=path.name,
            units=about.units,
            parts=about.named.parts,
            springs=springs,
            places=places,
            boxes={},
            mesh=None,
            elements=new,
            nodes=count(max((FIRST_MATERIAL - 1, *places.values())) + 1),
        )

    def together(self, effects: Sequence[Added]) -> dict[tuple[str, str], list[Added]]:
        """Effects by what they change together: the properties of a part, the springs of a joint; each other one by itself."""
        found: dict[tuple[str, str], list[Added]] = {}
        for one in effects:
            target, family = "".join(one.named.targets[:1]), one.named.family
            spring = family in ("connection-compliance", "support-stiffness") or (family == "modulus" and target in self.springs)
            kind = SPRING if spring else PART if family in PROPERTIES else ""
            found.setdefault((kind, target if kind else one.named.id), []).append(one)
        return found


class Program(ABC):
    """How a program writes what was found, all numbers in the deck's units.

    Attributes
    ----------
    name, comment, endings : of the program, of its comments and files
    lossy : whether a material may have a loss factor
    products : whether a node may have a mass matrix with products
    """

    name: str
    comment: str
    endings: tuple[str, ...]
    lossy = True
    products = False

    @abstractmethod
    def properties(self, p: PropertyValues) -> list[str]:
        """Cards of a material and, where its thickness changes, the section."""

    @abstractmethod
    def mass(self, deck: Deck, at: NodeOfDeck, mass: float) -> list[str]:
        """Of a mass at a node."""

    @abstractmethod
    def spring(self, deck: Deck, ends: Sequence[NodeOfDeck], axis: int, stiffness: float) -> list[str]:
        """Of a spring along one of six axes, from a node to the ground or between two."""

    def inertia(self, deck: Deck, point: Array, matrix: Array) -> list[str]:
        """Of a mass matrix (6, 6) at a point (3,), where a node may have one."""
        raise NotImplementedError


def written(model: Model, form: str) -> str:
    """The effects of `model` as a snippet of the format `form` of `PROGRAMS`; those that it cannot hold are comments in it.

    Raises
    ------
    BadInput : see `Deck.of`; the model has no effects.
    CheckFailed : none of them can be written.
    """
    if not model.effects:
        raise BadInput(model.source, "effect", "has no effect: nothing was found and added yet", "massline add MODEL EFFECT")

    def told(one: Added) -> str:
        """An effect with its size and interval, in SI."""
        sizes = []
        for key, value in one.named.values.items():
            half = NORMAL_90 * one.deviation.get(key, 0.0)
            between = f" ({value - half:.6g} to {value + half:.6g})" if half else ""
            sizes.append(f"{key + ' ' if key else ''}{value:.6g}{between}")
        unit = next((size.unit for size in FAMILIES[one.named.family].sizes_at(one.named.targets) if size.unit != "1"), "")
        return f"{one.named.id} = {', '.join(sizes)} {unit}".rstrip()

    deck, program = Deck.of(model), PROGRAMS[form]
    pieces, refused = list[tuple[list[str], list[str]]](), list[str]()
    for (kind, name), own in deck.together(model.effects).items():
        try:
            said, cards = _piece(deck, program, kind, name, own)
        except CheckFailed as error:
            refused.append(f"{', '.join(one.named.id for one in own)}: {error}")
        else:
            pieces.append(([*map(told, own), *said], cards))
    if not pieces:
        raise CheckFailed(f"Nothing of {model.source} can be written for {program.name}. {' '.join(refused)}")
    head = [
        f"massline: what was found and added to {Path(model.source).name} ({model.title}), for {program.name}",
        f"units {deck.units.name}; numbers of nodes are those of {deck.source}",
        "a material or section takes the place of its part's; new numbers follow those of the mesh; intervals are of 90 %",
    ]
    lines = [f"{program.comment} {line}" for line in head]
    for said, cards in pieces:
        lines += [program.comment, *(f"{program.comment} {line}" for line in dict.fromkeys(said)), *cards]
    lines += [f"{program.comment} not written: {one}" for one in refused]
    return "\n".join(lines) + "\n"


PART, SPRING = "part", "spring"
"""What several effects change together."""

PROPERTIES = {
    "modulus": "modulus of elasticity",
    "mass": "density",
    "thickness": "thickness",
    "structural-damping": "loss factor",
}
"""By family, the property of a part that it changes."""


def _piece(deck: Deck, program: Program, kind: str, name: str, own: Sequence[Added]) -> tuple[list[str], list[str]]:
    """What is said and what is written of effects that act together.

    Raises
    ------
    CheckFailed : the program has nothing of the kind, or the deck is not known that far; what can be done by hand is said.
    """
    if kind == SPRING:
        return _springs(deck, program, own)
    if kind == PART:
        return _properties(deck, program, name, own)
    one, u = own[0].named, deck.units
    value = one.values.get("", 0.0)
    if one.family == "point-mass":
        at = deck.at(one.targets[0])
        return list(at.said), program.mass(deck, at, value / u.mass)
    if one.family == "cable":
        at = deck.at(one.targets[0])
        axes = ALONG["".join(one.targets[1:])]
        return list(at.said), [card for axis in axes for card in program.spring(deck, (at,), axis, value * u.time**2 / u.mass)]
    if one.family == "rigid-inertia":
        return _rigid(deck, program, one)
    if FAMILIES[one.family].side != STRUCTURE:
        raise CheckFailed("of the measurement, not of the structure; `massline correct` takes some out of the records.")
    raise CheckFailed(f"{FAMILIES[one.family].what}: no property, mass or spring of a deck says that alone.")


def _properties(deck: Deck, program: Program, part: str, own: Sequence[Added]) -> tuple[list[str], list[str]]:
    by = {one.named.family: one for one in own}
    factor = {family: 1 + one.named.values[""] for family, one in by.items()}
    if part in deck.masses:
        body = deck.masses[part]
        at, drawn, turned = deck.at(body.at), body.inertia.mass, np.any(body.inertia.mass_matrix[3:, 3:])
        aside = body.inertia.cog - body.inertia.reference_point
        hand = (
            [f"its centre of gravity is {', '.join(f'{x / deck.units.length:.6g}' for x in aside)} beside the node: put it there"]
            if np.any(aside)
            else []
        )
        hand += (
            [f"its moments of inertia grow by the same share: multiply them by {factor['mass']:.6g} by hand"] if turned else []
        )
        said = [
            *at.said,
            f"mass of {part}: was {drawn:.6g} kg, found {drawn * factor['mass']:.6g} kg; this is the difference",
            *hand,
        ]
        return said, program.mass(deck, at, (factor["mass"] - 1) * drawn / deck.units.mass)
    table = deck.parts.get(part)
    material = None if table is None else table.material
    layered = isinstance(table, described.PartTable) and table.laminate is not None
    if table is None or layered or material is None or material.youngs_modulus is None or material.poisson_ratio is None:
        hand = [
            f"multiply the {PROPERTIES[family]} of {'each layer of ' if layered else ''}{part} by {value:.6g}"
            for family, value in factor.items()
            if family != "structural-damping"
        ]
        what = f"{part} is of layers" if layered else f"{deck.source} states no material of {part}"
        raise CheckFailed(f"{what}. By hand: {', '.join(hand) or 'raise its loss factor'}.")
    if "thickness" in by and table.thickness is None:
        raise CheckFailed(f"{part} is of beams: multiply the height of its section, or its wall, by {factor['thickness']:.6g}.")
    u, lost = deck.units, table.loss_factor or 0.0
    added = by["structural-damping"].named.values[""] if "structural-damping" in by else 0.0
    before = {
        "modulus": material.youngs_modulus * u.length * u.time**2 / u.mass,
        "mass": material.density * u.length**3 / u.mass,
        "thickness": (table.thickness or 0.0) / u.length,
        "structural-damping": lost,
    }
    said = []
    for family, one in by.items():
        sd = one.deviation.get("", 0.0)
        value, half = one.named.values[""], NORMAL_90 * sd
        ends = [
            (before[family] + x if family == "structural-damping" else before[family] * (1 + x))
            for x in (value - half, value, value + half)
        ]
        between = f" ({ends[0]:.6g} to {ends[2]:.6g})" if sd else ""
        said.append(f"{PROPERTIES[family]} of {part}: was {before[family]:.6g}, found {ends[1]:.6g}{between}")
    found = PropertyValues(
        part=part,
        modulus=before["modulus"] * factor.get("modulus", 1.0),
        poisson_ratio=material.poisson_ratio,
        density=before["mass"] * factor.get("mass", 1.0),
        loss_factor=lost + added,
        thickness=before["thickness"] * factor.get("thickness", 1.0) if "thickness" in by else None,
        number=FIRST_MATERIAL + list(deck.parts).index(part),
    )
    if added and not program.lossy:
        if len(by) == 1:
            problem = (
                f"{program.name} has no structural damping of a material: set a modal damping, loss factor {lost + added:.6g}."
            )
            raise CheckFailed(problem)
        said.append(f"{program.name} has no structural damping of a material: the loss factor is not written")
    return said, program.properties(found)


def _springs(deck: Deck, program: Program, own: Sequence[Added]) -> tuple[list[str], list[str]]:
    """Springs to the ground or between two nodes as they are found to be: a factor on all, compliances in series by axis."""
    u = deck.units
    said, cards = [], []
    for name in joints_named(own[0].named.targets[0], tuple(deck.springs)):
        if name not in deck.springs:
            raise CheckFailed(f"{deck.source} says nothing of {name} as a spring between nodes: give it this compliance by hand.")
        stiffness, places = deck.springs[name]
        scale, soft = 1.0, np.zeros(6)
        for one in own:
            value = one.named.values[""]
            if one.named.family == "connection-compliance":
                soft[MOTIONS.index(one.named.targets[1])] += value
            else:
                scale *= value + (one.named.family == "modulus")
        found = scale * stiffness / (1 + soft * scale * stiffness)
        ends = tuple(deck.at(place) for place in places)
        said += [line for end in ends for line in end.said]
        size = np.array([u.mass / u.time**2] * 3 + [u.energy] * 3)
        for axis in np.flatnonzero(stiffness):
            said.append(f"{name} {MOTIONS[axis]}: was {stiffness[axis] / size[axis]:.6g}, found {found[axis] / size[axis]:.6g}")
            cards += program.spring(deck, ends, int(axis), found[axis] / size[axis])
        said.append(f"these take the place of the springs of {name}")
    return said, cards


def _rigid(deck: Deck, program: Program, named: Named) -> tuple[list[str], list[str]]:
    if not program.products:
        raise CheckFailed(f"a node of {program.name} has no mass matrix with products: change mass and inertia in the mesh.")
    structure = reading.read(deck.path)
    if not isinstance(structure, Structure) or structure.floating or structure.grounded:
        raise CheckFailed("no node moves as the body as a whole but the base of a structure that is held by it.")
    m, u = structure.rigid_mass, deck.units
    cog = np.array([m[1, 5], m[2, 3], m[0, 4]]) / m[0, 0]
    unit = np.array([named.values[""] * (one == named.targets[0]) for one in PARAMETERS])
    E = Inertia(parameters=unit, reference_point=np.zeros(3)).mass_matrix
    G = rigid_transformation_6(cog)
    size = np.array([1.0, 1.0, 1.0, *3 * [u.length]])
    said = ["a node at the reference point, which rides on the base: tie it to what the base carries as one rigid body"]
    return said, program.inertia(deck, structure.reference_point / u.length, G.T @ E @ G / u.mass / np.outer(size, size))


def real(value: float) -> str:
    """Twelve digits with a point: without one CalculiX takes the stiffness of a spring for a direction."""
    mantissa, exponent, power = f"{value:.12g}".partition("e")
    return f"{mantissa}{'' if '.' in mantissa else '.'}{exponent}{power}"


# Programs. Numbers of new elements and nodes are handed out by the deck, one after the other.


def _nastran(word: str, *fields: object) -> list[str]:
    """A card in large fields, four a line."""
    cells = [16 * " " if one is None else nastran_field(one) if isinstance(one, float) else f"{one!s:>16}" for one in fields]
    rows = ["".join(cells[k : k + 4]) for k in range(0, len(cells), 4)]
    rows += [""] * (len(rows) % 2)  # large fields come by two lines
    return [f"{word + '*' if k == 0 else '*':<8}{row}".rstrip() for k, row in enumerate(rows)]


class _Nastran(Program):
    name, comment, endings, products = "Nastran", "$", (".bdf", ".dat", ".nas"), True

    def properties(self, p: PropertyValues) -> list[str]:
        lost = p.loss_factor or None
        cards = _nastran("MAT1", p.number, p.modulus, None, p.poisson_ratio, p.density, None, None, lost)
        return cards + (_nastran("PSHELL", p.number, p.number, p.thickness, p.number, None, p.number) if p.thickness else [])

    def mass(self, deck: Deck, at: NodeOfDeck, mass: float) -> list[str]:
        return _nastran("CONM2", next(deck.elements), at.node, None, mass)

    def spring(self, deck: Deck, ends: Sequence[NodeOfDeck], axis: int, stiffness: float) -> list[str]:
        fields = [value for end in ends for value in (end.node, axis + 1)]
        return _nastran("CELAS2", next(deck.elements), stiffness, *fields)

    def inertia(self, deck: Deck, point: Array, matrix: Array) -> list[str]:
        node = next(deck.nodes)
        lower = [float(matrix[i, j]) for i in range(6) for j in range(i + 1)]
        return _nastran("GRID", node, None, *map(float, point)) + _nastran("CONM1", next(deck.elements), node, None, *lower)


class _Abaqus(Program):
    name, comment, endings = "CalculiX and Abaqus", "**", (".inp",)

    def properties(self, p: PropertyValues) -> list[str]:
        lines = [
            f"*MATERIAL, NAME={p.part}",
            "*ELASTIC",
            f"{real(p.modulus)}, {real(p.poisson_ratio)}",
            "*DENSITY",
            real(p.density),
        ]
        lines += [f"*DAMPING, STRUCTURAL={real(p.loss_factor)}"] if p.loss_factor else []
        return lines + ([f"*SHELL SECTION, ELSET={p.part}, MATERIAL={p.part}", real(p.thickness)] if p.thickness else [])

    def mass(self, deck: Deck, at: NodeOfDeck, mass: float) -> list[str]:
        n = next(deck.elements)
        return [f"*ELEMENT, TYPE=MASS, ELSET=MASSLINE_{n}", f"{n}, {at.node}", f"*MASS, ELSET=MASSLINE_{n}", real(mass)]

    def spring(self, deck: Deck, ends: Sequence[NodeOfDeck], axis: int, stiffness: float) -> list[str]:
        n, kind = next(deck.elements), f"SPRING{len(ends)}"
        nodes, dofs = ", ".join(str(end.node) for end in ends), ", ".join(str(axis + 1) for _ in ends)
        head = f"*ELEMENT, TYPE={kind}, ELSET=MASSLINE_{n}"
        return [head, f"{n}, {nodes}", f"*SPRING, ELSET=MASSLINE_{n}", dofs, real(stiffness)]


class _OpenSees(Program):
    name, comment, endings, lossy = "OpenSees", "#", (".tcl",), False

    def properties(self, p: PropertyValues) -> list[str]:
        thick = (p.thickness,) if p.thickness else ()
        kind = "section ElasticMembranePlateSection" if thick else "nDMaterial ElasticIsotropic"
        return [f"{kind} {p.number} " + " ".join(map(real, (p.modulus, p.poisson_ratio, *thick, p.density)))]

    def mass(self, deck: Deck, at: NodeOfDeck, mass: float) -> list[str]:
        return [f"mass {at.node} " + " ".join([real(mass)] * 3 + ["0"] * 3 * at.turning)]

    def spring(self, deck: Deck, ends: Sequence[NodeOfDeck], axis: int, stiffness: float) -> list[str]:
        n, lines, other = next(deck.elements), list[str](), ends[-1].node
        if len(ends) == 1:
            if not ends[0].point:
                by_hand = "where the held node would stand: add it by hand."
                raise CheckFailed(f"{deck.source} says no coordinates of node {other}, {by_hand}")
            other = next(deck.nodes)
            size = 6 if ends[0].turning else 3
            lines = [f"node {other} {' '.join(map(repr, ends[0].point))}", f"fix {other} {' '.join(size * '1')}"]
        return [
            *lines,
            f"uniaxialMaterial Elastic {n} {real(stiffness)}",
            f"element zeroLength {n} {other} {ends[0].node} -mat {n} -dir {axis + 1}",
        ]


PROGRAMS: Mapping[str, Program] = {"nastran": _Nastran(), "calculix": _Abaqus(), "opensees": _OpenSees()}
"""What can be written, by the word of ``--as``."""
