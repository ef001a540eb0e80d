"""What came of one run, in figures: level, loads, cells, resonances, and whether the record holds the ring-down."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fem.base_excitation.response import Response, SmallMotion
from fem.base_excitation.rig import Friction, LoadCell
from geometry.dynamic_mass import LEVELS, MOTIONS
from geometry.frames import Array
from validation.excite.rig import RigModes, Run

if TYPE_CHECKING:
    from fem.base_excitation.patterns import Sweep


# When a sweep passes the resonances of a rig, and what each does to the load, measured on the run itself.
#
# Amplitudes are those of the analytic signal (Gabor, Journal of the IEE 93, 1946), which follows a sweep from cycle to cycle.
# The amplification is the load's amplitude over that of the rigid body, M a with the acceleration of the same moment, for the
# load along the axis that is driven; its largest value near the resonance counts, which a fast sweep reaches a little after
# passing it.


SHOWS = 0.02
"""A mode is listed when, held at its resonance, it would swell the load along a driven axis by this share of the rigid body's."""

LEAST_DAMPING = 1e-4
"""Of a mode, when that is judged."""

BEFORE = 2.0
"""Half-widths zeta of a resonance below it from which its largest amplification is looked for."""

AFTER = 3.0
"""The load is largest some 2 / sqrt(alpha) after its resonance is passed, alpha = d(omega)/dt (Lewis, Trans. ASME 54, 1932); it
is looked for this many times 1 / sqrt(alpha)."""

CUT = 0.25
"""The search ends where the next resonance is passed, unless that follows within this share of it: neighbours swell together."""


@dataclass(frozen=True, kw_only=True)
class Passed:
    """One resonance that a sweep passed.

    Attributes
    ----------
    mode : number of the rig's mode, from 1
    frequency : [Hz]
    damping_ratio : [1]
    axis : index of the driven axis, and of the load, that shows it most
    time : [s] when the sweep has its frequency
    amplification : [1] largest load near it over the rigid body's
    peak_time, peak_frequency : [s], [Hz] of that
    """

    mode: int
    frequency: float
    damping_ratio: float
    axis: int
    time: float
    amplification: float
    peak_time: float
    peak_frequency: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Amplitudes:
    """Amplitudes while the sweep is on, on its own instants.

    Attributes
    ----------
    time : (n,) [s]
    frequency : (n,) [Hz] of the sweep
    base : (n, 6) of the table's acceleration [m/s², rad/s²]
    load : (n, 6) of the load [N, N m]
    rigid : (n, 6) of the load that the rigid body would have
    """

    time: Array
    frequency: Array
    base: Array
    load: Array
    rigid: Array


def rigid_load(response: Response, rigid_mass: Array) -> Array:
    """(n, 6) M a: the load on the rigid body [N, N m]."""
    return np.asarray(response.table @ rigid_mass.T)


def amplitudes(response: Response, run: Run, rigid_mass: Array) -> Amplitudes | None:
    """The amplitudes of a run; None where many frequencies are driven at once."""
    if run.sweep is None:
        return None
    band = response.time <= run.sweep.driven
    base, load, rigid = (amplitude(x)[band] for x in (response.table, response.load, rigid_load(response, rigid_mass)))
    time = response.time[band]
    return Amplitudes(time=time, frequency=run.sweep.frequency_at(time), base=base, load=load, rigid=rigid)


def passed(found: Amplitudes | None, run: Run, modes: RigModes) -> tuple[Passed, ...]:
    """Every resonance that the sweep of `run` passed at full level, in the order of its time."""
    if found is None or run.sweep is None:
        return ()
    driven = list(run.axes)
    share = modes.participation[driven] ** 2 / np.diag(modes.rigid_mass)[driven, None]
    held = share.max(axis=0) / (2 * np.maximum(modes.damping_ratio, LEAST_DAMPING))
    inside = (modes.frequency >= run.sweep.start) & (modes.frequency <= run.sweep.stop) & (held > SHOWS)
    listed = np.flatnonzero(inside)
    # Until when [s] the largest load of each resonance of `frequency` (k,) [Hz], ascending, is looked for
    frequency = modes.frequency[listed]
    at = run.sweep.time_at(frequency)
    patience = AFTER / np.sqrt(2 * np.pi * frequency * run.sweep.rate * np.log(2) / 60)
    following = np.append(at[1:], np.inf)[: len(at)]
    ends = np.asarray(np.where(following - at > CUT * patience, np.minimum(at + patience, following), at + patience))
    axes = [run.axes[int(np.argmax(share[:, r]))] for r in listed]
    return tuple(_passed(found, run.sweep, modes, *one) for one in zip(listed.tolist(), axes, ends.tolist(), strict=True))


def _passed(found: Amplitudes, sweep: Sweep, modes: RigModes, r: int, axis: int, end: float) -> Passed:
    f, zeta = float(modes.frequency[r]), float(modes.damping_ratio[r])
    last = min(end, float(sweep.time_at(sweep.stop)))  # from then on the level falls, and what rings on has nothing beside it
    near = np.flatnonzero((found.frequency >= f * (1 - BEFORE * zeta)) & (found.time <= last))
    ratio = found.load[near, axis] / np.maximum(found.rigid[near, axis], np.finfo(np.float64).tiny)
    best = int(np.argmax(ratio))
    return Passed(
        mode=r + 1,
        frequency=f,
        damping_ratio=zeta,
        axis=axis,
        time=float(sweep.time_at(f)),
        amplification=float(ratio[best]),
        peak_time=float(found.time[near[best]]),
        peak_frequency=float(found.frequency[near[best]]),
    )


def amplitude(signals: Array) -> Array:
    """Amplitude of the analytic signal of each of `signals` (n, ...), of the same shape and unit."""
    from scipy.fft import next_fast_len
    from scipy.signal import hilbert

    n = len(signals)
    return np.asarray(np.abs(hilbert(signals, N=next_fast_len(n), axis=0))[:n])


@dataclass(frozen=True, kw_only=True)
class AxisResponse:
    """What one driven axis did.

    Attributes
    ----------
    axis : index of it
    asked : [m/s², rad/s²] amplitude of a sine in the band; root mean square of noise at full strength, of a burst in its middle
    realised : of the record: the largest within the band of a sweep; root mean square over the whole drive, soft start and stop
        included
    peak : largest acceleration of the whole drive
    """

    axis: int
    asked: float
    realised: float
    peak: float


@dataclass(frozen=True, kw_only=True)
class CellLoad:
    """The extremes of one load cell [N] as it was simulated, what it is preloaded with not counted.

    Attributes
    ----------
    lowest, highest : along z; the cover plate pulls at a cell where this is negative
    lateral : largest along x or y
    preload : None for a cell that never lifts off
    share_lifted : [1] of the record in which it was off, to `LIFTED` of its preload
    """

    lowest: float
    highest: float
    lateral: float
    preload: float | None
    share_lifted: float


@dataclass(frozen=True, kw_only=True)
class LoosePart:
    """How a loose part behaved as it was simulated.

    Attributes
    ----------
    axis : along which it can slip
    mass : [kg]
    slip_force : [N]
    share_slipping : [1] of the record in which its friction is at its limit
    """

    axis: str
    mass: float
    slip_force: float
    share_slipping: float


@dataclass(frozen=True, kw_only=True)
class RingDown:
    """Whether the record holds the ringing after the drive.

    Attributes
    ----------
    kept : [s] from the end of the drive to that of the record
    needed : [s] from the end of the drive until the ringing has died away
    """

    kept: float
    needed: float

    @property
    def sufficient(self) -> bool:
        """Whether it does, to a millisecond."""
        return self.kept >= self.needed - 1e-3


@dataclass(frozen=True, eq=False, kw_only=True)
class Outcome:
    """One run and what came of it, without its signals.

    Attributes
    ----------
    name, label : of the run
    duration : [s] of the record
    driven : [s] of it
    levels : of the axes that were driven
    cross : [1] largest acceleration of any other axis over its nominal level, over that of the driven ones; 0 when all are driven
    small : whether the table turned little enough
    peak_load : (6,) largest load of each kind [N, N m]
    peak_time : (6,) [s] when
    passed : resonances
    ring_down : what the record holds of it
    cells : extremes of every load cell
    loose : what every loose part did
    step : [s] of the simulation
    settings : how it was found
    warnings : sentences
    """

    name: str
    label: str
    duration: float
    driven: float
    levels: tuple[AxisResponse, ...]
    cross: float
    small: SmallMotion
    peak_load: Array
    peak_time: Array
    passed: tuple[Passed, ...]
    ring_down: RingDown
    cells: tuple[CellLoad, ...]
    loose: tuple[LoosePart, ...]
    step: float
    settings: Mapping[str, object]
    warnings: tuple[str, ...]


LIFTED = 1e-3
"""A cell counts as off when less than this share of its preload is left."""


def outcome(
    run: Run,
    response: Response,
    *,
    driven: float,
    small: SmallMotion,
    passed: tuple[Passed, ...],
    needed: float,
    step: float,
    cells: tuple[CellLoad, ...],
    loose: tuple[LoosePart, ...],
    warnings: tuple[str, ...],
) -> Outcome:
    """The figures of `run`, whose table was driven for `driven` [s] and whose ringing takes `needed` [s] more.

    `step` [s] is that of the simulation, where `response` says nothing else.
    """
    size = np.abs(response.load)
    duration = (len(size) - 1) / response.sampling_rate
    return Outcome(
        name=run.name,
        label=run.pattern.label,
        duration=duration,
        driven=driven,
        levels=_levels(run, response, driven),
        cross=_cross(run, response),
        small=small,
        peak_load=size.max(axis=0),
        peak_time=response.time[size.argmax(axis=0)],
        passed=passed,
        ring_down=RingDown(kept=max(duration - driven, 0.0), needed=needed),
        cells=cells,
        loose=loose,
        step=own if isinstance(own := response.settings.get("step_s"), float) else step,
        settings=response.settings,
        warnings=warnings,
    )


def cell_loads(simulated: Response, cells: tuple[LoadCell, ...]) -> tuple[CellLoad, ...]:
    """The extremes of every one of `cells`, before a filter rounds the corner where one lifts off."""
    return tuple(_cell(simulated.cells[:, k], cell) for k, cell in enumerate(cells))


def loose_parts(simulated: Response, frictions: tuple[Friction, ...]) -> tuple[LoosePart, ...]:
    """How long every one of `frictions` was at its limit."""
    return tuple(
        LoosePart(axis=part.axis, mass=part.mass, slip_force=part.slip_force, share_slipping=share)
        for part, share in zip(frictions, simulated.slipping, strict=True)
    )


def _levels(run: Run, response: Response, driven: float) -> tuple[AxisResponse, ...]:
    time = response.time
    band = None if run.sweep is None else [float(run.sweep.time_at(f)) for f in (run.sweep.start, run.sweep.stop)]
    found = []
    for axis in run.axes:
        a = response.table[time <= driven, axis]
        if band is None:
            realised = float(np.sqrt(np.mean(a**2)))
        else:
            realised = float(np.abs(response.table[(time >= band[0]) & (time <= band[1]), axis]).max())
        found.append(AxisResponse(axis=axis, asked=float(run.levels[axis]), realised=realised, peak=float(np.abs(a).max())))
    return tuple(found)


def _cross(run: Run, response: Response) -> float:
    size = np.abs(response.table).max(axis=0) / [LEVELS[axis] for axis in MOTIONS]
    driven = np.isin(np.arange(len(MOTIONS)), run.axes)
    return float(size[~driven].max(initial=0.0) / size[driven].max())


def _cell(force: Array, cell: LoadCell) -> CellLoad:
    preload = cell.preload
    off = 0.0 if preload is None else float(np.mean(force[:, 2] <= -(1 - LIFTED) * preload))
    return CellLoad(
        lowest=float(force[:, 2].min()),
        highest=float(force[:, 2].max()),
        lateral=float(np.abs(force[:, :2]).max()),
        preload=preload,
        share_lifted=off,
    )
