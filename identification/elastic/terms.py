"""`ElasticTerms`: what elasticity adds to the rigid mass matrix, in the form of Eq. 8b with poles that all 36 entries share.

    H(omega) = M_F + omega² L^T (Omega² - omega² + i omega C)^-1 L + omega² R

L holds a row of participation for each mode, C is the modal damping - diagonal 2 zeta omega, but full within a cluster -
and R, symmetric, is what all modes beyond the band answer statically. H(0) = M_F: that is the extrapolation to frequency 0.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from geometry.arrays import Array, frozen


@dataclass(frozen=True, eq=False, kw_only=True)
class ElasticTerms:
    """Elastic terms about the reference point; none at all by default.

    Attributes
    ----------
    frequency : (m,) [Hz] of the undamped modes of the blocked structure
    damping : (m, m) symmetric, 2 zeta omega on the diagonal [rad/s]
    participation : (m, 6) [sqrt(kg)] and [sqrt(kg) m], order of `MOTIONS`
    residual : (6, 6) symmetric, [kg s²], [kg m s²], [kg m² s²]
    """

    frequency: Array = field(default_factory=lambda: np.zeros(0))
    damping: Array = field(default_factory=lambda: np.zeros((0, 0)))
    participation: Array = field(default_factory=lambda: np.zeros((0, 6)))
    residual: Array = field(default_factory=lambda: np.zeros((6, 6)))

    def __post_init__(self) -> None:
        m = len(self.frequency)
        for name, shape in {"frequency": (m,), "damping": (m, m), "participation": (m, 6), "residual": (6, 6)}.items():
            object.__setattr__(self, name, frozen(getattr(self, name), shape, name))

    @property
    def damping_ratio(self) -> Array:
        """(m,) [1]."""
        return np.diag(self.damping) / (4 * np.pi * self.frequency)
