"""The lowest modes, none missed; participation and residual; factorisers solve, refuse, and foresee their memory."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigvalsh
from scipy.sparse import block_diag, csc_array, csr_array, diags_array, eye_array, kron
from scipy.sparse.linalg import splu

from fem import factorisers, modes
from fem.modes import fixed_base, lowest
from fem.structure import Structure, hold
from geometry.errors import BadInput, CheckFailed

Block = Callable[..., Structure]


@pytest.mark.parametrize(
    "name", ["superlu", *(pytest.param(name, marks=pytest.mark.fast(name)) for name in factorisers.NAMES if name != "superlu")]
)
def test_lanczos_and_lapack_agree_with_every_factoriser(name: str, block: Block) -> None:
    held = hold(block(6, 5, 7))
    found = lowest(held.stiffness, held.mass, 30, factoriser=name)
    assert found.factor is not None
    assert_allclose(found.values, eigvalsh(held.stiffness.toarray(), held.mass.toarray())[:30], rtol=1e-9)


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


def test_mass_that_is_taken_away_where_there_is_less_costs_no_more_solutions_than_mass_that_is_there(block: Block) -> None:
    held, solved = hold(block(6, 5, 7)), list[int]()
    place = np.zeros(len(held.free))
    place[100:103] = -5 * held.mass.diagonal()[100:103]
    for mass in (held.mass, csr_array(held.mass + diags_array(place))):
        asked = list[int]()
        found = lowest(held.stiffness, mass, 30, progress=asked.append)
        theta = eigvalsh(mass.toarray(), held.stiffness.toarray())
        assert_allclose(found.values, 1 / theta[::-1][:30], rtol=1e-8)
        assert_allclose(found.vectors.T @ (mass @ found.vectors), np.eye(30), atol=1e-8)
        solved.append(len(asked))
    assert theta[0] < 0
    assert solved[1] < 1.5 * solved[0]


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


@pytest.mark.parametrize("size", [(2, 2, 2), (6, 6, 7)])
def test_a_structure_that_nothing_holds_has_its_rigid_motions_first(size: tuple[int, int, int], block: Block) -> None:
    """They carry all of its mass, the elastic modes none; the others are those of K and M themselves."""
    structure = replace(block(*size), held=np.array([], dtype=np.intp))
    found = fixed_base(structure, 10)
    squares = eigvalsh(structure.stiffness.toarray(), structure.mass.toarray())[6:10]
    assert_allclose(found.frequency[:6], 0, atol=0)
    assert_allclose(found.frequency[6:], np.sqrt(squares) / (2 * np.pi), rtol=1e-8)
    M = structure.rigid_mass
    assert_allclose(found.participation[:, :6] @ found.participation[:, :6].T, M, rtol=0, atol=1e-9 * M.max())
    assert_allclose(found.participation[:, 6:], 0, atol=1e-6 * np.sqrt(M.max()))
    assert_allclose(found.shapes.T @ (structure.mass @ found.shapes), np.eye(10), atol=1e-9)


def test_a_free_structure_of_two_bodies_fails(block: Block) -> None:
    one = block(2, 2, 2)
    apart = replace(
        one,
        stiffness=csr_array(block_diag([one.stiffness, one.stiffness])),
        mass=csr_array(block_diag([one.mass, one.mass])),
        rigid=np.vstack([one.rigid, one.rigid]),
        held=np.array([], dtype=np.intp),
    )
    with pytest.raises(CheckFailed, match="Beside its rigid motions, 2 modes have zero frequency"):
        fixed_base(apart, 8)


@pytest.mark.parametrize("size", [(3, 3, 3), (6, 6, 7)])
def test_a_structure_that_swings_freely_fails(size: tuple[int, int, int], block: Block) -> None:
    """Held at one point only it turns about it; LAPACK's and Lanczos' way must both say so."""
    with pytest.raises(CheckFailed, match=r"floats freely|zero frequency"):
        fixed_base(replace(block(*size), held=np.arange(3)), 5)


OPTIONAL = [pytest.param(name, marks=pytest.mark.fast(name)) for name in factorisers.NAMES if name != "superlu"]


@pytest.mark.parametrize("name", ["superlu", *OPTIONAL])
@pytest.mark.parametrize("kind", ["definite", "indefinite", "complex"])
def test_every_factoriser_solves_or_says_that_it_cannot(name: str, kind: str, block: Block) -> None:
    held = hold(block(5, 5, 5))
    inside = 1.5 * np.linalg.eigvalsh(held.stiffness.toarray())[3] / 0.1  # between eigenvalues of this matrix
    A = {
        "definite": held.stiffness,
        "indefinite": held.stiffness - inside * held.mass,
        "complex": held.stiffness * (1 + 0.1j) - inside * held.mass,
    }[kind]
    B = np.random.default_rng(0).standard_normal((A.shape[0], 3)).astype(A.dtype)
    if name == "cholmod" and kind != "definite":
        with pytest.raises(BadInput, match="Use superlu or pardiso"):
            factorisers.factorise(A, name=name)
        return
    factor = factorisers.factorise(A, definite=kind == "definite", name=name)
    assert factor.name == name
    assert_allclose(A @ factor.solve(B), B, rtol=0, atol=1e-9)
    assert_allclose(A @ factor.solve(B[:, 0]), B[:, 0], rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", OPTIONAL)
def test_a_broken_promise_of_definiteness_is_noticed(name: str, block: Block) -> None:
    held = hold(block(5, 5, 5))
    with pytest.raises(factorisers.Singular):
        factorisers.factorise(held.stiffness - 1e6 * held.mass, definite=True, name=name)


def test_a_singular_matrix_has_no_factors() -> None:
    with pytest.raises(factorisers.Singular):
        factorisers.factorise(csc_array((np.array([1.0]), (np.array([0]), np.array([0]))), shape=(2, 2)))


def test_unknown_and_missing_factorisers_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    one = eye_array(3, format="csc")
    with pytest.raises(BadInput, match="Did you mean pardiso"):
        factorisers.factorise(one, name="pardisso")
    monkeypatch.setattr(factorisers, "find_spec", lambda library: None if library == "kvxopt" else object())
    with pytest.raises(BadInput, match=r"Install massline\[fast\]"):
        factorisers.factorise(one, definite=True, name="cholmod")


def test_the_best_that_is_installed_is_picked(monkeypatch: pytest.MonkeyPatch) -> None:
    large = eye_array(factorisers.SMALL + 1, format="csc")
    assert factorisers.choose(eye_array(10), True) == "superlu"  # small: no library is worth loading
    for there, definite, expected in (
        (("superlu", "cholmod", "pardiso"), True, "pardiso"),
        (("superlu", "cholmod"), True, "cholmod"),
        (("superlu", "cholmod"), False, "superlu"),
        (("superlu",), True, "superlu"),
    ):
        monkeypatch.setattr(factorisers, "installed", lambda there=there: there)
        assert factorisers.choose(large, definite) == expected


@pytest.mark.parametrize("shape", [(6, 6, 60), (40, 30, 3), (13, 13, 13), (4, 4, 200), (45, 45, 2)])
def test_the_fill_is_foreseen_to_a_factor_of_1_4(shape: tuple[int, int, int]) -> None:
    """Bars, plates and a block in the pattern of eight-noded hexahedra, against what SuperLU fills."""
    one = [diags_array([np.ones(n - 1), np.ones(n), np.ones(n - 1)], offsets=[-1, 0, 1]) for n in shape]
    pattern = kron(kron(kron(one[0], one[1]), one[2]), np.ones((3, 3)), format="csc")
    K = csc_array(pattern + 100 * eye_array(pattern.shape[0]))
    lu = splu(K, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=1e-3, options={"SymmetricMode": True})
    assert 1 / 1.4 < factorisers.predicted_entries(K) / lu.L.nnz < 1.4


def test_factors_that_would_not_fit_are_refused_with_the_way_out(monkeypatch: pytest.MonkeyPatch, block: Block) -> None:
    K = hold(block(16, 16, 16)).stiffness
    assert K.shape[0] > factorisers.SMALL
    needed = factorisers.predicted_bytes(K, "superlu")
    monkeypatch.setattr(factorisers, "available", lambda: needed)  # nine tenths of it may be used
    with pytest.raises(BadInput, match=r"coarser mesh.*pardiso") as refused:
        factorisers.factorise(K, definite=True, name="superlu")
    assert "11520 degrees of freedom would need about" in refused.value.problem
    monkeypatch.setattr(factorisers, "available", lambda: 1.2 * needed)
    factorisers.require_memory(K, "superlu")


def test_memory_of_this_machine_is_known_or_nobody_asks(monkeypatch: pytest.MonkeyPatch, block: Block) -> None:
    free = factorisers.available()
    assert free is None or free > 0
    monkeypatch.setattr(factorisers, "available", lambda: None)
    factorisers.require_memory(hold(block(4, 4, 4)).stiffness, "superlu")
