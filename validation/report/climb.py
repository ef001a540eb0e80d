"""`massline diagnose --auto`: diagnose, add what is missing as a rung, and diagnose again, until the rules say stop.

A rung is made by `validation.history.add`, as `massline add` makes it: fitted anew, evaluated on held-out data, kept at
once. So an interruption loses no rung that was finished, and the next run begins where the model file stands. The rules:

    nothing      is missing any more: done
    missing, several    every effect that was accepted becomes a rung, and the new model is diagnosed
    mistake      the mistakes alone become rungs; what there is beside them is for the diagnosis of the new model to say
    ambiguous    the first of those that cannot be told apart becomes a rung, which says so; only another measurement goes on
    nonlinear    likewise, and what a linear fit would say beyond that is nonsense
    unknown      no name is worth a rung; what is named beside what is left is for `massline add`
    a rung that is not worth a parameter by the ladder's own figures is left again, and ends the climb
"""

from collections.abc import Callable
from dataclasses import dataclass

from validation.diagnose import diagnosis as results
from validation.effects.catalogue import FAMILIES
from validation.effects.effect import MISTAKE as OF_MISTAKES
from validation.history import add
from validation.history.history import HistoryPosition, Version, history_position, undone
from validation.history.verdict import is_worth_adding
from validation.model import model_file
from validation.model.model import Model
from validation.study import Options, Study

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

Progress = Callable[[str, float], None]
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
    CheckFailed : a baseline does not converge.
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
            effect = add.AddedEffectOptions(effect=str(cause.named), remarks=remarks)
            step = add.added(bench, effect, lambda what, share, id=cause.id: progress(f"adding {id}: {what}", share))  # type: ignore[misc]
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
