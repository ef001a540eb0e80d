"""One anti-alias filter for all channels: what it passes, what it stops, and that ratios of channels do not notice it."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fem.base_excitation.patterns import Sweep, drawn
from fem.base_excitation.response import (
    LEAST,
    PASS,
    RIPPLE,
    Response,
    decimated,
    pass_band,
    require_recorded,
    simulation_rate,
    taps,
)
from geometry.errors import BadInput

FINE, COARSE = 8192.0, 512.0


def response(signal: np.ndarray, rate: float = FINE) -> Response:
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
    found = decimated(response(signal), COARSE)
    assert found.sampling_rate == COARSE
    assert_allclose(found.table[:, 0], signal[::16], rtol=0, atol=2 * RIPPLE)


@pytest.mark.parametrize("frequency", [260.0, 300.0, 515.0, 700.0, 1033.0, 4000.0])
def test_a_tone_above_the_nyquist_frequency_does_not_fold_back(frequency: float) -> None:
    """Without the filter 512 - 300 Hz would appear in full; what is left is the stated ripple."""
    assert np.abs(tone(frequency)[::16]).max() > 0.5
    found = decimated(response(tone(frequency)), COARSE)
    assert np.abs(found.table[:, 0]).max() < 1.5 * RIPPLE


def test_every_channel_goes_through_the_same_filter() -> None:
    """Also for a frequency in the transition band, where the filter does change it."""
    found = decimated(response(tone(230.0)), COARSE)
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


def test_ratios_of_channels_are_those_of_the_simulation_in_the_pass_band() -> None:
    """A resonance as second channel; the ratio of full-record spectra over the driven band stays to 1e-6."""
    from scipy.signal import lfilter

    drive = Sweep(axis="x", rate=60.0, stop=120.0).motion(FINE, ring_down=4.0).acceleration[:, 0]
    omega, zeta, h = 2 * np.pi * 12.3, 0.03, 1 / FINE
    pole = np.exp((-zeta + 1j * np.sqrt(1 - zeta**2)) * omega * h)
    answer = lfilter([1.0], [1.0, -2 * pole.real, abs(pole) ** 2], drive) * (omega * h) ** 2
    six = np.stack([drive, answer, *np.zeros((4, len(drive)))], axis=1)
    run = Response(sampling_rate=FINE, table=six, cover=six, load=six, cells=np.zeros((len(drive), 0, 3)))
    record = decimated(run, COARSE)
    band = np.linspace(4.0, 120.0, 40)
    ratios = []
    for found in (run, record):
        line = np.exp(-2j * np.pi * np.outer(band, found.time))
        ratios.append((line @ found.table[:, 1]) / (line @ found.table[:, 0]))
    assert_allclose(np.abs(ratios[1] / ratios[0] - 1), 0, atol=1e-6)


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
    run = response(tone(10.0))
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


@pytest.mark.parametrize(("rate", "expected"), [(512.0, 8192.0), (564.0, 8460.0), (8000.0, 8000.0), (10000.0, 10000.0)])
def test_simulations_run_at_8_khz_or_more(rate: float, expected: float) -> None:
    assert simulation_rate(rate) == expected
    assert LEAST == 8000.0


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
        (lambda: decimated(response(tone(9.0)), 0.0), "`rate`: must be positive and finite"),
        (
            lambda: decimated(response(tone(9.0)), 500.0),
            "8192 Hz must be a whole multiple of it, found 500 Hz. Record at 481.88. or 512",
        ),
        (lambda: decimated(response(tone(9.0)), 10000.0), "a whole multiple of it, found 10000 Hz. Record at 8192 Hz or less"),
    ],
)
def test_a_rate_that_cannot_be_is_refused_with_a_way_on(call: Callable[[], object], message: str) -> None:
    with pytest.raises(BadInput, match=message):
        call()
