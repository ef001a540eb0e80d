"""`Layout`: where the 22 pick-ups of the virtual shaker sit, by the names of the campaign format.

    table-z1 .. z3, table-x1, table-y1, y2     on the table, outside the FMD's mounting plate: the pilots of the control
    cover-z1 .. z4                             on the corners of the cover plate, from above
    cover-x1, x2, y1, y2                       on its sides
    fmd-x12, x34, y14, y23                     two cells on one line of action each, by the summation box
    fmd-z1 .. z4                               one cell each

Cells and corners are numbered counter-clockwise from +x +y. Frame: origin F, the centre of the force-measuring plane, z up.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array, frozen
from geometry.sensors import Channel, ChannelTable, Place

ALONG = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}

ACCELEROMETERS: Mapping[str, tuple[float, float, float]] = {
    "table-z1": (0.260, 0.0, -0.055),
    "table-z2": (-0.160, 0.240, -0.055),
    "table-z3": (-0.160, -0.240, -0.055),
    "table-x1": (0.0, -0.270, -0.055),
    "table-y1": (0.270, 0.0, -0.055),
    "table-y2": (-0.270, 0.0, -0.055),
    "cover-z1": (0.185, 0.185, 0.045),
    "cover-z2": (-0.185, 0.185, 0.045),
    "cover-z3": (-0.185, -0.185, 0.045),
    "cover-z4": (0.185, -0.185, 0.045),
    "cover-x1": (0.200, 0.150, 0.025),
    "cover-x2": (0.200, -0.150, 0.025),
    "cover-y1": (0.150, 0.200, 0.025),
    "cover-y2": (-0.150, 0.200, 0.025),
}
"""Nominal place [m] by name; the letter says along what it measures."""

FORCES: Mapping[str, tuple[int, ...]] = {
    "fmd-x12": (1, 2),
    "fmd-x34": (3, 4),
    "fmd-y14": (1, 4),
    "fmd-y23": (2, 3),
    "fmd-z1": (1,),
    "fmd-z2": (2,),
    "fmd-z3": (3,),
    "fmd-z4": (4,),
}
"""The cells that a channel adds up, by name; the letter says along what."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Layout:
    """Nominal places of all sensing elements.

    Attributes
    ----------
    table : the channels as a campaign file states them
    cells : (4, 3) [m] middles of the load cells
    """

    table: ChannelTable
    cells: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "cells", frozen(self.cells, (np.shape(self.cells)[0], 3), "cells"))

    def cells_of(self, channel: Channel) -> tuple[int, ...]:
        """The cells (from 0) that a force `channel` adds up."""
        return tuple(int(np.argmin(np.linalg.norm(self.cells - place.position, axis=1))) for place in channel.places)


def mavis(cells: npt.ArrayLike, noise_rms: Mapping[str, float]) -> Layout:
    """The layout of the paper's 22 signals over load `cells` (4, 3) [m].

    Parameters
    ----------
    noise_rms : known noise floor by quantity [m/s², N]; 0 is left unsaid
    """
    middles = np.asarray(cells, dtype=np.float64)
    floor = {quantity: value or None for quantity, value in noise_rms.items()}
    accelerations = [_accelerometer(name, floor.get("acceleration")) for name in ACCELEROMETERS]
    forces = [_force(name, middles, floor.get("force")) for name in FORCES]
    return Layout(table=ChannelTable(channels=(*accelerations, *forces)), cells=middles)


def letter(channel: str) -> str:
    """The axis that the name of a channel states: x of ``cover-x1``."""
    return channel.split("-")[1][0]


def _accelerometer(name: str, noise: float | None) -> Channel:
    group = name.split("-")[0]
    place = Place(position=np.array(ACCELEROMETERS[name]), direction=np.array(ALONG[letter(name)]))
    return Channel(name=name, quantity="acceleration", group=group, places=(place,), reference=group == "table", noise_rms=noise)


def _force(name: str, cells: Array, noise: float | None) -> Channel:
    direction = np.array(ALONG[letter(name)])
    places = tuple(Place(position=cells[number - 1], direction=direction) for number in FORCES[name])
    return Channel(name=name, quantity="force", group="fmd", places=places, noise_rms=noise)
