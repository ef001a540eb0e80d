"""The answer where two levels do not give the same: a linear fit of such data fails, and names nonsense."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from validation.diagnosing import stated
from validation.diagnosing.bench import Bench
from validation.diagnosing.confirming import confirming
from validation.diagnosing.diagnosis import NONLINEAR, Cause, Diagnosis, Level
from validation.diagnosing.errors import as_it_stands
from validation.diagnosing.menu import looked_for
from validation.diagnosing.nonlinear import nonlinear
from validation.effects.worth import ALIKE, WORTH
from validation.models.model import Added

Progress = Callable[[str, float], None]


def nonlinear_answer(
    bench: Bench, levels: Sequence[Level], progress: Progress, *, only: Sequence[str] = (), leave_out: Sequence[str] = ()
) -> Diagnosis:
    """Which axes depend on the level, and which effect that may be, of those that are looked for."""
    found = nonlinear(bench, levels, lambda share: progress("two levels do not give the same", share))
    ranking = tuple(one for one in found if looked_for(one.named, only, leave_out))
    alike = tuple(one.id for one in ranking if one.evidence >= max(ranking[0].evidence - ALIKE, WORTH))
    named = ranking[:1] if len(alike) == 1 else ()
    before = as_it_stands(bench, {})
    after = before
    if named:
        model = replace(bench.model, effects=(*bench.model.effects, Added(named=named[0].named, fixed=True)))
        after = as_it_stands(replace(bench, model=model), {})
    return Diagnosis(
        verdict=NONLINEAR,
        text=_text(levels, named),
        accepted=named,
        ranking=ranking,
        equivalence_class=alike,
        levels=tuple(levels),
        before=before,
        after=after,
        advice=confirming(one.named for one in ranking if one.id in alike),
        hold_out=before.held_out_names,
        settings=stated.of_bench(bench),
    )


def _text(levels: Sequence[Level], named: Sequence[Cause]) -> str:
    axes = ", ".join(dict.fromkeys(one.axis for one in levels))
    said = f"Driven along {axes}, two levels do not give the same"
    if named:
        said += f": as {named[0].id} would"
    return said
