"""Full-record spectra: closed forms, both ways of summing, and what is refused."""

import numpy as np
import pytest

from geometry.errors import BadInput
from identification.spectra.line_spectra import full_record

RATE = 512.0
LINES = np.linspace(4.0, 32.0, 57)


def test_the_spectrum_of_a_decay_is_the_closed_form_of_its_geometric_sum() -> None:
    k, pole = np.arange(4096), -3.0 + 2j * np.pi * 11.3
    z = np.exp(pole / RATE)
    w = np.exp(-2j * np.pi * LINES / RATE)
    series = (1 / (1 - z * w) + 1 / (1 - np.conj(z) * w)) / 2 / RATE  # the record is long enough for what is left to be 4e-11
    found = full_record(np.exp(pole.real * k / RATE) * np.cos(pole.imag * k / RATE), RATE, LINES)
    np.testing.assert_allclose(found, series, rtol=0, atol=1e-9 * np.abs(series).max())


def test_even_lines_by_the_chirp_transform_are_those_of_the_sum() -> None:
    x = np.random.default_rng(3).standard_normal((1000, 2, 3))
    apart = full_record(x, RATE, [4.0, 4.5])  # two lines are summed, many even ones are not
    np.testing.assert_allclose(full_record(x, RATE, LINES)[:2], apart, rtol=0, atol=1e-12 * np.abs(x).sum() / RATE)


def test_lines_need_not_be_even() -> None:
    x = np.random.default_rng(4).standard_normal(500)
    even, some = full_record(x, RATE, LINES), np.array([0, 7, 8, 30])
    np.testing.assert_allclose(full_record(x, RATE, LINES[some]), even[some], rtol=0, atol=1e-12 * np.abs(x).sum() / RATE)


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
