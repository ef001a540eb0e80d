"""The shipped dimensions are what the re-solve gives, and it says so when it fails."""

import json
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fem.base_excitation.patterns import Sweep
from fem.base_excitation.response import respond
from fem.base_excitation.rig import Rig, dynamic_mass, flexible
from fem.beam import articles
from fem.modes import fixed_base
from geometry.dynamic_mass import MOTIONS, DynamicMass
from geometry.errors import CheckFailed
from tools import reconstruction
from validation.verification import dynamics


@pytest.fixture(scope="module")
def posed(shared) -> reconstruction.Reconstruction:
    details = tomllib.loads(reconstruction.SHIPPED.read_text(encoding="utf-8"))
    return reconstruction.problem(details, json.loads((shared / "clumod" / "reconstruction.json").read_text()))


@pytest.mark.proof
def test_solving_again_meets_every_inertia_and_frequency_and_keeps_the_rest(posed, tmp_path):
    """From dimensions some thousandths off, inertias by tens of a bar: the whole way takes three times as long."""
    again = tmp_path / "clumod.toml"
    shipped = replace(posed, start=tomllib.loads(reconstruction.SHIPPED.read_text(encoding="utf-8")))
    detuned = replace(
        posed, start=reconstruction.changed(shipped, np.random.default_rng(0).normal(scale=2e-3, size=len(posed.free)))
    )
    assert np.abs(reconstruction.misfit(detuned, np.zeros(len(posed.free)))[1]).max() > 10
    reconstruction.write(detuned, reconstruction.solve(detuned, np.random.default_rng(0)), again)
    _require_solved(again, posed)
    before, after = (path.read_text(encoding="utf-8").splitlines() for path in (reconstruction.SHIPPED, again))
    changed_lines = [(old, new) for old, new in zip(before, after, strict=True) if old != new]
    assert len(changed_lines) <= 24  # 22 free dimensions, two of them for both lower blades
    assert all(old.split("=")[0] == new.split("=")[0] for old, new in changed_lines)


def test_shipped_dimensions_meet_every_inertia_and_frequency_and_equal_ones_stay_equal(posed):
    _require_solved(reconstruction.SHIPPED, posed)
    _, inertias = reconstruction.misfit(posed, np.zeros(len(posed.free)))
    assert np.abs(inertias).max() > 100
    blades = reconstruction.changed(posed, np.linspace(-0.1, 0.1, len(posed.free)))["blade"]
    for key in ("width_mm", "thickness_mm"):
        assert blades[0][key] == blades[1][key] != posed.start["blade"][0][key]


def _require_solved(file: Path, posed: reconstruction.Reconstruction) -> None:
    wishes, inertias = reconstruction.misfit(
        replace(posed, start=tomllib.loads(file.read_text(encoding="utf-8"))), np.zeros(len(posed.free))
    )
    assert (
        np.abs(inertias).max() < 0.5
    )  # of its bar: what the rounding of a thin blade's thickness to a tenth of a micrometre takes
    assert np.abs(wishes[len(posed.free) :]).max() < reconstruction.FREQUENCY_SOLVED


def test_a_solve_that_does_not_end_says_how_far_it_was(posed, monkeypatch):
    """On straight lines in place of articles: every start would take a second and more a derivative."""
    lines = np.random.default_rng(1).standard_normal((40, len(posed.free)))

    def far(posed: reconstruction.Reconstruction, change: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.concatenate([change / posed.freedom, lines[:30] @ change + 50.0]), lines[30:] @ change + 3.0

    monkeypatch.setattr(reconstruction, "misfit", far)
    monkeypatch.setattr(reconstruction, "ITERATIONS", 1)
    monkeypatch.setattr(reconstruction, "STARTS", 2)
    with pytest.raises(CheckFailed, match="not solved in 1 iterations: a frequency is off by"):
        reconstruction.solve(posed, np.random.default_rng(0))


def test_six_runs_of_the_recursion_give_the_dynamic_mass_of_what_was_driven():
    structure = articles.structure("cuboid")
    rig = Rig(article=flexible("cuboid", structure, fixed_base(structure, 2)))
    lines = np.array([8.0, 12.0, 20.0])
    runs = [respond(rig, Sweep(axis=one, rate=135.0).motion(8192, ring_down=0.2)) for one in MOTIONS]
    found = dynamics.identified(runs, lines).dynamic_mass
    expected = dynamic_mass(rig, lines).matrix
    np.testing.assert_allclose(found.matrix, expected, atol=1e-3 * np.abs(expected).max())  # what rings on is cut


LINES = np.array([4.0, 8.0, 10.0, 10.2, 20.0])
RESONANCE, RATIO = np.array([10.0]), np.array([0.003])
DIAGONAL = np.array([30.0, 30.0, 30.0, 8.0, 8.0, 2.0])


def _model() -> np.ndarray:
    """H (n, 6, 6), diagonal: rigid, ten times that at the resonance, an antiresonance at the last line."""
    H = np.tile(np.diag(DIAGONAL), (len(LINES), 1, 1)).astype(np.complex128)
    H[2:4] *= -10j
    H[-1] *= 1e-6
    return H


def _deviation(change: np.ndarray) -> np.ndarray:
    model = _model()
    changed = DynamicMass(frequency=LINES, matrix=model + change)
    return dynamics.deviation(changed, DynamicMass(frequency=LINES, matrix=model), RESONANCE, RATIO)


@pytest.mark.parametrize("change", [np.zeros((6, 6)), np.ones((6, 6)) - np.eye(6)], ids=["nothing", "beside the diagonal"])
def test_the_model_itself_deviates_by_nothing_and_what_lies_beside_the_diagonal_is_not_counted(change):
    off, at = _deviation(np.broadcast_to(change, (len(LINES), 6, 6)))
    assert not off.any()
    assert not at.any()


@pytest.mark.parametrize("axis", range(6))
def test_an_error_of_a_known_share_is_told_for_its_axis_at_resonance_or_off_it(axis):
    change = np.zeros((len(LINES), 6, 6), dtype=np.complex128)
    change[2, axis, axis] = 0.02j * 10 * DIAGONAL[axis]  # at the resonance
    change[1, axis, axis] = 0.001 * DIAGONAL[axis]
    off, at = _deviation(change)
    np.testing.assert_allclose(at, 0.02 * (np.arange(6) == axis), rtol=1e-12)
    np.testing.assert_allclose(off, 0.001 * (np.arange(6) == axis), rtol=1e-12)


def test_a_line_is_at_a_resonance_within_so_many_half_widths_of_it():
    change = np.zeros((len(LINES), 6, 6), dtype=np.complex128)
    change[3, 0, 0] = 3.0
    off, at = _deviation(change)
    assert LINES[3] - RESONANCE[0] > dynamics.BANDWIDTHS * RATIO[0] * RESONANCE[0]
    assert (off[0], at[0]) == (pytest.approx(0.01), 0.0)


def test_at_an_antiresonance_the_share_is_of_the_first_line():
    change = np.zeros((len(LINES), 6, 6), dtype=np.complex128)
    change[-1, 0, 0] = 0.3
    assert _deviation(change)[0][0] == pytest.approx(0.01)
