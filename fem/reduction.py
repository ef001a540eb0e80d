"""Craig-Bampton: a structure reduced to its interface and the modes that it has while the interface is held.

    u = Psi u_b + Phi q      Psi: static answer to the interface; Phi: mass-normalised fixed-interface modes

        | Psi^T M Psi   L |        | Psi^T K Psi    0    |
    M = |      L^T      1 |    K = |      0      Omega²  |     L = Psi^T M Phi

(Craig & Bampton, AIAA Journal 6, 1968.) With a rigid interface Psi is the rigid motion of the base, its stiffness is zero and the
mass is the rigid 6x6; with one of k degrees of freedom it is -K_ii^-1 K_ib, and the reduced matrices are again a `Structure`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from fem.damping import Damping
from fem.factorisers import factorise
from fem.modes import Modes, fixed_base, lowest
from fem.structure import Sparse, Structure, restricted
from geometry.dynamic_mass import ComplexArray, DynamicMass
from geometry.errors import BadInput
from geometry.frames import Array, Integers, frozen


@dataclass(frozen=True, eq=False, kw_only=True)
class Reduced:
    """Matrices on `interface` coordinates first, then one coordinate for each mode.

    Attributes
    ----------
    stiffness, mass, viscous, structural : (k + n, k + n), symmetric; K + i S is the complex stiffness
    interface : k, number of interface coordinates
    basis : (N, k + n) displacement of all degrees of freedom for each coordinate
    """

    stiffness: Array
    mass: Array
    viscous: Array
    structural: Array
    interface: int
    basis: Array

    def __post_init__(self) -> None:
        size = np.shape(self.mass)[0]
        for name in ("stiffness", "mass", "viscous", "structural"):
            object.__setattr__(self, name, frozen(getattr(self, name), (size, size), name))
        object.__setattr__(self, "basis", frozen(self.basis, (np.shape(self.basis)[0], size), "basis"))

    def expand(self, coordinates: Array | ComplexArray) -> Array | ComplexArray:
        """Displacement of all degrees of freedom (N, ...) from the reduced coordinates (k + n, ...)."""
        displacement: Array | ComplexArray = self.basis @ coordinates
        return displacement


def craig_bampton(
    structure: Structure, count: int = 30, *, damping: Damping | None = None, factoriser: str | None = None
) -> Reduced:
    """`structure` on the six motions of its base and its `count` lowest fixed-base modes.

    Raises
    ------
    BadInput, CheckFailed : as `fem.modes.fixed_base`.
    """
    return of_modes(fixed_base(structure, count, damping=damping, factoriser=factoriser), structure.rigid)


def of_modes(modes: Modes, rigid: Array) -> Reduced:
    """Reduced matrices on the six motions of the base and `modes`; `rigid` (N, 6) as in `Structure`."""
    n, L = modes.frequency.size, modes.participation
    return Reduced(
        stiffness=_beside(np.zeros((6, 6)), np.diag((2 * np.pi * modes.frequency) ** 2)),
        mass=np.block([[modes.rigid_mass, L], [L.T, np.eye(n)]]),
        viscous=_beside(np.zeros((6, 6)), modes.viscous),
        structural=_beside(np.zeros((6, 6)), modes.structural),
        interface=6,
        basis=np.hstack([rigid, modes.shapes]),
    )


def general(
    stiffness: Sparse, mass: Sparse, interface: Integers, count: int, *, viscous: Sparse = None, factoriser: str | None = None
) -> Reduced:
    """Any structure on its `interface` degrees of freedom and `count` modes with all of them held.

    Parameters
    ----------
    stiffness, mass, viscous : (N, N) sparse, symmetric
    interface : (k,) degrees of freedom, in the order of the reduced coordinates

    Raises
    ------
    BadInput : an interface that is empty, repeats itself or points outside the matrices.
    CheckFailed : something of the structure stays loose while the interface is held.
    """
    size = mass.shape[0]
    named = np.asarray(interface)
    wrong = "" if named.size else "it is empty"
    if len(set(named)) < named.size:
        wrong = "it names a degree of freedom twice"
    if named.size and (named.min() < 0 or named.max() >= size):
        wrong = f"it names {named.min()} to {named.max()}, and the matrices have {size} rows"
    if wrong:
        remedy = "Name every interface degree of freedom once, from 0"
        raise BadInput(source="reduction", field="interface", problem=wrong, remedy=remedy)
    inner = np.setdiff1d(np.arange(size), interface)
    K = restricted(stiffness, inner)
    pairs = lowest(K, restricted(mass, inner), count, factoriser=factoriser)
    k, n = len(interface), pairs.values.size
    basis = np.zeros((size, k + n))
    basis[interface, np.arange(k)] = 1.0
    if inner.size:
        factor = pairs.factor or factorise(K, definite=True, name=factoriser)
        basis[inner, :k] = -factor.solve((stiffness.tocsr()[inner][:, interface]).toarray())
        basis[np.ix_(inner, np.arange(k, k + n))] = pairs.vectors
    return Reduced(
        stiffness=_congruent(stiffness, basis, k),
        mass=_congruent(mass, basis),
        viscous=np.zeros((k + n, k + n)) if viscous is None else _congruent(viscous, basis),
        structural=np.zeros((k + n, k + n)),
        interface=k,
        basis=basis,
    )


def as_structure(reduced: Reduced, motion: npt.ArrayLike, reference_point: npt.ArrayLike = (0.0, 0.0, 0.0)) -> Structure:
    """The reduced matrices on a rigid base that carries all interface coordinates along.

    Parameters
    ----------
    motion : (k, 6) what the interface coordinates do in the six unit motions of the reference point
    reference_point : (3,) [m]
    """
    from scipy.sparse import csr_array

    modes = reduced.mass.shape[0] - reduced.interface
    return Structure(
        stiffness=csr_array(reduced.stiffness),
        mass=csr_array(reduced.mass),
        rigid=np.vstack([motion, np.zeros((modes, 6))]),
        held=np.arange(reduced.interface),
        reference_point=np.asarray(reference_point, dtype=np.float64),
    )


def dynamic_mass(reduced: Reduced, frequency: npt.ArrayLike, reference_point: npt.ArrayLike = (0.0, 0.0, 0.0)) -> DynamicMass:
    """Dynamic mass of matrices whose interface is a rigid base, at `frequency` (n,) [Hz]: the modal coordinates condensed.

    Raises
    ------
    ValueError : the interface has not six coordinates.
    """
    if reduced.interface != 6:
        raise ValueError(f"`reduced` must have the six motions of a base as its interface, found {reduced.interface} coordinates")
    lines = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    H = np.empty((len(lines), 6, 6), dtype=np.complex128)
    for line, omega in enumerate(2 * np.pi * lines):
        Z = reduced.stiffness + 1j * (omega * reduced.viscous + reduced.structural) - omega**2 * reduced.mass
        q = np.linalg.solve(Z[6:, 6:], omega**2 * reduced.mass[6:, :6])  # for a unit displacement of the base
        H[line] = reduced.mass[:6, :6] + reduced.mass[:6, 6:] @ q
    return DynamicMass(frequency=lines, matrix=H, reference_point=np.asarray(reference_point, dtype=np.float64))


def _beside(interface: Array, modes: Array) -> Array:
    from scipy.linalg import block_diag

    return np.asarray(block_diag(interface, modes))


def _congruent(matrix: Sparse, basis: Array, interface: int | None = None) -> Array:
    """basis^T matrix basis; the stiffness between `interface` and modes, zero but for rounding, is set to zero."""
    small = np.asarray(basis.T @ (matrix @ basis))
    if interface is not None:
        small[:interface, interface:] = small[interface:, :interface] = 0.0
    return np.asarray((small + small.T) / 2)


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
