"""A clamp that gives: what the ground holds as one body is a joint, exact at any compliance, and named where it is soft.

The truth holds a finer mesh by a rigid link on six springs; the model, coarser, is held altogether.
"""

import re
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh

from fem.mesh import deck, model
from fem.modes import lowest
from fem.structure import Structure
from geometry.frames import Array
from validation.effects.families import connection_compliance
from validation.prediction import structure as reduced

LENGTH, WIDTH, THICKNESS = 300.0, 60.0, 5.0
"""[mm] of a strip of steel that is clamped at one end."""

STIFF, SOFT = 1e12, 2000.0
"""[N/m or N m/rad] of what holds it, and of its spring about the edge."""

BAND = 1500.0


def strip(folder: Path, name: str, columns: int, rows: int, *, held: bool) -> Path:
    """The description of a strip of so many shells, held altogether or by springs of which one is `SOFT`."""
    number = {(i, j): i * (rows + 1) + j + 1 for i in range(columns + 1) for j in range(rows + 1)}
    lines = ["BEGIN BULK", "MAT1,1,210000.,,.3,7.85-9", f"PSHELL,1,1,{THICKNESS},1,,1"]
    lines += [f"GRID,{n},,{LENGTH * i / columns},{WIDTH * j / rows},0." for (i, j), n in number.items()]
    for i in range(columns):
        for j in range(rows):
            corners = [number[i + a, j + b] for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
            lines.append(f"CQUAD4,{len(lines)},1,{','.join(map(str, corners))}")
    foot = [number[0, j] for j in range(rows + 1)]
    lines += [f"SPC1,1,123456,{','.join(map(str, foot))}"] if held else []
    (folder / f"{name}.bdf").write_text("\n".join([*lines, "ENDDATA", ""]))
    text, lost = deck.described(folder / f"{name}.bdf")
    assert lost == ()
    if not held:
        units = [*3 * [f"{STIFF} N/m"], *(f"{one} N m/rad" for one in (STIFF, SOFT, STIFF))]
        text = text.replace('support = "free"', 'support = "ground"')
        text += f'\n[fe_model.links.foot]\nat = ["0 m", "{WIDTH / 2e3} m", "0 m"]\nnodes = {foot}\n'
        text += f'[fe_model.springs.hold]\nat = "foot"\nstiffness = {units}\n'
    (folder / f"{name}.toml").write_text(text)
    return folder / f"{name}.toml"


def squares(made: Structure, count: int) -> Array:
    return lowest(made.stiffness, made.mass, count).values


def test_a_clamp_that_does_not_give_holds_still(tmp_path: Path) -> None:
    """Of the free strip all that moves the foot is struck out instead: the same frequencies to four digits and more."""
    held = strip(tmp_path, "strip", 8, 2, held=True)
    made = model.load(held)[1]
    assert made.joints == ("clamp@1",)
    text = re.sub("(?m)^interface.*$", "", held.read_text()).replace('"ground"', '"free"')
    held.write_text(text.partition("[fe_model.links.")[0])
    free = model.load(held)[1]
    kept = np.setdiff1d(np.arange(free.mass.shape[0]), np.hstack([free.translations[:3], free.rotations[:3]]))
    np.testing.assert_allclose(free.points[:3, 0], 0)
    K, M = (one[kept][:, kept].toarray() for one in (free.stiffness, free.mass))
    wanted = eigh(K, M, eigvals_only=True, subset_by_index=(0, 7))
    np.testing.assert_allclose(squares(made, 8), wanted, rtol=5e-5)


def test_parts_that_stand_side_by_side_in_a_clamp_give_together(tmp_path: Path) -> None:
    """Welded where they are held, they ride as one, and a change of one of them is felt as it is."""
    both = strip(tmp_path, "strip", 8, 2, held=True)
    lines = (tmp_path / "strip.bdf").read_text().replace("PSHELL,1,1", f"PSHELL,2,1,{THICKNESS},1,,1\nPSHELL,1,1").splitlines()
    odd = [re.sub(r"^(CQUAD4,\d*[02468]),1,", r"\1,2,", line) for line in lines]
    (tmp_path / "strip.bdf").write_text("\n".join(odd) + "\n")
    both.write_text(deck.described(tmp_path / "strip.bdf")[0])
    whole = reduced.by_itself(model.load(both)[1], BAND)
    (joint,) = whole.matrices.joints
    soft = connection_compliance.change(whole.matrices, (joint, "beta"), {"": 1 / 500})
    softer = 0.9
    found = eigh(soft.stiffness - (1 - softer) * soft.parts["2"], soft.mass, eigvals_only=True, subset_by_index=(0, 0))
    text = both.read_text()
    one, two = text.index('[fe_model.parts."2"]'), text.index('[fe_model.parts."1"]')
    part = text[one : two if two > one else len(text)]
    weak = part.replace('youngs_modulus = "2.1e+11 Pa"', f'youngs_modulus = "{softer * 2.1e11} Pa"')
    assert weak != part
    text = re.sub("(?m)^interface.*$", "", text.replace(part, weak)).partition("[fe_model.links.")[0]
    units = [*3 * [f"{STIFF} N/m"], *(f"{k} N m/rad" for k in (STIFF, 500.0, STIFF))]
    text += f'\n[fe_model.links.foot]\nat = ["0 m", "{WIDTH / 2e3} m", "0 m"]\nnodes = [1, 2, 3]\n'
    both.write_text(f'{text}[fe_model.springs.hold]\nat = "foot"\nstiffness = {units}\n')
    np.testing.assert_allclose(found, squares(model.load(both)[1], 1), rtol=1e-3)


@pytest.mark.parametrize("about", [("beta",), ("z", "beta"), ("alpha",)])
def test_what_a_clamp_gives_is_exact(about: tuple[str, ...], tmp_path: Path) -> None:
    """Of the coordinates of the clamped structure, beside the same mesh on springs: to a thousandth of the change."""
    path = strip(tmp_path, "strip", 12, 3, held=True)
    whole = reduced.by_itself(model.load(path)[1], BAND)
    order, soft = ("x", "y", "z", "alpha", "beta", "gamma"), {"z": 1e6, "alpha": 4e3, "beta": SOFT}
    stage = whole.matrices
    for one in about:
        stage = connection_compliance.change(stage, ("clamp@1", one), {"": 1 / soft[one]})
    found = eigh(stage.stiffness, stage.mass, eigvals_only=True, subset_by_index=(0, 4))
    path = strip(tmp_path, "sprung", 12, 3, held=False)
    stiff = [soft[one] if one in about else STIFF for one in order]
    words = [f"{k} {'N/m' if n < 3 else 'N m/rad'}" for n, k in enumerate(stiff)]
    path.write_text(re.sub(r"stiffness = \[.*\]", f"stiffness = {words}", path.read_text()))
    wanted = squares(model.load(path)[1], 5)
    before = squares(whole.structure, 5)
    assert np.abs(found - wanted).max() < 1e-3 * np.abs(wanted - before).max()
    assert np.abs(wanted / before - 1).max() > 0.05


@pytest.fixture
def seven(tmp_path, monkeypatch, run) -> str:
    """A study of the strip held altogether, with seven frequencies of the one on springs."""
    monkeypatch.chdir(tmp_path)
    truth = model.load(strip(tmp_path, "truth", 24, 5, held=False))[1]
    read = ", ".join(f'"{f:.2f} Hz"' for f in np.sqrt(squares(truth, 7)) / (2 * np.pi))
    Path("modes.toml").write_text(f'format = 1\nkind = "modal-table"\nfrequencies = [{read}]\nfrequency_deviation = 0.003\n')
    strip(tmp_path, "strip", 15, 3, held=True)
    code, _, err = run("model", "strip.toml", "--test", "modes.toml", "--out", "study.toml")
    assert code == 0, err
    return "study.toml"


OF_JOINTS = ("--candidate", "connection-compliance", "--candidate", "modulus")


@pytest.mark.parametrize("only", [OF_JOINTS, pytest.param((), id="all families", marks=pytest.mark.proof)])
def test_a_clamp_that_gives_is_named_from_seven_frequencies(only, seven, answer) -> None:
    """From a table without shapes a mass at the tip, or a soft part, was all that could be said."""
    found = answer("diagnose", seven, *only)
    (one,) = found["accepted"]
    assert (found["verdict"], one["id"]) == ("missing", "connection-compliance:clamp@1:beta")
    assert one["interval90"][0] < 1 / SOFT < one["interval90"][1]


@pytest.mark.proof  # a report; test_league.py writes one of such a study
def test_a_report_of_seven_frequencies_says_what_was_held_against_what(seven, run) -> None:
    code, _, err = run("report", seven, "--no-diagnosis", "--out", "report.html")
    assert code in (0, 1), err
    assert "strip was held against 1 data set: 7 modes of tables." in Path("report.html").read_text()
