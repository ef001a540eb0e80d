"""Physics that no family describes does what its sentence says, and nothing at size zero."""

from collections.abc import Callable

import numpy as np
import pytest

from benchmarks.blind.drawing import foreign
from benchmarks.blind.drawing.foreign import FOREIGN, effect
from fem.base_excitation.response import Response
from validation.effects.effect import COVER, FMD
from validation.virtual_test.plan import Plan, Sensed
from validation.virtual_test.simulate import laboratory

RATE = 8192.0
FREQUENCY = 20.0
SECONDS = 4.0

SIGNALS = [name for name in FOREIGN if name not in ("dashpot", "lashing")]


@pytest.fixture(scope="module")
def sensed() -> Sensed:
    """A steady 20 Hz in every channel and in every motion, each of its own amplitude."""
    table = laboratory(Plan(article="fmd+disc+cuboid", seed=1)).layout.table
    time = np.arange(int(RATE * SECONDS)) / RATE
    wave = np.sin(2 * np.pi * FREQUENCY * time)
    values = wave[:, None] * np.arange(1.0, 1 + len(table.names))
    six = wave[:, None] * np.arange(1.0, 7.0)
    response = Response(sampling_rate=RATE, table=six, cover=six, load=six, cells=np.zeros((len(time), 4, 3)))
    return Sensed(
        values=values, table=table, sampling_rate=RATE, run="x", level=1.0, response=response, generator=np.random.default_rng(1)
    )


def phasor(signal: np.ndarray) -> complex:
    """Of 20 Hz in the second before the last tenth; at its very end a record has no second derivative."""
    chosen = slice(-int(1.1 * RATE), -int(0.1 * RATE))
    turning = np.exp(-2j * np.pi * FREQUENCY * np.arange(len(signal)) / RATE)
    return complex(2j * np.mean((signal * turning)[chosen]))


def ratio(name: str, channel: str, size: float, sensed: Sensed) -> complex:
    """What `channel` reads over what it did."""
    after = effect(name, channel, size).signals(sensed)
    return phasor(after.values[:, sensed.column(channel)]) / phasor(sensed.values[:, sensed.column(channel)])


@pytest.mark.parametrize("name", SIGNALS)
def test_at_size_zero_nothing_is_changed(name: str, sensed: Sensed) -> None:
    channel = FOREIGN[name].channels[0] if FOREIGN[name].channels else ""
    after = effect(name, channel, 0.0).signals(sensed)
    np.testing.assert_allclose(after.values, sensed.values, atol=1e-12)


def test_a_rising_gain_rises_with_the_square_of_frequency(sensed: Sensed) -> None:
    found = ratio("rising-gain", "cover-z3", 0.2, sensed)
    assert found == pytest.approx(1 + 0.2 * (FREQUENCY / foreign.TOP_OF_BAND) ** 2, rel=1e-4)  # central differences at 8 kHz


def test_a_loose_cell_adds_a_resonance(sensed: Sensed) -> None:
    f = FREQUENCY / 19.0
    expected = 1 + 0.01 * (1 / (1 - f**2 + 2j * 0.03 * f) - 1)
    assert ratio("loose-cell", "fmd-z1", 0.01, sensed) == pytest.approx(expected, rel=1e-4)  # it has rung up within 4 s


def test_a_gain_drifts_from_half_below_to_half_above(sensed: Sensed) -> None:
    after = effect("drift", "fmd-z1", 0.2).signals(sensed)
    k = sensed.column("fmd-z1")
    moved = after.values[:, k] / np.where(sensed.values[:, k] == 0, np.inf, sensed.values[:, k])
    seen = moved[np.abs(sensed.values[:, k]) > 1e-6]
    assert seen[0] == pytest.approx(0.9, abs=1e-3)
    assert seen[-1] == pytest.approx(1.1, abs=1e-3)


def test_a_force_channel_hears_newtons_for_an_acceleration(sensed: Sensed) -> None:
    after = effect("hearing", "fmd-x12", 2.0).signals(sensed)
    heard = (after.values - sensed.values)[:, sensed.column("fmd-x12")]
    np.testing.assert_allclose(heard, 2.0 * sensed.values[:, sensed.column("cover-y1")], atol=1e-12)


def test_a_slow_clock_lags_by_a_share_of_the_time_that_has_passed(sensed: Sensed) -> None:
    after = effect("slow-clock", "", 1e-4).signals(sensed)
    k = sensed.column("fmd-z1")
    late = float(np.angle(phasor(after.values[:, k]) / phasor(sensed.values[:, k])))
    middle = SECONDS - 0.6
    assert late == pytest.approx(-2 * np.pi * FREQUENCY * 1e-4 * middle, rel=1e-2)  # it lags more and more


def test_a_gyroscope_makes_moments_across_the_rate_and_no_force(sensed: Sensed) -> None:
    after = effect("gyroscope", "", 3.0).signals(sensed)
    added = after.values - sensed.values
    z = [sensed.column(f"fmd-z{k}") for k in range(1, 5)]
    places = np.array([sensed.table.channels[k].places[0].position for k in z])
    rate = np.cumsum(sensed.response.cover[:, 3:5], axis=0) / RATE
    np.testing.assert_allclose(added[:, z].sum(axis=1), 0.0, atol=1e-12)
    np.testing.assert_allclose(added[:, z] @ places[:, 1], 3.0 * rate[:, 1], atol=1e-9)  # M_x = sum y f_z = h beta'
    np.testing.assert_allclose(-added[:, z] @ places[:, 0], -3.0 * rate[:, 0], atol=1e-9)  # M_y = -sum x f_z = -h alpha'


def test_a_strained_pick_up_reads_the_lateral_load(sensed: Sensed) -> None:
    after = effect("strain", "cover-z2", 1e-3).signals(sensed)
    added = (after.values - sensed.values)[:, sensed.column("cover-z2")]
    np.testing.assert_allclose(added, 1e-3 * sensed.response.load[:, 0], atol=1e-15)


@pytest.mark.parametrize("name", SIGNALS)
def test_only_the_channels_that_are_meant_are_touched(name: str, sensed: Sensed) -> None:
    channel = FOREIGN[name].channels[0] if FOREIGN[name].channels else ""
    after = effect(name, channel, FOREIGN[name].high).signals(sensed)
    touched = {
        one for one in sensed.table.names if np.any(after.values[:, sensed.column(one)] != sensed.values[:, sensed.column(one)])
    }
    expected: dict[str, Callable[[str], bool]] = {
        "slow-clock": lambda one: one in FMD,
        "gyroscope": lambda one: one.startswith("fmd-z"),
    }
    assert touched
    assert all(expected.get(name, lambda one: one == channel)(one) for one in touched)
    assert channel in (*COVER, *FMD, "")


def test_a_lashing_ties_the_corner_of_the_plate_to_the_frame_and_a_dashpot_the_mast_to_the_table() -> None:
    rig = laboratory(Plan(article="fmd+clumod-1", seed=1)).rig
    tied = effect("lashing", "", 5e3).rig(rig)
    turn = np.zeros(len(rig.article.reduced.mass))
    turn[5] = 1.0  # about z, at the article's origin on the axis: the corner at y = -0.2 m moves by +0.2 m along x
    np.testing.assert_allclose(tied.article.places["corner"] @ turn, [0.2, 0.2, 0.0], atol=1e-12)
    assert [(one.place, one.to) for one in tied.struts] == [("corner", "ground")]
    np.testing.assert_array_equal(tied.struts[0].stiffness, [5e3, 0.0, 0.0])
    damped = effect("dashpot", "", 10.0).rig(rig)
    assert [(one.place, one.to) for one in damped.struts] == [("mast-top", "table")]
    np.testing.assert_array_equal(damped.struts[0].stiffness, np.zeros(3))
    rigid = laboratory(Plan(article="fmd+disc+cuboid", seed=1)).rig
    assert effect("dashpot", "", 10.0).rig(rigid) is rigid
