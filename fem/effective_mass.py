"""`EffectiveMass`: what each mode moves along each axis, and how much of the structure the kept modes account for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.modes import Modes
from geometry.arrays import Array, frozen


@dataclass(frozen=True, eq=False, kw_only=True)
class EffectiveMass:
    """Effective mass and moment of inertia about the modes' reference point; axes x, y, z [kg], alpha, beta, gamma [kg m²].

    Attributes
    ----------
    frequency : (n,) [Hz]
    each : (n, 6) of every mode
    rigid : (6,) of the whole structure moving rigidly: the diagonal of its 6x6 mass matrix
    """

    frequency: Array
    each: Array
    rigid: Array

    def __post_init__(self) -> None:
        n = np.size(self.frequency)
        for name, shape in {"frequency": (n,), "each": (n, 6), "rigid": (6,)}.items():
            object.__setattr__(self, name, frozen(getattr(self, name), shape, name))

    @property
    def total(self) -> Array:
        """Sum over the modes (6,)."""
        return np.asarray(self.each.sum(axis=0))

    @property
    def share(self) -> Array:
        """Share of the rigid structure in each mode (n, 6) [1]; zero along an axis about which there is no inertia."""
        return np.asarray(np.divide(self.each, self.rigid, out=np.zeros_like(self.each), where=self.rigid > 0))

    @property
    def total_share(self) -> Array:
        """Share of the rigid structure in all modes (6,) [1]; it stays below 1 by what the base itself carries."""
        return np.asarray(self.share.sum(axis=0))


def table(modes: Modes) -> EffectiveMass:
    """Effective masses of `modes` beside the rigid structure."""
    return EffectiveMass(frequency=modes.frequency, each=modes.effective_mass, rigid=np.diag(modes.rigid_mass))
