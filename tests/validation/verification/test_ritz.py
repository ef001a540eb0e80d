"""Ritz's method falls towards the truth as the degree rises, and meets the one frequency that has a closed form."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from validation.verification import closed_forms

E, NU, RHO, SIDE, THICKNESS = 200e9, 0.3, 8000.0, 10.0, 0.05


def thin(degree: int) -> np.ndarray:
    return closed_forms.thin_plate(SIDE, THICKNESS, E, NU, RHO, degree=degree, count=6)


def flat(degree: int) -> np.ndarray:
    return closed_forms.in_plane(SIDE, E, NU, RHO, degree=degree, count=6)


@pytest.mark.parametrize("frequencies", [thin, flat])
def test_a_higher_degree_never_raises_a_frequency(frequencies: object) -> None:
    values = np.array([frequencies(degree) for degree in (6, 8, 10, 12)])
    assert np.all(np.diff(values, axis=0) <= 1e-9 * values[0])  # 1e-9: rounding
    assert_allclose(values[-1], values[-2], rtol=2e-5)


def test_lames_motion_of_a_free_plate_has_its_closed_form() -> None:
    assert_allclose(flat(12)[3], np.sqrt(E / (2 * (1 + NU)) / RHO) / (np.sqrt(2) * SIDE), rtol=1e-9)  # smooth: exponential


def test_frequencies_scale_with_thickness_over_the_square_of_the_side() -> None:
    assert_allclose(
        closed_forms.thin_plate(2 * SIDE, 3 * THICKNESS, E, NU, RHO, degree=8, count=3), 0.75 * thin(8)[:3], rtol=1e-9
    )


def test_without_poissons_ratio_a_plate_bends_like_a_beam() -> None:
    """Without Poisson's ratio the free plate has the free beam's first bending mode among its own, exactly."""
    found = closed_forms.thin_plate(SIDE, THICKNESS, E, 0.0, RHO, degree=14, count=6)
    beam = 4.730040744862704**2 / (2 * np.pi * SIDE**2) * np.sqrt(E * THICKNESS**2 / 12 / RHO)
    assert np.min(np.abs(found / beam - 1)) < 1e-7
