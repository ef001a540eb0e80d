"""Elements of a structure, and what moves a point of them: found by coordinates, carried by the functions of its element."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import combinations

import numpy as np
import numpy.typing as npt

from fem.beam.elements import IN_XY, IN_XZ, SIGN_XZ, beam_axes, moduli, rods, shape_functions, timoshenko
from fem.mesh import shells, solids
from fem.mesh.constraints import fitted
from fem.mesh.description import PartTable
from fem.mesh.files import Cells
from fem.structure import Sparse
from geometry.errors import BadInput
from geometry.frames import Array, Integers, rigid_transformation, rigid_transformation_6, skew

OUTSIDE = 0.02
"""[share of an element's size] Distance up to which a place counts as lying on a flat skin of the mesh. By definition."""

SHARP = 60.0
"""[degrees] by which faces turn at an edge of the body; by less they are flat sides of a round one. By definition."""

ALIKE = 1 + 1e-9
"""[1] Ratio of two distances up to which they are one. By definition."""

LINE, ROD = "line2", "rod2"
"""Beams, and rods between two nodes, which push and pull and neither bend nor turn anything."""

SIX = np.arange(6)

ENERGY_TOO_HIGH = 2.0
"""[1] What the stiffness of a mesh of solids is too high by, in energy of the jumps of its strains: from 0.7 to 2.3 in 43 modes
of five structures of ten-node tetrahedra against CalculiX on finer meshes, to 4 and once 6.8 where one or two hexahedra of second
order are the whole width. Held by test_mesh_elements.py."""

OF_JUMPS = {"hex8": 0.75, **dict.fromkeys(shells.TRIANGLES, 0.25)}
"""[1] Share of the energy of jumps that tells as much as that of other kinds: what is too high was 0.2 to 1.6 times the whole in
26 modes of hexahedra of eight nodes, and -0.8 to 1.0 times in 72 of shells, which do not meet along their edges and may be too
soft. Held likewise."""

UPRIGHT = 1e-3
"""[1] Sine of the angle to a shell's normal below which a direction says nothing of it. By definition."""

QUARTERS = {
    "tet": ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)),
    "wedge": ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
    "hex": ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
}
"""Corners of the faces of a solid element, by its shape."""

TRACE = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
"""What makes of a strain, as `solids.strains` has it, the sum of its diagonal."""

Piece = tuple[Integers, Callable[[], tuple[Array, Array]]]
"""Elements of a part: numbers (c, k) of their corners; overlaps (c, k, k) of their functions, and at the corners strains
(c, k, s, m) the square of whose length is a density of energy."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Block(Cells):
    """Elements of one kind and part, lengths in metres."""

    part: str

    @property
    def turning(self) -> bool:
        """Whether its nodes turn."""
        return self.kind != ROD and self.kind not in solids.KINDS

    def only(self, some: Integers) -> "Block":
        """`some` of its elements, by their indices in it."""
        axes, offsets = (None if one is None else one[some] for one in (self.axes, self.offsets))
        loose = None if self.loose is None else self.loose[some]
        return replace(self, tags=self.tags[some], nodes=self.nodes[some], axes=axes, offsets=offsets, loose=loose)

    def corners(self, points: Array, some: slice | int = slice(None)) -> Array:
        """Where `some` elements are, (c, k, 3) or of one (k, 3): at their nodes, which are at `points`, or off them."""
        return np.asarray(points[self.nodes[some]] + (0.0 if self.offsets is None else self.offsets[some]))

    def fibres(self, points: Array, x_axis: Array | None) -> Array:
        """The first axis (c, 3) of its layers: the part's, or that which the element states, or its first side where neither is.

        Where that is upright the z of the frame, as in Abaqus, or the x where that is upright, too.
        """
        corners = self.corners(points)
        side, other = (corners[:, k] - corners[:, 0] for k in (1, 2))
        stated = self.axes if x_axis is None else x_axis[None]
        if stated is None:
            return side
        found, normal = side, np.cross(side, other)
        for one in (np.array([[1.0, 0.0, 0.0]]), np.array([[0.0, 0.0, 1.0]]), stated):
            across, *both = (np.linalg.norm(each, axis=1)[:, None] for each in (np.cross(one, normal), one, normal))
            found = np.where(across > UPRIGHT * both[0] * both[1], one, found)
        return np.where(np.isfinite(stated).all(axis=1, keepdims=True), found, side)

    def beam_axes(self, k: int, points: Array, table: PartTable) -> Array:
        """`beam_axes` of its beam `k`: the part's go before those that the element states.

        Raises
        ------
        ValueError : the z axis of its section lies along it, or nobody states it of a bar of bulk data.
        """
        stated = None if self.axes is None else self.axes[k]
        if table.z_axis is None and stated is not None and not np.isfinite(stated).all():
            raise ValueError("the bar states no direction")
        return beam_axes(self.corners(points, k), stated if table.z_axis is None else table.z_axis)

    def beam(self, k: int, points: Array, table: PartTable, mass: bool = False) -> tuple[float, Array]:
        """Length of its beam `k`, and what the ends of that do, in its own axes, of what its nodes do; (12, 12).

        Where it does not bend about its nodes, its ends are pulled along the neutral axis; or its `mass` is there.

        Raises
        ------
        ValueError : the z axis of its section lies along it.
        """
        section, line = table.section, np.diff(self.corners(points, k), axis=0)
        if section is None:
            raise ValueError(f"`section` of part {self.part} must be given")
        length, R = float(np.linalg.norm(line)), self.beam_axes(k, points, table)
        neutral = rigid_transformation_6([0.0, *section.neutral_axis])
        if not mass:
            neutral[1:3, 3] = 0.0
        T = np.kron(np.eye(2), np.kron(np.eye(2), section.turned) @ neutral @ np.kron(np.eye(2), R))
        if self.offsets is not None:
            for end, off in zip((slice(0, 6), slice(6, 12)), self.offsets[k], strict=True):
                T[:, end] = T[:, end] @ rigid_transformation_6(off)
        if self.loose is not None and (loose := self.loose[k]).any():
            K = timoshenko(section.times(1.0), length, self.part).stiffness[self.part]
            ends = np.diag(np.where(loose, 0.0, 1.0))  # what is loose goes where the beam pulls it
            ends[np.ix_(loose, ~loose)] = -np.linalg.pinv(K[np.ix_(loose, loose)]) @ K[np.ix_(loose, ~loose)]
            T = ends @ T
        return length, np.asarray(T, dtype=np.float64)


AS_ONE = 0.01
"""[1] Ratio of motions up to which two ends go as one: a frame's, clamped as stiffly as four digits of a frequency ask, differ by
0.002. Held by user_model/test_frame.py."""

WITHIN = 0.01
"""[share] of the way to the middle of an element at which its slopes are asked of a point on its surface. By definition."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Foot:
    """The point of an element nearest to another.

    Attributes
    ----------
    part, tag : the part it belongs to, and the element's number
    point : (3,) [m]
    distance : [m]
    size : [m] of the element
    reach : [m] how far the surface of a shell or beam is from the element
    nodes : (k,) of the element
    moved : (3, m) what the degrees of freedom `dofs` (m,) move there
    turned : (3, m) and turn there; None in a solid
    """

    part: str
    tag: int
    point: Array
    distance: float
    size: float
    reach: float
    nodes: Integers
    dofs: Integers
    moved: Array
    turned: Array | None


def _away(bounds: Array, point: Array) -> Array:
    """(e,) how far `point` (3,) is from boxes whose corners are `bounds` (e, 2, 3)."""
    return np.asarray(np.linalg.norm(np.maximum(0, np.maximum(bounds[:, 0] - point, point - bounds[:, 1])), axis=1))


@dataclass(frozen=True, eq=False, kw_only=True)
class Elements:
    """A mesh that is being made, or has been made, into a structure.

    Attributes
    ----------
    source : the file, for messages
    node_tags : (p,) numbers of nodes in the file, 0 where it has none
    points : (p, 3) [m]
    blocks : elements
    parts : as described
    first : (p,) first degree of freedom of each node: x, y, z, then three rotations where it is `turning` (p,)
    own : (m,) which of the structure's n degrees of freedom each of these m is; -1 where it rides on others or is held
    carried : (m, n) sparse; what the structure's degrees of freedom make of them
    """

    source: str
    node_tags: Integers
    points: Array
    blocks: tuple[Block, ...]
    parts: Mapping[str, PartTable]
    first: Integers
    turning: npt.NDArray[np.bool_]
    own: Integers
    carried: Sparse

    def rows(self, points: npt.ArrayLike, names: tuple[str, ...] = ()) -> list[Sparse]:
        """What each degree of freedom of the structure moves `points` (p, 3) [m] along x, y, z; (3, n) sparse each.

        Raises
        ------
        BadInput : a point outside the mesh; its distance and the nearest point of the mesh are said.
        """
        found = np.asarray(points, dtype=np.float64).reshape(-1, 3)
        named = names or tuple(f"({', '.join(f'{1e3 * value:.4g}' for value in point)}) mm" for point in found)
        return [self.motion(point, name)[:3] for point, name in zip(found, named, strict=True)]

    def beside(self, point: Array, steps: Array, moved: Array) -> Array:
        """(s, 3, k) by how much `moved` (n, k) moves what is `steps` (s, 3) [m] beside `point` (3,) [m] otherwise than there, in
        the one piece nearest: of ends that go as one each from its own, so that nothing jumps where a joint comes to give.

        Which ends do says the `moved` that asks first.

        Raises
        ------
        BadInput : as of `rows`.
        """
        from scipy.sparse import vstack

        asked = point.tobytes() + steps.tobytes()
        if (rows := self._asked.get(asked)) is None:
            pieces = self._about(point, float(np.linalg.norm(steps, axis=1).max()), moved)
            on = [min(pieces, key=lambda one: one.nearest(there).distance) for there in point + steps]
            rows = vstack([one.riding(point + step) - one.riding(point) for one, step in zip(on, steps, strict=True)])
            self._asked[asked] = rows
        return np.asarray(rows @ moved).reshape(len(steps), 3, -1)

    @cached_property
    def _asked(self) -> dict[bytes, Sparse]:
        """What was asked of `beside`, (3 s, n) each: a structure is reduced again and again, its mesh stays."""
        return {}

    def _about(self, point: Array, reach: float, moved: Array) -> list["Elements"]:
        """Pieces of it, whose elements share nodes, one with the next, within `reach` [m] of `point` (3,) [m]: that which holds
        it, and those that end there and go, where `moved` (n, k) moves them, as that does.

        Raises
        ------
        BadInput : as of `rows`.
        """
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        foot, (bounds, owner), count = self.foot_of(point, ""), self._boxes, len(self.points)
        near = owner[_away(bounds, point) <= max(reach, foot.distance * ALIKE)]
        blocks = [block.only(near[near[:, 0] == k, 1]) for k, block in enumerate(self.blocks)]
        pairs = np.vstack([np.column_stack([np.repeat(b.nodes[:, 0], b.nodes.shape[1]), b.nodes.ravel()]) for b in blocks])
        graph = coo_array((np.ones(len(pairs)), pairs.T), shape=(count, count))
        piece, kept = connected_components(graph, directed=False)[1], list[Elements]()
        goes = self._sparse(foot.moved, foot.dofs) @ moved
        for one in np.unique(piece[pairs[:, 0]]):
            there = [block.only(np.flatnonzero(piece[block.nodes[:, 0]] == one)) for block in blocks]
            found = replace(self, blocks=tuple(block for block in there if len(block.tags)))
            end = found.nearest(point)
            meets = end.distance <= foot.distance + WITHIN * foot.size
            if meets and np.linalg.norm(self._sparse(end.moved, end.dofs) @ moved - goes) <= AS_ONE * np.linalg.norm(goes):
                kept.append(found)
        return kept

    def riding(self, point: Array) -> Sparse:
        """(3, n) what moves `point` (3,) [m], riding along with the nearest point of the mesh."""
        foot = self.nearest(point)
        rows = self._sparse(foot.moved, foot.dofs)
        if foot.distance:
            for arm, slope in zip(point - foot.point, self._slopes(foot), strict=True):
                rows = rows + arm * slope
        return rows

    def _slopes(self, foot: Foot) -> list[Sparse]:
        """How what each degree of freedom moves `foot` changes by a metre along x, y, z; (3, n) each.

        It is asked just within the element that holds the point: across a joint motion jumps, and outside nothing moves.
        """
        inward = WITHIN * (self.points[foot.nodes].mean(axis=0) - foot.point)
        at, step = foot.point + inward, 0.01 * WITHIN * foot.size
        ahead, behind = ([self.motion(at + sign * axis, "", foot.part)[:3] for axis in step * np.eye(3)] for sign in (1, -1))
        return [(one - other) / (2 * step) for one, other in zip(ahead, behind, strict=True)]

    def numbered(self, number: int) -> Sparse | None:
        """What each degree of freedom moves the node of that number in its file, (3, n); None where it has no such node."""
        index = np.flatnonzero((self.node_tags == number) & (self.node_tags > 0))
        return self.node(int(index[0]))[:3] if len(index) else None

    def rigid(self, reference_point: Array) -> Array:
        """What each degree of freedom (n,) of the structure does in the six motions of `reference_point`; (n, 6)."""
        return np.asarray(self.rigid_everywhere(reference_point)[self.own >= 0])

    def rigid_everywhere(self, reference_point: Array) -> Array:
        """What each degree of freedom (m,) does in them, also those that ride or are held; (m, 6)."""
        whole, offsets = np.zeros((len(self.own), 6)), self.points - reference_point
        for axis, (j, k) in enumerate(((1, 2), (2, 0), (0, 1))):
            rows = self.first + axis
            whole[rows, axis] = 1.0
            whole[rows, 3 + j], whole[rows, 3 + k] = offsets[:, k], -offsets[:, j]
            whole[self.first[self.turning] + 3 + axis, 3 + axis] = 1.0
        return whole

    def foot_of(self, point: Array, name: str, part: str | None = None) -> Foot:
        """The foot of `point` (3,) [m] on the mesh, or on one `part` of it, that carries it.

        Raises
        ------
        BadInput : it lies outside.
        """
        foot = self.nearest(point, part)
        allowed = max(OUTSIDE * foot.size, 1.001 * foot.reach)
        if foot.distance > allowed and foot.distance > self._bulge(foot):
            near = ", ".join(f"{1e3 * value:.5g}" for value in foot.point)
            problem = (
                f"lies {1e3 * foot.distance:.4g} mm outside {'the mesh' if part is None else f'part {part}'}; "
                f"the nearest point is ({near}) mm in element {foot.tag} of {foot.part}"
            )
            raise BadInput(self.source, name, problem, "Correct the coordinates, or their unit")
        return foot

    def motion(self, point: Array, name: str, part: str | None = None) -> Sparse:
        """What moves and turns `point` (3,) [m] of the mesh, or of one `part` of it; (6, n) sparse.

        Raises
        ------
        BadInput : as `foot_of`.
        """
        foot = self.foot_of(point, name, part)
        moved, turned = foot.moved, foot.turned
        if turned is None:
            turned = fitted(self.points[foot.nodes], foot.point)[3:]
        else:
            moved = moved - skew(point - foot.point) @ turned
        return self._sparse(np.vstack([moved, turned]), foot.dofs)

    def node(self, index: int) -> Sparse:
        """What moves and turns a node, (6, n); in a solid it turns with the elements at it."""
        own = self.first[index] + np.arange(6 if self.turning[index] else 3)
        if self.turning[index]:
            return self._sparse(np.eye(6), own)
        beside = [block.nodes[(block.nodes == index).any(axis=1)].ravel() for block in self.blocks]
        nodes = np.unique(np.concatenate(beside))
        turned = fitted(self.points[nodes], self.points[index])
        dofs = np.append(own, (self.first[nodes][:, None] + np.arange(3)).ravel())
        whole = np.zeros((6, len(dofs)))
        whole[:3, :3], whole[3:, 3:] = np.eye(3), turned[3:]
        return self._sparse(whole, dofs)

    def mean(self, nodes: Integers, point: Array, turning: bool = True, weights: Array | None = None) -> Sparse:
        """The rigid motion of `nodes`, seen at `point` (3,) [m], nearest to what they do; (6, n).

        Rotations of nodes count as displacements at an arm as long as the group is wide; if not `turning`, they do not count.
        By `weights` (p,) the arm is the mean distance to the point, as in Nastran.

        Raises
        ------
        BadInput : nodes that leave one of the six motions open.
        """
        offsets = self.points[nodes] - self.points[nodes].mean(axis=0)
        wide = float(np.sqrt(np.mean(np.sum(offsets**2, axis=1))))
        wide = wide or float(np.ptp(self.points, axis=0).max()) * 1e-3
        shares = np.sqrt(np.ones(len(nodes)) if weights is None else weights)
        arm = wide if weights is None else float(np.linalg.norm(self.points[nodes] - point, axis=1).mean()) or wide
        blocks, dofs, counts = [], [], []
        for index, share in zip(nodes.tolist(), shares.tolist(), strict=True):
            T = np.zeros((6, 6))
            T[:3] = rigid_transformation(self.points[index] - point)
            T[3:, 3:] = np.eye(3)
            count = 6 if turning and self.turning[index] else 3
            blocks.append(T[:count])
            dofs.append(self.first[index] + np.arange(count))
            counts.append(share * np.array([1.0, 1.0, 1.0, arm, arm, arm])[:count])
        W, scale = np.concatenate(counts), np.array([1.0, 1.0, 1.0, wide, wide, wide])
        A = W[:, None] * np.vstack(blocks) / scale
        if np.linalg.svd(A, compute_uv=False)[-1] < 1e-6:
            problem = f"{len(nodes)} node(s) that lie in a line or a point and do not turn cannot say how they turn"
            raise BadInput(self.source, "groups", problem, "Name more nodes, or a place in a face")
        return self._sparse(np.linalg.pinv(A) * W / scale[:, None], np.concatenate(dofs))

    def _sparse(self, rows: Array, dofs: Integers) -> Sparse:
        from scipy.sparse import csr_array

        where = np.repeat(np.arange(len(rows)), len(dofs)), np.tile(dofs, len(rows))
        return csr_array(csr_array((rows.ravel(), where), shape=(len(rows), self.carried.shape[0])) @ self.carried)

    def nearest(self, point: Array, part: str | None = None) -> Foot:
        """The foot of `point` (3,) [m] on the mesh, or on one `part` of it."""
        bounds, owner = self._boxes
        away = _away(bounds, point)
        if part is not None:
            away[np.array([block.part != part for block in self.blocks])[owner[:, 0]]] = np.inf
        best: Foot | None = None
        for k in np.argsort(away, kind="stable"):
            if best is not None and (away[k] > best.distance * ALIKE or best.distance == 0):
                break
            block = self.blocks[owner[k, 0]]
            for foot in self._feet(block, int(owner[k, 1]), point):  # at an edge of two shells the thicker one reaches further
                if best is None or (foot.distance / (ALIKE if foot.reach > best.reach else 1.0) < best.distance):
                    best = foot
        if best is None or not np.isfinite(best.distance):
            raise ValueError(f"`part` must have elements, found {part!r}")
        return best

    def unresolved(self, shapes: Array, squares: Array, parts: tuple[str, ...] = ()) -> dict[str, Array]:
        """By part, all or `parts`, (k, k): how much too stiff its elements are to `shapes` (n, k), by jumps of strains.

        [unit of shapes]² N/m; of part and mode it is the share of omega² that the mesh leaves unsure. `squares` (k,) are omega²
        of shapes that are modes, else 0: beams are exact between their ends but for what their own mass bends.
        """
        from scipy.sparse import csr_array

        whole = self.carried @ shapes
        found: dict[str, Array] = {}
        for part in parts or self.parts:
            nodes = np.unique(np.concatenate([block.nodes.ravel() for block in self.blocks if block.part == part]))
            own = (self.first[nodes][:, None] + SIX)[self.turning[nodes][:, None] | (SIX < 3)]
            moved, k = whole, shapes.shape[1]
            if few := len(own) < k:  # of a small part each degree of freedom by itself
                moved, k = np.zeros((len(whole), len(own))), len(own)
                moved[own, np.arange(k)] = 1.0
            for pieces in filter(None, (self._solid_pieces(part, moved), self._shell_pieces(part, moved))):
                corners, at = np.unique(np.concatenate([each.ravel() for each, _ in pieces]), return_inverse=True)
                places = np.split(at, np.cumsum([each.size for each, _ in pieces[:-1]]))
                mean, weight, energy = np.zeros((0, 0)), np.zeros((len(corners), 1)), np.zeros((k, k))
                for (each, made), where in zip(pieces, places, strict=True):
                    overlaps, strains = made()
                    mean = mean if mean.size else np.zeros((len(corners), strains.size // each.size))
                    met, there = np.unique(where, return_inverse=True)  # of all corners a piece has few
                    extents = np.repeat(overlaps.sum(axis=(1, 2)), each.shape[1])
                    gather = csr_array((extents, (there, np.arange(each.size))), shape=(len(met), each.size))
                    mean[met] += gather @ strains.reshape(each.size, -1)
                    weight[met, 0] += gather.sum(axis=1)
                mean /= weight
                for (_, made), where in zip(pieces, places, strict=True):
                    overlaps, strains = made()
                    jumps = mean[where].reshape(strains.shape) - strains
                    spread = np.einsum("cab,cbtm->catm", overlaps, jumps, optimize=True)
                    energy += jumps.reshape(-1, k).T @ spread.reshape(-1, k)
                energy = whole[own].T @ energy @ whole[own] if few else energy
                found[part] = found.get(part, 0.0) + (energy + energy.T) / 2
            if any(block.part == part and block.kind == LINE for block in self.blocks):
                found[part] = found.get(part, 0.0) + self._bowed(part, whole * squares)
        return found

    def _bowed(self, part: str, pushed: Array) -> Array:
        """Energy (k, k) by which the beams of a part bow between their ends where their mass is `pushed` (n, k) [m/s²]."""
        X, W = np.polynomial.legendre.leggauss(6)
        x, w, energy = (1 + X) / 2, W / 2, np.zeros((pushed.shape[1], pushed.shape[1]))
        bows = np.array([x**2 * (1 - x) ** 2, x**2 * (1 - x) ** 2 * (2 * x - 1)])
        bent = np.array([2 - 12 * x + 12 * x**2, -2 + 24 * x - 60 * x**2 + 40 * x**3])
        A, a = np.linalg.inv((bent * w) @ bent.T), x * (1 - x)
        for block in self.blocks:
            table = self.parts[part]
            if block.part != part or block.kind != LINE or table.section is None:
                continue
            beam = table.section.times(1.0)
            for k, nodes in enumerate(block.nodes):
                L, T = block.beam(k, self.points, table)
                own = T @ pushed[(self.first[nodes][:, None] + SIX).ravel()]
                for planar, sign, bending, shear in (
                    (IN_XY, np.ones(4), beam.bending_z, beam.shear_y),
                    (IN_XZ, SIGN_XZ, beam.bending_y, beam.shear_z),
                ):
                    if not bending:
                        continue
                    v = shape_functions(x, 12 * bending / (shear * L**2), L)[0]
                    load = beam.mass * L * ((bows * w) @ (v.T @ (sign[:, None] * own[planar])))
                    energy += L**3 / bending * load.T @ A @ load
                for ends, mass, stiffness in (
                    ((0, 6), beam.mass, beam.axial),
                    ((3, 9), beam.rotary_y + beam.rotary_z, beam.torsion),
                ):
                    pull = mass * L * ((a * w) @ np.column_stack([1 - x, x])) @ own[list(ends)]
                    energy += 3 * L / stiffness * np.outer(pull, pull) if stiffness else 0.0
        return energy

    def _solid_pieces(self, part: str, moved: Array) -> list[Piece]:
        """Solids of a part where all degrees of freedom are `moved` (n, m), some at a time."""
        made: list[Piece] = []
        for block in self.blocks:
            if block.part != part or block.kind not in solids.KINDS:
                continue
            E, mu = moduli(self.parts[part].material, part)
            lam = mu * (E - 2 * mu) / (3 * mu - E)
            root = np.asarray(np.linalg.cholesky(2 * mu * np.eye(6) + lam * np.outer(TRACE, TRACE)), dtype=np.float64)
            step = max(solids.BATCH // (block.nodes.shape[1] * 6 * moved.shape[1]), 1)

            def piece(kind: str, nodes: Integers, lam: float = lam, mu: float = mu, root: Array = root) -> tuple[Array, Array]:
                own = solids.strains(kind, self.points[nodes], moved[self.first[nodes][:, :, None] + np.arange(3)], lam, mu)
                return OF_JUMPS.get(kind, 1.0) * solids.overlaps(kind, self.points[nodes]), np.einsum(
                    "st,cbsm->cbtm", root, own, optimize=True
                )

            pieces = (block.nodes[first : first + step] for first in range(0, len(block.nodes), step))
            made += [(nodes, partial(piece, block.kind, nodes)) for nodes in pieces]
        return made

    def _shell_pieces(self, part: str, moved: Array) -> list[Piece]:
        """Triangles of the shells of a part likewise; a corner is that of a sheet, so that nothing is seen to jump at a fold."""
        thickness = self.parts[part].thickness or 0.0
        of = [block for block in self.blocks if block.part == part and block.kind in shells.TRIANGLES]
        if not of:
            return []
        own = [
            (block.nodes[:, list(corners)], block.corners(self.points)[:, list(corners)], OF_JUMPS[block.kind] * weight)
            for block in of
            for corners, weight in shells.TRIANGLES[block.kind]
        ]
        nodes, where = (np.concatenate([one[k] for one in own]) for k in (0, 1))
        weights = np.concatenate([np.full(len(one), share) for one, _, share in own])
        beside = any(block.offsets is not None for block in of)
        E, mu = moduli(self.parts[part].material, part)
        nu = E / (2 * mu) - 1
        root = np.linalg.cholesky(E / (1 - nu**2) * ((1 - nu) * np.eye(6) + nu * np.outer(TRACE, TRACE)))
        corners = shells.sheets(self.points[nodes], nodes)[:, None] * len(self.points) + nodes
        step = max(solids.BATCH // (3 * 24 * moved.shape[1]), 1)

        def piece(at: slice) -> tuple[Array, Array]:
            dofs = (self.first[nodes[at]][:, :, None] + np.arange(6)).reshape(-1, 18)
            u = shells.carried(where[at] - self.points[nodes[at]]) @ moved[dofs] if beside else moved[dofs]
            strains = shells.strains(where[at], u, thickness)
            strains = np.einsum("st,cbxsm->cbxtm", root, strains.reshape(*strains.shape[:2], 4, 6, -1), optimize=True)
            areas = weights[at] * shells.areas(where[at])
            return areas[:, None, None] / 12 * (np.ones((3, 3)) + np.eye(3)), strains.reshape(*strains.shape[:2], 24, -1)

        return [(corners[at], partial(piece, at)) for at in (slice(n, n + step) for n in range(0, len(nodes), step))]

    @property
    def shells(self) -> tuple[str, ...]:
        """Parts that are shells."""
        return tuple(part for part in self.parts if any(one.part == part and one.kind in shells.TRIANGLES for one in self.blocks))

    def _bulge(self, foot: Foot) -> float:
        """How far [m] a round skin may lie outside its flat sides at `foot`, by how much the sides beside it turn."""
        triangles, _ = self.skin()
        corners = self.points[triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), np.finfo(np.float64).tiny)
        own = np.isin(triangles, foot.nodes).all(axis=1)
        own &= np.abs(np.einsum("ti,ti->t", normals, foot.point - corners[:, 0])) < 1e-6 * foot.size
        largest = 0.0
        for k in np.flatnonzero(own):
            beside = np.isin(triangles, triangles[k]).sum(axis=1) == 2
            turns = np.arccos(np.minimum(np.abs(normals[beside] @ normals[k]), 1.0))
            largest = max(largest, float(turns[turns < np.radians(SHARP)].max(initial=0.0)))
        return 1.05 * foot.size / 2 * float(np.tan(largest / 4))

    def skin(self) -> tuple[Integers, Integers]:
        """Triangles (t, 3) and lines (l, 2) by the indices of their nodes; of a solid with nodes along its edges the corners.

        Faces of solids that no other shares, shells, and beams as lines.
        """
        faces: dict[int, list[Integers]] = {3: [], 4: []}
        triangles, lines = [np.zeros((0, 3), dtype=np.int64)], [np.zeros((0, 2), dtype=np.int64)]
        for block in self.blocks:
            if block.kind in solids.KINDS:
                for corners in QUARTERS[solids.shape(block.kind)]:
                    faces[len(corners)].append(block.nodes[:, list(corners)])
            elif block.kind in (LINE, ROD):
                lines.append(block.nodes)
            else:  # the triangles of a quadrangle are there twice, once by either diagonal
                own = shells.TRIANGLES[block.kind]
                count = round(sum(weight for _, weight in own))
                triangles += [block.nodes[:, list(corners)] for corners, _ in own[:count]]
        for found in faces.values():
            if found:
                every = np.vstack(found)
                _, first, times = np.unique(np.sort(every, axis=1), axis=0, return_index=True, return_counts=True)
                outer = every[first[times == 1]]
                triangles.append(outer[:, :3])
                if outer.shape[1] == 4:
                    triangles.append(outer[:, [0, 2, 3]])
        return np.vstack(triangles), np.vstack(lines)

    @cached_property
    def _boxes(self) -> tuple[Array, Integers]:
        """Corners (e, 2, 3) of the boxes around all elements, and their block and index in it (e, 2)."""
        corners = [block.corners(self.points) for block in self.blocks]
        bounds = np.vstack([np.stack([each.min(axis=1), each.max(axis=1)], axis=1) for each in corners])
        owner = [np.column_stack([np.full(len(each), k), np.arange(len(each))]) for k, each in enumerate(corners)]
        return bounds, np.vstack(owner)

    def _feet(self, block: Block, index: int, point: Array) -> Iterator[Foot]:
        nodes = block.nodes[index]
        corners, table = block.corners(self.points, index), self.parts[block.part]
        size = float(np.ptp(corners, axis=0).max())

        def made(foot: Array, reach: float, dofs: Integers, moved: Array, turned: Array | None) -> Foot:
            away = float(np.linalg.norm(point - foot))
            known = {"part": block.part, "tag": int(block.tags[index]), "size": size, "reach": reach, "nodes": nodes}
            distance = 0.0 if away < 1e-9 * size else away
            return Foot(point=foot, distance=distance, dofs=dofs, moved=moved, turned=turned, **known)

        if block.kind in solids.KINDS:
            _, N = solids.located(block.kind, corners, point)
            foot, dofs = N @ corners, (self.first[nodes][:, None] + np.arange(3)).ravel()
            moved = np.asarray(np.kron(N, np.eye(3)), dtype=np.float64)
            yield made(foot, 0.0, dofs, moved, None)
            return
        if block.kind in (LINE, ROD):
            section = table.section
            share = float(
                np.clip((point - corners[0]) @ (corners[1] - corners[0]) / np.sum((corners[1] - corners[0]) ** 2), 0, 1)
            )
            foot = corners[0] + share * (corners[1] - corners[0])
            if block.kind == ROD:
                dofs = (self.first[nodes][:, None] + np.arange(3)).ravel()
                yield made(foot, table.reach, dofs, np.hstack([(1 - share) * np.eye(3), share * np.eye(3)]), None)
            elif section is not None:
                six = (self.first[nodes][:, None] + np.arange(6)).ravel()
                # What the twelve degrees of freedom of the beam move and turn there, (3, 12) each, in the frame
                beam, (length, T) = section.times(1.0), block.beam(index, self.points, table)
                moved, turned = np.zeros((2, 3, 12))
                moved[0, [0, 6]] = turned[0, [3, 9]] = 1 - share, share
                for planar, sign, bending, shear, row in (
                    (IN_XY, np.ones(4), beam.bending_z, beam.shear_y, 1),
                    (IN_XZ, SIGN_XZ, beam.bending_y, beam.shear_z, 2),
                ):
                    v, theta = shape_functions(np.array([share]), 12 * bending / (shear * length**2), length)
                    moved[row, planar] = sign * v[:, 0]
                    turned[3 - row, planar] = sign * theta[:, 0] * (1 if row == 1 else -1)
                moved, turned = (section.turned.T @ one @ T for one in (moved, turned))
                y, z = section.neutral_axis  # along which `moved` pulls
                moved[0] += y * turned[2] - z * turned[1]
                R = block.beam_axes(index, self.points, table)
                moved, turned = np.asarray(R.T @ moved), np.asarray(R.T @ turned)
                yield made(foot, table.reach, six, moved, turned)
            return
        for triangle, _ in shells.TRIANGLES[block.kind]:
            own = corners[list(triangle)]
            L = _on_triangle(own, point)
            moved = shells.displacement(own[None], L[None])[0, 0]
            if block.offsets is not None:
                moved = moved @ shells.carried(block.offsets[[index]][:, list(triangle)])[0]
            turned = np.hstack([np.hstack([np.zeros((3, 3)), weight * np.eye(3)]) for weight in L])
            dofs = (self.first[nodes[list(triangle)]][:, None] + np.arange(6)).ravel()
            yield made(L @ own, table.thickness or 0.0, dofs, moved, turned)


def _on_triangle(corners: Array, point: Array) -> Array:
    """Area coordinates (3,) of the point of a triangle (3, 3) nearest to `point`."""
    inside = np.linalg.lstsq((corners[1:] - corners[0]).T, point - corners[0], rcond=None)[0]
    L = np.array([1 - inside.sum(), *inside])
    if L.min() >= 0:
        return L
    best, distance = L, np.inf
    for a, b in combinations(range(3), 2):
        edge = corners[b] - corners[a]
        share = float(np.clip((point - corners[a]) @ edge / (edge @ edge), 0, 1))
        away = float(np.linalg.norm(point - corners[a] - share * edge))
        if away < distance:
            best, distance = np.zeros(3), away
            best[[a, b]] = 1 - share, share
    return best


# Matrices: element by element in batches, the lower half of each, part by part.

BATCH = 6_000_000
"""Entries of element matrices at a time: what an assembly needs beside its result."""

STEP = 1e-4
"""Relative change of a thickness for the derivative of a beam's stiffness, which is then right to its square."""


def assembled(elements: Elements) -> tuple[dict[str, Sparse], dict[str, Sparse], dict[str, tuple[Sparse, Sparse]]]:
    """Stiffness and mass of each part, and the shares of stiffness that grow with its thickness and with the cube of it."""
    stiffness, mass, sections = {}, {}, {}

    def freedoms(nodes: Integers, width: int) -> Integers:
        """Of the first `width` motions of each of the `nodes` (c, k); (c, k width)."""
        return np.asarray((elements.first[nodes][:, :, None] + SIX[:width]).reshape(len(nodes), -1))

    for name, part in elements.parts.items():
        kinds = {"K": _Sum(elements), "M": _Sum(elements), "linear": _Sum(elements), "cubic": _Sum(elements)}
        E, mu = moduli(part.material, name)
        nu, density = E / (2 * mu) - 1, part.material.density
        for block in elements.blocks:
            if block.part != name:
                continue
            if block.kind in solids.KINDS:
                lam, size = mu * (E - 2 * mu) / (3 * mu - E), 3 * block.nodes.shape[1]
                for some in _batches(len(block.nodes), size):
                    nodes = block.nodes[some]
                    K, M = solids.matrices(block.kind, elements.points[nodes], lam, mu, density)
                    kinds["K"].add(freedoms(nodes, 3), K)
                    kinds["M"].add(freedoms(nodes, 3), M)
            elif block.kind == ROD:
                if part.section is None:
                    raise ValueError(f"`section` of part {name} must be given")
                K, M = rods(elements.points[block.nodes], part.section.times(1.0))
                kinds["K"].add(freedoms(block.nodes, 3), K)
                kinds["M"].add(freedoms(block.nodes, 3), M)
            elif block.kind == LINE:
                dofs = freedoms(block.nodes, 6)
                K, M, D = _beams(elements, block, part)
                kinds["K"].add(dofs, K)
                kinds["M"].add(dofs, M)
                if part.varied:
                    kinds["linear"].add(dofs, (3 * K - D) / 2)
                    kinds["cubic"].add(dofs, (D - K) / 2)
            else:
                fibres = block.fibres(elements.points, part.x_axis)
                for triangle, share in shells.TRIANGLES[block.kind]:
                    for some in _batches(len(block.nodes), 18):
                        nodes, corners = block.nodes[some][:, triangle], block.corners(elements.points, some)[:, triangle]
                        if part.laminate is not None:
                            off = corners - elements.points[nodes]
                            flat, bent, M = shells.layered(corners, part.laminate, fibres[some], off)
                        else:
                            flat, bent, M = shells.matrices(corners, part.thickness or 0.0, E, nu, density)
                        if block.offsets is not None and part.laminate is None:
                            T = shells.carried(corners - elements.points[nodes])
                            flat, bent, M = (T.swapaxes(1, 2) @ one @ T for one in (flat, bent, M))
                        dofs = freedoms(nodes, 6)
                        kinds["linear"].add(dofs, share * flat)
                        kinds["cubic"].add(dofs, share * bent)
                        kinds["K"].add(dofs, share * (flat + bent))
                        kinds["M"].add(dofs, share * M)
        stiffness[name], mass[name] = kinds["K"].whole(), kinds["M"].whole()
        if kinds["cubic"].there:
            sections[name] = kinds["linear"].whole(), kinds["cubic"].whole()
    return stiffness, mass, sections


def _batches(count: int, size: int) -> Iterator[slice]:
    step = max(BATCH // size**2, 1)
    return (slice(k, k + step) for k in range(0, count, step))


def _beams(elements: Elements, block: Block, part: PartTable) -> tuple[Array, Array, Array]:
    """Stiffness, mass and derivative of stiffness by the logarithm of the thickness of beams; (c, 12, 12) each."""
    if part.section is None:
        raise ValueError(f"`section` of part {block.part} must be given")
    sections = (
        [part.section.times(factor) for factor in (1.0, 1 + STEP, 1 - STEP)] if part.varied else 3 * [part.section.times(1.0)]
    )
    made: dict[float, tuple[Array, Array, Array]] = {}
    whole = np.zeros((3, len(block.nodes), 12, 12))
    for k in range(len(block.nodes)):
        try:
            (length, T), (_, moved) = (block.beam(k, elements.points, part, mass) for mass in (False, True))
        except ValueError:
            problem = f"the z axis of its section lies along element {block.tags[k]}, or the deck states none"
            where = f"parts.{block.part}.section"
            raise BadInput(elements.source, where, problem, "State another z_axis") from None
        if (length := round(length, 12)) not in made:
            plain, more, less = (timoshenko(section, length, block.part) for section in sections)
            slope = (more.stiffness[block.part] - less.stiffness[block.part]) / (2 * STEP)
            made[length] = plain.stiffness[block.part], plain.mass, slope
        for target, local, by in zip(whole[:, k], made[length], (T, moved, T), strict=True):
            target[:] = by.T @ local @ by
    return whole[0], whole[1], whole[2]


class _Sum:
    """Element matrices added into one of the structure: lower halves, kept degrees of freedom only, links last."""

    def __init__(self, elements: Elements) -> None:
        self.elements = elements
        riding = np.diff(elements.carried.indptr) > 0
        self.linked = bool(np.any(riding & (elements.own < 0)))
        self.number = np.arange(len(elements.own)) if self.linked else elements.own
        self.size = len(elements.own) if self.linked else elements.carried.shape[1]
        self.there = False
        self.half: Sparse = None

    def add(self, dofs: Integers, blocks: Array) -> None:
        from scipy.sparse import coo_array

        self.there = True
        own = self.number[dofs].astype(np.int32)
        rows, columns = np.broadcast_to(own[:, :, None], blocks.shape), np.broadcast_to(own[:, None, :], blocks.shape)
        lower = (rows >= columns) & (columns >= 0)
        added = coo_array((blocks[lower], (rows[lower], columns[lower])), shape=(self.size, self.size)).tocsr()
        self.half = added if self.half is None else self.half + added

    def whole(self) -> Sparse:
        from scipy.sparse import csr_array, tril

        if self.half is None:
            return csr_array((self.elements.carried.shape[1],) * 2)
        whole = csr_array(self.half + tril(self.half, -1, format="csr").T)
        if not self.linked:
            return whole
        T = self.elements.carried
        return symmetric(T.T @ whole @ T)


def symmetric(A: Sparse) -> Sparse:
    from scipy.sparse import csr_array

    return csr_array((A + A.T) / 2)
