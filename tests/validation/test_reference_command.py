"""`massline reference` and `massline validate`: what is printed, what a program reads, and how they end."""

import csv
import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.inertia import Inertia
from validation.cli import main
from validation.cli.options import reading
from validation.output import inertia_json
from validation.reference.reference import file_name
from validation.reference.statement import inertia_of

Run = Callable[..., tuple[int, str, str]]


ROUGH = ("--chord", "1 mm")
"""For a mesh that is not what is looked at: with chords of 2 µm it takes most of the time."""

MOVING = "fmd.load_cell.moving_fraction=0.6"
BOLTS = "disc.cuboid_bolts.diameter_mm"
IN_PRINT = ("validate", "clumod-1-table2", "--against", "clumod-1", "--reference")
SETTINGS = {
    "fmd.load_cell.moving_fraction": "KEY=VALUE is expected",
    "=3": "KEY=VALUE is expected",
    "fmd.load_cell.moving_fraction=half": "a number is expected, found 'half'",
    "fmd.load_cell.height_mm=10 mm": "a number is expected, found '10 mm'",
    "fmd.load_cell.height_mm=nan": "no dimension has this size",
    "fmd.load_cell.height_mm=1e300": "no dimension has this size",
    "fmd.load_cel.height_mm=1": "Did you mean load_cell",
    "fdm.load_cell.height_mm=1": "Did you mean fmd",
    "cuboid.threads.depth_mm=1": "no article here has a part 'cuboid'",
    "fmd.load_cell.diameter_mm=-1": "no body has the dimensions",
    "fmd.load_cell.diameter_mm=1e-300": "no body has the dimensions",
}


def body(inertia: dict[str, Any]) -> Inertia:
    cog = np.array(inertia["cog_mm"]) * 1e-3
    return inertia_of([inertia["mass_kg"], *cog, *inertia["moi_cog_kgm2"], *inertia["poi_cog_kgm2"]])


def test_the_cuboid_is_its_block_less_its_threads(answer):
    mass = answer("reference", "cuboid")["articles"]["cuboid"]["routes"]["occ"]["mass_kg"]
    # Closed form: 160 x 70 x 400 mm and four holes of 6.8 mm, 20 mm deep, at 2700 kg/m³.
    assert_allclose(mass, 2700 * (0.16 * 0.07 * 0.4 - 4 * np.pi / 4 * 0.0068**2 * 0.02), rtol=1e-12)


def test_a_reference_does_not_begin_by_importing_effects_and_finite_elements():
    script = "import sys, validation.report.reference; print(*sorted(sys.modules))"
    imported = subprocess.run([sys.executable, "-P", "-c", script], capture_output=True, text=True, check=True).stdout.split()
    of_models = [one for one in imported if one.startswith(("fem", "validation.effects", "validation.prediction"))]
    assert "geometry.routes" in imported
    assert of_models == []


def test_the_users_frame_moves_and_turns_every_route_and_a_file_says_the_same_as_the_line(answer, tmp_path):
    own, theirs = (
        answer("reference", "cuboid", *more)["articles"]["cuboid"]["routes"]["occ"]
        for more in ((), ("--frame", "10 0 45 mm; z 90 deg"))
    )
    assert_allclose(theirs["cog_mm"], [0, 10, own["cog_mm"][2] - 45], rtol=0, atol=1e-9)  # rounding
    assert_allclose(theirs["moi_cog_kgm2"], np.array(own["moi_cog_kgm2"])[[1, 0, 2]], rtol=1e-12)  # rounding
    (tmp_path / "f.toml").write_text('[frame]\norigin = "10 0 45 mm"\nrotation = "z 90 deg"\n', encoding="utf-8")
    line, file = (answer("reference", "cuboid", "--frame", f) for f in ("10 0 45 mm; z 90 deg", "f.toml"))
    assert line["articles"]["cuboid"]["routes"] == file["articles"]["cuboid"]["routes"]


def test_out_holds_what_would_have_been_printed(run, tmp_path):
    printed = run("reference", "disc", "--format", "csv", *ROUGH)[1]
    code, out, _ = run("reference", "disc", "--format", "csv", "--out", "deep/table.csv", *ROUGH)
    assert (code, out) == (main.DONE, "")
    assert (tmp_path / "deep" / "table.csv").read_text(encoding="utf-8") == printed
    assert len(list(csv.reader(printed.splitlines()))) == 31


def test_routes_that_disagree_are_a_failed_check_after_everything_is_printed(run, monkeypatch):
    from geometry import routes

    right = routes.by_pinocchio
    monkeypatch.setattr(routes, "by_pinocchio", lambda article: right(article).scaled(1.01))
    code, out, err = run("reference", "cuboid", "--json")
    assert code == main.FAILED_CHECK
    assert json.loads(out)["articles"]["cuboid"]["agree"] is False
    assert "cuboid: occ and pinocchio disagree" in err or "cuboid: trimesh and pinocchio disagree" in err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("reference", "cubiod"), "Did you mean cuboid"),
        (("reference", "nothing.stl"), "no such file"),
        (("reference", "cuboid", "--chord", "2"), "--chord: a length needs its unit, found '2'. Write for example \"2 um\""),
        (("reference", "cuboid", "--chord", "-1 um"), "must be positive"),
        (("reference", "cuboid", "--chord", "1e-9 mm"), "must be from 0.1 um to 0.1 m, found 1e-9 mm"),
        (("reference", "cuboid", "--chord", "0.099 um"), "must be from 0.1 um to 0.1 m"),
        (("reference", "cuboid", "--chord", "101 mm"), "must be from 0.1 um to 0.1 m, found 101 mm"),
        (("reference", "cuboid", "--frame", "1 2 mm"), "three numbers"),
        *(
            (("reference", name, "--unit", "mm"), f"no built-in article is called {name!r}")
            for name in ("", "nofile", "clumod-5")
        ),
        (("validate", "clumod-1-table2", "--against", "clumod-9", "--unit", "mm"), "no built-in article is called 'clumod-9'"),
        (("reference", "cuboid", "--unit", "mm"), "a built-in article states its own"),
        (("reference", "cuboid", "disc", "--identified", "x.toml"), "one article, found 2"),
        (("reference", "cuboid", "--identified", "x.toml"), "x.toml"),
        (("validate", "x.toml", "--against", "cuboid"), "x.toml"),
        ((*IN_PRINT, "measured"), "Choose one of published, occ"),
        ((*IN_PRINT, "published", "--set", "clumod.mast.top_mm=1500"), "those of the unchanged article"),
        (("reference", "fmd", "--set", MOVING, "--set", MOVING), "set twice"),
        (("reference", "disc", "--set", "disc.fmd_bolts.count=-3"), "`count` of holes must lie between 0 and 200, found -3"),
        (("reference", "disc", "--set", "disc.fmd_bolts.count=10000"), "between 0 and 200, found 10000"),
        (("reference", "disc", "--set", f"{BOLTS}=200"), f"{BOLTS}=200: `voids` must take away less than there is"),
        *((("reference", "fmd", "--set", setting), words) for setting, words in SETTINGS.items()),
    ],
)
def test_bad_input_ends_with_2_and_a_remedy(refused, arguments, words):
    assert words in refused(*arguments)


def handed_back(run: Run, folder: Path, scale: float) -> tuple[int, dict[str, Any], str]:
    """The Cuboid's own inertia, from another point of view and scaled, against the Cuboid."""
    known = body(json.loads(run("reference", "cuboid", "--json")[1])["articles"]["cuboid"]["routes"]["occ"])
    (folder / "r.json").write_text(json.dumps(inertia_json(known.scaled(scale))), encoding="utf-8")
    code, out, err = run("validate", "r.json", "--against", "cuboid", "--json")
    return code, json.loads(out), err


@pytest.mark.parametrize(
    ("scale", "outside", "ends"), [(1.0, [], main.DONE), (1.1, ["Mass m", "MoI Θxx", "MoI Θyy", "MoI Θzz"], main.FAILED_CHECK)]
)
def test_a_right_result_is_within_in_every_row_and_a_wrong_one_names_its_rows(scale, outside, ends, run, tmp_path):
    code, value, err = handed_back(run, tmp_path, scale)
    assert (code, len(value["rows"])) == (ends, 10)
    assert [row["quantity"] for row in value["rows"] if not row["within"]] == outside
    assert err == "" if not outside else "Mass m (+10.00 %" in err


def test_the_papers_table_2_comes_out(run):
    code, out, err = run("validate", "clumod-1-table2", "--against", "clumod-1", "--reference", "published", "--json")
    rows = json.loads(out)["rows"]
    assert code == main.FAILED_CHECK
    assert set(rows[0]) >= {"quantity", "value", "tolerance", "unit", "reference", "deviation_percent", "within", "dominated_by"}
    percent = [row["deviation_percent"] for row in rows]
    assert_allclose(
        [percent[k] for k in (0, 4, 5, 6)], [2.94, 2.18, 15.50, -2.60], rtol=0, atol=0.01
    )  # one unit of the last digit
    assert_allclose([row["deviation"] for row in rows[1:4]], [0.39, -5.45, 13.01], rtol=0, atol=1e-9)  # rounding
    assert percent[1] is percent[2] is None
    assert "MoI Θyy (+15.50 %" in err


def test_the_users_own_mesh_is_an_article(run, tmp_path):
    import trimesh

    trimesh.creation.box(extents=(160, 70, 400)).export(tmp_path / "box.stl")
    code, out, err = run("reference", "box.stl", "--unit", "mm", "--material", "aluminium", "--json")
    assert code == main.DONE, err
    routes = json.loads(out)["articles"]["box.stl"]["routes"]
    assert list(routes) == ["trimesh"]
    assert_allclose(routes["trimesh"]["mass_kg"], 2700 * 0.16 * 0.07 * 0.4, rtol=1e-6)  # STL holds single precision


def test_a_warning_names_its_file_once_and_is_said_once(run, tmp_path):
    import trimesh

    apart = trimesh.creation.box(extents=(10, 10, 10)).apply_translation((50, 0, 0))
    trimesh.util.concatenate([trimesh.creation.box(extents=(10, 10, 10)), apart]).export(tmp_path / "two.stl")
    given = ("reference", "two.stl", "--unit", "mm", "--material", "steel")
    code, out, err = run(*given)
    assert code == main.DONE, err
    assert " ".join(out.split()).count("2 separate bodies") == 1
    assert "separate" not in err
    for more in (("--json",), ("--format", "csv"), ("--out", "table.txt")):
        err = run(*given, *more)[2]
        assert err.count("2 separate bodies") == 1
        assert err.split("2 separate")[0] == "massline: two.stl: "


def test_the_chord_error_of_the_users_step_follows_the_option_and_is_stated(answer, tmp_path):
    from cadquery import Assembly

    from geometry.articles import built_in
    from geometry.cad import solid

    disc = Assembly(name="disc")
    for part in built_in("disc").parts:
        disc.add(solid(part), name=part.name)
    disc.export(str(tmp_path / "disc.step"))
    given = ("reference", "disc.step", "--material", "steel")
    fine, own = (answer(*given, *more)["articles"]["disc.step"] for more in (("--chord", "10 um"), ()))
    assert fine["chord_m"] == pytest.approx(1e-5, rel=1e-12)
    assert "chord error of the mesh 10 µm" in fine["agreement"]
    assert_allclose(own["chord_m"], 1e-4 * np.sqrt(2 * 0.351**2 + 0.0145**2), rtol=1e-3)  # OCC's box has a small gap


def test_a_changed_dimension_reaches_every_route_and_is_said(answer):
    plain, changed = (answer("reference", "fmd", *more)["articles"]["fmd"] for more in ((), ("--set", MOVING)))
    # a tenth more of each of four steel cells of 80 x 10 mm moves
    more = 4 * 0.1 * 7850 * np.pi / 4 * 0.08**2 * 0.01
    for route in plain["routes"]:
        # 1e-4 kg is what the chords of 2 µm of all round faces may miss
        assert_allclose(changed["routes"][route]["mass_kg"] - plain["routes"][route]["mass_kg"], more, rtol=0, atol=1e-4)
    assert (plain["changes"], changed["changes"]) == ({}, {"fmd.load_cell.moving_fraction": 0.6})
    assert changed["footnotes"][0] == "Dimensions changed: fmd.load_cell.moving_fraction = 0.6."


def test_published_values_are_said_to_be_those_of_the_unchanged_article(run):
    longer = ("--set", "clumod.blade.lower-1.length_mm=1090")
    code, out, err = run("reference", "clumod-1", *longer, "--format", "markdown", *ROUGH)
    assert code == main.DONE, err
    said = "Dimensions changed: clumod.blade.lower-1.length_mm = 1090; published and measured values are those of the unchanged"
    assert said in out


def test_a_change_acts_where_its_part_is_and_says_where_it_does_nothing(run, refused):
    changes = ("--set", "disc.height_mm=20", "--set", "fmd.mounting_plate.size_mm=1")
    assert "only a number can be changed" in refused("reference", "disc", "fmd", "--json", *changes)
    code, out, _ = run(
        "reference", "cuboid", "disc", "--json", "--set", "disc.height_mm=20", "--set", "disc.fmd_bolts.circle_mm=320", *ROUGH
    )
    articles = json.loads(out)["articles"]
    assert code == main.DONE
    assert (articles["cuboid"]["changes"], articles["cuboid"]["footnotes"]) == ({}, [])
    assert "without effect on its inertia: disc.fmd_bolts.circle_mm." in articles["disc"]["footnotes"][0]


def test_a_drawing_that_cannot_be_fails_the_check_of_the_routes(run, tmp_path):
    """Threads so wide that they reach through the Cuboid's sides: the spatial algebra subtracts more than there is."""
    (tmp_path / "r.json").write_text(json.dumps(inertia_json(Inertia.from_cog(12.0, [0, 0, 0.2], np.eye(3)))), encoding="utf-8")
    for command in (("reference", "cuboid"), ("validate", "r.json", "--against", "cuboid")):
        code, _, err = run(*command, "--set", "cuboid.threads.diameter_mm=45")
        assert code == main.FAILED_CHECK
        assert "cuboid: occ and pinocchio disagree" in err or "cuboid: trimesh and pinocchio disagree" in err


def test_validate_holds_a_result_against_the_changed_article(run, answer, tmp_path):
    routes = answer("reference", "fmd", "--set", MOVING, *ROUGH)["articles"]["fmd"]["routes"]
    (tmp_path / "r.json").write_text(json.dumps(inertia_json(body(routes["occ"]))), encoding="utf-8")
    assert run("validate", "r.json", "--against", "fmd")[0] == main.FAILED_CHECK
    code, out, err = run("validate", "r.json", "--against", "fmd", "--set", MOVING)
    assert code == main.DONE, err
    assert "Dimensions changed: fmd.load_cell.moving_fraction = 0.6." in out
    assert answer("validate", "r.json", "--against", "fmd", "--set", MOVING)["changes"]


def test_view_writes_a_picture(run, tmp_path, renderer):
    code, _, err = run("reference", "cuboid", "--view", *ROUGH)
    assert code == main.DONE, err
    assert (tmp_path / "out" / "cuboid.png").stat().st_size > 10_000


@pytest.mark.parametrize("arguments", [("clumod-4", "--set", "clumod.blade.lower-1.z_mm=920"), ("fmd+fmd",)])
def test_bodies_that_run_through_one_another_fail_the_check(run, arguments):
    code, out, err = run("reference", *arguments, "--chord", "100 um")
    assert code == main.FAILED_CHECK
    assert "bodies overlap: " in err
    assert "Mass m [kg]" in out


def test_a_picture_stays_in_its_folder_whatever_its_article_is_called():
    assert file_name("../../../tmp/x/evil") == "tmp-x-evil"
    assert file_name("..") == "article"
    assert file_name("fmd+disc+cuboid") == "fmd+disc+cuboid"


@pytest.mark.parametrize(("text", "size"), [("0.1 um", 1e-7), ("100 mm", 0.1), ("2 um", 2e-6)])
def test_a_chord_error_between_the_bounds_is_taken_as_it_is(text, size):
    assert reading(text, None, None, ()).chord == pytest.approx(size, rel=1e-12)


def test_a_file_name_at_the_head_of_a_footnote_keeps_its_letters(run, tmp_path):
    faces = "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
    (tmp_path / "my.obj").write_text(f"v 0 0 0\nv 100 0 0\nv 0 100 0\nv 0 0 100\n{faces}", encoding="utf-8")
    said = {**inertia_json(Inertia.from_cog(12.0, [0, 0, 0.2], np.eye(3))), "article": "rig"}
    (tmp_path / "r.json").write_text(json.dumps(said), encoding="utf-8")
    out = run("validate", "r.json", "--against", "my.obj", "--unit", "mm", "--material", "steel")[1]
    assert "r.json: it says that it is about rig, held against my.obj" in out
    assert "R.json" not in out
    assert "A body can have these parameters" in out


def test_a_sound_solid_whose_mesh_is_no_skin_has_its_exact_table_and_ends_with_1(run, tmp_path):
    """A block with a bore of 40 mm that touches its outer wall along a line."""
    from cadquery import Workplane, exporters

    bore = Workplane().workplane(offset=-30).center(30, 0).circle(20).extrude(60)
    exporters.export(Workplane().box(100, 100, 100).cut(bore), str(tmp_path / "touch.step"))
    code, out, err = run("reference", "touch.step", "--material", "1000 kg/m^3", "--json")
    article = json.loads(out)["articles"]["touch.step"]
    assert (code, list(article["routes"])) == (main.FAILED_CHECK, ["occ"])
    assert_allclose(article["routes"]["occ"]["mass_kg"], 1e-6 * (100**3 - np.pi * 20**2 * 60), rtol=1e-9)  # closed form
    assert "no mesh route, since the mesh is no skin of a body: body" in err
    assert "in millimetres: 100 x 100 x 100 mm" in article["note"]


def test_a_broken_mesh_is_refused_mended_or_estimated_and_never_silently(run, refused, tmp_path):
    from trimesh import Trimesh, creation

    ball = creation.icosphere(subdivisions=3, radius=50.0)
    holes = {"small": np.arange(len(ball.faces)) > 0, "large": ball.triangles_center[:, 0] < 35}
    for name, kept in holes.items():
        Trimesh(ball.vertices, ball.faces[kept], process=False).export(tmp_path / f"{name}.stl")
    asked = ("--unit", "mm", "--material", "1000 kg/m^3")
    assert "add --repair" in refused("reference", "small.stl", *asked)
    code, out, _ = run("reference", "small.stl", *asked, "--repair")
    assert code == main.DONE
    assert "1 small hole closed" in out
    code, out, err = run("reference", "large.stl", *asked, "--repair", "--json")
    article = json.loads(out)["articles"]["large.stl"]
    assert (code, article["routes"]) == (main.FAILED_CHECK, {})
    assert "estimated from generalised winding numbers" in err
    found, within = (article["estimate"][key]["mass_kg"] if key else article["estimate"]["mass_kg"] for key in ("", "tolerance"))
    assert abs(found - ball.volume * 1e-6) <= within


def test_a_share_of_what_cannot_be_told_from_zero_is_no_per_cent():
    from validation.reference.statement import Row

    row = Row(quantity="CoG x", value=2e-4, tolerance=1e-3, unit="mm", reference=2e-5, reference_tolerance=1e-6)
    assert row.deviation_percent is None
    assert Row(quantity="Mass", value=2.0, tolerance=0.1, unit="kg", reference=1.0).deviation_percent == 100
