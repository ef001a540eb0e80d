"""How a table turns: rotation, spin and what accelerometers on it sense, without any assumption of smallness.

With the angles alpha, beta, gamma of `BaseMotion` a vector of the table's axes is, in the laboratory's,

    v_lab = R v,    R = R_x(alpha) R_y(beta) R_z(gamma),

so that alpha turns about the x axis of the laboratory, beta about the y axis that alpha has turned, gamma about the table's own z
axis. The spin is the sum of these three rates about these three axes, e_1 = x, e_2 = R_x y, e_3 = R_x R_y z:

    omega = alpha' e_1 + beta' e_2 + gamma' e_3
    omega' = alpha'' e_1 + beta'' e_2 + gamma'' e_3 + alpha' e_1 x beta' e_2 + (alpha' e_1 + beta' e_2) x gamma' e_3

(each axis turns with the rates before it). Only for small angles are alpha'', beta'', gamma'' the angular acceleration.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from fem.base_excitation.base_motion import BaseMotion
from geometry.arrays import Array, frozen


@dataclass(frozen=True, eq=False, kw_only=True)
class Turning:
    """The rotation of a table over time.

    Attributes
    ----------
    rotation : (n, 3, 3) its columns are the table's axes in the laboratory
    spin : (n, 3) [rad/s] in the laboratory's axes
    spin_rate : (n, 3) [rad/s²] its derivative, in the laboratory's axes
    """

    rotation: Array
    spin: Array
    spin_rate: Array

    def __post_init__(self) -> None:
        n = len(self.rotation)
        for name, shape in {"rotation": (n, 3, 3), "spin": (n, 3), "spin_rate": (n, 3)}.items():
            object.__setattr__(self, name, frozen(getattr(self, name), shape, name))

    def seen_from_table(self, vectors: npt.ArrayLike) -> Array:
        """R^T v: vectors (n, 3) of the laboratory's axes in the table's."""
        return _each("nji,nj->ni", self.rotation, vectors)

    def seen_from_laboratory(self, vectors: npt.ArrayLike) -> Array:
        """R v: vectors (n, 3) of the table's axes in the laboratory's."""
        return _each("nij,nj->ni", self.rotation, vectors)


def rotation(angles: npt.ArrayLike) -> Array:
    """R (n, 3, 3) of Tait-Bryan angles (n, 3) [rad] about x, y, z."""
    return np.asarray(np.stack(_axes(np.asarray(angles, dtype=np.float64))[1], axis=-1))


def turning(motion: BaseMotion) -> Turning:
    """How the table of `motion` turns."""
    angles, rates, accelerations = (x[:, 3:] for x in (motion.displacement, motion.velocity, motion.acceleration))
    turned_about, axes = _axes(angles)
    a, b, c = (rate[:, None] * axis for rate, axis in zip(rates.T, turned_about, strict=True))
    spin_rate = sum(x[:, None] * axis for x, axis in zip(accelerations.T, turned_about, strict=True))
    return Turning(rotation=np.stack(axes, axis=-1), spin=a + b + c, spin_rate=spin_rate + np.cross(a, b) + np.cross(a + b, c))


def accelerometer(motion: BaseMotion, place: npt.ArrayLike, gravity: float = 0.0) -> Array:
    """(n, 3) [m/s²] what an accelerometer fixed to the table at `place` reads, in the table's axes.

    R^T (p'' + g z) + omega' x r + omega x (omega x r) with omega, omega' and r in the table's axes: the last term is the
    centripetal one that the linear [G] of Eq. 3 does not know, the term of g is what gravity makes it read at rest and in a tilt.
    In the reference point R^T p'' is left, and R^T omega' is at once the derivative of the spin as the table sees it.

    Parameters
    ----------
    place : (3,) [m] from the reference point, in the table's axes
    gravity : g [m/s²], 0 for a purely kinematic reading
    """
    turned, r = turning(motion), np.asarray(place, dtype=np.float64)
    spin, spin_rate = (turned.seen_from_table(x) for x in (turned.spin, turned.spin_rate))
    straight = turned.seen_from_table(motion.acceleration[:, :3] + gravity * np.array([0.0, 0.0, 1.0]))
    return np.asarray(straight + np.cross(spin_rate, r) + np.cross(spin, np.cross(spin, r)))


def _each(product: str, matrices: Array, vectors: npt.ArrayLike) -> Array:
    return np.asarray(np.einsum(product, matrices, np.asarray(vectors, dtype=np.float64)))


def _axes(angles: Array) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
    """The three axes about which alpha, beta and gamma turn, and those of the table, all (n, 3) in the laboratory's."""
    (a, b, c), (sa, sb, sc) = np.cos(angles.T), np.sin(angles.T)
    zero, one = np.zeros_like(a), np.ones_like(a)
    first = np.column_stack([one, zero, zero])
    second = np.column_stack([zero, a, sa])
    third = np.column_stack([sb, -sa * b, a * b])
    x_axis = np.column_stack([b * c, a * sc + sa * sb * c, sa * sc - a * sb * c])
    return (first, second, third), (x_axis, np.cross(third, x_axis), third)
