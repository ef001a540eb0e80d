"""Photographs of pages for the gallery: the report as it opens from disk, the workbench as somebody works with it."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from validation.report import page

PATIENCE = 600_000
"""Milliseconds that a page may take: it computes."""

SWINGING = "canvas[data-frames]"
"""The structure in the mode nearest the frequency that is marked, all of its frames; they come last."""

OF_A_MODE = ", damping ratio "
"""What is said beneath the structure once a mode is what is seen; while it is drawn, the sensors are."""

EFFECT_SEEN = "() => document.querySelector('#overlay').data.some((one) => (one.name ?? '').startsWith('with '))"


def report(page: Path, picture: Path, sections: Sequence[str] = ()) -> None:
    """The head of the report `page` and some of its sections by name, all without any, in a window of 1366 pixels."""
    with browser() as opened:
        tab = opened.new_page(viewport={"width": 1366, "height": 1500})
        tab.goto(page.resolve().as_uri())
        if sections:
            tab.locator("html[data-drawn]").wait_for(state="attached", timeout=PATIENCE)
            kept = "".join(f":not(#{name})" for name in sections)
            tab.add_style_tag(content=f"main section[id]{kept} {{ display: none }}")
        tab.screenshot(path=str(picture))


def workbench(folder: Path) -> None:
    """The example of the tutorial on the workbench: compared, and diagnosed with a cause looked at."""
    with serving("--example", "mast") as address, browser() as opened:
        page = opened.new_page(viewport={"width": 1366, "height": 850})
        page.set_default_timeout(PATIENCE)
        page.goto(address)
        page.locator("#overlay[data-drawn]").wait_for()
        page.locator(".job").wait_for(state="detached")
        page.locator(".found ol li button").first.click()  # the worst spot
        page.get_by_text(OF_A_MODE).wait_for()
        page.locator(SWINGING).wait_for()
        page.screenshot(path=str(folder / "workbench-compared.png"))
        page.get_by_role("tab", name="What is missing").click()
        page.locator("#diagnose").click()
        page.locator("#verdict").wait_for()
        page.locator(".cause").first.click()
        page.locator("#effect").wait_for()
        page.locator(".job").wait_for(state="detached")
        page.wait_for_function(EFFECT_SEEN)
        page.locator(SWINGING).wait_for()
        page.screenshot(path=str(folder / "workbench-cause.png"))


@contextmanager
def browser() -> Iterator[Any]:
    """Chromium of this machine, without a window."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=page.browser_path(), args=list(page.flags()))
        yield opened
        opened.close()


@contextmanager
def serving(*arguments: str) -> Iterator[str]:
    """The address of a `massline app` that runs meanwhile."""
    entry = [
        sys.executable,
        "-P",
        "-c",
        "from validation.cli.main import main; main()",
        "app",
        *arguments,
        "--no-browser",
        "--stay",
    ]
    with subprocess.Popen(entry, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            yield next(line.strip() for line in process.stdout if "?token=" in line)
        finally:
            process.send_signal(signal.SIGINT)
