"""Spots in words: what is wrong, where, by how much, and what it follows.

moment about y in the y-sweep of fmd+clumod-1, 11-13 Hz, 9 sigma, 4 % of the dynamic mass, follows the first mast mode
"""

from __future__ import annotations

from collections.abc import Sequence

from geometry.dynamic_mass import MOTIONS
from geometry.observability import LOADS
from validation.comparing.spots import Spot
from validation.comparing.verdicts import figure

SENSED = dict(
    zip(
        LOADS,
        ("force along x", "force along y", "force along z", "moment about x", "moment about y", "moment about z"),
        strict=True,
    )
)
"""A load in words."""

AXES = dict(zip(MOTIONS, ("x", "y", "z", "rotation about x", "rotation about y", "rotation about z"), strict=True))

NAMED = 3
"""Rows or runs that are listed by name; of more, their number is."""


def text(spot: Spot, configurations: int = 2) -> str:
    """One spot; the configuration is left out where there is only one."""
    where = f" of {spot.data_set}" if configurations > 1 else ""
    share = "of the dynamic mass" if spot.of_load else "of what it reads"
    parts = [
        f"{row(spot.row)} in {run(spot.run, spot.axis)}{where}",
        band(spot.band),
        f"{figure(spot.sigma)} sigma",
        f"{figure(spot.percent)} % {share}",
        *([spot.course] if spot.course else []),
    ]
    return ", ".join(parts) + _elsewhere(spot)


def row(name: str) -> str:
    """A channel by its name, a load in words."""
    return SENSED.get(name, name)


def run(name: str, axis: str) -> str:
    """ "the y-sweep", with the name of the run where that says more."""
    if axis not in AXES:
        return f"run {name}"
    swept = f"the {axis}-sweep" if axis in MOTIONS[:3] else f"the {axis} sweep"
    return swept if name == axis else f"{swept} ({name})"


def band(of: tuple[float, float]) -> str:
    """[Hz], with as many digits as tell its ends apart."""
    low, high = (f"{one:.0f}" for one in of)
    if low == high:
        low, high = (f"{one:.1f}" for one in of)
    return f"{low} Hz" if low == high else f"{low}-{high} Hz"


def _elsewhere(spot: Spot) -> str:
    """The same row in other runs and data sets."""
    own = [run(name, name) for data_set, name, _ in spot.elsewhere if data_set == spot.data_set]
    others = list(dict.fromkeys(data_set for data_set, _, _ in spot.elsewhere if data_set != spot.data_set))
    said = [*([listed(own)] if own else []), *others]
    return f"; also in {', '.join(said)}" if said else ""


def listed(names: Sequence[str]) -> str:
    """Up to `NAMED` by name, of more the number of the others."""
    more = len(names) - NAMED
    return ", ".join(names) if more <= 0 else f"{', '.join(names[:NAMED])} and {more} more"
