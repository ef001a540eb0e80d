"""The three-dimensional part of a picture, rendered by pyvista: bodies one can look into, ellipsoid, axes and frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from validation.pictures.bodies import DrawnBody
from validation.pictures.ellipsoid import Ellipsoid
from validation.pictures.palette import ELLIPSOID, PAPER, UNCOUNTED, colours
from validation.pictures.view import View
from validation.pictures.window import off_screen

Image = npt.NDArray[np.uint8]
"""Pixels (height, width, 3), red, green and blue."""

SUPERSAMPLING = 2
"""Pixels are rendered so many times finer in each direction and averaged."""

PEELS = 12
"""Layers of translucent surfaces that are sorted; what lies deeper than that no one sees."""

SEEN_THROUGH = 0.45
"""How strongly arrows shine through the bodies in front of them."""

Plotter = Any
"""A `pyvista.Plotter`; the library is imported inside the functions."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Arrow:
    """An arrow from `start` to `end` (3,) [m] with a shaft of `radius` [m]."""

    start: Array
    end: Array
    radius: float
    colour: str


def rendered(view: View, bodies: Sequence[DrawnBody], ellipsoid: Ellipsoid | None, arrows: Sequence[Arrow]) -> Image:
    """The scene as seen by `view`, without an ellipsoid where there is none.

    Raises
    ------
    CheckFailed : nothing can be rendered on this machine.
    """
    with off_screen():
        whole = shot(view, lambda plotter: _all(plotter, bodies, ellipsoid, arrows))
        on_top = shot(view, lambda plotter: _arrows(plotter, arrows), transparent=True)
    alpha = SEEN_THROUGH * on_top[..., 3:] / 255.0
    blended = whole * (1 - alpha) + on_top[..., :3] * alpha
    return np.round(averaged(blended)).astype(np.uint8)


def shot(view: View, draw: Any, transparent: bool = False, peels: int = PEELS) -> npt.NDArray[np.uint8]:
    """One rendering, `SUPERSAMPLING` times finer than the view; with an alpha channel when `transparent`.

    `draw` puts things into the plotter it is given; `peels` layers of translucent surfaces are sorted, 0 where there are none.
    To be called inside of `off_screen`.
    """
    import pyvista

    width, height = view.size
    pixels = [width * SUPERSAMPLING, height * SUPERSAMPLING]
    plotter: Plotter = pyvista.Plotter(off_screen=True, window_size=pixels, lighting="none")
    try:
        plotter.disable_anti_aliasing()  # multisampling and depth peeling together lose the translucent bodies under Mesa
        plotter.set_background(PAPER)
        _light(plotter)
        draw(plotter)
        _look(plotter, view)
        if peels and not transparent:
            plotter.enable_depth_peeling(peels, 0.0)
        return np.asarray(plotter.screenshot(return_img=True, transparent_background=transparent))
    finally:
        plotter.close()


def _look(plotter: Plotter, view: View) -> None:
    camera = plotter.camera
    camera.enable_parallel_projection()
    distance = 10 * view.scale * max(view.size)
    camera.focal_point, camera.position, camera.up = view.centre, view.centre + distance * view.towards, view.up
    camera.parallel_scale = view.scale * view.size[1] / 2
    camera.clipping_range = (distance * 0.5, distance * 1.5)


def _light(plotter: Plotter) -> None:
    """Key light over the left shoulder, fill from the right, a little from behind; all move with the camera."""
    import pyvista

    for position, intensity in (((-1.0, 1.2, 2.0), 0.62), ((2.0, 0.3, 1.2), 0.36), ((0.0, 1.0, -1.5), 0.15)):
        light = pyvista.Light(light_type="camera light", intensity=intensity)
        light.position = position
        plotter.add_light(light)


def _all(plotter: Plotter, bodies: Sequence[DrawnBody], ellipsoid: Ellipsoid | None, arrows: Sequence[Arrow]) -> None:
    colour = colours(body.material for body in bodies)
    for body in bodies:
        _body(plotter, body, colour[body.material])
    if ellipsoid is not None:
        _ellipsoid(plotter, ellipsoid)
    _arrows(plotter, arrows)


def _body(plotter: Plotter, body: DrawnBody, colour: str) -> None:
    import pyvista

    shown, opacity, line = (colour, 0.55, 1.6) if body.counted else (UNCOUNTED, 0.10, 1.0)
    faces = np.column_stack([np.full(len(body.faces), 3), body.faces])
    mesh = pyvista.PolyData(body.vertices, faces.ravel())
    plotter.add_mesh(mesh, color=shown, opacity=opacity, ambient=0.62, diffuse=0.5, specular=0.08)
    edges = mesh.extract_feature_edges(30, boundary_edges=False, manifold_edges=False, non_manifold_edges=False)
    if edges.n_cells:
        edge_colour = pyvista.Color(shown).float_rgb
        darker = tuple(0.55 * c for c in edge_colour) if body.counted else edge_colour
        plotter.add_mesh(edges, color=darker, line_width=line * SUPERSAMPLING / 2, lighting=False)


def _ellipsoid(plotter: Plotter, ellipsoid: Ellipsoid) -> None:
    import pyvista

    ball = pyvista.Sphere(radius=1.0, theta_resolution=96, phi_resolution=96)
    surface = pyvista.PolyData(ellipsoid.stretched(ball.points), ball.faces)
    plotter.add_mesh(surface, color=ELLIPSOID, opacity=0.13, ambient=0.75, diffuse=0.35, smooth_shading=True)
    turn = np.linspace(0, 2 * np.pi, 181)
    for i in range(3):
        ring = np.zeros((len(turn), 3))
        ring[:, i - 2], ring[:, i - 1] = np.cos(turn), np.sin(turn)
        plotter.add_mesh(
            pyvista.MultipleLines(points=ellipsoid.stretched(ring)),
            color=ELLIPSOID,
            line_width=1.2 * SUPERSAMPLING / 2,
            lighting=False,
        )


def _arrows(plotter: Plotter, arrows: Sequence[Arrow]) -> None:
    import pyvista

    for arrow in arrows:
        reach = arrow.end - arrow.start
        length = float(np.linalg.norm(reach))
        mesh = pyvista.Arrow(
            start=arrow.start,
            direction=reach,
            scale=length,
            shaft_radius=arrow.radius / length,
            tip_radius=3 * arrow.radius / length,
            tip_length=9 * arrow.radius / length,
            shaft_resolution=24,
            tip_resolution=32,
        )
        plotter.add_mesh(mesh, color=arrow.colour, ambient=0.45, diffuse=0.6, specular=0.1)


def averaged(image: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """`image`, `SUPERSAMPLING` times finer than wanted, at the size wanted."""
    height, width = (length // SUPERSAMPLING for length in image.shape[:2])
    return np.asarray(image.reshape(height, SUPERSAMPLING, width, SUPERSAMPLING, 3).mean(axis=(1, 3)))
