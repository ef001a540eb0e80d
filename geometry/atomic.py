"""Files and folders that are there whole or not at all."""

import errno
import os
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path


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
