"""The separate bodies of one mesh: every outer skin with the cavities inside it."""

from __future__ import annotations

from geometry.mesh.self_intersection import winding_number
from geometry.mesh.triangles import TriangleMesh, joined, pieces


def bodies(mesh: TriangleMesh) -> tuple[TriangleMesh, ...]:
    """The bodies of a `mesh` that has passed `geometry.mesh.checks`, in the order of the first face of their outer skin."""
    every = pieces(mesh)
    skins = [piece for piece in every if piece.volume > 0]
    within: list[list[TriangleMesh]] = [[] for _ in skins]
    for cavity in (piece for piece in every if piece.volume < 0):
        around = [number for number, skin in enumerate(skins) if winding_number(skin, cavity.vertices[0]) == 1]
        within[min(around, key=lambda number: skins[number].volume)].append(cavity)
    return tuple(joined(skin, *cavities) for skin, cavities in zip(skins, within, strict=True))
