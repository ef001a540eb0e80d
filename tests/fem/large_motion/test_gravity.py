"""Gravity on a tilting table: its two halves, their signs, and when they cancel."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.base_excitation.patterns import BaseMotion
from fem.beam.elements import rectangle
from fem.beam.frame import Member, Plan
from fem.exudyn import large_motion
from fem.exudyn.large_motion import Conditions, respond, respond_of_plan, rigid, turning
from fem.exudyn.run import running
from geometry.article import material
from geometry.frames import Array, rigid_transformation
from geometry.inertia import Inertia

G = 9.81
FREQUENCY = 4.0
OMEGA = 2 * np.pi * FREQUENCY
LARGE = np.array([0.1, -0.05, 0.03, 0.6, -0.5, 1.0])
RATES = np.array([3.0, 4.0, 5.0, 4.3, 5.1, 3.7])


def added(axis: int, axes: str, block: Inertia, smooth: Callable[..., BaseMotion]) -> Array:
    """(6,) what gravity adds to a column of H at 4 Hz, per kinematic acceleration, in exudyn: the load with it less that without.

    At a microradian nothing of second order is left; theta'' = -omega² theta in a sine, so theta stands for -theta'' / omega².
    """
    motion = smooth(1e-6 * np.eye(6)[axis], OMEGA * np.ones(6))
    loads = [respond_of_plan(rigid(block), motion, Conditions(gravity=g, axes=axes)).load for g in (G, 0.0)]
    angle = motion.displacement[:, axis]
    per_angle = (loads[0] - loads[1]).T @ angle / (angle @ angle)
    return np.asarray(-per_angle / OMEGA**2)


def test_signs_of_the_tilt_in_the_tables_axes(block: Inertia, smooth: Callable[..., BaseMotion]) -> None:
    """f_x/beta'' += m g/omega², f_y/alpha'' -= m g/omega², t_alpha/alpha'' and t_beta/beta'' += m g z/omega²; about gamma, which
    tilts nothing, no column but a row: t_gamma/alpha'' -= m g x/omega², t_gamma/beta'' -= m g y/omega².
    """
    weight = block.mass * G / OMEGA**2
    x, y, z = block.cog
    expected = weight * np.array([[0, -1, 0, z, 0, -x], [1, 0, 0, 0, z, -y], [0, 0, 0, 0, 0, 0]])
    for axis, column in zip((3, 4, 5), expected, strict=True):
        assert_allclose(added(axis, "table", block, smooth), column, rtol=0, atol=1e-5 * weight)


def test_in_the_laboratorys_axes_the_weight_is_constant_and_only_moments_are_added(
    block: Inertia, smooth: Callable[..., BaseMotion]
) -> None:
    """There the force has no tilt, and a gamma column does stand: the CoG goes round under a weight that does not.

    t = r x m g z with r turned by the angle: for gamma, t_alpha = m g (y + x gamma), t_beta = -m g (x - y gamma).
    """
    weight = block.mass * G / OMEGA**2
    x, y, z = block.cog
    expected = weight * np.array([[0, 0, 0, z, 0, 0], [0, 0, 0, 0, z, 0], [0, 0, 0, -x, -y, 0]])
    for axis, column in zip((3, 4, 5), expected, strict=True):
        assert_allclose(added(axis, "laboratory", block, smooth), column, rtol=0, atol=1e-5 * weight)


def test_the_height_of_the_cog_would_be_off_by_g_over_omega_squared(block: Inertia, smooth: Callable[..., BaseMotion]) -> None:
    """m z is read from f_x/beta'': 15.5 mm at 4 Hz, whatever the body."""
    assert added(4, "table", block, smooth)[0] / block.mass == pytest.approx(G / OMEGA**2, rel=1e-5)
    assert pytest.approx(15.5e-3, abs=5e-5) == G / OMEGA**2


def test_with_accelerometers_that_sense_the_tilt_gravity_cancels_exactly_at_any_angle(
    block: Inertia, smooth: Callable[..., BaseMotion], accelerometer: Callable[..., Array]
) -> None:
    """Through a radian: what gravity adds to the load is M times what it adds to their reading, so H does not know of it."""
    motion = smooth(LARGE, RATES, 0.5)
    loads = [respond_of_plan(rigid(block), motion, Conditions(gravity=g)).load for g in (G, 0.0)]
    readings = [accelerometer(motion, np.zeros(3), g) for g in (G, 0.0)]
    sensed = (readings[0] - readings[1]) - [0.0, 0.0, G]  # charge amplifiers and cells forget what is constant
    expected = block.mass_matrix[:, :3] @ sensed.T
    assert_allclose(loads[0] - loads[1], expected.T, rtol=0, atol=1e-8 * block.mass * G)
    assert np.abs(sensed).max() > 0.5 * G


def test_weight_at_rest_is_told_and_taken_off(block: Inertia, smooth: Callable[..., BaseMotion]) -> None:
    found = respond_of_plan(rigid(block), smooth(LARGE, RATES, 0.1), Conditions(gravity=G))
    at_rest = block.mass * G * (rigid_transformation(block.cog).T @ [0.0, 0.0, 1.0])
    assert_allclose(found.settings["load_at_rest"], at_rest, rtol=0, atol=1e-9 * block.mass * G)
    assert_allclose(found.load[0], np.zeros(6), rtol=0, atol=1e-12)


def test_an_elastic_article_weighs_as_much_and_stands_still_under_gravity(smooth: Callable[..., BaseMotion]) -> None:
    """Bent by its weight from the first instant on: no jolt, and the load at rest is that of the rigid body."""
    motion = smooth(1e-9 * LARGE, RATES, 0.2, 256.0)
    elastic, stiff = (respond("clumod-4", motion, elements=elements, gravity=G) for elements in (1, None))
    weight = float(np.asarray(stiff.settings["load_at_rest"])[2])
    # the sag of the blades moves the CoG by some tenths of a millimetre
    assert_allclose(elastic.settings["load_at_rest"], stiff.settings["load_at_rest"], rtol=0, atol=1e-3 * weight)
    assert np.abs(elastic.load).max() < 1e-6 * weight


@pytest.mark.parametrize("gravity", [3.0, -3.0])
def test_a_column_pressed_by_its_weight_swings_more_slowly_and_a_hanging_one_faster(gravity: float) -> None:
    """Euler's column under its own weight buckles at q L³ / (E I) = 7.8373, and its squared frequency falls to zero there nearly
    on a straight line (Southwell): measured from the linearised system in exudyn, settled.
    """
    length, bar = 1.0, rectangle(0.02, 0.004, material("steel"))
    nodes = np.linspace([0.0, 0.0, 0.0], [0.0, 0.0, length], 13)
    member = Member(nodes=tuple(range(13)), section=bar, z_axis=np.array([1.0, 0.0, 0.0]))
    plan = Plan(nodes=nodes, carriers=tuple(range(13)), members=(member,))
    squares = [lowest_square(plan, g) for g in (gravity, 1e-9)]
    softest = min(bar.bending_y, bar.bending_z)
    buckling = 7.8373 * softest / (bar.mass * length**3)
    assert squares[0] / squares[1] - 1 == pytest.approx(-gravity / buckling, rel=0.05)


def lowest_square(plan: Plan, gravity: float) -> float:
    """Square of the lowest frequency [(rad/s)²] of `plan` on a table that stands still, at rest under `gravity`."""
    nothing = np.zeros((2, 6))
    still = BaseMotion(sampling_rate=64.0, displacement=nothing, velocity=nothing, acceleration=nothing, driven=0.0)
    with running("settle the column") as exudyn:
        scene, _table = large_motion._assembled(exudyn, plan, still, Conditions(gravity=gravity, loss_frequency=None))
        large_motion.settle(scene)
        return float(scene.system.ComputeODE2Eigenvalues(numberOfEigenvalues=2, useAbsoluteValues=False)[0][0])


def test_rotation_of_the_block_is_what_the_angles_say(block: Inertia, smooth: Callable[..., BaseMotion]) -> None:
    """Weight in the table's axes after a slow turn is R^T m g: the sense of all three angles at once, without any dynamics."""
    motion = smooth(LARGE, 0.05 * RATES, 4.0, 64.0)
    found = respond_of_plan(rigid(block), motion, Conditions(gravity=G))
    still = respond_of_plan(rigid(block), motion)
    weight = turning(motion).seen_from_table(np.tile([0.0, 0.0, block.mass * G], (len(found.load), 1)))
    assert_allclose(found.load[:, :3] - still.load[:, :3], weight - weight[0], rtol=0, atol=1e-8 * block.mass * G)
