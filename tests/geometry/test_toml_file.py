"""What users write down: TOML and JSON at the door, quantities with units and tolerances, files damaged at random."""

from pathlib import Path

import numpy as np
import pint
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from uncertainties import UFloat

from benchmarks.fuzz_readers import mutants
from geometry import toml_file
from geometry.errors import BadInput
from geometry.toml_file import doubtful_at_first_order, exact, quantity, tagged
from geometry.user_article import inertias, load
from validation.classical.files import dominating, itemised
from validation.classical.pendulum import rope_pendulum
from validation.cli.main import run


def written(folder: Path, content: str | bytes, ending: str = "toml") -> str:
    path = folder / f"file.{ending}"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return str(path)


@pytest.mark.parametrize(
    ("content", "ending", "words"),
    [
        ("a = " + "[" * 100_000, "toml", "nested too deeply"),
        ("[" * 100_000, "json", "nested too deeply"),
        (".".join("a" * 2000) + " = 1", "toml", "nested too deeply"),
        ("a = " + "[" * 30 + "]" * 30, "toml", "nested too deeply"),
        (b"a = '\xff'", "toml", "not text in UTF-8, found the byte 0xff at place 5"),
        ("a = 1\nb = ", "toml", "not TOML: Invalid value (at end of document"),
        ("a = " + "9" * 5000, "toml", "not TOML"),
        ("a = " + "9" * 400, "toml", "hundreds of digits"),
        ('{"a": 1,}', "json", "not JSON"),
        ('{"a": NaN}', "json", "must be finite, found NaN"),
        ("[1]", "json", "one JSON object"),
    ],
)
def test_a_file_that_is_no_table_is_refused_by_what_it_is(tmp_path: Path, content: str | bytes, ending: str, words: str) -> None:
    name = written(tmp_path, content, ending)
    with pytest.raises(BadInput) as caught:
        toml_file.read(name)
    assert words in caught.value.problem
    assert caught.value.source == name


@pytest.mark.parametrize(
    ("name", "words"),
    [("", "name is empty"), (".", "is a folder"), ("/dev/null", "is a device"), ("nothing.toml", "no such file")],
)
def test_what_is_no_file_is_said(name: str, words: str) -> None:
    with pytest.raises(BadInput, match=words) as caught:
        toml_file.read(name, remedy="Shipped are these")
    assert caught.value.remedy == "Shipped are these"


def test_a_damaged_file_is_still_known_by_its_table(tmp_path: Path) -> None:
    """So that a place that is named twice is said, and nobody takes a model for a drawing."""
    for text, known in (("[model.places]\na = 1\na = 2\n", True), ("[other]\na = 1\na = 2\n", False), ("[model]\n", True)):
        (tmp_path / "a.toml").write_text(text)
        assert toml_file.holds(tmp_path / "a.toml", "model") is known


def test_tables_within_reason_are_read(tmp_path: Path) -> None:
    assert toml_file.read(written(tmp_path, "a = [[[1, 2]]]\n[b.c.d]\ne = 1e400")) == {
        "a": [[[1, 2]]],
        "b": {"c": {"d": {"e": float("inf")}}},
    }


DOORS = (
    ("weigh", "{}"),
    ("cog", "{}"),
    ("pendulum", "{}"),
    ("validate", "{}", "--against", "clumod-1"),
    ("reference", "{}"),
    ("reference", "cuboid", "--frame", "{}"),
    ("reference", "cuboid", "--identified", "{}"),
)


@pytest.mark.parametrize("words", DOORS, ids=" ".join)
def test_every_door_refuses_a_file_that_is_nested_too_deeply(
    words: tuple[str, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name = written(tmp_path, "a = " + "[" * 100_000)
    assert run([word.format(name) for word in words]) == 2
    assert "nested too deeply" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("weigh", "."), "is a folder, where a file is needed. Shipped with massline are clumod"),
        (("weigh", ""), "the name is empty, found ''. Shipped with massline are clumod"),
        (("validate", "clumod-4-weighing", "--against", "clumod-4"), "Give a result file, or one that ships: clumod-1-table2"),
        (("validate", "clumod-1-tabel2", "--against", "clumod-1"), "Did you mean clumod-1-table2"),
    ],
)
def test_what_ships_is_said_where_nothing_can_be_read(
    words: tuple[str, ...], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(list(words)) == 2
    assert said in capsys.readouterr().err


def test_a_refusal_ends_with_one_mark_only() -> None:
    asked = BadInput("a.toml", "k", "is unknown", "Did you mean l? ")
    told = BadInput("a.toml", "k", "is unknown", "Write l.")
    assert (str(asked), str(told)) == ("a.toml: `k`: is unknown. Did you mean l?", "a.toml: `k`: is unknown. Write l.")


def read(text: object, dimension: str = "mass") -> UFloat:
    return quantity(text, dimension, source="file.toml", field="article.mass")


@pytest.mark.parametrize(
    ("text", "dimension", "value", "tolerance"),
    [
        ("47.40 +/- 0.05 kg", "mass", 47.4, 0.05),
        ("47.40 ± 0.05 kg", "mass", 47.4, 0.05),
        ("(47.40 +/- 0.05) kg", "mass", 47.4, 0.05),
        ("47.40 kg +/- 50 g", "mass", 47.4, 0.05),
        ("47.40 kg ± 0.1 %", "mass", 47.4, 0.0474),
        ("603.0 +/- 0.5 mm", "length", 0.603, 0.0005),
        ("9.81 m/s^2", "acceleration", 9.81, 0.0),
        ("9.81 m/s²", "acceleration", 9.81, 0.0),
        ("0.3 %", "ratio", 0.003, 0.0),
        ("0.003", "ratio", 0.003, 0.0),
        ("180 deg", "angle", np.pi, 0.0),
        ("1.9e3 +/- 1 ms", "time", 1.9, 1e-3),
        ("-5 mm", "length", -0.005, 0.0),
    ],
)
def test_what_people_write_is_understood(text: str, dimension: str, value: float, tolerance: float) -> None:
    found = read(text, dimension)
    assert_allclose([found.nominal_value, found.std_dev], [value, tolerance], rtol=1e-14)


@pytest.mark.parametrize(
    ("text", "dimension", "words"),
    [
        ("47.4", "mass", "needs its unit"),
        (47.4, "mass", "bare number 47.4"),
        ("300 mm", "mass", "'mm' is a length, where a mass should be"),
        ("47 N", "mass", "'N' is a force, where a mass should be"),
        ("5 %", "angle", "a pure number, where an angle"),
        ("1 rad", "ratio", "an angle, where a ratio"),
        ("5 kgm", "mass", "'kgm' is not known"),
        ("5 +/- -1 kg", "mass", "must not be negative"),
        ("1e400 kg", "mass", "finite"),
        ("1e30 kg", "mass", "no measured mass has this size"),
        ("nan kg", "mass", "cannot be read"),
        ("1,5 kg", "mass", "cannot be read"),
        ("5 kg +/- 1", "mass", "tolerance needs its unit"),
        (True, "mass", "cannot be read"),
        (None, "mass", "cannot be read"),
        (["1 kg"], "mass", "cannot be read"),
    ],
)
def test_everything_else_is_refused_with_file_field_and_an_example(text: object, dimension: str, words: str) -> None:
    with pytest.raises(BadInput) as refusal:
        read(text, dimension)
    assert words in str(refusal.value)
    assert "file.toml: `article.mass`" in str(refusal.value)
    assert "Write it like" in str(refusal.value)


@pytest.mark.parametrize("text", ["2.1e-149 m", "-3.1e-17 m", "1e-400 m", "1e-16 +/- 1e-17 m", "0 +/- 1e-200 m"])
def test_the_rounding_that_is_left_of_a_zero_is_zero(text: str) -> None:
    found = read(text, "length")
    assert (found.nominal_value, found.std_dev) == (0.0, 0.0)


@settings(max_examples=12)  # pint takes its time to refuse one
@given(st.text(max_size=20))
def test_no_text_ends_in_another_error(text: str) -> None:
    try:
        found = read(text)
    except BadInput:
        return
    assert np.isfinite(found.nominal_value)


SWING = {
    "mass": (47.4, 0.05),
    "gravity": (9.811, 0.001),
    "s1": (0.55, 0.002),
    "s2": (0.9, 0.003),
    "length": (2.0, 0.002),
    "period": (3.0, 0.004),
}


def test_first_order_agrees_with_monte_carlo_on_eq_5() -> None:
    result = rope_pendulum(**{name: tagged(*pair, name) for name, pair in SWING.items()})
    rng = np.random.default_rng(5)
    drawn = rope_pendulum(**{name: rng.normal(*pair, size=200_000) for name, pair in SWING.items()})
    # 200 000 draws know a standard deviation to 0.16 %, a mean to 0.002 of it; second order adds less than 1e-4
    assert_allclose(result.std_dev, drawn.std(), rtol=0.007)
    assert_allclose(result.nominal_value, drawn.mean(), atol=0.012 * result.std_dev)


def test_first_order_fails_where_the_library_says_it_is_doubtful() -> None:
    wide = tagged(3.0, 1.0, "period")
    assert doubtful_at_first_order(3.0, 1.0)
    drawn = np.random.default_rng(1).normal(3.0, 1.0, size=100_000) ** 2
    assert drawn.mean() > 1.1 * (wide**2).nominal_value  # E[T²] = T² + σ²: the first order sees none of it


def test_shares_add_up_and_follow_the_exponents_of_eq_5() -> None:
    items = itemised(rope_pendulum(**{name: tagged(*pair, name) for name, pair in SWING.items()}))
    assert_allclose(sum(item.share for item in items), 1.0, rtol=1e-12)
    by_name = {item.name: item for item in items}
    # T enters squared: 2 x 0.004/3.0; s1 once: 0.002/0.55
    assert_allclose(by_name["period"].contribution / by_name["s1"].contribution, (2 * 0.004 / 3) / (0.002 / 0.55), rtol=1e-12)
    assert items[0].name == "s1"


def test_inputs_of_one_name_are_taken_together() -> None:
    (item,) = itemised(tagged(1, 0.3, "reading") + tagged(1, 0.4, "reading"))
    assert_allclose(item.contribution, 0.5, rtol=1e-14)


def test_an_exact_value_has_no_dominating_input() -> None:
    assert dominating(exact(3.0)) == ""


DESCRIPTION = """format = 1
[article]
name = "block"
[material.lead]
density = "11.34 g/cm^3"
[[part]]
name = "block"
file = "block.stl"
unit = "mm"
material = "lead"
position_mm = [1, 2, 3]
"""


REGISTRY = pint.UnitRegistry()


@pytest.mark.parametrize(("dimension", "unit"), [(kind, unit) for kind, units in toml_file.SAID_OFTEN.items() for unit in units])
def test_units_that_are_said_often_are_what_pint_says_to_the_last_digit(dimension: str, unit: str) -> None:
    si = "dimensionless" if dimension == "ratio" else toml_file.SI_UNITS[dimension]
    said = REGISTRY.Quantity(1.0, REGISTRY.parse_units("dimensionless" if unit == "1" else unit)).to(si).magnitude
    assert quantity(f"1 {unit}" if unit != "1" else "1", dimension, source="file", field="").n == said


@pytest.mark.parametrize(("ending", "count"), [(".stl", 70), (".ply", 70), (".obj", 70), (".toml", 60), (".step", 24)])
def test_a_damaged_file_is_read_or_refused_in_words(
    tmp_path: Path, ending: str, count: int, capfd: pytest.CaptureFixture[str]
) -> None:
    solid = trimesh.creation.box((16.0, 7.0, 40.0))
    (tmp_path / "block.stl").write_bytes(solid.export(file_type="stl"))
    if ending == ".step":
        import cadquery

        cadquery.exporters.export(cadquery.Workplane().box(16, 7, 40), str(tmp_path / "whole.step"))
        content = (tmp_path / "whole.step").read_bytes()
    else:
        content = DESCRIPTION.encode() if ending == ".toml" else solid.export(file_type=ending[1:])
    content = content.encode() if isinstance(content, str) else content
    path = tmp_path / f"damaged{ending}"
    options = {} if ending == ".toml" else {"material": "steel"} if ending == ".step" else {"material": "steel", "unit": "mm"}
    capfd.readouterr()  # what writing says is not what is looked at here
    refusals = 0
    for one in mutants(content, count, seed=len(content)):
        path.write_bytes(one.content)
        try:
            inertias(load(path, **options))
        except BadInput:
            refusals += 1
    assert refusals > count / 4  # the damage is real
    assert capfd.readouterr() == ("", "")
