"""Clipping is told from rounding, and dead or impossible channels are refused."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from geometry.errors import BadInput
from identification import campaign_file

RATE = 564.0
T = np.arange(4000) / RATE


def sine(frequency: float, level: float = 1.0) -> np.ndarray:
    return level * np.sin(2 * np.pi * frequency * T + 0.3)


@pytest.mark.parametrize("frequency", [4.0, 12.0, 32.0])
@pytest.mark.parametrize("share", [0.5, 0.8])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_sine_cut_off_on_one_side_is_clipped(frequency: float, share: float, sign: float) -> None:
    cut = sign * np.minimum(sine(frequency), share)
    at_top = int(np.sum(sign * cut == share))
    found = campaign_file.clipped(cut)
    assert 0.8 * at_top < found <= at_top


@pytest.mark.parametrize("frequency", [4.0, 12.0, 32.0])
@pytest.mark.parametrize("bits", [6, 8, 12, 16])
def test_rounding_to_the_steps_of_a_converter_is_not_clipping(frequency: float, bits: int) -> None:
    step = 2.0 ** (1 - bits)
    assert campaign_file.clipped(np.round(sine(frequency) / step) * step) == 0


def test_a_clipped_and_rounded_signal_is_clipped() -> None:
    step = 2.0**-11
    assert campaign_file.clipped(np.round(np.clip(sine(8.0), -0.7, 0.7) / step) * step) > 100


def test_noise_and_rests_are_not_clipped() -> None:
    generator = np.random.default_rng(7)
    assert campaign_file.clipped(generator.standard_normal(4000)) == 0
    assert campaign_file.clipped(np.concatenate([np.zeros(500), sine(8.0), np.zeros(500)])) == 0


@given(st.floats(1e-9, 1e9))
def test_the_verdict_does_not_depend_on_the_unit(scale: float) -> None:
    assert campaign_file.clipped(scale * np.minimum(sine(8.0), 0.7)) == campaign_file.clipped(np.minimum(sine(8.0), 0.7))


@pytest.mark.parametrize("value", [0.0, -3.5, 1 + 1j])
def test_a_constant_channel_is_dead(value: complex) -> None:
    with pytest.raises(BadInput, match="is dead"):
        campaign_file.require_alive(np.full(10, value), "a", "run.h5")


@pytest.mark.parametrize(
    ("bad", "word"), [(np.nan, "NaN"), (np.inf, "infinite"), (-np.inf, "infinite"), (1e20, "no sensor reads")]
)
def test_impossible_samples_are_refused_with_their_place(bad: float, word: str) -> None:
    samples = sine(4.0)
    samples[41] = bad
    with pytest.raises(BadInput, match=word) as refused:
        campaign_file.require_finite(samples, "cover-z1", "run.h5")
    assert (refused.value.field, refused.value.source) == ("cover-z1", "run.h5")
    assert "number 42 of 4000" in refused.value.problem
