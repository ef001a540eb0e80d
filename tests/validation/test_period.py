"""The period from counts, lists and records: exact where it can be, honest in its tolerance, refused where it must be."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from geometry.toml_file import exact, tagged
from validation.classical.pendulum import from_cycles, from_signal, from_times

T, ZETA = 3.1, 0.01
TIME = np.arange(0, 40, 0.02)


def decay(time: np.ndarray, period: float = T, zeta: float = ZETA, amplitude: float = 0.1) -> np.ndarray:
    rate = zeta / np.sqrt(1 - zeta**2) * 2 * np.pi / period
    return amplitude * np.exp(-rate * time) * np.cos(2 * np.pi * time / period + 0.3)


def test_more_cycles_make_the_stop_watch_better_in_proportion() -> None:
    few, many = (from_cycles(n, tagged(n * T, 0.2, "time"), "file") for n in (5, 50))
    assert_allclose([few.nominal_value, many.nominal_value], T, rtol=1e-14)
    assert_allclose(few.std_dev / many.std_dev, 10, rtol=1e-12)


def test_a_clean_record_gives_period_damping_and_amplitude_to_rounding() -> None:
    found = from_signal(TIME, decay(TIME) + 0.002 * TIME + 2, "file")
    assert_allclose([found.period.nominal_value, found.damping_ratio.nominal_value], [T, ZETA], rtol=1e-9)
    rate = ZETA / np.sqrt(1 - ZETA**2) * 2 * np.pi / T
    peaks = 0.1 * np.exp(-rate * TIME)
    assert_allclose(found.amplitude, np.sqrt(np.mean(peaks**2)), rtol=0.02)  # the record holds no whole number of cycles


def test_uneven_sampling_changes_nothing() -> None:
    uneven = np.sort(np.random.default_rng(2).uniform(0, 40, 900))
    assert_allclose(from_signal(uneven, decay(uneven), "file").period.nominal_value, T, rtol=1e-9)


def test_the_stated_tolerance_of_a_noisy_record_covers_as_a_standard_deviation_should() -> None:
    rng = np.random.default_rng(7)
    fits = [from_signal(TIME, decay(TIME) + 0.005 * rng.normal(size=len(TIME)), "file") for _ in range(60)]
    off = np.array([(fit.period.nominal_value - T) / fit.period.std_dev for fit in fits])
    # 60 draws know a standard deviation to 9 %, a mean to 0.13: three of each
    assert 0.7 < off.std() < 1.3
    assert abs(off.mean()) < 0.4


def test_noise_drift_and_a_second_oscillation_are_said() -> None:
    rng = np.random.default_rng(3)
    noisy = from_signal(TIME, decay(TIME) + 0.02 * rng.normal(size=len(TIME)), "file")
    drifting = from_signal(TIME, decay(TIME) + 0.05 * TIME, "file")
    beating = from_signal(TIME, decay(TIME) + 0.01 * np.sin(2 * np.pi * 0.9 * TIME), "file")
    assert "of the signal" in noisy.notes[0]
    assert "drifts" in drifting.notes[0]
    assert any("correlated" in note for note in beating.notes)


@pytest.mark.parametrize(
    ("time", "signal", "words"),
    [
        (TIME[:400], decay(TIME[:400]), "at least 3 cycles"),
        (TIME[::200], decay(TIME[::200], period=10.0), "hold 15 samples"),
        (np.arange(0, 90, 0.8), decay(np.arange(0, 90, 0.8), period=2.5), "samples a cycle"),
        (TIME, np.where(TIME > 20, np.nan, 1.0), "not finite"),
        (TIME[::-1], decay(TIME), "time must increase"),
        (TIME, np.ones_like(TIME), "constant"),
        (TIME, decay(TIME)[::-1], "grows"),
        (TIME, np.random.default_rng(1).normal(size=len(TIME)), "no decaying sinusoid|samples a cycle"),
        (TIME, decay(TIME)[:-1], "equally long"),
    ],
)
def test_records_that_cannot_be_trusted_are_refused(time: np.ndarray, signal: np.ndarray, words: str) -> None:
    with pytest.raises(BadInput, match=words):
        from_signal(time, signal, "file")


def test_the_slope_of_the_passage_times_is_the_period() -> None:
    times = [tagged(2 + T * i, 0.05, "passage times") for i in range(11)]
    found = from_times(times, "file")
    assert_allclose(found.nominal_value, T, rtol=1e-13)
    # slope of a line through n evenly spaced points: σ / sqrt(n (n² - 1)/12)
    assert_allclose(found.std_dev, 0.05 / np.sqrt(11 * 120 / 12), rtol=1e-9)


def test_scatter_of_the_times_enters_the_tolerance() -> None:
    scattered = T * np.arange(11) + np.random.default_rng(4).normal(0, 0.05, 11)
    assert from_times([exact(t) for t in scattered], "file").std_dev > 0


@pytest.mark.parametrize("times", [[0.0, 3.0], [0.0, 3.0, 2.0], [0.0, 3.1, 6.2, 12.4, 15.5]])
def test_lists_that_hide_something_are_refused(times: list[float]) -> None:
    with pytest.raises(BadInput, match="times"):
        from_times([exact(t) for t in times], "file")


@pytest.mark.parametrize(("count", "time"), [(0, 3.0), (10, 0.0), (10, -3.0)])
def test_counts_and_times_must_be_positive(count: int, time: float) -> None:
    with pytest.raises(BadInput):
        from_cycles(count, exact(time), "file")


@pytest.mark.parametrize("cycles", [3.3, 5.5, 8.0])
def test_the_amplitude_is_the_root_mean_square_of_the_envelope_whatever_part_of_a_cycle_is_left_over(cycles: float) -> None:
    t = np.linspace(0, cycles, 400)
    envelope = 0.2 * np.exp(-0.1 * t)
    found = from_signal(t, envelope * np.cos(2 * np.pi * t) + 0.05 * t, "record")
    assert_allclose(found.amplitude, np.sqrt(np.mean(envelope**2)), rtol=1e-6)
    assert_allclose(found.fitted, envelope * np.cos(2 * np.pi * t) + 0.05 * t, atol=1e-7)
