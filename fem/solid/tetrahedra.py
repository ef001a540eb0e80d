"""Any article as curved ten-node tetrahedra, made by gmsh.

Every part is drawn by OCC, handed over as BREP in millimetres and fragmented with the others, so that bodies in contact share
the nodes of the common face and no joint has to be invented. The first-order mesh is made first; its edges are then bent onto
the true surfaces, since straight ones lose mass at every circle. What cannot be meshed is tried again with smaller elements
before it is refused.
"""

import hashlib
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from fem.solid import assembly
from fem.solid.assembly import SolidMesh, lame, session
from geometry.article import Article, Box, Material, Part, Placed
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array, Integers
from geometry.user_article import UserArticle

# What a solid model is made from: bodies that OCC can draw, each of one material with a stiffness.
#
# A drawing of primitives (`geometry.article.Article`) and a user's STEP file (`geometry.user_article.UserArticle`) both end here.
# The drawing itself is put off until a mesh is wanted; what a body's geometry is known by, its `fingerprint`, needs no OCC.

AnyArticle = Article | UserArticle


@dataclass(frozen=True, eq=False, kw_only=True)
class SolidBody:
    """One part of an article on its way to a mesh.

    Attributes
    ----------
    name : of the part
    material : with modulus and Poisson's ratio
    write : writes its solid(s) as BREP in millimetres, in the article's frame, to a path
    fingerprint : hexadecimal digest of its geometry
    """

    name: str
    material: Material
    write: Callable[[Path], None]
    fingerprint: str


def bodies(article: AnyArticle) -> tuple[SolidBody, ...]:
    """The counted parts of `article`.

    Raises
    ------
    BadInput : nothing counts; a part is a mesh without a solid; a material is not elastic.
    """
    found: list[SolidBody] = []
    if isinstance(article, Article):
        found = [_drawn(part) for part in article.counted_parts]
    else:
        for part in article.parts:
            if part.solid is None:
                problem = f"part {part.name} is a surface mesh, and the solid model needs the solid itself"
                raise BadInput(part.source, "", problem, "Export it from the CAD as STEP")
            found.append(imported(part.name, part.material, part.solid))
    if not found:
        raise BadInput(f"article {article.name}", "", "no part of it counts", "Name an article with mass")
    for body in found:
        lame(body.material, body.name)
    return tuple(found)


def _drawn(part: Part) -> SolidBody:
    def write(path: Path) -> None:
        from geometry.cad import solid, write_brep

        write_brep(path, solid(part))

    described = {"pose": _numbers(part.pose), "solids": _placed(part.shape.solids), "voids": _placed(part.shape.voids)}
    digest = hashlib.sha256(json.dumps(described).encode()).hexdigest()
    return SolidBody(name=part.name, material=part.material, write=write, fingerprint=digest)


def imported(name: str, material: Material, solid: Any) -> SolidBody:
    """The body of a `solid` as CAD has it."""
    from geometry import cad

    digest = cad.brep_digest(solid)
    return SolidBody(name=name, material=material, write=lambda path: cad.write_brep(path, solid), fingerprint=digest)


def _placed(placed: tuple[Placed, ...]) -> list[Any]:
    described = []
    for one in placed:
        shape = one.primitive
        sizes = shape.size.tolist() if isinstance(shape, Box) else [shape.diameter, shape.height]
        described.append([type(shape).__name__, *(float(size).hex() for size in sizes), *_numbers(one.pose)])
    return described


def _numbers(pose: Any) -> list[str]:
    return [float(number).hex() for number in np.append(pose.position, pose.rotation)]


# Re-entrant edges, found in a mesh: where the material around an edge of the skin fills more than half a turn.
#
# The angles of all tetrahedra at an edge add up to the angle of the material there, whatever faces, bodies and seams meet in
# it. The elastic stress is singular at such an edge, and uniform meshes converge slowly there (Williams, J. Appl. Mech. 19,
# 1952, 526).

HALF_A_TURN = np.deg2rad(200.0)
"""A flat skin has 180 degrees, and a coarse mesh of a round hole a little more."""

FULL_TURN = np.deg2rad(359.0)
"""Edges inside the material have it."""

_EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (2, 3), (1, 3))


def _re_entrant(gmsh: Any) -> list[int]:
    """Tags of the re-entrant curves of the current model, which is meshed with first-order tetrahedra."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    points, number = np.reshape(coordinates, (-1, 3))[np.argsort(tags)], np.zeros(int(max(tags)) + 1, dtype=np.int64)
    number[np.sort(tags)] = np.arange(len(tags))
    cells = number[np.concatenate(gmsh.model.mesh.getElements(3)[2]).astype(np.int64)].reshape(-1, 4)
    pairs, angles = [], []
    for pair in _EDGES:
        a, b, c, d = (points[cells[:, corner]] for corner in (*pair, *(other for other in range(4) if other not in pair)))
        pairs.append(np.sort(cells[:, pair], axis=1))
        # Angle between the faces abc and abd along ab
        along = (b - a) / np.linalg.norm(b - a, axis=1, keepdims=True)
        sides = [v - np.sum(v * along, axis=1, keepdims=True) * along for v in (c - a, d - a)]
        angles.append(np.arctan2(np.linalg.norm(np.cross(*sides), axis=1), np.sum(sides[0] * sides[1], axis=1)))
    edges, where = np.unique(np.vstack(pairs), axis=0, return_inverse=True)
    around = np.bincount(where.ravel(), weights=np.concatenate(angles))
    sharp, found = {tuple(edge) for edge in edges[(around > HALF_A_TURN) & (around < FULL_TURN)].tolist()}, []
    for _, curve in gmsh.model.getEntities(1):
        nodes = [np.reshape(group, (-1, 2)) for group in gmsh.model.mesh.getElements(1, curve)[2]]
        own = np.sort(number[np.vstack(nodes).astype(np.int64)], axis=1).tolist() if nodes else []
        if own and 2 * sum(tuple(edge) in sharp for edge in own) >= len(own):
            found.append(curve)
    return found


# How large the elements are: from thickness and curvature, by one number finer, and finer still at re-entrant edges.
#
# Three rules, the smallest holds. A body's own size follows its mean thickness 2 V / A (exactly the thickness of a plate, a
# third of a cube's edge). A curved face has at least `AROUND` elements on a full circle, and on a thin wall so many that a
# chord does not cut through a quarter of the wall. At a re-entrant edge, where stress is singular, elements are `refinement`
# times smaller. Away from what is small the size grows by `GROWTH` metres a metre.

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


LARGEST_MESH = 500_000
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
    largest: int = LARGEST_MESH

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
        raise BadInput("mesh", field, f"{condition}, found {found!r}", "Correct it, or leave it out")


@dataclass(frozen=True, kw_only=True)
class Volume:
    """A gmsh volume: its tag, mean thickness 2 V / A, longest dimension of its box, volume and area, in millimetres."""

    tag: int
    thickness: float
    longest: float
    volume: float
    area: float


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
        beside, _ = gmsh.model.getAdjacencies(1, curve)
        around = {int(volume) for face in beside for volume in gmsh.model.getAdjacencies(2, face)[0]}
        curves[curve] = sizing.refinement * min(curves.get(curve, np.inf), *(sizes[tag] for tag in around))
    fields = [_constant(gmsh, "VolumesList", tag, size) for tag, size in sizes.items()]
    fields += [_constant(gmsh, "SurfacesList", tag, size) for tag, size in faces.items()]
    # One field for the curves of each size: that size on them, `GROWTH` more with the distance
    largest = max(sizes.values())
    for size in sorted(set(np.round(list(curves.values()), 6))):
        distance = gmsh.model.mesh.field.add("Distance")
        gmsh.model.mesh.field.setNumbers(distance, "CurvesList", [tag for tag, own in curves.items() if round(own, 6) == size])
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
    # The smallest of the fields, and nothing else, rules
    least = gmsh.model.mesh.field.add("Min")
    gmsh.model.mesh.field.setNumbers(least, "FieldsList", fields)
    gmsh.model.mesh.field.setAsBackgroundMesh(least)
    for option in ("MeshSizeExtendFromBoundary", "MeshSizeFromPoints", "MeshSizeFromCurvature"):
        gmsh.option.setNumber(f"Mesh.{option}", 0)


def _curved_faces(gmsh: Any, volumes: Sequence[Volume], sizes: Mapping[int, float], sizing: Sizing) -> dict[int, float]:
    """Faces whose curvature asks for smaller elements than their body has, and that size [mm]."""
    found: dict[int, float] = {}
    for volume in volumes:
        for face in _faces(gmsh, volume.tag):
            # Edge [mm] on a face of `radius` on a wall of `volume.thickness` [mm]
            # Smallest radius of curvature [mm] found on `face`; infinite on a plane
            if gmsh.model.getType(2, face) == "Plane":
                radius = float(np.inf)
            else:
                lower, upper = gmsh.model.getParametrizationBounds(2, face)
                grid = np.array(list(product(*(np.linspace(a, b, 5)[1:-1] for a, b in zip(lower, upper, strict=True)))))
                largest, smallest, *_ = gmsh.model.getPrincipalCurvatures(face, grid.ravel())
                curvature = np.abs([largest, smallest]).max()
                radius = float(1 / curvature) if curvature > 0 else float(np.inf)
            if not np.isfinite(radius):
                size = np.inf
            else:
                around = 2 * np.pi * radius / max(AROUND, AROUND * sizing.fineness)
                chord = np.sqrt(8 * radius * CUT * volume.thickness) / max(1.0, sizing.fineness)
                size = float(min(around, chord))
            if size < sizes[volume.tag]:
                found[face] = min(size, found.get(face, np.inf))
    return found


def _faces(gmsh: Any, volume: int) -> list[int]:
    return [tag for _, tag in gmsh.model.getBoundary([(3, volume)], oriented=False)]


def _constant(gmsh: Any, kind: str, tag: int, size: float) -> int:
    field: int = gmsh.model.mesh.field.add("Constant")
    gmsh.model.mesh.field.setNumbers(field, kind, [tag])
    gmsh.model.mesh.field.setNumber(field, "VIn", size)
    gmsh.model.mesh.field.setNumber(field, "IncludeBoundary", 1)
    return field


# gmsh at work, in a process of its own: ``python -m fem.solid.tetrahedra FOLDER``.
#
# gmsh ends its process on some geometries instead of reporting a fault, and cannot be interrupted; `fem.solid.tetrahedra`
# therefore starts this module for every attempt, with the job in `FOLDER` (``job.json`` and one BREP a body, in millimetres),
# and finds the answer there: ``mesh.npz``, or ``fault.json``.


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
        mesh = mesh_bodies(folder, job["bodies"], Sizing(**job["sizing"]))
        np.savez(folder / MESH, allow_pickle=False, **assembly.pack_mesh(mesh))
    except Unmeshable as fault:
        _report(folder, {"unmeshable": str(fault)})
    except BadInput as fault:
        _report(folder, {key: getattr(fault, key) for key in ("source", "field", "problem", "remedy")})


def mesh_bodies(folder: Path, names: Sequence[str], sizes: Sizing) -> SolidMesh:
    """Curved tetrahedra of the bodies called `names`, whose BREP files are in `folder`.

    Raises
    ------
    BadInput : bodies that share volume, or more degrees of freedom than `sizes` allows.
    Unmeshable : gmsh fails, elements stay inverted, or they do not fill the drawing.
    """
    with session() as gmsh:
        entities = []
        for index, name in enumerate(names):
            solids = [entity for entity in gmsh.model.occ.importShapes(str(folder / f"{index}.brep")) if entity[0] == 3]
            if not solids:
                problem, remedy = "gmsh finds no solid in it", "Make it a closed solid in the CAD"
                raise BadInput(f"part {name}", "", problem, remedy)
            entities += [(entity, index) for entity in solids]
        # All volumes cut at each other's faces; the body that each piece belongs to by tag
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
                    shared = gmsh.model.occ.getMass(3, tag)
                    problem = f"they share {shared:.4g} mm³ of volume, which has no material of its own"
                    remedy = "Cut one by the other in the CAD, or correct its position"
                    raise BadInput(f"parts {names[owner[tag]]} and {names[index]}", "", problem, remedy)
                owner[tag] = index
        volumes = []
        for tag in sorted(owner):
            volume = gmsh.model.occ.getMass(3, tag)
            area = sum(gmsh.model.occ.getMass(2, face) for face in _faces(gmsh, tag))
            longest = float(np.ptp(np.reshape(gmsh.model.getBoundingBox(3, tag), (2, 3)), axis=0).max())
            volumes.append(Volume(tag=tag, thickness=2 * volume / area, longest=longest, volume=volume, area=area))
        model = _Model(gmsh=gmsh, names=names, volumes=tuple(volumes), owner=owner)
        # Refuse before the work what a surface mesh of this size alone would need
        edges = [(each, body_size(each, sizes)) for each in volumes]
        triangles = sum(each.area / (0.6 * edge**2) for each, edge in edges)
        tetrahedra = sum(each.volume / (0.2 * edge**3) for each, edge in edges)
        _refuse_above(sizes, int(max(6 * triangles, 4 * tetrahedra)), "at least ")
        return _mesh(model, sizes)


def _report(folder: Path, fault: Mapping[str, str]) -> None:
    (folder / FAULT).write_text(json.dumps(fault), encoding="utf-8")


def _mesh(model: _Model, sizes: Sizing) -> SolidMesh:
    curves: Sequence[int] = ()
    if sizes.refinement < 1:
        _generate(model, replace(sizes, refinement=1.0), ())
        curves = _re_entrant(model.gmsh)
    _generate(model, sizes, curves)
    # Second order on the true surfaces; elements that turn inside out by it are untangled, if that can be done
    mesh = model.gmsh.model.mesh
    mesh.setOrder(2)
    for method in ("HighOrder", "HighOrderElastic"):
        if not 0 < len(_inverted(model)) <= MANY * _count(mesh, 3):
            break
        mesh.optimize(method)
    inverted = _inverted(model)
    if len(inverted):
        worst, places = [model.gmsh.model.mesh.getElement(tag) for tag in inverted[:3]], []
        for _, nodes, _, volume in worst:
            centre = np.mean([model.gmsh.model.mesh.getNode(node)[0] for node in nodes[:4]], axis=0)
            places.append(f"{model.name(volume)} at ({', '.join(f'{value:.1f}' for value in centre)}) mm")
        raise Unmeshable(f"{len(inverted)} elements are inverted, the worst in {'; '.join(places)}")
    made, drawn = _read(model), np.zeros(len(model.names))  # it must be as large as OCC says its bodies are
    for volume in model.volumes:
        drawn[model.owner[volume.tag]] += MM**3 * volume.volume
    if words := assembly.unfilled(made, drawn):
        raise Unmeshable(words)
    return made


def _generate(model: _Model, sizes: Sizing, curves: Sequence[int]) -> None:
    """First-order tetrahedra in the current model."""
    mesh = model.gmsh.model.mesh
    mesh.clear()
    apply(model.gmsh, model.volumes, sizes, curves)
    for dimension in (1, 2, 3):
        try:
            mesh.generate(dimension)
        except Exception as error:  # gmsh raises nothing else
            failed = mesh.getLastEntityError()
            names = dict.fromkeys(model.name(int(volume)) for entity in failed for volume in _volumes(model, *entity))
            there = f"in {', '.join(names)}" if names else "between the bodies"
            raise Unmeshable(f"gmsh fails {there} ({str(error).strip().rstrip('.')})") from error
        # Two mid-side and corner nodes a triangle of the skin, then corners and edges of all
        if dimension == 2:
            _refuse_above(sizes, 6 * _count(mesh, 2), "at least ")
        elif dimension == 3:
            _refuse_above(sizes, 3 * (2 * len(mesh.getNodes()[0]) + _count(mesh, 3)), "about ")


def _volumes(model: _Model, dimension: int, tag: int) -> list[int]:
    if dimension == 3:
        return [tag]
    above = model.gmsh.model.getAdjacencies(dimension, tag)[0]
    return [volume for entity in above for volume in _volumes(model, dimension + 1, int(entity))]


def _count(mesh: Any, dimension: int) -> int:
    return sum(len(tags) for tags in mesh.getElements(dimension)[1])


def _refuse_above(sizes: Sizing, found: int, words: str) -> None:
    if found > sizes.largest:
        given = "none" if sizes.size is None else f"{1e3 * sizes.size:g} mm"
        problem = (
            f"the mesh would have {words}{found:,} degrees of freedom, {sizes.largest:,} are allowed "
            f"(size given: {given}, fineness {sizes.fineness:g})"
        )
        raise BadInput("mesh", "size", problem, "Give a larger element size or a smaller fineness, or allow more")


# --- second order ---------------------------------------------------------------------------------------------------------


def _inverted(model: _Model) -> Integers:
    """Tags of the elements whose Jacobian is not positive everywhere, worst first."""
    mesh = model.gmsh.model.mesh
    tags = np.concatenate(mesh.getElements(3)[1])
    least = np.asarray(mesh.getElementQualities(tags, "minDetJac"))
    order = np.argsort(least, kind="stable")
    return np.asarray(tags[order][least[order] <= 0], dtype=np.intp)


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


FINER = (1.0, 1.4, 2.0)
"""Fineness of the attempts, relative to the one asked for; a mesh that fails or is inverted is often only too coarse."""

TIME_LIMIT = 1800.0
"""Seconds after which gmsh is taken to hang."""


def tetrahedra(bodies: Sequence[SolidBody], sizes: Sizing | None = None) -> SolidMesh:
    """Curved tetrahedra of `bodies`, conforming where they touch; the same input gives the same mesh.

    Raises
    ------
    BadInput : bodies that share volume, or more degrees of freedom than `sizes` allows.
    CheckFailed : no valid mesh after several attempts; the message says which body, or how many elements are inverted and where,
        or how much of which body is missing.
    """
    sizes = sizes or Sizing()
    with tempfile.TemporaryDirectory() as folder:
        for index, body in enumerate(bodies):
            body.write(Path(folder, f"{index}.brep"))
        failures: list[str] = []
        for finer in FINER:
            try:
                return _attempt(Path(folder), bodies, replace(sizes, fineness=sizes.fineness * finer))
            except Unmeshable as failure:
                failures.append(str(failure))
            except BadInput as refusal:
                if failures and refusal.field == "size":
                    break  # too fine to be afforded: what made it finer is what the user must hear
                raise
    raise CheckFailed(
        f"no valid mesh after {len(failures)} attempt(s): {failures[-1]}. Give a smaller element size, or simplify the body "
        "there in the CAD",
        failures=tuple(failures),
    )


def _attempt(folder: Path, bodies: Sequence[SolidBody], sizes: Sizing) -> SolidMesh:
    """One run of `fem.solid.tetrahedra`; its answer, or its fault raised here."""
    assembly.require_gmsh()
    job = {"bodies": [body.name for body in bodies], "sizing": asdict(sizes)}
    (folder / JOB).write_text(json.dumps(job), encoding="utf-8")
    for left in (MESH, FAULT):
        (folder / left).unlink(missing_ok=True)
    # A process of its own; an interruption here ends it too
    command = [sys.executable, "-P", "-m", "fem.solid.tetrahedra", str(folder)]
    environment, words = {**os.environ, "PYTHONPATH": os.pathsep.join(entry or os.getcwd() for entry in sys.path)}, ""
    try:
        run = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=TIME_LIMIT, check=False)
        last = [line for line in run.stderr.splitlines() if line.strip()][-1:]
        if run.returncode:
            words = f"gmsh broke down ({''.join(last).strip() or run.returncode})"
    except subprocess.TimeoutExpired:
        words = f"gmsh has not finished after {TIME_LIMIT / 60:g} minutes"
    if (folder / FAULT).is_file():
        said = json.loads((folder / FAULT).read_text(encoding="utf-8"))
        raise Unmeshable(said["unmeshable"]) if "unmeshable" in said else BadInput(**said)
    if words:
        raise Unmeshable(words)
    with np.load(folder / MESH, allow_pickle=False) as arrays:
        return assembly.unpack_mesh(arrays)


if __name__ == "__main__":
    work(Path(sys.argv[1]))
