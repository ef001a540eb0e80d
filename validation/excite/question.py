"""What was asked of `massline excite`, checked at the door: axes, pattern, band, level, ring-down, route and rates."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from fem.base_excitation.rig import LATERAL, Flange, Friction, Strut
from geometry import toml_file
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.frames import Array
from validation.flexible.model import FlexibleOptions
from validation.output import entry, unwritten

# What is between table and article and what is attached to it, as typed: preloads, joint compliance, cables, dampers, friction.
#
# Keys, units and signs are those of the catalogue of effects: stiffness [N/m], damping [N s/m], compliance [m/N] and [rad/(N
# m)], slip force [N].


CELLS = ("1", "2", "3", "4")

COMPLIANT = {"lateral": (0, 1), "vertical": (2,), "rotation": (3, 4), "torsion": (5,)}
"""Which of x, y, z, alpha, beta, gamma a key of ``--flange`` means."""

ALONG = {"": (0, 1, 2), "lateral": (0, 1), "vertical": (2,)}
"""Which of x, y, z a strut acts along: all, or those after the colon."""

EXAMPLES = {
    "--preload": '--preload "2 kN", or for one cell --preload "3=500 N"',
    "--flange": "--flange rotation=1e-6",
    "--friction": "--friction x=3, or x=3,mass:2",
    "--cable": "--cable mast-top=1000, or mast-top:lateral=1000",
    "--damper": "--damper mast-top=20, or mast-top:vertical=20",
}


@dataclass(frozen=True, kw_only=True)
class Sane:
    """What a size may be: beyond it stiffnesses of one rig lie so far apart that rounding decides, or a unit was mistaken."""

    low: float
    high: float
    unit: str


SHIFTING, TURNING = Sane(low=1e-13, high=1e-3, unit="m/N"), Sane(low=1e-12, high=1e-2, unit="rad/(N m)")
SIZES = {"--cable": Sane(low=1e-3, high=1e9, unit="N/m"), "--damper": Sane(low=1e-3, high=1e7, unit="N s/m")}
SLIP_FORCE, LOOSE_MASS = Sane(low=1e-3, high=1e6, unit="N"), Sane(low=1e-3, high=1e3, unit="kg")


@dataclass(frozen=True, kw_only=True)
class Attached:
    """What the rig has beside the article.

    Attributes
    ----------
    cells : whether the FMD's load cells are springs
    preload : [N] by the number of a cell; empty for cells that never lift off
    flange : None for a rigid joint
    struts : cables to the ground, dampers to the table
    frictions : loose parts on the flange
    """

    cells: bool = False
    preload: Mapping[str, float] = field(default_factory=dict)
    flange: Flange | None = None
    struts: tuple[Strut, ...] = ()
    frictions: tuple[Friction, ...] = ()

    @property
    def options(self) -> tuple[str, ...]:
        """The options by which it was asked for."""
        to = {"ground": "--cable", "table": "--damper"}
        given = {"--cells": self.cells, "--preload": self.preload, "--flange": self.flange, "--friction": self.frictions}
        return (*(option for option, value in given.items() if value), *dict.fromkeys(to[strut.to] for strut in self.struts))


def attached(
    *,
    cells: bool,
    preload: Sequence[str],
    flange: Sequence[str],
    friction: Sequence[str],
    cable: Sequence[str],
    damper: Sequence[str],
) -> Attached:
    """What the options say; whether the article has such places is asked by `validation.excite.rig.require_mountable`.

    Raises
    ------
    BadInput : a text that cannot be read, a value that is not positive or out of all proportion (`Sane`), something said twice, a
        preload without cells.
    """
    loads: dict[str, float] = {}
    for text in preload:
        cell, equals, value = text.partition("=")
        numbers = (_known(cell.strip(), CELLS, "--preload", "cell"),) if equals else CELLS
        size = value if equals else text
        try:
            force = float(toml_file.quantity(size, "force", source="--preload", field="").nominal_value)
        except BadInput as error:
            raise _refused("--preload", error.problem) from None
        if force <= 0:
            raise _refused("--preload", f"a preload presses a cell together and must be positive, found {size.strip()}")
        for number in numbers:
            _once(number in loads, "--preload", f"cell {number}")
            loads[number] = force
    if loads and not cells:
        problem = "only cells that are springs can lift off, and they are rigid here"
        raise BadInput("--preload", "", problem, "Add --cells, or leave the preload out")
    compliance = np.zeros(6)
    for text in flange:
        key, value = _pair("--flange", text)
        motions = list(COMPLIANT[_known(key, COMPLIANT, "--flange", "direction")])
        _once(bool(compliance[motions].any()), "--flange", key)
        compliance[motions] = _sane("--flange", key, value, SHIFTING if motions[0] < 3 else TURNING)
    frictions: dict[str, Friction] = {}
    for text in friction:
        axis, value = _pair("--friction", text)
        _known(axis, LATERAL, "--friction", "axis")
        _once(axis in frictions, "--friction", axis)
        slip, *more = (part.strip() for part in value.split(","))
        masses: dict[str, float] = {}
        for mass in more:
            key, _, size = (part.strip() for part in mass.partition(":"))
            _known(key, ("mass",), "--friction", "property")
            _once(bool(masses), "--friction", key)
            masses[key] = _sane("--friction", key, size, LOOSE_MASS)
        given = {"axis": axis, "slip_force": _sane("--friction", axis, slip, SLIP_FORCE), **masses}
        frictions[axis] = Friction(**given)  # type: ignore[arg-type]  # the axis was compared with those that are known
    return Attached(
        cells=cells,
        preload=loads,
        flange=Flange(compliance=compliance) if flange else None,
        struts=(
            *(Strut(place=place, to="ground", stiffness=size) for place, size in _struts("--cable", cable).items()),
            *(Strut(place=place, to="table", damping=size) for place, size in _struts("--damper", damper).items()),
        ),
        frictions=tuple(frictions.values()),
    )


def _struts(option: str, texts: Sequence[str]) -> dict[str, Array]:
    """What acts at every place along x, y, z (3,)."""
    struts: dict[str, Array] = {}
    for text in texts:
        key, value = _pair(option, text)
        place, _, along = key.partition(":")
        if along:
            _known(along, [name for name in ALONG if name], option, "direction")
        axes, size = list(ALONG[along]), struts.setdefault(place, np.zeros(3))
        _once(bool(size[axes].any()), option, key)
        size[axes] = _sane(option, key, value, SIZES[option])
    return struts


def _pair(option: str, text: str) -> tuple[str, str]:
    key, equals, value = (part.strip() for part in text.partition("="))
    if not (key and equals and value):
        raise _refused(option, f"KEY=VALUE is expected, found {text!r}")
    return key, value


def _sane(option: str, key: str, text: str, sane: Sane) -> float:
    try:
        value = float(text)
    except ValueError:
        raise _refused(option, f"{key} must be a number in SI units, found {text!r}") from None
    if not 0 < value < np.inf:
        raise _refused(option, f"{key} must be positive and finite, found {text}")
    if not sane.low <= value <= sane.high:
        problem = f"{key} must lie between {sane.low:g} and {sane.high:g} {sane.unit}, found {text}"
        raise BadInput(option, "", problem, f"Check its unit, or leave it out; for example {EXAMPLES[option]}")
    return value


def _known(word: str, known: Collection[str], option: str, what: str) -> str:
    if word in known:
        return word
    near = toml_file.nearest(word, known)
    raise BadInput(option, "", f"no {what} is called {word!r}", f"{near}Known are {', '.join(known)}: {EXAMPLES[option]}")


def _once(already: bool, option: str, what: str) -> None:
    if already:
        raise BadInput(option, "", f"{what} is given twice", "Keep one of them")


def _refused(option: str, problem: str) -> BadInput:
    return BadInput(option, "", problem, f"Write for example {EXAMPLES[option]}")


SWEEP, RANDOM, BURST, MULTI = PATTERNS = ("sweep", "random", "burst", "multi")
LINEAR, EXUDYN, LARGE = ROUTES = ("linear", "exudyn", "large")

BAND = (4.0, 32.0)
"""[Hz] where nothing else is said: that of the paper."""

HIGHEST_RATE = 65536.0
"""[Hz] of the output: mechanics that a shaker drives lies far below."""

LONGEST = 900.0
"""[s] of one run: 90 s is a sweep of the paper; ten times that fill the memory of a desk machine at 8 kHz."""

LARGEST_LEVEL = 100.0
LARGEST_CROSS = 0.25
"""Shares are drawn up to twice this, and beyond a half a run no longer drives the axis that it is named after."""


@dataclass(frozen=True, kw_only=True)
class TableDrive:
    """How the table is driven.

    Attributes
    ----------
    axes : of `MOTIONS`, one run each; together in one run by the pattern ``multi``
    every : whether all six were asked for at once: ``multi`` then makes six runs whose phases differ
    pattern : one of `PATTERNS`
    band : [Hz]
    octaves_per_minute : of a sweep
    level : factor on the nominal level of each axis
    cross : share of the driven level on the other axes
    seed : of everything random
    duration : [s] of noise and of bursts; None for as long as their patterns have it
    ring_down : [s] of record after the drive; None for as long as the ringing takes
    """

    axes: tuple[str, ...] = unwritten()
    every: bool = unwritten()
    pattern: str
    band: tuple[float, float] = entry("band_hz", unit="Hz")
    octaves_per_minute: float
    level: float
    cross: float
    seed: int
    duration: float | None = unwritten()
    ring_down: float | None = unwritten()


@dataclass(frozen=True, eq=False, kw_only=True)
class ExciteOptions:
    """What `massline excite` was asked.

    Attributes
    ----------
    article, model : as for `validation.flexible.model.flexible`; the model is None where none was named
    asked : how the flexible model is made
    attached : what the rig has beside the article
    drive : how the table is driven
    route : one of `ROUTES`; None for the one that fits
    rate : [Hz] of the output
    every_mode : whether the number of modes was asked for, and none of them may be left to answer statically
    """

    article: str
    model: str | None
    asked: FlexibleOptions
    attached: Attached
    drive: TableDrive
    route: str | None
    rate: float
    every_mode: bool = False


def drive(
    *,
    axes: Sequence[str],
    every: bool,
    pattern: str,
    band: tuple[float, float],
    octaves_per_minute: float,
    level: float,
    cross: float,
    seed: int,
    duration: str | None,
    ring_down: str,
) -> TableDrive:
    """The options of the drive, checked.

    Raises
    ------
    BadInput : one of them is no such word, no number or out of its range; an axis is named twice, or beside all of them.
    """
    toml_file.one_of(pattern, PATTERNS, source="--pattern", where="")
    low, high = band
    if not (np.isfinite(low) and np.isfinite(high) and 0 < low < high):
        problem = f"a band goes from above 0 Hz up to a higher frequency, found {low:g} to {high:g} Hz"
        raise BadInput("--band", "", problem, "Give the lower end first: --band 4 32")
    _within("--octaves-per-minute", octaves_per_minute, 1e-2, 1e3, "Write 2 for the paper's sweeps")
    _within("--level", level, 1e-6, LARGEST_LEVEL, "1 is the nominal level, 0.5 half of it")
    _within("--cross", cross, 0.0, LARGEST_CROSS, "Write for example 0.03; 0 is a table without cross motion")
    if seed < 0:
        raise BadInput("--seed", "", f"must not be negative, found {seed}", "Give a whole number from 0 on")
    for axis in axes:
        toml_file.one_of(axis, MOTIONS, source="--axis", where="")
    if twice := next((axis for axis in axes if list(axes).count(axis) > 1), None):
        raise BadInput("--axis", "", f"{twice} is named twice", "Name each axis once")
    if every and axes:
        problem = f"all six axes are asked for, and {', '.join(axes)} once more"
        raise BadInput("--all", "", problem, "Give --all or --axis, not both")
    if duration is not None and pattern not in (RANDOM, BURST):
        problem = f"only random and burst have one, the pattern is {pattern}"
        raise BadInput("--duration", "", problem, "Leave it out: band and octaves a minute say how long it takes")
    found = TableDrive(
        axes=tuple(axes) or (MOTIONS if every or pattern == MULTI else MOTIONS[:1]),
        every=every,
        pattern=pattern,
        band=band,
        octaves_per_minute=octaves_per_minute,
        level=level,
        cross=cross,
        seed=seed,
        duration=None if duration is None else _seconds("--duration", duration, 'Write for example "30 s"'),
        ring_down=None if ring_down == "auto" else _seconds("--ring-down", ring_down, 'Write auto, or a time such as "5 s"'),
    )
    sweep = 60 * np.log2(high / low) / octaves_per_minute
    if pattern in (SWEEP, MULTI) and sweep > LONGEST:
        problem = f"a sweep of this band takes {sweep:.4g} s at {octaves_per_minute:g} octaves a minute"
        raise BadInput("--octaves-per-minute", "", problem, f"A run lasts {LONGEST:g} s at most: sweep faster, or a part of it")
    return found


def require_rate(rate: float) -> None:
    """Refuse an output rate that is none; whether it can show what is driven, `fem.base_excitation.response` asks.

    Raises
    ------
    BadInput : it lies outside 1 Hz to `HIGHEST_RATE`.
    """
    _within("--rate", rate, 1.0, HIGHEST_RATE, "Write for example 1024")


def _within(option: str, value: float, low: float, high: float, remedy: str) -> None:
    if not low <= value <= high:
        raise BadInput(option, "", f"must lie between {low:g} and {high:g}, found {value:g}", remedy)


def _seconds(option: str, text: str, remedy: str) -> float:
    try:
        seconds = float(toml_file.quantity(text, "time", source=option, field="").nominal_value)
    except BadInput as error:
        raise BadInput(option, "", error.problem, remedy) from None
    if not 0 <= seconds <= LONGEST:
        raise BadInput(option, "", f"must lie between 0 and {LONGEST:g} s, found {text}", remedy)
    return seconds
