"""What effects change: a prediction at its stages, from the matrices of the structure to what the channels read.

Effects act in the order of the model file, stage by stage. Every noun is frozen; an equation returns a changed copy.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from geometry.arrays import Array, frozen
from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput

NOTHING: Mapping[str, Array] = MappingProxyType({})


@dataclass(frozen=True, eq=False, kw_only=True)
class Matrices:
    """Reduced matrices of what stands on its base: ``f = (K + i (omega C + S) - omega² M) x``.

    The first `base` coordinates x are the motions of the base about the article's origin (six, in the order of `MOTIONS`, or
    none where the structure is held); the others are its own, relative to the base.

    Attributes
    ----------
    base : 6 or 0
    mass, stiffness, viscous, structural : (k, k) symmetric, SI
    places : by name (3, k), what each coordinate moves a place along x, y, z
    parts : by name (k, k), the share of a part in `stiffness`
    cog : (3,) [m] of the article as drawn, from its origin
    """

    base: int
    mass: Array
    stiffness: Array
    viscous: Array
    structural: Array
    places: Mapping[str, Array] = field(default_factory=lambda: NOTHING)
    parts: Mapping[str, Array] = field(default_factory=lambda: NOTHING)
    cog: Array = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        k = len(self.mass)
        for name in ("mass", "stiffness", "viscous", "structural"):
            object.__setattr__(self, name, frozen(getattr(self, name), (k, k), name))
        object.__setattr__(self, "cog", frozen(self.cog, (3,), "cog"))


@dataclass(frozen=True, eq=False, kw_only=True)
class Mounted:
    """The dynamic mass of the article on its place.

    Attributes
    ----------
    frequency : (n,) [Hz]
    matrix : (n, 6, 6) of the article, about its origin and in its axes when it stands as drawn
    seat : (3,) [m] where its origin is drawn, from the reference point F
    cog : (3,) [m] of the article as drawn, from its origin
    amplitude : (6,) [m/s², rad/s²] of the base motion of the run, zeros where it is not stated
    sweep_rate : [octaves/s] of the run; 0 where it is not stated
    block : [s] of the blocks of peak-reference-hold, 0 for full-record spectra
    """

    frequency: Array
    matrix: ComplexArray
    seat: Array = field(default_factory=lambda: np.zeros(3))
    cog: Array = field(default_factory=lambda: np.zeros(3))
    amplitude: Array = field(default_factory=lambda: np.zeros(6))
    sweep_rate: float = 0.0
    block: float = 0.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Reading:
    """What every channel reads for a unit of each of the inputs: base motions, or the force of a drive point.

    Attributes
    ----------
    frequency : (n,) [Hz]
    channels : (c,) names
    rows : (n, c, k) complex
    amplitude : (n, c) what each channel reads of the run's motion in time, amplitude in its SI unit; zeros where not stated
    peak : (c,) largest amplitude of each channel in the run that was driven at nominal level; empty where not stated: then the
        largest of `amplitude`
    """

    frequency: Array
    channels: tuple[str, ...]
    rows: ComplexArray
    amplitude: Array = field(default_factory=lambda: np.zeros((0, 0)))
    peak: Array = field(default_factory=lambda: np.zeros(0))

    def column(self, channel: str) -> int:
        """Where `channel` stands in `rows`.

        Raises
        ------
        BadInput : there is no such channel.
        """
        if channel not in self.channels:
            problem = "an effect acts on this channel, and the data have none of that name"
            raise BadInput(source="effect", field=channel, problem=problem, remedy=f"Known are {', '.join(self.channels)}")
        return self.channels.index(channel)


@dataclass(frozen=True, eq=False, kw_only=True)
class Floor:
    """How much noise is expected.

    Attributes
    ----------
    frequency : (n,) [Hz]
    channels : (c,) names
    quantities : (c,) "acceleration", "force" or "moment"
    deviation : (n, c) standard deviation of the complex noise of a line, in the unit of the spectra
    per_rms : (c,) `deviation` for a broadband noise of 1 SI unit rms in the time record; zeros where records are not known
    hum : (n, c) what the mains' ordinary hum leaves at a line, in the unit of the spectra; empty where it is not known
    """

    frequency: Array
    channels: tuple[str, ...]
    quantities: tuple[str, ...]
    deviation: Array
    per_rms: Array
    hum: Array = field(default_factory=lambda: np.zeros((0, 0)))


@dataclass(frozen=True, eq=False, kw_only=True)
class Swing:
    """A pendulum as it was measured.

    Attributes
    ----------
    period : [s] predicted
    amplitude : [rad] of the swing, 0 where not stated
    damping_ratio : [1], 0 where not stated
    mass, inertia : [kg], [kg m²] of what hangs on the ropes, the latter about the axis of the swing
    ropes : number of ropes; 0 for a body on a pivot
    length : [m] of a rope
    radii : (ropes,) [m] of the attachments from the axis
    gravity : [m/s²]
    """

    period: float
    amplitude: float = 0.0
    damping_ratio: float = 0.0
    mass: float = 0.0
    inertia: float = 0.0
    ropes: int = 2
    length: float = 0.0
    radii: Array = field(default_factory=lambda: np.zeros(0))
    gravity: float = 9.81
