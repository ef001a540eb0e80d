"""A table of numbers as programs and people write it in text: any separator, with or without a header, real or complex."""

import csv
import io
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from geometry.errors import BadInput
from identification.files import files
from identification.files.files import DAMAGED, Samples

SEPARATORS = {";": "semicolon", "\t": "tab", ",": "comma", " ": "space"}
"""In the order in which they are tried: a semicolon or a tab is never part of a number."""

MOST_HEAD = 200
"""Lines before the first row of numbers."""

LONGEST = 80
"""Characters of a number."""

_FORTRAN = re.compile(r"(?<=\d)[dD](?=[-+]?\d)")
_SIGNS = {"+-": "-", "-+": "-", "++": "+"}


@dataclass(frozen=True, eq=False, kw_only=True)
class TextTable:
    """Rows of a file.

    Attributes
    ----------
    source : the file
    header : (c,) words above the columns; empty where there are none
    cells : (n) rows of (c) texts, stripped
    first : line of the file [from 1] of the first row
    """

    source: str
    header: tuple[str, ...]
    cells: tuple[tuple[str, ...], ...]
    first: int

    def column(self, name: str, field: str) -> int:
        """Which column has the header `name`, or the number `name` from 1 where there is none.

        Raises
        ------
        BadInput : there is no such column; names those that there are.
        """
        known = self.header or tuple(str(k + 1) for k in range(len(self.cells[0])))
        if known.count(name) == 1:
            return known.index(name)
        problem = f"no column is called {name!r}" if name not in known else f"{known.count(name)} columns are called {name!r}"
        raise BadInput(self.source, field, problem, f"Columns are {', '.join(known)}")

    def numbers(self, column: int) -> Samples:
        """(n,) float64, or complex128 where a cell has an imaginary part.

        Raises
        ------
        BadInput : a cell that holds no finite number, with its line.
        """
        texts = [row[column] for row in self.cells]
        try:
            found = np.array(texts, dtype=np.float64)
        except ValueError:
            found = np.array([self._number(text, row, column) for row, text in enumerate(texts)], dtype=np.complex128)
        if not np.all(np.isfinite(found)):
            row = int(np.argmin(np.isfinite(found)))
            raise self._refused(row, column, f"a finite number is needed, found {texts[row]!r}")
        return found.real if np.iscomplexobj(found) and not any(re.search("[ij]", one) for one in texts) else found

    def _number(self, text: str, row: int, column: int) -> complex:
        made = as_number(text)
        if made is None:
            raise self._refused(row, column, f"a number is needed, found {text[:30]!r}")
        return made

    def _refused(self, row: int, column: int, problem: str) -> BadInput:
        name = self.header[column] if self.header else f"column {column + 1}"
        return BadInput(self.source, name, f"line {self.first + row}: {problem}", DAMAGED)


def as_number(text: str) -> complex | None:
    """The number that `text` is, ``1.5``, ``1,5``, ``1+2j``, ``1+-2i``; None where it is none."""
    plain = text.strip().strip('"').replace(" ", "").replace("*", "")
    if not plain or "_" in plain or len(plain) > LONGEST:
        return None
    if "," in plain and "." not in plain:
        plain = plain.replace(",", ".")
    for twice, sign in _SIGNS.items():
        plain = plain.replace(twice, sign)
    plain = _FORTRAN.sub("e", plain)
    if plain.rstrip(")").endswith(("i", "I")):
        bracket = ")" if plain.endswith(")") else ""
        plain = plain.rstrip(")")[:-1] + "j" + bracket
    try:
        return complex(plain)
    except ValueError:
        return None


def read(path: Path, separator: str = "") -> TextTable:
    """The table in `path`; the separator is the one that is found where none is given.

    Raises
    ------
    BadInput : no text, no rows of numbers, rows of different length (with the line).
    """
    files.require_file(path)
    source = str(path)
    content = path.read_bytes().removeprefix(b"\xef\xbb\xbf")
    wide = content.startswith((b"\xff\xfe", b"\xfe\xff"))  # as spreadsheets write "Unicode text"
    try:
        text = content.decode("utf-16" if wide else "utf-8")
    except UnicodeDecodeError:
        text = content.decode("latin-1")
    if "\0" in text:
        raise BadInput(source, "", "it is no text: it holds zero bytes", "Export the table as CSV")
    lines = [(number, line) for number, line in enumerate(text.splitlines(), start=1) if line.strip()]
    chosen = {"tab": "\t", "space": " ", "comma": ",", "semicolon": ";"}.get(separator, separator)
    start = next((k for k, (_, line) in enumerate(lines[:MOST_HEAD]) if _is_row(line, chosen)), None)
    if start is None:
        raise BadInput(source, "", "no row of numbers is found in it", "State `separator`, or export it again")
    by = chosen or next(one for one in SEPARATORS if _is_row(lines[start][1], one))
    rows = [_cells(line, by) for _, line in lines[start:] if not line.lstrip().startswith(("#", "%"))]
    width = len(rows[0])
    odd = next((k for k, row in enumerate(rows) if len(row) != width), None)
    if odd is not None:
        raise BadInput(source, "", f"line {lines[start + odd][0]} has {len(rows[odd])} columns, the first row {width}", DAMAGED)
    above = [_cells(line.lstrip("#% "), by) for _, line in lines[:start]]
    if above and len(above[-1]) == width and "" in above[-1] and sum(as_number(one) is not None for one in above[-1]) > 1:
        problem = f"line {lines[start - 1][0]}: cell {above[-1].index('') + 1} of {width} is empty"
        raise BadInput(source, "", problem, "A number is needed in each; leave out rows that have none")
    header = next((words for words in reversed(above) if len(words) == width), ())
    return TextTable(source=source, header=tuple(header), cells=tuple(rows), first=lines[start][0])


def _is_row(line: str, separator: str) -> bool:
    """Whether a line is a row of two cells or more, of which most are numbers."""
    if line.lstrip().startswith(("#", "%")):
        return False
    for by in (separator,) if separator else SEPARATORS:
        cells = _cells(line, by)
        numbers = sum(as_number(cell) is not None for cell in cells)
        if len(cells) > 1 and numbers >= max(1, len(cells) - 1):
            return True
    return False


def _cells(line: str, separator: str) -> tuple[str, ...]:
    if separator == " ":
        return tuple(line.split())
    try:
        words = next(csv.reader(io.StringIO(line), delimiter=separator), [])
    except csv.Error:
        return ()
    return tuple(word.strip() for word in words)
