"""Leftovers in the structure: at a place of the article, in the joint under it, in a part of which the fit has a parameter."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from geometry.dynamic_mass import MOTIONS, ComplexArray
from geometry.frames import rigid_transformation_6
from geometry.observability import LOADS
from validation.diagnosing.leftover.axes import Loaded
from validation.diagnosing.leftover.courses import OF_JOINTS, OF_PARTS, OF_PLACES, Course
from validation.diagnosing.leftover.places import JOINT, LOCATION, PART, Family, Place
from validation.diagnosing.leftover.tangents import Swallowing
from validation.engine.prediction import Lines, Offsets
from validation.engine.screening import Products
from validation.prediction import fmd
from validation.prediction.series import SeriesPrediction

DIRECTIONS = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1), "x and y": (1, 1, 0), "x, y and z": (1, 1, 1)}

GROUND, TABLE = "the ground", "the table"

JOINTS = ((0,), (1,), (2,), (3,), (4,), (5,), (0, 1), (3, 4))
"""Axes that give alike."""

GIVES = 0.02
"""Share of its motion that a place must move beyond a rigid article for anything to pull at that."""

PARTS = ("modulus", "loss", "damping-law", "cell-stiffness", "fmd-compliance", "frequency", "damping")
"""Families of parameters that stand for a part or a mode."""


def locations(
    of: Loaded, prediction: SeriesPrediction, offsets: Offsets, lines: Lines, shakes: Sequence[Course]
) -> Iterator[Family]:
    """What is attached to a place of the article: ``dH = a c(omega) sum_d p_d p_d^T``, p its accelerations for those of F."""
    moved = prediction.moved(offsets, lines)
    mixed = np.array(list(DIRECTIONS.values()), dtype=np.float64).T
    if not moved:
        return
    giving = {name: both for name, both in moved.items() if np.abs(both[1]).max() > GIVES * np.abs(both[0]).max()}
    for to, k, there, courses in ((GROUND, 0, moved, (*OF_PLACES, *shakes)), (TABLE, 1, giving, OF_PLACES[1:])):
        if not there:
            continue
        places = tuple(Place(kind=LOCATION, part=name, along=along, to=to) for name in there for along in DIRECTIONS)
        rows = [np.swapaxes(both[k], 1, 2) for both in there.values()]
        yield of.family(places, courses, np.concatenate([of.readings(one, one) @ mixed for one in rows], axis=-1))


def joint(of: Loaded, prediction: SeriesPrediction, offsets: Offsets) -> Iterator[Family]:
    """What gives between cover plate and article: ``dH = a c(omega) sum_d H e_d e_d^T H``, H of the article about its origin."""
    carried = prediction.tested.carried
    if carried.nuisances is None:
        return
    T = rigid_transformation_6(carried.standing.pose.position)
    back = np.linalg.inv(T)
    H = of.H - fmd.at(carried.moving, offsets).mass_matrix
    loads: ComplexArray = H @ back
    readings = of.readings(loads, np.swapaxes(back.T @ H, 1, 2))
    places, mixed = [], np.zeros((len(MOTIONS), len(JOINTS)))
    for k, axes in enumerate(JOINTS):
        (first, *others) = ((LOADS[axis], MOTIONS[axis]) for axis in axes)
        places.append(Place(kind=JOINT, load=first[0], motion=first[1], others=tuple(others)))
        mixed[list(axes), k] = 1.0
    yield of.family(tuple(places), OF_JOINTS, readings @ mixed)


def parts(of: Swallowing) -> Iterator[Family]:
    at = [k for k, name in enumerate(of.names) if name.partition(":")[0] in PARTS and name in of.of.predicted.changes]
    if at:
        places = tuple(Place(kind=PART, part=of.names[k]) for k in at)
        yield Family(places=places, courses=OF_PARTS, products=_of_parameters(of, at), root=of.root, slope=of.slope)


def _of_parameters(of: Swallowing, at: list[int]) -> Products:
    m, r, c, p = of.moved.shape
    V = of.moved.reshape(m, r * c, p)
    e = V[:, :, at].conj().swapaxes(1, 2)
    return Products(
        frequency=of.of.frequency,
        names=tuple(of.names[k] for k in at),
        residual=(e @ of.left.reshape(m, r * c, 1))[..., 0],
        others=np.asarray(e @ V),
        square=np.sum(np.abs(V[:, :, at]) ** 2, axis=1),
    )
