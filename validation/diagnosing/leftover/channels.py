"""Leftovers in channels: one, or all of a group, that tells a wrong share of what it reads; one that hears what it should not."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from geometry.dynamic_mass import MOTIONS, ComplexArray
from geometry.observability import LOADS
from geometry.sensors import Channel
from validation.diagnosing.leftover.courses import HEARD_FALLING, HEARD_PLAINLY, TILTING, Course
from validation.diagnosing.leftover.places import CHANNEL, GROUP, HEARD, Family, Place
from validation.diagnosing.leftover.tangents import Answers, Swallowing, products
from validation.engine.prediction import Offsets, Prediction
from validation.prediction.series import SeriesPrediction

DIMENSIONS: Mapping[str, tuple[int, int]] = MappingProxyType({"acceleration": (0, 1), "force": (1, 1), "moment": (1, 2)})
"""kg and m of a quantity, all of them per second squared."""


def channels(of: Swallowing, courses: tuple[Course, ...]) -> Family:
    """Channels by themselves and by groups, in shares of what they read."""
    names, table = of.of.prediction.measured.channels, _table(of.of.prediction)
    groups = tuple(dict.fromkeys(one.group for one in table))
    members = [np.array([one.group == group for one in table], dtype=np.float64) for group in groups]
    mixed = np.concatenate([np.eye(len(names)), np.stack(members, axis=1)], axis=1) if members else np.eye(len(names))
    read = predicted(of)
    places = [Place(kind=CHANNEL, channels=(name,)) for name in names]
    for group in groups:
        places.append(Place(kind=GROUP, part=group, channels=tuple(one.name for one in table if one.group == group)))
    made = products(of, read[..., None] * mixed, np.arange(len(names)))
    return Family(places=tuple(places), courses=courses, products=made, root=of.root, slope=of.slope)


def tilting(of: Swallowing) -> Iterator[Family]:
    """All accelerometers, and those of a group, that read gravity where they tilt: along x by beta, along y by minus alpha."""
    table, u = _table(of.of.prediction), of.of.inputs
    sensing = [one.quantity == "acceleration" for one in table]
    if not any(sensing) or u.shape[-1] != len(MOTIONS):
        return
    along = np.array([one.places[0].direction for one in table])
    read = u[..., 4, None] * along[:, 0] - u[..., 3, None] * along[:, 1]
    groups = dict.fromkeys(one.group for one, senses in zip(table, sensing, strict=True) if senses)
    chosen = {"": sensing} | {group: [one.group == group for one in table] for group in groups}
    mixed = np.array(list(chosen.values()), dtype=np.float64).T
    places = tuple(
        Place(kind=GROUP, part=group, channels=tuple(one.name for one, is_in in zip(table, members, strict=True) if is_in))
        for group, members in chosen.items()
    )
    made = products(of, read[..., None] * mixed, np.arange(len(table)))
    yield Family(places=places, courses=(TILTING,), products=made, root=of.root, slope=of.slope)


def predicted(of: Swallowing) -> ComplexArray:
    """(r, m, c) what the channels should read."""
    at = of.of
    return np.asarray((at.predicted.rows @ at.inputs[..., None])[..., 0])


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


def heard(of: Swallowing, offsets: Offsets) -> Iterator[tuple[tuple[Place, ...], Course, Answers]]:
    """Every channel that hears a motion, a load, or another channel."""
    at = of.of
    own = tuple(DIMENSIONS[one.quantity] for one in _table(at.prediction)) or ((0, 0),) * at.values.shape[-1]
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


def _readings(of: Swallowing, offsets: Offsets, own: Sequence[tuple[int, int]]) -> Iterator[Readings]:
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


def _table(prediction: Prediction) -> tuple[Channel, ...]:
    """(c,) what the channels are; nothing is known of those of an accelerance test."""
    if not isinstance(prediction, SeriesPrediction):
        return ()
    by_name = {one.name: one for one in prediction.tested.campaign.table.channels}
    return tuple(by_name[name] for name in prediction.measured.channels)


def _unit(own: tuple[int, int], other: tuple[int, int], course: Course) -> str:
    """Of a reading per unit of what is heard."""
    kg, m = own[0] - other[0], own[1] - other[1]
    powers = (("kg", kg), ("m", m), ("s", -2 if course is HEARD_FALLING else 0))
    above = " ".join(f"{name}^{power}" if power > 1 else name for name, power in powers if power > 0) or "1"
    below = " ".join(f"{name}^{-power}" if power < -1 else name for name, power in powers if power < 0)
    return above if not below else f"{above}/({below})" if " " in below else f"{above}/{below}"
