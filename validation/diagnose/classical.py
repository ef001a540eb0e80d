"""`SwingAnswer`: what a diagnosis of classical measurements alone says, with everything that it rests on."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import combinations
from types import MappingProxyType

import numpy as np
from numpy.polynomial import chebyshev

from geometry.errors import BadInput
from geometry.frames import Array, frozen
from geometry.inertia import PARAMETERS
from geometry.toml_file import nearest
from identification.quality import NORMAL_95
from validation.classical.pendulum import CompoundSwing, RopeSwing
from validation.diagnose.diagnosis import AMBIGUOUS, MISSING, NOTHING, SEVERAL, UNKNOWN, Advice, Cause, Detectable, Leftover
from validation.effects.catalogue import FAMILIES, Named
from validation.effects.effect import EVIDENCE_THRESHOLD, INDISTINGUISHABLE_NATS, PENDULUM, PERIOD_STAGE, SizeSpec
from validation.effects.practical_units import said
from validation.model.model import Added
from validation.output import derived, entry, unwritten
from validation.prediction import classical_facts
from validation.prediction.classical_facts import WEIGHED, ArticleFact, Input, covariance

UNITS = ("kg", "m", "m", "m", *("kg m^2",) * 6)
"""SI, of the quantities of `identification.request`."""


@dataclass(frozen=True, kw_only=True)
class MeasurementComparison:
    """One measurement beside the model.

    Attributes
    ----------
    name : file and quantity
    quantity : what was measured, in words: "period of swing 2"
    predicted, measured, deviation : SI, the last one standard deviation of the measured
    unit : of them
    sigma : (predicted - measured) / deviation
    period : [s] measured, of a swing; 0 of anything else
    period_shift : how much longer than the model's it is, as a share; 0 of anything else
    """

    name: str
    quantity: str = unwritten()
    sigma: float
    unit: str
    predicted: float
    measured: float
    deviation: float = entry("tolerance")
    period: float = entry("period_s", unit="s", null=0.0, default=0.0)
    period_shift: float = unwritten(default=0.0)

    @property
    @derived("period_shift_percent")
    def period_percent(self) -> float | None:
        """The shift in per cent; None of what is no swing."""
        return 100 * self.period_shift if self.period else None


@dataclass(frozen=True, kw_only=True)
class Needed:
    """How large an effect would have to be to explain the measurements by itself.

    Attributes
    ----------
    id : of the effect
    value, unit : SI
    plausible : what a fault of it may be, one standard deviation
    possible : whether any size that a test may have explains them; False for one that can only move them the other way
    fits : whether what is then left is what tolerances leave
    evidence : [nats] against the model without it
    text : all of it in words
    """

    id: str
    value: float
    unit: str
    plausible: float
    possible: bool
    fits: bool = entry("explains")
    evidence: float = entry("evidence_nats", unit="nats")
    text: str


@dataclass(frozen=True, kw_only=True)
class MeasurementInput:
    """An input of a measurement that would explain the deviation, were it wrong.

    Attributes
    ----------
    name : "rope length"
    value, change : as it stands, and by how much it would have to be wrong, SI
    tolerances : the same in its tolerances (95 %)
    of : measurements that it enters
    """

    name: str = entry("input")
    value: float = entry("value_si")
    change: float = entry("change_si")
    tolerances: float
    of: tuple[str, ...]


@dataclass(frozen=True, eq=False, kw_only=True)
class SwingAnswer:
    """The answer.

    Attributes
    ----------
    title : of the model
    source : the model's file
    verdict : of `validation.diagnose.diagnosis.VERDICTS`
    text : the answer in words
    accepted : what is missing; of several that these data cannot tell apart none
    ranking : all that was tried, the best first
    equivalence_class : ids that these data cannot tell apart, the best first; one where there is no doubt
    advice : measurements that would tell them apart, the best first
    leftover : of an unknown effect
    detectable : the smallest size at which each effect would have been named
    facts : every measurement beside the model
    needed : by effect the size that would explain the measurements by itself
    readings : inputs that would explain them, were they wrong, the least wrong first
    chi2, measurements : of the model without any effect, and how many numbers were measured
    remarks : what should be known
    settings : thresholds
    """

    title: str = unwritten()
    source: str = unwritten()
    verdict: str
    text: str
    accepted: tuple[Cause, ...] = ()
    ranking: tuple[Cause, ...] = ()
    equivalence_class: tuple[str, ...] = ()
    advice: tuple[Advice, ...] = ()
    leftover: Leftover | None = entry("leftover_described", default=None)
    detectable: tuple[Detectable, ...] = ()
    chi2: float
    measurements: int
    facts: tuple[MeasurementComparison, ...] = entry("classical")
    needed: tuple[Needed, ...] = ()
    readings: tuple[MeasurementInput, ...] = ()
    remarks: tuple[str, ...] = entry("warnings", default=())
    settings: Mapping[str, object] = field(default_factory=lambda: MappingProxyType({}))

    @property
    @derived("next_measurement", before="advice")
    def next_measurement(self) -> str:
        """The best advice in words; empty where there is none."""
        return self.advice[0].test if self.advice else ""

    @property
    @derived("leftover", before="leftover_described")
    def left(self) -> str | None:
        """What no effect explains, in words."""
        return None if self.leftover is None else self.leftover.text

    @property
    @derived("errors", before="detectable")
    def errors(self) -> None:
        """There are no spectra, and so no errors of them."""
        return None


# What may be wrong where only weights, centres of gravity and periods are known: effects of the pendulum and of the body.


REACH = 6.0
"""[prior sd] up to which the size of an effect is looked at; beyond it explains nothing. Held by
tests/validation/diagnosing/test_swings.py."""

LIGHTEST = 0.5
"""[share] of the mass of an article that is left at the least: more is not missing in a drawing. Set by the development draws of
`make blind`, exercised by tests/validation/diagnosing/test_swings.py."""


@dataclass(frozen=True, kw_only=True)
class ClassicalCandidate:
    """An effect with one size that might be there.

    Attributes
    ----------
    added : with its plausible size
    size : of the catalogue
    low, high : sizes that are looked at
    """

    added: Added
    size: SizeSpec
    low: float
    high: float

    @property
    def id(self) -> str:
        """``family:target``."""
        return self.added.named.id

    @property
    def of_pendulum(self) -> bool:
        """Whether it is the pendulum's, and not the article's."""
        return FAMILIES[self.added.named.family].side == PENDULUM


def pendulum_candidates(facts: Sequence[ArticleFact]) -> tuple[Added, ...]:
    """Effects, each at a plausible size, that change the period of a swing among `facts` and were not corrected for."""
    swings = [fact.swing for fact in facts if fact.swing is not None]
    named = (at_prior_sd(name) for name, family in FAMILIES.items() if family.stage == PERIOD_STAGE and not family.targets)
    return tuple(Added(named=one) for one in named if any(classical_facts.acts(one, swing) for swing in swings))


def candidates(
    facts: Sequence[ArticleFact], own: Sequence[Added] = (), only: Sequence[str] = ()
) -> tuple[ClassicalCandidate, ...]:
    """All that might explain `facts`, but for what the model has among its `own`: the pendulum's first, then the article's.

    Raises
    ------
    BadInput : one of `only`, families or ids that are looked for, is none of them.
    """
    there = {one.named.id for one in own}
    least = min((float(fact.of.ten({})[0]) for fact in facts), default=0.0)
    every = (*pendulum_candidates(facts), *(Added(named=at_prior_sd(name)) for name in _of_body(facts)))
    found = tuple(_candidate(one, least) for one in every if one.named.id not in there)
    for wanted in only:
        if not any(_is(one, wanted) for one in found):
            known = dict.fromkeys(name for one in found for name in (one.added.named.family, one.id))
            problem = "is no effect that weights and periods could show"
            remedy = f"{nearest(wanted, known)}Known here are {', '.join(dict.fromkeys(one.added.named.family for one in found))}"
            raise BadInput(source="--candidate", field=wanted, problem=problem, remedy=remedy)
    return tuple(one for one in found if not only or any(_is(one, wanted) for wanted in only))


def _is(one: ClassicalCandidate, name: str) -> bool:
    return name in (one.added.named.family, one.id)


def _of_body(facts: Sequence[ArticleFact]) -> Iterator[str]:
    yield from (f"rigid-inertia:{name}" for name in PARAMETERS)
    yield from dict.fromkeys(f"point-mass:{place}" for fact in facts for place in fact.of.drawn.places)


def at_prior_sd(name: str) -> Named:
    """The effect `name` at a plausible size."""
    family, *targets = name.split(":")
    sizes = FAMILIES[family].sizes_at(tuple(targets))
    return Named(family=family, targets=tuple(targets), values={size.key: size.null + size.plausible for size in sizes})


def _candidate(added: Added, mass: float) -> ClassicalCandidate:
    size = added.named.sizes[0]
    low, high = max(size.low, -REACH * size.plausible), min(size.high, REACH * size.plausible)
    if added.named.family in WEIGHED and size.unit == "kg":
        low = max(low, -LIGHTEST * mass)
    return ClassicalCandidate(added=added, size=size, low=low, high=high)


# `Curve`: what an effect makes of all measurements as a smooth function of its size.


DEGREE = 10
"""[count] Degree of the polynomial; effects are of second degree in their size or near it. Held by
tests/validation/diagnosing/test_weighed.py."""

NARROWER = 0.7
"""[factor] by which an interval shrinks whose end no pendulum and no body can have. Set by the development draws of `make blind`,
exercised by tests/validation/diagnosing/test_swings.py."""

TRIES = 12
"""[count] of times that such an interval shrinks. Exercised by tests/validation/diagnosing/test_swings.py."""


@dataclass(frozen=True, eq=False, kw_only=True)
class InterpolatedCurve:
    """An interpolation.

    Attributes
    ----------
    low, high : sizes between which it holds
    coefficients : (`DEGREE` + 1, n) of Chebyshev polynomials on them
    """

    low: float
    high: float
    coefficients: Array

    def at(self, sizes: Array) -> Array:
        """(k, n) what is predicted more, SI, at `sizes` (k,)."""
        scaled = (2 * np.asarray(sizes) - self.low - self.high) / (self.high - self.low)
        return np.asarray(chebyshev.chebval(scaled, self.coefficients).T)


def curve(answer: Callable[[Array], Array], low: float, high: float) -> InterpolatedCurve:
    """Of ``answer(sizes (k,)) -> (k, n)`` between `low` and `high`, or as near to them as `answer` goes.

    Raises
    ------
    BadInput : nothing near 0 can be answered.
    """
    for _ in range(TRIES):
        nodes = 0.5 * (low + high) + 0.5 * (high - low) * chebyshev.chebpts1(DEGREE + 1)
        try:
            values = answer(nodes)
        except (BadInput, ValueError, FloatingPointError):
            low, high = NARROWER * low, NARROWER * high
            continue
        coefficients = np.asarray(chebyshev.chebfit(chebyshev.chebpts1(DEGREE + 1), values, DEGREE), dtype=np.float64)
        return InterpolatedCurve(low=low, high=high, coefficients=coefficients)
    raise BadInput(
        source="pendulum",
        problem="its lengths leave no room for the smallest effect",
        remedy="Check lengths, radii and mass in the measurement file",
    )


# `Observed`: classical measurements beside a model, with the tolerances that they have in common.


@dataclass(frozen=True, eq=False, kw_only=True)
class ObservedFacts:
    """Facts, and how far the model is from them.

    Attributes
    ----------
    facts : (n,) by the model with its own effects
    own : those effects
    left : (n,) predicted - measured, SI
    covariance : (n, n) of the measured, SI
    """

    facts: tuple[ArticleFact, ...]
    own: tuple[Added, ...]
    left: Array
    covariance: Array

    def __post_init__(self) -> None:
        n = len(self.facts)
        object.__setattr__(self, "left", frozen(self.left, (n,), "left"))
        object.__setattr__(self, "covariance", frozen(self.covariance, (n, n), "covariance"))

    @property
    def precision(self) -> Array:
        """(n, n) inverse of the covariance."""
        return inverse_covariance(self.covariance)

    @property
    def of_period(self) -> Array:
        """(n,) 1 / the moment of inertia that was measured by a period, 0 of any other number."""
        return np.array([0.0 if fact.swing is None else 1 / fact.value for fact in self.facts])

    @property
    def deviation(self) -> Array:
        """(n,) standard deviations, SI."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))


def observed(facts: Sequence[ArticleFact], own: Sequence[Added]) -> ObservedFacts:
    """`facts` beside the model with its `own` effects."""
    left = [_left(fact) for fact in facts]
    return ObservedFacts(
        facts=tuple(facts), own=tuple(own), left=np.array(left), covariance=covariance([fact.spread for fact in facts])
    )


def shifted(of: ObservedFacts, added: Added, sizes: Array) -> Array:
    """(k, n) by how much more the model says than without the effect `added`, at each of its `sizes` (k,), SI.

    Raises
    ------
    BadInput, ValueError : a size that the pendulum or the body cannot have.
    """
    found = np.zeros((len(sizes), len(of.facts)))
    for n, fact in enumerate(of.facts):
        changed = fact.with_effects((*of.own, added))
        if added.named.id in {one.name for one in changed.parameters}:
            found[:, n] = [_left(changed, {added.named.id: float(size)}) - of.left[n] for size in sizes]
    return found


def inverse_covariance(covariance: Array) -> Array:
    """(n, n) of a covariance, in units in which it has ones on its diagonal."""
    sd = np.sqrt(np.diag(covariance))
    return np.asarray(np.linalg.inv(covariance / np.outer(sd, sd)) / np.outer(sd, sd), dtype=np.float64)


def _left(fact: ArticleFact, offsets: dict[str, float] | None = None) -> float:
    """Predicted - measured, SI; effects of the model at their own sizes."""
    at = {one.name: one.start for one in fact.parameters} | (offsets or {})
    return fact.left(at)


# Effects with what they make of the measurements, ready to be weighed; those of the article that move nothing are left out.


ANSWERS = 0.1
"""[sd] of some measurement that an effect at its prior sd must move to be looked at. Exercised by
tests/validation/diagnosing/test_swings.py."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Answering:
    """An effect and its answer."""

    candidate: ClassicalCandidate
    curve: InterpolatedCurve

    @property
    def id(self) -> str:
        """``family:target``."""
        return self.candidate.id

    @property
    def plausible(self) -> float:
        """Standard deviation of its size beforehand, SI."""
        return self.candidate.size.plausible


def answering(
    of: ObservedFacts, candidates: Sequence[ClassicalCandidate], progress: Callable[[float], None] | None = None
) -> tuple[Answering, ...]:
    """Those of `candidates` that move the measurements `of`, and all of the pendulum."""
    return tuple(_answering(of, candidates, progress or (lambda share: None)))


def _answering(of: ObservedFacts, candidates: Sequence[ClassicalCandidate], tell: Callable[[float], None]) -> Iterator[Answering]:
    for k, candidate in enumerate(candidates, start=1):
        answer = curve(partial(shifted, of, candidate.added), candidate.low, candidate.high)
        one = Answering(candidate=candidate, curve=answer)
        if candidate.of_pendulum or _moves(one, of):
            yield one
        tell(k / len(candidates))


def _moves(one: Answering, of: ObservedFacts) -> bool:
    """Whether a plausible size of it moves anything; of one that has either sign, the two of them apart."""
    size = min(one.plausible, one.curve.high)
    if one.curve.low >= 0:
        moved = one.curve.at(np.array([size]))
    else:
        size = min(size, -one.curve.low)
        moved = np.diff(one.curve.at(np.array([-size, size])), axis=0) / 2
    return bool(np.max(np.abs(moved) / of.deviation) > ANSWERS)


# Measurements that contradict one another, whatever the model: two swings about one axis, two weights of one article.


DISAGREE = 4.0
"""[sd] from which two measurements of one quantity contradict each other. Exercised by
tests/validation/diagnosing/test_swings.py."""

MASS = "mass"


def contradicting_measurements(of: ObservedFacts, beside: tuple[MeasurementComparison, ...]) -> tuple[str, ...]:
    """Each in a sentence."""
    return (*_of_one_quantity(of, beside), *_of_masses(of))


def _of_one_quantity(of: ObservedFacts, beside: tuple[MeasurementComparison, ...]) -> Iterator[str]:
    for i, j in combinations(range(len(of.facts)), 2):
        one, other = of.facts[i], of.facts[j]
        if one.of.article != other.of.article or not np.allclose(one.weights, other.weights):
            continue
        apart = one.value - other.value
        sd = float(np.sqrt(max(of.covariance[i, i] + of.covariance[j, j] - 2 * of.covariance[i, j], 1e-300)))
        if abs(apart) > DISAGREE * sd:
            values = " and ".join(said(each.value, beside[i].unit, 4) for each in (one, other))
            # In what two swings differ, as far as the file says
            if one.swing is None or other.swing is None:
                differing: str = ""
            else:
                differ = [name for name, (a, b) in _conditions(one, other).items() if a != b]
                differing = (
                    f"; they differ in {' and '.join(differ)}" if differ else "; the file says of nothing in which they differ"
                )
            yield (
                f"{one.name} and {other.name} contradict each other: {values}, "
                f"{abs(apart) / sd:.0f} standard deviations apart{differing}"
            )


def _conditions(one: ArticleFact, other: ArticleFact) -> dict[str, tuple[object, object]]:
    swings = [each.swing for each in (one, other) if each.swing is not None]
    told: list[dict[str, object]] = []
    for swing in swings:
        pendulum, said_of = swing.pendulum, swing.stated
        sizes: dict[str, object] = {"suspension": type(pendulum).__name__}
        if isinstance(pendulum, RopeSwing):
            sizes |= {"length of the ropes": pendulum.length.nominal_value}
            sizes |= {"radius": abs(pendulum.s1.nominal_value * pendulum.s2.nominal_value)}
        if isinstance(pendulum, RopeSwing | CompoundSwing):
            sizes |= {MASS: pendulum.mass.nominal_value}
        for key in ("amplitude", "damping", "rope_mass"):
            stated = getattr(said_of, key)
            sizes[key.replace("_", " ")] = None if stated is None else stated.nominal_value
        told.append(sizes)
    return {name: (told[0].get(name), told[1].get(name)) for name in {**told[0], **told[1]}}


def _of_masses(of: ObservedFacts) -> Iterator[str]:
    """A mass that a pendulum file states beside the one that was weighed."""
    weighed = [fact for fact in of.facts if fact.weights[0] == 1]
    stated = dict.fromkeys(
        (fact.of.article, each.value, each.deviation) for fact in of.facts for each in fact.spread if each.name == MASS
    )
    for fact in weighed:
        for article, value, deviation in stated:
            sd = float(np.hypot(fact.deviation, deviation))
            if article == fact.of.article and abs(fact.value - value) > DISAGREE * sd:
                yield (
                    f"{fact.name} says {said(fact.value, 'kg', 4)}, and beside it {said(value, 'kg', 4)} ± "
                    f"{said(NORMAL_95 * deviation, 'kg')} stands as the mass, {abs(fact.value - value) / sd:.0f} standard "
                    "deviations apart"
                )


# How probable measurements are if an effect of plausible size is there, against that it is not: an integral over its size.
#
#     Z = ∫ p(θ) exp(-½ [ (d + s(θ))ᵀ C⁻¹ (d + s(θ)) - dᵀ C⁻¹ d ]) dθ
#
# d (n,) is predicted - measured without the effect, s(θ) what it adds, C the covariance of what was measured, p the normal
# density of the plausible size, halved where a size has one sign. Effects of a pendulum go with the square of their size, so
# that no Gaussian in θ describes them near 0; one integral over a line costs nothing. Where s is linear and p whole, Z is that
# of two Gaussians: ``-½ ln(1 + σ_p² sᵀ C⁻¹ s) + ½ (sᵀ C⁻¹ d)² σ_p² / (1 + σ_p² sᵀ C⁻¹ s)`` (MacKay, Information Theory,
# Inference, and Learning Algorithms, ch. 28).


POINTS = 401
"""[count] of sizes in each look at one effect. Exercised by tests/validation/diagnosing/test_weighed.py."""

LOOKS = 4
"""[count] of looks, each closer than the one before. Exercised by tests/validation/diagnosing/test_weighed.py."""

FAR = 30.0
"""[nats] below the summit at which nothing is left. Exercised by tests/validation/diagnosing/test_weighed.py."""

NEAR = 1e-4
"""[nats] below the summit within which the summit itself is looked for. Exercised by
tests/validation/diagnosing/test_weighed.py."""

TAIL = 0.05
"""[probability] on either side of a 90 % interval. By definition."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Weighed:
    """One effect beside the measurements.

    Attributes
    ----------
    evidence : ln Z [nats], against the model without the effect
    value : median of its size
    low, high : 90 % interval
    best : size that fits best, whether plausible or not
    at_end : whether that is the end of what was looked at: a larger one would fit better yet
    chi2 : of the unexplained residual at `best`
    """

    evidence: float
    value: float
    low: float
    high: float
    best: float
    at_end: bool
    chi2: float


def weighed(curve: InterpolatedCurve, plausible: float, left: Array, precision: Array) -> Weighed:
    """An effect of which `curve` is the answer, beside `left` (n,) of which the inverse covariance is `precision` (n, n)."""
    sizes, density = _posterior(curve, plausible, left, precision)
    peak = density.max()
    share = steps(sizes) * np.exp(density - peak)
    low, value, high = quantiles(sizes, share)
    best_sizes, found = _around(curve, lambda x: _gain(curve, x, left, precision), NEAR)
    best = float(best_sizes[int(np.argmax(found))])
    gained = float(_gain(curve, np.array([best]), left, precision)[0])
    return Weighed(
        evidence=float(peak + np.log(share.sum())),
        value=value,
        low=low,
        high=high,
        best=best,
        at_end=is_end(curve, best),
        chi2=max(float(left @ precision @ left) - 2 * gained, 0.0),
    )


def evidence(curve: InterpolatedCurve, plausible: float, left: Array, precision: Array) -> float:
    """ln Z alone."""
    sizes, density = _posterior(curve, plausible, left, precision)
    return float(density.max() + np.log(np.sum(steps(sizes) * np.exp(density - density.max()))))


def _posterior(curve: InterpolatedCurve, plausible: float, left: Array, precision: Array) -> tuple[Array, Array]:
    return _around(curve, lambda x: _gain(curve, x, left, precision) + prior(x, curve, plausible), FAR)


def quantiles(sizes: Array, share: Array) -> tuple[float, float, float]:
    """Low end of a 90 % interval, median and high end of a distribution that has `share` (k,) around each of `sizes` (k,)."""
    below = np.cumsum(share) - share / 2
    low, value, high = np.interp([TAIL, 0.5, 1 - TAIL], below / share.sum(), sizes)
    return float(low), float(value), float(high)


def _gain(curve: InterpolatedCurve, sizes: Array, left: Array, precision: Array) -> Array:
    """(k,) logarithm of the likelihood against that without the effect."""
    s = curve.at(sizes)
    return np.asarray(-(s @ precision @ left) - 0.5 * np.einsum("kn,nm,km->k", s, precision, s))


def prior(sizes: Array, curve: InterpolatedCurve, plausible: float) -> Array:
    """(k,) logarithm of the density of a plausible size, on one side of 0 where the other is none."""
    sided = np.log(2.0) if curve.low >= 0 else 0.0
    return np.asarray(sided - 0.5 * (sizes / plausible) ** 2 - np.log(np.sqrt(2 * np.pi) * plausible))


def _around(curve: InterpolatedCurve, density: Callable[[Array], Array], far: float) -> tuple[Array, Array]:
    """Sizes (k,) and the logarithm of the density there, from end to end of where it is no more than `far` below the summit."""
    low, high = curve.low, curve.high
    for _ in range(LOOKS):
        sizes = np.linspace(low, high, POINTS)
        found = density(sizes)
        there = np.flatnonzero(found > found.max() - far)
        low, high = sizes[max(there[0] - 1, 0)], sizes[min(there[-1] + 1, POINTS - 1)]
    return sizes, found


def is_end(curve: InterpolatedCurve, size: float) -> bool:
    width = (curve.high - curve.low) / POINTS
    return size > curve.high - width or (curve.low < 0 and size < curve.low + width)


def steps(sizes: Array) -> Array:
    """(k,) weights of the trapezoidal rule."""
    steps = np.full(len(sizes), sizes[1] - sizes[0])
    steps[[0, -1]] /= 2
    return steps


# Two effects at once: the integral of `validation.diagnose.classical` over both sizes.
#
# What they make of a measurement adds, but for two that lengthen one period: factors multiply, and of a moment M that was
# measured ``M (1 - s₁/M) (1 - s₂/M)`` is left, so that s = s₁ + s₂ - s₁ s₂ / M.


PAIR_POINTS = 121
"""[count] of sizes in each look at a pair of effects, along either. Exercised by tests/validation/diagnosing/test_weighed.py."""

PAIR_LOOKS = 5
"""[count] of looks at a pair, each closer than the one before. Exercised by tests/validation/diagnosing/test_weighed.py."""


def both(
    curves: tuple[InterpolatedCurve, InterpolatedCurve],
    plausible: tuple[float, float],
    left: Array,
    precision: Array,
    shared: Array | None = None,
) -> tuple[Weighed, Weighed]:
    """Both effects beside `left` (n,) of which the inverse covariance is `precision` (n, n).

    `shared` (n,) is 1 / M of periods that both lengthen, and 0 of what they only add to.
    The evidence of either is that of both together, and so is what they leave; value and interval are its own.
    """
    ends = [(one.low, one.high) for one in curves]
    for _ in range(PAIR_LOOKS):
        sizes = [np.linspace(low, high, PAIR_POINTS) for low, high in ends]
        gained = _pair_gain(curves, sizes, left, precision, np.zeros(len(left)) if shared is None else shared)
        density = gained + sum(np.expand_dims(prior(sizes[k], curves[k], plausible[k]), 1 - k) for k in (0, 1))
        there = density > density.max() - FAR
        ends = [_around_pair(sizes[k], there.any(axis=1 - k)) for k in (0, 1)]
    share = np.exp(density - density.max()) * np.outer(steps(sizes[0]), steps(sizes[1]))
    evidence = float(density.max() + np.log(share.sum()))
    best = np.unravel_index(int(np.argmax(gained)), gained.shape)
    chi2 = max(float(left @ precision @ left) - 2 * float(gained[best]), 0.0)
    one, other = (_weighed(curves[k], sizes[k], share.sum(axis=1 - k), float(sizes[k][best[k]]), evidence, chi2) for k in (0, 1))
    return one, other


def _pair_gain(
    curves: tuple[InterpolatedCurve, InterpolatedCurve], sizes: list[Array], left: Array, precision: Array, shared: Array
) -> Array:
    """(k, l) logarithm of the likelihood against that of neither."""
    one, other = curves[0].at(sizes[0])[:, None], curves[1].at(sizes[1])[None]
    s = one + other - shared * one * other
    return np.asarray(-(s @ precision @ left) - 0.5 * np.einsum("kln,nm,klm->kl", s, precision, s))


def _around_pair(sizes: Array, there: Array) -> tuple[float, float]:
    at = np.flatnonzero(there)
    return float(sizes[max(at[0] - 1, 0)]), float(sizes[min(at[-1] + 1, len(sizes) - 1)])


def _weighed(curve: InterpolatedCurve, sizes: Array, share: Array, best: float, evidence: float, chi2: float) -> Weighed:
    low, value, high = quantiles(sizes, share)
    return Weighed(evidence=evidence, value=value, low=low, high=high, best=best, at_end=is_end(curve, best), chi2=chi2)


# Is something missing, and what: the verdict on classical measurements, by the rules of every diagnosis.
#
# An effect is accepted where its evidence exceeds `WORTH` and what it leaves is what tolerances leave; where none is, two at
# once are tried. All that lie within `ALIKE` of the best, and aliases of a possible size that leave as little as it does, are
# one class that these data cannot tell apart.


ALIAS_CHI2 = 2.0
"""[chi²] by which an alias may fit worse than the best. Exercised by tests/validation/diagnosing/test_swings.py."""

LARGE = 3.0
"""[prior sd] up to which a size is possible. Exercised by tests/validation/diagnosing/test_swings.py."""

UNLIKELY = 1e-3
"""[probability] of a misfit below which an explanation explains too little. Exercised by
tests/validation/diagnosing/test_swings.py."""

UNKNOWN_BELOW = 1e-5
"""[probability] of a misfit below which the cause is unknown though nothing is worth a name. Exercised by
tests/validation/diagnosing/test_swings.py."""

NO_SIZE = 5e-3
"""[prior sd] below which the best size is none. Exercised by tests/validation/diagnosing/test_swings.py."""

PAIR = 2
"""[count] of effects in a pair. By definition."""

OF_PAIRS = 8
"""[count] of effects, the best by themselves, of which pairs are tried. Exercised by
tests/validation/diagnosing/test_swings.py."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ClassicalCandidateFit:
    """An effect, its answer, and what the measurements say of it."""

    answering: Answering
    found: Weighed

    @property
    def id(self) -> str:
        """``family:target``."""
        return self.answering.id

    @property
    def candidate(self) -> ClassicalCandidate:
        """What it is."""
        return self.answering.candidate

    @property
    def curve(self) -> InterpolatedCurve:
        """What it makes of the measurements."""
        return self.answering.curve

    @property
    def helps(self) -> bool:
        """Whether any size of it is better than none."""
        return abs(self.found.best) > NO_SIZE * self.answering.plausible


@dataclass(frozen=True, eq=False, kw_only=True)
class ClassicalVerdict:
    """A verdict.

    Attributes
    ----------
    verdict : of `validation.diagnose.diagnosis.VERDICTS`
    tried : all effects, the best first
    alike : those that the measurements cannot tell apart
    pair : two at once where one is not enough; empty where it is, or where no two are
    measurements : how many numbers were measured
    chi2 : of the model without them
    probability : of so large a chi2 by chance
    """

    verdict: str
    tried: tuple[ClassicalCandidateFit, ...]
    alike: tuple[ClassicalCandidateFit, ...]
    pair: tuple[ClassicalCandidateFit, ...]
    measurements: int
    chi2: float
    probability: float


def judged(answers: Sequence[Answering], left: Array, precision: Array, of_period: Array | None = None) -> ClassicalVerdict:
    """What measurements say of effects that give these `answers`.

    Parameters
    ----------
    left : (n,) predicted - measured, SI
    precision : (n, n) inverse of the covariance of the measured
    of_period : (n,) 1 / the moment of inertia [kg m²] that was measured by a period, 0 of any other number
    """
    tried = tuple(sorted((_tried(one, left, precision) for one in answers), key=lambda one: -one.found.evidence))
    chi2, n = float(left @ precision @ left), len(left)
    good = [one for one in tried if explains(one, n)]
    alike = tuple(one for one in good if good[0].found.evidence > EVIDENCE_THRESHOLD and _alike(one, good[0]))
    pair: tuple[ClassicalCandidateFit, ...] = ()
    if alike:
        verdict = MISSING if len(alike) == 1 else AMBIGUOUS
    elif chance(chi2, n) > (UNKNOWN_BELOW if good else UNLIKELY):
        verdict = NOTHING
    else:
        # The best two at once that leave what tolerances leave, each as it is beside the other; nothing where no two do
        pair_of_period = np.zeros(n) if of_period is None else of_period
        found = []
        for two in combinations(tried[:OF_PAIRS], 2) if len(left) > PAIR else ():
            curves, plausible = (two[0].curve, two[1].curve), (two[0].answering.plausible, two[1].answering.plausible)
            shared = pair_of_period * all(one.candidate.of_pendulum for one in two)
            beside = both(curves, plausible, left, precision, shared)
            if beside[0].evidence > EVIDENCE_THRESHOLD and chance(beside[0].chi2, len(left) - PAIR) > UNLIKELY:
                found.append(tuple(replace(one, found=each) for one, each in zip(two, beside, strict=True)))
        pair = max(found, key=lambda pair: pair[0].found.evidence, default=())
        verdict = SEVERAL if pair else UNKNOWN
    return ClassicalVerdict(
        verdict=verdict, tried=tried, alike=alike, pair=pair, measurements=n, chi2=chi2, probability=chance(chi2, n)
    )


def _tried(one: Answering, left: Array, precision: Array) -> ClassicalCandidateFit:
    found = weighed(one.curve, one.plausible, left, precision)
    return ClassicalCandidateFit(answering=one, found=found)


def _alike(one: ClassicalCandidateFit, best: ClassicalCandidateFit) -> bool:
    """Whether an explanation is as good as the best: as probable, or an alias that does the same at a size that is possible."""
    alias = one.found.chi2 - best.found.chi2 < ALIAS_CHI2 and abs(one.found.best) <= LARGE * one.answering.plausible
    return best.found.evidence - one.found.evidence < INDISTINGUISHABLE_NATS or alias


def chance(chi2: float, degrees: int) -> float:
    """Probability of a larger `chi2` by chance; 1 where nothing is left to be judged."""
    from scipy.special import chdtrc

    return float(chdtrc(degrees, chi2)) if degrees > 0 else 1.0


def explains(one: ClassicalCandidateFit, measurements: int) -> bool:
    """Whether what an effect leaves by itself is what tolerances leave."""
    return chance(one.found.chi2, measurements - 1) > UNLIKELY


# The smallest size at which classical measurements would name an effect: where its own answer, without noise, is worth it.


HALVINGS = 12
"""[count] of halvings of the interval that holds the size. Exercised by tests/validation/diagnosing/test_swings.py."""


def detectable(tried: Sequence[ClassicalCandidateFit], covariance: Array) -> tuple[Detectable, ...]:
    """Of every effect that measurements with this `covariance` (n, n) would name within its reach."""
    return tuple(_found(tried, inverse_covariance(covariance)))


def _found(tried: Sequence[ClassicalCandidateFit], precision: Array) -> Iterator[Detectable]:
    for one in tried:
        # Positive size at which the evidence is `WORTH`; the end of what is looked at where it is not
        low, high = 0.0, one.curve.high
        if not _named(one, high, precision):
            size = high
        else:
            for _ in range(HALVINGS):
                middle = 0.5 * (low + high)
                low, high = (low, middle) if _named(one, middle, precision) else (middle, high)
            size = high
        if size < one.curve.high:
            yield Detectable(id=one.id, size=size, unit=one.candidate.size.unit)


def _named(one: ClassicalCandidateFit, size: float, precision: Array) -> bool:
    left = -one.curve.at(np.array([size]))[0]
    return evidence(one.curve, one.answering.plausible, left, precision) > EVIDENCE_THRESHOLD


# Is an input wrong? By how much each length, mass or time would have to be, to explain the deviation by itself.


ROUNDING = 1e-12
"""[share] of a variance that is left of one which a single input makes alone. Exercised by
tests/validation/diagnosing/test_swings.py."""


def readings(of: ObservedFacts) -> tuple[MeasurementInput, ...]:
    """Every input that has a name and explains the measurements, the one that would be least wrong first.

    What fits best, the others as they are: ``z = aᵀ N⁻¹ d / (aᵀ N⁻¹ a)`` standard deviations, a what one of them makes of the
    measurements, N the covariance without it; what is left is ``dᵀ N⁻¹ d - z² aᵀ N⁻¹ a``.
    """
    return tuple(sorted(_wrong(of), key=lambda one: abs(one.tolerances)))


def _wrong(of: ObservedFacts) -> Iterator[MeasurementInput]:
    spreads = [fact.spread for fact in of.facts]
    for one in dict.fromkeys(each for spread in spreads for each in spread):
        a = np.array([spread.get(one, 0.0) for spread in spreads])
        P = inverse_covariance(of.covariance - np.outer(a, a) + ROUNDING * np.diag(np.diag(of.covariance)))
        z = float(a @ P @ of.left / (a @ P @ a))
        left = of.left - z * a
        if one.name and chance(float(left @ P @ left), len(left) - 1) > UNLIKELY:
            yield _reading(one, z, tuple(fact.name for fact, part in zip(of.facts, a, strict=True) if part))


def _reading(one: Input, z: float, of: tuple[str, ...]) -> MeasurementInput:
    """An input that reads `z` standard deviations too low, since the model says more than was measured."""
    return MeasurementInput(name=one.name, value=one.value, change=z * one.deviation, tolerances=z / NORMAL_95, of=of)
