"""How large the elements are: from thickness and curvature, by one number finer, and finer still at re-entrant edges.

Three rules, the smallest holds. A body's own size follows its mean thickness 2 V / A (exactly the thickness of a plate, a
third of a cube's edge). A curved face has at least `AROUND` elements on a full circle, and on a thin wall so many that a
chord does not cut through a quarter of the wall. At a re-entrant edge, where stress is singular, elements are `refinement`
times smaller. Away from what is small the size grows by `GROWTH` metres a metre.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from geometry.errors import BadInput

AROUND = 12
"""Elements on a full circle, at the least."""

CUT = 0.2
"""How deep a chord may cut into a thin wall, as a share of its thickness."""

GROWTH = 0.8
"""How fast the size grows away from a small feature, metre a metre."""

THIN, SLENDER = 6.0, 10.0
"""Largest size of a body: `THIN` times its thickness, or its longest dimension over `SLENDER`, whichever is smaller ..."""

SOLID = 0.5
"""... but never less than this share of its thickness."""


LARGEST = 500_000
"""Degrees of freedom; what a factoriser needs for them is estimated where the modes are computed."""


@dataclass(frozen=True, kw_only=True)
class Sizing:
    """What decides about the size of the elements.

    Attributes
    ----------
    size : largest edge of an element [m] in any body; None for what thickness asks for
    fineness : all sizes are divided by it; 2 halves them
    refinement : size at re-entrant edges over the size beside them, at most 1 (none)
    largest : degrees of freedom beyond which a mesh is refused
    """

    size: float | None = None
    fineness: float = 1.0
    refinement: float = 1.0
    largest: int = LARGEST

    @property
    def described(self) -> list[float | None]:
        """What the mesh depends on: another limit makes no other mesh."""
        return [self.size, self.fineness, self.refinement]

    def __post_init__(self) -> None:
        _require("size", self.size is None or 0 < self.size < np.inf, self.size, "must be a positive length in metres")
        _require("fineness", 0 < self.fineness < np.inf, self.fineness, "must be positive")
        _require("refinement", 0 < self.refinement <= 1, self.refinement, "must be positive and at most 1")
        _require("largest", self.largest > 0, self.largest, "must be a positive number of degrees of freedom")


def _require(field: str, holds: bool, found: object, condition: str) -> None:
    if not holds:
        raise BadInput(source="mesh", field=field, problem=f"{condition}, found {found!r}", remedy="Correct it, or leave it out")


@dataclass(frozen=True, kw_only=True)
class Volume:
    """A gmsh volume: its tag, mean thickness 2 V / A, longest dimension of its box, volume and area, in millimetres."""

    tag: int
    thickness: float
    longest: float
    volume: float
    area: float


def measured(gmsh: Any, tag: int) -> Volume:
    """The volume `tag` of the current model."""
    volume = gmsh.model.occ.getMass(3, tag)
    area = sum(gmsh.model.occ.getMass(2, face) for face in _faces(gmsh, tag))
    box = np.reshape(gmsh.model.getBoundingBox(3, tag), (2, 3))
    return Volume(tag=tag, thickness=2 * volume / area, longest=float(np.ptp(box, axis=0).max()), volume=volume, area=area)


def body_size(volume: Volume, sizing: Sizing) -> float:
    """Largest edge of an element of `volume` [mm]."""
    own = max(SOLID * volume.thickness, min(THIN * volume.thickness, volume.longest / SLENDER))
    given = np.inf if sizing.size is None else 1e3 * sizing.size
    return float(min(own if sizing.size is None else np.inf, given)) / sizing.fineness


def apply(gmsh: Any, volumes: Sequence[Volume], sizing: Sizing, re_entrant: Sequence[int] = ()) -> None:
    """Give the current model of gmsh its size field; `re_entrant` are the tags of the curves to refine at."""
    sizes = {volume.tag: body_size(volume, sizing) for volume in volumes}
    faces = _curved_faces(gmsh, volumes, sizes, sizing)
    curves: dict[int, float] = {}
    for face, size in faces.items():
        for _, curve in gmsh.model.getBoundary([(2, face)], oriented=False):
            curves[curve] = min(size, curves.get(curve, np.inf))
    for curve in re_entrant if sizing.refinement < 1 else ():
        curves[curve] = sizing.refinement * min(curves.get(curve, np.inf), *(sizes[tag] for tag in _volumes_at(gmsh, curve)))
    fields = [_constant(gmsh, "VolumesList", tag, size) for tag, size in sizes.items()]
    fields += [_constant(gmsh, "SurfacesList", tag, size) for tag, size in faces.items()]
    _background(gmsh, fields + _growing(gmsh, curves, max(sizes.values())))


def _curved_faces(gmsh: Any, volumes: Sequence[Volume], sizes: Mapping[int, float], sizing: Sizing) -> dict[int, float]:
    """Faces whose curvature asks for smaller elements than their body has, and that size [mm]."""
    found: dict[int, float] = {}
    for volume in volumes:
        for face in _faces(gmsh, volume.tag):
            size = _curved_size(_radius(gmsh, face), volume.thickness, sizing)
            if size < sizes[volume.tag]:
                found[face] = min(size, found.get(face, np.inf))
    return found


def _curved_size(radius: float, thickness: float, sizing: Sizing) -> float:
    """Edge [mm] on a face of `radius` on a wall of `thickness` [mm]."""
    if not np.isfinite(radius):
        return np.inf
    around = 2 * np.pi * radius / max(AROUND, AROUND * sizing.fineness)
    chord = np.sqrt(8 * radius * CUT * thickness) / max(1.0, sizing.fineness)
    return float(min(around, chord))


def _radius(gmsh: Any, face: int) -> float:
    """Smallest radius of curvature [mm] found on `face`; infinite on a plane."""
    if gmsh.model.getType(2, face) == "Plane":
        return float(np.inf)
    lower, upper = gmsh.model.getParametrizationBounds(2, face)
    grid = np.array(list(product(*(np.linspace(a, b, 5)[1:-1] for a, b in zip(lower, upper, strict=True)))))
    largest, smallest, *_ = gmsh.model.getPrincipalCurvatures(face, grid.ravel())
    curvature = np.abs([largest, smallest]).max()
    return float(1 / curvature) if curvature > 0 else float(np.inf)


def _faces(gmsh: Any, volume: int) -> list[int]:
    return [tag for _, tag in gmsh.model.getBoundary([(3, volume)], oriented=False)]


def _volumes_at(gmsh: Any, curve: int) -> set[int]:
    faces, _ = gmsh.model.getAdjacencies(1, curve)
    return {int(volume) for face in faces for volume in gmsh.model.getAdjacencies(2, face)[0]}


def _constant(gmsh: Any, kind: str, tag: int, size: float) -> int:
    field: int = gmsh.model.mesh.field.add("Constant")
    gmsh.model.mesh.field.setNumbers(field, kind, [tag])
    gmsh.model.mesh.field.setNumber(field, "VIn", size)
    gmsh.model.mesh.field.setNumber(field, "IncludeBoundary", 1)
    return field


def _growing(gmsh: Any, small: Mapping[int, float], largest: float) -> list[int]:
    """One field for the curves of each size: that size on them, `GROWTH` more with the distance."""
    fields = []
    for size in sorted(set(np.round(list(small.values()), 6))):
        curves = [curve for curve, own in small.items() if round(own, 6) == size]
        distance = gmsh.model.mesh.field.add("Distance")
        gmsh.model.mesh.field.setNumbers(distance, "CurvesList", curves)
        gmsh.model.mesh.field.setNumber(distance, "Sampling", 40)
        threshold = gmsh.model.mesh.field.add("Threshold")
        for key, value in (
            ("InField", distance),
            ("SizeMin", size),
            ("SizeMax", largest),
            ("DistMin", size),
            ("DistMax", size + max(largest - size, size) / GROWTH),
        ):
            gmsh.model.mesh.field.setNumber(threshold, key, value)
        fields.append(threshold)
    return fields


def _background(gmsh: Any, fields: Sequence[int]) -> None:
    """The smallest of `fields`, and nothing else, rules."""
    least = gmsh.model.mesh.field.add("Min")
    gmsh.model.mesh.field.setNumbers(least, "FieldsList", fields)
    gmsh.model.mesh.field.setAsBackgroundMesh(least)
    for option in ("MeshSizeExtendFromBoundary", "MeshSizeFromPoints", "MeshSizeFromCurvature"):
        gmsh.option.setNumber(f"Mesh.{option}", 0)
