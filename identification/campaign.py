"""`Campaign`: everything recorded for one test article on the shaker, and how it was recorded.

The nouns behind ``campaign.toml`` (`identification.campaign_file` reads and writes it): what was mounted, where each pick-up sat
(`geometry.sensors`), what each run drove (`Run`, `Excitation`), how spectra are wanted (`Processing`) and the samples themselves.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations
from types import MappingProxyType
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt

from geometry import cache
from geometry.dynamic_mass import LEVELS, MOTIONS
from geometry.errors import BadInput
from geometry.frames import Array, Pose, freeze
from geometry.inertia import Observability, of_motions, of_resultants
from geometry.sensors import SI, Channel, ChannelTable, motion_rows
from geometry.toml_file import PLAUSIBLE, STANDARD_GRAVITY, nearest
from identification.files.files import Samples, Signals, variable

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
        values, kind = np.asarray(self.values), np.float64 if self.frequency is None else np.complex128
        if values.flags.writeable or values.base is not None or values.dtype != kind:  # what is its own and never changes is kept
            values = np.array(values, dtype=kind)
        if values.ndim != 2 or values.shape[1] != len(self.names):
            raise ValueError(f"`values` must have shape (n, {len(self.names)}), found {values.shape}")
        values.setflags(write=False)
        object.__setattr__(self, "values", values)
        if (self.sampling_rate is None) == (self.frequency is None):
            raise ValueError("give either `sampling_rate` or `frequency`")
        if self.sampling_rate is not None and not 0 < self.sampling_rate < np.inf:
            raise ValueError(f"`sampling_rate` must be positive, found {self.sampling_rate}")
        if self.frequency is not None:
            lines = np.array(self.frequency, dtype=np.float64)
            as_many = lines.shape == values.shape[:1] and np.all(np.isfinite(lines))
            if not as_many or np.any(np.diff(lines) <= 0) or np.any(lines < 0):
                raise ValueError(f"`frequency` must be {len(values)} ascending frequencies, not negative")
            freeze(self, "frequency")

    def __len__(self) -> int:
        return len(self.values)

    @cached_property
    def rms(self) -> Array:
        """(b, c) of every channel in consecutive blocks of `BLOCK` seconds, about the mean of each; of time histories."""
        return block_rms(self.values, self.sampling_rate or 0.0)

    @cached_property
    def digest(self) -> str:
        """Of what was recorded, hexadecimal: channels, samples and where they lie."""
        axis = np.array(self.sampling_rate) if self.frequency is None else self.frequency
        return cache.digest({"names": np.array(self.names), "values": self.values, "axis": axis})

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
            raise BadInput(self.source, name, "there is no such channel", "Check the name")
        column: npt.NDArray[Any] = self.values[:, self.names.index(name)]
        return column


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
        start, stop, rate = (self.figure(key) for key in ("start_hz", "stop_hz", "octaves_per_minute"))
        return None if not (start and stop and rate) else 60 * abs(math.log2(stop / start)) / rate


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
class Instrument:
    """What measured, and when it was last held against a standard: for whoever signs.

    Attributes
    ----------
    name : maker and type
    serial_number : of the instrument
    calibrated, due : dates, ISO 8601; empty where the file does not state them
    channels : names of those that it measured
    """

    name: str
    serial_number: str = ""
    calibrated: str = ""
    due: str = ""
    channels: tuple[str, ...] = ()


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
    date, place, operator, serial_number : of the test and of its article, for whoever signs; ISO 8601; empty when not stated
    instruments : that measured
    cross_motion : of a single-axis shaker the size of the base's other motions, which nobody measured, as a share of the driven
        one (rotations at a metre); 0 where base motions are measured
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
    date: str = ""
    place: str = ""
    operator: str = ""
    serial_number: str = ""
    instruments: tuple[Instrument, ...] = ()
    cross_motion: float = 0.0
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
        raise BadInput(self.source, "run", f"there is no run {name!r}", f"There are {known}")


# Units of signal files. A channel states its own; its samples are multiplied once, where they are read.

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
    raise BadInput(source, field, problem, f"{nearest(name, known)}Known are {', '.join(known)}")


def is_same(unit: str, other: str, quantity: str) -> bool:
    """Whether both are the same unit of `quantity`."""
    known = UNITS[quantity]
    sizes = [known.get(_SPELT.get(one, one)) for one in (unit, other)]
    return sizes[0] is not None and sizes[0] == sizes[1]


def named(size: float, quantity: str) -> str:
    """The unit of `quantity` with the factor `size`, or the factor in SI when it has no name."""
    names = [name for name, value in UNITS[quantity].items() if math.isclose(value, size, rel_tol=SAME_UNIT)]
    return names[0] if names else f"{size:.7g} {next(iter(UNITS[quantity]))}"


# A first look at recorded runs: what the table did, and what the channels read when nothing moved.
#
# Both come from short blocks of the time histories. Spectra have no quiet part and no level; they are left out.

RIGID_GROUPS = ("table", "cover")
"""Groups whose accelerometers may tell the base motion: they move with the table as long as the FMD is stiff."""

NOMINAL = np.array([LEVELS[axis] for axis in MOTIONS])
"""(6,) nominal acceleration of every axis, by which motions are made comparable [m/s², rad/s²]."""

BLOCK = 0.5
"""[s] of a block: two periods of the lowest line that the paper uses."""

DRIVEN = 0.5
"""Share of the strongest block from which a block counts as driven."""

STILL = 2.0
"""How far above those of the quietest block of its run the accelerometers of table and cover plate may read in a quiet block."""

QUIET = 0.05
"""Share of the driven level above which no block of a run is quiet."""


def observed(table: ChannelTable) -> dict[str, Observability]:
    """Every verdict on `table`: the base motion by cover plate, by table and by both, and the resultants."""
    return {
        "base motion by cover": of_motions(table, ("cover",)),
        "base motion by table": of_motions(table, ("table",)),
        "base motion by table and cover": of_motions(table, RIGID_GROUPS),
        "resultants by fmd": of_resultants(table),
    }


@dataclass(frozen=True, eq=False, kw_only=True)
class Levels:
    """What the table did in one run, about the reference point.

    Attributes
    ----------
    amplitude : (6,) of each base motion while it was driven, sqrt(2) times its rms: the amplitude of a sine [m/s², rad/s²]
    share : (6,) the same as a share of the largest, every axis divided by its nominal level [1]
    driven : [s] how long the table was driven
    """

    amplitude: Array
    share: Array
    driven: float

    def __post_init__(self) -> None:
        freeze(self, amplitude=(6,), share=(6,))


def levels(recorded: Recording, table: ChannelTable) -> Levels | None:
    """The levels of one run by Eqs. 6 and 7; None for spectra, records below two blocks, and tables that tell no base motion.

    The cover plate's accelerometers are used where they tell all six motions, else the table's, too.
    """
    known = _KNOWN.get(recorded)
    if known is None or known[0] is not table:
        known = _KNOWN[recorded] = (table, _levels(recorded, table))  # several checks of a campaign ask for the same
    return known[1]


_KNOWN: "WeakKeyDictionary[Recording, tuple[ChannelTable, Levels | None]]" = WeakKeyDictionary()


def _levels(recorded: Recording, table: ChannelTable) -> Levels | None:
    motion = base_motion(recorded, table)
    if motion is None or recorded.sampling_rate is None:
        return None
    rms = block_rms(motion, recorded.sampling_rate)
    if len(rms) < 2:
        return None
    size = np.linalg.norm(rms / NOMINAL, axis=1)
    driven = size > DRIVEN * size.max()
    amplitude = np.sqrt(2 * np.mean(np.square(rms[driven]), axis=0))
    scaled = amplitude / NOMINAL
    return Levels(
        amplitude=amplitude, share=scaled / max(scaled.max(), np.finfo(np.float64).tiny), driven=float(driven.sum() * BLOCK)
    )


def base_motion(recorded: Recording, table: ChannelTable) -> npt.NDArray[Any] | None:
    """The six accelerations (n, 6) of the reference point by Eqs. 6 and 7, of time histories or spectra; None where not told."""
    for groups in (("cover",), RIGID_GROUPS):
        if of_motions(table, groups).complete:
            chosen = table.select(group=groups, quantity="acceleration")
            told = np.zeros((len(table), 6))
            told[list(chosen)] = np.linalg.pinv(motion_rows([table.channels[k] for k in chosen], table.origin)).T
            return np.asarray(recorded.values @ told)
    return None


def noise_floors(campaign: Campaign) -> Array | None:
    """Broadband rms (c,) of every channel while nothing moved, in SI; None where no run has a quiet part.

    A block is quiet when the accelerometers of table and cover plate are. What still rings on the structure is louder than noise,
    so of the quiet blocks of all runs the quieter half of each channel counts.
    """
    blocks = []
    for recorded in campaign.recordings.values():
        quiet = quiet_blocks(recorded, campaign.table)
        if quiet is not None and recorded.sampling_rate is not None:
            blocks.append(recorded.rms[quiet])
    if not blocks:
        return None
    rms = np.sort(np.vstack(blocks), axis=0)
    return np.asarray(np.sqrt(np.mean(np.square(rms[: max(len(rms) // 2, 1)]), axis=0)))


def quiet_blocks(recorded: Recording, table: ChannelTable) -> npt.NDArray[np.bool_] | None:
    """Which of the consecutive blocks of `BLOCK` seconds (b,) are quiet; None for spectra and where no block is."""
    watched = table.select(group=RIGID_GROUPS, quantity="acceleration")
    if recorded.sampling_rate is None or not watched:
        return None
    rms = recorded.rms[:, watched]
    if len(rms) < 2:
        return None
    size = np.linalg.norm(rms, axis=1)
    return np.asarray(size <= STILL * size.min()) if size.min() < QUIET * size.max() else None


def block_length(rate: float) -> int:
    """Samples of a block at `rate` [Hz]."""
    return max(round(BLOCK * rate), 2)


def block_rms(values: Array, rate: float) -> Array:
    """(b, c) rms about the mean of consecutive blocks of (n, c); what does not fill a block at the end is left out."""
    length = block_length(rate)
    count = len(values) // length
    return np.asarray(np.std(values[: count * length].reshape(count, length, -1), axis=1))


# What the runs of a campaign drive together: six motions that are told apart, and no run that is another one once more.

UNDRIVEN = 0.15
"""Share of the largest motion of a run, every axis by its nominal level, below which a run does not drive an axis: cross
motion of real tables stays below."""

SAME = 1e-6
"""Relative difference below which two recordings are one: a copy, or an export of it with fewer digits. Noise is far above."""


def problems_of_runs(campaign: Campaign) -> list[BadInput]:
    """Why six base motions cannot be told from the runs: too few of them, or an axis that none drives."""
    driven = {name: share for name, one in campaign.recordings.items() if (share := shares(one, campaign.table)) is not None}
    # The axes that no run drives, in words; by what the runs say they drive where their motion cannot be told
    if len(driven) == len(campaign.runs) and driven:
        most = np.max(list(driven.values()), axis=0)
        missing = [axis for axis, share in zip(MOTIONS, most, strict=True) if share < UNDRIVEN]
    else:
        said = {run.axis for run in campaign.runs}
        missing = [] if "" in said else [axis for axis in MOTIONS if axis not in said]
    words = f"no run drives {' or '.join(missing)}" if missing else ""
    if len(campaign.runs) < 6:
        many = "1 run" if len(campaign.runs) == 1 else f"{len(campaign.runs)} runs"
        words = f"six base motions take at least six runs, found {many}{f'; {words}' if words else ''}"
    if not words:
        return []
    alike = "".join(f"; {text}" for text in _copies(campaign))
    remedy = "Record a run that drives each axis, or correct which file belongs to which run"
    return [BadInput(campaign.source, "run", words + alike, remedy)]


def warnings_of_runs(campaign: Campaign) -> tuple[str, ...]:
    """Runs that are one and the same, and runs that drive another axis than they say."""
    found = []
    for run in campaign.runs:
        recorded = campaign.recordings.get(run.name)
        share = None if recorded is None or not run.axis else shares(recorded, campaign.table)
        if share is not None and share[MOTIONS.index(run.axis)] < UNDRIVEN:
            most = MOTIONS[int(np.argmax(share))]
            found.append(f"run {run.name} says that it drives {run.axis}, but it drives {most}")
    return tuple(f"{campaign.source}: {text}" for text in (*_copies(campaign), *found))


def shares(recorded: Recording, table: ChannelTable) -> Array | None:
    """(6,) every base motion of a run as a share of its largest, each by its nominal level; None where it cannot be told.

    Places in a doubtful unit tell nothing of rotations: that cause is said where the places are read, and not once a run.
    """
    if not PLAUSIBLE[0] <= table.extent <= PLAUSIBLE[1]:
        return None
    if not recorded.is_spectrum:
        found = levels(recorded, table)
        return None if found is None else found.share
    motion = base_motion(recorded, table)
    if motion is None:
        return None
    size = np.sqrt(np.mean(np.square(np.abs(motion)), axis=0)) / NOMINAL
    return np.asarray(size / max(size.max(), np.finfo(np.float64).tiny))


def _copies(campaign: Campaign) -> list[str]:
    found = []
    for (a, one), (b, other) in combinations(campaign.recordings.items(), 2):
        parts = (slice(None, None, max(len(one) // 100, 1)), slice(None))  # nearly every pair differs in a hundred samples
        alike = one.values.shape == other.values.shape and all(
            np.linalg.norm(one.values[at] - other.values[at]) <= SAME * np.linalg.norm(one.values[at]) for at in parts
        )
        if alike:
            found.append(f"runs {a} and {b} are the same recording")
    return found


# Signals that cannot be true: NaN, infinite, dead, clipped. One channel at a time, named, with what to do.

FLAT = 3
"""Samples in a row at the largest value from which a record may be clipped; rounding alone does that near a slow peak, too."""

OVERSHOOT = 4.0
"""Steps of resolution by which the signal, continued as it arrived, would have passed the flat top: beyond, it was cut off."""

LARGEST_SAMPLE = 1e15
"""In the unit of the file: numbers whose bytes came in another order are of any size at all."""


def require_finite(values: npt.NDArray[Any], name: str, source: str) -> None:
    """Refuse NaN, infinity, and what no sensor reads in the samples (n,) of a channel.

    Raises
    ------
    BadInput : how many there are, and where the first stands.
    """
    parts = (values.real, values.imag) if np.iscomplexobj(values) else (values,)
    if not all(part.min() > -LARGEST_SAMPLE and part.max() < LARGEST_SAMPLE for part in parts if part.size):  # NaN is neither
        bad = ~np.logical_and.reduce([np.abs(part) < LARGEST_SAMPLE for part in parts])
        what = "NaN" if np.any(np.isnan(values)) else f"infinite or beyond {LARGEST_SAMPLE:g}, which no sensor reads"
        problem = (
            f"holds {int(bad.sum())} samples that are {what}, the first is number {int(np.argmax(bad)) + 1} of {len(values)}"
        )
        raise BadInput(source, name, problem, "Export it again, or repeat the run")


def require_alive(values: npt.NDArray[Any], name: str, source: str) -> None:
    """Refuse a channel whose samples (n,) are all the same, or whose spectrum is nothing: that of a base may be 1 everywhere.

    Raises
    ------
    BadInput : it is constant.
    """
    if len(values) and np.all(values == (0 if np.iscomplexobj(values) else values[0])):
        remedy = "Check cable and amplifier, or take the channel out of campaign.toml and of every file"
        raise BadInput(source, name, f"is dead: all {len(values)} samples are {values[0]:g}", remedy)


def clipped(values: Array) -> int:
    """How many samples (n,) of a time history lie on a flat top where the signal was cut off; 0 when it was not.

    Rounding to the steps of a converter leaves short flat tops, too, but the signal arrives there slowly. What was cut off
    arrives at full speed: continued, it would have passed the top by more than `OVERSHOOT` steps.
    """
    ends = ((1.0, values == values.max()), (-1.0, values == values.min()))
    return max((_cut_off(sign * values, at_top) for sign, at_top in ends if np.count_nonzero(at_top) >= FLAT), default=0)


def _cut_off(values: Array, at_top: npt.NDArray[np.bool_]) -> int:
    edges = np.flatnonzero(np.diff(np.concatenate([[False], at_top, [False]]).astype(np.int8)))
    starts, ends = edges[::2], edges[1::2]
    long = (ends - starts >= FLAT) & (starts >= 2)
    starts, ends = starts[long], ends[long]
    if not len(starts):
        return 0
    speed = values[starts - 1] - values[starts - 2]
    passed = speed * (ends - starts) / 4  # a parabola through the arrival, over the flat stretch
    # The smallest difference between two different samples: the converter's step, or rounding
    steps = np.diff(np.unique(values))
    resolution = float(steps.min()) if len(steps) else 0.0
    cut = passed > OVERSHOOT * resolution
    return int(np.sum((ends - starts)[cut]))


# From the contents of a signal file to a `Recording`: the channels of the table, each once, in SI.


def recording(signals: Signals, table: ChannelTable, toml: str) -> tuple[Recording | None, list[BadInput]]:
    """The recording in `signals` and what is wrong with it; None where a channel cannot be used.

    `toml` is what the channel table is called in messages.
    """
    # Samples by the name of the channel table, and the channels that are missing or too many
    is_mat = signals.source.lower().endswith(".mat")
    called: dict[str, str] = {}
    problems = []
    for name in table.names:
        key = variable(name) if is_mat else name
        if key in called:
            problem = f"stands for {called[key]!r} and {name!r}: a MAT file cannot tell them apart"
            problems.append(BadInput(signals.source, key, problem, "Rename one, or export .h5"))
        called[key] = name
    for name in called:
        if name not in signals.samples:
            problem = f"the channel {called[name]!r} is missing"
            like = nearest(name, [other for other in signals.samples if other not in called])
            remedy = f"{like}Export it, or take it out of campaign.toml"
            problems.append(BadInput(signals.source, name, problem, remedy))
    for name in signals.samples:
        if name not in called:
            remedy = "Add it to campaign.toml as a [[channel]], or leave it out of the file"
            problem = "this channel is not in campaign.toml"
            problems.append(BadInput(signals.source, name, problem, remedy))
    samples = {called[name]: values for name, values in signals.samples.items() if name in called}
    for channel in table.channels:
        if channel.name in samples:
            problems += _problems(samples[channel.name], channel, signals, toml)
    if problems:
        return None, problems
    values = np.empty((len(samples[table.names[0]]), len(table.channels)), samples[table.names[0]].dtype, order="F")
    for k, channel in enumerate(table.channels):  # each in one piece, as all that follows wants it
        np.multiply(samples[channel.name], factor_of(channel), out=values[:, k])
    cut = {name: clipped(samples[name].real) for name in table.names}
    flat = "samples lie on a flat top; raise its range and repeat the run, or leave it out"
    warnings = (*signals.warnings, *(f"{signals.source}: {name} is clipped: {n} {flat}" for name, n in cut.items() if n))
    values.setflags(write=False)  # a recording then keeps them as they are
    made = Recording(
        names=table.names,
        values=values,
        sampling_rate=signals.sampling_rate,
        frequency=signals.frequency,
        source=signals.source,
        warnings=warnings if signals.frequency is None else signals.warnings,
    )
    return made, []


def factor_of(channel: Channel) -> float:
    """How many SI units one unit of `channel` is."""
    return factor(channel.unit, channel.quantity, source="channel", field=channel.name)


def _problems(values: Samples, channel: Channel, signals: Signals, toml: str) -> list[BadInput]:
    found = []
    if np.iscomplexobj(values) != (signals.frequency is not None):
        what = "complex" if np.iscomplexobj(values) else "real"
        problem = f"is {what}, where {'time histories are real' if signals.frequency is None else 'spectra are complex'}"
        found.append(BadInput(signals.source, channel.name, problem, "Export it again"))
    for check in (require_finite, require_alive):
        try:
            check(values, channel.name, signals.source)
        except BadInput as error:
            found.append(error)
            break
    # What the signal file says about a unit beside what ``campaign.toml`` says: dataset 164, and the label of the ordinate
    ours, said = factor_of(channel), []
    units, label = signals.units.get(channel.name), signals.labels.get(channel.name, "")
    if units is not None and abs(units.size(channel.quantity) - ours) > SAME_UNIT * ours:
        theirs = units.size(channel.quantity)
        size = f"1 {channel.unit} is {ours:.7g} {SI[channel.quantity]}, the file's unit {theirs:.7g}"
        said.append(
            f"dataset 164 ({units.words}) gives it in {named(theirs, channel.quantity)}, {toml} in {channel.unit}: {size}"
        )
    if any(_SPELT.get(label, label) in units for units in UNITS.values()) and not is_same(label, channel.unit, channel.quantity):
        said.append(f"its axis is labelled {label}, {toml} gives it in {channel.unit}")
    remedy = "Correct the one that is wrong"
    contradictions = [BadInput(signals.source, channel.name, problem, remedy) for problem in said]
    return found + contradictions
