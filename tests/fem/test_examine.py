"""The doctor for models: planted slips are named, the right one first; sound models have none."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse import csr_array

from benchmarks.read_meshes import STEEL, abaqus, bricks
from fem.beam.elements import Section
from fem.beam.frame import Body, Member, Plan, assemble
from fem.structure import rigid_motion
from fem.user_model import examine, freedoms, matrix_checks
from fem.user_model.description import Description
from fem.user_model.units import unit_system
from geometry.errors import BadInput
from geometry.inertia import Inertia

Arrays = dict[str, Any]

METALS = ((210e9, 7850.0), (70e9, 2700.0), (110e9, 4430.0), (45e9, 1800.0))
"""Young's modulus [Pa] and density [kg/m³]."""

UNITS = ("m-kg-N-s", "mm-t-N-s", "mm-kg-mN-s", "mm-kg-kN-ms", "in-lbf-s", "ft-lbf-s")


@dataclass(frozen=True, eq=False, kw_only=True)
class Sample:
    """A model: `arrays` in SI (stiffness, mass, dof, nodes, coordinates), its interface and what else its description says."""

    arrays: Arrays
    interface: tuple[int, ...]
    units: str = "m-kg-N-s"
    stated: str = ""
    sparse: bool = False
    ending: str = ".npz"
    kind: str = "matrices"
    said: str = ""
    support: str = "base"

    def spoilt(self, slip: Callable[[Arrays], Any]) -> "Sample":
        """A copy after `slip` has been at its arrays."""
        arrays = {name: np.array(array) for name, array in self.arrays.items()}
        slip(arrays)
        return replace(self, arrays=arrays)

    def text(self) -> str:
        interface = f"interface = {list(self.interface)}\n" if self.interface else ""
        interface = interface if self.support == "base" else f'support = "{self.support}"\n'
        return (
            f'format = 1\n\n[fe_model]\nname = "sample"\nkind = "{self.kind}"\nunits = "{self.said or self.units}"\n'
            f'reference_point = ["0 m", "0 m", "0 m"]\n{interface}\n[stated]\n{self.stated}'
        )

    def write(self, folder: Path) -> Path:
        """Its file, in its units, with the description inside."""
        u, arrays = unit_system(self.units, ""), dict(self.arrays)
        if self.kind == "matrices":
            s = u.coordinates(np.asarray(arrays["dof"])[:, 1])
            powers = {"stiffness": 0, "mass": 2, "viscous": 1, "structural": 0}
            for name in [name for name in arrays if name.partition("/")[0] in powers]:
                A = np.asarray(arrays[name])
                if A.shape == (len(s), len(s)):
                    arrays[name] = A * np.outer(s, s) / (u.energy * u.time ** powers[name.partition("/")[0]])
            arrays["coordinates"] = np.asarray(arrays["coordinates"]) / u.length
        else:
            arrays["participation"] = arrays["participation"] / (u.six[:, None] * np.sqrt(u.mass))
            arrays["rigid_mass"] = arrays["rigid_mass"] / (np.outer(u.six, u.six) * u.mass)
        packed: Arrays = {}
        for name, array in arrays.items():
            if self.sparse and name in ("stiffness", "mass") and np.ndim(array) == 2:
                A = csr_array(np.asarray(array))
                packed |= {f"{name}/data": A.data, f"{name}/indices": A.indices, f"{name}/indptr": A.indptr}
                packed[f"{name}/shape"] = np.array(A.shape)
            else:
                packed[name] = np.asarray(array)
        path = folder / f"model{self.ending}"
        if self.ending == ".npz":
            np.savez(path, description=np.array(self.text()), **packed)
            return path
        import h5py

        with h5py.File(path, "w") as file:
            file.attrs["description"] = self.text()
            for name, array in packed.items():
                file[name] = array
        return path


def frequencies(sample: Sample, count: int = 5, held: bool = True) -> np.ndarray:
    """The lowest [Hz] with the interface held, or of the free structure without its rigid motions."""
    dof = sample.arrays["dof"]
    free = ~np.isin(dof[:, 0], sample.interface) if held else np.ones(len(dof), dtype=bool)
    K, M = (np.asarray(sample.arrays[name])[np.ix_(free, free)] for name in ("stiffness", "mass"))
    shift = 0.0 if held else 1e-6 * np.median(np.diag(K)[np.diag(M) > 0] / np.diag(M)[np.diag(M) > 0])
    theta = eigh(M, K + shift * M, eigvals_only=True)[::-1]
    values = 1 / theta[: count + 6] - shift
    return np.sqrt(values[0 if held else 6 :][:count]) / (2 * np.pi)


def section(width: float, height: float, E: float, rho: float) -> Section:
    """A solid rectangle."""
    area, about_y, about_z = width * height, width * height**3 / 12, height * width**3 / 12
    small, large = sorted((width, height))
    return Section(
        axial=E * area,
        torsion=E / 2.6 * large * small**3 / 3 * (1 - 0.63 * small / large),
        bending_y=E * about_y,
        bending_z=E * about_z,
        mass=rho * area,
        rotary_y=rho * about_y,
        rotary_z=rho * about_z,
    )


def _of_plan(plan: Plan, **more: Any) -> Sample:
    made = assemble(plan)
    nodes = np.arange(len(plan.nodes)) + 101
    dof = np.array([(node, component) for node in nodes for component in range(1, 7)])
    arrays = {
        "stiffness": sum(made.stiffness.values(), np.zeros_like(made.mass)),
        "mass": made.mass,
        "dof": dof,
        "nodes": nodes,
        "coordinates": np.array(plan.nodes),
    }
    return Sample(arrays=arrays, **{"interface": (101,), **more})


def frame(generator: np.random.Generator, **more: Any) -> Sample:
    """Storeys of four legs and four beams, clamped at the four feet; legs are divided."""
    E, rho = METALS[generator.integers(len(METALS))]
    storeys, wide, deep = int(generator.integers(1, 4)), *generator.uniform(0.3, 2.0, 2)
    levels = np.concatenate([[0.0], np.cumsum(generator.uniform(0.2, 1.0, storeys))])
    corners = [(0.0, 0.0), (wide, 0.0), (wide, deep), (0.0, deep)]
    points = [[x, y, z] for z in levels for x, y in corners]
    leg, beam = (section(*(generator.uniform(0.008, 0.03, 2)), E, rho) for _ in range(2))
    members = []
    for level in range(storeys):
        for corner in range(4):
            low, high = 4 * level + corner, 4 * level + 4 + corner
            points.append(list((np.array(points[low]) + np.array(points[high])) / 2))
            members.append(Member(nodes=(low, len(points) - 1, high), section=leg, z_axis=np.array([1.0, 0.0, 0.0])))
            following = 4 * level + 4 + (corner + 1) % 4
            members.append(Member(nodes=(high, following), section=beam, z_axis=np.array([0.0, 0.0, 1.0])))
    plan = Plan(nodes=np.array(points), carriers=tuple(range(len(points))), members=tuple(members))
    return _of_plan(plan, **{"interface": (101, 102, 103, 104), **more})


def chain(generator: np.random.Generator, **more: Any) -> Sample:
    """Rigid bodies joined by thin beams in a crooked line, clamped at one end."""
    E, rho = METALS[generator.integers(len(METALS))]
    count = int(generator.integers(5, 12))
    steps = generator.uniform(0.05, 0.3, (count, 3)) * np.array([1.0, 0.4, 0.3])
    points = np.vstack([np.zeros(3), np.cumsum(steps, axis=0)])
    thin = section(*generator.uniform(0.005, 0.02, 2), E, rho)
    members = []
    for k in range(count):
        along = steps[k] / np.linalg.norm(steps[k])
        across = np.cross(along, [0.0, 0.0, 1.0])
        members.append(Member(nodes=(k, k + 1), section=thin, z_axis=across / np.linalg.norm(across)))
    bodies = []
    for k in range(1, count + 1):
        mass, sides = generator.uniform(0.5, 5.0), generator.uniform(0.02, 0.1, 3) ** 2
        moments = mass / 12 * (sides.sum() - sides)
        bodies.append(Body(node=k, inertia=Inertia(parameters=np.array([mass, 0, 0, 0, *moments, 0, 0, 0]))))
    moved = [Body(node=one.node, inertia=one.inertia.moved(points[one.node])) for one in bodies]
    plan = Plan(nodes=points, carriers=tuple(range(count + 1)), members=tuple(members), bodies=tuple(moved))
    return _of_plan(plan, **more)


def plate(generator: np.random.Generator, lumped: bool = False, **more: Any) -> Sample:
    """One layer of hexahedra with three displacements a node, held along one edge."""
    E, rho = METALS[generator.integers(len(METALS))]
    nx, ny = (int(value) for value in generator.integers(3, 6, 2))
    a, b, t = generator.uniform(0.03, 0.1), generator.uniform(0.03, 0.1), generator.uniform(0.01, 0.03)
    grid = [[i * a, j * b, k * t] for i in range(nx + 1) for j in range(ny + 1) for k in range(2)]
    number = {(i, j, k): (i * (ny + 1) + j) * 2 + k for i in range(nx + 1) for j in range(ny + 1) for k in range(2)}
    Ke, Me = hexahedron(np.array([a, b, t]), E, 0.3, rho)
    n = 3 * len(grid)
    K, M = np.zeros((n, n)), np.zeros((n, n))
    for i in range(nx):
        for j in range(ny):
            corners = [number[i + p, j + q, r] for p in (0, 1) for q in (0, 1) for r in (0, 1)]
            rows = np.array([3 * corner + c for corner in corners for c in range(3)])
            K[np.ix_(rows, rows)] += Ke
            M[np.ix_(rows, rows)] += Me
    if lumped:
        M = np.diag(M.sum(axis=1))
    nodes = np.arange(1, len(grid) + 1)
    dof = np.array([(node, component) for node in nodes for component in (1, 2, 3)])
    arrays = {"stiffness": K, "mass": M, "dof": dof, "nodes": nodes, "coordinates": np.array(grid)}
    held = tuple(1 + number[0, j, k] for j in range(ny + 1) for k in range(2))
    return Sample(arrays=arrays, **{"interface": held, **more})


def hexahedron(sides: np.ndarray, E: float, nu: float, rho: float) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness and consistent mass (24, 24) of a trilinear brick, eight Gauss points (Hughes, The Finite Element Method)."""
    corners = np.array([[p, q, r] for p in (-1, 1) for q in (-1, 1) for r in (-1, 1)], dtype=float)
    C = np.diag([1 - nu] * 3 + [0.5 - nu] * 3)
    C[:3, :3] += nu * (1 - np.eye(3))
    C *= E / ((1 + nu) * (1 - 2 * nu))
    K, M = np.zeros((24, 24)), np.zeros((24, 24))
    for point in corners / np.sqrt(3):
        factors = (1 + corners * point) / 2
        shape = factors.prod(axis=1)
        slope = np.stack([corners[:, c] / 2 * np.delete(factors, c, axis=1).prod(axis=1) for c in range(3)], axis=1) * 2 / sides
        B = np.zeros((6, 24))
        for c in range(3):
            B[c, c::3] = slope[:, c]
        for row, (c, d) in enumerate(((1, 2), (2, 0), (0, 1)), start=3):
            B[row, c::3], B[row, d::3] = slope[:, d], slope[:, c]
        weight = sides.prod() / 8
        K += weight * B.T @ C @ B
        N = np.kron(shape, np.eye(3))
        M += weight * rho * N.T @ N
    return K, M


def reduced(sample: Sample, modes: int) -> Sample:
    """Craig-Bampton: the six motions of one interface node, and modes with it held."""
    K, M, dof = (np.asarray(sample.arrays[name]) for name in ("stiffness", "mass", "dof"))
    held = np.isin(dof[:, 0], sample.interface)
    free = np.flatnonzero(~held)
    T = rigid_motion(sample.arrays["coordinates"]).reshape(-1, 6)
    T = T[6 * np.searchsorted(sample.arrays["nodes"], dof[:, 0]) + dof[:, 1] - 1]
    _, phi = eigh(K[np.ix_(free, free)], M[np.ix_(free, free)], subset_by_index=[0, modes - 1])
    basis = np.zeros((len(dof), 6 + modes))
    basis[:, :6] = T
    basis[free, 6:] = phi
    labels = np.array([*((1, c) for c in range(1, 7)), *((9000 + k, 0) for k in range(modes))])
    K, M = (basis.T @ A @ basis for A in (K, M))
    arrays = {"stiffness": (K + K.T) / 2, "mass": (M + M.T) / 2, "dof": labels}
    return replace(sample, arrays={**arrays, "nodes": np.array([1]), "coordinates": np.zeros((1, 3))}, interface=(1,))


def modal(sample: Sample, modes: int) -> Sample:
    """Modes with the interface held, about the origin, with what stands for those left out."""
    K, M, dof = (np.asarray(sample.arrays[name]) for name in ("stiffness", "mass", "dof"))
    free = np.flatnonzero(~np.isin(dof[:, 0], sample.interface))
    T = rigid_motion(sample.arrays["coordinates"]).reshape(-1, 6)
    T = T[6 * np.searchsorted(sample.arrays["nodes"], dof[:, 0]) + dof[:, 1] - 1]
    values, phi = eigh(K[np.ix_(free, free)], M[np.ix_(free, free)])
    L = (M @ T)[free].T @ phi
    arrays = {
        "frequency": np.sqrt(values[:modes]) / (2 * np.pi),
        "damping_ratio": np.full(modes, 0.01),
        "participation": L[:, :modes],
        "rigid_mass": T.T @ M @ T,
    }
    return replace(sample, arrays=arrays, interface=(), kind="modal")


def stated(sample: Sample, count: int = 5, weighed: bool = False) -> Sample:
    """With its own frequencies stated, and its mass."""
    listed = ", ".join(f'"{one:.5g} Hz"' for one in frequencies(sample, count))
    along_x = np.asarray(sample.arrays["dof"])[:, 1] == 1
    mass = np.asarray(sample.arrays["mass"])[np.ix_(along_x, along_x)].sum()
    return replace(sample, stated=f"frequencies = [{listed}]\n" + (f'mass = "{mass:.5g} kg"\n' if weighed else ""))


# --- planted slips ----------------------------------------------------------------------------------------------------------

Slip = Callable[[Arrays], Any]


def by(name: str, factor: float) -> Slip:
    return lambda arrays: arrays.update({name: arrays[name] * factor})


def entry(name: str, row: int, column: int, factor: float, both: bool = False) -> Slip:
    """An entry moved by `factor` times the largest of its row."""

    def slip(arrays: Arrays) -> None:
        size = factor * np.abs(arrays[name][row]).max()
        arrays[name][row, column] += size
        if both and row != column:
            arrays[name][column, row] += size

    return slip


def triangle(name: str) -> Slip:
    return lambda arrays: arrays.update({name: np.triu(arrays[name])})


def swapped(arrays: Arrays) -> None:
    arrays["stiffness"], arrays["mass"] = arrays["mass"], arrays["stiffness"]


def rows_of(arrays: Arrays, node: int) -> np.ndarray:
    return np.flatnonzero(arrays["dof"][:, 0] == node)


def spring(arrays: Arrays, node: int, component: int, size: float, other: int | None = None) -> None:
    """To the ground, or to the same component of `other` without a lever arm; `size` times the entry that is there."""
    row = rows_of(arrays, node)[component - 1]
    k = size * arrays["stiffness"][row, row]
    arrays["stiffness"][row, row] += k
    if other is not None:
        column = rows_of(arrays, other)[component - 1]
        arrays["stiffness"][column, column] += k
        arrays["stiffness"][row, column] -= k
        arrays["stiffness"][column, row] -= k


def hinge(arrays: Arrays, node: int = 110) -> None:
    """`node` and its neighbour below turn about x for nothing: the stiffness of that motion is taken out, and no other."""
    v = np.zeros(len(arrays["dof"]))
    for each in (node, node - 1):
        v[rows_of(arrays, each)[3]] = 1.0
    Kv = arrays["stiffness"] @ v
    arrays["stiffness"] -= np.outer(Kv, Kv) / (v @ Kv)


def negative_spring(arrays: Arrays) -> None:
    """Between neighbours along x, of a negative stiffness, with its lever arms: rigid motions pass."""
    x = arrays["coordinates"]
    first, second = 7, 8
    a, b = (rows_of(arrays, arrays["nodes"][k]) for k in (first, second))
    T = rigid_motion(x[[first]], x[second])  # motions of `second` carried to `first`
    B = np.zeros((6, len(arrays["dof"])))
    B[:, a], B[:, b] = np.eye(6), -T
    K = arrays["stiffness"]
    arrays["stiffness"] = K - B.T @ np.diag(0.6 * np.diag(K)[a] * [1, 0, 0, 0, 0, 0]) @ B


def loose(arrays: Arrays) -> None:
    """The last node is cut off."""
    last = rows_of(arrays, arrays["nodes"][-1])
    for name in ("stiffness", "mass"):
        arrays[name][last] = arrays[name][:, last] = 0
        arrays[name][last, last] = 1.0 if name == "mass" else 1e3
    arrays["stiffness"][last, last] = 1e3


def orphan(arrays: Arrays) -> None:
    """A node that no element uses."""
    for name in ("stiffness", "mass"):
        arrays[name] = np.pad(arrays[name], (0, 6))
    arrays["dof"] = np.vstack([arrays["dof"], [(999, c) for c in range(1, 7)]])
    arrays["nodes"] = np.append(arrays["nodes"], 999)
    arrays["coordinates"] = np.vstack([arrays["coordinates"], [0.05, 0.07, 0.09]])


def point_mass_on_nothing(arrays: Arrays) -> None:
    orphan(arrays)
    arrays["mass"][-6:-3, -6:-3] = 0.5 * np.eye(3)


def unjoined(arrays: Arrays) -> None:
    """Two plates on one line, their nodes there doubled and not joined."""
    n, p = len(arrays["dof"]), len(arrays["nodes"])
    for name in ("stiffness", "mass"):
        A = np.zeros((2 * n, 2 * n))
        A[:n, :n] = A[n:, n:] = arrays[name]
        arrays[name] = A
    far = arrays["coordinates"] + np.array([np.ptp(arrays["coordinates"][:, 0]), 0, 0])
    arrays["dof"] = np.vstack([arrays["dof"], arrays["dof"] + np.array([p, 0])])
    arrays["nodes"] = np.arange(1, 2 * p + 1)
    arrays["coordinates"] = np.vstack([arrays["coordinates"], far])


def moved(node: int, by: tuple[float, float, float]) -> Slip:
    def slip(arrays: Arrays) -> None:
        arrays["coordinates"][np.flatnonzero(arrays["nodes"] == node)[0]] += by

    return slip


def exchanged(arrays: Arrays) -> None:
    arrays["coordinates"][[2, 4]] = arrays["coordinates"][[4, 2]]


def component_by_component(*names: str) -> Slip:
    """The rows of `names` run through all nodes for x, then for y ..., the map does not."""

    def slip(arrays: Arrays) -> None:
        n, p = len(arrays["dof"]), len(arrays["nodes"])
        order = np.arange(n).reshape(p, -1).T.ravel()
        for name in names:
            arrays[name] = arrays[name][np.ix_(order, order)]

    return slip


def degrees(arrays: Arrays) -> None:
    """Rotations in degrees: what multiplies them, and moments, are those of degrees."""
    scale = np.where(arrays["dof"][:, 1] > 3, np.pi / 180, 1.0)
    for name in ("stiffness", "mass"):
        arrays[name] = arrays[name] * np.outer(scale, scale)


def lost_on_the_interface(node: int, *, every: bool = True) -> Slip:
    def slip(arrays: Arrays) -> None:
        held = rows_of(arrays, node) if every else rows_of(arrays, node)[:1]
        arrays["mass"][held] = arrays["mass"][:, held] = 0

    return slip


def without_supported(arrays: Arrays) -> None:
    """Node 107 was supported along all three axes, and its rows were left out."""
    kept = np.setdiff1d(np.arange(len(arrays["dof"])), rows_of(arrays, 107)[:3])
    for name in ("stiffness", "mass"):
        arrays[name] = arrays[name][np.ix_(kept, kept)]
    arrays["dof"] = arrays["dof"][kept]


def one_axis(arrays: Arrays) -> None:
    row = rows_of(arrays, 106)[1]
    arrays["mass"][row, row] += 0.4


def penalty(arrays: Arrays) -> None:
    """A weld of nodes 104 and 105 by a spring of 1e20 N/m with its lever arms."""
    x = arrays["coordinates"]
    a, b = (rows_of(arrays, node) for node in (104, 105))
    B = np.zeros((3, len(arrays["dof"])))
    B[:, a], B[:, b] = np.eye(6)[:3], -rigid_motion(x[[3]], x[4])[:3]
    arrays["stiffness"] = arrays["stiffness"] + 1e20 * B.T @ B


def part_twice(arrays: Arrays) -> None:
    K = arrays["stiffness"]
    column = np.array(K)
    column[np.ix_(range(36, len(K)), range(36, len(K)))] = 0
    arrays["stiffness/column"], arrays["stiffness/arm"] = column, K - column
    arrays["stiffness"] = K + arrays["stiffness/arm"]


def part_missing_entry(arrays: Arrays) -> None:
    part_twice(arrays)
    arrays["stiffness"] = arrays["stiffness/column"] + arrays["stiffness/arm"]
    arrays["stiffness/arm"][50, 50] *= 1.01


def viscous(of: Callable[[np.ndarray], np.ndarray]) -> Slip:
    return lambda arrays: arrays.update(viscous=1e-5 * of(arrays["stiffness"]))


def feeding(K: np.ndarray) -> np.ndarray:
    """Proportional to K but for one motion, which it drives."""
    values, vectors = np.linalg.eigh(K)
    values[-1] *= -0.5
    made: np.ndarray = (vectors * values) @ vectors.T
    return made


def softened(arrays: Arrays) -> None:
    """All that is above the fifth node is a third less stiff."""
    K = arrays["stiffness"]
    upper = np.array(K)
    T = rigid_motion(arrays["coordinates"]).reshape(-1, 6)
    low = rows_of(arrays, arrays["nodes"][4])
    keep = np.arange(len(K)) >= low[0]
    upper[~keep] = upper[:, ~keep] = 0
    inner = upper[np.ix_(low, low)]
    rest = np.flatnonzero(keep & ~np.isin(np.arange(len(K)), low))
    upper[np.ix_(low, low)] = inner + np.linalg.solve(T[low].T, -T[low].T @ inner - T[rest].T @ upper[np.ix_(rest, low)])
    arrays["stiffness"] = K - 0.33 * (upper + upper.T) / 2


def nan(arrays: Arrays) -> None:
    arrays["stiffness"][3, 4] = np.nan


def short_map(arrays: Arrays) -> None:
    arrays["dof"] = arrays["dof"][:-6]


def put(name: str, make: Callable[[np.ndarray], Any]) -> Slip:
    return lambda arrays: arrays.update({name: make(arrays[name])})


BRACKET, FRAME, CHAIN, PLATE, MODAL = "bracket", "frame", "chain", "plate", "modal"
"""The sound models that are damaged."""

SLIPS: dict[str, tuple[str, Slip, str, str]] = {
    "unsymmetric K": (BRACKET, entry("stiffness", 13, 7, 0.01), "symmetry", "node 103, y"),
    "unsymmetric M": (FRAME, entry("mass", 30, 24, 0.01), "symmetry", "node 106, x"),
    "one triangle of K": (PLATE, triangle("stiffness"), "triangle", "stiffness"),
    "one triangle of M": (CHAIN, triangle("mass"), "triangle", "mass"),
    "K of the other sign": (FRAME, by("stiffness", -1.0), "sign", ""),
    "a negative entry in K": (BRACKET, entry("stiffness", 38, 38, -1.5), "diagonal", "node 107, z"),
    "a negative entry in M": (PLATE, entry("mass", 40, 40, -1.5), "diagonal", "node 14, y"),
    "K and M exchanged": (CHAIN, swapped, "confused", "stiffness"),
    "a part twice": (BRACKET, part_twice, "parts", "node 107"),
    "a part with a wrong entry": (BRACKET, part_missing_entry, "parts", "node 109, z"),
    "a node of nothing": (FRAME, orphan, "orphan", "node 999"),
    "a point mass on nothing": (BRACKET, point_mass_on_nothing, "no stiffness", "node 999"),
    "meshes not joined": (PLATE, unjoined, "coincident", "nodes"),
    "a loose node": (CHAIN, loose, "loose part", "node"),
    "a mechanism": (BRACKET, hinge, "mechanism", "alpha"),
    "a negative spring": (BRACKET, negative_spring, "indefinite stiffness", "node 10"),
    "a penalty spring": (BRACKET, penalty, "penalty", "node 10"),
    "a spring to the ground": (FRAME, lambda a: spring(a, 109, 1, 0.01), "grounded", "node 109, x"),
    "a stiff support": (PLATE, lambda a: spring(a, 20, 3, 1e3), "grounded", "node 20, z"),
    "a turning support": (CHAIN, lambda a: spring(a, 104, 5, 1.0), "grounded", "node 104, beta"),
    "rows of a support": (FRAME, without_supported, "restrained", "node 107"),
    "a link without lever arms": (FRAME, lambda a: spring(a, 105, 1, 1.0, other=112), "link", "112"),
    "coordinates in millimetres": (BRACKET, by("coordinates", 1e3), "unit of length", "coordinates"),
    "coordinates in inches": (FRAME, by("coordinates", 39.3700787), "unit of length", "coordinates"),
    "rotations in degrees": (CHAIN, degrees, "rotations", "coordinates"),
    "x and y exchanged": (PLATE, put("coordinates", lambda x: x[:, [1, 0, 2]]), "axes", "coordinates"),
    "z downwards": (FRAME, put("coordinates", lambda x: x * [1, 1, -1]), "axes", "coordinates"),
    "a node elsewhere": (FRAME, moved(110, (0.0, 0.02, 0.0)), "node place", "node 110"),
    "two nodes exchanged": (CHAIN, exchanged, "order of rows", "nodes 103 and 105"),
    "rows by component": (PLATE, component_by_component("stiffness", "mass"), "order of rows", "dof"),
    "mass by component": (PLATE, component_by_component("mass"), "order of mass", "mass"),
    "mass of the interface lost": (FRAME, lost_on_the_interface(101), "lost mass", "node 101"),
    "mass along one axis": (BRACKET, one_axis, "mass by axis", "node 106"),
    "grams for kilograms": (BRACKET, by("mass", 1e3), "unit of mass", "mass"),
    "weight for mass": (FRAME, by("mass", 9.80665), "unit of mass", "mass"),
    "pounds": (CHAIN, by("mass", 2.2046226), "unit of mass", "mass"),
    "a forgotten mass": (PLATE, by("mass", 0.9), "total mass", "mass"),
    "a modulus in MPa": (FRAME, by("stiffness", 1e6), "unit of frequency", "frequencies"),
    "a softer part": (BRACKET, softened, "frequencies", "frequencies"),
    "damping that drives": (BRACKET, viscous(feeding), "damping", ""),
    "dampers to the ground": (FRAME, viscous(lambda K: np.diag(np.diag(K))), "damping to ground", "node"),
    "NaN": (PLATE, nan, "stiffness", "stiffness"),
    "a short map": (CHAIN, short_map, "dof", "dof"),
    "too few modes": (MODAL, put("participation", lambda L: 0.3 * L), "too few modes", "last"),
    "modes not normalised": (MODAL, by("participation", 7.0), "participation", "participation"),
    "rad/s for Hz": (MODAL, by("frequency", 2 * np.pi), "unit of frequency", "frequency"),
    "per cent for shares": (MODAL, by("damping_ratio", 100.0), "damping", "mode 1"),
    "a moment of inertia": (MODAL, put("rigid_mass", lambda M: M + 3 * M[5, 5] * np.diag([0, 0, 0, 0, 0, 1])), "rigid_mass", ""),
}
"""By name: the model, what is done to it, the check that has to find it first, and what its place has to say."""


def sound_models(own: Mapping[str, Any]) -> dict[str, Sample]:
    """The models that are damaged, each with its mass and its frequencies stated."""
    nodes, coordinates, K, M = own["bracket"]()
    dof = np.array([(node, component) for node in nodes for component in range(1, 7)])
    units = unit_system("mm-t-N-s", "")
    s = units.coordinates(dof[:, 1])
    scale = 1 / np.outer(s, s)
    arrays = {"stiffness": units.energy * K * scale, "mass": units.energy * M * scale}
    arrays |= {"dof": dof, "nodes": nodes, "coordinates": coordinates * units.length}
    g = np.random.default_rng(21)
    found = {
        BRACKET: Sample(arrays=arrays, interface=(101,), units="mm-t-N-s"),
        FRAME: frame(g, sparse=True),
        CHAIN: chain(g, units="in-lbf-s", ending=".h5"),
        PLATE: plate(g, units="mm-kg-kN-ms", sparse=True),
    }
    made = {name: stated(one, weighed=True) for name, one in found.items()}
    return made | {MODAL: replace(modal(found[PLATE], 30), stated=made[PLATE].stated, units="mm-t-N-s")}


def lumped(sample: Sample) -> Sample:
    """Its mass summed up on the diagonal, without rotary inertia."""
    dof, M = np.asarray(sample.arrays["dof"]), np.asarray(sample.arrays["mass"])
    sums = np.zeros(len(dof))
    for component in (1, 2, 3):
        along = dof[:, 1] == component
        sums[along] = M[np.ix_(along, along)].sum(axis=1)
    return replace(sample, arrays={**sample.arrays, "mass": np.diag(sums)})


def of_another_mass(sample: Sample) -> Sample:
    return replace(sample, stated=stated(lumped(sample)).stated)


def of_another_mesh(sample: Sample) -> Sample:
    return replace(lumped(sample), stated=sample.stated)


def of_the_free_structure(sample: Sample) -> Sample:
    listed = ", ".join(f'"{one:.6g} Hz"' for one in frequencies(sample, 4, held=False))
    return replace(sample, stated=f"frequencies = [{listed}]\n")


def of_one_more_mode(sample: Sample) -> Sample:
    own = frequencies(sample, 5)
    listed = ", ".join(f'"{one:.6g} Hz"' for one in [*own, (own[1] + own[2]) / 2])
    return replace(sample, stated=f"frequencies = [{listed}]\n")


def in_millimetres(sample: Sample) -> Sample:
    """Numbers in metres and kilograms that are said to be in millimetres and tonnes, and nothing else is said."""
    return replace(sample, said="mm-t-N-s", units="m-kg-N-s", stated="")


def in_megapascals(sample: Sample) -> Sample:
    return replace(sample.spoilt(by("stiffness", 1e-6)), stated="")


def centre_elsewhere(sample: Sample) -> Sample:
    return replace(sample, stated='cog = ["0.1 m", "0.5 m", "-2 m"]\n')


def of_three_modes(sample: Sample) -> Sample:
    return replace(reduced(sample, 3), stated=sample.stated)


WHOLE_SLIPS: dict[str, tuple[str, Callable[[Sample], Sample], str, str]] = {
    "frequencies of a lumped mass": (FRAME, of_another_mass, "lumped mass", "mass"),
    "a lumped mass of a coarse mesh": (PLATE, of_another_mesh, "lumped mass", "mass"),
    "frequencies without supports": (BRACKET, of_the_free_structure, "boundary", "interface"),
    "a mode that is not there": (CHAIN, of_one_more_mode, "frequencies", "frequencies"),
    "metres called millimetres": (PLATE, in_millimetres, "units", "mass"),
    "a modulus in MPa, nothing stated": (FRAME, in_megapascals, "units", "stiffness"),
    "a centre of gravity elsewhere": (CHAIN, centre_elsewhere, "centre of gravity", "cog"),
    "a reduction to three modes": (FRAME, of_three_modes, "too few modes", "last"),
}
"""As `SLIPS`, where more than single arrays is wrong."""


@pytest.fixture(scope="module")
def whole(own_model: dict[str, Any]) -> dict[str, Sample]:
    return sound_models(own_model)


@pytest.mark.parametrize("model", [BRACKET, FRAME, CHAIN, PLATE, MODAL])
def test_nothing_is_found_in_what_is_damaged_below(model: str, whole: dict[str, Sample], tmp_path: Path) -> None:
    found = examine.examine(whole[model].write(tmp_path))
    assert found.findings == ()
    assert found.unexamined == ()


@pytest.mark.parametrize("case", [*SLIPS, *WHOLE_SLIPS])
def test_a_planted_slip_is_named_first(case: str, whole: dict[str, Sample], tmp_path: Path) -> None:
    model, slip, check, where = SLIPS.get(case) or WHOLE_SLIPS[case]
    sample = whole[model].spoilt(slip) if case in SLIPS else slip(whole[model])
    found = examine.examine(sample.write(tmp_path)).findings
    assert found, "nothing was found"
    first = found[0]
    assert first.check == check, found
    assert where in first.where
    assert first.what
    assert first.remedy


def test_at_least_forty_slips_are_planted() -> None:
    assert len(SLIPS) + len(WHOLE_SLIPS) >= 40


# --- sound models -----------------------------------------------------------------------------------------------------------


def sound(seed: int) -> dict[str, Sample]:
    """Ten sound models, random in shape, material, units and format."""
    g, units = np.random.default_rng(seed), UNITS[seed % len(UNITS)]
    more = {"units": units, "ending": (".npz", ".h5")[seed % 2], "sparse": bool(seed % 3)}
    made = {"frame": frame(g, **more), "chain": chain(g, **more), "plate": plate(g, **more)}
    every = {name: stated(one, weighed=bool(seed % 2)) for name, one in made.items()}
    every |= {f"{name}, nothing stated": one for name, one in made.items()}
    every |= {"lumped plate": plate(g, lumped=True, **more), "lumped frame": lumped(made["frame"])}
    return every | {"reduced chain": reduced(made["chain"], 20), "modes of the plate": modal(made["plate"], 40)}


@pytest.mark.parametrize("seed", [*range(4), *(pytest.param(seed, marks=pytest.mark.proof) for seed in range(4, 16))])
def test_nothing_is_found_in_sound_models(seed: int, tmp_path: Path) -> None:
    for name, sample in sound(seed).items():
        found = examine.examine(sample.write(tmp_path))
        assert found.findings == (), name
        assert found.unexamined == (), name


# --- plain arrays -----------------------------------------------------------------------------------------------------------


def submitted(sample: Sample, support: str) -> matrix_checks.Submitted:
    """As the door hands it on, on the ground or free."""
    dof, x = np.asarray(sample.arrays["dof"]), np.asarray(sample.arrays["coordinates"])
    T = rigid_motion(x).reshape(-1, 6)
    none = np.zeros((0, 3), dtype=np.intp)
    dofs = freedoms.DofMap(
        labels=dof,
        scale=np.ones(len(dof)),
        rigid=T[6 * np.searchsorted(sample.arrays["nodes"], dof[:, 0]) + dof[:, 1] - 1],
        held=none[:, 0],
        points=x[:0],
        translations=none,
        rotations=none,
    )
    K, M = (csr_array(np.asarray(sample.arrays[name])) for name in ("stiffness", "mass"))
    return matrix_checks.Submitted(stiffness=K, mass=M, dofs=dofs, support=support, nodes=sample.arrays["nodes"], places=x)


def looked_at(sample: Sample, support: str) -> tuple[matrix_checks.Finding, ...]:
    description = Description(source="", name="", kind="matrices", units=unit_system("m-kg-N-s", ""), reference_point=np.zeros(3))
    return examine.examine_matrices(submitted(sample, support), [], description).findings


@pytest.mark.parametrize("make", [frame, chain, plate])
def test_a_free_structure_is_sound_and_one_on_the_ground_is(make: Callable[..., Sample]) -> None:
    sample = make(np.random.default_rng(4))
    assert looked_at(sample, "free") == ()
    standing = sample.spoilt(lambda arrays: None)
    for node in sample.interface:
        rows = rows_of(standing.arrays, node)
        standing.arrays["stiffness"][rows, rows] *= 1.5
    assert looked_at(standing, "ground") == ()
    assert [one.check for one in looked_at(standing, "free")] == ["grounded"]
    assert [one.check for one in looked_at(sample, "ground")][:1] == ["mechanism"]


@pytest.mark.parametrize("make", [frame, chain, plate])
@pytest.mark.parametrize("units", UNITS[:3])
def test_a_file_on_the_ground_or_free_is_sound(make: Callable[..., Sample], units: str, tmp_path: Path) -> None:
    sample = make(np.random.default_rng(5), units=units)
    kept = ~np.isin(sample.arrays["dof"][:, 0], sample.interface)
    clamped = {name: np.array(sample.arrays[name])[np.ix_(kept, kept)] for name in ("stiffness", "mass")}
    clamped = {**sample.arrays, **clamped, "dof": sample.arrays["dof"][kept]}
    free = replace(sample, support="free")
    assert examine.examine(replace(sample, arrays=clamped, support="ground").write(tmp_path)).findings == ()
    assert examine.examine(free.write(tmp_path)).findings == ()
    node = int(sample.arrays["nodes"][-1])
    tied = examine.examine(free.spoilt(lambda arrays: spring(arrays, node, 1, 0.1)).write(tmp_path)).findings
    assert [one.check for one in tied] == ["grounded"]
    assert f"node {node}, x" in tied[0].where


@pytest.mark.parametrize("make", [frame, chain, plate])
def test_metres_that_are_said_to_be_millimetres_are_seen_on_the_ground_too(make: Callable[..., Sample], tmp_path: Path) -> None:
    """Of what stands on the ground no density was looked at, and of a flat structure nowhere."""
    sample = make(np.random.default_rng(5), units="m-kg-N-s")
    kept = ~np.isin(sample.arrays["dof"][:, 0], sample.interface)
    clamped = {name: np.array(sample.arrays[name])[np.ix_(kept, kept)] for name in ("stiffness", "mass")}
    stood = replace(sample, arrays={**sample.arrays, **clamped, "dof": sample.arrays["dof"][kept]}, support="ground")
    path = replace(stood, ending=".npz").write(tmp_path)
    assert examine.examine(path).findings == ()
    with np.load(path) as file:
        arrays = dict(file)
    arrays["description"] = np.array(str(arrays["description"]).replace("m-kg-N-s", "mm-t-N-s"))
    np.savez(path, **arrays)
    assert [one.check for one in examine.examine(path).findings] == ["units"]


SOIL = """
[fe_model.places]
foot = 101

[fe_model.joints.soil]
between = ["foot", "ground"]
stiffness = ["2e7 N/m", "2e7 N/m", "5e7 N/m", "3e4 N m/rad", "3e4 N m/rad", "3e4 N m/rad"]
"""


@pytest.mark.parametrize(("joint", "checks"), [(SOIL, []), ("", ["mechanism"])])
def test_joints_of_the_description_hold_what_stands_on_them(joint: str, checks: list[str], bracket_files: Path) -> None:
    path = bracket_files / "on-soil.toml"
    head = 'format = 1\n[fe_model]\nkind = "matrices"\nunits = "mm-t-N-s"\nsupport = "ground"\nfile = "bracket-parts.npz"\n'
    path.write_text(head + joint, encoding="utf-8")
    assert [one.check for one in examine.examine(path).findings] == checks


BRIDGE = """
format = 1
[fe_model]
kind = "matrices"
units = "consistent"
support = "ground"
supports = ["y1", "y2", "z1", "z2"]
file = "$MASSLINE_DATA/footbridge/model.npz"
"""


def test_a_bridge_is_sound_and_not_the_one_that_was_measured(data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Measured 4.063, 4.550, 6.823, 8.653, 11.498 Hz (data/README.md): five modes that its model has elsewhere."""
    monkeypatch.setenv("MASSLINE_DATA", str(data))
    path = tmp_path / "bridge.toml"
    path.write_text(BRIDGE, encoding="utf-8")
    assert examine.examine(path).findings == ()
    measured = '[stated]\nfrequencies = ["4.063 Hz", "4.550 Hz", "6.823 Hz", "8.653 Hz", "11.498 Hz"]\n'
    path.write_text(BRIDGE + measured, encoding="utf-8")
    assert [one.check for one in examine.examine(path).findings] == ["frequencies"]


def test_two_faults_are_both_found(whole: dict[str, Sample], tmp_path: Path) -> None:
    both = whole[BRACKET].spoilt(entry("stiffness", 13, 7, 0.01)).spoilt(by("mass", 9.80665))
    assert [one.check for one in examine.examine(both.write(tmp_path)).findings] == ["symmetry", "unit of mass"]


def test_what_the_reader_refuses_is_a_finding(whole: dict[str, Sample], tmp_path: Path) -> None:
    path = whole[BRACKET].spoilt(lambda a: a.update(massess=np.eye(2))).write(tmp_path)
    assert [one.check for one in examine.examine(path).findings] == ["massess"]


def test_a_file_that_cannot_be_read_is_refused(tmp_path: Path) -> None:
    (tmp_path / "model.npz").write_bytes(b"PK nothing")
    with pytest.raises(BadInput):
        examine.examine(tmp_path / "model.npz")


@pytest.mark.parametrize(
    ("kind", "cells", "is_wrong"),
    [
        ("C3D4", (8, 2, 2), True),
        ("C3D10", (16, 3, 3), False),
        ("C3D10", (2, 1, 1), True),
        ("C3D8", (8, 1, 1), True),
        ("C3D8", (40, 2, 2), False),
    ],
)
def test_a_mesh_that_is_too_coarse_for_its_modes_is_named_with_the_part(
    kind: str, cells: tuple[int, int, int], is_wrong: bool, tmp_path: Path
) -> None:
    points, elements = bricks(cells, (1.0, 0.1, 0.08), kind)
    (tmp_path / "mesh.inp").write_text(abaqus(points, {"beam": (kind, elements)}), encoding="utf-8")
    described = 'format = 1\n[fe_model]\nkind = "mesh"\nunits = "m"\nfile = "mesh.inp"\nsupport = "free"\n'
    (tmp_path / "beam.toml").write_text(f"{described}[fe_model.parts.beam]\n{STEEL}\n", encoding="utf-8")
    found = examine.examine(tmp_path / "beam.toml")
    assert any("finer mesh may" in fact for fact in found.facts)
    assert [(one.check, one.where) for one in found.findings] == ([("mesh", "beam")] if is_wrong else [])
    assert [one.remedy.endswith("of the second order") for one in found.findings] == ([kind != "C3D10"] if is_wrong else [])
