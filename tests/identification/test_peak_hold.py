"""Peak-reference-hold: amplitudes, phases, the same operator on a model, and its bias at a lightly damped mode."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.signal import lfilter

from geometry.dynamic_mass import DynamicMass
from geometry.errors import BadInput
from identification.spectra.peak_hold import applied, model_lines, peak_reference_hold, sweep_bias

RATE, SIZE = 128.0, 512
STEP = RATE / SIZE


def sweep(seconds: float = 40.0, low: float = 3.0, high: float = 40.0) -> np.ndarray:
    t = np.arange(int(seconds * RATE)) / RATE
    k = np.log(high / low) / seconds
    return np.concatenate([np.zeros(200), np.sin(2 * np.pi * low / k * np.expm1(k * t)), np.zeros(900)])


def test_a_sine_reads_its_amplitude_and_its_phase_against_the_reference() -> None:
    t = np.arange(4000) / RATE
    reference = 2.0 * np.cos(2 * np.pi * 40 * STEP * t + 0.3)
    signal = 3.0 * np.cos(2 * np.pi * 40 * STEP * t + 0.3 - 0.7)
    found = peak_reference_hold(np.column_stack([reference, signal]), RATE, reference, [40 * STEP], block_size=SIZE, overlap=0.9)
    assert_allclose(found[0], [2.0, 3.0 * np.exp(-0.7j)], rtol=1e-10)  # a native line, the window's sum is exact


def test_what_is_proportional_to_the_reference_stays_so_at_every_line() -> None:
    reference = sweep()
    lines = np.arange(4.0, 35.0, 0.05)  # between native lines, too
    found = peak_reference_hold(np.column_stack([reference, -1.7 * reference]), RATE, reference, lines, block_size=SIZE)
    assert_allclose(found[:, 1] / found[:, 0], -1.7, rtol=1e-12)
    assert np.all(found[:, 0].real > 0)


def test_a_short_delay_is_a_phase_that_interpolation_keeps() -> None:
    """Neighbouring lines come from different blocks: without a reference the interpolation between them destroys them."""
    reference, lines = sweep(), np.arange(5.0, 30.0, 0.05)
    late = np.concatenate([np.zeros(2), reference[:-2]])
    found = peak_reference_hold(np.column_stack([reference, late]), RATE, reference, lines, block_size=SIZE)
    # blocks move over the sweep: the same delayed block starts two of 512 samples later in the window
    assert_allclose(found[:, 1] / found[:, 0], np.exp(-2j * np.pi * lines * 2 / RATE), atol=0.02)


def test_a_rigid_model_through_the_same_operator_is_the_spectrum_of_its_load() -> None:
    motion = np.column_stack([sweep() * scale for scale in (1.0, 0.1, 0.0, 0.3, 0.0, 0.02)])
    lines = model_lines(len(motion), RATE, (0.0, RATE / 2))
    M = np.diag([40.0, 41.0, 42.0, 1.0, 1.1, 0.7]) + 0.3
    model = DynamicMass(frequency=lines, matrix=np.broadcast_to(M.astype(complex), (len(lines), 6, 6)))
    asked = np.arange(5.0, 30.0, 0.1)
    found = applied(model, motion, RATE, motion[:, 0], asked, block_size=SIZE)
    expected = peak_reference_hold(motion @ M.T, RATE, motion[:, 0], asked, block_size=SIZE)
    assert_allclose(found, expected, rtol=0, atol=1e-10 * np.abs(expected).max())


def test_a_mode_through_the_same_operator_is_the_biased_spectrum_that_a_record_has() -> None:
    """A resonator integrated sample by sample against its response function, where H itself is wrong by tens of per cent."""
    pole = np.exp((-0.35 + 2j * np.pi * 12.0) / RATE)
    b, a = [1.0 - abs(pole) ** 2], [1.0, -2 * pole.real, abs(pole) ** 2]
    drive = sweep()
    load = lfilter(b, a, drive)
    lines, asked = model_lines(len(drive), RATE, (0.0, RATE / 2)), np.arange(9.0, 16.0, 0.05)

    def response(f: np.ndarray) -> np.ndarray:
        z = np.exp(-2j * np.pi * f / RATE)
        return b[0] / (a[0] + a[1] * z + a[2] * z**2)

    matrix = np.zeros((len(lines), 6, 6), dtype=complex)
    matrix[:, 0, 0] = response(lines)
    motion = np.column_stack([drive, *[np.zeros(len(drive))] * 5])
    found = applied(DynamicMass(frequency=lines, matrix=matrix), motion, RATE, drive, asked, block_size=SIZE)[:, 0]
    recorded = peak_reference_hold(np.column_stack([drive, load]), RATE, drive, asked, block_size=SIZE)
    peak = np.abs(recorded[:, 1]).max()
    assert_allclose(found, recorded[:, 1], rtol=0, atol=2e-3 * peak)  # e^-5 of the ring-down is left where the record ends
    assert np.abs(response(asked) * recorded[:, 0] - recorded[:, 1]).max() > 0.2 * peak


def test_the_bias_at_a_resonance_of_a_third_of_a_per_cent_is_tens_of_per_cent_and_the_full_record_has_none() -> None:
    """`physics.md`: up to 44 % at the resonance, 0.03 % elsewhere; the full record 0.008 %."""
    frequency = 4 + 0.05 * np.arange(561)
    found = sweep_bias(12.3, 0.0035, frequency=frequency)
    hold, full = found.error("peak_hold"), found.error("full_record")
    at, far = np.argmin(np.abs(frequency - 12.3)), np.abs(frequency / 12.3 - 1) > 0.1
    assert 0.3 < hold[at] < 0.6
    assert hold[at] == hold.max()
    assert 1e-4 < np.median(hold[far]) < 1e-3
    assert full.max() < 8e-5


def test_the_bias_falls_as_damping_grows_and_as_blocks_do() -> None:
    lines = np.array([12.25, 12.3, 12.35])
    bias = [sweep_bias(12.3, zeta, frequency=lines, finer=8).error("peak_hold").max() for zeta in (0.0035, 0.0105, 0.035)]
    assert bias[0] > 2 * bias[1] > 4 * bias[2]
    longer = sweep_bias(12.3, 0.0035, frequency=lines, finer=8, block_size=4 * 8192).error("peak_hold").max()
    assert longer < bias[0] / 1.5


def test_a_record_that_ends_early_biases_the_full_record_too() -> None:
    lines = np.arange(28.0, 32.0, 0.05)
    whole, cut = (sweep_bias(31.0, 0.0035, frequency=lines, finer=8, ring_down=after) for after in (None, 0.1))
    assert cut.error("full_record").max() > 30 * whole.error("full_record").max()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"block_size": 100_000}, "shorter than a block of 100000"),
        ({"overlap": 1.0}, "an overlap of 1"),
        ({"frequency": [0.1]}, "lines from 0.5 to 64 Hz can be told"),
        ({"frequency": [70.0]}, "lines from 0.5 to 64 Hz can be told"),
        ({"reference": np.zeros(6220)}, "silent"),
    ],
)
def test_what_cannot_be_held_is_refused(change: dict[str, object], said: str) -> None:
    x = sweep()
    asked: dict[str, object] = {"signals": x[:, None], "rate": RATE, "reference": x, "frequency": [8.0], "block_size": SIZE}
    with pytest.raises(BadInput, match=said):
        peak_reference_hold(**{**asked, **change})  # type: ignore[arg-type]


def test_a_model_at_other_lines_is_refused() -> None:
    x = sweep()
    model = DynamicMass(frequency=np.array([4.0, 4.05]), matrix=np.zeros((2, 6, 6)))
    with pytest.raises(BadInput, match="model_lines"):
        applied(model, np.tile(x[:, None], 6), RATE, x, [8.0], block_size=SIZE)
