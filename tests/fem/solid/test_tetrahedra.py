"""Solid elements against scikit-fem's own forms; tetrahedra of any article, its inertia, its faults in words."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from fem.solid import assembly, model, tetrahedra
from fem.solid.assembly import LOCAL_TET10, QUADRATURE, Matrices, SolidMesh, assemble, lame, volumes
from fem.solid.tetrahedra import Sizing, bodies
from fem.structure import Structure
from geometry import routes
from geometry.article import Article, Box, Cylinder, Material, Part, Shape, material, placed, upright
from geometry.articles import built_in
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Pose, rotation_about
from validation.verification.solids import block

SIDES = (1.0, 0.8, 0.6)
FIRM = Material(name="firm", density=7850.0, youngs_modulus=207e9, poisson_ratio=0.3)
SOFT = Material(name="soft", density=1100.0, youngs_modulus=2e6, poisson_ratio=0.49)
MATERIALS = {"low": FIRM, "high": SOFT}


def bent(points: np.ndarray) -> np.ndarray:
    """Parabolas that cells of degree 2 hold exactly; every section slides, so that volume is kept."""
    x, y, z = points.T
    return np.column_stack([x + 0.2 * y**2 - 0.1 * z**2, y + 0.15 * z**2, z])


@pytest.fixture(scope="module", params=[10, 27], ids=["tetrahedra", "hexahedra"])
def mesh(request: pytest.FixtureRequest) -> SolidMesh:
    made = block(SIDES, (2, 2, 2), request.param, bent)
    high = made.points[made.cells].mean(axis=1)[:, 2] > SIDES[2] / 2
    return replace(made, part=high.astype(np.intp), parts=("low", "high"))


@pytest.fixture(scope="module")
def matrices(mesh: SolidMesh) -> Matrices:
    return assemble(mesh, MATERIALS)


def by_scikit_fem(mesh: SolidMesh, straight: np.ndarray, cells: np.ndarray, form: Any) -> np.ndarray:
    """`form` over `cells`, visited one basis function after the other by scikit-fem, in our order of degrees of freedom."""
    import skfem

    first, second, element = {
        10: (skfem.MeshTet, skfem.MeshTet2, skfem.ElementTetP2()),
        27: (skfem.MeshHex, skfem.MeshHex2, skfem.ElementHex2()),
    }[mesh.cells.shape[1]]
    corners, numbered = np.unique(mesh.cells[:, : {10: 4, 27: 8}[mesh.cells.shape[1]]], return_inverse=True)
    plain = second.from_mesh(first(straight[corners].T, numbered.reshape(len(mesh.cells), -1).T))
    ours = np.array([np.argmin(np.linalg.norm(straight - place, axis=1)) for place in plain.doflocs.T])
    curved = replace(plain, doflocs=mesh.points[ours].T)
    basis = skfem.Basis(curved, skfem.ElementVector(element), intorder=QUADRATURE[mesh.cells.shape[1]], elements=cells)
    place = np.array([np.argmin(np.linalg.norm(mesh.points - place, axis=1)) for place in basis.doflocs.T])
    axis = np.zeros(basis.N, dtype=np.intp)
    for dofs in (basis.nodal_dofs, basis.edge_dofs, basis.facet_dofs, basis.interior_dofs):
        for row, numbers in enumerate(dofs):
            axis[numbers] = row
    back = np.empty(basis.N, dtype=np.intp)
    back[3 * place + axis] = np.arange(basis.N)
    return np.asarray(form.assemble(basis).toarray()[np.ix_(back, back)])


def test_it_is_what_scikit_fem_assembles_from_its_own_forms(mesh: SolidMesh, matrices: Matrices) -> None:
    from skfem import BilinearForm
    from skfem.helpers import dot
    from skfem.models.elasticity import linear_elasticity

    straight = block(SIDES, (2, 2, 2), mesh.cells.shape[1]).points
    mass = np.zeros(matrices.mass.shape)
    for number, name in enumerate(mesh.parts):
        own = np.flatnonzero(mesh.part == number)
        density = MATERIALS[name].density
        K = by_scikit_fem(mesh, straight, own, linear_elasticity(*lame(MATERIALS[name])))
        assert_allclose(matrices.part_stiffness[name].toarray(), K, rtol=0, atol=1e-12 * np.abs(K).max())
        mass += by_scikit_fem(mesh, straight, own, BilinearForm(lambda u, v, w, rho=density: rho * dot(u, v)))
    assert_allclose(matrices.mass.toarray(), mass, rtol=0, atol=1e-12 * np.abs(mass).max())


def test_an_even_stretch_stores_the_energy_of_its_volume_and_moduli(mesh: SolidMesh, matrices: Matrices) -> None:
    """Twice the energy of a strain of 1 along x, over the volume, is lambda + 2 mu, however the cells are bent."""
    stretch = np.zeros((len(mesh.points), 3))
    stretch[:, 0] = mesh.points[:, 0]
    for name, K in matrices.part_stiffness.items():
        lam, mu = lame(MATERIALS[name])
        energy = stretch.ravel() @ (K @ stretch.ravel())
        assert_allclose(energy, (lam + 2 * mu) * np.prod(SIDES) / 2, rtol=1e-12)


COARSE = {"size": 0.06, "cached": False}


def block_of_tetrahedra(
    size: tuple[float, float, float], bottom: float = 0.0, name: str = "block", made_of: str = "steel"
) -> Part:
    return Part(name=name, material=material(made_of), shape=Shape(solids=(upright(Box(size=np.array(size)), bottom=bottom),)))


def rod(diameter: float = 0.1, height: float = 0.1, bottom: float = 0.0, name: str = "rod") -> Part:
    cylinder = upright(Cylinder(diameter=diameter, height=height), bottom=bottom)
    return Part(name=name, material=material("steel"), shape=Shape(solids=(cylinder,)))


def article(*parts: Part) -> Article:
    return Article(name="own", parts=parts)


@pytest.fixture(scope="module")
def cuboid() -> Structure:
    return model.structure(built_in("cuboid"), **COARSE)


def test_the_cuboid_has_the_inertia_of_its_drawing(cuboid: Structure) -> None:
    """Its holes are curved elements of degree 2: of the circle's area 1e-4 is missed at twelve of them, of little mass."""
    drawn = routes.inertia(built_in("cuboid")).mass_matrix
    assert_allclose(cuboid.rigid_mass, drawn, rtol=0, atol=1e-5 * drawn[0, 0])


def test_no_rigid_motion_strains_it(cuboid: Structure) -> None:
    force = np.abs(cuboid.stiffness @ cuboid.rigid).max()
    assert force < 1e-12 * np.abs(cuboid.stiffness.data).max()


def test_the_base_is_the_underside_and_all_of_it(cuboid: Structure) -> None:
    held = np.isin(cuboid.translations, cuboid.held).all(axis=1)
    assert_array_equal(held, np.abs(cuboid.points[:, 2]) < 1e-9)
    assert held.sum() > 10


def test_stiffness_and_mass_are_exactly_symmetric_and_the_parts_add_up(cuboid: Structure) -> None:
    for matrix in (cuboid.stiffness, cuboid.mass):
        assert abs(matrix - matrix.T).nnz == 0
    assert abs(cuboid.stiffness - sum(cuboid.part_stiffness.values())).nnz == 0
    assert cuboid.loss_factors == {"block": material("aluminium").loss_factor}


def straight(mesh: SolidMesh) -> SolidMesh:
    """Every mid-side node put half-way between its corners."""
    corners = 2 * LOCAL_TET10[4:]  # each row has a 1 for every corner that is not the first
    weights = np.column_stack([2 - corners.sum(axis=1), corners]) / 2
    points = mesh.points.copy()
    points[mesh.cells[:, 4:]] = np.einsum("ek,cki->cei", weights, points[mesh.cells[:, :4]])
    return replace(mesh, points=points)


def volume(mesh: SolidMesh) -> float:
    return float(volumes(mesh).sum())


@pytest.mark.proof  # four meshes; test_the_cuboid_has_the_inertia_of_its_drawing holds a volume
def test_curved_edges_lose_volume_with_the_fourth_power_of_the_size_and_straight_ones_with_the_second() -> None:
    exact = np.pi / 4 * 0.1**2 * 0.1
    meshes = [tetrahedra.tetrahedra(bodies(article(rod())), Sizing(size=1, fineness=f)) for f in (1.0, 3.0)]
    curved, bent_back = (np.array([1 - volume(each(m)) / exact for m in meshes]) for each in (lambda m: m, straight))
    assert np.abs(curved).max() < 1e-4  # twelve elements a circle
    assert bent_back[0] > 0.02
    rates = [np.log(abs(error[0] / error[1])) / np.log(3.0) for error in (curved, bent_back)]
    assert_allclose(rates, (4, 2), atol=0.4)  # circles only, and the number of elements around is a whole one


def test_parts_in_contact_share_nodes_and_keep_their_own_material() -> None:
    """A smaller rod on a larger block, of two materials: the joint carries load, the mass is that of each."""
    both = article(block_of_tetrahedra((0.2, 0.2, 0.05), name="foot", made_of="aluminium"), rod(bottom=0.05))
    structure = model.structure(both, **COARSE)
    drawn = routes.inertia(both).mass_matrix
    assert_allclose(structure.rigid_mass, drawn, rtol=0, atol=2e-4 * drawn[0, 0])
    shared = [K.diagonal() > 0 for K in structure.part_stiffness.values()]
    assert np.any(shared[0] & shared[1])


def test_the_same_article_gives_the_same_mesh_to_the_last_bit() -> None:
    first, second = (tetrahedra.tetrahedra(bodies(article(rod())), Sizing(size=0.05)) for _ in range(2))
    assert_array_equal(first.points, second.points)
    assert_array_equal(first.cells, second.cells)


def test_a_size_is_kept_and_fineness_divides_it() -> None:
    coarse, fine = (
        tetrahedra.tetrahedra(bodies(article(block_of_tetrahedra((0.2, 0.1, 0.1)))), Sizing(size=0.05, fineness=f))
        for f in (1, 2)
    )
    edges = [m.points[m.cells[:, 0]] - m.points[m.cells[:, 1]] for m in (coarse, fine)]
    longest = [np.linalg.norm(e, axis=1).max() for e in edges]
    assert longest[0] < 2 * 0.05
    assert longest[1] < 0.7 * longest[0]


@pytest.mark.proof  # two meshes for a choice of sizes
def test_elements_shrink_at_re_entrant_edges_only() -> None:
    """The rod's foot on the block is one, the block's own edges are none."""
    both = article(block_of_tetrahedra((0.3, 0.3, 0.05), name="foot"), rod(bottom=0.05))
    plain, refined = (tetrahedra.tetrahedra(bodies(both), Sizing(size=0.05, refinement=r)).points[:, :3] for r in (1.0, 0.3))
    at_foot, at_corner = np.array([0.05, 0.0, 0.05]), np.array([0.15, 0.15, 0.05])

    def near(points: np.ndarray, place: np.ndarray) -> int:
        return int(np.sum(np.linalg.norm(points - place, axis=1) < 0.02))

    assert near(refined, at_foot) > 3 * near(plain, at_foot)
    assert near(refined, at_corner) <= near(plain, at_corner) + 3


def test_gmsh_says_nothing(capfd: pytest.CaptureFixture[str]) -> None:
    tetrahedra.tetrahedra(bodies(article(rod())), Sizing(size=0.05))
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("bottom", "said"),
    [(0.05, r"(?s)block and rod.*share 3\.9\d+e\+05 mm³"), (0.11, r"rod \(its node at .* is 10 mm from")],
    ids=["overlap", "gap"],
)
def test_bodies_that_overlap_or_touch_nothing_are_named_with_volume_or_distance(bottom: float, said: str) -> None:
    with pytest.raises(BadInput, match=said):
        model.structure(article(block_of_tetrahedra((0.2, 0.2, 0.1)), rod(bottom=bottom)), **COARSE)


def test_touching_along_an_edge_is_no_joint() -> None:
    other = block_of_tetrahedra((0.1, 0.1, 0.1), bottom=0.1, name="upper")
    aside = placed(article(other), Pose(position=np.array([0.1, 0.0, 0.0]))).parts[0]
    with pytest.raises(BadInput, match="upper"):
        model.structure(article(block_of_tetrahedra((0.1, 0.1, 0.1)), aside), **COARSE)


def test_an_article_that_stands_on_a_line_cannot_be_held() -> None:
    lying = placed(article(rod()), Pose(rotation=rotation_about("x", np.pi / 2)))
    with pytest.raises(BadInput, match="no face lies on the lowest plane"):
        model.structure(lying, **COARSE)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"youngs_modulus": None}, "youngs_modulus.*found none"),
        ({"youngs_modulus": np.inf}, "finite"),
        ({"poisson_ratio": -1.0}, "between -1 and 0.5"),
    ],
)
def test_a_material_that_is_not_elastic_is_refused_before_anything_is_meshed(change: dict[str, float], words: str) -> None:
    part = block_of_tetrahedra((0.1, 0.1, 0.1), name="foot")
    with pytest.raises(BadInput, match=f"(?s)of foot.*{words}"):
        model.structure(article(replace(part, material=replace(part.material, **change))), **COARSE)


def test_a_density_alone_makes_no_solid_model() -> None:
    part = replace(block_of_tetrahedra((0.1, 0.1, 0.1)), material=Material(name="7800 kg/m^3", density=7800.0))
    with pytest.raises(BadInput, match=r"state your own in an article\.toml"):
        model.structure(article(part), **COARSE)


@pytest.mark.parametrize("option", [{"size": 0.0}, {"size": -1.0}, {"fineness": 0.0}, {"refinement": 2.0}, {"largest": 0}])
def test_a_size_that_is_none_is_refused_by_name(option: dict[str, float]) -> None:
    with pytest.raises(BadInput, match=f"`{next(iter(option))}`"):
        model.structure(article(rod()), cached=False, **option)


def test_too_many_unknowns_are_refused_before_the_work_or_when_only_the_mesh_shows_them() -> None:
    with pytest.raises(BadInput, match=r"at least [\d,]+ degrees of freedom, 500,000 are allowed"):
        model.structure(built_in("cuboid"), size=1e-4, cached=False)
    with pytest.raises(BadInput, match="5,000 are allowed"):
        model.structure(built_in("cuboid"), size=0.05, largest=5000, cached=False)


@pytest.fixture
def attempts(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[float]]:
    """The fineness of every attempt; all fail."""
    seen: list[float] = []

    def fail(folder: Path, found: object, sizes: Sizing) -> SolidMesh:
        seen.append(sizes.fineness)
        raise tetrahedra.Unmeshable("2 elements are inverted, the worst in rod at (1.0, 2.0, 3.0) mm")

    monkeypatch.setattr(tetrahedra, "_attempt", fail)
    return seen


def test_a_mesh_that_fails_is_tried_finer_and_then_explained(attempts: list[float]) -> None:
    with pytest.raises(CheckFailed, match=r"after 3 attempt.*2 elements are inverted, the worst in rod at"):
        tetrahedra.tetrahedra(bodies(article(rod())))
    assert attempts == [1.0, 1.4, 2.0]


def test_a_gmsh_that_ends_its_process_is_a_failed_attempt(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(tetrahedra.sys, "executable", "/bin/false")
    with pytest.raises(tetrahedra.Unmeshable, match="gmsh broke down"):
        tetrahedra._attempt(tmp_path, bodies(article(rod())), Sizing())


def test_inverted_elements_are_counted_and_placed() -> None:
    mesh = tetrahedra.tetrahedra(bodies(article(block_of_tetrahedra((0.1, 0.1, 0.1)))), Sizing(size=0.1))
    cells = mesh.cells.copy()
    cells[3] = cells[3][[1, 0, 2, 3, 4, 6, 5, 8, 7, 9]]
    with pytest.raises(CheckFailed, match=rf"1 of {len(cells)} elements are inverted, the worst in block at \(") as caught:
        assembly.require_upright(replace(mesh, cells=cells))
    assert_array_equal(caught.value.evidence["elements"], [3])


def test_a_slender_rod_keeps_its_volume() -> None:
    """It had lost 41 % of it, no element inverted, when only the edges of its curved face were divided and not the face."""
    mesh = tetrahedra.tetrahedra(bodies(article(rod(0.05, 0.6))))
    assert_allclose(volume(mesh), np.pi / 4 * 0.05**2 * 0.6, rtol=1e-4)


def test_cells_as_large_as_a_rod_is_thick_are_a_failed_attempt(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """With curvature left out of account every element is upright, and the rod is not all there."""
    monkeypatch.setattr(tetrahedra, "_curved_faces", lambda *_: {})
    (body,) = bodies(article(rod(0.05, 0.6)))
    body.write(tmp_path / "0.brep")
    with pytest.raises(tetrahedra.Unmeshable, match=r"do not fill the drawing: \d\.\d+% of rod are missing \(0\.1% allowed\)"):
        tetrahedra.mesh_bodies(tmp_path, ["rod"], Sizing(size=0.05))


def test_gmsh_is_put_away_after_an_error_and_refused_when_in_use() -> None:
    import gmsh

    from fem.solid.assembly import session

    with pytest.raises(KeyboardInterrupt), session():
        raise KeyboardInterrupt
    assert not gmsh.isInitialized()
    gmsh.initialize(interruptible=False)
    try:
        with pytest.raises(RuntimeError, match="in use"), session():
            pass
    finally:
        gmsh.finalize()
