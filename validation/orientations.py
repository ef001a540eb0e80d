"""Inertia tensor and CoG from several orientations of one body.

A pendulum about the axis n sees one number, ``J = n^T Θ n``: linear in the six entries of the tensor, so several axes give them
by least squares. A body with a plane of symmetry needs three axes in that plane. When the axes leave a combination of entries
unseen, no arithmetic brings it back: it is refused, and the entries that suffer are named.

The hanging orientations also say where the CoG is: it lies on every plumb line through the suspension, so that lines drawn on the
body meet there.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.errors import BadInput

if TYPE_CHECKING:
    from uncertainties import UFloat

SIX = ("xx", "yy", "zz", "xy", "xz", "yz")
"""Entries of the tensor in the order of Eq. 4."""

PLANAR = ("xx", "zz", "xz")
"""What pendulums about axes in the plane of symmetry xz see of the tensor."""

UNSEEN = 1e-6
"""Singular value, relative to the largest, below which a combination of entries counts as not observable."""

PARALLEL = 1e-3
"""Sine of the angle between two plumb lines below which their intersection says nothing."""


def tensor_from_axes(
    axes: npt.ArrayLike, moments: Sequence[UFloat], components: Sequence[str] = SIX, source: str = "orientations"
) -> dict[str, UFloat]:
    """Entries `components` of the tensor [kg m²] from the `moments` (n,) [kg m²] about `axes` (n, 3), least squares.

    Axes are directions in the body's frame, of any length, numbers or quantities with tolerance; the tensor is about the point
    that all axes pass through. Entries not in `components` are taken as zero (symmetry). Products are matrix entries.
    Equation: ``J = sum_i n_i² I_ii + 2 sum_{i<j} n_i n_j I_ij``.

    Raises
    ------
    BadInput : the axes cannot see all `components`; the message names those that are not observable.
    """
    directions = np.array([_unit(axis) for axis in np.asarray(axes)])
    A = np.array([[_weight(n, entry) for entry in components] for n in directions])
    _require_observable(_nominal(A), components, source)
    return dict(zip(components, _least_squares(A, np.array(moments, dtype=object)), strict=True))


def unobservable(axes: npt.ArrayLike, components: Sequence[str] = SIX) -> tuple[str, ...]:
    """Those of `components` that moments about `axes` (n, 3) do not determine."""
    directions = np.array([_unit(axis) for axis in np.asarray(axes)])
    return _unseen(_nominal(np.array([[_weight(n, entry) for entry in components] for n in directions])), components)


def meeting_point(normals: npt.ArrayLike, offsets: Sequence[UFloat], source: str = "plumb lines") -> tuple[UFloat, UFloat]:
    """Where plumb lines ``n · p = offset`` of a plane meet: the mean of all their pairwise intersections.

    Parameters
    ----------
    normals : (n, 2), unit normals of the lines, numbers or quantities
    offsets : (n,) [m], signed distances of the lines from the origin of the plane

    Three lines with reading errors form a triangle; its corners are averaged. That is what the published bicycle data use; a
    least-squares fit to the lines gives another point, a few millimetres away when the lines are poorly crossed.

    Raises
    ------
    BadInput : fewer than two lines, or two of them nearly parallel.
    """
    lines = list(zip(np.asarray(normals), offsets, strict=True))
    if len(lines) < 2:
        problem = f"at least two plumb lines must cross, found {len(lines)}"
        raise BadInput(source=source, field="orientations", problem=problem, remedy="Hang the body in another orientation too")
    corners = [_intersection(one, other, source) for one, other in combinations(lines, 2)]
    x, z = (sum(corner[i] for corner in corners) / len(corners) for i in (0, 1))
    return x, z


def _unit(axis: Any) -> Any:
    length = sum(component**2 for component in axis) ** 0.5
    return np.array([component / length for component in axis])


def _weight(n: Any, entry: str) -> Any:
    i, j = ("xyz".index(letter) for letter in entry)
    return n[i] * n[j] * (1 if i == j else 2)


def _nominal(values: Any) -> Array:
    array = np.asarray(values, dtype=object)
    return np.array([_number(value) for value in array.ravel()]).reshape(array.shape)


def _number(value: Any) -> float:
    return float(getattr(value, "nominal_value", value))


def _least_squares(A: Any, b: Any) -> Any:
    """Solution of ``A x = b`` by least squares, linearised exactly in the tolerances of both `A` and `b`."""
    A0, b0 = _nominal(A), _nominal(b)
    inverse = np.linalg.pinv(A0)
    x0 = inverse @ b0
    r0 = b0 - A0 @ x0
    return x0 + inverse @ (b - A @ x0 - r0) + np.linalg.inv(A0.T @ A0) @ ((A - A0).T @ r0)


def _unseen(A: Array, components: Sequence[str]) -> tuple[str, ...]:
    _, singular, V = np.linalg.svd(A, full_matrices=True)
    rank = int(np.sum(singular > UNSEEN * singular[0]))
    null = V[rank:]
    return tuple(name for name, column in zip(components, null.T, strict=True) if np.any(np.abs(column) > UNSEEN))


def _require_observable(A: Array, components: Sequence[str], source: str) -> None:
    unseen = _unseen(A, components)
    if unseen:
        raise BadInput(
            source=source,
            field="axes",
            problem=f"{len(A)} axes do not determine {', '.join('I' + name for name in unseen)} of the {len(components)} entries",
            remedy="Swing about further axes, not in one plane with these, or state the symmetry with `components`",
        )


def _intersection(one: Any, other: Any, source: str) -> tuple[UFloat, UFloat]:
    (n, c), (m, d) = one, other
    determinant = n[0] * m[1] - n[1] * m[0]
    if abs(_number(determinant)) < PARALLEL:
        problem = "two plumb lines are parallel within 0.06 deg"
        raise BadInput(
            source=source, field="orientations", problem=problem, remedy="Hang the body in a clearly different orientation"
        )
    return (c * m[1] - d * n[1]) / determinant, (n[0] * d - m[0] * c) / determinant
