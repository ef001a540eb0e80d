"""Tests simulated in time, `massline excite`, `simulate` and `swing`: their pages, their JSON, the picture of a driven run."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from operator import itemgetter
from pathlib import Path
from typing import Any

import click
import numpy as np

from fem.exudyn.run import exudyn_version
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.frames import Array
from identification import campaign_file
from identification.campaign import Campaign, require_alive
from validation.classical.swing import MEASUREMENT, RECORD, Simulated
from validation.excite import runs as excite_runs
from validation.excite.question import BURST, COMPLIANT, LARGE, LINEAR, MULTI, RANDOM, SWEEP, ExciteOptions
from validation.excite.results import LOAD_UNITS, LOADS, Outcome, amplitude, rigid_load
from validation.excite.rig import FMD, ArticleOnTable, RigModes
from validation.excite.runs import Done, PreparedRuns, ready
from validation.identify.check import of_campaign
from validation.output import (
    NONE,
    fixed,
    print_answer,
    print_json,
    require_file,
    require_folder,
    share_done,
    shown,
    to_json,
    wrote,
)
from validation.reference.reference import file_name
from validation.report import campaign as campaign_page
from validation.report.charts.excitation import PanelRow, Sheet, Signal, Spectra, draw_sheet
from validation.report.charts.style import unit
from validation.report.document import Column, Document, Grid, Table, aligned, page
from validation.virtual_test import simulate as virtual_test
from validation.virtual_test import structure_tests
from validation.virtual_test.plan import HAMMER, MODES, Plan
from validation.virtual_test.simulate import SimulateOptions, VirtualTest

# What `massline excite` prints: runs, peak loads, resonances, load cells, and below them what must be known to read them.


LEVEL = {
    SWEEP: "largest amplitude within the band",
    MULTI: "largest amplitude within the band, with what the other axes add",
    RANDOM: "root mean square over the whole drive, of the one asked for at full strength, between soft start and stop",
    BURST: "root mean square over the whole swell, of the one asked for in its middle",
}
"""What is compared with what was asked for, by pattern."""


def rig_text(mounted: ArticleOnTable, modes: RigModes) -> Iterator[str]:
    """A rig in sentences, from the table up: what stands on what, what is attached, and how many modes it has."""
    made, cells = mounted.rig, mounted.rig.cells
    under = "on its four load cells, springs of assumed stiffness" if cells else "which is rigid on the table"
    if mounted.article == FMD:
        stands = f"The FMD's cover plate ({2 * float(made.article.reduced.mass[0, 0]):.4g} kg) alone, {under}"
    elif made.cover is None:
        stands = f"{made.article.name} on the table itself"
    else:
        plate = f"the FMD's cover plate ({made.cover.mass:.4g} kg, top {1e3 * made.seat[2]:g} mm above F)"
        stands = f"{made.article.name} on {plate}, {under}"
    point = "the article's origin" if made.cover is None else "F, the centre of the force-measuring plane"
    yield f"{stands}; the table carries {modes.rigid_mass[0, 0]:.4g} kg. Loads about {point}."
    if cells:
        loads = [cell.preload for cell in cells]
        off = [f"cell {k} at {load:g} N" for k, load in enumerate(loads, start=1) if load is not None]
        same = len(off) == len(cells) and len(set(loads)) == 1
        lifts = f"each lifts off at {loads[0]:g} N" if same else f"{', '.join(off)} lifts off" if off else "none lifts off"
        yield f"Load cells: {', '.join(f'{k:.3g}' for k in cells[0].stiffness)} N/m along x, y, z each; {lifts}."
    if made.flange is not None:
        of = {name: (made.flange.compliance[axes[0]], "m/N" if axes[0] < 3 else "rad/(N m)") for name, axes in COMPLIANT.items()}
        yield f"The flange gives: {', '.join(f'{name} {size:.3g} {per}' for name, (size, per) in of.items() if size)}."
    for strut in made.struts:
        sizes = ", ".join(f"{value:g}" for value in (strut.stiffness if strut.to == "ground" else strut.damping))
        if strut.to == "ground":
            yield f"A cable from {strut.place} to the ground: {sizes} N/m along x, y, z."
        else:
            yield f"A damper from {strut.place} to the table: {sizes} N s/m along x, y, z."
    for loose in made.frictions:
        held = f"held along {loose.axis} by {loose.slip_force:g} N of friction"
        yield f"A loose part of {loose.mass:g} kg on the flange, {held}."
    if mounted.model is None:
        return
    kept = made.article.kept
    if not len(kept):
        first = mounted.model.modes.frequency[:1]
        why = f": its first mode lies at {first[0]:.4g} Hz, beyond what the step follows" if len(first) else ""
        yield f"{mounted.model.model} model, taken as rigid{why}."
        return
    yield (
        f"{mounted.model.model} model with {len(kept)} modes, {kept[0]:.4g} to {kept[-1]:.4g} Hz, and what the others answer "
        f"statically; on the table the lowest resonance is {float(np.min(modes.frequency)):.4g} Hz."
    )
    yield from mounted.model.notes


def document(made: PreparedRuns, outcomes: Sequence[Outcome]) -> Document:
    """All of the runs, in the order in which it is read."""

    def ring_down(one: Outcome) -> str:
        kept = f"{one.ring_down.kept:.1f} s"
        return f"{kept}, sufficient" if one.ring_down.sufficient else f"CUT: {kept} of {one.ring_down.needed:.1f} s needed"

    def level(one: Outcome) -> str:
        return "".join(f"{of.realised:.4g} of {of.asked:.4g} {campaign_page.LEVEL_UNITS[of.axis]}" for of in one.levels[:1])

    def share(of: float) -> str:
        return f"{100 * of:.2g} % of the time" if of else "never"

    def load(value: float) -> str:
        return f"{value:.1f}" if value >= 100 else f"{value:.3f}"

    run = Column("run", lambda row: row[0].name)
    runs = Table(
        rows=outcomes,
        columns=(
            Column("run", lambda one: one.name),
            Column("lasts [s]", lambda one: one.duration, ".1f"),
            Column("level", level, aligned=False),
            Column("turns [mrad]", lambda one: 1e3 * one.small.angle, ".3f"),
            Column("at [mrad/s]", lambda one: 1e3 * one.small.rate, ".2f"),
            Column("left out [%]", lambda one: f"{100 * one.small.left_out:.3f} of {100 * one.small.limit:g}", aligned=False),
            Column("ring-down", ring_down, words=True),
        ),
    )
    heads = [f"{name} [{unit}]" for name, unit in zip(LOADS, LOAD_UNITS, strict=True)]
    loads = Table(
        rows=[(one.name, *map(load, one.peak_load)) for one in outcomes],
        columns=[Column(head, itemgetter(k)) for k, head in enumerate(("peak load", *heads))],
    )
    resonances = Table(
        rows=[(one, p) for one in outcomes for p in one.passed],
        columns=(
            run,
            Column("mode", lambda row: str(row[1].mode)),
            Column("f [Hz]", lambda row: row[1].frequency, ".3f"),
            Column("ζ [%]", lambda row: 100 * row[1].damping_ratio, ".2f"),
            Column("passed at [s]", lambda row: row[1].time, ".2f"),
            Column("times rigid", lambda row: row[1].amplification, ".2f"),
            Column("seen in", lambda row: LOADS[row[1].axis]),
            Column("largest at [Hz]", lambda row: row[1].peak_frequency, ".3f"),
        ),
    )
    cells = Table(
        rows=[(one, cell) for one in outcomes for cell in one.cells],
        columns=(
            run,
            Column("cell", lambda row: str(row[1].number)),
            Column("z from [N]", lambda row: row[1].lowest, ".1f"),
            Column("to [N]", lambda row: row[1].highest, ".1f"),
            Column("lateral up to [N]", lambda row: row[1].lateral, ".1f"),
            Column("preload [N]", lambda row: row[1].preload, "g", aligned=False),
            Column("lifts off", lambda row: NONE if row[1].preload is None else share(row[1].share_lifted), aligned=False),
        ),
    )
    loose = Table(
        rows=[(one, part) for one in outcomes for part in one.loose],
        columns=(
            run,
            Column("loose along", lambda row: row[1].axis),
            Column("mass [kg]", lambda row: row[1].mass, "g", aligned=False),
            Column("friction [N]", lambda row: row[1].slip_force, "g", aligned=False),
            Column("slips", lambda row: share(row[1].share_slipping), aligned=False),
        ),
    )
    return Document(
        title=f"{made.question.article}: driven in time, {made.route.name} route",
        blocks=(runs, loads, resonances, cells, loose),
        notes=(*(f"{one.name}: {one.label}." for one in outcomes), *rig_text(made.mounted, made.modes), *_notes(made, outcomes)),
    )


def _notes(made: PreparedRuns, outcomes: Sequence[Outcome]) -> Iterator[str]:
    """How it was computed, and what must be known to read the tables."""
    question, route = made.question, made.route
    what = "exact recursion of its modes" if route.name == LINEAR else f"integration by exudyn {exudyn_version()}"
    if route.name == LARGE:
        own = "one rigid body" if made.as_one_body else "exudyn's own bodies and beams"
        what = f"{what} of {own} on a base that turns, instead of the model above"
    yield (
        f"Route {route.name}, {route.why}: {what}, step {1e6 * outcomes[0].step:.4g} µs; recorded at {question.rate:g} Hz "
        "behind one anti-alias filter."
    )
    if question.drive.cross:
        drawn = f"Cross motion of the table: {100 * question.drive.cross:g} % on average, seed {question.drive.seed}"
        largest = ", ".join(f"{100 * one.cross:.2g} % in {one.name}" for one in outcomes if one.cross)
        yield f"{drawn}; the largest on another axis, of the level driven: {largest}." if largest else f"{drawn}."
    yield (
        f"Level: {LEVEL[question.drive.pattern]}. Turns: largest rotation of the table and its rate; left out is what linear "
        "equations neglect of the load for that, and their limit."
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


# The picture of `massline excite --plot`: table, loads and cells of one run over time, and over frequency.


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

    @classmethod
    def of(cls, one: Done, band: tuple[float, float]) -> "AmplitudeView":
        """Amplitudes while the sweep of `one` run passes its band; without a sweep spectral densities of the record, averaged
        (Welch, IEEE Trans. Audio 15, 1967)."""
        time, rate, sweep = one.response.time, one.response.sampling_rate, one.run.sweep
        if sweep is not None:
            begin, end = (int(np.searchsorted(time, float(sweep.time_at(f)))) for f in (sweep.start, sweep.stop))
            at = np.unique(np.linspace(begin, max(begin, min(end, len(time) - 1)), POINTS).astype(int))
            return cls(
                frequency=sweep.frequency_at(time[at]),
                along="frequency of the sweep at that moment [Hz]",
                per="",
                amplitude=lambda signal: np.asarray(amplitude(signal)[at]),
            )
        from scipy.signal import welch

        n = len(one.response.table)
        length = max(2 * n // BLOCKS, min(n, 64))
        f = welch(one.response.table[:, 0], rate, nperseg=length)[0]
        inside = (f >= band[0]) & (f <= band[1])
        return cls(
            frequency=f[inside],
            along="frequency [Hz]",
            per="/√Hz",
            amplitude=lambda signal: np.sqrt(welch(signal, rate, nperseg=length)[1])[inside],
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class RunPicture:
    """The picture of `one` of the runs that were `made` ready."""

    made: PreparedRuns
    one: Done

    def draw(self, folder: Path) -> Path:
        """Write it into `folder`, and say where it is."""
        path = folder / f"{file_name(f'excite-{self.made.question.article}-{self.made.route.name}-{self.one.run.name}')}.png"
        draw_sheet(self.sheet(), path)
        return path

    def sheet(self) -> Sheet:
        """What it shows."""
        made, one = self.made, self.one
        view = AmplitudeView.of(one, made.question.drive.band)
        marks = " Lines and figures above: resonances passed [Hz]." if one.outcome.passed else ""
        about = "the article's origin" if made.about_article else "F"
        seen = "amplitude of the analytic signal" if one.run.sweep is not None else "spectral density"
        left = "Left: over time, dotted: end of the drive"
        return Sheet(
            title=f"{made.question.article}: {one.run.pattern.label}",
            note=f"Route {made.route.name}. Loads about {about}. {left}. Right: {seen}.{marks}",
            time=one.response.time,
            frequency=view.frequency,
            along=view.along,
            rows=tuple(self._rows(view)),
            spectra=self._spectra(),
            marks=tuple((p.time, p.frequency) for p in one.outcome.passed),
            driven=one.motion.driven,
        )

    def _rows(self, view: AmplitudeView) -> Iterator[PanelRow]:
        """The table's acceleration, the load along it, the largest load of the other kind, the cells."""

        def signal(name: str, values: Array) -> Signal:
            return Signal(name=name, values=values, amplitude=view.amplitude(values))

        one, response = self.one, self.one.response
        driven = one.run.axes[0]
        yield PanelRow(
            title=f"Acceleration of the table {'along' if driven < 3 else 'about'} {MOTIONS[driven]}",
            unit=campaign_page.LEVEL_UNITS[driven],
            unit_of_amplitude=campaign_page.LEVEL_UNITS[driven] + view.per,
            signals=(signal(MOTIONS[driven], response.table[:, driven]),),
            logarithmic=False,
        )
        other = [k for k in range(6) if (k < 3) != (driven < 3)]
        for k in (driven, other[int(np.argmax(one.outcome.peak_load[other]))]):
            rigid = rigid_load(response, self.made.modes.rigid_mass)[:, k]
            what = f"{'Force' if k < 3 else 'Moment'} {LOADS[k]} of the table on {self.made.question.article}"
            yield PanelRow(
                title=f"{what}; dashed: the rigid body, M a",
                unit=LOAD_UNITS[k],
                unit_of_amplitude=LOAD_UNITS[k] + view.per,
                signals=(signal(LOADS[k], response.load[:, k]),),
                rigid=(amplitude(rigid) if one.run.sweep is not None else None, view.amplitude(rigid)),
            )
        if len(one.outcome.cells):
            forces = response.cells[:, :, 2]
            loads = [cell.preload for cell in one.outcome.cells if cell.preload is not None]
            yield PanelRow(
                title="Load cells along z, change of force; lowest and highest",
                unit="N",
                unit_of_amplitude="N" + view.per,
                signals=tuple(signal(f"cell {k + 1}", forces[:, k]) for k in range(forces.shape[1])),
                limit=(f"lifts off at -{min(loads):g} N", -min(loads)) if loads else None,
            )

    def _spectra(self) -> Spectra:
        """The load along the driven axis in time and frequency; over the acceleration, by the Fourier integral of the record."""
        from scipy.signal import spectrogram

        from identification.spectra.line_spectra import full_record

        driven, response, (low, high) = self.one.run.axes[0], self.one.response, self.made.question.drive.band
        n, rate = len(response.load), response.sampling_rate
        length = int(min(np.clip(n / rate / BLOCKS**2, *BLOCK) * rate, n))
        how = {"window": "hann", "nperseg": length, "noverlap": 15 * length // 16, "nfft": 4 * length, "detrend": False}
        f, t, power = spectrogram(response.load[:, driven], rate, **how)
        inside = f <= ABOVE * high
        power = power[inside]
        lines = np.linspace(low, high, LINES)
        load, motion = (np.abs(full_record(x[:, driven], rate, lines)) for x in (response.load, response.table))
        return Spectra(
            load=LOADS[driven],
            time=t,
            frequency=f[inside],
            decibel=10 * np.log10(np.maximum(power / power.max(), 1e-30)),
            lines=lines,
            quotient=load / motion,
            cut=not self.one.outcome.ring_down.sufficient,
            rigid=float(self.made.modes.rigid_mass[driven, driven]),
            unit=unit(driven, driven),
        )


# The run of `massline excite`: ask, drive, write files and pictures run by run, and print what came of it.


def excite_json(made: PreparedRuns, outcomes: Sequence[Outcome], files: Sequence[Sequence[Path]]) -> dict[str, Any]:
    """The JSON object of `massline excite`, a stable contract; `files` were written for each run."""
    question, rig, modes = made.question, made.mounted.rig, made.modes
    return {
        "article": question.article,
        "model": None if made.mounted.model is None else made.mounted.model.model,
        "route": made.route.name,
        "route_why": made.route.why,
        "exudyn": None if made.route.name == LINEAR else exudyn_version(),
        "about": "article" if made.about_article else "F",
        "sampling_rate_hz": question.rate,
        "drive": to_json(question.drive),
        "rig": {
            "text": list(rig_text(made.mounted, modes)),
            "linear": rig.linear,
            "mass_kg": float(modes.rigid_mass[0, 0]),
            "modes_kept": len(rig.article.kept),
            "frequency_hz": modes.frequency.tolist(),
            "resonance": list(modes.resonance),
            "damping_ratio": modes.damping_ratio.tolist(),
        },
        "runs": [{**to_json(one), "files": list(map(str, paths))} for one, paths in zip(outcomes, files, strict=True)],
    }


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
    for one in made.done(keep_coordinates=wanted.animate, quiet=wanted.as_json):
        files.append(_written_run(made, one, wanted))
        outcomes.append(one.outcome)
        for warning in one.outcome.warnings:
            click.echo(f"massline: {one.run.name}: {warning}", err=True)
    page = document(made, outcomes)
    print_answer(lambda: excite_json(made, outcomes, files), page.text, as_json=wanted.as_json)
    wrote(*(path for paths in files for path in paths))


def _written_run(made: PreparedRuns, one: Done, wanted: Wanted) -> list[Path]:
    """The files of one run."""
    name, quiet, written = one.run.name, wanted.as_json, []
    if wanted.out is not None:
        path = wanted.out if len(made.runs) == 1 else wanted.out.with_stem(f"{wanted.out.stem}-{name}")
        with shown(f"{name}: writing {path}", quiet=quiet):
            excite_runs.write(path, one.response, f"{made.question.article}: {one.run.pattern.label}")
        written.append(path)
    if wanted.plot:
        with shown(f"{name}: drawing", quiet=quiet):
            written.append(RunPicture(made=made, one=one).draw(FOLDER))
    if wanted.animate:
        from validation.report.scenes.turntable import animate

        with shown(f"{name}: drawing the passage of a resonance", quiet=quiet):
            moving = animate(made, one, FOLDER)
        if moving is None:
            click.echo(f"massline: {name}: no resonance was passed, and nothing is animated.", err=True)
        else:
            written.append(moving)
    return written


# The answer of `massline simulate`: a virtual test written to disk, shown as `massline check` would, and unless it is sealed what
# lies behind it.


@dataclass(frozen=True, eq=False, kw_only=True)
class Written:
    """A virtual test that was written: as its file states it, where it lies and its truth, and whether it replaced another.

    `planted` are the effects that act in this campaign; in a series, others may act elsewhere.
    """

    plan: Plan
    campaign: Campaign
    test: VirtualTest
    folder: Path
    truth: Path
    replaced: bool
    sealed: bool
    planted: tuple[Any, ...]

    def text(self) -> str:
        """The page, of one screen: `massline check` has channels and levels."""
        found = of_campaign(self.folder, self.campaign)
        runs = [grid for grid in campaign_page.grids(found) if grid.header[0] == "run"]
        more = f"{len(self.campaign.table)} channels, their levels and what they tell: massline check {self.folder}."
        grids = (*runs, *(() if self.sealed else self._behind()))
        return page(campaign_page.title(found), grids, (more, *self._notes()))

    def as_json(self) -> dict[str, Any]:
        """The same as one object; where it is sealed, nothing that was drawn or planted."""
        found = {**to_json(of_campaign(self.folder, self.campaign)), "truth": str(self.truth)}
        if self.sealed:
            return found
        effects = [
            {"id": one.id, "value": one.value if set(one.values) <= {""} else dict(one.values), "unit": one.unit}
            for one in self.planted
        ]
        return found | {"seed": self.plan.seed, "effects": effects}

    def _behind(self) -> Iterator[Grid]:
        """What was planted; mass, CoG and moments about it of FMD and article as they are, in their own frames."""
        if self.planted:
            lines = tuple((one.id, str(one).partition("=")[2] or NONE, one.unit or NONE, one.what) for one in self.planted)
            yield Grid(header=("planted", "value", "unit", "what"), lines=lines, words=True)
        truth: Any = self.test.truth
        bodies = {"FMD, from F": truth["fmd"]}
        if truth["article"] is not None:
            bodies[f"{self.plan.on_fmd}, own frame"] = truth["article"]["own_frame"]
        header = ("truth", "m [kg]", *(f"{axis} of CoG [mm]" for axis in "xyz"), *(f"I{axis}{axis} [kg m²]" for axis in "xyz"))
        keys = ("mass_kg", "cog_mm", "moi_cog_kgm2")
        figures = [[fixed(value, 4) for key in keys for value in np.ravel(body[key])] for body in bodies.values()]
        columns = [aligned(column) for column in zip(*figures, strict=True)]
        yield Grid(header=header, lines=tuple(zip(bodies, *columns, strict=True)))

    def _notes(self) -> Iterator[str]:
        if self.sealed:
            yield f"Sealed: what was drawn and planted stands in {self.truth} alone."
            return
        yield f"Drawn from seed {self.plan.seed}: tests of the same seed share FMD, load cells and sensors, and so their errors."
        modes: Any = self.test.truth["modes"]
        if modes["frequency_hz"]:
            listed = ", ".join(f"{f:.2f}" for f in modes["frequency_hz"] if f <= 1.5 * self.plan.band[1])
            yield f"Modes of {self.plan.on_fmd} on a rigid base: {listed} Hz." if listed else "No mode lies near the band."
        yield f"Every figure that was drawn stands in {self.truth}, by the ids of the catalogue."


def simulate(question: SimulateOptions, *, as_json: bool) -> None:
    """Answer `question`, campaign by campaign; what is finished stays when a later one is interrupted.

    Raises
    ------
    BadInput : a folder or a truth that cannot be written or would destroy what is there, or what the plans cannot be.
    CheckFailed : something on the table swings freely.
    """
    virtual_test.require_folder(question.out)
    require_folder(question.out, "--out")
    if question.sealed is not None:
        (require_file if len(question.plans) == 1 else require_folder)(question.sealed, "--sealed")
    for plan in question.plans:
        virtual_test.require_free(question.folder(plan), question.truth(plan))
    done = []
    for number, plan in enumerate(question.plans, start=1):
        one = _written_test(question, plan, f"{plan.article} ({number} of {len(question.plans)})", quiet=as_json)
        done.append(one)
        if not as_json:
            click.echo(one.text(), nl=False)
    if as_json:
        print_json({"campaigns": [one.as_json() for one in done]})
    for one in done:
        instead = " in place of the virtual test that was there" if one.replaced else ""
        click.echo(f"massline: wrote {one.folder} and its truth {one.truth}{instead}.", err=True)


def simulate_structure(
    path: str,
    out: Path,
    *,
    as_json: bool,
    kind: str | None,
    effects: Sequence[str],
    seed: int,
    sealed: Path | None,
    noise: str,
    tolerances: str,
    band: tuple[float, float] | None,
    drives: Sequence[str],
    responses: Sequence[str],
    block: float | None,
    axis: str,
    cross: float | None,
) -> None:
    """Answer `massline simulate MODEL.toml`.

    Raises
    ------
    BadInput : a folder that cannot be written or would destroy what is there, a model without a structure, an option that cannot
        be.
    """
    virtual_test.require_folder(out)
    require_folder(out, "--out")
    truth = sealed or out.parent / f"{out.name}.truth.json"
    if sealed is not None:
        require_file(sealed, "--sealed")
    virtual_test.require_free(out, truth)
    if block is not None and not 0 < block < 1e4:
        raise BadInput("--block", "", f"must be a time in seconds, found {block:g}", "Write --block 4")
    plan = structure_tests.plan_of(
        path,
        kind=kind or HAMMER,
        effects=effects,
        seed=seed,
        noise=virtual_test.factor("--noise", noise),
        tolerances=virtual_test.factor("--tolerances", tolerances),
        band=band,
        drives=drives,
        responses=responses,
        block=block or 0.0,
        axis=axis,
        cross=cross,
    )
    for doubt in plan.doubts:
        click.echo(f"massline: {doubt}.", err=True)
    with shown(f"{plan.article}: simulating and writing {out}", quiet=as_json):
        made = structure_tests.simulate(plan)
        if made.campaign is not None:
            _require_alive(made.campaign)
        virtual_test.write(out, truth, made.truth, made.fill)
    test = out if plan.on_base else out / "test.toml"
    about: dict[str, Any] = {
        "test": str(test),
        "truth": str(truth),
        "kind": plan.kind,
        "article": plan.article,
        "drives": [] if plan.kind == MODES else [one.name for one in plan.drives],
        "responses": [one.name for one in plan.responses],
        "band_hz": [float(f"{one:.6g}") for one in plan.band] if not as_json else list(plan.band),
    }
    if sealed is None:
        about |= {"seed": seed, "effects": [str(one) for one in plan.effects]}
    if as_json:
        print_json(about)
    else:
        rows = [(key, ", ".join(map(str, value)) if isinstance(value, list) else str(value)) for key, value in about.items()]
        click.echo("\n".join(f"{key:10} {value or 'none'}" for key, value in rows))
    click.echo(f"massline: wrote {out} and its truth {truth}. `massline compare {path} {test}` reads it.", err=True)


def _require_alive(campaign: Campaign) -> None:
    """Refuse records that no reader would take: without noise, what nothing moves stays at zero."""
    for run, recorded in campaign.recordings.items():
        for k, name in enumerate(recorded.names):
            try:
                require_alive(recorded.values[:, k], name, run)
            except BadInput:
                problem = f"without noise, hum and cross motion nothing moves {name} in the run {run}: it reads zero throughout"
                remedy = "A dead channel makes a campaign unusable: leave some noise (--noise 0.001) or cross motion"
                raise BadInput("--noise", "", problem, remedy) from None


def _written_test(question: SimulateOptions, plan: Plan, words: str, *, quiet: bool) -> Written:
    with share_done(f"{words}: simulating", quiet=quiet) as progress:
        try:
            test = virtual_test.simulate(plan, progress)
        except BadInput as error:
            if error.source != "rig":
                raise
            # A rig that cannot be built, which only an effect can have done
            raise BadInput("--effect", error.field, error.problem, error.remedy) from None
    _require_alive(test.campaign)
    table, units = test.campaign.table, question.units
    in_units = tuple(replace(channel, unit=units.get(channel.quantity, channel.unit)) for channel in table.channels)
    campaign = replace(test.campaign, table=replace(table, channels=in_units))
    folder, truth = question.folder(plan), question.truth(plan)
    replaced = folder.exists() and any(folder.iterdir())
    with shown(f"{words}: writing {folder}", quiet=quiet):
        virtual_test.write(folder, truth, test.truth, lambda new: campaign_file.write(new, campaign, ending=question.ending))
    acting = {effect.id for effect in plan.effects}
    return Written(
        plan=plan,
        campaign=replace(campaign, source=str(folder)),
        test=test,
        folder=folder,
        truth=truth,
        replaced=replaced,
        sealed=question.sealed is not None,
        planted=tuple(one for one in question.effects if one.id in acting),
    )


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

    def percent_of(share: float) -> str:
        return f"{100 * share:+.4f}"

    record, setup = found.record, found.record.setup
    small, ideal = record.swing.small_period, setup.ideal_period
    periods = [
        ("by Eq. 5 from the inertia", f"{ideal:.6f}", ""),
        ("small swings, by statics", f"{small:.6f}", percent_of(small / ideal - 1)),
        (f"recorded, {record.decay.cycles:.1f} cycles", f"{record.period:.6f}", percent_of(record.shift)),
    ]
    links = setup.suspension.links
    shifts = [(s.name, *map(percent_of, (s.period, s.plain, s.corrected)), WHY[s.name].format(links=links)) for s in found.shifts]
    shifts.append(("all together", *map(percent_of, (record.shift, found.plain, found.corrected)), "the record"))
    inertias = [
        (name, f"{value:.6g}", percent_of(value / setup.reference - 1))
        for name, value in (
            ("simulated body", setup.reference),
            ("Eq. 5 alone", record.plain),
            ("with corrections", record.corrected),
        )
    ]
    heads = ("effect alone", "period [%]", "inertia by Eq. 5 [%]", "corrected [%]", "what the reduction does")
    tables = (
        (("period", "T [s]", "from Eq. 5 [%]"), periods),
        (heads, shifts),
        (("moment of inertia", f"Θ{2 * setup.axis} [kg m²]", "error [%]"), inertias),
    )
    blocks = [
        Table(rows=rows, columns=[Column(head, itemgetter(k), words=k == 4) for k, head in enumerate(header)])
        for header, rows in tables
    ]
    title = f"{setup.article} on {setup.suspension.ropes} ropes, axis {setup.axis} upright: simulated by exudyn"
    return Document(title=title, blocks=blocks, notes=report_notes(found)).text()


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
