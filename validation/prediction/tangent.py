"""`Tangent`: how reduced matrices change with one parameter, on the few coordinates that do."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from geometry.arrays import Array, Integers
from validation.effects.stages import Matrices


@dataclass(frozen=True, eq=False, kw_only=True)
class Tangent:
    """d `Matrices` / d offset of one parameter.

    Attributes
    ----------
    at : (s,) the coordinates concerned; coordinates that later effects append need no change here
    mass, stiffness, viscous, structural : (s, s)
    parts : by name (k, k), where the share of a part changes
    crossing : position in `at` of the coordinate whose row and column alone change; None where more may
    """

    at: Integers
    mass: Array
    stiffness: Array
    viscous: Array
    structural: Array
    parts: Mapping[str, Array] = field(default_factory=lambda: MappingProxyType({}))
    crossing: int | None = None


FIELDS = ("mass", "stiffness", "viscous", "structural")


def of_arrays(
    size: int, parts: Mapping[str, Array] = MappingProxyType({}), crossing: int | None = None, **changes: Array
) -> Tangent:
    """The tangent of full (size, size) `changes` by the names of `FIELDS`; what is not named does not change.

    Parameters
    ----------
    crossing : the coordinate whose row and column alone change, if there is one
    """
    moving = np.zeros(size, dtype=bool)
    for change in changes.values():
        moving |= np.any(change != 0, axis=0) | np.any(change != 0, axis=1)
    at = np.flatnonzero(moving)
    nothing = np.zeros((len(at), len(at)))
    where = None if crossing is None or not moving[crossing] else int(np.searchsorted(at, crossing))
    mass, stiffness, viscous, structural = (changes[name][np.ix_(at, at)] if name in changes else nothing for name in FIELDS)
    return Tangent(at=at, mass=mass, stiffness=stiffness, viscous=viscous, structural=structural, parts=parts, crossing=where)


def between(before: Matrices, after: Matrices, step: float) -> Tangent:
    """(after - before) / step."""
    changes = {name: (getattr(after, name) - getattr(before, name)) / step for name in FIELDS}
    parts = {name: (share - before.parts[name]) / step for name, share in after.parts.items() if share is not before.parts[name]}
    return of_arrays(len(before.mass), {name: change for name, change in parts.items() if np.any(change)}, **changes)


def plus(one: Tangent, other: Tangent, size: int) -> Tangent:
    """The sum of both, on matrices of `size`."""
    whole = {name: full(one, name, size) + full(other, name, size) for name in FIELDS}
    return of_arrays(size, {**one.parts, **other.parts}, None, **whole)


def full(tangent: Tangent, name: str, size: int) -> Array:
    """The field `name` of `tangent` on all coordinates, (size, size)."""
    whole = np.zeros((size, size))
    whole[np.ix_(tangent.at, tangent.at)] = getattr(tangent, name)
    return whole
