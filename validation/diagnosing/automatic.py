"""`massline diagnose --auto`: diagnose, add what is missing as a rung, and diagnose again, until the rules say stop.

A rung is made by `validation.ladders.adding`, as `massline add` makes it: fitted anew, evaluated on held-out data, kept at once.
So an interruption loses no rung that was finished, and the next run begins where the model file stands. The rules:

    nothing      is missing any more: done
    missing, several    every effect that was accepted becomes a rung, and the new model is diagnosed
    mistake      the mistakes alone become rungs; what there is beside them is for the diagnosis of the new model to say
    ambiguous    the first of those that cannot be told apart becomes a rung, which says so; only another measurement goes on
    nonlinear    likewise, and what a linear fit would say beyond that is nonsense
    unknown      no name is worth a rung
    a rung that is not worth a parameter by the ladder's own figures is left again, and ends the climb
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from validation.diagnosing.as_json import effect
from validation.diagnosing.asked import Asked
from validation.diagnosing.bench import Bench
from validation.diagnosing.diagnosis import AMBIGUOUS, MISTAKE, NONLINEAR, NOTHING, UNKNOWN, Cause, Diagnosis
from validation.diagnosing.words import asked as asked_for
from validation.diagnosing.words import headline
from validation.effects.catalogue import FAMILIES
from validation.effects.family import MISTAKE as OF_MISTAKES
from validation.ladders import adding
from validation.ladders.as_json import of_ladder
from validation.ladders.climbing import Standing, standing, undone
from validation.ladders.nouns import Rung
from validation.ladders.verdict import worth
from validation.models import reading
from validation.models.model import Model

MOST_ROUNDS = 6
"""Diagnoses in a row, before something is wrong with the climb itself."""

ENDED = {
    NOTHING: "nothing more{asked} is missing at the resolution of these data",
    AMBIGUOUS: "these data cannot tell what comes next; the rung takes the first of those that explain them alike",
    NONLINEAR: "what depends on the level is no matter of a linear fit",
    UNKNOWN: "what is left is explained by no effect that was looked for",
}
"""Why a climb ends, by the last verdict."""

NOT_WORTH = "{effect} is not worth a parameter by the ladder's figures: the model went back to rung {below}"
NO_MORE = "what was found is in the model already"
TOO_LONG = "{rounds} diagnoses in a row found something: look at the ladder before going on"

Progress = Callable[[str, float], None]
Diagnose = Callable[[Bench], Diagnosis]


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

    rounds: tuple[Diagnosis, ...]
    rungs: tuple[Rung, ...]
    ended: str
    at: Standing


@dataclass(frozen=True, eq=False, kw_only=True)
class Heard:
    """Who hears of what is finished: a diagnosis, a rung, and how far the work is."""

    diagnosed: Callable[[Diagnosis], None] = lambda found: None
    added: Callable[[Rung], None] = lambda rung: None
    progress: Progress = lambda what, share: None


def climb(asked: Asked, bench: Bench, diagnose: Diagnose, heard: Heard | None = None) -> Climb:
    """Climb the ladder of the model that is `asked`.

    Parameters
    ----------
    bench : of that model
    diagnose : makes the diagnosis of a bench

    Raises
    ------
    BadInput : a rung cannot be made, see `validation.ladders.adding.added`.
    CheckFailed : a baseline does not converge.
    OSError : the ladder or the model file cannot be written.
    """
    told, rounds, rungs = heard or Heard(), [], []
    while True:
        found = diagnose(bench)
        rounds.append(found)
        told.diagnosed(found)
        ended = ENDED.get(found.verdict, "").format(asked=asked_for(found))
        more = new(found, bench.model)
        for cause in more:
            rung, below = _added(asked, cause, found, told.progress)
            if not worth(rung) and rung.gain is not None:
                undone(standing(asked.model))
                ended = NOT_WORTH.format(effect=cause.id, below=below)
                break
            rungs.append(rung)
            told.added(rung)
        if not ended and (not more or len(rounds) >= MOST_ROUNDS):
            ended = TOO_LONG.format(rounds=len(rounds)) if more else NO_MORE
        if ended:
            return Climb(rounds=tuple(rounds), rungs=tuple(rungs), ended=ended, at=standing(asked.model))
        bench = replace(bench, model=reading.read(str(asked.model)))


def new(found: Diagnosis, model: Model) -> tuple[Cause, ...]:
    """What becomes a rung: accepted, and not in `model` yet; of an unknown effect nothing does."""
    if found.verdict == UNKNOWN:
        return ()
    known = {one.named.id for one in model.effects}
    more = tuple(one for one in found.accepted if one.id not in known)
    wrong = tuple(one for one in more if FAMILIES[one.named.family].side == OF_MISTAKES)
    return wrong if found.verdict == MISTAKE and wrong else more


def _added(asked: Asked, cause: Cause, found: Diagnosis, progress: Progress) -> tuple[Rung, int]:
    """The rung of `cause`, and the number of the one below."""
    step = adding.added(
        adding.Asked(
            model=asked.model,
            effect=str(cause.named),
            data=asked.data,
            hold_out=asked.hold_out,
            band=asked.band,
            method=asked.method,
            effects_from=asked.effects_from,
            remarks=_alike(cause, found),
        ),
        lambda what, share: progress(f"adding {cause.id}: {what}", share),
    )
    return step.after, step.before.number


def _alike(cause: Cause, found: Diagnosis) -> Sequence[str]:
    others = [id for id in found.equivalence_class if id != cause.id]
    if cause.id not in found.equivalence_class or not others:
        return ()
    return (f"These data cannot tell it from {' or '.join(others)}.",)


def as_json(found: Climb) -> dict[str, Any]:
    """What --json says of a climb beside its first diagnosis."""
    rounds = [
        {"verdict": one.verdict, "headline": headline(one), "accepted": [effect(each) for each in one.accepted]}
        for one in found.rounds
    ]
    return {
        "auto": {
            "ended": found.ended,
            "rungs": [rung.number for rung in found.rungs],
            "rounds": rounds,
            "ladder": of_ladder(found.at),
        }
    }
