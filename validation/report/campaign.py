"""The page of `massline check`: channels, runs, levels, what can be told, and what is wrong."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.inertia import Observability
from geometry.sensors import SI, Channel, Place
from identification.campaign import Campaign, Levels, Recording, Run
from validation.identify.check import Summary
from validation.reference.statement import NONE
from validation.report.document import Grid

AXES = ("x", "y", "z", "α", "β", "γ")
LEVEL_UNITS = ("m/s²", "m/s²", "m/s²", "rad/s²", "rad/s²", "rad/s²")


def title(summary: Summary) -> str:
    """Title and article of the campaign, or its folder."""
    return summary.folder if summary.campaign is None else f"{summary.campaign.title}: {summary.campaign.article}"


def grids(summary: Summary) -> list[Grid]:
    """All tables, in the order in which they are read."""
    if summary.campaign is None:
        return []
    return [
        _channels(summary.campaign, summary),
        _runs(summary.campaign, summary),
        *([_levels(summary.campaign, summary)] if summary.levels else []),
        _verdicts(summary),
    ]


def notes(summary: Summary) -> list[str]:
    """What must be known to read the tables, then what is odd, then what is wrong."""
    campaign = summary.campaign
    about = [] if campaign is None else list(_about(campaign, summary))
    warnings = [f"warning: {text}." for text in summary.warnings]
    return [
        *about,
        *warnings,
        *(f"problem {k}: {problem}" for k, problem in enumerate(summary.problems, start=1)),
        verdict(summary),
    ]


def verdict(summary: Summary) -> str:
    """The end of the page in a sentence."""
    if not summary.usable:
        many = "1 problem" if len(summary.problems) == 1 else f"{len(summary.problems)} problems"
        return f"{summary.folder} cannot be used as it is: {many}."
    if summary.warnings:
        return f"{summary.folder} can be used; read the warnings first."
    return f"{summary.folder} can be used: nothing is wrong with it."


def _channels(campaign: Campaign, summary: Summary) -> Grid:
    noise = [None] * len(campaign.table) if summary.noise is None else summary.noise.tolist()
    lines = [
        (
            channel.name,
            channel.group,
            channel.unit,
            _places(channel, campaign),
            _direction(channel.places[0]),
            f"{_figure(channel.noise_rms)} {SI[channel.quantity]}" if channel.noise_rms is not None else NONE,
            f"{_figure(floor)} {SI[channel.quantity]}" if floor is not None else NONE,
            ", ".join(_remarks(channel)) or NONE,
        )
        for channel, floor in zip(campaign.table.channels, noise, strict=True)
    ]
    header = ("channel", "group", "in files", "at, from F [mm]", "along", "noise stated", "noise found", "remarks")
    return Grid(header=header, lines=tuple(lines), words=True)


def _places(channel: Channel, campaign: Campaign) -> str:
    return " + ".join(_point(place, campaign) for place in channel.places)


def _point(place: Place, campaign: Campaign) -> str:
    return "(" + ", ".join(f"{1e3 * value + 0.0:.5g}" for value in place.position - campaign.table.origin) + ")"


def _direction(place: Place) -> str:
    """``+x`` along an axis, else the components."""
    largest = max(range(3), key=lambda k: abs(place.direction[k]))
    if abs(place.direction[largest]) > 1 - 1e-9:
        return f"{'+' if place.direction[largest] > 0 else '-'}{'xyz'[largest]}"
    return "(" + ", ".join(f"{value + 0.0:.4g}" for value in place.direction) + ")"


def _remarks(channel: Channel) -> Iterable[str]:
    if channel.quantity == "moment":
        yield "moment"
    if channel.is_sum:
        yield f"sum of {len(channel.places)}"
    if channel.reference:
        yield "reference"
    if channel.quantity == "acceleration" and not channel.senses_gravity:
        yield "kinematic"


def _runs(campaign: Campaign, summary: Summary) -> Grid:
    lines = [
        (run.name, run.file, run.axis or "several", *_axis(campaign.recordings.get(run.name)), driven, _excitation(run))
        for run in campaign.runs
        for driven in [f"{summary.levels[run.name].driven:.1f} s" if run.name in summary.levels else NONE]
    ]
    header = ("run", "file", "axis", "rate or lines", "length", "driven for", "excitation")
    return Grid(header=header, lines=tuple(lines), words=True)


def _excitation(run: Run) -> str:
    if run.excitation is None:
        return NONE
    start, stop, rate, level = (run.excitation.figure(key) for key in ("start_hz", "stop_hz", "octaves_per_minute", "level"))
    band = f" {start:g}-{stop:g} Hz" if start is not None and stop is not None else ""
    return f"{run.excitation.kind}{band}{_if(rate, ', {:g} oct/min')}{_if(level, ', level {:g}')}"


def _if(value: float | None, text: str) -> str:
    return "" if value is None else text.format(value)


def _axis(recorded: Recording | None) -> tuple[str, str]:
    if recorded is None:
        return "not read", NONE
    if recorded.frequency is not None:
        return f"{recorded.frequency[0]:g}-{recorded.frequency[-1]:g} Hz", f"{len(recorded)} lines"
    return f"{recorded.sampling_rate:g} Hz", f"{recorded.duration:.1f} s"


def _levels(campaign: Campaign, summary: Summary) -> Grid:
    lines = []
    for run in campaign.runs:
        found = summary.levels.get(run.name)
        if found is not None:
            figures = (f"{value:.3f} ({100 * share:.1f} %)" for value, share in zip(found.amplitude, found.share, strict=True))
            asked = run.excitation.figure("level") if run.excitation else None
            lines.append((run.name, NONE if asked is None else f"{asked:g}", *figures))
    units = (f"{axis} [{unit}]" for axis, unit in zip(AXES, LEVEL_UNITS, strict=True))
    return Grid(header=("level realised", "asked", *units), lines=tuple(lines))


def _verdicts(summary: Summary) -> Grid:
    lines = [
        (
            what,
            str(len(one.channels)),
            f"{one.rank} of 6",
            f"{one.condition:.3g}" if one.complete else NONE,
            f"{1e3 * one.lever:.0f} mm" if one.channels else NONE,
            ", ".join(one.missing) or "nothing",
        )
        for what, one in summary.verdicts.items()
    ]
    return Grid(header=("can be told", "channels", "rank", "condition", "scaled by", "missing"), lines=tuple(lines), words=True)


def _about(campaign: Campaign, summary: Summary) -> Iterable[str]:
    yield f"Hardware: {campaign.hardware or 'not stated, so no other campaign can be combined with this one unseen'}."
    yield f"Gravity {campaign.gravity:g} m/s². {_mounting(campaign)}"
    if campaign.processing is not None:
        of = campaign.processing
        blocks = f", blocks of {of.block_size}, overlap {of.overlap:g}" if of.method == "peak-reference-hold" else ""
        yield f"Processing asked for: {of.method}{blocks}, {of.start:g} to {of.stop:g} Hz in steps of {of.step:g} Hz."
    if summary.levels:
        named = ", ".join(MOTIONS)
        yield (
            f"Levels: sqrt(2) times the rms of the base motion ({named} about F, by Eqs. 6 and 7) while it was driven; in "
            "brackets the share of the run's largest, each axis divided by its nominal level."
        )
    if summary.noise is not None:
        yield "Noise found: broadband rms in the parts of the runs in which table and cover plate stand still."
    yield "Condition: rotations and moments divided by the mean distance of the places from F, which stands beside it."


def _mounting(campaign: Campaign) -> str:
    if campaign.mounting is None:
        return "No mounting pose is stated: a CoG can be given from F only."
    x, y, z = (f"{1e3 * value + 0.0:.5g}" for value in campaign.mounting.position)
    return f"The top article's origin sits at ({x}, {y}, {z}) mm."


def _figure(value: float | None) -> str:
    return NONE if value is None else f"{value:.3g}"


# What `massline check --json` prints. Keys end in their unit; positions are in the campaign's own frame.


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
    return found | {"problems": [_problem(one) for one in summary.problems], "warnings": list(summary.warnings)}


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
