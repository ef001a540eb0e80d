"""The tested structures: solids that CalculiX assembles, and beams of an own element code."""

from __future__ import annotations

import subprocess
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise, product
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array, csc_array

Array = npt.NDArray[Any]
Places = Mapping[str, tuple[float, float, float]]
Box = tuple[float, float, float, float, float, float]

STEEL, ALUMINIUM = (210e9, 0.3, 7850.0), (70e9, 0.33, 2700.0)
FOOT = 0.007
"""[m] Radius of pick-ups and of the tip of a hammer."""


@dataclass
class Fine:
    """The tested structure on its own mesh: degrees of freedom 6 (or 3) a node, stiffness and mass by part, springs by node."""

    points: Array
    per_node: int
    stiffness: dict[str, csc_array] = field(default_factory=dict)
    mass: dict[str, csc_array] = field(default_factory=dict)
    springs: dict[str, tuple[int, Array]] = field(default_factory=dict)
    ties: dict[str, tuple[int, int]] = field(default_factory=dict)
    masses: dict[int, float] = field(default_factory=dict)
    held: Array = field(default_factory=lambda: np.zeros(0, dtype=int))

    def nearest(self, at: tuple[float, float, float]) -> int:
        return int(np.argmin(np.linalg.norm(self.points - np.array(at), axis=1)))

    def patch(self, at: tuple[float, float, float]) -> Array:
        """What a pick-up or the tip of a hammer rests on: of solids all nodes within `FOOT` that lie evenly about the nearest."""
        centre = self.nearest(at)
        if self.per_node == 6:
            return np.array([centre])
        away = self.points - self.points[centre]
        near = np.flatnonzero(np.linalg.norm(away, axis=1) < FOOT)
        even = [k for k in near if np.min(np.linalg.norm(away[near] + away[k], axis=1)) < 1e-6]
        return np.array(even)


# Solids: boxes on one grid of hexahedra, assembled by CalculiX.


def grid(boxes: Mapping[str, Box], size: float) -> tuple[Array, dict[str, Array]]:
    """Nodes [m] and twenty-node hexahedra by part of boxes [mm] on a common grid of about `size`."""
    axes = []
    for k in range(3):
        ends = np.unique([box[k + 3 * side] for box in boxes.values() for side in (0, 1)])
        axes.append(
            np.concatenate([np.linspace(a, b, max(round((b - a) / size), 2) + 1)[:-1] for a, b in pairwise(ends)] + [ends[-1:]])
        )
    corners = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
    edges = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
    places = corners + [tuple((np.array(corners[a]) + corners[b]) // 2) for a, b in edges]
    half = [np.insert(a.repeat(2)[1:-1].reshape(-1, 2).mean(axis=1), np.arange(1, len(a) - 1), a[1:-1]) for a in axes]
    full = [np.concatenate([a[:1], h, a[-1:]]) for a, h in zip(axes, half, strict=True)]
    number: dict[tuple[int, ...], int] = {}
    elements: dict[str, list[list[int]]] = {name: [] for name in boxes}
    for cell in product(*(range(len(a) - 1) for a in axes)):
        middle = np.array([(axes[k][cell[k]] + axes[k][cell[k] + 1]) / 2 for k in range(3)])
        part = next((n for n, b in boxes.items() if np.all(middle > b[:3]) and np.all(middle < b[3:])), None)
        if part is not None:
            keys = [tuple(2 * c + p for c, p in zip(cell, place, strict=True)) for place in places]
            elements[part].append([number.setdefault(key, len(number)) for key in keys])
    points = np.array([[full[k][key[k]] for k in range(3)] for key in number]) / 1e3
    return points, {name: np.array(each) for name, each in elements.items()}


def rows(number: int, nodes: Array) -> str:
    whole = [str(number), *(str(n + 1) for n in nodes)]
    return ", ".join(whole[:15]) + (",\n" + ", ".join(whole[15:]) if len(whole) > 15 else "")


def solids(boxes: Mapping[str, Box], size: float, materials: Mapping[str, tuple[float, float, float]]) -> Fine:
    """Boxes of quadratic hexahedra with reduced integration, a run of CalculiX a part."""
    points, elements = grid(boxes, size)
    made = Fine(points=points, per_node=3)
    for part, own in elements.items():
        E, nu, rho = materials[part]
        used = np.unique(own)
        deck = ["*NODE", *(f"{n + 1}, {x:.12g}, {y:.12g}, {z:.12g}" for n in used for x, y, z in (points[n],))]
        deck += ["*ELEMENT, TYPE=C3D20R, ELSET=A", *(rows(k + 1, nodes) for k, nodes in enumerate(own))]
        deck += ["*MATERIAL, NAME=M", "*ELASTIC", f"{E}, {nu}", "*DENSITY", f"{rho}", "*SOLID SECTION, ELSET=A, MATERIAL=M"]
        deck += ["*STEP", "*FREQUENCY, SOLVER=MATRIXSTORAGE", "*END STEP", ""]
        with TemporaryDirectory() as scratch:
            Path(scratch, "a.inp").write_text("\n".join(deck))
            subprocess.run(["ccx", "a"], cwd=scratch, check=False, capture_output=True)  # it ends with 201 after storing
            dof = np.array([line.split(".") for line in Path(scratch, "a.dof").read_text().split()], dtype=int)
            at = 3 * (dof[:, 0] - 1) + dof[:, 1] - 1
            for name, into in (("sti", made.stiffness), ("mas", made.mass)):
                i, j, value = np.loadtxt(Path(scratch, f"a.{name}"), unpack=True)
                i, j = at[i.astype(int) - 1], at[j.astype(int) - 1]
                upper = coo_array((value, (i, j)), shape=(3 * len(points),) * 2)
                off = i != j
                into[part] = (upper + coo_array((value[off], (j[off], i[off])), shape=upper.shape)).tocsc()
    return made


def tetrahedra(path: Path, boxes: Mapping[str, Box], size: float) -> None:
    """The owner's mesh of the same boxes: gmsh, ten nodes each, a physical group a part, `underside` what lies at z = 0."""
    import gmsh

    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        solid = [gmsh.model.occ.addBox(*b[:3], *(np.array(b[3:]) - b[:3])) for b in boxes.values()]
        _, pieces = gmsh.model.occ.fragment([(3, solid[0])], [(3, one) for one in solid[1:]])
        gmsh.model.occ.synchronize()
        for name, piece in zip(boxes, pieces, strict=True):
            gmsh.model.addPhysicalGroup(3, [tag for _, tag in piece], name=name)
        low = gmsh.model.getEntitiesInBoundingBox(-1e3, -1e3, -1e-3, 1e3, 1e3, 1e-3, 2)
        gmsh.model.addPhysicalGroup(2, [tag for _, tag in low], name="underside")
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.option.setNumber("Mesh.SaveGroupsOfNodes", 1)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(2)
        gmsh.write(str(path))
    finally:
        gmsh.finalize()


# Beams of Timoshenko, three-dimensional (J. S. Przemieniecki, Theory of Matrix Structural Analysis, 1968, sections 5.6 and 11.3).


def beam(one: Array, other: Array, up: Array, b: float, h: float, material: tuple[float, float, float]) -> tuple[Array, Array]:
    """(12, 12) stiffness and consistent mass; width b along y, height h along z, which lies in the plane of `up`."""
    E, nu, rho = material
    G, A, L = E / (2 + 2 * nu), b * h, float(np.linalg.norm(other - one))
    long, short = max(b, h), min(b, h)
    J = long * short**3 * (1 / 3 - 0.21 * short / long * (1 - (short / long) ** 4 / 12))
    K, M = np.zeros((12, 12)), np.zeros((12, 12))
    for pair, stiff, heavy in (((0, 6), E * A / L, rho * A * L), ((3, 9), G * J / L, rho * L * (b * h**3 + h * b**3) / 12)):
        K[np.ix_(pair, pair)] += stiff * np.array([[1, -1], [-1, 1]])
        M[np.ix_(pair, pair)] += heavy / 6 * np.array([[2, 1], [1, 2]])
    # Bending in x-y about z, then in x-z about y, whose rotations have the other sign
    for dofs, sign, inertia in (((1, 5, 7, 11), 1, h * b**3 / 12), ((2, 4, 8, 10), -1, b * h**3 / 12)):
        p = 12 * E * inertia / (G * A * 5 / 6 * L**2)
        s = np.array([1, sign, 1, sign])
        k = (
            E
            * inertia
            / (L**3 * (1 + p))
            * np.array(
                [
                    [12, 6 * L, -12, 6 * L],
                    [6 * L, (4 + p) * L**2, -6 * L, (2 - p) * L**2],
                    [-12, -6 * L, 12, -6 * L],
                    [6 * L, (2 - p) * L**2, -6 * L, (4 + p) * L**2],
                ]
            )
        )
        m = (
            rho
            * A
            * L
            / 420
            * np.array(
                [
                    [156, 22 * L, 54, -13 * L],
                    [22 * L, 4 * L**2, 13 * L, -3 * L**2],
                    [54, 13 * L, 156, -22 * L],
                    [-13 * L, -3 * L**2, -22 * L, 4 * L**2],
                ]
            )
        )
        K[np.ix_(dofs, dofs)] += s[:, None] * k * s
        M[np.ix_(dofs, dofs)] += s[:, None] * m * s
    x = (other - one) / L
    z = up - (up @ x) * x
    z /= np.linalg.norm(z)
    T = np.kron(np.eye(4), np.array([x, np.cross(z, x), z]))
    return T.T @ K @ T, T.T @ M @ T


Member = tuple[str, str, tuple[float, float, float], float, float, tuple[float, float, float]]


def beams(nodes: Mapping[str, tuple[float, float, float]], members: Mapping[str, list[Member]], count: int) -> Fine:
    """Members by part: two nodes [mm], the direction of the height, width, height [mm], material; each of `count` elements, tied
    to its nodes by what joints may loosen."""
    points, found = [np.array(p) / 1e3 for p in nodes.values()], Fine(points=np.zeros((0, 3)), per_node=6)
    names, pieces = list(nodes), list[tuple[str, int, int, Array, Array]]()
    for part, bars in members.items():
        for a, b, up, width, height, material in bars:
            ends = [points[names.index(a)], points[names.index(b)]]
            along = list(range(len(points), len(points) + count + 1))
            points += [ends[0] + (ends[1] - ends[0]) * k / count for k in range(count + 1)]
            for k, other in pairwise(along):
                pieces.append(
                    (part, k, other, *beam(points[k], points[other], np.array(up), width / 1e3, height / 1e3, material))
                )
            for node, end in ((a, along[0]), (b, along[-1])):
                found.ties[f"{part}@{node}:{a}-{b}"] = (names.index(node), end)
    found.points = np.array(points)
    size = 6 * len(points)
    for part in members:
        own = [
            (np.concatenate([6 * a + np.arange(6), 6 * b + np.arange(6)]), K, M) for name, a, b, K, M in pieces if name == part
        ]
        i, j = np.concatenate([np.repeat(d, 12) for d, _, _ in own]), np.concatenate([np.tile(d, 12) for d, _, _ in own])
        for into, each in ((found.stiffness, [K for _, K, _ in own]), (found.mass, [M for _, _, M in own])):
            into[part] = coo_array((np.concatenate([m.ravel() for m in each]), (i, j)), shape=(size, size)).tocsc()
    return found
