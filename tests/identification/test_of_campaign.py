"""Spectra of a campaign: what leaks, what is missing at the ends of a record, what is refused."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from geometry.inertia import Inertia
from identification import campaign_file
from identification.base_motion import base_motion
from identification.campaign import Campaign, Processing, Recording
from identification.dynamic_mass import from_runs
from identification.resultants import resultants
from identification.spectra.line_spectra import full_record
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
