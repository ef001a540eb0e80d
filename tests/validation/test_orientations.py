"""Tensor and CoG from several orientations: identities, propagation, and what cannot be seen."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from uncertainties import ufloat

from geometry.errors import BadInput
from geometry.inertia import tensor_from_six
from validation.classical.pendulum import PLANAR, SIX, meeting_point, tensor_from_axes, unobservable

DIAGONALS = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, 0, 1], [0, 1, 1.0]])
BODY = tensor_from_six([20.353, 20.528, 2.278, 0.11, -0.23, 0.05])


def moments(axes: np.ndarray, tensor: np.ndarray = BODY) -> np.ndarray:
    units = axes / np.linalg.norm(axes, axis=1)[:, None]
    return np.einsum("ni,ij,nj->n", units, tensor, units)


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 2**32 - 1), st.integers(6, 12))
def test_moments_about_general_axes_give_back_the_tensor(seed: int, count: int) -> None:
    axes = np.vstack([DIAGONALS, np.random.default_rng(seed).normal(size=(count - 6, 3))])
    found = tensor_from_axes(axes, list(moments(axes)))
    # the six diagonals alone have condition number 6, so rounding stays near 1e-14 of the largest entry
    assert_allclose(tensor_from_six([found[name] for name in SIX]), BODY, atol=1e-12)


def test_a_coordinate_pendulum_reads_the_diagonal() -> None:
    found = tensor_from_axes(np.eye(3), [1.0, 2.0, 3.0], ("xx", "yy", "zz"))
    assert_allclose([found["xx"], found["yy"], found["zz"]], [1, 2, 3], rtol=1e-14)


def test_least_squares_tolerance_follows_moments_and_angles_as_finite_differences_say() -> None:
    angles = np.radians([3.0, 47.0, 95.0, 150.0])
    readings = np.array([1.3, 0.9, 0.8, 1.2])  # no tensor fits these exactly: the residual's part of the derivative is tested

    def solved(a: np.ndarray, j: np.ndarray) -> np.ndarray:
        found = tensor_from_axes(np.column_stack([np.cos(a), 0 * a, -np.sin(a)]), list(j), PLANAR)
        return np.array([found[name] for name in PLANAR])

    da, dj, step = 0.004, 0.01, 1e-6
    by_angle = [(solved(angles + step * e, readings) - solved(angles - step * e, readings)) / (2 * step) for e in np.eye(4)]
    by_moment = [solved(angles, readings + e) - solved(angles, readings) for e in np.eye(4)]
    expected = np.sqrt(np.sum((da * np.array(by_angle)) ** 2, axis=0) + np.sum((dj * np.array(by_moment)) ** 2, axis=0))

    from uncertainties import umath

    tagged = [ufloat(a, da) for a in angles]
    axes = [(umath.cos(a), 0.0, -umath.sin(a)) for a in tagged]
    found = tensor_from_axes(axes, [ufloat(j, dj) for j in readings], PLANAR)
    # central differences with a step of 1e-6 are good to about 1e-9
    assert_allclose([found[name].std_dev for name in PLANAR], expected, rtol=1e-7)


def test_axes_in_one_plane_leave_the_entries_across_it_unseen() -> None:
    angles = np.linspace(0, 2.5, 7)
    axes = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
    assert unobservable(axes) == ("zz", "xz", "yz")
    with pytest.raises(BadInput, match="Izz, Ixz, Iyz"):
        tensor_from_axes(axes, list(moments(axes)))


def test_five_axes_are_too_few_for_six_entries() -> None:
    assert unobservable(DIAGONALS[:5]) == ("yz",)


def test_plumb_lines_through_one_point_meet_there() -> None:
    angles = np.array([0.1, 1.2, 2.0])
    normals = np.column_stack([np.cos(angles), np.sin(angles)])
    point = np.array([0.27, -0.54])
    assert_allclose(meeting_point(normals, list(normals @ point)), point, atol=1e-14)


@pytest.mark.parametrize("normals", [[(1.0, 0.0)], [(1.0, 0.0), (1.0, 1e-4)]])
def test_lines_that_do_not_cross_are_refused(normals: list[tuple[float, float]]) -> None:
    with pytest.raises(BadInput, match="plumb lines"):
        meeting_point(normals, [0.1] * len(normals))
