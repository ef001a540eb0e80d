"""Overlay and map, drawn as the page stands."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from validation.app.bench import Bench
from validation.app.figures import as_state
from validation.desk.whatif import WhatIf
from validation.plots import maps, overlay

if TYPE_CHECKING:
    from geometry.dynamic_mass import ComplexArray

ROW, TOP, BOTTOM = 9, 16, 40
"""Least height of a row of the map, and room above and below its rows [pixels]."""

TITLE = 8
"""[pixels] less than on a page that the overlay's title takes here."""

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
        state.fig_overlay = await bench.away(lambda: _entitled(look(further=beside), state.load, state.motion))
    else:
        state.fig_overlay = {}
    if state.map_kind == "pairs" and (pairs := of.pairs) is not None:
        state.fig_map = await bench.away(lambda: _low(maps.pair_map(pairs, modes=modes, dark=dark)))
    else:
        number = None if state.run == WORST_OF_ALL else state.run
        state.fig_map = await bench.away(lambda: _low(maps.channel_map(of, number, modes=modes, dark=dark)))
    state.flush()


def _entitled(figure: Any, load: int, motion: int) -> dict[str, Any]:
    """The overlay named by its entry alone: the campaign is said beside it, and the button that enlarges it needs room, too."""
    title = f"{overlay.entry(load, motion)}: {overlay.LOADS[load]} by {overlay.MOTIONS[motion]}"
    figure.update_layout(title_text=title, margin_t=figure.layout.margin.t - TITLE)
    return as_state(figure)


def _low(figure: Any) -> dict[str, Any]:
    """A map without its title, which tabs and choices above it say; its height is the least, the page gives it what there is."""
    rows = len(figure.data[0].y)
    figure.update_layout(title_text="", height=TOP + ROW * rows + BOTTOM, margin_t=TOP, margin_b=BOTTOM)
    figure.update_xaxes(title_standoff=2, title_font_size=12, tickfont_size=11)
    return as_state(figure)


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
