"""Channels: their rows of [G], what sums of cells give, and what can be told from a table of them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from geometry.frames import rigid_transformation
from geometry.inertia import LOADS, of_motions, of_resultants
from geometry.sensors import Channel, ChannelTable, Place, motion_rows, resultants, row

X, Y, Z = np.eye(3)
CORNERS = ((0.13, 0.13, 0.0), (-0.13, 0.13, 0.0), (-0.13, -0.13, 0.0), (0.13, -0.13, 0.0))

coordinates = st.tuples(*[st.floats(-2.0, 2.0)] * 3)
directions = coordinates.filter(lambda v: np.linalg.norm(v) > 0.1).map(lambda v: np.array(v) / np.linalg.norm(v))


def cell(name: str, *places: tuple[tuple[float, float, float], np.ndarray], quantity: str = "force") -> Channel:
    at = tuple(Place(position=np.array(position), direction=along) for position, along in places)
    return Channel(name=name, quantity=quantity, group="fmd", places=at)


def pickup(name: str, at: tuple[float, float, float], along: np.ndarray, group: str = "cover") -> Channel:
    return Channel(name=name, quantity="acceleration", group=group, places=(Place(position=np.array(at), direction=along),))


def paper() -> list[Channel]:
    sums = [cell("x12", (CORNERS[0], X), (CORNERS[1], X)), cell("x34", (CORNERS[2], X), (CORNERS[3], X))]
    sums += [cell("y14", (CORNERS[0], Y), (CORNERS[3], Y)), cell("y23", (CORNERS[1], Y), (CORNERS[2], Y))]
    return sums + [cell(f"z{k}", (at, Z)) for k, at in enumerate(CORNERS, start=1)]


@given(coordinates, directions, coordinates, st.tuples(*[st.floats(-3, 3)] * 6))
def test_an_accelerometer_reads_eq_3_along_its_direction(
    at: tuple[float, ...], along: np.ndarray, point: tuple[float, ...], motion: tuple[float, ...]
) -> None:
    place = Place(position=np.array(at), direction=along)
    arm = np.array(at) - np.array(point)
    expected = along @ (np.array(motion[:3]) + np.cross(motion[3:], arm))
    # cancellation of a few terms below 50
    assert_allclose(row(place, point) @ motion, expected, rtol=0, atol=1e-13 * 50)
    assert_allclose(row(place, point), place.direction @ rigid_transformation(arm), rtol=0, atol=1e-14)


@given(st.lists(st.floats(-50, 50), min_size=12, max_size=12), coordinates)
def test_eight_channels_give_the_resultants_of_the_twelve_cell_forces(forces: list[float], point: tuple[float, ...]) -> None:
    """Whatever the twelve forces are: the paper's sums lie on lines of action, so nothing of their resultants is lost."""
    f = np.array(forces).reshape(4, 3)
    y = [f[0, 0] + f[1, 0], f[2, 0] + f[3, 0], f[0, 1] + f[3, 1], f[1, 1] + f[2, 1], *f[:, 2]]
    arms = np.array(CORNERS) - np.array(point)
    expected = np.concatenate([f.sum(axis=0), np.cross(arms, f).sum(axis=0)])
    assert_allclose(resultants(paper(), point) @ y, expected, rtol=0, atol=1e-11)


def test_power_is_that_of_the_resultants() -> None:
    """Reciprocity: a cell's row for motion is the column of its resultants."""
    single = cell("z1", (CORNERS[0], Z))
    assert_allclose(resultants([single], np.zeros(3))[:, 0], motion_rows([single], np.zeros(3))[0], rtol=0, atol=1e-15)


def test_a_moment_channel_gives_a_moment_wherever_it_sits() -> None:
    moment = cell("t", ((0.3, 0.2, 0.1), Z), quantity="moment")
    assert_allclose(resultants([moment], np.zeros(3))[:, 0], [0, 0, 0, 0, 0, 1], rtol=0, atol=0)


def test_the_papers_channels_tell_all_six_resultants() -> None:
    verdict = of_resultants(ChannelTable(channels=tuple(paper())))
    assert verdict.complete
    assert verdict.missing == ()
    assert 1 <= verdict.condition < 2


@pytest.mark.parametrize(
    ("dropped", "missing"),
    [(("x12", "x34"), ("f_x",)), (("y14", "y23"), ("f_y",)), (("z1", "z2", "z3", "z4"), ("f_z", "t_x", "t_y"))],
)
def test_what_is_missing_is_named(dropped: tuple[str, ...], missing: tuple[str, ...]) -> None:
    kept = tuple(channel for channel in paper() if channel.name not in dropped)
    verdict = of_resultants(ChannelTable(channels=kept))
    assert verdict.missing == missing
    assert verdict.rank == 6 - len(missing)
    assert all(name in verdict.text for name in missing)
    assert np.isinf(verdict.condition)


def test_a_sum_of_cells_off_one_line_of_action_hides_its_moments() -> None:
    """All four vertical cells on one channel: the force is known, where it acts is not."""
    table = ChannelTable(channels=(*paper()[:4], cell("z", *((at, Z) for at in CORNERS))))
    verdict = of_resultants(table)
    assert verdict.missing == ("t_x", "t_y")
    assert verdict.rank == 4
    assert "one line of action" in verdict.text


def test_a_summed_and_a_single_reading_of_the_same_cells_agree() -> None:
    doubled = [*paper(), cell("z12", (CORNERS[0], Z), (CORNERS[1], Z))]
    forces = np.array([1.0, 2, 3, 4, 5, 6, 7, 8])
    expected = resultants(paper(), np.zeros(3)) @ forces
    assert_allclose(resultants(doubled, np.zeros(3)) @ [*forces, 5 + 6], expected, rtol=1e-12, atol=1e-12)


def test_three_vertical_pickups_leave_the_motions_of_the_plane() -> None:
    ups = tuple(pickup(f"z{k}", at, Z) for k, at in enumerate(CORNERS[:3]))
    verdict = of_motions(ChannelTable(channels=ups), ("cover",))
    assert (verdict.rank, verdict.missing) == (3, ("x", "y", "gamma"))


def test_a_combination_that_no_channel_sees_is_written_out() -> None:
    """Two pick-ups along x, both 0.2 m above F, read x + 0.2 beta: x = 0.2 m/s² with beta = -1 rad/s² moves neither."""
    table = ChannelTable(
        channels=(
            pickup("x1", (0.0, 0.1, 0.2), X),
            pickup("x2", (0.0, -0.1, 0.2), X),
            pickup("y", (0.0, 0.0, 0.0), Y),
            pickup("z1", (0.0, 0.1, 0.0), Z),
            pickup("z2", (0.0, -0.1, 0.0), Z),
        )
    )
    verdict = of_motions(table, ("cover",))
    assert (verdict.rank, verdict.missing) == (5, ("x", "beta"))
    assert "0.2 x - 1 beta is seen by no channel" in verdict.text


def test_the_condition_does_not_depend_on_the_unit_of_length() -> None:
    """Everything ten times as large: the same verdict, because rotations are scaled by the lever."""
    spots = [((0.2, 0.1, 0.0), X), ((0.2, -0.1, 0.0), X), ((0.1, 0.2, 0.1), Y), *[((a, b, 0.0), Z) for a, b, _ in CORNERS[:3]]]
    tables = [
        ChannelTable(channels=tuple(pickup(str(k), tuple(s * np.array(at)), along) for k, (at, along) in enumerate(spots)))
        for s in (1.0, 10.0)
    ]
    small, large = (of_motions(table, ("cover",)) for table in tables)
    assert_allclose(large.condition, small.condition, rtol=1e-9)
    assert_allclose(large.lever, 10 * small.lever, rtol=1e-12)


def test_a_direction_of_another_length_is_refused() -> None:
    with pytest.raises(ValueError, match="unit vector"):
        Place(position=np.zeros(3), direction=np.array([0.0, 0.0, 1.1]))


def test_a_direction_typed_with_four_digits_is_brought_to_length_one() -> None:
    place = Place(position=np.zeros(3), direction=np.array([0.7071, 0.7071, 0.0]))
    assert_allclose(np.linalg.norm(place.direction), 1.0, rtol=1e-15)


def test_two_channels_of_one_name_are_refused() -> None:
    with pytest.raises(ValueError, match="z1"):
        ChannelTable(channels=(cell("z1", (CORNERS[0], Z)), cell("z1", (CORNERS[1], Z))))


def test_nothing_that_is_no_accelerometer_senses_gravity() -> None:
    assert pickup("a", (0, 0, 0), X).senses_gravity
    assert not cell("z1", (CORNERS[0], Z)).senses_gravity


def test_no_channels_tell_nothing() -> None:
    empty = ChannelTable(channels=())
    assert of_resultants(empty).missing == LOADS
    assert of_motions(empty, ("cover",)).rank == 0
