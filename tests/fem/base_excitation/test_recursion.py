"""The recursion is exact for straight lines between samples, and wrong by what is known for smooth motion."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.base_excitation import first_order_hold
from geometry.errors import CheckFailed

F, ZETA = 12.3, 0.01
OMEGA = 2 * np.pi * F
RATE = 200.0

Route = Callable[..., np.ndarray]


def oscillator(zeta: float = ZETA, omega: float = OMEGA) -> first_order_hold.States:
    """x'' + 2 zeta omega x' + omega² x = p."""
    one = np.eye(1)
    return first_order_hold.states(one, 2 * zeta * omega * one, omega**2 * one, one)


def displacement(system: first_order_hold.States, samples: np.ndarray, rate: float) -> np.ndarray:
    found = np.empty((len(samples), len(system.displacement)))
    for block in first_order_hold.answer(system, system.displacement, samples, rate):
        found[block.samples] = block.outputs
    return found


@pytest.fixture(params=["poles", "stepping"])
def route(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Route:
    """Both ways to the answer, uncoupled and all together."""
    if request.param == "stepping":
        monkeypatch.setattr(first_order_hold, "poles", lambda system: None)
    return displacement


def ramp_answer(t: np.ndarray, zeta: float = ZETA, omega: float = OMEGA) -> np.ndarray:
    """Closed form for p = t from t = 0 on, at rest before; any textbook on vibration."""
    damped = omega * np.sqrt(1 - zeta**2)
    decay = np.exp(-zeta * omega * t)
    swing = 2 * zeta / omega * np.cos(damped * t) + (2 * zeta**2 - 1) / damped * np.sin(damped * t)
    return np.where(t > 0, (t - 2 * zeta / omega + decay * swing) / omega**2, 0.0)


def test_a_ramp_is_answered_exactly(route: Route) -> None:
    t = np.arange(400) / RATE
    assert_allclose(route(oscillator(), t[:, None], RATE)[:, 0], ramp_answer(t), atol=1e-12 * ramp_answer(t).max())


def test_straight_lines_between_samples_are_answered_exactly(route: Route) -> None:
    rng = np.random.default_rng(1)
    t, p = np.arange(300) / RATE, rng.normal(size=300)
    p[0] = 0.0
    bends = np.diff(np.diff(p), prepend=0.0) * RATE  # at samples 0 ... 298, each the start of a ramp
    exact = sum(bend * ramp_answer(t - start) for bend, start in zip(bends, t[:-1], strict=True))
    # The closed form adds ramps that grow, which costs it some digits.
    assert_allclose(route(oscillator(), p[:, None], RATE)[:, 0], exact, atol=1e-10 * np.abs(exact).max())


def test_input_at_the_first_sample_finds_the_system_at_rest(route: Route) -> None:
    t = np.arange(200) / RATE
    step = route(oscillator(), np.ones((200, 1)), RATE)[:, 0]
    damped = OMEGA * np.sqrt(1 - ZETA**2)
    swing = np.cos(damped * t) + ZETA * OMEGA / damped * np.sin(damped * t)
    assert_allclose(step, (1 - np.exp(-ZETA * OMEGA * t) * swing) / OMEGA**2, atol=1e-12 / OMEGA**2)


def coupled(damping: np.ndarray) -> first_order_hold.States:
    M = np.diag([1.0, 2.0, 0.5])
    K = np.array([[5e3, -2e3, 0], [-2e3, 6e3, -1e3], [0, -1e3, 3e3]])
    return first_order_hold.states(M, damping, K, np.array([[1.0, 0.0], [0.3, -1.0], [0.0, 2.0]]))


DAMPINGS = {
    "beside the diagonal": np.array([[3.0, -2.0, 1.0], [-2.0, 4.0, 0.5], [1.0, 0.5, 2.0]]),
    "overdamped": np.array([[900.0, -20.0, 0.0], [-20.0, 40.0, 0.0], [0.0, 0.0, 2.0]]),
    "none": np.zeros((3, 3)),
}


@pytest.mark.parametrize("damping", DAMPINGS.values(), ids=list(DAMPINGS))
def test_both_ways_agree_whatever_the_damping_couples(damping: np.ndarray, monkeypatch: pytest.MonkeyPatch) -> None:
    samples = np.random.default_rng(2).normal(size=(500, 2))
    fast = displacement(coupled(damping), samples, RATE)
    monkeypatch.setattr(first_order_hold, "poles", lambda system: None)
    assert_allclose(fast, displacement(coupled(damping), samples, RATE), atol=1e-12 * np.abs(fast).max())


def test_a_cluster_of_equal_frequencies_is_answered_like_its_members() -> None:
    K, twins = OMEGA**2 * np.eye(2), np.array([[1.0, 0.0], [0.0, 1.0]])
    rotated = np.array([[0.6, -0.8], [0.8, 0.6]])
    C = rotated @ np.diag([0.02, 0.04]) * OMEGA @ rotated.T  # two equal frequencies that only damping tells apart
    samples = np.random.default_rng(3).normal(size=(400, 2))
    together = displacement(first_order_hold.states(twins, C, K, rotated), samples, RATE)
    alone = np.hstack([displacement(oscillator(z), samples[:, [k]], RATE) for k, z in enumerate((0.01, 0.02))])
    assert_allclose(together, alone @ rotated.T, atol=1e-12 * np.abs(alone).max())


def test_critical_damping_has_no_two_poles_and_is_stepped() -> None:
    critical = oscillator(zeta=1.0)
    assert first_order_hold.poles(critical) is None
    t = np.arange(200) / RATE
    x = OMEGA * t
    exact = (t - 2 / OMEGA + np.exp(-x) * (t + 2 / OMEGA)) / OMEGA**2
    assert_allclose(displacement(critical, t[:, None], RATE)[:, 0], exact, atol=1e-12 * exact.max())


def test_answers_scale_and_add(route: Route) -> None:
    system, rng = coupled(DAMPINGS["beside the diagonal"]), np.random.default_rng(4)
    a, b = rng.normal(size=(2, 300, 2))
    both = route(system, 3 * a - b, RATE)
    assert_allclose(both, 3 * route(system, a, RATE) - route(system, b, RATE), atol=1e-13 * np.abs(both).max())


def test_blocks_join_without_a_seam(monkeypatch: pytest.MonkeyPatch) -> None:
    system, samples = coupled(DAMPINGS["beside the diagonal"]), np.random.default_rng(5).normal(size=(500, 2))
    whole = displacement(system, samples, RATE)
    monkeypatch.setattr(first_order_hold, "BLOCK", 37)
    assert_allclose(displacement(system, samples, RATE), whole, atol=1e-13 * np.abs(whole).max())


@pytest.mark.parametrize("way", ["poles", "stepping"])
def test_the_state_where_a_block_stops_is_that_of_the_sample(way: str, monkeypatch: pytest.MonkeyPatch) -> None:
    system, samples = coupled(DAMPINGS["overdamped"]), np.random.default_rng(6).normal(size=(100, 2))
    if way == "stepping":
        monkeypatch.setattr(first_order_hold, "poles", lambda system: None)
    first, _ = first_order_hold.answer(system, system.velocity, samples, RATE, stop=60)
    assert first.samples == slice(0, 61)
    assert_allclose(system.velocity @ first.state, first.outputs[-1], atol=1e-13)


def test_progress_is_told_and_may_end_the_run() -> None:
    told: list[float] = []
    list(first_order_hold.answer(oscillator(), np.eye(2), np.zeros((100, 1)), RATE, stop=50, progress=told.append))
    assert told == [0.51, 1.0]

    def stop(share: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        list(first_order_hold.answer(oscillator(), np.eye(2), np.zeros((100, 1)), RATE, progress=stop))


def test_what_swings_freely_is_refused() -> None:
    with pytest.raises(CheckFailed, match="swings freely"):
        first_order_hold.states(np.eye(2), np.zeros((2, 2)), np.array([[1.0, -1.0], [-1.0, 1.0]]), np.eye(2))


def steady_gain(frequency: float, rate: float, *, straight: bool = False) -> float:
    """Amplitude of the answer to a sampled sine in its steady state, as a share of the exact one."""
    system = oscillator(zeta=0.2, omega=2 * np.pi * 20.0)
    t = np.arange(int(2.0 * rate)) / rate
    samples = np.sin(2 * np.pi * frequency * t)[:, None]
    x = displacement(system, first_order_hold.straightened(samples) if straight else samples, rate)[:, 0]
    late = t > 1.0  # by then exp(-0.2 * 2 pi 20 * 1) = 1e-11 is left of the beginning
    waves = np.column_stack([np.cos(2 * np.pi * frequency * t[late]), np.sin(2 * np.pi * frequency * t[late])])
    amplitude = np.linalg.norm(np.linalg.lstsq(waves, x[late], rcond=None)[0])
    omega, own = 2 * np.pi * frequency, 2 * np.pi * 20.0
    return float(amplitude * abs(own**2 - omega**2 + 2j * 0.2 * own * omega))


@pytest.mark.parametrize(
    ("rate", "at_12", "at_28"), [(564.0, 1.6e-3, 8.1e-3), (2048.0, 1.2e-4, 6.1e-4), (8192.0, 7.4e-6, 3.8e-5)]
)
def test_the_hold_is_biased_as_the_physics_page_says(rate: float, at_12: float, at_28: float) -> None:
    """0.16 / 0.81 % at 564 Hz, 0.012 / 0.06 % at 2048 Hz, 7e-6 / 4e-5 at 8192 Hz."""
    for frequency, bias in ((12.3, at_12), (28.0, at_28)):
        found = 1 - steady_gain(frequency, rate)
        assert_allclose(found, bias, rtol=0.03)  # two digits are printed
        assert_allclose(found, 1 - np.sinc(frequency / rate) ** 2, rtol=0.02)  # images at the sampling rate add a little


def test_bias_falls_with_the_square_of_the_step_and_straightened_with_the_fourth_power() -> None:
    plain = [1 - steady_gain(28.0, rate) for rate in (512.0, 1024.0)]
    lifted = [1 - steady_gain(28.0, rate, straight=True) for rate in (512.0, 1024.0)]
    assert_allclose(np.log2(plain[0] / plain[1]), 2, atol=0.05)
    assert_allclose(np.log2(lifted[0] / lifted[1]), 4, atol=0.2)
    assert abs(lifted[1]) < plain[1] / 50


def test_straight_input_is_left_as_it_is() -> None:
    line = np.column_stack([np.full(50, 3.0), np.arange(50.0)])
    lifted = first_order_hold.straightened(line)
    assert_allclose(lifted[1:-1], line[1:-1])
    assert_allclose(lifted[-1, 0], 3.0)  # goes on as it is
    assert_allclose(lifted[0, 0], 3.0 + 3.0 / 12)  # before the first sample there is nothing


def test_the_weights_of_a_step_have_no_seam_between_series_and_closed_form() -> None:
    s = first_order_hold.SMALL * np.exp(1j * np.linspace(np.pi / 2, np.pi, 9))
    inside, outside = first_order_hold.held(s * (1 - 1e-9)), first_order_hold.held(s * (1 + 1e-9))
    for a, b in zip(inside, outside, strict=True):
        assert_allclose(a, b, rtol=1e-9)
