"""What `massline check --json` prints. Keys end in their unit; positions are in the campaign's own frame."""

from __future__ import annotations

from typing import Any

from geometry.errors import BadInput
from geometry.observability import Observability
from geometry.sensors import Channel
from identification.campaign import Campaign, Run
from identification.closed_checks import Finding
from identification.recording import Recording
from identification.survey import Levels
from validation.campaigns.summary import Summary

UNIT_KEYS = {"acceleration": "noise_m_s2", "force": "noise_n", "moment": "noise_n_m"}
"""Key of a noise floor, by quantity."""


def as_json(summary: Summary) -> dict[str, Any]:
    """The summary as one object."""
    campaign = summary.campaign
    found: dict[str, Any] = {"campaign": summary.folder, "usable": summary.usable}
    if campaign is not None:
        found |= _description(campaign) | {
            "channels": [_channel(c, k, summary) for k, c in enumerate(campaign.table.channels)],
            "runs": [_run(run, campaign.recordings.get(run.name), summary.levels.get(run.name)) for run in campaign.runs],
            "observability": {what: _verdict(one) for what, one in summary.verdicts.items()},
        }
    found["checks"] = [check(one) for one in summary.checks]
    return found | {"problems": [_problem(one) for one in summary.problems], "warnings": list(summary.warnings)}


def check(one: Finding) -> dict[str, Any]:
    """A closed check."""
    suspects = [
        {"effects": [name for mistake in suspect.mistakes for name in mistake.identifiers], "text": suspect.text}
        for suspect in one.suspects
    ]
    return {"name": one.name, "holds": one.holds, "tolerances": one.value, "text": one.text, "suspects": suspects}


def _description(campaign: Campaign) -> dict[str, Any]:
    return {
        "title": campaign.title,
        "article": campaign.article,
        "hardware": campaign.hardware,
        "gravity_m_s2": campaign.gravity,
        "origin_m": campaign.table.origin.tolist(),
        "mounting_origin_m": None if campaign.mounting is None else campaign.mounting.position.tolist(),
    }


def _channel(channel: Channel, k: int, summary: Summary) -> dict[str, Any]:
    key = UNIT_KEYS[channel.quantity]
    return {
        "name": channel.name,
        "quantity": channel.quantity,
        "group": channel.group,
        "unit_in_files": channel.unit,
        "position_m": [place.position.tolist() for place in channel.places],
        "direction": [place.direction.tolist() for place in channel.places],
        "reference": channel.reference,
        "senses_gravity": channel.senses_gravity,
        f"{key}_stated": channel.noise_rms,
        f"{key}_found": None if summary.noise is None else float(summary.noise[k]),
    }


def _run(run: Run, recorded: Recording | None, level: Levels | None) -> dict[str, Any]:
    return {
        "name": run.name,
        "file": run.file,
        "axis": run.axis or None,
        "excitation": None if run.excitation is None else {"kind": run.excitation.kind, **run.excitation.figures},
        "read": recorded is not None,
        "sampling_rate_hz": None if recorded is None else recorded.sampling_rate,
        "samples": None if recorded is None else len(recorded),
        "duration_s": None if recorded is None or recorded.is_spectrum else recorded.duration,
        "level_m_s2_rad_s2": None if level is None else level.amplitude.tolist(),
        "level_share": None if level is None else level.share.tolist(),
        "driven_s": None if level is None else level.driven,
    }


def _verdict(one: Observability) -> dict[str, Any]:
    return {
        "channels": list(one.channels),
        "rank": one.rank,
        "condition": one.condition if one.complete else None,
        "lever_m": one.lever,
        "missing": list(one.missing),
        "text": one.text,
    }


def _problem(one: BadInput) -> dict[str, str]:
    return {"file": one.source, "field": one.field, "problem": one.problem, "remedy": one.remedy}
