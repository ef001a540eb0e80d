"""Signals in HDF5: one dataset a channel in ``/channels/<name>``, and the axis at the root.

Time histories have the attribute ``sampling_rate`` [Hz] on the root, spectra the dataset ``/frequency`` [Hz]. Files written here
carry checksums of samples and structure: a byte that changes on the way is noticed.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from geometry.atomic import write_with
from geometry.errors import BadInput
from identification.files import files
from identification.files.files import DAMAGED, LARGEST_BYTES, Samples, Signals

# HDF5 that may come from anywhere: opened, and one dataset read, without believing more than the file can vouch for.
#
# The library follows links into other files, fills what was never written with zeros, and reads whatever stands where a damaged
# address points. All of that is looked at before.

SIGNATURE = b"\x89HDF\r\n\x1a\n"

MOST_CHUNKS = 100_000
"""Pieces of one dataset; ten times what the smallest sensible ones need."""

_OWN_DATA = "Copy what it points to into this file"
_FILTERS = {1: "deflate", 2: "shuffle", 3: "fletcher32"}
"""Filters that are known here, by their number in the format; others lose digits or need plug-ins."""


@contextmanager
def opened(path: Path) -> Iterator[Any]:
    """The file, open for reading; whatever the library says of damaged bytes becomes a sentence.

    Raises
    ------
    BadInput : no HDF5, of another length than it says, or damaged.
    """
    import h5py

    # The file is as long as its superblock says: a stretch that was lost, or came twice, shifts all that follows it
    with path.open("rb") as raw:
        head = raw.read(8192)
    start = next((k for k in (0, 512, 1024, 2048, 4096) if head[k : k + 8] == SIGNATURE), None)
    if start is None:
        raise BadInput(str(path), "", "it cannot be read as HDF5: it does not begin so", DAMAGED)
    block = head[start : start + 64].ljust(64, b"\0")
    field, width = (40 if block[8] < 2 else 28) + 4 * (block[8] == 1), block[13] if block[8] < 2 else block[9]
    stated, found = int.from_bytes(block[field : field + 8], "little"), path.stat().st_size
    if width == 8 and stated != found:
        problem = f"it cannot be read as HDF5: it says that it is {stated} bytes long, found {found}"
        raise BadInput(str(path), "", problem, DAMAGED)
    try:
        with h5py.File(path, "r") as file:
            yield file
    except (BadInput, KeyboardInterrupt):
        raise
    except Exception as error:  # h5py raises OSError, KeyError, RuntimeError, ValueError and more on damaged bytes
        first = next(iter(str(error).splitlines()), type(error).__name__)
        raise BadInput(str(path), "", f"it cannot be read as HDF5: {first}", DAMAGED) from None


def datasets(group: Any, source: str) -> dict[str, Any]:
    """The numeric datasets that lie directly in `group`, by name.

    Raises
    ------
    BadInput : a link or storage outside the file, anything but datasets of floating-point numbers, or more than can be held.
    """
    found = {name: dataset(group, name, source) for name in group}
    total = sum(int(one.size or 0) * one.dtype.itemsize for one in found.values())
    if total > LARGEST_BYTES:
        raise files.too_large(source, total)
    from h5py import h5o

    # No two datasets share bytes of the file, nor do numbers and the heads of datasets
    heads = [(h5o.get_info(one.id).addr, 1, f"the head of {name}") for name, one in found.items()]
    ranges = sorted(
        heads
        + [
            (one.id.get_offset(), one.id.get_storage_size(), name)
            for name, one in found.items()
            if one.chunks is None and one.id.get_offset() is not None
        ]
    )
    for (start, size, name), (after, _, other) in pairwise(ranges):
        if start + size > after:
            raise BadInput(source, other, f"lies in the bytes of {name}", DAMAGED)
    return found


def dataset(group: Any, name: str, source: str) -> Any:
    """The dataset `name` of `group`, when all of it lies in the file and holds floating-point numbers.

    Raises
    ------
    BadInput : it does not.
    """
    import h5py

    def refused(problem: str, remedy: str) -> BadInput:
        return BadInput(source, name, problem, remedy)

    link = group.get(name, getlink=True)
    if not isinstance(link, h5py.HardLink):
        raise refused("is a link, which is not followed", _OWN_DATA)
    entry = group[name]
    if not isinstance(entry, h5py.Dataset):
        raise refused("is no dataset", "Put one dataset a channel there")
    if entry.external or entry.is_virtual:
        raise refused("has its numbers in another file", _OWN_DATA)
    # The type in the file is the standard one, bit by bit: with a damaged one, other numbers would be read
    if not _is_plain(entry.dtype) or not any(
        entry.id.get_type().equal(h5py.h5t.py_create(entry.dtype.newbyteorder(sign))) for sign in "<>"
    ):
        raise refused(f"must hold floating-point numbers, found the type {entry.dtype}", "Write it as 64-bit floating point")
    if int(entry.size or 0) * entry.dtype.itemsize > LARGEST_BYTES:
        raise files.too_large(source, int(entry.size) * entry.dtype.itemsize)
    return entry


def values(entry: Any, name: str, source: str) -> Samples:
    """All numbers of a dataset, as float64 or complex128.

    Raises
    ------
    BadInput : numbers that are declared but were never written, or a storage that does not fit what is declared.
    """
    if entry.size:
        _require_written(entry, name, source)
    numbers = np.asarray(entry[()])
    if numbers.dtype.names:
        numbers = files.as_complex(*(numbers[part] for part in numbers.dtype.names))
    return numbers.astype(np.complex128 if numbers.dtype.kind == "c" else np.float64, copy=False)


def number(group: Any, name: str, source: str) -> float:
    """The attribute `name` of `group`, one finite number.

    Raises
    ------
    BadInput : it is something else.
    """
    plain = group.attrs.get_id(name).dtype.kind in "fiu"  # the library fails on other, damaged types in ways nobody can catch
    value = np.asarray(group.attrs[name]) if plain else np.zeros(0)
    if value.size != 1 or value.dtype.kind not in "fiu" or not np.isfinite(value.item()):
        problem = f"must be one finite number, found {value.tolist()!r}"
        raise BadInput(source, name, problem[:200], "Write it as one number")
    return float(value.item())


def _is_plain(dtype: Any) -> bool:
    """Real or complex IEEE numbers of four or eight bytes a part, complex also as MATLAB's pair of fields."""
    if dtype.names:
        parts = [dtype[name] for name in dtype.names]
        return dtype.names in (("real", "imag"), ("r", "i")) and parts[0] == parts[1] and _is_plain(parts[0])
    return dtype.kind in "fc" and dtype.itemsize in ((4, 8) if dtype.kind == "f" else (8, 16))


def _require_written(entry: Any, name: str, source: str) -> None:
    def refused(problem: str) -> BadInput:
        return BadInput(source, name, problem, DAMAGED)

    steps = entry.chunks  # asked of the file each time
    if steps is None:
        if entry.id.get_storage_size() != entry.size * entry.dtype.itemsize:
            raise refused(f"declares {entry.size} samples, but they were never written")
        return
    counts = [-(-side // step) for side, step in zip(entry.shape, steps, strict=True)]
    expected, found = int(np.prod(counts, dtype=object)), entry.id.get_num_chunks()
    if found != expected or expected > MOST_CHUNKS:
        raise refused(f"declares {entry.size} samples in {expected} pieces, found {found}")
    corners = (tuple(at * step for at, step in zip(place, steps, strict=True)) for place in np.ndindex(*counts))
    plain = int(np.prod(steps)) * entry.dtype.itemsize
    properties = entry.id.get_create_plist()
    filters = [properties.get_filter(k) for k in range(properties.get_nfilters())]
    for code, _, parameters, _ in filters:
        if code not in _FILTERS:
            raise refused(f"is packed by filter {code}, where {', '.join(_FILTERS.values())} are known")
        if code == 2 and tuple(parameters[:1]) != (entry.dtype.itemsize,):
            raise refused("is shuffled by another size than that of its numbers")
    for corner in corners:
        left_out, _ = entry.id.read_direct_chunk(corner)  # fails where reading the numbers would fill in zeros
        if left_out or not (filters or entry.id.get_chunk_info_by_coord(corner).size == plain):
            raise refused("is stored otherwise than it says")


ENDINGS = (".h5", ".hdf5")


def read(path: Path) -> Signals:
    """The signals in `path`.

    Raises
    ------
    BadInput : no HDF5, damaged, links, no channels, no axis or two, channels of different lengths or of more dimensions than one.
    """
    files.require_file(path)
    source = str(path)
    with opened(path) as file:
        import h5py

        link = file.get("channels", getlink=True) if "channels" in file else None
        if not isinstance(link, h5py.HardLink) or not isinstance(file["channels"], h5py.Group):
            problem = "must be a group with one dataset a channel, found " + ("none" if link is None else "something else")
            raise BadInput(source, "channels", problem, "Write /channels/<name>")
        group = file["channels"]
        samples = {
            name: _one_dimensional(values(one, name, source), name, source) for name, one in datasets(group, source).items()
        }
        rate = number(file, "sampling_rate", source) if "sampling_rate" in file.attrs else None
        lines = values(dataset(file, "frequency", source), "frequency", source) if "frequency" in file else None
    if (rate is None) == (lines is None):
        found = "neither" if rate is None else "both"
        problem = f"an attribute `sampling_rate` of the root or a dataset /frequency is needed, found {found}"
        raise BadInput(source, "sampling_rate", problem, "Write the one that fits the data")
    if rate is not None and rate <= 0:
        raise BadInput(source, "sampling_rate", f"must be positive, found {rate:g}", "Correct it")
    if lines is not None:
        lines = _one_dimensional(lines, "frequency", source).real
        files.require_lines(lines, source, "frequency")
    files.require_one_length(samples, None if lines is None else len(lines), source)
    return Signals(source=source, samples=samples, sampling_rate=rate, frequency=lines)


def write(path: Path, signals: Signals) -> None:
    """Write `signals` to `path`, whole or not at all."""
    write_with(path, lambda temporary: _fill(temporary, signals))


def _fill(path: Path, signals: Signals) -> None:
    import h5py

    with h5py.File(path, "w", libver=("v110", "v110")) as file:
        packed = {"compression": "gzip", "compression_opts": 4, "shuffle": True, "fletcher32": True}
        if signals.frequency is None:
            file.attrs["sampling_rate"] = signals.sampling_rate
        else:
            file.create_dataset("frequency", data=signals.frequency, **packed)
        group = file.create_group("channels", track_order=True)
        for name, samples in signals.samples.items():
            entry = group.create_dataset(name, data=samples, **packed)
            if name in signals.labels:
                entry.attrs["unit"] = signals.labels[name]


def _one_dimensional(found: Samples, name: str, source: str) -> Samples:
    if found.ndim != 1:
        shape = " x ".join(map(str, found.shape)) or "a single number"
        raise BadInput(source, name, f"must have one dimension, found {shape}", "Write it as a vector")
    return found
