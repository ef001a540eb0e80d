"""Noise at a line, from quiet parts: white, coloured and tonal, in both kinds of spectra."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.frames import Array
from identification.campaign import Campaign
from identification.spectra import noise
from identification.spectra.line_spectra import full_record
from identification.spectra.of_campaign import spectra
from identification.spectra.peak_hold import hann

RATE, LINES = 256.0, np.arange(6.0, 30.0, 0.5)


def longer(campaign: Campaign, extra: np.ndarray | None = None, seconds: float = 8.0, seed: int = 11) -> Campaign:
    """The campaign with `seconds` of fresh noise behind every run, and `extra` (n,) on the first cover channel."""
    random, recordings = np.random.default_rng(seed), {}
    floors = np.array([channel.noise_rms for channel in campaign.table.channels])
    first = campaign.table.names.index("cover-z1")
    for name, one in campaign.recordings.items():
        values = np.vstack([one.values, floors * random.standard_normal((round(seconds * RATE), len(floors)))])
        if extra is not None:
            values[:, first] += extra[: len(values)]
        recordings[name] = replace(one, values=values)
    return replace(campaign, recordings=recordings)


def test_white_noise_has_the_density_of_its_rms(campaign: Campaign) -> None:
    found = noise.density(longer(campaign))
    stated = np.array([channel.noise_rms for channel in campaign.table.channels])
    inside = (found.frequency > 2) & (found.frequency < 120)
    # some 60 segments and 236 lines: below 2 %
    assert_allclose(found.values[inside].mean(axis=0), stated**2 / RATE, rtol=0.05)


def test_the_noise_of_a_full_record_line_is_the_scatter_of_full_record_lines() -> None:
    record = 0.02 * np.random.default_rng(3).standard_normal((2000, 400))
    lines = full_record(record, RATE, LINES)
    density = np.full((1, len(LINES), 1), 0.02**2 / RATE)
    expected = noise.of_full_record(density, np.array([2000 / RATE]))[0, :, 0]
    # 400 complex samples a line: 2.5 %, four of them
    assert_allclose(np.sqrt(np.mean(np.abs(lines) ** 2, axis=1)), expected, rtol=0.1)


def test_the_noise_of_a_block_is_the_scatter_of_windowed_blocks() -> None:
    window = hann(512)
    blocks = 0.02 * np.random.default_rng(4).standard_normal((512, 1000))
    lines = 2 / window.sum() * np.fft.rfft(blocks * window[:, None], axis=0)[12:60]
    expected = noise.of_block(np.full((1, 48, 1), 0.02**2 / RATE), np.array([RATE]), window)[0, :, 0]
    assert_allclose(np.sqrt(np.mean(np.abs(lines) ** 2, axis=1)), expected, rtol=0.08)


def test_the_spread_of_the_noise_is_that_of_its_estimates(campaign: Campaign) -> None:
    """Thirty silences of two seconds: their powers scatter as each of them says of itself."""
    estimates = [noise.of_lines(longer(campaign, seconds=2.0, seed=seed), LINES) for seed in range(30)]
    stated = np.array([channel.noise_rms for channel in campaign.table.channels]) ** 2 / RATE
    powers = np.array([np.mean(one.density / stated) for one in estimates])
    spread = np.mean([one.spread for one in estimates])
    # 30 estimates of a standard deviation: 13 %, three of them, and what smoothing adds at the ends of the band
    assert_allclose(np.std(powers), spread, rtol=0.5)


def test_the_scatter_of_a_line_is_that_of_its_estimates(campaign: Campaign) -> None:
    """Of one channel and line over thirty silences, averaged over channels and the lines in the middle."""
    estimates = [noise.of_lines(longer(campaign, seconds=2.0, seed=seed), LINES) for seed in range(30)]
    powers = np.stack([one.density[0, 8:-8] for one in estimates])
    scatter = np.sqrt(np.mean(np.var(powers, axis=0) / np.mean(powers, axis=0) ** 2))
    # tops that are cut off take some of it away
    assert_allclose(scatter, np.mean([one.scatter for one in estimates]), rtol=0.25)


def test_longer_silences_tell_the_noise_better(campaign: Campaign) -> None:
    short, long = (noise.of_lines(longer(campaign, seconds=seconds), LINES).spread for seconds in (4.0, 16.0))
    assert_allclose(long / short, 0.5, rtol=0.2)


def test_a_tone_is_seen_at_its_line_and_not_beside_it(campaign: Campaign) -> None:
    """Railway mains, 16.7 Hz, that a broadband floor would spread over all lines."""
    t = np.arange(20 * int(RATE)) / RATE
    found, plain = (
        noise.of_lines(longer(campaign, extra), LINES).density[0] for extra in (0.02 * np.sin(2 * np.pi * 16.5 * t), None)
    )
    k = campaign.table.names.index("cover-z1")
    ratio = found[:, k] / plain[:, k]
    assert ratio[LINES == 16.5].max() > 20
    assert_allclose(np.delete(ratio, np.flatnonzero(np.abs(LINES - 16.5) < 1.1)), 1.0, atol=0.3)
    others = np.delete(found / plain, k, axis=1)
    assert_allclose(others, 1.0, rtol=1e-9)


def test_coloured_noise_is_larger_where_it_is(campaign: Campaign) -> None:
    random = np.random.default_rng(9).standard_normal(20 * int(RATE))
    low = np.convolve(random, np.ones(16) / 16, mode="same") * 0.02  # a first zero at 16 Hz
    found = noise.of_lines(longer(campaign, low), LINES).density[0][:, campaign.table.names.index("cover-z1")]
    white, gain = 0.005**2 / RATE, np.abs(np.sinc(16 * LINES / RATE) / np.sinc(LINES / RATE)) ** 2
    expected = white + 0.02**2 / RATE * gain
    assert_allclose(np.log(found), np.log(expected), atol=0.6)  # smoothed over 2 Hz, where it falls by decades in 10 Hz
    assert found[0] / found[-1] > 5


def test_what_rings_on_the_structure_is_not_noise_of_its_load_cell(campaign: Campaign) -> None:
    whole, k = longer(campaign), campaign.table.names.index("fmd-z1")
    one = whole.recordings["x"]
    values = one.values.copy()
    t = np.arange(len(values)) / RATE
    values[t > 5, k] += 20 * np.cos(2 * np.pi * 12 * t[t > 5])
    ringing = replace(whole, recordings={**whole.recordings, "x": replace(one, values=values)})
    found, plain = (noise.of_lines(made, LINES).density[0, :, k] for made in (ringing, whole))
    assert_allclose(found, plain, rtol=0.5)  # a run less: other noise


def changed(campaign: Campaign, change: Callable[[Array], Array], stated: bool = True) -> Campaign:
    """The campaign with the samples of every run changed, without floors in its table unless `stated`."""
    channels = tuple(one if stated else replace(one, noise_rms=None) for one in campaign.table.channels)
    recordings = {name: replace(one, values=change(one.values)) for name, one in campaign.recordings.items()}
    return replace(campaign, table=replace(campaign.table, channels=channels), recordings=recordings)


def quietless(campaign: Campaign) -> Campaign:
    return changed(campaign, lambda values: values[300:1200])


def test_without_a_quiet_part_the_stated_floor_is_spread_evenly(campaign: Campaign) -> None:
    found = noise.of_lines(quietless(campaign), LINES)
    assert found.spread == found.scatter == 0.0  # it is no estimate
    stated = np.array([channel.noise_rms for channel in campaign.table.channels])
    assert_allclose(found.density, np.broadcast_to(stated**2 / RATE, found.density.shape))
    assert found.unknown == ()


@pytest.mark.parametrize(("silent", "said"), [(("cover-z1", "fmd-x12"), "cover-z1, fmd-x12"), (None, "all channels")])
def test_unknown_noise_counts_as_zero_and_is_said(campaign: Campaign, silent: tuple[str, ...] | None, said: str) -> None:
    mute = campaign.table.names if silent is None else silent
    channels = tuple(replace(one, noise_rms=None) if one.name in mute else one for one in campaign.table.channels)
    made = spectra(replace(quietless(campaign), table=replace(campaign.table, channels=channels)), frequency=LINES)
    zero = [name for name, column in zip(campaign.table.names, np.moveaxis(made.noise, 2, 0), strict=True) if not column.any()]
    assert zero == list(mute)
    assert any(f"the noise of {said} is not known" in text for text in made.warnings)


def test_rounding_is_not_taken_for_noise(campaign: Campaign) -> None:
    def exact(values: Array) -> Array:
        quiet = np.r_[0:256, 1280:1536]
        values = values.copy()
        values[quiet] = 1e-15 * np.random.default_rng(0).standard_normal((512, values.shape[1]))
        return values

    assert not spectra(changed(campaign, exact, stated=False), frequency=LINES).noise.any()
