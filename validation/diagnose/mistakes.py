"""Discrete mistakes - a wrong sign, two plugs exchanged, a unit taken for another - which are looked for before any fit.

Every reading y_c of `validation.diagnose.mistakes` is held against what *every* channel of its quantity should read, times every
factor that a mistake can bring: y_c = k p_d. The assignment of readings to channels that is likeliest as a whole, at a price for
every mistake, says all of them at once: a cycle of three plugs as well as eight cells in kilonewtons.

    log L = -|y - k p|² / sigma² - log sigma² ,   sigma = |k| (OFF |p| + ...)

averaged over lines and added over runs, since what a nominal model has wrong does not average out. OFF is so wide that gains of
20 %, delays of milliseconds and pick-ups that sit 5 cm beside their place are no mistakes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import ComplexArray
from geometry.errors import CheckFailed
from geometry.frames import Array
from identification.consistency import candidates
from identification.quality import NORMAL_90
from validation.diagnose.accept import errors_without_fit
from validation.diagnose.diagnosis import (
    MISTAKE,
    NONLINEAR,
    NOTHING,
    Cause,
    Diagnosis,
    EffectEstimate,
    confirming,
    headline,
)
from validation.effects.catalogue import Named
from validation.model.model import Added
from validation.prediction.series import SeriesPrediction
from validation.study import Study

# `Heard`: what every channel of a campaign reads at its lowest lines, beside what all others and the model say it should read.
#
# There every structure is nearly a rigid body, so that the nominal model is right to some ten per cent, and a discrete mistake
# is wrong by hundreds. What moved is estimated from whichever six channels let most of the others agree: a channel that is
# wrong, or several, or all of one kind, then stands alone against the rest however wrong it is (random sample consensus,
# Fischler & Bolles, Communications of the ACM 24 (1981), 381). How far a reading lies from what it should be is told without any
# scale,
#
#     |y - p| / (|y| + |p|)     each line and run in units of what is usual there
#
# 0 where they agree, 0.1 for a gain of 20 %, 0.8 for g taken for m/s², 1 for a wrong sign.


REACH = 1.5
"""[factor] on the lowest line up to which lines are used. Exercised by tests/validation/diagnosing/test_mistakes.py."""

LINES = 4
"""[count] of those lines. Exercised by tests/validation/diagnosing/test_mistakes.py."""

MOTIONS_OF_A_PLATE = 6
"""[count] of motions of a rigid plate. By definition."""

DRAWS = 400
"""[count] of sets of six channels that are tried, of the accelerometers alone and of all channels. Exercised by
tests/validation/diagnosing/test_mistakes.py."""

CONDITION = 40.0
"""[1] Condition number of the rows of six channels beyond which they do not tell the motion. Exercised by
tests/validation/diagnosing/test_mistakes.py."""

DISTANT = 0.15
"""[share] Distance of a reading from what it should be at which it stops to count much. Exercised by
tests/validation/diagnosing/test_mistakes.py."""

NEAR = 0.25
"""[share] Distance within which a channel takes part in the final estimate: a gain of two thirds. Exercised by
tests/validation/diagnosing/test_mistakes.py."""

PORTION = 100
"""[count] of sets that are worked on at once; memory only. By definition."""

ROUNDS = 3
"""[count] of times that the final estimate is repeated with the channels that are near. Exercised by
tests/validation/diagnosing/test_mistakes.py."""

FAINT = 0.3
"""[share] of what a channel should read over all runs that counts as its level where it should read less. Exercised by
tests/validation/diagnosing/test_mistakes.py."""


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
    """

    name: str
    channels: tuple[str, ...]
    quantities: tuple[str, ...]
    lines: int
    reading: ComplexArray
    expected: ComplexArray
    noise: Array

    @property
    def level(self) -> Array:
        """(m, c) what each channel should read, never nothing."""
        return np.asarray(level(self.expected[None])[0])


def low_frequency_readings(one: SeriesPrediction) -> LowFrequencyReadings:
    """The lowest lines of `one`, by its model as it stands."""
    measured = one.measured
    low = np.flatnonzero(measured.frequency <= REACH * measured.frequency[0])
    lines = np.unique(np.linspace(low[0], low[-1], LINES).round().astype(np.int64))
    rows = one.at({parameter.name: parameter.start for parameter in one.parameters}, lines, derivatives=False).rows
    y = measured.values[:, lines]
    p = _consensus(rows if rows.ndim == 4 else rows[None], y, ~measured.judged)
    of = {channel.name: channel.quantity for channel in one.tested.campaign.table.channels}
    return LowFrequencyReadings(
        name=measured.name,
        channels=measured.channels,
        quantities=tuple(of[name] for name in measured.channels),
        lines=len(lines),
        reading=y.reshape(-1, y.shape[2]),
        expected=p.reshape(-1, y.shape[2]),
        noise=measured.noise[:, lines].reshape(-1, y.shape[2]),
    )


def distance(y: ComplexArray, p: ComplexArray) -> Array:
    """(..., c) of readings y (..., r, n, c) from what they should be, 0 to 1; every run counts, loud or not."""
    size = level(p)
    off, both = _norm((y - p) / size), _norm(y / size) + _norm(p / size)
    return np.asarray(off / np.maximum(both, TINY))


def level(p: ComplexArray) -> Array:
    """(..., r, n, c) of what channels should read, never nothing."""
    usual = np.sqrt(np.mean(np.abs(p) ** 2, axis=(-3, -2), keepdims=True))
    return np.asarray(np.maximum(np.hypot(np.abs(p), FAINT * usual), TINY))


def _norm(values: ComplexArray) -> Array:
    return np.asarray(np.linalg.norm(values, axis=(-3, -2)))


def _consensus(A: ComplexArray, y: ComplexArray, moved: npt.NDArray[np.bool_]) -> ComplexArray:
    """(r, n, c) what the channels should read, A (r or 1, n, c, 6), by the motion on which most of them agree."""
    p = _by_six(A, y, moved)
    for _ in range(ROUNDS):
        near = distance(y, p) < NEAR
        weight = near / np.maximum(np.sqrt(np.mean(np.abs(p) ** 2, axis=(0, 1))), TINY)
        if np.linalg.matrix_rank(weight[:, None] * A[0, 0]) < MOTIONS_OF_A_PLATE:
            break
        p = (A @ (np.linalg.pinv(weight[:, None] * A) @ (weight * y)[..., None]))[..., 0]
    return np.asarray(p)


def _by_six(A: ComplexArray, y: ComplexArray, moved: npt.NDArray[np.bool_]) -> ComplexArray:
    """The same by the six channels whose motion the others contradict least."""
    every = np.arange(len(moved))
    sets = np.vstack([_drawn(every[moved]), _drawn(every)])
    sets = sets[_condition(A[0, 0], sets) < CONDITION]
    if not len(sets):
        weight = 1 / np.maximum(np.linalg.norm(A, axis=-1), TINY)
        return np.asarray((A @ (np.linalg.pinv(weight[..., None] * A) @ (weight * y)[..., None]))[..., 0])
    best, least = np.zeros_like(y), np.inf
    for part in np.array_split(sets, max(1, len(sets) // PORTION)):
        of_sets = np.linalg.inv(A[:, :, part].transpose(2, 0, 1, 3, 4)) @ y[:, :, part].transpose(2, 0, 1, 3)[..., None]
        p = (A @ of_sets)[..., 0]
        d = distance(y, p) ** 2
        cost = np.sum(d / (d + DISTANT**2), axis=1)
        if cost.min() < least:
            best, least = p[int(np.argmin(cost))], float(cost.min())
    return np.asarray(best)


def _drawn(channels: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """(DRAWS, 6) sets of six of them; always the same, so that a diagnosis can be repeated."""
    if len(channels) < MOTIONS_OF_A_PLATE:
        return np.zeros((0, MOTIONS_OF_A_PLATE), dtype=np.int64)
    generator = np.random.default_rng(0)
    return np.stack([generator.choice(channels, MOTIONS_OF_A_PLATE, replace=False) for _ in range(DRAWS)])


def _condition(A: ComplexArray, sets: npt.NDArray[np.int64]) -> Array:
    """(k,) of the rows (c, 6) of each set, rows and columns of one size."""
    even = A / np.maximum(np.linalg.norm(A, axis=1, keepdims=True), TINY)
    even = even / np.maximum(np.linalg.norm(even, axis=0), TINY)
    sizes = np.linalg.svd(even[sets], compute_uv=False)
    return np.asarray(sizes[:, 0] / np.maximum(sizes[:, -1], TINY))


OFF = 0.15
"""[share] by which readings may be off for other reasons. Exercised by tests/validation/diagnosing/test_mistakes.py."""

SIGN_PENALTY = 8.0
"""[nats] Prior penalty of a wrong sign. Exercised by tests/validation/diagnosing/test_mistakes.py."""

UNIT_PENALTY = 10.0
"""[nats] Prior penalty of a known unit. Exercised by tests/validation/diagnosing/test_mistakes.py."""

FACTOR_PENALTY = 16.0
"""[nats] Prior penalty of a factor that is no unit. Exercised by tests/validation/diagnosing/test_mistakes.py."""

PLUG_PENALTY = 6.0
"""[nats] Prior penalty of a channel that reads another's plug. Exercised by tests/validation/diagnosing/test_mistakes.py."""

SURE = 20.0
"""[nats] below which a mistake is none; also what one campaign must have against a mistake of another to contradict it. Exercised
by tests/validation/diagnosing/test_mistakes.py."""

USUAL = 2.5
"""[factor] Nearer to 1 than this a factor is a gain. Exercised by tests/validation/diagnosing/test_mistakes.py."""

SNAP = 0.2
"""[log] How far the factor that fits best may lie from that of a unit to be it. Exercised by
tests/validation/diagnosing/test_mistakes.py."""


FAR = 0.25
"""[share] Distance, as of `distance`, at which a reading still is not what a mistake says: a gain of two thirds. Exercised by
tests/validation/diagnosing/test_mistakes.py."""

IMPOSSIBLE = -1e9
"""[nats] of an accelerometer that holds a force: never taken. Exercised by tests/validation/diagnosing/test_mistakes.py."""

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


def mistakes(data: Study) -> tuple[Cause, ...]:
    """Wrong signs, exchanged plugs and wrong units, in the order in which effects of a model say them; none where there are none.

    All of them hold together, and in all campaigns: signs belong to sensors, units to what the files say. A channel that no
    factor and no exchange brings near is not among them.

    Raises
    ------
    CheckFailed : a mistake of one campaign that another contradicts.
    """
    every = [low_frequency_readings(one.with_effects(data.model.effects)) for one in data.made]
    channels = every[0].channels
    units = [one for one in candidates(data.made[0].tested.campaign.table) if one.kind == "unit" and len(one.channels) == 1]
    of = {name: [one for one in units if one.channels == (name,)] for name in channels}
    known = tuple(
        _KnownFactors(values=np.array([one.factor for one in of[n]]), units=tuple(one.units for one in of[n])) for n in channels
    )
    found = _sources(every, known)
    for one in every if len(every) > 1 else ():
        # Refuse a mistake of campaign `one` that another contradicts
        for taken in _sources([one], known):
            for other in every:
                right, wrong = (
                    _likelihood([other], taken.channel, plug, factor)
                    for plug, factor in ((taken.channel, 1.0), (taken.plug, taken.factor))
                )
                if not taken.is_right and right - wrong > SURE:
                    channel, plug = one.channels[taken.channel], one.channels[taken.plug]
                    holds = (
                        f"{channel} holds the signal of {plug}" if taken.plug != taken.channel else f"{channel} reads as expected"
                    )
                    what = holds if taken.factor == 1 else f"{holds} times {taken.factor:.4g}"
                    raise CheckFailed(
                        f"the campaigns contradict one another: in {one.name} {what}, in {other.name} it is as the file says; "
                        f"correct that campaign alone (`massline correct`), or leave it out",
                        evidence_nats={one.name: taken.gain, other.name: right - wrong},
                    )
    return tuple(_causes(every[0].channels, _by_accelerometers(found, every[0], known)))


@dataclass(frozen=True, eq=False, kw_only=True)
class _KnownFactors:
    """Factors between the units of a channel's quantity, that of the channel table among them where it can."""

    values: Array
    units: tuple[tuple[str, str], ...]


def _sources(every: Sequence[LowFrequencyReadings], known: Sequence[_KnownFactors]) -> tuple[ChannelSource, ...]:
    """What each channel holds, by all campaigns together."""
    from scipy.optimize import linear_sum_assignment

    of, count = every[0], len(every[0].channels)
    best = np.full((count, count), IMPOSSIBLE)
    factors, units = np.ones((count, count)), np.full((count, count), -1)
    for c in range(count):
        for d in range(count):
            if of.quantities[c] == of.quantities[d]:
                factors[c, d], units[c, d], price = _factor(every, c, d, known[c])
                price += PLUG_PENALTY * (c != d)
                best[c, d] = _likelihood(every, c, d, factors[c, d]) - price
    right = np.array([_likelihood(every, c, c, 1.0) for c in range(count)])
    stays = right >= np.diagonal(best)
    best[stays, stays] = right[stays]
    for c in np.flatnonzero(stays).tolist():
        best[c, c], factors[c, c], units[c, c] = right[c], 1.0, -1
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
    return _certain(every, taken)


def _factor(every: Sequence[LowFrequencyReadings], c: int, d: int, known: _KnownFactors) -> tuple[float, int, float]:
    """The factor between reading c and what channel d should read, which of the known ones it is, else -1, and its price."""
    products = [(one.reading[:, c], one.expected[:, d], one.level[:, d]) for one in every]
    above = sum(float(np.sum((y * p.conj()).real / level**2)) for y, p, level in products)
    below = sum(float(np.sum(np.abs(p) ** 2 / level**2)) for _, p, level in products)
    k = above / max(below, TINY)
    sign, size = (-1.0 if k < 0 else 1.0), max(abs(k), TINY)
    price = SIGN_PENALTY * (k < 0)
    if abs(np.log(size)) < np.log(USUAL):
        return sign, -1, price
    off = np.abs(np.log(known.values / size)) if len(known.values) else np.array([np.inf])
    nearest = int(np.argmin(off))
    if off[nearest] < SNAP:
        return sign * float(known.values[nearest]), nearest, price + UNIT_PENALTY
    return float(k), -1, price + FACTOR_PENALTY


def _likelihood(every: Sequence[LowFrequencyReadings], c: int, d: int, factor: float) -> float:
    """[nats] That channel c holds `factor` times what channel d should read."""
    found = 0.0
    for one in every:
        variance = one.noise[:, c] ** 2 + (factor * OFF * one.level[:, d]) ** 2
        off = np.abs(one.reading[:, c] - factor * one.expected[:, d]) ** 2
        found -= float(np.sum(off / variance + np.log(variance))) / one.lines
    return found


def _certain(every: Sequence[LowFrequencyReadings], taken: Sequence[ChannelSource]) -> tuple[ChannelSource, ...]:
    """`taken` without cycles of plugs, and factors, that are not told or do not bring a reading near."""
    found = list(taken)
    for cycle in _cycles(taken):
        near = all(_distance_to(every, taken[c]) < FAR for c in cycle)
        if sum(taken[c].gain for c in cycle) < SURE or not near:
            for c in cycle:
                found[c] = ChannelSource(channel=c, plug=c, factor=1.0, units=("", ""), gain=0.0)
    return tuple(found)


def _cycles(taken: Sequence[ChannelSource]) -> Iterator[list[int]]:
    left = set(range(len(taken)))
    while left:
        first = min(left)
        cycle = [first]
        while (at := taken[cycle[-1]].plug) != first:
            cycle.append(at)
        left -= set(cycle)
        yield cycle


def _distance_to(every: Sequence[LowFrequencyReadings], one: ChannelSource) -> float:
    """Distance, over all campaigns, of a reading from what it is said to hold; each line in units of its level."""
    y = np.concatenate([of.reading[:, one.channel] / of.level[:, one.plug] for of in every]) / one.factor
    p = np.concatenate([of.expected[:, one.plug] / of.level[:, one.plug] for of in every])
    return float(np.linalg.norm(y - p) / max(float(np.linalg.norm(y) + np.linalg.norm(p)), TINY))


def _by_accelerometers(
    taken: tuple[ChannelSource, ...], of: LowFrequencyReadings, known: Sequence[_KnownFactors]
) -> tuple[ChannelSource, ...]:
    """What all load cells share and no unit explains may be the inverse of what all accelerometers share.

    H alone cannot tell the two; a unit that explains the latter can.
    """
    moved = [c for c, quantity in enumerate(of.quantities) if quantity == "acceleration"]
    felt = [c for c in range(len(taken)) if c not in moved]
    sizes = np.log([abs(taken[c].factor) for c in felt])
    if np.ptp(sizes) > SNAP or any(taken[c].units[0] for c in felt) or any(taken[c].factor != 1 for c in moved):
        return taken
    size = float(np.exp(np.median(sizes)))
    if size == 1:
        return taken
    off = np.abs(np.log(known[moved[0]].values * size))
    nearest = int(np.argmin(off))
    if off[nearest] >= SNAP:
        return taken
    gain = sum(taken[c].gain for c in felt) / len(moved)
    unit = {c: (float(known[c].values[nearest]), known[c].units[nearest]) for c in moved}
    return tuple(
        replace(one, factor=unit[one.channel][0], units=unit[one.channel][1], gain=gain)
        if one.channel in unit
        else replace(one, factor=float(np.sign(one.factor)), gain=0.0)
        for one in taken
    )


def _causes(channels: Sequence[str], taken: Sequence[ChannelSource]) -> Iterator[Cause]:
    """Signs of sensors, then plugs, then units of the files."""
    for one in taken:
        if one.factor < 0:
            yield _cause("polarity", (channels[one.plug],), one.gain)
    # Exchanges of two that, one after the other, bring every plug where it was found
    at = list(range(len(taken)))
    for c, each in enumerate(taken):
        if at[c] != each.plug:
            other = at.index(each.plug)
            at[c], at[other] = at[other], at[c]
            yield _cause("channel-swap", (channels[c], channels[other]), each.gain + taken[other].gain)
    for one in taken:
        if abs(one.factor) != 1:
            yield _unit(channels[one.channel], one)


def _unit(channel: str, one: ChannelSource) -> Cause:
    value = abs(one.factor)
    half = 0.0 if one.units[0] else NORMAL_90 * OFF * value
    size = EffectEstimate(key="", value=value, unit="1", low=value - half, high=value + half)
    taken, true = one.units
    in_words = f"its numbers are in {true}, and the file says {taken}" if taken else ""
    return _cause("unit", (channel,), one.gain, {"": value}, (size,), in_words)


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


def without_mistakes(data: Study, mistaken: Sequence[Cause]) -> Study:
    """`data` with a model that makes the same mistakes as the data, so that nothing is left of them."""
    made = tuple(Added(named=one.named, fixed=True) for one in mistaken)
    return replace(data, model=replace(data.model, effects=(*data.model.effects, *made)))


def with_mistakes(data: Study, found: Diagnosis, mistaken: Sequence[Cause]) -> Diagnosis:
    """`found`, the diagnosis without the mistakes, as one of the data of `data` as they are."""
    return replace(
        found,
        verdict=found.verdict if found.verdict == NONLINEAR else MISTAKE,
        text=_text(found, mistaken),
        accepted=(*mistaken, *found.accepted),
        ranking=(*mistaken, *found.ranking),
        equivalence_class=found.equivalence_class or tuple(one.id for one in mistaken),
        advice=found.advice or confirming(one.named for one in mistaken),
        before=errors_without_fit(data, {} if found.verdict == NONLINEAR else found.after.fitted.by_name),
    )


def _text(found: Diagnosis, mistaken: Sequence[Cause]) -> str:
    which = " and ".join(one.id for one in mistaken)
    if found.verdict == NONLINEAR:
        return f"{found.text}; beside that a mistake in the data: {which}"
    if found.verdict == NOTHING:
        return ""
    return f"Beside {which}: {found.text or headline(found)}"
