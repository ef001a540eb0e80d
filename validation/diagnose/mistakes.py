"""Discrete mistakes - a wrong sign, two plugs exchanged, a unit taken for another - which are looked for before any fit.

Every reading y_c of the lowest lines is held against what *every* channel of its quantity should read, times every
factor that a mistake can bring: y_c = k p_d. The assignment of readings to channels that is likeliest as a whole, at a price for
every mistake, says all of them at once: a cycle of three plugs as well as eight cells in kilonewtons.

    log L = -|y - k p|² / sigma² - log sigma² ,   sigma = |k| (OFF |p| + ...)

averaged over lines and added over runs, since what a nominal model has wrong does not average out. OFF is so wide that gains of
20 %, delays of milliseconds and pick-ups that sit 5 cm beside their place are no mistakes.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, product
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import MOTIONS, ComplexArray
from geometry.errors import CheckFailed
from geometry.frames import Array
from identification.consistency import candidates
from identification.modal_table import mac, mixes
from identification.quality import NORMAL_90
from validation.diagnose.diagnosis import Cause, EffectEstimate
from validation.effects.catalogue import Named
from validation.effects.effect import INDISTINGUISHABLE_NATS
from validation.estimation.problem import Parameter, Predicted
from validation.model.model import Added
from validation.prediction.modal_table import TableShapes
from validation.prediction.response_functions import FORCE_CHANNEL, ResponseFunctionTest
from validation.prediction.series import SeriesPrediction, is_read
from validation.study import Study

# What every channel of a campaign reads at its lowest lines, beside what all others and the model say it should read.
#
# There every structure is nearly a rigid body, so that the nominal model is right to some ten per cent, and a discrete mistake is
# wrong by hundreds. What moved is estimated from whichever six channels let most of the others agree: a channel that is wrong, or
# several, or all of one kind, then stands alone against the rest however wrong it is (random sample consensus, Fischler & Bolles,
# Communications of the ACM 24 (1981), 381). How far a reading lies from what it should be is told without any scale,
#
#     |y - p| / (|y| + |p|)     each line and run in units of what is usual there
#
# 0 where they agree, 0.1 for a gain of 20 %, 0.8 for g taken for m/s², 1 for a wrong sign.


REACH = 1.5
"""[factor] on the lowest line up to which lines are used. Held by test_mistakes.py."""

LINES = 4
"""[count] of those lines. Exercised by test_mistakes.py."""


DRAWS = 400
"""[count] of sets of six channels that are tried, of accelerometers alone and of all. Exercised by test_mistakes.py."""

CONDITION = 40.0
"""[1] Condition number of the rows of six channels beyond which they do not tell the motion. Exercised by test_mistakes.py."""

DISTANT = 0.15
"""[share] Distance of a reading from what it should be at which it stops to count much. Held by test_mistakes.py."""

NEAR = 0.25
"""[share] Distance, of a gain of two thirds, within which a channel takes part in the final estimate, and a reading is what a
mistake says. Held by test_mistakes.py."""

PORTION = 100
"""[count] of sets that are worked on at once; memory only. By definition."""

ROUNDS = 3
"""[count] of times that the final estimate is repeated with the channels that are near. Exercised by test_mistakes.py."""

UNHEARD = 1e6
"""[sd] How unsure a reading is, in SI, of a channel that a campaign has not. By definition."""

FAINT = 0.3
"""[share] of what a channel should read over all runs that counts as its level where it should read less. Exercised by
test_mistakes.py."""


@dataclass(frozen=True, eq=False, kw_only=True)
class LowFrequencyReadings:
    """One campaign at its lowest lines; runs and lines in one axis of m.

    Attributes
    ----------
    name : of the data set
    channels : (c,) names
    quantities : (c,) "acceleration", "force" or "moment"
    lines : how many of m belong to one run
    reading : (m, c) y
    expected : (m, c) p, by the other channels and the model
    noise : (m, c)
    unsure : (m, c) what base motions that nobody measured, or tolerances, may add to what is expected
    """

    name: str
    channels: tuple[str, ...]
    quantities: tuple[str, ...]
    lines: int
    reading: ComplexArray
    expected: ComplexArray
    noise: Array
    unsure: Array

    @classmethod
    def of(cls, one: SeriesPrediction) -> "LowFrequencyReadings":
        """The lowest lines of `one`, by its model as it stands."""
        measured = one.measured
        low = np.flatnonzero(measured.frequency <= REACH * measured.frequency[0])
        lines = np.unique(np.linspace(low[0], low[-1], LINES).round().astype(np.int64))
        rows = one.at({parameter.name: parameter.start for parameter in one.parameters}, lines, derivatives=False).rows
        rows = rows if rows.ndim == 4 else rows[None]
        read = np.array([is_read(name) for name in measured.channels])
        unsure, moves = np.zeros((len(measured.runs), len(lines), int(np.sum(read)))), slice(None)
        if not np.all(read):  # one motion is told, and of the others how large they may be
            driven = MOTIONS.index(measured.axes[0])
            moves, across = slice(driven, driven + 1), [k for k in range(len(MOTIONS)) if k != driven]
            size = measured.noise[:, lines][:, :, ~read].max(axis=2, keepdims=True)
            unsure = size * np.linalg.norm(rows[:, :, read][..., across], axis=-1)
        y, noise = measured.values[:, lines][:, :, read], measured.noise[:, lines][:, :, read]
        p = consensus(rows[:, :, read, moves], y, ~measured.judged[read])
        quantity = {channel.name: channel.quantity for channel in one.tested.campaign.table.channels}
        channels = tuple(name for name, kept in zip(measured.channels, read, strict=True) if kept)
        return cls(
            name=measured.name,
            channels=channels,
            quantities=tuple(quantity[name] for name in channels),
            lines=len(lines),
            reading=y.reshape(-1, len(channels)),
            expected=p.reshape(-1, len(channels)),
            noise=noise.reshape(-1, len(channels)),
            unsure=unsure.reshape(-1, len(channels)),
        )

    def of_channels(self, quantities: Mapping[str, str]) -> "LowFrequencyReadings":
        """The same in the channels of `quantities`; of those that it has not it tells nothing."""
        names = tuple(quantities)
        if names == self.channels:
            return self
        at, m = [names.index(name) for name in self.channels], len(self.reading)
        reading, expected = np.zeros((2, m, len(names)), dtype=np.complex128)
        noise, unsure = np.full((2, m, len(names)), UNHEARD)
        reading[:, at], expected[:, at], noise[:, at], unsure[:, at] = self.reading, self.expected, self.noise, self.unsure
        types, one = tuple(quantities.values()), replace(self, channels=names, reading=reading, expected=expected)
        return replace(one, quantities=types, noise=noise, unsure=unsure)

    @property
    def level(self) -> Array:
        """(m, c) what each channel should read, never nothing."""
        return np.asarray(np.hypot(level(self.expected[None])[0], self.unsure))


def distance(y: ComplexArray, p: ComplexArray) -> Array:
    """(..., c) of readings y (..., r, n, c) from what they should be, 0 to 1; every run counts, loud or not."""
    size = level(p)
    off, read, due = (np.linalg.norm(one / size, axis=(-3, -2)) for one in (y - p, y, p))
    return np.asarray(off / np.maximum(read + due, TINY))


def level(p: ComplexArray) -> Array:
    """(..., r, n, c) of what channels should read, never nothing."""
    usual = np.sqrt(np.mean(np.abs(p) ** 2, axis=(-3, -2), keepdims=True))
    least = np.maximum(ROUNDING * usual.max(axis=-1, keepdims=True), TINY)
    return np.asarray(np.maximum(np.hypot(np.abs(p), FAINT * usual), least))


def consensus(A: ComplexArray, y: ComplexArray, moved: npt.NDArray[np.bool_]) -> ComplexArray:
    """(r, n, c) what the channels should read, A (r or 1, n, c, k), by the motion on which most of them agree.

    It is that of the k channels whose motion the others contradict least, estimated again from all that are near it. The motions
    are six, or the driven one alone where nobody measured the others.
    """
    every, inputs = np.arange(len(moved)), A.shape[-1]
    sets = np.vstack([_drawn(every[moved], inputs), _drawn(every, inputs)])
    # Condition numbers of the rows of each set, rows and columns of one size
    size = np.linalg.norm(A[0, 0], axis=1, keepdims=True)
    even = A[0, 0] / np.maximum(size, ROUNDING * size.max())
    even = even / np.maximum(np.linalg.norm(even, axis=0), TINY)
    values = np.linalg.svd(even[sets], compute_uv=False)
    sets = sets[(values[:, -1] > ROUNDING) & (values[:, 0] / np.maximum(values[:, -1], TINY) < CONDITION)]
    if len(sets):
        p, least = np.zeros_like(y), np.inf
        for part in np.array_split(sets, max(1, len(sets) // PORTION)):
            of_sets = np.linalg.inv(A[:, :, part].transpose(2, 0, 1, 3, 4)) @ y[:, :, part].transpose(2, 0, 1, 3)[..., None]
            told = (A @ of_sets)[..., 0]
            d = distance(y, told) ** 2
            cost = np.sum(d / (d + DISTANT**2), axis=1)
            if cost.min() < least:
                p, least = told[int(np.argmin(cost))], float(cost.min())
    else:
        weight = 1 / np.maximum(np.linalg.norm(A, axis=-1), TINY)
        p = (A @ (np.linalg.pinv(weight[..., None] * A) @ (weight * y)[..., None]))[..., 0]
    for _ in range(ROUNDS):
        near = distance(y, p) < NEAR
        weight = near / np.maximum(np.sqrt(np.mean(np.abs(p) ** 2, axis=(0, 1))), TINY)
        if np.linalg.matrix_rank(weight[:, None] * A[0, 0]) < inputs:
            break
        p = (A @ (np.linalg.pinv(weight[:, None] * A) @ (weight * y)[..., None]))[..., 0]
    return np.asarray(p)


def _drawn(channels: npt.NDArray[np.int64], count: int) -> npt.NDArray[np.int64]:
    """(DRAWS, count) sets of so many of them; always the same, so that a diagnosis can be repeated."""
    if len(channels) < count:
        return np.zeros((0, count), dtype=np.int64)
    generator = np.random.default_rng(0)
    return np.stack([generator.choice(channels, count, replace=False) for _ in range(DRAWS)])


OFF = 0.15
"""[share] by which readings may be off for other reasons. Held by test_mistakes.py."""

LEAST_VARIANCE = 1e-30
"""[1] of a reading without noise held against nothing, in the square of its unit. Exercised by test_mistakes.py."""

SIGN_PENALTY = 8.0
"""[nats] Prior penalty of a wrong sign. Exercised by test_mistakes.py."""

UNIT_PENALTY = 10.0
"""[nats] Prior penalty of a known unit. Held by test_mistakes.py."""

FACTOR_PENALTY = 16.0
"""[nats] Prior penalty of a factor that is no unit. Exercised by test_mistakes.py."""

PLUG_PENALTY = 6.0
"""[nats] Prior penalty of a channel that reads another's plug. Exercised by test_mistakes.py."""

SURE = 20.0
"""[nats] below which a mistake is none; also what one campaign must have against a mistake of another to contradict it. Held by
test_mistakes.py."""

USUAL = 2.5
"""[factor] Nearer to 1 than this a factor is a gain. Held by test_mistakes.py."""

SNAP = 0.2
"""[log] How far the factor that fits best may lie from that of a unit to be it. Held by test_mistakes.py."""


ROUNDING = 1e-8
"""[share] of the largest row below which a channel hears of no motion but by rounding. Held by test_single_axis.py."""

TINY = float(np.finfo(np.float64).tiny)


@dataclass(frozen=True, kw_only=True)
class ChannelSource:
    """What one channel of the files holds: the signal of the sensor `plug`, times `factor`.

    Attributes
    ----------
    channel, plug : indices
    factor : 1 where nothing is wrong
    units : (taken for, is) where a unit has that factor
    gain : [nats] over the channel as it says it is
    """

    channel: int
    plug: int
    factor: float
    units: tuple[str, str]
    gain: float

    @property
    def is_right(self) -> bool:
        """Whether it is as it should be."""
        return self.channel == self.plug and self.factor == 1

    def distance(self, every: Sequence[LowFrequencyReadings]) -> float:
        """Of the reading from what it is said to hold, over all campaigns; each line in units of its level.

        What is lost in twice its noise is near to all that is, too; but of a unit a reading must be seen.
        """
        if not self.factor:  # of a reading of nothing, as of a pilot that was not read
            return 1.0
        size, c, d = abs(self.factor), self.channel, self.plug
        units = [np.hypot(of.level[:, d], 2 * np.hypot(of.noise[:, c] / size, of.unsure[:, d])) for of in every]
        y = np.concatenate([of.reading[:, c] / unit for of, unit in zip(every, units, strict=True)]) / self.factor
        p = np.concatenate([of.expected[:, d] / unit for of, unit in zip(every, units, strict=True)])
        whole = max(float(np.linalg.norm(y) + np.linalg.norm(p)), np.sqrt(len(p)) if size == 1 else TINY)
        return float(np.linalg.norm(y - p) / whole)


@dataclass(frozen=True, eq=False, kw_only=True)
class _KnownFactors:
    """Factors between the units of a channel's quantity, that of the channel table among them where it can."""

    values: Array
    units: tuple[tuple[str, str], ...]

    def nearest(self, size: float) -> int | None:
        """Index of the factor that `size` is; None where it is none of them."""
        off = np.abs(np.log(self.values) - np.log(size)) if len(self.values) else np.array([np.inf])
        nearest = int(np.argmin(off))
        return nearest if off[nearest] < SNAP else None


def mistakes(data: Study) -> tuple[Cause, ...]:
    """Wrong signs, exchanged plugs and wrong units, in the order in which effects of a model say them; none where there are none.

    All of them hold together, and in all campaigns: signs belong to sensors, units to what the files say. A channel that no
    factor and no exchange brings near is not among them.

    Raises
    ------
    CheckFailed : a mistake of one campaign that another contradicts.
    """
    if data.tests:
        of_tests = mistakes_of_tests(data)
        return of_tests if not data.made else (*of_tests, *mistakes(replace(data, tests=())))
    if not data.made:
        return ()
    every = [LowFrequencyReadings.of(one.with_effects(data.model.effects)) for one in data.made]
    quantities = {name: quantity for one in every for name, quantity in zip(one.channels, one.quantities, strict=True)}
    every, channels = [one.of_channels(quantities) for one in every], tuple(quantities)
    tables = {channel.name: channel for one in data.made for channel in one.tested.campaign.table.channels}
    table = replace(data.made[0].tested.campaign.table, channels=tuple(tables.values()))
    units = [one for one in candidates(table) if one.kind == "unit" and len(one.channels) == 1]
    of = {name: [one for one in units if one.channels == (name,)] for name in channels}
    known = tuple(
        _KnownFactors(values=np.array([one.factor for one in of[n]]), units=tuple(one.units for one in of[n])) for n in channels
    )
    taken = _sources(every, known)
    for one in every if len(every) > 1 else ():
        # Refuse a mistake of campaign `one` that another contradicts
        for source in _sources([one], known):
            for other in every:
                right = _likelihood([other], source.channel, source.channel, 1.0)
                wrong = _likelihood([other], source.channel, source.plug, source.factor)
                if not source.is_right and right - wrong > SURE:
                    channel, plug = one.channels[source.channel], one.channels[source.plug]
                    holds = f"{channel} reads as expected" if plug == channel else f"{channel} holds the signal of {plug}"
                    what = holds if source.factor == 1 else f"{holds} times {source.factor:.4g}"
                    raise CheckFailed(
                        f"the campaigns contradict one another: in {one.name} {what}, in {other.name} it is as the file says; "
                        f"correct that campaign alone (`massline correct`), or leave it out",
                        evidence_nats={one.name: source.gain, other.name: right - wrong},
                    )
    taken = _of_accelerometers(taken, every[0], known)
    return tuple(_told(taken, channels))


def _told(taken: Sequence[ChannelSource], channels: Sequence[str]) -> list[Cause]:
    """Signs of sensors, then plugs, then units of the files."""
    causes = [_cause("polarity", (channels[one.plug],), one.gain) for one in taken if one.factor < 0]
    at = list(range(len(taken)))
    for c, each in enumerate(taken):
        if at[c] != each.plug:  # exchanges of two, one after the other, bring every plug where it was found
            swapped = at.index(each.plug)
            at[c], at[swapped] = at[swapped], at[c]
            causes.append(_cause("channel-swap", (channels[c], channels[swapped]), each.gain + taken[swapped].gain))
    wrong = (each for each in taken if abs(each.factor) != 1)
    return causes + [_unit_cause(channels[one.channel], abs(one.factor), one.units, one.gain) for one in wrong]


def _sources(every: Sequence[LowFrequencyReadings], known: Sequence[_KnownFactors]) -> tuple[ChannelSource, ...]:
    """What each channel holds, by all campaigns together."""
    of, count = every[0], len(every[0].channels)
    best = np.full((count, count), -np.inf)  # an accelerometer never holds a force
    factors, units = np.ones((count, count)), np.full((count, count), -1)
    for c, d in product(range(count), range(count)):
        if of.quantities[c] != of.quantities[d]:
            continue
        # The factor between reading c and what channel d should read, if that is more than it may be off by; of known ones which
        products = [(one.reading[:, c], one.expected[:, d], np.hypot(one.level[:, d], one.noise[:, c])) for one in every]
        above = sum(float(np.sum((y * p.conj()).real / level**2)) for y, p, level in products)
        below = sum(float(np.sum(np.abs(p) ** 2 / level**2)) for _, p, level in products)
        seen = any(
            np.linalg.norm(p / level) >= np.linalg.norm(one.unsure[:, d] / level)
            for one, (_, p, level) in zip(every, products, strict=True)
        )
        k = above / max(below, TINY) if seen else 1.0
        sign, size = (-1.0 if k < 0 else 1.0), max(abs(k), TINY)
        price = SIGN_PENALTY * (k < 0) + PLUG_PENALTY * (c != d)
        if abs(np.log(size)) < np.log(USUAL):
            factors[c, d] = sign
        elif (unit := known[c].nearest(size)) is not None:
            factors[c, d], units[c, d] = sign * float(known[c].values[unit]), unit
            price += UNIT_PENALTY
        else:
            factors[c, d] = k
            price += FACTOR_PENALTY
        best[c, d] = _likelihood(every, c, d, factors[c, d]) - price
    right = np.array([_likelihood(every, c, c, 1.0) for c in range(count)])
    stays = right >= np.diagonal(best)
    for c in np.flatnonzero(stays).tolist():
        best[c, c], factors[c, c], units[c, c] = right[c], 1.0, -1
    plugs = best.argmax(axis=1)
    if len(set(plugs.tolist())) < count:  # two channels want one plug
        from scipy.optimize import linear_sum_assignment

        _, plugs = linear_sum_assignment(-best)
    taken = [
        ChannelSource(
            channel=c,
            plug=int(d),
            factor=float(factors[c, d]),
            units=known[c].units[units[c, d]] if units[c, d] >= 0 else ("", ""),
            gain=float(best[c, d] - right[c]),
        )
        for c, d in enumerate(plugs)
    ]
    # Without cycles of plugs, and factors, that are not told or do not bring a reading near
    left = set(range(count))
    while left:
        cycle = [min(left)]
        while (at := taken[cycle[-1]].plug) != cycle[0]:
            cycle.append(at)
        left -= set(cycle)
        near = all(taken[c].distance(every) < NEAR for c in cycle)
        if sum(taken[c].gain for c in cycle) < SURE or not near:
            for c in cycle:
                taken[c] = ChannelSource(channel=c, plug=c, factor=1.0, units=("", ""), gain=0.0)
    return tuple(taken)


def _likelihood(every: Sequence[LowFrequencyReadings], c: int, d: int, factor: float) -> float:
    """[nats] That channel c holds `factor` times what channel d should read."""
    found = 0.0
    for one in every:
        due = factor * np.hypot(one.unsure[:, d], OFF * one.level[:, d])
        variance = np.maximum(one.noise[:, c] ** 2 + due**2, LEAST_VARIANCE)
        off = np.abs(one.reading[:, c] - factor * one.expected[:, d]) ** 2
        found -= float(np.sum(off / variance + np.log(variance))) / one.lines
    return found


def _of_accelerometers(
    taken: tuple[ChannelSource, ...], of: LowFrequencyReadings, known: Sequence[_KnownFactors]
) -> tuple[ChannelSource, ...]:
    """What all load cells share and no unit explains may be the inverse of what all accelerometers share.

    H alone cannot tell the two; a unit that explains the latter can.
    """
    moved = [c for c, quantity in enumerate(of.quantities) if quantity == "acceleration"]
    felt = [c for c in range(len(taken)) if c not in moved]
    if not felt:
        return taken
    sizes = np.log([abs(taken[c].factor) for c in felt])
    size = float(np.exp(np.median(sizes)))
    shared = np.ptp(sizes) <= SNAP and not any(taken[c].units[0] for c in felt) and all(taken[c].factor == 1 for c in moved)
    unit = known[moved[0]].nearest(1 / size) if shared and size != 1 else None
    if unit is None:
        return taken
    gain = sum(taken[c].gain for c in felt) / len(moved)
    return tuple(
        replace(one, factor=float(known[c].values[unit]), units=known[c].units[unit], gain=gain)
        if c in moved
        else replace(one, factor=float(np.sign(one.factor)), gain=0.0)
        for c, one in enumerate(taken)
    )


# Tests of a structure by itself: what all channels of a line, or of a mode, read beside what a nominal model says, but for the
# one factor that they have in common. Damping and the height of a peak are in that factor; signs, plugs, units, directions and
# places of single channels are not. Frequencies of the model are first brought to those of the test, peak by peak.

WARPED = 0.15
"""[log] Difference of two frequencies up to which their peaks are one. Held by test_mistakes_of_tests.py."""

LEAST_PEAK = 1.0
"""[log] Height of a peak over its surroundings, in the mean of all functions. Exercised by test_mistakes_of_tests.py."""

ROWS = 240
"""[count] of lines of a test that are looked at. Exercised by test_mistakes_of_tests.py."""

FAR = 0.5
"""[share] Distance of a reading from its due from which another point is sought. Exercised by test_mistakes_of_tests.py."""

INDEPENDENT = 4
"""[count] of lines of functions, or of modes, that say something of their own where a band has no more. Exercised by
test_mistakes_of_tests.py."""

SCATTERED = 4.0
"""[factor] On the median of how far the readings of a test lie from what they should, up to which each may. Held by
test_mistakes_of_tests.py."""

MOST_SWAPPED = 12
"""[count] of channels up to which every exchange of two is tried by itself. Exercised by test_mistakes_of_tests.py."""

FEWEST_CHANNELS = 3
"""[count] of channels below which nobody tells which of them is wrong. By definition."""


def mistakes_of_tests(data: Study) -> tuple[Cause, ...]:
    """Wrong signs, exchanged plugs, wrong units, directions, places and references of response functions and tables of modes.

    A mistake of a channel that several tests have must be in all of them: effects act by the name of a channel.
    """
    from identification.campaign import UNITS

    tests = [one.with_effects(data.model.effects) for one in data.tests]
    named = [set(one.measured.channels) for one in tests]
    found: list[list[Cause]] = []
    for one in tests:
        if isinstance(one, ResponseFunctionTest):
            found.append(_of_functions(one, UNITS))
        elif isinstance(one, TableShapes):
            found.append(_of_shapes(one, UNITS))
        else:
            found.append([])
    said = [{cause.id for cause in causes} for causes in found]
    kept: dict[str, Cause] = {}
    for causes in found:
        for cause in causes:
            others = [ids for ids, channels in zip(said, named, strict=True) if cause.named.target in channels]
            if all(cause.id in ids for ids in others):
                kept.setdefault(cause.id, cause)
    order = ("polarity", "channel-swap", "wrong-direction", "wrong-place", "wrong-reference", "unit")
    return tuple(sorted(kept.values(), key=lambda one: order.index(one.named.family)))


def _of_shapes(one: TableShapes, units: Mapping[str, Mapping[str, float]]) -> list[Cause]:
    """Of shapes, whose modes are paired with those of the model by shape and frequency, or by frequency alone where that leaves
    far less: a mistake may have made one mode look like another."""
    y, noise = one.measured.values[:, 0], one.measured.noise[:, 0]
    causes, least = list[Cause](), np.inf
    for of in (one, replace(one, table=replace(one.table, shapes=None))):
        found = _of_channels(of, y, noise, units, lambda paired: paired.at({}), together=of.together)
        acting = (*one.effects, *(Added(named=cause.named, fixed=True) for cause in found))
        rows = np.array(one.with_effects(acting).at({}, derivatives=False).rows[:, 0, :, 0])
        for group, mix in mixes(y, rows, of.together):
            rows[group] = mix @ rows[group]
        left = float(np.sum(1 - np.array([mac(a, b).item() for a, b in zip(y, rows, strict=True)])))
        if left < least / 2:
            causes, least = found, left
    return causes


def _of_functions(one: ResponseFunctionTest, units: Mapping[str, Mapping[str, float]]) -> list[Cause]:
    """Of response functions."""
    measured = one.measured
    lines = np.unique(np.linspace(0, len(measured.frequency) - 1, ROWS).round().astype(np.int64))
    y, noise = measured.values[:, lines], measured.noise[:, lines]

    def at(of: ResponseFunctionTest, frequency: Array) -> ResponseFunctionTest:
        whole = np.zeros((len(y), len(frequency), y.shape[2]))
        moved = replace(measured, frequency=frequency, values=whole.astype(np.complex128), noise=whole + 1.0)
        return replace(of, measured=replace(moved, inputs=np.ones((len(y), len(frequency), 1), dtype=np.complex128)))

    def predicted(of: ResponseFunctionTest, frequency: Array) -> ComplexArray:
        return np.asarray(at(of, frequency).at({}, derivatives=False).rows[..., 0])

    wide = np.geomspace(measured.frequency[0] * np.exp(-WARPED), measured.frequency[-1] * np.exp(WARPED), 4 * ROWS)
    warped = _warped(measured.frequency, measured.values, wide, predicted(one, wide))(measured.frequency[lines])
    c = y.shape[2]

    def with_causes(causes: Sequence[Cause]) -> ResponseFunctionTest:
        return one.with_effects((*one.effects, *(Added(named=cause.named, fixed=True) for cause in causes)))

    f, low, high = one.structure.frequency, measured.frequency[0], measured.frequency[-1]
    modes = max(INDEPENDENT, int(np.sum((f >= low) & (f <= high))))  # each has a shape of its own
    causes = _of_channels(one, y.reshape(-1, c), noise.reshape(-1, c), units, lambda of: at(of, warped).at({}), modes)
    p = predicted(with_causes(causes), warped)
    for r, drive in enumerate(one.drives):
        # The factor of a line would hide where the force acted: here its sign counts
        stated = _apart(y[r], p[r])
        if stated < NEAR:
            continue
        trials = {}
        for name in (point.name for point in one.responses if point.name != drive.name):
            named = Named(family="wrong-reference", targets=(drive.name, name), values={"": 1.0})
            rows = predicted(with_causes((*causes, _cause(named.family, named.targets, 0.0, named.values))), warped)[r]
            trials[name] = (_apart(y[r], rows), rows)
        best = min(trials, key=lambda name: trials[name][0], default="")
        if best and trials[best][0] < min(NEAR, stated / 2):
            nats = float((stated**2 - trials[best][0] ** 2) / OFF**2 * max(2, c))
            causes.append(_cause("wrong-reference", (drive.name, best), nats, {"": 1.0}))
            p = np.concatenate([p[:r], trials[best][1][None], p[r + 1 :]])
    loud = np.sqrt(np.mean(np.abs(p) ** 2, axis=2)).ravel() > TINY
    ratio = np.sum(y * p.conj(), axis=2).ravel()[loud] / np.sum(np.abs(p) ** 2, axis=2).ravel()[loud]
    if one.scale is None and np.all(np.abs(ratio) > TINY):
        # What all channels share is the force's, unless it is a unit of acceleration
        size, sign = float(np.exp(np.median(np.log(np.abs(ratio))))), float(np.mean(ratio.real / np.abs(ratio)))
        if sign < -FAR:
            causes.append(_cause("polarity", (FORCE_CHANNEL,), SURE + SIGN_PENALTY * len(measured.runs)))
        if abs(np.log(size)) > np.log(USUAL):
            of_force, of_motion = (_units_of(units[quantity]) for quantity in ("force", "acceleration"))
            if (unit := of_force.nearest(1 / size)) is not None:
                causes.append(_unit_cause(FORCE_CHANNEL, float(of_force.values[unit]), of_force.units[unit], SURE))
            elif (unit := of_motion.nearest(size)) is not None:
                value, pair = float(of_motion.values[unit]), of_motion.units[unit]
                causes += [_unit_cause(name, value, pair, SURE) for name in measured.channels]
    return causes


def tolerated(due: Predicted, parameters: Sequence[Parameter], together: Sequence[Sequence[int]] = ()) -> Array:
    """(r, n, c) [sd] by how much tolerances may change what channels should read, but for the factor that all of a line share,
    and for what modes `together`, in rows of one line, are mixed by.

    What a channel reads by its slant alone, or where parts that should be alike are not, tells nothing of its sign or unit.
    """
    p = due.rows[..., 0]
    own = p / np.maximum(np.linalg.norm(p, axis=-1, keepdims=True), TINY)
    square, spans = np.zeros(p.shape), [(group, np.linalg.qr(p[group, 0].T)[0]) for group in map(list, together)]
    for one in parameters:
        if one.name in due.changes and np.isfinite(one.tolerance):
            change, moved = due.changes[one.name], np.zeros_like(p)
            moved[..., list(change.channels)] = one.tolerance * change.rows[..., 0]
            moved -= own * np.sum(moved * own.conj(), axis=-1, keepdims=True)
            for group, span in spans:
                moved[group, 0] -= moved[group, 0] @ span.conj() @ span.T
            square += np.abs(moved) ** 2
    return np.asarray(np.sqrt(square))


def _apart(y: ComplexArray, p: ComplexArray) -> float:
    """Distance, 0 to 1, of readings y (n, c) of one run from p, of either sign: 1 less the mean cosine between them."""
    above = np.sum(y * p.conj(), axis=1).real
    below = np.linalg.norm(y, axis=1) * np.linalg.norm(p, axis=1)
    return float(1 - abs(np.mean(above / np.maximum(below, TINY))))


def _warped(f: Array, y: ComplexArray, wide: Array, p: ComplexArray) -> Callable[[Array], Array]:
    """Where the model has what the test has at a frequency, by the peaks of the mean level of all functions."""
    from scipy.signal import find_peaks

    def level(values: ComplexArray) -> Array:
        size = np.log(np.maximum(np.abs(values), TINY))
        return np.asarray(np.mean(size - np.median(size, axis=1, keepdims=True), axis=(0, 2)))

    of_test, of_model = level(y), level(p)
    ours, theirs = (np.log(axis[find_peaks(of, prominence=LEAST_PEAK)[0]]) for axis, of in ((f, of_test), (wide, of_model)))
    logs = np.log(wide)
    shifts = np.linspace(-WARPED, WARPED, 61)
    on = np.linspace(np.log(f[0]), np.log(f[-1]), ROWS)
    seen = np.interp(on, np.log(f), of_test)
    scores = [float(np.corrcoef(seen, np.interp(on + shift, logs, of_model))[0, 1]) for shift in shifts]
    whole = float(shifts[int(np.argmax(scores))]) if max(scores) > 0 else 0.0
    knots = {float(np.log(f[0])): whole, float(np.log(f[-1])): whole}
    if len(ours) and len(theirs):
        from scipy.optimize import linear_sum_assignment

        apart = np.abs(theirs[None] - ours[:, None] - whole)
        for i, k in zip(*linear_sum_assignment(np.minimum(apart, WARPED)), strict=True):
            if apart[i, k] < WARPED:
                knots[float(ours[i])] = float(theirs[k] - ours[i])
    places = np.array(sorted(knots))
    moved = np.maximum.accumulate(places + np.array([knots[x] for x in places]))
    return lambda at: np.asarray(np.exp(np.interp(np.log(at), places, moved)))


def _units_of(sizes: Mapping[str, float], *, either: bool = False) -> _KnownFactors:
    """Factors of numbers that are in another unit than the SI one, or of `either`: in the SI one and taken for another."""
    si = next(unit for unit, size in sizes.items() if size == 1)
    pairs = [(1 / size, (si, unit)) for unit, size in sizes.items() if size != 1]
    pairs += [(1 / factor, (unit, si)) for factor, (_, unit) in pairs if either]
    return _KnownFactors(values=np.array([factor for factor, _ in pairs]), units=tuple(units for _, units in pairs))


def _unit_cause(channel: str, value: float, units: tuple[str, str], nats: float) -> Cause:
    said, true = units
    half = 0.0 if said else NORMAL_90 * OFF * value
    size = EffectEstimate(key="", value=value, unit="1", low=value - half, high=value + half)
    note = f"its numbers are in {true}, and were taken for {said}" if said else ""
    return _cause("unit", (channel,), nats, {"": value}, (size,), note)


def _of_channels(
    one: ResponseFunctionTest | TableShapes,
    y: ComplexArray,
    noise: Array,
    units: Mapping[str, Mapping[str, float]],
    read: Callable[[Any], Predicted],
    independent: int = INDEPENDENT,
    together: Sequence[list[int]] = (),
) -> list[Cause]:
    """Mistakes of single channels in readings y (m, c), of which `read` says what a model expects of them; so many of m are
    `independent`, and those `together` may be any mix of what is expected of them."""
    c, names = y.shape[1], one.measured.channels
    if c < FEWEST_CHANNELS:
        return []

    stated = y

    def expected(of: ResponseFunctionTest | TableShapes) -> tuple[ComplexArray, Array]:
        due = read(of)
        p, unsure = np.array(due.rows[..., 0]).reshape(-1, c), tolerated(due, of.parameters, together).reshape(-1, c)
        for group, mix in mixes(stated, p, together):
            p[group], unsure[group] = mix @ p[group], np.sqrt(np.abs(mix) ** 2 @ unsure[group] ** 2)
        return p, unsure

    p, unsure = expected(one)
    size = np.sqrt(np.mean(np.abs(p) ** 2, axis=1, keepdims=True))
    kept = size[:, 0] > TINY
    y, p, noise, unsure = y[kept] / size[kept], p[kept] / size[kept], noise[kept] / size[kept], unsure[kept] / size[kept]
    factors = _shared_factor(y, p)
    scaled = y / factors[:, None]
    # By how much a sound model is off may be far less than is allowed for; most channels say it
    scatter = SCATTERED * float(np.median(np.abs(scaled - p)))
    most = min(scatter, OFF) if isinstance(one, TableShapes) else np.inf  # a unit makes all others of a shape faint
    readings = LowFrequencyReadings(
        name=one.measured.name,
        channels=names,
        quantities=("acceleration",) * c,
        lines=max(1, len(scaled) // independent),
        reading=scaled,
        expected=p,
        noise=np.minimum(noise / np.abs(factors)[:, None], most),
        unsure=unsure,
    )
    known = (_units_of(units["acceleration"], either=True),) * c
    taken = _sources([readings], known)
    causes = _told(taken, names)
    distances = [each.distance([readings]) for each in taken]
    # By what the others read, the model must be right: channels that hardly move agree with anything
    squares, agree = np.mean(np.abs(p) ** 2, axis=0), np.array(distances) < NEAR
    for k, (each, away) in enumerate(zip(taken, distances, strict=True)):
        rest = np.arange(c) != k
        if not each.is_right or away < NEAR or squares[rest & agree].sum() < FAR * squares[rest].sum():
            continue
        # Another direction, or another place, and either sign
        right = _likelihood([readings], k, k, 1.0)
        found: dict[tuple[str, str], tuple[float, bool]] = {}
        for family, words in (("wrong-direction", "xyz"), ("wrong-place", tuple(one.there.places))):
            for word in words:
                named = Named(family=family, targets=(names[k], word), values={"": 1.0})
                other = one.with_effects((*one.effects, Added(named=named, fixed=True)))
                rows, beside = (all_of[kept] / size[kept] for all_of in expected(other))
                trial = replace(readings, expected=np.where(rest, p, rows), unsure=np.where(rest, unsure, beside))
                is_stated = np.allclose(trial.expected, p)
                which = ("polarity", "") if is_stated else (family, word)
                for sign in (1.0, -1.0):
                    source = replace(each, factor=sign)
                    nats = _likelihood([trial], k, k, sign) - right - PLUG_PENALTY - SIGN_PENALTY * (sign < 0)
                    if source.distance([trial]) < NEAR and nats > max(SURE, found.get(which, (0.0, False))[0]):
                        found[which] = (nats, sign < 0 and not is_stated)
        if found:
            family, word = max(found, key=lambda key: found[key][0])
            nats, inverted = found[family, word]
            near = (key for key, own in found.items() if own[0] > nats - INDISTINGUISHABLE_NATS)
            alike = sorted(f"{key[0]}:{names[k]}:{key[1]}".rstrip(":") for key in near)
            cause = _cause(family, (names[k], word), nats, {"": 1.0}) if word else _cause(family, (names[k],), nats)
            alike.remove(cause.id)
            note = f"{' and '.join(alike)} would read the same" if alike else ""
            causes.append(replace(cause, same=tuple(alike), note=note))
            if inverted:
                causes.append(_cause("polarity", (names[k],), SURE))
    return causes


def _shared_factor(y: ComplexArray, p: ComplexArray) -> ComplexArray:
    """(m,) y / p of every row that most channels of `y` (m, c) agree on: by the one channel of a row that the others contradict
    least, or over all rows by all channels but one or two."""
    costs, told = [], []
    for k in range(y.shape[1]):
        ratio = y[:, k] / np.where(np.abs(p[:, k]) > TINY, p[:, k], TINY)
        weight = np.abs(p[:, k]) > FAINT
        due = np.abs(ratio[:, None]) * np.maximum(np.abs(p), FAINT)  # what should read next to nothing votes for no factor
        off = np.abs(y - ratio[:, None] * p) / np.maximum(np.abs(y) + due, TINY)
        costs.append(np.where(weight, np.sum(off**2 / (off**2 + DISTANT**2), axis=1), np.inf))
        told.append(np.where(np.abs(ratio) > TINY, ratio, 1.0))
    factors = [np.array(told)[np.argmin(costs, axis=0), np.arange(len(y))]]
    every = range(y.shape[1])
    for left_out in [(k,) for k in every] + (list(combinations(every, 2)) if len(every) <= MOST_SWAPPED else []):
        factors.append(_over(y, p, ~np.isin(every, left_out)))

    def contradicted(factor: ComplexArray) -> tuple[int, float]:
        d = distance((y / factor[:, None])[None], p[None])
        return int(np.sum(d >= NEAR)), float(np.sum(d**2 / (d**2 + DISTANT**2)))

    factor = min(factors, key=contradicted)
    for _ in range(ROUNDS):  # again from all that are near, over all rows
        near = distance(y[None] / factor[None, :, None], p[None]) < NEAR
        if not np.any(near):
            break
        factor = _over(y, p, near)
    return np.asarray(factor)


def _over(y: ComplexArray, p: ComplexArray, kept: npt.NDArray[np.bool_]) -> ComplexArray:
    """(m,) y / p of every row by the channels that are `kept` (c,), in least squares."""
    factor = np.sum(y[:, kept] * p[:, kept].conj(), axis=1) / np.maximum(np.sum(np.abs(p[:, kept]) ** 2, axis=1), TINY)
    return np.asarray(np.where(np.abs(factor) > TINY, factor, 1.0))


def _cause(
    family: str,
    targets: tuple[str, ...],
    evidence: float,
    values: Mapping[str, float] = MappingProxyType({}),
    sizes: tuple[EffectEstimate, ...] = (),
    note: str = "",
) -> Cause:
    return Cause(named=Named(family=family, targets=targets, values=values), sizes=sizes, evidence=evidence, note=note)


# A diagnosis of data with discrete mistakes: they are taken out first, and told with whatever else is found.
