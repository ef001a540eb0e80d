"""Named places of the built-in articles: they lie on the bodies that they are named after, follow the dimensions, and stack."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.article import Article, Box, Part
from geometry.articles import NAMES, SETUPS, built_in
from geometry.articles.locations import locations, seats
from geometry.frames import Pose

STACKS = [*NAMES, *SETUPS, "disc+cuboid", "disc+disc+cuboid"]
"""Every article and stack that is tried here."""

CAMPAIGN = ("flange", "hub-1", "hub-2", "hub-3", "hub-4", "mast-top", "lower-1+", "lower-1-")
"""The names that campaign folders know on Clumod with one blade."""

UPPER = ("lower-2+", "lower-2-", "upper-long+", "upper-long-", "upper-short+", "upper-short-")
"""Those of the blades that are taken off."""


def part(article: Article, name: str) -> Part:
    return next(found for found in article.parts if found.name == name)


def bounds(body: Part) -> tuple[np.ndarray, np.ndarray]:
    """Smallest and largest coordinate of the solids of `body`, from their corners (of a cylinder: those of its box)."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2
    points = [body.pose.apply(placed.pose.apply(corners * extent(placed.primitive))) for placed in body.shape.solids]
    return np.min(np.vstack(points), axis=0), np.max(np.vstack(points), axis=0)


def extent(primitive: object) -> list[float]:
    if isinstance(primitive, Box):
        return list(primitive.size)
    return [primitive.diameter, primitive.diameter, primitive.height]


def test_clumod_has_the_places_of_the_campaign_folder_and_no_tips_of_blades_that_are_off() -> None:
    assert set(locations("clumod-1")) == set(CAMPAIGN)
    assert set(locations("clumod-4")) == {*CAMPAIGN, *UPPER}


@pytest.mark.parametrize("place", CAMPAIGN)
def test_what_both_configurations_have_is_at_the_same_place(place: str) -> None:
    assert_allclose(locations("clumod-1")[place], locations("clumod-4")[place], rtol=0, atol=0)


@pytest.mark.parametrize("blade", ["lower-1", "lower-2", "upper-long", "upper-short"])
@pytest.mark.parametrize("sign", ["+", "-"])
def test_a_tip_lies_in_the_end_face_of_its_blade_on_the_side_of_its_sign(blade: str, sign: str) -> None:
    bodies = [body for body in built_in("clumod-4").parts if body.name.startswith(blade)]
    low, high = np.min([bounds(b)[0] for b in bodies], axis=0), np.max([bounds(b)[1] for b in bodies], axis=0)
    axis = int(np.argmax(high - low))
    expected = (low + high) / 2
    expected[axis] = high[axis] if sign == "+" else low[axis]
    assert_allclose(locations("clumod-4")[f"{blade}{sign}"], expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_a_hub_is_found_in_the_middle_of_its_collars(number: int) -> None:
    low, high = bounds(part(built_in("clumod-4"), f"hub-{number}"))
    assert_allclose(locations("clumod-4")[f"hub-{number}"], (low + high) / 2, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("article", "place", "body"),
    [
        ("clumod-4", "mast-top", "mast"),
        ("clumod-4", "flange", "flange"),
        ("cuboid", "top", "block"),
        ("disc", "disc", "plate"),
        ("fmd", "cover", "cover-plate"),
    ],
)
def test_a_place_on_top_is_the_middle_of_the_upper_side(article: str, place: str, body: str) -> None:
    low, high = bounds(part(built_in(article), body))
    assert_allclose(locations(article)[place], [*(low + high)[:2] / 2, high[2]], rtol=0, atol=1e-12)


@pytest.mark.parametrize(("article", "side", "body"), [("cuboid", "top", "block"), ("fmd", "cover", "cover-plate")])
def test_corners_are_numbered_counter_clockwise_from_x_and_y_like_the_load_cells(article: str, side: str, body: str) -> None:
    low, high = bounds(part(built_in(article), body))
    expected = [[high[0], high[1]], [low[0], high[1]], [low[0], low[1]], [high[0], low[1]]]
    found = [locations(article)[f"{side}-{number}"] for number in range(1, 5)]
    assert_allclose(found, [[*corner, high[2]] for corner in expected], rtol=0, atol=1e-12)


@pytest.mark.parametrize("name", STACKS)
def test_every_place_lies_within_the_article(name: str) -> None:
    low, high = np.transpose([bounds(body) for body in built_in(name).parts], (1, 0, 2))
    for position in locations(name).values():
        assert np.all(position >= low.min(axis=0) - 1e-12)
        assert np.all(position <= high.max(axis=0) + 1e-12)


@pytest.mark.parametrize("name", STACKS)
def test_about_the_top_article_everything_is_shifted_by_its_seat(name: str) -> None:
    own, lowest, seat = locations(name, origin="top"), locations(name), seats(name)[-1]
    assert set(own) == set(lowest)
    for place, position in own.items():
        assert_allclose(seat.apply(position), lowest[place], rtol=0, atol=1e-15)


@pytest.mark.parametrize("top", ["clumod-1", "clumod-4", "cuboid"])
def test_on_the_fmd_an_article_keeps_its_places_about_its_own_origin(top: str) -> None:
    alone, mounted = locations(top), locations(f"fmd+{top}", origin="top")
    for place, position in alone.items():
        assert_allclose(mounted[place], position, rtol=0, atol=1e-15)


def test_the_place_between_two_articles_belongs_to_both() -> None:
    """What stands on the cover plate has its origin there."""
    assert_allclose(locations("fmd+clumod-4")["cover"], seats("fmd+clumod-4")[1].position, rtol=0, atol=1e-15)
    assert_allclose(locations("fmd+clumod-4", origin="top")["cover"], 0, rtol=0, atol=1e-15)


def test_a_stack_has_the_places_of_all_its_articles_and_a_second_one_of_a_kind_says_so() -> None:
    places = locations("disc+disc+cuboid")
    assert {"disc", "disc-2/disc", "top", "top-4"} < set(places)
    assert_allclose(places["disc-2/disc"], 2 * places["disc"], rtol=1e-15)


def test_the_seats_of_a_stack_are_where_its_parts_are() -> None:
    heights = [pose.position[2] for pose in seats("fmd+disc+cuboid")]
    parts = {body.name: body.pose.position[2] for body in built_in("fmd+disc+cuboid").parts}
    assert_allclose(heights, [0.0, parts["disc/plate"], parts["cuboid/block"]], rtol=0, atol=1e-15)
    assert_allclose(seats("cuboid")[0].position, Pose().position, rtol=0, atol=0)


def test_places_follow_the_users_own_dimensions() -> None:
    changes = {"clumod.blade.lower-1.length_mm": 1000.0, "clumod.mast.top_mm": 1650.0, "fmd.cover_plate.threads.depth_mm": 25.0}
    places = locations("fmd+clumod-1", changes, origin="top")
    assert_allclose(places["lower-1-"][1], -0.5, rtol=1e-15)
    assert_allclose(places["mast-top"], [0, 0, 1.65], rtol=0, atol=1e-15)
