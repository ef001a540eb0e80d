"""`ChainTruth`: what load cells, summation box and accelerometers really are, beside what the campaign file says they are.

The table of channels in the file holds nominal places and directions; here stand the deviations from it, by channel. An effect of
the measurement side is another `ChainTruth`: `dataclasses.replace`, or one of the changes below, which add to what was drawn.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array, frozen

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
        for name, shape in (("cell_stiffness", (CELLS, 3)), ("crosstalk", (3, 3)), ("plane_offset", (2,)), ("compliance", (2,))):
            object.__setattr__(self, name, frozen(getattr(self, name), shape, name))

    def more_gain(self, channel: str, value: float) -> ChainTruth:
        """`channel` reads (1 + `value`) times what it did."""
        before = self.gain.get(channel, 0.0)
        return replace(self, gain={**self.gain, channel: (1 + before) * (1 + value) - 1})

    def later(self, channel: str, seconds: float) -> ChainTruth:
        """`channel` comes later by `seconds`."""
        return replace(self, delay={**self.delay, channel: self.delay.get(channel, 0.0) + seconds})

    def moved(self, channel: str, offset: npt.ArrayLike) -> ChainTruth:
        """The accelerometer `channel` sits `offset` (3,) [m] farther from its nominal position."""
        return replace(self, position={**self.position, channel: self.position.get(channel, np.zeros(3)) + np.asarray(offset)})

    def turned(self, channel: str, rotation: npt.ArrayLike) -> ChainTruth:
        """The accelerometer `channel` is turned by `rotation` (3,) [rad] more, a small vector."""
        return replace(self, angle={**self.angle, channel: self.angle.get(channel, np.zeros(3)) + np.asarray(rotation)})

    def stiffer(self, cell: int, axis: int, value: float) -> ChainTruth:
        """Cell `cell` (from 0) is (1 + `value`) times as stiff along `axis` (0, 1, 2)."""
        changed = np.array(self.cell_stiffness)
        changed[cell, axis] = (1 + changed[cell, axis]) * (1 + value) - 1
        return replace(self, cell_stiffness=changed)
