"""Explanations that belong together: by evidence, and by what they do to the channels."""

import numpy as np
from numpy.testing import assert_allclose

from validation.diagnose.candidates import share


def fisher(*columns: np.ndarray) -> np.ndarray:
    J = np.stack(columns, axis=1)
    return np.asarray(J.T @ J)


def test_a_share_is_the_squared_sine_of_the_angle_between_two_columns() -> None:
    for angle in (0.0, 0.02, 0.7, np.pi / 2):
        b, c = np.array([1.0, 0.0, 0.0]), 3e4 * np.array([np.cos(angle), np.sin(angle), 0.0])
        assert_allclose(share(fisher(b, c), np.zeros(2), 0, [1], []), np.sin(angle) ** 2, atol=1e-12)


def test_two_effects_that_differ_only_in_what_a_tolerance_does_are_one() -> None:
    rng = np.random.default_rng(2)
    b, loose = rng.standard_normal((2, 50))
    N = fisher(b, b + loose, loose)
    assert share(N, np.array([0.0, 0.0, 1e-9]), 0, [1], [2]) < 1e-6  # nothing is known of the tolerance
    assert share(N, np.array([0.0, 0.0, 1e9]), 0, [1], [2]) > 0.2  # it is known exactly


def test_several_sizes_together_may_do_what_none_of_them_does() -> None:
    rng = np.random.default_rng(2)
    c1, c2 = rng.standard_normal((2, 50))
    N = fisher(c1 - 2 * c2, c1, c2)
    assert share(N, np.zeros(3), 0, [1, 2], []) < 1e-9
    assert share(N, np.zeros(3), 0, [1], []) > 0.1
