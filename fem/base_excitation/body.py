"""`Body` from a structure and its modes, from modal data alone, or rigid: what stands on a base that moves in time.

A structure's kept modes are joined by up to six static answers to accelerations of the base (`fem.static_answer`), so the
truncated modes need no term of their own: the body answers as the full structure does up to the fourth power of the frequency.
Modes without shapes bring their residual mass R instead; up to six further modes then carry just that R.

A response in time knows no i in K + i S. Structural damping becomes viscous, C_rs += S_rs / sqrt(omega_r omega_s): right at
resonance and within a cluster, and of the order of the loss factor wrong in phase between resonances. Where a lossy part makes
the truncated modes give way, the real part of the condensed stiffness is kept (`fem.condensed`). Against the direct solution with
K + i S, the greatest difference of Clumod's dynamic mass at any line from 4 to 32 Hz is 0.5 % (one blade) and 0.9 % (four, one
with a silicone layer; 1.9 % without the condensation) of the largest entry there. The static coordinates lose as much as the
kept modes do on average: they follow the base quietly, and must only not ring on.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from fem.base_excitation.rig import Body
from fem.held_base import hold
from fem.modes import Modes
from fem.reduction import Reduced, of_modes
from fem.static_answer import static_shapes
from fem.structure import Structure
from geometry.arrays import Array
from geometry.consistency import require_physical
from geometry.errors import BadInput
from geometry.frames import rigid_transformation, rigid_transformation_6
from geometry.inertia import Inertia

Places = Mapping[str, npt.ArrayLike]
"""(3,) [m] by name, in the article's frame."""

NOWHERE: Places = MappingProxyType({})

NEAR = 0.05
"""How far a place may lie from a point whose motion is known, as a share of the size of the structure."""

LEAVES = 0.8
"""Greatest share of the mass beside the kept modes that the carriers of R may take, in any direction: what stays with the base
keeps the mass matrix positive definite."""

FAR = 4.0
"""Times the highest kept frequency at which the carriers of R lie, where their mass allows it."""

NOTHING = 1e-12
"""Share of the mass that R may make up at the highest kept frequency and still be rounding."""

EXCESS = 1e-6
"""Share of the mass by which modes of printed digits may take more than there is."""


def flexible(name: str, structure: Structure, modes: Modes, *, places: Places = NOWHERE) -> Body:
    """`structure` on its base, reduced to its `modes`, shapes included, and to what the others answer statically.

    A place moves with the base as a rigid body's point does, and beyond that as the nearest of the structure's points.

    Raises
    ------
    BadInput : modes without shapes or of another structure, a place with no point near it, factors that do not fit in memory.
    """
    _require_shapes(name, structure, modes)
    held = hold(structure)
    X = static_shapes(held.stiffness, held.mass, held.load, modes.shapes[held.free])
    squares, V = np.linalg.eigh(X.T @ (held.stiffness @ X))
    X = X @ V
    reduced = _reduced(modes, np.sqrt(squares), held.load.T @ X, structure.rigid, held.expand(X))
    rows = {place: _place(name, place, at, structure, reduced) for place, at in places.items()}
    return Body(name=name, reduced=reduced, kept=modes.frequency, places=rows)


def of_modal_data(name: str, modes: Modes) -> Body:
    """A body of which only frequencies, damping, participation and the rigid 6x6 are known; R is carried by further modes.

    Their frequencies are `FAR` above the kept ones, or as high as the mass beside the kept modes allows.

    Raises
    ------
    BadInput : modes that take more mass than there is, in some direction.
    """
    omega, L = _carriers(name, modes)
    bare = replace(modes, shapes=np.zeros((0, modes.frequency.size)))
    return Body(name=name, reduced=_reduced(bare, omega, L, np.zeros((0, 6)), np.zeros((0, omega.size))), kept=modes.frequency)


def rigid(name: str, inertia: Inertia, places: Places = NOWHERE) -> Body:
    """A rigid body with its base at the article's origin.

    Raises
    ------
    BadInput : an inertia that no body has.
    """
    M = require_physical(inertia, f"body {name}").about(np.zeros(3)).mass_matrix
    nothing = np.zeros((6, 6))
    reduced = Reduced(stiffness=nothing, mass=M, viscous=nothing, structural=nothing, interface=6, basis=np.eye(6))
    rows = {place: rigid_transformation(at) for place, at in places.items()}
    return Body(name=name, reduced=reduced, kept=np.zeros(0), places=rows)


def viscous(modes: Modes) -> tuple[Array, Array]:
    """Stiffness [rad²/s²] and viscous damping [rad/s] (n, n) of `modes` for a response in time."""
    omega = 2 * np.pi * modes.frequency
    A = np.diag(omega**2) + 1j * modes.structural if modes.condensed is None else modes.condensed.stiffness
    return np.asarray(A.real), np.asarray(modes.viscous + A.imag / np.sqrt(np.outer(omega, omega)))


def _reduced(modes: Modes, omega: Array, L: Array, rigid_motion: Array, shapes: Array) -> Reduced:
    """`modes` and m carriers of the rest beside them; omega (m,) [rad/s], L (6, m), shapes (N, m); about the article's origin."""
    from scipy.linalg import block_diag

    K, C = viscous(modes)
    ratio = modes.damping_ratio.mean() if modes.damping_ratio.size else 0.0
    n = len(K) + len(omega)
    extended = Modes(
        frequency=np.append(modes.frequency, omega / (2 * np.pi)),
        damping_ratio=np.append(modes.damping_ratio, np.full(len(omega), ratio)),
        participation=np.hstack([modes.participation, L]),
        rigid_mass=modes.rigid_mass,
        residual=np.zeros((6, 6)),
        reference_point=modes.reference_point,
        shapes=np.hstack([modes.shapes, shapes]),
        viscous=np.asarray(block_diag(C, np.diag(2 * ratio * omega))).reshape(n, n),
    )
    made = of_modes(extended, rigid_motion)
    stiffness = np.array(made.stiffness)
    stiffness[6 : 6 + len(K), 6 : 6 + len(K)] = K
    return _about_origin(replace(made, stiffness=stiffness), modes.reference_point)


def _about_origin(reduced: Reduced, point: Array) -> Reduced:
    """The base's motions counted at the article's origin instead of at `point`."""
    T = np.eye(len(reduced.mass))
    T[:6, :6] = rigid_transformation_6(point)
    return replace(reduced, mass=T.T @ reduced.mass @ T, basis=reduced.basis @ T)


def _carriers(name: str, modes: Modes) -> tuple[Array, Array]:
    """Frequencies (m,) [rad/s] and participation (6, m) of modes with sum of L L^T / omega² = R, within the mass that is left.

    With R V = M V diag(mu), V^T M V = 1, M the mass beside the kept modes, mode s is L_s = omega_s sqrt(mu_s) M v_s, which takes
    the share omega_s² mu_s of the mass in its direction. Where mu is negative, as extrapolation from mesh to mesh can leave it, R
    is less than it is known to, and left out.
    """
    from scipy.linalg import eigh

    M = modes.rigid_mass - modes.participation @ modes.participation.T
    _require_mass(name, M, modes.rigid_mass)
    M = M + EXCESS * modes.rigid_mass
    mu, V = eigh(modes.residual, M)
    highest = 2 * np.pi * modes.frequency.max(initial=0.0)
    kept = mu * highest**2 > NOTHING if highest else mu > 0
    mu, V = mu[kept], V[:, kept]
    omega = np.sqrt(LEAVES / mu)
    if highest:
        omega = np.minimum(omega, FAR * highest)
    return omega, (M @ V) * (omega * np.sqrt(mu))


def _require_mass(name: str, left: Array, whole: Array) -> None:
    from scipy.linalg import eigh

    share = float(eigh(left, whole, eigvals_only=True)[0])
    if share < -EXCESS:
        raise BadInput(
            source=f"body {name}",
            field="participation",
            problem=f"its modes must not move more mass than the body has, found {-share:.3g} of it too much in some direction",
            remedy="Check the units of the participation, and that it and the rigid mass have one reference point",
        )


def _require_shapes(name: str, structure: Structure, modes: Modes) -> None:
    if len(modes.shapes) != structure.mass.shape[0]:
        raise BadInput(
            source=f"body {name}",
            field="modes",
            problem=f"shapes on all {structure.mass.shape[0]} degrees of freedom of the structure are needed, found "
            f"{len(modes.shapes)}",
            remedy="Bring the modes of this structure, or use modal data alone",
        )


def _place(name: str, place: str, at: npt.ArrayLike, structure: Structure, reduced: Reduced) -> Array:
    """(3, 6 + n) what each coordinate does to `place`, (3,) [m] in the article's frame."""
    point = np.asarray(at, dtype=np.float64)
    distance = np.linalg.norm(structure.points - point, axis=1)
    size = float(np.linalg.norm(np.ptp(structure.points, axis=0))) if len(distance) else 0.0
    if distance.min(initial=np.inf) > NEAR * size:
        found = f"the nearest is {1e3 * distance.min():.1f} mm away" if len(distance) else "it has none"
        raise BadInput(
            source=f"body {name}",
            field=f"places.{place}",
            problem=f"a point whose motion is known must lie within {1e3 * NEAR * size:.1f} mm, and {found}",
            remedy="Give a place on the structure, in the article's frame in metres",
        )
    shapes = reduced.basis[structure.translations[int(np.argmin(distance))], 6:]
    return np.hstack([rigid_transformation(point), shapes])
