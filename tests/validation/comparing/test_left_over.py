"""What a channel reads beyond all others: against a fit without that channel, and against chance."""

import numpy as np
from numpy.testing import assert_allclose

from validation.compare.maps import combined, covariance, judged_error, left_over

LINES, CHANNELS, INPUTS, TOLERANCES = 3, 7, 2, 4


def _made(seed: int) -> tuple[np.ndarray, ...]:
    rng = np.random.default_rng(seed)

    def some(*shape: int) -> np.ndarray:
        return rng.standard_normal(shape) + 1j * rng.standard_normal(shape)

    A, V = some(LINES, CHANNELS, INPUTS), 0.3 * some(LINES, CHANNELS, TOLERANCES)
    return some(LINES, CHANNELS), A, covariance(rng.uniform(0.1, 0.4, (LINES, CHANNELS)), V)


def test_a_channel_is_predicted_from_all_others_as_a_fit_without_it_predicts_it() -> None:
    y, A, S = _made(1)
    found, _ = left_over(y, A, S, None)
    for n, c in np.ndindex(LINES, CHANNELS):
        o = np.delete(np.arange(CHANNELS), c)
        inverse = np.linalg.inv(S[n][np.ix_(o, o)])
        u = np.linalg.solve(A[n, o].conj().T @ inverse @ A[n, o], A[n, o].conj().T @ inverse @ y[n, o])
        # the best unbiased prediction of a correlated reading (Goldberger, JASA 57, 1962)
        said = A[n, c] @ u + S[n, c, o] @ inverse @ (y[n, o] - A[n, o] @ u)
        assert_allclose(found.value[n, c], y[n, c] - said, rtol=1e-9)


def test_known_inputs_leave_a_channel_to_its_correlation_with_the_others() -> None:
    y, A, S = _made(2)
    u = np.ones((LINES, INPUTS), dtype=complex)
    found, chi2 = left_over(y, A, S, u)
    e = y - (A @ u[..., None])[..., 0]
    P = np.linalg.inv(S)
    assert_allclose(found.value, np.einsum("nij,nj->ni", P, e) / np.diagonal(P, axis1=1, axis2=2), rtol=1e-9)
    assert_allclose(chi2, np.einsum("ni,nij,nj->n", e.conj(), P, e).real, rtol=1e-9)


def test_errors_scatter_as_they_are_expected_to() -> None:
    """Draws of noise and tolerances; 4000 of them tell a standard deviation to about 1 %."""
    rng, count = np.random.default_rng(3), 4000
    _, A, S = _made(4)
    L = np.linalg.cholesky(S[0])
    drawn = (rng.standard_normal((count, CHANNELS)) + 1j * rng.standard_normal((count, CHANNELS))) / np.sqrt(2) @ L.T
    found, chi2 = left_over(drawn, np.broadcast_to(A[0], (count, CHANNELS, INPUTS)), np.broadcast_to(S[0], (count, 7, 7)), None)
    ratio = np.sqrt(np.mean(np.abs(found.value) ** 2, axis=0)) / found.expected[0]
    assert_allclose(ratio, 1.0, atol=0.05)
    assert_allclose(chi2.mean(), CHANNELS - INPUTS, rtol=0.05)


def test_an_error_of_loads_is_free_of_the_inputs_and_scatters_as_expected() -> None:
    rng, count = np.random.default_rng(5), 4000
    _, A, S = _made(6)
    judged, R = np.array([False] * 4 + [True] * 3), np.array([[1.0, 1.0, 0.0], [0.0, 1.0, -1.0]])
    L = np.linalg.cholesky(S[0])
    drawn = (rng.standard_normal((count, CHANNELS)) + 1j * rng.standard_normal((count, CHANNELS))) / np.sqrt(2) @ L.T
    drawn = drawn + A[0] @ np.array([3.0, -2.0j])
    error, spread = judged_error(drawn, np.broadcast_to(A[0], (count, 7, 2)), np.broadcast_to(S[0], (count, 7, 7)), None, judged)
    found = combined(error, spread, R)
    assert_allclose(np.sqrt(np.mean(np.abs(found.value) ** 2, axis=0)) / found.expected[0], 1.0, atol=0.05)


def test_a_channel_that_nothing_checks_deviates_by_nothing_and_is_never_surprising() -> None:
    y = np.array([[1.0, 2.0, 5.0 + 0j]])
    A = np.array([[[1, 0], [1, 0], [0, 1.0 + 0j]]])
    found, _ = left_over(y, A, np.eye(3, dtype=complex)[None], None)
    assert found.expected[0, 2] == np.inf
    assert found.value[0, 2] == 0
    assert_allclose(np.abs(found.value[0, :2]), 1.0, rtol=1e-12)
