"""What the tests of large motion share: smooth motion of any size, a block off every axis, its load in closed form."""

from collections.abc import Callable

import numpy as np
import pytest

from fem.base_excitation.patterns import BaseMotion
from fem.exudyn.large_motion import turning
from geometry.frames import Array, rotation_about
from geometry.inertia import Inertia

TURN = rotation_about("x", 0.4) @ rotation_about("y", -0.8) @ rotation_about("z", 1.1)


@pytest.fixture(scope="session")
def block() -> Inertia:
    """A body with all ten parameters, its CoG off every axis."""
    return Inertia.from_cog(3.0, [0.11, -0.23, 0.37], TURN @ np.diag([0.5, 0.7, 0.9]) @ TURN.T)


@pytest.fixture(scope="session")
def sensed() -> Callable[[BaseMotion], Array]:
    """R^T p'' and R^T omega' (n, 6): what accelerometers in the reference point and gyroscopes make of a motion."""

    def six(motion: BaseMotion) -> Array:
        turned = turning(motion)
        return np.hstack([turned.seen_from_table(x) for x in (motion.acceleration[:, :3], turned.spin_rate)])

    return six


@pytest.fixture(scope="session")
def newton_euler() -> Callable[..., Array]:
    """Load (n, 6) of the table on a rigid body about the reference point, in the table's axes, as a textbook has it."""

    def load(motion: BaseMotion, body: Inertia, gravity: float = 0.0) -> Array:
        turned, about = turning(motion), body.about(motion.reference_point)
        lifted = motion.acceleration[:, :3] + gravity * np.eye(3)[2]
        a, spin, rate = (turned.seen_from_table(x) for x in (lifted, turned.spin, turned.spin_rate))
        h, I = about.first_moment, about.tensor
        force = about.mass * a + np.cross(rate, h) + np.cross(spin, np.cross(spin, h))
        return np.hstack([force, np.cross(h, a) + rate @ I + np.cross(spin, spin @ I)])

    return load


@pytest.fixture(scope="session")
def accelerometer() -> Callable[..., Array]:
    """``accelerometer(motion, place, gravity=0)``: (n, 3) [m/s²] what one fixed to the table reads there, in the table's axes.

    R^T (p'' + g z) + omega' x r + omega x (omega x r): the last term is the centripetal one that the linear [G] of Eq. 3 does not
    know, that of g is what gravity makes it read at rest and in a tilt.
    """

    def read(motion: BaseMotion, place: Array, gravity: float = 0.0) -> Array:
        turned = turning(motion)
        spin, rate = (turned.seen_from_table(x) for x in (turned.spin, turned.spin_rate))
        straight = turned.seen_from_table(motion.acceleration[:, :3] + [0.0, 0.0, gravity])
        return straight + np.cross(rate, place) + np.cross(spin, np.cross(spin, place))

    return read
