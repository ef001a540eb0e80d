"""A mesh and its matrices as plain arrays and back, for the cache: symmetric ones by their lower half.

The mass is the same in all three directions and does not couple them, so that one third of its rows says it all.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from fem.solid.elasticity import Matrices
from fem.solid.mesh import SolidMesh
from fem.structure import Sparse

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
