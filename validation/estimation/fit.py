"""The fits: from far away to the minimum of misfit and of what is known beforehand, and the guard that makes children comparable.

The model-error floor is annealed: at 20 % the likelihood is so coarse that its minimum is found from afar, at 0.15 % it is sharp.
Tolerances of the measurement, hundreds of them and stiff, are released when the few that matter are near. Every stage is
Levenberg-Marquardt with the priors as part of it (`identification.self_calibration.solve`).

A fit that begins nowhere converges or is refused: an unconverged baseline makes any further parameter look decisive. A fit that
begins at a parent's solution keeps that where it finds nothing better, and so never costs more. "What bit" of the catalogue.

Where chance explains all that is left (`Fit.sound`) no other valley is looked for: the short way ends there, within `CLOSE`
standard deviations of the minimum that the long way finds.
"""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from math import inf

import numpy as np
import numpy.typing as npt

from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array
from geometry.toml_file import nearest
from identification.self_calibration.solve import CLOSE, HOPE, MOST, Normal, Solution, inverse, minimise
from validation.estimation.likelihood import Cost, cost_of, log_evidence
from validation.estimation.problem import (
    DECLARED,
    PLAIN,
    SENSOR,
    STRUCTURAL,
    TOLERANCES,
    Fit,
    Offsets,
    Parameter,
    Problem,
    by_chance,
)

# The way down: stages of an annealed floor, all of them within the bounds of the parameters, and where it ended.

COARSE = (0.2, 0.06)
"""[share] Model-error floors of the stages before tolerances of the measurement are released. Held by engine/test_fit.py."""

FINE = (0.02, 0.006, 0.003)
"""[share] Model-error floors of the stages after that, before the last. Exercised by engine/test_fit.py."""

ROUGHLY = 1.0
"""[sd] that the last step of a stage may be which is not the last. Exercised by engine/test_fit.py."""

STEPS = 6
"""[count] of evaluations that such a stage takes where nothing better is known to come of it. Held by engine/test_fit.py."""

LOOKED_AT = 32
"""[count] of draws from the priors of stiffnesses at which a baseline looks where to begin. Held by engine/test_fit.py."""

STIFFNESSES = ("modulus", "support-stiffness", "thickness")
"""Families of what is declared that moves resonances by many of their widths. By definition."""

BEGUN = 3
"""[count] of the cheapest of these from which its first stage begins as well. Held by engine/test_fit.py."""

STRIDE = 3
"""[count] Every third line is taken by such a stage, where that leaves enough: its minimum need not be sharp. Held by
engine/test_fit.py."""

RESTARTS = 6
"""[count] of times that a descent which did not end by itself begins again where it stopped. Exercised by engine/test_fit.py."""

RESTART_GAIN = 1.0
"""[nats] that each of these must gain to go on. Exercised by engine/test_fit.py."""

ROUNDING = 1e-9
"""[sd] from a bound that are none. Exercised by engine/test_fit.py."""

BREAKDOWNS = (np.linalg.LinAlgError, ValueError, FloatingPointError)
"""What a prediction raises where its model breaks down."""

Progress = Callable[[float], None]


@dataclass(frozen=True, eq=False, kw_only=True)
class End:
    """Where a way ended.

    Attributes
    ----------
    cost : that was made small, with what is held at a bound
    x : (p,) of its free parameters
    whole, data : normal equations there, with knowledge beforehand and without
    chi2 : of data and facts
    converged : whether the iteration ended by itself
    """

    cost: Cost
    x: Array
    whole: Normal
    data: Normal
    chi2: float
    converged: bool

    @property
    def offsets(self) -> dict[str, float]:
        """Of all parameters of the problem."""
        return self.cost.offsets(self.x)


def ended(cost: Cost, offsets: Offsets, *, converged: bool, data: Normal | None = None) -> End:
    """The point `offsets` as an end; `data` are the normal equations there, where they are known."""
    x = cost.at(offsets)
    whole, data = cost.total(x, data)
    return End(cost=cost, x=x, whole=whole, data=data, chi2=cost.chi2(x, data), converged=converged)


def annealed(
    cost: Cost,
    offsets: Offsets,
    progress: Progress,
    *,
    most: int = MOST,
    steps: int = STEPS,
    again: int = RESTARTS,
    everywhere: bool = False,
    near: End | None = None,
) -> End:
    """From `offsets` through floors that fall to that of `cost`; tolerances of the measurement are released half-way.

    At the last floor it takes at most `most` evaluations before it begins again, at most `again` times, see `direct`; not at all
    where chance will not explain what is left even over the coarsest floor: such valleys have no end. Fewer lines over a coarser
    floor cost less: once all moves that does, the first stage that cannot come below what is worth it is the end.

    Parameters
    ----------
    steps : evaluations that a stage may take which is not the last, the first twice as many where it begins several times
    everywhere : whether the first stage begins at other stiffnesses as well, and the way goes on from its cheapest end: of modes
        that lie closer than their parts are known, one takes the place of another, and no step leads back from there
    near : where the short way from `offsets` ended, to which all further stages lead if none of the others ends lower

    Raises
    ------
    CheckFailed : the model breaks down where it begins.
    """
    found, sparse = dict(offsets), cost.problem.sparser(STRIDE)
    stages = [(floor, False) for floor in COARSE if floor > cost.floor] + [(floor, True) for floor in FINE if floor > cost.floor]
    for done, (floor, everything) in enumerate(stages):
        moving = tuple(one for one in cost.free if everything or one.kind not in (SENSOR, STRUCTURAL))
        stage = replace(cost, problem=sparse, observed=(), free=moving, floor=floor, base={**cost.base, **found})
        stage = replace(stage, worth=cost.worth if everything else inf)
        others = _elsewhere(stage, found) if everywhere and not done else []
        within = 2 * steps if others else steps
        ends = [descent(stage, found, close=ROUGHLY, most=within)]
        for begin in others:
            with suppress(CheckFailed):
                ends.append(descent(stage, begin, close=ROUGHLY, most=within))
        best = min(ends, key=lambda end: end.normal.cost)
        if near is not None and ends[0].normal.cost < best.normal.cost + RESTART_GAIN:
            return near
        found, near = found | stage.offsets(best.seen), None
        if best.beyond_hope(stage.worth):
            return ended(cost, found, converged=False)
        if not done and not by_chance(stage.chi2(best.seen, best.data) - HOPE * best.decrement**2, stage.size(best.seen)):
            again = 0
        progress((done + 1) / (len(stages) + 2))
    return direct(cost, found, progress, most=most, again=again)


def short(cost: Cost, offsets: Offsets, progress: Progress) -> End | None:
    """Where the way straight from `offsets` ends: what matters first, all on few lines, all on all. None unless chance explains
    what is left of the data: a misfit is seen on few lines, before anything dear is done."""
    rough = tuple(one for one in cost.free if one.kind not in (SENSOR, STRUCTURAL))
    found, sparse = dict(offsets), cost.problem.sparser(STRIDE)
    try:
        for free, floor in ((rough, FINE[0]), (cost.free, cost.floor)):
            stage = replace(cost, problem=sparse, observed=(), free=free, floor=floor, base={**cost.base, **found})
            last = descent(stage, found, close=ROUGHLY, most=STEPS)
            found |= stage.offsets(last.seen)
        if by_chance(stage.chi2(last.seen, last.data), stage.size(last.seen)):
            end = direct(cost, found, progress, again=0)
            return end if end.converged and by_chance(end.chi2, end.cost.size(end.x)) else None
    except CheckFailed:
        pass
    return None


def _elsewhere(cost: Cost, offsets: Offsets) -> list[dict[str, float]]:
    """`offsets` with other stiffnesses: of draws from what is known of them beforehand the cheapest."""
    stiff = [one for one in cost.free if one.kind == DECLARED and one.family in STIFFNESSES]
    draws = np.random.default_rng(0).standard_normal((LOOKED_AT if stiff else 0, len(stiff)))
    found: list[tuple[float, dict[str, float]]] = []
    for draw in draws * [one.tolerance for one in stiff]:
        there = {**offsets, **{one.name: float(np.clip(x, one.low, one.high)) for one, x in zip(stiff, draw, strict=True)}}
        still = replace(cost, free=(), base={**cost.base, **there})
        with suppress(*BREAKDOWNS):
            found.append((still.data(np.zeros(0)).cost, there))
    return [there for _, there in sorted(found, key=lambda one: one[0])[:BEGUN]]


def direct(
    cost: Cost, offsets: Offsets, progress: Progress, *, close: float = CLOSE, most: int = MOST, again: int = RESTARTS
) -> End:
    """From `offsets` straight down, and once more from where that ended while it does not end by itself but still gains.

    A whole beginning that gains next to nothing ends it, too. How far the quadratic model would still like to go is not asked:
    where the data do not fit, its second derivatives lack what the misfit adds, it points along a valley for ever, or past a
    bound of what a model declares. Nor does it begin again where all times that are left, each gaining as much as the last, would
    not bring it below what is worth it.

    Parameters
    ----------
    close : [sd] that the last step may be, as in `minimise`
    most : evaluations before it begins again
    again : times that it may

    Raises
    ------
    CheckFailed : the model breaks down where it begins.
    """
    solution = descent(cost, offsets, close=close, most=most)
    converged, hopeless = solution.converged, solution.beyond_hope(cost.worth)
    for left in reversed(range(again)):
        if converged or hopeless:
            break
        before, solution = solution, descent(cost, cost.offsets(solution.seen), close=close, most=most)
        gained = before.normal.cost - solution.normal.cost
        idle, hopeless = gained < RESTART_GAIN, solution.normal.cost - left * gained > cost.worth
        converged = solution.converged or (idle and solution.evaluations >= most)
        if idle:
            break
    progress(0.95)
    seen = at_its_bounds(cost, cost.offsets(solution.seen), converged=converged, data=solution.data)
    if np.array_equal(solution.x, solution.seen):
        return seen
    try:
        last = at_its_bounds(cost, cost.offsets(solution.x), converged=converged)
    except BREAKDOWNS:  # the last step was taken unseen
        return seen
    return min(last, seen, key=lambda end: end.whole.cost)  # nor need it go down where the valley bends


def at_its_bounds(cost: Cost, offsets: Offsets, *, converged: bool, data: Normal | None = None) -> End:
    """The point `offsets` as an end, what stands at a bound there held.

    Parameters
    ----------
    data : normal equations of the data there in all free parameters of `cost`, where they are known
    """
    left = at_bounds(cost, offsets)
    free = np.array([one.name in left.names for one in cost.free], dtype=bool)
    if data is not None:
        data = Normal(cost=data.cost, gradient=data.gradient[free], matrix=data.matrix[np.ix_(free, free)])
    return ended(left, offsets, converged=converged, data=data)


def at_bounds(cost: Cost, offsets: Offsets) -> Cost:
    """`cost` with what stands at a bound at `offsets` held there.

    A tolerance that stands where physics ends is no surer for that: it counts as free, lest a model gain evidence by it.
    """
    low, high = cost.bounds
    if not cost.plain:
        ends = np.array([one.kind in TOLERANCES for one in cost.free], dtype=bool)
        low, high = np.where(ends, -inf, low), np.where(ends, inf, high)
    x = cost.at(offsets)
    near = ROUNDING * np.array([one.tolerance if np.isfinite(one.tolerance) else 1.0 for one in cost.free])
    at = np.where(x <= low + near, low, np.where(x >= high - near, high, np.nan))
    held = {name: float(bound) for name, bound in zip(cost.names, at, strict=True) if np.isfinite(bound)}
    return cost.holding({**{one.name: cost.base[one.name] for one in cost.held}, **held})


def descent(cost: Cost, offsets: Offsets, *, close: float = CLOSE, most: int) -> Solution:
    """From `offsets` down, `most` evaluations at most.

    Raises
    ------
    CheckFailed : the model breaks down where it begins.
    """
    start = np.clip(cost.at(offsets), *cost.bounds)
    if not len(start):
        whole, data = cost.total(start)
        return Solution(x=start, seen=start, normal=whole, data=data, converged=True, decrement=0.0, evaluations=1)
    try:
        size, bounds, of = cost.size(start), cost.bounds, (cost.data, start, cost.knowledge)
        return minimise(*of, close=close, most=most, size=size, bounds=bounds, cost=cost.misfit, worth=cost.worth)
    except BREAKDOWNS as error:
        raise CheckFailed(f"the model breaks down where its fit begins: {error}") from error


FLOOR = 0.0015
"""[share] of the level of a channel: model-error floor at which fits are compared. Exercised by engine/test_fit.py."""

TRIAL = 20
"""[count] of evaluations after which a trial stops, and begins once more if it still gained: most are of effects that are not
there. Exercised by engine/test_fit.py."""

CHILD_RESTARTS = 3
"""[count] of times that a descent of a child begins again: it has others, one of which ends lower where this one creeps along a
valley. Exercised by engine/test_fit.py."""

PLAIN_FLOOR = 0.01
"""[share] The same floor where tolerances of the measurement are not fitted: what gains, delays and angles within them make of a
prediction. Held by engine/test_fit.py."""


def fit(
    problem: Problem,
    kinds: Sequence[str],
    *,
    start: Fit | Offsets | None = None,
    floor: float | None = None,
    progress: Progress | None = None,
) -> Fit:
    """The parameters of `kinds` that fit best, knowledge beforehand counted; others stand where the model has them.

    Where the tolerances of the measurement are not among `kinds`, declared parameters stay `within` their bounds. Effects always
    stay within what their family allows.

    Parameters
    ----------
    start : offsets at which to begin; or the fit of a parent, in whose place this one never costs more: what the parent does not
        have begins at the size at which there is no effect (offset 0) and, once more, at its own start
    floor : model-error floor; `FLOOR`, and `PLAIN_FLOOR` where tolerances of the measurement are not fitted
    progress : told the share of the work that is done, 0 to 1

    Raises
    ------
    CheckFailed : without a parent, when the model breaks down where it begins.
    """
    tell = progress or (lambda share: None)
    cost = cost_of(problem, problem.free(kinds), floor_of(kinds) if floor is None else floor, plain=SENSOR not in kinds)
    if isinstance(start, Fit):
        # The cheapest of the parent's point, the way straight from there, and the way annealed from the child's start
        null = parents_point(cost.free, start)
        ends = [ended(cost, null, converged=False)]
        begins = {one.name: start.by_name.get(one.name, one.start) for one in cost.free}
        for way, begin in ((direct, null), (annealed, begins)):
            with suppress(CheckFailed):
                ends.append(_cheaper(way(cost, begin, tell, again=CHILD_RESTARTS), begin, tell))
                if not start.sound and fitted(ends[-1]).sound:  # what is new explains what its parent could not
                    break
        if not _best(ends).converged:  # what the parent was driven to for want of the effect may be a valley without an end
            with suppress(CheckFailed):
                ends.append(_cheaper(annealed(cost, {}, tell), {}, tell))
        end = _best(ends)
    else:
        begin, everywhere = dict(start or {}), SENSOR in kinds
        near = short(cost, begin, tell) if everywhere else None
        end = near if near is not None and fitted(near).sound else annealed(cost, begin, tell, everywhere=everywhere, near=near)
        end = _cheaper(end, begin, tell)
        if not end.converged:  # it is there where the step is short: two modes that change places let none gain what is expected
            end = replace(end, converged=max(map(abs, _ahead(end).values()), default=0.0) < CLOSE)
    tell(1.0)
    return fitted(end)


def child(
    problem: Problem,
    kinds: Sequence[str],
    parent: Fit,
    start: Offsets,
    *,
    from_afar: bool = False,
    floor: float | None = None,
    close: float = CLOSE,
    worth: float = inf,
) -> Fit:
    """The fit of `problem`, which has more parameters than that of its `parent`, by a single way; it never costs more.

    Parameters
    ----------
    start : offsets at which the way begins; what is not named begins where the parent ended, or where it has no effect
    from_afar : whether the floor is annealed on the way, instead of straight down
    close : [sd] that the last step straight down may be
    worth : as of `Cost`; at most what its parent costs

    Raises
    ------
    CheckFailed : the model breaks down where it begins and, of a structure over other coordinates, where the parent ended.
    """
    cost = cost_of(problem, problem.free(kinds), floor_of(kinds) if floor is None else floor, plain=SENSOR not in kinds)
    cost, null = replace(cost, worth=min(worth, parent.cost)), parents_point(cost.free, parent)
    down = partial(annealed, steps=TRIAL) if from_afar else partial(direct, close=close, again=1)
    ends, broken = list[End](), None
    try:
        ends.append(down(cost, {**null, **start}, lambda share: None, most=TRIAL))
    except CheckFailed as error:
        broken = error
    if broken or ends[0].whole.cost > parent.cost:
        with suppress(*BREAKDOWNS):  # over other coordinates than its parent's
            ends.append(ended(cost, null, converged=False))
    if broken and not ends:
        raise broken
    return fitted(min(ends, key=lambda one: one.whole.cost))


def nearby(
    problem: Problem,
    kinds: Sequence[str],
    start: Offsets,
    *,
    floor: float | None = None,
    worth: float = inf,
    again: int = RESTARTS,
) -> Fit:
    """The fit to which the way leads straight down from `start`, as far as it ends; `floor` as in `fit`, `worth` of `Cost`, and
    `again` as in `direct`.

    Raises
    ------
    CheckFailed : the model breaks down where it begins.
    """
    cost = cost_of(problem, problem.free(kinds), floor_of(kinds) if floor is None else floor, plain=SENSOR not in kinds)
    return fitted(direct(replace(cost, worth=worth), start, lambda share: None, again=again))


def unfitted(problem: Problem, kinds: Sequence[str], offsets: Offsets) -> Fit:
    """The parameters of `kinds` as they stand at `offsets`, with what the data say there; nothing was fitted, nor converged."""
    cost = cost_of(problem, problem.free(kinds), floor_of(kinds), plain=SENSOR not in kinds)
    return fitted(ended(cost, offsets, converged=False))


def floor_of(kinds: Sequence[str]) -> float:
    """The model-error floor of a fit of parameters of `kinds`."""
    return FLOOR if SENSOR in kinds else PLAIN_FLOOR


def _best(ends: Sequence[End]) -> End:
    """The cheapest; it is as good as any other that ended by itself and costs as much."""
    best = min(ends, key=lambda end: end.whole.cost)
    return replace(best, converged=any(one.converged and one.whole.cost < best.whole.cost + RESTART_GAIN for one in ends))


def _cheaper(end: End, start: Offsets, tell: Progress) -> End:
    """`end`, or where it stands at bounds what is cheaper: the way from `start` without them, brought back within them."""
    if not (end.cost.plain and any(one.within < inf for one in end.cost.held)):
        return end
    cost = end.cost.holding({})
    try:
        # A trial is enough: without bounds some valleys have no end, and what it leads to is brought back within them
        unbound = replace(cost, free=tuple(replace(one, within=inf) for one in cost.free))
        free = annealed(unbound, start, tell, most=TRIAL, again=0)
        other = direct(cost, free.offsets, tell)
    except CheckFailed:
        return end
    return min(end, other, key=lambda one: one.whole.cost)


def parents_point(free: Sequence[Parameter], parent: Fit) -> dict[str, float]:
    """Offsets of `free` at which a child is its parent: what is new stands where it has no effect."""
    known = parent.by_name
    return {one.name: known.get(one.name, one.start if one.logarithmic else 0.0) for one in free}


def fitted(end: End) -> Fit:
    """An end as a result."""
    everything = (*end.cost.free, *end.cost.held)
    order = [one for one in end.cost.problem.parameters if one.name in {each.name for each in everything}]
    offsets = end.offsets
    tolerances = [one for one in everything if one.kind in TOLERANCES and np.isfinite(one.tolerance)]
    covariance = np.zeros((len(order), len(order)))
    place = {one.name: k for k, one in enumerate(order)}
    at = np.array([place[name] for name in end.cost.names], dtype=np.int64)
    covariance[np.ix_(at, at)] = inverse(end.whole.matrix) if len(at) else 0.0
    return Fit(
        parameters=tuple(order),
        offsets=np.array([offsets[one.name] for one in order]),
        covariance=covariance,
        cost=end.whole.cost,
        chi2=end.chi2,
        degrees_of_freedom=end.cost.size(end.x) - sum(not np.isfinite(one.tolerance) for one in end.cost.free),
        tolerance_z2=sum((offsets[one.name] / one.tolerance) ** 2 for one in tolerances),
        tolerances=len(tolerances),
        log_evidence=log_evidence(end.cost, end.x, end.whole),
        converged=end.converged,
        ahead={} if end.converged else _ahead(end),
    )


def _ahead(end: End) -> dict[str, float]:
    """The next step of the three parameters that it moves farthest [standard deviations]; none of what its bound holds back."""
    (low, high), g = end.cost.bounds, end.whole.gradient
    held = ((end.x <= low) & (g > 0)) | ((end.x >= high) & (g < 0))
    covariance = inverse(end.whole.matrix[np.ix_(~held, ~held)])
    steps = -covariance @ g[~held] / np.sqrt(np.diag(covariance))
    names = (name for name, one in zip(end.cost.names, held, strict=True) if not one)
    return dict(sorted(zip(names, steps.tolist(), strict=True), key=lambda one: -abs(one[1]))[:3])


# Where a fit begins that would not find its way: the best place of a grid over the sizes that it cannot find from afar.
#
# A resonator's frequency has no slope where the resonator weighs nothing, and the slope of a modulus far beside its resonance
# points anywhere. So the sizes that are named take every value of a grid, a dictionary; at each place the other free parameters
# take the best step of the quadratic model there, and its gain says how promising the place is. Of the most promising the true
# cost decides, and the point from which it began stays where none is better.
#
# What a resonator does grows with its mass. Such an amplitude is not on the grid: at every place it begins at next to nothing,
# the quadratic model says how many times as much the data want, and what is known of its logarithm does not count, because that
# is no step of a logarithm.

SINGLE_PLACES = 41
"""[count] of places along a single size. Exercised by engine/test_fit.py."""

SEVERAL_PLACES = 9
"""[count] of places along each of several sizes. Exercised by engine/test_fit.py."""

REACH = 2.0
"""[prior sd] to either side that a grid covers. Exercised by engine/test_fit.py."""

NEXT_TO_NOTHING = -7.0
"""[log] Offset of a small amplitude from where it stands: a thousandth. Held by engine/test_fit.py."""

PROMISING = 5
"""[count] of places whose true cost is looked at. Exercised by engine/test_fit.py."""


def start(
    problem: Problem,
    names: Sequence[str],
    *,
    kinds: Sequence[str] = PLAIN,
    base: Offsets | None = None,
    places: Mapping[str, npt.ArrayLike] | None = None,
    amplitude: str = "",
    floor: float = PLAIN_FLOOR,
    progress: Progress | None = None,
) -> dict[str, float]:
    """Offsets of the parameters of `kinds` from which a fit finds its way.

    Parameters
    ----------
    names : of the parameters on the grid
    base : offsets from which to begin, such as a parent's solution; those of the model where nothing is said
    places : by name the offsets of the grid; evenly over `REACH` prior deviations about the base where nothing is said
    amplitude : name of a logarithmic parameter in whose value the data are linear while it is small; none by default
    progress : told the share of the work that is done, 0 to 1

    Raises
    ------
    BadInput : a name of no free parameter, or one of which nothing is known beforehand without its `places`.
    """
    tell = progress or (lambda share: None)
    cost = cost_of(problem, problem.free(kinds), floor, plain=SENSOR not in kinds)
    here = {name: x for name, x in {**problem.start, **(base or {})}.items() if name in cost.names}
    known, given = {one.name: one.tolerance for one in cost.free}, places or {}
    for name in names:
        if name not in known:
            raise BadInput("start", name, "is no free parameter of this problem", nearest(name, known) or "Free it")
        if name not in given and not np.isfinite(known[name]):
            raise BadInput("start", name, "nothing is known of it beforehand", "Give its `places`")
    evenly = np.linspace(-REACH, REACH, SINGLE_PLACES if len(names) == 1 else SEVERAL_PLACES)
    along = [
        np.asarray(given[name], dtype=np.float64).ravel() if name in given else here[name] + known[name] * evenly
        for name in names
    ]
    grid = [dict(zip(names, map(float, values), strict=True)) for values in product(*along)]
    found: list[tuple[float, dict[str, float]]] = []
    small = {amplitude: here[amplitude] + NEXT_TO_NOTHING} if amplitude else {}
    for done, place in enumerate(grid):
        # `cost` without what is known beforehand of the `amplitude`
        unpriced = replace(
            cost, free=tuple(replace(one, tolerance=np.inf) if one.name == amplitude else one for one in cost.free)
        )
        found += _promise(unpriced, {**here, **place, **small}, names, amplitude)
        tell((done + 1) / (len(grid) + PROMISING))
    best = sorted(found, key=lambda one: one[0])[:PROMISING]
    least, end = np.inf, here
    for offsets in (here, *(offsets for _, offsets in best)):
        with suppress(*BREAKDOWNS):
            there = cost.total(cost.at(offsets))[0].cost
            least, end = (there, offsets) if there < least else (least, end)
    return end


def _promise(cost: Cost, place: Offsets, names: Sequence[str], amplitude: str) -> list[tuple[float, dict[str, float]]]:
    """The cost that the quadratic model at `place` promises, and where it is; nothing where the model breaks down."""
    x = cost.at(place)
    try:
        whole, _ = cost.total(x)
    except BREAKDOWNS:
        return []
    moving = np.array([name not in names for name in cost.names])
    step = np.zeros(len(x))
    step[moving] = -np.linalg.lstsq(whole.matrix[np.ix_(moving, moving)], whole.gradient[moving], rcond=None)[0]
    promised = whole.cost + float(whole.gradient @ step) + 0.5 * float(step @ whole.matrix @ step)
    if amplitude:
        k = cost.names.index(amplitude)
        if step[k] <= 0:
            return []
        step[k] = np.log1p(step[k])
    there = np.clip(x + step, *cost.bounds)
    return [(promised, dict(zip(cost.names, map(float, there), strict=True)))]
