"""Discrete mistakes - a wrong sign, two plugs exchanged, a unit taken for another - which are looked for before any fit.

Every reading y_c of `validation.diagnosing.heard` is held against what *every* channel of its quantity should read, times every
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

from geometry.arrays import Array
from geometry.errors import CheckFailed
from geometry.sensors import ChannelTable
from identification.mistakes import candidates
from identification.quality import NORMAL_90
from validation.diagnosing.bench import Bench
from validation.diagnosing.diagnosis import Cause, Size
from validation.diagnosing.heard import Heard, heard
from validation.effects.identifiers import Named

OFF = 0.15
"""Share by which readings may be off for other reasons."""

SIGN, UNIT, FACTOR, PLUG = 8.0, 10.0, 16.0, 6.0
"""[nats] Price of a wrong sign, a known unit, a factor that is none, and of a channel that reads another's plug."""

SURE = 20.0
"""[nats] Evidence below which a mistake is none, and that one campaign has against a mistake of another to contradict it."""

USUAL = 2.5
"""Factors nearer to 1 than this are gains."""

SNAP = 0.2
"""How far, as a logarithm, the factor that fits best may lie from a unit's to be that."""


FAR = 0.25
"""Distance (`validation.diagnosing.heard.distance`) at which a reading still is not what a mistake says: a gain of two thirds."""

IMPOSSIBLE = -1e9
"""[nats] Of an accelerometer that holds a force."""

TINY = float(np.finfo(np.float64).tiny)


@dataclass(frozen=True, kw_only=True)
class Taken:
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


def mistakes(bench: Bench) -> tuple[Cause, ...]:
    """Wrong signs, exchanged plugs and wrong units, in the order in which effects of a model say them; none where there are none.

    All of them hold together, and in all campaigns: signs belong to sensors, units to what the files say. A channel that no
    factor and no exchange brings near is not among them.

    Raises
    ------
    CheckFailed : a mistake of one campaign that another contradicts.
    """
    every = [heard(one.with_effects(bench.model.effects)) for one in bench.made]
    known = _factors(bench.made[0].tested.campaign.table, every[0].channels)
    found = _decided(every, known)
    for one in every if len(every) > 1 else ():
        _require_agreement(one, every, _decided([one], known))
    return tuple(_causes(every[0].channels, _whole(found, every[0], known)))


@dataclass(frozen=True, eq=False, kw_only=True)
class _Known:
    """Factors between the units of a channel's quantity, that of the channel table among them where it can."""

    values: Array
    units: tuple[tuple[str, str], ...]


def _factors(table: ChannelTable, channels: Sequence[str]) -> tuple[_Known, ...]:
    units = [one for one in candidates(table) if one.kind == "unit" and len(one.channels) == 1]
    of = {name: [one for one in units if one.channels == (name,)] for name in channels}
    return tuple(
        _Known(values=np.array([one.factor for one in of[n]]), units=tuple(one.units for one in of[n])) for n in channels
    )


def _decided(every: Sequence[Heard], known: Sequence[_Known]) -> tuple[Taken, ...]:
    """What each channel holds, by all campaigns together."""
    from scipy.optimize import linear_sum_assignment

    of, count = every[0], len(every[0].channels)
    best = np.full((count, count), IMPOSSIBLE)
    factors, units = np.ones((count, count)), np.full((count, count), -1)
    for c in range(count):
        for d in range(count):
            if of.quantities[c] == of.quantities[d]:
                factors[c, d], units[c, d], price = _factor(every, c, d, known[c])
                price += PLUG * (c != d)
                best[c, d] = _likelihood(every, c, d, factors[c, d]) - price
    right = np.array([_likelihood(every, c, c, 1.0) for c in range(count)])
    stays = right >= np.diagonal(best)
    best[stays, stays] = right[stays]
    for c in np.flatnonzero(stays).tolist():
        best[c, c], factors[c, c], units[c, c] = right[c], 1.0, -1
    _, plugs = linear_sum_assignment(-best)
    taken = [
        Taken(
            channel=c,
            plug=int(d),
            factor=float(factors[c, d]),
            units=known[c].units[units[c, d]] if units[c, d] >= 0 else ("", ""),
            gain=float(best[c, d] - right[c]),
        )
        for c, d in enumerate(plugs)
    ]
    return _sure(every, taken)


def _factor(every: Sequence[Heard], c: int, d: int, known: _Known) -> tuple[float, int, float]:
    """The factor between reading c and what channel d should read, which of the known ones it is, else -1, and its price."""
    products = [(one.reading[:, c], one.expected[:, d], one.level[:, d]) for one in every]
    above = sum(float(np.sum((y * p.conj()).real / level**2)) for y, p, level in products)
    below = sum(float(np.sum(np.abs(p) ** 2 / level**2)) for _, p, level in products)
    k = above / max(below, TINY)
    sign, size = (-1.0 if k < 0 else 1.0), max(abs(k), TINY)
    price = SIGN * (k < 0)
    if abs(np.log(size)) < np.log(USUAL):
        return sign, -1, price
    off = np.abs(np.log(known.values / size)) if len(known.values) else np.array([np.inf])
    nearest = int(np.argmin(off))
    if off[nearest] < SNAP:
        return sign * float(known.values[nearest]), nearest, price + UNIT
    return float(k), -1, price + FACTOR


def _likelihood(every: Sequence[Heard], c: int, d: int, factor: float) -> float:
    """[nats] That channel c holds `factor` times what channel d should read."""
    found = 0.0
    for one in every:
        variance = one.noise[:, c] ** 2 + (factor * OFF * one.level[:, d]) ** 2
        off = np.abs(one.reading[:, c] - factor * one.expected[:, d]) ** 2
        found -= float(np.sum(off / variance + np.log(variance))) / one.lines
    return found


def _sure(every: Sequence[Heard], taken: Sequence[Taken]) -> tuple[Taken, ...]:
    """`taken` without cycles of plugs, and factors, that are not told or do not bring a reading near."""
    found = list(taken)
    for cycle in _cycles(taken):
        near = all(_apart(every, taken[c]) < FAR for c in cycle)
        if sum(taken[c].gain for c in cycle) < SURE or not near:
            for c in cycle:
                found[c] = Taken(channel=c, plug=c, factor=1.0, units=("", ""), gain=0.0)
    return tuple(found)


def _cycles(taken: Sequence[Taken]) -> Iterator[list[int]]:
    left = set(range(len(taken)))
    while left:
        first = min(left)
        cycle = [first]
        while (at := taken[cycle[-1]].plug) != first:
            cycle.append(at)
        left -= set(cycle)
        yield cycle


def _apart(every: Sequence[Heard], one: Taken) -> float:
    """Distance, over all campaigns, of a reading from what it is said to hold; each line in units of its level."""
    y = np.concatenate([of.reading[:, one.channel] / of.level[:, one.plug] for of in every]) / one.factor
    p = np.concatenate([of.expected[:, one.plug] / of.level[:, one.plug] for of in every])
    return float(np.linalg.norm(y - p) / max(float(np.linalg.norm(y) + np.linalg.norm(p)), TINY))


def _whole(taken: tuple[Taken, ...], of: Heard, known: Sequence[_Known]) -> tuple[Taken, ...]:
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


def _require_agreement(one: Heard, every: Sequence[Heard], alone: Sequence[Taken]) -> None:
    """Refuse a mistake of campaign `one` that another contradicts."""
    for taken in alone:
        for other in every:
            right, wrong = (
                _likelihood([other], taken.channel, plug, factor)
                for plug, factor in ((taken.channel, 1.0), (taken.plug, taken.factor))
            )
            if not taken.is_right and right - wrong > SURE:
                what = _said(one.channels, taken)
                raise CheckFailed(
                    f"the campaigns contradict one another: in {one.name} {what}, in {other.name} it is as the file says; "
                    f"correct that campaign alone (`massline correct`), or leave it out",
                    evidence_nats={one.name: taken.gain, other.name: right - wrong},
                )


def _said(channels: Sequence[str], one: Taken) -> str:
    channel, plug = channels[one.channel], channels[one.plug]
    holds = f"{channel} holds the signal of {plug}" if one.plug != one.channel else f"{channel} reads as expected"
    return holds if one.factor == 1 else f"{holds} times {one.factor:.4g}"


def _causes(channels: Sequence[str], taken: Sequence[Taken]) -> Iterator[Cause]:
    """Signs of sensors, then plugs, then units of the files."""
    for one in taken:
        if one.factor < 0:
            yield _cause("polarity", (channels[one.plug],), one.gain)
    yield from _swaps(channels, taken)
    for one in taken:
        if abs(one.factor) != 1:
            yield _unit(channels[one.channel], one)


def _swaps(channels: Sequence[str], taken: Sequence[Taken]) -> Iterator[Cause]:
    """Exchanges of two that, one after the other, bring every plug where it was found."""
    at = list(range(len(taken)))
    for c, one in enumerate(taken):
        if at[c] != one.plug:
            other = at.index(one.plug)
            at[c], at[other] = at[other], at[c]
            yield _cause("channel-swap", (channels[c], channels[other]), one.gain + taken[other].gain)


def _unit(channel: str, one: Taken) -> Cause:
    value = abs(one.factor)
    half = 0.0 if one.units[0] else NORMAL_90 * OFF * value
    size = Size(key="", value=value, unit="1", low=value - half, high=value + half)
    return _cause("unit", (channel,), one.gain, {"": value}, (size,), _in_words(one))


def _in_words(one: Taken) -> str:
    taken, true = one.units
    return f"its numbers are in {true}, and the file says {taken}" if taken else ""


def _cause(
    family: str,
    targets: tuple[str, ...],
    evidence: float,
    values: Mapping[str, float] = MappingProxyType({}),
    sizes: tuple[Size, ...] = (),
    note: str = "",
) -> Cause:
    return Cause(named=Named(family=family, targets=targets, values=values), sizes=sizes, evidence=evidence, note=note)
