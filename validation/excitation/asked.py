"""What was asked of `massline excite`, checked at the door: axes, pattern, band, level, ring-down, route and rates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometry import keys
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from validation.excitation.attached import Attached
from validation.flexible.model import Asked

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
class Drive:
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

    axes: tuple[str, ...]
    every: bool
    pattern: str
    band: tuple[float, float]
    octaves_per_minute: float
    level: float
    cross: float
    seed: int
    duration: float | None
    ring_down: float | None


@dataclass(frozen=True, eq=False, kw_only=True)
class Question:
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
    asked: Asked
    attached: Attached
    drive: Drive
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
) -> Drive:
    """The options of the drive, checked.

    Raises
    ------
    BadInput : one of them is no such word, no number or out of its range; an axis is named twice, or beside all of them.
    """
    _word("--pattern", pattern, PATTERNS)
    _require_band(band)
    _within("--octaves-per-minute", octaves_per_minute, 1e-2, 1e3, "Write 2 for the paper's sweeps")
    _within("--level", level, 1e-6, LARGEST_LEVEL, "1 is the nominal level, 0.5 half of it")
    _within("--cross", cross, 0.0, LARGEST_CROSS, "Write for example 0.03; 0 is a table without cross motion")
    if seed < 0:
        raise BadInput(source="--seed", problem=f"must not be negative, found {seed}", remedy="Give a whole number from 0 on")
    found = Drive(
        axes=_axes(axes, every, pattern),
        every=every,
        pattern=pattern,
        band=band,
        octaves_per_minute=octaves_per_minute,
        level=level,
        cross=cross,
        seed=seed,
        duration=_duration(duration, pattern),
        ring_down=None if ring_down == "auto" else _seconds("--ring-down", ring_down, 'Write auto, or a time such as "5 s"'),
    )
    _require_short(found)
    return found


def require_rate(rate: float) -> None:
    """Refuse an output rate that is none; whether it can show what is driven is asked by `fem.base_excitation.decimation`.

    Raises
    ------
    BadInput : it lies outside 1 Hz to `HIGHEST_RATE`.
    """
    _within("--rate", rate, 1.0, HIGHEST_RATE, "Write for example 1024")


def require_route(route: str | None) -> None:
    """Refuse a route that there is not.

    Raises
    ------
    BadInput : it is none of `ROUTES`.
    """
    if route is not None:
        _word("--route", route, ROUTES)


def _word(option: str, word: str, known: Sequence[str]) -> None:
    if word not in known:
        remedy = keys.nearest(word, known) or "Choose one of them"
        raise BadInput(source=option, problem=f"must be one of {', '.join(known)}, found {word!r}", remedy=remedy)


def _axes(axes: Sequence[str], every: bool, pattern: str) -> tuple[str, ...]:
    for axis in axes:
        _word("--axis", axis, MOTIONS)
    twice = next((axis for axis in axes if list(axes).count(axis) > 1), None)
    if twice is not None:
        raise BadInput(source="--axis", problem=f"{twice} is named twice", remedy="Name each axis once")
    if every and axes:
        problem = f"all six axes are asked for, and {', '.join(axes)} once more"
        raise BadInput(source="--all", problem=problem, remedy="Give --all or --axis, not both")
    if axes:
        return tuple(axes)
    return MOTIONS if every or pattern == MULTI else MOTIONS[:1]


def _require_band(band: tuple[float, float]) -> None:
    low, high = band
    if not (np.isfinite(low) and np.isfinite(high) and 0 < low < high):
        problem = f"a band goes from above 0 Hz up to a higher frequency, found {low:g} to {high:g} Hz"
        raise BadInput(source="--band", problem=problem, remedy="Give the lower end first: --band 4 32")


def _within(option: str, value: float, low: float, high: float, remedy: str) -> None:
    if not low <= value <= high:
        raise BadInput(source=option, problem=f"must lie between {low:g} and {high:g}, found {value:g}", remedy=remedy)


def _duration(text: str | None, pattern: str) -> float | None:
    if text is None:
        return None
    if pattern not in (RANDOM, BURST):
        problem = f"only random and burst have one, the pattern is {pattern}"
        raise BadInput(
            source="--duration", problem=problem, remedy="Leave it out: band and octaves a minute say how long it takes"
        )
    return _seconds("--duration", text, 'Write for example "30 s"')


def _seconds(option: str, text: str, remedy: str) -> float:
    from geometry.quantities import quantity

    try:
        seconds = float(quantity(text, "time", source=option, field="").nominal_value)
    except BadInput as error:
        raise BadInput(source=option, problem=error.problem, remedy=remedy) from None
    if not 0 <= seconds <= LONGEST:
        raise BadInput(source=option, problem=f"must lie between 0 and {LONGEST:g} s, found {text}", remedy=remedy)
    return seconds


def _require_short(drive: Drive) -> None:
    seconds = 60 * np.log2(drive.band[1] / drive.band[0]) / drive.octaves_per_minute
    if drive.pattern in (SWEEP, MULTI) and seconds > LONGEST:
        problem = f"a sweep of this band takes {seconds:.4g} s at {drive.octaves_per_minute:g} octaves a minute"
        raise BadInput(
            source="--octaves-per-minute",
            problem=problem,
            remedy=f"A run lasts {LONGEST:g} s at most: sweep faster, or a part of it",
        )
