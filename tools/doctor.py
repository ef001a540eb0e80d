"""Are the system libraries there that the locked wheels open at run time?

Wheels carry nearly everything they need, but not OpenGL, X11, the XML parser and the OpenMP runtime: those belong to the
system, and a bare Debian has none of them. Without this check a newcomer would meet them one `ImportError` at a time. It runs
before anything is installed and therefore knows the standard library only.

    python3.11 tools/doctor.py              says what is missing and the line that installs it; exit code 1 if a library is
    python3.11 tools/doctor.py --packages   the missing Debian packages on one line, nothing when all is there; exit code 0

A browser is not needed, so that one is missing is a note.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Library:
    """A shared library of the system: the name it is opened by, the Debian package that brings it, and who opens it."""

    soname: str
    package: str
    needed_by: str


LIBRARIES = (
    Library(soname="libGL.so.1", package="libgl1", needed_by="cadquery (OCC) and exudyn"),
    Library(soname="libX11.so.6", package="libx11-6", needed_by="cadquery (OCC) and exudyn, though no window is ever opened"),
    Library(soname="libEGL.so.1", package="libegl1", needed_by="pyvista (VTK), to draw off screen without an X server"),
    Library(soname="libexpat.so.1", package="libexpat1", needed_by="cadquery (fontconfig)"),
    Library(soname="libgomp.so.1", package="libgomp1", needed_by="pinocchio and gmsh (OpenMP)"),
    Library(soname="libGLU.so.1", package="libglu1-mesa", needed_by="gmsh"),
    Library(soname="libXcursor.so.1", package="libxcursor1", needed_by="gmsh, though no window is ever opened"),
    Library(soname="libXext.so.6", package="libxext6", needed_by="gmsh"),
    Library(soname="libXfixes.so.3", package="libxfixes3", needed_by="gmsh"),
    Library(soname="libXft.so.2", package="libxft2", needed_by="gmsh"),
    Library(soname="libXinerama.so.1", package="libxinerama1", needed_by="gmsh"),
    Library(soname="libXrender.so.1", package="libxrender1", needed_by="gmsh"),
    Library(soname="libfontconfig.so.1", package="libfontconfig1", needed_by="gmsh"),
)

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "microsoft-edge")
"""What a browser may be called; `validation.report.page` looks for the same."""

INSTALL_BROWSER = "apt-get install --no-install-recommends chromium"


def installed(soname: str) -> bool:
    """Whether the system's loader finds `soname`."""
    try:
        ctypes.CDLL(soname)
    except OSError:
        return False
    return True


def missing(present: Callable[[str], bool] = installed) -> tuple[Library, ...]:
    """The libraries that are not `present`."""
    return tuple(library for library in LIBRARIES if not present(library.soname))


def browser() -> str | None:
    """The path of a browser: what `MASSLINE_BROWSER` names, or the first of `BROWSERS`; None where there is none."""
    named = os.environ.get("MASSLINE_BROWSER")
    return next(filter(None, map(shutil.which, BROWSERS if named is None else (named,))), None)


def note() -> str:
    """What a machine without a browser cannot do, and what to type."""
    return "\n".join(
        [
            "massline: note: no browser of the Chromium family is found. Tests that drive one will be skipped, and reports",
            "not be printed to PDF; everything else works. To have them, as root:",
            "  " + INSTALL_BROWSER,
        ]
    )


def install_line(libraries: Iterable[Library] = LIBRARIES) -> str:
    """The command that installs `libraries` on Debian and its relatives."""
    return "apt-get install --no-install-recommends " + " ".join(sorted(library.package for library in libraries))


def report(absent: tuple[Library, ...]) -> str:
    """What is missing, for whom, and what to type, one library a line."""
    lines = [f"  {library.soname:<15} needed by {library.needed_by}" for library in absent]
    return "\n".join(
        [
            "massline: system libraries are missing:",
            *lines,
            "Install them as root and run make again:",
            "  " + install_line(absent),
        ]
    )


def main(arguments: list[str]) -> int:
    """Run the check and return the exit code."""
    absent = missing()
    if arguments == ["--packages"]:
        sys.stdout.write(" ".join(library.package for library in absent) + "\n" if absent else "")
        return 0
    if absent:
        sys.stderr.write(report(absent) + "\n")
    if browser() is None:
        sys.stderr.write(note() + "\n")
    return 1 if absent else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
