"""What a mode is, in words: which part moves most, along what, and whether its ends go together.

Shares are those of the kinetic energy, u_i (M u)_i summed over a part's degrees of freedom; where the model says which stiffness
is whose, the part that holds most of the strain energy is named too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem.modes import Modes
from fem.structure import Structure
from geometry.arrays import Array, Integers
from geometry.article import Article
from validation.flexible.motion import has_rotations, node_displacement
from validation.flexible.places import family, nearest_part

WORTH_NAMING = 0.15
"""Share of the energy below which a second part is not mentioned."""

SLICES = 12
"""Across a part of a solid, to see whether it twists."""

STILL = 0.15
"""An end that moves less than this share of the farthest moving point stands still."""


@dataclass(frozen=True, kw_only=True)
class Described:
    """One mode.

    Attributes
    ----------
    moving : share of the kinetic energy by part, largest first
    strained : share of the strain energy by part, largest first; empty where the model does not say
    text : both in words
    """

    moving: dict[str, float]
    strained: dict[str, float]
    text: str


def described(structure: Structure, modes: Modes, article: Article | None) -> tuple[Described, ...]:
    """Every mode of `modes` in words; `article` names the parts, without it those of the structure's stiffness are named."""
    if not len(modes.shapes) or not len(structure.points):
        return tuple(Described(moving={}, strained={}, text="") for _ in modes.frequency)
    energy = modes.shapes * (structure.mass @ modes.shapes)
    u = node_displacement(structure, modes.shapes)
    names, owner = _owners(structure, article)
    strain = _strain(structure, modes)
    return tuple(
        _described(structure, names, owner, energy[:, r], u[:, :, r], {k: float(v[r]) for k, v in strain.items()})
        for r in range(len(modes.frequency))
    )


def _described(
    structure: Structure, names: Sequence[str], owner: Integers, energy: Array, u: Array, strain: dict[str, float]
) -> Described:
    along, whole = energy[structure.translations], _point_energy(structure, energy)
    shares = _sorted({name: float(whole[owner == k].sum()) for k, name in enumerate(names)})
    named = [name for name, share in shares.items() if share >= WORTH_NAMING] or list(shares)[:1]
    moving = []
    for name in named[:3]:
        own = owner == names.index(name)
        how = (
            "twists"
            if _twists(structure, own, u, along[own].sum() / shares[name])
            else "xyz"[int(np.argmax(along[own].sum(axis=0)))]
        )
        moving.append(f"{100 * shares[name]:.0f} % {name} {how}" if name else how)
    first = owner == names.index(named[0])
    pattern = _pattern(structure.points[first], u[first])
    moving[0] += f", {pattern}" if pattern and "twists" not in moving[0] else ""
    strained = _sorted(strain)
    return Described(moving=shares, strained=strained, text="; ".join([*moving, *_bent(strained, named[0])]))


def _twists(structure: Structure, own: Array, u: Array, translating: float) -> bool:
    """Whether a part turns about its own length more than it moves; `translating` is the share of its energy in translations.

    Beams have rotations of their own. In a solid the points of a slice across the part go round, and their mean stands still.
    """
    if has_rotations(structure):
        return translating < 0.5
    points, moved = structure.points[own], u[own]
    if len(points) < 2 * SLICES:
        return False
    arms = points - points.mean(axis=0)
    along = arms @ np.linalg.svd(arms, full_matrices=False)[2][0]
    slices = np.minimum((SLICES * (along - along.min()) / max(np.ptp(along), 1e-12)).astype(int), SLICES - 1)
    counts = np.bincount(slices, minlength=SLICES)
    sums = np.stack([np.bincount(slices, weights=moved[:, i], minlength=SLICES) for i in range(3)])
    return float((sums**2 / np.maximum(counts, 1)).sum()) < 0.5 * float((moved**2).sum())


def _bent(strained: dict[str, float], moving: str) -> list[str]:
    """Which part is strained most, if that is another than the one that moves most."""
    name = next(iter(strained), moving)
    return [f"strain: {100 * strained[name]:.0f} % {name}"] if name != moving else []


def _pattern(points: Array, u: Array) -> str:
    """Whether the two ends of a part that is longer than everything else go the same way."""
    if len(points) < 3:
        return ""
    extent = np.ptp(points, axis=0)
    k = int(np.argmax(extent))
    if k == 2:
        return ""  # a mast has one free end
    axis = int(np.argmax(np.abs(u).sum(axis=0)))
    ends = [float(u[i, axis]) for i in (np.argmin(points[:, k]), np.argmax(points[:, k]))]
    largest = float(np.abs(u[:, axis]).max())
    if max(map(abs, ends)) < STILL * largest:
        return "ends still"
    if min(map(abs, ends)) < STILL * max(map(abs, ends)):
        return "one end"
    if ends[0] * ends[1] > 0:
        return "ends together"
    return "ends opposed" if axis == 2 else "turning about z"


def _owners(structure: Structure, article: Article | None) -> tuple[list[str], Integers]:
    """Names of the parts, and for each point the index of its own: by the drawing, else by whose stiffness holds the point."""
    if article is not None:
        families = [family(part.name) for part in article.counted_parts]
        names = list(dict.fromkeys(families))
        return names, np.array([names.index(name) for name in families])[nearest_part(article, structure.points)]
    if not structure.part_stiffness:
        return [""], np.zeros(len(structure.points), dtype=np.intp)
    held = [K.diagonal()[structure.translations].sum(axis=1) for K in structure.part_stiffness.values()]
    return list(structure.part_stiffness), np.argmax(held, axis=0)


def _point_energy(structure: Structure, energy: Array) -> Array:
    """Energy (p,) of each point with its rotations, where it has any: all degrees of freedom up to the next point's."""
    order = np.argsort(structure.translations[:, 0])
    starts = structure.translations[order, 0]
    sums = np.add.reduceat(energy, starts)
    result = np.empty(len(order))
    result[order] = sums
    return result


def _strain(structure: Structure, modes: Modes) -> dict[str, Array]:
    """Share (m,) of the strain energy of each mode by part."""
    shares: dict[str, Array] = {}
    omega2 = (2 * np.pi * modes.frequency) ** 2
    for name, K in structure.part_stiffness.items():
        share = np.einsum("nm,nm->m", modes.shapes, K @ modes.shapes) / omega2
        shares[family(name)] = shares.get(family(name), 0.0) + share
    return shares


def _sorted(shares: dict[str, float]) -> dict[str, float]:
    return dict(sorted(shares.items(), key=lambda item: -item[1]))
