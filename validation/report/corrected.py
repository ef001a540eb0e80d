"""Identified inertia with the effects of the model: what its ladder says, or what a fit finds where no rung says it.

Identification from raw records knows no effect: a load cell that reads too much makes an article too heavy there. With the
effects of the model its fault is taken out.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from geometry.errors import BadInput, CheckFailed
from validation.comparing.asked import Asked
from validation.comparing.comparison import Comparison
from validation.comparing.gathered import Data
from validation.ladders import sources
from validation.ladders.adding import bench_of
from validation.ladders.climbing import Standing
from validation.ladders.judging import body_of
from validation.ladders.nouns import Body, Conditions
from validation.models.model import Model

Progress = Callable[[str, float], None]


def identified(
    asked: Asked, model: Model, data: Data, comparison: Comparison, at: Standing | None, progress: Progress
) -> tuple[tuple[Body, ...], str]:
    """Of the rung on which the model stands, where that stands on the same data; else of a fit. None of a model without effects
    that no rung has, and none where there is a reason, which is told.

    Parameters
    ----------
    comparison : of `model` and `data`, as `asked`

    Raises
    ------
    OSError : a file cannot be read.
    """
    conditions = Conditions(
        data=sources.sources(asked.data, Path(asked.model).parent), hold_out=asked.hold_out, band=asked.band, method=asked.method
    )
    if at is not None and _is_of(at, conditions, comparison):
        return (() if at.rung is None else at.rung.bodies), ""
    if not model.effects:
        return (), ""
    try:
        bench = bench_of(model, data, conditions, lambda share: progress("spectra", share))
        plain = comparison.evaluation.plain_fit
        body = body_of(bench, bench.problem(model), plain, lambda share: progress("identifying", share))
    except (BadInput, CheckFailed) as error:
        return (), str(error)
    return ((body,), "") if body is not None else ((), "no article stood on the FMD")


def _is_of(at: Standing, conditions: Conditions, comparison: Comparison) -> bool:
    """Whether the rung stands on the data of `conditions`, with the same held out."""
    rung = at.rung
    if rung is None or rung.errors is None:
        return False
    held = rung.errors.held_out_names == comparison.evaluation.held_out_names
    return held and replace(rung.conditions, hold_out=()).same(replace(conditions, hold_out=()))
