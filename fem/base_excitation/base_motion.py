"""`BaseMotion`: what the table does, sampled, all six axes at once.

Displacement is the primary quantity and velocity and acceleration are its exact derivatives, sampled at the same instants: an
integrator may take whichever it needs, and the table is at rest before the first sample and after the last drive.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from geometry.frames import Array, frozen


@dataclass(frozen=True, eq=False, kw_only=True)
class BaseMotion:
    """Motion of a rigid table, in the frame fixed in the laboratory whose origin is the reference point at rest.

    Attributes
    ----------
    sampling_rate : [Hz]
    displacement, velocity, acceleration : (n, 6) x, y, z [m, m/s, m/s²] of the reference point, and alpha, beta, gamma [rad, ...]
        as Tait-Bryan angles about x, y, z as exudyn's Rxyz counts them, which for small motion are the rotations of Eq. 1
    driven : [s] how long the table is driven; from then on it stands still and the article rings down
    reference_point : (3,) [m], in the frame of what stands on the table: F, or the origin of an article without FMD
    label : what was driven, in words
    """

    sampling_rate: float
    displacement: Array
    velocity: Array
    acceleration: Array
    driven: float
    reference_point: Array = field(default_factory=lambda: np.zeros(3))
    label: str = "base motion"

    def __post_init__(self) -> None:
        n = np.shape(self.acceleration)[0]
        for name in ("displacement", "velocity", "acceleration"):
            object.__setattr__(self, name, frozen(getattr(self, name), (n, 6), name))
        object.__setattr__(self, "reference_point", frozen(self.reference_point, (3,), "reference_point"))

    @property
    def time(self) -> Array:
        """(n,) [s], from 0."""
        return np.arange(len(self.acceleration)) / self.sampling_rate

    @property
    def duration(self) -> float:
        """[s], from the first sample to the last."""
        return (len(self.acceleration) - 1) / self.sampling_rate
