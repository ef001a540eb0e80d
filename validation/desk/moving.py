"""A model file and its ladder in another folder: what they say of other files by its path is said anew from there.

Paths in a model file (``[structure.own]``) and in a ladder (its data) are seen from their own folder. A copy that is read in
another one must say them otherwise; every other byte stays, comments and ends of lines too.
"""

from __future__ import annotations

import os.path
import re
from dataclasses import replace
from pathlib import Path

from geometry.atomic import write_with
from geometry.errors import BadInput
from validation.ladders import file
from validation.ladders.climbing import read_text
from validation.ladders.nouns import Ladder, Rung, Source
from validation.models import reading

TABLE = re.compile(r"^\s*\[(?!\[)\s*structure\s*\.\s*own\s*\]")
OTHER = re.compile(r"^\s*\[")
ENTRY = re.compile(
    r"^(?P<key>\s*(?:\"[^\"]*\"|'[^']*'|[\w-]+)\s*=\s*)(?P<quote>[\"'])(?P<path>[^\"'\\]*)(?P=quote)(?P<rest>.*)$", re.S
)


def copied(model: Path, to: Path) -> None:
    """Copy the file `model`, and the ladder beside it where there is one, to the file `to` and beside it.

    Raises
    ------
    BadInput : no model file, a ladder that cannot be read, a layout of paths that cannot be said anew.
    OSError : a file cannot be read or written.
    """
    text = moved(read_text(model), model, to)
    reading.of_text(text, str(to))
    beside = file.beside(model)
    ladder = moved_ladder(file.read(beside), model, to) if beside.exists() else None
    to.parent.mkdir(parents=True, exist_ok=True)
    if ladder is not None:
        file.write(file.beside(to), ladder, to.name)
    write_with(to, lambda temporary: temporary.write_bytes(text.encode("utf-8")))


def moved(text: str, model: Path, to: Path) -> str:
    """`text` of the file `model` as the file `to` must say it: paths of a user's own models seen from there.

    Raises
    ------
    BadInput : such paths stand where they cannot be found, as in an inline table.
    """
    if "own" not in text or model.resolve().parent == to.resolve().parent:
        return text
    lines, inside = text.splitlines(keepends=True), False
    for k, line in enumerate(lines):
        if OTHER.match(line):
            inside = bool(TABLE.match(line))
        elif inside and (entry := ENTRY.match(line)):
            path = _seen(entry["path"], model, to)
            lines[k] = f"{entry['key']}{entry['quote']}{path}{entry['quote']}{entry['rest']}"
    found = "".join(lines)
    _require_same(text, found, model, to)
    return found


def _seen(path: str, model: Path, to: Path) -> str:
    """A path from the folder of `model`, from that of `to`; an absolute one stays as it is."""
    if not path or Path(path).is_absolute():
        return path
    return Path(os.path.relpath(model.resolve().parent / path, to.resolve().parent)).as_posix()


def _require_same(before: str, after: str, model: Path, to: Path) -> None:
    """Refuse a text whose own models are not those of the first."""

    def own(text: str, at: Path) -> dict[str, Path]:
        return {name: Path(path).resolve() for name, path in reading.of_text(text, str(at)).own.items()}

    known = own(before, model)
    try:
        same = own(after, to) == known
    except BadInput:  # a path that leads nowhere from there
        same = False
    if not same:
        problem = (
            "the paths of your own models do not stand one a line in [structure.own], and cannot be said from another folder"
        )
        raise BadInput(
            source=str(model), field="structure.own", problem=problem, remedy='Write "article" = "path" on lines there'
        )


def moved_ladder(ladder: Ladder, model: Path, to: Path) -> Ladder:
    """`ladder` of the file `model` as that of the file `to` must say it: its texts as `moved`, its data seen from there.

    Raises
    ------
    BadInput : see `moved`.
    """
    return replace(ladder, rungs=tuple(_rung(one, model, to) for one in ladder.rungs))


def _rung(one: Rung, model: Path, to: Path) -> Rung:
    data = tuple(Source(path=_data(source.path, model, to), digest=source.digest) for source in one.conditions.data)
    return replace(one, model=moved(one.model, model, to), conditions=replace(one.conditions, data=data))


def _data(path: str, model: Path, to: Path) -> str:
    """A path of a ladder; the name of a shipped measurement stays a name."""
    return _seen(path, model, to) if (model.parent / path).exists() else path
