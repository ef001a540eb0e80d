"""What came of one run, in figures: level, loads, cells, resonances, and whether the record holds the ring-down."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fem.base_excitation.response import Response
from fem.base_excitation.rig import Cell, Friction
from fem.base_excitation.small_motion import SmallMotion
from geometry.arrays import Array
from geometry.dynamic_mass import LEVELS, MOTIONS
from validation.excitation.drives import Run
from validation.excitation.passage import Passed


@dataclass(frozen=True, kw_only=True)
class Level:
    """What one driven axis did.

    Attributes
    ----------
    axis : index of it
    asked : [m/s², rad/s²] amplitude of a sine in the band; root mean square of noise at full strength, of a burst in its middle
    realised : of the record: the largest within the band of a sweep; root mean square over the whole drive, soft start and stop
        included
    peak : largest acceleration of the whole drive
    """

    axis: int
    asked: float
    realised: float
    peak: float


@dataclass(frozen=True, kw_only=True)
class CellLoad:
    """The extremes of one load cell [N] as it was simulated, what it is preloaded with not counted.

    Attributes
    ----------
    lowest, highest : along z; the cover plate pulls at a cell where this is negative
    lateral : largest along x or y
    preload : None for a cell that never lifts off
    share_lifted : [1] of the record in which it was off, to `LIFTED` of its preload
    """

    lowest: float
    highest: float
    lateral: float
    preload: float | None
    share_lifted: float


@dataclass(frozen=True, kw_only=True)
class LoosePart:
    """How a loose part behaved as it was simulated.

    Attributes
    ----------
    axis : along which it can slip
    mass : [kg]
    slip_force : [N]
    share_slipping : [1] of the record in which its friction is at its limit
    """

    axis: str
    mass: float
    slip_force: float
    share_slipping: float


@dataclass(frozen=True, kw_only=True)
class RingDown:
    """Whether the record holds the ringing after the drive.

    Attributes
    ----------
    kept : [s] from the end of the drive to that of the record
    needed : [s] from the end of the drive until the ringing has died away
    """

    kept: float
    needed: float

    @property
    def sufficient(self) -> bool:
        """Whether it does, to a millisecond."""
        return self.kept >= self.needed - 1e-3


@dataclass(frozen=True, eq=False, kw_only=True)
class Outcome:
    """One run and what came of it, without its signals.

    Attributes
    ----------
    name, label : of the run
    duration : [s] of the record
    driven : [s] of it
    levels : of the axes that were driven
    cross : [1] largest acceleration of any other axis over its nominal level, over that of the driven ones; 0 when all are driven
    small : whether the table turned little enough
    peak_load : (6,) largest load of each kind [N, N m]
    peak_time : (6,) [s] when
    passed : resonances
    ring_down : what the record holds of it
    cells : extremes of every load cell
    loose : what every loose part did
    step : [s] of the simulation
    settings : how it was found
    warnings : sentences
    """

    name: str
    label: str
    duration: float
    driven: float
    levels: tuple[Level, ...]
    cross: float
    small: SmallMotion
    peak_load: Array
    peak_time: Array
    passed: tuple[Passed, ...]
    ring_down: RingDown
    cells: tuple[CellLoad, ...]
    loose: tuple[LoosePart, ...]
    step: float
    settings: Mapping[str, object]
    warnings: tuple[str, ...]


LIFTED = 1e-3
"""A cell counts as off when less than this share of its preload is left."""


def outcome(
    run: Run,
    response: Response,
    *,
    driven: float,
    small: SmallMotion,
    passed: tuple[Passed, ...],
    needed: float,
    step: float,
    cells: tuple[CellLoad, ...],
    loose: tuple[LoosePart, ...],
    warnings: tuple[str, ...],
) -> Outcome:
    """The figures of `run`, whose table was driven for `driven` [s] and whose ringing takes `needed` [s] more.

    `step` [s] is that of the simulation, where `response` says nothing else.
    """
    size = np.abs(response.load)
    duration = (len(size) - 1) / response.sampling_rate
    return Outcome(
        name=run.name,
        label=run.pattern.label,
        duration=duration,
        driven=driven,
        levels=_levels(run, response, driven),
        cross=_cross(run, response),
        small=small,
        peak_load=size.max(axis=0),
        peak_time=response.time[size.argmax(axis=0)],
        passed=passed,
        ring_down=RingDown(kept=max(duration - driven, 0.0), needed=needed),
        cells=cells,
        loose=loose,
        step=own if isinstance(own := response.settings.get("step_s"), float) else step,
        settings=response.settings,
        warnings=warnings,
    )


def cell_loads(simulated: Response, cells: tuple[Cell, ...]) -> tuple[CellLoad, ...]:
    """The extremes of every one of `cells`, before a filter rounds the corner where one lifts off."""
    return tuple(_cell(simulated.cells[:, k], cell) for k, cell in enumerate(cells))


def loose_parts(simulated: Response, frictions: tuple[Friction, ...]) -> tuple[LoosePart, ...]:
    """How long every one of `frictions` was at its limit."""
    return tuple(
        LoosePart(axis=part.axis, mass=part.mass, slip_force=part.slip_force, share_slipping=share)
        for part, share in zip(frictions, simulated.slipping, strict=True)
    )


def _levels(run: Run, response: Response, driven: float) -> tuple[Level, ...]:
    time = response.time
    band = None if run.sweep is None else [float(run.sweep.time_at(f)) for f in (run.sweep.start, run.sweep.stop)]
    found = []
    for axis in run.axes:
        a = response.table[time <= driven, axis]
        if band is None:
            realised = float(np.sqrt(np.mean(a**2)))
        else:
            realised = float(np.abs(response.table[(time >= band[0]) & (time <= band[1]), axis]).max())
        found.append(Level(axis=axis, asked=float(run.levels[axis]), realised=realised, peak=float(np.abs(a).max())))
    return tuple(found)


def _cross(run: Run, response: Response) -> float:
    size = np.abs(response.table).max(axis=0) / [LEVELS[axis] for axis in MOTIONS]
    driven = np.isin(np.arange(len(MOTIONS)), run.axes)
    return float(size[~driven].max(initial=0.0) / size[driven].max())


def _cell(force: Array, cell: Cell) -> CellLoad:
    preload = cell.preload
    off = 0.0 if preload is None else float(np.mean(force[:, 2] <= -(1 - LIFTED) * preload))
    return CellLoad(
        lowest=float(force[:, 2].min()),
        highest=float(force[:, 2].max()),
        lateral=float(np.abs(force[:, :2]).max()),
        preload=preload,
        share_lifted=off,
    )
