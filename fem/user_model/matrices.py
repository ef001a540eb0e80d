"""What a user's arrays describe: K and M as `Structure`, modal data as `Modes`, in SI, checked with all that mechanics knows.

The interface nodes ride on the reference point. Whether the model is a full one or reduced to Craig-Bampton coordinates makes no
difference: a generalised coordinate takes no part in a rigid motion, so its row of `rigid` is zero.

Only what the base moves counts. With the interface held, K must be positive definite (else something is loose) and M too; with it
carried along, M of base and free coordinates together must not be negative, and K must let the rigid motions pass. On the ground
K must be positive definite as it is; of a free structure, once as many rows are held as there are rigid motions.
"""

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from fem.modes import Modes
from fem.structure import Sparse, Structure
from fem.user_model.description import TABLE, Contents, Description, require_as_stated, require_rigid_body, require_stated_mass
from fem.user_model.freedoms import DofMap, dof_map, with_places
from fem.user_model.parts import require_name
from geometry import toml_file
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.frames import Array, Integers

# Are matrices symmetric and positive definite? By the signs of the pivots of L D L^T, which are those of the eigenvalues.
#
# Sylvester's law of inertia: a symmetric matrix has as many negative eigenvalues as L D L^T has negative pivots. SuperLU keeps
# the pivots on the diagonal when it is told that the matrix is symmetric; the matrix is scaled to a diagonal of ones first, so
# that what counts as zero does not depend on units.

SYMMETRIC = 1e-6
"""Two entries across the diagonal may differ by this share of the largest in their rows: single precision and printed digits."""

ROUNDING = 1e-9
"""Rows count as this share of the stiffest one at least: `SYMMETRIC` times it is the rounding that a reduction leaves."""

SINGULAR = 1e-12
"""A pivot, of a matrix scaled to a diagonal of ones, that is rounding: a motion that costs no energy."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Factored:
    """A symmetric matrix A = S^-1 B S^-1 with B factored.

    Attributes
    ----------
    solve : gives A^-1 b for b (n, k)
    negative : number of negative eigenvalues
    zero : indices where the scaled pivot vanishes, first in the order of elimination; empty when regular
    """

    solve: Callable[[Array], Array]
    negative: int
    zero: Integers


def asymmetry(A: Sparse, masses: Array) -> tuple[float, int, int]:
    """Largest difference across the diagonal relative to the largest entries of its two rows, and its row and column.

    Where a reduction leaves nothing but rounding, as in the interface rows of a Craig-Bampton stiffness, rows count as `ROUNDING`
    of the stiffest one; divided by `masses` (n,), the diagonal of M, rows of translations, rotations and modes are comparable.
    """
    from scipy.sparse import coo_array

    rows = np.sqrt(np.maximum(abs(A).max(axis=1).toarray().ravel(), abs(A).max(axis=0).toarray().ravel()))
    heavy = masses > SINGULAR * masses.max()
    stiffest = np.max(rows[heavy] ** 2 / masses[heavy], initial=0.0)
    rows[heavy] = np.maximum(rows[heavy], np.sqrt(ROUNDING * masses[heavy] * stiffest))
    D = coo_array(A - A.T)
    if not D.nnz:
        return 0.0, 0, 0
    i, j = D.coords
    share = np.abs(D.data) / np.maximum(rows[i] * rows[j], np.finfo(np.float64).tiny)  # entries may be as small as that
    worst = int(np.argmax(share))
    return float(share[worst]), int(i[worst]), int(j[worst])


OPTIONAL = (
    *("viscous", "structural", "dof", "nodes", "coordinates", "interface"),
    *("rigid", "basic", "held", "points", "translations", "rotations", "measured_dof", "places"),
    *("membrane", "bending", "geometric"),
)

ADDS_UP = 1e-6
"""The parts may be off the whole by this share of the largest entries in its rows: single precision and printed digits."""

GROUNDED = 1e-5
"""Largest (f_rigid / f_1)²: f_rigid is what K gives the free rigid body, f_1 the lowest frequency with the interface held."""

EXTERNAL = 1e-4
"""Share of a damping matrix's terms that may be left when a rigid motion makes them cancel: single precision, printed digits."""

HELD = 1e-9
"""A rigid motion that moves every row by less than this share of the largest is none: a model of one plane has three."""

CLAMPED = 0.5
"""Share of the stated mass that a grounded structure weighs at least: the rest may lie on what the ground holds."""

NEGATIVE_MASS = 1e-6
"""What the base itself carries may be this share of the rigid mass below nothing: rounding."""


def structure(contents: Contents, description: Description) -> tuple[Structure, Sparse | None, list[str]]:
    """The structure that K, M and the degrees of freedom in `contents` describe, with what is named in the description.

    Returns
    -------
    structure, its viscous matrix C [SI] if there is one, and what must be known of it, in sentences

    Raises
    ------
    BadInput : whatever is wrong with them, with the file, the array, what was found and what to do.
    """
    contents.require(("stiffness", "mass"), OPTIONAL)
    whole_K, parts = _whole_and_parts(contents, "stiffness", None)
    n = whole_K.shape[0]
    whole_M, masses = _whole_and_parts(contents, "mass", n)
    dofs = dof_map(contents, description, n)
    scale, u = dofs.scale, description.units
    M = _converted(whole_M, scale, u.energy * u.time**2)
    K = _symmetric(contents, "stiffness", _converted(whole_K, scale, u.energy), dofs, M.diagonal())
    M = _symmetric(contents, "mass", M, dofs, M.diagonal())

    def own(name: str, A: Sparse, energy: float = u.energy) -> Sparse:
        """A share `A` [user's units] of the matrix `name` in SI."""
        return _symmetric(contents, name, _converted(A, scale, energy), dofs, M.diagonal())

    parts = {name: own(f"stiffness/{name}", share) for name, share in parts.items()}
    masses = {name: own(f"mass/{name}", share, u.energy * u.time**2) for name, share in masses.items()}
    if parts:
        K = _require_sum(contents, "stiffness", K, parts, dofs)
    if masses:
        M = _require_sum(contents, "mass", M, masses, dofs)
    for kind in ("membrane", "bending", "geometric"):
        for part in contents.shares(kind):
            if part not in parts:
                remedy = toml_file.nearest(part, parts) + f"Write stiffness/{part}"
                raise contents.refused(f"{kind}/{part}", "is of a part that is not there", remedy)
    # Of shells and beams, what grows with the thickness and with its cube: together the part
    sections = {}
    for part in dict.fromkeys((*contents.shares("membrane"), *contents.shares("bending"))):
        two = {name: own(name, _sized(contents, name, n)) for name in (f"membrane/{part}", f"bending/{part}")}
        _require_sum(contents, f"stiffness/{part}", parts[part], two, dofs)
        sections[part] = (two[f"membrane/{part}"], two[f"bending/{part}"])
    weighed = {part: own(f"geometric/{part}", _sized(contents, f"geometric/{part}", n)) for part in contents.shares("geometric")}
    _require_parts(description, parts, masses, sections)
    found = Structure(
        stiffness=K,
        mass=M,
        rigid=dofs.rigid,
        held=dofs.held,
        reference_point=description.reference_point,
        points=dofs.points,
        translations=dofs.translations,
        rotations=dofs.rotations,
        part_stiffness=MappingProxyType(parts),
        part_mass=MappingProxyType(masses),
        sections=MappingProxyType(sections),
        geometric=MappingProxyType(weighed),
        grounded=description.named.support == "ground",
        part_tolerances=MappingProxyType(
            {name: part.tolerance for name, part in description.named.parts.items() if part.tolerance}
        ),
    )
    found, said = with_places(found, dofs, contents, description)
    found = _lossy(found, contents, description, dofs)
    _require_mechanics(found, contents, description, dofs)
    if not description.units.known:
        said.append("The units of the matrices are not known: masses, lengths and stiffnesses are in the model's own.")
    if "viscous" not in contents:
        return found, None, said
    C = _sized(contents, "viscous", n)
    C = _symmetric(contents, "viscous", _converted(C, dofs.scale, u.energy * u.time), dofs, M.diagonal())
    _require_internal(contents, "viscous", C, found)
    return found, C, said


def _whole_and_parts(contents: Contents, name: str, n: int | None) -> tuple[Sparse, dict[str, Sparse]]:
    """The matrix `name`, the sum of its parts where it is not there itself, and its parts; in the user's units."""
    parts = {}
    for part in contents.shares(name):
        require_name(part, contents.source, name)
        parts[part] = _sized(contents, f"{name}/{part}", n)
        n = parts[part].shape[0]
    whole = _sized(contents, name, n) if name in contents else None
    return (sum(list(parts.values())[1:], next(iter(parts.values()))) if whole is None else whole), parts


def _require_sum(contents: Contents, name: str, whole: Sparse, parts: dict[str, Sparse], dofs: DofMap) -> Sparse:
    """The sum of `parts`, which must be `whole`."""
    total = sum(list(parts.values())[1:], next(iter(parts.values())))
    rows = np.sqrt(np.maximum(abs(whole).max(axis=1).toarray().ravel(), abs(total).max(axis=1).toarray().ravel()))
    off = (whole - total).tocoo()
    share = np.abs(off.data) / np.maximum(rows[off.row] * rows[off.col], np.finfo(np.float64).tiny)
    if np.any(share > ADDS_UP):
        k = int(np.argmax(share))
        i, j = int(off.row[k]), int(off.col[k])
        there = f"{dofs.name(i)}" + (f"; {dofs.name(j)}" if i != j else "")
        problem = (
            f"is not what its {len(parts)} parts add up to: row {i + 1}, column {j + 1} ({there}) holds {whole[i, j]:.6g} [SI], "
            f"the parts make {total[i, j]:.6g}, {share[k]:.2g} of the largest in its rows apart; "
            f"{int(np.sum(share > ADDS_UP))} entries are off"
        )
        missing = np.abs(total.sum()) < np.abs(whole.sum())
        remedy = f"Look for a part that is {'missing' if missing else 'there twice'}, or leave `{name}` out: it is their sum"
        raise contents.refused(name, problem, remedy)
    return total


def _require_parts(
    description: Description, parts: dict[str, Sparse], masses: dict[str, Sparse], sections: Collection[str]
) -> None:
    """Refuse parts of the description that the matrices have not, and what these say themselves."""
    for name, part in description.named.parts.items():
        where, there = f"{TABLE}.parts.{name}", {**parts, **masses}
        if name not in there:
            remedy = f"{toml_file.nearest(name, there)}Parts are {', '.join(there) or 'none: write stiffness/' + name}"
            raise BadInput(description.source, where, "is no part of the matrices", remedy)
        meshed = {"material": part.material, "thickness": part.thickness, "section": part.section}
        stated = next((key for key, value in meshed.items() if value), "")
        if stated:
            problem = "is what elements are made with, and the matrices say it already"
            raise BadInput(description.source, f"{where}.{stated}", problem, "Leave it out")
        if part.loss_factor is not None and name not in parts:
            problem = f"is that of a part without stiffness: there is no stiffness/{name}"
            raise BadInput(description.source, f"{where}.loss_factor", problem, "Leave it out")
        lacking = {
            "modulus": None if name in parts else f"stiffness/{name}",
            "loss_factor": None if name in parts else f"stiffness/{name}",
            "density": None if name in masses else f"mass/{name}",
            "thickness": None if name in sections else f"membrane/{name} and bending/{name}",
        }
        for key in part.tolerance:
            if lacking[key]:
                problem = f"is off by a stated share of what is not there: it needs {lacking[key]}"
                raise BadInput(description.source, f"{where}.tolerance.{key}", problem, "Leave it out, or bring what it needs")


def _lossy(found: Structure, contents: Contents, description: Description, dofs: DofMap) -> Structure:
    """`found` with structural damping as shares of K with a loss factor each: of its parts, or what the user's matrix says."""
    whole, K = description.loss_factor, found.stiffness
    own = {name: part.loss_factor for name, part in description.named.parts.items() if part.loss_factor is not None}
    if "structural" not in contents:
        parts = dict(found.part_stiffness) or ({"structure": K} if whole else {})
        factors = own if whole is None else dict.fromkeys(parts, whole) | own
        return replace(found, part_stiffness=MappingProxyType(parts), loss_factors=MappingProxyType(factors))
    if whole is not None or own:
        field = "fe_model.loss_factor" if whole is not None else f"fe_model.parts.{next(iter(own))}.loss_factor"
        raise BadInput(description.source, field, "is given beside a matrix `structural`", "Leave one of the two out")
    if found.part_stiffness:
        problem = "is one matrix for all parts, which would not follow a part that is softer or stiffer"
        raise contents.refused("structural", problem, "Give every part its loss_factor in [fe_model.parts.NAME] instead")
    S = _sized(contents, "structural", K.shape[0])
    S = _symmetric(contents, "structural", _converted(S, dofs.scale, description.units.energy), dofs, found.mass.diagonal())
    _require_internal(contents, "structural", S, found)
    # i S = i (S / g) g: any g serves, and the largest ratio of the two diagonals keeps the rest of K positive.
    diagonal = K.diagonal()
    g = float((S.diagonal()[diagonal > 0] / diagonal[diagonal > 0]).max(initial=0.0))
    if not 0 < g < 2:
        problem = f"is {g:.3g} of the stiffness at most, no loss factor between 0 and 2"
        raise contents.refused("structural", problem, "Give the matrix that multiplies i, in the unit of K")
    parts = {"damped": S / g, "rest": K - S / g}
    return replace(found, part_stiffness=MappingProxyType(parts), loss_factors=MappingProxyType({"damped": g}))


def _require_internal(contents: Contents, name: str, A: Sparse, found: Structure) -> None:
    """Without a ground damping acts within the structure: a rigid motion meets none, so that only the free part need be known."""
    if found.grounded:
        return
    met, could = np.abs(A @ found.rigid).max(axis=0), (abs(A) @ np.abs(found.rigid)).max(axis=0)
    share = met / np.maximum(could, np.finfo(np.float64).tiny)
    worst = int(np.argmax(share))
    if share[worst] > EXTERNAL:
        problem = f"damps the rigid motions ({name} @ rigid must be 0), most along {MOTIONS[worst]}"
        remedy = "Write the damping within the structure, without dampers to ground; check the coordinates and the order of rows"
        raise contents.refused(name, problem, remedy)


def _sized(contents: Contents, name: str, n: int | None) -> Sparse:
    """The matrix `name`, which must be as large as the stiffness, n rows, where these are known."""
    A = contents.matrix(name)
    if n is not None and A.shape != (n, n):
        problem = f"is {A.shape[0]} x {A.shape[1]} where stiffness is {n} x {n}"
        raise contents.refused(name, problem, "Write both for the same degrees of freedom, in the same order")
    return A


def _converted(A: Sparse, scale: Array, energy: float) -> Sparse:
    """A [user's units] as energy [SI] of coordinates whose unit is `scale` (n,) in SI."""
    from scipy.sparse import csr_array, diags_array

    S = diags_array(1 / scale)
    return csr_array(energy * (S @ A @ S))


def _symmetric(contents: Contents, name: str, A: Sparse, dofs: DofMap, masses: Array) -> Sparse:
    share, i, j = asymmetry(A, masses)
    if share > SYMMETRIC:
        problem = (
            f"is not symmetric: row {i + 1}, column {j + 1} ({dofs.name(i)}; {dofs.name(j)}) holds {A[i, j]:.6g} [SI] and across "
            f"the diagonal {A[j, i]:.6g}, {share:.2g} of the largest entry there"
        )
        remedy = "Write both triangles; gyroscopic or follower terms are not part of a dynamic mass"
        raise contents.refused(name, problem, remedy)
    from scipy.sparse import csr_array

    # A, its two triangles averaged
    return csr_array((A + A.T) / 2)


# --- mechanics --------------------------------------------------------------------------------------------------------------


def _require_mechanics(found: Structure, contents: Contents, description: Description, dofs: DofMap) -> None:
    free = found.free
    K, M = (A[free][:, free] for A in (found.stiffness, found.mass))
    # Those of the free degrees of freedom that have mass; lumped masses leave rotations without, in rows that are empty
    without = M.diagonal() == 0
    coupled = np.flatnonzero(without & (abs(M).sum(axis=1) > 0))
    if coupled.size:
        problem = f"is indefinite: {dofs.name(free[coupled[0]])} has no mass of its own but is coupled to others"
        raise contents.refused("mass", problem, "Write the whole consistent mass matrix, or a lumped one without couplings")
    if np.all(without):
        raise contents.refused("mass", "gives no free degree of freedom any mass", "Check that this is M, and the interface")
    heavy = np.flatnonzero(~without)
    mass = _factored(contents, "mass", M[heavy][:, heavy], free[heavy], dofs)
    if found.grounded:
        _factored(contents, "stiffness", K, free, dofs, "ground")
        # What is clamped is not in the matrices: they may weigh less than was stated, and their centre of gravity is not known
        if description.stated.cog is not None:
            problem = "cannot be compared: what the ground holds is not in the matrices"
            raise BadInput(description.source, "stated.cog", problem, "Leave it out")
        if description.stated.mass is not None:
            weight = float(np.diag(found.rigid_mass)[:3].max())
            if not weight:
                problem = "cannot be compared: without coordinates nobody knows which rows of M are masses"
                raise BadInput(description.source, "stated.mass", problem, "Leave it out, or add dof and nodes")
            require_stated_mass(weight, description, CLAMPED)
        return
    # The mass that the base would feel at infinite frequency, M_rr - M_rf M_ff^-1 M_fr, must not be negative
    there = np.any(found.rigid, axis=0)  # a model of one plane has no motion out of it
    R = found.rigid[:, there]
    momenta = np.asarray(found.mass @ R)
    inertia, names = np.sum(R * momenta, axis=0), [name for name, moves in zip(MOTIONS, there, strict=True) if moves]
    if np.any(inertia <= 0):
        problem = f"is indefinite: the whole has the inertia {inertia.min():.6g} [SI] along {names[int(np.argmin(inertia))]}"
        raise contents.refused("mass", problem, "Check the rows and columns of the interface in M, and the coordinates")
    scale = 1 / np.sqrt(inertia)
    if len(found.held):
        left = R.T @ momenta - momenta[free[heavy]].T @ mass.solve(momenta[free[heavy]])
        values, vectors = np.linalg.eigh(scale[:, None] * left * scale)
        if values[0] < -NEGATIVE_MASS:
            axis = names[int(np.argmax(np.abs(vectors[:, 0])))]
            problem = (
                f"is indefinite: what the interface itself carries is {values[0]:.3g} of the rigid inertia, mostly along {axis}"
            )
            raise contents.refused("mass", problem, "Check the rows and columns of the interface in M")
    else:  # of a floating structure as many rows are held as just hold it
        from scipy.linalg import qr

        triangle, order = qr((R * scale).T, mode="r", pivoting=True)
        rank = np.sum(np.abs(np.diag(triangle)) > HELD * abs(triangle[0, 0]))
        free = np.setdiff1d(free, order[:rank])
        K = found.stiffness[free][:, free]
    # The six rigid motions must cost no energy, beside what the lowest mode costs (from above: the static answer to gravity)
    sag = _factored(contents, "stiffness", K, free, dofs, "base" if len(found.held) else "free").solve(momenta[free])
    lowest = np.min(np.sum(sag * (K @ sag), axis=0) / np.sum(sag * (found.mass[free][:, free] @ sag), axis=0))
    energy = R.T @ (found.stiffness @ R)
    values, vectors = np.linalg.eigh(scale[:, None] * energy * scale)
    worst = int(np.argmax(np.abs(values)))
    if abs(values[worst]) > GROUNDED * lowest:
        axis = names[int(np.argmax(np.abs(vectors[:, worst])))]
        problem = (
            f"resists the rigid motions (K @ rigid must be 0), most along {axis}: the free body would oscillate at "
            f"{np.sqrt(abs(values[worst])) / (2 * np.pi):.4g} Hz"
        )
        remedy = (
            'Write K without supports or springs to ground, or state support = "ground"; otherwise the coordinates, their unit, '
            "the order of the degrees of freedom or the displacement coordinate systems do not belong to it"
        )
        raise contents.refused("stiffness", problem, remedy)
    if not np.all(there):
        return
    remedy = "Check the order of the degrees of freedom, the coordinates and the units; every mass moves in three directions"
    require_as_stated(require_rigid_body(found.rigid_mass, contents.source, "mass", remedy), description)


def factored(A: Sparse) -> Factored:
    """L D L^T of A, symmetric with a positive diagonal, whatever the signs of its pivots."""
    from scipy.sparse import csc_array, diags_array
    from scipy.sparse.linalg import splu

    # Where a pivot is exactly zero, which one it is, is found with a little added to the diagonal
    scale = 1 / np.sqrt(A.diagonal())
    S = diags_array(scale)
    B = csc_array(S @ A @ S)
    options: dict[str, Any] = {"SymmetricMode": True}
    try:
        lu = splu(B, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
    except RuntimeError:
        lu = splu(B + csc_array(diags_array(np.full(B.shape[0], SINGULAR / 10))), "MMD_AT_PLUS_A", 0.0, options=options)
    pivots = lu.U.diagonal()
    zero, columns = np.flatnonzero(np.abs(pivots) <= SINGULAR), np.argsort(lu.perm_c)
    negative = int(np.count_nonzero(pivots < -SINGULAR))
    return Factored(solve=lambda b: scale[:, None] * lu.solve(scale[:, None] * b), negative=negative, zero=columns[zero])


def _factored(contents: Contents, name: str, A: Sparse, free: Integers, dofs: DofMap, support: str = "base") -> Factored:
    """L D L^T of A of the free degrees of freedom, when it is positive definite."""
    diagonal = A.diagonal()
    empty = np.flatnonzero(diagonal <= 0)
    if empty.size:
        worst = empty[np.argmin(diagonal[empty])]
        what = f"{empty.size} degree(s) of freedom without {name}" if diagonal[worst] == 0 else f"a negative {name}"
        problem = (
            f"is not positive definite: {what}, such as {dofs.name(free[worst])}, {diagonal[worst]:.6g} [SI] on the diagonal"
        )
        raise contents.refused(name, problem, _REMEDIES[name])
    factor = factored(A)
    if factor.negative:
        problem = f"is not positive definite {_HELD[support]}: it has {factor.negative} negative eigenvalue(s)"
        raise contents.refused(name, problem, _REMEDIES[name])
    if factor.zero.size:
        where = dofs.name(free[factor.zero[-1]])
        what = f"{factor.zero.size} motion(s) of the structure cost no energy" if name == "stiffness" else "it is singular"
        problem = f"is not positive definite {_HELD[support]}: {what}, one of them moves {where}"
        floats = name == "stiffness" and support == "ground"
        raise contents.refused(name, problem, _FLOATS if floats else _REMEDIES[name])
    return factor


_HELD = {"base": "with the interface held", "ground": "on the ground", "free": "beside its rigid motions"}

_FLOATS = 'Look for loose parts and missing supports; a structure that floats states support = "free"'

_REMEDIES = {
    "mass": "Check how M was made; a motion that has no mass must have an empty row",
    "stiffness": "Look for parts that hang loose and for an interface that leaves a mechanism, and name all its nodes; "
    "write K unreduced by loads or pre-stress beyond buckling",
}


# Modal data about the reference point as `Modes`, held against the rigid body that they belong to.

NEEDED_MODAL = ("frequency", "damping_ratio", "participation", "rigid_mass")
OPTIONAL_MODAL = ("residual", "viscous", "structural")

EXCESS = 1e-4
"""Effective masses may exceed the rigid mass by this share: the digits that programs print."""


def modes(contents: Contents, description: Description) -> Modes:
    """The modes in `contents`.

    Frequencies are in Hz and the damping matrices in rad/s and rad²/s² in every unit system; masses, lever arms and the residual
    are in the user's. The residual is zero when there is none.

    Raises
    ------
    BadInput : whatever is wrong, with the file, the array, what was found and what to do.
    """
    contents.require(NEEDED_MODAL, OPTIONAL_MODAL)
    if description.interface or description.loss_factor is not None:
        field = "fe_model.interface" if description.interface else "fe_model.loss_factor"
        problem = "belongs to matrices, not to modal data, whose base is the reference point and whose damping is damping_ratio"
        raise BadInput(description.source, field, problem, "Leave it out")
    frequency = contents.numbers("frequency", (-1,))
    if not len(frequency):
        raise contents.refused("frequency", "holds no mode", "Write at least one; a rigid body needs no model")
    wrong = np.flatnonzero(frequency <= 0)
    if wrong.size:
        problem = f"must be positive, found {frequency[wrong[0]]:.6g} Hz for mode {wrong[0] + 1}"
        remedy = "The base is held, so that no mode is at 0 Hz; a negative one is the mark of an indefinite K or of rad²/s²"
        raise contents.refused("frequency", problem, remedy)
    falls = np.flatnonzero(np.diff(frequency) < 0)
    if falls.size:
        k = int(falls[0])
        problem = f"must ascend, found {frequency[k]:.6g} Hz for mode {k + 1} and {frequency[k + 1]:.6g} Hz for mode {k + 2}"
        remedy = "Sort frequency, damping_ratio and the columns of participation together; here nobody knows which are sorted"
        raise contents.refused("frequency", problem, remedy)
    n, u = len(frequency), description.units
    rigid = contents.numbers("rigid_mass", (6, 6)) * np.outer(u.six, u.six) * u.mass
    participation = contents.numbers("participation", (6, n)) * u.six[:, None] * np.sqrt(u.mass)
    about = "Write the 6 x 6 mass matrix about the reference point: products are matrix entries, Ixy = -∫xy dm"
    inertia = require_rigid_body(rigid, contents.source, "rigid_mass", about)
    require_as_stated(inertia, description)
    # What the modes carry is a part of the rigid mass: rigid - L L^T has no negative eigenvalue
    shares = np.sum(participation**2, axis=1) / np.diag(rigid)
    worst = int(np.argmax(shares))
    remedy = (
        "Write participation about the reference point, 6 x n, of modes normalised to unit modal mass, in the units of rigid_mass"
    )
    if shares[worst] > 1 + EXCESS:
        problem = f"carries {shares[worst]:.4g} times the rigid mass along {MOTIONS[worst]}: the effective masses exceed it"
        raise contents.refused("participation", problem, remedy)
    scale = 1 / np.sqrt(np.diag(rigid))
    left = scale[:, None] * (rigid - participation @ participation.T) * scale
    lowest = float(np.linalg.eigvalsh((left + left.T) / 2)[0])
    if lowest < -EXCESS:
        problem = f"carries more than the rigid mass in a combination of axes, by {-lowest:.3g} of it"
        raise contents.refused("participation", problem, f"Check the signs of its rows. {remedy}")
    viscous, structural = (_damping(contents, name, n) for name in ("viscous", "structural"))
    ratio = contents.numbers("damping_ratio", (n,))
    wrong = np.flatnonzero((ratio < 0) | (ratio >= 1))
    if wrong.size:
        found = ratio[wrong[0]]
        problem = f"must be at least 0 and below 1, found {found:.6g} for mode {wrong[0] + 1}"
        remedy = "Write the share of critical damping, 0.01 for 1 %" if found >= 1 else "Correct it"
        raise contents.refused("damping_ratio", problem, remedy)
    omega = 2 * np.pi * frequency
    if viscous is None:
        viscous = np.diag(2 * ratio * omega - (0 if structural is None else np.diag(structural) / omega))
    # `damping_ratio` repeats the diagonals of the damping matrices where these are given
    equivalent = (np.diag(viscous) + (0 if structural is None else np.diag(structural) / omega)) / (2 * omega)
    off = np.abs(equivalent - ratio)
    mode = int(np.argmax(off))
    if off[mode] > 1e-3 * ratio[mode] + 1e-9 or np.any(np.diag(viscous) < -1e-9 * omega):
        problem = f"is {ratio[mode]:.6g} for mode {mode + 1} where the damping matrices make it {equivalent[mode]:.6g}"
        remedy = "Write (C_rr + S_rr / omega_r) / (2 omega_r), with C in rad/s and S in rad²/s²"
        raise contents.refused("damping_ratio", problem, remedy)
    return Modes(
        frequency=frequency,
        damping_ratio=ratio,
        participation=participation,
        rigid_mass=(rigid + rigid.T) / 2,
        residual=_residual(contents) * np.outer(u.six, u.six) * u.mass * u.time**2,
        reference_point=description.reference_point,
        shapes=np.zeros((0, n)),
        viscous=viscous,
        structural=np.zeros((n, n)) if structural is None else structural,
    )


def _damping(contents: Contents, name: str, n: int) -> Array | None:
    if name not in contents:
        return None
    D = contents.numbers(name, (n, n))
    worst = float(np.abs(D - D.T).max())
    if worst > SYMMETRIC * np.abs(D).max():
        raise contents.refused(name, f"is not symmetric, by {worst:.6g}", "Write both triangles of the modal damping matrix")
    lowest = float(np.linalg.eigvalsh((D + D.T) / 2)[0])
    if lowest < -SYMMETRIC * np.abs(D).max():
        raise contents.refused(name, f"has the negative eigenvalue {lowest:.6g}, which feeds energy in", "Correct it")
    return (D + D.T) / 2


def _residual(contents: Contents) -> Array:
    if "residual" not in contents:
        return np.zeros((6, 6))
    R = contents.numbers("residual", (6, 6))
    scale = np.sqrt(np.abs(np.diag(R)))
    unsymmetric = np.abs(R - R.T) > SYMMETRIC * np.outer(scale, scale) + 1e-30
    if np.any(unsymmetric):
        row, column = np.argwhere(unsymmetric)[0] + 1
        raise contents.refused("residual", f"is not symmetric in row {row}, column {column}", "Write both triangles")
    regular = np.where(scale > 0, scale, 1.0)
    lowest = float(np.linalg.eigvalsh((R + R.T) / 2 / np.outer(regular, regular))[0])
    if lowest < -EXCESS:
        problem = f"is not positive: it has the eigenvalue {lowest:.3g} when scaled to a diagonal of ones"
        raise contents.refused("residual", problem, "Write the sum of L L^T / omega² over the modes that are left out")
    return (R + R.T) / 2
