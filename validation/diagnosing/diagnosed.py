"""`diagnosed`: the whole way from data to an answer. `bench`: the data made ready for it.

Order of work ("What bit" of the catalogue): discrete mistakes, two levels, a converged baseline, screening, refits, acceptance or
"unknown", and then what would settle it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from validation.comparing.compared import meant
from validation.comparing.gathered import Data
from validation.diagnosing import answering, stated
from validation.diagnosing.bench import Bench
from validation.diagnosing.diagnosis import Diagnosis
from validation.diagnosing.discrete import mistakes
from validation.diagnosing.levels import levels
from validation.diagnosing.menu import candidates, looked_for
from validation.diagnosing.mistaken import with_mistakes, without_mistakes
from validation.diagnosing.refitting import baseline, finished
from validation.diagnosing.searching import searched
from validation.diagnosing.unequal import nonlinear_answer
from validation.effects.catalogue import FAMILIES
from validation.effects.family import AMPLITUDE
from validation.engine.prediction import Fact
from validation.models.model import Added, Model
from validation.prediction.facts import facts
from validation.prediction.series import predictions

Progress = Callable[[str, float], None]
"""Hears what is done now, and the share of it."""


def bench(
    model: Model,
    data: Data,
    *,
    hold_out: Sequence[str] = (),
    band: tuple[float, float] | None = None,
    method: str = "full-record",
    progress: Progress | None = None,
) -> Bench:
    """`data` ready for `model` with any effects.

    Raises
    ------
    BadInput : an unknown name in `hold_out`; whatever makes no spectra.
    """
    tell = progress or (lambda what, share: None)
    made = predictions(
        replace(model, effects=()), data.campaigns, band=band, method=method, progress=lambda share: tell("spectra", share)
    )

    said = facts(replace(model, effects=()), data.classical)  # read once: records are fitted on the way

    def of_effects(effects: Sequence[Added]) -> tuple[Fact, ...]:
        return tuple(fact.with_effects(effects) for fact in said)

    ready = Bench(model=model, campaigns=data.campaigns, made=made, facts=of_effects)
    return replace(ready, hold_out=meant(ready.whole(), data, tuple(hold_out)))


def diagnosed(
    of: Bench, *, only: Sequence[str] = (), leave_out: Sequence[str] = (), progress: Progress | None = None
) -> Diagnosis:
    """What the model of a bench is missing.

    Parameters
    ----------
    only : families or ids that are looked for beside mistakes; all where nothing is said
    leave_out : families or ids that are not, mistakes among them

    Raises
    ------
    BadInput : one of `only` could not act on these data.
    CheckFailed : the baseline does not converge.
    """
    tell = progress or (lambda what, share: None)
    tell("looking for mistakes", 0.0)
    mistaken = [one for one in mistakes(of) if looked_for(one.named, (), leave_out)]
    right = without_mistakes(of, mistaken)
    found = _linear_or_not(right, only, leave_out, tell)
    whole = with_mistakes(of, found, mistaken) if mistaken else found
    return replace(whole, only=tuple(only), settings={**whole.settings, **stated.of_question(only, leave_out)})


def _linear_or_not(right: Bench, only: Sequence[str], leave_out: Sequence[str], tell: Progress) -> Diagnosis:
    """The diagnosis of data without mistakes: what two levels say, and where they say the same what a search finds."""
    linear = [one for one in only if FAMILIES[one.partition(":")[0]].side != AMPLITUDE]
    menu = candidates(right, only=linear, leave_out=leave_out) if linear or not only else ()
    if differing := levels(right):
        return nonlinear_answer(right, differing, tell, only=only, leave_out=leave_out)
    tell("fitting the model as it is", 0.0)
    base = baseline(right, lambda share: tell("fitting the model as it is", share))
    found, rounds = searched(right, base, menu, tell)
    found = finished(right, found) if found.effects else found
    return answering.answer(right, rounds[0].at, found, rounds, tell)
