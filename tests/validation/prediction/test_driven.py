"""Lines that no run drives are neither fitted nor judged, unless a band is asked for."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from identification.campaign import Campaign, Excitation, Processing, Recording
from validation.prediction.series import SeriesPrediction, predictions
from validation.virtual_test.plan import NOISE, RIGID
from validation.virtual_test.simulate import simulate

LOW, HIGH = 8.0, 16.0
LINES = {"start_hz": LOW, "stop_hz": HIGH}


@pytest.fixture(scope="module")
def campaign(plan: Any) -> Campaign:
    """Disc and Cuboid, swept from 8 to 16 Hz, with so much noise that little of a sweep is seen beside its band."""
    noise = {quantity: 5 * rms for quantity, rms in NOISE.items()}
    short = plan(article="fmd+disc+cuboid", model=RIGID, band=(LOW, HIGH), octaves_per_minute=60.0, noise_rms=noise)
    return simulate(short).campaign


def _saying(campaign: Campaign, **by_run: dict[str, float] | None) -> Campaign:
    """The same runs, which state `by_run` instead of what they do; None for nothing."""
    said = {name: None if figures is None else Excitation(kind="sine-sweep", figures=figures) for name, figures in by_run.items()}
    return replace(campaign, runs=tuple(replace(run, excitation=said.get(run.name, run.excitation)) for run in campaign.runs))


def _silent(campaign: Campaign) -> Campaign:
    return _saying(campaign, **dict.fromkeys(run.name for run in campaign.runs))


def _ends(of: SeriesPrediction) -> tuple[float, float]:
    return of.measured.frequency[0], of.measured.frequency[-1]


def _left_out(of: SeriesPrediction) -> list[str]:
    return [said for said in of.tested.remarks if "left out" in said]


def test_what_is_wrong_with_a_record_is_passed_on(campaign: Campaign, model: Any) -> None:
    (of,) = predictions(model(), [campaign])
    assert any("ends before the ring-down" in said for said in of.tested.remarks)


def test_lines_are_those_that_the_runs_state_to_drive(campaign: Campaign, model: Any) -> None:
    (of,) = predictions(model(), [campaign])
    assert_allclose(_ends(of), (LOW, HIGH))
    (said,) = _left_out(of)
    assert "400 of the 561 lines" in said
    assert "drive 8 to 16 Hz" in said


def test_a_band_that_is_asked_for_decides(campaign: Campaign, model: Any) -> None:
    (of,) = predictions(model(), [campaign], band=(6.0, 20.0))
    assert_allclose(_ends(of), (6.0, 20.0))
    assert not _left_out(of)


def test_lines_are_those_that_all_runs_and_the_processing_have_in_common(campaign: Campaign, model: Any) -> None:
    said = _saying(campaign, x={"start_hz": 14.0, "stop_hz": 2.0}, gamma={"start_hz": 9.0, "stop_hz": 40.0})
    (of,) = predictions(model(), [replace(said, processing=Processing(start=10.0, stop=20.0, step=0.5))])
    assert_allclose(_ends(of), (10.0, 14.0))


def test_a_campaign_that_drives_all_of_its_lines_keeps_them_without_a_word(campaign: Campaign, model: Any) -> None:
    (of,) = predictions(model(), [replace(campaign, processing=Processing(start=LOW, stop=HIGH, step=0.5))])
    assert_allclose(_ends(of), (LOW, HIGH))
    assert not _left_out(of)


def test_where_no_run_says_so_its_level_tells_what_it_drives(campaign: Campaign, model: Any) -> None:
    """The spectrum of a fast sweep has no sharp ends: within about two lobes, of a hertz."""
    (of,) = predictions(model(), [_silent(campaign)])
    assert_allclose(_ends(of), (LOW, HIGH), atol=2.0)
    assert np.all(np.isin(np.arange(180, 321), np.round(of.measured.frequency / 0.05)))
    (said,) = _left_out(of)
    assert "10 times the noise" in said


def test_a_run_that_drives_nothing_does_not_take_all_lines_away_without_a_word(campaign: Campaign, model: Any) -> None:
    still = campaign.recordings["y"]
    noise = np.random.default_rng(0).standard_normal(still.values.shape) * still.values[:40].std(axis=0)
    dead = replace(campaign, recordings={**campaign.recordings, "y": replace(still, values=noise)})
    (of,) = predictions(model(), [_saying(dead, y=None)])
    assert_allclose(_ends(of), (LOW, HIGH))
    assert any("all lines are kept" in said and "y state" in said for said in of.tested.remarks)


def test_noise_that_nobody_knows_leaves_no_line_out(campaign: Campaign, model: Any) -> None:
    recordings = {
        name: Recording(names=one.names, values=np.ones((5, len(one.names))) + 0j, frequency=np.arange(4.0, 9.0), source=name)
        for name, one in campaign.recordings.items()
    }
    (of,) = predictions(model(), [_silent(replace(campaign, recordings=recordings))])
    assert_allclose(_ends(of), (4.0, 8.0))


def test_runs_that_drive_nothing_in_common_are_refused(campaign: Campaign, model: Any) -> None:
    apart = _saying(campaign, x={"start_hz": 4.0, "stop_hz": 10.0}, y={"start_hz": 12.0, "stop_hz": 16.0})
    with pytest.raises(BadInput, match=r"x drives 4 to 10 Hz.*--band"):
        predictions(model(), [apart])
    (of,) = predictions(model(), [apart], band=(LOW, HIGH))
    assert_allclose(_ends(of), (LOW, HIGH))
