"""Resonances of a whole rig: article on its joint on its cells, cables included, the table held.

What is not linear is taken as it is while little moves: cells pressed together, loose parts held by their friction.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fem.base_excitation.rig import Rig
from geometry.arrays import Array, frozen
from geometry.frames import rigid_transformation

TABLE = 6


@dataclass(frozen=True, eq=False, kw_only=True)
class RigModes:
    """Modes of a rig with its table held, ascending, and what it weighs.

    Attributes
    ----------
    frequency : (k,) [Hz]
    damping_ratio : (k,) [1]
    participation : (6, k) about F, of mass-normalised modes
    rigid_mass : (6, 6) of all that the table carries, about F
    resonance : (k,) whether it is one; the others carry what the modes left out answer statically
    """

    frequency: Array
    damping_ratio: Array
    participation: Array
    rigid_mass: Array
    resonance: tuple[bool, ...]

    def __post_init__(self) -> None:
        k = np.size(self.frequency)
        for name, shape in (("frequency", (k,)), ("damping_ratio", (k,)), ("participation", (6, k)), ("rigid_mass", (6, 6))):
            object.__setattr__(self, name, frozen(getattr(self, name), shape, name))


def rig_modes(rig: Rig) -> RigModes:
    """The modes of `rig`.

    Raises
    ------
    BadInput : a rig that cannot be built.
    """
    from scipy.linalg import eigh

    from fem.base_excitation.rig_structure import matrices

    linear = replace(rig, frictions=(), cells=tuple(replace(cell, preload=None) for cell in rig.cells))
    made = matrices(linear)
    table, rest = slice(None, TABLE), slice(TABLE, None)
    squares, Phi = eigh(made.stiffness[rest, rest], made.mass[rest, rest]) if len(made.mass) > TABLE else _none()
    omega = np.sqrt(np.maximum(squares, np.finfo(np.float64).tiny))
    viscous = np.einsum("ir,ij,jr->r", Phi, made.viscous[rest, rest], Phi)
    return RigModes(
        frequency=omega / (2 * np.pi),
        damping_ratio=viscous / (2 * omega),
        participation=made.mass[table, rest] @ Phi,
        rigid_mass=made.mass[table, table] + _loose(rig),
        resonance=tuple((_carried(rig, made.stiffness[rest, rest], Phi) < omega**2 / 2).tolist()),
    )


def _carried(rig: Rig, stiffness: Array, shapes: Array) -> Array:
    """(k,) twice the strain energy of mass-normalised `shapes` (n, k) in the coordinates beside the article's kept modes."""
    beside = len(rig.article.reduced.mass) - TABLE - len(rig.article.kept)
    own = slice(len(stiffness) - beside, None)
    return np.asarray(np.einsum("ir,ij,jr->r", shapes[own], stiffness[own, own], shapes[own]))


def _none() -> tuple[Array, Array]:
    return np.zeros(0), np.zeros((0, 0))


def _loose(rig: Rig) -> Array:
    """(6, 6) what the loose parts add while they are held: point masses at the article's origin."""
    G = rigid_transformation(rig.seat)
    return np.asarray(sum(friction.mass for friction in rig.frictions) * (G.T @ G))
