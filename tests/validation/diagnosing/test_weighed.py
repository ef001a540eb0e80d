"""Evidence of one effect of unknown size: against the Gaussian closed form, against quadrature, by its coverage."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from scipy.special import log_ndtr
from scipy.stats import norm

from validation.diagnose.classical import InterpolatedCurve, both, curve, weighed

PLAUSIBLE = 0.5
LEFT = np.array([0.3, -0.2, 0.5])
SLOPE = np.array([1.0, 0.4, -2.0])
"""What one unit of the effect adds to three predictions."""


@pytest.fixture(scope="module")
def precision() -> np.ndarray:
    spread = np.array([[0.1, 0.0, 0.0], [0.05, 0.12, 0.0], [-0.02, 0.03, 0.2]])
    return np.linalg.inv(spread @ spread.T)


def linear(low: float = -6 * PLAUSIBLE, slope: np.ndarray = SLOPE) -> InterpolatedCurve:
    return curve(lambda sizes: sizes[:, None] * slope, low, 6 * PLAUSIBLE)


def squared() -> InterpolatedCurve:
    return curve(lambda sizes: sizes[:, None] ** 2 * SLOPE, 0.0, 6 * PLAUSIBLE)


def _gaussian(precision: np.ndarray) -> tuple[float, float, float]:
    """Evidence, mean and standard deviation of the size, both signs allowed."""
    information, pull = SLOPE @ precision @ SLOPE, -SLOPE @ precision @ LEFT
    width = 1 / (information + PLAUSIBLE**-2)
    return 0.5 * pull**2 * width - 0.5 * np.log(1 + PLAUSIBLE**2 * information), pull * width, np.sqrt(width)


def test_an_effect_that_adds_in_proportion_weighs_what_two_gaussians_do(precision: np.ndarray) -> None:
    evidence, mean, sd = _gaussian(precision)
    found = weighed(linear(), PLAUSIBLE, LEFT, precision)
    # beyond six standard deviations lies a part in 1e9 of the prior; the trapezoidal rule is as good, interpolated quantiles less
    assert_allclose(found.evidence, evidence, rtol=1e-6)
    assert_allclose(found.value, mean, atol=1e-4 * sd)
    assert_allclose([found.low, found.high], norm.ppf([0.05, 0.95], mean, sd), rtol=1e-3)


def test_an_effect_of_one_sign_gains_what_the_other_sign_would_have_wasted(precision: np.ndarray) -> None:
    evidence, mean, sd = _gaussian(precision)
    found = weighed(linear(low=0.0), PLAUSIBLE, LEFT, precision)
    assert_allclose(found.evidence, evidence + np.log(2) + log_ndtr(mean / sd), rtol=1e-5)


@pytest.mark.parametrize("sign", [-1, 1])
def test_an_effect_that_goes_with_the_square_of_its_size_is_integrated_as_it_is(precision: np.ndarray, sign: int) -> None:
    left = sign * LEFT

    def density(size: float) -> float:
        r = left + size**2 * SLOPE
        return 2 * norm.pdf(size, 0, PLAUSIBLE) * np.exp(-0.5 * (r @ precision @ r - left @ precision @ left))

    expected = np.log(quad(density, 0, 6 * PLAUSIBLE, epsabs=0, epsrel=1e-10, limit=200)[0])
    assert_allclose(weighed(squared(), PLAUSIBLE, left, precision).evidence, expected, rtol=1e-5)


def test_an_effect_that_can_only_move_the_other_way_is_best_not_there(precision: np.ndarray) -> None:
    found = weighed(linear(low=0.0, slope=precision @ LEFT), PLAUSIBLE, LEFT, precision)
    assert found.best == 0
    assert_allclose(found.chi2, LEFT @ precision @ LEFT, rtol=1e-12)
    assert found.evidence < 0


def test_two_effects_that_do_not_touch_weigh_what_they_weigh_alone() -> None:
    left, precision = np.array([0.4, -0.7]), np.diag([100.0, 25.0])
    curves = (linear(slope=np.array([1.0, 0.0])), linear(slope=np.array([0.0, 1.0])))
    alone = [weighed(one, PLAUSIBLE, left, precision) for one in curves]
    one, other = both(curves, (PLAUSIBLE, PLAUSIBLE), left, precision)
    assert_allclose(one.evidence, sum(each.evidence for each in alone), rtol=1e-4)  # grids of 121 points
    assert_allclose([one.value, other.value], [each.value for each in alone], rtol=1e-2)
    assert_allclose(one.chi2, 0.0, atol=1e-2)


def test_intervals_hold_the_truth_as_often_as_they_say() -> None:
    rng = np.random.default_rng(3)
    precision = np.diag([400.0, 400.0])
    answer = curve(lambda sizes: sizes[:, None] ** 2 * np.array([1.0, 0.3]), 0.0, 6 * PLAUSIBLE)
    inside = 0
    count = 300
    for truth in np.abs(rng.normal(0, PLAUSIBLE, count)):
        left = -answer.at(np.array([truth]))[0] + rng.normal(0, 0.05, 2)
        found = weighed(answer, PLAUSIBLE, left, precision)
        inside += found.low <= truth <= found.high
    # truths drawn from what is plausible: exactly 90 % are due; three standard deviations of 300 draws are 5 %
    assert_allclose(inside / count, 0.9, atol=0.05)
