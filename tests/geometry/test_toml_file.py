"""Whatever a user hands over as TOML or JSON: a table comes out, or a refusal that says what it is."""

from pathlib import Path

import pytest

from geometry import toml_file
from geometry.errors import BadInput
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
    asked = BadInput(source="a.toml", field="k", problem="is unknown", remedy="Did you mean l? ")
    told = BadInput(source="a.toml", field="k", problem="is unknown", remedy="Write l.")
    assert (str(asked), str(told)) == ("a.toml: `k`: is unknown. Did you mean l?", "a.toml: `k`: is unknown. Write l.")
