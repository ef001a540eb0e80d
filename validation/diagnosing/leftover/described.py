"""What no effect explains, described: where it is and what it looks like.

Every place - a pair of axes, an axis, a channel, a channel that hears something, a part - is tried with every course over
frequency; the one that explains most is named where it covers half of the leftover. Else a channel or a pair that holds half of
it, whatever it does there, is named as irregular or as noise; else only where it is worst.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from geometry.arrays import Array
from validation.diagnosing.bench import Hypothesis
from validation.diagnosing.diagnosis import Leftover
from validation.diagnosing.leftover import words
from validation.diagnosing.leftover.courses import RESONANCE
from validation.diagnosing.leftover.irregular import irregular
from validation.diagnosing.leftover.places import AXIS, KINDS, SPAN
from validation.diagnosing.leftover.ranking import Explanation, ranked, refined
from validation.diagnosing.leftover.tangents import swallowing
from validation.diagnosing.leftover.whitened import whitened
from validation.prediction.series import SeriesPrediction

NULL = 0.89
"""Twice the cost of a fit, priors counted, per degree of freedom where nothing is missing; the model-error floor is a bound."""

SURE = 0.4
"""Share of a leftover that an explanation must cover to be what the leftover looks like."""

NEARLY = 0.95
"""Share of the best gain at which a plainer explanation is as good."""

MANY, VAGUE, ALONE = 0.95, 0.75, 0.8
"""What the gain counts of a whole matrix, which has many numbers; of a whole axis, which can be many things; and of what acts in
one of several data sets alone, where tolerances that all of them share give back what they took elsewhere."""

WEIGHED: Mapping[str, float] = MappingProxyType({SPAN: MANY, AXIS: VAGUE})

HARDLY = 0.02
"""Share of the degrees of freedom that a leftover must at least be: below, models that miss nothing differ by as much."""


def described(hypothesis: Hypothesis) -> Leftover:
    """What `hypothesis` does not explain, and what its tolerances swallowed of it."""
    data = swallowing(list(whitened(hypothesis, derivatives=True)), hypothesis)
    best = refined(plainest(ranked(hypothesis, data)))
    excess = _excess(hypothesis, data[0].slope)
    share = 2 * best.gain / max(excess, 2 * best.gain, HARDLY * hypothesis.fit.degrees_of_freedom)
    if share >= SURE:
        return words.leftover(best, share, _resonance(best, hypothesis))
    return irregular([one.of for one in data], excess, best, share)


def _excess(hypothesis: Hypothesis, slope: Array) -> float:
    """Chi² and price of all parameters above those of a model that misses nothing; the way to the minimum is not counted."""
    return 2 * hypothesis.fit.cost - float(slope @ slope) - NULL * hypothesis.fit.degrees_of_freedom


def plainest(found: Sequence[Explanation]) -> Explanation:
    """Of `found` the plainest of those that are nearly as good as the best, as far as each is plausible."""
    best = max(map(_plausibly, found))
    return min((one for one in found if _plausibly(one) >= NEARLY * best), key=_plainness)


def _plausibly(one: Explanation) -> float:
    return one.gain * WEIGHED.get(one.place.kind, 1.0) * (ALONE if one.data_set else 1.0)


def _plainness(one: Explanation) -> tuple[bool, int, float]:
    return one.course.looks_like == RESONANCE, KINDS.index(one.place.kind), -_plausibly(one)


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
