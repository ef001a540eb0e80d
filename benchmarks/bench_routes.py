"""What each route to inertia costs, against the others and against the imports alone, and what a finer mesh buys.

The routes run warm, on a drawing that is built anew every time. The import is that of the route's library in a fresh process: the
price of the first answer. Processor time, that of children included, for a drawing of 18 bodies of five kinds: the whole command
against a fresh process that reads it and asks OCC for every body's properties once, and both without what is imported.
"""

import os
import sys
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.bench_import import in_a_fresh_process
from benchmarks.ratios import measure, show
from geometry import cad, user_article
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


PLAIN = """
from cadquery import importers
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
def plain():
    for solid in importers.importStep({path!r}).solids().vals():
        BRepGProp.VolumeProperties_s(solid.wrapped, GProp_GProps())
"""
"""What anybody does who has OCC, a drawing and nothing else: the measure of `drawings`."""

COMMAND = "from validation.cli.main import run; run(['reference', {path!r}, '--material', 'steel'])"


def drawn_assembly(path: Path) -> None:
    """Two brackets on a plate, six bolts with nuts, a rod with two more: 18 bodies of five kinds in a STEP file of splines."""
    from cadquery import Assembly, Location, Shape, Solid, Workplane
    from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert

    points = [(x, y) for x in (-45, 45) for y in (-26, 0, 26)]
    bracket = Workplane().box(50, 100, 10).faces(">Z").workplane().pushPoints([(0, y) for y in (-26, 0, 26)]).hole(10)
    kinds: dict[str, Any] = {
        "plate": Workplane().box(180, 150, 20).faces(">Z").workplane().pushPoints(points).hole(10),
        "bracket": bracket.union(
            Workplane().box(10, 100, 60).translate((-20, 0, 35)).faces("<X").workplane(centerOption="CenterOfMass").hole(10)
        ),
        "bolt": Workplane().cylinder(4, 7.5).union(Workplane().cylinder(37, 5).translate((0, 0, -20.5))),
        "nut": Workplane().polygon(6, 16).circle(5).extrude(3),
        "rod": Workplane(Solid.makeCylinder(5, 200)),
    }
    places = [("plate", (0, 0, 0), 0), *(("bracket", (x, 0, 15), 0) for x in (-45, 45)), ("rod", (-100, 0, 50), 90)]
    places += [(kind, (x, y, z), 0) for x, y in points for kind, z in (("bolt", 22), ("nut", -13))]
    assembly = Assembly(name="assembly")
    splines = {
        kind: Shape.cast(BRepBuilderAPI_NurbsConvert(body.vals()[0].wrapped, True).Shape()) for kind, body in kinds.items()
    }
    for k, (kind, place, turn) in enumerate([*places, ("nut", (-90, 0, 50), 90), ("nut", (85, 0, 50), 90)]):
        assembly.add(splines[kind], name=f"{kind} {k}", loc=Location(place, (0, 1, 0), turn))
    with cad.silence():
        assembly.export(str(path), "STEP")


def drawings(path: Path) -> tuple[dict[str, Callable[[], object]], dict[str, Callable[[], object]]]:
    """Of the drawing `path`: the command and the plain way, first in fresh processes, then in this one."""
    plain: dict[str, Callable[[], None]] = {}
    exec(PLAIN.format(path=str(path)), plain)
    fresh = {"plain": PLAIN.format(path=str(path)) + "plain()", "massline reference": COMMAND.format(path=str(path))}

    def ours() -> None:
        article = user_article.load(path, material="steel")
        user_article.agreement(article, user_article.inertias(article))

    return {name: in_a_fresh_process(text) for name, text in fresh.items()}, {"plain": plain["plain"], "both routes": ours}


def processor_time() -> float:
    """Of this process and all its children that have ended [s]."""
    return sum(os.times()[:4])


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        drawn_assembly(path := Path(folder, "assembly.step"))
        for where, ways in zip(("a fresh process", "this process"), drawings(path), strict=True):
            show(f"A drawing of 18 bodies, in {where}: processor time", measure(ways, 3, processor_time), base="plain")
    show(f"Routes to the inertia of {ARTICLE}", measure(routes(), rounds=3), base="occ")
    if "--json" not in sys.argv[1:]:
        callables, notes = tessellations()
        show(
            "Tessellation: time, and error relative to the largest parameter (bound that is stated)",
            measure(callables, rounds=1),
            base=next(iter(callables)),
            notes=notes,
        )
