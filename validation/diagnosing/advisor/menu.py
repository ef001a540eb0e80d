"""The menu: every test that could be offered after the present data. What is in them already is not offered."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from validation.diagnosing.advisor import articles, drives, loads, sensors
from validation.diagnosing.advisor.classical import classical
from validation.diagnosing.advisor.offer import Offer
from validation.diagnosing.advisor.planned import Template
from validation.diagnosing.advisor.undone import undone
from validation.engine.prediction import Fact
from validation.models.model import Added


def menu(templates: Sequence[Template], effects: Sequence[Added], facts: Sequence[Fact]) -> Iterator[Offer]:
    """Of a laboratory that has done the campaigns of `templates` and knows `facts`, and wonders about `effects`."""
    asked = tuple(target for one in effects for target in one.named.targets)
    families = [one.named.family for one in effects]
    yield from classical(templates, facts)
    yield from articles.others(templates)
    yield from articles.turned(templates)
    yield from articles.lying(templates)
    yield from loads.on_plate(templates)
    yield from loads.on_article(templates, asked)
    yield from sensors.exchanged(templates, asked)
    yield from sensors.moved(templates, asked)
    yield from sensors.more(templates)
    yield from sensors.without_tilt(templates, families)
    yield from undone(templates, effects)
    yield from drives.lower(templates)
    yield from drives.higher(templates)
    yield from drives.levels(templates, families)
