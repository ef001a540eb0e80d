"""Fits find the truth, say how well they know it, refuse what does not converge, and no child costs more than its parent."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import CheckFailed
from validation.engine.cost import cost_of
from validation.engine.descent import direct, within
from validation.engine.evaluation import Fit
from validation.engine.fit import fit, parents_point
from validation.engine.parameter import FITTED, NOMINAL, PLAIN
from validation.engine.problem import Problem

TRUTH = {"mass": 0.06, "inertia": -0.04, "damping": 0.3, "frequency:one": 0.02}


def sd(found: Fit, name: str) -> float:
    k = [p.name for p in found.parameters].index(name)
    return float(np.sqrt(found.covariance[k, k]))


@pytest.mark.parametrize("known", [False, True], ids=["latent", "known"])
def test_without_noise_the_truth_is_found_exactly(lab, known):
    """Priors pull by their share of what is known: next to nothing against data without noise."""
    toy = lab.toy(TRUTH, seed=None, known=known)
    found = fit(Problem((toy,)), PLAIN, floor=1e-6)
    for name, value in TRUTH.items():
        assert_allclose(found.by_name[name], value, atol=2e-6, err_msg=name)


@pytest.mark.parametrize("known", [False, True], ids=["latent", "known"])
def test_intervals_cover_the_truth(lab, known):
    """Of 90 % intervals of 18 parameters in 25 laboratories drawn from what is known beforehand, nine in ten hold the truth."""
    inside, surprise = [], []
    for seed in range(25):
        rng = np.random.default_rng(seed)
        truth = lab.drawn(seed) | {"mass": 0.05 * rng.standard_normal(), "inertia": 0.05 * rng.standard_normal()}
        truth |= {"damping": 0.35 * rng.standard_normal(), "frequency:one": 0.02 * rng.standard_normal()}
        found = fit(Problem((lab.toy(truth, seed=seed, lines=24, known=known),)), FITTED, floor=0.0)
        assert found.converged
        inside += [abs(found.by_name[name] - value) < 1.645 * sd(found, name) for name, value in truth.items()]
        surprise.append(found.chi2 / found.degrees_of_freedom)
    assert 0.85 < np.mean(inside) < 0.95  # 425 of them, correlated within a laboratory: 1.5 % is one standard error
    assert_allclose(np.mean(surprise), 1.0, atol=0.02)


def test_nothing_free_is_the_model_as_it_stands(lab):
    toy = lab.toy(TRUTH, parameters=(*lab.LABORATORY, lab.effect("offset", 1.0, start=0.2)))
    found = fit(Problem((toy,)), NOMINAL)
    cost = cost_of(Problem((toy,)), (), 0.01)
    assert found.parameters == ()
    assert_allclose(found.chi2, 2 * cost.data(np.zeros(0)).cost, rtol=1e-12)
    assert cost.offsets(np.zeros(0))["offset"] == 0.2


def test_declared_parameters_of_a_plain_fit_stop_at_their_bounds_and_the_others_make_up_for_it(lab):
    truth = {**TRUTH, "frequency:one": 0.08, "damping": 0.9}
    problem = Problem((lab.toy(truth, seed=None),))
    found = fit(problem, PLAIN)
    assert found.by_name["frequency:one"] == 0.05
    assert sd(found, "frequency:one") == 0.0
    assert abs(found.by_name["damping"]) <= 0.875
    fixed = tuple(replace(p, tolerance=0.0, start=0.05) if p.name == "frequency:one" else p for p in problem.parameters)
    again = fit(Problem((replace(problem.predictions[0], parameters=fixed),)), PLAIN)
    assert_allclose(found.by_name["mass"], again.by_name["mass"], atol=0.1 * sd(found, "mass"))
    free = fit(problem, FITTED)
    assert_allclose(free.by_name["frequency:one"], 0.08, atol=1e-3)


def test_what_is_known_of_a_parameter_at_its_bound_counts(lab):
    problem = Problem((lab.toy({**TRUTH, "frequency:one": 0.08}, seed=None),))
    found = fit(problem, PLAIN)
    assert found.by_name["frequency:one"] == 0.05
    everything = cost_of(problem, found.parameters, 0.01)
    assert_allclose(found.cost, everything.total(found.offsets)[0].cost, rtol=1e-12)


def test_a_parameter_at_a_bound_is_let_go_when_the_data_pull_it_back(lab):
    problem = Problem((lab.toy(TRUTH, seed=None),))
    held = cost_of(problem, problem.free(PLAIN), 0.01).holding({"frequency:one": 0.05})
    end = within(direct(held, {}, lambda share: None), lambda share: None)
    assert_allclose(end.offsets["frequency:one"], 0.02, atol=1e-3)


class Listening:
    """A prediction that writes down where it was asked."""

    def __init__(self, toy):
        self.toy, self.measured, self.parameters, self.asked = toy, toy.measured, toy.parameters, []

    def at(self, offsets, lines=None, *, derivatives=True):
        self.asked.append(dict(offsets))
        return self.toy.at(offsets, lines, derivatives=derivatives)


def test_tolerances_of_the_measurement_are_released_when_the_rest_is_near(lab):
    toy = Listening(lab.toy({**lab.drawn(1), **TRUTH}))
    found = fit(Problem((toy,)), FITTED)
    released = next(one for one in toy.asked if any(one[p.name] for p in lab.LABORATORY if p.kind == "sensor"))
    for name in TRUTH:
        assert_allclose(released[name], found.by_name[name], atol=0.01, err_msg=name)


@pytest.mark.parametrize("kinds", [PLAIN, FITTED], ids=["plain", "fitted"])
def test_a_child_far_from_its_parent_is_found_by_the_annealed_floor(lab, kinds):
    """A resonance five of its widths away: straight from the parent the way ends elsewhere."""
    effects = (
        lab.effect("appendage[m]", 0.3, start=0.1),
        lab.effect("appendage[f]", 0.5, nominal=20.0, logarithmic=True),
    )
    truth = {"appendage[m]": 0.5, "appendage[f]": 0.1, "mass": 0.01}
    parent = fit(Problem((lab.toy(truth, acting=effects),)), kinds)
    problem = Problem((lab.toy(truth, parameters=(*lab.LABORATORY, *effects)),))
    child = fit(problem, kinds, start=parent)
    assert_allclose(child.by_name["appendage[f]"], 0.1, atol=1e-4)
    cost = cost_of(problem, problem.free(kinds), 0.01)
    straight = direct(cost, parents_point(cost.free, parent), lambda share: None)
    assert abs(straight.offsets["appendage[f]"] - 0.1) > 0.05


def test_a_child_whose_own_start_breaks_down_is_found_from_its_parent(lab):
    without, having = with_offset(lab, {**TRUTH, "offset": 0.3}, start=2.0)

    class Fragile(Broken):
        def at(self, offsets, lines=None, *, derivatives=True):
            if offsets.get("offset", 0.0) > 1.0:
                raise np.linalg.LinAlgError("a stiffness turned negative")
            return self.toy.at(offsets, lines, derivatives=derivatives)

    child = fit(Problem((Fragile(having),)), PLAIN, start=fit(Problem((without,)), PLAIN))
    assert_allclose(child.by_name["offset"], 0.3, atol=0.01)


def test_tolerances_of_the_measurement_are_not_touched_by_a_plain_fit(lab):
    found = fit(Problem((lab.toy(TRUTH),)), PLAIN)
    assert {p.kind for p in found.parameters} == {"identified", "declared"}
    assert found.tolerances == 2


def test_what_was_fitted_is_priced_in_squares_of_tolerances(lab):
    found = fit(Problem((lab.toy(TRUTH),)), FITTED)
    priced = [p for p in found.parameters if p.kind in ("sensor", "declared")]
    assert found.tolerances == len(priced) == 15
    assert_allclose(found.tolerance_z2, sum((found.by_name[p.name] / p.tolerance) ** 2 for p in priced), rtol=1e-12)


class Wrong:
    """A prediction whose derivatives have the wrong sign."""

    def __init__(self, toy):
        self.toy, self.measured, self.parameters = toy, toy.measured, toy.parameters

    def at(self, offsets, lines=None, *, derivatives=True):
        right = self.toy.at(offsets, lines, derivatives=derivatives)
        return replace(right, changes={name: replace(one, rows=-one.rows) for name, one in right.changes.items()})


def test_a_baseline_that_does_not_converge_is_refused_with_the_reason(lab):
    with pytest.raises(CheckFailed, match=r"4 parameters did not converge.*mass|4 parameters did not converge.*inertia"):
        fit(Problem((Wrong(lab.toy(TRUTH)),)), PLAIN)


class Broken:
    """A model that breaks down wherever the effect `offset` differs from nothing, or everywhere."""

    def __init__(self, toy, everywhere=False):
        self.toy, self.measured, self.parameters, self.everywhere = toy, toy.measured, toy.parameters, everywhere

    def at(self, offsets, lines=None, *, derivatives=True):
        if self.everywhere or offsets.get("offset", 0.0):
            raise np.linalg.LinAlgError("a stiffness turned negative")
        return self.toy.at(offsets, lines, derivatives=derivatives)


def test_a_model_that_breaks_down_where_the_fit_begins_is_refused(lab):
    with pytest.raises(CheckFailed, match="breaks down where its fit begins: a stiffness turned negative"):
        fit(Problem((Broken(lab.toy(TRUTH), everywhere=True),)), PLAIN)


def with_offset(lab, truth, **more):
    effect = lab.effect("offset", 1.0, **more)
    return lab.toy(truth, acting=(effect,)), lab.toy(truth, parameters=(*lab.LABORATORY, effect))


@pytest.mark.parametrize("kinds", [PLAIN, FITTED], ids=["plain", "fitted"])
@pytest.mark.parametrize("size", [0.0, 0.5])
def test_a_child_never_costs_more_than_its_parent(lab, kinds, size):
    without, having = with_offset(lab, {**TRUTH, "offset": size}, start=0.1)
    parent = fit(Problem((without,)), kinds)
    child = fit(Problem((having,)), kinds, start=parent)
    assert child.cost <= parent.cost
    assert_allclose(child.by_name["offset"], size, atol=max(3 * sd(child, "offset"), 0.01))
    assert (parent.cost - child.cost > 100) is (size > 0)


def test_a_child_that_finds_nothing_keeps_its_parents_point(lab):
    without, having = with_offset(lab, TRUTH)
    parent = fit(Problem((without,)), PLAIN)
    child = fit(Problem((Broken(having),)), PLAIN, start=parent)
    assert not child.converged
    assert {**child.by_name, "offset": 0.0} == {**parent.by_name, "offset": 0.0}
    assert_allclose(child.cost, parent.cost, rtol=1e-12)


def test_what_is_new_begins_where_it_has_no_effect_and_a_factor_at_its_own_start(lab):
    parent = fit(Problem((lab.toy(TRUTH),)), PLAIN)
    new = (
        lab.effect("appendage[m]", 0.05, start=0.3),
        lab.effect("appendage[f]", 0.5, nominal=20.0, logarithmic=True, start=0.1),
    )
    assert parents_point(new, parent) == {"appendage[m]": 0.0, "appendage[f]": 0.1}


def test_facts_count(lab):
    class Weight:
        name, parameters = "weight", (lab.LABORATORY[0],)

        def residual(self, offsets):
            return (offsets.get("mass", 0.0) - 0.5) / 1e-7, {"mass": 1 / 1e-7}

    problem = Problem((lab.toy(TRUTH),), (Weight(),))
    found = fit(problem, PLAIN)
    assert_allclose(found.by_name["mass"], 0.5, atol=1e-5)
    cost = cost_of(Problem(problem.predictions), found.parameters, 0.01)
    left = (found.by_name["mass"] - 0.5) / 1e-7
    assert_allclose(found.chi2, 2 * cost.data(found.offsets).cost + left**2, rtol=1e-9)
    assert found.degrees_of_freedom == fit(Problem(problem.predictions), PLAIN).degrees_of_freedom + 1


def test_progress_ends_at_all_and_never_goes_back(lab):
    told: list[float] = []
    fit(Problem((lab.toy(TRUTH),)), FITTED, progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 1.0


def test_an_interrupt_ends_a_fit_at_once(lab):
    def stop(share):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fit(Problem((lab.toy(TRUTH),)), PLAIN, progress=stop)
