"""`massline add`, `massline ladder` and `massline undo` from options to output, and the climb of `massline diagnose --auto`."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from fem.mesh import deck
from geometry.atomic import write_text
from geometry.errors import BadInput, CheckFailed
from geometry.toml_file import DECKS
from identification.quality import NORMAL_90
from validation import output
from validation.diagnose import diagnosis as results
from validation.effects.catalogue import FAMILIES
from validation.effects.effect import MISTAKE as OF_MISTAKES
from validation.history import add as adding
from validation.history import history
from validation.history.history import SHOWN, Body, HistoryPosition, Version, VersionSize, history_position, undone
from validation.history.verdict import is_worth_adding, percent
from validation.model import model_file, write_back
from validation.model.model import Model
from validation.reference.statement import QUANTITIES
from validation.report import document
from validation.report.charts import history as charts
from validation.report.document import PAGE, TERMINAL, Block, Column, Document, Drawn, Figures, Grid, Safe, Table, aligned
from validation.report.parts import Report, error_figures, error_lines, section
from validation.report.parts import notes as parts_notes
from validation.study import Options, Progress, Study

if TYPE_CHECKING:
    from validation.history.add import AddedEffectOptions
    from validation.study import Options


# What `massline add`, `massline ladder` and `massline undo` print with ``--json``; keys end in their unit.


def of_ladder(at: HistoryPosition) -> dict[str, Any]:
    """The ladder and where its model stands; null where that was edited by hand."""
    return {
        "model": str(at.path),
        "ladder": str(history.path_beside(at.path)),
        "current": None if at.rung is None else at.rung.number,
        "edited": at.edited,
        "rungs": [of_rung(one) for one in at.ladder.rungs],
    }


def of_rung(one: Version) -> dict[str, Any]:
    """A rung without its model and its tolerances, which the ladder's file holds."""
    return {
        "number": one.number,
        "parent": one.parent,
        "cause": one.cause,
        "effect": one.effect or None,
        "effects": [effect(one, name) for name in one.effects],
        "errors": output.to_json(one.errors),
        "evidence_gain_nats": output.to_json(one.gain),
        "inertia": [_body(body) for body in one.bodies],
        "verdict": list(one.verdict),
        "worth_a_parameter": is_worth_adding(one) if one.effect else None,
        "data": [source.path for source in one.conditions.data],
        "when": one.when,
    }


def of_step(at: HistoryPosition, before: Version, after: Version, said: Sequence[str]) -> dict[str, Any]:
    """What adding an effect did; `said` is what was warned of."""
    both = {
        f"{name.replace('_', '')}_{when}_percent": None if errors is None else getattr(errors, name)
        for name in ("plain", "held_out")
        for when, errors in (("before", before.errors), ("after", after.errors))
    }
    return {
        "model": str(at.path),
        "ladder": str(history.path_beside(at.path)),
        "rung": after.number,
        "parent": before.number,
        "effect": effect(after, after.effect),
        "errors": both,
        "evidence_gain_nats": output.to_json(after.gain),
        "verdict": list(after.verdict),
        "worth_a_parameter": is_worth_adding(after),
        "before": of_rung(before),
        "after": of_rung(after),
        "warnings": list(said),
    }


def effect(one: Version, name: str) -> dict[str, Any]:
    """EFFECT of the output contract; of an effect with several sizes `values` holds them, and `value` is null."""
    sizes = one.effects.get(name, ())
    alone = sizes[0] if len(sizes) == 1 else None
    return {
        "id": name,
        "value": None if alone is None else alone.value,
        "unit": None if alone is None else alone.unit,
        "interval90": None if alone is None else _interval(alone),
        "evidence_nats": output.to_json(one.gain) if name == one.effect else None,
        "text": " ".join(one.verdict) if name == one.effect else "",
        "values": {size.key: {"value": size.value, "unit": size.unit, "interval90": _interval(size)} for size in sizes},
    }


def _interval(size: VersionSize) -> list[float] | None:
    if size.deviation is None:
        return None
    half = NORMAL_90 * size.deviation
    return [size.value - half, size.value + half]


def _body(body: Body) -> dict[str, Any]:
    return {
        "article": body.article,
        "identified": history.ten_json(body.values),
        "half_width95": history.ten_json(body.half_width),
        "reference": history.ten_json(body.reference),
        "distance": {"cog_mm": body.shown[1:4].tolist(), "percent": body.shown[[0, *range(4, 10)]].tolist()},
        "sigma": body.sigmas.tolist(),
        "converged": body.converged,
    }


# The pages of `massline add`, `massline ladder` and `massline undo`, and the ladder in a report.


HERE, NOT_HERE = "→ ", "  "
"""Before the rung on which the model stands, and before the others."""

PRICE = "{tolerance_z2:.3g} of {due_z2:.0f}"
"""Of the tolerances, on a terminal."""

UNKEPT = "plain error, a configuration never seen"
"""An error that versions do not keep."""


def of_added(before: Version, after: Version) -> list[Grid]:
    """The four errors before and after, the sizes of all effects, and how far each article is from its reference."""
    lines = [one for one in error_lines(before.errors, after.errors) if one[0] != UNKEPT]
    gain = ("", output.NONE if after.gain is None else f"{output.nats(after.gain)} nats, {output.odds(after.gain)}")
    columns = [aligned(tuple(column)) for column in zip(*(cells for _, cells in lines), gain, strict=True)]
    names = (*(name for name, _ in lines), "evidence gained")
    header = ("", f"rung {before.number}", f"rung {after.number}")
    found = [Grid(header=header, lines=tuple(zip(names, *columns, strict=True)))]
    # A line a size; one that says that there is none, of an effect that is there or not
    sizes = [
        line
        for name, every in after.effects.items()
        for line in [(f"{name} {size.key}".rstrip(), _size(size)) for size in every] or [(name, output.NONE)]
    ]
    if sizes:
        cells = aligned(tuple(cell for _, cell in sizes))
        named = tuple((name, cell) for (name, _), cell in zip(sizes, cells, strict=True))
        found.append(Grid(header=("effects of the model", "size ± one standard deviation"), lines=named))
    for body in after.bodies:
        earlier = [(before.number, one) for one in before.bodies if one.article == body.article][:1]
        found.append(distances(body.article, [*earlier, (after.number, body)]))
    return found


def _size(size: VersionSize) -> str:
    spread = "" if size.deviation is None else f" ± {size.deviation:.2g}"
    return output.with_unit(f"{size.value:.5g}{spread}", size.unit)


def distances(article: str, bodies: Sequence[tuple[int, Body]]) -> Grid:
    """How far the identified inertia of `article` lies from the model's, rung by rung: in mm or per cent, and in sigmas."""
    header = ["identified - reference"]
    columns: list[tuple[str, ...]] = [tuple(quantity.label for quantity in QUANTITIES)]
    for rung, body in bodies:
        header += [f"{article}, rung {rung}", "σ"]
        columns.append(aligned(tuple(f"{one:+.3g} {name}" for one, name in zip(body.shown, SHOWN, strict=True))))
        columns.append(aligned(tuple(f"{one:+.1f}" for one in body.sigmas)))
    return Grid(header=tuple(header), lines=tuple(zip(*columns, strict=True)))


def _values(article: str, bodies: Sequence[tuple[int, Body]]) -> Grid:
    """The identified inertia of `article` rung by rung with its 95 % intervals, and the model's own on the last."""
    per_si = np.array([quantity.per_si for quantity in QUANTITIES])
    header = ["identified ± 95 %"]
    columns: list[tuple[str, ...]] = [tuple(f"{quantity.label} [{quantity.unit}]" for quantity in QUANTITIES)]
    for rung, body in bodies:
        header.append(f"{article}, rung {rung}")
        both = zip((body.values * per_si).tolist(), (body.half_width * per_si).tolist(), strict=True)
        columns.append(aligned(tuple(f"{output.rounded(value, half)} ± {output.rounded(half, half)}" for value, half in both)))
    last = bodies[-1][1]
    both = zip((last.reference * per_si).tolist(), (last.half_width * per_si).tolist(), strict=True)
    columns.append(aligned(tuple(output.rounded(value, half) for value, half in both)))
    return Grid(header=(*header, "reference"), lines=tuple(zip(*columns, strict=True)))


def _sizes(one: Version) -> str:
    """Of the effect that it added."""
    every = one.effects.get(one.effect, ())
    return _size(every[0]) if len(every) == 1 else ", ".join(f"{each.key} {each.value:.4g}" for each in every) or output.NONE


def rungs(at: HistoryPosition) -> Table:
    """All rungs: on a page in their order, on a terminal as a tree."""
    here = None if at.rung is None else at.rung.number

    return Table(
        caption="Rungs",
        rows=[("", one, error_figures(one.errors)) for one in at.ladder.rungs],
        shown=[(branch, one, error_figures(one.errors)) for branch, one in at.ladder.tree()],
        columns=(
            Column("rung", lambda row: f"{row[1].number}{' (here)' if row[1].number == here else ''}", words=True, on=PAGE),
            Column(
                "  rung",
                lambda row: f"{HERE if row[1].number == here else NOT_HERE}{row[0]}{row[1].number} {row[1].title}",
                words=True,
                on=TERMINAL,
            ),
            Column("from", lambda row: "" if row[1].parent is None else f"{row[1].parent}", words=True, on=PAGE),
            Column("what changed", lambda row: row[1].title, words=True, on=PAGE),
            Column("size", lambda row: _sizes(row[1]), on=TERMINAL),
            Column("nominal", lambda row: row[2]["nominal"], unit="%", said=("nominal", percent)),
            Column("plain", lambda row: row[2]["plain"], unit="%", said=("plain", percent)),
            Column("plain, only for checking", lambda row: row[2]["held_out"], unit="%", said=("checked", percent)),
            Column("χ² per dof", lambda row: row[2]["chi2_per_dof"], said=("chi²/dof", ".3g")),
            Column("sum z²", lambda row: row[2]["tolerance_z2"], on=PAGE),
            Column("sum z²", lambda row: output.NONE if row[2]["due_z2"] is None else PRICE.format(**row[2]), on=TERMINAL),
            Column("due", lambda row: row[2]["due_z2"], on=PAGE),
            Column("evidence", lambda row: row[1].gain, output.nats, unit="nats"),
            Column("when", lambda row: row[1].when.replace("T", " ")[:16], words=True, on=PAGE),
        ),
    )


def ladder_document(at: HistoryPosition) -> Document:
    """The rungs, and of every article what was identified and its way to the reference along the rungs to here."""
    many = f"{len(at.ladder.rungs)} rung{'s' if len(at.ladder.rungs) > 1 else ''}"
    where = "edited by hand since" if at.rung is None else f"it stands on rung {at.rung.number}"
    strong = "Strong: the way to the rung on which the model stands. Open circles: branches."
    blocks: list[Block] = [Drawn(partial(charts.falling_errors, at), strong), rungs(at)]
    way = charts.way_to(at)
    for article in dict.fromkeys(body.article for one in way for body in one.bodies):
        bodies = [(one, body) for one in way for body in one.bodies if body.article == article]
        numbered = [(one.number, body) for one, body in bodies]
        moved = {f"{one.number} {one.title}": body for one, body in bodies}
        title = f"{article}: identified less the model of each rung, 95 % intervals"
        drawn = Drawn(partial(charts.identified_inertia, moved, title))
        blocks += [_values(article, numbered), distances(article, numbered), drawn]
    for one in at.ladder.rungs:
        if one.verdict:
            blocks.append(document.tag("p", document.tag("strong", f"Rung {one.number}, {one.title}: "), " ".join(one.verdict)))
    return Document(title=f"{at.path.name}: {many}, {where}", blocks=blocks, notes=list(notes(at)))


def text(at: HistoryPosition) -> str:
    """The page of a ladder."""
    return ladder_document(at).text()


def html(report: Report, figures: Figures) -> Safe:
    """The section of a report; empty where no effect was added."""
    at = report.standing
    if at is None or not any(one.errors for one in at.ladder.rungs):
        return Safe("")
    said = ladder_document(at)
    return section("ladder", "The ladder", *said.html(figures), parts_notes(said.notes))


BODIES = (
    "Identified: CoG from the article's own origin, moments and products about it. Reference: the model with its effects.",
    "Less reference: mass, moments in per cent, products in per cent of √(Θii Θjj), CoG in mm; σ: one standard deviation.",
)
"""What must be known to read what was identified."""


def notes(at: HistoryPosition) -> Iterator[str]:
    """What must be known to read the tables, and what is odd."""
    bodies = any(one.bodies for one in at.ladder.rungs)
    what = "the force" if bodies else "what is"
    yield f"Nominal: as it stands. Plain: tolerances of the measurement not fitted. Per cent of {what} read."
    yield "Checked: the plain error on data used only for checking (held out). Evidence in nats: 3 is 20 to 1, 8 is 3000 to 1."
    yield "Sum z²: the prior penalty of the tolerances, all fitted, and what is due in a sound laboratory."
    yield from BODIES if bodies else ()
    yield from history.conditions(at)


def add(asked: "Options", effect: "AddedEffectOptions", *, as_json: bool) -> None:
    """Add an `effect` to the model that is `asked`, and print the errors before and after.

    Raises
    ------
    BadInput : something that was asked cannot be used.
    CheckFailed : a fit of the model as it was does not converge.
    """
    from validation.history.add import added, opened
    from validation.history.verdict import sentence

    with output.stages(f"adding {effect.effect}", quiet=as_json) as told:
        study, known = opened(asked, effect, told)
        step = added(study, effect, told)
    said = (*known, *step.said)
    title = f"{asked.path.name}: {step.after.effect} added, rung {step.after.number} on rung {step.before.number}"
    page = document.page(title, of_added(step.before, step.after), (*step.after.verdict, *map(sentence, said)))
    output.print_answer(lambda: of_step(step.at, step.before, step.after, said), lambda: page, as_json=as_json)


def ladder(path: Path, *, go: int | None, as_json: bool, folder: Path | None) -> None:
    """Print the ladder of the model at `path`, and draw it into `folder` (None: nowhere); after going to the rung `go`.

    Raises
    ------
    BadInput : there is no ladder, or none that can be read; no such rung.
    OSError : a file cannot be written.
    """
    at = history.history_position(path)
    if go is not None:
        at = history.gone_to(at, go)
    _show(at, as_json=as_json)
    if folder is not None:
        with output.shown(f"pictures of {at.path.name}", quiet=as_json):
            paths = charts.draw(at, folder)
        output.wrote(*paths)


def undo(path: Path, *, as_json: bool) -> None:
    """Put the model at `path` on the parent of its rung.

    Raises
    ------
    BadInput : there is no ladder, or nothing below.
    OSError : a file cannot be written.
    """
    _show(history.undone(history.history_position(path)), as_json=as_json)


def _show(at: HistoryPosition, *, as_json: bool) -> None:
    if not at.ladder.rungs:
        problem = f"it has no ladder: there is no {history.path_beside(at.path).name} beside it"
        raise BadInput(str(at.path), "", problem, "`massline add MODEL EFFECT DATA ...` makes one")
    output.print_answer(lambda: of_ladder(at), lambda: text(at), as_json=as_json)


# The run of `massline model`.


def model(
    article: str,
    out: Path | None,
    *,
    force: bool,
    tests: Sequence[str] = (),
    program: str | None = None,
    units: str | None = None,
) -> None:
    """Print the model file for `article`, or write it to `out`; with `tests` the study of an FE model beside them.

    With a `program` it is the snippet for that program's deck instead (`validation.model.write_back`). Of a deck it is the
    description of its structure, its `units` those of `fem.mesh.deck.described`; with `tests` that is written beside the deck,
    unless it is there, and then their study.

    Raises
    ------
    BadInput : see `draft`; `out` is there already and not to be replaced, or cannot be written.
    OSError : a file cannot be read or written.
    """
    known, lost = None if program is None else write_back.PROGRAMS[program], tuple[str, ...]()
    is_deck = program is None and Path(article).suffix.lower() in DECKS
    if units is not None and not is_deck:
        raise BadInput("--units", "", "only a deck states none itself", "Leave it out")
    if out is not None:
        if known is None:
            output.require_ending(out, (".toml",), "a model file", "model.toml")
        else:
            output.require_ending(out, known.endings, f"a snippet for {known.name}", f"found{known.endings[0]}")
        if out.exists() and not force:
            problem = "it is there already, perhaps with changes of your own"
            raise BadInput(str(out), "--out", problem, "Name another file, or replace it with --force")
        output.require_file(out, "--out")
    if is_deck and tests:
        own = Path(article).with_suffix(".toml")
        if out is None or out.resolve() == own.resolve():
            problem = f"the structure of {article} is described in {own}, and the study is a file beside it"
            raise BadInput("--out", "", problem, "Name the study, as in --out study.toml")
        if own.exists() and units is not None:
            problem = f"the structure is described in {own} already, which states its units"
            raise BadInput("--units", "", problem, "Leave it out, or take the description away")
        if not own.exists():
            text, lost = deck.described(Path(article), units)
            write_text(own, text)
            output.wrote(own)
        model(str(own), out, force=force, tests=tests)
        _require_all(article, lost)
        return
    source = str(out or "model.toml")
    if program is not None:
        text = write_back.written(model_file.read(article), program)
    elif is_deck:
        text, lost = deck.described(Path(article), units)
    elif tests:
        text = model_file.study_text(article, tests, out or Path("study.toml"))
    else:
        drafted = model_file.draft(article, out)
        text, source = model_file.text(drafted), drafted.source
    if program is None and not is_deck:
        model_file.of_text(text, source)
    if out is None:
        click.echo(text, nl=False)
        if (folder := Path(source).parent) != Path():
            click.echo(f"massline: its files are named as from {folder}, where it belongs.", err=True)
    else:
        if is_deck and out.resolve().parent != Path(article).resolve().parent:
            problem = "a description lies beside the deck, whose nodes and elements it needs"
            raise BadInput(str(out), "--out", problem, f"Write it to {Path(article).parent}")
        write_text(out, text)
        output.wrote(out)
    _require_all(article, lost)


def _require_all(deck: str, lost: Sequence[str]) -> None:
    if lost:
        more = f"; and {len(lost) - 5} more" if lost[5:] else ""
        raise CheckFailed(f"{deck}: not carried over: {'; '.join(lost[:5])}{more}")


# `massline diagnose --auto`: diagnose, add what is missing as a rung, and diagnose again, until the rules say stop.
#
# A rung is made by `validation.history.add`, as `massline add` makes it: fitted anew, evaluated on held-out data, kept at
# once. So an interruption loses no rung that was finished, and the next run begins where the model file stands. The rules:
#
#     nothing      is missing any more: done
#     missing, several    every effect that was accepted becomes a rung, and the new model is diagnosed
#     mistake      the mistakes alone become rungs; what there is beside them is for the diagnosis of the new model to say
#     ambiguous    the first of those that cannot be told apart becomes a rung, which says so; only another measurement goes on
#     nonlinear    likewise, and what a linear fit would say beyond that is nonsense
#     unknown      no name is worth a rung; what is named beside what is left is for `massline add`
#     a rung that is not worth a parameter by the ladder's own figures is left again, and ends the climb


MOST_ROUNDS = 6
"""Diagnoses in a row, before something is wrong with the climb itself."""

ENDED = {
    results.NOTHING: "nothing more{asked} is missing at the resolution of these data",
    results.AMBIGUOUS: "these data cannot tell what comes next; the rung takes the first of those that explain them alike",
    results.NONLINEAR: "what depends on the level is no matter of a linear fit",
    results.UNKNOWN: "what is left is explained by no effect that was looked for",
}
"""Why a climb ends, by the last verdict."""

NOT_WORTH = "{effect} is not worth a parameter by the ladder's figures: the model went back to rung {below}"
NO_MORE = "what was found is in the model already"
TOO_LONG = "{rounds} diagnoses in a row found something: look at the ladder before going on"

Diagnose = Callable[[Study], results.Diagnosis]


@dataclass(frozen=True, eq=False, kw_only=True)
class Climb:
    """What came of it.

    Attributes
    ----------
    rounds : the diagnoses, one after the other
    rungs : that were made
    ended : why it ended
    at : where the model stands now
    """

    rounds: tuple[results.Diagnosis, ...]
    rungs: tuple[Version, ...]
    ended: str
    at: HistoryPosition


def climb(
    asked: Options,
    bench: Study,
    diagnose: Diagnose,
    added: Callable[[Version], None] = lambda rung: None,
    progress: Progress = lambda what, share: None,
) -> Climb:
    """Climb the ladder of the model that is `asked`.

    Parameters
    ----------
    bench : of that model
    diagnose : makes the diagnosis of a bench
    added : hears of a rung when it is made
    progress : hears of what is done, and how far

    Raises
    ------
    BadInput : a rung cannot be made, see `validation.history.add.added`.
    CheckFailed : a model that breaks down.
    OSError : the ladder or the model file cannot be written.
    """
    rounds, rungs = [], []
    while True:
        found = diagnose(bench)
        rounds.append(found)
        ended = ENDED.get(found.verdict, "").format(asked=results.asked(found))
        more = new(found, bench.model)
        for cause in more:
            others = [id for id in found.equivalence_class if id != cause.id] if cause.id in found.equivalence_class else []
            remarks = (f"These data cannot tell it from {' or '.join(others)}.",) if others else ()
            effect = adding.AddedEffectOptions(effect=str(cause.named), remarks=remarks)
            step = adding.added(bench, effect, lambda what, share, id=cause.id: progress(f"adding {id}: {what}", share))  # type: ignore[misc]
            rung = step.after
            if not is_worth_adding(rung) and rung.gain is not None:
                undone(history_position(asked.path))
                ended = NOT_WORTH.format(effect=cause.id, below=step.before.number)
                break
            rungs.append(rung)
            added(rung)
        if not ended and (not more or len(rounds) >= MOST_ROUNDS):
            ended = TOO_LONG.format(rounds=len(rounds)) if more else NO_MORE
        if ended:
            return Climb(rounds=tuple(rounds), rungs=tuple(rungs), ended=ended, at=history_position(asked.path))
        bench = bench.by(model_file.read(asked.model))


def new(found: results.Diagnosis, model: Model) -> tuple[results.Cause, ...]:
    """What becomes a rung: accepted, and not in `model` yet; of an unknown one nothing: what is named is for `massline add`."""
    if found.verdict == results.UNKNOWN:
        return ()
    known = {one.named.id for one in model.effects}
    more = tuple(one for one in found.accepted if one.id not in known)
    wrong = tuple(one for one in more if FAMILIES[one.named.family].side == OF_MISTAKES)
    return wrong if found.verdict == results.MISTAKE and wrong else more
