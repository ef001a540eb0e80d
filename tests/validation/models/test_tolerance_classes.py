"""Classes of laboratories: a line of the model file sets them, its own figures go before, and the page says what the code has."""

import re
from pathlib import Path

import pytest

from geometry.errors import BadInput
from geometry.sensors import Tolerances
from validation.model import model_file
from validation.model.model import Model
from validation.model.tolerance_classes import (
    AS_DELIVERED,
    CALIBRATED,
    METROLOGY,
    NAMES,
    ROWS,
    MountingTolerances,
    StructureTolerances,
    ToleranceClass,
    named,
)

PAGE = (Path(__file__).parents[3] / "docs" / "laboratories.md").read_text(encoding="utf-8")

SMALLEST = 'format = 1\n[model]\narticle = "fmd+clumod-1"\n'


def stated(of: Model) -> ToleranceClass:
    return ToleranceClass(
        name=of.tolerance_class, chain=of.tolerances, opened=of.opened, mounting=of.mounting, structure=of.structure
    )


def test_without_a_class_all_is_as_ever():
    """`metrology` is what a model without a class has, and its column of the table is what the code has by default."""
    (plain, asked) = (model_file.of_text(SMALLEST + more, "m.toml") for more in ("", f'[tolerances]\nclass = "{METROLOGY}"\n'))
    for one in (plain, asked):
        assert one.tolerances == Tolerances()
        assert one.mounting == MountingTolerances()
        assert one.structure == StructureTolerances()
        assert not one.opened
    assert all(ToleranceClass().of(row) == row.si(row.classes[0]) for row in ROWS)


def test_classes_widen_from_one_to_the_next_and_every_figure_has_a_source():
    for row in ROWS:
        assert list(row.classes) == sorted(row.classes), row.key
        assert row.classes[2] < row.largest, row.key
        assert len(row.source) > 30, row.key
    assert [named(name).name for name in NAMES] == list(NAMES)


def test_what_a_file_states_goes_before_its_class_and_all_is_written_back():
    text = f'{SMALLEST}[tolerances]\nclass = "{AS_DELIVERED}"\ngain = 0.004\nmounting_mm = 2.5\ncell_crosstalk = 0\n'
    found = model_file.of_text(text + "[structure.tolerances]\ndamping = 0.2\n", "m.toml")
    usual = named(AS_DELIVERED)
    assert (found.tolerances.gain, found.mounting.place, found.opened["cell-crosstalk"]) == (0.004, 0.0025, 0.0)
    assert found.structure.damping == 0.2
    assert found.tolerances.position == usual.chain.position
    assert found.opened["accelerometer-highpass"] == usual.opened["force-highpass"] == 0.03
    again = model_file.of_text(model_file.text(found), "m.toml")
    assert {row.key: stated(again).of(row) for row in ROWS} == {row.key: stated(found).of(row) for row in ROWS}


def test_an_unknown_class_and_a_number_in_another_unit_are_refused():
    with pytest.raises(BadInput, match="calibrated"):
        model_file.of_text(SMALLEST + '[tolerances]\nclass = "calibrate"\n', "m.toml")
    with pytest.raises(BadInput, match="mounting_mm"):
        model_file.of_text(SMALLEST + "[tolerances]\nmounting_mm = 500\n", "m.toml")


def test_the_page_has_every_figure_and_every_source():
    rows = {cells[0]: cells[1:] for line in PAGE.splitlines() if len(cells := re.split(r" *\| *", line.strip("| "))) == 6}
    for row in ROWS:
        *figures, what, source = rows[f"`{row.key}`"]
        assert [float(one) for one in figures] == pytest.approx(row.classes), row.key
        assert (what, source) == (row.what, row.source), row.key
    assert f'class = "{CALIBRATED}"' in PAGE
