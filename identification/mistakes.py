"""Discrete mistakes of a test, and which of them the readings themselves accuse.

A wrong sign, two plugs exchanged, a unit taken for another: each is undone in turn, and the misfit of `self_consistency` says
how well the readings then agree. The mistake whose undoing brings agreement is suspected by name. Where undoing one helps and
is not enough, a second is looked for behind it.

What no check of this kind can see: channels of one position and direction that were exchanged (they read the same), and a unit
that *all* force channels share, or all accelerometers - H keeps its structure then, and only a weighing knows. A sign that all
share shows as a negative mass, but not on which side. What all pick-ups of the table share might as well be the inverse on the
cover plate; both are named.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, permutations

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from geometry.sensors import ChannelTable
from identification.self_consistency import Readings, misfit
from identification.units import UNITS

LIMIT = 16.0
"""Mean square from which readings disagree: four tolerances. Three on every channel at once still pass."""

FALL = 3.0
"""By what factor undoing a mistake must lower the misfit to be held on to where it is not enough alone."""

ALIKE = 2.0
"""Mistakes are alike where their misfits differ by less than this factor; below it, three mean squares of 1 tell nothing."""

SHORTLIST = 40
"""How many mistakes are judged with H, which is the dearer part: those that suit the two sides alone best."""

TOGETHER = 3
"""How many mistakes are looked for behind one another."""


@dataclass(frozen=True, kw_only=True)
class Mistake:
    """One mistake.

    Attributes
    ----------
    kind : "polarity", "channel-swap" or "unit"
    channels : that it concerns: two of a swap, all of a group that share it
    factor : what readings are multiplied with by it; 1 for a swap
    units : (taken for, is) of a unit
    """

    kind: str
    channels: tuple[str, ...]
    factor: float = 1.0
    units: tuple[str, str] = ("", "")

    @property
    def identifiers(self) -> tuple[str, ...]:
        """In the catalogue of effects."""
        if self.kind == "channel-swap":
            return (f"channel-swap:{':'.join(self.channels)}",)
        return tuple(f"{self.kind}:{name}" for name in self.channels)

    @property
    def text(self) -> str:
        """In words."""
        few = len(self.channels) <= 2
        named = " and ".join(self.channels) if few else f"all {len(self.channels)} of {self.channels[0]} to {self.channels[-1]}"
        if self.kind == "channel-swap":
            return f"{named} are exchanged"
        have = "has" if len(self.channels) == 1 else "have"
        if self.kind == "polarity":
            return f"{named} {have} the wrong sign"
        return f"{named} {have} the wrong unit: {self.units[0]} for {self.units[1]}, a factor of {self.factor:.6g}"


@dataclass(frozen=True, eq=False, kw_only=True)
class Suspect:
    """A mistake, or several at once, and what undoing it does.

    Attributes
    ----------
    mistakes : to be undone together
    before, after : misfit, the sum of three mean squares that are 1 at the tolerances
    explains : whether the readings agree within four tolerances afterwards
    """

    mistakes: tuple[Mistake, ...]
    before: float
    after: float
    explains: bool

    @property
    def text(self) -> str:
        """In words."""
        what = "; ".join(mistake.text for mistake in self.mistakes)
        return f"{what} (undone, the misfit falls from {self.before:.3g} to {self.after:.3g})"


def candidates(table: ChannelTable) -> tuple[Mistake, ...]:
    """Every sign, every unit and every pair within a group of one quantity; what a whole group may share, too."""
    groups: dict[tuple[str, str], list[str]] = {}
    for channel in table.channels:
        groups.setdefault((channel.group, channel.quantity), []).append(channel.name)
    found: list[Mistake] = []
    for (_, quantity), names in groups.items():
        alone = [(name,) for name in names]
        found.extend(Mistake(kind="polarity", channels=one, factor=-1.0) for one in alone)
        # A unit that all channels of a quantity share leaves no trace; one that table or cover plate has does.
        shared = [tuple(names)] if len(names) > 1 and sum(other == quantity for _, other in groups) > 1 else []
        found.extend(unit for one in [*alone, *shared] for unit in _units(table, quantity, one))
        found.extend(Mistake(kind="channel-swap", channels=pair) for pair in combinations(names, 2))
    wholes = {tuple(names) for names in groups.values()} | {_of_quantity(table, quantity) for _, quantity in groups}
    found.extend(Mistake(kind="polarity", channels=one, factor=-1.0) for one in sorted(wholes) if len(one) > 1)
    return tuple(found)


def _of_quantity(table: ChannelTable, quantity: str) -> tuple[str, ...]:
    return tuple(table.names[k] for k in table.select(quantity=quantity))


def _units(table: ChannelTable, quantity: str, channels: tuple[str, ...]) -> list[Mistake]:
    """One for every factor between two units; the pair that is named holds the unit of the channel table where it can."""
    stated = table.channels[table.names.index(channels[0])].unit
    by_factor: dict[float, Mistake] = {}
    for taken, true in sorted(permutations(UNITS[quantity], 2), key=lambda pair: (pair[0] != stated, pair[1] != stated)):
        factor = UNITS[quantity][taken] / UNITS[quantity][true]
        by_factor.setdefault(float(f"{factor:.9e}"), Mistake(kind="unit", channels=channels, factor=factor, units=(taken, true)))
    return list(by_factor.values())


def suspects(of: Readings) -> tuple[Suspect, ...]:
    """Mistakes whose undoing lets the readings agree, the best first; none where they agree as they are.

    Where no mistake explains the disagreement, the best of what helps is given, and says so.
    """
    known = candidates(of.table)
    chain: tuple[Mistake, ...] = ()
    values, noise = of.values[None], of.noise[None]
    now = misfit(of, values, noise)
    before, total = float(now.total[0]), float(now.total[0])
    if now.worst[0] <= LIMIT:
        return ()
    for _ in range(TOGETHER):
        tried = _tried(of, values[0], noise[0], known)
        found = tuple(
            Suspect(mistakes=(*chain, mistake), before=before, after=after, explains=True)
            for mistake, after in _explaining(tried)
        )
        best = min(tried, key=lambda one: one.total)
        if found or best.total * FALL > total:
            return found or _helpful(chain, before, total)
        chain, total = (*chain, best.mistake), best.total
        values, noise = _undone_all(of.table, values[0], noise[0], [best.mistake])
    return _helpful(chain, before, total)


def undone(table: ChannelTable, values: ComplexArray, mistake: Mistake) -> ComplexArray:
    """`values` (..., c) of the channels of `table` without `mistake`."""
    chosen = [table.names.index(name) for name in mistake.channels]
    out = np.array(values)
    out[..., chosen] = out[..., chosen[::-1]] if mistake.kind == "channel-swap" else out[..., chosen] / mistake.factor
    return out


@dataclass(frozen=True, kw_only=True)
class _Tried:
    """A mistake, and the misfit once it is undone."""

    mistake: Mistake
    total: float
    worst: float


def _tried(of: Readings, values: ComplexArray, noise: Array, known: Sequence[Mistake]) -> list[_Tried]:
    """The mistakes that look best on each side alone, judged with H."""
    sides = misfit(of, *_undone_all(of.table, values, noise, known), structure=False)
    shortlist = [known[k] for k in np.argsort(sides.total, kind="stable")[:SHORTLIST]]
    full = misfit(of, *_undone_all(of.table, values, noise, shortlist))
    return [
        _Tried(mistake=mistake, total=float(total), worst=float(worst))
        for mistake, total, worst in zip(shortlist, full.total, full.worst, strict=True)
    ]


def _undone_all(
    table: ChannelTable, values: ComplexArray, noise: Array, mistakes: Sequence[Mistake]
) -> tuple[ComplexArray, Array]:
    """Values and noise (v, r, n, c) without each of the mistakes."""
    return (
        np.stack([undone(table, values, mistake) for mistake in mistakes]),
        np.stack([np.abs(undone(table, noise.astype(np.complex128), mistake)) for mistake in mistakes]),
    )


def _explaining(tried: Sequence[_Tried]) -> list[tuple[Mistake, float]]:
    """Those that bring agreement and are about as good as the best, the best first."""
    good = sorted((one for one in tried if one.worst <= LIMIT), key=lambda one: one.total)
    return [(one.mistake, one.total) for one in good if one.total <= ALIKE * max(good[0].total, ALIKE)]


def _helpful(chain: tuple[Mistake, ...], before: float, after: float) -> tuple[Suspect, ...]:
    return (Suspect(mistakes=chain, before=before, after=after, explains=False),) if chain else ()
