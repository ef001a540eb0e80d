"""Fits: where they begin, which way they go, and where they end."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput, CheckFailed
from identification.self_calibration.solve import Normal, Solution, minimise
from validation.estimation import fit as fit_module
from validation.estimation.fit import FINE, FLOOR, PLAIN_FLOOR, STRIDE, annealed, child, direct, fit, parents_point, start
from validation.estimation.likelihood import cost_of
from validation.estimation.problem import (
    DECLARED,
    EFFECT,
    FITTED,
    NOMINAL,
    PLAIN,
    Change,
    Fit,
    Measured,
    Parameter,
    Predicted,
    Problem,
)

TRUTH = {"mass": 0.06, "inertia": -0.04, "damping": 0.3, "frequency:one": 0.02}


def sd(found: Fit, name: str) -> float:
    k = [p.name for p in found.parameters].index(name)
    return float(np.sqrt(found.covariance[k, k]))


@pytest.mark.parametrize("known", [False, True], ids=["latent", "known"])
def test_without_noise_the_truth_is_found_exactly(lab, known):
    """Priors pull by their share of what is known: next to nothing against data without noise."""
    toy = lab.toy(TRUTH, seed=None, known=known)
    found = fit(Problem((toy,)), PLAIN, floor=1e-6)
    for name, value in TRUTH.items():
        assert_allclose(found.by_name[name], value, atol=2e-6, err_msg=name)


@pytest.mark.parametrize("known", [pytest.param(False, id="latent"), pytest.param(True, id="known", marks=pytest.mark.proof)])
def test_intervals_cover_the_truth(lab, known):
    """Of 90 % intervals of 18 parameters in 25 laboratories drawn from what is known beforehand, nine in ten hold the truth."""
    inside, surprise = [], []
    for seed in range(25):
        rng = np.random.default_rng(seed)
        truth = lab.drawn(seed) | {"mass": 0.05 * rng.standard_normal(), "inertia": 0.05 * rng.standard_normal()}
        truth |= {"damping": 0.35 * rng.standard_normal(), "frequency:one": 0.02 * rng.standard_normal()}
        found = fit(Problem((lab.toy(truth, seed=seed, lines=24, known=known),)), FITTED, floor=0.0)
        assert found.converged
        inside += [abs(found.by_name[name] - value) < 1.645 * sd(found, name) for name, value in truth.items()]
        surprise.append(found.chi2 / found.degrees_of_freedom)
    assert 0.85 < np.mean(inside) < 0.95  # 425 of them, correlated within a laboratory: 1.5 % is one standard error
    assert_allclose(np.mean(surprise), 1.0, atol=0.02)


def test_nothing_free_is_the_model_as_it_stands(lab):
    toy = lab.toy(TRUTH, parameters=(*lab.LABORATORY, lab.effect("offset", 1.0, start=0.2)))
    found = fit(Problem((toy,)), NOMINAL)
    cost = cost_of(Problem((toy,)), (), 0.01)
    assert found.parameters == ()
    assert_allclose(found.chi2, 2 * cost.data(np.zeros(0)).cost, rtol=1e-12)
    assert cost.offsets(np.zeros(0))["offset"] == 0.2


def test_few_lines_over_a_coarser_floor_cost_less_wherever_the_parameters_stand(lab):
    """By which a fit that cannot win is known before it is dear."""
    problem, rng = Problem((lab.toy(TRUTH),)), np.random.default_rng(4)
    free = problem.free(FITTED)
    for _ in range(20):
        x = rng.standard_normal(len(free)) * [one.tolerance for one in free]
        costs = [
            cost_of(of, free, floor).total(x)[0].cost
            for of, floor in ((problem.sparser(STRIDE), FINE[-1]), (problem.sparser(STRIDE), FLOOR), (problem, FLOOR))
        ]
        assert costs == sorted(costs)


def test_a_way_that_cannot_come_below_what_it_is_worth_is_given_up_and_another_ends_where_it_did(lab, monkeypatch):
    evaluations = []

    def counted(*args, **more):
        found = minimise(*args, **more)
        evaluations[-1] += found.evaluations
        return found

    monkeypatch.setattr(fit_module, "minimise", counted)
    problem = Problem((lab.toy({**TRUTH, "offset": 20.0}, acting=(lab.effect("offset", 1.0),)),))

    def ended(worth):
        evaluations.append(0)
        cost = replace(cost_of(problem, problem.free(FITTED), FLOOR), worth=worth)
        return annealed(cost, {}, lambda share: None)

    whole = ended(np.inf)
    assert whole.converged
    assert_allclose(ended(whole.whole.cost + 0.1).whole.cost, whole.whole.cost, rtol=1e-12)
    hopeless = ended(0.1 * whole.whole.cost)
    assert not hopeless.converged
    assert evaluations[2] < 0.7 * evaluations[1] == 0.7 * evaluations[0]


def test_a_descent_begins_again_only_while_that_may_bring_it_below_what_it_is_worth(lab, monkeypatch):
    """Gains of 40 and 30 leave 830: four more of 30 do not come below 700, and do below 720."""
    begun = []
    problem = Problem((lab.toy(TRUTH),))

    def descent(cost, offsets, **more):
        begun.append(min(len(begun), 2))
        normal = Normal(cost=(900.0, 860.0, 830.0)[begun[-1]], gradient=np.zeros(len(cost.free)), matrix=np.eye(len(cost.free)))
        at = cost.at(offsets)
        return Solution(x=at, seen=at, normal=normal, data=normal, converged=False, decrement=20.0, evaluations=1)

    monkeypatch.setattr(fit_module, "descent", descent)
    for worth, times in ((700.0, 3), (720.0, 4)):
        begun.clear()
        direct(replace(cost_of(problem, problem.free(FITTED), FLOOR), worth=worth), {}, lambda share: None)
        assert len(begun) == times


@pytest.mark.parametrize(("off", "times"), [(0.02, 6), (0.4, 0)])
def test_what_contradicts_the_data_even_over_the_coarsest_floor_begins_no_descent_again(lab, monkeypatch, off, times):
    """Where a bearing had a twelfth of its stiffness six beginnings led nowhere."""
    asked = []
    problem = Problem((lab.toy({**TRUTH, "frequency:one": off}),))
    monkeypatch.setattr(fit_module, "direct", lambda cost, offsets, progress, *, most, again: asked.append(again))
    still = tuple(one for one in problem.free(FITTED) if one.name != "frequency:one")
    annealed(cost_of(problem, still, FLOOR), {}, lambda share: None)
    assert asked == [times]


def test_declared_parameters_of_a_plain_fit_stop_at_their_bounds_and_the_others_make_up_for_it(lab):
    truth = {**TRUTH, "frequency:one": 0.08, "damping": 0.9}
    problem = Problem((lab.toy(truth, seed=None),))
    found = fit(problem, PLAIN)
    assert found.by_name["frequency:one"] == 0.05
    assert sd(found, "frequency:one") == 0.0
    assert abs(found.by_name["damping"]) <= 0.875
    fixed = tuple(replace(p, tolerance=0.0, start=0.05) if p.name == "frequency:one" else p for p in problem.parameters)
    again = fit(Problem((replace(problem.predictions[0], parameters=fixed),)), PLAIN)
    assert_allclose(found.by_name["mass"], again.by_name["mass"], atol=0.1 * sd(found, "mass"))
    free = fit(problem, FITTED)
    assert_allclose(free.by_name["frequency:one"], 0.08, atol=1e-3)


def test_what_is_known_of_a_parameter_at_its_bound_counts_and_it_is_let_go_when_the_data_pull_it_back(lab):
    problem = Problem((lab.toy({**TRUTH, "frequency:one": 0.08}, seed=None),))
    found = fit(problem, PLAIN)
    assert found.by_name["frequency:one"] == 0.05
    everything = cost_of(problem, found.parameters, 0.01)
    assert_allclose(found.cost, everything.total(found.offsets)[0].cost, rtol=1e-12)
    problem = Problem((lab.toy(TRUTH, seed=None),))
    cost = cost_of(problem, problem.free(PLAIN), 0.01, plain=True)
    end = direct(cost, {"frequency:one": 0.05}, lambda share: None)
    assert_allclose(end.offsets["frequency:one"], 0.02, atol=1e-3)
    assert end.cost.held == ()


@pytest.mark.parametrize("kinds", [PLAIN, FITTED], ids=["plain", "fitted"])
@pytest.mark.parametrize("child", [False, True], ids=["baseline", "child"])
def test_an_effect_ends_at_the_bound_of_what_its_family_allows_and_the_others_make_up_for_it(lab, kinds, child):
    effect = lab.effect("offset", 1.0, low=0.0, high=2.0)
    truth = {**TRUTH, "offset": -0.3}
    without = Problem((lab.toy(truth, acting=(effect,)),))
    problem = Problem((lab.toy(truth, acting=(effect,), parameters=(*lab.LABORATORY, effect)),))
    parent = fit(without, kinds)
    found = fit(problem, kinds, start=parent if child else None)
    assert found.by_name["offset"] == 0.0
    assert sd(found, "offset") == 0.0
    assert_allclose(found.cost, parent.cost, atol=1.0)
    upper = Problem((replace(problem.predictions[0], parameters=(*lab.LABORATORY, replace(effect, low=-1.0, high=-0.5))),))
    assert fit(upper, kinds, start={"offset": -0.7}).by_name["offset"] == -0.5


def test_a_plain_fit_at_bounds_is_as_cheap_as_any_feasible_beginning_leads_to(lab):
    """Declared parameters far beyond what a plain fit allows: the way without bounds leads elsewhere."""
    truth = {"mass": 0.1, "inertia": -0.1, "damping": 1.4, "frequency:one": 0.3}
    problem = Problem((lab.toy(truth, seed=None),))
    found = fit(problem, PLAIN)
    rng = np.random.default_rng(3)
    for _ in range(6):
        start = {"frequency:one": rng.uniform(-0.05, 0.05), "damping": rng.uniform(-0.8, 0.8), "mass": rng.uniform(-0.2, 0.2)}
        cost = cost_of(problem, problem.free(PLAIN), PLAIN_FLOOR, plain=True)
        end = direct(cost, start, lambda share: None)
        assert found.cost < end.whole.cost + 1.0


def test_without_bounds_a_plain_fit_goes_no_farther_than_a_trial_before_it_is_brought_back(lab, monkeypatch):
    """Such a way may follow a valley without an end, of which nothing is left but where to begin within the bounds."""
    problem, ways, descend = Problem((lab.toy({"damping": 1.4, "frequency:one": 0.3}, seed=None),)), [], fit_module.descent

    def counted(cost, offsets, **options):
        ways.append((any(one.kind == DECLARED and np.isfinite(one.within) for one in cost.free), options["most"]))
        return descend(cost, offsets, **options)

    monkeypatch.setattr(fit_module, "descent", counted)
    fit(problem, PLAIN)
    without = [most for bounded, most in ways if not bounded]
    assert 0 < len(without) <= len(fit_module.COARSE) + len(fit_module.FINE) + 1
    assert max(without) <= fit_module.TRIAL


def test_tolerances_of_the_measurement_are_released_when_the_rest_is_near(lab):
    asked = []
    toy = replace(lab.toy({**lab.drawn(1), **TRUTH}), twist=lambda said, offsets, _: asked.append(dict(offsets)) or said)
    found = fit(Problem((toy,)), FITTED)
    released = next(one for one in asked if any(one[p.name] for p in lab.LABORATORY if p.kind == "sensor"))
    for name in TRUTH:
        assert_allclose(released[name], found.by_name[name], atol=0.01, err_msg=name)


@pytest.mark.parametrize("kinds", [PLAIN, FITTED], ids=["plain", "fitted"])
def test_a_child_far_from_its_parent_is_found_by_the_annealed_floor(lab, kinds):
    """A resonance five of its widths away: straight from the parent the way ends elsewhere."""
    effects = (lab.effect("appendage[m]", 0.3, start=0.1), lab.effect("appendage[f]", 0.5, nominal=20.0, logarithmic=True))
    truth = {"appendage[m]": 0.5, "appendage[f]": 0.1, "mass": 0.01}
    parent = fit(Problem((lab.toy(truth, acting=effects),)), kinds)
    problem = Problem((lab.toy(truth, parameters=(*lab.LABORATORY, *effects)),))
    child = fit(problem, kinds, start=parent)
    assert_allclose(child.by_name["appendage[f]"], 0.1, atol=1e-4)
    cost = cost_of(problem, problem.free(kinds), 0.01)
    straight = direct(cost, parents_point(cost.free, parent), lambda share: None)
    assert abs(straight.offsets["appendage[f]"] - 0.1) > 0.05


@pytest.mark.parametrize("sound", [True, False])
def test_a_baseline_that_chance_explains_ends_where_the_annealed_way_does_but_sooner(lab, sound):
    asked = []
    truth = lab.drawn(1) | {"mass": 0.01, "damping": 0.2} | ({} if sound else {"frequency:one": 0.09})
    toy = replace(lab.toy(truth, seed=1), twist=lambda said, *_: asked.append(1) or said)
    found, count = fit(Problem((toy,)), FITTED), len(asked)
    assert found.sound is sound
    cost = cost_of(Problem((toy,)), found.parameters, FLOOR)
    long = annealed(cost, {}, lambda share: None, everywhere=True)
    for name, x in long.offsets.items():
        assert abs(found.by_name[name] - x) < 0.01 * sd(found, name)
    assert (count < len(asked) - count) is sound


def test_a_child_whose_own_start_breaks_down_is_found_from_its_parent(lab):
    without, having = with_offset(lab, {**TRUTH, "offset": 0.3}, start=2.0)
    fragile = replace(having, twist=lab.breaking(lambda offsets: offsets.get("offset", 0.0) > 1.0))
    child = fit(Problem((fragile,)), PLAIN, start=fit(Problem((without,)), PLAIN))
    assert_allclose(child.by_name["offset"], 0.3, atol=0.01)


def test_what_was_fitted_is_priced_in_squares_of_tolerances_which_a_plain_fit_does_not_touch(lab):
    found = fit(Problem((lab.toy(TRUTH),)), FITTED)
    priced = [p for p in found.parameters if p.kind in ("sensor", "declared")]
    assert found.tolerances == len(priced) == 15
    assert_allclose(found.tolerance_z2, sum((found.by_name[p.name] / p.tolerance) ** 2 for p in priced), rtol=1e-12)
    found = fit(Problem((lab.toy(TRUTH),)), PLAIN)
    assert {p.kind for p in found.parameters} == {"identified", "declared"}
    assert found.tolerances == 2


def test_a_baseline_that_does_not_converge_or_breaks_down_is_refused_with_the_reason(lab):
    def wrong(said, *_):
        """Its derivatives have the wrong sign."""
        return replace(said, changes={name: replace(one, rows=-one.rows) for name, one in said.changes.items()})

    with pytest.raises(CheckFailed, match=r"4 parameters did not converge.*mass|4 parameters did not converge.*inertia"):
        fit(Problem((replace(lab.toy(TRUTH), twist=wrong),)), PLAIN).required()
    with pytest.raises(CheckFailed, match="breaks down where its fit begins: a stiffness turned negative"):
        fit(Problem((replace(lab.toy(TRUTH), twist=lab.breaking(lambda offsets: True)),)), PLAIN)


def with_offset(lab, truth, **more):
    effect = lab.effect("offset", 1.0, **more)
    return lab.toy(truth, acting=(effect,)), lab.toy(truth, parameters=(*lab.LABORATORY, effect))


@pytest.mark.parametrize("kinds", [PLAIN, FITTED], ids=["plain", "fitted"])
@pytest.mark.parametrize("size", [0.0, 0.5])
def test_a_child_never_costs_more_than_its_parent(lab, kinds, size):
    without, having = with_offset(lab, {**TRUTH, "offset": size}, start=0.1)
    parent = fit(Problem((without,)), kinds)
    child = fit(Problem((having,)), kinds, start=parent)
    assert child.cost <= parent.cost
    assert_allclose(child.by_name["offset"], size, atol=max(3 * sd(child, "offset"), 0.01))
    assert (parent.cost - child.cost > 100) is (size > 0)


def test_a_child_that_finds_nothing_keeps_its_parents_point_and_is_converged_there(lab):
    without, having = with_offset(lab, {**TRUTH, "offset": 0.3})
    parent = fit(Problem((without,)), PLAIN)
    broken = replace(having, twist=lab.breaking(lambda offsets: offsets.get("offset", 0.0)))
    child = fit(Problem((broken,)), PLAIN, start=parent)
    assert not child.converged
    assert {**child.by_name, "offset": 0.0} == {**parent.by_name, "offset": 0.0}
    assert_allclose(child.cost, parent.cost, rtol=1e-12)
    without, having = with_offset(lab, TRUTH)
    parent = fit(Problem((without,)), PLAIN)
    assert fit(Problem((having,)), PLAIN, start=parent).converged


def test_where_a_parent_ended_may_break_down_of_a_child_over_other_coordinates(lab):
    """With a node of a barrel among them its stiffness had no square root where the fit without it had ended: a traceback."""
    without, having = with_offset(lab, {**TRUTH, "offset": 0.3})
    parent = replace(fit(Problem((without,)), PLAIN), cost=0.0)  # so that where it ended is asked for
    at_null = Problem((replace(having, twist=lab.breaking(lambda offsets: not offsets.get("offset", 0.0))),))
    found = child(at_null, PLAIN, parent, {"offset": 0.2})
    assert_allclose(found.by_name["offset"], 0.3, atol=0.01)
    with pytest.raises(CheckFailed, match="breaks down where its fit begins: a stiffness turned negative"):
        child(Problem((replace(having, twist=lab.breaking(lambda offsets: True)),)), PLAIN, parent, {"offset": 0.2})


@dataclass(frozen=True, eq=False, kw_only=True)
class Valley:
    """One channel reads e^modulus / (1 + clamp): a bent valley, as narrow as the noise."""

    measured: Measured
    parameters: tuple[Parameter, ...]

    def at(self, offsets, lines=None, *, derivatives=True):
        n = len(self.measured.frequency if lines is None else lines)
        stiffness, clamp = np.exp(offsets.get("modulus", 0.0)), offsets.get("clamp", 0.0)
        reads = np.full((n, 1, 1), stiffness / (1 + clamp), dtype=complex)
        slopes = {"modulus": reads, "clamp": -reads / (1 + clamp)}
        names = [one.name for one in self.parameters]
        changes = {name: Change(channels=(0,), rows=slopes[name]) for name in names if derivatives}
        return Predicted(rows=reads, changes=changes)


def reading(values, noise):
    """One channel that reads `values` (n,) for a known input of 1."""
    shape = (1, len(values), 1)
    return Measured(
        name="one",
        configuration="one",
        runs=("r",),
        channels=("c",),
        judged=np.ones(1, dtype=bool),
        frequency=np.linspace(1.0, 2.0, len(values)),
        values=np.reshape(values, shape).astype(complex),
        noise=np.full(shape, noise),
        inputs=np.ones(shape, dtype=complex),
    )


def test_a_child_in_a_bent_valley_goes_on_while_it_gains(lab):
    """The parent had to bend its modulus far out of its tolerance; straight steps along the valley leave it at once."""
    measured = reading(np.full(40, 0.7), 2e-6)
    modulus = Parameter(name="modulus", unit="1", tolerance=0.02, kind=DECLARED)
    clamp = Parameter(name="clamp", unit="1", tolerance=0.5, kind=EFFECT, start=3.0, low=0.0)
    parent = fit(Problem((Valley(measured=measured, parameters=(modulus,)),)), FITTED, floor=0.0)
    child = fit(Problem((Valley(measured=measured, parameters=(modulus, clamp)),)), FITTED, start=parent, floor=0.0)
    clamps = np.linspace(0.0, 1.0, 100_001)
    least = np.min(0.5 * (np.log(0.7 * (1 + clamps)) / 0.02) ** 2 + 0.5 * (clamps / 0.5) ** 2)
    assert child.converged
    assert child.cost < least + 0.5
    assert parent.cost > least + 50


@dataclass(frozen=True, eq=False, kw_only=True)
class Turning:
    """One channel whose phase turns with a stiffness, the quicker the higher the frequency: one valley for every turn."""

    measured: Measured
    parameters: tuple[Parameter, ...]

    def at(self, offsets, lines=None, *, derivatives=True):
        f = self.measured.frequency if lines is None else self.measured.frequency[lines]
        reads = np.exp(6j * f * offsets.get("modulus", 0.0))[:, None, None]
        changes = {"modulus": Change(channels=(0,), rows=6j * f[:, None, None] * reads)} if derivatives else {}
        return Predicted(rows=reads, changes=changes)


@pytest.mark.parametrize("truth", [-0.7, 0.0, 0.6])
def test_a_baseline_begins_at_other_stiffnesses_as_well(truth):
    """From the nominal one every way leads down into the valley of another turn; a way begun near the truth does not."""
    stiffness = Parameter(name="modulus", unit="1", tolerance=0.5, kind=DECLARED, logarithmic=True, nominal=1.0)
    f = np.linspace(1.0, 2.0, 60)
    problem = Problem((Turning(measured=reading(np.exp(6j * f * truth), 1e-3), parameters=(stiffness,)),))
    assert_allclose(fit(problem, FITTED).by_name["modulus"], truth, atol=1e-3)
    here = direct(cost_of(problem, problem.parameters, 0.2), {}, lambda share: None)
    assert (abs(here.offsets["modulus"] - truth) > 0.1) == (truth != 0.0)


def test_what_is_new_begins_where_it_has_no_effect_and_a_factor_at_its_own_start(lab):
    parent = fit(Problem((lab.toy(TRUTH),)), PLAIN)
    new = (
        lab.effect("appendage[m]", 0.05, start=0.3),
        lab.effect("appendage[f]", 0.5, nominal=20.0, logarithmic=True, start=0.1),
    )
    assert parents_point(new, parent) == {"appendage[m]": 0.0, "appendage[f]": 0.1}


def test_facts_count(lab):
    class Weight:
        name, parameters = "weight", (lab.LABORATORY[0],)

        def residual(self, offsets):
            return (offsets.get("mass", 0.0) - 0.5) / 1e-7, {"mass": 1 / 1e-7}

    problem = Problem((lab.toy(TRUTH),), (Weight(),))
    found = fit(problem, PLAIN)
    assert_allclose(found.by_name["mass"], 0.5, atol=1e-5)
    cost = cost_of(Problem(problem.predictions), found.parameters, 0.01)
    left = (found.by_name["mass"] - 0.5) / 1e-7
    assert_allclose(found.chi2, 2 * cost.data(found.offsets).cost + left**2, rtol=1e-9)
    assert found.degrees_of_freedom == fit(Problem(problem.predictions), PLAIN).degrees_of_freedom + 1


def test_progress_ends_at_all_never_goes_back_and_an_interrupt_ends_a_fit_at_once(lab):
    told: list[float] = []
    fit(Problem((lab.toy(TRUTH),)), FITTED, progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 1.0

    def stop(share):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fit(Problem((lab.toy(TRUTH),)), PLAIN, progress=stop)


HIDDEN = {"appendage[m]": 0.4, "appendage[f]": np.log(26.3 / 20.0), "mass": 0.01}


@pytest.fixture
def resonator(lab):
    effects = (lab.effect("appendage[m]", 0.3), lab.effect("appendage[f]", 0.5, nominal=20.0, logarithmic=True))
    return Problem((lab.toy(HIDDEN, parameters=(*lab.LABORATORY, *effects)),)), Problem((lab.toy(HIDDEN, acting=effects),))


def test_a_resonator_is_found_by_its_dictionary(resonator):
    problem, without = resonator
    parent = fit(without, PLAIN)
    told: list[float] = []
    begin = start(problem, ["appendage[f]"], base=parent.by_name, progress=told.append)
    found = fit(problem, PLAIN, start=begin)
    assert_allclose(found.by_name["appendage[f]"], HIDDEN["appendage[f]"], atol=0.003)
    assert_allclose(found.by_name["appendage[m]"], 0.4, atol=0.02)
    assert found.cost < parent.cost - 100
    assert told == sorted(told)


def test_an_amplitude_is_what_the_data_want_at_every_place_and_not_on_the_grid(lab):
    """A logarithmic mass a factor of eight too small: steps of its logarithm from there would promise nothing."""
    effects = (
        lab.effect("appendage[m]", 2.0, nominal=0.05, logarithmic=True),
        lab.effect("appendage[f]", 1.0, nominal=10.0, logarithmic=True),
    )
    truth = {"appendage[m]": np.log(0.4 / 0.05), "appendage[f]": np.log(26.3 / 10.0), "mass": 0.01}
    problem = Problem((lab.toy(truth, acting=effects, parameters=(*lab.LABORATORY, *effects)),))
    places = {"appendage[f]": np.log(np.geomspace(4.0, 30.0, 60) / 10.0)}
    begin = start(problem, tuple(places), places=places, amplitude="appendage[m]")
    assert_allclose(begin["appendage[f]"], truth["appendage[f]"], atol=0.02)
    assert_allclose(begin["appendage[m]"], truth["appendage[m]"], atol=0.3)
    found = fit(problem, PLAIN, start=begin)
    assert_allclose(found.by_name["appendage[m]"], truth["appendage[m]"], atol=0.01)


def test_no_amplitude_is_begun_that_the_data_want_negative(lab):
    effects = (
        lab.effect("appendage[m]", 2.0, nominal=0.05, logarithmic=True),
        lab.effect("appendage[f]", 1.0, nominal=20.0, logarithmic=True),
    )
    negative = (lab.effect("appendage[m]", 1.0), effects[1])
    made = lab.toy({"appendage[m]": -0.4, "mass": 0.01}, acting=negative)
    problem = Problem((replace(made, parameters=(*made.parameters, *effects)),))
    places = {"appendage[f]": [0.0]}
    begin = start(problem, tuple(places), places=places, amplitude="appendage[m]")
    assert begin["appendage[m]"] == 0.0


def test_the_beginning_stays_where_nothing_is_better_and_several_sizes_span_a_grid(lab):
    effects = (lab.effect("appendage[m]", 0.3), lab.effect("appendage[f]", 0.5, nominal=20.0, logarithmic=True))
    problem = Problem((lab.toy({"mass": 0.01}, parameters=(*lab.LABORATORY, *effects), seed=None),))
    begin = start(problem, ["appendage[f]"], base={"mass": 0.01})
    assert_allclose(begin["appendage[m]"], 0.0, atol=1e-6)
    problem = Problem((lab.toy({"mass": 0.2, "frequency:one": 0.04}, seed=None),))
    places = {"mass": [0.0, 0.2], "frequency:one": [-0.04, 0.0, 0.04]}
    begin = start(problem, ["mass", "frequency:one"], places=places)
    assert begin["mass"] == 0.2
    assert begin["frequency:one"] == 0.04


def test_unknown_names_and_unknown_reach_are_refused(lab):
    loose = lab.effect("offset", np.inf)
    problem = Problem((lab.toy({}, parameters=(*lab.LABORATORY, loose)),))
    with pytest.raises(BadInput, match="Did you mean mass"):
        start(problem, ["mas"])
    with pytest.raises(BadInput, match="nothing is known of it beforehand"):
        start(problem, ["offset"])
