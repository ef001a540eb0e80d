"""The page with tests of a structure by itself: curves, MAC and switches, seen and saved, at three sizes."""

from typing import Any

import numpy as np
import pytest

TEST = """loss_factor = 0.02
[[test]]
kind = "response-functions"
article = "frame"
file = "frame.csv"
drive = "floor-1:x"
responses = ["floor-1:x", "floor-2:x"]
"""

pytestmark = pytest.mark.proof  # a browser that draws at three widths; validation/desk/test_structures.py holds what it shows

APART = """() => [...document.querySelectorAll(".js-plotly-plot")].filter((one) => one.offsetWidth > 0).flatMap((one) => {
    const box = (name) => one.querySelector(name)?.getBoundingClientRect();
    const [legend, bar, drag] = [".legend", ".modebar", ".nsewdrag"].map(box);
    const cross = (a, b) => a && b && a.width > 0 && b.width > 0
        && a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1;
    const title = one.querySelector(".gtitle")?.getBoundingClientRect();
    const pairs = { "legend on curves": [legend, drag], "buttons on legend": [legend, bar], "legend on title": [legend, title],
        "buttons on curves": [bar, drag] };
    return Object.keys(pairs).filter((name) => cross(...pairs[name])).map((name) => `${one.id}: ${name}`);
})"""
"""What of the figures lies on what it must not."""

CUT = """() => [...document.querySelectorAll(".controls, .headed, .bar")].filter((one) => one.scrollWidth > one.clientWidth + 1
    || one.scrollHeight > one.clientHeight + 1).map((one) => one.className)"""
"""Rows of controls that do not fit."""


@pytest.fixture(scope="module")
def page(start_app, visit, two_floors, tmp_path_factory) -> Any:
    folder = tmp_path_factory.mktemp("frame")
    frequency, leg = np.arange(3.0, 40.0, 0.2), 4 * 12 * 70e9 * (0.025 * 0.003**3 / 12) / 0.15**3
    K = leg * np.array([[1.8, -0.8], [-0.8, 0.8]])
    noise = np.random.default_rng(1).standard_normal((len(frequency), 2, 2)) @ [1, 1j]
    omega = 2 * np.pi * frequency[:, None, None]
    H = (-(omega**2) * np.linalg.inv(K * (1 + 0.02j) - omega**2 * 5.0 * np.eye(2)))[:, :, 0] * (1 + 0.004 * noise)
    table = np.column_stack([frequency, np.ascontiguousarray(H).view(np.float64)])
    np.savetxt(folder / "frame.csv", table, delimiter=",", comments="", header="f,1 re,1 im,2 re,2 im")
    (folder / "frame.toml").write_text('model = { title = "Two floors", article = "frame" }\n' + two_floors + TEST)
    bench = start_app("--stay", str(folder / "frame.toml"), MASSLINE_CACHE=str(folder / "cache"))
    opened = visit(bench)
    opened.locator("#overlay[data-drawn]").wait_for()
    return opened


@pytest.mark.parametrize(("width", "height"), [(1280, 650), (1366, 768), (1920, 1080)])
def test_nothing_lies_on_anything_and_nothing_is_cut_at(width, height, page):
    for larger in (True, False):  # a size that it was given, and one that it was brought to
        page.set_viewport_size({"width": width + 80 * larger, "height": height})
        page.wait_for_timeout(400)
    page.locator("#overlay").hover()
    page.wait_for_function(f"({APART})().length === 0", timeout=5000)
    assert page.evaluate(CUT) == []
    assert "-1" not in page.locator(".v-select__selection").all_inner_texts()


def test_functions_are_switched_saved_and_told(page, looked, tmp_path):
    page.set_viewport_size({"width": 1366, "height": 768})
    page.locator("#lower").select_option("ratio")
    page.locator("#units").select_option("in-lbf")
    page.locator("#overlay .ytitle", has_text="g/lbf").wait_for()
    page.locator("#overlay").hover()
    with page.expect_download() as saved:
        page.locator('#overlay [data-title="Save the numbers as CSV"]').click()
    saved.value.save_as(tmp_path / "curves.csv")
    head, first, *_ = (tmp_path / "curves.csv").read_text().splitlines()
    assert head.startswith('"frequency [Hz]",')
    assert '"measured, |H| [g/lbf]"' in head
    assert '"over predicted, measured / predicted [1]"' in head
    assert float(first.split(",")[0]) == 3.0
    for form in ("real, imaginary", "Nyquist", "magnitude"):
        page.locator("#form").select_option(form)
        page.locator("#overlay[data-drawn]").wait_for()
    page.locator("#response").select_option("1")
    page.wait_for_function("document.querySelector('#overlay').getAttribute('aria-label').includes('floor-2-x')")
    looked(page, "functions")


def test_a_place_on_the_mac_shows_that_pair(page, looked):
    page.get_by_role("tab", name="MAC").click()
    page.locator("#mac[data-drawn]").wait_for()
    assert "MAC 1.00, alike" in page.inner_text("#pair")
    page.locator("#mac").focus()
    page.keyboard.press("Home")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Enter")
    page.locator("#pair", has_text="no pair").wait_for()
    looked(page, "mac")
