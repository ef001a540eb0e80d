"""What the step costs: rates of convergence, samples between samples, steps that are too long."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.base_excitation import response as base_excitation_response
from fem.base_excitation.patterns import BaseMotion
from fem.base_excitation.rig import Flange, FlexibleBody, Friction, LoadCell, Rig
from fem.exudyn.driven_rig import targets
from fem.exudyn.driven_run import Solver, highest, respond
from geometry.errors import BadInput
from geometry.frames import Array
from geometry.inertia import Inertia

RATES = (512.0, 1024.0, 2048.0)

FINE = 32768.0


@pytest.fixture(scope="module")
def ringing(reed: Callable[..., FlexibleBody]) -> Rig:
    """An oscillator of 12 Hz that hardly loses energy."""
    return Rig(article=reed(12.0, 1e-3))


@pytest.fixture(scope="module")
def moves(shake: Callable[..., BaseMotion]) -> Callable[[float], BaseMotion]:
    return lambda rate: shake([1.0, 0, 0, 0, 0, 0], frequency=11.0, seconds=2.0, rate=rate)


@pytest.fixture(scope="module")
def truth(ringing: Rig, moves: Callable[[float], BaseMotion]) -> Array:
    """(n,) [N] along x, by the exact recursion with steps so short that they do not count."""
    return base_excitation_response.respond(ringing, moves(FINE)).load[:, 0]


def errors(rig: Rig, moves: Callable[[float], BaseMotion], truth: Array, solver: Solver) -> Array:
    """Of the load, of the largest load, at each of the `RATES`."""
    found = []
    for rate in RATES:
        exact = truth[:: round(FINE / rate)]
        found.append(np.abs(respond(rig, moves(rate), solver=solver).load[:, 0] - exact).max() / np.abs(exact).max())
    return np.array(found)


@pytest.mark.parametrize(
    "solver", [Solver(), Solver(method="newmark"), Solver(method="generalised-alpha")], ids=lambda solver: str(solver.method)
)
def test_the_load_converges_with_the_square_of_the_step(
    solver: Solver, ringing: Rig, moves: Callable[[float], BaseMotion], truth: Array
) -> None:
    found = errors(ringing, moves, truth, solver)
    assert_allclose(np.log2(found[:-1] / found[1:]), 2.0, atol=0.15)


def test_fox_and_goodwin_keep_a_lightly_damped_resonance_twenty_times_better(
    ringing: Rig, moves: Callable[[float], BaseMotion], truth: Array
) -> None:
    trapezoidal, default = (errors(ringing, moves, truth, Solver(method=m)) for m in ("newmark", "fox-goodwin"))
    assert np.all(default < trapezoidal / 20)


def test_a_spectral_radius_of_one_loses_the_load_the_shorter_the_step(
    ringing: Rig, moves: Callable[[float], BaseMotion], truth: Array
) -> None:
    lossless, default = (
        errors(ringing, moves, truth, Solver(method="generalised-alpha", spectral_radius=radius)) for radius in (1.0, 0.9)
    )
    assert lossless[-1] / default[-1] > lossless[0] / default[0]


@pytest.mark.parametrize("velocity", [False, True])
def test_between_samples_the_table_follows_a_polynomial_of_fifth_degree_exactly(velocity: bool) -> None:
    curve = np.polynomial.Polynomial([0.3, -1.0, 2.0, 0.5, -3.0, 1.5])
    t, fine = np.arange(9) / 8.0, np.arange(8 * 5 + 1) / 40.0
    at = [np.tile(curve.deriv(order)(t)[:, None], (1, 6)) if order else np.tile(curve(t)[:, None], (1, 6)) for order in range(3)]
    motion = BaseMotion(sampling_rate=8.0, displacement=at[0], velocity=at[1], acceleration=at[2], driven=1.0)
    expected = curve.deriv()(fine) if velocity else curve(fine)
    assert_allclose(targets(motion, 5, velocity=velocity)[:, 3], expected, atol=1e-12)


def test_half_the_step_at_the_same_samples_is_half_the_step(ringing: Rig, moves: Callable[[float], BaseMotion]) -> None:
    solver = Solver(method="generalised-alpha")
    halved = respond(ringing, moves(1024.0), solver=replace(solver, subdivision=2)).load
    fine = respond(ringing, moves(2048.0), solver=solver).load[::2]
    assert_allclose(halved, fine, atol=1e-6 * np.abs(fine).max())


def test_the_highest_frequency_is_that_of_the_softest_cells_and_heaviest_plate(
    block: FlexibleBody, cover: Inertia, cells: tuple[LoadCell, ...]
) -> None:
    """Up and down, centred: sqrt(sum k / m); the other way round for the bristles of a loose part on a heavy table."""
    still = Inertia.from_cog(8.0, [0, 0, 0], np.eye(3) * 100.0)
    light = replace(block, reduced=replace(block.reduced, mass=1e-9 * np.diag([1.0, 1, 1, 1, 1, 1])))
    rig = Rig(article=light, cover=still, cells=cells)
    assert_allclose(highest(rig), np.sqrt(16e8 / 8.0) / (2 * np.pi), rtol=1e-6)
    assert_allclose(highest(Rig(article=block, frictions=(Friction(axis="x", slip_force=1.0),))), 1000.0, rtol=1e-6)


def test_stiff_joints_get_as_many_steps_a_sample_as_they_need(
    block: FlexibleBody, cover: Inertia, shake: Callable[..., BaseMotion]
) -> None:
    rig = Rig(article=block, cover=cover, flange=Flange(compliance=[0, 0, 1e-10, 0, 0, 0]))
    motion = shake([0, 0, 1.0, 0, 0, 0], seconds=0.2)
    response = respond(rig, motion)
    steps = response.settings["subdivision"]
    assert isinstance(steps, int)
    assert steps > 1
    with pytest.raises(BadInput, match=f"needs {steps} steps a sample, found 1"):
        respond(rig, motion, solver=Solver(subdivision=1))
    assert_allclose(response.load, base_excitation_response.respond(rig, motion).load, atol=1e-3 * np.abs(response.load).max())


def test_a_step_too_coarse_for_the_highest_kept_mode_is_refused_with_the_rate_that_is_needed(
    reed: Callable[..., FlexibleBody], shake: Callable[..., BaseMotion]
) -> None:
    rig, motion = Rig(article=reed(300.0, 0.01)), shake([1.0, 0, 0, 0, 0, 0], rate=1024.0, seconds=0.1)
    with pytest.raises(BadInput, match=r"300 Hz.*Simulate at 2400 Hz or more, or keep fewer modes"):
        respond(rig, motion, solver=Solver(method="newmark"))
    respond(rig, motion, solver=Solver(method="newmark", subdivision=3))
