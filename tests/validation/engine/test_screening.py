"""What the data, and facts beside them, say of parameters that are not in a fit yet."""

from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import least_squares
from scipy.stats import norm

from validation.estimation.fit import FLOOR, child, fit, nearby, unfitted
from validation.estimation.problem import EFFECT, FITTED, IDENTIFIED, PLAIN, Parameter, Problem
from validation.estimation.screening import POWER, MadeUp, Products, ScoreTest, Screen, in_the_fit, screened

OFFSET = 0.02
"""Small beside the bending of the toy, large beside its noise."""


@pytest.fixture(scope="module")
def small(lab):
    """Data with a small fault, the fit without it, and the model that has it."""
    truth = {**lab.drawn(3), "offset": OFFSET}
    effect = lab.effect("offset", 1.0)
    without, having = lab.toy(truth, acting=(effect,)), lab.toy(truth, parameters=(*lab.LABORATORY, effect))
    return Problem((without,)), fit(Problem((without,)), FITTED), Problem((having,))


def test_a_straight_line_says_what_the_fit_finds(small):
    _, parent, having = small
    told = screened(having, parent, ["offset"]).told()["offset"]
    there = child(having, FITTED, parent, {})
    k = [one.name for one in there.parameters].index("offset")
    # the toy is linear in it but for the gains that scale it, and their covariances bend by per cents
    assert_allclose(told.estimate, there.offsets[k], rtol=0.01)
    assert_allclose(told.deviation, np.sqrt(there.covariance[k, k]), rtol=0.05)
    assert_allclose(told.evidence(1.0), there.log_evidence - parent.log_evidence, rtol=0.01)
    assert 0 < told.share < 1


def bounded(lab, kind):
    """The laboratory with a mass that no fit moves by more than 1 %."""
    return tuple(replace(one, low=-0.01, high=0.01, kind=kind) if one.name == "mass" else one for one in lab.LABORATORY)


def beside_a_mass_that_is_wrong(lab, parameters):
    """What is screened beside a fit of `parameters` where the mass is off by 3 % and something else is missing."""
    effect = lab.effect("offset", 1.0)
    truth = {"mass": 0.03, "offset": OFFSET}
    without = lab.toy(truth, parameters=parameters, acting=(effect,))
    parent = fit(Problem((without,)), FITTED)
    having = Problem((replace(without, parameters=(*without.parameters, effect)),))
    return parent, screened(having, parent, ["offset"])


def test_what_is_identified_at_a_bound_makes_up_for_others_as_if_free_and_an_effect_there_stays(lab):
    parent, at_bound = beside_a_mass_that_is_wrong(lab, bounded(lab, IDENTIFIED))
    assert parent.by_name["mass"] == pytest.approx(0.01, abs=1e-9)
    _, free = beside_a_mass_that_is_wrong(lab, lab.LABORATORY)
    assert np.any(at_bound.step != 0)
    assert not np.any(free.step)
    assert_allclose(at_bound.told()["offset"].estimate, free.told()["offset"].estimate, rtol=0.05)
    assert_allclose(at_bound.told()["offset"].information, free.told()["offset"].information, rtol=0.2)
    parent, at_bound = beside_a_mass_that_is_wrong(lab, bounded(lab, EFFECT))
    assert parent.by_name["mass"] == pytest.approx(0.01, abs=1e-9)
    assert "mass" not in {one.name for one in at_bound.free}
    assert not np.any(at_bound.step)


def test_a_tolerance_that_leaves_its_bounds_gains_what_a_fit_gains_and_the_smallest_size_told_just_that_evidence(lab):
    truth = {"gain:f2": 0.02}
    toy = lab.toy(truth)
    parent = fit(Problem((toy,)), FITTED)
    opened = tuple(replace(p, tolerance=0.1, kind=EFFECT) if p.name == "gain:f2" else p for p in toy.parameters)
    there = child(Problem((replace(toy, parameters=opened),)), FITTED, parent, {})
    told = in_the_fit(parent)["gain:f2"]
    assert_allclose(told.evidence(0.1), there.log_evidence - parent.log_evidence, atol=0.05)
    assert_allclose(told.estimate, there.by_name["gain:f2"], rtol=1e-3)
    told = ScoreTest(name="x", estimate=0.0, information=1e4, tolerance=0.003)
    size = told.detectable(0.1, 10.0)
    unlucky = size - POWER * np.hypot(0.01, 0.003)  # one test of five finds less
    assert norm.cdf(-POWER) == pytest.approx(0.2, abs=1e-3)
    assert_allclose(ScoreTest(name="x", estimate=unlucky, information=1e4, tolerance=0.003).evidence(0.1), 10.0, rtol=1e-9)
    assert np.isinf(ScoreTest(name="x", estimate=0.0, information=0.0).detectable(0.1, 10.0))
    assert np.isinf(told.detectable(0.003, 10.0))


PARTS = np.array([[0.7, 0.2], [0.4, 0.5], [0.1, 0.9]])
"""Shares of the loss of three modes in two parts."""

MODES, PART_SD = 0.3, 0.35
"""[1] What is known of the modes' dampings, and of the parts' loss factors, which are 0.006."""


def of_modes() -> MadeUp:
    """Of a loss of the first part, as the covariance of a fit says it that knows each mode's loss to 1 %."""
    J = np.vstack([np.hstack([PARTS, np.eye(3)]) / 0.01, np.diag([1 / PART_SD] * 2 + [1 / MODES] * 3)])
    e = np.concatenate([PARTS[:, 0] / 0.006 / 0.01, np.zeros(5)])
    C = np.linalg.inv(J.T @ J)
    q = e @ e - e @ J @ C @ J.T @ e
    names = [("loss:one", PART_SD), ("loss:two", PART_SD), *((f"damping:a:{r}", MODES) for r in (1, 2, 3))]
    products = Products(
        frequency=np.zeros(1),
        names=("x",),
        residual=np.zeros((1, 1), dtype=complex),
        others=(e @ J)[None, None].astype(complex),
        square=np.array([[e @ e]]),
    )
    none = replace(products, names=())
    free = tuple(Parameter(name=name, unit="1", tolerance=sd) for name, sd in names)
    screen = Screen(free=free, covariance=C, step=np.zeros(5), products=(products,), facts=none)
    return MadeUp.of(screen, ScoreTest(name="x", estimate=0.0, information=q))


@pytest.mark.parametrize("size", [1e-5, 0.006, 0.03, 0.2])
def test_what_multiplies_makes_up_for_a_loss_as_cheaply_as_it_can(size):
    def left(x):
        modes = np.log1p(PARTS[:, 0] * size / 0.006) - np.log1p(PARTS @ x[:2]) - x[2:]
        return np.concatenate([x / ([PART_SD] * 2 + [MODES] * 3), modes / 0.01])

    least = least_squares(left, np.zeros(5), bounds=(-0.9, np.inf)).cost
    assert_allclose(0.5 * of_modes().at(size).information * size**2, least, rtol=0.01)


def test_the_smallest_loss_is_larger_than_a_straight_line_says():
    of = of_modes()
    size = of.detectable(0.05, 20.0)
    assert size > 1.5 * of.told.detectable(0.05, 20.0)
    told = of.at(size)
    assert told.detectable(0.05, 20.0) == pytest.approx(size, rel=1e-3)
    assert np.isfinite(of.at(1e6).information)
    assert np.isinf(replace(of, matrix=1e-3 * of.matrix, known=1e-3 * of.known).detectable(0.05, 20.0))


def test_a_column_times_a_function_of_frequency_needs_no_derivative_and_summed_lines_say_the_same_sooner(small):
    _, parent, having = small
    of = screened(having, parent, ["offset"])
    f = of.products[0].frequency
    plain, turned = of.shaped("offset"), of.shaped("offset", {0: 2.0 * np.ones(len(f), dtype=complex)})
    assert_allclose(turned.information, 4 * plain.information, rtol=1e-9)
    assert_allclose(turned.estimate, plain.estimate / 2, rtol=1e-9)
    beside = of.shaped("offset", {0: 1j * np.ones(len(f))})
    assert beside.evidence(1.0) < plain.evidence(1.0) / 10  # the fault is real
    by_line, summed = (screened(having, parent, ["offset"], by_line=each).told()["offset"] for each in (True, False))
    assert_allclose(summed.estimate, by_line.estimate, rtol=1e-9)
    assert_allclose(summed.information, by_line.information, rtol=1e-9)
    assert_allclose(summed.share, by_line.share, rtol=1e-9)


def test_a_trial_never_costs_more_than_its_parent(lab):
    truth = {**lab.drawn(5), "offset": 0.5}
    effect = lab.effect("offset", 1.0)
    without, having = lab.toy(truth, acting=(effect,)), lab.toy(truth, parameters=(*lab.LABORATORY, effect))
    parent = fit(Problem((without,)), FITTED)
    for from_afar in (False, True):
        found = child(Problem((having,)), FITTED, parent, {"offset": -3.0}, from_afar=from_afar)
        assert found.cost <= parent.cost
        assert_allclose(found.by_name["offset"], 0.5, atol=0.01)


def test_a_way_straight_down_ends_where_the_fit_ends_and_unfitted_misfit_is_told_as_it_stands(lab):
    problem = Problem((lab.toy({**lab.drawn(6), "mass": 0.03}),))
    whole = fit(problem, PLAIN)
    assert_allclose(nearby(problem, PLAIN, fit(problem, FITTED).by_name).cost, whole.cost, rtol=1e-4)
    problem = Problem((lab.toy({"mass": 0.05}),))
    assert unfitted(problem, FITTED, {}).chi2 > 10 * unfitted(problem, FITTED, {"mass": 0.05}).chi2
    assert not unfitted(problem, FITTED, {}).converged


@dataclass(frozen=True, eq=False, kw_only=True)
class Weight:
    """``value = sum(slope * offset) +- sd``."""

    value: float
    sd: float
    slopes: dict[str, float]
    parameters: tuple[Parameter, ...] = field(default=())
    name: str = "a weight"

    def residual(self, offsets: dict[str, float]) -> tuple[float, dict[str, float]]:
        said = sum(slope * offsets.get(name, 0.0) for name, slope in self.slopes.items())
        return (said - self.value) / self.sd, {name: slope / self.sd for name, slope in self.slopes.items()}


@pytest.mark.parametrize("sd", [1e9, 2e-4, 2e-5])
def test_a_fact_tells_what_it_tells_the_fit(lab, sd):
    truth, effect = {**lab.drawn(4), "offset": 1e-3}, lab.effect("offset", 1.0)
    right = lab.toy(truth, parameters=(*lab.LABORATORY, effect))
    without = lab.toy(truth, acting=(effect,))
    weight = Weight(value=1.05e-3, sd=sd, slopes={"offset": 1.0, "mass": 0.3}, parameters=(effect,))
    parent = fit(Problem((without,), (replace(weight, slopes={"mass": 0.3}, parameters=()),)), FITTED)
    problem = Problem((right,), (weight,))
    told = screened(problem, parent, ["offset"]).told()["offset"]
    child = fit(problem, FITTED, start=parent)
    variance = float(np.diag(child.covariance)[[one.name for one in child.parameters].index("offset")])
    # linear to a few per cent of a standard deviation; what is known beforehand of the effect is in the fit and not in the told
    assert_allclose(1 / told.information, variance, rtol=2e-2)
    assert_allclose(told.estimate, child.by_name["offset"], atol=0.1 * np.sqrt(variance))
    gain = child.log_evidence - parent.log_evidence
    assert_allclose(told.evidence(1.0), gain, atol=0.05 + 0.02 * abs(gain))


def test_a_fact_alone_tells_of_what_no_channel_sees(lab):
    truth, unseen = lab.drawn(4), lab.effect("unseen", 2.0)
    toy = lab.toy(truth)
    weight = Weight(value=3.0, sd=0.5, slopes={"unseen": 1.0}, parameters=(unseen,))
    parent = fit(Problem((toy,)), FITTED, floor=FLOOR)
    told = screened(Problem((toy,), (weight,)), parent, ["unseen"]).told()["unseen"]
    assert_allclose([told.estimate, told.deviation], [3.0, 0.5], rtol=1e-12)
    # two normal densities of a weight: with the effect it may be 2.06 wide, without it 0.5
    expected = 0.5 * (3 / 0.5) ** 2 - 0.5 * 9 / (4 + 0.25) - 0.5 * np.log(1 + 4 / 0.25)
    assert_allclose(told.evidence(2.0), expected, rtol=1e-12)
