"""Pinocchio's order and signs, and log-Cholesky coordinates."""

import numpy as np
import pinocchio
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from geometry import routes
from geometry.articles import built_in
from geometry.errors import BadInput
from geometry.inertia import Inertia

coordinates = st.lists(st.floats(-1, 1), min_size=10, max_size=10)


def in_pinocchio(inertia: Inertia) -> pinocchio.Inertia:
    return pinocchio.Inertia(inertia.mass, inertia.cog.copy(), inertia.tensor_cog)


@settings(max_examples=50, deadline=None)
@given(coordinates)
def test_any_body_goes_to_pinocchio_and_back(values: list[float]) -> None:
    inertia = routes.from_log_cholesky(np.array(values))
    back = routes.from_pinocchio(in_pinocchio(inertia))
    assert_allclose(back.parameters, inertia.parameters, rtol=1e-9, atol=1e-9 * np.abs(inertia.parameters).max())


@settings(max_examples=50, deadline=None)
@given(coordinates)
def test_log_cholesky_coordinates_go_there_and_back(values: list[float]) -> None:
    assert_allclose(routes.log_cholesky(routes.from_log_cholesky(np.array(values))), values, atol=1e-9)


def test_regressor_times_parameters_is_the_wrench() -> None:
    """The ten parameters in Pinocchio's order give the wrench of its recursive Newton-Euler equations: order and signs hold."""
    rng = np.random.default_rng(1)
    inertia = routes.from_log_cholesky(rng.normal(size=10) / 2)
    body = in_pinocchio(inertia)
    velocity, acceleration = pinocchio.Motion(rng.normal(size=6)), pinocchio.Motion(rng.normal(size=6))
    regressor = pinocchio.bodyRegressor(velocity, acceleration)
    in_their_order = np.empty(10)
    in_their_order[routes.FROM_PINOCCHIO] = inertia.parameters
    wrench = body * acceleration + body.vxiv(velocity)
    assert_allclose(regressor @ in_their_order, wrench.vector, rtol=1e-12, atol=1e-12)


def test_mass_matrix_of_eq_1_is_pinocchios() -> None:
    inertia = routes.inertia(built_in("fmd+clumod-1"))
    assert_allclose(inertia.mass_matrix, in_pinocchio(inertia).matrix(), rtol=1e-12, atol=1e-12)


def test_ideal_bodies_have_no_log_cholesky_coordinates() -> None:
    rod = Inertia.from_cog(1.0, [0, 0, 0], np.diag([1.0, 1.0, 0.0]))
    with pytest.raises(BadInput, match="body with volume"):
        routes.log_cholesky(rod)
