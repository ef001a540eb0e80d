"""Elements of users' meshes: constant strain in any shape, six rigid motions, convergence to closed form at a known rate."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import sparse
from scipy.linalg import eigh

from benchmarks.read_meshes import STEEL, abaqus, bricks, plate
from fem.mesh import shells, solids
from fem.mesh.places import ENERGY_TOO_HIGH
from fem.modes import fixed_base, floating_shift, lowest
from fem.structure import Structure

Meshed = Callable[..., Structure]

E, NU, RHO = 210e9, 0.3, 7850.0
SOLIDS = ("C3D4", "C3D10", "C3D6", "C3D15", "C3D8", "C3D20")
SHELLS = ("S3", "S4")
PART = f"[fe_model.parts.p]\n{STEEL}\n"


def shaken(points: np.ndarray, share: float) -> np.ndarray:
    """Points moved within the body by a smooth field, so that straight edges stay nearly straight and no two are alike."""
    x, y, z = (points / np.ptp(points, axis=0).max()).T
    return points + share * np.column_stack([y * z + x * x, x * z - y * y, x * y + 0.5 * z * x])


def free_frequencies(structure: Structure, count: int) -> np.ndarray:
    pairs = lowest(structure.stiffness, structure.mass, count, shift=floating_shift(structure.stiffness, structure.mass))
    return np.asarray(np.sqrt(np.abs(pairs.values)) / (2 * np.pi))


@pytest.fixture
def solid(meshed: Meshed) -> Callable[..., Structure]:
    def made(kind: str, cells: tuple[int, int, int] = (2, 2, 2), share: float = 0.1) -> Structure:
        points, elements = bricks(cells, (1.0, 0.8, 0.6), kind)
        return meshed(abaqus(shaken(points, share), {"p": (kind, elements)}), PART)

    return made


@pytest.mark.parametrize("kind", SOLIDS)
def test_a_solid_has_six_rigid_motions_and_no_other_without_strain(solid: Callable[..., Structure], kind: str) -> None:
    structure = solid(kind, (1, 1, 1))
    values = np.linalg.eigvalsh(structure.stiffness.toarray())
    assert_allclose(values[:6], 0, atol=1e-12 * values[-1])
    assert values[6] > 1e-5 * values[-1]
    assert_allclose(structure.stiffness @ structure.rigid, 0, atol=1e-13 * values[-1])


@pytest.mark.parametrize("kind", SOLIDS)
def test_constant_strain_leaves_no_force_inside_and_stores_its_energy(solid: Callable[..., Structure], kind: str) -> None:
    structure = solid(kind, (2, 2, 2))
    G = np.random.default_rng(2).standard_normal((3, 3))
    u = np.zeros(structure.mass.shape[0])
    u[structure.translations] = structure.points @ G.T
    force = structure.stiffness @ u
    points = structure.points
    strain = (G + G.T) / 2
    lam, mu = E * NU / (1 + NU) / (1 - 2 * NU), E / 2 / (1 + NU)
    density = lam * np.trace(strain) ** 2 / 2 + mu * np.sum(strain**2)
    volume = structure.rigid_mass[0, 0] / RHO
    assert_allclose(u @ force / 2, density * volume, rtol=1e-9)
    original, _ = bricks((2, 2, 2), (1.0, 0.8, 0.6), kind)
    order = np.argsort(np.linalg.norm(shaken(original, 0.1)[:, None] - points[None], axis=2).argmin(axis=1))
    inner = np.all((original > 1e-9) & (original < np.array([1.0, 0.8, 0.6]) - 1e-9), axis=1)[order]
    assert np.any(inner)
    assert_allclose(force[structure.translations[inner]], 0, atol=1e-9 * np.abs(force).max())


@pytest.mark.parametrize("kind", SHELLS)
def test_a_shell_meets_constant_strain_and_constant_curvature_on_a_distorted_mesh(meshed: Meshed, kind: str) -> None:
    points, elements = plate(3, 3, (1.0, 0.7), kind, skew=0.2)
    structure = meshed(abaqus(points, {"p": (kind, elements)}), f'{PART}thickness = "20 mm"')
    x, y, _ = structure.points.T
    inner = (x > 0) & (x < 1) & (y > 0) & (y < 0.7)
    assert inner.sum() == 4
    D, t, area = shells.plane_stress(E, NU), 0.02, 0.7
    a, b, c, d = 0.3, -0.7, 0.2, 0.5
    stretched = np.zeros(structure.mass.shape[0])
    stretched[structure.translations] = np.column_stack([a * x + b * y, c * x + d * y, 0 * x])
    stretched[structure.rotations[:, 2]] = (c - b) / 2
    bent = np.zeros_like(stretched)
    bent[structure.translations[:, 2]] = (a * x**2 + b * y**2) / 2 + c * x * y
    bent[structure.rotations[:, 0]] = b * y + c * x
    bent[structure.rotations[:, 1]] = -(a * x + c * y)
    for u, strain, stiff in ((stretched, [a, d, b + c], t), (bent, [a, b, 2 * c], t**3 / 12)):
        force = structure.stiffness @ u
        where = np.hstack([structure.translations, structure.rotations])[inner]
        assert_allclose(force[where], 0, atol=1e-9 * np.abs(force).max())
        assert_allclose(u @ force, stiff * area * np.array(strain) @ D @ np.array(strain), rtol=1e-9)


@pytest.mark.parametrize("kind", ["S3", "S4", "B31"])
def test_shells_and_beams_in_space_have_six_rigid_motions(meshed: Meshed, kind: str) -> None:
    rng = np.random.default_rng(3)
    points = rng.standard_normal((4, 3))
    elements = {"S3": [[1, 2, 3], [2, 3, 4]], "S4": [[1, 2, 3, 4]], "B31": [[1, 2], [2, 3], [3, 4]]}[kind]
    if kind == "S4":  # a warped one
        points = np.array([[0, 0, 0], [1, 0, 0.1], [1.1, 0.9, 0], [0, 1, 0.2]])
    section = 'section = { width = "20 mm", height = "50 mm" }' if kind == "B31" else 'thickness = "100 mm"'
    structure = meshed(abaqus(points, {"p": (kind, elements)}), f"{PART}{section}")
    values = np.linalg.eigvalsh(structure.stiffness.toarray())
    assert_allclose(values[:6], 0, atol=1e-12 * values[-1])
    assert values[6] > 1e-8 * values[-1]


@pytest.mark.parametrize("kind", ["S3", "S4"])
def test_nafems_fv12_the_free_thin_square_plate(meshed: Meshed, kind: str) -> None:
    """Published to four digits (NAFEMS, Selected Benchmarks for Natural Frequency Analysis, FV12)."""
    points, elements = plate(24, 24, (10.0, 10.0), kind, skew=0.2)
    material = 'material = { density = "8000 kg/m^3", youngs_modulus = "200 GPa", poisson_ratio = 0.3 }'
    structure = meshed(abaqus(points, {"p": (kind, elements)}), f'[fe_model.parts.p]\n{material}\nthickness = "50 mm"')
    found = free_frequencies(structure, 14)
    assert_allclose(found[:6], 0, atol=1e-4 * found[6])
    assert_allclose(found[6:], [1.622, 2.360, 2.922, 4.190, 4.190, 7.356, 7.356, 7.668], rtol=2e-3)


@pytest.mark.parametrize("kind", ["S3", "S4"])
def test_a_simply_supported_plate_converges_at_second_order(meshed: Meshed, kind: str) -> None:
    side, t = 1.0, 0.002
    exact = np.pi / side**2 * np.sqrt(E * t**2 / 12 / (1 - NU**2) / RHO)
    errors = []
    for n in (6, 12):
        points, elements = plate(n, n, (side, side), kind)
        structure = meshed(abaqus(points, {"p": (kind, elements)}), f'{PART}thickness = "2 mm"')
        x, y, _ = structure.points.T
        sides, ends = (y == 0) | (y == side), (x == 0) | (x == side)
        held = [structure.translations[:, :2].ravel(), structure.rotations[:, 2], structure.translations[sides | ends, 2]]
        held += [structure.rotations[sides, 1], structure.rotations[ends, 0]]
        free = np.setdiff1d(np.arange(len(structure.rigid)), np.concatenate(held))
        K, M = (A.toarray()[np.ix_(free, free)] for A in (structure.stiffness, structure.mass))
        first = eigh(K, M, eigvals_only=True, subset_by_index=[0, 0])[0]
        errors.append(abs(np.sqrt(first) / (2 * np.pi) / exact - 1))
    assert errors[1] < 4e-3
    assert 1.7 < np.log2(errors[0] / errors[1]) < 2.5


def test_a_cantilever_of_beams_converges_at_fourth_order(meshed: Meshed) -> None:
    length, h = 1.0, 0.002
    exact = 3.516015269 / (2 * np.pi) * np.sqrt(E * h**2 / 12 / RHO) * np.array([1, 22.03449156 / 3.516015269])
    errors = []
    for n in (3, 6):
        points = np.column_stack([np.linspace(0, length, n + 1), np.zeros((n + 1, 2))])
        mesh = abaqus(points, {"p": ("B31", [[k, k + 1] for k in range(1, n + 1)])}, {"root": [1]})
        section = 'section = { width = "20 mm", height = "2 mm" }'
        structure = meshed(mesh, f"{PART}{section}", support='interface = ["root"]')
        upright = fixed_base(structure, 2).frequency
        errors.append(upright[1] / exact[1] - 1)
        assert_allclose(upright[0], exact[0], rtol=1e-3)
    assert 3.5 < np.log2(errors[0] / errors[1]) < 4.5


@pytest.mark.parametrize(
    ("kind", "cells", "rtol"), [("C3D20", (8, 1, 1), 5e-3), ("C3D10", (10, 1, 1), 5e-3), ("C3D8", (16, 2, 2), 5e-3)]
)
def test_a_cantilever_of_solids_is_the_beam(meshed: Meshed, kind: str, cells: tuple[int, int, int], rtol: float) -> None:
    """Without lateral contraction, which the clamp would hold and a beam does not know."""
    part = f"{PART}".replace("0.3", "0.0")
    points, elements = bricks(cells, (1.0, 0.05, 0.05), kind)
    box = '[fe_model.groups.root]\nbox = [["0 m", "0 m", "0 m"], ["0 m", "1 m", "1 m"]]'
    structure = meshed(abaqus(points, {"p": (kind, elements)}), part, support='interface = ["root"]', more=box)
    nodes = np.column_stack([np.linspace(0, 1, 21), np.zeros((21, 2))])
    mesh = abaqus(nodes, {"p": ("B31", [[k, k + 1] for k in range(1, 21)])}, {"root": [1]})
    beam = meshed(mesh, f'{part}section = {{ width = "50 mm", height = "50 mm" }}', support='interface = ["root"]')
    assert_allclose(fixed_base(structure, 1).frequency, fixed_base(beam, 1).frequency, rtol=rtol)


@pytest.mark.parametrize("kind", [*SOLIDS, *SHELLS])
def test_the_whole_weighs_and_turns_as_its_closed_form(meshed: Meshed, kind: str) -> None:
    a, b, t = 1.0, 0.6, 0.05
    if kind in SHELLS:
        points, elements = plate(2, 3, (a, b), kind)
        structure = meshed(abaqus(points, {"p": (kind, elements)}), f'{PART}thickness = "50 mm"')
        m, middle = RHO * a * b * t, np.array([a / 2, b / 2, 0])
    else:
        points, elements = bricks((2, 3, 1), (a, b, t), kind)
        structure = meshed(abaqus(points, {"p": (kind, elements)}), PART)
        m, middle = RHO * a * b * t, np.array([a / 2, b / 2, t / 2])
    assert_allclose(np.diag(structure.rigid_mass)[:3], m, rtol=1e-12)
    central = m / 12 * np.array([b**2 + t**2, a**2 + t**2, a**2 + b**2])
    steiner = m * (middle @ middle - middle**2)
    assert_allclose(np.diag(structure.rigid_mass)[3:], central + steiner, rtol=1e-12)


@pytest.mark.parametrize("kind", solids.KINDS)
def test_functions_are_one_at_their_own_node_and_sum_to_one(kind: str) -> None:
    X = solids.local_nodes(kind)
    values, _ = solids.functions(kind, X)
    assert_allclose(values, np.eye(len(X)), atol=1e-12)
    points, weights = solids.quadrature(kind)
    values, gradients = solids.functions(kind, points)
    assert_allclose(values.sum(axis=1), 1, rtol=1e-13)
    assert_allclose(gradients.sum(axis=1), 0, atol=1e-12)
    assert_allclose(weights.sum(), {"tet": 1 / 6, "wedge": 1.0, "hex": 8.0}[solids.shape(kind)], rtol=1e-13)


@pytest.mark.parametrize("aspect", [1.0, 3.0, 10.0])
def test_two_membrane_triangles_bend_exactly_in_their_plane_whatever_their_aspect(meshed: Meshed, aspect: float) -> None:
    b, t = 0.1, 0.01
    points = np.array([[0, 0, 0], [aspect * b, 0, 0], [aspect * b, b, 0], [0, b, 0]])
    structure = meshed(abaqus(points, {"p": ("S3", [[1, 2, 3], [1, 3, 4]])}), f'{PART}thickness = "10 mm"')
    x, y = (structure.points[:, :2] - [aspect * b / 2, b / 2]).T
    u = np.zeros(structure.mass.shape[0])
    u[structure.translations] = np.column_stack([-x * y, (x**2 + NU * y**2) / 2, 0 * x])
    u[structure.rotations[:, 2]] = x
    # The optimal membrane is exact for the Poisson's ratio that its factor is made from, up to 0.5
    assert_allclose(u @ (structure.stiffness @ u), E * t * b**3 / 12 * aspect * b, rtol=1e-9)


@pytest.mark.parametrize("kind", SOLIDS)
def test_a_body_in_constant_strain_is_resolved_by_any_mesh(solid: Callable[..., Structure], kind: str) -> None:
    structure = solid(kind)
    motions = np.zeros((structure.mass.shape[0], 7))
    motions[structure.translations, 0] = structure.points @ np.random.default_rng(2).standard_normal((3, 3)).T
    motions[:, 1:] = structure.rigid
    assert structure.elements is not None
    (energy,) = structure.elements.unresolved(motions, np.zeros(7)).values()
    assert_allclose(energy, 0, atol=1e-12 * (motions[:, 0] @ structure.stiffness @ motions[:, 0]))


@pytest.mark.parametrize(
    ("kind", "cells"),
    [("C3D4", (12, 4, 4)), ("C3D10", (5, 2, 2)), ("C3D6", (12, 4, 4)), ("C3D15", (5, 2, 2)), ("C3D8", (5, 1, 1))],
)
def test_how_much_too_stiff_a_mesh_is_is_told_by_the_jumps_of_its_strains(
    meshed: Meshed, kind: str, cells: tuple[int, int, int]
) -> None:
    box = '[fe_model.groups.root]\nbox = [["0 m", "0 m", "0 m"], ["0 m", "1 m", "1 m"]]'

    def held(kind: str, cells: tuple[int, int, int]) -> Structure:
        points, elements = bricks(cells, (1.0, 0.2, 0.15), kind)
        return meshed(abaqus(points, {"p": (kind, elements)}), PART, support='interface = ["root"]', more=box)

    structure = held(kind, cells)
    modes, true = fixed_base(structure, 2), fixed_base(held("C3D20", (16, 4, 4)), 2)
    assert structure.elements is not None
    assert modes.shapes is not None
    told = (
        np.diag(structure.elements.unresolved(modes.shapes, (2 * np.pi * modes.frequency) ** 2)["p"])
        / (2 * np.pi * modes.frequency) ** 2
    )
    off = 1 - (true.frequency / modes.frequency) ** 2
    assert np.all((off / told > ENERGY_TOO_HIGH / 2) & (off / told < 2 * ENERGY_TOO_HIGH))


@pytest.mark.parametrize("kind", SHELLS)
def test_a_fold_is_no_jump_and_a_sheet_of_constant_strain_and_curvature_is_resolved(meshed: Meshed, kind: str) -> None:
    points, elements = plate(3, 2, (0.3, 0.2), kind, skew=0.2)
    standing = points[:, [2, 1, 0]]  # the first three are the fold
    more = [[n if n <= 3 else n + len(points) - 3 for n in one] for one in elements]
    mesh = abaqus(np.vstack([points, standing[3:]]), {"p": (kind, [*elements, *more])})
    structure = meshed(mesh, f'{PART}thickness = "2 mm"')
    x, y, z = structure.points.T
    # Deflections 0.4 x² + 0.3 x y of the one and 0.2 z² - 0.3 y z of the other turn the fold alike, and leave it where it is
    moved = np.column_stack([1e-3 * x + 0.2 * z**2 - 0.3 * y * z, 2e-3 * y, 4e-3 * z + 0.4 * x**2 + 0.3 * x * y])
    turned = np.column_stack([0.3 * x, -0.8 * x - 0.3 * y + 0.4 * z, 0.3 * z])
    u = np.zeros((structure.mass.shape[0], 1))
    u[structure.translations, 0], u[structure.rotations, 0] = moved, turned
    assert structure.elements is not None
    (energy,) = structure.elements.unresolved(u, np.zeros(1)).values()
    assert_allclose(energy, 0, atol=1e-9 * (u.T @ structure.stiffness @ u).item())


@pytest.mark.parametrize(("kind", "n"), [("S3", 6), ("S4", 6)])
def test_how_far_off_a_mesh_of_shells_is_is_no_more_than_it_tells(meshed: Meshed, kind: str, n: int) -> None:
    """Either way, as discrete Kirchhoff triangles may be too soft; here, of a cantilever, by a fifth of it at least."""
    box = '[fe_model.groups.root]\nbox = [["0 m", "0 m", "0 m"], ["0 m", "1 m", "1 m"]]'

    def held(n: int) -> Structure:
        points, elements = plate(n, n // 2, (0.4, 0.2), kind)
        return meshed(
            abaqus(points, {"p": (kind, elements)}), f'{PART}thickness = "2 mm"', support='interface = ["root"]', more=box
        )

    structure = held(n)
    modes, true = fixed_base(structure, 6), fixed_base(held(4 * n), 6)
    assert structure.elements is not None
    assert modes.shapes is not None
    squares = (2 * np.pi * modes.frequency) ** 2
    share = ENERGY_TOO_HIGH * np.diag(structure.elements.unresolved(modes.shapes, squares)["p"]) / squares
    off = np.abs(1 - (true.frequency / modes.frequency) ** 2)
    assert np.all(off < 2 * share)
    assert off.max() > 0.2 * share.max()


def test_what_a_mesh_leaves_unsure_costs_what_its_elements_do_however_many_pieces_they_are_taken_in(meshed, monkeypatch):
    points, elements = plate(12, 12, (0.4, 0.4), "S4")
    structure = meshed(abaqus(points, {"p": ("S4", elements)}), f'{PART}thickness = "2 mm"')
    motions = np.random.default_rng(1).standard_normal((structure.mass.shape[0], 3))
    (due,) = structure.elements.unresolved(motions, np.zeros(3)).values()
    monkeypatch.setattr("fem.mesh.solids.BATCH", 72 * 3 * 4)  # four triangles
    rows, made = list[int](), sparse.csr_array
    monkeypatch.setattr(sparse, "csr_array", lambda *of, **more: rows.append(made(*of, **more).shape[0]) or made(*of, **more))
    (found,) = structure.elements.unresolved(motions, np.zeros(3)).values()
    assert len(rows) > 100
    assert np.median(rows) <= 3 * 4  # its own corners
    assert_allclose(found, due, rtol=1e-9)


def test_a_beam_says_how_far_its_mass_bows_it_between_its_ends(meshed: Meshed) -> None:
    section = 'section = { width = "20 mm", height = "10 mm" }'

    def held(n: int) -> Structure:
        points = np.column_stack([np.linspace(0, 1, n + 1), np.zeros((n + 1, 2))])
        mesh = abaqus(points, {"p": ("B31", [[k, k + 1] for k in range(1, n + 1)])}, {"root": [1]})
        return meshed(mesh, f"{PART}{section}", support='interface = ["root"]')

    structure = held(2)
    modes, true = fixed_base(structure, 4), fixed_base(held(16), 4)
    assert structure.elements is not None
    assert modes.shapes is not None
    squares = (2 * np.pi * modes.frequency) ** 2
    told = np.diag(structure.elements.unresolved(modes.shapes, squares)["p"]) / squares
    off = 1 - (true.frequency / modes.frequency) ** 2
    assert off[-1] > 0.01
    assert np.all((off / told > 0.9) & (off / told < ENERGY_TOO_HIGH))
