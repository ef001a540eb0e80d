"""`massline excite`: every route, what is printed, what a program reads, which files it writes, and how it ends."""

import csv
import json
import re
import sys
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.io import loadmat

from fem.base_excitation.response import Response
from geometry.articles import built_in
from geometry.routes import inertia
from identification.files import files
from identification.files.files import variable
from validation.cli import main
from validation.excite import runs

Run = Callable[..., tuple[int, str, str]]

FAST = ("--octaves-per-minute", "120", "--ring-down", "0.5 s")
"""A sweep of three octaves in two seconds, and a record that is cut: what is not about resonances need not wait for them."""


def said(run: Run, *arguments: str) -> dict[str, Any]:
    code, out, _ = run("excite", *arguments, "--json")
    assert code == main.DONE
    found: dict[str, Any] = json.loads(out)
    return found


def table_and_load(path: Path) -> tuple[np.ndarray, np.ndarray]:
    with np.load(path, allow_pickle=False) as stored:
        table = [stored[f"table-{axis}"] for axis in ("x", "y", "z", "alpha", "beta", "gamma")]
        load = [stored[f"load-{name}"] for name in ("fx", "fy", "fz", "mx", "my", "mz")]
    return np.array(table).T, np.array(load).T


@pytest.fixture(scope="module")
def written(tmp_path_factory) -> Path:
    """A folder with one run of ``fmd+clumod-1`` on its cells in every format."""
    folder = tmp_path_factory.mktemp("excite")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        heard: list[Response] = []
        patch.setattr(runs, "write", lambda path, response, label: heard.append(response))
        assert main.run(["excite", "fmd+clumod-1", "--cells", *FAST, "--rate", "256", "--out", "run.h5"]) == main.DONE
    for ending in ("h5", "csv", "npz", "mat", "uff"):
        runs.write(folder / f"run.{ending}", heard[0], "a run")
    return folder


def test_json_is_one_object_in_the_shape_of_the_contract_and_nothing_is_said_beside_it(run):
    code, out, err = run("excite", "clumod-1", "--axis", "beta", *FAST[:2], "--modes", "6", "--damping", "0.01", "--json")
    found = json.loads(out)
    assert (code, err) == (main.DONE, "")
    assert (found["article"], found["model"], found["route"], found["about"]) == ("clumod-1", "beam", "linear", "article")
    assert found["sampling_rate_hz"] == 1024
    assert found["rig"]["mass_kg"] == pytest.approx(inertia(built_in("clumod-1")).mass, rel=1e-9)
    (one,) = found["runs"]
    assert one["name"] == "beta"
    assert one["level"][0]["asked_rad_s2"] == 3.0
    assert one["level"][0]["realised_rad_s2"] == pytest.approx(3.0, rel=0.02)  # its own fast passage and the table's cross motion
    assert one["small_motion"]["within"]
    assert one["ring_down"]["sufficient"]
    assert set(one["peak_load"]) == {"fx_N", "fy_N", "fz_N", "mx_Nm", "my_Nm", "mz_Nm"}
    assert one["duration_s"] == pytest.approx(one["driven_s"] + one["ring_down"]["kept_s"])
    assert [p["load"] for p in one["resonances"]] == ["my"] * len(one["resonances"]) != []
    assert all(8 * p["amplification"] > 8 for p in one["resonances"])
    assert one["step_s"] == pytest.approx(1 / 8192)


@pytest.mark.parametrize("route", ["linear", "exudyn", "large"])
def test_a_stocky_article_weighs_what_its_geometry_says_on_every_route(route, run, tmp_path):
    """f = +M a about its origin, M from the drawing; the first mode of the disc lies two decades above the drive."""
    said(run, "disc", "--axis", "beta", "--route", route, "--band", "8", "16", *FAST, "--out", "run.npz")
    table, load = table_and_load(tmp_path / "run.npz")
    expected = table @ inertia(built_in("disc")).mass_matrix.T
    for kind in (slice(0, 3), slice(3, 6)):
        # exudyn's step is known to 3e-4 of a force; a table that turns by 2 mrad differs from one that does not by as much
        assert_allclose(load[:, kind], expected[:, kind], atol=4e-3 * np.abs(expected[:, kind]).max())


def test_exudyn_and_the_recursion_agree_on_a_flexible_article(run, tmp_path):
    loads = []
    for route in ("linear", "exudyn"):
        asked = ("--axis", "beta", "--band", "12", "24", "--modes", "8", *FAST)
        said(run, "clumod-1", *asked, "--route", route, "--out", f"{route}.npz")
        loads.append(table_and_load(tmp_path / f"{route}.npz")[1])
    for kind in (slice(0, 3), slice(3, 6)):
        assert_allclose(loads[1][:, kind], loads[0][:, kind], atol=2e-3 * np.abs(loads[0][:, kind]).max())


def test_the_route_that_a_rig_needs_is_chosen_and_said(run):
    found = said(run, "fmd", "--cells", "--preload", "1 kN", "--friction", "x=3", "--band", "8", "16", *FAST)
    assert (found["route"], found["rig"]["linear"]) == ("exudyn", False)
    assert found["route_why"] == "chosen because --preload and --friction are not linear"
    assert found["exudyn"] == version("exudyn")
    assert found["runs"][0]["settings"]
    (part,) = found["runs"][0]["loose_parts"]
    assert (part["axis"], part["slip_force_N"], part["mass_kg"]) == ("x", 3.0, 2.0)
    assert 0.1 < part["share_slipping"] < 1  # its 3 N are less than 2 kg times 2.5 m/s²
    assert found["about"] == "F"


def test_a_cell_lifts_off_at_its_preload_and_no_other_does(run):
    found = said(
        run, "fmd+cuboid", "--cells", "--preload", "3=5 N", "--axis", "beta", "--band", "8", "10", *FAST[:2], "--ring-down", "0 s"
    )
    cells = found["runs"][0]["cells"]
    assert [cell["preload_N"] for cell in cells] == [None, None, 5.0, None]
    assert [cell["share_lifted"] > 0 for cell in cells] == [False, False, True, False]
    assert cells[2]["z_lowest_N"] == pytest.approx(-5.0, rel=1e-9)


def test_every_format_holds_the_same_numbers_under_the_same_names(written):
    with h5py.File(written / "run.h5") as file:
        rate = file.attrs["sampling_rate"]
        signals = {name: np.array(data) for name, data in file["channels"].items()}
        assert file["channels/cell-1z"].attrs["unit"] == "N"
    assert rate == 256
    assert {"table-x", "cover-gamma", "load-fx", "load-mz", "cell-4z", "mast-top-x", "lower-1+-z"} <= set(signals)
    with np.load(written / "run.npz", allow_pickle=False) as stored:
        assert float(stored["sampling_rate"]) == rate
        for name, values in signals.items():
            assert_allclose(stored[name], values, rtol=0, atol=0)
    stored = loadmat(written / "run.mat")
    assert float(stored["fs"][0, 0]) == rate
    assert {name for name in stored if not name.startswith("__")} == {"fs", *map(variable, signals)}
    for name, values in signals.items():
        assert_allclose(stored[variable(name)][:, 0], values, rtol=0, atol=0)
    header, *rows = csv.reader((written / "run.csv").read_text(encoding="utf-8").splitlines())
    columns = dict(zip(header, np.array(rows, dtype=float).T, strict=True))
    assert header[0] == "time"
    assert_allclose(columns.pop("time"), np.arange(len(rows)) / rate, rtol=1e-15)
    assert set(columns) == set(signals)
    for name, values in signals.items():
        assert_allclose(columns[name], values, rtol=0, atol=0)


@pytest.mark.parametrize(("ending", "digits"), [("h5", 0.0), ("csv", 0.0), ("mat", 0.0), ("uff", 1e-12)])
def test_what_excite_writes_is_read_as_the_signal_file_of_a_campaign(written, ending, digits):
    found, first = files.read(written / f"run.{ending}"), files.read(written / "run.h5")
    assert found.sampling_rate == 256
    for name, values in first.samples.items():
        same = variable(name) if ending == "mat" else name
        assert_allclose(found.samples[same], values, rtol=digits, atol=digits * np.abs(values).max())


def test_the_cells_carry_what_the_table_exerts(written):
    """Forces of the cells add up to the load on everything, and turn about F as it does."""
    table, load = table_and_load(written / "run.npz")
    with np.load(written / "run.npz", allow_pickle=False) as stored:
        cells = np.array([[stored[f"cell-{k}{axis}"] for axis in "xyz"] for k in range(1, 5)]).transpose(2, 0, 1)
    places = np.array([[x, y, 0.0] for x, y in ((0.13, 0.13), (-0.13, 0.13), (-0.13, -0.13), (0.13, -0.13))])
    assert_allclose(cells.sum(axis=1), load[:, :3], atol=1e-6 * np.abs(load).max())
    assert_allclose(np.cross(places, cells).sum(axis=1), load[:, 3:], atol=1e-6 * np.abs(load).max())
    assert np.abs(table).max() > 2.4


def test_six_axes_make_six_runs_and_six_files(run, tmp_path):
    found = said(run, "disc", "--all", "--band", "8", "12", *FAST, "--rate", "128", "--out", "deep/run.npz")
    assert [one["name"] for one in found["runs"]] == ["x", "y", "z", "alpha", "beta", "gamma"]
    assert [level["axis"] for one in found["runs"] for level in one["level"]] == [one["name"] for one in found["runs"]]
    assert [one["files"] for one in found["runs"]] == [[f"deep/run-{one['name']}.npz"] for one in found["runs"]]
    assert all((tmp_path / file).is_file() for one in found["runs"] for file in one["files"])


@pytest.mark.parametrize(
    ("pattern", "runs", "levels"),
    [
        (["--pattern", "random", "--duration", "3 s"], ["x"], 1),
        (["--pattern", "burst"], ["x"], 1),
        (["--pattern", "multi"], ["multi"], 6),
        (["--pattern", "multi", "--axis", "z", "--axis", "gamma"], ["multi"], 2),
        (["--pattern", "multi", "--all"], [f"multi-{k}" for k in range(1, 7)], 6),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_other_patterns_drive_the_axes_they_say(pattern, runs, levels, run):
    found = said(run, "disc", *pattern, "--band", "8", "16", *FAST, "--rate", "128", "--level", "0.5", "--cross", "0")
    assert [one["name"] for one in found["runs"]] == runs
    assert [len(one["level"]) for one in found["runs"]] == [levels] * len(runs)
    for level in found["runs"][0]["level"]:
        asked, realised, _ = (value for key, value in level.items() if key != "axis")
        assert realised == pytest.approx(asked, rel=0.65)  # a burst swells; noise has a soft start and stop


def test_a_table_without_cross_motion_moves_along_one_axis_only(run, tmp_path):
    said(run, "disc", "--band", "8", "16", *FAST, "--cross", "0", "--out", "alone.npz")
    said(run, "disc", "--band", "8", "16", *FAST, "--seed", "1", "--out", "one.npz")
    said(run, "disc", "--band", "8", "16", *FAST, "--seed", "1", "--out", "same.npz")
    alone, one, same = (table_and_load(tmp_path / f"{name}.npz")[0] for name in ("alone", "one", "same"))
    assert np.abs(alone[:, 1:]).max() == 0
    assert np.abs(one[:, 1:]).max() > 0.01
    assert_allclose(one, same, rtol=0, atol=0)


def test_a_reader_is_told_what_was_driven_what_it_did_and_what_it_is_worth(run):
    code, out, err = run("excite", "fmd+clumod-1", "--cells", "--axis", "beta", *FAST)
    assert code == main.DONE
    for words in (
        "fmd+clumod-1: driven in time, linear route",
        "sine sweep 4-32 Hz, 120 oct/min, beta 3 rad/s²",
        "on the FMD's cover plate (18.04 kg, top 45 mm above F)",
        "springs of assumed stiffness",
        "CUT: 0.5 s of",
        "times rigid",
        "chosen because everything in the rig is linear",
        "none lifts off",
        "largest amplitude within the band",
        "the largest on another axis, of the level driven:",
    ):
        assert words in out
    assert "massline: beta: The record ends at" in err
    needed = re.search(r"CUT: 0.5 s of ([\d.]+) s needed", out)
    typed = re.search(r'Write --ring-down "([\d.]+) s", or leave it out', " ".join(err.split()))
    assert float(typed[1]) == pytest.approx(float(needed[1]), abs=0.11)  # both count from the end of the drive


def test_a_tester_is_told_what_a_preload_is_and_what_the_level_of_a_burst_compares(run):
    out = run("excite", "fmd+cuboid", "--cells", "--preload", "1 kN", "--band", "8", "16", *FAST)[1]
    assert "weight of the article included, which is not added to it" in " ".join(out.split())
    out = run("excite", "disc", "--pattern", "burst", "--band", "8", "16", *FAST[2:], "--rate", "128")[1]
    assert "root mean square over the whole swell, of the one asked for in its middle" in " ".join(out.split())


def test_a_user_s_own_model_is_driven_too(run, tmp_path):
    from fem.beam.articles import structure
    from fem.modes import fixed_base
    from fem.user_model.reading import write

    write(fixed_base(structure("clumod-1"), 12), tmp_path / "mine.npz")
    mine, ours = (said(run, name, "--modes", "12", "--axis", "beta", *FAST)["runs"][0] for name in ("mine.npz", "clumod-1"))
    # modal data carry the residual mass by further modes, a structure by static shapes: alike to (32 Hz / 55 Hz)^4 of R
    assert mine["peak_load"]["my_Nm"] == pytest.approx(ours["peak_load"]["my_Nm"], rel=0.01)


def test_of_a_user_s_own_matrices_the_modes_that_no_step_follows_answer_statically(run, tmp_path):
    from fem.beam.articles import structure
    from fem.user_model.reading import write

    write(structure("cuboid"), tmp_path / "mine.npz")
    mine, ours = (said(run, name, "--band", "8", "16", *FAST) for name in ("mine.npz", "cuboid"))
    assert mine["rig"]["modes_kept"] == ours["rig"]["modes_kept"] < 30
    # their damping differs, and is that of modes a decade above the drive
    assert mine["runs"][0]["peak_load"]["fx_N"] == pytest.approx(ours["runs"][0]["peak_load"]["fx_N"], rel=1e-4)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["clumod-1", "--axis", "gama"], "Did you mean gamma?"),
        (["clumod-1", "--axis", "x", "--axis", "x"], "--axis: x is named twice"),
        (["clumod-1", "--axis", "x", "--all"], "Give --all or --axis, not both"),
        (["clumod-1", "--pattern", "swept"], "Did you mean sweep?"),
        (["clumod-1", "--band", "32", "4"], "--band: a band goes from above 0 Hz up to a higher frequency, found 32 to 4 Hz"),
        (["clumod-1", "--band", "0", "4"], "found 0 to 4 Hz"),
        (["clumod-1", "--band", "4", "nan"], "--band"),
        (["clumod-1", "--band", "4", "600"], "--band: it drives up to 635.7 Hz, beyond the Nyquist frequency"),
        (["clumod-1", "--band", "4", "600"], "Record at --rate 1590 or more, or stop lower with --band"),
        (["clumod-1", "--band", "4", "60000"], "a record of 1024 Hz has. Stop lower with --band"),
        (["clumod-1", "--rate", "64"], "--rate: it drives up to 33.9 Hz, beyond the Nyquist frequency"),
        (["clumod-1", "--rate", "0"], "--rate"),
        (["clumod-1", "--rate", "1e9"], "--rate"),
        (["clumod-1", "--octaves-per-minute", "0"], "--octaves-per-minute: must lie between 0.01 and 1000, found 0"),
        (["clumod-1", "--octaves-per-minute", "0.1"], "a sweep of this band takes 1800 s"),
        (["clumod-1", "--octaves-per-minute", "900"], "--octaves-per-minute: at most 137.6 oct/min keep the level at 4 Hz"),
        (["clumod-1", "--level", "0"], "--level"),
        (["clumod-1", "--level", "-1"], "--level"),
        (["clumod-1", "--cross", "0.5"], "--cross: must lie between 0 and 0.25, found 0.5"),
        (["clumod-1", "--seed", "-1"], "--seed: must not be negative"),
        (
            ["clumod-1", "--ring-down", "5"],
            "--ring-down: a time needs its unit, found '5'. Write auto, or a time such as \"5 s\"",
        ),
        (["clumod-1", "--ring-down", "-5 s"], "--ring-down: must lie between 0 and 900 s, found -5 s"),
        (["clumod-1", "--duration", "5 s"], "only random and burst have one"),
        (["clumod-1", "--pattern", "random", "--duration", "0.1 s"], "--duration: must be at least 9 cycles of 4 Hz"),
        (["clumod-1", "--pattern", "burst", "--duration", "0.1 s"], "Drive longer, or start higher with --band"),
        (["clumod-1", "--route", "exodyn"], "Did you mean exudyn?"),
        (["clumod-1", "--route", "linear", "--friction", "x=5"], "and --friction is not linear"),
        (["clumod-1", "--route", "large", "--flange", "rotation=1e-6"], "without --flange"),
        (["clumod-1", "--route", "large", "--model", "beam"], "not the beam model"),
        (["clumod-1", "--route", "large", "--damping", "0.01"], "without --damping"),
        (["mine.step", "--route", "large"], "made of the dimensions of built-in articles"),
        (["clumod-1", "--modes", "0"], "--modes: must lie between 1 and 500, found 0"),
        (["cuboid", "--modes", "3", *FAST], "--modes: the step follows modes up to 1024 Hz, 2 of those, found 3 up to 1332 Hz"),
        (["cuboid", "--modes", "3", *FAST], "Write --modes 2, or leave it out: the others then answer statically, or record at"),
        (["cuboid", "--modes", "30", "--route", "exudyn", *FAST], "--modes: the step follows modes up to 1024 Hz, 2 of those"),
        (["clumod-1", "--flange", "rotation=1e-12", "--route", "exudyn", *FAST], "--flange: it makes exudyn's steps too short"),
        (
            ["clumod-1", "--flange", "rotation=1e-12", "--route", "exudyn", *FAST],
            "Make it softer, leave it out, or take --route linear",
        ),
        (["clumod-1", "--damping", "0", *FAST[:2]], "--ring-down: a driven mode has no damping"),
        (["clumod-1", "--cells"], "only the FMD has load cells, found clumod-1"),
        (["clumod-1", "--preload", "2 kN"], "Add --cells"),
        (["fmd+clumod-1", "--cells", "--preload", "-2 kN"], "must be positive, found -2 kN"),
        (["fmd+clumod-1", "--cells", "--preload", "2"], "--preload: a force needs its unit"),
        (["fmd+clumod-1", "--cells", "--preload", "5=2 kN"], "no cell is called '5'"),
        (["fmd+clumod-1", "--cells", "--preload", "2 kN", "--preload", "1=3 kN"], "cell 1 is given twice"),
        (["clumod-1", "--flange", "rotaton=1e-6"], "Did you mean rotation?"),
        (["clumod-1", "--flange", "rotation"], "KEY=VALUE is expected"),
        (["clumod-1", "--flange", "rotation=soft"], "rotation must be a number in SI units, found 'soft'"),
        (["clumod-1", "--flange", "rotation=-1e-6"], "rotation must be positive and finite"),
        (["fmd", "--flange", "rotation=1e-6"], "nothing above its cover plate"),
        (["clumod-1", "--friction", "z=5"], "no axis is called 'z'"),
        (["clumod-1", "--flange", "rotation=1e9"], "--flange: rotation must lie between 1e-12 and 0.01 rad/(N m), found 1e9"),
        (["clumod-1", "--flange", "lateral=1e-30"], "--flange: lateral must lie between 1e-13 and 0.001 m/N, found 1e-30"),
        (["clumod-1", "--cable", "mast-top=1e30"], "--cable: mast-top must lie between 0.001 and 1e+09 N/m, found 1e30"),
        (["clumod-1", "--damper", "mast-top=1e30"], "--damper: mast-top must lie between 0.001 and 1e+07 N s/m, found 1e30"),
        (["clumod-1", "--friction", "x=5,mass:1e6"], "--friction: mass must lie between 0.001 and 1000 kg, found 1e6"),
        (
            ["clumod-1", "--friction", "x=5,mass:900", *FAST],
            "--friction: it may be up to 329.5 kg, 10 times the article, found 900 kg",
        ),
        (["clumod-1", "--friction", "x=1e9"], "--friction: x must lie between 0.001 and 1e+06 N, found 1e9"),
        (["clumod-1", "--friction", "x=5,mas:2"], "Did you mean mass?"),
        (["clumod-1", "--friction", "x=5", "--friction", "x=6"], "x is given twice"),
        (["clumod-1", "--cable", "mast-tip=1000"], "clumod-1 has no place 'mast-tip'. Did you mean mast-top?"),
        (["clumod-1", "--cable", "mast-top:sideways=1"], "no direction is called 'sideways'"),
        (["clumod-1", "--damper", "mast-top=0"], "mast-top must be positive"),
        (["clumod-1", "--model", "exudyn", "--cable", "mast-top=1000"], "Use --model beam or solid"),
        (["clumod-1", "--out", "run.xls"], "a run is written as .uff, .unv, .h5, .hdf5, .csv, .mat, .npz, found .xls"),
        (["clumod-1", "--out", ""], "--out: no file is named"),
        (["clumod-1", "--out", "../nowhere/deep/run.h5"], "--out: ../nowhere/deep/run.h5 cannot be written"),
        (["clumod-1", "--out", "/dev/null/run.h5"], "--out: /dev/null/run.h5 cannot be written: Not a directory"),
        (["clumod-1", "--animate", "--pattern", "random"], "random passes no resonance"),
        (["clumod-1", "--animate", "--route", "large"], "the large route keeps no coordinates"),
        (["fmd", "--animate"], "a rigid article has no shape"),
        (["clumod-7"], "no built-in article is called 'clumod-7'"),
        (["clumod-1", "--model", "bem"], "Did you mean beam?"),
        (["clumod-1", "--set", "fmd.load_cell.moving_fraction=0.6"], "no article here has a part 'fmd'"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_bad_input_is_refused_in_words_before_anything_is_written(arguments, words, run, tmp_path):
    code, out, err = run("excite", *arguments)
    assert words in " ".join(err.split())
    assert (code, out) == (main.BAD_INPUT, "")
    assert list(tmp_path.iterdir()) == []


def test_a_terminal_sees_how_far_a_run_has_come_and_json_keeps_silent(run, monkeypatch, capsys):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    arguments = ("excite", "disc", "--band", "8", "16", "--axis", "x", "--axis", "y", *FAST, "--rate", "128", "--out", "run.npz")
    code, _, err = run(*arguments)
    assert code == main.DONE
    assert "x, linear (1 of 2)" in err
    assert "y: writing run-y.npz" in err
    assert run(*arguments, "--json")[2].count("massline: wrote") == 2
    assert "linear (" not in run(*arguments, "--json")[2]


def test_ctrl_c_in_the_middle_of_a_run_leaves_no_file(run, tmp_path, monkeypatch):
    from contextlib import contextmanager

    from validation.excite import runs

    @contextmanager
    def pressed(words, *, quiet=False):
        def halfway(share):
            if share > 0.3:
                raise KeyboardInterrupt

        yield halfway

    monkeypatch.setattr(runs, "share_done", pressed)
    for route in ("linear", "exudyn", "large"):
        code, out, _ = run("excite", "disc", "--band", "8", "16", "--route", route, *FAST, "--out", "run.h5")
        assert (code, out) == (130, "")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("level", "warned"), [("1", False), ("60", True)])
def test_a_table_that_turns_beyond_small_motion_is_warned_of(run, level, warned):
    code, out, err = run(
        "excite", "cuboid", "--axis", "beta", "--octaves-per-minute", "60", "--ring-down", "0 s", "--level", level, "--json"
    )
    assert code == main.DONE
    (one,) = json.loads(out)["runs"]
    assert one["small_motion"]["within"] is not warned
    assert any("--route large" in warning for warning in one["warnings"]) is warned
    assert ("beyond the limit" in err) is warned
