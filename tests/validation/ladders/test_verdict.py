"""Verdicts say what the figures say: worth a parameter, holds elsewhere, a fault at all, at what price."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from validation.ladders.nouns import Errors, Rung, Size
from validation.ladders.verdict import verdict, worth

MakeRung = Callable[..., Rung]
ID = "force-gain:fmd-z2"


def errors(plain: float, held_out: float | None, **more: object) -> Errors:
    given = {"nominal": 9.0, "chi2": 900.0, "degrees_of_freedom": 1000, "tolerance_z2": 150.0, "tolerances": 160}
    return Errors(plain=plain, held_out=held_out, log_evidence=0.0, **{**given, **more})  # type: ignore[arg-type]


def told(rung: MakeRung, before: Errors, after: Errors, *, gain: float = 30.0, size: Size | None = None) -> str:
    size = size or Size(key="", value=0.08, unit="1", deviation=0.002)
    old = rung(0, None, errors=before)
    new = rung(1, 0, errors=after, gain=gain, effects={ID: (size,)})
    return " ".join(verdict(old, new, {"": 0.003}, {"": 0.0}))


def test_an_effect_that_explains_here_and_there_is_worth_a_parameter(rung: MakeRung) -> None:
    said = told(rung, errors(4.0, 4.2), errors(0.5, 0.6))
    assert "It is worth a parameter: the evidence rises by 30.0 nats" in said
    assert "falls from 4 % to 0.5 % on the data it was fitted to" in said
    assert "It falls from 4.2 % to 0.6 % on data that were held out" in said
    assert "Its size is 0.08 ± 0.0039 (95 %)." in said


def test_a_wrong_one_is_told_by_what_does_not_fall(rung: MakeRung) -> None:
    said = told(rung, errors(4.0, 4.2), errors(3.99, 4.21), gain=0.4)
    assert "It is not worth a parameter: the evidence rises by 0.4 nats" in said
    assert said.count("does not fall") == 2


def test_what_holds_only_where_it_was_fitted_is_said(rung: MakeRung) -> None:
    assert "it fits the data, not the structure" in told(rung, errors(4.0, 4.2), errors(2.0, 6.0))


@pytest.mark.parametrize(
    ("value", "deviation", "words"),
    [
        (0.004, 0.0005, "lies within its tolerance of 0.003, one standard deviation: it is no fault"),
        (0.008, 0.003, "may yet lie within its tolerance"),
        (0.08, 0.002, "Its size is 0.08"),
        (0.08, None, "was given, not fitted"),
    ],
)
def test_a_size_within_its_tolerance_is_no_fault(value: float, deviation: float | None, words: str, rung: MakeRung) -> None:
    size = Size(key="", value=value, unit="1", deviation=deviation)
    assert words in told(rung, errors(4.0, 4.2), errors(2.0, 2.0), size=size)


def test_tolerances_that_pay_for_a_good_fit_are_said(rung: MakeRung) -> None:
    said = told(rung, errors(4.0, 4.2), errors(2.0, 2.0, tolerance_z2=2900.0))
    assert "The tolerances still pay for it, sum z² 2.9e+03 of 160" in said


def test_folds_that_rose_are_named_among_those_that_fell(rung: MakeRung) -> None:
    before, after = ({"run x": 1.3, "run y": 1.3}, {"run x": 0.7, "run y": 2.6})
    said = told(rung, errors(2.0, 1.3, by_fold=before), errors(1.0, 1.9, by_fold=after))
    assert "1 fell and 1 rose, most of all run y: 1.3 % before and 2.6 % after" in said


def test_fits_that_did_not_converge_come_first(rung: MakeRung) -> None:
    assert told(rung, errors(2.0, 2.0), errors(1.0, 1.0, converged=False)).startswith("A fit did not converge")


def test_without_evidence_nothing_is_worth_a_parameter(rung: MakeRung) -> None:
    assert worth(rung(1, 0, gain=7.0))
    assert not worth(rung(1, 0, gain=5.0))
    assert not worth(replace(rung(1, 0), gain=None))
