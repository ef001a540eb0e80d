"""A mass, a spring to the ground or a resonator at every node of a structure: where no name is known for what is missing.

The answers of the whole structure to sensors and drives (`AttachedResponse`) tell to first order what anything attached to
any node would change of every reading, and `validation.diagnose.unexplained_fit` what that would explain once all tolerances
have taken what they may of it: no node needs a solution of its own. Where it explains most the same is asked without the first
order, at sizes from next to nothing to far beyond what is plausible, of the few nodes that stand out.

What is looked for at thousands of nodes is found somewhere by chance. Where it sits is not known beforehand, so that what the
data say of it somewhere is the mean over the nodes,

    evidence = ln (1/p sum_n exp e_n) ,

and the best node has to bring more than one that somebody named by as much as the mean falls short of it (H. Jeffreys, Theory of
Probability, 1961, section 1.6: a law of which one constant is not known).
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np

from fem.structure import Structure, at_freedoms, position_of, removable
from geometry.dynamic_mass import ComplexArray
from geometry.errors import CheckFailed
from geometry.frames import Array, Integers
from identification.self_calibration.solve import inverse
from validation.diagnose import unexplained_fit as fit
from validation.diagnose.candidate_fits import (
    ABSURD,
    CandidateFit,
    can_restart,
    candidate_fit,
    declared,
    fit_in_place,
    fit_with,
    goodness_of_fit,
    over,
    ranked,
    restarted_from_priors,
)
from validation.diagnose.candidates import DAMPING, OCCAM, PER_OCTAVE, SAME_DIRECTION, band, has_lines
from validation.diagnose.diagnosis import Candidate, FoundNode
from validation.diagnose.search import FEW, FITS_OF_A_STEP, MOVES, SCREENING_ERROR, SCREENING_MARGIN, SearchStep, worth
from validation.effects.catalogue import FAMILIES, Named
from validation.effects.effect import INDISTINGUISHABLE_NATS, at_position, evidence_threshold, position
from validation.estimation.fit import BREAKDOWNS, FLOOR
from validation.estimation.likelihood import cost_of
from validation.estimation.problem import Fit, Prediction, Problem
from validation.model.model import Added
from validation.prediction.dynamic_mass import Finite
from validation.prediction.effects import UNSEEN, Nuisances
from validation.prediction.structure import ReducedStructure
from validation.prediction.structure_tests import OnNodes
from validation.study import Study

MASS, SPRINGS, RESONATOR = "point-mass", ("cable:x", "cable:y", "cable:z"), "absorber"
KINDS = (MASS, *SPRINGS, RESONATOR)
"""What is looked for: a family, with its direction."""

AT_ONCE = 4e6
"""[count] of readings of nodes that are worked out together: some ten megabytes an array. Exercised by test_everywhere.py."""

SURVEYED = 128
"""[count] of nodes, spread over the structure, at which frequency and damping of a resonator are looked up, and all else from
afar. Exercised by test_everywhere.py."""

KEPT = 5e8
"""[count] of bytes kept of what coordinates answer to places, three complex numbers a coordinate, line and place. Held by
test_everywhere.py."""

PRODUCTS = 1e10
"""[count] of readings times parameters times nodes, about a minute's work; beyond them nodes say what the nearest of those says
that are worked out. Held by test_everywhere.py."""

PROMISING = 3.0
"""[nats] to first order that a kind must bring somewhere for that: 20 to 1. Exercised by test_everywhere.py."""

OCTAVES = np.arange(-6.0, 4.0)
"""[octave] Sizes at which they are asked, of what is plausible. Exercised by test_everywhere.py."""

NARROW = np.arange(-2.0, 2.5)
"""[octave] Sizes of a node beside one of which the size is known, of that size; nearer by half from step to step. Held by
test_everywhere.py."""

NEAREST = 0.125
"""[share] of these that they come to at least: a quarter of an octave. Held by test_everywhere.py."""

NEARER = 3
"""[count] of sizes between those that are asked: data may tell one to a thousandth. Held by test_everywhere.py."""

STEPS = (1.0, 0.5, 0.2, 0.1, 0.05, 0.02)
"""[share] of the structure's size about the best in which a node is looked for, first in all. Held by test_everywhere.py."""

AROUND = 32
"""[count] of nodes that are asked there. Exercised by test_everywhere.py."""

ASKED = 1024
"""[count] of nodes, spread over the structure, at which twins of one are looked for: the cost of one search about a node.
Exercised by test_everywhere.py."""

NEIGHBOURS = 9
"""[count] of nodes, itself one, among which one with the most evidence is the top of a hill. Exercised by test_everywhere.py."""

APART = 0.03
"""[share] of the structure's size by which these lie apart: closer ones say the same. Exercised by test_everywhere.py."""


@dataclass(frozen=True, eq=False, kw_only=True)
class NodeScores:
    """What the data say of one structure's nodes.

    Attributes
    ----------
    article : its name
    structure : with its elements, to be drawn
    points : (p, 3) [m] the nodes that move
    evidence : by kind (p,) [nats], where the node is the only one that is looked at
    size : by kind (p,) SI: kg, N/m, and the mass of a resonator
    tuned : (p, 2) [Hz], [1] of that resonator; empty where none was looked for
    """

    article: str
    structure: Structure
    points: Array
    evidence: Mapping[str, Array]
    size: Mapping[str, Array]
    tuned: Array

    def somewhere(self, kind: str) -> float:
        """[nats] for something of that kind of which nobody knows where."""
        e = self.evidence[kind]
        return float(np.log(np.mean(np.exp(e - e.max()))) + e.max())

    def standing_out(self, kind: str) -> Integers:
        """Up to `FITS_OF_A_STEP` nodes, the best first, each `APART` from those before it."""
        left, found = np.argsort(-self.evidence[kind], kind="stable"), list[int]()
        apart = APART * float(np.ptp(self.points, axis=0).max())
        while len(left) and len(found) < FITS_OF_A_STEP:
            found.append(int(left[0]))
            left = left[np.linalg.norm(self.points[left] - self.points[left[0]], axis=1) > apart]
        return np.array(found, dtype=np.int64)

    def corrected(self, kind: str, told: Mapping[int, float]) -> "NodeScores":
        """With the evidence `told` of some nodes for `kind` without the first order, by as much higher or lower around each of
        them, and nowhere more than at the best of them."""
        from scipy.spatial import cKDTree

        nodes, evidence, whole = np.array([*told]), np.maximum([*told.values()], 0.0), self.evidence[kind]
        ratio = evidence / np.maximum(whole[nodes], PROMISING)
        around = np.minimum(whole * ratio[cKDTree(self.points[nodes]).query(self.points)[1]], evidence.max())
        around[nodes] = evidence
        return replace(self, evidence={**self.evidence, kind: around})

    def nearest(self, point: Sequence[float]) -> int:
        """The node at `point` (3,) [m], or nearest to it."""
        return int(np.argmin(np.linalg.norm(self.points - np.array(point), axis=1)))

    def named(self, kind: str, node: int, size: float) -> Named:
        """The effect at a node."""
        family, _, along = kind.partition(":")
        values = {"": size} if kind != RESONATOR else {"m": size, "f": self.tuned[node, 0], "zeta": self.tuned[node, 1]}
        place = at_position(self.points[node])
        return Named(family=family, targets=(place, along) if along else (place,), values=values)


Where = Callable[[Nuisances], Array]
"""Of a structure as a test knows it (q, 3, k), what each of its coordinates moves some places along x, y, z."""


@dataclass(frozen=True, eq=False, kw_only=True)
class MeshSearch:
    """All tests of one structure beside the fit of a candidate.

    Attributes
    ----------
    offsets : of the fit
    structure, whole : as the first of its tests knows it, and what that was reduced from
    points, moved : (p, 3) [m] nodes that move, and (p, 3) by which degrees of freedom
    tests : by data set, what the fit leaves, and its prediction
    brought : [nats] by an effect that the fit has and the prediction has not, where one is looked for in its place
    """

    offsets: Mapping[str, float]
    structure: Nuisances
    whole: ReducedStructure
    points: Array
    moved: Integers
    tests: tuple[tuple[fit.Swallowing, OnNodes], ...]
    brought: float = 0.0
    _reads: dict[tuple[bytes, ...], tuple[Callable[[Array, Array], ComplexArray], ...]] = field(default_factory=dict, init=False)

    @classmethod
    def of(cls, candidate: Candidate) -> Iterator["MeshSearch"]:
        """One for every structure of which nodes and units are known."""
        found: dict[int, list[tuple[fit.Swallowing, OnNodes]]] = {}
        if not any(nodes_of(one) for one in candidate.problem.predictions):
            return
        for one in fit.swallowing(candidate):
            prediction = one.of.prediction
            if isinstance(prediction, OnNodes) and (whole := nodes_of(prediction)):
                found.setdefault(id(whole.structure.stiffness), []).append((one, prediction))
        offsets = {**candidate.problem.start, **candidate.fit.by_name}
        for tests in found.values():
            structure = tests[0][1].structure
            assert structure is not None
            assert structure.reduced is not None
            points, moved = structure.reduced.nodes()
            yield cls(
                offsets=offsets, structure=structure, whole=structure.reduced, points=points, moved=moved, tests=tuple(tests)
            )

    @classmethod
    def in_place_of(cls, data: Study, there: Candidate, brought: float) -> Iterator["MeshSearch"]:
        """Of the newest effect of `there`, which `brought` that [nats]: tolerances follow a node in its place from where they
        stand with it, as far as they can with it. None of a structure of which nothing is left there without it."""
        *others, newest = there.effects
        problem = data.problem((*others, replace(newest, fixed=True)))
        free = tuple(problem.by_name[one.name] for one in there.fit.parameters if one.name in problem.by_name)
        fitted = _standing(problem, replace(there.fit, parameters=free), {**problem.start, **there.fit.by_name})
        without = {one.measured.name: one for one in data.problem(tuple(others)).predictions}
        for search in cls.of(Candidate(effects=(*others, replace(newest, fixed=True)), fit=fitted, problem=problem)):
            tests = [(left, without[one.measured.name]) for left, one in search.tests]
            here = replace(search, tests=tuple((left, one) for left, one in tests if isinstance(one, OnNodes)), brought=brought)
            with suppress(*BREAKDOWNS):
                if here.finite:
                    yield here

    def at(self, nodes: slice | Integers) -> Where:
        """Some of its nodes."""
        moved = self.moved[nodes]
        return lambda of: np.zeros((0, 3, 0)) if of.reduced is None else at_freedoms(of.reduced.basis, moved)

    @property
    def surveyed(self) -> Integers:
        """Nodes all over the structure."""
        return np.unique(np.linspace(0, len(self.points) - 1, SURVEYED).astype(np.int64))

    @property
    def worked_out(self) -> Integers:
        """Every node, or as many all over the structure as `PRODUCTS` are enough for."""
        a_node = sum(of.moved.size for of, _ in self.tests)
        most = min(max(int(PRODUCTS / a_node), SURVEYED), len(self.points))
        return np.unique(np.linspace(0, len(self.points) - 1, most).astype(np.int64))

    def scores(self, progress: Callable[[float], None] = lambda share: None) -> NodeScores:
        """Of every node; `progress` hears the share done."""
        from scipy.spatial import cKDTree

        every = self.worked_out
        points = self.points[every]
        evidence = {kind: np.zeros(len(points)) for kind in KINDS if kind != RESONATOR or self.lined}
        size = {kind: np.zeros(len(points)) for kind in evidence}
        tuned, places = np.zeros((len(points), 2)), self.resonances() if self.lined else ()
        together = max(int(AT_ONCE / (3 * sum(of.of.values.size for of, _ in self.tests))), 1)
        for begin in range(0, len(points), together):
            progress(begin / len(points))
            some = slice(begin, begin + together)
            told = self.told(self.at(every[some]), places)
            for kind, (e, c) in told.items():
                if kind in evidence:
                    evidence[kind][some], size[kind][some] = e, c
            for frequency, ratio in places:
                e, c = told[f"{RESONATOR}:{frequency}:{ratio}"]
                better = e > evidence[RESONATOR][some]
                evidence[RESONATOR][some], size[RESONATOR][some] = (
                    np.where(better, new, old[some]) for new, old in ((e, evidence[RESONATOR]), (c, size[RESONATOR]))
                )
                tuned[some][better] = frequency, ratio
        nearest = cKDTree(points).query(self.points)[1]
        return NodeScores(
            article=self.structure.configuration,
            structure=self.whole.structure,
            points=self.points,
            evidence={kind: one[nearest] for kind, one in evidence.items()},
            size={kind: one[nearest] for kind, one in size.items()},
            tuned=tuned[nearest],
        )

    @property
    def lined(self) -> bool:
        """Whether there are lines of a spectrum, along which a resonator can be looked for."""
        return any(has_lines(prediction) for _, prediction in self.tests)

    def told(self, where: Where, places: Sequence[tuple[float, float]]) -> dict[str, tuple[Array, Array]]:
        """By kind evidence (q,) [nats] and size (q,), at some places.

        Parameters
        ----------
        places : frequency [Hz] and damping ratio of resonators, which stand under a kind of their own each
        """
        answers: dict[str, list[fit.Answers]] = {}
        for of, prediction in self.tests:
            made = prediction.attached(self.offsets, of.of.lines, where(_known(prediction)), of.of.inputs)
            mass = made.readings.sum(axis=-1)
            answers.setdefault(MASS, []).append(_answers(of, mass))
            for axis, kind in enumerate(SPRINGS):
                along = made.readings[..., axis] * made.spring[:, :, None, None]
                answers.setdefault(kind, []).append(_answers(of, along))
            for f, ratio in places if has_lines(prediction) else ():
                course = _resonator(of.of.frequency, f, ratio)[None, :, None, None]
                answers.setdefault(f"{RESONATOR}:{f}:{ratio}", []).append(_answers(of, mass * course))
        plausible = self.plausible(where)
        return {kind: self._evidence(kind, each, plausible) for kind, each in answers.items()}

    def _evidence(self, kind: str, answers: Sequence[fit.Answers], plausible: Mapping[str, Array]) -> tuple[Array, Array]:
        """[nats] and sizes; a spring that pushes and a resonator of less than no mass are none."""
        found = fit.gains(answers, self.tests[0][0].slope)
        gain, size = found.gain, found.size
        if kind not in plausible:
            own = sum(one.own for one in answers)
            left = own - np.sum(np.square(sum(one.swallowed for one in answers)), axis=-1)
            sound = (size > 0) & (left > SAME_DIRECTION * own)
            return np.where(sound, gain - OCCAM, -OCCAM), np.maximum(size, 0.0)
        # 1/2 c² q (q s²) / (1 + q s²) - 1/2 ln (1 + q s²), as of `validation.estimation.screening.ScoreTest`
        q = np.divide(2 * gain, size**2, out=np.zeros_like(gain), where=size != 0)
        wide = q * plausible[kind] ** 2
        allowed = (size > 0) | (kind == MASS)
        return np.where(allowed, gain * wide / (1 + wide), 0.0) - 0.5 * np.log1p(wide), np.where(allowed, size, 0.0)

    def plausible(self, where: Where) -> dict[str, Array]:
        """By kind (q,) standard deviation of a fault, as `validation.prediction.effects.plausible` has it of a named place and a
        `Problem` of several data sets."""
        found: dict[str, list[Array]] = {kind: [] for kind in (MASS, *SPRINGS)}
        for of in {id(one.structure): _known(one) for _, one in self.tests}.values():
            square = where(of)[:, :, of.nominal.base + np.arange(len(of.frequency))] ** 2
            at = np.max(square / (2 * np.pi * of.frequency) ** 2, axis=-1, initial=0.0)  # no mode may lie below twice the band
            for kind, by in zip(found, (square.sum(axis=1).max(axis=-1, initial=0.0), *at.T), strict=True):
                (size,) = FAMILIES[kind.partition(":")[0]].sizes
                found[kind].append(np.where(by > 0, UNSEEN / np.maximum(by, UNSEEN / size.high), size.plausible))
        return {kind: np.min(each, axis=0) for kind, each in found.items()}

    def resonances(self) -> tuple[tuple[float, float], ...]:
        """Frequencies [Hz] and damping ratios at which a resonator explains most at any of some nodes."""
        some = self.at(self.surveyed)
        lined = [(of, one) for of, one in self.tests if has_lines(one)]
        low, high = band(of.of.frequency for of, _ in lined)
        every = np.geomspace(low, high, max(int(PER_OCTAVE * np.log2(high / low)), 2))
        places = [(float(f), ratio) for ratio in DAMPING for f in every]
        answers = []
        for of, one in lined:
            mass = one.attached(self.offsets, of.of.lines, some(_known(one)), of.of.inputs).readings.sum(axis=-1)
            products = fit.products(of, mass, np.arange(mass.shape[2]))
            courses = np.stack([_resonator(of.of.frequency, f, ratio) for f, ratio in places])
            answers.append(fit.following(products, courses, of.root))
        found = fit.gains(answers, lined[0][0].slope)
        best = np.where(found.size > 0, found.gain, 0.0).max(axis=1)
        return tuple(places[k] for k in np.argsort(-best)[:FEW])

    def sized(
        self, kind: str, place: int | str, first: float, octaves: Array = OCTAVES, *, nearer: int = 0
    ) -> tuple[float, float]:
        """Evidence [nats] and size of a mass or a spring at a node or a place with a name, without the first order.

        Tolerances follow to first order what the effect does at each size, all of the sign of its size to `first` order. No
        more is missing than is `removable`.

        Parameters
        ----------
        octaves : sizes, as powers of two of what is plausible
        nearer : how often the top of the parabola over the best of them and its neighbours is asked, too
        """
        if isinstance(place, str):
            where, point = _named([place]), position_of(self.whole.structure, place)
        else:
            where, point = self.at(np.array([place])), self.points[place]
        spread = float(self.plausible(where)[kind][0])
        sign, most = (-1, removable(self.whole.structure, point)) if first < 0 else (1, np.inf)
        rows = [where(_known(one))[0] for _, one in self.tests]
        asked = tuple(row.tobytes() for row in rows)
        if asked not in self._reads:  # of every kind the same places; what each holds may be megabytes
            a_place = sum(48 * left.of.values.shape[1] * len(_known(one).nominal.mass) for left, one in self.tests)
            if len(self._reads) >= min(SURVEYED, KEPT / a_place):
                self._reads.clear()
            self._reads[asked] = tuple(of(row) for of, row in zip(self.finite, rows, strict=True))
        reads = self._reads[asked]

        along = np.ones(3) if kind == MASS else np.arange(3) == SPRINGS.index(kind)

        def at(some: Array) -> list[tuple[float, float]]:  # what tolerances take of them, hundreds of columns, is asked at once
            told, beyond, sizes = np.full(len(some), -np.inf), dict[int, list[ComplexArray]](), np.exp2(some)
            for k, added in enumerate(sign * spread * sizes[:, None] * along):
                if spread * sizes[k] > most:
                    continue
                with suppress(*BREAKDOWNS):
                    read = [one(added, 0 * added) if kind == MASS else one(0 * added, added) for one in reads]
                    beyond[k] = [left.beyond(rows) for (left, _), rows in zip(self.tests, read, strict=True)]
            if beyond:
                each = zip(self.tests, zip(*beyond.values(), strict=True), strict=True)
                answers = [left.answers(np.stack(columns)) for (left, _), columns in each]
                gain, square = fit.gain(answers, self.tests[0][0].slope) + self.brought, sizes[[*beyond]] ** 2
                told[[*beyond]] = gain - 0.5 * square - 0.5 * np.log1p(2 * np.maximum(gain, 0.0) / square)
            return list(zip(some.tolist(), told.tolist(), strict=True))

        found = sorted(at(octaves))
        for _ in range(nearer):
            best = max(range(len(found)), key=lambda k: found[k][1])
            if not 0 < best < len(found) - 1:
                break
            (x0, y0), (x1, y1), (x2, y2) = found[best - 1 : best + 2]
            left, right = (x1 - x0) * (y1 - y2), (x1 - x2) * (y1 - y0)
            if not np.isfinite(left - right) or left == right:
                break
            top = x1 - 0.5 * ((x1 - x0) * left - (x1 - x2) * right) / (left - right)
            found = sorted([*found, *at(np.array([top]))])
        octave, gain = max(found, key=lambda one: one[1])
        return gain, float(sign * spread * np.exp2(octave))

    def nearby(self, kind: str, point: Array, size: float) -> tuple[int, float, float]:
        """The best node that is reached from `point` (3,), where `size` is that, its evidence [nats] and size."""
        node = int(np.argmin(np.linalg.norm(self.points - point, axis=1)))
        best = (*self.sized(kind, node, size), node)
        for k, step in enumerate(STEPS):
            away = np.linalg.norm(self.points - self.points[best[2]], axis=1) / np.ptp(self.points, axis=0).max()
            near = np.argsort(away)[: int(np.sum(away <= step))]  # itself, too, at nearer sizes
            asked = np.unique(near[np.linspace(0, len(near) - 1, AROUND).astype(np.int64)])
            at = np.log2(abs(best[1]) / self.plausible(self.at(np.array([best[2]])))[kind][0])
            some = at + NARROW * max(0.5**k, NEAREST)
            told = [(*self.sized(kind, one, size, some, nearer=NEARER if k else 0), one) for one in asked.tolist()]
            best = max([best, *told])
        return best[2], best[0], best[1]

    def best_node(self, scores: NodeScores, kind: str, *, far: bool = False) -> tuple[int, float, float, dict[int, float]]:
        """The best node for `kind` that is reached from those that stand out, its evidence [nats] and size; and from `surveyed`
        ones where what is looked for may be `far`: no straight line leads there. Beside it the evidence of all of these."""
        evidence, size = scores.evidence[kind], scores.size[kind]
        if kind == RESONATOR:
            best = int(np.argmax(evidence))
            return best, float(evidence[best]), float(size[best]), {best: float(evidence[best])}
        asked = [(one, size[one]) for one in scores.standing_out(kind).tolist()]
        asked += [(one, sign) for one in self.surveyed.tolist() for sign in (1.0, -1.0)[: 1 + (kind == MASS)]] if far else []
        told = sorted((*self.sized(kind, one, first), one) for one, first in asked)
        node, gain, own = self.nearby(kind, self.points[told[-1][2]], told[-1][1])
        return node, gain, own, {one: each for each, _, one in told} | {node: gain}

    def about(self, kind: str, node: int, size: float) -> Array:
        """[octave] sizes about that of a `node`, as of `sized`: less mass where a structure moves more does nearly the same."""
        return np.asarray(np.log2(abs(size) / self.plausible(self.at(np.array([node])))[kind][0]) + NARROW / 2)

    def neighbours(self, kind: str, node: int, size: float) -> list[tuple[int, float]]:
        """Nodes beside a `node`, and sizes, that bring most if tolerances follow to first order, the best first. Along sharp
        resonances they do not, and only a fit tells what a neighbour brings."""
        near = np.argsort(np.linalg.norm(self.points - self.points[node], axis=1), kind="stable")[1:NEIGHBOURS]
        some = self.about(kind, node, size)
        told = sorted([(*self.sized(kind, one, size, some, nearer=NEARER), one) for one in near.tolist()])
        return [(one, x) for _, x, one in told[: -FEW - 1 : -1]]

    def twins(self, kind: str, named: Named) -> tuple[Named, ...]:
        """Effects at other nodes that may explain as much as `named` does. What is too heavy on one side of what is symmetric is
        as much too light on the other."""
        sizes = (named.value, -named.value) if kind == MASS else (named.value,)
        found = self.hills(kind, np.array(position(named.target)), sizes, itself=True)
        return tuple(_moved(named, self.points[node], size) for node, _, size in found)

    def hills(self, kind: str, point: Array, sizes: Sequence[float], *, itself: bool = False) -> list[tuple[int, float, float]]:
        """Nodes at which other hills of the evidence have their tops than that of `point` (3,), its evidence [nats] and size, the
        best first, as far as they may bring as much as it once tolerances follow; before them the best of its own where that
        `itself` is asked for.

        Every node is asked for sizes `about` the first of `sizes` at that of `point`, of the signs of all.
        """
        from scipy.spatial import cKDTree

        own, *near = np.argsort(np.linalg.norm(self.points - point, axis=1), kind="stable")[:NEIGHBOURS].tolist()
        some = np.unique([own, *near, *np.linspace(0, len(self.points) - 1, ASKED).astype(np.int64)])
        asked = self.about(kind, own, sizes[0])
        each = [max(self.sized(kind, n, x, asked, nearer=1) for x in sizes) for n in some.tolist()]
        gains, here = np.array([gain for gain, _ in each]), int(np.searchsorted(some, own))
        around = cKDTree(self.points[some]).query(self.points[some], k=min(NEIGHBOURS, len(some)))[1]
        uphill = around[np.arange(len(some)), np.argmax(gains[around], axis=1)]
        top = np.where(gains[uphill] > gains, uphill, np.arange(len(some)))
        while np.any(top[top] != top):
            top = top[top]
        rivals = np.flatnonzero((gains > _least_of_rivals(gains[here])) & (np.arange(len(some)) != here))
        rivals = rivals[np.argsort(-gains[rivals], kind="stable")]
        beside, others = rivals[top[rivals] == top[here]], rivals[(top[rivals] == rivals) & (rivals != top[here])]
        best = [*(beside[:FEW] if itself else ()), *others[:FEW]]
        return [(int(some[k]), float(gains[k]), each[k][1]) for k in best]

    def best_name(self, kind: str) -> tuple[str, float]:
        """The best of the places that have names, and its evidence [nats]; empty where there is none."""
        names = [name for name in self.structure.nominal.places if position(name) is None]
        if not names or kind == RESONATOR:
            return "", 0.0
        first, size = self.told(_named(names), ())[kind]
        gain, name = max((self.sized(kind, names[k], size[k])[0], names[k]) for k in np.argsort(-first)[:FEW].tolist())
        return name, gain

    @cached_property
    def finite(self) -> tuple[Finite, ...]:
        """By test, what is read with a mass or a spring of any size."""
        return tuple(one.finite(self.offsets, left.of.lines) for left, one in self.tests)


def _moved(named: Named, point: Sequence[float], size: float) -> Named:
    """`named` of another size, at a point (3,) [m]."""
    return replace(named, targets=(at_position(point), *named.targets[1:]), values={"": size})


def _least_of_rivals(gain: float) -> float:
    """[nats], not below 0, that another node must bring to be as good as one with that `gain` once tolerances follow."""
    return max((1 - SCREENING_ERROR) * gain - SCREENING_MARGIN, 0.0)


def nodes_of(one: Prediction) -> ReducedStructure | None:
    """The structure of which something could be attached to any node; None where no nodes or no units are known."""
    of = one.structure if isinstance(one, OnNodes) else None
    whole = of.reduced if of is not None and of.scaled else None
    return whole if whole is not None and len(whole.nodes()[0]) else None


def _named(places: Sequence[str]) -> Where:
    return lambda of: np.stack([of.nominal.places[name] for name in places])


def _known(one: OnNodes) -> Nuisances:
    assert one.structure is not None  # it has nodes
    return one.structure


def _answers(of: fit.Swallowing, readings: ComplexArray) -> fit.Answers:
    """Of changes of the readings (r, m, c, q)."""
    return of.answers(np.moveaxis(of.of.kept(readings * of.of.weight[..., None], np.arange(readings.shape[2])), -1, 0))


def _resonator(frequency: Array, own: float, ratio: float) -> ComplexArray:
    """(m,) what a resonator adds to the dynamic mass, times what its mass held there would add."""
    spring = own**2 + 2j * ratio * own * frequency
    return np.asarray(spring / (spring - frequency**2))


def found_nodes(
    candidate: Candidate, progress: Callable[[float], None] = lambda share: None, *, far: bool = False
) -> tuple[tuple[NodeScores, ...], tuple[FoundNode, ...]]:
    """What the data say of all nodes beside the fit of `candidate`, and of every kind that explains anything the best node,
    from afar also those of other hills; `progress` hears the share done."""
    every, found = list[NodeScores](), list[FoundNode]()
    wholes = {id(whole.structure.stiffness) for one in candidate.problem.predictions if (whole := nodes_of(one))}
    for k, search in enumerate(MeshSearch.of(candidate)):
        done = partial(lambda before, share: progress((before + share / 2) / len(wholes)), k)
        scores = search.scores(done)
        drawn = scores
        told = [(kind, evidence) for kind, evidence in scores.evidence.items() if evidence.max() >= PROMISING]
        tops = dict[str, list[tuple[int, float, float]]]()
        for asked, (kind, _) in enumerate(told):
            done(1 + asked / len(told))
            node, gain, size, by_node = search.best_node(scores, kind, far=far)
            tops[kind], drawn = [(node, gain, size)], drawn.corrected(kind, by_node)
        least = _least_of_rivals(max((top[0][1] for kind, top in tops.items() if kind != RESONATOR), default=np.inf))
        every.append(drawn)
        for kind, top in tops.items():
            (node, gain, size), evidence = top[0], scores.evidence[kind]
            if far and kind != RESONATOR and gain > least:
                top += search.hills(kind, search.points[node], [size])
            name, of_name = search.best_name(kind)
            looked, first = float(evidence.max()) - scores.somewhere(kind), int(np.argmax(evidence))
            for node, gain, size in top:
                point = scores.points[node]
                nearest, distance = nearest_place(scores.structure, point)
                found.append(
                    FoundNode(
                        named=scores.named(kind, node, size),
                        straight=None if far else scores.named(kind, first, float(scores.size[kind][first])),
                        article=scores.article,
                        evidence=gain - looked,
                        looked=looked,
                        position=(float(point[0]), float(point[1]), float(point[2])),
                        nearest=nearest,
                        distance=distance,
                        named_place=name,
                        named_evidence=of_name,
                    )
                )
    return tuple(every), tuple(sorted(found, key=lambda one: -one.evidence))


def without_a_name(
    data: Study,
    base: Candidate,
    nodes: Sequence[FoundNode],
    wanted: Callable[[Named], bool] = lambda named: True,
    progress: Callable[[float], None] = lambda share: None,
    rivals: Callable[[], Sequence[CandidateFit]] = tuple,
) -> tuple[FoundNode, ...]:
    """Of the kinds of `nodes` the places that are worth a fit although they have no name: they would explain what is worth a
    parameter, and what no place that has a name explains as well. As a fit of all tolerances left them, the best first.

    A large fault has the fit without it move tolerances far, and then a node is not seen where it is. So the mesh is asked from
    the tolerances as they are declared, too; the best are fitted, and the mesh is asked again around each beside the effect.
    No way goes on that cannot come as low as a fit of `rivals` that leaves nothing; `progress` hears the share done.
    """
    seen = [one for one in nodes if _is_worth(one)]
    if not seen and goodness_of_fit(base.fit, base.problem).null:
        return ()
    found, stood = dict[str, FoundNode](), dict[str, Candidate]()
    asked = set[str]()
    at_home = replace(base, fit=_standing(base.problem, base.fit, base.problem.start))
    declared = found_nodes(at_home, lambda share: progress(share / 2), far=True)[1]
    declared = tuple(one for one in declared if wanted(one.named) and _is_worth(one))
    # A resonator far above the band is a mass, and takes a fit of three sizes: it comes last, where it promises more than those
    both = []
    for far, listed in ((False, seen), (True, declared)):  # of the first few kinds the best, and its other hills
        kinds = list(dict.fromkeys((one.article, one.kind) for one in listed if one.kind != RESONATOR))[:FEW]
        both += [(one, far) for one in listed if (one.article, one.kind) in kinds]
    both += [(each, False) for each in seen if each.kind == RESONATOR]
    begins = [(each, far, named) for each, far in both for named in (each.named, each.straight) if named is not None]
    tried, least = list(rivals() if begins else ()), -np.inf  # of what is seen from home, beside a fit that leaves nothing
    for k, (one, from_afar, here) in enumerate(begins):
        progress((1 + k / len(begins)) / 2)
        kind, most, some, beside = one.kind, -np.inf, [here], None
        if kind == RESONATOR and any(one.evidence < each.evidence + INDISTINGUISHABLE_NATS for each in found.values()):
            continue
        if from_afar and one.evidence < least:
            continue
        for _ in range(MOVES):
            ends = []
            for each in some:
                if each.id in asked:
                    continue
                asked.add(each.id)
                ready = data.ready_at([each.target], anew=False)
                start, effect = replace(base, problem=ready.problem(base.effects)), Added(named=each)
                way, enough = restarted_from_priors if can_restart(effect) else fit_with, worth(base, tried)
                with suppress(CheckFailed):  # over the coordinates of this node the model breaks down
                    if beside is not None:
                        there = fit_in_place(ready, beside, start, effect, worth=min(enough, beside.fit.cost + SCREENING_MARGIN))
                    else:
                        there = way(ready, start, effect, worth=enough)
                    tried.append(candidate_fit(base, there))
                    ends.append((there.fit.log_evidence, there, each, ready))
            best, there, here, ready = max(ends, key=lambda end: end[0], default=(-np.inf, base, here, data))
            if best <= most:
                break
            if from_afar and goodness_of_fit(there.fit, there.problem).null:
                least = max(least, _least_of_rivals(one.evidence))
            most, fitted = best, there.effects[-1].named
            point = position(here.target) or one.position
            gain = most - base.fit.log_evidence - one.looked
            if kind not in found or gain > found[kind].evidence:
                found[kind], stood[kind] = replace(one, named=fitted, position=point, evidence=gain, fit=there.fit), there
            if kind == RESONATOR or not fitted.value or there.fit.cost > worth(base, tried):
                break
            about = MeshSearch.in_place_of(ready, there, base.fit.cost - there.fit.cost)
            search = next((each for each in about if each.structure.configuration == one.article), None)
            if search is None:
                break
            node, _, size = search.nearby(kind, np.array(point), fitted.value)
            stays = at_position(search.points[node]) == here.target
            further, beside = (search.neighbours(kind, node, size), there) if stays else ([(node, size)], None)
            some = [_moved(here, search.points[other], value) for other, value in further]
    on = [one for one in base.problem.predictions if isinstance(one, OnNodes)]
    structures = {_known(one).configuration: whole.structure for one in on if (whole := nodes_of(one))}
    for kind, one in found.items():
        nearest, distance = nearest_place(structures[one.article], np.array(one.position))  # it may have moved
        found[kind] = replace(one, nearest=nearest, distance=distance)
        if one.named_place and not _is_worth(one):  # a place with a name was promised as much, and is fitted as the node was
            named = replace(one.named, targets=(one.named_place, *one.named.targets[1:]))
            there = fit_in_place(data, stood[kind], base, Added(named=named))
            found[kind] = replace(found[kind], named_evidence=there.fit.log_evidence - base.fit.log_evidence)
    return tuple(sorted((one for one in found.values() if _is_worth(one)), key=lambda one: -one.evidence))


def _standing(problem: Problem, of: Fit, offsets: Mapping[str, float]) -> Fit:
    """`of` a `problem` as it stands at `offsets`, with the covariance that belongs there."""
    cost = cost_of(problem, of.parameters, FLOOR, offsets)
    x = cost.at(offsets)
    return replace(of, offsets=x, covariance=inverse(cost.total(x)[0].matrix))


def kind_of(added: Added) -> str:
    """Which of `KINDS` an effect is that may move to another node; empty for none."""
    kind = ":".join((added.named.family, *added.named.targets[1:]))
    return kind if kind in (MASS, *SPRINGS) and not added.fixed and added.named.value else ""


def elsewhere(data: Study, rest: Candidate, there: Candidate) -> tuple[tuple[Study, Added, float], ...]:
    """The nodes at which the newest effect of `there`, a mass or a spring that `rest` has not, may explain most, with the study
    that is ready for all of them: the modes of what is sound do not hold how what carries a large mass bends.

    Tolerances are followed from where they stand with it, once as far as they can with it and once as far as they can without:
    along the lines of a spectrum the one errs, of a table of modes the other. Where they stand absurdly far they pay for a wrong
    place, and hills are asked from where they are declared, too. Where it has a name, a node that has none must
    bring more than it by what tells two explanations apart, and by what it costs to have looked at all: that [nats] is the third.
    """
    added = there.effects[-1]
    kind, here = kind_of(added), added.named.target
    if not kind:
        return ()
    offsets = {**rest.problem.start, **{one: x for one, x in there.fit.by_name.items() if one in rest.problem.by_name}}
    absurd = goodness_of_fit(there.fit, there.problem).largest >= ABSURD

    def standing(at: Mapping[str, float]) -> Iterator[MeshSearch]:
        return MeshSearch.of(replace(rest, fit=_standing(rest.problem, rest.fit, at)))

    near = (*MeshSearch.in_place_of(data, there, rest.fit.cost - there.fit.cost), *standing(offsets))
    home = standing(declared(rest.problem, rest.fit)) if absurd else ()
    searches = (*((one, False) for one in near), *((one, True) for one in home))
    found, named = dict[str, tuple[Added, float]](), position(here)
    for search, far in searches:
        point = None if named is None else np.array(named)
        if here in search.whole.structure.places:
            point = position_of(search.whole.structure, here)
        if point is None:
            continue
        begin, size = point, added.named.value
        if far and (tops := search.hills(kind, point, [size], itself=True)):
            node, _, size = max(tops, key=lambda top: top[1])
            begin = search.points[node]
        node, _, size = search.nearby(kind, begin, size)
        place = at_position(search.points[node])
        again = _moved(added.named, search.points[node], size)
        if again.id not in {one.named.id for one in there.effects} and not np.allclose(search.points[node], point):
            looked = 0.0 if named is not None else float(np.log(len(search.points))) + INDISTINGUISHABLE_NATS
            found.setdefault(place, (Added(named=again), looked))
    ready = data.ready_at([*found], anew=False) if found else data
    return tuple((ready, *one) for one in found.values())


def with_twins(data: Study, at: Candidate, steps: Sequence[SearchStep]) -> tuple[Study, Candidate, tuple[SearchStep, ...]]:
    """`at`, and a step of each of its masses and springs at a node without a name of which another node explains these data as
    well: the other side of what is symmetric. The study is ready for all of them.
    """
    last, more = {one.added: one for one in steps}, list[SearchStep]()
    for one in at.effects:
        kind, step = kind_of(one), last.get(one.named.id)
        others = tuple(each for each in at.effects if each.named.id != one.named.id)
        if not kind or position(one.named.target) is None or step is None or len(step.at.effects) != len(others):
            continue
        there, rest = replace(at, effects=(*others, one)), replace(step.at, effects=others)
        searches = (*MeshSearch.in_place_of(data, there, rest.fit.cost - at.fit.cost), *MeshSearch.of(rest))  # as `elsewhere`
        found = {twin.id: twin for search in searches for twin in search.twins(kind, one.named)}
        twins = [replace(one, named=twin) for twin in found.values()]
        if not twins:
            continue
        try:
            ready = data.ready_at([one.named.target, *(twin.named.target for twin in twins)])
            rest, there = (over(ready, data, each) for each in (rest, there))
        except CheckFailed:  # over their coordinates the model breaks down
            continue
        here, enough = candidate_fit(rest, there), there.fit.cost + INDISTINGUISHABLE_NATS
        fits = [candidate_fit(rest, fit_in_place(ready, there, rest, twin, worth=enough)) for twin in twins]
        if alike := [each for each in fits if each.evidence > here.evidence - INDISTINGUISHABLE_NATS]:
            best, *tried = ranked([here, *alike])
            by = here.evidence - max(each.evidence for each in step.tried if each.id == here.id)  # over other coordinates
            tried += (replace(each, evidence=each.evidence + by) for each in step.tried if each.id != here.id)
            data, at = ready, best.candidate
            more.append(replace(step, at=rest, tried=(best, *ranked(tried)), added=best.id, reconsidered=one.named.id))
    return data, at, tuple(more)


def _is_worth(node: FoundNode) -> bool:
    return node.evidence >= max(evidence_threshold(node.named.family), node.named_evidence + INDISTINGUISHABLE_NATS)


def nearest_place(structure: Structure, point: Array) -> tuple[str, float | None]:
    """The named place of `structure` nearest to `point` (3,) [m], and its distance [m]; empty where none has coordinates."""
    named = {name: position_of(structure, name) for name in structure.places if position(name) is None}
    away = {name: float(np.linalg.norm(place - point)) for name, place in named.items() if place is not None}
    nearest = min(away, key=away.__getitem__, default="")
    return nearest, away.get(nearest)
