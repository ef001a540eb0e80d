"""Do weights and periods agree with the campaigns? What the spectra alone say of each number, beside what was measured.

At a fit the facts are left out, the one parameter of the article that a fact is about is freed, the rest of it being as the model
has it, and one step of Gauss and Newton made: with N and g of everything that is free,

    x = -N^-1 g ,      z = r(x) / sqrt(1 + s^T N^-1 s) ,

r being the fact's (predicted - measured) / sd there and s its derivatives: how many standard deviations of both together lie
between what the balance says and what the shaker says.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from geometry.inertia import PARAMETERS
from identification.self_calibration.solve import inverse
from validation.diagnosing.bench import Bench, Hypothesis
from validation.diagnosing.classical.nouns import UNITS
from validation.diagnosing.practical import said
from validation.effects.identifiers import Named
from validation.engine.cost import cost_of
from validation.engine.fit import FLOOR
from validation.engine.problem import Problem
from validation.models.model import Added
from validation.prediction.facts import ArticleFact
from validation.prediction.inertia import WEIGHED

FAMILY = "rigid-inertia"

DISAGREE = 4.0
"""Standard deviations from which a fact and the campaigns contradict each other."""

STANDS_OUT = 3.0
"""Standard deviations of a fact at a fit below which nobody asks."""


@dataclass(frozen=True, kw_only=True)
class Against:
    """One fact beside what the campaigns alone say of it.

    Attributes
    ----------
    name : of the fact
    measured, measured_sd : by balance, crane or pendulum, SI
    said, said_sd : by the campaigns, SI
    unit : of them
    sigma : (said - measured) / standard deviation of both
    """

    name: str
    measured: float
    measured_sd: float
    said: float
    said_sd: float
    unit: str
    sigma: float

    @property
    def text(self) -> str:
        """In words."""
        away, told = abs(self.said - self.measured), said(self.said_sd, self.unit)
        return (
            f"{self.name} and the campaigns disagree by {said(away, self.unit)}, {abs(self.sigma):.0f} sigma: measured is "
            f"{said(self.measured, self.unit, 4)}, the campaigns alone say {said(self.said, self.unit, 4)} ± {told}"
        )


def contradictions(bench: Bench, base: Hypothesis, found: Hypothesis) -> tuple[str, ...]:
    """Each fact that contradicts the campaigns by the model as it is, `base`, and whether what was `found` settles it.

    Where that model meets all facts, nothing is computed.
    """
    offsets = {**base.problem.start, **base.fit.by_name}
    if all(abs(fact.residual(offsets)[0]) < STANDS_OUT for fact in base.problem.facts):
        return ()
    odd = [one for one in against(bench, base) if abs(one.sigma) > DISAGREE]
    others = [one.named.id for one in found.effects if one.named.family not in WEIGHED]
    then = {one.name: one.sigma for one in against(bench, found)} if odd and others else {}
    return tuple(f"{one.text}{_settled(then.get(one.name), others)}" for one in odd)


def _settled(sigma: float | None, effects: list[str]) -> str:
    """What effects of the measurement make of a contradiction; nothing where none was found."""
    if sigma is None:
        return ""
    return f"; with {', '.join(effects)} they {'agree' if abs(sigma) < DISAGREE else 'still disagree'}"


def against(bench: Bench, at: Hypothesis) -> tuple[Against, ...]:
    """Every fact about an article that was on the shaker, beside what the campaigns alone say at the fit of `at`."""
    every = (*bench.model.effects, *at.effects)
    facts = [fact for fact in bench.facts(every) if isinstance(fact, ArticleFact)]
    return tuple(one for article in dict.fromkeys(fact.of.article for fact in facts) for one in _of(bench, at, article, facts))


def _of(bench: Bench, at: Hypothesis, article: str, facts: list[ArticleFact]) -> Iterator[Against]:
    every = (*bench.model.effects, *at.effects)
    freed = (*every, *_ten(every))
    if not any(one.tested.carried.standing.article == article for one in bench.made):
        return
    made = tuple(one.with_effects(freed if one.tested.carried.standing.article == article else every) for one in bench.made)
    problem = Problem(made).thinned()
    known = {one.name for one in at.fit.parameters}
    free = [one for one in problem.parameters if one.name in known or one.name.startswith(FAMILY)]
    cost = cost_of(problem, free, FLOOR, at.fit.by_name)
    x = cost.at({**{one.name: 0.0 for one in free}, **at.fit.by_name})
    whole, _, _ = cost.total(x)
    for fact in facts:
        if fact.of.article == article:
            about = {f"{FAMILY}:{name}" for name, weight in zip(PARAMETERS, fact.weights, strict=True) if weight}
            moving = [k for k, name in enumerate(cost.names) if name in known or name in about]
            C = inverse(whole.matrix[np.ix_(moving, moving)])
            y = x.copy()
            y[moving] -= C @ whole.gradient[moving]
            own = fact.with_effects(freed)
            here = {one.name: one.start for one in own.parameters} | at.fit.by_name | dict(zip(cost.names, y, strict=True))
            z, slopes = own.residual(here)
            s = np.array([slopes.get(cost.names[k], 0.0) for k in moving])
            yield _against(own, z, float(s @ C @ s))


def _ten(every: tuple[Added, ...]) -> tuple[Added, ...]:
    there = {one.named.id for one in every}
    named = (Named(family=FAMILY, targets=(name,), values={"": 0.0}) for name in PARAMETERS)
    return tuple(Added(named=one) for one in named if one.id not in there)


def _against(fact: ArticleFact, z: float, variance: float) -> Against:
    return Against(
        name=fact.name,
        measured=fact.value,
        measured_sd=fact.deviation,
        said=fact.value + z * fact.deviation,
        said_sd=float(np.sqrt(variance)) * fact.deviation,
        unit=UNITS[int(np.argmax(np.abs(fact.weights)))],
        sigma=z / float(np.sqrt(1 + variance)),
    )
