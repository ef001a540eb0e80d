"""The page as a person meets it: what it says when it is empty, what it says is wrong, by eye and by keyboard, light and dark."""

from __future__ import annotations

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

STILL = "() => document.getAnimations().every((one) => one.playState !== 'running')"
"""Whether colours have stopped to fade into each other."""


@pytest.fixture(scope="module")
def bench(start_app: Any, series: tuple[str, str], tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A workbench on data whose folder and title would like to be HTML and a template."""
    model, data = series
    folder = tmp_path_factory.mktemp("evil") / EVIL
    shutil.copytree(data, folder)
    told = (folder / "campaign.toml").read_text(encoding="utf-8")
    (folder / "campaign.toml").write_text(told.replace("Virtual test of", f"{EVIL} of"), encoding="utf-8")
    return start_app("--stay", model, str(folder), "--hold-out", "z")


@pytest.fixture(scope="module")
def page(bench: Any, visit: Any) -> Any:
    """A window in which the comparison is made."""
    opened = visit(bench)
    opened.locator("#map[data-drawn]").wait_for()
    opened.locator("#overlay[data-drawn]").wait_for()
    return opened


@pytest.fixture(scope="module")
def empty(start_app: Any, visit: Any) -> Any:
    """A window that begins with nothing."""
    opened = visit(start_app("--stay"))
    opened.locator("#open-files").wait_for()
    return opened


def test_an_empty_page_says_what_to_do_next(empty: Any, script: Any, shot: Any) -> None:
    assert "Drag a folder" in empty.inner_text("main")
    assert empty.get_by_role("button", name="Open the example").count() >= 2
    for scheme in ("light", "dark"):
        empty.emulate_media(color_scheme=scheme)
        empty.locator(f".v-theme--{scheme}").first.wait_for()
        empty.wait_for_function(STILL)
        assert empty.evaluate(script("contrast")) == []
        assert empty.evaluate(script("unlabelled")) == []
        shot(empty, f"open-{scheme}")
    empty.emulate_media(color_scheme="light")


def test_what_is_wrong_stands_beside_the_field_that_has_it(empty: Any, shot: Any) -> None:
    empty.get_by_label("Model file").fill("/nowhere/model.toml")
    empty.get_by_label("Data: campaign folders").fill("/nowhere/block")
    empty.locator("#open-files").click()
    empty.locator(".fault", has_text="/nowhere/model.toml").wait_for()
    assert "no such file" in empty.locator(".fault").first.inner_text()
    empty.get_by_label("Band [Hz]").fill("9 high")
    empty.locator("#open-files").click()
    empty.locator(".fault", has_text="9 high").wait_for()
    shot(empty, "faults")


def test_names_of_dropped_files_go_nowhere(empty: Any, bench: Any) -> None:
    names = ["../../../evil.toml", "/etc/evil.toml", "..\\evil.toml", "a/../../evil.toml", "ok\u0000evil.toml", EVIL + ".toml"]
    send = """async (names) => {
        const form = new FormData();
        for (const name of names) form.append(encodeURIComponent(name), new Blob(["x = 1"]), "file");
        return (await fetch("files", { method: "POST", body: form })).status;
    }"""
    root = Path(f"/proc/{bench.process.pid}/cwd").resolve().parent
    before = {path for path in root.rglob("*evil*") if "given" not in path.parts}
    assert empty.evaluate(send, names) == 200
    empty.locator(".fault", has_text="evil.toml").first.wait_for()
    assert {path for path in root.rglob("*evil*") if "given" not in path.parts} == before
    assert not Path("/etc/evil.toml").exists()
    assert empty.locator("main img").count() == 0


def test_names_in_a_campaign_are_text(page: Any, bench: Any) -> None:
    assert EVIL in page.inner_text("header")
    page.locator(".note", has_text=f"{EVIL} of fmd+cuboid").wait_for()
    assert page.locator("img").count() == 0
    assert "49" not in page.inner_text("header")
    assert page.locator("#overlay .gtitle").text_content().count("<img") == 1
    assert page.title() == "massline"


@pytest.mark.parametrize(("width", "height"), [(1366, 768), (1920, 1080)])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_everything_can_be_read_and_is_named_without_sideways_scrolling(
    page: Any, script: Any, shot: Any, width: int, height: int, scheme: str
) -> None:
    page.set_viewport_size({"width": width, "height": height})
    page.emulate_media(color_scheme=scheme)
    page.locator(f".v-theme--{scheme}").first.wait_for()
    paper = {"light": "rgb(255, 255, 255)", "dark": "rgb(23, 27, 34)"}[scheme]
    page.wait_for_function(
        "(paper) => getComputedStyle(document.querySelector('#overlay .main-svg')).backgroundColor === paper", arg=paper
    )
    page.locator("canvas[data-shown]").wait_for()
    page.wait_for_function(STILL)
    assert page.evaluate(script("contrast")) == []
    assert page.evaluate(script("unlabelled")) == []
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    shot(page, f"work-{scheme}-{width}")


def test_the_keyboard_reaches_everything_and_shows_where_it_is(page: Any) -> None:
    page.set_viewport_size({"width": 1366, "height": 768})
    page.evaluate("document.activeElement?.blur()")
    reached = []
    for _ in range(90):
        page.keyboard.press("Tab")
        name, outline = page.evaluate(FOCUSED)
        reached.append(name)
        assert outline != "none", name
    for wanted in ("Skip to the contents", "Report", "What is missing", "H xx: force along x by a", "Pairs of axes"):
        assert any(one.startswith(wanted) for one in reached), wanted
    page.get_by_role("button", name="H yy: force along y").focus()
    page.keyboard.press("Enter")
    page.locator('[aria-pressed="true"][aria-label^="H yy"]').wait_for()


def test_the_structure_turns_by_keyboard_and_by_hand(page: Any) -> None:
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


def test_a_slider_moves_the_curve_and_comes_to_rest_at_every_line(page: Any, shot: Any) -> None:
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


def test_a_long_computation_can_be_cancelled_and_leaves_nothing(page: Any, bench: Any, until: Any) -> None:
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


def test_an_example_opens_by_its_button(empty: Any) -> None:
    empty.get_by_role("button", name="Open the example").first.click()
    empty.locator("main.work").wait_for()
    assert "hidden effect" in empty.inner_text("header")
    empty.locator(".job", has_text="Comparing").wait_for()
    empty.locator("#cancel").click()
    empty.locator("#compare:enabled").wait_for()
