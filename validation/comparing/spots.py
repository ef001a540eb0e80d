"""The worst spots: connected regions of the maps, merged over neighbouring lines and over all rows that say the same.

One fault shows in many cells of a map. A spot therefore takes the worst row of a run, the stretch of lines around its peak on
which it stays above half of that, and whatever else in this run and stretch is less bad than it. What is left is looked at
again: something worse in the same stretch is a spot of its own. The same row in other runs, and the same channel in other
data sets, is one spot with the worst of them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import MOTIONS
from validation.comparing.frequency import Course, follows
from validation.comparing.maps import LENGTHS, Map
from validation.comparing.modes import NamedMode, taking_part

COUNT = 10

REGION = 0.5
"""Share of its peak down to which a spot reaches."""

GAP = 0.5
"""[Hz] of calmer lines that do not end a spot."""

LOAD, RESONANT = 0.65, 0.05
"""What a sigma of a load counts beside one of a channel, but for lines within that share of a mode's frequency. A channel that is
off shows in its loads nearly as much, all over the band; a resonance that is wrong is the structure's, and every cell sees it."""

A_RUN = 6
"""Spots of one run that are looked at."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Spot:
    """A region of a map.

    Attributes
    ----------
    data_set, configuration, run, axis : where
    row : the channel, or the load, that is worst
    of_load : whether it is a load
    frequency : [Hz] of the peak
    band : (low, high) [Hz]
    sigma : at the peak, in standard deviations
    counts : the same as it counts beside other rows
    percent : there, of what the channel reads, of the dynamic mass for a load
    course : what it follows over frequency, in words; empty where nothing plain
    others : rows of the same run that say the same, worst first
    elsewhere : (data set, run, sigma) where the same row stands out too, worst first
    """

    data_set: str
    configuration: str
    run: str
    axis: str
    row: str
    of_load: bool
    frequency: float
    band: tuple[float, float]
    sigma: float
    percent: float
    counts: float = 0.0
    course: str = ""
    others: tuple[str, ...] = ()
    elsewhere: tuple[tuple[str, str, float], ...] = field(default=())


def worst(maps: Sequence[Map], modes: Sequence[Sequence[NamedMode]], count: int = COUNT) -> tuple[Spot, ...]:
    """The worst `count` spots of all `maps`, worst first; `modes` are those of each map's configuration."""
    found = [spot for of, own in zip(maps, modes, strict=True) for spot in _of_map(of, own)]
    return tuple(_merged(sorted(found, key=lambda spot: -spot.counts)))[:count]


def _of_map(of: Map, modes: Sequence[NamedMode]) -> Iterator[Spot]:
    sigma = of.sigma
    for run in range(len(of.runs)):
        yield from _of_run(of, run, np.array(sigma[run]), modes)


def _of_run(of: Map, run: int, left: Array, modes: Sequence[NamedMode]) -> Iterator[Spot]:
    """The spots of one run; `left` (n, m) are sigmas, which spots take one after the other."""
    sigma, counts = np.array(left), _counts(of, modes)
    left *= counts
    whole = np.array(left)
    for _ in range(A_RUN):
        line, row = np.unravel_index(int(np.argmax(left)), left.shape)
        peak = float(left[line, row])
        if peak <= 0:
            return
        first, last = _stretch(of.frequency, whole[:, row], int(line), REGION * peak)
        yield replace(_spot(of, run, sigma, int(line), int(row), (first, last), modes), counts=peak)
        _take(left, whole[:, row], int(row), first, last, of.frequency)


def _counts(of: Map, modes: Sequence[NamedMode]) -> Array:
    """(n, m) what a sigma counts when the worst row is sought."""
    near = [np.abs(of.frequency / mode.frequency - 1) <= RESONANT for mode in modes]
    loads = np.where(np.any(near, axis=0), 1.0, LOAD) if near else np.full(len(of.frequency), LOAD)
    counts = np.ones((len(of.frequency), len(of.rows)))
    counts[:, of.channels :] = loads[:, None]
    return counts


def _stretch(frequency: Array, sigma: Array, line: int, limit: float) -> tuple[int, int]:
    """First and last line around `line` between which no gap of lines below `limit` is longer than `GAP`."""
    above = np.flatnonzero(sigma >= limit)
    at = int(np.searchsorted(above, line))
    apart = np.flatnonzero(np.diff(frequency[above]) > GAP)
    begin = max((k + 1 for k in apart if k < at), default=0)
    end = min((k for k in apart if k >= at), default=len(above) - 1)
    return int(above[begin]), int(above[end])


def _take(left: Array, sigma: Array, row: int, first: int, last: int, frequency: Array) -> None:
    """Take away what the worst row explains: its own region, and all rows where they are less bad within half a gap."""
    reach = np.abs(frequency[:, None] - frequency[None, first : last + 1]) <= GAP / 2
    around = np.where(reach, sigma[None, first : last + 1], 0.0).max(axis=1)
    left[left <= around[:, None]] = 0.0
    left[reach.any(axis=1), row] = 0.0


def _spot(of: Map, run: int, sigma: Array, line: int, row: int, stretch: tuple[int, int], modes: Sequence[NamedMode]) -> Spot:
    first, last = stretch
    band = (float(of.frequency[first]), float(of.frequency[last]))
    peaks = sigma[first : last + 1].max(axis=0)
    others = [k for k in np.argsort(-peaks) if k != row and peaks[k] >= REGION * sigma[line, row]]
    driven = _driven(of, run)
    course = Course(
        frequency=of.frequency,
        deviation=of.deviation[run, :, row],
        expected=of.expected[run, :, row],
        reading=of.reading[run, :, row],
        motion=of.inputs[run, :, driven],
        of_load=row >= of.channels,
    )
    return Spot(
        data_set=of.data_set,
        configuration=of.configuration,
        run=of.runs[run],
        axis=of.axes[run],
        row=of.rows[row],
        of_load=row >= of.channels,
        frequency=float(of.frequency[line]),
        band=band,
        sigma=float(sigma[line, row]),
        percent=float(of.percent[run, line, row]),
        course=follows(course, taking_part(modes, driven), band, float(of.frequency[line])),
        others=tuple(of.rows[k] for k in others),
    )


def _driven(of: Map, run: int) -> int:
    """Which of the inputs the run drives: that of its axis, else the greatest."""
    u = of.inputs[run]
    if of.axes[run] in MOTIONS and u.shape[1] == len(MOTIONS):
        return MOTIONS.index(of.axes[run])
    scaled = u * LENGTHS if u.shape[1] == len(MOTIONS) else u
    return int(np.argmax(np.sum(np.abs(scaled) ** 2, axis=0)))


def _merged(spots: Sequence[Spot]) -> list[Spot]:
    """`spots`, worst first, with what is the same again further down told by the worst."""
    kept: list[Spot] = []
    for spot in spots:
        same = next((k for k, one in enumerate(kept) if _same(one, spot)), None)
        if same is None:
            kept.append(spot)
        else:
            kept[same] = _both(kept[same], spot)
    return kept


def _same(one: Spot, other: Spot) -> bool:
    """Whether both are of one row - a channel is the same in all data sets, a load in its own alone - and of one cause.

    Their bands touch, or both follow the same over frequency: at a resonance a channel is calm, and its fault is the same beyond.
    """
    touching = one.band[0] <= other.band[1] + GAP and other.band[0] <= one.band[1] + GAP
    alike = touching or bool(one.course and one.course == other.course)
    return one.row == other.row and alike and (not one.of_load or one.data_set == other.data_set)


def _both(one: Spot, other: Spot) -> Spot:
    """`one`, with `other` in its band where both are of one run and alike bad, else as a further place."""
    here = (other.data_set, other.run)
    if here == (one.data_set, one.run):
        if other.sigma < REGION * one.sigma:
            return one
        return replace(one, band=(min(one.band[0], other.band[0]), max(one.band[1], other.band[1])))
    if here in ((data_set, run) for data_set, run, _ in one.elsewhere):
        return one
    return replace(one, elsewhere=(*one.elsewhere, (*here, other.sigma)))
