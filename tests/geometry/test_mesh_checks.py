"""Every way in which a mesh is not the skin of a body, each with the evidence that the message must carry."""

import time
from pathlib import Path

import numpy as np
import pytest
import trimesh

from geometry.errors import BadInput
from geometry.frames import Pose, rotation_about
from geometry.mesh import TriangleMesh, inertia, joined, merged, placed, require_closed_volume, scaled, selected
from geometry.toml_file import MILLIMETRE


def of_trimesh(solid: trimesh.Trimesh) -> TriangleMesh:
    return merged(TriangleMesh(vertices=solid.vertices, faces=solid.faces))


def box(size=(2.0, 2.0, 2.0), centre=(0.0, 0.0, 0.0)) -> TriangleMesh:
    """A box with `size` and `centre` in millimetres."""
    solid = of_trimesh(trimesh.creation.box(size))
    return scaled(placed(solid, Pose(position=np.array(centre, dtype=float))), 1e-3)


def turned(mesh: TriangleMesh) -> TriangleMesh:
    """`mesh` with its inside out."""
    return TriangleMesh(vertices=mesh.vertices, faces=mesh.faces[:, ::-1])


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


# --- passed ---------------------------------------------------------------------------------------------------------------


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


@pytest.mark.parametrize("tool", ["allen_key", "box_wrench"])
def test_the_closed_workshop_tools_pass_without_a_warning(data: Path, tool: str) -> None:
    solid = trimesh.load(data / "workshop_tools" / tool / "mesh.ply", process=False)
    assert require_closed_volume(scaled(of_trimesh(solid), 1e-3), tool) == ()


def test_twenty_thousand_faces_are_judged_within_seconds() -> None:
    mesh = of_trimesh(trimesh.creation.icosphere(5))
    assert len(mesh.faces) > 20_000
    start = time.process_time()
    require_closed_volume(mesh, "sphere")
    assert time.process_time() - start < 5.0  # a tenth of this; the processor's, since other tests run beside


def test_pieces_apart_a_cavity_and_a_body_within_a_cavity_are_bodies() -> None:
    shell = joined(box((9, 9, 9)), turned(box((7, 7, 7))))
    assert require_closed_volume(joined(shell, box((2, 2, 2)), box(centre=(20, 0, 0))), "mesh") == ()


def test_bodies_that_only_touch_pass_without_a_warning() -> None:
    assert require_closed_volume(joined(box(), box((1, 1, 1), (1.5, 0.0, 0.0))), "mesh") == ()


def test_curved_bodies_that_fit_into_one_another_pass_with_the_sliver_named() -> None:
    pin = scaled(of_trimesh(trimesh.creation.cylinder(1.0, 4.0, sections=47)), 1e-3)
    turn = Pose(rotation=rotation_about("z", 0.01))  # or the two would share an edge
    bush = scaled(placed(of_trimesh(trimesh.creation.annulus(1.0, 3.0, 4.0, sections=61)), turn), 1e-3)
    warnings = require_closed_volume(joined(pin, bush), "bearing.stl", MILLIMETRE)
    assert len(warnings) == 1
    assert "bearing.stl: pieces 1 and 2 touch and their meshes overlap by 0.0" in warnings[0]


# --- refused --------------------------------------------------------------------------------------------------------------


def test_an_open_mesh_is_refused_with_the_number_of_open_edges_and_where() -> None:
    top = faces_at_top(box())
    assert len(top) == 2
    problem = refusal(without_faces(box(), *top))
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
    boxes = joined(*(without_faces(box(centre=(5 * k, 0, 0)), *faces_at_top(box())) for k in range(5)))
    assert refusal(boxes).endswith("; and 2 more")


def test_an_inside_out_mesh_is_refused_with_its_negative_volume() -> None:
    assert "inside-out: its normals point inwards, its volume comes out as -8 mm³" in refusal(turned(box()))


def test_an_inside_out_piece_outside_any_other_is_refused_as_no_cavity() -> None:
    problem = refusal(joined(box((9, 9, 9)), turned(box(centre=(20, 0, 0)))))
    assert problem == (
        "piece 2 ((19, -1, -1) mm to (21, 1, 1) mm) is inside-out and does not lie within another piece, so that it is no cavity"
    )


def test_a_cavity_that_breaks_through_the_wall_is_refused() -> None:
    assert "piece 2" in refusal(joined(box((9, 9, 9)), turned(box(centre=(4.5, 0, 0)))))


def test_faces_that_disagree_on_the_outside_are_refused_with_the_edges_between_them() -> None:
    faces = box().faces.copy()
    faces[0] = faces[0][::-1]
    problem = refusal(TriangleMesh(vertices=box().vertices, faces=faces))
    assert problem.startswith("the faces disagree on what is outside along 3 edges, at (")


def test_two_interpenetrating_boxes_are_refused_with_the_volume_that_counts_twice() -> None:
    problem = refusal(joined(box(), box(centre=(1.0, 1.5, 0.5))))
    assert problem == "pieces 1 and 2 overlap: 0.75 mm³ within (0, 0.5, -0.5) mm to (1, 1, 1) mm would count twice"


def test_bars_that_cross_without_a_corner_inside_one_another_are_refused() -> None:
    assert "overlap: 8 mm³" in refusal(joined(box((9, 2, 2)), box((2, 9, 2.5))))


def test_a_body_within_another_of_the_same_orientation_is_refused() -> None:
    assert refusal(joined(box((9, 9, 9)), box())) == (
        "piece 2 lies within another piece: 8 mm³ within (-1, -1, -1) mm to (1, 1, 1) mm would count twice"
    )


def test_a_body_within_another_is_found_even_where_it_touches_a_third() -> None:
    inner = joined(box((2, 2, 2), (-1, 0, 0)), box((2, 1, 1), (1, 0, 0)))
    assert "lies within another piece" in refusal(joined(box((9, 9, 9)), inner))


def test_the_same_body_twice_is_refused() -> None:
    assert refusal(joined(box(), box())).startswith("12 faces given more than once, at (")
    assert "overlap: 7.88" in refusal(joined(box(), box((1.99, 1.99, 1.99), (0.0, 0.0, 0.005))))


def test_a_sphere_with_a_lobe_pushed_through_its_far_side_is_refused_with_the_place() -> None:
    sphere = of_trimesh(trimesh.creation.icosphere(4))
    x, y, z = sphere.vertices.T
    pushed = np.column_stack([x, y, z - 2.5 * np.exp(-((x**2 + y**2) / 0.05)) * (z > 0)])
    problem = refusal(scaled(TriangleMesh(vertices=pushed, faces=sphere.faces), 1e-3))
    assert problem.startswith("the surface runs through itself: ")
    assert "pairs of faces intersect, within (-0." in problem


def test_a_tube_along_a_lying_eight_runs_through_itself_and_one_that_passes_over_itself_does_not() -> None:
    def eight(lift: float) -> TriangleMesh:
        t, s = (np.linspace(0, 2 * np.pi, count, endpoint=False) for count in (120, 16))
        centre = np.column_stack([np.sin(t), np.sin(t) * np.cos(t), lift * np.cos(t)])
        tangent = np.roll(centre, -1, axis=0) - np.roll(centre, 1, axis=0)
        across = np.cross(tangent, [0.0, 0.0, 1.0])
        across /= np.linalg.norm(across, axis=1)[:, None]
        up = np.cross(across, tangent)
        up /= np.linalg.norm(up, axis=1)[:, None]
        ring = np.cos(s)[None, :, None] * across[:, None] + np.sin(s)[None, :, None] * up[:, None]
        i, j = np.meshgrid(np.arange(120), np.arange(16), indexing="ij")
        at = lambda i, j: (i % 120) * 16 + j % 16  # noqa: E731
        quads = np.stack([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)], axis=-1).reshape(-1, 4)
        mesh = TriangleMesh(
            vertices=(centre[:, None] + 0.1 * ring).reshape(-1, 3), faces=np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
        )
        return mesh if mesh.volume > 0 else turned(mesh)

    assert "the surface runs through itself" in refusal(eight(lift=0.0))
    assert require_closed_volume(eight(lift=0.3), "tube") == ()


def test_faces_without_area_are_refused_with_their_number_and_place() -> None:
    mesh = box()
    edge = mesh.faces[0][:2]
    middle = mesh.vertices[edge].mean(axis=0)
    vertices = np.vstack([mesh.vertices, [middle]])
    problem = refusal(TriangleMesh(vertices=vertices, faces=np.vstack([mesh.faces, [*edge, 8]])))
    assert problem.startswith("1 face of 13 without area, at (")
    assert problem.endswith(" mm")


def test_a_flat_mesh_is_refused_as_a_surface() -> None:
    flat = placed(box((2.0, 2.0, 0.0)), Pose(rotation=rotation_about("x", 0.4), position=np.array([0.1, 0.2, 0.3])))
    assert refusal(flat) == "the mesh is flat: all its 12 faces lie in one plane, so that it encloses no volume"


def test_a_mesh_without_faces_is_refused() -> None:
    nothing = TriangleMesh(vertices=np.empty((0, 3)), faces=np.empty((0, 3), dtype=np.int64))
    assert refusal(nothing) == "the mesh has no faces"


def test_boxes_that_share_an_edge_are_refused_with_the_edge() -> None:
    problem = refusal(merged(joined(box(), box(centre=(2.0, 2.0, 0.0)))))
    assert problem == (
        "the mesh is not watertight: 1 of its 35 edges do not join exactly two faces; 0 open edges; "
        "1 edge where up to 4 faces meet in 1 line: 1 edge within (1, 1, -1) mm to (1, 1, 1) mm"
    )


def test_the_adjustable_wrench_is_refused_with_the_number_of_edges_and_where(data: Path) -> None:
    """Two lines along which four faces meet make it not watertight; its SolidWorks export repeats their vertices."""
    solid = trimesh.load(data / "workshop_tools" / "adjustable_wrench" / "mesh.ply", process=False)
    problem = refusal(scaled(of_trimesh(solid), 1e-3))
    assert (
        "32 of its 32431 edges do not join exactly two faces; 0 open edges; 32 edges where up to 4 faces meet in 2 lines"
        in problem
    )
    assert "(94.0125, -2.5, -16.3909) mm to (98.7914, -0.43412, -15.2045) mm" in problem


def test_the_hammer_of_two_bodies_passes_with_the_overlap_of_its_meshes_named(data: Path) -> None:
    solid = trimesh.load(data / "workshop_tools" / "machinist_hammer" / "mesh.ply", process=False)
    (warning,) = require_closed_volume(scaled(of_trimesh(solid), 1e-3), "hammer", MILLIMETRE)
    assert (
        warning
        == "hammer: pieces 1 and 2 touch and their meshes overlap by 52.1126 mm³, 0.41% of the smaller one, which counts twice"
    )
