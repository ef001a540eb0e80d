"""The dynamic mass from modes against direct solution, pyyeti, and what it must be; damping in all its forms."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.sparse import csr_array

from fem import damping, dynamic_mass
from fem import modes as fem_modes
from fem.beam import articles
from fem.damping import Damping
from fem.modes import Modes, craig_bampton, fixed_base, with_damping
from fem.structure import Structure, rigid_motion
from geometry.dynamic_mass import DynamicMass
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array, rigid_transformation_6
from geometry.inertia import Inertia

BAND = np.linspace(4.0, 32.0, 15)


@cache
def clumod() -> Structure:
    return articles.structure("clumod-4")


@cache
def clumod_modes() -> Modes:
    return fixed_base(clumod(), 30)


def error(found: DynamicMass, expected: DynamicMass, rigid: Array) -> Array:
    """Largest deviation at every line, each entry in units of the rigid body's."""
    scale = np.sqrt(np.outer(np.diag(rigid), np.diag(rigid)))
    return np.asarray((np.abs(found.matrix - expected.matrix) / scale).max(axis=(1, 2)))


def chain(masses: Array, springs: Array, spacing: float = 0.1) -> Structure:
    """Rigid cubes on the base and on each other, six springs from each to the next at its own place: springs (n, 6)."""
    n = len(masses)
    points = np.column_stack([np.zeros((n + 1, 2)), spacing * np.arange(n + 1)])
    K, M = np.zeros((2, 6 * n + 6, 6 * n + 6))
    for k in range(n):
        arm = rigid_transformation_6(points[k + 1] - points[k])  # the lower body carried to the upper one
        stretch = np.hstack([-arm, np.eye(6)])
        place = slice(6 * k, 6 * k + 12)
        K[place, place] += stretch.T @ np.diag(springs[k]) @ stretch
        body = slice(6 * k + 6, 6 * k + 12)
        M[body, body] += np.diag([masses[k]] * 3 + [1e-3 * masses[k]] * 3)
    return Structure(stiffness=csr_array(K), mass=csr_array(M), rigid=rigid_motion(points), held=np.arange(6))


@pytest.mark.parametrize("per_part", [True, False])
def test_thirty_modes_with_residual_are_within_1e_4_of_a_direct_solution(per_part: bool) -> None:
    damping = None if per_part else Damping(ratio=0.003)
    modes = fixed_base(clumod(), 30, damping=damping)
    exact = dynamic_mass.direct(clumod(), BAND, damping, modes=modes)
    assert clumod().mass.shape[0] > 10 * 30
    assert error(dynamic_mass.modal(modes, BAND), exact, modes.rigid_mass).max() < 1e-4


@pytest.mark.parametrize(("residual", "power"), [(False, 2), (True, 4)])
def test_the_truncation_error_grows_with_its_power_of_frequency(residual: bool, power: int) -> None:
    lines = np.array([17.0, 20.0, 24.0, 28.0, 32.0])  # above the cluster, where rounding of its poles drowns the small error
    damping = Damping(ratio=0.003)
    modes = fixed_base(clumod(), 30, damping=damping)
    exact = dynamic_mass.direct(clumod(), lines, damping, modes=modes)
    found = error(dynamic_mass.modal(modes, lines, residual=residual), exact, modes.rigid_mass)
    slope = np.polyfit(np.log(lines), np.log(found), 1)[0]
    assert slope == pytest.approx(power, abs=0.25)  # the next modes, at 76 Hz and above, steepen it a little


def test_a_lossy_layer_needs_the_truncated_modes_condensed_with_it() -> None:
    """Without it the truncated modes do not give way to the silicone: the error at the cluster is fifty times larger."""
    lines = np.array([12.0, 14.0, 16.0])
    modes, exact = clumod_modes(), dynamic_mass.direct(clumod(), np.array([12.0, 14.0, 16.0]))
    with_it, without = (dynamic_mass.modal(m, lines) for m in (modes, replace(modes, condensed=None)))
    assert error(without, exact, modes.rigid_mass).max() > 50 * error(with_it, exact, modes.rigid_mass).max()


def test_the_series_with_real_factors_is_the_complex_solution(monkeypatch: pytest.MonkeyPatch) -> None:
    """Large structures take the series; here it is forced on a small one."""
    complex_solution = clumod_modes().condensed
    monkeypatch.setattr(fem_modes, "FEW", 0)
    series = with_damping(replace(clumod_modes(), condensed=None), clumod()).condensed
    assert complex_solution is not None
    assert series is not None
    for name in ("stiffness", "participation", "residual"):
        expected = getattr(complex_solution, name)
        assert_allclose(getattr(series, name), expected, rtol=0, atol=1e-7 * np.abs(expected).max())


def test_it_is_symmetric_and_takes_energy_out() -> None:
    """Reciprocity: H = H^T. Power into the article is never negative: the imaginary part of -H is positive semi-definite."""
    H = dynamic_mass.modal(clumod_modes()).matrix
    assert_allclose(H, H.transpose(0, 2, 1), rtol=0, atol=1e-9 * np.abs(H).max())
    loss = np.linalg.eigvalsh(-H.imag)
    assert loss.min() > -1e-9 * np.abs(loss).max()


def test_a_rigid_block_answers_with_plus_its_mass() -> None:
    """f = +M a: the load is that of the table on the article."""
    block = Inertia.from_cog(12.0, [0.01, -0.02, 0.2], np.diag([0.2, 0.18, 0.05]))
    empty = csr_array((6, 6))
    structure = Structure(stiffness=empty, mass=csr_array(block.mass_matrix), rigid=np.eye(6), held=np.arange(6))
    modes = fixed_base(structure, 30)
    assert modes.frequency.size == 0
    expected = np.broadcast_to(block.mass_matrix, (561, 6, 6))
    assert_allclose(dynamic_mass.modal(modes).matrix, expected, rtol=1e-12, atol=1e-12)


def test_pyyeti_drives_the_same_base() -> None:
    """An independent peer: pyyeti's base-driven solution of our Craig-Bampton matrices, damping per part and off-diagonal."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        from pyyeti import cb
    r = craig_bampton(clumod_modes(), clumod().rigid)
    found = dynamic_mass.modal(clumod_modes(), BAND, residual=False).matrix
    K = r.stiffness + 1j * r.structural
    peer = np.array([cb.cbtf(r.mass, r.viscous, K, row, BAND, np.arange(6)).frc for row in np.eye(6)])  # axis, load, line
    assert_allclose(found, peer.transpose(2, 1, 0), rtol=0, atol=1e-9 * np.abs(found).max())


def test_one_mass_on_a_spring_is_the_textbook_formula() -> None:
    m, k, zeta = 2.0, 2.0 * (2 * np.pi * 10) ** 2, 0.02
    structure = chain(np.array([m]), np.full((1, 6), k))
    lines = np.array([3.0, 9.5, 10.0, 10.5, 40.0])
    H = dynamic_mass.modal(fixed_base(structure, 6, damping=Damping(ratio=zeta)), lines).matrix[
        :, 2, 2
    ]  # along z nothing couples
    r = lines / 10.0
    assert_allclose(H, m * (1 + 2j * zeta * r) / (1 - r**2 + 2j * zeta * r), rtol=1e-9)


@settings(max_examples=15)
@given(
    masses=st.lists(st.floats(0.5, 5.0), min_size=2, max_size=4),
    stiffness=st.floats(1e3, 1e5),
    ratio=st.floats(0.001, 0.2),
    seed=st.integers(0, 2**16),
)
def test_all_modes_of_any_chain_equal_its_direct_solution(masses: list[float], stiffness: float, ratio: float, seed: int) -> None:
    """All modes are kept, so nothing is truncated, with ratios, a full modal matrix and a dashpot to the neighbour together."""
    rng, n = np.random.default_rng(seed), len(masses)
    structure = chain(np.array(masses), stiffness * rng.uniform(0.5, 2.0, (n, 6)) * np.array([1, 1, 1, 0.01, 0.01, 0.01]))
    root = rng.standard_normal((6 * n, 6 * n))
    damping = Damping(ratio=ratio, modal=0.1 * root @ root.T, viscous=1e-4 * structure.stiffness)
    modes = fixed_base(structure, 6 * n, damping=damping)
    lines = np.linspace(1.0, 60.0, 7)
    found, exact = dynamic_mass.modal(modes, lines), dynamic_mass.direct(structure, lines, damping, modes=modes)
    assert_allclose(found.matrix, exact.matrix, rtol=0, atol=1e-8 * np.abs(exact.matrix).max())
    assert_allclose(modes.residual, 0, atol=1e-9 * modes.rigid_mass.max() / (2 * np.pi * modes.frequency[0]) ** 2)
    assert np.linalg.eigvalsh(-found.matrix.imag).min() > -1e-9 * np.abs(found.matrix).max()


def test_a_line_on_an_undamped_mode_is_refused() -> None:
    structure = chain(np.array([1.0]), np.full((1, 6), 1e4))
    modes = fixed_base(structure, 6, damping=Damping(ratio=0.0))
    with pytest.raises(CheckFailed, match="undamped mode"):
        dynamic_mass.modal(modes, [modes.frequency[-1]])


def test_direct_solution_with_ratios_asks_for_the_modes() -> None:
    with pytest.raises(ValueError, match="`modes` are needed"):
        dynamic_mass.direct(chain(np.ones(1), np.full((1, 6), 1e4)), [5.0], Damping(ratio=0.01))


def test_damping_that_the_structure_does_not_know_is_refused() -> None:
    with pytest.raises(BadInput, match="Did you mean mast"):
        fixed_base(clumod(), 5, damping=Damping(loss_factors={"masd": 0.1}))


def test_reduced_matrices_are_the_full_ones_seen_through_the_basis(block: Callable[..., Structure]) -> None:
    structure = block(4, 4, 5)
    r = craig_bampton(fixed_base(structure, 12), structure.rigid)
    V = r.expand(np.eye(18))
    for full, small in ((structure.mass, r.mass), (structure.stiffness, r.stiffness)):
        assert_allclose(V.T @ full @ V, small, rtol=0, atol=1e-9 * np.abs(small).max())
    assert_allclose(V[:, :6], structure.rigid)  # coordinates of the base move everything rigidly


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


def test_each_part_damps_its_own_mode() -> None:
    modes = fixed_base(pair(2.0), 2, damping=Damping(loss_factors={"a": 0.1}))
    assert_allclose(modes.damping_ratio, [0.05, 0.0], atol=1e-15)


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
