"""The whole story in a real browser, as the workbench was asked for, and pictures of every state under out/."""

import json
import zipfile
from pathlib import Path
from typing import Any

import pytest

PNG = b"\x89PNG"


def percent(page: Any, name: str) -> float:
    """An error of the table, in per cent."""
    return float(page.locator(f'[data-error="{name}"]').inner_text().split()[0])


@pytest.mark.proof
def test_open_the_example_compare_click_diagnose_add_undo_and_save(start_app, visit, tmp_path, script, looked, shot, chromium):
    page = visit(start_app())
    assert "Drag a folder" in page.inner_text("main")
    page.get_by_label("Model file").fill("/nowhere/model.toml")
    page.get_by_label("Data: campaign folders").fill("/nowhere/block")
    page.locator("#open-files").click()
    page.locator(".fault", has_text="/nowhere/model.toml").wait_for()
    assert "no such file" in page.locator(".fault").first.inner_text()
    looked(page, "open")
    page.get_by_label("Band [Hz]").fill("9 high")
    page.locator("#open-files").click()
    page.locator(".fault", has_text="9 high").wait_for()

    page.get_by_role("button", name="Open the example A block").click()
    page.locator("main.work").wait_for()
    assert "hidden effect" in page.inner_text("header")
    page.locator(".job", has_text="Comparing").wait_for()  # it begins by itself, and says what it does
    page.locator("#overlay[data-drawn]").wait_for()
    page.locator("#map[data-drawn]").wait_for()
    before = percent(page, "plain error"), percent(page, "held-out error")
    looked(page, "compared")

    page.get_by_role("button", name="H xx: force along x").click()
    page.locator('[aria-pressed="true"][aria-label^="H xx"]').wait_for()
    worst = page.evaluate(script("worst_cell"))
    assert worst["name"] in ("fmd-z2", "force along z")
    page.mouse.click(worst["x"], worst["y"])
    page.wait_for_function(script("marked"), arg=worst["frequency"])
    page.locator('[aria-pressed="true"][aria-label^="H z"], [aria-pressed="true"][aria-label*=": moment"]').wait_for()
    page.locator("canvas[data-frames]").wait_for()  # the mode nearest the frequency swings

    page.get_by_role("tab", name="What is missing").click()
    page.locator("#diagnose").click()
    page.locator("#cancel").wait_for()
    looked(page, "at-work")
    page.locator("#verdict").wait_for()
    assert "force-gain:fmd-z2" in page.locator("#verdict").inner_text()
    assert "clear of 0" in page.locator(".cause").first.inner_text()
    looked(page, "diagnosed")
    page.locator(".cause").first.click()
    page.locator("#effect").wait_for()
    curve(page, "with force-gain:fmd-z2")
    assert "calibration" in page.locator("#effect").inner_text()  # what would confirm it
    page.locator("#answer", has_text="plain error goes from").wait_for()
    assert "fitted anew beside it" in page.locator("#answer").inner_text()  # what the plain fit frees follows the effect
    page.get_by_label("relative gain of a force channel [%]").fill("")
    page.keyboard.press("Enter")
    page.locator(".error", has_text="a number in % is expected").wait_for()
    looked(page, "cause")
    page.get_by_role("button", name="Close this message").click()

    page.locator("#add").click()
    page.locator('[data-rung="1"][aria-pressed="true"]').wait_for()
    page.locator("#falling[data-drawn]").wait_for()
    assert not page.evaluate("document.querySelector('#overlay').data.some((one) => (one.name ?? '').startsWith('with '))")
    assert bool(page.evaluate(LEFT)) is False
    page.locator("th", has_text="before").wait_for()
    after = percent(page, "plain error"), percent(page, "held-out error")
    assert after[0] < before[0] / 2
    assert after[1] < before[1] / 2
    looked(page, "added")

    with page.expect_download() as downloaded:
        page.get_by_role("link", name="Model").click()
    assert "force-gain:fmd-z2" in Path(downloaded.value.path()).read_text()
    with page.expect_download() as downloaded:
        page.get_by_role("link", name="Ladder").click()
    assert downloaded.value.suggested_filename == "model.ladder.json"
    assert len(json.loads(Path(downloaded.value.path()).read_text())["rungs"]) == 2

    page.reload()
    page.locator('[data-rung="1"][aria-pressed="true"]').wait_for()
    assert percent(page, "plain error") == after[0]

    page.locator("#undo").click()
    page.locator('[data-rung="0"][aria-pressed="true"]').wait_for()
    page.wait_for_function(f"() => document.querySelector('[data-error=\"plain error\"]').innerText.startsWith('{before[0]:g}')")
    assert page.locator('[data-rung="1"]').count() == 1  # nothing is lost

    page.get_by_role("button", name="Figures").click()
    with zipfile.ZipFile(saved(page, tmp_path / "figures.zip")) as figures:
        assert any("ladder" in name for name in figures.namelist())
        assert all(figures.read(name).startswith(PNG) for name in figures.namelist())

    page.get_by_role("button", name="Report").click()
    report = saved(page, tmp_path / "report.html")
    page.get_by_role("tab", name="Inertia").click()
    page.locator("#inertia[data-drawn]").wait_for()
    looked(page, "saved")
    opened = chromium.new_context().new_page()  # from disk, as whoever it is sent to opens it
    opened.goto(report.as_uri())
    opened.locator("html[data-drawn=all]").wait_for(timeout=180_000)
    told = opened.inner_text("body")
    assert f"{before[0]:.3g} %" in told  # of the model after Undo
    assert "force-gain:fmd-z2" in told
    shot(opened, "report")
    opened.context.close()


LEFT = "window.dispatchEvent(new Event('beforeunload', { cancelable: true }))"


def saved(page: Any, path: Path) -> Path:
    """What the page says is ready, downloaded."""
    with page.expect_download() as downloaded:
        page.locator(f'.ready-link[download="{path.name}"]').click()
    downloaded.value.save_as(path)
    return path


def curve(page: Any, name: str) -> None:
    """Wait until the overlay draws a curve called so."""
    page.wait_for_function(f"() => document.querySelector('#overlay')?.data?.some((one) => one.name === {name!r})")
