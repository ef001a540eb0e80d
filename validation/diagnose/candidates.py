"""The candidates: every effect of the catalogue that could act on these data, at the size at which it does nothing.

A resonator has no such size in its logarithm: it stands at next to nothing, at a frequency that `dictionary` moves.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import inf, isfinite, log, sqrt

import numpy as np
from scipy.linalg import solve_triangular

from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array
from geometry.toml_file import nearest
from identification.quality import NORMAL_90
from validation.diagnose import pendulum
from validation.diagnose.classical import pendulum_candidates
from validation.diagnose.diagnosis import Candidate, Detectable, Screened
from validation.diagnose.unexplained_fit import Answers, Swallowing, gain, swallowing
from validation.effects import effect
from validation.effects.catalogue import FAMILIES, Named, acts
from validation.estimation.fit import BREAKDOWNS, FLOOR
from validation.estimation.likelihood import cost_of, tailed
from validation.estimation.problem import EFFECT, FITTED, Fact, Offsets, Parameter, Prediction, Problem
from validation.estimation.screening import KNOWN, POWER, MadeUp, ScoreTest, in_the_fit, screened
from validation.history.add import names_of
from validation.model.model import Added
from validation.prediction import effects
from validation.prediction.classical_facts import ArticleFact
from validation.prediction.modal_table import TableFrequencies
from validation.prediction.series import pilots
from validation.prediction.structure_tests import StructurePrediction
from validation.study import Study

SIDES = (effect.STRUCTURE, effect.FORCES, effect.ACCELERATIONS)
"""What one level of a linear test shows; mistakes and what depends on the level are tested before."""

SHOWN = (effect.STRUCTURE_STAGE, effect.BODY_STAGE, effect.CHANNEL_STAGE, effect.OPENED)

RESONATOR = ("m", "f", "zeta")
"""Keys of the sizes of a resonator."""

OF_BASE = ("accelerometer-misalignment", "accelerometer-position")
"""Families of a single-axis shaker's pilot that its unmeasured cross motion looks like."""

TINY = 1e-9
"""[kg] Mass of a resonator that does next to nothing; a step of its logarithm is then linear. Set by the development draws of
`make blind`, held by test_candidates.py."""

TINY_AT = {"m": TINY, "f": 1000.0, "zeta": 0.02}


def baseline(study: Study) -> Candidate:
    """The model of `study` as it is, all its parameters fitted: what a candidate is added to.

    Raises
    ------
    CheckFailed : the fit does not converge.
    """
    return Candidate(effects=(), fit=study.all_free().required(), problem=study.problem())


def candidates(
    data: Study, *, only: Sequence[str] = (), leave_out: Sequence[str] = (), swinging: bool = False
) -> tuple[Added, ...]:
    """What could be missing from the model of `data`.

    Parameters
    ----------
    only : families or ids that are looked for; all where nothing is said
    leave_out : families or ids that are not
    swinging : whether resonators are asked for where there are but modes, which no straight line leads to

    Raises
    ------
    BadInput : one of `only` is no effect that could act on these data and be told by them.
    """
    words, known = data.words, {one.named.id for one in data.model.effects}
    lines = swinging or any(has_lines(one) for one in (*data.made, *data.tests))
    once = {word for wanted in only for word in wanted.split(":")}
    once |= {name for one in (*data.made, *data.tests) if one.structure for name in one.structure.nominal.once}
    words = replace(words, places=tuple(place for place in words.places or () if place in once))
    slanted = {name for one in data.campaigns for name in pilots(one)}
    acting: list[Added] = []
    for family in FAMILIES.values():
        if family.side not in SIDES or family.stage not in SHOWN:
            continue
        for targets in product(*(words.legal(kind) or () for kind in family.targets)):
            sizes = family.sizes_at(targets)
            values: Mapping[str, float] = {
                size.key: size.null if size.plausible > 0 or size.default is None else size.default for size in sizes
            }
            values = TINY_AT if tuple(size.key for size in sizes) == RESONATOR else values
            named = Named(family=family.name, targets=targets, values=values)
            if (is_resonator(named) and not lines) or (family.name in OF_BASE and named.target in slanted):
                continue
            if named.id not in known and any(acts(named, place) for place in data.there):
                acting.append(Added(named=named, fixed=bool(sizes) and all(size.whole for size in sizes)))
    # Parameters that effects without an equation would open; a chain makes them when they are asked for
    asking = tuple(replace(one, fixed=False) for one in acting if FAMILIES[one.named.family].stage == effect.OPENED)
    opened = {
        one.name for made in (*data.made, *data.tests) for one in made.with_effects((*data.model.effects, *asking)).parameters
    }
    possible = [one for one in acting if FAMILIES[one.named.family].stage != effect.OPENED or one.named.id in opened]
    possible += (one for one in pendulum_candidates(pendulum.swings(data, ())) if one.named.id not in known)
    found = [one for one in possible if looked_for(one.named, (), leave_out)]
    for wanted in only:
        if not any(_is(one.named, wanted) for one in found):
            names = dict.fromkeys(name for one in found for name in (one.named.family, one.named.id))
            problem = "is no effect that could act on these data and be told by them"
            there = ", ".join(one.named.id for one in found if one.named.family == wanted.partition(":")[0])
            remedy = f"{nearest(wanted, names)}{f'There are {there}' if there else '`massline effects` lists the catalogue'}"
            raise BadInput("--candidate", wanted, problem, remedy)
    return tuple(one for one in found if looked_for(one.named, only, ()))


def looked_for(named: Named, only: Sequence[str], leave_out: Sequence[str]) -> bool:
    """Whether an effect is one of `only` (families or ids; all where nothing is said), and none of `leave_out`."""
    return (not only or any(_is(named, one) for one in only)) and not any(_is(named, one) for one in leave_out)


def _is(named: Named, name: str) -> bool:
    return named.family == name or named.id == name or named.id.startswith(f"{name}:")


def has_lines(one: Prediction) -> bool:
    """Whether it has lines of a spectrum, which a table of modes has not: a resonator is looked for along them."""
    return len(one.measured.frequency) > 1


def is_resonator(named: Named) -> bool:
    """Whether its frequency must be looked for."""
    return tuple(size.key for size in named.sizes) == RESONATOR


SIZE_OCTAVES = np.arange(-6.0, 4.0, 0.5)
"""[octave] of the prior sd: sizes at which an effect is looked at. Held by test_search.py."""


def sizes(of: Parameter, octaves: Array = SIZE_OCTAVES) -> Array:
    """Offsets of `of` at which an effect is looked at, (n,), none outside its bounds; else half of these.

    Of a logarithm no two neighbours lie farther apart than a factor of two: a bearing of a twelfth of its stiffness moves
    resonances to where one of a seventh or of a fiftieth has none. Of what may break next to nothing is looked at, too.
    """
    steps = of.tolerance * np.exp2(octaves)
    if of.logarithmic and (far := np.diff(steps, prepend=0.0) > log(2)).any():
        near = steps[~far].max(initial=0.0)
        end = max(-of.low, of.high)
        steps = np.append(steps[~far], np.arange(near + log(2), end if tailed(of) else min(steps[-1], end), log(2)))
    both = np.concatenate([-steps[::-1], steps])
    inside = both[(both > of.low) & (both < of.high)]
    return inside if len(inside) else 0.5 * np.array([of.low, of.high])


# Explanations that these data cannot tell apart: those of nearly the same evidence, and those that do the same to every channel.
#
# Evidence is compared between candidates that were fitted. What was not may still be an alias: the columns of J of one effect,
# once the tolerances have taken what they may of it, lie along those of the other. With the Fisher matrix N, what is known
# beforehand in it, and tolerances o projected off,
#
#     S = N_xx - N_xo N_oo^-1 N_ox ,      share = 1 - S_bc S_cc^+ S_cb / S_bb
#
# is what only the first effect b can explain of what it does, whatever the sizes c of the other.


def aliases(best: Candidate, added: Added, candidates: Sequence[Added], *, limit: float) -> dict[str, float]:
    """Ids of those of `candidates` that could stand for `added` of the candidate `best` where its fit ended, with their share.

    Those that act nowhere on the data are left out, and so are those that `best` has, and those with a larger share than `limit`.
    """
    known = {one.named.id for one in best.effects}
    asked = [one for one in candidates if one.named.id not in known]
    problem = with_candidates(best.problem, asked)
    own = {one.name: one.tolerance for one in best.problem.free(FITTED)}
    free = [one for one in problem.parameters if one.name in own or one.kind == EFFECT]
    cost = cost_of(problem, free, FLOOR)
    x = cost.at(best.fit.by_name)
    _, rows = cost.knowledge(x)
    facts = rows[len(rows) - len(problem.facts) :]
    matrix, prior = cost.data(x).matrix + facts.T @ facts, np.array([own.get(one.name, np.inf) for one in free]) ** -2.0
    place = {one.name: k for k, one in enumerate(free)}
    (b, *_) = (place[name] for name in names_of(problem, added.named))
    found = {}
    for one in asked:
        c = [place[name] for name in names_of(problem, one.named) if name in place]
        o = [place[name] for name in own if place[name] not in (b, *c)]
        if c and matrix[c[0], c[0]] > 0:
            found[one.named.id] = share(matrix, prior, b, c, o)
    return {id: size for id, size in sorted(found.items(), key=lambda pair: pair[1]) if size <= limit}


def share(matrix: Array, prior: Array, b: int, c: Sequence[int], o: Sequence[int]) -> float:
    """Share of the square of what parameter `b` does that parameters `c` cannot do once `o` have taken what they may.

    Parameters
    ----------
    matrix : (p, p) Fisher matrix of the data
    prior : (p,) one over the square of what is known of each beforehand, which counts for `o`
    """
    bc = [b, *c]
    root = np.linalg.cholesky(matrix[np.ix_(o, o)] + np.diag(prior[o]))
    through = solve_triangular(root, matrix[np.ix_(o, bc)], lower=True, check_finite=False)
    S = matrix[np.ix_(bc, bc)] - through.T @ through
    scale = np.sqrt(np.maximum(np.diag(S), np.finfo(np.float64).tiny))
    S = S / np.outer(scale, scale)
    return float(np.clip(1 - S[0, 1:] @ np.linalg.pinv(S[1:, 1:], rcond=1e-10, hermitian=True) @ S[1:, 0], 0.0, 1.0))


def with_candidates(problem: Problem, candidates: Sequence[Added]) -> Problem:
    """`problem` with `candidates` on top of the effects of its models."""
    made: list[Prediction] = []
    for one in problem.predictions:
        made.append(one.with_effects((*one.effects, *candidates)) if isinstance(one, StructurePrediction) else one)
    facts: list[Fact] = []
    for fact in problem.facts:
        has = (*fact.of.effects, *fact.effects) if isinstance(fact, ArticleFact) else ()
        facts.append(fact.with_effects((*has, *candidates)) if isinstance(fact, ArticleFact) else fact)
    return replace(problem, predictions=tuple(made), facts=tuple(facts))


# Resonators of every frequency: a dictionary over frequency and damping, by products that one derivative gives.
#
# While its mass m is small, a resonator on a coordinate adds to the dynamic mass, times what a mass held there would add,
#
#     m s(omega) ,        s = (omega_a² + 2 i zeta omega_a omega) / (omega_a² - omega² + 2 i zeta omega_a omega) :
#
# one column does for all frequencies.


DAMPING = (0.005, 0.02, 0.08)
"""[1] Damping ratios of the resonators that are looked up. Set by the development draws of `make blind`."""

BEYOND = 1.15
"""[factor] by which the resonators that are looked up reach beyond the band at either end. Held by test_candidates.py."""

PER_OCTAVE = 24
"""[count] of frequencies in an octave at which a resonator is looked up. Set by the development draws of `make blind`."""

OCCAM = 4.0
"""[nats] that three sizes which are known to a factor cost at least, where the data tell them well. Set by the development draws
of `make blind`, held by test_candidates.py."""


SAME_DIRECTION = 0.02
"""[share] of what a resonator does that the modes of the model must leave to it; below it a straight line is wrong. Set by the
development draws of `make blind`."""


def screened_resonators(data: Study, at: Candidate, menu: Sequence[Added], floor: float = FLOOR) -> list[Screened]:
    """Each resonator of `menu` at its best frequency and damping; `floor` as in a fit. Tables of modes have none."""
    if not menu:
        return []
    whole = data.problem((*at.effects, *menu))
    problem = replace(whole, predictions=tuple(one for one in whole.predictions if has_lines(one)))
    if not problem.predictions:  # a table of modes has none
        return []
    names = {f"{one.named.id}[m]": one for one in menu}
    of = screened(problem, at.fit, [name for name in names if name in problem.by_name], floor=floor)
    low, high = band(one.frequency for one in of.products)
    frequency = np.geomspace(low, high, max(int(PER_OCTAVE * np.log2(high / low)), 2))
    places = [(float(f), zeta) for zeta in DAMPING for f in frequency]
    shapes = {k: np.stack([shape(one.frequency, f, zeta) for f, zeta in places]) for k, one in enumerate(of.products)}
    found = []
    for name, added in names.items():
        if not any(name in one.names for one in of.products):
            continue
        told = of.shapes(name, shapes)
        sound = [one.estimate > 0 and one.share > SAME_DIRECTION for one in told]
        gains = [0.5 * one.estimate**2 * one.information if good else 0.0 for one, good in zip(told, sound, strict=True)]
        best = int(np.argmax(gains))
        f, zeta = places[best]
        mass = max(TINY * told[best].estimate, TINY)  # the offset is that of ln m, at the mass TINY
        named = replace(added.named, values={"m": mass, "f": f, "zeta": zeta})
        usual = int(np.argsort([one.information for one in told])[len(told) // 5])
        found.append(
            Screened(
                added=replace(added, named=named),
                evidence=float(gains[best]) - OCCAM,
                told=told[best],
                plausible=np.inf,
                usual=told[usual],
            )
        )
    return found


def band(frequencies: Iterable[Array]) -> tuple[float, float]:
    """[Hz] Ends of where resonators are looked up."""
    known = tuple(frequencies)
    return min(float(one[0]) for one in known) / BEYOND, max(float(one[-1]) for one in known) * BEYOND


def looked_up(data: Study) -> tuple[float, float]:
    """[Hz] The same of all that `data` have, lines or modes of tables."""
    every = (*data.made, *data.tests)
    return band(np.sort(one.table.frequency) if isinstance(one, TableFrequencies) else one.measured.frequency for one in every)


def shape(frequency: Array, own: float, zeta: float) -> ComplexArray:
    """(m,) The answer of a resonator over that of those of the menu."""
    spring, menu = (f**2 + 2j * ratio * f * frequency for f, ratio in ((own, zeta), (TINY_AT["f"], TINY_AT["zeta"])))
    return np.asarray(spring / (spring - frequency**2) / (menu / (menu - frequency**2)))


# The smallest size at which these data would name each effect: what "nothing is missing" is worth.


USUAL = "four of five frequencies"
"""At which a resonator of that mass would be named; tuned to a resonance of the article, one of a hundredth of it would be."""


@dataclass(frozen=True, eq=False, kw_only=True)
class AnySize:
    """What the data say of a fault of the structure of any size, which no straight line follows far: what a spring holds moves no
    more. The others follow it as of a small one.

    Attributes
    ----------
    told : of a small one
    parameter : of it
    problem : in which it is one
    offsets : of the fit
    tests : what the fit leaves
    """

    told: ScoreTest
    parameter: Parameter
    problem: Problem
    offsets: Offsets
    tests: Sequence[Swallowing]

    @classmethod
    def of(cls, there: Candidate, added: Added) -> "AnySize | None":
        """Of an effect of `there`, from where its fit ended, of a resonator of a table its mass; None of one that a straight line
        follows."""
        if added.fixed or not (added.named.family in SPRINGS or is_resonator(added.named)):
            return None
        if is_resonator(added.named) and any(map(has_lines, there.problem.predictions)):
            return None
        name = next(iter(names_of(there.problem, added.named)), "")
        if name not in (known := in_the_fit(there.fit)):
            return None
        parameter = next(one for one in there.fit.parameters if one.name == name)
        offsets = {**there.problem.start, **there.fit.by_name}
        return cls(told=known[name], parameter=parameter, problem=there.problem, offsets=offsets, tests=swallowing(there))

    def _read(self, offset: float) -> tuple[Array, Answers]:
        """Slope, and how all data sets answer to a size that is `offset` away, both but for itself."""
        by_name = {one.measured.name: one for one in self.problem.predictions}
        there = {**self.offsets, self.told.name: self.offsets.get(self.told.name, 0.0) + offset}
        moved = [one for one in self.tests if any(of.name == self.told.name for of in by_name[one.of.name].parameters)]
        made = ((one, by_name[one.of.name].at(there, one.of.lines, derivatives=False)) for one in moved or self.tests)
        told = [one.answers(one.beyond(read.rows)[None]) for one, read in made]
        slope, swallowed = self.tests[0].slope, np.sum([one.swallowed[0] for one in told], axis=0)
        for own in [one.root[one.names.index(self.told.name)] for one in self.tests if self.told.name in one.names][:1]:
            slope, swallowed = (each - own * float(own @ each) / float(own @ own) for each in (slope, swallowed))
        score, own = (np.sum([getattr(one, what) for one in told]) for what in ("score", "own"))
        return slope, Answers(score=score, own=own, swallowed=swallowed)

    def at(self, offset: float) -> ScoreTest:
        """What they say of a size of `offset`."""
        _, of = self._read(offset)
        return replace(self.told, information=max(float(of.own - of.swallowed @ of.swallowed), 0.0) / offset**2)

    def interval(self) -> tuple[float, float, float]:
        """The offset that the data alone say, and the ends of its interval of 90 %: bounds where no data end it."""
        from scipy.optimize import brentq

        here, low, high = self.offsets[self.told.name], self.parameter.low, self.parameter.high
        sizes = here + OCTAVES * log(2) if self.parameter.logarithmic else here * np.exp2(OCTAVES)
        every = np.unique(np.clip([*sizes, self.told.estimate], low, high))
        gains = [self._gained(x - here) for x in every]
        best = int(np.argmax(gains))
        least = gains[best] - 0.5 * NORMAL_90**2

        def end(beyond: Sequence[int], bound: float) -> float:
            k = next((k for k in beyond if gains[k] < least), None)
            if k is None:
                return bound
            return float(brentq(lambda x: max(self._gained(x - here), least - 9.0) - least, every[best], every[k], rtol=1e-3))

        return float(every[best]), end(range(best - 1, -1, -1), low), end(range(best + 1, len(every)), high)

    def _gained(self, offset: float) -> float:
        """[nats] By the data alone, of a size that is `offset` away."""
        try:
            slope, answers = self._read(offset)
        except BREAKDOWNS:
            return -np.inf
        return float(gain([answers], slope))

    def detectable(self, plausible: float, evidence: float, side: int = 1) -> float:
        """As `ScoreTest.detectable`, of the size that it tells, to that `side`; infinite where none that is allowed does."""
        bound = min(side * (self.parameter.high if side > 0 else self.parameter.low), 1 / KNOWN)
        low = high = self.told.detectable(plausible, evidence)

        def named(offset: float) -> bool:
            try:
                return offset >= self.at(side * offset).detectable(plausible, evidence)
            except BREAKDOWNS:
                return False

        while high < bound and not named(high):
            low, high = high, GROWS * high
        if not high < bound:
            return np.inf
        while high > (1 + NEAR) * low:
            middle = sqrt(low * high)
            low, high = (low, middle) if named(middle) else (middle, high)
        return high


OCTAVES = np.arange(-8.0, 9.0)
"""[octave] Sizes about that of a fit between which an interval ends; beyond nothing ends it. Exercised by test_candidates.py."""

GROWS = 4.0
"""[factor] By which a size grows that is not told yet. By definition."""

NEAR = 0.05
"""[share] to which the smallest size is looked for. Held by test_candidates.py."""

ABOVE, BELOW = "factors above 1", "factors below 1"
"""At which alone a factor would be named: what is all but rigid cannot be stiffer."""

SPRINGS = ("cable", "support-stiffness", "connection-compliance", "joint-compliance")
"""Families of which more and more comes to the same: what a spring holds, or no longer holds, moves no more."""

LOSSES = ("structural-damping", "layer-damping")
"""Families of what may be many times as large as what modes lose, of which all that is known multiplies."""


def detectable(screened: Sequence[Screened]) -> tuple[Detectable, ...]:
    """Of every candidate that the data tell at all; switches have no size."""
    found = []
    for one in screened:
        size, wanted = (*one.added.named.sizes, None)[0], effect.evidence_threshold(one.added.named.family)
        if size is None or all(each.whole for each in one.added.named.sizes):
            continue
        if one.usual is not None:
            away, at = TINY * (sqrt(2 * (wanted + OCCAM)) + POWER) * one.usual.deviation, USUAL
        else:
            away, at = (one.any_size or one.told).detectable(one.plausible, wanted), ""
            if isinstance(one.any_size, AnySize) and one.parameter is not None and one.parameter.logarithmic:
                less = one.any_size.detectable(one.plausible, wanted, -1)
                at = ABOVE if away < less == inf else BELOW if less < away == inf else ""
                away = {ABOVE: away, BELOW: -less}.get(at, max(away, less))
            if one.parameter is not None and isfinite(away):
                try:
                    away = one.parameter.value(away) - one.parameter.value(0.0)
                except OverflowError:  # more than a number holds
                    away = inf
        if isfinite(away):
            found.append(Detectable(id=one.id, size=abs(away), unit=size.unit, at=at))
    return tuple(found)


# All candidates at once, in closed form: what evidence each would bring and of what size, as far as a straight line goes.


SWITCHED = 1.0
"""[1] Offset of a switch from on to off. By definition."""


TOGETHER = 512
"""[count] of candidates that are screened at a time: products of columns cost the square of their number, and each resonator is a
coordinate of the matrices more, which cost the cube. Held by test_candidates.py."""


def screen(data: Study, at: Candidate, menu: Sequence[Added]) -> tuple[Screened, ...]:
    """The candidates of `menu` on top of the candidate `at`, the most promising first."""
    if len(menu) > TOGETHER:
        groups = (menu[k : k + TOGETHER] for k in range(0, len(menu), TOGETHER))
        return tuple(sorted((one for group in groups for one in screen(data, at, group)), key=lambda one: -one.evidence))
    known = {one.named.id for one in at.effects}
    left = [one for one in menu if one.named.id not in known]
    tolerances = in_the_fit(at.fit)
    inside = [one for one in left if one.named.id in tolerances]
    resonators = [one for one in left if is_resonator(one.named)]
    of_periods = [one for one in left if FAMILIES[one.named.family].stage == effect.PERIOD_STAGE]
    new = [one for one in left if one not in inside and one not in resonators and one not in of_periods]
    found, offsets, tests = [], {**at.problem.start, **at.fit.by_name}, swallowing(at)

    def of_spring(one: Screened) -> Screened:
        if one.added.named.family not in SPRINGS or one.parameter is None:
            return one
        problem = data.problem((*at.effects, replace(one.added, fixed=False)))
        whole = AnySize(told=one.told, parameter=one.parameter, problem=problem, offsets=offsets, tests=tests)
        return replace(one, any_size=whole)

    for one in inside:
        told = tolerances[one.named.id]
        (size,) = one.named.sizes
        sized = _sized(one, size, next(each for each in at.fit.parameters if each.name == told.name), told)
        found.append(of_spring(sized))
    if new:
        firsts = {one.named.id: (*one.named.fitted_sizes, one.named.sizes[0])[0] for one in new if one.named.sizes}
        names = {one.named.id: effects.name(one.named, firsts[one.named.id].key) for one in new if one.named.sizes}
        problem = data.problem((*at.effects, *(replace(one, fixed=False) for one in new)))
        columns = screened(problem, at.fit, [name for name in names.values() if name in problem.by_name], by_line=False)
        scores = columns.told()
        for one in new:
            if (which := names.get(one.named.id, "")) in scores:
                sized = _sized(one, firsts[one.named.id], problem.by_name[which], scores[which])
                lost = MadeUp.of(columns, scores[which]) if one.named.family in LOSSES else None
                found.append(of_spring(replace(sized, any_size=lost)))
    found += screened_resonators(data, at, resonators)
    # Of effects on a period no straight line tells, and no smallest size by one
    for added, swings in pendulum.told(data, at, of_periods) if of_periods else ():
        told = ScoreTest(name=added.named.id, estimate=swings.value, information=0.0)
        found.append(Screened(added=added, evidence=swings.evidence, told=told, plausible=added.named.sizes[0].plausible))
    return tuple(sorted(found, key=lambda one: -one.evidence))


def _sized(added: Added, size: effect.SizeSpec, one: Parameter, told: ScoreTest) -> Screened:
    """`added` at the size that `told` says, within what its family allows."""
    low, high = effects.bounds(one, size)
    if size.whole:
        offset, plausible = (SWITCHED if one.nominal == 0 else -SWITCHED), SWITCHED
    else:
        offset, plausible = float(np.clip(told.estimate, low, high)), one.tolerance if one.kind == EFFECT else size.plausible
    if not size.whole and low < told.estimate < high:
        evidence = told.evidence(plausible)
    else:  # it can only be `offset`: a switch, or the bound of what its family allows; 0 where that is none
        evidence = told.information * (told.estimate * offset - 0.5 * offset**2)
    values = {**added.named.values, size.key: min(max(one.value(offset), size.low), size.high)}
    return Screened(
        added=replace(added, named=replace(added.named, values=values)),
        evidence=evidence,
        told=told,
        plausible=plausible,
        parameter=None if size.whole else one,
    )
