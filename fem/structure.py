"""`Structure`: stiffness and mass of a discretised structure on a base, on the ground or free, however it was made.

Beams, solid elements and a user's own matrices all end here; modes, reduction and dynamic mass start from here and need not know
which it was. The base is six rigid motions of a reference point. It carries some degrees of freedom along (`held`): the flange's
rigid node, the underside of a solid, the interface of a user's model. All others are free (`HeldBase`). A structure on the ground
(`grounded`), or one that floats, has no base and holds nothing.
"""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array, Integers, freeze, rigid_transformation_6, skew

Sparse = Any
"""A `scipy.sparse.csr_array`; SciPy ships no types."""


class Carrier(Protocol):
    """A mesh that knows what moves a point of it."""

    @property
    def parts(self) -> Mapping[str, Any]:
        """Parts that have elements, and what they are made of."""

    @property
    def shells(self) -> tuple[str, ...]:
        """Parts that are shells."""

    def rows(self, points: npt.ArrayLike, names: tuple[str, ...] = ()) -> list[Sparse]:
        """What each degree of freedom moves `points` (p, 3) [m] along x, y, z; (3, n) sparse each."""

    def riding(self, point: Array) -> Sparse:
        """(3, n) what moves `point` (3,) [m], riding along with the nearest point of the mesh."""

    def beside(self, point: Array, steps: Array, moved: Array) -> Array:
        """(s, 3, k) by how much `moved` (n, k) moves what is `steps` (s, 3) [m] beside `point` (3,) [m] otherwise than that."""

    def numbered(self, number: int) -> Sparse | None:
        """What each degree of freedom moves the node of that number in its file, (3, n); None where it has no such node."""

    def unresolved(self, shapes: Array, squares: Array, parts: tuple[str, ...] = ()) -> dict[str, Array]:
        """By part, all or `parts`, (k, k) how much too stiff it is to `shapes` (n, k), modes of omega² `squares` (k,) or of 0."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Structure:
    """Stiffness and mass, and how they follow their base.

    Attributes
    ----------
    stiffness, mass : (n, n) sparse, symmetric, SI, of the unconstrained structure
    elements : where there is a mesh (`fem.mesh.places.Elements`), what carries a point of it
    rigid : (n, 6) what every degree of freedom does in the six unit motions of the reference point (columns: x, y, z [1 per m],
        alpha, beta, gamma [1 per rad]); stiffness @ rigid = 0 unless `grounded`; zero where a model has no coordinates
    held : (b,) degrees of freedom that the base carries along; none of a structure that is grounded or free
    reference_point : (3,) [m], in the article's frame
    points : (p, 3) [m], places where the shape of a mode can be looked at, in the article's frame
    translations, rotations : (p, 3) the degrees of freedom that move those points along x, y, z and turn them about these axes;
        -1 where they are held, of rotations also where nothing turns; rotations may be left empty
    part_stiffness : share of each part in `stiffness`, (n, n) sparse, together all of it; may be left empty
    part_mass : share of each part in `mass`, likewise
    loss_factors : structural loss factor [1] of the parts that have one
    grounded : what ties it to the ground is in `stiffness`
    supports, joints : names in `part_stiffness` that are springs to the ground, and springs between two parts
    places : by name (3, n) sparse, what each degree of freedom moves there along x, y, z; a row is empty where nothing does
    sections : by shell or beam, the shares of `part_stiffness` that grow with the thickness and with its cube
    part_tolerances : by part, standard deviation, relative, of its "modulus", "density", "loss_factor" or "thickness"
    geometric : by part (n, n) sparse, the stiffness that its weight gives or takes under standard gravity (`fem.gravity`)
    """

    stiffness: Sparse
    mass: Sparse
    elements: Carrier | None = None
    rigid: Array
    held: Integers
    reference_point: Array = field(default_factory=lambda: np.zeros(3))
    points: Array = field(default_factory=lambda: np.zeros((0, 3)))
    translations: Integers = field(default_factory=lambda: np.zeros((0, 3), dtype=np.intp))
    part_stiffness: Mapping[str, Sparse] = field(default_factory=lambda: MappingProxyType({}))
    part_mass: Mapping[str, Sparse] = field(default_factory=lambda: MappingProxyType({}))
    loss_factors: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    rotations: Integers = field(default_factory=lambda: np.zeros((0, 3), dtype=np.intp))
    grounded: bool = False
    supports: tuple[str, ...] = ()
    joints: tuple[str, ...] = ()
    places: Mapping[str, Sparse] = field(default_factory=lambda: MappingProxyType({}))
    sections: Mapping[str, tuple[Sparse, Sparse]] = field(default_factory=lambda: MappingProxyType({}))
    part_tolerances: Mapping[str, Mapping[str, float]] = field(default_factory=lambda: MappingProxyType({}))
    geometric: Mapping[str, Sparse] = field(default_factory=lambda: MappingProxyType({}))

    def __post_init__(self) -> None:
        freeze(self, rigid=(self.mass.shape[0], 6), reference_point=(3,))

    @property
    def free(self) -> Integers:
        """Degrees of freedom that the base does not hold, ascending."""
        return np.setdiff1d(np.arange(self.mass.shape[0]), self.held)

    @property
    def floating(self) -> bool:
        """Whether nothing holds it: neither a base nor the ground."""
        return not (len(self.held) or self.grounded)

    @property
    def rigid_mass(self) -> Array:
        """6x6 mass matrix of the whole structure as a rigid body about the reference point (Eq. 1)."""
        M = self.rigid.T @ (self.mass @ self.rigid)
        return np.asarray((M + M.T) / 2)

    @property
    def gyration(self) -> float:
        """[m] Largest radius of gyration about the axes through the CoG; 0 where no mass is known."""
        M = self.rigid_mass
        about_cog = M[3:, 3:] - M[3:, :3] @ np.linalg.pinv(M[:3, :3]) @ M[:3, 3:]
        return float(np.sqrt(np.diag(about_cog).max() / M[0, 0])) if M[0, 0] > 0 else 0.0

    @cached_property
    def weights(self) -> Array:
        """(p, 3) [kg] what resists at each of `points` along x, y, z where all of it shifts."""
        shifted = at_freedoms(np.asarray(self.mass @ self.rigid[:, :3]), self.translations)
        return np.diagonal(shifted, axis1=1, axis2=2)


def at_freedoms(values: Array, freedoms: Integers) -> Array:
    """`values` (n, ...) at `freedoms` of any shape, as a structure's `translations` are; 0 where these are -1, held."""
    found = values[freedoms]
    found[freedoms < 0] = 0.0
    return found


def rigid_motion(points: npt.ArrayLike, reference_point: npt.ArrayLike = (0.0, 0.0, 0.0)) -> Array:
    """All six motions of `points` (p, 3) [m] that ride on the reference point; shape (6 p, 6), point by point (Eq. 3)."""
    offsets = np.asarray(points, dtype=np.float64) - np.asarray(reference_point, dtype=np.float64)
    return np.vstack([rigid_transformation_6(offset) for offset in offsets])


# A place that is a coordinate, in a structure of which no elements are known.

NEIGHBOURS = 8
"""Nodes whose motions are fitted by a rigid one where none of them turns."""

ON_NODE = 1e-6
"""Distance to a node, as a share of that to the farthest of its neighbours, below which the point is the node."""


FAR = 2.0
"""A point lies outside when the nearest node is farther than this many times the widest gap between two neighbouring nodes,"""

OUTSIDE = 0.1
"""[share] and than this of the size of the structure. By definition."""

BRING = "bring what all rows do there as an array places/NAME (3 x n) of its file"
"""What to do where nodes do not tell how a place moves, as modal coordinates bend it, too."""


def place_rows(
    structure: Structure, points: npt.ArrayLike, source: str = "the structure", field: str = "place", *, riding: bool = False
) -> list[Sparse]:
    """What each degree of freedom moves `points` (p, 3) [m], in the article's frame, along x, y, z: (3, n) sparse each.

    In a mesh the element that holds a point carries it. Else it rides on the nearest node and turns with it. Where that has no
    rotations, it follows the rigid motion nearest to those of the nodes around it, weighted with the inverse square of their
    distances: on a node it is the node's own.

    Raises
    ------
    BadInput : the structure knows no nodes, or a point, `field` of the `source`, lies outside its mesh or, unless it is `riding`
        along with the nearest one, far from its nodes, sooner where rows of no node, such as modal coordinates, bend it, too.
    """
    from scipy.sparse import csr_array

    if structure.elements is not None:
        try:
            return list(structure.elements.rows(points))
        except BadInput as error:  # says nothing of who asked
            raise BadInput(source, field, error.problem, error.remedy) from None
    if not len(structure.points):
        known = ", ".join(list(structure.places)[:20]) or "its nodes or degrees of freedom"
        raise BadInput(source, field, "has no known motion: the structure has no coordinates", f"A place is named there: {known}")
    from scipy.spatial import cKDTree

    at = np.asarray(points, dtype=np.float64).reshape(-1, 3)
    away, near = cKDTree(structure.points).query(at, k=min(NEIGHBOURS, len(structure.points)))
    found, n, wide = [], structure.mass.shape[0], np.ptp(structure.points, axis=0).max() or structure.gyration
    unplaced = not structure.rigid.any(axis=1).all()  # rows of no node, which no rigid motion moves: modal coordinates
    for point, distances, nodes in zip(at, away.reshape(len(at), -1), near.reshape(len(at), -1), strict=True):
        first, arm = nodes[0], point - structure.points[nodes[0]]
        far = distances[0] > OUTSIDE * wide and not riding
        if far and (unplaced or distances[0] > FAR * (nearest_node(structure, point)[2] or np.inf)):  # gaps of all are dear
            nearest = "The nearest node is at ({}) m".format(", ".join(f"{x:.6g}" for x in point - arm))
            problem, remedy = f"lies {distances[0]:.4g} m outside of the structure", nearest
            if unplaced:
                problem = f"lies {distances[0]:.4g} m from all nodes, and rows that are of none of these move it, too"
                remedy = f"{nearest}; {BRING}"
            raise BadInput(source, field, problem, remedy)
        turning = structure.rotations[first] if len(structure.rotations) else np.full(3, -1)
        if np.all(turning >= 0):
            rows, values = np.append(structure.translations[first], turning), np.hstack([np.eye(3), -skew(arm)])
        elif distances[0] <= ON_NODE * distances[-1]:
            rows, values = structure.translations[first], np.eye(3)
        else:
            weights = np.repeat(distances[0] / distances, 3)[:, None]
            motions = rigid_motion(structure.points[nodes], point).reshape(-1, 6, 6)[:, :3].reshape(-1, 6)
            size = distances[-1] * np.array([0, 0, 0, 1, 1, 1]) + np.array([1, 1, 1, 0, 0, 0])  # rotations as long as the rest
            fitted = np.linalg.pinv(weights * motions / size, rcond=1e-9)
            rows, values = structure.translations[nodes].ravel(), fitted[:3] * weights.T
        along = np.repeat(np.arange(3), len(rows))
        found.append(csr_array((values.ravel(), (along, np.tile(rows, 3))), shape=(3, n)))
    return found


def rows_beside(structure: Structure, point: Array) -> Sparse:
    """(3, n) what moves a pick-up at `point` (3,) [m], as of `place_rows`; outside it rides along with what is nearest."""
    return structure.elements.riding(point) if structure.elements is not None else place_rows(structure, point, riding=True)[0]


def position_of(structure: Structure, place: str) -> Array | None:
    """(3,) [m] of a named place in the article's frame, by how it turns with the structure, or by the node that it is where that
    does not move in all directions; None where neither says."""
    rows = structure.places[place]
    carried = np.asarray(rows @ structure.rigid)
    if carried.shape != (3, 6) or not np.allclose(carried[:, :3], np.eye(3), atol=1e-6):
        nodes = np.flatnonzero(np.isin(structure.translations, rows.tocoo().col).any(axis=1))  # of a frame in a plane
        return np.array(structure.points[nodes[0]]) if len(nodes) == 1 else None
    turns = carried[:, 3:]  # -[a], a the arm from the reference point
    return np.asarray(structure.reference_point + np.array([turns[1, 2], turns[2, 0], turns[0, 1]]))


BESIDE = (0.01, 0.03, 0.1)
"""Shares of the size of a structure to either side of a place at which its motion and how that changes are taken from the mesh.
The last is as far as a pick-up is plausibly beside its place. Held by user_model/test_frame.py."""

NEARBY = 1e-4
"""Share of the size of a structure by which a place is shifted to see how its motion changes. By definition."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Beside:
    """How what moves a place changes beside it, in pieces of third power along each axis, and straight on beyond the last.

    Attributes
    ----------
    ends : (p + 1,) [m] from the place
    pieces : (4, p, 3, 3, k) by power, from the third down, of metres from where a piece begins; by axis x, y, z along which; what
        each of k coordinates moves it along x, y, z
    """

    ends: Array
    pieces: Array

    def shifted(self, axis: int, by: float) -> tuple[Array, Array]:
        """By how much what moves the place changes `by` [m] beside it along an `axis`, and by a metre more, (3, k) each."""
        within = float(np.clip(by, self.ends[0], self.ends[-1]))
        piece = int(np.clip(np.searchsorted(self.ends, within, "right") - 1, 0, self.pieces.shape[1] - 1))
        third, second, slope, begin = self.pieces[:, piece, axis]
        x = within - self.ends[piece]
        there = slope + x * (2 * second + x * 3 * third)
        return begin + x * (slope + x * (second + x * third)) + (by - within) * there, there


def gradients(structure: Structure, places: Sequence[str], moved: Array) -> dict[str, Beside]:
    """By place how what `moved` (n, k) moves it changes beside it; as the mesh does, or by metres alone where there is none.

    A place is found by how it turns with the whole structure. None of those about which nothing turns and no element is known.
    """
    from scipy.interpolate import CubicSpline

    size = (float(np.ptp(structure.points, axis=0).max()) if len(structure.points) else 0.0) or 1.0
    ends, near, found = size * np.array([*(-share for share in BESIDE[::-1]), 0.0, *BESIDE]), NEARBY * size, {}
    steps = np.asarray(np.kron(np.eye(3), ends[:, None]), dtype=np.float64)
    for name in places:
        if (at := position_of(structure, name)) is None or (structure.elements is None and not len(structure.points)):
            continue
        with suppress(BadInput):  # outside the mesh, or far from all nodes that there are
            if structure.elements is not None:
                ways = structure.elements.beside(at, steps, moved).reshape(3, len(ends), 3, -1)
            else:
                rows = [row @ moved for row in place_rows(structure, at + near * np.vstack([np.eye(3), -np.eye(3)]))]
                ways = ends[:, None, None] / (2 * near) * np.subtract(rows[:3], rows[3:])[:, None]
            found[name] = Beside(ends=ends, pieces=CubicSpline(ends, ways.swapaxes(0, 1)).c)
    return found


def nearest_node(structure: Structure, point: Array) -> tuple[int, float, float]:
    """Number of the node nearest to `point` (3,) [m], its distance, and the widest gap between a node and its nearest [m]."""
    from scipy.spatial import cKDTree

    tree = cKDTree(structure.points)
    distance, node = tree.query(point)
    gaps = tree.query(structure.points, k=2)[0][:, 1] if len(structure.points) > 1 else np.zeros(1)
    return int(node), float(distance), float(gaps.max())


NEAR = 0.1
"""[share] of a structure's size about a node within which what it weighs may be taken away as a mass at that. By definition."""


def removable(structure: Structure, point: npt.ArrayLike | None) -> float:
    """[kg] that can be missing at `point` (3,) [m] at most: what is about it and at the nearest node, or the whole if unknown."""
    most = float(np.diag(structure.rigid_mass)[:3].max()) or np.inf  # without coordinates nothing is known
    if point is None or not len(structure.points):
        return most
    away = np.linalg.norm(structure.points - np.asarray(point), axis=1)
    near = away <= max(NEAR * np.ptp(structure.points, axis=0).max(), away.min())
    return float(np.clip(structure.weights[near].sum(axis=0).max(), 0.0, most))


def limits_of_mass(structure: Structure, point: Array | None, direction: Array) -> tuple[float, float]:
    """[kg] Least and greatest mass at `point`: no more can be missing than is `removable`, whatever the `direction`."""
    return -removable(structure, point), np.inf


AROUND = 0.02
"""[share] of a structure's size by which what sits on it may be beside the surface of its elements. By definition."""


def limits_of_shift(structure: Structure, point: Array | None, direction: Array) -> tuple[float, float]:
    """[m] How far what sits at `point` (3,) can be from there along `direction` (3,) and still be on it, if that is known."""
    if point is None or not len(structure.points):
        return -np.inf, np.inf
    away, size = (structure.points - point) @ direction, float(np.ptp(structure.points, axis=0).max())
    if structure.elements is None and np.ptp(away) <= AROUND * size:  # nobody knows how wide it is
        return -np.inf, np.inf
    parts = {} if structure.elements is None else structure.elements.parts
    wide = AROUND * size + max((one.reach for one in parts.values()), default=0.0)
    return min(float(away.min()), 0.0) - wide, max(float(away.max()), 0.0) + wide


# `HeldBase`: the free part of a structure, and how acceleration of the base loads it.
#
# With u = T u_b + w, where T is the rigid motion and w vanishes on the held degrees of freedom, a driven structure obeys
#
#     M_ff w'' + (C_ff + ...) w' + K_ff w = -P u_b'',   P = (M T)_f,   f = T^T M T u_b'' + P^T w'',
#
# because neither stiffness nor internal damping resists a rigid motion. Modes, direct solution and reduction all start from here.

LOOSE = 100 * float(np.finfo(np.float64).eps)
"""Strain energy of a mode, as a share of what its terms would add up to if none cancelled, below which there is none."""


@dataclass(frozen=True, eq=False, kw_only=True)
class HeldBase:
    """Matrices on the f free degrees of freedom.

    Attributes
    ----------
    stiffness, mass : (f, f) sparse, symmetric
    load : (f, 6) P, load of the free part against unit acceleration of the base about the reference point
    free : (f,) their numbers in the structure
    size : degrees of freedom of the whole structure
    """

    stiffness: Sparse
    mass: Sparse
    load: Array
    free: Integers
    size: int

    def expand(self, free: Array) -> Array:
        """Values (f, n) on the free degrees of freedom written on all of them (N, n), zero where held."""
        whole = np.zeros((self.size, free.shape[1]), dtype=free.dtype)
        whole[self.free] = free
        return whole


def hold(structure: Structure) -> HeldBase:
    """The free part of `structure`."""
    free = structure.free
    return HeldBase(
        stiffness=restricted(structure.stiffness, free),
        mass=restricted(structure.mass, free),
        load=np.asarray((structure.mass @ structure.rigid)[free]),
        free=free,
        size=structure.mass.shape[0],
    )


def restricted(matrix: Sparse, free: Integers) -> Sparse:
    """Rows and columns `free` of a sparse matrix, by columns."""
    from scipy.sparse import csc_array, csr_array

    return csc_array(csr_array(matrix)[free][:, free])


def check_connected(structure: Structure) -> None:
    """Refuse a structure of which something hangs on nothing that the base holds.

    On the ground, or without any hold, no pattern of the matrices shows it: `check_stiff` does.

    Raises
    ------
    CheckFailed : the degrees of freedom of each such body are counted; the parts it belongs to and a point of it are named.
    """
    from scipy.sparse.csgraph import connected_components

    if not len(structure.held):
        return
    count, label = connected_components(abs(structure.stiffness) + abs(structure.mass), directed=False)
    loose = [np.flatnonzero(label == k) for k in np.setdiff1d(np.arange(count), label[structure.held])]
    if loose:
        bodies = "; ".join(f"{len(dofs)} degrees of freedom {_whereabouts(structure, dofs)}".rstrip() for dofs in loose[:3])
        raise CheckFailed(
            f"{len(loose)} {'body is' if len(loose) == 1 else 'bodies are'} not connected to the base: {bodies}. "
            "Let the parts touch, join them, or hold them.",
            bodies=loose,
        )


def check_stiff(held: HeldBase, structure: Structure, values: Array, vectors: Array) -> None:
    """Refuse modes that strain nothing: held, on the ground, or beside its rigid motions, all of a structure must resist.

    Raises
    ------
    CheckFailed : how many modes have zero frequency, and where the first of them moves most.
    """
    if not values.size:
        return
    strain = np.abs(vectors).T * (abs(held.stiffness) @ np.abs(vectors)).T
    loose = values <= LOOSE * strain.sum(axis=1)
    if np.any(loose):
        moving = np.argmax(np.abs(vectors[:, loose][:, 0]))
        where = _whereabouts(structure, held.free[[moving]])
        how = (
            "Beside its rigid motions" if structure.floating else "On the ground" if structure.grounded else "With the base held"
        )
        raise CheckFailed(
            f"{how}, {np.sum(loose)} {'mode has' if np.sum(loose) == 1 else 'modes have'} zero frequency: part of "
            f"the structure floats or swings freely {where}".rstrip()
            + ". Hold it, or stiffen the joint.",
            count=int(np.sum(loose)),
        )


def _whereabouts(structure: Structure, dofs: Integers) -> str:
    """'of part a, b near (x, y, z) mm' as far as the structure knows."""
    parts = [name for name, K in structure.part_stiffness.items() if np.any(K.diagonal()[dofs])]
    there = np.flatnonzero(np.isin(structure.translations, dofs).any(axis=1))
    words = [f"of part {', '.join(parts)}"] if parts else []
    if there.size:
        x, y, z = 1e3 * structure.points[there[0]]
        words.append(f"near ({x:.1f}, {y:.1f}, {z:.1f}) mm")
    return " ".join(words)
