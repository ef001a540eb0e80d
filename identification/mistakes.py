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

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial, reduce
from itertools import combinations, permutations, product

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from geometry.sensors import ChannelTable
from identification.self_consistency import Readings, misfit, parity, redundancy
from identification.units import UNITS

LIMIT = 16.0
"""Mean square from which readings disagree: four tolerances. Three on every channel at once still pass."""

FALL = 3.0
"""By what factor undoing mistakes must lower the misfit to be told although it is not enough."""

ALIKE = 2.0
"""Mistakes are alike where their misfits differ by less than this factor; below it, three mean squares of 1 tell nothing."""

OPTIONS = 30
"""How many ways of bringing one side into agreement with itself are judged with H."""

BEAM = 30
"""How many mistakes of a side, the most helpful ones, are tried as one of two."""

PORTION = 2000
"""Variants of the readings that are held in memory at once."""


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
    """The fewest mistakes whose undoing lets the readings agree, the best first; none where they agree as they are.

    Either side - accelerometers, load cells - must first agree with itself; what does that is then judged with H. Where nothing
    explains the disagreement, what helps most is given if it helps much, and says that it is not enough.
    """
    start = misfit(of, of.values[None], of.noise[None])
    if start.worst[0] <= LIMIT:
        return ()
    before = float(start.total[0])
    pairs = [(*one, *other) for one, other in product(*(_options(of, side) for side in _sides(of.table)))]
    tried: list[_Tried] = []
    for count in sorted({len(chain) for chain in pairs} - {0}):
        tried += _tried(of, [chain for chain in pairs if len(chain) == count])
        if explaining := _explaining(tried):
            return tuple(Suspect(mistakes=one.chain, before=before, after=one.total, explains=True) for one in explaining)
    best = min(tried, key=lambda one: one.total, default=None)
    if best is None or best.total * FALL > before:
        return ()
    return (Suspect(mistakes=best.chain, before=before, after=best.total, explains=False),)


def undone(table: ChannelTable, values: ComplexArray, mistake: Mistake) -> ComplexArray:
    """`values` (..., c) of the channels of `table` without `mistake`."""
    chosen = [table.names.index(name) for name in mistake.channels]
    out = np.array(values)
    out[..., chosen] = out[..., chosen[::-1]] if mistake.kind == "channel-swap" else out[..., chosen] / mistake.factor
    return out


Chain = tuple[Mistake, ...]
"""Mistakes that are undone one after the other."""


@dataclass(frozen=True, kw_only=True)
class _Tried:
    """Mistakes, and the misfit once they are undone."""

    chain: Chain
    total: float
    worst: float


@dataclass(frozen=True, eq=False, kw_only=True)
class _Side:
    """The mistakes of one side, and how well that side agrees with itself."""

    known: tuple[Mistake, ...]
    square: Callable[[Readings, ComplexArray, Array], Array]


def _sides(table: ChannelTable) -> tuple[_Side, _Side]:
    known = candidates(table)
    pick_ups = {table.names[k] for k in table.select(quantity="acceleration")}
    moved = tuple(one for one in known if one.channels[0] in pick_ups)
    felt = tuple(one for one in known if one.channels[0] not in pick_ups)
    return _Side(known=moved, square=redundancy), _Side(known=felt, square=parity)


def _options(of: Readings, side: _Side) -> list[Chain]:
    """What may have happened on a side so that it agrees with itself once that is undone: nothing, one mistake, or else two."""
    sound = _squares(of, side, [()])[0] <= LIMIT
    singles: list[Chain] = [(one,) for one in side.known]
    squares = _squares(of, side, singles)
    order = np.argsort(squares, kind="stable")
    good = [singles[k] for k in order[:OPTIONS].tolist() if squares[k] <= LIMIT]
    if sound or good:
        return [(), *good] if sound else good
    doubles = [(*singles[k], second) for k in order[:BEAM].tolist() for second in side.known if (second,) != singles[k]]
    squares = _squares(of, side, doubles)
    order = np.argsort(squares, kind="stable")[:OPTIONS]
    return _unordered([doubles[k] for k in order.tolist() if squares[k] <= LIMIT]) or [()]


def _unordered(chains: Sequence[Chain]) -> list[Chain]:
    """The same two in either order count once."""
    return list({frozenset(chain): chain for chain in reversed(chains)}.values())[::-1]


def _squares(of: Readings, side: _Side, chains: Sequence[Chain]) -> Array:
    """(v,) how a side agrees with itself without the mistakes of each chain."""
    parts = [chains[k : k + PORTION] for k in range(0, len(chains), PORTION)]
    return np.concatenate([side.square(of, *_undone_all(of, part)) for part in parts])


def _tried(of: Readings, chains: Sequence[Chain]) -> list[_Tried]:
    full = misfit(of, *_undone_all(of, chains))
    return [
        _Tried(chain=chain, total=float(total), worst=float(worst))
        for chain, total, worst in zip(chains, full.total, full.worst, strict=True)
    ]


def _undone_all(of: Readings, chains: Sequence[Chain]) -> tuple[ComplexArray, Array]:
    """Values and noise (v, r, n, c) without the mistakes of each chain."""
    both = np.stack([of.values, of.noise.astype(np.complex128)])
    without = np.stack([reduce(partial(undone, of.table), chain, both) for chain in chains])
    return without[:, 0], np.abs(without[:, 1])


def _explaining(tried: Sequence[_Tried]) -> list[_Tried]:
    """Those that bring agreement and are about as good as the best, the best first."""
    good = sorted((one for one in tried if one.worst <= LIMIT), key=lambda one: one.total)
    return [one for one in good if one.total <= ALIKE * max(good[0].total, ALIKE)]
