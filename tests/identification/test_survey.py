"""Levels and noise floors: what was put in comes out."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.dynamic_mass import LEVELS, MOTIONS
from geometry.sensors import motion_rows
from identification.campaign import NOMINAL, Campaign, Recording, base_motion, levels, noise_floors

RATE = 256.0


def moved(campaign: Campaign, motion: np.ndarray, floor: float = 0.0) -> Recording:
    """What the accelerometers read of `motion` (n, 6), noise of `floor` in every channel."""
    rows = np.zeros((len(campaign.table), 6))
    pickups = list(campaign.table.select(quantity="acceleration"))
    rows[pickups] = motion_rows([campaign.table.channels[k] for k in pickups], campaign.table.origin)
    noise = np.random.default_rng(3).standard_normal((len(motion), len(rows)))
    return Recording(names=campaign.table.names, values=motion @ rows.T + floor * noise, sampling_rate=RATE)


def test_the_base_motion_is_what_moved_the_pickups(campaign: Campaign) -> None:
    motion = np.random.default_rng(1).standard_normal((300, 6))
    found = base_motion(moved(campaign, motion), campaign.table)
    assert found is not None
    # condition below 3, a sum of eight products
    assert_allclose(found, motion, rtol=0, atol=1e-13)


def test_the_table_helps_where_the_cover_plate_alone_does_not_tell(campaign: Campaign) -> None:
    kept = [k for k, name in enumerate(campaign.table.names) if not name.startswith("cover-x")]
    motion = np.random.default_rng(1).standard_normal((300, 6))
    whole = moved(campaign, motion)
    few = replace(campaign, table=campaign.table.subset(kept))
    found = base_motion(replace(whole, names=few.table.names, values=whole.values[:, kept]), few.table)
    assert found is not None
    assert_allclose(found, motion, rtol=0, atol=1e-13)


@pytest.mark.parametrize("axis", range(6), ids=MOTIONS)
def test_a_sine_has_the_level_it_was_driven_with_and_its_cross_motion(campaign: Campaign, axis: int) -> None:
    t = np.arange(int(20 * RATE)) / RATE
    motion = np.zeros((len(t), 6))
    motion[:, axis] = NOMINAL[axis] * np.sin(2 * np.pi * 8 * t)
    other = (axis + 1) % 6
    motion[:, other] = 0.04 * NOMINAL[other] * np.cos(2 * np.pi * 8 * t)
    found = levels(moved(campaign, motion), campaign.table)
    # whole periods in every block
    assert_allclose(found.amplitude[axis], NOMINAL[axis], rtol=1e-9)
    assert_allclose(found.share[[axis, other]], [1.0, 0.04], rtol=1e-9)
    assert found.driven == 20.0


def test_the_rests_are_not_counted_as_driven(campaign: Campaign) -> None:
    found = levels(campaign.recordings["x"], campaign.table)
    assert found.driven == 4.0
    assert_allclose(found.amplitude[0], LEVELS["x"], rtol=0.01)  # blocks of half a second cut periods of the sweep


def test_noise_floors_are_those_of_the_rests(campaign: Campaign) -> None:
    """Six runs with two seconds of rest: 12 x 256 samples a channel, of which the quieter half counts."""
    floors = noise_floors(campaign)
    assert floors is not None
    stated = np.array([channel.noise_rms for channel in campaign.table.channels])
    # a block of 128 samples scatters by 6 %; the quieter half lies some 5 % low
    assert_allclose(floors, stated, rtol=0.12)
    assert_allclose(np.mean(floors / stated), 0.95, atol=0.03)


def test_ringing_of_the_structure_is_not_taken_for_noise_of_its_load_cell(campaign: Campaign) -> None:
    cell = campaign.table.names.index("fmd-z1")
    values = campaign.recordings["x"].values.copy()
    t = np.arange(len(values)) / RATE
    values[:, cell] += np.where(t > 5.0, 50.0 * np.exp(-2 * (t - 5.0)) * np.sin(60 * t), 0.0)
    rung = replace(campaign, recordings={"x": replace(campaign.recordings["x"], values=values)})
    floors = noise_floors(rung)
    assert floors[cell] < 1.2 * 0.3


def test_a_run_that_is_driven_throughout_has_no_floor(campaign: Campaign) -> None:
    always = moved(campaign, np.sin(np.arange(4000))[:, None] * NOMINAL, floor=0.01)
    assert noise_floors(replace(campaign, recordings={"x": always})) is None


def test_spectra_have_neither(campaign: Campaign) -> None:
    spectra = Recording(names=campaign.table.names, values=np.ones((5, 22)) + 1j, frequency=np.arange(5.0))
    assert levels(spectra, campaign.table) is None
    assert noise_floors(replace(campaign, recordings={"x": spectra})) is None
