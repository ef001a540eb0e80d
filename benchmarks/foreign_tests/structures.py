"""The structures: what is tested, and the model as its owner would write it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from itertools import pairwise, product
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.foreign_tests.laboratory import Bench
from benchmarks.foreign_tests.truth import ALUMINIUM, STEEL, Box, Fine, Member, Places, beams, solids, tetrahedra


def described(parts: Mapping[str, str], places: Places, *more: str) -> str:
    named = ", ".join(f'{name} = ["{x} mm", "{y} mm", "{z} mm"]' for name, (x, y, z) in places.items())
    lines = ["[fe_model]", 'kind = "mesh"', 'units = "mm"', *more, f"places = {{ {named} }}"]
    return "\n".join([*lines, *(line for name, said in parts.items() for line in (f"[fe_model.parts.{name}]", said))]) + "\n"


METAL = {"aluminium": ALUMINIUM, "steel": STEEL}


def of(metal: str) -> str:
    E, nu, rho = METAL[metal]
    material = f'{{ density = "{rho:g} kg/m^3", youngs_modulus = "{E / 1e9:g} GPa", poisson_ratio = {nu} }}'
    return f"material = {material}\nloss_factor = 0.02"


def bricks(boxes: Mapping[str, Box], metals: Mapping[str, str], *, fine: float, coarse: float, clamped: bool) -> dict[str, Any]:
    """Truth and model of boxes that are solids in both."""

    @cache
    def truth() -> Fine:
        made = solids(boxes, fine, {name: METAL[metal] for name, metal in metals.items()})
        at = np.flatnonzero(made.points[:, 2] < 1e-9) if clamped else np.zeros(0, dtype=int)
        made.held = np.concatenate([3 * at + k for k in range(3)])
        return made

    def model(folder: Path, places: Places) -> str:
        tetrahedra(folder / "own.msh", boxes, coarse)
        held = ('support = "ground"', 'interface = ["underside"]') if clamped else ('support = "free"',)
        return described({name: of(metal) for name, metal in metals.items()}, places, 'file = "own.msh"', *held)

    return {"fine": truth, "described": model}


PLATE = {
    "plate": (0, 0, 0, 300, 200, 6),
    "rib-1": (0, 40, 6, 300, 48, 30),
    "rib-2": (0, 150, 6, 300, 158, 30),
}
BRACKET = {
    "foot": (0, 0, 0, 120, 80, 12),
    "upright": (0, 0, 12, 10, 80, 132),
    "gusset": (10, 36, 12, 50, 44, 72),
}


def plate() -> Bench:
    corners = {"a": (12, 12, 0), "b": (288, 12, 0), "c": (288, 188, 0), "d": (12, 188, 0), "e": (150, 12, 0), "f": (150, 188, 0)}
    places = {**corners, "g": (150, 100, 0), "h": (12, 100, 0)}
    return Bench(
        **bricks(PLATE, dict.fromkeys(PLATE, "aluminium"), fine=12.5, coarse=22.0, clamped=False),
        places=places,
        responses=tuple(f"{name}:z" for name in places),
        drives=("a:z", "e:z"),
        modes=6,
        faults={
            "mass": ("point-mass", "c", 0.02),
            "softer": ("modulus", "rib-1", -0.2),
            "gain": ("gain", "b:z", 0.08),
            "polarity": ("polarity", "f:z", 0.0),
            "swap": ("swap", "d:z e:z", 0.0),
        },
    )


def bracket() -> Bench:
    places = {
        "tip": (0, 8, 124),
        "side": (0, 72, 124),
        "mid": (0, 40, 124),
        "low": (0, 8, 72),
        "back": (0, 72, 72),
        "knee": (50, 40, 64),
    }
    return Bench(
        **bricks(BRACKET, {"foot": "aluminium", "upright": "aluminium", "gusset": "steel"}, fine=8.0, coarse=14.0, clamped=True),
        places=places,
        responses=("tip:x", "side:x", "mid:x", "low:x", "back:x", "tip:y", "knee:y", "mid:z"),
        drives=("tip:x", "side:y"),
        modes=5,
        faults={
            "mass": ("point-mass", "side", 0.01),
            "softer": ("modulus", "upright", -0.15),
            "gain": ("gain", "mid:x", 0.08),
            "polarity": ("polarity", "low:x", 0.0),
            "swap": ("swap", "tip:x low:x", 0.0),
        },
    )


TOP = {
    "top": (0, 0, 0, 600, 400, 8),
    "apron-1": (0, 60, -40, 600, 66, 0),
    "apron-2": (0, 334, -40, 600, 340, 0),
}
LEGS = {"leg-1": (60, 40), "leg-2": (540, 40), "leg-3": (540, 360), "leg-4": (60, 360)}
LOST = "loss_factor = 0.02"
LEG = 2.5e5
"""[N/m] along every axis."""


def table_top() -> Bench:
    """Solids in truth; shells, middle on middle, and four springs in the model."""
    corners = {"a": (0, 0, 4), "b": (600, 0, 4), "c": (600, 400, 4), "d": (0, 400, 4), "e": (300, 0, 4), "f": (300, 400, 4)}
    places = {**corners, "g": (300, 200, 4), "h": (0, 200, 4)}

    @cache
    def truth() -> Fine:
        made = solids(TOP, 25.0, dict.fromkeys(TOP, STEEL))
        made.springs = {name: (made.nearest((x / 1e3, y / 1e3, 0.004)), np.full(3, LEG)) for name, (x, y) in LEGS.items()}
        return made

    def model(folder: Path, places: Places) -> str:
        nodes: dict[tuple[float, float, float], int] = {}
        deck, count = list[str](), 0
        for part, at, n, m in (
            (
                "top",
                lambda u, v: (u, v, 4.0),
                np.linspace(0, 600, 21),
                np.array([0, 20, 40, 63, 90, 120, 150, 200, 250, 280, 310, 337, 360, 380, 400.0]),
            ),
            ("apron-1", lambda u, v: (u, 63.0, v), np.linspace(0, 600, 21), np.array([-40, -20, 4.0])),
            ("apron-2", lambda u, v: (u, 337.0, v), np.linspace(0, 600, 21), np.array([-40, -20, 4.0])),
        ):
            deck.append(f"*ELEMENT, TYPE=S4, ELSET={part}")
            for (u, w), (v, y) in product(pairwise(n), pairwise(m)):
                count += 1
                own = [nodes.setdefault(at(*p), len(nodes) + 1) for p in ((u, v), (w, v), (w, y), (u, y))]
                deck.append(", ".join(map(str, [count, *own])))
        head = ["*NODE", *(f"{number}, {x}, {y}, {z}" for (x, y, z), number in nodes.items())]
        (folder / "own.inp").write_text("\n".join([*head, *deck, ""]))
        parts = {"top": 'thickness = "8 mm"', "apron-1": 'thickness = "6 mm"', "apron-2": 'thickness = "6 mm"'}
        springs = []
        for name, (node, _) in truth().springs.items():
            x, y = (float(f"{1e3 * each:.6g}") for each in truth().points[node][:2])
            k = [*3 * [f'"{LEG:g} N/m"'], *3 * ['"0 N m/rad"']]
            springs += [f"[fe_model.springs.{name}]", f'at = ["{x} mm", "{y} mm", "4 mm"]', f"stiffness = [{', '.join(k)}]", LOST]
        whole = described(
            {name: f"{of('steel')}\n{said}" for name, said in parts.items()}, places, 'file = "own.inp"', 'support = "ground"'
        )
        return whole + "\n".join([*springs, ""])

    return Bench(
        fine=truth,
        described=model,
        places=places,
        responses=tuple(f"{name}:z" for name in places),
        drives=("a:z", "e:z"),
        modes=6,
        faults={
            "mass": ("point-mass", "c", 0.3),
            "softer": ("modulus", "apron-1", -0.2),
            "support": ("support", "leg-2", 0.6),
            "gain": ("gain", "b:z", 0.08),
            "polarity": ("polarity", "f:z", 0.0),
        },
    )


def cantilever() -> Bench:
    """Two rails of four bays with rungs, clamped at the wall, something on its end."""
    nodes = {f"{side}{k}": (300.0 * k, y, 0.0) for k in range(5) for side, y in (("l", 0.0), ("r", 240.0))}
    bars: dict[str, tuple[str, str]] = {}
    for k in range(4):
        bars |= {
            f"left-{k + 1}": (f"l{k}", f"l{k + 1}"),
            f"right-{k + 1}": (f"r{k}", f"r{k + 1}"),
            f"rung-{k + 1}": (f"l{k + 1}", f"r{k + 1}"),
        }
    up, more = (0.0, 0.0, 1.0), {"r4": 0.4}

    @cache
    def truth() -> Fine:
        made = beams(nodes, {name: [(a, b, up, 20.0, 12.0, ALUMINIUM)] for name, (a, b) in bars.items()}, 8)
        names = list(nodes)
        made.masses = {names.index(name): kg for name, kg in more.items()}
        made.held = np.concatenate([6 * names.index(name) + np.arange(6) for name in ("l0", "r0")])
        return made

    def model(folder: Path, places: Places) -> str:
        E, nu, rho = ALUMINIUM
        where = ", ".join(f'{name} = ["{x} mm", "{y} mm", "{z} mm"]' for name, (x, y, z) in nodes.items())
        members = ", ".join(f'{name} = ["{a}", "{b}"]' for name, (a, b) in bars.items())
        lines = ["[fe_model]", 'kind = "frame"', f"nodes = {{ {where} }}", 'fixed = ["l0", "r0"]', f"members = {{ {members} }}"]
        lines += ['section = { width = "20 mm", thickness = "12 mm", across = "z" }', 'masses = { r4 = "400 g" }', "elements = 2"]
        lines += [f'material = {{ density = "{rho:g} kg/m^3", youngs_modulus = "{E / 1e9:g} GPa", poisson_ratio = {nu} }}']
        return "\n".join([*lines, "loss_factor = 0.02", ""])

    return Bench(
        fine=truth,
        described=model,
        places={name: at for name, at in nodes.items() if name[1] != "0"},
        responses=("l1:z", "r1:z", "l2:z", "r2:z", "l3:z", "r3:z", "l4:z", "r4:z", "l4:y", "l2:y"),
        drives=("l4:z", "r2:z"),
        modes=6,
        faults={
            "mass": ("point-mass", "l3", 0.1),
            "softer": ("modulus", "left-1", -0.2),
            "joint": ("joint", "left-1@l0:y", 2e-4),
            "gain": ("gain", "r3:z", 0.08),
            "swap": ("swap", "l2:z r2:z", 0.0),
            "polarity": ("polarity", "l3:z", 0.0),
            "unit": ("unit", "r1:z", 0.0),
            "delay": ("delay", "r3:z", 2e-4),
            "turned": ("turned", "l4:y x", 0.14),
            "beside": ("beside", "l2:z x", 0.0375),
            "moved": ("moved", "l2:z l3", 0.0),
            "direction": ("direction", "l2:y z", 0.0),
        },
    )


def storeys() -> Bench:
    """Two floors on eight legs, on springs to the ground; a mesh of few beams in the model."""
    feet = [(0.0, 0.0), (600.0, 0.0), (600.0, 400.0), (0.0, 400.0)]
    nodes = {f"{level}{k + 1}": (x, y, 450.0 * number) for number, level in enumerate("gmt") for k, (x, y) in enumerate(feet)}
    members: dict[str, list[Member]] = {}
    for number, (low, high) in enumerate((("g", "m"), ("m", "t"))):
        for side, own in (("left", (1, 4)), ("right", (2, 3))):
            members[f"{side}-{number + 1}"] = [(f"{low}{k}", f"{high}{k}", (1.0, 0.0, 0.0), 18.0, 18.0, STEEL) for k in own]
        members[f"floor-{number + 1}"] = [
            (f"{high}{k}", f"{high}{k % 4 + 1}", (0.0, 0.0, 1.0), 30.0, 20.0, STEEL) for k in range(1, 5)
        ]
    springs = np.array([2e6, 2e6, 5e6, 2e4, 2e4, 2e4])

    @cache
    def truth() -> Fine:
        made = beams(nodes, members, 10)
        made.springs = {f"foot-{k + 1}": (k, springs) for k in range(4)}
        return made

    def model(folder: Path, places: Places) -> str:
        numbers, deck, count = {at: k + 1 for k, at in enumerate(nodes.values())}, list[str](), 0
        for part, own in members.items():
            deck.append(f"*ELEMENT, TYPE=B31, ELSET={part}")
            for start, end, *_ in own:
                one, other = np.array(nodes[start]), np.array(nodes[end])
                for s, t in pairwise(np.linspace(0, 1, 5)):
                    count += 1
                    ends = [numbers.setdefault(tuple(one + (other - one) * each), len(numbers) + 1) for each in (s, t)]
                    deck.append(", ".join(map(str, [count, *ends])))
        head = ["*NODE", *(f"{number}, {x}, {y}, {z}" for (x, y, z), number in numbers.items())]
        (folder / "own.inp").write_text("\n".join([*head, *deck, ""]))
        parts = {}
        for part, bars in members.items():
            _, _, up, b, h, _ = bars[0]
            parts[part] = f'{of("steel")}\nsection = {{ width = "{b} mm", height = "{h} mm", z_axis = {list(up)} }}'
        more = []
        for k in range(4):
            x, y, z = nodes[f"g{k + 1}"]
            said = ", ".join([*(f'"{s:g} N/m"' for s in springs[:3]), *(f'"{s:g} N m/rad"' for s in springs[3:])])
            more += [f"[fe_model.springs.foot-{k + 1}]", f'at = ["{x} mm", "{y} mm", "{z} mm"]', f"stiffness = [{said}]", LOST]
        return described(parts, places, 'file = "own.inp"', 'support = "ground"') + "\n".join([*more, ""])

    return Bench(
        fine=truth,
        described=model,
        places={name: at for name, at in nodes.items() if name[0] != "g"},
        responses=("m1:x", "m1:y", "m3:x", "m3:y", "t1:x", "t1:y", "t3:x", "t3:y", "t2:y", "m2:y"),
        drives=("t1:x", "m3:y"),
        modes=6,
        faults={
            "mass": ("point-mass", "t2", 0.4),
            "softer": ("modulus", "left-1", -0.15),
            "support": ("support", "foot-2", 0.4),
            "gain": ("gain", "t3:x", 0.08),
            "polarity": ("polarity", "m1:y", 0.0),
            "unit": ("unit", "t1:x", 0.0),
            "delay": ("delay", "m3:y", 1e-3),
            "turned": ("turned", "t2:y z", 0.14),
            "beside": ("beside", "t3:y x", -0.06),
            "moved": ("moved", "t3:x m3", 0.0),
            "direction": ("direction", "m1:x y", 0.0),
        },
    )


BENCHES: Mapping[str, Callable[[], Bench]] = {
    "plate": plate,
    "bracket": bracket,
    "table-top": table_top,
    "cantilever": cantilever,
    "storeys": storeys,
}
