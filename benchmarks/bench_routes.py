"""What each route to inertia costs, against the others and against the imports alone, and what a finer mesh buys.

The routes run warm, on a drawing that is built anew every time. The import is that of the route's library in a fresh process: the
price of the first answer.
"""

import sys
from collections.abc import Callable
from functools import partial

import numpy as np

from benchmarks.bench_import import in_a_fresh_process
from benchmarks.ratios import measure, show
from geometry import cad
from geometry import routes as geometry_routes
from geometry.articles import built_in
from geometry.mesh import DEFAULT_CHORD
from geometry.routes import by_mesh, tessellation_error

ARTICLE = "fmd+clumod-4"
CHORDS = DEFAULT_CHORD * 4.0 ** np.arange(4, -1, -1)


def routes() -> dict[str, Callable[[], object]]:
    """Every route on `ARTICLE`, and the import of every route's library in a fresh process."""
    return {
        "pinocchio": lambda: geometry_routes.inertia(built_in(ARTICLE)),
        "occ": lambda: cad.inertia(built_in(ARTICLE)),
        f"trimesh, chord {1e6 * DEFAULT_CHORD:g} µm": lambda: by_mesh(built_in(ARTICLE)),
        "import pinocchio": in_a_fresh_process("import pinocchio"),
        "import cadquery": in_a_fresh_process("import cadquery"),
        "import cadquery, trimesh": in_a_fresh_process("import cadquery, trimesh"),
    }


def tessellations() -> tuple[dict[str, Callable[[], object]], dict[str, str]]:
    """The mesh route at every chord error, and its error in mass and in the tensor beside the bound that is stated."""
    article = built_in(ARTICLE)
    exact = geometry_routes.inertia(article).parameters
    callables: dict[str, Callable[[], object]] = {}
    notes = {}
    for chord in CHORDS:
        name = f"chord {1e6 * chord:g} µm"
        callables[name] = partial(by_mesh, article, chord)
        error = np.abs(by_mesh(article, chord).parameters - exact) / np.abs(exact).max()
        stated = tessellation_error(article, chord) / np.abs(exact).max()
        notes[name] = f"{error.max():.1e} ({stated.max():.1e})"
    return callables, notes


if __name__ == "__main__":
    show(f"Routes to the inertia of {ARTICLE}", measure(routes(), rounds=3), base="occ")
    if "--json" not in sys.argv[1:]:
        callables, notes = tessellations()
        show(
            "Tessellation: time, and error relative to the largest parameter (bound that is stated)",
            measure(callables, rounds=1),
            base=next(iter(callables)),
            notes=notes,
        )
