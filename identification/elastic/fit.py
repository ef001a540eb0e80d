"""The ten inertia parameters together with the elastic terms of Eq. 8b, from a measured dynamic mass and nothing else.

Poles are added one by one where they take most out of what is left (`next_poles`), all parameters are refined together after each
(`refine`), and a pole stays when it pays: when it lowers chi² by more than its eight parameters would by chance and model error
(Schwarz, Ann. Statist. 6 (1978) 461, with the misfit of the best model as the unit of chi²). H(0) = M_F is the extrapolation.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import ComplexArray, DynamicMass
from geometry.errors import BadInput
from geometry.frames import Array, Integers, freeze
from geometry.inertia import Inertia
from identification.elastic import model
from identification.elastic.model import SCALE, UPPER, ElasticLayout, ElasticTerms

# `Lines`: a measured dynamic mass as weighted data: symmetric, with standard deviations, thinned where nothing happens.
#
# A gain, an angle or a cross-talk of a sensor that is off makes an error in proportion to what else that row and that column
# carry, alike at neighbouring lines. So the model-error floor is a share of the level of row and column at the line, and lines
# away from resonances, which repeat the same error, count once in a quarter of a hertz.

LINES_APART = 0.25
"""Distance [Hz] of lines that are kept where the dynamic mass is smooth."""

CHANGE = 0.03
"""Change of an entry, in its level, from which the next line is kept too."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Lines:
    """Upper triangles of H, the two measured halves averaged by their weights.

    Attributes
    ----------
    frequency : (n,) [Hz]
    values : (n, 21) complex, order of `model.UPPER`
    deviation : (n, 21) standard deviation of the complex error, noise and floor together
    asymmetry : (2,) chi² of the differences of the two halves, which no symmetric model explains, and their number
    """

    frequency: Array
    values: ComplexArray
    deviation: Array
    asymmetry: tuple[float, int]

    @property
    def count(self) -> int:
        """Real numbers in the data."""
        return 2 * self.values.size

    def at(self, chosen: npt.ArrayLike) -> "Lines":
        """The lines that `chosen` (mask or indices) picks."""
        k = np.asarray(chosen)
        return Lines(frequency=self.frequency[k], values=self.values[k], deviation=self.deviation[k], asymmetry=self.asymmetry)


def lines_of(measured: DynamicMass, noise: npt.ArrayLike | None, floor: float, band: tuple[float, float] | None) -> Lines:
    """All lines of `measured` in `band`.

    Parameters
    ----------
    noise : (n, 6, 6) standard deviation of the complex noise of H, in its units; none when None
    floor : model error as a share of the level of row and column

    Raises
    ------
    BadInput : no lines in the band, noise of another shape, a deviation that is not above zero.
    """
    low, high = band or (-np.inf, np.inf)
    inside = (measured.frequency >= low - 1e-9) & (measured.frequency <= high + 1e-9) & (measured.frequency > 0)
    if np.sum(inside) < 2:
        raise _refused("band", f"at least two lines are needed, found {np.sum(inside)} in {low:g} to {high:g} Hz", "Widen it")
    H = measured.matrix[inside]
    sd = floor * levels(H)
    if noise is not None:
        given = np.asarray(noise, dtype=np.float64)
        if given.shape != measured.matrix.shape or not np.all(given >= 0):
            problem = f"one standard deviation for each entry {measured.matrix.shape} is needed, found {given.shape}"
            raise _refused("weights", problem, "Give those of the dynamic mass, at least 0")
        sd = np.hypot(sd, given[inside])
    if not np.all(sd > 0):
        raise _refused("floor", "without noise a floor above zero is needed to weigh entries", "Leave the default, 0.002")
    frequency = measured.frequency[inside]
    i, j = UPPER
    off = i != j
    a, b, va, vb = H[:, i, j], H[:, j, i], sd[:, i, j] ** 2, sd[:, j, i] ** 2
    values = np.where(off, (a * vb + b * va) / (va + vb), a)
    variance = np.where(off, va * vb / (va + vb), va)
    chi2 = float(np.sum(2 * np.abs(a - b)[:, off] ** 2 / (va + vb)[:, off]))
    return Lines(
        frequency=frequency, values=values, deviation=np.sqrt(variance), asymmetry=(chi2, 2 * len(frequency) * int(np.sum(off)))
    )


def levels(H: ComplexArray) -> Array:
    """(n, 6, 6) in the units of H: root mean square of its row and its column, rotations divided by their nominal length."""
    scale = np.outer(SCALE, SCALE)
    power = np.abs(H / scale) ** 2
    return np.asarray(scale * np.sqrt((power.sum(axis=2)[:, :, None] + power.sum(axis=1)[:, None, :]) / 2))


def kept(lines: Lines, measured: ComplexArray | None = None) -> Integers:
    """Indices of lines that say something new: `LINES_APART`, or where an entry changed by `CHANGE` of its level."""
    H = model.whole(lines.values) if measured is None else measured
    values = (H / levels(H))[:, UPPER[0], UPPER[1]]
    chosen = [0]
    for k in range(1, len(values)):
        last = chosen[-1]
        moved = np.abs(values[k] - values[last]).max() >= CHANGE
        if moved or lines.frequency[k] - lines.frequency[last] >= LINES_APART - 1e-9 or k == len(values) - 1:
            chosen.append(k)
    return np.array(chosen)


def _refused(field: str, problem: str, remedy: str) -> BadInput:
    return BadInput("elastic fit", field, problem, remedy)


# All parameters together by Levenberg and Marquardt: normal equations of weighted lines, analytic derivatives.
#
# Priors keep what the data do not say: a structure is lightly damped (a factor of 4.5 either way about 0.4 %), a pole belongs to
# the band unless the data say otherwise, and coupling of damping does not exceed what its two modes have. Against data they
# weigh nothing: a resonance tells ln f a thousand times better.
#
# Source: Marquardt, J. SIAM 11 (1963) 431; its damping as in Nielsen, IMM-REP-1999-05, Technical University of Denmark.

DAMPING_PRIOR = (np.log(0.004), 1.5)
"""Mean and standard deviation of ln zeta."""

REACH = (0.5, 2.5)
"""How far out of the band a pole may go, of its lower and of its upper end: beyond, it is an error and no mode."""

RATIOS = (2e-4, 0.1)
"""Damping ratios of a resonance: above them it is a slope that other poles lack, below them an error of one line."""

COUPLING = 0.3
"""Standard deviation of rho."""

TIGHTEST = 0.95
"""Largest rho: at 1 a pair would have a motion without damping."""

ENOUGH = 0.03
"""Gain of chi² that is no gain: a sixth of a standard deviation."""

HOPELESS = 1e8
"""Damping at which a step is too short to gain by anything but rounding."""

STEP = 0.3
"""Largest step of a logarithm or a coupling."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Refined:
    """Where an iteration ended.

    Attributes
    ----------
    vector : (k,) of `layout`
    chi2 : of the data alone
    cost : of data and priors
    residual : (N,) fitted less measured, weighted, N = 42 n: line by line, entry by entry, real and imaginary
    slope : (k,) J^T r, gradient of half the data's cost
    prior : (k,) gradient of half the priors' cost
    certainty : (k,) inverse variance of the priors, 0 where there is none
    information : (k, k) J^T J with the priors
    converged : whether it ended by itself
    """

    layout: ElasticLayout
    vector: Array
    chi2: float
    cost: float
    residual: Array
    slope: Array
    prior: Array
    certainty: Array
    information: Array
    converged: bool

    def _step(self, damping: float, lines: Lines) -> tuple[Array, float]:
        """The vector of the next trial and what cost it should save; what stands at a limit and pushes against it stays."""
        x, A, blocks = self.vector, self.information, self.layout.blocks
        g = self.slope + self.prior
        limited = slice(blocks["frequency"].start, blocks["pairs"].stop)
        low, high = np.full(len(x), -np.inf), np.full(len(x), np.inf)
        low[limited], high[limited] = limits(self.layout, lines)
        free = ~(((x <= low) & (g > 0)) | ((x >= high) & (g < 0)))
        d = unit_of(A)[free]
        scaled = A[np.ix_(free, free)] / np.outer(d, d) + damping * np.eye(len(d))
        dx = np.zeros(len(x))
        dx[free] = -np.linalg.solve(scaled, g[free] / d) / d
        dx *= min(1.0, STEP / max(np.abs(dx[limited]).max(initial=0.0), STEP))
        trial = np.clip(x + dx, low, high)
        dx = trial - x
        return trial, float(-2 * g @ dx - dx @ A @ dx)

    @property
    def effective_size(self) -> float:
        """Parameters that the data decide and not the priors: k less the share of the priors in what is known of each."""
        d = unit_of(self.information)
        variance = np.diag(np.linalg.pinv(self.information / np.outer(d, d), hermitian=True)) / d**2
        return len(self.vector) - float(self.certainty @ variance)

    @property
    def correlation_time(self) -> float:
        """Lines that repeat the same error, 1 and more: the sum of the autocorrelation of what is left up to its first zero."""
        r = self.residual.reshape(-1, 42)
        lags = [float(np.sum(r[k:] * r[: len(r) - k])) for k in range(len(r) // 2)]
        ends = next((k for k, lag in enumerate(lags) if lag <= 0), len(lags))
        return 1 + 2 * sum(lags[1:ends]) / lags[0] if lags and lags[0] > 0 else 1.0

    def _room(self, lines: Lines) -> Array:
        """(m,) distance of ln f and ln zeta of every pole from where a resonance ends."""
        blocks, m = self.layout.blocks, self.layout.modes
        x = self.vector[blocks["frequency"].start : blocks["damping"].stop]
        low, high = (limit[: 2 * m] for limit in limits(self.layout, lines))
        return np.asarray(np.minimum(x - low, high - x).reshape(2, m).min(axis=0, initial=np.inf))

    def _worth(self, r: int) -> float:
        """What chi² would rise by without pole r, to second order in its participation, all else refitted (Wald)."""
        place = self.layout.blocks["participation"].start + 6 * r + np.arange(6)
        covariance = np.linalg.pinv(self.information)[np.ix_(place, place)]
        return float(self.vector[place] @ np.linalg.solve(covariance, self.vector[place]))


def refine(start: Array, layout: ElasticLayout, lines: Lines, *, iterations: int = 40, accuracy: float = 3e-5) -> Refined:
    """From the vector `start` (k,) downhill until a step gains less than `accuracy` of the cost and `ENOUGH`.

    Not converged when `iterations` steps did not do; none only linearises at `start`.
    """
    at, damping, rise = linearised(start, layout, lines), 1e-3, 2.0
    for _ in range(iterations):
        trial, predicted = at._step(damping, lines)
        there = evaluated(trial, layout, lines)
        left = np.concatenate([weighted(there[1], lines), _prior(trial, layout, lines)[0]])
        gained = at.cost - float(left @ left)
        if gained > 0 and predicted > 0:
            at, rise = linearised(trial, layout, lines, there), 2.0
            damping *= max(0.1, 1 - (2 * gained / predicted - 1) ** 3)
        else:
            damping, rise = damping * rise, 2 * rise
        if damping > HOPELESS or 0 <= max(gained, predicted) < accuracy * at.cost + ENOUGH:
            return replace(at, converged=True)
    return at


def evaluated(x: Array, layout: ElasticLayout, lines: Lines) -> tuple[ComplexArray, ComplexArray]:
    """What the modes answer (n, m, 6), and fitted less measured (n, 21), in the units of H."""
    _, terms = model.unpack(x, layout)
    X, mass = model.answers(terms, lines.frequency), np.tensordot(x[:10], model.inertia_basis(), axes=1)
    return X, np.asarray(model.by_answers(mass, terms, lines.frequency, X)[:, UPPER[0], UPPER[1]] - lines.values)


def weighted(values: ComplexArray, lines: Lines) -> Array:
    """(..., n, 21) complex as (..., 42 n) real of unit variance: that of a complex error is shared by its two parts."""
    scaled = np.multiply(values, np.sqrt(2) / lines.deviation, order="C")
    return np.asarray(scaled.reshape(*values.shape[:-2], -1).view(np.float64))


def unit_of(information: Array) -> Array:
    """(k,) by which a normal matrix is divided to have ones on its diagonal; 1 where the data do not see a parameter at all."""
    diagonal = np.diag(information)
    return np.sqrt(np.where(diagonal > 0, diagonal, 1.0))


def limits(layout: ElasticLayout, lines: Lines) -> tuple[Array, Array]:
    """Lowest and highest ln f, ln zeta and rho, in the order of the vector."""
    f, m, p = lines.frequency[[0, -1]], layout.modes, len(layout.pairs)
    low, high = np.log(np.array(REACH) * f)
    return (
        np.concatenate([np.full(m, low), np.full(m, np.log(RATIOS[0])), np.full(p, -TIGHTEST)]),
        np.concatenate([np.full(m, high), np.full(m, np.log(RATIOS[1])), np.full(p, TIGHTEST)]),
    )


def linearised(x: Array, layout: ElasticLayout, lines: Lines, known: tuple[ComplexArray, ComplexArray] | None = None) -> Refined:
    """Cost and derivatives at the vector `x` (k,), which nothing moves; `known` is what was `evaluated` there."""
    X, left = known or evaluated(x, layout, lines)
    common, answer = model.parts(model.unpack(x, layout)[1], lines.frequency, layout, X)
    weight, m, d = np.sqrt(2) / lines.deviation.T, layout.modes, len(common)
    # What moves all entries, and what is left, by entry; then entry by entry the few that move some
    D = np.concatenate([common * weight, (left.T * weight)[None]]).view(np.float64)  # (d + 1, 21, 2 n)
    whole = D.reshape(d + 1, -1) @ D.reshape(d + 1, -1).T
    information, slope, chi2 = np.zeros((len(x), len(x))), np.zeros(len(x)), float(whole[d, d])
    information[:d, :d], slope[:d] = whole[:d, :d], whole[:d, d]
    residual = (2 * np.pi * lines.frequency) ** 2 * model.residual_basis()[:, UPPER[0], UPPER[1]].diagonal()[:, None]
    for e, (i, j) in enumerate(zip(*UPPER, strict=True)):
        rows = [(SCALE[i] * weight[e]) * answer[:, j], (SCALE[j] * weight[e]) * answer[:, i]]
        at = [d + 6 * np.arange(m) + i, d + 6 * np.arange(m) + j]
        if i == j:
            rows, at = [2 * rows[0]], at[:1]
        if layout.residual:
            rows, at = [*rows, (residual[e] * weight[e])[None]], [*at, np.array([d + 6 * m + e])]
        own, places = np.concatenate(rows, dtype=np.complex128).view(np.float64), np.concatenate(at)
        met = own @ D[:, e].T
        information[places, :d] += met[:, :d]
        information[np.ix_(places, places)] += own @ own.T
        slope[places] += met[:, d]
    information[:d, d:] = information[d:, :d].T
    p, slopes = _prior(x, layout, lines)
    information[np.diag_indices(len(x))] += slopes**2
    return Refined(
        layout=layout,
        vector=x,
        chi2=chi2,
        cost=chi2 + float(p @ p),
        residual=weighted(left, lines),
        slope=slope,
        prior=slopes * p,
        certainty=slopes**2,
        information=information,
        converged=False,
    )


def _prior(x: Array, layout: ElasticLayout, lines: Lines) -> tuple[Array, Array]:
    """Residuals (k,) and their slopes (k,), zero for parameters without a prior."""
    blocks, low, high = layout.blocks, np.log(lines.frequency[0]), np.log(lines.frequency[-1])
    mean, slope = np.zeros(len(x)), np.zeros(len(x))
    mean[blocks["frequency"]], slope[blocks["frequency"]] = (low + high) / 2, 2 / max(high - low, 1.0)
    mean[blocks["damping"]], slope[blocks["damping"]] = DAMPING_PRIOR[0], 1 / DAMPING_PRIOR[1]
    slope[blocks["pairs"]] = 1 / COUPLING
    return slope * (x - mean), slope


# Where the next pole starts: the frequency, damping and participation that take most out of what a fit left over.
#
# On a grid of poles, in the band and around it, every entry of the leftover is fitted by a constant, omega² and the pole's curve
# omega² / (omega_r² - omega² + 2 i zeta omega_r omega), all entries and poles at once; the constants and omega² are what inertia
# and residual mass could still take. The most promising are looked at closely: all parameters of the fit may give way to first
# order, so that the slope which a resonance out of tune leaves beside it is not taken for another one, and the matrix of
# amplitudes is cut down to rank one with a positive sign, for a mode of a symmetric structure answers by L L^T.

TRIAL_DAMPING = (0.0015, 0.004, 0.01, 0.03)
"""Ratios that are tried."""

BEYOND = (0.6, 1.7)
"""How far out of the band a pole is looked for: of its lower and of its upper end."""

SHORT = 150
"""Poles of the grid that are looked at closely."""

LEAST = 1.0
"""Fall of chi² that is worth a try: what one number does by chance."""

ROUNDING = 1e-10
"""Added to the normal matrix, scaled to 1: parameters that the data do not see leave rounding there."""

POLES_APART = 0.02
"""Relative distance of two candidates: nearer ones are the same."""

RIDGE = 1e-3
"""Share of a pole's own curve that counts as explained by what is fitted already, so that no pole is put on another."""


@dataclass(frozen=True, eq=False, kw_only=True)
class PoleCandidate:
    """A pole to start from.

    Attributes
    ----------
    frequency : [Hz]
    damping_ratio : [1]
    participation : (6,) [sqrt(kg)], [sqrt(kg) m]
    gain : what it takes out of chi², as far as a linear fit tells
    """

    frequency: float
    damping_ratio: float
    participation: Array
    gain: float


def next_poles(at: Refined, lines: Lines, count: int = 8) -> tuple[PoleCandidate, ...]:
    """The poles, apart from each other, that take most out of what the fit `at` leaves over, the best first."""
    f, zeta = _shortlist(at, lines)
    rhs, P = _projected(at, lines, f, zeta)
    L, gain = _rank_one(rhs, P)
    chosen: list[int] = []
    for k in np.argsort(-gain).tolist():
        if len(chosen) < count and gain[k] > LEAST and all(abs(f[k] / f[j] - 1) > POLES_APART for j in chosen):
            chosen.append(k)
    return tuple(PoleCandidate(frequency=f[k], damping_ratio=zeta[k], participation=L[k], gain=gain[k]) for k in chosen)


def _shortlist(at: Refined, lines: Lines) -> tuple[Array, Array]:
    """The most promising of the grid, each entry fitted on its own by a constant, omega² and the curve of the pole."""
    # The grid: as fine as the half-power width of the lightest in the band, coarse around it
    low, high = lines.frequency[0], lines.frequency[-1]
    inside = np.geomspace(low, high, max(int(np.ceil(np.log(high / low) / (2 * TRIAL_DAMPING[1]))), 2))
    beyond = np.concatenate([np.geomspace(BEYOND[0] * low, 0.97 * low, 6), np.geomspace(1.03 * high, BEYOND[1] * high, 10)])
    f = np.concatenate([np.repeat(inside, len(TRIAL_DAMPING)), beyond])
    zeta = np.concatenate([np.tile(TRIAL_DAMPING, len(inside)), np.full(len(beyond), TRIAL_DAMPING[1])])
    left = -evaluated(at.vector, at.layout, lines)[1]
    # Amplitudes (g, 21) of the poles' curves and the weight (g, 21) of each: chi² falls by amplitude² x weight
    w = 2 * np.pi * lines.frequency
    curve = _curves(w, f, zeta)
    weight = 2 / lines.deviation**2  # (n, 21)
    # 1 and omega² (2, n, 21), orthonormal over the lines under each entry's own weight
    one = np.broadcast_to(1 / np.sqrt(weight.sum(axis=0)), weight.shape)
    square = (w**2)[:, None] - one * np.sum(weight * one * (w**2)[:, None], axis=0)
    basis = np.stack([one, square / np.sqrt(np.sum(weight * square**2, axis=0))])
    shares = [curve.real @ (weight * one) for one in basis]
    strength = np.abs(curve) ** 2 @ weight - sum(share**2 for share in shares)
    remainder = left - sum(one * np.sum(weight * one * left.real, axis=0) for one in basis)
    against = curve.real @ (weight * remainder.real) + curve.imag @ (weight * remainder.imag)
    sound = strength > 1e-9 * (np.abs(curve) ** 2 @ weight)
    amplitude = np.where(sound, against / np.where(sound, strength, 1.0), 0.0)
    power = np.where(sound, strength, 0.0)
    best = np.argsort(-np.sum(power * amplitude**2, axis=1))[:SHORT]
    return f[best], zeta[best]


def _projected(at: Refined, lines: Lines, f: Array, zeta: Array) -> tuple[Array, Array]:
    """Right-hand sides (s, 21) and normal matrices (s, 21, 21) of the amplitudes once all parameters of the fit may give way."""
    n, k = len(lines.frequency), len(at.vector)
    jacobian = weighted(model.upper_derivatives(model.unpack(at.vector, at.layout)[1], lines.frequency, at.layout), lines)
    curve = _curves(2 * np.pi * lines.frequency, f, zeta)
    g = curve.view(np.float64).reshape(len(f), n, 2)
    weight = np.sqrt(2) / lines.deviation
    J, r = jacobian.reshape(k, n, 21, 2), at.residual.reshape(n, 21, 2)
    rows = np.tensordot(g, weight[:, :, None] * J, axes=((1, 2), (1, 3)))  # (s, k, 21)
    own = np.abs(curve) ** 2 @ weight**2
    d = unit_of(at.information)
    root = np.linalg.cholesky(at.information / np.outer(d, d) + ROUNDING * np.eye(k)) * d[:, None]
    half = np.linalg.solve(root, rows)
    slope = np.linalg.solve(root, at.slope + at.prior)
    rhs = np.einsum("ske,k->se", half, slope) - np.tensordot(g, weight[:, :, None] * r, axes=((1, 2), (0, 2)))
    P = -half.swapaxes(1, 2) @ half
    P[:, np.arange(21), np.arange(21)] += own * (1 + RIDGE)
    return rhs, P


def _curves(w: Array, f: Array, zeta: Array) -> ComplexArray:
    """omega² / (omega_r² - omega² + 2 i zeta omega_r omega) of every pole (g, n)."""
    p = 2 * np.pi * f[:, None]
    return np.asarray(w**2 / (p**2 - w**2 + 2j * zeta[:, None] * p * w))


def _rank_one(rhs: Array, P: Array) -> tuple[Array, Array]:
    """Of every pole the best of the six eigenvectors of its matrix of amplitudes: participation (s, 6) and fall of chi² (s,)."""
    i, j = UPPER
    A = np.zeros((len(rhs), 6, 6))
    A[:, i, j] = A[:, j, i] = np.linalg.solve(P, rhs[:, :, None])[:, :, 0]
    _, vectors = np.linalg.eigh(A / np.outer(SCALE, SCALE))
    u = vectors.swapaxes(1, 2) * SCALE  # (s, 6 vectors, 6)
    v = u[:, :, i] * u[:, :, j]
    along = np.einsum("sve,se->sv", v, rhs)
    size = np.maximum(along, 0.0) / np.einsum("sve,sef,svf->sv", v, P, v)
    gain = size * along
    best = np.argmax(gain, axis=1)
    k = np.arange(len(rhs))
    return np.sqrt(size[k, best])[:, None] * u[k, best], gain[k, best]


FLOOR = 0.002
"""Model error as a share of the level of an entry's row and column."""

MOST = 24
"""Poles at most when their number is not given."""

PATIENCE = 3
"""Poles that are tried beyond the last one that paid: a mode of two directions may need two before either does."""

OVERLAP = 100.0
"""Damping is coupled between poles nearer than this many half-power widths: farther apart a coupling of 0.4 mixes less than 0.2 %
of one mode into another. A lossy layer couples modes that are half the band apart."""

Progress = Callable[[float], None]


@dataclass(frozen=True, eq=False, kw_only=True)
class Trial:
    """One fit of the search: `vector` of `layout`, with its chi² at the lines that say something new."""

    layout: ElasticLayout
    vector: Array
    chi2: float

    @property
    def modes(self) -> int:
        """Number of poles."""
        return self.layout.modes


@dataclass(frozen=True, eq=False, kw_only=True)
class Fitted:
    """Inertia and elastic terms that explain a dynamic mass.

    Attributes
    ----------
    parameters : (10,) of Eq. 4 about the reference point of the dynamic mass
    covariance : (10, 10) with all else estimated: noise and model error at the lines that say something new, times what the
        misfit and the lines that repeat an error make of it. Errors alike at all lines, of gains for instance, are not in it
    terms : elastic terms about the same point
    reference_point : (3,) [m]
    misfit : chi² per degree of freedom with the given noise and floor
    asymmetry : the same of H_ij - H_ji, which are equal in every structure: sensors are off where it is far above 1
    modes : number of poles
    reason : why there are as many
    history : the fits of the search, one pole more each
    residual : (6, 6) what is left over, root mean square over the lines in standard deviations, by entry
    band : (low, high) [Hz] of the lines
    converged : whether the iteration ended by itself
    layout, vector : all that was estimated, as `model.unpack` reads it
    information : (k, k) inverse covariance of the vector, the weak priors of `refine` included
    """

    parameters: Array
    covariance: Array
    terms: ElasticTerms
    reference_point: Array
    misfit: float
    asymmetry: float
    modes: int
    reason: str
    history: tuple[Trial, ...]
    residual: Array
    band: tuple[float, float]
    converged: bool
    layout: ElasticLayout
    vector: Array
    information: Array

    def __post_init__(self) -> None:
        freeze(self, parameters=(10,), covariance=(10, 10), residual=(6, 6))

    @property
    def inertia(self) -> Inertia:
        """The ten as a noun."""
        return Inertia(parameters=self.parameters, reference_point=self.reference_point)


def fit(
    dynamic_mass: DynamicMass,
    *,
    weights: npt.ArrayLike | None = None,
    floor: float = FLOOR,
    modes: int | None = None,
    band: tuple[float, float] | None = None,
    start: Fitted | None = None,
    progress: Progress | None = None,
) -> Fitted:
    """Inertia and elastic terms of a measured `dynamic_mass`.

    Parameters
    ----------
    weights : (n, 6, 6) standard deviation of the complex noise of H, E|noise|² = sd², in the units of H; 0 when None
    floor : model error as a share of the level of row and column
    modes : number of poles; 0 takes the structure for rigid (Eq. 1 alone); None lets the data decide
    band : (low, high) [Hz], all lines when None
    start : an earlier fit, of another band for instance, to begin from
    progress : called with the share done

    Raises
    ------
    BadInput : fewer than two lines, weights of another shape or all zero with a floor of zero, a negative number of modes.
    """
    if modes is not None and modes < 0:
        problem = f"a number of poles is at least 0, found {modes}"
        raise BadInput("elastic fit", "modes", problem, "Leave it out and the data decide")
    data = lines_of(dynamic_mass, weights, floor, band)
    thin = data.at(kept(data))
    tell = progress or (lambda share: None)
    rigid = refine(np.zeros(10), ElasticLayout(modes=0, residual=False), thin) if not modes else None
    if modes == 0 and rigid is not None:
        found, history, reason = rigid, [rigid], "rigid, as asked for"
    else:
        first = ElasticLayout(modes=0) if start is None else start.layout
        at = refine(np.zeros(first.size) if start is None else start.vector, first, thin)
        tried, most = [at], MOST if modes is None else modes
        while at.layout.modes < most:
            more = _with_one_more(at, thin)
            if more is None:
                break
            at = more
            tried.append(at)
            tell(min(0.95, at.layout.modes / (most if modes else 16)))
            if modes is None and len(tried) > PATIENCE:
                # The last poles together took less than their price, or less than a tenth of what there was to take
                before = tried[-1 - PATIENCE]
                price = (at.layout.size - before.layout.size) * np.log(thin.count)
                if before.chi2 - at.chi2 < max(price, 0.1 * before.chi2):
                    break
        history = tried
        if rigid is None:
            found, reason = refine(at.vector, at.layout, thin), f"{at.layout.modes} poles, as asked for"
        else:
            of = price_of(tried, thin)
            best = min([rigid, *tried], key=of.criterion)
            if best is rigid:
                found, reason = rigid, "rigid: neither a pole nor a residual mass pays"
            else:
                found = _pruned(refine(best.vector, best.layout, thin), thin, of)
                left = f"{found.layout.modes} poles leave a misfit of {_misfit(found, thin):.3g}"
                gains = [max(found.chi2 - one.chi2, 0.0) for one in tried if one.layout.modes > found.layout.modes]
                more_gains = (
                    f"one more would take {gains[0]:.3g} out of chi², less than its price of {of.pole:.3g}" if gains else ""
                )
                reason = f"{left}; {more_gains or 'nothing else in it is a resonance'}"
    tell(1.0)
    return _result(found, history, reason, data, thin, dynamic_mass.reference_point)


def _with_one_more(at: Refined, lines: Lines) -> Refined | None:
    """The fit with the best pole of the leftover added and everything refined; None when none is one that helps."""
    for pole in next_poles(at, lines):
        parameters, terms = model.unpack(at.vector, at.layout)
        C = np.zeros((len(terms.frequency) + 1,) * 2)
        C[:-1, :-1], C[-1, -1] = terms.damping, 4 * np.pi * pole.damping_ratio * pole.frequency
        extended = ElasticTerms(
            frequency=np.append(terms.frequency, pole.frequency),
            damping=C,
            participation=np.vstack([terms.participation, pole.participation]),
            residual=terms.residual,
        )
        # The layout of `extended` with damping coupled where poles overlap, and where it has been `at.layout`
        now = model.layout_of(extended, widths=OVERLAP)
        layout = ElasticLayout(modes=now.modes, pairs=tuple(sorted({*now.pairs, *at.layout.pairs})), residual=at.layout.residual)
        longer = refine(model.pack(parameters, extended, layout), layout, lines, iterations=12, accuracy=1e-3)
        if longer.chi2 < at.chi2 and np.all(longer._room(lines) > 0):
            return longer
    return None


@dataclass(frozen=True, kw_only=True)
class Price:
    """What a parameter must take out of chi².

    Attributes
    ----------
    unit : what one of chi² is worth, at least 1: misfit that remains with the best of the fits, times the lines it repeats itself
    parameter : logarithm of the independent numbers in the data
    """

    unit: float
    parameter: float

    def criterion(self, fit: Refined) -> float:
        """The least wins."""
        return fit.chi2 / self.unit + fit.effective_size * self.parameter

    @property
    def pole(self) -> float:
        """Of a pole, in chi²."""
        return 8 * self.parameter * self.unit


def price_of(fits: list[Refined], lines: Lines) -> Price:
    best = min(fits, key=lambda one: _misfit(one, lines))
    repeated = best.correlation_time
    unit = max(1.0, _misfit(best, lines) * repeated)
    return Price(unit=unit, parameter=float(np.log(lines.count / repeated if unit > 1 else lines.count)))


def _misfit(fit: Refined, lines: Lines) -> float:
    return fit.chi2 / max(lines.count - fit.layout.size, 1)


def _pruned(at: Refined, lines: Lines, price: Price) -> Refined:
    """Poles go, the weakest first, while that costs less than they are worth; any that became no resonance go, too."""
    while at.layout.modes:
        room = at._room(lines)
        lost = bool(room.min() <= 0)
        weakest = int(np.argmin(room if lost else [at._worth(r) for r in range(at.layout.modes)]))
        parameters, terms = model.unpack(at.vector, at.layout)
        rest = np.delete(np.arange(at.layout.modes), weakest)
        fewer = model.chosen(terms, rest)
        layout = model.layout_of(fewer, widths=OVERLAP)
        shorter = refine(model.pack(parameters, fewer, layout), layout, lines, iterations=20)
        if not lost and price.criterion(shorter) > price.criterion(at):
            return at
        at = shorter
    return at


def _result(found: Refined, history: list[Refined], reason: str, data: Lines, thin: Lines, reference_point: Array) -> Fitted:
    # The modes in the order of their frequencies
    parameters, terms = model.unpack(found.vector, found.layout)
    order = np.argsort(terms.frequency, kind="stable")
    place = np.argsort(order)
    pairs = sorted((int(min(place[r], place[s])), int(max(place[r], place[s]))) for r, s in found.layout.pairs)
    layout = replace(found.layout, pairs=tuple(pairs))
    final = refine(model.pack(parameters, model.chosen(terms, order), layout), layout, data, iterations=20)
    parameters, terms = model.unpack(final.vector, layout)
    misfit = final.chi2 / max(data.count - layout.size, 1)
    said = linearised(final.vector, layout, thin)
    information = said.information / price_of([said], thin).unit
    deviations = np.abs(model.whole(evaluated(final.vector, layout, data)[1] / data.deviation))
    asymmetry, number = data.asymmetry
    return Fitted(
        parameters=parameters,
        covariance=covariance_of_the_ten(information),
        terms=terms,
        reference_point=reference_point,
        misfit=misfit,
        asymmetry=asymmetry / number,
        modes=layout.modes,
        reason=reason,
        history=tuple(Trial(layout=one.layout, vector=one.vector, chi2=one.chi2) for one in history),
        residual=np.sqrt(np.mean(deviations**2, axis=0)),
        band=(float(data.frequency[0]), float(data.frequency[-1])),
        converged=found.converged and final.converged,
        layout=layout,
        vector=final.vector,
        information=information,
    )


def covariance_of_the_ten(information: Array) -> Array:
    """(10, 10) in the units of Eq. 4; everything else is estimated with them."""
    d = unit_of(information)
    covariance = np.linalg.pinv(information / np.outer(d, d), hermitian=True) / np.outer(d, d)
    unit = model.inertia_scale()
    return np.asarray(covariance[:10, :10] * np.outer(unit, unit))
