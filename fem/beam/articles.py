"""Beam models of the built-in articles and their stacks, in milliseconds: the model that fitting uses.

Clumod is a frame, Cuboid and disc are stiff columns, the FMD's moving part is rigid. What stands on something stands on its top
node, rigidly. The base holds the lowest body: Clumod's flange, the foot of a column, the FMD's cover plate or, when its load
cells are springs, what is below them.
"""

import copy
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from itertools import pairwise
from operator import sub
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from fem.beam import frame
from fem.beam.elements import Sandwich, Section, rectangle, sandwich, tube
from fem.beam.frame import Body, Frame, Member, Plan, Ports, assemble, on_top, placed
from fem.factorisers import factorise
from fem.structure import Structure, hold, rigid_motion
from geometry import cache
from geometry.article import Article, Part, Shape, material, prefixes
from geometry.article import rectangle as corners
from geometry.articles import built_in, changes_of, dimension_files
from geometry.articles.parts import FOUR_BLADES, ONE_BLADE, Dimensions, build_clumod, load
from geometry.errors import BadInput
from geometry.frames import Array, Integers, Pose, frozen, rigid_transformation, rigid_transformation_6
from geometry.inertia import Inertia
from geometry.routes import inertia as drawn_inertia
from geometry.toml_file import nearest

# Cuboid and disc as stiff columns of their section, the FMD as a rigid cover plate, on springs when asked.

AXES = ("x", "y", "z")
REFINED = 3
"""Elements in a column for one in a half-blade: it is stubby, and there shear converges slowly."""


def _cells_refused(problem: str) -> BadInput:
    return BadInput("load cells of the FMD", "cells", problem, "Give (4, 3) values in N/m")


def _column(article: Article, section: Section, height: float, elements: int) -> Plan:
    """One part standing up from the origin; its holes are taken off as a rigid body at its foot."""
    (part,), elements = article.parts, REFINED * elements
    nodes = np.linspace([0.0, 0.0, 0.0], [0.0, 0.0, height], elements + 1)
    member = Member(nodes=tuple(range(elements + 1)), section=section, z_axis=np.array([1.0, 0.0, 0.0]), part=part.name)
    holes = drawn_inertia(article) - frame.inertia(member, nodes)
    loss = part.material.loss_factor
    return Plan(
        nodes=nodes,
        carriers=tuple(range(elements + 1)),
        members=(member,),
        bodies=(Body(node=0, inertia=holes),),
        top=elements,
        loss_factors={} if loss is None else {part.name: loss},
    )


# Clumod as a frame: mast and half-blades are beams, flange, hubs and what is clamped between their collars are rigid.
#
# A hub holds its blade between two collars. Over their height the mast is rigid, and a half-blade begins not at the mast's axis
# but at `reach` from it. All that the beams do not have of the real parts - collars, the blade's middle with its holes for mast
# and bolts - is a rigid body on the hub, drawing less beams, so that the frame carries the mass of the drawing exactly. Where a
# blade has been taken off, its two collars stay, a tube's gap apart.
#
# What a rigid hub cannot say - the collars' own give, the blade that is wider than they are - enters as `Joint`: matrices on
# ports, from a local solid model of the crossing.

ELEMENTS = 6
"""In a half-blade; the mast, three times as long and stiffer, has twice as many."""

MAST = "mast"
X, Y, Z = np.eye(3)
BLADE_AXES = {"x": X, "y": Y}

RIGID_ROUNDING = 1e-6
"""Share of a joint's stiffness that a rigid motion of all its ports may meet, which is what condensation loses to rounding."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Port:
    """A place on a beam of Clumod, where a node is put for it.

    Attributes
    ----------
    member : "mast" or the name of a blade
    at : [m] height on the mast above Clumod's origin; on a blade the distance from the mast's axis, negative on its other side
    """

    member: str
    at: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Joint:
    """What a local model adds to the frame between ports, in Clumod's axes.

    Attributes
    ----------
    ports : k of them
    stiffness : (6 k, 6 k) symmetric, x, y, z, alpha, beta, gamma of the first port, then of the second ...; rigid motions of all
        ports together cost nothing
    mass : (6 k, 6 k) symmetric; zero by default, and without rigid mass when the frame shall weigh what the drawing weighs
    part : whose stiffness and loss factor it is
    """

    ports: tuple[Port, ...]
    stiffness: Array
    mass: Array | None = None
    part: str = MAST

    def __post_init__(self) -> None:
        size = 6 * len(self.ports)
        for name in ("stiffness",) if self.mass is None else ("stiffness", "mass"):
            matrix = frozen(getattr(self, name), (size, size), name)
            if not np.allclose(matrix, matrix.T, rtol=0, atol=1e-9 * np.abs(matrix).max(initial=0)):
                raise BadInput("joint of Clumod", name, "must be symmetric", "Check the order of ports")
            object.__setattr__(self, name, matrix)


def reach(radius: float, thickness: float) -> float:
    """Distance [m] from the mast's axis at which a half-blade of `thickness` between collars of `radius` begins to bend.

    The collars end at their radius; a plate is not held rigidly at the edge of what clamps it but yields over a length of the
    order of its thickness. Local solid models (`fem.beam.articles`) give 0.9 to 1.4 thicknesses between the thick collars of
    the lower blades; one is taken. Thin collars and the mast's wall yield more: that is left to the joints.
    """
    return radius - thickness


def clumod_plan(blades: Sequence[str], d: Dimensions, *, joints: Sequence[Joint] = (), elements: int = ELEMENTS) -> Plan:
    """Clumod with the `blades` named; node 0 is the flange, at the article's origin.

    Raises
    ------
    BadInput : hubs that overlap, a joint on a port that does not exist, a section that is none.
    """
    article, pieces = build_clumod(tuple(blades), d), _rigid_pieces(blades, d)
    foot, mast = d["flange"]["height"], d["mast"]
    asked = [port for joint in joints for port in joint.ports]
    ends = {MAST: (foot, mast["top"])}
    ends |= {blade["name"]: _ends(blade, d) for blade in d["blade"] if blade["name"] in blades}
    for port in asked:  # each must lie on a beam that is there
        if port.member not in ends:
            raise _joints_refused(f"there is no {port.member!r}", f"{nearest(port.member, ends)}Known are {', '.join(ends)}")
        first, last = ends[port.member]
        if not first <= (port.at if port.member == MAST else abs(port.at)) <= last:
            known = f"Its beam goes from {1e3 * first:.1f} to {1e3 * last:.1f} mm"
            raise _joints_refused(f"{port.member} is no beam at {1e3 * port.at:g} mm", known)
    nodes = _Nodes()
    nodes.put(np.zeros(3), carrier=0)
    for piece in pieces:
        nodes.put(piece.middle * Z)
    # Nodes of the mast: the flange, the ends of rigid pieces (a collar may stand out beyond the top), those asked for, the top,
    # and enough between; what lies within a rigid piece rides on it
    edges = [min(end, mast["top"]) for piece in pieces for end in (piece.bottom, piece.top)]
    fixed = sorted({foot, mast["top"], *edges, *(port.at for port in asked if port.member == MAST)})
    chain = []
    for height in _between(fixed, (fixed[-1] - fixed[0]) / (2 * elements)):
        carrier = next((1 + index for index, piece in enumerate(pieces) if piece.bottom <= height <= piece.top), None)
        chain.append(nodes.put(height * Z, 0 if height == foot else carrier))
    section = tube(mast["outer_diameter"], mast["inner_diameter"], material(mast["material"]))
    members = [Member(nodes=tuple(chain), section=section, z_axis=X, part=MAST)]
    for station, piece in enumerate(pieces, start=1):
        blade = d["blade"][piece.number]
        if blade["name"] in blades:
            members += [_half_blade(blade, d, side, station, asked, elements, nodes) for side in (1, -1)]
    points = np.array(nodes.points)
    elastic = [part for part in article.parts if part.name != "flange" and not part.name.startswith("hub-")]
    return Plan(
        nodes=points,
        carriers=tuple(nodes.carriers),
        members=tuple(members),
        bodies=tuple(_bodies(article, d, pieces, members, points)),
        ports=tuple(_ports(joint, d, points) for joint in joints),
        loss_factors={part.name: part.material.loss_factor for part in elastic if part.material.loss_factor is not None},
    )


class _Nodes:
    """The nodes of a plan while it grows."""

    def __init__(self) -> None:
        self.points: list[Array] = []
        self.carriers: list[int] = []

    def put(self, point: Array, carrier: int | None = None) -> int:
        """Add a node at `point` that rides on `carrier`, or moves on its own; its index."""
        index = len(self.points)
        self.points.append(point)
        self.carriers.append(index if carrier is None else carrier)
        return index


@dataclass(frozen=True, eq=False, kw_only=True)
class _Rigid:
    """A piece of the mast that is rigid from `bottom` to `top`, riding on a node at `middle` [m]; `number` of its blade."""

    bottom: float
    middle: float
    top: float
    number: int


def _rigid_pieces(blades: Sequence[str], d: Dimensions) -> list[_Rigid]:
    """Where collars make the mast rigid, from the bottom: one piece with the blade between them, two without."""
    pieces = []
    for number, blade in enumerate(d["blade"]):
        z, t = blade["z"], blade["thickness"] / 2
        h = t + blade["hub_height"] / 2
        ends = [(-h, h)] if blade["name"] in blades else [(-h, -t), (t, h)]
        pieces += [_Rigid(bottom=z + a, middle=z + (a + b) / 2, top=z + b, number=number) for a, b in ends]
    pieces.sort(key=lambda piece: piece.bottom)
    edges = [d["flange"]["height"], *(edge for piece in pieces for edge in (piece.bottom, piece.top))]
    for lower, upper in pairwise(edges):
        if upper < lower:
            problem = f"hubs must lie on the mast and apart, found {1e3 * lower:g} mm above {1e3 * upper:g} mm"
            raise BadInput("clumod.toml", "blade.z", problem, "Move the blade or make its hub lower")
    return pieces


def _half_blade(
    blade: Dimensions, d: Dimensions, side: int, station: int, asked: list[Port], elements: int, nodes: _Nodes
) -> Member:
    """One half of a blade, on the positive or the negative `side` of its axis, from its root to its tip."""
    root, tip = _ends(blade, d)
    own = [side * port.at for port in asked if port.member == blade["name"] and side * port.at > 0]
    distances = _between(sorted({root, tip, *own}), (tip - root) / elements)
    places = [blade["z"] * Z + side * distance * BLADE_AXES[blade["axis"]] for distance in distances]
    chain = [nodes.put(places[0], station), *(nodes.put(place) for place in places[1:])]
    steel, w, t = material(d["blades"]["material"]), blade["width"], blade["thickness"]
    section: Section | Sandwich = rectangle(w, t, steel)
    if layer := blade.get("layer"):
        names = (f"{blade['name']}-bottom", f"{blade['name']}-silicone", f"{blade['name']}-top")
        section = sandwich(w, t, layer["thickness"], steel, material(layer["material"]), names)
    return Member(nodes=tuple(chain), section=section, z_axis=Z, part=blade["name"], bonded=frozenset(chain[:1]))


def _ends(blade: Dimensions, d: Dimensions) -> tuple[float, float]:
    """Distances [m] from the mast's axis at which a half-blade begins and ends."""
    return reach(d["hubs"]["outer_diameter"] / 2, blade["thickness"]), blade["length"] / 2


def _between(fixed: list[float], step: float) -> list[float]:
    """`fixed`, ascending, and what divides the gaps evenly into pieces not much longer than `step`."""
    gaps = [np.linspace(a, b, max(1, round((b - a) / step)), endpoint=False).tolist() for a, b in pairwise(fixed)]
    return [*(value for gap in gaps for value in gap), fixed[-1]]


def _bodies(article: Article, d: Dimensions, pieces: list[_Rigid], members: list[Member], nodes: Array) -> list[Body]:
    """What the beams lack: the flange, and on every rigid piece its collars and the blade as drawn less the blade's beams."""
    drawn = {part.name: part for part in article.parts}
    bodies = [Body(node=0, inertia=_drawn([drawn["flange"]]))]
    for station, piece in enumerate(pieces, start=1):
        blade, hub = d["blade"][piece.number]["name"], drawn[f"hub-{piece.number + 1}"]
        own = [part for name, part in drawn.items() if name == blade or name.startswith(f"{blade}-")]
        # The collars of the hub that belong to the piece
        solids, voids = (
            tuple(p for p in placed_ones if piece.bottom <= p.pose.position[2] <= piece.top)
            for placed_ones in (hub.shape.solids, hub.shape.voids)
        )
        collars = replace(hub, shape=Shape(solids=solids, voids=voids))
        beams = [frame.inertia(member, nodes) for member in members if member.part == blade]
        bodies.append(Body(node=station, inertia=reduce(sub, beams, _drawn([collars, *own]))))
    return bodies


def _drawn(parts: Iterable[Part]) -> Inertia:
    return drawn_inertia(Article(name="rigid", parts=tuple(parts)))


def _ports(joint: Joint, d: Dimensions, nodes: Array) -> Ports:
    mass = np.zeros_like(joint.stiffness) if joint.mass is None else joint.mass
    chosen = tuple(nearest_node(place(port, d), nodes) for port in joint.ports)
    carried = np.abs(joint.stiffness @ rigid_motion(nodes[list(chosen)])).max(initial=0)
    if carried > RIGID_ROUNDING * np.abs(joint.stiffness).max(initial=0):
        problem = f"must let its ports move together rigidly, found a force or moment of {carried:.3g} for a unit motion"
        remedy = "Check that the ports lie where the local model has them, in Clumod's axes"
        raise BadInput("joint of Clumod", "stiffness", problem, remedy)
    return Ports(nodes=chosen, stiffness=joint.stiffness, mass=mass, part=joint.part)


def nearest_node(there: Array, nodes: Array) -> int:
    """Index of the one of `nodes` (n, 3) that lies nearest to the place `there` (3,) [m]."""
    return int(np.argmin(np.linalg.norm(nodes - there, axis=1)))


def place(port: Port, d: Dimensions) -> Array:
    """Where `port` is (3,) [m], in Clumod's frame."""
    if port.member == MAST:
        return port.at * Z
    blade = next(blade for blade in d["blade"] if blade["name"] == port.member)
    return np.asarray(blade["z"] * Z + port.at * BLADE_AXES[blade["axis"]])


def _joints_refused(problem: str, remedy: str) -> BadInput:
    return BadInput("joint of Clumod", "port", problem, remedy)


NO_CHANGES: Mapping[str, float] = MappingProxyType({})
BASE = 6
"""The first degrees of freedom are those of the base."""

BLADES = {"clumod-1": ONE_BLADE, "clumod-4": FOUR_BLADES}


def structure(
    article_name: str,
    changes: Mapping[str, float] = NO_CHANGES,
    *,
    elements: int = ELEMENTS,
    cells: npt.ArrayLike | None = None,
    joints: Sequence[Joint] = (),
) -> Structure:
    """Beam model of the built-in article or stack called `article_name`, about its origin.

    Parameters
    ----------
    article_name, changes : as `geometry.articles.built_in` takes them
    elements : in a half-blade of Clumod; its mast has twice, a column three times as many
    cells : (4, 3) [N/m] stiffness of the FMD's load cells along x, y, z (`load_cells` gives assumed values); rigid when None
    joints : what a local model of Clumod's crossings adds

    Raises
    ------
    BadInput : an article, a dimension, a port or a material that cannot be used; the message says why.
    """
    return _structure(assemble(article_plan(article_name, changes, elements=elements, cells=cells, joints=joints)))


def article_plan(
    article_name: str,
    changes: Mapping[str, float] = NO_CHANGES,
    *,
    elements: int = ELEMENTS,
    cells: npt.ArrayLike | None = None,
    joints: Sequence[Joint] = (),
) -> Plan:
    """What the frame of `structure` is made of, from the same arguments; other programs make their own elements of it.

    Raises
    ------
    BadInput : as `structure`.
    """
    built_in(article_name, changes)  # checks names, order and changes of the whole stack
    names = article_name.split("+")
    if elements < 1:
        remedy = "Give a whole number from 1 on"
        raise _refused(article_name, "elements", f"at least one element is needed, found {elements}", remedy)
    if cells is not None and "fmd" not in names:
        remedy = "Name a stack that begins with fmd"
        raise _refused(article_name, "cells", "there is no FMD whose load cells could be springs", remedy)
    if joints and not BLADES.keys() & set(names):
        raise _refused(article_name, "joints", "there is no Clumod whose crossings could have joints", "Leave the joints away")
    plans = [_plan(name, changes, elements, cells, joints) for name in names]
    if len(plans) == 1:
        return plans[0]
    # Each goes where the seats below put it; seats have parallel axes. Names of parts are those of the stacked article.
    pose, in_place = Pose(), []
    for name, prefix, plan in zip(names, prefixes(names), plans, strict=True):
        in_place.append(placed(plan, pose.position, f"{prefix}/"))
        seat = _article(name, changes).seat
        pose = pose @ seat if seat else pose
    return reduce(on_top, in_place)


def load_cells(changes: Mapping[str, float] = NO_CHANGES) -> Array:
    """Assumed stiffness (4, 3) along x, y, z [N/m] of the FMD's load cells, labelled so in `fmd.toml`."""
    cell = load("fmd", changes)["load_cell"]
    return np.tile([cell["lateral_stiffness_N_m"], cell["lateral_stiffness_N_m"], cell["axial_stiffness_N_m"]], (4, 1))


def _plan(name: str, changes: Mapping[str, float], elements: int, cells: npt.ArrayLike | None, joints: Sequence[Joint]) -> Plan:
    """One article in its own frame."""
    (file,) = dimension_files(name)
    article, d = _article(name, changes), load(file, changes)
    if name in BLADES:
        return clumod_plan(BLADES[name], d, joints=joints, elements=elements)
    if name == "cuboid":
        x, y, z = d["size"]
        return _column(article, rectangle(y, x, material(d["material"])), z, elements)
    if name == "disc":  # a column far wider than high, whose give is nearly all shear and stretch of its height
        return _column(article, tube(d["diameter"], 0.0, material(d["material"])), d["height"], elements)
    # The FMD's moving part about F: on its base, or on springs in the middle of the load cells
    body = drawn_inertia(article)
    if cells is None:
        return Plan(nodes=np.zeros((1, 3)), carriers=(0,), bodies=(Body(node=0, inertia=body),))
    stiffness = np.asarray(cells, dtype=np.float64)
    if stiffness.shape != (4, 3):
        raise _cells_refused(f"four cells with three stiffnesses each are needed, found shape {stiffness.shape}")
    for (cell, axis), value in np.ndenumerate(stiffness):
        if not 0 < value < np.inf:
            found = f"must have a positive, finite stiffness along {AXES[axis]}, found {value:g} N/m"
            raise _cells_refused(f"cell {cell + 1} {found}")
    springs, square = [], d["load_cell"]["square"]
    for number, ((x, y), along) in enumerate(zip(corners(square, square), stiffness, strict=True), start=1):
        G = rigid_transformation([x, y, 0.0])
        k = G.T @ np.diag(along) @ G
        between = np.block([[k, -k], [-k, k]])
        springs.append(Ports(nodes=(0, 1), stiffness=between, mass=np.zeros((12, 12)), part=f"cell-{number}"))
    loss = material(d["load_cell"]["material"]).loss_factor
    return Plan(
        nodes=np.zeros((2, 3)),
        carriers=(0, 1),
        bodies=(Body(node=1, inertia=body),),
        ports=tuple(springs),
        top=1,
        loss_factors={} if loss is None else {spring.part: loss for spring in springs},
    )


def _article(name: str, changes: Mapping[str, float]) -> Article:
    return built_in(name, changes_of(name, changes))


def _structure(frame: Frame) -> Structure:
    from scipy.sparse import csr_array

    parts = {part: csr_array(k) for part, k in frame.stiffness.items()}
    moving = list(frame.moving)
    return Structure(
        stiffness=csr_array(sum(frame.stiffness.values(), np.zeros_like(frame.mass))),
        mass=csr_array(frame.mass),
        rigid=frame.rigid,
        held=np.arange(BASE),
        points=frame.plan.nodes[moving],
        translations=6 * np.arange(len(moving))[:, None] + np.arange(3),
        rotations=6 * np.arange(len(moving))[:, None] + np.arange(3, 6),
        part_stiffness=MappingProxyType(parts),
        loss_factors=MappingProxyType(dict(frame.plan.loss_factors)),
    )


def _refused(whole: str, field: str, problem: str, remedy: str) -> BadInput:
    return BadInput(f"article {whole}", field, problem, remedy)


# Joints of Clumod's beam model from local solid models: what hub, blade roots and mast do that beams and rigid hubs do not.
#
# A crossing is cut out of the drawing: a piece of the mast with its hubs and the roots of its blades, no frequency in sight. It
# is built twice from the same dimensions, as hexahedra and as the beam model's own beams, both held at the lower end of the
# mast. Unit loads at the other ends - the ports - give the flexibility of each, 6 x 6 a port; ends of the solid carry and report
# them as the mean over the cut section. The difference of the two stiffnesses, expanded to all ports by rigid motion, is the
# joint: added to the beams it gives them the flexibility of the solid, and nothing else. The mast's foot on the elastic flange
# is a joint as well.

STUB = 0.75
"""Length of a blade's root beyond the collars, in widths of the blade: where the plate has become a beam."""

SLEEVE = 1.0
"""Length of mast beyond the collars, in diameters of the mast."""

SAME = 1e-7
"""Nodes closer to a cut than this [m] lie in it."""

ELEMENTS_AT_CROSSING = 24
"""Of a half-blade in the local beam model, which shall be exact."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ClumodPiece:
    """A piece of Clumod between two heights of the mast.

    Attributes
    ----------
    dimensions : as of a Clumod that ends where the piece ends; its flange reaches up to the lower end, unless `foot`
    blades : names of those whose roots belong to the piece
    ports : its free ends
    base : (3,) [m] where its lowest beam begins, which moves with what holds the piece
    foot : whether the flange itself belongs to it, held at its underside
    """

    dimensions: Dimensions
    blades: tuple[str, ...]
    ports: tuple[Port, ...]
    base: Array
    foot: bool = False


def joints(blades: Sequence[str], d: Dimensions, *, size: float = 0.02) -> tuple[Joint, ...]:
    """The joints of Clumod with the `blades` named, for `clumod_plan`; `size` [m]: cells of the local solids.

    Raises
    ------
    BadInput, CheckFailed : a local solid that cannot be meshed or factorised.
    """
    return tuple(joint(piece, d, size) for piece in pieces(blades, d))


def joint(piece: ClumodPiece, d: Dimensions, size: float) -> Joint:
    """What the solid `piece` adds to the stiffness of its beams, between its lower end and its ports."""
    added = np.linalg.inv(_kept_flexibility(piece, size)) - np.linalg.inv(beam_flexibility(piece))
    T = np.hstack([-np.vstack([rigid_transformation_6(place(port, d) - piece.base) for port in piece.ports]), np.eye(len(added))])
    held = Port(member=MAST, at=float(piece.base[2]))
    return Joint(ports=(held, *piece.ports), stiffness=T.T @ ((added + added.T) / 2) @ T)


def pieces(blades: Sequence[str], d: Dimensions) -> Iterator[ClumodPiece]:
    """The foot of the mast, then its hubs from bottom to top, neighbours in one piece when they stand close together."""
    sleeve = SLEEVE * d["mast"]["outer_diameter"]
    foot = d["flange"]["height"]
    top = foot + sleeve
    own: Dimensions = {**copy.deepcopy(d), "blade": [], "mast": {**d["mast"], "top": top}}
    ends = (Port(member=MAST, at=top),)
    yield ClumodPiece(dimensions=own, blades=(), ports=ends, base=np.array([0.0, 0.0, foot]), foot=True)
    groups: list[list[Dimensions]] = []  # hubs whose sleeves would run into one another
    for blade in sorted(d["blade"], key=lambda blade: float(blade["z"])):
        if groups and _collar_span(blade)[0] - _collar_span(groups[-1][-1])[1] < 2 * sleeve:
            groups[-1].append(blade)
        else:
            groups.append([blade])
    for group in groups:
        low, high = _collar_span(group[0])[0] - sleeve, _collar_span(group[-1])[1] + sleeve
        crossed = tuple(b["name"] for b in group if b["name"] in blades)
        upper = min(high, d["mast"]["top"])
        own = copy.deepcopy(d)
        own["flange"] |= {"height": low}
        own["mast"] |= {"top": upper}
        own["blade"] = [{**blade, "length": 2 * _end(blade, d)} for blade in group]
        ports = [Port(member=b["name"], at=side * _end(b, d)) for b in group if b["name"] in crossed for side in (1, -1)]
        if upper < d["mast"]["top"]:
            ports.append(Port(member=MAST, at=upper))
        piece = ClumodPiece(dimensions=own, blades=crossed, ports=tuple(ports), base=np.array([0.0, 0.0, low]))
        if piece.ports:  # bare collars at the end of the mast carry nothing
            yield piece


def beam_flexibility(piece: ClumodPiece) -> Array:
    """Displacements and rotations of the ports (6 k, 6 k) for unit forces and moments there, by the beam model."""
    frame = assemble(clumod_plan(piece.blades, piece.dimensions, elements=ELEMENTS_AT_CROSSING))
    stiffness = sum(frame.stiffness.values(), np.zeros_like(frame.mass))
    moving = frame.plan.nodes[list(frame.moving)]
    nodes = [nearest_node(place(port, piece.dimensions), moving) for port in piece.ports]
    dofs = np.concatenate([6 * node + np.arange(6) for node in nodes])
    free = np.arange(6, len(stiffness))
    loads = np.zeros((len(stiffness), len(dofs)))
    loads[dofs, np.arange(len(dofs))] = 1.0
    return np.asarray(np.linalg.solve(stiffness[np.ix_(free, free)], loads[free])[dofs - 6])


def solid_flexibility(piece: ClumodPiece, size: float) -> Array:
    """The same by hexahedra."""
    solid = _solid(piece, size)
    held = hold(solid)
    # Mass (N,) that moves with every degree of freedom when all of the solid goes along with it
    shares = np.asarray((solid.mass @ np.tile(np.eye(3), (len(solid.points), 1))).sum(axis=1))
    B = np.hstack([_mean(solid, shares, piece, port) for port in piece.ports])[held.free]
    return np.asarray(B.T @ factorise(held.stiffness, definite=True).solve(B))


def _kept_flexibility(piece: ClumodPiece, size: float) -> Array:
    """`solid_flexibility`, remembered on disk by the drawing of the piece and its materials."""
    from fem.solid.tetrahedra import bodies

    drawn = [
        [body.name, body.fingerprint, body.material.youngs_modulus, body.material.poisson_ratio]
        for body in bodies(build_clumod(piece.blades, piece.dimensions))
    ]
    ports = [[port.member, port.at] for port in piece.ports]
    name = cache.key("flexibility of ports", {"drawn": drawn, "ports": ports, "size": size, "foot": piece.foot})
    kept = cache.load(name)
    if kept is None:
        kept = {"flexibility": solid_flexibility(piece, size)}
        cache.store(name, kept)
    return kept["flexibility"]


def _solid(piece: ClumodPiece, size: float) -> Structure:
    from fem.solid.hexahedra import hexahedra
    from fem.solid.model import of_mesh

    article = build_clumod(piece.blades, piece.dimensions)
    parts = [part for part in article.parts if piece.foot or part.name != "flange"]
    sizes, cuts = ([2 * size, size], [piece.dimensions["flange"]["height"]]) if piece.foot else ([size], [])
    mesh = hexahedra(parts, sizes=sizes, cuts=cuts)
    return of_mesh(mesh, {part.name: part.material for part in parts})


def _mean(solid: Structure, shares: Array, piece: ClumodPiece, port: Port) -> Array:
    """Weights (N, 6) whose products with the displacements are the mean motion of the port's section.

    The motion is that of the rigid section nearest to the displacements, every node weighted with its share of the cells' mass
    (`shares`). Of a sandwich it is the mean of the motions of its two faces, each about its own middle: a beam's moment bends the
    faces and does not make them slide, which is another degree of freedom.
    """
    middle = place(port, piece.dimensions)
    axis = 2 if port.member == MAST else int(np.argmax(np.abs(middle[:2])))
    nodes = np.flatnonzero(np.abs(solid.points[:, axis] - middle[axis]) < SAME)
    if port.member == MAST:
        return _of_section(solid, shares, nodes, middle)
    # Heights [m] between which the plates of a blade lie, from its middle: one plate, or two faces
    blade = next(blade for blade in piece.dimensions["blade"] if blade["name"] == port.member)
    outer = blade["thickness"] / 2
    if "layer" not in blade:
        faces: list[tuple[float, float]] = [(-outer, outer)]
    else:
        inner = blade["layer"]["thickness"] / 2
        faces = [(-outer, -inner), (inner, outer)]
    heights = solid.points[nodes, 2] - middle[2]
    sections = [(nodes[(low - SAME < heights) & (heights < high + SAME)], (low + high) / 2) for low, high in faces]
    return np.asarray(
        sum(_of_section(solid, shares, own, middle + np.array([0.0, 0.0, height])) for own, height in sections) / len(sections)
    )


def _of_section(solid: Structure, shares: Array, nodes: Integers, middle: Array) -> Array:
    """Weights (N, 6) of the mean motion, about `middle` (3,) [m], of the section that consists of `nodes`."""
    own = solid.translations[nodes].ravel()
    R = solid.rigid[own] @ np.linalg.inv(rigid_transformation_6(middle))
    weighted = shares[own, None] * R
    result = np.zeros((len(solid.rigid), 6))
    result[own] = weighted @ np.linalg.inv(R.T @ weighted)
    return result


def _collar_span(blade: Dimensions) -> tuple[float, float]:
    """Heights [m] between which the hub of a blade reaches."""
    half = (blade["thickness"] + blade["hub_height"]) / 2
    return blade["z"] - half, blade["z"] + half


def _end(blade: Dimensions, d: Dimensions) -> float:
    return float(min(d["hubs"]["outer_diameter"] / 2 + STUB * blade["width"], blade["length"] / 2))
