"""The mode nearest a frequency, as a shape that can be drawn and moved."""

from __future__ import annotations

from dataclasses import dataclass

from validation.desk.comparing import Compared
from validation.desk.desk import Desk
from validation.pictures.moving import MovingBody


@dataclass(frozen=True, eq=False, kw_only=True)
class Shape:
    """A mode with its base held, seen from F.

    Attributes
    ----------
    number : from 0, ascending in frequency
    name : "first mast mode"
    frequency, damping_ratio : [Hz], [1], as the plain fit has them
    bodies : vertices at rest, faces, edges, and the displacement of every vertex in any one scale
    scale : factor by which displacements are drawn; times cos(2 pi f t) it moves
    """

    number: int
    name: str
    frequency: float
    damping_ratio: float
    bodies: tuple[MovingBody, ...]
    scale: float


def nearest(of: Compared, campaign: str, frequency: float) -> int | None:
    """Number of the mode of `campaign` whose frequency is nearest, told in octaves; None where there is none."""
    raise NotImplementedError


def shape(of: Desk, found: Compared, campaign: str, number: int) -> Shape:
    """The mode with `number`; a second or two the first time, then quick.

    Raises
    ------
    BadInput : the article is rigid, of the user's own, or has no such mode.
    """
    raise NotImplementedError
