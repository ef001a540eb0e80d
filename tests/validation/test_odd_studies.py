"""Odd but sound studies: each was refused with wrong words, or ended in a traceback. No code of ours knows the chain."""

import re
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from identification import test_file
from validation.effects.catalogue import Named
from validation.model.model import Added
from validation.study import Study

LINES = np.arange(3.0, 40.0, 0.1)
FLOORS = 'responses = ["floor-1:x", "floor-2:x", "floor-3:x"]\n'
ONE, THREE = 'file = "one.csv"\ndrive = "floor-1:x"\n' + FLOORS, 'file = "three.csv"\ndrive = "floor-3:x"\n' + FLOORS
SPRING = 4 * 12 * 70e9 * (0.025 * 0.003**3 / 12) / 0.15**3
CHAIN = SPRING * np.array([[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
SQUARES, SHAPES = np.linalg.eigh(CHAIN / 5.0)
HERTZ = (np.sqrt(SQUARES) / (2 * np.pi)).round(4).tolist()
TABLE = f"frequencies = {HERTZ}\n"


def functions(drive: int, seed: int) -> np.ndarray:
    """(n, 3) accelerances with noise of half a per cent."""
    rng = np.random.default_rng(seed)
    H = np.array([-(w**2) * np.linalg.inv(CHAIN * (1 + 0.02j) - 5.0 * w**2 * np.eye(3))[:, drive] for w in 2 * np.pi * LINES])
    return H * (1 + 0.005 * (rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape)) / np.sqrt(2))


def write(path: Path, H: np.ndarray, first: int = 0, code: str = "utf-8") -> None:
    rows = np.column_stack([LINES, np.ascontiguousarray(H).view(float)])[first:]
    text = "frequency," + ",".join(f"r{k},i{k}" for k in (1, 2, 3)) + "\n"
    path.write_text(text + "\n".join(",".join(f"{x:.9g}" for x in row) for row in rows) + "\n", encoding=code)


@pytest.fixture
def study(tmp_path: Path, three_floors: Callable[..., str]) -> Callable[..., str]:
    """Writes a study of these tests, beside the functions of two drives."""
    write(tmp_path / "one.csv", functions(0, 1))
    write(tmp_path / "three.csv", functions(2, 2))

    def written(*tests: str) -> str:
        bodies = (f'[[test]]\nkind = "{"modal-table" if "frequencies" in one else "response-functions"}"\n{one}' for one in tests)
        (tmp_path / "lab.toml").write_text(three_floors() + "\n".join(bodies), encoding="utf-8")
        return "lab.toml"

    return written


def says_that_it_is_sound(found: dict) -> bool:
    return found["plain_error_percent"] < 0.5 and found["tolerance_z2"] < 5 and all(one["sigma"] < 5 for one in found["worst"])


@pytest.mark.parametrize(
    "tests",
    [
        (f'title = "a"\ngain = 0.02\n{ONE}', f'title = "b"\ngain = 0.05\n{THREE}'),
        (f'title = "a"\n{ONE}', f'title = "b"\nforce_gain = 0.05\n{THREE}'),
        (f'title = "a"\ngain = 0\n{ONE}', f'title = "b"\n{THREE}'),
        (f'title = "a"\n{ONE}', f'title = "b"\ngain = 0.1\nsensors = ["floor-1:x", "floor-3:x"]\n{TABLE}shapes = '
         f"{SHAPES[[0, 2]].T.round(4).tolist()}\n"),
        (ONE, THREE),  # no titles
    ],
)  # fmt: skip
def test_tests_of_one_study_need_no_title_and_may_state_a_sensors_gain_each(study, answer, tests):
    assert says_that_it_is_sound(answer("compare", study(*tests)))


def test_the_smaller_of_two_tolerances_of_one_sensor_holds(study, answer):
    tests = (f'title = "a"\ngain = 0.02\n{ONE}', f'title = "b"\ngain = 0.0002\n{THREE}')
    for order in (tests, tests[::-1]):
        fitted = answer("compare", study(*order))["parameters"]["fitted"]
        assert fitted["accelerometer-gain:floor-2-x"]["sd"] < 2.1e-4


def test_a_gain_that_one_test_knows_and_another_does_not_is_refused_in_words(study, refused):
    text = refused("compare", study(f'title = "a"\ngain = "each unknown"\n{ONE}', f'title = "b"\n{THREE}'))
    assert re.search(r"floor-\d-x.*unknown in a, known in b", re.sub(r"\s+", " ", text))
    assert "name the sensor apart" in re.sub(r"\s+", " ", text)


@pytest.mark.parametrize(
    ("sensors", "shapes"),
    [
        (["floor-3:x"], [[1], [1], [1]]),  # a mode is seen by one sensor alone
        (["floor-1:x", "floor-2:y"], [[1, 0.01], [1, 0.02], [1, 0.01]]),  # the other does not move in the model
    ],
)
def test_a_mode_that_one_sensor_sees_alone_fails_no_comparison(study, answer, sensors, shapes):
    found = answer("compare", study(f"sensors = {sensors}\n{TABLE}shapes = {shapes}\n".replace("'", '"')))
    assert says_that_it_is_sound(found)
    assert len(sensors) > 1 or any("floor-3-x alone say nothing" in text for text in found["warnings"])


def test_functions_that_begin_at_different_lines_are_cut_to_those_that_all_have(study, answer, tmp_path):
    write(tmp_path / "late.csv", functions(2, 2), first=50)
    files = '[{ path = "one.csv", drive = "floor-1:x" }, { path = "late.csv", drive = "floor-3:x" }]'
    found = answer("compare", study(f"files = {files}\n{FLOORS}"))
    assert says_that_it_is_sound(found)
    assert found["maps"][0]["frequency_band_hz"][0] == pytest.approx(8.0)
    assert any("50 lines below" in text for text in found["warnings"])


def test_a_mobility_where_it_is_driven_is_not_taken_for_magnitude_and_phase(study, answer, tmp_path):
    write(tmp_path / "one.csv", 1e3 * functions(0, 1) / (2j * np.pi * LINES[:, None]))
    assert says_that_it_is_sound(answer("compare", study(f'unit = "mm/s/N"\n{ONE}')))


def test_force_over_response_is_told_by_its_resonances_and_read_when_said(study, answer, refused, tmp_path):
    """It went through every fit for minutes."""
    write(tmp_path / "one.csv", 1 / functions(0, 1))
    assert "force over response" in refused("compare", study(ONE))
    assert says_that_it_is_sound(answer("compare", study(f"inverted = true\n{ONE}")))


def test_text_of_a_spreadsheet_in_utf_16_is_read(study, answer, tmp_path):
    write(tmp_path / "one.csv", functions(0, 1), code="utf-16")
    assert says_that_it_is_sound(answer("compare", study(ONE)))


@pytest.mark.filterwarnings("error")
def test_a_sensor_across_the_motion_of_the_model_is_compared(study, answer, run):
    path = study(ONE.replace("floor-2:x", "floor-2:y"))
    assert "floor-2-y" in answer("compare", path)["worst"][0]["text"]
    assert re.search(r"floor-1-x/floor-2-y +0.000 +–", run("compare", path)[1])  # and no level of -2964 dB


@pytest.mark.parametrize(
    ("test", "words"),
    [
        (f"frequencies = {[*HERTZ, 55.0]}\n", "the model has 3 modes, and the table 4"),
        (f"{TABLE}damping = [1.0, 1.0, 1.0]\n", "must be a share below 1, found 1 of mode 1"),
        (f'{TABLE}shapes = {{ file = "empty.csv", sensor = "at", modes = "mode{{}}" }}\n', "cell 3 of 4 is empty"),
        (f"{TABLE}leave_out = [2]\n", "no mode of lab lies within 10 to 20 Hz"),
    ],
)
def test_what_is_wrong_is_said_of_what_is_wrong(study, refused, tmp_path, test, words):
    (tmp_path / "empty.csv").write_text("at,mode1,mode2,mode3\nfloor-1:x,0.3,,0.6\nfloor-2:x,0.6,0.3,-0.7\n", encoding="utf-8")
    band = ("--band", "10", "20") if "leave_out" in test else ()
    assert words in re.sub(r"\s+", " ", refused("compare", study(test), *band))


def test_deviations_of_some_modes_are_kept_beside_usual_ones():
    stated = {"kind": "modal-table", "article": "frame", "frequencies": ["4.0 +/- 0.01 Hz", 8.0, "12 Hz"]}
    table = test_file.read("lab.toml", stated)
    assert_allclose(table.frequency_deviation, [0.01, 0.04, 0.06])  # half a per cent where nothing is said
    assert "frequency_deviation of some modes" in table.warnings[0]


def test_a_band_is_that_of_tests_of_structures_too(study, answer):
    (one,) = answer("compare", study(ONE), "--band", "10", "20")["maps"]
    assert one["frequency_band_hz"] == pytest.approx([10.0, 20.0])
    (one,) = answer("compare", study(TABLE), "--band", "15", "40")["maps"]
    assert one["runs"] == ["mode 2", "mode 3"]


def test_a_study_of_modes_that_are_typed_is_written(study, run, tmp_path, three_floors):
    (tmp_path / "frame.toml").write_text(three_floors(), encoding="utf-8")
    shapes = SHAPES.T.round(4).tolist()
    text = f'format = 1\nkind = "modal-table"\narticle = "frame"\nsensors = ["floor-1:x", "floor-2:x", "floor-3:x"]\n{TABLE}'
    (tmp_path / "table.toml").write_text(f"{text}shapes = {shapes}\n", encoding="utf-8")
    code, _, err = run("model", "frame.toml", "--test", "table.toml", "--out", "study.toml")
    assert code == 0, err
    assert run("compare", "study.toml")[0] == 0


@pytest.mark.parametrize(
    ("stated", "where"),
    [
        pytest.param('[tolerances]\nclass = "calibrated"\n', "", marks=pytest.mark.proof),
        ("", "gain = 0.005\nforce_gain = 0.005\n"),
    ],
)
def test_a_pick_up_that_reads_eight_per_cent_too_much_is_named_by_whoever_has_his_calibrated(
    study, answer, tmp_path, stated, where
):
    """The gain was taken for known to 2 % whatever the class, and where the drives are read it was the scatter of the readings:
    "nothing is missing"."""
    for name, drive in (("one", 0), ("three", 2)):
        write(tmp_path / f"{name}.csv", functions(drive, drive + 1) * [1.0, 1.0, 1.08])
    files = 'files = [{ path = "one.csv", drive = "floor-1:x" }, { path = "three.csv", drive = "floor-3:x" }]\n'
    path = study(f"{where}{files}{FLOORS}")
    text = (tmp_path / path).read_text(encoding="utf-8")
    (tmp_path / path).write_text(text.replace("[fe_model]", f"{stated}[fe_model]", 1), encoding="utf-8")
    (found,) = answer("diagnose", path)["accepted"]
    assert found["id"] == "accelerometer-gain:floor-3-x"
    assert found["value"] == pytest.approx(0.08, abs=0.01)


STRIP = """BEGIN BULK
MAT1,1,210000.,,.3,7.85-9
PSHELL,1,1,5.,1,,1
{nodes}
{sheets}
SPC1,1,123456,1,2
ENDDATA
"""
"""Of steel, 320 by 40 mm, clamped at one end."""


def test_coordinates_that_two_articles_have_are_said_to_be_of_both_and_how_one_is_meant(run, tmp_path: Path) -> None:
    """A mass that was hung onto one of them would count for the other, too, without a word."""
    nodes = [f"GRID,{1 + j + 2 * i},,{40.0 * i},{40.0 * j},0." for i in range(9) for j in range(2)]
    sheets = [f"CQUAD4,{k},1,{2 * k - 1},{2 * k + 1},{2 * k + 2},{2 * k}" for k in range(1, 9)]
    (tmp_path / "strip.bdf").write_text(STRIP.format(nodes="\n".join(nodes), sheets="\n".join(sheets)))
    own = ""
    for name in "ab":
        assert run("model", "strip.bdf", "--out", f"{name}.toml")[0] == 0
        described = tmp_path / f"{name}.toml"
        described.write_text(f'{described.read_text()}\n[fe_model.places]\ntip-{name} = ["0.32 m", "0 m", "0 m"]\n')
        own += f'{name} = "{name}.toml"\n'
        test = f'format = 1\nkind = "modal-table"\ntitle = "of {name}"\narticle = "{name}"\nfrequencies = [41.5, 260.0]\n'
        (tmp_path / f"test-{name}.toml").write_text(test)
    both = f'format = 1\n[model]\narticle = "a"\n[structure]\nkind = "own"\n[structure.own]\n{own}'
    for place, told in (("@0.24,0.03,0", True), ("tip-b", False)):
        mass = f'[[effect]]\nid = "point-mass:{place}"\nvalue = 0.05\n'
        (tmp_path / "both.toml").write_text(both + mass)
        said = " ".join(run("compare", "both.toml", "test-a.toml", "test-b.toml")[1].split())
        assert ("which acts on a and b: to mean one, give the point a name" in said) == told, said


def test_base_tests_of_two_articles_are_asked_for_the_coordinates_of_both_as_well() -> None:
    """Of campaigns nothing was said, since they are no tests by name."""
    place = "@0.24,0.03,0"

    def of(article: str) -> SimpleNamespace:
        structure = SimpleNamespace(nominal=SimpleNamespace(places={place: None}))
        return SimpleNamespace(measured=SimpleNamespace(configuration=article), structure=structure)

    effect = Added(named=Named(family="point-mass", targets=(place,), values={"": 0.05}))
    (said,) = Study.on_several(SimpleNamespace(made=[of("a")], tests=[of("b")]), [effect])  # type: ignore[arg-type]
    assert "which acts on a and b" in said


def test_frequencies_in_radians_a_second_are_told(study, refused, answer):
    """Each was paired with the mode that lay nearest, without a word."""
    said = refused("compare", study(f"frequencies = {[round(6.2832 * one, 3) for one in HERTZ]}\n"))
    assert "they look like rad/s. Write them in hertz" in said
    assert "rad/s" not in " ".join(answer("compare", study(TABLE))["warnings"])


MISSPELT = f'sensors = ["Floor-2:x", "floor-1:x"]\n{TABLE}shapes = [[1, 0.5], [1, 2], [1, -2]]\n'


@pytest.mark.parametrize("test", [ONE.replace("floor-2:x", "Floor-2:x"), MISSPELT])
def test_a_place_that_is_misspelt_is_said_with_the_nearest(study, refused, test):
    assert "frame has no such place. Did you mean floor-2? Its places are" in refused("compare", study(test))


def test_modes_from_the_highest_down_are_a_table_from_the_lowest_up(run, tmp_path):
    (tmp_path / "modes.toml").write_text('format = 1\nkind = "modal-table"\narticle = "frame"\nfrequencies = [13.5, 3.4]\n')
    assert re.search(r"modes +2 +3.4 +13.5", run("check", "modes.toml")[1])


BENT = """\
format = 1
model = { title = "", article = "bent" }
[fe_model]
kind = "frame"
nodes = { a = ["0 mm", "0 mm", "0 mm"], b = ["400 mm", "0 mm", "0 mm"], c = ["400 mm", "300 mm", "0 mm"] }
members = { long = ["a", "b"], short = ["b", "c"] }
section = { width = "20 mm", thickness = "10 mm", across = "z" }
material = "steel"
elements = 4
loss_factor = 0.01
[[test]]
kind = "modal-table"
frequencies = [95.0, 170.0, 330.0]
"""


def test_rigid_motions_of_a_free_structure_are_none_of_its_modes(run, answer, tmp_path):
    """They were "first long mode" with a damping of -1e17 %, and what came behind them was the seventh."""
    (tmp_path / "bent.toml").write_text(BENT)
    modes = answer("compare", "bent.toml")["maps"][0]["modes"]
    assert [one["name"] for one in modes[:6]] == 6 * ["rigid motion"]
    assert [one["damping_ratio"] for one in modes[:6]] == 6 * [0]
    assert modes[6]["name"] in ("first long mode", "first short mode")
    assert modes[6]["damping_ratio"] == pytest.approx(0.005, rel=0.2)
    assert run("report", "bent.toml", "--no-diagnosis", "--out", "bent.html")[0] == 0
    page = (tmp_path / "bent.html").read_text()
    assert "rigid motion" not in page[page.index("Modes of bent") :]


def test_what_is_looked_for_at_coordinates_is_looked_for_there_or_said_to_lie_outside(refused, answer, tmp_path):
    """Both were "no effect that could act on these data"; of a place that has no name as well."""
    (tmp_path / "bent.toml").write_text(BENT)
    said = refused("diagnose", "bent.toml", "--candidate", "point-mass:@0.4,0.9,0")
    assert "`@0.4,0.9,0`: lies 600 mm outside the mesh; the nearest point is (400, 300, 0) mm" in said
    said = refused("diagnose", "bent.toml", "--candidate", "point-mass:d")
    assert "There are point-mass:a, point-mass:b, point-mass:c." in said
    found = answer("diagnose", "bent.toml", "--candidate", "point-mass:@0.2,0,0")
    assert found["settings"]["only"] == ["point-mass:@0.2,0,0"]
