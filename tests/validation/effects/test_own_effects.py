"""A user's own effects: found, checked, refused in words with the user's line, and used like any other."""

import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import fields, replace
from importlib.metadata import EntryPoint
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from validation.cli import main
from validation.effects import catalogue, own
from validation.effects.catalogue import FAMILIES, SOURCES, parse
from validation.effects.effect import Family, SizeSpec
from validation.effects.stages import ChannelResponse, Shares
from validation.virtual_test.planted import planted

WHOLE = """
from dataclasses import replace
from validation.effects.effect import CHANNEL_STAGE, FORCES, Family, SizeSpec

def change(reading, targets, values):
    rows = reading.rows.copy()
    rows[:, reading.column(targets[0])] *= 1 + values[""]
    return replace(reading, rows=rows)

FAMILY = Family(
    name="drift-of-gain",
    side=FORCES,
    what="a gain of my own",
    targets=("force channel",),
    sizes=(SizeSpec(unit="1", low=-0.5, high=0.5, plausible=0.1),),
    example="drift-of-gain:fmd-z2=0.1",
    stage=CHANNEL_STAGE,
    change=change,
    equation="y (1 + g)",
    confirmed_by="a calibration",
    reference="my notes",
    sentence="It drifts.",
)
"""


@pytest.fixture
def folder(tmp_path) -> Callable[..., Path]:
    """``folder(name=text)``: a folder of files of effects."""

    def made(**files: str) -> Path:
        for name, text in files.items():
            (tmp_path / f"{name}.py").write_text(text, encoding="utf-8")
        return tmp_path

    return made


def test_a_file_is_found_keeps_its_equation_and_can_be_typed(folder):
    where = folder(mine=WHOLE)
    (family,) = catalogue.load(where)
    assert FAMILIES["drift-of-gain"] is family
    assert SOURCES["drift-of-gain"] == str(where / "mine.py")
    assert list(FAMILIES)[-1] == "drift-of-gain"
    named = parse("drift-of-gain:fmd-z2=0.25")
    reading = ChannelResponse(frequency=np.array([5.0]), channels=("fmd-z1", "fmd-z2"), rows=np.ones((1, 2, 6), complex))
    changed = family.change(reading, named.targets, named.values)
    assert_allclose(changed.rows[0, :, 0], [1.0, 1.25])


def test_reading_leaves_no_trace_happens_once_and_what_a_file_prints_does_not_mix_with_answers(folder, capsys):
    count = "\nwith open(__file__[:-2] + 'log', 'a') as log:\n    log.write('x')\n"
    where = folder(mine="print('hello')\n" + WHOLE + count)
    first = catalogue.load(where)
    assert catalogue.load(where / ".." / where.name) == first
    assert (where / "mine.log").read_text() == "x"
    assert {path.name for path in where.iterdir()} == {"mine.py", "mine.log"}
    assert capsys.readouterr() == ("", "hello\n")


def changed(old: str, new: str) -> str:
    assert old in WHOLE
    return WHOLE.replace(old, new)


@pytest.mark.parametrize(
    ("text", "field", "says"),
    [
        ("x = 1\n", "FAMILY", "is missing"),
        ("FAMILY = 'mine'\n", "FAMILY", "found str"),
        ("def broken(:\n", "", "line 1, `def broken(:`, raised SyntaxError"),
        ("import no_such_module_of_mine\n", "", "line 1, `import no_such_module_of_mine`, raised ModuleNotFoundError"),
        ("\n\nx = 1 / 0\n", "", "line 3, `x = 1 / 0`, raised ZeroDivisionError: division by zero"),
        ("import sys\nsys.exit('enough')\n", "", "raised SystemExit: enough"),
        (changed('    sentence="It drifts.",\n', ""), "sentence", "is missing"),
        (changed('    reference="my notes",\n', ""), "reference", "is missing"),
        (changed('    equation="y (1 + g)",\n', ""), "equation", "is missing"),
        (changed('    confirmed_by="a calibration",\n', ""), "confirmed_by", "is missing"),
        (changed('unit="1"', 'unit=""'), "sizes", "its unit is missing"),
        (changed("low=-0.5", "low=0.7"), "sizes", "low must lie below high, found 0.7 and 0.5"),
        (changed("plausible=0.1", "plausible=-1"), "sizes", "plausible must be 0 or more"),
        (changed('name="drift-of-gain"', 'name="force-gain"'), "name", "is there already, from massline itself"),
        (changed('name="drift-of-gain"', 'name="Drift of gain"'), "name", "must be lower-case words joined by -"),
        (changed("side=FORCES", 'side="forces"'), "side", "Did you mean force side?"),
        (changed("stage=CHANNEL_STAGE", 'stage="channel"'), "stage", "Did you mean channels?"),
        (changed("stage=CHANNEL_STAGE,\n    change=change", "change=None"), "stage", "no parameter of a laboratory has its name"),
        (changed("change=change", "change=None"), "change", "is missing"),
        (changed('("force channel",)', '("cell channel",)'), "targets", "must be one of those known, found 'cell channel'"),
        (
            changed("drift-of-gain:fmd-z2=0.1", "drift-of-gain:fmd-z9=0.1"),
            "example",
            "cannot be typed: no force channel is called",
        ),
        (changed("drift-of-gain:fmd-z2=0.1", "force-gain:fmd-z2=0.1"), "example", "is one of force-gain"),
        (changed('1 + values[""]', '1.5 + values[""]'), "change", "changes something at size 0, where there is no effect"),
        (changed('*= 1 + values[""]', '+= values[""]'), "change", "is not linear in `rows`"),
        (
            changed("return replace(reading, rows=rows)", "return rows"),
            "change",
            "must return the changed ChannelResponse, found ndarray",
        ),
        (changed("rows = reading.rows.copy()", "rows = reading.rows"), "change", "line 7, `rows[:, reading.column(targets[0])]"),
        (changed('values[""]', 'values["size"]'), "change", "raised KeyError: 'size'"),
        (
            changed(
                'sizes=(SizeSpec(unit="1", low=-0.5, high=0.5, plausible=0.1),)', "sizes=SizeSpec(unit='1', low=0.0, high=1.0)"
            ),
            "sizes",
            "a tuple of SizeSpec",
        ),
        (changed('targets=("force channel",)', 'targets="force channel"'), "targets", "a tuple of texts"),
        (
            changed("reading.rows.copy()", "reading.rows[:-1].copy()"),
            "change",
            "leaves `rows` of shape (4, 22, 6), where (5, 22, 6)",
        ),
        (changed('*= 1 + values[""]', '*= (1 + values[""]) / 0.0'), "change", "raised ZeroDivisionError"),
        (changed('*= 1 + values[""]', '*= float("nan")'), "change", "leaves values in `rows` that are no numbers"),
    ],
)
def test_what_is_not_whole_is_refused_with_file_field_and_remedy(folder, text, field, says):
    where = folder(mine=text)
    before = dict(FAMILIES)
    with pytest.raises(BadInput) as refused:
        catalogue.load(where)
    assert refused.value.source == str(where / "mine.py")
    assert refused.value.field == field
    assert says in str(refused.value)
    assert refused.value.remedy
    assert dict(FAMILIES) == before


STRUCTURAL = (
    WHOLE.replace("reading.rows.copy()", "matrices.MORE")
    .replace("def change(reading", "def change(matrices")
    .replace('    rows[:, reading.column(targets[0])] *= 1 + values[""]\n', "")
    .replace("replace(reading, rows=rows)", 'replace(matrices, mass=matrices.mass + values[""] * rows)')
    .replace("CHANNEL_STAGE", "STRUCTURE_STAGE")
)


JUNK = [None, 3, "", "x", (), ("",), [1], {"a": 1}, object(), float("nan"), lambda: None]


@pytest.mark.parametrize("field", [*(one.name for one in fields(Family)), *(f"sizes.{one.name}" for one in fields(SizeSpec))])
@pytest.mark.parametrize("junk", JUNK, ids=lambda junk: type(junk).__name__)
def test_no_junk_in_a_field_brings_anything_but_a_family_or_a_refusal(field, junk, folder):
    (whole,) = catalogue.load(folder(mine=WHOLE))
    catalogue._forget(whole.name)
    _, of_size, key = field.rpartition("sizes.")
    change = {"sizes": (replace(whole.sizes[0], **{key: junk}),)} if of_size else {field: junk}
    with suppress(BadInput):
        catalogue._add(own.of(replace(whole, **change), "mine.py"), "mine.py")


def test_a_structure_that_does_not_add_is_refused_and_one_that_does_is_taken(folder):
    with pytest.raises(BadInput, match="adds to `mass` what depends on the matrices that are there"):
        catalogue.load(folder(mine=STRUCTURAL.replace("matrices.MORE", "matrices.mass")))
    assert catalogue.load(folder(mine=STRUCTURAL.replace("matrices.MORE", "matrices.parts['mast']")))


def test_of_a_folder_with_one_broken_file_nothing_is_taken(folder):
    where = folder(a=WHOLE, b="x = 1\n")
    with pytest.raises(BadInput, match=r"b\.py: `FAMILY`: is missing"):
        catalogue.load(where)
    assert "drift-of-gain" not in FAMILIES
    (where / "b.py").unlink()
    assert [family.name for family in catalogue.load(where)] == ["drift-of-gain"]


def test_two_files_cannot_share_a_name(folder):
    where = folder(a=WHOLE, b=WHOLE)
    with pytest.raises(BadInput, match=r"b\.py: `name`: an effect called 'drift-of-gain' is there already, from .*a\.py"):
        catalogue.load(where)
    assert "drift-of-gain" not in FAMILIES
    (where / "b.py").unlink()
    assert catalogue.load(where)[0].name == "drift-of-gain"


def test_what_is_no_folder_of_effects_is_refused(folder, tmp_path):
    with pytest.raises(BadInput, match="no such folder"):
        catalogue.load(tmp_path / "nowhere")
    with pytest.raises(BadInput, match=r"holds no file of an effect"):
        catalogue.load(folder(_helper=WHOLE))
    (tmp_path / "file").write_text("")
    with pytest.raises(BadInput, match="it is a file"):
        catalogue.load(tmp_path / "file")


def test_an_equation_that_fails_later_is_told_in_words(folder):
    (family,) = catalogue.load(folder(mine=changed('1 + values[""]', '1 + (values[""] if values[""] < 0.2 else [][0])')))
    reading = ChannelResponse(frequency=np.array([5.0]), channels=("fmd-z2",), rows=np.ones((1, 1, 6), complex))
    with pytest.raises(BadInput, match=r"mine\.py: `change`: line 7, .* raised IndexError: list index out of range"):
        family.change(reading, ("fmd-z2",), {"": 0.3})


def test_a_plant_that_fails_is_told_in_words(folder):
    plant = "    plant=at('record', lambda named: lambda sensed: sensed.nothing),\n)"
    text = "from validation.effects.plants import at\n" + WHOLE.rstrip().removesuffix(")") + plant
    (family,) = catalogue.load(folder(mine=text))
    effect = family.plant(parse("drift-of-gain:fmd-z2=0.1"))
    assert effect.id == "drift-of-gain:fmd-z2"
    with pytest.raises(BadInput, match=r"`plant`: line \d+, .* raised AttributeError: 'int' object has no attribute 'nothing'"):
        effect.record(3)


def test_one_without_a_plant_cannot_be_simulated_and_says_so(folder):
    catalogue.load(folder(mine=WHOLE.replace("side=FORCES", "side=PROCESSING").replace("FORCES,", "PROCESSING,")))
    with pytest.raises(BadInput, match="its family says no `plant`"):
        planted([parse("drift-of-gain:fmd-z2=0.1")])


def test_an_installed_package_brings_effects_by_entry_point(folder, monkeypatch):
    where = folder(brought=WHOLE)
    monkeypatch.syspath_prepend(where)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    catalogue.add_installed(iter([EntryPoint("drift", "brought:FAMILY", catalogue.GROUP)]))
    assert FAMILIES["drift-of-gain"].what == "a gain of my own"
    with pytest.raises(BadInput, match=r"entry point lost = no_such_package .* raised ModuleNotFoundError"):
        catalogue.add_installed(iter([EntryPoint("lost", "no_such_package", catalogue.GROUP)]))


def test_the_option_puts_them_into_simulate_wherever_it_stands(root, capsys):
    for order in (["--list-effects", "--effects-from"], ["--effects-from"]):
        more = [] if "--list-effects" in order else ["--list-effects"]
        assert main.run(["simulate", *order, str(root / "examples" / "effects"), *more]) == main.DONE
        out, _ = capsys.readouterr()
        assert "dashpot:mast-top=30" in out
        assert "force-lowpass:fmd-z2=1e-3" in out


def test_a_broken_folder_ends_with_2_and_no_traceback(folder, apart, root, code):
    run = apart("simulate", "fmd+cuboid", "--out", "x", "--effects-from", str(folder(mine="\nx = 1 / 0\n")), cwd=code)
    assert run.returncode == main.BAD_INPUT
    assert "line 2, `x = 1 / 0`, raised ZeroDivisionError" in run.stderr
    assert "Traceback" not in run.stderr


def test_shares_of_parts_are_joined_with_others_as_tables_are():
    assert Shares(["mast", "hub"], lambda part: f"drawn {part}") | {"hub": "mine"} == {"mast": "drawn mast", "hub": "mine"}
