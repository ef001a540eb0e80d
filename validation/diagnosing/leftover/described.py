"""What no effect explains, described: where it is and what it looks like.

Every place - a pair of axes, an axis, a channel, a channel that hears something, a part - is tried with every course over
frequency; the one that explains most is named where it covers half of the leftover. Else a channel or a pair that holds half of
it, whatever it does there, is named as irregular or as noise; else only where it is worst.
"""

from __future__ import annotations

from collections.abc import Sequence

from validation.diagnosing.bench import Hypothesis
from validation.diagnosing.diagnosis import Leftover
from validation.diagnosing.leftover import words
from validation.diagnosing.leftover.courses import RESONANCE
from validation.diagnosing.leftover.irregular import irregular
from validation.diagnosing.leftover.places import AXIS, CHANNEL, HEARD, PAIR, PART
from validation.diagnosing.leftover.ranking import Explanation, ranked
from validation.diagnosing.leftover.whitened import whitened
from validation.prediction.series import SeriesPrediction

NULL = 0.89
"""Twice the cost of a fit, tolerances counted, per degree of freedom where nothing is missing: the model-error floor is a bound."""

SURE = 0.5
"""Share of a leftover that an explanation must cover to be what the leftover looks like."""

NEARLY = 0.9
"""Share of the best gain at which a plainer explanation is as good."""

PLAINER = (CHANNEL, PAIR, AXIS, PART, HEARD)
"""Kinds of places, the plainest first."""


def described(hypothesis: Hypothesis) -> Leftover:
    """What `hypothesis` does not explain, and what its tolerances swallowed of it."""
    data = list(whitened(hypothesis, derivatives=True))
    excess = leftover_of(hypothesis)
    found = ranked(hypothesis, data)
    best = plainest(found)
    share = 2 * best.gain / max(excess, 2 * best.gain)
    if share >= SURE:
        return words.leftover(best, share, _resonance(best, hypothesis))
    return irregular(data, excess, best, share)


def leftover_of(hypothesis: Hypothesis) -> float:
    """How much chi² and price of all parameters lie above those of a model that misses nothing."""
    return 2 * hypothesis.fit.cost - NULL * hypothesis.fit.degrees_of_freedom


def plainest(found: Sequence[Explanation]) -> Explanation:
    """Of `found`, the best first, the plainest of those that are nearly as good."""
    good = [one for one in found if one.gain >= NEARLY * found[0].gain]
    return min(good, key=_plainness)


def _plainness(one: Explanation) -> tuple[bool, int, bool, float]:
    return one.course.looks_like == RESONANCE, PLAINER.index(one.place.kind), bool(one.data_set), -one.gain


def _resonance(one: Explanation, hypothesis: Hypothesis) -> float | None:
    """[Hz] of the mode that a parameter is of."""
    family, _, rest = one.place.part.partition(":")
    if family not in ("frequency", "damping"):
        return None
    configuration, _, mode = rest.rpartition(":")
    for prediction in hypothesis.problem.predictions:
        if isinstance(prediction, SeriesPrediction) and prediction.tested.carried.nuisances is not None:
            nuisances = prediction.tested.carried.nuisances
            if nuisances.configuration == configuration:
                return float(nuisances.frequency[int(mode) - 1])
    return None
