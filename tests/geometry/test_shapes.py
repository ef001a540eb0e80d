"""Shapes as data: volumes, places, and the words for what cannot be drawn."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from geometry.article import Box, Cylinder, Placed, Shape, bolt_circle, drilled, rectangle, upright

lengths = st.floats(1e-4, 10)


@given(lengths, lengths, lengths, st.floats(0.1, 10))
def test_volume_grows_with_the_cube_of_the_lengths(a: float, b: float, c: float, s: float) -> None:
    box, cylinder = Box(size=np.array([a, b, c])), Cylinder(diameter=a, height=b)
    assert_allclose(Box(size=s * box.size).volume, s**3 * box.volume, rtol=1e-12)
    assert_allclose(Cylinder(diameter=s * a, height=s * b).volume, s**3 * cylinder.volume, rtol=1e-12)


def test_a_cylinder_fills_pi_quarters_of_its_box() -> None:
    assert_allclose(Cylinder(diameter=2.0, height=3.0).volume, np.pi / 4 * Box(size=np.array([2.0, 2.0, 3.0])).volume, rtol=1e-15)


@given(lengths, st.floats(-5, 5), st.floats(-5, 5), st.floats(-5, 5))
def test_what_stands_upright_reaches_from_its_bottom_to_its_height(height: float, bottom: float, x: float, y: float) -> None:
    for primitive in (Cylinder(diameter=0.1, height=height), Box(size=np.array([0.2, 0.3, height]))):
        placed = upright(primitive, bottom=bottom, x=x, y=y)
        assert_allclose(placed.pose.apply([0, 0, -height / 2]), [x, y, bottom], rtol=0, atol=1e-14)
        assert_allclose(placed.pose.apply([0, 0, height / 2]), [x, y, bottom + height], rtol=0, atol=1e-14)


def test_holes_are_drilled_at_every_position_from_the_bottom_up() -> None:
    holes = drilled([[0.1, 0.2], [0.3, -0.4]], diameter=0.01, bottom=0.5, depth=0.2)
    assert_allclose([hole.pose.position for hole in holes], [[0.1, 0.2, 0.6], [0.3, -0.4, 0.6]], rtol=1e-15)
    assert all(hole.primitive.volume == Cylinder(diameter=0.01, height=0.2).volume for hole in holes)


@given(st.integers(2, 12), lengths, st.floats(-4, 4))
def test_a_bolt_circle_has_its_radius_equal_chords_and_its_first_angle(count: int, diameter: float, angle: float) -> None:
    circle = bolt_circle(count, diameter, angle)
    chords = np.linalg.norm(circle - np.roll(circle, 1, axis=0), axis=1)
    assert_allclose(np.linalg.norm(circle, axis=1), diameter / 2, rtol=1e-12)
    assert_allclose(chords, diameter * np.sin(np.pi / count), rtol=1e-12)
    assert_allclose(circle[0], diameter / 2 * np.array([np.cos(angle), np.sin(angle)]), rtol=1e-12)
    assert_allclose(circle.sum(axis=0), 0, atol=1e-13 * count * diameter)


def test_a_rectangle_runs_counter_clockwise_from_plus_plus() -> None:
    assert_allclose(rectangle(4.0, 2.0), [[2, 1], [-2, 1], [-2, -1], [2, -1]], rtol=0)


@pytest.mark.parametrize("wrong", [0.0, -1.0, np.nan, np.inf])
def test_a_length_that_cannot_be_is_named_with_what_was_found(wrong: float) -> None:
    with pytest.raises(ValueError, match="`diameter` must be positive and finite"):
        Cylinder(diameter=wrong, height=1.0)
    with pytest.raises(ValueError, match="`height` must be positive and finite"):
        Cylinder(diameter=1.0, height=wrong)
    with pytest.raises(ValueError, match="`size` must be"):
        Box(size=np.array([1.0, wrong, 1.0]))


def test_a_box_has_three_edges_and_they_cannot_be_changed() -> None:
    with pytest.raises(ValueError, match=r"`size` must have shape \(3,\), found \(2,\)"):
        Box(size=np.ones(2))
    with pytest.raises(ValueError, match="read-only"):
        Box(size=np.ones(3)).size[0] = 2.0


def test_voids_that_take_away_more_than_there_is_are_refused() -> None:
    """Spatial algebra would pass through zero mass, where Pinocchio returns figures of any size without a word."""
    block, hole = Placed(primitive=Box(size=[0.1, 0.1, 0.1])), Placed(primitive=Box(size=[0.1, 0.1, 0.2]))
    with pytest.raises(ValueError, match="take away less than there is"):
        Shape(solids=(block,), voids=(hole,))
