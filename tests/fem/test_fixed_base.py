"""Fixed-base modes: participation, effective mass, residual, and structures that are not held."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.sparse import block_diag, csr_array

from fem.modes import fixed_base
from fem.structure import Structure
from geometry.errors import BadInput, CheckFailed

Block = Callable[..., Structure]


def test_effective_masses_of_all_modes_are_the_rigid_mass_less_the_bases(block: Block) -> None:
    structure = block(3, 3, 4)
    modes = fixed_base(structure, 10_000)
    base = np.zeros((structure.mass.shape[0], 6))
    base[structure.held] = structure.rigid[structure.held]
    carried = np.diag(base.T @ structure.mass @ base)
    assert_allclose(modes.effective_mass.sum(axis=0) + carried, np.diag(modes.rigid_mass), rtol=1e-9)


@pytest.mark.parametrize("size", [(3, 3, 4), (6, 6, 7)])
def test_the_residual_is_the_sum_over_the_modes_left_out(size: tuple[int, int, int], block: Block) -> None:
    structure = block(*size)
    few, every = fixed_base(structure, 12), fixed_base(structure, 10_000)
    left = every.participation[:, 12:]
    static = (left / (2 * np.pi * every.frequency[12:]) ** 2) @ left.T
    assert_allclose(few.residual, static, rtol=0, atol=1e-9 * np.abs(static).max())
    assert np.linalg.eigvalsh(few.residual).min() > -1e-12 * np.abs(few.residual).max()


def test_shapes_are_zero_where_held_and_mass_normalised(block: Block) -> None:
    structure = block(4, 4, 5)
    modes = fixed_base(structure, 8)
    assert not np.any(modes.shapes[structure.held])
    assert_allclose(modes.shapes.T @ structure.mass @ modes.shapes, np.eye(8), atol=1e-10)
    assert_allclose(modes.participation, (structure.rigid.T @ structure.mass) @ modes.shapes, atol=1e-10)


def test_fewer_modes_than_asked_for_are_given(block: Block) -> None:
    structure = block(2, 2, 2)
    modes = fixed_base(structure, 99)
    assert modes.frequency.size == len(structure.free)
    assert_allclose(modes.residual, 0, atol=1e-12 * modes.rigid_mass.max())


@pytest.mark.parametrize("count", [0, -3])
def test_no_modes_are_refused(count: int, block: Block) -> None:
    with pytest.raises(BadInput, match="at least one mode"):
        fixed_base(block(2, 2, 2), count)


def test_a_body_that_is_not_connected_is_named(block: Block) -> None:
    one, other = block(2, 2, 2), block(2, 2, 3)
    zero = csr_array(one.stiffness.shape), csr_array(other.stiffness.shape)
    apart = Structure(
        stiffness=csr_array(block_diag([one.stiffness, other.stiffness])),
        mass=csr_array(block_diag([one.mass, other.mass])),
        rigid=np.vstack([one.rigid, other.rigid]),
        held=one.held,
        points=np.vstack([one.points, other.points + 1.0]),
        translations=np.vstack([one.translations, other.translations + len(one.rigid)]),
        part_stiffness={
            "foot": csr_array(block_diag([one.stiffness, zero[1]])),
            "bolt": csr_array(block_diag([zero[0], other.stiffness])),
        },
    )
    with pytest.raises(
        CheckFailed, match=r"1 body is not connected.*36 degrees of freedom of part bolt near \(1000.0, 1000.0, 1000.0\)"
    ):
        fixed_base(apart, 5)


def test_a_structure_that_nothing_holds_fails(block: Block) -> None:
    with pytest.raises(CheckFailed, match="not connected to the base"):
        fixed_base(replace(block(2, 2, 2), held=np.array([], dtype=np.intp)), 5)


@pytest.mark.parametrize("size", [(3, 3, 3), (6, 6, 7)])
def test_a_structure_that_swings_freely_fails(size: tuple[int, int, int], block: Block) -> None:
    """Held at one point only it turns about it; LAPACK's and Lanczos' way must both say so."""
    with pytest.raises(CheckFailed, match=r"floats freely|zero frequency"):
        fixed_base(replace(block(*size), held=np.arange(3)), 5)


@pytest.mark.fast("pardiso")
def test_the_factoriser_does_not_show_in_the_modes(block: Block) -> None:
    structure = block(5, 5, 8)
    one, other = (fixed_base(structure, 20, factoriser=name) for name in ("superlu", "pardiso"))
    assert_allclose(other.frequency, one.frequency, rtol=1e-10)
    assert_allclose(other.residual, one.residual, rtol=0, atol=1e-9 * np.abs(one.residual).max())
