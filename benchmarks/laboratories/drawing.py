"""What a laboratory is that bought its sensors: every deviation drawn flat between the limits of a data sheet.

What belongs to the hardware is drawn once, what comes with a mounting anew for every campaign. A data sheet states limits and no
standard deviation, so nothing here is normal but the damping.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import radians

import numpy as np

from geometry.frames import Array

CELLS = 4


@dataclass(frozen=True, kw_only=True)
class DataSheet:
    """Limits of a class of laboratories: of every figure the largest deviation, but for `damping`.

    Attributes
    ----------
    force, acceleration, table : relative, sensitivity of a channel
    own, other : relative, of what each cell reads along an axis of the force along it, and of the force along another
    transverse : share of the acceleration across its direction that an accelerometer reads, in a direction that nobody knows
    glued : [rad] by which an accelerometer is turned about each axis
    place : [m] of an accelerometer along each axis
    late : [s] of a channel
    corner : [Hz] of the high-pass of a channel that is left when the stated one is divided out
    cell : relative, stiffness of each cell along each axis
    plane : [m] height of the plane in which the cells feel lateral forces
    beside, turned, tilted : [m] and [rad] by which an article stands beside its place, is turned about z and tilted on its seat
    density : relative, of an article as a whole
    bolts : [kg] of every bolt that is there and not drawn, or drawn and not there
    damping : standard deviation of the logarithm of every modal damping ratio
    modulus : relative, of every part's
    fmd : relative, of mass and moments of the moving part
    fmd_cog : [m] of its centre of gravity along each axis
    cross : what the table does on other axes, as a share of the driven one
    """

    force: float
    acceleration: float
    table: float = 0.02
    own: float
    other: float
    transverse: float
    glued: float
    place: float
    late: float
    corner: float
    cell: float
    plane: float
    beside: float
    turned: float
    tilted: float
    density: float
    bolts: float
    damping: float
    modulus: float = 0.04
    fmd: float = 0.05
    fmd_cog: float = 0.8e-3
    cross: float = 0.03


SHEETS: Mapping[str, DataSheet] = {
    "calibrated": DataSheet(
        force=0.005,
        acceleration=0.007,
        own=0.003,
        other=0.0015,
        transverse=0.02,
        glued=radians(0.5),
        place=0.8e-3,
        late=30e-6,
        corner=0.006,
        cell=0.08,
        plane=0.4e-3,
        beside=0.3e-3,
        turned=radians(0.15),
        tilted=radians(0.02),
        density=0.002,
        bolts=0.003,
        damping=0.2,
    ),
    "as-delivered": DataSheet(
        force=0.015,
        acceleration=0.02,
        own=0.01,
        other=0.02,
        transverse=0.05,
        glued=radians(1.0),
        place=1.5e-3,
        late=60e-6,
        corner=0.05,
        cell=0.15,
        plane=0.8e-3,
        beside=1.5e-3,
        turned=radians(0.5),
        tilted=radians(0.1),
        density=0.008,
        bolts=0.025,
        damping=0.4,
    ),
}
"""By class. Three-component quartz cells state cross-talk of at most 1 to 3 % (IEPE accelerometers transverse
sensitivities below 5 %, sensitivities by certificate to 1 to 2 %); certificates of ISO 16063-21 state 0.5 to 1 %."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Mounting:
    """How one article was bolted on.

    Attributes
    ----------
    beside : (3,) [m] true less stated place
    turned : (3,) [rad] rotation vector
    """

    beside: Array
    turned: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class Hardware:
    """FMD, sensors and amplifiers, the same in all campaigns of a laboratory.

    Attributes
    ----------
    gain, late, corner : by channel, see `DataSheet`
    place : (3,) [m] by accelerometer
    direction : (3,) by accelerometer, what is added to its nominal direction
    cells : (4, 3, 3) what a cell reads along x, y, z (rows) of the force on it (columns)
    stiffness : (4, 3) factors on the nominal
    plane : (2,) [m] height of the plane of forces along x, y
    mass, moments : factors on mass and moments of the FMD's moving part
    cog : (3,) [m] of its centre of gravity, true less nominal
    """

    gain: Mapping[str, float]
    late: Mapping[str, float]
    corner: Mapping[str, float]
    place: Mapping[str, Array]
    direction: Mapping[str, Array]
    cells: Array
    stiffness: Array
    plane: Array
    mass: float
    moments: Array
    cog: Array


def hardware(sheet: DataSheet, names: Mapping[str, Array], generator: np.random.Generator) -> Hardware:
    """One laboratory's; `names` are its channels with their nominal directions (3,)."""
    flat = _flat(generator)
    sensors = [name for name in names if not name.startswith("fmd")]
    limits = {"fmd": sheet.force, "table": sheet.table, "cover": sheet.acceleration}
    reads = {name: limits[name.split("-")[0]] for name in names}
    direction = {}
    for name in sensors:
        along, about = names[name], np.array([flat(sheet.glued) for _ in range(3)])
        across = np.cross(along, generator.standard_normal(3))
        share = generator.uniform(0.0, sheet.transverse)
        direction[name] = np.cross(about, along) + share * across / np.linalg.norm(across)
    apart = np.array([[[flat(sheet.own if i == j else sheet.other) for j in range(3)] for i in range(3)] for _ in range(CELLS)])
    return Hardware(
        gain={name: flat(size) for name, size in reads.items()},
        late={name: flat(sheet.late) for name in names},
        corner={name: flat(sheet.corner) for name in names},
        place={name: np.array([flat(sheet.place) for _ in range(3)]) for name in sensors},
        direction=direction,
        cells=np.eye(3) + apart,
        stiffness=1 + np.array([[flat(sheet.cell) for _ in range(3)] for _ in range(CELLS)]),
        plane=np.array([flat(sheet.plane), flat(sheet.plane)]),
        mass=1 + flat(sheet.fmd),
        moments=1 + np.array([flat(sheet.fmd) for _ in range(3)]),
        cog=np.array([flat(sheet.fmd_cog) for _ in range(3)]),
    )


def mounting(sheet: DataSheet, generator: np.random.Generator) -> Mounting:
    """One, which is another every time."""
    flat = _flat(generator)
    beside = np.array([flat(sheet.beside), flat(sheet.beside), flat(sheet.beside) / 5])
    return Mounting(beside=beside, turned=np.array([flat(sheet.tilted), flat(sheet.tilted), flat(sheet.turned)]))


def bolts(sheet: DataSheet, places: Sequence[Array], generator: np.random.Generator) -> Array:
    """(n,) [kg] at each of `places` what is there and not drawn."""
    return np.array([_flat(generator)(sheet.bolts) for _ in places])


def _flat(generator: np.random.Generator) -> Callable[[float], float]:
    return lambda size: float(generator.uniform(-size, size))
