"""Ten inertia parameters from dynamic masses or from raw spectra: the paper's Eqs. 1 and 4 solved by least squares.

Eq. 1 is linear in the ten of Eq. 4, f = M(p) u = sum_k p_k B_k u with ten constant matrices B_k. So every entry of a dynamic mass
is an equation for p, and so is every load of every run and line. Which of the two is weighed differs: H hides how well each
run told its motions, raw spectra keep it.

Noise of the motions makes plain least squares too low, as every error in a regressor does: by the share of noise in the power of
the motion. Where the noise on both sides is known, motions corrected by what the loads say take part in the equations instead.
The answer is the stationary point of the likelihood (errors in variables; Fuller, Measurement Error Models, 1987).

Gravity: with apparent accelerations, which is what accelerometers read, none of it is left (`identification.base_motion`).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import LEVELS, MOTIONS, ComplexArray, DynamicMass
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array, frozen
from geometry.inertia import PARAMETERS, Inertia, Kind, combination, judge
from geometry.routes import from_log_cholesky, log_cholesky
from identification.base_motion import RunNoise, against_apparent, tilt
from identification.dynamic_mass import balance, correction
from identification.elastic import model
from identification.elastic.model import ElasticTerms

# The nearest parameters that a body can have, in units of what the data can tell.
#
# Least squares knows nothing of positive density. Where its answer breaks the triangle inequality, the one that a body can have
# and that the data like best is the minimum of (p - p0)^T C^-1 (p - p0) over all positive pseudo-inertias, for which the
# log-Cholesky coordinates are free of constraints (`geometry.routes`). Where least squares lies outside, that minimum lies on
# the boundary - a body without thickness - which logarithms approach and never reach: what is returned is a body, by a hair.

INSIDE = 1e-3
"""How far inside the boundary, relative to the trace of the pseudo-inertia, the search starts."""


def nearest_body(inertia: Inertia, covariance: Array) -> Inertia:
    """`inertia` where a body can have it, else the nearest body in the metric of `covariance` (10, 10), about the same point.

    Raises
    ------
    CheckFailed : the mass is not positive, so that there is no body near.
    """
    from scipy.optimize import least_squares

    if judge(inertia).kind is Kind.BODY:
        return inertia
    if inertia.mass <= 0:
        raise CheckFailed(f"No body is near parameters of negative mass, found {inertia.mass:.6g} kg", mass=inertia.mass)
    whiten = np.linalg.inv(np.linalg.cholesky(covariance))

    def misfit(coordinates: Array) -> Array:
        return np.asarray(whiten @ (_of(coordinates, inertia).parameters - inertia.parameters))

    # A body near `inertia`, about the origin: second moments of its density about its CoG lifted to be positive
    about = Inertia(parameters=inertia.parameters)
    values, axes = np.linalg.eigh(about.tensor_cog)
    sigma = values.sum() / 2 - values
    lifted = np.maximum(sigma, INSIDE * np.abs(sigma).max())
    tensor = axes @ np.diag(lifted.sum() - lifted) @ axes.T
    inside = Inertia.from_cog(mass=about.mass, cog=about.cog, tensor=tensor)
    found = least_squares(misfit, log_cholesky(inside), x_scale="jac", xtol=1e-12, ftol=1e-12, gtol=1e-12)
    return _of(found.x, inertia)


def _of(coordinates: Array, like: Inertia) -> Inertia:
    """The body with log-Cholesky coordinates about the reference point of `like`, which stands for the frame's origin there."""
    return Inertia(parameters=from_log_cholesky(coordinates).parameters, reference_point=like.reference_point)


# Robust weights: equations that do not fit the others lose their say (iteratively reweighted least squares).
#
# Equations come in groups of s complex numbers that belong together, whitened: the size of a group is the rms of its residuals,
# 1 where nothing is wrong but the noise. The scale by which sizes are divided comes from their median, which half of the groups
# may spoil without moving it far. Huber's weights fall off as 1/size and never to zero, so that there is one minimum; Tukey's
# biweight takes gross errors out altogether (Huber, Robust Statistics, 1981; Holland and Welsch, Commun. Statist. A6, 1977).


def huber(size: Array, corner: float = 1.5) -> Array:
    """Weights of groups of this `size`: 1 up to the corner, then falling as 1/size."""
    return np.asarray(corner / np.maximum(size, corner))


def tukey(size: Array, corner: float = 4.0) -> Array:
    """Weights of groups of this `size`: smoothly from 1 to 0 at the corner, 0 beyond."""
    return np.asarray(np.square(1 - np.square(np.minimum(size / corner, 1))))


WEIGHTS: Mapping[str, Callable[[Array], Array]] = MappingProxyType({"": np.ones_like, "huber": huber, "tukey": tukey})
"""Robust weights by name; the empty name weighs all alike."""


def scale(size: Array, together: int) -> float:
    """The size of a sound group of `together` complex numbers from the median of all.

    The mean square of s complex normal numbers has the median (1 - 1/(9 s))³ (Wilson and Hilferty, PNAS 17, 1931).
    """
    return float(np.median(size) / (1 - 1 / (9 * together)) ** 1.5)


# `Unidentifiable`: data that leave a combination of the unknowns open, with the evidence.


class Unidentifiable(CheckFailed):
    """Data that leave a combination of the unknowns open.

    Attributes
    ----------
    singular_values : of the equations, every unknown scaled to a column of length 1; descending
    null_direction : the combination of the scaled unknowns that the data say least about, of length 1
    undetermined : names of the unknowns that take part in what is open
    """

    def __init__(self, message: str, *, singular_values: Array, null_direction: Array, undetermined: tuple[str, ...]) -> None:
        self.singular_values = singular_values
        self.null_direction = null_direction
        self.undetermined = undetermined
        super().__init__(message, singular_values=singular_values, null_direction=null_direction, undetermined=undetermined)


# Complex linear equations for ten real unknowns: weighted, robust, and refused where they leave a combination open.

OPEN = 1e-8
"""Singular value, relative to the largest, below which equations of scaled unknowns say nothing: what is left is rounding."""

ROUNDING = 1e-9
"""Residuals, relative to the values, below which none of them is an outlier: exact data have nothing but rounding."""

SHARE = 0.05
"""Share of the largest from which a parameter counts as part of the combination that is open."""

ROBUST_STEADY, ROBUST_ROUNDS = 1e-10, 100
"""Relative change of the parameters at which reweighting ends, and after how many rounds at the latest."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Equations:
    """Whitened equations ``rows @ p = values`` in groups of numbers that belong together.

    Attributes
    ----------
    rows : (g, s, 10) complex
    values : (g, s) complex
    left : (g, s, 10) complex, what the residual is orthogonal to: `rows` in least squares, rows without their noise in errors in
        variables
    """

    rows: ComplexArray
    values: ComplexArray
    left: ComplexArray


@dataclass(frozen=True, eq=False, kw_only=True)
class RigidSolution:
    """What the equations say.

    Attributes
    ----------
    parameters : (10,)
    inverse : (10, 10) covariance of the parameters where every whitened number has E|noise|² = 1
    size : (g,) rms of the residuals of each group
    weight : (g,) robust weight of each group
    singular_values : (10,) of the equations, every unknown scaled to a column of length 1; descending
    """

    parameters: Array
    inverse: Array
    size: Array
    weight: Array
    singular_values: Array


def solve(equations: Equations, robust: str = "") -> RigidSolution:
    """The ten parameters, robust in the way `robust` of `WEIGHTS`.

    Raises
    ------
    BadInput : `robust` is no such way.
    Unidentifiable : the equations leave a combination of the ten parameters open.
    """
    require_known(robust)
    weight = np.ones(len(equations.values))
    found = _weighted(equations, weight)
    least = ROUNDING * float(np.sqrt(np.mean(np.abs(equations.values) ** 2))) or 1.0
    for _ in range(ROBUST_ROUNDS if robust else 0):
        before, size = found.parameters, found.size
        found = _weighted(equations, WEIGHTS[robust](size / max(scale(size, equations.values.shape[1]), least)))
        if np.linalg.norm(found.parameters - before) <= ROBUST_STEADY * np.linalg.norm(before):
            break
    return found


def require_known(robust: str) -> None:
    """`robust` is a way of `WEIGHTS`.

    Raises
    ------
    BadInput : it is not.
    """
    if robust not in WEIGHTS:
        known = ", ".join(repr(name) for name in WEIGHTS)
        raise BadInput("ten parameters", "robust", f"must be one of {known}, found {robust!r}", "Take one of these")


def _weighted(equations: Equations, weight: Array) -> RigidSolution:
    root = np.sqrt(weight)[:, None]
    A, Z = _real(equations.rows * root[:, :, None]), _real(equations.left * root[:, :, None])
    b = _real(equations.values * root)
    length = np.maximum(np.linalg.norm(Z, axis=0), np.finfo(np.float64).tiny)
    left, singular, right = np.linalg.svd(Z / length, full_matrices=False)
    if singular[-1] <= OPEN * singular[0]:
        null = right[singular <= OPEN * singular[0]]
        share = np.linalg.norm(null, axis=0)
        open_ = tuple(name for name, part in zip(PARAMETERS, share, strict=True) if part >= SHARE * share.max())
        told = f"{len(singular) - len(null)} of ten combinations are told"
        if len(null) == len(open_):
            mixed = ""
        elif len(null) > 1:
            mixed = "; they are mixed"
        else:
            kept = np.where(np.abs(null[0]) >= SHARE * np.abs(null[0]).max(), null[0], 0)
            mixed = f"; the data say nothing of {combination(kept, PARAMETERS)} (each as a share of what it does in the data)"
        said = (
            f"The data leave {', '.join(open_)} open: {told}{mixed}. Drive the base motions that these act on, "
            "in runs of their own"
        )
        raise Unidentifiable(said, singular_values=singular, null_direction=right[-1], undetermined=open_)
    # Z = left s right: the normal equations Z^T A p = Z^T b without squaring the condition number.
    inner = left.T @ A
    p = np.linalg.solve(inner, left.T @ b)
    residual = equations.values - equations.rows @ p
    half = (right / singular[:, None]) / length
    return RigidSolution(
        parameters=np.asarray(p, dtype=np.float64),
        inverse=half.T @ half / 2,
        size=np.sqrt(np.mean(np.abs(residual) ** 2, axis=1)),
        weight=weight,
        singular_values=singular,
    )


def _real(values: ComplexArray) -> Array:
    """Real parts above imaginary parts; the groups side by side."""
    flat = values.reshape(values.shape[0] * values.shape[1], *values.shape[2:])
    return np.concatenate([flat.real, flat.imag])


BASIS = np.array([Inertia(parameters=one).mass_matrix for one in np.eye(10)])
"""(10, 6, 6) the matrices B_k of M(p) = sum_k p_k B_k."""

RIGID = ElasticTerms()
"""No elastic terms."""

STEADY, ROUNDS = 1e-12, 100
"""Relative change of the parameters at which the correction of motions ends, and after how many rounds at the latest."""


@dataclass(frozen=True, eq=False, kw_only=True)
class RigidFit:
    """Ten parameters and how well they are known.

    Attributes
    ----------
    inertia : about the reference point of the data
    covariance : (10, 10) of the parameters about the same point, by noise alone and before any step to a body
    misfit : mean square of whitened residuals for each degree of freedom; nan where the size of the noise was not given
    weight : robust weight [0 to 1] of each equation: (n, 6, 6) entries of H, or (r, n) runs and lines; 1 where all weigh alike
    singular_values : (10,) of the equations, every unknown scaled to a column of length 1; descending
    text : whether a body can have the parameters, and what was done about it
    """

    inertia: Inertia
    covariance: Array
    misfit: float
    weight: Array
    singular_values: Array
    text: str

    def __post_init__(self) -> None:
        object.__setattr__(self, "covariance", frozen(self.covariance, (10, 10), "covariance"))


def fit(
    dynamic_mass: DynamicMass,
    *,
    weights: npt.ArrayLike | None = None,
    covariance: npt.ArrayLike | None = None,
    robust: str = "",
    consistent: bool = False,
    elastic: ElasticTerms | None = None,
    gravity: float = 0.0,
) -> RigidFit:
    """The ten parameters from all 36 entries of a dynamic mass at all its lines.

    Parameters
    ----------
    weights : (n, 6, 6) one over the standard deviation of each entry, E|noise|² = sd²
    covariance : (n, 36, 36) of the entries row by row, instead of `weights`; without either, loads are taken to be off by
        the same share of their rms in sweeps at nominal levels, and the size of that share follows from the misfit
    robust : "huber" or "tukey" take the say from entries that do not fit
    consistent : return the nearest parameters that a body can have
    elastic : terms of Eq. 8b, taken off before
    gravity : [m/s²] where H is against kinematic motions; 0 for accelerometers, which feel the tilt themselves

    Raises
    ------
    BadInput : weights and covariance both, or of another shape; an unknown `robust`.
    Unidentifiable : weights of zero leave a combination of the parameters open.
    """
    H = against_apparent(dynamic_mass, gravity) if gravity else dynamic_mass
    values = (H.matrix - model.dynamic_mass(np.zeros((6, 6)), elastic or RIGID, H.frequency)).reshape(-1, 36)
    rows = np.broadcast_to(BASIS.reshape(10, 36).T, (len(values), 36, 10)).astype(np.complex128)
    known = weights is not None or covariance is not None
    if covariance is not None:
        lines = len(values)
        C = np.asarray(covariance, dtype=np.complex128)
        if weights is not None or C.shape != (lines, 36, 36):
            problem = f"give either `weights` or a covariance of shape {(lines, 36, 36)}, found {C.shape}"
            raise BadInput("ten parameters", "covariance", problem, "Leave one of them out")
        W = np.asarray(np.linalg.inv(np.linalg.cholesky(C)))
        rows, values = W @ rows, (W @ values[:, :, None])[:, :, 0]
    else:
        if weights is None:
            level = np.array([LEVELS[axis] for axis in MOTIONS])
            size = np.sqrt(np.mean(np.abs(H.matrix * level) ** 2, axis=(0, 2)))
            w = np.broadcast_to(level / np.where(size > 0, size, size.max() or 1.0)[:, None], H.matrix.shape)
        else:
            w = np.asarray(weights, dtype=np.float64)
        if w.shape != H.matrix.shape or not np.all((w >= 0) & np.isfinite(w)):
            problem = f"must be finite, not negative and of shape {H.matrix.shape}"
            remedy = "Give one over the standard deviation"
            raise BadInput("ten parameters", "weights", f"{problem}, found shape {w.shape}", remedy)
        rows, values = rows * w.reshape(-1, 36, 1), values * w.reshape(-1, 36)
    equations = Equations(rows=rows.reshape(-1, 1, 10), values=values.reshape(-1, 1), left=rows.reshape(-1, 1, 10))
    return _told(solve(equations, robust), 1, known, H.reference_point, consistent, (len(values), 6, 6))


def from_spectra(
    motion: npt.ArrayLike,
    load: npt.ArrayLike,
    frequency: npt.ArrayLike,
    reference_point: npt.ArrayLike = (0.0, 0.0, 0.0),
    *,
    noise: RunNoise | None = None,
    robust: str = "",
    consistent: bool = False,
    elastic: ElasticTerms | None = None,
    gravity: float = 0.0,
) -> RigidFit:
    """The ten parameters from raw spectra: any number of runs, whatever they drive.

    Parameters
    ----------
    motion, load : (r, n, 6) spectra about the reference point (3,) [m]
    frequency : (n,) [Hz]
    noise : of both sides; errors in variables then. Without it every load weighs by its rms over all runs, and motions are exact
    robust, consistent, elastic, gravity : as in `fit`; robust weights go by run and line

    Raises
    ------
    BadInput : shapes that do not fit, an unknown `robust`, noise of zero.
    Unidentifiable : the runs leave a combination of the parameters open; it is named.
    CheckFailed : the correction of motions does not settle: noise is about as large as the motion.
    """
    U, F = np.asarray(motion, dtype=np.complex128), np.asarray(load, dtype=np.complex128)
    lines = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    found = [U.shape, F.shape, *([] if noise is None else [noise.load.shape[:3], noise.motion.shape[:3]])]
    if any(shape != U.shape for shape in found) or U.ndim != 3 or U.shape[1:] != (len(lines), 6):
        problem = f"motions and loads of (runs, {len(lines)} lines, 6) are needed, found {', '.join(map(str, found))}"
        raise BadInput("ten parameters", "spectra", problem, "Give them on the same lines")
    require_known(robust)
    T = tilt(lines, gravity)
    data = _Data(
        motion=np.einsum("njk,rnk->rnj", T, U), load=F, elastic=model.dynamic_mass(np.zeros((6, 6)), elastic or RIGID, lines)
    )
    if noise is None:
        solution = solve(_plain(data), robust)
    else:
        felt = RunNoise(load=noise.load, motion=T @ noise.motion @ T.swapaxes(1, 2))
        solution = _corrected(data, felt, robust)
    A = np.asarray(reference_point, dtype=np.float64)
    return _told(solution, 6, noise is not None, A, consistent, U.shape[:2])


@dataclass(frozen=True, eq=False, kw_only=True)
class _Data:
    """Apparent motions and loads (r, n, 6), and the elastic part (n, 6, 6) of H."""

    motion: ComplexArray
    load: ComplexArray
    elastic: ComplexArray

    @property
    def rigid_load(self) -> ComplexArray:
        return np.asarray(self.load - np.einsum("njk,rnk->rnj", self.elastic, self.motion))


def _regressor(motion: ComplexArray) -> ComplexArray:
    """(r, n, 6, 10): loads by each of the ten parameters."""
    return np.asarray(np.einsum("kji,rni->rnjk", BASIS, motion, optimize=True))


def _plain(data: _Data) -> Equations:
    values = data.rigid_load
    size = np.sqrt(np.mean(np.abs(data.load) ** 2, axis=(0, 1)))
    size = np.where(size > 0, size, size.max() or 1.0)
    rows = (_regressor(data.motion) / size[:, None]).reshape(-1, 6, 10)
    return Equations(rows=rows, values=(values / size).reshape(-1, 6), left=rows)


def _corrected(data: _Data, noise: RunNoise, robust: str) -> RigidSolution:
    """Errors in variables: motions corrected by what the loads say, from the plain answer until nothing moves."""
    found = solve(_plain(data), robust)
    for _ in range(ROUNDS):
        before = found.parameters
        try:
            # The equations at p, whitened by the noise of their residual f - H u, against regressors of corrected motions
            H = np.tensordot(before, BASIS, axes=1) + data.elastic
            residual, R = balance(H, data.motion, data.load, noise)
            W = np.linalg.inv(np.linalg.cholesky(R))
            corrected = data.motion + correction(H, residual, R, noise)
            values = (W @ data.rigid_load[..., None])[..., 0]
            rows, left = (W @ _regressor(motion) for motion in (data.motion, corrected))
            whitened = Equations(rows=rows.reshape(-1, 6, 10), values=values.reshape(-1, 6), left=left.reshape(-1, 6, 10))
            found = solve(whitened, robust)
        except Unidentifiable:  # the data told all ten: it is the correction that takes the motions away
            break
        if np.linalg.norm(found.parameters - before) <= STEADY * np.linalg.norm(before):
            return found
    raise CheckFailed("The correction of the motions' noise does not settle: it is about as large as the motions themselves")


def _told(
    solution: RigidSolution, together: int, known: bool, point: Array, consistent: bool, shape: tuple[int, ...]
) -> RigidFit:
    """The answer of equations in groups of `together`; a tenth unknown takes half a complex number."""
    squares = solution.weight @ np.square(solution.size) * together
    variance = squares / max(float(solution.weight.sum()) * together - 5, 1.0)
    covariance = solution.inverse * (1.0 if known else variance)
    free = Inertia(parameters=solution.parameters, reference_point=point)
    if consistent:
        if judge(free).physical:
            inertia, text = free, judge(free).text
        else:
            body = nearest_body(free, covariance)
            moved = np.linalg.norm(np.linalg.solve(np.linalg.cholesky(covariance), body.parameters - free.parameters))
            inertia, text = body, f"{judge(free).text}; the nearest body is {moved:.2g} standard deviations of noise away"
    else:
        inertia, text = (free, judge(free).text)
    return RigidFit(
        inertia=inertia,
        covariance=covariance,
        misfit=float(variance) if known else float("nan"),
        weight=solution.weight.reshape(shape) if len(solution.weight) == np.prod(shape) else np.ones(shape),
        singular_values=solution.singular_values,
        text=text,
    )
