"""What was found, written for other programs: with it CalculiX has massline's frequencies, and Nastran's cards read back."""

import os
import re
import shutil
import subprocess
from collections.abc import Mapping
from itertools import permutations, product
from pathlib import Path

import numpy as np
import pytest

from fem.mesh import deck
from geometry.errors import BadInput, CheckFailed
from validation.cli.main import run
from validation.model import model_file
from validation.model.write_back import FIRST_MATERIAL, written
from validation.study import Study

PARTS = {"ROOT": "207000., 0.3\n*DENSITY\n7.85e-9", "ARM": "70000., 0.33\n*DENSITY\n2.7e-9"}
"""Elasticity [MPa] and density [t/mm³] of steel and aluminium, as the deck of somebody else has them."""

CELLS, SIZE = (12, 2, 2), (200.0, 30.0, 20.0)
CORNER = 525
"""Node at the upper corner of the free end."""


@pytest.fixture
def beam(tmp_path: Path) -> Path:
    """A folder with the mesh of a cantilever of two parts, in millimetres, quadratic tetrahedra, which CalculiX includes."""
    wide = [2 * n + 1 for n in CELLS]

    def tag(at: tuple[int, ...]) -> int:
        return 1 + at[0] + wide[0] * (at[1] + wide[1] * at[2])

    grid = [(i, j, k) for k in range(wide[2]) for j in range(wide[1]) for i in range(wide[0])]
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{tag(at)}, " + ", ".join(repr(s * a / (2 * n)) for s, a, n in zip(SIZE, at, CELLS, strict=True)) for at in grid]
    elements: dict[str, list[list[int]]] = {name: [] for name in PARTS}
    for first, order in product(np.ndindex(CELLS), permutations(range(3))):  # six tetrahedra a brick
        corners = [2 * np.array(first)]
        for axis in order:
            corners.append(corners[-1] + 2 * np.eye(3, dtype=int)[axis])
        if np.linalg.det(np.array(corners[1:]) - corners[0]) < 0:
            corners[2], corners[3] = corners[3], corners[2]
        middles = [(corners[a] + corners[b]) // 2 for a, b in ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))]
        number = 1 + sum(map(len, elements.values()))
        elements["ROOT" if first[0] < CELLS[0] // 2 else "ARM"].append([number, *(tag(tuple(at)) for at in (*corners, *middles))])
    for name, own in elements.items():
        lines += [f"*ELEMENT, TYPE=C3D10, ELSET={name}", *(", ".join(map(str, one)) for one in own)]
    lines += ["*NSET, NSET=FOOT", *(str(tag(at)) for at in grid if at[0] == 0)]
    (tmp_path / "mesh.inp").write_text("\n".join(lines) + "\n", encoding="utf-8")
    assert tag((24, 0, 4)) == CORNER
    return tmp_path


def model(folder: Path, effects: Mapping[str, float], more: str = "", support: str = "ground", near: str = "650") -> Path:
    """A model file of the beam with `effects`, each known to a tenth, and a table of modes `near` which its own are."""
    places = f'{{ tip = {CORNER}, middle = ["99 mm", "0 mm", "20 mm"], end = "FOOT" }}'
    text = f"""format = 1
model = {{ title = "Beam", article = "beam" }}
[fe_model]
kind = "mesh"
units = "mm"
file = "mesh.inp"
support = "{support}"
interface = ["FOOT"]
places = {places}
parts = {{ ROOT = {{ material = "steel" }}, ARM = {{ material = "aluminium" }} }}
{more}
[[test]]
kind = "modal-table"
article = "beam"
sensors = ["tip:x"]
frequencies = [{", ".join(f'"{hertz} Hz"' for hertz in near.split())}]
"""
    text += "".join(f'[[effect]]\nid = "{name}"\nvalue = {value}\nsd = {abs(value) / 10}\n' for name, value in effects.items())
    (folder / "model.toml").write_text(text, encoding="utf-8")
    return folder / "model.toml"


def of_massline(path: Path) -> np.ndarray:
    """(5,) [Hz] as `massline compare` predicts them."""
    (prediction,) = Study.open(path, []).predictions
    return np.real(prediction.at({one.name: one.start for one in prediction.parameters}, derivatives=()).rows).ravel()


def of_calculix(folder: Path, snippet: str) -> np.ndarray:
    """(5,) [Hz] by CalculiX, in whose deck the snippet takes the place of the materials that it has."""
    if shutil.which("ccx") is None:
        pytest.skip("CalculiX is not installed: apt-get install calculix-ccx")
    own = [f"*MATERIAL, NAME={name}\n*ELASTIC\n{text}\n" for name, text in PARTS.items() if f"NAME={name}\n" not in snippet]
    sections = [f"*SOLID SECTION, ELSET={name}, MATERIAL={name}\n" for name in PARTS]
    step = "*BOUNDARY\nFOOT, 1, 3\n*STEP\n*FREQUENCY\n5\n*END STEP\n"
    (folder / "deck.inp").write_text("".join(["*INCLUDE, INPUT=mesh.inp\n", *own, snippet, *sections, step]), encoding="utf-8")
    command, quiet = ["ccx", "deck"], {**os.environ, "OMP_NUM_THREADS": "1"}
    done = subprocess.run(command, cwd=folder, env=quiet, capture_output=True, text=True, timeout=300, check=False)
    rows = [line.split() for line in (folder / "deck.dat").read_text().splitlines() if re.match(r" +\d+ +0\.\d+E", line)]
    assert "*ERROR" not in done.stdout, done.stdout
    return np.array([float(row[3]) for row in rows if len(row) == 5][:5])


ALONE = {"modulus:ARM": -0.2, "mass:ROOT": 0.3, "point-mass:tip": 0.05, "cable:tip:z": 2e6, "support-stiffness:bearing": 0.4}
STOOD = '[fe_model.springs.bearing]\nat = "tip"\nstiffness = ["0 N/m", "0 N/m", "5e6 N/m", "0 N m/rad", "0 N m/rad", "0 N m/rad"]'


@pytest.mark.calculix
@pytest.mark.parametrize("names", [*((name,) for name in ALONE), tuple(ALONE)[:-1]], ids=lambda names: "+".join(names))
def test_calculix_has_the_frequencies_of_massline_with_what_was_found(beam: Path, names: tuple[str, ...]) -> None:
    """To 1e-4; CalculiX prints seven digits. The effect itself moves them by a hundred times as much."""
    more, effects = STOOD if "support-stiffness:bearing" in names else "", {name: ALONE[name] for name in names}
    there = of_calculix(beam, written(model_file.read(model(beam, effects, more)), "calculix"))
    found = of_massline(
        model(beam, effects, more, near=" ".join(f"{hertz:.2g}" for hertz in there))
    )  # a mode is named by its place
    np.testing.assert_allclose(there, found, rtol=1e-4)
    assert np.abs(of_calculix(beam, "") / found - 1).max() > 1e-2


def test_nastran_reads_back_what_was_found(beam: Path) -> None:
    """The cards in large fields; pyNastran 1.4 reads the same of them."""
    effects = {**ALONE, "structural-damping:ARM": 0.02}
    cards = fields(written(model_file.read(model(beam, effects, STOOD)), "nastran"))
    (aluminium, steel), (mass,), springs = (cards[word] for word in ("MAT1", "CONM2", "CELAS2"))
    assert [float(aluminium[k]) for k in (1, 3, 4, 7)] == [56000.0, 0.33, 2.7e-9, 0.024]
    assert float(steel[4]) == pytest.approx(1.3 * 7.85e-9)
    assert (int(mass[1]), float(mass[3])) == (CORNER, 5e-5)
    assert [(int(one[2]), int(one[3]), float(one[1])) for one in springs] == [(CORNER, 3, 2000.0), (CORNER, 3, 0.4 * 5000)]
    assert len({one[0] for one in (mass, *springs)}) == 3


def test_a_body_that_is_heavier_gets_the_difference_at_its_node(beam: Path) -> None:
    camera = '[fe_model.masses.camera]\nat = "tip"\nmass = "120 g"\n' + f"moments = {3 * ['1e-4 kg m^2'] + 3 * ['0 kg m^2']}"
    text = written(model_file.read(model(beam, {"mass:camera": 0.25}, camera)), "nastran")
    (mass,) = fields(text)["CONM2"]
    assert (int(mass[1]), float(mass[3])) == (CORNER, pytest.approx(3e-5))
    assert "$ mass of camera: was 0.12 kg, found 0.15 kg; this is the difference" in text
    assert "multiply them by 1.25 by hand" in text
    assert "beside the node" not in text
    aside = camera + '\ncog = ["0 mm", "0 mm", "35 mm"]'
    assert "its centre of gravity is 0, 0, 35 beside the node: put it there" in written(
        model_file.read(model(beam, {"mass:camera": 0.25}, aside)), "nastran"
    )


def fields(text: str) -> dict[str, list[list[str]]]:
    """Fields of cards of the large format by their word, numbers as Python has them."""
    found: dict[str, list[list[str]]] = {}
    last: list[str] = []
    for line in text.splitlines():
        if line.startswith("$"):
            continue
        own = [line[k : k + 16].strip() for k in range(8, 72, 16)]
        own = [re.sub(r"(?<=[\d.])([+-]\d+)$", r"e\1", one) for one in own]
        if line.startswith("*"):
            last += own
        else:
            last = own
            found.setdefault(line[:8].strip("* "), []).append(last)
    return found


def test_opensees_has_materials_masses_and_springs_to_a_node_that_is_held(beam: Path) -> None:
    lines = written(model_file.read(model(beam, ALONE, STOOD)), "opensees").splitlines()
    assert "nDMaterial ElasticIsotropic 9002 56000. 0.33 2.7e-09" in lines
    assert f"mass {CORNER} 5.e-05 5.e-05 5.e-05" in lines
    spring = next(k for k, line in enumerate(lines) if line.startswith("node "))
    assert lines[spring + 1].endswith(" 1 1 1")
    assert lines[spring + 3].endswith(f" {CORNER} -mat 289 -dir 3")


def test_what_was_and_what_is_found_stand_beside_each_other_with_the_interval(beam: Path) -> None:
    text = written(model_file.read(model(beam, {"modulus:ARM": -0.2, "point-mass:middle": 0.05})), "calculix")
    assert "** modulus of elasticity of ARM: was 70000, found 56000 (53697.2 to 58302.8)" in text
    assert "** point-mass:middle = 0.05 (0.0417757 to 0.0582243) kg" in text
    assert "stands for middle: the nearest, 1 mm from it" in text
    assert "** units mm-t-N-s; numbers of nodes are those of mesh.inp" in text


@pytest.mark.parametrize(
    ("effect", "said"),
    [
        ("force-gain:fmd-z2", "of the measurement, not of the structure"),
        ("slosh:tip", "no property, mass or spring of a deck says that alone"),
        ("rigid-inertia:Ixx", "change mass and inertia in the mesh"),
        ("modulus:LEG", "states no material of LEG. By hand: multiply the modulus of elasticity of LEG by 1.1"),
        ("point-mass:FAR", "has no node at FAR"),
    ],
)
def test_what_no_deck_can_say_is_said(beam: Path, effect: str, said: str) -> None:
    value = "{ m = 1.0, f = 2.0, zeta = 0.01 }" if effect.startswith("slosh") else 0.1
    path = model(beam, {"mass:ARM": 0.1})
    more = f'[[effect]]\nid = "{effect}"\nvalue = {value}\n'
    path.write_text(path.read_text(encoding="utf-8") + more, encoding="utf-8")
    text = written(model_file.read(path), "calculix")
    assert f"** not written: {effect}: " in text
    assert said in text
    path.write_text(model(beam, {}).read_text(encoding="utf-8") + more, encoding="utf-8")
    with pytest.raises(CheckFailed, match="can be written for CalculiX"):
        written(model_file.read(path), "calculix")


def test_effects_of_a_layered_part_are_those_of_all_its_layers_and_are_said_in_words(tmp_path: Path) -> None:
    """Modulus, density and thickness of a clamped strip of unbalanced layers, its frequencies beside those of another deck."""

    def study(factor: float, effects: Mapping[str, float]) -> Path:
        layers = [(1.0, 0.0), (0.5, 45.0), (0.5, 90.0)]
        lines = ["BEGIN BULK", "MAT8,2,130000.,9000.,.3,5000.,4000.,3000.,1.6-9"]
        lines += ["PCOMP,1\n," + ",".join(f"2,{factor * t},{angle},YES" for t, angle in layers[:2])]
        lines += [f",2,{factor * layers[2][0]},{layers[2][1]},YES"]
        lines += [f"GRID,{1 + 2 * i + j},,{30.0 * i},{40.0 * j},0." for i in range(7) for j in range(2)]
        lines += [f"CQUAD4,{i + 1},1,{2 * i + 1},{2 * i + 3},{2 * i + 4},{2 * i + 2}" for i in range(6)]
        (tmp_path / "strip.bdf").write_text("\n".join([*lines, "SPC1,1,123456,1,2", "ENDDATA", ""]))
        text = deck.described(tmp_path / "strip.bdf", "mm-t-N-s")[0].replace(
            "[fe_model]\n", "[fe_model]\nplaces = { tip = 13 }\n"
        )
        text = text.replace("format = 1\n", 'format = 1\nmodel = { title = "Strip", article = "strip" }\n')
        text += '[[test]]\nkind = "modal-table"\narticle = "strip"\nsensors = ["tip:z"]\nfrequencies = ["80 Hz", "400 Hz"]\n'
        text += "".join(f'[[effect]]\nid = "{name}"\nvalue = {value}\n' for name, value in effects.items())
        (tmp_path / "strip.toml").write_text(text)
        return tmp_path / "strip.toml"

    plain = of_massline(study(1.0, {}))
    for name, value, wanted in (("modulus:1", -0.19, 0.9), ("mass:1", 0.21, 1 / 1.1)):
        np.testing.assert_allclose(of_massline(study(1.0, {name: value})) / plain, wanted, rtol=1e-3)
    thick = of_massline(study(1.0, {"thickness:1": 0.02}))
    np.testing.assert_allclose(
        thick, of_massline(study(1.02, {})), rtol=3e-4
    )  # what grows with the square, but for its curvature
    path = study(1.0, {"modulus:1": -0.2, "point-mass:tip": 0.01})
    for form in ("nastran", "calculix"):
        text = written(model_file.read(path), form)
        assert "modulus:1: 1 is of layers. By hand: multiply the modulus of elasticity of each layer of 1 by 0.8." in text


def test_inertia_rides_on_the_base_as_a_matrix_of_nastran(beam: Path) -> None:
    path = model(beam, {"rigid-inertia:m": 0.5}, support="base")
    cards = fields(written(model_file.read(path), "nastran"))
    (grid,), (matrix,) = cards["GRID"], cards["CONM1"]
    assert grid[0] == matrix[1]
    assert [float(matrix[k]) for k in (3, 5, 8)] == pytest.approx(3 * [0.5e-3])
    y, z = SIZE[1] / 2, SIZE[2] / 2
    assert float(matrix[12]) == pytest.approx(0.5e-3 * (y**2 + z**2))  # about x through the origin, the reference point


@pytest.mark.parametrize(
    ("effects", "said"), [({}, "nothing was found and added yet"), ({"force-gain:fmd-z2": 0.1}, "stand in no deck")]
)
def test_a_model_without_effects_or_without_a_mesh_is_refused(beam: Path, effects: dict[str, float], said: str) -> None:
    path = model(beam, effects)
    if effects:
        text = path.read_text(encoding="utf-8")
        start, end = text.index("[fe_model]"), text.index("[[effect]]")
        path.write_text(text[:start].replace('"beam"', '"fmd+clumod-1"') + text[end:], encoding="utf-8")
    with pytest.raises(BadInput, match=said):
        written(model_file.read(path), "nastran")


def test_the_command_writes_a_file_and_does_not_replace_one(beam: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = ["model", str(model(beam, {"modulus:ARM": -0.2})), "--as", "nastran"]
    assert run([*command, "--out", str(beam / "found.bdf")]) == 0
    assert (beam / "found.bdf").read_text(encoding="utf-8").startswith("$ massline: ")
    assert run([*command, "--out", str(beam / "found.bdf")]) == 2
    assert "--force" in capsys.readouterr().err
    assert run([*command, "--out", str(beam / "found.toml")]) == 2


def test_of_matrices_only_what_they_say_is_written(tmp_path: Path) -> None:
    np.savez(tmp_path / "column.npz", stiffness=np.eye(2), mass=np.eye(2))
    text = """format = 1
model = { title = "Column", article = "column" }
[fe_model]
kind = "matrices"
units = "mm-t-N-s"
support = "ground"
file = "column.npz"
places = { tip = 110, edge = ["0 mm", "0 mm", "10 mm"] }
parts = { arm = { material = "steel" } }
"""
    effects = {"modulus:arm": -0.2, "modulus:column": 0.1, "point-mass:tip": 0.05, "point-mass:edge": 0.1, "cable:tip:z": 1e3}
    text += "".join(f'[[effect]]\nid = "{name}"\nvalue = {value}\n' for name, value in effects.items())
    (tmp_path / "column.toml").write_text(text, encoding="utf-8")
    found = model_file.read(tmp_path / "column.toml")
    cards = written(found, "calculix")
    assert "*ELASTIC\n165600., 0.3" in cards
    assert f"{FIRST_MATERIAL}, 110\n*MASS" in cards
    assert "3\n1.\n" in cards
    assert "not written: modulus:column: column.toml states no material of column. By hand: multiply the modulus" in cards
    assert "not written: point-mass:edge: column.toml says no number of a node at edge" in cards
    assert "not written: cable:tip:z: column.toml says no coordinates of node 110" in written(found, "opensees")
