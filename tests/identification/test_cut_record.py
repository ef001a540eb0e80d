"""What the end of a record makes of a mode that still rings, and the mode fitted by itself."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from identification.spectra.peak_hold import kept, lone_mode

OWN, ZETA, T = 6.5127, 0.00156, 32.0


@pytest.mark.parametrize("line", [204, 208, 212])
def test_a_cut_keeps_of_a_decay_what_is_predicted_the_same_at_all_lines(line: int) -> None:
    omega = 2 * np.pi * OWN
    lam, t = (-ZETA + 1j) * omega, np.linspace(0, T, 400_001)
    at = 2j * np.pi * line / T
    cut = np.trapezoid(np.exp((lam - at) * t), t)
    assert_allclose(cut * (at - lam), kept(OWN, ZETA, T), rtol=0, atol=1e-4)  # the second power of the step


def test_a_decay_that_is_over_is_kept_whole() -> None:
    assert_allclose(kept(OWN, 0.05, T), 1.0, rtol=0, atol=1e-20 + np.exp(-0.05 * 2 * np.pi * OWN * T))


@pytest.mark.parametrize("turn", [-0.3, 0.0, 0.2])
def test_a_mode_is_found_by_itself_with_its_turn_on_top_of_others(turn: float) -> None:
    f = 5.5 + np.arange(0, 2, 1 / 32)
    w, own = 2 * np.pi * f[:, None], 2 * np.pi * OWN
    exact = np.exp(1j * turn) * np.array([0.03, -0.05, 0.1])
    y = exact * w**2 / (w**2 - own**2 - 2j * ZETA * own * w) + np.array([0.2, 0.1j, -0.05])
    found = lone_mode(f, y, near=6.5, damping_ratio=0.004)
    assert found.frequency == pytest.approx(OWN, rel=1e-8)
    assert found.damping_ratio == pytest.approx(ZETA, rel=1e-6)
    assert_allclose(found.residues, exact, rtol=1e-6)
    assert found.turn == pytest.approx(turn, abs=1e-7)
