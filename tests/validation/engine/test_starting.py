"""A dictionary over a resonator's frequency finds it where a fit alone does not."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from validation.engine.fit import fit
from validation.engine.parameter import PLAIN
from validation.engine.problem import Problem
from validation.engine.starting import start

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


def test_the_beginning_stays_where_nothing_is_better(lab):
    effects = (lab.effect("appendage[m]", 0.3), lab.effect("appendage[f]", 0.5, nominal=20.0, logarithmic=True))
    problem = Problem((lab.toy({"mass": 0.01}, parameters=(*lab.LABORATORY, *effects), seed=None),))
    begin = start(problem, ["appendage[f]"], base={"mass": 0.01})
    assert_allclose(begin["appendage[m]"], 0.0, atol=1e-6)


def test_several_sizes_span_a_grid_and_places_may_be_given(lab):
    problem = Problem((lab.toy({"mass": 0.2, "frequency:one": 0.1}, seed=None),))
    places = {"mass": [0.0, 0.2], "frequency:one": [-0.1, 0.0, 0.1]}
    begin = start(problem, ["mass", "frequency:one"], places=places)
    assert begin["mass"] == 0.2
    assert begin["frequency:one"] == 0.1


def test_unknown_names_and_unknown_reach_are_refused(lab):
    loose = lab.effect("offset", np.inf)
    problem = Problem((lab.toy({}, parameters=(*lab.LABORATORY, loose)),))
    with pytest.raises(BadInput, match="Did you mean mass"):
        start(problem, ["mas"])
    with pytest.raises(BadInput, match="nothing is known of it beforehand"):
        start(problem, ["offset"])
