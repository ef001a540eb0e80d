"""Verdicts say what the figures say: worth a parameter, holds elsewhere, a fault at all, at what price."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from validation.estimation.problem import SENSOR, Evaluation, Fit, Parameter, Share
from validation.estimation.verdicts import absurd
from validation.history.add import EvaluatedModel, rung_with
from validation.history.history import Errors, Version, VersionSize
from validation.history.verdict import is_worth_adding, verdict
from validation.model.model import Model

MakeRung = Callable[..., Version]
ID = "force-gain:fmd-z2"
NO_EFFECT = Model(source="m.toml", title="", article="fmd+cuboid")


def errors(plain: float, held_out: float | None, **more: object) -> Errors:
    given = {"nominal": 9.0, "chi2": 900.0, "degrees_of_freedom": 1000, "tolerance_z2": 150.0, "tolerances": 160}
    return Errors(plain=plain, held_out=held_out, log_evidence=0.0, **{**given, **more})  # type: ignore[arg-type]


def told(rung: MakeRung, before: Errors, after: Errors, *, gain: float = 30.0, size: VersionSize | None = None) -> str:
    size = size or VersionSize(key="", value=0.08, unit="1", deviation=0.002)
    old = rung(0, None, errors=before)
    new = rung(1, 0, errors=after, gain=gain, effects={ID: (size,)})
    return " ".join(verdict(old, new, {"": 0.003}, {"": 0.0}))


def test_an_effect_that_explains_here_and_there_is_worth_a_parameter_and_a_wrong_one_is_told_by_what_does_not_fall(rung):
    said = told(rung, errors(4.0, 4.2), errors(0.5, 0.6))
    assert "It is worth a parameter: the evidence rises by 30 nats" in said
    assert "falls from 4 % to 0.5 % on the data it was fitted to" in said
    assert "It falls from 4.2 % to 0.6 % on data used only for checking" in said
    assert "Its size is 0.08 ± 0.0039 (95 %)." in said
    said = told(rung, errors(4.0, 4.2), errors(3.99, 4.21), gain=0.4)
    assert "It is not worth a parameter: the evidence rises by 0.4 nats" in said
    assert said.count("does not fall") == 2
    assert "it fits the data, not the structure" in told(rung, errors(4.0, 4.2), errors(2.0, 6.0))


@pytest.mark.parametrize(
    ("value", "deviation", "words"),
    [
        (0.004, 0.0005, "lies within its tolerance of 0.003, one standard deviation: it is no fault"),
        (0.008, 0.003, "may yet lie within its tolerance"),
        (0.08, 0.002, "Its size is 0.08"),
        (0.08, None, "was given, not fitted"),
        (0.0, 0.0, "Its size ends at the bound of what its family allows, 0: the data want it beyond."),
    ],
)
def test_a_size_within_its_tolerance_is_no_fault(value, deviation, words, rung):
    size = VersionSize(key="", value=value, unit="1", deviation=deviation)
    assert words in told(rung, errors(4.0, 4.2), errors(2.0, 2.0), size=size)


def test_tolerances_that_pay_for_a_good_fit_are_said_by_what_is_due_and_not_how_many_there_are(rung):
    said = told(rung, errors(4.0, 4.2), errors(2.0, 2.0, tolerance_z2=426.0, tolerances=118, expected_z2=112.0, largest_z=3.9))
    assert (
        "The prior penalty of the tolerances stays too high, sum z² 426, where about 112 is due: something else is wrong" in said
    )
    one = told(rung, errors(4.0, 4.2), errors(2.0, 2.0, tolerance_z2=110.0, tolerances=118, expected_z2=112.0, largest_z=5.2))
    assert "one moved by 5.2 of its" in one
    fair = errors(2.0, 2.0, tolerance_z2=130.0, tolerances=118, expected_z2=112.0, largest_z=3.1)
    assert "prior penalty" not in told(rung, errors(4.0, 4.2), fair)
    # of 270 tolerances the data tell 40: 120 is three times what is due
    said = told(rung, errors(4.0, 4.2), errors(2.0, 2.0, tolerance_z2=120.0, tolerances=270, expected_z2=40.0, largest_z=3.0))
    assert "where about 40 is due" in said


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None, max_examples=50)
@given(z=st.lists(st.floats(-6, 6), min_size=1, max_size=30), tolerance=st.floats(1e-3, 10), told_share=st.floats(0.05, 1))
def test_the_ladder_and_compare_judge_a_fit_alike(z, tolerance, told_share, rung):
    free = tuple(Parameter(name=f"p{k}", unit="1", tolerance=tolerance, kind=SENSOR) for k in range(len(z)))
    of = Fit(
        parameters=free,
        offsets=tolerance * np.array(z),
        covariance=(1 - told_share) * tolerance**2 * np.eye(len(z)),
        cost=0.0,
        chi2=900.0,
        degrees_of_freedom=1000,
        tolerance_z2=float(np.sum(np.square(z))),
        tolerances=len(z),
        log_evidence=0.0,
        converged=True,
    )
    share = Share(percent=2.0)
    found = Evaluation(nominal=share, plain=share, held_out=None, held_out_nominal=None, plain_fit=of, fitted=of)
    new = rung_with(rung(1, 0), EvaluatedModel(model=NO_EFFECT, evaluation=found, body=None)).errors
    assert new is not None
    assert ("prior penalty" in told(rung, errors(4.0, 4.2), new)) == absurd(of)


def test_fits_that_did_not_converge_come_first_folds_that_rose_are_named_and_evidence_is_needed(rung):
    before, after = ({"run x": 1.3, "run y": 1.3}, {"run x": 0.7, "run y": 2.6})
    said = told(rung, errors(2.0, 1.3, by_fold=before), errors(1.0, 1.9, by_fold=after))
    assert "1 fell and 1 rose, most of all run y: 1.3 % before and 2.6 % after" in said
    assert told(rung, errors(2.0, 2.0), errors(1.0, 1.0, converged=False)).startswith("A fit did not converge")
    assert is_worth_adding(rung(1, 0, gain=9.0))
    assert not is_worth_adding(rung(1, 0, gain=5.0))
    assert not is_worth_adding(replace(rung(1, 0), gain=None))
