"""Tests of the menu in which pick-ups are exchanged, moved, added, or feel no tilt."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from geometry.sensors import Channel, ChannelTable, Place
from validation.diagnosing.advisor.articles import named
from validation.diagnosing.advisor.knowledge import Origin
from validation.diagnosing.advisor.offer import Offer
from validation.diagnosing.advisor.planned import Template, planned
from validation.identifying.known import above_fmd

ITS_OWN = ("accelerometer-gain", "accelerometer-delay")
"""What an accelerometer takes along when it is exchanged; place and slant stay with the place."""

WHERE = ("accelerometer-position", "accelerometer-misalignment")
"""What it gets anew when it is moved."""

INWARDS = 0.6
"""Of its distance from the middle of its group, to which an accelerometer is moved."""

PARALLEL = 0.99
"""Cosine between two directions that are the same to a hand."""

TILTED = ("gravity", "accelerometer-tilt", "cable")
"""Families that look like a tilt."""

COVER = "cover"

MOUNTED = (COVER, "table")
"""Groups that a chain predicts."""

AXES = "xyz"


def exchanged(templates: Sequence[Template], asked: Sequence[str]) -> Iterator[Offer]:
    """An accelerometer that is `asked` about and one of the same direction change places."""
    of = templates[0]
    for one in _accelerometers(of, asked):
        for other in _alike(of, one)[:1]:
            pairs = ((one.name, other.name), (other.name, one.name))
            moved = {f"{family}:{a}": Origin(name=f"{family}:{b}") for family in ITS_OWN for a, b in pairs}
            words = f"Run {_beneath(of)} with the accelerometers {one.name} and {other.name} exchanged"
            yield Offer(kind="exchanged", words=words, hours=1.0, test=planned(of, of.tested.campaign), moved=moved)


def moved(templates: Sequence[Template], asked: Sequence[str]) -> Iterator[Offer]:
    """An accelerometer that is `asked` about sits elsewhere, and its new place is measured with care."""
    of = templates[0]
    for one in _accelerometers(of, asked):
        anew = tuple(f"{family}:{one.name}:{axis}" for family in WHERE for axis in AXES)
        campaign = replace(of.tested.campaign, table=_changed(of, [replace(one, places=_inwards(of, one))]))
        words = f"Run {_beneath(of)} with the accelerometer {one.name} moved inwards, and its place measured again"
        yield Offer(
            kind="moved", words=words, hours=1.0, test=planned(of, campaign), moved=dict.fromkeys(anew, Origin()), gone=anew
        )


def more(templates: Sequence[Template]) -> Iterator[Offer]:
    """Every second accelerometer of the cover plate has another one beside it, nearer to the middle."""
    of = templates[0]
    beside = [replace(one, name=f"{one.name}-b", places=_inwards(of, one)) for one in _on(of, COVER)[::2]]
    if beside:
        campaign = replace(of.tested.campaign, table=_changed(of, beside))
        words = f"Run {_beneath(of)} with {len(beside)} more accelerometers on the cover plate"
        yield Offer(kind="more", words=words, hours=2.0, test=planned(of, campaign))


def without_tilt(templates: Sequence[Template], families: Sequence[str]) -> Iterator[Offer]:
    """The motion of the cover plate is measured by what feels no tilt, where one of `families` is about that."""
    for of in templates if set(TILTED) & set(families) else ():
        kinematic = [replace(one, senses_gravity=False) for one in _on(of, COVER) if one.senses_gravity]
        if kinematic:
            campaign = replace(of.tested.campaign, table=_changed(of, kinematic))
            words = f"Run {_beneath(of)} with the motion of the cover plate measured by vibrometers, which feel no tilt"
            yield Offer(kind="tilt", words=words, hours=8.0, test=planned(of, campaign))


def _beneath(of: Template) -> str:
    return named(above_fmd(of.tested.campaign.article))


def _on(of: Template, group: str) -> list[Channel]:
    return [one for one in of.tested.campaign.table.channels if one.group == group and one.quantity == "acceleration"]


def _accelerometers(of: Template, asked: Sequence[str]) -> list[Channel]:
    there = of.tested.campaign.table.channels
    return [one for one in there if one.name in asked and one.quantity == "acceleration" and one.group in MOUNTED]


def _alike(of: Template, one: Channel) -> list[Channel]:
    """Others of its group along the same direction."""
    along = one.places[0].direction
    return [two for two in _on(of, one.group) if two.name != one.name and two.places[0].direction @ along > PARALLEL]


def _inwards(of: Template, one: Channel) -> tuple[Place, ...]:
    middle = np.mean([two.places[0].position for two in _on(of, one.group)], axis=0)
    return tuple(replace(place, position=middle + INWARDS * (place.position - middle)) for place in one.places)


def _changed(of: Template, channels: Sequence[Channel]) -> ChannelTable:
    """The table with `channels` instead of those of their names, and new ones behind."""
    table = of.tested.campaign.table
    by_name = {one.name: one for one in channels}
    kept = [by_name.pop(one.name, one) for one in table.channels]
    return replace(table, channels=(*kept, *by_name.values()))
