"""What effects change: a prediction at its stages, from the matrices of the structure to what the channels read.

Effects act in the order of the model file, stage by stage. Every noun is frozen; an equation returns a changed copy.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array, frozen
from validation.classical.pendulum import plane_amplitude_factor, rope_amplitude_factor
from validation.effects.effect import Values

NOTHING: Mapping[str, Array] = MappingProxyType({})


@dataclass(frozen=True, eq=False, kw_only=True)
class Matrices:
    """Reduced matrices of what stands on its base: ``f = (K + i (omega C + S) - omega² M) x``.

    The first `base` coordinates x are the motions of the base about the article's origin (six, in the order of `MOTIONS`, or
    none where the structure is held); the others are its own, relative to the base.

    Attributes
    ----------
    base : 6 or 0
    mass, stiffness, viscous, structural : (k, k) symmetric, SI
    places : by name (3, k), what each coordinate moves a place along x, y, z
    parts : by name (k, k), the share of a part in `stiffness`
    cog : (3,) [m] of the article as drawn, from its origin
    """

    base: int
    mass: Array
    stiffness: Array
    viscous: Array
    structural: Array
    places: Mapping[str, Array] = field(default_factory=lambda: NOTHING)
    parts: Mapping[str, Array] = field(default_factory=lambda: NOTHING)
    cog: Array = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        k = len(self.mass)
        for name in ("mass", "stiffness", "viscous", "structural"):
            object.__setattr__(self, name, frozen(getattr(self, name), (k, k), name))
        object.__setattr__(self, "cog", frozen(self.cog, (3,), "cog"))


@dataclass(frozen=True, eq=False, kw_only=True)
class MountedDynamicMass:
    """The dynamic mass of the article on its place.

    Attributes
    ----------
    frequency : (n,) [Hz]
    matrix : (n, 6, 6) of the article, about its origin and in its axes when it stands as drawn
    seat : (3,) [m] where its origin is drawn, from the reference point F
    cog : (3,) [m] of the article as drawn, from its origin
    amplitude : (6,) [m/s², rad/s²] of the base motion of the run, zeros where it is not stated
    sweep_rate : [octaves/s] of the run; 0 where it is not stated
    block : [s] of the blocks of peak-reference-hold, 0 for full-record spectra
    """

    frequency: Array
    matrix: ComplexArray
    seat: Array = field(default_factory=lambda: np.zeros(3))
    cog: Array = field(default_factory=lambda: np.zeros(3))
    amplitude: Array = field(default_factory=lambda: np.zeros(6))
    sweep_rate: float = 0.0
    block: float = 0.0


@dataclass(frozen=True, eq=False, kw_only=True)
class ChannelResponse:
    """What every channel reads for a unit of each of the inputs: base motions, or the force of a drive point.

    Attributes
    ----------
    frequency : (n,) [Hz]
    channels : (c,) names
    rows : (n, c, k) complex
    amplitude : (n, c) what each channel reads of the run's motion in time, amplitude in its SI unit; zeros where not stated
    peak : (c,) largest amplitude of each channel in the run that was driven at nominal level; empty where not stated: then the
        largest of `amplitude`
    """

    frequency: Array
    channels: tuple[str, ...]
    rows: ComplexArray
    amplitude: Array = field(default_factory=lambda: np.zeros((0, 0)))
    peak: Array = field(default_factory=lambda: np.zeros(0))

    def column(self, channel: str) -> int:
        """Where `channel` stands in `rows`.

        Raises
        ------
        BadInput : there is no such channel.
        """
        if channel not in self.channels:
            problem = "an effect acts on this channel, and the data have none of that name"
            raise BadInput(source="effect", field=channel, problem=problem, remedy=f"Known are {', '.join(self.channels)}")
        return self.channels.index(channel)


@dataclass(frozen=True, eq=False, kw_only=True)
class NoiseModel:
    """How much noise is expected.

    Attributes
    ----------
    frequency : (n,) [Hz]
    channels : (c,) names
    quantities : (c,) "acceleration", "force" or "moment"
    deviation : (n, c) standard deviation of the complex noise of a line, in the unit of the spectra
    per_rms : (c,) `deviation` for a broadband noise of 1 SI unit rms in the time record; zeros where records are not known
    hum : (n, c) what the mains' ordinary hum leaves at a line, in the unit of the spectra; empty where it is not known
    """

    frequency: Array
    channels: tuple[str, ...]
    quantities: tuple[str, ...]
    deviation: Array
    per_rms: Array
    hum: Array = field(default_factory=lambda: np.zeros((0, 0)))


@dataclass(frozen=True, eq=False, kw_only=True)
class PendulumSwing:
    """A pendulum as it was measured.

    Attributes
    ----------
    period : [s] predicted
    amplitude : [rad] of the swing, 0 where not stated
    damping_ratio : [1], 0 where not stated
    mass, inertia : [kg], [kg m²] of what hangs on the ropes, the latter about the axis of the swing
    ropes : number of ropes; 0 for a body on a pivot
    length : [m] of a rope
    radii : (ropes,) [m] of the attachments from the axis
    gravity : [m/s²]
    """

    period: float
    amplitude: float = 0.0
    damping_ratio: float = 0.0
    mass: float = 0.0
    inertia: float = 0.0
    ropes: int = 2
    length: float = 0.0
    radii: Array = field(default_factory=lambda: np.zeros(0))
    gravity: float = 9.81


# Equations of what happens to whole channels, each linear in the rows that it gets.


def inverted(reading: ChannelResponse, targets: tuple[str, ...], values: Values) -> ChannelResponse:
    """``-y``"""
    return times(reading, targets[0], -1.0)


def scaled(reading: ChannelResponse, targets: tuple[str, ...], values: Values) -> ChannelResponse:
    """``factor y``"""
    return times(reading, targets[0], values[""])


def swapped(reading: ChannelResponse, targets: tuple[str, ...], values: Values) -> ChannelResponse:
    """Each of two channels reads what the other would."""
    order = np.arange(len(reading.channels))
    one, other = (reading.column(name) for name in targets)
    order[[one, other]] = other, one
    amplitude, peak = (one[..., order] if one.size else one for one in (reading.amplitude, reading.peak))
    return replace(reading, rows=reading.rows[:, order], amplitude=amplitude, peak=peak)


def times(reading: ChannelResponse, channel: str, factor: float) -> ChannelResponse:
    """`reading` with one channel multiplied."""
    factors = np.ones(len(reading.channels))
    factors[reading.column(channel)] = factor
    amplitude, peak = (one * np.abs(factors) if one.size else one for one in (reading.amplitude, reading.peak))
    return replace(reading, rows=reading.rows * factors[:, None], amplitude=amplitude, peak=peak)


# Describing functions: what a channel that is not linear reads of a sine, as a share of what it should read.
#
# The fundamental alone: a slow sweep is a sine at every moment, and its harmonics appear at other lines, where the sweep is at
# another time. They are not predicted; a full-record spectrum holds them at three times the frequency, small as they are.


TINY = float(np.finfo(np.float64).tiny)

WARP = {"1": (1, -1, 1, -1), "2": (-1, 1, -1, 1), "3": (1, -1, 1, -1), "4": (-1, 1, -1, 1)}
"""What four cells on a square, numbered around, can carry against each other without any resultant."""

CELLS = ("fmd-z1", "fmd-z2", "fmd-z3", "fmd-z4")


def saturated(reading: ChannelResponse, targets: tuple[str, ...], values: Values) -> ChannelResponse:
    """``y (1 - 3/4 s (a / y_p)²)``, a the amplitude at a line and y_p the peak of the run at nominal level."""
    k = reading.column(targets[0])
    a = amplitude_of(reading, k)
    peak = reading.peak[k] if reading.peak.size else np.max(a, initial=0.0)
    rows = np.array(reading.rows)
    rows[:, k] *= (1 - 0.75 * values[""] * (a / max(peak, TINY)) ** 2)[:, None]
    return replace(reading, rows=rows)


def lifted(reading: ChannelResponse, targets: tuple[str, ...], values: Values) -> ChannelResponse:
    """A cell pulls no more than its preload. What it lacks goes to the other three, in the one pattern that has no resultant."""
    cell = reading.column(CELLS[int(targets[0]) - 1])
    lost = 1 - clipped(values[""], amplitude_of(reading, cell))
    rows, missing = np.array(reading.rows), lost[:, None] * reading.rows[:, cell]
    for name, share in zip(CELLS, WARP[targets[0]], strict=True):
        rows[:, reading.column(name)] -= share * missing
    return replace(reading, rows=rows)


def clipped(preload: float, amplitude: Array) -> Array:
    """(n,) share of the fundamental that is left of a sine of `amplitude` (n,) cut off at -`preload` on one side."""
    p = np.divide(np.minimum(preload, amplitude), amplitude, out=np.ones_like(amplitude), where=amplitude > 0)
    return np.asarray(0.5 + (np.arcsin(p) + p * np.sqrt(1 - p**2)) / np.pi)


def amplitude_of(reading: ChannelResponse, column: int) -> Array:
    """(n,) amplitude in time of a channel; zeros where the run does not state it."""
    return reading.amplitude[:, column] if reading.amplitude.size else np.zeros(len(reading.frequency))


# Equations of the noise that is expected.


NEAREST = 0.1
"""[Hz] from the mains, within which their frequency wanders."""


def louder(floor: NoiseModel, targets: tuple[str, ...], values: Values) -> NoiseModel:
    """Variances of independent noise add."""
    k, deviation = floor.channels.index(targets[0]), np.array(floor.deviation)
    deviation[:, k] = np.hypot(deviation[:, k], values[""] * floor.per_rms[k])
    return replace(floor, deviation=deviation)


def humming(floor: NoiseModel, targets: tuple[str, ...], values: Values) -> NoiseModel:
    """The ordinary hum is in the noise that was measured: more of it adds, less takes off, and never all."""
    if not floor.hum.size:
        return floor
    factor = values[""]
    change = (factor**2 - 1) * floor.hum**2
    variance = np.maximum(floor.deviation**2 + change, (min(factor, 1.0) * floor.deviation) ** 2)
    return replace(floor, deviation=np.sqrt(variance), hum=factor * floor.hum)


def leak(frequency: Array, mains: float = 50.0) -> Array:
    """(n,) [1/Hz] standard deviation of what a hum of amplitude 1 at `mains` [Hz] leaves at a line of a full record.

    A record of whole or half periods leaves nothing or twice as much; how it is cut is not known, and the mean square is taken.
    Lines closer than `NEAREST` are as those at that distance.
    """
    away = np.maximum(np.abs(frequency - mains), NEAREST)
    return np.asarray(1 / (2 * np.sqrt(2) * np.pi * away))


# Masses, springs and resonators on reduced matrices: what several families of the structure have in common.


ALONG = {"": (0, 1, 2), "lateral": (0, 1), "vertical": (2,)}
"""Which of x, y, z a direction means."""

BASE = 6


def heavier(stage: Matrices, mass: Array) -> Matrices:
    """`stage` with `mass` (k, k) more."""
    return replace(stage, mass=stage.mass + mass)


def with_resonators(stage: Matrices, place: str, axes: tuple[int, ...], values: Values) -> Matrices:
    """`stage` with a resonator along each of `axes` at `place`: mass ``m``, frequency ``f``, damping ratio ``zeta``."""
    for axis in axes:
        # One more coordinate, the motion of a mass on a spring relative to ``row @ x``, on which it rides
        m, omega = values["m"], 2 * np.pi * values["f"]
        rides = np.append(stage.places[place][axis], 1.0)
        mass, stiffness, viscous, structural = (
            _grown(a, 1) for a in (stage.mass, stage.stiffness, stage.viscous, stage.structural)
        )
        mass += m * np.outer(rides, rides)
        stiffness[-1, -1] = omega**2 * m
        viscous[-1, -1] = 2 * values["zeta"] * omega * m
        stage = replace(
            stage,
            mass=mass,
            stiffness=stiffness,
            viscous=viscous,
            structural=structural,
            places={name: _grown(rows, 0) for name, rows in stage.places.items()},
            parts={name: _grown(share, 1) for name, share in stage.parts.items()},
        )
    return stage


def _grown(matrix: Array, rows: int) -> Array:
    """`matrix` with a column of zeros more, and with `rows` rows of them: hundreds of resonators find `numpy.pad` slow."""
    n, m = matrix.shape
    found = np.zeros((n + rows, m + 1))
    found[:n, :m] = matrix
    return found


# What blocks of a Hann window make of a dynamic mass while a sweep passes (peak-reference-hold).
#
# Around the moment at which a logarithmic sweep passes f it is a chirp of s = f ln 2 rate [Hz/s], with the spectrum
# exp(-i pi (nu - f)² / s) by stationary phase. A block of length T around that moment reads at f, of a load H u,
#
#     H'(f) = int H(nu) W(f - nu) exp(-i pi (nu - f)² / s) dnu / the same without H,
#
# W the transform of the window, real for a window that is even about its middle. Linear in H, so derivatives pass through it.
# Between lines H is interpolated by cubic splines: they must lie closer than a third of the half-power width of what is to be
# seen.


LOBES = 12.0
"""Widths 1 / T of the window to either side that count: beyond, its transform has fallen to 1e-4."""

FINER = 16
"""Points of the kernel for every width 1 / T."""


def held(mounted: MountedDynamicMass, targets: tuple[str, ...], values: Values) -> MountedDynamicMass:
    """`mounted` as peak-reference-hold shows it; unchanged where the run states no blocks or no sweep."""
    if mounted.block <= 0 or mounted.sweep_rate <= 0 or len(mounted.frequency) < 2:
        return mounted
    S = _operator(mounted.frequency.tobytes(), mounted.sweep_rate, mounted.block)
    return replace(mounted, matrix=np.einsum("nm,mij->nij", S, mounted.matrix))


@lru_cache(maxsize=8)
def _operator(frequency: bytes, rate: float, block: float) -> ComplexArray:
    return operator(np.frombuffer(frequency), rate, block)


def operator(frequency: Array, rate: float, block: float) -> ComplexArray:
    """(n, n) from H at the lines `frequency` (n,) [Hz] to what blocks of `block` [s] read in a sweep of `rate` [octaves/s].

    Beyond the first and the last line H is taken to stay as it is there.
    """
    from scipy.interpolate import CubicSpline

    n = len(frequency)
    offsets = np.arange(-LOBES * FINER, LOBES * FINER + 1) / (FINER * block)
    kernel = window(offsets * block) * np.exp(-1j * np.pi * offsets**2 / (frequency[:, None] * np.log(2) * rate))
    kernel /= kernel.sum(axis=1, keepdims=True)
    at = np.clip(frequency[:, None] + offsets, frequency[0], frequency[-1])
    interval = np.clip(np.searchsorted(frequency, at, side="right") - 1, 0, n - 2)
    where, away = (np.arange(n)[:, None] * (n - 1) + interval).ravel(), at - frequency[interval]
    moments = np.empty((n, n - 1, 4), dtype=np.complex128)  # of the kernel over every interval between two lines
    for k, weights in enumerate((kernel * away**power).ravel() for power in (3, 2, 1, 0)):
        for part in ("real", "imag"):
            getattr(moments, part)[..., k] = np.bincount(where, getattr(weights, part), n * (n - 1)).reshape(n, n - 1)
    pieces = CubicSpline(frequency, np.eye(n), bc_type="not-a-knot" if n > 3 else "natural").c  # (4, n - 1, n)
    return np.asarray(np.tensordot(moments, pieces, axes=([2, 1], [0, 1])), dtype=np.complex128)


def window(x: Array) -> Array:
    """Transform of a Hann window of length 1, over that at 0, at x = f T: sinc x / (1 - x²)."""
    at_one = np.isclose(np.abs(x), 1.0)
    apart = np.where(at_one, 0.0, x)
    return np.asarray(np.where(at_one, 0.5, np.sinc(apart) / (1 - apart**2)))


# What moves the period of a pendulum away from paper Eq. 5, each as a factor on the period that it gets.
#
# Those of amplitude, damping and rope mass are `validation.classical.pendulum` the other way round. One period is one number:
# all six are exact aliases there, and only two amplitudes, two lengths or the decay tell them apart.


def wide(swing: PendulumSwing, targets: tuple[str, ...], values: Values) -> PendulumSwing:
    """The swing is so wide; of ropes the exact period, of a body on a pivot that of the plane pendulum."""
    if not swing.ropes:
        return _times(swing, plane_amplitude_factor(values[""]))
    square = _square(swing)
    epsilon, kappa = square / _stated(swing, "length") ** 2, _stated(swing, "mass") * square / _stated(swing, "inertia")
    return _times(swing, rope_amplitude_factor(values[""], epsilon, kappa))


def damped(swing: PendulumSwing, targets: tuple[str, ...], values: Values) -> PendulumSwing:
    """``1 / sqrt(1 - zeta²)``"""
    return _times(swing, 1 / np.sqrt(1 - values[""] ** 2))


def heavy_ropes(swing: PendulumSwing, targets: tuple[str, ...], values: Values) -> PendulumSwing:
    """``M q / 3`` more inertia, ``M q / 2`` more of m s1 s2, M the mass of all ropes."""
    mean = values[""] * float(np.mean(_radii(swing) ** 2))
    turning, pulling = mean / (3 * _stated(swing, "inertia")), mean / (2 * _stated(swing, "mass") * _square(swing))
    return _times(swing, np.sqrt((1 + turning) / (1 + pulling)))


def stretched(swing: PendulumSwing, targets: tuple[str, ...], values: Values) -> PendulumSwing:
    """Each rope is longer by ``c m g / n``, c [m/N] of one rope; where they share the weight alike."""
    longer = values[""] * _stated(swing, "mass") * swing.gravity / len(_radii(swing))
    return _times(swing, np.sqrt(1 + longer / _stated(swing, "length")))


def carried(swing: PendulumSwing, targets: tuple[str, ...], values: Values) -> PendulumSwing:
    """Air that turns along with the body."""
    return _times(swing, np.sqrt(1 + values[""] / _stated(swing, "inertia")))


def beside(swing: PendulumSwing, targets: tuple[str, ...], values: Values) -> PendulumSwing:
    """``1 / sqrt(1 - e² / s²)``: with the CoG off the middle of the ropes by e, sum F_i r_i² = m g (s² - e²)."""
    share = values[""] ** 2 / _square(swing)
    if share >= 1:
        problem = (
            f"a CoG {values['']:g} m beside the middle of the ropes, {np.sqrt(_square(swing)):g} m from them, would fall over"
        )
        raise BadInput(source="pendulum", field="off-centre-suspension", problem=problem, remedy="Give a smaller distance")
    return _times(swing, 1 / np.sqrt(1 - share))


def _times(swing: PendulumSwing, factor: float) -> PendulumSwing:
    return replace(swing, period=swing.period * float(factor))


def _square(swing: PendulumSwing) -> float:
    """s1 s2 of two ropes, the mean square of the radii of more: what stands for s² in Eq. 5."""
    radii = _radii(swing)
    return float(radii[0] * radii[1] if len(radii) == 2 else np.mean(radii**2))


def _radii(swing: PendulumSwing) -> np.ndarray:
    if not len(swing.radii):
        raise _not_stated("radii")
    return swing.radii


def _stated(swing: PendulumSwing, name: str) -> float:
    value: float = getattr(swing, name)
    if value <= 0:
        raise _not_stated(name)
    return value


def _not_stated(name: str) -> BadInput:
    problem = f"the effect needs the pendulum's {name}, which is not stated"
    return BadInput(source="pendulum", field=name, problem=problem, remedy="State it in the measurement file")
