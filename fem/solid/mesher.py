"""gmsh at work, in a process of its own: ``python -m fem.solid.mesher FOLDER``.

gmsh ends its process on some geometries instead of reporting a fault, and cannot be interrupted; `fem.solid.tetrahedra`
therefore starts this module for every attempt, with the job in `FOLDER` (``job.json`` and one BREP a body, in millimetres),
and finds the answer there: ``mesh.npz``, or ``fault.json``.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from fem.solid import packed, re_entrant, sizing, soundness
from fem.solid.gmsh_session import session
from fem.solid.mesh import SolidMesh
from fem.solid.sizing import Sizing, Volume
from geometry.arrays import Array, Integers
from geometry.errors import BadInput

JOB, MESH, FAULT = "job.json", "mesh.npz", "fault.json"
"""Files of a job's folder; the bodies are ``0.brep``, ``1.brep`` ..."""

FROM_GMSH = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]
"""gmsh's ten nodes in scikit-fem's order: the last two edges change places."""

MANY = 0.005
"""Share of inverted elements above which smaller ones are a better cure than untangling, which may take minutes."""

MM = 1e-3


class Unmeshable(Exception):
    """An attempt that failed, in words."""


@dataclass(frozen=True, eq=False, kw_only=True)
class _Model:
    """The current model of gmsh: its volumes, and the index of the body that each belongs to by tag."""

    gmsh: Any
    names: Sequence[str]
    volumes: tuple[Volume, ...]
    owner: Mapping[int, int]

    def name(self, volume: int) -> str:
        return self.names[self.owner[volume]]


def work(folder: Path) -> None:
    """Do the job in `folder`."""
    job = json.loads((folder / JOB).read_text(encoding="utf-8"))
    try:
        mesh = tetrahedra(folder, job["bodies"], Sizing(**job["sizing"]))
        np.savez(folder / MESH, allow_pickle=False, **packed.pack_mesh(mesh))
    except Unmeshable as fault:
        _report(folder, {"unmeshable": str(fault)})
    except BadInput as fault:
        _report(folder, {key: getattr(fault, key) for key in ("source", "field", "problem", "remedy")})


def tetrahedra(folder: Path, names: Sequence[str], sizes: Sizing) -> SolidMesh:
    """Curved tetrahedra of the bodies called `names`, whose BREP files are in `folder`.

    Raises
    ------
    BadInput : bodies that share volume, or more degrees of freedom than `sizes` allows.
    Unmeshable : gmsh fails, elements stay inverted, or they do not fill the drawing.
    """
    with session() as gmsh:
        model = _model(gmsh, names, folder)
        _require_affordable(model, sizes)
        return _mesh(model, sizes)


def _report(folder: Path, fault: Mapping[str, str]) -> None:
    (folder / FAULT).write_text(json.dumps(fault), encoding="utf-8")


# --- geometry -------------------------------------------------------------------------------------------------------------


def _model(gmsh: Any, names: Sequence[str], folder: Path) -> _Model:
    imported = [_imported(gmsh, name, folder / f"{index}.brep") for index, name in enumerate(names)]
    owner = _fragmented(gmsh, names, imported)
    volumes = tuple(sizing.measured(gmsh, tag) for tag in sorted(owner))
    return _Model(gmsh=gmsh, names=names, volumes=volumes, owner=owner)


def _imported(gmsh: Any, name: str, path: Path) -> list[tuple[int, int]]:
    volumes = [entity for entity in gmsh.model.occ.importShapes(str(path)) if entity[0] == 3]
    if not volumes:
        raise BadInput(source=f"part {name}", problem="gmsh finds no solid in it", remedy="Make it a closed solid in the CAD")
    return volumes


def _fragmented(gmsh: Any, names: Sequence[str], imported: Sequence[list[tuple[int, int]]]) -> dict[int, int]:
    """All volumes cut at each other's faces; the body that each piece belongs to by tag."""
    entities = [(entity, index) for index, group in enumerate(imported) for entity in group]
    if len(entities) > 1:
        first, *others = [entity for entity, _ in entities]
        _, pieces = gmsh.model.occ.fragment([first], others)
    else:
        pieces = [[entity] for entity, _ in entities]
    gmsh.model.occ.synchronize()
    owner: dict[int, int] = {}
    for (_, index), group in zip(entities, pieces, strict=True):
        for _, tag in group:
            if tag in owner:
                raise _overlap(names[owner[tag]], names[index], gmsh.model.occ.getMass(3, tag))
            owner[tag] = index
    return owner


def _overlap(first: str, second: str, shared: float) -> BadInput:
    return BadInput(
        source=f"parts {first} and {second}",
        problem=f"they share {shared:.4g} mm³ of volume, which has no material of its own",
        remedy="Cut one by the other in the CAD, or correct its position",
    )


# --- mesh -----------------------------------------------------------------------------------------------------------------


def _mesh(model: _Model, sizes: Sizing) -> SolidMesh:
    curves: Sequence[int] = ()
    if sizes.refinement < 1:
        _generate(model, replace(sizes, refinement=1.0), ())
        curves = re_entrant.curves(model.gmsh)
    _generate(model, sizes, curves)
    _bend(model)
    made = _read(model)
    _require_filled(model, made)
    return made


def _require_filled(model: _Model, made: SolidMesh) -> None:
    """Refuse a mesh that is not as large as OCC says its bodies are."""
    drawn = np.zeros(len(model.names))
    for volume in model.volumes:
        drawn[model.owner[volume.tag]] += MM**3 * volume.volume
    if words := soundness.unfilled(made, drawn):
        raise Unmeshable(words)


def _generate(model: _Model, sizes: Sizing, curves: Sequence[int]) -> None:
    """First-order tetrahedra in the current model."""
    mesh = model.gmsh.model.mesh
    mesh.clear()
    sizing.apply(model.gmsh, model.volumes, sizes, curves)
    for dimension in (1, 2, 3):
        try:
            mesh.generate(dimension)
        except Exception as error:  # gmsh raises nothing else
            raise Unmeshable(_where(model, str(error))) from error
        _require_size(model, dimension, sizes)


def _where(model: _Model, error: str) -> str:
    """gmsh's own words, with the bodies where it failed."""
    failed = model.gmsh.model.mesh.getLastEntityError()
    names = dict.fromkeys(model.name(int(volume)) for entity in failed for volume in _volumes(model, *entity))
    there = f"in {', '.join(names)}" if names else "between the bodies"
    return f"gmsh fails {there} ({error.strip().rstrip('.')})"


def _volumes(model: _Model, dimension: int, tag: int) -> list[int]:
    if dimension == 3:
        return [tag]
    above = model.gmsh.model.getAdjacencies(dimension, tag)[0]
    return [volume for entity in above for volume in _volumes(model, dimension + 1, int(entity))]


def _require_affordable(model: _Model, sizes: Sizing) -> None:
    """Refuse before the work what a surface mesh of this size alone would need."""
    edges = [(volume, sizing.body_size(volume, sizes)) for volume in model.volumes]
    triangles = sum(volume.area / (0.6 * edge**2) for volume, edge in edges)
    tetrahedra = sum(volume.volume / (0.2 * edge**3) for volume, edge in edges)
    _refuse_above(sizes, int(max(6 * triangles, 4 * tetrahedra)), "at least ")


def _require_size(model: _Model, dimension: int, sizes: Sizing) -> None:
    """Refuse once the count is known: two mid-side and corner nodes a triangle of the skin, then corners and edges of all."""
    if dimension == 1:
        return
    mesh = model.gmsh.model.mesh
    if dimension == 2:
        _refuse_above(sizes, 6 * _count(mesh, 2), "at least ")
    else:
        _refuse_above(sizes, 3 * (2 * len(mesh.getNodes()[0]) + _count(mesh, 3)), "about ")


def _count(mesh: Any, dimension: int) -> int:
    return sum(len(tags) for tags in mesh.getElements(dimension)[1])


def _refuse_above(sizes: Sizing, found: int, words: str) -> None:
    if found > sizes.largest:
        given = "none" if sizes.size is None else f"{1e3 * sizes.size:g} mm"
        raise BadInput(
            source="mesh",
            field="size",
            problem=f"the mesh would have {words}{found:,} degrees of freedom, {sizes.largest:,} are allowed "
            f"(size given: {given}, fineness {sizes.fineness:g})",
            remedy="Give a larger element size or a smaller fineness, or allow more",
        )


# --- second order ---------------------------------------------------------------------------------------------------------


def _bend(model: _Model) -> None:
    """Second order on the true surfaces; elements that turn inside out by it are untangled, if that can be done."""
    mesh = model.gmsh.model.mesh
    mesh.setOrder(2)
    for method in ("HighOrder", "HighOrderElastic"):
        if not 0 < len(_inverted(model)) <= MANY * _count(mesh, 3):
            break
        mesh.optimize(method)
    _require_upright(model)


def _inverted(model: _Model) -> Integers:
    """Tags of the elements whose Jacobian is not positive everywhere, worst first."""
    mesh = model.gmsh.model.mesh
    tags = np.concatenate(mesh.getElements(3)[1])
    least = np.asarray(mesh.getElementQualities(tags, "minDetJac"))
    order = np.argsort(least, kind="stable")
    return np.asarray(tags[order][least[order] <= 0], dtype=np.intp)


def _require_upright(model: _Model) -> None:
    inverted = _inverted(model)
    if len(inverted):
        worst = [model.gmsh.model.mesh.getElement(tag) for tag in inverted[:3]]
        places = [f"{model.name(volume)} at {_centre(model, nodes)} mm" for _, nodes, _, volume in worst]
        raise Unmeshable(f"{len(inverted)} elements are inverted, the worst in {'; '.join(places)}")


def _centre(model: _Model, nodes: Sequence[int]) -> str:
    points = [model.gmsh.model.mesh.getNode(node)[0] for node in nodes[:4]]
    return "(" + ", ".join(f"{value:.1f}" for value in np.mean(points, axis=0)) + ")"


def _read(model: _Model) -> SolidMesh:
    """The mesh in metres, nodes numbered from 0."""
    mesh = model.gmsh.model.mesh
    tags, coordinates, _ = mesh.getNodes()
    cells, part = [], []
    for volume in sorted(model.owner):
        _, (elements,), (nodes,) = mesh.getElements(3, volume)
        cells.append(np.reshape(nodes, (-1, 10))[:, FROM_GMSH])
        part.append(np.full(len(elements), model.owner[volume]))
    used, numbered = np.unique(np.concatenate(cells), return_inverse=True)
    places: Array = np.reshape(coordinates, (-1, 3))[np.argsort(tags)]
    return SolidMesh(
        points=MM * places[np.searchsorted(np.sort(tags), used)],
        cells=numbered.reshape(-1, 10).astype(np.intp),
        part=np.concatenate(part).astype(np.intp),
        parts=tuple(model.names),
    )


if __name__ == "__main__":
    work(Path(sys.argv[1]))
