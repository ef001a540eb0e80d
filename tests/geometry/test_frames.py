"""Arrays, positions, rotations and the rigid transformation of Eq. 3."""

from dataclasses import FrozenInstanceError

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from geometry.frames import (
    Array,
    Pose,
    axes_along,
    frozen,
    proper_rotation,
    rigid_transformation,
    rigid_transformation_6,
    rotation_about,
    skew,
)

ROUNDING = {"rtol": 0.0, "atol": 1e-13}
"""Numbers of order 10 and a handful of operations."""

vectors = st.tuples(*[st.floats(-5, 5)] * 3).map(np.array)
angles = st.floats(-7, 7)
seeds = st.integers(0, 2**32 - 1)


def pose(seed: int) -> Pose:
    rng = np.random.default_rng(seed)
    Q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return Pose(position=rng.uniform(-3, 3, 3), rotation=Q * np.linalg.det(Q))


poses = seeds.map(pose)


def same(a: Pose, b: Pose) -> None:
    assert_allclose(a.position, b.position, **ROUNDING)
    assert_allclose(a.rotation, b.rotation, **ROUNDING)


@given(vectors, vectors)
def test_skew_is_the_cross_product(a: Array, b: Array) -> None:
    assert_allclose(skew(a) @ b, np.cross(a, b), **ROUNDING)


def test_the_rigid_transformation_is_the_matrix_printed_as_eq_3() -> None:
    x, y, z = 2.0, 3.0, 5.0
    printed = [[1, 0, 0, 0, z, -y], [0, 1, 0, -z, 0, x], [0, 0, 1, y, -x, 0]]
    assert_allclose(rigid_transformation([x, y, z]), printed, rtol=0)


@given(seeds)
def test_axes_along_a_line_are_a_rotation_with_the_side_in_the_plane_of_the_first_two(seed: int) -> None:
    line, beside = np.random.default_rng(seed).normal(size=(2, 3))
    for side in (beside, None):
        axes = axes_along(line, side)
        assert_allclose(proper_rotation(axes, "axes"), axes, rtol=0)
        assert_allclose(axes @ line, [np.linalg.norm(line), 0, 0], **ROUNDING)
    assert_allclose((axes_along(line, beside) @ beside)[2], 0, **ROUNDING)
    assert (axes_along(line, beside) @ beside)[1] > 0


@pytest.mark.parametrize(("line", "beside"), [([0, 0, 0], None), ([1, 2, 3], [-2, -4, -6]), ([1, 2, 3], [0, 0, 0])])
def test_what_lies_along_one_line_spans_no_axes(line: list[float], beside: list[float] | None) -> None:
    with pytest.raises(ValueError, match="span no axes"):
        axes_along(line, beside)


@given(vectors, vectors, vectors)
def test_it_gives_the_acceleration_of_a_point_of_a_rigid_body(point: Array, linear: Array, angular: Array) -> None:
    found = rigid_transformation_6(point) @ np.concatenate([linear, angular])
    assert_allclose(found[:3], linear + np.cross(angular, point), **ROUNDING)
    assert_allclose(found[3:], angular, rtol=0)


@given(vectors, vectors)
def test_rigid_transformations_chain_like_the_points_they_lead_through(a: Array, b: Array) -> None:
    assert_allclose(rigid_transformation_6(b) @ rigid_transformation_6(a), rigid_transformation_6(a + b), **ROUNDING)


@pytest.mark.parametrize(("axis", "start", "end"), [("x", 1, 2), ("y", 2, 0), ("z", 0, 1)])
def test_a_quarter_turn_takes_each_axis_to_the_next_one(axis: str, start: int, end: int) -> None:
    assert_allclose(rotation_about(axis, np.pi / 2)[:, start], np.eye(3)[end], **ROUNDING)


@given(st.sampled_from("xyz"), angles, angles)
def test_turns_about_one_axis_add_up_and_are_proper(axis: str, a: float, b: float) -> None:
    product = rotation_about(axis, a) @ rotation_about(axis, b)
    assert_allclose(product, rotation_about(axis, a + b), **ROUNDING)
    proper_rotation(product)


@given(poses, poses, poses, vectors)
def test_poses_form_a_group_that_acts_on_points(a: Pose, b: Pose, c: Pose, point: Array) -> None:
    same((a @ b) @ c, a @ (b @ c))
    same(a @ a.inverse, Pose())
    same(a.inverse @ a, Pose())
    same(a @ Pose(), a)
    assert_allclose((a @ b).apply(point), a.apply(b.apply(point)), **ROUNDING)


@given(poses, seeds)
def test_a_pose_takes_points_of_any_shape_and_keeps_their_distances(where: Pose, seed: int) -> None:
    cloud = np.random.default_rng(seed).normal(size=(2, 4, 3))
    moved = where.apply(cloud)
    assert moved.shape == cloud.shape
    assert_allclose(moved[1, 2], where.rotation @ cloud[1, 2] + where.position, **ROUNDING)
    assert_allclose(np.linalg.norm(moved[0] - moved[1], axis=1), np.linalg.norm(cloud[0] - cloud[1], axis=1), **ROUNDING)


def test_a_rotation_typed_with_ten_digits_passes_and_one_with_four_does_not() -> None:
    R = rotation_about("z", 0.3)
    proper_rotation(np.round(R, 10))
    with pytest.raises(ValueError, match="`rotation` must be orthonormal"):
        proper_rotation(np.round(R, 4))


def test_an_unknown_axis_a_reflection_a_wrong_shape_and_not_a_number_are_refused_in_words() -> None:
    with pytest.raises(ValueError, match="`axis` must be one of x, y, z, found 'w'"):
        rotation_about("w", 1.0)
    with pytest.raises(ValueError, match="found a reflection"):
        proper_rotation(np.diag([1.0, 1.0, -1.0]))
    with pytest.raises(ValueError, match=r"must have shape \(3, 3\), found \(2, 2\)"):
        proper_rotation(np.eye(2))
    with pytest.raises(ValueError, match="`position` must be finite"):
        Pose(position=np.array([np.nan, 0, 0]))


def test_a_pose_cannot_be_changed() -> None:
    position = np.array([1.0, 2.0, 3.0])
    where = Pose(position=position)
    position[0] = 9.0
    assert where.position[0] == 1.0
    for array in (where.position, where.rotation):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 5.0
    with pytest.raises(FrozenInstanceError):
        where.position = position  # type: ignore[misc]


def test_of_a_long_array_that_is_not_finite_the_first_such_entry_is_named() -> None:
    long = np.zeros((100_000, 6))
    long[70_001, 2], long[70_002:] = np.inf, np.nan
    with pytest.raises(ValueError, match=r"`load` must be finite, found inf at \[70001, 2\]$"):
        frozen(long, long.shape, "load")


def test_a_single_number_has_no_place() -> None:
    with pytest.raises(ValueError, match=r"`mass` must be finite, found nan$"):
        frozen(np.nan, (), "mass")
