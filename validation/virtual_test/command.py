"""The run of `massline simulate`: simulate, write campaign and truth, print what they hold."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import click

from geometry.errors import BadInput
from identification import campaign_file
from identification.campaign import Campaign
from identification.soundness import require_alive
from validation.progress import percent, shown
from validation.virtual_test import folders
from validation.virtual_test.asked import Question
from validation.virtual_test.plan import Plan
from validation.virtual_test.simulate import VirtualTest


@dataclass(frozen=True, eq=False, kw_only=True)
class Written:
    """A virtual test that was written: as its file states it, where it lies and its truth, and whether it replaced another."""

    plan: Plan
    campaign: Campaign
    test: VirtualTest
    folder: Path
    truth: Path
    replaced: bool


def simulate(question: Question, *, as_json: bool) -> None:
    """Answer `question`, campaign by campaign; what is finished stays when a later one is interrupted.

    Raises
    ------
    BadInput : a folder or a truth that cannot be written or would destroy what is there, or what the plans cannot be.
    CheckFailed : something on the table swings freely.
    """
    from validation.output import print_json
    from validation.virtual_test import summary

    _require_free(question)
    done = []
    for number, plan in enumerate(question.plans, start=1):
        one = _written(question, plan, f"{plan.article} ({number} of {len(question.plans)})", quiet=as_json)
        done.append(one)
        if not as_json:
            click.echo(summary.page_of(one, question), nl=False)
    if as_json:
        print_json(summary.as_json(done, question))
    for one in done:
        instead = " in place of the virtual test that was there" if one.replaced else ""
        click.echo(f"massline: wrote {one.folder} and its truth {one.truth}{instead}.", err=True)


def _require_free(question: Question) -> None:
    from validation.output import require_file, require_folder

    folders.require_folder(question.out)
    require_folder(question.out, "--out")
    if question.sealed is not None:
        tried = require_file if len(question.plans) == 1 else require_folder
        tried(question.sealed, "--sealed")
    for plan in question.plans:
        folders.require_free(question.folder(plan), question.truth(plan))


def _written(question: Question, plan: Plan, words: str, *, quiet: bool) -> Written:
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
        folders.write(folder, truth, test.truth, lambda new: campaign_file.write(new, campaign, ending=question.ending))
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
