"""Several pictures side by side on one sheet."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from geometry.atomic import write_with
from geometry.errors import BadInput

COLUMNS = 2
TILE = (800, 600)
DPI = 100


def contact_sheet(paths: Sequence[Path], path: Path) -> None:
    """Put the pictures at `paths` on one sheet, two abreast, in their order; the ending of `path` chooses PNG or JPEG.

    Raises
    ------
    BadInput : no picture, or a file that is none.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    if not paths:
        raise BadInput(source=str(path), field="paths", problem="no picture was given", remedy="Give at least one")
    rows = -(-len(paths) // COLUMNS)
    figure = Figure(figsize=(COLUMNS * TILE[0] / DPI, rows * TILE[1] / DPI), dpi=DPI, facecolor="white")
    FigureCanvasAgg(figure)
    for index, tile in enumerate(paths):
        row, column = divmod(index, COLUMNS)
        axes = figure.add_axes((column / COLUMNS, 1 - (row + 1) / rows, 1 / COLUMNS, 1 / rows))
        axes.set_axis_off()
        axes.imshow(_read(tile), interpolation="antialiased", aspect="equal")
    write_with(path, lambda temporary: figure.savefig(temporary, dpi=DPI, **_format(path)))


def _read(path: Path) -> Any:
    from matplotlib.image import imread

    try:
        return imread(path)
    except (OSError, SyntaxError) as error:
        raise BadInput(
            source=str(path), problem=f"this is no picture that can be read ({error})", remedy="Draw it again"
        ) from None


def _format(path: Path) -> dict[str, Any]:
    return {"pil_kwargs": {"quality": 85, "optimize": True}} if path.suffix in (".jpg", ".jpeg") else {}
