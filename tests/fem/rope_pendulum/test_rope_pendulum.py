"""The rope pendulum at rest and swinging: closed forms, rates, and what cannot hang or swing."""

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.exudyn import rope_pendulum
from fem.exudyn.rope_pendulum import Swing, small_period, swing
from fem.exudyn.rope_statics import Suspension, at_rest, feet_of, hung, on_three_ropes, on_two_ropes, ropework
from geometry.errors import BadInput, CheckFailed
from geometry.inertia import Inertia

G = 9.81
# the article of physics.md: three ropes of 2 m at s = 0.3 m
MASS, MOMENT, S, LENGTH = 47.23, 2.289, 0.3, 2.0
BODY = Inertia.from_cog(MASS, np.zeros(3), np.diag([5.0, 6.0, MOMENT]))
WEIGHT = MASS * G


def eq_5(product: float = S**2) -> float:
    return float(2 * np.pi * np.sqrt(MOMENT * LENGTH / (WEIGHT * product)))


def three(**more: Any) -> Suspension:
    return on_three_ropes(S, **({"length": LENGTH, "amplitude": 1e-3} | more))


def two(s1: float, s2: float, **more: Any) -> Suspension:
    return on_two_ropes(s1, s2, **({"length": LENGTH, "amplitude": 1e-3} | more))


def test_small_swings_have_the_period_of_eq_5_on_two_ropes_and_on_three() -> None:
    assert_allclose(small_period(BODY, three(), G), eq_5(), rtol=1e-10)
    assert_allclose(small_period(BODY, two(0.3, 0.9), G), eq_5(0.27), rtol=1e-10)
    assert_allclose(small_period(BODY, two(0.3, 0.9, height=0.4), G), eq_5(0.27), rtol=1e-10)


@pytest.mark.parametrize("twist", [0.1, 1.0, 2.5])
def test_a_held_twist_lifts_the_body_as_its_ropes_command(twist: float) -> None:
    pose = at_rest(ropework(BODY, three(), G), twist)
    assert_allclose(pose.place, [0, 0, LENGTH - np.sqrt(LENGTH**2 - 4 * S**2 * np.sin(twist / 2) ** 2)], atol=1e-12)
    assert_allclose(pose.rotation[0, 0], np.cos(twist), rtol=1e-12)


def test_two_ropes_share_the_weight_by_the_lever() -> None:
    pose = at_rest(ropework(BODY, two(0.3, 0.9), G))
    assert_allclose(pose.tension[:, 0], [WEIGHT * 0.75, WEIGHT * 0.25], rtol=1e-12)


def test_a_body_off_centre_on_two_ropes_turns_until_its_cog_is_below_them() -> None:
    pose = at_rest(ropework(BODY, two(0.3, 0.3, height=0.1, off_centre=(0.0, 0.02)), G))
    assert_allclose(abs(np.arctan2(pose.rotation[2, 1], pose.rotation[2, 2])), np.arctan2(0.02, 0.1), rtol=1e-9)


def test_elastic_ropes_are_as_long_as_their_load_makes_them() -> None:
    EA = 1e5
    strain = WEIGHT / 3 / EA
    assert_allclose(at_rest(ropework(BODY, three(stiffness=EA), G)).place[2], -LENGTH * strain, rtol=1e-9)
    # the one thing that changes is the length: Eq. 5 with l (1 + strain)
    assert_allclose(small_period(BODY, three(stiffness=EA), G) / eq_5(), np.sqrt(1 + strain), rtol=1e-9)


@pytest.mark.parametrize("direction", [0.0, 0.7, np.pi / 2])
def test_a_cog_off_centre_by_e_takes_e_squared_off_s_squared(direction: float) -> None:
    e = 0.01
    off = three(off_centre=(e * np.cos(direction), e * np.sin(direction)))
    assert_allclose(small_period(BODY, off, G) / eq_5(), 1 / np.sqrt(1 - e**2 / S**2), rtol=1e-10)


def chain_period(rope_mass: float, links: int) -> float:
    """Small period on ropes of point masses between massless links, sideways places of the joints written down by hand."""
    step, point = LENGTH / links, rope_mass / links
    tension = G * (MASS + rope_mass - point * (np.arange(links) + 0.5))
    K, M = np.zeros((links, links)), np.full(links, point)
    for i, force in enumerate(tension):
        K[i, i] += force / step
        if i:
            K[i - 1, i - 1] += force / step
            K[i, i - 1] = K[i - 1, i] = -force / step
    M[-1] = point / 2 + MOMENT / S**2
    return float(2 * np.pi / np.sqrt(np.linalg.eigvalsh(K / np.sqrt(np.outer(M, M)))[0]))


@pytest.mark.parametrize("links", [1, 2, 8])
def test_ropes_with_mass_are_chains(links: int) -> None:
    assert_allclose(small_period(BODY, three(rope_mass=0.3, links=links), G), chain_period(0.3, links), rtol=1e-9)


def test_lumped_ropes_go_to_uniform_ones_with_the_square_of_the_links() -> None:
    links = np.array([2, 4, 8, 16])
    shift = 100 * np.array([small_period(BODY, three(rope_mass=0.3, links=n), G) / eq_5() - 1 for n in links])
    uniform = (16**2 * shift[-1] - 8**2 * shift[-2]) / (16**2 - 8**2)
    # physics.md says 0.06 %: that is a rope in two links; Eq. 5 with M s²/3 and M/2, a uniform rope, says 0.038 %
    assert_allclose(shift[0], 0.0622, atol=1e-4)
    assert_allclose(uniform, 50 * (0.3 * S**2 / 3 / MOMENT - 0.3 / 2 / MASS), rtol=0.02)  # to first order in the ropes' mass
    rate = np.polyfit(np.log(links), np.log(shift - uniform), 1)[0]
    assert_allclose(rate, -2, atol=0.02)


def test_feet_hang_where_the_ropes_end() -> None:
    suspension = three(rope_mass=0.6, links=5, off_centre=(0.02, -0.01), extra=np.array([0.004, 0.0, -0.002]))
    work = ropework(BODY, suspension, G)
    pose = at_rest(work)
    lowest = np.linalg.norm(feet_of(work, pose) - pose.joints[:, -1], axis=1)
    assert_allclose(lowest, suspension.lengths / 5, rtol=1e-11)
    # vertical balance at the ceiling: the weight of everything but the half links that the ceiling bears itself
    down = (work.anchors - pose.joints[:, 0])[:, 2] / np.linalg.norm(work.anchors - pose.joints[:, 0], axis=1)
    assert_allclose(pose.tension[:, 0] @ down, G * (MASS + 0.6 * (1 - 0.5 / 5)), rtol=1e-11)


@pytest.mark.parametrize(("axis", "moment"), [("x", 5.0), ("y", 6.0), ("z", MOMENT)])
def test_the_axis_asked_for_is_upright(axis: str, moment: float) -> None:
    article = Inertia.from_cog(MASS, [0.1, -0.2, 0.6], np.diag([5.0, 6.0, MOMENT]))
    body = hung(article, axis)
    assert_allclose(body.tensor_cog[2, 2], moment, rtol=1e-12)
    assert_allclose(body.cog, 0, atol=1e-12)


def test_what_lies_along_the_ropes_can_be_chosen() -> None:
    assert_allclose(hung(BODY, "x").tensor[0, 0], MOMENT, rtol=1e-12)  # z, where it lies
    assert_allclose(hung(BODY, "x", "y").tensor[0, 0], 6.0, rtol=1e-12)
    with pytest.raises(BadInput, match="upright"):
        hung(BODY, "x", "x")
    with pytest.raises(BadInput, match="x, y or z"):
        hung(BODY, "w")


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: two(-0.3, 0.3), "s1.*positive"),
        (lambda: on_three_ropes(0.0, length=2.0, amplitude=0.1), "radius.*positive"),
        (lambda: three(length=-2.0), "length.*positive"),
        (lambda: three(extra=np.array([-3.0, 0.0, 0.0])), "extra.*3 m unequal"),
        (lambda: three(extra=np.array([0.6, 0.0, 0.0])), "extra.*0.52 m apart"),
        (lambda: three(extra=np.full(3, -2.0)), "extra"),
        (lambda: three(length=1001.0), "length.*longer than 1000 m"),
        (lambda: three(links=21, rope_mass=0.3), "links.*at most 20"),
        (lambda: three(amplitude=0.0), "amplitude.*positive"),
        (lambda: three(stiffness=0.0), "stiffness.*positive"),
        (lambda: three(rope_mass=-1.0), "rope_mass.*negative"),
        (lambda: three(links=4), "links.*cannot have 4"),
        (lambda: three(damping_ratio=1.0), "damping_ratio"),
        (lambda: three(start="jump"), "start"),
        (lambda: Suspension(feet=np.zeros((4, 3)), length=1.0, amplitude=0.1), "two or three"),
    ],
)
def test_suspensions_that_cannot_be_are_refused(make: Any, words: str) -> None:
    with pytest.raises(BadInput, match=words):
        make()


@pytest.mark.parametrize(
    ("suspension", "words"),
    [
        (three(off_centre=(-0.2, 0.0)), "would have to push"),
        (two(0.3, 0.3, off_centre=(0.4, 0.0)), "would have to push"),
        (two(0.3, 0.3, height=-0.1), "tips over"),
        (three(height=-3.0, stiffness=2e3), "tip over"),
        (Suspension(feet=np.array([[-0.3, 0, 0.1], [0.1, 0, 0.1], [0.3, 0, 0.1]]), length=2.0, amplitude=0.1), "one line"),
    ],
)
def test_what_would_not_hang_is_refused(suspension: Suspension, words: str) -> None:
    with pytest.raises(BadInput, match=words):
        small_period(BODY, suspension, G)


@pytest.mark.parametrize("mass", [0.0, -1.0])
def test_a_body_without_mass_is_refused(mass: float) -> None:
    with pytest.raises(BadInput, match=r"mass.*positive"):
        small_period(Inertia.from_cog(mass, [0, 0, 0], np.eye(3)), three(), G)


def test_a_twist_at_which_the_ropes_lie_flat_has_no_equilibrium() -> None:
    with pytest.raises((CheckFailed, BadInput)):
        at_rest(ropework(BODY, three(length=0.4), G), 2.5)


SKEW = Inertia.from_cog(MASS, np.zeros(3), [[5.0, 0.1, 0.2], [0.1, 6.0, -0.1], [0.2, -0.1, MOMENT]])
PERIOD = eq_5()


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
        (two(0.3, 0.9, rope_mass=0.5, links=3), BODY),
    ],
    ids=["chain", "elastic, off centre", "elastic chain", "unequal, askew", "two ropes"],
)
def test_exudyn_and_statics_agree_on_the_small_period(suspension: Suspension, body: Inertia) -> None:
    found = run(suspension, body=body)
    assert_allclose(period(found), found.small_period, rtol=1e-5)


def test_let_go_or_pushed_the_body_swings_equally_far_and_fast() -> None:
    let_go, pushed = (run(three(amplitude=0.3, start=start)) for start in ("twist", "push"))
    assert_allclose(let_go.yaw[0], 0.3, rtol=1e-12)
    assert_allclose(pushed.yaw[0], 0, atol=1e-12)
    # the energy of the push is that of the held twist, and the method keeps it to its own 3e-6 and better
    assert_allclose(np.abs(pushed.yaw).max(), 0.3, rtol=1e-5)
    assert_allclose(period(pushed), period(let_go), rtol=1e-6)


def test_a_tilted_body_is_pushed_about_the_vertical_not_about_an_axis_of_its_own() -> None:
    tilted = two(0.3, 0.3, off_centre=(0.0, 0.06), start="push")
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
    found = run(three(amplitude=0.5, height=0.5, rope_mass=3.0, links=1), cycles=0.5)
    assert_allclose(found.place[:, :2], 0, atol=1e-9)
    assert_allclose(found.chains[0, :, -1, 2] - found.place[0, 2], 0.5, rtol=1e-9)


@pytest.mark.parametrize(("name", "value"), [("duration", -1.0), ("step", 0.0), ("rate", -5.0), ("gravity", 0.0)])
def test_sizes_of_a_run_must_be_positive(name: str, value: float) -> None:
    with pytest.raises(BadInput, match="must be positive"):
        swing(BODY, three(), **({"duration": 1.0, "gravity": G} | {name: value}))
