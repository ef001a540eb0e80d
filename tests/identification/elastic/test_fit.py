"""Weights, thinning, the start of poles and what the fit refuses: on dynamic masses written down here."""

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


def test_lines_are_kept_at_resonances_and_thinned_away_from_them() -> None:
    all_lines = data()
    chosen = all_lines.frequency[elastic_fit.kept(all_lines)]
    assert chosen[[0, -1]].tolist() == [4.0, 32.0]
    assert np.sum((chosen > 12.1) & (chosen < 12.6)) >= 9
    assert_allclose(np.diff(chosen[chosen > 20])[:-1], elastic_fit.LINES_APART, atol=1e-9)


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


def test_levels_grow_with_the_matrix_and_see_what_row_and_column_carry() -> None:
    levels = elastic_fit.levels(CLUSTER.matrix)
    assert_allclose(elastic_fit.levels(3 * CLUSTER.matrix), 3 * levels, rtol=1e-12)
    assert np.all(levels >= np.abs(CLUSTER.matrix) * (1 - 1e-12))


def test_the_first_pole_starts_at_the_resonance_with_its_participation() -> None:
    single = model.chosen(TWO, [0])
    H = DynamicMass(frequency=LINES, matrix=model.dynamic_mass(BODY.mass_matrix, single, LINES))
    lines = data(H)
    rigid = refine(np.zeros(31), ElasticLayout(modes=0), lines)
    first = elastic_fit.next_poles(rigid, lines)[0]
    assert_allclose(first.frequency, 12.30, rtol=0.01)
    along = first.participation / model.SCALE
    true = TWO.participation[0] / model.SCALE
    assert abs(along @ true) > 0.95 * np.linalg.norm(along) * np.linalg.norm(true)


def test_white_noise_repeats_nothing_and_a_slope_repeats_itself() -> None:
    rng = np.random.default_rng(1)
    lines = data()
    at = refine(np.zeros(31), ElasticLayout(modes=0), lines, iterations=0)
    white = replace(at, residual=rng.standard_normal(at.residual.shape))
    slope = replace(at, residual=np.repeat(np.linspace(-1, 1, 561), 42))
    assert white.correlation_time < 1.1
    assert slope.correlation_time > 50


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
