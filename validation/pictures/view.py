"""The camera: a parallel projection, so that a scale bar is true everywhere in the picture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array, frozen

AZIMUTH = np.radians(-62.0)
"""Where the camera stands, from +x towards +y: x runs to the right, y into the picture."""


@dataclass(frozen=True, eq=False, kw_only=True)
class View:
    """A parallel projection onto an image.

    Attributes
    ----------
    right, up, towards : (3,), the image's axes and the way to the camera, an orthonormal right-handed set in the article's frame
    centre : (3,) [m], what is in the middle of the image
    scale : [m] a pixel
    size : width and height of the image [pixel]
    """

    right: Array
    up: Array
    towards: Array
    centre: Array
    scale: float
    size: tuple[int, int]

    def pixel(self, points: npt.ArrayLike) -> Array:
        """Where `points` (..., 3) [m] appear: (..., 2) [pixel], to the right and down from the upper left corner."""
        arm = np.asarray(points, dtype=np.float64) - self.centre
        across, upwards = arm @ self.right / self.scale, arm @ self.up / self.scale
        width, height = self.size
        return np.stack([width / 2 + across, height / 2 - upwards], axis=-1)


def fitted(points: Array, size: tuple[int, int], margin: float) -> View:
    """The view in which `points` (n, 3) [m] fill an image of `size` [pixel] but for `margin` [pixel] on every side.

    A flat article is looked at from higher up, so that its upper face shows.
    """
    towards = _direction(_elevation(points))
    right = np.cross([0.0, 0.0, 1.0], towards)
    right /= np.linalg.norm(right)
    up = np.cross(towards, right)
    axes = np.column_stack([right, up, towards])
    lower, upper = (points @ axes).min(axis=0), (points @ axes).max(axis=0)
    room = np.array(size) - 2 * margin
    return View(
        right=frozen(right, (3,), "right"),
        up=frozen(up, (3,), "up"),
        towards=frozen(towards, (3,), "towards"),
        centre=frozen(axes @ ((lower + upper) / 2), (3,), "centre"),
        scale=float(((upper - lower)[:2] / room).max()),
        size=size,
    )


def _direction(elevation: float) -> Array:
    c, s = np.cos(elevation), np.sin(elevation)
    return np.array([c * np.cos(AZIMUTH), c * np.sin(AZIMUTH), s])


def _elevation(points: Array) -> float:
    """Camera height above the horizon [rad]: 18° for what is at least as tall as wide, 34° for a plate."""
    extent = np.ptp(points, axis=0)
    slender = min(extent[2] / max(extent[0], extent[1], 1e-12), 1.0)
    return float(np.radians(34.0 - 16.0 * slender))
