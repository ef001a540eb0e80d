"""The pictures of `massline pretest`: condition and expected intervals, shares of the variance, rigid places."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from validation.article_reference import file_name
from validation.flexible.drawing import moved_bodies
from validation.flexible.model import Flexible
from validation.pictures.identification import DrawnShares, draw_shares
from validation.pictures.moving import MovingBody
from validation.pictures.pretest import DrawnPretest, draw_pretest
from validation.pictures.rigid_places import draw_rigid
from validation.pretest.findings import Findings
from validation.pretest.rigid_places import coarse_lines, largest_share
from validation.pretest.table import title
from validation.statement import QUANTITIES

NOTE = "Expected before any measurement, linearised at the drawn article; see docs/pretest.md."


def draw(found: Findings, folder: Path) -> tuple[Path, ...]:
    """Write every picture of `found` into `folder`, and say where they are.

    Raises
    ------
    CheckFailed : nothing can be rendered on this machine.
    """
    stem = file_name(f"pretest-{found.question.plan.article}")
    paths = [folder / f"{stem}.png", folder / f"{stem}-shares.png"]
    draw_pretest(title(found), _intervals(found), paths[0], NOTE)
    draw_shares(f"{title(found)}: where the uncertainty comes from", _shares(found), paths[1], NOTE)
    if found.model is not None and found.model.drawn is not None:
        paths.append(folder / f"{stem}-places.png")
        note = "Elastic motion, the largest of six axes, over that of a rigid article at the same place."
        heading = f"{found.question.above}: where a pick-up moves with the base"
        draw_rigid(heading, _surfaces(found, found.model), found.question.rigid, paths[2], note)
    return tuple(paths)


def _intervals(found: Findings) -> DrawnPretest:
    cases = {"plain": found.plain.half_width, "self-calibrated": found.best.half_width}
    cases |= {} if found.untared is None else {"self-calibrated, no tare": found.untared}
    best = found.best.half_width
    return DrawnPretest(
        frequency=found.spectra.frequency,
        condition=found.condition,
        limit=found.question.condition_limit,
        quantities=tuple(f"{one.label} [{one.unit}]" for one in QUANTITIES[:7]),
        intervals={name: half[:7] * np.array([one.per_si for one in QUANTITIES[:7]]) for name, half in cases.items()},
        growth={name: (half / np.where(best > 0, best, 1.0))[:7] for name, half in found.without.items()},
    )


def _shares(found: Findings) -> list[DrawnShares]:
    return [
        DrawnShares(
            way=one.identified.way,
            parameters=tuple(quantity.label for quantity in QUANTITIES),
            intervals=tuple(f"{half * q.per_si:.2g} {q.unit}" for half, q in zip(one.half_width, QUANTITIES, strict=True)),
            shares=one.quality.shares,
        )
        for one in (found.plain, found.best)
    ]


def _surfaces(found: Findings, model: Flexible) -> dict[str, tuple[MovingBody, ...]]:
    """The surface of the article by caption; the length of a vertex's displacement is its elastic share."""
    lines = coarse_lines(found.spectra.frequency, model.modes)
    start: list[MovingBody] = []
    most: list[MovingBody] = []
    for body, edges, moved in moved_bodies(model, model.modes.shapes):
        shares = largest_share(moved, body.vertices + found.seat, model.modes, found.seat, lines)
        for drawn, size in zip((start, most), shares, strict=True):
            motion = size[:, None] * [1.0, 0.0, 0.0]
            drawn.append(MovingBody(name=body.name, vertices=body.vertices, faces=body.faces, edges=edges, displacement=motion))
    low, high = float(lines[0]), float(lines[-1])
    return {f"at {low:g} Hz": tuple(start), f"at most, {low:g} to {high:g} Hz": tuple(most)}
