"""Which lines of a campaign its runs drive: a line that a run does not drive holds noise, and no model is judged by noise.

A run says what it drives, or its level does. Only lines that every run drives are kept, since all runs share one grid.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.errors import BadInput
from identification.campaign import Campaign, Run
from identification.spectra.line_spectra import Spectra
from identification.spectra.of_campaign import SAME_LINE, grid

WELL_ABOVE = 10.0
"""Level over known noise of the channel that sees most, from which a line is driven. Of 22 channels of pure noise the largest
reaches about 3 at the worst of a thousand lines."""

Chosen = npt.NDArray[np.bool_]

OTHERWISE = "--band decides otherwise"


def stated(campaign: Campaign) -> tuple[float, float] | None:
    """(low, high) [Hz] that all runs that state what they drive have in common; None where none does.

    Raises
    ------
    BadInput : they have no line in common.
    """
    ends = {run.name: found for run in campaign.runs if (found := _ends(run)) is not None}
    if not ends:
        return None
    low, high = max(of[0] for of in ends.values()), min(of[1] for of in ends.values())
    lines = lines_of(campaign)
    if not low < high or not np.any(_between(lines, low, high)):
        said = ", ".join(f"{name} drives {of[0]:g} to {of[1]:g} Hz" for name, of in ends.items())
        raise BadInput(
            source=campaign.source,
            field="run.excitation",
            problem=f"all runs together drive none of the lines from {lines[0]:g} to {lines[-1]:g} Hz: {said}",
            remedy="Correct start_hz and stop_hz, or choose the lines with --band LOW HIGH",
        )
    return low, high


def outside(campaign: Campaign, band: tuple[float, float] | None) -> tuple[str, ...]:
    """A sentence about the lines that `stated` leaves out; none where it leaves out none."""
    lines = lines_of(campaign)
    if band is None or (left := int(np.sum(~_between(lines, *band)))) == 0:
        return ()
    low, high = band
    of = f"{left} of the {len(lines)} lines of {campaign.source}, {lines[0]:g} to {lines[-1]:g} Hz, are left out"
    return (f"{of}: all of its runs together drive {low:g} to {high:g} Hz, as they state; {OTHERWISE}",)


def by_level(campaign: Campaign, found: Spectra, groups: Sequence[Sequence[int]]) -> tuple[Chosen, tuple[str, ...]]:
    """(n,) lines of `found` that stand well above the noise in every run that states nothing, and what is to be said.

    Parameters
    ----------
    groups : columns of channels, in each of which the line must show: forces, accelerations
    """
    silent = [k for k, run in enumerate(campaign.runs) if _ends(run) is None]
    every = np.ones(len(found.frequency), dtype=bool)
    if not silent:
        return every, ()
    loud = np.all([_above(found, silent, columns) for columns in groups if len(columns)], axis=(0, 1))
    names = _some([campaign.runs[k].name for k in silent])
    if not np.any(loud):
        said = f"no line stands {WELL_ABOVE:g} times above the noise in every run, and {names} state nothing of what they drive"
        return every, (f"of {campaign.source} all lines are kept: {said}",)
    if np.all(loud):
        return every, ()
    kept = found.frequency[loud]
    which = f"{int(np.sum(~loud))} of {len(loud)} lines of {campaign.source}"
    left = f"{which} are left out, {kept[0]:g} to {kept[-1]:g} Hz remain"
    why = f"there the level is below {WELL_ABOVE:g} times the noise in {names}, which state nothing of what they drive"
    return loud, (f"{left}: {why}; {OTHERWISE}",)


def lines_of(campaign: Campaign) -> Array:
    """(n,) [Hz] of the files, or those of the campaign's processing."""
    recorded = next(iter(campaign.recordings.values()), None)
    there = None if recorded is None else recorded.frequency
    return grid(campaign) if there is None else there[there > 0]


def _ends(run: Run) -> tuple[float, float] | None:
    """(low, high) [Hz] of what a run states to drive."""
    return None if run.excitation is None else run.excitation.band


def _between(lines: Array, low: float, high: float) -> Chosen:
    slack = SAME_LINE * (high - low)
    return np.asarray((lines >= low - slack) & (lines <= high + slack))


def _above(found: Spectra, runs: Sequence[int], columns: Sequence[int]) -> Chosen:
    """(r, n) whether the best channel of `columns` stands well above its noise; noise that is not known counts as none."""
    chosen = np.ix_(runs, range(len(found.frequency)), columns)
    return np.asarray(np.any(np.abs(found.values[chosen]) > WELL_ABOVE * found.noise[chosen], axis=2))


def _some(names: Sequence[str], most: int = 6) -> str:
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")
