"""Bodies and beams on a table that really turns: how it turns, Newton and Euler, gravity, losses."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.base_excitation.patterns import BaseMotion, phased_sweeps
from fem.base_excitation.response import judge
from fem.beam import articles
from fem.beam.elements import rectangle
from fem.beam.frame import Member, Plan
from fem.exudyn import frame, large_motion
from fem.exudyn.frame import lossy, viscous
from fem.exudyn.large_motion import Conditions, able_to_turn, respond, respond_of_plan, rigid, seen_by, turning
from fem.exudyn.linear import linearise, stiffness_of
from fem.exudyn.run import running
from geometry.article import material
from geometry.errors import BadInput
from geometry.frames import Array, rigid_transformation, rotation_about
from geometry.inertia import Inertia

MakeMotion = Callable[..., BaseMotion]
Makes = Callable[..., Array]
Senses = Callable[[BaseMotion], Array]

LARGE = np.array([0.1, -0.05, 0.03, 1.1, -0.9, 1.4])
OMEGA = np.array([3.0, 4.0, 5.0, 4.3, 5.1, 3.7])
PLACE = np.array([0.4, -0.3, 0.2])
RATE = 4096.0


def test_rotation_is_that_about_x_then_about_the_turned_y_then_about_the_turned_z() -> None:
    angles, none = np.array([[0.3, -0.7, 1.1], [-1.2, 0.4, 2.0]]), np.zeros((2, 6))
    turned = np.hstack([np.zeros((2, 3)), angles])
    motion = BaseMotion(sampling_rate=1.0, displacement=turned, velocity=none, acceleration=none, driven=1.0)
    product = [rotation_about("x", a) @ rotation_about("y", b) @ rotation_about("z", c) for a, b, c in angles]
    assert_allclose(turning(motion), product, rtol=0, atol=1e-15)


def test_an_accelerometer_on_the_table_reads_the_second_derivative_of_its_place_and_gravity(
    smooth: MakeMotion, accelerometer: Makes
) -> None:
    motion = smooth(LARGE, OMEGA, rate=RATE)
    R = turning(motion)
    path = motion.displacement[:, :3] + R @ PLACE
    second = np.diff(path, 2, axis=0) * RATE**2 + [0.0, 0.0, 9.81]
    read = accelerometer(motion, PLACE, 9.81)[1:-1]
    assert_allclose(read, np.einsum("nji,nj->ni", R[1:-1], second), rtol=0, atol=1e-4 * np.abs(read).max())


WIDE = np.array([0.1, -0.05, 0.03, 0.6, -0.5, 1.0])
POINT = np.array([0.1, 0.2, -0.3])


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("axis", range(6))
def test_load_on_a_rigid_block_is_plus_its_mass_matrix_times_acceleration(
    axis: int, sign: float, block: Inertia, smooth: MakeMotion
) -> None:
    """All six components. At a microradian the terms of second order are 1e-6; the integrator's own error cancels."""
    motion = smooth(sign * 1e-6 * np.eye(6)[axis], OMEGA, 0.5)
    found = respond_of_plan(rigid(block), motion)
    peak = np.abs(found.load).max()
    assert_allclose(found.load, found.table @ block.mass_matrix, rtol=0, atol=2e-6 * peak)
    # the acceleration that was asked for, within the square of the step: 1024 Hz under 5 rad/s
    assert_allclose(found.table, motion.acceleration, rtol=0, atol=1e-4 * np.abs(motion.acceleration).max())


@pytest.mark.parametrize("gravity", [0.0, 9.81])
@pytest.mark.parametrize("point", [np.zeros(3), POINT], ids=["origin", "elsewhere"])
def test_at_large_motion_newton_and_euler_hold_in_the_tables_axes(
    gravity: float, point: Array, block: Inertia, smooth: MakeMotion, newton_euler: Makes
) -> None:
    """Through a radian at 4 rad/s. The error of the step is of second order, so two steps say where it goes."""
    loads = []
    for rate in (1024, 2048):
        motion = smooth(WIDE, OMEGA, rate=rate, point=point)
        assert np.abs(motion.displacement).max() > 0.98
        loads.append(respond_of_plan(rigid(block), motion, Conditions(gravity=gravity)).load[:: rate // 1024])
    exact = newton_euler(smooth(WIDE, OMEGA, rate=1024, point=point), block, gravity)
    changes, peak = exact - exact[0], np.abs(exact - exact[0]).max(axis=0)
    errors = [np.abs(load - changes).max(axis=0) / peak for load in (*loads, (4 * loads[1] - loads[0]) / 3)]
    assert_allclose(errors[0] / errors[1], 4.0, rtol=0.1)
    assert np.all(errors[2] < 2e-6)


def test_the_share_that_is_stated_bounds_what_exact_kinematics_leave_over(block: Inertia, newton_euler: Makes) -> None:
    """All six axes at once, three times the paper's drive, a body without symmetry; and the bound is not a loose one."""
    motion = phased_sweeps(3.0, rate=60.0)[1].motion(512, ring_down=0.1)
    kept = motion.acceleration @ block.mass_matrix
    left = newton_euler(motion, block) - kept
    sizes = [[np.linalg.norm(part[:, k], axis=1).max() for part in (left, kept)] for k in (slice(3), slice(3, 6))]
    share = max(left / kept for left, kept in sizes)
    assert 0.2 * judge(motion).left_out < share < judge(motion).left_out


def test_loads_in_the_laboratorys_axes_are_those_of_the_table_turned(block: Inertia, smooth: MakeMotion) -> None:
    motion = smooth(WIDE, OMEGA, 0.5)
    table, laboratory = (respond_of_plan(rigid(block), motion, Conditions(axes=axes)) for axes in ("table", "laboratory"))
    R = turning(motion)
    for part in (slice(0, 3), slice(3, 6)):
        assert_allclose(np.einsum("nij,nj->ni", R, table.load[:, part]), laboratory.load[:, part], rtol=0, atol=1e-9)
        assert_allclose(np.einsum("nij,nj->ni", R, table.table[:, part]), laboratory.table[:, part], rtol=0, atol=1e-9)
    # the force is the mass times the acceleration of the CoG in the laboratory, nothing else
    cog = R @ block.cog + motion.displacement[:, :3]
    second = np.diff(cog, 2, axis=0) * motion.sampling_rate**2
    force = laboratory.load[1:-1, :3] / block.mass
    assert_allclose(force, second, rtol=0, atol=2e-4 * np.abs(second).max())


def test_exudyns_accelerations_of_the_table_are_those_of_the_formula(block: Inertia, smooth: MakeMotion, sensed: Senses) -> None:
    motion = smooth(WIDE, OMEGA)
    found = respond_of_plan(rigid(block), motion).table
    assert_allclose(found, sensed(motion), rtol=0, atol=1e-4 * np.abs(found).max())


G = 9.81
FREQUENCY = 4.0
GRAVITY_OMEGA = 2 * np.pi * FREQUENCY


def added(axis: int, axes: str, block: Inertia, smooth: MakeMotion) -> Array:
    """(6,) what gravity adds to a column of H at 4 Hz, per kinematic acceleration, in exudyn: the load with it less that without.

    At a microradian nothing of second order is left; theta'' = -omega² theta in a sine, so theta stands for -theta'' / omega².
    """
    motion = smooth(1e-6 * np.eye(6)[axis], GRAVITY_OMEGA * np.ones(6))
    loads = [respond_of_plan(rigid(block), motion, Conditions(gravity=g, axes=axes)).load for g in (G, 0.0)]
    angle = motion.displacement[:, axis]
    per_angle = (loads[0] - loads[1]).T @ angle / (angle @ angle)
    return np.asarray(-per_angle / GRAVITY_OMEGA**2)


@pytest.mark.parametrize("axes", ["table", "laboratory"])
def test_gravity_adds_its_tilt_in_the_tables_axes_and_moments_alone_in_the_laboratorys(
    axes: str, block: Inertia, smooth: MakeMotion
) -> None:
    """Table: f_x/beta'' += m g/omega², f_y/alpha'' -= m g/omega², t_alpha/alpha'' and t_beta/beta'' += m g z/omega²; about gamma,
    which tilts nothing, no column but a row: t_gamma/alpha'' -= m g x/omega², t_gamma/beta'' -= m g y/omega².

    In the laboratory the weight is constant and a gamma column does stand, the CoG goes round under it: t = r x m g z with r
    turned by the angle, for gamma t_alpha = m g (y + x gamma), t_beta = -m g (x - y gamma).
    """
    weight, (x, y, z) = block.mass * G / GRAVITY_OMEGA**2, block.cog
    columns = {
        "table": [[0, -1, 0, z, 0, -x], [1, 0, 0, 0, z, -y], [0, 0, 0, 0, 0, 0]],
        "laboratory": [[0, 0, 0, z, 0, 0], [0, 0, 0, 0, z, 0], [0, 0, 0, -x, -y, 0]],
    }
    for axis, column in zip((3, 4, 5), weight * np.array(columns[axes]), strict=True):
        assert_allclose(added(axis, axes, block, smooth), column, rtol=0, atol=1e-5 * weight)


def test_with_accelerometers_that_sense_the_tilt_gravity_cancels_exactly_at_any_angle(
    block: Inertia, smooth: MakeMotion, accelerometer: Makes
) -> None:
    """Through a radian: what gravity adds to the load is M times what it adds to their reading, so H does not know of it."""
    motion = smooth(WIDE, OMEGA, 0.5)
    loads = [respond_of_plan(rigid(block), motion, Conditions(gravity=g)).load for g in (G, 0.0)]
    readings = [accelerometer(motion, np.zeros(3), g) for g in (G, 0.0)]
    sensed = (readings[0] - readings[1]) - [0.0, 0.0, G]  # charge amplifiers and cells forget what is constant
    expected = block.mass_matrix[:, :3] @ sensed.T
    assert_allclose(loads[0] - loads[1], expected.T, rtol=0, atol=1e-8 * block.mass * G)
    assert np.abs(sensed).max() > 0.5 * G


def test_weight_at_rest_is_told_and_taken_off(block: Inertia, smooth: MakeMotion) -> None:
    found = respond_of_plan(rigid(block), smooth(WIDE, OMEGA, 0.1), Conditions(gravity=G))
    at_rest = block.mass * G * (rigid_transformation(block.cog).T @ [0.0, 0.0, 1.0])
    assert_allclose(found.settings["load_at_rest"], at_rest, rtol=0, atol=1e-9 * block.mass * G)
    assert_allclose(found.load[0], np.zeros(6), rtol=0, atol=1e-12)


def test_an_elastic_article_weighs_as_much_and_stands_still_under_gravity(smooth: MakeMotion) -> None:
    """Bent by its weight from the first instant on: no jolt, and the load at rest is that of the rigid body."""
    motion = smooth(1e-9 * WIDE, OMEGA, 0.2, 256.0)
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
        scene, *_ = large_motion._assembled(exudyn, plan, still, Conditions(gravity=gravity, loss_frequency=None))
        large_motion.settle(scene)
        return float(scene.system.ComputeODE2Eigenvalues(numberOfEigenvalues=2, useAbsoluteValues=False)[0][0])


ELASTIC_RATE = 512.0
LOSSES_AT = 0.5
"""[Hz] where viscous and structural losses agree: damping of 7 % at the first mode, which rings down within the record."""
PULSE = 0.04


@pytest.fixture(scope="module")
def kicked() -> tuple[BaseMotion, Array]:
    """A short kick along y with a turn about x, and lines [Hz] at which it has something."""
    t = np.arange(round(1.8 * ELASTIC_RATE) + 1) / ELASTIC_RATE
    s = (t - 8 * PULSE) / PULSE
    bell = np.exp(-(s**2) / 2)
    shapes = (bell, -s / PULSE * bell, (s**2 - 1) / PULSE**2 * bell)
    directions = 1e-6 * np.array([[0.0, 1.0, 0.0, -0.7, 0.0, 0.3]])
    parts = [shape[:, None] * directions for shape in shapes]
    parts[0][0] = parts[1][0] = 0.0  # 1e-14 of the kick
    motion = BaseMotion(
        sampling_rate=ELASTIC_RATE, displacement=parts[0], velocity=parts[1], acceleration=parts[2], driven=16 * PULSE
    )
    return motion, np.array([2.0, 4.0, 6.0, 8.0])


def test_at_small_motion_the_response_is_that_of_the_linear_dynamic_mass(kicked: tuple[BaseMotion, Array], driven: Makes) -> None:
    """Clumod on one mesh, time against frequency: transforms of whole records. Below the first mode, at 11.5 Hz; the step shifts
    its square by (omega h)² / 6 = 3e-3 at 512 Hz, and the elastic eighth of the load at 8 Hz by about as much.
    """
    motion, lines = kicked
    found = respond("clumod-1", motion, elements=1, loss_frequency=LOSSES_AT)
    turn = np.exp(-2j * np.pi * lines[:, None] * motion.time)
    load, acceleration = turn @ found.load, turn @ found.table
    plan = articles.article_plan("clumod-1", elements=1)
    system, losses = linearise(plan, 10), stiffness_of(lossy(plan))
    stiff = load[-1] - acceleration[-1] @ system.rigid_mass
    assert np.abs(stiff).max() > 0.1 * np.abs(load[-1]).max()  # at 8 Hz an eighth of the load is elastic
    for k, line in enumerate(lines):
        expected = driven(system, losses * line / LOSSES_AT, line) @ acceleration[k]
        assert_allclose(load[k], expected, rtol=0, atol=5e-4 * np.abs(expected).max())


@pytest.mark.parametrize("name", ["clumod-1", "clumod-4"])
def test_dampers_beside_the_beams_are_the_lossy_stiffness_over_omega(name: str) -> None:
    """Beams, layers of a sandwich and all: the identity C = sum of eta K / omega, in exudyn's own matrices."""
    plan = articles.article_plan(name, elements=2)
    with running("linearise the damped frame") as exudyn:
        made = frame.build(exudyn, plan, held=False, damping=viscous(plan, 12.0))
        damping = np.array(made.system.ComputeLinearizedSystem()[2])
    expected = stiffness_of(lossy(plan)) / (2 * np.pi * 12.0)
    size = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    assert_allclose(damping, expected, rtol=0, atol=1e-12 * size.max())
    kept = size > 1e-9 * size.max()
    assert np.abs((damping - expected)[kept] / size[kept]).max() < 1e-9


def test_a_turning_beam_feels_nothing_of_its_dampers(smooth: MakeMotion) -> None:
    """The Cuboid through a radian, damped a hundred times as much as it is: the load changes by what bending at 1e-5 loses.

    The same dampers against the laboratory would hold it with meganewtons.
    """
    motion = smooth(WIDE, OMEGA, 0.5, 512.0)
    damped, free = (respond("cuboid", motion, elements=1, loss_frequency=f).load for f in (0.12, None))
    assert_allclose(damped, free, rtol=0, atol=5e-5 * np.abs(free).max())


@pytest.mark.parametrize("name", ["cuboid", "fmd+disc+cuboid"])
def test_a_stiff_article_of_beams_is_nearly_the_rigid_body_even_when_it_turns_far(name: str, smooth: MakeMotion) -> None:
    """Its holes included. The Cuboid gives by 3e-5; the rest is the step, 1.1e-4 at 512 Hz, and falls with its square."""
    motion = smooth(WIDE, OMEGA, 0.5, 512.0)
    elastic, stiff = (respond(name, motion, elements=elements, gravity=9.81).load for elements in (1, None))
    assert_allclose(elastic, stiff, rtol=0, atol=2e-4 * np.abs(stiff).max())


def test_places_tell_their_acceleration_in_the_axes_that_were_asked_for(smooth: MakeMotion, accelerometer: Makes) -> None:
    """Beside a node high on the stiff Cuboid: what an accelerometer on the table itself would read there, turned or not."""
    place = np.array([0.1, -0.2, 0.35])
    motion = smooth(WIDE, OMEGA, 0.5, 2048.0)
    expected = accelerometer(motion, place)
    for axes in ("table", "laboratory"):
        found = respond("cuboid", motion, elements=1, axes=axes, places={"CORNER": place}).places["CORNER"]
        seen = expected if axes == "table" else seen_by(turning(motion).swapaxes(1, 2), expected)
        # the step at 2048 Hz leaves 2e-5, the give of the Cuboid's top 1.5e-4
        assert_allclose(found, seen, rtol=0, atol=3e-4 * np.abs(expected).max())


def test_springs_that_are_matrices_are_refused() -> None:
    with pytest.raises(BadInput, match=r"`ports`: springs between ports are matrices that do not turn .* found 4"):
        able_to_turn(articles.article_plan("fmd+clumod-1", cells=articles.load_cells()))


def test_a_disc_thinner_than_its_holes_allow_is_refused() -> None:
    nothing = np.zeros((4, 6))
    still = BaseMotion(sampling_rate=64.0, displacement=nothing, velocity=nothing, acceleration=nothing, driven=0.0)
    with pytest.raises(BadInput, match="more material is taken away at node 0 than there is"):
        respond("disc", still, elements=1)
