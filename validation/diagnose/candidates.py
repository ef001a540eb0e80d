"""The candidates: every effect of the catalogue that could act on these data, at the size at which it does nothing.

A resonator has no such size in its logarithm: it stands at next to nothing, at a frequency that `dictionary` moves.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import product
from math import inf, isfinite, sqrt

import numpy as np
from scipy.linalg import solve_triangular

from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array
from geometry.toml_file import nearest
from validation.diagnose import pendulum
from validation.diagnose.diagnosis import Candidate, Detectable, Screened
from validation.diagnose.pendulum import of_swings
from validation.effects.catalogue import FAMILIES, Named, There, acts
from validation.effects.effect import (
    ACCELERATIONS,
    BODY_STAGE,
    CHANNEL_STAGE,
    FORCES,
    INDISTINGUISHABLE_NATS,
    OPENED,
    PERIOD_STAGE,
    STRUCTURE,
    STRUCTURE_STAGE,
    Family,
    SizeSpec,
    Vocabulary,
    evidence_threshold,
)
from validation.estimation.cost import cost_of
from validation.estimation.fit import FLOOR
from validation.estimation.problem import EFFECT, FITTED, Fact, Parameter, Prediction, Problem
from validation.estimation.screening import ScoreTest, Screen, in_the_fit, screened
from validation.history.add import names_of
from validation.model.model import Added, vocabulary
from validation.prediction import effects
from validation.prediction.classical_facts import ArticleFact
from validation.prediction.series import SeriesPrediction
from validation.study import Study

SIDES = (STRUCTURE, FORCES, ACCELERATIONS)
"""What one level of a linear test shows; mistakes and what depends on the level are tested before."""

SHOWN = (STRUCTURE_STAGE, BODY_STAGE, CHANNEL_STAGE, OPENED)

RESONATOR = ("m", "f", "zeta")
"""Keys of the sizes of a resonator."""

TINY = 1e-6
"""[kg] Mass of a resonator that does next to nothing; a step of its logarithm is then linear. Set by the development draws of
`make blind`, exercised by tests/validation/diagnosing/test_dictionary.py."""

TINY_AT = {"m": TINY, "f": 1000.0, "zeta": 0.02}


def candidates(data: Study, *, only: Sequence[str] = (), leave_out: Sequence[str] = ()) -> tuple[Added, ...]:
    """What could be missing from the model of `data`.

    Parameters
    ----------
    only : families or ids that are looked for; all where nothing is said
    leave_out : families or ids that are not

    Raises
    ------
    BadInput : one of `only` is no effect that could act on these data and be told by them.
    """
    found = tuple(one for one in _possible(data) if not _is_one_of(one.named, leave_out))
    for wanted in only:
        if not any(_is(one.named, wanted) for one in found):
            known = dict.fromkeys(name for one in found for name in (one.named.family, one.named.id))
            problem = "is no effect that could act on these data and be told by them"
            remedy = f"{nearest(wanted, known)}`massline effects` lists the catalogue"
            raise BadInput(source="--candidate", field=wanted, problem=problem, remedy=remedy)
    return tuple(one for one in found if not only or _is_one_of(one.named, only))


def looked_for(named: Named, only: Sequence[str], leave_out: Sequence[str]) -> bool:
    """Whether an effect is one of `only` (families or ids; all where nothing is said), and none of `leave_out`."""
    return (not only or _is_one_of(named, only)) and not _is_one_of(named, leave_out)


def _is_one_of(named: Named, names: Sequence[str]) -> bool:
    return any(_is(named, name) for name in names)


def _is(named: Named, name: str) -> bool:
    return named.family == name or named.id == name or named.id.startswith(f"{name}:")


def is_resonator(named: Named) -> bool:
    """Whether its frequency must be looked for."""
    return tuple(size.key for size in named.sizes) == RESONATOR


def _possible(data: Study) -> Iterator[Added]:
    there, words = tuple(_structures(data)), vocabulary(data.model, data.campaigns)
    known = {one.named.id for one in data.model.effects}
    families = [one for one in FAMILIES.values() if one.side in SIDES and one.stage in SHOWN]
    every = [named for family in families for named in _at_every_target(family, words) if named.id not in known]
    found = [Added(named=one, fixed=_is_switch(one)) for one in every if any(acts(one, place) for place in there)]
    # Parameters that effects without an equation would open; a chain makes them when they are asked for
    asking = tuple(replace(one, fixed=False) for one in found if not _has_equation(one))
    opened = {one.name for made in data.made for one in made.with_effects((*data.model.effects, *asking)).parameters}
    yield from (one for one in found if _has_equation(one) or one.named.id in opened)
    yield from (one for one in of_swings(data) if one.named.id not in known)


def _structures(data: Study) -> Iterator[There]:
    for one in data.made:
        there = one.tested.carried.standing.there
        yield There(article=there.article, parts=there.parts, places=there.places, channels=one.measured.channels)


def _at_every_target(family: Family, words: Vocabulary) -> Iterator[Named]:
    for targets in product(*(words.legal(kind) or () for kind in family.targets)):
        sizes = family.sizes_at(targets)
        if tuple(size.key for size in sizes) == RESONATOR:
            at_nothing = Named(family=family.name, targets=targets, values=TINY_AT)
        else:
            values = {}
            for size in sizes:
                values[size.key] = size.null if size.plausible > 0 or size.default is None else size.default
            at_nothing = Named(family=family.name, targets=targets, values=values)
        yield at_nothing


def _has_equation(added: Added) -> bool:
    return FAMILIES[added.named.family].stage != OPENED


def _is_switch(named: Named) -> bool:
    return bool(named.sizes) and all(size.whole for size in named.sizes)


# Explanations that these data cannot tell apart: those of nearly the same evidence, and those that do the same to every channel.
#
# Evidence is compared between candidates that were fitted. What was not may still be an alias: the columns of J of one effect,
# once the tolerances have taken what they may of it, lie along those of the other. With the Fisher matrix N, what is known
# beforehand in it, and tolerances o projected off,
#
#     S = N_xx - N_xo N_oo^-1 N_ox ,      share = 1 - S_bc S_cc^+ S_cb / S_bb
#
# is what only the first effect b can explain of what it does, whatever the sizes c of the other.


ALIAS_SHARE = 1e-3
"""[share] of the square of what an effect does that its alias must leave to it at most. Set by the development draws of `make
blind`."""


def alike(best: Candidate, others: Sequence[Candidate]) -> tuple[str, ...]:
    """Ids of what explains the data about as well as `best`, its own first; of several effects those that not all have."""
    near = [one for one in others if best.fit.log_evidence - one.fit.log_evidence < INDISTINGUISHABLE_NATS]
    ranked = (best, *sorted(near, key=lambda one: -one.fit.log_evidence))
    common = set.intersection(*({one.named.id for one in each.effects} for each in (best, *others))) if others else set()
    return tuple(dict.fromkeys(one.named.id for each in ranked for one in each.effects if one.named.id not in common))


def aliases(best: Candidate, effect: Added, candidates: Sequence[Added], *, limit: float = ALIAS_SHARE) -> dict[str, float]:
    """Ids of those of `candidates` that could stand for `effect` of the candidate `best` where its fit ended, with their share.

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
    (b, *_) = (place[name] for name in names_of(problem, effect.named))
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
        made.append(one.with_effects((*one.effects, *candidates)) if isinstance(one, SeriesPrediction) else one)
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
"""[factor] by which the resonators that are looked up reach beyond the band at either end. Held by
tests/validation/diagnosing/test_dictionary.py."""

PER_OCTAVE = 24
"""[count] of frequencies in an octave at which a resonator is looked up. Set by the development draws of `make blind`."""

OCCAM = 4.0
"""[nats] that three sizes which are known to a factor cost at least, where the data tell them well. Set by the development draws
of `make blind`, exercised by tests/validation/diagnosing/test_dictionary.py."""


SAME_DIRECTION = 0.02
"""[share] of what a resonator does that the modes of the model must leave to it; below it a straight line is wrong. Set by the
development draws of `make blind`."""


def screened_resonators(data: Study, at: Candidate, menu: Sequence[Added]) -> list[Screened]:
    """Each resonator of `menu` at its best frequency and damping."""
    problem = data.problem((*at.effects, *menu))
    names = {f"{one.named.id}[m]": one for one in menu}
    of = screened(problem, at.fit, [name for name in names if name in problem.by_name])
    low, high = _band(one.frequency for one in of.products)
    frequency = np.geomspace(low, high, max(int(PER_OCTAVE * np.log2(high / low)), 2))
    places = [(float(f), zeta) for zeta in DAMPING for f in frequency]
    by_set = {k: np.stack([_shape(one.frequency, f, zeta) for f, zeta in places]) for k, one in enumerate(of.products)}
    return [found for name, one in names.items() if (found := _best(of, name, one, places, by_set)) is not None]


def smallest_mass(told: ScoreTest, evidence: float) -> float:
    """[kg] whose expected evidence is `evidence` [nats], by what the data tell of next to none; infinite for nothing."""
    return TINY * sqrt(2 * (evidence + OCCAM)) * told.deviation


def reaches(data: Study, named: Named) -> bool:
    """Whether `named` resonates where the data of `data` are; far below them it is a spring to the ground, far above a mass."""
    low, high = _band(one.measured.frequency for one in data.made)
    return low <= named.values["f"] <= high


def _best(
    of: Screen, name: str, added: Added, places: Sequence[tuple[float, float]], shapes: dict[int, ComplexArray]
) -> Screened | None:
    if not any(name in one.names for one in of.products):
        return None
    told = of.shapes(name, shapes)
    sound = [one.estimate > 0 and one.share > SAME_DIRECTION for one in told]
    gains = np.array([0.5 * one.estimate**2 * one.information if good else 0.0 for one, good in zip(told, sound, strict=True)])
    best = int(np.argmax(gains))
    f, zeta = places[best]
    mass = max(TINY * told[best].estimate, TINY)  # the offset is that of ln m, at the mass TINY
    named = replace(added.named, values={"m": mass, "f": f, "zeta": zeta})
    usual = int(np.argsort([one.information for one in told])[len(told) // 2])
    return Screened(
        added=replace(added, named=named),
        evidence=float(gains[best]) - OCCAM,
        told=told[best],
        plausible=np.inf,
        usual=told[usual],
    )


def _band(frequencies: Iterable[Array]) -> tuple[float, float]:
    known = tuple(frequencies)
    return min(float(one[0]) for one in known) / BEYOND, max(float(one[-1]) for one in known) * BEYOND


def _resonance(frequency: Array, own: float, zeta: float) -> ComplexArray:
    spring = own**2 + 2j * zeta * own * frequency
    return np.asarray(spring / (spring - frequency**2))


def _shape(frequency: Array, own: float, zeta: float) -> ComplexArray:
    """The answer of a resonator over that of those of the menu, (m,)."""
    return np.asarray(_resonance(frequency, own, zeta) / _resonance(frequency, TINY_AT["f"], TINY_AT["zeta"]))


# The smallest size at which these data would name each effect: what "nothing is missing" is worth.


USUAL = "half of all frequencies"
"""At which a resonator of that mass would be named; tuned to a resonance of the article, one of a hundredth of it would be."""


def detectable(screened: Sequence[Screened]) -> tuple[Detectable, ...]:
    """Of every candidate that the data tell at all; switches have no size."""
    found = (_detectable(one) for one in screened if not all(size.whole for size in one.added.named.sizes))
    return tuple(one for one in found if isfinite(one.size))


def _detectable(one: Screened) -> Detectable:
    size, wanted = one.added.named.sizes[0], evidence_threshold(one.added.named.family)
    if one.usual is not None:
        return Detectable(id=one.id, size=smallest_mass(one.usual, wanted), unit=size.unit, at=USUAL)
    return Detectable(id=one.id, size=_size_at(one, one.told.detectable(one.plausible, wanted)), unit=size.unit)


def _size_at(one: Screened, offset: float) -> float:
    """How far from no effect the size is at `offset`; infinite where that is more than a number holds."""
    if one.parameter is None or not isfinite(offset):
        return offset
    try:
        return one.parameter.value(offset) - one.parameter.value(0.0)
    except OverflowError:
        return inf


# All candidates at once, in closed form: what evidence each would bring and of what size, as far as a straight line goes.


SWITCHED = 1.0
"""[1] Offset of a switch from on to off. By definition."""


def screen(data: Study, at: Candidate, menu: Sequence[Added]) -> tuple[Screened, ...]:
    """The candidates of `menu` on top of the candidate `at`, the most promising first."""
    known = {one.named.id for one in at.effects}
    left = [one for one in menu if one.named.id not in known]
    tolerances = in_the_fit(at.fit)
    inside = [one for one in left if one.named.id in tolerances]
    resonators = [one for one in left if is_resonator(one.named)]
    of_periods = [one for one in left if FAMILIES[one.named.family].stage == PERIOD_STAGE]
    new = [one for one in left if one not in inside and one not in resonators and one not in of_periods]
    found = [_screened_tolerance(one, tolerances[one.named.id], at) for one in inside]
    found += _screened_effects(data, at, new) if new else []
    found += screened_resonators(data, at, resonators) if resonators else []
    found += _screened_periods(data, at, of_periods) if of_periods else []
    return tuple(sorted(found, key=lambda one: -one.evidence))


def _screened_periods(data: Study, at: Candidate, menu: Sequence[Added]) -> list[Screened]:
    """Of effects on a period no straight line tells, and no smallest size by one."""
    return [
        Screened(
            added=added,
            evidence=found.evidence,
            told=ScoreTest(name=added.named.id, estimate=found.value, information=0.0),
            plausible=added.named.sizes[0].plausible,
        )
        for added, found in pendulum.told(data, at, menu)
    ]


def _screened_tolerance(added: Added, told: ScoreTest, at: Candidate) -> Screened:
    (size,) = added.named.sizes
    one = next(one for one in at.fit.parameters if one.name == told.name)
    return _sized(added, size, one, told)


def _screened_effects(data: Study, at: Candidate, menu: Sequence[Added]) -> list[Screened]:
    free = [replace(one, fixed=False) for one in menu]
    problem = data.problem((*at.effects, *free))
    sized = {one.named.id: effects.name(one.named, _first(one).key) for one in free if one.named.sizes}
    of = screened(problem, at.fit, [which for which in sized.values() if which in problem.by_name], by_line=False)
    told = of.told()
    there = [(one, which) for one in menu if (which := sized.get(one.named.id, "")) in told]
    return [_sized(one, _first(one), problem.by_name[which], told[which]) for one, which in there]


def _first(added: Added) -> SizeSpec:
    """The size by which an effect of several is screened: the first that is fitted."""
    return (*added.named.fitted_sizes, added.named.sizes[0])[0]


def _sized(added: Added, size: SizeSpec, one: Parameter, told: ScoreTest) -> Screened:
    """`added` at the size that `told` says, within what its family allows."""
    low, high = effects.bounds(one, size)
    if size.whole:
        offset = SWITCHED if one.nominal == 0 else -SWITCHED
        return Screened(
            added=_with_size(added, size, one.value(offset)), evidence=_at_size(told, offset), told=told, plausible=SWITCHED
        )
    offset = float(np.clip(told.estimate, low, high))
    evidence = told.evidence(size.plausible) if low < told.estimate < high else _at_size(told, offset)
    return Screened(
        added=_with_size(added, size, one.value(offset)), evidence=evidence, told=told, plausible=size.plausible, parameter=one
    )


def _at_size(told: ScoreTest, offset: float) -> float:
    """[nats] of an effect that can only be `offset`: a switch, or the bound of what its family allows; 0 where that is none."""
    return told.information * (told.estimate * offset - 0.5 * offset**2)


def _with_size(added: Added, size: SizeSpec, value: float) -> Added:
    values = {**added.named.values, size.key: min(max(value, size.low), size.high)}
    return replace(added, named=replace(added.named, values=values))
