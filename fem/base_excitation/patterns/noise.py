"""`Random`: noise of constant strength over a band, on one axis or several at once, the axes independent of each other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from fem.base_excitation.patterns.jet import Jet, window
from fem.base_excitation.patterns.levels import listed, require_axes, require_band, require_positive
from fem.base_excitation.patterns.lines import ends, noise, numbers, phases
from fem.base_excitation.patterns.pattern import RAMP_CYCLES, Clock, sampled
from geometry.dynamic_mass import LEVELS
from geometry.errors import BadInput


@dataclass(frozen=True, eq=False, kw_only=True)
class Random:
    """Band-limited noise: equally strong lines of random phase, between a smooth start and a smooth end.

    Every line of the band is there in every draw, so no frequency is left without excitation. The root mean square is that of the
    noise at full strength; the soft start and stop, `RAMP_CYCLES` of `start` each, lie within `duration`.

    Attributes
    ----------
    rms : root mean square acceleration [m/s², rad/s²] by axis
    start, stop : [Hz] the band
    duration : [s]
    seed : a number or a generator, from which a number is drawn here: a pattern gives the same motion whenever it is asked

    Raises
    ------
    BadInput : an unknown axis or none, a level, band or duration that cannot be, a duration too short for soft start and stop, a
        band so narrow that it holds no line, a negative seed.
    """

    rms: Mapping[str, float] = field(default_factory=lambda: LEVELS)
    start: float = 4.0
    stop: float = 32.0
    duration: float = 90.0
    seed: int | np.random.Generator = 0

    def __post_init__(self) -> None:
        source = "random excitation"
        object.__setattr__(self, "rms", require_axes(self.rms, "rms", source))
        require_band(self.start, self.stop, source)
        require_positive(self.duration, "duration", source, "s")
        require_cycles(self.duration, self.start, 3 * RAMP_CYCLES, source)
        require_lines(self.start, self.stop, self.duration, source)
        object.__setattr__(self, "seed", fixed(self.seed, source))

    @property
    def label(self) -> str:
        """What is driven, in words."""
        return f"random {self.start:g}-{self.stop:g} Hz, {self.duration:g} s, rms {listed(self.rms)}"

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
        ramp = RAMP_CYCLES / self.start
        return noisy(self.rms, self.start, self.stop, self.duration, self.seed, clock, ramp)

    motion = sampled


def noisy(
    rms: Mapping[str, float],
    start: float,
    stop: float,
    duration: float,
    seed: int | np.random.Generator,
    clock: Clock,
    ramp: float,
) -> dict[str, Jet]:
    """Noise of every axis under one window that rises and falls within `ramp` [s]."""
    shape = window(clock.time, 0.0, ramp, duration - ramp, duration)
    lines = numbers(start, stop, duration)
    phase = phases(np.random.default_rng(seed), lines)
    return {axis: shape * noise(clock, lines, phase[axis], duration, level) for axis, level in rms.items()}


def fixed(seed: int | np.random.Generator, source: str) -> int:
    """`seed` as a number: itself, or one drawn from the generator.

    Raises
    ------
    BadInput : a negative number.
    """
    number = int(seed.integers(2**63)) if isinstance(seed, np.random.Generator) else seed
    if number < 0:
        raise BadInput(source=source, field="seed", problem=f"must not be negative, found {number}", remedy="Give 0 or more")
    return number


def require_cycles(duration: float, start: float, cycles: float, source: str) -> None:
    """Refuse what is too short to start and stop softly.

    Raises
    ------
    BadInput : `duration` [s] holds fewer than `cycles` of `start` [Hz].
    """
    if duration * start < cycles:
        problem = f"must be at least {cycles:g} cycles of {start:g} Hz, {cycles / start:.4g} s, found {duration:g} s"
        raise BadInput(source=source, field="duration", problem=problem, remedy="Drive longer or start higher")


def require_lines(start: float, stop: float, duration: float, source: str) -> None:
    """Refuse a band that holds no line.

    Raises
    ------
    BadInput : see above.
    """
    first, last = ends(start, stop, duration)
    if last < first:
        problem = f"no line of noise of {duration:g} s lies between {start:g} and {stop:g} Hz"
        raise BadInput(source=source, field="stop", problem=problem, remedy="Drive longer or widen the band")
