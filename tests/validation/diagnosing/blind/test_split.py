"""Split samples: halves that share no line, and both ways counted apart."""

from dataclasses import fields

import numpy as np

from benchmarks.blind.split import SURE, Half, Tried, told
from validation.model.model import Model
from validation.prediction.series import predictions
from validation.study import Study
from validation.virtual_test.plan import Plan
from validation.virtual_test.simulate import simulate


def of(planted: str, over: float, unseen: float) -> Tried:
    return Tried(case="one", planted=planted, found="force-gain:fmd-z1", over=over, unseen=unseen)


def test_two_halves_share_no_line_and_are_all_lines_together() -> None:
    campaign = simulate(Plan(article="fmd+cuboid", seed=1, octaves_per_minute=120.0, quiet=0.3, ringing=1e-3)).campaign
    model = Model(source="here", title="a block", article="fmd+cuboid")
    whole = Study(model=model, campaigns=(campaign,), made=predictions(model, [campaign]))
    given = {one.name: getattr(whole, one.name) for one in fields(whole) if one.init}
    halves = [Half(**given, odd=odd).problem() for odd in (False, True)]
    (name,) = halves[0].lines
    even, odd = (half.lines[name] for half in halves)
    assert not set(even) & set(odd)
    assert np.array_equal(np.sort(np.concatenate([even, odd])), whole.problem().lines[name])


def test_what_evidence_names_and_what_the_other_half_confirms_are_counted_apart() -> None:
    found = [of("", 0.5, SURE - 1), of("", -2.0, SURE + 1), of("cable", 3.0, SURE + 9), of("cable", 1.0, SURE + 5)]
    nulls, effects = told(found)
    assert "of 2 evidence in half of the lines names 1, the other half confirms 1 (median +3.0 nats)" in nulls
    assert "of 2 evidence in half of the lines names 2, the other half confirms 2 (median +10.0 nats)" in effects
