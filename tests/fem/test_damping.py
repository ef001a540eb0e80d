"""Damping in all its forms: what it means in the modes, and what is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.sparse import csr_array

from fem import damping
from fem.beam import articles
from fem.damping import Damping
from fem.modes import fixed_base
from fem.structure import Structure
from geometry.errors import BadInput


def pair(second: float = 1.0) -> Structure:
    """Two masses of 1 kg along x, each on its own spring [1e4 N/m] to the base: part a, and b `second` times as stiff."""
    K = {"a": np.zeros((3, 3)), "b": np.zeros((3, 3))}
    for name, k, dof in (("a", 1e4, 1), ("b", second * 1e4, 2)):
        K[name][np.ix_([0, dof], [0, dof])] = k * np.array([[1, -1], [-1, 1]])
    parts = {name: csr_array(matrix) for name, matrix in K.items()}
    rigid = np.zeros((3, 6))
    rigid[:, 0] = 1.0
    mass = csr_array(np.diag([0.5, 1.0, 1.0]))
    return Structure(stiffness=sum(parts.values()), mass=mass, rigid=rigid, held=np.array([0]), part_stiffness=parts)


def test_a_ratio_is_the_ratio_of_every_mode() -> None:
    modes = fixed_base(pair(2.0), 2, damping=Damping(ratio=[0.01, 0.03]))
    assert_allclose(modes.damping_ratio, [0.01, 0.03])
    assert_allclose(modes.viscous, np.diag(2 * np.array([0.01, 0.03]) * 2 * np.pi * modes.frequency))
    assert not np.any(modes.structural)


def test_a_loss_factor_of_all_parts_is_half_of_it_as_a_ratio() -> None:
    modes = fixed_base(pair(2.0), 2, damping=Damping(loss_factors={"a": 0.02, "b": 0.02}))
    assert_allclose(modes.damping_ratio, 0.01)
    assert_allclose(modes.structural, 0.02 * np.diag((2 * np.pi * modes.frequency) ** 2), rtol=1e-12, atol=1e-9)


def test_each_part_damps_its_own_mode() -> None:
    modes = fixed_base(pair(2.0), 2, damping=Damping(loss_factors={"a": 0.1}))
    assert_allclose(modes.damping_ratio, [0.05, 0.0], atol=1e-15)


def test_off_diagonal_entries_stay() -> None:
    """The silicone of the short blade couples modes: entries beside the diagonal reach the geometric mean of those on it."""
    S = fixed_base(articles.structure("clumod-4"), 10).structural
    coupling = np.abs(S) / np.sqrt(np.outer(np.diag(S), np.diag(S)))
    assert (coupling - np.eye(10)).max() > 0.5


def test_forms_add() -> None:
    one = pair(2.0)
    C = csr_array(np.array([[3.0, -1, -2], [-1, 1, 0], [-2, 0, 2]]))
    together = fixed_base(one, 2, damping=Damping(ratio=0.01, modal=np.eye(2), viscous=C, loss_factors={"b": 0.1}))
    parts = (Damping(ratio=0.01), Damping(modal=np.eye(2)), Damping(viscous=C), Damping(loss_factors={"b": 0.1}))
    alone = [fixed_base(one, 2, damping=part) for part in parts]
    assert_allclose(together.viscous, sum(modes.viscous for modes in alone), rtol=1e-12)
    assert_allclose(together.structural, sum(modes.structural for modes in alone), rtol=1e-12)
    assert_allclose(alone[2].viscous, np.diag([1.0, 2.0]), atol=1e-12)  # the dashpots act alone on the masses they sit on
    assert_allclose(together.damping_ratio, sum(modes.damping_ratio for modes in alone), rtol=1e-12)


def test_what_the_structure_brings_is_the_default() -> None:
    bare = pair()
    assert_allclose(fixed_base(bare, 2).damping_ratio, damping.DEFAULT_RATIO)
    assert_allclose(fixed_base(replace(bare, loss_factors={"a": 0.1, "b": 0.1}), 2).damping_ratio, 0.05)


@pytest.mark.parametrize("ratio", [-0.001, 1.0, 1.5, float("nan"), [0.01, 1.0]])
def test_a_ratio_below_zero_or_from_one_is_refused(ratio: object) -> None:
    with pytest.raises(BadInput, match="at least 0 and below 1") as refused:
        Damping(ratio=ratio)
    assert refused.value.field == "ratio"


@pytest.mark.parametrize("eta", [-0.1, 2.0, float("nan")])
def test_a_loss_factor_out_of_bounds_is_refused(eta: float) -> None:
    with pytest.raises(BadInput, match="below 2"):
        Damping(loss_factors={"silicone": eta})


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"ratio": [0.01] * 3}, "one for each of the 2 modes is needed, found 3"),
        ({"modal": np.eye(3)}, "each of the 2 modes, found"),
        ({"viscous": csr_array(np.eye(4))}, "as large as the structure's matrices"),
        ({"loss_factors": {"c": 0.1}}, "has no part 'c'.*parts are a, b"),
    ],
)
def test_the_wrong_size_is_refused(given: dict[str, object], words: str) -> None:
    with pytest.raises(BadInput, match=words):
        fixed_base(pair(), 2, damping=Damping(**given))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"ratio": np.eye(2)}, "Use `modal`"),
        ({"modal": [[1.0, 2.0], [0.0, 1.0]]}, "must be symmetric"),
        ({"modal": [[1.0, 2.0], [2.0, 1.0]]}, "not feed energy in"),
        ({"modal": [1.0, 2.0]}, "square matrix"),
        ({"modal": [[np.inf]]}, "finite"),
        ({"viscous": csr_array([[1.0, 2.0], [0.0, 1.0]])}, "must be symmetric"),
        ({"viscous": csr_array([[-1.0, 0.0], [0.0, 1.0]])}, "not feed energy in"),
        ({"viscous": csr_array((2, 3))}, "square sparse matrix"),
    ],
)
def test_matrices_that_are_no_damping_are_refused(given: dict[str, object], words: str) -> None:
    with pytest.raises(BadInput, match=words):
        Damping(**given)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"viscous": csr_array(3e-2 * pair().stiffness)}, r"`viscous`.*damping ratio 1\.5 for mode 1 at 15\.92 Hz"),
        ({"viscous": csr_array(1e-2 * pair().stiffness), "ratio": 0.6}, "damping ratio 1.1 for mode 1"),
        ({"loss_factors": {"a": 1.5}, "ratio": 0.5}, "`structural`.*damping ratio 1.25"),
    ],
)
def test_a_mode_that_would_not_swing_is_refused(given: dict[str, object], words: str) -> None:
    """k = 1e4 N/m on 1 kg is 100 rad/s: C = b K has the ratio 50 b."""
    with pytest.raises(BadInput, match=words):
        fixed_base(pair(), 2, damping=Damping(**given))


def test_a_matrix_whose_diagonal_hides_that_it_feeds_energy_in_is_refused() -> None:
    hidden = np.array([[2.0, -1, -1], [-1, 1, -2], [-1, -2, 1]])  # of the two masses: eigenvalues 3 and -1
    with pytest.raises(BadInput, match=r"`viscous`.*feed energy in.*loss factor -0.01"):
        fixed_base(pair(), 2, damping=Damping(viscous=csr_array(hidden)))
    turned = replace(pair(), part_stiffness={"a": csr_array(1e4 * hidden)})
    with pytest.raises(BadInput, match=r"`structural`.*feed energy in.*loss factor -0.1"):
        fixed_base(turned, 2, damping=Damping(loss_factors={"a": 0.1}))


def test_a_dashpot_between_two_masses_is_none_of_these() -> None:
    """Its matrix is singular: one of the motions loses nothing, and rounding decides the sign."""
    between = csr_array(np.array([[0.0, 0, 0], [0, 7, -7], [0, -7, 7]]))
    assert_allclose(np.trace(fixed_base(pair(2.0), 2, damping=Damping(viscous=between)).viscous), 14.0, rtol=1e-12)
