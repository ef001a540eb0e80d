"""The prediction of an accelerance test: against the direct solution, against differences, and on data with a planted effect."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array
from geometry.sensors import Point
from identification.response_functions import ResponseFunctions
from identification.spectra import noise
from validation.diagnose.diagnosis import Candidate
from validation.diagnose.unexplained import described
from validation.effects.catalogue import Named
from validation.effects.stages import Matrices
from validation.estimation.evaluate import evaluate
from validation.estimation.fit import FLOOR, ended, fitted
from validation.estimation.likelihood import cost_of
from validation.estimation.problem import FITTED, Problem
from validation.model.model import Added, StructureTolerances
from validation.prediction import effects as prediction_effects
from validation.prediction import response_functions
from validation.prediction.response_functions import ResponseFunctionTest, measured

M, K, ETA = np.diag([2.0, 3.0, 1.5]), 1e4 * np.array([[5.0, -2.0, 0.0], [-2.0, 4.0, -1.0], [0.0, -1.0, 1.0]]), 0.01
"""A chain of three masses on springs, every spring with the same loss factor."""

F = 1.0 + 0.05 * np.arange(1200)
NAMES = ("a", "b", "c")


def chain(mass: Array = M) -> ComplexArray:
    """Accelerances (r, n, c) in physical coordinates, one line solved after the other; no code of the package."""
    lines = [-(w**2) * np.linalg.inv(K * (1 + 1j * ETA) - w**2 * mass) for w in 2 * np.pi * F]
    return np.array(lines).transpose(2, 0, 1)


def model(values: ComplexArray, **options: object) -> ResponseFunctionTest:
    """The chain on its own modes, and `values` as what was measured."""
    squares, shapes = np.linalg.eigh(np.sqrt(np.linalg.inv(M)) @ K @ np.sqrt(np.linalg.inv(M)))
    shapes = np.sqrt(np.linalg.inv(M)) @ shapes
    none, stiffness = np.zeros((3, 3)), np.diag(squares)
    made = Matrices(
        base=0,
        mass=np.eye(3),
        stiffness=stiffness,
        viscous=none,
        structural=ETA * stiffness,
        places={name: np.vstack([row, np.zeros((2, 3))]) for name, row in zip(NAMES, shapes, strict=True)},
        parts={"springs": stiffness},
    )
    known = StructureTolerances(modulus=0.02, damping=0.3)
    of = prediction_effects.nuisances("chain", made, np.sqrt(squares) / (2 * np.pi), {"springs": ETA}, known)
    data = measured("test", "chain", F, dict(zip(NAMES, values, strict=True)), NAMES, share=0.01)
    points = tuple(Point(place=name) for name in NAMES)
    return ResponseFunctionTest(measured=data, structure=of, responses=points, drives=points, **options)  # type: ignore[arg-type]


def added(identifier: str, value: float) -> Added:
    family, *targets = identifier.split(":")
    return Added(named=Named(family=family, targets=tuple(targets), values={"": value}))


EFFECTS = (added("point-mass:b", 0.2), added("structural-damping:springs", 0.005), added("modulus:springs", -0.03))


def test_the_prediction_is_the_direct_solution_and_an_effect_on_the_modes_that_on_the_masses():
    exact = chain()
    found = model(exact).at({}, derivatives=False).rows[..., 0]
    assert_allclose(found, exact, rtol=0, atol=1e-11 * np.abs(exact).max())  # rounding of two ways to one number
    heavier = chain(M + np.diag([0.0, 0.2, 0.0]))
    test = model(chain()).with_effects([added("point-mass:b", 0.2)])
    found = test.at({"point-mass:b": 0.2}, derivatives=False).rows[..., 0]
    assert_allclose(found, heavier, rtol=0, atol=1e-11 * np.abs(heavier).max())


def test_every_derivative_is_that_of_differences():
    assert_derivatives(model(chain()).with_effects(EFFECTS))


def test_neighbouring_modes_turn_into_each_other_by_what_is_not_known_of_their_stiffness():
    test, squares = model(chain()), (2 * np.pi * np.array([4.0, 4.2, 9.0])) ** 2
    K = np.diag(squares)
    nominal = replace(test.structure.nominal, stiffness=K, structural=ETA * K, parts={"springs": K})
    close = test.by(replace(test.structure, nominal=nominal, frequency=np.sqrt(squares) / (2 * np.pi)))
    (one,) = (each for each in close.parameters if each.name.startswith("mixing:"))
    assert one.name == "mixing:chain:1:2"
    assert one.tolerance == pytest.approx(np.sqrt(2) * StructureTolerances().frequency)
    mixed, _ = close.structure.at({"mixing:chain:1:2": 0.003})
    assert mixed.stiffness[0, 1] == mixed.stiffness[1, 0] == pytest.approx(0.003 * np.sqrt(squares[0] * squares[1]))
    assert_derivatives(close)


def test_gains_scale_channels_the_force_the_other_way_and_a_known_effect_is_no_parameter_and_acts():
    test = model(chain())
    plain = test.at({}, derivatives=False).rows
    found = test.at({"accelerometer-gain:b": 0.1, "force-gain:force": 0.25}, derivatives=False).rows
    assert_allclose(found, plain * (np.array([1.0, 1.1, 1.0]) / 1.25)[:, None], rtol=1e-13)
    alone = test.on(("c",))
    assert alone.measured.runs == ("c",)
    assert_allclose(alone.at({}, derivatives=False).rows[0], test.at({}, derivatives=False).rows[2], rtol=1e-13)
    test = model(chain()).with_effects([replace(added("modulus:springs", 0.1), fixed=True)])
    assert "modulus:springs" not in {one.name for one in test.parameters}
    free = model(chain()).at({"modulus:springs": np.log(1.1)}, derivatives=False).rows
    assert_allclose(test.at({}, derivatives=False).rows, free, rtol=1e-12)
    assert "modulus:springs" not in test.at({}).changes


@pytest.mark.parametrize("elsewhere", ["mounting-offset:x", "point-mass:mast-top", "modulus:mast", "accelerometer-gain:d"])
def test_an_effect_that_reaches_nothing_leaves_the_test_as_it_is(elsewhere):
    known = added("modulus:springs", 0.1)
    assert model(chain()).with_effects([added(elsewhere, 0.1), known]).effects == (known,)


def test_a_planted_mass_is_found_and_the_error_falls_on_drive_points_that_no_fit_has_seen():
    rng, truth = np.random.default_rng(3), 0.3
    clean = chain(M + np.diag([0.0, truth, 0.0]))
    noisy = clean * (1 + 0.01 * (rng.standard_normal((3, len(F), 3)) + 1j * rng.standard_normal((3, len(F), 3))) / np.sqrt(2))
    test = model(noisy)
    base = evaluate(Problem((test,)))
    right = evaluate(Problem((test.with_effects([added("point-mass:b", 0.0)]),)), parent=base)
    wrong = evaluate(Problem((test.with_effects([added("structural-damping:springs", 0.0)]),)), parent=base)
    assert right.held_out.percent < 1.2  # the noise that was put in is 1 %
    assert wrong.held_out.percent > 0.8 * base.held_out.percent
    at = [one.name for one in right.fitted.parameters].index("point-mass:b")
    assert right.fitted.offsets[at] == pytest.approx(truth, abs=3 * np.sqrt(right.fitted.covariance[at, at]))


def test_readings_that_differ_by_a_share_repeat_to_it_and_what_tells_no_scatter_is_refused():
    rng, share = np.random.default_rng(2), 0.02
    exact = chain()
    error = (rng.standard_normal(exact.shape) + 1j * rng.standard_normal(exact.shape)) / np.sqrt(2)
    assert noise.repeatability(exact * (1 + share * error)) == pytest.approx(share, rel=0.05)
    assert noise.repeatability(exact * [1.0, 1.08, 0.97] * (1 + share * error)) == pytest.approx(share, rel=0.05)  # gains
    within = np.full(
        exact.shape, 0.02 * np.median(np.abs(exact))
    )  # of most lines it is a few per cent, of some all that they read
    still = within * (rng.standard_normal(exact.shape) + 1j * rng.standard_normal(exact.shape)) / np.sqrt(2)
    assert noise.repeatability(exact + still) > 0.02
    assert noise.repeatability(exact + still, within) < 0.005
    assert noise.repeatability(exact * (1 + share * error) + still, within) == pytest.approx(share, rel=0.1)
    across = exact * np.where(np.eye(len(exact), dtype=bool)[:, None], 1.0, 0.01)
    across[0, :, 1] *= 50.0 * (1 + 1j * np.linspace(0, 3, exact.shape[1]))  # it was struck beside its point
    assert noise.repeatability(across[:2, :, :2]) == 0.0
    with pytest.raises(ValueError, match="two runs or more"):
        noise.repeatability(np.ones((1, 5, 1)))


def functions(values: ComplexArray, **options: object) -> ResponseFunctions:
    """The chain's readings as a test file has them."""
    given = {"source": "test.toml", "title": "test", "article": "chain", "band": (float(F[0]), float(F[-1]))}
    points = tuple(Point(place=name) for name in NAMES)
    return ResponseFunctions(frequency=F, values=values, responses=points, **{"drives": points, **given, **options})  # type: ignore[arg-type]


@pytest.mark.parametrize(("quantity", "power"), [("velocity", 1), ("displacement", 2)])
def test_velocity_and_displacement_are_the_acceleration_over_powers_of_i_omega(quantity: str, power: int) -> None:
    exact = chain() / (2j * np.pi * F[:, None]) ** power
    (test,) = response_functions.of(model(chain()).structure, functions(exact, quantity=quantity))
    found = test.at({}, derivatives=False).rows[..., 0]
    assert_allclose(found, exact, rtol=0, atol=1e-11 * np.abs(exact).max())


@pytest.mark.parametrize("scale", [3.7, -0.02])
def test_readings_without_calibration_give_their_scale_with_its_interval_and_every_derivative(scale: float) -> None:
    rng = np.random.default_rng(6)
    clean = scale * chain(M + np.diag([0.0, 0.3, 0.0]))
    noisy = clean * (1 + 0.01 * rng.standard_normal(clean.shape))
    (test,) = response_functions.of(model(chain()).structure, functions(noisy, scaled=False, share=0.01, decay_rate=0.0))
    heavier = test.with_effects([added("point-mass:b", 0.0)])
    assert_derivatives(heavier)
    found = evaluate(Problem((heavier,))).fitted
    names = [one.name for one in found.parameters]
    at = names.index("scale:test")
    assert found.parameters[at].value(found.offsets[at]) == pytest.approx(scale, rel=4 * np.sqrt(found.covariance[at, at]))
    assert found.offsets[names.index("point-mass:b")] == pytest.approx(0.3, abs=0.02)


def test_an_exponential_window_moves_the_axis_of_prediction_and_its_derivatives() -> None:
    rate = 2.0
    (test,) = response_functions.of(model(chain()).structure, functions(chain(), decay_rate=rate))
    s = 2j * np.pi * F + rate
    exact = np.array([one**2 * np.linalg.inv(K * (1 + 1j * ETA) + one**2 * M) for one in s]).transpose(2, 0, 1)
    assert_allclose(test.at({}, derivatives=False).rows[..., 0], exact, rtol=0, atol=1e-11 * np.abs(exact).max())
    assert_derivatives(test.with_effects(EFFECTS))


def test_gains_that_are_unknown_each_by_itself_take_no_shape_for_evidence() -> None:
    (test,) = response_functions.of(model(chain()).structure, functions(chain(), gain=np.inf))
    open_ones = [one.name for one in test.parameters if not np.isfinite(one.tolerance)]
    assert open_ones == [f"accelerometer-gain:{name}" for name in NAMES]
    assert_derivatives(test)
    assert test.with_effects([added("accelerometer-gain:a", 0.1)]).parameters == test.parameters  # no fault beside the unknown


def test_noise_is_that_of_the_coherence_where_it_is_known() -> None:
    coherence, values = np.full((3, len(F), 3), 0.8), chain()
    (test,) = response_functions.of(model(values).structure, functions(values, coherence=coherence, averages=20, share=0.0))
    assert_allclose(test.measured.noise, np.abs(values) * np.sqrt(0.2 / 16), rtol=0.05)  # but for the bias of few averages


@pytest.mark.parametrize("averages", [4, 12, 40])
def test_what_sound_data_come_to_over_a_noise_that_few_averages_tell_is_known(averages: int) -> None:
    """Four blows told a noise over which sound data came to a chi² of 1.08 a number, and a fault was sought for that."""
    rng, shape = np.random.default_rng(3), (averages, 9, len(F))
    noise = 0.1 * (rng.standard_normal(shape) + 1j * rng.standard_normal(shape)) / np.sqrt(2)
    made = chain().transpose(0, 2, 1).reshape(9, -1) + noise  # of as many blows of 1 N
    mean, left = made.mean(axis=0), np.mean(np.square(np.abs(made - made.mean(axis=0))), axis=0)
    coherence = np.square(np.abs(mean)) / (np.square(np.abs(mean)) + left)
    values, coherence = (one.reshape(3, 3, -1).transpose(0, 2, 1) for one in (mean, coherence))
    (test,) = response_functions.of(
        model(chain()).structure, functions(values, coherence=coherence, averages=averages, share=0.0)
    )
    found = np.mean(np.square(np.abs(values - chain()) / test.measured.noise))
    assert found == pytest.approx(1 + test.measured.noise_scatter**2, abs=0.03)


def test_what_readings_of_one_number_differ_by_holds_their_noise_already() -> None:
    """Noise of two per cent by coherence, and as much by reciprocity, was taken for three."""
    rng, exact, share = np.random.default_rng(5), chain(), 0.02
    noisy = exact * (1 + share * (rng.standard_normal(exact.shape) + 1j * rng.standard_normal(exact.shape)) / np.sqrt(2))
    coherence = np.full(exact.shape, 1 / (1 + 20 * share**2))
    (test,) = response_functions.of(model(exact).structure, functions(noisy, coherence=coherence, averages=20))
    assert_allclose(test.measured.noise, share * np.abs(noisy), rtol=0.25)


def test_places_that_the_structure_has_not_are_refused() -> None:
    with pytest.raises(BadInput, match="no such place"):
        response_functions.of(
            model(chain()).structure, functions(chain(), drives=tuple(Point(place=n) for n in ("a", "b", "attic")))
        )


def assert_derivatives(test: ResponseFunctionTest) -> None:
    at = {one.name: one.start + 0.1 * min(one.tolerance, 1.0) for one in test.parameters}
    lines = np.arange(0, len(F), 60)
    exact = test.at(at, lines)
    assert set(at) <= set(exact.changes)
    for name in at:
        step = 1e-5
        above, below = (test.at({**at, name: at[name] + side * step}, lines, derivatives=False).rows for side in (1, -1))
        change = exact.changes[name]
        difference = ((above - below) / (2 * step))[:, :, list(change.channels)]
        scale = np.abs(difference).max()
        assert scale > 0
        assert_allclose(change.rows, difference, rtol=0, atol=1e-5 * scale, err_msg=name)  # the step's third power


def test_solids_give_where_a_force_acts_on_a_point_of_them_by_what_their_mesh_leaves_unsure():
    test = model(chain())
    unsure = {"springs": np.diag([0.0, 0.0, 0.1]) @ test.structure.nominal.stiffness}
    of = replace(test.structure, nominal=replace(test.structure.nominal, unresolved=unsure))
    of = replace(of, frequency=of.frequency[:2])  # the third coordinate answers statically
    test = replace(test, structure=of)
    (own,) = (one for one in test.parameters if one.name == f"{response_functions.LOCAL}:b")
    assert own.tolerance == response_functions.POINT
    still, moved = (test.at({own.name: size}, derivatives=False).rows[1, ..., 0] for size in (0.0, 0.3))
    there = of.nominal.places
    stiffness = of.nominal.stiffness[2, 2]
    softer = [0.1 * there[name][0, 2] * there["b"][0, 2] / stiffness for name in NAMES]
    assert_allclose(moved - still, -((2 * np.pi * F[:, None]) ** 2) * 0.3 * np.array(softer), rtol=1e-6)
    every = np.arange(len(F))
    here = np.vstack([there["c"][:1], np.zeros((2, 3))])
    nothing = test.finite({own.name: 0.3}, every)(here)(np.array([1e-9, 0.0, 0.0]), np.zeros(3))
    assert_allclose(nothing[1, ..., 0], moved, rtol=0, atol=1e-6 * np.abs(moved).max())
    change = test.at({}).changes[own.name].rows[1, ..., 0]
    assert_allclose(change, (moved - still) / 0.3, rtol=1e-6)
    windowed = test.with_effects([added("exponential-window", 0.0)])
    (name,) = (one.name for one in windowed.parameters if one.name == response_functions.WINDOW)
    above, below = (windowed.at({own.name: 3.0, name: side}, derivatives=False).rows for side in (1e-3, -1e-3))
    slope = windowed.at({own.name: 3.0}).changes[name].rows
    assert_allclose(slope, (above - below) / 2e-3, rtol=0, atol=1e-4 * np.abs(slope).max())
    assert not any(one.name.startswith(response_functions.LOCAL) for one in model(chain()).parameters)


@pytest.mark.parametrize("spacing", [1.0, 0.1, 0.05])
def test_chi_squared_of_noise_alone_is_one_whatever_lines_tell_the_noise(spacing):
    rng, f = np.random.default_rng(3), spacing * np.arange(1, 20001)
    values = (rng.standard_normal((len(f), 4)) + 1j * rng.standard_normal((len(f), 4))) / np.sqrt(2)
    found = measured("test", "chain", f, {"a": values}, ("a", "b", "c", "d"))
    assert_allclose(np.mean(np.abs(found.values / found.noise) ** 2), 1.0, atol=0.025)


def test_one_channel_alone_hears_no_other_and_what_is_left_of_it_is_told() -> None:
    """It ended in "cannot reshape array of size 0"."""
    rng = np.random.default_rng(2)
    jagged = chain()[:, :, :1] * (1 + 0.05 * rng.standard_normal((len(NAMES), len(F), 1)))
    (test,) = response_functions.of(
        model(chain()).structure, replace(functions(chain()), values=jagged, responses=(Point(place="a"),))
    )
    problem = Problem((test,))
    cost = cost_of(problem, problem.free(FITTED), FLOOR)
    found = described(Candidate(effects=(), fit=fitted(ended(cost, {}, converged=False)), problem=problem))
    assert found.channels == ("a",)
