"""Consider covariance: it covers where tolerances nobody fitted move the estimate, and what noise alone leaves does not."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from validation.estimation.fit import fit
from validation.estimation.problem import EFFECT, IDENTIFIED, PLAIN, SENSOR, Parameter, Problem
from validation.history.add import judged
from validation.history.verdict import NOTICED, alias, covariance, noticed, of_fit
from validation.model.model import Model
from validation.study import Study


def test_the_formula_is_the_covariance_of_what_is_drawn_and_without_tolerances_what_noise_leaves():
    rng = np.random.default_rng(3)
    J, tolerance = rng.standard_normal((40, 5)), np.array([np.inf, np.inf, 0.7, 0.3, 2.0])
    estimated = np.array([True, True, False, False, False])
    draws = 20_000
    t = rng.standard_normal((draws, 3)) * tolerance[2:]
    y = t @ J[:, 2:].T + rng.standard_normal((draws, 40))  # the estimated ones are 0 in truth
    found = np.linalg.lstsq(J[:, :2], y.T, rcond=None)[0]
    C = covariance(J.T @ J, estimated, tolerance)
    # 20,000 draws tell a variance to 1 %
    assert_allclose(np.cov(found), C, rtol=0.05, atol=0.02 * np.sqrt(C[0, 0] * C[1, 1]))
    J = np.random.default_rng(4).standard_normal((10, 3))
    estimated = np.array([True, True, False])
    assert_allclose(covariance(J.T @ J, estimated, np.zeros(3)), np.linalg.inv(J[:, :2].T @ J[:, :2]), rtol=1e-12)


@pytest.fixture(scope="module")
def drawn(affine) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """By drawn laboratory: error of the estimate, its standard deviation, and the one of noise alone."""
    wanted = Parameter(name="wanted", unit="1", tolerance=10.0, kind=EFFECT)
    sensors = tuple(Parameter(name=f"gain:{k}", unit="1", tolerance=0.03, kind=SENSOR) for k in range(6))
    rng, rows = np.random.default_rng(5), []
    for seed in range(150):
        truth = {"wanted": 0.3, **{one.name: 0.03 * rng.standard_normal() for one in sensors}}
        problem = affine((wanted, *sensors), truth, seed)
        found = fit(problem, PLAIN)
        names, C = of_fit(problem, found, PLAIN)
        assert names == ("wanted",)
        rows.append((found.by_name["wanted"] - 0.3, np.sqrt(C[0, 0]), np.sqrt(found.covariance[0, 0])))
    error, considered, noise = np.array(rows).T
    return error, considered, noise


def test_95_per_cent_intervals_cover_about_95_per_cent_and_those_of_noise_alone_do_not(drawn):
    error, considered, _ = drawn
    covered = np.mean(np.abs(error) < 1.96 * considered)
    assert 0.90 <= covered <= 0.99  # 150 draws: 0.95 within 2.5 standard deviations of 0.018
    error, _, noise = drawn
    assert np.mean(np.abs(error) < 1.96 * noise) < 0.75


KNOWN = (Parameter(name="fmd:m", unit="kg", tolerance=1.0, kind=IDENTIFIED),)


def test_nominal_and_plain_error_on_what_was_held_out_are_of_the_same_data(affine):
    """Two configurations of one run each: configurations are held out and told apart, and no run can be."""
    found = []
    for seed, name in enumerate(("one", "other")):
        (prediction,) = affine(KNOWN, {"fmd:m": 0.1}, seed=seed).predictions
        found.append(replace(prediction, measured=replace(prediction.measured, name=name, configuration=name)))
    series = Problem(tuple(found))

    class OfSeries(Study):
        def whole(self, effects=()):
            return series

    of = judged(OfSeries(model=Model(source="m", title="m", article="fmd+cuboid")), None).evaluation
    assert of.held_out_configurations is not None
    assert (of.held_out, of.held_out_nominal) == (None, None)


def effect(name: str, unit: str = "1", kind: str = EFFECT) -> Parameter:
    return Parameter(name=name, unit=unit, tolerance=0.1, kind=kind)


def test_an_exact_alias_is_named_with_the_size_that_does_the_same(affine):
    problem = affine((effect("gain"), effect("mass", "kg"), effect("other")), {}, alike=[("gain", "mass")])
    found = alias(problem, "gain", ["gain"])
    assert found.effects == ("mass",)
    assert_allclose(found.mixture["mass"] / found.size, 2.0, rtol=1e-6)
    assert found.text == "gain +0.01 does to these data what mass +0.02 kg does"
    assert found.share < 1e-12


def test_a_mixture_of_several_is_an_alias_and_what_merely_resembles_another_is_none(affine):
    problem = affine(tuple(map(effect, "abc")), {})
    (one,) = problem.predictions
    one.slopes["a"] = one.slopes["b"] - 3 * one.slopes["c"]  # type: ignore[attr-defined]
    found = alias(problem, "a", ["a"])
    assert_allclose([found.mixture[name] / found.size for name in "bc"], [1.0, -3.0], rtol=1e-6)
    problem = affine(tuple(map(effect, "ab")), {})
    (one,) = problem.predictions
    one.slopes["a"] = one.slopes["b"] + 0.05 * one.slopes["a"]  # type: ignore[attr-defined]
    assert alias(problem, "a", ["a"]) is None


@pytest.mark.parametrize(("kind", "effects"), [(IDENTIFIED, ()), (EFFECT, ("b",))])
def test_what_must_be_identified_takes_part_but_is_no_effect(kind, effects, affine):
    found = alias(affine((effect("a"), effect("b", kind=kind)), {}, alike=[("a", "b")]), "a", ["a"])
    assert found.effects == effects


def test_tolerances_of_the_measurement_take_no_part_and_an_effect_that_moves_no_channel_is_not_noticed(affine):
    assert alias(affine((effect("a"), effect("b", kind=SENSOR)), {}, alike=[("a", "b")]), "a", ["a"]) is None
    problem = affine((effect("a[m]"), effect("a[f]"), effect("b")), {}, alike=[("a[m]", "b")])
    assert alias(problem, "a", ["a[m]", "a[f]"]) is None
    assert alias(problem, "a", ["a[m]"]) is not None
    problem = affine(tuple(map(effect, "ab")), {})
    (one,) = problem.predictions
    one.slopes["b"] *= 0.0  # type: ignore[attr-defined]
    assert noticed(problem, ["a"]) > 1.0
    assert noticed(problem, ["b"]) < NOTICED
    assert noticed(problem, []) == 0.0
