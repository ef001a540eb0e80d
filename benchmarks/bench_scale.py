"""How the cost of a job grows: exponents for lines, campaigns, parts of a structure, degrees of freedom and candidates.

Times are of the processor, so that others on the machine do not count. An exponent is the slope of log time over log size, by
least squares over all sizes; what a job costs whatever its size flattens it.

    python -m benchmarks.bench_scale                      what takes minutes
    python -m benchmarks.bench_scale lines parts          some rows
    python -m benchmarks.bench_scale degrees --large      up to 300,000 degrees of freedom, with the peak of memory
"""

from __future__ import annotations

import gc
import resource
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache, partial
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.bench_structures import BAND, SHEET, plan
from benchmarks.blind.structures.shapes import PLATE, Mesh, Plan
from fem.structure import Structure
from fem.user_model import reading
from geometry.frames import Array
from identification.campaign import Campaign
from validation.compare.compare import compared
from validation.diagnose.candidates import baseline, candidates, screen
from validation.model.model import Model
from validation.prediction.series import predictions
from validation.prediction.structure import by_itself
from validation.study import Study
from validation.virtual_test.plan import Plan as Sweeps
from validation.virtual_test.simulate import simulate

ARTICLE = "fmd+cuboid"
MODEL = Model(source="benchmark", title="as drawn", article=ARTICLE)
PACE = 60.0
"""[octaves/min] of the sweeps."""

AROUND = 200
"""[count] of quadrangles along the plate that is cut into parts: its mesh is the same however many they are."""

SMALL, LARGE = (40, 80, 126), (40, 80, 160, 226)
"""Quadrangles along the longer side of the ribbed plate: from 10,000 to 90,000 degrees of freedom, and to 300,000."""

BARS = {"lines": 1.2, "campaigns": 1.2, "parts": 1.0, "degrees": 1.2, "candidates": 1.0}


@cache
def campaign() -> Campaign:
    """A quick test of a block."""
    return simulate(Sweeps(article=ARTICLE, seed=1, octaves_per_minute=PACE)).campaign


def of_lines(count: int) -> Callable[[], object]:
    """A comparison at so many lines."""
    found = (campaign(),)
    return lambda: compared(
        Study(model=MODEL, campaigns=found, made=predictions(MODEL, found, lines=np.linspace(4.0, 32.0, count)))
    )


def of_campaigns(count: int) -> Callable[[], object]:
    """A comparison with so many campaigns of one hardware: the same records under other names."""
    found = tuple(replace(campaign(), source=f"test {k}", title=f"test {k}") for k in range(count))
    return lambda: compared(Study(model=MODEL, campaigns=found, made=predictions(MODEL, found)))


def of_candidates(count: int) -> Callable[[], object]:
    """All candidates of the catalogue, so many times over, screened from one Jacobian."""
    found = (campaign(),)
    bench = Study(model=MODEL, campaigns=found, made=predictions(MODEL, found))
    menu, at = candidates(bench), baseline(bench)
    return lambda: screen(bench, at, (menu * (count // len(menu) + 1))[:count])


def strips(count: int) -> Plan:
    """A plate of 800 x 40 mm, cut into so many strips of its own material each."""

    def build(mesh: Mesh) -> None:
        def at(u: float, v: float, k: int) -> Array:
            return np.array([800 * (k + u) / count, 40 * v, 0.0])

        for k in range(count):
            mesh.patch(f"strip-{k}", partial(at, k=k), (AROUND // count, 4))

    return Plan(kind=PLATE, build=build, parts={f"strip-{k}": SHEET for k in range(count)}, support="free")


def structure(of: Plan) -> Structure:
    """`of`, read from files like a user's."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "model.toml"
        (file.parent / "mesh.inp").write_text(of.mesh(fine=False).text())
        file.write_text("format = 1\n" + of.description("mesh.inp", {"corner": (0.0, 0.0, 0.0)}))
        found = reading.read(file)
    assert isinstance(found, Structure)
    return found


def of_structure(of: Plan) -> Callable[[], object]:
    """A structure read and reduced."""
    return lambda: by_itself(structure(of), BAND)


JOBS: dict[str, tuple[str, Sequence[int], Callable[[int], Callable[[], object]]]] = {
    "lines": ("a comparison", (150, 475, 1500), of_lines),
    "campaigns": ("a comparison", (2, 6, 20), of_campaigns),
    "parts": ("read and reduced", (5, 20, 100, 200), lambda n: of_structure(strips(n))),
    "degrees": ("read and reduced", SMALL, lambda cells: of_structure(plan(cells))),
    "candidates": ("a screening", (300, 3000, 30000), of_candidates),
}
"""By name what is done, in which sizes, and what makes it ready."""


def taken(call: Callable[[], object]) -> float:
    """[s] of the processor."""
    gc.collect()
    began = time.process_time()
    call()
    return time.process_time() - began


def main(words: Sequence[str]) -> None:
    """Print a row for each of `words`."""
    table = Table(title="How costs grow", title_justify="left", title_style="bold")
    for heading in ("over", "what", "sizes", "times the smallest", "exponent", "bar", ""):
        table.add_column(heading, justify="left" if heading in ("over", "what", "") else "right")
    asked = [word for word in words if not word.startswith("-")]
    for name in [one for one in BARS if not asked or one in asked]:
        what, sizes, ready = JOBS[name]
        if name == "degrees" and "--large" in words:
            sizes = LARGE
        taken(ready(sizes[0]))  # what is imported and kept once
        seconds = np.array([taken(ready(one)) for one in sizes])
        if name == "degrees":
            sizes = [structure(plan(cells)).mass.shape[0] for cells in sizes]
        exponent = float(np.polyfit(np.log(sizes), np.log(seconds), 1)[0])
        said = ", ".join(f"{one:.3g}" for one in seconds / seconds[0])
        row = (name, what, ", ".join(f"{one:,.0f}" for one in sizes), said, f"{exponent:.2f}", f"{BARS[name]:g}")
        sys.stderr.write("  ".join(row) + "\n")  # what is known is seen before all is
        table.add_row(*row, "met" if exponent <= BARS[name] else "missed")
    Console().print(table)
    Console().print(f"peak of memory {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6:.2f} GB")


if __name__ == "__main__":
    main(sys.argv[1:])
