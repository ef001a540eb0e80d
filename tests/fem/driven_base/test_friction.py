"""A loose part on the flange against closed forms: what it pulls at most, what it adds while it sticks, what it wears away."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.base_excitation.patterns import BaseMotion
from fem.base_excitation.rig import FlexibleBody, Friction, Rig
from fem.exudyn.driven_rig import STICKING
from fem.exudyn.driven_run import respond
from geometry.frames import Array, rigid_transformation
from geometry.inertia import Inertia

MASS, LEVEL, FREQUENCY = 2.0, 2.5, 10.0

SEAT = (0.0, 0.0, 0.05)


@pytest.fixture(scope="module")
def loose(block: FlexibleBody, shake: Callable[..., BaseMotion], inertia: Inertia) -> Callable[..., tuple[BaseMotion, Array]]:
    """Motion along an axis, and the load (n, 6) of nothing but the part, about F."""

    def made(slip_force: float, axis: Literal["x", "y"] = "x", driven: str = "x") -> tuple[BaseMotion, Array]:
        motion = shake(LEVEL * (np.arange(6) == "xyz".index(driven)), frequency=FREQUENCY, seconds=1.0, rate=8192.0)
        friction = Friction(axis=axis, slip_force=slip_force, mass=MASS)
        response = respond(Rig(article=block, frictions=(friction,)), motion)
        return motion, response.load - response.table @ inertia.mass_matrix

    return made


def test_the_pull_of_a_loose_part_saturates_at_its_slip_force(loose: Callable[..., tuple[BaseMotion, Array]]) -> None:
    _, load = loose(0.4 * MASS * LEVEL)
    assert_allclose([load[:, 0].max(), -load[:, 0].min()], 0.4 * MASS * LEVEL, rtol=1e-6)


@pytest.mark.parametrize("share", [1.02, 20.0])
def test_below_the_level_at_which_it_slips_it_is_an_added_mass(
    share: float, loose: Callable[..., tuple[BaseMotion, Array]]
) -> None:
    motion, load = loose(share * MASS * LEVEL)
    stuck = MASS * motion.acceleration[:, 0]
    assert_allclose(load[:, 0], stuck, atol=2 * (FREQUENCY / STICKING) ** 2 * MASS * LEVEL)


@pytest.mark.parametrize("share", [0.1, 1.02])
def test_how_long_it_slips_is_told(share: float, block: FlexibleBody, shake: Callable[..., BaseMotion]) -> None:
    """From when the table's sine has swollen to F / m, 1 - exp(-(3 t)^4) = F / (m a) in a record of 1 s; else never."""
    motion = shake([LEVEL, 0, 0, 0, 0, 0], frequency=FREQUENCY, seconds=1.0, rate=8192.0)
    friction = Friction(axis="x", slip_force=share * MASS * LEVEL, mass=MASS)
    (found,) = respond(Rig(article=block, frictions=(friction,)), motion).slipping
    expected = 1 - (-np.log(1 - share)) ** 0.25 / 3 if share < 1 else 0.0
    assert found == pytest.approx(expected, abs=0.02)  # a fifth of a cycle: it comes to rest and turns twice in each


@pytest.mark.parametrize(("axis", "driven"), [("x", "y"), ("x", "z"), ("y", "x")])
def test_across_its_axis_it_is_an_added_mass_at_any_level(
    axis: Literal["x", "y"], driven: str, loose: Callable[..., tuple[BaseMotion, Array]]
) -> None:
    motion, load = loose(0.1, axis, driven)
    assert_allclose(load[:, :3], MASS * motion.acceleration[:, :3], atol=2e-4 * MASS * LEVEL)


def test_it_sits_at_the_origin_of_the_article(block: FlexibleBody, shake: Callable[..., BaseMotion], inertia: Inertia) -> None:
    motion = shake([0, 2.0, 0, 1.0, 0, 0], rate=8192.0)
    frictions = (Friction(axis="x", slip_force=100.0, mass=MASS),)
    with_part, without = (respond(Rig(article=block, seat=SEAT, frictions=parts), motion).load for parts in (frictions, ()))
    G = rigid_transformation(SEAT)
    expected = MASS * motion.acceleration @ G.T @ G
    assert_allclose(with_part - without, expected, atol=1e-3 * np.abs(expected).max())


@pytest.mark.parametrize("share", [0.1, 0.25, 0.4])
def test_a_part_that_always_slides_wears_away_the_energy_of_coulombs_law(
    share: float, loose: Callable[..., tuple[BaseMotion, Array]]
) -> None:
    """Its speed is a triangle under the table's sine: a cycle takes W = 4 F U sqrt(1 - (pi F / 2 m a)²), U the table's stroke.

    (Den Hartog, Trans. ASME 53, 1931, for a mass without spring: it slides all the time while F / (m a) < 0.537.)
    """
    slip_force = share * MASS * LEVEL
    motion, load = loose(slip_force)
    cycle = round(motion.sampling_rate / FREQUENCY * 5)
    work = np.trapezoid(load[-cycle - 1 :, 0] * motion.velocity[-cycle - 1 :, 0]) / motion.sampling_rate / 5
    stroke = LEVEL / (2 * np.pi * FREQUENCY) ** 2
    expected = 4 * slip_force * stroke * np.sqrt(1 - (np.pi * share / 2) ** 2)
    assert_allclose(work, expected, rtol=5e-3)


def test_two_loose_parts_lie_on_one_flange(block: FlexibleBody, shake: Callable[..., BaseMotion], inertia: Inertia) -> None:
    motion = shake([2.0, 1.0, 0, 0, 0, 0], rate=8192.0)
    parts = (Friction(axis="x", slip_force=0.5, mass=MASS), Friction(axis="y", slip_force=0.3, mass=MASS))
    response = respond(Rig(article=block, frictions=parts), motion)
    pull = response.load - response.table @ inertia.mass_matrix
    across = MASS * motion.acceleration[:, :2]
    assert_allclose(np.abs(pull[:, 0] - across[:, 0]).max(), 0.5, rtol=5e-3)
    assert_allclose(np.abs(pull[:, 1] - across[:, 1]).max(), 0.3, rtol=5e-3)
