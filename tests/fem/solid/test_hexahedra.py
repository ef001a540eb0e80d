"""Hexahedra: plan views that meet edge on edge, Clumod's volumes, walls of one cell, plates and tubes that bend right."""

import inspect
import re
from collections import Counter
from collections.abc import Sequence
from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from fem.beam.elements import cowper_tube
from fem.modes import fixed_base
from fem.solid import model
from fem.solid.assembly import SolidMesh, jacobians, require_connected, unfilled, volumes
from fem.solid.hexahedra import Outline, PlanMesh, covered, foot_height, hexahedra
from fem.solid.tetrahedra import Sizing
from geometry.article import Article, Box, Cylinder, Material, Part, Shape, placed, upright
from geometry.articles import built_in
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Pose, rotation_about
from validation.verification.beams import Beam


def circle(diameter: float, x: float = 0.0, y: float = 0.0) -> Outline:
    return Outline(centre=np.array([x, y]), size=np.full(2, diameter), round=True)


def rectangle(a: float, b: float, angle: float = 0.0) -> Outline:
    return Outline(centre=np.zeros(2), size=np.array([a, b]), angle=angle)


def edges(plan: PlanMesh) -> Counter[tuple[int, ...]]:
    """How many quadrilaterals have each edge, its middle node included."""
    corner, middle = plan.quads[:, :4], plan.quads[:, 4:8]
    sides = np.stack([corner, np.roll(corner, -1, axis=1), middle], axis=-1).reshape(-1, 3)
    return Counter((*sorted(side[:2].tolist()), int(side[2])) for side in sides)


def test_quadrilaterals_meet_edge_on_edge() -> None:
    plan = covered([rectangle(0.3, 0.2), rectangle(0.1, 0.4, angle=0.4), circle(0.1)], 0.03, 24)
    used = edges(plan)
    assert set(used.values()) == {1, 2}
    outside = {node for edge, count in used.items() if count == 1 for node in edge}
    inner = np.hypot(*plan.points[sorted(outside)].T) < 0.0999
    assert not inner.any()


STRAIGHT = Material(name="no Poisson effect", density=7850.0, youngs_modulus=207e9, poisson_ratio=0.0)
LAYERS_SIZES = (0.045, 0.03)
AROUND = inspect.signature(hexahedra).parameters["around"].default
MESHES = (("clumod-1", LAYERS_SIZES[0]), ("clumod-1", LAYERS_SIZES[1]), ("clumod-4", LAYERS_SIZES[0]))


def box(size: tuple[float, float, float], bottom: float = 0.0, name: str = "box") -> Part:
    return Part(name=name, material=STRAIGHT, shape=Shape(solids=(upright(Box(size=np.array(size)), bottom=bottom),)))


def tube(outer: float, inner: float, height: float, bottom: float = 0.0) -> Part:
    whole, hole = (upright(Cylinder(diameter=d, height=height), bottom=bottom) for d in (outer, inner))
    return Part(name="tube", material=STRAIGHT, shape=Shape(solids=(whole,), voids=(hole,)))


def drawn(parts: Sequence[Part]) -> np.ndarray:
    return np.array(
        [sum(p.primitive.volume for p in part.shape.solids) - sum(p.primitive.volume for p in part.shape.voids) for part in parts]
    )


@cache
def clumod(name: str, size: float) -> SolidMesh:
    parts = built_in(name).counted_parts
    return hexahedra(parts, sizes=(max(size, 0.04), size), cuts=(foot_height(parts),))


@pytest.mark.parametrize(("name", "size"), MESHES)
def test_every_part_of_clumod_has_its_volume(name: str, size: float) -> None:
    mesh, parts = clumod(name, size), built_in(name).counted_parts
    assert mesh.parts == tuple(part.name for part in parts)
    assert_allclose(np.bincount(mesh.part, weights=volumes(mesh)), drawn(parts), rtol=1e-4)


@pytest.mark.parametrize(("name", "size"), MESHES)
def test_no_cell_of_clumod_is_inverted_and_all_are_joined(name: str, size: float) -> None:
    mesh = clumod(name, size)
    assert jacobians(mesh).min() > 0
    require_connected(mesh)
    assert_array_equal(np.unique(mesh.cells), np.arange(len(mesh.points)))
    apart = np.unique(np.round(mesh.points / 1e-6), axis=0)
    assert len(apart) == len(mesh.points)  # no two nodes in one place: nothing is cut open


def test_the_plans_below_and_above_a_cut_share_the_nodes_of_the_ring() -> None:
    mesh = clumod("clumod-1", LAYERS_SIZES[0])
    height = foot_height(built_in("clumod-1").counted_parts)
    at_cut = np.abs(mesh.points[:, 2] - height) < 1e-9
    nodes = [np.unique(mesh.cells[mesh.part == mesh.parts.index(name)]) for name in ("flange", "mast")]
    on_ring = nodes[1][at_cut[nodes[1]]]
    assert len(on_ring) == AROUND * 2 * 3  # corners and middles around, three circles through the wall
    assert np.isin(on_ring, nodes[0]).all()


def test_the_mast_has_one_cell_through_its_wall() -> None:
    mesh = clumod("clumod-4", LAYERS_SIZES[0])
    own = mesh.points[mesh.cells[mesh.part == mesh.parts.index("mast"), :8]]
    radius = np.hypot(own[..., 0], own[..., 1])
    inner, outer = radius.min(), radius.max()
    assert np.all(np.isclose(radius, inner) | np.isclose(radius, outer))
    assert_array_equal(np.isclose(radius, inner).sum(axis=1), 4)


def test_a_blade_is_one_cell_thick_and_its_silicone_too() -> None:
    mesh = clumod("clumod-4", LAYERS_SIZES[0])
    for name in ("lower-1", "upper-short-silicone"):
        own = mesh.points[mesh.cells[mesh.part == mesh.parts.index(name), :8]][..., 2]
        assert_allclose(np.ptp(own, axis=1), np.ptp(own), rtol=1e-9)


def test_a_tilted_part_is_refused_by_name_and_one_through_a_cut() -> None:
    tilted = placed(Article(name="own", parts=(box((0.1, 0.1, 0.1)),)), Pose(rotation=rotation_about("x", 0.1))).parts[0]
    with pytest.raises(BadInput, match="part box"):
        hexahedra([tilted], sizes=(0.05,))
    assert foot_height([tilted, tube(0.1, 0.09, 0.1)]) is None
    with pytest.raises(BadInput, match="through a height at which the mesh is cut"):
        hexahedra([box((0.1, 0.1, 0.1))], sizes=(0.05, 0.05), cuts=(0.05,))


def test_cells_that_do_not_fill_a_part_are_refused_with_its_name_and_share() -> None:
    mesh = clumod("clumod-1", LAYERS_SIZES[0])
    volume = drawn(built_in("clumod-1").counted_parts)
    assert unfilled(mesh, volume) == ""
    volume[mesh.parts.index("hub-2")] *= 1.02
    volume[mesh.parts.index("mast")] /= 1.01
    assert re.search(r"1\.0\d% of mast are too much, 1\.9\d% of hub-2 are missing", unfilled(mesh, volume))
    assert "flange" not in unfilled(mesh, volume)


def test_hexahedra_too_large_for_the_holes_are_made_smaller() -> None:
    made = model._hexahedra(built_in("clumod-1"), Sizing(size=0.06))
    assert made is not None
    assert jacobians(made).min() > 0


def test_and_refused_when_that_does_not_help(monkeypatch: pytest.MonkeyPatch) -> None:
    tried: list[float] = []

    def inverted(*_: object, sizes: tuple[float, float], **__: object) -> SolidMesh:
        tried.append(sizes[1])
        raise CheckFailed("2 of 9 elements are inverted, the worst in hub-1 at (1.0, 2.0, 3.0) mm")

    monkeypatch.setattr(model, "hexahedra", inverted)
    with pytest.raises(CheckFailed, match=r"after 3 attempts.*elements are inverted, the worst in"):
        model._hexahedra(built_in("clumod-1"), Sizing(size=0.3))
    assert_allclose(tried, [0.3, 0.3 / 1.4, 0.15])


def test_too_many_unknowns_are_refused() -> None:
    with pytest.raises(BadInput, match="5000 are allowed"):
        model._hexahedra(built_in("clumod-1"), Sizing(largest=5000))


def frequencies(part: Part, size: float, count: int) -> np.ndarray:
    mesh = hexahedra([part], sizes=(size,))
    return fixed_base(model.of_mesh(mesh, {part.name: part.material}, cached=False), count).frequency


def timoshenko(length: float, area: float, second: float, shear: float, count: int) -> np.ndarray:
    E, rho = 207e9, 7850.0
    beam = Beam(length=length, bending=E * second, shear=shear * E / 2 * area, mass=rho * area, rotary=rho * second)
    return beam.timoshenko(count, clamped=True)


def test_a_plate_bends_like_a_timoshenko_beam() -> None:
    """Cells four times as long as thick, where one of 8 nodes would lock; without Poisson's effect the clamp is a beam's."""
    width, thickness, length = 0.02, 0.005, 0.4
    found = frequencies(box((width, thickness, length)), 0.02, 2)
    across = timoshenko(length, width * thickness, width * thickness**3 / 12, 5 / 6, 1)
    along = timoshenko(length, width * thickness, thickness * width**3 / 12, 5 / 6, 1)
    assert_allclose(found, [across[0], along[0]], rtol=1e-3)


def test_a_tube_bends_like_a_timoshenko_beam_both_ways() -> None:
    outer, inner, length = 0.05, 0.046, 0.4
    area, second = np.pi / 4 * (outer**2 - inner**2), np.pi / 64 * (outer**4 - inner**4)
    found = frequencies(tube(outer, inner, length), 0.06, 4)
    beam = timoshenko(length, area, second, cowper_tube(0.0, inner / outer), 2)
    assert_allclose(found, np.repeat(beam, 2), rtol=2e-3)
