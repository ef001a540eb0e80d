"""What the runs of a campaign drive together: six motions that are told apart, and no run that is another one once more."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.observability import of_motions
from geometry.sensors import ChannelTable, motion_rows
from identification.campaign import Campaign
from identification.campaign_checks import RIGID_GROUPS
from identification.recording import Recording
from identification.survey import NOMINAL, levels

UNDRIVEN = 0.15
"""Share of the largest motion of a run, every axis by its nominal level, below which a run does not drive an axis: cross
motion of real tables stays below."""

SAME = 1e-6
"""Relative difference below which two recordings are one: a copy, or an export of it with fewer digits. Noise is far above."""


def problems_of_runs(campaign: Campaign) -> list[BadInput]:
    """Why six base motions cannot be told from the runs: too few of them, or an axis that none drives."""
    driven = {name: share for name, one in campaign.recordings.items() if (share := shares(one, campaign.table)) is not None}
    words = _undriven(campaign, driven)
    if len(campaign.runs) < 6:
        many = "1 run" if len(campaign.runs) == 1 else f"{len(campaign.runs)} runs"
        words = f"six base motions take at least six runs, found {many}{f'; {words}' if words else ''}"
    if not words:
        return []
    alike = "".join(f"; {text}" for text in _copies(campaign))
    remedy = "Record a run that drives each axis, or correct which file belongs to which run"
    return [BadInput(source=campaign.source, field="run", problem=words + alike, remedy=remedy)]


def warnings_of_runs(campaign: Campaign) -> tuple[str, ...]:
    """Runs that are one and the same, and runs that drive another axis than they say."""
    return tuple(f"{campaign.source}: {text}" for text in (*_copies(campaign), *_misnamed(campaign)))


def shares(recorded: Recording, table: ChannelTable) -> Array | None:
    """(6,) every base motion of a run as a share of its largest, each by its nominal level; None where it cannot be told."""
    if not recorded.is_spectrum:
        found = levels(recorded, table)
        return None if found is None else found.share
    for groups in (("cover",), RIGID_GROUPS):
        if of_motions(table, groups).complete:
            chosen = table.select(group=groups, quantity="acceleration")
            rows = motion_rows([table.channels[k] for k in chosen], table.origin)
            size = np.sqrt(np.mean(np.square(np.abs(recorded.values[:, chosen] @ np.linalg.pinv(rows).T)), axis=0)) / NOMINAL
            return np.asarray(size / max(size.max(), np.finfo(np.float64).tiny))
    return None


def _undriven(campaign: Campaign, driven: dict[str, Array]) -> str:
    """The axes that no run drives, in words; by what the runs say they drive where their motion cannot be told."""
    if len(driven) == len(campaign.runs) and driven:
        most = np.max(list(driven.values()), axis=0)
        missing = [axis for axis, share in zip(MOTIONS, most, strict=True) if share < UNDRIVEN]
    else:
        said = {run.axis for run in campaign.runs}
        missing = [] if "" in said else [axis for axis in MOTIONS if axis not in said]
    return f"no run drives {' or '.join(missing)}" if missing else ""


def _copies(campaign: Campaign) -> list[str]:
    return [
        f"runs {a} and {b} are the same recording"
        for (a, one), (b, other) in combinations(campaign.recordings.items(), 2)
        if one.values.shape == other.values.shape and _same(one, other)
    ]


def _same(one: Recording, other: Recording) -> bool:
    first = slice(None, None, max(len(one) // 100, 1))  # nearly every pair differs in a hundred samples
    return all(
        np.linalg.norm(one.values[at] - other.values[at]) <= SAME * np.linalg.norm(one.values[at]) for at in (first, slice(None))
    )


def _misnamed(campaign: Campaign) -> list[str]:
    found = []
    for run in campaign.runs:
        recorded = campaign.recordings.get(run.name)
        share = None if recorded is None or not run.axis else shares(recorded, campaign.table)
        if share is not None and share[MOTIONS.index(run.axis)] < UNDRIVEN:
            most = MOTIONS[int(np.argmax(share))]
            found.append(f"run {run.name} says that it drives {run.axis}, but it drives {most}")
    return found
