"""What a laboratory has learnt: its file, and a model that names it."""

import re
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from identification.parameter import Parameter
from validation.model import model_file
from validation.model.learnt import Learnt, Offset, Spread
from validation.prediction.series import predictions

GAIN, CELL, PLANE = "force-gain:fmd-z2", "cell-stiffness:1x", "fmd:mx"

KNOWN = Learnt(
    source="lab.toml",
    hardware="fmd-3/sensors-7",
    tolerance_class="calibrated",
    campaigns=("spring", "autumn"),
    offsets={
        GAIN: Offset(offset=0.004, deviation=0.001, before=0.005),
        CELL: Offset(offset=-0.03, deviation=0.02, before=0.05),
        PLANE: Offset(offset=0.002, deviation=0.001, before=0.08),
    },
    spreads={"mounting_mm": Spread(deviation=1.2e-4, low=5e-5, high=2.5e-4, before=2.5e-4, count=6)},
)

MODEL = """\
format = 1
model = { article = "fmd+disc+cuboid" }
laboratory = { hardware = "HARDWARE", learnt = "lab.toml" }
tolerances = { class = "calibrated" }
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "lab.toml").write_text(KNOWN.text)
    return tmp_path


def model(folder: Path, hardware: str = KNOWN.hardware, more: str = "") -> model_file.Model:
    return model_file.of_text(MODEL.replace("HARDWARE", hardware) + more, str(folder / "m.toml"))


def test_what_is_written_is_read_and_a_model_that_names_it_has_it(folder):
    found = model(folder)
    assert found.learnt is not None
    assert dict(found.learnt.offsets) == dict(KNOWN.offsets)
    assert (found.learnt.hardware, found.learnt.campaigns) == (KNOWN.hardware, KNOWN.campaigns)
    assert_allclose(found.mounting.place, 1.2e-4)
    assert found.mounting.turn > 0
    again = model_file.of_text(model_file.text(found), found.source)
    assert dict(again.learnt.offsets) == dict(KNOWN.offsets)


def test_an_offset_of_a_known_parameter_counts_from_where_it_stands():
    gain = Parameter(name=GAIN, unit="1", tolerance=0.005, low=-0.02, high=0.02)
    cell = Parameter(name=CELL, unit="1", tolerance=0.05, nominal=1.0, logarithmic=True, above=-1.0)
    for one in (gain, cell):
        known = KNOWN.known(one)
        assert known.tolerance == KNOWN.offsets[one.name].deviation
        total = KNOWN.at({one.name: 0.01}, [one.name])[one.name]
        assert_allclose(known.value(0.01), one.value(total), rtol=1e-12)
        assert_allclose(known.offset(known.value(0.01)), 0.01, rtol=1e-9)
    assert_allclose([KNOWN.known(gain).low, KNOWN.known(gain).high], [-0.024, 0.016])
    other = Parameter(name="force-gain:fmd-z3", unit="1", tolerance=0.005)
    assert KNOWN.known(other) is other


def test_a_prediction_by_what_was_learnt_is_the_prediction_there(ordinary, folder):
    """At zero offsets every channel reads what a laboratory that has learnt nothing reads at the offsets that were learnt."""
    campaign = ordinary("fmd+disc+cuboid", "rigid").campaign
    bare = model_file.of_text(MODEL.replace('HARDWARE", learnt = "lab.toml"', '"'), "m.toml")
    (knowing,), (plain,) = (predictions(one, [campaign], lines=[5.0, 21.0]) for one in (model(folder, ""), bare))
    at = {name: one.offset for name, one in KNOWN.offsets.items()}
    found, expected = knowing.at({}), plain.at(at)
    assert_allclose(found.rows, expected.rows, rtol=0, atol=1e-12 * np.abs(expected.rows).max())
    assert np.abs(found.rows - plain.at({}).rows).max() > 1e-3
    slopes = (found.changes[GAIN].rows, expected.changes[GAIN].rows)
    assert_allclose(*slopes, rtol=0, atol=1e-12 * np.abs(slopes[1]).max())
    by_name = {one.name: one for one in knowing.parameters}
    assert_allclose(by_name[GAIN].value(0.0), 0.004)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ((r'kind = "laboratory"', 'kind = "model"'), "kind"),
        ((r"hardware = .*", 'hardware = "another"'), "another"),
        ((r"sd = 0.001,", "sd = 0,"), GAIN),
        ((r"sd = 0.001,", "sd = nan,"), GAIN),
        ((r"offset = 0.004,", ""), "offset"),
        ((r"\[mounting.mounting_mm\]", "[mounting.mounting]"), "mounting"),
    ],
)
def test_what_cannot_be_meant_is_refused(folder, change, says):
    path = folder / "lab.toml"
    path.write_text(re.sub(*change, path.read_text(), count=1))
    with pytest.raises(BadInput, match=says):
        model(folder)
