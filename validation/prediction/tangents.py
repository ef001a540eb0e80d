"""How reduced matrices change with one parameter, and how their losses are taken, with all derivatives."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array, Integers
from validation.effects.stages import Matrices, Shares
from validation.estimation.problem import Offsets


@dataclass(frozen=True, eq=False, kw_only=True)
class Tangent:
    """d `Matrices` / d offset of one parameter.

    Attributes
    ----------
    at : (s,) the coordinates concerned; coordinates that later effects append need no change here
    mass, stiffness, viscous, structural : (s, s); of one with a `crossing` (s,) by which its row grows, and its column
    parts : by name (k, k), where the share of a part changes
    crossing : position in `at` of the coordinate whose row and column alone change, twice where they meet; None where more may
    lossier : the coordinate whose losses grow, and of parts with them what effects add; None of all others
    losses : by name, where the loss factor of a part changes
    """

    at: Integers
    mass: Array
    stiffness: Array
    viscous: Array
    structural: Array
    parts: Mapping[str, Array] = field(default_factory=lambda: MappingProxyType({}))
    crossing: int | None = None
    lossier: int | None = None
    losses: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))

    def entries(self, whole: Array) -> Array:
        """Those of a symmetric `whole` (k, k) that stand where the fields do."""
        if self.crossing is not None:
            return np.asarray(whole[self.at[self.crossing], self.at])
        return whole if len(self.at) == len(whole) else whole[np.ix_(self.at, self.at)]

    def times(self, name: str, motions: Array) -> Array:
        """The field `name` as a matrix (s, s) times `motions` (s, m)."""
        own: Array = getattr(self, name)
        if self.crossing is None:
            return np.asarray(own @ motions)
        pulled = np.outer(own, motions[self.crossing])
        pulled[self.crossing] += own @ motions
        return pulled


FIELDS = ("mass", "stiffness", "viscous", "structural")


NONE: Mapping[str, Array] = MappingProxyType({})


def of_arrays(size: int, parts: Mapping[str, Array] = NONE, **changes: Array) -> Tangent:
    """The tangent of full (size, size) `changes` by the names of `FIELDS`; what is not named does not change."""
    moving = np.zeros(size, dtype=bool)
    for change in changes.values():
        for axis in (0, 1):
            if not moving.all():
                moving |= change.any(axis=axis)
    at = np.flatnonzero(moving)
    nothing, whole = np.zeros((len(at), len(at))), len(at) == size
    own = {name: change if whole else change[np.ix_(at, at)] for name, change in changes.items()}
    mass, stiffness, viscous, structural = (own.get(name, nothing) for name in FIELDS)
    return Tangent(at=at, mass=mass, stiffness=stiffness, viscous=viscous, structural=structural, parts=parts)


def crossed(r: int, **changed: Array) -> Tangent:
    """The tangent d (E matrix E) / d ln e_r of symmetric matrices by the names of `FIELDS`, of which `changed` are the rows `r`
    (k,): row and column `r`, twice where they meet."""
    at = np.flatnonzero(np.logical_or.reduce([row != 0 for row in changed.values()]))
    if (where := int(np.searchsorted(at, r))) == len(at) or at[where] != r:
        at = np.insert(at, where, r)
    mass, stiffness, viscous, structural = (changed[name][at] if name in changed else np.zeros(len(at)) for name in FIELDS)
    return Tangent(at=at, mass=mass, stiffness=stiffness, viscous=viscous, structural=structural, crossing=where)


def between(before: Matrices, after: Matrices, step: float) -> Tangent:
    """(after - before) / step."""
    pairs = {name: (getattr(before, name), getattr(after, name)) for name in FIELDS}
    changes = {name: (new - old) / step for name, (old, new) in pairs.items() if new is not old}
    parts = Shares(after.parts, lambda name: (after.parts[name] - before.parts[name]) / step)
    return of_arrays(len(before.mass), parts, **changes)


def plus(one: Tangent, other: Tangent, size: int) -> Tangent:
    """The sum of both, on matrices of `size`, with the shares of parts of the `other`, and the losses that grow of the `one`."""
    some = [name for name in FIELDS if getattr(one, name).any() or getattr(other, name).any()]
    whole = {name: full(one, name, size) + full(other, name, size) for name in some}
    return replace(of_arrays(size, other.parts, **whole), lossier=one.lossier, losses=one.losses)


def scaled(matrix: Array, by: Array) -> Array:
    """(k, k) `matrix` with rows and columns times `by` (k,); itself where that is 1 everywhere."""
    return matrix if np.all(by == 1.0) else np.asarray(by[:, None] * matrix * by)


def full(tangent: Tangent, name: str, size: int) -> Array:
    """The field `name` of `tangent` on all coordinates, (size, size)."""
    whole = np.zeros((size, size))
    crossing, own = tangent.crossing, getattr(tangent, name)
    whole[np.ix_(tangent.at, tangent.at)] = own if crossing is None else tangent.times(name, np.eye(len(own)))
    return whole


# Whether the losses of a structure follow its displacement or its velocity: nobody knows, and beside a resonance it matters.
#
# Structural damping S and viscous damping that is equal to it at every resonance, C_rs = S_rs / sqrt(omega_r omega_s), take the
# same off every peak, and differ by (1 - omega / omega_r) of themselves beside it. Real joints and layers lie in between (L.
# Gaul, Mechanical Systems and Signal Processing 13 (1999), 473). So a share p of what is structural is taken for viscous:
#
#     S' = (1 - p) S ,        C' = C + p W S W ,        W = diag(omega_r^-1/2) of the nominal modes.
#
# With p beyond 0 to 1, as with less than no loss of a part, a structure would feed its motion somewhere.

DAMPING_LAW = "damping-law"
"""Of the share; one for all structures of a series."""

# Nor does anybody know whether they couple modes. What parts lose does, as S has entries beside its diagonal; what joints and air
# lose beside them, in any shape, is told by mode alone and called classical (T. K. Caughey and M. E. J. O'Kelly, J. Applied
# Mechanics 32 (1965), 583). So a share c of what lies beside the diagonal of the modes is taken away: S_rs' = (1 - c) S_rs.
# And what is told by mode couples the modes that an effect turns, unless a real structure's are classical again: of these modes
# as they stand, C_rs' = (1 - c w_rs) C_rs, w from 0 of neighbours, whose coupling has a number of its own, to 1 beyond them.

LOSS_COUPLING = "loss-coupling"
"""Of the share that is not there; one for all structures of a series."""

LAWS = (DAMPING_LAW, LOSS_COUPLING)

LIGHTEST = float(np.finfo(np.float64).tiny)
"""[kg] of a coordinate that only gives: where a model has massless degrees of freedom."""


def with_damping_law(
    matrices: Matrices,
    tangents: Mapping[str, Tangent],
    nominal: Matrices,
    offsets: Offsets,
    *,
    derivatives: bool,
    laws: Collection[str] = LAWS,
    coupling: Array | None = None,
) -> tuple[Matrices, dict[str, Tangent]]:
    """`matrices` with the shares of `offsets`, their `tangents` behind them, and those by the shares.

    Parameters
    ----------
    nominal : the matrices at offset 0 and without effects, whose modes say at which frequency the two dampings agree
    derivatives : whether any are wanted
    laws : of `LAWS` those whose shares are open
    coupling : (k, k) what of the structural damping is no loss of parts, see `Nuisances.coupling`; none by default
    """
    # (k,) omega^-1/2 of every coordinate; 0 of the base and of what effects append, which brings its own losses
    W, there = np.zeros(len(matrices.mass)), slice(nominal.base, len(nominal.mass))
    with np.errstate(over="ignore"):  # what has next to no mass moves as fast as can be
        square = np.diag(nominal.stiffness)[there] / np.maximum(np.diag(nominal.mass)[there], LIGHTEST)
    W[there] = np.where(square > 0, square, np.inf) ** -0.25
    share, apart = offsets.get(DAMPING_LAW, 0.0), offsets.get(LOSS_COUPLING, 0.0)
    own = np.outer(W > 0, W > 0).astype(np.float64)  # 1 where both coordinates lose by this law, 0 elsewhere
    beside, within = own * (1 - np.eye(len(W))), W[:, None] * W
    between, found = np.zeros_like(own), dict(tangents)
    if coupling is not None:
        between[: len(coupling), : len(coupling)] = coupling
    coupled = matrices.structural - between
    kept, together = 1 - share * own, 1 - apart * beside
    turning = share * within
    if apart:
        matrices = replace(matrices, structural=coupled * together + between)
    for name, tangent in tangents.items() if share or apart else ():
        if tangent.structural.any():
            parted = apart and not name.startswith("coupling:")
            lost = tangent.structural * tangent.entries(together) if parted else tangent.structural
            viscous = tangent.viscous + tangent.entries(turning) * lost
            found[name] = replace(tangent, structural=lost * tangent.entries(kept), viscous=viscous)
    turned = within * matrices.structural
    if derivatives and DAMPING_LAW in laws:
        found[DAMPING_LAW] = of_arrays(len(W), viscous=turned, structural=-matrices.structural * own)
    if derivatives and LOSS_COUPLING in laws:
        less = -coupled * beside
        found[LOSS_COUPLING] = of_arrays(len(W), structural=less * kept, viscous=turning * less)
    left = matrices.structural * kept
    return replace(matrices, structural=left, viscous=matrices.viscous + share * turned), found


NEIGHBOURS = 0.1
"""Greatest distance of two frequencies, as a share of the higher one, at which the damping of one mode is taken to pull at the
other: beyond it their resonances do not overlap, and the coupling is of second order in the damping."""

ROUNDING = 1e-9
"""[share] of the largest mass, or of two squared frequencies, below which a mass is none and the two are one. By definition."""


def with_losses_by_mode(
    matrices: Matrices,
    tangents: Mapping[str, Tangent],
    told: Array,
    moved: Mapping[str, Array],
    share: float,
    *,
    derivatives: bool,
) -> tuple[Matrices, dict[str, Tangent]]:
    """`matrices` without a `share` of what the losses that are `told` by mode (n, n) couple the modes by as they stand now, their
    `tangents` behind it, and that by the share; `moved` (n, n) are the derivatives of `told` by parameter."""
    found, own = dict(tangents), np.flatnonzero(np.diag(told) + (not matrices.base) * matrices.rigid[:, : len(told)].any(axis=0))
    at, size = np.ix_(own, own), len(matrices.mass)
    heavy, axes = np.linalg.eigh(matrices.mass[at])
    root = axes / np.sqrt(np.maximum(heavy, ROUNDING * heavy[-1]))
    squares, turned = np.linalg.eigh(root.T @ matrices.stiffness[at] @ root)
    shapes, squares = root @ turned, np.maximum(squares, len(own) * np.finfo(np.float64).eps * squares[-1])  # what floats: ±0
    back, lost = np.linalg.inv(shapes), shapes.T @ told[at] @ shapes
    gap, both = squares - squares[:, None], np.maximum(squares + squares[:, None], LIGHTEST)
    apart = gap / both
    weight = apart**2 / (apart**2 + NEIGHBOURS**2)

    def placed(inner: Array) -> Tangent:
        viscous = np.zeros((size, size))
        viscous[at] = -back.T @ inner @ back
        return of_arrays(size, viscous=viscous)

    away = placed(coupled := weight * lost)
    for name, tangent in tangents.items() if share else ():
        mass, stiffness = (shapes.T @ full(tangent, field, size)[at] @ shapes for field in ("mass", "stiffness"))
        more = shapes.T @ moved[name][at] @ shapes if name in moved else np.zeros_like(lost)
        if not (mass.any() or stiffness.any() or more.any()):
            continue
        # First-order perturbation (Fox & Kapoor 1968); modes that are one for rounding turn into each other by nothing
        Z = np.divide(stiffness - mass * squares, gap, out=np.zeros_like(gap), where=np.abs(apart) > ROUNDING)
        np.fill_diagonal(Z, -np.diag(mass) / 2)
        grown = np.diag(stiffness) - squares * np.diag(mass)
        parted = 2 * (squares[:, None] * grown - squares * grown[:, None]) / both**2
        inner = 2 * NEIGHBOURS**2 * apart * parted / (apart**2 + NEIGHBOURS**2) ** 2 * lost
        inner += weight * (more + Z.T @ lost + lost @ Z) - Z.T @ coupled - coupled @ Z
        less = placed(share * inner)
        found[name] = replace(plus(tangent, less, size), parts=tangent.parts)
    if derivatives:
        found[LOSS_COUPLING] = plus(found[LOSS_COUPLING], away, size) if LOSS_COUPLING in found else away
    return replace(matrices, viscous=matrices.viscous + share * full(away, "viscous", size)), found


FEW = 1e-9
"""[share] of the largest answer of each coordinate by which few directions may miss it, at any line. Held by test_matrices.py."""

SHOWN = 32
"""[count] of lines at least at which these directions are looked for. Held by test_matrices.py."""

WORTH_CONDENSING = 0.75
"""[share] of the coordinates above which nothing is condensed: that costs more than it saves. By counting."""


@dataclass(frozen=True, eq=False, kw_only=True)
class CondensedTransfer:
    """Transfer at every line, and the answers of all coordinates that its derivatives are made of.

    Attributes
    ----------
    frequency : (n,) [Hz]
    matrix : (n, r, d) complex: dynamic mass (n, 6, 6) about the article's origin, or accelerance [1/kg]
    left, right : (k, n, r), (k, n, d), by coordinate: d matrix = sign * left^T dD right
    sign : +1 of a dynamic mass, -1 of an accelerance
    decay_rate : [1/s] by which the axis is moved, see `accelerance`
    """

    frequency: Array
    matrix: ComplexArray
    left: ComplexArray
    right: ComplexArray
    sign: float
    decay_rate: float | Array = 0.0

    @property
    def omega(self) -> npt.NDArray[Any]:
        """(n,) [rad/s], s / i of every line."""
        return turning(self.frequency, self.decay_rate)


def turning(frequency: Array, decay_rate: float | Array) -> npt.NDArray[Any]:
    """(n,) [rad/s] s / i at `frequency` (n,) [Hz] on the axis s = i omega + decay_rate, real where that is 0."""
    omega = 2 * np.pi * frequency
    return omega - 1j * decay_rate if np.any(decay_rate) else omega


def transfer_tangents(
    answered: CondensedTransfer, changes: Mapping[str, Tangent], few: Sequence[tuple[Array, ComplexArray]] = ()
) -> dict[str, ComplexArray]:
    """By parameter d matrix / d offset, (n, r, d). What changes one row and its column alone is met on the coordinates that it
    has, all else along `few` directions (k, w) of what was `answered`, left and right, where those are known."""
    made, omega = {}, answered.omega[:, None, None]
    factors = [answered.sign * one for one in (np.ones_like(omega), -1 / omega**2, -1j / omega, -1j / omega**2)]
    (_, n, r), d = answered.left.shape, answered.right.shape[2]
    for name, change in changes.items():
        # Each field by itself: those that do not change cost nothing, nor do coordinates that do not
        row = len(change.at) and change.at[-1] + 1 - change.at[0] == len(change.at)
        at = slice(change.at[0], change.at[-1] + 1) if row else change.at  # of neighbours nothing is copied
        fields = [(one, by) for field, by in zip(FIELDS, factors, strict=True) if (one := getattr(change, field)).any()]
        left, right = answered.left[at], answered.right[at]
        if few and change.crossing is None:
            (V, left), (W, right) = few
            fields = [(V[at].T @ (matrix @ W[at]), factor) for matrix, factor in fields]
        found = [factor * _product(left, matrix, right, change.crossing) for matrix, factor in fields]
        made[name] = sum(found[1:], found[0]) if found else np.zeros((n, r, d), dtype=np.complex128)
    return made


def along_few(*sides: ComplexArray) -> list[tuple[Array, ComplexArray]]:
    """Of each of `sides` (k, n, r) the directions (k, w) in which it lies, and how far along each (w, n, r); none where they are
    not few. What follows without a resonance near the band goes smoothly; every line is held against what some show."""
    from scipy.linalg import qr

    found: list[tuple[Array, ComplexArray]] = []
    for side in sides:
        if found and side is sides[0]:
            return 2 * found
        k, n, r = side.shape
        size = np.abs(side).max(axis=(1, 2))
        size[size == 0] = 1.0
        own = np.divide(side, size[:, None, None], order="C")
        seen = np.ascontiguousarray(own[:, :: max(n // SHOWN, 1)]).reshape(k, -1)
        seen /= np.maximum(np.abs(seen).max(axis=0), LIGHTEST)  # each line as large as any other
        axes, told, _ = qr(seen.view(np.float64), mode="economic", pivoting=True, check_finite=False)
        told, flat = np.abs(np.diag(told)), own.reshape(k, -1).view(np.float64)
        W = axes[:, : np.count_nonzero(told > FEW / k * told[0])]
        along = W.T @ flat
        if W.shape[1] > k * WORTH_CONDENSING or np.abs(flat - W @ along).max() > FEW:
            return []
        found.append((size[:, None] * W, along.view(np.complex128).reshape(-1, n, r)))
    return found


def _product(left: ComplexArray, matrix: Array, right: ComplexArray, crossing: int | None) -> ComplexArray:
    """left^T matrix right, (n, r, d), of sides (k, n, r) and (k, n, d): one real product for all lines."""
    if crossing is not None:  # the same of a row `matrix` (k,) that is the column, too: two sums over the coordinates
        sums = [(matrix @ one.reshape(len(one), -1).view(np.float64)).view(np.complex128) for one in (left, right)]
        whole, beyond = (one.reshape(side.shape[1:]) for one, side in zip(sums, (left, right), strict=True))
        return np.asarray(left[crossing][:, :, None] * beyond[:, None] + whole[:, :, None] * right[crossing][:, None])
    k, n, d = right.shape
    pulled = (matrix @ right.reshape(k, n * d).view(np.float64)).view(np.complex128).reshape(-1, n, d)
    return np.asarray(left.transpose(1, 2, 0) @ pulled.transpose(1, 0, 2))
