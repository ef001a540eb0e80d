"""Where a report of the workbench comes from: the user's own files and the command line, never the folders of a desk.

A desk is deleted when its window closes, and a report is signed and kept. So it names the files that the user named, files that
a browser handed over by the names under which it gave them, and the effects that the user's own model has not.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from geometry.errors import BadInput
from validation.comparing.asked import Asked as Compared
from validation.desk.desk import Desk
from validation.desk.handed import GIVEN
from validation.desk.saving import model_text
from validation.models import reading
from validation.models.model import Model
from validation.report.nouns import CampaignPart, Provenance, Report
from validation.report.run import Asked, command_line, provenance

ADDED = "effects added in the workbench"


def signed(of: Desk, model: Model, *, diagnosed: bool) -> Provenance:
    """The provenance of a report on the `model` of the desk.

    Raises
    ------
    BadInput : the working copy is gone.
    OSError : a file cannot be read.
    """
    asked = of.asked
    there = asked.model if Path(asked.model).is_file() else str(of.model)
    question = Compared(model=there, data=asked.data, hold_out=asked.hold_out, band=asked.band, method=asked.method)
    made = provenance(Asked(compared=question, diagnosis=diagnosed))
    typed = replace(
        question,
        model=given(of, asked.model),
        data=tuple(given(of, path) for path in asked.data),
        hold_out=tuple(given(of, name) for name in asked.hold_out),
    )
    return replace(
        made,
        command=command_line(typed, effects_from=asked.effects_from, diagnosis=diagnosed),
        inputs=tuple(replace(one, path=given(of, one.path)) for one in made.inputs),
        settings={**made.settings, "held out": typed.hold_out or made.settings["held out"], ADDED: _added(of, model)},
        model_text=model_text(of),
    )


def as_given(of: Desk, report: Report) -> Report:
    """`report` with the user's own paths for model and campaigns."""
    comparison = replace(report.comparison, source=given(of, of.asked.model))
    return replace(report, comparison=comparison, campaigns=tuple(_campaign(of, one) for one in report.campaigns))


def given(of: Desk, path: str) -> str:
    """`path` as the user knows it: of a file that a browser handed over, the name that it had there."""
    try:
        _, folder, *names = Path(path).relative_to(of.folder.parent).parts
    except ValueError:
        return path
    return path if folder != GIVEN else "/".join(names) or "."


def _campaign(of: Desk, one: CampaignPart) -> CampaignPart:
    source = one.campaign.source
    shown = given(of, source)
    return replace(one, campaign=replace(one.campaign, source=shown), command=one.command.replace(source, shown))


def _added(of: Desk, model: Model) -> tuple[str, ...]:
    """Identifiers of the effects that the user's own model file has not."""
    try:
        own = {one.named.id for one in reading.read(of.asked.model).effects}
    except (BadInput, OSError):
        own = set()
    return tuple(one.named.id for one in model.effects if one.named.id not in own)
