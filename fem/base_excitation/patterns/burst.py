"""`Burst`: a short piece of sine or noise and then silence, so that the article rings down alone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from fem.base_excitation.patterns.jet import Jet, sine, window
from fem.base_excitation.patterns.levels import listed, require_axes, require_band, require_positive
from fem.base_excitation.patterns.noise import fixed, noisy, require_cycles, require_lines
from fem.base_excitation.patterns.pattern import RAMP_CYCLES, Clock, sampled
from geometry.arrays import Array
from geometry.dynamic_mass import LEVELS


@dataclass(frozen=True, eq=False, kw_only=True)
class Burst:
    """A swell of sine (`start` equal to `stop`) or of noise over a band, rising to its middle and falling to its end.

    Attributes
    ----------
    level : acceleration [m/s², rad/s²] by axis in the middle of the burst: amplitude of a sine, root mean square of noise
    start, stop : [Hz] the band; one and the same frequency for a sine
    duration : [s] of the burst
    seed : of the noise, a number or a generator from which one is drawn here; a sine needs none, all its axes are in phase

    Raises
    ------
    BadInput : an unknown axis or none, a level, band or duration that cannot be, fewer than `RAMP_CYCLES` cycles (of such a kick
        the level would not be the stated one), a band so narrow that it holds no line, a negative seed.
    """

    level: Mapping[str, float] = field(default_factory=lambda: LEVELS)
    start: float = 4.0
    stop: float = 32.0
    duration: float = 4.0
    seed: int | np.random.Generator = 0

    def __post_init__(self) -> None:
        source = "burst excitation"
        object.__setattr__(self, "level", require_axes(self.level, "level", source))
        require_band(self.start, self.stop, source, line=True)
        require_positive(self.duration, "duration", source, "s")
        require_cycles(self.duration, self.start, RAMP_CYCLES, source)
        if self.start < self.stop:
            require_lines(self.start, self.stop, self.duration, source)
        object.__setattr__(self, "seed", fixed(self.seed, source))

    @property
    def label(self) -> str:
        """What is driven, in words."""
        what = f"noise {self.start:g}-{self.stop:g} Hz" if self.start < self.stop else f"sine {self.start:g} Hz"
        return f"burst of {what}, {self.duration:g} s, {listed(self.level)}"

    @property
    def driven(self) -> float:
        """[s]."""
        return self.duration

    @property
    def highest(self) -> float:
        """[Hz]."""
        return self.stop

    def signals(self, clock: Clock) -> Mapping[str, Jet]:
        """Displacement [m, rad] of every axis that is driven, with its derivatives, at the instants of `clock`."""
        half = self.duration / 2
        if self.start < self.stop:
            return noisy(self.level, self.start, self.stop, self.duration, self.seed, clock, half)
        shape = window(clock.time, 0.0, half, half, self.duration)
        carrier = shape * _sine(clock.time - half, 2 * np.pi * self.start)
        return {axis: -level * carrier for axis, level in self.level.items()}

    motion = sampled


def _sine(time: Array, omega: float) -> Jet:
    """sin(omega t) / omega², whose second derivative has the amplitude 1."""
    return omega**-2 * sine(Jet(omega * time, np.full_like(time, omega), np.zeros_like(time)))
