"""Entries of the 6 x 6 dynamic mass: measured beside predicted, and where on it a click on the residual map leads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import LEVELS, MOTIONS, ComplexArray
from validation.comparing.maps import Map
from validation.desk.comparing import Compared
from validation.pictures.curves import unit


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


@dataclass(frozen=True, eq=False, kw_only=True)
class Curve:
    """One entry of one campaign over frequency, about F, of all that stands on the load cells.

    Attributes
    ----------
    campaign : data set
    load, motion : as of `Entry`
    frequency : (n,) [Hz]
    measured, predicted : (n,) complex, in `unit`
    expected : (n,) standard deviation of their difference by noise and tolerances
    unit : kg, kg m or kg m²
    """

    campaign: str
    load: int
    motion: int
    frequency: Array
    measured: ComplexArray
    predicted: ComplexArray
    expected: Array
    unit: str


def curves(of: Compared, load: int, motion: int) -> tuple[Curve, ...]:
    """The entry of every campaign that tells a dynamic mass."""
    return tuple(
        Curve(
            campaign=pairs.campaign,
            load=load,
            motion=motion,
            frequency=pairs.frequency,
            measured=pairs.measured[:, load, motion],
            predicted=pairs.predicted[:, load, motion],
            expected=pairs.expected[:, load, motion],
            unit=unit(load, motion),
        )
        for pairs in (one.pairs for one in of.maps)
        if pairs is not None
    )


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


def worst(of: Compared) -> Entry | None:
    """Where the worst spot of the comparison is, as an entry to begin with; None where nothing stands out."""
    for spot in of.summary["worst"]:
        cell = Cell(campaign=spot["campaign"], run=spot["run"], row=spot["channel"], frequency=spot["frequency_hz"])
        return entry_of(of, cell)
    return None


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
