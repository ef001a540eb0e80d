"""`Response`: what table, cover plate, load cells and article did during one run, how it is found, and how it is recorded."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from math import ceil, floor, isfinite
from types import MappingProxyType
from typing import Any, overload

import numpy as np
import numpy.typing as npt
from numpy.lib.stride_tricks import sliding_window_view

from fem.base_excitation.first_order_hold import (
    Channels,
    Outputs,
    Progress,
    Run,
    States,
    accelerations,
    carried,
    cell_forces,
    driven,
    load,
    poles,
    relative,
    require_bounded,
    run,
    seen,
    solver,
    stacked,
    stepped,
)
from fem.base_excitation.patterns import BaseMotion, Clock, CrossMotion, Pattern, driven_by, require_below_nyquist
from fem.base_excitation.rig import TABLE, FlexibleBody, Rig, RigStructure, matrices
from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array, freeze, frozen


@dataclass(frozen=True, eq=False, kw_only=True)
class Response:
    """One run, equally sampled, all channels at the same instants.

    Loads are those of the table *on* what stands on it, f = +M a.

    Attributes
    ----------
    sampling_rate : [Hz]
    table : (n, 6) acceleration of the table about the reference point, x, y, z [m/s²], alpha, beta, gamma [rad/s²]
    cover : (n, 6) the same of what carries the article: of the FMD's cover plate, of the table when there are no cells
    load : (n, 6) force [N] and moment [N m] about the reference point
    cells : (n, c, 3) force [N] of every load cell along x, y, z of the laboratory; c is 0 when there are none
    places : (n, 3) acceleration [m/s²] of places of the article by name, in the laboratory's axes
    coordinates : (n, k) when they were asked for, (n, 0) otherwise; by the recursion all of the rig relative to the table, as
        `fem.base_excitation.rig` orders them, by exudyn those of the article in the laboratory
    slipping : [1] share of the record in which each of the rig's loose parts slipped; none by a route that knows no friction
    reference_point : (3,) [m]
    settings : how it was found: route, program and version, step, what it kept; JSON values
    warnings : sentences
    """

    sampling_rate: float
    table: Array
    cover: Array
    load: Array
    cells: Array
    places: Mapping[str, Array] = field(default_factory=lambda: MappingProxyType({}))
    coordinates: Array = field(default_factory=lambda: np.zeros((0, 0)))
    slipping: tuple[float, ...] = ()
    reference_point: Array = field(default_factory=lambda: np.zeros(3))
    settings: Mapping[str, object] = field(default_factory=lambda: MappingProxyType({}))
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        n = np.shape(self.table)[0]
        coordinates = self.coordinates if np.size(self.coordinates) else np.zeros((n, 0))
        object.__setattr__(self, "coordinates", coordinates)
        freeze(self, table=(n, 6), cover=(n, 6), load=(n, 6), cells=(n, np.shape(self.cells)[1], 3))
        freeze(self, coordinates=(n, np.shape(coordinates)[1]), reference_point=(3,))
        object.__setattr__(
            self, "places", MappingProxyType({name: frozen(a, (n, 3), f"places.{name}") for name, a in self.places.items()})
        )
        object.__setattr__(self, "settings", MappingProxyType(dict(self.settings)))

    @property
    def time(self) -> Array:
        """(n,) [s], from 0."""
        return np.arange(len(self.table)) / self.sampling_rate


# How long a record must go on after the drive ends, so that what still rings is nothing that a spectrum would miss.
#
# At the end of the drive every mode has a state, from which it decays with its own pole. The record is long enough when each of
# them loads the table by less than a share of the greatest load of the run, a moment counting as the force that makes it at the
# radius of gyration.

SHARE = 1e-4
"""Share of the greatest load below which what is left of a mode does no harm."""

HAIR = 0.01
"""Share of a ring-down by which a record may be short without a word: its length may come from another sampling rate."""

UNDAMPED = 1e-14
"""Decay as a share of the highest frequency that is nothing but rounding."""


def needed(rig: Rig, motion: BaseMotion, share: float = SHARE) -> float:
    """Length [s] that the record of `motion` must have, from its first sample; infinite when a driven mode has no damping.

    A rig with friction or cells that can lift off is taken as it is while nothing slips or lifts, loose parts left out.

    Raises
    ------
    BadInput : a rig that cannot be built.
    CheckFailed : something on the table swings freely, or the answer grows beyond all numbers.
    """
    linear = rig if rig.linear else replace(rig, frictions=(), cells=tuple(replace(cell, preload=None) for cell in rig.cells))
    structure = matrices(linear)
    system = driven(structure)
    return motion.driven + lasting(structure, system, run(structure, system, load(structure), motion), share)


def warning(rig: Rig, motion: BaseMotion) -> str:
    """A sentence when the record of `motion` is cut while `rig` still rings, with the length that it needs; else empty.

    Raises
    ------
    BadInput, CheckFailed : as `needed`.
    """
    return judged(needed(rig, motion), motion)


def judged(length: float, motion: BaseMotion) -> str:
    """The sentence of `warning`, from the `length` [s] that is needed."""
    if motion.duration + 1 / motion.sampling_rate >= length - HAIR * (length - motion.driven):
        return ""
    cut = f"The record ends at {motion.duration:.4g} s"
    if not np.isfinite(length):
        return f"{cut}, but a driven mode has no damping and never stops ringing. Give it damping"
    rest = "before the drive has" if motion.duration < motion.driven else "while the article still rings"
    after = max(motion.duration - motion.driven, 0.0)
    return (
        f"{cut}, {rest}: after the drive {length - motion.driven:.4g} s are needed until no mode loads the table by more than "
        f"{SHARE:g} of the greatest load, found {after:.4g} s"
    )


def lasting(structure: RigStructure, system: States, done: Run, share: float = SHARE) -> float:
    """[s] after the drive until every mode's load has fallen below `share` of the greatest; `done` begins with the load."""
    greatest = size(structure, done.samples[:, :TABLE].T).max()
    return lasting_from(structure, system, done.state, float(greatest), share)


def lasting_from(structure: RigStructure, system: States, state: Array, greatest: float, share: float = SHARE) -> float:
    """[s] of rest from `state` (2 n,) on until every mode's load has fallen below `share` of the `greatest`, a `size` [N]."""
    uncoupled, wanted = poles(system), seen(load(structure), system).of_states
    if uncoupled is None:  # modes that cannot be told apart: all together, with the slowest decay
        decay = -np.array([np.linalg.eigvals(system.A).real.max()])
        loads = np.linalg.norm(wanted, axis=1)[:, None] * np.linalg.norm(state)
    else:
        decay, loads = -uncoupled.pole.real, np.abs((wanted @ uncoupled.shape) * (uncoupled.project @ state))
    left = size(structure, loads)
    rings = left > share * greatest
    if np.any(decay[rings] <= UNDAMPED * np.linalg.norm(system.A, 2)):
        return float("inf")
    return float(np.max(np.log(left[rings] / (share * greatest)) / decay[rings], initial=0.0))


def size(structure: RigStructure, loads: Array) -> Array:
    """(k,) [N] size of `loads` (6, k), moments over the radius of gyration about F."""
    M = np.diag(structure.mass)[:TABLE]
    return np.asarray(np.sqrt((loads[:3] ** 2).sum(axis=0) + (loads[3:] ** 2).sum(axis=0) * M[:3].sum() / M[3:].sum()))


# A linear rig on a driven base in time, by the exact recursion in its own modes: seconds for a sweep of a minute and a half.
#
# Table, cover plate, load cells, places and the load on the table are sums of the states and of the motion of the table:
#
#     y'' = -M_yy^-1 (K_yy y + C_yy y' + M_yt u'' + C_yt u' + K_yt u),    load = M_t x'' + C_t x' + K_t x.
#
# The load is all that the table feels: through the load cells, and through what is tied to the table beside them.

COARSEST = 8
"""Samples a period of the highest kept mode that straight lines between samples need; driven there, its answer lacks 5 %."""


def respond(rig: Rig, motion: BaseMotion, *, keep_coordinates: bool = False, progress: Progress | None = None) -> Response:
    """What `rig` does on a table that makes `motion`, at the sampling rate of the motion.

    Parameters
    ----------
    keep_coordinates : with those of `fem.base_excitation.rig`, the table's left out
    progress : called with the share done

    Raises
    ------
    BadInput : a rig that is not linear or cannot be built, a sampling rate too coarse for a kept mode.
    CheckFailed : something on the table swings freely, or the answer grows beyond all numbers; with channel and time.
    """
    import scipy

    require_fine(rig.article, motion.sampling_rate)
    structure = matrices(rig)
    system = driven(structure)
    parts = [load(structure), accelerations(structure.cover, "the cover plate"), cell_forces(structure)]
    parts += [accelerations(rows, name) for name, rows in structure.places.items()]
    done = run(structure, system, stacked([*parts, relative(structure)] if keep_coordinates else parts), motion, progress)
    n, cells, names = len(done.samples), len(structure.cells), list(structure.places)
    widths = [TABLE, TABLE, 3 * cells, 3 * len(names)]
    loads, cover, forces, places, coordinates = np.split(done.samples, np.cumsum(widths), axis=1)
    warning = judged(motion.driven + lasting(structure, system, done), motion)
    return Response(
        sampling_rate=motion.sampling_rate,
        table=motion.acceleration,
        cover=cover,
        load=loads,
        cells=forces.reshape(n, cells, 3),
        places={name: places[:, 3 * k : 3 * k + 3] for k, name in enumerate(names)},
        coordinates=coordinates,
        reference_point=motion.reference_point,
        settings={
            "route": "recursion",
            "hold": "first order",
            "sampling_rate_hz": motion.sampling_rate,
            "modes": rig.article.kept.size,
            "highest_mode_hz": float(rig.article.kept.max(initial=0.0)),
            "coordinates": len(system.A) // 2,
            "numpy": np.__version__,
            "scipy": scipy.__version__,
        },
        warnings=(warning,) if warning else (),
    )


def require_fine(article: FlexibleBody, sampling_rate: float) -> None:
    """Refuse a sampling rate too coarse for a kept mode.

    Raises
    ------
    BadInput : the rate that is needed is named.
    """
    highest = float(article.kept.max(initial=0.0))
    if sampling_rate < COARSEST * highest:
        where = "beyond half the sampling rate" if 2 * highest > sampling_rate else "sampled too coarsely"
        problem = f"the highest kept mode, {highest:.4g} Hz, is {where}, found {sampling_rate:g} Hz"
        remedy = f"Simulate at {np.ceil(COARSEST * highest):.0f} Hz or more, or keep fewer modes"
        raise BadInput(f"simulation of {article.name}", "sampling_rate", problem, remedy)


# Whether a run stays where the linear equations hold: "rotational amplitudes and velocities sufficiently small" (paper 2.1).
#
# Eqs. 1 take the table's axes for those of the laboratory and velocities for nothing. With the rotation vector phi(t) of the
# table, R its rotation, omega its angular velocity, r the arm from the reference point A to a particle, the exact acceleration is
#
#     a = a_A + omega' x (R r) + omega x (omega x (R r)),
#
# and load cells, which ride on the table, sense R^T of it. What the linear equations drop is of second order in the motion:
#
# - turned axes: (R^T - 1) a_A and omega' x ((R - 1) r), at most |phi| times what is kept, and nothing where accelerometers and
#   load cells turn with the table together;
# - centripetal acceleration and the gyroscopic moment omega x (Theta omega): |omega|² beside |omega'|, which for a harmonic
#   motion is |phi| again;
# - phi'' - omega', which vanishes while one axis turns alone and is of the order |phi| |phi''| and |phi'|² otherwise.
#
# One figure says how small all of it is beside what is kept, `left_out`: the larger of the largest angle and of the largest
# squared rate over the largest angular acceleration. Where it shows depends on how the record is read. Products of two harmonics
# lie at zero and at twice the driven frequency, so a reading at the driven frequency (a steady sine, a tracking filter) sees
# only terms of third order, `left_out`². The transform of a whole sweep does not know when a line was driven: at the frequency f
# it also holds what the sweep left over when it passed f / 2, which in a sweep of one axis is half the angle at f / 2. With the
# paper's vertical rotation that is 0.5 % of the force just above 8 Hz, falling with 1 / f². A resonance of the article at f
# magnifies it.
#
# Gravity is not among these terms: its tilt m g |phi| is of first order, and belongs to the linear equations that include it.

LIMIT = 0.02
"""Largest share of the load, in the time record of a rigid article, that the linear equations may leave out: 2 %, an angle of 1.1
degrees, twice what the paper's sweeps reach. At the driven frequency that is 0.04 %, in full-record spectra of a sweep 1 %.

Exudyn's own bodies and beams, on a table that really turns, stay below that share in every case tried, rigid and flexible, from
the paper's level to thirty times it (`examples/large_motion.py`)."""


@dataclass(frozen=True, kw_only=True)
class SmallMotion:
    """How large the rotations of a run are.

    Attributes
    ----------
    angle : [rad] largest rotation of the table
    rate : [rad/s] largest angular velocity
    turned : [1] share of a load that the turning of the axes moves to another axis: the angle itself
    centripetal : [1] largest squared rate over largest angular acceleration
    limit : `LIMIT`
    """

    angle: float
    rate: float
    turned: float
    centripetal: float
    limit: float = LIMIT

    @property
    def left_out(self) -> float:
        """[1] what the linear equations leave out, as a share of what they keep."""
        return max(self.turned, self.centripetal)

    @property
    def within(self) -> bool:
        """Whether that is small enough."""
        return self.left_out <= self.limit

    @property
    def text(self) -> str:
        """One sentence."""
        is_within = "within" if self.within else "beyond"
        return (
            f"The table turns by {np.degrees(self.angle):.2g}° at most, at up to {np.degrees(self.rate):.2g}°/s: the linear "
            f"equations leave out {self.left_out:.2%} of the load, {is_within} the limit of {self.limit:.2%}."
        )


def judge(motion: BaseMotion) -> SmallMotion:
    """What the rotations of `motion` are to the linear equations; see the head of this file for what they leave out."""
    angle, rate, acceleration = (
        float(np.linalg.norm(kind[:, 3:], axis=1).max()) for kind in (motion.displacement, motion.velocity, motion.acceleration)
    )
    return SmallMotion(angle=angle, rate=rate, turned=angle, centripetal=rate**2 / acceleration if acceleration else 0.0)


# A linear rig driven by a pattern, block by block: as `linear.respond`, and nothing of the run is kept but what is asked for.
#
# The motion of every block is a closed form, the state of the rig is all that passes from one to the next, and how long the
# record goes on after the drive is decided when it ends: until what still rings is nothing (`ring_down`), and some quiet after
# that.

BLOCK = 16_384
"""Samples that are answered at a time."""

LONGEST = 600.0
"""[s] that a record may go on after the drive."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Piece:
    """Some samples of a run.

    Attributes
    ----------
    acceleration : (6, k) of the table
    values : (o, k) the channels that were asked for
    """

    acceleration: Array
    values: Array


def streamed(
    rig: Rig,
    pattern: Pattern,
    sampling_rate: float,
    channels: Callable[[RigStructure], Channels],
    *,
    cross: CrossMotion | None = None,
    quiet: float = 0.0,
    share: float = SHARE,
) -> Iterator[Piece]:
    """What `channels` show while `pattern` drives `rig`, from rest to rest.

    Parameters
    ----------
    sampling_rate : [Hz]
    channels : what is wanted of the equations of the rig
    cross : what the table does besides
    quiet : [s] of record after the ringing
    share : of the greatest load, below which ringing is nothing

    Raises
    ------
    BadInput : a rig that is not linear or cannot be built, a sampling rate too coarse for the pattern or for a kept mode.
    CheckFailed : something swings freely, the answer grows beyond all numbers, or it rings for more than `LONGEST`.
    """
    structure, system, wanted, outputs = _asked(rig, pattern, sampling_rate, channels)
    solve = solver(system, outputs.of_states, sampling_rate)
    start, stop, greatest, rung_down = 0, _at_rest(pattern, sampling_rate, cross) + 1, 0.0, False
    while start < stop:
        count = min(BLOCK, stop - start)
        # (18, count + 2) motion of the table, from the sample before `start` on
        inputs = _of_table(pattern, sampling_rate, start - 1, count + 2, cross)
        driving = inputs[: system.B.shape[1]]
        with np.errstate(over="ignore", invalid="ignore"):  # said below, in words
            # The inner of the samples (p, k + 2) lifted as `recursion.straightened` does: (p, k)
            found, state = solve(np.asarray(driving[:, 1:-1] * (7 / 6) - (driving[:, :-2] + driving[:, 2:]) / 12).T)
            values = found.T + outputs.of_inputs @ inputs[:, 1:-1]
        require_bounded(values.T, wanted.names, start, sampling_rate)
        greatest = max(greatest, float(size(structure, values[:TABLE]).max()))
        yield Piece(acceleration=inputs[:TABLE, 1:-1], values=values[TABLE:])
        start += count
        if start >= stop and not rung_down:
            rest = _resting(pattern, lasting_from(structure, system, state, greatest, share))
            stop, rung_down = start + int(np.ceil((rest + quiet) * sampling_rate)), True


def _asked(
    rig: Rig, pattern: Pattern, sampling_rate: float, channels: Callable[[RigStructure], Channels]
) -> tuple[RigStructure, States, Channels, Outputs]:
    """What `rig` is made of, and the load on the table and, below it, `channels` of it."""
    require_below_nyquist(pattern, sampling_rate)
    require_fine(rig.article, sampling_rate)
    structure = matrices(rig)
    system, wanted = driven(structure), stacked([load(structure), channels(structure)])
    return structure, system, wanted, seen(wanted, system)


def _at_rest(pattern: Pattern, sampling_rate: float, cross: CrossMotion | None) -> int:
    """The first sample at which the table has come to rest."""
    return int(np.ceil((pattern.driven + (cross.delay if cross else 0.0)) * sampling_rate))


def _of_table(
    pattern: Pattern, sampling_rate: float, start: int, count: int, cross: CrossMotion | None, few: int = TABLE
) -> Array:
    """(3 `few`, count) accelerations, velocities and displacements from the sample `start` on: of the table, or of the `few` that
    drive it, see `driven_by`."""
    if start > _at_rest(pattern, sampling_rate, cross):
        return np.zeros((3 * few, count))
    driven, to = driven_by(pattern, Clock(sampling_rate=sampling_rate, count=count, late=-start / sampling_rate), cross)
    return np.asarray(driven if few < TABLE else to @ driven)[::-1].reshape(-1, count)


def _resting(pattern: Pattern, rest: float) -> float:
    """`rest` [s] after `pattern`, unless it is too long."""
    if not rest <= LONGEST:
        said = f"After the {pattern.label} the article rings for {rest:.3g} s, more than {LONGEST:g} s. Give it damping."
        raise CheckFailed(said, seconds=rest)
    return rest


# From the rate of a simulation to that of a record: one anti-alias filter for all channels, then every q-th sample.
#
# Sampled motion is not piecewise linear, which every recursion takes it for: at the rates of a test (0.5 to 2 kHz) that alone
# biases the elastic part of the response. A run is therefore simulated at `LEAST` or more and brought down here.
#
# The filter is a symmetric FIR (Kaiser window), its delay taken off again, so that it changes no phase: up to `PASS` of the
# Nyquist frequency of the record amplitudes change by less than `RIPPLE`, and from that Nyquist frequency on everything is
# pressed below `RIPPLE`. What it does to one channel it does to all, so ratios of channels stay what they were. At both ends of
# the record it takes for granted that all is at rest beyond.

LEAST = 8000.0
"""[Hz] at which a run is simulated at least."""

PASS = 0.8
"""Of the Nyquist frequency of the record: up to here the filter lets everything through."""

RIPPLE = 1e-6
"""Largest relative change of an amplitude in the pass-band, and what is left of one in the stop-band (-120 dB)."""

HALF = 44
"""Samples of the record on each side of a sample that the filter looks at; enough for `PASS` and `RIPPLE`."""

POINTS = 12
"""Samples through which a delay by a part of a sample is interpolated."""

FILTERED = 1024
"""Samples of the record that are filtered at a time, to spare memory."""


def simulation_rate(output_rate: float, least: float = LEAST) -> float:
    """The smallest whole multiple of `output_rate` that is `least` [Hz] or more.

    Raises
    ------
    BadInput : a rate that is not positive.
    """
    _require_rate(output_rate, "output_rate")
    return output_rate * max(1, ceil(least / output_rate - 1e-9))


def pass_band(rate: float) -> float:
    """[Hz] up to which a record of `rate` [Hz] holds amplitudes as they were."""
    return PASS * rate / 2


def require_recorded(highest: float, rate: float, source: str) -> None:
    """Refuse a record whose rate is too low for what is driven.

    Raises
    ------
    BadInput : `highest` [Hz] lies beyond the Nyquist frequency of `rate` [Hz], or beyond the pass-band of the filter.
    """
    _require_rate(rate, "rate")
    if highest > pass_band(rate):
        nyquist = f"Nyquist frequency of {rate / 2:g} Hz"
        limit = nyquist if highest >= rate / 2 else f"pass-band of the anti-alias filter, {pass_band(rate):g} Hz"
        problem = f"it drives up to {highest:.4g} Hz, beyond the {limit}, that a record of {rate:g} Hz has"
        raise BadInput(source, "rate", problem, f"Record at {2 * highest / PASS:.4g} Hz or more, or stop the excitation lower")


@overload
def decimated(record: BaseMotion, rate: float) -> BaseMotion: ...


@overload
def decimated(record: Response, rate: float) -> Response: ...


def decimated(record: BaseMotion | Response, rate: float) -> BaseMotion | Response:
    """`record` at `rate` [Hz], all channels through the one filter; itself when it has that rate already.

    Raises
    ------
    BadInput : `rate` is not positive, or the record's rate is not a whole multiple of it.
    """
    factor = _factor(record.sampling_rate, rate)
    if factor == 1:
        return record
    if isinstance(record, BaseMotion):
        motion_rate = record.sampling_rate / factor
        return replace(
            record,
            sampling_rate=motion_rate,
            displacement=_filtered(record.displacement, factor),
            velocity=_filtered(record.velocity, factor),
            acceleration=_filtered(record.acceleration, factor),
            driven=min(record.driven + HALF / motion_rate, record.duration),
        )
    response_rate = record.sampling_rate / factor
    channels: dict[str, Any] = {
        name: _filtered(getattr(record, name), factor) for name in ("table", "cover", "load", "cells", "coordinates")
    }
    settings = {
        "simulated_at_hz": record.sampling_rate,
        "recorded_at_hz": response_rate,
        "pass_band_hz": pass_band(response_rate),
        "stop_band_hz": response_rate / 2,
        "ripple": RIPPLE,
        "filter": "symmetric FIR, Kaiser window, delay compensated",
    }
    return replace(
        record,
        **channels,
        sampling_rate=response_rate,
        places={name: _filtered(channel, factor) for name, channel in record.places.items()},
        settings={**record.settings, "anti_alias": settings},
    )


def decimated_channels(channels: Array, simulated: float, rate: float, delay: npt.ArrayLike = 0.0) -> Array:
    """Samples (n, c) at the rate `simulated` [Hz] brought down to `rate` [Hz], each channel `delay` (c,) [s] later.

    Raises
    ------
    BadInput : `rate` is not positive, or `simulated` is not a whole multiple of it.
    """
    late = np.broadcast_to(np.asarray(delay, dtype=np.float64) * simulated, (channels.shape[1],))
    factor = _factor(simulated, rate)
    return channels if factor == 1 and not late.any() else _apart(channels, factor, late)


@cache
def taps(factor: int) -> Array:
    """The anti-alias filter for every `factor`-th sample: (2 `HALF` `factor` + 1,), symmetric, of sum 1."""
    # `firwin` and `kaiser_beta` of SciPy, whose module of signals takes longer to import than the filter to run
    middle, beta = (1 + PASS) / 2 / factor, 0.1102 * (-20 * np.log10(RIPPLE) - 8.7)
    found: Array = np.sinc(middle * np.arange(-HALF * factor, HALF * factor + 1)) * np.kaiser(2 * HALF * factor + 1, beta)
    found /= found.sum()
    found.setflags(write=False)
    return found


def _filtered(channels: Array, factor: int) -> Array:
    """Every `factor`-th of the filtered samples (n, ...), the first one kept in its place."""
    width = int(np.prod(channels.shape[1:]))
    found = _apart(channels.reshape(len(channels), width), factor, np.zeros(width))
    return found.reshape(len(found), *channels.shape[1:])


def _apart(columns: Array, factor: int, late: Array) -> Array:
    """Every `factor`-th of the filtered samples (n, c), each column `late` (c,) samples later; (ceil(n / factor), c)."""
    step = FILTERED * factor
    return joined((columns[start : start + step].T for start in range(0, len(columns), step)), factor, late)


def joined(blocks: Iterable[Array], factor: int, late: npt.ArrayLike) -> Array:
    """Every `factor`-th of the filtered samples of channels in `blocks` (c, k), each `late` (c,) samples later: (m, c)."""
    pieces = [_cut(factor, float(samples)) for samples in np.atleast_1d(np.asarray(late, dtype=np.float64))]
    longest, earliest = max((len(one.table) for one in pieces), default=1), min((one.before for one in pieces), default=0)
    found: list[Array] = []
    held, base, done, count = np.zeros((len(pieces), 0)), 0, 0, 0
    for block in blocks:
        held = np.hstack([held, block])
        count = base + held.shape[1]
        ready = max((count + earliest) // factor - longest + 1, done)
        found.append(_several(held, base, pieces, done, ready, factor))
        first = max(ready * factor - max((one.before for one in pieces), default=0), base)
        held, base, done = held[:, first - base :], first, ready
    found.append(_several(held, base, pieces, done, ceil(count / factor), factor))
    return np.asarray(np.hstack(found).T)


def recorded(
    rig: Rig,
    pattern: Pattern,
    sampling_rate: float,
    channels: Callable[[RigStructure], Channels],
    rate: float,
    late: npt.ArrayLike,
    *,
    cross: CrossMotion | None = None,
    quiet: float = 0.0,
    share: float = SHARE,
) -> Array:
    """What `joined` makes of what is `streamed` at `sampling_rate`: (m, c) at `rate`, each channel `late` (c,) samples later.

    Filter and rig are linear, so that what drives is filtered instead of all that is read, and states are worked out where a
    sample of the record is, not at all samples of the simulation. The record is the same to rounding.

    Raises
    ------
    BadInput, CheckFailed : as `streamed`.
    """
    factor = _factor(sampling_rate, rate)
    structure, system, wanted, outputs = _asked(rig, pattern, sampling_rate, channels)
    modes, apart = poles(system), np.atleast_1d(np.asarray(late, dtype=np.float64))
    if modes is None:
        pieces = streamed(rig, pattern, sampling_rate, channels, cross=cross, quiet=quiet, share=share)
        return joined((piece.values for piece in pieces), factor, apart)
    # All axes follow the few signals that drive, one axis and its delay by cross motion: these are what is filtered and stepped
    to = driven_by(pattern, Clock(sampling_rate=sampling_rate, count=1), cross)[1]
    few, reach = min(to.shape[1], TABLE), HALF * factor
    follows, p = np.kron(np.eye(3), to if few < TABLE else np.eye(TABLE)), system.B.shape[1] * few // TABLE
    modes, of_inputs = replace(modes, drive=modes.drive @ follows[: system.B.shape[1], :p]), outputs.of_inputs @ follows
    used = [*range(p), *(p + np.flatnonzero(of_inputs[:, p:].any(axis=0)))]
    # A row of `factor` samples begins `back` samples before its sample of the record, and all that is read there is seen from it
    delays = [_delayed(samples) for samples in apart]
    back = max(max(int(nodes[-1]) for nodes, _ in delays), 0)
    length = max(back - min(int(nodes[0]) for nodes, _ in delays), factor)
    ahead, m = stepped(modes, 1 / sampling_rate, len(used), length), len(modes.pole)
    of_modes = outputs.of_states @ modes.shape
    shown = [_shown(of_modes, of_inputs[:, used], one, k) for k, one in enumerate(ahead)]
    read = np.array([by @ [shown[back - k][TABLE + c] for k in nodes] for c, (nodes, by) in enumerate(delays)])
    loads, growth = np.stack([one[:TABLE] for one in shown[:factor]]), np.tile(ahead[factor][:, :m].diagonal(), 2)
    drive = slice(m, m + p * (length + 3))
    pushing = np.ascontiguousarray(ahead[factor][:, drive].T).view(np.float64)
    # As many rows at once as an FFT takes. The first ones are those to which the filter passes on what drives later
    whole = 2 ** int(np.ceil(np.log2(max(4 * reach, BLOCK) + length)))
    rows, early = (whole - 2 * reach - length - 3) // factor + 1, HALF + 1
    held = np.zeros((len(used), (rows - 1) * factor + length + 3 + 2 * reach))
    begin, fresh, done = 0, held.shape[1] - early * factor - back - 1 - reach, -early
    state, greatest, spectrum, record = np.zeros(2 * m, dtype=np.complex128), 0.0, np.fft.rfft(taps(factor), whole), []
    last, stop = _at_rest(pattern, sampling_rate, cross), 0
    while not stop or done * factor < stop + back:
        held[:, :-fresh] = held[:, fresh:].copy()
        held[:, -fresh:] = _of_table(pattern, sampling_rate, begin, fresh, cross, few)[used]
        begin, fresh = begin + fresh, rows * factor
        filtered = np.fft.irfft(np.fft.rfft(held, whole) * spectrum, whole)[:, 2 * reach : held.shape[1]]
        both = np.stack([held[:, reach:-reach], filtered])
        windows = sliding_window_view(both, length + 3, axis=2)[:, :, ::factor].transpose(0, 2, 1, 3).reshape(2, rows, -1)
        with np.errstate(over="ignore", invalid="ignore"):  # said below, in words
            pushed = (windows[:, :, : pushing.shape[0]] @ pushing).view(np.complex128)
            after = carried(np.hstack(list(pushed)), growth, state)
            w = np.vstack([state, after[:-1]])
            plain, smooth = (np.hstack([of.view(np.float64), x]) for of, x in zip(np.hsplit(w, 2), windows, strict=True))
            coarse = plain @ loads[0].T
        require_bounded(coarse, wanted.names[:TABLE], done, rate)
        record.append(smooth @ read.T)
        # The greatest load lies beside a row that nearly has it
        sizes = size(structure, coarse.T)
        near = sizes >= np.cos(np.pi * min(pattern.highest / rate, 0.5)) * max(greatest, sizes.max())
        near |= np.append(near[1:], True)
        greatest = max(greatest, *(float(size(structure, one @ plain[near].T).max()) for one in loads))
        state, first, done = after[-1], done, done + rows
        row, k = divmod(last + back, factor)
        if not stop and row < done:
            at_end = ahead[k][:, :m] @ w[row - first, :m] + ahead[k][:, m:] @ windows[0, row - first]
            rest = _resting(pattern, lasting_from(structure, system, (modes.shape @ at_end).real, greatest, share))
            stop = last + 1 + int(np.ceil((rest + quiet) * sampling_rate))
    values = np.vstack(record)[early : early + ceil(stop / factor)]
    # What rings beyond the end of the record is no part of it
    ringing = np.exp(np.outer(np.arange(stop - last, stop - last + reach + length + factor) / sampling_rate, modes.pole)) * at_end
    cuts = [_cut(factor, samples) for samples in apart]
    few = max(len(values) - max(len(one.table) for one in cuts), 0)
    values[few:] -= _several((of_modes[TABLE:] @ ringing.T).real, stop, cuts, few, len(values), factor).T
    return values


def _shown(of_modes: ComplexArray, of_inputs: Array, at: ComplexArray, k: int) -> Array:
    """(o, 2 m + p (l + 3)) what channels show `k` samples on, by real and imaginary parts of states and by inputs: as `at`."""
    o, m = of_modes.shape
    both = of_modes @ at
    of_windows = both[:, m:].real.reshape(o, of_inputs.shape[1], -1)
    of_windows[:, :, k + 1] += of_inputs
    return np.hstack([np.ascontiguousarray(both[:, :m].conj()).view(np.float64), of_windows.reshape(o, -1)])


def _delayed(samples: float) -> tuple[npt.NDArray[np.int64], Array]:
    """By how many samples, and with which weights, samples make a signal so many `samples` later.

    A delay is a polynomial through `POINTS` samples around it (Lagrange), which for motion far below the rate of the simulation
    is exact to rounding; a whole number of samples is exact for any.
    """
    if samples == 0.0:
        return np.zeros(1, dtype=np.int64), np.ones(1)
    nodes = floor(samples) - POINTS // 2 + 1 + np.arange(POINTS)
    return nodes, np.array([np.prod([(samples - other) / (node - other) for other in nodes if other != node]) for node in nodes])


@dataclass(frozen=True, eq=False, kw_only=True)
class _Cut:
    """A filter cut into pieces of as many coefficients as samples are left out, `table` (pieces, factor), latest sample last.

    The first coefficient belongs to the sample that comes `before` so many samples before the one that is wanted.
    """

    table: Array
    before: int


def _cut(factor: int, samples: float) -> _Cut:
    """`taps` that delay by so many `samples` as well."""
    nodes, weights = _delayed(samples)
    coefficients, first = np.convolve(taps(factor), weights), int(nodes[0])
    size = ceil(len(coefficients) / factor) * factor
    table = np.zeros(size)
    table[size - len(coefficients) :] = coefficients[::-1]
    return _Cut(table=table.reshape(-1, factor), before=first - HALF * factor + size - 1)


def _several(held: Array, base: int, pieces: list[_Cut], start: int, stop: int, factor: int) -> Array:
    """Samples `start` to `stop` of the record, (c, stop - start); `held` (c, k) begins at the sample `base`."""
    found = np.zeros((len(pieces), stop - start))
    for row, signal, cut in zip(found, held, pieces, strict=True):
        # `count` samples of `signal` from `begin` on, at rest beyond both its ends
        begin = start * factor - cut.before - base
        count = (stop - start + len(cut.table) - 1) * factor
        low, high = max(begin, 0), min(begin + count, len(signal))
        if low == begin and high == begin + count:
            samples = signal[low:high]
        else:
            samples = np.zeros(count)
            if high > low:
                samples[low - begin : high - begin] = signal[low:high]
        for k, products in enumerate(cut.table @ samples.reshape(-1, factor).T):
            row += products[k : k + stop - start]
    return found


def _factor(simulated: float, rate: float) -> int:
    _require_rate(rate, "rate")
    factor = max(1, round(simulated / rate))
    if abs(simulated / rate - factor) > 1e-9 * factor:
        less, more = simulated / (int(simulated / rate) + 1), simulated / max(1, int(simulated / rate))
        below = f"Record at {less:g} or {more:g} Hz" if rate < simulated else f"Record at {simulated:g} Hz or less"
        problem = f"the simulation's {simulated:g} Hz must be a whole multiple of it, found {rate:g} Hz"
        raise BadInput("decimation", "rate", problem, f"{below}, or simulate at {simulation_rate(rate, simulated):g} Hz")
    return factor


def _require_rate(rate: float, field: str) -> None:
    if not (isfinite(rate) and rate > 0):
        raise BadInput("decimation", field, f"must be positive and finite, found {rate:g} Hz", "Give a positive rate")
