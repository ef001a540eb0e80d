"""Arrays from a NumPy ``.npz``: never unpickled, and no larger in memory than the archive's own list says."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from fem.users_model.contents import LARGEST_BYTES, TOO_LARGE, Contents
from geometry.errors import BadInput

_WRITE_AGAIN = "Write it again with numpy.savez_compressed"


def read(path: Path) -> Contents:
    """The arrays in `path`.

    Raises
    ------
    BadInput : no archive, cut short, damaged (the archive's checksums tell), an array that would have to be unpickled, or more
        than `LARGEST_BYTES`.
    """
    source = str(path)
    try:
        with zipfile.ZipFile(path) as archive:
            _require_reasonable(archive, source)
            arrays = {entry.filename.removesuffix(".npy"): _array(archive, entry, source) for entry in archive.infolist()}
    except BadInput:
        raise
    except Exception as error:  # zipfile, zlib and NumPy raise a dozen kinds of their own on damaged bytes
        problem = f"it cannot be read as .npz: {type(error).__name__}, {error}"
        raise BadInput(source=source, problem=problem, remedy=f"{_WRITE_AGAIN}; it may be cut short or damaged") from None
    text = arrays.pop("description", None)
    return Contents(source=source, arrays=arrays, description=None if text is None else str(text))


def _require_reasonable(archive: zipfile.ZipFile, source: str) -> None:
    names = [entry.filename for entry in archive.infolist()]
    if not names:
        raise BadInput(source=source, problem="it holds no arrays", remedy=_WRITE_AGAIN)
    if len(set(names)) < len(names):
        raise BadInput(source=source, problem="it holds two arrays of one name", remedy=_WRITE_AGAIN)
    total = sum(entry.file_size for entry in archive.infolist())
    if total > LARGEST_BYTES:
        problem = f"its arrays would take {total / 2**30:.3g} GiB, more than {LARGEST_BYTES / 2**30:.3g}"
        raise BadInput(source=source, problem=problem, remedy=TOO_LARGE)


def _array(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, source: str) -> Any:
    """One array, its header compared with what follows it before memory is asked for."""
    name = entry.filename.removesuffix(".npy")
    with archive.open(entry) as file:
        version = np.lib.format.read_magic(file)
        header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, _, dtype = header(file)
        if dtype.hasobject:
            problem = "holds Python objects, which only pickle could read, and that could run anything"
            raise BadInput(source=source, field=name, problem=problem, remedy="Save an array of numbers")
        declared = int(np.prod([int(side) for side in shape], dtype=object)) * dtype.itemsize
        if declared != entry.file_size - file.tell():
            problem = f"declares {declared} bytes where {entry.file_size - file.tell()} follow"
            raise BadInput(source=source, field=name, problem=problem, remedy=_WRITE_AGAIN)
    with archive.open(entry) as file:
        return np.lib.format.read_array(file, allow_pickle=False)
