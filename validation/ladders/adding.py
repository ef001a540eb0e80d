"""From what `massline add` was asked to the rung that is written: data gathered, the effect checked, both models evaluated.

The rung of the model before is kept as soon as it is evaluated, so that an interruption of the fit behind it loses nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from geometry.atomic import probe
from geometry.errors import BadInput, CheckFailed
from validation.comparing.asked import require_band
from validation.comparing.compared import meant
from validation.comparing.gathered import Data, gathered
from validation.effects import catalogue
from validation.effects.catalogue import FAMILIES
from validation.effects.family import MISTAKE
from validation.effects.targets import Vocabulary
from validation.engine.hold_out import named, without
from validation.engine.problem import Problem
from validation.identifying.known import above_fmd
from validation.ladders import candidate as candidates
from validation.ladders import file, sources, table
from validation.ladders.beginning import begun
from validation.ladders.candidate import Candidate
from validation.ladders.climbing import Standing, climbed, kept, next_rung, standing
from validation.ladders.judging import Bench, Judged, judged, rewritten, rung_with
from validation.ladders.nouns import ADDED, OTHER_DATA, Conditions, Rung
from validation.ladders.own_effects import reminded
from validation.ladders.verdict import sentence, verdict
from validation.models import reading
from validation.models.model import Model
from validation.prediction.bodies import require_bodies
from validation.prediction.facts import facts
from validation.prediction.series import SeriesPrediction, predictions

Progress = Callable[[str, float], None]


ALONE = "Without it no fit of these data converges, so that its errors have none to be held against."
"""Of a rung above one without figures."""


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
    remarks : sentences that the rung's verdict ends with, of whoever asks for it
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
    remarks: Sequence[str] = ()


@dataclass(frozen=True, eq=False, kw_only=True)
class Step:
    """What adding an effect came to."""

    at: Standing
    before: Rung
    after: Rung
    said: tuple[str, ...]


def added(asked: Asked, progress: Progress | None = None) -> Step:
    """The rung that `asked` leads to, written; the rung below it is evaluated and kept first where it was not yet.

    Raises
    ------
    BadInput, CheckFailed : see `add`.
    """
    tell = progress or (lambda what, share: None)
    require_band(asked.band)
    if asked.model.is_file():
        probe(asked.model)  # what cannot be written at the end is said before minutes are spent
    for folder in asked.effects_from:
        catalogue.load(folder)
    at = standing(asked.model)
    with reminded(at.path):
        model = reading.of_text(at.text, str(at.path))
    paths = _paths(asked, at)
    data = gathered(paths, model, tell)
    conditions, said = _conditions(asked, at, paths)
    effect, left = candidates.read(asked.effect, model, _words(data), fixed=asked.fixed)
    require_bodies(replace(model, effects=(*model.effects, effect)), data.campaigns)
    rewritten(at.text, (effect,), str(at.path))  # a layout that cannot be changed is refused before minutes are spent
    bench = bench_of(model, data, conditions, lambda share: tell("spectra", share))
    conditions = replace(conditions, hold_out=bench.hold_out)  # names that mean the same from whatever folder
    tell("looking for aliases", 0.0)
    chosen = candidates.candidate(effect, left, model, bench.problem, allowed=asked.alias_ok)
    at, known = _grounded(at, model, bench, conditions, tell, chosen)
    before = _rung_of(at)
    chosen = _begun(chosen, model, bench, before, tell)
    parent = before if before.errors is not None else None
    after = judged(bench, replace(model, effects=(*model.effects, chosen.added)), parent, tell)
    rung = _next(at, before, after, chosen, asked, conditions)
    there = climbed(at, rung)
    new = next(one for one in reversed(there.ladder.rungs) if one.model == rung.model)
    said = (*said, *bench.remarks, *known, *_left_alone(there, new), *table.conditions(there))
    return Step(at=there, before=before, after=new, said=said)


def _left_alone(at: Standing, new: Rung) -> tuple[str, ...]:
    """Said of a model file that somebody changed while the fit ran."""
    if at.rung is not None and at.rung.number == new.number:
        return ()
    return (f"{at.path.name} was changed while the fit ran and is left as it is; `--go {new.number}` goes to the new rung",)


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


def _grounded(
    at: Standing, model: Model, bench: Bench, conditions: Conditions, progress: Progress, chosen: Candidate
) -> tuple[Standing, tuple[str, ...]]:
    """As `grounded`; where a mistake is to be taken out of data that nothing fits with it, the rung below has no figures."""
    try:
        return grounded(at, model, bench, conditions, progress)
    except CheckFailed as failed:
        if FAMILIES[chosen.added.named.family].side != MISTAKE or (at.rung is not None and at.rung.errors is not None):
            raise
        waiting = kept(at, replace(next_rung(at), settings=_settings(model)))
        return waiting, (f"the model before cannot be fitted to these data, and its rung has no figures: {failed}",)


def _begun(chosen: Candidate, model: Model, bench: Bench, before: Rung, progress: Progress) -> Candidate:
    """`chosen` with the sizes at which its fit begins; data that are held out do not say where."""
    problem = bench.problem(replace(model, effects=(*model.effects, chosen.added))).thinned()
    known = without(problem, named(problem, bench.hold_out)) if bench.hold_out else problem
    at = begun(chosen.added, chosen.left, known, before.plain_offsets, lambda share: progress("looking where it is", share))
    return replace(chosen, added=at)


def _rung_of(at: Standing) -> Rung:
    if at.rung is None:
        problem = "it was changed while it was evaluated"
        raise BadInput(source=str(at.path), problem=problem, remedy="Nothing is lost: give the command again")
    return at.rung


def _next(at: Standing, before: Rung, of: Judged, chosen: Candidate, asked: Asked, conditions: Conditions) -> Rung:
    """The rung of the effect that was added, with its verdict."""
    text = rewritten(at.text, of.model.effects, str(at.path))
    bare = Rung(
        number=len(at.ladder.rungs),
        parent=before.number,
        cause=ADDED,
        effect=chosen.added.named.id,
        model=text,
        conditions=conditions,
        settings={**_settings(of.model), **_said_of(asked, chosen)},
    )
    rung = rung_with(bare, of)
    old, new = before.errors, rung.errors
    gain = new.log_evidence - old.log_evidence if old is not None and new is not None else None
    rung = replace(rung, gain=gain)
    told = verdict(before, rung, chosen.tolerances, chosen.nulls) or (ALONE,)
    return replace(rung, verdict=(*told, *(sentence(one) for one in (*chosen.said, *asked.remarks))))


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


def bench_of(model: Model, data: Data, conditions: Conditions, progress: Callable[[float], None]) -> Bench:
    """`data` ready for `model` with any effects, as a rung that stands on `conditions` wants them."""
    made = predictions(
        replace(model, effects=()), data.campaigns, band=conditions.band, method=conditions.method, progress=progress
    )

    def problem(of: Model) -> Problem:
        return Problem(tuple(one.with_effects(of.effects) for one in made), facts(of, data.classical))

    hold_out = meant(problem(model), data, conditions.hold_out)
    left_out = tuple(text for one in made for text in one.tested.remarks)
    return Bench(problem=problem, hold_out=hold_out, article=_article(model, made), remarks=left_out)


def _article(model: Model, made: tuple[SeriesPrediction, ...]) -> str:
    """Whose inertia is identified: the model's own article where it was tested, else the first that stood on the FMD."""
    tested = [one.tested.carried.standing.article for one in made]
    own = above_fmd(model.article)
    return own if own in tested else next((one for one in tested if one), "")
