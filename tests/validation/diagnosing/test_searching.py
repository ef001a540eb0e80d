"""What a search fits, of all that a straight line promises."""

from collections import Counter
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from validation.diagnosing import searching
from validation.diagnosing.bench import Hypothesis
from validation.diagnosing.screened import Screened
from validation.diagnosing.searching import (
    INSTEAD,
    OF_A_FAMILY,
    PROMISING,
    STRUCTURAL,
    TRIED,
    Tried,
    _promising,
    _rivals,
    _within,
)
from validation.effects.catalogue import FAMILIES
from validation.effects.family import STRUCTURE
from validation.effects.identifiers import parse
from validation.engine.screening import Told
from validation.models.model import Added

LOUD = tuple(
    f"{family}:{target}=0.1" for family in ("force-gain", "force-delay", "force-highpass") for target in ("fmd-z1", "fmd-z2")
)
"""Of no structure."""


def screened(*texts: str, evidence: float = 100.0) -> list[Screened]:
    """All of them, the first one promising the most."""
    return [
        Screened(
            added=Added(named=parse(text)), evidence=evidence - k, told=Told(name="", estimate=0.0, information=0.0), plausible=1
        )
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


def tried(text: str) -> Tried:
    """A fit that ended there."""
    nobody: Any = None
    hypothesis = Hypothesis(effects=(Added(named=parse(text)),), fit=nobody, problem=nobody)
    return Tried(id=hypothesis.effects[0].named.id, hypothesis=hypothesis, evidence=100.0, standing=nobody)


def test_one_oscillator_under_two_names_is_fitted_under_both_at_the_sizes_of_the_first() -> None:
    menu = [
        Added(named=parse(f"{where}=m:0.001,f:1000,zeta:0.02"))
        for where in ("slosh:mast-top", "absorber:mast-top", "absorber:hub-4", "appendage:x")
    ]
    best = tried("slosh:mast-top=m:0.1,f:5,zeta:0.01")
    (twin,) = _rivals([best], [*menu, Added(named=parse("point-mass:mast-top=0"))], [])
    assert twin.named.id == "absorber:mast-top"
    assert twin.named.values == best.added.named.values


def test_a_resonator_that_left_the_band_gives_way_to_springs_and_masses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(searching, "_tried", lambda bench, at, added: tried("=".join((added.named.id, "1"))))
    bench: Any = SimpleNamespace(made=[SimpleNamespace(measured=SimpleNamespace(frequency=np.array([4.0, 32.0])))])
    nowhere: Any = None
    gone, there = tried("slosh:mast-top=m:0.9,f:1.1,zeta:0.01"), tried("slosh:hub-4=m:0.9,f:9,zeta:0.01")
    springs = [f"cable:{one}:lateral=50" for one in ("mast-top", "hub-4", "hub-3")]
    found = screened("slosh:mast-top=m:1,f:4,zeta:0.01", "slosh:hub-3=m:1,f:4,zeta:0.01", *springs)
    assert [one.id for one in _within(bench, nowhere, [gone, there], found)] == [
        there.id,
        *(one.partition("=")[0] for one in springs[:INSTEAD]),
    ]
    assert _within(bench, nowhere, [there], found) == [there]
