"""`Campaign`: everything recorded for one test article on the shaker, and how it was recorded.

The nouns behind ``campaign.toml`` (`identification.campaign_file` reads and writes it): what was mounted, where each pick-up sat
(`geometry.sensors`), what each run drove (`Run`, `Excitation`), how spectra are wanted (`Processing`) and the samples themselves.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from geometry.errors import BadInput
from geometry.frames import Pose
from geometry.sensors import ChannelTable
from identification.recording import Recording

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
