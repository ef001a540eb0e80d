"""The shipped dimensions are what the re-solve gives, and it says so when it fails."""

import json
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from geometry.errors import CheckFailed
from validation.reference import reconstruction
from validation.reference.reconstruction import FREQUENCY_SOLVED, SHIPPED, Reconstruction, changed, misfit, problem, solve, write


@pytest.fixture(scope="module")
def posed(shared: Path) -> Reconstruction:
    details = tomllib.loads(SHIPPED.read_text(encoding="utf-8"))
    return problem(details, json.loads((shared / "clumod" / "reconstruction.json").read_text()))


@pytest.mark.proof
def test_solving_again_meets_every_inertia_and_frequency_and_keeps_the_rest(posed: Reconstruction, tmp_path: Path) -> None:
    """From dimensions some thousandths off, inertias by tens of a bar: the whole way takes three times as long."""
    again = tmp_path / "clumod.toml"
    shipped = replace(posed, start=tomllib.loads(SHIPPED.read_text(encoding="utf-8")))
    detuned = replace(posed, start=changed(shipped, np.random.default_rng(0).normal(scale=2e-3, size=len(posed.free))))
    assert np.abs(misfit(detuned, np.zeros(len(posed.free)))[1]).max() > 10
    write(detuned, solve(detuned, np.random.default_rng(0)), again)
    _require_solved(again, posed)
    before, after = (path.read_text(encoding="utf-8").splitlines() for path in (SHIPPED, again))
    changed_lines = [(old, new) for old, new in zip(before, after, strict=True) if old != new]
    assert len(changed_lines) <= 24  # 22 free dimensions, two of them for both lower blades
    assert all(old.split("=")[0] == new.split("=")[0] for old, new in changed_lines)


def test_shipped_dimensions_meet_every_inertia_and_frequency(posed: Reconstruction) -> None:
    _require_solved(SHIPPED, posed)


def _require_solved(file: Path, posed: Reconstruction) -> None:
    wishes, inertias = misfit(replace(posed, start=tomllib.loads(file.read_text(encoding="utf-8"))), np.zeros(len(posed.free)))
    assert (
        np.abs(inertias).max() < 0.5
    )  # of its bar: what the rounding of a thin blade's thickness to a tenth of a micrometre takes
    assert np.abs(wishes[len(posed.free) :]).max() < FREQUENCY_SOLVED


def test_cad_detail_alone_would_miss_the_published_inertias(posed: Reconstruction) -> None:
    _, inertias = misfit(posed, np.zeros(len(posed.free)))
    assert np.abs(inertias).max() > 100


def test_equal_dimensions_stay_equal(posed: Reconstruction) -> None:
    blades = changed(posed, np.linspace(-0.1, 0.1, len(posed.free)))["blade"]
    for key in ("width_mm", "thickness_mm"):
        assert blades[0][key] == blades[1][key] != posed.start["blade"][0][key]


def test_a_solve_that_does_not_end_says_how_far_it_was(posed: Reconstruction, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reconstruction, "ITERATIONS", 1)
    monkeypatch.setattr(reconstruction, "STARTS", 2)
    with pytest.raises(CheckFailed, match="not solved in 1 iterations: a frequency is off by"):
        solve(posed, np.random.default_rng(0))
