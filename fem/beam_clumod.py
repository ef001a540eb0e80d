"""Clumod as a frame: mast and half-blades are beams, flange, hubs and what is clamped between their collars are rigid.

A hub holds its blade between two collars. Over their height the mast is rigid, and a half-blade begins not at the mast's axis but
at `reach` from it. All that the beams do not have of the real parts - collars, the blade's middle with its holes for mast and
bolts - is a rigid body on the hub, drawing less beams, so that the frame carries the mass of the drawing exactly. Where a blade
has been taken off, its two collars stay, a tube's gap apart.

What a rigid hub cannot say - the collars' own give, the blade that is wider than they are - enters as `Joint`: matrices on ports,
from a local solid model of the crossing.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from itertools import pairwise
from operator import sub

import numpy as np

from fem import frame
from fem.frame import Body, Member, Plan, Ports
from fem.sandwich import Sandwich, sandwich
from fem.section import Section, rectangle, tube
from fem.structure import rigid_motion
from geometry.arrays import Array, frozen
from geometry.article import Article, Part
from geometry.articles import clumod
from geometry.articles.dimensions import Dimensions
from geometry.errors import BadInput
from geometry.inertia import Inertia
from geometry.keys import nearest
from geometry.materials import material
from geometry.multibody import inertia as drawn_inertia
from geometry.shapes import Placed, Shape

ELEMENTS = 6
"""In a half-blade; the mast, three times as long and stiffer, has twice as many."""

MAST = "mast"
X, Y, Z = np.eye(3)
AXES = {"x": X, "y": Y}

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
                raise BadInput(
                    source="joint of Clumod", field=name, problem="must be symmetric", remedy="Check the order of ports"
                )
            object.__setattr__(self, name, matrix)


def reach(radius: float, thickness: float) -> float:
    """Distance [m] from the mast's axis at which a half-blade of `thickness` between collars of `radius` begins to bend.

    The collars end at their radius; a plate is not held rigidly at the edge of what clamps it but yields over a length of the
    order of its thickness. Local solid models (`fem.crossing`) give 0.9 to 1.4 thicknesses between the thick collars of the lower
    blades; one is taken. Thin collars and the mast's wall yield more: that is left to the joints.
    """
    return radius - thickness


def plan(blades: Sequence[str], d: Dimensions, *, joints: Sequence[Joint] = (), elements: int = ELEMENTS) -> Plan:
    """Clumod with the `blades` named; node 0 is the flange, at the article's origin.

    Raises
    ------
    BadInput : hubs that overlap, a joint on a port that does not exist, a section that is none.
    """
    article, pieces = clumod.build(tuple(blades), d), _rigid_pieces(blades, d)
    asked = [_checked(port, blades, d) for joint in joints for port in joint.ports]
    nodes = _Nodes()
    nodes.put(np.zeros(3), carrier=0)
    for piece in pieces:
        nodes.put(piece.middle * Z)
    members = [_mast(d, pieces, asked, elements, nodes)]
    for station, piece in enumerate(pieces, start=1):
        blade = d["blade"][piece.number]
        if blade["name"] in blades:
            members += [_half_blade(blade, d, side, station, asked, elements, nodes) for side in (1, -1)]
    points = np.array(nodes.points)
    return Plan(
        nodes=points,
        carriers=tuple(nodes.carriers),
        members=tuple(members),
        bodies=tuple(_bodies(article, d, pieces, members, points)),
        ports=tuple(_ports(joint, d, points) for joint in joints),
        loss_factors={
            part.name: part.material.loss_factor for part in _elastic(article) if part.material.loss_factor is not None
        },
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
    _require_apart(pieces, d)
    return pieces


def _require_apart(pieces: list[_Rigid], d: Dimensions) -> None:
    edges = [d["flange"]["height"], *(edge for piece in pieces for edge in (piece.bottom, piece.top))]
    for lower, upper in pairwise(edges):
        if upper < lower:
            raise BadInput(
                source="clumod.toml",
                field="blade.z",
                problem=f"hubs must lie on the mast and apart, found {1e3 * lower:g} mm above {1e3 * upper:g} mm",
                remedy="Move the blade or make its hub lower",
            )


def _mast(d: Dimensions, pieces: list[_Rigid], asked: list[Port], elements: int, nodes: _Nodes) -> Member:
    """The mast from the flange to its top; what lies within a rigid piece rides on it."""
    mast, chain = d["mast"], []
    for height in _mast_heights(d, pieces, [port.at for port in asked if port.member == MAST], 2 * elements):
        carrier = next((1 + index for index, piece in enumerate(pieces) if piece.bottom <= height <= piece.top), None)
        chain.append(nodes.put(height * Z, 0 if height == d["flange"]["height"] else carrier))
    section = tube(mast["outer_diameter"], mast["inner_diameter"], material(mast["material"]))
    return Member(nodes=tuple(chain), section=section, z_axis=X, part=MAST)


def _mast_heights(d: Dimensions, pieces: list[_Rigid], asked: list[float], elements: int) -> list[float]:
    """Heights of the nodes: the flange, the ends of rigid pieces, those asked for, the top, and enough between."""
    # a collar may stand out beyond the mast's top
    ends = [min(end, d["mast"]["top"]) for piece in pieces for end in (piece.bottom, piece.top)]
    fixed = sorted({d["flange"]["height"], d["mast"]["top"], *ends, *asked})
    return _between(fixed, (fixed[-1] - fixed[0]) / elements)


def _half_blade(
    blade: Dimensions, d: Dimensions, side: int, station: int, asked: list[Port], elements: int, nodes: _Nodes
) -> Member:
    """One half of a blade, on the positive or the negative `side` of its axis, from its root to its tip."""
    root, tip = _ends(blade, d)
    own = [side * port.at for port in asked if port.member == blade["name"] and side * port.at > 0]
    distances = _between(sorted({root, tip, *own}), (tip - root) / elements)
    places = [blade["z"] * Z + side * distance * AXES[blade["axis"]] for distance in distances]
    chain = [nodes.put(places[0], station), *(nodes.put(place) for place in places[1:])]
    return Member(nodes=tuple(chain), section=_blade_section(blade, d), z_axis=Z, part=blade["name"], bonded=frozenset(chain[:1]))


def _ends(blade: Dimensions, d: Dimensions) -> tuple[float, float]:
    """Distances [m] from the mast's axis at which a half-blade begins and ends."""
    return reach(d["hubs"]["outer_diameter"] / 2, blade["thickness"]), blade["length"] / 2


def _between(fixed: list[float], step: float) -> list[float]:
    """`fixed`, ascending, and what divides the gaps evenly into pieces not much longer than `step`."""
    gaps = [np.linspace(a, b, max(1, round((b - a) / step)), endpoint=False).tolist() for a, b in pairwise(fixed)]
    return [*(value for gap in gaps for value in gap), fixed[-1]]


def _blade_section(blade: Dimensions, d: Dimensions) -> Section | Sandwich:
    steel, w, t = material(d["blades"]["material"]), blade["width"], blade["thickness"]
    if "layer" not in blade:
        return rectangle(w, t, steel)
    bottom, layer, top = (f"{blade['name']}-{body}" for body in ("bottom", "silicone", "top"))
    return sandwich(w, t, blade["layer"]["thickness"], steel, material(blade["layer"]["material"]), (bottom, layer, top))


def _bodies(article: Article, d: Dimensions, pieces: list[_Rigid], members: list[Member], nodes: Array) -> list[Body]:
    """What the beams lack: the flange, and on every rigid piece its collars and the blade as drawn less the blade's beams."""
    drawn = {part.name: part for part in article.parts}
    bodies = [Body(node=0, inertia=_drawn([drawn["flange"]]))]
    for station, piece in enumerate(pieces, start=1):
        blade, hub = d["blade"][piece.number]["name"], drawn[f"hub-{piece.number + 1}"]
        own = [part for name, part in drawn.items() if name == blade or name.startswith(f"{blade}-")]
        beams = [frame.inertia(member, nodes) for member in members if member.part == blade]
        bodies.append(Body(node=station, inertia=reduce(sub, beams, _drawn([_collars(hub, piece), *own]))))
    return bodies


def _collars(hub: Part, piece: _Rigid) -> Part:
    """The collars of a hub that belong to a rigid piece of the mast."""

    def there(placed: Placed) -> bool:
        return bool(piece.bottom <= placed.pose.position[2] <= piece.top)

    shape = Shape(solids=tuple(filter(there, hub.shape.solids)), voids=tuple(filter(there, hub.shape.voids)))
    return replace(hub, shape=shape)


def _drawn(parts: Iterable[Part]) -> Inertia:
    return drawn_inertia(Article(name="rigid", parts=tuple(parts)))


def _elastic(article: Article) -> Iterable[Part]:
    return (part for part in article.parts if part.name != "flange" and not part.name.startswith("hub-"))


def _ports(joint: Joint, d: Dimensions, nodes: Array) -> Ports:
    mass = np.zeros_like(joint.stiffness) if joint.mass is None else joint.mass
    chosen = tuple(nearest_node(place(port, d), nodes) for port in joint.ports)
    carried = np.abs(joint.stiffness @ rigid_motion(nodes[list(chosen)])).max(initial=0)
    if carried > RIGID_ROUNDING * np.abs(joint.stiffness).max(initial=0):
        raise BadInput(
            source="joint of Clumod",
            field="stiffness",
            problem=f"must let its ports move together rigidly, found a force or moment of {carried:.3g} for a unit motion",
            remedy="Check that the ports lie where the local model has them, in Clumod's axes",
        )
    return Ports(nodes=chosen, stiffness=joint.stiffness, mass=mass, part=joint.part)


def nearest_node(there: Array, nodes: Array) -> int:
    """Index of the one of `nodes` (n, 3) that lies nearest to the place `there` (3,) [m]."""
    return int(np.argmin(np.linalg.norm(nodes - there, axis=1)))


def place(port: Port, d: Dimensions) -> Array:
    """Where `port` is (3,) [m], in Clumod's frame."""
    if port.member == MAST:
        return port.at * Z
    blade = next(blade for blade in d["blade"] if blade["name"] == port.member)
    return np.asarray(blade["z"] * Z + port.at * AXES[blade["axis"]])


def _checked(port: Port, blades: Sequence[str], d: Dimensions) -> Port:
    """`port`, which must lie on a beam that is there."""
    ends = {MAST: (d["flange"]["height"], d["mast"]["top"])}
    ends |= {blade["name"]: _ends(blade, d) for blade in d["blade"] if blade["name"] in blades}
    if port.member not in ends:
        raise _refused(f"there is no {port.member!r}", f"{nearest(port.member, ends)}Known are {', '.join(ends)}")
    first, last = ends[port.member]
    if not first <= (port.at if port.member == MAST else abs(port.at)) <= last:
        raise _refused(
            f"{port.member} is no beam at {1e3 * port.at:g} mm", f"Its beam goes from {1e3 * first:.1f} to {1e3 * last:.1f} mm"
        )
    return port


def _refused(problem: str, remedy: str) -> BadInput:
    return BadInput(source="joint of Clumod", field="port", problem=problem, remedy=remedy)
