"""The picture of `massline excite --plot`: table, loads and cells of one run over time, and over frequency."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click
import numpy as np

from fem.base_excitation.rig import Flange, Friction, Strut
from fem.exudyn.run import exudyn_version
from geometry.dynamic_mass import MOTIONS
from geometry.frames import Array
from validation.classical.swing import MEASUREMENT, RECORD, Simulated
from validation.excite import runs as excite_runs
from validation.excite.question import BURST, COMPLIANT, LARGE, LINEAR, MULTI, RANDOM, SWEEP, ExciteOptions
from validation.excite.results import AxisResponse, CellLoad, LoosePart, Outcome, Passed, RingDown, amplitude, rigid_load
from validation.excite.rig import FMD, ArticleOnTable, RigModes
from validation.excite.runs import LOAD_UNITS, LOADS, Done, PreparedRuns, as_one_body, done, ready
from validation.output import shown
from validation.reference.reference import file_name
from validation.reference.statement import NONE
from validation.report.charts.excitation import PanelRow, Sheet, Signal, Spectra, draw_sheet
from validation.report.charts.style import unit
from validation.report.document import Grid, aligned, page

# A rig and a route in words: what stands on what, what is attached, and how it was computed.


def rig_text(mounted: ArticleOnTable, modes: RigModes) -> tuple[str, ...]:
    """Sentences, from the table up."""
    made = mounted.rig
    point = "the article's origin" if made.cover is None else "F, the centre of the force-measuring plane"
    cells = made.cells
    if not cells:
        excitation_cells: str = ""
    else:
        stiffness = ", ".join(f"{k:.3g}" for k in cells[0].stiffness)
        loads = [cell.preload for cell in cells]
        off = [f"cell {k} at {load:g} N" for k, load in enumerate(loads, start=1) if load is not None]
        same = len(off) == len(cells) and len(set(loads)) == 1
        lifts = f"each lifts off at {loads[0]:g} N" if same else f"{', '.join(off)} lifts off" if off else "none lifts off"
        excitation_cells = f"Load cells: {stiffness} N/m along x, y, z each; {lifts}."
    return (
        f"{_stands(mounted)}; the table carries {modes.rigid_mass[0, 0]:.4g} kg. Loads about {point}.",
        *filter(None, (excitation_cells, _flange(made.flange))),
        *map(_strut, made.struts),
        *map(_friction, made.frictions),
        *_kept(mounted, modes),
    )


def _stands(mounted: ArticleOnTable) -> str:
    made = mounted.rig
    under = "on its four load cells, springs of assumed stiffness" if made.cells else "which is rigid on the table"
    if mounted.article == FMD:
        return f"The FMD's cover plate ({2 * float(made.article.reduced.mass[0, 0]):.4g} kg) alone, {under}"
    if made.cover is None:
        return f"{made.article.name} on the table itself"
    height = 1e3 * made.seat[2]
    return f"{made.article.name} on the FMD's cover plate ({made.cover.mass:.4g} kg, top {height:g} mm above F), {under}"


def _flange(flange: Flange | None) -> str:
    if flange is None:
        return ""
    given = [
        f"{name} {flange.compliance[axes[0]]:.3g} {'m/N' if axes[0] < 3 else 'rad/(N m)'}"
        for name, axes in COMPLIANT.items()
        if flange.compliance[axes[0]]
    ]
    return f"The flange gives: {', '.join(given)}."


def _strut(strut: Strut) -> str:
    if strut.to == "ground":
        return f"A cable from {strut.place} to the ground: {_along(strut.stiffness)} N/m along x, y, z."
    return f"A damper from {strut.place} to the table: {_along(strut.damping)} N s/m along x, y, z."


def _along(values: Array) -> str:
    return ", ".join(f"{value:g}" for value in values)


def _friction(friction: Friction) -> str:
    part = f"A loose part of {friction.mass:g} kg on the flange"
    return f"{part}, held along {friction.axis} by {friction.slip_force:g} N of friction."


def _kept(mounted: ArticleOnTable, modes: RigModes) -> Iterator[str]:
    if mounted.model is None:
        return
    kept = mounted.rig.article.kept
    if not len(kept):
        first = mounted.model.modes.frequency[:1]
        why = f": its first mode lies at {first[0]:.4g} Hz, beyond what the step follows" if len(first) else ""
        yield f"{mounted.model.model} model, taken as rigid{why}."
        return
    lowest = float(np.min(modes.frequency))
    yield (
        f"{mounted.model.model} model with {len(kept)} modes, {kept[0]:.4g} to {kept[-1]:.4g} Hz, and what the others answer "
        f"statically; on the table the lowest resonance is {lowest:.4g} Hz."
    )
    yield from mounted.model.notes


# What `massline excite` prints: runs, peak loads, resonances, load cells, and below them what must be known to read them.


UNITS = ("m/s²",) * 3 + ("rad/s²",) * 3

LEVEL = {
    SWEEP: "largest amplitude within the band",
    MULTI: "largest amplitude within the band, with what the other axes add",
    RANDOM: "root mean square over the whole drive, of the one asked for at full strength, between soft start and stop",
    BURST: "root mean square over the whole swell, of the one asked for in its middle",
}
"""What is compared with what was asked for, by pattern."""


def page_of(made: PreparedRuns, outcomes: Sequence[Outcome]) -> str:
    """All of it as text."""
    from validation.report.document import page

    return page(f"{made.question.article}: driven in time, {made.route.name} route", grids(outcomes), notes(made, outcomes))


def grids(outcomes: Sequence[Outcome]) -> tuple[Grid, ...]:
    """The tables, from runs to cells; one without a line is left out."""
    return tuple(
        grid for grid in (runs(outcomes), loads(outcomes), resonances(outcomes), cells(outcomes), loose(outcomes)) if grid.lines
    )


def runs(outcomes: Sequence[Outcome]) -> Grid:
    """Duration, level and motion of every run."""
    lines = [
        (
            one.name,
            f"{one.duration:.1f}",
            "\n".join(f"{level.realised:.4g} of {level.asked:.4g} {UNITS[level.axis]}" for level in one.levels[:1]),
            f"{1e3 * one.small.angle:.3f}",
            f"{1e3 * one.small.rate:.2f}",
            f"{100 * one.small.left_out:.3f} of {100 * one.small.limit:g}",
            _ring_down(one.ring_down),
        )
        for one in outcomes
    ]
    header = ("run", "lasts [s]", "level", "turns [mrad]", "at [mrad/s]", "left out [%]", "ring-down")
    return Grid(header=header, lines=tuple(lines), words=True)


def loads(outcomes: Sequence[Outcome]) -> Grid:
    """The largest load of each kind."""
    header = ("peak load", *(f"{name} [{unit}]" for name, unit in zip(LOADS, LOAD_UNITS, strict=True)))
    lines = [(one.name, *(f"{value:.1f}" if value >= 100 else f"{value:.3f}" for value in one.peak_load)) for one in outcomes]
    columns = list(zip(*lines, strict=True))
    return Grid(header=header, lines=tuple(zip(columns[0], *map(aligned, columns[1:]), strict=True)))


def resonances(outcomes: Sequence[Outcome]) -> Grid:
    """Every resonance that was passed."""
    lines = [
        (
            one.name,
            str(p.mode),
            f"{p.frequency:.3f}",
            f"{100 * p.damping_ratio:.2f}",
            f"{p.time:.2f}",
            f"{p.amplification:.2f}",
            LOADS[p.axis],
            f"{p.peak_frequency:.3f}",
        )
        for one in outcomes
        for p in one.passed
    ]
    header = ("run", "mode", "f [Hz]", "ζ [%]", "passed at [s]", "times rigid", "seen in", "largest at [Hz]")
    return Grid(header=header, lines=tuple(lines))


def cells(outcomes: Sequence[Outcome]) -> Grid:
    """The extremes of every load cell."""
    lines = [
        (
            one.name,
            str(number),
            f"{cell.lowest:.1f}",
            f"{cell.highest:.1f}",
            f"{cell.lateral:.1f}",
            NONE if cell.preload is None else f"{cell.preload:g}",
            NONE if cell.preload is None else _share(cell.share_lifted),
        )
        for one in outcomes
        for number, cell in enumerate(one.cells, start=1)
    ]
    header = ("run", "cell", "z from [N]", "to [N]", "lateral up to [N]", "preload [N]", "lifts off")
    return Grid(header=header, lines=tuple(lines))


def loose(outcomes: Sequence[Outcome]) -> Grid:
    """How long every loose part slips."""
    lines = [
        (one.name, part.axis, f"{part.mass:g}", f"{part.slip_force:g}", _share(part.share_slipping))
        for one in outcomes
        for part in one.loose
    ]
    return Grid(header=("run", "loose along", "mass [kg]", "friction [N]", "slips"), lines=tuple(lines))


def notes(made: PreparedRuns, outcomes: Sequence[Outcome]) -> tuple[str, ...]:
    """What must be known to read the tables."""
    labels = [f"{one.name}: {one.label}." for one in outcomes]
    return (
        *labels,
        *rig_text(made.mounted, made.modes),
        *_how(made, outcomes),
        *_explained(made.question.drive.pattern, outcomes),
    )


def _how(made: PreparedRuns, outcomes: Sequence[Outcome]) -> Iterator[str]:
    question = made.question
    what = "exact recursion of its modes" if made.route.name == LINEAR else f"integration by exudyn {exudyn_version()}"
    if made.route.name == LARGE:
        own = "one rigid body" if as_one_body(made) else "exudyn's own bodies and beams"
        what = f"{what} of {own} on a base that turns, instead of the model above"
    step = outcomes[0].step
    yield (
        f"Route {made.route.name}, {made.route.why}: {what}, step {1e6 * step:.4g} µs; recorded at {question.rate:g} Hz "
        "behind one anti-alias filter."
    )
    if question.drive.cross:
        drawn = f"Cross motion of the table: {100 * question.drive.cross:g} % on average, seed {question.drive.seed}"
        largest = ", ".join(f"{100 * one.cross:.2g} % in {one.name}" for one in outcomes if one.cross)
        yield f"{drawn}; the largest on another axis, of the level driven: {largest}." if largest else f"{drawn}."


def _explained(pattern: str, outcomes: Sequence[Outcome]) -> Iterator[str]:
    yield (
        f"Level: {LEVEL[pattern]}. Turns: largest rotation of the table and its rate; left out is what linear equations neglect "
        "of the load for that, and their limit."
    )
    if any(one.cells for one in outcomes):
        yield "Cells: change of force, as simulated; behind the anti-alias filter what is too fast for the record is rounded off."
    if any(cell.preload is not None for one in outcomes for cell in one.cells):
        yield (
            "Preload: the whole force that presses a cell together, weight of the article included, which is not added to it. "
            "While open a cell pulls on with it, and keeps its shear."
        )
    if any(one.loose for one in outcomes):
        yield "Slips: share of the record, ring-down included, in which the friction of a loose part is at its limit."
    if any(one.passed for one in outcomes):
        yield (
            "Times rigid: the largest load near a resonance over M a at that moment; a fast sweep reaches it after passing, and "
            "less of it."
        )


def _ring_down(found: RingDown) -> str:
    if found.sufficient:
        return f"{found.kept:.1f} s, sufficient"
    return f"CUT: {found.kept:.1f} s of {found.needed:.1f} s needed"


def _share(share: float) -> str:
    return f"{100 * share:.2g} % of the time" if share else "never"


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
class AmplitudeView:
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


def draw(made: PreparedRuns, one: Done, folder: Path) -> Path:
    """Write the picture of `one` run into `folder`, and say where it is."""
    path = folder / f"{file_name(f'excite-{made.question.article}-{made.route.name}-{one.run.name}')}.png"
    draw_sheet(sheet(made, one), path)
    return path


def sheet(made: PreparedRuns, one: Done) -> Sheet:
    """What the picture shows."""
    view = _swept(one) or _noise(one, made.question.drive.band)
    from scipy.signal import spectrogram

    # The load along the driven axis in time and frequency, and over the acceleration, by the Fourier integral of the record
    from identification.spectra.line_spectra import full_record

    driven, response, (low, high) = one.run.axes[0], one.response, made.question.drive.band
    n = len(response.load)
    length = int(min(np.clip(n / response.sampling_rate / BLOCKS**2, *BLOCK) * response.sampling_rate, n))
    how = {"window": "hann", "nperseg": length, "noverlap": 15 * length // 16, "nfft": 4 * length, "detrend": False}
    f, t, power = spectrogram(response.load[:, driven], response.sampling_rate, **how)
    shown = f <= ABOVE * high
    power = power[shown]
    lines = np.linspace(low, high, LINES)
    load, motion = (np.abs(full_record(x[:, driven], response.sampling_rate, lines)) for x in (response.load, response.table))
    spectra = Spectra(
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
    return Sheet(
        title=f"{made.question.article}: {one.run.pattern.label}",
        note=_note(made, one),
        time=one.response.time,
        frequency=view.frequency,
        along=view.along,
        rows=tuple(_rows(made, one, view)),
        spectra=spectra,
        marks=tuple((p.time, p.frequency) for p in one.outcome.passed),
        driven=one.motion.driven,
    )


def _rows(made: PreparedRuns, one: Done, view: AmplitudeView) -> Iterator[PanelRow]:
    """The table's acceleration, the load along it, the largest load of the other kind, the cells."""
    driven = one.run.axes[0]
    named = f"{'along' if driven < 3 else 'about'} {MOTIONS[driven]}"
    yield PanelRow(
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


def _load(made: PreparedRuns, one: Done, load: int, view: AmplitudeView) -> PanelRow:
    rigid = rigid_load(one.response, made.modes.rigid_mass)[:, load]
    swept = one.run.sweep is not None
    what = f"{'Force' if load < 3 else 'Moment'} {LOADS[load]} of the table on {made.question.article}"
    return PanelRow(
        title=f"{what}; dashed: the rigid body, M a",
        unit=LOAD_UNITS[load],
        unit_of_amplitude=LOAD_UNITS[load] + view.per,
        signals=(_signal(LOADS[load], one.response.load[:, load], view),),
        rigid=(amplitude(rigid) if swept else None, view.amplitude(rigid)),
    )


def _cells(one: Done, view: AmplitudeView) -> PanelRow:
    forces = one.response.cells[:, :, 2]
    loads = [cell.preload for cell in one.outcome.cells if cell.preload is not None]
    return PanelRow(
        title="Load cells along z, change of force; lowest and highest",
        unit="N",
        unit_of_amplitude="N" + view.per,
        signals=tuple(_signal(f"cell {k + 1}", forces[:, k], view) for k in range(forces.shape[1])),
        limit=(f"lifts off at -{min(loads):g} N", -min(loads)) if loads else None,
    )


def _signal(name: str, values: Array, view: AmplitudeView) -> Signal:
    return Signal(name=name, values=values, amplitude=view.amplitude(values))


def _swept(one: Done) -> AmplitudeView | None:
    """Amplitudes while the sweep passes its band; None where it has none."""
    sweep = one.run.sweep
    if sweep is None:
        return None
    time = one.response.time
    begin, end = (int(np.searchsorted(time, float(sweep.time_at(f)))) for f in (sweep.start, sweep.stop))
    shown = np.unique(np.linspace(begin, max(begin, min(end, len(time) - 1)), POINTS).astype(int))
    return AmplitudeView(
        frequency=sweep.frequency_at(time[shown]),
        along="frequency of the sweep at that moment [Hz]",
        per="",
        amplitude=lambda signal: np.asarray(amplitude(signal)[shown]),
    )


def _noise(one: Done, band: tuple[float, float]) -> AmplitudeView:
    """Spectral densities of the record, averaged (Welch, IEEE Trans. Audio 15, 1967)."""
    from scipy.signal import welch

    rate, n = one.response.sampling_rate, len(one.response.table)
    length = max(2 * n // BLOCKS, min(n, 64))

    def density(signal: Array) -> tuple[Array, Array]:
        f, power = welch(signal, rate, nperseg=length)
        return f, np.sqrt(power)

    f = density(one.response.table[:, 0])[0]
    shown = (f >= band[0]) & (f <= band[1])
    return AmplitudeView(
        frequency=f[shown],
        along="frequency [Hz]",
        per="/√Hz",
        amplitude=lambda signal: density(signal)[1][shown],
    )


def _note(made: PreparedRuns, one: Done) -> str:
    marks = " Lines and figures above: resonances passed [Hz]." if one.outcome.passed else ""
    about = "the article's origin" if made.mounted.rig.cover is None and made.mounted.model is not None else "F"
    ring = "dotted: end of the drive"
    seen = "amplitude of the analytic signal" if one.run.sweep is not None else "spectral density"
    return f"Route {made.route.name}. Loads about {about}. Left: over time, {ring}. Right: {seen}.{marks}"


# The JSON object of `massline excite`, a stable contract: keys end in their unit, loads act on the article.


ACCELERATION = ("m_s2",) * 3 + ("rad_s2",) * 3
LOAD_KEYS = tuple(f"{name}_{unit.replace(' ', '')}" for name, unit in zip(LOADS, LOAD_UNITS, strict=True))
"""fx_N ... mx_Nm."""


def of(made: PreparedRuns, outcomes: Sequence[Outcome], files: Sequence[Sequence[Path]]) -> dict[str, Any]:
    """All that is printed, and more digits of it; `files` were written for each run."""
    question, rig = made.question, made.mounted.rig
    drive = question.drive
    return {
        "article": question.article,
        "model": None if made.mounted.model is None else made.mounted.model.model,
        "route": made.route.name,
        "route_why": made.route.why,
        "exudyn": None if made.route.name == LINEAR else exudyn_version(),
        "about": "article" if rig.cover is None and made.mounted.model is not None else "F",
        "sampling_rate_hz": question.rate,
        "drive": {
            "pattern": drive.pattern,
            "band_hz": list(drive.band),
            "octaves_per_minute": drive.octaves_per_minute,
            "level": drive.level,
            "cross": drive.cross,
            "seed": drive.seed,
        },
        "rig": {
            "text": list(rig_text(made.mounted, made.modes)),
            "linear": rig.linear,
            "mass_kg": float(made.modes.rigid_mass[0, 0]),
            "modes_kept": len(rig.article.kept),
            "frequency_hz": made.modes.frequency.tolist(),
            "resonance": list(made.modes.resonance),
            "damping_ratio": made.modes.damping_ratio.tolist(),
        },
        "runs": [_run(one, paths) for one, paths in zip(outcomes, files, strict=True)],
    }


def _run(one: Outcome, files: Sequence[Path]) -> dict[str, Any]:
    return {
        "name": one.name,
        "label": one.label,
        "duration_s": one.duration,
        "driven_s": one.driven,
        "level": [_level(level) for level in one.levels],
        "cross": one.cross,
        "small_motion": {
            "angle_rad": one.small.angle,
            "rate_rad_s": one.small.rate,
            "left_out": one.small.left_out,
            "limit": one.small.limit,
            "within": one.small.within,
            "text": one.small.text,
        },
        "peak_load": dict(zip(LOAD_KEYS, one.peak_load.tolist(), strict=True)),
        "peak_load_at_s": one.peak_time.tolist(),
        "resonances": [_passed(p) for p in one.passed],
        "ring_down": {
            "kept_s": one.ring_down.kept,
            "needed_s": one.ring_down.needed,
            "sufficient": one.ring_down.sufficient,
        },
        "cells": [_cell(number, cell) for number, cell in enumerate(one.cells, start=1)],
        "loose_parts": [_loose(part) for part in one.loose],
        "step_s": one.step,
        "settings": dict(one.settings),
        "warnings": list(one.warnings),
        "files": [str(path) for path in files],
    }


def _level(level: AxisResponse) -> dict[str, Any]:
    unit = ACCELERATION[level.axis]
    return {
        "axis": MOTIONS[level.axis],
        f"asked_{unit}": level.asked,
        f"realised_{unit}": level.realised,
        f"peak_{unit}": level.peak,
    }


def _passed(p: Passed) -> dict[str, Any]:
    return {
        "mode": p.mode,
        "frequency_hz": p.frequency,
        "damping_ratio": p.damping_ratio,
        "load": LOADS[p.axis],
        "passed_at_s": p.time,
        "amplification": p.amplification,
        "largest_at_s": p.peak_time,
        "largest_at_hz": p.peak_frequency,
    }


def _cell(number: int, cell: CellLoad) -> dict[str, Any]:
    return {
        "cell": number,
        "z_lowest_N": cell.lowest,
        "z_highest_N": cell.highest,
        "lateral_N": cell.lateral,
        "preload_N": cell.preload,
        "share_lifted": cell.share_lifted,
    }


def _loose(part: LoosePart) -> dict[str, Any]:
    return {
        "axis": part.axis,
        "mass_kg": part.mass,
        "slip_force_N": part.slip_force,
        "share_slipping": part.share_slipping,
    }


# The run of `massline excite`: ask, drive, write files and pictures run by run, and print what came of it.


FOLDER = Path("out")


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """What is wanted of the runs beside their figures.

    Attributes
    ----------
    out : file for the signals; one for each run where there are several
    plot, animate : pictures
    as_json : one object instead of tables, and no progress
    """

    out: Path | None
    plot: bool
    animate: bool
    as_json: bool


def excite(question: ExciteOptions, wanted: Wanted) -> None:
    """Answer `question`, write what is `wanted`, and print.

    Raises
    ------
    BadInput : something in `question` cannot be, a file that cannot be written so; before anything is computed.
    CheckFailed : a route failed.
    """
    from validation.output import print_json, require_file, require_folder

    if wanted.out is not None:
        excite_runs.require_ending(wanted.out)
        require_file(wanted.out, "--out")
    for option, drawn in (("--plot", wanted.plot), ("--animate", wanted.animate)):
        if drawn:
            require_folder(FOLDER, option)
    made = ready(question, quiet=wanted.as_json)
    if wanted.animate:
        from validation.report.scenes.turntable import require_animable

        require_animable(made)
    outcomes, files = [], []
    for one in done(made, keep_coordinates=wanted.animate, quiet=wanted.as_json):
        files.append(_written(made, one, wanted))
        outcomes.append(one.outcome)
        for warning in one.outcome.warnings:
            click.echo(f"massline: {one.run.name}: {warning}", err=True)
    if wanted.as_json:
        print_json(of(made, outcomes, files))
    else:
        click.echo(page_of(made, outcomes), nl=False)
    for path in (path for paths in files for path in paths):
        click.echo(f"massline: wrote {path}.", err=True)


def _written(made: PreparedRuns, one: Done, wanted: Wanted) -> list[Path]:
    """The files of one run."""
    written: list[Path] = []
    if wanted.out is not None:
        path = wanted.out if len(made.runs) == 1 else wanted.out.with_stem(f"{wanted.out.stem}-{one.run.name}")
        with shown(f"{one.run.name}: writing {path}", quiet=wanted.as_json):
            excite_runs.write(path, one.response, f"{made.question.article}: {one.run.pattern.label}")
        written.append(path)
    if wanted.plot:
        with shown(f"{one.run.name}: drawing", quiet=wanted.as_json):
            written.append(draw(made, one, FOLDER))
    if wanted.animate:
        from validation.report.scenes.turntable import animate

        with shown(f"{one.run.name}: drawing the passage of a resonance", quiet=wanted.as_json):
            moving = animate(made, one, FOLDER)
        if moving is None:
            click.echo(f"massline: {one.run.name}: no resonance was passed, and nothing is animated.", err=True)
        else:
            written.append(moving)
    return written


# What `massline swing` prints: the period beside Eq. 5's, the shifts by cause, the reduced inertia beside the true one.


WHY = {
    "amplitude": "taken off, its size stated",
    "damping": "taken off, its size from the record",
    "rope-mass": "taken off, its size stated; {links} links a rope stand for a uniform one",
    "rope-stretch": "not known to Eq. 5: it would be, were the length measured with the article on the ropes",
    "off-centre": "not known to Eq. 5: s1 and s2, or the radius, are not what they are thought to be",
    "unequal ropes": "not known to Eq. 5",
}
"""What the reduction does about each effect."""


def text(found: Simulated) -> str:
    """The page for a reader."""
    setup = found.record.setup
    title = f"{setup.article} on {setup.suspension.ropes} ropes, axis {setup.axis} upright: simulated by exudyn"
    record, periods_setup = found.record, found.record.setup
    small = record.swing.small_period
    lines = [
        ("by Eq. 5 from the inertia", f"{periods_setup.ideal_period:.6f}", ""),
        ("small swings, by statics", f"{small:.6f}", _percent(small / periods_setup.ideal_period - 1)),
        (f"recorded, {record.decay.cycles:.1f} cycles", f"{record.period:.6f}", _percent(record.shift)),
    ]
    periods = Grid(header=("period", "T [s]", "from Eq. 5 [%]"), lines=_columns(lines))
    links = found.record.setup.suspension.links
    shifts_lines = [
        (s.name, _percent(s.period), _percent(s.plain), _percent(s.corrected), WHY[s.name].format(links=links))
        for s in found.shifts
    ]
    shifts_lines.append(
        ("all together", _percent(found.record.shift), _percent(found.plain), _percent(found.corrected), "the record")
    )
    header = ("effect alone", "period [%]", "inertia by Eq. 5 [%]", "corrected [%]", "what the reduction does")
    shifts = Grid(header=header, lines=_columns(shifts_lines, words=True), words=True)
    return page(title, [periods, shifts, _inertias(found)], report_notes(found))


def as_json(found: Simulated, folder: Path | None) -> dict[str, Any]:
    """The same for a program."""
    record, setup = found.record, found.record.setup
    return {
        "article": setup.article,
        "axis": setup.axis,
        "ropes": setup.suspension.ropes,
        "mass_kg": setup.inertia.mass,
        "period_s": record.period,
        "period_eq5_s": setup.ideal_period,
        "period_small_s": record.swing.small_period,
        "damping_ratio": float(record.decay.damping_ratio.nominal_value),
        "amplitude_rms_rad": record.decay.amplitude,
        "cycles": record.decay.cycles,
        "period_shift_percent": {s.name: 100 * s.period for s in found.shifts} | {"all": 100 * record.shift},
        "moi_kgm2": {"reference": setup.reference, "eq5": record.plain, "corrected": record.corrected},
        "moi_error_percent": {"eq5": 100 * found.plain, "corrected": 100 * found.corrected},
        "corrections_percent": {name: 100 * part for name, part in record.effects.items()},
        "settings": dict(record.swing.settings),
        "files": [] if folder is None else [str(folder / RECORD), str(folder / MEASUREMENT)],
        "notes": [*report_notes(found)],
    }


def report_notes(found: Simulated) -> tuple[str, ...]:
    """What the figures do not say by themselves, sentences."""
    setup, swing = found.record.setup, found.record.swing
    s, tensor = setup.suspension, setup.inertia.tensor_cog
    tilt = float(np.abs(tensor[2, :2]).max() / tensor[2, 2])
    said = {
        f"The body is let go at rest from a twist of {s.amplitude:.4g} rad.": s.start == "twist",
        f"The body is pushed about the vertical out of its equilibrium, so that it swings to {s.amplitude:.4g} rad.": s.start
        == "push",
        f"Exudyn {swing.settings['version']}, {swing.settings['method']}, "
        f"{swing.settings['steps_per_period']:.0f} steps a period. "
        "The method's own share of the period is 3e-6 at 1000, and falls with the square.": True,
        f"The vertical is no principal axis (product {tilt:.1%} of the moment): the twist drags a tilt along.": tilt > PRODUCT,
        "On two ropes at s1 != s2 the amplitude's correction is an approximation.": len(set(setup.radii)) == 2,
    }
    return (*(sentence for sentence, true in said.items() if true), *found.record.decay.notes, *swing.warnings)


PRODUCT = 1e-3
"""Product of inertia, relative to the moment, that is worth a word."""


def _inertias(found: Simulated) -> Grid:
    record, setup = found.record, found.record.setup
    rows = (("simulated body", setup.reference), ("Eq. 5 alone", record.plain), ("with corrections", record.corrected))
    lines = [(name, f"{value:.6g}", _percent(value / setup.reference - 1)) for name, value in rows]
    return Grid(header=("moment of inertia", f"Θ{2 * setup.axis} [kg m²]", "error [%]"), lines=_columns(lines))


def _percent(share: float) -> str:
    return f"{100 * share:+.4f}"


def _columns(lines: Sequence[tuple[str, ...]], *, words: bool = False) -> tuple[tuple[str, ...], ...]:
    columns = list(zip(*lines, strict=True))
    last = len(columns) - 1 if words else len(columns)
    shown = [columns[0], *map(aligned, columns[1:last]), *columns[last:]]
    return tuple(zip(*shown, strict=True))
