"""`Layout`: where the 22 pick-ups of the virtual shaker sit, by the names of the campaign format.

    table-z1 .. z3, table-x1, table-y1, y2     on the table, outside the FMD's mounting plate: the pilots of the control
    cover-z1 .. z4                             on the corners of the cover plate, from above
    cover-x1, x2, y1, y2                       on its sides
    fmd-x12, x34, y14, y23                     two cells on one line of action each, by the summation box
    fmd-z1 .. z4                               one cell each

Cells and corners are numbered counter-clockwise from +x +y. Frame: origin F, the centre of the force-measuring plane, z up.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from hashlib import blake2b
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from geometry.frames import Array, freeze, frozen
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


def mavis(
    cells: npt.ArrayLike, noise_rms: Mapping[str, float], on_article: Mapping[str, npt.ArrayLike] = MappingProxyType({})
) -> Layout:
    """The layout of the paper's 22 signals over load `cells` (4, 3) [m].

    Parameters
    ----------
    noise_rms : known noise floor by quantity [m/s², N]; 0 is left unsaid
    on_article : (3,) [m] from F of further accelerometers by name, ``mast-top-x``; its last letter says along what
    """
    middles = np.asarray(cells, dtype=np.float64)
    floor = {quantity: value or None for quantity, value in noise_rms.items()}
    channels = []
    for name, position in {**ACCELEROMETERS, **on_article}.items():
        group, noise = "article" if name in on_article else name.split("-")[0], floor.get("acceleration")
        one = Channel(
            name=name,
            quantity="acceleration",
            group=group,
            places=(
                Place(position=np.array(position), direction=np.array(ALONG[name[-1] if name in on_article else letter(name)])),
            ),
            reference=group == "table",
            noise_rms=noise,
        )
        channels.append(one)
    for name, numbers in FORCES.items():
        places = tuple(Place(position=middles[k - 1], direction=np.array(ALONG[letter(name)])) for k in numbers)
        channels.append(Channel(name=name, quantity="force", group="fmd", places=places, noise_rms=floor.get("force")))
    return Layout(table=ChannelTable(channels=tuple(channels)), cells=middles)


def letter(channel: str) -> str:
    """The axis that the name of a channel states: x of ``cover-x1``."""
    return channel.split("-")[1][0]


# `ChainTruth`: what load cells, summation box and accelerometers really are, beside what the campaign file says they are.
#
# The table of channels in the file holds nominal places and directions; here stand the deviations from it, by channel. An effect
# of the measurement side is another `ChainTruth`: `dataclasses.replace`, or one of the changes below, which add to what was
# drawn.


CELLS = 4
"""Load cells of the FMD, counter-clockwise from +x +y."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ChainTruth:
    """A measurement chain as it is. A channel that is not named in a mapping has nothing of it.

    Attributes
    ----------
    gain : relative error of a channel: it reads 1 + gain
    delay : [s] by which a channel comes late
    position : (3,) [m] true less nominal position of an accelerometer
    angle : (3,) [rad] rotation vector that turns the nominal direction of an accelerometer into the true one
    cell_stiffness : (4, 3) relative change of every load cell's stiffness along x, y, z
    crosstalk : (3, 3) share of the resultant force along x, y, z (columns) that shows in the channels of another axis (rows), all
        of them alike; the diagonal is zero
    plane_offset : (2,) [m] unmeasured cell moments: M_y loses `plane_offset[0]` F_x, M_x gains `plane_offset[1]` F_y
    compliance : (2,) factors on the lateral and the vertical compliance of all load cells
    gravity, accelerometer_tilt : 1, or 0 for the half of gravity that is switched off: of the structure, of the accelerometers
    noise_rms : broadband noise of a channel [m/s², N]
    mains : amplitude of the mains' hum in a channel [m/s², N]
    """

    gain: Mapping[str, float] = field(default_factory=dict)
    delay: Mapping[str, float] = field(default_factory=dict)
    position: Mapping[str, Array] = field(default_factory=dict)
    angle: Mapping[str, Array] = field(default_factory=dict)
    cell_stiffness: Array = field(default_factory=lambda: np.zeros((CELLS, 3)))
    crosstalk: Array = field(default_factory=lambda: np.zeros((3, 3)))
    plane_offset: Array = field(default_factory=lambda: np.zeros(2))
    compliance: Array = field(default_factory=lambda: np.ones(2))
    gravity: float = 1.0
    accelerometer_tilt: float = 1.0
    noise_rms: Mapping[str, float] = field(default_factory=dict)
    mains: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in ("gain", "delay", "noise_rms", "mains"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))
        for name in ("position", "angle"):
            vectors = {channel: frozen(value, (3,), f"{name}.{channel}") for channel, value in getattr(self, name).items()}
            object.__setattr__(self, name, MappingProxyType(vectors))
        freeze(self, cell_stiffness=(CELLS, 3), crosstalk=(3, 3), plane_offset=(2,), compliance=(2,))

    def more_gain(self, channel: str, value: float) -> "ChainTruth":
        """`channel` reads (1 + `value`) times what it did."""
        before = self.gain.get(channel, 0.0)
        return replace(self, gain={**self.gain, channel: (1 + before) * (1 + value) - 1})

    def later(self, channel: str, seconds: float) -> "ChainTruth":
        """`channel` comes later by `seconds`."""
        return replace(self, delay={**self.delay, channel: self.delay.get(channel, 0.0) + seconds})

    def moved(self, channel: str, offset: npt.ArrayLike) -> "ChainTruth":
        """The accelerometer `channel` sits `offset` (3,) [m] farther from its nominal position."""
        return replace(self, position={**self.position, channel: self.position.get(channel, np.zeros(3)) + np.asarray(offset)})

    def turned(self, channel: str, rotation: npt.ArrayLike) -> "ChainTruth":
        """The accelerometer `channel` is turned by `rotation` (3,) [rad] more, a small vector."""
        return replace(self, angle={**self.angle, channel: self.angle.get(channel, np.zeros(3)) + np.asarray(rotation)})

    def stiffer(self, cell: int, axis: int, value: float) -> "ChainTruth":
        """Cell `cell` (from 0) is (1 + `value`) times as stiff along `axis` (0, 1, 2)."""
        changed = np.array(self.cell_stiffness)
        changed[cell, axis] = (1 + changed[cell, axis]) * (1 + value) - 1
        return replace(self, cell_stiffness=changed)

    def deviations(self) -> Iterator[tuple[str, float]]:
        """Every deviation under its id of the catalogue, SI."""
        for what in ("gain", "delay"):
            for channel, value in getattr(self, what).items():
                yield f"{'force' if channel.startswith('fmd') else 'accelerometer'}-{what}:{channel}", float(value)
        for family, vectors in (("accelerometer-position", self.position), ("accelerometer-misalignment", self.angle)):
            for channel, vector in vectors.items():
                yield from ((f"{family}:{channel}:{axis}", float(v)) for axis, v in zip("xyz", vector, strict=True))
        for (cell, axis), value in np.ndenumerate(self.cell_stiffness):
            yield f"cell-stiffness:{cell + 1}{'xyz'[axis]}", float(value)
        for (to, of), value in np.ndenumerate(self.crosstalk):
            if to != of:
                yield f"force-crosstalk:{'xyz'[to]}{'xyz'[of]}", float(value)


# Random streams by name: what is drawn under a name depends on the seed and on the name, and on nothing that was drawn before.
#
# So a laboratory stays the same when another article is mounted, another run is added, or another tolerance is drawn as well.


def stream(seed: int, *names: str) -> np.random.Generator:
    """The generator of `names` under `seed`; the same on every machine and in every process."""
    key = tuple(int(word) for word in np.frombuffer(_digest(*names), dtype="<u4"))  # four words of 32 bits
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=key))


def token(seed: int, *names: str) -> str:
    """Eight characters that belong to `names` under `seed` and show neither."""
    return _digest(f"{seed}", *names).hex()[:8]


def _digest(*words: str) -> bytes:
    return blake2b("\0".join(words).encode(), digest_size=16, person=b"massline").digest()
