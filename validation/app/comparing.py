"""Measured beside predicted: the entry that is shown, the map of residuals, and where a click on it leads."""

from __future__ import annotations

from typing import Any

import numpy as np

from validation.app import rungs, structure
from validation.app.bench import Bench
from validation.app.drawing import WORST_OF_ALL, drawn
from validation.comparing.maps import Map
from validation.comparing.words import run as run_in_words
from validation.desk import entries
from validation.desk.entries import Cell, Entry
from validation.plots import maps
from validation.plots.theme import escaped

TINTS = (4.0, 6.0, 20.0)
"""[σ] at which an entry of the picker takes its next tint: below the first it may be chance."""

TONES = {"good": "good", "doubtful": "doubt", "failed": "bad"}


async def shown(bench: Bench) -> None:
    """Bring errors, worst spots, picker, overlay and map to the comparison."""
    state, compared = bench.state, bench.compared
    if compared is None:
        state.errors, state.worst, state.remarks = [], [], []
        return
    state.errors = [{**one, "tone": _tone(one["verdict"])} for one in compared.summary["errors"]]
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


async def redrawn(bench: Bench) -> None:
    """Draw every figure anew, in other colours."""
    await drawn(bench)
    await rungs.shown(bench)


async def entry(bench: Bench, load: int, motion: int) -> None:
    """Show another entry, where it was looked at."""
    bench.state.load, bench.state.motion = int(load), int(motion)
    await drawn(bench)


async def marked(bench: Bench, frequency: float) -> None:
    """A click on the overlay: that frequency, and the mode nearest it."""
    bench.state.marked = float(frequency)
    await structure.nearest(bench)
    await drawn(bench)


async def cell(bench: Bench, picked: dict[str, Any]) -> None:
    """A click on the map: the overlay jumps there, to the worst of the lines that share the cell."""
    if bench.compared is None or len(picked["custom"]) != 2:  # the triangle of a mode
        return
    of, row, frequency = bench.compared.map(bench.state.campaign), str(picked["y"]), float(picked["custom"][1])
    if row in maps.PAIRS and bench.state.map_kind == "pairs":
        load, motion = divmod(maps.PAIRS.index(row), 6)
        _go(bench, Entry(campaign=of.data_set, load=load, motion=motion, frequency=frequency))
    else:
        labels = [escaped(name) for name in maps.labels(of)]
        if row not in labels:
            return
        number = labels.index(row)
        run = bench.state.run if bench.state.run != WORST_OF_ALL else _worst_run(of, number, frequency)
        found = Cell(campaign=of.data_set, run=of.runs[run], row=of.rows[number], frequency=frequency)
        _go(bench, entries.entry_of(bench.compared, found))
    await _went(bench)


async def spot(bench: Bench, number: int) -> None:
    """A worst spot of the list, the same way."""
    _go(bench, _entry_of_spot(bench, int(number)))
    await _went(bench)


async def campaign(bench: Bench, name: str) -> None:
    """Show another campaign."""
    bench.state.campaign = name
    _of_campaign(bench)
    await drawn(bench)
    await structure.shown(bench)


async def show_map(bench: Bench, kind: str) -> None:
    """Channels and loads, or pairs of axes."""
    bench.state.map_kind = kind
    await drawn(bench)


async def show_run(bench: Bench, number: int) -> None:
    """One run on the map, or the worst of all."""
    bench.state.run = int(number)
    await drawn(bench)


async def _went(bench: Bench) -> None:
    await structure.nearest(bench)
    await drawn(bench)


def _of_campaign(bench: Bench) -> None:
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


def _entry_of_spot(bench: Bench, number: int) -> Entry:
    compared = bench.compared
    one = compared.summary["worst"][number]  # type: ignore[union-attr]
    found = Cell(campaign=one["campaign"], run=one["run"], row=one["channel"], frequency=float(one["frequency_hz"]))
    return entries.entry_of(compared, found)  # type: ignore[arg-type]


def _go(bench: Bench, to: Entry) -> None:
    state = bench.state
    if state.campaign != to.campaign:
        state.campaign = to.campaign
        _of_campaign(bench)
    state.load, state.motion, state.marked = to.load, to.motion, to.frequency


def _worst_run(of: Map, row: int, frequency: float) -> int:
    line = int(np.argmin(np.abs(of.frequency - frequency)))
    known = np.isfinite(of.expected[:, line, row]) & np.isfinite(of.sigma[:, line, row])
    return int(np.argmax(np.where(known, of.sigma[:, line, row], -np.inf)))


def _short(sigma: float) -> str:
    return f"{sigma:.1f}" if sigma < 9.95 else f"{min(sigma, 9999):.0f}"


def _tone(verdict: str | None) -> str:
    return next((tone for word, tone in TONES.items() if verdict and word in verdict.lower()), "")
