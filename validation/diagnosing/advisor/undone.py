"""Tests of the menu that take away what is suspected, or change it by hand."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType

from validation.diagnosing.advisor.articles import named
from validation.diagnosing.advisor.knowledge import Origin
from validation.diagnosing.advisor.offer import Offer
from validation.diagnosing.advisor.planned import Template, planned
from validation.effects.reach import acts
from validation.identifying.known import above_fmd
from validation.models.model import Added
from validation.prediction import applied

GONE: Mapping[str, str] = MappingProxyType(
    {
        "cable": "with the cables taken off",
        "load-path-shunt": "with cables and seals beside the load path taken off",
        "slosh": "with the tank drained",
        "absorber": "with whatever may swing on it held still by wax or tape",
        "appendage": "with covers and loose leads taken off the cover plate",
    }
)
"""By family, how it is taken away."""

CHANGED: Mapping[str, str] = MappingProxyType(
    {
        "joint-compliance": "with the bolts of its joint torqued again",
        "cell-stiffness": "with the bolt of that load cell torqued again",
        "gap": "with the bolt of that load cell torqued again",
    }
)
"""By family, how it is changed."""

LEFT = 0.5
"""Share of an effect that is taken to be left when bolts were torqued again."""

HOURS = 1.0


def undone(templates: Sequence[Template], effects: Sequence[Added]) -> Iterator[Offer]:
    """Of every one of `effects` that a hand can reach, on the campaign in which it acts first."""
    for added in effects:
        of = next((one for one in templates if acts(added.named, one.tested.carried.standing.there)), None)
        family = added.named.family
        if of is None or family not in {*GONE, *CHANGED}:
            continue
        what, how = named(above_fmd(of.tested.campaign.article)), GONE.get(family) or CHANGED[family]
        test = planned(of, of.tested.campaign)
        gone = (family,) if family in GONE else ()
        names = () if gone else (applied.name(added.named, size.key) for size in added.named.sizes if not size.logarithmic)
        moved = {name: Origin(name=name, factor=LEFT) for name in names}
        yield Offer(kind=added.named.family, words=f"Run {what} {how}", hours=HOURS, test=test, moved=moved, gone=gone)
