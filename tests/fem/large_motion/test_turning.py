"""How a table turns, against differences of its rotation."""

from collections.abc import Callable

import numpy as np
from numpy.testing import assert_allclose

from fem.base_excitation.patterns import BaseMotion
from fem.exudyn.large_motion import turning
from geometry.frames import Array, rotation_about

LARGE = np.array([0.1, -0.05, 0.03, 1.1, -0.9, 1.4])
OMEGA = np.array([3.0, 4.0, 5.0, 4.3, 5.1, 3.7])
PLACE = np.array([0.4, -0.3, 0.2])
RATE = 4096.0


def test_rotation_is_that_about_x_then_about_the_turned_y_then_about_the_turned_z() -> None:
    angles, none = np.array([[0.3, -0.7, 1.1], [-1.2, 0.4, 2.0]]), np.zeros((2, 6))
    turned = np.hstack([np.zeros((2, 3)), angles])
    motion = BaseMotion(sampling_rate=1.0, displacement=turned, velocity=none, acceleration=none, driven=1.0)
    product = [rotation_about("x", a) @ rotation_about("y", b) @ rotation_about("z", c) for a, b, c in angles]
    assert_allclose(turning(motion).rotation, product, rtol=0, atol=1e-15)


def test_spin_is_the_rate_of_the_rotation(smooth: Callable[..., BaseMotion]) -> None:
    """omega x R = R', by central differences, whose error is (omega h)² / 6."""
    turned = turning(smooth(LARGE, OMEGA, rate=RATE))
    R, spin = turned.rotation, turned.spin[1:-1]
    derivative = (R[2:] - R[:-2]) * RATE / 2
    assert_allclose(np.cross(spin[:, :, None], R[1:-1], axis=1), derivative, rtol=0, atol=1e-4)


def test_spin_rate_is_the_derivative_of_the_spin_in_both_frames(smooth: Callable[..., BaseMotion]) -> None:
    turned = turning(smooth(LARGE, OMEGA, rate=RATE))
    for spin, rate in (
        (turned.spin, turned.spin_rate),
        (turned.seen_from_table(turned.spin), turned.seen_from_table(turned.spin_rate)),
    ):
        derivative = (spin[2:] - spin[:-2]) * RATE / 2
        assert_allclose(rate[1:-1], derivative, rtol=0, atol=1e-4 * np.abs(rate).max())


def test_an_accelerometer_on_the_table_reads_the_second_derivative_of_its_place_and_gravity(
    smooth: Callable[..., BaseMotion], accelerometer: Callable[..., Array]
) -> None:
    motion = smooth(LARGE, OMEGA, rate=RATE)
    R = turning(motion).rotation
    path = motion.displacement[:, :3] + R @ PLACE
    second = np.diff(path, 2, axis=0) * RATE**2 + [0.0, 0.0, 9.81]
    read = accelerometer(motion, PLACE, 9.81)[1:-1]
    assert_allclose(read, np.einsum("nji,nj->ni", R[1:-1], second), rtol=0, atol=1e-4 * np.abs(read).max())


def test_small_motion_needs_no_turning(smooth: Callable[..., BaseMotion], sensed: Callable[[BaseMotion], Array]) -> None:
    motion = smooth(1e-6 * LARGE, OMEGA)
    assert_allclose(sensed(motion), motion.acceleration, rtol=0, atol=1e-10)


def test_the_linear_transformation_lacks_the_centripetal_acceleration(
    smooth: Callable[..., BaseMotion], sensed: Callable[[BaseMotion], Array], accelerometer: Callable[..., Array]
) -> None:
    """About one axis: omega² r towards it."""
    motion = smooth(0.5 * np.eye(6)[5], OMEGA)
    a = sensed(motion)
    linear = a[:, :3] + np.cross(a[:, 3:], PLACE)
    towards = -(motion.velocity[:, 5:] ** 2) * (PLACE * [1.0, 1.0, 0.0])
    assert_allclose(accelerometer(motion, PLACE) - linear, towards, rtol=0, atol=1e-12)
