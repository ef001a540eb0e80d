"""The structure in three dimensions: with its sensors, or swinging in the mode nearest the frequency that was clicked."""

from __future__ import annotations

from collections.abc import Mapping
from math import log2

from geometry.errors import BadInput, CheckFailed
from validation.app.bench import Bench
from validation.desk import scene, shapes
from validation.pictures.turntable import Turn, Turntable

NEAR = 0.5
"""Octaves between a frequency and a mode that has anything to do with it."""

AT_REST = -1
"""In place of a mode: bodies with their sensors."""


async def shown(bench: Bench) -> None:
    """Show the campaign's structure as the choice above it says."""
    state, campaign = bench.state, bench.state.campaign
    if bench.desk is None or not campaign:
        return
    state.modes = _modes(bench)
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


async def mode(bench: Bench, number: int) -> None:
    """Show a mode, or the structure at rest."""
    bench.state.mode = int(number)
    await shown(bench)


async def nearest(bench: Bench) -> None:
    """Show the mode nearest the frequency that is marked, where there is one; how far it is stands below it."""
    state = bench.state
    if bench.compared is None or state.marked is None:
        return
    number = shapes.nearest(bench.compared, state.campaign, state.marked)
    if number is not None and number != state.mode:
        state.mode = number
        bench.begin(shown(bench))
    state.view_far = _far(bench)


def picture(bench: Bench, asked: Mapping[str, str]) -> bytes:
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


async def _at_rest(bench: Bench, campaign: str) -> None:
    assert bench.desk is not None
    found = await bench.away(scene.scene, bench.desk, campaign)
    await _put(
        bench, Turntable(found.bodies, found.sensors), f"{campaign}: structure and sensors", f"{found.title}. {found.note}"
    )


async def _swinging(bench: Bench, campaign: str, number: int) -> None:
    assert bench.desk is not None
    assert bench.compared is not None
    found = await bench.away(shapes.shape, bench.desk, bench.compared, campaign, number)
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


def _far(bench: Bench) -> str:
    """What is said of the mode that is shown, and of the frequency that is marked."""
    state = bench.state
    modes = () if bench.compared is None else bench.compared.modes_of(state.campaign)
    if state.marked is None or not 0 <= state.mode < len(modes):
        return ""
    return apart(float(state.marked), modes[state.mode].frequency)


async def _put(bench: Bench, table: Turntable, label: str, note: str) -> None:
    before, bench.turntable = bench.turntable, table
    if before is not None:
        await bench.drawn(before.close)
    bench.views += 1
    bench.state.update({"view": str(bench.views), "view_label": label, "view_note": note})


def _modes(bench: Bench) -> list[dict[str, object]]:
    at_rest: list[dict[str, object]] = [{"title": "Structure and sensors", "value": AT_REST}]
    if bench.compared is None or bench.state.campaign not in bench.compared.campaigns:
        return at_rest
    found = bench.compared.modes_of(bench.state.campaign)
    return at_rest + [{"title": f"{one.frequency:.2f} Hz, {one.name}", "value": k} for k, one in enumerate(found)]
