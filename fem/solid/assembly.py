"""`SolidMesh`, curved second-order cells of parts, whoever made them, and their stiffness and mass.

Tetrahedra have 10 nodes and hexahedra 27, both in scikit-fem's local order: vertices, edges, faces, interior. Its elements,
mappings and quadrature are contracted cell by cell, in batches.

The stiffness of isotropic elasticity between node a, direction i, and node b, direction j, of a cell is

    K = integral( lambda d_i N_a d_j N_b + mu d_j N_a d_i N_b + mu delta_ij grad N_a . grad N_b ) dV,

Lamé's lambda and mu those of the cell's part; the mass is integral(rho N_a N_b) dV in each direction (Hughes, The Finite
Element Method, chapters 2 and 7). A vector form of scikit-fem visits the 81 x 81 pairs of a hexahedron's functions one after the
other; the gradients of its scalar functions, contracted for many cells at once, are the same sum in a fraction of it. A test
holds the result against scikit-fem's own form.
"""

import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from itertools import combinations
from typing import Any

import numpy as np

from fem.beam.elements import moduli
from fem.structure import Sparse
from geometry.article import Material
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array, Integers, freeze, frozen

_VERTICES = ([0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1])
_EDGES = ([1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1])
LOCAL_TET10 = frozen(np.vstack([_VERTICES, np.array(_EDGES) / 2]), (10, 3), "LOCAL_TET10")
"""Places of the nodes in the reference tetrahedron (10, 3)."""

_HEX = (
    "222 221 212 122 211 121 112 111 "  # 1 and 2 are the low and the high end, 0 the middle, of x, y and z
    "220 202 022 201 021 210 012 120 102 011 101 110 "
    "200 002 020 010 001 100 000"
)
_END = {"1": 0.0, "2": 1.0, "0": 0.5}
LOCAL_HEX27 = frozen([[_END[place] for place in node] for node in _HEX.split()], (27, 3), "LOCAL_HEX27")
"""Places of the nodes in the reference hexahedron (27, 3)."""

NODES_OF_A_CELL = (10, 27)


@dataclass(frozen=True, eq=False, kw_only=True)
class SolidMesh:
    """Cells of second order, conforming.

    Attributes
    ----------
    points : (p, 3) [m], in the article's frame; every one belongs to a cell
    cells : (c, 10) tetrahedra or (c, 27) hexahedra, indices into `points`
    part : (c,) index into `parts`
    parts : names of the parts
    """

    points: Array
    cells: Integers
    part: Integers
    parts: tuple[str, ...]

    def __post_init__(self) -> None:
        freeze(self, points=(len(self.points), 3))
        if self.cells.shape[1] not in NODES_OF_A_CELL:
            raise ValueError(f"`cells` must have {' or '.join(map(str, NODES_OF_A_CELL))} nodes, found {self.cells.shape[1]}")
        if len(self.part) != len(self.cells):
            raise ValueError(f"`part` must name the part of every cell, found {len(self.part)} for {len(self.cells)} cells")


# One silent gmsh at a time, always put away again.
#
# gmsh is a single set of global variables. Its own handling of Ctrl-C ends the whole process and works in the main thread only,
# so it is switched off: an interruption is raised by Python as soon as gmsh returns.

_ALONE = threading.Lock()


@contextmanager
def session() -> Iterator[Any]:
    """The `gmsh` module, initialised with an empty model and nothing on the terminal; finalised at the end of the block.

    Raises
    ------
    RuntimeError : the host program has a gmsh of its own open, which would be overwritten.
    """
    import gmsh

    with _ALONE:
        if gmsh.isInitialized():
            raise RuntimeError("gmsh is in use by the calling program; call gmsh.finalize() before massline makes a mesh")
        gmsh.initialize(argv=[], readConfigFiles=False, interruptible=False)
        try:
            gmsh.option.setNumber("General.Terminal", 0)
            gmsh.option.setNumber("General.NumThreads", 1)
            yield gmsh
        finally:
            gmsh.finalize()


def require_gmsh() -> None:
    """Raise ModuleNotFoundError here where gmsh is not installed, rather than in the process that is to work with it."""
    if find_spec("gmsh") is None:
        raise ModuleNotFoundError("No module named 'gmsh'", name="gmsh")


QUADRATURE = {10: 5, 27: 5}
"""Order of the rule by nodes of a cell: exact for the mass of straight cells, ample for slightly curved ones."""

BATCH = 1000
"""Cells at a time: bounds the memory of gradients at all quadrature points."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Matrices:
    """Of the unconstrained solid; degrees of freedom 3 p + (0, 1, 2) are x, y, z of point p.

    Attributes
    ----------
    stiffness, mass : (3 p, 3 p) sparse [N/m], [kg]
    part_stiffness : share of each part in the stiffness
    """

    stiffness: Sparse
    mass: Sparse
    part_stiffness: Mapping[str, Sparse]


def assemble(mesh: SolidMesh, materials: Mapping[str, Material]) -> Matrices:
    """Stiffness and mass of `mesh`; `materials` gives each part's.

    Raises
    ------
    BadInput : a material without a usable Young's modulus or Poisson's ratio.
    """
    constants = {name: lame(materials[name], name) for name in mesh.parts}
    W, values, reference = _reference(mesh.cells.shape[1])
    shares, mass = {}, _zero(mesh)
    for index, name in enumerate(mesh.parts):
        own = np.flatnonzero(mesh.part == index)
        K, M = _zero(mesh), _zero(mesh)
        lam, mu = constants[name]
        for cells, mapping in _mappings(mesh, own):
            volume = np.abs(np.linalg.det(mapping)) * W  # (c, q) at the quadrature points
            gradients = np.einsum("cqji,jkq->cikq", np.linalg.inv(mapping), reference, optimize=True)
            K += _scattered(mesh, cells, _stiffness(gradients, volume, lam, mu))
            M += _scattered(mesh, cells, _mass(values, volume, materials[name].density))
        shares[name], mass = K, mass + M
    return Matrices(stiffness=sum(shares.values(), _zero(mesh)), mass=mass, part_stiffness=shares)


def _stiffness(gradients: Array, volume: Array, lam: float, mu: float) -> Array:
    """Isotropic elasticity: lam div u div v + 2 mu sym(grad u) : sym(grad v) over each cell, (c, k, 3, k, 3)."""
    weighted = gradients * volume[:, None, None, :]
    pairs = np.array([[a @ b.transpose(0, 2, 1) for b in gradients.swapaxes(0, 1)] for a in weighted.swapaxes(0, 1)])
    blocks = np.einsum("ijcab->caibj", lam * pairs) + np.einsum("jicab->caibj", mu * pairs)
    blocks[:, :, range(3), :, range(3)] += mu * np.einsum("iicab->cab", pairs)
    return np.asarray(blocks)


def _mass(values: Array, volume: Array, density: float) -> Array:
    """Density times u . v over each cell, (c, k, 3, k, 3)."""
    scalar = density * np.einsum("aq,cq,bq->cab", values, volume, values, optimize=True)
    return np.asarray(np.einsum("cab,ij->caibj", scalar, np.eye(3)))


def lame(material: Material, part: str = "part") -> tuple[float, float]:
    """Lamé's first constant and the shear modulus [Pa].

    Raises
    ------
    BadInput : as `fem.beam.elements.moduli`; it names the `part`.
    """
    E, mu = moduli(material, part)
    return mu * (E - 2 * mu) / (3 * mu - E), mu


def jacobians(mesh: SolidMesh) -> Array:
    """Determinants of the mapping (c, q) [m³] at the quadrature points of every cell; a cell with one below zero is inverted."""
    found = [np.linalg.det(mapping) for _, mapping in _mappings(mesh, np.arange(len(mesh.cells)))]
    return np.concatenate(found) if found else np.zeros((0, 0))


def volumes(mesh: SolidMesh) -> Array:
    """Volume (c,) [m³] of every cell, exact for curved ones; negative where a cell is inside out."""
    W, _, _ = _reference(mesh.cells.shape[1])
    return np.asarray(jacobians(mesh) @ W)


def _reference(nodes: int) -> tuple[Array, Array, Array]:
    """Weights (q,), values (k, q) and gradients (3, k, q) of the functions in the reference cell."""
    from skfem import ElementHex2, ElementTetP2
    from skfem.quadrature import get_quadrature

    element = {10: ElementTetP2, 27: ElementHex2}[nodes]()
    X, W = get_quadrature(element.refdom, QUADRATURE[nodes])
    pairs = [element.lbasis(X, k) for k in range(nodes)]
    values = np.array([np.broadcast_to(value, W.shape) for value, _ in pairs])
    return W, values, np.array([[np.broadcast_to(d, W.shape) for d in gradient] for _, gradient in pairs]).transpose(1, 0, 2)


def _mappings(mesh: SolidMesh, cells: Integers) -> Iterator[tuple[Integers, Array]]:
    """Batches of `cells` with the derivative of the isoparametric map, (c, q, 3, 3): dx_i / dX_j."""
    _, _, gradients = _reference(mesh.cells.shape[1])
    for first in range(0, len(cells), BATCH):
        batch = cells[first : first + BATCH]
        yield batch, np.einsum("cki,jkq->cqij", mesh.points[mesh.cells[batch]], gradients, optimize=True)


def _zero(mesh: SolidMesh) -> Sparse:
    from scipy.sparse import csr_array

    return csr_array((3 * len(mesh.points), 3 * len(mesh.points)))


def _scattered(mesh: SolidMesh, cells: Integers, blocks: Array) -> Sparse:
    """The batch's cell matrices added into one of the whole solid."""
    from scipy.sparse import coo_array

    dofs = (3 * mesh.cells[cells][:, :, None] + np.arange(3)).reshape(len(cells), -1)
    rows = np.broadcast_to(dofs[:, :, None], (*dofs.shape, dofs.shape[1]))
    shape = (3 * len(mesh.points), 3 * len(mesh.points))
    return coo_array((blocks.ravel(), (rows.ravel(), rows.swapaxes(1, 2).ravel())), shape=shape).tocsr()


# A mesh and its matrices as plain arrays and back, for the cache: symmetric ones by their lower half.
#
# The mass is the same in all three directions and does not couple them, so that one third of its rows says it all.

Arrays = dict[str, np.ndarray]


def pack_mesh(mesh: SolidMesh) -> Arrays:
    """`mesh` as arrays."""
    return {"points": mesh.points, "cells": mesh.cells, "part": mesh.part, "parts": np.array(mesh.parts)}


def unpack_mesh(arrays: Mapping[str, np.ndarray]) -> SolidMesh:
    """What `pack_mesh` packed."""
    parts = tuple(str(name) for name in arrays["parts"])
    return SolidMesh(points=arrays["points"], cells=arrays["cells"], part=arrays["part"], parts=parts)


def pack_matrices(matrices: Matrices) -> Arrays:
    """`matrices` as arrays; the parts' shares of the stiffness in their order."""
    mass = {f"mass-{name}": array for name, array in _lower(matrices.mass[::3, ::3]).items()}
    shares = enumerate(matrices.part_stiffness.values())
    return mass | {f"{index}-{name}": array for index, K in shares for name, array in _lower(K).items()}


def unpack_matrices(arrays: Mapping[str, np.ndarray], parts: Sequence[str]) -> Matrices:
    """What `pack_matrices` packed, for `parts`; exactly symmetric."""
    from scipy.sparse import csr_array, eye_array, kron

    shares = {name: _symmetric(arrays, str(index)) for index, name in enumerate(parts)}
    first, *others = shares.values()
    mass = csr_array(kron(_symmetric(arrays, "mass"), eye_array(3), format="csr"))
    return Matrices(stiffness=sum(others, first), mass=mass, part_stiffness=shares)


def _lower(matrix: Sparse) -> Arrays:
    from scipy.sparse import tril

    half = tril(matrix, format="csr")
    half.eliminate_zeros()
    return {"data": half.data, "indices": half.indices.astype(np.int32), "starts": half.indptr.astype(np.int64)}


def _symmetric(arrays: Mapping[str, np.ndarray], name: str) -> Sparse:
    from scipy.sparse import csr_array, tril

    starts = arrays[f"{name}-starts"]
    half = csr_array((arrays[f"{name}-data"], arrays[f"{name}-indices"], starts), shape=(len(starts) - 1,) * 2)
    return csr_array(half + tril(half, -1, format="csr").T)


# What a mesh must be: a face to be held at, every body joined to it by faces, no cell inside out, all the volume drawn.

ON_THE_PLANE = 1e-6
"""Distance from the base plane, as a share of the article's size, within which a node lies on it."""

VOLUME = 1e-3
"""Share of a part's volume that its cells may miss. Arcs of degree 2 miss 1.6e-4 of a circle at twelve of them, 8e-4 at eight;
plane faces miss nothing."""

_TETRAHEDRON = tuple(combinations(range(4), 3))
_HEXAHEDRON = tuple(
    tuple(int(node) for node in np.flatnonzero(LOCAL_HEX27[:8, axis] == end)) for axis in range(3) for end in (0.0, 1.0)
)
_FACES = {10: _TETRAHEDRON, 27: _HEXAHEDRON}
"""Corners of the faces of a cell, by its number of nodes."""


def base(mesh: SolidMesh) -> Integers:
    """Nodes on the mounting face, the plane z = min of `mesh`; ascending.

    Raises
    ------
    BadInput : no cell has a face on that plane, so that nothing would be held; the message says what touches it.
    """
    on = _on_the_plane(mesh)
    if not np.any(_held_cells(mesh, on)):
        lowest = mesh.points[np.argmin(mesh.points[:, 2])]
        problem = (
            f"no face lies on the lowest plane: the article meets z = {1e3 * lowest[2]:.4g} mm in {int(on.sum())} "
            f"node(s) only, the lowest at {_place(lowest)}, and cannot be held there"
        )
        remedy = "Turn it so that its mounting face is a plane and points down, or add the foot it stands on"
        raise BadInput("mesh", "base", problem, remedy)
    return np.flatnonzero(on)


def require_connected(mesh: SolidMesh) -> None:
    """Refuse a body that no chain of common faces joins to the base; touching in an edge or a point is a hinge, not a joint.

    Raises
    ------
    BadInput : which parts float, where, and how far from the rest.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    # Number of the body of cells joined by faces that each cell belongs to; (c,)
    faces = np.sort(np.vstack([mesh.cells[:, list(face)] for face in _faces(mesh)]), axis=1)
    cell, order = np.tile(np.arange(len(mesh.cells)), len(_faces(mesh))), np.lexsort(faces.T)
    same = np.all(faces[order][1:] == faces[order][:-1], axis=1)
    a, b = cell[order][:-1][same], cell[order][1:][same]
    graph = coo_array((np.ones(len(a), dtype=np.int8), (a, b)), shape=(len(mesh.cells),) * 2)
    label = np.asarray(connected_components(graph, directed=False)[1], dtype=np.intp)
    loose = np.setdiff1d(label, label[_held_cells(mesh, _on_the_plane(mesh))])
    if not len(loose):
        return
    said = []
    for k in loose[:3]:
        own, others = np.unique(mesh.cells[label == k]), np.unique(mesh.cells[label != k])
        names = ", ".join(mesh.parts[part] for part in np.unique(mesh.part[label == k]))
        distance, _ = cKDTree(mesh.points[others]).query(mesh.points[own])
        nearest = int(np.argmin(distance))
        where = _place(mesh.points[own[nearest]])
        said.append(f"{names} (its node at {where} is {1e3 * distance[nearest]:.3g} mm from the nearest other)")
    more = f"; and {len(loose) - 3} more" if len(loose) > 3 else ""
    problem = (
        f"{len(loose)} {'body is' if len(loose) == 1 else 'bodies are'} not joined to the base by any face: "
        f"{'; '.join(said)}{more}"
    )
    raise BadInput("mesh", "parts", problem, "Let the faces coincide in the CAD, or add what joins the bodies")


def require_upright(mesh: SolidMesh) -> None:
    """Refuse cells that are inside out or have no volume.

    Raises
    ------
    CheckFailed : how many, in which parts, and where the worst are.
    """
    least = jacobians(mesh).min(axis=1)
    bad = np.flatnonzero(least <= 0)
    if not len(bad):
        return
    worst = bad[np.argsort(least[bad], kind="stable")][:3]
    places = "; ".join(f"{mesh.parts[mesh.part[cell]]} at {_place(mesh.points[mesh.cells[cell]].mean(axis=0))}" for cell in worst)
    said = f"{len(bad)} of {len(mesh.cells)} elements are inverted, the worst in {places}. Give a smaller element size"
    raise CheckFailed(said, elements=bad)


def unfilled(mesh: SolidMesh, drawn: Sequence[float] | Array) -> str:
    """Which parts' cells are not as large as drawn, in words; nothing when all are.

    Cells far larger than the curvature of a face can be upright and yet cut a part off: a rod has lost 41 % of its volume so.

    Parameters
    ----------
    drawn : (parts,) volume [m³] of each part, from its drawing and not from a mesh
    """
    found = np.bincount(mesh.part, weights=volumes(mesh), minlength=len(mesh.parts))
    error = found / np.asarray(drawn) - 1
    bad = np.flatnonzero(~(np.abs(error) <= VOLUME))
    said = [f"{abs(error[k]):.2%} of {mesh.parts[k]} {'are missing' if error[k] < 0 else 'are too much'}" for k in bad]
    return f"the elements do not fill the drawing: {', '.join(said)} ({VOLUME:.1%} allowed)" if said else ""


def _on_the_plane(mesh: SolidMesh) -> np.ndarray:
    z = mesh.points[:, 2]
    return np.asarray(z <= z.min() + ON_THE_PLANE * np.ptp(mesh.points, axis=0).max())


def _held_cells(mesh: SolidMesh, on: np.ndarray) -> np.ndarray:
    """Whether a cell has all corners of a face among the nodes `on`; (c,)."""
    corners = on[mesh.cells]
    return np.asarray(np.any([corners[:, list(face)].all(axis=1) for face in _faces(mesh)], axis=0))


def _faces(mesh: SolidMesh) -> Sequence[tuple[int, ...]]:
    return _FACES[mesh.cells.shape[1]]


def _place(point: Array) -> str:
    return "(" + ", ".join(f"{1e3 * value:.1f}" for value in point) + ") mm"
