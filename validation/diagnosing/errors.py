"""The four errors of a hypothesis, quickly: at every third line, every run held out in turn."""

from __future__ import annotations

from collections.abc import Callable

from validation.diagnosing.bench import Bench, Hypothesis
from validation.engine.evaluate import evaluate
from validation.engine.evaluation import Evaluation
from validation.engine.fit import unfitted
from validation.engine.parameter import FITTED
from validation.engine.prediction import Offsets

Progress = Callable[[float], None]


def errors(bench: Bench, of: Hypothesis, progress: Progress | None = None) -> Evaluation:
    """Of the hypothesis `of`, whose fit is known; no configuration is held out."""
    return evaluate(bench.whole(of.effects), hold_out=bench.hold_out, fitted=of.fit, quick=True, progress=progress)


def as_it_stands(bench: Bench, offsets: Offsets) -> Evaluation:
    """Of the model of `bench` where no fit of all tolerances makes sense: they stand at `offsets`."""
    found = unfitted(bench.problem(), FITTED, offsets)
    return evaluate(bench.whole(), hold_out=bench.hold_out, fitted=found, quick=True)
