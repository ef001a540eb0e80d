"""The forecast in closed form against the same written out, and what is known of parameters carried over to a test."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from identification.self_calibration.solve import Normal
from validation.diagnose.next_test import _whitening, either, nats
from validation.diagnose.planned_test import Knowledge, Origin
from validation.estimation.likelihood import root
from validation.estimation.problem import EFFECT, Parameter


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(5)


def normal(d: np.ndarray, J: np.ndarray) -> Normal:
    return Normal(cost=0.5 * float(d @ d), gradient=J.T @ d, matrix=J.T @ J)


def test_the_forecast_is_the_quadratic_form_written_out(rng: np.random.Generator) -> None:
    J, L, d = rng.standard_normal((40, 6)), rng.standard_normal((6, 4)), rng.standard_normal(40)
    S = np.eye(40) + J @ L @ L.T @ J.T
    assert_allclose(nats(normal(d, J), L), 0.5 * d @ np.linalg.solve(S, d), rtol=1e-10)


def test_what_is_known_exactly_takes_up_nothing_and_what_is_not_known_takes_up_its_own(rng: np.random.Generator) -> None:
    J = rng.standard_normal((40, 6))
    d = J @ rng.standard_normal(6)
    assert_allclose(nats(normal(d, J), np.zeros((6, 0))), 0.5 * d @ d, rtol=1e-12)
    assert nats(normal(d, J), 1e4 * np.eye(6)) < 1e-6  # half of |z|², and |z| is of the size of 1e-4


def test_a_difference_twice_as_large_is_told_four_times_as_surely(rng: np.random.Generator) -> None:
    J, L, d = rng.standard_normal((40, 6)), rng.standard_normal((6, 4)), rng.standard_normal(40)
    assert_allclose(nats(normal(2 * d, J), L), 4 * nats(normal(d, J), L), rtol=1e-10)


def test_a_root_of_a_covariance_gives_it_back_whatever_the_units(rng: np.random.Generator) -> None:
    A = rng.standard_normal((5, 5)) * np.array([1e-6, 1.0, 1e5, 1e-3, 0.0])[:, None]
    C = A @ A.T
    assert_allclose(root(C) @ root(C).T, C, rtol=1e-9, atol=1e-12 * np.sqrt(np.outer(np.diag(C), np.diag(C))).max())
    W = _whitening(root(C)[:4])
    assert_allclose(W @ C[:4, :4] @ W.T, np.eye(4), atol=1e-6)


def test_what_is_plain_in_one_case_alone_is_not_expected() -> None:
    assert_allclose(either(1.0, 7.0, 1e6), 7.0)
    assert_allclose(either(0.5, 4.0, 9.0), 6.0)
    assert either(0.99, 1.0, 1e4) < 1.1  # where the mean would say a hundred


def parameter(name: str, tolerance: float, kind: str = "sensor") -> Parameter:
    return Parameter(name=name, unit="1", tolerance=tolerance, kind=kind)


@pytest.fixture
def known() -> Callable[[], Knowledge]:
    def make() -> Knowledge:
        C = np.array([[4.0, 1.0], [1.0, 9.0]])
        return Knowledge(effects=(), offsets={"a": 1.0, "b": 2.0}, names=("a", "b"), root=root(C), log_evidence=0.0)

    return make


def test_exchanged_sensors_take_along_what_is_known_of_them(known: Callable[[], Knowledge]) -> None:
    moved = {"a": Origin(name="b"), "b": Origin(name="a")}
    L = known().spread([parameter("a", 0.3), parameter("b", 0.3)], moved)
    assert_allclose(L @ L.T, [[9.0, 1.0], [1.0, 4.0]], atol=1e-12)
    assert known().at(moved) == {"a": 2.0, "b": 1.0}


def test_what_is_drawn_anew_is_known_as_beforehand_and_an_effect_that_is_not_there_is_known_not_to_be(
    known: Callable[[], Knowledge],
) -> None:
    every = [parameter("a", 0.3), parameter("new", 0.5), parameter("effect", 7.0, EFFECT)]
    L = known().spread(every, {"a": Origin()})
    assert_allclose(L @ L.T, np.diag([0.09, 0.25, 0.0]), atol=1e-12)


def test_half_of_an_effect_is_half_as_uncertain(known: Callable[[], Knowledge]) -> None:
    L = known().spread([parameter("a", 0.3)], {"a": Origin(name="a", factor=0.5)})
    assert_allclose(L @ L.T, [[1.0]], atol=1e-12)
    assert_allclose(known().at({"a": Origin(name="a", factor=0.5)})["a"], 0.5)


def test_odds_follow_from_evidence(known: Callable[[], Knowledge]) -> None:
    one, other = known(), replace(known(), log_evidence=np.log(3.0))
    assert_allclose(other.odds(one), 0.75)
    assert_allclose(one.odds(replace(one, log_evidence=-1e6)), 1.0)
