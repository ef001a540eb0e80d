"""A diagnosis of data with discrete mistakes: they are taken out first, and told with whatever else is found."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from validation.diagnosing.bench import Bench
from validation.diagnosing.confirming import confirming
from validation.diagnosing.diagnosis import MISTAKE, NONLINEAR, NOTHING, Cause, Diagnosis
from validation.diagnosing.errors import as_it_stands
from validation.diagnosing.words import headline
from validation.models.model import Added


def without_mistakes(bench: Bench, mistaken: Sequence[Cause]) -> Bench:
    """`bench` with a model that makes the same mistakes as the data, so that nothing is left of them."""
    made = tuple(Added(named=one.named, fixed=True) for one in mistaken)
    return replace(bench, model=replace(bench.model, effects=(*bench.model.effects, *made)))


def with_mistakes(bench: Bench, found: Diagnosis, mistaken: Sequence[Cause]) -> Diagnosis:
    """`found`, the diagnosis without the mistakes, as one of the data of `bench` as they are."""
    return replace(
        found,
        verdict=found.verdict if found.verdict == NONLINEAR else MISTAKE,
        text=_text(found, mistaken),
        accepted=(*mistaken, *found.accepted),
        ranking=(*mistaken, *found.ranking),
        equivalence_class=found.equivalence_class or tuple(one.id for one in mistaken),
        advice=found.advice or confirming(one.named for one in mistaken),
        before=as_it_stands(bench, {} if found.verdict == NONLINEAR else found.after.fitted.by_name),
    )


def _text(found: Diagnosis, mistaken: Sequence[Cause]) -> str:
    which = " and ".join(one.id for one in mistaken)
    if found.verdict == NONLINEAR:
        return f"{found.text}; beside that a mistake in the data: {which}"
    if found.verdict == NOTHING:
        return ""
    return f"Beside {which}: {found.text or headline(found)}"
