"""`Modes`: eigenfrequencies, shapes and participation of a structure whose base is held - what the dynamic mass is made of.

With base motion u_b and the displacements relative to it expanded in mass-normalised fixed-base modes, the modal equations
are q'' + 2 zeta omega q' + omega² q = -L^T u_b''. L is the participation about the reference point and L L^T of one mode its
effective mass. Of the modes that are not kept, the static share of their answer is: the residual mass R = sum of L L^T / omega²
over them, which follows from one static solution with the base accelerated, without any of them being computed (Craig, Structural
Dynamics).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fem import damping as damped
from fem.condensed import Condensed, condensed
from fem.damping import Damping
from fem.eigen import Eigenpairs, Progress, lowest
from fem.factorisers import Factor, factorise
from fem.held_base import HeldBase, check_connected, check_stiff, hold, restricted
from fem.structure import Structure
from geometry.arrays import Array, frozen
from geometry.errors import BadInput


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
    condensed : what structural damping makes of squared frequencies, participation and residual when it couples kept and truncated
        modes; None where it does not

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
        shapes = {
            "frequency": (n,),
            "damping_ratio": (n,),
            "participation": (6, n),
            "rigid_mass": (6, 6),
            "residual": (6, 6),
            "reference_point": (3,),
            "shapes": (np.shape(self.shapes)[0], n),
            "viscous": (n, n),
            "structural": (n, n),
        }
        for name, shape in shapes.items():
            object.__setattr__(self, name, frozen(getattr(self, name), shape, name))

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

    Parameters
    ----------
    damping : by default the loss factors that the structure's parts bring, else one ratio for all (`fem.damping.default`)
    factoriser : name as in `fem.factorisers`; chosen by itself when None
    progress : hook of the eigenvalue iteration, see `fem.eigen.Progress`

    Raises
    ------
    BadInput : `count` below 1, damping that does not fit, matrices whose factors would not fit in memory.
    CheckFailed : part of the structure is not held or swings freely, or a mode was missed.
    """
    if count < 1:
        raise BadInput(source="modes", field="count", problem=f"at least one mode is needed, found {count}", remedy="Ask for 30")
    held = hold(structure)
    check_connected(structure)
    pairs = lowest(held.stiffness, held.mass, count, factoriser=factoriser, progress=progress)
    check_stiff(held, structure, pairs.values, pairs.vectors)
    L = held.load.T @ pairs.vectors
    omega, shapes = np.sqrt(pairs.values), held.expand(pairs.vectors)
    damping = damping or damped.default(structure)
    C, S = damped.modal_matrices(damping, structure, omega, shapes)
    return Modes(
        frequency=omega / (2 * np.pi),
        damping_ratio=damped.equivalent_ratio(C, S, omega),
        participation=L,
        rigid_mass=structure.rigid_mass,
        residual=_residual(held, pairs, L, factoriser),
        reference_point=structure.reference_point,
        shapes=shapes,
        viscous=C,
        structural=S,
        condensed=_condensed(held, structure, damping, pairs),
    )


def _condensed(held: HeldBase, structure: Structure, damping: Damping, pairs: Eigenpairs) -> Condensed | None:
    S = damped.structural_matrix(damping, structure)
    if S is None or not held.free.size:
        return None
    return condensed(held, restricted(S, held.free), max(damping.loss_factors.values()), pairs.vectors, pairs.factor)


def _residual(held: HeldBase, pairs: Eigenpairs, L: Array, factoriser: str | None) -> Array:
    """R = P^T K^-1 P - L Omega^-2 L^T, from one static solution with the base accelerated."""
    if not held.free.size:
        return np.zeros((6, 6))
    factor: Factor = pairs.factor or factorise(held.stiffness, definite=True, name=factoriser)
    R = held.load.T @ factor.solve(held.load) - (L / pairs.values) @ L.T
    return np.asarray((R + R.T) / 2)
