"""Full-record spectra, the paper's peak-reference-hold, records that are cut, and the page about them."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.signal import lfilter

from geometry.dynamic_mass import DynamicMass
from geometry.errors import BadInput
from identification.spectra.line_spectra import _folded, full_record
from identification.spectra.peak_hold import applied, lone_mode, model_lines, peak_reference_hold

RATE = 512.0
LINES = np.linspace(4.0, 32.0, 57)


def test_the_spectrum_of_a_decay_is_the_closed_form_of_its_geometric_sum() -> None:
    k, pole = np.arange(4096), -3.0 + 2j * np.pi * 11.3
    z = np.exp(pole / RATE)
    w = np.exp(-2j * np.pi * LINES / RATE)
    series = (1 / (1 - z * w) + 1 / (1 - np.conj(z) * w)) / 2 / RATE  # the record is long enough for what is left to be 4e-11
    found = full_record(np.exp(pole.real * k / RATE) * np.cos(pole.imag * k / RATE), RATE, LINES)
    np.testing.assert_allclose(found, series, rtol=0, atol=1e-9 * np.abs(series).max())


@pytest.mark.parametrize("length", [700, 2900])
@pytest.mark.parametrize(("rate", "folds"), [(RATE, True), (511.7, False)])
def test_even_lines_are_those_of_the_sum_by_the_chirp_or_on_a_folded_record(rate: float, folds: bool, length: int) -> None:
    x = np.random.default_rng(3).standard_normal((length, 2, 3))
    apart = full_record(x, rate, LINES[:2])  # two lines are summed, many even ones are not
    np.testing.assert_allclose(full_record(x, rate, LINES)[:2], apart, rtol=0, atol=1e-12 * np.abs(x).sum() / rate)
    assert (_folded(x.reshape(length, -1), LINES, 0.5, rate) is not None) is folds


def test_a_record_of_any_length_has_the_precision_of_a_short_one() -> None:
    """The chirp's phase grows with the square of the length: a whole sweep must still be right to nine digits."""
    k = np.arange(900_000)
    x = np.cos(2 * np.pi * 17.3 * k / 8192) * np.exp(-k / 9e4)
    found = full_record(x, 8192.0, np.linspace(17.0, 17.6, 13))
    np.testing.assert_allclose(found[[0, 6]], full_record(x, 8192.0, [17.0, 17.3]), rtol=0, atol=1e-8 * np.abs(found).max())


@pytest.mark.parametrize(
    ("signals", "lines", "said"),
    [
        (np.ones(100), [4.0, 300.0], "256 Hz, found 4 to 300 Hz"),
        (np.full(100, np.nan), [4.0], "NaN or infinity"),
        (np.ones(1), [4.0], "found 1 samples"),
    ],
)
def test_what_cannot_be_transformed_is_refused(signals: np.ndarray, lines: list[float], said: str) -> None:
    with pytest.raises(BadInput, match=said):
        full_record(signals, RATE, lines)


HELD_RATE, SIZE = 128.0, 512
STEP = HELD_RATE / SIZE


def sweep(seconds: float = 40.0, low: float = 3.0, high: float = 40.0) -> np.ndarray:
    t = np.arange(int(seconds * HELD_RATE)) / HELD_RATE
    k = np.log(high / low) / seconds
    return np.concatenate([np.zeros(200), np.sin(2 * np.pi * low / k * np.expm1(k * t)), np.zeros(900)])


def test_a_sine_reads_its_amplitude_and_its_phase_against_the_reference() -> None:
    t = np.arange(4000) / HELD_RATE
    reference = 2.0 * np.cos(2 * np.pi * 40 * STEP * t + 0.3)
    signal = 3.0 * np.cos(2 * np.pi * 40 * STEP * t + 0.3 - 0.7)
    found = peak_reference_hold(
        np.column_stack([reference, signal]), HELD_RATE, reference, [40 * STEP], block_size=SIZE, overlap=0.9
    )
    assert_allclose(found[0], [2.0, 3.0 * np.exp(-0.7j)], rtol=1e-10)  # a native line, the window's sum is exact


def test_a_short_delay_is_a_phase_that_interpolation_keeps() -> None:
    """Neighbouring lines come from different blocks: without a reference the interpolation between them destroys them."""
    reference, lines = sweep(), np.arange(5.0, 30.0, 0.05)
    late = np.concatenate([np.zeros(2), reference[:-2]])
    found = peak_reference_hold(np.column_stack([reference, late]), HELD_RATE, reference, lines, block_size=SIZE)
    # blocks move over the sweep: the same delayed block starts two of 512 samples later in the window
    assert_allclose(found[:, 1] / found[:, 0], np.exp(-2j * np.pi * lines * 2 / HELD_RATE), atol=0.02)


def test_a_rigid_model_through_the_same_operator_is_the_spectrum_of_its_load() -> None:
    motion = np.column_stack([sweep() * scale for scale in (1.0, 0.1, 0.0, 0.3, 0.0, 0.02)])
    lines = model_lines(len(motion), HELD_RATE, (0.0, HELD_RATE / 2))
    M = np.diag([40.0, 41.0, 42.0, 1.0, 1.1, 0.7]) + 0.3
    model = DynamicMass(frequency=lines, matrix=np.broadcast_to(M.astype(complex), (len(lines), 6, 6)))
    asked = np.arange(5.0, 30.0, 0.1)
    found = applied(model, motion, HELD_RATE, motion[:, 0], asked, block_size=SIZE)
    expected = peak_reference_hold(motion @ M.T, HELD_RATE, motion[:, 0], asked, block_size=SIZE)
    assert_allclose(found, expected, rtol=0, atol=1e-10 * np.abs(expected).max())


def test_a_mode_through_the_same_operator_is_the_biased_spectrum_that_a_record_has() -> None:
    """A resonator integrated sample by sample against its response function, where H itself is wrong by tens of per cent."""
    pole = np.exp((-0.35 + 2j * np.pi * 12.0) / HELD_RATE)
    b, a = [1.0 - abs(pole) ** 2], [1.0, -2 * pole.real, abs(pole) ** 2]
    drive = sweep()
    load = lfilter(b, a, drive)
    lines, asked = model_lines(len(drive), HELD_RATE, (0.0, HELD_RATE / 2)), np.arange(9.0, 16.0, 0.05)

    def response(f: np.ndarray) -> np.ndarray:
        z = np.exp(-2j * np.pi * f / HELD_RATE)
        return b[0] / (a[0] + a[1] * z + a[2] * z**2)

    matrix = np.zeros((len(lines), 6, 6), dtype=complex)
    matrix[:, 0, 0] = response(lines)
    motion = np.column_stack([drive, *[np.zeros(len(drive))] * 5])
    found = applied(DynamicMass(frequency=lines, matrix=matrix), motion, HELD_RATE, drive, asked, block_size=SIZE)[:, 0]
    recorded = peak_reference_hold(np.column_stack([drive, load]), HELD_RATE, drive, asked, block_size=SIZE)
    peak = np.abs(recorded[:, 1]).max()
    assert_allclose(found, recorded[:, 1], rtol=0, atol=2e-3 * peak)  # e^-5 of the ring-down is left where the record ends
    assert np.abs(response(asked) * recorded[:, 0] - recorded[:, 1]).max() > 0.2 * peak


def test_the_bias_falls_as_damping_grows_and_as_blocks_do(peak_hold_bias: dict[str, Any]) -> None:
    sweep_bias = peak_hold_bias["sweep_bias"]
    lines = np.array([12.25, 12.3, 12.35])
    bias = [sweep_bias(12.3, zeta, frequency=lines, finer=8).error("peak_hold").max() for zeta in (0.0035, 0.0105, 0.035)]
    assert bias[0] > 2 * bias[1] > 4 * bias[2]
    longer = sweep_bias(12.3, 0.0035, frequency=lines, finer=8, block_size=4 * 8192).error("peak_hold").max()
    assert longer < bias[0] / 1.5


def test_a_record_that_ends_early_biases_the_full_record_too(peak_hold_bias: dict[str, Any]) -> None:
    sweep_bias = peak_hold_bias["sweep_bias"]
    lines = np.arange(28.0, 32.0, 0.05)
    whole, cut = (sweep_bias(31.0, 0.0035, frequency=lines, finer=8, ring_down=after) for after in (None, 0.1))
    assert cut.error("full_record").max() > 30 * whole.error("full_record").max()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"block_size": 100_000}, "shorter than a block of 100000"),
        ({"overlap": 1.0}, "an overlap of 1"),
        ({"frequency": [0.1]}, "lines from 0.5 to 64 Hz can be resolved"),
        ({"frequency": [70.0]}, "lines from 0.5 to 64 Hz can be resolved"),
        ({"reference": np.zeros(6220)}, "silent"),
    ],
)
def test_what_cannot_be_held_is_refused(change: dict[str, object], said: str) -> None:
    x = sweep()
    asked: dict[str, object] = {"signals": x[:, None], "rate": HELD_RATE, "reference": x, "frequency": [8.0], "block_size": SIZE}
    with pytest.raises(BadInput, match=said):
        peak_reference_hold(**{**asked, **change})  # type: ignore[arg-type]


def test_a_model_at_other_lines_is_refused() -> None:
    x = sweep()
    model = DynamicMass(frequency=np.array([4.0, 4.05]), matrix=np.zeros((2, 6, 6)))
    with pytest.raises(BadInput, match="model_lines"):
        applied(model, np.tile(x[:, None], 6), HELD_RATE, x, [8.0], block_size=SIZE)


def kept(frequency: float, damping_ratio: float, duration: float) -> complex:
    """1 - exp(lambda T): what is kept of a mode's resonance at the lines k / T of a record of `duration` T [s]."""
    return complex(1 - np.exp((-damping_ratio + 1j) * 2 * np.pi * frequency * duration))


OWN, ZETA, T = 6.5127, 0.00156, 32.0


@pytest.mark.parametrize("line", [204, 208, 212])
def test_a_cut_keeps_of_a_decay_what_is_predicted_the_same_at_all_lines(line: int) -> None:
    omega = 2 * np.pi * OWN
    lam, t = (-ZETA + 1j) * omega, np.linspace(0, T, 400_001)
    at = 2j * np.pi * line / T
    cut = np.trapezoid(np.exp((lam - at) * t), t)
    assert_allclose(cut * (at - lam), kept(OWN, ZETA, T), rtol=0, atol=1e-4)  # the second power of the step


def test_a_decay_that_is_over_is_kept_whole() -> None:
    assert_allclose(kept(OWN, 0.05, T), 1.0, rtol=0, atol=1e-20 + np.exp(-0.05 * 2 * np.pi * OWN * T))


@pytest.mark.parametrize("turn", [-0.3, 0.0, 0.2])
def test_a_mode_is_found_by_itself_with_its_turn_on_top_of_others(turn: float) -> None:
    f = 5.5 + np.arange(0, 2, 1 / 32)
    w, own = 2 * np.pi * f[:, None], 2 * np.pi * OWN
    exact = np.exp(1j * turn) * np.array([0.03, -0.05, 0.1])
    y = exact * w**2 / (w**2 - own**2 - 2j * ZETA * own * w) + np.array([0.2, 0.1j, -0.05])
    found = lone_mode(f, y, near=6.5, damping_ratio=0.004)
    assert found.frequency == pytest.approx(OWN, rel=1e-8)
    assert found.damping_ratio == pytest.approx(ZETA, rel=1e-6)
    assert_allclose(found.residues, exact, rtol=1e-6)
    assert found.turn == pytest.approx(turn, abs=1e-7)


PAGE = Path(__file__).parents[2] / "docs" / "spectra.md"


def test_the_bias_on_the_page_is_the_one_that_is_measured(peak_hold_bias: dict[str, Any]) -> None:
    found = peak_hold_bias["figures"](peak_hold_bias["sweep_bias"](12.3, 0.0035, frequency=peak_hold_bias["LINES"]), 12.3)
    text = PAGE.read_text(encoding="utf-8").replace("\n", " ")
    at, away, largest = (
        float(re.search(pattern, text).group(1)) / 100 for pattern in (r"(\d+) % low", r"about ([\d.]+) %", r"up to ([\d.]+) %")
    )  # type: ignore[union-attr]
    np.testing.assert_allclose(
        [found["peak_hold"][key] for key in ("at", "away", "largest_away")], [at, away, largest], rtol=0.07
    )
    assert found["full_record"]["largest_away"] < 1.2e-5
    assert abs(found["full_record"]["at"]) < 8e-5
