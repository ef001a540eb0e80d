"""`Campaign`: everything recorded for one test article on the shaker, and how it was recorded.

The nouns behind ``campaign.toml`` (`identification.campaign_file` reads and writes it): what was mounted, where each pick-up sat
(`geometry.sensors`), what each run drove (`Run`, `Excitation`), how spectra are wanted (`Processing`) and the samples themselves.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry.errors import BadInput
from geometry.frames import Array, Pose
from geometry.sensors import ChannelTable
from geometry.toml_file import nearest

# `Recording`: the samples of one run, every channel on one common axis, in SI.


@dataclass(frozen=True, eq=False, kw_only=True)
class Recording:
    """Time histories, equally sampled, or complex spectra: exactly one of `sampling_rate` and `frequency` is given.

    Attributes
    ----------
    names : of the channels, in the order of the columns
    values : (n, c) float64 time histories or complex128 spectra, in the SI unit of each channel (spectra may be per Hz)
    sampling_rate : [Hz], of time histories
    frequency : (n,) [Hz], of spectra, ascending
    source : the file, for messages
    warnings : what is odd about it, in words
    """

    names: tuple[str, ...]
    values: npt.NDArray[Any]
    sampling_rate: float | None = None
    frequency: Array | None = None
    source: str = "recording"
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "names", tuple(self.names))
        values = np.array(self.values, dtype=np.float64 if self.frequency is None else np.complex128)
        if values.ndim != 2 or values.shape[1] != len(self.names):
            raise ValueError(f"`values` must have shape (n, {len(self.names)}), found {values.shape}")
        values.setflags(write=False)
        object.__setattr__(self, "values", values)
        if (self.sampling_rate is None) == (self.frequency is None):
            raise ValueError("give either `sampling_rate` or `frequency`")
        if self.sampling_rate is not None and not 0 < self.sampling_rate < np.inf:
            raise ValueError(f"`sampling_rate` must be positive, found {self.sampling_rate}")
        if self.frequency is not None:
            object.__setattr__(self, "frequency", _lines(self.frequency, len(values)))

    def __len__(self) -> int:
        return len(self.values)

    @property
    def is_spectrum(self) -> bool:
        """Whether these are complex spectra."""
        return self.frequency is not None

    @property
    def duration(self) -> float:
        """[s] from the first sample to one after the last; 0 of spectra."""
        return 0.0 if self.sampling_rate is None else len(self) / self.sampling_rate

    @property
    def time(self) -> Array:
        """(n,) [s], from 0; of time histories."""
        if self.sampling_rate is None:
            raise ValueError("spectra have no time")
        return np.arange(len(self)) / self.sampling_rate

    def channel(self, name: str) -> npt.NDArray[Any]:
        """The samples (n,) of the channel `name`.

        Raises
        ------
        BadInput : there is none of this name.
        """
        if name not in self.names:
            raise BadInput(source=self.source, field=name, problem="there is no such channel", remedy="Check the name")
        column: npt.NDArray[Any] = self.values[:, self.names.index(name)]
        return column


def _lines(frequency: npt.ArrayLike, count: int) -> Array:
    lines = np.array(frequency, dtype=np.float64)
    if lines.shape != (count,) or not np.all(np.isfinite(lines)) or np.any(np.diff(lines) <= 0) or np.any(lines < 0):
        raise ValueError(f"`frequency` must be {count} ascending frequencies, not negative")
    lines.setflags(write=False)
    return lines


METHODS = ("full-record", "peak-reference-hold")
"""How spectra are made of records."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Excitation:
    """What the table was asked to do.

    Attributes
    ----------
    kind : "sine-sweep", "random", "burst", "multi-axis"
    figures : by the key of ``campaign.toml``: start_hz, stop_hz, octaves_per_minute, duration_s; `level` [m/s²] or [rad/s²]; of a
        multi-axis pattern six `levels` in the order x, y, z, alpha, beta, gamma
    """

    kind: str
    figures: Mapping[str, float | tuple[float, ...]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "figures", MappingProxyType(dict(self.figures)))

    def figure(self, key: str) -> float | None:
        """The number under `key`; None where the file does not state it."""
        value = self.figures.get(key)
        return value if isinstance(value, float) else None

    @property
    def band(self) -> tuple[float, float] | None:
        """(low, high) [Hz] of what is driven; None where start or stop is not stated."""
        start, stop = self.figure("start_hz"), self.figure("stop_hz")
        return None if start is None or stop is None else (min(start, stop), max(start, stop))

    @property
    def sweep_duration(self) -> float | None:
        """[s] that a sine sweep at the stated rate takes; None where start, stop or rate is not stated."""
        from math import log2

        start, stop, rate = (self.figure(key) for key in ("start_hz", "stop_hz", "octaves_per_minute"))
        return None if not (start and stop and rate) else 60 * abs(log2(stop / start)) / rate


@dataclass(frozen=True, eq=False, kw_only=True)
class Run:
    """One run: a signal file and what was driven.

    Attributes
    ----------
    name : unique in the campaign
    file : name of the signal file, relative to the folder
    axis : of `MOTIONS`; empty for a pattern of several axes
    excitation : None where the file does not state it
    """

    name: str
    file: str
    axis: str = ""
    excitation: Excitation | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Processing:
    """How spectra are to be made: the paper's settings where the file does not state others.

    Attributes
    ----------
    method : of `METHODS`
    block_size : samples a block, of peak-reference-hold
    overlap : share of a block, of peak-reference-hold
    start, stop, step : grid of lines [Hz]
    """

    method: str = "full-record"
    block_size: int = 8192
    overlap: float = 0.9
    start: float = 4.0
    stop: float = 32.0
    step: float = 0.05


@dataclass(frozen=True, eq=False, kw_only=True)
class Campaign:
    """A campaign.

    Attributes
    ----------
    title, notes : free text
    article : the whole stack above the force plane, bottom to top, joined by "+", or a model file
    hardware : campaigns of the same id share FMD and sensors, and so their errors; empty when it is not stated
    table : channels and the reference point, the paper's F
    runs : in the order of the file
    recordings : by name of the run; all of them, or none where only the description was read
    mounting : pose of the top article's own frame in the frame of `table`; None when it is not stated
    gravity : [m/s²]
    processing : None where the file leaves it open
    warnings : what is odd about the campaign, in words
    source : the folder, for messages
    """

    title: str
    article: str
    table: ChannelTable
    runs: tuple[Run, ...]
    recordings: Mapping[str, Recording] = field(default_factory=dict)
    hardware: str = ""
    notes: str = ""
    mounting: Pose | None = None
    gravity: float = 9.81
    processing: Processing | None = None
    warnings: tuple[str, ...] = ()
    source: str = "campaign"

    def __post_init__(self) -> None:
        object.__setattr__(self, "runs", tuple(self.runs))
        object.__setattr__(self, "recordings", MappingProxyType(dict(self.recordings)))

    def run(self, name: str) -> Run:
        """The run `name`.

        Raises
        ------
        BadInput : there is none of this name.
        """
        for one in self.runs:
            if one.name == name:
                return one
        known = ", ".join(one.name for one in self.runs)
        raise BadInput(source=self.source, field="run", problem=f"there is no run {name!r}", remedy=f"There are {known}")


# Units of signal files. A channel states its own; its samples are multiplied once, where they are read.


STANDARD_GRAVITY = 9.80665
POUND_FORCE = 4.4482216152605
FOOT, INCH = 0.3048, 0.0254

UNITS: dict[str, dict[str, float]] = {
    "acceleration": {"m/s^2": 1.0, "g": STANDARD_GRAVITY, "mm/s^2": 1e-3, "in/s^2": INCH, "ft/s^2": FOOT},
    "force": {"N": 1.0, "kN": 1e3, "mN": 1e-3, "lbf": POUND_FORCE},
    "moment": {"N m": 1.0, "kN m": 1e3, "N mm": 1e-3, "lbf in": POUND_FORCE * INCH, "lbf ft": POUND_FORCE * FOOT},
}
"""Units of each quantity, and what a number in one is multiplied with to be SI."""

SAME_UNIT = 1e-6
"""Relative difference up to which two factors are the same unit: universal files write them with seven digits and more."""

_SPELT = {"m/s²": "m/s^2", "m/s2": "m/s^2", "m/s**2": "m/s^2", "mm/s²": "mm/s^2", "mm/s2": "mm/s^2", "Nm": "N m", "N*m": "N m"}


def factor(unit: object, quantity: str, *, source: str, field: str) -> float:
    """What a number in `unit` is multiplied with to be in the SI unit of `quantity`.

    Raises
    ------
    BadInput : no unit of this quantity; those on offer are named.
    """
    known = UNITS[quantity]
    name = _SPELT.get(unit, unit) if isinstance(unit, str) else ""
    if name in known:
        return known[name]
    other = next((what for what, units in UNITS.items() if name in units), None)
    a = "an" if quantity[0] in "aeiou" else "a"
    problem = f"must be a unit of {a} {quantity}, found {unit!r}" + (f", a unit of {other}" if other else "")
    raise BadInput(source=source, field=field, problem=problem, remedy=f"{nearest(name, known)}Known are {', '.join(known)}")


def is_unit(text: str) -> bool:
    """Whether `text` is one of the units known here."""
    return any(_SPELT.get(text, text) in units for units in UNITS.values())


def is_same(unit: str, other: str, quantity: str) -> bool:
    """Whether both are the same unit of `quantity`."""
    known = UNITS[quantity]
    sizes = [known.get(_SPELT.get(one, one)) for one in (unit, other)]
    return sizes[0] is not None and sizes[0] == sizes[1]


def named(size: float, quantity: str) -> str:
    """The unit of `quantity` with the factor `size`, or the factor in SI when it has no name."""
    names = [name for name, value in UNITS[quantity].items() if math.isclose(value, size, rel_tol=SAME_UNIT)]
    return names[0] if names else f"{size:.7g} {next(iter(UNITS[quantity]))}"
