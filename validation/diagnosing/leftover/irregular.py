"""A leftover that goes with frequency in no plain way: the channel that holds it, or where it is worst."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from validation.diagnosing.diagnosis import Leftover
from validation.diagnosing.leftover import words
from validation.diagnosing.leftover.courses import IRREGULAR, NOISE
from validation.diagnosing.leftover.ranking import Explanation
from validation.diagnosing.leftover.whitened import Whitened

HELD = 0.5
"""Share of a leftover that a channel must hold to be named."""

SMOOTH = 0.4
"""Correlation of neighbouring lines above which a leftover is no noise."""

ALONE = 1e-6
"""Share of a channel that inputs must leave for anything to be known of it."""


@dataclass(frozen=True, kw_only=True)
class Held:
    """What one channel holds of a leftover in all data sets.

    Attributes
    ----------
    channel : its name
    chi2 : by which all would be better off without it
    smooth : correlation of neighbouring lines, -1 to 1
    """

    channel: str
    chi2: float
    smooth: float


def irregular(data: Sequence[Whitened], excess: float, best: Explanation, share: float) -> Leftover:
    """What is left, where `best` explains but `share` of it.

    Parameters
    ----------
    excess : chi² and price above those of a model that misses nothing
    """
    nearest = f"What comes closest is {words.sentence(best)}, with {share:.0%} of it"
    worst = max((one for one in held(data)), key=lambda one: one.chi2)
    part = min(worst.chi2 / max(excess, worst.chi2, np.finfo(np.float64).tiny), 1.0)
    if part < HELD:
        text = f"Spread over channels and frequencies, worst in {worst.channel} with {part:.0%}. {nearest}."
        return Leftover(text=text, looks_like=IRREGULAR, channels=(worst.channel,), share=part)
    looks_like = IRREGULAR if worst.smooth > SMOOTH else NOISE
    kind = "smooth over frequency but like nothing plain" if looks_like == IRREGULAR else "jagged over frequency, as of noise"
    text = f"{worst.channel} alone, {kind}: {part:.0%} of what is left. {nearest}."
    return Leftover(text=text, looks_like=looks_like, channels=(worst.channel,), share=part)


def held(data: Sequence[Whitened]) -> list[Held]:
    """What every channel holds: the sum of |r_c|² / (1 - h_c), whitened residuals of which inputs leave 1 - h_c free."""
    found: dict[str, tuple[float, complex, float]] = {}
    for one in data:
        free = np.maximum(one.free / 2, ALONE)
        e = one.values / np.sqrt(free)
        beside = np.sum(e[:, 1:] * e[:, :-1].conj(), axis=(0, 1))
        for k, channel in enumerate(one.prediction.measured.channels):
            chi2, together, power = found.get(channel, (0.0, 0j, 0.0))
            own = float(np.sum(np.abs(e[..., k]) ** 2))
            found[channel] = (chi2 + own - 2 * e[..., k].size, together + beside[k], power + own)
    return [
        Held(channel=channel, chi2=chi2, smooth=float((together / power).real))
        for channel, (chi2, together, power) in found.items()
    ]
