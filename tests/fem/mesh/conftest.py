"""Meshes for tests: grids in Abaqus text, drawings in every format through gmsh, each with its description beside it."""

import json
import subprocess
import sys
from collections.abc import Callable, Mapping
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from fem.structure import Structure
from fem.user_model import reading

STEEL = 'material = { density = "7850 kg/m^3", youngs_modulus = "210 GPa", poisson_ratio = 0.3 }'

Groups = Mapping[str, tuple[str, list[list[int]]]]
"""By name the Abaqus type of the elements and their nodes, counted from 1."""

Meshed = Callable[..., Structure]


def abaqus(points: np.ndarray, groups: Groups, sets: Mapping[str, list[int]] | None = None) -> str:
    """A flat input deck."""
    lines = ["*NODE", *(f"{n}, " + ", ".join(f"{v:.16g}" for v in point) for n, point in enumerate(points, start=1))]
    tag = 0
    for name, (kind, elements) in groups.items():
        lines.append(f"*ELEMENT, TYPE={kind}, ELSET={name}")
        for nodes in elements:
            tag += 1
            words = [tag, *nodes]
            lines += [
                ", ".join(map(str, words[k : k + 12])) + ("," if k + 12 < len(words) else "") for k in range(0, len(words), 12)
            ]
    for name, members in (sets or {}).items():
        lines += [f"*NSET, NSET={name}", *(str(member) for member in members)]
    return "\n".join(lines) + "\n"


def plate(n: int, m: int, size: tuple[float, float], kind: str = "S4", skew: float = 0.0) -> tuple[np.ndarray, list[list[int]]]:
    """Points and elements of n x m cells in the plane; inner nodes are moved by `skew` of a cell."""
    rng = np.random.default_rng(1)
    x, y = np.meshgrid(np.linspace(0, size[0], n + 1), np.linspace(0, size[1], m + 1), indexing="ij")
    move = skew * np.array([size[0] / n, size[1] / m])[:, None, None] * rng.uniform(-1, 1, (2, n + 1, m + 1))
    move[:, [0, -1]] = move[:, :, [0, -1]] = 0
    points = np.column_stack([(x + move[0]).ravel(), (y + move[1]).ravel(), np.zeros(x.size)])
    quads = [
        [1 + (m + 1) * i + j, 1 + (m + 1) * (i + 1) + j, 2 + (m + 1) * (i + 1) + j, 2 + (m + 1) * i + j]
        for i, j in product(range(n), range(m))
    ]
    if kind == "S3":
        quads = [three for a, b, c, d in quads for three in ([a, b, c], [a, c, d])]
    return points, quads


def bricks(cells: tuple[int, int, int], size: tuple[float, float, float], kind: str) -> tuple[np.ndarray, list[list[int]]]:
    """Points and elements of a box: C3D8, C3D20, C3D4, C3D10, C3D6 or C3D15."""
    from fem.mesh import solids

    mine = {"C3D8": "hex8", "C3D20": "hex20", "C3D4": "tet4", "C3D10": "tet10", "C3D6": "wedge6", "C3D15": "wedge15"}[kind]
    corner = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])
    cuts = {
        "hex": [list(range(8))],
        "wedge": [[0, 1, 2, 4, 5, 6], [0, 2, 3, 4, 6, 7]],
        "tet": [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]],
    }[solids.shape(mine)]
    numbers: dict[tuple[int, ...], int] = {}
    elements = []
    local = solids.local_nodes(mine)
    corners = len(cuts[0])
    _, edges = solids._CORNERS[solids.shape(mine)]
    for cell in product(*map(range, cells)):
        for cut in cuts:
            own = [2 * (np.array(cell) + corner[k]) for k in cut]
            if len(local) > corners:
                own += [(own[a] + own[b]) // 2 for a, b in edges]
            elements.append([numbers.setdefault(tuple(place.tolist()), len(numbers) + 1) for place in own])
    return np.array(list(numbers)) / 2 / cells * size, elements


@pytest.fixture
def meshed(tmp_path: Path) -> Meshed:
    """Writes a mesh and the rest of its description, and reads both: text of the mesh, tables of the parts, more keys."""

    def made(
        mesh: str, parts: str, *, support: str = 'support = "free"', more: str = "", units: str = "m", ending: str = "inp"
    ) -> Structure:
        (tmp_path / f"mesh.{ending}").write_text(mesh)
        text = f'format = 1\n[fe_model]\nkind = "mesh"\nunits = "{units}"\nfile = "mesh.{ending}"\n{support}\n{parts}\n{more}\n'
        (tmp_path / "mesh.toml").write_text(text)
        found = reading.read(tmp_path / "mesh.toml")
        assert isinstance(found, Structure)
        return found

    return made


BRACKET = """
import gmsh, json, sys
path, order, quads, options = sys.argv[1], int(sys.argv[2]), sys.argv[3], json.loads(sys.argv[4])
gmsh.initialize(interruptible=False)
gmsh.option.setNumber("General.Terminal", 0)
occ = gmsh.model.occ
foot, wall = occ.addBox(0, 0, 0, 100, 60, 10), occ.addBox(0, 0, 10, 10, 60, 90)
occ.fragment([(3, foot)], [(3, wall)])
occ.synchronize()
gmsh.model.addPhysicalGroup(3, [foot], name="foot")
gmsh.model.addPhysicalGroup(3, [wall], name="wall")
under = gmsh.model.getEntitiesInBoundingBox(-1, -1, -1, 101, 61, 1, 2)
gmsh.model.addPhysicalGroup(2, [tag for _, tag in under], name="underside")
tip = gmsh.model.getEntitiesInBoundingBox(9, 59, 99, 11, 61, 101, 0)
gmsh.model.addPhysicalGroup(0, [tag for _, tag in tip], name="tip")
for key, value in {"Mesh.MeshSizeMax": 15, "Mesh.SaveGroupsOfNodes": 1, "Mesh.SaveGroupsOfElements": 1, **options}.items():
    gmsh.option.setNumber(key, value)
gmsh.model.mesh.generate(3)
gmsh.model.mesh.setOrder(order)
gmsh.write(path)
"""


@pytest.fixture(scope="session")
def bracket_mesh(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """A bracket of two blocks [mm] written by gmsh, a process of its own, into a file of an ending."""
    made: dict[str, Path] = {}

    def write(ending: str, order: int = 2, **options: float) -> Path:
        key = f"{ending}-{order}-{json.dumps(options)}"
        if key not in made:
            made[key] = tmp_path_factory.mktemp("bracket") / f"bracket.{ending}"
            subprocess.run([sys.executable, "-P", "-c", BRACKET, str(made[key]), str(order), "", json.dumps(options)], check=True)
        return made[key]

    return write
