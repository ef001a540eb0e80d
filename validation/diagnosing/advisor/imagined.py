"""What a single explanation could be mistaken for: that nothing is missing, or another effect, as far as a straight line goes.

Nobody fitted these. From the Jacobian of the data at the fit that there is, the quadratic model of the cost says where the fit
without the effect would end, and where one with another effect in its place:

    minimum over delta of  1/2 delta^T N delta + g^T delta + 1/2 (x + delta)^T P (x + delta) ,

the sizes of the effect itself at nothing, and P what is known beforehand. That is good enough to ask what a test would read.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from geometry.arrays import Array
from identification.self_calibration.elimination import Normal
from identification.self_calibration.solve import inverse
from validation.diagnosing.advisor.knowledge import SURE, Knowledge, effects_of, knowledge
from validation.diagnosing.bench import Bench, Hypothesis
from validation.diagnosing.classes import opened
from validation.diagnosing.menu import candidates, is_resonator
from validation.effects.catalogue import FAMILIES
from validation.effects.identifiers import Named
from validation.engine.cost import cost_of
from validation.engine.fit import FLOOR
from validation.engine.parameter import EFFECT, FITTED, Parameter
from validation.engine.roots import root
from validation.models.model import Added
from validation.prediction.applied import name

NOTHING = "nothing"

MOST = 1
"""Effects that are imagined in its place."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Imagined:
    """An explanation that nobody fitted.

    Attributes
    ----------
    id : of the effect in its place; "nothing" for none
    known : what the data would say of the parameters by it
    """

    id: str
    known: Knowledge


@dataclass(frozen=True, eq=False, kw_only=True)
class _Ground:
    """The cost to second order in the parameters (p,), about the offsets x (p,) where the fit ended.

    Attributes
    ----------
    parameters : those of the fit, and the sizes of what may stand in place of the effect
    x, data, precision : offsets, cost of the data, and one over the square of what a laboratory admits of each; infinite for none
    """

    parameters: tuple[Parameter, ...]
    x: Array
    data: Normal
    precision: Array


def imagined(bench: Bench, of: Hypothesis) -> tuple[Imagined, ...]:
    """In place of the last effect of a hypothesis: nothing, and the effects that come nearest of those it is mistaken for."""
    effect = of.effects[-1]
    if effect.fixed:
        return (_switched_off(of, effect),)
    menu = lookalikes(bench, effect.named)
    ground = _ground(bench, of, menu)
    without = tuple(one for one in effects_of(of) if one.named.id != effect.named.id)
    found = [_instead(ground, of, effect, without, one) for one in (None, *menu)]
    nothing, *others = (one for one in found if one is not None)
    return (nothing, *sorted(others, key=lambda one: -one.known.log_evidence)[:MOST])


def _switched_off(of: Hypothesis, effect: Added) -> Imagined:
    """Of an effect that is there or not: the same without it, which was not asked for because it is far worse."""
    known = knowledge(of)
    left = tuple(one for one in known.effects if one.named.id != effect.named.id)
    return Imagined(id=NOTHING, known=replace(known, effects=left, log_evidence=of.fit.log_evidence - SURE))


def lookalikes(bench: Bench, named: Named) -> tuple[Added, ...]:
    """The effects for which the catalogue says that `named` is mistaken; of channels the same one, where both are of one."""
    wanted = FAMILIES[named.family].mistaken_for
    found = (one for one in candidates(bench) if one.named.family in wanted or one.named.id in wanted)
    return tuple(one for one in found if not (is_resonator(one.named) or one.fixed) and _shares(one.named, named))


def _shares(one: Named, other: Named) -> bool:
    """Whether two effects act on the same target, of the kinds that both have."""
    first, second = (dict(zip(FAMILIES[each.family].targets, each.targets, strict=False)) for each in (one, other))
    return all(first[kind] == second[kind] for kind in first.keys() & second.keys())


def _ground(bench: Bench, of: Hypothesis, menu: Sequence[Added]) -> _Ground:
    admitted = {one.name: one.tolerance for one in bench.problem(of.effects[:-1]).free(FITTED)}
    problem = opened(of.problem, menu)
    own = {one.name for one in of.fit.parameters}
    free = tuple(one for one in problem.free(FITTED) if one.name in own or one.kind == EFFECT)
    cost = cost_of(problem, free, FLOOR)
    x = cost.at(of.fit.by_name)
    data, count = cost.data(x), len(problem.facts)
    left, rows = (each[len(each) - count :] for each in cost.knowledge(x))
    whole = Normal(
        cost=data.cost + 0.5 * float(left @ left),
        gradient=data.gradient + rows.T @ left,
        matrix=data.matrix + rows.T @ rows,
    )
    precision = np.array([admitted.get(one.name, 0.0) for one in free])
    with np.errstate(divide="ignore"):
        return _Ground(parameters=free, x=x, data=whole, precision=precision**-2.0)


def _instead(at: _Ground, of: Hypothesis, effect: Added, without: tuple[Added, ...], other: Added | None) -> Imagined | None:
    """Where the fit with `other` in place of `effect` would end; None where that acts nowhere."""
    names = [one.name for one in at.parameters]
    sizes = {} if other is None else {name(other.named, size.key): size.plausible for size in other.named.sizes}
    opened_here = [k for k, one in enumerate(names) if one in sizes]
    if other is not None and not opened_here:
        return None
    precision = np.array(at.precision)
    precision[opened_here] = [sizes[names[k]] ** -2.0 for k in opened_here]
    goal = -at.x
    for size in effect.named.sizes:
        if name(effect.named, size.key) in names and size.logarithmic:
            goal[names.index(name(effect.named, size.key))] = -1.0 if size == effect.named.sizes[0] else 0.0
    free, held = np.flatnonzero(np.isfinite(precision)), np.flatnonzero(~np.isfinite(precision))
    delta = np.where(np.isfinite(precision), 0.0, goal)
    P, N = np.diag(precision[free]), at.data.matrix
    pull = at.data.gradient[free] + N[np.ix_(free, held)] @ delta[held] + P @ at.x[free]
    covariance = inverse(N[np.ix_(free, free)] + P)
    delta[free] = -covariance @ pull
    x = at.x + delta
    cost = at.data.cost + float(at.data.gradient @ delta + 0.5 * delta @ N @ delta + 0.5 * x[free] @ P @ x[free])
    kept = [names[k] for k in free]
    offsets = {**of.problem.start, **of.fit.by_name, **dict(zip(kept, map(float, x[free]), strict=True))}
    gone = {names[k] for k in held}
    known = Knowledge(
        effects=without if other is None else (*without, other),
        offsets={one: size for one, size in offsets.items() if one not in gone},
        names=tuple(kept),
        root=root(covariance),
        log_evidence=of.fit.log_evidence + of.fit.cost - cost,
    )
    return Imagined(id=NOTHING if other is None else other.named.id, known=known)
