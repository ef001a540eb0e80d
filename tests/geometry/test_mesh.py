"""Triangle meshes: closed forms, scaling and convergence, and every way in which one is not the skin of a body."""

import re
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from geometry.frames import Pose, rotation_about
from geometry.inertia import Inertia
from geometry.mesh import TriangleMesh, inertia, joined, merged, pieces, placed, require_closed_volume, scaled, selected
from geometry.toml_file import MILLIMETRE

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


def block(size=(2.0, 2.0, 2.0), centre=(0.0, 0.0, 0.0)) -> TriangleMesh:
    """A box with `size` and `centre` in millimetres."""
    solid = of_trimesh(trimesh.creation.box(size))
    return scaled(placed(solid, Pose(position=np.array(centre, dtype=float))), 1e-3)


def without_faces(mesh: TriangleMesh, *numbers: int) -> TriangleMesh:
    return selected(mesh, ~np.isin(np.arange(len(mesh.faces)), numbers))


def refusal(mesh: TriangleMesh) -> str:
    with pytest.raises(BadInput) as caught:
        inertia(mesh, 1000.0, "part.stl", MILLIMETRE)
    assert caught.value.source == "part.stl"
    assert caught.value.remedy
    return caught.value.problem


def faces_at_top(mesh: TriangleMesh) -> np.ndarray:
    return np.flatnonzero(np.all(mesh.triangles[:, :, 2] > 0.99e-3, axis=1))


@pytest.mark.parametrize(
    "solid",
    [
        trimesh.creation.icosphere(3),
        trimesh.creation.torus(2.0, 0.5),
        trimesh.creation.annulus(1.0, 2.0, 3.0),
        trimesh.creation.cylinder(1.0, 20.0, sections=90),
        trimesh.creation.capsule(),
    ],
    ids=["icosphere", "torus", "annulus", "cylinder", "capsule"],
)
@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_healthy_meshes_pass_whatever_their_size_without_a_warning(solid, size) -> None:
    tilted = Pose(position=np.array([0.3, 0.1, -0.2]), rotation=rotation_about("x", 0.3) @ rotation_about("z", 1.1))
    assert require_closed_volume(scaled(placed(of_trimesh(solid), tilted), size), "mesh") == ()


def test_pieces_apart_a_cavity_and_a_body_within_a_cavity_are_bodies() -> None:
    shell = joined(block((9, 9, 9)), turned(block((7, 7, 7))))
    assert require_closed_volume(joined(shell, block((2, 2, 2)), block(centre=(20, 0, 0))), "mesh") == ()


def test_bodies_that_only_touch_pass_without_a_warning() -> None:
    assert require_closed_volume(joined(block(), block((1, 1, 1), (1.5, 0.0, 0.0))), "mesh") == ()


def test_curved_bodies_that_fit_into_one_another_pass_with_the_sliver_named() -> None:
    pin = scaled(of_trimesh(trimesh.creation.cylinder(1.0, 4.0, sections=47)), 1e-3)
    turn = Pose(rotation=rotation_about("z", 0.01))  # or the two would share an edge
    bush = scaled(placed(of_trimesh(trimesh.creation.annulus(1.0, 3.0, 4.0, sections=61)), turn), 1e-3)
    warnings = require_closed_volume(joined(pin, bush), "bearing.stl", MILLIMETRE)
    assert len(warnings) == 1
    assert "bearing.stl: pieces 1 and 2 touch and their meshes overlap by 0.0" in warnings[0]


def test_an_open_mesh_is_refused_with_the_number_of_open_edges_and_where() -> None:
    top = faces_at_top(block())
    assert len(top) == 2
    problem = refusal(without_faces(block(), *top))
    assert problem == (
        "the mesh is not watertight: 4 of its 17 edges do not join exactly two faces; "
        "4 open edges in 1 hole: 4 edges within (-1, -1, 1) mm to (1, 1, 1) mm"
    )


def test_two_holes_are_listed_apart_the_larger_first() -> None:
    sphere = scaled(of_trimesh(trimesh.creation.icosphere(2)), 1e-3)
    middle = sphere.triangles.mean(axis=1)
    top, bottom = int(middle[:, 2].argmax()), int(middle[:, 2].argmin())
    neighbours = np.flatnonzero((np.isin(sphere.faces, sphere.faces[top]).sum(axis=1)) == 2)[:1]
    problem = refusal(without_faces(sphere, top, int(neighbours[0]), bottom))
    assert "7 open edges in 2 holes: 4 edges within" in problem
    assert "; 3 edges within" in problem


def test_more_than_three_holes_are_counted_but_not_all_listed() -> None:
    boxes = joined(*(without_faces(block(centre=(5 * k, 0, 0)), *faces_at_top(block())) for k in range(5)))
    assert refusal(boxes).endswith("; and 2 more")


def flipped(mesh: TriangleMesh) -> TriangleMesh:
    """`mesh` with one face turned round."""
    return TriangleMesh(vertices=mesh.vertices, faces=np.vstack([mesh.faces[:1, ::-1], mesh.faces[1:]]))


def halved(mesh: TriangleMesh) -> TriangleMesh:
    """`mesh` with a face more, between the ends and the middle of one of its edges."""
    edge = mesh.faces[0][:2]
    vertices = np.vstack([mesh.vertices, [mesh.vertices[edge].mean(axis=0)]])
    return TriangleMesh(vertices=vertices, faces=np.vstack([mesh.faces, [*edge, 8]]))


def sheet() -> TriangleMesh:
    tilt = Pose(rotation=rotation_about("x", 0.4), position=np.array([0.1, 0.2, 0.3]))
    return placed(block((2.0, 2.0, 0.0)), tilt)


LARGE = (9, 9, 9)
INNER = joined(block((2, 2, 2), (-1, 0, 0)), block((2, 1, 1), (1, 0, 0)))
"""A body that touches another one."""

REFUSED: dict[str, tuple[TriangleMesh, str]] = {
    "inside out": (turned(block()), ".*inside-out: its normals point inwards, its volume comes out as -8 mm³"),
    "inside-out piece outside any other": (
        joined(block(LARGE), turned(block(centre=(20, 0, 0)))),
        r"piece 2 \(\(19, -1, -1\) mm to \(21, 1, 1\) mm\) is inside-out and does not lie within another piece, so that it is no "
        "cavity$",
    ),
    "cavity through the wall": (joined(block(LARGE), turned(block(centre=(4.5, 0, 0)))), ".*piece 2"),
    "faces that disagree": (flipped(block()), r"the faces disagree on what is outside along 3 edges, at \("),
    "interpenetrating boxes": (
        joined(block(), block(centre=(1.0, 1.5, 0.5))),
        r"pieces 1 and 2 overlap: 0\.75 mm³ within \(0, 0\.5, -0\.5\) mm to \(1, 1, 1\) mm would count twice$",
    ),
    "bars that cross, no corner inside": (joined(block((9, 2, 2)), block((2, 9, 2.5))), ".*overlap: 8 mm³"),
    "body within another": (
        joined(block(LARGE), block()),
        r"piece 2 lies within another piece: 8 mm³ within \(-1, -1, -1\) mm to \(1, 1, 1\) mm would count twice$",
    ),
    "body within another, touching a third": (joined(block(LARGE), INNER), ".*lies within another piece"),
    "the same body twice": (joined(block(), block()), r"12 faces given more than once, at \("),
    "nearly the same body twice": (joined(block(), block((1.99, 1.99, 1.99), (0.0, 0.0, 0.005))), r".*overlap: 7\.88"),
    "face without area": (halved(block()), r"1 face of 13 without area, at \(.* mm$"),
    "flat": (sheet(), "the mesh is flat: all its 12 faces lie in one plane, so that it encloses no volume$"),
    "no faces": (TriangleMesh(vertices=np.empty((0, 3)), faces=np.empty((0, 3), dtype=np.int64)), "the mesh has no faces$"),
    "boxes that share an edge": (
        merged(joined(block(), block(centre=(2.0, 2.0, 0.0)))),
        "the mesh is not watertight: 1 of its 35 edges do not join exactly two faces; 0 open edges; 1 edge where up to 4 faces "
        r"meet in 1 line: 1 edge within \(1, 1, -1\) mm to \(1, 1, 1\) mm$",
    ),
}


@pytest.mark.parametrize(("mesh", "said"), REFUSED.values(), ids=REFUSED)
def test_what_is_no_skin_of_a_body_is_refused_with_the_place_and_the_size(mesh: TriangleMesh, said: str) -> None:
    assert re.match(said, refusal(mesh))


def test_a_sphere_with_a_lobe_pushed_through_its_far_side_is_refused_with_the_place() -> None:
    sphere = of_trimesh(trimesh.creation.icosphere(4))
    x, y, z = sphere.vertices.T
    pushed = np.column_stack([x, y, z - 2.5 * np.exp(-((x**2 + y**2) / 0.05)) * (z > 0)])
    problem = refusal(scaled(TriangleMesh(vertices=pushed, faces=sphere.faces), 1e-3))
    assert problem.startswith("the surface runs through itself: ")
    assert "pairs of faces intersect, within (-0." in problem


def test_the_adjustable_wrench_is_refused_with_the_number_of_edges_and_where(data: Path) -> None:
    """Two lines along which four faces meet make it not watertight; its SolidWorks export repeats their vertices."""
    solid = trimesh.load(data / "workshop_tools" / "adjustable_wrench" / "mesh.ply", process=False)
    problem = refusal(scaled(of_trimesh(solid), 1e-3))
    assert (
        "32 of its 32431 edges do not join exactly two faces; 0 open edges; 32 edges where up to 4 faces meet in 2 lines"
        in problem
    )
    assert "(94.0125, -2.5, -16.3909) mm to (98.7914, -0.43412, -15.2045) mm" in problem
