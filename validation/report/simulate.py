"""The answer of `massline simulate`: a virtual test written to disk, and what it holds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import click
import numpy as np

from geometry.errors import BadInput
from identification import campaign_file
from identification.campaign import Campaign
from identification.campaign_file import require_alive
from validation.effects.catalogue import Named
from validation.identify.check import of_campaign
from validation.output import percent, shown, to_json
from validation.reference.statement import NONE
from validation.report import campaign
from validation.report.document import Grid, aligned, grid_number
from validation.virtual_test import simulate as virtual_test_simulate
from validation.virtual_test.plan import Plan
from validation.virtual_test.simulate import SimulateOptions, VirtualTest


@dataclass(frozen=True, eq=False, kw_only=True)
class Written:
    """A virtual test that was written: as its file states it, where it lies and its truth, and whether it replaced another."""

    plan: Plan
    campaign: Campaign
    test: VirtualTest
    folder: Path
    truth: Path
    replaced: bool


def simulate(question: SimulateOptions, *, as_json: bool) -> None:
    """Answer `question`, campaign by campaign; what is finished stays when a later one is interrupted.

    Raises
    ------
    BadInput : a folder or a truth that cannot be written or would destroy what is there, or what the plans cannot be.
    CheckFailed : something on the table swings freely.
    """
    from validation.output import print_json

    _require_free(question)
    done = []
    for number, plan in enumerate(question.plans, start=1):
        one = _written(question, plan, f"{plan.article} ({number} of {len(question.plans)})", quiet=as_json)
        done.append(one)
        if not as_json:
            click.echo(page_of(one, question), nl=False)
    if as_json:
        print_json(summary_json(done, question))
    for one in done:
        instead = " in place of the virtual test that was there" if one.replaced else ""
        click.echo(f"massline: wrote {one.folder} and its truth {one.truth}{instead}.", err=True)


def _require_free(question: SimulateOptions) -> None:
    from validation.output import require_file, require_folder

    virtual_test_simulate.require_folder(question.out)
    require_folder(question.out, "--out")
    if question.sealed is not None:
        tried = require_file if len(question.plans) == 1 else require_folder
        tried(question.sealed, "--sealed")
    for plan in question.plans:
        virtual_test_simulate.require_free(question.folder(plan), question.truth(plan))


def _written(question: SimulateOptions, plan: Plan, words: str, *, quiet: bool) -> Written:
    from validation.virtual_test.simulate import simulate as simulated

    with percent(f"{words}: simulating", quiet=quiet) as progress:
        try:
            test = simulated(plan, progress)
        except BadInput as error:
            raise _of_rig(error) from None
    _require_alive(test.campaign)
    campaign, folder, truth = in_units(test.campaign, question.units), question.folder(plan), question.truth(plan)
    replaced = folder.exists() and any(folder.iterdir())
    with shown(f"{words}: writing {folder}", quiet=quiet):
        virtual_test_simulate.write(
            folder, truth, test.truth, lambda new: campaign_file.write(new, campaign, ending=question.ending)
        )
    campaign = replace(campaign, source=str(folder))
    return Written(plan=plan, campaign=campaign, test=test, folder=folder, truth=truth, replaced=replaced)


def _of_rig(error: BadInput) -> BadInput:
    """`error` of a rig that cannot be built, which only an effect can have done; others pass unchanged."""
    if error.source != "rig":
        return error
    return BadInput(source="--effect", field=error.field, problem=error.problem, remedy=error.remedy)


def _require_alive(campaign: Campaign) -> None:
    """Refuse records that no reader would take: without noise, what nothing moves stays at zero."""
    for run, recorded in campaign.recordings.items():
        for k, name in enumerate(recorded.names):
            try:
                require_alive(recorded.values[:, k], name, run)
            except BadInput:
                problem = (
                    f"without noise, hum and cross motion nothing moves {name} in the run {run}, and it reads zero throughout"
                )
                remedy = "A dead channel makes a campaign unusable: leave some noise (--noise 0.001) or cross motion"
                raise BadInput(source="--noise", problem=problem, remedy=remedy) from None


def in_units(campaign: Campaign, units: dict[str, str]) -> Campaign:
    """`campaign`, whose files will be in `units`, by quantity."""
    channels = tuple(replace(c, unit=units.get(c.quantity, c.unit)) for c in campaign.table.channels)
    return replace(campaign, table=replace(campaign.table, channels=channels))


# What `massline simulate` shows: the campaign as `massline check` would, and unless it is sealed what lies behind it.


def page_of(one: Written, question: SimulateOptions) -> str:
    """All of it as text."""
    from validation.report.document import page

    found = of_campaign(one.folder, one.campaign)
    shown = () if question.sealed else tuple(_behind(one, _planted(one, question)))
    notes = campaign.notes(found)[:-1]
    return page(campaign.title(found), (*campaign.grids(found), *shown), (*notes, *_notes(one, question)))


def summary_json(done: Sequence[Written], question: SimulateOptions) -> dict[str, Any]:
    """The same as one object; where it is sealed, nothing that was drawn or planted."""
    return {"campaigns": [_campaign(one, question) for one in done]}


def _campaign(one: Written, question: SimulateOptions) -> dict[str, Any]:
    found = {**to_json(of_campaign(one.folder, one.campaign)), "truth": str(one.truth)}
    return found if question.sealed else found | {"seed": one.plan.seed, "effects": [_effect(n) for n in _planted(one, question)]}


def _planted(one: Written, question: SimulateOptions) -> tuple[Named, ...]:
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
    lines = [(name, *(grid_number(v, 4) for key in keys for v in np.ravel(body[key]))) for name, body in bodies.items()]
    columns = list(zip(*lines, strict=True))
    return Grid(header=header, lines=tuple(zip(columns[0], *map(aligned, columns[1:]), strict=True)))


def _notes(one: Written, question: SimulateOptions) -> Iterator[str]:
    if question.sealed:
        yield f"Sealed: what was drawn and planted stands in {one.truth} alone."
        return
    yield f"Drawn from seed {one.plan.seed}: tests of the same seed share FMD, load cells and sensors, and so their errors."
    modes: Any = one.test.truth["modes"]
    if modes["frequency_hz"]:
        listed = ", ".join(f"{f:.2f}" for f in modes["frequency_hz"] if f <= 1.5 * one.plan.band[1])
        yield f"Modes of {one.plan.on_fmd} on a rigid base: {listed} Hz." if listed else "No mode lies near the band."
    yield f"Every figure that was drawn stands in {one.truth}, by the ids of the catalogue."
