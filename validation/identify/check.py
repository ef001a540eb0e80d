"""What `massline check` finds out about a campaign, before anybody decides how it is shown."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from geometry.errors import BadInput
from geometry.frames import Array
from geometry.inertia import Observability
from geometry.sensors import Channel
from identification import campaign as campaigns
from identification.campaign import levels
from identification.campaign_file import Progress, examine
from identification.consistency import of_spectra
from identification.spectra.noise import densities
from identification.spectra.of_campaign import spectra
from validation.output import derived, entry, unwritten

LOUD = 1.5
"""How far above its stated noise floor a channel may read while nothing moves; beyond, it is said aloud."""

TONE = 0.5
"""[share] of that near one frequency, from which it is a tone, as of the mains, and not noise. Held by test_check_command.py."""

SIX = 6
"""Base motions, and so the fewest runs from which a dynamic mass is measured."""


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

    folder: str = entry("campaign")
    campaign: campaigns.Campaign | None = unwritten()
    levels: Mapping[str, campaigns.Levels] = unwritten()
    noise: Array | None = unwritten()
    verdicts: Mapping[str, Observability] = unwritten()
    problems: tuple[BadInput, ...] = entry(
        write=lambda problems: [
            {"file": one.source, "field": one.field, "problem": one.problem, "remedy": one.remedy} for one in problems
        ]
    )
    warnings: tuple[str, ...]

    @property
    @derived("usable", before="problems")
    def usable(self) -> bool:
        """Whether nothing is wrong that a reader would refuse."""
        return self.campaign is not None and not self.problems

    @property
    @derived("", before="problems")
    def contents(self) -> dict[str, Any]:
        """What the campaign is and has, by its keys in JSON; positions are in its own frame. Nothing without a campaign."""
        of = self.campaign
        if of is None:
            return {}
        noise = [None] * len(of.table) if self.noise is None else list(self.noise)
        return {
            "title": of.title,
            "article": of.article,
            "hardware": of.hardware,
            "gravity_m_s2": of.gravity,
            "origin_m": of.table.origin,
            "mounting_origin_m": None if of.mounting is None else of.mounting.position,
            "channels": [_channel(*one) for one in zip(of.table.channels, noise, strict=True)],
            "runs": [_run(one, of.recordings.get(one.name), self.levels.get(one.name)) for one in of.runs],
            "observability": {
                what: {
                    "channels": one.channels,
                    "rank": one.rank,
                    "condition": one.condition if one.complete else None,
                    "lever_m": one.lever,
                    "missing": one.missing,
                    "text": one.text,
                }
                for what, one in self.verdicts.items()
            },
        }


UNIT_KEYS = {"acceleration": "noise_m_s2", "force": "noise_n", "moment": "noise_n_m"}
"""Key of a noise floor, by quantity."""


def _channel(channel: Channel, noise: float | None) -> dict[str, Any]:
    key = UNIT_KEYS[channel.quantity]
    return {
        "name": channel.name,
        "quantity": channel.quantity,
        "group": channel.group,
        "unit_in_files": channel.unit,
        "position_m": [place.position for place in channel.places],
        "direction": [place.direction for place in channel.places],
        "reference": channel.reference,
        "senses_gravity": channel.senses_gravity,
        f"{key}_stated": channel.noise_rms,
        f"{key}_found": noise,
    }


def _run(run: campaigns.Run, recorded: campaigns.Recording | None, level: campaigns.Levels | None) -> dict[str, Any]:
    return {
        "name": run.name,
        "file": run.file,
        "axis": run.axis or None,
        "excitation": None if run.excitation is None else {"kind": run.excitation.kind, **run.excitation.figures},
        "read": recorded is not None,
        "sampling_rate_hz": None if recorded is None else recorded.sampling_rate,
        "samples": None if recorded is None else len(recorded),
        "duration_s": None if recorded is None or recorded.is_spectrum else recorded.duration,
        "level_m_s2_rad_s2": None if level is None else level.amplitude,
        "level_share": None if level is None else level.share,
        "driven_s": None if level is None else level.driven,
    }


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
        closed = of_spectra(spectra(campaign), gravity=campaign.gravity)
    except BadInput:  # no line to look at: that is for whoever wants a result
        return seen
    contradictions = (f"{campaign.source}: {one.text}" for one in closed if not one.holds)
    return replace(seen, warnings=(*seen.warnings, *contradictions))


def of_campaign(folder: str | Path, campaign: campaigns.Campaign, problems: tuple[BadInput, ...] = ()) -> Summary:
    """All about a `campaign` that lies, or will lie, in `folder`."""
    noise = campaigns.noise_floors(campaign)
    known = {name: level for name, one in campaign.recordings.items() if (level := levels(one, campaign.table)) is not None}
    floors = zip(campaign.table.channels, () if noise is None else noise, strict=noise is not None)
    # An article rings on where table and cover plate stand still
    still = [(channel, floor) for channel, floor in floors if channel.noise_rms and channel.group != "article"]
    ratios = {channel.name: floor / channel.noise_rms for channel, floor in still if channel.noise_rms}
    loud = {name: ratio for name, ratio in ratios.items() if ratio > LOUD}
    warnings = (*campaign.warnings, *campaigns.warnings_of_runs(campaign))
    if loud:
        worst = max(loud, key=lambda name: loud[name])
        which = f"{worst} reads" if len(loud) == 1 else f"{len(loud)} of {len(ratios)} channels read up to"
        most = "" if len(loud) == 1 else f", {worst} most"
        said = f"{which} {loud[worst]:.1f} times the stated noise_rms while nothing moves{most}"
        at, share = (0.0, 0.0) if (of := densities(campaign)[0]) is None else of.tone(campaign.table.names.index(worst))
        tone = f", {100 * share:.0f} % of it a tone at {at:g} Hz" if share > TONE else ""
        remedy = "check cable, screen and earth" if tone else "check cable and range"
        warnings += (f"{campaign.source}: {said}{tone}; {remedy}, or correct noise_rms",)
    wrong = [] if problems else campaigns.problems_of_runs(campaign)
    if len(campaign.runs) < SIX:
        seen = "no dynamic mass is measured, so that `identify` refuses it; `compare` and `diagnose` use the runs that there are"
        warnings += tuple(f"{campaign.source}: {one.problem}: {seen}" for one in wrong)
        wrong = []
    return Summary(
        folder=str(folder),
        campaign=campaign,
        problems=(*problems, *wrong),
        warnings=tuple(dict.fromkeys(warnings)),
        verdicts=campaigns.observed(campaign.table),
        levels=known,
        noise=noise,
    )
