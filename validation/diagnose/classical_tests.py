"""Which measurement would tell the explanations apart, and how surely: every test of the menu thought through for each of them.

Were explanation i true, at the size that it was found to have, the measurements made and the new one would be what it says; the
evidence of every explanation on these, without noise, is what is to be expected. The gain of a test is that of the true one
against the mean of the others, and the mean of that over the explanations, each as probable as it is now.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial import chebyshev

from geometry.errors import BadInput
from geometry.frames import Array
from geometry.inertia import Inertia
from geometry.toml_file import exact, tagged
from identification import request
from identification.quality import NORMAL_95
from validation.classical.pendulum import CompoundSwing, RecordedSwing, RopeSwing, TorsionSwing
from validation.diagnose.classical import (
    DEGREE,
    ClassicalCandidateFit,
    InterpolatedCurve,
    ObservedFacts,
    evidence,
    inverse_covariance,
    observed,
    shifted,
)
from validation.diagnose.diagnosis import Advice
from validation.effects.effect import INDISTINGUISHABLE_NATS
from validation.effects.practical_units import said
from validation.effects.stages import Matrices, heavier
from validation.prediction import classical_facts
from validation.prediction.classical_facts import ArticleFact, Input, covariance, spread

if TYPE_CHECKING:
    from uncertainties import UFloat


# What a laboratory might measure next with a balance, ropes and a watch: the tests among which an advice is chosen.
#
# A swing that was not made yet is one that was, under other conditions, its tolerances as they are stated there; what stays as
# it was (the mass, the same ropes) stays one input, so that the tolerance of it does not blur a difference. Other instruments
# are those that a workshop has; how good they are stands in the words of the test.


Pendulum = RopeSwing | CompoundSwing | TorsionSwing

HALF = 0.5
"""[factor] by which the other test differs: shorter or lighter, or twice as well known. By definition."""

BALANCE = 5e-4
"""[share] One sd of a mass on the balance of an article. Exercised by tests/validation/diagnosing/test_swings.py."""

SMALL_BALANCE = 1e-3
"""[kg] One sd of the mass of the ropes. Exercised by tests/validation/diagnosing/test_swings.py."""

RULER = 2.5e-4
"""[m] One sd of a stretch; a ruler reads 0.5 mm. Exercised by tests/validation/diagnosing/test_swings.py."""

SHARE = 5e-3
"""[share] of the weight: one sd of what a rope carries. Exercised by tests/validation/diagnosing/test_swings.py."""

DECAY = 2.5e-4
"""[1] One sd of a damping ratio from a decay. Exercised by tests/validation/diagnosing/test_swings.py."""

CRANE = 5e-4
"""[m] One sd of a centre of gravity on the crane. Exercised by tests/validation/diagnosing/test_swings.py."""

OFF_CENTRE = "off-centre-suspension"


@dataclass(frozen=True, eq=False, kw_only=True)
class PossibleMeasurement:
    """A measurement that was not made.

    Attributes
    ----------
    text : what to do
    facts : what it would say, by the model
    told : by family the standard deviation with which it says the size of an effect directly
    """

    text: str
    facts: tuple[ArticleFact, ...] = ()
    told: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))


def menu(of: ObservedFacts) -> tuple[PossibleMeasurement, ...]:
    """What could be measured beside what was."""
    swings = [n for n, fact in enumerate(of.facts) if fact.swing is not None]
    if not swings:
        return tuple(_of_body(of))
    base = of.facts[max(swings, key=lambda n: abs(of.left[n]) / of.deviation[n])]
    return (*_of_swing(base), *_of_axes(of, base), *_of_body(of))


def _of_swing(fact: ArticleFact) -> Iterator[PossibleMeasurement]:
    """The same pendulum under other conditions, and its parts by themselves."""
    swing = _swing(fact)
    if _acts(classical_facts.AMPLITUDE, swing):
        shares = {**fact.shares, classical_facts.AMPLITUDE: HALF * fact.shares.get(classical_facts.AMPLITUDE, 1.0)}
        yield PossibleMeasurement(text="swing it once more, half as wide", facts=(another(fact, swing.pendulum, shares=shares),))
    if _acts(classical_facts.DAMPING, swing):
        text = "record the decay of the swing, and from it the damping (to 0.05 %)"
        yield PossibleMeasurement(text=text, told={classical_facts.DAMPING: DECAY})
    if isinstance(swing.pendulum, RopeSwing):
        yield from _of_ropes(fact, swing, swing.pendulum)


def _of_ropes(fact: ArticleFact, swing: RecordedSwing, ropes: RopeSwing) -> Iterator[PossibleMeasurement]:
    shorter = replace(ropes, length=_scaled(ropes.length, HALF, "rope length"))
    shares = {
        **fact.shares,
        **{name: HALF * fact.shares.get(name, 1.0) for name in (classical_facts.ROPE_MASS, classical_facts.STRETCH)},
    }
    length = said(shorter.length.nominal_value, "m", 3)
    yield PossibleMeasurement(text=f"hang it on ropes half as long, {length}", facts=(another(fact, shorter, shares=shares),))
    s1, s2 = (_scaled(one, HALF, name) for one, name in ((ropes.s1, "s1"), (ropes.s2, "s2")))
    yield PossibleMeasurement(
        text="hang the ropes half as far from the centre of gravity", facts=(another(fact, replace(ropes, s1=s1, s2=s2)),)
    )
    # With half its mass more, in two known weights on either side at the ropes
    mass, square = HALF * ropes.mass.nominal_value, abs(ropes.s1.nominal_value * ropes.s2.nominal_value)
    loaded_radius = float(np.sqrt(square))
    more = replace(fact, of=replace(fact.of, drawn=_with_weights(fact, mass, loaded_radius)))
    loaded_text = f"add two known masses of {said(mass / 2, 'kg', 2)} on either side, {said(loaded_radius, 'm', 2)} from the axis"
    loaded = PossibleMeasurement(text=loaded_text, facts=(another(more, replace(ropes, mass=ropes.mass + exact(mass))),))
    yield loaded
    if _acts(classical_facts.ROPE_MASS, swing):
        yield PossibleMeasurement(text="weigh the ropes (to 2 g)", told={classical_facts.ROPE_MASS: SMALL_BALANCE})
    load = ropes.mass.nominal_value * ropes.gravity.nominal_value / max(swing.ropes, 1)
    text = "measure the ropes with and without the load (to 0.5 mm)"
    yield PossibleMeasurement(text=text, told={classical_facts.STRETCH: RULER / load})
    radius = float(np.sqrt(abs(ropes.s1.nominal_value * ropes.s2.nominal_value)))
    yield PossibleMeasurement(text="measure what each rope carries (to 1 % of the weight)", told={OFF_CENTRE: SHARE * radius})


def _with_weights(fact: ArticleFact, mass: float, radius: float) -> Matrices:
    """The article of `fact` with half of `mass` [kg] on either side of its CoG, `radius` [m] from the axis of the swing."""
    axis = np.asarray(_swing(fact).axis)
    aside = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    aside *= radius / np.linalg.norm(aside)
    tensor = mass * (aside @ aside * np.eye(3) - np.outer(aside, aside))
    weights = Inertia.from_cog(mass=mass, cog=_ten(fact)[1:4], tensor=tensor).about(np.zeros(3))
    drawn = fact.of.drawn
    added = np.zeros_like(drawn.mass)
    added[:6, :6] = weights.mass_matrix
    return heavier(drawn, added)


def _of_axes(of: ObservedFacts, base: ArticleFact) -> Iterator[PossibleMeasurement]:
    """About an axis that nobody swung it about, on the same ropes."""
    swung_about = {tuple(np.round(np.abs(fact.swing.axis), 9)) for fact in of.facts if fact.swing is not None}
    for name, axis in zip("xyz", np.eye(3), strict=True):
        if tuple(axis) not in swung_about:
            weights = np.concatenate([np.zeros(4), axis, np.zeros(3)])
            fact = another(replace(base, weights=weights), _swing(base).pendulum)
            yield PossibleMeasurement(text=f"swing it about {name} too", facts=(fact,))


def _of_body(of: ObservedFacts) -> Iterator[PossibleMeasurement]:
    """A balance, and a crane beside it."""
    known = [fact.weights for fact in of.facts]
    if not of.facts:
        return
    fact = of.facts[0]
    if not any(weights[0] for weights in known):
        yield PossibleMeasurement(text="weigh it (to 0.1 %)", facts=(_fact(fact, 0, BALANCE * _ten(fact)[0]),))
    for axis in range(3):
        if not any(weights[1 + axis] for weights in known):
            text = f"find its centre of gravity along {'xyz'[axis]} by crane and balance (to 1 mm)"
            yield PossibleMeasurement(text=text, facts=(_fact(fact, 1 + axis, CRANE),))


def another(fact: ArticleFact, pendulum: Pendulum, *, shares: Mapping[str, float] | None = None) -> ArticleFact:
    """`fact` had it been measured on another `pendulum`, at the period that the model then says."""
    swing = replace(_swing(fact), pendulum=pendulum)
    period = _period(swing, float(fact.weights @ _ten(fact)))
    was = swing.pendulum.period
    read = tagged(period, period * was.std_dev / was.nominal_value, "period")
    swing = replace(swing, pendulum=replace(swing.pendulum, period=read))
    moment = swing.moment
    own = spread(moment)
    deviation = float(np.sqrt(sum(part**2 for part in own.values())))
    return replace(
        fact,
        name="what was not measured",
        swing=swing,
        value=float(moment.nominal_value),
        deviation=deviation,
        spread=own,
        shares=fact.shares if shares is None else shares,
    )


def period_per_inertia(fact: ArticleFact) -> float:
    """Relative change of the period of a swing per kg m²."""
    swing = _swing(fact)
    T = float(swing.pendulum.period.nominal_value)
    step = 1e-4
    return 2 * step / (swing.moment_at(T * (1 + step)) - swing.moment_at(T * (1 - step)))


def _period(swing: RecordedSwing, moment: float) -> float:
    """[s] with which `swing` says this `moment`: its square is linear in the period's, but for the correction of an amplitude."""
    T = float(swing.pendulum.period.nominal_value)
    for _ in range(8):
        slope = (swing.moment_at(1.001 * T) - swing.moment_at(T)) / (1.001**2 - 1)
        T *= float(np.sqrt(max(1 + (moment - swing.moment_at(T)) / slope, 0.1)))
    return T


def _fact(fact: ArticleFact, k: int, deviation: float) -> ArticleFact:
    """Quantity `k` of its article measured to `deviation` by an instrument of its own."""
    weights = np.eye(10)[k]
    one = Input(name="instrument", value=0.0, deviation=deviation, reading=object())
    return replace(
        fact,
        name="what was not measured",
        weights=weights,
        value=float(weights @ _ten(fact)),
        deviation=deviation,
        spread={one: deviation},
        swing=None,
        effects=(),
    )


def _ten(fact: ArticleFact) -> Array:
    """(10,) quantities of its article by the model with its own effects."""
    return request.quantities(fact.of.ten({one.name: one.start for one in fact.of.parameters}))


def _acts(family: str, swing: RecordedSwing) -> bool:
    from validation.diagnose.classical import at_prior_sd

    return classical_facts.acts(at_prior_sd(family), swing)


def _scaled(value: UFloat, factor: float, name: str) -> UFloat:
    """Another length, measured as well as this one."""
    return tagged(factor * value.nominal_value, value.std_dev, name)


def _swing(fact: ArticleFact) -> RecordedSwing:
    if fact.swing is None:
        raise ValueError("`fact` must be of a swing")
    return fact.swing


EXPLANATIONS_TOLD_APART = 6
"""[count] of explanations that are told apart at most, the best of each family first. Exercised by
tests/validation/diagnosing/test_swings.py."""

SURE = 30.0
"""[nats] beyond which nobody is surer. Exercised by tests/validation/diagnosing/test_swings.py."""

WORTH_WHILE = 1.0
"""[nats] below which a test is not worth the work. Exercised by tests/validation/diagnosing/test_swings.py."""

NAMED = 3
"""[count] of explanations whose expected reading stands in the words of a test. Exercised by
tests/validation/diagnosing/test_swings.py."""


@dataclass(frozen=True, eq=False, kw_only=True)
class _Thought:
    """A test thought through.

    Attributes
    ----------
    trial : of the menu
    curves : by explanation what measurements and test say of every size
    covariance : (n, n) of measurements and test
    """

    trial: PossibleMeasurement
    curves: tuple[InterpolatedCurve, ...]
    covariance: Array


def advised_measurements(
    of: ObservedFacts, rivals: Sequence[ClassicalCandidateFit], progress: Callable[[float], None] | None = None
) -> tuple[Advice, ...]:
    """The tests that tell `rivals` apart, the most telling first; of a single one, those that add most to its evidence."""
    if not rivals:
        return ()
    # The best of every family first: places of one are much alike
    families = [one.candidate.added.named.family for one in rivals]
    first = [one for k, one in enumerate(rivals) if families[k] not in families[:k]]
    various = [*first, *(one for one in rivals if one not in first)]
    chosen = various[:EXPLANATIONS_TOLD_APART]
    now = _Thought(
        trial=PossibleMeasurement(text=""), curves=tuple(one.curve for one in chosen), covariance=np.array(of.covariance)
    )
    before = _gains(_evidence(chosen, now))
    advice, trials = [], menu(of)
    for k, trial in enumerate(trials, start=1):
        if (one := _thought(of, chosen, trial)) is not None:
            advice.append(_advice(of, chosen, one, before))
        if progress is not None:
            progress(k / len(trials))
    return tuple(sorted((one for one in advice if one.gain > WORTH_WHILE), key=lambda one: -one.gain))


def _thought(of: ObservedFacts, rivals: Sequence[ClassicalCandidateFit], trial: PossibleMeasurement) -> _Thought | None:
    """`trial` by every one of `rivals`; None where one of them has no answer to it."""
    more = observed(trial.facts, of.own)
    try:
        curves = tuple(_longer(one, more, trial) for one in rivals)
    except (BadInput, ValueError):
        return None
    every = covariance([fact.spread for fact in (*of.facts, *trial.facts)])
    n, m = len(every), len(trial.told)
    C = np.zeros((n + m, n + m))
    C[:n, :n], C[n:, n:] = every, np.diag(np.square(list(trial.told.values())))
    return _Thought(trial=trial, curves=curves, covariance=C)


def _longer(one: ClassicalCandidateFit, more: ObservedFacts, trial: PossibleMeasurement) -> InterpolatedCurve:
    """The curve of an explanation with what it says of the test behind it."""
    points = chebyshev.chebpts1(DEGREE + 1)
    sizes = 0.5 * (one.curve.low + one.curve.high) + 0.5 * (one.curve.high - one.curve.low) * points
    family = one.candidate.added.named.family
    told = np.array([[size * (name == family) for name in trial.told] for size in sizes]).reshape(len(sizes), len(trial.told))
    values = np.concatenate([shifted(more, one.candidate.added, sizes), told], axis=1)
    coefficients = np.concatenate([one.curve.coefficients, chebyshev.chebfit(points, values, DEGREE)], axis=1)
    return InterpolatedCurve(low=one.curve.low, high=one.curve.high, coefficients=coefficients)


def _advice(of: ObservedFacts, rivals: Sequence[ClassicalCandidateFit], one: _Thought, before: Array) -> Advice:
    told = _evidence(rivals, one)
    now = np.array([rival.found.evidence for rival in rivals])
    share = np.exp(now - now.max())
    least = [row[k] - np.delete(row, k).max(initial=-np.inf) for k, row in enumerate(told)]
    # By how much the new period would differ from the model's, by each of the explanations, and what tolerances see
    if not one.trial.facts or one.trial.facts[0].swing is None:
        figures: str = ""
    else:
        n, C = len(of.facts), one.covariance
        per = period_per_inertia(one.trial.facts[0])
        figures_told = [
            f"{-per * left[n]:+.2%} if it is {rival.id}" for rival, left in zip(rivals, _truths(rivals, one), strict=True)
        ]
        more = f" and {len(figures_told) - NAMED} more" if len(figures_told) > NAMED else ""
        own = float(np.sqrt(max(C[n, n] - C[n, :n] @ np.linalg.solve(C[:n, :n], C[:n, n]), 0.0)))
        seen = f"tolerances that it does not share with what was measured are ± {said(NORMAL_95 * per * own, '1')}"
        figures = f": its period is then off the model's by {', '.join(figures_told[:NAMED])}{more}; {seen} of it"
    return Advice(
        test=f"{one.trial.text}{figures}",
        gain=float(share @ (_gains(told) - before) / share.sum()),
        separates=tuple(
            rival.id for rival, apart in zip(rivals, least, strict=True) if apart > INDISTINGUISHABLE_NATS and len(rivals) > 1
        ),
    )


def _gains(told: Array) -> Array:
    """(k,) of every explanation, were it true: evidence against the mean of the others, `SURE` at most; alone against none."""
    if len(told) == 1:
        return np.asarray(told[0])
    others = [np.logaddexp.reduce(np.delete(row, k)) - np.log(len(row) - 1) for k, row in enumerate(told)]
    return np.asarray(np.clip(np.diag(told) - np.array(others), -SURE, SURE))


def _evidence(rivals: Sequence[ClassicalCandidateFit], of: _Thought) -> Array:
    """(k, k) were the first true, of the second, without noise."""
    precision = inverse_covariance(of.covariance)
    pairs = list(zip(rivals, of.curves, strict=True))
    told = [
        [evidence(curve, rival.answering.plausible, left, precision) for rival, curve in pairs] for left in _truths(rivals, of)
    ]
    return np.array(told)


def _truths(rivals: Sequence[ClassicalCandidateFit], of: _Thought) -> list[Array]:
    """By explanation what would be left of measurements and test by the model without it."""
    return [-curve.at(np.array([rival.found.value]))[0] for rival, curve in zip(rivals, of.curves, strict=True)]
