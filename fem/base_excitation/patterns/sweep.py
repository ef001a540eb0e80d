"""`Sweep`: a sine whose frequency rises by a constant number of octaves a minute, the excitation of the paper's tests."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from fem.base_excitation.patterns.jet import Jet, exponential, sine, window
from fem.base_excitation.patterns.levels import (
    listed,
    require_band,
    require_not_negative,
    require_positive,
)
from fem.base_excitation.patterns.pattern import RAMP_CYCLES, Clock, sampled
from geometry.arrays import Array
from geometry.dynamic_mass import LEVELS, MOTIONS
from geometry.errors import BadInput
from geometry.keys import one_of

RAMP_OCTAVES = 1 / 12
"""Least width of soft start and soft stop, below and above the band."""

LEVEL_ERROR = 0.002
"""Largest relative deviation of the realised acceleration from its nominal level within the band."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Sweep:
    """A logarithmic sine sweep along or about one axis, at full level over the whole band from `start` to `stop`.

    Soft start and soft stop lie outside the band: it begins below `start` and ends above `stop`, by `RAMP_OCTAVES`, or by
    `RAMP_CYCLES` of the band's edge where the sweep is so fast that this is more. The displacement is
    u = -A w sin(phi) / omega², with the window w, omega = 2 pi f growing as exp(k t), and phi its integral. The acceleration is
    its exact second derivative and so has the amplitude A (1 + (k/omega)²/2 + ...): 4e-7 above nominal at the paper's rate, and
    never more than `LEVEL_ERROR`.

    Attributes
    ----------
    axis : of `MOTIONS`
    start, stop : [Hz] the band
    rate : [octaves per minute]
    level : in units of `LEVELS`
    phase : [rad] of the sine, where it begins
    delay : [s] of rest before it begins

    Raises
    ------
    BadInput : an unknown axis, a band that does not ascend, a rate or level that is not positive, a rate so fast that the level
        would be off by more than `LEVEL_ERROR`.

    Source: paper, section 4.
    """

    axis: str
    start: float = 4.0
    stop: float = 32.0
    rate: float = 2.0
    level: float = 1.0
    phase: float = 0.0
    delay: float = 0.0

    def __post_init__(self) -> None:
        source = "sine sweep"
        one_of(self.axis, MOTIONS, source=source, where="axis")
        require_band(self.start, self.stop, source)
        require_positive(self.rate, "rate", source, "oct/min")
        require_positive(self.level, "level", source)
        require_not_negative(self.delay, "delay", source, "s")
        if not np.isfinite(self.phase):
            raise BadInput(source=source, field="phase", problem=f"must be finite, found {self.phase:g}", remedy="Give radians")
        self._require_slow(source)

    @property
    def amplitude(self) -> float:
        """Acceleration in the band [m/s² or rad/s²]."""
        return self.level * LEVELS[self.axis]

    @property
    def label(self) -> str:
        """What is driven, in words."""
        return f"sine sweep {self.start:g}-{self.stop:g} Hz, {self.rate:g} oct/min, {listed({self.axis: self.amplitude})}"

    @property
    def lowest(self) -> float:
        """[Hz] where it begins, soft start included."""
        return float(self.start * 2.0 ** -_ramp(self.start, self.rate))

    @property
    def highest(self) -> float:
        """[Hz] where it ends, soft stop included."""
        return float(self.stop * 2.0 ** _ramp(self.stop, self.rate))

    @property
    def driven(self) -> float:
        """[s] from the start of the record to the end of the soft stop."""
        return float(self.time_at(self.highest))

    def frequency_at(self, time: npt.ArrayLike) -> Array:
        """Instantaneous frequency [Hz] at `time` [s]; before the sweep begins and after it has ended, that of the nearer end."""
        after = np.clip(np.asarray(time, dtype=np.float64), self.delay, self.driven) - self.delay
        return np.asarray(self.lowest * np.exp(self._growth * after))

    def time_at(self, frequency: npt.ArrayLike) -> Array:
        """When [s] the sweep passes `frequency` [Hz].

        Raises
        ------
        BadInput : a frequency that lies outside `lowest` to `highest`.
        """
        f = np.asarray(frequency, dtype=np.float64)
        inside = (f >= self.lowest * (1 - 1e-9)) & (f <= self.highest * (1 + 1e-9))
        if not np.all(inside):
            problem = f"the sweep runs from {self.lowest:.4g} to {self.highest:.4g} Hz, found {f[~inside].flat[0]:g} Hz"
            raise BadInput(source=self.label, field="frequency", problem=problem, remedy="Name a frequency in between")
        return np.asarray(self.delay + np.log(f / self.lowest) / self._growth)

    def signals(self, clock: Clock) -> Mapping[str, Jet]:
        """Displacement [m, rad] along the axis, with its derivatives, at the instants of `clock`."""
        k, first = self._growth, 2 * np.pi * self.lowest
        begin, full, fading, end = (float(self.time_at(f)) for f in (self.lowest, self.start, self.stop, self.highest))
        time = np.clip(clock.time, begin, end) - begin  # outside, the window is 0 and so is all that it multiplies
        angle = exponential(time, first / k, k)
        phi = Jet(angle.value - first / k + self.phase, angle.first, angle.second)
        shape = window(clock.time, begin, full, fading, end)
        return {self.axis: -self.amplitude * (shape * exponential(time, first**-2, -2 * k) * sine(phi))}

    motion = sampled

    @property
    def _growth(self) -> float:
        """[1/s] of the logarithm of the frequency."""
        return float(self.rate * np.log(2) / 60)

    def _require_slow(self, source: str) -> None:
        fastest = np.sqrt(2 * LEVEL_ERROR) * 2 * np.pi * self.start * 60 / np.log(2)
        if self.rate > fastest:
            problem = f"at most {fastest:.4g} oct/min keep the level at {self.start:g} Hz, found {self.rate:g} oct/min"
            raise BadInput(source=source, field="rate", problem=problem, remedy="Sweep slower or start higher")


def sweeps(level: float = 1.0, **changes: Any) -> dict[str, Sweep]:
    """The paper's six sweeps by axis, at `level` times the nominal one; `changes` are fields of `Sweep`.

    Raises
    ------
    BadInput : what `Sweep` refuses.
    """
    return {axis: Sweep(axis=axis, level=level, **changes) for axis in MOTIONS}


def _ramp(edge: float, rate: float) -> float:
    """[octaves] that a soft start or stop takes beside the `edge` [Hz] of the band."""
    return max(RAMP_OCTAVES, RAMP_CYCLES / edge * rate / 60)
