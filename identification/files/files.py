"""Signal files: the format is that of the ending. Readers believe nothing, writers leave whole files or none."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry.errors import BadInput
from geometry.frames import Array

# What a signal file holds, whatever its format: samples by name, one common axis, and the units that the file itself states.

LARGEST_BYTES = 2 * 2**30
"""A run of more is refused, on disk and unpacked: 22 channels at 8192 Hz take 0.13 GiB in ninety seconds."""

TOO_LARGE = "Split the run, or record it at a lower rate"

DAMAGED = "Copy or export it again; it may be cut short or damaged"

Samples = npt.NDArray[Any]
"""(n,) float64 or complex128, in the unit of the file."""


@dataclass(frozen=True, kw_only=True)
class StatedUnits:
    """Dataset 164 of a universal file, as it stands before a channel.

    Attributes
    ----------
    length, force : what one unit of the file is in SI [m], [N]
    words : how the file calls the system
    """

    length: float
    force: float
    words: str

    def size(self, quantity: str) -> float:
        """What one unit of `quantity` is in SI."""
        return {"acceleration": self.length, "force": self.force, "moment": self.force * self.length}[quantity]


@dataclass(frozen=True, eq=False, kw_only=True)
class Signals:
    """The contents of one file.

    Attributes
    ----------
    source : the file
    samples : by name of the channel, all of one length
    sampling_rate : [Hz], of time histories
    frequency : (n,) [Hz], of spectra
    units : by name of the channel, the system of units that the file states for it
    labels : by name of the channel, what the file calls its unit; empty where it does not
    places : by name of a response function, node and direction (1 to 6, negative against the axis) of response and of reference
    warnings : what is odd, in words
    """

    source: str
    samples: Mapping[str, Samples]
    sampling_rate: float | None = None
    frequency: Array | None = None
    units: Mapping[str, StatedUnits] = field(default_factory=dict)
    labels: Mapping[str, str] = field(default_factory=dict)
    places: Mapping[str, tuple[int, int, int, int]] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()


def require_file(path: Path) -> None:
    """Refuse what is no regular file of a size that can be read: folders, links, devices, pipes.

    Raises
    ------
    BadInput : which of them it is.
    """

    def refused(problem: str, remedy: str = "Put the signals into a file of the folder") -> BadInput:
        return BadInput(str(path), "", problem, remedy)

    if path.is_symlink():
        raise refused("it is a link, which is not followed")
    if not path.exists():
        raise refused("there is no such file", "Check the name")
    if not path.is_file():
        raise refused("it is no regular file but a folder, a device or a pipe")
    size = path.stat().st_size
    if size > LARGEST_BYTES:
        raise too_large(str(path), size)


def too_large(source: str, size: int) -> BadInput:
    """The refusal of `size` bytes."""
    problem = f"it takes {size / 2**30:.3g} GiB, more than {LARGEST_BYTES / 2**30:.3g}"
    return BadInput(source, "", problem, TOO_LARGE)


def require_one_length(samples: Mapping[str, Samples], count: int | None, source: str) -> None:
    """Refuse channels of different lengths, or without samples; `count` is what the axis has.

    Raises
    ------
    BadInput : the first channel whose length is another.
    """
    if not samples:
        raise BadInput(source, "", "it holds no channel", DAMAGED)
    first = next(iter(samples))
    wanted = len(samples[first]) if count is None else count
    if wanted < 2:
        raise BadInput(source, first, f"holds {wanted} samples, and at least two are needed", DAMAGED)
    for name, values in samples.items():
        if len(values) != wanted:
            against = f"{first} has {wanted}" if count is None else f"the axis has {wanted}"
            problem = f"has {len(values)} samples where {against}"
            raise BadInput(source, name, problem, "Record all channels at one rate and length")


def as_complex(real: npt.ArrayLike, imaginary: npt.ArrayLike) -> Samples:
    """Complex numbers (n,) of two parts; infinite ones stay what they are, which a sum with 1j would make NaN."""
    parts = np.asarray(real, dtype=np.float64), np.asarray(imaginary, dtype=np.float64)
    found = np.empty(parts[0].shape, dtype=np.complex128)
    found.real, found.imag = parts
    return found


FORMATS = {".uff": "uff", ".unv": "uff", ".h5": "hdf5", ".hdf5": "hdf5", ".csv": "csv", ".mat": "mat"}
"""Ending of a file, in lower case, and the module of this package that reads and writes it."""


def read(path: Path) -> Signals:
    """The signals in `path`, in the units and under the names of the file.

    Raises
    ------
    BadInput : an ending that is not known, or whatever is wrong with the file.
    """
    return _module(path).read(path)  # type: ignore[no-any-return]


def write(path: Path, signals: Signals) -> None:
    """Write `signals` to `path`, whole or not at all.

    Raises
    ------
    BadInput : an ending that is not known, or signals that the format cannot hold.
    """
    call: Callable[[Path, Signals], None] = _module(path).write
    call(path, signals)


def require_known(name: str, source: str, field: str) -> None:
    """Refuse a file `name` with an ending that is not known.

    Raises
    ------
    BadInput : the endings that are.
    """
    if Path(name).suffix.lower() not in FORMATS:
        problem = f"ends in {Path(name).suffix!r}, which is none of {', '.join(FORMATS)}"
        raise BadInput(source, field, problem, "Export the signals in one of these formats")


def _module(path: Path) -> Any:
    require_known(path.name, str(path), "")
    return import_module(f"identification.files.{FORMATS[path.suffix.lower()]}")


# The common axis: is it evenly sampled, and at what rate, when the file says so in a few digits only?

TIMES = {"s": 1.0, "sec": 1.0, "ms": 1e-3, "µs": 1e-6, "us": 1e-6}
FREQUENCIES = {"hz": 1.0, "1/s": 1.0, "khz": 1e3, "rad/s": 1 / (2 * np.pi)}
"""Units of an axis in lower case, in SI."""

UNEVEN = 0.3
"""How far a time stamp may lie from its place at most, in sampling intervals, when its printed digits have no more to say."""

EVEN = 1e-4
"""How far it may lie with all digits there: clocks agree better, and a lost sample is off by one."""

LARGEST = 1e12
"""Seconds or hertz: no axis goes beyond."""

MOST_DECIMALS = 9
"""Time stamps of more decimals are taken as complete."""

SIGNIFICANT = range(6, 11)
"""Significant digits with which programs print every time stamp."""


def roundest(low: float, high: float) -> float:
    """The number of fewest decimal digits from `low` to `high`, both positive: what somebody set before it was rounded."""
    middle = (low + high) / 2
    for digits in range(17):
        candidate = float(f"{middle:.{digits}e}")
        if low <= candidate <= high:
            return candidate
    return middle


def rate_of_times(time: Array, source: str, field: str) -> float:
    """The sampling rate [Hz] behind time stamps (n,) [s].

    Raises
    ------
    BadInput : NaN, not ascending, or not evenly spaced: where, and by how much.
    """

    def refused(problem: str) -> BadInput:
        return BadInput(source, field, problem, "Record at one rate and export every sample")

    if len(time) < 2:
        raise refused(f"holds {len(time)} time stamps, and at least two are needed")
    good = np.abs(time) < LARGEST
    if not np.all(good):
        k = int(np.argmin(good))
        raise refused(f"must be a time in row {k + 1}, found {time[k]:g} s")
    steps, span, count = np.diff(time), float(time[-1] - time[0]), len(time) - 1
    usual = float(np.median(steps))
    if usual <= 0 or span <= 0:
        raise refused(f"must ascend, found a median step of {usual:g} s")
    off = np.abs(time - time[0] - span / count * np.arange(len(time)))
    rounding = _rounding(time)
    if np.any(off > np.clip(rounding + max(rounding[0], rounding[-1]), EVEN * usual, UNEVEN * usual)):
        k = int(np.argmax(np.abs(steps - usual)))
        raise refused(
            f"is sampled unequally: row {k + 2} comes {steps[k]:.6g} s after the one before it, most come {usual:.6g} s after"
        )
    ends = float(rounding[[0, -1]].sum())
    return roundest(count / (span + ends), count / max(span - ends, span / 2))


def _rounding(time: Array) -> Array:
    """Half a unit of the last digit that each of the time stamps (n,) [s] was printed with, of so many decimals or digits."""
    size, exact = np.abs(time), 4 * np.finfo(np.float64).eps
    binary = exact * float(size.max())
    found = np.full(len(time), binary)
    for decimals in range(MOST_DECIMALS):
        if np.all(np.abs(np.round(time, decimals) - time) <= binary):
            found = np.full(len(time), 0.5 * 10.0**-decimals)
            break
    decade = np.floor(np.log10(np.where(size > 0, size, 1.0)))
    for digits in SIGNIFICANT:
        unit = 10.0 ** (decade + 1 - digits)
        if np.all(np.abs(np.round(time / unit) * unit - time) <= exact * size):
            return np.asarray(np.maximum(found, unit / 2))
    return found


def require_lines(frequency: Array, source: str, field: str) -> None:
    """Refuse a frequency axis (n,) [Hz] that is not finite, negative, or does not ascend.

    Raises
    ------
    BadInput : the first line that is wrong.
    """
    good = (frequency < LARGEST) & (frequency >= 0)
    good[1:] &= frequency[1:] > frequency[:-1]
    if not np.all(good):
        k = int(np.argmin(good))
        problem = f"must be finite, not negative and ascend, found {frequency[k]:g} Hz in line {k + 1}"
        raise BadInput(source, field, problem, "Correct the frequency axis")


# Names of channels as variables of MATLAB.


def variable(name: str) -> str:
    """The variable of the channel `name`: ``-`` becomes ``_`` and the ``+`` of a blade's tip ``p``."""
    return name.replace("-", "_").replace("+", "p")
