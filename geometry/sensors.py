"""`Channel` and `ChannelTable`: what is measured where, along what, through which summation.

A channel reads the motion or the force at its place along its direction. For a small motion u of the reference point A of a rigid
body, an accelerometer at P along d reads

    y = d^T [G] u          [G] of P seen from A (Eq. 3)

and a load cell at P along d that reads y gives the resultants ``[G]^T d y`` about A: the same row, transposed. A summation box
adds cells; what of their resultants survives the sum is said by `resultants`. Loads are those of the table on the structure.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from math import inf, radians
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry import toml_file
from geometry.errors import BadInput
from geometry.frames import Array, freeze, frozen, rigid_transformation

SI = {"acceleration": "m/s^2", "force": "N", "moment": "N m"}
"""What can be measured, and the unit in which it stands in every array."""

GROUPS = {
    "table": "shaker table, below the FMD",
    "cover": "cover plate of the FMD",
    "fmd": "load cells of the FMD",
    "article": "on the structure",
}
"""Where a channel sits."""

UNIT_LENGTH = 1e-3
"""How far the length of a direction may lie from 1: digits that were typed, not another vector."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Place:
    """Where one sensing element sits and along what it measures.

    Attributes
    ----------
    position : (3,) [m], in the frame of the channel table
    direction : (3,) unit vector of positive output, in the same axes; brought to length 1 from within `UNIT_LENGTH`

    Raises
    ------
    ValueError : shapes, NaN, or a direction that is no unit vector.
    """

    position: Array
    direction: Array

    def __post_init__(self) -> None:
        direction = frozen(self.direction, (3,), "direction")
        length = float(np.linalg.norm(direction))
        if abs(length - 1) > UNIT_LENGTH:
            raise ValueError(f"`direction` must be a unit vector, found {direction.tolist()} of length {length:.6g}")
        unit = direction if abs(length - 1) < 1e-15 else direction / length
        freeze(self, position=(3,))
        object.__setattr__(self, "direction", frozen(unit, (3,), "direction"))


@dataclass(frozen=True, eq=False, kw_only=True)
class Channel:
    """One signal.

    Attributes
    ----------
    name : unique in its table
    quantity : a key of `SI`
    group : a key of `GROUPS`
    places : one, or the several cells that a summation box adds up
    unit : the one of the signal files; arrays and `noise_rms` here are SI whatever it says. Empty stands for the SI unit
    reference : whether the table is controlled by it (a pilot)
    senses_gravity : whether a tilt reads as acceleration; False for what is no accelerometer
    noise_rms : known noise floor, broadband rms of the time signal, in the unit of `SI`; None when it is not known
    """

    name: str
    quantity: str
    group: str
    places: tuple[Place, ...]
    unit: str = ""
    reference: bool = False
    senses_gravity: bool = True
    noise_rms: float | None = None

    def __post_init__(self) -> None:
        if self.quantity not in SI or self.group not in GROUPS:
            raise ValueError(f"`quantity` and `group` must be known words, found {self.quantity!r} and {self.group!r}")
        if not self.places:
            raise ValueError(f"`places` of {self.name} must hold at least one")
        object.__setattr__(self, "places", tuple(self.places))
        object.__setattr__(self, "unit", self.unit or SI[self.quantity])
        object.__setattr__(self, "senses_gravity", self.senses_gravity and self.quantity == "acceleration")

    @property
    def is_sum(self) -> bool:
        """Whether a summation box adds up several cells."""
        return len(self.places) > 1


@dataclass(frozen=True, eq=False, kw_only=True)
class ChannelTable:
    """All channels of a test.

    Attributes
    ----------
    channels : in the order of the columns of every recording, no two of one name
    origin : (3,) [m] coordinates of the reference point, the paper's F, in the frame of the places
    """

    channels: tuple[Channel, ...]
    origin: Array = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        object.__setattr__(self, "channels", tuple(self.channels))
        freeze(self, origin=(3,))
        twice = sorted({name for name in self.names if self.names.count(name) > 1})
        if twice:
            raise ValueError(f"`channels` must have names of their own, found {', '.join(twice)} more than once")

    def __len__(self) -> int:
        return len(self.channels)

    @property
    def names(self) -> tuple[str, ...]:
        """The names, in order."""
        return tuple(channel.name for channel in self.channels)

    @property
    def extent(self) -> float:
        """[m] Largest distance of two places along an axis."""
        return float(np.ptp([place.position for channel in self.channels for place in channel.places], axis=0).max())

    def select(self, *, group: str | Sequence[str] = (), quantity: str | Sequence[str] = ()) -> tuple[int, ...]:
        """Indices of the channels of these groups and quantities; an empty choice takes all."""
        groups, quantities = ((one,) if isinstance(one, str) else tuple(one) for one in (group, quantity))
        return tuple(
            k
            for k, channel in enumerate(self.channels)
            if (not groups or channel.group in groups) and (not quantities or channel.quantity in quantities)
        )

    def subset(self, chosen: Sequence[int]) -> "ChannelTable":
        """The table of the channels at the indices `chosen`."""
        return ChannelTable(channels=tuple(self.channels[k] for k in chosen), origin=self.origin)


def row(place: Place, point: npt.ArrayLike) -> Array:
    """``d^T [G]``: what `place` reads for unit motions of `point` (3,) [m]; (6,), translations [1], rotations [m] (Eq. 3)."""
    return np.asarray(place.direction @ rigid_transformation(place.position - np.asarray(point, dtype=np.float64)))


def motion_rows(channels: Sequence[Channel], point: npt.ArrayLike) -> Array:
    """[G] of accelerometers about `point` (3,) [m]: (n, 6); where several are averaged, the mean of their rows (Eq. 3)."""
    rows = [np.mean([row(place, point) for place in channel.places], axis=0) for channel in channels]
    return np.asarray(rows, dtype=np.float64).reshape(-1, 6)


@dataclass(frozen=True, eq=False, kw_only=True)
class Point:
    """Where a response is taken or a force acts in a test of any structure.

    Attributes
    ----------
    place : of the structure, by a name that its description knows, ``node 117`` or ``dof 20`` (a row of its matrices, from 0)
    direction : (3,) unit vector in the axes of the structure; of a single degree of freedom (1, 0, 0)
    name : of the signal, without colons, which the names of effects are divided by; the place where nothing is said
    position : (3,) [m] where the test states coordinates, in its own frame; None where it does not

    Raises
    ------
    ValueError : a direction that is no unit vector.
    """

    place: str
    direction: npt.ArrayLike = (1.0, 0.0, 0.0)
    name: str = ""
    position: npt.ArrayLike | None = None

    def __post_init__(self) -> None:
        direction = frozen(self.direction, (3,), "direction")
        if abs(float(np.linalg.norm(direction)) - 1) > UNIT_LENGTH:
            raise ValueError(f"`direction` must be a unit vector, found {direction.tolist()}")
        object.__setattr__(self, "direction", frozen(direction / np.linalg.norm(direction), (3,), "direction"))
        object.__setattr__(self, "name", re.sub(r"[:\s]+", "-", (self.name or self.place).strip()))
        if self.position is not None:
            object.__setattr__(self, "position", frozen(self.position, (3,), "position"))


AXES: dict[str, tuple[float, float, float]] = {
    sign + axis: (factor * (axis == "x"), factor * (axis == "y"), factor * (axis == "z"))
    for sign, factor in (("", 1.0), ("+", 1.0), ("-", -1.0))
    for axis in "xyz"
}
"""Directions by the words that files use."""


def point(value: Any, *, source: str, field: str, direction: str = "") -> Point:
    """What a user's file says of one point: ``"tip:-z"``, or a table of `place`, `direction`, `name` and `position` [m].

    Parameters
    ----------
    direction : of `AXES`, of a text that names none; a degree of freedom needs none

    Raises
    ------
    BadInput : neither, no direction, or one that is no unit vector.
    """

    def refused(problem: str) -> BadInput:
        remedy = 'Write "place:x" (y, z, -x ...), or { place = "tip", direction = [0, 0.6, 0.8] }'
        return BadInput(source, field, problem, remedy)

    table = value if isinstance(value, dict) else {"place": value}
    place, along = table.get("place"), table.get("direction")
    if not isinstance(place, str) or not place.strip() or not set(table) <= {"place", "direction", "name", "position"}:
        raise refused(f"must be a point of the structure, found {value!r}")
    stem, _, axis = place.rpartition(":")
    if along is None and stem:
        place, along = stem, axis
    along = ("x" if place.strip().startswith("dof ") else direction) if along is None else along
    if isinstance(along, str) and along.strip().lower() not in AXES:
        raise refused(f"has no direction, found {value!r}" if not along else f"has no axis {along!r}")
    vector = AXES[along.strip().lower()] if isinstance(along, str) else along
    axis = along.strip(" +-").lower() if isinstance(along, str) and not place.strip().startswith("dof ") else ""
    try:
        name = str(table.get("name", f"{place.strip()}:{axis}" if axis else place))
        return Point(place=place.strip(), direction=vector, name=name, position=table.get("position"))
    except (TypeError, ValueError) as error:
        raise refused(str(error)) from None


@dataclass(frozen=True, eq=False, kw_only=True)
class Summation:
    """How force channels come about from sensing elements, and resultants from these.

    Attributes
    ----------
    adds : (n, e) which of the elements every channel adds up
    gives : (6, e) resultants about the reference point for a unit reading of each element: forces [1], moments [m], or [1] where
        the element senses a moment
    elements : (e,) quantity and place of each
    """

    adds: Array
    gives: Array
    elements: tuple[tuple[str, Place], ...]


def summation(channels: Sequence[Channel], point: npt.ArrayLike) -> Summation:
    """The elements behind force and moment `channels`; a cell that several channels share is one element."""
    keys: dict[tuple[object, ...], int] = {}
    gives: list[Array] = []
    elements: list[tuple[str, Place]] = []
    adds = np.zeros((len(channels), sum(len(channel.places) for channel in channels)))
    for k, channel in enumerate(channels):
        for place in channel.places:
            key = (channel.quantity, *np.round(place.position, 9), *np.round(place.direction, 9))
            if key not in keys:
                keys[key] = len(keys)
                moment = np.concatenate([np.zeros(3), place.direction])
                gives.append(moment if channel.quantity == "moment" else row(place, point))
                elements.append((channel.quantity, place))
            adds[k, keys[key]] += 1.0
    return Summation(adds=adds[:, : len(keys)], gives=np.asarray(gives).reshape(-1, 6).T, elements=tuple(elements))


def resultants(channels: Sequence[Channel], point: npt.ArrayLike) -> Array:
    """The six resultants about `point` (3,) [m] from what force and moment `channels` read: (6, n), least squares.

    Cells that one channel adds up share its reading equally. On one line of action that is no assumption: wherever on the line
    the force acts, its moment is the same.
    """
    of = summation(channels, point)
    return np.asarray(of.gives @ np.linalg.pinv(of.adds)) if channels else np.zeros((6, 0))


# `Tolerances`: what an ordinary, careful laboratory does not know of its own measurement chain, one standard deviation each.
#
# The figures are those of the catalogue of effects. Virtual tests draw from them, identification takes them for priors.


@dataclass(frozen=True, kw_only=True)
class Tolerances:
    """Standard deviations of a measurement chain.

    Attributes
    ----------
    gain : relative, of every load-cell channel and of the accelerometers on cover plate and article
    table_gain : relative, of the accelerometers below the FMD
    delay : [s] of every channel
    position : [m] of a pick-up along each axis
    angle : [rad] of a pick-up about each of the two axes across its direction
    cell_stiffness : relative, of each load cell along each axis
    crosstalk : relative, of each load resultant in each other one of the same kind
    fmd_inertia : relative, of the mass and the moments of inertia of the FMD's moving part
    """

    gain: float = 0.003
    table_gain: float = 0.015
    delay: float = 20e-6
    position: float = 0.5e-3
    angle: float = radians(0.3)
    cell_stiffness: float = 0.05
    crosstalk: float = 0.0015
    fmd_inertia: float = 0.05

    def __post_init__(self) -> None:
        for one in fields(self):
            value = getattr(self, one.name)
            if not 0 <= value < inf:
                problem = f"a standard deviation must be finite and not negative, found {value}"
                raise BadInput("tolerances", one.name, problem, "Give it in SI units; 0 is exact")

    def scaled(self, factor: float) -> "Tolerances":
        """All of them times `factor` [1]."""
        return Tolerances(**{one.name: factor * getattr(self, one.name) for one in fields(self)})


def coordinates_of(table: Mapping[str, Any], source: str) -> dict[str, list[float]]:
    """By place its coordinates [m], as numbers or lengths with their unit.

    Raises
    ------
    BadInput : what is no three lengths.
    """
    stated = toml_file.require_table(table.get("coordinates", {}), source=source, where="coordinates")
    found = {}
    for name, three in stated.items():
        field = f"coordinates.{name}"
        if not isinstance(three, list) or len(three) != 3:
            raise BadInput(source, field, f"must be three lengths, found {three!r}", "Write [0.1, 0.0, 0.2]")
        found[str(name)] = [
            float(toml_file.quantity(one, "length", source=source, field=field).n) if isinstance(one, str) else float(one)
            for one in three
        ]
    return found
