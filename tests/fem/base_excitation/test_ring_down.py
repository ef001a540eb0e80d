"""A record is long enough when what still rings is below a share of the greatest load, and is warned of when it is not."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.base_excitation import first_order_hold, response, rig
from fem.base_excitation.patterns import BaseMotion
from fem.base_excitation.rig import FlexibleBody, Friction, LoadCell, Rig
from geometry.inertia import Inertia

Burst = Callable[..., BaseMotion]


def cut(motion: BaseMotion, seconds: float) -> BaseMotion:
    """The record of `motion` until `seconds`."""
    n = int(np.ceil(seconds * motion.sampling_rate)) + 1
    return replace(
        motion, displacement=motion.displacement[:n], velocity=motion.velocity[:n], acceleration=motion.acceleration[:n]
    )


def oscillator(ratio: float) -> Rig:
    """10 kg on springs, 15 Hz along z."""
    omega, mass = 2 * np.pi * 15.0, 10.0
    k, c = mass * omega**2, 2 * ratio * mass * omega
    ball = rig.rigid("ball", Inertia.from_cog(mass, [0, 0, 0], np.diag([0.1, 0.1, 0.1])))
    corners = ((0.1, 0.1), (-0.1, 0.1), (-0.1, -0.1), (0.1, -0.1))
    cells = [LoadCell(position=[x, y, 0.0], stiffness=[k / 4] * 3, damping=[c / 4] * 3) for x, y in corners]
    return Rig(article=ball, cells=tuple(cells))


@pytest.mark.parametrize("axis", [2, 5])
@pytest.mark.parametrize("share", [1e-2, 1e-4])
def test_after_the_length_needed_nothing_louder_than_the_share_is_left(burst: Burst, share: float, axis: int) -> None:
    rig, motion = oscillator(0.01), burst(2048.0, np.eye(6)[axis], 20.0)
    load = np.abs(response.respond(rig, motion).load[:, axis])
    needed = response.needed(rig, motion, share)
    after = load[motion.time >= needed].max() / load.max()
    # The amplitude of the mode is meant, and its force peaks once in half a period, in which it falls by 3 %.
    assert share * 0.95 < after < share * 1.0001


def test_a_cut_record_is_warned_of_with_the_length_that_a_whole_one_would_ask_for(clumod: Callable, burst: Burst) -> None:
    rig, whole = Rig(article=clumod("clumod-4")), burst(8192.0, np.array([1.0, 1, 0, 0, 0, 0]), 12.0)
    needed = response.needed(rig, whole)
    assert whole.driven + 1 < needed < whole.duration
    assert response.warning(rig, whole) == ""
    assert response.respond(rig, cut(whole, needed)).warnings == ()
    short = cut(whole, needed - 0.5)
    (warning,) = response.respond(rig, short).warnings
    assert f"while the article still rings: after the drive {needed - short.driven:.4g} s are needed" in warning
    assert response.warning(rig, short) == warning


def test_a_record_short_by_a_hair_is_not_warned_of(clumod: Callable, burst: Burst) -> None:
    """Its length may come from a coarser simulation, which finds another one by milliseconds."""
    rig, axis = Rig(article=clumod("clumod-4")), np.eye(6)[0]
    coarse, fine = (response.needed(rig, burst(rate, axis, 12.0)) for rate in (512.0, 8192.0))
    whole = burst(8192.0, axis, 12.0)
    rings = fine - whole.driven
    assert 0 < abs(coarse - fine) < 0.001 * rings
    assert response.respond(rig, cut(whole, fine - 0.005 * rings)).warnings == ()
    assert response.respond(rig, cut(whole, fine - 0.02 * rings)).warnings


def test_a_record_cut_before_the_drive_has_ended_says_so(burst: Burst) -> None:
    short = cut(burst(2048.0, np.eye(6)[2], 20.0), 0.33)
    assert "before the drive has" in response.warning(oscillator(0.01), short)


def test_what_has_no_damping_never_stops_ringing(burst: Burst) -> None:
    motion = burst(2048.0, np.eye(6)[2], 2.0)
    assert response.needed(oscillator(0.0), motion) == np.inf
    assert "no damping" in response.warning(oscillator(0.0), motion)


def test_half_the_damping_needs_twice_the_ring_down(burst: Burst) -> None:
    motion = burst(2048.0, np.eye(6)[2], 1.0, width=0.01)  # so short that damping hardly matters during the drive
    long, twice = (response.needed(oscillator(ratio), motion, 1e-9) - motion.driven for ratio in (2e-3, 1e-3))
    assert_allclose(twice / long, 2, rtol=0.01)


def test_a_rigid_article_needs_no_ring_down(rigid_block: FlexibleBody, burst: Burst) -> None:
    motion = burst(2048.0, np.ones(6), 0.0)
    assert response.needed(Rig(article=rigid_block), motion) == motion.driven
    assert response.warning(Rig(article=rigid_block), motion) == ""


def test_a_table_at_rest_needs_nothing(burst: Burst) -> None:
    still = burst(2048.0, np.zeros(6), 0.0)
    assert response.needed(oscillator(0.01), still) == still.driven


def test_a_nonlinear_rig_rings_as_it_does_while_nothing_slips_or_lifts(burst: Burst) -> None:
    rig, motion = oscillator(0.01), burst(2048.0, np.eye(6)[2], 1.0)
    cells = tuple(replace(cell, preload=1e4) for cell in rig.cells)
    loose = replace(rig, cells=cells, frictions=(Friction(axis="x", slip_force=10.0),))
    assert response.needed(loose, motion) == response.needed(rig, motion)


def test_modes_that_cannot_be_told_apart_are_given_the_slowest_decay(burst: Burst, monkeypatch: pytest.MonkeyPatch) -> None:
    rig, motion = oscillator(0.01), burst(2048.0, np.eye(6)[2], 1.0)
    apart = response.needed(rig, motion)
    for module in (first_order_hold, response):
        monkeypatch.setattr(module, "poles", lambda system: None)
    assert apart <= response.needed(rig, motion) < apart + 2.0  # a bound: a factor of 5 is 1.7 s
