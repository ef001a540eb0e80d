"""Base motion and resultants: the paper's Eqs. 2, 3, 6 and 7 on spectra, and how far channels contradict each other.

What accelerometers on a rigid cover plate read is y = G u, with a row d^T [G] each (Eq. 3). Six motions u of the reference
point F follow from more than six readings by weighted least squares (Eq. 2; Eq. 7 with equal weights)

    u = (G^T W G)^-1 G^T W y

with W the inverse noise variance. What is left, y - G u, is the only thing that the data say about themselves: eight readings
of six motions leave two combinations that must be zero.

Pick-ups of the table and of the cover plate are never used together unless asked for: load cells give way between them.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np
import numpy.typing as npt

from geometry import sensors
from geometry.dynamic_mass import MOTIONS, ComplexArray, DynamicMass
from geometry.errors import BadInput
from geometry.frames import Array, freeze
from geometry.inertia import combination, of_motions, of_resultants
from geometry.sensors import ChannelTable, motion_rows
from identification.campaign import NOMINAL
from identification.spectra.line_spectra import Spectra

# Gravity has two halves: the weight of a tilted body, and the tilt that accelerometers feel. Here is the one that is missing.
#
# What an accelerometer reads is a - g in its own axes, the *apparent* acceleration, and a body that tilts with the base answers
# to just that: f = H u with apparent u has no term of gravity. A *kinematic* motion - optical, or the table's control - lacks
# it:
#
#     u_apparent = (1 + g/omega² E) u_kinematic,    E[x, beta] = 1, E[y, alpha] = -1
#
# A dynamic mass against kinematic motions is H (1 + g/omega² E), not symmetric any more; E² = 0, so its inverse is 1 - g/omega²
# E.

TILT = np.zeros((6, 6))
"""E, the one place where its signs stand."""
TILT[MOTIONS.index("x"), MOTIONS.index("beta")] = 1.0
TILT[MOTIONS.index("y"), MOTIONS.index("alpha")] = -1.0
TILT.setflags(write=False)


def tilt(frequency: npt.ArrayLike, gravity: float) -> Array:
    """(n, 6, 6) apparent from kinematic accelerations at `frequency` (n,) [Hz], `gravity` [m/s²].

    Raises
    ------
    BadInput : a line at 0 Hz, where an acceleration tells no tilt.
    """
    lines = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    if gravity and not np.all(lines > 0):
        problem = f"a tilt follows from an acceleration above 0 Hz only, found {lines.min():g} Hz"
        raise BadInput("gravity", "frequency", problem, "Leave the line out")
    share = np.divide(gravity, (2 * np.pi * lines) ** 2, out=np.zeros_like(lines), where=lines > 0)
    return np.asarray(np.eye(6) + share[:, None, None] * TILT)


def against_apparent(dynamic_mass: DynamicMass, gravity: float) -> DynamicMass:
    """A dynamic mass measured against kinematic motions, as it is against apparent ones."""
    H = dynamic_mass.matrix @ np.linalg.inv(tilt(dynamic_mass.frequency, gravity))
    return DynamicMass(frequency=dynamic_mass.frequency, matrix=H, reference_point=dynamic_mass.reference_point)


STANDARD_GRAVITY = 9.81
"""[m/s²] where a campaign does not state its own: that of the campaign format."""


@dataclass(frozen=True, eq=False, kw_only=True)
class BaseMotion:
    """Six base motions of the reference point, run by run and line by line: the *apparent* ones (`identification.base_motion`).

    Attributes
    ----------
    channels : (c,) names of the accelerometers used
    values : (r, n, 6) complex, order of `MOTIONS`, in the unit of the spectra
    covariance : (r, n, 6, 6) of the noise in them, E[e e^H]; 0 where the noise is not known
    residual : (r, n, c) complex, what each accelerometer reads beyond the motion
    expected : (r, n, c) standard deviation that noise alone gives this residual; 0 where the noise is not known
    sigmas : (r, c) rms of residual / expected over the lines; nan where the noise is not known or nothing is redundant
    percent : (r, c) rms of the residual, in per cent of the rms reading of all these accelerometers in the run
    redundancy : how many readings there are beyond six
    warnings : sentences
    """

    channels: tuple[str, ...]
    values: ComplexArray
    covariance: Array
    residual: ComplexArray
    expected: Array
    sigmas: Array
    percent: Array
    redundancy: int
    warnings: tuple[str, ...] = ()


def base_motion(
    spectra: Spectra,
    *,
    groups: Sequence[str] | None = None,
    weights: npt.ArrayLike | None = None,
    gravity: float = STANDARD_GRAVITY,
) -> BaseMotion:
    """The base motion of every run (Eqs. 2, 3, 6, 7).

    Parameters
    ----------
    spectra : of a campaign
    groups : of `geometry.sensors.GROUPS`; by default the cover plate where it tells all six motions, else the table
    weights : a number for each channel of `groups` in the order of the table, inverse variances up to a factor; by default the
        inverse variance of the noise, or equal weights in runs where the noise of a channel is not known
    gravity : [m/s²], by which the readings of channels that do not feel it differ

    Raises
    ------
    BadInput : the accelerometers do not tell six motions, which are missing; weights that are none.
    """
    used = groups_used(spectra.table) if groups is None else tuple(groups)
    verdict = of_motions(spectra.table, used)
    if not verdict.complete:
        problem = f"the accelerometers of {' and '.join(used)} do not tell the six base motions: {verdict.text}"
        raise BadInput("base motion", "channel", problem, f"Add one that sees {', '.join(verdict.missing)}, or use another group")
    chosen = spectra.table.select(group=used, quantity="acceleration")
    G = rows_at_lines(spectra, chosen, gravity)
    # (r, n, c) as (1, n, c) where all runs have the same: what follows from it is computed once
    each_run = spectra.noise[:, :, chosen]
    noise = each_run[:1] if np.all(each_run == each_run[:1]) else each_run
    roots = _roots(noise, weights)
    T = np.linalg.pinv(roots[..., None] * G) * roots[:, :, None, :]  # (r, n, 6, c): [T] of Eq. 6, weighted
    y = spectra.values[:, :, chosen]
    u = (T @ y[..., None])[..., 0]
    residual = y - (G @ u[..., None])[..., 0]
    # (r, n, c) standard deviation of the residual (I - G T) n; 0 where rounding is all that is left
    left = np.eye(G.shape[1]) - G @ T
    sd = np.sqrt((left**2 @ noise[..., None] ** 2)[..., 0])
    expected = np.broadcast_to(np.where(sd > 1e-6 * noise, sd, 0.0), y.shape)
    covariance = (T * noise[:, :, None, :] ** 2) @ T.swapaxes(2, 3)
    warnings: tuple[str, ...] = ()
    if {"table", "cover"} <= set(used):
        rigid = "they are taken for one rigid body, load cells for rigid"
        warnings = (f"base motion from table and cover plate together: {rigid}",)
    elif "cover" not in used:
        lacking = of_motions(spectra.table, ("cover",)).text
        warnings = (f"base motion from {' and '.join(used)}: cells are taken for rigid (the cover plate: {lacking})",)
    return BaseMotion(
        channels=tuple(spectra.table.names[k] for k in chosen),
        values=u,
        covariance=np.broadcast_to(covariance, (*u.shape, 6)),
        residual=residual,
        expected=expected,
        sigmas=in_sigmas(residual, expected),
        percent=in_percent(residual, y),
        redundancy=len(chosen) - 6,
        warnings=warnings,
    )


def groups_used(table: ChannelTable) -> tuple[str, ...]:
    """The cover plate where its accelerometers tell all six motions, else the table; never both, since load cells give way.

    Raises
    ------
    BadInput : neither does.
    """
    for group in ("cover", "table"):
        if of_motions(table, (group,)).complete:
            return (group,)
    cover, below = of_motions(table, ("cover",)), of_motions(table, ("table",))
    both = of_motions(table, ("table", "cover")).complete
    together = "Together they do: ask for both groups, and mind that the load cells between them give way" if both else ""
    problem = f"neither the cover plate ({cover.text}) nor the table ({below.text}) tells the six base motions"
    remedy = together or f"Add an accelerometer to the cover plate that sees {', '.join(cover.missing)}"
    raise BadInput("base motion", "channel", problem, remedy)


def rows_at_lines(spectra: Spectra, chosen: Sequence[int], gravity: float) -> Array:
    """(n, c, 6): what the channels `chosen` read for unit *apparent* motions of the reference point, line by line."""
    channels = [spectra.table.channels[k] for k in chosen]
    G = np.broadcast_to(motion_rows(channels, spectra.table.origin), (len(spectra.frequency), len(channels), 6)).copy()
    kinematic = [k for k, channel in enumerate(channels) if not channel.senses_gravity]
    if kinematic:
        G[:, kinematic] = G[:, kinematic] @ np.linalg.inv(tilt(spectra.frequency, gravity))
    return G


def in_sigmas(residual: ComplexArray, expected: Array) -> Array:
    """(r, k): rms over the lines of (r, n, k) residuals, each divided by the standard deviation expected of it."""
    known = expected > 0
    ratio = np.abs(residual) / np.where(known, expected, 1.0)
    found = np.sqrt(np.mean(ratio**2, axis=1))
    return np.asarray(np.where(known.all(axis=1), found, np.nan))


def in_percent(residual: ComplexArray, readings: ComplexArray) -> Array:
    """(r, k): rms over the lines of (r, n, k) residuals in per cent of the rms reading of all channels of the run."""
    level = np.sqrt(np.mean(np.abs(readings) ** 2, axis=(1, 2)))[:, None]
    return np.asarray(100 * np.sqrt(np.mean(np.abs(residual) ** 2, axis=1)) / np.where(level > 0, level, 1.0))


def _roots(noise: Array, weights: npt.ArrayLike | None) -> Array:
    """(r, n, c) square roots of the weights, about 1."""
    if weights is not None:
        given = np.asarray(weights, dtype=np.float64)
        if given.shape != noise.shape[2:] or not np.all(np.isfinite(given) & (given > 0)):
            problem = f"a positive weight for each of {noise.shape[2]} channels is needed, found {given.tolist()}"
            raise BadInput("base motion", "weights", problem, "Leave them out for those of the noise")
        return np.broadcast_to(np.sqrt(given / given.mean()), noise.shape)
    known = np.all(noise > 0, axis=(1, 2))[:, None, None]
    least = np.where(known, noise.min(axis=2, keepdims=True), 1.0)
    return np.where(known, least / np.where(known, noise, 1.0), 1.0)


# How well the runs tell six base motions apart, line by line, and in words where they do not.
#
# Columns of S_u are runs. Every row is divided by the nominal level of its axis, so that metres stand beside radians; the
# condition number of what is left does not know units. The left singular vector of the smallest singular value is the
# combination of base motions that the runs drive least: where it holds one motion alone, that one is hardly driven; where it
# holds several, they move together in every run and cannot be told apart.

SINGULAR = 1e9
"""Condition number of the scaled base motions from which runs do not tell six motions apart: what is left is rounding."""

SHARE = 0.1
"""Share of the largest from which a base motion counts as part of the combination that is driven least."""

IN_PHASE = 0.1
"""Imaginary share of a combination from which its motions do not move in phase."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DrivenMotions:
    """What the runs drive.

    Attributes
    ----------
    frequency : (n,) [Hz]
    singular : (n, 6) singular values of the base motions, every axis divided by its nominal level; descending
    directions : (n, 6, 6) complex: column k is the combination of scaled base motions that belongs to the k-th of them
    """

    frequency: Array
    singular: Array
    directions: ComplexArray

    def __post_init__(self) -> None:
        freeze(self, "frequency", singular=(*self.frequency.shape, 6))

    @property
    def condition(self) -> Array:
        """(n,) condition number [1] of the scaled base motions; up to 1e16, where rounding is all that is left."""
        largest = np.maximum(self.singular[:, 0], np.finfo(np.float64).tiny)
        return np.asarray(1 / np.maximum(self.singular[:, -1] / largest, 1e-16))

    @staticmethod
    def of_runs(scaled: ComplexArray, frequency: Array) -> "DrivenMotions":
        """By base motions (r, n, 6) at `frequency` (n,) [Hz], every axis divided by its level."""
        directions, found, _ = np.linalg.svd(scaled.transpose(1, 2, 0))
        singular = np.zeros((len(frequency), 6))
        singular[:, : found.shape[1]] = found
        return DrivenMotions(frequency=frequency, singular=singular, directions=directions)

    def require_told_apart(self) -> None:
        """Six base motions must be told apart at every line.

        Raises
        ------
        BadInput : the runs leave a combination of base motions undriven; it is named.
        """
        worst = int(np.argmax(self.condition))
        if self.condition[worst] >= SINGULAR:
            where = f"at {self.frequency[worst]:g} Hz (condition number {self.condition[worst]:.1e})"
            problem = f"the base motions are linearly dependent {where}: {said(self.weak(worst, SINGULAR))}"
            raise BadInput("dynamic mass from runs", "runs", problem, "Drive every one of the six axes in a run of its own")

    def excluded(self, limit: float) -> "Exclusions":
        """Lines whose condition number exceeds `limit` are left out; the reason names the base motions that move together."""
        kept = self.condition <= limit
        out = [(k, names(self.weak(k, limit))) for k in np.flatnonzero(~kept).tolist()]
        reasons = []
        # Neighbours with the same motions share a sentence: index minus rank is constant in a run of neighbours.
        for _, stretch in groupby(enumerate(out), key=lambda item: (item[1][0] - item[0], item[1][1])):
            lines = [k for _, (k, _) in stretch]
            f, condition = self.frequency[lines], self.condition[lines]
            where = f"{f[0]:g} Hz is" if len(f) == 1 else f"{f[0]:g} to {f[-1]:g} Hz ({len(f)} lines) are"
            allowed = f"condition number up to {condition.max():.3g} where {limit:g} is allowed"
            worst = self.weak(lines[int(np.argmax(condition))], limit)
            reasons.append(f"{where} left out, {allowed}: {said(worst)}")
        return Exclusions(kept=kept, reasons=tuple(reasons))

    def weak(self, line: int, limit: float) -> ComplexArray:
        """(6, k) combinations of the scaled base motions at `line` that are driven less than 1 / `limit` of the strongest."""
        open_ = self.singular[line] * limit <= self.singular[line, 0]
        return np.asarray(self.directions[line][:, open_ if open_.any() else [-1]])


@dataclass(frozen=True, eq=False, kw_only=True)
class Exclusions:
    """Which lines are left out, and why.

    Attributes
    ----------
    kept : (n,) bool
    reasons : sentences, one for each stretch of neighbouring lines that are left out for the same reason
    """

    kept: np.ndarray[tuple[int], np.dtype[np.bool_]]
    reasons: tuple[str, ...]


def names(weak: ComplexArray) -> tuple[str, ...]:
    """The base motions that take part in the combinations `weak` (6, k)."""
    size = np.linalg.norm(weak, axis=1)
    return tuple(name for name, part in zip(MOTIONS, size, strict=True) if part >= SHARE * size.max())


def said(weak: ComplexArray) -> str:
    """What it means that the combinations `weak` (6, k) of scaled base motions are not driven."""
    involved = names(weak)
    listed = " and ".join(part for part in (", ".join(involved[:-1]), involved[-1]) if part)
    if len(involved) == weak.shape[1]:  # the axes themselves span what is not driven
        return f"hardly any run drives {listed}"
    if weak.shape[1] > 1:
        return f"{listed} move together so that {weak.shape[1]} combinations of them hardly move in any run"
    # The combination that stands still is v^H u, so shares are conjugate; the largest is real
    size, largest = np.abs(weak[:, 0]), weak[int(np.argmax(np.abs(weak[:, 0]))), 0]
    share = np.where(size >= SHARE * size.max(), np.conj(weak[:, 0]) * largest / np.abs(largest), 0)
    lag = ", partly out of phase," if np.abs(share.imag).max() > IN_PHASE * size.max() else ""
    still = combination(share.real, MOTIONS) + lag
    return f"{listed} move together: {still} hardly moves in any run (every motion as a share of its level)"


# What the base motion would be without each of its accelerometers: how far it moves, how much noise grows, what is lost.
#
# An accelerometer whose absence moves a motion by much contradicts the others; one whose absence leaves a motion untold is the
# only one that sees it, and its errors go into the result unseen.


@dataclass(frozen=True, eq=False, kw_only=True)
class Loss:
    """The effect of losing one accelerometer.

    Attributes
    ----------
    channel : its name
    lost : of `MOTIONS`, what the others cannot tell; none where they tell all six
    text : the same in words
    moved : (r, 6) rms over the lines of the change of each motion, as a share of the largest motion of the run, every axis
        divided by its nominal level; 0 where motions are lost
    amplification : (6,) standard deviation of the noise of each motion without the channel over that with it (median of runs and
        lines; of equal noise where it is not known); infinite where a motion is lost
    """

    channel: str
    lost: tuple[str, ...]
    text: str
    moved: Array
    amplification: Array


def without_each(spectra: Spectra, *, gravity: float = STANDARD_GRAVITY) -> tuple[Loss, ...]:
    """The effect of losing each accelerometer that `base_motion` uses, in the order of the table.

    Raises
    ------
    BadInput : as of `base_motion`.
    """
    used = groups_used(spectra.table)
    known = _only(spectra, spectra.table.select(group=used, quantity="acceleration"))
    if not np.all(known.noise > 0):  # equal noise then: what matters here is how it spreads
        known = replace(known, noise=np.ones_like(known.noise))
    whole, found = base_motion(known, groups=used, gravity=gravity), []
    size = np.sqrt(np.mean(np.abs(whole.values / NOMINAL) ** 2, axis=1)).max(axis=1)
    for gone, name in enumerate(known.table.names):
        left = _only(known, [k for k in range(len(known.table)) if k != gone])
        verdict = of_motions(left.table, used)
        if not verdict.complete:
            untold, text = np.zeros((len(known.runs), 6)), f"without {name} {verdict.text}"
            found.append(Loss(channel=name, lost=verdict.missing, text=text, moved=untold, amplification=np.full(6, np.inf)))
            continue
        rest = base_motion(left, groups=used, gravity=gravity)
        amplification = np.sqrt(np.median(_variance(rest) / _variance(whole), axis=(0, 1)))
        change = np.sqrt(np.mean(np.abs((rest.values - whole.values) / NOMINAL) ** 2, axis=1))
        moved = np.asarray(change / np.where(size > 0, size, 1.0)[:, None])
        k = int(np.argmax(moved.max(axis=0)))
        most = f"moves {MOTIONS[k]} most, by {100 * moved[:, k].max():.2g} % of the driven motion"
        text = f"without {name} {most}; noise grows up to {amplification.max():.2g} times"
        found.append(Loss(channel=name, lost=(), text=text, moved=moved, amplification=amplification))
    return tuple(found)


def _variance(motion: BaseMotion) -> Array:
    return np.asarray(np.diagonal(motion.covariance, axis1=2, axis2=3))


def _only(spectra: Spectra, chosen: Sequence[int]) -> Spectra:
    taken = list(chosen)
    values, noise = spectra.values[:, :, taken], spectra.noise[:, :, taken]
    return replace(spectra, table=spectra.table.subset(taken), values=values, noise=noise)


# `RunNoise`: the noise of loads and base motions, run by run and line by line.
#
# `identification.base_motion` and `identification.base_motion` tell it from the noise of the channels: their `covariance`.


@dataclass(frozen=True, eq=False, kw_only=True)
class RunNoise:
    """Covariances of complex noise, E n n^H, the same for all phases; motions and loads are independent of each other.

    Attributes
    ----------
    load : (r, n, 6, 6) of forces and moments about the reference point, in their units squared
    motion : (r, n, 6, 6) of the base motions about the same point
    """

    load: Array
    motion: Array

    def __post_init__(self) -> None:
        shape = np.asarray(self.load).shape
        if len(shape) != 4 or shape[2:] != (6, 6):
            raise ValueError(f"`load` must have shape (r, n, 6, 6), found {shape}")
        freeze(self, load=shape, motion=shape)


# From load-cell channels to the six resultants about F, and the combinations of channels that must balance.
#
# Eight channels y of the paper's box give six resultants f = R y (`geometry.sensors.resultants`). Two combinations are left
# that no resultant shows: how cells of equal stiffness share a load says that they are zero, for example
#
#     x12 - x34 + y14 - y23      and      z1 - z2 + z3 - z4
#
# A combination that does not balance is a wrong gain, a swapped or dead channel - or cells that are not equally stiff: an error
# of one per cent in one channel or one cell shows as a quarter of a per cent of what that channel reads.

NOTHING = 1e-9
"""Relative size below which a channel takes no part in a combination: rounding."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Resultants:
    """Six resultants about the reference point, run by run and line by line.

    Attributes
    ----------
    channels : (c,) names of the force and moment channels used
    values : (r, n, 6) complex forces and moments of the table on the structure, in the unit of the spectra
    covariance : (r, n, 6, 6) of the noise in them, E[e e^H]; 0 where the noise is not known
    combinations : (k, c) parity rows, unit vectors
    names : (k,) of the combinations, in words
    parity : (r, n, k) complex, what the combinations read; 0 for exact channels on equal cells
    expected : (r, n, k) standard deviation that noise alone gives them; 0 where the noise is not known
    sigmas : (r, k) rms of parity / expected over the lines; nan where the noise is not known
    percent : (r, k) rms of the parity, in per cent of the rms reading of all these channels in the run
    """

    channels: tuple[str, ...]
    values: ComplexArray
    covariance: Array
    combinations: Array
    names: tuple[str, ...]
    parity: ComplexArray
    expected: Array
    sigmas: Array
    percent: Array


def resultants(spectra: Spectra) -> Resultants:
    """The six resultants about the table's reference point, with covariance and parity.

    Raises
    ------
    BadInput : the load cells do not tell six resultants, which are missing.
    """
    verdict = of_resultants(spectra.table)
    if not verdict.complete:
        problem = f"the load cells do not tell the six resultants: {verdict.text}"
        raise BadInput("resultants", "channel", problem, f"Add a load cell that sees {', '.join(verdict.missing)}")
    chosen = spectra.table.select(group=("fmd",), quantity=("force", "moment"))
    channels = [spectra.table.channels[k] for k in chosen]
    names = tuple(channel.name for channel in channels)
    R = sensors.resultants(channels, spectra.table.origin)
    V = combinations(spectra.table, chosen)
    words = []
    for row in V / np.abs(V).max(axis=1, keepdims=True, initial=0.0):
        parts = [(abs(v), "-" if v < 0 else "+", name) for v, name in zip(row, names, strict=True) if v]
        terms = [f"{sign} {'' if abs(size - 1) < 1e-6 else f'{size:.3g} '}{name}" for size, sign, name in parts]
        words.append(" ".join(terms).removeprefix("+ "))
    y, noise = spectra.values[:, :, chosen], spectra.noise[:, :, chosen]
    parity = y @ V.T
    known = np.all(noise > 0, axis=2, keepdims=True)
    expected = np.where(known, np.sqrt(noise**2 @ (V**2).T), 0.0)
    return Resultants(
        channels=names,
        values=y @ R.T,
        covariance=np.einsum("kc,rnc,lc->rnkl", R, noise**2, R),
        combinations=V,
        names=tuple(words),
        parity=parity,
        expected=expected,
        sigmas=in_sigmas(parity, expected),
        percent=in_percent(parity, y),
    )


def combinations(table: ChannelTable, chosen: Sequence[int]) -> Array:
    """(k, c) unit rows of the combinations of the force and moment channels `chosen` that equal cells balance.

    With equal stiffness the cells share a load f as B (B^T B)^-1 f, and a combination v of the sums S balances when v S B = 0.
    The rows are as sparse as elimination makes them: a lateral one and a vertical one are not mixed.
    """
    of = sensors.summation([table.channels[k] for k in chosen], table.origin)
    shown = of.adds @ of.gives.T  # (c, 6): what a channel reads of each load, up to (B^T B)^-1
    scale = np.linalg.norm(shown, axis=0)
    U, singular, _ = np.linalg.svd(shown / np.where(scale > 0, scale, 1.0))
    rank = int(np.sum(singular > 1e-6 * singular[0]))
    null = U[:, rank:]
    count = null.shape[1]
    if not count:
        return np.zeros((0, len(null)))
    # The channels that `null` sees most, each beside those before it; as Householder's QR with pivots, without importing SciPy
    left, pivots = np.array(null), []
    for _ in range(count):
        pivots.append(int(np.argmax(np.linalg.norm(left, axis=1))))
        along = left[pivots[-1]] / np.linalg.norm(left[pivots[-1]])
        left -= np.outer(left @ along, along)
    rows = np.linalg.solve(null[pivots].T, null.T)
    rows[np.abs(rows) < NOTHING * np.abs(rows).max()] = 0.0
    rows = rows[np.argsort([int(np.flatnonzero(row)[0]) for row in rows], kind="stable")]
    first = np.array([np.sign(row[np.flatnonzero(row)[0]]) for row in rows])
    return np.asarray(rows * first[:, None] / np.linalg.norm(rows, axis=1, keepdims=True))
