"""Evidence says whether a parameter is worth having, and for a linear model it is exact."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from validation.estimation.fit import fit
from validation.estimation.problem import FITTED, PLAIN, Predicted, Problem


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


class Noisier:
    """The toy with noise that is not that of the data."""

    def __init__(self, toy, factor):
        self.toy, self.measured, self.parameters, self.factor = toy, toy.measured, toy.parameters, factor

    def at(self, offsets, lines=None, *, derivatives=True):
        found = self.toy.at(offsets, lines, derivatives=derivatives)
        lines = slice(None) if lines is None else lines
        return Predicted(rows=found.rows, changes=found.changes, noise=self.factor * self.measured.noise[:, lines])


@pytest.mark.parametrize("known", [False, True], ids=["latent", "known"])
def test_noise_that_is_not_that_of_the_data_is_less_probable_both_ways(lab, known):
    """Where noise is an effect, the normalisation of the likelihood decides: too much of it is as wrong as too little."""
    toy = lab.toy({}, known=known)
    evidence = {factor: fit(Problem((Noisier(toy, factor),)), PLAIN, floor=0.0).log_evidence for factor in (0.5, 1.0, 2.0)}
    assert evidence[1.0] > evidence[0.5] + 100
    assert evidence[1.0] > evidence[2.0] + 100
    assert_allclose(evidence[1.0], fit(Problem((toy,)), PLAIN, floor=0.0).log_evidence, rtol=1e-12)
