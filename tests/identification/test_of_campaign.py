"""From a campaign to spectra: one grid of lines, noise from quiet parts, and what is refused."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from geometry.frames import Array
from geometry.inertia import Inertia
from identification import campaign_file
from identification.base_motion import base_motion, resultants
from identification.campaign import Campaign, Processing, Recording
from identification.dynamic_mass import from_runs
from identification.spectra import noise
from identification.spectra.line_spectra import full_record, hann
from identification.spectra.of_campaign import reference_channel, spectra

BLOCK = Inertia.from_cog(mass=41.0, cog=np.array([0.0, 0.0, 0.1]), tensor=np.diag([0.9, 0.95, 0.75]))
"""That of examples/own_campaign.py."""


def altered(campaign: Campaign, change: Callable[[np.ndarray], np.ndarray], only: str = "") -> Campaign:
    """The campaign with the samples of its runs (or of one run) changed."""
    recordings = {
        name: replace(one, values=change(one.values.copy())) if only in ("", name) else one
        for name, one in campaign.recordings.items()
    }
    return replace(campaign, recordings=recordings)


def test_a_rigid_block_on_the_table_is_found_from_its_spectra(campaign: Campaign) -> None:
    made = spectra(campaign, band=(5.0, 31.0))
    motion, loads = base_motion(made), resultants(made)
    found = from_runs(loads.values, motion.values, made.frequency).dynamic_mass.matrix
    M = BLOCK.mass_matrix
    scale = np.sqrt(np.outer(np.diag(M), np.diag(M)))
    # lines lie closer than 1/T: of 521 about 160 are independent
    deviation = np.abs(found.mean(axis=0) - M) / (found.std(axis=0) / np.sqrt(160))
    assert deviation.max() < 4
    assert np.abs(found.mean(axis=0) - M).max() < 5e-3 * scale.max()
    assert np.median(motion.sigmas) == pytest.approx(1.0, abs=0.1)
    assert np.median(loads.sigmas) == pytest.approx(1.0, abs=0.1)
    assert made.quality.min() > 0.98
    assert not made.warnings


def test_the_lines_are_those_of_the_processing_and_of_the_band(campaign: Campaign) -> None:
    assert_allclose(spectra(campaign).frequency, np.linspace(4, 32, 561), rtol=1e-12)
    stated = replace(campaign, processing=Processing(start=5.0, stop=10.0, step=0.5))
    assert_allclose(spectra(stated).frequency, np.arange(5, 10.1, 0.5), rtol=1e-12)
    assert_allclose(spectra(stated, band=(6.0, 8.0)).frequency, [6.0, 6.5, 7.0, 7.5, 8.0], rtol=1e-12)
    assert_allclose(spectra(campaign, frequency=[7.0, 7.7]).frequency, [7.0, 7.7])


def test_offset_and_drift_do_not_leak_into_lines(campaign: Campaign) -> None:
    clean = spectra(campaign)
    n = len(next(iter(campaign.recordings.values())))
    ramp = np.linspace(0.0, 3.0, n)[:, None]
    leaking = altered(campaign, lambda x: x + 5.0 + ramp)
    assert_allclose(spectra(leaking).values, clean.values, rtol=0, atol=1e-11)
    one = leaking.recordings["x"]
    plain = full_record(one.values, 256.0, clean.frequency)
    # what would have leaked: up to D/(pi f) of an offset of 6.5
    assert 0.1 < np.abs(plain - clean.values[0]).max() < 6.5 / (np.pi * 4) * 1.1


def test_the_straight_line_costs_a_sweep_next_to_nothing(campaign: Campaign) -> None:
    """The paper's sweep: 2 octaves a minute, 90 s; what it has at 0 Hz is taken for an offset."""
    rate, k = 128.0, np.log(2) / 30
    t = np.arange(int(90 * rate)) / rate
    drive = np.concatenate([np.zeros(128), np.sin(2 * np.pi * 4 / k * np.expm1(k * t)), np.zeros(512)])
    record = Recording(names=campaign.table.names, values=np.tile(drive[:, None], len(campaign.table)), sampling_rate=rate)
    made = spectra(replace(campaign, recordings=dict.fromkeys(campaign.recordings, record)), band=(4.0, 31.5))
    lost = np.abs(made.values[0, :, 0] / full_record(drive, rate, made.frequency) - 1)
    assert np.median(lost) < 3e-5
    assert lost.max() < 3e-4  # at 4 Hz, where the sweep starts


def test_a_record_cut_before_the_ring_down_is_said_with_run_and_channel(campaign: Campaign) -> None:
    cut = replace(campaign.recordings["beta"], values=campaign.recordings["beta"].values[:-300])
    made = spectra(replace(campaign, recordings={**campaign.recordings, "beta": cut}))
    said = [text for text in made.warnings if "ends before the ring-down" in text]
    assert len(said) == 1
    assert "run beta" in said[0]
    assert "Record longer" in said[0]


def test_ringing_of_one_channel_at_the_end_is_named(campaign: Campaign) -> None:
    k = campaign.table.names.index("fmd-z3")
    t = np.arange(1536) / 256

    def ring(x: np.ndarray) -> np.ndarray:
        x[:, k] += 10 * np.where(t > 5, np.cos(2 * np.pi * 12 * t), 0)
        return x

    said = [text for text in spectra(altered(campaign, ring, "y")).warnings if "ends before" in text]
    assert len(said) == 1
    assert "fmd-z3 at" in said[0]
    assert "cover" not in said[0]


def test_a_record_that_begins_in_motion_is_said_and_one_that_begins_with_the_drive_is_not(campaign: Campaign) -> None:
    middle = replace(campaign.recordings["z"], values=campaign.recordings["z"].values[400:])
    made = spectra(replace(campaign, recordings={**campaign.recordings, "z": middle}))
    said = [text for text in made.warnings if "begins in motion" in text]
    assert len(said) == 1
    assert "run z" in said[0]
    at_once = {name: replace(one, values=one.values[256:]) for name, one in campaign.recordings.items()}
    assert not [text for text in spectra(replace(campaign, recordings=at_once)).warnings if "begins in motion" in text]


def test_lines_beyond_the_sweep_are_said(campaign: Campaign) -> None:
    said = spectra(campaign, frequency=np.arange(2.0, 40.0)).warnings
    assert any("beyond what was driven in x (4 to 32 Hz)" in text for text in said)


def as_spectra(campaign: Campaign, lines: np.ndarray) -> Campaign:
    """The same campaign as files that hold spectra."""
    made = spectra(campaign, frequency=lines)
    recordings = {
        run: Recording(names=campaign.table.names, values=made.values[k], frequency=lines, source=f"{run}.h5")
        for k, run in enumerate(made.runs)
    }
    return replace(campaign, recordings=recordings)


def test_spectra_in_files_stay_as_they_are(campaign: Campaign, tmp_path) -> None:  # type: ignore[no-untyped-def]
    lines = np.linspace(4, 32, 57)
    campaign_file.write(tmp_path / "spectra", as_spectra(campaign, lines))
    found = spectra(campaign_file.read(tmp_path / "spectra"), band=(5.0, 20.0))
    assert found.method == "spectra"
    assert_allclose(found.frequency, lines[(lines >= 5) & (lines <= 20)], rtol=1e-12)
    assert_allclose(found.values, spectra(campaign, frequency=found.frequency).values, rtol=0, atol=1e-9)
    assert "told from redundant channels" in found.warnings[-1]
    rests = spectra(campaign, frequency=found.frequency).noise.mean(axis=1)
    assert_allclose(np.median(found.noise.mean(axis=1) / rests), 1.0, atol=0.5)  # 31 lines, half a hertz apart: an upper bound
    assert found.quality.min() > 0.98


def test_a_spectrum_may_be_the_same_at_all_lines_but_not_nothing(campaign: Campaign, tmp_path: Path) -> None:
    """What all is divided by, the base's own accelerometer, is 1 everywhere; it had been refused as dead."""
    held, name = as_spectra(campaign, np.linspace(4, 32, 57)), campaign.table.names[0]
    for level in (1.0, 0.0):
        for one in held.recordings.values():
            values = np.array(one.values)
            values[:, 0] = level
            object.__setattr__(one, "values", values)
        campaign_file.write(tmp_path / f"{level}", held)
    assert not campaign_file.examine(tmp_path / "1.0").problems
    assert {(one.field, "is dead" in str(one)) for one in campaign_file.examine(tmp_path / "0.0").problems} == {(name, True)}


def test_noise_of_spectra_without_redundant_channels_is_told_over_the_base(campaign: Campaign) -> None:
    """A sound panel on one axis of a shaker was unknown: the noise of its spectra counted as 0."""
    lines, rng = np.arange(5.0, 300.0), np.random.default_rng(4)
    made = spectra(campaign, frequency=np.linspace(5, 30, len(lines)))
    below = list(made.table.select(group="table", quantity="acceleration"))
    functions = np.ones((1, len(lines), len(made.table.channels)), dtype=complex)
    for k in range(functions.shape[2]):
        functions[0, :, k] += k / (1 - (lines / (40 + 35 * k)) ** 2 + 0.02j)
    functions[0, :, below] = 1.0
    clean = 3.0 * np.exp(0.7j * lines)[None, :, None] * functions
    sd = np.hypot(2e-3 * np.abs(clean), 2e-3)
    added = rng.standard_normal((*clean.shape, 2)) @ np.array([1, 1j]) / np.sqrt(2)
    quality, one = np.ones((1, len(lines))), {"runs": made.runs[:1], "axes": made.axes[:1]}
    some = replace(made, frequency=lines, values=clean + sd * added, noise=0 * sd, quality=quality, **one)
    untold = np.arange(functions.shape[2]) != len(made.table.channels) - 1
    ratio = np.median(noise.over_a_reference(some, untold) / sd, axis=1)[0]
    assert ratio[untold].min() > 0.7
    assert ratio[untold].max() < 2.0
    assert not ratio[~untold].any()
    smooth = np.ones(clean.shape, dtype=complex)
    smooth[:, :, 0] = 0.0  # what nothing moves, without noise: infinity times nothing had been warned of
    with np.errstate(invalid="raise"):
        assert not noise.over_a_reference(replace(some, values=smooth), untold).any()


@pytest.mark.parametrize("share", [0.0, 3e-3])
def test_noise_that_goes_with_what_is_read_is_told_at_resonances_and_noise_of_one_level_stays(campaign: Campaign, share) -> None:
    """A sound stack on a table was unknown: at its resonances noise was up to a hundred times what redundant channels tell."""
    lines, rng, level = np.arange(15.0, 140.0, 0.2), np.random.default_rng(5), 5e-3
    made = spectra(campaign, frequency=np.linspace(5, 30, len(lines)))
    runs, n, channels = 2, len(lines), len(made.table.channels)
    of_article = [c for c in range(channels) if c not in made.table.select(group="table")]
    functions = rng.uniform(0.2, 1.0, (runs, 1, channels)) * np.ones((runs, n, channels), dtype=complex)
    for k in of_article:
        functions[:, :, k] += 0.7 / (1 - (lines / (40 + 10 * k)) ** 2 + 0.02j)
    clean = 3.0 * np.exp(0.7j * lines)[None, :, None] * functions
    sd = np.hypot(share * np.abs(clean), level)
    added = rng.standard_normal((*clean.shape, 2)) @ np.array([1, 1j]) / np.sqrt(2)
    some = replace(
        made,
        frequency=lines,
        values=clean + sd * added,
        noise=0 * sd,
        quality=np.ones((runs, n)),
        runs=made.runs[:runs],
        axes=made.axes[:runs],
    )
    told = np.full(clean.shape, level)
    found = noise.with_reading(some, told)
    if not share:
        assert found is told
    else:
        assert sd.max() > 10 * level
        assert_allclose(found / sd, 1.0, atol=0.15)
    some_told = told * (np.arange(channels) != made.table.select(quantity="acceleration")[0])
    assert noise.with_reading(some, some_told) is some_told  # an accelerometer of which nothing is known


@pytest.mark.parametrize(
    ("lacking", "said"),
    [
        (("table-x", "table-y", "table-z2", "table-z3", "cover", "fmd-y", "fmd-z"), "from: that of all channels is told"),
        (("fmd-y23", "fmd-z4"), "that of acceleration is told from redundant channels, that of other channels is told from"),
    ],
)
def test_whose_noise_is_told_over_the_base_is_said(lacking: tuple[str, ...], said: str, campaign: Campaign) -> None:
    held = as_spectra(campaign, np.linspace(4, 32, 57))
    kept = [k for k, one in enumerate(held.table.channels) if not one.name.startswith(lacking)]
    table = replace(held.table, channels=tuple(held.table.channels[k] for k in kept))
    some = {run: replace(one, names=table.names, values=one.values[:, kept]) for run, one in held.recordings.items()}
    assert said in spectra(replace(held, table=table, recordings=some)).warnings[-1]


def test_spectra_in_files_are_not_interpolated(campaign: Campaign) -> None:
    held = as_spectra(campaign, np.linspace(4, 32, 57))
    assert len(spectra(held, frequency=[5.0, 5.5]).frequency) == 2
    with pytest.raises(BadInput, match="do not hold the lines asked for"):
        spectra(held, frequency=[5.0, 5.25])


def test_runs_that_do_not_fit_each_other_are_refused(campaign: Campaign) -> None:
    held = as_spectra(campaign, np.linspace(4, 32, 57))
    mixed = replace(campaign, recordings={**campaign.recordings, "z": held.recordings["z"]})
    with pytest.raises(BadInput, match=r"z\.h5 hold spectra, the others time histories"):
        spectra(mixed)
    other = as_spectra(campaign, np.linspace(4, 32, 29))
    with pytest.raises(BadInput, match="has other lines than x"):
        spectra(replace(held, recordings={**held.recordings, "z": other.recordings["z"]}))


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"method": "welch"}, "Choose one of full-record, peak-reference-hold"),
        ({"band": (40.0, 50.0)}, "holds none of the lines from 4 to 32 Hz"),
        ({"band": (20.0, 10.0)}, "lowest frequency first"),
        ({"frequency": [5.0, 4.0]}, "lines must ascend"),
        ({"frequency": [5.0, 200.0]}, "half the sampling rate, 128 Hz"),
        ({"method": "peak-reference-hold"}, "1536 samples is shorter than a block of 8192"),
    ],
)
def test_what_cannot_be_done_is_refused(campaign: Campaign, asked: dict[str, object], said: str) -> None:
    with pytest.raises(BadInput, match=said):
        spectra(campaign, **asked)  # type: ignore[arg-type]


def test_a_description_without_recordings_is_refused(campaign: Campaign) -> None:
    with pytest.raises(BadInput, match="the runs x, y, z, alpha, beta, gamma have no recording"):
        spectra(replace(campaign, recordings={}))


def test_peak_reference_hold_is_made_with_the_pilot_of_the_driven_axis(campaign: Campaign) -> None:
    small = replace(campaign, processing=Processing(block_size=256, start=6.0, stop=30.0, step=0.5))
    made = spectra(small, method="peak-reference-hold")
    assert made.method == "peak-reference-hold"
    assert "reference of each run: x by table-x1, y by table-y1, z by table-z1" in made.warnings[0]
    pilot = campaign.table.names.index("table-x1")
    assert_allclose(made.values[0, :, pilot].imag, 0, atol=1e-12)
    other = spectra(small, method="peak-reference-hold", reference="cover-z1")
    assert_allclose(other.values[0, :, campaign.table.names.index("cover-z1")].imag, 0, atol=1e-12)
    with pytest.raises(BadInput, match="no such channel"):
        spectra(small, method="peak-reference-hold", reference="cover-z9")


def test_the_pilot_is_the_reference_that_sees_most_of_the_axis(campaign: Campaign) -> None:
    chosen = {run.name: reference_channel(campaign.table, run, campaign.recordings[run.name]) for run in campaign.runs}
    # z1 is 0.25 m off along x, z2 and z3 are 0.22 m off along y; y1 and y2 0.25 m off z
    assert chosen["beta"] == "table-z1"
    assert chosen["alpha"] in ("table-z2", "table-z3")
    assert chosen["gamma"] in ("table-x1", "table-y1", "table-y2")
    pattern = replace(campaign.runs[0], axis="")
    assert reference_channel(campaign.table, pattern, campaign.recordings["z"]).startswith("table-z")


def test_progress_reaches_the_end(campaign: Campaign) -> None:
    seen: list[float] = []
    spectra(campaign, progress=seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0


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
    found, _ = noise.densities(longer(campaign))
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


def test_the_spread_of_the_noise_and_the_scatter_of_a_line_are_those_of_their_estimates(campaign: Campaign) -> None:
    """Thirty silences of two seconds scatter as each says of itself: all lines together, and one channel and line on average."""
    estimates = [noise.of_lines(longer(campaign, seconds=2.0, seed=seed), LINES) for seed in range(30)]
    stated = np.array([channel.noise_rms for channel in campaign.table.channels]) ** 2 / RATE
    powers = np.array([np.mean(one.density / stated) for one in estimates])
    # 30 estimates of a standard deviation: 13 %, three of them, and what smoothing adds at the ends of the band
    assert_allclose(np.std(powers), np.mean([one.spread for one in estimates]), rtol=0.5)
    lines = np.stack([one.density[0, 8:-8] for one in estimates])
    scatter = np.sqrt(np.mean(np.var(lines, axis=0) / np.mean(lines, axis=0) ** 2))
    # tops that are cut off take some of it away
    assert_allclose(scatter, np.mean([one.scatter for one in estimates]), rtol=0.25)


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


def test_a_run_recorded_in_a_wider_range_has_the_noise_of_its_own_and_neither_begins_nor_ends_in_motion(
    campaign: Campaign,
) -> None:
    whole, random = longer(campaign), np.random.default_rng(5)
    stated = np.array([channel.noise_rms for channel in campaign.table.channels])
    one = whole.recordings["x"]
    loud = replace(one, values=one.values + 3 * stated * random.standard_normal(one.values.shape))
    made = replace(whole, recordings={**whole.recordings, "x": loud})
    found = noise.of_lines(made, LINES)
    ranges = np.where([run.name == "x" for run in made.runs], 10.0, 1.0)  # of power: 1 and 3 squared
    # four segments of 2 s of one run, seventeen lines of each: 12 %, three of them, and the worst of 22 channels
    assert_allclose(found.density.mean(axis=1), ranges[:, None] * stated**2 / RATE, rtol=0.5)
    assert_allclose(found.floors, np.sqrt(ranges)[:, None] * stated, rtol=0.1)
    assert not [said for said in spectra(made).warnings if "motion" in said or "ring-down" in said]


def test_a_run_that_was_recorded_faster_has_the_noise_of_its_own(campaign: Campaign) -> None:
    """Its recorder's noise lies over four times the band: by that of the others it had four times its power."""
    whole = longer(campaign)
    one = whole.recordings[whole.runs[-1].name]
    made = replace(whole, recordings={**whole.recordings, whole.runs[-1].name: replace(one, sampling_rate=4 * RATE)})
    found = noise.of_lines(made, LINES).density.mean(axis=1)
    shares = np.where(np.arange(len(made.runs)) == len(made.runs) - 1, 0.25, 1.0)
    stated = np.array([channel.noise_rms for channel in campaign.table.channels])
    assert_allclose(found, shares[:, None] * stated**2 / RATE, rtol=0.5)


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
