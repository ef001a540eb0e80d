"""`Cost`: what a fit makes small: half the squares of misfit, of facts, and of what is known beforehand."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType

import numpy as np

from geometry.arrays import Array
from identification.self_calibration.elimination import Normal
from validation.engine import likelihood
from validation.engine.likelihood import Observed
from validation.engine.parameter import Parameter
from validation.engine.prediction import Lines, Offsets, Predicted, Prediction
from validation.engine.problem import Problem

NOTHING: Offsets = MappingProxyType({})


@dataclass(frozen=True, eq=False, kw_only=True)
class Cost:
    """Of a problem in some of its parameters.

    Attributes
    ----------
    problem : what is compared
    free : (p,) the parameters that move
    floor : model-error floor, relative
    base : offsets at which the others stand, those of the model where nothing is said
    held : parameters of the fit that stand at a bound; what is known of them counts
    plain : whether declared parameters stay within what a plain fit allows them
    """

    problem: Problem
    free: tuple[Parameter, ...]
    floor: float
    base: Offsets = field(default_factory=lambda: NOTHING)
    held: tuple[Parameter, ...] = ()
    plain: bool = False
    observed: tuple[tuple[Prediction, Lines, Observed], ...] = field(default=(), repr=False)

    def __post_init__(self) -> None:
        if not self.observed:
            chosen = ((one, self.problem.lines_of(one)) for one in self.problem.predictions)
            object.__setattr__(
                self, "observed", tuple((one, lines, likelihood.observed(one.measured, lines)) for one, lines in chosen)
            )

    @cached_property
    def names(self) -> tuple[str, ...]:
        """(p,) of the free parameters."""
        return tuple(one.name for one in self.free)

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """(p,) least and (p,) greatest offsets of the free parameters."""
        pairs = np.array([one.bounds(plain=self.plain) for one in self.free]).reshape(-1, 2)
        return pairs[:, 0], pairs[:, 1]

    def offsets(self, x: Array) -> dict[str, float]:
        """Of all parameters, the free ones at `x` (p,)."""
        return {**self.problem.start, **self.base, **dict(zip(self.names, map(float, x), strict=True))}

    def at(self, offsets: Offsets) -> Array:
        """(p,) of the free parameters from `offsets`, those of the model where nothing is said."""
        return np.array([offsets.get(one.name, one.start) for one in self.free])

    def holding(self, held: Mapping[str, float]) -> Cost:
        """The same with the parameters `held` at these offsets, and all others of the fit free."""
        everything = (*self.free, *self.held)
        return replace(
            self,
            free=tuple(one for one in everything if one.name not in held),
            held=tuple(one for one in everything if one.name in held),
            base={**self.base, **held},
        )

    def by_run(self, x: Array) -> dict[tuple[str, str], Normal]:
        """Normal equations of the data at `x` (p,) by data set and run."""
        found: dict[tuple[str, str], Normal] = {}
        offsets = self.offsets(x)
        for prediction, lines, seen in self.observed:
            predicted = prediction.at(offsets, lines, derivatives=frozenset(self.names))
            for run, one in likelihood.normals(seen, predicted, self.names, self.floor).items():
                found[prediction.measured.name, run] = one
        return found

    def data(self, x: Array) -> Normal:
        """Normal equations of all data at `x` (p,)."""
        return likelihood.total(self.by_run(x).values(), len(self.free))

    def knowledge(self, x: Array) -> tuple[Array, Array]:
        """Whitened residuals (q,) at `x` (p,) of what is known beforehand and of facts, and their derivatives (q, p)."""
        sd = np.array([one.tolerance for one in self.free])
        known = np.isfinite(sd)
        away, rows = x[known] / sd[known], np.eye(len(sd))[known] / sd[known, None]
        still = np.array([self.base[one.name] / one.tolerance for one in self.held])
        left, change = self._facts(x)
        return np.concatenate([away, still, left]), np.vstack([rows, np.zeros((len(still), len(sd))), change])

    def _facts(self, x: Array) -> tuple[Array, Array]:
        said = [fact.residual(self.offsets(x)) for fact in self.problem.facts]
        rows = np.array([[slopes.get(name, 0.0) for name in self.names] for _, slopes in said])
        return np.array([left for left, _ in said]), rows.reshape(len(said), len(self.names))

    def total(self, x: Array, data: Normal | None = None) -> tuple[Normal, Normal, float]:
        """At `x` (p,): all as one, the `data` alone, which may be known already, and chi² of data and facts."""
        data = self.data(x) if data is None else data
        away, rows = self.knowledge(x)
        whole = Normal(
            cost=data.cost + 0.5 * float(away @ away),
            gradient=data.gradient + rows.T @ away,
            matrix=data.matrix + rows.T @ rows,
        )
        left, _ = self._facts(x)
        return whole, data, 2 * data.cost + float(left @ left)

    def predicted(self, x: Array) -> list[tuple[Observed, Predicted]]:
        """At `x` (p,) without derivatives, by data set."""
        offsets = self.offsets(x)
        return [(seen, one.at(offsets, lines, derivatives=False)) for one, lines, seen in self.observed]

    def size(self, x: Array) -> int:
        """Real numbers that the data leave when latent inputs are taken out, and the facts; counted at `x` (p,)."""
        offsets, found = self.offsets(x), len(self.problem.facts)
        for one, lines, _ in self.observed:
            found += likelihood.size(one.measured, one.at(offsets, lines[:1], derivatives=False), len(lines))
        return found


def cost_of(problem: Problem, free: Sequence[Parameter], floor: float, base: Offsets = NOTHING, *, plain: bool = False) -> Cost:
    """The cost of `problem` in the parameters `free`; of a plain fit declared ones have narrower bounds."""
    return Cost(problem=problem, free=tuple(free), floor=floor, base=base, plain=plain)
