"""The closure table: one row for each source, all of them about one article, and the paper's own errors among them."""

import io
import runpy
from typing import Any

import pytest
from numpy.testing import assert_allclose
from rich.console import Console

from validation.reference.published import published
from validation.reference.statement import Statement


@pytest.fixture(scope="module")
def example(root) -> dict[str, Any]:
    return runpy.run_path(str(root / "examples" / "closure_table.py"))


@pytest.fixture(scope="module")
def rows(example) -> dict[str, Statement]:
    found: dict[str, Statement] = example["rows"]("clumod-1", {})
    return found


def _values(said: Statement) -> list[float | None]:
    return [None if stated is None else stated.value for stated in said.values[:7]]


def test_every_source_has_one_row_cad_is_the_measure_exudyn_and_pendulum_agree_and_the_papers_errors_stand_beside(rows, example):
    cad, exudyn, pendulum = (_values(said) for said in list(rows.values())[:3])
    # Clumod's beams are solved to reproduce the published figures, which the solid does to 1e-5.
    assert_allclose(exudyn, cad, rtol=2e-5, atol=2e-6)
    assert pendulum[:4] == [None] * 4
    assert_allclose(pendulum[4:], cad[4:], rtol=1e-4)  # what corrections leave of a swing of 0.1 rad
    _, deviations = example["grids"](rows)
    printed = next(line for line in deviations.lines if line[0] == "in print: identified")
    numbers = [float(cell) for cell in printed[1:]]
    assert_allclose(numbers, [2.94, 0.39, -5.45, 13.01, 2.18, 15.50, -2.60], atol=0.0051)
    values, deviations = example["grids"](rows)
    names = [line[0] for line in values.lines]
    in_print = [f"in print: {column}" for column in published("clumod-1").statements]
    assert names == ["CAD", "exudyn, flexible body", "pendulum, swung by exudyn", *in_print]
    assert [line[0] for line in deviations.lines] == names[1:]


def test_the_example_puts_an_identification_in_its_rows(example, result_file, rows, monkeypatch):
    monkeypatch.setitem(example["main"].__globals__, "rows", lambda article, identified: {**rows, **identified})
    printed = io.StringIO()
    example["main"](Console(file=printed, width=160), str(result_file()))
    text = printed.getvalue()
    plain, better = (line for line in text.splitlines() if "identified, " in line and "±" in line)
    assert "33.28" in plain  # 1 % too heavy, as it was made
    assert "32.95" in better
