"""Craig-Bampton: a structure reduced to the six motions of its base and the modes that it has while the base is held.

    u = T u_b + Phi q      T: rigid motion of the base; Phi: mass-normalised fixed-base modes

        | T^T M T   L |        |  0     0    |
    M = |   L^T     1 |    K = |  0   Omega² |     L = T^T M Phi

(Craig & Bampton, AIAA Journal 6, 1968.)
"""

from dataclasses import dataclass

import numpy as np

from fem.factorisers import factorise
from fem.modes import Modes
from fem.structure import Sparse
from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array, freeze


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


def of_modes(modes: Modes, rigid: Array) -> Reduced:
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
