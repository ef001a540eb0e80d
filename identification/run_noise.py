"""`RunNoise`: the noise of loads and base motions, run by run and line by line, from the noise of the channels behind them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array, frozen
from geometry.sensors import motion_rows, resultants
from identification.spectra.line_spectra import Spectra


@dataclass(frozen=True, eq=False, kw_only=True)
class RunNoise:
    """Covariances of complex noise, E n n^H, the same for all phases; motions and loads are independent of each other.

    Attributes
    ----------
    load : (r, n, 6, 6) of forces and moments about the reference point, in their units squared
    motion : (r, n, 6, 6) of the base motions about the same point
    """

    load: Array
    motion: Array

    def __post_init__(self) -> None:
        shape = np.asarray(self.load).shape
        if len(shape) != 4 or shape[2:] != (6, 6):
            raise ValueError(f"`load` must have shape (r, n, 6, 6), found {shape}")
        object.__setattr__(self, "load", frozen(self.load, shape, "load"))
        object.__setattr__(self, "motion", frozen(self.motion, shape, "motion"))

    @staticmethod
    def of_deviations(load: Array, motion: Array) -> RunNoise:
        """From standard deviations (r, n, 6) each, all components independent."""
        return RunNoise(load=_diagonal(load), motion=_diagonal(motion))

    @staticmethod
    def of_spectra(spectra: Spectra, groups: Sequence[str] = ("cover",)) -> RunNoise:
        """What the noise of the channels makes of the resultants, and of the base motion by the accelerometers of `groups`.

        All accelerometers weigh alike; so Eqs. 6 and 7 without weights.
        """
        table = spectra.table
        felt, moved = table.select(quantity=("force", "moment"), group="fmd"), table.select(quantity="acceleration", group=groups)
        to_load = resultants([table.channels[k] for k in felt], table.origin)
        to_motion = np.asarray(np.linalg.pinv(motion_rows([table.channels[k] for k in moved], table.origin)), dtype=np.float64)
        load, motion = (_through(M, spectra.noise[:, :, k]) for M, k in ((to_load, felt), (to_motion, moved)))
        return RunNoise(load=load, motion=motion)


def _diagonal(deviation: Array) -> Array:
    return np.asarray(np.square(deviation)[..., :, None] * np.eye(6))


def _through(M: Array, deviation: Array) -> Array:
    """M diag(deviation²) M^T at every run and line."""
    return np.asarray(np.einsum("jc,rnc,kc->rnjk", M, np.square(deviation), M, optimize=True))
