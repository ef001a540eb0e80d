"""Built-in articles and their stacks: names, seats, what counts, and what they say about themselves."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from geometry.article import Article, Box, Part, Placed, Shape, material, placed, seat_at, stacked
from geometry.articles import NAMES, SETUPS, built_in
from geometry.articles import parts as articles_parts
from geometry.articles.parts import load, to_si
from geometry.errors import BadInput
from geometry.frames import Pose, rotation_about

heights = st.floats(0.01, 2)


def brick(name: str, height: float = 0.1, seat: Pose | None = None) -> Article:
    shape = Shape(solids=(Placed(primitive=Box(size=np.array([0.1, 0.1, height]))),))
    pose = Pose(position=np.array([0.3, -0.2, 0.0]), rotation=rotation_about("y", 0.7))
    return Article(name=name, parts=(Part(name="body", material=material("steel"), shape=shape, pose=pose),), seat=seat)


@pytest.mark.parametrize("name", [*NAMES, *SETUPS, "disc+cuboid"])
def test_every_built_in_article_is_found_under_its_own_name_with_unique_parts(name: str) -> None:
    article = built_in(name)
    assert article.name == name
    assert article.counted_parts
    assert len({part.name for part in article.parts}) == len(article.parts)


@pytest.mark.parametrize("name", ["fmd", "clumod-1", "clumod-4", "fmd+clumod-4"])
def test_what_is_a_reconstruction_says_so(name: str) -> None:
    assert "reconstruction" in built_in(name).note


def test_a_stack_carries_the_notes_of_all_its_parts() -> None:
    note = built_in("fmd+disc+cuboid").note
    assert all(built_in(name).note in note for name in ("fmd", "disc", "cuboid"))


def test_the_cuboid_of_the_set_up_stands_on_the_disc_on_the_cover_plate() -> None:
    d = load("fmd")
    plate_top = d["load_cell"]["height"] / 2 + d["cover_plate"]["size"][2]
    poses = {part.name: part.pose.position for part in built_in("fmd+disc+cuboid").parts}
    assert_allclose(poses["disc/plate"], [0, 0, plate_top], rtol=0, atol=1e-15)
    assert_allclose(poses["cuboid/block"], [0, 0, plate_top + load("disc")["height"]], rtol=0, atol=1e-15)


def test_the_table_side_of_the_fmd_is_drawn_but_not_counted() -> None:
    uncounted = {part.name for part in built_in("fmd").parts if not part.counted}
    assert uncounted == {"mounting-plate", *(f"cell-{number}-fixed" for number in range(1, 5))}


@pytest.mark.parametrize(("fraction", "moving", "fixed"), [(0.0, 0, 4), (0.25, 4, 4), (1.0, 4, 0)])
def test_the_moving_fraction_of_the_load_cells_decides_what_counts(fraction: float, moving: int, fixed: int) -> None:
    d = load("fmd")
    d["load_cell"]["moving_fraction"] = fraction
    parts = articles_parts.build_fmd(d).parts
    assert sum(part.name.endswith("-moving") for part in parts) == moving
    assert sum(part.name.endswith("-fixed") for part in parts) == fixed
    volume = sum(s.primitive.volume for p in parts if p.name.endswith("-moving") for s in p.shape.solids)
    cell = np.pi / 4 * d["load_cell"]["diameter"] ** 2 * d["load_cell"]["height"]
    assert_allclose(volume, 4 * fraction * cell, rtol=1e-12)


def test_one_blade_is_four_blades_with_three_blades_taken_off_and_the_hubs_left() -> None:
    one, four = ({part.name for part in built_in(name).parts} for name in ("clumod-1", "clumod-4"))
    assert four - one == {"lower-2", "upper-long", "upper-short-bottom", "upper-short-silicone", "upper-short-top"}
    assert one < four
    assert {f"hub-{number}" for number in range(1, 5)} < one


def test_the_layer_in_the_shorter_upper_blade_is_a_body_of_silicone() -> None:
    parts = {part.name: part for part in built_in("clumod-4").parts}
    assert parts["upper-short-silicone"].material.name == "silicone"
    assert parts["upper-short-top"].material.name == "steel"


@given(heights, heights)
def test_each_article_sits_on_the_seat_of_the_one_below(first: float, second: float) -> None:
    stack = stacked(brick("a", seat=seat_at(first)), brick("b", seat=seat_at(second)), brick("c"))
    assert_allclose([part.pose.position[2] for part in stack.parts], [0, first, first + second], rtol=1e-15)
    assert [part.name for part in stack.parts] == ["a/body", "b/body", "c/body"]
    assert stack.name == "a+b+c"
    assert stack.seat is None


@given(heights, st.floats(-3, 3))
def test_a_turned_seat_turns_what_stands_on_it(height: float, angle: float) -> None:
    seat = Pose(position=np.array([0.1, 0.2, height]), rotation=rotation_about("z", angle))
    above = brick("b")
    top = stacked(brick("a", seat=seat), above).parts[1]
    assert_allclose(top.pose.apply([1, 0, 0]), seat.apply(above.parts[0].pose.apply([1, 0, 0])), rtol=0, atol=1e-14)


@given(heights, st.floats(-3, 3))
def test_placing_and_placing_back_changes_nothing(height: float, angle: float) -> None:
    pose = Pose(position=np.array([1.0, 2.0, 3.0]), rotation=rotation_about("x", angle))
    article = brick("a", seat=seat_at(height))
    back = placed(placed(article, pose), pose.inverse)
    assert back.seat is not None
    assert article.seat is not None
    for found, expected in ((back.parts[0].pose, article.parts[0].pose), (back.seat, article.seat)):
        assert_allclose(found.position, expected.position, rtol=0, atol=1e-14)
        assert_allclose(found.rotation, expected.rotation, rtol=0, atol=1e-14)


def test_a_single_article_is_its_own_stack() -> None:
    article = brick("a")
    assert stacked(article) is article


def test_two_articles_of_one_kind_can_stand_on_each_other() -> None:
    stack = built_in("disc+disc+cuboid")
    assert [part.name for part in stack.parts] == ["disc/plate", "disc-2/plate", "cuboid/block"]
    assert stack.note.count(built_in("disc").note) == 1


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("cubid", "no built-in article is called 'cubid'. Did you mean cuboid? Known are cuboid, disc, fmd"),
        ("fmd+clumod-3", "article fmd+clumod-3: no built-in article is called 'clumod-3'"),
        ("fmd+", "no built-in article is called ''"),
        ("cuboid+disc", "nothing can be mounted on cuboid, found disc above it. Name the stack from bottom to top"),
    ],
)
def test_a_name_that_cannot_be_built_is_refused_with_a_way_on(name: str, words: str) -> None:
    with pytest.raises(BadInput) as caught:
        built_in(name)
    assert words in str(caught.value)


def test_nothing_stands_where_there_is_no_seat() -> None:
    with pytest.raises(ValueError, match="nothing can be mounted on a, found b"):
        stacked(brick("a"), brick("b"))


def test_part_names_are_unique_within_an_article() -> None:
    part = brick("a").parts[0]
    with pytest.raises(ValueError, match="found body more than once"):
        Article(name="twice", parts=(part, part))


def test_dimension_files_leave_their_units_at_the_door() -> None:
    table = {
        "length_mm": 10.0,
        "size_mm": [1.0, 2.0],
        "angle_deg": 180.0,
        "count": 4,
        "hub": {"d_mm": 5},
        "blade": [{"z_mm": 1.0}],
    }
    found = to_si(table)
    assert set(found) == {"length", "size", "angle", "count", "hub", "blade"}
    assert_allclose(
        [found["length"], *found["size"], found["hub"]["d"], found["blade"][0]["z"]], [0.01, 0.001, 0.002, 0.005, 0.001]
    )
    assert_allclose(found["angle"], np.pi, rtol=1e-15)
    assert found["count"] == 4
