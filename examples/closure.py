"""A model is shaken six times, and Eqs. 10 and 11 make its dynamic mass again: how near do they come to the model's own?

    python examples/closure.py                               Clumod with one blade, quick sweeps, much damping: seconds
    python examples/closure.py clumod-4 2 0.003 16384        the paper's sweeps of Clumod with four blades: many minutes

The article, octaves a minute, damping ratio of all modes, and steps a second. The table moves a few per cent in all other axes
as well. Shares are of the diagonal of the dynamic mass, off the resonances and at them, where an error of the time step is one
of frequency; first of exudyn's integration, then of the exact recursion.
"""

import sys
from collections.abc import Callable, Sequence

import numpy as np
from rich.console import Console
from rich.table import Table

from fem.base_excitation import response, rig
from fem.base_excitation.patterns import BaseMotion, CrossMotion, Sweep, drawn, sweeps
from fem.base_excitation.response import Response
from fem.base_excitation.rig import Rig, dynamic_mass
from fem.beam import articles
from fem.damping import Damping
from fem.dynamic_mass import LINES
from fem.exudyn import driven_run
from fem.modes import Modes, fixed_base
from geometry.dynamic_mass import MOTIONS
from validation.output import counted
from validation.reference.reconstruction import Deviation, deviation, identified

QUICK = ("clumod-1", "120", "0.05", "8192")
MODES, CROSS, LEFT = 10, 0.03, 1e-7
"""Modes kept, the table's cross motion, and the share of the greatest load that may still ring when a record ends."""


def model(article: str, ratio: float) -> tuple[Rig, Modes]:
    """`article` of beams, rigid on the table, with its fixed-base modes."""
    structure = articles.structure(article)
    modes = fixed_base(structure, MODES, damping=Damping(ratio=ratio))
    return Rig(article=rig.flexible(article, structure, modes)), modes


def closed(rig: Rig, modes: Modes, octaves: float, rate: float, respond: Callable[..., Response]) -> Deviation:
    """How far the dynamic mass identified from six sweeps lies from that of `rig`."""
    drives, cross = sweeps(rate=octaves), drawn(np.random.default_rng(1), CROSS)
    axes = counted(drives, f"sweeps at {rate:g} Hz")
    runs = (respond(rig, record(rig, drives[axis], cross, rate)) for axis in axes)
    return deviation(identified(runs, LINES).dynamic_mass, dynamic_mass(rig, LINES), modes.frequency, modes.damping_ratio)


def record(rig: Rig, drive: Sweep, cross: CrossMotion, rate: float) -> BaseMotion:
    """The motion of the table in one run, to the end of the ring-down."""
    length = response.needed(rig, drive.motion(rate, ring_down=0.0, cross=cross), LEFT)
    return drive.motion(rate, ring_down=length - drive.driven, cross=cross)


def main(console: Console, arguments: Sequence[str] = QUICK) -> None:
    article, (octaves, ratio, rate) = arguments[0], map(float, arguments[1:])
    rig, modes = model(article, ratio)
    ways = {"exudyn": driven_run.respond, "recursion": response.respond}
    found = {name: closed(rig, modes, octaves, rate, way) for name, way in ways.items()}
    shown = Table(title=f"{article}: {octaves:g} octaves a minute, damping {ratio:.1%}, {rate:g} steps a second")
    shown.add_column("axis")
    for heading in (f"{way}, {where}" for way in ways for where in ("off resonance", "at resonance")):
        shown.add_column(heading, justify="right")
    for k, axis in enumerate(MOTIONS):
        shares = (share[k] for of in found.values() for share in (of.off, of.at))
        shown.add_row(axis, *(f"{share:.4%}" if share else "-" for share in shares))
    console.print(shown)


if __name__ == "__main__":
    main(Console(), sys.argv[1:] or QUICK)
