"""From what table, cover plate and load cells do to what 22 sensors read: true places, directions, gains and summation.

Every channel is a weighted sum of 28 signals: six accelerations of the table, six of the cover plate, three forces of each of
four cells, and two tilts of the table and of the cover plate, which only count where one half of gravity is switched off.

With both halves on, the motion of a virtual test is the *apparent* acceleration, which the structure feels and the accelerometers
sense alike. With alpha and beta the tilt, apparent and kinematic acceleration differ by

    a_x (kinematic) = a_x (apparent) + g beta,    a_y (kinematic) = a_y (apparent) - g alpha.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fem.base_excitation.driven_states import Channels, cell_forces
from fem.base_excitation.rig_structure import RigStructure
from geometry.arrays import Array, frozen
from geometry.frames import rigid_transformation
from geometry.sensors import Channel
from validation.virtual_test.chain_truth import CELLS, ChainTruth
from validation.virtual_test.layout import Layout, letter

AXES = "xyz"
TABLE, COVER, FORCES = slice(0, 6), slice(6, 12), slice(12, 12 + 3 * CELLS)
TABLE_TILT, COVER_TILT = slice(24, 26), slice(26, 28)
WIDTH = 28

MOTION_OF: Mapping[str, tuple[slice, slice]] = {"table": (TABLE, TABLE_TILT), "cover": (COVER, COVER_TILT)}


@dataclass(frozen=True, eq=False, kw_only=True)
class Sensors:
    """Rows (c, 28) of all channels on the signals of the head of this file, and `delay` (c,) [s]."""

    rows: Array
    delay: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "rows", frozen(self.rows, (len(self.delay), WIDTH), "rows"))
        object.__setattr__(self, "delay", frozen(self.delay, np.shape(self.delay), "delay"))


def sensors(layout: Layout, chain: ChainTruth, gravity: float) -> Sensors:
    """The sensors of `layout` as `chain` says they are; `gravity` in m/s²."""
    channels = layout.table.channels
    rows = np.array([_row(channel, layout, chain, gravity) for channel in channels])
    gains = np.array([1 + chain.gain.get(channel.name, 0.0) for channel in channels])
    delay = np.array([chain.delay.get(channel.name, 0.0) for channel in channels])
    return Sensors(rows=gains[:, None] * rows, delay=delay)


def channels(sensors: Sensors, structure: RigStructure) -> Channels:
    """What all channels read, undelayed and without the tilt of the table, as sums of the motions of a rig."""
    table, forces = np.eye(6, structure.mass.shape[0]), cell_forces(structure)
    rows = sensors.rows
    return Channels(
        names=tuple(f"channel {number}" for number in range(1, len(rows) + 1)),
        acceleration=rows[:, TABLE] @ table + rows[:, COVER] @ structure.cover,
        velocity=rows[:, FORCES] @ forces.velocity,
        displacement=rows[:, FORCES] @ forces.displacement + rows[:, COVER_TILT] @ (structure.cover - table)[3:5],
    )


def tilted(sensors: Sensors, motion: Array) -> Array | float:
    """What the tilt of the table adds to all channels (c, k), `motion` (3, 6, k) of the table; 0 where it cancels."""
    rows = sensors.rows[:, TABLE_TILT] + sensors.rows[:, COVER_TILT]
    return np.asarray(rows @ motion[0, 3:5]) if rows.any() else 0.0


def _row(channel: Channel, layout: Layout, chain: ChainTruth, gravity: float) -> Array:
    return _force(channel, layout, chain) if channel.quantity == "force" else _acceleration(channel, layout, chain, gravity)


def _acceleration(channel: Channel, layout: Layout, chain: ChainTruth, gravity: float) -> Array:
    from scipy.spatial.transform import Rotation

    place, nothing = channel.places[0], np.zeros(3)
    direction = Rotation.from_rotvec(np.array(chain.angle.get(channel.name, nothing))).apply(np.array(place.direction))
    position = place.position + chain.position.get(channel.name, nothing) - layout.table.origin
    motion, tilt = MOTION_OF[channel.group]
    row = np.zeros(WIDTH)
    row[motion] = direction @ rigid_transformation(position)
    row[tilt] = (chain.gravity - chain.accelerometer_tilt) * gravity * np.array([-direction[1], direction[0]])
    return row


def _force(channel: Channel, layout: Layout, chain: ChainTruth) -> Array:
    """A summation of cells; cross-talk of the resultants in equal parts; cell moments that nobody measures."""
    axis = AXES.index(letter(channel.name))
    alike = sum(letter(other.name) == AXES[axis] for other in layout.table.channels if other.quantity == "force")
    cells = np.zeros((CELLS, 3))
    cells[list(layout.cells_of(channel)), axis] = 1.0
    cells += chain.crosstalk[axis] / alike
    if axis == AXES.index("z"):
        cells += _of_moments(layout, chain)[layout.cells_of(channel)[0]]
    row = np.zeros(WIDTH)
    row[FORCES] = cells.ravel()
    return row


def _of_moments(layout: Layout, chain: ChainTruth) -> Array:
    """(4, 3) what the z force of each cell has of a lateral force that acts `plane_offset` off the plane.

    M_y = -sum x f_z loses h_x F_x and M_x = sum y f_z gains h_y F_y.
    """
    x, y = layout.cells[:, 0], layout.cells[:, 1]
    found = np.zeros((CELLS, 3))
    found[:, 0] = chain.plane_offset[0] * x / (x @ x)
    found[:, 1] = chain.plane_offset[1] * y / (y @ y)
    return found
