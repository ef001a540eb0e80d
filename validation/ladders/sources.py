"""Where a ladder's data lie and whether they are what they were: paths from its folder, and digests of what they hold."""

from __future__ import annotations

import os.path
from collections.abc import Sequence
from hashlib import file_digest, sha256
from importlib.resources import files
from pathlib import Path

from geometry.errors import BadInput
from identification import campaign_file
from validation import measurement_file
from validation.ladders.nouns import Conditions, Source


def sources(paths: Sequence[str], folder: Path) -> tuple[Source, ...]:
    """The data at `paths`, seen from the `folder` of a ladder.

    Raises
    ------
    BadInput : a folder that is no campaign.
    OSError : a file cannot be read.
    """
    return tuple(Source(path=_from(path, folder), digest=digest(path)) for path in paths)


def paths(known: Conditions, folder: Path, ladder: str) -> tuple[str, ...]:
    """Where the data of a rung are now, `folder` being that of the `ladder`.

    Raises
    ------
    BadInput : one of them is not there any more.
    """
    return tuple(_there(one.path, folder, ladder) for one in known.data)


def changed(known: Conditions, now: Conditions) -> tuple[str, ...]:
    """Sentences about data of `known` that hold something else `now`."""
    digests = {one.path: one.digest for one in known.data}
    return tuple(
        f"{one.path} is not what it was when the ladder met it: its digest changed. The model is held against it anew"
        for one in now.data
        if digests.get(one.path, one.digest) != one.digest
    )


def digest(path: str) -> str:
    """SHA-256 of a file, or of the description and the signals of a campaign.

    Raises
    ------
    BadInput : a folder that is no campaign.
    OSError : a file cannot be read.
    """
    if not Path(path).is_dir():
        return _of_file(Path(path)) if Path(path).exists() else _shipped(path)
    described = campaign_file.read_description(path)
    names = sorted({campaign_file.NAME, *(run.file for run in described.runs)})
    whole = sha256()
    for name in names:
        if (Path(path) / name).is_file():
            whole.update(f"{name}\0{_of_file(Path(path) / name)}\n".encode())
    return whole.hexdigest()


def _of_file(path: Path) -> str:
    with path.open("rb") as stream:
        return file_digest(stream, "sha256").hexdigest()


def _shipped(name: str) -> str:
    held = files("validation").joinpath("published").joinpath(f"{name.removesuffix('.toml')}.toml")
    return sha256(held.read_bytes()).hexdigest()


def _from(path: str, folder: Path) -> str:
    """`path` from `folder`, with forward slashes; the name of shipped data stays one."""
    if not Path(path).exists():
        return path
    return Path(os.path.relpath(Path(path).resolve(), folder.resolve())).as_posix()


def _there(path: str, folder: Path, ladder: str) -> str:
    if (folder / path).exists():
        return os.path.normpath(folder / path)
    if path.removesuffix(".toml") in measurement_file.shipped():
        return path
    problem = f"its rung stands on {path}, which is not there any more"
    raise BadInput(
        source=ladder, field="data", problem=problem, remedy="Put it back, or name the data again: MODEL EFFECT DATA ..."
    )
