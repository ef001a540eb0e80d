"""What the present data say of the parameters by one explanation, carried over to a test that is not done yet.

A test shares tolerances with the data that are there: sensors, the FMD, parts. What the fit has learnt of them holds; what is
new, such as the modes of an article that never stood there, is known as beforehand. A test may also move a parameter - two
pick-ups exchanged take their gains along - or draw it anew.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from validation.diagnosing.bench import Hypothesis
from validation.engine.parameter import EFFECT, Parameter
from validation.engine.roots import root
from validation.models.model import Added


@dataclass(frozen=True, kw_only=True)
class Origin:
    """Where a parameter of a test comes from.

    Attributes
    ----------
    name : of the parameter of the present data whose offset it takes; empty for one that is drawn anew
    factor : by which the offset is multiplied
    """

    name: str = ""
    factor: float = 1.0


SURE = 100.0
"""Nats beyond which one of two is right."""

Moved = Mapping[str, Origin]
"""By name of a parameter in the test; one that is not in it stays what it was."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Knowledge:
    """A hypothesis as a distribution of its parameters.

    Attributes
    ----------
    effects : all of its model, as its problem has them
    offsets : where its fit ended, of all parameters
    names : (p,) of the free parameters
    root : (p, p), covariance of their offsets = root @ root.T
    log_evidence : [nats] of the present data
    """

    effects: tuple[Added, ...]
    offsets: Mapping[str, float]
    names: tuple[str, ...]
    root: Array
    log_evidence: float

    def odds(self, other: Knowledge) -> float:
        """Probability of this one, if it or `other` is right."""
        return float(1 / (1 + np.exp(np.clip(other.log_evidence - self.log_evidence, -SURE, SURE))))

    def at(self, moved: Moved) -> dict[str, float]:
        """Offsets of the test."""
        taken = {new: origin.factor * self.offsets.get(origin.name, 0.0) for new, origin in moved.items()}
        return {**self.offsets, **taken}

    def spread(self, parameters: Sequence[Parameter], moved: Moved) -> Array:
        """(q, s): covariance of the offsets of `parameters` in the test = spread @ spread.T.

        Effects that this hypothesis has not are known not to be there.
        """
        row = {name: k for k, name in enumerate(self.names)}
        known = np.zeros((len(parameters), len(self.names)))
        new = np.zeros(len(parameters))
        for k, one in enumerate(parameters):
            origin = moved.get(one.name, Origin(name=one.name))
            if origin.name in row:
                known[k] = origin.factor * self.root[row[origin.name]]
            elif origin.name not in self.offsets and one.kind != EFFECT and np.isfinite(one.tolerance):
                new[k] = one.tolerance
        return np.hstack([known, np.diag(new)[:, new > 0]])


def knowledge(of: Hypothesis) -> Knowledge:
    """What the fit of a hypothesis knows."""
    return Knowledge(
        effects=effects_of(of),
        offsets={**of.problem.start, **of.fit.by_name},
        names=tuple(one.name for one in of.fit.parameters),
        root=root(of.fit.covariance),
        log_evidence=of.fit.log_evidence,
    )


def effects_of(of: Hypothesis) -> tuple[Added, ...]:
    """The effects from which the offsets of its fit count: those of its model and its own."""
    own = [getattr(one, "effects", ()) for one in of.problem.predictions]
    return max(own, key=len, default=()) or of.effects
