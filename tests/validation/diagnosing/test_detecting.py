"""A smallest size is told in its unit, from where there is no effect."""

from math import expm1, inf
from typing import Any

import pytest

from validation.diagnose.candidates import detectable
from validation.diagnose.diagnosis import Screened
from validation.effects.catalogue import parse
from validation.effects.effect import evidence_threshold
from validation.estimation.problem import EFFECT, Parameter
from validation.estimation.screening import ScoreTest
from validation.model.model import Added

SURE = ScoreTest(name="x", estimate=0.0, information=1e4)


def screened(text: str, told: ScoreTest = SURE, **more: Any) -> Screened:
    """A candidate whose size a straight line tells to 0.01 of its offset."""
    one = Parameter(name="x", unit="1", tolerance=0.1, kind=EFFECT, **more)
    return Screened(added=Added(named=parse(text)), evidence=0.0, told=told, plausible=1.0, parameter=one)


def test_a_size_that_adds_is_its_offset() -> None:
    (found,) = detectable([screened("force-gain:fmd-z2=0.1")])
    assert found.size == pytest.approx(SURE.detectable(1.0, evidence_threshold("force-gain")))


@pytest.mark.parametrize(
    ("text", "more"),
    [
        ("fmd-compliance:lateral=2", {"nominal": 1.0, "logarithmic": True}),
        ("modulus:mast=0.1", {"nominal": 1.0, "logarithmic": True, "above": -1.0}),
    ],
)
def test_a_factor_counts_from_one(text: str, more: Any) -> None:
    (found,) = detectable([screened(text, **more)])
    assert found.size == pytest.approx(expm1(SURE.detectable(1.0, evidence_threshold(text.partition(":")[0]))))


def test_what_is_hardly_told_is_left_out() -> None:
    vague = ScoreTest(name="x", estimate=0.0, information=1e-8)
    assert vague.detectable(inf, 8.0) > 1000
    found = screened("fmd-compliance:lateral=2", vague, nominal=1.0, logarithmic=True)
    assert detectable([Screened(added=found.added, evidence=0.0, told=vague, plausible=1e6, parameter=found.parameter)]) == ()
