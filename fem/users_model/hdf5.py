"""Arrays from HDF5. Only what lies in the file itself: no links to other files, and nothing that is declared but not there."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from fem.users_model.contents import LARGEST_BYTES, TOO_LARGE, Contents
from geometry.errors import BadInput

ENDINGS = (".h5", ".hdf5", ".hdf")

_WRITE_AGAIN = "Write it again; it may be cut short or damaged"
_OWN_DATA = "Copy what it points to into this file"


def read(path: Path) -> Contents:
    """The datasets in `path`, those of groups as ``group/name``.

    Raises
    ------
    BadInput : no HDF5, cut short or damaged, a link or storage outside the file, a dataset that is declared but was never
        written, or more than `LARGEST_BYTES`.
    """
    import h5py

    source = str(path)
    try:
        with h5py.File(path, "r") as file:
            found = _datasets(file, "", source)
            _require_reasonable(found, source)
            arrays = {name: np.asarray(dataset[()]) for name, dataset in found.items()}
            text = file.attrs.get("description")
    except BadInput:
        raise
    except Exception as error:  # h5py raises OSError, KeyError, RuntimeError, ValueError and more on damaged bytes
        problem = f"it cannot be read as HDF5: {str(error).splitlines()[0] if str(error) else type(error).__name__}"
        raise BadInput(source=source, problem=problem, remedy=_WRITE_AGAIN) from None
    if isinstance(text, bytes):
        text = text.decode("utf-8", errors="replace")
    return Contents(source=source, arrays=arrays, description=text if isinstance(text, str) else None)


def _datasets(group: Any, prefix: str, source: str) -> dict[str, Any]:
    """All datasets below `group`, by path. Groups within groups are not ours; links are looked at before they are followed."""
    import h5py

    found: dict[str, Any] = {}
    for key in group:
        name, link = f"{prefix}{key}", group.get(key, getlink=True)
        if not isinstance(link, h5py.HardLink):
            target = getattr(link, "filename", None) or getattr(link, "path", "")
            raise BadInput(source=source, field=name, problem=f"is a link to {target!r}, which is not followed", remedy=_OWN_DATA)
        entry = group[key]
        if isinstance(entry, h5py.Dataset):
            found[name] = _own(entry, name, source)
        elif prefix:
            problem = "is a group within a group, which no model of ours has"
            raise BadInput(source=source, field=name, problem=problem, remedy="Put the datasets at the root of the file")
        elif isinstance(entry, h5py.Group):
            found |= _datasets(entry, f"{name}/", source)
    return found


def _own(dataset: Any, name: str, source: str) -> Any:
    """`dataset`, when all of it lies in the file."""
    if dataset.external or dataset.is_virtual:
        raise BadInput(source=source, field=name, problem="has its numbers in another file", remedy=_OWN_DATA)
    if dataset.dtype.kind not in "fiuc":
        problem = f"must hold numbers, found the type {dataset.dtype}"
        raise BadInput(source=source, field=name, problem=problem, remedy="Write it as 64-bit floating point")
    if dataset.size and dataset.id.get_storage_size() == 0:
        shape = " x ".join(map(str, dataset.shape)) or "1"
        problem = f"declares {shape} values, but none was ever written"
        raise BadInput(source=source, field=name, problem=problem, remedy=_WRITE_AGAIN)
    return dataset


def _require_reasonable(found: dict[str, Any], source: str) -> None:
    total = sum(int(dataset.size or 0) * dataset.dtype.itemsize for dataset in found.values())
    if total > LARGEST_BYTES:
        problem = f"its datasets would take {total / 2**30:.3g} GiB, more than {LARGEST_BYTES / 2**30:.3g}"
        raise BadInput(source=source, problem=problem, remedy=TOO_LARGE)
