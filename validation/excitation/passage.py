"""When a sweep passes the resonances of a rig, and what each does to the load, measured on the run itself.

Amplitudes are those of the analytic signal (Gabor, Journal of the IEE 93, 1946), which follows a sweep from cycle to cycle. The
amplification is the load's amplitude over that of the rigid body, M a with the acceleration of the same moment, for the load
along the axis that is driven; its largest value near the resonance counts, which a fast sweep reaches a little after passing it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fem.base_excitation.response import Response
from geometry.arrays import Array
from validation.excitation.drives import Run
from validation.excitation.rig_modes import RigModes

if TYPE_CHECKING:
    from fem.base_excitation.patterns import Sweep

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
    ends = _search_ends(run.sweep, modes.frequency[listed])
    axes = [run.axes[int(np.argmax(share[:, r]))] for r in listed]
    return tuple(_passed(found, run.sweep, modes, *one) for one in zip(listed.tolist(), axes, ends.tolist(), strict=True))


def _search_ends(sweep: Sweep, frequency: Array) -> Array:
    """Until when [s] the largest load of each resonance of `frequency` (k,) [Hz], ascending, is looked for."""
    at = sweep.time_at(frequency)
    patience = AFTER / np.sqrt(2 * np.pi * frequency * sweep.rate * np.log(2) / 60)
    following = np.append(at[1:], np.inf)[: len(at)]
    return np.asarray(np.where(following - at > CUT * patience, np.minimum(at + patience, following), at + patience))


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
