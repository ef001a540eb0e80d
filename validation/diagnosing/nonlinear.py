"""Which kind of nonlinearity lets two levels differ: friction, a gap, saturation, or what else the catalogue has.

Every candidate is taken off the readings of all runs (`validation.diagnosing.bent`), at sizes from a grid and then at the best;
the right one leaves weaker runs that the stronger ones explain (`validation.diagnosing.driven`). First to first order, in what
the stronger runs cannot explain as they are; the best then as they would be without it. No model of the structure is fitted, so
none can swallow what does not belong to it.

Evidence is the fall of the sum of squares at the lines that are looked at, divided by what is left per degree of freedom by the
best of all: equations for the fundamental alone are good to some per cent and not to noise.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from geometry.errors import BadInput
from identification.quality import NORMAL_90
from validation.diagnosing.bench import Bench
from validation.diagnosing.bent import Bent, bent, could_act
from validation.diagnosing.diagnosis import Cause, Level, Size
from validation.diagnosing.driven import Beyond, beyond, driven
from validation.effects.family import Size as OfFamily
from validation.effects.identifiers import Named
from validation.effects.worth import ALIKE
from validation.models.pairing import vocabulary

LINES = 60
"""Of a campaign, that are looked at."""

WORST = 3
"""Weaker runs of a campaign that are looked at, those that differ most."""

SUSPECTED = 4
"""Channels that are suspected of saturation, those that differ most."""

PER_DECADE = 3
"""Sizes of the first grid."""

AGAIN = 4
"""Candidates, the best by first order, whose size is found once more."""

EXPLAINED = 0.8
"""Share of the surplus that a kind must explain to be the right one."""

EQUATIONS = 0.04
"""Standard deviation by which the equations themselves are off in the size, as a share."""

BY_CHANCE = 4.0
"""Standard deviations of a sum of squares within which what is left over is noise."""

TINY = float(np.finfo(np.float64).tiny)


def nonlinear(bench: Bench, levels: Sequence[Level], progress: Callable[[float], None] | None = None) -> tuple[Cause, ...]:
    """What could let the axes of `levels` differ, the likeliest first; none where runs do not state their level.

    `misfit` of a cause is what it leaves per degree of freedom, and `null` says whether it explains the difference.
    """
    seen = tuple(_seen(bench, levels))
    if not seen:
        return ()
    found: list[_Found] = []
    every = could_act([one.bent.one for one in seen], vocabulary(bench.model, bench.campaigns), _suspected(levels))
    for k, named in enumerate(every):
        found += _sized(named, seen, first_order=True)
        if progress is not None:
            progress((k + 1) / (len(every) + 1))
    found.sort(key=lambda one: one.chi2)
    again = [better for one in found[:AGAIN] for better in _sized(one.named, seen, first_order=False)]
    if progress is not None:
        progress(1.0)
    return tuple(_causes(sorted(again, key=lambda one: one.chi2), seen))


@dataclass(frozen=True, eq=False, kw_only=True)
class _Seen:
    """One campaign: its runs, and which of the weaker ones are looked at."""

    bent: Bent
    runs: tuple[int, ...]

    @cached_property
    def left(self) -> tuple[Beyond, ...]:
        """What these runs hold beyond the stronger ones, as they are."""
        return beyond(self.bent.of, self.runs)

    @property
    def used(self) -> tuple[int, ...]:
        """The runs that are taken into account: those, and the stronger ones."""
        return (*self.runs, *self.bent.of.stronger)

    def first_order(self, named: Named) -> float:
        """Sum of squares without `named`, the stronger runs explaining what they do as they are."""
        by_run = {run: self.bent.bent(named, run) for run in self.used}
        found = 0.0
        for one in self.left:
            taken = sum(one.weights[:, [h]] * by_run[run] for h, run in enumerate(self.bent.of.stronger))
            found += float(np.sum(np.abs(one.whitened - one.projected(by_run[one.run] - taken)) ** 2))
        return found

    def exact(self, named: Named) -> float:
        """Sum of squares without `named`."""
        of = self.bent.of
        values = np.array(of.values)
        for run in self.used:
            values[run] -= self.bent.bent(named, run)
        return sum(one.chi2 for one in beyond(replace(of, values=values), self.runs))


@dataclass(frozen=True, kw_only=True)
class _Found:
    """A candidate at its best size, what it leaves, and the second derivative of that by the size (its logarithm)."""

    named: Named
    chi2: float
    curvature: float


def _seen(bench: Bench, levels: Sequence[Level]) -> Iterator[_Seen]:
    for one in bench.made:
        told = sorted((level for level in levels if level.data_set == one.measured.name), key=lambda level: -level.sigma)
        model = one.with_effects(bench.model.effects)
        if not told or not all(np.any(drive.amplitude) for drive in model.tested.drives):
            continue
        of = driven(model)
        lines = np.unique(np.linspace(0, len(of.frequency) - 1, LINES).round().astype(np.int64))
        runs = tuple(of.runs.index(level.runs[0]) for level in told[:WORST])
        recordings = next((raw.recordings for raw, made in zip(bench.campaigns, bench.made, strict=False) if made is one), {})
        yield _Seen(bent=bent(model, of, lines, recordings), runs=runs)


def _suspected(levels: Sequence[Level]) -> tuple[str, ...]:
    worst = sorted(levels, key=lambda level: -level.sigma)
    every = dict.fromkeys(level.channels[k] for k in range(SUSPECTED) for level in worst if k < len(level.channels))
    return tuple(every)[:SUSPECTED]


def _sized(named: Named, seen: Sequence[_Seen], *, first_order: bool) -> list[_Found]:
    """`named` at its best size; none where the data have not what it acts on, or no size helps."""
    from scipy.optimize import minimize_scalar

    size = named.fitted_sizes[0]
    begin = named.values[size.key]

    def at(x: float) -> Named:
        return replace(named, values={**named.values, size.key: float(np.exp(x)) if size.logarithmic else x})

    def chi2(x: float) -> float:
        return sum(one.first_order(at(x)) if first_order else one.exact(at(x)) for one in seen)

    try:
        low, high = _bracket(size, chi2) if first_order else _around(size, begin)
    except BadInput:
        return []
    best = minimize_scalar(chi2, bounds=(low, high), method="bounded", options={"xatol": 1e-3 * (high - low)})
    step = 0.02 * (high - low)
    curvature = (chi2(best.x - step) - 2 * best.fun + chi2(best.x + step)) / step**2
    return [_Found(named=at(float(best.x)), chi2=float(best.fun), curvature=float(curvature))]


def _bracket(size: OfFamily, chi2: Callable[[float], float]) -> tuple[float, float]:
    """Where the best size lies, as a logarithm where it is fitted so: the neighbours of the best of a grid."""
    if not size.logarithmic:
        return size.low, size.high
    low, high = np.log(size.low), np.log(size.high)
    grid = np.linspace(low, high, round(PER_DECADE * (high - low) / np.log(10)) + 1)
    best = int(np.argmin([chi2(float(x)) for x in grid]))
    return float(grid[max(best - 1, 0)]), float(grid[min(best + 1, len(grid) - 1)])


def _around(size: OfFamily, value: float) -> tuple[float, float]:
    if size.logarithmic:
        return float(np.log(value)) - 0.7, float(np.log(value)) + 0.7
    half = 0.3 * abs(value) + 0.02 * (size.high - size.low)
    return max(size.low, value - half), min(size.high, value + half)


def _causes(found: Sequence[_Found], seen: Sequence[_Seen]) -> Iterator[Cause]:
    """In nats of what the best leaves; only of those that help at all."""
    before = sum(left.chi2 for one in seen for left in one.left)
    count = sum(left.count for one in seen for left in one.left)
    scale = max(1.0, found[0].chi2 / count) if found else 1.0
    best = (before - found[0].chi2) / scale if found else 0.0
    for k, one in enumerate(found):
        evidence = (before - one.chi2) / scale
        if evidence <= 0:
            continue
        rivals = [other.named.id for j, other in enumerate(found) if j != k and abs(other.chi2 - one.chi2) / scale < ALIKE]
        share = min((before - one.chi2) / max(before - count, TINY), 1.0)
        enough = share > EXPLAINED or one.chi2 < count + BY_CHANCE * np.sqrt(count)
        yield Cause(
            named=one.named,
            sizes=(_size(one, scale),),
            evidence=evidence,
            misfit=one.chi2 / count,
            null=bool(enough),
            note=_in_words(share, rivals if best - evidence < ALIKE else [], enough=bool(enough)),
        )


def _size(one: _Found, scale: float) -> Size:
    """With the 90 % interval of the curvature: -log L is the sum of squares over `scale`."""
    of = one.named.fitted_sizes[0]
    value = one.named.values[of.key]
    of_equations = EQUATIONS if of.logarithmic else EQUATIONS * abs(value)
    half = NORMAL_90 * float(np.hypot(np.sqrt(scale / one.curvature), of_equations)) if one.curvature > 0 else np.inf
    low, high = (value * np.exp(-half), value * np.exp(half)) if of.logarithmic else (value - half, value + half)
    return Size(key=of.key, value=value, unit=of.unit, low=max(float(low), of.low), high=min(float(high), of.high))


def _in_words(share: float, rivals: Sequence[str], *, enough: bool) -> str:
    """What is to be said beside the size."""
    explains = f"it explains {100 * share:.0f} % of what differs between the levels beyond noise"
    if not enough:
        explains += ", so another kind, or more than one, is at work"
    return f"{explains}; these levels cannot tell it from {' and '.join(rivals)}" if rivals else explains
