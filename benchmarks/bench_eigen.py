"""What thirty fixed-base modes of a solid cost: ours by every factoriser, SciPy's own calls, CalculiX; and how that grows.

The solid is an article in curved ten-node tetrahedra. Every way gets the same matrices, CalculiX the same mesh. SciPy's plain
call looks for the smallest eigenvalues without inverting, which does not converge on a solid: it is stopped after a few restarts
and says how many modes it had. Memory is what the solution adds to the peak of a process of its own.

    python -m benchmarks.bench_eigen            ratios on one mesh
    python -m benchmarks.bench_eigen --growth   time and memory from 30 000 to 300 000 degrees of freedom
"""

import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.ratios import measure, show
from fem import factorisers, modes
from fem.solid import model, tetrahedra
from fem.solid.assembly import SolidMesh
from fem.solid.tetrahedra import bodies
from fem.structure import HeldBase, Structure, hold
from geometry.article import Material
from geometry.articles import built_in
from geometry.frames import Array

ARTICLE = "disc"
COUNT = 30
AFFORDABLE = 7e9
"""Memory [B] that a row of the growth table may take; what is foreseen to take more is not run."""

RESTARTS = 10
GROWTH = (0.03, 0.0085, 0.006, 0.0048)
"""Sizes of the elements [m]."""


def solid(size: float) -> tuple[SolidMesh, Structure, Material]:
    """Mesh and structure of the block, and what it is made of."""
    found = bodies(built_in(ARTICLE))
    made = tetrahedra.tetrahedra(found, tetrahedra.Sizing(size=size))
    materials = {body.name: body.material for body in found}
    return made, model.of_mesh(made, materials), found[0].material


def ways(held: HeldBase) -> Mapping[str, Callable[[], Array]]:
    """Frequencies [Hz] by our shift-invert with every factoriser and by SciPy's shift-invert as it comes."""
    ours = {f"ours, {name}": partial(_ours, held, name) for name in factorisers.installed()}
    plain = partial(_scipy, held, which="SM", maxiter=RESTARTS)
    return ours | {"SciPy, sigma=0": partial(_scipy, held, sigma=0), f"SciPy, {RESTARTS} restarts": plain}


def calculix(mesh: SolidMesh, structure: Structure, material: Material) -> Array:
    """Frequencies [Hz] by CalculiX on the same mesh; its C3D10 numbers nodes as `SolidMesh` does."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "solid.inp").write_text(_deck(mesh, structure, material), encoding="ascii")
        environment = os.environ | {"OMP_NUM_THREADS": "1"}
        subprocess.run(["ccx", "solid"], cwd=folder, check=True, stdout=subprocess.DEVNULL, env=environment)
        lines = Path(folder, "solid.dat").read_text(encoding="ascii").splitlines()
    rows = [line.split() for line in lines]
    return np.array([float(row[3]) for row in rows if len(row) == 5 and row[0].isdigit()][:COUNT])


def _deck(mesh: SolidMesh, structure: Structure, material: Material) -> str:
    nodes = [f"{k},{x:.12e},{y:.12e},{z:.12e}" for k, (x, y, z) in enumerate(mesh.points, start=1)]
    cells = [",".join(str(v) for v in (k, *(cell + 1))) for k, cell in enumerate(mesh.cells, start=1)]
    base = [str(k) for k in np.unique(structure.held // 3) + 1]
    head = [
        "*MATERIAL,NAME=M",
        "*ELASTIC",
        f"{material.youngs_modulus},{material.poisson_ratio}",
        "*DENSITY",
        f"{material.density}",
    ]
    step = ["*SOLID SECTION,ELSET=ALL,MATERIAL=M", "*BOUNDARY", "BASE,1,3", "*STEP", "*FREQUENCY", str(COUNT), "*END STEP"]
    listed = ["*NODE", *nodes, "*ELEMENT,TYPE=C3D10,ELSET=ALL", *cells, "*NSET,NSET=BASE", *base]
    return "\n".join([*listed, *head, *step, ""])


def _ours(held: HeldBase, name: str) -> Array:
    return _hertz(modes.lowest(held.stiffness, held.mass, COUNT, factoriser=name).values)


def _scipy(held: HeldBase, **options: Any) -> Array:
    from scipy.sparse.linalg import ArpackNoConvergence, eigsh

    try:
        return _hertz(np.sort(eigsh(held.stiffness, COUNT, M=held.mass, return_eigenvectors=False, **options)))
    except ArpackNoConvergence as error:
        return _hertz(np.sort(error.eigenvalues))


def _hertz(squares: Array) -> Array:
    return np.asarray(np.sqrt(np.abs(squares)) / (2 * np.pi))


def note(found: Array, expected: Array) -> str:
    """How far from ours, or how many were found at all."""
    if len(found) < len(expected):
        return f"{len(found)} of {len(expected)} modes"
    return f"off by {np.abs(found / expected - 1).max():.0e}"


def compare() -> None:
    """Ratios on one mesh."""
    mesh, structure, material = solid(GROWTH[0])
    held = hold(structure)
    every = dict(ways(held))
    if shutil.which("ccx"):
        every["CalculiX"] = partial(calculix, mesh, structure, material)
    found: dict[str, Array] = {}
    timings = measure({name: partial(_keep, found, name, way) for name, way in every.items()}, rounds=1)
    notes = {name: note(frequencies, found["ours, superlu"]) for name, frequencies in found.items()}
    show(f"{COUNT} modes of {ARTICLE}, {held.free.size} degrees of freedom", timings, base="ours, superlu", notes=notes)


def _keep(found: dict[str, Array], name: str, way: Callable[[], Array]) -> None:
    found[name] = way()


def growth() -> None:
    """Time and peak memory of every factoriser over the number of degrees of freedom, as foreseen and as it was."""
    from rich.console import Console
    from rich.table import Table

    table = Table(title="Growth (each in a process of its own)", title_justify="left")
    for heading in ("degrees of freedom", "factoriser", "s", "peak GB", "foreseen GB"):
        table.add_column(heading, justify="right")
    for size in GROWTH:
        held = hold(solid(size)[1])
        for name in factorisers.installed():
            foreseen = factorisers.predicted_bytes(held.stiffness, name)
            seconds, peak = _alone(held, name) if foreseen < AFFORDABLE else ("-", "-")
            table.add_row(str(held.free.size), name, seconds, peak, f"{foreseen / 1e9:.2f}")
    Console().print(table)


def _alone(held: HeldBase, name: str) -> tuple[str, str]:
    """Seconds and gigabytes of one eigen-solution in a fresh process that reads the matrices from files."""
    from scipy.sparse import save_npz

    with tempfile.TemporaryDirectory() as folder:
        for matrix, values in (("K", held.stiffness), ("M", held.mass)):
            save_npz(Path(folder, f"{matrix}.npz"), values, compressed=False)
        command = [sys.executable, "-m", "benchmarks.bench_eigen", "--one", folder, name]
        seconds, peak = subprocess.run(command, check=True, capture_output=True, encoding="ascii").stdout.split()
    return f"{float(seconds):.1f}", f"{float(peak) / 1e9:.2f}"


def _one(folder: Path, name: str) -> None:
    """Seconds of one eigen-solution and the bytes it adds to the peak of this process, on standard output."""
    from scipy.sparse import load_npz

    K, M = (load_npz(folder / f"{matrix}.npz") for matrix in ("K", "M"))
    before, start = _peak(), time.perf_counter()
    modes.lowest(K, M, COUNT, factoriser=name)
    sys.stdout.write(f"{time.perf_counter() - start} {_peak() - before}\n")


def _peak() -> float:
    """Peak memory [B] of this process; Linux only, for `getrusage` counts what the process that started it had."""
    lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    return next(1024.0 * int(line.split()[1]) for line in lines if line.startswith("VmHWM:"))


if __name__ == "__main__":
    if "--one" in sys.argv:
        _one(Path(sys.argv[-2]), sys.argv[-1])
    elif "--growth" in sys.argv:
        growth()
    else:
        compare()
