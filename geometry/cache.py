"""Arrays and answers kept on disk by what they were made from: a mesh, modes, a picture. Nothing here may ever be in the way.

An entry is one ``.npz`` file, named after the digest of everything that went into it, versions of the libraries included. It
carries that name and a digest of its own arrays, so that a file that is half-written, damaged, renamed or somebody else's is
seen and made again. A full or read-only disk costs the time that the entry would have saved, and nothing else. The folder is
``MASSLINE_CACHE``, else ``massline`` in ``XDG_CACHE_HOME``, else ``~/.cache/massline``; it may be deleted at any time.
"""

import copyreg
import functools
import hashlib
import json
import os
import pickle
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from types import MappingProxyType
from typing import Any, TypeVar

import numpy as np

from geometry import atomic

FORMAT = 2
"""Of the entries; a change of what is stored or computed counts it up, and older ones are no longer found."""

LARGEST = 4 * 2**30
"""Bytes that the folder may hold; the entries unused for longest go first."""

ABANDONED = 24 * 3600.0
"""Seconds after which a temporary file of a process that was killed is removed."""

LIBRARIES = ("gmsh", "scikit-fem", "cadquery-ocp", "numpy", "scipy", "pin", "trimesh", "libigl", "manifold3d", "exudyn")

ROOMS = ("geometry", "fem", "identification", "validation")
"""Packages whose source makes the answers."""

Arrays = Mapping[str, np.ndarray]
Made = TypeVar("Made")

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
    whole = {"kind": kind, "format": FORMAT, "versions": versions(), "described": described}
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
        # What killed processes left goes, then the entries unused for longest until all fit
        for found, stat in _files(path.parent, ".*.npz"):
            if time.time() - stat.st_mtime > ABANDONED:
                found.unlink(missing_ok=True)
        kept = 0
        for found, stat in sorted(_files(path.parent, "[!.]*.npz"), key=lambda entry: -entry[1].st_mtime_ns):
            kept += stat.st_size
            if kept > LARGEST:
                found.unlink(missing_ok=True)


def digest(arrays: Arrays) -> str:
    """Digest of names, types, shapes and bytes of `arrays`, hexadecimal."""
    found = hashlib.blake2b(digest_size=32)
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        found.update(f"{name} {array.dtype.str} {array.shape};".encode())
        found.update(array.reshape(-1).view(np.uint8).data)
    return found.hexdigest()


def answer(make: Callable[[], Made], *of: object) -> Made:
    """What `make` gives, read back where this very code made it `of` the same before; what it raises is not kept.

    An answer is any Python object. It is read back from a file that this user alone can write, and from no other, since reading
    one runs what stands in it.

    Parameters
    ----------
    of : all that the answer depends on, and what it is; values, arrays and dataclasses of these, of a file its `content`
    """
    import joblib

    name = key("answer", {"code": code(), "of": joblib.hash(of)})
    path = _path(name)
    found = load(name) if path is not None and _is_mine(path) else None
    if found is not None:
        with suppress(Exception):  # another Python's
            made: Made = pickle.loads(found["pickle"].tobytes())
            return made
    made = make()
    store(name, {"pickle": np.frombuffer(pickle.dumps(made), dtype=np.uint8)})
    return made


def content(paths: Iterable[Path | str]) -> str:
    """Digest of the bytes of files and of all in folders, with their names inside of these."""
    found = hashlib.sha256()
    for path in map(Path, paths):
        for one in sorted(path.rglob("*")) if path.is_dir() else [path]:
            if one.is_file():
                found.update(f"{one.relative_to(path) if path.is_dir() else ''}\0{one.stat().st_size}\0".encode())
                found.update(one.read_bytes())
    return found.hexdigest()


@functools.cache
def versions() -> dict[str, str]:
    """Of the `LIBRARIES`, "none" of one that is not there."""
    from importlib.metadata import PackageNotFoundError, version

    found = dict.fromkeys(LIBRARIES, "none")
    for library in LIBRARIES:
        with suppress(PackageNotFoundError):
            found[library] = version(library)
    return found


@functools.cache
def code() -> str:
    """Digest of massline's own source, with the tables of its articles and materials."""
    house = Path(__file__).resolve().parents[1]
    kinds = ("*.py", "*.toml", "*.json")  # drawings and materials are as much of an answer as code
    return content(path for room in ROOMS for kind in kinds for path in sorted((house / room).rglob(kind)))


def _path(name: str) -> Path | None:
    there = folder()
    return None if there is None else there / f"{name}.npz"


def _files(there: Path, pattern: str) -> Iterator[tuple[Path, os.stat_result]]:
    for path in there.glob(pattern):
        with suppress(OSError):
            yield path, path.stat()


def _is_mine(path: Path) -> bool:
    """Whether nobody but this user can have written `path` or put it where it is."""
    try:
        stats = [path.stat(), path.parent.stat()]
    except OSError:
        return False
    return os.name == "nt" or all(stat.st_uid == os.getuid() and not stat.st_mode & 0o022 for stat in stats)


def _read_only(items: dict[Any, Any]) -> MappingProxyType[Any, Any]:
    return MappingProxyType(items)


copyreg.pickle(MappingProxyType, lambda view: (_read_only, (dict(view),)))
