"""`HeldBase`: the free part of a structure, and how acceleration of the base loads it.

With u = T u_b + w, where T is the rigid motion and w vanishes on the held degrees of freedom, a driven structure obeys

    M_ff w'' + (C_ff + ...) w' + K_ff w = -P u_b'',   P = (M T)_f,   f = T^T M T u_b'' + P^T w'',

because neither stiffness nor internal damping resists a rigid motion. Modes, direct solution and reduction all start from here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.factorisers import factorise
from fem.structure import Sparse, Structure
from geometry.errors import CheckFailed
from geometry.frames import Array, Integers

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

    Raises
    ------
    CheckFailed : the degrees of freedom of each such body are counted; the parts it belongs to and a point of it are named.
    """
    from scipy.sparse.csgraph import connected_components

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
    """Refuse modes that strain nothing: with the base held, all of a structure must resist.

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
        raise CheckFailed(
            f"With the base held, {np.sum(loose)} {'mode has' if np.sum(loose) == 1 else 'modes have'} zero frequency: part of "
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


# What truncated modes answer statically, as coordinates of a reduced body (mode acceleration, attachment modes).
#
# The few modes kept would leave the static share of the others out. The static answers to six accelerations of the base, less
# what the kept modes hold of them, are put beside the modes as further shapes: the reduced body then answers as the full one
# does up to the fourth power of the frequency, residual mass included (Craig & Chang, AIAA Journal 15, 1977).


REDUNDANT = 1e-8
"""Share of a static answer that may lie outside the modes already there, below which it is left out."""


def static_shapes(stiffness: Sparse, mass: Sparse, load: Array, shapes: Array) -> Array:
    """Static answers to `load` beside mass-normalised `shapes`: orthonormal in the mass, to one another and to `shapes`.

    Parameters
    ----------
    stiffness, mass : (f, f) sparse, of the free degrees of freedom
    load : (f, k), of unit accelerations of the base
    shapes : (f, n)

    Returns
    -------
    (f, m) : m at most k, fewer where the modes already answer a load in full
    """
    if not len(load):
        return np.zeros((0, 0))
    static = factorise(stiffness, definite=True).solve(load)
    size = np.sqrt(np.einsum("ir,ir->r", static, mass @ static))
    static = static[:, size > 0] / size[size > 0]
    left = static - shapes @ (shapes.T @ (mass @ static))
    left -= shapes @ (shapes.T @ (mass @ left))  # twice is enough, against rounding
    square, directions = np.linalg.eigh(left.T @ (mass @ left))
    kept = square > REDUNDANT**2
    return np.asarray(left @ directions[:, kept] / np.sqrt(square[kept]))
