"""A rigid block on exudyn's table: f = +M a at small motion, Newton and Euler in closed form at large motion."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.base_excitation.patterns import BaseMotion
from fem.exudyn.large_motion import Conditions, respond, respond_of_plan, rigid, turning
from geometry.articles import built_in
from geometry.frames import Array
from geometry.inertia import Inertia
from geometry.routes import inertia as drawn_inertia

LARGE = np.array([0.1, -0.05, 0.03, 0.6, -0.5, 1.0])
OMEGA = np.array([3.0, 4.0, 5.0, 4.3, 5.1, 3.7])
POINT = np.array([0.1, 0.2, -0.3])


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("axis", range(6))
def test_load_on_a_rigid_block_is_plus_its_mass_matrix_times_acceleration(
    axis: int, sign: float, block: Inertia, smooth: Callable[..., BaseMotion]
) -> None:
    """All six components. At a microradian the terms of second order are 1e-6; the integrator's own error cancels."""
    motion = smooth(sign * 1e-6 * np.eye(6)[axis], OMEGA, 0.5)
    found = respond_of_plan(rigid(block), motion)
    peak = np.abs(found.load).max()
    assert_allclose(found.load, found.table @ block.mass_matrix, rtol=0, atol=2e-6 * peak)
    # the acceleration that was asked for, within the square of the step: 1024 Hz under 5 rad/s
    assert_allclose(found.table, motion.acceleration, rtol=0, atol=1e-4 * np.abs(motion.acceleration).max())


def test_the_cuboid_as_one_rigid_body_weighs_what_is_drawn(smooth: Callable[..., BaseMotion]) -> None:
    found = respond("cuboid", smooth(1e-6 * LARGE, OMEGA, 0.5), elements=None)
    M = drawn_inertia(built_in("cuboid")).mass_matrix
    assert_allclose(found.load, found.table @ M, rtol=0, atol=2e-6 * np.abs(found.load).max())


@pytest.mark.parametrize("gravity", [0.0, 9.81])
@pytest.mark.parametrize("point", [np.zeros(3), POINT], ids=["origin", "elsewhere"])
def test_at_large_motion_newton_and_euler_hold_in_the_tables_axes(
    gravity: float, point: Array, block: Inertia, smooth: Callable[..., BaseMotion], newton_euler: Callable[..., Array]
) -> None:
    """Through a radian at 4 rad/s. The error of the step is of second order, so two steps say where it goes."""
    loads = []
    for rate in (1024, 2048):
        motion = smooth(LARGE, OMEGA, rate=rate, point=point)
        assert np.abs(motion.displacement).max() > 0.98
        loads.append(respond_of_plan(rigid(block), motion, Conditions(gravity=gravity)).load[:: rate // 1024])
    exact = newton_euler(smooth(LARGE, OMEGA, rate=1024, point=point), block, gravity)
    changes, peak = exact - exact[0], np.abs(exact - exact[0]).max(axis=0)
    errors = [np.abs(load - changes).max(axis=0) / peak for load in (*loads, (4 * loads[1] - loads[0]) / 3)]
    assert_allclose(errors[0] / errors[1], 4.0, rtol=0.1)
    assert np.all(errors[2] < 2e-6)


def test_without_its_gyroscopic_and_centripetal_terms_the_load_would_be_far_off(
    block: Inertia, smooth: Callable[..., BaseMotion]
) -> None:
    """The same run against M a: the test above would not pass for want of turning."""
    found = respond_of_plan(rigid(block), smooth(LARGE, OMEGA))
    missing = np.abs(found.load - found.table @ block.mass_matrix).max(axis=0)
    assert np.all(missing > 0.07 * np.abs(found.load).max(axis=0))


def test_loads_in_the_laboratorys_axes_are_those_of_the_table_turned(block: Inertia, smooth: Callable[..., BaseMotion]) -> None:
    motion = smooth(LARGE, OMEGA, 0.5)
    table, laboratory = (respond_of_plan(rigid(block), motion, Conditions(axes=axes)) for axes in ("table", "laboratory"))
    R = turning(motion).rotation
    for part in (slice(0, 3), slice(3, 6)):
        assert_allclose(np.einsum("nij,nj->ni", R, table.load[:, part]), laboratory.load[:, part], rtol=0, atol=1e-9)
        assert_allclose(np.einsum("nij,nj->ni", R, table.table[:, part]), laboratory.table[:, part], rtol=0, atol=1e-9)
    # the force is the mass times the acceleration of the CoG in the laboratory, nothing else
    cog = R @ block.cog + motion.displacement[:, :3]
    second = np.diff(cog, 2, axis=0) * motion.sampling_rate**2
    force = laboratory.load[1:-1, :3] / block.mass
    assert_allclose(force, second, rtol=0, atol=2e-4 * np.abs(second).max())


def test_exudyns_accelerations_of_the_table_are_those_of_the_formula(
    block: Inertia, smooth: Callable[..., BaseMotion], sensed: Callable[[BaseMotion], Array]
) -> None:
    motion = smooth(LARGE, OMEGA)
    found = respond_of_plan(rigid(block), motion).table
    assert_allclose(found, sensed(motion), rtol=0, atol=1e-4 * np.abs(found).max())
