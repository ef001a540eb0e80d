"""`CrossMotion`: what a real table does besides what it is asked for, a few per cent in all other axes (paper, section 4).

The motion of every axis is passed on to every other one by two taps of a filter, one at once and one a quarter period of the
middle frequency later. Their two real weights give any share and phase lag there; away from it both change smoothly. A filter of
finite length keeps what the patterns promise: derivatives stay exact, and the table comes to rest, one delay later.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from fem.base_excitation.patterns.levels import require_not_negative, require_positive
from geometry.arrays import Array, frozen
from geometry.dynamic_mass import LEVELS, MOTIONS, ComplexArray
from geometry.errors import BadInput

SOURCE = "cross motion"

MIDDLE = float(np.sqrt(4.0 * 32.0))
"""[Hz] the middle of the paper's band, on a logarithmic scale."""

LARGEST_SHARE = 0.5
"""Of one axis in another, relative to nominal levels; beyond it a run no longer drives the axis that it is named after."""


@dataclass(frozen=True, eq=False, kw_only=True)
class CrossMotion:
    """How far every axis (rows) follows the drive of every axis (columns), in the order of `MOTIONS`.

    Attributes
    ----------
    share : (6, 6) amplitude [1] in units of the nominal levels of both axes, at `frequency`; elsewhere it lies between none and
        the square root of 2 times this. The diagonal is what comes on top of the drive itself
    lag : (6, 6) [rad] by which it lags behind the drive at `frequency`
    frequency : [Hz]
    """

    share: Array
    lag: Array
    frequency: float = MIDDLE

    def __post_init__(self) -> None:
        for name in ("share", "lag"):
            object.__setattr__(self, name, frozen(getattr(self, name), (6, 6), name))
        require_positive(self.frequency, "frequency", SOURCE, "Hz")
        worst = np.unravel_index(np.argmax(np.abs(self.share)), (6, 6))
        if abs(self.share[worst]) > LARGEST_SHARE:
            to, of = (MOTIONS[int(i)] for i in worst)
            problem = f"must be at most {LARGEST_SHARE:g} everywhere, found {self.share[worst]:g} of {of} in {to}"
            raise BadInput(source=SOURCE, field="share", problem=problem, remedy="Give a few per cent, such as 0.03")

    @property
    def delay(self) -> float:
        """[s] between the two taps: a quarter period."""
        return 0.25 / self.frequency

    @property
    def at_once(self) -> Array:
        """(6, 6) weights of the tap without delay, the drive itself included; in SI."""
        return np.eye(6) + self._scale * self.share * np.cos(self.lag)

    @property
    def delayed(self) -> Array:
        """(6, 6) weights of the tap that comes `delay` later; in SI."""
        return self._scale * self.share * np.sin(self.lag)

    @property
    def _scale(self) -> Array:
        """(6, 6) nominal level of the axis that follows over that of the axis driven."""
        levels = np.array([LEVELS[axis] for axis in MOTIONS])
        return np.asarray(levels[:, None] / levels)

    def transfer(self, frequency: npt.ArrayLike) -> ComplexArray:
        """(n, 6, 6) motion of all axes (rows) for a unit drive of each (columns), in SI, at `frequency` (n,) [Hz]."""
        late = np.exp(-2j * np.pi * self.delay * np.atleast_1d(np.asarray(frequency, dtype=np.float64)))
        return np.asarray(self.at_once + late[:, None, None] * self.delayed)


def drawn(generator: np.random.Generator, share: float = 0.03) -> CrossMotion:
    """Cross motion of any table: shares of `share` on average, anything between none and twice that, and lags of every size.

    Raises
    ------
    BadInput : a `share` that is negative, NaN, or so large that one beyond `LARGEST_SHARE` was drawn.
    """
    require_not_negative(share, "share", SOURCE, "")
    amplitude = 2 * share * generator.uniform(size=(6, 6))
    return CrossMotion(share=amplitude * (1 - np.eye(6)), lag=generator.uniform(0.0, 2 * np.pi, (6, 6)))
