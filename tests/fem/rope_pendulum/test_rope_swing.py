"""Exudyn swings the body: rate of convergence, period against statics, starts, damping, and how a run ends badly."""

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.exudyn import rope_pendulum
from fem.exudyn.rope_pendulum import Swing, small_period, swing
from fem.exudyn.rope_statics import Suspension, on_three_ropes, on_two_ropes
from geometry.errors import BadInput, CheckFailed
from geometry.inertia import Inertia

G = 9.81
MASS, MOMENT, S, LENGTH = 47.23, 2.289, 0.3, 2.0
BODY = Inertia.from_cog(MASS, np.zeros(3), np.diag([5.0, 6.0, MOMENT]))
SKEW = Inertia.from_cog(MASS, np.zeros(3), [[5.0, 0.1, 0.2], [0.1, 6.0, -0.1], [0.2, -0.1, MOMENT]])
PERIOD = float(2 * np.pi * np.sqrt(MOMENT * LENGTH / (MASS * G * S**2)))


def three(**more: Any) -> Suspension:
    return on_three_ropes(S, **({"length": LENGTH, "amplitude": 1e-3} | more))


def run(suspension: Suspension, cycles: float = 3.1, body: Inertia = BODY, **more: Any) -> Swing:
    return swing(body, suspension, duration=cycles * PERIOD, gravity=G, **more)


def period(found: Swing) -> float:
    """From the first to the last passage downwards, each by a straight line between two samples."""
    y = found.yaw
    k = np.flatnonzero((y[:-1] > 0) & (y[1:] <= 0))
    t = found.time[k] + np.diff(found.time)[k] * y[k] / (y[k] - y[k + 1])
    return float((t[-1] - t[0]) / (len(t) - 1))


def test_the_period_converges_with_the_square_of_the_step_and_is_right_to_1e_5_at_the_default() -> None:
    steps = np.array([200, 400, 800])
    errors = np.array([period(run(three(), step=PERIOD / n)) / PERIOD - 1 for n in steps])
    assert_allclose(np.polyfit(np.log(steps), np.log(errors), 1)[0], -2, atol=0.02)
    assert_allclose(errors, (2 * np.pi / steps) ** 2 / 12, rtol=0.04)  # as the module's head says; radius 0.9 adds 1 %
    assert abs(period(run(three())) / PERIOD - 1) < 5e-6


@pytest.mark.parametrize(
    ("suspension", "body"),
    [
        (three(rope_mass=0.3, links=4), BODY),
        (three(stiffness=1e5, off_centre=(0.02, 0.01)), BODY),
        (three(stiffness=1e6, rope_mass=0.3, links=4, stretch_damping=0.02), BODY),
        (three(extra=np.array([0.005, 0.0, 0.0])), SKEW),
        (on_two_ropes(0.3, 0.9, length=LENGTH, amplitude=1e-3, rope_mass=0.5, links=3), BODY),
    ],
    ids=["chain", "elastic, off centre", "elastic chain", "unequal, askew", "two ropes"],
)
def test_exudyn_and_statics_agree_on_the_small_period(suspension: Suspension, body: Inertia) -> None:
    found = run(suspension, body=body)
    assert_allclose(period(found), found.small_period, rtol=1e-5)


def test_the_body_stays_where_statics_hangs_it() -> None:
    suspension = three(
        amplitude=1e-9, stiffness=1e5, rope_mass=0.5, links=3, off_centre=(0.03, 0.02), extra=np.array([0.003, 0, 0])
    )
    found = run(suspension, cycles=1.0, body=SKEW)
    # exudyn's own equations find nothing to move: what moves is Newton's tolerance
    assert np.abs(found.place - found.place[0]).max() < 1e-8
    assert np.abs(found.chains - found.chains[0]).max() < 1e-8
    assert np.abs(found.yaw - found.yaw[0]).max() < 1e-7


def test_let_go_or_pushed_the_body_swings_equally_far_and_fast() -> None:
    let_go, pushed = (run(three(amplitude=0.3, start=start)) for start in ("twist", "push"))
    assert_allclose(let_go.yaw[0], 0.3, rtol=1e-12)
    assert_allclose(pushed.yaw[0], 0, atol=1e-12)
    # the energy of the push is that of the held twist, and the method keeps it to its own 3e-6 and better
    assert_allclose(np.abs(pushed.yaw).max(), 0.3, rtol=1e-5)
    assert_allclose(period(pushed), period(let_go), rtol=1e-6)


def test_a_tilted_body_is_pushed_about_the_vertical_not_about_an_axis_of_its_own() -> None:
    tilted = on_two_ropes(0.3, 0.3, length=LENGTH, amplitude=1e-3, off_centre=(0.0, 0.06), start="push")
    found = run(tilted, body=SKEW)
    assert abs(found.rotation[0, 2, 1]) > 0.5  # sine of the tilt
    # one small mode and nothing else: after one period of the statics all is back where it was
    k = round(found.small_period / found.time[1])
    far = np.abs(found.rotation - found.rotation[0]).max()
    assert far > 5e-4
    assert np.abs(found.rotation[k] - found.rotation[0]).max() < 0.01 * far
    assert np.abs(found.place[k] - found.place[0]).max() < 0.01 * far


def test_ropes_keep_their_length_and_carry_the_weight() -> None:
    found = run(three(amplitude=1.0))
    assert_allclose(np.linalg.norm(np.diff(found.chains, axis=2), axis=3), LENGTH, rtol=1e-9)
    # the mean upward force over whole cycles is the weight: momentum comes back
    vertical = found.tension[..., None] * (found.chains[:, :, 0] - found.chains[:, :, -1]) / LENGTH
    cycle = round(2 * period(found) / (found.time[1] - found.time[0]))
    assert_allclose(vertical[:cycle, :, 2].sum(axis=1).mean(), MASS * G, rtol=1e-3)  # one sample more or less of 2000


@pytest.mark.parametrize("zeta", [0.01, 0.05])
def test_peaks_fall_by_the_logarithmic_decrement_that_was_asked_for(zeta: float) -> None:
    found = run(three(amplitude=0.01, damping_ratio=zeta), cycles=3.1)
    peaks = [found.yaw[k] for k in range(1, len(found.yaw) - 1) if found.yaw[k - 1] < found.yaw[k] >= found.yaw[k + 1]]
    assert_allclose(np.log(peaks[0] / peaks[2]) / 2, 2 * np.pi * zeta / np.sqrt(1 - zeta**2), rtol=1e-4)
    assert_allclose(period(found) / PERIOD, 1 / np.sqrt(1 - zeta**2), rtol=1e-5)


def test_the_recorder_hears_every_sample_it_asks_for() -> None:
    found = run(three(), rate=20.0, cycles=2.0)
    assert_allclose(found.time, np.arange(len(found.time)) / 20.0, atol=1e-9)
    assert found.time[-1] >= 2.0 * PERIOD - 1e-9
    assert float(found.settings["step_s"]) <= PERIOD / 1000  # type: ignore[arg-type]
    assert {"version", "step_s", "spectral_radius", "start"} <= set(found.settings)


def test_a_step_that_no_rope_sway_survives_is_refused_with_the_one_that_is_needed() -> None:
    heavy = three(rope_mass=0.3, links=8)
    with pytest.raises(BadInput, match=r"too coarse.*fastest sway.*Use 0\.0034") as caught:
        run(heavy, step=PERIOD / 200)
    assert caught.value.field == "step"
    with pytest.raises(BadInput, match="too coarse for a twist"):
        run(three(), step=PERIOD / 150)


def test_where_the_refusal_is_overruled_exudyn_fails_and_says_when_and_where(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rope_pendulum, "RESOLVED", 100.0)
    with pytest.raises(CheckFailed, match=r"exudyn [\d.]+ failed.* s, step \d+ of \d+") as caught:
        run(three(rope_mass=0.3, links=8), step=PERIOD / 200)
    assert caught.value.evidence["time"] < 3.1 * PERIOD  # type: ignore[operator]
    assert np.size(caught.value.evidence["state"]) == 7 + 3 * 3 * 7


def test_more_than_can_be_done_is_refused_and_said_of_what_asked_for_it() -> None:
    light = three(rope_mass=1e-9, links=8)
    for name, suspension, more in (
        ("step", three(), {"step": 1e-9}),
        ("rate", three(), {"rate": 1e9}),
        ("links", light, {}),
        ("duration", three(), {"duration": 1e5}),
    ):
        with pytest.raises(BadInput, match="times as many as are simulated") as caught:
            swing(BODY, suspension, **({"duration": 10.0, "gravity": G} | more))
        assert caught.value.field == name


def test_ctrl_c_and_whatever_else_progress_raises_ends_the_run_as_itself() -> None:
    told: list[float] = []

    def progress(share: float) -> None:
        told.append(share)
        if share > 0.4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(three(), progress=progress)
    assert told == sorted(told)
    assert 0.4 < told[-1] < 0.45


def test_ropes_that_slack_on_the_way_are_no_result() -> None:
    rubber = three(amplitude=2.0, length=1.0, stiffness=2000.0)
    with pytest.raises(CheckFailed, match=r"rope \d slacks at .* s of the swing"):
        run(rubber)


def test_the_place_told_is_that_of_the_article_not_of_its_ropes() -> None:
    found = run(on_three_ropes(S, length=LENGTH, amplitude=0.5, height=0.5, rope_mass=3.0, links=1), cycles=0.5)
    assert_allclose(found.place[:, :2], 0, atol=1e-9)
    assert_allclose(found.chains[0, :, -1, 2] - found.place[0, 2], 0.5, rtol=1e-9)


@pytest.mark.parametrize(("name", "value"), [("duration", -1.0), ("step", 0.0), ("rate", -5.0), ("gravity", 0.0)])
def test_sizes_of_a_run_must_be_positive(name: str, value: float) -> None:
    with pytest.raises(BadInput, match="must be positive"):
        swing(BODY, three(), **({"duration": 1.0, "gravity": G} | {name: value}))


def test_small_period_needs_no_exudyn() -> None:
    assert_allclose(small_period(BODY, three(), G), PERIOD, rtol=1e-10)
