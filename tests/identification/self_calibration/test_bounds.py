"""Levenberg-Marquardt within bounds: the minimum of a convex cost there satisfies the conditions of Karush, Kuhn and Tucker."""

import numpy as np
import pytest

from identification.self_calibration.solve import Normal, minimise


@pytest.mark.parametrize("seed", range(8))
def test_the_gradient_is_nothing_inside_and_points_outwards_at_every_bound(seed: int) -> None:
    rng = np.random.default_rng(seed)
    J, wanted = rng.standard_normal((30, 6)), 2 * rng.standard_normal(6)
    low, high = np.full(6, -1.0), np.full(6, 0.5)

    def data(x):
        left = J @ (x + 0.1 * x**3 - wanted)
        slopes = J * (1 + 0.3 * x**2)
        return Normal(cost=0.5 * float(left @ left), gradient=slopes.T @ left, matrix=slopes.T @ slopes)

    def knowledge(x):
        return 0.1 * x, 0.1 * np.eye(6)

    found = minimise(data, np.zeros(6), knowledge, close=1e-6, bounds=(low, high))
    x = found.x
    gradient = data(x).gradient + 0.01 * x
    assert found.converged
    assert np.all((x >= low) & (x <= high))
    at_low, at_high = x < low + 1e-9, x > high - 1e-9
    assert np.any(at_low | at_high)
    assert np.all(gradient[at_low] > 0)
    assert np.all(gradient[at_high] < 0)
    assert np.abs(gradient[~(at_low | at_high)]).max(initial=0.0) < 1e-3


def test_wide_bounds_change_nothing() -> None:
    J, y = np.vander(np.linspace(0, 1, 9), 3), np.arange(9.0)

    def data(x):
        left = J @ x - y
        return Normal(cost=0.5 * float(left @ left), gradient=J.T @ left, matrix=J.T @ J)

    def knowledge(x):
        return 1e-3 * x, 1e-3 * np.eye(3)

    wide = (np.full(3, -1e9), np.full(3, 1e9))
    free, bounded = minimise(data, np.zeros(3), knowledge), minimise(data, np.zeros(3), knowledge, bounds=wide)
    assert np.array_equal(free.x, bounded.x)
