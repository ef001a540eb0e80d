"""Where a virtual test goes: its folder and its truth, both whole or not at all, and nothing of anybody else's is replaced.

The truth lists every file of its campaign with its SHA-256. A folder that its truth vouches for, file by file, can be made again
from the seed, and may be replaced; any other is left alone.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from hashlib import sha256
from pathlib import Path

from geometry import atomic
from geometry.errors import BadInput
from validation.output import json_text

KIND = "virtual test"
FILES = "files_sha256"


def require_free(folder: Path, truth: Path) -> None:
    """Refuse, before anything is computed, a folder or a truth that would destroy what is there.

    Raises
    ------
    BadInput : `folder` holds something else than the virtual test that `truth` vouches for; `truth` is another file, or lies in
        the folder.
    """
    _require_apart(folder, truth)
    known = _vouched(truth)
    if truth.exists() and known is None:
        problem = f"{truth} is there and is no truth of a virtual test"
        raise BadInput(source=str(truth), problem=problem, remedy="Name another file; it is not overwritten")
    if folder.exists() and any(folder.iterdir()) and digests(folder) != known:
        problem = "it is there, and not empty, and no virtual test that its truth vouches for"
        raise BadInput(
            source=str(folder), field="--out", problem=problem, remedy="Name a new folder, or remove this one yourself"
        )


def require_folder(path: Path) -> None:
    """Refuse a file where a folder is meant, and the folder in which the command runs or one around it, which cannot be replaced.

    Raises
    ------
    BadInput : `path` is there and no folder, or such a folder.
    """
    if Path.cwd().is_relative_to(path.resolve()):
        problem = "the command runs in this folder"
        raise BadInput(source=str(path), field="--out", problem=problem, remedy="Name a folder in it, such as out/campaign")
    if path.exists() and not path.is_dir():
        problem = "it is a file, a folder is expected"
        raise BadInput(source=str(path), field="--out", problem=problem, remedy="Name a new folder")


def write(folder: Path, truth: Path, content: Mapping[str, object], fill: Callable[[Path], None]) -> None:
    """Let `fill` make the new `folder`, and write its truth, `content` and the digests of its files; see `require_free`.

    Raises
    ------
    OSError : one of them cannot be written.
    """

    def both(new: Path) -> None:
        fill(new)
        stated = {"kind": KIND, **content, FILES: digests(new)}
        atomic.write_text(truth, json_text(stated) + "\n")  # before the folder is in place: no campaign is ever without its truth

    atomic.write_folder(folder, both)


def digests(folder: Path) -> dict[str, str]:
    """SHA-256 of everything in `folder` by name; a subfolder has none."""
    return {path.name: sha256(path.read_bytes()).hexdigest() if path.is_file() else "" for path in sorted(folder.iterdir())}


def _vouched(truth: Path) -> dict[str, str] | None:
    """The digests in the file `truth`; None where there is no such file, or it is something else."""
    try:
        found = json.loads(truth.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    if not isinstance(found, dict) or found.get("kind") != KIND or not isinstance(found.get(FILES), dict):
        return None
    return dict(found[FILES])


def _require_apart(folder: Path, truth: Path) -> None:
    if truth.resolve().is_relative_to(folder.resolve()):
        problem = f"{truth} lies in the campaign folder, which whoever is not to see the truth will read"
        raise BadInput(source="--sealed", problem=problem, remedy="Name a file elsewhere")
