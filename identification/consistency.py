"""Checks that need no model of the structure: what any dynamic mass on stiff plates must satisfy, and which channel breaks it.

At the lowest lines every structure is nearly a rigid body, and its dynamic mass nearly the matrix of Eq. 1: symmetric - that one
at every line -, one mass along x, y and z, a skew coupling of forces and rotations, a positive diagonal, no phase. Departures
are told in tolerances: what an ordinary laboratory does not know of its sensors, put through Eqs. 6 to 11. What elasticity adds
is allowed for by the way H grows over the same lines. Redundant accelerometers and force channels must agree, too. Where
something does not hold, mistakes are tried one by one (`identification.consistency`).
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial, reduce
from itertools import combinations, permutations, product
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import MOTIONS, ComplexArray, DynamicMass
from geometry.errors import BadInput
from geometry.frames import Array, Integers, rigid_transformation
from geometry.inertia import LOADS
from geometry.sensors import Channel, ChannelTable, Tolerances, resultants
from identification.base_motion import STANDARD_GRAVITY, base_motion, groups_used, rows_at_lines
from identification.base_motion import resultants as identification_resultants
from identification.campaign import RIGID_GROUPS, UNITS
from identification.dynamic_mass import from_runs
from identification.rigid_body import BASIS
from identification.spectra.line_spectra import Spectra

# How well what the channels read agrees with itself, in units of the tolerances of an ordinary laboratory.
#
# Three agreements need no model of the structure, only that the plates below it are stiff:
#
# - redundancy: more than six accelerometers on table and cover plate tell one and the same base motion,
# - parity: more than six force channels hold self-equilibrated readings, which cells of one stiffness do not have,
# - structure: H is the mass matrix of a body (Eq. 1): symmetric, m_x = m_y = m_z, skew coupling, no phase, positive diagonal.
#   Elastic structures are symmetric, too, and positive at the lowest line.
#
# Each is a mean square of 1 where channels are off by their tolerances, and grows to hundreds with a wrong sign. The lowest
# lines are used, where the structure answers most rigidly; what elasticity adds there is allowed for by the way H grows over
# them, with omega². Everything is computed for many variants of the readings at once, since mistakes are found by trying to undo
# them.

REACH = 1.5
"""Lines up to so many times the lowest one are used."""

LINES = 3
"""How many of them: faults that do not depend on frequency show at every line alike."""

CLIP = 2.0
"""How far the largest reading of a channel may lie beyond that of most others, and still tell how much moved."""

NEGATIVE = 1e6
"""Mean square of a mass or a moment of inertia below zero: no tolerance makes one."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Readings:
    """What the channels of table, cover plate and force measurement read at the lowest lines.

    Attributes
    ----------
    table : these channels
    rows : (n, a, 6) what the accelerometers among them read of the apparent base motion
    omega : (n,) [rad/s]
    values : (r, n, c) complex
    noise : (r, n, c) standard deviation
    lines : (n,) indices of the lines in the spectra
    tolerances : of the laboratory
    """

    table: ChannelTable
    rows: Array
    omega: Array
    values: ComplexArray
    noise: Array
    lines: Integers
    tolerances: Tolerances


@dataclass(frozen=True, eq=False, kw_only=True)
class Misfit:
    """Mean squares of v variants of the readings, 1 where they are off by the tolerances, 0 where there is nothing to compare.

    Attributes
    ----------
    redundancy, parity, structure : (v,)
    """

    redundancy: Array
    parity: Array
    structure: Array

    @property
    def total(self) -> Array:
        """(v,) their sum."""
        return self.redundancy + self.parity + self.structure

    @property
    def worst(self) -> Array:
        """(v,) the largest of the three."""
        return np.asarray(np.max([self.redundancy, self.parity, self.structure], axis=0))


def readings(spectra: Spectra, tolerances: Tolerances, gravity: float = STANDARD_GRAVITY) -> Readings:
    """The lowest lines of the channels that can be compared; `gravity` [m/s²] is for channels that do not feel a tilt."""
    low = np.flatnonzero(spectra.frequency <= REACH * spectra.frequency[0])
    lines = np.unique(np.linspace(low[0], low[-1], LINES).round().astype(np.intp))
    moved = spectra.table.select(group=RIGID_GROUPS, quantity="acceleration")
    chosen = [*moved, *spectra.table.select(group="fmd", quantity=("force", "moment"))]
    return Readings(
        table=spectra.table.subset(chosen),
        rows=rows_at_lines(spectra, moved, gravity)[lines],
        omega=2 * np.pi * spectra.frequency[lines],
        values=spectra.values[:, lines][:, :, chosen],
        noise=spectra.noise[:, lines][:, :, chosen],
        lines=lines,
        tolerances=tolerances,
    )


def redundancy(of: Readings, values: ComplexArray, noise: Array) -> Array:
    """(v,) that of the accelerometers alone."""
    return _motion(of, values, noise).left_over


def parity(of: Readings, values: ComplexArray, noise: Array) -> Array:
    """(v,) that of the force channels alone."""
    return _load(of, values, noise).left_over


def misfit(of: Readings, values: ComplexArray, noise: Array) -> Misfit:
    """The misfit of variants (v, r, n, c) of the readings and of their noise; structure takes six runs."""
    motion, load = _motion(of, values, noise), _load(of, values, noise)
    if values.shape[1] >= 6:
        # Mean squares (v,) of what H has that no body has and that no structure has, and the price of a negative mass
        H, sd = _entries(motion, load)
        elastic = elasticity(of, H, sd)
        negative = np.any(np.diagonal((H.real + elastic)[:, 0], axis1=1, axis2=2) <= 0, axis=1)
        # Mean square (v,) of H (v, n, 6, 6) less its transpose, which elasticity leaves alone
        j, k = np.triu_indices(6, 1)
        unsymmetric = _mean_square((H[..., j, k] - H[..., k, j]) / np.hypot(sd[..., j, k], sd[..., k, j]))
        # Mean square (v,) of what the best mass matrix of Eq. 1 leaves of H
        weight = 1 / np.hypot(sd, elastic).reshape(len(H), -1)
        rows, b = np.tile(BASIS.reshape(10, 36).T, (H.shape[1], 1)) * weight[..., None], H.reshape(len(H), -1) * weight
        p = np.linalg.pinv(rows) @ b.real[..., None]
        third = np.asarray(np.maximum(_mean_square(b - (rows @ p)[..., 0]), unsymmetric) + NEGATIVE * negative)
    else:
        third = np.zeros(len(values))
    return Misfit(redundancy=motion.left_over, parity=load.left_over, structure=third)


def deviation(of: Readings) -> Array:
    """(n, 6, 6) standard deviation of the entries of H by the tolerances, its base motion as in `identification.base_motion`."""
    values, noise = of.values[None], of.noise[None]
    groups = groups_used(of.table)
    used = [k for k, channel in enumerate(_pick_ups(of)) if channel.group in groups]
    T = np.linalg.pinv(of.rows[:, used])
    sd = _tolerance(of, values, noise)[..., used]
    covariance = np.einsum("njc,vrnc,nkc->vrnjk", T, sd**2, T, optimize=True)
    u = np.einsum("njc,vrnc->vrnj", T, values[..., used])
    side = _Side(values=u, covariance=covariance, left_over=np.zeros(1))
    return np.asarray(_entries(side, _load(of, values, noise))[1][0])


def elasticity(of: Readings, H: ComplexArray, sd: Array) -> Array:
    """What |H| (..., n, 6, 6) may hold beyond a body, by what is seen from the first line to the last.

    Below the modes it grows with omega², the steeper the nearer they are. Where H changes otherwise, and by more than tolerances
    `sd` of its entries do, a mode lies among the lines or below them, and it is twice the most that H changes: a mode just below
    makes H as large as it changes. Wrong signs, exchanges and units are the same at every line, and change nothing.
    """
    if len(of.omega) < 2:
        return np.zeros(H.shape)
    square = of.omega**2
    change = np.abs(H[..., -1:, :, :] - H[..., :1, :, :])
    allowed = np.asarray(change * (square / (square[-1] - square[0]))[:, None, None])
    slope = np.diff(H, axis=-3) / np.diff(square)[:, None, None]
    first, last = slope[..., :1, :, :], slope[..., -1:, :, :]
    steeper = (np.abs(last) >= np.abs(first)) & ((first * last.conj()).real >= 0)
    pairs = [np.abs(H[..., [j], :, :] - H[..., [k], :, :]) for j, k in combinations(range(len(square)), 2)]
    most = np.max(pairs, axis=0)
    return np.where(steeper | (most**2 <= LIMIT * sd**2), allowed, np.maximum(allowed, 2 * most))


@dataclass(frozen=True, eq=False, kw_only=True)
class _Side:
    """Six motions or loads (v, r, n, 6), their covariances by tolerance (v, r, n, 6, 6), and the mean square (v,) left over."""

    values: ComplexArray
    covariance: Array
    left_over: Array


def _pick_ups(of: Readings) -> list[Channel]:
    """The accelerometers. They stand before the load cells."""
    return [of.table.channels[k] for k in of.table.select(quantity="acceleration")]


def _tolerance(of: Readings, values: ComplexArray, noise: Array) -> Array:
    """(v, r, n, a) standard deviation of the accelerometers: own gain and delay, place and angle in what is around."""
    channels, t = _pick_ups(of), of.tolerances
    a, floor = values[..., : len(channels)], noise[..., : len(channels)]
    # Readings (v, r, n, a) cut off far beyond the largest of most channels: one in a wrong unit shall not excuse the others
    size = np.abs(a)
    usual = np.median(size.max(axis=(1, 2)), axis=-1)[:, None, None, None]
    clipped = np.asarray(a * np.minimum(1.0, CLIP * usual / np.maximum(size, np.finfo(np.float64).tiny)))
    rough = (np.linalg.pinv(of.rows) @ clipped[..., None])[..., 0]
    # (3,) [m] where a channel sits; the mean of several places
    local = np.stack(
        [
            rough
            @ rigid_transformation(np.asarray(np.mean([place.position for place in channel.places], axis=0)) - of.table.origin).T
            for channel in channels
        ],
        axis=-2,
    )
    across, turning = np.linalg.norm(local, axis=-1), np.linalg.norm(rough[..., 3:], axis=-1, keepdims=True)
    gain = np.array([t.table_gain if channel.group == "table" else t.gain for channel in channels])
    own = np.abs(a) ** 2 * (gain**2 + (of.omega[:, None] * t.delay) ** 2)
    sd = np.sqrt(own + (t.angle * across) ** 2 + (t.position * turning) ** 2 + floor**2)
    rounding = np.finfo(np.float64).eps * np.abs(a).max(axis=-1, keepdims=True) + np.finfo(np.float64).tiny
    return np.asarray(np.maximum(sd, rounding))


def _motion(of: Readings, values: ComplexArray, noise: Array) -> _Side:
    """Eqs. 6 and 7, every accelerometer of table and cover plate weighted by its tolerance."""
    G, sd = of.rows, _tolerance(of, values, noise)
    a, count = values[..., : G.shape[1]], G.shape[1]
    # Six unknowns and rows of one geometry: the normal equations are quick, and safe at condition numbers of tens.
    outer = (G[..., :, None] * G[..., None, :]).reshape(*G.shape[:2], 36)
    covariance = np.linalg.inv((sd[..., None, :] ** -2 @ outer).reshape(*sd.shape[:-1], 6, 6))
    u = covariance @ ((a / sd**2)[..., None, :] @ G).swapaxes(-1, -2)
    return _Side(
        values=u[..., 0],
        covariance=np.asarray(covariance, dtype=np.float64),
        left_over=_mean_square((a - (G @ u)[..., 0]) / sd) * count / max(count - 6, 1),
    )


def _load(of: Readings, values: ComplexArray, noise: Array) -> _Side:
    """Resultants, and what is self-equilibrated: the null space of the sums that make them."""
    chosen = list(of.table.select(quantity=("force", "moment")))
    T, f, t = resultants([of.table.channels[k] for k in chosen], of.table.origin), values[..., chosen], of.tolerances
    F = f @ T.T
    variance = np.abs(f) ** 2 * (t.gain**2 + (of.omega[:, None] * t.delay) ** 2) + noise[..., chosen] ** 2
    crossed = np.concatenate(
        [np.repeat(np.sum(np.abs(F[..., part]) ** 2, axis=-1)[..., None], 3, axis=-1) for part in HALVES], -1
    )
    covariance = np.einsum("jc,...c,kc->...jk", T, variance, T, optimize=True) + t.crosstalk**2 * crossed[..., None] * np.eye(6)
    N = np.linalg.svd(T)[2][6:].T
    spread = (variance + t.cell_stiffness**2 * np.abs(f) ** 2) @ N**2
    tiny = np.finfo(np.float64).tiny
    left_over = _mean_square(f @ N / np.sqrt(np.maximum(spread, tiny))) if N.size else np.zeros(len(values))
    return _Side(values=F, covariance=covariance, left_over=left_over)


HALVES = (slice(3), slice(3, 6))
"""Translations and rotations, forces and moments."""


def _entries(motion: _Side, load: _Side) -> tuple[ComplexArray, Array]:
    """H (v, n, 6, 6) at the lowest lines, and the standard deviation of each entry by the tolerances."""
    U, F = motion.values.transpose(0, 2, 3, 1), load.values.transpose(0, 2, 3, 1)  # (v, n, 6, r)
    P = np.linalg.pinv(U)
    H = F @ P
    through = np.einsum("vnij,vrnjk,vnik->vrni", H, motion.covariance, H.conj(), optimize=True).real
    own = np.diagonal(load.covariance, axis1=-2, axis2=-1)
    return H, np.sqrt(np.einsum("vrni,vnrk->vnik", own + through, np.abs(P) ** 2, optimize=True))


def _mean_square(values: ComplexArray) -> Array:
    """(v,) over all but the first axis."""
    return np.asarray(np.mean(np.abs(values.reshape(len(values), -1)) ** 2, axis=1))


# Discrete mistakes of a test, and which of them the readings themselves accuse.
#
# A wrong sign, two plugs exchanged, a unit taken for another: each is undone in turn, and the misfit above says
# how well the readings then agree. The mistake whose undoing brings agreement is suspected by name. Where undoing one helps and
# is not enough, a second is looked for behind it.
#
# What no check of this kind can see: channels of one position and direction that were exchanged (they read the same), and a unit
# that *all* force channels share, or all accelerometers - H keeps its structure then, and only a weighing knows. A sign that all
# share shows as a negative mass, but not on which side. What all pick-ups of the table share might as well be the inverse on the
# cover plate; both are named.

LIMIT = 16.0
"""Mean square from which readings disagree: four tolerances. Three on every channel at once still pass."""

FALL = 3.0
"""By what factor undoing mistakes must lower the misfit to be told although it is not enough."""

SAME_LEVEL = 2.0
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
        for one in [*alone, *shared]:
            # One for every factor between two units; the pair that is named holds the unit of the table where it can
            stated = table.channels[table.names.index(one[0])].unit
            by_factor: dict[str, Mistake] = {}
            for pair in sorted(permutations(UNITS[quantity], 2), key=lambda pair: (pair[0] != stated, pair[1] != stated)):
                factor = UNITS[quantity][pair[0]] / UNITS[quantity][pair[1]]
                by_factor.setdefault(f"{factor:.9e}", Mistake(kind="unit", channels=one, factor=factor, units=pair))
            found.extend(by_factor.values())
        found.extend(Mistake(kind="channel-swap", channels=pair) for pair in combinations(names, 2))
    wholes = {tuple(names) for names in groups.values()} | {
        tuple(table.names[k] for k in table.select(quantity=quantity)) for _, quantity in groups
    }
    found.extend(Mistake(kind="polarity", channels=one, factor=-1.0) for one in sorted(wholes) if len(one) > 1)
    return tuple(found)


def suspects(of: Readings) -> tuple[Suspect, ...]:
    """The fewest mistakes whose undoing lets the readings agree, the best first; none where they agree as they are.

    Either side - accelerometers, load cells - must first agree with itself; what does that is then judged with H. Where nothing
    explains the disagreement, what helps most is given if it helps much, and says that it is not enough.
    """
    start = misfit(of, of.values[None], of.noise[None])
    if start.worst[0] <= LIMIT:
        return ()
    before = float(start.total[0])
    table = of.table
    known = candidates(table)
    pick_ups = {table.names[k] for k in table.select(quantity="acceleration")}
    moved = tuple(one for one in known if one.channels[0] in pick_ups)
    felt = tuple(one for one in known if one.channels[0] not in pick_ups)
    sides = _SideChecks(known=moved, square=redundancy), _SideChecks(known=felt, square=parity)
    pairs = [(*one, *other) for one, other in product(*(_options(of, side) for side in sides))]
    tried: list[_Tried] = []
    for count in sorted({len(chain) for chain in pairs} - {0}):
        chains = [chain for chain in pairs if len(chain) == count]
        full = misfit(of, *_undone_all(of, chains))
        tried += [_Tried(chain=a, total=float(b), worst=float(c)) for a, b, c in zip(chains, full.total, full.worst, strict=True)]
        # Those that bring agreement and are about as good as the best, the best first
        good = sorted((one for one in tried if one.worst <= LIMIT), key=lambda one: one.total)
        good = [one for one in good if one.total <= SAME_LEVEL * max(good[0].total, SAME_LEVEL)]
        if good:
            return tuple(Suspect(mistakes=one.chain, before=before, after=one.total, explains=True) for one in good)
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
class _SideChecks:
    """The mistakes of one side, and how well that side agrees with itself."""

    known: tuple[Mistake, ...]
    square: Callable[[Readings, ComplexArray, Array], Array]


def _options(of: Readings, side: _SideChecks) -> list[Chain]:
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
    # The same two in either order count once
    chains = [doubles[k] for k in order.tolist() if squares[k] <= LIMIT]
    unordered = list({frozenset(chain): chain for chain in reversed(chains)}.values())[::-1]
    return unordered or [()]


def _squares(of: Readings, side: _SideChecks, chains: Sequence[Chain]) -> Array:
    """(v,) how a side agrees with itself without the mistakes of each chain."""
    parts = [chains[k : k + PORTION] for k in range(0, len(chains), PORTION)]
    return np.concatenate([side.square(of, *_undone_all(of, part)) for part in parts])


def _undone_all(of: Readings, chains: Sequence[Chain]) -> tuple[ComplexArray, Array]:
    """Values and noise (v, r, n, c) without the mistakes of each chain."""
    both = np.stack([of.values, of.noise.astype(np.complex128)])
    without = np.stack([reduce(partial(undone, of.table), chain, both) for chain in chains])
    return without[:, 0], np.abs(without[:, 1])


ORDINARY = Tolerances()

Departure = tuple[str, npt.NDArray[np.complexfloating[Any, Any]], Array]
"""A name, how far something is from what it should be (n,), and the tolerance (n,) of that."""


@dataclass(frozen=True, kw_only=True)
class Finding:
    """One check.

    Attributes
    ----------
    name : "symmetry", "equal masses", "coupling", "diagonal", "phase", "redundancy", "parity" or "channels"
    holds : whether it is satisfied
    value : the worst departure [tolerances]
    text : the finding in words
    suspects : mistakes of "channels", the most likely first
    """

    name: str
    holds: bool
    value: float
    text: str
    suspects: tuple[Suspect, ...] = ()


def checks(
    dynamic_mass: DynamicMass, spectra: Spectra, tolerances: Tolerances = ORDINARY, *, gravity: float = STANDARD_GRAVITY
) -> tuple[Finding, ...]:
    """All checks of a dynamic mass and of the spectra that it came from.

    Parameters
    ----------
    dynamic_mass : about the reference point of the spectra, at their lines
    gravity : [m/s²], for channels that do not feel a tilt

    Raises
    ------
    BadInput : the dynamic mass has other lines than the spectra.
    """
    if dynamic_mass.frequency.shape != spectra.frequency.shape or np.any(dynamic_mass.frequency != spectra.frequency):
        problem = f"the dynamic mass has {len(dynamic_mass.frequency)} lines, the spectra have {len(spectra.frequency)} others"
        raise BadInput("closed checks", "frequency", problem, "Give it at the lines of the spectra")
    of = readings(spectra, tolerances, gravity)
    H, sd = dynamic_mass.matrix[of.lines], deviation(of)
    elastic = elasticity(of, H, sd)
    rigid = np.hypot(sd, elastic)
    departures = [
        (f"{LOADS[j]} by {MOTIONS[k]}", H[:, j, k] - H[:, k, j], np.hypot(sd[:, j, k], sd[:, k, j])) for j, k in _pairs(range(6))
    ]
    symmetry = _finding("symmetry", "the dynamic mass is symmetric", "the dynamic mass is not symmetric in {}", departures)
    unequal = [
        (f"{MOTIONS[j]} and {MOTIONS[k]}", H[:, j, j] - H[:, k, k], np.hypot(rigid[:, j, j], rigid[:, k, k]))
        for j, k in _pairs(range(3))
    ]
    unequal += [(f"{LOADS[j]} by {MOTIONS[k]}", H[:, j, k], rigid[:, j, k]) for j in range(3) for k in range(3) if j != k]
    sound = "the masses along x, y and z are one and do not couple"
    masses = _finding("equal masses", sound, "the masses along x, y and z are not one, or they couple: {}", unequal)
    own = [(f"{LOADS[j]} by {MOTIONS[j + 3]}", H[:, j, j + 3], rigid[:, j, j + 3]) for j in range(3)]
    skew = [
        (
            f"{LOADS[j]} by {MOTIONS[k + 3]} and {LOADS[k]} by {MOTIONS[j + 3]}",
            H[:, j, k + 3] + H[:, k, j + 3],
            np.hypot(rigid[:, j, k + 3], rigid[:, k, j + 3]),
        )
        for j, k in _pairs(range(3))
    ]
    coupling = _finding(
        "coupling", "the coupling of forces and rotations is skew", "the coupling is not skew in {}", [*own, *skew]
    )
    lowest = np.diagonal(H[0].real + elastic[0]) / np.diagonal(sd[0])
    negative = [MOTIONS[k] for k in np.flatnonzero(lowest <= 0).tolist()]
    text = f"the diagonal is negative for {', '.join(negative)}" if negative else "the diagonal is positive"
    diagonal = Finding(name="diagonal", holds=not negative, value=float(max(0.0, -lowest.min())), text=text)
    lags = [(f"{LOADS[k]} by {MOTIONS[k]}", np.asarray(1j * H[:, k, k].imag), rigid[:, k, k]) for k in range(6)]
    sound = "loads are in phase with the motions at low frequency"
    phase = _finding("phase", sound, "loads are out of phase with the motions at low frequency: {}", lags)
    return symmetry, masses, coupling, diagonal, phase, *_agreement(of), _channels(of)


def of_spectra(spectra: Spectra, tolerances: Tolerances = ORDINARY, *, gravity: float = STANDARD_GRAVITY) -> tuple[Finding, ...]:
    """All checks of `spectra`; without those of the dynamic mass where their runs tell none.

    Raises
    ------
    BadInput : pick-ups or load cells that tell no base motion or no resultants.
    """
    motion, load = base_motion(spectra, gravity=gravity), identification_resultants(spectra)
    try:
        estimate = from_runs(load.values, motion.values, spectra.frequency, spectra.table.origin)
    except BadInput:
        of = readings(spectra, tolerances, gravity)
        return (*_agreement(of), _channels(of))
    return checks(estimate.dynamic_mass, spectra, tolerances, gravity=gravity)


def _finding(name: str, sound: str, broken: str, departures: Iterable[Departure]) -> Finding:
    # The name and the size in tolerances of the largest of (name, departure (n,), tolerance (n,))
    sizes = {name: float(np.max(np.abs(departure) / tolerance)) for name, departure, tolerance in departures}
    key = max(sizes, key=sizes.__getitem__)
    where, value = key, sizes[key]
    holds = value**2 <= LIMIT
    said = sound if holds else broken.format(where)
    return Finding(name=name, holds=holds, value=value, text=f"{said} (worst {where}: {value:.2g} tolerances)")


def _pairs(indices: range) -> list[tuple[int, int]]:
    return [(j, k) for j in indices for k in indices if j < k]


def _agreement(of: Readings) -> tuple[Finding, Finding]:
    found = misfit(of, of.values[None], of.noise[None])
    return (
        _agreed(
            "redundancy",
            found.redundancy,
            "the accelerometers of table and cover plate {} one base motion",
            ("tell", "do not tell"),
        ),
        _agreed("parity", found.parity, "the redundant force channels {}", ("agree", "contradict each other")),
    )


def _agreed(name: str, square: Array, sentence: str, words: tuple[str, str]) -> Finding:
    value, holds = float(np.sqrt(square[0])), bool(square[0] <= LIMIT)
    return Finding(name=name, holds=holds, value=value, text=f"{sentence.format(words[not holds])} ({value:.2g} tolerances rms)")


def _channels(of: Readings) -> Finding:
    found, total = suspects(of), misfit(of, of.values[None], of.noise[None])
    value = float(np.sqrt(total.worst[0]))
    if not found:
        text = (
            "no channel is suspected" if value**2 <= LIMIT else "something is wrong that no wrong sign, exchange or unit explains"
        )
        return Finding(name="channels", holds=value**2 <= LIMIT, value=value, text=text)
    words = " or ".join(one.text for one in found)
    enough = "" if found[0].explains else ", which is not enough: look for more behind it"
    return Finding(name="channels", holds=False, value=value, text=f"it looks as if {words}{enough}", suspects=found)
