"""The picture of `massline excite --plot`: table, loads and cells of one run over time, and over frequency."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import MOTIONS
from validation.article_reference import file_name
from validation.excitation.passage import amplitude, rigid_load
from validation.excitation.runs import Done, Ready
from validation.excitation.signals import LOAD_UNITS, LOADS
from validation.excitation.table import UNITS
from validation.pictures.curves import unit
from validation.pictures.excitation import Row, Sheet, Signal, Spectra, draw_sheet

POINTS = 3000
"""Of a curve over frequency."""

LINES = 1401
"""Of the load over the acceleration: 0.02 Hz in the paper's band."""

BLOCK = (0.5, 2.0)
"""[s] shortest and longest block of a spectrogram."""

ABOVE = 1.25
"""Of the band's upper end: so far a spectrogram reaches."""

BLOCKS = 8
"""A spectrum of noise is averaged over about so many blocks, half of each shared with the next."""


@dataclass(frozen=True, eq=False, kw_only=True)
class View:
    """How a signal becomes an amplitude over frequency.

    Attributes
    ----------
    frequency : (m,) [Hz]
    along : what that is
    per : what the unit of an amplitude has besides that of the signal
    amplitude : from a signal (n,) to (m,)
    """

    frequency: Array
    along: str
    per: str
    amplitude: Callable[[Array], Array]


def draw(made: Ready, one: Done, folder: Path) -> Path:
    """Write the picture of `one` run into `folder`, and say where it is."""
    path = folder / f"{file_name(f'excite-{made.question.article}-{made.route.name}-{one.run.name}')}.png"
    draw_sheet(sheet(made, one), path)
    return path


def sheet(made: Ready, one: Done) -> Sheet:
    """What the picture shows."""
    view = _swept(one) or _noise(one, made.question.drive.band)
    return Sheet(
        title=f"{made.question.article}: {one.run.pattern.label}",
        note=_note(made, one),
        time=one.response.time,
        frequency=view.frequency,
        along=view.along,
        rows=tuple(_rows(made, one, view)),
        spectra=_spectra(made, one),
        marks=tuple((p.time, p.frequency) for p in one.outcome.passed),
        driven=one.motion.driven,
    )


def _rows(made: Ready, one: Done, view: View) -> Iterator[Row]:
    """The table's acceleration, the load along it, the largest load of the other kind, the cells."""
    driven = one.run.axes[0]
    named = f"{'along' if driven < 3 else 'about'} {MOTIONS[driven]}"
    yield Row(
        title=f"Acceleration of the table {named}",
        unit=UNITS[driven],
        unit_of_amplitude=UNITS[driven] + view.per,
        signals=(_signal(MOTIONS[driven], one.response.table[:, driven], view),),
        logarithmic=False,
    )
    other = [k for k in range(6) if (k < 3) != (driven < 3)]
    second = other[int(np.argmax(one.outcome.peak_load[other]))]
    for load in (driven, second):
        yield _load(made, one, load, view)
    if len(one.outcome.cells):
        yield _cells(one, view)


def _load(made: Ready, one: Done, load: int, view: View) -> Row:
    rigid = rigid_load(one.response, made.modes.rigid_mass)[:, load]
    swept = one.run.sweep is not None
    what = f"{'Force' if load < 3 else 'Moment'} {LOADS[load]} of the table on {made.question.article}"
    return Row(
        title=f"{what}; dashed: the rigid body, M a",
        unit=LOAD_UNITS[load],
        unit_of_amplitude=LOAD_UNITS[load] + view.per,
        signals=(_signal(LOADS[load], one.response.load[:, load], view),),
        rigid=(amplitude(rigid) if swept else None, view.amplitude(rigid)),
    )


def _cells(one: Done, view: View) -> Row:
    forces = one.response.cells[:, :, 2]
    loads = [cell.preload for cell in one.outcome.cells if cell.preload is not None]
    return Row(
        title="Load cells along z, change of force; lowest and highest",
        unit="N",
        unit_of_amplitude="N" + view.per,
        signals=tuple(_signal(f"cell {k + 1}", forces[:, k], view) for k in range(forces.shape[1])),
        limit=(f"lifts off at -{min(loads):g} N", -min(loads)) if loads else None,
    )


def _spectra(made: Ready, one: Done) -> Spectra:
    """The load along the driven axis in time and frequency, and over the acceleration, by the Fourier integral of the record."""
    from scipy.signal import spectrogram

    from identification.spectra.full_record import full_record

    driven, response, (low, high) = one.run.axes[0], one.response, made.question.drive.band
    n = len(response.load)
    length = int(min(np.clip(n / response.sampling_rate / BLOCKS**2, *BLOCK) * response.sampling_rate, n))
    how = {"window": "hann", "nperseg": length, "noverlap": 15 * length // 16, "nfft": 4 * length, "detrend": False}
    f, t, power = spectrogram(response.load[:, driven], response.sampling_rate, **how)
    shown = f <= ABOVE * high
    power = power[shown]
    lines = np.linspace(low, high, LINES)
    load, motion = (np.abs(full_record(x[:, driven], response.sampling_rate, lines)) for x in (response.load, response.table))
    return Spectra(
        load=LOADS[driven],
        time=t,
        frequency=f[shown],
        decibel=10 * np.log10(np.maximum(power / power.max(), 1e-30)),
        lines=lines,
        quotient=load / motion,
        cut=not one.outcome.ring_down.sufficient,
        rigid=float(made.modes.rigid_mass[driven, driven]),
        unit=unit(driven, driven),
    )


def _signal(name: str, values: Array, view: View) -> Signal:
    return Signal(name=name, values=values, amplitude=view.amplitude(values))


def _swept(one: Done) -> View | None:
    """Amplitudes while the sweep passes its band; None where it has none."""
    sweep = one.run.sweep
    if sweep is None:
        return None
    time = one.response.time
    begin, end = (int(np.searchsorted(time, float(sweep.time_at(f)))) for f in (sweep.start, sweep.stop))
    shown = np.unique(np.linspace(begin, max(begin, min(end, len(time) - 1)), POINTS).astype(int))
    return View(
        frequency=sweep.frequency_at(time[shown]),
        along="frequency of the sweep at that moment [Hz]",
        per="",
        amplitude=lambda signal: np.asarray(amplitude(signal)[shown]),
    )


def _noise(one: Done, band: tuple[float, float]) -> View:
    """Spectral densities of the record, averaged (Welch, IEEE Trans. Audio 15, 1967)."""
    from scipy.signal import welch

    rate, n = one.response.sampling_rate, len(one.response.table)
    length = max(2 * n // BLOCKS, min(n, 64))

    def density(signal: Array) -> tuple[Array, Array]:
        f, power = welch(signal, rate, nperseg=length)
        return f, np.sqrt(power)

    f = density(one.response.table[:, 0])[0]
    shown = (f >= band[0]) & (f <= band[1])
    return View(
        frequency=f[shown],
        along="frequency [Hz]",
        per="/√Hz",
        amplitude=lambda signal: density(signal)[1][shown],
    )


def _note(made: Ready, one: Done) -> str:
    marks = " Lines and figures above: resonances passed [Hz]." if one.outcome.passed else ""
    about = "the article's origin" if made.mounted.rig.cover is None and made.mounted.model is not None else "F"
    ring = "dotted: end of the drive"
    seen = "amplitude of the analytic signal" if one.run.sweep is not None else "spectral density"
    return f"Route {made.route.name}. Loads about {about}. Left: over time, {ring}. Right: {seen}.{marks}"
