"""Do two channel tables say the same of one hardware? Positions count as seen from F: a frame is everyone's own."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from geometry.arrays import Array
from geometry.sensors import Channel
from identification.campaign import Campaign

SAME = 1e-6
"""[m], and of unit vectors: what two files may differ by that mean the same place."""

MOUNTED = "article"
"""The group that goes with what is tested, and not with the hardware."""

SAYS = {"quantity": "measures", "group": "belongs to the group", "senses_gravity": "senses gravity:"}


def difference(one: Campaign, other: Campaign) -> str:
    """The first thing in which the channel tables of two campaigns differ, in words; empty where there is none."""
    differences = (*_missing(one, other), *_missing(other, one))
    return next(iter(differences), "") or next(_said_otherwise(one, other), "") or _placed_otherwise(one, other)


def _channels(campaign: Campaign) -> dict[str, Channel]:
    return {channel.name: channel for channel in campaign.table.channels if channel.group != MOUNTED}


def _missing(one: Campaign, other: Campaign) -> list[str]:
    names = [name for name in _channels(one) if name not in _channels(other)]
    return [f"{names[0]} is a channel of {one.source} and not of {other.source}"] if names else []


def _said_otherwise(one: Campaign, other: Campaign) -> Iterator[str]:
    there = _channels(other)
    for name, a in _channels(one).items():
        for key, says in SAYS.items():
            here, said = getattr(a, key), getattr(there[name], key)
            if here != said:
                yield f"{name} {says} {here} in {one.source} and {said} in {other.source}"
        if len(a.places) != len(there[name].places):
            yield f"{name} adds up {len(a.places)} places in {one.source} and {len(there[name].places)} in {other.source}"
        for first, second in zip(a.places, there[name].places, strict=False):
            if _apart(first.direction, second.direction):
                ways = _vector(first.direction), _vector(second.direction)
                yield f"{name} points along {ways[0]} in {one.source} and along {ways[1]} in {other.source}"


def _placed_otherwise(one: Campaign, other: Campaign) -> str:
    there = _channels(other)
    places = [
        (name, a.position - one.table.origin, b.position - other.table.origin)
        for name, channel in _channels(one).items()
        for a, b in zip(channel.places, there[name].places, strict=True)
    ]
    moved = [(name, a, b) for name, a, b in places if _apart(a, b)]
    if not moved:
        return ""
    name, a, b = moved[0]
    if len(moved) == len(places) and not any(_apart(y - x, b - a) for _, x, y in moved):
        shift = _vector(b - a)
        return f"every channel lies {shift} m farther from F than in {one.source}: one `frame.origin` is not that of F"
    return f"{name} lies at {_vector(a)} m from F in {one.source} and at {_vector(b)} m in {other.source}"


def _apart(a: Array, b: Array) -> bool:
    return bool(np.abs(a - b).max() > SAME)


def _vector(values: Array) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in np.round(values, 9) + 0.0) + ")"
