"""Which poles stay in the joint fit: those that are there, in the band and beyond it, and no others."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from identification.elastic.model import ElasticTerms
from identification.self_calibration import fit
from identification.self_calibration.problem import assembled, normals
from identification.self_calibration.solve import inverse, minimise, total

FLOOR = 0.0015


def minimum(problem, start):
    parts = problem.parts(FLOOR)
    return minimise(lambda x: total(normals(parts, problem.layout, x), len(x)), start, problem.knowledge, close=0.3)


def size(problem) -> int:
    return sum(part.observed.size for part in problem.parts(FLOOR))


def frequencies(problem, x) -> np.ndarray:
    return np.sort(problem.campaigns[0].structure.terms(problem.layout, x).frequency)


@pytest.fixture(scope="module")
def elastic(ordinary, lab):
    """The joint problem of an article with two modes in the band, and its minimum."""
    laboratory = replace(ordinary, frequency=np.arange(4.0, 32.01, 0.25), rng=np.random.default_rng(7))
    problem = assembled(laboratory.evidence(terms=lab.MODES), laboratory.settings(modes=2))
    return problem, minimum(problem, problem.layout.start)


@pytest.fixture(scope="module")
def longer(elastic):
    """The same with a pole where nothing resonates, and its minimum."""
    problem, solution = elastic
    line = int(np.argmin(np.abs(problem.parts(FLOOR)[0].observed.frequency - 22.0)))
    found = [fit.with_one_more(problem, solution.x, k) for k in range(line, line + 8)]
    more = next(one for one in found if one is not None)
    return more[0], minimum(*more)


def test_a_pole_that_is_not_there_goes_and_those_that_are_stay(longer, lab):
    problem, solution = longer
    assert problem.modes == 3
    shorter, x = fit.pruned(problem, solution, size(problem))
    assert_allclose(frequencies(shorter, x), lab.MODES.frequency, rtol=1e-3)
    assert minimum(shorter, x).converged


def test_a_pole_above_the_limit_is_left_alone(longer):
    problem, solution = longer
    left = fit.pruned(problem, solution, size(problem), below=20.0)
    assert left is None or left[0].modes == 3


def test_nothing_goes_where_every_pole_pays(elastic):
    problem, solution = elastic
    left = fit.pruned(problem, solution, size(problem))
    assert left is None or left[0].modes == 2


def test_a_worth_is_what_the_quadratic_cost_rises_by_without_the_pole(longer):
    problem, solution = longer
    N, x = solution.normal.matrix, solution.x
    found = fit.worths(problem, x, inverse(N))
    at = problem.layout.at("elastic:article").start - 10 + problem.campaigns[0].structure.elastic.blocks["participation"].start
    for r, worth in enumerate(found):
        held = np.arange(at + 6 * r, at + 6 * r + 6)
        free = np.setdiff1d(np.arange(len(x)), held)
        step = np.zeros(len(x))
        step[held] = -x[held]
        scale = 1 / np.sqrt(np.diag(N)[free])
        inner = scale[:, None] * N[np.ix_(free, free)] * scale
        step[free] = -scale * np.linalg.solve(inner, scale * (N[np.ix_(free, held)] @ step[held]))
        assert_allclose(worth, step @ N @ step, rtol=1e-4, atol=1e-3)  # inverses of matrices of condition 1e10


def test_a_pole_beyond_the_band_is_found_where_the_residual_mass_does_not_do(ordinary, lab):
    """Without it the joint fit is off by more than its intervals; the pole pays, and one more does not."""
    beyond = ElasticTerms(
        frequency=np.array([11.5, 38.0]),
        damping=np.diag([0.6, 2.0]),
        participation=np.array([[3.5, 0.2, 0.0, 0.1, 2.0, 0.0], [0.1, 4.0, 0.1, -1.6, 0.0, 0.1]]),
        residual=lab.MODES.residual,
    )
    laboratory = replace(ordinary, frequency=np.arange(4.0, 32.01, 0.25), rng=np.random.default_rng(8))
    problem = assembled(laboratory.evidence(terms=beyond), laboratory.settings(modes=1))
    solution = minimum(problem, problem.layout.start)
    assert problem.modes_beyond(solution.x) == 0
    longer = fit.with_one_beyond(problem, solution.x)
    more = minimum(*longer)
    assert 2 * (solution.normal.cost - more.normal.cost) > 10 * fit.pole_penalty(size(problem))
    assert longer[0].modes_beyond(more.x) == 1
    assert_allclose(frequencies(longer[0], more.x)[-1], 38.0, rtol=0.05)
