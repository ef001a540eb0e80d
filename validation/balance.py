"""A balance and its readings: what resolution, relative error and digit error leave of a figure on a display (paper 3.3).

    [balance]
    resolution = "10 g"         # the last digit of the display; rounding leaves half of it
    relative_error = "0.05 %"   # of the reading: calibration, the same for every reading
    digit_error = 1             # by how many last digits a reading may jump, for each reading anew

A reading r is ``(r + rounding + digits) (1 + relative)``. The relative error is shared by all readings, so it does not average
out and a tare does not remove it from the net mass.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from geometry.quantities import exact, tagged
from validation.measurement_file import Fields

if TYPE_CHECKING:
    from uncertainties import UFloat


@dataclass(frozen=True, eq=False, kw_only=True)
class Balance:
    """A balance.

    Attributes
    ----------
    resolution : value of the last digit [kg]
    digit_error : tolerance of a reading, in last digits
    gain : ``1 + relative error``, one quantity for all readings
    """

    resolution: float
    digit_error: int
    gain: UFloat

    def reading(self, shown: UFloat) -> UFloat:
        """A figure on the display [kg] with its own rounding and digit error, before the gain."""
        rounding = tagged(0.0, self.resolution / 2, "balance resolution")
        digits = tagged(0.0, self.digit_error * self.resolution, "balance digit error")
        return shown + rounding + digits

    def mean(self, readings: Sequence[UFloat]) -> UFloat:
        """Mean [kg] of `readings`, with the scatter of the mean where there are several, and the gain."""
        average = sum(readings) / len(readings)
        return (average + _scatter_of(readings)) * self.gain


def balance(fields: Fields) -> Balance:
    """The balance described by the table ``[balance]``.

    Raises
    ------
    BadInput : a key missing, unknown, or out of range.
    """
    fields.only(("name", "resolution", "relative_error", "digit_error"))
    relative = fields.quantity("relative_error", "ratio")
    if relative.nominal_value < 0 or relative.std_dev:
        raise fields.refused("relative_error", "it is a tolerance, not negative and without one", 'Write it like "0.05 %"')
    return Balance(
        resolution=fields.positive("resolution", "mass").nominal_value,
        digit_error=fields.integer("digit_error", 0, 0),
        gain=tagged(1.0, relative.nominal_value, "balance relative error"),
    )


def _scatter_of(readings: Sequence[UFloat]) -> UFloat:
    if len(readings) < 2:
        return exact(0.0)
    shown = np.array([reading.nominal_value for reading in readings])
    return tagged(0.0, float(shown.std(ddof=1) / np.sqrt(len(shown))), "scatter of the readings")
