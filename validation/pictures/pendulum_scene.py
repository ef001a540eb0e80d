"""A rope pendulum rendered: the article where it is at one instant, its ropes from the ceiling, and the frame they are tied to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array, frozen
from validation.pictures.bodies import DrawnBody
from validation.pictures.palette import INK, colours
from validation.pictures.scene import SUPERSAMPLING, Image, Plotter, averaged, shot
from validation.pictures.view import View, fitted

ROPE, SPREADER, CEILING, AT_REST = "#8a6d3b", "#59616d", "#d9dde3", "#c3c8d0"
CREASE = 30.0


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
    rest : the pendulum at rest, drawn as an outline
    view : in which all instants fit
    """

    bodies: tuple[DrawnBody, ...]
    rest: Instant
    view: View


def pendulum_scene(
    bodies: Sequence[DrawnBody], rest: Instant, instants: Sequence[Instant], size: tuple[int, int], margin: float
) -> PendulumScene:
    """The scene of `bodies` in an image of `size` [pixel] into which every one of `instants` fits."""
    vertices = np.concatenate([body.vertices for body in bodies])
    seen = [np.vstack([vertices @ one.rotation.T + one.place, one.chains.reshape(-1, 3)]) for one in (rest, *instants)]
    return PendulumScene(bodies=tuple(bodies), rest=rest, view=fitted(np.concatenate(seen), size, margin))


def rendered(scene: PendulumScene, instant: Instant) -> Image:
    """The pendulum at `instant`. To be called inside of `off_screen`."""
    image = shot(scene.view, lambda plotter: _all(plotter, scene, instant), peels=0)
    return np.round(averaged(image.astype(np.float64))).astype(np.uint8)


def _all(plotter: Plotter, scene: PendulumScene, instant: Instant) -> None:
    colour = colours(body.material for body in scene.bodies)
    _ceiling(plotter, instant.chains[:, 0])
    for body in scene.bodies:
        _lines(plotter, body, scene.rest, AT_REST)
        _body(plotter, body, instant, colour[body.material])
        _lines(plotter, body, instant, INK)
    for chain in instant.chains:
        _polyline(plotter, chain, ROPE, 2.4)
    _spreader(plotter, instant)


def _placed(body: DrawnBody, instant: Instant) -> Array:
    return np.asarray(body.vertices @ instant.rotation.T + instant.place)


def _mesh(body: DrawnBody, points: Array):  # type: ignore[no-untyped-def]  # a `pyvista.PolyData`; imported inside
    import pyvista

    return pyvista.PolyData(points, np.column_stack([np.full(len(body.faces), 3), body.faces]).ravel())


def _body(plotter: Plotter, body: DrawnBody, instant: Instant, colour: str) -> None:
    mesh = _mesh(body, _placed(body, instant))
    plotter.add_mesh(mesh, color=colour, ambient=0.55, diffuse=0.55, specular=0.05)


def _lines(plotter: Plotter, body: DrawnBody, instant: Instant, colour: str) -> None:
    mesh = _mesh(body, _placed(body, instant))
    edges = mesh.extract_feature_edges(CREASE, boundary_edges=False, manifold_edges=False, non_manifold_edges=False)
    if edges.n_cells:
        plotter.add_mesh(edges, color=colour, line_width=0.8 * SUPERSAMPLING, lighting=False)


def _ceiling(plotter: Plotter, anchors: Array) -> None:
    """A plate above the ropes' upper ends."""
    import pyvista

    reach = 0.25 * float(np.ptp(anchors[:, :2], axis=0).max())
    (x0, y0), (x1, y1) = anchors[:, :2].min(axis=0) - reach, anchors[:, :2].max(axis=0) + reach
    z = float(anchors[:, 2].max())
    plate = pyvista.Box(bounds=(x0, x1, y0, y1, z, z + 0.06 * reach))
    plotter.add_mesh(plate, color=CEILING, ambient=0.7, diffuse=0.3)


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
