"""Curves, map of residuals and shapes of modes as the page stands, and an effect on the sliders that moves them."""

import asyncio
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite, log
from typing import TYPE_CHECKING, Any

import numpy as np

from validation.app import whatif
from validation.app.session import Session
from validation.app.state import WindowState, keep
from validation.app.whatif import ReadyPredictions, Slider, TrialEffect, WhatIf
from validation.compare.maps import Pairs
from validation.diagnose.diagnosis import listed, sized
from validation.effects import effect as effect_types
from validation.effects.catalogue import FAMILIES, parse
from validation.history.add import completed
from validation.output import nats
from validation.report.charts import functions, maps
from validation.report.charts.figure import Figure

if TYPE_CHECKING:
    from geometry.dynamic_mass import ComplexArray


def as_state(figure: Figure) -> dict[str, Any]:
    """A figure as JSON values; arrays stay packed, which plotly.js reads."""
    made: dict[str, Any] = json.loads(figure.json(template=True))
    return made


ROWS, TOP, BOTTOM = 218, 28, 34
"""Least height of all rows of the map, and room above them, for the buttons, and below them [pixels]."""

WORST_OF_ALL = -1
"""In place of a run: the worst of all."""

MASS, FUNCTIONS, TABLE = "mass", "functions", "table"
"""What a data set is: runs that tell a dynamic mass, response functions, a table of modes."""

CURVES, MAC = "curves", "mac"
"""What stands above: curves over frequency, or modes beside modes."""


async def drawn(window: WindowState) -> None:
    """Draw overlay and map anew."""
    if window.compared is None:
        return
    state, of = window.state, window.compared.map(window.state.campaign)
    modes, dark, further = window.compared.modes_of(state.campaign), bool(state.dark), with_effect(window)
    load, motion, marked, number = state.load, state.motion, state.marked, state.run
    run, channel, how = state.drive, state.response, switches(window)

    def overlay() -> dict[str, Any]:
        """Without a title: what it is of is said above it."""
        coherence = None
        if of.pairs is not None:
            panel = maps.entry_of(of.pairs, load, motion, modes, further)
        else:
            panel = maps.function_of(of, run, channel, further)
            if of.functions is not None and of.functions.coherence is not None:
                coherence = of.functions.coherence[run, :, channel]
        drawn_curves = functions.DrawnCurves(
            panel=panel,
            units=units(window),
            switches=how,
            coherence=coherence,
            modes=modes,
            marked=marked,
            title=f"{of.data_set} {state.curve}",
        )
        return as_state(drawn_curves.figure(dark))

    def residuals(pairs: Pairs | None) -> dict[str, Any]:
        """Without its title, which tabs and choices above it say; its height is the least, the page gives it what there is."""
        if pairs is not None:
            figure = maps.pair_map(pairs, modes=modes, dark=dark)
        else:
            figure = maps.channel_map(of, None if number == WORST_OF_ALL else number, modes=modes, dark=dark)
        figure.update(title={"text": ""}, height=TOP + ROWS + BOTTOM, margin={"t": TOP, "b": BOTTOM})
        figure.across(title={"standoff": 2, "font": {"size": 12}}, tickfont={"size": 11})
        return as_state(figure)

    if of.pairs is not None:
        state.curve = f"{maps.entry(load, motion)}: {maps.LOADS[load]} by {maps.MOTIONS[motion]}"
    elif of.functions is not None:
        state.curve = f"{of.rows[channel]} by a force at {of.runs[run]}"
    else:
        state.curve = ""
    state.fig_overlay = await window.away(overlay) if state.curve else {}
    await correlation_drawn(window)
    state.fig_map = await window.away(residuals, of.pairs if state.map_kind == "pairs" else None)
    state.flush()


def with_effect(window: WindowState) -> "dict[str, ComplexArray]":
    """What the overlay draws beside the prediction: by name, all that is read with the effect, whichever entry is shown."""
    tried, state = window.tried, window.state
    if tried is None:
        return {}
    trace = next((one for one in tried.traces if one.campaign == state.campaign), None)
    if trace is None:
        return {}
    return {name_of(tried): trace.matrix.swapaxes(0, 1) if state.kind == FUNCTIONS else trace.matrix}


def switches(window: WindowState) -> functions.Switches:
    """How curves are shown."""
    return functions.Switches(**{one: window.state[one] for one in SWITCHES})


def units(window: WindowState) -> tuple[str, str]:
    """SI, of what is divided and of what it is divided by, of the curve that is shown."""
    state = window.state
    if state.kind == FUNCTIONS and window.compared is not None:
        whole = window.compared.map(state.campaign).functions
        return ("" if whole is None else whole.unit.removesuffix("/N").replace("^2", "²")), "N"
    return ("N", "N m")[state.load >= 3], ("m/s²", "rad/s²")[state.motion >= 3]


SWITCHES = ("form", "lower", "logarithmic", "unwrapped", "units")
"""State of the page that `functions.Switches` is made of."""

CHOICES: Mapping[str, tuple[Any, ...]] = {
    "form": functions.FORMS,
    "lower": functions.LOWER,
    "logarithmic": (True, False),
    "unwrapped": (False, True),
    "units": tuple(functions.SYSTEMS),
}


# Modes of a table, or resonances that functions show, beside those of the model.


async def correlation_drawn(window: WindowState) -> None:
    """Draw MAC and the chosen pair of shapes, where the data set has modes."""
    state, shown = window.state, pair_of(window)
    if shown is None or window.compared is None:
        state.fig_mac, state.fig_shape, state.pair_words = {}, {}, ""
        return
    dark = bool(state.dark)
    state.fig_mac = as_state(shown.mac(window.compared.modes_of(state.campaign), dark))
    state.fig_shape, state.pair_words = as_state(shown.shapes(dark)), shown.words


def pair_of(window: WindowState) -> functions.ShownPair | None:
    """The pair of modes that is shown; None where curves are, and where there are no shapes."""
    state, compared = window.state, window.compared
    table = None if compared is None or state.kind == MASS else compared.table(state.campaign)
    if table is None or not table.mac.size or state.showing != MAC:
        return None
    return functions.ShownPair.chosen(table, state.pair)


def name_of(tried: WhatIf) -> str:
    """What its curve is called."""
    return f"with {tried.written.partition('=')[0]}"


# One effect explained to a person: what it means, how large it is, what it is mistaken for, and what would tell.


@dataclass(frozen=True, eq=False, kw_only=True)
class EffectExplanation:
    """One effect, for somebody who never heard of it.

    Attributes
    ----------
    id : ``family:target``
    written : with its size, as `massline add` takes it
    what : in a few words
    text : what it means here
    equation, reference : of the catalogue
    sizes : SI, by key, as the diagnosis found them; none of one that it did not try
    found : these in words
    evidence : [nats]; None where it was not tried, or beyond all numbers
    aliases : ids that these data cannot tell from it
    mistaken_for : ids or families that look like it
    confirmed_by : what would confirm it in the laboratory
    separating : measurements that would tell it from its aliases, the best first, in words
    note : what the data say of it beyond its size
    """

    id: str
    written: str
    what: str
    text: str
    equation: str
    reference: str
    sizes: Mapping[str, float]
    found: str
    evidence: float | None
    aliases: tuple[str, ...]
    mistaken_for: tuple[str, ...]
    confirmed_by: str
    separating: tuple[str, ...]
    note: str


def explained(of: Session, effect: str) -> EffectExplanation:
    """`effect` (an id, or with its size) as the diagnosis and the catalogue speak of it. Its curves: `whatif.what_if`.

    Raises
    ------
    BadInput : no such effect, with the nearest.
    """
    named = parse(
        completed(effect)[0], effect_types.Vocabulary(accelerometers=None, forces=None, places=None, parts=None), source="effect"
    )
    family, found = FAMILIES[named.family], of.diagnosis()
    # As it was accepted, else as it was ranked
    every = () if found is None else (*found.accepted, *found.ranking)
    tried = next((one for one in every if one.id == named.id), None)
    alike = () if found is None else found.equivalence_class
    advice = () if found is None else found.advice
    return EffectExplanation(
        id=named.id,
        written=effect if tried is None else str(tried.named),
        what=family.what,
        text=family.sentence.format(target=named.target, targets=" and ".join(named.targets)),
        equation=family.equation,
        reference=family.reference,
        sizes={} if tried is None else {size.key: size.value for size in tried.sizes},
        found="" if tried is None else "; ".join(sized(tried, size) for size in tried.sizes),
        evidence=None if tried is None or not isfinite(tried.evidence) else tried.evidence,
        aliases=tuple(id for id in alike if id != named.id) if named.id in alike else (),
        mistaken_for=family.mistaken_for,
        confirmed_by=family.confirmed_by,
        separating=tuple(one.text for one in advice if not one.separates or named.id in one.separates),
        note="" if tried is None else tried.note,
    )


# What if: an effect on the sliders, its curve beside the others at once, and what is known of it in words.


STEPS = 1000
"""Positions of a slider."""

LONG = re.compile(r"\d+\.\d{4,}(e[+-]?\d+)?")
"""A number with more digits than are read."""

RESTS = 0.4
"""Seconds without a move after which a slider rests."""


async def made_ready(window: WindowState) -> None:
    """Predictions and effects for the model as it stands, beside the page."""
    session, compared = window.session, window.compared
    if session is None:
        return
    table = await window.away(whatif.table, session, window.positions)
    effects = await window.away(whatif.reaching, table)
    if window.compared is not compared:  # another model meanwhile
        return
    window.table, window.effects = table, {one.id: one for one in effects}
    window.state.effects = [{"title": f"{one.id}: {one.what}", "value": one.id} for one in effects]
    window.state.flush()
    if window.wanted is not None:
        await chosen(window, window.wanted)


async def chosen(window: WindowState, effect: str | None) -> None:
    """Explain `effect` (an id, or with its size) and draw what it would do; None puts it aside."""
    state = window.state
    window.wanted, window.tried, window.exact = effect, None, True  # whatever was dragged is at rest now
    if effect is None or window.session is None:
        state.effect, window.sizes = None, {}
        await drawn(window)
        keep(window)
        return
    state.part = "what-if"
    told = await window.away(explained, window.session, effect)
    known = window.effects.get(told.id)
    found = told.sizes
    asked = dict(parse(effect).values) if "=" in effect else found
    window.sizes = {} if known is None else {one.key: asked.get(one.key, one.start) for one in known.sliders}
    state.effect = {
        "id": told.id,
        "what": told.what,
        "text": told.text,
        "equation": told.equation,
        "found": told.found,
        "evidence": "" if told.evidence is None else nats(told.evidence),
        "aliases": list(told.aliases),
        "mistaken": list(told.mistaken_for),
        "separating": list(told.separating),
        "confirmed": told.confirmed_by,
        "note": told.note,
        "reference": told.reference,
        "sliders": _sliders(window, known),
        "inside": bool(known and known.in_model),
        "answer": "",
    }
    state.flush()
    await follow(window)
    keep(window)


async def drag(window: WindowState, key: str, at: float) -> None:
    """A slider moves: the curve follows to where it is, and what lies between is left out; at rest every line is computed."""
    slider = _moved(window, key)
    if slider is None:
        return
    window.sizes[key] = value(slider, at)
    window.exact = False
    if window.dragging is None or window.dragging.done():
        window.dragging = window.begin(_followed(window))


async def size(window: WindowState, key: str, typed: str) -> None:
    """A number in the field beside the slider, in the unit that is shown there."""
    slider = _moved(window, key)
    if slider is None:
        return
    try:
        window.sizes[key] = float(typed) / slider.per_si
    except ValueError:
        window.state.failure = f"{slider.label}: a number in {slider.shown_unit or 'one'} is expected, found {typed!r}."
        return
    effect = window.state.effect
    window.state.effect = {**effect, "sliders": _sliders(window, window.effects.get(effect["id"]))}
    window.state.flush()
    await follow(window)
    keep(window)


async def follow(window: WindowState) -> None:
    """Compute the chosen effect at its size, at every line, and draw everything with it."""
    effect, table = on_sliders(window), window.table
    if effect is None or table is None:
        if window.state.effect is not None:
            _answer(window, "" if table is None else "It acts on nothing that was tested here, so no curve would move.")
            await drawn(window)  # without the curve of what was tried before
        return
    sizes = dict(window.sizes)

    def computed() -> WhatIf | None:
        """None where the slider moved on while something else was computed."""
        asked = effect.written(sizes)
        return whatif.what_if(table, asked) if window.sizes == sizes else None

    found = await window.at_rest(computed)
    if found is None or window.sizes != sizes or _stale(window, effect, table):
        return
    window.tried = found
    if window.exact:
        _answer(window, _said(found, table.at))
    await drawn(window)


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


async def _followed(window: WindowState) -> None:
    """Follow the slider until it rests, whether it was let go (which a keyboard does not tell) or not; then every line."""

    async def whole() -> None:
        await follow(window)
        keep(window)

    while not window.exact:
        await _chased(window)
        rests = dict(window.sizes)
        await asyncio.sleep(RESTS)
        if rests == window.sizes and not window.exact:
            window.exact = True
            window.begin(whole())  # beside this: whoever drags on need not wait for it


async def _chased(window: WindowState) -> None:
    """Curves for where the slider is, as fast as they come, until it is where the last one was."""
    done: dict[str, float] | None = None
    state = window.state
    while not window.exact and done != window.sizes and window.table is not None:
        effect, table = on_sliders(window), window.table
        if effect is None:  # put aside meanwhile
            return
        done = dict(window.sizes)
        found = await window.away(whatif.what_if, table, effect.written(done), exact=False)
        if _stale(window, effect, table):
            return
        trace = next((one for one in found.traces if one.campaign == state.campaign), None)
        window.drags += 1
        if trace is not None and window.tried is not None:
            # Of the entry that is shown now, whichever was then
            of_test = state.kind == FUNCTIONS
            after = trace.matrix[:, state.drive, state.response] if of_test else trace.matrix[:, state.load, state.motion]
            how = switches(window)
            curves = how.curves(after * how.unit(*units(window))[0])
            state.live = {
                "group": name_of(window.tried),
                "x": trace.frequency.tolist(),
                "y": [np.float32(one).astype(float).tolist() for one in curves],
                "number": window.drags,
            }
        sizes = _sliders(window, effect)
        state.effect = {**state.effect, "sliders": sizes, "answer": _said(found, table.at)}
        state.flush()  # all at once: each word to the page has it laid out anew


def on_sliders(window: WindowState) -> TrialEffect | None:
    """The effect on the sliders; None where there is none, or where it acts on nothing."""
    return None if window.state.effect is None else window.effects.get(window.state.effect["id"])


def _stale(window: WindowState, effect: TrialEffect, table: ReadyPredictions) -> bool:
    """Whether an answer came too late: another effect is chosen meanwhile, or the model is another."""
    return on_sliders(window) is not effect or window.table is not table


def _said(found: WhatIf, at: str) -> str:
    """What it would do, and whether anything was fitted anew for that: the size itself never is."""
    how = "with what the plain fit frees fitted anew beside it" if found.followed else "with nothing fitted anew"
    goes = f"the plain error goes from {found.before_percent:.3g} to {found.plain_percent:.3g} %"
    # Four digits of a size: a slider has no more
    told = f"{LONG.sub(lambda size: f'{float(size[0]):.4g}', found.written)}: {goes}, {how}"
    if not any(one.reached for one in found.traces):
        told += "; no curve of the dynamic mass moves"
    facts = [f"{name} from {before:.1f} to {after:.1f} σ" for name, (before, after) in found.facts.items() if before != after]
    return told + (f"; {listed(facts)}" if facts else "") + f". Seen from {at}."


def _answer(window: WindowState, text: str) -> None:
    window.state.effect = {**window.state.effect, "answer": text}
    window.state.flush()


def _moved(window: WindowState, key: str) -> Slider | None:
    effect = on_sliders(window)
    return None if effect is None else next((one for one in effect.sliders if one.key == key), None)


def _sliders(window: WindowState, effect: TrialEffect | None) -> list[dict[str, Any]]:
    if effect is None:
        return []
    return [
        {
            "key": one.key,
            "name": one.key or "alone",
            "label": one.label,
            "unit": one.shown_unit or "1",
            "value": float(f"{window.sizes[one.key] * one.per_si:.4g}"),
            "at": position(one, window.sizes[one.key]),
        }
        for one in effect.sliders
    ]
