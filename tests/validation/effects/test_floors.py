"""How much noise is expected: equations against noise and hum in time."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from validation.effects.catalogue import FAMILIES
from validation.effects.stages import NEAREST, NoiseModel, leak

RATE, DURATION = 512.0, 8.0
CHANNELS = ("cover-z3", "fmd-z1")


def full_record(signal: np.ndarray, frequency: np.ndarray) -> np.ndarray:
    """Spectra per Hz of records (..., n) at the lines `frequency` (m,)."""
    t = np.arange(signal.shape[-1]) / RATE
    return signal @ np.exp(-2j * np.pi * np.outer(t, frequency)) / RATE


def floor(frequency: np.ndarray, deviation: float, **more: np.ndarray) -> NoiseModel:
    return NoiseModel(
        frequency=frequency,
        channels=CHANNELS,
        quantities=("acceleration", "force"),
        deviation=np.full((len(frequency), 2), deviation),
        per_rms=np.full(2, np.sqrt(DURATION / RATE)),
        **more,
    )


def test_a_channel_with_more_noise_scatters_by_both_together() -> None:
    rng, f = np.random.default_rng(4), np.array([5.0, 11.3, 27.7])
    own, more, records = 0.03, 0.04, 1200
    before = floor(f, own * np.sqrt(DURATION / RATE))
    after = FAMILIES["noise"].change(before, ("cover-z3",), {"": more})
    n = round(DURATION * RATE)
    lines = full_record(own * rng.standard_normal((records, n)) + more * rng.standard_normal((records, n)), f)
    found = np.sqrt(np.mean(np.abs(lines) ** 2, axis=0))
    assert_allclose(found, after.deviation[:, 0], rtol=4 / np.sqrt(2 * records))  # four standard deviations
    assert_allclose(after.deviation[:, 1], before.deviation[:, 1])


def test_hum_leaks_into_a_record_that_cuts_it_anywhere() -> None:
    rng, f = np.random.default_rng(5), np.array([8.0, 20.1, 31.9])
    records = 1500
    mains, phase = 50 + 0.1 * rng.standard_normal((records, 1)), rng.uniform(0, 2 * np.pi, (records, 1))
    t = np.arange(round(DURATION * RATE)) / RATE
    lines = full_record(np.sin(2 * np.pi * mains * t + phase), f)
    found = np.sqrt(np.mean(np.abs(lines) ** 2, axis=0))
    # The mirror at -50 Hz adds (|f - 50| / (f + 50))² at most, half of it at random phases.
    assert_allclose(found, leak(f), rtol=0.5 * (42 / 58) ** 2 + 4 / np.sqrt(2 * records))
    assert_allclose(found[2], leak(f)[2], rtol=0.5 * (18.1 / 81.9) ** 2 + 4 / np.sqrt(2 * records))


@pytest.mark.parametrize("factor", [0.0, 0.5, 1.0, 7.0])
def test_a_factor_on_the_hum_adds_or_takes_what_is_its_share(factor: float) -> None:
    f = np.array([10.0, 30.0])
    hum = np.outer(leak(f), [0.003, 0.2])
    before = floor(f, 1e-4, hum=hum)
    after = FAMILIES["mains"].change(before, (), {"": factor})
    expected = before.deviation**2 + (factor**2 - 1) * hum**2
    kept = expected > (min(factor, 1.0) * before.deviation) ** 2
    assert_allclose(after.deviation[kept] ** 2, expected[kept], rtol=1e-12)
    assert np.all(after.deviation >= min(factor, 1.0) * before.deviation * (1 - 1e-12))
    assert_allclose(after.hum, factor * hum)


def test_where_the_hum_is_not_known_nothing_changes_and_on_the_mains_nothing_is_infinite() -> None:
    unknown = floor(np.array([10.0]), 1e-4)
    assert FAMILIES["mains"].change(unknown, (), {"": 9.0}) is unknown
    assert leak(np.array([50.0]))[0] == pytest.approx(leak(np.array([50.0 + NEAREST]))[0])
