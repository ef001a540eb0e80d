"""Records that begin or end in motion: what the Fourier integral of a whole record cannot know.

The integral is free of leakage only when the record holds everything from rest to rest. Half a second of missing ring-down is
visible as misfit at the sweep's end.
"""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array
from identification.campaign import Campaign
from identification.recording import Recording
from identification.survey import block_rms, noise_floors

IN_MOTION = 2.0
"""How far above its noise a channel reads when it still moves."""

JERK = 6.0
"""How far above its noise the very first sample lies when the record begins in motion: a drive that starts from rest does not."""

UNKNOWN = 0.01
"""Share of its largest block above which a channel still moves, where its noise is not known."""

NEGLIGIBLE = 1e-4
"""Share of its largest block below which a channel counts as still whatever its noise: records without noise ring for ever."""

NAMED = 3
"""How many channels a warning names."""


def warnings(campaign: Campaign) -> tuple[str, ...]:
    """Sentences about runs of time histories that do not begin or end at rest."""
    floors = _floors(campaign)
    recorded = [(run.name, campaign.recordings[run.name]) for run in campaign.runs]
    return tuple(text for name, one in recorded for text in _of_run(name, one, floors) if text)


def _floors(campaign: Campaign) -> Array:
    """(c,) broadband noise; 0 where it is not known."""
    stated = np.array([channel.noise_rms or 0.0 for channel in campaign.table.channels])
    measured = noise_floors(campaign)
    return stated if measured is None else np.where(measured > 0, measured, stated)


def _of_run(name: str, recorded: Recording, floors: Array) -> tuple[str, str]:
    if recorded.sampling_rate is None:
        return "", ""
    forward, backward = recorded.values, recorded.values[::-1]
    rms, last = block_rms(forward, recorded.sampling_rate), block_rms(backward, recorded.sampling_rate)
    if len(rms) < 2:
        return "", ""
    level = rms.max(axis=0)
    still = np.where(floors > 0, np.maximum(IN_MOTION * floors, NEGLIGIBLE * level), UNKNOWN * level)
    first = np.abs(forward[0] - forward.mean(axis=0))
    begins = (rms[0] > still) & (first > JERK / IN_MOTION * still)
    began = (
        "begins in motion",
        "what went before is missing from its spectra",
        "Start recording before the drive",
    )
    ended = "ends before the ring-down", "what would have followed is missing from its spectra", "Record longer"
    words = tuple(recorded.names)
    return _said(name, words, rms[0], level, begins, began), _said(name, words, last[0], level, last[0] > still, ended)


def _said(run: str, names: tuple[str, ...], rms: Array, level: Array, moving: np.ndarray, words: tuple[str, str, str]) -> str:
    if not moving.any():
        return ""
    share = np.where(moving, rms / np.where(level > 0, level, 1.0), 0.0)
    worst = [int(k) for k in np.argsort(-share, kind="stable")[:NAMED] if moving[k]]
    which = ", ".join(f"{names[k]} at {100 * share[k]:.2g} %" for k in worst)
    more = f" and {int(moving.sum()) - len(worst)} more" if moving.sum() > len(worst) else ""
    what, why, remedy = words
    return f"run {run} {what} ({which}{more} of its largest half second): {why}. {remedy}"
