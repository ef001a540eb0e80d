"""The door to trimesh: closed forms, scaling, rotation and convergence."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from geometry.frames import Pose, rotation_about
from geometry.inertia import Inertia
from geometry.mesh import TriangleMesh, inertia, joined, merged, pieces, placed, scaled

DENSITY = 2700.0


def of_trimesh(solid: trimesh.Trimesh) -> TriangleMesh:
    return merged(TriangleMesh(vertices=solid.vertices, faces=solid.faces))


def box(
    size: tuple[float, float, float] = (0.16, 0.07, 0.4), centre: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> TriangleMesh:
    return placed(of_trimesh(trimesh.creation.box(size)), Pose(position=np.array(centre)))


def turned(mesh: TriangleMesh) -> TriangleMesh:
    """`mesh` with its inside out."""
    return TriangleMesh(vertices=mesh.vertices, faces=mesh.faces[:, ::-1])


def lopsided() -> TriangleMesh:
    """A tetrahedron with nothing symmetrical about it."""
    corners = np.array([[0.1, 0.0, 0.2], [0.5, 0.1, 0.0], [0.2, 0.7, 0.1], [0.0, 0.2, 0.9]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    mesh = TriangleMesh(vertices=corners, faces=faces)
    return mesh if mesh.volume > 0 else turned(mesh)


def rotation(angles: tuple[float, float, float]) -> np.ndarray:
    return rotation_about("z", angles[0]) @ rotation_about("y", angles[1]) @ rotation_about("x", angles[2])


angles = st.tuples(*[st.floats(-3, 3)] * 3)
offsets = st.tuples(*[st.floats(-2, 2)] * 3)


def test_a_box_has_the_inertia_of_the_textbook_about_the_origin_of_its_mesh() -> None:
    a, b, c = 0.16, 0.07, 0.4
    mass, cog = DENSITY * a * b * c, (0.3, -0.2, 0.2)
    tensor = mass / 12 * np.diag([b**2 + c**2, a**2 + c**2, a**2 + b**2])
    expected = Inertia.from_cog(mass, cog, tensor)
    found = inertia(box((a, b, c), cog), DENSITY, "box")
    assert_allclose(found.parameters, expected.parameters, rtol=1e-12, atol=1e-14)  # exact but for rounding
    assert_allclose(found.reference_point, 0.0, atol=0)


def test_the_tensor_of_a_lopsided_body_has_the_signs_of_equation_4() -> None:
    """Second moments of a tetrahedron from its corners: integral x_i x_j dV = V/20 (sum_k x x + (sum_k x)(sum_k x))."""
    mesh = lopsided()
    corners, total = mesh.vertices, mesh.vertices.sum(axis=0)
    second = DENSITY * mesh.volume / 20 * (corners.T @ corners + np.outer(total, total))
    assert_allclose(inertia(mesh, DENSITY, "tet").tensor, np.trace(second) * np.eye(3) - second, rtol=1e-11)


@settings(max_examples=25, deadline=None)
@given(angles=angles, offset=offsets)
def test_placing_the_mesh_and_placing_the_inertia_are_the_same(angles, offset) -> None:
    pose = Pose(position=np.array(offset), rotation=rotation(angles))
    moved = inertia(placed(lopsided(), pose), DENSITY, "tet")
    expected = inertia(lopsided(), DENSITY, "tet").placed(pose)
    assert_allclose(moved.parameters, expected.parameters, rtol=1e-10, atol=1e-10 * np.abs(expected.parameters).max())


@settings(max_examples=25, deadline=None)
@given(factor=st.floats(1e-3, 1e3))
def test_lengths_times_s_make_mass_times_s3_first_moment_s4_and_tensor_s5(factor) -> None:
    powers = np.array([3, 4, 4, 4, 5, 5, 5, 5, 5, 5])
    expected = inertia(lopsided(), DENSITY, "tet").parameters * factor**powers
    assert_allclose(inertia(scaled(lopsided(), factor), DENSITY, "tet").parameters, expected, rtol=1e-10)


def test_a_body_far_from_the_origin_loses_no_digits_about_its_own_centre() -> None:
    far = inertia(box(centre=(1e3, -2e3, 5e2)), DENSITY, "box")
    assert_allclose(far.cog, [1e3, -2e3, 5e2], rtol=1e-12)
    assert_allclose(far.mass, inertia(box(), DENSITY, "box").mass, rtol=1e-10)  # coordinates of 2 km hold 5e-13 m


def test_the_icosphere_converges_to_the_sphere_with_the_square_of_the_edge_length() -> None:
    radius = 0.1
    exact_mass = DENSITY * 4 / 3 * np.pi * radius**3
    exact_moment = 2 / 5 * exact_mass * radius**2
    errors = []
    for subdivisions in (2, 3, 4):
        sphere = inertia(of_trimesh(trimesh.creation.icosphere(subdivisions, radius)), DENSITY, "sphere")
        errors.append([1 - sphere.mass / exact_mass, 1 - sphere.moments_cog.mean() / exact_moment])
    rates = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert_allclose(rates, 2.0, atol=0.05)  # edges halve each time; the next term of the error is of fourth order


def test_a_cavity_takes_its_mass_away_and_separate_pieces_add_up() -> None:
    hollow = joined(box(), turned(box((0.1, 0.05, 0.2))))
    expected = inertia(box(), DENSITY, "outer") - inertia(box((0.1, 0.05, 0.2)), DENSITY, "inner")
    assert_allclose(inertia(hollow, DENSITY, "hollow").parameters, expected.parameters, rtol=1e-12, atol=1e-14)
    pair = joined(box(), box(centre=(1.0, 0.0, 0.0)))
    total = inertia(box(), DENSITY, "one") + inertia(box(centre=(1.0, 0.0, 0.0)), DENSITY, "two")
    assert_allclose(inertia(pair, DENSITY, "pair").parameters, total.parameters, rtol=1e-12, atol=1e-14)


def test_it_is_what_trimesh_itself_finds() -> None:
    mesh = lopsided()
    solid = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    solid.density = DENSITY
    found = inertia(mesh, DENSITY, "tet")
    assert_allclose([found.mass, *found.cog], [solid.mass, *solid.center_mass], rtol=1e-12)
    assert_allclose(found.tensor_cog, solid.moment_inertia, rtol=1e-10)


def test_pieces_come_in_the_order_of_their_first_face_and_join_to_the_whole() -> None:
    whole = joined(box(), box((0.1, 0.1, 0.1), (2.0, 0.0, 0.0)), box((0.2, 0.1, 0.1), (4.0, 0.0, 0.0)))
    assert_allclose([piece.volume for piece in pieces(whole)], [0.16 * 0.07 * 0.4, 1e-3, 2e-3], rtol=1e-12)
    assert len(pieces(whole)[0].faces) == 12


def test_merging_closes_a_box_whose_faces_came_with_vertices_of_their_own() -> None:
    soup = box().triangles.reshape(-1, 3)
    loose = TriangleMesh(vertices=np.vstack([soup, [[9.0, 9.0, 9.0]]]), faces=np.arange(36).reshape(-1, 3))
    assert len(pieces(loose)) == 12
    closed = merged(loose)
    assert closed.vertices.shape == (8, 3)
    assert_allclose(inertia(closed, DENSITY, "box").mass, DENSITY * 0.16 * 0.07 * 0.4, rtol=1e-12)


def test_a_triangle_mesh_is_read_only_and_names_what_does_not_fit() -> None:
    mesh = box()
    with pytest.raises(ValueError, match="read-only"):
        mesh.vertices[0, 0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        mesh.faces[0, 0] = 1
    with pytest.raises(ValueError, match="`faces` must name vertices 0 to 7, found 0 to 8"):
        TriangleMesh(vertices=mesh.vertices, faces=np.array([[0, 1, 8]]))
    with pytest.raises(ValueError, match=r"`faces` must have shape \(k, 3\), found \(1, 4\)"):
        TriangleMesh(vertices=mesh.vertices, faces=np.array([[0, 1, 2, 3]]))
    with pytest.raises(ValueError, match="`vertices` must be finite"):
        TriangleMesh(vertices=np.full((3, 3), np.nan), faces=np.array([[0, 1, 2]]))
