"""How a fit stands against those of nulls: misfit, price and a single tolerance each refuse it alone."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from validation.diagnose.search import ABSURD, SCATTER, UNLIKELY, goodness_of_fit
from validation.estimation.fit import FLOOR
from validation.estimation.problem import Parameter
from validation.estimation.result import Fit
from validation.estimation.verdicts import expected_z2

FREEDOM, COUNT = 5000, 100


def fitted(*, misfit: float = 0.9, z: np.ndarray | None = None) -> Fit:
    """All tolerances are told by the data, ten times better than beforehand, and moved by `z`."""
    moved = np.ones(COUNT) if z is None else z
    return Fit(
        parameters=tuple(Parameter(name=f"gain:{k}", unit="1", tolerance=0.01) for k in range(COUNT)),
        offsets=0.01 * moved,
        covariance=0.001**2 * np.eye(COUNT),
        cost=0.5 * (misfit * FREEDOM + float(moved @ moved)),
        chi2=misfit * FREEDOM,
        degrees_of_freedom=FREEDOM,
        tolerance_z2=float(moved @ moved),
        tolerances=COUNT,
        log_evidence=0.0,
        converged=True,
    )


@pytest.fixture
def noisy(monkeypatch: pytest.MonkeyPatch) -> Any:
    """A problem whose likelihood allows for noise and as much again of a floor."""
    noise = np.ones((1, 4, 2))
    seen = SimpleNamespace(noise=noise, floor=noise / FLOOR)
    monkeypatch.setattr("validation.diagnose.search.observed", lambda measured, lines: seen)
    return SimpleNamespace(predictions=(of_spread(0.0),), lines_of=lambda one: None)


def of_spread(spread: float, scatter: float = 0.0) -> SimpleNamespace:
    """A data set whose noise is known so well."""
    return SimpleNamespace(measured=SimpleNamespace(noise_spread=spread, noise_scatter=scatter))


def one_far(z: float) -> np.ndarray:
    return np.concatenate([[z], np.full(COUNT - 1, 0.9)])


def test_the_misfit_of_a_null_is_the_share_of_noise_in_what_is_allowed_for(noisy: Any) -> None:
    assert_allclose(goodness_of_fit(fitted(), noisy).limit, 0.5 * (1 + SCATTER * np.sqrt(2 / FREEDOM)), rtol=1e-12)


def test_an_estimate_of_the_noise_makes_chi2_larger_by_its_variance_as_drawn_ones_do(noisy: Any) -> None:
    """Half of the variance is noise, estimated to 20 % at every line."""
    noisy.predictions = (of_spread(0.0, 0.2),)
    estimates = 1 + 0.2 * np.random.default_rng(1).standard_normal(1_000_000)
    drawn = np.mean(1 / (estimates + 1)) / np.mean(estimates / (estimates + 1))
    noise_alone = goodness_of_fit(fitted(), noisy).limit / (1 + SCATTER * np.sqrt(2 / FREEDOM))
    assert_allclose(noise_alone / 0.5, drawn, rtol=1e-3)


def test_noise_that_short_silences_tell_widens_the_limit(noisy: Any) -> None:
    """Two data sets of one size: 3 % and 4 % of each are 2.5 % of both."""
    noisy.predictions = (of_spread(0.03), of_spread(0.04))
    assert_allclose(
        goodness_of_fit(fitted(), noisy).limit, 0.5 * (1 + SCATTER * np.hypot(np.sqrt(2 / FREEDOM), 0.025)), rtol=1e-12
    )


def test_a_fit_within_noise_that_pays_what_is_due_is_that_of_a_null(noisy: Any) -> None:
    of = fitted(misfit=0.49)
    found = goodness_of_fit(of, noisy)
    assert found.null
    assert found.text == ""
    assert_allclose(found.prior_penalty, COUNT / expected_z2(of), rtol=1e-12)
    assert_allclose(expected_z2(of), 0.99 * COUNT, rtol=1e-12)  # each was told ten times better
    assert found.excess(of) == pytest.approx(0.5 * 0.01 * COUNT)  # no misfit, and a hundredth more than is due


def test_misfit_alone_refuses(noisy: Any) -> None:
    limit = goodness_of_fit(fitted(), noisy).limit
    below, above = (goodness_of_fit(fitted(misfit=factor * limit), noisy) for factor in (0.999, 1.001))
    assert (below.null, above.null) == (True, False)
    assert above.text.startswith("chi² per degree of freedom")
    assert ";" not in above.text


def test_price_alone_refuses(noisy: Any) -> None:
    """Every tolerance a little too far, none of them by much."""
    from scipy.stats import chi2

    z = np.sqrt(chi2.isf(UNLIKELY, 0.99 * COUNT) / COUNT)
    below, above = (goodness_of_fit(fitted(misfit=0.4, z=np.full(COUNT, factor * z)), noisy) for factor in (0.999, 1.001))
    assert (below.null, above.null) == (True, False)
    assert above.largest < 2
    assert above.text.startswith("the tolerances pay")
    assert ";" not in above.text


def test_one_tolerance_alone_refuses(noisy: Any) -> None:
    below, above = (goodness_of_fit(fitted(misfit=0.4, z=one_far(-factor * ABSURD)), noisy) for factor in (0.999, 1.001))
    assert (below.null, above.null) == (True, False)
    assert above.likely > UNLIKELY
    assert above.text.startswith("a tolerance stands at 4.8 z")


def test_everything_that_refuses_is_said(noisy: Any) -> None:
    found = goodness_of_fit(fitted(misfit=2.0, z=np.full(COUNT, 6.0)), noisy)
    assert found.text.count(";") == 2
    assert not found.null
