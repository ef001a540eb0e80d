"""The dynamic mass of a structure from measured spectra: six runs that tell six base motions apart, the paper's Eqs. 9 to 11.

Columns of S_f and S_u are runs, rows are loads and base motions about one reference point, and at every line

    S_f = H S_u,   so   H = S_f S_u^-1                                            (Eqs. 10, 11)

With more than six runs the same is solved by least squares, each run with its weight. How well six motions are told apart is the
condition of S_u (`identification.base_motion`).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import LEVELS, MOTIONS, ComplexArray, DynamicMass
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array, freeze
from identification.base_motion import DrivenMotions, RunNoise


@dataclass(frozen=True, eq=False, kw_only=True)
class Estimate:
    """A dynamic mass from runs.

    Attributes
    ----------
    dynamic_mass : H about the reference point of the spectra
    excitation : how well the runs tell the six base motions apart, line by line
    inverse : (n, r, 6) the pseudo-inverse of S_u: H = S_f inverse, and an error of loads reaches H through it
    """

    dynamic_mass: DynamicMass
    excitation: DrivenMotions
    inverse: ComplexArray

    @property
    def condition(self) -> Array:
        """(n,) condition number [1] of the base motions at each line, every axis divided by its nominal level."""
        return self.excitation.condition


def from_runs(
    load: npt.ArrayLike,
    motion: npt.ArrayLike,
    frequency: npt.ArrayLike,
    reference_point: npt.ArrayLike = (0.0, 0.0, 0.0),
    *,
    weights: npt.ArrayLike | None = None,
) -> Estimate:
    """H from the spectra of six runs or more (Eqs. 9 to 11; least squares of all runs at each line).

    Parameters
    ----------
    load : (r, n, 6) spectra of forces and moments of the table on the structure about the reference point, run by run
    motion : (r, n, 6) spectra of the base acceleration about the same point
    frequency : (n,) lines [Hz]
    reference_point : (3,) [m]
    weights : (r,) or (r, n) one over the standard deviation of the loads of a run, in any unit; all alike by default

    Raises
    ------
    BadInput : fewer than six runs, shapes that do not fit, weights that are not positive, or base motions that are linearly
        dependent at a line; the combination is named.
    """
    F, U = np.asarray(load, dtype=np.complex128), np.asarray(motion, dtype=np.complex128)
    lines = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    if F.shape != U.shape or F.shape[1:] != (len(lines), 6):
        found = f"found {F.shape} and {U.shape}"
        raise _refused("load", f"spectra of six loads and six motions at {len(lines)} lines are needed, {found}")
    if len(F) < 6:
        raise _refused("runs", f"six linearly independent base motions take at least six runs, found {len(F)}")
    scale = np.array([LEVELS[axis] for axis in MOTIONS])
    excited = DrivenMotions.of_runs(U / scale, lines)
    excited.require_told_apart()
    shape = F.shape[:2]
    given = np.ones(shape) if weights is None else np.asarray(weights, dtype=np.float64)
    if given.shape not in (shape[:1], shape) or not np.all((given > 0) & np.isfinite(given)):
        raise _refused("weights", f"one positive number for each of {shape[0]} runs, or for each run and line, is needed")
    w = np.broadcast_to(given[:, None] if given.ndim == 1 else given, shape).T  # (n, r)
    columns = (U / scale).transpose(1, 2, 0) * w[:, None, :]
    inverted = np.linalg.inv(columns) if len(U) == 6 else np.linalg.pinv(columns)
    inverse = np.asarray(w[:, :, None] * inverted / scale, dtype=np.complex128)
    H = F.transpose(1, 2, 0) @ inverse
    mass = DynamicMass(frequency=lines, matrix=H, reference_point=np.asarray(reference_point, dtype=np.float64))
    return Estimate(dynamic_mass=mass, excitation=excited, inverse=inverse)


def quotient(load: npt.ArrayLike, motion: npt.ArrayLike, axis: str) -> ComplexArray:
    """The column (n, 6) of H by dividing one run's loads (n, 6) by the driven motion alone (Eq. 8a); `motion` (n, 6) spectra."""
    return np.asarray(np.asarray(load) / np.asarray(motion)[:, [MOTIONS.index(axis)]], dtype=np.complex128)


def _refused(field: str, problem: str) -> BadInput:
    remedy = "Give the spectra of every run on the same lines, each of the six axes driven in a run of its own"
    return BadInput("dynamic mass from runs", field, problem, remedy)


# What the simple quotient of the driven axis costs beside six runs solved together.
#
# The quotient (Eq. 8a) takes every load in the run of axis k for an answer to the motion along k. The table moves along the
# other five axes, too, and what these do is in the quotient: beside H from all runs (Eqs. 9 to 11) it is off by the sum of H_jl
# u_l / u_k over these five.


@dataclass(frozen=True, eq=False, kw_only=True)
class CrossMotion:
    """The quotient beside H, axis by axis.

    Attributes
    ----------
    quotient : (n, 6, 6) complex, its columns by single runs, about the reference point of H
    cross_motion : (6,) rms of the other five motions over the driven one, every axis divided by its nominal level
    diagonal : (6,) rms over the lines of what the quotient is off on the diagonal, as a share of the diagonal's rms
    column : (6,) the same for the largest load of the other five, as a share of the rms of sqrt(|H_jj H_kk|)
    text : (6,) a sentence for each axis
    """

    quotient: ComplexArray
    cross_motion: Array
    diagonal: Array
    column: Array
    text: tuple[str, ...]

    def __post_init__(self) -> None:
        freeze(self, cross_motion=(6,), diagonal=(6,), column=(6,))


def cost(load: npt.ArrayLike, motion: npt.ArrayLike, axes: Sequence[str], estimate: Estimate) -> CrossMotion:
    """What cross motion costs the quotient, from the first run of each axis.

    Parameters
    ----------
    load, motion : (r, n, 6) spectra about the reference point of `estimate`
    axes : (r,) driven axis of each run, empty for a pattern of several

    Raises
    ------
    BadInput : an axis that no run drives alone; a pattern of several axes has no quotient.
    """
    F, U = np.asarray(load, dtype=np.complex128), np.asarray(motion, dtype=np.complex128)
    lacking = [axis for axis in MOTIONS if axis not in axes]
    if lacking:
        problem = f"no run drives {', '.join(lacking)} alone"
        raise BadInput("quotient of the driven axis", "runs", problem, "Use all runs together")
    runs = [list(axes).index(axis) for axis in MOTIONS]
    columns = np.stack([quotient(F[run], U[run], axis) for run, axis in zip(runs, MOTIONS, strict=True)], axis=2)
    H = estimate.dynamic_mass.matrix
    off, own = _rms(columns - H), _rms(np.sqrt(np.abs(np.einsum("nj,nk->njk", *2 * [np.diagonal(H, axis1=1, axis2=2)]))))
    share = off / own
    others = share - np.diag(np.diag(share))
    scaled = _rms(U[runs].transpose(1, 0, 2)) / np.array([LEVELS[axis] for axis in MOTIONS])
    driven = np.diag(scaled)
    crossed = np.asarray(np.linalg.norm(scaled - np.diag(driven), axis=1) / driven)
    diagonal, column = np.diag(share), others.max(axis=0)
    text = tuple(
        f"{axis}: the other five axes move {100 * crossed[k]:.2g} % as much; the quotient is {100 * diagonal[k]:.2g} % off on "
        f"the diagonal and up to {100 * column[k]:.2g} % beside it"
        for k, axis in enumerate(MOTIONS)
    )
    return CrossMotion(quotient=columns, cross_motion=crossed, diagonal=diagonal, column=column, text=text)


def _rms(values: npt.NDArray[np.complex128] | Array) -> Array:
    """Over the first axis."""
    return np.asarray(np.sqrt(np.mean(np.abs(values) ** 2, axis=0)))


# What noise does to a dynamic mass, and how noise of the motions is kept from making it too small.
#
# Runs tell f_r = H u_r, but both sides are measured with noise, of covariances F_r and U_r. The residual e_r = f_r - H u_r then
# has the covariance R_r = F_r + H U_r H^H. Least squares takes u_r for exact; with more than six runs its answer is too low by
# the share of noise in the power of the motions. Likelihood takes the true motions for unknowns, too, and eliminates them: they
# are the corrected
#
#     v_r = u_r + U_r H^H R_r^-1 e_r ,      and H solves     sum_r R_r^-1 (f_r - H u_r) v_r^H = 0 ,
#
# iterated until it stands still (Fuller, Measurement Error Models, 1987; total least squares of Golub and Van Loan, SIAM J.
# Numer. Anal. 17, 1980, where all noise is alike). With six runs there is nothing to be corrected: e_r = 0 whatever they read.

STEADY, ROUNDS = 1e-10, 100
"""Relative change of H at which the iteration ends, and after how many rounds at the latest."""


def balance(H: ComplexArray, motion: ComplexArray, load: ComplexArray, noise: RunNoise) -> tuple[ComplexArray, ComplexArray]:
    """Residuals f - H u (r, n, 6) and their covariance F + H U H^H (r, n, 6, 6) for H (n, 6, 6).

    Raises
    ------
    BadInput : the noise of some load and line is zero, so that nothing can be weighed by it.
    """
    R = noise.load + H @ noise.motion @ H.conj().swapaxes(1, 2)
    if not np.all(np.linalg.eigvalsh(R)[..., 0] > 0):
        problem = "loads and motions without any noise cannot be weighed by it"
        raise BadInput("errors in variables", "noise", problem, "Give the noise of every channel")
    return np.asarray(load - np.einsum("njk,rnk->rnj", H, motion)), np.asarray(R)


def correction(H: ComplexArray, residual: ComplexArray, covariance: ComplexArray, noise: RunNoise) -> ComplexArray:
    """What the loads say against the motions: U H^H R^-1 e (r, n, 6)."""
    weighed = np.linalg.solve(covariance, residual[..., None])
    return np.asarray((noise.motion @ (H.conj().swapaxes(1, 2) @ weighed))[..., 0])


def corrected(
    load: npt.ArrayLike, motion: npt.ArrayLike, noise: RunNoise, estimate: Estimate
) -> tuple[DynamicMass, ComplexArray]:
    """H by errors in variables, from the least squares in `estimate`, and its covariance (n, 36, 36), entries row by row.

    Parameters
    ----------
    load, motion : (r, n, 6) spectra about the reference point of `estimate`
    noise : of both

    Raises
    ------
    BadInput : noise of zero.
    CheckFailed : the iteration does not settle, where noise is about as large as the motion.
    """
    F, U = np.asarray(load, dtype=np.complex128), np.asarray(motion, dtype=np.complex128)
    H = estimate.dynamic_mass.matrix
    for _ in range(ROUNDS):
        # The equations for H, with motions corrected by the present H: matrix (n, 36, 36), right side (n, 36)
        residual, R = balance(H, U, F, noise)
        V = (U + correction(H, residual, R, noise)).conj()
        weight = np.linalg.inv(R)
        left = np.einsum("rnaj,rnb,rnk->nabjk", weight, V, U, optimize=True).reshape(len(H), 36, 36)
        right = np.einsum("rnaj,rnj,rnb->nab", weight, F, V, optimize=True).reshape(len(H), 36)
        new = np.asarray(np.linalg.solve(left, right[..., None]).reshape(H.shape), dtype=np.complex128)
        change = np.abs(new - H).max() / np.abs(new).max()
        H = new
        if change <= STEADY:
            break
    else:
        raise CheckFailed("The correction of the motions' noise does not settle: it is about as large as the motions themselves")
    # N^-1 N_v N^-1: N_v is told by the corrected motions, N by the true ones, whose power lacks the noise left in those
    residual, R = balance(H, U, F, noise)
    V, W = (U + correction(H, residual, R, noise)).conj(), np.asarray(np.linalg.inv(R), dtype=np.complex128)
    HU = H @ noise.motion
    left_over = np.asarray((noise.motion - HU.conj().swapaxes(2, 3) @ W @ HU).conj(), dtype=np.complex128)
    power = np.asarray(V[..., :, None] * V.conj()[..., None, :], dtype=np.complex128)
    inverse = np.linalg.inv(_information(W, np.asarray(power - left_over, dtype=np.complex128)))
    return replace(estimate.dynamic_mass, matrix=H), np.asarray(inverse @ _information(W, power) @ inverse)


def covariance(estimate: Estimate, noise: RunNoise) -> ComplexArray:
    """(n, 36, 36) covariance E h h^H of the entries of a least-squares H, row by row, by noise on both sides (first order)."""
    H, P = estimate.dynamic_mass.matrix, estimate.inverse
    R = noise.load + H @ noise.motion @ H.conj().swapaxes(1, 2)
    return np.asarray(np.einsum("rnij,nrk,nrl->nikjl", R, P, P.conj(), optimize=True).reshape(len(H), 36, 36))


def bias(estimate: Estimate, noise: RunNoise) -> Array:
    """(n,) by what share least squares of more than six runs takes H for too small: noise in the power of the motions, H N S^-1.

    The motion that has most of it counts. 0 of six runs, which leave nothing to be corrected.
    """
    if noise.motion.shape[0] <= 6:
        return np.zeros(len(estimate.inverse))
    inverse_power = np.einsum("nrj,nrk->njk", estimate.inverse.conj(), estimate.inverse)  # (S_u S_u^H)^-1, conjugate
    share = noise.motion.sum(axis=0) @ inverse_power.conj()
    return np.asarray(np.abs(np.linalg.eigvals(share)).max(axis=1))


def deviation(covariance: ComplexArray) -> Array:
    """(n, 6, 6) standard deviation of each entry of H from their covariance (n, 36, 36)."""
    return np.asarray(np.sqrt(np.diagonal(covariance, axis1=1, axis2=2).real).reshape(-1, 6, 6))


def _information(weight: ComplexArray, power: ComplexArray) -> ComplexArray:
    n = weight.shape[1]
    return np.asarray(np.einsum("rnaj,rnbk->nabjk", weight, power, optimize=True).reshape(n, 36, 36))
