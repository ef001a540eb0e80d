"""Residuals have the deviation that is predicted of them."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from validation.estimation.evaluate import residuals
from validation.estimation.fit import fit
from validation.estimation.likelihood import floor_of
from validation.estimation.problem import FITTED, PLAIN, Problem


@pytest.mark.parametrize("known", [False, True], ids=["latent", "known"])
@pytest.mark.parametrize("per_run", [False, True], ids=["shared", "per run"])
def test_over_many_laboratories_residuals_scatter_as_predicted(lab, known, per_run):
    """All parameters drawn from what is known beforehand, little enough for a linear answer; nothing fitted, no floor needed."""
    little = {"mass": 0.004, "inertia": 0.005, "damping": 0.05}
    parameters = [replace(p, tolerance=little.get(p.name, p.tolerance)) for p in lab.LABORATORY]
    squares, expected = 0.0, 0.0
    for seed in range(150):
        rng = np.random.default_rng(seed)
        truth = lab.drawn(seed) | {name: sd * rng.standard_normal() for name, sd in little.items()}
        toy = lab.toy(truth, parameters=parameters, seed=7, lines=6, runs=2, known=known, per_run=per_run)
        toy = replace(toy, parameters=toy.parameters[:-1])  # the frequency is not drawn
        (found,) = residuals(Problem((toy,)), {}, floor=0.0)
        squares, expected = squares + np.abs(found.values) ** 2, expected + found.sigma**2
    ratio = np.sqrt(np.mean(squares, axis=(0, 1)) / np.mean(expected, axis=(0, 1)))
    assert_allclose(ratio, 1.0, atol=0.2)  # a gain that all lines share: 150 draws tell its deviation to 6 %


def test_without_tolerances_the_deviation_is_that_of_noise_and_floor(lab):
    toy = replace(lab.toy({}, known=True), parameters=())
    (found,) = residuals(Problem((toy,)), {}, floor=0.0)
    assert_allclose(found.sigma, toy.measured.noise, rtol=1e-12)
    (floored,) = residuals(Problem((toy,)), {}, floor=0.01)
    assert_allclose(floored.sigma**2 - toy.measured.noise**2, (0.01 * floor_of(toy.measured)) ** 2, rtol=1e-9)


def test_a_fault_stands_out_in_its_own_channel(lab):
    toy = lab.toy({**lab.drawn(4), "gain:f3": 0.08})
    problem = Problem((toy,))
    (found,) = residuals(problem, fit(problem, PLAIN))
    sigmas = np.sqrt(np.mean(np.abs(found.values) ** 2 / found.sigma**2, axis=(0, 1)))
    worst = lab.CHANNELS[int(np.argmax(sigmas))]
    assert worst == "f3"
    assert sigmas.max() > 5
    assert np.median(sigmas) < 2


def test_what_was_fitted_no_longer_excuses_a_residual(lab):
    toy = lab.toy(lab.drawn(4))
    problem = Problem((toy,))
    (plain,), (fitted,) = residuals(problem, fit(problem, PLAIN)), residuals(problem, fit(problem, FITTED))
    assert np.all(fitted.sigma < plain.sigma)


def test_inputs_and_levels_are_told(lab):
    toy = lab.toy({}, known=True)
    (found,) = residuals(Problem((toy,)), {})
    assert_allclose(found.inputs, toy.measured.inputs)
    assert found.level.shape == found.values.shape == toy.measured.values.shape
    latent = lab.toy({}, known=False)
    (estimated,) = residuals(Problem((latent,)), {})
    assert_allclose(estimated.inputs, toy.measured.inputs, atol=2e-3)  # the same draw; noise of pick-ups is 2e-4


def test_lines_of_the_fits_may_be_asked_for_alone(lab):
    problem = Problem((lab.toy({}, lines=300),)).thinned()
    (few,), (all_lines,) = residuals(problem, {}, every_line=False), residuals(problem, {})
    assert_allclose(few.values, all_lines.values[:, problem.lines["one"]], rtol=1e-12)
    assert_allclose(few.sigma, all_lines.sigma[:, problem.lines["one"]], rtol=1e-12)
