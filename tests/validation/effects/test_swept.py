"""What peak-hold makes of a lightly damped mode: the kernel against the operator on sweeps in time, and its limits."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from identification.spectra.peak_hold import hann, sweep_bias
from validation.effects.catalogue import FAMILIES
from validation.effects.families.sweep_bias import operator, window
from validation.effects.stages import MountedDynamicMass

RATE, BLOCK = 564.0, 8192
RESONANCE = 12.3


def mode(frequency: np.ndarray, damping: float) -> np.ndarray:
    return 1 + frequency**2 / (RESONANCE**2 - frequency**2 + 2j * damping * RESONANCE * frequency)


def test_the_window_is_the_transform_of_the_hann_window_of_peak_hold() -> None:
    at = np.array([0.0, 0.3, 0.99, 1.0, 1.01, 2.0, 2.5, 7.3])
    n = 1 << 16
    shifted = np.arange(n) - n / 2
    exact = [np.sum(hann(n) * np.cos(2 * np.pi * x * shifted / n)) / np.sum(hann(n)) for x in at]
    assert_allclose(window(at), exact, atol=1e-8)


@pytest.mark.parametrize(("overlap", "left"), [(0.98, 0.06), (0.9, 0.3)])
@pytest.mark.parametrize("damping", [0.0035, 0.01])
def test_the_kernel_is_what_peak_hold_does_to_a_sweep_in_time(damping: float, overlap: float, left: float) -> None:
    """It stands for a block right in the middle: what is left shrinks with the step from block to block."""
    native = np.arange(round(11.0 * BLOCK / RATE), round(13.6 * BLOCK / RATE)) * RATE / BLOCK
    measured = sweep_bias(RESONANCE, damping, frequency=native, rate=RATE, overlap=overlap)
    lines = native[0] + np.arange(-100, 8 * len(native) + 100) * RATE / BLOCK / 8
    predicted = (operator(lines, 2 / 60, BLOCK / RATE) @ mode(lines, damping))[100 : 100 + 8 * len(native) : 8]
    inner = (native > 11.6) & (native < 13.0)
    size = np.max(np.abs(measured.exact))
    bias, error = (np.max(np.abs(one - measured.peak_hold)[inner]) / size for one in (measured.exact, predicted))
    assert bias > 0.1
    assert error < left * bias


def test_at_a_quarter_of_the_rate_the_phase_of_the_chirp_counts_and_is_right() -> None:
    """A quarter of the paper's rate, where the phase of the chirp turns four times as far across the window."""
    native = np.arange(round(11.6 * BLOCK / RATE), round(13.0 * BLOCK / RATE)) * RATE / BLOCK
    slow = {"start": 9.0, "stop": 16.0, "octaves_per_minute": 0.5, "rate": RATE, "overlap": 0.98}
    measured = sweep_bias(RESONANCE, 0.0035, frequency=native, **slow)
    lines = native[0] + np.arange(-100, 8 * len(native) + 100) * RATE / BLOCK / 8
    predicted = (operator(lines, 0.5 / 60, BLOCK / RATE) @ mode(lines, 0.0035))[100 : 100 + 8 * len(native) : 8]
    size = np.max(np.abs(measured.exact))
    bias, error = (np.max(np.abs(one - measured.peak_hold)) / size for one in (measured.exact, predicted))
    assert bias > 0.3
    assert error < 0.02


def test_longer_blocks_help_and_a_slower_sweep_does_not() -> None:
    """What the catalogue says would confirm it; the lines are a seventh of the half-power width apart."""
    lines = np.arange(10.5, 14.2, 0.0125)
    exact = mode(lines, 0.0035)
    inner = (lines > 11.6) & (lines < 13.0)

    def bias(octaves_per_minute: float, block: float) -> float:
        found = operator(lines, octaves_per_minute / 60, block) @ exact
        return float(np.max(np.abs(found - exact)[inner]) / np.max(np.abs(exact)))

    paper = bias(2.0, BLOCK / RATE)
    assert bias(0.5, BLOCK / RATE) == pytest.approx(paper, rel=0.01)
    assert bias(2.0, 2 * BLOCK / RATE) < 0.55 * paper


def test_a_heavily_damped_mode_and_a_mass_line_stay_as_they_are() -> None:
    lines = np.arange(11.0, 13.6, 0.05)
    S = operator(lines, 2 / 60, BLOCK / RATE)
    assert_allclose(S.sum(axis=1), 1.0, atol=1e-12)
    soft = mode(lines, 0.2)
    assert_allclose((S @ soft)[10:-10], soft[10:-10], rtol=1e-3)


def test_splines_between_lines_converge_with_the_fourth_power_of_their_distance() -> None:
    def at(finer: int) -> np.ndarray:
        lines = 11.5 + np.arange(32 * finer + 1) * 0.05 / finer
        return (operator(lines, 2 / 60, BLOCK / RATE) @ mode(lines, 0.0035))[10 * finer : 22 * finer : finer]

    errors = [np.max(np.abs(at(finer) - at(16))) for finer in (1, 2, 4)]
    assert errors[0] < 0.05 * np.max(np.abs(mode(np.array([RESONANCE]), 0.0035)))
    assert errors[1] / errors[2] > 10  # 16 from afar; the coarsest lines see the mode with four points


def test_full_records_and_runs_that_state_no_sweep_are_left_alone() -> None:
    H = np.random.default_rng(1).standard_normal((4, 6, 6)).astype(complex)
    plain = MountedDynamicMass(frequency=np.arange(4) + 5.0, matrix=H)
    for stage in (plain, replace(plain, block=14.5), replace(plain, sweep_rate=0.03)):
        assert FAMILIES["sweep-bias"].change(stage, (), {}) is stage
