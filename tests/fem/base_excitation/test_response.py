"""The exact recursion, block by block; how long a record must be, and how it is brought down to its rate."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fem.base_excitation import first_order_hold, response, rig
from fem.base_excitation import response as base_excitation_response
from fem.base_excitation.first_order_hold import Channels, accelerations, cell_forces, stacked
from fem.base_excitation.patterns import BaseMotion, Random, Sweep, drawn
from fem.base_excitation.response import (
    PASS,
    RIPPLE,
    Response,
    decimated,
    decimated_channels,
    joined,
    pass_band,
    require_recorded,
    simulation_rate,
    taps,
)
from fem.base_excitation.rig import FlexibleBody, Friction, LoadCell, Rig, RigStructure, Strut, rigid
from geometry.dynamic_mass import LEVELS, MOTIONS
from geometry.errors import BadInput, CheckFailed
from geometry.inertia import Inertia

F, ZETA = 12.3, 0.01
OMEGA = 2 * np.pi * F
RATE = 200.0

Route = Callable[..., np.ndarray]
Mounted = Callable[..., Rig]
Clumod = Callable[[str], FlexibleBody]


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


def test_the_weights_of_a_step_have_no_seam_between_series_and_closed_form() -> None:
    s = first_order_hold.SMALL * np.exp(1j * np.linspace(np.pi / 2, np.pi, 9))
    inside, outside = first_order_hold.held(s * (1 - 1e-9)), first_order_hold.held(s * (1 + 1e-9))
    for a, b in zip(inside, outside, strict=True):
        assert_allclose(a, b, rtol=1e-9)


Burst = Callable[..., BaseMotion]


def cut(motion: BaseMotion, seconds: float) -> BaseMotion:
    """The record of `motion` until `seconds`."""
    n = int(np.ceil(seconds * motion.sampling_rate)) + 1
    return replace(
        motion, displacement=motion.displacement[:n], velocity=motion.velocity[:n], acceleration=motion.acceleration[:n]
    )


def oscillator_of_ring_down(ratio: float) -> Rig:
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
    rig, motion = oscillator_of_ring_down(0.01), burst(2048.0, np.eye(6)[axis], 20.0)
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
    assert "before the drive has" in response.warning(oscillator_of_ring_down(0.01), short)


def test_what_has_no_damping_never_stops_ringing(burst: Burst) -> None:
    motion = burst(2048.0, np.eye(6)[2], 2.0)
    assert response.needed(oscillator_of_ring_down(0.0), motion) == np.inf
    assert "no damping" in response.warning(oscillator_of_ring_down(0.0), motion)


def test_a_rigid_article_and_a_table_at_rest_need_no_ring_down(rigid_block: FlexibleBody, burst: Burst) -> None:
    motion, still = (burst(2048.0, axes, 0.0) for axes in (np.ones(6), np.zeros(6)))
    assert response.needed(Rig(article=rigid_block), motion) == motion.driven
    assert response.warning(Rig(article=rigid_block), motion) == ""
    assert response.needed(oscillator_of_ring_down(0.01), still) == still.driven


def test_a_nonlinear_rig_rings_as_it_does_while_nothing_slips_or_lifts(burst: Burst) -> None:
    rig, motion = oscillator_of_ring_down(0.01), burst(2048.0, np.eye(6)[2], 1.0)
    cells = tuple(replace(cell, preload=1e4) for cell in rig.cells)
    loose = replace(rig, cells=cells, frictions=(Friction(axis="x", slip_force=10.0),))
    assert response.needed(loose, motion) == response.needed(rig, motion)


def test_modes_that_cannot_be_told_apart_are_given_the_slowest_decay(burst: Burst, monkeypatch: pytest.MonkeyPatch) -> None:
    rig, motion = oscillator_of_ring_down(0.01), burst(2048.0, np.eye(6)[2], 1.0)
    apart = response.needed(rig, motion)
    for module in (first_order_hold, response):
        monkeypatch.setattr(module, "poles", lambda system: None)
    assert apart <= response.needed(rig, motion) < apart + 2.0  # a bound: a factor of 5 is 1.7 s


STREAMED_RATE = 8192.0
SWEEP = Sweep(axis="beta", rate=120.0, delay=0.1)


def wanted(structure: RigStructure) -> Channels:
    return stacked([accelerations(structure.cover, "cover"), cell_forces(structure)])


def collected(rig: Rig, **options: object) -> tuple[np.ndarray, np.ndarray]:
    """Acceleration of the table (n, 6) and values (n, o) of the whole run."""
    pieces = list(
        base_excitation_response.streamed(rig, SWEEP, STREAMED_RATE, wanted, cross=drawn(np.random.default_rng(0)), **options)
    )
    return np.hstack([piece.acceleration for piece in pieces]).T, np.hstack([piece.values for piece in pieces]).T


@pytest.mark.parametrize("grounded", [False, True])
def test_a_streamed_run_is_the_whole_run(grounded: bool, mounted: Mounted, clumod: Clumod) -> None:
    rig = mounted(clumod("clumod-1"))
    if grounded:
        rig = Rig(article=rig.article, cover=rig.cover, seat=rig.seat, cells=rig.cells, struts=(cable(),))
    acceleration, values = collected(rig, quiet=0.2)
    whole = SWEEP.motion(STREAMED_RATE, ring_down=len(values) / STREAMED_RATE - 1.0, cross=drawn(np.random.default_rng(0)))
    n = min(len(values), len(whole.time))
    assert_allclose(acceleration[:n], whole.acceleration[:n], rtol=0, atol=1e-10 * np.abs(whole.acceleration).max())
    response = base_excitation_response.respond(rig, whole)
    for found, expected in ((values[:, :6], response.cover), (values[:, 6:], response.cells.reshape(len(response.cells), -1))):
        assert_allclose(found[:n], expected[:n], rtol=0, atol=1e-10 * np.abs(expected).max())


def tilted(structure: RigStructure) -> Channels:
    """What depends on accelerations, velocities and displacements, those of the table among them."""
    read = wanted(structure)
    displacement = read.displacement.copy()
    displacement[:, 3:5] += 9.81
    return replace(read, displacement=displacement)


@pytest.mark.parametrize("grounded", [False, True])
@pytest.mark.parametrize(("rate", "furthest"), [(8192.0, 3.3), (512.0, 0.4), (512.0, 40.3), (128.0, 7.0)])
def test_a_record_is_what_is_streamed_filtered_and_brought_down(
    grounded: bool, rate: float, furthest: float, mounted: Mounted, clumod: Clumod
) -> None:
    rig = mounted(clumod("clumod-1"))
    if grounded:
        rig = Rig(article=rig.article, cover=rig.cover, seat=rig.seat, cells=rig.cells, struts=(cable(),))
    how = {"cross": drawn(np.random.default_rng(0)), "quiet": 0.013, "share": 1e-2}  # rings audibly where the record ends
    pieces = list(base_excitation_response.streamed(rig, SWEEP, STREAMED_RATE, tilted, **how))
    late = np.linspace(-furthest, furthest, len(pieces[0].values))
    late[3] = 0.0
    expected = joined((piece.values for piece in pieces), round(STREAMED_RATE / rate), late)
    found = base_excitation_response.recorded(rig, SWEEP, STREAMED_RATE, tilted, rate, late, **how)
    assert found.shape == expected.shape
    assert_allclose(found / np.abs(expected).max(axis=0), expected / np.abs(expected).max(axis=0), rtol=0, atol=1e-12)
    assert np.abs(expected[-1]).max() > 1e-6 * np.abs(expected).max()


@pytest.mark.parametrize(("axes", "few"), [("x", 2), ("xyz", 6), (MOTIONS, 6)])
def test_a_record_filters_what_drives_and_not_every_axis_that_follows(
    axes: Sequence[str], few: int, mounted: Mounted, clumod: Clumod, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One axis and its delay by cross motion, however many axes of the table they move; never more than the table has."""
    rig, filtered = mounted(clumod("clumod-1")), []
    pattern = Random(rms={axis: LEVELS[axis] for axis in axes}, duration=3.0)
    how, late = {"cross": drawn(np.random.default_rng(0)), "share": 1e-2}, np.zeros(18)
    pieces = list(base_excitation_response.streamed(rig, pattern, STREAMED_RATE, wanted, **how))
    stepped = first_order_hold.stepped
    monkeypatch.setattr(response, "stepped", lambda *asked: filtered.append(asked[2]) or stepped(*asked))
    found = base_excitation_response.recorded(rig, pattern, STREAMED_RATE, wanted, 512.0, late, **how)
    expected = joined((piece.values for piece in pieces), round(STREAMED_RATE / 512.0), late)
    assert_allclose(found / np.abs(expected).max(axis=0), expected / np.abs(expected).max(axis=0), rtol=0, atol=1e-12)
    assert filtered == [few]


def test_a_record_of_modes_that_cannot_be_told_apart_is_streamed(
    mounted: Mounted, clumod: Clumod, monkeypatch: pytest.MonkeyPatch
) -> None:
    rig, late = mounted(clumod("clumod-1")), np.zeros(18)
    apart = base_excitation_response.recorded(rig, SWEEP, STREAMED_RATE, wanted, 512.0, late, share=0.1)
    for module in (first_order_hold, response):
        monkeypatch.setattr(module, "poles", lambda system: None)
    found = base_excitation_response.recorded(rig, SWEEP, STREAMED_RATE, wanted, 512.0, late, share=0.1)
    n = min(len(found), len(apart)) - 50  # the slowest decay is taken for all modes, so that it rings on
    assert_allclose(found[:n], apart[:n], rtol=0, atol=1e-9 * np.abs(apart).max())


def cable() -> Strut:
    return Strut(place="top", stiffness=np.full(3, 1e3), damping=np.full(3, 5.0))


def test_the_record_ends_when_the_ringing_has_fallen_to_its_share(mounted: Mounted, clumod: Clumod) -> None:
    """A hundredth of the share takes ln(100) / (zeta omega) more of the slowest mode that rings; what is left is below it."""
    rig = mounted(clumod("clumod-1"))
    lengths = []
    for share in (1e-3, 1e-5):
        _, values = collected(rig, share=share)
        lengths.append(len(values) / STREAMED_RATE)
        assert np.abs(values[-200:, 6:]).max() < 3 * share * np.abs(values[:, 6:]).max()
    slowest = 0.03 * 2 * np.pi * rig.article.kept[0]
    assert 0.5 < (lengths[1] - lengths[0]) * slowest / np.log(100) < 1.3


def test_what_never_stops_ringing_is_refused() -> None:
    inertia = Inertia.from_cog(20.0, [0, 0, 0.2], np.eye(3))
    cells = tuple(LoadCell(position=np.array([x, y, 0.0]), stiffness=np.full(3, 1e5)) for x in (0.1, -0.1) for y in (0.1, -0.1))
    undamped = Rig(article=rigid("block", inertia), cover=inertia, cells=cells)
    with pytest.raises(CheckFailed, match="Give it damping"):
        collected(undamped)


def test_a_rate_too_coarse_for_the_sweep_or_for_a_mode_is_refused(mounted: Mounted, clumod: Clumod) -> None:
    rig = mounted(clumod("clumod-1"))
    for rate, said in ((60.0, "twice the highest frequency driven"), (600.0, "highest kept mode")):
        with pytest.raises(BadInput, match=said):
            next(base_excitation_response.streamed(rig, SWEEP, rate, wanted))


@pytest.mark.parametrize("delay", [0.0, 20e-6, -33e-6, 1.3e-3, 0.05])
def test_a_delay_is_that_of_the_closed_form(delay: float) -> None:
    time = np.arange(4 * 8460) / 8460

    def signal(t: np.ndarray) -> np.ndarray:
        return np.exp(-(((t - 2) / 0.3) ** 2)) * np.cos(2 * np.pi * 30 * t)

    found = decimated_channels(signal(time)[:, None], 8460.0, 564.0, delay)[:, 0]
    assert_allclose(found, signal(np.arange(len(found)) / 564 - delay), rtol=0, atol=2e-7)  # ripple of the filter: 1e-6 at most


def test_delays_change_nothing_but_the_phase_between_channels() -> None:
    """The filter is the same, so its ripple cancels in a ratio: what is left of a delay is exp(-i w tau), to rounding."""
    rng, delays = np.random.default_rng(1), np.array([0.0, 17e-6, -2.4e-4, 3.1e-3])
    time = np.arange(6 * 8460) / 8460
    shape = np.exp(-(((time - 3) / 0.4) ** 2)) * sum(np.cos(2 * np.pi * f * time + rng.uniform(0, 6)) for f in (7, 19, 31))
    found = decimated_channels(np.tile(shape[:, None], (1, 4)), 8460.0, 564.0, delays)
    lines = np.array([7.0, 19.0, 31.0])
    spectra = np.exp(-2j * np.pi * np.outer(lines, np.arange(len(found)) / 564)) @ found
    assert_allclose(spectra / spectra[:, :1], np.exp(-2j * np.pi * np.outer(lines, delays)), rtol=0, atol=1e-10)


def test_how_a_record_is_cut_into_blocks_leaves_no_trace() -> None:
    rng, late = np.random.default_rng(2), np.array([0.0, 0.3, -7.9])
    whole = rng.standard_normal((3, 5000))
    expected = joined([whole], 15, late)
    for cuts in ([1, 2, 3], [700, 701, 4999], list(range(1, 5000, 97))):
        assert_allclose(joined(np.split(whole, cuts, axis=1), 15, late), expected, rtol=0, atol=1e-12)


FINE, COARSE = 8192.0, 512.0


def response_of_decimation(signal: np.ndarray, rate: float = FINE) -> Response:
    """All channels are multiples of `signal` (n,)."""
    column = signal[:, None]
    six = column * np.arange(1.0, 7.0)
    return Response(
        sampling_rate=rate,
        table=six,
        cover=2 * six,
        load=3 * six,
        cells=4 * column[:, :, None] * np.ones((4, 3)),
        places={"mast-top": 5 * column * np.ones(3)},
        coordinates=6 * column * np.ones(8),
        settings={"route": "made up"},
    )


def tone(frequency: float, seconds: float = 4.0, rate: float = FINE) -> np.ndarray:
    """A sine that swells and fades, at rest at both ends; its spectrum lies within 3 Hz of `frequency`."""
    time = np.arange(round(seconds * rate)) / rate
    return np.sin(np.pi * time / seconds) ** 8 * np.sin(2 * np.pi * frequency * time)


@pytest.mark.parametrize("factor", [2, 3, 5, 16, 40])
def test_the_filter_keeps_what_it_states_in_pass_band_and_stop_band(factor: int) -> None:
    from scipy.signal import freqz

    w, H = freqz(taps(factor), worN=np.linspace(0, np.pi, 4001))
    of_nyquist = w / np.pi * factor
    assert np.abs(np.abs(H[of_nyquist <= PASS]) - 1).max() < RIPPLE
    assert np.abs(H[of_nyquist >= 1]).max() < RIPPLE
    assert_allclose(taps(factor), taps(factor)[::-1], rtol=0, atol=1e-18)


@pytest.mark.parametrize("frequency", [3.0, 32.0, 100.0, 0.8 * 256 - 3])
def test_a_tone_in_the_pass_band_comes_out_as_it_went_in_without_delay(frequency: float) -> None:
    signal = tone(frequency)
    found = decimated(response_of_decimation(signal), COARSE)
    assert found.sampling_rate == COARSE
    assert_allclose(found.table[:, 0], signal[::16], rtol=0, atol=2 * RIPPLE)


@pytest.mark.parametrize("frequency", [260.0, 300.0, 515.0, 700.0, 1033.0, 4000.0])
def test_a_tone_above_the_nyquist_frequency_does_not_fold_back(frequency: float) -> None:
    """Without the filter 512 - 300 Hz would appear in full; what is left is the stated ripple."""
    assert np.abs(tone(frequency)[::16]).max() > 0.5
    found = decimated(response_of_decimation(tone(frequency)), COARSE)
    assert np.abs(found.table[:, 0]).max() < 1.5 * RIPPLE


def test_every_channel_goes_through_the_same_filter() -> None:
    """Also for a frequency in the transition band, where the filter does change it."""
    found = decimated(response_of_decimation(tone(230.0)), COARSE)
    column = found.table[:, :1]
    assert 0.05 < np.abs(column).max() < 0.95
    assert_allclose(found.table, column * np.arange(1.0, 7.0), rtol=1e-12, atol=1e-13)
    assert_allclose(found.cover, 2 * found.table, rtol=1e-12, atol=1e-13)
    assert_allclose(found.load, 3 * found.table, rtol=1e-12, atol=1e-13)
    assert_allclose(found.cells, 4 * column[:, :, None] * np.ones((4, 3)), rtol=1e-12, atol=1e-13)
    assert_allclose(found.places["mast-top"], 5 * column * np.ones(3), rtol=1e-12, atol=1e-13)
    assert_allclose(found.coordinates, 6 * column * np.ones(8), rtol=1e-12, atol=1e-13)
    assert found.settings["route"] == "made up"
    assert found.settings["anti_alias"]["simulated_at_hz"] == FINE


def test_a_motion_brought_down_is_the_pattern_sampled_at_that_rate() -> None:
    pattern, cross = Sweep(axis="gamma", rate=60.0), drawn(np.random.default_rng(0))
    found = decimated(pattern.motion(FINE, ring_down=1.0, cross=cross), COARSE)
    expected = pattern.motion(COARSE, ring_down=1.0, cross=cross)
    n = min(len(found.time), len(expected.time))
    for kind in ("displacement", "velocity", "acceleration"):
        channels, truth = getattr(found, kind)[:n], getattr(expected, kind)[:n]
        assert_allclose(channels / np.abs(truth).max(axis=0), truth / np.abs(truth).max(axis=0), rtol=0, atol=3 * RIPPLE)
    assert not found.acceleration[found.time > found.driven].any()
    assert found.duration == pytest.approx(expected.duration, abs=1 / COARSE)


def test_a_record_at_its_own_rate_stays_what_it_is() -> None:
    run = response_of_decimation(tone(10.0))
    assert decimated(run, FINE) is run


def test_a_rig_without_cells_places_and_coordinates_is_brought_down_too() -> None:
    six = np.zeros((100, 6))
    found = decimated(Response(sampling_rate=FINE, table=six, cover=six, load=six, cells=np.zeros((100, 0, 3))), COARSE)
    assert found.cells.shape == (7, 0, 3)
    assert found.coordinates.shape == (7, 0)
    assert len(found.time) == 7


@given(st.floats(10, 20000), st.floats(100, 50000))
def test_the_simulation_rate_is_the_smallest_multiple_that_is_enough(rate: float, least: float) -> None:
    found = simulation_rate(rate, least)
    assert found >= least * (1 - 1e-8)
    assert found / rate == pytest.approx(round(found / rate), rel=1e-12)
    assert found == rate or found - rate < least
    assert (simulation_rate(564.0), simulation_rate(8000.0)) == (8460.0, 8000.0)


def test_what_a_record_can_hold_ends_at_the_pass_band() -> None:
    sweep = Sweep(axis="x")
    require_recorded(sweep.highest, 564.0, sweep.label)
    assert pass_band(100.0) == 40.0
    require_recorded(40.0, 100.0, "edge")


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: require_recorded(33.9, 60.0, "sweep"),
            "sweep: `rate`: it drives up to 33.9 Hz, beyond the Nyquist frequency of 30",
        ),
        (lambda: require_recorded(33.9, 80.0, "sweep"), "pass-band of the anti-alias filter, 32 Hz.* Record at 84.75 Hz or more"),
        (lambda: require_recorded(33.9, -80.0, "sweep"), "`rate`: must be positive and finite, found -80 Hz"),
        (lambda: simulation_rate(0.0), "`output_rate`: must be positive and finite, found 0 Hz"),
        (lambda: simulation_rate(float("nan")), "found nan Hz"),
        (lambda: decimated(response_of_decimation(tone(9.0)), 0.0), "`rate`: must be positive and finite"),
        (
            lambda: decimated(response_of_decimation(tone(9.0)), 500.0),
            "8192 Hz must be a whole multiple of it, found 500 Hz. Record at 481.88. or 512",
        ),
        (
            lambda: decimated(response_of_decimation(tone(9.0)), 10000.0),
            "a whole multiple of it, found 10000 Hz. Record at 8192 Hz or less",
        ),
    ],
)
def test_a_rate_that_cannot_be_is_refused_with_a_way_on(call: Callable[[], object], message: str) -> None:
    with pytest.raises(BadInput, match=message):
        call()
