"""The page: one file of HTML that needs nothing else, neither a network nor a folder beside it."""

import json
import math
import os
import shlex
import shutil
import subprocess
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as version_of
from importlib.resources import files
from pathlib import Path
from platform import platform, python_version
from tempfile import TemporaryDirectory
from typing import Any

from geometry.atomic import write_text, write_with
from geometry.errors import BadInput, CheckFailed
from geometry.toml_file import files_named
from identification.campaign import METHODS
from validation import study as validation_study
from validation.classical.files import read
from validation.compare.compare import Comparison, compared, text
from validation.diagnose import diagnose, diagnosis
from validation.diagnose.diagnose import require_runs
from validation.diagnose.diagnosis import Diagnosis
from validation.effects.catalogue import SOURCES
from validation.estimation.verdicts import DOUBTFUL, FAILED, GOOD, STANDS_OUT
from validation.history.history import Body, HistoryPosition, Source, digest, history_position
from validation.identify.request import REDUCED
from validation.model.model import Model
from validation.model.setups import FMD, above_fmd
from validation.output import percent, require_ending, require_file, rounded, stages, to_json, wrote
from validation.prediction.modal_table import FREQUENCY
from validation.reference.reference import file_name
from validation.reference.statement import QUANTITIES
from validation.report import compare, flexible, history, identify, reference
from validation.report import diagnose as report_diagnose
from validation.report.document import Column, Figures, Safe, joined, plus_minus, table, tag, worded
from validation.report.identify import campaign_part
from validation.report.parts import ArticlePart, CampaignPart, Provenance, Report, head_html, requirements_html, section, verdict
from validation.report.reference import article_part
from validation.study import Data, Options, Progress, Study

# Where everything comes from: versions, settings, inputs with their digests, the model, and the command line.


SEEDS = "none: the same data give the same answer (of a simulated campaign the seed stands in its own description)"
"""Of the random numbers behind figures of this page."""


def provenance_html(report: Report, figures: Figures) -> Safe:
    """The section."""
    made = report.provenance
    asks = {"spectra": bool(report.campaigns), "band [Hz]": any(one.has_lines for one in report.comparison.maps)}
    settings = {"random numbers": SEEDS, **{key: value for key, value in made.settings.items() if asks.get(key, True)}}
    asked = {} if report.diagnosis is None else report.diagnosis.settings
    numbers = {key: _text(value) for key, value in asked.items() if key != "random_numbers"}
    return section(
        "provenance",
        "Provenance",
        tag("p", "Command line: ", tag("code", made.command)) if made.command else None,
        tag("p", "Versions: ", ", ".join(f"{name} {version}" for name, version in made.versions.items()), ".", class_="note"),
        table(
            "Inputs",
            [Column(head="file or folder", words=True), Column(head="SHA-256", words=True)],
            [[one.path, tag("code", one.digest)] for one in made.inputs],
            note="Of a campaign: of its description and all of its signals.",
        ),
        _pairs("Settings", "setting", "value", {key: _text(value) for key, value in settings.items()}),
        tag("details", tag("summary", "Numbers of the diagnosis"), _pairs("Diagnosis", "number", "value", numbers))
        if numbers
        else None,
        tag("details", tag("summary", "The model file"), tag("pre", made.model_text)) if made.model_text else None,
    )


def _pairs(caption: str, key: str, value: str, pairs: Mapping[str, str]) -> Safe:
    columns = [Column(head=key, words=True), Column(head=value, words=True)]
    return joined(table(caption, columns, [[name, said] for name, said in pairs.items()]))


def _text(value: object) -> str:
    said = to_json(value)
    if isinstance(said, dict):
        return "; ".join(f"{key or 'any other'}: {_text(one)}" for key, one in said.items())
    if isinstance(said, list):
        return ", ".join(map(_text, said)) or "none"
    return said if isinstance(said, str) else json.dumps(said)


# Five sentences: what was held against what, how well it fits, where it fails, what is missing, and what the article weighs.


RAW = "From the raw records alone, which know no effect: "
"""Before what was identified without the model."""


def summary_html(report: Report, figures: Figures) -> Safe:
    """The section."""
    said = ReportSummary(report=report)
    sentences = (said.data(), said.errors(), said.worst(), said.missing(), said.inertia())
    return section("summary", "Summary", tag("ol", *(tag("li", one) for one in sentences), class_="summary"))


@dataclass(frozen=True, eq=False, kw_only=True)
class ReportSummary:
    """The sentences at the head of a `report`."""

    report: Report

    def data(self) -> Safe:
        """What was held against what."""
        maps, classical = self.report.comparison.maps, len(self.report.classical)
        lined = [one for one in maps if len(one.frequency) > 1]  # a table of modes has one line for all of them
        modes = sum(len(one.runs) for one in maps if len(one.frequency) == 1 and FREQUENCY in one.rows)
        where, runs = list[str](), sum(len(one.runs) for one in lined)
        if lined:
            lines = sum(len(one.runs) * len(one.frequency) for one in lined)
            low, high = min(one.frequency[0] for one in lined), max(one.frequency[-1] for one in lined)
            where.append(f"{lines} lines between {low:.4g} and {high:.4g} Hz")
        where += [f"{modes} modes of tables"] if modes else []
        files = f" and {classical} classical measurement{'s' if classical != 1 else ''}" if classical else ""
        of = "campaign" if len(self.report.campaigns) == len(maps) else "data set"
        many = f"{len(maps)} {of}{'s' if len(maps) != 1 else ''}{f' of {runs} run' + 's' * (runs > 1) if runs else ''}"
        told = f": {' and '.join(where)}" if where else ""
        return joined(f"{self.report.comparison.title} was held against {many}{files}{told}.")

    def errors(self) -> Safe:
        """How well it fits."""
        _, plain, _, held = self.report.comparison.errors
        of = self.report.comparison.evaluation
        read = {channel.quantity for part in self.report.campaigns for channel in part.campaign.table.channels}
        what = "the measured forces" if read - {"acceleration"} else "what was measured"
        much = percent(of.plain.percent) if of.plain.percent else "no more than noise makes, 0 %"
        told = joined(f"With the sensors as calibrated it misses {what} by {much} ", verdict(plain.verdict))
        if of.held_out is None:
            return joined(told, ".")
        unseen = verdict(plain.verdict if held.verdict == GOOD else held.verdict)
        return joined(told, f", and of what no fit has seen {percent(of.held_out.percent)}", unseen and joined(" ", unseen), ".")

    def worst(self) -> Safe:
        """Where it fails."""
        spots = self.report.comparison.worst
        if not spots or spots[0].sigma < STANDS_OUT:
            peak = f", the worst spot being at {spots[0].sigma:.1f} sigma" if spots else ""
            return joined(f"Nowhere does it fail by more than chance{peak} ", verdict(GOOD), ".")
        where = text(spots[0], len(self.report.comparison.maps))
        return joined("It fails most at ", tag("em", where), " ", verdict(FAILED), ".")

    def missing(self) -> Safe:
        """What the model lacks."""
        found = self.report.diagnosis
        if found is None:
            return joined(f"What is missing was not looked for: {self.report.not_diagnosed or 'nobody asked'}.")
        then = f" Next measurement: {found.next_measurement.rstrip('.')}." if found.next_measurement else ""
        return joined(diagnosis.headline(found), then)

    def inertia(self) -> Safe:
        """What the article weighs: with the effects of the model first, then from raw records; and what neither knows yet."""
        report = self.report
        if not report.campaigns:
            return Safe("No inertia was identified: that takes motions of a base and the forces below.")
        known = [(part, part.findings.article) for part in report.campaigns if part.findings is not None]
        alone = [part for part, article in known if article.split("+")[0] != FMD]
        told = [_from_records(part) for part in alone or [part for part, _ in known]]
        raw = joined(RAW, Safe("; ".join(told)), ".") if told else joined("No inertia was identified from the raw records.")
        # What was diagnosed and is not in the model yet
        there = set(report.comparison.effects)
        lacking = [one.id for one in report.diagnosis.accepted if one.id not in there] if report.diagnosis is not None else []
        later = f" Nothing of this knows {diagnosis.listed(lacking)} yet, which the model lacks: `massline add` adds it."
        unknown = worded(later if lacking else "")
        if report.identified:
            lead = "with the effects of the model" if report.comparison.effects else "with the model, which has no effects"
            bodies = Safe("; ".join(map(_with_effects, report.identified)))
            return joined(f"Identified {lead}: ", bodies, ". ", raw, unknown)
        why = report.not_identified and f" With the effects of the model no inertia was identified: {report.not_identified}"
        return joined(raw, why, unknown)


def _with_effects(body: Body) -> Safe:
    """Mass, CoG and moments with their intervals beside the model's, and how many of the ten values lie outside."""
    beside = []
    for which in (slice(0, 1), slice(1, 4), slice(4, 7)):
        values, half, model = (one[which] * QUANTITIES[which][0].per_si for one in (body.values, body.half_width, body.reference))
        told = ", ".join(map(plus_minus, values, half))
        own = ", ".join(rounded(x, h) for x, h in zip(model, half, strict=True))
        beside.append(f"{told} {QUANTITIES[which][0].unit} (95 %), the model {own}")
    mass, cog, moments = beside
    within = verdict("within", GOOD) if abs(body.distance[0]) <= body.half_width[0] else verdict("outside", DOUBTFUL)
    beyond = int((abs(body.distance) > body.half_width).sum())
    of_ten = f"{beyond} of the ten values outside" if beyond else "all ten values inside"
    rest = f"; CoG {cog}; moments about it {moments}; {of_ten} their intervals"
    return joined(f"{body.article} weighs {mass}, ", within, rest)


def _from_records(part: CampaignPart) -> Safe:
    found = part.findings
    if found is None:
        return Safe("")
    best, mass = found.result, QUANTITIES[0]
    value, half = float(best.values[0]) * mass.per_si, float(best.half_width[0]) * mass.per_si
    carried = ", the FMD's moving part included," if found.article.split("+")[0] == FMD else ""
    told = f"{found.article}{carried} weighs {plus_minus(value, half)} kg ({best.identified.way}, 95 %)"
    doubted = joined(", ", verdict(DOUBTFUL), f" since {found.doubts[0]}") if found.doubts else None
    known = None if part.reference is None else part.reference.values[0]
    if known is None:
        return joined(told, doubted)
    own, admitted = known.value * mass.per_si, (known.tolerance or 0.0) * mass.per_si
    within = abs(value - own) <= math.hypot(half, admitted)
    drawn = f", drawn {plus_minus(own, admitted) if admitted > 1e-3 * half else f'{own:.4g}'} kg, "
    return joined(told, drawn, verdict("within", GOOD) if within else verdict("outside", DOUBTFUL), doubted)


Section = Callable[[Report, Figures], Safe]

SECTIONS: tuple[tuple[str, str, Section], ...] = (
    ("summary", "Summary", summary_html),
    ("requirements", "Requirements", requirements_html),
    ("articles", "Articles and reference", reference.html),
    ("modes", "Modes", flexible.html),
    ("sensors", "Sensors", compare.sensors_html),
    ("dynamic-mass", "Dynamic mass", compare.dynamic_mass_html),
    ("functions", "Response functions", compare.functions_html),
    ("condition", "Condition number", compare.html),
    ("inertia", "Identified inertia", identify.html),
    ("where", "Where it fails", compare.where_html),
    ("missing", "What is missing", report_diagnose.html),
    ("ladder", "The ladder", history.html),
    ("provenance", "Provenance", provenance_html),
)
"""Name, heading in the table of contents, and what writes it, in the order of the page."""

ALLOWED = "; ".join(
    (
        "default-src 'none'",
        "img-src data: blob:",
        "style-src 'unsafe-inline'",
        "script-src 'unsafe-inline'",
        "base-uri 'none'",
        "form-action 'none'",
    )
)
"""What the page may load: itself. A browser refuses it everything else, whatever stands in it."""


def write(report: Report, path: Path, progress: Progress | None = None) -> None:
    """Write the page to `path`, whole or not at all.

    Raises
    ------
    OSError : it cannot be written.
    """
    write_text(path, html(report, progress))


def html(report: Report, progress: Progress | None = None) -> str:
    """The whole page."""
    figures, tell = Figures(), progress or (lambda what, share: None)
    parts: list[tuple[str, str, Safe]] = []
    for k, (name, heading, write_section) in enumerate(SECTIONS):
        tell(heading, k / len(SECTIONS))
        if made := write_section(report, figures):
            parts.append((name, heading, made))
    named = f"{report.comparison.title} · massline report"
    return framed(named, head_html(report, figures), parts, figures, report.provenance.versions.get("massline", ""))


def framed(named: str, head: Safe, parts: Sequence[tuple[str, str, Safe]], figures: Figures, by: str) -> str:
    """A page of `parts`, each with its name and heading, below a `head`; it needs no other file.

    Parameters
    ----------
    named : for the browser's window
    figures : that the parts hold
    by : version of massline
    """
    links = [tag("li", tag("a", heading, href=f"#{name}")) for name, heading, _ in parts]
    contents = tag("nav", tag("ol", *links), aria_label="Contents", class_="paper-only")
    main = tag("main", head, contents, *(made for _, _, made in parts))
    # What a reader can do, above the page
    light = tag("button", "light or dark", type="button", id="theme", aria_pressed="false")
    printed = tag("button", "print", type="button", id="print")
    skip = tag("a", "Skip to the report", href="#top", class_="skip")
    bar = tag("div", skip, tag("span", "massline report", class_="brand"), light, printed, class_="bar screen-only")
    without = tag("noscript", tag("p", "Figures need JavaScript; the tables hold their numbers.", class_="warning"))
    told = tag("div", id="told", role="status", aria_live="polite", class_="screen-only")
    script = joined(without, told, figures.packed(), tag("script", Safe(_resource("page.js"))))
    body = tag(
        "body",
        bar,
        tag("div", tag("nav", tag("ol", *links), aria_label="Contents", class_="screen-only"), main, class_="page"),
        script,
    )
    about = tag(
        "head",
        tag("meta", charset="utf-8"),
        Safe(f'<meta http-equiv="Content-Security-Policy" content="{ALLOWED}">'),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("meta", name="generator", content=f"massline {by}".strip()),
        tag("title", named),
        tag("style", Safe(_resource("page.css"))),
    )
    return f"<!DOCTYPE html>\n{tag('html', about, body, lang='en')}\n"


def _resource(name: str) -> str:
    return files("validation.report").joinpath(name).read_text(encoding="utf-8")


# A `Report` from results that are there. What it still lacks is found here: articles by themselves, sensors, identified inertia.
#
# comparison = compared(model, data, ...)                      # validation.compare
# report = assembled(model, data, comparison, diagnosis=found, standing=at, provenance=...)
# page.write(report, Path("out/report.html"))


@dataclass(frozen=True, kw_only=True)
class How:
    """With what everything was computed.

    Attributes
    ----------
    band : [Hz]; None for that of the campaigns
    method : how spectra are made
    """

    band: tuple[float, float] | None = None
    method: str = "full-record"


def assembled(
    model: Model,
    data: Data,
    comparison: Comparison,
    *,
    provenance: Provenance,
    how: How | None = None,
    identified: Sequence[Body] = (),
    not_identified: str = "",
    diagnosis: Diagnosis | None = None,
    not_diagnosed: str = "",
    standing: HistoryPosition | None = None,
    progress: Progress | None = None,
) -> Report:
    """The report of `comparison`, with everything that can be told of its articles and campaigns by themselves.

    What cannot be made is left out, with the reason in its part: a user's own FE model has no drawing, a campaign of fewer than
    six runs no identified inertia.

    Parameters
    ----------
    model, data : of `comparison`
    identified, not_identified : inertia with the effects of the model, or why there is none (see `validation.report.identify`)
    diagnosis : of the same; None leaves the section with the reason `not_diagnosed`
    standing : of the model file

    Raises
    ------
    BadInput : a measurement file cannot be used.
    OSError : a file cannot be read any more.
    """
    how, tell = how or How(), progress or (lambda what, share: None)
    measured = [read(name, tuple(REDUCED)) for name in data.classical]
    classical = tuple(REDUCED[one.text("kind")](one) for one in measured)  # as `massline weigh`, `cog` and `pendulum` do it
    names = tuple(dict.fromkeys(name for one in data.campaigns if (name := above_fmd(one.article))))
    count = len(names) + len(data.campaigns)
    articles: list[ArticlePart] = []
    campaigns: list[CampaignPart] = []
    for name in names:
        tell(name, len(articles) / count)
        articles.append(article_part(name, model, comparison, classical))
    for one in data.campaigns:
        tell(Path(one.source).name, (len(articles) + len(campaigns)) / count)
        campaigns.append(campaign_part(one, data.campaigns, model, how.band, how.method))
    return Report(
        model=model,
        comparison=comparison,
        provenance=provenance,
        articles=tuple(articles),
        campaigns=tuple(campaigns),
        identified=tuple(identified),
        not_identified=not_identified,
        classical=classical,
        diagnosis=diagnosis,
        not_diagnosed=not_diagnosed,
        standing=standing,
    )


# A browser of the Chromium family without a window: where it lies, and how it is started so that it asks nobody for anything.
#
# Whoever starts one, the tests and the benchmarks among them, starts it with `flags`.


BROWSER = "MASSLINE_BROWSER"
"""The environment variable that names a browser."""

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "microsoft-edge")

PATIENCE = 30.0
"""[s] that a browser has to say its version."""


def browser_path() -> str:
    """The path of a browser that prints.

    Raises
    ------
    BadInput : there is none, or `MASSLINE_BROWSER` names none.
    """
    named = os.environ.get(BROWSER)
    if named is not None:
        found = shutil.which(named)
        if found is None:
            raise BadInput(BROWSER, "", f"no program is called {named!r}", "Name a browser of the Chromium family, or unset it")
        return found
    found = next((there for name in NAMES if (there := shutil.which(name))), None)
    if found is None:
        remedy = f"Install one (Debian: apt-get install chromium), or name another in {BROWSER}"
        raise BadInput("browser", "", f"none is on the path, looked for {', '.join(NAMES)}", remedy)
    return found


def version(program: str) -> str:
    """What the browser `program` says of itself; its path where it says nothing."""
    try:
        done = subprocess.run([program, "--version"], capture_output=True, encoding="utf-8", timeout=PATIENCE, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return program
    return done.stdout.strip() or program


def flags() -> tuple[str, ...]:
    """What it is started with: nothing asked of anybody, and its sandbox kept wherever it can be.

    As root, which is what one is in a container, it refuses to start in its sandbox.
    """
    root = hasattr(os, "geteuid") and os.geteuid() == 0
    return (
        *(("--no-sandbox",) if root else ()),
        "--disable-gpu",
        "--disable-quic",
        "--no-first-run",
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
    )


# The page on paper: a browser of the Chromium family prints it, without a window and without a network.


PDF_PATIENCE = 180.0
"""[s] after which a browser that does not end is ended."""

BUDGET = 60_000
"""[ms] of the page's own time within which every figure is drawn."""


def print_to(page: Path, path: Path, program: str) -> None:
    """Print the report `page` to the PDF file `path`, whole or not at all.

    Raises
    ------
    CheckFailed : the browser does not print.
    OSError : `path` cannot be written.
    """
    with TemporaryDirectory() as profile:
        made = Path(profile) / "page.pdf"
        options = (
            "--headless",
            *flags(),
            "--disable-extensions",
            f"--user-data-dir={profile}/profile",  # of its own, so that nothing is asked of anybody
            f"--virtual-time-budget={BUDGET}",
            "--no-pdf-header-footer",
            "--generate-pdf-document-outline",
            f"--print-to-pdf={made}",
        )
        words = [program, *options, f"{page.resolve().as_uri()}#paper"]
        how: dict[str, Any] = {"capture_output": True, "encoding": "utf-8", "errors": "replace", "check": False}
        try:
            done = subprocess.run(words, timeout=PDF_PATIENCE, **how)
        except subprocess.TimeoutExpired:
            raise CheckFailed(f"{program} did not print the report within {PDF_PATIENCE:g} s") from None
        last = next((line for line in reversed(done.stderr.splitlines()) if line.strip()), "")
        if not made.exists() or made.stat().st_size == 0:
            raise CheckFailed(f"{program} did not print the report: {last or 'it said nothing'}")
        write_with(path, lambda temporary: shutil.copyfile(made, temporary))


# `massline report` from options to output: read, compare, diagnose, assemble, write, print.


PROGRAMS = (
    *("massline", "numpy", "scipy", "plotly", "pyvista", "vtk", "matplotlib", "exudyn", "pin", "cadquery", "cadquery-ocp"),
    *("trimesh", "gmsh", "scikit-fem", "h5py", "joblib", "libigl", "manifold3d", "pillow", "pint", "pyyeti"),
    *("tomlkit", "uncertainties"),
)
"""Whose versions stand in the report where they are installed, beside Python's: what reads, computes or draws what is on it."""

NOT_ASKED = "--no-diagnosis"
WITHOUT = "this report was asked for without it"


@dataclass(frozen=True, kw_only=True)
class ReportOptions:
    """The options as typed.

    Attributes
    ----------
    compared : model, data, and what `massline compare` is asked
    diagnosis : whether to look for what is missing
    out : where the page goes; None for a name after the model's, under out/
    pdf : whether to print it as well
    by : who makes it
    command : the command line
    """

    compared: Options
    diagnosis: bool = True
    out: Path | None = None
    pdf: bool = False
    by: str = ""
    command: str = ""


def answer(asked: ReportOptions) -> None:
    """Write what is `asked`, and say where it is.

    Raises
    ------
    BadInput : something that was asked cannot be used; no browser where one is to print.
    CheckFailed : a fit that does not converge; a browser that does not print.
    OSError : a file cannot be written.
    """
    path = place(asked)
    program = browser_path() if asked.pdf else ""
    report = reported(asked)
    with stages("writing", quiet=False) as told:
        write(report, path, told)
    wrote(path)
    if program:
        printed = path.with_suffix(".pdf")
        with stages("printing", quiet=False):
            print_to(path, printed, program)
        wrote(printed)


def place(asked: ReportOptions) -> Path:
    """Where the page goes.

    Raises
    ------
    BadInput : a place where nothing can be written, or an ending that is not .html.
    """
    if asked.out is None:
        path = Path("out") / f"{file_name(Path(asked.compared.model).stem)}-report.html"
        path.parent.mkdir(exist_ok=True)
        return path
    require_ending(asked.out, (".html", ".htm"), "a report, of which --pdf prints a PDF beside it,", "out/report.html")
    require_file(asked.out, "--out")
    return asked.out


def reported(asked: ReportOptions, *, quiet: bool = False) -> Report:
    """The report that `asked` leads to.

    Raises
    ------
    BadInput, CheckFailed : see `answer`.
    """
    question = asked.compared
    with stages("reading", quiet=quiet) as told:
        model, data = validation_study.read(question, told)
        at = history_position(Path(question.model)) if Path(question.model).is_file() else None
    with stages("comparing", quiet=quiet) as told:
        study = Study.of(model, data, question, told)
        comparison = compared(study, told)
    with stages("diagnosing", quiet=quiet) as told:
        found: Diagnosis | None = None
        why = "" if asked.diagnosis else WITHOUT
        if asked.diagnosis:
            try:
                if not study.tests:
                    require_runs(study.campaigns)
                found = diagnose.diagnosed_once(study, progress=told)
            except (BadInput, CheckFailed) as error:
                why = str(error)
    with stages("identifying and drawing", quiet=quiet) as told:
        bodies, missing = identify.identified(study, comparison, at, told)
        return assembled(
            model,
            data,
            comparison,
            provenance=provenance(asked),
            how=How(band=question.band, method=question.spectra),
            identified=bodies,
            not_identified=missing,
            diagnosis=found,
            not_diagnosed=why,
            standing=at,
            progress=told,
        )


def provenance(asked: ReportOptions) -> Provenance:
    """Where a report of what is `asked` comes from, at this moment.

    Raises
    ------
    OSError : a file cannot be read.
    """
    question = asked.compared
    there: dict[str, str] = {}
    for name in PROGRAMS:
        with suppress(PackageNotFoundError):
            there[name] = version_of(name)
    found = there | {"Python": python_version(), "system": platform()}
    versions = {**found, "browser that prints": version(browser_path())} if asked.pdf else found
    asked_of = (question.model, *question.data)
    named = [str(one) for path in asked_of for one in files_named(Path(path))]
    # Files of code that take part in every figure
    own_effects = tuple(source for source in SOURCES.values() if Path(source).is_file())
    return Provenance(
        when=datetime.now().astimezone().isoformat(sep=" ", timespec="minutes"),
        by=asked.by,
        command=asked.command or command_line(question, diagnosis=asked.diagnosis),
        versions=versions,
        inputs=tuple(Source(path=path, digest=digest(path)) for path in dict.fromkeys((*asked_of, *named, *own_effects))),
        settings={
            "spectra": question.spectra,
            "band [Hz]": question.band or "what all runs drive",
            "held out": question.hold_out or "each run in turn",
            **({"effects of the user's own": [f"{name} ({source})" for name, source in SOURCES.items()]} if SOURCES else {}),
        },
        model_text=Path(question.model).read_text(encoding="utf-8") if Path(question.model).is_file() else "",
    )


def command_line(of: Options, *, effects_from: Sequence[str] = (), diagnosis: bool = True) -> str:
    """What is typed for a report of `of`."""
    words = ["massline", "report", of.model, *of.data]
    words += [word for name in of.hold_out for word in ("--hold-out", name)]
    words += [] if of.band is None else ["--band", *(f"{end:g}" for end in of.band)]
    words += [] if of.spectra == METHODS[0] else ["--method", of.spectra]
    words += [word for folder in effects_from for word in ("--effects-from", folder)]
    return shlex.join([*words, *([] if diagnosis else [NOT_ASKED])])
