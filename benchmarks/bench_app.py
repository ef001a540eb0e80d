"""What the workbench lets one wait for, as the page sees it: until its first picture, and from a slider's move to the curve.

The page is driven by Chromium like a user's: a slider moves a step, and the clock stops with the frame in which the
overlay shows the new curve. The bar is 200 ms for every effect tried. Times are shown on the screen, beside the bar, and as
ratios to what a page costs that computes nothing. A move over the bar ends it with exit code 1.

    python -m benchmarks.bench_app [EXAMPLE]
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from validation.report import page as report_page

BAR = 0.2
"""Seconds from a slider's move to the curve."""

MOVES = 8
"""Of each slider."""

EFFECTS = (
    "force-gain:fmd-z2",
    "accelerometer-delay:cover-z3",
    "point-mass:mast-top",
    "modulus:mast",
    "joint-compliance:rotation",
)
"""One of a channel, one with a phase, and three that have the structure solved again; those that the example does not have are
left out."""

FOLLOWED = """() => new Promise((done) => {
    const root = document.querySelector("#overlay");
    const began = performance.now();
    const seen = new MutationObserver(() => {
        seen.disconnect();
        requestAnimationFrame(() => requestAnimationFrame(() => done(performance.now() - began)));
    });
    seen.observe(root, { attributeFilter: ["data-live"] });
    const slider = document.querySelector("input.what-if");
    slider.value = Number(slider.value) + 15;
    slider.dispatchEvent(new Event("input", { bubbles: true }));
})"""
"""Milliseconds from a step of the slider to the frame that shows the curve."""


@contextmanager
def served(*arguments: str) -> Iterator[tuple[str, float]]:
    """`massline app`, its address, and how long it took to print it."""
    began = time.perf_counter()
    command = [
        sys.executable,
        "-P",
        "-c",
        "from validation.cli.main import main; main()",
        "app",
        "--no-browser",
        "--stay",
        *arguments,
    ]
    environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)
    assert process.stdout is not None
    said = ""
    while (found := re.search(r"http://\S+", said)) is None:
        line = process.stdout.readline()
        if not line:
            raise SystemExit(f"massline app ended: {said}")
        said += line
    try:
        yield found[0], time.perf_counter() - began
    finally:
        process.terminate()
        process.wait()
        process.stdout.close()


def waited(page: Any, selector: str, began: float) -> float:
    """Seconds since `began` until `selector` is there."""
    page.locator(selector).first.wait_for()
    return time.perf_counter() - began


def followed(page: Any, effect: str) -> list[float]:
    """Seconds from each move of the first slider of `effect` to its curve; none where these data do not have it."""
    page.locator("#try").fill(effect)
    page.wait_for_timeout(500)
    choice = page.locator(".v-list-item", has_text=f"{effect}:")
    if not choice.count():
        page.keyboard.press("Escape")
        return []
    choice.first.click()
    page.wait_for_function(
        "(name) => document.querySelector('#overlay').data.some((one) => one.name === name)", arg=f"with {effect}"
    )
    found = []
    for _ in range(MOVES):
        drawn = int(page.locator("#overlay").get_attribute("data-drawn"))
        found.append(page.evaluate(FOLLOWED) / 1e3)
        # Until it rests and every line is computed: a move that comes before waits for that, as anything else does.
        page.wait_for_function("(drawn) => Number(document.querySelector('#overlay').dataset.drawn) > drawn", arg=drawn)
    return found


def main(example: str) -> None:
    """Measure and show."""
    from playwright.sync_api import sync_playwright

    table = Table("what", "seconds", "times the empty page", "bar")
    with sync_playwright() as playwright, served("--example", example) as (address, printed):
        browser = playwright.chromium.launch(executable_path=report_page.browser_path(), args=list(report_page.flags()))
        page = browser.new_page(viewport={"width": 1366, "height": 768})
        page.set_default_timeout(900_000)
        began = time.perf_counter()
        page.goto(address)
        empty = waited(page, "header.bar", began)
        table.add_row("command until its address", f"{printed:.2f}", f"{printed / empty:.2f}", "")
        table.add_row("address until the page", f"{empty:.2f}", "1", "")
        first = waited(page, "#overlay[data-drawn]", began)
        table.add_row("address until the first figure, compared anew", f"{first:.2f}", f"{first / empty:.2f}", "")
        page.locator("canvas[data-shown]").wait_for()
        page.get_by_role("tab", name="What if").click()
        page.locator("#try").wait_for()
        began = time.perf_counter()
        page.reload()
        for what, selector in (
            ("reload until the first figure", "#overlay[data-drawn]"),
            ("... until the structure", "canvas[data-shown]"),
        ):
            taken = waited(page, selector, began)
            table.add_row(what, f"{taken:.2f}", f"{taken / empty:.2f}", "")
        every = []
        for effect in EFFECTS:
            if moves := followed(page, effect):
                every += moves
                told = f"{np.median(moves):.3f}, at worst {max(moves):.3f}"
                table.add_row(f"slider of {effect} until the curve", told, f"{np.median(moves) / empty:.3f}", f"{BAR:g}")
        browser.close()
    Console().print(table)
    met = f"{sum(one <= BAR for one in every)} of {len(every)} moves within {BAR:g} s"
    Console().print(f"{example}: {met}, median {np.median(every):.3f} s, worst {max(every):.3f} s")
    if max(every) > BAR:
        raise SystemExit(1)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "mast")
