"""What classical measurements - weights, centres of gravity, periods - say of effects of the pendulum and of the body."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations, product

import numpy as np
from numpy.polynomial import chebyshev

from geometry.errors import BadInput
from geometry.frames import Array, freeze
from geometry.inertia import PARAMETERS
from geometry.toml_file import nearest
from identification.quality import NORMAL_95
from validation.classical.pendulum import CompoundSwing, RecordedSwing, RopeSwing
from validation.diagnose.diagnosis import AMBIGUOUS, MISSING, NOTHING, SEVERAL, UNKNOWN, Detectable, MeasurementInput, Needed
from validation.effects.catalogue import FAMILIES, Named
from validation.effects.effect import EVIDENCE_THRESHOLD, INDISTINGUISHABLE_NATS, PENDULUM, PERIOD_STAGE, SizeSpec
from validation.effects.practical_units import said
from validation.estimation.verdicts import UNLIKELY
from validation.model.model import Added
from validation.output import significant
from validation.prediction import classical_facts
from validation.prediction.classical_facts import WEIGHED, ArticleFact, covariance

UNITS = ("kg", "m", "m", "m", *("kg m^2",) * 6)
"""SI, of the quantities of `identification.request`."""


# What may be wrong where only weights, centres of gravity and periods are known: effects of the pendulum and of the body.


REACH = 6.0
"""[prior sd] up to which the size of an effect is looked at; beyond it explains nothing. Held by test_classical.py."""

LIGHTEST = 0.5
"""[share] of the mass of an article that is left at the least: more is not missing in a drawing. Set by the development draws of
`make blind`, exercised by test_classical.py."""


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
    of_body = [f"rigid-inertia:{name}" for name in PARAMETERS]
    of_body += dict.fromkeys(f"point-mass:{place}" for fact in facts for place in fact.of.drawn.places)
    found = []
    for added in (*pendulum_candidates(facts), *(Added(named=at_prior_sd(name)) for name in of_body)):
        size = added.named.sizes[0]
        low, high = max(size.low, -REACH * size.plausible), min(size.high, REACH * size.plausible)
        if added.named.family in WEIGHED and size.unit == "kg":
            low = max(low, -LIGHTEST * least)
        if added.named.id not in there:
            found.append(ClassicalCandidate(added=added, size=size, low=low, high=high))
    for wanted in only:
        if not any(_is(one, wanted) for one in found):
            known = dict.fromkeys(name for one in found for name in (one.added.named.family, one.id))
            remedy = f"{nearest(wanted, known)}Known here are {', '.join(dict.fromkeys(one.added.named.family for one in found))}"
            raise BadInput("--candidate", wanted, "is no effect that weights and periods could show", remedy)
    return tuple(one for one in found if not only or any(_is(one, wanted) for wanted in only))


def _is(one: ClassicalCandidate, name: str) -> bool:
    return name in (one.added.named.family, one.id)


def at_prior_sd(name: str) -> Named:
    """The effect `name` at a plausible size."""
    family, *targets = name.split(":")
    sizes = FAMILIES[family].sizes_at(tuple(targets))
    return Named(family=family, targets=tuple(targets), values={size.key: size.null + size.plausible for size in sizes})


# What an effect makes of all measurements as a smooth function of its size.


DEGREE = 10
"""[count] Degree of the polynomial; effects are of second degree in their size or near it. Held by test_classical.py."""

NARROWER = 0.7
"""[factor] by which an interval shrinks whose end no pendulum and no body can have. Set by the development draws of `make blind`,
exercised by test_classical.py."""

TRIES = 12
"""[count] of times that such an interval shrinks. Exercised by test_classical.py."""


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
    problem = "its lengths leave no room for the smallest effect"
    raise BadInput("pendulum", "", problem, "Check lengths, radii and mass in the measurement file")


# Classical measurements beside a model, with the tolerances that they have in common.


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
        freeze(self, left=(n,), covariance=(n, n))

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

    @property
    def readings(self) -> tuple[MeasurementInput, ...]:
        """Every input that has a name and explains the measurements, were it wrong, the one that would be least wrong first.

        What fits best, the others as they are: ``z = aᵀ N⁻¹ d / (aᵀ N⁻¹ a)`` standard deviations too low, a what one of them
        makes of the measurements, N the covariance without it; what is left is ``dᵀ N⁻¹ d - z² aᵀ N⁻¹ a``.
        """
        spreads, found = [fact.spread for fact in self.facts], []
        for one in dict.fromkeys(each for spread in spreads for each in spread):
            a = np.array([spread.get(one, 0.0) for spread in spreads])
            P = inverse_covariance(self.covariance - np.outer(a, a) + ROUNDING * np.diag(np.diag(self.covariance)))
            z = float(a @ P @ self.left / (a @ P @ a))
            left = self.left - z * a
            if one.name and chance(float(left @ P @ left), len(left) - 1) > UNLIKELY:
                of, change = tuple(fact.name for fact, part in zip(self.facts, a, strict=True) if part), z * one.deviation
                found.append(MeasurementInput(name=one.name, value=one.value, change=change, tolerances=z / NORMAL_95, of=of))
        return tuple(sorted(found, key=lambda one: abs(one.tolerances)))

    def contradictions(self, units: Sequence[str]) -> tuple[str, ...]:
        """Measurements that contradict one another, whatever the model, each in a sentence with these `units`.

        They are two of one quantity, and a mass that a pendulum file states beside the one that was weighed.
        """
        told = []
        for i, j in combinations(range(len(self.facts)), 2):
            one, other = self.facts[i], self.facts[j]
            if one.of.article != other.of.article or not np.allclose(one.weights, other.weights):
                continue
            apart, C = one.value - other.value, self.covariance
            sd = float(np.sqrt(max(C[i, i] + C[j, j] - 2 * C[i, j], 1e-300)))
            if abs(apart) > DISAGREE * sd:
                values = " and ".join(said(each.value, units[i], 4) for each in (one, other))
                differing = ""
                if one.swing is not None and other.swing is not None:  # in what they differ, as far as the file says
                    a, b = _conditions(one.swing), _conditions(other.swing)
                    differ = " and ".join(name for name in {**a, **b} if a.get(name) != b.get(name))
                    differing = f"; they differ in {differ}" if differ else "; the file says of nothing in which they differ"
                told.append(
                    f"{one.name} and {other.name} contradict each other: {values}, "
                    f"{abs(apart) / sd:.0f} standard deviations apart{differing}"
                )
        stated = dict.fromkeys(
            (fact.of.article, each.value, each.deviation) for fact in self.facts for each in fact.spread if each.name == MASS
        )
        for fact, (article, value, deviation) in product((fact for fact in self.facts if fact.weights[0] == 1), stated):
            sd = float(np.hypot(fact.deviation, deviation))
            if article == fact.of.article and abs(fact.value - value) > DISAGREE * sd:
                told.append(
                    f"{fact.name} says {said(fact.value, 'kg', 4)}, and beside it {said(value, 'kg', 4)} ± "
                    f"{said(NORMAL_95 * deviation, 'kg')} stands as the mass, {abs(fact.value - value) / sd:.0f} standard "
                    "deviations apart"
                )
        return tuple(told)


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
"""[sd] of some measurement that an effect at its prior sd must move to be looked at. Exercised by test_classical.py."""


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
    """Those of `candidates` of which a plausible size moves the measurements `of`, and all of the pendulum."""
    found = []
    for k, candidate in enumerate(candidates, start=1):
        one = Answering(candidate=candidate, curve=curve(partial(shifted, of, candidate.added), candidate.low, candidate.high))
        size = min(one.plausible, one.curve.high)
        if one.curve.low >= 0:
            moved = one.curve.at(np.array([size]))
        else:  # of one that has either sign, the two of them apart
            size = min(size, -one.curve.low)
            moved = np.diff(one.curve.at(np.array([-size, size])), axis=0) / 2
        if candidate.of_pendulum or np.max(np.abs(moved) / of.deviation) > ANSWERS:
            found.append(one)
        if progress is not None:
            progress(k / len(candidates))
    return tuple(found)


DISAGREE = 4.0
"""[sd] from which two measurements of a quantity, or one and campaigns, contradict each other. Exercised by test_classical.py."""

MASS = "mass"


def _conditions(swing: RecordedSwing) -> dict[str, object]:
    pendulum = swing.pendulum
    told: dict[str, object] = {"suspension": type(pendulum).__name__}
    if isinstance(pendulum, RopeSwing):
        told |= {"length of the ropes": pendulum.length.nominal_value}
        told |= {"radius": abs(pendulum.s1.nominal_value * pendulum.s2.nominal_value)}
    if isinstance(pendulum, RopeSwing | CompoundSwing):
        told |= {MASS: pendulum.mass.nominal_value}
    for key in ("amplitude", "damping", "rope_mass"):
        stated = getattr(swing.stated, key)
        told[key.replace("_", " ")] = None if stated is None else stated.nominal_value
    return told


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
"""[count] of sizes in each look at one effect. Held by test_classical.py."""

LOOKS = 4
"""[count] of looks, each closer than the one before. Held by test_classical.py."""

FAR = 30.0
"""[nats] below the summit at which nothing is left. Held by test_classical.py."""

NEAR = 1e-4
"""[nats] below the summit within which the summit itself is looked for. Exercised by test_classical.py."""

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


# Two effects at once: the same integral over both sizes.
#
# What they make of a measurement adds, but for two that lengthen one period: factors multiply, and of a moment M that was
# measured ``M (1 - s₁/M) (1 - s₂/M)`` is left, so that s = s₁ + s₂ - s₁ s₂ / M.


PAIR_POINTS = 121
"""[count] of sizes in each look at a pair of effects, along either. Held by test_classical.py."""

PAIR_LOOKS = 5
"""[count] of looks at a pair, each closer than the one before. Exercised by test_classical.py."""


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
        first, second = curves[0].at(sizes[0])[:, None], curves[1].at(sizes[1])[None]
        s = first + second - (np.zeros(len(left)) if shared is None else shared) * first * second
        gained = -(s @ precision @ left) - 0.5 * np.einsum("kln,nm,klm->kl", s, precision, s)
        density = gained + sum(np.expand_dims(prior(sizes[k], curves[k], plausible[k]), 1 - k) for k in (0, 1))
        there = density > density.max() - FAR
        at = [np.flatnonzero(there.any(axis=1 - k)) for k in (0, 1)]
        ends = [(float(x[max(k[0] - 1, 0)]), float(x[min(k[-1] + 1, len(x) - 1)])) for x, k in zip(sizes, at, strict=True)]
    share = np.exp(density - density.max()) * np.outer(steps(sizes[0]), steps(sizes[1]))
    best = np.unravel_index(int(np.argmax(gained)), gained.shape)
    found = []
    for k in (0, 1):
        low, value, high = quantiles(sizes[k], share.sum(axis=1 - k))
        found.append(
            Weighed(
                evidence=float(density.max() + np.log(share.sum())),
                value=value,
                low=low,
                high=high,
                best=float(sizes[k][best[k]]),
                at_end=is_end(curves[k], float(sizes[k][best[k]])),
                chi2=max(float(left @ precision @ left) - 2 * float(gained[best]), 0.0),
            )
        )
    return found[0], found[1]


# Is something missing, and what: the verdict on classical measurements, by the rules of every diagnosis.
#
# An effect is accepted where its evidence exceeds `EVIDENCE_THRESHOLD` and what it leaves is what tolerances leave; where none
# is, two at once are tried. All that lie within `INDISTINGUISHABLE_NATS` of the best, and aliases of a possible size that leave
# as little as it does, are one class that these data cannot tell apart.


ALIAS_CHI2 = 2.0
"""[chi²] by which an alias may fit worse than the best. Exercised by test_classical.py."""

LARGE = 3.0
"""[prior sd] up to which a size is possible. Exercised by test_classical.py."""

UNKNOWN_BELOW = 1e-5
"""[probability] of a misfit below which the cause is unknown though nothing is worth a name. Exercised by test_classical.py."""

NO_SIZE = 5e-3
"""[prior sd] below which the best size is none. Exercised by test_classical.py."""

PAIR = 2
"""[count] of effects in a pair. By definition."""

OF_PAIRS = 8
"""[count] of effects, the best by themselves, of which pairs are tried. Exercised by test_classical.py."""


PLAUSIBLE = 1.0
"""[prior sd] up to which an effect is nothing special: plausible is one. By definition."""


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

    def needed(self, measurements: int) -> Needed:
        """The size that it would have, were it alone, and what is to be thought of that."""
        unit, plausible, size = self.candidate.size.unit, self.candidate.size.plausible, self.found.best
        times, fits = abs(size) / plausible, explains(self, measurements)
        if not self.helps:
            text = "moves the measurements the other way, whatever its size"
        elif self.found.at_end:
            text = f"more than {said(abs(size), unit)}, beyond anything plausible ({said(plausible, unit)})"
        elif not fits:
            text = f"{said(size, unit)} fits best, and leaves chi² {self.found.chi2:.3g}: no explanation by itself"
        else:
            thought = "plausible" if times <= PLAUSIBLE else "large, but possible" if times <= LARGE else "hardly plausible"
            text = f"{said(size, unit)}, {significant(times, 2)} times what is plausible: {thought}"
        return Needed(
            id=self.id,
            value=size,
            unit=unit,
            plausible=plausible,
            possible=self.helps and not self.found.at_end,
            fits=fits,
            evidence=self.found.evidence,
            text=text,
        )


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
    fits = [ClassicalCandidateFit(answering=one, found=weighed(one.curve, one.plausible, left, precision)) for one in answers]
    tried = tuple(sorted(fits, key=lambda one: -one.found.evidence))
    chi2, n = float(left @ precision @ left), len(left)
    good = [one for one in tried if explains(one, n)]
    best = good[0].found if good else None
    # As probable as the best, or an alias that does the same at a size that is possible
    alike = tuple(
        one
        for one in good
        if best is not None
        and best.evidence > EVIDENCE_THRESHOLD
        and (
            best.evidence - one.found.evidence < INDISTINGUISHABLE_NATS
            or (one.found.chi2 - best.chi2 < ALIAS_CHI2 and abs(one.found.best) <= LARGE * one.answering.plausible)
        )
    )
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


def chance(chi2: float, degrees: int) -> float:
    """Probability of a larger `chi2` by chance; 1 where nothing is left to be judged."""
    from scipy.special import chdtrc

    return float(chdtrc(degrees, chi2)) if degrees > 0 else 1.0


def explains(one: ClassicalCandidateFit, measurements: int) -> bool:
    """Whether what an effect leaves by itself is what tolerances leave."""
    return chance(one.found.chi2, measurements - 1) > UNLIKELY


# The smallest size at which classical measurements would name an effect: where its own answer, without noise, is worth it.


HALVINGS = 12
"""[count] of halvings of the interval that holds the size. Exercised by test_classical.py."""


def detectable(tried: Sequence[ClassicalCandidateFit], covariance: Array) -> tuple[Detectable, ...]:
    """Of every effect that measurements with this `covariance` (n, n) would name within its reach."""
    precision, found = inverse_covariance(covariance), []
    for one in tried:
        low, high = 0.0, one.curve.high
        for halved in range(HALVINGS + 1):
            size = 0.5 * (low + high) if halved else high
            named = evidence(one.curve, one.answering.plausible, -one.curve.at(np.array([size]))[0], precision)
            if named > EVIDENCE_THRESHOLD:
                high = size
            elif halved:
                low = size
            else:
                break  # the largest that is looked at is not named
        if high < one.curve.high:
            found.append(Detectable(id=one.id, size=high, unit=one.candidate.size.unit))
    return tuple(found)


# Is an input wrong? By how much each length, mass or time would have to be, to explain the deviation by itself.


ROUNDING = 1e-12
"""[share] of a variance that is left of one which a single input makes alone. Exercised by test_classical.py."""
