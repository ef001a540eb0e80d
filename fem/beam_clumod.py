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
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from fem import frame
from fem.frame import Body, Member, Plan, Ports
from fem.sandwich import Sandwich, sandwich
from fem.section import Section, rectangle, tube
from geometry.arrays import Array
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


@dataclass(frozen=True, eq=False)
class _Rigid:
    """A rigid piece of the mast from `bottom` to `top`, riding on a node at `middle` [m]."""

    bottom: float
    middle: float
    top: float
    number: int = field(default=0)


def reach(radius: float, width: float) -> float:
    """Distance [m] from the mast's axis at which a half-blade of `width` leaves collars of `radius` and begins to bend.

    The mean over the width of the collar's edge, sqrt(radius² - y²), nothing where the blade is wider than the collar.
    """
    y = min(radius, width / 2)
    return float((y * np.sqrt(radius**2 - y**2) + radius**2 * np.arcsin(y / radius)) / width)


def plan(blades: Sequence[str], d: Dimensions, *, joints: Sequence[Joint] = (), elements: int = ELEMENTS) -> Plan:
    """Clumod with the `blades` named; node 0 is the flange, at the article's origin.

    Raises
    ------
    BadInput : hubs that overlap, a joint on a port that does not exist, a section that is none.
    """
    article = clumod.build(tuple(blades), d)
    pieces = _rigid_pieces(blades, d)
    ports = [port for joint in joints for port in joint.ports]
    nodes, carriers = [np.zeros(3)], [0]
    for piece in pieces:
        carriers.append(len(nodes))
        nodes.append(piece.middle * Z)
    heights = _mast_heights(d, pieces, [port.at for port in ports if port.member == MAST], 2 * elements)
    mast = tuple(range(len(nodes), len(nodes) + len(heights)))
    for height in heights:
        carriers.append(_carrier(height, d, pieces, len(nodes)))
        nodes.append(height * Z)
    section = tube(d["mast"]["outer_diameter"], d["mast"]["inner_diameter"], material(d["mast"]["material"]))
    members = [Member(nodes=mast, section=section, z_axis=X, part=MAST)]
    for number, blade in enumerate(d["blade"]):
        if blade["name"] in blades:
            station = 1 + next(index for index, piece in enumerate(pieces) if piece.number == number)
            asked = [port.at for port in ports if port.member == blade["name"]]
            members += _half_blades(blade, d, station, nodes, carriers, asked, elements)
    points = np.array(nodes)
    return Plan(
        nodes=points,
        carriers=tuple(carriers),
        members=tuple(members),
        bodies=tuple(_bodies(article, d, pieces, members, points)),
        ports=tuple(_ports(joint, blades, d, points) for joint in joints),
        loss_factors={
            part.name: part.material.loss_factor for part in article.parts if part.material.loss_factor and _elastic(part)
        },
    )


def _rigid_pieces(blades: Sequence[str], d: Dimensions) -> list[_Rigid]:
    """Where collars make the mast rigid, from the bottom: one piece with the blade between them, two without."""
    pieces = []
    for number, blade in enumerate(d["blade"]):
        z, t = blade["z"], blade["thickness"] / 2
        h = t + blade["hub_height"] / 2
        if blade["name"] in blades:
            pieces.append(_Rigid(z - h, z, z + h, number))
        else:
            pieces += [_Rigid(z - h, z - (h + t) / 2, z - t, number), _Rigid(z + t, z + (h + t) / 2, z + h, number)]
    pieces.sort(key=lambda piece: piece.bottom)
    _require_apart(pieces, d)
    return pieces


def _require_apart(pieces: list[_Rigid], d: Dimensions) -> None:
    edges = [d["flange"]["height"], *(edge for piece in pieces for edge in (piece.bottom, piece.top)), d["mast"]["top"]]
    for lower, upper in pairwise(edges):
        if upper < lower:
            raise BadInput(
                source="clumod.toml",
                field="blade.z",
                problem=f"hubs must lie on the mast and apart, found {1e3 * lower:g} mm above {1e3 * upper:g} mm",
                remedy="Move the blade or make its hub lower",
            )


def _mast_heights(d: Dimensions, pieces: list[_Rigid], asked: list[float], elements: int) -> list[float]:
    """Heights of the nodes from flange to top: the ends of rigid pieces, those asked for, and enough between."""
    ends = [end for piece in pieces for end in (piece.bottom, piece.top)]
    fixed = sorted({d["flange"]["height"], d["mast"]["top"], *ends, *asked})
    inside = {(piece.bottom, piece.top) for piece in pieces}
    step = (fixed[-1] - fixed[0]) / elements
    heights = [fixed[0]]
    for a, b in pairwise(fixed):
        count = 1 if (a, b) in inside else max(1, int(np.ceil((b - a) / step - 1e-9)))
        heights += np.linspace(a, b, count + 1)[1:].tolist()
    return heights


def _carrier(height: float, d: Dimensions, pieces: list[_Rigid], own: int) -> int:
    if height == d["flange"]["height"]:
        return 0
    return next((1 + index for index, piece in enumerate(pieces) if piece.bottom <= height <= piece.top), own)


def _half_blades(
    blade: Dimensions, d: Dimensions, station: int, nodes: list[Array], carriers: list[int], asked: list[float], elements: int
) -> list[Member]:
    """Two members from `reach` to the tips, their nodes appended to `nodes` and `carriers`."""
    root, tip = reach(d["hubs"]["outer_diameter"] / 2, blade["width"]), blade["length"] / 2
    outwards = {"x": X, "y": Y}[blade["axis"]]
    section, members = _blade_section(blade, d), []
    for side in (1, -1):
        first, own = len(nodes), [side * at for at in asked if side * at > 0]
        fixed = sorted({root, tip, *(at for at in own if root < at < tip)})
        counts = [max(1, round(elements * (b - a) / (tip - root))) for a, b in pairwise(fixed)]
        distances = [root]
        for (a, b), count in zip(pairwise(fixed), counts, strict=True):
            distances += np.linspace(a, b, count + 1)[1:].tolist()
        for distance in distances:
            carriers.append(station if distance == root else len(nodes))
            nodes.append(nodes[station] + side * distance * outwards)
        chain = tuple(range(first, len(nodes)))
        members.append(Member(nodes=chain, section=section, z_axis=Z, part=blade["name"], bonded=frozenset({first})))
    return members


def _blade_section(blade: Dimensions, d: Dimensions) -> Section | Sandwich:
    steel, w, t = material(d["blades"]["material"]), blade["width"], blade["thickness"]
    if "layer" not in blade:
        return rectangle(w, t, steel)
    bottom, layer, top = (f"{blade['name']}-{body}" for body in ("bottom", "silicone", "top"))
    return sandwich(w, t, blade["layer"]["thickness"], steel, material(blade["layer"]["material"]), (bottom, layer, top))


def _bodies(article: Article, d: Dimensions, pieces: list[_Rigid], members: list[Member], nodes: Array) -> list[Body]:
    """What the beams lack: the flange, and on every rigid piece its collars and the blade as drawn less the blade's beams."""
    bodies = [Body(node=0, inertia=_drawn(part for part in article.parts if part.name == "flange"))]
    for station, piece in enumerate(pieces, start=1):
        blade = d["blade"][piece.number]["name"]
        hub = next(part for part in article.parts if part.name == f"hub-{piece.number + 1}")
        own = [part for part in article.parts if part.name == blade or part.name.startswith(f"{blade}-")]
        lacking = _drawn([_between(hub, piece), *own])
        for member in members:
            lacking = lacking - frame.inertia(member, nodes) if own and member.part == blade else lacking
        bodies.append(Body(node=station, inertia=lacking))
    return bodies


def _between(part: Part, piece: _Rigid) -> Part:
    """The collars of a hub that belong to a rigid piece of the mast."""

    def there(placed: Placed) -> bool:
        return bool(piece.bottom <= placed.pose.position[2] <= piece.top)

    shape = Shape(solids=tuple(filter(there, part.shape.solids)), voids=tuple(filter(there, part.shape.voids)))
    return replace(part, shape=shape)


def _drawn(parts: Iterable[Part]) -> Inertia:
    return drawn_inertia(Article(name="rigid", parts=tuple(parts)))


def _elastic(part: Part) -> bool:
    return part.name != "flange" and not part.name.startswith("hub-")


def _ports(joint: Joint, blades: Sequence[str], d: Dimensions, nodes: Array) -> Ports:
    size = 6 * len(joint.ports)
    mass = np.zeros((size, size)) if joint.mass is None else joint.mass
    return Ports(
        nodes=tuple(_node(port, blades, d, nodes) for port in joint.ports), stiffness=joint.stiffness, mass=mass, part=joint.part
    )


def _node(port: Port, blades: Sequence[str], d: Dimensions, nodes: Array) -> int:
    known = [MAST, *blades]
    if port.member not in known:
        raise _refused(f"there is no {port.member!r}", f"{nearest(port.member, known)}Known are {', '.join(known)}")
    blade = next((blade for blade in d["blade"] if blade["name"] == port.member), None)
    if blade is None:
        place, ends = port.at * Z, (d["flange"]["height"], d["mast"]["top"])
    else:
        place = blade["z"] * Z + port.at * {"x": X, "y": Y}[blade["axis"]]
        ends = (reach(d["hubs"]["outer_diameter"] / 2, blade["width"]), blade["length"] / 2)
    if not ends[0] <= abs(port.at) <= ends[1]:
        raise _refused(
            f"{port.member} has no node at {1e3 * port.at:g} mm",
            f"Its beam goes from {1e3 * ends[0]:.1f} to {1e3 * ends[1]:.1f} mm",
        )
    return len(nodes) - 1 - int(np.argmin(np.linalg.norm(nodes[::-1] - place, axis=1)))


def _refused(problem: str, remedy: str) -> BadInput:
    return BadInput(source="joint of Clumod", field="port", problem=problem, remedy=remedy)
