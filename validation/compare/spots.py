"""The worst spots: connected regions of the maps, merged over neighbouring lines and over all rows that say the same.

One fault shows in many cells of a map. A spot therefore takes the worst row of a run, the stretch of lines around its peak on
which it stays above half of that, and whatever else in this run and stretch is less bad than it. What is left is looked at
again: something worse in the same stretch is a spot of its own. The same row in other runs, and the same channel in other
data sets, is one spot with the worst of them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from geometry.dynamic_mass import MOTIONS, ComplexArray
from geometry.frames import Array
from geometry.inertia import LOADS as OBSERVABILITY_LOADS
from validation.compare.maps import LENGTHS, Map, NamedMode, taking_part
from validation.estimation.verdicts import figure
from validation.output import derived, entry, unwritten

# How a deviation depends on frequency, where that is plain: a share that is constant, grows, falls, or a resonance.
#
# Each candidate is fitted by weighted least squares with one real number, a resonance with two complex ones, and is named only
# when it explains nearly all of the deviation. What follows nothing plain gets no name.


EXPLAINED = 0.9
"""Share of the deviation, in squares of standard deviations, that a name must explain."""

AROUND = 0.3
"""Share of a mode's frequency to either side in which a deviation may follow it."""

LONGEST = 3.0
"""[Hz] to either side that count at most."""

SHIFTED = 0.12
"""Share of its frequency by which a mode may lie elsewhere."""

WIDTHS = 6
"""Damping ratios to either side of a peak within which the mode is sought that makes it."""

SHARES: Mapping[str, tuple[complex, int]] = {
    "the same share at all frequencies": (1, 0),
    "a share that grows with frequency, as of a delay": (1j, 1),
    "a share that falls with frequency, as of a high-pass": (1j, -1),
    "a share that grows with the square of frequency": (1, 2),
    "a share that falls with the square of frequency": (1, -2),
}
"""Of what a channel reads: factor and power of the frequency."""

LOADS: Mapping[str, tuple[complex, int]] = {
    "constant over frequency, as of a mass": (1, 0),
    "grows with the square of frequency, as of a compliance": (1, 2),
    "falls with the square of frequency, as of a spring to ground or of gravity": (1, -2),
    "falls with frequency, as of a damper to ground": (1j, -1),
}
"""Of the motion that a run drives."""


@dataclass(frozen=True, eq=False, kw_only=True)
class FrequencyTrend:
    """A deviation over frequency.

    Attributes
    ----------
    frequency : (n,) [Hz]
    deviation : (n,) complex
    expected : (n,) standard deviation
    reading : (n,) complex, what was expected to be read
    motion : (n,) complex, what the run drives
    of_load : whether it is a load's, not a channel's
    """

    frequency: Array
    deviation: ComplexArray
    expected: Array
    reading: ComplexArray
    motion: ComplexArray
    of_load: bool


def follows(course: FrequencyTrend, modes: Sequence[NamedMode], band: tuple[float, float], peak: float) -> str:
    """What the deviation follows, in words; empty where nothing plain. It stands out in `band` [Hz], most at `peak`."""
    weight = 1 / np.maximum(course.expected, np.finfo(np.float64).tiny)
    y, f = weight * course.deviation, course.frequency
    if not np.any(np.abs(y) > 0):
        return ""
    functions, driver = (LOADS, course.motion) if course.of_load else (SHARES, course.reading)
    shares = {name: _explained(y, [factor * weight * driver * f**power]) for name, (factor, power) in functions.items()}
    best = max(shares, key=lambda name: shares[name])
    return best if shares[best] >= EXPLAINED else _resonance(f, y, weight * course.motion, modes, band, peak)


def _resonance(
    frequency: Array,
    y: ComplexArray,
    motion: ComplexArray,
    modes: Sequence[NamedMode],
    band: tuple[float, float],
    peak: float,
) -> str:
    """The mode near `band` whose resonance the deviation follows: as it is predicted and as it would be a little elsewhere."""
    found = {}
    for mode in modes:
        if band[0] / (1 + SHIFTED) <= mode.frequency <= band[1] * (1 + SHIFTED):
            near = np.abs(frequency - mode.frequency) <= min(AROUND * mode.frequency, LONGEST)
            tried = [(mode.frequency, mode.damping_ratio), *_elsewhere(peak, mode.damping_ratio)]
            found[mode.name] = max(_beside(frequency[near], y[near], motion[near], mode, other) for other in tried)
    best = max(found, key=lambda name: found[name], default="")
    return f"follows the {best}" if best and found[best] >= EXPLAINED else ""


def _elsewhere(peak: float, zeta: float) -> Iterator[tuple[float, float]]:
    """Frequencies [Hz] about `peak` and damping ratios that a mode might have there."""
    for times in (0.25, 0.5, 1.0, 2.0):
        for width in np.linspace(-WIDTHS, WIDTHS, 4 * WIDTHS + 1):
            yield peak * (1 + width * times * zeta), times * zeta


def _beside(frequency: Array, y: ComplexArray, motion: ComplexArray, mode: NamedMode, other: tuple[float, float]) -> float:
    """What a resonance explains as predicted and as it might be, frequency and damping; where they are one, its derivative."""
    L, second = (_resonates(frequency / f, zeta) for f, zeta in ((mode.frequency, mode.damping_ratio), other))
    if other == (mode.frequency, mode.damping_ratio):
        second = L**2
    return _explained(y, [factor * motion * of for factor in (1, 1j) for of in (L, second)])


def _resonates(ratio: Array, zeta: float) -> ComplexArray:
    return np.asarray(1 / (1 - ratio**2 + 2j * zeta * ratio))


def _explained(y: ComplexArray, basis: Sequence[ComplexArray]) -> float:
    """Share of the square of y (n,) that real multiples of the `basis` explain; 0 of fewer lines than would show anything."""
    columns, flat = _real(np.stack(basis, axis=1)), _real(y)
    if len(flat) < 4 * columns.shape[1] or not np.any(flat):
        return 0.0
    columns = columns / np.maximum(np.linalg.norm(columns, axis=0), np.finfo(np.float64).tiny)
    found, *_ = np.linalg.lstsq(columns, flat, rcond=None)
    left = flat - columns @ found
    return float(1 - (left @ left) / (flat @ flat))


def _real(values: ComplexArray) -> Array:
    """Complex values (n, ...) as (2 n, ...) real ones."""
    return np.concatenate([values.real, values.imag])


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

    data_set: str = entry("campaign")
    configuration: str = unwritten()
    run: str
    axis: str = unwritten()
    row: str = entry("channel")
    of_load: bool = unwritten()
    frequency: float = entry("frequency_hz", unit="Hz")
    sigma: float
    band: tuple[float, float] = entry("band_hz", unit="Hz")
    percent: float
    counts: float = unwritten(default=0.0)
    course: str = entry("follows", null="", default="")
    others: tuple[str, ...] = entry("also_in_channels", default=())
    elsewhere: tuple[tuple[str, str, float], ...] = entry(
        "also_in", write=lambda of: [dict(zip(("campaign", "run", "sigma"), one, strict=True)) for one in of], default=()
    )

    @property
    @derived("text", before="band_hz")
    def text(self) -> str:
        """In words, of one configuration among several."""
        return text(self)


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
    course = FrequencyTrend(
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


# Spots in words: what is wrong, where, by how much, and what it follows.
#
# moment about y in the y-sweep of fmd+clumod-1, 11-13 Hz, 9 sigma, 4 % of the dynamic mass, follows the first mast mode


SENSED = dict(
    zip(
        OBSERVABILITY_LOADS,
        ("force along x", "force along y", "force along z", "moment about x", "moment about y", "moment about z"),
        strict=True,
    )
)
"""A load in words."""

AXES = dict(zip(MOTIONS, ("x", "y", "z", "rotation about x", "rotation about y", "rotation about z"), strict=True))

NAMED = 3
"""Rows or runs that are listed by name; of more, their number is."""


def text(spot: Spot, configurations: int = 2) -> str:
    """One spot; the configuration is left out where there is only one."""
    where = f" of {spot.data_set}" if configurations > 1 else ""
    share = "of the dynamic mass" if spot.of_load else "of what it reads"
    parts = [
        f"{row(spot.row)} in {run(spot.run, spot.axis)}{where}",
        band(spot.band),
        f"{figure(spot.sigma)} sigma",
        f"{figure(spot.percent)} % {share}",
        *([spot.course] if spot.course else []),
    ]
    return ", ".join(parts) + _comparison_elsewhere(spot)


def row(name: str) -> str:
    """A channel by its name, a load in words."""
    return SENSED.get(name, name)


def run(name: str, axis: str) -> str:
    """ "the y-sweep", with the name of the run where that says more."""
    if axis not in AXES:
        return f"run {name}"
    swept = f"the {axis}-sweep" if axis in MOTIONS[:3] else f"the {axis} sweep"
    return swept if name == axis else f"{swept} ({name})"


def band(of: tuple[float, float]) -> str:
    """[Hz], with as many digits as tell its ends apart."""
    low, high = (f"{one:.0f}" for one in of)
    if low == high:
        low, high = (f"{one:.1f}" for one in of)
    return f"{low} Hz" if low == high else f"{low}-{high} Hz"


def _comparison_elsewhere(spot: Spot) -> str:
    """The same row in other runs and data sets."""
    own = [run(name, name) for data_set, name, _ in spot.elsewhere if data_set == spot.data_set]
    others = list(dict.fromkeys(data_set for data_set, _, _ in spot.elsewhere if data_set != spot.data_set))
    said = [*([listed(own)] if own else []), *others]
    return f"; also in {', '.join(said)}" if said else ""


def listed(names: Sequence[str]) -> str:
    """Up to `NAMED` by name, of more the number of the others."""
    more = len(names) - NAMED
    return ", ".join(names) if more <= 0 else f"{', '.join(names[:NAMED])} and {more} more"
