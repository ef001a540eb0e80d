"""`Damping`: what takes energy out of a structure, in the forms in which engineers know it. They add.

    viscous     C = diag(2 zeta_r omega_r) + modal + Phi^T C_u Phi     forces follow the velocity
    structural  S = sum over parts of eta_p Phi^T K_p Phi              forces follow the displacement: K (1 + i eta)

In the modal equations -omega² + i (omega C + S) + Omega² the off-diagonal entries of both stay: in a cluster of frequencies they
are as large as the distance of the modes (Craig & Kurdila, Fundamentals of Structural Dynamics; Nashif, Vibration Damping).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from fem.structure import Sparse, Structure
from geometry.errors import BadInput
from geometry.frames import Array
from geometry.toml_file import nearest

DEFAULT_RATIO = 0.003
"""Damping ratio of every mode of a structure that brings no loss factors: an assumed bolted steel assembly."""

ASSUMED_WITHIN = 3.0
"""Factor, one standard deviation, by which what is assumed may be off: welded steel has 0.1 %, boxes of electronics 1 to 2 %."""

ROUNDING = 1e-9

FEEDS = 1e-6
"""Share of the largest loss below which a negative one is what single precision and printed digits leave of zero."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Damping:
    """Damping of a structure; all that is given acts together.

    Attributes
    ----------
    ratio : damping ratio [1] of every mode, or (n,) of each; at least 0 and below 1
    loss_factors : structural loss factor [1] by part of the structure; at least 0 and below 2 (a ratio of 1)
    modal : (n, n) viscous damping matrix [rad/s] of mass-normalised modes, symmetric, positive semi-definite
    viscous : (N, N) sparse viscous damping matrix of the structure's degrees of freedom [N s/m ...], symmetric

    Raises
    ------
    BadInput : a value out of its bounds, a matrix that is unsymmetric or would drive the structure.
    """

    ratio: npt.ArrayLike | None = None
    loss_factors: Mapping[str, float] = field(default_factory=dict)
    modal: npt.ArrayLike | None = None
    viscous: Sparse = None

    def __post_init__(self) -> None:
        if self.ratio is not None:
            ratio = np.asarray(self.ratio, dtype=np.float64)
            if ratio.ndim > 1:
                problem = f"one value or a list of one per mode is needed, found shape {ratio.shape}"
                raise _bad("ratio", problem, "Use `modal` for a matrix")
            wrong = ~((ratio >= 0) & (ratio < 1))  # NaN is wrong too
            if np.any(wrong):
                found = np.atleast_1d(ratio)[np.atleast_1d(wrong)][0]
                problem = f"a damping ratio must be at least 0 and below 1, found {found:g}"
                raise _bad("ratio", problem, "Give it as a fraction: 0.5 % is 0.005")
        for part, eta in self.loss_factors.items():
            if not 0 <= eta < 2:
                problem = f"a loss factor must be at least 0 and below 2, which is a damping ratio of 1, found {eta:g}"
                raise _bad(f"loss_factors.{part}", problem, "Give it as a fraction: steel about 0.001, silicone about 0.2")
        if self.modal is not None:
            matrix = np.asarray(self.modal, dtype=np.float64)
            if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1] or not np.all(np.isfinite(matrix)):
                remedy = "Give one row per mode"
                raise _bad("modal", f"a square matrix of finite numbers is needed, found shape {matrix.shape}", remedy)
            scale = np.abs(matrix).max(initial=0.0)
            if np.abs(matrix - matrix.T).max(initial=0.0) > ROUNDING * scale:
                remedy = "Symmetrise it, or leave gyroscopics out"
                raise _bad("modal", "it must be symmetric, found entries that differ from their mirror", remedy)
            lowest = np.linalg.eigvalsh(matrix).min(initial=0.0)
            if lowest < -ROUNDING * scale:
                remedy = "Check the signs of its entries"
                raise _bad("modal", f"it must not feed energy in, found a negative eigenvalue {lowest:g} rad/s", remedy)
        if (C := self.viscous) is not None:
            if C.ndim != 2 or C.shape[0] != C.shape[1] or not np.all(np.isfinite(C.data)):
                problem = f"a square sparse matrix of finite numbers is needed, found shape {C.shape}"
                raise _bad("viscous", problem, "Check the file")
            if np.abs((C - C.T).data).max(initial=0.0) > ROUNDING * np.abs(C.data).max(initial=0.0):
                problem = "it must be symmetric, found entries that differ from their mirror"
                raise _bad("viscous", problem, "Leave gyroscopic terms out")
            if np.any(C.diagonal() < 0):
                problem = f"it must not feed energy in, found {C.diagonal().min():g} on its diagonal"
                raise _bad("viscous", problem, "Check the signs")


def default_damping(structure: Structure) -> Damping:
    """The loss factors that `structure` brings, else `DEFAULT_RATIO` for every mode."""
    return Damping(ratio=DEFAULT_RATIO) if is_assumed(structure, None) else Damping(loss_factors=structure.loss_factors)


def is_assumed(structure: Structure, stated: Damping | None) -> bool:
    """Whether nobody said what `structure` loses: neither `stated`, nor a loss factor of it."""
    return stated is None and not (structure.loss_factors and structure.part_stiffness)


def modal_matrices(damping: Damping, structure: Structure, omega: Array, shapes: Array) -> tuple[Array, Array]:
    """Viscous C (n, n) [rad/s] and structural S (n, n) [rad²/s²] of mass-normalised modes.

    Parameters
    ----------
    omega : (n,) [rad/s]
    shapes : (N, n) on all degrees of freedom of `structure`

    Raises
    ------
    BadInput : a ratio or modal matrix of another number of modes, a matrix of another size, a part that the structure has not;
        C or S that feeds energy into a motion of these modes, a mode that does not oscillate (ratio of 1 and above).
    """
    C = damping_per_mode(damping, omega)
    if damping.viscous is not None:
        C = C + symmetric(shapes.T @ (viscous_matrix(damping, structure) @ shapes))
    S = np.zeros_like(C)
    for K in _lossy(damping, structure):
        S = S + symmetric(shapes.T @ (K @ shapes))
    _require_losses(C, np.sqrt(omega), "viscous")
    _require_losses(S, omega, "structural")
    ratio = equivalent_ratio(C, S, omega)
    if not ratio.max(initial=0.0) < 1:  # NaN is wrong too
        r = int(np.argmax(ratio >= 1))
        problem = (
            f"a mode must keep swinging, found the damping ratio {ratio[r]:.4g} for mode {r + 1} at {omega[r] / 2 / np.pi:.4g} Hz"
        )
        name = "viscous" if C[r, r] * omega[r] > S[r, r] else "structural"
        raise _bad(name, problem, "A ratio stays below 1: check the unit of its entries, or ask for fewer modes")
    return C, S


def damping_per_mode(damping: Damping, omega: Array) -> Array:
    """The part of C (n, n) [rad/s] that is given per mode: diag(2 zeta omega) and `modal`; omega (n,) [rad/s].

    Raises
    ------
    BadInput : a ratio or modal matrix of another number of modes.
    """
    count, ratio = len(omega), np.asarray(0.0 if damping.ratio is None else damping.ratio, dtype=np.float64)
    if ratio.ndim and ratio.shape != (count,):
        problem = f"one value or one for each of the {count} modes is needed, found {ratio.size}"
        raise _bad("ratio", problem, "Give one ratio for all modes, or ask for as many modes as there are ratios")
    matrix = np.zeros((count, count)) if damping.modal is None else np.asarray(damping.modal, dtype=np.float64)
    if matrix.shape != (count, count):
        problem = f"it must have a row and a column for each of the {count} modes, found {matrix.shape}"
        raise _bad("modal", problem, "Ask for as many modes as it has rows")
    return np.diag(2 * np.broadcast_to(ratio, (count,)) * omega) + matrix


def structural_matrix(damping: Damping, structure: Structure) -> Sparse:
    """sum over parts of eta_p K_p (N, N) sparse, or None when no part has a loss factor.

    Raises
    ------
    BadInput : a part that the structure has not.
    """
    matrices = _lossy(damping, structure)
    return sum(matrices[1:], start=matrices[0]) if matrices else None


def viscous_matrix(damping: Damping, structure: Structure) -> Sparse:
    """The viscous matrix (N, N) of the degrees of freedom, or None.

    Raises
    ------
    BadInput : it has another size than `structure`.
    """
    if damping.viscous is not None and damping.viscous.shape != structure.mass.shape:
        problem = f"it must be as large as the structure's matrices {structure.mass.shape}, found {damping.viscous.shape}"
        raise _bad("viscous", problem, "Give it on all degrees of freedom of the structure, the held ones too")
    return damping.viscous


def equivalent_ratio(viscous: Array, structural: Array, omega: Array) -> Array:
    """Damping ratio (n,) [1] that each mode would have alone: (C_rr + S_rr / omega_r) / (2 omega_r)."""
    swings = np.where(omega > 0, omega, np.inf)  # a rigid motion of a free structure does not
    return np.asarray((np.diag(viscous) + np.diag(structural) / swings) / (2 * swings))


def _lossy(damping: Damping, structure: Structure) -> list[Sparse]:
    """eta_p K_p of every part with a loss factor above zero."""
    for part in damping.loss_factors:
        if part not in structure.part_stiffness:
            known = ", ".join(sorted(structure.part_stiffness)) or "none: the model does not keep its parts apart"
            remedy = f"{nearest(part, structure.part_stiffness)}Its parts are {known}"
            raise _bad("loss_factors", f"the structure has no part {part!r}", remedy)
    return [eta * structure.part_stiffness[part] for part, eta in damping.loss_factors.items() if eta > 0]


def _require_losses(matrix: Array, scale: Array, name: str) -> None:
    """Refuse an indefinite modal matrix; `scale` (n,) makes a loss factor of what is on its diagonal, whatever the frequency."""
    if not scale.any():  # rigid motions alone, of which nothing but rounding is left
        return
    scale = np.where(scale > 0, scale, scale.max())
    loss = np.linalg.eigvalsh(matrix / np.outer(scale, scale))
    if loss.min(initial=0.0) < -FEEDS * np.abs(loss).max(initial=0.0):
        problem = f"it must not feed energy in, found a motion of the modes with the loss factor {loss.min():.3g}"
        remedy = "Check the signs of its entries beside the diagonal, and that it is damping and not gyroscopics"
        raise _bad(name, problem, remedy)


def symmetric(matrix: Array) -> Array:
    """The symmetric part of `matrix` (n, n)."""
    return np.asarray((matrix + matrix.T) / 2)


def _bad(name: str, problem: str, remedy: str) -> BadInput:
    return BadInput("damping", name, problem, remedy)
