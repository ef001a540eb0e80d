"""The page on which one works: brought to what the session holds, after opening, after a reload, and after every step."""

from collections.abc import Mapping
from math import isfinite, log2
from typing import Any

import numpy as np

from geometry.errors import BadInput, CheckFailed
from validation.app import curves, scene3d, workers
from validation.app import state as app_state
from validation.app.scene3d import MapCell, MapEntry
from validation.app.state import WindowState, keep, kept
from validation.compare.compare import run as run_in_words
from validation.diagnose.diagnosis import Cause, Diagnosis, sized
from validation.effects import practical_units
from validation.effects.effect import at_position
from validation.estimation.verdicts import STANDS_OUT
from validation.output import nats, significant
from validation.report.charts import functions, maps
from validation.report.charts.crosscheck import standing_of
from validation.report.charts.figure import Figure
from validation.report.charts.history import falling_errors, identified_inertia, way_to
from validation.report.charts.interactive import escaped
from validation.report.charts.spec import ACCEPTED, ALIKE, LESS, TOO_MUCH_LEFT, signed_log
from validation.report.compare import CHANCE
from validation.report.scenes import motion
from validation.report.scenes.turntable import Turn, Turntable


async def switch(window: WindowState, name: str, wanted: str) -> None:
    """Show curves otherwise; every window that is opened later begins so."""
    found = next((one for one in curves.CHOICES.get(name, ()) if str(one) == wanted), None)
    if found is not None:
        window.state.update({name: found})
        app_state.keep_switches({one: window.state[one] for one in curves.SWITCHES})
        await curves.drawn(window)


async def function(window: WindowState, drive: int, response: int) -> None:
    """Show another response function."""
    window.state.drive, window.state.response = int(drive), int(response)
    await curves.drawn(window)


async def showing(window: WindowState, name: str) -> None:
    """Curves, or modes beside modes."""
    window.state.showing = curves.MAC if name == curves.MAC else curves.CURVES
    await curves.drawn(window)
    await structure_shown(window)


async def matched(window: WindowState, picked: dict[str, Any]) -> None:
    """A click on the MAC: the shapes of that pair, side by side."""
    if len(picked["custom"]) == 4:
        window.state.pair = [int(picked["custom"][2]), int(picked["custom"][3])]
        await curves.correlation_drawn(window)
        await structure_shown(window)


# The ladder as the page shows it: rungs with their errors, the fall, and identified inertia on its way.


LOW = 270
"""Least height of a figure [pixels]; the page gives it what there is."""

SHORTER = {
    "plain, fitted data": "plain",
    "plain, only for checking": "only for checking",
    "χ² per degree of freedom": "χ² per dof",
    "z² of the tolerances over what is due": "z² over due",
}
"""Names in the legend."""

BESIDE = 4
"""Rungs whose inertia is drawn, the last ones."""


async def rungs_shown(window: WindowState) -> None:
    """Bring rungs, falling errors and identified inertia to the ladder."""
    if window.session is None:
        return
    state, at = window.state, await window.away(window.session.ladder)
    rungs = []  # the page sees what is assigned, and nothing that is put into a list afterwards
    for one in reversed(at.ladder.rungs):
        told = "no figures yet"
        if (of := one.errors) is not None:
            held = "" if of.held_out is None else f", checked {of.held_out:.3g} %"
            told = f"plain {of.plain:.3g} %{held}, χ² {significant(of.chi2_per_dof, 3)}, tolerances {of.tolerance_z2:.0f}"
        rung = {
            "number": one.number,
            "title": one.title,
            "errors": told,
            "plain": None if of is None else of.plain,
            "verdict": " ".join(one.verdict),
            "here": at.rung is not None and at.rung.number == one.number,
        }
        rungs.append(rung)
    state.rungs = rungs
    # The errors of the rung below, by the names that a comparison gives them
    state.before = {}
    below = None if at.rung is None or at.rung.parent is None else at.ladder.rung(at.rung.parent).errors
    if below is not None:
        state.before = {
            "nominal error": f"{below.nominal:.3g} %",
            "plain error": f"{below.plain:.3g} %",
            "fitted error": f"χ² {below.chi2_per_dof:.3g}, z² {below.tolerance_z2:.3g}",
        } | ({} if below.held_out is None else {"held-out error": f"{below.held_out:.3g} %"})
    state.unsaved = app_state.unsaved(window.session.folder)
    state.undoable = at.below is not None and at.below.parent is not None
    state.step = "" if at.rung is None else " ".join(at.rung.verdict)  # what the last step did
    dark = bool(state.dark)

    def fall() -> dict[str, Any]:
        """With a legend in fewer words: a panel is narrower than a page."""
        figure = falling_errors(at, dark=dark)
        for one in figure.data:
            one["name"] = SHORTER.get(one["name"], one["name"])
        figure.update(margin={"b": 28, "l": 54})
        figure.up(title={"font": {"size": 11}}, tickfont={"size": 11})
        return _untitled(figure, 14)

    def inertia() -> dict[str, Any]:
        """With its headings in narrow lines, likewise."""
        figure = identified_inertia(dict(list(bodies.items())[-BESIDE:]), dark=dark)
        for heading in figure.layout["annotations"]:
            heading |= {"text": heading["text"].replace(" [", "<br>["), "font": {"size": 11}}
        figure.across(tickangle=0, tickfont={"size": 10})
        return _untitled(figure, 50)

    # The first article's identified inertia on each rung of the way
    bodies = {f"{one.number} {one.title}": one.bodies[0] for one in way_to(at) if one.bodies}
    state.fig_ladder = await window.away(fall) if any(one.errors for one in at.ladder.rungs) else None
    state.fig_inertia = await window.away(inertia) if bodies else None


def _untitled(figure: Figure, above: int) -> dict[str, Any]:
    """Without its title, which the tab above it says, in a low panel; `above` [pixels] are left between legend and curves."""
    legend = {"yref": "container", "y": 1.0, "yanchor": "top", "font": {"size": 11}}
    margin = {"t": above + 40, "r": functions.ROOM + 6}
    figure.update(title={"text": ""}, height=LOW, margin=margin, legend=legend, meta={"above": above})
    figure.update(modebar={"orientation": "v"})
    return curves.as_state(figure)


# The structure in three dimensions: with its sensors, or swinging in the mode nearest the frequency that was clicked.


NEAR = 0.5
"""Octaves between a frequency and a mode that has anything to do with it."""

AT_REST = -1
"""In place of a mode: bodies with their sensors."""

FIRST_SCORE = -2
"""In place of a mode: the nodes coloured by the evidence for what may sit there, this for the first kind and down from it."""

TRIED = 4
"""Places without a name that predictions are kept ready for, the last ones."""


async def structure_shown(window: WindowState) -> None:
    """Show the campaign's structure as the choice above it says."""
    state, campaign, compared = window.state, window.state.campaign, window.compared
    if window.session is None or not campaign:
        return
    known = () if compared is None or campaign not in compared.campaigns else compared.modes_of(campaign)
    modes = [{"title": f"{one.frequency:.2f} Hz, {one.name}", "value": k} for k, one in enumerate(known)]
    article = "" if compared is None or state.kind == curves.MASS else compared.map(campaign).configuration
    scored = await window.away(window.session.evidence, article) if article else {}
    coloured = [
        {"title": f"Where {motion.WORDS[kind]} would explain most", "value": FIRST_SCORE - k} for k, kind in enumerate(scored)
    ]
    state.modes = [{"title": "Structure and sensors", "value": AT_REST}, *coloured, *modes]
    if state.mode not in {one["value"] for one in state.modes}:
        state.mode = AT_REST
    kind = list(scored)[FIRST_SCORE - state.mode] if state.mode <= FIRST_SCORE else ""
    state.view_far = _far(window)
    state.flush()
    try:
        if compared is not None and state.kind != curves.MASS:
            number = None if state.mode < 0 else state.mode
            here = None if state.node is None else np.array(state.node["point"])
            turned = await window.away(
                scene3d.of_test, window.session, compared, campaign, number, curves.pair_of(window), here, kind
            )
            table_of, label, note = turned.table, turned.label, turned.note
        elif state.mode == AT_REST or compared is None:
            scene = await window.away(scene3d.scene, window.session, campaign)
            table_of, label = Turntable(scene.bodies, scene.sensors), f"{campaign}: structure and sensors"
            note = f"{scene.title}. {scene.note}"
        else:
            shape = await window.away(scene3d.shape, window.session, compared, campaign, state.mode)
            rest = await window.away(scene3d.scene, window.session, campaign)
            table_of = Turntable(shape.bodies, rest.sensors, shape.scale)
            label = f"{campaign}: {shape.name} at {shape.frequency:.2f} Hz"
            damping = f"damping ratio {shape.damping_ratio:.3g}"
            note = f"{shape.name}, {shape.frequency:.2f} Hz, {damping}; base held, size of the swing as drawn."
        before, window.turntable = window.turntable, table_of
        if before is not None:
            await window.drawn(before.close)
        window.views += 1
        moves = table_of.moves
        state.update({"view": str(window.views), "view_label": label, "view_note": note, "view_moves": moves})
    except (BadInput, CheckFailed) as error:
        state.view, state.view_note = "", str(error)
    state.flush()


async def node(window: WindowState, at: dict[str, float]) -> None:
    """A click on the structure: the node that is meant, and what may be tried there."""
    turntable, state = window.turntable, window.state
    if turntable is None or state.mode >= 0:
        return
    turn = Turn(azimuth=at["az"], elevation=at["el"], zoom=at["zoom"], size=(int(at["w"]), int(at["h"])))
    found = turntable.picked(turn, (at["x"], at["y"]))
    if found is None:
        state.node = None
    else:
        place = at_position(found.tolist())
        every = ((kind.partition(":"), words) for kind, words in motion.WORDS.items())
        tries = [{"id": ":".join(filter(None, (family, place, axis))), "title": words} for (family, _, axis), words in every]
        where = ", ".join(f"{1e3 * x:.4g}" for x in found)
        state.node = {"point": found.tolist(), "place": place, "words": f"Node at ({where}) mm", "tries": tries}
    await structure_shown(window)


async def try_here(window: WindowState, effect: str) -> None:
    """Make predictions ready for an effect at the node that is marked, and put it on the sliders."""
    session, state = window.session, window.state
    if session is None or state.node is None or window.compared is None or window.worker is not None:
        return
    window.positions = tuple(dict.fromkeys((*window.positions, state.node["place"])))[-TRIED:]
    window.wanted = effect
    await curves.made_ready(window)


async def mode(window: WindowState, number: int) -> None:
    """Show a mode, or the structure at rest."""
    window.state.mode = int(number)
    await structure_shown(window)


async def nearest(window: WindowState) -> None:
    """Show the mode nearest the frequency that is marked, where there is one; how far it is stands below it."""
    state = window.state
    if window.compared is None or state.marked is None:
        return
    number = scene3d.nearest(window.compared, state.campaign, state.marked)
    if number is not None and number != state.mode:
        state.mode = number
        window.begin(structure_shown(window))
    state.view_far = _far(window)


def picture(window: WindowState, asked: Mapping[str, str]) -> bytes:
    """The picture that the page asks for; to be called in the thread that draws.

    Raises
    ------
    ValueError : a number that is none.
    LookupError : nothing is shown.
    """
    if window.turntable is None:
        raise LookupError("nothing is shown")
    frames = 8
    share = -1.0 + 2.0 * min(max(int(asked.get("frame", "0")), 0), frames) / frames
    return window.turntable.jpeg(
        Turn(
            azimuth=float(asked.get("az", "0")),
            elevation=float(asked.get("el", "0")),
            zoom=min(max(float(asked.get("zoom", "1")), 0.2), 20.0),
            size=(int(asked.get("w", "600")), int(asked.get("h", "400"))),
            dark=asked.get("dark") == "1",
            share=share,
        )
    )


def apart(marked: float, found: float) -> str:
    """What is said of a mode at the frequency `found` when another is marked; nothing where they are neighbours."""
    if found <= 0.0 or abs(log2(found / marked)) < NEAR:
        return ""
    return f"No mode is near {marked:.4g} Hz: this one is at {found:.4g} Hz, and what is seen there is no resonance of the model."


def _far(window: WindowState) -> str:
    """What is said of the mode that is shown, and of the frequency that is marked."""
    state = window.state
    modes = () if window.compared is None else window.compared.modes_of(state.campaign)
    if state.marked is None or not 0 <= state.mode < len(modes):
        return ""
    return apart(float(state.marked), modes[state.mode].frequency)


# Measured beside predicted: the entry that is shown, the map of residuals, and where a click on it leads.


TINTS = (4.0, 6.0, 20.0)
"""[σ] at which an entry of the picker takes its next tint: below the first it may be chance."""

TONES = {"good": "good", "doubtful": "doubt", "failed": "bad"}


async def comparing_shown(window: WindowState) -> None:
    """Bring errors, worst spots, picker, overlay and map to the comparison."""
    state, compared = window.state, window.compared
    if compared is None:
        state.errors, state.worst, state.remarks = [], [], []
        return
    tones = [
        next((tone for word, tone in TONES.items() if word in (one["verdict"] or "").lower()), "") for one in compared.errors
    ]
    state.errors = [{**one, "tone": tone} for one, tone in zip(compared.errors, tones, strict=True)]
    worst = compared.summary["worst"]
    kept = sum(one["sigma"] >= STANDS_OUT for one in worst) or CHANCE  # as the command prints them
    state.worst = [{"sigma": f"{one['sigma']:.1f}", "text": one["text"]} for one in worst[:kept]]
    state.remarks = list(compared.summary["warnings"])
    state.campaigns = list(compared.campaigns)
    fresh = state.campaign not in compared.campaigns
    if fresh:
        state.campaign = compared.campaigns[0]
    _of_campaign(window)
    if fresh and worst:
        if state.kind != curves.MASS:
            await spot(window, 0)
            return
        _go(window, _entry_of_spot(window, 0))  # the structure stays at rest until somebody clicks
    await curves.drawn(window)


async def redrawn(window: WindowState) -> None:
    """Draw every figure anew, in other colours."""
    await curves.drawn(window)
    await rungs_shown(window)


async def entry(window: WindowState, load: int, motion: int) -> None:
    """Show another entry, where it was looked at."""
    window.state.load, window.state.motion = int(load), int(motion)
    await curves.drawn(window)


async def marked(window: WindowState, frequency: float) -> None:
    """A click on the overlay: that frequency, and the mode nearest it."""
    window.state.marked = float(frequency)
    await nearest(window)
    await curves.drawn(window)


async def cell(window: WindowState, picked: dict[str, Any]) -> None:
    """A click on the map: the overlay jumps there, to the worst of the lines that share the cell."""
    if window.compared is None or len(picked["custom"]) != 2:  # the triangle of a mode
        return
    of, row, frequency = window.compared.map(window.state.campaign), str(picked["y"]), float(picked["custom"][1])
    if window.state.kind == curves.TABLE:
        await _to_mode(window, int(frequency) - 1)
        return
    if row in maps.PAIRS and window.state.map_kind == "pairs":
        load, motion = divmod(maps.PAIRS.index(row), 6)
        _go(window, MapEntry(campaign=of.data_set, load=load, motion=motion, frequency=frequency))
    else:
        labels = [escaped(name) for name in maps.labels(of)]
        if row not in labels:
            return
        number = labels.index(row)
        if window.state.run != curves.WORST_OF_ALL:
            run = window.state.run
        else:
            line = int(np.argmin(np.abs(of.frequency - frequency)))
            known = np.isfinite(of.expected[:, line, number]) & np.isfinite(of.sigma[:, line, number])
            run = int(np.argmax(np.where(known, of.sigma[:, line, number], -np.inf)))
        if window.state.kind == curves.FUNCTIONS:
            window.state.drive, window.state.response, window.state.marked = run, number, frequency
            window.state.showing = curves.CURVES
            await nearest(window)
            await curves.drawn(window)
            return
        found = MapCell(campaign=of.data_set, run=of.runs[run], row=of.rows[number], frequency=frequency)
        _go(window, scene3d.entry_of(window.compared, found))
    await nearest(window)
    await curves.drawn(window)


async def _to_mode(window: WindowState, row: int) -> None:
    """A mode of a table and its partner."""
    table = None if window.compared is None else window.compared.table(window.state.campaign)
    if table is None or not 0 <= row < len(table.pairs):
        return
    window.state.showing, window.state.pair = curves.MAC, [row, table.modes.index(table.pairs[row].model)]
    await curves.drawn(window)
    await structure_shown(window)


async def spot(window: WindowState, number: int) -> None:
    """A worst spot of the list, the same way."""
    one, compared = _spot(window, int(number)), window.compared
    of = None if compared is None else compared.map(one["campaign"])
    if of is not None and of.pairs is None and of.channels == len(of.rows):  # a test by itself
        if window.state.campaign != of.data_set:
            window.state.campaign = of.data_set
            _of_campaign(window)
        run = of.runs.index(one["run"])
        if window.state.kind == curves.TABLE:
            await _to_mode(window, run)
            return
        window.state.drive, window.state.response = run, of.rows.index(one["channel"])
        window.state.marked, window.state.showing = float(one["frequency_hz"]), curves.CURVES
        await nearest(window)
        await curves.drawn(window)
        return
    _go(window, _entry_of_spot(window, int(number)))
    await nearest(window)
    await curves.drawn(window)


async def campaign(window: WindowState, name: str) -> None:
    """Show another campaign."""
    window.state.campaign, window.state.node = name, None
    _of_campaign(window)
    await curves.drawn(window)
    await structure_shown(window)


async def show_map(window: WindowState, kind: str) -> None:
    """Channels and loads, or pairs of axes."""
    window.state.map_kind = kind
    await curves.drawn(window)


async def show_run(window: WindowState, number: int) -> None:
    """One run on the map, or the worst of all."""
    window.state.run = int(number)
    await curves.drawn(window)


def _of_campaign(window: WindowState) -> None:
    """What the picker and the choice of runs say of the campaign that is shown."""
    state = window.state
    of = window.compared.map(state.campaign)  # type: ignore[union-attr]
    table = window.compared.table(state.campaign)  # type: ignore[union-attr]
    state.kind = curves.FUNCTIONS if of.functions is not None else curves.TABLE if not of.has_lines else curves.MASS
    state.correlated = table is not None and bool(table.mac.size)
    state.showing = curves.MAC if state.kind == curves.TABLE else curves.CURVES if not state.correlated else state.showing
    state.drives, state.responses = ([*of.runs], [*of.rows]) if state.kind == curves.FUNCTIONS else ([], [])
    state.drive, state.response = (
        at if at < max(count, 1) else 0 for at, count in ((state.drive, len(of.runs)), (state.response, len(of.rows)))
    )
    if state.kind != curves.MASS:
        state.map_kind = "channels"
    state.runs = [{"title": "the worst of all runs", "value": curves.WORST_OF_ALL}] + [
        {"title": run_in_words(name, axis), "value": k} for k, (name, axis) in enumerate(zip(of.runs, of.axes, strict=True))
    ]
    if state.run not in range(curves.WORST_OF_ALL, len(of.runs)):
        state.run = curves.WORST_OF_ALL
    peaks = np.full((6, 6), np.nan) if of.pairs is None else np.nanmax(of.pairs.sigma, axis=0)
    state.peaks = [
        ["–" if np.isnan(peak) else f"{peak:.1f}" if peak < 9.95 else f"{min(peak, 9999):.0f}" for peak in row] for row in peaks
    ]
    state.tints = [[int(np.searchsorted(TINTS, 0 if np.isnan(peak) else peak, side="right")) for peak in row] for row in peaks]


def _spot(window: WindowState, number: int) -> Mapping[str, Any]:
    return window.compared.summary["worst"][number]  # type: ignore[union-attr, no-any-return]


def _entry_of_spot(window: WindowState, number: int) -> MapEntry:
    compared, one = window.compared, _spot(window, number)
    found = MapCell(campaign=one["campaign"], run=one["run"], row=one["channel"], frequency=float(one["frequency_hz"]))
    return scene3d.entry_of(compared, found)  # type: ignore[arg-type]


def _go(window: WindowState, to: MapEntry) -> None:
    state = window.state
    if state.campaign != to.campaign:
        state.campaign = to.campaign
        _of_campaign(window)
    state.load, state.motion, state.marked = to.load, to.motion, to.frequency


# What is missing, as the page tells it: the verdict, and causes as bars of evidence with the intervals of their sizes.


SHOWN = 12
"""Causes in the list."""

TONE_OF_CAUSE = {ACCEPTED: "good", ALIKE: "doubt", LESS: "faint", TOO_MUCH_LEFT: "bad"}
"""Of a cause, by where it stands."""


async def diagnosing_shown(window: WindowState) -> None:
    """Bring verdict and ranking to the diagnosis of the model as it stands, where it was made."""
    found = None if window.session is None else await window.away(window.session.diagnosis)
    state = window.state
    if found is None:
        state.verdict, state.ranking = None, []
        return
    detectable = [(one.id, one.id.partition(":")[0], one) for one in found.detectable if isfinite(one.size)]
    state.verdict = {
        "headline": found.sentences["headline"],
        "text": found.sentences["text"],
        "next": found.next_measurement,
        "leftover": found.left or "",
        "detectable": [{"id": id, "size": practical_units.one(family, "", one.unit, one.size)} for id, family, one in detectable],
    }
    # What was accepted, then what was ranked last, then what earlier steps had ranked; each once, with the step it is from
    first: dict[str, tuple[Cause, int | None]] = {}
    for one in (*found.accepted, *found.ranking):
        first.setdefault(one.id, (one, None))
    for number, step in enumerate(found.steps, start=1):
        for one in step.ranking:
            first.setdefault(one.id, (one, number))
    order = list(first.values())[:SHOWN]
    lengths = signed_log(np.minimum([one.evidence if isfinite(one.evidence) else np.inf for one, _ in order], 1e9))
    most = max(float(lengths.max(initial=0.0)), 1e-9)
    state.ranking = [
        _cause(one, found, round(100 * max(length, 0.0) / most, 1)) | {"step": number}
        for (one, number), length in zip(order, lengths, strict=True)
    ]
    if found.everywhere:
        window.begin(structure_shown(window))


def _cause(one: Cause, found: Diagnosis, share: float) -> dict[str, Any]:
    alike = one.id in found.equivalence_class and len(found.equivalence_class) > 1
    standing = standing_of(found, one)
    tone = "doubt" if alike else TONE_OF_CAUSE[standing]
    if standing == ACCEPTED and alike:
        standing += ", as one of several that the data cannot tell apart"
    # Where the 90 % interval of its first size lies on a line that holds no effect, too: in per cent, and in words
    interval: dict[str, Any] | None = None
    if one.sizes and one.sizes[0].low != one.sizes[0].high:
        low, high = one.sizes[0].low, one.sizes[0].high
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
        "id": one.id,
        "written": str(one.named),
        "standing": standing,
        "tone": tone,
        "size": "; ".join(sized(one, size) for size in one.sizes),
        "nats": nats(one.evidence) if isfinite(one.evidence) else "more than can be counted",
        "share": share,
        "interval": interval,
    }


async def shown(window: WindowState) -> None:
    """Show the session as it is; a comparison that was never made begins."""
    state, session = window.state, window.session
    if session is None:
        return
    workers.recovered(session)
    window.wanted = kept(window)
    names = [path.rsplit("/", 1)[-1] for path in session.asked.data]
    state.title = ": ".join(filter(None, (session.title or session.asked.model.rsplit("/", 1)[-1], ", ".join(names))))
    state.screen, state.failure, state.ready = "work", "", None
    state.faults = {"model": [], "data": [], "options": []}
    state.flush()
    await stands(window)
    if window.compared is None:
        app_state.start(window, workers.COMPARE, stands)


async def stands(window: WindowState) -> None:
    """Everything that follows from the model as it stands now."""
    if window.session is None:
        return
    window.compared = await window.away(window.session.comparison)
    window.table, window.effects, window.tried = None, {}, None  # all of the model that stood there before
    window.state.compared = window.compared is not None
    await comparing_shown(window)
    await rungs_shown(window)
    await diagnosing_shown(window)
    window.state.flush()
    window.begin(structure_shown(window))
    if window.compared is not None:
        window.begin(curves.made_ready(window))


# Up and down the ladder, from the page.


async def add(window: WindowState) -> None:
    """Add the chosen effect; its fit begins at the size of the sliders."""
    effect = curves.on_sliders(window)
    if effect is None:
        return
    app_state.start(window, workers.ADD, _added, stands, effect=effect.written(window.sizes))


async def _added(window: WindowState) -> None:
    window.wanted, window.tried, window.state.effect, window.state.node = None, None, None, None
    window.state.tab, window.state.part = "ladder", "fails"
    await stands(window)
    keep(window)


async def undo(window: WindowState) -> None:
    """One rung down."""
    if window.session is not None and window.worker is None:
        await window.away(window.session.undo)
        await stands(window)


async def go(window: WindowState, number: int) -> None:
    """To any rung."""
    if window.session is not None and window.worker is None:
        await window.away(window.session.go_to, int(number))
        await stands(window)
        if window.compared is None:
            app_state.start(window, workers.COMPARE, stands)
