"""Native beams on the moving table at small motion: the linear dynamic mass, losses, and what cannot turn."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.base_excitation.patterns import BaseMotion
from fem.beam import articles
from fem.beam.frame import assemble
from fem.exudyn import frame
from fem.exudyn.frame import lossy, viscous
from fem.exudyn.large_motion import Conditions, able_to_turn, respond, respond_of_plan, turning
from fem.exudyn.linear import linearise, stiffness_of
from fem.exudyn.run import running
from geometry.errors import BadInput
from geometry.frames import Array

RATE = 512.0
LOSSES_AT = 0.5
"""[Hz] where viscous and structural losses agree: damping of 7 % at the first mode, which rings down within the record."""
PULSE = 0.04


@pytest.fixture(scope="module")
def kicked() -> tuple[BaseMotion, Array]:
    """A short kick along y with a turn about x, and lines [Hz] at which it has something."""
    t = np.arange(round(1.8 * RATE) + 1) / RATE
    s = (t - 8 * PULSE) / PULSE
    bell = np.exp(-(s**2) / 2)
    shapes = (bell, -s / PULSE * bell, (s**2 - 1) / PULSE**2 * bell)
    directions = 1e-6 * np.array([[0.0, 1.0, 0.0, -0.7, 0.0, 0.3]])
    parts = [shape[:, None] * directions for shape in shapes]
    parts[0][0] = parts[1][0] = 0.0  # 1e-14 of the kick
    motion = BaseMotion(sampling_rate=RATE, displacement=parts[0], velocity=parts[1], acceleration=parts[2], driven=16 * PULSE)
    return motion, np.array([2.0, 4.0, 6.0, 8.0])


def test_at_small_motion_the_response_is_that_of_the_linear_dynamic_mass(
    kicked: tuple[BaseMotion, Array], driven: Callable[..., Array]
) -> None:
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


def test_a_turning_beam_feels_nothing_of_its_dampers(smooth: Callable[..., BaseMotion]) -> None:
    """The Cuboid through a radian, damped a hundred times as much as it is: the load changes by what bending at 1e-5 loses.

    The same dampers against the laboratory would hold it with meganewtons.
    """
    motion = smooth(np.array([0.1, -0.05, 0.03, 0.6, -0.5, 1.0]), np.array([3.0, 4.0, 5.0, 4.3, 5.1, 3.7]), 0.5, 512.0)
    damped, free = (respond("cuboid", motion, elements=1, loss_frequency=f).load for f in (0.12, None))
    assert_allclose(damped, free, rtol=0, atol=5e-5 * np.abs(free).max())


@pytest.mark.parametrize("name", ["cuboid", "fmd+disc+cuboid"])
def test_a_stiff_article_of_beams_is_nearly_the_rigid_body_even_when_it_turns_far(
    name: str, smooth: Callable[..., BaseMotion]
) -> None:
    """Its holes included. The Cuboid gives by 3e-5; the rest is the step, 1.1e-4 at 512 Hz, and falls with its square."""
    motion = smooth(np.array([0.1, -0.05, 0.03, 0.6, -0.5, 1.0]), np.array([3.0, 4.0, 5.0, 4.3, 5.1, 3.7]), 0.5, 512.0)
    elastic, stiff = (respond(name, motion, elements=elements, gravity=9.81).load for elements in (1, None))
    assert_allclose(elastic, stiff, rtol=0, atol=2e-4 * np.abs(stiff).max())


def test_mass_given_to_nodes_where_holes_are_is_the_same_inertia() -> None:
    plan = articles.article_plan("cuboid", elements=2)
    filled = able_to_turn(plan)
    assert filled is not plan
    weights = [frame.rigid.T @ frame.mass @ frame.rigid for frame in map(assemble, (plan, filled))]
    assert_allclose(*weights, rtol=0, atol=1e-12 * weights[0].max())


def test_an_article_with_nothing_to_fill_is_taken_as_it_is() -> None:
    plan = articles.article_plan("clumod-4", elements=1)
    assert able_to_turn(plan) is plan


def test_places_tell_their_acceleration_in_the_axes_that_were_asked_for(
    smooth: Callable[..., BaseMotion], accelerometer: Callable[..., Array]
) -> None:
    """Beside a node high on the stiff Cuboid: what an accelerometer on the table itself would read there, turned or not."""
    place = np.array([0.1, -0.2, 0.35])
    motion = smooth(np.array([0.1, -0.05, 0.03, 0.6, -0.5, 1.0]), np.array([3.0, 4.0, 5.0, 4.3, 5.1, 3.7]), 0.5, 2048.0)
    expected = accelerometer(motion, place)
    for axes in ("table", "laboratory"):
        found = respond("cuboid", motion, elements=1, axes=axes, places={"CORNER": place}).places["CORNER"]
        seen = expected if axes == "table" else turning(motion).seen_from_laboratory(expected)
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


def test_a_frame_of_ones_own_is_driven_like_a_built_in_one(kicked: tuple[BaseMotion, Array]) -> None:
    motion = short(kicked[0])
    plan = articles.article_plan("fmd+cuboid", elements=1)
    ours, named = respond_of_plan(plan, motion, Conditions()), respond("fmd+cuboid", motion, elements=1)
    assert_allclose(ours.load, named.load, rtol=0, atol=1e-12)


def test_about_another_reference_point_the_load_is_moved_there(kicked: tuple[BaseMotion, Array]) -> None:
    """At small motion, both tables doing the same: t_P = t_O - r x f. Forces of a microradian are known to 2e-5: the rounding of
    beams that take gigapascals.
    """
    motion, r = short(kicked[0]), np.array([0.2, -0.1, 0.4])
    whole = respond("fmd+cuboid", motion, elements=1)
    found = respond("fmd+cuboid", told_of(motion, r), elements=1)
    assert_allclose(found.load[:, :3], whole.load[:, :3], rtol=0, atol=5e-5 * np.abs(whole.load).max())
    expected = whole.load[:, 3:] - np.cross(r, whole.load[:, :3])
    assert_allclose(found.load[:, 3:], expected, rtol=0, atol=5e-5 * np.abs(whole.load).max())


def short(motion: BaseMotion) -> BaseMotion:
    n = round(0.6 * RATE)
    return replace(
        motion, displacement=motion.displacement[:n], velocity=motion.velocity[:n], acceleration=motion.acceleration[:n]
    )


def told_of(motion: BaseMotion, r: Array) -> BaseMotion:
    """The same small motion of the same table, told of its point `r`."""
    parts = {}
    for name in ("displacement", "velocity", "acceleration"):
        parts[name] = np.array(getattr(motion, name))
        parts[name][:, :3] += np.cross(parts[name][:, 3:], r)
    return replace(motion, reference_point=r, **parts)
