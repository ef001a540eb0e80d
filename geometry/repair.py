"""Meshes that are no skin of a body: what can be mended safely, and an estimate of what the rest encloses.

Mending changes no shape that is there: vertices at nearly one place become one, faces that are given twice or have collapsed go,
normals are made to agree, and holes that are small beside the body are closed. Every step is said, with the volume that it moved.

What stays open, crosses itself or is a soup of triangles has no volume by definition. Its *generalised winding number* (Jacobson,
Kavan and Sorkine-Hornung, ACM Trans. Graph. 32, 2013) is the share of a full turn that the triangles close around a point: 1
inside and 0 outside of a closed surface, between them where something is missing. The body is where it exceeds one half; how much
the ten parameters move between the thresholds `LOW` and `HIGH` is what nobody can know from such a mesh, and is the interval.
"""

from dataclasses import dataclass

import numpy as np

from geometry import mesh as meshes
from geometry.frames import Array, frozen
from geometry.inertia import Inertia
from geometry.mesh import Integers, TriangleMesh
from geometry.toml_file import METRE, LengthUnit

WELD = 1e-6
"""Vertices closer than this share of the diagonal are taken for one: a tenth of what single precision keeps of an export."""

SMALL = 0.1
"""Largest extent of a hole that is closed, as a share of the diagonal of the body."""

LOW, HIGH = 0.25, 0.75
"""Thresholds of the winding number between which the truth mostly lies, midway to what is certainly out and certainly in."""

WIDER = 2.0
"""The interval is so many times what changes between them and what sampling leaves open. `benchmarks.damaged_meshes` sets it: of
200 meshes that were damaged on purpose it holds all ten parameters of at least 95 %. With 1 it held those of 85 % of sixty."""

POINTS = 60_000
"""Samples of the box around a mesh; their own error is in the interval."""


@dataclass(frozen=True, eq=False, kw_only=True)
class MendedMesh:
    """A mesh after mending, and every step in words."""

    mesh: TriangleMesh
    steps: tuple[str, ...]


@dataclass(frozen=True, eq=False, kw_only=True)
class EstimatedBody:
    """What a mesh that is no skin encloses.

    Attributes
    ----------
    inertia : at unit density, about the mesh's origin
    error : (10,) half-width of the interval of each parameter about the origin, order of `geometry.inertia.PARAMETERS`
    """

    inertia: Inertia
    error: Array


def mended(mesh: TriangleMesh, unit: LengthUnit = METRE) -> MendedMesh:
    """`mesh` with what can be mended safely mended; volumes in the steps are in cubes of `unit`."""
    steps: list[str] = []
    diagonal = float(np.linalg.norm(np.ptp(mesh.bounds, axis=0)))

    def said(words: str, now: TriangleMesh) -> TriangleMesh:
        moved = abs(now.volume - mesh.volume)
        share = f", {moved / abs(now.volume):.2g} of it" if moved and now.volume else ""
        steps.append(f"{words}: {moved / unit.metres**3:.3g} {unit.name}³ moved{share}")
        return now

    before = meshes.merged(mesh)
    grid = np.round(before.vertices / (WELD * diagonal)).astype(np.int64)
    _, first, index = np.unique(grid, axis=0, return_index=True, return_inverse=True)
    if len(first) < len(before.vertices):
        welded = TriangleMesh(vertices=before.vertices[first], faces=index.reshape(-1)[before.faces])
        mesh = said(f"{len(before.vertices) - len(first)} vertices made one with a neighbour", welded)
    else:
        mesh = before
    a, b, c = mesh.faces.T
    if (collapsed := (a == b) | (b == c) | (c == a)).any():
        mesh = said(f"{int(collapsed.sum())} collapsed faces removed", meshes.selected(mesh, ~collapsed))
    _, first, index, count = np.unique(
        np.sort(mesh.faces, axis=1), axis=0, return_index=True, return_inverse=True, return_counts=True
    )
    if (count > 1).any():
        # Copies of one orientation leave one face; a face and its reverse enclose nothing and leave none
        start = np.argmin(mesh.faces, axis=1)
        second = np.take_along_axis(mesh.faces, ((start + 1) % 3)[:, None], axis=1)[:, 0]
        along = np.where(second == np.sort(mesh.faces, axis=1)[:, 1], 1, -1)
        net = np.bincount(index.reshape(-1), weights=along, minlength=len(first))
        keep = np.zeros(len(mesh.faces), dtype=np.bool_)
        for group in np.flatnonzero(net):
            members = np.flatnonzero(index.reshape(-1) == group) if count[group] > 1 else first[group : group + 1]
            keep[members[along[members] == np.sign(net[group])][0]] = True
        mesh = said(f"{int((~keep).sum())} doubled faces removed", meshes.selected(mesh, keep))
    turned = meshes.oriented(mesh)
    # a cyclic order of three numbers has the sign of the product of its differences
    senses = [np.sign(one.faces - np.roll(one.faces, 1, axis=1)).prod(axis=1) for one in (turned, mesh)]
    if flipped := int((senses[0] != senses[1]).sum()):
        mesh = said(f"{flipped} faces turned to agree with their neighbours", turned)
    caps = _caps(mesh, SMALL * diagonal)
    if caps:
        closed = meshes.merged(meshes.joined(mesh, *caps))
        mesh = said(f"{len(caps)} small hole{'s' * (len(caps) > 1)} closed", closed)
    skins = list(meshes.pieces(mesh)) if len(mesh.faces) else []
    if skins and all(one.volume < 0 for one in skins) and not (meshes.edges(mesh).uses == 1).any():
        mesh = said("all normals turned outwards", TriangleMesh(vertices=mesh.vertices, faces=mesh.faces[:, ::-1]))
    return MendedMesh(mesh=mesh, steps=tuple(steps))


def _caps(mesh: TriangleMesh, largest: float) -> list[TriangleMesh]:
    """A fan of triangles for every hole of `mesh` that is a simple loop and no wider than `largest` [m]."""
    found = meshes.edges(mesh)
    directed = mesh.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    open_edges = directed[found.uses[found.of_face.reshape(-1)] == 1]
    following = dict(open_edges.tolist())
    if len(following) < len(open_edges) or set(following) != set(following.values()):
        # loops that touch in a point: which closes which cannot be told
        crowded = [start for start, number in zip(*np.unique(open_edges[:, 0], return_counts=True), strict=True) if number > 1]
        following = {start: end for start, end in following.items() if start not in crowded and end not in crowded}
    label, piece = meshes.piece_of_face(mesh), np.zeros(len(mesh.vertices), dtype=np.int64)
    piece[mesh.faces] = label[:, None]
    every = mesh.vertices[mesh.faces]
    extent = np.full((int(label.max(initial=-1)) + 1, 2, 3), np.inf)
    extent[:, 1] = -np.inf
    np.minimum.at(extent[:, 0], label, every.min(axis=1))
    np.maximum.at(extent[:, 1], label, every.max(axis=1))
    caps, left = [], set(following)
    while left:
        loop = [left.pop()]
        while (after := following.get(loop[-1])) is not None and after != loop[0] and after in left:
            left.discard(after)
            loop.append(after)
        if len(loop) < 3 or following.get(loop[-1]) != loop[0]:
            continue
        rim = mesh.vertices[loop]
        wide, around = (float(np.linalg.norm(np.ptp(places, axis=0))) for places in (rim, extent[piece[loop[0]]]))
        if wide > largest or 2 * wide > around:  # the rim of a lone triangle or of a scrap is no hole
            continue
        if len(loop) == 3:
            caps.append(TriangleMesh(vertices=rim, faces=np.array([[2, 1, 0]])))
            continue
        ring = np.arange(len(loop))
        fan: Integers = np.column_stack([np.roll(ring, -1), ring, np.full(len(loop), len(loop))])
        caps.append(TriangleMesh(vertices=np.vstack([rim, rim.mean(axis=0)]), faces=fan))
    return caps


def estimated(mesh: TriangleMesh, random: "np.random.Generator | None" = None) -> EstimatedBody:
    """What `mesh` encloses at unit density, closed or not; `random` draws the samples, by default the same ones every time.

    Raises
    ------
    ValueError : nothing is enclosed.
    """
    from scipy.stats import qmc

    low, high = mesh.bounds
    size = high - low
    draw = qmc.Sobol(3, rng=random or np.random.default_rng(0)).random(1 << int(np.log2(POINTS)))
    points = low + size * draw
    winding = meshes.winding_numbers(mesh, points)
    cell = float(np.prod(size)) / len(points)
    middle = 0.5 * (low + high)
    x, y, z = (points - middle).T
    terms = np.column_stack([np.ones_like(x), x, y, z, y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z])

    def parameters(threshold: float) -> Array:
        return np.asarray(cell * terms[winding > threshold].sum(axis=0))

    best = parameters(0.5)
    if best[0] <= 0:
        raise ValueError("`mesh` encloses nothing")
    # Sampling: the same sums over eight runs of the sequence, each of them as even as the whole
    parts = (8 * cell * terms * (winding > 0.5)[:, None]).reshape(8, -1, 10).sum(axis=1)
    sampling = 2 * np.std(parts, axis=0, ddof=1) / np.sqrt(8)
    unknown = np.max([np.abs(parameters(threshold) - best) for threshold in (LOW, HIGH)], axis=0)
    about_middle = Inertia(parameters=best).moved(middle)
    error = _carried(WIDER * (sampling + unknown), np.abs(middle))
    return EstimatedBody(inertia=about_middle, error=frozen(error, (10,), "error"))


def _carried(error: Array, lever: Array) -> Array:
    """`error` (10,) of parameters about one point as a bound about another at most `lever` (3,) [m] away."""
    m, first, tensor = error[0], error[1:4], error[4:]
    i, j = np.array([[1, 2], [0, 2], [0, 1], [0, 1], [0, 2], [1, 2]]).T
    moments = 2 * (first[i[:3]] * lever[i[:3]] + first[j[:3]] * lever[j[:3]]) + m * (lever[i[:3]] ** 2 + lever[j[:3]] ** 2)
    products = first[i[3:]] * lever[j[3:]] + first[j[3:]] * lever[i[3:]] + m * lever[i[3:]] * lever[j[3:]]
    return np.concatenate([[m], first + m * lever, tensor[:3] + moments, tensor[3:] + products])
