"""A dictionary over a resonator's frequency finds it where a fit alone does not."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from validation.estimation.fit import fit, start
from validation.estimation.problem import PLAIN, Problem

TRUTH = {"appendage[m]": 0.4, "appendage[f]": np.log(26.3 / 20.0), "mass": 0.01}


@pytest.fixture
def resonator(lab):
    effects = (lab.effect("appendage[m]", 0.3), lab.effect("appendage[f]", 0.5, nominal=20.0, logarithmic=True))
    return Problem((lab.toy(TRUTH, parameters=(*lab.LABORATORY, *effects)),)), Problem((lab.toy(TRUTH, acting=effects),))


def test_a_resonator_is_found_by_its_dictionary(resonator):
    problem, without = resonator
    parent = fit(without, PLAIN)
    told: list[float] = []
    begin = start(problem, ["appendage[f]"], base=parent.by_name, progress=told.append)
    found = fit(problem, PLAIN, start=begin)
    assert_allclose(found.by_name["appendage[f]"], TRUTH["appendage[f]"], atol=0.003)
    assert_allclose(found.by_name["appendage[m]"], 0.4, atol=0.02)
    assert found.cost < parent.cost - 100
    assert told == sorted(told)


def test_an_amplitude_is_what_the_data_want_at_every_place_and_not_on_the_grid(lab):
    """A logarithmic mass a factor of eight too small: steps of its logarithm from there would promise nothing."""
    effects = (
        lab.effect("appendage[m]", 2.0, nominal=0.05, logarithmic=True),
        lab.effect("appendage[f]", 1.0, nominal=10.0, logarithmic=True),
    )
    truth = {"appendage[m]": np.log(0.4 / 0.05), "appendage[f]": np.log(26.3 / 10.0), "mass": 0.01}
    problem = Problem((lab.toy(truth, acting=effects, parameters=(*lab.LABORATORY, *effects)),))
    places = {"appendage[f]": np.log(np.geomspace(4.0, 30.0, 60) / 10.0)}
    begin = start(problem, tuple(places), places=places, amplitude="appendage[m]")
    assert_allclose(begin["appendage[f]"], truth["appendage[f]"], atol=0.02)
    assert_allclose(begin["appendage[m]"], truth["appendage[m]"], atol=0.3)
    found = fit(problem, PLAIN, start=begin)
    assert_allclose(found.by_name["appendage[m]"], truth["appendage[m]"], atol=0.01)


def test_no_amplitude_is_begun_that_the_data_want_negative(lab):
    effects = (
        lab.effect("appendage[m]", 2.0, nominal=0.05, logarithmic=True),
        lab.effect("appendage[f]", 1.0, nominal=20.0, logarithmic=True),
    )
    negative = (lab.effect("appendage[m]", 1.0), effects[1])
    made = lab.toy({"appendage[m]": -0.4, "mass": 0.01}, acting=negative)
    problem = Problem((replace(made, parameters=(*made.parameters, *effects)),))
    places = {"appendage[f]": [0.0]}
    begin = start(problem, tuple(places), places=places, amplitude="appendage[m]")
    assert begin["appendage[m]"] == 0.0


def test_the_beginning_stays_where_nothing_is_better(lab):
    effects = (lab.effect("appendage[m]", 0.3), lab.effect("appendage[f]", 0.5, nominal=20.0, logarithmic=True))
    problem = Problem((lab.toy({"mass": 0.01}, parameters=(*lab.LABORATORY, *effects), seed=None),))
    begin = start(problem, ["appendage[f]"], base={"mass": 0.01})
    assert_allclose(begin["appendage[m]"], 0.0, atol=1e-6)


def test_several_sizes_span_a_grid_and_places_may_be_given(lab):
    problem = Problem((lab.toy({"mass": 0.2, "frequency:one": 0.04}, seed=None),))
    places = {"mass": [0.0, 0.2], "frequency:one": [-0.04, 0.0, 0.04]}
    begin = start(problem, ["mass", "frequency:one"], places=places)
    assert begin["mass"] == 0.2
    assert begin["frequency:one"] == 0.04


def test_unknown_names_and_unknown_reach_are_refused(lab):
    loose = lab.effect("offset", np.inf)
    problem = Problem((lab.toy({}, parameters=(*lab.LABORATORY, loose)),))
    with pytest.raises(BadInput, match="Did you mean mass"):
        start(problem, ["mas"])
    with pytest.raises(BadInput, match="nothing is known of it beforehand"):
        start(problem, ["offset"])
