"""Principal axes fit to be drawn, and the homogeneous ellipsoid that has a body's mass and moments."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array, frozen
from geometry.inertia import Inertia

EQUAL = 1e-6
"""Principal moments closer than this, relative to the largest, are equal: their axes are free to turn."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Ellipsoid:
    """Equivalent inertia ellipsoid of a body.

    Attributes
    ----------
    centre : (3,) [m], the CoG in the body's frame
    axes : (3, 3), principal axes as columns, right-handed
    moments : (3,) [kg m²], principal moments about the CoG, ascending
    semi_axes : (3,) [m] along the principal axes
    """

    centre: Array
    axes: Array
    moments: Array
    semi_axes: Array

    def stretched(self, unit: npt.ArrayLike) -> Array:
        """Points (n, 3) of the unit ball laid into the ellipsoid [m], in the body's frame."""
        return np.asarray(unit, dtype=np.float64) * self.semi_axes @ self.axes.T + self.centre

    @property
    def equal(self) -> tuple[tuple[int, int], ...]:
        """Neighbouring principal axes, counted from 0, whose moments are equal."""
        close = np.diff(self.moments) <= EQUAL * self.moments[2]
        return tuple((i, i + 1) for i in range(2) if close[i])


def equivalent_ellipsoid(inertia: Inertia) -> Ellipsoid:
    """The homogeneous ellipsoid of the body's mass, CoG and principal moments.

    A homogeneous ellipsoid has I1 = m/5 (b² + c²) and so on, hence a² = 5 (I2 + I3 - I1) / (2 m). Exists for every physical
    body; a semi-axis of an ideal one is zero.
    """
    moments, axes = inertia.principal()
    squares = 5 * (moments.sum() - 2 * moments) / (2 * inertia.mass)
    return Ellipsoid(
        centre=frozen(inertia.cog, (3,), "centre"),
        axes=frozen(_settled(moments, axes), (3, 3), "axes"),
        moments=frozen(moments, (3,), "moments"),
        semi_axes=frozen(np.sqrt(np.maximum(squares, 0)), (3,), "semi_axes"),
    )


def _settled(moments: Array, axes: Array) -> Array:
    """The axes with their freedom used up: those of equal moments along the frame, all as far as can be its positive way."""
    first, second = np.diff(moments) <= EQUAL * moments[2]
    one, two, three = (_forward(axis) for axis in axes.T)
    if first and second:
        return np.eye(3)
    if first:
        one = _nearest_in_plane(three)
        two = np.cross(three, one)
    elif second:
        two = _nearest_in_plane(one)
        three = np.cross(one, two)
    return _right_handed(np.column_stack([one, two, three]))


def _right_handed(axes: Array) -> Array:
    """When all forward axes are left-handed one has to point back: that along y, so that up stays up."""
    if np.linalg.det(axes) < 0:
        back = np.argmax(np.abs(axes[1]))
        axes[:, back] = -axes[:, back]
    return axes


def _forward(axis: Array) -> Array:
    """`axis` or its opposite, whichever has its largest component positive."""
    return np.asarray(axis * np.sign(axis[np.argmax(np.abs(axis))]))


def _nearest_in_plane(normal: Array) -> Array:
    """The frame axis that lies best in the plane across `normal`, laid into it."""
    axis = np.eye(3)[np.argmin(np.round(np.abs(normal), 6))]
    flat = axis - np.dot(axis, normal) * normal
    return np.asarray(flat / np.linalg.norm(flat))
