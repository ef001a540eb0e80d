"""Built-in articles and their stacks: drawings, names, seats, places, own dimensions, what counts, and what is published."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from geometry import cad
from geometry.article import Article, Box, Cylinder, Material, Part, Placed, Shape, library, material, seat_at, stacked
from geometry.articles import NAMES, SETUPS, built_in, locations, seats
from geometry.articles import parts as articles_parts
from geometry.articles.parts import build_clumod, load
from geometry.errors import BadInput
from geometry.frames import Pose, rotation_about
from geometry.routes import inertia

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


def test_nothing_stands_where_there_is_no_seat_and_part_names_are_unique_within_an_article() -> None:
    with pytest.raises(ValueError, match="nothing can be mounted on a, found b"):
        stacked(brick("a"), brick("b"))
    part = brick("a").parts[0]
    with pytest.raises(ValueError, match="found body more than once"):
        Article(name="twice", parts=(part, part))


@pytest.mark.parametrize("wrong", [0.0, -1.0, np.nan, np.inf])
def test_a_length_that_cannot_be_is_named_with_what_was_found(wrong: float) -> None:
    with pytest.raises(ValueError, match="`diameter` must be positive and finite"):
        Cylinder(diameter=wrong, height=1.0)
    with pytest.raises(ValueError, match="`height` must be positive and finite"):
        Cylinder(diameter=1.0, height=wrong)
    with pytest.raises(ValueError, match="`size` must be"):
        Box(size=np.array([1.0, wrong, 1.0]))


def test_a_box_has_three_edges_and_they_cannot_be_changed() -> None:
    with pytest.raises(ValueError, match=r"`size` must have shape \(3,\), found \(2,\)"):
        Box(size=np.ones(2))
    with pytest.raises(ValueError, match="read-only"):
        Box(size=np.ones(3)).size[0] = 2.0


def test_voids_that_take_away_more_than_there_is_are_refused() -> None:
    """Spatial algebra would pass through zero mass, where Pinocchio returns figures of any size without a word."""
    block, hole = Placed(primitive=Box(size=[0.1, 0.1, 0.1])), Placed(primitive=Box(size=[0.1, 0.1, 0.2]))
    with pytest.raises(ValueError, match="take away less than there is"):
        Shape(solids=(block,), voids=(hole,))


@pytest.mark.parametrize("density", [0.0, -7850.0, float("nan"), float("inf")])
def test_a_density_that_no_material_has_is_refused_in_words(density: float) -> None:
    with pytest.raises(BadInput, match=r"material lead: `density`: .* found .* kg/m³\. Give it in kg/m³") as caught:
        Material(name="lead", density=density)
    assert (caught.value.source, caught.value.field) == ("material lead", "density")


def test_the_library_knows_what_the_articles_are_made_of_by_their_own_names() -> None:
    assert {"steel", "aluminium", "silicone"} <= set(library())
    assert all(entry.name == name for name, entry in library().items())
    assert material("steel").density == 7850.0
    assert material("steel").youngs_modulus == 207e9


def test_an_unknown_material_is_refused_with_the_list_of_the_known() -> None:
    with pytest.raises(BadInput, match=r"parts\.toml: `material`: no material is called 'stel'.*aluminium.*steel"):
        material("stel", source="parts.toml")


def test_the_library_cannot_be_changed() -> None:
    entries: Any = library()
    with pytest.raises(TypeError):
        entries["steel"] = Material(name="steel", density=1.0)


def test_a_change_acts_in_a_stack_and_nowhere_else() -> None:
    changes = {"disc.height_mm": 20.0}
    stack = built_in("fmd+disc+cuboid", changes)
    cuboid = next(part for part in stack.parts if part.name == "cuboid/block")
    assert cuboid.pose.position[2] == pytest.approx(0.045 + 0.020)
    assert inertia(built_in("disc")).mass < inertia(built_in("disc", changes)).mass


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"fmd.load_cel.height_mm": 1.0}, "Did you mean load_cell"),
        ({"fmd.load_cell.heigth_mm": 1.0}, "Did you mean height_mm"),
        ({"fmd": 1.0}, r"a table of dimensions. Name one of fmd\.\w+"),
        ({"fmd.": 1.0}, "there is no ''"),
        ({"fmd.cover_plate": 1.0}, r"this is a table of dimensions. Name one of .*fmd\.cover_plate\.threads"),
        ({"fmd.nothing": 1.0}, r"^--set, dimension file fmd\.toml: `fmd\.nothing`: there is no 'nothing' here"),
        ({"fmd.note": 1.0}, "only a number can be changed"),
        ({"fmd.note.more": 1.0}, "no further entries"),
        ({"fmd.cover_plate.threads.count": 7.5}, "a count, found 7.5"),
        ({"cuboid.threads.depth_mm": 1.0}, "made of fmd"),
        ({"fmd.load_cell.diameter_mm": -1.0}, "no body has the dimensions fmd.load_cell.diameter_mm=-1"),
        ({"fmd.load_cell.moving_fraction": 1.2}, "between 0 and 1"),
    ],
)
def test_what_cannot_be_is_refused(changes: dict[str, float], message: str) -> None:
    with pytest.raises(BadInput, match=message):
        built_in("fmd", changes)


@pytest.mark.parametrize(
    ("name", "key", "value", "message"),
    [
        ("clumod-1", "clumod.blade", 1.0, r"a table of dimensions. Name one of clumod\.blade\.lower-1,"),
        ("cuboid", "cuboid.size_mm", 1.0, r"found \[160\.0, 70\.0, 400\.0\]. Name a number"),
        ("cuboid", "cuboid.size_mm.x", 1.0, "there is no 'x' here"),
        ("cuboid", "cuboid.threads.depth_mm", 5000.0, r"threads.*0\.4 m, found 5 m"),
    ],
)
def test_a_list_is_no_number_and_a_thread_no_deeper_than_its_block(name: str, key: str, value: float, message: str) -> None:
    with pytest.raises(BadInput, match=message):
        built_in(name, {key: value})


# Half a unit of the last printed digit of the moments (Tables 1 and 2); 5 g and 0.05 mm as the reference table promises.
PRINTED = {"clumod-4": ("four_blades", 0.0005), "clumod-1": ("one_blade", 0.005)}


@pytest.mark.parametrize("name", PRINTED)
def test_published_inertia_comes_out(name: str, shared: Path) -> None:
    key, half_a_unit = PRINTED[name]
    published = json.loads((shared / "clumod" / "reconstruction.json").read_text())["published"][key]
    inertia = cad.inertia(built_in(name))
    assert_allclose(inertia.mass, published["mass_kg"], rtol=0, atol=0.005)
    assert_allclose(inertia.cog * 1e3, published["cog_mm"], rtol=0, atol=0.05)
    assert_allclose(inertia.moments_cog, published["Ixx_Iyy_Izz_cog_kgm2"], rtol=0, atol=half_a_unit)


@pytest.mark.parametrize("name", PRINTED)
def test_clumod_is_symmetrical(name: str) -> None:
    inertia = cad.inertia(built_in(name))
    assert_allclose(inertia.cog[:2], 0, atol=1e-12)
    assert_allclose(inertia.products_cog, 0, atol=1e-12)


def test_taking_blades_off_leaves_every_other_part_where_it_was() -> None:
    four = {part.name: part for part in built_in("clumod-4").parts}
    for part in built_in("clumod-1").parts:
        assert_allclose(part.pose.position, four[part.name].pose.position, rtol=0)
        assert len(part.shape.solids) == len(four[part.name].shape.solids)


def test_only_the_shorter_upper_blade_holds_silicone_and_in_its_neutral_axis() -> None:
    parts = {part.name: part for part in built_in("clumod-4").parts}
    assert [name for name, part in parts.items() if part.material.name == "silicone"] == ["upper-short-silicone"]
    layer, faces = parts["upper-short-silicone"], (parts["upper-short-bottom"], parts["upper-short-top"])
    middle = [part.pose.apply(part.shape.solids[0].pose.position)[2] for part in (layer, *faces)]
    assert middle[0] == pytest.approx(np.mean(middle[1:]), abs=1e-12)
    assert middle[1] < middle[0] < middle[2]


def test_a_blade_and_its_hub_hold_their_bolts_in_the_same_places() -> None:
    article = build_clumod(("lower-2",))
    parts = {part.name: part for part in article.parts}
    places = [
        {tuple(np.round(part.pose.apply(void.pose.position)[:2], 9)) for void in part.shape.voids}
        for part in (parts["hub-2"], parts["lower-2"])
    ]
    assert places[0] == places[1]


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


def test_a_stack_has_the_places_of_all_its_articles_and_a_second_one_of_a_kind_says_so() -> None:
    places = locations("disc+disc+cuboid")
    assert {"disc", "disc-2/disc", "top", "top-4"} < set(places)
    assert_allclose(places["disc-2/disc"], 2 * places["disc"], rtol=1e-15)


def test_places_follow_the_users_own_dimensions() -> None:
    changes = {"clumod.blade.lower-1.length_mm": 1000.0, "clumod.mast.top_mm": 1650.0, "fmd.cover_plate.threads.depth_mm": 25.0}
    places = locations("fmd+clumod-1", changes, origin="top")
    assert_allclose(places["lower-1-"][1], -0.5, rtol=1e-15)
    assert_allclose(places["mast-top"], [0, 0, 1.65], rtol=0, atol=1e-15)
