"""Structures as meshes in the format of Abaqus, coarse and fine, and the ``[fe_model]`` that describes them; millimetres.

A plan is drawn once; `Mesh` writes it at any fineness. What is modelled with quadrangles and few beams or bricks is tested with
triangles among twice as many quadrangles, with more bricks, and with three times as many beams.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise, product

import numpy as np

from geometry.frames import Array

FRAME, TRUSS, PLATE, BOXES, BARREL = KINDS = ("frame", "truss", "plate", "boxes", "barrel")

Point = tuple[float, float, float]


@dataclass
class Mesh:
    """Nodes and elements of one fineness.

    Attributes
    ----------
    fine : whether it is the one of the test
    nodes : number by place, to the nanometre
    elements : lines by type and part
    held : nodes that the ground holds
    """

    fine: bool
    nodes: dict[Point, int] = field(default_factory=dict)
    elements: dict[tuple[str, str], list[tuple[int, ...]]] = field(default_factory=dict)
    held: list[int] = field(default_factory=list)

    def node(self, point: Array) -> int:
        """The number of the node at `point`, a new one where there is none."""
        x, y, z = (round(float(value), 6) + 0.0 for value in point)
        return self.nodes.setdefault((x, y, z), len(self.nodes) + 1)

    def line(self, part: str, one: Array, other: Array, count: int) -> None:
        """Beams from one point to another."""
        count *= 3 if self.fine else 1
        along = [self.node(one + (other - one) * k / count) for k in range(count + 1)]
        self.elements.setdefault(("B31", part), []).extend(pairwise(along))

    def patch(self, part: str, at: Callable[[float, float], Array], count: tuple[int, int]) -> None:
        """Shells over ``at(u, v)``, 0 to 1 each."""
        n, m = (2 * each if self.fine else each for each in count)
        grid = [[self.node(at(i / n, j / m)) for j in range(m + 1)] for i in range(n + 1)]
        for i, j in product(range(n), range(m)):
            a, b, c, d = grid[i][j], grid[i + 1][j], grid[i + 1][j + 1], grid[i][j + 1]
            if self.fine and (i + j) % 5 == 0:
                self.elements.setdefault(("S3", part), []).extend(((a, b, c), (a, c, d)))
            else:
                self.elements.setdefault(("S4", part), []).append((a, b, c, d))

    def brick(self, part: str, low: Array, high: Array, count: tuple[int, int, int]) -> None:
        """Solids that fill a box."""
        count = (count[0] + 1, count[1] + 1, count[2] + 1) if self.fine else count
        n = np.array(count)
        corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], dtype=float)
        ends = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
        places = np.vstack([corners, [(corners[a] + corners[b]) / 2 for a, b in ends]])
        for first in product(*(range(each) for each in count)):
            own = tuple(self.node(low + (high - low) * (np.array(first) + place) / n) for place in places)
            self.elements.setdefault(("C3D20", part), []).append(own)

    def hold(self, where: Callable[[Array], bool]) -> None:
        """Have the ground hold nodes."""
        self.held += [number for point, number in self.nodes.items() if where(np.array(point))]

    def text(self) -> str:
        """The file."""
        lines = ["*NODE", *(f"{number}, {x:.9g}, {y:.9g}, {z:.9g}" for (x, y, z), number in self.nodes.items())]
        number = 0
        for (kind, part), found in self.elements.items():
            lines.append(f"*ELEMENT, TYPE={kind}, ELSET={part}")
            for nodes in found:
                number += 1
                whole = [str(number), *map(str, nodes)]
                lines += [", ".join(whole[k : k + 15]) + ("," if k + 15 < len(whole) else "") for k in range(0, len(whole), 15)]
        if self.held:
            lines += ["*NSET, NSET=HELD", *(f"{one}," for one in self.held)]
        return "\n".join(lines) + "\n"


@dataclass(frozen=True, kw_only=True)
class Plan:
    """One structure.

    Attributes
    ----------
    kind : of `KINDS`
    build : makes its mesh
    parts : lines of the description by part
    more : lines of supports and joints
    support : "ground" or "free"
    held : whether the ground holds nodes of it
    stands : where a base would hold it
    """

    kind: str
    build: Callable[[Mesh], None]
    parts: Mapping[str, str]
    more: tuple[str, ...] = ()
    support: str = "ground"
    held: bool = False
    stands: Callable[[Array], bool] = lambda at: bool(at[2] == 0)

    def mesh(self, *, fine: bool) -> Mesh:
        """Coarse for the model, fine for the test."""
        made = Mesh(fine=fine)
        self.build(made)
        return made

    def description(self, file: str, places: Mapping[str, Point]) -> str:
        """The table ``[fe_model]`` and those below it."""
        named = ", ".join(f'{name} = ["{x:.6g} mm", "{y:.6g} mm", "{z:.6g} mm"]' for name, (x, y, z) in places.items())
        lines = ["[fe_model]", 'kind = "mesh"', 'units = "mm"', f'file = "{file}"', f'support = "{self.support}"']
        lines += ['interface = ["HELD"]'] if self.held else []
        lines += [f"places = {{ {named} }}", *self.more]
        for name, said in self.parts.items():
            lines += [f"[fe_model.parts.{name}]", said]
        return "\n".join(lines) + "\n"


def drawn(kind: str, generator: np.random.Generator, *, base: bool = False) -> Plan:
    """A structure of that kind; held by a `base` that moves, where it is free, on springs or on the ground otherwise."""
    plans = {FRAME: _frame, TRUSS: _truss, PLATE: _plate, BOXES: _boxes, BARREL: _barrel}
    found = plans[kind](generator)
    if not base:
        return found

    def build(mesh: Mesh) -> None:
        found.build(mesh)
        if not found.held:
            mesh.hold(found.stands)

    springs = tuple(one for one in found.more if not one.startswith("[fe_model.springs"))
    return replace(found, build=build, more=springs, support="base", held=True)


LOSS = "loss_factor = 0.02"
METALS = ("aluminium", "steel")


def _beam(generator: np.random.Generator, low: float, high: float) -> str:
    width, height = (round(float(generator.uniform(low, high)), 1) for _ in range(2))
    return f'material = "{generator.choice(METALS)}"\nsection = {{ width = "{width} mm", height = "{height} mm" }}\n{LOSS}'


def _sheet(generator: np.random.Generator, low: float, high: float) -> str:
    thickness = round(float(generator.uniform(low, high)), 2)
    return f'material = "{generator.choice(METALS)}"\nthickness = "{thickness} mm"\n{LOSS}'


def _spring(name: str, at: Array, generator: np.random.Generator, size: float) -> str:
    k = [float(f"{size * np.exp(generator.uniform(-0.5, 0.5)):.3g}") for _ in range(3)]
    x, y, z = at
    values = [*(f'"{one:g} N/mm"' for one in k), *(f'"{1e3 * one:g} N mm/rad"' for one in k)]
    return f'[fe_model.springs.{name}]\nat = ["{x:g} mm", "{y:g} mm", "{z:g} mm"]\nstiffness = [{", ".join(values)}]\n{LOSS}'


def _frame(generator: np.random.Generator) -> Plan:
    storeys, bays = int(generator.integers(1, 4)), 1
    high, wide, deep = generator.uniform(350, 600), generator.uniform(400, 700), generator.uniform(300, 500)
    springs = bool(generator.integers(2))
    names = [f"{what}-{k + 1}" for k in range(storeys) for what in ("left", "right", "floor")]
    feet = [np.array([i * wide, y, 0.0]) for i in range(bays + 1) for y in (0.0, deep)]

    def build(mesh: Mesh) -> None:
        up = np.array([0.0, 0.0, high])
        for k in range(storeys):
            for foot in feet:
                side = "left" if foot[0] < wide * bays / 2 else "right"
                mesh.line(f"{side}-{k + 1}", foot + k * up, foot + (k + 1) * up, 8)
            level = [foot + (k + 1) * up for foot in feet]
            for i in range(bays + 1):
                mesh.line(f"floor-{k + 1}", level[2 * i], level[2 * i + 1], 6)
                for y in (0, 1) if i < bays else ():
                    mesh.line(f"floor-{k + 1}", level[2 * i + y], level[2 * i + 2 + y], 6)
        if not springs:
            mesh.hold(lambda at: at[2] == 0)

    more = tuple(_spring(f"foot-{k + 1}", foot, generator, 3e3) for k, foot in enumerate(feet)) if springs else ()
    parts = {name: _beam(generator, 14, 30) for name in names}
    return Plan(kind=FRAME, build=build, parts=parts, more=more, held=not springs)


def _truss(generator: np.random.Generator) -> Plan:
    bays, long, high, wide = int(generator.integers(2, 5)), 400.0, generator.uniform(300, 450), generator.uniform(300, 500)
    half = bays * long / 2
    names = ["top", "bottom-1", "bottom-2", "posts-1", "posts-2", "diagonals-1", "diagonals-2", "cross"]
    ends = [np.array([x, y, 0.0]) for x in (0.0, bays * long) for y in (0.0, wide)]

    def build(mesh: Mesh) -> None:
        for y in (0.0, wide):
            low = [np.array([k * long, y, 0.0]) for k in range(bays + 1)]
            top = [each + np.array([0.0, 0.0, high]) for each in low]
            for k in range(bays + 1):
                side = 1 if low[k][0] <= half else 2
                mesh.line(f"posts-{side}", low[k], top[k], 3)
                if k < bays:
                    side = 1 if low[k][0] + long / 2 <= half else 2
                    mesh.line("top", top[k], top[k + 1], 3)
                    mesh.line(f"bottom-{side}", low[k], low[k + 1], 3)
                    mesh.line(f"diagonals-{side}", low[k] if k % 2 else top[k], top[k + 1] if k % 2 else low[k + 1], 3)
        for k, z in product(range(bays + 1), (0.0, high)):
            mesh.line("cross", np.array([k * long, 0, z]), np.array([k * long, wide, z]), 3)

    more = tuple(_spring(f"bearing-{k + 1}", at, generator, 1e4) for k, at in enumerate(ends))
    parts = {name: _beam(generator, 15, 30) for name in names}
    return Plan(kind=TRUSS, build=build, parts=parts, more=more, stands=lambda at: at[2] == 0 and at[0] in (0.0, bays * long))


def _plate(generator: np.random.Generator) -> Plan:
    ribs, long, wide = int(generator.integers(2, 4)), generator.uniform(600, 900), generator.uniform(350, 500)
    deep = generator.uniform(25, 50)
    n = 6 * (ribs + 1)

    def build(mesh: Mesh) -> None:
        mesh.patch("plate", lambda u, v: np.array([u * long, v * wide, 0.0]), (n, 14))
        for k in range(ribs):
            x = (k + 1) * long / (ribs + 1)
            mesh.patch(f"rib-{k + 1}", lambda u, v, x=x: np.array([x, u * wide, v * deep]), (14, 2))  # type: ignore[misc]

    parts = {"plate": _sheet(generator, 3, 6), **{f"rib-{k + 1}": _sheet(generator, 2, 5) for k in range(ribs)}}
    return Plan(kind=PLATE, build=build, parts=parts, support="free")


def _boxes(generator: np.random.Generator) -> Plan:
    count, a, b = int(generator.integers(3, 6)), generator.uniform(60, 100), generator.uniform(60, 100)
    heights = generator.uniform(60, 160, count)
    level = np.concatenate([[0.0], np.cumsum(heights)])
    jointed = sorted(int(k) for k in generator.choice(count - 1, min(2, count - 1), replace=False))

    def build(mesh: Mesh) -> None:
        for k in range(count):
            layers = max(round(heights[k] / 30), 2)
            mesh.brick(f"box-{k + 1}", np.array([0, 0, level[k]]), np.array([a, b, level[k + 1]]), (3, 3, layers))
        mesh.hold(lambda at: at[2] == 0)

    more = []
    for k in jointed:
        size = 2e5 * float(np.exp(generator.uniform(-0.5, 0.5)))
        turned = size * 1e3
        values = [*(f'"{size:.4g} N/mm"' for _ in range(3)), *(f'"{turned:.4g} N mm/rad"' for _ in range(3))]
        at = f'["{a / 2:.6g} mm", "{b / 2:.6g} mm", "{level[k + 1]:.6g} mm"]'
        more += [f"[fe_model.joints.joint-{k + 1}]", f'between = ["box-{k + 1}", "box-{k + 2}"]', f"at = {at}"]
        more.append(f"stiffness = [{', '.join(values)}]\n{LOSS}")
    parts = {f"box-{k + 1}": f'material = "{generator.choice(METALS)}"\n{LOSS}' for k in range(count)}
    return Plan(kind=BOXES, build=build, parts=parts, more=tuple(more), held=True)


def _barrel(generator: np.random.Generator) -> Plan:
    rings, radius, high = int(generator.integers(3, 5)), generator.uniform(120, 200), generator.uniform(80, 130)
    held = bool(generator.integers(2))

    def build(mesh: Mesh) -> None:
        def ring(k: int) -> Callable[[float, float], Array]:
            return lambda u, v: np.array(
                [1.12 * radius * np.cos(2 * np.pi * u), radius * np.sin(2 * np.pi * u), (k + v) * high], dtype=np.float64
            )

        for k in range(rings):
            mesh.patch(f"ring-{k + 1}", ring(k), (44, 5))
        if held:
            mesh.hold(lambda at: at[2] == 0)

    parts = {f"ring-{k + 1}": _sheet(generator, 1.5, 3) for k in range(rings)}
    return Plan(kind=BARREL, build=build, parts=parts, support="ground" if held else "free", held=held)
