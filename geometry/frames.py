"""Positions, rotations and the rigid transformation [G] of the paper's Eq. 3. Nothing else in massline writes them again.

Frames are right-handed with z up. A `Pose` says where a body's own frame sits in another one:
``p_outer = rotation @ p_body + position``.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

# Arrays that cannot change under anybody's feet.

Array = npt.NDArray[np.float64]

Integers = npt.NDArray[np.intp]


def frozen(value: npt.ArrayLike, shape: tuple[int, ...], name: str, kind: type = np.float64) -> npt.NDArray[Any]:
    """Copy `value` into a read-only array of `shape` and `kind`; one that is read-only and nobody else's stays what it is.

    Raises
    ------
    ValueError : `value` has another shape or holds NaN or infinity; the message names it and the first such entry.
    """
    safe = isinstance(value, np.ndarray) and not value.flags.writeable and value.base is None
    array: npt.NDArray[Any] = np.array(value, dtype=kind, copy=None if safe else True)
    if array.shape != shape:
        raise ValueError(f"`{name}` must have shape {shape}, found {array.shape}")
    if not np.all(np.isfinite(array)):
        first = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise ValueError(f"`{name}` must be finite, found {array[first]:g}" + (f" at {list(first)}" if first else ""))
    array.setflags(write=False)
    return array


def freeze(holder: object, *names: str, **shapes: tuple[int, ...]) -> None:
    """Make fields of a frozen dataclass `frozen` copies: those of these `names` as they are, the others of these `shapes`.

    Raises
    ------
    ValueError : as `frozen`.
    """
    for name in (*names, *shapes):
        value = getattr(holder, name)
        object.__setattr__(holder, name, frozen(value, shapes.get(name, np.shape(value)), name))


ROTATION_ROUNDING = 1e-9
"""How far R R^T may lie from the identity: a rotation typed with ten digits passes, one typed with four does not."""


def skew(vector: npt.ArrayLike) -> Array:
    """Matrix S of the cross product, ``S @ a = vector x a``; shape (3, 3), unit of `vector`."""
    x, y, z = np.asarray(vector, dtype=np.float64)
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def rotation_about(axis: str, angle: float) -> Array:
    """Rotation by `angle` [rad] about the coordinate axis "x", "y" or "z", right-handed; shape (3, 3)."""
    c, s = np.cos(angle), np.sin(angle)
    planes = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}
    if axis not in planes:
        raise ValueError(f"`axis` must be one of x, y, z, found {axis!r}")
    i, j = planes[axis]
    rotation = np.eye(3)
    rotation[i, i] = rotation[j, j] = c
    rotation[j, i], rotation[i, j] = s, -s
    return rotation


def rotation_by(turn: npt.ArrayLike) -> Array:
    """(3, 3) rotation about the vector `turn` (3,) by its length [rad] (Rodrigues)."""
    angle, S = float(np.linalg.norm(turn)), skew(turn)
    return np.asarray(np.eye(3) + np.sinc(angle / np.pi) * S + 0.5 * np.sinc(angle / (2 * np.pi)) ** 2 * S @ S)


def left_jacobian(turn: npt.ArrayLike) -> Array:
    """(3, 3) J: a small change t of `turn` (3,) [rad] rotates what `rotation_by` has turned already about ``J t``."""
    angle, S = float(np.linalg.norm(turn)), skew(turn)
    third = 1 / 6 if angle < 1e-3 else (angle - np.sin(angle)) / angle**3
    return np.asarray(np.eye(3) + 0.5 * np.sinc(angle / (2 * np.pi)) ** 2 * S + third * S @ S)


FLAT = 1e-9
"""Sine of the angle between two directions below which they span no plane."""


def axes_along(line: npt.ArrayLike, beside: npt.ArrayLike | None = None) -> Array:
    """Rows (3, 3): right-handed axes, the first along `line` (3,), the second in its plane with `beside` (3,) and on that side.

    Without `beside` the plane is that with the coordinate axis which is least along `line`.

    Raises
    ------
    ValueError : `line` or `beside` is nothing, or both are along one line.
    """
    x = np.asarray(line, dtype=np.float64)
    y = np.eye(3)[np.argmin(np.abs(x))] if beside is None else np.asarray(beside, dtype=np.float64)
    z = np.cross(x, y)
    if not np.linalg.norm(z) > FLAT * np.linalg.norm(x) * np.linalg.norm(y):
        raise ValueError(f"{x.tolist()} and {y.tolist()} span no axes")
    return np.array([one / np.linalg.norm(one) for one in (x, np.cross(z, x), z)])


def proper_rotation(value: npt.ArrayLike, name: str = "rotation") -> Array:
    """Read-only (3, 3) rotation matrix.

    Raises
    ------
    ValueError : not orthonormal within `ROTATION_ROUNDING`, or a reflection (determinant -1).
    """
    rotation = frozen(value, (3, 3), name)
    if np.abs(rotation @ rotation.T - np.eye(3)).max() > ROTATION_ROUNDING:
        raise ValueError(f"`{name}` must be orthonormal, found {rotation.tolist()}")
    if np.linalg.det(rotation) < 0:
        raise ValueError(f"`{name}` must be right-handed (determinant +1), found a reflection {rotation.tolist()}")
    return rotation


def rigid_transformation(point: npt.ArrayLike) -> Array:
    """[G] of the paper's Eq. 3: accelerations of `point` from those of the reference point A.

    Parameters
    ----------
    point : (3,) [m], from A, in the axes of A

    Returns
    -------
    (3, 6) : columns x, y, z [1] and alpha, beta, gamma [m]
    """
    return np.hstack([np.eye(3), -skew(point)])


def rigid_transformation_6(point: npt.ArrayLike) -> Array:
    """All six accelerations of `point` from the six of A: [G] of Eq. 3 above ``[0 I]``; shape (6, 6)."""
    return np.vstack([rigid_transformation(point), np.hstack([np.zeros((3, 3)), np.eye(3)])])


@dataclass(frozen=True, eq=False, kw_only=True)
class Pose:
    """Where a body's own frame sits in an outer frame.

    Attributes
    ----------
    position : (3,) [m], the body's origin in the outer frame
    rotation : (3, 3), its columns are the body's axes in the outer frame
    """

    position: Array = field(default_factory=lambda: np.zeros(3))
    rotation: Array = field(default_factory=lambda: np.eye(3))

    def __post_init__(self) -> None:
        freeze(self, position=(3,))
        object.__setattr__(self, "rotation", proper_rotation(self.rotation))

    def __matmul__(self, inner: "Pose") -> "Pose":
        """The pose of a body placed by `inner` in a frame that this pose places: first `inner`, then `self`."""
        return Pose(position=self.apply(inner.position), rotation=self.rotation @ inner.rotation)

    def apply(self, points: npt.ArrayLike) -> Array:
        """Body coordinates (..., 3) [m] expressed in the outer frame."""
        return np.asarray(points, dtype=np.float64) @ self.rotation.T + self.position

    @property
    def inverse(self) -> "Pose":
        """The pose of the outer frame seen from the body."""
        return Pose(position=-self.rotation.T @ self.position, rotation=self.rotation.T)
