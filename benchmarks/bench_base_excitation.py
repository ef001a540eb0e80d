"""What a second of test costs in seconds of computing, by every route in time, and how that grows.

One quick sweep along x of Clumod with one blade, the same for all. The first table sets the routes side by side: the exact
recursion, exudyn on a rigid base and with every kind of joint, and exudyn's own beams on a table that really turns. The others
grow one thing at a time: modes kept, steps a second, joints (struts from blade and mast to the table).
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from benchmarks.ratios import Timing, measure, show
from fem.base_excitation import response, rig
from fem.base_excitation.patterns import BaseMotion, Sweep
from fem.base_excitation.response import Response
from fem.base_excitation.rig import Flange, FlexibleBody, Friction, LoadCell, Rig, Strut
from fem.beam import articles
from fem.damping import Damping
from fem.exudyn import driven_run, large_motion
from fem.modes import fixed_base
from geometry.articles import built_in, locations
from geometry.routes import inertia

ARTICLE, MODES, RATE = "clumod-1", 10, 8192.0
OCTAVES = 90.0
"""A minute; the sweep then lasts two seconds."""

ELEMENTS = 4
"""In a half-blade of exudyn's own beams."""

Call = Callable[[], object]


def article(count: int = MODES) -> FlexibleBody:
    """Clumod with one blade, on beams."""
    structure = articles.structure(ARTICLE)
    modes = fixed_base(structure, count, damping=Damping(ratio=0.003))
    return rig.flexible(ARTICLE, structure, modes, places=locations(ARTICLE))


def driven(rate: float = RATE) -> BaseMotion:
    """The sweep along x."""
    return Sweep(axis="x", rate=OCTAVES).motion(rate, ring_down=0.0)


def rigs(article: FlexibleBody) -> dict[str, Rig]:
    """`article` on a rigid base, and with one kind of joint at a time."""
    fmd = built_in("fmd")
    seat = np.zeros(3) if fmd.seat is None else fmd.seat.position
    corners = [np.array([x, y, 0.0]) for x, y in ((0.13, 0.13), (-0.13, 0.13), (-0.13, -0.13), (0.13, -0.13))]
    cells = tuple(
        LoadCell(position=at, stiffness=k, damping=np.full(3, 2e3)) for at, k in zip(corners, articles.load_cells(), strict=True)
    )
    on_cells = Rig(article=article, cover=inertia(fmd), seat=seat, cells=cells)
    return {
        "rigid base": Rig(article=article),
        "load cells": on_cells,
        "flange": Rig(article=article, flange=Flange(compliance=np.array([0.0, 0.0, 0.0, 1e-6, 1e-6, 0.0]))),
        "cells that lift off": replace(on_cells, cells=tuple(replace(cell, preload=50.0) for cell in cells)),
        "friction": Rig(article=article, frictions=(Friction(axis="x", slip_force=2.0),)),
    }


def with_struts(article: FlexibleBody, count: int) -> Rig:
    """`article` with `count` dampers to the table."""
    names = list(article.places)
    return Rig(
        article=article,
        struts=tuple(Strut(place=names[k % len(names)], to="table", damping=np.full(3, 1.0)) for k in range(count)),
    )


def shown(
    title: str, calls: Mapping[str, Call], seconds: Mapping[str, float], base: str, slow: Mapping[str, Call] | None = None
) -> None:
    """One table: times over that of `base`, and seconds of computing a second of test; what is `slow` is run once."""
    timings: dict[str, Timing] = measure(calls, rounds=3) | measure(slow or {}, rounds=1)
    notes = {name: f"{timing.fastest / seconds[name]:.2g} s/s" for name, timing in timings.items()}
    show(f"{title} (s/s: computing over test)", timings, base=base, notes=notes)


def exudyn(rig: Rig, motion: BaseMotion) -> Call:
    return partial(driven_run.respond, rig, motion)


def routes() -> None:
    """Every route, and every kind of joint."""
    clumod, motion = article(), driven()
    by_joint = rigs(clumod)
    calls: dict[str, Callable[[], Response]] = {
        "recursion": partial(response.respond, by_joint["rigid base"], motion),
        "recursion, load cells": partial(response.respond, by_joint["load cells"], motion),
    }
    calls |= {f"exudyn, {name}": partial(driven_run.respond, rig, motion) for name, rig in by_joint.items()}
    slow = {"exudyn's own beams": partial(large_motion.respond, ARTICLE, motion, elements=ELEMENTS)}
    seconds = dict.fromkeys((*calls, *slow), motion.duration)
    shown(f"Routes: {ARTICLE}, {MODES} modes, {RATE:g} steps a second", calls, seconds, "recursion", slow)


def modes() -> None:
    """More modes."""
    motion = driven()
    calls: dict[str, Call] = {}
    for count in (3, 6, 12, 24):
        rig = Rig(article=article(count))
        calls |= {f"recursion, {count}": partial(response.respond, rig, motion), f"exudyn, {count}": exudyn(rig, motion)}
    shown(f"Modes kept, {RATE:g} steps a second", calls, dict.fromkeys(calls, motion.duration), "recursion, 3")


def rates() -> None:
    """A finer step."""
    rig = Rig(article=article())
    calls: dict[str, Call] = {}
    seconds: dict[str, float] = {}
    for rate in (2048.0, 4096.0, 8192.0, 16384.0):
        motion = driven(rate)
        own: dict[str, Call] = {
            f"recursion, {rate:g}": partial(response.respond, rig, motion),
            f"exudyn, {rate:g}": exudyn(rig, motion),
        }
        calls |= own
        seconds |= dict.fromkeys(own, motion.duration)
    shown(f"Steps a second, {MODES} modes", calls, seconds, "recursion, 2048")


def joints() -> None:
    """More joints."""
    clumod, motion = article(), driven()
    calls: dict[str, Call] = {}
    for count in (0, 1, 2, 4, 8):
        rig = with_struts(clumod, count)
        calls |= {f"recursion, {count}": partial(response.respond, rig, motion), f"exudyn, {count}": exudyn(rig, motion)}
    shown(f"Joints, {MODES} modes, {RATE:g} steps a second", calls, dict.fromkeys(calls, motion.duration), "recursion, 0")


if __name__ == "__main__":
    for table in (routes, modes, rates, joints):
        table()
