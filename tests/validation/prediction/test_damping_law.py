"""The law of damping: right at resonance whatever it is, and between the two beside it."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.beam import articles
from fem.modes import fixed_base
from geometry.articles import built_in
from validation.prediction import dynamic_mass, nuisances
from validation.prediction import structure as prediction_structure


@pytest.fixture(scope="module")
def of():
    structure = articles.structure("clumod-1")
    modes = fixed_base(structure, 12)
    found = prediction_structure.of_structure(structure, modes, article=built_in("clumod-1"))
    return nuisances.of("clumod-1", found, modes.frequency, structure.loss_factors, highest=20.0)


def answered(of, share, lines):
    made, tangents = of.at({})
    changed, behind = nuisances.applied(made, tangents, of.nominal, {nuisances.NAME: share}, derivatives=True)
    return dynamic_mass.dynamic_mass(changed, lines), behind


def test_both_laws_lose_the_same_at_a_resonance_and_not_beside_it(of):
    f = float(of.frequency[0])
    (at, _), (viscous, _) = answered(of, 0.0, [f, 0.5 * f]), answered(of, 1.0, [f, 0.5 * f])
    x = np.unravel_index(np.abs(at.matrix[0]).argmax(), (6, 6))
    # what remains at the peak is what the other modes lose there
    assert_allclose(viscous.matrix[0][x], at.matrix[0][x], rtol=0.01)
    ratio = viscous.matrix[1][x].imag / at.matrix[1][x].imag
    assert 0.35 < ratio < 0.55  # omega / omega_r of this mode, and less of those above


def test_its_derivative_and_those_behind_it_are_differences(of):
    lines, share, step = np.array([5.0, 11.6, 14.0]), 0.3, 1e-4
    here, behind = answered(of, share, lines)
    slopes = dynamic_mass.transfer_tangents(here, behind)
    above, below = (answered(of, share + side * step, lines)[0].matrix for side in (1, -1))
    scale = np.abs(slopes[nuisances.NAME]).max()
    assert_allclose(slopes[nuisances.NAME], (above - below) / (2 * step), atol=1e-6 * scale)
    for name in ("loss:mast", "modulus:mast"):
        sides = []
        for side in (1, -1):
            made, _ = of.at({name: side * step})
            changed, _ = nuisances.applied(made, {}, of.nominal, {nuisances.NAME: share}, derivatives=False)
            sides.append(dynamic_mass.dynamic_mass(changed, lines).matrix)
        assert_allclose(slopes[name], (sides[0] - sides[1]) / (2 * step), atol=1e-4 * np.abs(slopes[name]).max(), err_msg=name)


def test_it_is_open_where_parts_lose_something_and_one_for_all_structures(of):
    (law,) = (one for one in of.parameters if one.name == nuisances.NAME)
    assert law.tolerance == of.tolerances.damping_law
    bare = nuisances.of("clumod-1", of.nominal, of.frequency, {})
    assert nuisances.NAME not in {one.name for one in bare.parameters}
