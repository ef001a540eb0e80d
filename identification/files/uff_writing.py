"""Universal files written: header 151, units 164, and a dataset 58 or 58b for every channel.

pyuff writes functions of type 12 not at all, half of the byte count of complex ones, and zeros for NaN; so this is ours, by the
published description of the format, and pyuff reads it back in the tests. ASCII numbers have the thirteen digits of E20.12.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from geometry.arrays import Array
from geometry.atomic import write_with
from geometry.errors import BadInput
from identification.files.contents import Samples, Signals, StatedUnits

RATE = "sampling rate {} Hz"
"""The fourth id line: the increment of the header has six digits only, and a record's length needs more."""

LONGEST_LINE = 80
"""Characters of an id line."""

AGREED = 1e-10
"""Relative difference up to which frequencies that were printed are those that were meant."""

_ENGLISH = StatedUnits(length=1.0, force=1.0, words="SI")


def write(path: Path, signals: Signals, *, binary: bool = False) -> None:
    """Write `signals` to `path`, whole or not at all; `binary` writes 58b, which keeps every digit.

    Raises
    ------
    BadInput : a name that an id line has no room for, or frequencies that six digits cannot say (ASCII, unevenly spaced).
    """
    pieces = [_header()]
    units: tuple[float, float] | None = None
    for name, samples in signals.samples.items():
        stated = signals.units.get(name, _ENGLISH)
        if (stated.length, stated.force) != units:
            units = (stated.length, stated.force)
            pieces.append(_units(stated))
        pieces.append(_function(name, samples, signals, binary, str(path)))
    write_with(path, lambda temporary: temporary.write_bytes(b"".join(pieces)))


def _dataset(number: str, lines: list[str]) -> bytes:
    return "".join(f"{line}\n" for line in ("    -1", f"{number:<80}", *lines, "    -1")).encode()


def _header() -> bytes:
    return _dataset("   151", [f"{word:<80}" for word in ("NONE", "NONE", "massline", "NONE", "NONE", "massline", "NONE")])


def _units(stated: StatedUnits) -> bytes:
    """Factors are what SI is divided by; temperature is that of code 1."""
    is_si = stated.length == stated.force == 1.0
    factors = [f"{value:25.16E}".replace("E", "D") for value in (1 / stated.length, 1 / stated.force, 1.0, 273.15)]
    words = f"{1 if is_si else 9:10d}{'SI: metre, newton' if is_si else 'unit of the channel':<20}{2:10d}"
    return _dataset("   164", [words, "".join(factors[:3]), factors[3]])


def _function(name: str, samples: Samples, signals: Signals, binary: bool, source: str) -> bytes:
    if len(name) > LONGEST_LINE or name.strip() != name or name in ("", "NONE"):
        problem = f"does not fit an id line of {LONGEST_LINE} characters"
        raise BadInput(source=source, field=name, problem=problem, remedy="Rename the channel, or write .h5")
    is_spectrum = signals.frequency is not None
    start, step, even = _abscissa(signals, binary, source)
    numbers = _numbers(samples, None if even else signals.frequency)
    rate = RATE.format(repr(float(signals.sampling_rate))) if signals.sampling_rate is not None else "NONE"
    lines = [
        *(f"{text:<80}" for text in (name, "NONE", "NONE", rate, "NONE")),
        f"{12 if is_spectrum else 1:5d}{0:10d}{0:5d}{0:10d} {'NONE':<10}{0:10d}{0:4d} {'NONE':<10}{0:10d}{0:4d}",
        f"{6 if is_spectrum else 4:10d}{len(samples):10d}{int(even):10d}{start:13.5E}{step:13.5E}{0:13.5E}",
        _characteristics(18 if is_spectrum else 17, "Hz" if is_spectrum else "s"),
        _characteristics(0, signals.labels.get(name) or "NONE"),
        *[_characteristics(0, "NONE")] * 2,
    ]
    if not binary:
        return _dataset("    58", [*lines, *_rows(numbers, even)])
    identity = f"    58b{1:6d}{2:6d}{11:12d}{8 * numbers.size:12d}{0:6d}{0:6d}{0:12d}{0:12d}"
    head = "".join(f"{line}\n" for line in ("    -1", identity, *lines)).encode()
    return head + numbers.astype("<f8").tobytes() + b"    -1\n"


def _abscissa(signals: Signals, binary: bool, source: str) -> tuple[float, float, bool]:
    """Start, increment and whether these say it all."""
    if signals.frequency is None:
        return 0.0, 1 / float(signals.sampling_rate or 1.0), True
    lines = np.asarray(signals.frequency, dtype=np.float64)
    start, step = lines[0], (lines[-1] - lines[0]) / (len(lines) - 1)
    printed = np.asarray(float(f"{start:13.5E}") + float(f"{step:13.5E}") * np.arange(len(lines)), dtype=np.float64)
    if _same(printed, lines):
        return float(start), float(step), True
    if not binary and not _same(np.array([float(f"{one:13.5E}") for one in lines]), lines):
        problem = "has lines that the six digits of an ASCII universal file cannot say"
        raise BadInput(source=source, field="frequency", problem=problem, remedy="Write 58b or .h5")
    return 0.0, 0.0, False


def _same(printed: Array, lines: Array) -> bool:
    return bool(np.all(np.abs(printed - lines) <= AGREED * np.abs(lines)))


def _characteristics(kind: int, unit: str) -> str:
    return f"{kind:10d}{0:5d}{0:5d}{0:5d} {'NONE':<20} {unit:<20}"


def _numbers(samples: Samples, abscissa: Array | None) -> Array:
    columns = [samples.real, samples.imag] if np.iscomplexobj(samples) else [samples]
    return np.column_stack(columns if abscissa is None else [abscissa, *columns]).ravel()


def _rows(numbers: Array, even: bool) -> list[str]:
    """Lines of E20.12, or of E13.5 and two E20.12 where every line has its own frequency."""
    width, form = (4, "%20.12E" * 4) if even else (3, "%13.5E%20.12E%20.12E")
    full = len(numbers) // width * width
    rows = [form % tuple(row) for row in numbers[:full].reshape(-1, width).tolist()]
    return rows + (["".join(f"{one:20.12E}" for one in numbers[full:])] if full < len(numbers) else [])
