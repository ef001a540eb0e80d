"""What a mesh of a user's own costs to read and to reduce, how that grows, and how much memory it takes.

    python -m benchmarks.bench_structures [CELLS ...]     a plate with two ribs, so many quadrangles along its longer side
    python -m benchmarks.bench_structures STUDY.toml      a whole diagnosis, in full eigen-solutions of its structure

Times are of the processor, so that others on the machine do not count; memory is the peak of the process, the largest mesh last.
"""

from __future__ import annotations

import resource
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import click
import numpy as np
from scipy.linalg import eigh

from benchmarks.blind.structures.shapes import PLATE, Mesh, Plan
from benchmarks.ratios import measure, show
from fem.modes import lowest
from fem.structure import Structure, hold
from fem.user_model import reading
from validation.diagnose.diagnose import diagnosed
from validation.prediction.structure import by_itself
from validation.study import Study

CELLS = (40, 80, 160, 226)
"""Up to 300,000 degrees of freedom."""

SHEET = 'material = "steel"\nthickness = "4 mm"\nloss_factor = 0.01'

BAND = 300.0
"""[Hz]"""

MODES = 16
"""[count] of the lowest modes of a structure."""

BAR = 200.0
"""[eigen-solutions] that a whole diagnosis may cost."""


def plan(cells: int) -> Plan:
    """A plate of 800 x 600 mm with a rib along its middle and one across."""

    def build(mesh: Mesh) -> None:
        across = 2 * max(round(3 * cells / 8), 1)
        mesh.patch("plate", lambda u, v: np.array([800 * u, 600 * v, 0.0]), (cells, across))
        mesh.patch("along", lambda u, v: np.array([800 * u, 300.0, 40 * v]), (cells, 2))
        mesh.patch("through", lambda u, v: np.array([400.0, 600 * u, 40 * v]), (across, 2))

    return Plan(kind=PLATE, build=build, parts=dict.fromkeys(("plate", "along", "through"), SHEET), support="free")


def costs(cells: int) -> tuple[int, float, float, float]:
    """Degrees of freedom, seconds to read and to reduce, and the peak of memory so far [GB]."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "model.toml"
        (file.parent / "mesh.inp").write_text(plan(cells).mesh(fine=False).text())
        file.write_text("format = 1\n" + plan(cells).description("mesh.inp", {"corner": (0.0, 0.0, 0.0)}))
        began = time.process_time()
        found = reading.read(file)
    read = time.process_time() - began
    assert isinstance(found, Structure)
    began = time.process_time()
    by_itself(found, BAND)
    reduced = time.process_time() - began
    return found.mass.shape[0], read, reduced, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def diagnosis(study: str) -> None:
    """Print what a diagnosis of `study` costs over one eigen-solution of its first structure, all modes, and over the lowest."""
    opened = Study.open(study, ())
    reduced = next(one.structure.reduced for one in opened.tests if one.structure is not None)
    assert reduced is not None
    free = hold(reduced.structure)
    K, M = free.stiffness.toarray(), free.mass.toarray()
    calls: dict[str, Callable[[], object]] = {
        "one eigen-solution, all modes": lambda: eigh(M, K),  # which has no mass has a mode, too, of share zero
        f"one eigen-solution, the lowest {MODES}": lambda: lowest(free.stiffness, free.mass, MODES),
    }
    timings = measure(calls, rounds=3, clock=time.process_time)
    timings |= measure({"a whole diagnosis": lambda: diagnosed(opened)}, rounds=1, clock=time.process_time)
    title = f"{study}: {len(K)} degrees of freedom, {reduced.basis.shape[1]} coordinates; bar {BAR:g}"
    show(title, timings, base="one eigen-solution, all modes")


def main(cells: Sequence[int]) -> None:
    """Print a line each size, and the exponents from the first to the last."""
    rows = []
    for each in cells:
        rows.append(costs(each))
        n, read, reduced, memory = rows[-1]
        ratio = f"reduction {reduced / read:.1f} x reading"
        click.echo(f"{n:7d} degrees of freedom: {ratio}, peak {memory:.2f} GB")
    if len(rows) > 1:
        first, last = (np.log(np.array(row[:3])) for row in (rows[0], rows[-1]))
        size, read, reduced = last - first
        click.echo(f"grows as n^{read / size:.2f} (reading), n^{reduced / size:.2f} (reduction); bar n^1.3")


if __name__ == "__main__":
    asked = [one for one in sys.argv[1:] if not one.startswith("--")]
    if asked and not asked[0].isdecimal():
        diagnosis(asked[0])
    else:
        main([int(one) for one in asked] or CELLS)
