"""`Observed`: classical measurements beside a model, with the tolerances that they have in common."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array, frozen
from validation.models.model import Added
from validation.prediction.facts import ArticleFact
from validation.prediction.inputs import covariance


@dataclass(frozen=True, eq=False, kw_only=True)
class Observed:
    """Facts, and how far the model is from them.

    Attributes
    ----------
    facts : (n,) by the model with its own effects
    own : those effects
    left : (n,) predicted - measured, SI
    covariance : (n, n) of the measured, SI
    """

    facts: tuple[ArticleFact, ...]
    own: tuple[Added, ...]
    left: Array
    covariance: Array

    def __post_init__(self) -> None:
        n = len(self.facts)
        object.__setattr__(self, "left", frozen(self.left, (n,), "left"))
        object.__setattr__(self, "covariance", frozen(self.covariance, (n, n), "covariance"))

    @property
    def precision(self) -> Array:
        """(n, n) inverse of the covariance."""
        return inverse(self.covariance)

    @property
    def of_period(self) -> Array:
        """(n,) 1 / the moment of inertia that was measured by a period, 0 of any other number."""
        return np.array([0.0 if fact.swing is None else 1 / fact.value for fact in self.facts])

    @property
    def deviation(self) -> Array:
        """(n,) standard deviations, SI."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))


def observed(facts: Sequence[ArticleFact], own: Sequence[Added]) -> Observed:
    """`facts` beside the model with its `own` effects."""
    left = [_left(fact) for fact in facts]
    return Observed(
        facts=tuple(facts), own=tuple(own), left=np.array(left), covariance=covariance([fact.spread for fact in facts])
    )


def shifted(of: Observed, added: Added, sizes: Array) -> Array:
    """(k, n) by how much more the model says than without the effect `added`, at each of its `sizes` (k,), SI.

    Raises
    ------
    BadInput, ValueError : a size that the pendulum or the body cannot have.
    """
    found = np.zeros((len(sizes), len(of.facts)))
    for n, fact in enumerate(of.facts):
        changed = fact.with_effects((*of.own, added))
        if added.named.id in {one.name for one in changed.parameters}:
            found[:, n] = [_left(changed, {added.named.id: float(size)}) - of.left[n] for size in sizes]
    return found


def inverse(covariance: Array) -> Array:
    """(n, n) of a covariance, in units in which it has ones on its diagonal."""
    sd = np.sqrt(np.diag(covariance))
    return np.asarray(np.linalg.inv(covariance / np.outer(sd, sd)) / np.outer(sd, sd), dtype=np.float64)


def _left(fact: ArticleFact, offsets: dict[str, float] | None = None) -> float:
    """Predicted - measured, SI; effects of the model at their own sizes."""
    at = {one.name: one.start for one in fact.parameters} | (offsets or {})
    return fact.left(at)
