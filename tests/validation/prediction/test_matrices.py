"""Reduced matrices of a structure, and what is measured of them."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from fem.beam import articles
from fem.damping import Damping
from fem.dynamic_mass import direct
from fem.dynamic_mass import modal as by_modes
from fem.modes import Modes, fixed_base
from fem.structure import Structure
from geometry.articles import built_in, locations
from geometry.frames import Array, rigid_transformation_6
from geometry.inertia import Inertia
from geometry.routes import inertia
from validation.effects.stages import Matrices
from validation.prediction import dynamic_mass, mounting, points
from validation.prediction import structure as prediction_structure
from validation.prediction import tangents as prediction_tangents
from validation.prediction.effects import nuisances
from validation.prediction.tangents import FIELDS, Tangent, crossed, full, of_arrays, plus

LINES = np.linspace(4.0, 32.0, 57)
ARTICLES = ("clumod-1", "clumod-4", "disc+cuboid")
LOSSES, RATIO = None, Damping(ratio=0.003)

NOMINAL = 5e-6
"""Of the largest entry at any line, in units of the diagonals: as near as 30 modes and their static answers come."""

CHANGED = 1e-4
"""The same where a part is 10 % stiffer: without the answers to the parts' forces it is 2e-2."""


@cache
def structure(article: str) -> Structure:
    return articles.structure(article)


@cache
def modes(article: str, damping: Damping | None) -> Modes:
    return fixed_base(structure(article), 30, damping=damping)


@cache
def made(article: str, damping: Damping | None = None) -> Matrices:
    whole = built_in(article)
    places = locations(article)
    return prediction_structure.of_structure(
        structure(article), modes(article, damping), places, inertia(whole).cog, damping=damping, article=whole
    )


def apart(found: Array, truth: Array) -> float:
    """Largest difference at any line, each entry in units of what the diagonals reach in the band."""
    size = np.sqrt(np.abs(np.einsum("nii->ni", truth)).max(axis=0))
    return float(np.abs((found - truth) / np.outer(size, size)).max())


@pytest.mark.parametrize("damping", [LOSSES, RATIO], ids=["losses", "ratio"])
@pytest.mark.parametrize("article", ARTICLES)
def test_the_dynamic_mass_is_that_of_the_whole_structure(article, damping):
    found = dynamic_mass.dynamic_mass(made(article, damping), LINES).matrix
    assert apart(found, direct(structure(article), LINES, damping, modes=modes(article, damping)).matrix) < NOMINAL


def test_structural_damping_stays_structural_and_inertia_is_in_the_first_six_coordinates():
    m = made("clumod-4")
    assert not np.any(m.viscous)
    assert np.any(m.structural)
    assert not np.any(made("clumod-4", RATIO).structural)
    found = Inertia.from_mass_matrix(made("clumod-4").mass[:6, :6])
    np.testing.assert_allclose(found.mass, structure("clumod-4").rigid_mass[0, 0], rtol=1e-12)


@pytest.mark.parametrize("part", ["mast", "lower-1", "upper-short", "upper-short-silicone"])
def test_a_stiffer_part_is_what_the_stiffer_structure_is(part):
    m, whole = made("clumod-4"), structure("clumod-4")
    shares = {name: K * (1.1 if prediction_structure.sheet(name) == part else 1.0) for name, K in whole.part_stiffness.items()}
    stiffer = replace(whole, stiffness=sum(shares.values()), part_stiffness=shares)
    loss = next(eta for name, eta in whole.loss_factors.items() if prediction_structure.sheet(name) == part)
    share = 0.1 * m.parts[part]
    changed = replace(m, stiffness=m.stiffness + share, structural=m.structural + loss * share)
    truth = direct(stiffer, LINES).matrix
    assert apart(dynamic_mass.dynamic_mass(changed, LINES).matrix, truth) < CHANGED
    assert apart(dynamic_mass.dynamic_mass(m, LINES).matrix, truth) > 100 * CHANGED


@pytest.mark.parametrize("place", ["mast-top", "hub-3", "lower-1+"])
def test_a_mass_at_a_place_is_what_the_heavier_structure_is(place):
    from scipy.sparse import csr_array

    whole, at = structure("clumod-4"), locations("clumod-4")[place]
    node = int(np.argmin(np.linalg.norm(whole.points - at, axis=1)))
    np.testing.assert_allclose(whole.points[node], at, atol=1e-9)  # a node lies there, so the structure can bear the mass
    mass = whole.mass.toarray()
    mass[whole.translations[node], whole.translations[node]] += 0.5
    truth = direct(replace(whole, mass=csr_array(mass)), LINES).matrix
    m = made("clumod-4")
    phi = m.places[place]
    assert apart(dynamic_mass.dynamic_mass(replace(m, mass=m.mass + 0.5 * phi.T @ phi), LINES).matrix, truth) < CHANGED


def test_parts_share_the_whole_stiffness_and_a_rigid_body_is_its_mass_matrix():
    m = made("clumod-4")
    assert set(m.parts) == {"mast", "lower-1", "lower-2", "upper-long", "upper-short", "upper-short-silicone"}
    np.testing.assert_allclose(sum(m.parts.values()), m.stiffness, atol=1e-9 * np.abs(m.stiffness).max())
    body = inertia(built_in("cuboid"))
    m = mounting.of_inertia(body, {"top": [0.0, 0.0, 0.4]})
    found = dynamic_mass.dynamic_mass(m, LINES).matrix
    np.testing.assert_allclose(found, np.broadcast_to(body.about(np.zeros(3)).mass_matrix, found.shape), rtol=1e-14)
    np.testing.assert_allclose(m.places["top"] @ [0, 0, 0, 0, 1.0, 0], [0.4, 0, 0], atol=1e-15)
    np.testing.assert_allclose(m.cog, body.cog)


@pytest.mark.parametrize("damping", [LOSSES, RATIO], ids=["losses", "ratio"])
def test_modal_data_alone_answer_as_their_modes_and_residual_do(damping):
    bare = replace(modes("clumod-1", damping), shapes=np.zeros((0, 30)), condensed=None)
    found = dynamic_mass.dynamic_mass(mounting.of_modes(bare), LINES).matrix
    assert apart(found, by_modes(bare, LINES).matrix) < 1e-5  # carriers of R lie four times above the modes


def test_a_structure_about_another_point_is_the_same_about_the_origin():
    whole, point = structure("clumod-1"), np.array([0.1, -0.2, 0.3])
    moved = replace(whole, rigid=whole.rigid @ rigid_transformation_6(-point), reference_point=point)
    found = prediction_structure.of_structure(moved, fixed_base(moved, 30), locations("clumod-1"), article=built_in("clumod-1"))
    expected = dynamic_mass.dynamic_mass(made("clumod-1"), LINES).matrix
    assert apart(dynamic_mass.dynamic_mass(found, LINES).matrix, expected) < 1e-9


def test_a_model_twice_as_large_of_the_same_material_scales_and_modes_of_other_damping_are_refused():
    """Lengths x s: masses x s³, inertia x s⁵, frequencies / s; the axes of rotations count no length."""
    s, whole = 2.0, structure("clumod-1")
    found = prediction_structure.of_structure(
        scaled(whole, s), fixed_base(scaled(whole, s), 30), {"mast-top": s * locations("clumod-1")["mast-top"]}
    )
    length = np.repeat([1.0, s], 3)
    expected = s**3 * np.outer(length, length) * dynamic_mass.dynamic_mass(made("clumod-1"), LINES).matrix
    assert apart(dynamic_mass.dynamic_mass(found, LINES / s).matrix, expected) < NOMINAL
    with pytest.raises(ValueError, match="that of `modes`"):
        prediction_structure.of_structure(structure("clumod-1"), modes("clumod-1", RATIO))
    with pytest.raises(ValueError, match="shapes"):
        prediction_structure.of_structure(structure("clumod-1"), replace(modes("clumod-1", LOSSES), shapes=np.zeros((0, 30))))


def scaled(whole: Structure, s: float) -> Structure:
    """`whole` of `s` times the lengths, same modulus and density: K_tt x s, K_tr x s², K_rr x s³ and M x s² beside that."""
    from scipy.sparse import diags_array

    turns = np.ones(whole.mass.shape[0])
    turns[(whole.translations + 3).ravel()] = s
    turns[3:6] = s
    D, length = diags_array(turns), np.repeat([1.0, s], 3)
    parts = {name: s * D @ K @ D for name, K in whole.part_stiffness.items()}
    return replace(
        whole,
        stiffness=s * D @ whole.stiffness @ D,
        mass=s**3 * D @ whole.mass @ D,
        rigid=s * (whole.rigid / turns[:, None]) * length / s,
        points=s * whole.points,
        part_stiffness=parts,
    )


def test_a_held_structure_answers_a_force_as_the_whole_one_does(held):
    whole, at = structure("clumod-1"), locations("clumod-1")
    m = held(whole, at).matrices
    assert m.base == 0
    drive, *responses = (points.along(m, place, [1.0, 0.0, 0.0]) for place in ("mast-top", "mast-top", "hub-1"))
    found = dynamic_mass.accelerance(m, LINES, responses, drive).matrix
    truth = held_directly(whole, [at["mast-top"], at["hub-1"]], at["mast-top"])
    np.testing.assert_allclose(found[:, :, 0], truth, rtol=0, atol=1e-4 * np.abs(truth).max())  # of `LEFT_OUT`, which is 1e-3


def held_directly(whole: Structure, points: list[Array], drive: Array) -> Array:
    """(n, r) accelerations along x of all degrees of freedom of the structure, solved line by line."""
    free = whole.free
    K, M = (matrix.toarray()[np.ix_(free, free)] for matrix in (whole.stiffness, whole.mass))
    S = sum(whole.loss_factors[name] * share.toarray()[np.ix_(free, free)] for name, share in whole.part_stiffness.items())
    at = [
        int(np.flatnonzero(free == whole.translations[np.argmin(np.linalg.norm(whole.points - p, axis=1)), 0])[0])
        for p in (*points, drive)
    ]
    force = np.zeros(len(free))
    force[at[-1]] = 1.0
    omega = 2 * np.pi * LINES
    return np.array([(-(w**2) * np.linalg.solve(K + 1j * S - w**2 * M, force))[at[:-1]] for w in omega])


FEW_LINES = np.array([3.0, 9.0, 11.0, 40.0])
SIZE = 11

DIFFERENCE = 1e-7
"""Relative agreement with central differences of steps of 1e-5: their rounding."""


def drawn(base: int = 6) -> Matrices:
    generator = np.random.default_rng(5)

    def definite(scale: float) -> Array:
        A = generator.standard_normal((SIZE, SIZE))
        return scale * (A @ A.T + np.eye(SIZE))

    mass, K, C, S = definite(1.0), definite(4e3), definite(1.0), definite(10.0)
    for matrix in (K, C, S):
        matrix[:base] = matrix[:, :base] = 0.0
    return Matrices(
        base=base, mass=mass, stiffness=K, viscous=C, structural=S, places={"tip": generator.standard_normal((3, SIZE))}
    )


def changes(generator: np.random.Generator, at: Array) -> Tangent:
    fields = {}
    for name in FIELDS:
        change = np.zeros((SIZE, SIZE))
        block = generator.standard_normal((len(at), len(at)))
        change[np.ix_(at, at)] = block + block.T
        fields[name] = change
    return of_arrays(SIZE, **fields)


def moved(m: Matrices, change: Tangent, step: float) -> Matrices:
    return replace(m, **{name: getattr(m, name) + step * full(change, name, SIZE) for name in FIELDS})


@pytest.mark.parametrize("at", [[7, 9], [0, 8], list(range(SIZE))], ids=["own", "base", "all"])
def test_derivatives_of_the_dynamic_mass_are_its_differences(at):
    m, change = drawn(), changes(np.random.default_rng(1), np.array(at))
    found = dynamic_mass.transfer_tangents(dynamic_mass.dynamic_mass(m, FEW_LINES), {"one": change})["one"]
    above, below = (dynamic_mass.dynamic_mass(moved(m, change, step), FEW_LINES).matrix for step in (1e-5, -1e-5))
    np.testing.assert_allclose(found, (above - below) / 2e-5, rtol=0, atol=DIFFERENCE * np.abs(found).max())


@pytest.mark.parametrize("at", [[2, 9], list(range(SIZE))], ids=["few", "all"])
def test_derivatives_of_an_accelerance_are_its_differences(at):
    m, change = drawn(base=0), changes(np.random.default_rng(2), np.array(at))
    responses, drive = m.places["tip"], m.places["tip"][2]
    found = dynamic_mass.transfer_tangents(dynamic_mass.accelerance(m, FEW_LINES, responses, drive), {"one": change})["one"]
    assert found.shape == (len(FEW_LINES), 3, 1)
    above, below = (
        dynamic_mass.accelerance(moved(m, change, step), FEW_LINES, responses, drive).matrix for step in (1e-5, -1e-5)
    )
    np.testing.assert_allclose(found, (above - below) / 2e-5, rtol=0, atol=DIFFERENCE * np.abs(found).max())


def test_the_dynamic_mass_is_symmetric_and_solves_the_equations_of_motion():
    m = drawn()
    answered = dynamic_mass.dynamic_mass(m, FEW_LINES)
    np.testing.assert_allclose(answered.matrix, answered.matrix.transpose(0, 2, 1), rtol=1e-10, atol=1e-10)
    for k, w in enumerate(2 * np.pi * FEW_LINES):
        x = -answered.right[:, k] / w**2  # displacements for unit accelerations of the base
        loads = (m.stiffness + 1j * (w * m.viscous + m.structural) - w**2 * m.mass) @ x
        np.testing.assert_allclose(loads[:6], answered.matrix[k], rtol=0, atol=1e-9 * np.abs(answered.matrix).max())
        np.testing.assert_allclose(loads[6:], 0, atol=1e-9 * np.abs(answered.matrix).max())


@pytest.mark.parametrize("article", ["cuboid", "clumod-1", "clumod-4"])
def test_what_is_far_above_the_band_is_solved_at_few_lines_and_answers_at_all_of_them_as_if_at_each(article, monkeypatch):
    m = made(article, LOSSES)
    m = replace(m, viscous=1e-3 * m.structural)
    lines = np.linspace(4.0, 32.0, 5 * dynamic_mass.NODES)
    each = [dynamic_mass.dynamic_mass(m, [line]) for line in lines]  # of one line all is solved
    found = dynamic_mass.dynamic_mass(m, lines)
    for name, axis in (("matrix", 0), ("right", 1)):
        known = np.concatenate([getattr(one, name) for one in each], axis=axis)
        np.testing.assert_allclose(getattr(found, name), known, rtol=0, atol=1e-11 * np.abs(known).max())
    far, *_ = dynamic_mass.far_coordinates(m, 2 * np.pi * lines)
    assert len(far) > len(m.mass) / 2
    asked, whole = [], dynamic_mass.dynamic_matrix
    monkeypatch.setattr(dynamic_mass, "dynamic_matrix", lambda of, at, rows: asked.append((at, rows)) or whole(of, at, rows))
    dynamic_mass.dynamic_mass(m, lines)
    assert sum(len(at) for at, rows in asked if set(far) & set(rows)) == dynamic_mass.NODES + 1


def test_derivatives_are_made_of_few_directions_where_answers_lie_in_few(monkeypatch):
    generator, k = np.random.default_rng(4), 120
    hertz = np.concatenate([np.zeros(6), [8.0, 13.0, 21.0, 29.0], np.geomspace(70.0, 900.0, k - 10)])
    M, K = np.eye(k) + 0.02 * (mixed := generator.standard_normal((k, k))) @ mixed.T / 11, np.diag((2 * np.pi * hertz) ** 2)
    m = Matrices(base=6, mass=M, stiffness=K, viscous=0 * K, structural=0.02 * K, places={})
    lines = np.linspace(4.0, 32.0, 5 * dynamic_mass.NODES)
    answered = dynamic_mass.dynamic_mass(m, lines, generator.standard_normal((2, k)) * (hertz > 0))
    scale = 2 * np.pi * hertz
    each = [scale[:, None] * one * scale for one in generator.standard_normal((4, k, k))]
    changes = {f"{number}": of_arrays(k, stiffness=one + one.T) for number, one in enumerate(each)}
    due, sides = dynamic_mass.transfer_tangents(answered, changes), (answered.left, answered.right)
    few = prediction_tangents.along_few(*sides)
    assert max(len(along) for _, along in few) < 0.6 * k
    for name, change in dynamic_mass.transfer_tangents(answered, changes, few).items():
        np.testing.assert_allclose(change, due[name], rtol=0, atol=100 * prediction_tangents.FEW * np.abs(due[name]).max())
    monkeypatch.setattr(prediction_tangents, "SHOWN", 3)  # what they do not show is found out at the other lines
    assert not prediction_tangents.along_few(*sides)


@pytest.mark.parametrize("decay", [0.0, 0.4])
def test_what_all_coordinates_answer_to_any_place_takes_inverses_of_the_near_ones_alone_at_every_line(decay, monkeypatch):
    m = made("clumod-4", LOSSES)
    at = dynamic_mass.turning(np.linspace(4.0, 32.0, 5 * dynamic_mass.NODES), decay)
    row, b = np.random.default_rng(2).standard_normal((3, len(m.mass) - m.base)), m.base
    due = np.linalg.solve(dynamic_mass.dynamic_matrix(m, at)[:, b:, b:], np.broadcast_to(row.T, (len(at), *row.T.shape)))
    shapes, inverse = [], np.linalg.inv
    monkeypatch.setattr(np.linalg, "inv", lambda of: shapes.append(of.shape) or inverse(of))
    of_rows = dynamic_mass.answering(m, at)
    assert sum(np.prod(shape) for shape in shapes) < 0.5 * len(at) * row.shape[1] ** 2
    np.testing.assert_allclose(of_rows(row), due, rtol=0, atol=1e-10 * np.abs(due).max())
    short = row[:, :-2]  # of a place that what came behind does not move
    due = np.linalg.solve(dynamic_mass.dynamic_matrix(m, at)[0, b:, b:], np.pad(short, ((0, 0), (0, 2))).T)
    np.testing.assert_allclose(of_rows(short)[0], due, rtol=0, atol=1e-10 * np.abs(due).max())


def test_coordinates_whose_coupling_brings_them_into_the_band_are_solved_at_every_line():
    K = (2 * np.pi * 70) ** 2 * np.array([[0, 0, 0], [0, 1, 0.9], [0, 0.9, 1.0]])  # each by itself at 70 Hz, one of both at 22
    M = np.array([[1.0, 0.1, 0.2], [0.1, 1, 0], [0.2, 0, 1]])
    m = Matrices(base=1, mass=M, stiffness=K, viscous=0 * K, structural=0.02 * K, places={})
    lines = np.linspace(4.0, 32.0, 5 * dynamic_mass.NODES)
    assert not len(dynamic_mass.far_coordinates(m, 2 * np.pi * lines)[0])
    known = [dynamic_mass.dynamic_mass(m, [line]).matrix[0] for line in lines]
    np.testing.assert_allclose(dynamic_mass.dynamic_mass(m, lines).matrix, known, rtol=1e-12)


def test_an_accelerance_is_reciprocal_and_of_one_mass_on_one_spring_the_textbook():
    m = drawn(base=0)
    one, other = (points.along(m, "tip", axis) for axis in ([1.0, 0, 0], [0, 0, 1.0]))
    there, back = (dynamic_mass.accelerance(m, FEW_LINES, a, b).matrix for a, b in ((one, other), (other, one)))
    np.testing.assert_allclose(there, back, rtol=1e-9)
    m, k, eta, omega = 2.0, 800.0, 0.05, 2 * np.pi * FEW_LINES
    one = Matrices(base=0, mass=[[m]], stiffness=[[k]], viscous=[[0.0]], structural=[[eta * k]], places={})
    found = dynamic_mass.accelerance(one, FEW_LINES, [1.0], [1.0]).matrix[:, 0, 0]
    np.testing.assert_allclose(found, -(omega**2) / (k * (1 + 1j * eta) - m * omega**2), rtol=1e-12)


def test_a_row_and_column_that_cross_are_the_matrix_that_they_are():
    m, generator, r = drawn(base=0), np.random.default_rng(6), 4
    cross = np.zeros((SIZE, SIZE))
    cross[r] = generator.standard_normal(SIZE)
    cross[:, r] = cross[r]
    answered = dynamic_mass.accelerance(m, FEW_LINES, m.places["tip"][:2], m.places["tip"][2])
    row = cross[r] / np.where(np.arange(SIZE) == r, 2, 1)
    changes = {"whole": of_arrays(SIZE, stiffness=cross), "crossing": crossed(r, stiffness=row)}
    found = dynamic_mass.transfer_tangents(answered, changes)
    np.testing.assert_allclose(found["crossing"], found["whole"], rtol=1e-10, atol=1e-12 * np.abs(found["whole"]).max())


def test_tangents_add_on_the_coordinates_of_both():
    generator = np.random.default_rng(3)
    one, other = changes(generator, np.array([1, 2])), changes(generator, np.array([2, 8]))
    both = plus(one, other, SIZE)
    assert list(both.at) == [1, 2, 8]
    for name in FIELDS:
        np.testing.assert_allclose(full(both, name, SIZE), full(one, name, SIZE) + full(other, name, SIZE))


@pytest.fixture(scope="module")
def turned(held) -> tuple[Matrices, np.ndarray]:
    """Clumod with a mast at 40 % of its stiffness, which couples its modes to what answers statically, and rows of two places."""
    m = held(structure("clumod-4"), locations("clumod-4")).matrices
    K = m.stiffness - 0.6 * m.parts["mast"]
    m = replace(m, stiffness=K, structural=m.structural + 0.1 * m.parts["mast"])
    return m, np.array([points.along(m, place, [1.0, 0.0, 0.0]) for place in ("mast-top", "hub-1")])


def test_a_structure_is_condensed_to_what_it_does_over_a_band_and_neither_answers_nor_derivatives_change(turned):
    m, rows = turned
    few = dynamic_mass.Condensed.of(m, 2 * np.pi * LINES, rows.T)
    assert few is not None
    assert len(few.matrices.mass) < 0.5 * len(m.mass)
    part = of_arrays(len(m.mass), stiffness=m.parts["mast"], structural=0.1 * m.parts["mast"])
    mode = crossed(3, stiffness=m.stiffness[3], structural=m.structural[3])
    answered = dynamic_mass.accelerance(m, LINES, rows, rows[0])
    condensed = dynamic_mass.accelerance(few.matrices, LINES, few.of_rows(rows), few.of_rows(rows[0]))
    np.testing.assert_allclose(condensed.matrix, answered.matrix, rtol=0, atol=1e-8 * np.abs(answered.matrix).max())
    due = dynamic_mass.transfer_tangents(answered, {"part": part, "mode": mode})
    found = few.tangents(condensed, {"part": part, "mode": mode})
    for name, change in due.items():
        np.testing.assert_allclose(found[name], change, rtol=0, atol=dynamic_mass.SPANNED * np.abs(change).max())


def test_what_turns_two_modes_or_moves_one_is_made_no_whole_matrix_where_it_is_condensed(turned, monkeypatch):
    m, _ = turned
    rows = np.array([points.along(m, place, [0.6, 0.8, 0.0]) for place in ("mast-top", "hub-1")])
    few = dynamic_mass.Condensed.of(m, 2 * np.pi * LINES, rows.T)
    condensed = dynamic_mass.accelerance(few.matrices, LINES, few.of_rows(rows), few.of_rows(rows[0]))
    answered = dynamic_mass.accelerance(m, LINES, rows, rows[0])
    of = nuisances("clumod", m, np.sqrt(np.diag(m.stiffness)[:12]) / (2 * np.pi), {})
    now = {name: one for name, one in of.at({})[1].items() if name.split(":")[0] in ("mixing", "coupling", "frequency")}
    assert len(now) == 12 + len(of.pairs) + len(of.mixed) > 12
    asked, product = [], prediction_tangents._product
    monkeypatch.setattr(prediction_tangents, "_product", lambda *of: asked.append(of[1].ndim) or product(*of))
    found = few.tangents(condensed, now)
    assert set(asked) == {1}
    due = dynamic_mass.transfer_tangents(answered, now)
    for family in ("mixing", "coupling", "frequency"):
        told, asked = (np.array([one for name, one in of.items() if name.startswith(family)]) for of in (found, due))
        np.testing.assert_allclose(told, asked, rtol=0, atol=dynamic_mass.SPANNED * np.abs(asked).max())


@pytest.mark.parametrize("lost", [0.0, 0.01, 0.5])
def test_what_is_condensed_is_right_at_peaks_between_its_lines_too_and_few_lines_are_solved_as_they_are(turned, lost):
    m, rows = turned
    m = replace(m, structural=0.001 * m.stiffness + lost * m.parts["mast"])
    f = np.linspace(LINES[0], LINES[-1], 4001)
    few = dynamic_mass.Condensed.of(m, 2 * np.pi * LINES, rows.T)
    assert few is not None
    condensed = dynamic_mass.accelerance(few.matrices, f, few.of_rows(rows), few.of_rows(rows[0])).matrix
    whole = dynamic_mass.accelerance(m, f, rows, rows[0]).matrix
    line = np.abs(whole).max(axis=(1, 2), keepdims=True)
    assert (np.abs(condensed - whole) / line).max() < dynamic_mass.SPANNED
    assert dynamic_mass.Condensed.of(m, 2 * np.pi * LINES[:12], rows.T) is None


def test_what_is_stiff_is_right_beside_what_is_soft_each_by_its_own_size():
    n, stiff = 120, 10  # masses on springs in a row, of which the first half is a million times as stiff
    springs = 3e7 * np.where(np.arange(n) < n // 2, 1e6, 1.0)
    ties = np.eye(n) - np.eye(n, k=-1)
    K, changed = ties.T * springs @ ties, ties[:stiff].T * springs[:stiff] @ ties[:stiff]
    m = Matrices(base=0, mass=np.eye(n), stiffness=K, viscous=np.zeros((n, n)), structural=0.01 * K)
    rows, f = np.eye(n)[[2, 8, n - 1]], np.linspace(5.0, 200.0, 300)
    few = dynamic_mass.Condensed.of(m, 2 * np.pi * f, rows.T)
    assert few is not None
    answered = dynamic_mass.accelerance(m, f, rows, rows)
    condensed = dynamic_mass.accelerance(few.matrices, f, few.of_rows(rows), few.of_rows(rows))
    apart = np.abs(condensed.matrix - answered.matrix).max(axis=0) / np.abs(answered.matrix).max(axis=0)
    assert apart.max() < dynamic_mass.SPANNED
    change = of_arrays(n, stiffness=changed)
    due = dynamic_mass.transfer_tangents(answered, {"root": change})["root"]
    found = few.tangents(condensed, {"root": change})["root"]
    assert (np.abs(found - due).max(axis=0) / np.abs(due).max(axis=0)).max() < 1e-2


def test_what_neither_stands_nor_floats_is_not_condensed(turned):
    m, rows = turned
    m = replace(m, stiffness=m.stiffness - 1.1 * np.diag(np.diag(m.stiffness + (2 * np.pi * LINES.max()) ** 2 * m.mass)))
    assert dynamic_mass.Condensed.of(m, 2 * np.pi * LINES, rows.T) is None


def test_a_band_below_half_of_all_modes_leaves_no_coordinate_that_is_solved_at_every_line():
    """A traceback: no coordinate of a base is left beside those far above."""
    omega, at = 2 * np.pi * np.array([100.0, 150.0, 200.0, 300.0]), 2 * np.pi * np.linspace(5.0, 40.0, 60)
    m = Matrices(base=0, mass=np.eye(4), stiffness=np.diag(omega**2), viscous=np.diag(0.02 * omega), structural=np.zeros((4, 4)))
    row = np.arange(12.0).reshape(3, 4) - 5.0
    due = np.linalg.solve(dynamic_mass.dynamic_matrix(m, at), np.broadcast_to(row.T.astype(complex), (60, 4, 3)))
    np.testing.assert_allclose(dynamic_mass.answering(m, at)(row), due, rtol=0, atol=1e-10 * np.abs(due).max())
