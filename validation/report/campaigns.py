"""What is known of a campaign by itself: the map of its sensors, and the inertia that is identified from it without any model."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from geometry.errors import BadInput, CheckFailed
from geometry.frames import Pose
from identification.campaign import Campaign
from validation.article_reference import Asked as Drawn
from validation.article_reference import is_stack, reference
from validation.campaigns.sensor_map import draw
from validation.identifying.asked import Asked
from validation.identifying.findings import Findings
from validation.identifying.known import FMD, above_fmd, stated
from validation.identifying.run import identified
from validation.models.model import Model
from validation.report.articles import drawing_of, drawn
from validation.report.nouns import CampaignPart, Picture
from validation.statement import Statement

KNOWN = ("cuboid", "disc")
"""Parts that are known well enough to tell the FMD by: a campaign of nothing else is the tare of the others."""


NOT_MOUNTED = (
    "the result is seen from F and the drawing from its own origin, and campaign.toml has no [mounting] that says how the "
    "article stands; state it, and both are compared"
)


def campaign_part(
    one: Campaign, series: Sequence[Campaign], model: Model, band: tuple[float, float] | None, method: str
) -> CampaignPart:
    """What is known of the campaign `one` of a `series`; its tare is a campaign of the series whose article is known."""
    missing: list[str] = []
    tares = tuple(other.source for other in series if other is not one and is_tare(other) and not is_tare(one))
    asked = Asked(campaign=one.source, tares=tares, band=band, spectra=method, study=False)
    findings = _findings(asked, missing)
    return CampaignPart(
        campaign=one,
        sensors=_sensors(one, missing),
        findings=findings,
        reference=None if findings is None else _reference(findings, model, missing),
        command=command(asked),
        missing=tuple(missing),
    )


def is_tare(one: Campaign) -> bool:
    """Whether nothing but known parts stand on the FMD."""
    parts = above_fmd(one.article).split("+")
    return bool(parts) and set(parts) <= set(KNOWN)


def command(asked: Asked) -> str:
    """The command line that gives the same findings."""
    band = [] if asked.band is None else ["--band", *(f"{one:g}" for one in asked.band)]
    tares = [word for tare in asked.tares for word in ("--tare", tare)]
    return " ".join(["massline identify", asked.campaign, *tares, *band, "--spectra", asked.spectra, "--no-study"])


def _findings(asked: Asked, missing: list[str]) -> Findings | None:
    try:
        return identified(asked)
    except (BadInput, CheckFailed) as error:
        missing.append(f"No inertia was identified: {error}")
        return None


def _sensors(one: Campaign, missing: list[str]) -> Picture | None:
    said = f"Sensors of {Path(one.source).name}, seen from F: accelerometers of table, cover plate and article, and load cells"
    try:
        return drawn(lambda folder: draw(one, folder), said)
    except CheckFailed as error:
        missing.append(f"No map of the sensors: {error}")
        return None


def _reference(found: Findings, model: Model, missing: list[str]) -> Statement | None:
    """Of what was identified, as it is drawn, in the frame of the result.

    None where no drawing is known, with an FMD that the model knows otherwise, and where nothing says how the article stands.
    """
    if found.article.split("+")[0] == FMD and model.fmd is not None:
        return None
    source = drawing_of(found.article, model)
    if not source:
        return None
    frame = _frame(found)
    if frame is None:
        missing.append(f"Nothing is held against the drawing of {found.article}: {NOT_MOUNTED}")
        return None
    changes = model.changes if is_stack(found.article) else {}
    try:
        return reference(source, None, Drawn(changes=changes), frame)[1]
    except (BadInput, CheckFailed):
        return None


def _frame(found: Findings) -> Pose | None:
    """That of the result, seen from the drawing's; None where nobody stated it. The frame of a stack from the FMD up is F's."""
    if found.origin != "F" or found.article.split("+")[0] == FMD:
        return Pose()
    mount = stated(found.request.campaign)
    return None if mount is None else mount.inverse
