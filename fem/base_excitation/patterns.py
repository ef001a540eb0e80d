"""Patterns of excitation, and `BaseMotion`, which they become: sampled, with cross motion, and a rest at the end."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import ceil, comb, isfinite
from types import MappingProxyType
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import LEVELS, MOTIONS
from geometry.errors import BadInput
from geometry.frames import Array, freeze
from geometry.toml_file import one_of

# `BaseMotion`: what the table does, sampled, all six axes at once.
#
# Displacement is the primary quantity and velocity and acceleration are its exact derivatives, sampled at the same instants: an
# integrator may take whichever it needs, and the table is at rest before the first sample and after the last drive.


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
        freeze(self, displacement=(n, 6), velocity=(n, 6), acceleration=(n, 6), reference_point=(3,))

    @property
    def time(self) -> Array:
        """(n,) [s], from 0."""
        return np.arange(len(self.acceleration)) / self.sampling_rate

    @property
    def duration(self) -> float:
        """[s], from the first sample to the last."""
        return (len(self.acceleration) - 1) / self.sampling_rate


# Levels in words, and what every number of a pattern has to be.


def unit(axis: str) -> str:
    """Unit of acceleration along or about `axis`."""
    return "m/s²" if axis in MOTIONS[:3] else "rad/s²"


def listed(levels: Mapping[str, float]) -> str:
    """`levels` in words: ``x 2.5 m/s², gamma 6 rad/s²``."""
    return ", ".join(f"{axis} {level:g} {unit(axis)}" for axis, level in levels.items())


def require_positive(value: float, field: str, source: str, unit: str = "") -> None:
    """Refuse what is not a positive number.

    Raises
    ------
    BadInput : zero, negative, NaN or infinite.
    """
    if not (isfinite(value) and value > 0):
        raise BadInput(source, field, f"must be positive and finite, found {value:g} {unit}".rstrip(), "Give a positive number")


def require_not_negative(value: float, field: str, source: str, unit: str) -> None:
    """Refuse what is not a number from 0 up.

    Raises
    ------
    BadInput : negative, NaN or infinite.
    """
    if not (isfinite(value) and value >= 0):
        problem = f"must be finite and not negative, found {value:g} {unit}".rstrip()
        raise BadInput(source, field, problem, "Give 0 or a positive number")


def require_band(start: float, stop: float, source: str, *, line: bool = False) -> None:
    """Refuse a band [Hz] that does not ascend; a `line`, where both bounds are one, may be allowed.

    Raises
    ------
    BadInput : see above, and a bound that is not positive.
    """
    require_positive(start, "start", source, "Hz")
    require_positive(stop, "stop", source, "Hz")
    if start > stop or (start == stop and not line):
        raise BadInput(source, "start", f"must be below `stop`, found {start:g} Hz and {stop:g} Hz", "Give the lower bound first")


# `CrossMotion`: what a real table does besides what it is asked for, a few per cent in all other axes (paper, section 4).
#
# The motion of every axis is passed on to every other one by two taps of a filter, one at once and one a quarter period of the
# middle frequency later. Their two real weights give any share and phase lag there; away from it both change smoothly. A filter
# of finite length keeps what the patterns promise: derivatives stay exact, and the table comes to rest, one delay later.

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
        freeze(self, share=(6, 6), lag=(6, 6))
        require_positive(self.frequency, "frequency", SOURCE, "Hz")
        worst = np.unravel_index(np.argmax(np.abs(self.share)), (6, 6))
        if abs(self.share[worst]) > LARGEST_SHARE:
            to, of = (MOTIONS[int(i)] for i in worst)
            problem = f"must be at most {LARGEST_SHARE:g} everywhere, found {self.share[worst]:g} of {of} in {to}"
            raise BadInput(SOURCE, "share", problem, "Give a few per cent, such as 0.03")

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


def drawn(generator: np.random.Generator, share: float = 0.03) -> CrossMotion:
    """Cross motion of any table: shares of `share` on average, anything between none and twice that, and lags of every size.

    Raises
    ------
    BadInput : a `share` that is negative, NaN, or so large that one beyond `LARGEST_SHARE` was drawn.
    """
    require_not_negative(share, "share", SOURCE, "")
    amplitude = 2 * share * generator.uniform(size=(6, 6))
    return CrossMotion(share=amplitude * (1 - np.eye(6)), lag=generator.uniform(0.0, 2 * np.pi, (6, 6)))


# `Jet`: a function of time with its first two derivatives, and the product rule.
#
# A pattern writes its displacement as products of such functions (a window, an amplitude, a carrier), and velocity and
# acceleration follow to rounding, without a difference quotient.

SMOOTH = 5
"""Derivatives of the smooth step that vanish at both of its ends: what is built of it has five continuous derivatives."""


@dataclass(frozen=True, eq=False)
class Jet:
    """A function of time, sampled.

    Attributes
    ----------
    value, first, second : (n,) the function, and its first [1/s] and second [1/s²] derivative with respect to time
    """

    value: Array
    first: Array
    second: Array

    def __add__(self, other: "Jet") -> "Jet":
        return Jet(self.value + other.value, self.first + other.first, self.second + other.second)

    def __mul__(self, other: "Jet") -> "Jet":
        """The product of two functions: (a b)'' = a'' b + 2 a' b' + a b''."""
        return Jet(
            self.value * other.value,
            self.first * other.value + self.value * other.first,
            self.second * other.value + 2 * self.first * other.first + self.value * other.second,
        )

    def __rmul__(self, factor: float) -> "Jet":
        return Jet(factor * self.value, factor * self.first, factor * self.second)


def sine(phase: Jet) -> Jet:
    """Sine of an angle [rad] that is itself a function of time."""
    s, c = np.sin(phase.value), np.cos(phase.value)
    return Jet(s, phase.first * c, phase.second * c - phase.first**2 * s)


def exponential(time: Array, factor: float, rate: float) -> Jet:
    """`factor` times exp(`rate` t) of `time` (n,) [s]."""
    value = factor * np.exp(rate * time)
    return Jet(value, rate * value, rate**2 * value)


def smooth_step(time: Array, begin: float, end: float) -> Jet:
    """From 0 at `begin` to 1 at `end` [s], with `SMOOTH` continuous derivatives; constant outside.

    With x from 0 to 1 between the two its derivative is x^p (1 - x)^p over the integral of that, p = `SMOOTH`: the step is the
    regularised incomplete beta function I_x(p + 1, p + 1), here as the sum of Bernstein polynomials that it is.
    """
    p, length = SMOOTH, end - begin
    x = np.clip((time - begin) / length, 0.0, 1.0)
    rising = (x > 0) & (x < 1)
    r = x[rising]
    value, first, second = (x >= 1).astype(np.float64), np.zeros_like(x), np.zeros_like(x)
    n = 2 * p + 1
    value[rising] = sum(comb(n, k) * r**k * (1 - r) ** (n - k) for k in range(p + 1, n + 1))
    bell = (n * comb(2 * p, p)) * (r * (1 - r)) ** (p - 1)  # over the beta function of p + 1 and p + 1
    first[rising] = bell * r * (1 - r) / length
    second[rising] = p * bell * (1 - 2 * r) / length**2
    return Jet(value, first, second)


def window(time: Array, begin: float, full: float, fading: float, end: float) -> Jet:
    """1 between `full` and `fading`, 0 before `begin` and after `end` [s], smooth in between."""
    fall = smooth_step(time, fading, end)
    return smooth_step(time, begin, full) * Jet(1 - fall.value, -fall.first, -fall.second)


RAMP_CYCLES = 3.0
"""A soft start or stop lasts at least as many cycles of the lowest frequency driven then."""

MOST_SAMPLES = 20_000_000
"""Of one motion: 40 minutes at 8 kHz, and 3 GB."""


@dataclass(frozen=True, kw_only=True)
class Clock:
    """Equally spaced instants: the sample j is at j / `sampling_rate` - `late` [s]."""

    sampling_rate: float
    count: int
    late: float = 0.0

    @property
    def time(self) -> Array:
        """(count,) [s]."""
        return np.arange(self.count) / self.sampling_rate - self.late


class Pattern(Protocol):
    """A closed form of what the table does."""

    @property
    def label(self) -> str:
        """What is driven, in words."""

    @property
    def driven(self) -> float:
        """[s] from the first motion to the last; the table is at rest before and after."""

    @property
    def highest(self) -> float:
        """[Hz] the highest frequency that is driven on purpose, soft start and stop included."""

    def signals(self, clock: Clock) -> Mapping[str, Jet]:
        """Displacement [m, rad] of every axis that is driven, with its derivatives, at the instants of `clock`."""


def sampled(
    pattern: Pattern,
    sampling_rate: float,
    *,
    ring_down: float,
    cross: CrossMotion | None = None,
    reference_point: npt.ArrayLike = (0.0, 0.0, 0.0),
) -> BaseMotion:
    """`pattern` at `sampling_rate` [Hz], followed by `ring_down` [s] of rest, as motion about `reference_point` (3,) [m].

    Every pattern has it as its method `motion`.

    Raises
    ------
    BadInput : a sampling rate or ring-down that cannot be, a pattern beyond the Nyquist frequency, a record of more than
        `MOST_SAMPLES`.
    """
    require_positive(sampling_rate, "sampling_rate", pattern.label, "Hz")
    require_not_negative(ring_down, "ring_down", pattern.label, "s")
    require_below_nyquist(pattern, sampling_rate)
    driven = pattern.driven + (cross.delay if cross else 0.0)
    samples = (driven + ring_down) * sampling_rate
    if samples > MOST_SAMPLES:
        problem = f"the record would have {samples:.3g} samples, more than {MOST_SAMPLES:.3g}"
        raise BadInput(pattern.label, "", problem, "Sweep faster, shorten the record or sample slower")
    clock = Clock(sampling_rate=sampling_rate, count=ceil(samples - 1e-6) + 1)
    signals, to = driven_by(pattern, clock, cross)
    displacement, velocity, acceleration = (to @ signals).transpose(0, 2, 1)
    return BaseMotion(
        sampling_rate=sampling_rate,
        displacement=displacement,
        velocity=velocity,
        acceleration=acceleration,
        driven=driven,
        reference_point=np.asarray(reference_point, dtype=np.float64),
        label=pattern.label,
    )


def driven_by(pattern: Pattern, clock: Clock, cross: CrossMotion | None = None) -> tuple[Array, Array]:
    """Displacement, velocity, acceleration (3, a, n) of every axis that is driven at the instants of `clock`, and with `cross` a
    delay later; and (6, a) how far each axis of the table follows."""
    passed = [(pattern.signals(clock), cross.at_once if cross else np.eye(6))]
    if cross:
        passed.append((pattern.signals(replace(clock, late=clock.late + cross.delay)), cross.delayed))
    jets = [jet for signals, _ in passed for jet in signals.values()]
    columns = np.stack([to[:, MOTIONS.index(axis)] for signals, to in passed for axis in signals], axis=1)
    return np.array([[getattr(jet, order) for jet in jets] for order in ("value", "first", "second")]), columns


def require_below_nyquist(pattern: Pattern, sampling_rate: float) -> None:
    """Refuse a rate that cannot hold what is driven.

    Raises
    ------
    BadInput : `pattern` goes beyond half of `sampling_rate` [Hz].
    """
    if pattern.highest >= sampling_rate / 2:
        problem = f"must be above twice the highest frequency driven, {pattern.highest:.4g} Hz, found {sampling_rate:g} Hz"
        raise BadInput(pattern.label, "sampling_rate", problem, "Sample faster or stop the excitation lower")


# Noise of one level over a band as a sum of equally strong lines of random phase, evaluated by FFT with exact derivatives.


def period(duration: float) -> int:
    """[s] after which noise repeats itself: whole seconds, so that its lines are the same at every whole sampling rate."""
    return max(1, ceil(duration - 1e-9))


def line_numbers(start: float, stop: float, duration: float) -> range:
    """Those multiples of 1 / `period` that lie between `start` and `stop` [Hz], both included."""
    T = period(duration)
    return range(ceil(start * T - 1e-9), int(stop * T + 1e-9) + 1)


def noise(clock: Clock, lines: Array, phase: Array, duration: float, rms: float) -> Jet:
    """Displacement whose acceleration has the root mean square `rms` over a period, at the instants of `clock`.

    a = A sum_k cos(omega_k t + phi_k) with A = `rms` sqrt(2 / number of lines), and u of every line is -1/omega² of its a.

    Raises
    ------
    BadInput : a sampling rate at which the period has no whole number of samples.
    """
    T = period(duration)
    n = round(T * clock.sampling_rate)
    if abs(n - T * clock.sampling_rate) > 1e-6:
        problem = f"noise of a period of {T} s needs a whole number of samples in it, found {T * clock.sampling_rate:.6g}"
        raise BadInput("noise", "sampling_rate", problem, "Sample at a whole number of hertz")
    omega = 2 * np.pi * lines / T
    acceleration = rms * np.sqrt(2 / lines.size) * np.exp(1j * (phase - omega * clock.late))
    derivatives = []
    for order in range(3):  # one period by FFT, and then repeated
        spectrum = np.zeros(n // 2 + 1, dtype=np.complex128)
        spectrum[lines.astype(np.intp)] = acceleration * (1j * omega) ** (order - 2) * n / 2
        derivatives.append(np.resize(np.fft.irfft(spectrum, n), clock.count))
    return Jet(*derivatives)


# `Random`: noise of constant strength over a band, on one axis or several at once, the axes independent of each other.


@dataclass(frozen=True, eq=False, kw_only=True)
class InBand:
    """What lies in one band [Hz] for one `duration` [s]; `seed` of what is drawn for it."""

    start: float = 4.0
    stop: float = 32.0
    duration: float = 90.0
    seed: int | np.random.Generator = 0

    @property
    def driven(self) -> float:
        """[s]."""
        return self.duration

    @property
    def highest(self) -> float:
        """[Hz]."""
        return self.stop


@dataclass(frozen=True, eq=False, kw_only=True)
class Random(InBand):
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

    def __post_init__(self) -> None:
        _settle(self, "rms", 3 * RAMP_CYCLES, "random excitation")

    @property
    def label(self) -> str:
        """What is driven, in words."""
        return f"random {self.start:g}-{self.stop:g} Hz, {self.duration:g} s, rms {listed(self.rms)}"

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
    lines = np.array(line_numbers(start, stop, duration), dtype=np.float64)
    # Phase [rad] of every line, for every axis whether it is driven or not: the axes of a pattern do not shift each other's
    generator = np.random.default_rng(seed)
    phase = {axis: generator.uniform(0.0, 2 * np.pi, lines.size) for axis in MOTIONS}
    return {axis: shape * noise(clock, lines, phase[axis], duration, level) for axis, level in rms.items()}


def _settle(pattern: "Random | Burst", levels: str, cycles: float, source: str, *, line: bool = False) -> None:
    """Refuse a pattern that cannot be; its field `levels` is then in the order of axes, and its seed a number.

    `cycles` of its lowest frequency are what it needs to start and stop softly; a `line`, one frequency alone, may be allowed.
    """
    start, stop, duration, seed = pattern.start, pattern.stop, pattern.duration, pattern.seed
    named: Mapping[str, float] = getattr(pattern, levels)
    if not named:
        raise BadInput(source, levels, "names no axis", f"Name some of {', '.join(MOTIONS)}")
    for axis, level in named.items():
        one_of(axis, MOTIONS, source=source, where=levels)
        require_positive(level, f"{levels}.{axis}", source, unit(axis))
    in_order = MappingProxyType({axis: float(named[axis]) for axis in MOTIONS if axis in named})
    object.__setattr__(pattern, levels, in_order)
    require_band(start, stop, source, line=line)
    require_positive(duration, "duration", source, "s")
    if duration * start < cycles:
        problem = f"must be at least {cycles:g} cycles of {start:g} Hz, {cycles / start:.4g} s, found {duration:g} s"
        raise BadInput(source, "duration", problem, "Drive longer or start higher")
    if start < stop and not line_numbers(start, stop, duration):
        problem = f"no line of noise of {duration:g} s lies between {start:g} and {stop:g} Hz"
        raise BadInput(source, "stop", problem, "Drive longer or widen the band")
    number = int(seed.integers(2**63)) if isinstance(seed, np.random.Generator) else seed
    if number < 0:
        raise BadInput(source, "seed", f"must not be negative, found {number}", "Give 0 or more")
    object.__setattr__(pattern, "seed", number)


# `Burst`: a short piece of sine or noise and then silence, so that the article rings down alone.


@dataclass(frozen=True, eq=False, kw_only=True)
class Burst(InBand):
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
    duration: float = 4.0

    def __post_init__(self) -> None:
        _settle(self, "level", RAMP_CYCLES, "burst excitation", line=True)

    @property
    def label(self) -> str:
        """What is driven, in words."""
        what = f"noise {self.start:g}-{self.stop:g} Hz" if self.start < self.stop else f"sine {self.start:g} Hz"
        return f"burst of {what}, {self.duration:g} s, {listed(self.level)}"

    def signals(self, clock: Clock) -> Mapping[str, Jet]:
        """Displacement [m, rad] of every axis that is driven, with its derivatives, at the instants of `clock`."""
        half = self.duration / 2
        if self.start < self.stop:
            return noisy(self.level, self.start, self.stop, self.duration, self.seed, clock, half)
        shape = window(clock.time, 0.0, half, half, self.duration)
        # sin(omega t) / omega², whose second derivative has the amplitude 1
        time, omega = clock.time - half, 2 * np.pi * self.start
        carrier = shape * (omega**-2 * sine(Jet(omega * time, np.full_like(time, omega), np.zeros_like(time))))
        return {axis: -level * carrier for axis, level in self.level.items()}

    motion = sampled


# `Sweep`: a sine whose frequency rises by a constant number of octaves a minute, the excitation of the paper's tests.

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
            raise BadInput(source, "phase", f"must be finite, found {self.phase:g}", "Give radians")
        fastest = np.sqrt(2 * LEVEL_ERROR) * 2 * np.pi * self.start * 60 / np.log(2)
        if self.rate > fastest:
            problem = f"at most {fastest:.4g} oct/min keep the level at {self.start:g} Hz, found {self.rate:g} oct/min"
            raise BadInput(source, "rate", problem, "Sweep slower or start higher")

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
            raise BadInput(self.label, "frequency", problem, "Name a frequency in between")
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


# `MultiAxis`: several patterns at the same time, and six runs of them that are linearly independent.


@dataclass(frozen=True, eq=False, kw_only=True)
class MultiAxis:
    """All of `patterns` at once: sweeps of several axes with phases and delays of their own, noise on one and a sweep on another.

    Attributes
    ----------
    patterns : at least one; where two drive the same axis they add up
    title : what it is called; by default the labels of its patterns

    Raises
    ------
    BadInput : no pattern.
    """

    patterns: tuple[Pattern, ...]
    title: str = ""

    def __post_init__(self) -> None:
        if not self.patterns:
            raise BadInput("multi-axis excitation", "patterns", "is empty", "Name at least one")

    @property
    def label(self) -> str:
        """What is driven, in words."""
        return self.title or " together with ".join(pattern.label for pattern in self.patterns)

    @property
    def driven(self) -> float:
        """[s] until the last pattern has come to rest."""
        return max(pattern.driven for pattern in self.patterns)

    @property
    def highest(self) -> float:
        """[Hz] of all patterns."""
        return max(pattern.highest for pattern in self.patterns)

    def signals(self, clock: Clock) -> Mapping[str, Jet]:
        """Displacement [m, rad] of every axis that is driven, with its derivatives, at the instants of `clock`."""
        total: dict[str, Jet] = {}
        for pattern in self.patterns:
            for axis, jet in pattern.signals(clock).items():
                total[axis] = total[axis] + jet if axis in total else jet
        return total

    motion = sampled


def phased_sweeps(level: float = 1.0, **changes: Any) -> tuple[MultiAxis, ...]:
    """Six runs that sweep all six axes at once, each at `level` times its nominal level; `changes` are fields of `Sweep`.

    In run r the axis k leads by 2 pi r k / 6. At every frequency of the band the six columns of the paper's S_u are then those of
    a discrete Fourier transform: in units of the nominal levels they are orthogonal, the best condition that six runs can have.

    Raises
    ------
    BadInput : what `Sweep` refuses.
    """
    return tuple(
        MultiAxis(
            title=f"sine sweep of all six axes at once, run {run + 1} of 6",
            patterns=tuple(
                Sweep(axis=axis, level=level, phase=2 * np.pi * run * k / 6, **changes) for k, axis in enumerate(MOTIONS)
            ),
        )
        for run in range(6)
    )
