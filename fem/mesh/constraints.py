"""Linear equations between motions of nodes: what a deck ties, couples and makes rigid, and which motions follow which.

An equation is a sum that is zero, of terms (coefficient, node, motion), motions numbered as `MOTIONS` are. That of the first term
is meant to follow those of the others. Coefficients of rotations are lengths beside those of translations.
"""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from fem.mesh import solids
from fem.structure import Sparse
from geometry.frames import Array, Integers, rigid_transformation, rigid_transformation_6, skew

Term = tuple[float, int, int]
Sum = tuple[Term, ...]
"""Terms (coefficient, node, motion from 0 to 5)."""

NamedSum = tuple[tuple[float, int | str, int], ...]
"""The same, where a node may be called by a group that it is, or a link that it carries."""

Motion = tuple[int, int]
"""Of a node, from 0 to 5."""

NOTHING = 1e-10
"""[1] Share of the largest coefficient of an equation below which one is none: rounding. By definition."""

LOOSE_END = 1e-9
"""[1] Least share of the largest singular value of what six motions say of a rigid body, below which one is open."""


def following(
    points: Mapping[int, Array],
    motions: Sequence[Motion],
    leading: Mapping[Motion, float],
    axes: Mapping[int, Array],
    arm: float = 0.0,
) -> list[Sum]:
    """`motions` that follow the rigid motion nearest to what the `leading` ones do, by their weights (least squares).

    Six of those tell it exactly. Rotations among them count at an `arm`, else at one as long as all is wide. All are along the
    `axes` (3, 3) of their nodes, as rows, where these have some.

    Raises
    ------
    ValueError : they leave a rigid motion open.
    """
    middle = np.mean([points[node] for node, _ in leading], axis=0) if leading else np.zeros(3)
    wide = max((float(np.linalg.norm(points[node] - middle)) for node, _ in (*leading, *motions)), default=0.0) or 1.0

    def rows(some: Iterable[Motion]) -> Array:  # of the six motions of a body, rotations by what they move at its rim
        turned = (
            np.kron(np.eye(2), axes.get(node, np.eye(3)))[way] @ rigid_transformation_6(points[node] - middle)
            for node, way in some
        )
        return np.array(list(turned)).reshape(-1, 6) * [1.0, 1.0, 1.0, *3 * [1 / wide]]

    W = np.array([weight * ((arm or wide) ** 2 if way > 2 else 1.0) for (_, way), weight in leading.items()])
    A = rows(leading)
    if not leading or not np.linalg.cond(A.T * W @ A) < 1 / LOOSE_END:
        raise ValueError("what leads leaves open how a rigid body moves")
    T = rows(motions) @ np.linalg.solve(A.T * W @ A, A.T * W)
    T[np.abs(T) < NOTHING * np.abs(T).max(axis=1, keepdims=True)] = 0.0
    return [following_one(one, zip(row.tolist(), leading, strict=True)) for one, row in zip(motions, T, strict=True)]


def following_one(one: Motion, leading: Iterable[tuple[float, Motion]]) -> Sum:
    """`one` motion that is the sum of others by their shares."""
    return ((1.0, *one), *((-share, *motion) for share, motion in leading if share))


def without(sums: Iterable[Sum], idle: Callable[[Motion], bool]) -> list[Sum]:
    """What each of `sums` says where motions that are `idle`, which nothing else moves or resists, follow the others."""
    rows, on = list[dict[Motion, float]](), dict[Motion, set[int]]()
    for k, one in enumerate(sums):
        rows.append({})
        for factor, node, way in one:
            rows[k][node, way] = rows[k].get((node, way), 0.0) + factor
            on.setdefault((node, way), set()).add(k)
    sizes = [max(map(abs, row.values()), default=0.0) for row in rows]
    for node in sorted({motion[0] for motion in on if idle(motion)}):
        ways = [motion for motion in on if motion[0] == node and idle(motion)]
        while some := [(abs(rows[k][motion]), k, motion) for motion in ways for k in on[motion]]:
            size, first, motion = max(some)
            ways.remove(motion)
            row, others = rows[first], on.pop(motion)
            if size > LOOSE_END * sizes[first]:  # by more than rounding
                rows[first] = {motion: 0.0}
                for other in row.keys() - {motion}:
                    on[other] = on[other] - {first} | others - {first}
                for k in others - {first}:
                    share = rows[k][motion] / row[motion]
                    rows[k] |= {other: rows[k].get(other, 0.0) - share * factor for other, factor in row.items()}
            for k in others:
                del rows[k][motion]
    return [
        tuple((factor, *motion) for motion, factor in row.items() if abs(factor) > NOTHING * size)
        for row, size in zip(rows, sizes, strict=True)
    ]


# Surfaces: faces of elements, and what ties a node to the face that it lies on.

FACES: Mapping[str, tuple[tuple[int, ...], ...]] = {
    "tet4": ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)),
    "tet10": ((0, 1, 2, 4, 5, 6), (0, 3, 1, 7, 8, 4), (1, 3, 2, 8, 9, 5), (2, 3, 0, 9, 7, 6)),
    "wedge6": ((0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)),
    "wedge15": (
        *((0, 1, 2, 6, 7, 8), (3, 5, 4, 11, 10, 9)),
        *((0, 3, 4, 1, 12, 9, 13, 6), (1, 4, 5, 2, 13, 10, 14, 7), (2, 5, 3, 0, 14, 11, 12, 8)),
    ),
    "hex8": ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)),
    "hex20": (
        *((0, 1, 2, 3, 8, 9, 10, 11), (4, 7, 6, 5, 15, 14, 13, 12), (0, 4, 5, 1, 16, 12, 17, 8)),
        *((1, 5, 6, 2, 17, 13, 18, 9), (2, 6, 7, 3, 18, 14, 19, 10), (3, 7, 4, 0, 19, 15, 16, 11)),
    ),
    **{f"tri{n}": (tuple(range(n)),) for n in (3, 6)},
    **{f"quad{n}": (tuple(range(n)),) for n in (4, 8)},
}
"""Nodes of the faces of an element in the order of Abaqus: corners, then the middles of edges."""


def _block(face: Array) -> tuple[str, Array, Integers]:
    """A face (k, 3) as a solid on both sides of it: its kind, its nodes (m, 3), and which of the face each stands over (m,)."""
    count = 3 if len(face) in (3, 6) else 4
    corners, middles = np.arange(count), np.arange(count, len(face))
    over = np.concatenate([corners, corners, middles, middles, corners[: count if len(middles) else 0]])
    high = np.repeat([-1.0, 1.0, -1.0, 1.0, 0.0], [count, count, len(middles), len(middles), len(over) - 2 * len(face)])
    up = np.cross(face[1] - face[0], face[2] - face[0])
    up = 0.5 * float(np.linalg.norm(np.ptp(face, axis=0))) * up / np.linalg.norm(up)
    return {3: "wedge6", 6: "wedge15", 4: "hex8", 8: "hex20"}[len(face)], face[over] + high[:, None] * up, over


def areas(face: Array) -> Array:
    """Of each node (k,) of a face (k, 3) the area that its function covers; of an edge all are alike."""
    if len(face) == 2 or np.linalg.matrix_rank(face[1:3] - face[0], tol=LOOSE_END * np.ptp(face)) < 2:
        return np.ones(len(face))
    kind, nodes, over = _block(face)
    return np.bincount(over, weights=solids.overlaps(kind, nodes[None])[0].sum(axis=1)) / float(
        np.linalg.norm(np.ptp(face, axis=0))
    )


def foot(face: Array, point: Array) -> tuple[float, Array]:
    """How far `point` (3,) is from a face (k, 3), and the functions (k,) of the nearest point of it."""
    kind, nodes, over = _block(face)
    N = np.bincount(over, weights=solids.located(kind, nodes, point)[1]).astype(np.float64)
    return float(np.linalg.norm(point - N @ face)), N


def tied(
    slaves: Mapping[int, Array],
    faces: Sequence[Sequence[int]],
    points: Mapping[int, Array],
    turning: Callable[[int], bool],
    tolerance: float | None,
) -> tuple[list[Sum], int, float]:
    """Each of the `slaves` as the face nearest to it moves it there, how many lie further than `tolerance`, and that.

    It is a twentieth of the mean size of the faces where none is given, as in Abaqus. A node off its face turns with it.
    """
    from scipy.spatial import cKDTree

    corners = [np.array([points[node] for node in face]) for face in faces]
    middles = np.array([own.mean(axis=0) for own in corners])
    sizes = np.array([float(np.linalg.norm(np.ptp(own, axis=0))) for own in corners])
    tree, reach = cKDTree(middles), 0.05 * float(sizes.mean()) if tolerance is None else tolerance
    found, away = list[Sum](), 0
    for node, point in slaves.items():
        near = tree.query_ball_point(point, float(sizes.max()) / 2 + reach) or [int(tree.query(point)[1])]
        distance, N, best = np.inf, np.zeros(0), near[0]
        for k in sorted(near, key=lambda k: float(np.linalg.norm(middles[k] - point))):
            if distance > NOTHING * sizes[k] and (one := foot(corners[k], point))[0] < distance:
                (distance, N), best = one, k
        if distance > reach:
            away += 1
            continue
        own = faces[best]
        if node in own:
            continue
        R = np.kron(N, np.eye(3))
        if distance > NOTHING * sizes[best]:
            R = R - skew(point - N @ corners[best]) @ fitted(corners[best], N @ corners[best])[3:]
        motions = [(other, way) for other in own for way in range(3)]
        found += [following_one((node, way), zip(R[way].tolist(), motions, strict=True)) for way in range(3)]
        if turning(node) and all(map(turning, own)):
            shares = list(zip(N.tolist(), own, strict=True))
            found += [following_one((node, way), [(share, (other, way)) for share, other in shares]) for way in (3, 4, 5)]
    return found, away, reach


def fitted(points: Array, centre: Array) -> Array:
    """The rigid motion (6, 3 k) about `centre` nearest to what `points` (k, 3) do; a turn that they leave open is none."""
    T = np.vstack([rigid_transformation(point - centre) for point in points])
    wide = float(np.abs(points - centre).max()) or 1.0
    scale = np.array([1.0, 1.0, 1.0, *3 * [1 / wide]])
    return np.asarray(scale[:, None] * np.linalg.pinv(T * scale, rcond=1e-9))


# Which motions follow: one of each equation, by those that are free.


def eliminated(
    sums: Iterable[Sequence[tuple[float, int]]], riding: Sparse, held: npt.NDArray[np.bool_], kept: npt.NDArray[np.bool_]
) -> dict[int, dict[int, float]]:
    """Of every equation the degree of freedom that follows, and by how much each of those that are free moves it.

    It is that of its first term unless this follows others already, is `held` (m,), or is to be `kept` (m,); then that of the
    largest coefficient. One that says nothing new is passed over. `riding` (m, m) are those that ride on links.
    """
    found, rank = dict[int, dict[int, float]](), dict[int, int]()
    rides = np.diff(riding.indptr) > 0

    def leading(dof: int) -> Iterator[tuple[int, float]]:
        if dof in found:
            return iter(found[dof].items())
        some = slice(riding.indptr[dof], riding.indptr[dof + 1])
        return zip(riding.indices[some].tolist(), riding.data[some].tolist(), strict=True)

    for terms in sums:
        free, todo, new = defaultdict[int, float](float), defaultdict[int, float](float), [(dof, of) for of, dof in terms]
        while new or todo:
            for dof, factor in new:
                if not held[dof]:
                    (todo if dof in found or rides[dof] else free)[dof] += factor
            first = min(todo, key=lambda dof: rank.get(dof, -1), default=-1)  # what follows leads none that followed before it
            new = [(other, todo[first] * share) for other, share in leading(first)] if todo else []
            todo.pop(first, None)
        largest = max((abs(factor) for factor, _ in terms), default=0.0)
        able = {dof: factor for dof, factor in free.items() if abs(factor) > NOTHING * largest}
        movable = [dof for dof in able if not kept[dof]]
        if movable:
            follower = terms[0][1] if terms[0][1] in movable else max(movable, key=lambda dof: abs(able[dof]))
            rank[follower] = len(found)
            found[follower] = {dof: -factor / able[follower] for dof, factor in able.items() if dof != follower}
    return found


def matrix(found: Mapping[int, Mapping[int, float]], size: int) -> Sparse:
    """By how much each degree of freedom moves those that follow it; (`size`, `size`)."""
    from scipy.sparse import coo_array

    listed = [(value, row, column) for row, own in found.items() for column, value in own.items()]
    values, r, c = np.array(listed, dtype=np.float64).reshape(-1, 3).T
    return coo_array((values, (r.astype(np.intp), c.astype(np.intp))), shape=(size, size)).tocsr()
