"""The pictures of `massline compare`: what each of them shows, from the comparison."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from geometry.atomic import write_text
from geometry.dynamic_mass import SIGNS, DynamicMass
from validation.compare.compare import Comparison, compared, run, text, worst_pairs
from validation.compare.correlation import FunctionCorrelation, ModalCorrelation, NamedMode
from validation.compare.maps import Map
from validation.effects.practical_units import written_as
from validation.estimation.verdicts import ABSURD, STANDS_OUT, StatedError, Tolerance, absurd, misfit
from validation.output import NONE, print_answer, shown, significant, stages, to_json, two_digits, with_unit, wrote
from validation.reference.reference import file_name
from validation.report import document as doc
from validation.report.charts import crosscheck, maps, spec
from validation.report.charts.style import DynamicMassCurve, chosen
from validation.report.parts import Report, picture, section, verdict
from validation.report.parts import notes as parts_notes
from validation.study import Options, Study, read

# The page of `massline compare`: four errors, the worst spots in words, runs and configurations, pairs of axes,
# tolerances, facts.


COMPARISON_PAIRS = 5

CHANCE = 3
"""Spots that are shown where none stands out."""


def document(found: Comparison) -> doc.Document:
    """What is said of a comparison, in the order in which it is read."""
    from validation.report.charts.crosscheck import four_errors

    both, page = zip(found.maps, found.modes, strict=True), ComparisonPage(found=found)
    return doc.Document(
        title=f"{found.title} beside {', '.join(found.data_sets)}",
        blocks=(
            errors(found),
            doc.Drawn(lambda: four_errors(found)),
            page.spots(),
            *(partial(_maps, of, modes, k) for k, (of, modes) in enumerate(both)),
            parts_notes([SCALE if any(of.has_lines for of in found.maps) else CHANCES]),
            page.runs(),
            page.misfits(),
            page.entries(),
            page.tolerances(),
            page.facts(),
            *correlation_tables(found.correlation),
        ),
        notes=tuple(page.notes()),
    )


ErrorRow = tuple[str, float | None, str, StatedError | None]
"""Name, size and unit of an error, and what is to be thought of it."""


def error_rows(found: Comparison) -> list[ErrorRow]:
    """The four errors; a figure that is new beside them is one more row."""
    of, (nominal, plain, fitted, held) = found.evaluation, found.errors
    return [
        (nominal.name, of.nominal.percent, "%", nominal),
        (plain.name, of.plain.percent, "%", plain),
        ("fitted error, χ² per degree of freedom", misfit(of.fitted), "1", fitted),
        ("its prior penalty, the sum of z² of the tolerances", of.fitted.tolerance_z2, "1", None),
        (held.name, None if of.held_out is None else of.held_out.percent, "%", held),
    ]


PRICE = 3
"""Row of the prior penalty, which a terminal and the panel have in the row above it."""


def errors(found: Comparison) -> doc.Table:
    """The four errors: figure, meaning, verdict."""
    rows = error_rows(found)
    said = "what it means, and what is to be thought of it"

    def thought(row: ErrorRow, judged: bool = False) -> str:
        one = row[3]
        if one is None or not one.text:
            return "" if one is None else one.meaning
        verdict = f"{one.verdict.upper()}: " if judged and one.verdict else ""
        text = one.text if verdict or one.text.startswith("χ") else f"{one.text[:1].upper()}{one.text[1:]}"
        return f"{one.meaning}. {verdict}{text}"

    return doc.Table(
        caption="The four errors",
        rows=rows,
        shown=[*rows[:PRICE], *rows[PRICE + 1 :]],
        columns=(
            doc.Column("error", lambda row: row[0], words=True, on=doc.PAGE),
            doc.Column("", lambda row: _of(row, "name") or row[0], words=True, panel="name", on=doc.TERMINAL),
            doc.Column(
                "error",
                lambda row: _of(row, "figure") or f"{row[1]:.3g} {row[2]}",
                panel="figure",
                aligned=False,
                on=doc.TERMINAL,
            ),
            doc.Column("size", lambda row: row[1], on=doc.PAGE),
            doc.Column("unit", lambda row: row[2], words=True, on=doc.PAGE),
            doc.Column("verdict", lambda row: verdict(_of(row, "verdict")), words=True, on=doc.PAGE),
            doc.Column(said, thought, words=True, on=doc.PAGE),
            doc.Column(said, partial(thought, judged=True), words=True, on=doc.TERMINAL),
            doc.Column("", lambda row: _of(row, "meaning"), panel="meaning", on=doc.PANEL),
            doc.Column("", lambda row: _of(row, "verdict") or None, panel="verdict", on=doc.PANEL),
            doc.Column("", lambda row: _of(row, "text"), panel="text", on=doc.PANEL),
        ),
    )


def _of(row: ErrorRow, name: str) -> str:
    return "" if row[3] is None else str(getattr(row[3], name))


@dataclass(frozen=True, eq=False, kw_only=True)
class ComparisonPage:
    """What a page says of the comparison that was `found`, table by table."""

    found: Comparison

    def spots(self) -> doc.Table:
        """The worst spots in words: those that stand out, or else the worst three, as chance leaves them."""
        rows = list(enumerate(self.found.worst, start=1))
        rows = [row for row in rows if row[1].sigma >= STANDS_OUT] or rows[:CHANCE]
        return doc.Table(
            caption="The worst spots",
            rows=rows,
            columns=(
                doc.Column("", lambda row: f"{row[0]}", words=True, on=doc.PAGE),
                doc.Column("", lambda row: f"{row[0]:>2}", words=True, on=doc.TERMINAL),
                doc.Column("deviation", lambda row: row[1].sigma, ".3g", unit="σ", said=("sigma", two_digits), aligned=False),
                doc.Column("of the reading", lambda row: row[1].percent, partial(significant, digits=3), unit="%", on=doc.PAGE),
                doc.Column("at", lambda row: row[1].frequency, ".2f", unit="Hz", on=doc.PAGE),
                doc.Column("in words", lambda row: text(row[1], len(self.found.maps)), words=True, said="where it fails"),
            ),
        )

    def runs(self) -> doc.Table:
        """Every run of every campaign."""
        by_run = self.found.evaluation.plain.by_run
        return doc.Table(
            caption="Runs",
            rows=[(of, k, name) for of in self.found.maps for k, name in enumerate(of.runs)],
            columns=(
                doc.Column("run", lambda row: row[2], words=True),
                doc.Column("campaign", lambda row: row[0].data_set, words=True),
                doc.Column("plain error", lambda row: by_run.get(f"{row[0].data_set}/{row[2]}"), ".3g", unit="%"),
                doc.Column(
                    "χ² per degree of freedom", lambda row: float(row[0].misfit[row[1]].mean()), partial(significant, digits=3)
                ),
                doc.Column("worst cell", lambda row: float(row[0].sigma[row[1]].max()), ".3g", unit="σ"),
            ),
            on=doc.PAGE,
        )

    def misfits(self) -> doc.Table:
        """Chi² per degree of freedom of every run of every data set, tolerances counted."""

        def misfit_of(name: str) -> doc.Column:
            return doc.Column(name, lambda row: two_digits(row[1][name]) if name in row[1] else NONE)

        names = dict.fromkeys(name for one in self.found.maps for name in one.runs)
        rows = [(one.data_set, dict(zip(one.runs, map(float, one.misfit.mean(axis=1)), strict=True))) for one in self.found.maps]
        return doc.Table(
            columns=[doc.Column("chi² by run", lambda row: row[0], words=True), *map(misfit_of, names)],
            rows=rows,
            on=doc.TERMINAL,
        )

    def entries(self) -> doc.Table:
        """The pairs of axes in which predicted and measured dynamic mass differ most."""
        return doc.Table(
            columns=(
                doc.Column("dynamic mass", lambda one: f"H {SIGNS[one.load]}{SIGNS[one.motion]} of {one.data_set}", words=True),
                doc.Column("sigma", lambda one: two_digits(one.sigma)),
                doc.Column("of it", lambda one: f"{two_digits(one.percent)} %"),
                doc.Column("at [Hz]", lambda one: one.frequency, ".2f"),
            ),
            rows=worst_pairs(self.found.maps, COMPARISON_PAIRS),
            on=doc.TERMINAL,
        )

    def tolerances(self) -> doc.Table:
        """The tolerances that a fit of everything moved farthest; on a terminal where they are absurd, the most absurd."""
        worst = [one for one in self.found.absurd if abs(one.z) >= min(ABSURD, abs(self.found.absurd[0].z))]
        return doc.Table(
            caption="Tolerances that the fit of everything moved farthest",
            rows=self.found.absurd,
            shown=worst if absurd(self.found.evaluation.fitted) else (),
            columns=(
                doc.Column("tolerance", lambda one: one.parameter.name, words=True, said="moved too far"),
                doc.Column("moved by", lambda one: one.z, "+.2f", unit="z", said=("z", "+.1f")),
                doc.Column("moved by", lambda one: moved(one)[0], on=doc.PAGE),
                doc.Column("moved by", lambda one: with_unit(*moved(one)), on=doc.TERMINAL),
                doc.Column("unit", lambda one: moved(one)[1], words=True, on=doc.PAGE),
            ),
            note="One standard deviation of what was known beforehand is 1 z. Beyond 4 no careful laboratory has it.",
        )

    def facts(self) -> doc.Table:
        """Classical measurements, predicted minus measured."""
        return doc.Table(
            caption="Classical measurements beside the model",
            rows=self.found.facts,
            columns=(
                doc.Column("classical measurement", lambda one: one.name, words=True, on=doc.PAGE),
                doc.Column("classical measurements", lambda one: f"{one.name} [{one.unit}]", words=True, on=doc.TERMINAL),
                doc.Column("unit", lambda one: one.unit, words=True, on=doc.PAGE),
                doc.Column("measured", lambda one: doc.toleranced(one.measured, one.tolerance)),
                doc.Column("standard deviation", lambda one: doc.toleranced(one.tolerance, one.tolerance), said="sd"),
                doc.Column("predicted", lambda one: doc.toleranced(one.predicted, one.tolerance)),
                doc.Column("deviation", lambda one: one.sigma, "+.2f", unit="σ", said=("sigma", "+.1f")),
                doc.Column("nothing fitted", lambda one: one.nominal_sigma, "+.2f", unit="σ", said=("nominal", "+.1f")),
            ),
        )

    def notes(self) -> Iterator[str]:
        """What must be known to read the tables, then what was assumed."""
        first = self.found.worst[0].sigma if self.found.worst else 0.0
        if first < STANDS_OUT:
            # Of n complex cells of noise alone the worst reaches (ln n + 0.577)^½ in the mean (Gumbel)
            cells = sum(one.deviation.size for one in self.found.maps)
            among = f"{np.sqrt(np.log(cells) + np.euler_gamma):.1f} among {cells} cells" if first > STANDS_OUT - 1 else "3"
            yield f"Nothing stands out: the worst spot is {two_digits(first)} sigma, and chance reaches about {among}."
        elif below := sum(one.sigma < STANDS_OUT for one in self.found.worst):
            yield f"{below} more of the ten worst spots are below {STANDS_OUT:g} sigma, as chance leaves them."
        yield (
            "Sigma: what the plain fit leaves, in standard deviations of noise, a model error of 0.15 % and the tolerances that "
            "were not fitted. A channel is held against what all other channels and the model say of it."
        )
        # Modes within the band by name
        for of, modes in zip(self.found.maps, self.found.modes, strict=True):
            within = [one for one in modes if of.frequency[0] <= one.frequency <= of.frequency[-1]]
            if inside := [f"{one.name} {one.frequency:.2f} Hz" for one in within]:
                yield f"Modes of {of.data_set} at the plain fit: {_some(inside, 8)}."
        if self.found.evaluation.held_out_names:
            yield f"Used only for checking (held out): {_some(self.found.evaluation.held_out_names)}."
        if self.found.effects:
            yield f"Effects in the model: {', '.join(self.found.effects)}."
        yield from (f"warning: {text}." for text in self.found.remarks)


def moved(one: Tolerance) -> tuple[str, str]:
    """By how much a fit moved a tolerance, and the unit: of a factor by what share."""
    (text,), unit = written_as(one.parameter.unit, (one.moved,))
    return text.replace("-", "−"), unit


def correlation_tables(correlation: Sequence[ModalCorrelation | FunctionCorrelation]) -> tuple[doc.Table, doc.Table]:
    """What analysts deliver of tests of structures: modes of tables, or resonances that functions show, beside their partners in
    the model as it is; and response functions beside those of it."""
    rows = [(one.data_set, pair) for one in correlation if isinstance(one, ModalCorrelation) for pair in one.pairs]
    modes = doc.Table(
        caption="Modes and resonances beside the model as it is",
        rows=rows,
        columns=(
            doc.Column("mode", lambda row: row[1].measured, words=True),
            doc.Column("measured", lambda row: row[1].measured_hz, ".4g", unit="Hz"),
            doc.Column("model", lambda row: row[1].model_hz, ".4g", unit="Hz"),
            doc.Column("too high", lambda row: row[1].percent, "+.2f", unit="%"),
            doc.Column("deviation", lambda row: row[1].sigmas, "+.1f", unit="σ", on=doc.PAGE),
            doc.Column("MAC", lambda row: row[1].mac, ".3f"),
            doc.Column("of", lambda row: row[0], words=True, on=doc.PAGE),
        ),
    )
    every = [one for one in correlation if isinstance(one, FunctionCorrelation)]
    functions = doc.Table(
        caption="Response functions beside the model as it is",
        rows=[(one.data_set, name, one.frac[name], one.ratio[name]) for one in every for name in one.frac],
        columns=(
            doc.Column("function", lambda row: row[1], words=True),
            doc.Column("FRAC", lambda row: row[2], ".3f"),
            doc.Column("level", lambda row: row[3] if abs(row[3]) < SILENT else None, "+.1f", unit="dB"),
            doc.Column("of", lambda row: row[0], words=True, on=doc.PAGE),
        ),
    )
    return modes, functions


def _some(names: tuple[str, ...] | list[str], most: int = 4) -> str:
    more = len(names) - most
    return ", ".join(names) if more <= 0 else f"{', '.join(names[:most])} and {more} more"


SILENT = 150.0
"""[dB] from which a function is that of nothing, in the model or in the data. By definition."""

PAIRS = 6

NOTE = "What the plain fit leaves, in standard deviations of noise, a model error of 0.15 % and the tolerances not fitted. "
THRESHOLD = f"Beyond {spec.CHANCE:g} (black bar of the scale) it is no chance. Triangles: modes of the model."


def draw(found: Comparison, folder: Path) -> tuple[Path, ...]:
    """Write every picture that `found` has the evidence for into `folder`, and say where they are."""
    made: list[Path] = []

    def to(name: str) -> Path:
        made.append(folder / f"{file_name(f'compare-{name}')}.png")
        return made[-1]

    crosscheck.draw_errors(crosscheck.errors_of(found), to("errors"))
    columns = tuple(dict.fromkeys(name for of in found.maps for name in of.runs))
    sigma = np.full((len(found.maps), len(columns)), np.nan)
    percent = sigma.copy()
    for a, of in enumerate(found.maps):
        for k, name in enumerate(of.runs):
            at = (a, columns.index(name))
            sigma[at] = of.sigma[k].max()
            percent[at] = found.evaluation.plain.by_run.get(f"{of.data_set}/{name}", np.nan)
    note = "The worst cell of each run in sigmas, and its plain error in per cent."
    maps.draw_runs(f"{found.title}: runs", found.data_sets, columns, sigma, percent, to("runs"), note)
    for of, modes in zip(found.maps, found.modes, strict=True):
        draw_channels(of, modes, to(f"{of.data_set}-channels"))
        if of.pairs is not None:
            note = f"Predicted beside measured, about F; sigma as in the maps of the channels. {THRESHOLD}"
            maps.draw_pairs(of.pairs, modes, to(f"{of.data_set}-pairs"), note)
    known = {of.data_set: (of.pairs, modes) for of, modes in zip(found.maps, found.modes, strict=True) if of.pairs is not None}
    panels = []
    for pair in worst_pairs(found.maps, PAIRS) if known else ():
        pairs, modes = known[pair.data_set]
        curves = tuple(
            DynamicMassCurve(
                name=name,
                mass=DynamicMass(frequency=pairs.frequency, matrix=matrix),
                rigid=np.zeros((6, 6)),
                marked=np.array([one.frequency for one in modes]),
                effective_mass=np.full((len(modes), 6), np.inf),
                dots=dots,
            )
            for matrix, name, dots in ((pairs.predicted, "predicted", ""), (pairs.measured, "measured", spec.MEASURED))
        )
        heading = f"{pair.data_set}, {pair.sigma:.0f} σ at {pair.frequency:.1f} Hz"
        panels.append((heading, pair.load, pair.motion, curves))
    if known:
        note = "Blocked, about F: the pairs of axes that differ most. Dots: Eqs. 9 to 11. Line: model, plain fit, made likewise."
        chosen(f"{found.title}: predicted beside measured", panels, to("dynamic-mass"), note)
    return tuple(made)


def draw_channels(of: Map, modes: Sequence[NamedMode], path: Path) -> None:
    """Write the map of channels and loads over frequency, a panel a run."""
    maps.draw_channels(of, modes, path, NOTE + THRESHOLD)


# `massline compare` from options to output: read, fit, map, show.


RESULT = "compare.json"
"""The file of a comparison in its folder."""


def answer(asked: Options, *, as_json: bool, folder: Path | None) -> None:
    """Compare what is `asked`, print it, and write JSON and pictures into `folder` (None: nowhere).

    Raises
    ------
    BadInput : something that was asked cannot be used.
    CheckFailed : a fit that does not converge.
    """
    with stages("reading", quiet=as_json) as told:
        model, data = read(asked, told)
    with stages("comparing", quiet=as_json) as told:
        found = compared(Study.of(model, data, asked, told), told)
    file = None if folder is None else folder / RESULT
    print_answer(lambda: to_json(found), lambda: document(found).text(), as_json=as_json, file=file)
    if folder is not None:
        for one in found.correlation:
            for name, rows in one.tables().items():
                path = folder / f"{file_name(f'compare-{one.data_set}-{name}')}.csv"
                write_text(path, rows)
                wrote(path)
        with shown("pictures", quiet=as_json):
            paths = draw(found, folder)
        wrote(*paths)


# Condition number of Eqs. 9 to 11, campaign by campaign.


def html(report: Report, figures: doc.Figures) -> doc.Safe:
    """The section; empty where no line has a condition number."""
    from validation.report.charts.identification import condition

    parts: list[doc.Safe] = []
    for one in report.campaigns:
        lines, name = None if one.findings is None else one.findings.lines, one.campaign.source
        if lines is None:
            continue
        worst, used = int(np.argmax(lines.condition)), int(np.sum(np.asarray(lines.kept) > 0))
        told = (
            f"{name}: at most {lines.condition[worst]:.3g}, at {lines.frequency[worst]:.4g} Hz; {used} of "
            f" {len(lines.frequency)} lines are used. Base motions of all runs, every axis divided by its nominal level"
        )
        parts += [figures.placed(condition(lines, name)), parts_notes([told, *lines.reasons])]
    return section("condition", "Condition number of Eqs. 9 to 11", *parts) if parts else doc.Safe("")


# Measured beside predicted dynamic mass: the six diagonals of every campaign, and any other entry by choice.


DYNAMIC_MASS_PAIRS = 10
"""Worst pairs that are listed."""

DYNAMIC_MASS_NOTE = (
    "Blocked dynamic mass of all that stands on the load cells, about F. Dots: measured, Eqs. 9 to 11. Line: the model at the "
    "plain fit, its channels put through the same equations. Band: two standard deviations, the σ of the maps, of the complex "
    "difference that noise and tolerances which were not fitted explain. Phase of an entry that is next to nothing means nothing"
)


def dynamic_mass_html(report: Report, figures: doc.Figures) -> doc.Safe:
    """The section; empty where no dynamic mass was measured."""
    from validation.report.charts.maps import LOADS, MOTIONS, diagonal, entry, overlay

    found = report.comparison
    both = [(of.pairs, modes) for of, modes in zip(found.maps, found.modes, strict=True) if of.pairs is not None]
    if not both:
        return doc.Safe("")
    worst = worst_pairs(found.maps, 36 * len(both))
    listed = doc.Table(
        caption="The entries that differ most",
        rows=worst[:DYNAMIC_MASS_PAIRS],
        columns=(
            doc.Column("entry", lambda one: entry(one.load, one.motion), words=True),
            doc.Column("campaign", lambda one: one.data_set, words=True),
            doc.Column("load", lambda one: LOADS[one.load], words=True),
            doc.Column("base motion", lambda one: MOTIONS[one.motion], words=True),
            doc.Column("at", lambda one: one.frequency, ".2f", unit="Hz"),
            doc.Column("deviation", lambda one: one.sigma, ".3g", unit="σ"),
            doc.Column("of the dynamic mass", lambda one: one.percent, ".3g", unit="%"),
        ),
    )
    parts = []
    for k, (pairs, modes) in enumerate(both):
        group, first = f"entry-{k}", next(one for one in worst if one.data_set == pairs.campaign)
        every = {f"{i}-{j}": overlay(pairs, i, j, modes=modes) for i in range(6) for j in range(6)}
        figures.choices(group, every)
        key = f"{first.load}-{first.motion}"
        part = doc.tag(
            "div",
            doc.tag("h3", pairs.campaign),
            figures.placed(diagonal(pairs, modes=modes)),
            doc.tag("h4", "Any entry", class_="screen-only"),
            doc.tag(
                "div",
                _select("load", "load", LOADS, group, first.load),
                _select("base motion", "motion", MOTIONS, group, first.motion),
                class_="choice screen-only",
            ),
            figures.placed(every[key], screen_only=True, group=group, shown=key),
            class_="part",
        )
        parts.append(part)
    title = "Dynamic mass, measured and predicted"
    return section("dynamic-mass", title, parts_notes([DYNAMIC_MASS_NOTE]), listed.html(), *parts)


FUNCTIONS_NOTE = (
    "Dots: measured. Line: the model at the plain fit. Band: two standard deviations of what noise, the model's own error and "
    "tolerances which were not fitted explain"
)

FUNCTIONS_SHOWN = 6
"""Response functions of a test that a report shows: a sheet of paper."""


def functions_html(report: Report, figures: doc.Figures) -> doc.Safe:
    """The response functions that differ most, measured and predicted; empty where none were measured."""
    from validation.report.charts.maps import function_of, side_by_side

    parts = []
    for of, modes in zip(report.comparison.maps, report.comparison.modes, strict=True):
        if (whole := of.functions) is None:
            continue
        apart = np.linalg.norm((whole.measured - whole.predicted) / whole.expected, axis=1)  # (r, c)
        every = sorted(np.ndindex(apart.shape), key=lambda at: -apart[at])[:FUNCTIONS_SHOWN]
        unit = whole.unit.replace("^2", "²")
        marks = [(one.name, one.frequency) for one in modes if of.frequency[0] <= one.frequency <= of.frequency[-1]]
        panels = [
            (f"{of.rows[k]} by {of.runs[run]}", replace(function_of(of, run, k, {}), unit=unit, modes=marks))
            for run, k in sorted(every)
        ]
        many = "" if apart.size <= len(every) else f", of {apart.size} the {len(every)} that differ most"
        figure = side_by_side(panels, f"{of.data_set}: response by force{many}")
        parts.append(doc.tag("div", doc.tag("h3", of.data_set), figures.placed(figure), class_="part"))
    title = "Response functions, measured and predicted"
    return section("functions", title, parts_notes([FUNCTIONS_NOTE]), *parts) if parts else doc.Safe("")


def _select(what: str, part: str, names: Sequence[str], group: str, chosen: int) -> doc.Safe:

    options = [
        doc.tag("option", f"{sign}: {name}", value=str(k), selected=k == chosen)
        for k, (sign, name) in enumerate(zip(SIGNS, names, strict=True))
    ]
    return doc.tag("label", f"{what} ", doc.tag("select", *options, data_choice=group, data_part=part))


# The sensors of every campaign on a map.


def sensors_html(report: Report, figures: doc.Figures) -> doc.Safe:
    """The section; empty where nothing could be drawn."""
    parts = [
        doc.tag("div", doc.tag("h3", f"{one.campaign.title} ({one.campaign.source})"), picture(one.sensors), class_="part")
        for one in report.campaigns
        if one.sensors is not None
    ]
    return section("sensors", "Sensors", *parts) if parts else doc.Safe("")


# Where the model fails: four errors, the worst spots in words, maps in sigmas, runs, classical measurements.


CHANCES = "Pale: what chance reaches. From 4 sigma on it is no chance. Empty: nothing checks the row"
SCALE = f"{CHANCES}. Triangles: modes of the model"
"""Of a table of modes, and of lines."""


def where_html(report: Report, figures: doc.Figures) -> doc.Safe:
    """The section."""
    found = document(report.comparison)
    return section("where", "Where it fails", *found.html(figures), parts_notes(found.notes))


def _maps(of: Map, modes: Sequence[NamedMode], k: int, figures: doc.Figures) -> doc.Safe:
    from validation.report.charts.maps import channel_map, pair_map

    if np.max(of.sigma, initial=0.0) < 1:  # all white
        return doc.tag("p", f"No map of {of.data_set}: nothing in it reaches 1 sigma.", class_="note")
    group = f"map-{k}"
    every = {"worst": channel_map(of, modes=modes)}
    every |= {str(at): channel_map(of, at, modes=modes) for at in range(len(of.runs))}
    figures.choices(group, every)
    pairs = figures.placed(pair_map(of.pairs, modes=modes)) if of.pairs is not None else None
    options = [doc.tag("option", "the worst of all runs", value="worst", selected=True)]
    options += [
        doc.tag("option", run(name, axis), value=str(j)) for j, (name, axis) in enumerate(zip(of.runs, of.axes, strict=True))
    ]
    choice = doc.tag("label", "run ", doc.tag("select", *options, data_choice=group, data_part="run"))
    return doc.tag(
        "div",
        doc.tag("h3", f"Map of {of.data_set}"),
        doc.tag("div", choice, class_="choice screen-only"),
        figures.placed(every["worst"], group=group, shown="worst"),
        pairs,
        class_="part",
    )
