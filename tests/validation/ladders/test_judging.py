"""A model held against a series by hand."""

from collections.abc import Callable
from dataclasses import replace

from validation.estimation.problem import IDENTIFIED, Parameter, Problem
from validation.history.add import judged
from validation.model.model import Model
from validation.study import Study

KNOWN = (Parameter(name="fmd:m", unit="kg", tolerance=1.0, kind=IDENTIFIED),)


def test_nominal_and_plain_error_on_what_was_held_out_are_of_the_same_data(affine: Callable[..., Problem]) -> None:
    """Two configurations of one run each: configurations are held out and told apart, and no run can be."""
    found = []
    for seed, name in enumerate(("one", "other")):
        (prediction,) = affine(KNOWN, {"fmd:m": 0.1}, seed=seed).predictions
        found.append(replace(prediction, measured=replace(prediction.measured, name=name, configuration=name)))
    series = Problem(tuple(found))

    class OfSeries(Study):
        def whole(self, effects: object = ()) -> Problem:
            return series

    of = judged(OfSeries(model=Model(source="m", title="m", article="fmd+cuboid")), None).evaluation
    assert of.held_out_configurations is not None
    assert (of.held_out, of.held_out_nominal) == (None, None)
