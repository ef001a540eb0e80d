"""A user's own dimensions: they reach the drawing, and what cannot be is refused by name."""

import pytest

from geometry.articles import built_in
from geometry.errors import BadInput
from geometry.routes import inertia


def test_the_moving_part_of_the_load_cells_is_a_parameter() -> None:
    """Steel cells of 80 x 10 mm: a tenth more of each moves, so four times a tenth of a cell more is counted."""
    more = inertia(built_in("fmd", {"fmd.load_cell.moving_fraction": 0.6})).mass - inertia(built_in("fmd")).mass
    assert more == pytest.approx(4 * 0.1 * 7850 * 3.141592653589793 / 4 * 0.08**2 * 0.01, rel=1e-9)


def test_a_blade_is_named_in_the_list_of_blades() -> None:
    shorter = built_in("clumod-1", {"clumod.blade.lower-1.length_mm": 1000.0})
    assert inertia(shorter).mass < inertia(built_in("clumod-1")).mass


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


def test_a_list_of_blades_is_a_table_of_them() -> None:
    with pytest.raises(BadInput, match=r"a table of dimensions. Name one of clumod\.blade\.lower-1,"):
        built_in("clumod-1", {"clumod.blade": 1.0})


@pytest.mark.parametrize(
    ("key", "message"),
    [("cuboid.size_mm", r"found \[160\.0, 70\.0, 400\.0\]. Name a number"), ("cuboid.size_mm.x", "there is no 'x' here")],
)
def test_a_list_of_numbers_is_no_number(key: str, message: str) -> None:
    with pytest.raises(BadInput, match=message):
        built_in("cuboid", {key: 1.0})


def test_a_thread_is_no_deeper_than_the_block_that_it_is_cut_into() -> None:
    with pytest.raises(BadInput, match=r"threads.*0\.4 m, found 5 m"):
        built_in("cuboid", {"cuboid.threads.depth_mm": 5000.0})
