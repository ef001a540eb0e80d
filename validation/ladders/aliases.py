"""Whether the data can tell an effect from those that the model has already: the direction of the Fisher matrix says.

Whitened derivatives of what the channels read, and of classical results, are the columns of J; N = J^T J is the Fisher matrix of
these data. What is left of an effect's column when the columns of the others are projected out,

    S_cc = N_cc - N_co N_oo^+ N_oc ,        share = S_cc / N_cc ,

is what only it can explain. Where nothing is left, it and a mixture of the others, N_oo^+ N_oc of each, do the same to every
channel at every line: no fit can share out a fault between them, knowledge beforehand does. Of an effect with several sizes it is
the largest share over all their mixtures.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from geometry.arrays import Array
from validation.effects.identifiers import Named
from validation.engine.cost import cost_of
from validation.engine.fit import floor_of
from validation.engine.parameter import EFFECT, IDENTIFIED, PLAIN, Parameter
from validation.engine.prediction import Prediction
from validation.engine.problem import Problem
from validation.models.model import Added
from validation.prediction.series import SeriesPrediction

ALIKE = 1e-6
"""Share of the square of what an effect does that others must leave to it: a thousandth of what it does to the channels."""

NOTICED = 1e-3
"""Standard deviations that a plausible fault must move all data together for the effect to act on them at all."""

TAKES_PART = 0.02
"""Share of what the effect does from which a member of the mixture is named."""

RANK = 1e-13
"""Relative singular value below which a direction of the others is itself none."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Alias:
    """An effect that others imitate.

    Attributes
    ----------
    id : of the effect
    share : of the square of what it does that only it can explain
    size : of the effect, in the unit of its first parameter, to which the mixture belongs
    unit : its unit
    mixture : by the names of the others, which size of each does the same, in `units`
    units : by name
    effects : those of the mixture that are effects of the model
    """

    id: str
    share: float
    size: float
    unit: str
    mixture: Mapping[str, float]
    units: Mapping[str, str]
    effects: tuple[str, ...]

    @property
    def text(self) -> str:
        """The direction in words."""
        same = ", ".join(f"{name} {_told(size, self.units[name])}" for name, size in self.mixture.items())
        return f"{self.id} {_told(self.size, self.unit)} does to these data what {same} does"


def _told(size: float, unit: str) -> str:
    return f"{size:+.3g}" if unit == "1" else f"{size:+.3g} {unit}"


def noticed(problem: Problem, names: Sequence[str]) -> float:
    """How many standard deviations a plausible fault in the parameters `names` moves all data together; 0 where none acts."""
    free = [one for one in problem.parameters if one.name in names]
    if not free:
        return 0.0
    N = _fisher(problem, free)
    scale = np.array([one.tolerance for one in free])
    return float(np.sqrt(np.linalg.eigvalsh(scale[:, None] * N * scale)[-1]))


def alias(problem: Problem, id: str, names: Sequence[str]) -> Alias | None:
    """The mixture of effects, and of what a laboratory must identify, that does what the parameters `names` of `id` do, if any.

    Derivatives are those where the model stands.
    """
    others = [one for one in problem.parameters if one.kind in (EFFECT, IDENTIFIED) and one.name not in names]
    own = [one for one in problem.parameters if one.name in names]
    if not own or not others:
        return None
    free = [*own, *others]
    matrix = _fisher(problem, free)
    scale = np.sqrt(np.maximum(np.diag(matrix), np.finfo(np.float64).tiny))
    N, c = matrix / np.outer(scale, scale), len(own)
    mixed = np.linalg.pinv(N[c:, c:], rcond=RANK, hermitian=True) @ N[c:, :c]
    share, direction = _largest(N[:c, :c], N[:c, :c] - N[:c, c:] @ mixed)
    if share > ALIKE:
        return None
    return _told_apart(id, share, free, c, direction / scale[:c], (mixed @ direction) / scale[c:], mixed @ direction)


def _fisher(problem: Problem, free: Sequence[Parameter]) -> Array:
    """(p, p) of data and facts where the model stands, knowledge beforehand left out."""
    cost = cost_of(problem, free, floor_of(PLAIN))
    x = cost.at({})
    _, rows = cost.knowledge(x)
    facts = rows[len(rows) - len(problem.facts) :]
    return np.asarray(cost.data(x).matrix + facts.T @ facts)


def _largest(whole: Array, left: Array) -> tuple[float, Array]:
    """The largest share of `whole` (c, c) that is `left`, and its direction (c,)."""
    values, vectors = np.linalg.eigh(whole)
    kept = values > 1e-12 * values[-1]
    root = vectors[:, kept] / np.sqrt(values[kept])
    shares, directions = np.linalg.eigh(root.T @ left @ root)
    return float(max(shares[-1], 0.0)), np.asarray(root @ directions[:, -1])


def _told_apart(id: str, share: float, free: Sequence[Parameter], c: int, own: Array, mixed: Array, weight: Array) -> Alias:
    """The direction in the units of the parameters, at a tenth of a plausible fault of the effect."""
    first = int(np.argmax(np.abs(own) / [one.tolerance for one in free[:c]]))
    scale = 0.1 * free[first].tolerance / own[first]
    slope = [one.slope(one.start) for one in free]
    part = np.abs(weight) > TAKES_PART * np.abs(weight).max()
    named = {one.name: float(scale * mixed[k] * slope[c + k]) for k, one in enumerate(free[c:]) if part[k]}
    return Alias(
        id=id,
        share=share,
        size=float(scale * own[first] * slope[first]),
        unit=free[first].unit,
        mixture=named,
        units={one.name: one.unit for one in free},
        effects=tuple(one.name for one in free[c:] if one.kind == EFFECT and one.name in named),
    )


def freed(problem: Problem) -> Problem:
    """`problem` with every effect of its models free, those too whose size was given."""
    made: list[Prediction] = []
    for one in problem.predictions:
        made.append(one.with_effects(_free(one.effects)) if isinstance(one, SeriesPrediction) else one)
    return replace(problem, predictions=tuple(made))


def _free(effects: Sequence[Added]) -> tuple[Added, ...]:
    return tuple(replace(one, fixed=False) for one in effects)


def names_of(problem: Problem, named: Named) -> tuple[str, ...]:
    """The parameters of `problem` that are sizes of the effect `named`."""
    known = {named.id, *(f"{named.id}[{size.key}]" for size in named.sizes)}
    return tuple(one.name for one in problem.parameters if one.name in known and one.kind == EFFECT)
