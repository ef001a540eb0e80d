"""The drawing of ``docs/architecture.md``: the rooms on their floors, and the ways of two commands through them.

Rooms and lines are those of the source. `FLOORS` says on which floor a room stands and what it is for; that no import goes
upwards is held by ``tests/architecture/test_house.py``.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tools.house import FACE, ROOMS, ROOT, imports, modules

FLOORS: Mapping[str, Mapping[str, str]] = {
    "asked": {"massline": "Python", "cli": "terminal", "app": "browser"},
    "shown": {"report": "documents, tables, charts, scenes"},
    "answered": {
        "study": "model and data",
        "compare": "where it fails",
        "diagnose": "what is missing",
        "history": "add, ladder",
        "identify": "inertia, pretest",
        "correct": "a campaign",
        "verification": "of solvers",
    },
    "predicted\nand fitted": {"prediction": "what each channel reads", "estimation": "fits, evidence, errors"},
    "described": {
        "model": "the model file",
        "effects": "one file a family",
        "virtual_test": "simulate",
        "excite": "base motion",
        "flexible": "modes",
        "classical": "weigh, swing",
        "reference": "known values",
        "output": "JSON",
    },
    "computed": {
        "fem": "predict: structures, modes, response in time",
        "identification": "estimate: campaigns, spectra, rigid body",
    },
    "named": {"geometry": "inertia, frames, articles, sensors, files"},
}
"""From the top, by floor its rooms; a room imports from its own floor and from those below."""

WAYS: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "diagnose": ("#0b5fa5", ("cli", "study", "prediction", "diagnose", "estimation", "report")),
    "identify": ("#b3541e", ("cli", "identify", "identification", "report")),
}
"""By command its colour and the rooms that it passes, in order; the page says what happens in each."""


def room(module: str) -> str:
    """The room in which `module` stands: the first part of its name, and of `validation` the second."""
    parts = module.split(".")
    return parts[1] if parts[0] == "validation" and len(parts) > 1 else parts[0]


def leads(root: Path = ROOT) -> dict[str, set[str]]:
    """By room those that it imports."""
    found: dict[str, set[str]] = {}
    for module, targets in imports(modules(root, (*ROOMS, FACE))).items():
        found.setdefault(room(module), set()).update({room(to) for to in targets} - {room(module)})
    return {name: to - {"validation"} for name, to in found.items() if name != "validation"}


def upwards(graph: Mapping[str, set[str]]) -> list[str]:
    """Imports of `graph` that go to a higher floor, and rooms that stand on none."""
    floor = {name: number for number, rooms in enumerate(FLOORS.values()) for name in rooms}
    lost = [f"{name} stands on no floor" for name in sorted(graph.keys() - floor.keys())]
    known = [(name, to) for name, targets in sorted(graph.items()) for to in sorted(targets) if {name, to} <= floor.keys()]
    return lost + [f"{name} imports {to}" for name, to in known if floor[to] < floor[name]]


def draw(path: Path, root: Path = ROOT) -> None:
    """Write the drawing to `path`, a PNG."""
    from matplotlib.figure import Figure

    graph = leads(root)
    figure = Figure(figsize=(11.0, 7.6), dpi=110)
    page = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    page.set(xlim=(0, 110), ylim=(0, 76))
    page.axis("off")
    places: dict[str, tuple[float, float]] = {}
    for number, (floor, rooms) in enumerate(FLOORS.items()):
        there, y = [name for name in rooms if name in graph], 64 - 9.8 * number
        page.text(1.5, y, floor, va="center", color="#777777", style="italic", fontsize=10)
        wide = 96 / len(there)
        for k, name in enumerate(there):
            places[name] = (12 + wide * (k + 0.5), y)
            _box(page, places[name], min(wide - 1.4, 46), name, rooms[name])
    for name, to in _lines(graph):
        (x, y), (u, v) = places[name], places[to]
        page.plot((x, u), (y - 2.9, v + 2.9), color="#c4c4c4", linewidth=0.7, zorder=0)
    page.text(1.5, 72.5, "Rooms of massline", fontsize=14, weight="bold", va="center")
    for row, (command, (colour, passed)) in enumerate(WAYS.items()):
        page.text(64 + 23 * row, 72.5, f"●  the way of {command}", color=colour, fontsize=11, va="center")
        for k, name in enumerate(passed, 1):
            x, y = places[name]
            page.text(
                x + 3.0 * row - 1.5,
                y + 3.1,
                f"{k}",
                color="white",
                fontsize=8,
                weight="bold",
                ha="center",
                va="center",
                bbox={"boxstyle": "circle,pad=0.22", "facecolor": colour, "edgecolor": "white"},
            )
    page.text(
        1.5,
        1.0,
        "A grey line: the upper room imports the lower one; of longer chains the links alone.",
        fontsize=8,
        color="#777777",
    )
    figure.savefig(path)


def _box(page: Any, place: tuple[float, float], wide: float, name: str, what: str) -> None:
    from matplotlib.patches import FancyBboxPatch

    x, y = place
    style = "round,pad=0,rounding_size=0.8"
    page.add_patch(FancyBboxPatch((x - wide / 2, y - 2.9), wide, 5.8, boxstyle=style, facecolor="#f4f6f8", edgecolor="#5a6570"))
    page.text(x, y + 0.9, name, ha="center", va="center", fontsize=9.5, weight="bold")
    page.text(x, y - 1.2, what, ha="center", va="center", fontsize=7.2, color="#444444")


def _lines(graph: Mapping[str, set[str]]) -> list[tuple[str, str]]:
    """Imports between floors that no chain of others already says."""
    import networkx

    floor = {name: number for number, rooms in enumerate(FLOORS.values()) for name in rooms}
    down = networkx.DiGraph([(name, to) for name, targets in graph.items() for to in targets if floor[to] > floor[name]])
    return sorted(networkx.transitive_reduction(down).edges)
