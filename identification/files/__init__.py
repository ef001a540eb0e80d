"""Signal files: the format is that of the ending. Readers believe nothing, writers leave whole files or none."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

from geometry.errors import BadInput
from identification.files.contents import Signals

FORMATS = {
    ".uff": "uff",
    ".unv": "uff",
    ".h5": "hdf5",
    ".hdf5": "hdf5",
    ".csv": "csv",
    ".mat": "mat",
}
"""Ending of a file, in lower case, and the module of this package that reads and writes it."""


def read(path: Path) -> Signals:
    """The signals in `path`, in the units and under the names of the file.

    Raises
    ------
    BadInput : an ending that is not known, or whatever is wrong with the file.
    """
    return _module(path).read(path)  # type: ignore[no-any-return]


def write(path: Path, signals: Signals) -> None:
    """Write `signals` to `path`, whole or not at all.

    Raises
    ------
    BadInput : an ending that is not known, or signals that the format cannot hold.
    """
    call: Callable[[Path, Signals], None] = _module(path).write
    call(path, signals)


def require_known(name: str, source: str, field: str) -> None:
    """Refuse a file `name` with an ending that is not known.

    Raises
    ------
    BadInput : the endings that are.
    """
    if Path(name).suffix.lower() not in FORMATS:
        problem = f"ends in {Path(name).suffix!r}, which is none of {', '.join(FORMATS)}"
        raise BadInput(source=source, field=field, problem=problem, remedy="Export the signals in one of these formats")


def _module(path: Path) -> Any:
    require_known(path.name, str(path), "")
    return import_module(f"identification.files.{FORMATS[path.suffix.lower()]}")
