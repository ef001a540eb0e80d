"""K and M of a user as `Structure`: converted to SI, given a base, and checked with everything that mechanics knows of them.

The interface nodes ride on the reference point. Whether the model is a full one or reduced to Craig-Bampton coordinates makes no
difference: a generalised coordinate takes no part in a rigid motion, so its row of `rigid` is zero.

Only what the base moves counts. With the interface held, K must be positive definite (else something is loose) and M too; with it
carried along, M of base and free coordinates together must not be negative, and K must let the rigid motions pass.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from fem.structure import Sparse, Structure
from fem.users_model import definite, stated
from fem.users_model.contents import Contents
from fem.users_model.description import Description
from fem.users_model.dof_map import DofMap, dof_map
from fem.users_model.units import UnitSystem
from geometry.arrays import Array, Integers
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput

OPTIONAL = (
    *("viscous", "structural", "dof", "nodes", "coordinates", "interface"),
    *("rigid", "basic", "held", "points", "translations"),
)

GROUNDED = 1e-5
"""Largest (f_rigid / f_1)²: f_rigid is what K gives the free rigid body, f_1 the lowest frequency with the interface held."""

EXTERNAL = 1e-4
"""Share of a damping matrix's terms that may be left when a rigid motion makes them cancel: single precision, printed digits."""

NEGATIVE_MASS = 1e-6
"""What the base itself carries may be this share of the rigid mass below nothing: rounding."""


def structure(contents: Contents, description: Description) -> tuple[Structure, Sparse | None]:
    """The structure that K, M and the degrees of freedom in `contents` describe, and its viscous matrix C [SI] if there is one.

    Raises
    ------
    BadInput : whatever is wrong with them, with the file, the array, what was found and what to do.
    """
    contents.require(("stiffness", "mass"), OPTIONAL)
    K = contents.matrix("stiffness")
    n = K.shape[0]
    M = _sized(contents, "mass", n)
    dofs = dof_map(contents, description, n)
    scale, u = dofs.scale, description.units
    M = _converted(M, scale, u.energy * u.time**2)
    K = _symmetric(contents, "stiffness", _converted(K, scale, u.energy), dofs, M.diagonal())
    M = _symmetric(contents, "mass", M, dofs, M.diagonal())
    parts, loss_factors = _losses(contents, description, K, M, dofs)
    found = Structure(
        stiffness=K,
        mass=M,
        rigid=dofs.rigid,
        held=dofs.held,
        reference_point=description.reference_point,
        points=dofs.points,
        translations=dofs.translations,
        part_stiffness=parts,
        loss_factors=loss_factors,
    )
    _require_mechanics(found, contents, description, dofs)
    return found, _viscous(contents, M, dofs, u)


def _viscous(contents: Contents, M: Sparse, dofs: DofMap, units: UnitSystem) -> Sparse | None:
    if "viscous" not in contents:
        return None
    C = _sized(contents, "viscous", M.shape[0])
    C = _symmetric(contents, "viscous", _converted(C, dofs.scale, units.energy * units.time), dofs, M.diagonal())
    _require_internal(contents, "viscous", C, dofs)
    return C


def _require_internal(contents: Contents, name: str, A: Sparse, dofs: DofMap) -> None:
    """Damping acts within the structure: a rigid motion meets none, so that only the free part need be known."""
    met, could = np.abs(A @ dofs.rigid).max(axis=0), (abs(A) @ np.abs(dofs.rigid)).max(axis=0)
    share = met / np.maximum(could, np.finfo(np.float64).tiny)
    worst = int(np.argmax(share))
    if share[worst] > EXTERNAL:
        problem = f"damps the rigid motions ({name} @ rigid must be 0), most along {MOTIONS[worst]}"
        remedy = "Write the damping within the structure, without dampers to ground; check the coordinates and the order of rows"
        raise contents.refused(name, problem, remedy)


def _sized(contents: Contents, name: str, n: int) -> Sparse:
    """The matrix `name`, which must be as large as the stiffness."""
    A = contents.matrix(name)
    if A.shape != (n, n):
        problem = f"is {A.shape[0]} x {A.shape[1]} where stiffness is {n} x {n}"
        raise contents.refused(name, problem, "Write both for the same degrees of freedom, in the same order")
    return A


def _converted(A: Sparse, scale: Array, energy: float) -> Sparse:
    """A [user's units] as energy [SI] of coordinates whose unit is `scale` (n,) in SI."""
    from scipy.sparse import csr_array, diags_array

    S = diags_array(1 / scale)
    return csr_array(energy * (S @ A @ S))


def _symmetric(contents: Contents, name: str, A: Sparse, dofs: DofMap, masses: Array) -> Sparse:
    share, i, j = definite.asymmetry(A, masses)
    if share > definite.SYMMETRIC:
        problem = (
            f"is not symmetric: row {i + 1}, column {j + 1} ({dofs.name(i)}; {dofs.name(j)}) holds {A[i, j]:.6g} [SI] and across "
            f"the diagonal {A[j, i]:.6g}, {share:.2g} of the largest entry there"
        )
        remedy = "Write both triangles; gyroscopic or follower terms are not part of a dynamic mass"
        raise contents.refused(name, problem, remedy)
    return definite.symmetrised(A)


def _losses(
    contents: Contents, description: Description, K: Sparse, M: Sparse, dofs: DofMap
) -> tuple[Mapping[str, Sparse], Mapping[str, float]]:
    """Structural damping as shares of K with a loss factor each: the whole, or what the user's matrix says."""
    whole = description.loss_factor
    if "structural" in contents:
        if whole is not None:
            problem = "is given beside a matrix `structural`"
            field = "fe_model.loss_factor"
            raise BadInput(source=description.source, field=field, problem=problem, remedy="Leave one of the two out")
        S = _sized(contents, "structural", dofs.scale.size)
        S = _symmetric(contents, "structural", _converted(S, dofs.scale, description.units.energy), dofs, M.diagonal())
        _require_internal(contents, "structural", S, dofs)
        # i S = i (S / g) g: any g serves, and the largest ratio of the two diagonals keeps the rest of K positive.
        diagonal = K.diagonal()
        g = float((S.diagonal()[diagonal > 0] / diagonal[diagonal > 0]).max(initial=0.0))
        if not 0 < g < 2:
            problem = f"is {g:.3g} of the stiffness at most, no loss factor between 0 and 2"
            raise contents.refused("structural", problem, "Give the matrix that multiplies i, in the unit of K")
        return MappingProxyType({"damped": S / g, "rest": K - S / g}), MappingProxyType({"damped": g})
    if whole:
        return MappingProxyType({"all": K}), MappingProxyType({"all": whole})
    return MappingProxyType({}), MappingProxyType({})


# --- mechanics --------------------------------------------------------------------------------------------------------------


def _require_mechanics(found: Structure, contents: Contents, description: Description, dofs: DofMap) -> None:
    free = found.free
    K, M = (A[free][:, free] for A in (found.stiffness, found.mass))
    heavy = _heavy(contents, M, free, dofs)
    mass = _factored(contents, "mass", M[heavy][:, heavy], free[heavy], dofs)
    _require_mass_of_base(found, free[heavy], mass, contents)
    stiffness = _factored(contents, "stiffness", K, free, dofs)
    _require_not_grounded(found, free, K, M, stiffness, contents)
    remedy = "Check the order of the degrees of freedom, the coordinates and the units; every mass moves in three directions"
    stated.require_as_stated(stated.require_rigid_body(found.rigid_mass, contents.source, "mass", remedy), description)


def _heavy(contents: Contents, M: Sparse, free: Integers, dofs: DofMap) -> Integers:
    """Those of the free degrees of freedom that have mass; lumped masses leave rotations without, in rows that are empty."""
    without = M.diagonal() == 0
    coupled = np.flatnonzero(without & (abs(M).sum(axis=1) > 0))
    if coupled.size:
        problem = f"is indefinite: {dofs.name(free[coupled[0]])} has no mass of its own but is coupled to others"
        raise contents.refused("mass", problem, "Write the whole consistent mass matrix, or a lumped one without couplings")
    if np.all(without):
        raise contents.refused("mass", "gives no free degree of freedom any mass", "Check that this is M, and the interface")
    return np.flatnonzero(~without)


def _factored(contents: Contents, name: str, A: Sparse, free: Integers, dofs: DofMap) -> definite.Factored:
    """A of the free degrees of freedom, factored, when it is positive definite."""
    diagonal = A.diagonal()
    empty = np.flatnonzero(diagonal <= 0)
    if empty.size:
        worst = empty[np.argmin(diagonal[empty])]
        what = f"{empty.size} degree(s) of freedom without {name}" if diagonal[worst] == 0 else f"a negative {name}"
        problem = (
            f"is not positive definite: {what}, such as {dofs.name(free[worst])}, {diagonal[worst]:.6g} [SI] on the diagonal"
        )
        raise contents.refused(name, problem, _REMEDIES[name])
    factor = definite.factored(A)
    if factor.negative:
        problem = f"is not positive definite with the interface held: it has {factor.negative} negative eigenvalue(s)"
        raise contents.refused(name, problem, _REMEDIES[name])
    if factor.zero.size:
        where = dofs.name(free[factor.zero[-1]])
        what = f"{factor.zero.size} motion(s) of the structure cost no energy" if name == "stiffness" else "it is singular"
        problem = f"is not positive definite with the interface held: {what}, one of them moves {where}"
        raise contents.refused(name, problem, _REMEDIES[name])
    return factor


_REMEDIES = {
    "mass": "Check how M was made; a motion that has no mass must have an empty row",
    "stiffness": "Look for parts that hang loose and for an interface that leaves a mechanism, and name all its nodes; "
    "write K unreduced by loads or pre-stress beyond buckling",
}


def _require_mass_of_base(found: Structure, free: Integers, mass: definite.Factored, contents: Contents) -> None:
    """The mass that the base would feel at infinite frequency, M_rr - M_rf M_ff^-1 M_fr, must not be negative."""
    inertia = np.diag(found.rigid_mass)
    if np.any(inertia <= 0):
        problem = f"is indefinite: the whole has the inertia {inertia.min():.6g} [SI] along {MOTIONS[int(np.argmin(inertia))]}"
        raise contents.refused("mass", problem, "Check the rows and columns of the interface in M, and the coordinates")
    coupling = np.asarray((found.mass @ found.rigid)[free])
    left = found.rigid_mass - coupling.T @ mass.solve(coupling)
    scale = 1 / np.sqrt(inertia)
    values, vectors = np.linalg.eigh(scale[:, None] * left * scale)
    if values[0] < -NEGATIVE_MASS:
        axis = MOTIONS[int(np.argmax(np.abs(vectors[:, 0])))]
        problem = f"is indefinite: what the interface itself carries is {values[0]:.3g} of the rigid inertia, mostly along {axis}"
        raise contents.refused("mass", problem, "Check the rows and columns of the interface in M")


def _require_not_grounded(
    found: Structure, free: Integers, K: Sparse, M: Sparse, factor: definite.Factored, contents: Contents
) -> None:
    """The six rigid motions must cost no energy, beside what the lowest mode costs (from above: the static answer to gravity)."""
    sag = factor.solve(np.asarray((found.mass @ found.rigid)[free]))
    lowest = np.min(np.sum(sag * (K @ sag), axis=0) / np.sum(sag * (M @ sag), axis=0))
    energy = found.rigid.T @ (found.stiffness @ found.rigid)
    scale = 1 / np.sqrt(np.diag(found.rigid_mass))
    values, vectors = np.linalg.eigh(scale[:, None] * energy * scale)
    worst = int(np.argmax(np.abs(values)))
    if abs(values[worst]) > GROUNDED * lowest:
        axis = MOTIONS[int(np.argmax(np.abs(vectors[:, worst])))]
        problem = (
            f"resists the rigid motions (K @ rigid must be 0), most along {axis}: the free body would oscillate at "
            f"{np.sqrt(abs(values[worst])) / (2 * np.pi):.4g} Hz"
        )
        remedy = (
            "Write K without supports or springs to ground; otherwise the coordinates, their unit, the order of the degrees of "
            "freedom or the displacement coordinate systems do not belong to it"
        )
        raise contents.refused("stiffness", problem, remedy)
