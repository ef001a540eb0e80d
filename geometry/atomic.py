"""Files and folders that are there whole or not at all; arrays of an ``.npz``, never unpickled, no larger than its list says."""

import errno
import os
import shutil
import tempfile
import zipfile
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any

from geometry.errors import BadInput


def write_text(path: Path, text: str) -> None:
    """Write `text` (UTF-8) to `path`; an interruption leaves the old file or none."""
    write_with(path, lambda temporary: temporary.write_text(text, encoding="utf-8"))


def write_with(path: Path, write: Callable[[Path], object]) -> None:
    """Let `write` fill a temporary file of the same ending beside `path`, then rename it into place.

    A link stays a link, and what it points to is replaced.

    Raises
    ------
    OSError : `path` cannot be written, or is there and no regular file; it names `path`, not the temporary file.
    """
    try:
        target = _target(path)
        target.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=f".{target.stem}-", suffix=target.suffix, dir=target.parent)
        os.close(handle)
        temporary = Path(name)
        try:
            write(temporary)
            temporary.chmod(0o644)
            temporary.replace(target)
        finally:
            temporary.unlink(missing_ok=True)
    except OSError as error:
        raise OSError(error.errno, error.strerror or str(error), str(path)) from error


def write_folder(folder: Path, fill: Callable[[Path], object]) -> None:
    """Let `fill` fill a temporary folder beside `folder`, then rename it into place; what was in `folder` is gone then.

    Raises
    ------
    OSError : `folder` cannot be written.
    """
    target = folder.resolve()
    target.parent.mkdir(parents=True, exist_ok=True)
    temporary = Path(tempfile.mkdtemp(prefix=f".{target.name}-", dir=target.parent))
    new, old = temporary / "new", temporary / "old"
    try:
        new.mkdir()
        fill(new)
        if target.exists():
            target.rename(old)
        try:
            new.rename(target)
        except BaseException:  # all is left as it was
            if old.exists():
                old.rename(target)
            raise
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def probe(path: Path) -> None:
    """Try whether `write_with` could write the file `path`, before anything is computed for it; nothing is left behind.

    Raises
    ------
    OSError : it could not; see `write_with` and `probe_folder`.
    """
    probe_folder(_target(path).parent)


def probe_folder(folder: Path) -> None:
    """Try whether files could be written into `folder`; nothing is left behind.

    A folder that is missing need not be made yet, but the one that it would lie in must be there; below the working folder, where
    ``out/swing`` is meant, both may be missing.

    Raises
    ------
    OSError : there is no such folder, or nothing can be written into it.
    """
    there = folder if folder.exists() else folder.resolve().parent
    if not there.exists() and there.is_relative_to(Path.cwd()):
        there = next(parent for parent in there.parents if parent.exists())
    handle, name = tempfile.mkstemp(prefix=".probe-", dir=there)
    os.close(handle)
    Path(name).unlink()


def _target(path: Path) -> Path:
    """The regular file, there or not yet, that `path` means."""
    target = path.resolve()
    if target.is_dir():
        raise OSError(errno.EISDIR, "this is a folder, a file name is expected")
    if target.exists() and not target.is_file():
        raise OSError(errno.EINVAL, "this is no regular file, which alone can be replaced whole")
    return target


# NumPy is imported where it is needed: what only writes text does without.


_WRITE_AGAIN = "Write it again with numpy.savez_compressed"


def read_npz(path: Path, largest: int, wanted: Collection[str] | None = None) -> dict[str, Any]:
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
                raise BadInput(source=source, problem="it holds no arrays", remedy=_WRITE_AGAIN)
            if len(set(names)) < len(names):
                raise BadInput(source=source, problem="it holds two arrays of one name", remedy=_WRITE_AGAIN)
            chosen = {name: one for name, one in zip(names, entries, strict=True) if wanted is None or name in wanted}
            total = sum(entry.file_size for entry in chosen.values())
            if total > largest:
                problem = f"its arrays would take {total / 2**30:.3g} GiB, more than {largest / 2**30:.3g}"
                raise BadInput(source=source, problem=problem, remedy="Leave out of it what is not needed")
            found = {name: _array(archive, entry, name, source) for name, entry in chosen.items()}
            return {name: values for name, values in found.items() if values is not None}
    except BadInput:
        raise
    except Exception as error:  # zipfile, zlib and NumPy raise a dozen kinds of their own on damaged bytes
        problem = f"it cannot be read as .npz: {type(error).__name__}, {error}"
        raise BadInput(source=source, problem=problem, remedy=f"{_WRITE_AGAIN}; it may be cut short or damaged") from None


def _array(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, name: str, source: str) -> Any:
    """One array, its header compared with what follows it before memory is asked for; None for a lone Python object."""
    import numpy as np

    with archive.open(entry) as file:
        version = np.lib.format.read_magic(file)
        header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, _, dtype = header(file)
        if dtype.hasobject and shape == ():  # None, which NumPy writes so
            return None
        if dtype.hasobject:
            problem = "holds Python objects, which only pickle could read, and that could run anything"
            raise BadInput(source=source, field=name, problem=problem, remedy="Save an array of numbers")
        declared = int(np.prod([int(side) for side in shape], dtype=object)) * dtype.itemsize
        if declared != entry.file_size - file.tell():
            problem = f"declares {declared} bytes where {entry.file_size - file.tell()} follow"
            raise BadInput(source=source, field=name, problem=problem, remedy=_WRITE_AGAIN)
    with archive.open(entry) as file:
        return np.lib.format.read_array(file, allow_pickle=False)
