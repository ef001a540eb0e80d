"""Search from afar: which effects bring resonances, shapes and levels to where they were measured."""

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np
from scipy.linalg import solve_triangular

from geometry.errors import CheckFailed
from geometry.frames import Array
from identification.quality import NORMAL_90
from validation.diagnose.candidates import has_lines, is_resonator, sizes
from validation.diagnose.diagnosis import EffectEstimate
from validation.effects.catalogue import FAMILIES
from validation.effects.effect import EVIDENCE_THRESHOLD, INDISTINGUISHABLE_NATS, STRUCTURE, evidence_threshold
from validation.estimation.fit import BREAKDOWNS, COARSE, RESTARTS, STRIDE, nearby
from validation.estimation.likelihood import ends_of
from validation.estimation.problem import FITTED, Fit, Offsets, Parameter
from validation.model.model import Added
from validation.prediction.effects import name
from validation.prediction.landmarks import Landmark, tolerances
from validation.study import Study

# A fit of all lines finds its way only where resonances of model and data overlap. Farther off, landmarks are compared
# (`validation.prediction.landmarks`), which change smoothly with the sizes of effects however large these are. The response is
# exact for the reduced structure at every size; nothing is linear but the tolerances, which are taken out in closed form. With
# residuals r in units of what a sound model may be off, their derivatives J by the tolerances at the model as it is, and T =
# diag(tolerance),
#
#     chi² = r^T (1 + J T² J^T)^-1 r .
#
# Each candidate is looked at over its whole plausible range, the best are fitted, and beside the best few of these all others
# again, up to `MOST_EFFECTS` at once: two effects may do together what neither does alone. Logarithms nearly add: what one moves
# by itself says which others are worth a look there, and at which of their sizes. An effect whose size mechanics states
# has no free size; it is there or not. Sizes of others are known to an order of magnitude beforehand, by a Cauchy density of
# their plausible size.
#
# No model of known effects comes down to a chi² of one per number where something else is missing, too. What the best of all
# leaves, c = chi² / (numbers - sizes), is then taken for the variance of what landmarks are off, and evidence is counted in it
# (quasi-likelihood: R. W. M. Wedderburn, Biometrika 61 (1974), 439; K. P. Burnham and D. R. Anderson, Model Selection and
# Multimodel Inference, 2002, section 2.5).

OCTAVES = np.arange(-3.0, 5.0)
"""[octave] of a plausible size at which an effect is looked at, to either side. By definition."""

MOST_EFFECTS = 3
"""[count] of effects of free size at once. By definition."""

KEPT = 3
"""[count] of explanations beside which others are looked for. Held by test_landmark_search.py."""

LOOKED_AT = 20
"""[count] of effects that are looked at beside others, those that should do most there. Held by test_landmark_search.py."""

OF_A_FAMILY = 2
"""[count] of these whose newest effect is of one family: joints yield for one another. Held by test_landmark_search.py."""

TRIED = 6
"""[count] of effects that are fitted beside each of these. Held by test_landmark_search.py."""

ALIKE = 0.9995
"""[1] Cosine between what two effects do to landmarks from which one is looked at for both. Held by test_landmark_search.py."""

MOST_ALIKE = 3
"""[count] of effects any of which explains as much: one of more is no name, nor its size one. Held by test_landmark_search.py."""

UNSEEN = 1e-6
"""[sd] of a sound model that an effect moves all landmarks by at least to be looked for. By definition."""

WIDEST = 10.0
"""[log] that stands for a tolerance of which nothing is known. By definition."""

AWAY = 1e3
"""[sd] that stands for landmarks of a model that breaks down. By definition."""

TRIALS = 12
"""[count] of steps of the fit of an explanation. Held by test_landmark_search.py."""

SETTLED = 1e-4
"""[share] of what an explanation leaves, or of its sizes, that a step of a fit changes. Exercised by test_landmark_search.py."""

GAINS = ("force-gain", "accelerometer-gain")
"""Families that change the level of all that a sensor reads."""

FAR = 2.0
"""[factor] on chi² a number of a model near the data, beyond which it is far. Held by test_landmark_search.py."""

EXPLAINED = 0.5
"""[share] of the chi² above one a number that effects must explain to be named. Held by test_landmark_search.py."""

Progress = Callable[[str, float], None]


@dataclass(frozen=True, eq=False, kw_only=True)
class LandmarkFit:
    """Effects at the sizes that bring the landmarks nearest.

    Attributes
    ----------
    effects : at these sizes
    sizes : (p,) offsets of the free ones, in plausible sizes
    residual : (n,) of the landmarks, tolerances taken out
    curvature : (p, p) half the second derivatives of `chi2`
    """

    effects: tuple[Added, ...] = ()
    sizes: Array = field(default_factory=lambda: np.zeros(0))
    residual: Array
    curvature: Array = field(default_factory=lambda: np.zeros((0, 0)))

    @property
    def chi2(self) -> float:
        """Of the landmarks, tolerances taken out."""
        return float(self.residual @ self.residual)

    @property
    def ids(self) -> frozenset[str]:
        """Of the effects."""
        return frozenset(one.named.id for one in self.effects)

    def log_evidence(self, variance: float) -> float:
        """[nats] where landmarks are off by this `variance`, by Laplace's approximation; no free size gains by being free."""
        prior = -float(np.sum(np.log(np.pi * (1 + self.sizes**2))))
        _, logdet = np.linalg.slogdet(self._precision(variance))
        occam = prior + 0.5 * len(self.sizes) * np.log(2 * np.pi) - 0.5 * float(logdet)
        return float(-0.5 * self.chi2 / variance + min(occam, 0.0))

    def covariance(self, variance: float) -> Array:
        """(p, p) of the sizes, in plausible sizes."""
        return np.asarray(np.linalg.inv(self._precision(variance)))

    def _precision(self, variance: float) -> Array:
        return np.asarray(self.curvature / variance + np.diag(1 / (1 + self.sizes**2)))


@dataclass(frozen=True, eq=False, kw_only=True)
class DistantView:
    """A model and its data as they are seen from afar.

    Attributes
    ----------
    marks : of all tests, by the model as it is
    """

    marks: tuple[Landmark, ...]
    _moved: dict[str, tuple[tuple[Added, ...], Array]] = field(default_factory=dict, init=False)

    @cached_property
    def number(self) -> float:
        """Of independent numbers among the landmarks."""
        return sum(one.number for one in self.marks)

    @cached_property
    def home(self) -> LandmarkFit:
        """The model as it is."""
        return self.explained(())

    @property
    def far(self) -> bool:
        """Whether the model as it is lies far from the data."""
        return self.home.chi2 > FAR * self.number

    def nearest(self, menu: Sequence[Added], most: int) -> list[LandmarkFit]:
        """What one effect of `menu` explains, the best first: of the `most` that come nearest at any of their sizes."""
        one_size = [one for one in menu if len(self.sizes((one,))) == 1]
        return sorted((self.explained((there,)) for there in self.looked(self.home, one_size, most)), key=lambda one: one.chi2)

    @cached_property
    def root(self) -> Array:
        """(n, n) lower root of 1 + J T² J^T at the model as it is."""
        known = tolerances(self.marks, ())
        rows = []
        for mark in self.marks:
            left, moved = mark.at({}, (), derivatives=tuple(known))
            nothing = np.zeros(len(left))
            rows.append([min(one.tolerance, WIDEST) * moved.get(which, nothing) for which, one in known.items()])
        J = np.hstack([np.reshape(one, (len(known), -1)) for one in rows])
        R = np.linalg.qr(np.vstack([J, np.eye(J.shape[1])]), mode="r")  # of J^T J very large numbers would leave no 1
        return np.asarray((R * np.sign(np.diag(R))[:, None]).T)

    def residual(self, effects: Sequence[Added]) -> Array:
        """(n,) with `effects` at their sizes, whitened."""
        return self._seen([replace(one, fixed=True) for one in effects], {})[0]

    def _seen(self, effects: Sequence[Added], offsets: Offsets) -> tuple[Array, Array]:
        """(n,) with `effects` at these offsets of those that are free, whitened, and (n, p) its derivatives by `offsets`."""
        try:
            seen = [one.at(offsets, effects, derivatives=tuple(offsets)) for one in self.marks]
        except BREAKDOWNS:
            return np.full(len(self.root), AWAY), np.zeros((len(self.root), len(offsets)))
        moved = [np.column_stack([left, *(by.get(which, np.zeros(len(left))) for which in offsets)]) for left, by in seen]
        whole = np.nan_to_num(np.vstack(moved), nan=AWAY)
        whole = solve_triangular(self.root, whole, lower=True, check_finite=False, overwrite_b=True)
        return whole[:, 0], whole[:, 1:]

    def sizes(self, effects: Sequence[Added]) -> tuple[Parameter, ...]:
        """The free sizes of `effects`, in their order."""
        every = tolerances(self.marks, effects) if any(not one.fixed for one in effects) else {}
        wanted = (name(one.named, size.key) for one in effects if not one.fixed for size in one.named.fitted_sizes)
        return tuple(every[which] for which in wanted if which in every)

    def explained(self, effects: Sequence[Added]) -> LandmarkFit:
        """`effects`, fitted from the sizes at which they stand."""
        from scipy.optimize import least_squares

        free = self.sizes(effects)
        if not free:
            return LandmarkFit(effects=tuple(effects), residual=self.residual(effects))
        scale = np.array([one.tolerance for one in free])
        low, high = (np.array([one.bounds(plain=False)[end] for one in free]) / scale for end in (0, 1))

        @lru_cache(maxsize=2)  # for the residual and for its derivatives
        def seen(x: tuple[float, ...]) -> tuple[Array, Array]:
            return self._seen(effects, {one.name: each for one, each in zip(free, np.array(x) * scale, strict=True)})

        def left(x: Array) -> Array:
            return np.concatenate([seen(tuple(x))[0], np.sqrt(2 * np.log1p(x**2))])

        def slope(x: Array) -> Array:
            straight = np.divide(x, np.sqrt(np.log1p(x**2)), out=np.ones_like(x), where=x != 0)
            return np.vstack([seen(tuple(x))[1] * scale, np.diag(np.sqrt(2.0) * straight / (1 + x**2))])

        start = np.clip(np.array([one.start for one in free]) / scale, low, high)
        inside = np.clip(start, low + 1e-6 * np.minimum(high - low, 1.0), high - 1e-6 * np.minimum(high - low, 1.0))
        size = np.maximum(np.abs(start), 0.1)
        ends = {"max_nfev": TRIALS, "ftol": SETTLED, "xtol": SETTLED}
        found = least_squares(left, inside, bounds=(low, high), x_scale=size, jac=slope, **ends)
        J, r = found.jac[: -len(free)], found.fun[: -len(free)]
        return LandmarkFit(effects=at_offsets(effects, free, found.x * scale), sizes=found.x, residual=r, curvature=J.T @ J)

    def moved(self, one: Added) -> tuple[tuple[Added, ...], Array]:
        """`one` at each of its sizes, and what it moves the residual of the model as it is by (s, n)."""
        if one.named.id not in self._moved:
            (free,) = self.sizes((one,))
            x = sizes(free, OCTAVES)
            there = tuple(at_offsets((one,), (free,), [each])[0] for each in x)
            linear = FAMILIES[one.named.family].side != STRUCTURE  # one of a channel
            asked = [self.residual((each,)) - self.home.residual for each in (there[:1] if linear else there)]
            self._moved[one.named.id] = there, np.outer(x / x[0], asked[0]) if linear else np.array(asked)
        return self._moved[one.named.id]

    def guessed(self, at: LandmarkFit, one: Added) -> Array:
        """(s,) chi² with `one` at each of its sizes beside the effects of `at`, as if it moved landmarks as by itself."""
        return np.asarray(np.sum((at.residual + self.moved(one)[1]) ** 2, axis=1))

    def scanned(self, at: LandmarkFit, one: Added) -> tuple[float, Added]:
        """chi² and size of `one` beside the effects of `at` where it is least: where it should be, at the likelier size beside
        that, and where this is no better at the other."""
        there, guess = self.moved(one)[0], self.guessed(at, one)
        k = int(np.argmin(guess))
        beside = sorted({max(k - 1, 0), min(k + 1, len(there) - 1)} - {k}, key=lambda other: guess[other]) if at.effects else ()
        found: list[tuple[float, Added]] = []
        for size in (there[other] for other in (k, *beside)):
            found.append((float(np.sum(self.residual((*at.effects, size)) ** 2)), size))
            if len(found) > 1 and found[-1][0] <= found[0][0]:
                break
        return min(found, key=lambda each: each[0])

    def looked(self, at: LandmarkFit, menu: Sequence[Added], most: int) -> list[Added]:
        """Those `most` of `menu` that should do most beside the effects of `at`, the best first, at the sizes where they do."""
        first = sorted(menu, key=lambda one: float(self.guessed(at, one).min()))[:most]
        return [there for _, there in sorted((self.scanned(at, one) for one in first), key=lambda each: each[0])]

    def groups(self, menu: Sequence[Added]) -> list[list[Added]]:
        """Those of `menu` that have one free size and move the landmarks, the alike together."""
        known = {one.named.id for one in stated(menu)}
        found: list[tuple[Array, list[Added]]] = []
        for one in menu:
            if one.fixed or is_resonator(one.named) or one.named.id in known:
                continue
            free = self.sizes((one,))
            if len(free) != 1:
                continue
            step = 0.1 * free[0].tolerance
            moved = self.residual(at_offsets((one,), free, [step if step < free[0].bounds(plain=False)[1] else -step]))
            moved -= self.home.residual
            length = float(np.linalg.norm(moved))
            if length < UNSEEN:
                continue
            for direction, group in found:
                if abs(direction @ moved) > ALIKE * length:
                    group.append(one)
                    break
            else:
                found.append((moved / length, [one]))
        return [group for _, group in found]

    def variance(self, nodes: Iterable[LandmarkFit]) -> float:
        """What the best of `nodes` leaves, one at least."""
        return max(1.0, min(self.misfit(one) for one in nodes))

    def misfit(self, node: LandmarkFit) -> float:
        """chi² a number that `node` leaves."""
        return node.chi2 / max(self.number - len(node.sizes), 1.0)

    def looked_at(self, node: LandmarkFit, rest: LandmarkFit, variance: float) -> "LookedAt":
        """The newest effect of `node` that `rest` has not."""
        added = next(one for one in reversed(node.effects) if one.named.id not in rest.ids)
        return LookedAt(added=added, evidence=node.log_evidence(variance) - rest.log_evidence(variance), misfit=self.misfit(node))

    def needed(self, data: Study, nodes: Sequence[LandmarkFit], start: LandmarkFit, variance: float) -> LandmarkFit:
        """That of `nodes`, each of which has the effects of `start`, that has no effect more than can be told.

        Landmarks bring resonances together, and then lines say more. So of explanations with as many effects that landmarks do
        not tell apart the fit of all lines over a coarse floor decides; its cost is that of as many independent numbers as there
        are landmarks. One effect more is needed where landmarks gain what its family asks for, or gain at all, and lines what
        tells two explanations apart.
        """
        costs: dict[frozenset[str], float] = {}

        def cost(one: LandmarkFit) -> float:
            """Of the fit of all lines; none where there are no lines."""
            if one.ids not in costs:
                told = line_fit(data, one.effects, roughly=True)
                costs[one.ids] = float("nan") if told is None else told.cost
            return costs[one.ids]

        best = start
        for count in range(len(start.effects) + 1, len(start.effects) + MOST_EFFECTS + 1):
            more = sorted((one for one in nodes if len(one.effects) == count), key=lambda one: -one.log_evidence(variance))
            if not more:
                break
            first = more[0].log_evidence(variance)
            near = [one for one in more[:KEPT] if one.log_evidence(variance) > first - EVIDENCE_THRESHOLD]
            there = min(near, key=lambda one: np.nan_to_num(cost(one), nan=-one.log_evidence(variance)))
            gained = max(first, there.log_evidence(variance)) - best.log_evidence(variance)
            asked = max(evidence_threshold(one.named.family) for one in there.effects if not one.fixed)
            by_lines = 0.5 * self.number * float(np.log(cost(best) / cost(there))) if gained > 0 else 0.0
            if gained >= asked * (count - len(best.effects)) or by_lines >= INDISTINGUISHABLE_NATS * (count - len(best.effects)):
                best = there
        return best

    def alike(
        self,
        best: LandmarkFit,
        one: Added,
        groups: Sequence[Sequence[Added]],
        nodes: dict[frozenset[str], LandmarkFit],
        variance: float,
    ) -> tuple[str, ...]:
        """Ids of what could stand for `one` beside the other effects of `best`, the best first."""
        others = best.ids - {one.named.id}
        rest = replace(best, effects=tuple(each for each in best.effects if each is not one))
        found = {one.named.id: best.log_evidence(variance)}
        for group in groups:
            first = group[0].named.id
            if first in others:
                continue
            near = nodes.get(others | {first})
            if near is None or near.log_evidence(variance) < found[one.named.id] - INDISTINGUISHABLE_NATS:
                continue
            for each in group:
                if each.named.id not in best.ids:
                    again = near if each is group[0] else self.explained((*rest.effects, self.scanned(rest, each)[1]))
                    found[each.named.id] = again.log_evidence(variance)
        return tuple(id for id in found if found[id] >= found[one.named.id] - INDISTINGUISHABLE_NATS)


def at_offsets(effects: Sequence[Added], free: Sequence[Parameter], offsets: Sequence[float] | Array) -> tuple[Added, ...]:
    """`effects` with the sizes that `free` have at these `offsets`."""
    values = {one.name: one.value(float(x)) for one, x in zip(free, offsets, strict=True)}
    found = []
    for one in effects:
        own = {size.key: values[name(one.named, size.key)] for size in one.named.sizes if name(one.named, size.key) in values}
        found.append(one if one.fixed else replace(one, named=replace(one.named, values={**one.named.values, **own})))
    return tuple(found)


def stated(menu: Sequence[Added]) -> tuple[Added, ...]:
    """Those of `menu` whose size mechanics states, at that size."""
    found = []
    for one in menu:
        sizes = {size.key: size.stated for size in one.named.sizes if size.stated is not None}
        if sizes and len(sizes) == len(one.named.sizes):
            found.append(replace(one, named=replace(one.named, values=sizes), fixed=True))
    return tuple(found)


@dataclass(frozen=True, eq=False, kw_only=True)
class LookedAt:
    """An effect that was looked at in place of one that was found, or alone.

    Attributes
    ----------
    added : at its size
    evidence : [nats] against the model without it
    misfit : chi² a number of the landmarks with it
    """

    added: Added
    evidence: float
    misfit: float


@dataclass(frozen=True, eq=False, kw_only=True)
class FromAfar:
    """What a search from afar found.

    Attributes
    ----------
    best : the effects that are named
    variance : of what landmarks are off, that no effects explain, in that of a sound model
    number : of independent numbers
    base : the model as it is
    gains : by id of each of the effects [nats] against the others alone
    alike : by id of each of the effects those that could stand for it, itself the first
    alone : every effect that was fitted by itself, the most evidence first
    after : the effect that comes closest to what is left; None for none
    view : that all this was seen in
    """

    best: LandmarkFit
    variance: float
    number: float
    base: LandmarkFit
    gains: dict[str, float]
    alike: dict[str, tuple[str, ...]]
    alone: tuple[LookedAt, ...]
    after: LookedAt | None
    view: DistantView

    def off(self, limit: float) -> list[tuple[str, float]]:
        """Landmarks that are still off by more than `limit` of what a sound model may be, in words, the farthest first.

        Of one resonance, one shape and one channel it is the farthest alone.
        """
        given = [replace(one, fixed=True) for one in self.best.effects]
        found: dict[str, tuple[str, float]] = {}
        for mark in self.view.marks:
            left, _ = mark.at({}, given)
            for where, sd in zip(mark.where, np.abs(left), strict=True):
                which = where.partition(" about ")[0].partition(" at ")[0]
                if sd > found.get(which, ("", limit))[1]:
                    found[which] = (where, float(sd))
        return sorted(found.values(), key=lambda one: -one[1])

    def instead(self, id: str, menu: Sequence[Added]) -> list[tuple[Added, ...]]:
        """The effects with each of those of `menu` in the place of `id` that could stand for it."""
        rest = replace(self.best, effects=tuple(one for one in self.best.effects if one.named.id != id))
        others = [one for other in self.alike[id][1:] for one in menu if one.named.id == other]
        return [self.view.explained((*rest.effects, self.view.scanned(rest, one)[1])).effects for one in others]

    def estimates(self) -> dict[str, tuple[EffectEstimate, ...]]:
        """By id the sizes of the effects, between 90 % limits.

        They are those of a fit in which every size is free, one that is stated, too, beside what comes closest to what is left.
        Those of a size that is stated lie about what that fit finds of it.
        """
        beside = () if self.after is None else (self.after.added,)
        again = self.view.explained(tuple(replace(one, fixed=False) for one in (*self.best.effects, *beside)))
        spread = np.sqrt(np.diag(again.covariance(self.variance)))
        told = {one.name: (one, float(sd)) for one, sd in zip(self.view.sizes(again.effects), spread, strict=True)}
        found = {}
        for one in self.best.effects:
            own = []
            for size in one.named.sizes:
                value = one.named.values[size.key]
                low = high = value
                if (which := name(one.named, size.key)) in told:
                    free, sd = told[which]
                    about = free.start if one.fixed else free.offset(value)
                    half = NORMAL_90 * sd * free.tolerance
                    ends = sorted(ends_of(free, about, (about - half, about + half)))
                    low, high = (min(max(end, size.low), size.high) for end in ends)
                own.append(EffectEstimate(key=size.key, value=value, unit=size.unit, low=low, high=high))
            found[one.named.id] = tuple(own)
        return found

    @classmethod
    def search(cls, data: Study, menu: Sequence[Added], progress: Progress) -> "FromAfar | None":
        """The effects of `menu` that bring the landmarks of the tests of `data` nearest.

        Only what changes the structure, or the level of all that a sensor reads, is looked for from afar: delays, windows and
        crooked blows move no resonance. None where the model is not far, or none brings them near.
        """
        menu = [one for one in menu if FAMILIES[one.named.family].side == STRUCTURE or one.named.family in GAINS]
        view = DistantView(marks=Landmark.of_tests(data.predictions))
        if not view.marks:
            return None
        base = view.home
        if not view.far:
            return None
        progress("looking from afar", 0.0)
        groups = view.groups(menu)
        firsts = [group[0] for group in groups]
        # What mechanics states is asked first: it has no size by which it could explain anything else
        start = base
        for known in stated(menu):
            with_it = view.explained((*start.effects, known))
            start = with_it if with_it.chi2 < start.chi2 else start
        nodes: dict[frozenset[str], LandmarkFit] = {base.ids: base, start.ids: start}
        asked: set[frozenset[str]] = set()

        def without(node: LandmarkFit, one: Added) -> LandmarkFit:
            return nodes.get(node.ids - {one.named.id}) or view.explained(tuple(each for each in node.effects if each is not one))

        def beside(some: Sequence[LandmarkFit], done: float) -> list[LandmarkFit]:
            """The nodes with one effect more than `some`, of those that come nearest."""
            made: dict[frozenset[str], LandmarkFit] = {}
            for k, node in enumerate(some):
                progress("looking from afar", (done + k / len(some)) / (MOST_EFFECTS + 1))
                asked.add(node.ids)
                others = [one for one in firsts if one.named.id not in node.ids]
                for there in _diverse(view.looked(node, others, LOOKED_AT), TRIED):
                    if (ids := node.ids | {there.named.id}) not in made:
                        made[ids] = nodes.get(ids) or view.explained((*node.effects, there))
            nodes.update(made)
            return list(made.values())

        beam = [start]
        for depth in range(MOST_EFFECTS):
            made = beside(beam, depth)
            variance = view.variance(nodes.values())
            ordered = sorted(made, key=lambda one: -one.log_evidence(variance))
            newest = {id(one.effects[-1]): one for one in ordered}
            beam = [newest[id(one)] for one in _diverse([one.effects[-1] for one in ordered], KEPT)]
        while beam:  # what came first may only have stood for what came after: each is asked once more beside the others
            first = max(beam, key=lambda one: one.log_evidence(variance))
            rests: dict[frozenset[str], LandmarkFit] = {}
            for node in (one for one in beam if one.log_evidence(variance) > first.log_evidence(variance) - EVIDENCE_THRESHOLD):
                for one in node.effects[len(start.effects) :]:
                    if (ids := node.ids - {one.named.id}) not in asked | rests.keys():
                        rests[ids] = without(node, one)
            made = beside(list(rests.values()), MOST_EFFECTS)
            variance = view.variance(nodes.values())
            beam = [one for one in made if one.log_evidence(variance) > first.log_evidence(variance)]
        progress("telling what is near apart by lines", 0.9)
        best = view.needed(data, [one for one in nodes.values() if one.ids >= start.ids], start, variance)
        gains: dict[str, float] = {}
        for added in best.effects:
            of, rest = (view.explained((added,)), base) if added.fixed else (best, without(best, added))  # stated: by itself
            gains[added.named.id] = of.log_evidence(variance) - rest.log_evidence(variance)
        faint = {one.named.id for one in best.effects if one.fixed and gains[one.named.id] < evidence_threshold(one.named.family)}
        if faint:
            best = view.explained(tuple(one for one in best.effects if one.named.id not in faint))
            gains = {id: gain for id, gain in gains.items() if id not in faint}
        if not best.effects or base.chi2 - best.chi2 < EXPLAINED * (base.chi2 - view.number):
            return None
        alike = {
            each.named.id: (each.named.id,) if each.fixed else view.alike(best, each, groups, nodes, variance)
            for each in best.effects
        }
        if any(len(ids) > MOST_ALIKE for ids in alike.values()):
            return None
        with_one = [one for one in nodes.values() if len(one.effects) == len(start.effects) + 1 or (one is start is not base)]
        beside_best = [node for node in nodes.values() if node.ids > best.ids and len(node.effects) == len(best.effects) + 1]
        nearest = max(beside_best, key=lambda one: one.log_evidence(variance), default=None)
        return cls(
            best=best,
            variance=variance,
            number=view.number,
            base=base,
            gains=gains,
            alike=alike,
            alone=tuple(sorted((view.looked_at(one, base, variance) for one in with_one), key=lambda one: -one.evidence)),
            after=None if nearest is None else view.looked_at(nearest, best, variance),
            view=view,
        )


def _diverse(found: Sequence[Added], most: int) -> list[Added]:
    """The first `most` of `found`, no more than `OF_A_FAMILY` of one family."""
    count: Counter[str] = Counter()
    kept = []
    for one in found:
        count[one.named.family] += 1
        if count[one.named.family] <= OF_A_FAMILY:
            kept.append(one)
    return kept[:most]


def line_fit(data: Study, effects: Sequence[Added], *, roughly: bool = False) -> Fit | None:
    """The fit of all lines of the response functions of `data` with `effects`, from the sizes at which they stand, over the floor
    of what is still far; None where there are no lines, or none is found. `roughly`, every third line and one beginning, will do
    to tell explanations apart: they differ by a share of what they cost.
    """
    problem = data.problem(effects)
    if not all(has_lines(one) for one in problem.predictions):
        return None
    with suppress(CheckFailed):
        stride, again = (STRIDE, 0) if roughly else (1, RESTARTS)
        return nearby(problem.sparser(stride), FITTED, problem.start, floor=COARSE[0], again=again)
    return None
