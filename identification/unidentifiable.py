"""`Unidentifiable`: data that leave a combination of the unknowns open, with the evidence."""

from __future__ import annotations

from geometry.arrays import Array
from geometry.errors import CheckFailed


class Unidentifiable(CheckFailed):
    """Data that leave a combination of the unknowns open.

    Attributes
    ----------
    singular_values : of the equations, every unknown scaled to a column of length 1; descending
    null_direction : the combination of the scaled unknowns that the data say least about, of length 1
    undetermined : names of the unknowns that take part in what is open
    """

    def __init__(self, message: str, *, singular_values: Array, null_direction: Array, undetermined: tuple[str, ...]) -> None:
        self.singular_values = singular_values
        self.null_direction = null_direction
        self.undetermined = undetermined
        super().__init__(message, singular_values=singular_values, null_direction=null_direction, undetermined=undetermined)
