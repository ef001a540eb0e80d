"""Plan views: areas, quadrilaterals that meet edge on edge, rings that two plans divide alike."""

from collections import Counter

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.solid.hexahedra import Outline, PlanMesh, covered, with_whole_walls

SIZES = (0.05, 0.02)


def circle(diameter: float, x: float = 0.0, y: float = 0.0) -> Outline:
    return Outline(centre=np.array([x, y]), size=np.full(2, diameter), round=True)


def rectangle(a: float, b: float, angle: float = 0.0) -> Outline:
    return Outline(centre=np.zeros(2), size=np.array([a, b]), angle=angle)


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def areas(plan: PlanMesh) -> np.ndarray:
    """Area (q,) [m²] within the parabolas through each quadrilateral's edges: its polygon and 2/3 of chord times bulge."""
    a = plan.points[plan.quads[:, :4]]
    m = plan.points[plan.quads[:, 4:8]]
    b = np.roll(a, -1, axis=1)
    return np.asarray((cross(a, b) / 2 + 2 / 3 * cross(m - (a + b) / 2, b - a)).sum(axis=1))


def edges(plan: PlanMesh) -> Counter[tuple[int, ...]]:
    """How many quadrilaterals have each edge, its middle node included."""
    corner, middle = plan.quads[:, :4], plan.quads[:, 4:8]
    sides = np.stack([corner, np.roll(corner, -1, axis=1), middle], axis=-1).reshape(-1, 3)
    return Counter((*sorted(side[:2].tolist()), int(side[2])) for side in sides)


@pytest.mark.parametrize("size", SIZES)
def test_a_plate_with_holes_has_its_area_in_and_around_them(size: float) -> None:
    """Parabolas miss 7.8e-4 of a circle at eight edges and 1e-5 at 24."""
    large, small = circle(0.1), circle(0.01, x=0.1)
    plan = covered([rectangle(0.3, 0.2, angle=0.3), large, small], size, 24)
    found = areas(plan)
    assert np.all(found > 0)
    assert_allclose(found.sum(), 0.3 * 0.2, rtol=1e-10)
    for hole, share in ((large, 1e-4), (small, 8e-4)):
        within = np.hypot(*(plan.centres - hole.centre).T) < hole.size[0] / 2
        assert_allclose(found[within].sum(), np.pi / 4 * hole.size[0] ** 2, rtol=share)


def test_quadrilaterals_meet_edge_on_edge() -> None:
    plan = covered([rectangle(0.3, 0.2), rectangle(0.1, 0.4, angle=0.4), circle(0.1)], 0.03, 24)
    used = edges(plan)
    assert set(used.values()) == {1, 2}
    outside = {node for edge, count in used.items() if count == 1 for node in edge}
    inner = np.hypot(*plan.points[sorted(outside)].T) < 0.0999
    assert not inner.any()


def test_a_wall_of_two_becomes_one_and_keeps_its_area() -> None:
    outlines = [circle(0.1), circle(0.09), rectangle(0.3, 0.2)]
    plan = covered(outlines, 0.03, 24)
    whole = with_whole_walls(plan, 0.045, 0.05)
    assert_allclose(areas(whole).sum(), areas(plan).sum(), rtol=1e-9)
    middle = np.hypot(*whole.centres.T)
    ring = (middle > 0.045) & (middle < 0.05)
    assert ring.sum() == 24
    corners = np.hypot(*np.moveaxis(whole.points[whole.quads[ring, :4]], -1, 0))
    assert np.all(np.isclose(corners, 0.045) | np.isclose(corners, 0.05))
    assert set(edges(whole).values()) == {1, 2}


def test_two_plans_divide_a_ring_alike() -> None:
    ring = [circle(0.1), circle(0.09)]
    plans = [covered([*ring, rectangle(0.3, 0.2)], 0.03, 24), covered([*ring, circle(0.2), circle(0.01, x=0.08)], 0.05, 24)]
    nodes = []
    for plan in plans:
        radius = np.hypot(*plan.points.T)
        within = plan.points[(radius > 0.045 - 1e-9) & (radius < 0.05 + 1e-9)]
        nodes.append(within[np.lexsort(np.round(within, 9).T)])
    assert_allclose(nodes[0], nodes[1], rtol=0, atol=1e-9)


@pytest.mark.parametrize("around", [16, 24, 32])
def test_a_tube_has_as_many_edges_around_as_asked_for(around: int) -> None:
    plan = covered([circle(0.1), circle(0.09)], 0.03, around)
    used = edges(plan)
    outside = [edge for edge, count in used.items() if count == 1]
    assert len(outside) == around
