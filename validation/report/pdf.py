"""The page on paper: a browser of the Chromium family prints it, without a window and without a network."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

from geometry.atomic import write_with
from geometry.errors import CheckFailed
from validation.report import browser

PATIENCE = 180.0
"""[s] after which a browser that does not end is ended."""

BUDGET = 60_000
"""[ms] of the page's own time within which every figure is drawn."""


def print_to(page: Path, path: Path, program: str) -> None:
    """Print the report `page` to the PDF file `path`, whole or not at all.

    Raises
    ------
    CheckFailed : the browser does not print.
    OSError : `path` cannot be written.
    """
    write_with(path, lambda temporary: _print(page, temporary, program))


def _print(page: Path, path: Path, program: str) -> None:
    with TemporaryDirectory() as profile:
        made = Path(profile) / "page.pdf"
        done = _run([program, *_options(profile, made), f"{page.resolve().as_uri()}#paper"])
        if not made.exists() or made.stat().st_size == 0:
            raise CheckFailed(f"{program} did not print the report: {done or 'it said nothing'}")
        shutil.copyfile(made, path)


def _options(profile: str, made: Path) -> tuple[str, ...]:
    """Without a window, a profile of its own, nothing asked of anybody."""
    return (
        "--headless",
        *browser.flags(),
        "--disable-extensions",
        f"--user-data-dir={profile}/profile",
        f"--virtual-time-budget={BUDGET}",
        "--no-pdf-header-footer",
        "--generate-pdf-document-outline",
        f"--print-to-pdf={made}",
    )


def _run(words: list[str]) -> str:
    """The last thing that the browser said.

    Raises
    ------
    CheckFailed : it does not end by itself.
    """
    try:
        done = subprocess.run(words, capture_output=True, encoding="utf-8", errors="replace", timeout=PATIENCE, check=False)
    except subprocess.TimeoutExpired:
        raise CheckFailed(f"{words[0]} did not print the report within {PATIENCE:g} s") from None
    return next((line for line in reversed(done.stderr.splitlines()) if line.strip()), "")
