"""The effect that is to be added, checked before anything is fitted: known, not there yet, seen by these data, no exact alias."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from geometry.errors import BadInput
from validation.effects.catalogue import FAMILIES
from validation.effects.family import Size as Described
from validation.effects.identifiers import Named, parse
from validation.effects.targets import Vocabulary
from validation.engine.problem import Problem
from validation.ladders import aliases
from validation.ladders.aliases import Alias, names_of
from validation.models.model import Added, Model

ARGUMENT = "EFFECT"

FIRST_GUESS: Mapping[str, float] = {"m": 0.05, "f": 10.0, "zeta": 0.01}
"""Of a resonator of which nothing is said: fifty grams at the middle of the paper's band; where it is, a grid says."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Candidate:
    """An effect that may be added.

    Attributes
    ----------
    added : with the sizes that were asked for, or a first guess
    left : keys of the sizes that are a guess
    alias : what does the same to these data; None where nothing does
    tolerances : by key of its sizes what a laboratory or the model admits, one standard deviation
    nulls : by key the size at which there is no effect
    said : sentences about how it is taken
    """

    added: Added
    left: tuple[str, ...]
    alias: Alias | None
    tolerances: Mapping[str, float]
    nulls: Mapping[str, float]
    said: tuple[str, ...] = ()


def read(text: str, model: Model, words: Vocabulary, *, fixed: bool) -> tuple[Added, tuple[str, ...]]:
    """The effect that `text` names, and the keys of its sizes that `text` leaves open.

    Raises
    ------
    BadInput : no effect of the catalogue, a size that is no physics, one that the model has already, `fixed` without a size.
    """
    whole, left = completed(text)
    named = parse(whole, words, source=ARGUMENT)
    there = next((one for one in model.effects if one.named.id == named.id), None)
    if there is not None:
        problem = f"the model has it already, {there.named}"
        remedy = "`massline undo` takes the last one out; to start it elsewhere, change its value in the file"
        raise BadInput(source=model.source, field=named.id, problem=problem, remedy=remedy)
    if fixed and left:
        remedy = f"Write for example {FAMILIES[named.family].example}"
        raise BadInput(source="--fixed", field=named.id, problem="its size is missing, to which it is to be fixed", remedy=remedy)
    switch = bool(named.sizes) and all(size.whole for size in named.sizes)
    return Added(named=named, fixed=fixed or switch), left


def candidate(
    added: Added, left: Sequence[str], model: Model, problem: Callable[[Model], Problem], *, allowed: bool
) -> Candidate:
    """`added`, whose sizes were partly `left` open, as it can be fitted to the data of `problem`.

    Raises
    ------
    BadInput : it acts nowhere on these data; others of the model do exactly the same, and that is not `allowed`.
    """
    before = problem(model).thinned()
    after = problem(replace(model, effects=(*model.effects, added))).thinned()
    _require_seen(before, after, added)
    free = aliases.freed(after)
    found = aliases.alias(free, added.named.id, names_of(free, added.named))
    if found is not None and found.effects and not allowed:
        raise BadInput(
            source=ARGUMENT,
            field=added.named.id,
            problem=f"these data cannot tell it from what is in the model: {found.text}",
            remedy="Add data that tell them apart, undo the other, or say --alias-ok: knowledge beforehand then shares it out",
        )
    said = (f"{found.text}; only what is known beforehand shares it out",) if found is not None else ()
    return Candidate(
        added=added,
        left=tuple(left),
        alias=found,
        tolerances=_tolerances(added.named, before),
        nulls={size.key: size.null for size in added.named.sizes},
        said=said,
    )


def completed(text: str) -> tuple[str, tuple[str, ...]]:
    """`text` with a first guess for every size that it leaves out, and the keys of these."""
    name, equals, value = (part.strip() for part in text.partition("="))
    family, *targets = (part.strip() for part in name.split(":"))
    if family not in FAMILIES or (equals and not value):
        return text, ()
    given = {part.rpartition(":")[0].strip() for part in value.split(",")} if value else set()
    open_ = [size for size in FAMILIES[family].sizes_at(tuple(targets)) if size.key not in given]
    if not open_ or "" in given:
        return text, ()
    guesses = [f"{size.key}:{_guess(size)!r}" if size.key else repr(_guess(size)) for size in open_]
    return f"{name}={','.join([*([value] if value else []), *guesses])}", tuple(size.key for size in open_)


def _guess(size: Described) -> float:
    """No effect where that is a size; of a switch the other position; else something that is there."""
    if size.whole:
        return size.low if size.null == size.high else size.high
    first = FIRST_GUESS.get(size.key, size.plausible) if size.logarithmic else size.null
    return min(max(first, size.low), size.high)


def _require_seen(before: Problem, after: Problem, added: Added) -> None:
    names = names_of(after, added.named)
    seen = aliases.noticed(after, names) > aliases.NOTICED if names else _differ(before, after)
    if not seen:
        raise BadInput(
            source=ARGUMENT,
            field=added.named.id,
            problem="it acts nowhere on these data: no channel would read anything else",
            remedy="Name data of an article that has it, or of a run that drives it",
        )


def _differ(before: Problem, after: Problem) -> bool:
    """Whether any channel is predicted otherwise, or its noise."""
    for one, other in zip(before.predictions, after.predictions, strict=True):
        lines = before.lines_of(one)
        first, second = (each.at(problem.start, lines, derivatives=False) for each, problem in ((one, before), (other, after)))
        if first.rows.shape != second.rows.shape or not np.array_equal(first.rows, second.rows):
            return True
        if (first.noise is None) != (second.noise is None):
            return True
    return False


def _tolerances(named: Named, before: Problem) -> dict[str, float]:
    """Of a size that was a tolerance of the model before, that; else what its family admits of a careful laboratory."""
    admitted = FAMILIES[named.family].tolerance
    found = {size.key: admitted for size in named.sizes}
    if named.id in before.by_name:
        found[""] = before.by_name[named.id].tolerance
    return found
