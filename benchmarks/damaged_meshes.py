"""How often the interval of an estimate holds the truth: 200 meshes damaged on purpose, of which the truth is known.

    python -m benchmarks.damaged_meshes [COUNT]

Eight bodies in random poses and proportions; six kinds of damage, one or two at once: faces missing at random, a patch missing,
faces turned over, faces doubled, corners of a triangle soup pulled apart, and a second skin inside that would count twice. Each
goes through mending and the estimate. The interval of a mesh holds the truth when that of each of the ten parameters does.
"""

import sys
from typing import Any

import numpy as np

from geometry import mesh as meshes
from geometry import repair
from geometry.frames import Array
from geometry.mesh import TriangleMesh


def sound(random: np.random.Generator) -> TriangleMesh:
    """A closed body in a random pose."""
    from trimesh import creation, transformations

    kinds: list[Any] = [
        lambda: creation.box(extents=(1, 0.6, 0.4)).subdivide().subdivide().subdivide(),
        lambda: creation.icosphere(subdivisions=3),
        lambda: creation.cylinder(radius=0.4, height=1.5, sections=48).subdivide().subdivide(),
        lambda: creation.capsule(height=1.0, radius=0.3),
        lambda: creation.torus(major_radius=1.0, minor_radius=0.3),
        lambda: creation.annulus(r_min=0.5, r_max=0.8, height=0.6, sections=48).subdivide().subdivide(),
        lambda: creation.cone(radius=0.6, height=1.2, sections=40).subdivide().subdivide().subdivide(),
        lambda: creation.uv_sphere(radius=0.7),
    ]
    one = kinds[int(random.integers(len(kinds)))]()
    vertices = np.asarray(one.vertices) * random.uniform(0.5, 1.5, 3) * 10 ** random.uniform(-2, 0)
    turn = transformations.random_rotation_matrix(random.uniform(size=3))[:3, :3]
    return meshes.merged(TriangleMesh(vertices=vertices @ turn.T, faces=np.asarray(one.faces)))


def damaged(mesh: TriangleMesh, random: np.random.Generator) -> TriangleMesh:
    """`mesh` with one or two kinds of damage."""
    for kind in random.choice(6, size=int(random.integers(1, 3)), replace=False):
        count = len(mesh.faces)
        if kind == 0:
            mesh = meshes.selected(mesh, random.uniform(size=count) > random.uniform(0.005, 0.1))
        elif kind == 1:
            middles = mesh.triangles.mean(axis=1)
            near = np.argsort(np.linalg.norm(middles - middles[int(random.integers(count))], axis=1))
            keep = np.ones(count, dtype=np.bool_)
            keep[near[: int(random.uniform(0.01, 0.12) * count)]] = False
            mesh = meshes.selected(mesh, keep)
        elif kind == 2:
            turned = random.uniform(size=count) < random.uniform(0.01, 0.3)
            mesh = TriangleMesh(vertices=mesh.vertices, faces=np.where(turned[:, None], mesh.faces[:, ::-1], mesh.faces))
        elif kind == 3:
            again = mesh.faces[random.uniform(size=count) < 0.2]
            mesh = TriangleMesh(vertices=mesh.vertices, faces=np.vstack([mesh.faces, again]))
        elif kind == 4:
            size = float(np.median(np.linalg.norm(np.diff(mesh.triangles, axis=1), axis=2)))
            corners = mesh.triangles.reshape(-1, 3) + random.normal(size=(3 * count, 3)) * size * random.uniform(0.01, 0.08)
            mesh = TriangleMesh(vertices=corners, faces=np.arange(3 * count).reshape(-1, 3))
        else:
            # a copy of a part of the body, inside of it: it crosses the skin or lies within, and counts twice by divergence
            middle = mesh.bounds.mean(axis=0)
            inner = middle + 0.7 * (mesh.vertices - middle)
            inside = meshes.winding_numbers(mesh, inner)
            if inside.min() > 0.9:
                mesh = meshes.joined(mesh, TriangleMesh(vertices=inner, faces=mesh.faces))
    return mesh


def held(seed: int) -> tuple[bool, float, float]:
    """Whether the interval of the mesh number `seed` holds the truth; by what share it is off, and how wide its interval is."""
    random = np.random.default_rng(seed)
    whole = sound(random)
    truth: Array = meshes.inertia_unchecked(whole, 1.0).parameters
    found = repair.estimated(repair.mended(damaged(whole, random)).mesh)
    off = np.abs(found.inertia.parameters - truth)
    return bool(np.all(off <= found.error)), off[0] / truth[0], found.error[0] / truth[0]


def main(count: int = 200) -> None:
    results = [held(seed) for seed in range(count)]
    inside, off, wide = (np.array(one) for one in zip(*results, strict=True))
    sys.stdout.write(
        f"{count} damaged meshes: the interval holds the truth of {100 * inside.mean():.1f} % (bar 95 %)\n"
        f"mass off by {100 * np.median(off):.2g} % in the middle, {100 * np.quantile(off, 0.95):.2g} % of one in twenty; "
        f"half-width {100 * np.median(wide):.2g} % and {100 * np.quantile(wide, 0.95):.2g} %\n"
    )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
