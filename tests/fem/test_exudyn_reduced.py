"""Plumbing: reduced matrices of ours arrive in exudyn as they left."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem import beam
from fem.damping import DEFAULT_RATIO
from fem.dynamic_mass import LINES, modal
from fem.flexible_body import reduced
from fem.flexible_body.modal import single
from fem.flexible_body.running import failed
from fem.modes import Modes, fixed_base
from geometry.arrays import Array
from geometry.errors import CheckFailed

COUNT = 30


@pytest.fixture(scope="module", params=["clumod-1", "clumod-4"])
def ours(request: pytest.FixtureRequest) -> Modes:
    structure = beam.structure(request.param)
    return fixed_base(structure, COUNT)


def test_reduced_matrices_in_exudyn_have_our_frequencies(ours: Modes) -> None:
    system = reduced.linearised(*craig_bampton(ours))
    assert_allclose(system.frequency, ours.frequency, rtol=1e-6)


def test_reduced_matrices_in_exudyn_have_our_dynamic_mass(ours: Modes) -> None:
    """Of the modes alone: what is left out of a reduction is out of exudyn too."""
    K, M = craig_bampton(ours)
    system = reduced.linearised(K, M)
    exudyns = modal(single(system, 2 * DEFAULT_RATIO * K, np.zeros(3), COUNT), LINES, residual=False).matrix
    structural = np.diag(2 * DEFAULT_RATIO * (2 * np.pi * ours.frequency) ** 2)
    here = modal(with_structural(ours, structural), LINES, residual=False).matrix
    assert_allclose(exudyns, here, rtol=0, atol=1e-6 * np.abs(here).max())


def test_matrices_without_stiffness_are_no_frequencies() -> None:
    with pytest.raises(CheckFailed, match="lowest squared frequency is"):
        reduced.linearised(np.zeros((8, 8)), np.eye(8))


def test_matrices_of_different_size_are_refused_in_exudyns_words() -> None:
    with pytest.raises(CheckFailed, match=r"exudyn .* failed when it should take reduced matrices: \S"):
        reduced.linearised(np.eye(7), np.eye(8))


def test_a_failure_carries_what_exudyn_said() -> None:
    assert failed("do it", "no").evidence == {"task": "do it", "said": "no"}


def craig_bampton(modes: Modes) -> tuple[Array, Array]:
    """Stiffness and mass (6 + n, 6 + n): rigid motions of the base, then mass-normalised fixed-base modes."""
    n = modes.frequency.size
    K = np.diag(np.concatenate([np.zeros(6), (2 * np.pi * modes.frequency) ** 2]))
    return K, np.block([[modes.rigid_mass, modes.participation], [modes.participation.T, np.eye(n)]])


def with_structural(modes: Modes, structural: Array) -> Modes:
    return Modes(**{**vars(modes), "structural": structural})
