"""Signals as comma-separated values: a header row, then a row a sample.

The first column is ``time`` [s] or ``frequency`` [Hz]; then comes a column a channel, of spectra ``<name>.re`` and ``<name>.im``.
"""

import csv
import io
import re
from pathlib import Path

import numpy as np

from geometry.atomic import write_text
from geometry.errors import BadInput
from geometry.frames import Array
from identification.files import files
from identification.files.files import DAMAGED, Samples, Signals

AXES = ("time", "frequency")

LONGEST_HEADER = 1_000_000
"""Bytes: no header is longer, and what has no line break in so many is no table."""

_NUMBERS = re.compile(rb"[-+0-9eE.,\r\n \tnaifNAIF]*")
"""What a table of numbers is written with; NaN and inf are named by their channel later."""


def read(path: Path) -> Signals:
    """The signals in `path`.

    Raises
    ------
    BadInput : no header, two columns of one name, a row that is too long or too short, no number, unequal sampling, spectra with
        half of their columns.
    """
    files.require_file(path)
    source = str(path)
    content = path.read_bytes().removeprefix(b"\xef\xbb\xbf")
    head, _, body = content.partition(b"\n")
    header = _header(head, source)
    table = _table(body, len(header), source)
    axis = table[:, 0]
    warnings = () if content.endswith(b"\n") else (f"{source}: its last row does not end; is the file cut short?",)
    if header[0] == "time":
        samples: dict[str, Samples] = {name: table[:, k] for k, name in enumerate(header) if k}
        files.require_one_length(samples, len(axis), source)
        rate = files.rate_of_times(axis, source, "time")
        return Signals(source=source, samples=samples, sampling_rate=rate, warnings=warnings)
    for name in header[1:]:
        stem, _, part = name.rpartition(".")
        other = f"{stem}.{'im' if part == 're' else 're'}"
        if part not in ("re", "im") or other not in header:
            missing = f"{name}.re and {name}.im are needed" if part not in ("re", "im") else f"{other} is missing"
            raise BadInput(source, name, f"a spectrum takes two columns: {missing}", "Write real and imaginary part")
    stems, at = dict.fromkeys(name.rpartition(".")[0] for name in header[1:]), {name: k for k, name in enumerate(header)}
    samples = {name: files.as_complex(table[:, at[f"{name}.re"]], table[:, at[f"{name}.im"]]) for name in stems}
    files.require_one_length(samples, len(axis), source)
    files.require_lines(axis, source, "frequency")
    return Signals(source=source, samples=samples, frequency=axis, warnings=warnings)


def write(path: Path, signals: Signals) -> None:
    """Write `signals` to `path`, whole or not at all, every number in the fewest digits that give it back exactly."""
    names = list(signals.samples)
    columns = list(signals.samples.values())
    if signals.frequency is None:
        rate = float(signals.sampling_rate or 1.0)
        header, axis = ["time", *names], np.arange(len(columns[0])) / rate
    else:
        header, axis = ["frequency", *(f"{name}.{part}" for name in names for part in ("re", "im"))], signals.frequency
        columns = [part for column in columns for part in (column.real, column.imag)]
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(header)
    for numbers in np.column_stack([axis, *columns]).tolist():
        text.write(",".join(map(repr, numbers)) + "\n")
    write_text(path, text.getvalue())


def _header(line: bytes, source: str) -> list[str]:
    def refused(problem: str, remedy: str, field: str = "header") -> BadInput:
        return BadInput(source, field, problem, remedy)

    try:
        words = next(csv.reader([line[:LONGEST_HEADER].decode("utf-8").rstrip("\r")], strict=True), [])
    except (UnicodeDecodeError, csv.Error) as error:
        raise refused(f"cannot be read: {error}", "Save the file as UTF-8 with commas") from None
    names = [word.strip() for word in words]
    if not names or names[0] not in AXES:
        found = names[0][:60] if names else ""
        problem = f"the first column must be called time or frequency, found {found!r}"
        raise refused(problem, "Write time [s] or frequency [Hz] first, separated by commas, with decimal points")
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise refused(f"names two columns {twice[0]!r}", "Give every channel its own name", twice[0])
    return names


def _table(body: bytes, width: int, source: str) -> Array:
    if not body.strip():
        raise BadInput(source, "", "it holds no samples", DAMAGED)
    good = _NUMBERS.match(body)
    end = good.end() if good else 0
    if end < len(body):
        row = body[:end].count(b"\n") + 1
        found = body[end : end + 12].decode("utf-8", errors="replace")
        problem = f"row {row} holds something that is no number, at {found!r}"
        raise BadInput(source, "", problem, "Use commas between columns and points in decimals")
    try:
        table = np.loadtxt(io.BytesIO(body), delimiter=",", dtype=np.float64, comments=None, ndmin=2)
    except ValueError as error:
        raise BadInput(source, "", f"it cannot be read: {str(error).split(';')[0]}", DAMAGED) from None
    if table.shape[1] != width:
        raise BadInput(source, "", f"its rows have {table.shape[1]} columns where the header names {width}", DAMAGED)
    return np.asarray(table, dtype=np.float64)
