"""The likelihood of one data set: residuals, normal equations, common ways, and evidence."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from identification.self_calibration.solve import total
from validation.estimation import likelihood
from validation.estimation.fit import fit
from validation.estimation.likelihood import FEW, ObservedLines, cost_of, floor_of, normals, observed, residual, ways
from validation.estimation.problem import FITTED, PLAIN, Change, Conveyed, Predicted, Problem

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
    found, _ = cost.total(x)
    for k, parameter in enumerate(cost.free):
        step = 1e-3 / np.sqrt(found.matrix[k, k])
        up, down = (cost.total(x + sign * step * np.eye(len(x))[k])[0].cost for sign in (1, -1))
        scale = np.sqrt(found.matrix[k, k])
        # central difference in units of a standard deviation: what is left of it is of third order, and rounding of the cost
        assert_allclose(found.gradient[k] / scale, (up - down) / (2 * step) / scale, rtol=1e-5, atol=1e-5, err_msg=parameter.name)


@pytest.mark.parametrize("breaks", [True, False], ids=["fault of a factor", "any other"])
def test_a_fault_that_leaves_next_to_nothing_costs_as_a_power(lab, breaks):
    """Up to three plausible sizes as a normal deviate; beyond, where a factor falls to nothing, with its logarithm."""
    problem = Problem((lab.toy({}, lines=5),))
    (one, *_) = (one for one in problem.free(FITTED) if np.isfinite(one.tolerance))
    cost = cost_of(problem, (replace(one, kind="effect" if breaks else one.kind, logarithmic=True, nominal=1.0),), FLOOR)

    def price(u: float) -> float:
        left, _ = cost.knowledge(np.array([u * one.tolerance]))
        return 0.5 * float(left @ left)

    for u in (-40.0, -10.0, -3.0001, -2.9999, -1.0, 0.0, 2.0, 5.0):
        assert price(u) == pytest.approx(4.5 + 9 * np.log(abs(u) / 3) if breaks and abs(u) > 3 else u**2 / 2)
        left, rows = cost.knowledge(np.array([u * one.tolerance]))
        slope = (price(u + 1e-5) - price(u - 1e-5)) / 2e-5
        assert float(rows[:, 0] @ left) * one.tolerance == pytest.approx(slope, abs=1e-4)


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


def test_normal_equations_of_runs_add_and_a_parameter_that_does_not_act_has_no_part(lab, away):
    toy = lab.toy({}, lines=10)
    names = [p.name for p in toy.parameters]
    seen = observed(toy.measured, np.arange(10))
    whole = total(normals(seen, toy.at(away), names, FLOOR).values(), len(names))
    parts = [normals(observed(toy.on([run]).measured, np.arange(10)), toy.at(away), names, 0.0)[run] for run in toy.measured.runs]
    alone = total(normals(seen, toy.at(away), names, 0.0).values(), len(names))
    assert_allclose(total(parts, len(names)).matrix, alone.matrix, rtol=1e-12)
    assert whole.cost < alone.cost  # a floor forgives
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


LINES, CHANNELS, INPUTS, QUANTITIES, RUNS = 7, 9, 2, 3, 2
LOADED = (3, 4, 5, 6, 8)

Predict = Callable[..., Predicted]


@pytest.fixture
def drawn() -> Callable[..., np.ndarray]:
    rng = np.random.default_rng(1)
    return lambda *shape: rng.standard_normal(shape) + 1j * rng.standard_normal(shape)


@pytest.fixture
def predicted(drawn) -> Predict:
    through = drawn(LINES, len(LOADED), QUANTITIES)

    def made(common: int = 4, others: int = 2) -> Predicted:
        changes: dict[str, Change | Conveyed] = {}
        for k in range(common):
            changes[f"carried {k}"] = Conveyed(channels=LOADED, through=through, quantities=drawn(LINES, QUANTITIES, INPUTS))
        for k, channel in enumerate((0, 0, 3, 8)):
            changes[f"gain {k}"] = Change(channels=(channel,), rows=drawn(LINES, 1, INPUTS))
        for k in range(others):
            channels = (0, 2, 3) if k else LOADED
            changes[f"pose {k}"] = Change(channels=channels, rows=drawn(LINES, len(channels), INPUTS))
        return Predicted(rows=drawn(LINES, CHANNELS, INPUTS), changes=changes)

    return made


@pytest.fixture
def seen(drawn) -> Callable[[bool], ObservedLines]:
    def made(known: bool) -> ObservedLines:
        spread = np.abs(drawn(RUNS, LINES, CHANNELS))
        inputs = drawn(RUNS, LINES, INPUTS) if known else None
        values = drawn(RUNS, LINES, CHANNELS)
        return ObservedLines(runs=("x", "y"), values=values, noise=spread, floor=0 * spread, inputs=inputs)

    return made


def plainly(predicted: Predicted) -> Predicted:
    """The same, every parameter by rows of its own."""
    changes = {name: Change(channels=one.channels, rows=one.rows) for name, one in predicted.changes.items()}
    return Predicted(rows=predicted.rows, changes=changes)


@pytest.mark.parametrize("known", [False, True])
@pytest.mark.parametrize("others", [0, 2])
def test_what_goes_a_common_way_makes_the_same_normal_equations(predicted, seen, known, others):
    of, read = predicted(others=others), seen(known)
    names = ["nowhere", *sorted(of.changes)]  # one that does not act here, and kinds mixed
    assert ways(of.changes, names[1:], CHANNELS) is not None
    assert ways(plainly(of).changes, names[1:], CHANNELS) is None
    ours, plain = (likelihood.normals(read, one, names, 0.0) for one in (of, plainly(of)))
    for run in read.runs:
        assert_allclose(ours[run].matrix, plain[run].matrix, rtol=1e-9, atol=1e-9 * np.abs(plain[run].matrix).max())
        assert_allclose(ours[run].gradient, plain[run].gradient, rtol=1e-9, atol=1e-9 * np.abs(plain[run].gradient).max())
        assert ours[run].cost == pytest.approx(plain[run].cost, rel=1e-12)
        assert not ours[run].matrix[0].any()


def test_normal_equations_are_those_of_the_whitened_columns(predicted, seen):
    of, read = predicted(), seen(False)
    names = sorted(of.changes)
    for k, run in enumerate(read.runs):
        r, V = likelihood.whitened(read, of, names, 0.0, k)
        flat = V.reshape(-1, len(names))
        found = likelihood.normals(read, of, names, 0.0)[run]
        assert_allclose(found.matrix, (flat.conj().T @ flat).real, rtol=1e-9, atol=1e-9 * np.abs(found.matrix).max())
        assert_allclose(found.gradient, -(flat.conj().T @ r.ravel()).real, rtol=1e-9, atol=1e-9 * np.abs(found.gradient).max())


def test_many_with_ways_of_their_own_and_rows_that_runs_do_not_share_go_no_common_way(predicted, drawn):
    of = predicted(others=FEW + 1)
    assert ways(of.changes, sorted(of.changes), CHANNELS) is None
    of = predicted()
    changes = {**of.changes, "bent": Change(channels=(1,), rows=drawn(RUNS, LINES, 1, INPUTS))}
    assert ways(changes, sorted(changes), CHANNELS) is None
    assert ways(changes, sorted(of.changes), CHANNELS) is not None


def test_chi2_of_what_was_read_grows_with_its_noise_by_its_freedom_and_stays_below_it_by_what_nobody_measured(drawn):
    """Inputs that nobody measured are not there at all, or as large as they may be."""
    draws, read = 20_000, np.arange(CHANNELS) >= 2
    rows = np.tile(drawn(1, CHANNELS, INPUTS), (draws, 1, 1))
    rows[:, ~read] = np.eye(2, INPUTS)  # of two inputs a pick-up each, which reads nothing
    sd = np.abs(drawn(1, 1, CHANNELS)) * np.ones((1, draws, 1))
    noise, predicted = sd * drawn(1, draws, CHANNELS) / np.sqrt(2), Predicted(rows=rows)
    for share in (0.0, 1.0):
        values = noise * np.where(read, 1.0, share)
        of = ObservedLines(runs=("x",), values=values, noise=sd, floor=0 * sd, inputs=None, unmeasured=~read)
        count = likelihood.freedom(of, lambda: predicted, 0.0).sum() / draws
        chi2 = np.sum(np.square(np.abs(likelihood.residual(of, predicted, 0.0)[..., read]))) / draws
        if not share:
            assert chi2 == pytest.approx(count, rel=0.02)
        else:
            Q = np.linalg.qr(rows[0] / sd[0, 0, :, None])[0]
            assert chi2 == pytest.approx(2 * np.sum(1 - np.sum(np.abs(Q[read]) ** 2, axis=1)), rel=0.02)
            assert chi2 > 1.02 * count


def test_channels_that_hardly_tell_more_than_the_inputs_count_by_what_they_leave(drawn):
    """Three quiet channels that a table's motions take up, beside six noisy ones of what stands on it."""
    draws, below = 20_000, np.arange(CHANNELS) < 3
    predicted = Predicted(rows=np.tile(drawn(1, CHANNELS, INPUTS), (draws, 1, 1)))
    sd = np.where(below, 0.01, 1.0) * np.ones((1, draws, 1))
    used = np.where(below, 0.1, 1.0)  # of the variance that is allowed for: below most of it is a model's error
    values = np.sqrt(used / 2) * sd * drawn(1, draws, CHANNELS)
    of = ObservedLines(runs=("x",), values=values, noise=sd, floor=0 * sd, inputs=None)
    chi2 = np.sum(np.square(np.abs(likelihood.residual(of, predicted, 0.0)))) / draws
    count = likelihood.freedom(of, lambda: predicted, 0.0)
    assert count.sum() / draws == pytest.approx(2 * (CHANNELS - INPUTS), rel=1e-9)
    assert chi2 == pytest.approx(np.sum(count * used) / draws, rel=0.01)
    assert chi2 > 1.15 * np.average(used) * count.sum() / draws  # each channel alike would promise so much less


def linear(lab, truth, tolerances):
    """Everything is known but offsets of gains, in which a prediction with known inputs is linear."""
    effects = [lab.effect(name, tolerance) for name, tolerance in tolerances.items()]
    return lab.toy(truth, parameters=effects, acting=lab.LABORATORY, known=True, lines=8, runs=2)


def closed_form(toy, tolerances):
    """log of the normal density of all readings, y ~ N(A u, noise² + J S² J^T), real and imaginary parts."""
    names = list(tolerances)
    predicted, measured = toy.at({}), toy.measured
    J = np.zeros((*measured.values.shape, len(names)), dtype=complex)
    for k, name in enumerate(names):
        change = predicted.changes[name]
        J[:, :, change.channels, k] = (change.rows @ measured.inputs[..., None])[..., 0]
    y = measured.values - (predicted.rows @ measured.inputs[..., None])[..., 0]
    J = J.reshape(-1, len(names))
    y, J = np.concatenate([y.real.ravel(), y.imag.ravel()]), np.concatenate([J.real, J.imag])
    sd = np.concatenate([measured.noise.ravel()] * 2) / np.sqrt(2)
    S = np.array(list(tolerances.values()))
    C = np.diag(sd**2) + (J * S**2) @ J.T
    return -0.5 * y @ np.linalg.solve(C, y) - 0.5 * np.linalg.slogdet(C)[1] + np.sum(np.log(sd))


@pytest.mark.parametrize(
    "tolerances", [{"gain:f3": 0.05}, {"gain:f3": 0.05, "gain:a1": 0.01}, {"gain:f3": 0.002, "gain:f4": 1.0}]
)
def test_the_evidence_of_a_linear_model_is_that_of_the_normal_distribution(lab, tolerances):
    toy = linear(lab, {"gain:f3": 0.03}, tolerances)
    toy = replace(toy, parameters=tuple(p for p in toy.parameters if p.name in tolerances))
    found = fit(Problem((toy,)), PLAIN, floor=0.0)
    # the last step is taken unseen: 0.1 standard deviations at most are left of it
    assert_allclose(found.log_evidence, closed_form(toy, tolerances), atol=0.01)


def test_a_needed_effect_is_worth_it_and_a_useless_one_is_not(lab):
    truth = {**lab.drawn(2), "mass": 0.02, "offset": 0.3}
    effect, useless = lab.effect("offset", 1.0), lab.effect("appendage[m]", 0.5)
    without = lab.toy(truth, acting=(effect,))
    parent = fit(Problem((without,)), FITTED)
    right = fit(Problem((lab.toy(truth, parameters=(*lab.LABORATORY, effect)),)), FITTED, start=parent)
    data = lab.toy(truth, acting=(effect,)).measured
    assert_allclose(data.values, lab.toy(truth, parameters=(*lab.LABORATORY, effect)).measured.values)
    assert right.log_evidence - parent.log_evidence > 50
    both = replace(lab.toy(truth, parameters=(*lab.LABORATORY, effect, useless)), measured=data)
    more = fit(Problem((both,)), FITTED, start=right)
    assert more.cost <= right.cost
    assert -12 < more.log_evidence - right.log_evidence < 0


def test_a_parameter_of_which_the_data_say_nothing_costs_nothing(lab):
    parent = fit(Problem((lab.toy({}),)), FITTED)
    silent = replace(lab.toy({}), parameters=(*lab.toy({}).parameters, lab.effect("nobody", 3.0)))
    child = fit(Problem((silent,)), FITTED, start=parent)
    assert_allclose(child.log_evidence, parent.log_evidence, atol=0.01)
    assert child.by_name["nobody"] == 0.0


@pytest.mark.parametrize("known", [False, True], ids=["latent", "known"])
def test_noise_that_is_not_that_of_the_data_is_less_probable_both_ways(lab, known):
    """Where noise is an effect, the normalisation of the likelihood decides: too much of it is as wrong as too little."""
    toy = lab.toy({}, known=known)

    def noisier(factor):
        return replace(toy, twist=lambda said, _, lines: replace(said, noise=factor * toy.measured.noise[:, lines]))

    evidence = {factor: fit(Problem((noisier(factor),)), PLAIN, floor=0.0).log_evidence for factor in (0.5, 1.0, 2.0)}
    assert evidence[1.0] > evidence[0.5] + 100
    assert evidence[1.0] > evidence[2.0] + 100
    assert_allclose(evidence[1.0], fit(Problem((toy,)), PLAIN, floor=0.0).log_evidence, rtol=1e-12)
