"""What `massline simulate` shows: the campaign as `massline check` would, and unless it is sealed what lies behind it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from validation.campaigns import summary_json, summary_table
from validation.campaigns.summary import of_campaign
from validation.effects.identifiers import Named
from validation.rows import NONE
from validation.tables.grid import Grid, aligned, number

if TYPE_CHECKING:
    from validation.virtual_test.asked import Question
    from validation.virtual_test.command import Written


def page_of(one: Written, question: Question) -> str:
    """All of it as text."""
    from validation.tables.text import page

    found = of_campaign(one.folder, one.campaign)
    shown = () if question.sealed else tuple(_behind(one, _planted(one, question)))
    notes = summary_table.notes(found)[:-1]
    return page(summary_table.title(found), (*summary_table.grids(found), *shown), (*notes, *_notes(one, question)))


def as_json(done: Sequence[Written], question: Question) -> dict[str, Any]:
    """The same as one object; where it is sealed, nothing that was drawn or planted."""
    return {"campaigns": [_campaign(one, question) for one in done]}


def _campaign(one: Written, question: Question) -> dict[str, Any]:
    found = {**summary_json.as_json(of_campaign(one.folder, one.campaign)), "truth": str(one.truth)}
    return found if question.sealed else found | {"seed": one.plan.seed, "effects": [_effect(n) for n in _planted(one, question)]}


def _planted(one: Written, question: Question) -> tuple[Named, ...]:
    """The effects that act in this campaign; in a series, others may act elsewhere."""
    acting = {effect.id for effect in one.plan.effects}
    return tuple(named for named in question.effects if named.id in acting)


def _effect(named: Named) -> dict[str, Any]:
    return {"id": named.id, "value": named.value if set(named.values) <= {""} else dict(named.values), "unit": named.unit}


def _behind(one: Written, effects: Sequence[Named]) -> Iterator[Grid]:
    if effects:
        lines = tuple((named.id, str(named).partition("=")[2] or NONE, named.unit or NONE, named.what) for named in effects)
        yield Grid(header=("planted", "value", "unit", "what"), lines=lines, words=True)
    yield _inertia(one)


def _inertia(one: Written) -> Grid:
    """Mass, CoG and moments about it of FMD and article as they are, in their own frames."""
    truth = one.test.truth
    bodies: dict[str, Any] = {"FMD, from F": truth["fmd"]}
    article: Any = truth["article"]
    if article is not None:
        bodies |= {f"{one.plan.on_fmd}, own frame": article["own_frame"]}
    header = ("truth", "m [kg]", *(f"{axis} of CoG [mm]" for axis in "xyz"), *(f"I{axis}{axis} [kg m²]" for axis in "xyz"))
    keys = ("mass_kg", "cog_mm", "moi_cog_kgm2")
    lines = [(name, *(number(v, 4) for key in keys for v in np.ravel(body[key]))) for name, body in bodies.items()]
    columns = list(zip(*lines, strict=True))
    return Grid(header=header, lines=tuple(zip(columns[0], *map(aligned, columns[1:]), strict=True)))


def _notes(one: Written, question: Question) -> Iterator[str]:
    if question.sealed:
        yield f"Sealed: what was drawn and planted stands in {one.truth} alone."
        return
    yield f"Drawn from seed {one.plan.seed}: tests of the same seed share FMD, load cells and sensors, and so their errors."
    modes: Any = one.test.truth["modes"]
    if modes["frequency_hz"]:
        listed = ", ".join(f"{f:.2f}" for f in modes["frequency_hz"] if f <= 1.5 * one.plan.band[1])
        yield f"Modes of {one.plan.on_fmd} on a rigid base: {listed} Hz." if listed else "No mode lies near the band."
    yield f"Every figure that was drawn stands in {one.truth}, by the ids of the catalogue."
