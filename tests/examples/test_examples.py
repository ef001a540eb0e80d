"""The examples run, and what they print and draw is what they promise."""

import io
import json
import re
import runpy
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from rich.console import Console

from geometry.articles import built_in
from tools.pages import said_about


def test_the_quickstart_prints_three_routes_that_agree_and_the_tare(root: Path) -> None:
    printed = io.StringIO()
    runpy.run_path(str(root / "examples" / "quickstart.py"))["main"](Console(file=printed, width=160))
    text = printed.getvalue()
    for route in ("occ", "trimesh", "pinocchio"):
        assert re.search(rf"{route}\s.*4\d\.\d{{4}}", text)
    assert "agree: " in text
    assert "disagree" not in text
    assert len(re.findall(r"\b22\.9\d{3}\b", text)) >= 3
    assert "satisfy the triangle inequality" in text


@pytest.mark.proof  # the script; validation/test_pictures.py holds what it draws with
@pytest.mark.usefixtures("renderer")
def test_the_pictures_are_drawn_and_put_on_one_sheet_that_fits_a_readme(root: Path, tmp_path: Path) -> None:
    names = ("cuboid", "disc")
    runpy.run_path(str(root / "examples" / "pictures.py"))["main"](tmp_path, tmp_path / "docs" / "sheet.png", names)
    drawn = {entry.relative_to(tmp_path).as_posix() for entry in tmp_path.rglob("*.png")}
    assert drawn == {"cuboid.png", "disc.png", "docs/sheet.png"}
    assert (tmp_path / "docs" / "sheet.png").stat().st_size < 300_000


def test_the_sheet_in_the_readme_shows_the_articles_as_they_are_now(root: Path) -> None:
    program = runpy.run_path(str(root / "examples" / "pictures.py"))
    drawn = json.loads(said_about(root / "docs" / "pictures" / "articles.png"))
    assert list(drawn) == list(program["ON_THE_SHEET"])
    for name, then in drawn.items():
        now = program["figures"](built_in(name))
        again = "draw it again: python examples/pictures.py"
        assert [now["parts"], now["note"]] == [then["parts"], then["note"]], again
        assert now["mass_kg"] == pytest.approx(then["mass_kg"], rel=1e-6), again
        # 1e-6 of the largest entry: far below a printed digit, far above rounding
        for key in ("cog_mm", "moi_cog_kgm2", "poi_cog_kgm2"):
            assert now[key] == pytest.approx(then[key], rel=1e-6, abs=1e-6), again


@pytest.mark.parametrize(
    ("picture", "name"), [("modes-clumod-4", "clumod-4"), ("excite-clumod-1", "clumod-1"), ("dynamic-mass", None)]
)
def test_pictures_of_flexible_bodies_show_the_articles_as_they_are_now(root: Path, picture: str, name: str | None) -> None:
    program = runpy.run_path(str(root / "examples" / "pictures.py"))
    said = json.loads(said_about(root / "docs" / "pictures" / f"{picture}.png"))
    then = {name: said} if name else said
    assert list(then) == ([name] if name else list(program["SIDE_BY_SIDE"]))
    for name, frequencies in then.items():
        # a thousandth: no eye sees it, and every change of a dimension that matters shows
        assert program["frequencies"](name) == pytest.approx(frequencies, rel=1e-3), "draw it again: python examples/pictures.py"


def test_the_picture_of_the_pendulum_shows_the_article_as_it_is_now(root: Path) -> None:
    program = runpy.run_path(str(root / "examples" / "pictures.py"))
    then = json.loads(said_about(root / "docs" / "pictures" / "swing.png"))
    assert program["swung"](program["swing_setup"]()) == pytest.approx(then, rel=1e-3), (
        "draw it again: python examples/pictures.py"
    )


@pytest.mark.proof  # the script; fem/solid/test_solid_model.py refines meshes
def test_a_convergence_study_prints_frequencies_that_fall_and_a_verdict(
    root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MASSLINE_CACHE", str(tmp_path))
    printed = io.StringIO()
    runpy.run_path(str(root / "examples" / "convergence.py"))["main"](Console(file=printed, width=160))
    text = printed.getvalue()
    rows = re.findall(r"│ +(\d) │ plate +│ +([\d.]+) │ +([\d.]+) │ +([\d.]+) │", text)
    assert [row[0] for row in rows] == ["1", "2"]
    for _, coarse, _, fine in rows:
        assert float(fine) < float(coarse)  # conforming elements are too stiff
    assert re.search(r"the worst, mode \d at [\d.]+ Hz \(plate\), is [\d.]+% from its", text)


@pytest.mark.proof  # the script; its two routes are held in short by virtual_test/test_closure.py
def test_the_closure_example_finds_the_model_again_axis_by_axis(root: Path) -> None:
    printed = io.StringIO()
    main = runpy.run_path(str(root / "examples" / "closure.py"))["main"]
    main(Console(file=printed, width=160), ("clumod-1", "120", "0.05", "2048"))
    rows = re.findall(r"│ (\w+) +│(.+)│\n", printed.getvalue())
    shares = {axis: [float(share) for share in re.findall(r"([\d.]+)%", cells)] for axis, cells in rows}
    assert list(shares) == ["x", "y", "z", "alpha", "beta", "gamma"]
    for exudyn_off, exudyn_at, recursion_off, recursion_at in shares.values():
        assert max(exudyn_off, exudyn_at) < 0.1  # the bar of exudyn against the recursion, in per cent
        assert recursion_off < 0.01
        assert recursion_at < 0.05


def test_the_bias_of_peak_hold_is_drawn_as_it_is_measured_now(root: Path, tmp_path: Path) -> None:
    program, printed = runpy.run_path(str(root / "examples" / "peak_hold_bias.py")), io.StringIO()
    program["main"](Console(file=printed, width=160), (str(tmp_path / "bias.png"),))
    assert re.search(r"peak hold +│ +4\d %", printed.getvalue())
    now, then = (json.loads(said_about(path)) for path in (tmp_path / "bias.png", root / "docs/pictures/peak-hold-bias.png"))
    for which, errors in now.items():
        assert errors == pytest.approx(then[which], rel=0.01), "draw it again: python examples/peak_hold_bias.py"


def test_the_gallery_draws_every_picture_of_the_docs_and_each_once(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(root / "examples"))
    drawn = runpy.run_path(str(root / "examples" / "gallery.py"))["drawn"]().values()
    names = [name for shown in drawn for name in shown]
    assert sorted(names) == sorted(path.stem for path in (root / "docs" / "pictures").iterdir())


def test_a_story_of_the_gallery_is_what_a_reader_types_and_leaves_its_picture(
    root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(root / "examples"))
    program = runpy.run_path(str(root / "examples" / "gallery.py"))
    before = Path.cwd()
    program["draw"]("peak-hold-bias", tmp_path)
    assert Path.cwd() == before
    assert [path.name for path in tmp_path.iterdir()] == ["peak-hold-bias.png"]


def test_a_line_of_a_story_that_fails_ends_it(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(root / "examples"))
    program = runpy.run_path(str(root / "examples" / "gallery.py"))
    with pytest.raises(SystemExit, match="massline check nowhere"):
        program["done"]("massline check nowhere")
    with pytest.raises(SystemExit, match="there is no moon"):
        program["main"](["moon"])


@pytest.mark.usefixtures("browser_path")
def test_a_page_is_photographed_as_a_browser_shows_it(root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(root / "examples"))
    (tmp_path / "page.html").write_text("<!doctype html><title>A page</title><h1>Mass</h1>", encoding="utf-8")
    photograph = runpy.run_path(str(root / "examples" / "in_browser.py"))["report"]
    with ThreadPoolExecutor(1) as apart:  # the suite's own browser may be open, and its driver's loop is this thread's
        apart.submit(photograph, tmp_path / "page.html", tmp_path / "page.png").result()
    assert (tmp_path / "page.png").read_bytes()[16:24] == (1366).to_bytes(4, "big") + (1500).to_bytes(4, "big")
