"""The lowest modes: both methods agree, none is missed, floating bodies have their six rigid motions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigvalsh
from scipy.sparse import block_diag, csc_array, csr_array, diags_array

from fem import factorisers, modes
from fem.modes import largest_left, lowest
from fem.structure import Structure, hold
from geometry.errors import CheckFailed

Block = Callable[..., Structure]


@pytest.mark.parametrize(
    "name", ["superlu", *(pytest.param(name, marks=pytest.mark.fast(name)) for name in factorisers.NAMES if name != "superlu")]
)
def test_lanczos_and_lapack_agree_with_every_factoriser(name: str, block: Block) -> None:
    held = hold(block(6, 5, 7))
    found = lowest(held.stiffness, held.mass, 30, factoriser=name)
    assert found.factor is not None
    assert_allclose(found.values, eigvalsh(held.stiffness.toarray(), held.mass.toarray())[:30], rtol=1e-9)


@pytest.mark.parametrize("size", [(4, 4, 4), (6, 6, 7)])
def test_vectors_are_mass_normalised_and_decouple_the_stiffness(size: tuple[int, int, int], block: Block) -> None:
    held = hold(block(*size))
    pairs = lowest(held.stiffness, held.mass, 20)
    assert_allclose(pairs.vectors.T @ held.mass @ pairs.vectors, np.eye(20), atol=1e-10)
    squares = pairs.vectors.T @ held.stiffness @ pairs.vectors
    assert_allclose(squares, np.diag(pairs.values), atol=1e-10 * pairs.values[-1])


def test_the_same_call_gives_the_same_modes_with_the_same_signs(block: Block) -> None:
    held = hold(block(6, 6, 6))
    one, two = (lowest(held.stiffness, held.mass, 15) for _ in range(2))
    assert np.array_equal(one.values, two.values)
    assert np.array_equal(one.vectors, two.vectors)
    assert np.all(one.vectors[np.abs(one.vectors).argmax(axis=0), np.arange(15)] > 0)


def test_equal_frequencies_of_two_equal_bodies_are_all_found(block: Block) -> None:
    """The square section has pairs of equal frequencies already: here every one comes four times."""
    held = hold(block(5, 5, 6))
    K, M = (csr_array(block_diag([matrix, matrix])) for matrix in (held.stiffness, held.mass))
    expected = np.sort(np.repeat(eigvalsh(held.stiffness.toarray(), held.mass.toarray())[:12], 2))
    assert_allclose(lowest(K, M, 24).values, expected, rtol=1e-9)


@pytest.mark.parametrize("left_out", [0, 3, 10])
def test_the_search_sees_a_mode_that_was_left_out(left_out: int, block: Block) -> None:
    held = hold(block(6, 6, 6))
    pairs = lowest(held.stiffness, held.mass, 20)
    thinned = np.delete(pairs.vectors, left_out, axis=1)
    assert largest_left(held.mass, thinned, pairs.factor.solve) == pytest.approx(1 / pairs.values[left_out], rel=1e-2)
    assert largest_left(held.mass, pairs.vectors, pairs.factor.solve) < modes.MISSED / pairs.values[-1]


def test_a_missed_mode_fails_the_run(block: Block, monkeypatch: pytest.MonkeyPatch) -> None:
    held = hold(block(6, 6, 6))
    monkeypatch.setattr("scipy.sparse.linalg.eigsh", _forgetful(held.stiffness, held.mass))
    with pytest.raises(CheckFailed, match="missed a mode near"):
        lowest(held.stiffness, held.mass, 10)


def _forgetful(K: csc_array, M: csc_array) -> Callable[..., tuple[np.ndarray, np.ndarray]]:
    pairs = lowest(K, M, 11)
    return lambda *_, **__: (np.delete(pairs.values, 4), np.delete(pairs.vectors, 4, axis=1))


@pytest.mark.parametrize("size", [(3, 4, 5), (6, 6, 7)])
def test_a_floating_body_has_six_rigid_motions_and_then_its_own(size: tuple[int, int, int], block: Block) -> None:
    body = block(*size)
    K, M = csc_array(body.stiffness), csc_array(body.mass)
    pairs = lowest(K, M, 12, shift=modes.floating_shift(K, M))
    assert_allclose(pairs.values[:6], 0, atol=1e-9 * pairs.values[6])
    assert_allclose(pairs.values[6:], eigvalsh(K.toarray(), M.toarray())[6:12], rtol=1e-7)
    inside, *_ = np.linalg.lstsq(body.rigid, pairs.vectors[:, :6], rcond=None)
    assert_allclose(body.rigid @ inside, pairs.vectors[:, :6], atol=1e-6 * np.abs(pairs.vectors).max())


def test_scaling_the_units_scales_the_frequencies(block: Block) -> None:
    """Millimetres, tonnes: K and M in other units give the squares in their ratio and the same vectors but for a factor."""
    held = hold(block(6, 6, 6))
    one, other = lowest(held.stiffness, held.mass, 12), lowest(1e-3 * held.stiffness, 1e-6 * held.mass, 12)
    assert_allclose(other.values, 1e3 * one.values, rtol=1e-10)


@pytest.mark.parametrize("size", [(3, 3, 4), (6, 6, 6)])
def test_directions_without_mass_have_no_mode(size: tuple[int, int, int], block: Block) -> None:
    held = hold(block(*size))
    heavy = np.ones(held.mass.shape[0])
    heavy[::5] = 0.0
    M = csc_array(diags_array(heavy))
    K = held.stiffness.toarray()
    r, m = np.flatnonzero(heavy), np.flatnonzero(heavy == 0)
    condensed = K[np.ix_(r, r)] - K[np.ix_(r, m)] @ np.linalg.solve(K[np.ix_(m, m)], K[np.ix_(m, r)])
    assert_allclose(lowest(held.stiffness, M, 10).values, np.linalg.eigvalsh(condensed)[:10], rtol=1e-8)


def test_asked_for_more_than_there_are_it_gives_what_there_is(block: Block) -> None:
    held = hold(replace(block(2, 2, 2)))
    assert lowest(held.stiffness, held.mass, 99).values.size == held.mass.shape[0]


def test_the_hook_counts_and_may_stop_the_iteration(block: Block) -> None:
    held = hold(block(6, 6, 6))
    counted: list[int] = []
    lowest(held.stiffness, held.mass, 5, progress=counted.append)
    assert counted == list(range(1, len(counted) + 1))

    def interrupt(solved: int) -> None:
        if solved == 7:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        lowest(held.stiffness, held.mass, 5, progress=interrupt)
    assert lowest(held.stiffness, held.mass, 5).values.size == 5  # and leaves nothing behind
