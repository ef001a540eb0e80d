"""What came of one run, in figures: level, loads, cells, resonances, and whether the record holds the ring-down."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fem.base_excitation.response import Response, SmallMotion
from fem.base_excitation.rig import LoadCell
from geometry.dynamic_mass import LEVELS, MOTIONS
from geometry.frames import Array
from validation.excite.rig import RigModes, Run
from validation.output import derived, entry, unwritten

LOADS = ("fx", "fy", "fz", "mx", "my", "mz")
"""Forces and moments of the table on what stands on it, about the reference point."""

LOAD_UNITS = ("N",) * 3 + ("N m",) * 3


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
    frequency: float = entry("frequency_hz", unit="Hz")
    damping_ratio: float
    axis: int = entry("load", write=LOADS.__getitem__)
    time: float = entry("passed_at_s", unit="s")
    amplification: float
    peak_time: float = entry("largest_at_s", unit="s")
    peak_frequency: float = entry("largest_at_hz", unit="Hz")


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

    @classmethod
    def of(cls, response: Response, run: Run, rigid_mass: Array) -> "Amplitudes | None":
        """The amplitudes of a run; None where many frequencies are driven at once."""
        if run.sweep is None:
            return None
        band = response.time <= run.sweep.driven
        base, load, rigid = (amplitude(x)[band] for x in (response.table, response.load, rigid_load(response, rigid_mass)))
        time = response.time[band]
        return cls(time=time, frequency=run.sweep.frequency_at(time), base=base, load=load, rigid=rigid)

    def passed(self, run: Run, modes: RigModes) -> tuple[Passed, ...]:
        """Every resonance that the sweep of `run` passed at full level, in the order of its time."""
        sweep = run.sweep
        if sweep is None:
            return ()
        share = modes.participation[list(run.axes)] ** 2 / np.diag(modes.rigid_mass)[list(run.axes), None]
        held = share.max(axis=0) / (2 * np.maximum(modes.damping_ratio, LEAST_DAMPING))
        inside = (modes.frequency >= sweep.start) & (modes.frequency <= sweep.stop) & (held > SHOWS)
        listed = np.flatnonzero(inside)
        # Until when [s] the largest load of each resonance, ascending, is looked for
        frequency = modes.frequency[listed]
        at = sweep.time_at(frequency)
        patience = AFTER / np.sqrt(2 * np.pi * frequency * sweep.rate * np.log(2) / 60)
        following = np.append(at[1:], np.inf)[: len(at)]
        ends = np.where(following - at > CUT * patience, np.minimum(at + patience, following), at + patience)
        stop = float(sweep.time_at(sweep.stop))  # from then on the level falls, and what rings on has nothing beside it
        found = []
        for r, end in zip(listed.tolist(), ends.tolist(), strict=True):
            f, zeta, axis = float(modes.frequency[r]), float(modes.damping_ratio[r]), run.axes[int(np.argmax(share[:, r]))]
            near = np.flatnonzero((self.frequency >= f * (1 - BEFORE * zeta)) & (self.time <= min(end, stop)))
            ratio = self.load[near, axis] / np.maximum(self.rigid[near, axis], np.finfo(np.float64).tiny)
            best = int(np.argmax(ratio))
            one = Passed(
                mode=r + 1,
                frequency=f,
                damping_ratio=zeta,
                axis=axis,
                time=float(sweep.time_at(f)),
                amplification=float(ratio[best]),
                peak_time=float(self.time[near[best]]),
                peak_frequency=float(self.frequency[near[best]]),
            )
            found.append(one)
        return tuple(found)


def rigid_load(response: Response, rigid_mass: Array) -> Array:
    """(n, 6) M a: the load on the rigid body [N, N m]."""
    return np.asarray(response.table @ rigid_mass.T)


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

    axis: int = entry(write=MOTIONS.__getitem__)
    asked: float = unwritten()
    realised: float = unwritten()
    peak: float = unwritten()

    @classmethod
    def of(cls, axis: int, run: Run, response: Response, driven: float) -> "AxisResponse":
        """What `axis` did in `run`, whose table was driven for `driven` [s]."""
        time = response.time
        a = response.table[time <= driven, axis]
        if run.sweep is None:
            realised = float(np.sqrt(np.mean(a**2)))
        else:
            start, stop = (float(run.sweep.time_at(f)) for f in (run.sweep.start, run.sweep.stop))
            realised = float(np.abs(response.table[(time >= start) & (time <= stop), axis]).max())
        return cls(axis=axis, asked=float(run.levels[axis]), realised=realised, peak=float(np.abs(a).max()))

    @property
    @derived("")
    def by_unit(self) -> dict[str, float]:
        """All three by keys that end in the unit of the axis."""
        unit = "m_s2" if self.axis < 3 else "rad_s2"
        return {f"asked_{unit}": self.asked, f"realised_{unit}": self.realised, f"peak_{unit}": self.peak}


@dataclass(frozen=True, kw_only=True)
class CellLoad:
    """The extremes of one load cell [N] as it was simulated, what it is preloaded with not counted.

    Attributes
    ----------
    number : from 1
    lowest, highest : along z; the cover plate pulls at a cell where this is negative
    lateral : largest along x or y
    preload : None for a cell that never lifts off
    share_lifted : [1] of the record in which it was off, to `LIFTED` of its preload
    """

    number: int = entry("cell")
    lowest: float = entry("z_lowest_N", unit="N")
    highest: float = entry("z_highest_N", unit="N")
    lateral: float = entry("lateral_N", unit="N")
    preload: float | None = entry("preload_N", unit="N")
    share_lifted: float

    @classmethod
    def of(cls, number: int, force: Array, cell: LoadCell) -> "CellLoad":
        """The extremes of `force` (n, 3) [N] before a filter rounds the corner where the cell lifts off."""
        preload = cell.preload
        return cls(
            number=number,
            lowest=float(force[:, 2].min()),
            highest=float(force[:, 2].max()),
            lateral=float(np.abs(force[:, :2]).max()),
            preload=preload,
            share_lifted=0.0 if preload is None else float(np.mean(force[:, 2] <= -(1 - LIFTED) * preload)),
        )


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
    mass: float = entry("mass_kg", unit="kg")
    slip_force: float = entry("slip_force_N", unit="N")
    share_slipping: float


@dataclass(frozen=True, kw_only=True)
class RingDown:
    """Whether the record holds the ringing after the drive.

    Attributes
    ----------
    kept : [s] from the end of the drive to that of the record
    needed : [s] from the end of the drive until the ringing has died away
    """

    kept: float = entry("kept_s", unit="s")
    needed: float = entry("needed_s", unit="s")

    @property
    @derived("sufficient")
    def sufficient(self) -> bool:
        """Whether it does, to a millisecond."""
        return self.kept >= self.needed - 1e-3


LOAD_KEYS = tuple(f"{name}_{unit.replace(' ', '')}" for name, unit in zip(LOADS, LOAD_UNITS, strict=True))
"""fx_N ... mx_Nm."""


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
    duration: float = entry("duration_s", unit="s")
    driven: float = entry("driven_s", unit="s")
    levels: tuple[AxisResponse, ...] = entry("level")
    cross: float
    small: SmallMotion = unwritten()
    peak_load: Array = entry(write=lambda loads: dict(zip(LOAD_KEYS, loads, strict=True)))
    peak_time: Array = entry("peak_load_at_s", unit="s")
    passed: tuple[Passed, ...] = entry("resonances")
    ring_down: RingDown
    cells: tuple[CellLoad, ...]
    loose: tuple[LoosePart, ...] = entry("loose_parts")
    step: float = entry("step_s", unit="s")
    settings: Mapping[str, object]
    warnings: tuple[str, ...]

    @property
    @derived("small_motion", before="peak_load")
    def turned(self) -> dict[str, object]:
        """How far the table turned, and whether linear equations may leave that out."""
        one = self.small
        sizes = {"angle_rad": one.angle, "rate_rad_s": one.rate, "left_out": one.left_out, "limit": one.limit}
        return {**sizes, "within": one.within, "text": one.text}


LIFTED = 1e-3
"""A cell counts as off when less than this share of its preload is left."""


def cross_share(run: Run, response: Response) -> float:
    """[1] the largest acceleration of an axis that is not driven, over that of the driven ones, each over its nominal level."""
    size = np.abs(response.table).max(axis=0) / [LEVELS[axis] for axis in MOTIONS]
    driven = np.isin(np.arange(len(MOTIONS)), run.axes)
    return float(size[~driven].max(initial=0.0) / size[driven].max())
