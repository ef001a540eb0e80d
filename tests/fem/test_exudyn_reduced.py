"""Plumbing: reduced matrices of ours arrive in exudyn as they left."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem import reduction
from fem.beam import articles
from fem.dynamic_mass import LINES, modal
from fem.exudyn import linear
from fem.exudyn.linear import single
from fem.exudyn.run import failed
from fem.reduction import Reduced, craig_bampton
from geometry.errors import CheckFailed

COUNT = 30


@pytest.fixture(scope="module", params=["clumod-1", "clumod-4"])
def ours(request: pytest.FixtureRequest) -> Reduced:
    return craig_bampton(articles.structure(request.param), COUNT)


def test_reduced_matrices_in_exudyn_have_our_frequencies(ours: Reduced) -> None:
    system = linear.linearised(ours.stiffness, ours.mass)
    assert_allclose((2 * np.pi * system.frequency) ** 2, np.diag(ours.stiffness)[6:], rtol=1e-6)


def test_reduced_matrices_in_exudyn_have_our_dynamic_mass(ours: Reduced) -> None:
    """Exudyn's modes summed up, against our modal coordinates condensed line by line."""
    system = linear.linearised(ours.stiffness, ours.mass)
    exudyns = modal(single(system, ours.structural, np.zeros(3), COUNT), LINES).matrix
    here = reduction.dynamic_mass(ours, LINES).matrix
    assert_allclose(exudyns, here, rtol=0, atol=1e-6 * np.abs(here).max())


def test_matrices_without_stiffness_are_no_frequencies() -> None:
    with pytest.raises(CheckFailed, match="lowest squared frequency is"):
        linear.linearised(np.zeros((8, 8)), np.eye(8))


def test_matrices_of_different_size_are_refused_in_exudyns_words() -> None:
    with pytest.raises(CheckFailed, match=r"exudyn .* failed when it should take reduced matrices: \S"):
        linear.linearised(np.eye(7), np.eye(8))


def test_a_failure_carries_what_exudyn_said() -> None:
    assert failed("do it", "no").evidence == {"task": "do it", "said": "no"}
