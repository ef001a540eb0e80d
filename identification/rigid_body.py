"""Ten inertia parameters from dynamic masses or from raw spectra: the paper's Eqs. 1 and 4 solved by least squares.

Eq. 1 is linear in the ten of Eq. 4, f = M(p) u = sum_k p_k B_k u with ten constant matrices B_k. So every entry of a dynamic mass
is an equation for p, and so is every load of every run and line. Which of the two is weighed differs: H hides how well each
run told its motions, raw spectra keep it.

Noise of the motions makes plain least squares too low, as every error in a regressor does: by the share of noise in the power of
the motion. Where the noise on both sides is known, motions corrected by what the loads say take part in the equations instead.
The answer is the stationary point of the likelihood (errors in variables; Fuller, Measurement Error Models, 1987).

Gravity: with apparent accelerations, which is what accelerometers read, none of it is left (`identification.gravity`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array, frozen
from geometry.consistency import judge
from geometry.dynamic_mass import LEVELS, MOTIONS, ComplexArray, DynamicMass
from geometry.errors import BadInput, CheckFailed
from geometry.inertia import Inertia
from identification.elastic import model
from identification.elastic.terms import ElasticTerms
from identification.errors_in_variables import balance, correction
from identification.gravity import against_apparent, tilt
from identification.physical import nearest_body
from identification.regression import Equations, Solution, require_known, solve
from identification.run_noise import RunNoise
from identification.unidentifiable import Unidentifiable

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
        W = _whitening(covariance, weights, len(values))
        rows, values = W @ rows, (W @ values[:, :, None])[:, :, 0]
    else:
        w = _entry_weights(weights, H).reshape(-1, 36)
        rows, values = rows * w[:, :, None], values * w
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
    _require_fitting(U, F, lines, noise)
    require_known(robust)
    T = tilt(lines, gravity)
    data = _Data(
        motion=np.einsum("njk,rnk->rnj", T, U),
        load=F,
        elastic=model.dynamic_mass(np.zeros((6, 6)), elastic or RIGID, lines),
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


def _corrected(data: _Data, noise: RunNoise, robust: str) -> Solution:
    """Errors in variables: motions corrected by what the loads say, from the plain answer until nothing moves."""
    found = solve(_plain(data), robust)
    for _ in range(ROUNDS):
        before = found.parameters
        try:
            found = solve(_whitened(data, noise, before), robust)
        except Unidentifiable:  # the data told all ten: it is the correction that takes the motions away
            break
        if np.linalg.norm(found.parameters - before) <= STEADY * np.linalg.norm(before):
            return found
    raise CheckFailed("The correction of the motions' noise does not settle: it is about as large as the motions themselves")


def _whitened(data: _Data, noise: RunNoise, p: Array) -> Equations:
    """The equations at p, whitened by the noise of their residual f - H u, against regressors of corrected motions."""
    H = np.tensordot(p, BASIS, axes=1) + data.elastic
    residual, R = balance(H, data.motion, data.load, noise)
    W = np.linalg.inv(np.linalg.cholesky(R))
    corrected = data.motion + correction(H, residual, R, noise)
    values = (W @ data.rigid_load[..., None])[..., 0]
    rows, left = (W @ _regressor(motion) for motion in (data.motion, corrected))
    return Equations(rows=rows.reshape(-1, 6, 10), values=values.reshape(-1, 6), left=left.reshape(-1, 6, 10))


def _whitening(covariance: npt.ArrayLike, weights: npt.ArrayLike | None, lines: int) -> ComplexArray:
    C = np.asarray(covariance, dtype=np.complex128)
    if weights is not None or C.shape != (lines, 36, 36):
        problem = f"give either `weights` or a covariance of shape {(lines, 36, 36)}, found {C.shape}"
        raise BadInput(source="ten parameters", field="covariance", problem=problem, remedy="Leave one of them out")
    return np.asarray(np.linalg.inv(np.linalg.cholesky(C)))


def _entry_weights(weights: npt.ArrayLike | None, mass: DynamicMass) -> Array:
    if weights is None:
        level = np.array([LEVELS[axis] for axis in MOTIONS])
        size = np.sqrt(np.mean(np.abs(mass.matrix * level) ** 2, axis=(0, 2)))
        size = np.where(size > 0, size, size.max() or 1.0)
        return np.asarray(np.broadcast_to(level / size[:, None], mass.matrix.shape))
    w = np.asarray(weights, dtype=np.float64)
    if w.shape != mass.matrix.shape or not np.all((w >= 0) & np.isfinite(w)):
        problem = f"must be finite, not negative and of shape {mass.matrix.shape}, found shape {w.shape}"
        raise BadInput(source="ten parameters", field="weights", problem=problem, remedy="Give one over the standard deviation")
    return w


def _require_fitting(U: ComplexArray, F: ComplexArray, lines: Array, noise: RunNoise | None) -> None:
    found = [U.shape, F.shape, *([] if noise is None else [noise.load.shape[:3], noise.motion.shape[:3]])]
    if any(shape != U.shape for shape in found) or U.ndim != 3 or U.shape[1:] != (len(lines), 6):
        problem = f"motions and loads of (runs, {len(lines)} lines, 6) are needed, found {', '.join(map(str, found))}"
        raise BadInput(source="ten parameters", field="spectra", problem=problem, remedy="Give them on the same lines")


def _told(solution: Solution, together: int, known: bool, point: Array, consistent: bool, shape: tuple[int, ...]) -> RigidFit:
    """The answer of equations in groups of `together`; a tenth unknown takes half a complex number."""
    squares = solution.weight @ np.square(solution.size) * together
    variance = squares / max(float(solution.weight.sum()) * together - 5, 1.0)
    covariance = solution.inverse * (1.0 if known else variance)
    free = Inertia(parameters=solution.parameters, reference_point=point)
    inertia, text = _as_body(free, covariance) if consistent else (free, judge(free).text)
    return RigidFit(
        inertia=inertia,
        covariance=covariance,
        misfit=float(variance) if known else float("nan"),
        weight=solution.weight.reshape(shape) if len(solution.weight) == np.prod(shape) else np.ones(shape),
        singular_values=solution.singular_values,
        text=text,
    )


def _as_body(free: Inertia, covariance: Array) -> tuple[Inertia, str]:
    if judge(free).physical:
        return free, judge(free).text
    body = nearest_body(free, covariance)
    moved = np.linalg.norm(np.linalg.solve(np.linalg.cholesky(covariance), body.parameters - free.parameters))
    return body, f"{judge(free).text}; the nearest body is {moved:.2g} standard deviations of noise away"
