"""What a user's arrays describe: K and M as `Structure`, modal data as `Modes`, in SI, checked with all that mechanics knows.

The interface nodes ride on the reference point. Whether the model is a full one or reduced to Craig-Bampton coordinates makes no
difference: a generalised coordinate takes no part in a rigid motion, so its row of `rigid` is zero.

Only what the base moves counts. With the interface held, K must be positive definite (else something is loose) and M too; with it
carried along, M of base and free coordinates together must not be negative, and K must let the rigid motions pass.
"""

from collections.abc import Callable
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from fem.modes import Modes
from fem.structure import Sparse, Structure, rigid_motion
from fem.user_model.description import SI, Contents, Description, require_as_stated, require_rigid_body
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.frames import Array, Integers, rigid_transformation_6, skew

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


# Which motion every row of K and M is, which of them the base carries, and what they do when it moves.

INDEPENDENT = 1e-9
"""Singular value of the held rigid motions, scaled to the size of the interface, below which one of the six is not held."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DofMap:
    """The degrees of freedom of a model.

    Attributes
    ----------
    labels : (n, 2) node identifier and component 1 to 6, 0 for a generalised coordinate; (0, 2) when the file has none
    scale : (n,) SI value of the user's unit of each
    rigid : (n, 6) [SI] what each does in the motions of the reference point
    held : (b,) those of the interface
    points, translations : (p, 3) as in `Structure`
    """

    labels: Integers
    scale: Array
    rigid: Array
    held: Integers
    points: Array
    translations: Integers

    def name(self, index: int) -> str:
        """``node 12, beta`` or ``degree of freedom 7`` of the degree of freedom `index`, counted from 0."""
        if not len(self.labels):
            return f"degree of freedom {index + 1}"
        node, component = self.labels[index]
        return f"node {node}, {MOTIONS[component - 1]}" if component else f"generalised coordinate {node}"


def dof_map(contents: Contents, description: Description, n: int) -> DofMap:
    """The map of the `n` degrees of freedom in `contents`.

    Raises
    ------
    BadInput : wrong sizes, unknown or doubled degrees of freedom, nodes without coordinates, an interface that is not there
        or does not hold six motions.
    """
    if "dof" in contents:
        found = _by_nodes(contents, description, n)
    else:
        # From `rigid` and `held` themselves, in SI: how `write` leaves a structure that knows no nodes
        for name in ("rigid", "held"):
            if name not in contents:
                problem = (
                    "there is neither a map of the degrees of freedom (`dof`, `nodes`, `coordinates`) nor `rigid` and `held`"
                )
                raise contents.refused(
                    "dof", problem, "Add dof (n x 2: node, component 1 to 6, or 0), nodes (p) and coordinates (p x 3)"
                )
        units = description.units
        if (units.length, units.mass, units.time) != (SI.length, SI.mass, SI.time):
            problem = f"`rigid` without `dof` says not what is a length, and the units are {units.name}"
            raise contents.refused("rigid", problem, 'Add dof, nodes and coordinates, or write all in SI with units = "m-kg-N-s"')
        points = contents.numbers("points", (-1, 3)) if "points" in contents else np.zeros((0, 3))
        translations = contents.whole("translations", (len(points), 3)) if len(points) else np.zeros((0, 3), dtype=np.intp)
        held = contents.whole("held", (-1,))
        _require_within(contents, "held", held, n)
        _require_within(contents, "translations", translations, n)
        if len(np.unique(held)) < len(held):
            raise contents.refused("held", "names a degree of freedom twice", "Name every held degree of freedom once")
        found = DofMap(
            labels=np.zeros((0, 2), dtype=np.intp),
            scale=np.ones(n),
            rigid=contents.numbers("rigid", (n, 6)),
            held=held,
            points=points,
            translations=translations,
        )
    _require_hold(found, contents, description)
    return found


def _by_nodes(contents: Contents, description: Description, n: int) -> DofMap:
    labels = _labels(contents, n)
    nodes = contents.whole("nodes", (-1,))
    coordinates = contents.numbers("coordinates", (-1, 3))
    if len(nodes) != len(coordinates):
        problem = f"holds {len(coordinates)} points for {len(nodes)} nodes"
        raise contents.refused("coordinates", problem, "Write one row x, y, z for every entry of nodes")
    unique, count = np.unique(nodes, return_counts=True)
    if np.any(count > 1):
        problem = f"names node {unique[np.argmax(count > 1)]} {count.max()} times"
        raise contents.refused("nodes", problem, "Name every node once")
    # Row in `nodes` of every degree of freedom (n,); meaningless where it is a generalised coordinate
    order = np.argsort(nodes)
    nearby = np.searchsorted(nodes, labels[:, 0], sorter=order)
    row = order[np.minimum(nearby, len(nodes) - 1)] if len(nodes) else np.full(len(labels), -1)
    lost = np.flatnonzero((labels[:, 1] > 0) & ((row < 0) | (nodes[row] != labels[:, 0] if len(nodes) else True)))
    if lost.size:
        problem = f"node {labels[lost[0], 0]} has no coordinates, as {len(np.unique(labels[lost, 0]))} node(s) in all"
        raise contents.refused("dof", problem, "Add the missing nodes to nodes and coordinates")
    if "rigid" in contents:  # Nastran, whose displacements may have directions of their own
        rigid, basic = contents.numbers("rigid", (n, 6)), contents.whole("basic", (len(nodes),)).astype(bool)
    else:
        # What every degree of freedom does in the six motions of the origin (n, 6), in the user's unit of length
        rigid, physical = np.zeros((len(labels), 6)), labels[:, 1] > 0
        every = rigid_motion(coordinates).reshape(-1, 6, 6) if len(coordinates) else np.zeros((0, 6, 6))
        rigid[physical] = every[row[physical], labels[physical, 1] - 1]
        basic = np.ones(len(nodes), dtype=bool)
    units = description.units
    scale = units.coordinates(labels[:, 1])
    moved = rigid_transformation_6(-description.reference_point / units.length)
    # The nodes that can move along x, y and z, and the degrees of freedom that do it
    index = {(int(node), int(component)): k for k, (node, component) in enumerate(labels)}
    full = [k for k in np.flatnonzero(basic) if all((int(nodes[k]), c) in index for c in (1, 2, 3))]
    translations = np.array([[index[int(nodes[k]), c] for c in (1, 2, 3)] for k in full], dtype=np.intp).reshape(-1, 3)
    return DofMap(
        labels=labels,
        scale=scale,
        rigid=scale[:, None] * (rigid @ moved) / np.array([*3 * [units.length], *3 * [1.0]]),
        held=_held(contents, description, labels),
        points=coordinates[full].reshape(-1, 3) * units.length,
        translations=translations,
    )


def _labels(contents: Contents, n: int) -> Integers:
    labels = contents.whole("dof", (-1, 2))
    if len(labels) != n:
        problem = f"names {len(labels)} degrees of freedom where the matrices have {n}"
        raise contents.refused("dof", problem, "Write one row, node and component, for every row of K and M, in their order")
    wrong = np.flatnonzero((labels[:, 1] < 0) | (labels[:, 1] > 6))
    if wrong.size:
        problem = f"row {wrong[0] + 1} has the component {labels[wrong[0], 1]}"
        remedy = "Components are 1 to 6 (x, y, z and the rotations about them), 0 for a generalised coordinate"
        raise contents.refused("dof", problem, remedy)
    _, first, count = np.unique(labels, axis=0, return_index=True, return_counts=True)
    if np.any(count > 1):
        node, component = labels[first[np.argmax(count > 1)]]
        problem = f"names node {node}, component {component} {count.max()} times"
        raise contents.refused("dof", problem, "Name every degree of freedom once; number generalised coordinates")
    return labels


def _held(contents: Contents, description: Description, labels: Integers) -> Integers:
    interface = description.interface or tuple(contents.whole("interface", (-1,)).tolist() if "interface" in contents else ())
    if not interface:
        problem, remedy = "is missing: no node is named that the base carries", "Add interface = [node, ...]"
        raise BadInput(source=description.source, field="fe_model.interface", problem=problem, remedy=remedy)
    physical = labels[:, 1] > 0
    for node in interface:
        if not np.any(physical & (labels[:, 0] == node)):
            problem = f"names node {node}, which has no degree of freedom in the matrices"
            values = np.unique(labels[physical, 0])
            some = ", ".join(map(str, values[:6])) + (f", ... ({len(values)} in all)" if len(values) > 6 else "")
            remedy = f"The nodes there are {some}"
            raise BadInput(source=description.source, field="fe_model.interface", problem=problem, remedy=remedy)
    return np.flatnonzero(physical & np.isin(labels[:, 0], interface))


def _require_within(contents: Contents, name: str, values: Integers, n: int) -> None:
    if values.size and (values.min() < 0 or values.max() >= n):
        outside = values.min() if values.min() < 0 else values.max()
        problem = f"names the degree of freedom {outside} of {n}"
        raise contents.refused(name, problem, "Count from 0")


def _require_hold(found: DofMap, contents: Contents, description: Description) -> None:
    """The interface must follow all six motions: two nodes on a line that carry no rotations let the structure turn about it."""
    held = found.rigid[found.held]
    source = description.source if description.interface else contents.source
    field = "fe_model.interface" if description.interface else "held"
    remedy = "Name at least three nodes that are not on one line, or one that has its three rotations too"
    if not 0 < len(held) < len(found.rigid):
        problem = f"holds {len(held)} of all {len(found.rigid)} degrees of freedom"
        raise BadInput(source=source, field=field, problem=problem, remedy=remedy)
    # Motions about a point in the middle of the held degrees of freedom rather than the reference point: a shift of that by d
    # adds translations @ skew(d) to the rotations; the best d in the least-squares sense.
    translations, rotations = held[:, :3], held[:, 3:]
    generators = np.stack([translations @ skew(axis) for axis in np.eye(3)], axis=-1).reshape(-1, 3)
    shift, *_ = np.linalg.lstsq(generators, -rotations.reshape(-1), rcond=None)
    centred = np.hstack([translations, rotations + (generators @ shift).reshape(rotations.shape)])
    size = np.sqrt((centred[:, 3:] ** 2).sum(axis=0).max())
    scaled = centred / np.array([*3 * [1.0], *3 * [size or 1.0]])
    _, values, motions = np.linalg.svd(scaled, full_matrices=True)
    values = np.append(values, np.zeros(6 - len(values)))
    if values[-1] < INDEPENDENT * values[0]:
        axis = MOTIONS[int(np.argmax(np.abs(motions[-1])))]
        problem = f"does not hold the structure: it is free to move along or about {axis}"
        raise BadInput(source=source, field=field, problem=problem, remedy=remedy)


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
    # Structural damping as shares of K with a loss factor each: the whole, or what the user's matrix says
    whole = description.loss_factor
    parts: dict[str, Sparse] = {"all": K} if whole else {}
    loss_factors = {"all": whole} if whole else {}
    if "structural" in contents:
        if whole is not None:
            problem, field = "is given beside a matrix `structural`", "fe_model.loss_factor"
            raise BadInput(source=description.source, field=field, problem=problem, remedy="Leave one of the two out")
        S = _sized(contents, "structural", n)
        S = _symmetric(contents, "structural", _converted(S, scale, u.energy), dofs, M.diagonal())
        _require_internal(contents, "structural", S, dofs)
        # i S = i (S / g) g: any g serves, and the largest ratio of the two diagonals keeps the rest of K positive.
        diagonal = K.diagonal()
        g = float((S.diagonal()[diagonal > 0] / diagonal[diagonal > 0]).max(initial=0.0))
        if not 0 < g < 2:
            problem = f"is {g:.3g} of the stiffness at most, no loss factor between 0 and 2"
            raise contents.refused("structural", problem, "Give the matrix that multiplies i, in the unit of K")
        parts, loss_factors = {"damped": S / g, "rest": K - S / g}, {"damped": g}
    found = Structure(
        stiffness=K,
        mass=M,
        rigid=dofs.rigid,
        held=dofs.held,
        reference_point=description.reference_point,
        points=dofs.points,
        translations=dofs.translations,
        part_stiffness=MappingProxyType(parts),
        loss_factors=MappingProxyType(loss_factors),
    )
    _require_mechanics(found, contents, description, dofs)
    if "viscous" not in contents:
        viscous: Sparse | None = None
    else:
        C = _sized(contents, "viscous", M.shape[0])
        C = _symmetric(contents, "viscous", _converted(C, dofs.scale, u.energy * u.time), dofs, M.diagonal())
        _require_internal(contents, "viscous", C, dofs)
        viscous = C
    return found, viscous


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
    # The mass that the base would feel at infinite frequency, M_rr - M_rf M_ff^-1 M_fr, must not be negative
    inertia, momenta = np.diag(found.rigid_mass), np.asarray(found.mass @ found.rigid)
    if np.any(inertia <= 0):
        problem = f"is indefinite: the whole has the inertia {inertia.min():.6g} [SI] along {MOTIONS[int(np.argmin(inertia))]}"
        raise contents.refused("mass", problem, "Check the rows and columns of the interface in M, and the coordinates")
    left = found.rigid_mass - momenta[free[heavy]].T @ mass.solve(momenta[free[heavy]])
    scale = 1 / np.sqrt(inertia)
    values, vectors = np.linalg.eigh(scale[:, None] * left * scale)
    if values[0] < -NEGATIVE_MASS:
        axis = MOTIONS[int(np.argmax(np.abs(vectors[:, 0])))]
        problem = f"is indefinite: what the interface itself carries is {values[0]:.3g} of the rigid inertia, mostly along {axis}"
        raise contents.refused("mass", problem, "Check the rows and columns of the interface in M")
    # The six rigid motions must cost no energy, beside what the lowest mode costs (from above: the static answer to gravity)
    sag = _factored(contents, "stiffness", K, free, dofs).solve(momenta[free])
    lowest = np.min(np.sum(sag * (K @ sag), axis=0) / np.sum(sag * (M @ sag), axis=0))
    energy = found.rigid.T @ (found.stiffness @ found.rigid)
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
    remedy = "Check the order of the degrees of freedom, the coordinates and the units; every mass moves in three directions"
    require_as_stated(require_rigid_body(found.rigid_mass, contents.source, "mass", remedy), description)


def _factored(contents: Contents, name: str, A: Sparse, free: Integers, dofs: DofMap) -> Factored:
    """L D L^T of A of the free degrees of freedom, when it is positive definite."""
    from scipy.sparse import csc_array, diags_array
    from scipy.sparse.linalg import splu

    diagonal = A.diagonal()
    empty = np.flatnonzero(diagonal <= 0)
    if empty.size:
        worst = empty[np.argmin(diagonal[empty])]
        what = f"{empty.size} degree(s) of freedom without {name}" if diagonal[worst] == 0 else f"a negative {name}"
        problem = (
            f"is not positive definite: {what}, such as {dofs.name(free[worst])}, {diagonal[worst]:.6g} [SI] on the diagonal"
        )
        raise contents.refused(name, problem, _REMEDIES[name])
    # L D L^T; where a pivot is exactly zero, which one it is, is found with a little added to the diagonal
    scale = 1 / np.sqrt(diagonal)
    S = diags_array(scale)
    B = csc_array(S @ A @ S)
    options: dict[str, Any] = {"SymmetricMode": True}
    try:
        lu = splu(B, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
    except RuntimeError:
        lu = splu(B + csc_array(diags_array(np.full(B.shape[0], SINGULAR / 10))), "MMD_AT_PLUS_A", 0.0, options=options)
    pivots = lu.U.diagonal()
    zero = np.flatnonzero(np.abs(pivots) <= SINGULAR)
    columns = np.argsort(lu.perm_c)
    negative = int(np.count_nonzero(pivots < -SINGULAR))
    factor = Factored(solve=lambda b: scale[:, None] * lu.solve(scale[:, None] * b), negative=negative, zero=columns[zero])
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
        raise BadInput(source=description.source, field=field, problem=problem, remedy="Leave it out")
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
    n = len(frequency)
    u = description.units
    rigid = contents.numbers("rigid_mass", (6, 6)) * np.outer(u.six, u.six) * u.mass
    participation = contents.numbers("participation", (6, n)) * u.six[:, None] * np.sqrt(u.mass)
    about = "Write the 6 x 6 mass matrix about the reference point: products are matrix entries, Ixy = -∫xy dm"
    inertia = require_rigid_body(rigid, contents.source, "rigid_mass", about)
    require_as_stated(inertia, description)
    _require_within_rigid_mass(contents, rigid, participation)
    viscous, structural = (_damping(contents, name, n) for name in ("viscous", "structural"))
    ratio = contents.numbers("damping_ratio", (n,))
    wrong = np.flatnonzero((ratio < 0) | (ratio >= 1))
    if wrong.size:
        found = ratio[wrong[0]]
        problem = f"must be at least 0 and below 1, found {found:.6g} for mode {wrong[0] + 1}"
        raise contents.refused(
            "damping_ratio", problem, "Write the share of critical damping, 0.01 for 1 %" if found >= 1 else "Correct it"
        )
    omega = 2 * np.pi * frequency
    if viscous is None:
        viscous = np.diag(2 * ratio * omega - (0 if structural is None else np.diag(structural) / omega))
    # `damping_ratio` repeats the diagonals of the damping matrices where these are given
    equivalent = (np.diag(viscous) + (0 if structural is None else np.diag(structural) / omega)) / (2 * omega)
    off = np.abs(equivalent - ratio)
    mode = int(np.argmax(off))
    if off[mode] > 1e-3 * ratio[mode] + 1e-9 or np.any(np.diag(viscous) < -1e-9 * omega):
        problem = f"is {ratio[mode]:.6g} for mode {mode + 1} where the damping matrices make it {equivalent[mode]:.6g}"
        raise contents.refused(
            "damping_ratio", problem, "Write (C_rr + S_rr / omega_r) / (2 omega_r), with C in rad/s and S in rad²/s²"
        )
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


def _require_within_rigid_mass(contents: Contents, rigid: Array, participation: Array) -> None:
    """What the modes carry is a part of the rigid mass: rigid - L L^T has no negative eigenvalue."""
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
