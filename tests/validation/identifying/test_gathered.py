"""What is gathered from the evidence: the rigid body behind a measured dynamic mass, what redundant channels leave over."""

from types import SimpleNamespace

import numpy as np
from numpy.testing import assert_allclose

from geometry.inertia import Inertia
from identification.request import Identified
from validation.identify.identify import IdentificationFindings, residuals, rigid


def test_the_rigid_body_behind_a_dynamic_mass_is_found_whatever_was_left_out(found: IdentificationFindings) -> None:
    spoilt = found.dynamic_mass.matrix + 1e3 * (1 - found.lines.kept)[:, None, None]
    of = SimpleNamespace(
        estimate=SimpleNamespace(dynamic_mass=SimpleNamespace(frequency=found.lines.frequency, matrix=spoilt)),
        exclusions=SimpleNamespace(kept=found.lines.kept > 0),
    )
    assert_allclose(rigid(of, found.result.identified), found.rigid, atol=1e-9 * found.rigid.max())


def test_a_rigid_result_takes_no_elastic_terms_off(clumod: Inertia) -> None:
    body = clumod.moved([0.1, -0.2, 0.3])
    of = SimpleNamespace(
        estimate=SimpleNamespace(
            dynamic_mass=SimpleNamespace(frequency=np.arange(3.0), matrix=np.tile(body.mass_matrix, (3, 1, 1)))
        ),
        exclusions=SimpleNamespace(kept=np.ones(3, dtype=bool)),
    )
    one = Identified(way="plain", inertia=body, covariance=np.zeros((10, 10)), band=(4, 32))
    assert_allclose(rigid(of, one), body.mass_matrix, atol=1e-12)


def test_residuals_are_shares_of_what_channels_of_a_kind_read(found: IdentificationFindings) -> None:
    table = found.spectra.table
    names = tuple(table.names[k] for k in table.select(quantity="acceleration"))
    cells = tuple(table.names[k] for k in table.select(quantity="force"))
    values = np.ones((6, 141, len(table)))
    of = SimpleNamespace(
        motion=SimpleNamespace(channels=names, residual=np.full((6, 141, len(names)), 0.02j)),
        load=SimpleNamespace(channels=cells, parity=np.full((6, 141, 1), 0.1), combinations=np.ones((1, len(cells)))),
        article=SimpleNamespace(table=table, values=5 * values, frequency=found.spectra.frequency, runs=found.spectra.runs),
    )
    drawn = residuals(of)
    assert drawn.channels == (*names, *cells)
    assert_allclose(drawn.share[..., : len(names)], 0.004)
    assert_allclose(drawn.share[..., len(names) :], 0.02)
