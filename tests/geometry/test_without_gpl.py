"""Where surfaces cross and what two bodies share, without the GPL: held to CGAL's exact answers, which only tests ask for."""

import numpy as np
import pytest
import trimesh
from igl.copyleft.cgal import mesh_boolean, remesh_self_intersections
from numpy.testing import assert_allclose

from benchmarks.damaged_meshes import damaged, sound
from geometry import mesh as meshes
from geometry.mesh import TriangleMesh


def of_cgal(mesh: TriangleMesh) -> set[tuple[int, int]]:
    pairs = remesh_self_intersections(mesh.vertices, mesh.faces, detect_only=True)[2]
    return {(int(min(pair)), int(max(pair))) for pair in np.reshape(pairs, (-1, 2))}


def ours(mesh: TriangleMesh) -> set[tuple[int, int]]:
    return {(int(a), int(b)) for a, b in meshes.intersecting_faces(mesh)}


def crossing(seed: int) -> TriangleMesh:
    """Two closed bodies, one through the other, the first one crumpled as well where `seed` is odd."""
    random = np.random.default_rng(seed)
    first, second = sound(random), sound(random)
    size = np.ptp(first.bounds) / np.ptp(second.bounds) * random.uniform(0.2, 1.0)
    centre = first.vertices[random.integers(len(first.vertices))]
    if seed % 2:
        step = np.ptp(first.bounds) / len(first.vertices) ** 0.5
        first = TriangleMesh(vertices=first.vertices + step * random.normal(size=first.vertices.shape) / 3, faces=first.faces)
    return meshes.joined(first, TriangleMesh(vertices=second.vertices * size + centre, faces=second.faces))


@pytest.mark.parametrize("seed", range(6))
def test_bodies_that_cross_themselves_and_others_do_so_in_the_faces_that_cgal_names(seed: int) -> None:
    mesh = crossing(seed)
    expected = of_cgal(mesh)
    assert expected
    assert ours(mesh) == expected


def test_meshes_damaged_on_purpose_cross_where_cgal_says_so() -> None:
    """Holes and turned faces left as they are, of doubled faces one of each."""
    crossed = 0
    for seed in range(8):
        random = np.random.default_rng(seed)
        mesh = meshes.merged(damaged(sound(random), random))
        _, first = np.unique(np.sort(mesh.faces, axis=1), axis=0, return_index=True)
        mesh = meshes.selected(mesh, np.isin(np.arange(len(mesh.faces)), first))
        expected = of_cgal(mesh)
        assert ours(mesh) == expected
        crossed += bool(expected)
    assert 2 <= crossed <= 6


def folded(*corners: tuple[float, float, float]) -> TriangleMesh:
    """A fan of tetrahedra over pairs of `corners`, all with the corner at the origin."""
    bodies = []
    for first, second in zip(corners[::2], corners[1::2], strict=True):
        points = np.array([(0.0, 0.0, 0.0), first, second, np.cross(first, second) + np.add(first, second) / 3])
        bodies.append(TriangleMesh(vertices=points, faces=np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])))
    return meshes.merged(meshes.joined(*bodies))


def test_an_edge_along_another_one_from_the_corner_they_share_is_a_contact_as_for_cgal() -> None:
    mesh = folded((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.5, 0.0, 0.0), (0.0, 0.0, -1.0))
    expected = of_cgal(mesh)
    assert len(expected) >= 4
    assert ours(mesh) == expected


def test_what_two_bodies_share_is_what_cgal_cuts_out_of_them() -> None:
    shares = []
    for seed in (2, 4):
        first, second = meshes.pieces(crossing(seed))
        vertices, faces, _ = mesh_boolean(first.vertices, first.faces, second.vertices, second.faces, "intersect")
        smaller = min(first.volume, second.volume)
        shared = meshes.shared_volumes((first, second)).get((0, 1), 0.0)
        shares.append([shared / smaller, TriangleMesh(vertices=vertices, faces=faces).volume / smaller])
    found, expected = np.transpose(shares)
    assert expected.max() > 0.05
    assert_allclose(found, expected, rtol=0, atol=1e-12)  # of the smaller body; rounding makes 1e-14


def test_what_is_no_closed_surface_shares_nothing_that_could_be_told() -> None:
    ball = trimesh.creation.icosphere(subdivisions=1)
    whole = TriangleMesh(vertices=ball.vertices, faces=ball.faces)
    with pytest.raises(ValueError, match="must be closed surfaces, found NotManifold"):
        meshes.shared_volumes((whole, TriangleMesh(vertices=ball.vertices, faces=ball.faces[1:])))
