"""Tests of the menu in which a known mass is added to what was tested."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from geometry.arrays import Array
from geometry.articles.locations import locations
from geometry.errors import BadInput
from geometry.inertia import Inertia
from validation.diagnosing.advisor.articles import named
from validation.diagnosing.advisor.offer import Offer
from validation.diagnosing.advisor.planned import Planned, Template, planned
from validation.effects.families.point_mass import change as heavier
from validation.identifying.known import above_fmd
from validation.prediction.carried import Carried
from validation.prediction.series import carried

CORNER, ON_PLATE = "cover-1", 5.0
"""Of the cover plate of the FMD, and the mass [kg] that is put there."""

ON_ARTICLE = 0.5
"""[kg] that is put on a place of the article."""

HOURS = 1.0

MOST = 2
"""Places of an article at which a mass is offered at most."""


def on_plate(templates: Sequence[Template]) -> Iterator[Offer]:
    """On a corner of the cover plate, beside what stands there: it loads one cell more than the others."""
    of = templates[0]
    place = locations("fmd")[CORNER]
    test = planned(of, of.tested.campaign)
    bare = test.prediction.tested.carried
    made = _carrying(test, replace(bare, moving=bare.moving + _point(ON_PLATE, place)))
    beside = named(above_fmd(of.tested.campaign.article))
    words = f"Run {beside} with {ON_PLATE:g} kg on the corner {CORNER} of the cover plate"
    yield Offer(kind="load on the plate", words=words, hours=HOURS, test=made)


def on_article(templates: Sequence[Template], asked: Sequence[str]) -> Iterator[Offer]:
    """On places of the article that has most of them: those that are `asked` about, and the highest."""
    of = max(templates, key=lambda one: len(_places(one)))
    there = _places(of)
    chosen = dict.fromkeys((*(place for place in asked if place in there), *there[::-1]))
    asked_about = sum(place in there for place in asked)
    for place in list(chosen)[: min(max(asked_about, 1), MOST)]:
        words = f"Run {named(above_fmd(of.tested.campaign.article))} with {ON_ARTICLE:g} kg more at {place}"
        yield Offer(kind="load on the article", words=words, hours=HOURS, test=_with_mass(of, place))


def _with_mass(of: Template, place: str) -> Planned:
    test = planned(of, of.tested.campaign)
    tested = test.prediction.tested
    stands = tested.carried.standing
    heavy = None if stands.matrices is None else heavier(stands.matrices, (place,), {"": ON_ARTICLE})
    return _carrying(test, carried(tested.model, tested.campaign, replace(stands, matrices=heavy)))


def _carrying(test: Planned, what: Carried) -> Planned:
    return replace(test, prediction=replace(test.prediction, tested=replace(test.prediction.tested, carried=what)))


def _point(mass: float, position: Array) -> Inertia:
    """About F."""
    return Inertia.from_cog(mass, position, np.zeros((3, 3)))


def _places(of: Template) -> tuple[str, ...]:
    """Of the article on the FMD, the lowest first."""
    article = above_fmd(of.tested.campaign.article)
    try:
        points = locations(article, of.tested.model.changes) if article else {}
    except BadInput:
        return ()
    return tuple(sorted((place for place in of.tested.carried.standing.there.places), key=lambda place: points[place][2]))
