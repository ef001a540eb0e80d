"""Joints of Clumod's beam model from local solid models: what hub, blade roots and mast do that beams and rigid hubs do not.

A crossing is cut out of the drawing: a piece of the mast with its hubs and the roots of its blades, no frequency in sight. It is
built twice from the same dimensions, as hexahedra and as the beam model's own beams, both held at the lower end of the mast. Unit
loads at the other ends - the ports - give the flexibility of each, 6 x 6 a port; ends of the solid carry and report them as the
mean over the cut section. The difference of the two stiffnesses, expanded to all ports by rigid motion, is the joint: added to
the beams it gives them the flexibility of the solid, and nothing else. The mast's foot on the elastic flange is a joint as well.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from fem.beam_clumod import MAST, Joint, Port, nearest_node, place
from fem.beam_clumod import plan as beams
from fem.factorisers import factorise
from fem.frame import assemble
from fem.held_base import hold
from fem.structure import Structure
from geometry.arrays import Array, Integers
from geometry.articles import clumod
from geometry.articles.dimensions import Dimensions
from geometry.frames import rigid_transformation_6

STUB = 0.75
"""Length of a blade's root beyond the collars, in widths of the blade: where the plate has become a beam."""

SLEEVE = 1.0
"""Length of mast beyond the collars, in diameters of the mast."""

SAME = 1e-7
"""Nodes closer to a cut than this [m] lie in it."""

ELEMENTS = 24
"""Of a half-blade in the local beam model, which shall be exact."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Piece:
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
    """The joints of Clumod with the `blades` named, for `fem.beam.build`; `size` [m] is that of the local solids' cells.

    Raises
    ------
    BadInput, CheckFailed : a local solid that cannot be meshed or factorised.
    """
    return tuple(joint(piece, d, size) for piece in pieces(blades, d))


def joint(piece: Piece, d: Dimensions, size: float) -> Joint:
    """What the solid `piece` adds to the stiffness of its beams, between its lower end and its ports."""
    added = np.linalg.inv(_kept_flexibility(piece, size)) - np.linalg.inv(beam_flexibility(piece))
    T = np.hstack([-np.vstack([rigid_transformation_6(place(port, d) - piece.base) for port in piece.ports]), np.eye(len(added))])
    held = Port(member=MAST, at=float(piece.base[2]))
    return Joint(ports=(held, *piece.ports), stiffness=T.T @ ((added + added.T) / 2) @ T)


def pieces(blades: Sequence[str], d: Dimensions) -> Iterator[Piece]:
    """The foot of the mast, then its hubs from bottom to top, neighbours in one piece when they stand close together."""
    sleeve = SLEEVE * d["mast"]["outer_diameter"]
    yield _foot(d, sleeve)
    for group in _neighbours(d, sleeve):
        low, high = _collars(group[0])[0] - sleeve, _collars(group[-1])[1] + sleeve
        piece = _crossing(d, group, tuple(b["name"] for b in group if b["name"] in blades), low, min(high, d["mast"]["top"]))
        if piece.ports:  # bare collars at the end of the mast carry nothing
            yield piece


def beam_flexibility(piece: Piece) -> Array:
    """Displacements and rotations of the ports (6 k, 6 k) for unit forces and moments there, by the beam model."""
    frame = assemble(beams(piece.blades, piece.dimensions, elements=ELEMENTS))
    stiffness = sum(frame.stiffness.values(), np.zeros_like(frame.mass))
    moving = frame.plan.nodes[list(frame.moving)]
    nodes = [nearest_node(place(port, piece.dimensions), moving) for port in piece.ports]
    dofs = np.concatenate([6 * node + np.arange(6) for node in nodes])
    free = np.arange(6, len(stiffness))
    loads = np.zeros((len(stiffness), len(dofs)))
    loads[dofs, np.arange(len(dofs))] = 1.0
    return np.asarray(np.linalg.solve(stiffness[np.ix_(free, free)], loads[free])[dofs - 6])


def solid_flexibility(piece: Piece, size: float) -> Array:
    """The same by hexahedra."""
    solid = _solid(piece, size)
    held = hold(solid)
    shares = _shares(solid)
    B = np.hstack([_mean(solid, shares, piece, port) for port in piece.ports])[held.free]
    return np.asarray(B.T @ factorise(held.stiffness, definite=True).solve(B))


def _kept_flexibility(piece: Piece, size: float) -> Array:
    """`solid_flexibility`, remembered on disk by the drawing of the piece and its materials."""
    from fem.solid import cache
    from fem.solid.bodies import bodies

    drawn = [
        [body.name, body.fingerprint, body.material.youngs_modulus, body.material.poisson_ratio]
        for body in bodies(clumod.build(piece.blades, piece.dimensions))
    ]
    ports = [[port.member, port.at] for port in piece.ports]
    name = cache.key("flexibility of ports", {"drawn": drawn, "ports": ports, "size": size, "foot": piece.foot})
    kept = cache.load(name)
    if kept is None:
        kept = {"flexibility": solid_flexibility(piece, size)}
        cache.store(name, kept)
    return kept["flexibility"]


def _solid(piece: Piece, size: float) -> Structure:
    from fem.solid.layers import hexahedra
    from fem.solid.model import of_mesh

    article = clumod.build(piece.blades, piece.dimensions)
    parts = [part for part in article.parts if piece.foot or part.name != "flange"]
    sizes, cuts = ([2 * size, size], [piece.dimensions["flange"]["height"]]) if piece.foot else ([size], [])
    mesh = hexahedra(parts, sizes=sizes, cuts=cuts)
    return of_mesh(mesh, {part.name: part.material for part in parts})


def _shares(solid: Structure) -> Array:
    """Mass (N,) that moves with every degree of freedom when all of the solid goes along with it."""
    return np.asarray((solid.mass @ np.tile(np.eye(3), (len(solid.points), 1))).sum(axis=1))


def _mean(solid: Structure, shares: Array, piece: Piece, port: Port) -> Array:
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
    faces = _faces(next(blade for blade in piece.dimensions["blade"] if blade["name"] == port.member))
    heights = solid.points[nodes, 2] - middle[2]
    sections = [(nodes[(low - SAME < heights) & (heights < high + SAME)], (low + high) / 2) for low, high in faces]
    return np.asarray(
        sum(_of_section(solid, shares, own, middle + np.array([0.0, 0.0, height])) for own, height in sections) / len(sections)
    )


def _faces(blade: Dimensions) -> list[tuple[float, float]]:
    """Heights [m] between which the plates of a blade lie, from its middle: one plate, or two faces."""
    outer = blade["thickness"] / 2
    if "layer" not in blade:
        return [(-outer, outer)]
    inner = blade["layer"]["thickness"] / 2
    return [(-outer, -inner), (inner, outer)]


def _of_section(solid: Structure, shares: Array, nodes: Integers, middle: Array) -> Array:
    """Weights (N, 6) of the mean motion, about `middle` (3,) [m], of the section that consists of `nodes`."""
    own = solid.translations[nodes].ravel()
    R = solid.rigid[own] @ np.linalg.inv(rigid_transformation_6(middle))
    weighted = shares[own, None] * R
    result = np.zeros((len(solid.rigid), 6))
    result[own] = weighted @ np.linalg.inv(R.T @ weighted)
    return result


def _foot(d: Dimensions, sleeve: float) -> Piece:
    top = d["flange"]["height"] + sleeve
    own = {**copy.deepcopy(d), "blade": [], "mast": {**d["mast"], "top": top}}
    return Piece(
        dimensions=own, blades=(), ports=(Port(member=MAST, at=top),), base=np.array([0.0, 0.0, d["flange"]["height"]]), foot=True
    )


def _crossing(d: Dimensions, group: list[Dimensions], blades: tuple[str, ...], low: float, high: float) -> Piece:
    own = copy.deepcopy(d)
    own["flange"] |= {"height": low}
    own["mast"] |= {"top": high}
    own["blade"] = [{**blade, "length": 2 * _end(blade, d)} for blade in group]
    ports = [Port(member=b["name"], at=side * _end(b, d)) for b in group if b["name"] in blades for side in (1, -1)]
    if high < d["mast"]["top"]:
        ports.append(Port(member=MAST, at=high))
    return Piece(dimensions=own, blades=blades, ports=tuple(ports), base=np.array([0.0, 0.0, low]))


def _neighbours(d: Dimensions, sleeve: float) -> list[list[Dimensions]]:
    """Hubs from bottom to top, in groups whose sleeves would run into one another."""
    groups: list[list[Dimensions]] = []
    for blade in sorted(d["blade"], key=lambda blade: float(blade["z"])):
        if groups and _collars(blade)[0] - _collars(groups[-1][-1])[1] < 2 * sleeve:
            groups[-1].append(blade)
        else:
            groups.append([blade])
    return groups


def _collars(blade: Dimensions) -> tuple[float, float]:
    """Heights [m] between which the hub of a blade reaches."""
    half = (blade["thickness"] + blade["hub_height"]) / 2
    return blade["z"] - half, blade["z"] + half


def _end(blade: Dimensions, d: Dimensions) -> float:
    return float(min(d["hubs"]["outer_diameter"] / 2 + STUB * blade["width"], blade["length"] / 2))
