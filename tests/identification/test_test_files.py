"""Tests of any structure as their TOML describes them: every format, every mistake that is told in words, and the real data."""

import json
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.io import savemat
from scipy.signal import fftconvolve

from geometry.errors import BadInput
from geometry.frames import Array
from identification import test_file
from identification.files import files, text_table
from identification.files.files import Signals
from identification.modal_table import ModalTable
from identification.response_functions import ResponseFunctions
from identification.spectra import response_estimates

F = np.arange(1, 401) * 0.25
PLACES = ("a", "b")


def functions() -> dict[tuple[str, str], Any]:
    """By drive and response, of two modes: complex accelerances."""
    omega = 2 * np.pi * F
    shapes, poles = np.array([[1.0, 0.6], [0.7, -1.0]]), 2 * np.pi * np.array([20.0, 55.0])
    made = {}
    for r, drive in enumerate(PLACES):
        for c, response in enumerate(PLACES):
            terms = [
                -(omega**2) * m[r] * m[c] / (w**2 - omega**2 + 0.02j * w * omega) for m, w in zip(shapes, poles, strict=True)
            ]
            made[drive, response] = sum(terms)
    return made


def written(folder: Path, name: str, columns: list[Any], *, separator: str = ",", header: str = "", form: str = "{!r}") -> None:
    rows = [separator.join(form.format(one) for one in row) for row in zip(*columns, strict=True)]
    (folder / name).write_text("\n".join([header, *rows] if header else rows) + "\n", encoding="utf-8")


def described(**more: Any) -> dict[str, Any]:
    return {"kind": "response-functions", "article": "plate", "direction": "z", "responses": list(PLACES), **more}


def read(folder: Path, table: dict[str, Any]) -> ResponseFunctions:
    found = test_file.read(folder / "test.toml", table)
    assert isinstance(found, ResponseFunctions)
    return found


def two_files(folder: Path) -> list[dict[str, str]]:
    of = functions()
    for drive in PLACES:
        columns = [F.tolist(), *([complex(one) for one in of[drive, at]] for at in PLACES)]
        text = [[str(one).strip("()") for one in column] for column in columns]
        written(folder, f"{drive}.csv", text, separator=";", form="{}")
    return [{"path": f"{drive}.csv", "drive": drive} for drive in PLACES]


def test_complex_numbers_real_and_imaginary_parts_and_magnitudes_with_phases_are_one_test(tmp_path: Path) -> None:
    of, files_of = functions(), two_files(tmp_path)
    whole = read(tmp_path, described(files=files_of))
    exact = np.array([[of[d, c] for c in PLACES] for d in PLACES]).transpose(0, 2, 1)
    assert_allclose(whole.values, exact, rtol=1e-12)
    assert_allclose(whole.frequency, F, rtol=1e-15)
    parts = [part.tolist() for c in PLACES for part in (of["a", c].real, of["a", c].imag)]
    written(tmp_path, "pairs.csv", [F.tolist(), *parts], header="f,a (Real),a (Imag.),b (Real),b (Imag.)")
    pairs = read(tmp_path, described(file="pairs.csv", drive="a"))
    assert_allclose(pairs.values[0], exact[0], rtol=1e-12)
    polar = [p for c in PLACES for p in ((20 * np.log10(np.abs(of["a", c]))).tolist(), np.degrees(np.angle(of["a", c])).tolist())]
    written(tmp_path, "polar.csv", [F.tolist(), *polar])
    decibels = read(tmp_path, described(file="polar.csv", drive="a", parts="decibel-degrees"))
    assert_allclose(decibels.values[0], exact[0], rtol=1e-9)


def test_the_file_itself_is_read_with_its_format_and_fifteen_lines_are_enough(tmp_path: Path) -> None:
    two_files(tmp_path)
    text = """format = 1
kind = "response-functions"
article = "plate"
responses = ["a:z", "b:-z"]
files = [{ path = "a.csv", drive = "a:z" }, { path = "b.csv", drive = "b:-z" }]
unit = "g/N"
band = [5, 80]
gain = "unknown"
share = 0.02
"""
    (tmp_path / "test.toml").write_text(text, encoding="utf-8")
    found = test_file.read(tmp_path / "test.toml")
    assert isinstance(found, ResponseFunctions)
    assert_allclose(found.values[0, :, 0], 9.80665 * functions()["a", "a"], rtol=1e-12)
    assert found.responses[1].direction.tolist() == [0, 0, -1]  # type: ignore[union-attr]
    assert (found.band, found.scaled, found.share) == ((5, 80), False, 0.02)


def test_vectors_of_matlab_and_hdf5_are_response_functions_too(tmp_path: Path) -> None:
    of = functions()
    samples = {"Haa": of["a", "a"], "Hba": of["a", "b"]}
    for name in ("x.mat", "x.h5"):
        files.write(tmp_path / name, Signals(source=name, samples=samples, frequency=F))
        named = described(file=name, drive="a", columns={"a": "Haa", "b": "Hba"})
        assert_allclose(read(tmp_path, named).values[0, :, 1], of["a", "b"], rtol=1e-12)


def universal(path: Path, **changed: Any) -> None:
    """Written by pyuff, which is other code."""
    import pyuff

    file = pyuff.UFF(str(path))
    sets = [
        pyuff.prepare_164(units_code=5, units_description="mm", temp_mode=1, length=1e3, force=1.0, temp=1.0, temp_offset=1.0)
    ]
    sets.append(pyuff.prepare_2411([1, 2], [1, 1], [1, 1], [1, 1], [0.0, 250.0], [0.0, 0.0], [100.0, 100.0]))
    for (drive, response), H in functions().items():
        head = {
            "binary": 0, "func_type": 4, "rsp_node": PLACES.index(response) + 1, "rsp_dir": 3, "ref_dir": -3,
            "ref_node": PLACES.index(drive) + 1, "data": 1e3 * H, "x": F, "id1": f"{response}/{drive}", "rsp_ent_name": "NONE",
            "ref_ent_name": "NONE", "abscissa_spacing": 1, "abscissa_min": F[0], "abscissa_inc": F[1] - F[0], "num_pts": len(F),
            "ordinate_spec_data_type": 12, "orddenom_spec_data_type": 13, "abscissa_spec_data_type": 18, "ord_data_type": 6,
        }  # fmt: skip
        sets.append(pyuff.prepare_58(**{**head, **changed}))
    file.write_sets(sets, mode="overwrite")


@pytest.mark.parametrize("places", [{"2": "tip"}, {"tip": 2}])
def test_a_universal_file_brings_places_units_and_references_along(tmp_path: Path, places: dict[str, str | int]) -> None:
    universal(tmp_path / "test.uff")
    table = {"kind": "response-functions", "article": "plate", "file": "test.uff", "places": places}
    found = read(tmp_path, table)
    of = functions()
    assert_allclose(found.values, np.array([[of[d, c] for c in PLACES] for d in PLACES]).transpose(0, 2, 1), rtol=1e-10)
    assert [one.place for one in found.drives] == ["node 1", "tip"]
    assert found.drives[0].direction.tolist() == [0, 0, -1]  # type: ignore[union-attr]
    assert_allclose(found.responses[1].position, [0.25, 0.0, 0.1])  # type: ignore[arg-type]
    assert found.quantity == "acceleration"


def test_a_universal_file_of_displacements_says_so_and_one_upside_down_too(tmp_path: Path) -> None:
    table = {"kind": "response-functions", "article": "plate", "file": "test.uff"}
    universal(tmp_path / "test.uff", ordinate_spec_data_type=8)
    assert read(tmp_path, table).quantity == "displacement"
    universal(tmp_path / "test.uff", ordinate_spec_data_type=13, orddenom_spec_data_type=12)
    with pytest.raises(BadInput, match="force over acceleration"):
        read(tmp_path, table)
    universal(tmp_path / "test.uff", ref_node=0, ref_dir=0)
    with pytest.raises(BadInput, match="reference"):
        read(tmp_path, table)


@pytest.mark.parametrize("complex_modes", [False, True])
def test_modes_of_a_universal_file_are_a_table(tmp_path: Path, complex_modes: bool) -> None:
    import pyuff

    z, shape = np.zeros(2), np.array([[1.0, -0.5], [0.3, 1.0]])
    sets = [pyuff.prepare_2411([7, 9], [1, 1], [1, 1], [1, 1], [0.0, 1.0], z, z)]
    for k, row in enumerate(shape):
        pole = 2 * np.pi * (10.0 + k) * (-0.01 + 1j * np.sqrt(1 - 1e-4))
        kind: dict[str, Any] = {"analysis_type": 2, "freq": 10.0 + k, "modal_damp_vis": 0.01}
        if complex_modes:
            row, kind = row * (1 + 0.5j), {"analysis_type": 3, "eig": pole, "modal_a": 1 + 0j, "modal_b": 1 + 0j}
        sets.append(
            pyuff.prepare_55(
                **kind, data_ch=2, spec_data_type=8, load_case=1, mode_n=k + 1, node_nums=[7, 9], r1=0 * row, r2=0 * row, r3=row
            )
        )
    pyuff.UFF(str(tmp_path / "modes.unv")).write_sets(sets, mode="overwrite")
    found = test_file.read(
        tmp_path / "t.toml", {"kind": "modal-table", "article": "beam", "file": "modes.unv", "places": {"9": "tip"}}
    )
    assert isinstance(found, ModalTable)
    assert_allclose(found.frequency, [10, 11], rtol=1e-5)  # six digits
    assert_allclose(found.damping_ratio, 0.01, rtol=1e-4)  # type: ignore[arg-type]
    assert [(one.place, one.name) for one in found.sensors] == [("node 7", "node-7-z"), ("tip", "tip-z")]
    assert_allclose(np.asarray(found.shapes), shape * (1 + 0.5j if complex_modes else 1), rtol=1e-5)
    assert any("deviation" in one for one in found.warnings)
    text = (tmp_path / "modes.unv").read_text().replace("         9\n", "     60101\n").replace("         7\n", "      60109\n")
    (tmp_path / "wide.unv").write_text(text)  # a number of its own line may stand a column too far right, and had lost its end
    wide = test_file.read(tmp_path / "t.toml", {"kind": "modal-table", "article": "beam", "file": "wide.unv"})
    assert isinstance(wide, ModalTable)
    assert [one.place for one in wide.sensors] == ["node 60109", "node 60101"]


@pytest.mark.parametrize(
    ("damping", "per_cent"),
    [([0.3, 0.5, 0.8], True), ([0.02, 0.5, 0.04], False), ([0.3, 0.5], False), ([0.003, 0.005, 0.008], False)],
)
def test_damping_that_is_likely_in_per_cent_is_doubted(damping: list[float], per_cent: bool) -> None:
    table = {"kind": "modal-table", "article": "beam", "frequencies": [10.0, 20.0, 30.0][: len(damping)], "damping": damping}
    found = test_file.read(Path("lab.toml"), table)
    assert any("0.3 to 0.8 of critical: it is likely in per cent" in one for one in found.warnings) == per_cent


def test_a_damping_ratio_above_one_is_refused_with_what_a_share_is(tmp_path: Path) -> None:
    import pyuff

    z = np.zeros(2)
    mode = {
        "analysis_type": 2,
        "freq": 10.0,
        "modal_damp_vis": 1.5,
        "data_ch": 2,
        "spec_data_type": 8,
        "load_case": 1,
        "mode_n": 1,
    }
    pyuff.UFF(str(tmp_path / "m.unv")).write_sets(
        [pyuff.prepare_55(**mode, node_nums=[7, 9], r1=z, r2=z, r3=z + 1)], mode="overwrite"
    )
    with pytest.raises(BadInput, match=r"damping ratio 1.5, where a share below 1 is read. Export it as a share, 0.01 for 1 %"):
        test_file.read(tmp_path / "t.toml", {"kind": "modal-table", "article": "beam", "file": "m.unv"})


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "no file": ({"file": "none.csv", "drive": "a"}, "there is no file"),
    "reference missing": ({"file": "a.csv"}, "reference is missing"),
    "one reference's file missing": (
        {"files": [{"path": "a.csv", "drive": "a"}, {"path": "short.csv", "drive": "b", "responses": ["a"]}]},
        "missing: b-z over b-z",
    ),
    "unequal resolution": ({"files": [{"path": "a.csv", "drive": "a"}, {"path": "coarse.csv", "drive": "b"}]}, "apart"),
    "upside down by its unit": ({"file": "a.csv", "drive": "a", "unit": "N/(m/s^2)"}, "force over acceleration"),
    "upside down by its looks": (
        {"files": [{"path": "up-a.csv", "drive": "a"}, {"path": "up-b.csv", "drive": "b"}]},
        "force over response",
    ),
    "magnitude alone": ({"file": "magnitude.csv", "drive": "a"}, "complex"),
    "decibels alone": ({"file": "decibels.csv", "drive": "a"}, "decibels"),
    "phase in degrees": ({"file": "polar.csv", "drive": "a"}, "magnitude and phase"),
    "no direction": ({"file": "a.csv", "drive": "a", "direction": ""}, "direction"),
    "another axis": ({"file": "a.csv", "drive": "a:w"}, "no axis 'w'"),
    "unknown key": ({"file": "a.csv", "drive": "a", "bend": [1, 2]}, "band"),
    "unit of something else": ({"file": "a.csv", "drive": "a", "unit": "K"}, "none of acceleration"),
    "columns": ({"file": "a.csv", "drive": "a", "responses": ["a", "b", "c"]}, "columns"),
    "twice": ({"files": [{"path": "a.csv", "drive": "a"}, {"path": "a.csv", "drive": "a"}]}, "is there twice"),
    "band": ({"file": "a.csv", "drive": "a", "band": [500, 600]}, "band"),
    "not finite": ({"file": "nan.csv", "drive": "a"}, "finite"),
    "file and files": ({"file": "a.csv", "files": [], "drive": "a"}, "one of `file` and `files`"),
    "a file without a path": ({"files": [{"drive": "a"}]}, "names no file"),
    "no responses": ({"file": "a.csv", "drive": "a", "responses": []}, "responses`: is missing"),
    "a gain below zero": ({"file": "a.csv", "drive": "a", "gain": -1}, "a share such as 0.02"),
    "a place in a plane": ({"file": "a.csv", "drive": "a", "coordinates": {"a": [0.1, 0.2]}}, "three lengths"),
    "a block below zero": ({"file": "a.csv", "drive": "a", "records": {"kind": "hammer", "block": -1}}, "not negative"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_used_is_refused_in_words(case: str, tmp_path: Path) -> None:
    two_files(tmp_path)
    of = functions()
    for name, chosen in (("short", F[:200]), ("coarse", 2 * F)):
        count = 1 if name == "short" else 2
        written(tmp_path, f"{name}.csv", [chosen.tolist(), *[[f"{k}+1j" for k in range(len(chosen))]] * count], form="{}")
    for drive in PLACES:
        upside = [[str(complex(one)).strip("()") for one in 1 / of[drive, c]] for c in PLACES]
        written(tmp_path, f"up-{drive}.csv", [F.tolist(), *upside], form="{}")
    level = [np.abs(of["a", c]) for c in PLACES]
    written(tmp_path, "magnitude.csv", [F.tolist(), *(one.tolist() for one in level)])
    written(tmp_path, "decibels.csv", [F.tolist(), *((20 * np.log10(one) - 60).tolist() for one in level)])
    polar = [part.tolist() for c in PLACES for part in (np.abs(of["a", c]), np.degrees(np.angle(of["a", c])))]
    written(tmp_path, "polar.csv", [F.tolist(), *polar])
    written(tmp_path, "nan.csv", [F.tolist(), *[["nan+0j"] * len(F)] * 2], form="{}")
    more, said = REFUSED[case]
    with pytest.raises(BadInput, match=said):
        read(tmp_path, described(**more))


MODES: dict[str, tuple[dict[str, Any], str]] = {
    "no frequency": ({"frequencies": []}, "list"),
    "negative": ({"frequencies": [-1.0, 2.0]}, "positive"),
    "shapes of other modes": ({"frequencies": [1.0], "shapes": [[1, 2], [3, 4]], "sensors": ["a:x", "b:x"]}, "2 modes"),
    "shapes without sensors": ({"frequencies": [1.0], "shapes": [[1, 2]]}, "0 sensors"),
    "a zero shape": ({"frequencies": [1.0], "shapes": [[0, 0]], "sensors": ["a:x", "b:x"]}, "zero"),
    "words": ({"frequencies": [1.0], "shapes": [["x", 0]], "sensors": ["a:x", "b:x"]}, "list of numbers"),
    "unequal rows": ({"frequencies": [1.0, 2.0], "shapes": [[1], [1, 2]], "sensors": ["a:x"]}, "list of numbers a mode"),
    "one shape for a list": ({"frequencies": [1.0], "shapes": [1, 2], "sensors": ["a:x", "b:x"]}, "list of numbers a mode"),
    "a deviation below zero": (
        {"frequencies": [1.0], "shapes": [[1, 2]], "sensors": ["a:x", "b:x"], "shapes_deviation": -0.1},
        "a share such as",
    ),
    "damping of one mode": ({"frequencies": [1.0, 2.0], "damping": [0.01]}, "states 1 modes, and frequencies 2"),
    "a frequency that is true": ({"frequencies": [True]}, "must be a number"),
    "a gain below zero": ({"frequencies": [1.0], "gain": -1}, "a share such as 0.02"),
    "a sensor twice": ({"frequencies": [1.0], "shapes": [[1, 2]], "sensors": ["a:x", "a:x"]}, "twice"),
    "of another dimension": ({"frequencies": ["3 kg"]}, "frequency"),
}  # fmt: skip


@pytest.mark.parametrize("case", MODES)
def test_a_table_of_modes_that_cannot_be_used_is_refused_in_words(case: str, tmp_path: Path) -> None:
    more, said = MODES[case]
    with pytest.raises(BadInput, match=said):
        test_file.read(tmp_path / "t.toml", {"kind": "modal-table", "article": "beam", **more})


READ_BEFORE = ["10 +/- 0.1 Hz", "16 +/- 0.2 Hz", "30 +/- 0.3 Hz"]
BEFORE = {"format": 1, "kind": "modal-table", "article": "beam", "frequencies": READ_BEFORE}


def test_a_lone_sensor_whose_shape_says_nothing_is_a_place_of_the_structure_all_the_same(tmp_path: Path) -> None:
    """Its shape is left out; the sensor went with it, and a place that is misspelt was never looked at."""
    table = {"kind": "modal-table", "article": "beam", "frequencies": [1.0, 2.0], "sensors": ["topp:y"], "shapes": [[1.0], [0.5]]}
    found = test_file.read(tmp_path / "t.toml", table)
    assert isinstance(found, ModalTable)
    assert found.shapes is None
    assert [one.place for one in found.sensors] == ["topp"]


def toml_of(table: dict[str, Any]) -> str:
    return "".join(f"{key} = {json.dumps(value)}\n" for key, value in table.items())


def test_a_table_names_the_test_before_and_each_mode_has_that_of_then(tmp_path: Path) -> None:
    (tmp_path / "before.toml").write_text(toml_of(BEFORE), encoding="utf-8")
    table = {"kind": "modal-table", "article": "beam", "before": "before.toml", "frequencies": [9.5, 29.0], "leave_out": [1]}
    found = test_file.read(tmp_path / "t.toml", table)
    assert isinstance(found, ModalTable)
    assert found.before is not None
    assert_allclose([found.frequency[0], *found.before[0]], [29.0, 30.0, 0.3])


def test_a_mode_that_the_test_before_has_not_may_be_left_out(tmp_path: Path) -> None:
    """Four modes where the one before has three; and that may itself name one before it, even this."""
    (tmp_path / "before.toml").write_text(toml_of({**BEFORE, "before": "after.toml"}), encoding="utf-8")
    of = {"kind": "modal-table", "article": "beam", "frequencies": [9.5, 15.0, 19.0, 29.0], "leave_out": [2]}
    (tmp_path / "after.toml").write_text(toml_of({**of, "before": "before.toml"}), encoding="utf-8")
    found = test_file.read(tmp_path / "after.toml", {**of, "before": "before.toml"})
    assert isinstance(found, ModalTable)
    assert found.before is not None
    assert_allclose(found.before[:, 0], [10.0, 16.0, 30.0])
    with pytest.raises(BadInput, match="names its own table"):
        test_file.read(tmp_path / "after.toml", {**of, "before": "after.toml"})


@pytest.mark.parametrize(
    ("earlier", "frequencies", "said"),
    [
        ({**BEFORE, "kind": "response-functions"}, [9.5, 15.0, 29.0], "kind = 'response-functions'"),
        ({**BEFORE, "drive": "tip:z"}, [9.5], "before.toml"),
        ({**BEFORE, "article": "plate"}, [9.5], "3 modes of plate, and here are 1 of beam"),
        (BEFORE, [9.0, 15.0, 29.0, 40.0], "before.toml has 3 modes of beam, and here are 4 of beam"),
    ],
)
def test_a_test_before_that_is_none_of_the_same_is_refused(
    earlier: dict[str, Any], frequencies: list[float], said: str, tmp_path: Path
) -> None:
    (tmp_path / "before.toml").write_text(toml_of(earlier), encoding="utf-8")
    table = {"kind": "modal-table", "article": "beam", "before": "before.toml", "frequencies": frequencies}
    with pytest.raises(BadInput, match=said):
        test_file.read(tmp_path / "t.toml", table)


def test_names_of_a_column_are_those_of_the_sensors_stated_beside_it(tmp_path: Path) -> None:
    """They were taken as places, each along `direction`."""
    (tmp_path / "shapes.csv").write_text("sensor,mode1\nA 2,0.5\ntip:z,0.2\nA1,1.0\n")
    (tmp_path / "table.toml").write_text(
        'format = 1\nkind = "modal-table"\narticle = "tower"\ndirection = "x"\nfrequencies = ["4.8 +/- 0.1 Hz"]\n'
        'sensors = [{ name = "A1", place = "top", direction = [0.8, 0.6, 0] },'
        '{ name = "A 2", place = "top", direction = "z" }]\n'
        'shapes = { file = "shapes.csv", sensor = "sensor", modes = "mode{}" }\n'
    )
    table = test_file.read(tmp_path / "table.toml")
    assert isinstance(table, ModalTable)
    assert [one.place for one in table.sensors] == ["top", "tip", "top"]
    np.testing.assert_allclose([one.direction for one in table.sensors], [[0, 0, 1], [0, 0, 1], [0.8, 0.6, 0]])
    np.testing.assert_allclose(table.shapes, [[0.5, 0.2, 1.0]])


def test_a_table_that_is_typed_has_deviations_or_says_that_the_usual_are_taken(tmp_path: Path) -> None:
    table = {
        "kind": "modal-table",
        "article": "beam",
        "frequencies": ["4.06 +/- 0.03 Hz", "4.55 +/- 0.02 Hz"],
        "damping": [0.01, 0.02],
    }
    found = test_file.read(tmp_path / "t.toml", table)
    assert isinstance(found, ModalTable)
    assert_allclose(found.frequency_deviation, [0.03, 0.02], rtol=1e-12)
    assert_allclose(found.damping_deviation, [0.002, 0.004], rtol=1e-12)  # type: ignore[arg-type]
    assert len(found.warnings) == 1


def test_shapes_that_were_scaled_to_a_sensor_are_told_of_once(tmp_path: Path) -> None:
    table = {
        "kind": "modal-table",
        "article": "beam",
        "frequencies": ["4.06 +/- 0.03 Hz", "4.55 +/- 0.02 Hz"],
        "shapes": {"file": "shapes.csv", "sensor": "dof", "modes": "mode{}", "deviations": "sd{}"},
    }
    rows = "dof,mode1,mode2,sd1,sd2\nnorth:z,1,0.5,0,0.01\nmiddle:z,0.4,0.3,0.01,0.02\nsouth:z,0.2,1,0.02,0\n"
    (tmp_path / "shapes.csv").write_text(rows)
    found = test_file.read(tmp_path / "t.toml", table)
    assert isinstance(found, ModalTable)
    assert len(found.warnings) == 1
    assert "mode 1 at north-z, mode 2 at south-z" in found.warnings[0]


def test_one_fault_of_several_records_is_told_once_and_no_peak_beyond_the_band(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    force = rng.standard_normal(RATE * 4)
    names, x = ("a.csv", "b.csv"), answer(force, zeta=0.001)
    for name in names:
        np.savetxt(
            tmp_path / name, np.column_stack([np.arange(len(force)) / RATE, force, x]), delimiter=",", header="t,f,x", comments=""
        )
    columns = {"time": "t", "force": "f", "response": "x"}
    table = {
        "kind": "response-functions",
        "article": "beam",
        "drive": "tip:z",
        "band": [5.0, 30.0],
        "records": {"block": "4 s", "window": "boxcar"},
        "files": [{"path": name, "responses": [f"{name[0]}:z"], "columns": columns} for name in names],
    }
    (said,) = (one for one in test_file.read(tmp_path / "t.toml", table).warnings if "average" in one)
    assert all(name in said for name in names)
    assert said.endswith("take a shorter block")
    near = test_file.read(tmp_path / "t.toml", table | {"band": [5.0, 100.0]}).warnings
    told = [one for one in near if "average" in one]  # a shorter block would mend one fault, a longer one the other
    assert len(told) == 1
    assert told[0].endswith("record for longer")


POLES = {
    "Fn": np.array([4.06, 4.55]),
    "Xi": np.array([0.011, 0.013]),
    "Phi": np.array([[1.0, 0.4 + 0.1j], [0.6, -1.0], [-0.2j, 0.5]]),
    "Fn_std": np.array([0.02, 0.03]),
    "Xi_std": np.array([0.002, 0.001]),
    "Phi_std": np.full((3, 2), 0.04),
}
"""As pyOMA2 names what it found: a row of `Phi` a sensor, a column a mode."""
OF_POLES = {"kind": "modal-table", "article": "bridge", "sensors": ["north:z", "middle:z", "south:z"]}


def saved(ending: str, folder: Path, found: dict[str, Any]) -> str:
    path = folder / f"poles{ending}"
    if ending == ".npz":
        np.savez(path, **found)
    elif ending == ".mat":
        savemat(path, {name: value for name, value in found.items() if value is not None})
    elif ending == ".h5":
        with h5py.File(path, "w") as file:
            file.update({name: value for name, value in found.items() if value is not None})
    else:
        parts = {name: {"real": v.real.tolist(), "imag": v.imag.tolist()} for name, v in found.items() if np.iscomplexobj(v)}
        whole = {name: v if v is None else v.tolist() for name, v in found.items() if name not in parts}
        path.write_text(json.dumps(whole | parts))
    return path.name


@pytest.mark.parametrize("ending", [".npz", ".mat", ".h5", ".json"])
def test_poles_of_pyoma_and_of_sdypy_are_read_with_their_deviations_from_any_file(ending: str, tmp_path: Path) -> None:
    found = test_file.read(tmp_path / "t.toml", {**OF_POLES, "file": saved(ending, tmp_path, POLES)})
    assert isinstance(found, ModalTable)
    for name, one in (("Fn", found.frequency), ("Fn_std", found.frequency_deviation), ("Xi", found.damping_ratio)):
        assert_allclose(one, POLES[name], rtol=1e-14)  # type: ignore[arg-type]
    assert_allclose(found.shapes, POLES["Phi"].T, rtol=1e-14)  # type: ignore[arg-type]
    assert_allclose(found.shapes_deviation, POLES["Phi_std"].T, rtol=1e-14)  # type: ignore[arg-type]
    assert found.warnings == ()
    # sdypy-EMA has no deviations; constants stand for shapes where no driving point was named
    named = {"nat_freq": POLES["Fn"], "nat_xi": POLES["Xi"], "A": POLES["Phi"], "phi": None}
    other = test_file.read(tmp_path / "t.toml", {**OF_POLES, "leave_out": [1], "file": saved(ending, tmp_path, named)})
    assert isinstance(other, ModalTable)
    assert (other.names, other.frequency.tolist()) == (("mode 2",), [4.55])
    assert_allclose(other.shapes, POLES["Phi"].T[1:], rtol=1e-14)  # type: ignore[arg-type]
    assert len(other.warnings) == 3  # usual deviations are taken, and said


OF_ARRAYS: dict[str, tuple[dict[str, Any], dict[str, Any], str]] = {
    "no frequencies": ({"Fn": None}, {}, "no array Fn or nat_freq"),
    "all poles": ({"Fn": np.ones((3, 4))}, {}, "one real number a mode"),
    "another sensor": ({}, {"sensors": ["north:z"]}, "1 sensors are named"),
    "a name that is none": ({}, {"arrays": {"shapes": "Psi"}}, "no array Psi"),
    "a mode that was not found": ({"Fn": np.array([4.06, np.nan])}, {}, "nan Hz of mode 2"),
    "a shape that was not found": ({"Phi": np.full((3, 2), np.nan)}, {}, "not finite"),
    "all left out": ({}, {"leave_out": [1, 2]}, "not of all"),
    "objects": ({"Phi": np.array([None, "x"])}, {}, "only pickle could read"),
}


@pytest.mark.parametrize("case", OF_ARRAYS)
def test_arrays_that_are_no_table_of_modes_are_refused_by_name(case: str, tmp_path: Path) -> None:
    changed, more, said = OF_ARRAYS[case]
    name = saved(".npz", tmp_path, {**POLES, **changed})
    with pytest.raises(BadInput, match=said):
        test_file.read(tmp_path / "t.toml", {**OF_POLES, "file": name, **more})


@pytest.mark.parametrize("wild", [1e300, np.nan])
def test_a_record_with_a_number_that_nothing_reads_is_refused(wild: float, tmp_path: Path) -> None:
    force = 50 * np.sin(np.pi * np.clip((np.arange(1024) / 512 % 1.0 - 0.1) / 0.01, 0, 1))
    ring = answer(force)
    ring[700] = wild
    samples = {"force": force, "a-z": ring, "b-z": ring}
    files.write(tmp_path / "x.h5", Signals(source="x", samples=samples, sampling_rate=512.0))
    with pytest.raises(BadInput, match="beyond 1e"):
        read(tmp_path, described(file="x.h5", drive="a", records={"kind": "hammer", "block": 1.0}))


def test_a_pickle_is_not_read(tmp_path: Path) -> None:
    (tmp_path / "setup.pkl").write_bytes(b"\x80\x04N.")
    with pytest.raises(BadInput, match="can run programs"):
        test_file.read(tmp_path / "t.toml", {**OF_POLES, "file": "setup.pkl"})


@given(st.complex_numbers(allow_nan=False, allow_infinity=False, max_magnitude=1e9))
def test_a_complex_number_is_read_as_python_writes_it(number: complex) -> None:
    assert text_table.as_number(str(number)) == number
    assert text_table.as_number(str(number).replace("j", "i").strip("()")) == number


@given(st.text(max_size=40))
def test_no_text_makes_the_reader_of_numbers_fail(text: str) -> None:
    found = text_table.as_number(text)
    assert found is None or isinstance(found, complex)


# Records of force and response.

RATE = 1024


def answer(force: Array, frequency: float = 60.0, zeta: float = 0.01) -> Array:
    """Displacement of one mode of unit mass, by its impulse response."""
    w = 2 * np.pi * frequency
    t = np.arange(len(force)) / RATE
    h = np.exp(-zeta * w * t) * np.sin(w * np.sqrt(1 - zeta**2) * t) / (w * np.sqrt(1 - zeta**2)) / RATE
    return np.asarray(fftconvolve(force, h)[: len(force)])


def exact(f: Array, decay: float = 0.0, frequency: float = 60.0, zeta: float = 0.01) -> Any:
    w, s = 2 * np.pi * frequency, 2j * np.pi * f + (1 / decay if decay else 0.0)
    return 1 / (s**2 + 2 * zeta * w * s + w**2)


def test_estimators_of_a_shaker_bracket_the_function_where_each_channel_is_noisy() -> None:
    rng = np.random.default_rng(0)
    force = rng.standard_normal(RATE * 120)
    x = answer(force)
    noise = 0.5 * x.std() * rng.standard_normal(len(x))
    level = {}
    for of in response_estimates.ESTIMATORS:
        made = response_estimates.shaken(force[:, None], (x + noise)[:, None], RATE, block=4.0, estimator=of)
        away = (made.frequency > 20) & (made.frequency < 50)
        level[of] = np.median(np.abs(made.values[0, away, 0] / exact(made.frequency[away])))
    assert level["H1"] == pytest.approx(1, abs=0.06)
    assert level["H1"] < level["Hv"] < level["H2"]
    clean = response_estimates.shaken(force[:, None], x[:, None], RATE, block=8.0)
    near = np.abs(clean.frequency - 60) < 3
    assert_allclose(clean.values[0, near, 0], exact(clean.frequency[near]), rtol=0.06)  # leakage of 8 s at this damping
    assert clean.coherence[0, near].min() > 0.95


def test_a_hann_window_smears_what_random_forces_drive_and_nothing_that_repeats_in_every_block() -> None:
    block = np.random.default_rng(0).standard_normal(RATE * 4)
    forces = {"random": np.random.default_rng(1).standard_normal(20 * len(block)), "periodic": np.tile(block, 20)}
    smeared = {
        (name, window): response_estimates.shaken(one[:, None], answer(one)[:, None], RATE, block=4.0, window=window).smeared
        for name, one in forces.items()
        for window in ("hann", "boxcar")
    }
    assert [key for key, share in smeared.items() if share] == [("random", "hann")]


def test_several_shakers_at_a_time_are_told_apart_and_their_noise_is_what_their_coherence_says() -> None:
    rng, errors, said = np.random.default_rng(1), [], []
    for _ in range(20):
        one, other = rng.standard_normal((2, RATE * 60))
        other = 0.5 * one + other  # the structure couples them a little
        x = answer(one) - 2 * answer(other, frequency=45.0)
        x = x + 0.1 * x.std() * rng.standard_normal(len(x))
        made = response_estimates.shaken(np.column_stack([one, other]), x[:, None], RATE, block=2.0)
        away = (made.frequency > 10) & (made.frequency < 30)
        true = np.array([exact(made.frequency[away]), -2 * exact(made.frequency[away], frequency=45.0)])
        H, g2 = made.values[:, away, 0], made.coherence[:, away, 0]
        errors.append(np.mean(np.abs(H / true - 1) ** 2, axis=1))
        said.append(np.mean((1 - g2) / (g2 * made.averages), axis=1))
        alone = response_estimates.shaken(one[:, None], x[:, None], RATE, block=2.0)
        assert np.median(np.abs(alone.values[0, away, 0] / true[0] - 1)) > 0.5
    assert_allclose(np.sqrt(np.mean(errors, axis=0)), np.sqrt(np.mean(said, axis=0)), rtol=0.1)
    with pytest.raises(BadInput, match="2 forces are as one"):
        response_estimates.shaken(np.column_stack([one, 1.5 * one + 0.01 * other]), x[:, None], RATE, block=2.0)
    for copies in ([one, one], [one, -2 * one], [one, other, one + other]):
        with pytest.raises(BadInput, match="forces are as one"):
            response_estimates.shaken(np.column_stack(copies), x[:, None], RATE, block=2.0)
    with pytest.raises(BadInput, match=r"H2 of .* averages does not tell 2 forces"):
        response_estimates.shaken(np.column_stack([one, other]), x[:, None], RATE, block=2.0, estimator="H2")


def blows_of(zeta: float, count: int = 4) -> tuple[Array, Array]:
    """Blows 4 s apart, each answered until the next."""
    force, found = np.zeros(4 * RATE * count), np.zeros(4 * RATE * count)
    for k in range(count):
        own = slice(4 * RATE * k, 4 * RATE * (k + 1))
        force[own.start + 100 : own.start + 105] = (100 + 10 * k) * np.sin(np.pi * np.arange(5) / 4)
        alone = np.zeros(4 * RATE)
        alone[:] = force[own]
        found[own] = answer(alone, zeta=zeta)
    return force, found


@pytest.mark.parametrize(("zeta", "decay"), [(0.01, 0.0), (0.001, 0.6)])
def test_blows_give_the_function_on_the_axis_to_which_their_window_moves_it(zeta: float, decay: float) -> None:
    force, x = blows_of(zeta)
    found = response_estimates.blows(force, x[:, None], RATE, block=3.8)
    assert [one.fault for one in found] == [""] * 4
    made = response_estimates.struck(found, RATE, decay=decay)
    near = np.abs(made.frequency - 60) < 5
    assert_allclose(made.values[0, near, 0], exact(made.frequency[near], decay, zeta=zeta), rtol=3e-3)  # what is left at the end
    assert not made.warnings
    assert not made.rings
    if decay:
        short = response_estimates.struck(found, RATE)
        assert short.rings > 0.05
        assert np.abs(short.values[0, near, 0]).max() < 0.9 * np.abs(exact(made.frequency[near], zeta=zeta)).max()


def test_double_hits_overload_and_blows_beside_their_point_are_said_by_blow() -> None:
    force, x = blows_of(0.01, count=7)
    hit = 4 * RATE * 1 + 160
    force[hit : hit + 5] += 40 * np.sin(np.pi * np.arange(5) / 4)
    start = 4 * RATE * 2 + 100
    force[start - 3 : start + 5] = 130.0
    beside = slice(4 * RATE * 4, 4 * RATE * 5)
    x = np.array(x)
    x[beside] *= 0.7
    found = response_estimates.blows(force, x[:, None], RATE, block=3.8)
    assert "double hit" in found[1].fault
    assert "overloaded" in found[2].fault
    made = response_estimates.struck(found, RATE)
    assert made.averages == 5
    assert sum("left out" in one for one in made.warnings) == 2
    assert any("16.1 s has poor coherence" in one for one in made.warnings)
    with pytest.raises(BadInput, match="none of 2 blows can be used"):
        response_estimates.struck(found[1:3], RATE)


def test_short_blows_that_end_at_one_force_are_overloaded_and_copies_of_one_are_not() -> None:
    """A blow of six samples is flat for two or three where its amplifier ends, and never was for five."""
    force, size = np.zeros(6 * 4 * RATE), np.array([0.9, 0.6, 1.1, 0.5, 1.0, 0.55])
    pulse = np.sin(np.pi * np.arange(1, 7) / 7)
    for k, one in enumerate(size):
        force[4 * RATE * k + 100 : 4 * RATE * k + 106] = 100 * one * pulse
    x = answer(force)
    found = response_estimates.blows(np.minimum(force, 75.0), x[:, None], RATE, block=3.8)
    made = response_estimates.struck(found, RATE)
    assert made.averages == 3
    assert sum("left out, the force is overloaded" in one for one in made.warnings) == 3
    same = response_estimates.blows(np.tile(force[: 4 * RATE], 6), np.tile(x[: 4 * RATE], 6)[:, None], RATE, block=3.8)
    assert response_estimates.struck(same, RATE).averages == 6


def test_a_record_without_a_hit_and_a_clipped_channel_are_refused() -> None:
    rng = np.random.default_rng(3)
    noise = rng.standard_normal(8 * RATE)
    with pytest.raises(BadInput, match="no blow"):
        response_estimates.blows(noise, noise[:, None], RATE)
    with pytest.raises(BadInput, match="silent"):
        response_estimates.shaken(0 * noise[:, None], noise[:, None], RATE)
    loud = np.clip(np.convolve(noise, np.ones(30), mode="same"), -4, 4)
    with pytest.raises(BadInput, match="clipped"):
        response_estimates.shaken(noise[:, None], loud[:, None], RATE)
    hard = np.clip(noise, -3.0, 3.0)  # a random force that its amplifier limits is there for a sample or two at a time
    with pytest.raises(BadInput, match="`force`: is clipped"):
        response_estimates.shaken(hard[:, None], noise[:, None], RATE)
    sine = np.sin(2 * np.pi * np.arange(8 * RATE) / 64)
    for sound in (np.round(noise * 100) / 100, np.tile(noise[:RATE], 8), sine, np.round(200 * sine + noise)):
        assert not response_estimates.clipped(sound)
    force, x = blows_of(0.01)
    for names, said in ((["tip-z"], "tip-z is overloaded"), ([], "a response is overloaded")):
        found = response_estimates.blows(force, np.minimum(x, 0.3 * x.max())[:, None], RATE, block=3.8, names=names)
        assert [one.fault for one in found] == [said] * 4


def test_a_blow_at_which_a_channel_is_silent_is_left_out() -> None:
    """A cable that is loose for one blow; it was a traceback."""
    force, x = blows_of(0.01)
    x = np.array(x)
    x[4 * RATE : 8 * RATE] = 0.0
    found = response_estimates.blows(force, x[:, None], RATE, block=3.8)
    assert [bool(one.fault) for one in found] == [False, True, False, False]


def test_records_in_files_become_functions_with_their_coherence(tmp_path: Path) -> None:
    rng = np.random.default_rng(4)
    force = rng.standard_normal(RATE * 40)
    x = answer(force)
    time = np.arange(len(force)) / RATE
    np.savetxt(
        tmp_path / "a.csv", np.column_stack([time, force, x]), delimiter=",", header="time,force,x", comments="", fmt="%.9g"
    )
    files.write(tmp_path / "a.h5", Signals(source="a", samples={"force": force, "x": x}, sampling_rate=RATE))
    made = []
    for name, more in (("a.csv", {}), ("a.h5", {"columns": {"response": "x"}})):
        table = described(file=name, drive="a", responses=["a"], quantity="displacement", records={"block": "4 s"}, **more)
        made.append(read(tmp_path, table))
    assert_allclose(made[0].values, made[1].values, rtol=1e-5)
    assert made[0].coherence is not None
    assert made[0].averages > 5
    near = np.abs(made[0].frequency - 30) < 5
    assert_allclose(made[0].values[0, near, 0], exact(made[0].frequency[near]), rtol=0.03)


@pytest.mark.parametrize("names", [["a:z", "b:z"], ["a_z", "b_z"], ["A-Z [m]", "B-Z [m]"]])
def test_channels_that_are_called_as_the_points_are_found_in_any_order(tmp_path: Path, names: list[str]) -> None:
    rng = np.random.default_rng(4)
    force = rng.standard_normal(RATE * 40)
    samples = {names[1]: answer(force, frequency=40.0), "force": force, names[0]: answer(force)}
    files.write(tmp_path / "a.h5", Signals(source="a", samples=samples, sampling_rate=RATE))
    columns = {"time": np.arange(len(force)) / RATE, **samples}
    np.savetxt(tmp_path / "a.csv", np.column_stack([*columns.values()]), delimiter=",", header=",".join(columns), comments="")
    of = functions()
    lines = {"frequency": F, names[1]: of["a", "b"], names[0]: of["a", "a"]}
    rows = {name: [one, one] if name == "frequency" else [one.real, one.imag] for name, one in lines.items()}
    header = ",".join(["frequency", *(f"{name} {part}" for name in (names[1], names[0]) for part in ("real", "imag"))])
    table = np.column_stack([F, *rows[names[1]], *rows[names[0]]])
    np.savetxt(tmp_path / "lines.csv", table, delimiter=",", header=header, comments="", fmt="%.17g")
    stated = described(drive="a", quantity="displacement")
    near = np.abs(np.arange(1, 401) * 0.25 - 30) < 5
    for file in ("a.h5", "a.csv"):
        found = read(tmp_path, {**stated, "file": file, "records": {"block": "4 s"}})
        assert_allclose(found.values[0, : len(near)][near, 0], exact(F[near]), rtol=0.03)
        assert_allclose(found.values[0, : len(near)][near, 1], exact(F[near], frequency=40.0), rtol=0.03)
    assert_allclose(read(tmp_path, {**stated, "file": "lines.csv"}).values[0, :, 1], of["a", "b"])


@pytest.mark.parametrize("ending", ["csv", "h5"])
def test_a_file_may_hold_several_forces_at_a_time(tmp_path: Path, ending: str) -> None:
    rng = np.random.default_rng(4)
    F1, F2 = rng.standard_normal((2, RATE * 40))
    samples = {"F1": F1, "x": answer(F1) + 3 * answer(F2, frequency=40.0), "F2": F2}
    files.write(tmp_path / "two.h5", Signals(source="two", samples=samples, sampling_rate=RATE))
    columns = {"time": np.arange(len(F1)) / RATE, **samples}
    np.savetxt(tmp_path / "two.csv", np.column_stack([*columns.values()]), delimiter=",", header=",".join(columns), comments="")
    stated = {"file": f"two.{ending}", "drive": ["a", "b"], "responses": ["c"], "quantity": "displacement"}
    names = {"force": ["F1", "F2"], "c": "x"}
    found = read(tmp_path, described(**stated, columns=names, records={"block": "4 s"}))
    assert [one.place for one in found.drives] == ["a", "b"]
    near = np.abs(found.frequency - 25) < 5
    for k, true in enumerate((exact(found.frequency[near]), 3 * exact(found.frequency[near], frequency=40.0))):
        assert_allclose(found.values[k, near, 0], true, rtol=0.05)
    with pytest.raises(BadInput, match="names 0 forces, and the drives are 2"):
        read(tmp_path, described(**stated, columns={"c": "x"}, records={"block": "4 s"}))
    with pytest.raises(BadInput, match="names 1 forces, and the drives are 2"):
        read(tmp_path, described(**stated, columns={"force": ["F1", "F1"], "c": "x"}, records={"block": "4 s"}))
    with pytest.raises(BadInput, match="several at a time are read from records of shakers"):
        read(tmp_path, described(**stated, columns=names, records={"kind": "hammer"}))


def test_a_channel_that_reads_nothing_of_the_force_is_left_out_and_said(tmp_path: Path) -> None:
    rng, (force, x) = np.random.default_rng(5), blows_of(0.01)
    noise = 1e-3 * x.std() * rng.standard_normal((2, len(x)))
    said = []
    for name, read_at, other in (("a", x, noise[0]), ("b", x, x + noise[1]), ("c", noise[1], noise[0])):
        samples = {"force": force, "a-z": read_at, "b-z": other}
        files.write(tmp_path / f"{name}.h5", Signals(source=name, samples=samples, sampling_rate=RATE))
        table = described(file=f"{name}.h5", drive="a", responses=["a", "b"], records={"kind": "hammer"})
        found = read(tmp_path, table)
        said.append([one for one in found.warnings if "the force" in one])
        assert [one.name for one in found.responses] == (["a-z"] if name == "a" else ["a-z", "b-z"])
        assert found.values.shape[2] == found.coherence.shape[2] == len(found.responses)
    assert len(said[0]) == 1
    assert "b-z is left out: it reads nothing of the force, its coherence is 0.2" in said[0][0]
    assert said[1] == []
    assert len(said[2]) == 1
    assert "no response follows the force" in said[2][0]


def test_a_channel_that_follows_the_force_at_resonances_or_within_the_band_alone_stays(tmp_path: Path) -> None:
    """Half of its lines over all that the file holds are noise: it was left out, with all that it reads of the modes."""
    rng, (force, x) = np.random.default_rng(5), blows_of(0.01)
    near = x + 0.5 * x.std() * rng.standard_normal(len(x))
    low = answer(force, frequency=20.0) + 0.5 * x.std() * rng.standard_normal(len(x))
    for name, other, band in (("near", near, [5.0, 400.0]), ("low", low, [5.0, 60.0])):
        files.write(
            tmp_path / f"{name}.h5", Signals(source=name, samples={"force": force, "a-z": x, "b-z": other}, sampling_rate=RATE)
        )
        table = described(file=f"{name}.h5", drive="a", responses=["a", "b"], records={"kind": "hammer"}, band=band)
        found = read(tmp_path, table)
        assert found.coherence is not None
        share = np.median(found.coherence[0, :, 1])
        assert share < 0.3, (name, share)
        assert [one.name for one in found.responses] == ["a-z", "b-z"], name
        assert not [one for one in found.warnings if "the force" in one]


@pytest.mark.parametrize(
    ("names", "words"), [("abc", "and of 2 other files still ring"), ("ab", "and of 1 other file still ring")]
)
def test_answers_that_ring_on_are_said_once_for_all_files(tmp_path: Path, names: str, words: str) -> None:
    force, x = blows_of(0.001, count=2)
    for name in names:
        files.write(tmp_path / f"{name}.h5", Signals(source=name, samples={"force": force, name: x}, sampling_rate=RATE))
    entries = [{"path": f"{name}.h5", "drive": name, "columns": {"response": name}} for name in names]
    found = read(tmp_path, described(files=entries, responses=["r"], records={"kind": "hammer", "block": "3.8 s"}))
    (said,) = (one for one in found.warnings if "ring" in one)
    assert words in said


# The real ones.


def test_the_frame_is_read_from_a_table_of_ten_lines(data: Path) -> None:
    folder = _folder(data, "three_storey_frame")
    named = {"Experimental.csv": "floor-1", "test_2.csv": "floor-2", "test_3.csv": "floor-3"}
    entries = [{"path": path, "drive": drive} for path, drive in named.items()]
    table = described(direction="x", responses=list(named.values()), files=entries, band=[3, 90])
    found = read(folder, table)
    assert found.values.shape == (3, len(found.frequency), 3)
    there = (found.frequency > 60) & (found.frequency < 90)
    # The mass line: that of the drive point of floor 1 is 5.05 kg, data/README.md
    assert 1 / np.mean(found.values[0, there, 0].real) == pytest.approx(5.05, rel=0.02)


def test_the_frame_with_weights_has_its_peaks_where_they_are_stated(data: Path) -> None:
    found = read(
        _folder(data, "shear_building_weights"), described(direction="x", file="FRF.csv", drive="a", responses=["a", "b", "c"])
    )
    level = np.abs(found.values[0]).sum(axis=1)
    for low, high, stated in ((10, 40, 21), (60, 100, 77), (120, 180, 145)):
        inside = np.flatnonzero((found.frequency > low) & (found.frequency < high))
        assert found.frequency[inside[np.argmax(level[inside])]] == pytest.approx(stated, abs=1.0)


def test_the_shear_building_is_read_from_records(data: Path) -> None:
    entries = [{"path": f"floor{k}.csv", "responses": [f"floor-{k}"]} for k in (1, 2, 3)]
    table = described(direction="x", drive="floor-1", files=entries, records={"block": "10 s"}, gain="unknown")
    found = read(_folder(data, "shear_building"), table)
    assert not found.scaled
    level = np.abs(found.values[0]).sum(axis=1)
    for low, high, stated in ((2, 5, 3.18), (7, 11, 9.09), (11, 16, 13.44)):
        inside = np.flatnonzero((found.frequency > low) & (found.frequency < high))
        assert found.frequency[inside[np.argmax(level[inside])]] == pytest.approx(stated, abs=0.15)


def _folder(data: Path, name: str) -> Path:
    if not (data / name).is_dir():
        pytest.skip(f"{data / name} is absent; data/README.md of the shared folder says where it comes from")
    return data / name


ONE = {"drive": "a", "responses": ["b"]}


def table_of(*head: str, separator: str = "\t", ends: str = "") -> str:
    """One function as real and imaginary part under the lines of `head`."""
    rows = [
        separator.join(map(repr, row)) + ends
        for row in zip(F.tolist(), functions()["a", "b"].real.tolist(), functions()["a", "b"].imag.tolist(), strict=True)
    ]
    return "\n".join([*head, *rows]) + "\n"


@pytest.mark.parametrize(
    ("header", "scale", "quantity"),
    [
        ("Frequency [Hz]\tReal [g/N]\tImag [g/N]", 9.80665, "acceleration"),
        ("f (Hz)\tReal (mm/s2/N)\tImag", 1e-3, "acceleration"),
        ("[ Hz ]\t[ mm/s/N ]\t[ mm/s/N ]", 1e-3, "velocity"),
        ("f\tReal (left)\tImag (left)", 1.0, "acceleration"),
    ],
)
def test_units_in_brackets_of_a_header_count(tmp_path: Path, header: str, scale: float, quantity: str) -> None:
    """They had been taken for part of a name, and the numbers for SI."""
    (tmp_path / "x.txt").write_text(table_of(header))
    found = read(tmp_path, described(file="x.txt", **ONE))
    assert_allclose(found.values[0, :, 0], scale * functions()["a", "b"])
    assert found.quantity == quantity
    if scale != 1:
        with pytest.raises(BadInput, match="`unit`: is 1 in SI, and the file says"):
            read(tmp_path, described(file="x.txt", unit="m/s^2/N", **ONE))


def test_a_header_of_another_unit_is_refused_by_name(tmp_path: Path) -> None:
    (tmp_path / "x.txt").write_text(table_of("f [Hz]\tReal [V]\tImag [V]"))
    with pytest.raises(BadInput, match=r"the function in Real \[V\] labels its numbers 'V'.* unit = \"g/N\""):
        read(tmp_path, described(file="x.txt", **ONE))
    (tmp_path / "x.txt").write_text(table_of("f [rpm]\tReal\tImag"))
    with pytest.raises(BadInput, match=r"`frequency`: is in 'rpm', where hz"):
        read(tmp_path, described(file="x.txt", **ONE))


@pytest.mark.parametrize(("unit", "scale"), [("kHz", 1e3), ("rad/s", 1 / (2 * np.pi))])
def test_an_axis_is_in_the_unit_of_its_header(tmp_path: Path, unit: str, scale: float) -> None:
    (tmp_path / "x.txt").write_text(table_of(f"f [{unit}]\tReal\tImag"))
    assert_allclose(read(tmp_path, described(file="x.txt", **ONE)).frequency, scale * F)


def test_records_in_text_are_in_the_units_of_their_header(tmp_path: Path) -> None:
    noise = np.random.default_rng(5).standard_normal(2000)
    written(
        tmp_path, "x.csv", [np.arange(2000.0).tolist(), noise.tolist(), noise.tolist()], header="Time (ms),Force (lbf),b:z [g]"
    )
    found = read(tmp_path, described(file="x.csv", records={"kind": "shaker", "block": 0.5}, **ONE))
    assert_allclose(found.frequency[-1], 500)
    assert_allclose(found.values[0, 5:-5, 0], 9.80665 / 4.4482216, rtol=1e-6)


def test_frequencies_and_damping_of_a_table_are_in_the_units_of_its_header(tmp_path: Path) -> None:
    (tmp_path / "m.csv").write_text("mode,f [kHz],damping (%)\n1,0.01,0.5\n2,0.02,0.8\n")
    columns = {"file": "m.csv", "frequency": "f [kHz]", "damping": "damping (%)"}
    found = test_file.read(tmp_path / "t.toml", {"kind": "modal-table", "article": "a", "frequencies": columns})
    assert isinstance(found, ModalTable)
    assert_allclose(found.frequency, [10, 20])
    assert found.damping_ratio is not None
    assert_allclose(found.damping_ratio, [0.005, 0.008])


@pytest.mark.parametrize("ends", ["", "\t"])
def test_lines_of_a_head_that_hold_a_number_are_no_rows(tmp_path: Path, ends: str) -> None:
    """As exports of vibrometers begin, and others end every row in a separator; the first such line had been the first row."""
    head = ["Source File Name:\tplate.svd", "Point Index:\t1", "Component:\tRoot", f"Frequency\tReal\tImag{ends}"]
    (tmp_path / "x.txt").write_text(table_of(*head, ends=ends))
    assert_allclose(read(tmp_path, described(file="x.txt", **ONE)).values[0, :, 0], functions()["a", "b"])
    (tmp_path / "x.txt").write_text(table_of(*head, "0.0\t1.0", ends=ends))  # a first row that is cut short is no head
    with pytest.raises(BadInput, match="the first row 2"):
        read(tmp_path, described(file="x.txt", **ONE))
