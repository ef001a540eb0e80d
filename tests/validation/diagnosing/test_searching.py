"""What a search fits, of all that a straight line promises."""

from collections import Counter

import pytest

from validation.diagnosing.screened import Screened
from validation.diagnosing.searching import OF_A_FAMILY, PROMISING, STRUCTURAL, TRIED, _promising
from validation.effects.catalogue import FAMILIES
from validation.effects.family import STRUCTURE
from validation.effects.identifiers import parse
from validation.engine.screening import Told
from validation.models.model import Added

LOUD = tuple(f"{family}:{target}=0.1" for family in ("force-gain", "force-delay", "force-highpass") for target in ("fmd-z1", "fmd-z2"))
"""Of no structure."""


def screened(*texts: str, evidence: float = 100.0) -> list[Screened]:
    """All of them, the first one promising the most."""
    return [
        Screened(added=Added(named=parse(text)), evidence=evidence - k, told=Told(name="", estimate=0.0, information=0.0), plausible=1)
        for k, text in enumerate(texts)
    ]


def ids(found: list[Screened]) -> list[str]:
    return [one.id for one in found]


def test_what_promises_little_is_not_fitted() -> None:
    found = screened(*LOUD[:3], evidence=PROMISING + 1.5)
    assert _promising(found) == found[:2]


def test_of_one_family_no_more_than_some_are_fitted() -> None:
    gains = [f"force-gain:fmd-{one}=0.1" for one in ("z1", "z2", "z3", "z4", "x12")]
    chosen = _promising(screened(*gains, "force-delay:fmd-z1=0.001"))
    assert Counter(one.added.named.family for one in chosen) == {"force-gain": OF_A_FAMILY, "force-delay": 1}
    assert ids(chosen)[:OF_A_FAMILY] == ids(screened(*gains))[:OF_A_FAMILY]


def test_the_structure_is_asked_though_many_channels_promise_more() -> None:
    structure = ("modulus:mast=0.1", "point-mass:mast-top=0.1", "rigid-inertia:m=0.1")
    assert all(FAMILIES[parse(one).family].side == STRUCTURE for one in structure)
    assert not any(FAMILIES[parse(one).family].side == STRUCTURE for one in LOUD)
    chosen = _promising(screened(*LOUD, *structure))
    assert len(LOUD) == TRIED
    assert ids(chosen) == ids(screened(*LOUD, *structure))[: TRIED + STRUCTURAL]


def test_no_more_of_the_structure_is_added_where_it_leads_anyway() -> None:
    chosen = _promising(screened("modulus:mast=0.1", "rigid-inertia:m=0.1", *LOUD, "point-mass:mast-top=0.1"))
    assert len(chosen) == TRIED


@pytest.mark.parametrize("count", [0, 1])
def test_few_promises_are_all_fitted(count: int) -> None:
    assert len(_promising(screened(*LOUD[:count]))) == count
