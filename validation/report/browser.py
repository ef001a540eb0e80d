"""A browser of the Chromium family without a window: where it lies, and how it is started so that it asks nobody for anything.

Whoever starts one, the tests and the benchmarks among them, starts it with `flags`.
"""

from __future__ import annotations

import os
import shutil
import subprocess

from geometry.errors import BadInput

BROWSER = "MASSLINE_BROWSER"
"""The environment variable that names a browser."""

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "microsoft-edge")

PATIENCE = 30.0
"""[s] that a browser has to say its version."""


def path() -> str:
    """The path of a browser that prints.

    Raises
    ------
    BadInput : there is none, or `MASSLINE_BROWSER` names none.
    """
    named = os.environ.get(BROWSER)
    if named is not None:
        found = shutil.which(named)
        if found is None:
            remedy = "Name a browser of the Chromium family, or unset it"
            raise BadInput(source=BROWSER, problem=f"no program is called {named!r}", remedy=remedy)
        return found
    found = next((there for name in NAMES if (there := shutil.which(name))), None)
    if found is None:
        raise BadInput(
            source="browser",
            problem=f"none is on the path, looked for {', '.join(NAMES)}",
            remedy=f"Install one (Debian: apt-get install chromium), or name another in {BROWSER}",
        )
    return found


def version(program: str) -> str:
    """What the browser `program` says of itself; its path where it says nothing."""
    try:
        done = subprocess.run([program, "--version"], capture_output=True, encoding="utf-8", timeout=PATIENCE, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return program
    return done.stdout.strip() or program


def flags() -> tuple[str, ...]:
    """What it is started with: nothing asked of anybody, and its sandbox kept wherever it can be.

    As root, which is what one is in a container, it refuses to start in its sandbox.
    """
    root = hasattr(os, "geteuid") and os.geteuid() == 0
    return (
        *(("--no-sandbox",) if root else ()),
        "--disable-gpu",
        "--disable-quic",
        "--no-first-run",
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
    )
