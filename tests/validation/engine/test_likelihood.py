"""The likelihood of any data set: inputs known or latent, rows that runs share or not."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from identification.self_calibration.solve import total
from validation.estimation.cost import cost_of
from validation.estimation.likelihood import floor_of, normals, observed, residual
from validation.estimation.problem import FITTED, Problem

FLOOR = 0.0015


@pytest.fixture(scope="module")
def away(lab):
    return {**lab.drawn(3), "mass": 0.02, "inertia": -0.03, "damping": 0.2, "frequency:one": 0.004}


@pytest.mark.parametrize("known", [False, True], ids=["latent", "known"])
@pytest.mark.parametrize("per_run", [False, True], ids=["shared", "per run"])
def test_the_gradient_is_that_of_the_cost_for_every_parameter(lab, away, known, per_run):
    problem = Problem((lab.toy({}, known=known, per_run=per_run, lines=20),))
    cost = cost_of(problem, problem.free(FITTED), FLOOR)
    x = cost.at(away)
    found, _, _ = cost.total(x)
    for k, parameter in enumerate(cost.free):
        step = 1e-3 / np.sqrt(found.matrix[k, k])
        up, down = (cost.total(x + sign * step * np.eye(len(x))[k])[0].cost for sign in (1, -1))
        scale = np.sqrt(found.matrix[k, k])
        # central difference in units of a standard deviation: what is left of it is of third order, and rounding of the cost
        assert_allclose(found.gradient[k] / scale, (up - down) / (2 * step) / scale, rtol=1e-5, atol=1e-5, err_msg=parameter.name)


def test_runs_may_share_rows_or_have_their_own(lab, away):
    toy = lab.toy({}, lines=20)
    own = replace(toy, per_run=True)
    problems = [cost_of(Problem((one,)), Problem((one,)).free(FITTED), FLOOR) for one in (toy, own)]
    shared, each = (cost.total(cost.at(away))[0] for cost in problems)
    assert_allclose(each.matrix, shared.matrix, rtol=1e-12)
    assert_allclose(each.gradient, shared.gradient, rtol=1e-12)


def test_eliminated_inputs_are_those_of_least_squares(lab, away):
    """An independent oracle: every latent input is an unknown of one large least-squares problem."""
    toy = lab.toy({}, lines=7)
    predicted = toy.at(away)
    seen = observed(toy.measured, np.arange(7))
    weight = seen.weight(FLOOR)
    for run, found in enumerate(residual(seen, predicted, FLOOR)):
        for line in range(7):
            A, y = weight[run, line][:, None] * predicted.rows[line], weight[run, line] * seen.values[run, line]
            u = np.linalg.lstsq(A, y, rcond=None)[0]
            assert_allclose(found[line], y - A @ u, atol=1e-9 * np.abs(y).max())


def test_no_latent_input_changes_the_residual_and_a_known_one_does(lab, away):
    for known in (False, True):
        toy = lab.toy({}, lines=10, known=known)
        predicted, seen = toy.at(away), observed(toy.measured, np.arange(10))
        more = (predicted.rows @ np.array([0.3, 1j]))[None]
        moved = replace(seen, values=seen.values + more)
        same = np.allclose(residual(moved, predicted, 0.0), residual(seen, predicted, 0.0), atol=1e-6)
        assert same is (not known)


def test_normal_equations_of_runs_add(lab, away):
    toy = lab.toy({}, lines=10)
    names = [p.name for p in toy.parameters]
    seen = observed(toy.measured, np.arange(10))
    whole = total(normals(seen, toy.at(away), names, FLOOR).values(), len(names))
    parts = [normals(observed(toy.on([run]).measured, np.arange(10)), toy.at(away), names, 0.0)[run] for run in toy.measured.runs]
    alone = total(normals(seen, toy.at(away), names, 0.0).values(), len(names))
    assert_allclose(total(parts, len(names)).matrix, alone.matrix, rtol=1e-12)
    assert whole.cost < alone.cost  # a floor forgives


def test_a_parameter_that_does_not_act_has_no_part(lab):
    toy = lab.toy({}, lines=10)
    found = normals(observed(toy.measured, np.arange(10)), toy.at({}), ["nobody", "mass"], FLOOR)["r1"]
    assert found.gradient[0] == 0.0
    assert not found.matrix[0].any()
    assert found.matrix[1, 1] > 0


def test_the_floor_follows_the_level_and_not_below_a_share_of_what_such_channels_read(lab):
    toy = lab.toy({}, lines=40, seed=None, motion=(1.0, 0.0))
    floor = floor_of(toy.measured)
    level = np.abs(toy.measured.values)
    forces = toy.measured.judged
    silent = np.array([name in ("f5", "f6", "f7", "f8") for name in toy.measured.channels])
    dead = replace(toy.measured, values=np.where(silent, 0.0, toy.measured.values))
    assert np.all(floor_of(dead)[..., silent] > 0)
    assert_allclose(floor_of(dead)[..., 0], floor[..., 0], rtol=1e-12)
    least = np.sqrt(floor**2 - level**2)[..., forces]  # lines stand farther apart than levels are smoothed
    assert_allclose(least, least[0, 0, 0], rtol=1e-6)
    assert least[0, 0, 0] > 0
    assert_allclose(floor_of(replace(toy.measured, values=3 * toy.measured.values)), 3 * floor, rtol=1e-12)
