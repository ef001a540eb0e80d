"""Arrays of an ``.npz``: never unpickled, no larger than its list says."""

import zipfile
from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np

from geometry.errors import BadInput

_WRITE_AGAIN = "Write it again with numpy.savez_compressed"


def read(path: Path, largest: int, wanted: Collection[str] | None = None) -> dict[str, Any]:
    """The arrays in `path` by name, those `wanted` alone where some are.

    Parameters
    ----------
    largest : [bytes] that they may take

    Raises
    ------
    BadInput : no archive, cut short, damaged (the archive's checksums tell), an array that would have to be unpickled, or more
        than `largest`.
    """
    source = str(path)
    try:
        with zipfile.ZipFile(path) as archive:
            entries = archive.infolist()
            names = [entry.filename.removesuffix(".npy") for entry in entries]
            if not names:
                raise BadInput(source, "", "it holds no arrays", _WRITE_AGAIN)
            if len(set(names)) < len(names):
                raise BadInput(source, "", "it holds two arrays of one name", _WRITE_AGAIN)
            chosen = {name: one for name, one in zip(names, entries, strict=True) if wanted is None or name in wanted}
            total = sum(entry.file_size for entry in chosen.values())
            if total > largest:
                problem = f"its arrays would take {total / 2**30:.3g} GiB, more than {largest / 2**30:.3g}"
                raise BadInput(source, "", problem, "Leave out of it what is not needed")
            found = {name: _array(archive, entry, name, source) for name, entry in chosen.items()}
            return {name: values for name, values in found.items() if values is not None}
    except BadInput:
        raise
    except Exception as error:  # zipfile, zlib and NumPy raise a dozen kinds of their own on damaged bytes
        problem = f"it cannot be read as .npz: {type(error).__name__}, {error}"
        raise BadInput(source, "", problem, f"{_WRITE_AGAIN}; it may be cut short or damaged") from None


def _array(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, name: str, source: str) -> Any:
    """One array, its header compared with what follows it before memory is asked for; None for a lone Python object."""
    with archive.open(entry) as file:
        version = np.lib.format.read_magic(file)
        header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, _, dtype = header(file)
        if dtype.hasobject and shape == ():  # None, which NumPy writes so
            return None
        if dtype.hasobject:
            problem = "holds Python objects, which only pickle could read, and that could run anything"
            raise BadInput(source, name, problem, "Save an array of numbers")
        declared = int(np.prod([int(side) for side in shape], dtype=object)) * dtype.itemsize
        if declared != entry.file_size - file.tell():
            raise BadInput(source, name, f"declares {declared} bytes where {entry.file_size - file.tell()} follow", _WRITE_AGAIN)
    with archive.open(entry) as file:
        return np.lib.format.read_array(file, allow_pickle=False)
