"""An OpenGL window that nobody sees: where VTK gets it from, and what is said when there is none.

Left alone, VTK asks an X server first, complains on standard error, tries EGL, then OSMesa, and crashes when all are missing.
Pictures need no screen, so on Linux EGL is asked at once, whether a display exists or not: the same picture everywhere. A child
process tries it first, because a crash in the driver cannot be caught in this one.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

from geometry.errors import CheckFailed

OFF_SCREEN = {"VTK_DEFAULT_OPENGL_WINDOW": "vtkEGLRenderWindow", "EGL_LOG_LEVEL": "fatal"}
"""Environment that makes VTK render through EGL, and Mesa keep to itself which hardware it did not find."""

TRIAL = """
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(16, 16))
plotter.add_mesh(pyvista.Sphere(), color="black")
if plotter.screenshot(return_img=True).min() > 128:
    raise SystemExit(3)
"""

PATIENCE = 120
"""Seconds after which a driver that does not answer counts as none."""


@contextmanager
def off_screen() -> Iterator[None]:
    """Windows made inside need no screen; the environment is restored afterwards.

    Raises
    ------
    CheckFailed : nothing can be rendered on this machine; the message names the packages that are missing.
    """
    _require_renderer()
    before = {name: os.environ.get(name) for name in _environment()}
    os.environ.update(_environment())
    try:
        yield
    finally:
        for name, value in before.items():
            _restore(name, value)


@cache
def _require_renderer() -> None:
    """Render a black ball in a child process, once a session."""
    environment = os.environ | _environment()
    try:
        command = [sys.executable, "-P", "-c", TRIAL]
        trial = subprocess.run(command, env=environment, capture_output=True, timeout=PATIENCE, check=False)
    except subprocess.TimeoutExpired:
        raise _no_renderer("it did not answer", "") from None
    if trial.returncode != 0:
        raise _no_renderer(f"a trial ended with code {trial.returncode}", trial.stderr.decode(errors="replace"))


def _no_renderer(what: str, said: str) -> CheckFailed:
    return CheckFailed(
        f"no picture can be rendered: OpenGL is not available without a screen ({what}). "
        "On Debian install the packages libegl1, libgl1 and libgl1-mesa-dri (software rendering, no graphics card needed), "
        "or ask for the tables without pictures",
        said=said,
    )


def _environment() -> dict[str, str]:
    return OFF_SCREEN if sys.platform == "linux" else {}


def _restore(name: str, value: str | None) -> None:
    if value is None:
        os.environ.pop(name, None)
    else:
        os.environ[name] = value
