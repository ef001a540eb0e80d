"""Recordings, units, a first look at levels and noise floors, and channels that cannot be true."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from geometry.dynamic_mass import LEVELS, MOTIONS
from geometry.errors import BadInput
from geometry.sensors import motion_rows
from identification.campaign import (
    NOMINAL,
    Campaign,
    Recording,
    base_motion,
    clipped,
    factor,
    is_same,
    levels,
    named,
    noise_floors,
)


@pytest.mark.parametrize(
    ("axis", "values", "words"),
    [
        ({}, np.zeros((3, 2)), "either"),
        ({"sampling_rate": 1.0, "frequency": np.arange(3.0)}, np.zeros((3, 2)), "either"),
        ({"sampling_rate": 0.0}, np.zeros((3, 2)), "positive"),
        ({"sampling_rate": np.nan}, np.zeros((3, 2)), "positive"),
        ({"sampling_rate": 1.0}, np.zeros((3, 3)), "shape"),
        ({"frequency": np.array([1.0, 1.0, 2.0])}, np.zeros((3, 2)), "ascending"),
        ({"frequency": np.array([-1.0, 1.0, 2.0])}, np.zeros((3, 2)), "ascending"),
        ({"frequency": np.arange(4.0)}, np.zeros((3, 2)), "3 ascending"),
    ],
)
def test_a_recording_that_contradicts_itself_is_refused(axis: dict[str, object], values: np.ndarray, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Recording(names=("a", "b"), values=values, **axis)  # type: ignore[arg-type]


def test_a_recording_is_a_copy_that_nobody_changes() -> None:
    samples = np.ones((4, 2))
    recorded = Recording(names=("a", "b"), values=samples, sampling_rate=2.0)
    samples[:] = 5
    assert_array_equal(recorded.channel("b"), np.ones(4))
    with pytest.raises(ValueError, match="read-only"):
        recorded.values[0, 0] = 3
    assert recorded.duration == 2.0
    assert_array_equal(recorded.time, [0, 0.5, 1, 1.5])
    with pytest.raises(BadInput, match="no such channel"):
        recorded.channel("c")
    own = np.ones((4, 2))
    own.setflags(write=False)  # nobody can change what is kept as it is, and a view of what somebody can is copied
    assert Recording(names=("a", "b"), values=own, sampling_rate=2.0).values is own
    part = samples[:, :]
    part.setflags(write=False)
    assert Recording(names=("a", "b"), values=part, sampling_rate=2.0).values is not part


def test_spectra_have_no_time() -> None:
    spectra = Recording(names=("a",), values=np.ones((2, 1)), frequency=np.array([1.0, 2.0]))
    assert spectra.duration == 0
    with pytest.raises(ValueError, match="no time"):
        _ = spectra.time


@pytest.mark.parametrize(
    ("unit", "quantity", "size"),
    [
        ("g", "acceleration", 9.80665),  # standard gravity, CGPM 1901
        ("in/s^2", "acceleration", 0.0254),
        ("m/s²", "acceleration", 1.0),
        ("lbf", "force", 0.45359237 * 9.80665),  # the pound by its definition, times standard gravity
        ("kN", "force", 1000.0),
        ("lbf ft", "moment", 0.45359237 * 9.80665 * 0.3048),
        ("Nm", "moment", 1.0),
    ],
)
def test_units_are_what_they_are_by_definition(unit: str, quantity: str, size: float) -> None:
    assert_allclose(factor(unit, quantity, source="s", field="f"), size, rtol=1e-14)
    assert is_same(unit, named(size, quantity), quantity)


@pytest.mark.parametrize("unit", ["kg", "", None, 3, "G"])
def test_what_is_no_unit_is_refused(unit: object) -> None:
    with pytest.raises(BadInput, match=r"Known are m/s\^2, g"):
        factor(unit, "acceleration", source="s", field="f")


def test_a_factor_without_a_name_is_said_in_si() -> None:
    assert named(0.5, "force") == "0.5 N"
    assert not is_same("g", "N", "force")


RATE = 256.0


def moved(campaign: Campaign, motion: np.ndarray, floor: float = 0.0) -> Recording:
    """What the accelerometers read of `motion` (n, 6), noise of `floor` in every channel."""
    rows = np.zeros((len(campaign.table), 6))
    pickups = list(campaign.table.select(quantity="acceleration"))
    rows[pickups] = motion_rows([campaign.table.channels[k] for k in pickups], campaign.table.origin)
    noise = np.random.default_rng(3).standard_normal((len(motion), len(rows)))
    return Recording(names=campaign.table.names, values=motion @ rows.T + floor * noise, sampling_rate=RATE)


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


SAMPLED = 564.0
T = np.arange(4000) / SAMPLED


def sine(frequency: float, level: float = 1.0) -> np.ndarray:
    return level * np.sin(2 * np.pi * frequency * T + 0.3)


@pytest.mark.parametrize("frequency", [4.0, 12.0, 32.0])
@pytest.mark.parametrize("share", [0.5, 0.8])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_sine_cut_off_on_one_side_is_clipped(frequency: float, share: float, sign: float) -> None:
    cut = sign * np.minimum(sine(frequency), share)
    at_top = int(np.sum(sign * cut == share))
    found = clipped(cut)
    assert 0.8 * at_top < found <= at_top


@pytest.mark.parametrize("frequency", [4.0, 12.0, 32.0])
@pytest.mark.parametrize("bits", [6, 8, 12, 16])
def test_rounding_to_the_steps_of_a_converter_is_not_clipping(frequency: float, bits: int) -> None:
    step = 2.0 ** (1 - bits)
    assert clipped(np.round(sine(frequency) / step) * step) == 0


def test_a_clipped_and_rounded_signal_is_clipped() -> None:
    step = 2.0**-11
    assert clipped(np.round(np.clip(sine(8.0), -0.7, 0.7) / step) * step) > 100


def test_noise_and_rests_are_not_clipped() -> None:
    generator = np.random.default_rng(7)
    assert clipped(generator.standard_normal(4000)) == 0
    assert clipped(np.concatenate([np.zeros(500), sine(8.0), np.zeros(500)])) == 0


@given(st.floats(1e-9, 1e9))
def test_the_verdict_does_not_depend_on_the_unit(scale: float) -> None:
    assert clipped(scale * np.minimum(sine(8.0), 0.7)) == clipped(np.minimum(sine(8.0), 0.7))
