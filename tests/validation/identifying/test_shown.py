"""The page, the JSON and the pictures of an identification, and that `massline validate` reads what was printed."""

import json
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.frames import Pose, rotation_about
from validation.identify.identify import IdentificationFindings, reported
from validation.output import to_json
from validation.reference.statement import QUANTITIES
from validation.report import identify
from validation.report.identify import IdentificationPictures


def _page(found: IdentificationFindings, width: int = 132) -> str:
    return identify.IdentificationPage(found=found).document().text(width)


def test_the_page_shows_both_ways_side_by_side_and_what_moved(found):
    mass = next(line for line in _page(found).splitlines() if line.lstrip().startswith("Mass m"))
    plain, better = (one.values[0] for one in found.results)
    assert f"{plain:.2f}" in mass
    assert f"{better:.2f}" in mass
    assert "-0.99 %" in mass  # 1 / 1.01


@pytest.mark.parametrize(
    "words",
    [
        "beta 3.1 % 1.2 % 45 %",
        "trustworthy",
        "dominated by elasticity",
        "left out: 12.1 to 12.5 Hz: condition number 180 exceeds 100.",
        "check: it looks as if fmd-z1 has the wrong sign.",
        "Closed checks that hold: symmetry.",
        "Without mass_kg of scale.toml the interval of m would be 4 times as wide.",
        "warning: the Cuboid's drawing is taken as it is.",
        "tare fmd+disc+cuboid",
        "sum z² of 40 tolerances 31",
        "from the article's own origin",
    ],
)
def test_the_page_says(words, found):
    assert words in " ".join(_page(found, 200).split())


def test_page_and_json_say_how_the_block_bootstrap_agrees(found):
    assert "Block bootstrap" not in _page(found)
    assert to_json(found)["self_calibrated"]["bootstrap_over_parametric_sd"] is None
    one = found.result
    again = replace(one.identified, resampled=1.3**2 * one.identified.covariance)
    with_it = replace(found, results=(found.results[0], reported(again, Pose())))
    assert "standard deviations 1.30 to 1.30 times those of the intervals" in " ".join(_page(with_it).split())
    assert to_json(with_it)["self_calibrated"]["bootstrap_over_parametric_sd"]["mass_kg"] == pytest.approx(1.3)


def test_crosses_compare_with_the_interval_of_the_difference(found):
    assert found.study is not None
    what = "no elastic terms"
    alone = IdentificationPictures(found=found).band_map(found.study, what, 0).half_width
    wide = replace(found.study, half_widths={what: np.full((3, 3, 10), 3.0)})
    both = IdentificationPictures(found=found).band_map(wide, what, 0).half_width
    scale = 100 / found.result.values[0]
    assert_allclose(both, np.hypot(alone, 3.0 * scale), rtol=1e-12)
    assert_allclose(alone, scale * found.result.half_width[0], rtol=1e-12)


def test_where_the_better_way_failed_the_plain_result_is_shown(found):
    plain, better = found.results
    failed = replace(found, results=(plain, replace(better, identified=replace(better.identified, converged=False))))
    assert failed.result is plain
    assert to_json(failed)["result"] == "plain"
    assert_allclose(to_json(failed)["inertia"]["mass_kg"], plain.values[0])
    assert "verdict on the plain result" in " ".join(_page(failed).split())


def test_elastic_terms_are_listed_by_frequency_no_figure_is_cut_and_without_a_tare_the_fmd_is_said_to_be_in_it(found):
    grid = next(one for one in identify.IdentificationPage(found=found).document().grids() if one.header[0].startswith("elastic"))
    shown = [float(line[0]) for line in grid.lines]
    assert shown == sorted(shown)
    assert len(shown) == 3
    narrow = _page(found, 80)
    for quantity, value in zip(QUANTITIES, found.result.values, strict=True):
        assert any(quantity.label in line for line in narrow.splitlines()), quantity.label
        assert np.isfinite(value)
    assert max(map(len, narrow.splitlines())) <= 80
    bare = replace(found, request=replace(found.request, tares=()), origin="F")
    text = " ".join(_page(bare).split())
    assert "no tare, so the FMD's moving part is in the result" in text
    assert "CoG from F, the centre of the force-measuring plane" in text


def test_validate_takes_the_interval_for_the_tolerance_and_reads_a_frame_of_the_users_own(result_file, run, found):
    code, out, _ = run("validate", str(result_file()), "--against", "clumod-1", "--json")
    rows = json.loads(out)["rows"]
    assert code == 0
    assert_allclose([row["tolerance"] for row in rows], found.result.half_width * [q.per_si for q in QUANTITIES], rtol=1e-9)
    frame = Pose(position=np.array([0.05, 0.0, 0.3]), rotation=rotation_about("z", 0.4) @ rotation_about("x", 0.2))
    seen = tuple(reported(one.identified, Pose(position=np.array([0.0, 0.0, 0.045])) @ frame) for one in found.results)
    path = result_file(results=seen, frame=frame)
    assert abs(json.loads(path.read_text())["inertia"]["cog_mm"][0]) > 40
    assert run("validate", str(path), "--against", "clumod-1")[0] == 0
    wrong = result_file(results=seen, frame=None)
    assert run("validate", str(wrong), "--against", "clumod-1")[0] == 1


def test_every_picture_is_drawn_and_those_without_evidence_are_left_out(found, tmp_path, monkeypatch):
    from PIL import Image

    def of_36_panels(title, curves, path, note):  # which `massline dynamic-mass` draws in a test of its own
        assert [len(one.mass.frequency) for one in curves] == [141, 138, identify.FINE, 3]  # three lines are left out
        Image.linear_gradient("L").resize((500, 500)).save(path)

    monkeypatch.setattr(identify, "full", of_36_panels)
    paths = IdentificationPictures(found=found).draw(tmp_path)
    names = [path.stem.removeprefix("identify-clumod-1-") for path in paths]
    assert names == ["lines", "dynamic-mass", "dynamic-mass-6x6", "residuals", "stability", "stability-rigid", "shares"]
    for path in paths:
        with Image.open(path) as picture:
            assert min(picture.size) > 450
            assert len(picture.convert("RGB").reduce(4).getcolors(1 << 24) or ()) > 50, path.name
    bare = replace(found, lines=None, residuals=None, study=None, spectra=None, dynamic_mass=None)
    assert [path.name for path in IdentificationPictures(found=bare).draw(tmp_path)] == ["identify-clumod-1-shares.png"]
