"""Elastic terms: the model and its derivatives, fits from exact and noisy data, and why so many poles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.dynamic_mass import DynamicMass
from geometry.errors import BadInput
from geometry.inertia import Inertia
from identification.elastic import fit as elastic_fit
from identification.elastic import model
from identification.elastic.fit import fit, refine
from identification.elastic.model import ElasticLayout, ElasticTerms

RNG = np.random.default_rng(8)
SOME_LINES = np.linspace(4.0, 32.0, 41)
PARAMETERS = np.array([33.0, 0.4, -0.3, 9.0, 8.8, 8.4, 0.8, 0.02, -0.03, 0.05])


def terms(modes: int, *, coupled: bool = False) -> ElasticTerms:
    f = np.sort(RNG.uniform(5.0, 40.0, modes))
    d = np.sqrt(4 * np.pi * 0.004 * f)
    rho = 0.3 * np.eye(modes, k=1) if coupled else np.zeros((modes, modes))
    A = RNG.standard_normal((6, 6))
    return ElasticTerms(
        frequency=f,
        damping=np.outer(d, d) * (np.eye(modes) + rho + rho.T),
        participation=RNG.standard_normal((modes, 6)),
        residual=1e-5 * (A + A.T),
    )


def mass(parameters: np.ndarray = PARAMETERS) -> np.ndarray:
    return Inertia(parameters=parameters).mass_matrix


def test_at_frequency_zero_the_rigid_mass_is_left() -> None:
    assert_allclose(model.dynamic_mass(mass(), terms(5, coupled=True), [0.0])[0], mass(), rtol=1e-14, atol=0)


def test_one_mode_is_the_oscillator_of_a_closed_form() -> None:
    f, zeta, m = 12.0, 0.02, 3.0
    one = ElasticTerms(frequency=[f], damping=[[4 * np.pi * zeta * f]], participation=[[np.sqrt(m), 0, 0, 0, 0, 0]])
    ratio = SOME_LINES / f
    carried = m * (1 + 2j * zeta * ratio) / (1 - ratio**2 + 2j * zeta * ratio)  # a mass on a spring and a dashpot, driven below
    got = model.dynamic_mass(np.diag([m, m, m, 1.0, 1.0, 1.0]), one, SOME_LINES)[:, 0, 0]
    assert_allclose(got, carried, rtol=1e-12)


def test_coupled_damping_of_modes_is_that_of_any_other_basis_of_them() -> None:
    """Two modes of one frequency may be turned into each other; full C and L turn with them and H stays."""
    c, s = np.cos(0.7), np.sin(0.7)
    turn, L, C = np.array([[c, -s], [s, c]]), RNG.standard_normal((2, 6)), np.diag([0.3, 0.9])
    before = ElasticTerms(frequency=[12.3, 12.3], damping=C, participation=L)
    after = ElasticTerms(frequency=[12.3, 12.3], damping=turn @ C @ turn.T, participation=turn @ L)
    assert_allclose(
        model.dynamic_mass(mass(), after, SOME_LINES), model.dynamic_mass(mass(), before, SOME_LINES), rtol=0, atol=1e-10
    )


@pytest.mark.parametrize("coupled", [False, True])
def test_packing_and_unpacking_is_the_identity(coupled: bool) -> None:
    given = terms(4, coupled=coupled)
    layout = model.layout_of(given)
    parameters, back = model.unpack(model.pack(PARAMETERS, given), layout)
    assert_allclose(parameters, PARAMETERS, rtol=1e-14)
    for name in ("frequency", "damping", "participation", "residual"):
        assert_allclose(getattr(back, name), getattr(given, name), rtol=1e-13, atol=1e-18)
    assert len(layout.names) == len(set(layout.names)) == layout.size == 10 + 8 * 4 + 3 * coupled + 21


@pytest.mark.parametrize("coupled", [False, True])
def test_derivatives_are_the_differences_of_the_model(coupled: bool) -> None:
    given = terms(4, coupled=coupled)
    layout = model.layout_of(given)
    x, analytic = model.pack(PARAMETERS, given), model.whole(model.upper_derivatives(given, SOME_LINES, layout))

    def mass_at(vector: np.ndarray) -> np.ndarray:
        parameters, moved = model.unpack(vector, layout)
        return model.dynamic_mass(mass(parameters), moved, SOME_LINES)

    for k, name in enumerate(layout.names):
        step = 1e-4 * np.eye(layout.size)[k]
        slopes = [(mass_at(x + h * step) - mass_at(x - h * step)) / (2e-4 * h) for h in (1.0, 2.0)]
        numeric = (4 * slopes[0] - slopes[1]) / 3  # Richardson: the error is of fourth order in the step
        # At 0.4 % damping a step of 1e-4 in ln f is 1/40 of the half-power width: (1/40)^4 is 4e-7, rounding 1e-10.
        assert_allclose(numeric, analytic[k], rtol=0, atol=3e-5 * np.abs(analytic[k]).max() + 1e-9, err_msg=name)


def test_a_layout_by_widths_couples_the_modes_that_overlap() -> None:
    f = np.array([11.6, 12.28, 12.34, 12.38, 15.5])
    cluster = ElasticTerms(frequency=f, damping=np.diag(4 * np.pi * 0.0035 * f), participation=np.ones((5, 6)))
    assert model.layout_of(cluster).pairs == ()
    assert model.layout_of(cluster, widths=2.0).pairs == ((1, 2), (1, 3), (2, 3))


LINES = np.linspace(4.0, 32.0, 561)
BODY = Inertia.from_cog(40.0, [0.01, -0.02, 0.2], np.diag([2.0, 2.5, 1.0]))
TWO = ElasticTerms(
    frequency=np.array([12.30, 12.36]),  # 0.7 of a half-power width apart
    damping=4 * np.pi * 0.0035 * np.array([[12.30, 2.0], [2.0, 12.36]]),
    participation=np.array([[3.0, 0, 0, 0, 1.0, 0], [1.0, 2.0, 0, -1.5, 0.3, 0]]),
    residual=np.diag([1e-5, 1e-5, 1e-5, 1e-6, 1e-6, 1e-6]),
)
CLUSTER = DynamicMass(frequency=LINES, matrix=model.dynamic_mass(BODY.mass_matrix, TWO, LINES))


def data(H: DynamicMass = CLUSTER) -> elastic_fit.Lines:
    return elastic_fit.lines_of(H, None, 0.002, None)


def test_two_modes_within_a_half_power_width_are_told_apart_with_their_coupling() -> None:
    found = fit(CLUSTER)
    assert found.modes == 2
    assert_allclose(found.terms.frequency, TWO.frequency, rtol=1e-6)
    assert_allclose(found.terms.damping, TWO.damping, rtol=2e-3)
    assert_allclose(found.inertia.mass_matrix, BODY.mass_matrix, rtol=0, atol=1e-5)


def test_the_reference_point_is_that_of_the_dynamic_mass() -> None:
    moved = fit(CLUSTER.about([0.1, 0.2, -0.3]), modes=2)
    assert_allclose(moved.inertia.cog, BODY.cog, atol=1e-5)


def test_a_fit_started_from_another_one_does_not_need_to_search() -> None:
    before = fit(CLUSTER)
    again = fit(CLUSTER, start=before, modes=2)
    assert [one.modes for one in again.history] == [2]
    assert_allclose(again.parameters, before.parameters, rtol=1e-4, atol=1e-4)


def test_the_two_halves_of_a_measured_matrix_are_averaged_and_their_difference_is_told() -> None:
    H = CLUSTER.matrix.copy()
    H[:, 0, 4] *= 1.01
    H[:, 4, 0] *= 0.99
    one = data(replace(CLUSTER, matrix=H))
    place = [(i, j) for i, j in zip(*model.UPPER, strict=True)].index((0, 4))
    assert_allclose(one.values[:, place], CLUSTER.matrix[:, 0, 4], rtol=1e-3)
    assert one.asymmetry[0] > 100 * data().asymmetry[0]


def test_known_noise_rules_where_it_is_larger_than_the_floor() -> None:
    noise = np.full((561, 6, 6), 7.0)
    noisy = elastic_fit.lines_of(CLUSTER, noise, 1e-9, None)
    diagonal = model.UPPER[0] == model.UPPER[1]
    assert_allclose(noisy.deviation[:, diagonal], 7.0, rtol=1e-9)
    assert_allclose(noisy.deviation[:, ~diagonal], 7.0 / np.sqrt(2), rtol=1e-9)


def test_what_priors_decide_is_no_parameter_of_the_data() -> None:
    lines, layout = data(), ElasticLayout(modes=2, pairs=((0, 1),))
    x = model.pack(BODY.parameters, TWO, layout)
    seen = refine(x, layout, lines, iterations=0)
    blind = model.pack(BODY.parameters, replace(TWO, participation=np.zeros((2, 6))), layout)
    unseen = refine(blind, layout, lines, iterations=0)
    assert seen.effective_size > layout.size - 0.1
    assert_allclose(unseen.effective_size, layout.size - 5, atol=0.1)


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"band": (40.0, 50.0)}, "at least two lines are needed, found 0"),
        ({"weights": np.ones((3, 6, 6))}, "one standard deviation for each entry"),
        ({"weights": -np.ones((561, 6, 6))}, "at least 0"),
        ({"floor": 0.0}, "a floor above zero is needed"),
        ({"modes": -1}, "`modes`"),
    ],
)
def test_what_cannot_be_fitted_is_refused(asked: dict[str, object], said: str) -> None:
    with pytest.raises(BadInput, match=said):
        fit(CLUSTER, **asked)


def test_a_step_solves_the_modes_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a trial is judged by is what it is linearised with."""
    there = terms(3, coupled=True)
    layout, start = model.layout_of(there), model.pack(PARAMETERS, there)
    H = DynamicMass(frequency=SOME_LINES, matrix=model.dynamic_mass(mass(), there, SOME_LINES), reference_point=np.zeros(3))
    lines = elastic_fit.lines_of(H, None, 0.002, None)
    solved, trials, answers, step = [], [], model.answers, elastic_fit.Refined._step
    monkeypatch.setattr(model, "answers", lambda *asked: solved.append(1) or answers(*asked))
    monkeypatch.setattr(elastic_fit.Refined, "_step", lambda *asked: trials.append(1) or step(*asked))
    found = refine(start + 0.002, layout, lines)
    assert found.converged
    assert found.chi2 < 1
    assert len(solved) == 1 + len(trials) > 2
