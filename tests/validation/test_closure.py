"""What closure says of a dynamic mass that is wrong by a known share, at known lines; the way there is tested by the example."""

import numpy as np
import pytest

from geometry.dynamic_mass import DynamicMass
from validation.reference.reconstruction import BANDWIDTHS, deviation

LINES = np.array([4.0, 8.0, 10.0, 10.2, 20.0])
RESONANCE, RATIO = np.array([10.0]), np.array([0.003])
DIAGONAL = np.array([30.0, 30.0, 30.0, 8.0, 8.0, 2.0])


def _model() -> np.ndarray:
    """H (n, 6, 6), diagonal: rigid, ten times that at the resonance, an antiresonance at the last line."""
    H = np.tile(np.diag(DIAGONAL), (len(LINES), 1, 1)).astype(np.complex128)
    H[2:4] *= -10j
    H[-1] *= 1e-6
    return H


def _deviation(change: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    model = _model()
    found = deviation(
        DynamicMass(frequency=LINES, matrix=model + change), DynamicMass(frequency=LINES, matrix=model), RESONANCE, RATIO
    )
    return found.off, found.at


def test_the_model_itself_deviates_by_nothing() -> None:
    off, at = _deviation(np.zeros((len(LINES), 6, 6)))
    assert not off.any()
    assert not at.any()


@pytest.mark.parametrize("axis", range(6))
def test_an_error_of_a_known_share_is_told_for_its_axis_at_resonance_or_off_it(axis: int) -> None:
    change = np.zeros((len(LINES), 6, 6), dtype=np.complex128)
    change[2, axis, axis] = 0.02j * 10 * DIAGONAL[axis]  # at the resonance
    change[1, axis, axis] = 0.001 * DIAGONAL[axis]
    off, at = _deviation(change)
    np.testing.assert_allclose(at, 0.02 * (np.arange(6) == axis), rtol=1e-12)
    np.testing.assert_allclose(off, 0.001 * (np.arange(6) == axis), rtol=1e-12)


def test_a_line_is_at_a_resonance_within_so_many_half_widths_of_it() -> None:
    change = np.zeros((len(LINES), 6, 6), dtype=np.complex128)
    change[3, 0, 0] = 3.0
    off, at = _deviation(change)
    assert LINES[3] - RESONANCE[0] > BANDWIDTHS * RATIO[0] * RESONANCE[0]
    assert (off[0], at[0]) == (pytest.approx(0.01), 0.0)


def test_at_an_antiresonance_the_share_is_of_the_first_line() -> None:
    change = np.zeros((len(LINES), 6, 6), dtype=np.complex128)
    change[-1, 0, 0] = 0.3
    assert _deviation(change)[0][0] == pytest.approx(0.01)


def test_what_lies_beside_the_diagonal_is_not_counted() -> None:
    change = np.ones((len(LINES), 6, 6)) - np.eye(6)
    off, at = _deviation(change)
    assert not off.any()
    assert not at.any()
