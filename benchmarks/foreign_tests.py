"""Structures whose truth is none of ours: meshes that CalculiX assembles and beams of another element code, tested and diagnosed.

    python -m benchmarks.foreign_tests OUT [--only WORD ...] [--table]

writes a folder a case into OUT, with the model as its owner would write it, a coarse mesh or a frame in a few lines, and the data
as a laboratory would hand them over (UFF 58 and 55, CSV); it diagnoses what has no answer yet, and prints a row a case. Nothing
of massline is asked for the data: the tested structure is finer, of other elements, its materials a little off, its losses by
mode, its pick-ups glued a little crooked and calibrated as well as certificates say.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from itertools import pairwise, product
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import numpy.typing as npt
import pyuff
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import eigsh, splu

Array = npt.NDArray[Any]
Places = Mapping[str, tuple[float, float, float]]
Box = tuple[float, float, float, float, float, float]
Fault = tuple[str, str, float]
"""Kind, target - of a channel with what it is mistaken for or goes along or about - and size in SI."""

STEEL, ALUMINIUM = (210e9, 0.3, 7850.0), (70e9, 0.33, 2700.0)
GAIN, ANGLE, NOISE, LEVEL, DAMPING = 0.005, 0.5, 0.005, 0.0005, 0.3
"""Scatter of pick-ups [1], [deg]; noise of a line as a share of it and of the level of its run; of the logarithm of a loss."""
FOOT = 0.007
"""[m] Radius of pick-ups and of the tip of a hammer."""
STANDARD_GRAVITY = 9.80665
"""[m/s²] What a pick-up that is stated in m/s² is divided by where it reads in g."""
BESIDE = "beside"
"""Place of the tested structure at which a pick-up sits that is not at its own."""
MODULUS, DENSITY, SUPPORT = 0.015, 0.003, 0.05
"""Scatter of what parts are made of, and of springs."""


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


@dataclass(frozen=True)
class Bench:
    """A structure: its truth, what its owner writes, where it is read and struck (place and axis), and how far."""

    fine: Callable[[], Fine]
    described: Callable[[Path, Places], str]
    places: Places
    responses: tuple[str, ...]
    drives: tuple[str, ...]
    modes: int
    faults: Mapping[str, Fault]
    loss: float = 0.02


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


# A test of it.


@dataclass(frozen=True)
class Tested:
    """Modes (m,) and (m, p) by place and axis, more than enough of them, static answers among them; losses (m,)."""

    frequency: Array
    shapes: dict[str, Array]
    losses: Array


def tested(bench: Bench, fault: Fault | None, seed: int) -> Tested:
    """The structure with materials a little off and with the `fault` in it."""
    draw, fine = np.random.default_rng([seed, 1]), bench.fine()
    kind, target, size = fault or ("", "", 0.0)
    K, M = csc_array(next(iter(fine.stiffness.values())).shape), csc_array(next(iter(fine.mass.values())).shape)
    for part in fine.stiffness:
        softer = 1 + size if (kind, target) == ("modulus", part) else 1.0
        K = K + float(np.exp(MODULUS * draw.standard_normal())) * softer * fine.stiffness[part]
        M = M + float(np.exp(DENSITY * draw.standard_normal())) * fine.mass[part]
    n, d = K.shape[0], fine.per_node
    more, tie = np.zeros(n), 1e3 * abs(K).max()
    at = {name: fine.patch(p) for name, p in bench.places.items()}
    if kind == "beside":
        place, along = target.split(":")[0], "xyz".index(target[-1])
        at[BESIDE] = fine.patch(tuple(np.array(bench.places[place]) + size * np.eye(3)[along]))
    for name, (node, k) in fine.springs.items():
        factor = np.exp(SUPPORT * draw.standard_normal()) * (size if (kind, target) == ("support", name) else 1.0)
        more[d * node : d * node + len(k)] += factor * k
    heavy = dict(fine.masses)
    if kind == "point-mass":
        node = fine.nearest(bench.places[target])
        heavy[node] = heavy.get(node, 0.0) + size
    weights = np.zeros(n)
    for node, kg in heavy.items():
        weights[d * node : d * node + 3] += kg
    for name, (a, b) in fine.ties.items():
        k = np.full(6, tie)
        if kind == "joint" and name.startswith(target.rpartition(":")[0] + ":"):
            k[3 + "xyz".index(target[-1])] = 1 / size
        i, j = 6 * a + np.arange(6), 6 * b + np.arange(6)
        K = K + coo_array(
            (np.concatenate([k, k, -k, -k]), (np.concatenate([i, j, i, j]), np.concatenate([i, j, j, i]))), shape=K.shape
        )
    diagonal = coo_array((more, (np.arange(n), np.arange(n))), shape=K.shape)
    K, M = (K + diagonal).tocsc(), (M + coo_array((weights, (np.arange(n), np.arange(n))), shape=M.shape)).tocsc()
    free = np.setdiff1d(np.flatnonzero(abs(K).sum(axis=0) > 0), fine.held)
    K, M = K[free][:, free], M[free][:, free]
    count = 4 * bench.modes + 10
    shift = -float(K.diagonal().sum() / M.diagonal().sum()) * 1e-7
    _values, vectors = eigsh(K, count, M, sigma=shift, v0=np.ones(len(free)))
    loads = np.zeros((len(free), 3 * len(at)))
    for column, feet in enumerate(at.values()):
        for axis in range(3):
            loads[np.isin(free, d * feet + axis), 3 * column + axis] = 1 / len(feet)
    left = splu((K - shift * M).tocsc()).solve(loads)
    left -= vectors @ (vectors.T @ (M @ left))
    left -= vectors @ (vectors.T @ (M @ left))
    square, turned = np.linalg.eigh(left.T @ (M @ left))
    left = left @ turned[:, square > 1e-12 * square.max()] / np.sqrt(square[square > 1e-12 * square.max()])
    basis = np.hstack([vectors, left])
    square, turned = np.linalg.eigh(basis.T @ (K @ basis))
    basis = basis @ turned
    shapes = {f"{name}:{'xyz'[axis]}": loads[:, 3 * k + axis] @ basis for k, name in enumerate(at) for axis in range(3)}
    losses = bench.loss * np.exp(DAMPING * np.random.default_rng([seed, 2]).standard_normal(len(square)))
    return Tested(frequency=np.sqrt(np.maximum(square, 0)) / (2 * np.pi), shapes=shapes, losses=losses)


def noticed(bench: Bench, made: Tested, fault: Fault | None, seed: int) -> dict[str, Array]:
    """By response what its pick-up feels of every mode: glued a little crooked, calibrated as its certificate says; or turned
    altogether, glued along another axis, beside its place or at another one."""
    draw, found = np.random.default_rng([seed, 3]), {}
    kind, target, size = fault or ("", "", 0.0)
    channel, _, other = target.partition(" ")
    for point in bench.responses:
        place, axis = point.split(":")
        turned = np.radians(ANGLE) * draw.standard_normal(3)
        turned["xyz".index(axis)] = 1.0
        gain = np.exp(GAIN * draw.standard_normal())
        if point == channel and kind == "turned":
            about = np.eye(3)["xyz".index(other)]  # O. Rodrigues
            turned = (
                np.cos(size) * turned + np.sin(size) * np.cross(about, turned) + (1 - np.cos(size)) * about * (about @ turned)
            )
        if point == channel and kind == "direction":
            a, b = "xyz".index(axis), "xyz".index(other)
            turned[[a, b]] = turned[[b, a]]
        place = {"beside": BESIDE, "moved": other}.get(kind, place) if point == channel else place
        found[point] = gain * sum(t * made.shapes[f"{place}:{a}"] for t, a in zip(turned, "xyz", strict=True))
    return found


def elastic(made: Tested) -> Array:
    return np.flatnonzero(made.frequency > 1e-2 * np.sort(made.frequency)[6] if made.frequency[0] < 0.5 else made.frequency > 0)


def mixed(read: Array, bench: Bench, fault: Fault | None, f: Array) -> Array:
    """What is wrong with the channels, (n, c), at frequencies `f` (n,)."""
    kind, target, size = fault or ("", "", 0.0)
    read, at = np.array(read), list(bench.responses)
    if kind == "gain":
        read[..., at.index(target)] *= 1 + size
    if kind == "unit":
        read[..., at.index(target)] /= STANDARD_GRAVITY
    if kind == "delay":
        read[..., at.index(target)] *= np.exp(-2j * np.pi * f * size)
    if kind == "polarity":
        read[..., at.index(target)] *= -1
    if kind == "swap":
        a, b = (at.index(one) for one in target.split(" "))
        read[..., [a, b]] = read[..., [b, a]]
    return read


def functions(folder: Path, bench: Bench, fault: Fault | None, seed: int, csv: bool) -> str:
    """Accelerances of all drives, as UFF 58 or CSV, and the table of the test."""
    made = tested(bench, fault, seed)
    own = elastic(made)
    low, high = 0.5 * made.frequency[own[0]], (made.frequency[own[bench.modes - 1]] + made.frequency[own[bench.modes]]) / 2
    f = np.linspace(low, high, 600)
    f = np.round(f[1] - f[0], 4) * np.arange(int(low / (f[1] - f[0])), int(high / (f[1] - f[0])))
    felt, draw = noticed(bench, made, fault, seed), np.random.default_rng([seed, 4])
    receptance = 1 / ((2 * np.pi * made.frequency) ** 2 * (1 + 1j * made.losses) - (2 * np.pi * f[:, None]) ** 2)
    sign = -((2 * np.pi * f[:, None]) ** 2)
    sets, text = [], ["[[test]]", 'kind = "response-functions"', 'article = "own"']
    files, places = [], {name: k + 1 for k, name in enumerate(bench.places)}
    cell = np.exp(GAIN * draw.standard_normal())
    for drive in bench.drives:
        read = sign * np.array([receptance @ (made.shapes[drive] * felt[one]) for one in bench.responses]).T * cell
        sd = np.hypot(NOISE * np.abs(read), LEVEL * np.median(np.abs(read))) / np.sqrt(2)
        read = mixed(read, bench, fault, f) + sd * (draw.standard_normal(read.shape) + 1j * draw.standard_normal(read.shape))
        if csv:
            names = [f"{one} {part}" for one in bench.responses for part in ("real", "imag")]
            columns = np.column_stack([f, np.stack([read.real, read.imag], axis=2).reshape(len(f), -1)])
            file = f"{drive.replace(':', '-')}.csv"
            np.savetxt(folder / file, columns, delimiter=",", header=",".join(["frequency", *names]), comments="", fmt="%.9g")
            files.append(f'{{ path = "{file}", drive = "{drive}" }}')
        for k, one in enumerate(bench.responses):
            (place, axis), (at, along) = one.split(":"), drive.split(":")
            sets.append(
                pyuff.prepare_58(
                    binary=0,
                    id1="own",
                    func_type=4,
                    rsp_ent_name="NONE",
                    rsp_node=places[place],
                    rsp_dir="xyz".index(axis) + 1,
                    ref_ent_name="NONE",
                    ref_node=places[at],
                    ref_dir="xyz".index(along) + 1,
                    abscissa_spec_data_type=18,
                    ordinate_spec_data_type=12,
                    orddenom_spec_data_type=13,
                    data=read[:, k],
                    x=f,
                    abscissa_spacing=1,
                    abscissa_min=f[0],
                    abscissa_inc=f[1] - f[0],
                    num_pts=len(f),
                    ord_data_type=5,
                )
            )
    if csv:
        text += [f"files = [{', '.join(files)}]", f"responses = {json.dumps(list(bench.responses))}"]
    else:
        pyuff.UFF(str(folder / "test.uff")).write_sets([units(), *sets], "overwrite")
        text += ['file = "test.uff"', f"places = {{ {', '.join(f'{name} = {k}' for name, k in places.items())} }}"]
    return "\n".join(text) + "\n"


def units() -> Any:
    return pyuff.prepare_164(units_code=1, units_description="SI", temp_mode=1, length=1.0, force=1.0, temp=1.0, temp_offset=0.0)


def table(folder: Path, bench: Bench, fault: Fault | None, seed: int) -> str:
    """A table of modes as UFF 55: frequencies to 0.1 %, damping to a tenth, shapes to 2 %."""
    made = tested(bench, fault, seed)
    own, felt, draw = elastic(made)[: bench.modes], noticed(bench, made, fault, seed), np.random.default_rng([seed, 5])
    shapes = mixed(np.array([felt[one] for one in bench.responses]).T, bench, fault, made.frequency)[own]
    shapes = shapes / np.abs(shapes).max(axis=1, keepdims=True)
    shapes = shapes + 0.02 * draw.standard_normal(shapes.shape)
    sets, nodes = [units()], list(bench.places)
    for k, r in enumerate(own):
        along = np.zeros((len(nodes), 3))
        for c, one in enumerate(bench.responses):
            place, axis = one.split(":")
            along[nodes.index(place), "xyz".index(axis)] = shapes[k, c]
        sets.append(
            pyuff.prepare_55(
                model_type=1,
                id1="own",
                analysis_type=2,
                data_ch=2,
                spec_data_type=8,
                data_type=2,
                n_data_per_node=3,
                r1=along[:, 0],
                r2=along[:, 1],
                r3=along[:, 2],
                load_case=0,
                mode_n=k + 1,
                freq=float(made.frequency[r] * (1 + 0.001 * draw.standard_normal())),
                modal_m=1.0,
                modal_damp_vis=float(made.losses[r] / 2 * (1 + 0.1 * draw.standard_normal())),
                modal_damp_his=0.0,
                node_nums=np.arange(1, len(nodes) + 1),
            )
        )
    pyuff.UFF(str(folder / "test.uff")).write_sets(sets, "overwrite")
    named = ", ".join(f"{name} = {k + 1}" for k, name in enumerate(nodes))
    text = ["[[test]]", 'kind = "modal-table"', 'article = "own"', 'file = "test.uff"', f"places = {{ {named} }}"]
    text += [f"sensors = {json.dumps(list(bench.responses))}", "frequency_deviation = 0.001", "damping_deviation = 0.1"]
    return "\n".join([*text, "shapes_deviation = 0.02"]) + "\n"


# The structures.


def described(parts: Mapping[str, str], places: Places, *more: str) -> str:
    named = ", ".join(f'{name} = ["{x} mm", "{y} mm", "{z} mm"]' for name, (x, y, z) in places.items())
    lines = ["[fe_model]", 'kind = "mesh"', 'units = "mm"', *more, f"places = {{ {named} }}"]
    return "\n".join([*lines, *(line for name, said in parts.items() for line in (f"[fe_model.parts.{name}]", said))]) + "\n"


METAL = {"aluminium": ALUMINIUM, "steel": STEEL}


def of(metal: str) -> str:
    E, nu, rho = METAL[metal]
    material = f'{{ density = "{rho:g} kg/m^3", youngs_modulus = "{E / 1e9:g} GPa", poisson_ratio = {nu} }}'
    return f"material = {material}\nloss_factor = 0.02"


def bricks(boxes: Mapping[str, Box], metals: Mapping[str, str], *, fine: float, coarse: float, clamped: bool) -> dict[str, Any]:
    """Truth and model of boxes that are solids in both."""

    @cache
    def truth() -> Fine:
        made = solids(boxes, fine, {name: METAL[metal] for name, metal in metals.items()})
        at = np.flatnonzero(made.points[:, 2] < 1e-9) if clamped else np.zeros(0, dtype=int)
        made.held = np.concatenate([3 * at + k for k in range(3)])
        return made

    def model(folder: Path, places: Places) -> str:
        tetrahedra(folder / "own.msh", boxes, coarse)
        held = ('support = "ground"', 'interface = ["underside"]') if clamped else ('support = "free"',)
        return described({name: of(metal) for name, metal in metals.items()}, places, 'file = "own.msh"', *held)

    return {"fine": truth, "described": model}


PLATE = {
    "plate": (0, 0, 0, 300, 200, 6),
    "rib-1": (0, 40, 6, 300, 48, 30),
    "rib-2": (0, 150, 6, 300, 158, 30),
}
BRACKET = {
    "foot": (0, 0, 0, 120, 80, 12),
    "upright": (0, 0, 12, 10, 80, 132),
    "gusset": (10, 36, 12, 50, 44, 72),
}


def plate() -> Bench:
    corners = {"a": (12, 12, 0), "b": (288, 12, 0), "c": (288, 188, 0), "d": (12, 188, 0), "e": (150, 12, 0), "f": (150, 188, 0)}
    places = {**corners, "g": (150, 100, 0), "h": (12, 100, 0)}
    return Bench(
        **bricks(PLATE, dict.fromkeys(PLATE, "aluminium"), fine=12.5, coarse=22.0, clamped=False),
        places=places,
        responses=tuple(f"{name}:z" for name in places),
        drives=("a:z", "e:z"),
        modes=6,
        faults={
            "mass": ("point-mass", "c", 0.02),
            "softer": ("modulus", "rib-1", -0.2),
            "gain": ("gain", "b:z", 0.08),
            "polarity": ("polarity", "f:z", 0.0),
            "swap": ("swap", "d:z e:z", 0.0),
        },
    )


def bracket() -> Bench:
    places = {
        "tip": (0, 8, 124),
        "side": (0, 72, 124),
        "mid": (0, 40, 124),
        "low": (0, 8, 72),
        "back": (0, 72, 72),
        "knee": (50, 40, 64),
    }
    return Bench(
        **bricks(BRACKET, {"foot": "aluminium", "upright": "aluminium", "gusset": "steel"}, fine=8.0, coarse=14.0, clamped=True),
        places=places,
        responses=("tip:x", "side:x", "mid:x", "low:x", "back:x", "tip:y", "knee:y", "mid:z"),
        drives=("tip:x", "side:y"),
        modes=5,
        faults={
            "mass": ("point-mass", "side", 0.01),
            "softer": ("modulus", "upright", -0.15),
            "gain": ("gain", "mid:x", 0.08),
            "polarity": ("polarity", "low:x", 0.0),
            "swap": ("swap", "tip:x low:x", 0.0),
        },
    )


TOP = {
    "top": (0, 0, 0, 600, 400, 8),
    "apron-1": (0, 60, -40, 600, 66, 0),
    "apron-2": (0, 334, -40, 600, 340, 0),
}
LEGS = {"leg-1": (60, 40), "leg-2": (540, 40), "leg-3": (540, 360), "leg-4": (60, 360)}
LOST = "loss_factor = 0.02"
LEG = 2.5e5
"""[N/m] along every axis."""


def table_top() -> Bench:
    """Solids in truth; shells, middle on middle, and four springs in the model."""
    corners = {"a": (0, 0, 4), "b": (600, 0, 4), "c": (600, 400, 4), "d": (0, 400, 4), "e": (300, 0, 4), "f": (300, 400, 4)}
    places = {**corners, "g": (300, 200, 4), "h": (0, 200, 4)}

    @cache
    def truth() -> Fine:
        made = solids(TOP, 25.0, dict.fromkeys(TOP, STEEL))
        made.springs = {name: (made.nearest((x / 1e3, y / 1e3, 0.004)), np.full(3, LEG)) for name, (x, y) in LEGS.items()}
        return made

    def model(folder: Path, places: Places) -> str:
        nodes: dict[tuple[float, float, float], int] = {}
        deck, count = list[str](), 0
        for part, at, n, m in (
            (
                "top",
                lambda u, v: (u, v, 4.0),
                np.linspace(0, 600, 21),
                np.array([0, 20, 40, 63, 90, 120, 150, 200, 250, 280, 310, 337, 360, 380, 400.0]),
            ),
            ("apron-1", lambda u, v: (u, 63.0, v), np.linspace(0, 600, 21), np.array([-40, -20, 4.0])),
            ("apron-2", lambda u, v: (u, 337.0, v), np.linspace(0, 600, 21), np.array([-40, -20, 4.0])),
        ):
            deck.append(f"*ELEMENT, TYPE=S4, ELSET={part}")
            for (u, w), (v, y) in product(pairwise(n), pairwise(m)):
                count += 1
                own = [nodes.setdefault(at(*p), len(nodes) + 1) for p in ((u, v), (w, v), (w, y), (u, y))]
                deck.append(", ".join(map(str, [count, *own])))
        head = ["*NODE", *(f"{number}, {x}, {y}, {z}" for (x, y, z), number in nodes.items())]
        (folder / "own.inp").write_text("\n".join([*head, *deck, ""]))
        parts = {"top": 'thickness = "8 mm"', "apron-1": 'thickness = "6 mm"', "apron-2": 'thickness = "6 mm"'}
        springs = []
        for name, (node, _) in truth().springs.items():
            x, y = (float(f"{1e3 * each:.6g}") for each in truth().points[node][:2])
            k = [*3 * [f'"{LEG:g} N/m"'], *3 * ['"0 N m/rad"']]
            springs += [f"[fe_model.springs.{name}]", f'at = ["{x} mm", "{y} mm", "4 mm"]', f"stiffness = [{', '.join(k)}]", LOST]
        whole = described(
            {name: f"{of('steel')}\n{said}" for name, said in parts.items()}, places, 'file = "own.inp"', 'support = "ground"'
        )
        return whole + "\n".join([*springs, ""])

    return Bench(
        fine=truth,
        described=model,
        places=places,
        responses=tuple(f"{name}:z" for name in places),
        drives=("a:z", "e:z"),
        modes=6,
        faults={
            "mass": ("point-mass", "c", 0.3),
            "softer": ("modulus", "apron-1", -0.2),
            "support": ("support", "leg-2", 0.6),
            "gain": ("gain", "b:z", 0.08),
            "polarity": ("polarity", "f:z", 0.0),
        },
    )


def cantilever() -> Bench:
    """Two rails of four bays with rungs, clamped at the wall, something on its end."""
    nodes = {f"{side}{k}": (300.0 * k, y, 0.0) for k in range(5) for side, y in (("l", 0.0), ("r", 240.0))}
    bars: dict[str, tuple[str, str]] = {}
    for k in range(4):
        bars |= {
            f"left-{k + 1}": (f"l{k}", f"l{k + 1}"),
            f"right-{k + 1}": (f"r{k}", f"r{k + 1}"),
            f"rung-{k + 1}": (f"l{k + 1}", f"r{k + 1}"),
        }
    up, more = (0.0, 0.0, 1.0), {"r4": 0.4}

    @cache
    def truth() -> Fine:
        made = beams(nodes, {name: [(a, b, up, 20.0, 12.0, ALUMINIUM)] for name, (a, b) in bars.items()}, 8)
        names = list(nodes)
        made.masses = {names.index(name): kg for name, kg in more.items()}
        made.held = np.concatenate([6 * names.index(name) + np.arange(6) for name in ("l0", "r0")])
        return made

    def model(folder: Path, places: Places) -> str:
        E, nu, rho = ALUMINIUM
        where = ", ".join(f'{name} = ["{x} mm", "{y} mm", "{z} mm"]' for name, (x, y, z) in nodes.items())
        members = ", ".join(f'{name} = ["{a}", "{b}"]' for name, (a, b) in bars.items())
        lines = ["[fe_model]", 'kind = "frame"', f"nodes = {{ {where} }}", 'fixed = ["l0", "r0"]', f"members = {{ {members} }}"]
        lines += ['section = { width = "20 mm", thickness = "12 mm", across = "z" }', 'masses = { r4 = "400 g" }', "elements = 2"]
        lines += [f'material = {{ density = "{rho:g} kg/m^3", youngs_modulus = "{E / 1e9:g} GPa", poisson_ratio = {nu} }}']
        return "\n".join([*lines, "loss_factor = 0.02", ""])

    return Bench(
        fine=truth,
        described=model,
        places={name: at for name, at in nodes.items() if name[1] != "0"},
        responses=("l1:z", "r1:z", "l2:z", "r2:z", "l3:z", "r3:z", "l4:z", "r4:z", "l4:y", "l2:y"),
        drives=("l4:z", "r2:z"),
        modes=6,
        faults={
            "mass": ("point-mass", "l3", 0.1),
            "softer": ("modulus", "left-1", -0.2),
            "joint": ("joint", "left-1@l0:y", 2e-4),
            "gain": ("gain", "r3:z", 0.08),
            "swap": ("swap", "l2:z r2:z", 0.0),
            "polarity": ("polarity", "l3:z", 0.0),
            "unit": ("unit", "r1:z", 0.0),
            "delay": ("delay", "r3:z", 2e-4),
            "turned": ("turned", "l4:y x", 0.14),
            "beside": ("beside", "l2:z x", 0.0375),
            "moved": ("moved", "l2:z l3", 0.0),
            "direction": ("direction", "l2:y z", 0.0),
        },
    )


def storeys() -> Bench:
    """Two floors on eight legs, on springs to the ground; a mesh of few beams in the model."""
    feet = [(0.0, 0.0), (600.0, 0.0), (600.0, 400.0), (0.0, 400.0)]
    nodes = {f"{level}{k + 1}": (x, y, 450.0 * number) for number, level in enumerate("gmt") for k, (x, y) in enumerate(feet)}
    members: dict[str, list[Member]] = {}
    for number, (low, high) in enumerate((("g", "m"), ("m", "t"))):
        for side, own in (("left", (1, 4)), ("right", (2, 3))):
            members[f"{side}-{number + 1}"] = [(f"{low}{k}", f"{high}{k}", (1.0, 0.0, 0.0), 18.0, 18.0, STEEL) for k in own]
        members[f"floor-{number + 1}"] = [
            (f"{high}{k}", f"{high}{k % 4 + 1}", (0.0, 0.0, 1.0), 30.0, 20.0, STEEL) for k in range(1, 5)
        ]
    springs = np.array([2e6, 2e6, 5e6, 2e4, 2e4, 2e4])

    @cache
    def truth() -> Fine:
        made = beams(nodes, members, 10)
        made.springs = {f"foot-{k + 1}": (k, springs) for k in range(4)}
        return made

    def model(folder: Path, places: Places) -> str:
        numbers, deck, count = {at: k + 1 for k, at in enumerate(nodes.values())}, list[str](), 0
        for part, own in members.items():
            deck.append(f"*ELEMENT, TYPE=B31, ELSET={part}")
            for start, end, *_ in own:
                one, other = np.array(nodes[start]), np.array(nodes[end])
                for s, t in pairwise(np.linspace(0, 1, 5)):
                    count += 1
                    ends = [numbers.setdefault(tuple(one + (other - one) * each), len(numbers) + 1) for each in (s, t)]
                    deck.append(", ".join(map(str, [count, *ends])))
        head = ["*NODE", *(f"{number}, {x}, {y}, {z}" for (x, y, z), number in numbers.items())]
        (folder / "own.inp").write_text("\n".join([*head, *deck, ""]))
        parts = {}
        for part, bars in members.items():
            _, _, up, b, h, _ = bars[0]
            parts[part] = f'{of("steel")}\nsection = {{ width = "{b} mm", height = "{h} mm", z_axis = {list(up)} }}'
        more = []
        for k in range(4):
            x, y, z = nodes[f"g{k + 1}"]
            said = ", ".join([*(f'"{s:g} N/m"' for s in springs[:3]), *(f'"{s:g} N m/rad"' for s in springs[3:])])
            more += [f"[fe_model.springs.foot-{k + 1}]", f'at = ["{x} mm", "{y} mm", "{z} mm"]', f"stiffness = [{said}]", LOST]
        return described(parts, places, 'file = "own.inp"', 'support = "ground"') + "\n".join([*more, ""])

    return Bench(
        fine=truth,
        described=model,
        places={name: at for name, at in nodes.items() if name[0] != "g"},
        responses=("m1:x", "m1:y", "m3:x", "m3:y", "t1:x", "t1:y", "t3:x", "t3:y", "t2:y", "m2:y"),
        drives=("t1:x", "m3:y"),
        modes=6,
        faults={
            "mass": ("point-mass", "t2", 0.4),
            "softer": ("modulus", "left-1", -0.15),
            "support": ("support", "foot-2", 0.4),
            "gain": ("gain", "t3:x", 0.08),
            "polarity": ("polarity", "m1:y", 0.0),
            "unit": ("unit", "t1:x", 0.0),
            "delay": ("delay", "m3:y", 1e-3),
            "turned": ("turned", "t2:y z", 0.14),
            "beside": ("beside", "t3:y x", -0.06),
            "moved": ("moved", "t3:x m3", 0.0),
            "direction": ("direction", "m1:x y", 0.0),
        },
    )


BENCHES: Mapping[str, Callable[[], Bench]] = {
    "plate": plate,
    "bracket": bracket,
    "table-top": table_top,
    "cantilever": cantilever,
    "storeys": storeys,
}
SOUND = 2
"""[count] of sound articles of each structure and kind of test."""


def cases() -> list[tuple[str, str, str, int]]:
    """Name, structure, fault or nothing, and seed of every case; functions of every fault, tables of those that a table shows."""
    found = []
    for at, (name, bench) in enumerate(BENCHES.items()):
        for kind in ("functions", "table"):
            found += [(f"{name}-{kind}-sound-{k + 1}", name, "", 1000 * at + k) for k in range(SOUND)]
            faults = [
                (k, fault) for k, fault in enumerate(bench().faults) if (kind, fault) != ("table", "delay")
            ]  # shapes are real
            found += [(f"{name}-{kind}-{fault}", name, fault, 1000 * at + 100 + k) for k, fault in faults]
    return found


def written(folder: Path, case: tuple[str, str, str, int]) -> None:
    """Model and data of a case."""
    name, structure, fault, seed = case
    bench, kind = BENCHES[structure](), name.split(f"{structure}-")[1].split("-")[0]
    folder.mkdir(parents=True)
    fine = bench.fine()
    at: dict[str, tuple[float, float, float]] = {}
    for place, p in bench.places.items():
        x, y, z = (float(f"{x:.6g}") for x in 1e3 * fine.points[fine.nearest(tuple(np.array(p) / 1e3))])
        at[place] = (x, y, z)
    bench = Bench(**{**vars(bench), "places": {name: tuple(np.array(p) / 1e3) for name, p in at.items()}})
    planted = bench.faults[fault] if fault else None
    test = (
        functions(folder, bench, planted, seed, csv=seed % 2 == 1) if kind == "functions" else table(folder, bench, planted, seed)
    )
    model = bench.described(folder, at)
    head = 'format = 1\nmodel = { title = "own", article = "own" }\n[tolerances]\nclass = "calibrated"\n'
    (folder / "own.toml").write_text(f"{head}{model}{test}")
    (folder / "truth.json").write_text(json.dumps({"planted": planted}))


TURNS = {"x": "alpha", "y": "beta", "z": "gamma"}


def verdict(fault: Fault | None, answer: Mapping[str, object]) -> str:
    """`quiet`, `named`, `class`, `beside` (more is named with it), `missed`, `wrong`, `unknown` or `refused`."""
    if "refused" in answer:
        return "refused"
    said, accepted = str(answer["verdict"]), [str(one["id"]) for one in answer["accepted"]]  # type: ignore[attr-defined]
    if not fault:
        return "quiet" if said == "nothing" else ("unknown" if not accepted else "wrong")
    if not accepted:
        return "missed" if said == "nothing" else "unknown"
    kind, target, _ = fault
    channel = [one.replace(":", "-") for one in target.split()]
    right = {
        "point-mass": [f"point-mass:{target}"],
        "modulus": [f"modulus:{target}"],
        "support": [f"support-stiffness:{target}"],
        "joint": [f"connection-compliance:{target.rpartition(':')[0]}:{TURNS.get(target[-1])}"],
        "gain": [f"accelerometer-gain:{channel[0]}"],
        "polarity": [f"polarity:{channel[0]}"],
        "unit": [f"unit:{channel[0]}"],
        "delay": [f"accelerometer-delay:{channel[0]}"],
        "turned": [f"accelerometer-misalignment:{':'.join(channel)}"],
        "beside": [f"accelerometer-position:{':'.join(channel)}"],
        "moved": [f"wrong-place:{':'.join(channel)}"],
        "direction": [f"wrong-direction:{':'.join(channel)}"],
        "swap": [":".join(["channel-swap", *channel]), ":".join(["channel-swap", *channel[::-1]])],
    }[kind]
    if accepted[0] in right and len(accepted) == 1:
        return "named"
    if any(one in right for one in accepted):
        return "beside"
    alike = [one for each in answer["accepted"] for one in each.get("same", [])]  # type: ignore[attr-defined]
    alike += [one for each in answer.get("class", []) for one in (each if isinstance(each, list) else [each])]  # type: ignore[attr-defined]
    return "class" if any(one in right for one in alike) else "wrong"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--only", nargs="*", default=[], help="words that the name of a case has one of")
    parser.add_argument("--again", action="store_true", help="answer again what has an answer")
    parser.add_argument("--table", action="store_true", help="nothing but the table of what is answered")
    asked = parser.parse_args()
    counts: dict[str, int] = {}
    for case in cases():
        name, _, fault, _ = case
        folder = asked.out / name
        if asked.only and not any(word in name for word in asked.only):
            continue
        if not folder.exists() and not asked.table:
            written(folder, case)
        answer = folder / "answer.json"
        if not asked.table and (asked.again or not answer.exists()):
            before = os.times()
            run = subprocess.run(
                [str(Path(sys.executable).with_name("massline")), "diagnose", "own.toml", "--json"],
                cwd=folder,
                capture_output=True,
                text=True,
                check=False,
            )
            spent = os.times().children_user + os.times().children_system - before.children_user - before.children_system
            text = run.stdout if run.stdout.startswith("{") else json.dumps({"refused": run.stderr[-1000:]})
            answer.write_text(json.dumps({**json.loads(text), "seconds": spent}))
        if not answer.exists():
            continue
        found, planted = json.loads(answer.read_text()), json.loads((folder / "truth.json").read_text())["planted"]
        said = verdict(planted, found)
        key = f"{'fault' if fault else 'sound'} {said}"
        counts[key] = counts.get(key, 0) + 1
        sys.stdout.write(f"{name:32} {said:8} {found.get('verdict', '')} {found.get('seconds', 0):5.0f} s {summary(found)}\n")
        sys.stdout.flush()
    sys.stdout.write(", ".join(f"{key} {n}" for key, n in sorted(counts.items())) + "\n")
    return 0


def summary(found: Mapping[str, object]) -> str:
    """What was named with its size, or why nothing was answered."""
    if "refused" in found:
        return str(found["refused"]).strip().replace("\n", " ")[-150:]
    named = [f"{one['id']} {one['value'] or 0:.3g}" for one in found["accepted"]]  # type: ignore[attr-defined]
    return "; ".join(named)


if __name__ == "__main__":
    sys.exit(main())
