"""Craig-Bampton: on a rigid base, on any interface, and back."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigvalsh
from scipy.sparse import csr_array

from fem import dynamic_mass, reduction
from fem.beam import articles
from fem.modes import fixed_base
from fem.structure import Structure
from geometry.errors import BadInput

Block = Callable[..., Structure]
BAND = np.linspace(4.0, 32.0, 9)


def test_reduced_matrices_give_the_modal_dynamic_mass_without_residual() -> None:
    structure = articles.structure("clumod-4")
    found = reduction.dynamic_mass(reduction.craig_bampton(structure, 20), BAND)
    expected = dynamic_mass.modal(fixed_base(structure, 20), BAND, residual=False)
    assert_allclose(found.matrix, expected.matrix, rtol=0, atol=1e-11 * np.abs(expected.matrix).max())


def test_reduced_matrices_are_the_full_ones_seen_through_the_basis(block: Block) -> None:
    structure = block(4, 4, 5)
    r = reduction.craig_bampton(structure, 12)
    V = r.expand(np.eye(18))
    for full, small in ((structure.mass, r.mass), (structure.stiffness, r.stiffness)):
        assert_allclose(V.T @ full @ V, small, rtol=0, atol=1e-9 * np.abs(small).max())
    assert_allclose(V[:, :6], structure.rigid)  # coordinates of the base move everything rigidly


@pytest.mark.parametrize("count", [10, 40])
def test_a_general_interface_keeps_the_fixed_base_modes(count: int, block: Block) -> None:
    """Reduced onto every held degree of freedom and held there, the modes are those of the structure itself."""
    structure = block(4, 4, 5)
    r = reduction.general(structure.stiffness, structure.mass, structure.held, count)
    again = reduction.as_structure(r, structure.rigid[structure.held])
    one, other = fixed_base(structure, 10), fixed_base(again, 10)
    assert_allclose(other.frequency, one.frequency, rtol=1e-8)
    assert_allclose(again.rigid_mass, structure.rigid_mass, rtol=0, atol=1e-9 * structure.rigid_mass.max())
    assert_allclose(other.effective_mass.sum(axis=0), one.effective_mass.sum(axis=0), rtol=1e-6, atol=1e-9)


def test_the_static_answer_to_the_interface_is_exact(block: Block) -> None:
    structure = block(3, 3, 4)
    r = reduction.general(structure.stiffness, structure.mass, structure.held, 5)
    u = r.basis[:, : r.interface]
    forces = structure.stiffness @ u
    assert_allclose(forces[structure.free], 0, atol=1e-9 * np.abs(forces).max())
    assert_allclose(u @ structure.rigid[structure.held], structure.rigid, atol=1e-9)  # rigid motion comes through
    assert_allclose(r.stiffness[: r.interface] @ np.vstack([structure.rigid[structure.held], np.zeros((5, 6))]), 0, atol=1e-6)


def test_with_all_modes_nothing_is_lost_and_dashpots_come_along(block: Block) -> None:
    structure = block(2, 3, 3)
    every = len(structure.free)
    r = reduction.general(structure.stiffness, structure.mass, structure.held, every, viscous=1e-3 * structure.stiffness)
    full = eigvalsh(structure.stiffness.toarray(), structure.mass.toarray())
    assert_allclose(eigvalsh(r.stiffness, r.mass), full, rtol=1e-8, atol=1e-8 * full[-1])
    assert_allclose(r.viscous, 1e-3 * r.stiffness, rtol=0, atol=1e-9 * np.abs(r.viscous).max())


def test_an_interface_of_everything_is_the_structure_itself(block: Block) -> None:
    structure = block(2, 2, 2)
    r = reduction.general(structure.stiffness, structure.mass, np.arange(24), 5)
    assert_allclose(r.stiffness, structure.stiffness.toarray())
    assert r.interface == 24


@pytest.mark.parametrize(("interface", "words"), [([], "empty"), ([1, 1], "twice"), ([0, 99], "0 to 99"), ([-1], "-1 to -1")])
def test_an_interface_that_cannot_be_is_refused(interface: list[int], words: str) -> None:
    one = csr_array(np.eye(6))
    with pytest.raises(BadInput, match=words):
        reduction.general(one, one, np.array(interface, dtype=np.intp), 2)


def test_only_a_rigid_base_has_a_dynamic_mass(block: Block) -> None:
    structure = block(2, 2, 2)
    r = reduction.general(structure.stiffness, structure.mass, structure.held, 5)
    with pytest.raises(ValueError, match="six motions"):
        reduction.dynamic_mass(r, BAND)
