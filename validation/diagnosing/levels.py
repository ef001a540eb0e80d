"""The two-level test: do runs of one axis at two levels answer alike? It comes before any linear fit, and needs no model.

What a weaker run holds beyond the stronger ones (`validation.diagnosing.driven`) is compared with noise, channel by channel and
over all lines. An axis is named where some channel stands out both of noise and of what it reads, by more than what only leaks
into this axis by the cross motion of a table that drives another one.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from geometry.arrays import Array
from geometry.errors import BadInput
from validation.diagnosing.bench import Bench
from validation.diagnosing.diagnosis import Level
from validation.diagnosing.driven import FREE, Beyond, Driven, beyond, driven

SURE = 12.0
"""Standard deviations of the sum over all lines from which a channel answers differently. Of 22 channels in 384 weaker runs of 32
series with nothing planted the worst reached 7.0: noise is estimated, and its estimate scatters, too."""

VISIBLE = 2e-3
"""Share of what a channel reads that must differ."""

LEAKING = 3.0
"""How many times more must differ than what leaks from axes that are driven across."""

SMOOTHED = 9
"""Lines over which the worst frequency is looked for."""


def levels(bench: Bench) -> tuple[Level, ...]:
    """Axes that answer differently at two levels, the most surprising first; none where all were driven at one, or answer alike.

    What amplitude-dependent effects of the bench's model explain is taken off first.
    """
    found = [level for one in bench.made for level in of_campaign(driven(one.with_effects(bench.model.effects)))]
    return tuple(sorted(found, key=lambda level: -level.sigma))


def of_campaign(of: Driven) -> tuple[Level, ...]:
    """Of one campaign; the weakest of several levels of an axis, or whichever shows most."""
    left = beyond(of)
    apart = [differing(of, one) for one in left]
    known: dict[str, Level] = {}
    for k, one in enumerate(left):
        if not len(apart[k]) or _leaks(of, left, k):
            continue
        level = _level(of, one, apart[k])
        if level.axis not in known or known[level.axis].sigma < level.sigma:
            known[level.axis] = level
    return tuple(known.values())


def surprise(one: Beyond) -> Array:
    """(c,) by how many standard deviations the sum over lines of each channel is too large."""
    n = len(one.whitened)
    return np.asarray((np.sum(one.by_channel, axis=0) - n) / np.sqrt(n))


def share(of: Driven, one: Beyond) -> Array:
    """(c,) rms of what each channel holds beyond noise, when the others are believed, as a share of what it reads."""
    alone = (one.by_channel - 1) / np.maximum(one.free, FREE) * one.deviation**2
    return np.asarray(np.sqrt(np.maximum(alone.mean(axis=0), 0.0) / np.mean(of.level[one.run] ** 2, axis=0)))


def differing(of: Driven, one: Beyond) -> tuple[int, ...]:
    """Indices of the channels that answer differently, the worst first."""
    z = surprise(one)
    apart = np.flatnonzero((z > SURE) & (share(of, one) > VISIBLE))
    return tuple(int(k) for k in apart[np.argsort(-z[apart])])


def _leaks(of: Driven, left: Sequence[Beyond], k: int) -> bool:
    """Whether what run `k` holds is what other axes' differences bring along by cross motion."""
    one = left[k]
    own = float(np.sqrt(np.sum(np.abs(one.whitened * one.deviation) ** 2)))
    brought = 0.0
    for other in left:
        column = of.stronger.index(int(of.partner[other.run]))
        if other.run == one.run or of.partner[other.run] == of.partner[one.run]:
            continue
        taken = np.abs(one.weights[:, column]) / of.share[other.run]
        brought += float(np.sum(taken[:, None] ** 2 * np.abs(other.whitened * other.deviation) ** 2))
    return bool(own < LEAKING * np.sqrt(brought))


def _level(of: Driven, one: Beyond, apart: Sequence[int]) -> Level:
    by_line = np.sum(one.by_channel[:, list(apart)], axis=1)
    width = min(SMOOTHED, len(by_line))
    worst = int(np.argmax(np.convolve(by_line, np.ones(width) / width, mode="same")))
    return Level(
        data_set=of.name,
        runs=(of.runs[one.run], of.runs[int(of.partner[one.run])]),
        axis=of.axes[one.run],
        channels=tuple(of.channels[k] for k in apart),
        frequency=float(of.frequency[worst]),
        sigma=float(surprise(one).max()),
    )


def require_levels(bench: Bench, what: str = "friction, a gap or saturation") -> None:
    """Refuse a bench that was driven at one level where two are needed.

    Parameters
    ----------
    what : is asked for, for the message

    Raises
    ------
    BadInput : no axis of any campaign was driven at two levels.
    """
    if any(driven(one).weaker for one in bench.made):
        return
    sources = ", ".join(one.source for one in bench.campaigns)
    raise BadInput(
        source=sources,
        field="run.excitation.level",
        problem=f"every axis was driven at one level, and one level cannot see {what}: it looks like mass and damping there",
        remedy="Drive the same axes once more at half the level (`massline simulate --levels 1,0.5`), and name those runs, too",
    )
