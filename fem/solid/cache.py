"""Arrays kept on disk by what they were made from: a mesh, matrices, modes. Nothing here may ever be in the way.

An entry is one ``.npz`` file, named after the digest of everything that went into it, versions of the libraries included. It
carries that name and a digest of its own arrays inside, so that a file that is half-written, cut short, damaged, renamed or
somebody else's is seen and ignored, and made again. No pickle is read or written. A disk that is full or read-only costs the
time that the entry would have saved, and nothing else.

The folder is ``MASSLINE_CACHE``, else ``massline`` in ``XDG_CACHE_HOME``, else ``~/.cache/massline``; it may be deleted at
any time.
"""

from __future__ import annotations

import hashlib
import json
import os
import time
from collections.abc import Iterator, Mapping
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np

from geometry import atomic

FORMAT = 2
"""Of the entries; a change of what is stored or computed counts it up, and older ones are no longer found."""

LARGEST = 4 * 2**30
"""Bytes that the folder may hold; the entries unused for longest go first."""

ABANDONED = 24 * 3600.0
"""Seconds after which a temporary file of a process that was killed is removed."""

LIBRARIES = ("gmsh", "scikit-fem", "cadquery-ocp", "numpy", "scipy")

Arrays = Mapping[str, np.ndarray]

_KEY, _DIGEST = "massline-key", "massline-digest"


def folder() -> Path | None:
    """Where entries are kept, there or not yet; None where a home cannot be found."""
    own = os.environ.get("MASSLINE_CACHE")
    if own:
        return Path(own)
    base = Path(os.environ.get("XDG_CACHE_HOME", ""))
    if base.is_absolute():
        return base / "massline"
    try:
        return Path.home() / ".cache" / "massline"
    except RuntimeError:
        return None


def key(kind: str, described: Any) -> str:
    """Name of the entry that holds the `kind` of thing made from what `described` says (anything that JSON can write)."""
    whole = {"kind": kind, "format": FORMAT, "versions": {name: _version(name) for name in LIBRARIES}, "described": described}
    return hashlib.sha256(json.dumps(whole, sort_keys=True, allow_nan=False).encode()).hexdigest()


def load(name: str) -> dict[str, np.ndarray] | None:
    """The arrays of the entry `name`; None when there is none that is whole and its own."""
    path = _path(name)
    if path is None:
        return None
    try:
        with path.open("rb") as opened, np.load(opened, allow_pickle=False) as file:
            arrays = {each: file[each] for each in file.files}
        genuine = str(arrays.pop(_KEY)) == name and str(arrays.pop(_DIGEST)) == digest(arrays)
    except Exception:  # whatever damaged or foreign bytes make numpy, zipfile and zlib raise
        return None
    if genuine:
        with suppress(OSError):
            os.utime(path)  # used now
    return arrays if genuine else None


def store(name: str, arrays: Arrays) -> None:
    """Keep `arrays` under `name`, as far as the disk allows."""
    path = _path(name)
    if path is None or sum(array.nbytes for array in arrays.values()) > LARGEST:
        return
    stamped = {**arrays, _KEY: np.array(name), _DIGEST: np.array(digest(arrays))}
    with suppress(OSError):
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        atomic.write_with(path, lambda temporary: np.savez(temporary, allow_pickle=False, **stamped))
        _make_room(path.parent)


def digest(arrays: Arrays) -> str:
    """Digest of names, types, shapes and bytes of `arrays`, hexadecimal."""
    found = hashlib.blake2b(digest_size=32)
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        found.update(f"{name} {array.dtype.str} {array.shape};".encode())
        found.update(array.reshape(-1).view(np.uint8).data)
    return found.hexdigest()


def _path(name: str) -> Path | None:
    there = folder()
    return None if there is None else there / f"{name}.npz"


def _version(library: str) -> str:
    try:
        return version(library)
    except PackageNotFoundError:
        return "none"


def _make_room(there: Path) -> None:
    """Remove what killed processes left, then the entries unused for longest until all fit."""
    now = time.time()
    for path, stat in _files(there, ".*.npz"):
        if now - stat.st_mtime > ABANDONED:
            path.unlink(missing_ok=True)
    kept = 0
    for path, stat in sorted(_files(there, "[!.]*.npz"), key=lambda found: -found[1].st_mtime_ns):
        kept += stat.st_size
        if kept > LARGEST:
            path.unlink(missing_ok=True)


def _files(there: Path, pattern: str) -> Iterator[tuple[Path, os.stat_result]]:
    for path in there.glob(pattern):
        with suppress(OSError):
            yield path, path.stat()
