"""Which measurement would tell the explanations apart, and how surely: every test of the menu thought through for each of them.

Were explanation i true, at the size that it was found to have, the measurements made and the new one would be what it says; the
evidence of every explanation on these, without noise, is what is to be expected. The gain of a test is that of the true one
against the mean of the others, and the mean of that over the explanations, each as probable as it is now.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType

import numpy as np
from numpy.polynomial import chebyshev

from geometry.errors import BadInput
from geometry.frames import Array
from geometry.inertia import Inertia
from geometry.toml_file import exact, tagged
from identification import request
from identification.quality import NORMAL_95
from validation.classical.pendulum import CompoundSwing, RecordedSwing, RopeSwing, TorsionSwing
from validation.diagnose import classical
from validation.diagnose.diagnosis import Advice
from validation.effects.effect import INDISTINGUISHABLE_NATS
from validation.effects.practical_units import said
from validation.effects.stages import heavier
from validation.prediction import classical_facts
from validation.prediction.classical_facts import ArticleFact, Input, covariance, spread

# What a laboratory might measure next with a balance, ropes and a watch: the tests among which an advice is chosen.
#
# A swing that was not made yet is one that was, under other conditions, its tolerances as they are stated there; what stays as
# it was (the mass, the same ropes) stays one input, so that the tolerance of it does not blur a difference. Other instruments
# are those that a workshop has; how good they are stands in the words of the test.


Pendulum = RopeSwing | CompoundSwing | TorsionSwing

HALF = 0.5
"""[factor] by which the other test differs: shorter or lighter, or twice as well known. By definition."""

BALANCE = 5e-4
"""[share] One sd of a mass on the balance of an article. Exercised by test_classical.py."""

SMALL_BALANCE = 1e-3
"""[kg] One sd of the mass of the ropes. Exercised by test_classical.py."""

RULER = 2.5e-4
"""[m] One sd of a stretch; a ruler reads 0.5 mm. Exercised by test_classical.py."""

SHARE = 5e-3
"""[share] of the weight: one sd of what a rope carries. Exercised by test_classical.py."""

DECAY = 2.5e-4
"""[1] One sd of a damping ratio from a decay. Exercised by test_classical.py."""

CRANE = 5e-4
"""[m] One sd of a centre of gravity on the crane. Exercised by test_classical.py."""

OFF_CENTRE = "off-centre-suspension"

DIRECTLY = (classical_facts.AMPLITUDE, classical_facts.DAMPING, classical_facts.ROPE_MASS)
"""Families of which a test is offered where a swing has them."""

UNMEASURED = "what was not measured"


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


def menu(of: classical.ObservedFacts) -> tuple[PossibleMeasurement, ...]:
    """What could be measured beside what was."""
    swings = [n for n, fact in enumerate(of.facts) if fact.swing is not None]
    offered: list[PossibleMeasurement] = []
    if swings:
        base = of.facts[max(swings, key=lambda n: abs(of.left[n]) / of.deviation[n])]
        swing = _swing(base)
        shares, pendulum = {**base.shares}, swing.pendulum
        acting = {one for one in DIRECTLY if classical_facts.acts(classical.at_prior_sd(one), swing)}
        if classical_facts.AMPLITUDE in acting:
            half = {**shares, classical_facts.AMPLITUDE: HALF * shares.get(classical_facts.AMPLITUDE, 1.0)}
            offered.append(_offer("swing it once more, half as wide", another(base, pendulum, shares=half)))
        if classical_facts.DAMPING in acting:
            text = "record the decay of the swing, and from it the damping (to 0.05 %)"
            offered.append(PossibleMeasurement(text=text, told={classical_facts.DAMPING: DECAY}))
        if isinstance(pendulum, RopeSwing):
            offered += _on_ropes(base, pendulum, weighed=classical_facts.ROPE_MASS in acting)
        # About an axis that nobody swung it about, on the same ropes
        swung_about = {tuple(np.round(np.abs(fact.swing.axis), 9)) for fact in of.facts if fact.swing is not None}
        for name, axis in zip("xyz", np.eye(3), strict=True):
            if tuple(axis) not in swung_about:
                weights = np.concatenate([np.zeros(4), axis, np.zeros(3)])
                offered.append(_offer(f"swing it about {name} too", another(replace(base, weights=weights), pendulum)))
    # A balance, and a crane beside it
    texts = ["weigh it (to 0.1 %)"]
    texts += [f"find its centre of gravity along {axis} by crane and balance (to 1 mm)" for axis in "xyz"]
    for k, text in enumerate(texts):
        if of.facts and not any(fact.weights[k] for fact in of.facts):
            fact, weights = of.facts[0], np.eye(10)[k]
            value = float(weights @ _ten(fact))
            sd = CRANE if k else BALANCE * value
            one = Input(name="instrument", value=0.0, deviation=sd, reading=object())  # an instrument of its own
            measured = replace(
                fact, name=UNMEASURED, weights=weights, value=value, deviation=sd, spread={one: sd}, swing=None, effects=()
            )
            offered.append(_offer(text, measured))
    return tuple(offered)


def _offer(text: str, fact: ArticleFact) -> PossibleMeasurement:
    return PossibleMeasurement(text=text, facts=(fact,))


def _on_ropes(fact: ArticleFact, ropes: RopeSwing, *, weighed: bool) -> Iterator[PossibleMeasurement]:
    """The same pendulum under other conditions, each length measured as well as it is, and its parts by themselves."""
    swing = _swing(fact)
    length, s1, s2 = (
        tagged(HALF * one.nominal_value, one.std_dev, name)
        for one, name in ((ropes.length, "rope length"), (ropes.s1, "s1"), (ropes.s2, "s2"))
    )
    halved = {one: HALF * fact.shares.get(one, 1.0) for one in (classical_facts.ROPE_MASS, classical_facts.STRETCH)}
    shorter = another(fact, replace(ropes, length=length), shares={**fact.shares, **halved})
    yield _offer(f"hang it on ropes half as long, {said(length.nominal_value, 'm', 3)}", shorter)
    yield _offer("hang the ropes half as far from the centre of gravity", another(fact, replace(ropes, s1=s1, s2=s2)))
    # With half its mass more, in two known weights on either side of its CoG at the ropes
    mass, radius = HALF * ropes.mass.nominal_value, float(np.sqrt(abs(ropes.s1.nominal_value * ropes.s2.nominal_value)))
    axis = np.asarray(swing.axis)
    aside = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    aside *= radius / np.linalg.norm(aside)
    tensor = mass * (aside @ aside * np.eye(3) - np.outer(aside, aside))
    added = np.zeros_like(fact.of.drawn.mass)
    added[:6, :6] = Inertia.from_cog(mass=mass, cog=_ten(fact)[1:4], tensor=tensor).about(np.zeros(3)).mass_matrix
    loaded = another(
        replace(fact, of=replace(fact.of, drawn=heavier(fact.of.drawn, added))), replace(ropes, mass=ropes.mass + exact(mass))
    )
    yield _offer(
        f"add two known masses of {said(mass / 2, 'kg', 2)} on either side, {said(radius, 'm', 2)} from the axis", loaded
    )
    if weighed:
        yield PossibleMeasurement(text="weigh the ropes (to 2 g)", told={classical_facts.ROPE_MASS: SMALL_BALANCE})
    load = ropes.mass.nominal_value * ropes.gravity.nominal_value / max(swing.ropes, 1)
    text = "measure the ropes with and without the load (to 0.5 mm)"
    yield PossibleMeasurement(text=text, told={classical_facts.STRETCH: RULER / load})
    yield PossibleMeasurement(text="measure what each rope carries (to 1 % of the weight)", told={OFF_CENTRE: SHARE * radius})


def another(fact: ArticleFact, pendulum: Pendulum, *, shares: Mapping[str, float] | None = None) -> ArticleFact:
    """`fact` had it been measured on another `pendulum`, at the period that the model then says."""
    swing, goal = replace(_swing(fact), pendulum=pendulum), float(fact.weights @ _ten(fact))
    # [s] The moment's square is linear in the period's, but for the correction of an amplitude
    period = float(pendulum.period.nominal_value)
    for _ in range(8):
        slope = (swing.moment_at(1.001 * period) - swing.moment_at(period)) / (1.001**2 - 1)
        period *= float(np.sqrt(max(1 + (goal - swing.moment_at(period)) / slope, 0.1)))
    was = pendulum.period
    read = tagged(period, period * was.std_dev / was.nominal_value, "period")
    swing = replace(swing, pendulum=replace(pendulum, period=read))
    moment = swing.moment
    own = spread(moment)
    return replace(
        fact,
        name=UNMEASURED,
        swing=swing,
        value=float(moment.nominal_value),
        deviation=float(np.sqrt(sum(part**2 for part in own.values()))),
        spread=own,
        shares=fact.shares if shares is None else shares,
    )


def period_per_inertia(fact: ArticleFact) -> float:
    """Relative change of the period of a swing per kg m²."""
    swing = _swing(fact)
    T = float(swing.pendulum.period.nominal_value)
    step = 1e-4
    return 2 * step / (swing.moment_at(T * (1 + step)) - swing.moment_at(T * (1 - step)))


def _ten(fact: ArticleFact) -> Array:
    """(10,) quantities of its article by the model with its own effects."""
    return request.quantities(fact.of.ten({one.name: one.start for one in fact.of.parameters}))


def _swing(fact: ArticleFact) -> RecordedSwing:
    if fact.swing is None:
        raise ValueError("`fact` must be of a swing")
    return fact.swing


EXPLANATIONS_TOLD_APART = 6
"""[count] of explanations that are told apart at most, the best of each family first. Exercised by test_classical.py."""

SURE = 30.0
"""[nats] beyond which nobody is surer. Held by test_classical.py."""

WORTH_WHILE = 1.0
"""[nats] below which a test is not worth the work. Exercised by test_classical.py."""

NAMED = 3
"""[count] of explanations whose expected reading stands in the words of a test. Exercised by test_classical.py."""


@dataclass(frozen=True, eq=False, kw_only=True)
class _Expected:
    """What explanations say of measurements and a test.

    Attributes
    ----------
    rivals : the explanations
    curves : of each, what measurements and test say of every size
    covariance : (n, n) of measurements and test
    """

    rivals: tuple[classical.ClassicalCandidateFit, ...]
    curves: tuple[classical.InterpolatedCurve, ...]
    covariance: Array

    @property
    def truths(self) -> list[Array]:
        """By explanation what would be left of measurements and test by the model without it."""
        return [-curve.at(np.array([one.found.value]))[0] for one, curve in zip(self.rivals, self.curves, strict=True)]

    @cached_property
    def told(self) -> Array:
        """(k, k) evidence, were the first true, of the second, without noise."""
        precision = classical.inverse_covariance(self.covariance)
        pairs = list(zip(self.rivals, self.curves, strict=True))
        return np.array(
            [
                [classical.evidence(curve, one.answering.plausible, left, precision) for one, curve in pairs]
                for left in self.truths
            ]
        )

    @property
    def gains(self) -> Array:
        """(k,) of each, were it true: evidence against the mean of the others, `SURE` at most; alone against none."""
        told = self.told
        if len(told) == 1:
            return np.asarray(told[0])
        others = [np.logaddexp.reduce(np.delete(row, k)) - np.log(len(row) - 1) for k, row in enumerate(told)]
        return np.asarray(np.clip(np.diag(told) - np.array(others), -SURE, SURE))

    def with_test(self, of: classical.ObservedFacts, trial: PossibleMeasurement) -> "_Expected | None":
        """With what each says of `trial` behind it; None where one of them has no answer to that."""
        more, points = classical.observed(trial.facts, of.own), chebyshev.chebpts1(classical.DEGREE + 1)
        curves = []
        for one in self.rivals:
            low, high, family = one.curve.low, one.curve.high, one.candidate.added.named.family
            sizes = 0.5 * (low + high) + 0.5 * (high - low) * points
            told = np.array([[size * (name == family) for name in trial.told] for size in sizes])
            try:
                answers = classical.shifted(more, one.candidate.added, sizes)
            except (BadInput, ValueError):
                return None
            values = np.concatenate([answers, told.reshape(len(sizes), len(trial.told))], axis=1)
            coefficients = np.concatenate([one.curve.coefficients, chebyshev.chebfit(points, values, classical.DEGREE)], axis=1)
            curves.append(classical.InterpolatedCurve(low=low, high=high, coefficients=coefficients))
        every = covariance([fact.spread for fact in (*of.facts, *trial.facts)])
        n, m = len(every), len(trial.told)
        C = np.zeros((n + m, n + m))
        C[:n, :n], C[n:, n:] = every, np.diag(np.square(list(trial.told.values())))
        return replace(self, curves=tuple(curves), covariance=C)


def advised_measurements(
    of: classical.ObservedFacts,
    rivals: Sequence[classical.ClassicalCandidateFit],
    progress: Callable[[float], None] | None = None,
) -> tuple[Advice, ...]:
    """The tests that tell `rivals` apart, the most telling first; of a single one, those that add most to its evidence."""
    if not rivals:
        return ()
    # The best of every family first: places of one are much alike
    families = [one.candidate.added.named.family for one in rivals]
    first = [one for k, one in enumerate(rivals) if families[k] not in families[:k]]
    chosen = (*first, *(one for one in rivals if one not in first))[:EXPLANATIONS_TOLD_APART]
    now = _Expected(rivals=chosen, curves=tuple(one.curve for one in chosen), covariance=np.array(of.covariance))
    before, probable = now.gains, np.array([one.found.evidence for one in chosen])
    share = np.exp(probable - probable.max())
    advice, trials, n = [], menu(of), len(of.facts)
    for k, trial in enumerate(trials, start=1):
        if (then := now.with_test(of, trial)) is not None:
            least = [row[k] - np.delete(row, k).max(initial=-np.inf) for k, row in enumerate(then.told)]
            apart = tuple(one.id for one, nats in zip(chosen, least, strict=True) if nats > INDISTINGUISHABLE_NATS)
            text = trial.text
            if trial.facts and trial.facts[0].swing is not None:
                # By how much the new period would differ from the model's, by each of the explanations, and what tolerances see
                C, per = then.covariance, period_per_inertia(trial.facts[0])
                figures = [f"{-per * left[n]:+.2%} if it is {one.id}" for one, left in zip(chosen, then.truths, strict=True)]
                more = f" and {len(figures) - NAMED} more" if len(figures) > NAMED else ""
                own = float(np.sqrt(max(C[n, n] - C[n, :n] @ np.linalg.solve(C[:n, :n], C[:n, n]), 0.0)))
                seen = f"tolerances that it does not share with what was measured are ± {said(NORMAL_95 * per * own, '1')}"
                text += f": its period is then off the model's by {', '.join(figures[:NAMED])}{more}; {seen} of it"
            gain = float(share @ (then.gains - before) / share.sum())
            advice.append(Advice(test=text, gain=gain, separates=apart if len(chosen) > 1 else ()))
        if progress is not None:
            progress(k / len(trials))
    return tuple(sorted((one for one in advice if one.gain > WORTH_WHILE), key=lambda one: -one.gain))
