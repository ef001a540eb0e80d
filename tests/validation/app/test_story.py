"""The whole story in a real browser, and pictures of it under out/."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any


def percent(page: Any, name: str) -> float:
    """An error of the table, in per cent."""
    return float(page.locator(f'[data-error="{name}"]').inner_text().split()[0])


def test_compare_click_diagnose_add_undo_and_report(
    start_app: Any, visit: Any, series: tuple[str, str], tmp_path: Path, script: Any, shot: Any, chromium: Any
) -> None:
    model, data = series
    text = Path(model).read_text()
    bench = start_app(model, data, "--hold-out", "z")
    page = visit(bench)
    page.locator(".job").wait_for()  # a comparison begins by itself, and says what it does
    page.locator("#overlay[data-drawn]").wait_for()
    page.locator("#map[data-drawn]").wait_for()
    before = percent(page, "plain error"), percent(page, "held-out error")
    shot(page, "compared")

    page.get_by_role("button", name="H xx: force along x").click()
    page.locator('[aria-pressed="true"][aria-label^="H xx"]').wait_for()
    worst = page.evaluate(script("worst_cell"))
    assert worst["name"] == "fmd-z2"
    page.mouse.click(worst["x"], worst["y"])
    page.locator('[aria-pressed="true"][aria-label*="force along z by acceleration along z"]').wait_for()
    page.locator("canvas[data-frames]").wait_for()  # the mode nearest the frequency swings

    page.get_by_role("tab", name="What is missing").click()
    page.locator("#diagnose").click()
    page.locator("#verdict").wait_for()
    assert "force-gain:fmd-z2" in page.locator("#verdict").inner_text()
    readable(page, script)
    shot(page, "diagnosed")
    page.locator(".cause").first.click()
    page.locator("#effect").wait_for()
    curve(page, "with force-gain:fmd-z2")
    assert "calibration" in page.locator("#effect").inner_text()  # what would confirm it
    page.locator("#answer", has_text="plain error goes from").wait_for()
    assert "fitted anew beside it" in page.locator("#answer").inner_text()  # what the plain fit frees follows the effect
    readable(page, script)
    shot(page, "cause")

    page.locator("#add").click()
    page.locator('[data-rung="1"][aria-pressed="true"]').wait_for()
    page.locator("#falling[data-drawn]").wait_for()
    assert not page.evaluate("document.querySelector('#overlay').data.some((one) => (one.name ?? '').startsWith('with '))")
    assert left_unasked(page) is False
    page.get_by_role("tab", name="Where it fails").click()
    page.locator("th", has_text="before").wait_for()
    after = percent(page, "plain error"), percent(page, "held-out error")
    assert after[0] < before[0] / 3
    assert after[1] < before[1] / 2
    shot(page, "added")

    with page.expect_download() as downloaded:
        page.get_by_role("link", name="Model").click()
    saved = tmp_path / "model.toml"
    downloaded.value.save_as(saved)
    assert "force-gain:fmd-z2" in saved.read_text()
    assert Path(model).read_text() == text  # the user's own file is not touched
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

    page.get_by_role("button", name="Report").click()
    with page.expect_download() as downloaded:
        page.locator(".ready-link").click()
    report = tmp_path / "report.html"
    downloaded.value.save_as(report)
    opened = chromium.new_context().new_page()  # from disk, as whoever it is sent to opens it
    opened.goto(report.as_uri())
    opened.locator("html[data-drawn=all]").wait_for()
    told = opened.inner_text("body")
    assert f"{before[0]:.3g} %" in told  # of the model after Undo
    assert "force-gain:fmd-z2" in told
    shot(opened, "report")
    opened.context.close()


LEFT = "window.dispatchEvent(new Event('beforeunload', { cancelable: true }))"


def left_unasked(page: Any) -> bool:
    """Whether the browser would leave the page without a question."""
    return bool(page.evaluate(LEFT))


def readable(page: Any, script: Any) -> None:
    """Every text stands out and every control has a name, once colours have stopped to fade into each other."""
    page.wait_for_function("() => document.getAnimations().every((one) => one.playState !== 'running')")
    assert page.evaluate(script("contrast")) == []
    assert page.evaluate(script("unlabelled")) == []


def curve(page: Any, name: str) -> None:
    """Wait until the overlay draws a curve called so."""
    page.wait_for_function(f"() => document.querySelector('#overlay')?.data?.some((one) => one.name === {name!r})")
