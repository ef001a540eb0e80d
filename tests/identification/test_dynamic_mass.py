"""Eqs. 9 to 11: what went in comes out, whatever the table did besides, and what six runs must do."""

import numpy as np
import pytest

from geometry.dynamic_mass import LEVELS as BY_AXIS
from geometry.errors import BadInput
from identification.dynamic_mass import from_runs, quotient

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


def test_least_squares_of_noisy_runs_come_nearer_with_more_of_them() -> None:
    def error(count: int) -> float:
        U = _runs(count, 0.05)
        F = _loads(U)
        return float(np.abs(from_runs(F + 0.1 * _complex(*F.shape), U, LINES).dynamic_mass.matrix - H).mean())

    assert error(96) < 0.4 * error(6)  # sixteen times the runs, a quarter of the error


@pytest.mark.parametrize(
    ("runs", "said"),
    [
        (_runs(6, 0.05)[:5], "at least six runs, found 5"),
        (np.concatenate([_runs(5, 0.0), _runs(5, 0.0)]), "leave the base motion gamma undriven at 4 Hz"),
    ],
)
def test_runs_that_leave_a_motion_undriven_are_refused_by_name(runs: np.ndarray, said: str) -> None:
    with pytest.raises(BadInput, match=said):
        from_runs(_loads(runs), runs, LINES)


def test_loads_of_other_lines_than_the_motions_are_refused() -> None:
    U = _runs(6, 0.05)
    with pytest.raises(BadInput, match="at 9 lines"):
        from_runs(_loads(U)[:, :5], U, LINES)
