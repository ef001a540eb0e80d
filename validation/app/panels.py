"""The page on which one works: brought to what the desk holds, after opening, after a reload, and after every step."""

from __future__ import annotations

import asyncio
import io
import json
import re
import zipfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from functools import partial
from math import log, log2
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from geometry.errors import BadInput, CheckFailed
from validation.app import examples, scene3d, session, whatif, workers
from validation.app import state as app_state
from validation.app.scene3d import MapCell, MapEntry
from validation.app.session import Fault, Handed, Session, faults, of_error
from validation.app.state import WindowState, keep, kept
from validation.app.whatif import EffectExplanation, ReadyPredictions, Slider, TrialEffect, WhatIf
from validation.compare.spots import run as run_in_words
from validation.diagnose.diagnosis import listed as diagnosis_listed
from validation.effects import practical_units
from validation.effects.catalogue import parse
from validation.history.history import Body, HistoryPosition, Version
from validation.report.charts import interactive, maps
from validation.report.charts.history import falling_errors, identified_inertia, way_to
from validation.report.charts.interactive import escaped
from validation.report.charts.maps import phase
from validation.report.charts.spec import ACCEPTED, ALIKE, LESS, TOO_MUCH_LEFT, signed_log
from validation.report.scenes import turntable
from validation.report.scenes.turntable import Turn, Turntable

if TYPE_CHECKING:
    from geometry.dynamic_mass import ComplexArray


# Figures on their way to the page.


def as_state(figure: Any) -> dict[str, Any]:
    """A figure of `validation.report.charts.interactive` as JSON values; arrays stay packed, which plotly.js reads."""
    made: dict[str, Any] = json.loads(figure.to_json(validate=False))
    return made


# Overlay and map, drawn as the page stands.


ROW, TOP, BOTTOM = 9, 16, 40
"""Least height of a row of the map, and room above and below its rows [pixels]."""

TITLE = 8
"""[pixels] less than on a page that the overlay's title takes here."""

WORST_OF_ALL = -1
"""In place of a run: the worst of all."""


async def drawn(bench: WindowState) -> None:
    """Draw overlay and map anew."""
    if bench.compared is None:
        return
    state, of = bench.state, bench.compared.map(bench.state.campaign)
    modes, dark = bench.compared.modes_of(state.campaign), bool(state.dark)
    if of.pairs is not None:
        look = partial(maps.overlay, of.pairs, state.load, state.motion, modes=modes, marked=state.marked, dark=dark)
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
    title = f"{maps.entry(load, motion)}: {maps.LOADS[load]} by {maps.MOTIONS[motion]}"
    figure.update_layout(title_text=title, margin_t=figure.layout.margin.t - TITLE)
    return as_state(figure)


def _low(figure: Any) -> dict[str, Any]:
    """A map without its title, which tabs and choices above it say; its height is the least, the page gives it what there is."""
    rows = len(figure.data[0].y)
    figure.update_layout(title_text="", height=TOP + ROW * rows + BOTTOM, margin_t=TOP, margin_b=BOTTOM)
    figure.update_xaxes(title_standoff=2, title_font_size=12, tickfont_size=11)
    return as_state(figure)


def further(bench: WindowState) -> dict[str, ComplexArray]:
    """What the overlay draws beside the prediction: by name, the 6 x 6 with the effect, whichever entry is shown."""
    tried, state = bench.tried, bench.state
    if tried is None:
        return {}
    trace = next((one for one in tried.traces if one.campaign == state.campaign), None)
    return {} if trace is None else {name_of(tried): trace.matrix}


def name_of(tried: WhatIf) -> str:
    """What its curve is called."""
    return f"with {tried.written.partition('=')[0]}"


# The ladder as the page shows it: rungs with their errors, the fall, and identified inertia on its way.


LOW = 290
"""Least height of a figure [pixels]; the page gives it what there is."""

HEADINGS = {
    "mass and moments about the CoG [%]": "mass and moments<br>about the CoG [%]",
    "products about the CoG [% of √(Θii Θjj)]": "products about the CoG<br>[% of √(Θii Θjj)]",
}
"""Of the inertia, in two lines."""

SHORTER = {
    "plain, fitted data": "plain",
    "plain, held out": "held out",
    "χ² per degree of freedom": "χ² per dof",
    "z² of the tolerances over what is due": "z² over due",
}
"""Names in the legend."""

BESIDE = 4
"""Rungs whose inertia is drawn, the last ones."""


async def rungs_shown(bench: WindowState) -> None:
    """Bring rungs, falling errors and identified inertia to the ladder."""
    if bench.desk is None:
        return
    state, at = bench.state, await bench.away(session.ladder, bench.desk)
    state.rungs = [_rung(one, at) for one in reversed(at.ladder.rungs)]
    state.before = _before(at)
    state.unsaved = app_state.unsaved(bench.desk)
    state.undoable = at.below is not None and at.below.parent is not None
    # What the last step did
    state.step = "" if at.rung is None or not at.rung.verdict else " ".join(at.rung.verdict)
    dark = bool(state.dark)
    fallen = [one for one in at.ladder.rungs if one.errors is not None]
    state.fig_ladder = await bench.away(lambda: _fall(at, dark)) if fallen else None
    # The first article's identified inertia on each rung of the way
    found = {f"{one.number} {one.title}": one.bodies[0] for one in way_to(at) if one.bodies}
    bodies = dict(list(found.items())[-BESIDE:])
    state.fig_inertia = await bench.away(lambda: _inertia(bodies, dark)) if bodies else None


def _fall(at: HistoryPosition, dark: bool) -> dict[str, Any]:
    """With a legend in fewer words: a panel is narrower than a page."""
    figure = falling_errors(at, dark=dark)
    figure.for_each_trace(lambda one: one.update(name=SHORTER.get(one.name, one.name)))
    figure.update_layout(margin={"b": 28, "l": 54})
    figure.update_yaxes(title_font_size=11, tickfont_size=11)
    return _untitled(figure, 60)


def _inertia(bodies: dict[str, Body], dark: bool) -> dict[str, Any]:
    """With its headings in two lines: a panel is narrower than a page."""
    figure = identified_inertia(bodies, dark=dark)
    for heading, lines in HEADINGS.items():
        figure.update_annotations(text=lines, font_size=11, selector={"text": heading})
    return _untitled(figure, 78)


def _untitled(figure: Any, top: int) -> dict[str, Any]:
    """Without its title, which the tab above it says, in a low panel; `top` [pixels] are left for a legend at the upper edge."""
    legend = {"yref": "container", "y": 1.0, "yanchor": "top", "font": {"size": 11}}
    figure.update_layout(title_text="", height=LOW, margin_t=top, legend=legend)
    return as_state(figure)


def _rung(one: Version, at: HistoryPosition) -> dict[str, Any]:
    errors = one.errors
    told = "no figures yet"
    if errors is not None:
        held = "" if errors.held_out is None else f", held out {errors.held_out:.3g} %"
        told = f"plain {errors.plain:.3g} %{held}, χ² {errors.chi2_per_dof:.2f}, tolerances {errors.tolerance_z2:.0f}"
    return {
        "number": one.number,
        "title": one.title,
        "errors": told,
        "plain": None if errors is None else errors.plain,
        "verdict": " ".join(one.verdict),
        "here": at.rung is not None and at.rung.number == one.number,
    }


def _before(at: HistoryPosition) -> dict[str, str]:
    """The errors of the rung below, by the names that a comparison gives them."""
    if at.rung is None or at.rung.parent is None or (errors := at.ladder.rung(at.rung.parent).errors) is None:
        return {}
    found = {
        "nominal error": f"{errors.nominal:.3g} %",
        "plain error": f"{errors.plain:.3g} %",
        "fitted error": f"χ² {errors.chi2_per_dof:.3g}, z² {errors.tolerance_z2:.3g}",
    }
    return found if errors.held_out is None else found | {"held-out error": f"{errors.held_out:.3g} %"}


# The structure in three dimensions: with its sensors, or swinging in the mode nearest the frequency that was clicked.


NEAR = 0.5
"""Octaves between a frequency and a mode that has anything to do with it."""

AT_REST = -1
"""In place of a mode: bodies with their sensors."""


async def structure_shown(bench: WindowState) -> None:
    """Show the campaign's structure as the choice above it says."""
    state, campaign = bench.state, bench.state.campaign
    if bench.desk is None or not campaign:
        return
    at_rest: list[dict[str, object]] = [{"title": "Structure and sensors", "value": AT_REST}]
    if bench.compared is None or bench.state.campaign not in bench.compared.campaigns:
        state.modes = at_rest
    else:
        found = bench.compared.modes_of(bench.state.campaign)
        state.modes = at_rest + [{"title": f"{one.frequency:.2f} Hz, {one.name}", "value": k} for k, one in enumerate(found)]
    if state.mode not in [one["value"] for one in state.modes]:
        state.mode = AT_REST
    state.view_far = _far(bench)
    state.flush()
    try:
        if state.mode == AT_REST:
            await _at_rest(bench, campaign)
        else:
            await _swinging(bench, campaign, state.mode)
    except (BadInput, CheckFailed) as error:
        state.view, state.view_note = "", str(error)
    state.flush()


async def mode(bench: WindowState, number: int) -> None:
    """Show a mode, or the structure at rest."""
    bench.state.mode = int(number)
    await structure_shown(bench)


async def nearest(bench: WindowState) -> None:
    """Show the mode nearest the frequency that is marked, where there is one; how far it is stands below it."""
    state = bench.state
    if bench.compared is None or state.marked is None:
        return
    number = scene3d.nearest(bench.compared, state.campaign, state.marked)
    if number is not None and number != state.mode:
        state.mode = number
        bench.begin(structure_shown(bench))
    state.view_far = _far(bench)


def picture(bench: WindowState, asked: Mapping[str, str]) -> bytes:
    """The picture that the page asks for; to be called in the thread that draws.

    Raises
    ------
    ValueError : a number that is none.
    LookupError : nothing is shown.
    """
    if bench.turntable is None:
        raise LookupError("nothing is shown")
    frames = 8
    share = -1.0 + 2.0 * min(max(int(asked.get("frame", "0")), 0), frames) / frames
    return bench.turntable.jpeg(
        Turn(
            azimuth=float(asked.get("az", "0")),
            elevation=float(asked.get("el", "0")),
            zoom=min(max(float(asked.get("zoom", "1")), 0.2), 20.0),
            size=(int(asked.get("w", "600")), int(asked.get("h", "400"))),
            dark=asked.get("dark") == "1",
            share=share,
        )
    )


async def _at_rest(bench: WindowState, campaign: str) -> None:
    assert bench.desk is not None
    found = await bench.away(scene3d.scene, bench.desk, campaign)
    await _put(
        bench, Turntable(found.bodies, found.sensors), f"{campaign}: structure and sensors", f"{found.title}. {found.note}"
    )


async def _swinging(bench: WindowState, campaign: str, number: int) -> None:
    assert bench.desk is not None
    assert bench.compared is not None
    found = await bench.away(scene3d.shape, bench.desk, bench.compared, campaign, number)
    label = f"{campaign}: {found.name} at {found.frequency:.2f} Hz"
    note = (
        f"{found.name}, {found.frequency:.2f} Hz, damping ratio {found.damping_ratio:.3g}; base held, size of the swing as drawn."
    )
    await _put(bench, Turntable(found.bodies, scale=found.scale), label, note)


def apart(marked: float, found: float) -> str:
    """What is said of a mode at the frequency `found` when another is marked; nothing where they are neighbours."""
    if found <= 0.0 or abs(log2(found / marked)) < NEAR:
        return ""
    return f"No mode is near {marked:.4g} Hz: this one is at {found:.4g} Hz, and what is seen there is no resonance of the model."


def _far(bench: WindowState) -> str:
    """What is said of the mode that is shown, and of the frequency that is marked."""
    state = bench.state
    modes = () if bench.compared is None else bench.compared.modes_of(state.campaign)
    if state.marked is None or not 0 <= state.mode < len(modes):
        return ""
    return apart(float(state.marked), modes[state.mode].frequency)


async def _put(bench: WindowState, table: Turntable, label: str, note: str) -> None:
    before, bench.turntable = bench.turntable, table
    if before is not None:
        await bench.drawn(before.close)
    bench.views += 1
    bench.state.update({"view": str(bench.views), "view_label": label, "view_note": note})


# Measured beside predicted: the entry that is shown, the map of residuals, and where a click on it leads.


TINTS = (4.0, 6.0, 20.0)
"""[σ] at which an entry of the picker takes its next tint: below the first it may be chance."""

TONES = {"good": "good", "doubtful": "doubt", "failed": "bad"}


async def comparing_shown(bench: WindowState) -> None:
    """Bring errors, worst spots, picker, overlay and map to the comparison."""
    state, compared = bench.state, bench.compared
    if compared is None:
        state.errors, state.worst, state.remarks = [], [], []
        return
    state.errors = [{**one, "tone": _tone(one["verdict"])} for one in compared.errors]
    state.worst = [{"sigma": f"{one['sigma']:.1f}", "text": one["text"]} for one in compared.summary["worst"]]
    state.remarks = list(compared.summary["warnings"])
    state.campaigns = list(compared.campaigns)
    fresh = state.campaign not in compared.campaigns
    if fresh:
        state.campaign = compared.campaigns[0]
    _of_campaign(bench)
    if fresh and compared.summary["worst"]:
        _go(bench, _entry_of_spot(bench, 0))
    await drawn(bench)


async def redrawn(bench: WindowState) -> None:
    """Draw every figure anew, in other colours."""
    await drawn(bench)
    await rungs_shown(bench)


async def entry(bench: WindowState, load: int, motion: int) -> None:
    """Show another entry, where it was looked at."""
    bench.state.load, bench.state.motion = int(load), int(motion)
    await drawn(bench)


async def marked(bench: WindowState, frequency: float) -> None:
    """A click on the overlay: that frequency, and the mode nearest it."""
    bench.state.marked = float(frequency)
    await nearest(bench)
    await drawn(bench)


async def cell(bench: WindowState, picked: dict[str, Any]) -> None:
    """A click on the map: the overlay jumps there, to the worst of the lines that share the cell."""
    if bench.compared is None or len(picked["custom"]) != 2:  # the triangle of a mode
        return
    of, row, frequency = bench.compared.map(bench.state.campaign), str(picked["y"]), float(picked["custom"][1])
    if row in maps.PAIRS and bench.state.map_kind == "pairs":
        load, motion = divmod(maps.PAIRS.index(row), 6)
        _go(bench, MapEntry(campaign=of.data_set, load=load, motion=motion, frequency=frequency))
    else:
        labels = [escaped(name) for name in maps.labels(of)]
        if row not in labels:
            return
        number = labels.index(row)
        if bench.state.run != WORST_OF_ALL:
            run = bench.state.run
        else:
            line = int(np.argmin(np.abs(of.frequency - frequency)))
            known = np.isfinite(of.expected[:, line, number]) & np.isfinite(of.sigma[:, line, number])
            run = int(np.argmax(np.where(known, of.sigma[:, line, number], -np.inf)))
        found = MapCell(campaign=of.data_set, run=of.runs[run], row=of.rows[number], frequency=frequency)
        _go(bench, scene3d.entry_of(bench.compared, found))
    await _went(bench)


async def spot(bench: WindowState, number: int) -> None:
    """A worst spot of the list, the same way."""
    _go(bench, _entry_of_spot(bench, int(number)))
    await _went(bench)


async def campaign(bench: WindowState, name: str) -> None:
    """Show another campaign."""
    bench.state.campaign = name
    _of_campaign(bench)
    await drawn(bench)
    await structure_shown(bench)


async def show_map(bench: WindowState, kind: str) -> None:
    """Channels and loads, or pairs of axes."""
    bench.state.map_kind = kind
    await drawn(bench)


async def show_run(bench: WindowState, number: int) -> None:
    """One run on the map, or the worst of all."""
    bench.state.run = int(number)
    await drawn(bench)


async def _went(bench: WindowState) -> None:
    await nearest(bench)
    await drawn(bench)


def _of_campaign(bench: WindowState) -> None:
    """What the picker and the choice of runs say of the campaign that is shown."""
    state = bench.state
    of = bench.compared.map(state.campaign)  # type: ignore[union-attr]
    state.runs = [{"title": "the worst of all runs", "value": WORST_OF_ALL}] + [
        {"title": run_in_words(name, axis), "value": k} for k, (name, axis) in enumerate(zip(of.runs, of.axes, strict=True))
    ]
    if state.run not in range(WORST_OF_ALL, len(of.runs)):
        state.run = WORST_OF_ALL
    peaks = np.full((6, 6), np.nan) if of.pairs is None else np.nanmax(of.pairs.sigma, axis=0)
    state.peaks = [["–" if np.isnan(peak) else _short(float(peak)) for peak in row] for row in peaks]
    state.tints = [[int(np.searchsorted(TINTS, 0 if np.isnan(peak) else peak, side="right")) for peak in row] for row in peaks]


def _entry_of_spot(bench: WindowState, number: int) -> MapEntry:
    compared = bench.compared
    one = compared.summary["worst"][number]  # type: ignore[union-attr]
    found = MapCell(campaign=one["campaign"], run=one["run"], row=one["channel"], frequency=float(one["frequency_hz"]))
    return scene3d.entry_of(compared, found)  # type: ignore[arg-type]


def _go(bench: WindowState, to: MapEntry) -> None:
    state = bench.state
    if state.campaign != to.campaign:
        state.campaign = to.campaign
        _of_campaign(bench)
    state.load, state.motion, state.marked = to.load, to.motion, to.frequency


def _short(sigma: float) -> str:
    return f"{sigma:.1f}" if sigma < 9.95 else f"{min(sigma, 9999):.0f}"


def _tone(verdict: str | None) -> str:
    return next((tone for word, tone in TONES.items() if verdict and word in verdict.lower()), "")


# What if: an effect on the sliders, its curve beside the others at once, and what is known of it in words.


STEPS = 1000
"""Positions of a slider."""

LONG = re.compile(r"\d+\.\d{4,}(e[+-]?\d+)?")
"""A number with more digits than are read."""

RESTS = 0.4
"""Seconds without a move after which a slider rests."""


async def made_ready(bench: WindowState) -> None:
    """Predictions and effects for the model as it stands, beside the page."""
    desk, compared = bench.desk, bench.compared
    if desk is None:
        return
    table = await bench.away(whatif.table, desk)
    effects = await bench.away(whatif.reaching, table)
    if bench.compared is not compared:  # another model meanwhile
        return
    bench.table, bench.effects = table, {one.id: one for one in effects}
    bench.state.effects = [{"title": f"{one.id}: {one.what}", "value": one.id} for one in effects]
    bench.state.flush()
    if bench.wanted is not None:
        await chosen(bench, bench.wanted)


async def chosen(bench: WindowState, effect: str | None) -> None:
    """Explain `effect` (an id, or with its size) and draw what it would do; None puts it aside."""
    state = bench.state
    bench.wanted, bench.tried, bench.exact = effect, None, True  # whatever was dragged is at rest now
    if effect is None or bench.desk is None:
        state.effect, bench.sizes = None, {}
        await drawn(bench)
        keep(bench)
        return
    state.part = "what-if"
    told = await bench.away(whatif.explained, bench.desk, effect)
    known = bench.effects.get(told.id)
    found = {one.key: one.value for one in told.sizes}
    asked = dict(parse(effect).values) if "=" in effect else found
    bench.sizes = {} if known is None else {one.key: asked.get(one.key, one.start) for one in known.sliders}
    state.effect = _words(told) | {"sliders": _sliders(bench, known), "inside": bool(known and known.in_model), "answer": ""}
    state.flush()
    await follow(bench)
    keep(bench)


async def drag(bench: WindowState, key: str, at: float) -> None:
    """A slider moves: the curve follows to where it is, and what lies between is left out; at rest every line is computed."""
    slider = _slider(bench, key)
    if slider is None:
        return
    bench.sizes[key] = value(slider, at)
    bench.exact = False
    if bench.dragging is None or bench.dragging.done():
        bench.dragging = bench.begin(_followed(bench))


async def size(bench: WindowState, key: str, typed: str) -> None:
    """A number in the field beside the slider, in the unit that is shown there."""
    slider = _slider(bench, key)
    if slider is None:
        return
    try:
        bench.sizes[key] = float(typed) / slider.per_si
    except ValueError:
        bench.state.failure = f"{slider.label}: a number in {slider.shown_unit or 'one'} is expected, found {typed!r}."
        return
    effect = bench.state.effect
    bench.state.effect = {**effect, "sliders": _sliders(bench, bench.effects.get(effect["id"]))}
    bench.state.flush()
    await follow(bench)
    keep(bench)


async def follow(bench: WindowState) -> None:
    """Compute the chosen effect at its size, at every line, and draw everything with it."""
    effect, table = _chosen(bench), bench.table
    if effect is None or table is None:
        if bench.state.effect is not None:
            _answer(bench, "" if table is None else "It acts on nothing that was tested here, so no curve would move.")
            await drawn(bench)  # without the curve of what was tried before
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
    await drawn(bench)


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


async def _followed(bench: WindowState) -> None:
    """Follow the slider until it rests, whether it was let go (which a keyboard does not tell) or not; then every line."""
    while not bench.exact:
        await _chased(bench)
        rests = dict(bench.sizes)
        await asyncio.sleep(RESTS)
        if rests == bench.sizes and not bench.exact:
            bench.exact = True
            bench.begin(_rested(bench))  # beside this: whoever drags on need not wait for it


async def _rested(bench: WindowState) -> None:
    await follow(bench)
    keep(bench)


async def _chased(bench: WindowState) -> None:
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
                "group": name_of(bench.tried),
                "x": trace.frequency.tolist(),
                "y": [np.float32(one).astype(float).tolist() for one in curves],
                "number": bench.drags,
            }
        sizes = _sliders(bench, effect)
        state.effect = {**state.effect, "sliders": sizes, "answer": _said(found, table.at)}
        state.flush()  # all at once: each word to the page has it laid out anew


def _chosen(bench: WindowState) -> TrialEffect | None:
    """The effect on the sliders; None where there is none, or where it acts on nothing."""
    return None if bench.state.effect is None else bench.effects.get(bench.state.effect["id"])


def _stale(bench: WindowState, effect: TrialEffect, table: ReadyPredictions) -> bool:
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
    return told + (f"; {diagnosis_listed(facts)}" if facts else "") + f". Seen from {at}."


def _rounded(written: str) -> str:
    """An effect with its sizes in four digits: a slider has no more."""
    return LONG.sub(lambda found: f"{float(found[0]):.4g}", written)


def _answer(bench: WindowState, text: str) -> None:
    bench.state.effect = {**bench.state.effect, "answer": text}
    bench.state.flush()


def _slider(bench: WindowState, key: str) -> Slider | None:
    effect = _chosen(bench)
    return None if effect is None else next((one for one in effect.sliders if one.key == key), None)


def _sliders(bench: WindowState, effect: TrialEffect | None) -> list[dict[str, Any]]:
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


def _words(told: EffectExplanation) -> dict[str, Any]:
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
    (shown, least, most), scale = practical_units.written(family, key, unit, (value, low, high))
    text = (f"{key} " if key else "") + practical_units.with_unit(shown, scale)
    return text if low == high else f"{text} ({least} to {most})"


# What is missing, as the page tells it: the verdict, and causes as bars of evidence with the intervals of their sizes.


SHOWN = 12
"""Causes in the list."""


async def diagnosing_shown(bench: WindowState) -> None:
    """Bring verdict and ranking to the diagnosis of the model as it stands, where it was made."""
    found = None if bench.desk is None else await bench.away(session.diagnosing_diagnosis, bench.desk)
    state = bench.state
    if found is None:
        state.verdict, state.ranking = None, []
        return
    state.verdict = {
        "headline": found["headline"],
        "text": found["text"],
        "next": found["next_measurement"] or "",
        "leftover": found["leftover"] or "",
        "detectable": [
            {"id": one["id"], "size": practical_units.one(one["id"].partition(":")[0], "", one["unit"], one["size"])}
            for one in found["detectable"]
            if one["size"] is not None
        ],
    }
    # What was accepted, then what was ranked last, then what earlier steps had ranked; each once, with the step it is from
    accepted = {one["id"] for one in found["accepted"]}
    first: dict[str, Mapping[str, Any]] = {}
    step_of: dict[str, int] = {}
    for one in (*found["accepted"], *found["ranking"]):
        first.setdefault(one["id"], one)
    for number, step in enumerate(found["steps"], start=1):
        for one in step["ranking"]:
            if one["id"] not in first:
                first[one["id"]], step_of[one["id"]] = one, number
    order = list(first.values())[:SHOWN]
    nats = np.array([one["evidence_nats"] if one["evidence_nats"] is not None else np.inf for one in order], dtype=float)
    finite = signed_log(np.minimum(nats, 1e9))
    most = max(float(finite.max(initial=0.0)), 1e-9)
    causes = [_cause(one, found, accepted, 100 * max(at, 0.0) / most) for one, at in zip(order, finite, strict=True)]
    state.ranking = [one | {"step": step_of.get(one["id"])} for one in causes]


def _cause(one: Mapping[str, Any], found: Mapping[str, Any], accepted: set[str], share: float) -> dict[str, Any]:
    family, nats = one["id"].partition(":")[0], one["evidence_nats"]
    sizes = [sized(family, each["key"], each["unit"], each["value"], *each["interval90"]) for each in one["values"]]
    alike = one["id"] in found["equivalence_class"] and len(found["equivalence_class"]) > 1
    if one["id"] in accepted:
        standing, tone = (
            (ACCEPTED + (", as one of several that the data cannot tell apart" if alike else "")),
            "doubt" if alike else "good",
        )
    else:
        if alike:
            standing, tone = ALIKE, "doubt"
        else:
            standing, tone = (LESS, "faint") if one["as_where_nothing_is_missing"] else (TOO_MUCH_LEFT, "bad")
    # Where the 90 % interval of its first size lies on a line that holds no effect, too: in per cent, and in words
    if not one["values"]:
        interval: dict[str, Any] | None = None
    else:
        low, high = one["values"][0]["interval90"]
        if low == high:
            interval = None
        else:
            left, right = min(low, 0.0), max(high, 0.0)
            room = 0.06 * (right - left)
            left, width = left - room, right - left + 2 * room
            interval = {
                "left": round(100 * (low - left) / width, 2),
                "width": round(100 * (high - low) / width, 2),
                "zero": round(100 * (0.0 - left) / width, 2),
                "words": "holds 0" if low <= 0.0 <= high else "clear of 0",
            }
    return {
        "id": one["id"],
        "written": one["written"],
        "standing": standing,
        "tone": tone,
        "size": "; ".join(sizes),
        "nats": "more than can be counted" if nats is None else f"{nats:+.1f}",
        "share": round(share, 1),
        "interval": interval,
    }


async def shown(bench: WindowState) -> None:
    """Show the desk as it is; a comparison that was never made begins."""
    state, desk = bench.state, bench.desk
    if desk is None:
        return
    workers.recovered(desk)
    bench.wanted = kept(bench)
    state.title, state.screen, state.failure, state.ready = _title(bench), "work", "", None
    state.faults = {"model": [], "data": [], "options": []}
    state.flush()
    await stands(bench)
    if bench.compared is None:
        app_state.start(bench, workers.COMPARE, stands)


async def stands(bench: WindowState) -> None:
    """Everything that follows from the model as it stands now."""
    if bench.desk is None:
        return
    bench.compared = await bench.away(session.comparing_comparison, bench.desk)
    bench.table, bench.effects, bench.tried = None, {}, None  # all of the model that stood there before
    bench.state.compared = bench.compared is not None
    await comparing_shown(bench)
    await rungs_shown(bench)
    await diagnosing_shown(bench)
    bench.state.flush()
    bench.begin(structure_shown(bench))
    if bench.compared is not None:
        bench.begin(made_ready(bench))


def _title(bench: WindowState) -> str:
    desk: Any = bench.desk
    asked = desk.asked
    data = ", ".join(path.rsplit("/", 1)[-1] for path in asked.data)
    return f"{desk.title or asked.model.rsplit('/', 1)[-1]}: {data}"


# Up and down the ladder, from the page.


async def add(bench: WindowState) -> None:
    """Add the chosen effect; its fit begins at the size of the sliders."""
    effect = None if bench.state.effect is None else bench.effects.get(bench.state.effect["id"])
    if effect is None:
        return
    app_state.start(bench, workers.ADD, _added, stands, effect=effect.written(bench.sizes))


async def undo(bench: WindowState) -> None:
    """One rung down."""
    if bench.desk is not None and bench.worker is None:
        await bench.away(session.undone, bench.desk)
        await stands(bench)


async def go(bench: WindowState, number: int) -> None:
    """To any rung."""
    if bench.desk is not None and bench.worker is None:
        await bench.away(session.gone_to, bench.desk, int(number))
        await stands(bench)
        if bench.compared is None:
            app_state.start(bench, workers.COMPARE, stands)


async def _added(bench: WindowState) -> None:
    bench.wanted, bench.tried, bench.state.effect = None, None, None
    bench.state.tab, bench.state.part = "ladder", "fails"
    await stands(bench)
    keep(bench)


# Opening: an example, files that were dropped, or paths; and what is wrong with them, beside the field that has it.


WARMS_AFTER = 3.0
"""Seconds in which a page is there and nobody has asked for a figure yet."""

CURRENT = "current"
"""The file that names the desk in use."""


def listed() -> list[dict[str, str]]:
    """The examples, as the page shows them."""
    return [{"name": one.name, "title": one.title, "words": one.words} for one in examples.examples()]


async def first(bench: WindowState) -> None:
    """What a window begins with: the desk that it had, or what the command line named."""
    bench.begin(_warmed(bench))
    current = bench.folder / CURRENT
    if current.is_file():
        bench.desk = await bench.away(session.opened, bench.folder / current.read_text(encoding="utf-8"))
        await shown(bench)
    elif bench.opened.example is not None:
        await example(bench, bench.opened.example)
    elif bench.opened.model is not None:
        one = bench.opened
        _begin(bench, one.model or "", one.data, one.hold_out, one.band, one.method, one.effects_from)
        await shown(bench)


async def _warmed(bench: WindowState) -> None:
    """Have the libraries of figures and pictures there before the first one is waited for; the page itself comes first."""
    await asyncio.sleep(WARMS_AFTER)
    await asyncio.to_thread(interactive.template, False)
    await bench.drawn(turntable.ready)


async def example(bench: WindowState, name: str) -> None:
    """Open the example `name`, simulated first where it was never used here."""
    if _busy(bench):
        return
    bench.state.opening = True
    tell = app_state.teller(bench, f"The example {name} is made ready")
    try:
        series = await bench.aside(examples.series, name, tell)
    finally:
        bench.state.opening, bench.state.job = False, None
    _begin(bench, series.model, series.data, series.hold_out, series.band, title=series.title)
    await shown(bench)


async def paths(bench: WindowState) -> None:
    """Open what the fields name; faults stay beside them, and nothing is opened where one is grave."""
    if not _busy(bench):
        await _opened(bench, ())


async def _opened(bench: WindowState, refused: Sequence[Fault]) -> None:
    """The same, with what was refused on the way, and leaves the rest usable."""
    state = bench.state
    model, data = str(state.model_path or "").strip(), _lines(state.data_paths)
    try:
        model, data = await bench.away(_looked_into, model, data)
        text = str(state.band or "")
        words = text.replace(",", " ").replace("to", " ").replace("-", " ").split()
        if not words:
            band: tuple[float, float] | None = None
        else:
            try:
                low, high = (float(word) for word in words)
            except ValueError:
                problem = f"two frequencies [Hz] are expected, found {text!r}"
                raise BadInput(source="--band", problem=problem, remedy="Write for example 4 32") from None
            band = low, high
        hold_out = tuple(name.strip() for name in str(state.hold_out or "").split(",") if name.strip())
    except BadInput as error:
        _tell(bench, [*refused, of_error(error)], model)
        return
    state.model_path, state.data_paths = model, "\n".join(data)
    state.opening = True
    state.flush()
    try:
        found = await bench.away(faults, model, data, effects_from=bench.opened.effects_from)
    finally:
        state.opening = False
    _tell(bench, [*refused, *found], model)
    if any(one.grave for one in found):
        return
    _begin(bench, model, data, hold_out, band, effects_from=bench.opened.effects_from)
    await shown(bench)


async def arrived(bench: WindowState, files: Sequence[Handed]) -> None:
    """Take over what a browser handed in, name it in the fields, and open it if nothing is wrong with it."""
    if _busy(bench):
        bench.state.failure = "Something is being read or computed. Hand the files over when that is done."
        return
    # What was dropped since a desk was begun, each time into a folder of its own: a file that was mended has the same name
    before = sorted(bench.folder.glob(f"drop-{_number(bench)}-*"))
    folder = bench.folder / f"drop-{_number(bench)}-{len(before)}"
    room = session.LARGEST - sum(path.stat().st_size for one in before for path in one.rglob("*") if path.is_file())
    received = await bench.away(session.received, folder, files, limit=max(room, 0))
    state = bench.state
    # `received.data` with what was dropped before and is not replaced by it: campaigns may come one after the other
    named = {Path(one).name for one in received.data}
    ours = f"{bench.folder / f'drop-{_number(bench)}-'}"
    earlier = [one for one in _lines(bench.state.data_paths) if one.startswith(ours) and Path(one).name not in named]
    models, data = list(received.models), [*earlier, *received.data]
    if models:
        state.models, state.model_path = models, models[0]
    if data:
        state.data_paths = "\n".join(data)
    grave = any(one.grave for one in received.faults)
    if grave or not (state.model_path and state.data_paths):
        lacking = [] if grave else [_lacking(bool(state.model_path))]
        _tell(bench, [*received.faults, *lacking], str(state.model_path or ""))
        return
    await _opened(bench, received.faults)


def _busy(bench: WindowState) -> bool:
    """Whether a desk could not be changed for another now."""
    return bool(bench.state.opening) or bench.worker is not None or bench.state.job is not None


def another(bench: WindowState) -> None:
    """Back to the page on which things are opened; the desk in use stays as it is."""
    bench.state.screen = "open" if bench.state.screen == "work" else "work"


def _begin(
    bench: WindowState,
    model: str,
    data: Sequence[str],
    hold_out: Sequence[str] = (),
    band: tuple[float, float] | None = None,
    method: str = "full-record",
    effects_from: Sequence[str] = (),
    title: str = "",
) -> None:
    # A folder for the next desk
    folder = bench.folder / f"desk-{_number(bench)}"
    folder.mkdir(exist_ok=True)
    bench.desk = session.begun(
        folder, model, data, hold_out=hold_out, band=band, method=method, effects_from=effects_from, title=title
    )
    app_state.saved(bench.desk)
    (bench.folder / CURRENT).write_text(folder.name, encoding="utf-8")


def _number(bench: WindowState) -> int:
    """Of the next desk."""
    return sum(1 for one in bench.folder.glob("desk-*") if session.is_desk(one))


def _looked_into(model: str, data: tuple[str, ...]) -> tuple[str, tuple[str, ...]]:
    """A folder in the field of the model stands for the model and the data in it."""
    if model and Path(model).is_dir():
        found = session.sorted_out(model)
        return (found.models[0] if found.models else model), data or found.data
    return model, data


def _tell(bench: WindowState, found: Iterable[Fault], model: str) -> None:
    """Faults beside the fields that have them."""
    beside: dict[str, list[dict[str, Any]]] = {"model": [], "data": [], "options": []}
    for one in found:
        place = "options" if one.file.startswith("--") else "model" if one.file in (model, "model", "MODEL", "") else "data"
        beside[place].append(asdict(one))
    bench.state.faults = beside


def _lacking(model: bool) -> Fault:
    """What was not among the files."""
    if model:
        return Fault(file="", field="", problem="no campaign folder is among the files", remedy="Drop the campaign's folder, too")
    problem = "no model file is among the files"
    return Fault(file="", field="", problem=problem, remedy="`massline model ARTICLE` writes one to start from; drop it, too")


def _lines(text: str | None) -> tuple[str, ...]:
    return tuple(line.strip() for line in (text or "").splitlines() if line.strip())


# What leaves the page: model, ladder, figures and report, as downloads.


REPORT, FIGURES = "report.html", "figures.zip"

SAVING_BESIDE = {"ladder.json": "model.ladder.json"}
"""What is saved under another name than it is asked for: a ladder is found by that of its model."""

TYPES = {".toml": "application/toml", ".json": "application/json", ".html": "text/html", ".zip": "application/zip"}


async def report(bench: WindowState) -> None:
    """Let a worker write the report."""
    if bench.desk is not None:
        app_state.start(bench, workers.REPORT, _reported, to=str(_kept(bench.desk) / REPORT))


async def figures(bench: WindowState) -> None:
    """Draw the pictures of comparison and ladder."""
    desk = bench.desk
    if desk is None:
        return
    tell = app_state.teller(bench, "Drawing the figures")
    try:
        folder = _kept(desk) / "figures"
        folder.mkdir(parents=True, exist_ok=True)
        paths = await bench.aside(session.figures, desk, folder, tell)
        (_kept(desk) / FIGURES).write_bytes(await bench.aside(_zipped, paths))
    finally:
        bench.state.job = None
    _ready(bench, "The figures are ready:", FIGURES)


def content(bench: WindowState, name: str) -> tuple[bytes, str]:
    """What is downloaded under `name`, and its type.

    Raises
    ------
    LookupError : there is nothing of that name.
    BadInput : there is no ladder yet.
    """
    desk = bench.desk
    if desk is None:
        raise LookupError(name)
    kept = {REPORT: _kept(desk) / REPORT, FIGURES: _kept(desk) / FIGURES}
    if name == "model.toml":
        body = session.model_text(desk).encode()
        app_state.saved(desk)
        bench.state.unsaved = False
        bench.state.flush()
    elif name == "ladder.json":
        body = session.ladder_text(desk).encode()
    elif name in kept and kept[name].is_file():
        body = kept[name].read_bytes()
    else:
        raise LookupError(name)
    return body, TYPES[Path(name).suffix]


async def _reported(bench: WindowState) -> None:
    _ready(bench, "The report is ready:", REPORT)


def _ready(bench: WindowState, text: str, name: str) -> None:
    bench.state.ready = {"text": text, "links": [{"href": f"save/{name}", "name": name}]}


def _kept(desk: Session) -> Path:
    folder = desk.folder / "saved"
    folder.mkdir(exist_ok=True)
    return folder


def _zipped(paths: tuple[Path, ...]) -> bytes:
    if not paths:
        raise BadInput(source="figures", problem="there is nothing to draw yet", remedy="Compare first")
    kept = io.BytesIO()
    with zipfile.ZipFile(kept, "w") as archive:
        for path in paths:
            archive.write(path, path.name)
    return kept.getvalue()
