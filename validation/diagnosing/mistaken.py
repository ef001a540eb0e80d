"""A diagnosis of data with discrete mistakes: they are taken out first, and told with whatever else is found."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from validation.diagnosing.bench import Bench
from validation.diagnosing.diagnosis import MISTAKE, NOTHING, Cause, Diagnosis
from validation.diagnosing.errors import as_it_stands
from validation.models.model import Added


def without_mistakes(bench: Bench, mistaken: Sequence[Cause]) -> Bench:
    """`bench` with a model that makes the same mistakes as the data, so that nothing is left of them."""
    made = tuple(Added(named=one.named, fixed=True) for one in mistaken)
    return replace(bench, model=replace(bench.model, effects=(*bench.model.effects, *made)))


def with_mistakes(bench: Bench, found: Diagnosis, mistaken: Sequence[Cause]) -> Diagnosis:
    """`found`, the diagnosis without the mistakes, as one of the data of `bench` as they are."""
    which = " and ".join(one.id for one in mistaken)
    beside = "" if found.verdict == NOTHING else f"; beside it: {found.text}"
    return replace(
        found,
        verdict=MISTAKE,
        text=f"A mistake in the measurement: {which}{beside}",
        accepted=(*mistaken, *found.accepted),
        ranking=(*mistaken, *found.ranking),
        equivalence_class=found.equivalence_class or tuple(one.id for one in mistaken),
        before=as_it_stands(bench, found.after.fitted.by_name),
    )
