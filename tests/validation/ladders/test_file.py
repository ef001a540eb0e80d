"""The ladder's file: what was written is read back, what cannot be read is refused and kept."""

import json
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from validation.history import history
from validation.history.history import Errors, Ladder, Version


@pytest.fixture
def ladder(rung) -> Ladder:
    first = rung(0, None, "# mine\r\na = 1\n", verdict=(), gain=None)
    return Ladder(rungs=(first, rung(1, 0, "a = 2"), rung(2, 0, "a = 3", errors=None, bodies=())), current=1)


def test_what_was_written_is_read_back(ladder, tmp_path):
    path = tmp_path / "model.ladder.json"
    history.write(path, ladder, "model.toml")
    found = history.read(path)
    assert found.current == ladder.current
    for one, other in zip(found.rungs, ladder.rungs, strict=True):
        for name in {each.name for each in fields(Version)} - {"bodies"}:
            assert getattr(one, name) == getattr(other, name), name
        for body, its in zip(one.bodies, other.bodies, strict=True):
            assert body.article == its.article
            for name in ("values", "deviation", "reference"):  # metres become millimetres and come back
                assert_allclose(getattr(body, name), getattr(its, name), rtol=1e-15, atol=0)


@given(st.text())
def test_the_text_of_a_model_comes_back_byte_by_byte(tmp_path_factory, text):
    if any("\ud800" <= one <= "\udfff" for one in text):
        return  # no file in UTF-8 holds half a character
    path = tmp_path_factory.getbasetemp() / "any.ladder.json"
    history.write(path, Ladder(rungs=(Version(number=0, parent=None, cause="start", model=text),), current=0), "model.toml")
    assert history.read(path).rung(0).model == text


def test_a_person_reads_the_model_line_by_line_and_figures_that_are_not_there_are_null(ladder):
    table = json.loads(history.text(ladder, "model.toml"))
    assert table["format"] == 1
    assert table["rungs"][1]["model"] == ["a = 2"]
    assert table["rungs"][1]["errors"]["plain_percent"] == 4.1
    assert table["rungs"][1]["effects"]["force-gain:fmd-z2"] == [{"key": "", "value": 0.0801, "sd": 0.0013, "unit": "1"}]
    assert_allclose(table["rungs"][1]["inertia"][0]["identified"]["cog_mm"], 1e3 * ladder.rung(1).bodies[0].values[1:4])
    nowhere = replace(ladder.rung(1), gain=float("-inf"), errors=replace(_errors(ladder), log_evidence=float("nan")))
    text = history.text(Ladder(rungs=(ladder.rung(0), nowhere), current=0), "model.toml")
    assert json.loads(text, parse_constant=lambda word: pytest.fail(word))["rungs"][1]["evidence_gain_nats"] is None


def _errors(ladder: Ladder) -> Errors:
    found = ladder.rung(1).errors
    assert found is not None
    return found


def changed(change: Callable[[dict[str, Any]], object]) -> Callable[[str], str]:
    def apply(text: str) -> str:
        table = json.loads(text)
        change(table)
        return json.dumps(table)

    return apply


def test_a_ladder_from_before_the_price_was_kept_is_read(ladder, tmp_path):
    path = tmp_path / "model.ladder.json"
    table = json.loads(history.text(ladder, "model.toml"))
    for one in (one["errors"] for one in table["rungs"] if one["errors"]):
        del one["tolerance_z2_expected"], one["largest_z"]
    path.write_text(json.dumps(table), encoding="utf-8")
    found = history.read(path).rungs[1].errors
    assert found.due_z2 == found.tolerances  # the most that it can be


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda text: text[: len(text) // 2], "not JSON"),
        (lambda text: "[]", "one JSON object"),
        (lambda text: '{"format": 1}', "no ladder of massline"),
        (changed(lambda table: table.update(format=2)), "newer massline"),
        (changed(lambda table: table.update(format="1")), "must be 1"),
        (changed(lambda table: table.pop("current")), "'current' is missing"),
        (changed(lambda table: table.update(current=7)), "current rung is 7 of 3"),
        (changed(lambda table: table["rungs"].pop(0)), "rung 0 says that it is 1"),
        (changed(lambda table: table["rungs"][1].update(parent=1)), "comes from 1, which was not there before"),
        (changed(lambda table: table["rungs"][1].update(cause="magic")), "unknown cause 'magic'"),
        (changed(lambda table: table["rungs"][1].update(model="a = 2")), "a list of texts"),
        (changed(lambda table: table["rungs"][1]["errors"].update(plain_percent="4")), "a number is expected"),
        (changed(lambda table: table["rungs"][1]["errors"].pop("tolerances")), "'tolerances' is missing"),
        (changed(lambda table: table["rungs"][1]["errors"].update(plain_percent=-4.0)), "plain_percent is negative, -4"),
        (changed(lambda table: table["rungs"][1]["inertia"][0]["sd"].update(cog_mm=[1, 2])), "must have shape"),
        (changed(lambda table: table["rungs"][1].update(effects=[1])), "damaged"),
    ],
)
def test_what_is_no_whole_ladder_is_refused_in_words_and_left_alone(damage, words, ladder, tmp_path):
    path = tmp_path / "model.ladder.json"
    path.write_text(damage(history.text(ladder, "model.toml")), encoding="utf-8")
    before = path.read_bytes()
    with pytest.raises(BadInput, match=words) as raised:
        history.read(path)
    assert str(path) in str(raised.value)
    assert path.read_bytes() == before


def test_the_ladder_stands_beside_its_model_and_distances_are_told_in_standard_deviations(rung):
    assert history.path_beside(Path("a/my.model.toml")) == Path("a/my.model.ladder.json")
    (body,) = rung().bodies
    assert_allclose(body.sigmas, 0.5 * np.ones(10), rtol=1e-9)
    assert_allclose(body.half_width, 1.96 * body.deviation, rtol=1e-4)
