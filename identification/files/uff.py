"""Signals in universal files: dataset 58, ASCII or binary (58b), one a channel, its name in the first id line.

Function type 1 is a time history, 12 a spectrum. A dataset 164 states the units of the functions behind it. Other datasets (151
header, nodes, traces) are passed over.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from geometry.atomic import write_with
from geometry.errors import BadInput
from geometry.frames import Array
from identification.files import files
from identification.files.files import DAMAGED, LARGEST, Samples, Signals, StatedUnits

# The datasets of a universal file, told apart and measured before anybody reads numbers from them. Every dataset 58 must have
# exactly the numbers that its header promises, in fields of one width, so that a byte too many or too few is noticed. What has
# been measured is read at once, an order of magnitude faster than line by line.

MARK = b"    -1"
HEADER = 11
"""Lines of a dataset 58 before its numbers, behind the line that says 58."""

REAL, COMPLEX = (2, 4), (5, 6)
SINGLE = (2, 5)
"""Ordinate data types."""

_LINE_END = re.compile(rb"\r?\n")
_MARK_LINE = re.compile(rb"(?:^|(?<=\n))    -1[ ]*\r?(?:\n|$)")
_CLOSING = re.compile(rb"(?:\r?\n)?    -1[ ]*\r?(?:\n|$)")
_NUMBERS = re.compile(rb"[-+0-9eEdD. nafiNAFI\r\n]*")


@dataclass(frozen=True, eq=False, kw_only=True)
class Dataset:
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


def blocks(content: bytes, source: str) -> list[Dataset]:
    """All datasets in `content`.

    Raises
    ------
    BadInput : something outside of a dataset, a dataset that does not end, a function with other numbers than it promises.
    """
    found: list[Dataset] = []
    place = 0
    while True:
        while place < len(content) and content[place : place + 1] in b" \r\n" and content[place : place + 6] != MARK:
            place += 1  # past empty lines
        if place >= len(content):
            break
        block, place = _block(content, place, len(found), source)
        found.append(block)
    if not found:
        raise BadInput(source, "", "it is no universal file: it holds no dataset", DAMAGED)
    return found


def title(line: str, index: int) -> str:
    """What the first id `line` calls a function; ``dataset 3`` where it is blank or NONE."""
    return line.strip() if line.strip() not in ("", "NONE") else f"dataset {index + 1}"


def label(line: str) -> str:
    """The unit that a line of an axis names; empty for NONE."""
    text = line[47:67].strip()
    return "" if text.upper() == "NONE" else text


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
        return kind(text if kind is int else re.sub("[dD]", "E", text))
    except ValueError:
        raise BadInput(source, what, f"must be a number, found {text!r}", DAMAGED) from None


def _block(content: bytes, place: int, index: int, source: str) -> tuple[Dataset, int]:
    opening = _MARK_LINE.match(content, place)
    if opening is None:
        found = content[place : place + 20]
        problem = f"byte {place + 1} stands outside of any dataset, at {found.decode('utf-8', errors='replace')!r}"
        raise BadInput(source, "", problem, DAMAGED)
    identity, place = _line(content, opening.end(), source)
    number = int(column(identity, 0, 6, int, f"dataset {index + 1}", source))
    if number == 58:
        return _function(content, place, identity, index, source)
    closing = _next_mark(content, place)
    if closing is None:
        raise BadInput(source, "", f"dataset {index + 1} does not end", DAMAGED)
    lines = _text(content[place : closing.start()]).splitlines()
    return Dataset(number=number, index=index, lines=tuple(lines)), closing.end()


def _function(content: bytes, place: int, identity: str, index: int, source: str) -> tuple[Dataset, int]:
    lines = []
    for _ in range(HEADER):
        line, place = _line(content, place, source)
        lines.append(line)
    name = title(lines[0], index)
    kind, count, even = (int(column(lines[6], start, 10, int, name, source)) for start in (0, 10, 20))
    if kind not in REAL + COMPLEX or even not in (0, 1) or count < 0:
        problem = f"has the ordinate data type {kind}, {count} values and abscissa spacing {even}, which no dataset 58 has"
        raise BadInput(source, name, problem, DAMAGED)
    numbers = count * ((2 if kind in COMPLEX else 1) + (1 - even))
    if identity[6:7].lower() == "b":
        found, end, warnings = _binary(content, place, identity, numbers, 4 if kind in SINGLE else 8, name, source)
    else:
        if kind in SINGLE:
            widths = [13] * 6  # of the fields of a full line
        elif even:
            widths = [20] * 4
        else:
            widths = [13, 20, 13, 20] if kind in REAL else [13, 20, 20]
        (found, end), warnings = _ascii(content, place, widths, numbers, name, source), ()
    closing = _CLOSING.match(content, end)
    if closing is None:
        raise BadInput(source, name, f"does not end behind the {count} values that it promises", DAMAGED)
    return Dataset(number=58, index=index, lines=tuple(lines), numbers=found, warnings=warnings), closing.end()


def _binary(
    content: bytes, place: int, identity: str, count: int, width: int, name: str, source: str
) -> tuple[Array, int, tuple[str, ...]]:
    """`count` numbers of `width` bytes, where they end, and a word about the bytes that are stated."""
    size = count * width
    order, floats = (int(column(identity, start, 6, int, name, source)) for start in (7, 13))
    stated = int(column(identity, 31, 12, int, name, source))
    if order not in (1, 2) or floats != 2:
        problem = f"has byte order {order} and floating-point format {floats}, where 1 or 2 and 2 (IEEE 754) are read"
        raise BadInput(source, name, problem, "Export it with IEEE 754 numbers, or as ASCII")
    if place + size > len(content):
        raise BadInput(source, name, f"promises {count} numbers, and the file ends before", DAMAGED)
    numbers = np.frombuffer(content, f"{'<' if order == 1 else '>'}f{width}", count, place).astype(np.float64)
    if stated == size:
        return numbers, place + size, ()
    if stated * 2 != size:
        raise BadInput(source, name, f"states {stated} bytes of numbers, and its header promises {size}", DAMAGED)
    word = f"{source}: {name} states half of its bytes, as pyuff writes complex numbers; all of them were read"
    return numbers, place + size, (word,)


def _ascii(content: bytes, place: int, widths: list[int], count: int, name: str, source: str) -> tuple[Array, int]:
    """`count` numbers and where they end, after every line was measured."""
    closing = _next_mark(content, place)
    if closing is None:
        raise BadInput(source, name, "does not end", DAMAGED)
    body = content[place : closing.start()]
    if _NUMBERS.fullmatch(body) is None:
        raise BadInput(source, name, "holds something that is no number", DAMAGED)
    found, rows = 0, [row.rstrip(b"\r") for row in body.rstrip(b"\r\n").split(b"\n")] if count else []
    words = [word.end() for word in re.finditer(rb"\S+", rows[0])] if rows else []
    if words and len(set(np.diff([0, *words]))) == 1 and words[-1] not in np.cumsum(widths):
        widths = words[:1] * len(words)  # some writers have one width of their own for all numbers
    ends = [sum(widths[: k + 1]) for k in range(len(widths))]
    for k, row in enumerate(rows):
        bare = row.rstrip()
        rows[k] = row = row if len(row) in ends and len(bare) not in ends else bare  # some writers end each field in a blank
        length = len(row)
        if length not in ends or (length != len(rows[0]) and k + 1 < len(rows)):
            problem = f"line {k + 1} of its numbers has {length} characters where fields end at {', '.join(map(str, ends))}"
            raise BadInput(source, name, problem, DAMAGED)
        found += ends.index(length) + 1
    if found != count:
        raise BadInput(source, name, f"promises {count} numbers, found {found}", DAMAGED)
    group = widths[:1] if len(set(widths)) == 1 else widths[: 3 if len(widths) == 3 else 2]
    try:
        cells = np.frombuffer(re.sub(rb"[dD]", b"E", b"".join(rows)), [(f"f{k}", f"S{width}") for k, width in enumerate(group)])
        fields = np.column_stack([cells[f"f{k}"].astype(np.float64) for k in range(len(group))]).ravel()
    except ValueError as error:
        raise BadInput(source, name, f"holds something that is no number: {error}", DAMAGED) from None
    return fields, closing.start()


def _line(content: bytes, place: int, source: str) -> tuple[str, int]:
    end = _LINE_END.search(content, place, place + 1000)
    if end is None:
        raise BadInput(source, "", f"a header is cut short at byte {place + 1}", DAMAGED)
    return _text(content[place : end.start()]), end.end()


def _text(content: bytes) -> str:
    """UTF-8, or Latin-1 as most analysers write, in which every byte is a column."""
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError:
        return content.decode("latin-1")


def _next_mark(content: bytes, place: int) -> re.Match[bytes] | None:
    """The first line from `place` on that holds nothing but the mark."""
    while (place := content.find(MARK, place)) >= 0:
        found = _MARK_LINE.match(content, place)
        if found is not None:
            return found
        place += 1
    return None


# Universal files written: header 151, units 164, and a dataset 58 or 58b for every channel.
#
# By the published description of the format; pyuff reads it back in the tests. ASCII numbers have the thirteen digits of E20.12.

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
    header = _dataset("   151", [f"{word:<80}" for word in ("NONE", "NONE", "massline", "NONE", "NONE", "massline", "NONE")])
    pieces = [header]
    units: tuple[float, float] | None = None
    for name, samples in signals.samples.items():
        stated = signals.units.get(name, _ENGLISH)
        if (stated.length, stated.force) != units:
            units = (stated.length, stated.force)
            # Factors are what SI is divided by; temperature is that of code 1
            is_si = stated.length == stated.force == 1.0
            factors = [f"{value:25.16E}".replace("E", "D") for value in (1 / stated.length, 1 / stated.force, 1.0, 273.15)]
            words = f"{1 if is_si else 9:10d}{'SI: metre, newton' if is_si else 'unit of the channel':<20}{2:10d}"
            pieces.append(_dataset("   164", [words, "".join(factors[:3]), factors[3]]))
        pieces.append(_function_block(name, samples, signals, binary, str(path)))
    write_with(path, lambda temporary: temporary.write_bytes(b"".join(pieces)))


def _dataset(number: str, lines: list[str]) -> bytes:
    return "".join(f"{line}\n" for line in ("    -1", f"{number:<80}", *lines, "    -1")).encode()


def _function_block(name: str, samples: Samples, signals: Signals, binary: bool, source: str) -> bytes:
    if len(name) > LONGEST_LINE or name.strip() != name or name in ("", "NONE"):
        raise BadInput(source, name, f"does not fit an id line of {LONGEST_LINE} characters", "Rename the channel, or write .h5")
    is_spectrum = signals.frequency is not None
    kind = RESPONSE_FUNCTION if name in signals.places else SPECTRUM if is_spectrum else TIME_RESPONSE
    places = signals.places.get(name, (0, 0, 0, 0))
    samples = samples.astype(np.complex128) if is_spectrum else samples
    start, step, even = _abscissa(signals, binary, source)
    abscissa = None if even else signals.frequency
    columns = [samples.real, samples.imag] if np.iscomplexobj(samples) else [samples]
    numbers = np.column_stack(columns if abscissa is None else [abscissa, *columns]).ravel()
    rate = RATE.format(repr(float(signals.sampling_rate))) if signals.sampling_rate is not None else "NONE"
    lines = [
        *(f"{text:<80}" for text in (name, "NONE", "NONE", rate, "NONE")),
        f"{kind:5d}{0:10d}{0:5d}{0:10d} {'NONE':<10}{places[0]:10d}{places[1]:4d} {'NONE':<10}{places[2]:10d}{places[3]:4d}",
        f"{6 if is_spectrum else 4:10d}{len(samples):10d}{int(even):10d}{start:13.5E}{step:13.5E}{0:13.5E}",
        _characteristics(18 if is_spectrum else 17, "Hz" if is_spectrum else "s"),
        _characteristics(0, signals.labels.get(name) or "NONE"),
        *[_characteristics(0, "NONE")] * 2,
    ]
    if not binary:
        # Lines of E20.12, or of E13.5 and two E20.12 where every line has its own frequency
        width, form = (4, "%20.12E" * 4) if even else (3, "%13.5E%20.12E%20.12E")
        full = len(numbers) // width * width
        rows = [form % tuple(row) for row in numbers[:full].reshape(-1, width).tolist()]
        rest = ["".join(f"{one:20.12E}" for one in numbers[full:])] if full < len(numbers) else []
        return _dataset("    58", [*lines, *rows, *rest])
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
        raise BadInput(source, "frequency", problem, "Write 58b or .h5")
    return 0.0, 0.0, False


def _same(printed: Array, lines: Array) -> bool:
    return bool(np.all(np.abs(printed - lines) <= AGREED * np.abs(lines)))


def _characteristics(kind: int, unit: str) -> str:
    return f"{kind:10d}{0:5d}{0:5d}{0:5d} {'NONE':<20} {unit:<20}"


ENDINGS = (".uff", ".unv")


def is_universal(path: Path) -> bool:
    """Whether `path` is a universal file, by its ending or by its first line."""
    if path.suffix.lower() in ENDINGS or not path.is_file():
        return path.suffix.lower() in ENDINGS
    with path.open("rb") as file:
        return _MARK_LINE.match(file.read(100).lstrip(b"\r\n")) is not None


TIME_RESPONSE, RESPONSE_FUNCTION, SPECTRUM = 1, 4, 12
TIME, FREQUENCY = 17, 18
"""Specific data types of an abscissa."""


def read(path: Path) -> Signals:
    """The signals in `path`.

    Raises
    ------
    BadInput : no universal file, damaged, no function, one of another type, without name or with another's, axes that differ.
    """
    files.require_file(path)
    source = str(path)
    found = blocks(path.read_bytes(), source)
    functions = [block for block in found if block.number == 58]
    if not functions:
        raise BadInput(source, "", "it holds no dataset 58", "Export the signals as dataset 58 or 58b")
    names = _names(functions, source)
    kinds = []
    for block, name in zip(functions, names, strict=True):
        kind, along = (int(column(block.lines[at], 0, width, int, name, source)) for at, width in ((5, 5), (7, 10)))
        kinds.append(TIME_RESPONSE if (kind, along) == (0, TIME) else kind)
        if kinds[-1] not in (TIME_RESPONSE, SPECTRUM):
            problem = f"has the function type {kind}, where {TIME_RESPONSE} (time response) or {SPECTRUM} (spectrum) is read"
            raise BadInput(source, name, problem, "Export the recorded signals, not what was made of them")
        if kinds[-1] != kinds[0]:
            problem = "is a spectrum beside time histories, or the other way round"
            raise BadInput(source, name, problem, "Put them into files of their own")
    spectra = kinds[0] == SPECTRUM
    of_axis, stated = files.FREQUENCIES if spectra else files.TIMES, units(found, source)
    curves = {name: curve(block, name, source, of_axis) for block, name in zip(functions, names, strict=True)}
    samples = {name: values for name, (_, values) in curves.items()}
    files.require_one_length(samples, None, source)
    axis = curves[names[0]][0]
    for name, (other, _) in curves.items():
        if not np.array_equal(other, axis):
            ours, first = (f"{one[0]:.9g} to {one[-1]:.9g}" for one in (other, axis))
            problem = f"has another axis than {names[0]}: {ours} instead of {first}"
            raise BadInput(source, name, problem, "Record all channels at one rate and length")
    if spectra:
        files.require_lines(axis, source, names[0])
    return Signals(
        source=source,
        samples=samples,
        sampling_rate=None if spectra else _rate(axis, functions, names, source),
        frequency=axis if spectra else None,
        units={name: of for name, block in zip(names, functions, strict=True) if (of := stated[block.index])},
        labels={name: label(block.lines[8]) for name, block in zip(names, functions, strict=True)},
        warnings=tuple(text for block in functions for text in block.warnings),
    )


def _names(functions: list[Dataset], source: str) -> list[str]:
    """What tells the functions apart: the first id lines; else entity, node, direction and what the ordinate is called."""
    ids = [block.lines[0].strip() for block in functions]
    heads = [(block.lines[5][31:41], block.lines[5][41:51], block.lines[5][51:55], block.lines[8][26:46]) for block in functions]
    about = [[word for one in head if (word := one.strip()) not in ("", "NONE", "0")] for head in heads]
    for names in (ids, [head[0].strip() for head in heads], [" ".join(words) for words in about]):
        if len(set(names)) == len(names) and not {"", "NONE"} & set(names):
            return names
    name = next(name for name in ids if ids.count(name) > 1 or name in ("", "NONE"))
    problem = f"{ids.count(name)} datasets have this name or no name, and neither entity nor node tells the functions apart"
    raise BadInput(source, name, problem, "Give every channel its own name")


def curve(block: Dataset, name: str, source: str, units: Mapping[str, float]) -> tuple[Array, Samples]:
    """Abscissa in SI, by a label of `units`, and ordinate (n,) of a function, the latter real or complex.

    Raises
    ------
    BadInput : an abscissa without a finite start and step.
    """
    kind, count, even = (int(column(block.lines[6], start, 10, int, name, source)) for start in (0, 10, 20))
    rows = block.numbers.reshape(count, -1)
    if even:
        start, step = (column(block.lines[6], at, 13, float, name, source) for at in (30, 43))
        if not (abs(start) < LARGEST and 0 < step < LARGEST):
            raise BadInput(source, name, f"has the abscissa {start:g} + {step:g} k", "Export it with start and step of its axis")
        abscissa = np.asarray(start + step * np.arange(count), dtype=np.float64)
    else:
        abscissa, rows = rows[:, 0], rows[:, 1:]
    abscissa = units.get(label(block.lines[7]).lower(), 1.0) * abscissa
    return abscissa, files.as_complex(rows[:, 0], rows[:, 1]) if kind in COMPLEX else rows[:, 0]


def _rate(time: Array, functions: list[Dataset], names: list[str], source: str) -> float:
    """The sampling rate behind an increment of six digits, or behind time stamps; an id line of ours has it in full."""
    if not column(functions[0].lines[6], 20, 10, int, names[0], source):
        return files.rate_of_times(time, source, "time")
    unit = files.TIMES.get(label(functions[0].lines[7]).lower(), 1.0)
    increment = column(functions[0].lines[6], 43, 13, float, names[0], source) * unit
    # Half a unit of the last digit that the increment was printed with, at least `5` decimals behind an exponent
    digits = next((d for d in range(5, 17) if float(f"{increment:.{d}e}") == increment), 17)
    rounding = float(0.5 * 10.0 ** (np.floor(np.log10(increment)) - digits))
    low, high = 1 / (increment + rounding), 1 / (increment - rounding)
    for block, name in zip(functions, names, strict=True):
        stated = re.fullmatch(RATE.format(r"(\S+)"), block.lines[3].strip())
        full = float(stated[1]) if stated and re.fullmatch(r"[-+.\deE]+", stated[1]) else None
        if full is not None and not low <= full <= high:
            problem = f"says {stated[0] if stated else ''!r}, and its increment is that of {low:.9g} to {high:.9g} Hz"
            raise BadInput(source, name, problem, DAMAGED)
        if full is not None:
            return full
    return files.roundest(low, high)


def units(found: list[Dataset], source: str) -> list[StatedUnits | None]:
    """By dataset what the last 164 before it says, or the first where it comes only behind.

    Raises
    ------
    BadInput : one is cut short, its factors are none or contradict its code.
    """
    what, made = "dataset 164", dict[int, StatedUnits]()
    for block in (block for block in found if block.number == 164):
        if len(block.lines) < 2:
            raise BadInput(source, what, "is cut short", DAMAGED)
        code = int(column(block.lines[0], 0, 10, int, what, source))
        length, force = (column(block.lines[1], start, 25, float, what, source) for start in (0, 25))
        if not (0 < length < np.inf and 0 < force < np.inf):
            raise BadInput(source, what, f"has the factors {length:g} and {force:g}", "Correct it")
        if code == 1 and max(abs(length - 1), abs(force - 1)) > 1e-6:
            problem = f"says code 1, which is SI, and has the factors {length:g} and {force:g}, where those of SI are 1"
            raise BadInput(source, what, problem, "Write the factors 1 for numbers in SI, or the code 9 for a system of your own")
        words = f"code {code}, {block.lines[0][10:30].strip()!r}"
        made[block.index] = StatedUnits(length=1 / length, force=1 / force, words=words)
    return [made[max((k for k in made if k < one.index), default=min(made))] if made else None for one in found]
