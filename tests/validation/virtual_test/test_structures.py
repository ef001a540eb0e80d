"""Virtual tests of structures: the same whenever they are made."""

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.sparse.linalg import splu

from fem.user_model import reading
from validation.virtual_test import structure_tests


def test_a_table_of_a_large_structure_is_the_same_in_every_run(
    portal: Callable[..., Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """Sparse eigensolvers begin at random and end with any sign; noise upon a shape would then be another one every time."""
    monkeypatch.setattr(structure_tests, "WHOLE", 10)
    structure = reading.load(portal(tmp_path, 8)).model
    rows = [row for name in ("a", "b", "c") for row in structure.places[name].toarray()]
    tables = [
        structure_tests.TestedStructure(highest=500.0, structure=structure, losses={"posts": 0.01}, ratio=0.0).table(
            rows, 1.0, 3000.0
        )
        for _ in range(3)
    ]
    assert len(tables[0][0]) > 5
    for found in tables[1:]:
        for one, other in zip(found, tables[0], strict=True):
            np.testing.assert_array_equal(one, other)
    shapes = tables[0][2]
    assert np.all(shapes[np.arange(len(shapes)), np.abs(shapes).argmax(axis=1)] > 0)


def test_a_large_structure_answers_as_its_whole_matrices_do_with_their_losses(
    portal: Callable[..., Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """Of some modes and one static answer without losses a point gives a per cent too little where a force acts on it."""
    monkeypatch.setattr(structure_tests, "WHOLE", 10)
    monkeypatch.setattr(structure_tests, "MOST_MODES", 8)
    structure = reading.load(portal(tmp_path, 8)).model
    losses = {part: 0.02 * (k + 1) ** 2 for k, part in enumerate(structure.part_stiffness)}
    rows = [row for name in ("a", "b") for row in structure.places[name].toarray()]
    lab = structure_tests.TestedStructure(highest=300.0, structure=structure, losses=losses, ratio=0.0)
    assert off(lab, np.array([40.0, 150.0, 290.0]), rows) < 1e-3


POLE = """format = 1
[fe_model]
kind = "mesh"
units = "mm"
file = "pole.inp"
support = "free"
places.a = ["0 mm", "0 mm", "0 mm"]
places.b = ["0 mm", "0 mm", "300 mm"]
[fe_model.parts.lower]
material = "steel"
section = { width = "20 mm", height = "20 mm" }
[fe_model.parts.upper]
material = "steel"
section = { width = "20 mm", height = "20 mm" }
"""


@pytest.mark.parametrize("whole", [10, 1200])
def test_what_floats_and_bends_alike_both_ways_answers_as_its_matrices_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, whole: int
) -> None:
    """Rigid motions have one frequency, and so have pairs of modes: their lossy shapes are orthogonal in no sense, and a barrel
    answered off by up to a sixth, so that a diagnosis found delays that nobody had planted."""
    monkeypatch.setattr(structure_tests, "WHOLE", whole)
    lines = ["*NODE", *(f"{k + 1}, 0, 0, {50 * k}" for k in range(17))]
    for part, some in (("lower", range(6)), ("upper", range(6, 16))):
        lines += [f"*ELEMENT, TYPE=B31, ELSET={part}", *(f"{k + 1}, {k + 1}, {k + 2}" for k in some)]
    (tmp_path / "pole.inp").write_text("\n".join(lines) + "\n")
    (tmp_path / "pole.toml").write_text(POLE)
    structure = reading.load(tmp_path / "pole.toml").model
    rows = [row for name in ("a", "b") for row in structure.places[name].toarray()[:3]]
    losses = {"lower": 0.02, "upper": 0.05}
    lab = structure_tests.TestedStructure(highest=400.0, structure=structure, losses=losses, ratio=0.0)
    assert off(lab, np.array([20.0, 150.0, 390.0]), rows) < 1e-6


def off(lab: structure_tests.TestedStructure, frequency: np.ndarray, rows: list[np.ndarray]) -> float:
    """By how much it is beside a solution of its whole matrices at worst, as a share of the largest response to a force."""
    worst, K = 0.0, lab.structure
    lost = sum(eta * K.part_stiffness[part] for part, eta in lab.losses.items())
    for f, found in zip(frequency, lab.accelerance(frequency, rows, rows), strict=True):
        square = (2 * np.pi * f) ** 2
        dynamic = (K.stiffness + 1j * lost - square * K.mass).tocsc()[K.free][:, K.free]
        own = np.array(rows)[:, K.free]
        due = -square * own @ splu(dynamic).solve(own.T.astype(complex))
        worst = max(worst, float((np.abs(found - due) / np.abs(due).max(axis=1, keepdims=True)).max()))
    return worst


MAST = """format = 1
model = { title = "a mast", article = "mast" }

[fe_model]
kind = "frame"
nodes = { foot = "0 mm", middle = "400 mm", tip = "800 mm" }
fixed = ["foot"]
members = { lower = ["foot", "middle"], upper = ["middle", "tip"] }
section = { width = "30 mm", thickness = "10 mm", across = "x" }
material = "steel"
loss_factor = 0.01
"""


def test_a_table_has_no_mode_that_moves_no_sensor_and_one_that_has_is_compared_all_the_same(run: Any) -> None:
    """Modes across the sensors were tabulated by what rounding left of them, and `compare` ended in "Singular matrix"."""
    Path("mast.toml").write_text(MAST)
    asked = "simulate mast.toml --test modes --response middle:x --response tip:x --band 5 1500 --seed 1 --out seen"
    assert run(*asked.split())[0] == 0
    assert len(tomllib.loads(Path("seen/test.toml").read_text())["frequencies"]) == 4  # x alone, of eight
    across = (
        'format = 1\nkind = "modal-table"\narticle = "mast"\nfrequencies = [12.96, 38.85, 82.45]\nfrequency_deviation = 0.001\n'
    )
    shapes = 'sensors = ["middle:x", "tip:x"]\nshapes = [[0.31, 0.88], [0.5, -0.8], [1.3, -1.8]]\nshapes_deviation = 0.01\n'
    Path("across.toml").write_text(across + shapes)
    code, out, err = run("compare", "mast.toml", "across.toml")
    assert code in (0, 1), err
    assert "Where it fails".lower() in out.lower()
