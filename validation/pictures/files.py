"""Where pictures go: formats that can be written, and files that are there whole or not at all."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from geometry.atomic import write_with
from geometry.errors import BadInput

FORMATS = (".png", ".jpg", ".jpeg")


def require_format(path: Path) -> None:
    """Look at the ending of `path` before anything is drawn.

    Raises
    ------
    BadInput : it is not one of `FORMATS`.
    """
    if path.suffix.lower() not in FORMATS:
        raise BadInput(
            source=str(path),
            problem=f"a picture ends in {', '.join(FORMATS)}, found {path.suffix or 'no ending'}",
            remedy="Name the file so, the ending chooses the format",
        )


def save(path: Path, write: Callable[[Path], object]) -> None:
    """Let `write` fill the picture; an interruption leaves the old one or none."""
    require_format(path)
    write_with(path, write)


ABOUT = "Comment"
"""The key of a PNG's own words."""


def said_about(path: Path) -> str:
    """The words that a PNG was written with; empty without any."""
    from PIL import Image

    with Image.open(path) as picture:
        return str(picture.info.get(ABOUT, ""))
