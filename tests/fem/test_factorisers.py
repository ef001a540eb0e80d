"""Factorisers solve what they are given, refuse what they cannot serve, and their memory is foreseen."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.sparse import csc_array, diags_array, eye_array, kron
from scipy.sparse.linalg import splu

from fem import factorisers
from fem.structure import Structure, hold
from geometry.errors import BadInput

Block = Callable[..., Structure]

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


def test_fill_of_a_chain_and_of_a_full_matrix_is_known() -> None:
    chain = diags_array([np.ones(999), np.ones(1000), np.ones(999)], offsets=[-1, 0, 1], format="csr")
    assert 2000 < factorisers.predicted_entries(chain) < 2000 * 12  # small pieces count as dense by half
    assert factorisers.predicted_entries(csc_array(np.ones((100, 100)))) == pytest.approx(100 * 101 / 2, rel=0.65)  # one piece


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
