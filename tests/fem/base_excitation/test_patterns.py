"""Patterns of excitation: functions with exact derivatives, level over the band, rest at the end, and how small a motion is."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.base_excitation.patterns import (
    SMOOTH,
    BaseMotion,
    Burst,
    CrossMotion,
    MultiAxis,
    Random,
    Sweep,
    drawn,
    phased_sweeps,
    smooth_step,
    sweeps,
)
from fem.base_excitation.response import LIMIT, judge
from geometry.dynamic_mass import LEVELS, MOTIONS
from geometry.errors import BadInput

FAST = {"rate": 60.0}
"""Of sweeps that are about the shape of a pattern, not about the paper's rate."""


def cross(seed: int = 3) -> CrossMotion:
    return drawn(np.random.default_rng(seed))


def transfer(table: CrossMotion, frequency: Any) -> Any:
    """(n, 6, 6) motion of all axes (rows) for a unit drive of each (columns), in SI, at `frequency` (n,) [Hz]."""
    late = np.exp(-2j * np.pi * table.delay * np.atleast_1d(frequency))
    return table.at_once + late[:, None, None] * table.delayed


PATTERNS: dict[str, Callable[[], Any]] = {
    "sweep": lambda: Sweep(axis="x", **FAST),
    "delayed sweep": lambda: Sweep(axis="gamma", phase=1.0, delay=0.3, **FAST),
    "multi-axis": lambda: phased_sweeps(**FAST)[1],
    "random": lambda: Random(duration=4.0, seed=1),
    "burst of noise": lambda: Burst(duration=2.0, seed=2),
    "burst of sine": lambda: Burst(start=10.0, stop=10.0, duration=2.0),
}


def derivative_errors(motion: BaseMotion) -> tuple[float, float]:
    """Relative difference of velocity and acceleration from central differences of fourth order of the displacement."""
    u, h = motion.displacement, 1 / motion.sampling_rate
    first = (8 * (u[3:-1] - u[1:-3]) - (u[4:] - u[:-4])) / (12 * h)
    second = (16 * (u[3:-1] + u[1:-3]) - (u[4:] + u[:-4]) - 30 * u[2:-2]) / (12 * h**2)
    pairs = ((first, motion.velocity[2:-2]), (second, motion.acceleration[2:-2]))
    found, expected = (max(float((np.abs(d - e).max(0) / np.abs(e).max(0)).max()) for d, e in [pair]) for pair in pairs)
    return found, expected


@pytest.mark.parametrize("name", PATTERNS)
def test_velocity_and_acceleration_are_the_derivatives_of_displacement_to_the_order_of_the_differences(name: str) -> None:
    """Differences of fourth order come 16 times closer when the step is halved; what they come closer to is then exact."""
    coarse, fine = (derivative_errors(PATTERNS[name]().motion(rate, ring_down=0.2, cross=cross())) for rate in (1024, 2048))
    assert max(fine) < 2e-5
    assert_allclose(np.divide(coarse, fine), 16, rtol=0.1)


@pytest.mark.parametrize("with_cross", [False, True])
@pytest.mark.parametrize("name", PATTERNS)
def test_the_table_is_at_exact_rest_before_and_after(name: str, with_cross: bool) -> None:
    motion = PATTERNS[name]().motion(1024, ring_down=0.5, cross=cross() if with_cross else None)
    for kind in (motion.displacement, motion.velocity, motion.acceleration):
        assert not kind[0].any()
        assert not kind[motion.time >= motion.driven].any()
    assert motion.duration - motion.driven >= 0.5 - 1e-9
    before = (motion.time > motion.driven - 0.2) & (motion.time < motion.driven)
    assert motion.displacement[before].any()


@pytest.mark.parametrize("name", PATTERNS)
def test_half_of_the_samples_are_those_at_half_the_rate(name: str) -> None:
    """A pattern is a function of time, not of how it is sampled; that holds for noise and for cross motion too."""
    fine, coarse = (PATTERNS[name]().motion(rate, ring_down=0.25, cross=cross()) for rate in (1024, 512))
    n = min(len(coarse.time), len(fine.time[::2]))
    assert_allclose(fine.acceleration[::2][:n], coarse.acceleration[:n], rtol=0, atol=1e-11)
    assert_allclose(fine.displacement[::2][:n], coarse.displacement[:n], rtol=0, atol=1e-14)


@pytest.mark.parametrize("axis", MOTIONS)
def test_the_sweep_drives_one_axis_at_its_nominal_level_from_4_to_32_hz(axis: str) -> None:
    """A sweep and one a quarter period ahead together give the envelope at every instant: level within 0.2 % in the band."""
    for changes, bound in (({"rate": 2.0}, 1e-6), ({"rate": 137.0}, 2.1e-3)):
        sine, cosine = (Sweep(axis=axis, phase=phase, **changes) for phase in (0.0, np.pi / 2))
        motion, ahead = (sweep.motion(256, ring_down=0.0) for sweep in (sine, cosine))
        in_band = (motion.time >= sine.time_at(4.0)) & (motion.time <= sine.time_at(32.0))
        driven = MOTIONS.index(axis)
        envelope = np.hypot(motion.acceleration[:, driven], ahead.acceleration[:, driven])[in_band]
        assert_allclose(envelope, LEVELS[axis], rtol=bound)
        assert not np.delete(motion.acceleration, driven, axis=1).any()


def test_the_papers_sweep_takes_about_90_s_and_its_soft_ends_lie_outside_the_band() -> None:
    sweep = Sweep(axis="z")
    assert sweep.time_at(32.0) - sweep.time_at(4.0) == pytest.approx(90.0)
    assert sweep.lowest < 4.0
    assert sweep.highest > 32.0
    assert sweep.driven - 90.0 < 6.0


def test_frequency_and_time_of_a_sweep_undo_each_other_and_give_two_octaves_a_minute() -> None:
    sweep = Sweep(axis="x", delay=2.0)
    frequency = np.geomspace(sweep.lowest, sweep.highest, 50)
    assert_allclose(sweep.frequency_at(sweep.time_at(frequency)), frequency, rtol=1e-12)
    time = np.linspace(10.0, 60.0, 6)
    assert_allclose(sweep.frequency_at(time + 30.0) / sweep.frequency_at(time), 2.0, rtol=1e-12)
    assert sweep.frequency_at(0.0) == sweep.lowest


def test_the_frequency_of_a_sweep_is_that_of_its_sine() -> None:
    """Two sweeps a quarter period apart give the phase; its derivative is 2 pi times the stated frequency."""
    sine, cosine = (Sweep(axis="x", phase=phase, **FAST) for phase in (0.0, np.pi / 2))
    motion, ahead = (sweep.motion(4096, ring_down=0.0) for sweep in (sine, cosine))
    phase = np.unwrap(np.arctan2(motion.displacement[:, 0], ahead.displacement[:, 0]))
    inside = (motion.time > sine.time_at(4.0)) & (motion.time < sine.time_at(32.0))
    found = np.gradient(phase, 1 / 4096) / (2 * np.pi)
    assert_allclose(found[inside], sine.frequency_at(motion.time[inside]), rtol=1e-4)


def test_level_scales_the_whole_motion() -> None:
    whole, half = (Sweep(axis="beta", level=level, **FAST).motion(512, ring_down=0.1, cross=cross()) for level in (1.0, 0.5))
    assert_allclose(half.displacement, whole.displacement / 2, rtol=1e-13)


def test_phased_sweeps_of_all_axes_are_as_independent_as_six_runs_can_be() -> None:
    """S_u in units of the nominal levels has condition 1, in the band, at full-record resolution."""
    runs = [run.motion(256, ring_down=0.0).acceleration / list(LEVELS.values()) for run in phased_sweeps(**FAST)]
    spectra = np.stack([np.fft.rfft(run, axis=0) for run in runs], axis=2)
    frequency = np.fft.rfftfreq(len(runs[0]), 1 / 256)
    condition = np.linalg.cond(spectra[(frequency > 6) & (frequency < 28)])
    assert_allclose(condition, 1.0, atol=0.15)


def test_a_multi_axis_run_is_the_sum_of_its_patterns() -> None:
    parts = (Sweep(axis="x", **FAST), Sweep(axis="x", delay=0.5, **FAST), Random(rms={"gamma": 1.0}, duration=4.0))
    total = MultiAxis(patterns=parts).motion(512, ring_down=0.5)
    n = len(total.displacement)
    separate = [part.motion(512, ring_down=10.0).acceleration[:n] for part in parts]
    assert_allclose(total.acceleration, sum(separate), rtol=0, atol=1e-12)
    assert all(part.label in total.label for part in parts)


def test_noise_has_the_stated_strength_and_leaves_nothing_outside_its_band() -> None:
    rms = {"x": 1.0, "beta": 0.2}
    pattern = Random(rms=rms, start=5.0, stop=25.0, duration=60.0, seed=4)
    motion = pattern.motion(256, ring_down=0.0)
    full = motion.acceleration[(motion.time > 0.6) & (motion.time < 59.4)]
    assert_allclose(full.std(axis=0)[[0, 4]], [1.0, 0.2], rtol=0.01)
    assert not full[:, [1, 2, 3, 5]].any()
    power = np.abs(np.fft.rfft(motion.acceleration[:, 0])) ** 2
    frequency = np.fft.rfftfreq(len(motion.acceleration), 1 / 256)
    outside = (frequency < 3.5) | (frequency > 26.5)
    assert power[outside].sum() < 1e-4 * power.sum()


def test_axes_of_noise_are_independent_and_a_seed_repeats_it() -> None:
    first, again, other = (Random(duration=30.0, seed=seed).motion(128, ring_down=0.0).acceleration for seed in (7, 7, 8))
    assert_allclose(first, again, rtol=0, atol=0)
    assert np.abs(np.corrcoef(np.hstack([first, other]).T) - np.eye(12)).max() < 0.2


def test_a_pattern_from_a_generator_stays_the_same_and_the_next_one_differs() -> None:
    generator = np.random.default_rng(5)
    first, second = (Random(duration=4.0, seed=generator) for _ in range(2))
    once, twice, other = (pattern.motion(128, ring_down=0.0).acceleration for pattern in (first, first, second))
    assert_allclose(once, twice, rtol=0, atol=0)
    assert np.abs(once - other).max() > 0.1


def test_an_axis_of_noise_does_not_change_when_another_one_is_driven_as_well() -> None:
    alone, both = (Random(rms=rms, duration=4.0).motion(128, ring_down=0.0) for rms in ({"z": 1.0}, {"x": 1.0, "z": 1.0}))
    assert_allclose(alone.acceleration[:, 2], both.acceleration[:, 2], rtol=0, atol=0)


def test_a_burst_swells_to_its_level_and_is_then_silent() -> None:
    burst = Burst(level={"z": 3.0}, start=11.5, stop=11.5, duration=1.5)
    motion = burst.motion(4096, ring_down=2.0)
    assert_allclose(np.abs(motion.acceleration[:, 2]).max(), 3.0, rtol=0.01)
    assert abs(motion.time[np.argmax(np.abs(motion.acceleration[:, 2]))] - 0.75) < 0.1
    assert not motion.acceleration[motion.time > 1.5].any()
    swell = motion.displacement[motion.time <= 1.5, 2]
    assert_allclose(swell, -swell[::-1], rtol=0, atol=1e-12 * np.abs(swell).max())


def test_cross_motion_has_the_drawn_share_and_lag_over_the_whole_band() -> None:
    """The spectra of a driven run show the transfer that the table was given, axis by axis."""
    table = cross()
    six = [sweep.motion(512, ring_down=0.5, cross=table) for sweep in sweeps(**FAST).values()]
    alone = [sweep.motion(512, ring_down=0.5).acceleration for sweep in sweeps(**FAST).values()]
    n = len(six[0].acceleration)
    frequency = np.fft.rfftfreq(n, 1 / 512)
    band = (frequency > 4) & (frequency < 32)
    for axis, (run, drive) in enumerate(zip(six, alone, strict=True)):
        driven = np.fft.rfft(drive[:, axis], n)[band]
        found = np.fft.rfft(run.acceleration, axis=0)[band] / driven[:, None]
        assert_allclose(found, transfer(table, frequency[band])[:, :, axis], rtol=0, atol=1e-9)


def test_cross_motion_is_what_it_says_at_its_middle_frequency() -> None:
    table = cross()
    levels = np.array(list(LEVELS.values()))
    at_middle = transfer(table, table.frequency)[0] * levels / levels[:, None] - np.eye(6)
    assert_allclose(at_middle, table.share * np.exp(-1j * table.lag), rtol=0, atol=1e-15)
    over_band = np.abs(transfer(table, np.linspace(1, 64, 200)) * levels / levels[:, None] - np.eye(6))
    assert np.all(over_band <= np.sqrt(2) * table.share + 1e-15)
    assert 0.015 < table.share.sum() / 30 < 0.045
    assert not np.diag(table.share).any()


def test_the_reference_point_and_the_label_go_with_the_motion() -> None:
    motion = Sweep(axis="alpha", **FAST).motion(512, ring_down=0.1, reference_point=[0.0, 0.0, -0.045])
    assert_allclose(motion.reference_point, [0, 0, -0.045])
    assert motion.label == "sine sweep 4-32 Hz, 60 oct/min, alpha 3 rad/s²"


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Sweep(axis="beat"), "`axis`: must be one of .*, found 'beat'. Did you mean beta"),
        (lambda: Sweep(axis="x", start=32.0, stop=4.0), "`start`: must be below `stop`, found 32 Hz and 4 Hz"),
        (lambda: Sweep(axis="x", start=8.0, stop=8.0), "`start`: must be below `stop`"),
        (lambda: Sweep(axis="x", start=-1.0), "`start`: must be positive and finite, found -1 Hz"),
        (lambda: Sweep(axis="x", level=0.0), "`level`: must be positive and finite, found 0"),
        (lambda: Sweep(axis="x", level=float("nan")), "`level`: must be positive and finite, found nan"),
        (lambda: Sweep(axis="x", rate=-2.0), "`rate`: must be positive and finite, found -2 oct/min"),
        (lambda: Sweep(axis="x", rate=200.0), "`rate`: at most 137.6 oct/min keep the level at 4 Hz, found 200"),
        (lambda: Sweep(axis="x", delay=-1.0), "`delay`: must be finite and not negative"),
        (lambda: Sweep(axis="x", phase=float("inf")), "`phase`: must be finite"),
        (lambda: Sweep(axis="x").motion(512, ring_down=-1.0), "`ring_down`: must be finite and not negative, found -1 s"),
        (lambda: Sweep(axis="x").motion(64, ring_down=1.0), "`sampling_rate`: must be above twice .* 33.9 Hz, found 64 Hz"),
        (lambda: Sweep(axis="x").motion(float("nan"), ring_down=1.0), "`sampling_rate`: must be positive"),
        (lambda: Sweep(axis="x", rate=1e-4).motion(8192, ring_down=1.0), "the record would have 1.56e.10 samples"),
        (lambda: Random(rms={"X": 1.0}), "`rms`: must be one of x, y, z"),
        (lambda: Random(rms={}), "`rms`: names no axis"),
        (lambda: Random(rms={"x": -1.0}), "`rms.x`: must be positive and finite, found -1 m/s²"),
        (lambda: Random(duration=1.0), "`duration`: must be at least 9 cycles of 4 Hz, 2.25 s, found 1 s"),
        (lambda: Random(start=4.1, stop=4.2, duration=4.0), "no line of noise of 4 s lies between 4.1 and 4.2 Hz"),
        (lambda: Random(duration=4.0).motion(500.1, ring_down=0.0), "a whole number of samples in it, found 2000.4"),
        (lambda: Random(duration=4.0, seed=-1), "`seed`: must not be negative, found -1"),
        (lambda: Random(duration=1e9).motion(512, ring_down=0.0), "the record would have 5.12e.11 samples"),
        (lambda: Sweep(axis="x").time_at([5.0, 40.0]), "`frequency`: the sweep runs from 3.775 to 33.9 Hz, found 40 Hz"),
        (lambda: Burst(start=9.0, stop=8.0), "`start`: must be below `stop`"),
        (lambda: Burst(duration=0.1), "at least 3 cycles of 4 Hz"),
        (lambda: Burst(level={"gama": 1.0}), "Did you mean gamma"),
        (lambda: MultiAxis(patterns=()), "`patterns`: is empty"),
        (lambda: drawn(np.random.default_rng(0), -0.1), "`share`: must be finite and not negative, found -0.1"),
        (lambda: drawn(np.random.default_rng(0), 3.0), r"`share`: must be at most 0.5 everywhere, found .* of \w+ in \w+"),
        (lambda: CrossMotion(share=np.zeros((6, 6)), lag=np.zeros((6, 6)), frequency=0.0), "`frequency`: must be positive"),
    ],
)
def test_what_cannot_be_driven_is_refused_with_a_way_on(call: Callable[[], object], message: str) -> None:
    with pytest.raises(BadInput, match=message):
        call()


TIME = np.linspace(-0.2, 1.4, 3001)


def test_a_step_starts_with_as_many_vanishing_derivatives_as_stated() -> None:
    """Beside its foot it grows with the power after the last that vanishes, and it ends as it starts."""
    near, twice = smooth_step(np.array([1e-3, 2e-3]), 0.0, 1.0).value
    assert twice / near == pytest.approx(2 ** (SMOOTH + 1), rel=0.01)
    rising, falling = smooth_step(TIME, 0.0, 1.0), smooth_step(1 - TIME, 0.0, 1.0)
    assert_allclose(rising.value, 1 - falling.value, rtol=0, atol=1e-14)


@pytest.mark.parametrize("axis", ["alpha", "beta", "gamma"])
def test_the_papers_rotation_sweeps_keep_the_limit_and_reach_less_than_half_of_it(axis: str) -> None:
    """At full level the soft start is over at 4 Hz: there the angle is A / omega²."""
    sweep = sweeps()[axis]
    verdict = judge(sweep.motion(256, ring_down=0.0))
    omega = 2 * np.pi * 4.0
    assert verdict.angle == pytest.approx(sweep.amplitude / omega**2, rel=0.05)
    assert verdict.rate == pytest.approx(sweep.amplitude / omega, rel=0.05)
    assert verdict.left_out < 0.5 * LIMIT
    assert verdict.within
    assert "within the limit of 2.00%" in verdict.text


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_a_translation_without_rotation_leaves_nothing_out(axis: str) -> None:
    verdict = judge(sweeps(rate=60.0)[axis].motion(256, ring_down=0.0))
    assert verdict.left_out == 0
    assert verdict.within


def test_of_a_harmonic_rotation_the_angle_and_the_squared_rate_say_the_same() -> None:
    """|omega|² / |omega'| = theta for theta sin(Omega t)."""
    verdict = judge(Burst(level={"beta": 8.0}, start=5.0, stop=5.0, duration=20.0).motion(512, ring_down=0.0))
    assert verdict.angle == pytest.approx(8.0 / (2 * np.pi * 5.0) ** 2, rel=2e-3)
    assert verdict.centripetal == pytest.approx(verdict.turned, rel=5e-3)


def test_too_much_rotation_is_said_to_be_beyond_the_limit() -> None:
    verdict = judge(sweeps(4.0, rate=60.0)["gamma"].motion(256, ring_down=0.0))
    assert not verdict.within
    assert "beyond the limit of 2.00%" in verdict.text
