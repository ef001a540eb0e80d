"""Runs that are watched, stopped or go astray, what a result says about itself, and what is refused at the door."""

import json
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.base_excitation.patterns import BaseMotion
from fem.exudyn.driven_run import Solver
from fem.exudyn.large_motion import SOLVER, Conditions, respond, respond_of_plan, rigid
from fem.exudyn.run import exudyn_version
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array
from geometry.inertia import Inertia

MakeMotion = Callable[..., BaseMotion]
AMPLITUDE = np.array([0.01, 0.0, 0.0, 0.0, 0.02, 0.03])
OMEGA = np.full(6, 8.0)


@pytest.fixture(scope="module")
def motion(smooth: MakeMotion) -> BaseMotion:
    return smooth(AMPLITUDE, OMEGA, 1.0, 512.0)


def test_progress_rises_to_one_in_many_steps(motion: BaseMotion, block: Inertia) -> None:
    told: list[float] = []
    respond_of_plan(rigid(block), motion, progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 1.0
    assert 100 <= len(told) <= 400


@pytest.mark.parametrize("reason", [KeyboardInterrupt, OSError("the pipe is broken")])
def test_what_the_hook_raises_ends_the_run_and_comes_out_as_it_is(
    reason: type[BaseException] | BaseException, motion: BaseMotion, block: Inertia
) -> None:
    told: list[float] = []

    def stop(share: float) -> None:
        told.append(share)
        if share > 0.25:
            raise reason

    with pytest.raises(BaseException) as caught:  # noqa: PT011 - both kinds
        respond_of_plan(rigid(block), motion, progress=stop)
    assert caught.value is reason or isinstance(caught.value, KeyboardInterrupt)
    assert told[-1] < 0.3


def test_a_run_that_goes_astray_says_when_and_where(smooth: MakeMotion, capfd: pytest.CaptureFixture[str]) -> None:
    """A table thrown to and fro by ten metres at 30 Hz, two steps a cycle: no beam follows."""
    wild = smooth(np.array([10.0, 0, 0, 1.0, 1.0, 1.0]), np.full(6, 190.0), 1.0, 64.0)
    with pytest.raises(CheckFailed, match=rf"exudyn {exudyn_version()} .* step \d+") as caught:
        respond("clumod-1", wild, elements=1)
    evidence = caught.value.evidence
    assert 0 < evidence["time"] <= 1.0
    assert evidence["step"] == pytest.approx(evidence["time"] * 64.0)
    assert capfd.readouterr() == ("", "")


def test_a_result_says_how_it_was_found(motion: BaseMotion) -> None:
    found = respond("cuboid", motion, elements=None, gravity=9.81, solver=replace(SOLVER, spectral_radius=0.8))
    said = json.loads(json.dumps(dict(found.settings)))
    assert said["exudyn"] == exudyn_version()
    assert said["method"] == "generalised-alpha"
    assert said["spectral_radius"] == 0.8
    assert said["step_s"] == 1 / 512
    assert said["article"] == "cuboid"
    assert said["gravity"] == 9.81
    assert said["axes"] == "table"
    assert len(said["load_at_rest"]) == 6
    assert "large motion" in said["route"]


def test_motion_that_is_hardly_more_than_the_rounding_of_beams_still_converges(smooth: MakeMotion) -> None:
    """Of a level's hundred-thousandth at 4 kHz the tolerance asked of Newton's iteration would be 1e-18 m."""
    tiny = smooth(1e-6 * np.eye(6)[0], OMEGA, 0.03, 4096.0)
    found = respond("clumod-4", tiny, elements=3)
    assert_allclose(found.table, tiny.acceleration, rtol=0, atol=0.01 * np.abs(tiny.acceleration).max())


def test_two_runs_are_the_same(motion: BaseMotion) -> None:
    loads = [respond("fmd+cuboid", motion, elements=1).load for _ in range(2)]
    assert_allclose(loads[0], loads[1], rtol=0, atol=0)


def test_beta_near_a_quarter_turn_is_refused(smooth: MakeMotion, block: Inertia) -> None:
    steep = smooth(2.0 * np.eye(6)[4], OMEGA, 1.0, 64.0)
    with pytest.raises(BadInput, match=r"`displacement`: beta must stay within 1.4 rad, .* found 2 rad"):
        respond_of_plan(rigid(block), steep)


def test_alpha_and_gamma_may_turn_all_the_way_round(
    smooth: MakeMotion, block: Inertia, newton_euler: Callable[..., Array]
) -> None:
    turn = smooth(np.array([0, 0, 0, 4.0, 0.3, 7.0]), OMEGA / 2, 1.0, 2048.0)
    found, exact = respond_of_plan(rigid(block), turn).load, newton_euler(turn, block)
    assert_allclose(found, exact, rtol=0, atol=5e-4 * np.abs(exact).max())


@pytest.mark.parametrize("name", ["displacement", "velocity"])
def test_a_motion_that_does_not_begin_at_rest_is_refused(name: str, motion: BaseMotion, block: Inertia) -> None:
    moving = np.array(getattr(motion, name)) + 0.1
    with pytest.raises(BadInput, match=rf"`{name}`: it must begin at rest in the origin"):
        respond_of_plan(rigid(block), replace(motion, **{name: moving}))


def test_a_single_sample_is_refused(block: Inertia) -> None:
    one = np.zeros((1, 6))
    with pytest.raises(BadInput, match="at least two samples are needed, found one"):
        respond_of_plan(
            rigid(block), BaseMotion(sampling_rate=64.0, displacement=one, velocity=one, acceleration=one, driven=0.0)
        )


@pytest.mark.parametrize(
    ("field", "value", "said"),
    [
        ("gravity", float("nan"), "must be finite"),
        ("loss_frequency", 0.0, "must be positive"),
        ("axes", "body", "must be table or laboratory, found 'body'"),
    ],
)
def test_conditions_that_cannot_be_are_refused(field: str, value: object, said: str) -> None:
    with pytest.raises(BadInput, match=f"`{field}`: .*{said}"):
        Conditions(**{field: value})  # type: ignore[arg-type]


@pytest.mark.parametrize("method", ["fox-goodwin", "newmark"])
def test_a_method_that_stiff_beams_do_not_bear_is_refused(method: str, motion: BaseMotion) -> None:
    with pytest.raises(BadInput, match=f"`method`: .* need generalised-alpha, found {method}"):
        respond("clumod-1", motion, solver=Solver(method=method))  # type: ignore[arg-type]
