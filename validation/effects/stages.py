"""What effects change: a prediction at its stages, from the matrices of the structure to what the channels read.

Effects act in the order of the model file, stage by stage. Every noun is frozen; an equation returns a changed copy.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import TypeVar

import numpy as np

from fem.structure import Beside
from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array, freeze, frozen
from validation.effects.effect import AT, Values

NOTHING: Mapping[str, Array] = MappingProxyType({})


Kept = TypeVar("Kept")
Changed = TypeVar("Changed")


class Shares(Mapping[str, Kept]):
    """Shares by part that are made whenever they are read: those of hundreds of parts would fill the memory."""

    def __init__(self, names: Iterable[str], made: Callable[[str], Kept]) -> None:
        self._names, self._made = dict.fromkeys(names), made
        self.read: set[str] = set()

    def __getitem__(self, name: str) -> Kept:
        if name not in self._names:
            raise KeyError(name)
        self.read.add(name)
        return self._made(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __or__(self, other: Mapping[str, Kept]) -> dict[str, Kept]:
        return {**self, **other}


def each(shares: Mapping[str, Kept], change: Callable[[Kept], Changed]) -> Mapping[str, Changed]:
    """`change` of every one of `shares`, made when it is read if they are."""
    if isinstance(shares, Shares):
        return Shares(shares, lambda name: change(shares[name]))
    return {name: change(share) for name, share in shares.items()}


@dataclass(frozen=True, eq=False, kw_only=True)
class JointSprings:
    """Springs between two parts, along x, y, z and about them through a point.

    Attributes
    ----------
    loads : (6, k) force [N] and moment [N m] across the joint for each coordinate
    stiffness : (6,) of the springs, zero where there is none
    trace : of the joint's share in the stiffness when `loads` were made; what the share has become since scales both
    """

    loads: Array
    stiffness: Array
    trace: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Matrices:
    """Reduced matrices of a structure: ``f = (K + i (omega C + S) - omega² M) x``.

    The first `base` coordinates x are the motions of the base about the article's origin (six, in the order of `MOTIONS`, or
    none where the structure is held, stands on the ground or floats); the others are its own, relative to the base.

    Attributes
    ----------
    base : 6 or 0
    mass, stiffness, viscous, structural : (k, k) symmetric, SI
    places : by name (3, k), what each coordinate moves a place along x, y, z
    gradients : by name how that changes beside it; none where nobody knows
    parts : by name (k, k), the share of a part in `stiffness`
    cog : (3,) [m] of the article as drawn, from its origin
    part_mass : by name (k, k), the share of a part in `mass`; empty where it is not known
    supports : those of `parts` that are springs to the ground
    joints : those of `parts` that are springs between two others
    sections : by name of a shell or beam, the shares of its stiffness that grow with the thickness and with its cube
    unresolved : by part of a mesh (k, k), by how much its stiffness is too high, as far as its strains tell
    shells : parts of shells
    geometric : (k, k) stiffness that the weight gives or takes under standard gravity; (0, 0) where it is not known
    rigid : (6, k) rigid motion of the article about its origin that each coordinate carries along; by default that of the base
    lossier : root of the factor by which the mode of each of the first coordinates loses more than its parts say
    losses : loss factor by part, by which its share of `stiffness` stands in `structural`
    """

    base: int
    mass: Array
    stiffness: Array
    viscous: Array
    structural: Array
    places: Mapping[str, Array] = field(default_factory=lambda: NOTHING)
    gradients: Mapping[str, Beside] = field(default_factory=lambda: MappingProxyType({}))
    parts: Mapping[str, Array] = field(default_factory=lambda: NOTHING)
    cog: Array = field(default_factory=lambda: np.zeros(3))
    part_mass: Mapping[str, Array] = field(default_factory=lambda: NOTHING)
    supports: tuple[str, ...] = ()
    joints: Mapping[str, JointSprings] = field(default_factory=lambda: MappingProxyType({}))
    sections: Mapping[str, tuple[Array, Array]] = field(default_factory=lambda: MappingProxyType({}))
    unresolved: Mapping[str, Array] = field(default_factory=lambda: NOTHING)
    shells: tuple[str, ...] = ()
    geometric: Array = field(default_factory=lambda: np.zeros((0, 0)))
    rigid: Array = field(default_factory=lambda: np.zeros((0, 0)))
    lossier: Array = field(default_factory=lambda: np.zeros(0))
    losses: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))

    def __post_init__(self) -> None:
        k = len(self.mass)
        freeze(self, mass=(k, k), stiffness=(k, k), viscous=(k, k), structural=(k, k), cog=(3,))
        rigid = np.asarray(self.rigid)
        if not rigid.size:
            rigid = np.eye(6, k) if self.base else np.zeros((6, k))
        object.__setattr__(self, "rigid", frozen(rigid, (6, k), "rigid"))

    @cached_property
    def bodies(self) -> tuple[str, ...]:
        """Parts that have a mass and no stiffness; what is a point mass at one of the places has the name of that place."""
        rows = self.places.values()
        alone = {name: share for name, share in self.part_mass.items() if name not in self.parts and np.trace(share) > 0}
        return tuple(name for name, share in alone.items() if not any(_is_multiple(share, row.T @ row) for row in rows))

    @cached_property
    def once(self) -> tuple[str, ...]:
        """Places by one name each, the last: a test names a node behind a mesh, and coordinates come before any name."""
        names = sorted(self.places, key=lambda name: not name.startswith(AT))
        rows = np.array([self.places[name] for name in names])
        apart = (np.abs(rows[k + 1 :] - rows[k]).max(axis=(1, 2)) for k in range(len(rows)))
        least = ROUNDING * np.abs(rows).max(initial=0.0)
        return tuple(name for name, own in zip(names, apart, strict=True) if np.all(own > least))

    def lost(self, part: str) -> Array:
        """(k, k) share of a part as its losses count: what a mode loses beside them, it loses of all that the part loses."""
        return self.as_lost[:, None] * self.parts[part] * self.as_lost

    @cached_property
    def as_lost(self) -> Array:
        """(k,) root of the factor by which each coordinate loses more than parts say."""
        return np.append(self.lossier, np.ones(len(self.mass) - len(self.lossier)))


ROUNDING = 1e-9
"""Share of a matrix that the rounding of a reduction leaves of what is nothing."""


def _is_multiple(share: Array, square: Array) -> bool:
    """Whether `share` (k, k) is a multiple of `square`, but for rounding."""
    whole = np.trace(square)
    return bool(whole > 0 and np.abs(share - np.trace(share) / whole * square).max() <= ROUNDING * np.abs(share).max())


@dataclass(frozen=True, eq=False, kw_only=True)
class MountedDynamicMass:
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
class ChannelResponse:
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
            raise BadInput("effect", channel, problem, f"Known are {', '.join(self.channels)}")
        return self.channels.index(channel)

    def amplitude_of(self, column: int) -> Array:
        """(n,) amplitude in time of a channel; zeros where the run does not state it."""
        return self.amplitude[:, column] if self.amplitude.size else np.zeros(len(self.frequency))

    def times(self, channel: str, factor: float) -> "ChannelResponse":
        """The same with one channel multiplied."""
        factors = np.ones(len(self.channels))
        factors[self.column(channel)] = factor
        amplitude, peak = (one * np.abs(factors) if one.size else one for one in (self.amplitude, self.peak))
        return replace(self, rows=self.rows * factors[:, None], amplitude=amplitude, peak=peak)


@dataclass(frozen=True, eq=False, kw_only=True)
class NoiseModel:
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
class PendulumSwing:
    """A pendulum as it was measured. Effects move its period away from paper Eq. 5, each by a factor.

    Those of amplitude, damping and rope mass are `validation.classical.pendulum` the other way round. One period is one number:
    all six are exact aliases there, and only two amplitudes, two lengths or the decay tell them apart.

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

    def times(self, factor: float) -> "PendulumSwing":
        """The same with another period."""
        return replace(self, period=self.period * float(factor))

    def stated(self, name: str) -> float:
        """The figure called `name`.

        Raises
        ------
        BadInput : it is not stated.
        """
        value: float = getattr(self, name) if name != "radii" else len(self.radii)
        if value <= 0:
            problem = f"the effect needs the pendulum's {name}, which is not stated"
            raise BadInput("pendulum", name, problem, "State it in the measurement file")
        return value

    @property
    def square(self) -> float:
        """[m²] s1 s2 of two ropes, the mean square of the radii of more: what stands for s² in Eq. 5.

        Raises
        ------
        BadInput : the radii are not stated.
        """
        two = self.stated("radii") == 2
        return float(self.radii[0] * self.radii[1] if two else np.mean(self.radii**2))


NEAREST = 0.1
"""[Hz] from the mains, within which their frequency wanders."""


def leak(frequency: Array, mains: float = 50.0) -> Array:
    """(n,) [1/Hz] standard deviation of what a hum of amplitude 1 at `mains` [Hz] leaves at a line of a full record.

    A record of whole or half periods leaves nothing or twice as much; how it is cut is not known, and the mean square is taken.
    Lines closer than `NEAREST` are as those at that distance.
    """
    away = np.maximum(np.abs(frequency - mains), NEAREST)
    return np.asarray(1 / (2 * np.sqrt(2) * np.pi * away))


# Masses, springs and resonators on reduced matrices: what several families of the structure have in common.


ALONG = {"": (0, 1, 2), "lateral": (0, 1), "vertical": (2,), "x": (0,), "y": (1,), "z": (2,)}
"""Which of x, y, z a direction means."""


def heavier(stage: Matrices, mass: Array) -> Matrices:
    """`stage` with `mass` (k, k) more."""
    return replace(stage, mass=stage.mass + mass)


def with_resonators(stage: Matrices, place: str, axes: tuple[int, ...], values: Values) -> Matrices:
    """`stage` with a resonator along each of `axes` at `place`: mass ``m``, frequency ``f``, damping ratio ``zeta``."""
    # A coordinate more for each, the motion of a mass on a spring relative to ``row @ x``, on which it rides
    more, m, omega = len(axes), values["m"], 2 * np.pi * values["f"]
    rides = np.hstack([stage.places[place][list(axes)], np.eye(more)])
    mass, stiffness, viscous, structural = (
        _grown(a, more, more) for a in (stage.mass, stage.stiffness, stage.viscous, stage.structural)
    )
    mass += m * rides.T @ rides
    own = np.arange(len(mass) - more, len(mass))

    def square(share: Array) -> Array:
        return _grown(share, more, more)

    stiffness[own, own] = omega**2 * m
    viscous[own, own] = 2 * values["zeta"] * omega * m
    return replace(
        stage,
        mass=mass,
        stiffness=stiffness,
        viscous=viscous,
        structural=structural,
        places={name: _grown(rows, 0, more) for name, rows in stage.places.items()},
        gradients={
            name: replace(one, pieces=np.pad(one.pieces, (*4 * [(0, 0)], (0, more)))) for name, one in stage.gradients.items()
        },
        parts=each(stage.parts, square),
        part_mass=each(stage.part_mass, square),
        joints={name: replace(one, loads=_grown(one.loads, 0, more)) for name, one in stage.joints.items()},
        sections=each(stage.sections, lambda both: (square(both[0]), square(both[1]))),
        unresolved=each(stage.unresolved, square),
        geometric=_grown(stage.geometric, more, more) if stage.geometric.size else stage.geometric,
        rigid=_grown(stage.rigid, 0, more),
    )


def _grown(matrix: Array, rows: int, columns: int) -> Array:
    """`matrix` with so many rows and columns of zeros more: hundreds of resonators find `numpy.pad` slow."""
    n, m = matrix.shape
    found = np.zeros((n + rows, m + columns))
    found[:n, :m] = matrix
    return found
