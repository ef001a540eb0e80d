"""What is kept of a window's work when the workbench ends and nobody has saved it: models with the rungs added to them."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

from fem.solid import cache
from geometry.errors import BadInput
from validation.desk import desk as desks
from validation.desk import moving
from validation.desk.desk import Desk
from validation.ladders import file

SAVED = "rungs.saved"
"""The file of a desk that says how many rungs were there when its model was opened, or downloaded last."""

PLACE = "workbench"
"""Folder of the cache."""


def saved(of: Desk) -> None:
    """All rungs are in the user's hands: the model was opened just now, or downloaded."""
    (of.folder / SAVED).write_text(str(_rungs(of.folder)), encoding="utf-8")


def unsaved(of: Desk) -> bool:
    """Whether effects were added since."""
    return _unsaved(of.folder)


def kept(home: Path, say: Callable[[str], None]) -> None:
    """Copy what is unsaved in the windows below `home` to the user's cache, and `say` where it is."""
    for folder in sorted(home.glob("*/desk-*")):
        if desks.is_desk(folder) and _unsaved(folder):
            try:
                say(f"A model with effects added was not saved; it is kept in\n  {_copied(folder)}")
            except (BadInput, OSError) as error:
                say(f"A model with effects added was not saved, and cannot be kept: {error}")


def _unsaved(folder: Path) -> bool:
    try:
        known = int((folder / SAVED).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        known = 0
    return _rungs(folder) > max(known, 1)  # the first one is the model as it was opened


def _rungs(folder: Path) -> int:
    try:
        return len(file.read(file.beside(folder / "work" / "model.toml")).rungs)
    except (OSError, BadInput):
        return 0


def _copied(folder: Path) -> Path:
    """The model with its ladder, files that were dropped, and a report, in a new folder of the cache.

    Raises
    ------
    BadInput : there is no cache, or the model cannot be read.
    OSError : it cannot be written there.
    """
    place = cache.folder()
    if place is None:
        raise BadInput(source="workbench", problem="there is no folder for a cache", remedy="Set MASSLINE_CACHE")
    to = place / PLACE / next(_names(folder, place / PLACE))
    for one in _beside(folder):
        shutil.copytree(one, to / one.name, dirs_exist_ok=True)
    moving.copied(folder / "work" / "model.toml", to / "model.toml")
    return to / "model.toml"


def _beside(folder: Path) -> list[Path]:
    return [one for one in (*folder.parent.glob("drop-*"), folder / "saved") if one.is_dir()]


def _names(folder: Path, place: Path) -> Iterator[str]:
    number = 0
    while True:
        name = f"{folder.parent.name}-{folder.name}" + (f"-{number}" if number else "")
        if not (place / name).exists():
            yield name
        number += 1
