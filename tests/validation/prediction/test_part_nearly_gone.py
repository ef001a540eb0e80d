"""A part of which next to nothing is left, on the coordinates of the whole one."""

from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh

from fem.mesh import deck, model
from fem.modes import lowest
from fem.structure import Structure
from geometry.frames import Array
from validation.prediction import structure as reduced

BAND = 1500.0
COLUMNS, ROWS = 18, 4


@pytest.fixture
def sheet(tmp_path: Path) -> Structure:
    """A sheet of steel that is held at both ends, with a middle third of its own."""
    number = {(i, j): 1 + j + (ROWS + 1) * i for i in range(COLUMNS + 1) for j in range(ROWS + 1)}
    lines = ["BEGIN BULK", "MAT1,1,210000.,,.3,7.85-9", "PSHELL,1,1,5.,1,,1", "PSHELL,2,1,5.,1,,1"]
    lines += [f"GRID,{n},,{25.0 * i},{15.0 * j},0." for (i, j), n in number.items()]
    for i in range(COLUMNS):
        for j in range(ROWS):
            corners = [number[i + a, j + b] for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
            lines.append(f"CQUAD4,{len(lines)},{2 if 6 <= i < 12 else 1},{','.join(map(str, corners))}")
    ends = [number[i, j] for i in (0, COLUMNS) for j in range(ROWS + 1)]
    lines += [f"SPC1,1,123456,{','.join(map(str, ends[:5]))}", f"SPC1,1,123456,{','.join(map(str, ends[5:]))}"]
    (tmp_path / "sheet.bdf").write_text("\n".join([*lines, "ENDDATA", ""]))
    (tmp_path / "sheet.toml").write_text(deck.described(tmp_path / "sheet.bdf")[0])
    return model.load(tmp_path / "sheet.toml")[1]


def errors(made: Structure, change: float) -> Array:
    """Relative, of the frequencies in the band."""
    whole = reduced.by_itself(made, BAND).matrices
    wanted = lowest((made.stiffness + change * made.part_stiffness["2"]).tocsr(), made.mass, 8).values
    found = eigh(whole.stiffness + change * whole.parts["2"], whole.mass, eigvals_only=True, subset_by_index=(0, 7))
    return np.abs(np.sqrt(found / wanted) - 1)[np.sqrt(wanted) < 2 * np.pi * BAND]


def test_frequencies_of_a_sheet_whose_middle_has_lost_97_per_cent(sheet: Structure, monkeypatch: pytest.MonkeyPatch) -> None:
    """Made to 60 % alone, the coordinates are off by up to a tenth; the limit is what this sheet has."""
    found = errors(sheet, -0.97)
    assert np.median(found) < 2e-4
    assert found.max() < 5e-3
    monkeypatch.setattr(reduced, "FAR_MODULUS", reduced.FAR)
    assert errors(sheet, -0.97).max() > 5 * found.max()
