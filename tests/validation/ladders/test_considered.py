"""Consider covariance: it covers where tolerances nobody fitted move the estimate, and what noise alone leaves does not."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose

from validation.estimation.fit import fit
from validation.estimation.problem import EFFECT, PLAIN, SENSOR, Parameter, Problem
from validation.history.add import covariance, of_fit

MakeProblem = Callable[..., Problem]


def test_the_formula_is_the_covariance_of_what_is_drawn() -> None:
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


def test_without_tolerances_it_is_what_noise_leaves() -> None:
    J = np.random.default_rng(4).standard_normal((10, 3))
    estimated = np.array([True, True, False])
    assert_allclose(covariance(J.T @ J, estimated, np.zeros(3)), np.linalg.inv(J[:, :2].T @ J[:, :2]), rtol=1e-12)


@pytest.fixture(scope="module")
def drawn(affine: MakeProblem) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
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


def test_95_per_cent_intervals_cover_about_95_per_cent(drawn: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    error, considered, _ = drawn
    covered = np.mean(np.abs(error) < 1.96 * considered)
    assert 0.90 <= covered <= 0.99  # 150 draws: 0.95 within 2.5 standard deviations of 0.018


def test_intervals_of_noise_alone_do_not(drawn: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    error, _, noise = drawn
    assert np.mean(np.abs(error) < 1.96 * noise) < 0.75
