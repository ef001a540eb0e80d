"""Matrices of an elastic block for the tests of factorisers and eigenvalues, made without a mesh generator."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from scipy.sparse import csr_array, eye_array, kron

from fem.structure import Structure, rigid_motion


@pytest.fixture(scope="session")
def block() -> Callable[..., Structure]:
    """``block(nx, ny, nz)``: lattice of point masses 0.1 m apart, sprung to all 26 neighbours, the lowest layer held."""
    return cache(_block)


def _block(nx: int, ny: int, nz: int, stiffness: float = 1e6, mass: float = 0.1) -> Structure:
    places = np.stack(np.meshgrid(*(np.arange(n) for n in (nx, ny, nz)), indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(len(places)).reshape(nx, ny, nz)
    K = csr_array((3 * len(places), 3 * len(places)))
    for step in np.ndindex(3, 3, 3):
        d = np.array(step) - 1
        if tuple(d) <= (0, 0, 0):
            continue
        here = np.all((places + d >= 0) & (places + d < [nx, ny, nz]), axis=1)
        a = number.ravel()[here]
        b = number[tuple((places[here] + d).T)]
        rows = np.arange(len(a))
        lift = csr_array(
            (np.append(np.ones(len(a)), -np.ones(len(a))), (np.append(rows, rows), np.append(a, b))), (len(a), len(places))
        )
        along = csr_array(np.outer(d, d) / (d @ d) * stiffness)
        K = K + kron(lift.T @ lift, along)
    points = 0.1 * places
    dofs = np.arange(3 * len(places)).reshape(-1, 3)
    return Structure(
        stiffness=csr_array(K),
        mass=csr_array(mass * eye_array(3 * len(places))),
        rigid=rigid_motion(points).reshape(-1, 6, 6)[:, :3].reshape(-1, 6),
        held=dofs[places[:, 2] == 0].ravel(),
        points=points,
        translations=dofs,
    )
