"""The joint likelihood: gradients, bounds, poles that pay, and both bootstraps."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from identification.elastic.model import ElasticTerms
from identification.self_calibration import fit
from identification.self_calibration.likelihood import observed, residual
from identification.self_calibration.problem import assembled, normals
from identification.self_calibration.solve import SILENT, Normal, level_of_groups, minimise, total


@pytest.fixture(scope="module")
def problem(ordinary, lab):
    """Tare and elastic article, away from the minimum, few lines."""
    few = replace(ordinary, frequency=np.arange(4.0, 32.01, 0.5))
    made = assembled(few.evidence(terms=lab.MODES), few.settings())
    return replace(made, campaigns=tuple(replace(one, lines=one.lines[::4]) for one in made.campaigns))


@pytest.fixture(scope="module")
def away(problem):
    rng = np.random.default_rng(4)
    x = problem.layout.start.copy()
    chain = problem.layout.at("chain:0")
    x[chain] = 0.3 * rng.standard_normal(chain.stop - chain.start) * problem.campaigns[0].chain.tolerances
    return x


def test_no_base_motion_changes_the_residual(problem, away):
    part = problem.parts(0.0015)[0]
    rows = part.rows(problem.layout, away, changes=False)
    A = rows.a0 + rows.a1 @ rows.dynamic_mass
    rng = np.random.default_rng(0)
    more = rng.standard_normal((*part.observed.values.shape[:2], 6)) + 1j
    moved = replace(part.observed, values=part.observed.values + (A @ more[..., None])[..., 0])
    assert_allclose(residual(moved, rows), residual(part.observed, rows), atol=1e-9 * np.abs(part.observed.weight).max())


def cost(parts, layout, x):
    return sum(0.5 * np.sum(np.abs(residual(one.observed, one.rows(layout, x, changes=False))) ** 2) for one in parts)


def test_the_gradient_is_that_of_the_cost_for_every_kind_of_parameter(problem, away):
    parts = problem.parts(0.0015)
    found = total(normals(parts, problem.layout, away), len(away))
    scale = 1 / np.sqrt(np.diag(found.matrix))
    kinds = {}
    for k, owner in enumerate(problem.layout.owners):
        name = problem.layout.block(owner).names[k - problem.layout.at(owner).start]
        kinds.setdefault((owner, name.partition(":")[0].partition("[")[0]), k)
    assert len(kinds) > 25
    for what, k in kinds.items():
        step = 0.01 * scale[k] * np.eye(len(away))[k]
        up, down = (cost(parts, problem.layout, away + sign * step) for sign in (1, -1))
        slope = (up - down) / (2 * step[k])
        assert_allclose(
            found.gradient[k] * scale[k], slope * scale[k], atol=2e-3 * (1 + abs(slope * scale[k])), err_msg=str(what)
        )


def test_gradients_by_line_add_up_to_the_gradient(problem, away):
    parts = problem.parts(0.0015)
    whole = total(normals(parts, problem.layout, away), len(away)).gradient
    blocks = fit.bootstrap_scores(parts, problem.layout, away)
    added = np.sum([one.sum(axis=0) for one in blocks], axis=0)
    assert_allclose(added, whole, atol=1e-9 * np.abs(whole).max())


def test_near_a_point_the_cost_is_the_exact_one_there_and_to_second_order_beside_it(problem, away):
    """Whatever the structure does: a longer way in the elastic terms is off by what base motions and directions turn alone."""
    parts, layout = problem.parts(0.0015), problem.layout
    about = [part.near(layout, away, -1.0) for part in parts]
    exact, told = total(normals(parts, layout, away), len(away)), total([one.normal(away) for one in about], len(away))
    unit = np.sqrt(np.diag(exact.matrix))
    assert_allclose([told.cost, sum(one.cost(away) for one in about)], exact.cost, rtol=1e-12)
    assert_allclose(told.gradient / unit, exact.gradient / unit, atol=1e-9 * np.abs(exact.gradient / unit).max())
    assert_allclose(told.matrix / np.outer(unit, unit), exact.matrix / np.outer(unit, unit), atol=1e-9)
    step = 0.1 * np.random.default_rng(2).standard_normal(len(away)) / unit
    up, down = (total([one.normal(away + sign * step) for one in about], len(away)) for sign in (1, -1))
    assert_allclose(up.cost - down.cost, 2 * exact.gradient @ step, rtol=0.02)
    tiny = 1e-4 * step
    slope = sum(one.cost(away + step + tiny) - one.cost(away + step - tiny) for one in about) / 2
    assert_allclose(up.gradient @ tiny, slope, rtol=1e-4)


def test_what_was_told_near_a_point_is_kept_where_it_still_says_the_cost(problem, away):
    part, layout = problem.parts(0.0015)[1], problem.layout
    part.near(layout, away, -1.0)
    assert part.near(layout, away, 1e-6).known
    assert not part.near(layout, layout.start, 1e-6).known


def test_a_channel_that_reads_nothing_is_not_trusted_without_bound(exact, lab):
    """Spectra of noise zero: the weight of a silent channel is that of a floor on a share of what its kind reads."""
    read, floor = exact.spectra(lab.NOTHING), 0.0015
    values = read.values.copy()
    silent = [read.table.names.index(name) for name in ("cover-x1", "fmd-z1")]
    values[0, :, silent] = 0.0
    some = replace(read, values=values)
    weight = observed(some, range(len(read.table)), np.arange(len(read.frequency)), floor).weight
    kind = level_of_groups(some.values, np.array([one.quantity for one in some.table.channels]))
    assert_allclose(weight[0][:, silent] * floor * SILENT * kind[silent], np.sqrt(2), rtol=1e-12)
    assert np.all(weight[0][:, silent] < 1e3 * np.median(weight, axis=(0, 1))[silent])


@pytest.mark.parametrize(("repeated", "wider"), [(1, 1.0), (4, 2.0)])
def test_the_block_bootstrap_sees_residuals_that_repeat(repeated, wider):
    """A residual that stands at `repeated` lines in a row tells so much less: sqrt of that wider intervals."""
    rng = np.random.default_rng(5)
    lines = 800
    residuals = np.repeat(rng.standard_normal(lines // repeated), repeated)
    scores = -residuals.reshape(-1, 4).sum(axis=1)[:, None]  # a mean of lines, in blocks of four
    C = np.array([[1 / lines]])
    sd = fit.blocks(C, [scores], np.zeros((0, 1)), np.random.default_rng(8)).std()
    assert_allclose(sd / np.sqrt(C[0, 0]), wider, rtol=0.2)  # 200 blocks tell a deviation to 5 %


def test_the_block_bootstrap_agrees_with_the_covariance_where_lines_are_independent(ordinary):
    from identification.self_calibration.fit import calibrated

    found = calibrated(ordinary.evidence(), replace(ordinary.settings(modes=0), floor=1e-5))
    ratio = np.sqrt(np.diag(found.resampled) / np.diag(found.covariance))
    assert np.all((ratio > 0.75) & (ratio < 1.25))


@pytest.mark.parametrize("seed", range(8))
def test_the_gradient_is_nothing_inside_and_points_outwards_at_every_bound(seed: int) -> None:
    rng = np.random.default_rng(seed)
    J, wanted = rng.standard_normal((30, 6)), 2 * rng.standard_normal(6)
    low, high = np.full(6, -1.0), np.full(6, 0.5)

    def data(x):
        left = J @ (x + 0.1 * x**3 - wanted)
        slopes = J * (1 + 0.3 * x**2)
        return Normal(cost=0.5 * float(left @ left), gradient=slopes.T @ left, matrix=slopes.T @ slopes)

    def knowledge(x):
        return 0.1 * x, 0.1 * np.eye(6)

    found = minimise(data, np.zeros(6), knowledge, close=1e-6, bounds=(low, high))
    x = found.x
    gradient = data(x).gradient + 0.01 * x
    assert found.converged
    assert np.all((x >= low) & (x <= high))
    at_low, at_high = x < low + 1e-9, x > high - 1e-9
    assert np.any(at_low | at_high)
    assert np.all(gradient[at_low] > 0)
    assert np.all(gradient[at_high] < 0)
    assert np.abs(gradient[~(at_low | at_high)]).max(initial=0.0) < 1e-3


@pytest.mark.parametrize("seed", range(8))
def test_a_step_within_bounds_is_that_of_scipy_where_many_of_them_hold(seed: int) -> None:
    from scipy.optimize import lsq_linear

    rng = np.random.default_rng(seed)
    J = rng.standard_normal((90, 40)) * np.geomspace(1e-3, 1e3, 40)
    J += rng.standard_normal((90, 1)) * np.geomspace(1e-3, 1e3, 40)  # what one does, the others do as well
    wanted = rng.standard_normal(90)
    free = np.abs(np.linalg.lstsq(J, wanted, rcond=None)[0])
    low, high = -rng.uniform(0.1, 1.5, 40) * free, rng.uniform(0.1, 1.5, 40) * free

    def data(x):
        left = J @ x - wanted
        return Normal(cost=0.5 * float(left @ left), gradient=J.T @ left, matrix=J.T @ J)

    found = minimise(data, np.zeros(40), lambda x: (np.zeros(0), np.zeros((0, 40))), bounds=(low, high))
    best = lsq_linear(J, wanted, (low, high), method="bvls", tol=1e-14).x
    assert np.sum((best == low) | (best == high)) > 5
    assert_allclose(found.x / free, best / free, rtol=0, atol=1e-4)  # `minimise` damps by 1e-6 of the diagonal


def test_in_a_valley_refused_steps_are_known_by_their_cost_alone_and_the_way_is_the_same() -> None:
    asked: list[bytes] = []

    def data(x):
        asked.append(x.tobytes())
        left = np.array([10 * (x[1] - x[0] ** 2), 1 - x[0]])
        slopes = np.array([[-20 * x[0], 10.0], [-1.0, 0.0]])
        return Normal(cost=0.5 * float(left @ left), gradient=slopes.T @ left, matrix=slopes.T @ slopes)

    def knowledge(x):
        return 1e-6 * x, 1e-6 * np.eye(2)

    start = np.array([-1.2, 1.0])
    whole = minimise(data, start, knowledge, close=1e-6)
    every = len(asked)
    asked.clear()
    short = minimise(data, start, knowledge, close=1e-6, cost=lambda x: 50 * (x[1] - x[0] ** 2) ** 2 + 0.5 * (1 - x[0]) ** 2)
    assert_allclose(short.x, whole.x, rtol=1e-9)
    assert short.evaluations == whole.evaluations
    assert len(asked) < every


def test_a_minimum_along_a_valley_is_given_up_where_it_will_not_pay_and_only_there():
    """The cost falls ever more slowly, as x^-2: a cost that is reached in the end is not given up."""

    def data(x):
        left = np.array([1 / (1 + x[0]), 10.0])
        slope = -1 / (1 + x[0]) ** 2
        return Normal(cost=0.5 * float(left @ left), gradient=np.array([left[0] * slope]), matrix=np.array([[slope**2]]))

    def nothing(x):
        return np.zeros(0), np.zeros((0, 1))

    whole = minimise(data, np.zeros(1), nothing, close=1e-3)
    assert whole.normal.cost < 50.0001
    hopeless = minimise(data, np.zeros(1), nothing, close=1e-3, worth=49.0)
    assert not hopeless.converged
    assert hopeless.evaluations < 0.5 * whole.evaluations
    assert minimise(data, np.zeros(1), nothing, close=1e-3, worth=50.001).normal.cost == whole.normal.cost


FLOOR = 0.0015


def minimum(problem, start):
    parts = problem.parts(FLOOR)
    return minimise(lambda x: total(normals(parts, problem.layout, x), len(x)), start, problem.knowledge, close=0.3)


def size(problem) -> int:
    return sum(part.observed.size for part in problem.parts(FLOOR))


def frequencies(problem, x) -> np.ndarray:
    return np.sort(problem.campaigns[0].structure.terms(problem.layout, x).frequency)


@pytest.fixture(scope="module")
def elastic(ordinary, lab):
    """The joint problem of an article with two modes in the band, and its minimum."""
    laboratory = replace(ordinary, frequency=np.arange(4.0, 32.01, 0.25), rng=np.random.default_rng(7))
    problem = assembled(laboratory.evidence(terms=lab.MODES), laboratory.settings(modes=2))
    return problem, minimum(problem, problem.layout.start)


@pytest.fixture(scope="module")
def longer(elastic):
    """The same with a pole where nothing resonates, and its minimum."""
    problem, solution = elastic
    line = int(np.argmin(np.abs(problem.parts(FLOOR)[0].observed.frequency - 22.0)))
    found = [fit.with_one_more(problem, solution.x, k) for k in range(line, line + 8)]
    more = next(one for one in found if one is not None)
    return more[0], minimum(*more)


def test_a_pole_that_is_not_there_goes_and_those_that_are_stay(longer, lab):
    problem, solution = longer
    assert problem.modes == 3
    shorter, x = fit.pruned(problem, solution, size(problem))
    assert_allclose(frequencies(shorter, x), lab.MODES.frequency, rtol=1e-3)
    assert minimum(shorter, x).converged


def test_nothing_goes_above_the_limit_or_where_every_pole_pays(longer, elastic):
    for (problem, solution), below, modes in ((longer, {"below": 20.0}, 3), (elastic, {}, 2)):
        left = fit.pruned(problem, solution, size(problem), **below)
        assert left is None or left[0].modes == modes


def test_a_pole_beyond_the_band_is_found_where_the_residual_mass_does_not_do(ordinary, lab):
    """Without it the joint fit is off by more than its intervals; the pole pays, and one more does not."""
    beyond = ElasticTerms(
        frequency=np.array([11.5, 38.0]),
        damping=np.diag([0.6, 2.0]),
        participation=np.array([[3.5, 0.2, 0.0, 0.1, 2.0, 0.0], [0.1, 4.0, 0.1, -1.6, 0.0, 0.1]]),
        residual=lab.MODES.residual,
    )
    laboratory = replace(ordinary, frequency=np.arange(4.0, 32.01, 0.25), rng=np.random.default_rng(8))
    problem = assembled(laboratory.evidence(terms=beyond), laboratory.settings(modes=1))
    solution = minimum(problem, problem.layout.start)
    assert problem.modes_beyond(solution.x) == 0
    longer = fit.with_one_beyond(problem, solution.x)
    more = minimum(*longer)
    assert 2 * (solution.normal.cost - more.normal.cost) > 10 * fit.pole_penalty(size(problem))
    assert longer[0].modes_beyond(more.x) == 1
    assert_allclose(frequencies(longer[0], more.x)[-1], 38.0, rtol=0.05)
