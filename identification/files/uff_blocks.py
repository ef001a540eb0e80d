"""The datasets of a universal file, told apart and measured before anybody reads numbers from them.

pyuff looks for the end of a dataset by its sign and takes as many numbers as it finds. Here every dataset 58 must have exactly
the numbers that its header promises, in fields of the width that the format has, so that a byte too many or too few is noticed.
What has been measured is read at once, an order of magnitude faster than line by line.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np

from geometry.arrays import Array
from geometry.errors import BadInput
from identification.files.contents import DAMAGED

MARK = b"    -1"
HEADER = 11
"""Lines of a dataset 58 before its numbers, behind the line that says 58."""

REAL, COMPLEX = (2, 4), (5, 6)
SINGLE = (2, 5)
"""Ordinate data types."""

_LINE_END = re.compile(rb"\r?\n")
_MARK_LINE = re.compile(rb"(?:^|(?<=\n))    -1[ ]*\r?(?:\n|$)")
_CLOSING = re.compile(rb"(?:\r?\n)?    -1[ ]*\r?(?:\n|$)")
_NUMBERS = re.compile(rb"[-+0-9eE. nafiNAFI\r\n]*")


@dataclass(frozen=True, eq=False, kw_only=True)
class Block:
    """One dataset.

    Attributes
    ----------
    number : its type, 58 for a function
    index : which dataset of the file it is, from 0
    lines : its lines without the numbers of a function, behind the line with the type
    numbers : of a function, as they stand in the file: every ordinate, complex ones as pairs, behind its abscissa if uneven
    warnings : what is odd about it, in words
    """

    number: int
    index: int
    lines: tuple[str, ...]
    numbers: Array = field(default_factory=lambda: np.zeros(0))
    warnings: tuple[str, ...] = ()


def blocks(content: bytes, source: str) -> list[Block]:
    """All datasets in `content`.

    Raises
    ------
    BadInput : something outside of a dataset, a dataset that does not end, a function with other numbers than it promises.
    """
    found: list[Block] = []
    place = 0
    while (place := _skipped(content, place)) < len(content):
        block, place = _block(content, place, len(found), source)
        found.append(block)
    if not found:
        raise BadInput(source=source, problem="it is no universal file: it holds no dataset", remedy=DAMAGED)
    return found


def column(line: str, start: int, width: int, kind: type[int] | type[float], what: str, source: str) -> float:
    """The number in columns `start` on of `line`.

    Raises
    ------
    BadInput : there is none.
    """
    text = line[start : start + width].strip()
    try:
        if "_" in text:
            raise ValueError
        return kind(text)
    except ValueError:
        raise BadInput(source=source, field=what, problem=f"must be a number, found {text!r}", remedy=DAMAGED) from None


def _skipped(content: bytes, place: int) -> int:
    """Past empty lines."""
    while place < len(content) and content[place : place + 1] in b" \r\n" and content[place : place + 6] != MARK:
        place += 1
    return place


def _block(content: bytes, place: int, index: int, source: str) -> tuple[Block, int]:
    opening = _MARK_LINE.match(content, place)
    if opening is None:
        found = content[place : place + 20]
        problem = f"byte {place + 1} stands outside of any dataset, at {found.decode('utf-8', errors='replace')!r}"
        raise BadInput(source=source, problem=problem, remedy=DAMAGED)
    identity, place = _line(content, opening.end(), source)
    number = int(column(identity, 0, 6, int, f"dataset {index + 1}", source))
    if number == 58:
        return _function(content, place, identity, index, source)
    closing = _next_mark(content, place)
    if closing is None:
        raise _unfinished(index, source)
    lines = content[place : closing.start()].decode("utf-8", errors="replace").splitlines()
    return Block(number=number, index=index, lines=tuple(lines)), closing.end()


def _function(content: bytes, place: int, identity: str, index: int, source: str) -> tuple[Block, int]:
    lines = []
    for _ in range(HEADER):
        line, place = _line(content, place, source)
        lines.append(line)
    name = lines[0].strip() or f"dataset {index + 1}"
    kind, count, even = (int(column(lines[6], start, 10, int, name, source)) for start in (0, 10, 20))
    if kind not in REAL + COMPLEX or even not in (0, 1) or count < 0:
        problem = f"has the ordinate data type {kind}, {count} values and abscissa spacing {even}, which no dataset 58 has"
        raise BadInput(source=source, field=name, problem=problem, remedy=DAMAGED)
    numbers = count * ((2 if kind in COMPLEX else 1) + (1 - even))
    if identity[6:7].lower() == "b":
        found, end, warnings = _binary(content, place, identity, numbers, 4 if kind in SINGLE else 8, name, source)
    else:
        (found, end), warnings = _ascii(content, place, _widths(kind, even), numbers, name, source), ()
    closing = _CLOSING.match(content, end)
    if closing is None:
        problem = f"does not end behind the {count} values that it promises"
        raise BadInput(source=source, field=name, problem=problem, remedy=DAMAGED)
    return Block(number=58, index=index, lines=tuple(lines), numbers=found, warnings=warnings), closing.end()


def _binary(
    content: bytes, place: int, identity: str, count: int, width: int, name: str, source: str
) -> tuple[Array, int, tuple[str, ...]]:
    """`count` numbers of `width` bytes, where they end, and a word about the bytes that are stated."""
    size = count * width
    order, floats = (int(column(identity, start, 6, int, name, source)) for start in (7, 13))
    stated = int(column(identity, 31, 12, int, name, source))
    if order not in (1, 2) or floats != 2:
        problem = f"has byte order {order} and floating-point format {floats}, where 1 or 2 and 2 (IEEE 754) are read"
        raise BadInput(source=source, field=name, problem=problem, remedy="Export it with IEEE 754 numbers, or as ASCII")
    if place + size > len(content):
        raise BadInput(source=source, field=name, problem=f"promises {count} numbers, and the file ends before", remedy=DAMAGED)
    numbers = np.frombuffer(content, f"{'<' if order == 1 else '>'}f{width}", count, place).astype(np.float64)
    if stated == size:
        return numbers, place + size, ()
    if stated * 2 != size:
        problem = f"states {stated} bytes of numbers, and its header promises {size}"
        raise BadInput(source=source, field=name, problem=problem, remedy=DAMAGED)
    word = f"{source}: {name} states half of its bytes, as pyuff writes complex numbers; all of them were read"
    return numbers, place + size, (word,)


def _ascii(content: bytes, place: int, widths: list[int], count: int, name: str, source: str) -> tuple[Array, int]:
    """`count` numbers and where they end, after every line was measured."""
    closing = _next_mark(content, place)
    if closing is None:
        raise BadInput(source=source, field=name, problem="does not end", remedy=DAMAGED)
    body = content[place : closing.start()]
    if _NUMBERS.fullmatch(body) is None:
        raise BadInput(source=source, field=name, problem="holds something that is no number", remedy=DAMAGED)
    ends = [sum(widths[: k + 1]) for k in range(len(widths))]
    found, rows = 0, [row.rstrip(b" \r") for row in body.rstrip(b"\r\n").split(b"\n")] if count else []
    for k, row in enumerate(rows):
        length = len(row)
        if length not in ends or (length != ends[-1] and k + 1 < len(rows)):
            problem = f"line {k + 1} of its numbers has {length} characters where fields end at {', '.join(map(str, ends))}"
            raise BadInput(source=source, field=name, problem=problem, remedy=DAMAGED)
        found += ends.index(length) + 1
    if found != count:
        raise BadInput(source=source, field=name, problem=f"promises {count} numbers, found {found}", remedy=DAMAGED)
    return _fields(rows, widths, name, source), closing.start()


def _fields(rows: list[bytes], widths: list[int], name: str, source: str) -> Array:
    """All fields of measured `rows`."""
    group = widths[:1] if len(set(widths)) == 1 else widths[: 3 if len(widths) == 3 else 2]
    try:
        cells = np.frombuffer(b"".join(rows), [(f"f{k}", f"S{width}") for k, width in enumerate(group)])
        return np.column_stack([cells[f"f{k}"].astype(np.float64) for k in range(len(group))]).ravel()
    except ValueError as error:
        raise BadInput(source=source, field=name, problem=f"holds something that is no number: {error}", remedy=DAMAGED) from None


def _widths(kind: int, even: int) -> list[int]:
    """Widths of the fields of a full line."""
    if kind in SINGLE:
        return [13] * 6
    if even:
        return [20] * 4
    return [13, 20, 13, 20] if kind in REAL else [13, 20, 20]


def _line(content: bytes, place: int, source: str) -> tuple[str, int]:
    end = _LINE_END.search(content, place, place + 1000)
    if end is None:
        raise BadInput(source=source, problem=f"a header is cut short at byte {place + 1}", remedy=DAMAGED)
    return content[place : end.start()].decode("utf-8", errors="replace"), end.end()


def _next_mark(content: bytes, place: int) -> re.Match[bytes] | None:
    """The first line from `place` on that holds nothing but the mark."""
    while (place := content.find(MARK, place)) >= 0:
        found = _MARK_LINE.match(content, place)
        if found is not None:
            return found
        place += 1
    return None


def _unfinished(index: int, source: str) -> BadInput:
    return BadInput(source=source, problem=f"dataset {index + 1} does not end", remedy=DAMAGED)
