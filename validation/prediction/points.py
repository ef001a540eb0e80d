"""What each coordinate of a structure moves the points of a test, as they are stated and as they may be instead.

A point at p along d has the row dᵀ u(p). Turned about an axis e, beside its place along e, or at another point, it has

    (d cos v + e x d sin v + e eᵀd (1 - cos v))ᵀ u ,        dᵀ u(p + v e) ,        (1 - v) dᵀ u + v d'ᵀ u' ,

whose derivative is a row itself. How far it may be turned or lie beside its place is a tolerance of
the test, as of any pick-up; the others are parameters that effects open: `possible` says which.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.errors import BadInput
from geometry.frames import Array
from geometry.sensors import AXES, Point, Tolerances
from geometry.toml_file import nearest
from validation.effects.catalogue import FAMILIES
from validation.effects.effect import OPENED
from validation.effects.stages import Matrices
from validation.estimation.problem import Offsets, Parameter
from validation.model.model import Added
from validation.prediction.effects import Nuisances, limited

RESPONSES = ("accelerometer-misalignment", "accelerometer-position", "wrong-direction", "wrong-place")
DRIVES = ("force-misalignment", "force-position", "wrong-reference")
"""Families that move the points of responses, and those of drives."""


@dataclass(frozen=True, eq=False, kw_only=True)
class PointRows:
    """Rows of points.

    Attributes
    ----------
    values : (p, k)
    changes : by parameter the point concerned and d row / d offset (k,)
    """

    values: Array
    changes: Mapping[str, tuple[int, Array]]


def require_places(points: Sequence[Point], places: Collection[str], whose: str, source: str) -> None:
    """Refuse a point of the test in the file `source` at none of the `places` of the structure that is called `whose`."""
    for one in points:
        if one.place not in places:
            known = f"{nearest(one.place, places)}Its places are {', '.join(list(places)[:20]) or 'none'}; name it there"
            raise BadInput(source, one.place, f"{whose} has no such place", known)


def asked(effects: Sequence[Added], families: Sequence[str]) -> list[str]:
    """Ids of the effects of these families that want a parameter to be opened."""
    return [one.named.id for one in effects if one.named.family in families and FAMILIES[one.named.family].stage == OPENED]


EXACT = Tolerances().scaled(0.0)
"""Of a test that says by other deviations what its points may be off."""


def tolerance_of(family: str, tolerances: Tolerances) -> float:
    """Of a parameter of `family`; 0 where none is stated for it."""
    _, _, kind = family.partition("-")
    return {"misalignment": tolerances.angle, "position": tolerances.position}.get(kind, 0.0)


def uncertain(points: Sequence[Point], families: Sequence[str], effects: Sequence[Added], tolerances: Tolerances) -> list[str]:
    """Names of what may move the rows of `points`: what is known within `tolerances`, and what `effects` ask for, each once."""
    known = [one for one in families if tolerance_of(one, tolerances) > 0]
    names = [f"{family}:{point.name}:{axis}" for point in points for family in known for axis in "xyz"]
    return list(dict.fromkeys([*names, *asked(effects, families)]))


def possible(
    structure: Nuisances, points: Sequence[Point], others: Sequence[Point], names: Sequence[str], tolerances: Tolerances
) -> list[Parameter]:
    """Parameters `names` of `points` that change anything; none of them takes its point off the structure.

    Parameters
    ----------
    others : points at which a force may have acted instead
    tolerances : of what is not asked for by an effect
    """
    found = []
    for name, (k, row) in rows(structure.nominal, points, others, names, {}).changes.items():
        if np.any(row):
            family, word = name.partition(":")[0], name.rpartition(":")[2]
            unit, tolerance = FAMILIES[family].sizes[0].unit, tolerance_of(family, tolerances) or 1.0
            one = Parameter(name=name, unit=unit, tolerance=tolerance)
            if structure.reduced is not None:
                one = limited(one, structure.reduced.structure, points[k].place, AXES.get(word, (0.0, 0.0, 0.0)))
            found.append(one)
    return found


def along(matrices: Matrices, place: str, direction: npt.ArrayLike) -> Array:
    """(k,) what each coordinate moves `place` along `direction` (3,), a unit vector."""
    return np.asarray(np.asarray(direction, dtype=np.float64) @ matrices.places[place])


def stated(matrices: Matrices, points: Sequence[Point]) -> Array:
    """(p, k) of `points` as they are stated."""
    if not points:
        return np.zeros((0, len(matrices.mass)))
    directions = np.array([one.direction for one in points], dtype=np.float64)
    return np.asarray(np.einsum("pa,pak->pk", directions, np.stack([matrices.places[one.place] for one in points])))


def rows(
    matrices: Matrices, points: Sequence[Point], others: Sequence[Point], names: Sequence[str], offsets: Offsets
) -> PointRows:
    """Of `points` at `offsets`, and by the parameters `names`; one that points at nothing of these is left out."""
    own = stated(matrices, points)
    values = np.array(own)
    at = {one.name: k for k, one in enumerate(points)}
    instead = {one.name: one for one in others}
    changes = {}
    for name in names:
        family, *targets = name.split(":")
        if not targets or targets[0] not in at:
            continue
        k = at[targets[0]]
        point, word, by = points[k], targets[-1], offsets.get(name, 0.0)
        d = np.asarray(point.direction)
        if family.endswith("-misalignment"):
            e = np.asarray(AXES[word])
            across, back = (along(matrices, point.place, way) for way in (np.cross(e, d), (e @ d) * e - d))
            change = np.cos(by) * across + np.sin(by) * back
            values[k] += np.sin(by) * across + (1 - np.cos(by)) * back - by * change
        elif family.endswith("-position"):
            if point.place not in matrices.gradients:
                continue
            moved, change = (d @ one for one in matrices.gradients[point.place].shifted("xyz".index(word), by))
            values[k] += moved - by * change
        elif family == "wrong-direction":
            change = along(matrices, point.place, np.asarray(AXES[word]) - d)
        elif family == "wrong-place":
            if word not in matrices.places:
                continue
            change = along(matrices, word, d) - own[k]
        else:
            if word not in instead:
                continue
            change = along(matrices, instead[word].place, instead[word].direction) - own[k]
        changes[name] = (k, change)
        values[k] += by * change
    return PointRows(values=values, changes=changes)
