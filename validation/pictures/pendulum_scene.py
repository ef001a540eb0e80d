"""A rope pendulum rendered: the article at one instant, its ropes from the ceiling, and the frame they are tied to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array, frozen
from validation.pictures.bodies import DrawnBody
from validation.pictures.moving import Integers, sharp_edges
from validation.pictures.palette import INK, colours
from validation.pictures.scene import SUPERSAMPLING, Image, Plotter, averaged, shot
from validation.pictures.view import View, fitted

ROPE, SPREADER, CEILING, AT_REST = "#8a6d3b", "#59616d", "#d9dde3", "#c3c8d0"

OVERHANG = 0.06
"""Of the ceiling beyond the ropes [m]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Instant:
    """A pendulum at one instant, in the fixed frame, z upwards.

    Attributes
    ----------
    place : (3,) [m] of the article's CoG
    rotation : (3, 3) from the axes of `PendulumScene.bodies`
    chains : (ropes, k, 3) [m] every rope, from the ceiling to its foot
    """

    place: Array
    rotation: Array
    chains: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "place", frozen(self.place, (3,), "place"))
        object.__setattr__(self, "rotation", frozen(self.rotation, (3, 3), "rotation"))
        object.__setattr__(self, "chains", frozen(self.chains, (*np.shape(self.chains)[:2], 3), "chains"))


@dataclass(frozen=True, eq=False, kw_only=True)
class PendulumScene:
    """What stays the same in every frame.

    Attributes
    ----------
    bodies : of the article, in the axes in which it hangs, origin in its CoG
    edges : of every body, indices (e, 2) of the ends of its sharp edges
    rest : the pendulum at rest, drawn as an outline
    view : in which all instants fit
    """

    bodies: tuple[DrawnBody, ...]
    edges: tuple[Integers, ...]
    rest: Instant
    view: View


def pendulum_scene(
    bodies: Sequence[DrawnBody], rest: Instant, instants: Sequence[Instant], size: tuple[int, int], margin: float
) -> PendulumScene:
    """The scene of `bodies` in an image of `size` [pixel] into which every one of `instants` fits."""
    vertices = np.concatenate([body.vertices for body in bodies])
    seen = [np.vstack([vertices @ one.rotation.T + one.place, one.chains.reshape(-1, 3)]) for one in (rest, *instants)]
    view = fitted(np.concatenate([_box(rest.chains[:, 0]).points, *seen]), size, margin)
    return PendulumScene(bodies=tuple(bodies), edges=tuple(map(sharp_edges, bodies)), rest=rest, view=view)


def rendered(scene: PendulumScene, instant: Instant) -> Image:
    """The pendulum at `instant`. To be called inside of `off_screen`."""
    image = shot(scene.view, lambda plotter: _all(plotter, scene, instant), peels=0)
    return np.round(averaged(image.astype(np.float64))).astype(np.uint8)


def _all(plotter: Plotter, scene: PendulumScene, instant: Instant) -> None:
    colour = colours(body.material for body in scene.bodies)
    plotter.add_mesh(_box(instant.chains[:, 0]), color=CEILING, ambient=0.7, diffuse=0.3)
    for body, edges in zip(scene.bodies, scene.edges, strict=True):
        points = _placed(body, instant)
        _lines(plotter, edges, _placed(body, scene.rest), AT_REST)
        _body(plotter, body, points, colour[body.material])
        _lines(plotter, edges, points, INK)
    for chain in instant.chains:
        _polyline(plotter, chain, ROPE, 3.0)
    _spreader(plotter, instant)


def _placed(body: DrawnBody, instant: Instant) -> Array:
    return np.asarray(body.vertices @ instant.rotation.T + instant.place)


def _body(plotter: Plotter, body: DrawnBody, points: Array, colour: str) -> None:
    import pyvista

    mesh = pyvista.PolyData(points, np.column_stack([np.full(len(body.faces), 3), body.faces]).ravel())
    plotter.add_mesh(mesh, color=colour, ambient=0.55, diffuse=0.55, specular=0.05)


def _lines(plotter: Plotter, edges: Integers, points: Array, colour: str) -> None:
    import pyvista

    if len(edges):
        lines = pyvista.PolyData(points, lines=np.column_stack([np.full(len(edges), 2), edges]).ravel())
        plotter.add_mesh(lines, color=colour, line_width=0.8 * SUPERSAMPLING, lighting=False)


def _box(anchors: Array):  # type: ignore[no-untyped-def]  # a `pyvista.PolyData`; the library is imported inside
    """The ceiling, as much of it as the ropes need."""
    import pyvista

    (x0, y0, z), (x1, y1, _) = anchors.min(axis=0) - OVERHANG, anchors.max(axis=0) + OVERHANG
    z += OVERHANG
    return pyvista.Box(bounds=(x0, x1, y0, y1, z, z + OVERHANG / 4))


def _spreader(plotter: Plotter, instant: Instant) -> None:
    """The light frame that the ropes are tied to: from foot to foot, and from every foot to the axis through the CoG."""
    feet = instant.chains[:, -1]
    up = instant.rotation[:, 2]
    hub = instant.place + up * float(np.mean((feet - instant.place) @ up))
    _polyline(plotter, np.vstack([feet, feet[:1]]), SPREADER, 3.0)
    for foot in feet:
        _polyline(plotter, np.vstack([foot, hub]), SPREADER, 3.0)
    _polyline(plotter, np.vstack([hub, instant.place]), SPREADER, 3.0)


def _polyline(plotter: Plotter, points: Array, colour: str, width: float) -> None:
    import pyvista

    plotter.add_mesh(pyvista.MultipleLines(points=points), color=colour, line_width=width * SUPERSAMPLING / 2, lighting=False)
