"""`massline diagnose --each`: which of many articles differs, by what, how they scatter; `massline league`: tests of others."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from importlib.metadata import version
from operator import itemgetter
from pathlib import Path
from typing import Any

import click
import numpy as np

from geometry import toml_file
from geometry.atomic import write_text
from geometry.errors import BadInput, CheckFailed
from validation.classical import files, pendulum
from validation.diagnose.diagnose import diagnosed
from validation.diagnose.diagnosis import NAMED, NOTHING, UNKNOWN, Answer, Diagnosis, headline, listed
from validation.diagnose.fleet import ERROR, Difference, Fleet, Member, MemberAnswer, NumberScatter
from validation.diagnose.pendulum import only_classical
from validation.effects.practical_units import written
from validation.model import model_file
from validation.output import NONE, json_text, print_answer, stages, to_json, wrote
from validation.report import document as doc
from validation.report.charts import interactive, spec
from validation.report.charts.figure import Figure
from validation.report.page import framed
from validation.report.parts import notes, paragraphs, section
from validation.study import Options, Study

RESULT, PAGE = "fleet.json", "fleet.html"
"""Files of a fleet in its folder."""

DRAWN = 4
"""Numbers of which a page draws every article, those by which articles differ first."""

PANEL = 190
"""[pixels] of one of these."""


def answer(asked: Options, each: Path, *, processes: int, scheduler: str, as_json: bool, folder: Path | None) -> None:
    """Diagnose every article below `each`, print what differs, and write JSON and a page into `folder` (None: nowhere).

    Raises
    ------
    BadInput : no folder, or nothing in it.
    CheckFailed : nothing could be said of any of them.
    """
    if not each.is_dir():
        raise BadInput("--each", str(each), "there is no such folder", "Name one that holds campaigns")
    every = Member.below(each, asked)
    with stages("fleet", quiet=as_json) as told:
        found = Fleet.diagnosed(every, processes=processes, scheduler=scheduler, progress=told)
    page = replace(FleetPage(found=found).document(), title=f"{len(found.articles)} articles beside {asked.path.name}")
    whole, file = {"model": asked.model, "each": str(each), **to_json(found)}, None if folder is None else folder / RESULT
    print_answer(lambda: whole, page.text, as_json=as_json, file=file)
    if folder is not None:
        figures = doc.Figures()
        part = section("fleet", page.title, doc.joined(paragraphs(page.opening), *page.html(figures), notes(page.notes)))
        head = doc.tag("h1", page.title, id="top")
        write_text(folder / PAGE, framed(page.title, head, [("fleet", page.title, part)], figures, version("massline")))
        wrote(folder / PAGE)


@dataclass(frozen=True, eq=False, kw_only=True)
class FleetPage:
    """What a page says of the fleet that was `found`."""

    found: Fleet

    def document(self) -> doc.Document:
        """All of it, in the order in which it is read."""
        found = self.found
        apart = tuple(dict.fromkeys(one.article for one in found.differences))

        def figures(of: str, unit: str, *values: float | None) -> tuple[str, ...]:
            """In a practical unit, which comes last."""
            if of == ERROR:
                return (*(NONE if value is None else f"{value:.3g}" for value in values), "%")
            known = [value for value in values if value is not None]
            key = next(one.sizes[of].key for one in found.members if of in one.sizes)
            texts, shown = written(of.partition(":")[0], key, unit, tuple(known))
            each = iter(texts)
            return (*(NONE if value is None else next(each) for value in values), shown)

        def differs(one: Difference) -> tuple[str, ...]:
            return (NONE, NONE, "") if one.value is None else figures(one.of, one.unit, one.value, one.middle)

        def scatters(one: NumberScatter) -> tuple[str, ...]:
            sizes = (one.middle, one.articles, one.mountings, one.laboratories, one.stated)
            return tuple(text.lstrip("+") if k else text for k, text in enumerate(figures(one.of, one.unit, *sizes)))

        differences = doc.Table(
            caption="Which articles differ, and by what",
            rows=[(one, *differs(one)) for one in found.differences],
            columns=(
                doc.Column("differs", lambda row: row[0].article, words=True),
                doc.Column("value", itemgetter(1)),
                doc.Column("of the others", itemgetter(2)),
                doc.Column("unit", itemgetter(3), words=True),
                doc.Column("sd of an article", lambda row: NONE if row[0].sigma is None else f"{row[0].sigma:+.1f}"),
                doc.Column("by", lambda row: row[0].of, words=True),
            ),
        )
        scatter = doc.Table(
            caption="Scatter between articles, mountings and laboratories: standard deviations",
            rows=[(one.of, *scatters(one), f"{one.count}") for one in found.scatter],
            columns=(
                doc.Column("scatter of", itemgetter(0), words=True),
                doc.Column("mean", itemgetter(1)),
                doc.Column("articles", itemgetter(2)),
                doc.Column("mountings", itemgetter(3)),
                doc.Column("laboratories", itemgetter(4)),
                doc.Column("a fit states", itemgetter(5)),
                doc.Column("unit", itemgetter(6), words=True),
                doc.Column("from", itemgetter(7)),
            ),
        )
        every = doc.Table(
            caption="All that were diagnosed",
            rows=found.members,
            shown=[one for one in found.members if one.member.article in apart or one.verdict == "refused"],
            columns=(
                doc.Column("diagnosed", lambda one: one.member.name, words=True),
                doc.Column("article", lambda one: one.member.article, words=True),
                doc.Column("laboratory", lambda one: one.member.laboratory or NONE, words=True),
                doc.Column("plain error", lambda one: one.error, ".3g", unit="%"),
                doc.Column("said", lambda one: one.said, words=True),
            ),
        )
        said = (
            f"{listed(apart)} of {len(found.articles)} differ." if apart else f"None of {len(found.articles)} articles differs."
        )
        said = said.replace("differ.", "differs.") if len(apart) == 1 else said
        laboratories = {one.member.laboratory for one in found.members} - {""}
        places = f"{len(laboratories)} laboratories" if len(laboratories) > 1 else "one laboratory"
        counted = f"{len(found.members)} mountings of {len(found.articles)} articles in {places}"
        drawn = doc.Drawn(self.sizes, "Each point a mounting, with the 90 % interval of its fit.") if found.scatter else None
        return doc.Document(
            opening=(said, f"{counted}, each diagnosed by itself."),
            blocks=(differences, drawn, scatter, every),
            notes=tuple(self.notes(apart)),
        )

    def notes(self, apart: tuple[str, ...]) -> Iterator[str]:
        """What must be known to read the tables."""
        found = self.found
        yield (
            "An article differs where it lies farther from the others than chance lets any in 99 of 100 fleets of equal ones; sd "
            "of an article: of the mean of its mountings, among those that do not differ."
        )
        yield "Scatter: of the articles that do not differ. What a measurement adds is in that of mountings."
        if any(one.mountings is None for one in found.scatter):
            yield "One mounting an article: the scatter of mountings is in that of articles. Mount some again to tell them apart."
        if any(one.laboratories is None for one in found.scatter):
            yield "Laboratories are not told from articles here: that takes several articles in each of at least two of them."
        silent = [one.member.name for one in found.members if one.verdict == "refused"]
        if silent:
            yield f"Nothing can be said of {listed(silent)}; the table says why."
        if len(apart) > NAMED:
            yield "The first table and --json have all that differ."
        yield from (f"warning: {text}." for text in found.remarks)

    def sizes(self, *, dark: bool = False) -> Figure:
        """Every mounting of every article: the numbers by which articles differ first."""
        found = self.found
        by = [one.of for one in found.differences if one.value is not None]
        shown = sorted((one.of for one in found.scatter), key=lambda of: by.index(of) if of in by else len(by))[:DRAWN]
        far = {(one.article, one.of) for one in found.differences}
        figure = Figure(rows=len(shown), vertical=0.25 / len(shown))
        for row, of in enumerate(shown, start=1):
            for role, apart in ((spec.PREDICTED, False), (spec.MEASURED, True)):
                own = [one for one in found.members if ((one.member.article, of) in far) == apart and _of(one, of) is not None]
                values = np.array([_of(one, of) for one in own], dtype=float)
                ends = [one.sizes.get(of) for one in own]
                bars = {
                    "type": "data",
                    "symmetric": False,
                    "array": [0.0 if end is None else end.high - end.value for end in ends],
                    "arrayminus": [0.0 if end is None else end.value - end.low for end in ends],
                }
                trace = {
                    "type": "scatter",
                    "mode": "markers",
                    "x": [interactive.escaped(one.member.article) for one in own],
                    "y": values,
                    "error_y": bars,
                    "marker": {"color": spec.COLOURS[role][1], "size": 7},
                    "name": "differs" if apart else "alike",
                    "legendgroup": role,
                    "showlegend": row == 1 and bool(own),
                    "hovertemplate": "%{x}: %{y:.4g}<extra></extra>",
                }
                figure.add(trace, row=row)
            figure.up(row=row, column=1, title={"text": interactive.escaped(of)})
        return interactive.dressed(
            figure, "Every article", 110 + PANEL * len(shown), dark, legend=interactive.legend_above(), margin={"t": 80}
        )


def _of(one: MemberAnswer, of: str) -> float | None:
    return one.error if of == ERROR else one.sizes[of].value if of in one.sizes else None


# `massline league`: real tests that others made, each diagnosed from its study file, in one table: expected, said, and left.


FILE = "league.toml"
KEYS = ("name", "folder", "study", "data", "hold_out", "expected", "tuned_on")
FIRST = 3
"""Names of the ranking that JSON has of a set, accepted or not."""

REFUSED = "refused"
"""Verdict on a set of which no diagnosis came."""


@dataclass(frozen=True, kw_only=True)
class RealSet:
    """One real set.

    Attributes
    ----------
    name : of the set, and of its folder among the data where no other is named
    folder : among the data
    study : its model file; or pendulum periods, which are reduced and held against the published results that are its data
    data : campaigns and tests beside those that the study names, or weights and periods alone
    hold_out : see `validation.study.Options`
    expected : what a good league_answer is, and whose word that is
    tuned_on : whether anything of the program was chosen by looking at it
    """

    name: str
    folder: str = ""
    study: Path
    data: tuple[Path, ...] = ()
    hold_out: tuple[str, ...] = ()
    expected: str
    tuned_on: bool


@dataclass(frozen=True, eq=False, kw_only=True)
class Result:
    """What was said of a set.

    Attributes
    ----------
    entry : the set
    verdict : of the diagnosis, or `REFUSED`
    said : in a sentence
    found : the diagnosis; None where it refused, or nothing was diagnosed
    before, after : [%] plain errors of a diagnosis; of results that were reduced the largest deviation from what is published
    """

    entry: RealSet
    verdict: str
    said: str
    found: Answer | None = None
    before: float | None = None
    after: float | None = None

    @property
    def as_json(self) -> Mapping[str, Any]:
        """As `massline league --json` has it."""
        of = self.found
        return {
            "expected": self.entry.expected,
            "verdict": self.verdict,
            "said": self.said,
            "accepted": [] if of is None else [one.id for one in of.accepted],
            "class": [] if of is None else list(of.equivalence_class),
            "left": None if of is None else of.left,
            "first": [] if of is None else [one.id for one in of.ranking[:FIRST]],
            "error_before_percent": self.before,
            "error_after_percent": self.after,
            "tuned_on": self.entry.tuned_on,
        }


def real_sets(folder: Path, data: Path) -> tuple[RealSet, ...]:
    """The sets that ``league.toml`` in `folder` names, whose data lie in `data`.

    Raises
    ------
    BadInput : no such file, an unknown or missing key.
    """
    source = folder / FILE
    table = toml_file.read(source, remedy="Name the folder of study files with --studies")
    toml_file.require_format(table, str(source))
    toml_file.require_known(table, ("format", "set"), source=str(source))
    found = []
    for k, one in enumerate(table.get("set", []), start=1):
        where = f"set[{k}]"
        toml_file.require_known(one, KEYS, source=str(source), where=where)
        toml_file.require_present(one, ("name", "study", "expected", "tuned_on"), source=str(source), where=where)
        paths = tuple(folder / name if (folder / name).is_file() else data / name for name in one.get("data", ()))
        found.append(
            RealSet(
                name=one["name"],
                folder=one.get("folder", one["name"]),
                study=folder / one["study"],
                data=paths,
                hold_out=tuple(one.get("hold_out", ())),
                expected=one["expected"],
                tuned_on=bool(one["tuned_on"]),
            )
        )
    return tuple(found)


def result(entry: RealSet, *, quiet: bool = False) -> Result:
    """What a diagnosis says of one set."""
    try:
        with stages(entry.name, quiet=quiet) as told:
            if _is_measurement(entry.study):
                return _reduced(entry)
            if entry.data and all(map(_is_measurement, entry.data)):
                alone = only_classical(model_file.read(entry.study), [str(path) for path in entry.data])
                said = alone.text.partition(" Chi² ")[0]
                return Result(entry=entry, verdict=alone.verdict, said=said, found=alone)
            study = Study.open(entry.study, entry.data, hold_out=entry.hold_out, progress=told)
            found: Diagnosis = diagnosed(study, progress=told)
    except (BadInput, CheckFailed) as error:
        return Result(entry=entry, verdict=REFUSED, said=str(error))
    before, after = float(found.before.plain.percent), float(found.after.plain.percent)
    return Result(entry=entry, verdict=found.verdict, said=headline(found), found=found, before=before, after=after)


def _is_measurement(path: Path) -> bool:
    """Whether a file holds weights, periods, or what somebody made of them."""
    return path.suffix == ".toml" and toml_file.read(path).get("kind") in files.KINDS


def _reduced(entry: RealSet) -> Result:
    """What comes out of pendulum periods beside what their authors published of them."""
    ours = pendulum.reduce(files.read(str(entry.study), ("pendulum",))).results
    theirs = {
        key: value for path in entry.data for key, value in files.reduce(files.read(str(path), ("results",))).results.items()
    }
    off = {key: ours[key].nominal_value - value.nominal_value for key, value in theirs.items()}
    share = {key: 100 * abs(one / theirs[key].nominal_value) for key, one in off.items()}
    worst = max(share, key=lambda key: share[key])
    far = [key for key, one in off.items() if abs(one) > theirs[key].std_dev]
    where = f"{'beyond' if far else 'within'} its tolerance"
    said = f"{', '.join(share)} as published: {worst} is {round(share[worst], 6):.2g} % off, {where}"
    return Result(entry=entry, verdict=UNKNOWN if far else NOTHING, said=said, after=share[worst])


@dataclass(frozen=True, eq=False, kw_only=True)
class League:
    """The results of all sets, and the names of those whose data are not here."""

    results: tuple[Result, ...]
    absent: tuple[str, ...] = ()

    def document(self) -> doc.Document:
        """The table."""
        table = doc.Table(
            caption="The verdicts, and the plain error before and after",
            rows=self.results,
            columns=(
                doc.Column("set", lambda one: one.entry.name, words=True),
                doc.Column("verdict", lambda one: one.verdict, words=True),
                doc.Column("before", lambda one: one.before, ".3g", unit="%"),
                doc.Column("after", lambda one: None if one.after is None else round(one.after, 6), ".3g", unit="%"),
                doc.Column("tuned on", lambda one: "yes" if one.entry.tuned_on else "no"),
            ),
        )
        notes = [f"{one.entry.name}: expected: {one.entry.expected}. Said: {one.said.rstrip('.')}." for one in self.results]
        if self.absent:
            notes.append(f"Not here: {', '.join(self.absent)}. Name the folder of the data with --data or MASSLINE_DATA.")
        return doc.Document(title="Real tests that others made", blocks=(table,), notes=tuple(notes))


def league_answer(folder: Path, data: Path, names: tuple[str, ...], *, as_json: bool) -> None:
    """Diagnose the sets called `names`, all where none is, and print the table, or JSON.

    Raises
    ------
    BadInput : see `real_sets`; a name that no set has; none of the data are there.
    """
    every = real_sets(folder, data)
    if unknown := set(names) - {one.name for one in every}:
        known = ", ".join(one.name for one in every)
        raise BadInput("NAME", "", f"no set is called {', '.join(sorted(unknown))}", f"There are {known}")
    chosen = [one for one in every if not names or one.name in names]
    here = [one for one in chosen if (data / one.folder).is_dir()]
    if not here:
        problem = f"it holds none of {', '.join(one.name for one in chosen)}"
        raise BadInput(str(data), "--data", problem, "docs/league.md says where they come from")
    found = League(
        results=tuple(result(one, quiet=as_json) for one in here), absent=tuple(one.name for one in chosen if one not in here)
    )
    if as_json:
        click.echo(json_text({"sets": {one.entry.name: one.as_json for one in found.results}, "absent": list(found.absent)}))
    else:
        click.echo(found.document().text(), nl=False)
