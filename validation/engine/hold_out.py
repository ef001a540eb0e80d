"""What is held out: each run of each data set in turn and, in a series, each configuration; or what is named.

A fit that never saw a run, a configuration or a block of frequencies must predict it. Lines alone are never held out one by
one: a model's error is strongly correlated from line to line, and their scores are useless ("What bit" of the catalogue).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from types import MappingProxyType

import numpy as np

from geometry.errors import BadInput
from geometry.keys import nearest
from validation.engine.prediction import Lines, Prediction
from validation.engine.problem import Problem

Runs = Mapping[str, tuple[str, ...]]
"""Runs by data set."""

NOBODY: Runs = MappingProxyType({})

SHORTEST = 1.0
"""[Hz] that a block of frequencies is at least."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Fold:
    """What is held out together.

    Attributes
    ----------
    name : in words
    runs : by data set, those that are held out with all their lines
    blocks : by data set the indices of the lines that are held out of all runs
    facts : names of those that are held out
    configuration : whether it is all of one configuration of a series
    """

    name: str
    runs: Runs = field(default_factory=lambda: NOBODY)
    blocks: Mapping[str, Lines] = field(default_factory=lambda: MappingProxyType({}))
    facts: tuple[str, ...] = ()
    configuration: bool = False


def folds(problem: Problem) -> tuple[Fold, ...]:
    """Each run of each data set of several, and each configuration of several, in turn."""
    found = []
    for one in problem.predictions:
        if len(one.measured.runs) > 1:
            found += [_of_run(one.measured.name, run) for run in one.measured.runs]
    configurations = dict.fromkeys(one.measured.configuration for one in problem.predictions)
    if len(configurations) > 1:
        found += [_of_configuration(problem, configuration) for configuration in configurations]
    return tuple(found)


def every_block(problem: Problem, count: int) -> tuple[Fold, ...]:
    """`count` blocks of frequency, of equal width on a logarithmic axis, each held out of all data sets in turn.

    Raises
    ------
    BadInput : fewer than two, or blocks narrower than `SHORTEST`.
    """
    low = min(float(one.measured.frequency[0]) for one in problem.predictions)
    high = max(float(one.measured.frequency[-1]) for one in problem.predictions)
    edges = np.geomspace(max(low, 1e-3 * high), high * (1 + 1e-12), max(count, 1) + 1)
    if count < 2 or edges[1] - edges[0] < SHORTEST:
        problem_ = f"cannot be cut into {count} blocks of at least {SHORTEST:g} Hz, found {low:g} to {high:g} Hz"
        raise BadInput(source="hold-out", field="blocks", problem=problem_, remedy="Ask for 2 or a few more")
    made = (_of_block(problem, lo, hi) for lo, hi in pairwise(edges))
    return tuple(one for one in made if one.blocks)


def named(problem: Problem, names: Sequence[str]) -> Fold:
    """All that `names` name, together: runs as ``data set/run`` or by a name that only one has, data sets, configurations, facts.

    Raises
    ------
    BadInput : an unknown name, with the nearest; a run that several data sets have; nothing is left to fit.
    """
    runs: dict[str, tuple[str, ...]] = {}
    facts: list[str] = []
    for name in names:
        pieces, fact = _meant(problem, name)
        for data_set, some in pieces:
            runs[data_set] = tuple(dict.fromkeys((*runs.get(data_set, ()), *some)))
        facts += fact
    fold = Fold(name=", ".join(names), runs=runs, facts=tuple(facts))
    if not without(problem, fold).predictions:
        raise BadInput(source="--hold-out", field=fold.name, problem="nothing is left to fit", remedy="Hold out less")
    return fold


def without(problem: Problem, fold: Fold) -> Problem:
    """What is left to fit."""
    kept = [_rest(one, fold.runs.get(one.measured.name, ())) for one in problem.predictions]
    lines = {
        one.measured.name: np.setdiff1d(problem.lines_of(one), fold.blocks.get(one.measured.name, np.zeros(0, dtype=np.int64)))
        for one in problem.predictions
    }
    left = tuple(one for one in kept if one is not None and len(lines[one.measured.name]))
    facts = tuple(fact for fact in problem.facts if fact.name not in fold.facts)
    return replace(problem, predictions=left, facts=facts, lines=lines)


def held(problem: Problem, fold: Fold) -> list[tuple[Prediction, Lines | None]]:
    """What is predicted: predictions of the runs that are held out, and lines of them, None for all."""
    found: list[tuple[Prediction, Lines | None]] = []
    for one in problem.predictions:
        name = one.measured.name
        if fold.runs.get(name):
            found.append((one.on(fold.runs[name]), None))
        elif name in fold.blocks:
            found.append((one, fold.blocks[name]))
    return found


def _rest(one: Prediction, runs: Sequence[str]) -> Prediction | None:
    left = [run for run in one.measured.runs if run not in runs]
    if not left:
        return None
    return one.on(left) if len(left) < len(one.measured.runs) else one


def _of_run(data_set: str, run: str) -> Fold:
    return Fold(name=f"run {run} of {data_set}", runs={data_set: (run,)})


def _of_configuration(problem: Problem, configuration: str) -> Fold:
    whole = {one.measured.name: one.measured.runs for one in problem.predictions if one.measured.configuration == configuration}
    return Fold(name=f"configuration {configuration}", runs=whole, configuration=True)


def _of_block(problem: Problem, low: float, high: float) -> Fold:
    inside = {
        one.measured.name: np.flatnonzero((one.measured.frequency >= low) & (one.measured.frequency < high))
        for one in problem.predictions
    }
    return Fold(name=f"{low:.3g} to {high:.3g} Hz", blocks={name: lines for name, lines in inside.items() if len(lines)})


def _meant(problem: Problem, name: str) -> tuple[list[tuple[str, tuple[str, ...]]], list[str]]:
    """Runs by data set, and facts, that `name` names."""
    measured = [one.measured for one in problem.predictions]
    whole = [(one.name, one.runs) for one in measured if name in (one.name, one.configuration)]
    if whole:
        return whole, []
    facts = [fact.name for fact in problem.facts if fact.name == name]
    if facts:
        return [], facts
    runs = [(one.name, (run,)) for one in measured for run in one.runs if name in (run, f"{one.name}/{run}")]
    if len(runs) == 1:
        return [(runs[0][0], runs[0][1])], []
    raise _unknown(problem, name, [f"{data_set}/{run[0]}" for data_set, run in runs])


def _unknown(problem: Problem, name: str, several: Sequence[str]) -> BadInput:
    if several:
        told = f"is a run of {len(several)} data sets"
        return BadInput(source="--hold-out", field=name, problem=told, remedy=f"Write one of {', '.join(several)}")
    measured = [one.measured for one in problem.predictions]
    known = [
        *(one.name for one in measured),
        *dict.fromkeys(one.configuration for one in measured if one.configuration != one.name),
        *(f"{one.name}/{run}" for one in measured for run in one.runs),
        *(fact.name for fact in problem.facts),
    ]
    short = [run for one in measured for run in one.runs]
    near = nearest(name, [*known, *short])
    problem_ = f"no run, data set, configuration or fact is called {name!r}"
    return BadInput(source="--hold-out", field=name, problem=problem_, remedy=f"{near}Known are {', '.join(known)}")
