"""Overlay and map, drawn as the page stands."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from validation.app.bench import Bench
from validation.app.figures import as_state
from validation.desk.whatif import WhatIf
from validation.plots import maps, overlay

if TYPE_CHECKING:
    from geometry.dynamic_mass import ComplexArray

WORST_OF_ALL = -1
"""In place of a run: the worst of all."""


async def drawn(bench: Bench) -> None:
    """Draw overlay and map anew."""
    if bench.compared is None:
        return
    state, of = bench.state, bench.compared.map(bench.state.campaign)
    modes, dark = bench.compared.modes_of(state.campaign), bool(state.dark)
    if of.pairs is not None:
        look = partial(overlay.overlay, of.pairs, state.load, state.motion, modes=modes, marked=state.marked, dark=dark)
        beside = further(bench)
        state.fig_overlay = await bench.away(lambda: as_state(look(further=beside)))
    else:
        state.fig_overlay = {}
    if state.map_kind == "pairs" and (pairs := of.pairs) is not None:
        state.fig_map = await bench.away(lambda: as_state(maps.pair_map(pairs, modes=modes, dark=dark)))
    else:
        number = None if state.run == WORST_OF_ALL else state.run
        state.fig_map = await bench.away(lambda: as_state(maps.channel_map(of, number, modes=modes, dark=dark)))
    state.flush()


def further(bench: Bench) -> dict[str, ComplexArray]:
    """What the overlay draws beside the prediction: by name, the 6 x 6 with the effect, whichever entry is shown."""
    tried, state = bench.tried, bench.state
    if tried is None:
        return {}
    trace = next((one for one in tried.traces if one.campaign == state.campaign), None)
    return {} if trace is None else {name_of(tried): trace.matrix}


def name_of(tried: WhatIf) -> str:
    """What its curve is called."""
    return f"with {tried.written.partition('=')[0]}"
