"""A virtual campaign is a campaign like any other: it reads like one, and tells nothing that a laboratory would not know."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from fem.damping import Damping
from geometry.dynamic_mass import LEVELS, MOTIONS
from geometry.errors import BadInput, CheckFailed
from identification.campaign import Campaign, levels, noise_floors
from identification.campaign_file import examine, write
from validation.virtual_test.plan import Plan, PlantedEffect, exact
from validation.virtual_test.simulate import laboratory, record, recording, runs, simulate


@pytest.fixture(scope="module")
def folder(ordinary, tmp_path_factory) -> Path:
    """A virtual campaign as it was written."""
    path = tmp_path_factory.mktemp("series") / "one-blade"
    write(path, ordinary("fmd+clumod-1").campaign)
    return path


def test_a_written_campaign_reads_back_to_the_last_bit_and_nothing_is_wrong_with_it(folder, ordinary):
    found, campaign = examine(folder), ordinary("fmd+clumod-1").campaign
    assert found.problems == ()
    assert found.campaign.warnings == ()
    for name, one in campaign.recordings.items():
        assert_array_equal(found.campaign.recordings[name].values, one.values)
    assert_allclose(found.campaign.mounting.position, [0, 0, 0.045])


def test_the_campaign_file_holds_no_seed_no_effect_and_no_drawn_figure(elastic_plan, tmp_path):
    effect = PlantedEffect(id="force-gain:fmd-z3", value={"": 0.0432}, chain=lambda chain: chain.more_gain("fmd-z3", 0.0432))
    plan = elastic_plan(seed=987654321, effects=(effect,), article="fmd", model="rigid")
    made = simulate(plan)
    write(tmp_path / "sealed", made.campaign)
    text = (tmp_path / "sealed" / "campaign.toml").read_text(encoding="utf-8")
    for word in ("987654321", "seed", "effect", "0.0432", "gain", "tolerance"):
        assert word not in text.lower(), word
    figures = [value for value in made.truth["tolerances"].values() if isinstance(value, float) and value]
    assert len(figures) > 100
    assert not [value for value in figures if f"{abs(value):.6g}" in text]


def test_noise_floors_are_those_of_the_plan_and_of_the_file(ordinary):
    """The quiet before and after a run holds noise and hum; a second of it tells the rms to a few per cent."""
    campaign = ordinary("fmd+clumod-1").campaign
    found = noise_floors(campaign)
    for channel, rms in zip(campaign.table.channels, found, strict=True):
        hum = {"acceleration": 0.003, "force": 0.2}[channel.quantity] * np.sqrt((1 + 0.3**2 + 0.1**2) / 2)
        assert_allclose(rms, np.hypot(channel.noise_rms, hum), rtol=0.15)


def test_the_mains_hum_at_fifty_hertz_in_every_channel(rigid_plan, exact_test):
    size = {"acceleration": 0.003, "force": 0.2}
    campaign = simulate(replace(exact(rigid_plan()), mains=size)).campaign
    made = campaign.recordings["z"]
    hum = made.values - exact_test.campaign.recordings["z"].values
    frequency = np.fft.rfftfreq(len(hum), 1 / made.sampling_rate)
    lines = np.abs(np.fft.rfft(hum * np.hanning(len(hum))[:, None], axis=0)) * 4 / len(hum)
    assert_allclose(frequency[np.argmax(lines, axis=0)], 50.0, atol=1.5 * frequency[1])
    assert_allclose(lines.max(axis=0), [size[channel.quantity] for channel in campaign.table.channels], rtol=0.2)
    harmonics = lines[np.round(np.array([150.0, 250.0]) / frequency[1]).astype(int)] / lines.max(axis=0)
    assert_allclose(harmonics.mean(axis=1), [0.3, 0.1], rtol=0.3)


def test_the_table_moves_across_by_a_few_per_cent(elastic_plan):
    campaign = simulate(exact(elastic_plan(article="fmd", model="rigid", octaves_per_minute=40.0))).campaign
    shares = []
    for axis in MOTIONS:
        found = levels(campaign.recordings[axis], campaign.table)
        assert_allclose(found.amplitude[MOTIONS.index(axis)], LEVELS[axis], rtol=0.05)
        shares += [share for k, share in enumerate(found.share) if k != MOTIONS.index(axis)]
    assert 0.015 < np.mean(shares) < 0.06
    assert max(shares) < 0.1


def test_effects_on_whole_signals_see_what_is_streamed_otherwise(elastic_plan):
    """An effect that copies the signals makes the run be kept whole; what is recorded stays the same."""
    idle = PlantedEffect(id="idle", signals=lambda sensed: replace(sensed, values=np.array(sensed.values)))
    plain, kept = elastic_plan(), elastic_plan(effects=(idle,))
    run = runs(plain)[4]
    expected = record(plain, laboratory(plain), run)
    assert_allclose(record(kept, laboratory(kept), run), expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_effects_on_the_record_come_after_the_noise(rigid_plan):
    grams = PlantedEffect(id="unit", record=lambda sensed: replace(sensed, values=sensed.values / 9.81))
    plain, scaled = (replace(exact(rigid_plan()), noise_rms={"force": 1.0}, effects=effects) for effects in ((), (grams,)))
    labs = [(plan, laboratory(plan), runs(plan)[0]) for plan in (plain, scaled)]
    values = [recording(plan, lab.layout, lab.chain, run, record(plan, lab, run)).values for plan, lab, run in labs]
    assert_allclose(values[1], values[0] / 9.81, rtol=1e-12)


def test_effects_on_the_rig_come_before_the_drive(rigid_plan, exact_test):
    heavier = PlantedEffect(id="heavy", rig=lambda rig: replace(rig, cover=rig.cover.scaled(2.0)))
    plan = exact(rigid_plan(effects=(heavier,)))
    found, before = record(plan, laboratory(plan), runs(plan)[2]), exact_test.campaign.recordings["z"].values
    cells = exact_test.campaign.table.select(group="fmd")[4:]
    truth = exact_test.truth
    whole = truth["fmd"]["mass_kg"] + truth["article"]["own_frame"]["mass_kg"]
    ratio = np.linalg.norm(found[:, cells].sum(axis=1)) / np.linalg.norm(before[:, cells].sum(axis=1))
    assert_allclose(ratio, 1 + truth["fmd"]["mass_kg"] / whole, rtol=1e-3)


def test_progress_runs_up_to_the_end(rigid_plan):
    seen: list[float] = []
    simulate(exact(rigid_plan()), progress=seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"levels": ()}, "levels"),
        ({"levels": (1.0, 1.0)}, "levels"),
        ({"levels": (0.0,)}, "levels"),
        ({"seed": -1}, "seed"),
        ({"pattern": "spiral"}, "pattern"),
        ({"model": "solid"}, "model"),
        ({"rate": float("nan")}, "rate"),
        ({"noise_rms": {"force": -1.0}}, "noise_rms.force"),
        ({"mains": {"farce": 1.0}}, "mains"),
        ({"cross": float("inf")}, "cross"),
    ],
)
def test_a_plan_that_cannot_be_is_refused_by_its_field(changes, field):
    with pytest.raises(BadInput) as refused:
        Plan(article="fmd", **changes)
    assert refused.value.field == field


@pytest.mark.parametrize("article", ["clumod-1", "disc+cuboid", "fmd+clumod-2", "cuboid+fmd"])
def test_what_does_not_stand_on_the_fmd_is_refused(article):
    with pytest.raises(BadInput, match="article"):
        simulate(Plan(article=article))


def test_a_record_too_slow_for_the_sweep_and_an_article_that_never_stops_ringing_are_refused(elastic_plan):
    with pytest.raises(BadInput, match="pass-band"):
        simulate(Plan(article="fmd", rate=80.0))
    with pytest.raises(CheckFailed, match="Give it damping"):
        simulate(elastic_plan(damping=Damping(ratio=1e-7)))


def cross(campaign: Campaign) -> float:
    """Mean share of the motions that were not driven."""
    shares = [levels(campaign.recordings[run.name], campaign.table).share for run in campaign.runs]
    return float(np.mean([np.delete(share, MOTIONS.index(run.axis)) for share, run in zip(shares, campaign.runs, strict=True)]))
