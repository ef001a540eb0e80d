"""The tables of the story, every one within 80 columns, and how a section of it is printed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise

import numpy as np
from rich.console import Console

from frame_story.climbing import BETWEEN, IN_WORDS, NOMINAL, Rung, gain, where
from frame_story.readings import mass_line, resonances
from frame_story.structure import FLOORS
from validation.estimation.evaluate import share, squares
from validation.prediction.response_functions import ResponseFunctionTest
from validation.report.document import Grid, page

WIDEST = 100
"""Columns beyond which no line of text is read with ease."""

MODULUS = "modulus:legs"

FAR = 2.0
"""chi² a degree of freedom above which evidence is no probability."""


def section(console: Console, title: str, grids: Iterable[Grid], *sentences: str) -> None:
    """Print a heading, the tables, and what is to be said of them."""
    text = page(title, grids, sentences, min(console.width, WIDEST))
    console.print(text, markup=False, highlight=False)


def frequencies(test: ResponseFunctionTest) -> Grid:
    """Measured and nominal eigenfrequencies."""
    pairs = enumerate(zip(resonances(test), test.structure.frequency, strict=True))
    lines = [(str(r + 1), f"{f:.3f} Hz", f"{drawn:.3f} Hz", f"{100 * (drawn / f - 1):.1f} %") for r, (f, drawn) in pairs]
    return Grid(header=("mode", "measured", "model", "too high"), lines=tuple(lines))


def masses(test: ResponseFunctionTest, drawn: float) -> Grid:
    """Masses of the floors on the mass line."""
    line = mass_line(test)
    found = enumerate(zip(line["alone"], line["together"], strict=True), start=1)
    lines = [(str(k), f"{drawn:.2f} kg", f"{alone:.2f} kg", f"{together:.2f} kg") for k, (alone, together) in found]
    return Grid(header=("floor", "drawn", "1/reading", "springs off"), lines=tuple(lines))


def errors(rungs: Mapping[str, Rung]) -> Grid:
    """Errors of models, fitted and held out."""
    lines = []
    for name, one in rungs.items():
        shares = (one.evaluation.plain.percent, one.held_out, where(one.model, one.offsets)[-1])
        lines.append((name, *(f"{percent:.1f} %" for percent in shares)))
    return Grid(header=("what is added", "error", "held out", "mass line"), lines=tuple(lines))


def price(rungs: Mapping[str, Rung]) -> Grid:
    """What models ask of the tolerances when all of them are free, and what that leaves."""
    lines = []
    for name, one in rungs.items():
        fit = one.evaluation.fitted
        asked = f"{fit.tolerance_z2:.0f} of {fit.tolerances}"
        lines.append((name, f"{one.misfit:.0f}", asked, modulus(one), f"{gain(rungs, name):+.0f}"))
    return Grid(header=("what is added", "chi²/dof", "sum z²", "modulus", "evidence"), lines=tuple(lines))


def modulus(rung: Rung) -> str:
    """How far the modulus is pushed with all tolerances free, in its standard deviations."""
    own = next((one for one in rung.model.structure.parameters if one.name == MODULUS), None)
    if own is None or MODULUS in rung.sizes:
        return "free"
    return f"{round(rung.evaluation.fitted.by_name[MODULUS] / own.tolerance, 1) + 0.0:+.1f} sd"  # no -0.0


def evidence(rungs: Mapping[str, Rung], name: str) -> str:
    """How much more probable `name` is than the nominal model, and, where chi² forbids to say so, what evidence would prefer."""
    least = min(rungs[name].misfit, rungs[NOMINAL].misfit)
    found = f"Evidence is {gain(rungs, name):+.0f} nats for {name} over {NOMINAL}."
    if least < FAR:
        return found
    found += f" But chi² is {least:.0f} a degree of freedom, far above 1: such figures are no probabilities."
    ahead = max(rungs, key=lambda other: gain(rungs, other))
    return found if ahead == name else f"{found} By them {ahead} would be ahead, with the modulus at {modulus(rungs[ahead])}."


def missed(drawn: ResponseFunctionTest) -> float:
    """Error [%] of the model as drawn, over all lines."""
    every = np.arange(len(drawn.measured.frequency))
    return share(squares(drawn, {}, every)).percent


def bands(drawn: ResponseFunctionTest, rungs: Mapping[str, Rung]) -> Grid:
    """Errors by frequency: of the model as drawn and nothing fitted, and of `rungs`."""
    columns = [where(drawn, {}), *(where(one.model, one.offsets) for one in rungs.values())]
    spans = [f"{low:g}-{high:g} Hz {words}" for (low, high), words in zip(pairwise(BETWEEN), IN_WORDS, strict=True)]
    lines = [
        (span, *(f"{percent:.0f} %" for percent in row)) for span, row in zip(spans, zip(*columns, strict=True), strict=True)
    ]
    return Grid(header=("where", "drawn", *rungs), lines=tuple(lines))


def sizes(rungs: Mapping[str, Rung], drawn: float) -> Grid:
    """Clamps and masses of every floor, as fitted."""
    lines = []
    for name, one in rungs.items():
        found = one.sizes
        clamps = [1e3 * found.get(f"leg-clamp:{floor}", found.get("leg-clamp", 0.0)) for floor in FLOORS]
        floors = [drawn + found.get(f"point-mass:{floor}", 0.0) for floor in FLOORS]
        lines.append((name, _listed(clamps), _listed(floors)))
    return Grid(header=("floors 1, 2, 3", "clamps [rad/(kN m)]", "masses [kg]"), lines=tuple(lines))


def _listed(values: Sequence[float]) -> str:
    return "   ".join(f"{value:.2f}" for value in values)


def held_out(rungs: Mapping[str, Rung]) -> Grid:
    """Errors on every drive point by the fit to the other two."""
    runs = next(iter(rungs.values())).model.measured.runs
    found = [one.evaluation.held_out for one in rungs.values()]
    lines = [(run, *(f"{_on(one.by_run, run):.1f} %" for one in found if one)) for run in runs]
    return Grid(header=("predicted", *rungs), lines=tuple(lines))


def _on(by_run: Mapping[str, float], run: str) -> float:
    return next(percent for name, percent in by_run.items() if name.endswith(run))
