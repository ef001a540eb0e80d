"""The shipped dimensions are what the re-solve gives, and it says so when it fails."""

import json
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.articles.dimensions import to_si
from geometry.errors import CheckFailed
from validation import reconstruction
from validation.reconstruction import SHIPPED, Problem, changed, misfit, problem, solve, write


@pytest.fixture(scope="module")
def posed(shared: Path) -> Problem:
    details = tomllib.loads(SHIPPED.read_text(encoding="utf-8"))
    return problem(details, json.loads((shared / "clumod" / "reconstruction.json").read_text()))


def test_solving_again_gives_the_shipped_dimensions(posed: Problem, tmp_path: Path) -> None:
    again = tmp_path / "clumod.toml"
    write(posed, solve(posed), again)
    shipped, solved = (_numbers(to_si(tomllib.loads(path.read_text(encoding="utf-8")))) for path in (SHIPPED, again))
    # another BLAS may take the iteration along another path within the 0.1 % that a frequency is free to be off
    assert_allclose(solved, shipped, rtol=0.02)
    assert len(again.read_text().splitlines()) == len(SHIPPED.read_text().splitlines())


def test_shipped_dimensions_meet_every_inertia_and_frequency(posed: Problem) -> None:
    shipped = replace(posed, start=tomllib.loads(SHIPPED.read_text(encoding="utf-8")))
    wishes, inertias = misfit(shipped, np.zeros(len(posed.free)))
    assert np.abs(inertias).max() < 0.1  # of its bar; rounding to a tenth of a micrometre takes that much
    assert np.abs(wishes).max() <= 1  # a tenth of a per cent in frequency


def test_cad_detail_alone_would_miss_the_published_inertias(posed: Problem) -> None:
    _, inertias = misfit(posed, np.zeros(len(posed.free)))
    assert np.abs(inertias).max() > 100


def test_equal_dimensions_stay_equal(posed: Problem) -> None:
    blades = changed(posed, np.linspace(-0.1, 0.1, len(posed.free)))["blade"]
    assert blades[0]["width_mm"] == blades[1]["width_mm"]
    assert blades[0]["thickness_mm"] == blades[1]["thickness_mm"]


def test_a_solve_that_does_not_end_says_how_far_it_was(posed: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reconstruction, "ITERATIONS", 1)
    with pytest.raises(CheckFailed, match="not solved in 1 iterations: a frequency is off by"):
        solve(posed)


def _numbers(value: object) -> list[float]:
    if isinstance(value, dict):
        return [number for entry in value.values() for number in _numbers(entry)]
    if isinstance(value, list):
        return [number for entry in value for number in _numbers(entry)]
    return [float(value)] if isinstance(value, (int, float)) else []
