"""The closed forms of beams agree with textbook roots, with each other in their limits, and with rigid bodies."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from validation.verification import closed_forms

BEAM = closed_forms.Beam(length=1.3, bending=345.0, mass=1.57)
STOCKY = replace(BEAM, shear=2e5, rotary=1e-3)
BLEVINS_CLAMPED = np.array([1.87510407, 4.69409113, 7.85475744, 10.99554073])
BLEVINS_FREE = np.array([4.73004074, 7.85320462, 10.9956078, 14.1371655])


@pytest.mark.parametrize(
    ("frequencies", "printed"),
    [(closed_forms.euler_bernoulli_cantilever, BLEVINS_CLAMPED), (closed_forms.euler_bernoulli_free, BLEVINS_FREE)],
)
def test_roots_are_those_that_blevins_prints(frequencies: object, printed: np.ndarray) -> None:
    roots = np.sqrt(2 * np.pi * frequencies(BEAM, 4) * np.sqrt(BEAM.mass / BEAM.bending)) * BEAM.length
    assert_allclose(roots, printed, rtol=1e-8)  # eight decimals and more are printed


@pytest.mark.parametrize(
    ("timoshenko", "euler"),
    [
        (closed_forms.timoshenko_cantilever, closed_forms.euler_bernoulli_cantilever),
        (closed_forms.timoshenko_free, closed_forms.euler_bernoulli_free),
    ],
)
def test_without_shear_and_rotary_inertia_timoshenkos_beam_is_euler_and_bernoullis(timoshenko: object, euler: object) -> None:
    assert_allclose(timoshenko(BEAM, 4), euler(BEAM, 4), rtol=1e-9)  # two solutions of the same equation
    assert np.all(timoshenko(STOCKY, 4) < euler(STOCKY, 4))


def test_shear_alone_of_a_stubby_beam_is_that_of_a_shear_rod() -> None:
    """A cantilever stiff in bending shears like a rod: (2 k - 1) c / (4 L), c² = k G A / (rho A)."""
    stiff = replace(BEAM, bending=5e5, shear=1e4, rotary=0.0)
    expected = closed_forms.rod_fixed_free(np.sqrt(1e4 / stiff.mass), stiff.length, 2)
    assert_allclose(closed_forms.timoshenko_cantilever(stiff, 2), expected, rtol=1e-2)  # bending adds (15 / 187 Hz)², halved


def test_a_driven_beam_is_its_rigid_body_at_low_frequency() -> None:
    m, L = BEAM.mass * BEAM.length, BEAM.length
    rigid = np.array([[m, m * L / 2], [m * L / 2, m * L**2 / 3]])
    assert_allclose(closed_forms.base_driven(BEAM, [1e-2])[0], rigid, rtol=1e-5)  # (f / f_1)² with f_1 near 5 Hz
    assert_allclose(closed_forms.rod_dynamic_mass(3.0, 5000.0, 1.0, [1.0]), 3.0, rtol=1e-6)


def test_a_driven_beam_resonates_at_its_frequencies_as_a_cantilever() -> None:
    damped = replace(STOCKY, bending=STOCKY.bending * (1 + 1e-6j), shear=STOCKY.shear * (1 + 1e-6j))
    resonances = closed_forms.timoshenko_cantilever(STOCKY, 2)
    beside, on = (np.abs(closed_forms.base_driven(damped, factor * resonances)[:, 0, 0]) for factor in (1.02, 1.0))
    assert np.all(on > 1e3 * beside)


def test_a_driven_beam_is_reciprocal_and_loses_energy() -> None:
    damped = replace(STOCKY, bending=STOCKY.bending * (1 + 0.02j))
    H = closed_forms.base_driven(damped, np.linspace(1, 60, 7))
    assert_allclose(H[:, 0, 1], H[:, 1, 0], rtol=1e-9)
    assert np.all(np.diagonal(H, axis1=1, axis2=2).imag < 0)  # force lags behind acceleration
