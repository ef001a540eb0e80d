"""Native beams on the moving table at small motion: the linear dynamic mass, losses, and what cannot turn."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem import beam
from fem.base_excitation.base_motion import BaseMotion
from fem.flexible_body import driven, native
from fem.flexible_body.large_motion import Conditions, respond, respond_of_plan
from fem.flexible_body.large_motion.article import able_to_turn
from fem.flexible_body.linearised import linearise, stiffness_of
from fem.flexible_body.losses import lossy, viscous
from fem.flexible_body.running import running
from fem.frame import Plan, assemble
from geometry.arrays import Array
from geometry.errors import BadInput

RATE = 512.0
LOSSES_AT = 0.5
"""[Hz] where viscous and structural losses agree: damping of 7 % at the first mode, which rings down within the record."""
PULSE = 0.04


@pytest.fixture(scope="module")
def kicked() -> tuple[BaseMotion, Array]:
    """A short kick along x with a turn about y, and lines [Hz] at which it has something."""
    t = np.arange(round(2.5 * RATE) + 1) / RATE
    s = (t - 8 * PULSE) / PULSE
    bell = np.exp(-(s**2) / 2)
    shapes = (bell, -s / PULSE * bell, (s**2 - 1) / PULSE**2 * bell)
    directions = 1e-6 * np.array([[1.0, 0.0, 0.0, 0.0, 0.7, 0.3]])
    parts = [shape[:, None] * directions for shape in shapes]
    parts[0][0] = parts[1][0] = 0.0  # 1e-14 of the kick
    motion = BaseMotion(
        sampling_rate=RATE, displacement=parts[0], velocity=parts[1], acceleration=parts[2], driven=16 * PULSE
    )
    return motion, np.array([2.0, 4.0, 6.0, 8.0])


def test_at_small_motion_the_response_is_that_of_the_linear_dynamic_mass(kicked: tuple[BaseMotion, Array]) -> None:
    """Clumod on one mesh, time against frequency: transforms of whole records. Below the first mode, at 11.5 Hz; the step's own
    error there is 3e-5, from (omega h)² / 12 of the stiffness of that mode.
    """
    motion, lines = kicked
    found = respond("clumod-1", motion, elements=1, loss_frequency=LOSSES_AT)
    turn = np.exp(-2j * np.pi * lines[:, None] * motion.time)
    load, acceleration = turn @ found.load, turn @ found.table
    plan = beam.plan("clumod-1", elements=1)
    system, losses = linearise(plan, 10), stiffness_of(lossy(plan))
    for k, line in enumerate(lines):
        H = driven.direct(system, losses * line / LOSSES_AT, line).matrix[0]
        expected = H @ acceleration[k]
        assert_allclose(load[k], expected, rtol=0, atol=3e-4 * np.abs(expected).max())
        M = driven.direct(system, losses * 0, 0.01).matrix[0]
        assert np.abs(M @ acceleration[k] - expected).max() > 0.01 * np.abs(expected).max()  # it is elastic there


@pytest.mark.parametrize("name", ["clumod-1", "clumod-4"])
def test_dampers_beside_the_beams_are_the_lossy_stiffness_over_omega(name: str) -> None:
    """Beams, layers of a sandwich and all: the identity C = sum of eta K / omega, in exudyn's own matrices."""
    plan = beam.plan(name, elements=2)
    with running("linearise the damped frame") as exudyn:
        made = native.build(exudyn, plan, held=False, damping=viscous(plan, 12.0))
        damping = np.array(made.system.ComputeLinearizedSystem()[2])
    expected = stiffness_of(lossy(plan)) / (2 * np.pi * 12.0)
    size = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    assert_allclose(damping, expected, rtol=0, atol=1e-12 * size.max())
    kept = size > 1e-9 * size.max()
    assert np.abs((damping - expected)[kept] / size[kept]).max() < 1e-9


def test_a_turning_beam_feels_nothing_of_its_dampers(smooth: Callable[..., BaseMotion]) -> None:
    """The stiff Cuboid through a radian, damped a hundred times as much as it is: the load does not change."""
    motion = smooth(np.array([0.1, -0.05, 0.03, 0.6, -0.5, 1.0]), np.array([3.0, 4.0, 5.0, 4.3, 5.1, 3.7]), 0.5, 512.0)
    damped, free = (respond("cuboid", motion, elements=1, loss_frequency=f).load for f in (0.12, None))
    assert_allclose(damped, free, rtol=0, atol=1e-5 * np.abs(free).max())


@pytest.mark.parametrize("name", ["cuboid", "fmd+disc+cuboid"])
def test_a_stiff_article_of_beams_is_nearly_the_rigid_body_even_when_it_turns_far(
    name: str, smooth: Callable[..., BaseMotion]
) -> None:
    """Its holes included. First mode of the Cuboid above 1 kHz, so that 5 rad/s bend it by 1e-5."""
    motion = smooth(np.array([0.1, -0.05, 0.03, 0.6, -0.5, 1.0]), np.array([3.0, 4.0, 5.0, 4.3, 5.1, 3.7]), 0.5, 512.0)
    elastic, stiff = (respond(name, motion, elements=elements, gravity=9.81).load for elements in (1, None))
    assert_allclose(elastic, stiff, rtol=0, atol=5e-5 * np.abs(stiff).max())


def test_mass_given_to_nodes_where_holes_are_is_the_same_inertia() -> None:
    plan = beam.plan("cuboid", elements=2)
    filled = able_to_turn(plan)
    assert filled is not plan
    weights = [frame.rigid.T @ frame.mass @ frame.rigid for frame in map(assemble, (plan, filled))]
    assert_allclose(*weights, rtol=0, atol=1e-12 * weights[0].max())


def test_an_article_with_nothing_to_fill_is_taken_as_it_is() -> None:
    plan = beam.plan("clumod-4", elements=1)
    assert able_to_turn(plan) is plan


def test_places_tell_their_acceleration_in_the_axes_that_were_asked_for(smooth: Callable[..., BaseMotion]) -> None:
    """On the FMD, which is rigid: what an accelerometer there reads, turned or not."""
    from fem.flexible_body.large_motion.turning import accelerometer, turning

    place = np.array([0.1, -0.2, 0.3])
    motion = smooth(np.array([0.1, -0.05, 0.03, 0.6, -0.5, 1.0]), np.array([3.0, 4.0, 5.0, 4.3, 5.1, 3.7]), 0.5, 2048.0)
    expected = accelerometer(motion, place)
    for axes in ("table", "laboratory"):
        found = respond("fmd", motion, elements=1, axes=axes, places={"CORNER": place}).places["CORNER"]
        seen = expected if axes == "table" else turning(motion).seen_from_laboratory(expected)
        assert_allclose(found, seen, rtol=0, atol=1e-4 * np.abs(expected).max())


def test_springs_that_are_matrices_are_refused(smooth: Callable[..., BaseMotion]) -> None:
    with pytest.raises(BadInput, match=r"`ports`: springs between ports are matrices that do not turn .* found 4"):
        able_to_turn(beam.plan("fmd+clumod-1", cells=beam.load_cells()))


def test_a_disc_thinner_than_its_holes_allow_is_refused() -> None:
    with pytest.raises(BadInput, match="more material is taken away at node 0 than there is"):
        respond("disc", replace_motion(), elements=1)


def test_a_frame_of_ones_own_is_driven_like_a_built_in_one(kicked: tuple[BaseMotion, Array]) -> None:
    motion = short(kicked[0])
    plan = beam.plan("fmd+cuboid", elements=1)
    ours, named = respond_of_plan(plan, motion, Conditions()), respond("fmd+cuboid", motion, elements=1)
    assert_allclose(ours.load, named.load, rtol=0, atol=1e-12)


def test_about_another_reference_point_the_load_is_moved_there(kicked: tuple[BaseMotion, Array]) -> None:
    """At small motion, both tables doing the same: t_P = t_O - r x f."""
    motion, r = short(kicked[0]), np.array([0.2, -0.1, 0.4])
    whole = respond("fmd+cuboid", motion, elements=1)
    arm = np.cross(motion.displacement[:, 3:], r)
    moved = replace_motion(motion, r, arm)
    found = respond("fmd+cuboid", moved, elements=1)
    assert_allclose(found.load[:, :3], whole.load[:, :3], rtol=0, atol=1e-5 * np.abs(whole.load).max())
    expected = whole.load[:, 3:] - np.cross(r, whole.load[:, :3])
    assert_allclose(found.load[:, 3:], expected, rtol=0, atol=1e-5 * np.abs(whole.load).max())


def short(motion: BaseMotion) -> BaseMotion:
    n = round(0.6 * RATE)
    return replace(
        motion, displacement=motion.displacement[:n], velocity=motion.velocity[:n], acceleration=motion.acceleration[:n]
    )


def replace_motion(motion: BaseMotion | None = None, r: Array | None = None, arm: Array | None = None) -> BaseMotion:
    """`motion` of the same table told of the point `r`; a table at rest without one."""
    if motion is None or r is None:
        return BaseMotion(
            sampling_rate=64.0, displacement=np.zeros((4, 6)), velocity=np.zeros((4, 6)), acceleration=np.zeros((4, 6)), driven=0.0
        )
    parts = []
    for part in (motion.displacement, motion.velocity, motion.acceleration):
        told = np.array(part)
        told[:, :3] += np.cross(part[:, 3:], r)
        parts.append(told)
    return replace(motion, displacement=parts[0], velocity=parts[1], acceleration=parts[2], reference_point=r)


def plan_of_nothing() -> Plan:
    return Plan(nodes=np.zeros((1, 3)), carriers=(0,))
