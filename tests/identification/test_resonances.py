"""Resonances that functions show by themselves: of a chain of masses in closed form, and none of noise."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from identification.resonances import beside_axis, noise_beside_axis, resonances

MASS, SPRING, LOSS = 5.0, 5e4, 0.01


def chain(s: np.ndarray, drives: tuple[int, ...] = (0, 1, 2)) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Accelerances (r, n, 3) of three equal masses on equal springs at s (n,), their frequencies [Hz], and their shapes."""
    K = SPRING * np.array([[2.0, -1, 0], [-1, 2, -1], [0, -1, 1]])
    squares, shapes = np.linalg.eigh(K / MASS)
    modal = s[:, None] ** 2 / (s[:, None] ** 2 + LOSS * np.sqrt(squares) * s[:, None] + squares) / MASS
    H = np.einsum("im,nm,jm->jni", shapes, modal, shapes)
    return H[list(drives)], np.sqrt(squares) / (2 * np.pi), shapes.T


@pytest.mark.parametrize("drives", [(0,), (0, 1, 2)])
def test_frequencies_damping_and_shapes_are_those_of_the_chain(drives):
    f = np.arange(2.0, 60.0, 0.05)
    H, frequency, shapes = chain(2j * np.pi * f, drives)
    rng = np.random.default_rng(3)
    noise = 0.02 * np.abs(H).mean() * np.ones(H.shape)
    found = resonances(f, H + noise * (rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape)) / np.sqrt(2), noise)
    assert_allclose(found.frequency, frequency, rtol=2e-3)  # a constant beside each mode stands for all others
    assert_allclose(found.damping_ratio, LOSS / 2, rtol=0.2)
    for one, other in zip(found.shapes, shapes, strict=True):
        assert (one @ other) ** 2 / (one @ one) / (other @ other) > 0.995


def test_a_channel_that_reads_nothing_hides_none_and_has_no_part_in_a_shape():
    f = np.arange(2.0, 60.0, 0.05)
    H, frequency, _ = chain(2j * np.pi * f, (0,))
    H[:, :, 1] = 0.0
    found = resonances(f, H, 1e-3 * np.abs(H).mean() * np.ones(H.shape))
    assert_allclose(found.frequency, frequency, rtol=2e-3)
    assert_allclose(found.shapes[:, 1], 0.0, atol=1e-6)


def test_noise_alone_shows_none():
    rng = np.random.default_rng(4)
    f, shape = np.arange(2.0, 60.0, 0.1), (2, 580, 3)
    values = (rng.standard_normal(shape) + 1j * rng.standard_normal(shape)) / np.sqrt(2)
    assert resonances(f, values, np.ones(shape)).shapes.shape == (0, 3)


def test_beside_the_axis_functions_are_those_of_more_damping():
    f, at, width = np.arange(0.02, 400.0, 0.02), np.geomspace(4.0, 40.0, 20), 0.05
    found = beside_axis(f, chain(2j * np.pi * f)[0], at, width)
    wanted = chain(2 * np.pi * at * (width + 1j))[0]
    # What of the integral of Poisson lies beyond the band is some per cent of the largest
    assert np.abs(found - wanted).max() < 0.03 * np.abs(wanted).max()
    assert noise_beside_axis(f, np.ones((1, len(f), 1)), at, width).max() < 0.5
