"""The pictures of `massline modes --shapes` and `--mode`."""

from __future__ import annotations

from pathlib import Path

from geometry.errors import BadInput
from validation.article_reference import file_name
from validation.flexible.drawing import drawn_modes
from validation.flexible.model import Flexible
from validation.pictures.gltf import write_glb
from validation.pictures.mode_sheet import animation, mode_sheet

ON_THE_SHEET = 11
"""Modes of Clumod with four blades up to 15.5 Hz."""

NOTE = "Base held. Grey outline: at rest. A mode has no scale of its own: each is drawn with the same largest displacement."


def require_mode(number: int, count: int) -> None:
    """Refuse a mode that is not among the `count` that will be computed.

    Raises
    ------
    BadInput : it is not.
    """
    if not 1 <= number <= count:
        problem, remedy = f"modes 1 to {count} are computed, found {number}", "Choose one of them, or compute more with --count"
        raise BadInput(source="--mode", problem=problem, remedy=remedy)


def require_drawable(article: str, model: str) -> None:
    """Refuse pictures of a model that gives no shapes, before it is computed.

    Raises
    ------
    BadInput : it is exudyn's.
    """
    if model == "exudyn":
        problem = "exudyn's own elements give frequencies and participations here, no shape that could be drawn"
        raise BadInput(source=article, field="--shapes", problem=problem, remedy="Draw the beam or the solid model")


def draw_sheet(model: Flexible, folder: Path, name: str | None = None, about: str = "") -> Path:
    """Write the contact sheet of the first modes into `folder`, and say where it is; it carries the words `about`.

    Raises
    ------
    BadInput : the article has no mode, or no surface that is known.
    CheckFailed : nothing can be rendered on this machine.
    """
    numbers = range(1, 1 + min(ON_THE_SHEET, len(model.modes.frequency)))
    path = folder / (name or f"{_stem(model)}.png")
    title = f"{model.article}: the first {len(numbers)} modes, {model.model} model"
    mode_sheet(title, drawn_modes(model, numbers), path, NOTE, about)
    return path


def draw_moving(model: Flexible, number: int, folder: Path) -> list[Path]:
    """Write mode `number` as a GIF and as an animated glTF into `folder`, and say where they are.

    Raises
    ------
    BadInput : no such mode, or no surface that is known.
    CheckFailed : nothing can be rendered on this machine.
    """
    (mode,) = drawn_modes(model, [number])
    moving = folder / f"{_stem(model)}-{number}.gif", folder / f"{_stem(model)}-{number}.glb"
    write_glb(moving[1], model.article, mode)
    animation(model.article, mode, moving[0])
    return list(moving)


def _stem(model: Flexible) -> str:
    return file_name(f"modes-{model.article}-{model.model}")
