"""A mode of a table that the model has not: of something that swings on the structure, or of none of it."""

from pathlib import Path

import numpy as np
import pytest
import tomlkit
from numpy.typing import ArrayLike

from geometry.errors import BadInput
from validation.diagnose.diagnose import diagnosed, without_strangers
from validation.effects.catalogue import parse
from validation.effects.effect import Vocabulary
from validation.effects.stages import Matrices
from validation.model.model import Added
from validation.prediction.modal_table import real_modes, seen
from validation.study import Study

ANY = Vocabulary(accelerometers=None, forces=None, places=None, parts=None)
FLOORS, MODES = 5, 4
LEGS = 'legs-{1} = ["floor-{0}", "floor-{1}"]'
MODEL = f"""format = 1
model = {{ title = "Storeys", article = "storeys" }}
[fe_model]
kind = "frame"
nodes = {{ foot = "0 mm", {", ".join(f'floor-{k} = "{150 * k} mm"' for k in range(1, FLOORS + 1))} }}
fixed = ["foot"]
moves = ["x"]
members = {{ legs-1 = ["foot", "floor-1"], {", ".join(map(LEGS.format, range(1, FLOORS), range(2, FLOORS + 1)))} }}
section = {{ width = "25 mm", thickness = "3 mm", across = "x", count = 4 }}
material = {{ youngs_modulus = "70 GPa", poisson_ratio = 0.3 }}
masses = {{ {", ".join(f'floor-{k} = "5 kg"' for k in range(1, FLOORS + 1))} }}
"""


def table(folder: Path, frequency: ArrayLike, shapes: ArrayLike) -> Path:
    """Of modes [Hz] and shapes (m, s) at all floors, read to 0.2 and 2 per cent."""
    rng, f = np.random.default_rng(3), np.asarray(frequency)
    read = np.asarray(shapes) / np.abs(shapes).max(axis=1, keepdims=True)
    whole = {
        "format": 1,
        "kind": "modal-table",
        "title": "survey",
        "article": "storeys",
        "frequencies": (f * (1 + 0.002 * rng.standard_normal(len(f)))).tolist(),
        "frequency_deviation": 0.002,
        "shapes_deviation": 0.02,
        "sensors": [f"floor-{k}:x" for k in range(1, FLOORS + 1)],
        "shapes": (read + 0.02 * rng.standard_normal(read.shape)).tolist(),
    }
    path = folder / "survey.toml"
    path.write_text(tomlkit.dumps(whole))
    return path


def swung(folder: Path, mass: float, hertz: float, floor: int) -> tuple[Path, Path]:
    """The model, and a table of the modes that it has with a resonator on a floor; of none where that has no `mass`."""
    model = folder / "model.toml"
    model.write_text(MODEL)
    test = Study.open(model, [table(folder, [3.0, 9, 14, 18], np.eye(FLOORS)[:MODES])]).tests[0]
    of, own = test.structure.nominal, seen(test.structure.nominal, test.table)
    if mass:
        rope = np.append(own[floor - 1], -1.0)
        stiffness = np.pad(of.stiffness, (0, 1)) + mass * (2 * np.pi * hertz) ** 2 * np.outer(rope, rope)
        inertia = np.pad(of.mass, (0, 1)) + mass * np.diag(np.eye(len(rope))[-1])
        none = np.zeros_like(inertia)
        of = Matrices(base=0, mass=inertia, stiffness=stiffness, viscous=none, structural=none, places={})
        own = np.pad(own, ((0, 0), (0, 1)))
    modes, count = real_modes(of), MODES + (mass > 0)
    return model, table(folder, modes.frequency[:count], (own @ modes.shapes[:, :count]).T)


def with_hum(folder: Path, hertz: float) -> tuple[Path, Path]:
    """The model, and a table of its modes with one that is none of it."""
    model, path = swung(folder, 0.0, 0.0, 1)
    test = Study.open(model, [path]).tests[0].table
    k = int(np.searchsorted(test.frequency, hertz))
    odd = np.random.default_rng(8).standard_normal(FLOORS)
    return model, table(folder, np.insert(test.frequency, k, hertz), np.insert(test.shapes, k, odd, axis=0))


def test_the_modes_of_a_sound_structure_are_all_its_own(tmp_path: Path) -> None:
    model, path = swung(tmp_path, 0.0, 0.0, 1)
    _, odd, _ = without_strangers(Study.open(model, [path]), ())
    assert not odd


def test_a_mode_of_the_mains_is_left_out_and_nothing_is_missing(tmp_path: Path) -> None:
    model, path = with_hum(tmp_path, 15.0)
    found = diagnosed(Study.open(model, [path]), only=("point-mass", "absorber"))
    assert (found.verdict, found.accepted) == ("nothing", ())
    assert found.remarks[0].startswith("mode 3 of the table is left out")


def test_resonators_are_refused_where_no_mode_asks_for_one(tmp_path: Path) -> None:
    """None was tried, and it was said that none explains the data."""
    model, path = swung(tmp_path, 0.0, 0.0, 1)
    with pytest.raises(BadInput, match="is no effect that could act on these data and be told by them"):
        diagnosed(Study.open(model, [path]), only=("absorber",))


def test_what_swings_on_a_floor_is_found_there_with_its_mass(tmp_path: Path) -> None:
    model, path = swung(tmp_path, 1.2, 9.0, 4)
    (found,) = diagnosed(Study.open(model, [path]), only=("modulus", "absorber")).accepted
    assert found.id == "absorber:floor-4"
    mass, frequency, _ = found.sizes
    assert mass.low < 1.2 < mass.high < 3
    assert frequency.low < 9.0 < frequency.high
    of = Study.open(model, [path], hold_out=["survey shapes/mode 2", "survey shapes/mode 1"])
    left, odd, _ = without_strangers(of, ())
    assert [name for name, _ in odd] == ["mode 2"]
    assert left.hold_out == ("survey shapes/mode 1",)  # what is not there cannot be held out
    known = Added(named=parse("absorber:floor-4=m:1.2,f:9,zeta:0.01", ANY))
    _, odd, _ = without_strangers(of, (known,))
    assert not odd  # the model has it
