"""Closed forms that rows are held against agree with textbook roots, each other in their limits, and rigid bodies."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from validation.verification.beams import Beam, rod_dynamic_mass, rod_fixed_free
from validation.verification.solids import in_plane, thin_plate

BEAM = Beam(length=1.3, bending=345.0, mass=1.57)
STOCKY = replace(BEAM, shear=2e5, rotary=1e-3)
BLEVINS_CLAMPED = np.array([1.87510407, 4.69409113, 7.85475744, 10.99554073])
BLEVINS_FREE = np.array([4.73004074, 7.85320462, 10.9956078, 14.1371655])


@pytest.mark.parametrize(("clamped", "printed"), [(True, BLEVINS_CLAMPED), (False, BLEVINS_FREE)])
def test_roots_are_those_that_blevins_prints(clamped, printed):
    frequencies = BEAM.euler_bernoulli(4, clamped=clamped)
    roots = np.sqrt(2 * np.pi * frequencies * np.sqrt(BEAM.mass / BEAM.bending)) * BEAM.length
    assert_allclose(roots, printed, rtol=1e-8)  # eight decimals and more are printed


@pytest.mark.parametrize("clamped", [True, False])
def test_without_shear_and_rotary_inertia_timoshenkos_beam_is_euler_and_bernoullis(clamped):
    euler = BEAM.euler_bernoulli(4, clamped=clamped)
    assert_allclose(BEAM.timoshenko(4, clamped=clamped), euler, rtol=1e-9)  # two solutions of the same equation
    assert np.all(STOCKY.timoshenko(4, clamped=clamped) < euler)


def test_shear_alone_of_a_stubby_beam_is_that_of_a_shear_rod():
    """A cantilever stiff in bending shears like a rod: (2 k - 1) c / (4 L), c² = k G A / (rho A)."""
    stiff = replace(BEAM, bending=5e5, shear=1e4, rotary=0.0)
    expected = rod_fixed_free(np.sqrt(1e4 / stiff.mass), stiff.length, 2)
    assert_allclose(stiff.timoshenko(2, clamped=True), expected, rtol=1e-2)  # bending adds (15 / 187 Hz)², halved


def test_a_driven_beam_is_its_rigid_body_at_low_frequency():
    m, L = BEAM.mass * BEAM.length, BEAM.length
    rigid = np.array([[m, m * L / 2], [m * L / 2, m * L**2 / 3]])
    assert_allclose(BEAM.base_driven([1e-2])[0], rigid, rtol=1e-5)  # (f / f_1)² with f_1 near 5 Hz
    assert_allclose(rod_dynamic_mass(3.0, 5000.0, 1.0, [1.0]), 3.0, rtol=1e-6)


def test_a_driven_beam_resonates_at_its_frequencies_as_a_cantilever():
    damped = replace(STOCKY, bending=STOCKY.bending * (1 + 1e-6j), shear=STOCKY.shear * (1 + 1e-6j))
    resonances = STOCKY.timoshenko(2, clamped=True)
    beside, on = (np.abs(damped.base_driven(factor * resonances)[:, 0, 0]) for factor in (1.02, 1.0))
    assert np.all(on > 1e3 * beside)


def test_a_driven_beam_is_reciprocal_and_loses_energy():
    H = replace(STOCKY, bending=STOCKY.bending * (1 + 0.02j)).base_driven(np.linspace(1, 60, 7))
    assert_allclose(H[:, 0, 1], H[:, 1, 0], rtol=1e-9)
    assert np.all(np.diagonal(H, axis1=1, axis2=2).imag < 0)  # force lags behind acceleration


E, NU, RHO, SIDE, THICKNESS = 200e9, 0.3, 8000.0, 10.0, 0.05


def thin(degree: int) -> np.ndarray:
    return thin_plate(SIDE, THICKNESS, E, NU, RHO, degree=degree, count=6)


def flat(degree: int) -> np.ndarray:
    return in_plane(SIDE, E, NU, RHO, degree=degree, count=6)


@pytest.mark.parametrize("frequencies", [thin, flat])
def test_a_higher_degree_never_raises_a_frequency(frequencies):
    values = np.array([frequencies(degree) for degree in (6, 8, 10, 12)])
    assert np.all(np.diff(values, axis=0) <= 1e-9 * values[0])  # 1e-9: rounding
    assert_allclose(values[-1], values[-2], rtol=2e-5)


def test_lames_motion_has_its_closed_form_and_frequencies_scale_with_thickness_over_the_square_of_the_side():
    assert_allclose(flat(12)[3], np.sqrt(E / (2 * (1 + NU)) / RHO) / (np.sqrt(2) * SIDE), rtol=1e-9)  # smooth: exponential
    assert_allclose(thin_plate(2 * SIDE, 3 * THICKNESS, E, NU, RHO, degree=8, count=3), 0.75 * thin(8)[:3], rtol=1e-9)


def test_without_poissons_ratio_a_plate_bends_like_a_beam():
    """It has the free beam's first bending mode among its own, exactly."""
    found = thin_plate(SIDE, THICKNESS, E, 0.0, RHO, degree=14, count=6)
    beam = 4.730040744862704**2 / (2 * np.pi * SIDE**2) * np.sqrt(E * THICKNESS**2 / 12 / RHO)
    assert np.min(np.abs(found / beam - 1)) < 1e-7
