"""What each parameter does to the channels, in the words and signs of the catalogue of effects."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.frames import rotation_about
from geometry.sensors import ChannelTable, Tolerances
from identification.chain import Chain, chain

FREQUENCY = np.array([4.0, 25.0])
OMEGA = 2 * np.pi * FREQUENCY
STIFFNESS = (1e8, 1e8, 4e8)
OPEN = ("board-delay", "force-highpass", "load-path-shunt", "force-plane-offset", "cover-plate-flexibility")
H = np.array(
    [
        [50, 0, 1, 0, 9, 2],
        [0, 51, 0, -9, 0, 3],
        [1, 0, 52, 1, -2, 0],
        [0, -9, 1, 7, 0, 0],
        [9, 0, -2, 0, 6, 0],
        [2, 3, 0, 0, 0, 2.0],
    ]
)
U = np.array([1.0, -0.7, 0.4, 2.0, -1.5, 0.8])


@pytest.fixture(scope="module")
def made(paper: ChannelTable) -> Chain:
    return chain(paper, Tolerances(), stiffness=STIFFNESS, overrides=dict.fromkeys(OPEN, 1.0))


def reading(made: Chain, **values: float) -> dict[str, np.ndarray]:
    """By channel (n,) what it reads of the motion `U` with these parameters."""
    A0, A1 = made.rows(made.theta(dict(values)), FREQUENCY)
    return dict(zip(made.names, ((A0 + A1 @ H) @ U).T, strict=True))


def with_one(made: Chain, name: str, value: float) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Readings at nominal and with one parameter at a value; that all channels it does not claim stay is checked here."""
    before, after = reading(made), reading(made, **{name: value})
    touched = next(one.channels for one in made.parameters if one.name == name)
    for k, channel in enumerate(made.names):
        if k not in touched:
            assert_allclose(after[channel], before[channel], rtol=0, atol=0)
    return before, after


@pytest.mark.parametrize("channel", ["fmd-x12", "cover-z3", "table-y1"])
def test_a_gain_multiplies_its_channel(made: Chain, channel: str) -> None:
    kind = "force" if channel.startswith("fmd") else "accelerometer"
    before, after = with_one(made, f"{kind}-gain:{channel}", 0.08)
    assert_allclose(after[channel], 1.08 * before[channel], rtol=1e-12)


@pytest.mark.parametrize(
    "name", ["force-delay:fmd-x12", "accelerometer-delay:table-z1", "board-delay:cover", "board-delay:force"]
)
def test_a_late_channel_lags(made: Chain, name: str) -> None:
    before, after = with_one(made, name, 1e-3)
    for k in next(one.channels for one in made.parameters if one.name == name):
        channel = made.names[k]
        assert_allclose(after[channel], before[channel] * np.exp(-1j * OMEGA * 1e-3), rtol=1e-12)


def test_a_high_pass_lets_half_the_power_through_at_its_corner_and_leads(made: Chain) -> None:
    before, after = with_one(made, "force-highpass:fmd-z2", 4.0)
    ratio = after["fmd-z2"] / before["fmd-z2"]
    assert_allclose(abs(ratio[0]), np.sqrt(0.5), rtol=1e-12)
    assert_allclose(np.angle(ratio[0]), np.pi / 4, rtol=1e-12)
    assert abs(ratio[1]) > 0.98


@pytest.mark.parametrize(("channel", "axis"), [("cover-z3", "x"), ("cover-x1", "z"), ("table-y2", "x")])
def test_a_misalignment_turns_the_direction_right_handed_about_the_axis(made: Chain, channel: str, axis: str) -> None:
    exact = chain(paper_of(made), Tolerances(), stiffness=np.inf)
    after = reading(exact, **{f"accelerometer-misalignment:{channel}:{axis}": 0.1})
    group = exact.cover if channel.startswith("cover") else exact.table
    place = next(one for one in group.channels if one.name == channel).places[0]
    a = U[:3] + np.cross(U[3:], place.position)
    assert_allclose(after[channel], (rotation_about(axis, 0.1) @ place.direction) @ a, rtol=1e-12)


def paper_of(made: Chain) -> ChannelTable:
    return ChannelTable(channels=(*made.cover.channels, *made.table.channels, *made.forces.channels), origin=made.cover.point)


@pytest.mark.parametrize("axis", ["x", "y"])
def test_a_pick_up_reads_where_it_sits(made: Chain, axis: str) -> None:
    before, after = with_one(made, f"accelerometer-position:cover-z3:{axis}", 2e-3)
    moved = 2e-3 * np.eye(3)["xyz".index(axis)]
    assert_allclose(after["cover-z3"] - before["cover-z3"], np.cross(U[3:], moved)[2], rtol=1e-9)


def test_a_shift_along_the_direction_is_no_parameter(made: Chain) -> None:
    names = {one.name for one in made.parameters}
    assert "accelerometer-position:cover-z3:z" not in names
    assert "accelerometer-misalignment:cover-z3:z" not in names


def test_cross_talk_zx_shows_the_x_resultant_in_the_z_channels(made: Chain) -> None:
    before, after = with_one(made, "force-crosstalk:zx", 0.02)
    change = sum(after[f"fmd-z{k}"] - before[f"fmd-z{k}"] for k in range(1, 5))
    assert_allclose(change, 0.02 * (H @ U)[0], rtol=1e-12)
    assert_allclose(after["fmd-x12"], before["fmd-x12"], rtol=1e-12)


def test_a_shunt_takes_its_fraction_of_what_the_cells_carry_along_its_axis(made: Chain) -> None:
    before, after = with_one(made, "load-path-shunt:z", 0.03)
    for k in range(1, 5):
        assert_allclose(after[f"fmd-z{k}"], 0.97 * before[f"fmd-z{k}"], rtol=1e-12)
    assert_allclose(after["fmd-x34"], before["fmd-x34"], rtol=1e-12)


@pytest.mark.parametrize(("axis", "moment", "sign"), [("x", 4, -1), ("y", 3, 1)])
def test_moments_that_the_cells_miss_are_those_of_a_plane_at_another_height(
    made: Chain, axis: str, moment: int, sign: int
) -> None:
    """M_y -= h F_x and M_x += h F_y, read from the four vertical cells: M_x = sum y f_z, M_y = -sum x f_z."""
    before, after = with_one(made, f"force-plane-offset:{axis}", 4e-3)
    change = np.array([after[f"fmd-z{k}"] - before[f"fmd-z{k}"] for k in range(1, 5)])
    arm = {3: np.array([1, 1, -1, -1]), 4: -np.array([1, -1, -1, 1])}[moment] * 0.13
    assert_allclose(arm @ change, sign * 4e-3 * (H @ U)["xy".index(axis)], rtol=1e-10)


def test_a_cover_plate_that_bends_adds_to_its_vertical_pick_ups(made: Chain) -> None:
    before, after = with_one(made, "cover-plate-flexibility", 1e-9)
    assert_allclose(after["cover-z1"] - before["cover-z1"], -(OMEGA**2) * 1e-9 * (H @ U)[2], rtol=1e-9)
    assert_allclose(after["cover-x1"], before["cover-x1"], rtol=0, atol=0)
