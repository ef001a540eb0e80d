"""The dynamic mass of a rigid body with elastic terms, its derivatives, and the vector of parameters that fits move.

    H = M(p) + omega² L^T D^-1 L + omega² R,   D = Omega² - omega² + i omega C                       (paper Eq. 8b in matrix form)

With X = D^-1 L every derivative is an outer product of rows of X, because dH = -omega² X^T dD X and D is symmetric. Nothing is
re-diagonalised, so a cluster of modes stays smooth.

The vector holds, in this order: the ten of Eq. 4, ln f, ln zeta, the damping of pairs as a share of what its two modes have,
rho_rs = C_rs / sqrt(C_rr C_ss), L mode by mode, and the 21 of R. Rotations are divided by the length that the nominal levels of
the axes give, and R is multiplied by (2 pi 20 Hz)², so that all but the logarithms and rho are in kg or kg^0.5.
"""

from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import LEVELS, MOTIONS, ComplexArray
from geometry.frames import Array, Integers, freeze
from geometry.inertia import PARAMETERS, Inertia

# `ElasticTerms`: what elasticity adds to the rigid mass matrix, in the form of Eq. 8b with poles that all 36 entries share.
#
#     H(omega) = M_F + omega² L^T (Omega² - omega² + i omega C)^-1 L + omega² R
#
# L holds a row of participation for each mode, C is the modal damping - diagonal 2 zeta omega, but full within a cluster -
# and R, symmetric, is what all modes beyond the band answer statically. H(0) = M_F: that is the extrapolation to frequency 0.


@dataclass(frozen=True, eq=False, kw_only=True)
class ElasticTerms:
    """Elastic terms about the reference point; none at all by default.

    Attributes
    ----------
    frequency : (m,) [Hz] of the undamped modes of the blocked structure
    damping : (m, m) symmetric, 2 zeta omega on the diagonal [rad/s]
    participation : (m, 6) [sqrt(kg)] and [sqrt(kg) m], order of `MOTIONS`
    residual : (6, 6) symmetric, [kg s²], [kg m s²], [kg m² s²]
    """

    frequency: Array = field(default_factory=lambda: np.zeros(0))
    damping: Array = field(default_factory=lambda: np.zeros((0, 0)))
    participation: Array = field(default_factory=lambda: np.zeros((0, 6)))
    residual: Array = field(default_factory=lambda: np.zeros((6, 6)))

    def __post_init__(self) -> None:
        m = len(self.frequency)
        freeze(self, frequency=(m,), damping=(m, m), participation=(m, 6), residual=(6, 6))

    @property
    def damping_ratio(self) -> Array:
        """(m,) [1]."""
        return np.diag(self.damping) / (4 * np.pi * self.frequency)


SCALE = np.array([LEVELS["x"] / LEVELS[axis] for axis in MOTIONS])
"""(6,) [1] and [m]: S H S with S = diag(1 / SCALE) is in kg throughout."""

REFERENCE = (2 * np.pi * 20.0) ** 2
"""[rad²/s²]: the residual is told by its share of H at 20 Hz."""

UPPER = np.triu_indices(6)
"""Rows and columns of the 21 entries of a symmetric 6x6 matrix."""

_PLACE = np.array([[UPPER[0].tolist().index(min(i, j)) + abs(i - j) for j in range(6)] for i in range(6)]).ravel()
"""(36,) where among the 21 each entry of the matrix stands."""


@dataclass(frozen=True, kw_only=True)
class ElasticLayout:
    """What the vector of parameters holds.

    Attributes
    ----------
    modes : number of poles
    pairs : (r, s), r < s, of the modes whose damping is coupled
    residual : whether the 21 of R are among the parameters; 0 when they are not
    """

    modes: int
    pairs: tuple[tuple[int, int], ...] = ()
    residual: bool = True

    @property
    def blocks(self) -> dict[str, slice]:
        """Where inertia, frequency, damping, pairs, participation and residual stand."""
        m = self.modes
        counts = {"inertia": 10, "frequency": m, "damping": m, "pairs": len(self.pairs), "participation": 6 * m}
        counts["residual"] = 21 * self.residual
        ends = np.cumsum([0, *counts.values()]).tolist()
        return {name: slice(ends[k], ends[k + 1]) for k, name in enumerate(counts)}

    @property
    def size(self) -> int:
        """Length of the vector."""
        return int(self.blocks["residual"].stop)

    @property
    def names(self) -> tuple[str, ...]:
        """Of every parameter, modes counted from 1: m, f[1], zeta[1], rho[1,2], L[1,x], R[x,beta] ..."""
        modes = range(1, self.modes + 1)
        return (
            *PARAMETERS,
            *(f"f[{r}]" for r in modes),
            *(f"zeta[{r}]" for r in modes),
            *(f"rho[{r + 1},{s + 1}]" for r, s in self.pairs),
            *(f"L[{r},{axis}]" for r in modes for axis in MOTIONS),
            *(f"R[{MOTIONS[i]},{MOTIONS[j]}]" for i, j in zip(*UPPER, strict=True) if self.residual),
        )


def layout_of(terms: ElasticTerms, *, widths: float | None = None) -> ElasticLayout:
    """The layout of `terms`: pairs are those that have coupled damping, or - with `widths` - those that overlap.

    Parameters
    ----------
    widths : distance of two frequencies, in the geometric mean of their half-power widths 2 zeta f, up to which damping is
        coupled; at that distance the coupling mixes 1 / (2 widths) rho of one mode into the other
    """
    f, C = terms.frequency, terms.damping
    width = np.sqrt(np.diag(C)) / np.sqrt(2 * np.pi)
    near = C != 0 if widths is None else np.abs(f[:, None] - f) <= widths * np.outer(width, width)
    pairs = tuple((int(r), int(s)) for r, s in zip(*np.nonzero(np.triu(near, 1)), strict=True))
    return ElasticLayout(modes=len(f), pairs=pairs)


def dynamic_mass(mass_matrix: npt.ArrayLike, terms: ElasticTerms, frequency: npt.ArrayLike) -> ComplexArray:
    """H (n, 6, 6) about the reference point of `mass_matrix` (6, 6) and `terms`, at `frequency` (n,) [Hz]."""
    return by_answers(mass_matrix, terms, frequency, answers(terms, frequency))


def by_answers(mass_matrix: npt.ArrayLike, terms: ElasticTerms, frequency: npt.ArrayLike, X: ComplexArray) -> ComplexArray:
    """The same where the `answers` X (n, m, 6) are known."""
    return np.asarray(mass_matrix, dtype=np.complex128) + _squares(frequency) * (terms.participation.T @ X + terms.residual)


def whole(upper: ComplexArray) -> ComplexArray:
    """Symmetric (..., 6, 6) from its entries (..., 21) in `UPPER`."""
    return upper[..., _PLACE].reshape(*upper.shape[:-1], 6, 6)


def upper_derivatives(terms: ElasticTerms, frequency: npt.ArrayLike, layout: ElasticLayout) -> ComplexArray:
    """Derivatives (k, n, 21) of the entries of H in `UPPER`, all that a symmetric matrix has, by the vector of `layout`.

    They do not depend on the ten inertia parameters, in which H is linear.
    """
    blocks, (common, answer) = layout.blocks, parts(terms, frequency, layout, answers(terms, frequency))
    out = np.zeros((layout.size, common.shape[2], 21), dtype=np.complex128)
    out[: len(common)] = common.transpose(0, 2, 1)
    if layout.residual:
        out[blocks["residual"]] = _squares(frequency)[:, :, 0] * residual_basis()[:, None, UPPER[0], UPPER[1]]
    # L: row j and column j of H are omega² X_r
    by_participation = out[blocks["participation"]].reshape(layout.modes, 6, common.shape[2], 21)
    for e, (i, j) in enumerate(zip(*UPPER, strict=True)):
        by_participation[:, i, :, e] += SCALE[i] * answer[:, j]
        by_participation[:, j, :, e] += SCALE[j] * answer[:, i]
    return out


def parts(
    terms: ElasticTerms, frequency: npt.ArrayLike, layout: ElasticLayout, answered: ComplexArray
) -> tuple[ComplexArray, ComplexArray]:
    """Of the same those (d, 21, n) that move all entries - inertia, ln f, ln zeta, rho - and omega² X (m, 6, n), X as `answered`.

    What a participation L_ri moves are row and column i alone, by omega² X_r.
    """
    blocks, w2 = layout.blocks, _squares(frequency)[:, 0, 0]
    X = np.ascontiguousarray(answered.transpose(1, 2, 0))
    out = np.empty((blocks["pairs"].stop, 21, len(w2)), dtype=np.complex128)
    out[blocks["inertia"]] = inertia_basis()[:, UPPER[0], UPPER[1], None]
    # ln f, through stiffness and through the damping 2 zeta omega that ln zeta shares, ln zeta and rho
    r, s = _pairs(layout)
    squares, d = (2 * np.pi * terms.frequency) ** 2, np.sqrt(np.diag(terms.damping))
    lossy = -1j * w2**1.5
    out[blocks["damping"]] = _both(X * (lossy / 2), np.tensordot(terms.damping, X, axes=1))
    out[blocks["frequency"]] = out[blocks["damping"]] - _both(X * (squares[:, None, None] * w2), X)
    out[blocks["pairs"]] = _both(X[r] * ((d[r] * d[s])[:, None, None] * lossy), X[s])
    return out, w2 * X


def pack(parameters: npt.ArrayLike, terms: ElasticTerms, layout: ElasticLayout | None = None) -> Array:
    """The vector (k,) of ten inertia `parameters` (Eq. 4) and `terms`; damping of pairs outside `layout` is left out."""
    layout = layout or layout_of(terms)
    C, pairs = terms.damping, _pairs(layout)
    d = np.sqrt(np.diag(C))
    R = (terms.residual / np.outer(SCALE, SCALE) * REFERENCE)[UPPER]
    return np.concatenate(
        [
            np.asarray(parameters, dtype=np.float64) / inertia_scale(),
            np.log(terms.frequency),
            np.log(terms.damping_ratio),
            C[pairs] / (d[pairs[0]] * d[pairs[1]]),
            (terms.participation / SCALE).ravel(),
            R if layout.residual else R[:0],
        ]
    )


def unpack(vector: npt.ArrayLike, layout: ElasticLayout) -> tuple[Array, ElasticTerms]:
    """Ten inertia parameters and terms from a vector (k,)."""
    x = np.asarray(vector, dtype=np.float64)
    part = {name: x[place] for name, place in layout.blocks.items()}
    f, pairs = np.exp(part["frequency"]), _pairs(layout)
    d = np.sqrt(4 * np.pi * np.exp(part["damping"]) * f)
    C = np.diag(d**2)
    C[pairs] = C[pairs[::-1]] = part["pairs"] * d[pairs[0]] * d[pairs[1]]
    entries = part["residual"]
    R = np.tensordot(entries, residual_basis(), axes=1) if len(entries) else np.zeros((6, 6))
    L = part["participation"].reshape(-1, 6) * SCALE
    return part["inertia"] * inertia_scale(), ElasticTerms(frequency=f, damping=C, participation=L, residual=R)


def chosen(terms: ElasticTerms, modes: npt.ArrayLike) -> ElasticTerms:
    """`terms` with the `modes` (indices) alone, in that order; their own damping stays."""
    k = np.asarray(modes, dtype=np.intp)
    return replace(terms, frequency=terms.frequency[k], damping=terms.damping[np.ix_(k, k)], participation=terms.participation[k])


@lru_cache(maxsize=1)
def inertia_basis() -> Array:
    """(10, 6, 6): the mass matrix of Eq. 1 for one unit of the vector in each of the ten."""
    return np.stack([Inertia(parameters=row).mass_matrix for row in np.diag(inertia_scale())])


@lru_cache(maxsize=1)
def residual_basis() -> Array:
    """(21, 6, 6): R for one unit of the vector in each of its entries."""
    basis = np.zeros((21, 6, 6))
    k = np.arange(21)
    basis[k, UPPER[0], UPPER[1]] = basis[k, UPPER[1], UPPER[0]] = np.outer(SCALE, SCALE)[UPPER] / REFERENCE
    return basis


def inertia_scale() -> Array:
    """(10,) [1], [m] and [m²]: what one unit of the vector is in each of the ten."""
    length = float(SCALE[3])
    return np.array([1.0, *3 * [length], *6 * [length**2]])


def _pairs(layout: ElasticLayout) -> tuple[Integers, Integers]:
    pairs = np.array(layout.pairs, dtype=np.intp).reshape(-1, 2)
    return pairs[:, 0], pairs[:, 1]


def _squares(frequency: npt.ArrayLike) -> Array:
    """omega² (n, 1, 1)."""
    return (2 * np.pi * np.atleast_1d(np.asarray(frequency, dtype=np.float64))[:, None, None]) ** 2


def answers(terms: ElasticTerms, frequency: npt.ArrayLike) -> ComplexArray:
    """X = D^-1 L (n, m, 6)."""
    w = 2 * np.pi * np.atleast_1d(np.asarray(frequency, dtype=np.float64))[:, None]
    squares, C, L = (2 * np.pi * terms.frequency) ** 2, terms.damping, terms.participation
    if not np.any(C - np.diag(np.diag(C))):
        return np.asarray(L / (squares - w**2 + 1j * w * np.diag(C))[:, :, None])
    D = np.diag(squares) - w[:, :, None] ** 2 * np.eye(len(squares)) + 1j * w[:, :, None] * C
    return np.asarray(np.linalg.solve(D, np.broadcast_to(L, (len(w), *L.shape)).astype(np.complex128)))


def _both(left: ComplexArray, right: ComplexArray) -> ComplexArray:
    """(k, 21, n): left right^T + right left^T of (k, 6, n)."""
    i, j = UPPER
    return np.asarray(left[:, i] * right[:, j] + right[:, i] * left[:, j])
