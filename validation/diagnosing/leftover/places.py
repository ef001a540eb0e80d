"""Where a leftover may sit: a pair of axes, an axis, a channel, a part - each with what it does to the readings of a data set."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import MOTIONS, ComplexArray
from geometry.observability import LOADS
from validation.diagnosing.leftover.courses import (
    HEARD_FALLING,
    HEARD_PLAINLY,
    OF_PAIRS,
    OF_PARTS,
    OF_SHARES,
    Course,
    resonances,
)
from validation.diagnosing.leftover.tangents import Answers, Pattern, Swallowing, pattern
from validation.engine.prediction import Prediction
from validation.prediction.series import SeriesPrediction

PAIR, AXIS, CHANNEL, HEARD, PART = "pair", "axis", "channel", "heard", "part"

PARTS = ("modulus", "loss", "cell-stiffness", "fmd-compliance", "frequency", "damping")
"""Families of parameters that stand for a part or a mode."""

DIMENSIONS: Mapping[str, tuple[int, int]] = MappingProxyType({"acceleration": (0, 1), "force": (1, 1), "moment": (1, 2)})
"""kg and m of a quantity, all of them per second squared."""


@dataclass(frozen=True, kw_only=True)
class Place:
    """Where.

    Attributes
    ----------
    kind : of those above
    load, motion : of a pair; one of them alone of an axis whose load or motion is told wrongly
    sign : +1 of a pair that is symmetric, -1 of one that is antisymmetric, 0 of one entry alone
    channels : that show it; the first one hears the second
    part : name of the parameter
    unit : of a reading per unit of what is heard; empty where it is not stated
    """

    kind: str
    load: str = ""
    motion: str = ""
    sign: int = 0
    channels: tuple[str, ...] = ()
    part: str = ""
    unit: str = ""


@dataclass(frozen=True, eq=False, kw_only=True)
class Family:
    """Places of one kind in one data set, and the courses that they may take.

    Attributes
    ----------
    places : (q,)
    courses : (k,)
    pattern : of the places, line by line
    """

    places: tuple[Place, ...]
    courses: tuple[Course, ...]
    pattern: Pattern

    def answers(self) -> Answers:
        """(k, q) Of all courses."""
        return self.pattern.following(np.stack([course.of(self.pattern.omega) for course in self.courses]))


def families(of: Swallowing, offsets: Mapping[str, float]) -> Iterator[Family]:
    """All of one data set that go with frequency in ways to be found."""
    omega = 2 * np.pi * of.of.frequency
    shakes = resonances(omega)
    prediction = of.of.prediction
    if isinstance(prediction, SeriesPrediction):
        lines = np.searchsorted(prediction.measured.frequency, of.of.frequency)
        A1, H = prediction.by_load(offsets, lines), prediction.dynamic_mass(offsets, lines)
        yield _pairs(of, A1, (*OF_PAIRS, *shakes))
        yield _axes(of, A1, H)
    yield _channels(of, (*OF_SHARES, *shakes))
    yield from _parts(of)


def _pairs(of: Swallowing, A1: ComplexArray, courses: tuple[Course, ...]) -> Family:
    """Entries of the dynamic mass one by one, and pairs of them alike or opposite."""
    loaded = np.flatnonzero(np.any(A1 != 0, axis=(0, 2)))
    u = of.of.inputs
    readings = np.einsum("mci,rmj->rmcij", A1[:, loaded], u, optimize=True).reshape(*u.shape[:2], len(loaded), 36)
    places, mixed = _mixed()
    single = pattern(of, readings @ mixed, loaded)
    return Family(places=places, courses=courses, pattern=single)


def _mixed() -> tuple[tuple[Place, ...], Array]:
    """Places, and (36, q) of which entries each is the sum."""
    places, columns = [], []
    for i, load in enumerate(LOADS):
        for j, motion in enumerate(MOTIONS):
            places.append(Place(kind=PAIR, load=load, motion=motion))
            columns.append(_entry(i, j))
            if j > i:
                for sign in (1, -1):
                    places.append(Place(kind=PAIR, load=load, motion=motion, sign=sign))
                    columns.append(_entry(i, j) + sign * _entry(j, i))
    return tuple(places), np.stack(columns, axis=1)


def _entry(i: int, j: int) -> Array:
    found = np.zeros(36)
    found[6 * i + j] = 1.0
    return found


def _axes(of: Swallowing, A1: ComplexArray, H: ComplexArray) -> Family:
    """Axes whose load, or whose motion, is told wrongly."""
    u = of.of.inputs
    loaded = np.flatnonzero(np.any(A1 != 0, axis=(0, 2)))
    load = (H @ u[..., None])[..., 0]
    by_load = A1[:, loaded] * load[:, :, None, :]
    by_motion = -(A1[:, loaded] @ H) * u[:, :, None, :]
    places = (*(Place(kind=AXIS, load=one) for one in LOADS), *(Place(kind=AXIS, motion=one) for one in MOTIONS))
    return Family(places=places, courses=OF_SHARES, pattern=pattern(of, np.concatenate([by_load, by_motion], axis=-1), loaded))


def _channels(of: Swallowing, courses: tuple[Course, ...]) -> Family:
    """Channels by themselves, in shares of what they read."""
    names = of.of.prediction.measured.channels
    read = predicted(of)
    readings = np.zeros((*read.shape, len(names)), dtype=np.complex128)
    every = np.arange(len(names))
    readings[:, :, every, every] = read
    places = tuple(Place(kind=CHANNEL, channels=(name,)) for name in names)
    return Family(places=places, courses=courses, pattern=pattern(of, readings, every))


def predicted(of: Swallowing) -> ComplexArray:
    """(r, m, c) what the channels should read."""
    at = of.of
    return np.asarray((at.predicted.rows @ at.inputs[..., None])[..., 0])


def _parts(of: Swallowing) -> Iterator[Family]:
    at = [k for k, name in enumerate(of.names) if name.partition(":")[0] in PARTS and name in of.of.predicted.changes]
    if at:
        places = tuple(Place(kind=PART, part=of.names[k]) for k in at)
        yield Family(places=places, courses=OF_PARTS, pattern=_of_parameters(of, at))


def _of_parameters(of: Swallowing, at: list[int]) -> Pattern:
    m, r, c, p = of.moved.shape
    V = of.moved.reshape(m, r * c, p)
    b = V[:, :, at].conj().swapaxes(1, 2)
    return Pattern(
        omega=2 * np.pi * of.of.frequency,
        score=(b @ of.of.values.transpose(1, 0, 2).reshape(m, r * c, 1))[..., 0],
        own=np.sum(np.abs(V[:, :, at]) ** 2, axis=1),
        cross=np.asarray(b @ V),
        root=of.root,
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class Readings:
    """What a channel may hear, with one course.

    Attributes
    ----------
    course : over frequency
    places : (q,) what is heard, without the channel that hears it
    dimensions : (q,) kg and m of it, seconds left out
    values : (r, m, q) complex
    """

    course: Course
    places: tuple[Place, ...]
    dimensions: tuple[tuple[int, int], ...]
    values: ComplexArray


def heard(of: Swallowing, offsets: Mapping[str, float]) -> Iterator[tuple[tuple[Place, ...], Course, Answers]]:
    """Every channel that hears a motion, a load, or another channel."""
    at, own = of.of, _dimensions(of.of.prediction)
    for one in _readings(of, offsets, own):
        for c, name in enumerate(at.prediction.measured.channels):
            kept = [k for k, place in enumerate(one.places) if name not in place.channels]
            white = one.values[..., kept] * at.weight[:, :, c, None]
            places = tuple(
                replace(
                    one.places[k], channels=(name, *one.places[k].channels), unit=_unit(own[c], one.dimensions[k], one.course)
                )
                for k in kept
            )
            yield places, one.course, _of_channel(of, white, c)


def _of_channel(of: Swallowing, white: ComplexArray, channel: int) -> Answers:
    at = of.of
    b = white.swapaxes(0, 1).reshape(-1, white.shape[-1]).conj().T  # (q, m r)
    V = of.moved[:, :, channel].reshape(b.shape[1], -1)
    free = 0.5 * at.free[:, :, channel, None]
    return Answers(
        score=(b @ at.values[:, :, channel].T.ravel()).real[None],
        own=np.sum(free * np.abs(white) ** 2, axis=(0, 1))[None],
        swallowed=((b @ V).real @ of.root)[None],
    )


def _readings(of: Swallowing, offsets: Mapping[str, float], own: Sequence[tuple[int, int]]) -> Iterator[Readings]:
    at, prediction = of.of, of.of.prediction
    channels = tuple(Place(kind=HEARD, channels=(name,)) for name in prediction.measured.channels)
    yield Readings(course=HEARD_PLAINLY, places=channels, dimensions=tuple(own), values=predicted(of))
    if not isinstance(prediction, SeriesPrediction):
        return
    u = at.inputs
    H = prediction.dynamic_mass(offsets, np.searchsorted(prediction.measured.frequency, at.frequency))
    motions, loads = tuple(Place(kind=HEARD, motion=one) for one in MOTIONS), tuple(Place(kind=HEARD, load=one) for one in LOADS)
    moved, loaded = ((0, 1),) * 3 + ((0, 0),) * 3, ((1, 1),) * 3 + ((1, 2),) * 3
    both = np.concatenate([u, (H @ u[..., None])[..., 0]], axis=-1)
    yield Readings(course=HEARD_PLAINLY, places=(*motions, *loads), dimensions=(*moved, *loaded), values=both)
    falling = u * HEARD_FALLING.of(2 * np.pi * at.frequency)[:, None]
    yield Readings(course=HEARD_FALLING, places=motions, dimensions=moved, values=falling)


def _dimensions(prediction: Prediction) -> tuple[tuple[int, int], ...]:
    """(c,) kg and m of what the channels read."""
    if not isinstance(prediction, SeriesPrediction):
        return ((0, 0),) * len(prediction.measured.channels)
    quantity = {one.name: one.quantity for one in prediction.tested.campaign.table.channels}
    return tuple(DIMENSIONS[quantity[name]] for name in prediction.measured.channels)


def _unit(own: tuple[int, int], other: tuple[int, int], course: Course) -> str:
    """Of a reading per unit of what is heard."""
    kg, m = own[0] - other[0], own[1] - other[1]
    powers = (("kg", kg), ("m", m), ("s", -2 if course is HEARD_FALLING else 0))
    above = " ".join(f"{name}^{power}" if power > 1 else name for name, power in powers if power > 0) or "1"
    below = " ".join(f"{name}^{-power}" if power < -1 else name for name, power in powers if power < 0)
    return above if not below else f"{above}/({below})" if " " in below else f"{above}/{below}"
