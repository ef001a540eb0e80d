"""Functions of time with their derivatives: products, sines, steps, held against differences and closed forms."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.base_excitation.patterns import SMOOTH, Jet, exponential, sine, smooth_step, window

TIME = np.linspace(-0.2, 1.4, 3001)


def power(exponent: int) -> Jet:
    t, n = TIME, exponent
    return Jet(t**n, n * t ** (n - 1), n * (n - 1) * t ** (n - 2))


def agree(found: Jet, expected: Jet) -> None:
    for kind in ("value", "first", "second"):
        assert_allclose(getattr(found, kind), getattr(expected, kind), rtol=0, atol=1e-12)


def test_powers_multiply_and_add_as_powers_do() -> None:
    agree(power(2) * power(3), power(5))
    agree(power(2) + power(2), 2.0 * power(2))


def test_exponentials_multiply_as_exponentials_do() -> None:
    agree(exponential(TIME, 2.0, 0.7) * exponential(TIME, 3.0, -1.2), exponential(TIME, 6.0, -0.5))


def test_the_sine_of_a_bent_angle_keeps_its_identity() -> None:
    """sin 2a = 2 sin a cos a, with a = t³ + 0.3."""
    angle = power(3)
    a = Jet(angle.value + 0.3, angle.first, angle.second)
    cosine = sine(Jet(a.value + np.pi / 2, a.first, a.second))
    agree(sine(2.0 * a), 2.0 * (sine(a) * cosine))


@pytest.mark.parametrize("shape", [smooth_step(TIME, 0.1, 1.1), window(TIME, 0.0, 0.5, 0.6, 1.2)])
def test_steps_and_windows_have_the_derivatives_that_they_state(shape: Jet) -> None:
    """Central differences are of second order, (h / width)² of the next derivatives."""
    h = TIME[1] - TIME[0]
    assert_allclose(np.gradient(shape.value, h)[1:-1], shape.first[1:-1], rtol=0, atol=1e-4 * np.abs(shape.first).max())
    assert_allclose(np.gradient(shape.first, h)[1:-1], shape.second[1:-1], rtol=0, atol=1e-4 * np.abs(shape.second).max())


def test_a_step_starts_with_as_many_vanishing_derivatives_as_stated() -> None:
    """Beside its foot it grows with the power after the last that vanishes, and it ends as it starts."""
    near, twice = smooth_step(np.array([1e-3, 2e-3]), 0.0, 1.0).value
    assert twice / near == pytest.approx(2 ** (SMOOTH + 1), rel=0.01)
    rising, falling = smooth_step(TIME, 0.0, 1.0), smooth_step(1 - TIME, 0.0, 1.0)
    assert_allclose(rising.value, 1 - falling.value, rtol=0, atol=1e-14)


def test_a_window_is_one_in_between_and_nothing_outside() -> None:
    shape = window(TIME, 0.0, 0.3, 0.8, 1.2)
    full, outside = (TIME >= 0.3) & (TIME <= 0.8), (TIME <= 0) | (TIME >= 1.2)
    assert np.all(shape.value[full] == 1)
    assert not shape.first[full].any()
    assert not np.stack([shape.value, shape.first, shape.second])[:, outside].any()
