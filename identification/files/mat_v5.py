"""MAT files of version 5, measured before scipy reads them: every element within the file, every array as long as it says.

A variable may only be an array of real or complex floating-point numbers. Cells, structures, characters, sparse arrays, functions
and objects of MATLAB are refused by their class before anything is made of them. Nothing here or in scipy runs what a file holds.
Format: MAT-File Format, The MathWorks, level 5.
"""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import numpy as np

from geometry.errors import BadInput
from identification.files.contents import DAMAGED, LARGEST_BYTES, Samples, too_large

HEADER = 128
MATRIX, COMPRESSED = 14, 15
DOUBLE, SINGLE = 6, 7
CLASSES = {
    1: "a cell array",
    2: "a structure",
    3: "an object",
    4: "text",
    5: "a sparse array",
    16: "a function",
    17: "an object",
}
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


def read(path: Path) -> dict[str, Samples]:
    """All variables in `path`, as scipy gives them: two dimensions, in the type they are stored in.

    Raises
    ------
    BadInput : no MAT file of version 5, damaged, a variable that is no array of numbers, two of one name.
    """
    from scipy.io import loadmat

    source = str(path)
    content = _unpacked(path.read_bytes(), source)
    try:
        found = loadmat(BytesIO(content))  # mat_dtype=True would drop imaginary parts
    except Exception as error:  # scipy raises TypeError, ValueError, KeyError, struct.error and more
        problem = f"it cannot be read as a MAT file: {str(error) or type(error).__name__}"
        raise BadInput(source=source, problem=problem, remedy=DAMAGED) from None
    return {name: np.asarray(values) for name, values in found.items() if not name.startswith("__")}


def _unpacked(content: bytes, source: str) -> bytes:
    """`content` with its compressed elements unpacked, all of it measured."""
    if len(content) < HEADER or content[124:128] not in (b"\x00\x01IM", b"\x01\x00MI"):
        raise BadInput(source=source, problem="it is no MAT file of version 5", remedy="Save it with -v7 or -v7.3")
    order = _Order(sign="<" if content[126:128] == b"IM" else ">")
    pieces, place, names, room = [content[:HEADER]], HEADER, [], LARGEST_BYTES
    while place < len(content):
        kind, size = order.words(_enough(content, place, 8, source), place, 2)
        body = _enough(content, place + 8, size, source)[place + 8 : place + 8 + size]
        place += 8 + size
        element = _inflated(body, room, source) if kind == COMPRESSED else struct.pack(f"{order.sign}2I", kind, size) + body
        room -= len(element)
        name = _measured(element, order, source)
        if name in names:
            raise BadInput(source=source, field=name, problem="two variables have this name", remedy="Save each once")
        names.append(name)
        pieces.append(element)
    return b"".join(pieces)


def _inflated(packed: bytes, room: int, source: str) -> bytes:
    unpacker = zlib.decompressobj()
    try:
        element = unpacker.decompress(packed, room)
    except zlib.error as error:
        raise BadInput(source=source, problem=f"a variable cannot be unpacked: {error}", remedy=DAMAGED) from None
    if unpacker.unconsumed_tail:
        raise too_large(source, room + 1)
    if not unpacker.eof or unpacker.unused_data:
        raise BadInput(source=source, problem="a packed variable does not end where it says", remedy=DAMAGED)
    return element


def _measured(element: bytes, order: _Order, source: str) -> str:
    """The name of the array in `element`, after flags, dimensions, name and numbers fill it exactly."""
    kind, size = order.words(_enough(element, 0, 8, source), 0, 2)
    if kind != MATRIX or size != len(element) - 8:
        problem = f"an element of type {kind} and {size} bytes stands where a variable should"
        raise BadInput(source=source, problem=problem, remedy=DAMAGED)
    flags, place = _part(element, 8, order, source)
    shape, place = _part(element, place, order, source)
    word, place = _part(element, place, order, source)
    name = word[1].decode("utf-8", errors="replace")

    def refused(problem: str, remedy: str = DAMAGED) -> BadInput:
        return BadInput(source=source, field=name, problem=problem, remedy=remedy)

    if (flags[0], len(flags[1]), shape[0], word[0]) != (6, 8, 5, 1) or len(shape[1]) % 4:
        raise refused("its head is damaged")
    about = order.words(flags[1], 0, 1)[0]
    array_class, is_complex = about & 0xFF, bool(about >> 8 & COMPLEX_FLAG)
    if array_class not in (DOUBLE, SINGLE):
        what = CLASSES.get(array_class, "an array of whole numbers or of an unknown class")
        raise refused(f"is {what}, where a vector of floating-point numbers is needed", "Save signals and fs or frequency only")
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
            raise BadInput(source=source, problem="a short element is too long", remedy=DAMAGED)
        return (first & 0xFFFF, element[place + 4 : place + 4 + size]), place + 8
    size = order.words(element, place + 4, 1)[0]
    start = place + 8
    padded = -(-size // 8) * 8
    return (first, _enough(element, start, padded, source)[start : start + size]), start + padded


def _enough(content: bytes, place: int, size: int, source: str) -> bytes:
    if place + size > len(content):
        raise BadInput(source=source, problem=f"it ends at byte {len(content)} in the middle of a variable", remedy=DAMAGED)
    return content
