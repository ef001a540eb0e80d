"""The two pictures of the story."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from frame_story.climbing import NOMINAL, Rung, gain
from validation.estimation.problem import Evaluation
from validation.report.charts.history import FITTED, PERCENT, DrawnRung, draw_fall
from validation.report.charts.maps import DrawnModel, draw_accelerances

NOTE = "Measured: Digital-Twin-Operational-Platform/Cristallo, BSD-3. Errors are smoothed over 0.4 Hz"


def figures(rungs: Mapping[str, Rung]) -> dict[str, dict[str, float]]:
    """What the pictures show, for a test to see that they are those of the present code."""
    plain = {name: one.evaluation.plain.percent for name, one in rungs.items()}
    return {"plain_percent": plain, "held_out_percent": {name: one.held_out for name, one in rungs.items()}}


def draw(rungs: Mapping[str, Rung], ladder: Sequence[str], folder: Path) -> Path:
    """The accelerances with the models of the `ladder`, into `folder`."""
    drawn = []
    for name in ladder:
        one, as_drawn = rungs[name], name == NOMINAL
        share = one.evaluation.nominal if as_drawn else one.evaluation.plain
        rows = one.model.at({} if as_drawn else one.offsets, derivatives=False).rows[..., 0]
        drawn.append(DrawnModel(name=f"{'as drawn' if as_drawn else name}: {share.percent:.3g} %", rows=rows))
    path = folder / "three-storey-frame.png"
    data = rungs[NOMINAL].model.measured
    draw_accelerances("Three storeys, three drive points", data, drawn, path, NOTE, json.dumps(figures(rungs)))
    return path


def draw_ladder(rungs: Mapping[str, Rung], ladder: Sequence[str], folder: Path) -> Path:
    """How the errors fall along the `ladder`, the other candidates beside it, into `folder`."""
    numbers, path = {name: k for k, name in enumerate(rungs)}, folder / "three-storey-frame-ladder.png"
    drawn = []
    for name, one in rungs.items():
        depth = ladder.index(name) if name in ladder else 1
        before = ladder[max(depth - 1, 0)]
        rung = DrawnRung(
            number=numbers[name],
            parent=numbers[before] if depth else None,
            title=name,
            depth=depth,
            here=name in ladder,
            errors=_drawn(name, one.evaluation),
            gain=gain(rungs, name, before),
        )
        drawn.append(rung)
    aside = ", ".join(f"{numbers[name]} {name}" for name in rungs if name not in ladder)
    note = f"Each by itself: {aside}. Where chi² is far above 1, nats are no probabilities"
    draw_fall("The frame's errors, from rung to rung", drawn, path, note, json.dumps(figures(rungs)))
    return path


def _drawn(name: str, one: Evaluation) -> dict[str, float]:
    """Errors of one rung; the nominal one is that of the model as drawn."""
    fit = one.fitted
    drawn = one.nominal.percent if name == NOMINAL else np.nan
    held = one.held_out.percent if one.held_out else np.nan
    values = (drawn, one.plain.percent, held, fit.chi2 / fit.degrees_of_freedom, fit.tolerance_z2 / fit.tolerances)
    return dict(zip((*PERCENT, *FITTED), values, strict=True))
