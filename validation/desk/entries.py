"""Entries of the 6 x 6 dynamic mass: measured beside predicted, and where on it a click on the residual map leads."""

from __future__ import annotations

from dataclasses import dataclass

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
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
    raise NotImplementedError


def entry_of(of: Compared, cell: Cell) -> Entry:
    """The entry that shows what a cell of the residual map shows: the run's axis as the motion, and the load that the channel
    takes part in and that deviates most there.

    Raises
    ------
    KeyError : no such campaign, run or row.
    """
    raise NotImplementedError


def entry_name(load: int, motion: int) -> str:
    """As people say it: "f_x / ẍ", "t_y / β̈"."""
    raise NotImplementedError


def entry_unit(load: int, motion: int) -> str:
    """ "kg", "kg m" or "kg m²"."""
    raise NotImplementedError
