"""A laboratory without errors measures exactly what stands on its table."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.base_excitation.rig import dynamic_mass
from geometry.frames import rigid_transformation_6
from geometry.inertia import Inertia
from validation.virtual_test.plan import PlantedEffect, exact
from validation.virtual_test.simulate import laboratory, simulate

LINES = np.arange(4.0, 32.01, 1.0)


def matrix(truth: dict[str, object]) -> np.ndarray:
    """The 6x6 mass matrix of an inertia in the truth, about the origin of its frame."""
    return Inertia(parameters=np.array(list(truth["parameters"].values()))).mass_matrix


def difference(found: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """(n,) largest difference at each line, as a share of the largest entry there."""
    return np.abs(found - expected).max(axis=(1, 2)) / np.abs(expected).max(axis=(1, 2))


def test_a_rigid_article_measures_its_own_mass_matrix_to_rounding(exact_test, measured):
    """The time records of a rigid article are exact: all channels pass one filter, and ratios of them are what they were."""
    expected = matrix(exact_test.truth["fmd"]) + matrix(exact_test.truth["article"]["about_F"])
    found = measured(exact_test.campaign, LINES).matrix
    assert_allclose(difference(found, np.broadcast_to(expected, found.shape)), 0, atol=1e-12)


def test_an_elastic_article_measures_its_dynamic_mass_and_the_error_falls_with_the_ringing_that_is_cut_off(
    elastic_plan, measured
):
    worst = []
    for ringing in (1e-2, 1e-4):
        plan = exact(elastic_plan(ringing=ringing))
        expected = dynamic_mass(replace(laboratory(plan).rig, cells=()), LINES).matrix
        worst.append(difference(measured(simulate(plan).campaign, LINES).matrix, expected).max())
    assert worst[1] < 1e-5
    assert 20 < worst[0] / worst[1] < 500  # in proportion: a hundredth of the ringing, a hundredth of the error


def test_the_truth_states_the_inertia_and_the_dynamic_mass_of_what_was_driven(ordinary):
    truth = ordinary("fmd+clumod-1").truth
    own, about_f = (matrix(truth["article"][key]) for key in ("own_frame", "about_F"))
    T = rigid_transformation_6(truth["mounting_origin_m"])
    assert_allclose(about_f, T.T @ own @ T, rtol=0, atol=1e-12 * own.max())
    first = np.array(truth["dynamic_mass"]["re"][0])
    rigid = matrix(truth["fmd"]) + about_f
    assert 0 < np.abs(first - rigid).max() / rigid.max() < 0.3  # at 4 Hz, where elasticity has just begun
    assert_allclose(first, first.T, rtol=0, atol=1e-9 * rigid.max())


@pytest.mark.parametrize("half", ["accelerometer_tilt", "gravity"])
def test_one_half_of_gravity_alone_adds_the_tilt_terms_of_the_printed_signs(half, rigid_plan, exact_test, measured):
    """f_x/beta += m g/w², f_y/alpha -= m g/w², t_alpha/alpha and t_beta/beta += m g z/w² for kinematic accelerations, and the
    opposite where the structure does not feel gravity while the accelerometers do."""
    off = PlantedEffect(id=half, chain=lambda chain: replace(chain, **{half: 0.0}))
    M = measured(exact_test.campaign, LINES).matrix.real[0]
    found = measured(simulate(exact(rigid_plan(effects=(off,)))).campaign, LINES).matrix
    E = np.zeros((6, 6))
    E[0, 4], E[1, 3] = 1.0, -1.0  # motion x for a tilt beta, y for a tilt alpha
    sign, g = {"accelerometer_tilt": 1.0, "gravity": -1.0}[half], 9.81
    expected = M @ np.linalg.inv(np.eye(6) - sign * (g / (2 * np.pi * LINES[:, None, None]) ** 2) * E)
    assert_allclose(difference(found, expected), 0, atol=1e-5)
    added, m, mz = (found - M)[0].real * (2 * np.pi * LINES[0]) ** 2 / g * sign, M[0, 0], M[0, 4]
    assert_allclose([added[0, 4], added[1, 3], added[3, 3], added[4, 4]], [m, -m, mz, mz], rtol=1e-4)


def test_sweeps_of_several_axes_at_once_measure_the_same(rigid_plan, exact_test, measured):
    expected = measured(exact_test.campaign, LINES).matrix
    for pattern, runs in (("multi", 6), ("diagonal", 12), ("twice", 12)):
        campaign = simulate(exact(rigid_plan(pattern=pattern, octaves_per_minute=120.0))).campaign
        assert len(campaign.runs) == runs
        assert_allclose(difference(measured(campaign, LINES).matrix, expected), 0, atol=1e-12)
