"""Signals of MATLAB: variables named as the channels, ``-`` as ``_``, and ``fs`` [Hz] or ``frequency`` [Hz].

Version 5 (-v7) is read through scipy, version 7.3 is HDF5. Files are written in version 5, packed, so that its checksums tell
damage.
"""

import struct
import zlib
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import numpy as np

from geometry.atomic import write_with
from geometry.errors import BadInput
from geometry.frames import Array
from identification.files import files
from identification.files.files import DAMAGED, LARGEST_BYTES, Samples, Signals
from identification.files.hdf5 import SIGNATURE, datasets, opened, values

# MAT files of version 5, measured before scipy reads them: every element within the file, every array as long as it says.
#
# A variable may only be an array of real or complex floating-point numbers. Cells, structures, characters, sparse arrays,
# functions and objects of MATLAB are refused by their class before anything is made of them. Nothing here or in scipy runs what
# a file holds. Format: MAT-File Format, The MathWorks, level 5.

HEADER = 128
MATRIX, COMPRESSED = 14, 15
DOUBLE, SINGLE = 6, 7
CLASSES = {1: "a cell array", 2: "a structure", 3: "an object", 4: "text", 5: "a sparse array", 16: "a function", 17: "an object"}
"""Classes of variables that hold no signal."""

SIZES = {1: 1, 2: 1, 3: 2, 4: 2, 5: 4, 6: 4, 7: 4, 9: 8, 12: 8, 13: 8, 16: 1, 17: 2, 18: 4}
"""Bytes of a number of each storage type; MATLAB stores doubles that are whole numbers as integers."""

COMPLEX_FLAG = 0x08
"""In the flags of an array, beside its class."""


@dataclass(frozen=True, eq=False, kw_only=True)
class _Order:
    """Byte order of a file: "<" or ">"."""

    sign: str

    def words(self, content: bytes, place: int, count: int) -> tuple[int, ...]:
        return struct.unpack_from(f"{self.sign}{count}I", content, place)


def read_version_5(path: Path) -> dict[str, Samples]:
    """All variables in `path`, as scipy gives them: two dimensions, in the type they are stored in.

    Raises
    ------
    BadInput : no MAT file of version 5, damaged, a variable that is no array of numbers, two of one name.
    """
    from scipy.io import loadmat

    source = str(path)
    # Its compressed elements are unpacked, and all of it is measured
    packed = path.read_bytes()
    if len(packed) < HEADER or packed[124:128] not in (b"\x00\x01IM", b"\x01\x00MI"):
        raise BadInput(source, "", "it is no MAT file of version 5", "Save it with -v7 or -v7.3")
    order = _Order(sign="<" if packed[126:128] == b"IM" else ">")
    pieces, place, names, room = [packed[:HEADER]], HEADER, [], LARGEST_BYTES
    while place < len(packed):
        kind, size = order.words(_enough(packed, place, 8, source), place, 2)
        body = _enough(packed, place + 8, size, source)[place + 8 : place + 8 + size]
        place += 8 + size
        element = struct.pack(f"{order.sign}2I", kind, size) + body
        if kind == COMPRESSED:
            unpacker = zlib.decompressobj()
            try:
                element = unpacker.decompress(body, room)
            except zlib.error as error:
                raise BadInput(source, "", f"a variable cannot be unpacked: {error}", DAMAGED) from None
            if unpacker.unconsumed_tail:
                raise files.too_large(source, room + 1)
            if not unpacker.eof or unpacker.unused_data:
                raise BadInput(source, "", "a packed variable does not end where it says", DAMAGED)
        room -= len(element)
        name = _measured(element, order, source)
        if name in names:
            raise BadInput(source, name, "two variables have this name", "Save each once")
        names.append(name)
        pieces.append(element)
    content = b"".join(pieces)
    try:
        found = loadmat(BytesIO(content))  # mat_dtype=True would drop imaginary parts
    except Exception as error:  # scipy raises TypeError, ValueError, KeyError, struct.error and more
        raise BadInput(source, "", f"it cannot be read as a MAT file: {str(error) or type(error).__name__}", DAMAGED) from None
    return {name: np.asarray(values) for name, values in found.items() if not name.startswith("__")}


def _measured(element: bytes, order: _Order, source: str) -> str:
    """The name of the array in `element`, after flags, dimensions, name and numbers fill it exactly."""
    kind, size = order.words(_enough(element, 0, 8, source), 0, 2)
    if kind != MATRIX or size != len(element) - 8:
        raise BadInput(source, "", f"an element of type {kind} and {size} bytes stands where a variable should", DAMAGED)
    flags, place = _part(element, 8, order, source)
    shape, place = _part(element, place, order, source)
    word, place = _part(element, place, order, source)
    name = word[1].decode("utf-8", errors="replace")

    def refused(problem: str, remedy: str = DAMAGED) -> BadInput:
        return BadInput(source, name, problem, remedy)

    if (flags[0], len(flags[1]), shape[0], word[0]) != (6, 8, 5, 1) or len(shape[1]) % 4:
        raise refused("its head is damaged")
    about = order.words(flags[1], 0, 1)[0]
    array_class, is_complex = about & 0xFF, bool(about >> 8 & COMPLEX_FLAG)
    if array_class not in (DOUBLE, SINGLE):
        what = CLASSES.get(array_class, "an array of whole numbers or of an unknown class")
        raise refused(f"is {what}, where an array of floating-point numbers is needed", "Save arrays of numbers only")
    count = int(np.prod(np.frombuffer(shape[1], f"{order.sign}i4"), dtype=object))
    for _ in range(1 + is_complex):
        numbers, place = _part(element, place, order, source)
        if numbers[0] not in SIZES or len(numbers[1]) != count * SIZES[numbers[0]]:
            raise refused(f"declares {count} numbers, and other bytes follow")
    if place != len(element):
        raise refused("does not end where it says")
    return name


def _part(element: bytes, place: int, order: _Order, source: str) -> tuple[tuple[int, bytes], int]:
    """Type and bytes of the part at `place`, long or short form, and where the next one begins."""
    first = order.words(_enough(element, place, 8, source), place, 1)[0]
    if first >> 16:
        size = first >> 16
        if size > 4:
            raise BadInput(source, "", "a short element is too long", DAMAGED)
        return (first & 0xFFFF, element[place + 4 : place + 4 + size]), place + 8
    size = order.words(element, place + 4, 1)[0]
    start = place + 8
    padded = -(-size // 8) * 8
    return (first, _enough(element, start, padded, source)[start : start + size]), start + padded


def _enough(content: bytes, place: int, size: int, source: str) -> bytes:
    if place + size > len(content):
        raise BadInput(source, "", f"it ends at byte {len(content)} in the middle of a variable", DAMAGED)
    return content


ENDINGS = (".mat",)

V73 = 512
"""Bytes before the HDF5 part of a file of version 7.3."""

LONGEST_NAME = 63
"""Characters of a variable of MATLAB."""


def variables(path: Path) -> dict[str, Samples]:
    """All variables in `path`, of two dimensions.

    Raises
    ------
    BadInput : no MAT file, damaged, a variable that is no array of numbers.
    """
    source = str(path)
    with path.open("rb") as file:
        head = file.read(V73 + 8)
    if head[V73:] == SIGNATURE:
        with opened(path) as hdf5:
            import h5py

            for name in hdf5:  # MATLAB's own word for what is no array of numbers; `datasets` refuses what has no such word
                is_own = isinstance(hdf5.get(name, getlink=True), h5py.HardLink)
                word = hdf5[name].attrs.get("MATLAB_class") if is_own else None
                if word is not None and bytes(word) not in (b"double", b"single"):
                    said = bytes(word).decode("utf-8", errors="replace")
                    problem = f"is of class {said!r}, where an array of numbers is needed"
                    raise BadInput(source, name, problem, "Save arrays of numbers only")
            # Its last index runs first in the file
            return {name: values(one, name, source).T for name, one in datasets(hdf5, source).items()}
    return read_version_5(path)


def read(path: Path) -> Signals:
    """The signals in `path`, under the names of their variables.

    Raises
    ------
    BadInput : no MAT file, damaged, variables that are no vectors of numbers, no axis or two.
    """
    files.require_file(path)
    source = str(path)
    found = variables(path)
    axes = {name: found.pop(name) for name in ("fs", "frequency") if name in found}
    samples = {name: _vector(numbers, name, source) for name, numbers in found.items()}
    if len(axes) != 1:
        problem = f"one variable fs or frequency is needed, found {'both' if axes else 'neither'}"
        raise BadInput(source, "fs", problem, "Save the one that fits the data")
    if "fs" in axes:
        files.require_one_length(samples, None, source)
        rate = np.asarray(axes["fs"]).ravel()
        if rate.size != 1 or np.iscomplexobj(rate) or not 0 < rate[0] < np.inf:
            raise BadInput(source, "fs", "must be one positive number", DAMAGED)
        return Signals(source=source, samples=samples, sampling_rate=float(rate[0]))
    lines = _vector(axes["frequency"], "frequency", source).real.astype(np.float64)
    files.require_lines(lines, source, "frequency")
    files.require_one_length(samples, len(lines), source)
    return Signals(source=source, samples=samples, frequency=lines)


def write(path: Path, signals: Signals) -> None:
    """Write `signals` to `path` in version 5, whole or not at all.

    Raises
    ------
    BadInput : a channel whose name is no variable of MATLAB, or two that become the same one.
    """
    from scipy.io import savemat

    variables = variables_of(signals, str(path))
    write_with(path, lambda temporary: savemat(temporary, variables, do_compression=True, oned_as="column", appendmat=False))


def _vector(numbers: Samples, name: str, source: str) -> Samples:
    if numbers.ndim > 2 or (numbers.ndim == 2 and 1 not in numbers.shape):
        shape = " x ".join(map(str, numbers.shape))
        raise BadInput(source, name, f"must be a vector, found {shape}", "Save one vector a channel")
    return numbers.ravel().astype(np.complex128 if np.iscomplexobj(numbers) else np.float64)


def variables_of(signals: Signals, source: str) -> dict[str, float | Array | Samples]:
    """By name in MATLAB what a file of `signals` holds."""
    found: dict[str, float | Array | Samples] = {}
    if signals.sampling_rate is not None:
        found["fs"] = float(signals.sampling_rate)
    if signals.frequency is not None:
        found["frequency"] = np.asarray(signals.frequency)[:, None]
    for name, samples in signals.samples.items():
        called = files.variable(name)
        good = called.isidentifier() and called.isascii() and called[0] != "_" and len(called) <= LONGEST_NAME
        if not good or called in found or called in ("fs", "frequency"):
            problem = f"cannot be a variable of MATLAB: {called!r}" + (" is another one already" if called in found else "")
            raise BadInput(source, name, problem, "Rename the channel, or write .h5")
        found[called] = samples[:, None]
    return found
