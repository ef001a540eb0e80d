"""Eqs. 9 to 11: what went in comes out, whatever the table did besides, and what six runs must do."""

import numpy as np
import pytest

from geometry.dynamic_mass import LEVELS as BY_AXIS
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from identification.base_motion import RunNoise
from identification.dynamic_mass import bias, corrected, cost, covariance, deviation, from_runs, quotient

LINES = np.linspace(4.0, 32.0, 9)
LEVELS = np.array(list(BY_AXIS.values()))
RNG = np.random.default_rng(11)


def _complex(*shape: int) -> np.ndarray:
    return RNG.standard_normal(shape) + 1j * RNG.standard_normal(shape)


H = _complex(len(LINES), 6, 6)


def _runs(count: int, cross: float) -> np.ndarray:
    """Base motions (r, n, 6): one axis a run at its level, the others a share of theirs."""
    driven = np.eye(6)[np.arange(count) % 6][:, None, :] * np.exp(1j * np.arange(count))[:, None, None]
    return (driven + cross * _complex(count, len(LINES), 6)) * LEVELS


def _loads(U: np.ndarray) -> np.ndarray:
    return np.einsum("njk,rnk->rnj", H, U)


@pytest.mark.parametrize("count", [6, 9])
def test_six_runs_or_more_give_back_the_dynamic_mass_that_made_them(count: int) -> None:
    U = _runs(count, 0.05)
    found = from_runs(_loads(U), U, LINES)
    np.testing.assert_allclose(found.dynamic_mass.matrix, H, rtol=0, atol=1e-12 * np.abs(H).max())


def test_the_quotient_of_one_axis_is_right_without_cross_motion_and_wrong_with_it() -> None:
    clean, crossed = _runs(6, 0.0), _runs(6, 0.05)
    np.testing.assert_allclose(quotient(_loads(clean)[1], clean[1], "y"), H[:, :, 1], rtol=1e-12)
    assert np.abs(quotient(_loads(crossed)[1], crossed[1], "y") - H[:, :, 1]).max() > 0.05


def test_the_condition_number_does_not_know_units() -> None:
    U = _runs(6, 0.05)
    np.testing.assert_allclose(
        from_runs(_loads(U), U, LINES).condition, np.linalg.cond((U / LEVELS).transpose(1, 2, 0)), rtol=1e-9
    )
    assert from_runs(_loads(U), U, LINES).condition.max() < 3


@pytest.mark.parametrize(
    ("runs", "said"),
    [
        (_runs(6, 0.05)[:5], "at least six runs, found 5"),
        (np.concatenate([_runs(5, 0.0), _runs(5, 0.0)]), "hardly any run drives gamma"),
        (0 * _runs(6, 0.0), "hardly any run drives x, y, z, alpha, beta and gamma"),
    ],
)
def test_runs_that_leave_a_motion_undriven_are_refused_by_name(runs: np.ndarray, said: str) -> None:
    with pytest.raises(BadInput, match=said):
        from_runs(_loads(runs), runs, LINES)


def test_loads_of_other_lines_than_the_motions_are_refused() -> None:
    U = _runs(6, 0.05)
    with pytest.raises(BadInput, match="at 9 lines"):
        from_runs(_loads(U)[:, :5], U, LINES)


def _together(U: np.ndarray, share: float, lines: slice) -> np.ndarray:
    """The same motions, but beta follows `share` of x at some lines, both as shares of their levels."""
    V = U.copy()
    V[:, lines, 4] = share * V[:, lines, 0] / LEVELS[0] * LEVELS[4]
    return V


def test_lines_above_the_limit_are_left_out_with_the_combination_that_moves_together() -> None:
    U = _together(_runs(6, 0.02), 0.2, slice(3, 6)) + 1e-4 * _complex(6, len(LINES), 6)
    found = from_runs(_loads(U), U, LINES)
    chosen = found.excitation.excluded(50.0)
    assert chosen.kept.tolist() == [True] * 3 + [False] * 3 + [True] * 3
    (reason,) = chosen.reasons
    assert reason.startswith("14.5 to 21.5 Hz (3 lines) are left out, condition number up to")
    assert "x and beta move together: 0.2 x - 1 beta hardly moves in any run" in reason
    assert found.excitation.excluded(1e9).reasons == ()


def test_lines_with_reasons_of_their_own_have_sentences_of_their_own() -> None:
    U = _runs(6, 0.02)
    U[:, 0, 2] *= 1e-3
    U[:, 1, 2:4] *= 1e-3
    reasons = from_runs(_loads(U), U, LINES).excitation.excluded(100.0).reasons
    assert [reason.split(", condition")[0] for reason in reasons] == ["4 Hz is left out", "7.5 Hz is left out"]
    assert [reason.split(": ")[1] for reason in reasons] == ["hardly any run drives z", "hardly any run drives z and alpha"]


def test_singular_runs_say_which_base_motions_are_linearly_dependent() -> None:
    U = _together(_runs(8, 0.02), -0.5, slice(4, 5))
    with pytest.raises(BadInput, match=r"linearly dependent at 18 Hz .*x and beta move together: 0\.5 x \+ 1 beta hardly moves"):
        from_runs(_loads(U), U, LINES)
    V = _runs(8, 0.02)
    V[:, :, 5] = 1j * V[:, :, 3]
    with pytest.raises(BadInput, match=r"alpha and gamma move together: .*out of phase"):
        from_runs(_loads(V), V, LINES)
    W = _runs(8, 0.02)
    W[:, :, 1] = W[:, :, 2] = W[:, :, 0]
    with pytest.raises(BadInput, match="x, y and z move together so that 2 combinations of them hardly move"):
        from_runs(_loads(W), W, LINES)


def test_a_run_of_small_weight_does_not_spoil_the_others() -> None:
    U = _runs(12, 0.05)
    F = _loads(U)
    F[7] += 10.0
    weights = np.ones(12)
    weights[7] = 1e-6
    found = from_runs(F, U, LINES, weights=weights)
    np.testing.assert_allclose(found.dynamic_mass.matrix, H, rtol=0, atol=1e-6)
    by_line = from_runs(F, U, LINES, weights=np.tile(weights[:, None], (1, len(LINES))))
    np.testing.assert_allclose(by_line.dynamic_mass.matrix, found.dynamic_mass.matrix, rtol=1e-12)
    with pytest.raises(BadInput, match="one positive number for each of 12 runs"):
        from_runs(F, U, LINES, weights=np.zeros(12))


def _noisy(count: int, share: float, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, RunNoise]:
    U = _runs(count, 0.05)
    F = _loads(U)
    u, f = share * LEVELS * np.ones(U.shape), share * np.abs(F).max() * np.ones(F.shape)
    noise = RunNoise(load=f[..., None] ** 2 * np.eye(6), motion=u[..., None] ** 2 * np.eye(6))
    draw = [(rng.standard_normal(U.shape) + 1j * rng.standard_normal(U.shape)) / np.sqrt(2) for _ in range(2)]
    return U + u * draw[0], F + f * draw[1], noise


def test_the_covariance_of_least_squares_is_the_scatter_of_many_tests() -> None:
    rng = np.random.default_rng(3)
    off, sd = [], None
    for _ in range(60):
        U, F, noise = _noisy(6, 0.003, rng)
        found = from_runs(F, U, LINES)
        sd = deviation(covariance(found, noise))
        off.append(np.abs(found.dynamic_mass.matrix - H) ** 2)
    ratio = np.sqrt(np.mean(off, axis=0)) / sd
    np.testing.assert_allclose(
        np.mean(ratio), 1, atol=0.05
    )  # 324 entries of 60 draws each: 0.004, and what the seed's runs differ
    np.testing.assert_allclose(ratio, 1, atol=0.4)  # one entry: 0.065, five of them


def test_least_squares_is_too_low_by_the_share_of_noise_and_errors_in_variables_is_not() -> None:
    """Each axis is driven in one run of six: noise of 20 % in every run is 0.04 beside 1/6 + 0.003, 19 % of the power."""
    U, F, noise = _noisy(240, 0.2, np.random.default_rng(4))
    plain = from_runs(F, U, LINES)
    mass, C = corrected(F, U, noise, plain)
    low = np.real(np.vdot(H, plain.dynamic_mass.matrix) / np.vdot(H, H))  # the share of H that is found
    np.testing.assert_allclose(low, 1 - 0.04 / (0.04 + 1 / 6 + 0.05**2), atol=0.01)
    np.testing.assert_allclose(bias(plain, noise).mean(), 1 - low, rtol=0.4)  # the axis that has most of it
    chance = np.sqrt(np.sum(np.abs(H * deviation(C)) ** 2) / 2) / np.real(np.vdot(H, H))
    assert chance < 0.01
    np.testing.assert_allclose(np.real(np.vdot(H, mass.matrix) / np.vdot(H, H)), 1, atol=3 * chance)
    z = np.abs(mass.matrix - H) / deviation(C)
    np.testing.assert_allclose(np.sqrt(np.mean(z**2)), 1, atol=0.12)  # 324 complex numbers: standard deviation 0.03


def test_noise_that_is_the_same_everywhere_gives_the_total_least_squares_of_golub_and_van_loan() -> None:
    """Closed form: the six leading left singular vectors of motions above loads, each divided by its noise."""
    U, F, noise = _noisy(18, 0.02, np.random.default_rng(6))
    mass, _ = corrected(F, U, noise, from_runs(F, U, LINES))
    u, f = np.sqrt(noise.motion[0, 0].diagonal()), np.sqrt(noise.load[0, 0].diagonal())
    left = np.linalg.svd(np.concatenate([U / u, F / f], axis=2).transpose(1, 2, 0))[0][:, :, :6]
    total = f[:, None] * (left[:, 6:] @ np.linalg.inv(left[:, :6])) / u
    np.testing.assert_allclose(mass.matrix, total, rtol=0, atol=1e-7 * np.abs(H).max())  # where the iteration stops


def test_six_runs_leave_nothing_to_correct() -> None:
    U, F, noise = _noisy(6, 0.02, np.random.default_rng(7))
    plain = from_runs(F, U, LINES)
    assert not bias(plain, noise).any()
    mass, C = corrected(F, U, noise, plain)
    np.testing.assert_allclose(mass.matrix, plain.dynamic_mass.matrix, rtol=0, atol=1e-9 * np.abs(H).max())
    np.testing.assert_allclose(C, covariance(plain, noise), rtol=0, atol=0.02 * np.abs(C).max())  # noise squared


def test_the_cost_of_cross_motion_is_what_the_table_did_besides_times_what_it_couples_to() -> None:
    """One run turns beta by 10 % of what it moves x: the quotient of x is off by H_jb u_b / u_x, and the others by nothing."""
    M = np.diag([40.0, 40, 40, 1.2, 1.2, 0.7]).astype(complex)
    M[0, 4] = M[4, 0] = 4.0
    U = _runs(6, 0.0)
    U[0, :, 4] = 0.1 * U[0, :, 0] / LEVELS[0] * LEVELS[4]
    F = np.einsum("jk,rnk->rnj", M, U)
    found = cost(F, U, MOTIONS, from_runs(F, U, LINES))
    ratio = 0.1 * LEVELS[4] / LEVELS[0]
    np.testing.assert_allclose(found.cross_motion, [0.1, 0, 0, 0, 0, 0], atol=1e-12)
    np.testing.assert_allclose(found.diagonal, [ratio * 4 / 40, 0, 0, 0, 0, 0], atol=1e-12)
    np.testing.assert_allclose(found.column, [ratio * 1.2 / np.sqrt(40 * 1.2), 0, 0, 0, 0, 0], atol=1e-12)
    assert found.text[0].startswith("x: the other five axes move 10 % as much; the quotient is 1.2 % off on the diagonal")
    with pytest.raises(BadInput, match="no run drives z, gamma alone"):
        cost(F, U, ("x", "y", "", "alpha", "beta", ""), from_runs(F, U, LINES))
