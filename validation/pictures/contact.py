"""Several pictures side by side on one sheet, small enough for a README."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from geometry.errors import BadInput
from validation.pictures.files import ABOUT, save

COLUMNS = 2
TILE = (800, 600)
COLOURS = 255
"""A PNG sheet keeps so many colours, spread over all that occur: a third of the size, and no difference to the eye."""


def contact_sheet(paths: Sequence[Path], path: Path, about: str = "") -> None:
    """Put the pictures at `paths` on one sheet, two abreast, in their order; the ending of `path` chooses PNG or JPEG.

    A PNG carries the words `about`, which `validation.pictures.said_about` reads again.

    Raises
    ------
    BadInput : no picture, a file that is none, or an unknown ending of `path`.
    """
    from PIL import Image

    if not paths:
        raise BadInput(source=str(path), field="paths", problem="no picture was given", remedy="Give at least one")
    rows = -(-len(paths) // COLUMNS)
    sheet = Image.new("RGB", (COLUMNS * TILE[0], rows * TILE[1]), "white")
    for index, tile in enumerate(paths):
        row, column = divmod(index, COLUMNS)
        sheet.paste(_tile(tile), (column * TILE[0], row * TILE[1]))
    octree, plain = Image.Quantize.FASTOCTREE, Image.Dither.NONE
    finished = sheet.quantize(COLOURS, method=octree, dither=plain) if path.suffix == ".png" else sheet
    more = {"pnginfo": _noted(about)} if path.suffix == ".png" and about else {}
    save(path, lambda temporary: finished.save(temporary, optimize=True, **more))


def _noted(about: str) -> Any:
    from PIL.PngImagePlugin import PngInfo

    info = PngInfo()
    info.add_text(ABOUT, about)
    return info


def _tile(path: Path) -> Any:
    from PIL import Image

    try:
        with Image.open(path) as image:
            return image.convert("RGB").resize(TILE, Image.Resampling.LANCZOS)
    except OSError as error:
        raise BadInput(
            source=str(path), problem=f"this is no picture that can be read ({error})", remedy="Draw it again"
        ) from None
