"""Runs of exudyn: what the step costs, what a result says, how a run is stopped, and what is refused."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from importlib.metadata import version

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.base_excitation import response as base_excitation_response
from fem.base_excitation.patterns import BaseMotion
from fem.base_excitation.rig import Flange, FlexibleBody, Friction, LoadCell, Rig
from fem.exudyn.driven_run import Solver, respond
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array
from geometry.inertia import Inertia

Shake = Callable[..., BaseMotion]
Cells = tuple[LoadCell, ...]
Reed = Callable[..., FlexibleBody]
Moves = Callable[[float], BaseMotion]


@pytest.fixture(scope="module")
def motion(shake: Shake) -> BaseMotion:
    return shake([1.0, 0, 0, 0, 0, 0])


@pytest.fixture(scope="module")
def long(shake: Shake) -> BaseMotion:
    """So long that nobody waits for its end."""
    return shake([1.0, 0, 0, 0, 0, 0], seconds=60.0)


def test_progress_is_told_from_the_beginning_to_the_end(block: FlexibleBody, motion: BaseMotion) -> None:
    shares: list[float] = []
    respond(Rig(article=block), motion, progress=shares.append)
    assert shares == sorted(shares)
    assert shares[0] < 0.02
    assert shares[-1] == 1.0
    assert 50 < len(shares) < 300


class Enough(Exception):
    """Anything that a hook may raise."""


@pytest.mark.parametrize("reason", [KeyboardInterrupt, Enough])
def test_what_the_hook_raises_ends_the_run_and_leaves_as_it_is(
    reason: type[BaseException], block: FlexibleBody, long: BaseMotion
) -> None:
    told: list[float] = []

    def stop(share: float) -> None:
        told.append(share)
        if share > 0.01:
            raise reason

    with pytest.raises(reason):
        respond(Rig(article=block), long, progress=stop)
    assert 0.01 < told[-1] < 0.03


def test_a_rig_that_gains_energy_is_lost_with_the_time_the_step_and_the_last_state(reed: Reed, shake: Shake) -> None:
    """A damping ratio of -3 grows by exp(6 omega t): lost after some hundredths of a second, whatever the step."""
    with pytest.raises(CheckFailed, match="coordinate 1 of the article") as lost:
        respond(Rig(article=reed(40.0, -3.0)), shake([1.0, 0, 0, 0, 0, 0], seconds=2.0))
    evidence = lost.value.evidence
    time, value = evidence["time"], evidence["value"]
    assert isinstance(time, float)
    assert isinstance(value, float)
    assert 0.01 < time < 0.2
    assert evidence["step"] == round(time * 4096)
    assert abs(value) > 1e6
    for said in (f"exudyn {version('exudyn')}", f"{time:.6g} s", f"step {evidence['step']} of 8192", f"{value:.4g}"):
        assert said in str(lost.value)


def test_a_step_that_cannot_bear_the_fastest_joint_is_lost_when_nobody_judged_it(
    block: FlexibleBody, cover: Inertia, motion: BaseMotion, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The stability limit is real: two steps fewer a sample than the rule asks for, and the rig flies apart."""
    rig = Rig(article=block, cover=cover, flange=Flange(compliance=[1e-10, 0, 0, 0, 0, 0]))
    enough = respond(rig, motion).settings["subdivision"]
    assert isinstance(enough, int)
    monkeypatch.setattr("fem.exudyn.driven_run.STABLE", {})
    with pytest.raises(CheckFailed, match="Take more steps a sample"):
        respond(rig, motion, solver=Solver(subdivision=enough - 2))


def test_a_response_says_how_it_was_found_and_holds_every_sample(
    block: FlexibleBody, cover: Inertia, cells: Cells, motion: BaseMotion
) -> None:
    solver = Solver(method="generalised-alpha", spectral_radius=0.8, subdivision=2, tolerance=1e-5)
    response = respond(Rig(article=block, cover=cover, cells=cells), motion, solver=solver)
    settings = json.loads(json.dumps(dict(response.settings)))
    assert settings["exudyn"] == version("exudyn")
    expected = {"method": "generalised-alpha", "spectral_radius": 0.8, "subdivision": 2, "tolerance": 1e-5, "step_s": 1 / 8192}
    assert settings.items() >= expected.items()
    assert len(response.table) == len(motion.acceleration)
    assert response.cells.shape == (len(response.table), 4, 3)
    assert response.coordinates.size == 0


def test_coordinates_come_when_they_are_asked_for(reed: Reed, motion: BaseMotion) -> None:
    body = reed(20.0, 0.01)
    q = respond(Rig(article=body), motion, keep_coordinates=True).coordinates
    assert q.shape == (len(motion.displacement), 7)
    assert_allclose(q[:, :6], motion.displacement, atol=2e-4 * np.abs(motion.displacement).max())


def test_a_rig_that_cannot_be_is_refused_by_name(block: FlexibleBody, motion: BaseMotion) -> None:
    """Every way of it is tried on the door itself, in `base_excitation/test_rig.py`."""
    with pytest.raises(BadInput, match=r"`frictions\.slip_force`"):
        respond(Rig(article=block, frictions=(Friction(axis="x", slip_force=-1.0),)), motion)


def test_a_cover_plate_that_no_body_can_be_is_refused(block: FlexibleBody, motion: BaseMotion) -> None:
    thin = Inertia.from_cog(10.0, [0, 0, 0], np.diag([0.1, 0.1, 0.5]))
    with pytest.raises(BadInput, match="cover plate"):
        respond(Rig(article=block, cover=thin), motion)


@pytest.mark.parametrize(
    ("wrong", "field"),
    [
        ({"method": "euler"}, "method"),
        ({"spectral_radius": 0.0}, "spectral_radius"),
        ({"spectral_radius": 1.1}, "spectral_radius"),
        ({"subdivision": 0}, "subdivision"),
        ({"tolerance": 0.0}, "tolerance"),
    ],
)
def test_a_solver_that_cannot_be_is_refused_by_name(wrong: dict[str, object], field: str) -> None:
    with pytest.raises(BadInput) as refused:
        Solver(**wrong)  # type: ignore[arg-type]
    assert refused.value.field == field


RATES = (512.0, 1024.0, 2048.0)

FINE = 32768.0


@pytest.fixture(scope="module")
def ringing(reed: Reed) -> Rig:
    """An oscillator of 12 Hz that hardly loses energy."""
    return Rig(article=reed(12.0, 1e-3))


@pytest.fixture(scope="module")
def moves(shake: Shake) -> Moves:
    return lambda rate: shake([1.0, 0, 0, 0, 0, 0], frequency=11.0, seconds=2.0, rate=rate)


@pytest.fixture(scope="module")
def truth(ringing: Rig, moves: Moves) -> Array:
    """(n,) [N] along x, by the exact recursion with steps so short that they do not count."""
    return base_excitation_response.respond(ringing, moves(FINE)).load[:, 0]


def errors(rig: Rig, moves: Moves, truth: Array, solver: Solver) -> Array:
    """Of the load, of the largest load, at each of the `RATES`."""
    found = []
    for rate in RATES:
        exact = truth[:: round(FINE / rate)]
        found.append(np.abs(respond(rig, moves(rate), solver=solver).load[:, 0] - exact).max() / np.abs(exact).max())
    return np.array(found)


@pytest.mark.parametrize(
    "solver", [Solver(), Solver(method="newmark"), Solver(method="generalised-alpha")], ids=lambda solver: str(solver.method)
)
def test_the_load_converges_with_the_square_of_the_step(solver: Solver, ringing: Rig, moves: Moves, truth: Array) -> None:
    found = errors(ringing, moves, truth, solver)
    assert_allclose(np.log2(found[:-1] / found[1:]), 2.0, atol=0.15)


def test_fox_and_goodwin_keep_a_lightly_damped_resonance_twenty_times_better(ringing: Rig, moves: Moves, truth: Array) -> None:
    trapezoidal, default = (errors(ringing, moves, truth, Solver(method=m)) for m in ("newmark", "fox-goodwin"))
    assert np.all(default < trapezoidal / 20)


def test_a_spectral_radius_of_one_loses_the_load_the_shorter_the_step(ringing: Rig, moves: Moves, truth: Array) -> None:
    lossless, default = (
        errors(ringing, moves, truth, Solver(method="generalised-alpha", spectral_radius=radius)) for radius in (1.0, 0.9)
    )
    assert lossless[-1] / default[-1] > lossless[0] / default[0]


def test_half_the_step_at_the_same_samples_is_half_the_step(ringing: Rig, moves: Moves) -> None:
    solver = Solver(method="generalised-alpha")
    halved = respond(ringing, moves(1024.0), solver=replace(solver, subdivision=2)).load
    fine = respond(ringing, moves(2048.0), solver=solver).load[::2]
    assert_allclose(halved, fine, atol=1e-6 * np.abs(fine).max())


def test_stiff_joints_get_as_many_steps_a_sample_as_they_need(block: FlexibleBody, cover: Inertia, shake: Shake) -> None:
    rig = Rig(article=block, cover=cover, flange=Flange(compliance=[0, 0, 1e-10, 0, 0, 0]))
    motion = shake([0, 0, 1.0, 0, 0, 0], seconds=0.2)
    response = respond(rig, motion)
    steps = response.settings["subdivision"]
    assert isinstance(steps, int)
    assert steps > 1
    with pytest.raises(BadInput, match=f"needs {steps} steps a sample, found 1"):
        respond(rig, motion, solver=Solver(subdivision=1))
    assert_allclose(response.load, base_excitation_response.respond(rig, motion).load, atol=1e-3 * np.abs(response.load).max())


def test_a_step_too_coarse_for_the_highest_kept_mode_is_refused_with_the_rate_that_is_needed(reed: Reed, shake: Shake) -> None:
    rig, motion = Rig(article=reed(300.0, 0.01)), shake([1.0, 0, 0, 0, 0, 0], rate=1024.0, seconds=0.1)
    with pytest.raises(BadInput, match=r"300 Hz.*Simulate at 2400 Hz or more, or keep fewer modes"):
        respond(rig, motion, solver=Solver(method="newmark"))
    respond(rig, motion, solver=Solver(method="newmark", subdivision=3))
