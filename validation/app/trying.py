"""What if: an effect on the sliders, its curve beside the others at once, and what is known of it in words."""

from __future__ import annotations

import asyncio
import re
from math import log
from typing import Any

import numpy as np

from validation.app import drawing
from validation.app.bench import Bench
from validation.app.keeping import keep
from validation.desk import explaining, sliders, whatif
from validation.desk.explaining import Explained
from validation.desk.sliders import Effect, Slider
from validation.desk.whatif import Table, WhatIf
from validation.diagnosing import figures
from validation.diagnosing.words import listed
from validation.effects.identifiers import parse
from validation.plots.overlay import phase

STEPS = 1000
"""Positions of a slider."""

LONG = re.compile(r"\d+\.\d{4,}(e[+-]?\d+)?")
"""A number with more digits than are read."""

RESTS = 0.4
"""Seconds without a move after which a slider rests."""


async def made_ready(bench: Bench) -> None:
    """Predictions and effects for the model as it stands, beside the page."""
    desk, compared = bench.desk, bench.compared
    if desk is None:
        return
    table = await bench.away(whatif.table, desk)
    effects = await bench.away(sliders.reaching, table)
    if bench.compared is not compared:  # another model meanwhile
        return
    bench.table, bench.effects = table, {one.id: one for one in effects}
    bench.state.effects = [{"title": f"{one.id}: {one.what}", "value": one.id} for one in effects]
    bench.state.flush()
    if bench.wanted is not None:
        await chosen(bench, bench.wanted)


async def chosen(bench: Bench, effect: str | None) -> None:
    """Explain `effect` (an id, or with its size) and draw what it would do; None puts it aside."""
    state = bench.state
    bench.wanted, bench.tried, bench.exact = effect, None, True  # whatever was dragged is at rest now
    if effect is None or bench.desk is None:
        state.effect, bench.sizes = None, {}
        await drawing.drawn(bench)
        keep(bench)
        return
    state.part = "what-if"
    told = await bench.away(explaining.explained, bench.desk, effect)
    known = bench.effects.get(told.id)
    found = {one.key: one.value for one in told.sizes}
    asked = dict(parse(effect).values) if "=" in effect else found
    bench.sizes = {} if known is None else {one.key: asked.get(one.key, one.start) for one in known.sliders}
    state.effect = _words(told) | {"sliders": _sliders(bench, known), "inside": bool(known and known.in_model), "answer": ""}
    state.flush()
    await follow(bench)
    keep(bench)


async def drag(bench: Bench, key: str, at: float) -> None:
    """A slider moves: the curve follows to where it is, and what lies between is left out; at rest every line is computed."""
    slider = _slider(bench, key)
    if slider is None:
        return
    bench.sizes[key] = value(slider, at)
    bench.exact = False
    if bench.dragging is None or bench.dragging.done():
        bench.dragging = bench.begin(_followed(bench))


async def size(bench: Bench, key: str, typed: str) -> None:
    """A number in the field beside the slider, in the unit that is shown there."""
    slider = _slider(bench, key)
    if slider is None:
        return
    try:
        bench.sizes[key] = float(typed) / slider.per_si
    except ValueError:
        bench.state.failure = f"{slider.label}: a number in {slider.shown_unit or 'one'} is expected, found {typed!r}."
        return
    _show_sizes(bench)
    await follow(bench)
    keep(bench)


async def follow(bench: Bench) -> None:
    """Compute the chosen effect at its size, at every line, and draw everything with it."""
    effect, table = _chosen(bench), bench.table
    if effect is None or table is None:
        if bench.state.effect is not None:
            _answer(bench, "" if table is None else "It acts on nothing that was tested here, so no curve would move.")
            await drawing.drawn(bench)  # without the curve of what was tried before
        return
    sizes = dict(bench.sizes)

    def computed() -> WhatIf | None:
        """None where the slider moved on while something else was computed."""
        asked = effect.written(sizes)
        return whatif.what_if(table, asked, bench.state.load, bench.state.motion) if bench.sizes == sizes else None

    found = await bench.at_rest(computed)
    if found is None or bench.sizes != sizes or _stale(bench, effect, table):
        return
    bench.tried = found
    if bench.exact:
        _answer(bench, _said(found, table.at))
    await drawing.drawn(bench)


def value(slider: Slider, at: float) -> float:
    """The size [SI] at the position `at` of a slider."""
    share = min(max(float(at) / STEPS, 0.0), 1.0)
    if slider.whole:
        return slider.high if share >= 0.5 else slider.low
    if slider.logarithmic:
        return float(slider.low * (slider.high / slider.low) ** share)
    return float(slider.low + share * (slider.high - slider.low))


def position(slider: Slider, size: float) -> int:
    """Where on the slider the size [SI] stands."""
    if slider.high <= slider.low:
        return 0
    if slider.logarithmic:
        share = log(max(size, slider.low) / slider.low) / log(slider.high / slider.low)
    else:
        share = (size - slider.low) / (slider.high - slider.low)
    return round(STEPS * min(max(share, 0.0), 1.0))


async def _followed(bench: Bench) -> None:
    """Follow the slider until it rests, whether it was let go (which a keyboard does not tell) or not; then every line."""
    while not bench.exact:
        await _chased(bench)
        rests = dict(bench.sizes)
        await asyncio.sleep(RESTS)
        if rests == bench.sizes and not bench.exact:
            bench.exact = True
            bench.begin(_rested(bench))  # beside this: whoever drags on need not wait for it


async def _rested(bench: Bench) -> None:
    await follow(bench)
    keep(bench)


async def _chased(bench: Bench) -> None:
    """Curves for where the slider is, as fast as they come, until it is where the last one was."""
    done: dict[str, float] | None = None
    state = bench.state
    while not bench.exact and done != bench.sizes and bench.table is not None:
        effect, table = _chosen(bench), bench.table
        if effect is None:  # put aside meanwhile
            return
        done = dict(bench.sizes)
        found = await bench.away(whatif.what_if, table, effect.written(done), state.load, state.motion, exact=False)
        if _stale(bench, effect, table):
            return
        trace = next((one for one in found.traces if one.campaign == state.campaign), None)
        bench.drags += 1
        if trace is not None and bench.tried is not None:
            after = trace.matrix[:, state.load, state.motion]  # of the entry that is shown now, whichever was then
            curves = [np.abs(after), phase(after)]
            state.live = {
                "group": drawing.name_of(bench.tried),
                "x": trace.frequency.tolist(),
                "y": [np.float32(one).astype(float).tolist() for one in curves],
                "number": bench.drags,
            }
        sizes = _sliders(bench, effect)
        state.effect = {**state.effect, "sliders": sizes, "answer": _said(found, table.at)}
        state.flush()  # all at once: each word to the page has it laid out anew


def _chosen(bench: Bench) -> Effect | None:
    """The effect on the sliders; None where there is none, or where it acts on nothing."""
    return None if bench.state.effect is None else bench.effects.get(bench.state.effect["id"])


def _stale(bench: Bench, effect: Effect, table: Table) -> bool:
    """Whether an answer came too late: another effect is chosen meanwhile, or the model is another."""
    return _chosen(bench) is not effect or bench.table is not table


def _said(found: WhatIf, at: str) -> str:
    """What it would do, and whether anything was fitted anew for that: the size itself never is."""
    how = "with what the plain fit frees fitted anew beside it" if found.followed else "with nothing fitted anew"
    goes = f"the plain error goes from {found.before_percent:.3g} to {found.plain_percent:.3g} %"
    told = f"{_rounded(found.written)}: {goes}, {how}"
    if not any(one.reached for one in found.traces):
        told += "; no curve of the dynamic mass moves"
    facts = [f"{name} from {before:.1f} to {after:.1f} σ" for name, (before, after) in found.facts.items() if before != after]
    return told + (f"; {listed(facts)}" if facts else "") + f". Seen from {at}."


def _rounded(written: str) -> str:
    """An effect with its sizes in four digits: a slider has no more."""
    return LONG.sub(lambda found: f"{float(found[0]):.4g}", written)


def _answer(bench: Bench, text: str) -> None:
    bench.state.effect = {**bench.state.effect, "answer": text}
    bench.state.flush()


def _slider(bench: Bench, key: str) -> Slider | None:
    effect = _chosen(bench)
    return None if effect is None else next((one for one in effect.sliders if one.key == key), None)


def _show_sizes(bench: Bench) -> None:
    effect = bench.state.effect
    bench.state.effect = {**effect, "sliders": _sliders(bench, bench.effects.get(effect["id"]))}
    bench.state.flush()


def _sliders(bench: Bench, effect: Effect | None) -> list[dict[str, Any]]:
    if effect is None:
        return []
    return [
        {
            "key": one.key,
            "name": one.key or "alone",
            "label": one.label,
            "unit": one.shown_unit or "1",
            "value": float(f"{bench.sizes[one.key] * one.per_si:.4g}"),
            "at": position(one, bench.sizes[one.key]),
        }
        for one in effect.sliders
    ]


def _words(told: Explained) -> dict[str, Any]:
    """What is known of it, as the page shows it."""
    family = told.id.partition(":")[0]
    found = "; ".join(sized(family, one.key, one.unit, one.value, one.low, one.high) for one in told.sizes)
    return {
        "id": told.id,
        "what": told.what,
        "text": told.text,
        "equation": told.equation,
        "found": found,
        "evidence": "" if told.evidence is None else f"{told.evidence:+.1f}",
        "aliases": list(told.aliases),
        "mistaken": list(told.mistaken_for),
        "separating": list(told.separating),
        "confirmed": told.confirmed_by,
        "note": told.note,
        "reference": told.reference,
    }


def sized(family: str, key: str, unit: str, value: float, low: float, high: float) -> str:
    """ "+7.93 % (+7.69 to +8.17)"."""
    (shown, least, most), scale = figures.written(family, key, unit, (value, low, high))
    text = (f"{key} " if key else "") + figures.with_unit(shown, scale)
    return text if low == high else f"{text} ({least} to {most})"
