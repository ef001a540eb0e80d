"""Where a click on the residual map leads on the 6 x 6 dynamic mass."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import LEVELS, MOTIONS
from validation.comparing.maps import Map
from validation.desk.comparing import Compared


@dataclass(frozen=True, kw_only=True)
class Entry:
    """One entry, and a line of it.

    Attributes
    ----------
    campaign : data set
    load, motion : 0 to 5 in the orders of `geometry.observability.LOADS` and `geometry.dynamic_mass.MOTIONS`
    frequency : [Hz] to show
    """

    campaign: str
    load: int
    motion: int
    frequency: float


@dataclass(frozen=True, kw_only=True)
class Cell:
    """A cell of the residual map.

    Attributes
    ----------
    campaign, run, row : data set, its run, and the channel or load
    frequency : [Hz]
    """

    campaign: str
    run: str
    row: str
    frequency: float


def entry_of(of: Compared, cell: Cell) -> Entry:
    """The entry that shows what a cell of the residual map shows.

    The motion is that which the run drives; the load is the cell's own, or of those that its channel tells the one that deviates
    most there. An acceleration is in every load.

    Raises
    ------
    KeyError : no such campaign, run or row.
    """
    found = of.map(cell.campaign)
    run, row = _place(found.runs, cell.run), _place(found.rows, cell.row)
    line = _line(found.frequency, cell.frequency)
    motion = _driven(found, run, line)
    loads = [row - found.channels] if row >= found.channels else list(of.loads_of(cell.campaign, cell.row))
    sigma = np.zeros((6, 6)) if found.pairs is None else found.pairs.sigma[_line(found.pairs.frequency, cell.frequency)]
    most = max(loads, key=lambda load: float(sigma[load, motion]))
    return Entry(campaign=cell.campaign, load=most, motion=motion, frequency=float(found.frequency[line]))


def _line(frequency: Array, wanted: float) -> int:
    return int(np.argmin(np.abs(frequency - wanted)))


def _place(names: Sequence[str], name: str) -> int:
    if name not in names:
        raise KeyError(name)
    return names.index(name)


def _driven(found: Map, run: int, line: int) -> int:
    """The motion that a run drives: that of its axis, else the one that is largest there beside its nominal level."""
    if found.axes[run] in MOTIONS:
        return MOTIONS.index(found.axes[run])
    levels = np.array([LEVELS[axis] for axis in MOTIONS])
    return int(np.argmax(np.abs(found.inputs[run, line, :6]) / levels[: found.inputs.shape[2]]))
