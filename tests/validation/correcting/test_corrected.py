"""What a virtual test plants, `corrected` takes out: the copy is the test of the same laboratory without the fault."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from geometry.errors import BadInput
from geometry.sensors import Channel, ChannelTable, Place, motion_rows
from identification.campaign import Campaign, Recording
from identification.spectra.line_spectra import full_record
from validation.correct import CORRECTIONS, advanced, corrected, through
from validation.effects.catalogue import FAMILIES, Named, parse

LINES = np.arange(8.0, 32.0, 0.25)

ROUNDING = 1e-12
"""Relative to a channel's peak: a factor that is divided out again."""

TRANSFORMED = 1e-10
"""The same, after two transforms of a record that begins and ends at rest."""

HIGHPASS = 1e-5
"""Of a corner of 0.3 Hz, from 8 Hz up: what is held back there is (0.04/8)² of 0.3/8, and the filter that the virtual test plants
by the bilinear rule at 2048 Hz is off by (2 pi 8/2048)²/12 of it: 3e-6 in all."""


def largest_difference(one: Campaign, other: Campaign, *, lines: bool = False) -> float:
    """Over all runs and channels, relative to the channel's peak: of the samples, or of the spectra where they were driven."""
    worst = 0.0
    for name, recording in one.recordings.items():
        a, b = recording.values, other.recordings[name].values
        if lines:
            a, b = (full_record(values, recording.sampling_rate or 0.0, LINES) for values in (a, b))
        worst = max(worst, float(np.max(np.abs(a - b) / np.abs(a).max(axis=0))))
    return worst


@pytest.mark.parametrize(
    ("effect", "lines", "tolerance"),
    [
        ("force-gain:fmd-z2=0.08", False, ROUNDING),
        ("accelerometer-gain:cover-z3=-0.05", False, ROUNDING),
        ("unit:cover-z3=0.102", False, ROUNDING),
        ("polarity:fmd-z2", False, ROUNDING),
        ("channel-swap:cover-z1:table-x1", False, ROUNDING),
        ("load-path-shunt:x=0.03", False, ROUNDING),
        ("load-path-shunt:z=0.2", False, ROUNDING),
        ("force-delay:fmd-z2=200e-6", False, TRANSFORMED),
        ("force-delay:fmd-x12=0.0123", False, TRANSFORMED),
        ("accelerometer-delay:cover-z3=-2e-3", False, TRANSFORMED),
        ("board-delay:force=200e-6", False, TRANSFORMED),
        ("board-delay:cover=200e-6", False, TRANSFORMED),
        ("board-delay:table=-200e-6", False, TRANSFORMED),
        ("force-highpass:fmd-x12=0.3", True, HIGHPASS),
    ],
)
def test_what_is_planted_is_taken_out(tested, effect, lines, tolerance):
    clean, faulty = tested(), tested(effect)
    assert largest_difference(clean, faulty, lines=lines) > 1e-3
    assert largest_difference(clean, corrected(faulty, parse(effect)).campaign, lines=lines) < tolerance


@pytest.mark.parametrize("effect", ["accelerometer-position:cover-z3:x=0.01", "accelerometer-misalignment:cover-z3:x=0.02"])
def test_where_a_pick_up_really_is_makes_the_cover_plate_rigid_again(exactly, effect):
    """Eight channels see six motions: with true places and directions nothing is left over."""

    def left(campaign):
        chosen = campaign.table.select(group="cover")
        G = motion_rows([campaign.table.channels[k] for k in chosen], campaign.table.origin)
        beside = np.eye(len(chosen)) - G @ np.linalg.pinv(G)
        read = np.vstack([one.values[:, chosen] for one in campaign.recordings.values()])
        return float(np.linalg.norm(read @ beside) / np.linalg.norm(read))

    faulty = exactly(effect)
    made = corrected(faulty, parse(effect)).campaign
    assert left(exactly()) < ROUNDING
    assert left(faulty) > 1e-3
    assert left(made) < ROUNDING
    assert largest_difference(faulty, made) == 0.0


def test_faults_are_taken_out_one_after_the_other_and_other_channels_stay_to_the_last_bit(tested):
    effects = ("force-gain:fmd-z2=0.08", "force-delay:fmd-z2=200e-6")
    made = tested(*effects)
    for effect in effects:
        made = corrected(made, parse(effect)).campaign
    assert largest_difference(tested(), made) < TRANSFORMED
    assert made.notes.count("corrected: ") == 2
    for effect in ("force-delay:fmd-z2=200e-6", "board-delay:cover=1e-4", "force-gain:fmd-z2=0.08", "force-highpass:fmd-z1=0.3"):
        before = tested()
        made = corrected(before, parse(effect))
        others = [k for k, name in enumerate(before.table.names) if name not in made.channels]
        assert len(others) + len(made.channels) == len(before.table)
        for name, recording in made.campaign.recordings.items():
            np.testing.assert_array_equal(recording.values[:, others], before.recordings[name].values[:, others])


def test_all_else_is_said_as_before_and_a_noise_floor_goes_with_its_channel(tested):
    before = tested()
    made = corrected(before, parse("force-gain:fmd-z2=0.08")).campaign
    assert made.notes == f"{before.notes}; corrected: force-gain:fmd-z2=0.08 taken out (multiplied by 0.925926)"
    for key in ("title", "article", "hardware", "runs", "mounting", "gravity", "processing", "source"):
        assert getattr(made, key) == getattr(before, key)
    table = tested().table
    noisy = replace(tested(), table=replace(table, channels=tuple(replace(c, noise_rms=0.1) for c in table.channels)))
    made = corrected(noisy, parse("force-gain:fmd-z2=0.25")).campaign.table
    assert {c.name: c.noise_rms for c in made.channels if c.noise_rms != 0.1} == {"fmd-z2": pytest.approx(0.08, rel=1e-15)}


def test_spectra_at_rest_keep_what_a_high_pass_left_nothing_of():
    place = Place(position=np.zeros(3), direction=np.array([0.0, 0.0, 1.0]))
    table = ChannelTable(channels=(Channel(name="f", quantity="force", group="fmd", places=(place,)),))
    recording = Recording(names=("f",), values=np.ones((3, 1), dtype=complex), frequency=np.array([0.0, 1.0, 2.0]))
    campaign = Campaign(title="", article="fmd", table=table, runs=(), recordings={"r": recording})
    made = corrected(campaign, Named(family="force-highpass", targets=("f",), values={"": 0.5})).campaign
    np.testing.assert_allclose(made.recordings["r"].values[:, 0], [1.0, 1 - 0.5j, 1 - 0.25j], rtol=1e-15)


@pytest.mark.parametrize("family", [name for name in FAMILIES if name not in CORRECTIONS])
def test_what_no_record_can_be_rid_of_says_why(tested, family):
    named = parse(FAMILIES[family].example)
    with pytest.raises(BadInput, match="cannot be taken out of a record: ") as refused:
        corrected(tested(), named)
    assert refused.value.source == named.id
    assert "no inverse of its equation is known" not in refused.value.problem  # each has a reason of its own


@pytest.mark.parametrize("family", CORRECTIONS)
def test_the_example_of_the_catalogue_can_be_corrected(tested, family):
    named = parse(FAMILIES[family].example.partition(", or ")[0])
    assert set(corrected(tested(), named).channels) <= set(tested().table.names)


@pytest.mark.parametrize(
    "effect", ["force-gain:fmd-z1=0", "unit:fmd-z1=1", "force-delay:fmd-z1=0", "accelerometer-position:cover-z1:x=0"]
)
def test_no_fault_is_nothing_to_correct(tested, effect):
    with pytest.raises(BadInput, match="nothing to correct: this is the size of no effect"):
        corrected(tested(), parse(effect))


def test_a_turn_about_its_own_direction_and_a_board_without_channels_are_nothing_to_correct(tested):
    with pytest.raises(BadInput, match="a turn about z, along which it measures, changes nothing"):
        corrected(tested(), parse("accelerometer-misalignment:cover-z3:z=0.02"))
    with pytest.raises(BadInput, match="it has no channel of the group table"):
        corrected(force_table({"name": "z", "places": along((0, 0, 1))}), parse("board-delay:table=1e-4"))


def force_table(*channels: dict[str, Any]) -> Campaign:
    made = [Channel(**{"quantity": "force", "group": "fmd", **one}) for one in channels]
    return Campaign(title="", article="fmd", table=ChannelTable(channels=tuple(made)), runs=())


def along(*directions: tuple[float, float, float]) -> tuple[Place, ...]:
    return tuple(Place(position=np.zeros(3), direction=np.array(one)) for one in directions)


def test_a_shunt_is_refused_where_it_is_not_exact_and_a_slanted_cell_lost_the_share_along_the_axis():
    shunt = parse("load-path-shunt:x=0.1")
    mixed = force_table({"name": "sum", "places": along((1, 0, 0), (0, 1, 0))})
    with pytest.raises(BadInput, match="sum adds up cells of several directions, which lost different shares"):
        corrected(mixed, shunt)
    moment = force_table({"name": "my", "quantity": "moment", "places": along((0, 1, 0))})
    with pytest.raises(BadInput, match="my is a moment, and how much of it passed the cells by is not known"):
        corrected(moment, shunt)
    with pytest.raises(BadInput, match="no load cell measures along x"):
        corrected(force_table({"name": "z", "places": along((0, 0, 1))}), shunt)
    slanted = force_table({"name": "a", "places": along((0.6, 0.0, 0.8))})
    assert corrected(slanted, parse("load-path-shunt:x=0.1")).did == f"multiplied by {1 / (1 - 0.036):.6g}"


def test_a_shift_by_whole_samples_moves_them_what_is_constant_stays_and_a_cut_record_is_wrong_at_its_ends_alone():
    signal = np.random.default_rng(3).standard_normal((500, 2)).cumsum(axis=0)
    moved = through(signal, 100.0, advanced(0.07))
    np.testing.assert_allclose(moved[:-7], signal[7:], atol=1e-11)  # rounding of a walk that goes up to some tens
    ramp = np.linspace(0.0, 1.0, 1001)[:, None]
    moved = through(ramp, 1000.0, advanced(0.0003))
    np.testing.assert_allclose(moved[100:-100], ramp[100:-100] + 0.0003, atol=1e-8)
    np.testing.assert_allclose(through(np.full((100, 1), 3.0), 50.0, advanced(0.01)), 3.0, rtol=1e-13)
    # A sine that goes on beyond the record: its continuation bends at the ends, and what that does fades within some samples.
    time = np.arange(4000) / 500.0
    errors = np.abs(
        through(np.sin(2 * np.pi * 11 * time)[:, None], 500.0, advanced(0.0004))[:, 0] - np.sin(2 * np.pi * 11 * (time + 0.0004))
    )
    assert errors[200:-200].max() < 1e-6
    assert errors.max() < 1e-2
