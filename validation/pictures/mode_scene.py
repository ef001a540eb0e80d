"""A mode shape rendered: deformed and coloured by displacement, with the edges of the body at rest behind it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from validation.pictures.moving import MovingBody, largest
from validation.pictures.palette import INK
from validation.pictures.scene import SUPERSAMPLING, Image, Plotter, averaged, shot
from validation.pictures.view import View, fitted

STILL = "#d3d8e0"
"""What does not move; the colours from there on are those of `turbo`, whose own lowest ones are nearly black."""
AT_REST = "#b4bac4"

REACH = 0.09
"""Largest displacement drawn, as a share of the article's diagonal."""


def scale_of(bodies: Sequence[MovingBody]) -> float:
    """Factor [m per unit of displacement] that brings the largest displacement to `REACH`; 0 where nothing moves."""
    points = np.concatenate([body.vertices for body in bodies])
    most = largest(bodies)
    return REACH * float(np.linalg.norm(np.ptp(points, axis=0))) / most if most > 0 else 0.0


def colour_map() -> Any:
    """Light grey for what stands still, then blue, green, yellow, red."""
    from matplotlib import colormaps
    from matplotlib.colors import LinearSegmentedColormap

    turbo = colormaps["turbo"]
    return LinearSegmentedColormap.from_list("motion", [STILL, *(turbo(x) for x in np.linspace(0.12, 0.95, 12))], N=256)


def colours_of(bodies: Sequence[MovingBody]) -> list[npt.NDArray[np.uint8]]:
    """Red, green and blue (n, 3) of every vertex of `bodies`."""
    most = largest(bodies) or 1.0
    return [np.round(255 * colour_map()(body.size / most)[:, :3]).astype(np.uint8) for body in bodies]


def view_of(modes: Sequence[Sequence[MovingBody]], size: tuple[int, int], margin: float) -> View:
    """The view in which every one of `modes` fits, at both ends of its swing."""
    swings = []
    for bodies in modes:
        scale = scale_of(bodies)
        swings += [body.vertices + sign * scale * body.displacement for body in bodies for sign in (-1, 1)]
    return fitted(np.concatenate(swings), size, margin)


def rendered(view: View, bodies: Sequence[MovingBody], share: float) -> Image:
    """`bodies` at `share` (-1 to 1) of their swing. To be called inside of `off_screen`."""
    return displaced(view, bodies, share * scale_of(bodies), largest(bodies))


def displaced(view: View, bodies: Sequence[MovingBody], factor: float, most: float) -> Image:
    """`bodies` with their displacement times `factor`, coloured from none to `most`. To be called inside of `off_screen`."""
    pixels = shot(view, lambda plotter: _all(plotter, bodies, factor, most), peels=0)
    return np.round(averaged(pixels.astype(np.float64))).astype(np.uint8)


def _all(plotter: Plotter, bodies: Sequence[MovingBody], factor: float, most: float) -> None:
    for body in bodies:
        _lines(plotter, body, body.vertices, AT_REST)
        _body(plotter, body, body.vertices + factor * body.displacement, most)


def _body(plotter: Plotter, body: MovingBody, points: Array, most: float) -> None:
    import pyvista

    mesh = pyvista.PolyData(points, np.column_stack([np.full(len(body.faces), 3), body.faces]).ravel())
    mesh.point_data["displacement"] = body.size / most if most > 0 else body.size
    look = {"ambient": 0.55, "diffuse": 0.55, "specular": 0.05, "show_scalar_bar": False}
    plotter.add_mesh(mesh, scalars="displacement", cmap=colour_map(), clim=(0, 1), **look)
    _lines(plotter, body, points, INK)


def _lines(plotter: Plotter, body: MovingBody, points: Array, colour: str) -> None:
    import pyvista

    if len(body.edges):
        lines = pyvista.PolyData(points, lines=np.column_stack([np.full(len(body.edges), 2), body.edges]).ravel())
        plotter.add_mesh(lines, color=colour, line_width=0.8 * SUPERSAMPLING, lighting=False)
