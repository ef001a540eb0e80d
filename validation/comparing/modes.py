"""Modes by the names that one speaks of them: the part that holds most of their strain energy, and their order among its
modes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array, Integers
from validation.effects.stages import Matrices
from validation.flexible.places import family

PART = 0.05
"""Share of the greatest effective mass of several modes that one of them must have to be driven."""

ORDINALS = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth")


@dataclass(frozen=True, kw_only=True)
class NamedMode:
    """One fixed-base mode.

    Attributes
    ----------
    name : "first mast mode"
    frequency : [Hz]
    damping_ratio : [1]
    effective_mass : (6,) along and about every axis [kg], [kg m²]; empty where it is not known
    """

    name: str
    frequency: float
    damping_ratio: float
    effective_mass: tuple[float, ...] = ()


def named(matrices: Matrices) -> tuple[NamedMode, ...]:
    """The modes of `matrices` with the base held, ascending; the last of them stand for the static answer of all others."""
    from scipy.linalg import eigh

    own = np.arange(matrices.base, len(matrices.mass))
    if not own.size:
        return ()
    K, M, C, S = (one[np.ix_(own, own)] for one in (matrices.stiffness, matrices.mass, matrices.viscous, matrices.structural))
    squares, shapes = eigh(K, M)
    omega, shapes = np.sqrt(np.maximum(squares, 0.0)), np.asarray(shapes)
    zeta = (_energy(C, shapes) + _energy(S, shapes) / np.maximum(omega, 1e-12)) / np.maximum(2 * omega, 1e-12)
    names = in_order(_holders(matrices, own, shapes))
    effective = np.square(shapes.T @ matrices.mass[own, : matrices.base])
    return tuple(
        NamedMode(name=name, frequency=float(w / (2 * np.pi)), damping_ratio=float(z), effective_mass=tuple(map(float, m)))
        for name, w, z, m in zip(names, omega, zeta, effective, strict=True)
    )


def taking_part(modes: Sequence[NamedMode], axis: int) -> tuple[NamedMode, ...]:
    """Those of `modes` that a motion of the base along `axis` (index in `MOTIONS`) drives; all where that is not known."""
    if any(len(one.effective_mass) <= axis for one in modes):
        return tuple(modes)
    most = max((one.effective_mass[axis] for one in modes), default=0.0)
    return tuple(one for one in modes if one.effective_mass[axis] >= PART * most)


def in_order(holders: Sequence[str]) -> list[str]:
    """ "mast", "upper-long", "mast" as "first mast mode", "first upper-long mode", "second mast mode"."""
    return [f"{ordinal(holders[: k + 1].count(part))} {part} mode".replace("  ", " ") for k, part in enumerate(holders)]


def ordinal(number: int) -> str:
    """In words up to ten."""
    return ORDINALS[number - 1] if number <= len(ORDINALS) else f"{number}th"


def _holders(matrices: Matrices, own: Integers, shapes: Array) -> list[str]:
    """By mode the part with the largest share of strain energy; empty words where the model does not say."""
    shares: dict[str, Array] = {}
    for part, K in matrices.parts.items():
        shares[family(part)] = shares.get(family(part), 0.0) + _energy(K[np.ix_(own, own)], shapes)
    if not shares:
        return [""] * shapes.shape[1]
    most = np.argmax(np.stack(list(shares.values())), axis=0)
    return [list(shares)[k] for k in most]


def _energy(matrix: Array, shapes: Array) -> Array:
    return np.asarray(np.einsum("im,ij,jm->m", shapes, matrix, shapes))
