"""The solid model of any article: mesh, matrices and base in one `Structure`."""

from __future__ import annotations

import numpy as np

from fem.solid.bodies import AnyArticle, bodies
from fem.solid.elasticity import assemble
from fem.solid.mesh import Integers, SolidMesh
from fem.solid.sizing import Sizing
from fem.solid.tetrahedra import tetrahedra
from fem.structure import Structure
from geometry.arrays import Array
from geometry.frames import rigid_transformation
from geometry.materials import Material


def structure(article: AnyArticle, sizing: Sizing | None = None) -> Structure:
    """`article` as curved tetrahedra."""
    found = bodies(article)
    mesh = tetrahedra(found, sizing)
    return of_mesh(mesh, {body.name: body.material for body in found})


def of_mesh(mesh: SolidMesh, materials: dict[str, Material]) -> Structure:
    matrices = assemble(mesh, materials)
    return Structure(
        stiffness=matrices.stiffness,
        mass=matrices.mass,
        rigid=np.vstack([rigid_transformation(point) for point in mesh.points]),
        held=np.sort(_dofs(base(mesh)).ravel()),
        points=mesh.points,
        translations=_dofs(np.arange(len(mesh.points))),
        part_stiffness=matrices.part_stiffness,
        loss_factors={name: m.loss_factor for name, m in materials.items() if m.loss_factor is not None},
    )


def base(mesh: SolidMesh) -> Integers:
    z = mesh.points[:, 2]
    return np.flatnonzero(z < z.min() + 1e-6 * np.ptp(z))


def _dofs(nodes: Integers) -> Integers:
    return np.asarray(3 * nodes[:, None] + np.arange(3), dtype=np.intp)
