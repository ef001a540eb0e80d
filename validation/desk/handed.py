"""Files that a browser handed over, put into the desk's folder: whatever they are called, they go nowhere else.

Names come from a stranger. They are taken apart at ``/`` and ``\\``; what climbs, is absolute, reserved, too long or too deep, or
holds characters that no file name needs, is refused in words. Files that a system hides beside those of the user (``.DS_Store``,
``.git``, ``.~lock``, ``Thumbs.db``) are passed over, in words too. Nothing is renamed in silence: a campaign finds its signals by
their names. What is left keeps its folders, so that a dropped series is one. A file that is handed over again takes the place of
the one that was.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from geometry import toml_file
from geometry.atomic import write_with
from geometry.errors import BadInput
from identification.campaign_file import NAME
from validation import measurement_file
from validation.comparing.gathered import TRUTH
from validation.desk.faults import Fault, of_error

SOURCE = "the files that were handed over"
"""What a fault of theirs is about."""

GIVEN = "given"
"""The folder of a desk in which they lie."""

LARGEST = 2 * 2**30
"""Bytes of all files of a desk together."""

MOST = 2000
"""Files."""

LONGEST, DEEPEST = 120, 6
"""Characters of a name, folders above a file."""

FORBIDDEN = re.compile(r'[\x00-\x1f\x7f<>:"|?*]')
RESERVED = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)
"""What no Windows folder can hold, so that a desk can be copied anywhere."""

OF_SYSTEMS = ("thumbs.db", "desktop.ini", "__macosx")
"""What systems put into folders without a full stop before it, in small letters."""

DEEP = 3
"""Folders below the one that is looked through."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Handed:
    """One file as a browser gives it.

    Attributes
    ----------
    name : with the folders of what was dropped, ``series/block/x.h5``
    content : its bytes, or a file that already holds them and is copied
    """

    name: str
    content: bytes | Path


@dataclass(frozen=True, kw_only=True)
class Received:
    """What was taken over or found, told apart by what it holds.

    Attributes
    ----------
    folder : in which everything lies
    models : paths of model files, those that were handed over just now first
    data : paths of campaign folders and measurement files
    faults : what was refused, in words; not `grave` what was passed over and is missed by nobody
    """

    folder: Path
    models: tuple[str, ...]
    data: tuple[str, ...]
    faults: tuple[Fault, ...]


def received(folder: str | Path, files: Sequence[Handed], *, limit: int = LARGEST) -> Received:
    """`files` written below `folder` (that of the desk to be), in ``given/``; those that are refused are told and left out.

    One of the name of a file that was handed over before, as after a fault was mended, replaces it.

    Parameters
    ----------
    limit : bytes of all files together, those that are there already included

    Raises
    ------
    OSError : the folder cannot be written.
    """
    given = Path(folder).resolve() / GIVEN
    given.mkdir(parents=True, exist_ok=True)
    before = {_folded(path.relative_to(given).parts): path for path in _files(given)}
    room, faults = limit - sum(path.stat().st_size for path in before.values()), []
    taken: set[tuple[str, ...]] = set()
    hidden: list[str] = []
    for number, one in enumerate(files):
        try:
            _require_few(number, one)
            parts = _parts(one.name)
            if any(_is_hidden(part) for part in parts):
                hidden.append(one.name)
                continue
            old = before.get(_folded(parts))
            _require_new(parts, taken | (before.keys() - {_folded(parts)}), one)
            room = _require_room(room + (old.stat().st_size if old else 0), one, limit)
        except BadInput as error:
            faults.append(of_error(error))
            continue
        if old is not None:
            old.unlink()  # perhaps in other capitals
        _write(given.joinpath(*parts), one)
        taken.add(_folded(parts))
    found = sorted_out(given)
    faults += [] if not hidden else [_passed_over(hidden)]
    models = sorted(found.models, key=lambda path: _folded(Path(path).relative_to(given).parts) not in taken)
    return Received(folder=given, models=tuple(models), data=found.data, faults=tuple(faults))


def sorted_out(folder: str | Path) -> Received:
    """What a `folder` on this machine holds: models, campaigns and measurements, some levels deep; nothing is copied or followed.

    Raises
    ------
    BadInput : there is no such folder.
    OSError : it cannot be read.
    """
    where = Path(folder)
    if not where.is_dir():
        raise BadInput(
            source=str(folder), problem="there is no such folder", remedy="Name the folder of a campaign or of a series"
        )
    models: list[str] = []
    data: list[str] = []
    for path in _looked_through(where, DEEP):
        if path.is_dir():
            data.append(str(path))
        elif (kind := _kind(path)) is not None:
            (models if kind == "model" else data).append(str(path))
    return Received(folder=where, models=tuple(models), data=tuple(data), faults=())


def _looked_through(folder: Path, deep: int) -> Iterator[Path]:
    """Campaign folders, whose own folders are not looked into, and files that could be models or measurements."""
    if campaign := (folder / NAME).is_file():
        yield folder
    for path in sorted(folder.iterdir()):
        if path.is_symlink() or path.name.startswith(".") or path.name == NAME:
            continue
        if path.is_dir() and deep and not campaign:
            yield from _looked_through(path, deep - 1)
        elif path.is_file() and path.suffix.lower() in (".toml", ".json") and not path.name.endswith(TRUTH):
            yield path


def _kind(path: Path) -> str | None:
    """ "model", the kind of a measurement, or None for something else; what is neither is no fault here."""
    try:
        table = toml_file.read(path)
    except (BadInput, OSError):
        return "model" if path.suffix.lower() == ".toml" else None  # the reader of models says what is wrong with it
    if "model" in table and path.suffix.lower() == ".toml":
        return "model"
    kind = table.get("kind")
    return str(kind) if kind in measurement_file.KINDS else None


def _parts(name: str) -> tuple[str, ...]:
    """The folders and the name of a file, each of them harmless.

    Raises
    ------
    BadInput : the name would lead elsewhere, or no file can have it.
    """
    if not name or name[0] in "/\\" or (len(name) > 1 and name[1] == ":"):
        raise _refused(name, "is no name of a file in a folder")
    parts = tuple(part for part in re.split(r"[/\\]", name) if part not in ("", "."))
    if ".." in parts:
        raise _refused(name, "leads out of its folder")
    if not parts or len(parts) > DEEPEST or len(name) > DEEPEST * LONGEST:
        raise _refused(name, f"lies in more than {DEEPEST - 1} folders, or in none")
    for part in parts:
        _require_harmless(part, name)
    return parts


def _require_harmless(part: str, name: str) -> None:
    if len(part.encode("utf-8", "surrogatepass")) > LONGEST:
        raise _refused(name, f"is longer than {LONGEST} characters")
    if FORBIDDEN.search(part) or any("\ud800" <= letter <= "\udfff" for letter in part):
        raise _refused(name, "holds a character that no file name can have everywhere")
    if part.endswith((".", " ")) or RESERVED.fullmatch(part):
        raise _refused(name, "ends in a full stop, or is the name of a device")


def _is_hidden(part: str) -> bool:
    return part.startswith(".") or part.casefold() in OF_SYSTEMS


def _passed_over(names: Sequence[str]) -> Fault:
    """Of files that are no data, one word for all."""
    more = f" and {len(names) - 1} more" if len(names) > 1 else ""
    problem = "hidden files and those of an operating system are passed over"
    remedy = "There is nothing to do; a file that is meant must not begin with a full stop"
    return Fault(file=SOURCE, field=f"{_shown(names[0])}{more}", problem=problem, remedy=remedy, grave=False)


def _require_few(number: int, one: Handed) -> None:
    if number >= MOST:
        raise _refused(one.name, f"comes behind {MOST} other files")


def _require_new(parts: tuple[str, ...], taken: set[tuple[str, ...]], one: Handed) -> None:
    """Refuse a second file of a name, capitals or not, and one where a folder is."""
    folded = _folded(parts)
    clash = folded in taken or any(folded[:k] in taken for k in range(1, len(folded)))
    if clash or any(other[: len(folded)] == folded for other in taken):
        raise _refused(one.name, "is there already, perhaps in other capitals")


def _require_room(room: int, one: Handed, limit: int) -> int:
    size = len(one.content) if isinstance(one.content, bytes) else one.content.stat().st_size
    if size > room:
        raise _refused(one.name, f"does not fit: all files together may hold {limit / 2**20:g} MB")
    return room - size


def _write(path: Path, one: Handed) -> None:
    content = one.content
    if isinstance(content, bytes):
        write_with(path, lambda temporary: temporary.write_bytes(content))
        return
    import shutil

    write_with(path, lambda temporary: shutil.copyfile(content, temporary))


def _folded(parts: Sequence[str]) -> tuple[str, ...]:
    return tuple(part.casefold() for part in parts)


def _files(folder: Path) -> Iterator[Path]:
    for where, _, names in os.walk(folder):
        yield from (Path(where) / name for name in names)


def _refused(name: str, problem: str) -> BadInput:
    return BadInput(source=SOURCE, field=_shown(name), problem=problem, remedy="Rename it, and hand it over again")


def _shown(name: str) -> str:
    """`name` as a page can say it."""
    shown = name.encode("unicode_escape", "backslashreplace").decode("ascii") if not name.isprintable() else name
    return shown if len(shown) <= LONGEST else f"{shown[:LONGEST]}…"
