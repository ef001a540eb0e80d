"""`advised`: which test of the menu would tell explanations apart, with the evidence that it is expected to give.

Every test of the menu is forecast by a straight line, which takes a tenth of a second; the best are then gone through as a fit
would, until enough of them keep what they promise.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from fem.structure import at_freedoms
from geometry.frames import Array
from identification.self_calibration.solve import Normal, inverse, minimise, total
from validation.diagnose import next_test_offers
from validation.diagnose.candidates import candidates, is_resonator, with_candidates
from validation.diagnose.diagnosis import Advice, Candidate
from validation.diagnose.everywhere import ASKED
from validation.diagnose.next_test_offers import knowledge, menu
from validation.diagnose.reduction_errors import SAME_END
from validation.effects.catalogue import FAMILIES
from validation.effects.effect import INDISTINGUISHABLE_NATS, at_position
from validation.estimation import likelihood
from validation.estimation.fit import BREAKDOWNS, FLOOR
from validation.estimation.likelihood import cost_of, root
from validation.estimation.problem import EFFECT, FITTED, Fact, Parameter
from validation.model.model import Added
from validation.prediction import dynamic_mass
from validation.prediction import effects as prediction_effects
from validation.prediction.effects import name
from validation.prediction.modal_table import SLOWEST, TableShapes, real_modes
from validation.prediction.points import stated
from validation.prediction.response_functions import ResponseFunctionTest
from validation.prediction.structure import ReducedStructure
from validation.study import Study

# How many nats a test is expected to give for the right one of two explanations, in closed form.
#
# By explanation a the test reads A_a u + n, the tolerances within what the present data left of them: whitened and with the
# latent inputs taken out, a Gaussian with mean m_a and covariance S_a = 1 + J C_a J^T. If a is true, it gains on b
#
#     1/2 d^T S_b^-1 d ,        d = m_a - m_b ,
#
# the part of their difference that b cannot take up by what it does not know (Lindley, Annals of Mathematical Statistics 27,
# 1956; the mean of the logarithm of a ratio of Gaussians). With C = L L^T and N = J^T J everything is of the size of the
# parameters:
#
#     d^T S^-1 d = d^T d - |K^-1/2 L^T J^T d|² ,    K = 1 + L^T N L .
#
# What a itself does not know, 1/2 [tr S_b^-1 (S_a - S_b) + ln det S_b - ln det S_a], is left out. It is never negative, so that
# the figure is a cautious one; and it would ask for J of both: at a narrow resonance no difference of J is small.


def nats(difference: Normal, spread: Array) -> float:
    """Expected evidence against an explanation that knows its parameters as `spread` (p, s) L says.

    Parameters
    ----------
    difference : half |d|², J^T d (p,) and N (p, p) of how the right explanation differs from it
    """
    K = np.eye(spread.shape[1]) + spread.T @ difference.matrix @ spread
    taken_up = np.linalg.solve(np.linalg.cholesky(K), spread.T @ difference.gradient)
    return max(difference.cost - 0.5 * float(taken_up @ taken_up), 0.0)


# Explanations set beside each other in one test: how many nats it gives for the right one, whichever that is.
#
# The first explanation lends the test its derivatives. Every other one predicts what it would read; what the first cannot follow
# of that, latent inputs taken out, is their difference.


def told(
    offer: next_test_offers.OfferedTest, first: next_test_offers.Knowledge, others: Sequence[next_test_offers.Knowledge]
) -> tuple[float, ...]:
    """Nats that `offer` is expected to tell of `first` against each of `others`, as far as a straight line goes.

    Raises
    ------
    numpy.linalg.LinAlgError, ValueError, FloatingPointError : a model breaks down in this test.
    """
    here, there, test = offer.by(first), [offer.by(one) for one in others], offer.test
    differences = []  # how every other explanation differs from the first, in `parameters`
    if test is None:  # (predicted - measured) / deviation of every number, as each explanation has it
        every = [offer.facts(one.effects) for one in (here, *there)]
        parameters = {one.name: one for facts in every[::-1] for fact in facts for one in fact.parameters}
        names = tuple(parameters)
        left, J = _said(every[0], here, names)
        says = []
        for facts, other in zip(every[1:], there, strict=True):
            numbers, slopes = _said(facts, other, names)
            J = np.where(np.any(J != 0, axis=0), J, slopes)
            says.append(numbers - left)
        differences = [Normal(cost=0.5 * float(away @ away), gradient=J.T @ away, matrix=J.T @ J) for away in says]
    else:
        lines, worth = next_test_offers.lines_of(test, next_test_offers.reading(test, here, here.offsets))
        mine = test.prediction.with_effects(here.effects)
        predicted = mine.at(here.offsets, lines)
        parameters = {one.name: one for one in mine.parameters if one.tolerance > 0}
        changes = {name: change for name, change in predicted.changes.items() if name in parameters}
        for other in there:  # the sizes of its effects, and how the test answers to them
            its = test.prediction.with_effects(other.effects)
            own = {one.name: one for one in its.parameters if one.kind == EFFECT and one.tolerance > 0}
            answers = its.at(other.offsets, lines, derivatives=frozenset(own)).changes if own else {}
            changes = {**{name: change for name, change in answers.items() if name in own}, **changes}
            parameters = {**own, **parameters}
        names, whole = tuple(changes), replace(predicted, changes=changes)
        for other in there:
            seen = likelihood.observed(next_test_offers.reading(test, other, other.offsets), lines)
            differences.append(_weighted(total(likelihood.normals(seen, whole, names, FLOOR).values(), len(names)), worth))
    moving = tuple(parameters[name] for name in names)
    own_spread = first.spread(moving, offer.moved)
    return tuple(
        either(first.odds(one), nats(difference, one.spread(moving, offer.moved)), nats(difference, own_spread))
        for difference, one in zip(differences, others, strict=True)
    )


def _weighted(of: Normal, worth: float) -> Normal:
    return Normal(cost=worth * of.cost, gradient=worth * of.gradient, matrix=worth * of.matrix)


def either(probability: float, first: float, other: float) -> float:
    """What is expected where the first is right with `probability`: the geometric mean, which follows the smaller of the two.

    What would be plain in the one case is no reason to expect it in the other.
    """
    least = np.finfo(np.float64).tiny
    return float(max(first, least) ** probability * max(other, least) ** (1 - probability))


def _said(facts: Sequence[Fact], by: next_test_offers.Knowledge, names: Sequence[str]) -> tuple[Array, Array]:
    """(q,) residuals and (q, p) slopes."""
    said = [fact.residual(by.offsets) for fact in facts]
    rows = np.array([[slopes.get(name, 0.0) for name in names] for _, slopes in said])
    return np.array([left for left, _ in said]), rows.reshape(len(said), len(names))


# How far the wrong explanation can follow what the right one says a test would read: it is fitted to that.
#
# The linear forecast takes the derivatives where the fit of the present data ended. Where a resonance has moved by more than its
# width they say nothing of what a fit would do. So the few tests that look best are gone through: by the same descent as any fit,
# within the same bounds, with what the present data have told as knowledge beforehand, though only as far as a forecast needs.


EVALUATIONS = 12
"""[count] of evaluations that the descent may take. Set by draws of `make blind`, exercised by test_next_test.py."""

STIFF = 1e-12
"""[share] Relative variance of a direction below which it does not move. Exercised by test_next_test.py."""

ROUGHLY = 0.5
"""[sd] that the last step may be: it leaves an eighth of a nat. Set by draws of `make blind`, exercised by test_next_test.py."""


def following(
    test: next_test_offers.PlannedTest,
    offer: next_test_offers.OfferedTest,
    right: next_test_offers.Knowledge,
    wrong: next_test_offers.Knowledge,
) -> float:
    """Nats that are left of the difference between `right` and `wrong` when the latter was fitted to what the former reads.

    Raises
    ------
    numpy.linalg.LinAlgError, ValueError, FloatingPointError : a model breaks down in this test.
    """
    here, there = offer.by(right), offer.by(wrong)
    measured = next_test_offers.reading(test, here, here.offsets)
    lines, worth = next_test_offers.lines_of(test, measured)
    seen = likelihood.observed(measured, lines)
    prediction = test.prediction.with_effects(there.effects)
    moving = tuple(one for one in prediction.parameters if one.tolerance > 0)
    spread = wrong.spread(moving, offer.moved)
    free = np.flatnonzero(np.any(spread != 0, axis=1))
    names, bounds = tuple(moving[k].name for k in free), np.array([moving[k].bounds(plain=False) for k in free])
    whitening, begin = _whitening(spread[free]), np.array([there.offsets.get(name, 0.0) for name in names])

    def data(x: Array) -> Normal:
        offsets = {**there.offsets, **dict(zip(names, map(float, x), strict=True))}
        predicted = prediction.at(offsets, lines, derivatives=frozenset(names))
        return _weighted(total(likelihood.normals(seen, predicted, names, FLOOR).values(), len(names)), worth)

    def knowledge(x: Array) -> tuple[Array, Array]:
        return whitening @ (x - begin), whitening

    low, high = bounds.T
    found = minimise(
        data, begin, knowledge, close=ROUGHLY, most=EVALUATIONS, bounds=(np.minimum(low, begin), np.maximum(high, begin))
    )
    return found.normal.cost


def _whitening(spread: Array) -> Array:
    """(p, p) W with W spread spread^T W^T = 1, of parameters (p,) of any unit; a direction that does not move resists."""
    covariance = spread @ spread.T
    scale = np.sqrt(np.diag(covariance))
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    return np.asarray((vectors / np.sqrt(np.maximum(values, STIFF * values[-1]))).T / scale)


# What a single explanation could be mistaken for: that nothing is missing, or another effect, as far as a straight line goes.
#
# Nobody fitted these. From the Jacobian of the data at the fit that there is, the quadratic model of the cost says where the fit
# without the effect would end, and where one with another effect in its place:
#
#     minimum over delta of  1/2 delta^T N delta + g^T delta + 1/2 (x + delta)^T P (x + delta) ,
#
# the sizes of the effect itself at nothing, and P what is known beforehand. That is good enough to ask what a test would read.


NOTHING = "nothing"


@dataclass(frozen=True, eq=False, kw_only=True)
class Alternative:
    """An explanation that nobody fitted.

    Attributes
    ----------
    id : of the effect in its place; "nothing" for none
    known : what the data would say of the parameters by it
    """

    id: str
    known: next_test_offers.Knowledge


@dataclass(frozen=True, eq=False, kw_only=True)
class _QuadraticCost:
    """The cost to second order in the parameters (p,), about the offsets x (p,) where the fit ended.

    Attributes
    ----------
    of : the candidate whose fit it is
    parameters : those of the fit, and the sizes of what may stand in place of its last effect
    x, data, precision : offsets, cost of the data, and one over the square of what a laboratory admits of each; infinite for none
    """

    of: Candidate
    parameters: tuple[Parameter, ...]
    x: Array
    data: Normal
    precision: Array

    @classmethod
    def about(cls, study: Study, of: Candidate, menu: Sequence[Added]) -> "_QuadraticCost":
        """The fit of `of`, any of `menu` in place of its last effect."""
        admitted = {one.name: one.tolerance for one in study.problem(of.effects[:-1]).free(FITTED)}
        problem = with_candidates(of.problem, menu)
        own = {one.name for one in of.fit.parameters}
        free = tuple(one for one in problem.free(FITTED) if one.name in own or one.kind == EFFECT)
        cost = cost_of(problem, free, FLOOR)
        x = cost.at(of.fit.by_name)
        data, count = cost.data(x), len(problem.facts)
        whole = data.beside(*(each[len(each) - count :] for each in cost.knowledge(x)))
        precision = np.array([admitted.get(one.name, 0.0) for one in free])
        with np.errstate(divide="ignore"):
            return cls(of=of, parameters=free, x=x, data=whole, precision=precision**-2.0)

    def instead(self, other: Added | None) -> Alternative | None:
        """Where the fit with `other` in place of the last effect would end; None where that acts nowhere."""
        of, effect, names = self.of, self.of.effects[-1], [one.name for one in self.parameters]
        sizes = {} if other is None else {name(other.named, size.key): size.plausible for size in other.named.sizes}
        opened_here = [k for k, one in enumerate(names) if one in sizes]
        if other is not None and not opened_here:
            return None
        precision = np.array(self.precision)
        precision[opened_here] = [sizes[names[k]] ** -2.0 for k in opened_here]
        goal = -self.x
        for size in effect.named.sizes:
            if name(effect.named, size.key) in names and size.logarithmic:
                goal[names.index(name(effect.named, size.key))] = -1.0 if size == effect.named.sizes[0] else 0.0
        free, held = np.flatnonzero(np.isfinite(precision)), np.flatnonzero(~np.isfinite(precision))
        delta = np.where(np.isfinite(precision), 0.0, goal)
        P, N = np.diag(precision[free]), self.data.matrix
        pull = self.data.gradient[free] + N[np.ix_(free, held)] @ delta[held] + P @ self.x[free]
        covariance = inverse(N[np.ix_(free, free)] + P)
        delta[free] = -covariance @ pull
        x = self.x + delta
        cost = self.data.cost + float(self.data.gradient @ delta + 0.5 * delta @ N @ delta + 0.5 * x[free] @ P @ x[free])
        kept = [names[k] for k in free]
        offsets = {**of.problem.start, **of.fit.by_name, **dict(zip(kept, map(float, x[free]), strict=True))}
        gone = {names[k] for k in held}
        without = tuple(one for one in next_test_offers.effects_of(of) if one.named.id != effect.named.id)
        known = next_test_offers.Knowledge(
            effects=without if other is None else (*without, other),
            offsets={one: size for one, size in offsets.items() if one not in gone},
            names=tuple(kept),
            root=root(covariance),
            log_evidence=of.fit.log_evidence + of.fit.cost - cost,
        )
        return Alternative(id=NOTHING if other is None else other.named.id, known=known)


def imagined(data: Study, of: Candidate) -> tuple[Alternative, ...]:
    """In place of the last effect of a candidate: nothing, and the one that comes nearest of those it is mistaken for."""
    effect = of.effects[-1]
    if effect.fixed:
        # Of an effect that is there or not: the same without it, which was not asked for because it is far worse
        known = knowledge(of)
        left = tuple(one for one in known.effects if one.named.id != effect.named.id)
        return (
            Alternative(id=NOTHING, known=replace(known, effects=left, log_evidence=of.fit.log_evidence - next_test_offers.SURE)),
        )
    # The effects for which the catalogue says that this one is mistaken; on the same targets, of the kinds that both have
    family = FAMILIES[effect.named.family]
    its, menu = dict(zip(family.targets, effect.named.targets, strict=False)), []
    for one in candidates(data):
        theirs = dict(zip(FAMILIES[one.named.family].targets, one.named.targets, strict=False))
        like = one.named.family in family.mistaken_for or one.named.id in family.mistaken_for
        same = all(its[kind] == theirs[kind] for kind in its.keys() & theirs.keys())
        if like and same and not is_resonator(one.named) and not one.fixed:
            menu.append(one)
    cost = _QuadraticCost.about(data, of, menu)
    found = [cost.instead(one) for one in (None, *menu)]
    nothing, *others = (one for one in found if one is not None)
    return (nothing, max(others, key=lambda one: one.known.log_evidence)) if others else (nothing,)


DECIDED = 20.0
"""[nats] beyond which more decide no more: then the quicker test comes first. Exercised by test_next_test.py."""

NAMED_TESTS = 3
"""[count] of tests that are named. Exercised by test_next_test.py."""

FORECAST_TESTS = 6
"""[count] of tests whose fit is forecast at most. Exercised by test_next_test.py."""

CERTAIN = 0.95
"""[probability] of one of two explanations from which nobody asks what the other reads. Exercised by test_next_test.py."""

LOOKING = 0.6
"""[share] of the work that the forecast of the whole menu is; progress bar only. By definition."""

Progress = Callable[[float], None]


@dataclass(frozen=True, eq=False, kw_only=True)
class Forecast:
    """What is expected of one test.

    Attributes
    ----------
    offer : the test
    gains : by other explanation, nats between it and the first
    """

    offer: next_test_offers.OfferedTest
    gains: tuple[float, ...]

    @property
    def apart(self) -> tuple[int, ...]:
        """Which of the others it tells from the first."""
        return tuple(k for k, gain in enumerate(self.gains) if gain >= INDISTINGUISHABLE_NATS)

    @property
    def gain(self) -> float:
        """Of those that it tells apart, the least; else the most of all."""
        return min((self.gains[k] for k in self.apart), default=max(self.gains))

    @property
    def rank(self) -> tuple[float, float, float, float]:
        """The smaller the better: how many it tells apart, how surely, how quickly."""
        return -len(self.apart), -min(self.gain, DECIDED), self.offer.hours, -self.gain


# One more pick-up on a structure that is tested by itself: where explanations would have it read most differently.


def pick_ups(rivals: Sequence[Candidate]) -> Iterator[Forecast]:
    """By test of a structure the node and the axis at which one more pick-up tells most of `rivals` from the first.

    Modes are held against each other in the scale of what is read already and with its sign, by its deviations; what tolerances
    would take up of a difference is left in.
    """
    for every in zip(*map(_read, rivals), strict=True):
        one = every[0][0]
        square = np.square(one.measured.noise) + np.square(FLOOR * np.abs(one.measured.values))
        deviation = np.sqrt(np.mean(square) / np.mean(np.abs(one.measured.values) ** 2))
        (points, read, moved), *others = (_modes_at(of, *each) for of, each in zip(rivals, every, strict=True))
        gains = []
        for _, its, there in others:
            count = min(len(read), len(its))
            sign = np.where(np.sum(read[:count] * its[:count], axis=1) < 0, -1.0, 1.0)
            away = moved[:count] - sign[:, None, None] * there[:count]
            gains.append(0.5 * np.sum((away / deviation) ** 2, axis=0))
        node, axis = np.unravel_index(np.argmax(np.sum(np.minimum(gains, DECIDED), axis=0)), gains[0].shape)
        words = f"Add a pick-up at {at_position(points[node])} along {'xyz'[axis]}, and repeat {one.measured.name}"
        offer = next_test_offers.OfferedTest(kind=f"pick-up of {one.measured.name}", words=words, hours=1.0)
        yield Forecast(offer=offer, gains=tuple(float(gain[node, axis]) for gain in gains))


def _read(of: Candidate) -> list[tuple[ResponseFunctionTest | TableShapes, ReducedStructure]]:
    """The predictions of a candidate of what pick-ups read on a structure by itself, of which nodes are known."""
    some = (one for one in of.problem.predictions if isinstance(one, ResponseFunctionTest | TableShapes))
    read = ((one, one.structure.reduced) for one in some if [at.name for at in one.responses] == [*one.measured.channels])
    return [(one, known) for one, known in read if known is not None and len(known.nodes()[0])]


def _modes_at(of: Candidate, one: ResponseFunctionTest | TableShapes, reduced: ReducedStructure) -> tuple[Array, Array, Array]:
    """(q, 3) [m] nodes spread over the structure that `one` predicts, and what its modes in the band move the pick-ups (m, c) and
    these nodes (m, q, 3), of the root mean square 1 of what is read."""
    known = {**of.problem.start, **of.fit.by_name}
    effects = tuple(replace(each, fixed=True) for each in prediction_effects.at(one.effects, known))
    modes = real_modes(dynamic_mass.structure(one.structure, known, effects, derivatives=False)[0])
    elastic = np.flatnonzero(modes.frequency > SLOWEST * reduced.frequency[0])
    shapes = modes.shapes[:, elastic[: max(int(np.sum(reduced.frequency <= SAME_END * reduced.band)), 1)]]
    read = (stated(modes.matrices, one.responses) @ shapes).T
    scale = np.sqrt(np.mean(read**2, axis=1, keepdims=True))
    scale = np.maximum(scale, FLOOR * scale.max())
    points, moved = reduced.nodes()
    some = np.unique(np.linspace(0, len(points) - 1, ASKED).astype(np.int64))
    rows = at_freedoms(reduced.basis, moved[some])
    return points[some], read / scale, np.moveaxis(rows @ shapes[: rows.shape[2]], -1, 0) / scale[:, :, None]


def advised(data: Study, rivals: Sequence[Candidate], progress: Progress | None = None) -> tuple[Advice, ...]:
    """Tests that would tell `rivals` apart, the best first.

    Parameters
    ----------
    rivals : explanations of the data of `data`, the best first; of a single one, tests that would tell it from nothing, and from
        what it could be mistaken for

    Returns
    -------
    those from which `INDISTINGUISHABLE_NATS` or more are expected between the first and at least one other. First come those that
    tell most of them apart, then those of more evidence, up to `DECIDED`, then the quicker ones. Where there is none, one of gain
    0 says so.
    """
    if len(rivals) == 1 and not rivals[0].effects:
        return ()
    first, *others = (knowledge(one) for one in rivals)
    # Of every candidate the effects that not all of them have, and their names
    common = set.intersection(*({one.named.id for one in rival.effects} for rival in rivals)) if len(rivals) > 1 else set()
    own = [tuple(one for one in rival.effects if one.named.id not in common) for rival in rivals]
    names = [" with ".join(each.named.id for each in one) or "nothing" for one in own]
    if len(rivals) == 1:
        alternatives = imagined(data, rivals[0])
        others = [one.known for one in alternatives]
        names = [rivals[0].effects[-1].named.id, *(one.id for one in alternatives)]
        own = [rivals[0].effects[-1:]]
        own += [tuple(one for one in each.known.effects if one.named.id == each.id) for each in alternatives]
    effects = tuple({one.named.id: one for some in own for one in some}.values())
    tell, looked = progress or (lambda share: None), []
    offers = tuple(menu([next_test_offers.Template.of(one, first) for one in data.made], effects, data.facts(first.effects)))
    for k, offer in enumerate(offers):
        with suppress(*BREAKDOWNS):  # of a model in this test
            looked.append(Forecast(offer=offer, gains=told(offer, first, others)))
        tell(LOOKING * (k + 1) / len(offers))
    with suppress(*BREAKDOWNS):
        looked += (one for one in pick_ups(rivals) if round(one.gain, 1)) if len(rivals) > 1 else ()
    useful = _kept(sorted(looked, key=lambda one: one.rank), first, others, lambda share: tell(LOOKING + (1 - LOOKING) * share))
    found = tuple(
        Advice(
            test=one.offer.words, gain=one.gain, separates=(names[0], *(names[1 + k] for k in one.apart)), hours=one.offer.hours
        )
        for one in useful
        if one.apart
    )
    # That no test helps, which comes nearest, and what the catalogue knows of a laboratory
    listed = " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)
    text = f"no test of the menu is expected to tell {listed} apart"
    if useful:
        words = useful[0].offer.words
        text += f"; the nearest to it, with {useful[0].gain:.1f} nats: {words[:1].lower()}{words[1:]}"
    ways = "; ".join(way for way in dict.fromkeys(FAMILIES[one.named.family].confirmed_by for one in effects) if way)
    return found or (Advice(test=f"{text}{'. What would: ' + ways if ways else ''}", gain=0.0),)


def _kept(
    ranked: Sequence[Forecast],
    first: next_test_offers.Knowledge,
    others: Sequence[next_test_offers.Knowledge],
    progress: Progress,
) -> list[Forecast]:
    """The best of each kind, gone through as a fit would; in the end the best of all first, though it tell nothing apart."""
    kept: dict[str, Forecast] = {}
    tried = 0
    for one in ranked:
        enough = sum(bool(each.apart) for each in kept.values()) >= NAMED_TESTS or tried >= FORECAST_TESTS
        if enough or (kept and not one.apart):
            break
        if one.offer.kind in kept:
            continue
        test, gains = one.offer.test, list[float]()
        with suppress(*BREAKDOWNS):
            if test is None:  # of other measurements than campaigns the straight line says all
                kept[one.offer.kind] = one
            else:
                for other in others:
                    gain, probability = following(test, one.offer, first, other), first.odds(other)
                    if probability <= CERTAIN:
                        gain = either(probability, gain, following(test, one.offer, other, first))
                    gains.append(gain)
                kept[one.offer.kind] = replace(one, gains=tuple(gains))
        tried += 1
        progress(tried / FORECAST_TESTS)
    return sorted(kept.values(), key=lambda one: one.rank)
