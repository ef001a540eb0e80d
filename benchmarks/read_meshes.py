"""How the time to read and assemble a user's mesh grows with its size: ``python -m benchmarks.read_meshes [FINEST]``.

Prints, for second-order bricks and for shells, the exponent of the time in the number of degrees of freedom, 1 where it is
proportional. Grids in the text of Abaqus are made here for the tests as well.
"""

import sys
import tempfile
import time
from collections.abc import Mapping
from itertools import product
from pathlib import Path

import numpy as np

from fem.mesh import model, solids

STEEL = 'material = { density = "7850 kg/m^3", youngs_modulus = "210 GPa", poisson_ratio = 0.3 }'

Groups = Mapping[str, tuple[str, list[list[int]]]]
"""By name the Abaqus type of the elements and their nodes, counted from 1."""


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


def seconds(mesh: str, part: str) -> tuple[int, float]:
    """Degrees of freedom of a free structure, and processor time to read and assemble it."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "mesh.inp").write_text(mesh, encoding="utf-8")
        text = f'format = 1\n[fe_model]\nkind = "mesh"\nunits = "m"\nfile = "mesh.inp"\nsupport = "free"\n{part}'
        Path(folder, "mesh.toml").write_text(text, encoding="utf-8")
        start = time.process_time()
        _, made = model.load(Path(folder, "mesh.toml"))
        return made.mass.shape[0], time.process_time() - start


def exponent(sizes: list[tuple[int, float]]) -> float:
    """Slope of time over size in logarithms."""
    n, t = np.log(np.array(sizes)).T
    return float(np.polyfit(n, t, 1)[0])


def main(finest: float = 1.0) -> None:
    part = f"[fe_model.parts.p]\n{STEEL}\n"
    solid, shell = [], []
    points, elements = bricks((2, 2, 2), (1.0, 1.0, 1.0), "C3D20")
    seconds(abaqus(points, {"p": ("C3D20", elements)}), part)  # what is imported once belongs to no size
    for share in (0.1, 0.3, 1.0):
        n = round(20 * finest * share ** (1 / 3))
        points, elements = bricks((n, n, n), (1.0, 1.0, 1.0), "C3D20")
        solid.append(seconds(abaqus(points, {"p": ("C3D20", elements)}), part))
        n = round(130 * finest * share**0.5)
        points, elements = plate(n, n, (1.0, 1.0))
        shell.append(seconds(abaqus(points, {"p": ("S4", elements)}), f'{part}thickness = "3 mm"\n'))
    for name, sizes in (("second-order bricks", solid), ("shells", shell)):
        low, high = sizes[0][0], sizes[-1][0]
        sys.stdout.write(f"{name}: {low:,} to {high:,} degrees of freedom, exponent {exponent(sizes):.2f}\n")


if __name__ == "__main__":
    main(*map(float, sys.argv[1:2]))
