"""What peak-hold makes of a lightly damped mode: the kernel against the operator on sweeps in time, and its limits."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from identification.spectra.line_spectra import hann
from validation.effects.catalogue import FAMILIES
from validation.effects.families.sweep_bias import operator, window
from validation.effects.stages import NEAREST, MountedDynamicMass, NoiseModel, leak

RATE, BLOCK = 564.0, 8192
RESONANCE = 12.3


def mode(frequency: np.ndarray, damping: float) -> np.ndarray:
    return 1 + frequency**2 / (RESONANCE**2 - frequency**2 + 2j * damping * RESONANCE * frequency)


def test_the_window_is_the_transform_of_the_hann_window_of_peak_hold():
    at = np.array([0.0, 0.3, 0.99, 1.0, 1.01, 2.0, 2.5, 7.3])
    n = 1 << 16
    shifted = np.arange(n) - n / 2
    exact = [np.sum(hann(n) * np.cos(2 * np.pi * x * shifted / n)) / np.sum(hann(n)) for x in at]
    assert_allclose(window(at), exact, atol=1e-8)


@pytest.mark.parametrize(("overlap", "left"), [(0.98, 0.06), (0.9, 0.3)])
@pytest.mark.parametrize("damping", [0.0035, 0.01])
def test_the_kernel_is_what_peak_hold_does_to_a_sweep_in_time(damping, overlap, left, peak_hold_bias):
    """It stands for a block right in the middle: what is left shrinks with the step from block to block."""
    native = np.arange(round(11.0 * BLOCK / RATE), round(13.6 * BLOCK / RATE)) * RATE / BLOCK
    measured = peak_hold_bias["sweep_bias"](RESONANCE, damping, frequency=native, rate=RATE, overlap=overlap)
    lines = native[0] + np.arange(-100, 8 * len(native) + 100) * RATE / BLOCK / 8
    predicted = (operator(lines, 2 / 60, BLOCK / RATE) @ mode(lines, damping))[100 : 100 + 8 * len(native) : 8]
    inner = (native > 11.6) & (native < 13.0)
    size = np.max(np.abs(measured.exact))
    bias, error = (np.max(np.abs(one - measured.peak_hold)[inner]) / size for one in (measured.exact, predicted))
    assert bias > 0.1
    assert error < left * bias


def test_at_a_quarter_of_the_rate_the_phase_of_the_chirp_counts_and_is_right(peak_hold_bias):
    """A quarter of the paper's rate, where the phase of the chirp turns four times as far across the window."""
    native = np.arange(round(11.6 * BLOCK / RATE), round(13.0 * BLOCK / RATE)) * RATE / BLOCK
    slow = {"start": 9.0, "stop": 16.0, "octaves_per_minute": 0.5, "rate": RATE, "overlap": 0.98}
    measured = peak_hold_bias["sweep_bias"](RESONANCE, 0.0035, frequency=native, **slow)
    lines = native[0] + np.arange(-100, 8 * len(native) + 100) * RATE / BLOCK / 8
    predicted = (operator(lines, 0.5 / 60, BLOCK / RATE) @ mode(lines, 0.0035))[100 : 100 + 8 * len(native) : 8]
    size = np.max(np.abs(measured.exact))
    bias, error = (np.max(np.abs(one - measured.peak_hold)) / size for one in (measured.exact, predicted))
    assert bias > 0.3
    assert error < 0.02


def test_longer_blocks_help_and_a_slower_sweep_does_not():
    """What the catalogue says would confirm it; the lines are a seventh of the half-power width apart."""
    lines = np.arange(10.5, 14.2, 0.0125)
    exact = mode(lines, 0.0035)
    inner = (lines > 11.6) & (lines < 13.0)

    def bias(octaves_per_minute, block):
        found = operator(lines, octaves_per_minute / 60, block) @ exact
        return float(np.max(np.abs(found - exact)[inner]) / np.max(np.abs(exact)))

    paper = bias(2.0, BLOCK / RATE)
    assert bias(0.5, BLOCK / RATE) == pytest.approx(paper, rel=0.01)
    assert bias(2.0, 2 * BLOCK / RATE) < 0.55 * paper


def test_a_heavily_damped_mode_and_a_mass_line_stay_as_they_are():
    lines = np.arange(11.0, 13.6, 0.05)
    S = operator(lines, 2 / 60, BLOCK / RATE)
    assert_allclose(S.sum(axis=1), 1.0, atol=1e-12)
    soft = mode(lines, 0.2)
    assert_allclose((S @ soft)[10:-10], soft[10:-10], rtol=1e-3)


def test_splines_between_lines_converge_with_the_fourth_power_and_full_records_are_left_alone():
    def at(finer):
        lines = 11.5 + np.arange(32 * finer + 1) * 0.05 / finer
        return (operator(lines, 2 / 60, BLOCK / RATE) @ mode(lines, 0.0035))[10 * finer : 22 * finer : finer]

    errors = [np.max(np.abs(at(finer) - at(16))) for finer in (1, 2, 4)]
    assert errors[0] < 0.05 * np.max(np.abs(mode(np.array([RESONANCE]), 0.0035)))
    assert errors[1] / errors[2] > 10  # 16 from afar; the coarsest lines see the mode with four points
    H = np.random.default_rng(1).standard_normal((4, 6, 6)).astype(complex)
    plain = MountedDynamicMass(frequency=np.arange(4) + 5.0, matrix=H)
    for stage in (plain, replace(plain, block=14.5), replace(plain, sweep_rate=0.03)):
        assert FAMILIES["sweep-bias"].change(stage, (), {}) is stage


SAMPLING, DURATION = 512.0, 8.0
CHANNELS = ("cover-z3", "fmd-z1")


def full_record(signal: np.ndarray, frequency: np.ndarray) -> np.ndarray:
    """Spectra per Hz of records (..., n) at the lines `frequency` (m,)."""
    t = np.arange(signal.shape[-1]) / SAMPLING
    return signal @ np.exp(-2j * np.pi * np.outer(t, frequency)) / SAMPLING


def floor(frequency: np.ndarray, deviation: float, **more: np.ndarray) -> NoiseModel:
    return NoiseModel(
        frequency=frequency,
        channels=CHANNELS,
        quantities=("acceleration", "force"),
        deviation=np.full((len(frequency), 2), deviation),
        per_rms=np.full(2, np.sqrt(DURATION / SAMPLING)),
        **more,
    )


def test_a_channel_with_more_noise_scatters_by_both_together():
    rng, f = np.random.default_rng(4), np.array([5.0, 11.3, 27.7])
    own, more, records = 0.03, 0.04, 1200
    before = floor(f, own * np.sqrt(DURATION / SAMPLING))
    after = FAMILIES["noise"].change(before, ("cover-z3",), {"": more})
    n = round(DURATION * SAMPLING)
    lines = full_record(own * rng.standard_normal((records, n)) + more * rng.standard_normal((records, n)), f)
    found = np.sqrt(np.mean(np.abs(lines) ** 2, axis=0))
    assert_allclose(found, after.deviation[:, 0], rtol=4 / np.sqrt(2 * records))  # four standard deviations
    assert_allclose(after.deviation[:, 1], before.deviation[:, 1])


def test_hum_leaks_into_a_record_that_cuts_it_anywhere():
    rng, f = np.random.default_rng(5), np.array([8.0, 20.1, 31.9])
    records = 1500
    mains, phase = 50 + 0.1 * rng.standard_normal((records, 1)), rng.uniform(0, 2 * np.pi, (records, 1))
    t = np.arange(round(DURATION * SAMPLING)) / SAMPLING
    lines = full_record(np.sin(2 * np.pi * mains * t + phase), f)
    found = np.sqrt(np.mean(np.abs(lines) ** 2, axis=0))
    # The mirror at -50 Hz adds (|f - 50| / (f + 50))² at most, half of it at random phases.
    assert_allclose(found, leak(f), rtol=0.5 * (42 / 58) ** 2 + 4 / np.sqrt(2 * records))
    assert_allclose(found[2], leak(f)[2], rtol=0.5 * (18.1 / 81.9) ** 2 + 4 / np.sqrt(2 * records))


@pytest.mark.parametrize("factor", [0.0, 0.5, 1.0, 7.0])
def test_a_factor_on_the_hum_adds_or_takes_what_is_its_share(factor):
    f = np.array([10.0, 30.0])
    hum = np.outer(leak(f), [0.003, 0.2])
    before = floor(f, 1e-4, hum=hum)
    after = FAMILIES["mains"].change(before, (), {"": factor})
    expected = before.deviation**2 + (factor**2 - 1) * hum**2
    kept = expected > (min(factor, 1.0) * before.deviation) ** 2
    assert_allclose(after.deviation[kept] ** 2, expected[kept], rtol=1e-12)
    assert np.all(after.deviation >= min(factor, 1.0) * before.deviation * (1 - 1e-12))
    assert_allclose(after.hum, factor * hum)


def test_where_the_hum_is_not_known_nothing_changes_and_on_the_mains_nothing_is_infinite():
    unknown = floor(np.array([10.0]), 1e-4)
    assert FAMILIES["mains"].change(unknown, (), {"": 9.0}) is unknown
    assert leak(np.array([50.0]))[0] == pytest.approx(leak(np.array([50.0 + NEAREST]))[0])
