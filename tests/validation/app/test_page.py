"""The page as a person meets it: by mouse and by keyboard, with names in the files that would like to be more than names."""

import re
import shutil
from pathlib import Path
from typing import Any

import pytest

EVIL = "<img src=x onerror=alert(1)>{{7*7}}"

FOCUSED = """() => {
    const one = document.activeElement;
    if (one === document.body) return ["", "the browser's own"];
    const name = one.getAttribute("aria-label") ?? one.innerText ?? "";
    return [name.trim().slice(0, 24) || one.id, getComputedStyle(one).outlineStyle];
}"""
"""Name and outline of what the keyboard is at."""


def hertz(page: Any, figure: str) -> float:
    """The frequency of the place that the keyboard has marked in a figure, as it is said."""
    return float(re.search(r"([\d.]+) Hz", page.locator(f"{figure} .place-words").inner_text())[1])  # type: ignore[index]


@pytest.fixture(scope="module")
def bench(start_app, series, tmp_path_factory) -> Any:
    """A workbench on data whose folder and title would like to be HTML and a template."""
    model, data = series
    folder = tmp_path_factory.mktemp("evil") / EVIL
    shutil.copytree(data, folder)
    told = (folder / "campaign.toml").read_text(encoding="utf-8")
    (folder / "campaign.toml").write_text(told.replace("Virtual test of", f"{EVIL} of"), encoding="utf-8")
    return start_app("--stay", model, str(folder), "--hold-out", "z")


@pytest.fixture(scope="module")
def page(bench, visit) -> Any:
    """A window in which the comparison is made."""
    opened = visit(bench)
    opened.locator("#map[data-drawn]").wait_for()
    opened.locator("#overlay[data-drawn]").wait_for()
    return opened


def test_names_of_dropped_files_go_nowhere(page, bench):
    page.get_by_role("button", name="Open another").click()
    names = ["../../../evil.toml", "/etc/evil.toml", "..\\evil.toml", "a/../../evil.toml", "ok\u0000evil.toml", EVIL + ".toml"]
    send = """async (names) => {
        const form = new FormData();
        for (const name of names) form.append(encodeURIComponent(name), new Blob(["x = 1"]), "file");
        return (await fetch("files", { method: "POST", body: form })).status;
    }"""
    root = Path(f"/proc/{bench.process.pid}/cwd").resolve().parent
    before = {path for path in root.rglob("*evil*") if "given" not in path.parts}
    assert page.evaluate(send, names) == 200
    page.locator(".fault", has_text="evil.toml").first.wait_for()
    assert {path for path in root.rglob("*evil*") if "given" not in path.parts} == before
    assert not Path("/etc/evil.toml").exists()
    assert page.locator("main img").count() == 0
    page.get_by_role("button", name="Back to what is open").click()
    page.locator("#map[data-drawn]").wait_for()


def test_names_in_a_campaign_are_text(page, bench):
    assert EVIL in page.inner_text("header")
    page.locator(".note", has_text=f"{EVIL} of fmd+cuboid").wait_for()
    assert page.locator("img").count() == 0
    assert "49" not in page.inner_text("header")
    assert page.title() == "massline"


def test_the_keyboard_reaches_everything_and_shows_where_it_is(page):
    page.set_viewport_size({"width": 1366, "height": 768})
    page.evaluate("document.activeElement?.blur()")
    reached = []
    for _ in range(100):
        page.keyboard.press("Tab")
        name, outline = page.evaluate(FOCUSED)
        reached.append(name)
        assert outline != "none", name
    for wanted in ("Skip to the contents", "Report", "Where it fails", "Channels", "Map of residuals"):
        assert any(one.startswith(wanted) for one in reached), wanted
    (entry,) = {one for one in reached if one.startswith("H ")}  # one stop of 36: the entry that is shown
    assert page.locator('.picker [aria-pressed="true"]').get_attribute("aria-label").startswith(entry)


def label(page: Any) -> str:
    """What the control is called that has the focus; empty for one that needs no such name."""
    return str(page.evaluate("document.activeElement.getAttribute('aria-label') ?? ''"))


def test_arrow_keys_go_from_entry_to_entry_and_enter_shows_one(page):
    page.get_by_role("button", name="H yy: force along y").focus()
    for key, wanted in (("ArrowRight", "yz"), ("ArrowDown", "zz"), ("Home", "zx"), ("ArrowLeft", "zx"), ("ArrowUp", "yx")):
        page.keyboard.press(key)
        assert label(page).startswith(f"H {wanted}"), key
    page.keyboard.press("Control+ArrowRight")
    assert label(page).startswith("H yx"), "a shortcut of the browser moves nothing"
    page.keyboard.press("Tab")
    assert not label(page).startswith("H ")
    page.keyboard.press("Shift+Tab")
    assert label(page).startswith("H yx"), "Tab comes back to where it left"
    page.keyboard.press("Enter")
    page.locator('.picker [aria-pressed="true"][aria-label^="H yx"]').wait_for()
    assert label(page).startswith("H yx")
    page.get_by_role("button", name="H zz: force along z").click()
    page.locator('.picker [aria-pressed="true"][aria-label^="H zz"][tabindex="0"]').wait_for()
    assert page.locator('.picker [tabindex="0"]').count() == 1


def test_arrow_keys_choose_a_tab_that_says_what_it_controls(page):
    page.get_by_role("tab", name="Where it fails").focus()
    for key, name in (("ArrowRight", "What is missing"), ("End", "What if"), ("ArrowRight", "Where it fails")):
        page.keyboard.press(key)
        page.locator('[role="tab"][aria-selected="true"]', has_text=name).wait_for()
        assert page.evaluate("document.activeElement.innerText") == name
    panels = page.evaluate("[...document.querySelectorAll('[role=tab]')].map((one) => one.getAttribute('aria-controls'))")
    for panel in set(panels):
        assert page.locator(f"#{panel}[role=tabpanel]").count() == 1, panel


def test_any_cell_and_any_frequency_is_marked_told_and_picked_by_keyboard(page, script, shot):
    page.locator("#map").focus()
    page.keyboard.press("Home")
    worst = page.locator("#map .place-words").inner_text()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowUp")
    beside = page.locator("#map .place-words").inner_text()
    assert beside.split(",")[0] != worst.split(",")[0]
    assert " σ" in beside
    shot(page, "map-by-keyboard")
    page.keyboard.press("Enter")
    page.wait_for_function(script("marked"), arg=hertz(page, "#map"))
    page.locator("#overlay").focus()
    page.keyboard.press("PageDown")
    first = hertz(page, "#overlay")
    page.keyboard.press("ArrowRight")
    assert hertz(page, "#overlay") > first
    assert "predicted" in page.locator("#overlay .place-words").inner_text()
    assert page.locator("#overlay .place-words").get_attribute("role") == "status"  # which is read out
    shot(page, "overlay-by-keyboard")
    page.keyboard.press("Enter")
    page.wait_for_function(script("marked"), arg=hertz(page, "#overlay"))
    page.get_by_role("tab", name="Where it fails").focus()
    assert not page.locator(".place:visible").count()


APART = """() => {
    const names = [...document.querySelectorAll("#map .ytick text")].map((one) => one.getBoundingClientRect());
    names.sort((a, b) => a.top - b.top);
    const small = document.querySelector("#map .main-svg").clientHeight < 290;
    return small && names.length > 3 && names.every((one, k) => k === 0 || one.top > names[k - 1].bottom - 0.5);
}"""


def test_names_of_channels_on_the_map_do_not_touch_on_a_small_page(page):
    size = page.viewport_size
    page.set_viewport_size({"width": 1280, "height": 650})
    try:
        page.wait_for_function(APART, timeout=10_000)
    finally:
        page.set_viewport_size(size)


def test_the_structure_turns_by_keyboard_and_by_hand(page):
    canvas = page.locator("canvas.view")
    page.locator("canvas[data-shown]").wait_for()
    shown = int(canvas.get_attribute("data-shown"))
    canvas.focus()
    page.keyboard.press("ArrowLeft")
    page.wait_for_function("(shown) => Number(document.querySelector('canvas.view').dataset.shown) > shown", arg=shown)
    shown = int(canvas.get_attribute("data-shown"))
    box = canvas.bounding_box()
    page.mouse.move(box["x"] + 50, box["y"] + 50)
    page.mouse.down()
    page.mouse.move(box["x"] + 120, box["y"] + 70)
    page.mouse.up()
    page.wait_for_function("(shown) => Number(document.querySelector('canvas.view').dataset.shown) > shown", arg=shown)


def test_a_slider_moves_the_curve_and_comes_to_rest_at_every_line(page, shot):
    page.get_by_role("tab", name="What if").click()
    page.locator("#try").fill("force-gain:fmd-z1")
    page.locator(".v-list-item", has_text="force-gain:fmd-z1").first.click()
    page.locator("input.what-if").wait_for()
    page.wait_for_function("() => document.querySelector('#overlay').data.some((one) => one.name === 'with force-gain:fmd-z1')")
    page.locator("input.what-if").focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_function("() => Number(document.querySelector('#overlay').dataset.live) > 0")
    page.get_by_label("relative gain of a force channel [%]").fill("10")
    page.keyboard.press("Enter")
    page.locator("#answer", has_text="force-gain:fmd-z1=0.1:").wait_for()
    shot(page, "what-if")
    page.get_by_role("button", name="Put aside").click()
    page.wait_for_function("() => !document.querySelector('#overlay').data.some((one) => (one.name ?? '').startsWith('with '))")


def test_a_long_computation_can_be_cancelled_and_leaves_nothing(page, bench, until):
    windows = bench.descendants()
    page.get_by_role("tab", name="What is missing").click()
    page.locator("#diagnose").click()
    page.locator("#cancel").wait_for()
    assert until(lambda: len(bench.descendants()) > len(windows))
    page.get_by_role("button", name="H zz: force along z").click()  # the page goes on meanwhile
    page.locator('[aria-pressed="true"][aria-label^="H zz"]').wait_for()
    page.locator("#cancel").click()
    page.locator("text=was cancelled").wait_for()
    assert until(lambda: set(bench.descendants()) <= set(windows), 5)
    assert page.locator("#diagnose").is_enabled()


SCRIPTS = """async () => {
    const named = [...document.scripts].map((one) => one.src);
    const loaded = performance.getEntriesByType("resource").map((one) => one.name).filter((one) => /[.]m?js([?#]|$)/.test(one));
    const every = [...new Set([...named, ...loaded])].filter(Boolean);
    return Promise.all(every.map(async (one) => [one, await (await fetch(one)).text()]));
}"""
"""Every script that the page has run, as it came."""


def test_no_click_leads_out_of_the_house(page, leaves_by_no_click):
    page.locator("#map[data-drawn]").wait_for()
    leaves_by_no_click(
        page, {"http", "data", "blob"}, ["Copy the numbers", "Save the numbers as CSV"]
    )  # `visit` holds that it is this machine which is asked


def test_no_script_of_the_page_holds_a_foreign_address(page, elsewhere):
    scripts = dict(page.evaluate(SCRIPTS))
    assert {one.rpartition("/")[2].partition("?")[0] for one in scripts} >= {"plotly.js", "vue.global.js", "massline.js"}
    assert all(scripts.values())
    assert {name: found for name, text in scripts.items() if (found := elsewhere(text))} == {}
