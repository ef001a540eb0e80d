"""Rows about what any solid element must do: strain evenly when its edges do, resist no rigid motion, weigh what it weighs, and
care for no unit."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from fem.solid.elasticity import lame
from fem.solid.mesh import SolidMesh
from fem.structure import rigid_motion
from geometry.arrays import Array
from geometry.inertia import Inertia
from geometry.materials import Material
from validation.verification.check import Check, Error, Found, Mesh
from validation.verification.grids import HEX, TET, block
from validation.verification.solids import CELLS, YOUNG, steel
from validation.verification.solutions import floating, solid

FAMILY = "Patch, rigid body, units"

SIDES = (1.0, 0.8, 0.6)
"""[m]"""

SHIFTED = 0.1
"""How far the points inside a patch lie from their regular places, as a share of a cell."""

STRAIN = np.array([[3.0, 1.0, -2.0], [1.0, -1.0, 0.5], [-2.0, 0.5, 2.0]]) * 1e-4


def distorted(nodes: int) -> SolidMesh:
    """Two cells along each side, the inner vertex and all edges and faces inside away from their regular places."""
    counts = (2, 2, 2)
    inner = np.random.default_rng(3)

    def bent(points: Array) -> Array:
        inside = np.all((points > 1e-9) & (points < np.array(SIDES) - 1e-9), axis=1)
        moves = inner.uniform(-SHIFTED, SHIFTED, points.shape) * np.array(SIDES) / counts
        return np.asarray(points + moves * inside[:, None])

    return block(SIDES, counts, nodes, bent)


def _patch(nodes: int) -> tuple[SolidMesh, Array, Array]:
    """The distorted mesh, its displacements under an even strain, and those that the elements find from the surface's alone."""
    from scipy.sparse.linalg import spsolve

    mesh = distorted(nodes)
    K = solid(mesh, steel(0.3)).stiffness.tocsc()
    exact = (mesh.points @ STRAIN).ravel()
    surface = np.any(np.isclose(mesh.points, 0) | np.isclose(mesh.points, SIDES), axis=1)
    inside = np.flatnonzero(np.repeat(~surface, 3))
    outside = np.flatnonzero(np.repeat(surface, 3))
    found = exact.copy()
    found[inside] = spsolve(K[inside][:, inside], -K[inside][:, outside] @ exact[outside])
    return mesh, exact, found


def _patch_displacement(nodes: int, mesh: Mesh) -> Found:
    _, exact, found = _patch(nodes)
    return Found(0.0, float(np.max(np.abs(found - exact)) / np.max(np.abs(exact))))


def _patch_energy(nodes: int, mesh: Mesh) -> Found:
    """Strain energy [J]: half of stress times strain times volume, and half of u^T K u."""
    patch, exact, _ = _patch(nodes)
    lam, mu = lame(steel(0.3))
    stress = lam * np.trace(STRAIN) * np.eye(3) + 2 * mu * STRAIN
    K = solid(patch, steel(0.3)).stiffness
    return Found(float(0.5 * np.sum(stress * STRAIN) * np.prod(SIDES)), float(0.5 * exact @ (K @ exact)))


def _rigid_force(nodes: int, mesh: Mesh) -> Found:
    patch = distorted(nodes)
    K, T = solid(patch, steel(0.3)).stiffness, _rigid(patch)
    return Found(0.0, float(np.max(np.abs(K @ T) / np.max(abs(K) @ np.abs(T), axis=0))))


def _rigid_modes(nodes: int, mesh: Mesh) -> Found:
    """Zero, and the sixth eigenvalue of the free body as a share of the seventh."""
    matrices = solid(distorted(nodes), steel(0.3))
    values = floating(matrices.stiffness, matrices.mass, 8).values
    return Found(0.0, float(np.max(np.abs(values[:6])) / values[6]))


def _rigid_count(nodes: int, mesh: Mesh) -> Found:
    matrices = solid(distorted(nodes), steel(0.3))
    values = floating(matrices.stiffness, matrices.mass, 12).values
    return Found(6.0, float(np.sum(values < 1e-6 * values[-1])))


def _rigid_mass(nodes: int, mesh: Mesh) -> Found:
    """Zero, and the largest deviation from the block's 6x6 mass matrix about its corner, as a share of its own entries' scale."""
    straight = block(SIDES, (2, 2, 2), nodes)  # the quadrature is exact for straight cells only
    T = _rigid(straight)
    mass = steel(0.3).density * float(np.prod(SIDES))
    a, b, c = SIDES
    tensor = np.diag([b * b + c * c, a * a + c * c, a * a + b * b]) * mass / 12
    expected = Inertia.from_cog(mass, np.array(SIDES) / 2, tensor).mass_matrix
    scale = np.sqrt(np.diag(expected))
    return Found(0.0, float(np.max(np.abs(T.T @ (solid(straight, steel(0.3)).mass @ T) - expected) / np.outer(scale, scale))))


def _rigid(mesh: SolidMesh) -> Array:
    return rigid_motion(mesh.points).reshape(-1, 6, 6)[:, :3].reshape(-1, 6)


def _lowest(scale: float, material: Material, nodes: int) -> float:
    """Lowest elastic frequency of the free block whose sides are `scale` times `SIDES`."""
    matrices = solid(block([scale * side for side in SIDES], (2, 2, 2), nodes), material)
    return float(np.sqrt(floating(matrices.stiffness, matrices.mass, 8).values[6]) / (2 * np.pi))


def _scaled(nodes: int, mesh: Mesh) -> Found:
    """Lowest elastic frequency [Hz] of the block, and three times that of the block three times as long, wide and high."""
    return Found(_lowest(1.0, steel(0.3), nodes), 3 * _lowest(3.0, steel(0.3), nodes))


def _millimetres(nodes: int, mesh: Mesh) -> Found:
    """Lowest elastic frequency [Hz] in metres, kilograms and pascals, and in millimetres, tonnes and megapascals."""
    other = Material(name="steel", density=7850e-12, youngs_modulus=YOUNG / 1e6, poisson_ratio=0.3)
    return Found(_lowest(1.0, steel(0.3), nodes), _lowest(1e3, other, nodes))


def _row(what: str, source: str, unit: str, bar: float, find: Callable[[Mesh], Found], error: Error) -> Check:
    return Check(family=FAMILY, what=what, source=source, unit=unit, bar=bar, find=find, error=error)


def _of(nodes: int) -> tuple[Check, ...]:
    cells = f"distorted {CELLS[nodes]}"

    def zero(what: str, source: str, bar: float, find: Callable[[int, Mesh], Found]) -> Check:
        return _row(what, source, "", bar, partial(find, nodes), Error.ABSOLUTE)

    def same(what: str, source: str, unit: str, bar: float, find: Callable[[int, Mesh], Found]) -> Check:
        return _row(what, source, unit, bar, partial(find, nodes), Error.RELATIVE)

    return (
        zero(f"Patch test of {cells}: displacement", "even strain prescribed on the surface", 1e-10, _patch_displacement),
        same(f"Patch test of {cells}: strain energy", "stress times strain times volume, halved", "J", 1e-10, _patch_energy),
        zero(f"Rigid motions of {cells}: force per stiffness and motion", "a rigid body is not strained", 1e-12, _rigid_force),
        zero(f"Rigid motions of {cells}: sixth eigenvalue over the seventh", "a free body has six", 1e-7, _rigid_modes),
        same(f"Rigid motions of {cells}: how many", "a free body has six", "", 0.0, _rigid_count),
        zero(f"Rigid mass matrix of {CELLS[nodes]}", "block about its corner, closed form", 1e-12, _rigid_mass),
        same(f"Block of {CELLS[nodes]}, three times as large", "frequency falls with the size", "Hz", 1e-8, _scaled),
        same(f"Block of {CELLS[nodes]} in mm, t and MPa", "the same in m, kg and Pa", "Hz", 1e-8, _millimetres),
    )


CHECKS: tuple[Check, ...] = (*_of(HEX), *_of(TET))
