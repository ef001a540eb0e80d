"""The band study tells what elasticity makes from what inertia makes: on finite elements, and on a rigid body."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem import dynamic_mass
from fem.beam import articles
from fem.damping import Damping
from fem.modes import fixed_base
from geometry.dynamic_mass import DynamicMass
from geometry.errors import BadInput
from geometry.inertia import PARAMETERS, Inertia
from identification.elastic.fit import levels
from identification.elastic.study import BandStudy, study

LINES = np.linspace(4.0, 32.0, 561)
ELASTIC = ("m", "mz", "Ixx", "Iyy")
"""What the bending of one blade and its mast changes."""


def noisy(H: DynamicMass, noise: float) -> DynamicMass:
    rng = np.random.default_rng(3)
    white = (rng.standard_normal(H.matrix.shape) + 1j * rng.standard_normal(H.matrix.shape)) / np.sqrt(2)
    return replace(H, matrix=H.matrix + noise * levels(H.matrix) * white)


@cache
def one_blade() -> DynamicMass:
    return noisy(dynamic_mass.modal(fixed_base(articles.structure("clumod-1"), 40, damping=Damping(ratio=0.0035)), LINES), 0.002)


@cache
def body() -> Inertia:
    return Inertia.from_mass_matrix(articles.structure("disc+cuboid").rigid_mass)


@cache
def of_one_blade() -> BandStudy:
    return study(one_blade())


def rigid(noise: float) -> DynamicMass:
    flat = DynamicMass(frequency=LINES, matrix=np.broadcast_to(body().mass_matrix, (561, 6, 6)).astype(complex))
    return noisy(flat, noise)


def test_with_elastic_terms_one_blade_is_trusted_without_it_is_flagged_and_the_truth_lies_within_the_spread():
    with_terms, without = of_one_blade().verdicts(), of_one_blade().verdicts(rigid=True)
    assert all(with_terms[name].startswith("trustworthy") for name in PARAMETERS), dict(with_terms)
    assert all(without[name].startswith("dominated by elasticity") for name in ELASTIC), dict(without)
    true = Inertia.from_mass_matrix(articles.structure("clumod-1").rigid_mass).parameters
    found = of_one_blade()
    away = np.abs(found.fitted.parameters - true)
    assert np.all(away <= 2 * found.spread() + 3 * np.sqrt(np.diag(found.fitted.covariance)))


def test_a_rigid_body_is_trusted_the_rigid_way_but_not_in_poor_bands_and_those_without_width_are_refused():
    found = study(rigid(0.001), starts=[4.0, 8.0], stops=[16.0, 32.0], counts=[])
    assert found.counts == (0,)
    assert all(text.startswith("trustworthy") for text in found.verdicts(rigid=True).values())
    for cell in found.cells:
        assert np.all(np.abs(cell.parameters - body().parameters) < 5 * cell.deviation)
    found = study(rigid(0.5), starts=[4.0, 5.0], stops=[8.0, 9.0], counts=[])
    assert found.verdicts()["Ixy"].startswith("not identifiable from this data")
    with pytest.raises(BadInput, match="no band ends above"):
        study(rigid(0.001), starts=[20.0], stops=[21.0])


def test_the_maps_have_a_place_for_every_band_and_number_and_are_empty_where_none_was_fitted():
    found = study(rigid(0.001), starts=[4.0, 15.0], stops=[16.0, 32.0], counts=[])
    assert found.quantities.shape == (2, 2, 1, 7)
    assert_allclose(found.quantities[0, 1, 0, 0], body().mass, rtol=1e-3)
    empty = np.isnan(found.map("misfit"))
    assert empty.tolist() == [[[False], [False]], [[True], [False]]]
    assert found.map().shape == (2, 2, 1, 10)


def test_a_fit_that_exists_is_not_made_again_and_progress_ends_at_one():
    told: list[float] = []
    again = study(
        one_blade(), fitted=of_one_blade().fitted, starts=[4.0], stops=[20.0, 32.0], counts=[4, 5], progress=told.append
    )
    assert again.fitted is of_one_blade().fitted
    assert told == sorted(told)
    assert told[-1] == 1.0
    assert again.counts == (0, 4, 5)
