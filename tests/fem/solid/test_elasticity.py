"""Stiffness and mass of bent cells of both kinds: scikit-fem's own forms, rigid motion, volume, materials."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.solid.assembly import QUADRATURE, Matrices, assemble, lame, volumes
from fem.solid.mesh import SolidMesh
from fem.structure import rigid_motion
from geometry.article import Material, material
from geometry.errors import BadInput
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


def test_rigid_motion_costs_nothing_and_weighs_what_the_volume_does(mesh: SolidMesh, matrices: Matrices) -> None:
    motion = rigid_motion(mesh.points).reshape(len(mesh.points), 6, 6)[:, :3].reshape(-1, 6)
    assert np.abs(matrices.stiffness @ motion).max() < 1e-11 * np.abs(matrices.stiffness.data).max()
    half = np.prod(SIDES) / 2
    assert_allclose(motion[:, 0] @ matrices.mass @ motion[:, 0], half * (7850.0 + 1100.0), rtol=1e-12)
    assert_allclose(np.bincount(mesh.part, weights=volumes(mesh)), half, rtol=1e-12)


def test_each_part_has_its_own_share_of_the_stiffness(matrices: Matrices) -> None:
    assert abs(matrices.stiffness - sum(matrices.part_stiffness.values())).max() == 0
    assert set(matrices.part_stiffness) == {"low", "high"}


def test_an_even_stretch_stores_the_energy_of_its_volume_and_moduli(mesh: SolidMesh, matrices: Matrices) -> None:
    """Twice the energy of a strain of 1 along x, over the volume, is lambda + 2 mu, however the cells are bent."""
    stretch = np.zeros((len(mesh.points), 3))
    stretch[:, 0] = mesh.points[:, 0]
    for name, K in matrices.part_stiffness.items():
        lam, mu = lame(MATERIALS[name])
        energy = stretch.ravel() @ (K @ stretch.ravel())
        assert_allclose(energy, (lam + 2 * mu) * np.prod(SIDES) / 2, rtol=1e-12)


def test_a_cell_inside_out_has_negative_volume(mesh: SolidMesh) -> None:
    mirrored = replace(mesh, points=mesh.points * [-1.0, 1.0, 1.0])
    assert_allclose(volumes(mirrored), -volumes(mesh), rtol=1e-12)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"youngs_modulus": None}, "found none"),
        ({"poisson_ratio": None}, "found none"),
        ({"youngs_modulus": -1.0}, "must be positive"),
        ({"youngs_modulus": np.inf}, "finite"),
        ({"poisson_ratio": 0.5}, r"between -1 and 0\.5"),
    ],
)
def test_a_material_that_is_not_elastic_is_refused_by_part_and_field(
    mesh: SolidMesh, change: dict[str, float | None], words: str
) -> None:
    spoilt = Material(name="spoilt", density=1.0, **{"youngs_modulus": 1.0, "poisson_ratio": 0.3, **change})
    with pytest.raises(BadInput, match=f"(?s)of high.*{next(iter(change))}.*{words}"):
        assemble(mesh, {"low": material("steel"), "high": spoilt})
