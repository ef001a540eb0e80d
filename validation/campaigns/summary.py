"""What `massline check` finds out about a campaign, before anybody decides how it is shown."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from geometry.arrays import Array
from geometry.errors import BadInput
from geometry.observability import Observability
from identification import trust
from identification.campaign import Campaign, Processing
from identification.campaign_checks import observed
from identification.campaign_file import Progress, examine
from identification.closed_checks import Finding, of_spectra
from identification.self_consistency import REACH
from identification.spectra.of_campaign import spectra
from identification.survey import Levels, levels, noise_floors

LOUD = 1.5
"""How far above its stated noise floor a channel may read while nothing moves; beyond, it is said aloud."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Summary:
    """A campaign looked at.

    Attributes
    ----------
    folder : as it was named
    campaign : None where its description cannot be used
    problems : what makes the folder unusable as it is
    warnings : what is odd but leaves the data usable
    verdicts : which motions and resultants can be told, by what from what
    levels : by run, what the table did; runs without a level are left out
    noise : (c,) broadband rms of every channel in the quiet parts, in SI; None where there is none
    checks : what the channels say of each other, without a model; empty where that was not asked for or cannot be told
    """

    folder: str
    campaign: Campaign | None
    problems: tuple[BadInput, ...]
    warnings: tuple[str, ...]
    verdicts: Mapping[str, Observability]
    levels: Mapping[str, Levels]
    noise: Array | None
    checks: tuple[Finding, ...] = ()

    @property
    def usable(self) -> bool:
        """Whether nothing is wrong that a reader would refuse."""
        return self.campaign is not None and not self.problems


def summary(folder: str | Path, *, closed: bool = True, progress: Progress | None = None) -> Summary:
    """All about the campaign in `folder`; `closed` also holds its channels against each other.

    Raises
    ------
    OSError : a file cannot be read.
    """
    found = examine(folder, progress=progress)
    campaign = found.campaign
    if campaign is None:
        return Summary(
            folder=str(folder), campaign=None, problems=found.problems, warnings=(), verdicts={}, levels={}, noise=None
        )
    made = of_campaign(folder, campaign, found.problems)
    if not closed or found.problems:
        return made
    checks = _checked(campaign)
    said = (f"{campaign.source}: {text}" for text in trust.contradictions(checks))
    return replace(made, checks=checks, warnings=(*said, *made.warnings))


def _checked(campaign: Campaign) -> tuple[Finding, ...]:
    """The closed checks at the lowest lines; none where the campaign is too poor for them, which its verdicts say."""
    try:
        return of_spectra(spectra(campaign, band=_lowest(campaign)), gravity=campaign.gravity)
    except BadInput:
        return ()


def _lowest(campaign: Campaign) -> tuple[float, float]:
    """[Hz] of the lines that closed checks use."""
    lines = next(iter(campaign.recordings.values())).frequency
    start = (campaign.processing or Processing()).start if lines is None else float(lines[0])
    return start, REACH * start


def of_campaign(folder: str | Path, campaign: Campaign, problems: tuple[BadInput, ...] = ()) -> Summary:
    """All about a `campaign` that lies, or will lie, in `folder`."""
    noise = noise_floors(campaign)
    known = {name: level for name, one in campaign.recordings.items() if (level := levels(one, campaign.table)) is not None}
    return Summary(
        folder=str(folder),
        campaign=campaign,
        problems=problems,
        warnings=(*campaign.warnings, *_loud(campaign, noise)),
        verdicts=observed(campaign.table),
        levels=known,
        noise=noise,
    )


def _loud(campaign: Campaign, noise: Array | None) -> list[str]:
    if noise is None:
        return []
    return [
        f"{campaign.source}: {channel.name} reads {floor / channel.noise_rms:.1f} times its stated noise_rms while nothing "
        "moves; check cable and range, or correct noise_rms"
        for channel, floor in zip(campaign.table.channels, noise, strict=True)
        if channel.noise_rms and floor > LOUD * channel.noise_rms
    ]
