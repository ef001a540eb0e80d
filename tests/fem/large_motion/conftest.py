"""What the tests of large motion share: smooth motion of any size, a block off every axis, its load in closed form."""

from collections.abc import Callable

import numpy as np
import pytest

from fem.base_excitation.patterns import BaseMotion
from fem.exudyn.large_motion import seen_by, turning
from geometry.frames import Array, rotation_about
from geometry.inertia import Inertia

TURN = rotation_about("x", 0.4) @ rotation_about("y", -0.8) @ rotation_about("z", 1.1)


def spin(motion: BaseMotion) -> tuple[Array, Array]:
    """Spin and its rate (n, 3) [rad/s, rad/s²] in the table's axes: the three rates about the axes e_1 = x, e_2 = R_x y and
    e_3 = R_x R_y z, each of which turns with the rates before it,

    omega' = alpha'' e_1 + beta'' e_2 + gamma'' e_3 + alpha' e_1 x beta' e_2 + (alpha' e_1 + beta' e_2) x gamma' e_3.
    """
    (ca, _, _), (sa, _, _) = np.cos(motion.displacement[:, 3:].T), np.sin(motion.displacement[:, 3:].T)
    R = turning(motion)
    about = (np.broadcast_to([1.0, 0.0, 0.0], (len(R), 3)), np.column_stack([0 * ca, ca, sa]), R[:, :, 2])
    a, b, c = (rate[:, None] * e for rate, e in zip(motion.velocity[:, 3:].T, about, strict=True))
    rate = sum(x[:, None] * e for x, e in zip(motion.acceleration[:, 3:].T, about, strict=True))
    return seen_by(R, a + b + c), seen_by(R, rate + np.cross(a, b) + np.cross(a + b, c))


@pytest.fixture(scope="session")
def block() -> Inertia:
    """A body with all ten parameters, its CoG off every axis."""
    return Inertia.from_cog(3.0, [0.11, -0.23, 0.37], TURN @ np.diag([0.5, 0.7, 0.9]) @ TURN.T)


@pytest.fixture(scope="session")
def sensed() -> Callable[[BaseMotion], Array]:
    """R^T p'' and R^T omega' (n, 6): what accelerometers in the reference point and gyroscopes make of a motion."""

    def six(motion: BaseMotion) -> Array:
        return np.hstack([seen_by(turning(motion), motion.acceleration[:, :3]), spin(motion)[1]])

    return six


@pytest.fixture(scope="session")
def newton_euler() -> Callable[..., Array]:
    """Load (n, 6) of the table on a rigid body about the reference point, in the table's axes, as a textbook has it."""

    def load(motion: BaseMotion, body: Inertia, gravity: float = 0.0) -> Array:
        about, (w, rate) = body.about(motion.reference_point), spin(motion)
        a = seen_by(turning(motion), motion.acceleration[:, :3] + gravity * np.eye(3)[2])
        h, I = about.first_moment, about.tensor
        force = about.mass * a + np.cross(rate, h) + np.cross(w, np.cross(w, h))
        return np.hstack([force, np.cross(h, a) + rate @ I + np.cross(w, w @ I)])

    return load


@pytest.fixture(scope="session")
def accelerometer() -> Callable[..., Array]:
    """``accelerometer(motion, place, gravity=0)``: (n, 3) [m/s²] what one fixed to the table reads there, in the table's axes.

    R^T (p'' + g z) + omega' x r + omega x (omega x r): the last term is the centripetal one that the linear [G] of Eq. 3 does not
    know, that of g is what gravity makes it read at rest and in a tilt.
    """

    def read(motion: BaseMotion, place: Array, gravity: float = 0.0) -> Array:
        w, rate = spin(motion)
        straight = seen_by(turning(motion), motion.acceleration[:, :3] + [0.0, 0.0, gravity])
        return straight + np.cross(rate, place) + np.cross(w, np.cross(w, place))

    return read
