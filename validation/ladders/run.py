"""`massline add`, `massline ladder` and `massline undo` from options to output."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import click

from geometry.errors import BadInput
from validation.comparing.asked import require_band
from validation.comparing.compared import meant
from validation.comparing.gathered import Data, gathered
from validation.effects import catalogue
from validation.effects.targets import Vocabulary
from validation.engine.problem import Problem
from validation.identifying.known import above_fmd
from validation.ladders import as_json as written
from validation.ladders import candidate as candidates
from validation.ladders import file, sources, table
from validation.ladders.candidate import Candidate
from validation.ladders.climbing import Standing, climbed, gone_to, kept, next_rung, standing, undone
from validation.ladders.judging import Bench, Judged, judged, rewritten, rung_with
from validation.ladders.nouns import ADDED, OTHER_DATA, Conditions, Rung
from validation.ladders.verdict import verdict
from validation.models import reading
from validation.models.model import Model
from validation.output import json_text
from validation.prediction.facts import facts
from validation.prediction.series import SeriesPrediction, predictions
from validation.progress import shown, stages
from validation.tables.text import page

Progress = Callable[[str, float], None]


@dataclass(frozen=True, kw_only=True)
class Asked:
    """The options of `massline add` as typed; None where the ladder's own are meant.

    Attributes
    ----------
    model, effect : path and ``ID[=VALUE]``
    data : campaign folders and measurement files; none for those that the ladder knows
    hold_out, band, method : as of `massline compare`
    effects_from : folders of the user's own effects
    fixed : whether the effect stays at its size
    alias_ok : whether an exact alias of what the model has may be added
    """

    model: Path
    effect: str
    data: tuple[str, ...] = ()
    hold_out: tuple[str, ...] = ()
    band: tuple[float, float] | None = None
    method: str | None = None
    effects_from: tuple[str, ...] = ()
    fixed: bool = False
    alias_ok: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class Step:
    """What adding an effect came to."""

    at: Standing
    before: Rung
    after: Rung
    said: tuple[str, ...]


def add(asked: Asked, *, as_json: bool) -> None:
    """Add what is `asked`, and print the errors before and after.

    Raises
    ------
    BadInput : something that was asked cannot be used.
    CheckFailed : a fit of the model as it was does not converge.
    """
    with stages(f"adding {asked.effect}", quiet=as_json) as told:
        step = added(asked, told)
    if as_json:
        click.echo(json_text(written.of_step(step.at, step.before, step.after, step.said)))
        return
    title = f"{asked.model.name}: {step.after.effect} added, rung {step.after.number} on rung {step.before.number}"
    click.echo(page(title, table.of_step(step.before, step.after), (*step.after.verdict, *map(_sentence, step.said))), nl=False)


def added(asked: Asked, progress: Progress | None = None) -> Step:
    """The rung that `asked` leads to, written; the rung below it is evaluated and kept first where it was not yet.

    Raises
    ------
    BadInput, CheckFailed : see `add`.
    """
    tell = progress or (lambda what, share: None)
    require_band(asked.band)
    for folder in asked.effects_from:
        catalogue.load(folder)
    at = standing(asked.model)
    model = reading.of_text(at.text, str(at.path))
    paths = _paths(asked, at)
    data = gathered(paths, model, tell)
    conditions, said = _conditions(asked, at, paths)
    effect, left = candidates.read(asked.effect, model, _words(data), fixed=asked.fixed)
    rewritten(at.text, (effect,), str(at.path))  # a layout that cannot be changed is refused before minutes are spent
    bench = _bench(model, data, conditions, lambda share: tell("spectra", share))
    tell("looking for aliases", 0.0)
    chosen = candidates.candidate(effect, left, model, bench.problem, allowed=asked.alias_ok)
    at, known = grounded(at, model, bench, conditions, tell)
    before = _rung_of(at)
    after = judged(bench, replace(model, effects=(*model.effects, chosen.added)), before, tell)
    rung = _next(at, before, after, chosen, asked)
    there = climbed(at, rung)
    words = (*said, *known, *chosen.said, *table.conditions(there))
    return Step(at=there, before=before, after=there.ladder.rungs[-1], said=words)


def grounded(
    at: Standing, model: Model, bench: Bench, conditions: Conditions, progress: Progress
) -> tuple[Standing, tuple[str, ...]]:
    """`at` on a rung that stands on `conditions`, evaluated and kept at once where there was none, and what is to be said."""
    if at.rung is not None and at.rung.stands_on(conditions):
        return at, ()
    if at.rung is None or at.rung.errors is None:
        rung, said = next_rung(at), (f"{at.path.name} was edited by hand: that is a rung of its own",) if at.edited else ()
    else:
        rung = Rung(number=len(at.ladder.rungs), parent=at.rung.number, cause=OTHER_DATA, model=at.text)
        said = (f"rung {at.rung.number} stands on other data or settings: the model is held against these first",)
    found = judged(bench, model, None, lambda what, share: progress(f"the model before: {what}", share))
    return kept(at, replace(rung_with(rung, found), conditions=conditions, settings=_settings(model))), said


def _rung_of(at: Standing) -> Rung:
    if at.rung is None:
        problem = "it was changed while it was evaluated"
        raise BadInput(source=str(at.path), problem=problem, remedy="Nothing is lost: give the command again")
    return at.rung


def _next(at: Standing, before: Rung, of: Judged, chosen: Candidate, asked: Asked) -> Rung:
    """The rung of the effect that was added, with its verdict."""
    text = rewritten(at.text, of.model.effects, str(at.path))
    bare = Rung(
        number=len(at.ladder.rungs),
        parent=before.number,
        cause=ADDED,
        effect=chosen.added.named.id,
        model=text,
        conditions=before.conditions,
        settings={**_settings(of.model), **_said_of(asked, chosen)},
    )
    rung = rung_with(bare, of)
    old, new = before.errors, rung.errors
    gain = new.log_evidence - old.log_evidence if old is not None and new is not None else None
    rung = replace(rung, gain=gain)
    told = verdict(before, rung, chosen.tolerances, chosen.nulls)
    return replace(rung, verdict=(*told, *(_sentence(one) for one in chosen.said)))


def _settings(model: Model) -> dict[str, object]:
    return {"article": model.article, "kind": model.kind}


def _said_of(asked: Asked, chosen: Candidate) -> dict[str, object]:
    alias = chosen.alias
    return {
        "asked": asked.effect,
        "fixed": chosen.added.fixed,
        "effects_from": list(asked.effects_from),
        "alias": None if alias is None else {"text": alias.text, "mixture": dict(alias.mixture), "size": alias.size},
    }


def _paths(asked: Asked, at: Standing) -> tuple[str, ...]:
    """Where the data are: as named, else where the ladder knows them."""
    below = _with_data(at)
    if asked.data or below is None:
        _require_data(asked)
        return asked.data
    return sources.paths(below.conditions, at.path.parent, str(file.beside(at.path)))


def _require_data(asked: Asked) -> None:
    if not asked.data:
        problem = "there is no data: the model has no ladder yet that knows any"
        raise BadInput(source="DATA", problem=problem, remedy="Name campaign folders behind EFFECT")


def _conditions(asked: Asked, at: Standing, paths: tuple[str, ...]) -> tuple[Conditions, tuple[str, ...]]:
    """What is held against what: as asked, else as in the rung below where the data are its own; and what is to be said."""
    below = _with_data(at)
    known = Conditions() if below is None else below.conditions
    like = Conditions() if asked.data else known
    now = Conditions(
        data=sources.sources(paths, at.path.parent),
        hold_out=asked.hold_out or like.hold_out,
        band=asked.band or like.band,
        method=asked.method or like.method,
    )
    return now, sources.changed(known, now)


def _with_data(at: Standing) -> Rung | None:
    """The nearest rung downwards that was held against data."""
    below = at.below
    path = () if below is None else at.ladder.path(below.number)
    return next((one for one in reversed(path) if one.conditions.data), None)


def _words(data: Data) -> Vocabulary:
    """Channels of these campaigns; places and parts are those of whatever article, as in a model file."""
    channels = [channel for campaign in data.campaigns for channel in campaign.table.channels]
    accelerometers = [one.name for one in channels if one.quantity == "acceleration"]
    forces = [one.name for one in channels if one.quantity != "acceleration"]
    return Vocabulary(accelerometers=tuple(dict.fromkeys(accelerometers)), forces=tuple(dict.fromkeys(forces)), places=None)


def _bench(model: Model, data: Data, conditions: Conditions, progress: Callable[[float], None]) -> Bench:
    made = predictions(
        replace(model, effects=()), data.campaigns, band=conditions.band, method=conditions.method, progress=progress
    )

    def problem(of: Model) -> Problem:
        return Problem(tuple(one.with_effects(of.effects) for one in made), facts(of, data.classical))

    return Bench(problem=problem, hold_out=meant(problem(model), data, conditions.hold_out), article=_article(model, made))


def _article(model: Model, made: tuple[SeriesPrediction, ...]) -> str:
    """Whose inertia is identified: the model's own article where it was tested, else the first that stood on the FMD."""
    tested = [one.tested.carried.standing.article for one in made]
    own = above_fmd(model.article)
    return own if own in tested else next((one for one in tested if one), "")


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:].rstrip('.')}."


def ladder(path: Path, *, go: int | None, as_json: bool, folder: Path | None) -> None:
    """Print the ladder of the model at `path`, and draw it into `folder` (None: nowhere); after going to the rung `go`.

    Raises
    ------
    BadInput : there is no ladder, or none that can be read; no such rung.
    OSError : a file cannot be written.
    """
    at = standing(path)
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
    _show(undone(standing(path)), as_json=as_json)


def _show(at: Standing, *, as_json: bool) -> None:
    if not at.ladder.rungs:
        problem = f"it has no ladder: there is no {file.beside(at.path).name} beside it"
        raise BadInput(source=str(at.path), problem=problem, remedy="`massline add MODEL EFFECT DATA ...` makes one")
    if as_json:
        click.echo(json_text(written.of_ladder(at)))
        return
    rungs = f"{len(at.ladder.rungs)} rung{'s' if len(at.ladder.rungs) > 1 else ''}"
    where = "edited by hand since" if at.rung is None else f"it stands on rung {at.rung.number}"
    click.echo(page(f"{at.path.name}: {rungs}, {where}", table.of_ladder(at), table.notes(at)), nl=False)


def _draw(at: Standing, folder: Path, *, quiet: bool) -> None:
    from validation.ladders.drawn import draw

    with shown(f"pictures of {at.path.name}", quiet=quiet):
        paths = draw(at, folder)
    for path in paths:
        click.echo(f"massline: wrote {path}.", err=True)
