"""What `massline check` finds out about a campaign, before anybody decides how it is shown."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from geometry.errors import BadInput
from geometry.frames import Array
from geometry.inertia import Observability
from identification.campaign import Campaign, Levels, levels, noise_floors, observed, problems_of_runs, warnings_of_runs
from identification.campaign_file import Progress, examine
from identification.consistency import of_spectra
from identification.spectra.of_campaign import spectra

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
    """

    folder: str
    campaign: Campaign | None
    problems: tuple[BadInput, ...]
    warnings: tuple[str, ...]
    verdicts: Mapping[str, Observability]
    levels: Mapping[str, Levels]
    noise: Array | None

    @property
    def usable(self) -> bool:
        """Whether nothing is wrong that a reader would refuse."""
        return self.campaign is not None and not self.problems


def summary(folder: str | Path, *, progress: Progress | None = None) -> Summary:
    """All about the campaign in `folder`.

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
    seen = of_campaign(folder, campaign, found.problems)
    if not seen.usable:
        return seen
    try:
        checks = of_spectra(spectra(campaign), gravity=campaign.gravity)
    except BadInput:  # no line to look at: that is for whoever wants a result
        return seen
    # Channels that contradict each other, and which are suspected
    contradictions = [f"{campaign.source}: {one.text}" for one in checks if not one.holds]
    return replace(seen, warnings=(*seen.warnings, *contradictions))


def of_campaign(folder: str | Path, campaign: Campaign, problems: tuple[BadInput, ...] = ()) -> Summary:
    """All about a `campaign` that lies, or will lie, in `folder`."""
    noise = noise_floors(campaign)
    known = {name: level for name, one in campaign.recordings.items() if (level := levels(one, campaign.table)) is not None}
    if noise is None:
        loud: list[str] = []
    else:
        loud = [
            f"{campaign.source}: {channel.name} reads {floor / channel.noise_rms:.1f} times its stated noise_rms while nothing "
            "moves; check cable and range, or correct noise_rms"
            for channel, floor in zip(campaign.table.channels, noise, strict=True)
            if channel.noise_rms and floor > LOUD * channel.noise_rms
        ]
    return Summary(
        folder=str(folder),
        campaign=campaign,
        problems=(*problems, *([] if problems else problems_of_runs(campaign))),
        warnings=(*campaign.warnings, *warnings_of_runs(campaign), *loud),
        verdicts=observed(campaign.table),
        levels=known,
        noise=noise,
    )
