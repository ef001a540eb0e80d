"""Small swings about the equilibrium: the period that an amplitude of nothing would have, and the fastest motion of the ropes.

Mass and stiffness are those of `statics` at rest: links that stretch add G^T G / c, links that do not take their direction away
from the motions. No exudyn in it: it says beforehand what step a simulation needs, and afterwards whether it was right.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.flexible_body.rope_pendulum.statics import VERTICAL, Pose, Ropework, mass, stiffness
from fem.flexible_body.rope_pendulum.suspension import refused
from geometry.arrays import Array

NEUTRAL = 1e-9
"""Eigenvalue over the largest of the slow ones below which the body does not come back."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Swings:
    """Small undamped swings.

    Attributes
    ----------
    omega : (m,) [rad/s], ascending
    shapes : (k, m) of the coordinates of `statics`
    twist : which of them is the twist
    inertia : [kg m²] modal mass of the twist for one radian about the vertical
    """

    omega: Array
    shapes: Array
    twist: int
    inertia: float

    @property
    def period(self) -> float:
        """[s] of the small twist."""
        return float(2 * np.pi / self.omega[self.twist])

    @property
    def shape(self) -> Array:
        """(k,) the twist, one radian about the vertical."""
        column = self.shapes[:, self.twist]
        return np.asarray(column / column[VERTICAL])


def swings(work: Ropework, pose: Pose) -> Swings:
    """All small swings of `work` about its equilibrium `pose`.

    Raises
    ------
    BadInput : the body does not come back from some motion: it would tip over.
    """
    from scipy.linalg import eigh, null_space

    H, G = stiffness(work, pose)
    M = mass(work, pose)
    c = np.repeat(work.compliance, work.links)
    if c.any():
        Z, K = np.eye(work.size), H + G.T @ (G / c[:, None])
    else:
        Z, K = null_space(G), H
    values, vectors = eigh(Z.T @ K @ Z, Z.T @ M @ Z)
    if values[0] <= NEUTRAL * work.gravity / float(work.link_lengths.max() * work.links):
        raise refused(
            "height", "the body would tip over: it does not come back from a tilt", "Tie the ropes higher above the CoG"
        )
    shapes = Z @ vectors
    shares = shapes[VERTICAL] ** 2 * M[VERTICAL, VERTICAL]  # of the twist in the energy of each mode, which is one half
    twist = int(np.argmax(shares))
    return Swings(omega=np.sqrt(values), shapes=shapes, twist=twist, inertia=float(1 / shapes[VERTICAL, twist] ** 2))
