"""`Modes`: eigenfrequencies, shapes and participation of a structure whose base is held - what the dynamic mass is made of.

With base motion u_b and the displacements relative to it expanded in mass-normalised fixed-base modes, the modal equations
are q'' + 2 zeta omega q' + omega² q = -L^T u_b''. L is the participation about the reference point and L L^T of one mode its
effective mass. Of the modes that are not kept, the static share of their answer is: the residual mass R = sum of L L^T / omega²
over them, which follows from one static solution with the base accelerated, without any of them being computed (Craig, Structural
Dynamics).
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from fem.damping import Damping, default_damping, equivalent_ratio, modal_matrices, structural_matrix
from fem.factorisers import Factor, Singular, factorise
from fem.structure import HeldBase, Sparse, Structure, check_connected, check_stiff, hold, restricted
from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array, freeze

# `Condensed`: kept modes with the static answer of the truncated ones, where structural damping couples the two.
#
# A lossy layer (silicone, loss factor 0.2) pulls at kept and truncated modes alike, and the truncated ones give way. With all
# modes in hand the modal stiffness is A = Omega² + i S; taking the truncated ones as static leaves the Schur complement of A on
# the kept ones. It needs none of the truncated modes, because it is the inverse of a block of A^-1, and that is a static
# solution with the complex stiffness (Guyan's condensation, AIAA Journal 3, 1965, in modal coordinates):
#
#     F_kk = (M Phi)^T (K + i S)^-1 M Phi,   F_kb = (M Phi)^T (K + i S)^-1 P,   F_bb = P^T (K + i S)^-1 P
#     A = F_kk^-1,   L^T = A F_kb,   R = F_bb - F_kb^T A F_kb.
#
# Without damping these are Omega², the participation and the residual mass themselves.

MODERATE = 0.5
"""Up to this loss factor the real factors serve: the series in K^-1 S converges like its powers."""

FEW = 2_000
"""Up to so many degrees of freedom a complex factorisation is the quicker way."""

SETTLED = 1e-10


@dataclass(frozen=True, eq=False, kw_only=True)
class Condensed:
    """Complex counterparts of squared frequencies, participation and residual mass.

    Attributes
    ----------
    stiffness : (n, n) [rad²/s²], symmetric
    participation : (6, n) [kg^0.5, kg^0.5 m]
    residual : (6, 6) [kg s², kg m s², kg m² s²], symmetric
    """

    stiffness: ComplexArray
    participation: ComplexArray
    residual: ComplexArray


def condensed(
    held: HeldBase, S: Sparse, greatest: float, shapes: Array, factor: Factor | None = None, factoriser: str | None = None
) -> Condensed:
    """The truncated modes of `held` condensed on `shapes` (f, n).

    Parameters
    ----------
    S : (f, f) sparse structural damping, sum of eta_p K_p
    greatest : the greatest loss factor in it
    factor : of the stiffness, if there is one already
    factoriser : name as in `fem.factorisers`
    """
    n, loads = shapes.shape[1], np.hstack([held.mass @ shapes, held.load])
    if greatest > MODERATE or held.free.size <= FEW:
        whole = factorise((held.stiffness + 1j * S).tocsc(), name=None if factoriser == "cholmod" else factoriser)
        X: ComplexArray = np.asarray(whole.solve(loads.astype(np.complex128)), dtype=np.complex128)
    else:
        # (1 - i T + (i T)² - ...) K^-1 B with T = K^-1 S: real solutions only, as many as the greatest loss factor asks for
        real = factor or factorise(held.stiffness, definite=True, name=factoriser)
        term = np.asarray(real.solve(loads), dtype=np.float64)
        X, first, turn = np.asarray(term, dtype=np.complex128), np.abs(term).max(), 1.0 + 0.0j
        while np.abs(term).max() > SETTLED * first:
            term, turn = np.asarray(real.solve(S @ term)), -1j * turn
            X += turn * term
    F = loads.T @ X
    A = np.asarray(np.linalg.inv(F[:n, :n]), dtype=np.complex128)
    L = A @ F[:n, n:]
    R = F[n:, n:] - F[n:, :n] @ L
    return Condensed(
        stiffness=np.asarray((A + A.T) / 2), participation=np.ascontiguousarray(L.T), residual=np.asarray((R + R.T) / 2)
    )


# The lowest eigenvalues of K x = lambda M x, by inverting about a shift.
#
# Both methods look for the largest theta = 1 / (lambda - sigma), where a discretised structure keeps its lowest modes well apart
# from a crowd that nobody wants (Ericsson & Ruhe, Math. Comp. 35, 1980). Small problems go to LAPACK, large ones to ARPACK's
# Lanczos iteration with a factorised K - sigma M. A mass matrix may be singular (joints without mass): there theta is zero.
#
# Lanczos sees one vector of equal eigenvalues, and the others only as rounding brings them in; symmetric articles have many. So
# the rest of the space is searched once more from another start. When a mode turns up there below the last one kept, the
# iteration is repeated in that rest, and the lowest of both are kept.

DENSE = 250
"""Up to so many degrees of freedom LAPACK is the faster way."""

SEEN = 1e-12
"""Share of the largest theta below which rounding decides: frequencies beyond a million times the lowest are not given."""

CONVERGED = 1e-10
"""Relative residual at which Lanczos may stop; the eigenvalues are then right to its square."""

SEARCH_STEPS = 20
ROUNDS = 4
MISSED = 1.001
"""How far theta of the searched rest may lie above the last mode's before that mode counts as missed."""

Progress = Callable[[int], None]
"""Called with the number of solutions with the factors so far; it may raise to end the iteration."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Eigenpairs:
    """The lowest eigenvalues and their vectors.

    Attributes
    ----------
    values : (n,) [rad²/s²], ascending
    vectors : (f, n) mass-normalised; the entry largest in size of each is positive
    factor : what was factorised for them, K - shift M; None when LAPACK did it
    """

    values: Array
    vectors: Array
    factor: Factor | None = None


def lowest(
    stiffness: Sparse,
    mass: Sparse,
    count: int,
    *,
    shift: float = 0.0,
    factoriser: str | None = None,
    progress: Progress | None = None,
) -> Eigenpairs:
    """The `count` eigenpairs of (K, M) nearest above `shift`, or all there are when they are fewer.

    Parameters
    ----------
    stiffness, mass : (f, f) sparse, symmetric; K positive semi-definite, M too but for what is taken away at single places
    shift : [rad²/s²], not above the lowest eigenvalue; below zero for a body that floats freely (`floating_shift`)
    factoriser : name as in `fem.factorisers`; chosen by itself when None
    progress : hook, see `Progress`

    Raises
    ------
    CheckFailed : K - shift M is singular, the iteration does not converge, or a mode was missed.
    """
    size = stiffness.shape[0]
    if size == 0:
        return Eigenpairs(values=np.zeros(0), vectors=np.zeros((0, 0)))
    if size <= DENSE or count > size // 4:
        from scipy.linalg import LinAlgError, eigh

        m = mass.toarray()
        try:
            theta, vectors = eigh(m, stiffness.toarray() - shift * m)
        except LinAlgError:
            raise _floats() from None
        best = np.flatnonzero(theta > SEEN * theta[-1])[::-1][:count]
        return _sorted(shift + 1 / theta[best], vectors[:, best] / np.sqrt(theta[best]))
    return _by_lanczos(stiffness, mass, count, shift, factoriser, progress or (lambda solved: None))


def floating_shift(stiffness: Sparse, mass: Sparse) -> float:
    """A shift below zero for a body that floats freely, in the scale of its matrices [rad²/s²].

    Small beside the stiffness, so that the elastic modes keep their distance, and large beside its rounding.
    """
    K, M = stiffness.diagonal(), mass.diagonal()
    return -1e-9 * float(np.median(K[M > 0] / M[M > 0]))


def _by_lanczos(K: Sparse, M: Sparse, count: int, shift: float, factoriser: str | None, progress: Progress) -> Eigenpairs:
    try:
        factor = factorise(K - shift * M if shift else K, definite=True, name=factoriser)
    except Singular:
        raise _floats() from None
    solved = 0

    def solve(b: Array) -> Array:
        nonlocal solved
        solved += 1
        progress(solved)
        return np.asarray(factor.solve(b), dtype=np.float64)

    # What measures lengths: the mass, or the energy where more of it is taken away from a place than is there
    length = K - shift * M if M.diagonal().min() < 0 else M
    pairs = _iterated(K, M, count, shift, solve, np.zeros((K.shape[0], 0)), length)
    for _ in range(ROUNDS):
        best = largest_left(M, pairs.vectors, solve, length)
        if best <= MISSED / (pairs.values[-1] - shift):
            return replace(pairs, factor=factor)
        others = _iterated(K, M, count, shift, solve, pairs.vectors, length)
        together = _sorted(np.append(pairs.values, others.values), np.hstack([pairs.vectors, others.vectors]))
        pairs = Eigenpairs(values=together.values[:count], vectors=together.vectors[:, :count])
    frequency = np.sqrt(max(shift + 1 / best, 0.0)) / (2 * np.pi)
    said = f"The eigenvalue iteration missed a mode near {frequency:.4g} Hz. Ask for a few more modes."
    raise CheckFailed(said, frequency_hz=frequency)


def _iterated(
    K: Sparse, M: Sparse, count: int, shift: float, solve: Callable[[Array], Array], known: Array, length: Sparse
) -> Eigenpairs:
    """`count` eigenpairs by ARPACK in the space M-orthogonal to the modes `known` (f, m), as `length` measures."""
    from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

    def inverse(b: Array) -> Array:
        x = solve(b)
        return np.asarray(x - known @ (known.T @ (M @ x)))

    size = K.shape[0]
    start = inverse(M @ np.random.default_rng(0).standard_normal(size))  # M first: a massless direction has no place in it
    operator, ncv = LinearOperator(K.shape, matvec=inverse, dtype=np.float64), min(size, max(2 * count + 1, 20))
    try:
        if length is not M:
            theta, vectors = eigsh(M, count, M=length, Minv=operator, v0=start, ncv=ncv, tol=CONVERGED, which="LA")
            return _sorted(shift + 1 / theta, vectors / np.sqrt(theta))
        return _sorted(*eigsh(K, count, M=M, sigma=shift, OPinv=operator, v0=start, ncv=ncv, tol=CONVERGED))
    except ArpackNoConvergence as error:
        raise CheckFailed(
            f"The eigenvalue iteration found {len(error.eigenvalues)} of {count} modes and stopped. Ask for fewer modes, or "
            "check that stiffness and mass are symmetric and in the same units.",
            found=len(error.eigenvalues),
        ) from None


def largest_left(M: Sparse, vectors: Array, solve: Callable[[Array], Array], length: Sparse) -> float:
    """A lower bound of theta in the space M-orthogonal to `vectors` (f, n): some Lanczos steps from a start of their own."""
    from scipy.linalg import eigh_tridiagonal

    vectors = vectors / np.sqrt(np.sum(vectors * (length @ vectors), axis=0))
    basis = np.zeros((len(vectors), 0))
    diagonal: list[float] = []
    beside: list[float] = []
    vector = solve(M @ np.random.default_rng(1).standard_normal(len(vectors)))
    for _ in range(min(SEARCH_STEPS, vectors.shape[0] - vectors.shape[1])):
        for known in (vectors, basis, vectors, basis):  # twice is enough (Parlett, The Symmetric Eigenvalue Problem, 6.9)
            vector = vector - known @ (known.T @ (length @ vector))
        norm = float(np.sqrt(max(vector @ (length @ vector), 0.0)))
        if diagonal:
            if norm <= SEEN * max(diagonal):
                break
            beside.append(norm)
        elif norm == 0.0:
            return 0.0
        vector = vector / norm
        basis, along = np.column_stack([basis, vector]), length @ vector
        vector = solve(M @ vector)
        diagonal.append(float(along @ vector))
    return float(eigh_tridiagonal(diagonal, beside, eigvals_only=True)[-1])


def _sorted(values: Array, vectors: Array) -> Eigenpairs:
    order = np.argsort(values)
    vectors = vectors[:, order]
    signs = np.sign(vectors[np.argmax(np.abs(vectors), axis=0), np.arange(len(order))])
    return Eigenpairs(values=values[order], vectors=vectors * signs)


def _floats() -> CheckFailed:
    return CheckFailed(
        "The stiffness resists no motion of at least one part of the structure: it floats freely or a joint of it swings. "
        "Hold it, connect it, or ask for a floating body."
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class Modes:
    """The lowest fixed-base modes of a structure and what the others leave behind.

    Attributes
    ----------
    frequency : (n,) [Hz], ascending
    damping_ratio : (n,) [1]
    participation : (6, n) L about the reference point of mass-normalised modes [kg^0.5, kg^0.5 m]; column r belongs to mode r
    rigid_mass : (6, 6) mass matrix of the whole structure about the reference point (Eq. 1)
    residual : (6, 6) R, static share of the truncated modes [kg s², kg m s², kg m² s²]
    reference_point : (3,) [m], in the article's frame
    shapes : (N, n) mass-normalised, all degrees of freedom, zero where held; (0, n) when they were not asked for
    viscous : (n, n) modal damping matrix C [rad/s], symmetric; its diagonal is 2 zeta omega
    structural : (n, n) modal structural damping S [rad²/s²], symmetric, as in K + i S; zero when there is none
    condensed : what structural damping, which couples kept and truncated modes, makes of squared frequencies, participation
        and residual; None where there is none

    `damping_ratio` repeats the equivalent of both on the diagonal: (C_rr + S_rr / omega_r) / (2 omega_r).
    """

    frequency: Array
    damping_ratio: Array
    participation: Array
    rigid_mass: Array
    residual: Array
    reference_point: Array
    shapes: Array
    viscous: Array
    structural: Array = field(default_factory=lambda: np.zeros((0, 0)))
    condensed: Condensed | None = None

    def __post_init__(self) -> None:
        n = np.size(self.frequency)
        structural = self.structural if np.size(self.structural) else np.zeros((n, n))
        object.__setattr__(self, "structural", structural)
        freeze(self, frequency=(n,), damping_ratio=(n,), participation=(6, n), rigid_mass=(6, 6), residual=(6, 6))
        freeze(self, reference_point=(3,), shapes=(np.shape(self.shapes)[0], n), viscous=(n, n), structural=(n, n))

    @property
    def effective_mass(self) -> Array:
        """Effective mass (n, 6) per mode and axis [kg, kg m²]: the squares of the participation.

        Summed over all modes of a structure they reach the diagonal of `rigid_mass`, less what the base itself carries.
        """
        return np.asarray(self.participation.T**2)


def fixed_base(
    structure: Structure,
    count: int = 30,
    *,
    damping: Damping | None = None,
    factoriser: str | None = None,
    progress: Progress | None = None,
) -> Modes:
    """The lowest `count` modes of `structure` with its base held, or all there are when they are fewer.

    A structure on the ground has the modes that its supports leave it. Of one that floats the first are its rigid motions, at
    zero frequency, and carry the whole rigid mass; there is no residual mass, because no base drives it.

    Parameters
    ----------
    damping : by default the loss factors that the structure's parts bring, else one ratio for all (`fem.damping.default_damping`)
    factoriser : name as in `fem.factorisers`; chosen by itself when None
    progress : hook of the eigenvalue iteration, see `fem.modes.Progress`

    Raises
    ------
    BadInput : `count` below 1, damping that does not fit, matrices whose factors would not fit in memory.
    CheckFailed : part of the structure is not held or swings freely, or a mode was missed.
    """
    if count < 1:
        raise BadInput("modes", "count", f"at least one mode is needed, found {count}", "Ask for 30")
    held = hold(structure)
    check_connected(structure)
    if structure.floating:
        pairs = _floating(structure, held, count, factoriser, progress)
    else:
        pairs = lowest(held.stiffness, held.mass, count, factoriser=factoriser, progress=progress)
        check_stiff(held, structure, pairs.values, pairs.vectors)
    L, n, R = held.load.T @ pairs.vectors, pairs.values.size, np.zeros((6, 6))
    if np.any(held.load) and not structure.floating:
        # R = P^T K^-1 P - L Omega^-2 L^T, from one static solution with the base accelerated
        factor: Factor = pairs.factor or factorise(held.stiffness, definite=True, name=factoriser)
        R = np.asarray(held.load.T @ factor.solve(held.load), dtype=np.float64) - (L / pairs.values) @ L.T
    undamped = Modes(
        frequency=np.sqrt(pairs.values) / (2 * np.pi),
        damping_ratio=np.zeros(n),
        participation=L,
        rigid_mass=structure.rigid_mass,
        residual=(R + R.T) / 2,
        reference_point=structure.reference_point,
        shapes=held.expand(pairs.vectors),
        viscous=np.zeros((n, n)),
    )
    return _with_damping(undamped, structure, damping, held, pairs.factor, factoriser)


def _floating(structure: Structure, held: HeldBase, count: int, factoriser: str | None, progress: Progress | None) -> Eigenpairs:
    """The rigid motions of a structure that nothing holds, at zero, then its lowest elastic modes: `count` together.

    Raises
    ------
    CheckFailed : as `fixed_base`; also without rigid motions that could be told from others.
    """
    K, M = held.stiffness, held.mass
    inertia = structure.rigid_mass
    size = np.sqrt(np.diag(inertia))
    there = np.flatnonzero(size > SEEN * size.max(initial=0.0))
    square, turned = np.linalg.eigh(inertia[np.ix_(there, there)] / np.outer(size[there], size[there]))
    kept = square > SEEN * square.max(initial=0.0)  # points on a line do not turn about it
    rigid = (structure.rigid[:, there] / size[there]) @ turned[:, kept] / np.sqrt(square[kept])
    if not rigid.shape[1]:
        raise CheckFailed("The structure floats, and its rigid motions are not known. Give it coordinates, or hold it.")
    wanted = max(count, rigid.shape[1] + 1)
    pairs = lowest(K, M, wanted, shift=floating_shift(K, M), factoriser=factoriser, progress=progress)
    # The shift is small beside the elastic modes, so that the factors are nearly singular: the digits that this costs come back
    # from Rayleigh quotients in the space of the vectors, of which the rigid motions are taken out
    left = pairs.vectors - rigid @ (rigid.T @ (M @ pairs.vectors))
    share, directions = np.linalg.eigh(left.T @ (M @ left))
    elastic = left @ directions[:, rigid.shape[1] :] / np.sqrt(share[rigid.shape[1] :])
    values, directions = np.linalg.eigh(elastic.T @ (K @ elastic))
    elastic = elastic @ directions
    check_stiff(held, structure, values, elastic)
    together = np.hstack([rigid, elastic])[:, :count]
    return Eigenpairs(values=np.append(np.zeros(rigid.shape[1]), values)[:count], vectors=together)


def with_damping(modes: Modes, structure: Structure, damping: Damping | None = None, *, factoriser: str | None = None) -> Modes:
    """`modes` of `structure`, shapes included, with other damping; what the frequencies cost is not paid again.

    Where the parts' loss factors differ, one static solution with complex stiffness is.

    Raises
    ------
    BadInput : damping that does not fit, matrices whose factors would not fit in memory.
    """
    return _with_damping(modes, structure, damping, hold(structure), None, factoriser)


def _with_damping(
    modes: Modes, structure: Structure, damping: Damping | None, held: HeldBase, factor: Factor | None, factoriser: str | None
) -> Modes:
    damping, omega = damping or default_damping(structure), 2 * np.pi * modes.frequency
    C, S = modal_matrices(damping, structure, omega, modes.shapes)
    whole, together = structural_matrix(damping, structure), None
    if whole is not None and held.free.size and not structure.floating:
        factors = {damping.loss_factors.get(part, 0.0) for part in structure.part_stiffness}
        if len(factors) == 1:  # where all parts have one loss factor, K (1 + i eta) couples nothing
            turn = 1 + 1j * factors.pop()
            together = Condensed(
                stiffness=np.diag(turn * omega**2),
                participation=modes.participation.astype(np.complex128),
                residual=np.asarray(modes.residual / turn),
            )
        else:
            greatest, shapes = max(damping.loss_factors.values()), modes.shapes[held.free]
            together = condensed(held, restricted(whole, held.free), greatest, shapes, factor, factoriser)
    return replace(modes, damping_ratio=equivalent_ratio(C, S, omega), viscous=C, structural=S, condensed=together)


# Craig-Bampton: a structure reduced to the six motions of its base and the modes that it has while the base is held.
#
#     u = T u_b + Phi q      T: rigid motion of the base; Phi: mass-normalised fixed-base modes
#
#         | T^T M T   L |        |  0     0    |
#     M = |   L^T     1 |    K = |  0   Omega² |     L = T^T M Phi
#
# (Craig & Bampton, AIAA Journal 6, 1968.)


@dataclass(frozen=True, eq=False, kw_only=True)
class Reduced:
    """Matrices on the six motions of the base first, then one coordinate for each mode.

    Attributes
    ----------
    stiffness, mass, viscous, structural : (6 + n, 6 + n), symmetric; K + i S is the complex stiffness
    basis : (N, 6 + n) displacement of all degrees of freedom for each coordinate
    """

    stiffness: Array
    mass: Array
    viscous: Array
    structural: Array
    basis: Array

    def __post_init__(self) -> None:
        size = np.shape(self.mass)[0]
        square = (size, size)
        freeze(self, stiffness=square, mass=square, viscous=square, structural=square, basis=(np.shape(self.basis)[0], size))

    def expand(self, coordinates: Array | ComplexArray) -> Array | ComplexArray:
        """Displacement of all degrees of freedom (N, ...) from the reduced coordinates (6 + n, ...)."""
        displacement: Array | ComplexArray = self.basis @ coordinates
        return displacement


def craig_bampton(modes: Modes, rigid: Array) -> Reduced:
    """Reduced matrices on the six motions of the base and `modes`; `rigid` (N, 6) as in `Structure`."""
    n, L = modes.frequency.size, modes.participation
    return Reduced(
        stiffness=_beside(np.zeros((6, 6)), np.diag((2 * np.pi * modes.frequency) ** 2)),
        mass=np.block([[modes.rigid_mass, L], [L.T, np.eye(n)]]),
        viscous=_beside(np.zeros((6, 6)), modes.viscous),
        structural=_beside(np.zeros((6, 6)), modes.structural),
        basis=np.hstack([rigid, modes.shapes]),
    )


def _beside(interface: Array, modes: Array) -> Array:
    from scipy.linalg import block_diag

    return np.asarray(block_diag(interface, modes))


# What truncated modes answer statically, as coordinates of a reduced body (mode acceleration, attachment modes).
#
# The few modes kept would leave the static share of the others out. The static answers to six accelerations of the base, less
# what the kept modes hold of them, are put beside the modes as further shapes: the reduced body then answers as the full one
# does up to the fourth power of the frequency, residual mass included (Craig & Chang, AIAA Journal 15, 1977).

REDUNDANT = 1e-8
"""Share of a static answer that may lie outside the modes already there, below which it is left out."""


def static_shapes(stiffness: Sparse, mass: Sparse, load: Array, shapes: Array) -> Array:
    """Static answers to `load` beside mass-normalised `shapes`: orthonormal in the mass, to one another and to `shapes`.

    Parameters
    ----------
    stiffness, mass : (f, f) sparse, of the free degrees of freedom
    load : (f, k), of unit accelerations of the base
    shapes : (f, n)

    Returns
    -------
    (f, m) : m at most k, fewer where the modes already answer a load in full
    """
    if not len(load):
        return np.zeros((0, 0))
    static = factorise(stiffness, definite=True).solve(load)
    size = np.sqrt(np.einsum("ir,ir->r", static, mass @ static))
    static = static[:, size > 0] / size[size > 0]
    left = static - shapes @ (shapes.T @ (mass @ static))
    left -= shapes @ (shapes.T @ (mass @ left))  # twice is enough, against rounding
    square, directions = np.linalg.eigh(left.T @ (mass @ left))
    kept = square > REDUNDANT**2
    return np.asarray(left @ directions[:, kept] / np.sqrt(square[kept]))
