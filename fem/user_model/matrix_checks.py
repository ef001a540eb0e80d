"""What can be wrong with stiffness, mass and damping as somebody wrote them: each finding with where, how much and what to do.

Nothing here refuses. A check looks at the matrices as they stand, says what it finds, and hands on what the next ones can still
be done with: the right triangle of an unsymmetric matrix, the coordinates that let rigid motions pass. So causes come first.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import combinations, permutations, product

import numpy as np

from fem.structure import Sparse
from fem.user_model import description, freedoms, matrices
from fem.user_model.units import UnitSystem
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.frames import Array, Integers, skew


@dataclass(frozen=True, kw_only=True)
class Finding:
    """One thing that is wrong with a model.

    Attributes
    ----------
    check : what was looked at, in one or two words
    what : the sentence that says it
    where : degrees of freedom, nodes, parts or arrays
    amount : how much, with its unit
    remedy : what to do
    """

    check: str
    what: str
    where: str
    amount: str
    remedy: str


@dataclass(frozen=True, eq=False, kw_only=True)
class Submitted:
    """Matrices as they were written, in SI, neither symmetrised nor judged.

    Attributes
    ----------
    stiffness, mass : (n, n) sparse
    dofs : what every row is; its `rigid` is empty (0, 6) where that is not known
    support : "base", "ground" or "free"
    nodes, places : (p,) numbers and (p, 3) [m] coordinates, as far as the file has them
    reference_point : (3,) [m]
    viscous, structural : (n, n) sparse, None where there is none
    part_stiffness, part_mass : shares (n, n) in the stiffness and the mass
    stated : what is known of the whole from elsewhere
    """

    stiffness: Sparse
    mass: Sparse
    dofs: freedoms.DofMap
    support: str = "base"
    nodes: Integers = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    places: Array = field(default_factory=lambda: np.zeros((0, 3)))
    reference_point: Array = field(default_factory=lambda: np.zeros(3))
    viscous: Sparse = None
    structural: Sparse = None
    part_stiffness: Mapping[str, Sparse] = field(default_factory=dict)
    part_mass: Mapping[str, Sparse] = field(default_factory=dict)
    stated: description.Stated = field(default_factory=description.Stated)

    @property
    def reduced(self) -> bool:
        """Whether some of its coordinates are those of a reduction."""
        return bool(np.any(self.dofs.labels[:, 1:] == 0))

    @property
    def free(self) -> Integers:
        """Rows that no base carries."""
        return np.setdiff1d(np.arange(self.mass.shape[0]), self.dofs.held)

    def places_of(self, rows: Integers) -> str:
        """At most three of `rows` by name, how many more there are, and the parts to which they belong."""
        named = ", ".join(self.dofs.name(int(row)) for row in rows[:3])
        more = f" and {len(rows) - 3} more" if len(rows) > 3 else ""
        parts = [part for part, K in self.part_stiffness.items() if len(rows) and np.any(K.diagonal()[rows])]
        return f"{named}{more}" + (f" (part {', '.join(parts[:3])})" if 0 < len(parts) < len(self.part_stiffness) else "")

    def rows_of(self, node: int) -> Integers:
        """Rows of the motions of `node`, in the order of the matrices."""
        return np.flatnonzero((self.dofs.labels[:, 0] == node) & (self.dofs.labels[:, 1] > 0))

    def without(self, gone: Integers) -> "Submitted":
        """It without the rows `gone`, and without the nodes that had no others."""
        kept, d = np.setdiff1d(np.arange(self.mass.shape[0]), gone), self.dofs
        place = np.full(self.mass.shape[0], -1)
        place[kept] = np.arange(len(kept))
        held = place[d.held]

        def cut(A: Sparse) -> Sparse:
            return None if A is None else A[kept][:, kept]

        there = np.ones(len(self.nodes), dtype=bool)
        if len(d.labels):
            there = ~np.isin(self.nodes, d.labels[gone, 0]) | np.isin(self.nodes, d.labels[kept, 0])
        return replace(
            self,
            stiffness=cut(self.stiffness),
            mass=cut(self.mass),
            viscous=cut(self.viscous),
            structural=cut(self.structural),
            part_stiffness={part: cut(A) for part, A in self.part_stiffness.items()},
            part_mass={part: cut(A) for part, A in self.part_mass.items()},
            nodes=self.nodes[there],
            places=self.places[there],
            dofs=replace(
                d,
                labels=d.labels[kept] if len(d.labels) else d.labels,
                scale=d.scale[kept],
                rigid=d.rigid[kept] if len(d.rigid) else d.rigid,
                held=held[held >= 0],
            ),
        )


# --- entries ----------------------------------------------------------------------------------------------------------------


def entries(model: Submitted) -> tuple[Submitted, list[Finding]]:
    """Symmetry, signs of the diagonal, matrices confused; the model that is left is symmetric, its wrong triangle replaced."""
    found: list[Finding] = []
    K, M = model.stiffness, model.mass
    if len(model.dofs.rigid) and model.support != "ground" and K.shape == M.shape:
        T = model.dofs.rigid
        if _resistance(M, T) < 1e-6 < 1e-3 < _resistance(K, T):
            where = "arrays `stiffness` and `mass`"
            amount = "the mass lets all six rigid motions pass, and the stiffness does not"
            what = "stiffness and mass are confused: each stands under the other's name"
            found.append(Finding(check="confused", what=what, where=where, amount=amount, remedy="Exchange their names"))
            model = replace(model, stiffness=M, mass=K)
    for name in ("stiffness", "mass", "viscous", "structural"):
        A = getattr(model, name)
        if A is None:
            continue
        share, i, j = matrices.asymmetry(
            A, np.maximum(model.mass.diagonal(), 0) if model.mass.diagonal().max() > 0 else np.ones(A.shape[0])
        )
        if share <= matrices.SYMMETRIC:
            model = replace(model, **{name: (A + A.T) / 2})
            continue
        made, finding = _made_symmetric(model, name, share, i, j)
        model = replace(model, **{name: made})
        found.append(finding)
    for name in ("stiffness", "mass"):
        diagonal = getattr(model, name).diagonal()
        scale = float(np.abs(diagonal).max(initial=0.0))
        negative = np.flatnonzero(diagonal < -1e-9 * scale)
        if model.reduced and len(model.dofs.rigid):  # of the interface a reduction leaves rounding
            negative = negative[np.abs(diagonal[negative]) > 1e-6 * scale]
        if not negative.size:
            continue
        worst, every = negative[np.argsort(diagonal[negative])], len(negative) > len(diagonal) / 2
        what = f"the {name} has the wrong sign" if every else f"the {name} is negative on the diagonal"
        where = model.places_of(worst)
        amount = f"{len(negative)} of {len(diagonal)} diagonal entries, down to {diagonal[worst[0]]:.4g} [SI]"
        remedy = "Write it with the opposite sign" if every else "Correct these entries: no motion may give energy away"
        found.append(Finding(check="sign" if every else "diagonal", what=what, where=where, amount=amount, remedy=remedy))
        if every:
            model = replace(model, **{name: -getattr(model, name)})
    return model, found


def _made_symmetric(model: Submitted, name: str, share: float, i: int, j: int) -> tuple[Sparse, Finding]:
    """`name` with its better triangle on both sides, and what was wrong with it."""
    from scipy.sparse import csr_array, diags_array, tril, triu

    A = getattr(model, name)
    lower, upper, D = csr_array(tril(A, -1)), csr_array(triu(A, 1)), diags_array(A.diagonal())
    if not lower.nnz or not upper.nnz or abs(lower).sum() == 0 or abs(upper).sum() == 0:
        there, missing = ("upper", "lower") if lower.nnz == 0 or abs(lower).sum() == 0 else ("lower", "upper")
        whole = csr_array(upper + upper.T + D) if there == "upper" else csr_array(lower + lower.T + D)
        what = f"of the {name} only the {there} triangle is there"
        amount = f"{int((lower if there == 'lower' else upper).nnz)} entries without their counterparts"
        remedy = "Write both triangles, each entry twice but for the diagonal"
        return whole, Finding(
            check="triangle", what=what, where=f"array `{name}`, its {missing} triangle", amount=amount, remedy=remedy
        )
    choices = [csr_array((A + A.T) / 2), csr_array(upper + upper.T + D), csr_array(lower + lower.T + D)]
    best, T = 0, model.dofs.rigid
    if len(T) and (name == "mass" or model.support != "ground"):
        by_axis = [np.diag(T.T @ (choice @ T))[:3] for choice in choices]
        amiss = [np.ptp(one) if name == "mass" else _resistance(B, T) for one, B in zip(by_axis, choices, strict=True)]
        best = int(np.argmin(amiss)) if min(amiss) < CURED * amiss[0] else 0
    row, column = (max(i, j), min(i, j)) if best == 1 else (min(i, j), max(i, j))
    reason = "the rigid motions pass" if name != "mass" else "the mass is the same along all axes"
    said = f"; row {row + 1}, column {column + 1} is the wrong one, for with the other {reason}" if best else ""
    what = f"the {name} is not symmetric: across the diagonal stand {A[i, j]:.6g} and {A[j, i]:.6g} [SI]{said}"
    where = f"row {i + 1}, column {j + 1}: {model.dofs.name(i)} and {model.dofs.name(j)}"
    amount = f"{share:.2g} of the largest entry of the two rows"
    remedy = "Correct the entry; gyroscopic and follower terms are not part of K and M"
    finding = Finding(check="symmetry", what=what, where=where, amount=amount, remedy=remedy)
    return choices[best], finding


def _resistance(A: Sparse, T: Array) -> float:
    """How far A (n, n) resists the motions T (n, 6): 0 for none, of the order of 1 for a matrix that holds every row."""
    d = np.sqrt(np.abs(A.diagonal()))
    d = np.maximum(d, 1e-9 * d.max(initial=1e-300))
    norms = np.linalg.norm(d[:, None] * T, axis=0)
    return float(np.max(np.linalg.norm((A @ T) / d[:, None], axis=0) / np.maximum(norms, 1e-300)))


# --- parts ------------------------------------------------------------------------------------------------------------------

ADDED_UP = 1e-6
"""Share of the largest entry of a row by which parts may miss the whole: single precision and printed digits."""


def parts(whole: Mapping[str, Sparse], shares: Mapping[str, Mapping[str, Sparse]], model: Submitted) -> Iterator[Finding]:
    """Do the parts of ``stiffness`` and ``mass`` add up to the whole? `whole` and `shares` are by array, on plain matrices."""
    from scipy.sparse import coo_array

    for name, share in shares.items():
        if not share or name not in whole:
            continue
        A, every = whole[name], list(share.values())
        if any(part.shape != A.shape for part in every):
            odd = next(part for part, matrix in share.items() if matrix.shape != A.shape)
            size, remedy = share[odd].shape, "Write every part for all rows, in the order of the whole"
            what = f"the part {odd} of the {name} has another size than the whole"
            amount = f"{size[0]} x {size[1]} where {A.shape[0]} x {A.shape[1]} belongs"
            yield Finding(check="parts", what=what, where=f"array `{name}/{odd}`", amount=amount, remedy=remedy)
            continue
        D, scale = coo_array(A - sum(every[1:], every[0])), abs(A).max(axis=1).toarray().ravel()
        row, column = D.coords
        off = np.abs(D.data) / np.maximum(np.sqrt(scale[row] * scale[column]), 1e-9 * scale.max(initial=1e-300))
        if not len(off) or off.max() <= ADDED_UP:
            continue
        worst = int(np.argmax(off))
        blame, size = "", np.linalg.norm(D.data)
        for part, matrix in share.items():
            weight = float((matrix * D).sum() / max((matrix * matrix).sum(), 1e-300))
            if abs(D - weight * matrix).max() <= 1e-3 * abs(D).max() and size:
                blame = f": part {part} is in the whole {1 + weight:.4g} times"
        rows = np.unique(row[off > max(ADDED_UP, 1e-3 * off.max())])
        what = f"the parts of the {name} do not add up to the whole{blame}"
        amount = f"{D.data[worst]:.4g} [SI] in row {row[worst] + 1}, column {column[worst] + 1}, {off[worst]:.2g} of it"
        remedy = "Write the parts from the same model as the whole, each once, or leave out the whole: it is their sum"
        yield Finding(check="parts", what=what, where=model.places_of(rows), amount=amount, remedy=remedy)


# --- what hangs together ----------------------------------------------------------------------------------------------------

TOUCHING = 1e-6
"""Distance of two nodes, as a share of the size of the model, below which they are one place."""

PENALTY = 1e7
"""Stiffness of one motion over the median of all of its kind, above which half of the digits of the others are lost."""


def connections(model: Submitted) -> tuple[Submitted, list[Finding]]:
    """Rows without stiffness or mass, doubled nodes, loose parts, penalty springs; what hangs on nothing is left out."""
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    found: list[Finding] = []
    K, M, labels = model.stiffness, model.mass, model.dofs.labels
    rigid = len(model.dofs.rigid) > 0
    stiff, heavy = (np.asarray(abs(A).sum(axis=1)).ravel() > 0 for A in (K, M))
    size = float(np.ptp(model.places, axis=0).max()) if len(model.places) else 0.0
    free = np.isin(np.arange(K.shape[0]), model.free)
    unstiff, empty = np.flatnonzero(~stiff & heavy & free), np.flatnonzero(~stiff & ~heavy & free)
    of_mass = np.isin(labels[empty, 0], labels[unstiff, 0]) if len(labels) else np.zeros(len(empty), dtype=bool)
    beside, empty = empty[of_mass], empty[~of_mass]
    if empty.size:
        nodes = np.unique(labels[empty, 0]) if len(labels) else np.zeros(0, dtype=np.intp)
        lost = np.setdiff1d(nodes, labels[stiff, 0]).tolist()
        many = f"{len(empty)} degree(s) of freedom in which neither stiffness nor mass has an entry"
        named = f"node {', '.join(map(str, lost[:5]))}" if lost else model.places_of(empty)
        what = f"{len(lost)} node(s) belong to nothing" if lost else "degrees of freedom are there that nothing uses"
        remedy = "Take them out, or connect them: a node that no element uses, or a rotation that solid elements do not have"
        found.append(Finding(check="orphan", what=what, where=named, amount=many, remedy=remedy))
    if unstiff.size:
        what = "mass hangs where there is no stiffness"
        remedy = "Connect it: a point mass on a node that no element uses, or a row of K lost"
        amount = f"{len(unstiff)} degree(s) of freedom, {float(M.diagonal()[unstiff].max()):.4g} [SI] of mass on one of them"
        found.append(Finding(check="no stiffness", what=what, where=model.places_of(unstiff), amount=amount, remedy=remedy))
    if size and not model.reduced and len(model.nodes) == len(np.unique(model.nodes)):
        pairs, apart = cKDTree(model.places).query_pairs(TOUCHING * size, output_type="ndarray"), []
        for first, second in model.nodes[pairs]:
            a, b = (rows[stiff[rows]] for rows in (model.rows_of(int(first)), model.rows_of(int(second))))
            if a.size and b.size and not K[a][:, b].count_nonzero():
                apart.append((int(first), int(second)))
        if apart:
            listed = ", ".join(f"{a} and {b}" for a, b in apart[:3]) + (
                f" and {len(apart) - 3} more pairs" if len(apart) > 3 else ""
            )
            x, y, z = model.places[np.flatnonzero(model.nodes == apart[0][0])[0]]
            what = "nodes lie on one place and are not connected: the meshes of two parts that touch, but were never joined"
            where, amount = f"nodes {listed}, the first at ({x:.4g}, {y:.4g}, {z:.4g}) m", f"{len(apart)} pair(s)"
            remedy = "Merge them, or join them by an element; if they may slide on each other, leave them"
            found.append(Finding(check="coincident", what=what, where=where, amount=amount, remedy=remedy))
    gone = np.concatenate([empty, unstiff, beside])
    count, label = connected_components(abs(K) + abs(M), directed=False)
    if model.support == "base" and rigid:
        loose = [
            rows
            for k in np.setdiff1d(np.arange(count), label[model.dofs.held])
            if not np.isin(rows := np.flatnonzero(label == k), gone).all()
        ]
        what = "a part hangs on nothing that the base holds"
        remedy = "Join it, or name the nodes on which it stands in the interface"
    elif model.support == "free":
        whole = [rows for k in range(count) if not np.isin(rows := np.flatnonzero(label == k), gone).all()]
        loose = sorted(whole, key=len)[:-1]
        what, remedy = "the structure falls into bodies that are not connected", "Join them, or bring each as a model of its own"
    else:
        loose = []
        what = remedy = ""
    if loose:
        every = np.concatenate(loose)
        amount = f"{len(every)} degrees of freedom in {len(loose)} bod{'y' if len(loose) == 1 else 'ies'}"
        found.append(Finding(check="loose part", what=what, where=model.places_of(every), amount=amount, remedy=remedy))
    if not model.reduced and rigid and len(labels):
        for words, components in (("translation", (1, 2, 3)), ("rotation", (4, 5, 6))):
            rows = np.flatnonzero(np.isin(labels[:, 1], components) & (K.diagonal() > 0))
            diagonal = K.diagonal()[rows]
            hard = rows[diagonal > PENALTY * np.median(diagonal)] if len(rows) else rows
            if hard.size:
                hard = hard[np.argsort(-K.diagonal()[hard])]
                ratio = K.diagonal()[hard[0]] / np.median(diagonal)
                what = f"a {words} is held far more stiffly than all others: a penalty spring, or a rigid link"
                amount = f"{ratio:.3g} times the median, which takes {np.log10(ratio):.0f} of 16 digits from the others"
                remedy = "Use a spring some hundred times as stiff as what it joins, or a rigid link without stiffness"
                found.append(Finding(check="penalty", what=what, where=model.places_of(hard), amount=amount, remedy=remedy))
    gone = np.unique(np.concatenate([gone, *loose])).astype(np.intp) if loose else gone
    return (model.without(gone) if gone.size else model), found


# --- rigid motions ----------------------------------------------------------------------------------------------------------

CURED = 1e-3
"""What is left of the resistance against rigid motions when an explanation is the right one."""


def rigid_motions(model: Submitted, lowest: float | None) -> tuple[Submitted, list[Finding]]:
    """Does K let the six rigid motions pass, and if not, what would make it? The model goes on with what does.

    Parameters
    ----------
    lowest : [rad²/s²], the lowest eigenvalue of the held structure from above; None when it is not known
    """
    K, T, inertia = model.stiffness, model.dofs.rigid, np.diag(model.dofs.rigid.T @ (model.mass @ model.dofs.rigid))
    before = _resistance(K, T)
    if lowest is None or np.any(inertia <= 0):
        strained, amount = before > 1e-4, f"{before:.2g} of what clamping every row would give"
    else:
        scale = 1 / np.sqrt(inertia)
        values, vectors = np.linalg.eigh(scale[:, None] * (T.T @ (K @ T)) * scale)
        worst = int(np.argmax(np.abs(values)))
        strained = abs(values[worst]) > matrices.GROUNDED * lowest
        axis, frequency = MOTIONS[int(np.argmax(np.abs(vectors[:, worst])))], np.sqrt(abs(values[worst])) / (2 * np.pi)
        amount = f"most along {axis}: the free body would oscillate at {frequency:.4g} Hz instead of floating"
    if not strained:
        return model, []
    R, labels = K @ T, model.dofs.labels
    d = np.sqrt(np.maximum(K.diagonal(), 1e-12 * K.diagonal().max()))
    length = np.sqrt(np.trace(T[:, 3:].T @ T[:, 3:]) / max(np.trace(T[:, :3].T @ T[:, :3]), 1e-300))
    local = np.linalg.norm(R / d[:, None] / np.array([*3 * [1.0], *3 * [length]]), axis=1)
    rows = np.flatnonzero(local > 1e-2 * local.max())
    rows = rows[np.argsort(-local[rows])]
    if not len(labels):
        remedy = "Write K without supports, and `rigid` for the same rows in the same order"
        what = "the stiffness resists rigid motions"
        return model, [Finding(check="rigid motions", what=what, where=model.places_of(rows), amount=amount, remedy=remedy)]
    for check, what, where, remedy, made in _explanations(model, R / d[:, None], d, rows):
        if _resistance(K, made) < CURED * before:
            what = f"the stiffness resists rigid motions, but not when {what}"
            finding = Finding(check=check, what=what, where=where, amount=amount, remedy=remedy)
            return replace(model, dofs=replace(model.dofs, rigid=made)), [finding]
    pushed = np.linalg.norm(R[:, :3] / d[:, None], axis=1)
    turned = np.linalg.norm(R[:, 3:] / d[:, None], axis=1) / length
    nodes = list(dict.fromkeys(int(node) for node in labels[rows, 0]))
    grounded = rows[pushed[rows] > 1e-3 * turned.max()]
    if grounded.size or len(nodes) == 1:
        held = grounded if grounded.size else rows
        numbers, counts = np.unique(labels[np.isin(labels[:, 1], (1, 2, 3)), 0], return_counts=True)
        incomplete = np.setdiff1d(labels[:, 0], numbers[counts == 3]).tolist()
        gone = incomplete or np.setdiff1d(model.nodes, labels[:, 0]).tolist()
        if gone and not model.reduced:
            what = "supported degrees of freedom were taken out, and their mass with them: K is tied to the ground beside them"
            lacks = "not all of its three translations" if incomplete else "no row at all"
            where = f"node {', '.join(map(str, gone[:5]))} has {lacks}; K resists at {model.places_of(held)}"
            remedy = "Export K and M before the supports are applied, and name the supported nodes in the interface"
            return model, [Finding(check="restrained", what=what, where=where, amount=amount, remedy=remedy)]
        size = [float(R[row] @ T[row] / max(T[row] @ T[row], 1e-300)) for row in held[:3]]
        said = ", ".join(f"{value:.4g}" for value in size)
        what = "the structure is tied to the ground: a spring or support was left in the stiffness"
        remedy = "Take it out of K and name its node in the interface, or bring the structure as a grounded one"
        amount = f"about {said} N/m or N m/rad there; {amount}"
        return model, [Finding(check="grounded", what=what, where=model.places_of(held), amount=amount, remedy=remedy)]
    if len(nodes) <= 4:
        what = "a link or spring between nodes that are apart has no lever arms: it strains when the whole turns"
        where = f"nodes {', '.join(map(str, nodes))}"
        remedy = "Give the link its lever arms (RBE2, MPC with rotations), or join nodes that lie on one place"
        return model, [Finding(check="link", what=what, where=where, amount=amount, remedy=remedy)]
    what = "the stiffness resists rotations of the whole, not its translations: the coordinates do not belong to it"
    remedy = "Check the coordinates, their unit, the order of the rows and the displacement coordinate systems"
    return model, [Finding(check="coordinates", what=what, where=model.places_of(rows), amount=amount, remedy=remedy)]


def _explanations(model: Submitted, weighed: Array, d: Array, rows: Integers) -> Iterator[tuple[str, str, str, str, Array]]:
    """Rigid motions as they would be without one slip: its check, words, where, remedy and the motions (n, 6)."""
    K, T, labels = model.stiffness, model.dofs.rigid, model.dofs.labels
    physical, lever = labels[:, 1] > 0, np.zeros_like(T)
    lever[:, 3:] = np.where((labels[:, 1] <= 3)[:, None] & physical[:, None], T[:, 3:], 0.0)
    turning = T - lever
    # The unit of length, and degrees for radians: K (turning + s lever) = 0 in the least-squares sense
    a, b = (K @ lever)[:, 3:] / d[:, None], (K @ turning)[:, 3:] / d[:, None]
    if np.any(a) and np.any(b):
        s = -float(np.sum(a * b) / np.sum(a * a))
        if abs(s - 1) > 1e-3 and s > 0:
            known = {
                1e3: "millimetres",
                1e2: "centimetres",
                25.4: "millimetres and inches",
                39.3700787: "inches",
                12.0: "inches and feet",
                3.2808399: "feet",
            }
            named = next((words for factor, words in known.items() if min(abs(s / factor - 1), abs(s * factor - 1)) < 1e-3), "")
            degrees = min(abs(s * np.pi / 180 - 1), abs(s * 180 / np.pi - 1)) < 1e-3
            what = (
                "rotations are in degrees"
                if degrees
                else f"all coordinates are multiplied by {s:.6g}"
                + (f", {named} confused with the unit of the matrices" if named else "")
            )
            remedy = "Write the coordinates in the unit of length of the matrices, or correct `fe_model.units`"
            if degrees:
                remedy = "Write rotations and moments in radians"
            yield "rotations" if degrees else "unit of length", what, "`coordinates`, all of them", remedy, turning + s * lever
    nodes, counts = np.unique(labels[physical, 0], return_counts=True)
    per, uniform = int(counts[0]), bool(np.all(counts == counts[0])) and bool(np.all(physical))
    if uniform and np.all(labels.reshape(-1, per, 2)[:, :, 0] == labels.reshape(-1, per, 2)[:, :1, 0]):
        block = T.reshape(len(nodes), per, 6)
        orders = {
            "the rows run through all nodes component by component": block.transpose(1, 0, 2),
            "the nodes stand in the opposite order": block[::-1],
            "the three rotations of every node stand before its translations": np.roll(block, 3, axis=1) if per == 6 else block,
        }
        remedy = "Write `dof` in the order of the rows of K and M"
        for words, turned in orders.items():
            yield "order of rows", words, "`dof`, all rows", remedy, turned.reshape(-1, 6)
    if not len(model.places) or not uniform:
        return
    place = (
        model.places[np.searchsorted(model.nodes, labels[:, 0], sorter=np.argsort(model.nodes)).clip(max=len(model.nodes) - 1)]
        if np.all(np.diff(model.nodes) > 0)
        else None
    )
    # Another order or sign of the axes of the coordinates: the simplest first
    turns = sorted(
        product(permutations(range(3)), product((1, -1), repeat=3)),
        key=lambda turn: sum(k != p for k, p in enumerate(turn[0])) + sum(sign < 0 for sign in turn[1]),
    )
    if place is not None:
        for order, signs in turns[1:]:
            made, x = turning.copy(), place[:, order] * np.array(signs) - model.reference_point
            for row in range(3):
                chosen = labels[:, 1] == row + 1
                made[chosen, 3:] = np.cross(np.eye(3), x[chosen, None])[:, :, row]
            axes = ", ".join(f"{'-' if sign < 0 else ''}{'xyz'[k]}" for k, sign in zip(order, signs, strict=True))
            remedy = "Write the coordinates in the axes of the displacements"
            yield "axes", f"({axes}) of the coordinates stand for (x, y, z)", "`coordinates`, all of them", remedy, made
    suspects = list(dict.fromkeys(int(node) for node in labels[rows, 0]))[:10]
    for node in suspects:
        own = model.rows_of(node)
        own = own[labels[own, 1] <= 3]
        A = K[:, own].toarray() / d[:, None]
        moved = np.stack([-A @ skew(axis)[labels[own, 1] - 1] for axis in np.eye(3)], axis=-1)  # (n, 3 rotations, 3)
        shift, *_ = np.linalg.lstsq(moved.reshape(-1, 3), -weighed[:, 3:].reshape(-1), rcond=None)
        shift, made = np.where(np.abs(shift) > 1e-9 * np.abs(shift).max(), shift, 0.0), T.copy()
        made[own, 3:] += -skew(shift)[labels[own, 1] - 1]
        x, y, z = shift
        remedy = "Correct its coordinates"
        where = f"node {node}, off by ({-x + 0.0:.4g}, {-y + 0.0:.4g}, {-z + 0.0:.4g}) m"
        yield "node place", f"node {node} lies elsewhere, moved by ({x:.4g}, {y:.4g}, {z:.4g}) m", where, remedy, made
    for first, second in combinations(sorted(suspects), 2):
        made, (a_rows, b_rows) = T.copy(), (model.rows_of(first), model.rows_of(second))
        made[a_rows], made[b_rows] = T[b_rows], T[a_rows]
        yield (
            "order of rows",
            f"nodes {first} and {second} are exchanged",
            f"nodes {first} and {second}",
            "Exchange them in `dof` or in `nodes`",
            made,
        )


# --- mass -------------------------------------------------------------------------------------------------------------------

SOUND = (30.0, 50_000.0)
"""Speeds of sound [m/s] that no material leaves: soft rubber, and four times diamond."""

DENSEST = 50_000.0
"""[kg/m³] of the box about a model, twice what osmium has."""

OF_A_CUBE = 1e7
"""[kg/m³] of the cube about nodes in a plane or on a line, which may be of a heavy body: a slip of lengths makes it 1e9 times."""


def mass(model: Submitted, units: UnitSystem) -> list[Finding]:
    """Is the mass that of a rigid body, is it all there, and in which unit?"""
    T, M, labels, held = model.dofs.rigid, model.mass, model.dofs.labels, model.dofs.held
    rigid = np.asarray(T.T @ (M @ T))
    source, remedy = "the mass", "Check the order of the degrees of freedom, the coordinates and the units"
    said = description.Description(
        source=source, name="", kind="matrices", units=units, reference_point=model.reference_point, stated=model.stated
    )
    by_axis, carried = np.diag(rigid)[:3], float(np.diag(rigid)[:3].mean())
    bare = held[
        (np.asarray(abs(M).sum(axis=1)).ravel()[held] == 0) & (np.asarray(abs(model.stiffness).sum(axis=1)).ravel()[held] > 0)
    ]
    stated = model.stated.mass
    missing = stated is not None and carried < stated - max(description.MASS * stated, 3 * model.stated.mass_tolerance)
    try:
        inertia = description.require_rigid_body((rigid + rigid.T) / 2, source, "mass", remedy)
    except BadInput as error:
        spread = float(np.ptp(by_axis) / max(abs(carried), 1e-300))
        amount = f"{by_axis[0]:.6g} kg along x, {by_axis[1]:.6g} along y, {by_axis[2]:.6g} along z"
        if bare.size and (spread > description.RIGID or missing):
            return [_lost(model, bare, amount)]
        nodes, counts = np.unique(labels[:, 0], return_counts=True)
        if len(labels) and np.all(counts == counts[0]) and not model.reduced:
            blocks = T.reshape(len(nodes), -1, 6)
            others = {
                "component by component, not node by node": blocks.transpose(1, 0, 2),
                "with the nodes in the opposite order": blocks[::-1],
            }
            for words, turned in others.items():
                other = turned.reshape(-1, 6)
                form = other.T @ (M @ other)
                if np.ptp(np.diag(form)[:3]) < description.RIGID * np.trace(form) and _resistance(model.stiffness, T) < 1e-3:
                    what = f"the rows of the mass stand in another order than those of the stiffness: {words}"
                    remedy = "Write K and M for the same rows in the same order"
                    return [Finding(check="order of mass", what=what, where="array `mass`", amount="all rows", remedy=remedy)]
        if spread > description.RIGID:
            # Which node carries another mass along one axis than along another
            rows = np.flatnonzero(np.isin(labels[:, 1:].ravel(), (1, 2, 3))) if len(labels) else np.zeros(0, dtype=np.intp)
            momentum = np.einsum("ij,ij->i", (M @ T)[rows, :3], T[rows, :3])
            numbers, place = np.unique(labels[rows, 0], return_inverse=True) if rows.size else (rows, rows)
            most, least = np.full(len(numbers), -np.inf), np.full(len(numbers), np.inf)
            np.maximum.at(most, place, momentum)
            np.minimum.at(least, place, momentum)
            odd = int(numbers[np.argmax(most - least)]) if rows.size else None
            carried_there = momentum[labels[rows, 0] == odd] if rows.size else momentum
            where = (
                "array `mass`"
                if odd is None
                else f"node {odd}, which carries {', '.join(f'{value:.4g}' for value in carried_there)} kg along x, y, z"
            )
            what = "the mass is not the same along all axes"
            remedy = "Give a point mass all three axes; look for rows of M that were lost or written twice"
            return [Finding(check="mass by axis", what=what, where=where, amount=amount, remedy=remedy)]
        what = f"the mass is that of no rigid body: {error.problem}"
        amount = f"{carried:.6g} kg in all"
        return [Finding(check="rigid body", what=what, where="array `mass`", amount=amount, remedy=remedy)]
    try:
        description.require_as_stated(inertia, said)
    except BadInput as error:
        if error.field == "stated.mass":
            amount = f"{inertia.mass:.6g} kg where {stated:.6g} kg are stated, {inertia.mass / (stated or 1.0):.6g} times as much"
            if "A factor of" not in error.remedy and missing and bare.size:
                return [_lost(model, bare, amount)]
            unit = "A factor of" in error.remedy
            gone = np.setdiff1d(model.nodes, labels[:, 0]).tolist() if len(labels) else []
            more = (
                f" Nodes without rows, such as {gone[0]}, may have had what is missing." if missing and gone and not unit else ""
            )
            what = "the mass is off by the factor of a unit" if unit else "the mass is not the stated one"
            where, remedy = "array `mass`", error.remedy + more
            return [Finding(check="unit of mass" if unit else "total mass", what=what, where=where, amount=amount, remedy=remedy)]
        distance = np.linalg.norm(
            model.reference_point + inertia.first_moment / inertia.mass - (0.0 if model.stated.cog is None else model.stated.cog)
        )
        where = "`coordinates` or `stated.cog`"
        amount = f"{1e3 * distance:.4g} mm apart"
        return [Finding(check="centre of gravity", what=error.problem, where=where, amount=amount, remedy=error.remedy)]
    told = stated is not None or not units.known
    return [] if model.reduced or not len(labels) or told else list(_material(model, inertia.mass))


def _lost(model: Submitted, bare: Integers, amount: str) -> Finding:
    what = "mass was lost on restrained degrees of freedom: the interface has stiffness and no mass"
    remedy = "Export M before the supports are applied: with them, programs leave out the mass of what is held"
    return Finding(check="lost mass", what=what, where=model.places_of(bare), amount=amount, remedy=remedy)


def too_dense(model: Submitted, total: float) -> list[Finding]:
    """Whether the box about the nodes, or where they lie in a plane or on a line the cube of its longest side, is too small."""
    extent = np.ptp(model.places, axis=0) if len(model.places) else np.zeros(3)
    flat = extent.min() <= 0.05 * extent.max()
    volume, most = (extent.max() ** 3, OF_A_CUBE) if flat else (np.prod(extent), DENSEST)
    if not volume or total / volume <= most or model.stated.mass is not None:
        return []
    what, remedy = "the structure is denser than any material", "Check `fe_model.units`: tonnes, kilograms, millimetres"
    amount = f"{total / volume:.4g} kg/m³ of the {'cube' if flat else 'box'} about it, {total:.4g} kg in all"
    return [Finding(check="units", what=what, where="array `mass` and `coordinates`", amount=amount, remedy=remedy)]


def _material(model: Submitted, total: float) -> Iterator[Finding]:
    """Whether any material is so stiff, so slow or so dense: what is left to see a confused unit by when nothing is stated."""
    from scipy.sparse import coo_array

    if dense := too_dense(model, total):
        yield from dense
        return
    labels, M, k, m = model.dofs.labels, model.mass, model.stiffness.diagonal(), model.mass.diagonal()
    order = np.argsort(model.nodes)
    place = model.places[order[np.searchsorted(model.nodes, labels[:, 0], sorter=order).clip(max=len(order) - 1)]]
    pattern = coo_array(model.stiffness)
    i, j = pattern.coords
    apart, near = np.linalg.norm(place[i] - place[j], axis=1), np.full(len(labels), np.inf)
    other = apart > 0
    np.minimum.at(near, i[other], apart[other])
    usable = np.flatnonzero((labels[:, 1] <= 3) & (m > 0) & (k > 0) & np.isfinite(near))
    if not usable.size:
        return
    speeds = np.sqrt(k[usable] / m[usable]) * near[usable] / 1.5
    numbers, which = np.unique(labels[usable, 0], return_inverse=True)
    fastest = np.zeros(len(numbers))
    np.maximum.at(fastest, which, speeds)
    speed, consistent = float(np.median(fastest)), M.count_nonzero() > np.count_nonzero(m)
    if SOUND[0] < speed < SOUND[1] or (speed <= SOUND[0] and not consistent):
        return
    ratio, slips = speed / 5_000.0, {**description.SLIPS, 1e12: "N/mm² and N/m² with metres and millimetres confused"}
    factor = min(slips, key=lambda slip: abs(np.log(max(ratio, 1 / ratio) ** 2 / slip)))
    what = "sound would travel in it as in no material: stiffness, mass and length are not of one system of units"
    amount = f"about {speed:.3g} m/s from node to node; steel has 5000"
    over = f"Stiffness over mass is some {ratio**2:.1g} times that of a metal"
    remedy = f"{over}; the nearest slip is {factor:.4g}: {slips[factor]}. Check `fe_model.units`"
    yield Finding(check="units", what=what, where="arrays `stiffness` and `mass`", amount=amount, remedy=remedy)
