"""The table of bars of the catalogue of effects, row by row."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import isfinite
from statistics import median

import numpy as np

from benchmarks.blind.score.outcome import NOTHING, UNKNOWN, Outcome
from benchmarks.blind.score.rates import Rate, rate

NULL, SINGLE, PAIR, LEFT_OUT, FOREIGN = "nulls", "singles", "pairs", "left-out", "foreign"

WELL_ABOVE = 2.0
"""Times the detection limit from which an effect is to be named."""

LEFTOVER = 1.2
"""Times the misfit of its null from which an unknown effect is to be called one."""

WITHIN = 1.3
"""Times the plain error of its null that a series may keep on held-out data."""

LEAST = 0.1
"""[%] Plain error below which nothing is told apart."""

SECONDS = 15.0
"""Of a diagnosis on one core."""

ROUNDING = 1e-6
"""Relative: sizes are written with five digits, and a multiple of two may read 1.99999."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """One measure.

    Attributes
    ----------
    what : is measured
    figure : as it came out, with its interval where it is a share
    bar : that it is held against; empty for one that only tells more
    met : whether it is; None without a bar, or while nothing was counted
    private : whether it is a time, which belongs to this machine alone
    """

    what: str
    figure: str
    bar: str = ""
    met: bool | None = None
    private: bool = False


def rows(outcomes: Sequence[Outcome]) -> list[Row]:
    """All of them."""
    nulls, singles = _of(outcomes, NULL), _of(outcomes, SINGLE)
    named = [one for one in singles if not one.sized or one.multiple >= WELL_ABOVE * (1 - ROUNDING)]
    faulty = [*singles, *_of(outcomes, PAIR)]
    return [
        _share("named first, at 2 times the detection limit and more", rate(one.first for one in named), least=0.90),
        Row(what="· first, or not more than 1 nat behind what is", figure=str(rate(one.first or _tied(one) for one in named))),
        *_by_size(singles),
        Row(
            what="the same, at 2 times what the diagnosis of its null said that it would name there",
            figure=str(rate(one.first for one in named if not one.sized or _told(one, nulls))),
        ),
        Row(
            what="the same, beyond 2 times what tolerances hide",
            figure=str(rate(one.first for one in named if one.told >= WELL_ABOVE * (1 - ROUNDING) or not one.sized)),
        ),
        _share("truth inside the reported class", rate(one.inside for one in named), least=0.97),
        _class_size([one for one in named if one.claimed]),
        _false_alarms(nulls),
        _share("extra claims on faulty data", rate(one.extra for one in faulty), most=0.05),
        Row(what="· a claim that is wrong, however many there are", figure=str(rate(one.stray for one in faulty))),
        *_sizes(faulty),
        _share("both of a pair named", rate(one.every for one in _of(outcomes, PAIR)), least=0.80),
        *_unknown(outcomes, nulls),
        _held_out(faulty, nulls),
        _share("baseline refuses, or the program breaks down", rate(not one.answered for one in outcomes), most=0.02),
        *_times(outcomes),
    ]


def _of(outcomes: Iterable[Outcome], *kinds: str) -> list[Outcome]:
    return [one for one in outcomes if one.kind in kinds]


def _share(what: str, found: Rate, *, least: float | None = None, most: float | None = None) -> Row:
    bar = f"at least {100 * least:g} %" if least is not None else f"at most {100 * (most or 0.0):g} %"
    met = found.share >= least if least is not None else found.share <= (most or 0.0)
    return Row(what=what, figure=str(found), bar=bar, met=met if found.count else None)


def _tied(one: Outcome) -> bool:
    """Whether what was planted stands as near to what is claimed first as makes no difference."""
    return set(one.claimed[:1]) | set(one.planted) <= set(one.tied) and bool(one.claimed)


def _told(one: Outcome, nulls: Sequence[Outcome]) -> bool:
    """Whether the null of `one`, the same sweeps held out, said that half as much would be named."""
    sizes = [null.detectable.get(one.planted[0]) for null in nulls if null.name == one.null]
    return any(size is not None and one.size >= WELL_ABOVE * size for size in sizes)


def _by_size(singles: Sequence[Outcome]) -> list[Row]:
    found = [one for one in singles if one.sized]
    multiples = sorted({round(one.multiple) for one in found})
    return [
        Row(what=f"· at {multiple} times", figure=str(rate(one.first for one in found if round(one.multiple) == multiple)))
        for multiple in multiples
    ]


def _class_size(claiming: Sequence[Outcome]) -> Row:
    sizes = [len(one.alike) for one in claiming]
    if not sizes:
        return Row(what="size of that class", figure="none yet", bar="median at most 2, 90th percentile at most 5")
    middle, large = float(np.median(sizes)), float(np.percentile(sizes, 90))
    return Row(
        what="size of that class",
        figure=f"median {middle:g}, 90th percentile {large:g}",
        bar="median at most 2, 90th percentile at most 5",
        met=middle <= 2 and large <= 5,
    )


def _false_alarms(nulls: Sequence[Outcome]) -> Row:
    """Of those that were answered: a refusal is no alarm, and no proof that there would have been none."""
    found = rate(one.verdict != NOTHING for one in nulls if one.answered)
    unknown = sum(one.verdict == UNKNOWN for one in nulls)
    met = found.share <= 0.01 if found.count else None
    return Row(what="false alarms on nulls", figure=f"{found}, {unknown} of them without a name", bar="at most 2 of 200", met=met)


def _sizes(faulty: Sequence[Outcome]) -> list[Row]:
    found = [size for one in faulty for size in one.sizes]
    covered = rate(size.inside for size in found)
    middle = median(size.error for size in found) if found else float("nan")
    return [
        Row(
            what="median error of the size",
            figure=f"{100 * middle:.1f} %" if found else "none yet",
            bar="at most 5 %",
            met=middle <= 0.05 if found else None,
        ),
        Row(
            what="90 % interval holds the size",
            figure=str(covered),
            bar="85 to 95 %",
            met=0.85 <= covered.share <= 0.95 if found else None,
        ),
    ]


def _unknown(outcomes: Sequence[Outcome], nulls: Sequence[Outcome]) -> list[Row]:
    by_name = {one.name: one for one in nulls}
    found = [one for one in _of(outcomes, LEFT_OUT, FOREIGN) if one.null in by_name]
    small = [one for one in found if one.misfit < LEFTOVER * by_name[one.null].misfit]
    left = [one for one in found if one not in small]  # with those that were refused: nobody knows what they leave
    told = "unknown physics is called unknown, where its leftover is 20 % above null"
    return [
        _share(told, rate(one.verdict == UNKNOWN for one in left), least=0.90),
        *(
            Row(what=f"· {words}", figure=str(rate(one.verdict == UNKNOWN for one in left if one.kind == kind)))
            for kind, words in ((LEFT_OUT, "left out of the catalogue"), (FOREIGN, "in no catalogue"))
        ),
        Row(what="· given a wrong name there", figure=str(rate(bool(one.claimed) for one in left))),
        Row(what="· given a wrong name where less is left", figure=str(rate(bool(one.claimed) for one in small))),
    ]


def _held_out(faulty: Sequence[Outcome], nulls: Sequence[Outcome]) -> Row:
    by_name = {one.name: one for one in nulls if one.held_out is not None}
    pairs = [(one.held_out, by_name[one.null].held_out) for one in faulty if one.null in by_name]
    times = [max(after, LEAST) / max(null, LEAST) for after, null in pairs if after is not None and null is not None]
    what, bar = "median of plain error after, on held-out sweeps, over that of the null", f"within {WITHIN:g}"
    if not times:
        return Row(what=what, figure="none yet", bar=bar)
    within = rate(one <= WITHIN for one in times)
    return Row(what=what, figure=f"{median(times):.2f}; within {WITHIN:g} in {within}", bar=bar, met=median(times) <= WITHIN)


def _times(outcomes: Sequence[Outcome]) -> list[Row]:
    timed = [one for one in outcomes if isfinite(one.seconds)]
    if not timed:
        return []
    over = median(one.seconds / one.reading for one in timed)
    seconds = median(one.seconds for one in timed)
    return [
        Row(what="time of a diagnosis over that of reading the data, median", figure=f"{over:.1f}"),
        Row(
            what="time of a diagnosis, median",
            figure=f"{seconds:.1f} s",
            bar=f"at most {SECONDS:g} s on one core",
            met=seconds <= SECONDS,
            private=True,
        ),
    ]
