"""A table of numbers as programs and people write it in text: any separator, with or without a header, real or complex."""

import csv
import io
import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from geometry import toml_file
from geometry.errors import BadInput
from geometry.frames import Array
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

    def unit(self, column: int) -> str:
        """The unit in brackets at the end of its header; empty where there is none."""
        found = re.search(r"[\[(]([^\[\]()]*|\S*)[\])]$", self.header[column]) if self.header else None
        unit = found[1].strip() if found else ""
        return unit if unit == "%" or toml_file.is_unit(plain(unit)) else ""

    def real(self, column: int, units: Mapping[str, float], field: str) -> Array:
        """(n,) numbers times what the unit of their header is among `units`, in lower case; BadInput where it is another."""
        unit = self.unit(column).lower()
        if unit and unit not in units:
            raise BadInput(self.source, field, f"is in {unit!r}, where {', '.join(units)} are read", "Convert that column")
        return units.get(unit, 1.0) * self.numbers(column).real.astype(np.float64)

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
            made = [as_number(text) for text in texts]
            if None in made:
                row = made.index(None)
                raise self._refused(row, column, f"a number is needed, found {texts[row][:30]!r}") from None
            found = np.array(made, dtype=np.complex128)
        if not np.all(np.isfinite(found)):
            row = int(np.argmin(np.isfinite(found)))
            raise self._refused(row, column, f"a finite number is needed, found {texts[row]!r}")
        return found.real if np.iscomplexobj(found) and not any(re.search("[ij]", one) for one in texts) else found

    def _refused(self, row: int, column: int, problem: str) -> BadInput:
        name = self.header[column] if self.header else f"column {column + 1}"
        return BadInput(self.source, name, f"line {self.first + row}: {problem}", DAMAGED)


def plain(label: str) -> str:
    """A unit as it is written here: analysers print ``[m/s2]``, ``m/sec2``, ``gn``."""
    return re.sub(r"(?<=[sc])2\b", "^2", re.sub(r"\b(?:G|gn)\b", "g", label.translate(str.maketrans("[]", "()"))))


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
    widths = [_width(line, chosen) for _, line in lines[: 2 * MOST_HEAD]]
    usual = Counter(filter(None, widths)).most_common(1)  # a head may have lines such as ``Point index: 1``
    rows_at = (k for k, one in enumerate(widths) if one and (one == usual[0][0] or not re.search("[A-Za-z]{2}", lines[k][1])))
    start = next(rows_at, None)
    if start is None or start >= MOST_HEAD:
        raise BadInput(source, "", "no row of numbers is found in it", "State `separator`, or export it again")
    by = chosen or next(one for one in SEPARATORS if _width(lines[start][1], one))
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


def _width(line: str, separator: str) -> int:
    """How many cells, two or more of which most are numbers, a line has; 0 where it has others."""
    if line.lstrip().startswith(("#", "%")):
        return 0
    for by in (separator,) if separator else SEPARATORS:
        cells = _cells(line, by)
        numbers = sum(as_number(cell) is not None for cell in cells)
        if len(cells) > 1 and numbers >= max(1, len(cells) - 1):
            return len(cells)
    return 0


def _cells(line: str, separator: str) -> tuple[str, ...]:
    if separator == " ":
        return tuple(line.split())
    try:
        words = next(csv.reader(io.StringIO(line), delimiter=separator), [])
    except csv.Error:
        return ()
    return tuple(word.strip() for word in (words[:-1] if words and not words[-1].strip() else words))  # some end rows in one
