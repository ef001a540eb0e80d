"""Three routes from a drawing to inertia, and whether they agree.

=========== ======================================================= ============================
route       what it integrates                                      error
=========== ======================================================= ============================
occ         the exact B-rep that OCC made of the drawing            rounding
trimesh     a closed triangle mesh of that B-rep                    chord error of curved faces
pinocchio   closed-form primitives, voids as negative bodies        rounding
=========== ======================================================= ============================

OCC cuts the voids; Pinocchio subtracts them. They differ when a void leaves the material or meets another one, when OCC's boolean
operation fails, and when either is fed a wrong place: a disagreement is a failed check, not a matter of taste.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from geometry.agreement import Agreement, held_together, missing_mass, rounding
from geometry.arrays import Array
from geometry.article import Article
from geometry.frames import Pose
from geometry.inertia import Inertia
from geometry.shapes import Cylinder

ROUTES = ("occ", "trimesh", "pinocchio")

DEFAULT_CHORD = 2e-6
"""Chord error of the mesh route [m]."""


def by_routes(article: Article, chord: float = DEFAULT_CHORD) -> Mapping[str, Inertia]:
    """Inertia of `article` by every route, about the article's origin, in its frame; `chord` [m] is the mesh's chord error."""
    from geometry import multibody
    from geometry.cad import brep

    return {"occ": brep.inertia(article), "trimesh": by_mesh(article, chord), "pinocchio": multibody.inertia(article)}


def by_mesh(article: Article, chord: float = DEFAULT_CHORD) -> Inertia:
    """Inertia of `article` from closed meshes of its parts with chord error `chord` [m], about the article's origin."""
    from geometry import mesh
    from geometry.cad.tessellation import tessellate

    total = Inertia(parameters=np.zeros(10))
    for part in article.counted_parts:
        total = total + mesh.inertia(tessellate(part, chord), part.material.density, f"mesh of {part.name}")
    return total


def agreement(article: Article, inertias: Mapping[str, Inertia], chord: float = DEFAULT_CHORD) -> Agreement:
    """Hold the routes against each other: to `ROUNDING` among the exact ones, to the tessellation error against the mesh."""
    exact = rounding(inertias["occ"])
    allowed = {"occ": exact, "pinocchio": exact, "trimesh": exact + tessellation_error(article, chord)}
    return held_together(inertias, allowed)


def tessellation_error(article: Article, chord: float) -> Array:
    """What the mesh of `article` may be off by: bound on each of the ten parameters (10,), about the article's origin.

    A polygon inscribed in a circle with sagittas of at most c misses no more than two thirds of the shell of thickness c, so a
    cylinder's mesh misses mass of at most dm = rho 2/3 pi d h c, somewhere on its curved face; the farthest that face reaches
    along x, y and z bounds what dm adds to the moments. Material loses and voids gain: for the mass and the moments of
    inertia, which have positive weights, the two do not add up. Planar faces are exact.
    """
    material, voids = _missing(article, chord, "solids"), _missing(article, chord, "voids")
    return np.where(_POSITIVE, np.maximum(material, voids), material + voids)


def _missing(article: Article, chord: float, kind: str) -> Array:
    """Bound on what the inscribed polygons of all solids, or of all voids, miss; (10,)."""
    return sum((_segments(*cylinder, chord) for cylinder in _cylinders(article, kind)), np.zeros(10))


def _cylinders(article: Article, kind: str) -> Iterator[tuple[float, Pose, Cylinder]]:
    """Density, place in the article's frame and size of every cylinder."""
    for part in article.counted_parts:
        for placed in getattr(part.shape, kind):
            if isinstance(placed.primitive, Cylinder):
                yield part.material.density, part.pose @ placed.pose, placed.primitive


def _segments(density: float, pose: Pose, cylinder: Cylinder, chord: float) -> Array:
    mass = density * 2 / 3 * np.pi * cylinder.diameter * cylinder.height * chord
    axis = np.abs(pose.rotation[:, 2])
    half = axis * cylinder.height / 2 + np.sqrt(1 - np.minimum(axis, 1) ** 2) * cylinder.diameter / 2
    return missing_mass(mass, np.abs(pose.position) + half)


_POSITIVE = np.array([True, False, False, False, True, True, True, False, False, False])
