"""Effects of a pendulum among the candidates of a diagnosis with campaigns: what the swings among its facts say of each.

The period goes with the square of an amplitude, a damping or a distance: at none a straight line sees nothing of them, and a fit
that begins there stays there. So their evidence is the integral over their size (`validation.diagnosing.classical.weighed`), the
body being what the fit has made of it, and the fit begins at the size that it finds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from validation.diagnosing.bench import Bench, Hypothesis
from validation.diagnosing.classical.advised import advised as swings_advised
from validation.diagnosing.classical.answering import answering
from validation.diagnosing.classical.candidates import Candidate, candidates, pendulum_candidates
from validation.diagnosing.classical.curve import curve
from validation.diagnosing.classical.judged import judged
from validation.diagnosing.classical.observed import Observed, inverse, observed, shifted
from validation.diagnosing.classical.weighed import Weighed, weighed
from validation.diagnosing.diagnosis import Advice
from validation.models.model import Added
from validation.prediction.facts import ArticleFact


def of_swings(bench: Bench) -> tuple[Added, ...]:
    """Effects of a pendulum that could act on a swing among the facts of `bench`, each at a plausible size."""
    return pendulum_candidates(_swings(bench, ()))


def told(bench: Bench, at: Hypothesis, menu: Sequence[Added]) -> list[tuple[Added, Weighed]]:
    """Each of `menu`, at the size that it would have on top of the hypothesis `at`, with what the swings say of it."""
    every = (*bench.model.effects, *at.effects)
    of = _independent(observed(_swings(bench, every), every))
    wanted = {one.named.id for one in menu}
    return [_told(of, one) for one in candidates(of.facts, every) if one.id in wanted]


def advised(bench: Bench, at: Hypothesis, ids: Sequence[str]) -> tuple[Advice, ...]:
    """Measurements on swings and balances that would tell the effects `ids`, tried on top of the hypothesis `at`, apart."""
    every = (*bench.model.effects, *at.effects)
    of = observed(_swings(bench, every), every)
    answers = answering(of, [one for one in candidates(of.facts, every) if one.id in ids])
    tried = judged(answers, of.left, of.precision, of.of_period).tried
    return swings_advised(of, [one for one in tried if one.helps])


def _told(of: Observed, one: Candidate) -> tuple[Added, Weighed]:
    answer = curve(partial(shifted, of, one.added), one.low, one.high)
    found = weighed(answer, one.size.plausible, of.left, inverse(of.covariance))
    named = replace(one.added.named, values={one.size.key: found.value})
    return replace(one.added, named=named), found


def _independent(of: Observed) -> Observed:
    """As a fit takes them: what tolerances of swings have in common is not in it."""
    return replace(of, covariance=np.diag(np.diag(of.covariance)))


def _swings(bench: Bench, effects: Sequence[Added]) -> list[ArticleFact]:
    return [one for one in bench.facts(effects) if isinstance(one, ArticleFact) and one.swing is not None]
