"""`massline add`, `massline ladder` and `massline undo` from options to output."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from geometry.atomic import write_text
from geometry.errors import BadInput
from geometry.frames import Array
from identification.quality import NORMAL_90
from validation.history import history
from validation.history.history import (
    SHOWN,
    Body,
    Errors,
    HistoryPosition,
    Version,
    VersionSize,
    conditions,
    gone_to,
    history_position,
    is_worth_adding,
    percent,
    undone,
    unit,
)
from validation.model import model_file
from validation.model.model_file import draft
from validation.output import json_text, require_ending, require_file, shown, stages, to_json
from validation.reference.statement import NONE, QUANTITIES, rounded
from validation.report.document import Column, Figures, Grid, Safe, Table, aligned, joined, page, tag
from validation.report.parts import Report, error_figures, error_lines, paragraphs, section
from validation.report.parts import notes as parts_notes

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
        "errors": to_json(one.errors),
        "evidence_gain_nats": to_json(one.gain),
        "inertia": [_body(body) for body in one.bodies],
        "verdict": list(one.verdict),
        "worth_a_parameter": is_worth_adding(one) if one.effect else None,
        "data": [source.path for source in one.conditions.data],
        "when": one.when,
    }


def of_step(at: HistoryPosition, before: Version, after: Version, said: Sequence[str]) -> dict[str, Any]:
    """What adding an effect did; `said` is what was warned of."""
    return {
        "model": str(at.path),
        "ladder": str(history.path_beside(at.path)),
        "rung": after.number,
        "parent": before.number,
        "effect": effect(after, after.effect),
        "errors": _both(before.errors, after.errors),
        "evidence_gain_nats": to_json(after.gain),
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
        "evidence_nats": to_json(one.gain) if name == one.effect else None,
        "text": " ".join(one.verdict) if name == one.effect else "",
        "values": {size.key: {"value": size.value, "unit": size.unit, "interval90": _interval(size)} for size in sizes},
    }


def _interval(size: VersionSize) -> list[float] | None:
    if size.deviation is None:
        return None
    half = NORMAL_90 * size.deviation
    return [size.value - half, size.value + half]


def _both(before: Errors | None, after: Errors | None) -> dict[str, Any]:
    return {
        "plain_before_percent": None if before is None else before.plain,
        "plain_after_percent": None if after is None else after.plain,
        "heldout_before_percent": None if before is None else before.held_out,
        "heldout_after_percent": None if after is None else after.held_out,
    }


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


# The pages of `massline add`, `massline ladder` and `massline undo`.


HERE, NOT_HERE = "→ ", "  "
"""Before the rung on which the model stands, and before the others."""

UNKEPT = "plain error, a configuration never seen"
"""An error that versions do not keep."""


def ladder_of_step(before: Version, after: Version) -> list[Grid]:
    """The four errors before and after, the sizes of all effects, and how far each article is from its reference."""
    return [_errors(before, after), *_sizes(after), *(_distance(before, after, body) for body in after.bodies)]


def _errors(before: Version, after: Version) -> Grid:
    lines = [one for one in error_lines(before.errors, after.errors) if one[0] != UNKEPT]
    gain = ("evidence gained", "", NONE if after.gain is None else f"{after.gain:+.1f} nats")
    columns = [aligned(tuple(column)) for column in zip(*(cells for _, cells in lines), gain[1:], strict=True)]
    names = (*(name for name, _ in lines), gain[0])
    return Grid(header=("", f"rung {before.number}", f"rung {after.number}"), lines=tuple(zip(names, *columns, strict=True)))


def _sizes(rung: Version) -> list[Grid]:
    lines = tuple(line for name, sizes in rung.effects.items() for line in _lines(name, sizes))
    cells = aligned(tuple(cell for _, cell in lines))
    named = tuple((name, cell) for (name, _), cell in zip(lines, cells, strict=True))
    return [Grid(header=("effects of the model", "size ± one standard deviation"), lines=named)] if named else []


def _lines(name: str, sizes: Sequence[VersionSize]) -> list[tuple[str, str]]:
    """A line a size; one that says that there is none, of an effect that is there or not."""
    return [(_label(name, size), _size(size)) for size in sizes] or [(name, NONE)]


def _label(name: str, size: VersionSize) -> str:
    return f"{name} {size.key}".rstrip()


def _size(size: VersionSize) -> str:
    spread = "" if size.deviation is None else f" ± {size.deviation:.2g}"
    return f"{size.value:.5g}{spread}{unit(size.unit)}"


def _distance(before: Version, after: Version, body: Body) -> Grid:
    earlier = next((one for one in before.bodies if one.article == body.article), None)
    rungs = [(before, earlier), (after, body)] if earlier is not None else [(after, body)]
    return distances(body.article, [(one.number, of) for one, of in rungs if of is not None])


def distances(article: str, bodies: Sequence[tuple[int, Body]]) -> Grid:
    """How far the identified inertia of `article` lies from the model's, rung by rung: in mm or per cent, and in sigmas."""
    header = ["identified - reference"]
    columns: list[tuple[str, ...]] = [tuple(quantity.label for quantity in QUANTITIES)]
    for rung, body in bodies:
        header += [f"{article}, rung {rung}", "σ"]
        columns.append(aligned(tuple(f"{one:+.3g} {name}" for one, name in zip(body.shown, SHOWN, strict=True))))
        columns.append(aligned(tuple(f"{one:+.1f}" for one in body.sigmas)))
    return Grid(header=tuple(header), lines=tuple(zip(*columns, strict=True)))


def values(article: str, bodies: Sequence[tuple[int, Body]]) -> Grid:
    """The identified inertia of `article` rung by rung with its 95 % intervals, and the model's own on the last."""
    header = ["identified ± 95 %"]
    columns: list[tuple[str, ...]] = [tuple(f"{quantity.label} [{quantity.unit}]" for quantity in QUANTITIES)]
    for rung, body in bodies:
        header.append(f"{article}, rung {rung}")
        columns.append(aligned(tuple(_value(body, k) for k in range(len(QUANTITIES)))))
    header.append("reference")
    last = bodies[-1][1]
    columns.append(aligned(tuple(rounded(*_printed(last.reference, last.half_width, k)) for k in range(len(QUANTITIES)))))
    return Grid(header=tuple(header), lines=tuple(zip(*columns, strict=True)))


def _value(body: Body, k: int) -> str:
    value, half = _printed(body.values, body.half_width, k)
    return f"{rounded(value, half)} ± {rounded(half, half)}"


def _printed(values: Array, half_width: Array, k: int) -> tuple[float, float]:
    """One of the ten and half of its interval in the unit in which both are printed."""
    return float(values[k]) * QUANTITIES[k].per_si, float(half_width[k]) * QUANTITIES[k].per_si


def ladder_of_ladder(at: HistoryPosition) -> list[Grid]:
    """All rungs as a tree, and of every article what was identified and its way to the reference along the rungs to here."""
    return [_tree(at), *_way(at)]


def _tree(at: HistoryPosition) -> Grid:
    here = None if at.rung is None else at.rung.number
    rows = [(_place(one, branch, here), *_figures(one)) for branch, one in at.ladder.tree()]
    columns = list(zip(*rows, strict=True))
    header = ("  rung", "size", "nominal", "plain", "held out", "chi²/dof", "sum z²", "evidence")
    shown = [columns[0], *(aligned(column) for column in columns[1:])]
    return Grid(header=header, lines=tuple(zip(*shown, strict=True)))


def _place(one: Version, branch: str, here: int | None) -> str:
    return f"{HERE if one.number == here else NOT_HERE}{branch}{one.number} {one.title}"


def _figures(one: Version) -> tuple[str, ...]:
    sizes = one.effects.get(one.effect, ())
    size = _size(sizes[0]) if len(sizes) == 1 else ", ".join(f"{each.key} {each.value:.4g}" for each in sizes) or NONE
    return (size, *_told(one.errors), NONE if one.gain is None else f"{one.gain:+.1f}")


def _told(errors: Errors | None) -> tuple[str, ...]:
    if errors is None:
        return (NONE,) * 5
    percents = [percent(value) for value in (errors.nominal, errors.plain, errors.held_out)]
    return (*percents, f"{errors.chi2_per_dof:.3g}", _price(errors))


def _price(errors: Errors) -> str:
    return f"{errors.tolerance_z2:.3g} of {errors.due_z2:.0f}"


def _way(at: HistoryPosition) -> list[Grid]:
    below = at.below
    path = () if below is None else at.ladder.path(below.number)
    articles = dict.fromkeys(body.article for one in path for body in one.bodies)
    found = []
    for article in articles:
        bodies = [(one.number, body) for one in path for body in one.bodies if body.article == article]
        found += [values(article, bodies), distances(article, bodies)]
    return found


def notes(at: HistoryPosition) -> Iterator[str]:
    """What must be known to read the tables, and what is odd."""
    yield "Nominal: as it stands. Plain: tolerances of the measurement not fitted. Per cent of the force read. Evidence in nats."
    yield "Sum z²: of the tolerances, all fitted, and what is due where nothing is wrong."
    yield "Identified: CoG from the article's own origin, moments and products about it. Reference: the model with its effects."
    yield "Less reference: mass, moments in per cent, products in per cent of √(Θii Θjj), CoG in mm; σ: one standard deviation."
    yield from conditions(at)


def add(asked: Options, effect: AddedEffectOptions, *, as_json: bool) -> None:
    """Add an `effect` to the model that is `asked`, and print the errors before and after.

    Raises
    ------
    BadInput : something that was asked cannot be used.
    CheckFailed : a fit of the model as it was does not converge.
    """
    from validation.history.add import added, opened
    from validation.history.history import sentence

    with stages(f"adding {effect.effect}", quiet=as_json) as told:
        study, known = opened(asked, effect, told)
        step = added(study, effect, told)
    said = (*known, *step.said)
    if as_json:
        click.echo(json_text(of_step(step.at, step.before, step.after, said)))
        return
    title = f"{asked.path.name}: {step.after.effect} added, rung {step.after.number} on rung {step.before.number}"
    click.echo(page(title, ladder_of_step(step.before, step.after), (*step.after.verdict, *map(sentence, said))), nl=False)


def ladder(path: Path, *, go: int | None, as_json: bool, folder: Path | None) -> None:
    """Print the ladder of the model at `path`, and draw it into `folder` (None: nowhere); after going to the rung `go`.

    Raises
    ------
    BadInput : there is no ladder, or none that can be read; no such rung.
    OSError : a file cannot be written.
    """
    at = history_position(path)
    if go is not None:
        at = gone_to(at, go)
    _show(at, as_json=as_json)
    if folder is not None:
        _draw(at, folder, quiet=as_json)


def undo(path: Path, *, as_json: bool) -> None:
    """Put the model at `path` on the parent of its rung.

    Raises
    ------
    BadInput : there is no ladder, or nothing below.
    OSError : a file cannot be written.
    """
    _show(undone(history_position(path)), as_json=as_json)


def _show(at: HistoryPosition, *, as_json: bool) -> None:
    if not at.ladder.rungs:
        problem = f"it has no ladder: there is no {history.path_beside(at.path).name} beside it"
        raise BadInput(source=str(at.path), problem=problem, remedy="`massline add MODEL EFFECT DATA ...` makes one")
    click.echo(json_text(of_ladder(at)) if as_json else text(at), nl=as_json)


def text(at: HistoryPosition) -> str:
    """The page of a ladder."""
    rungs = f"{len(at.ladder.rungs)} rung{'s' if len(at.ladder.rungs) > 1 else ''}"
    where = "edited by hand since" if at.rung is None else f"it stands on rung {at.rung.number}"
    return page(f"{at.path.name}: {rungs}, {where}", ladder_of_ladder(at), notes(at))


def _draw(at: HistoryPosition, folder: Path, *, quiet: bool) -> None:
    from validation.report.charts.history import draw

    with shown(f"pictures of {at.path.name}", quiet=quiet):
        paths = draw(at, folder)
    for path in paths:
        click.echo(f"massline: wrote {path}.", err=True)


# The run of `massline model`.


def model(article: str, out: Path | None, *, force: bool) -> None:
    """Print the model file for `article`, or write it to `out`.

    Raises
    ------
    BadInput : see `draft`; `out` is there already and not to be replaced, or cannot be written.
    OSError : a file cannot be read or written.
    """
    if out is not None:
        _require_free(out, force=force)
    text = model_file.text(draft(article, out))
    model_file.of_text(text, str(out or "model.toml"))
    if out is None:
        click.echo(text, nl=False)
        return
    write_text(out, text)
    click.echo(f"massline: wrote {out}.", err=True)


def _require_free(out: Path, *, force: bool) -> None:
    require_ending(out, (".toml",), "a model file", "model.toml")
    if out.exists() and not force:
        problem = "it is there already, perhaps with changes of your own"
        raise BadInput(source=str(out), field="--out", problem=problem, remedy="Name another file, or replace it with --force")
    require_file(out, "--out")


# The ladder: every version of the model, how its errors fell, and how identified inertia moved.


NONE_YET = "The model has no ladder yet: `massline add MODEL EFFECT DATA ...` adds an effect, fits it and keeps both versions."


def html(report: Report, figures: Figures) -> Safe:
    """The section."""
    at = report.standing
    if at is None or not any(one.errors for one in at.ladder.rungs):
        return section("ladder", "The ladder", paragraphs([NONE_YET]))
    from validation.report.charts.history import falling_errors

    return section(
        "ladder",
        "The ladder",
        figures.placed(falling_errors(at), "Strong: the way to the rung on which the model stands. Open circles: branches."),
        _rungs(at),
        *_inertia(at, figures),
        *(_verdict(one) for one in at.ladder.rungs if one.verdict),
        parts_notes(notes(at)),
    )


def _rungs(at: HistoryPosition) -> Safe:
    here = None if at.rung is None else at.rung.number
    columns = (
        Column("rung", lambda row: f"{row[0].number} (here)" if row[0].number == here else f"{row[0].number}", words=True),
        Column("from", lambda row: "" if row[0].parent is None else f"{row[0].parent}", words=True),
        Column("what changed", lambda row: row[0].title, words=True),
        Column("nominal", lambda row: row[1]["nominal"], unit="%"),
        Column("plain", lambda row: row[1]["plain"], unit="%"),
        Column("held out", lambda row: row[1]["held_out"], unit="%"),
        Column("χ² per dof", lambda row: row[1]["chi2_per_dof"]),
        Column("sum z²", lambda row: row[1]["tolerance_z2"]),
        Column("due", lambda row: row[1]["due_z2"]),
        Column("evidence", lambda row: row[0].gain, "+.1f", unit="nats"),
        Column("when", lambda row: row[0].when.replace("T", " ")[:16], words=True),
    )
    return Table(caption="Rungs", columns=columns, rows=[(one, error_figures(one.errors)) for one in at.ladder.rungs]).html()


def _inertia(at: HistoryPosition, figures: Figures) -> list[Safe]:
    """How identified inertia moved along the way, article by article."""
    from validation.report.charts.history import identified_inertia, way_to

    found = []
    way = way_to(at)
    for article in dict.fromkeys(body.article for one in way for body in one.bodies):
        bodies = {f"{one.number} {one.title}": body for one in way for body in one.bodies if body.article == article}
        found.append(
            figures.placed(identified_inertia(bodies, f"{article}: identified less the model of each rung, 95 % intervals"))
        )
    return found


def _verdict(one: Version) -> Safe:
    return joined(tag("p", tag("strong", f"Rung {one.number}, {one.title}: "), " ".join(one.verdict)))
