"""How far the wrong explanation can follow what the right one says a test would read: it is fitted to that.

The linear forecast of `expected` takes the derivatives where the fit of the present data ended. Where a resonance has moved by
more than its width they say nothing of what a fit would do. So the few tests that look best are gone through: by the same descent
as any fit, with what the present data have told as knowledge beforehand, though only as far as a forecast needs.
"""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array
from identification.self_calibration.elimination import Normal
from identification.self_calibration.solve import minimise
from validation.diagnosing.advisor.knowledge import Knowledge
from validation.diagnosing.advisor.offer import Offer
from validation.diagnosing.advisor.planned import Planned, lines_of, reading
from validation.engine import likelihood
from validation.engine.fit import FLOOR

MOST = 12
"""Evaluations that it may take."""

ROUGHLY = 0.5
"""Standard deviations that the last step may be: it leaves an eighth of a nat."""


def following(test: Planned, offer: Offer, right: Knowledge, wrong: Knowledge) -> float:
    """Nats that are left of the difference between `right` and `wrong` when the latter was fitted to what the former reads.

    Raises
    ------
    numpy.linalg.LinAlgError, ValueError, FloatingPointError : a model breaks down in this test.
    """
    here, there = offer.by(right), offer.by(wrong)
    measured = reading(test, here, here.offsets)
    lines, worth = lines_of(measured)
    seen = likelihood.observed(measured, lines)
    prediction = test.prediction.with_effects(there.effects)
    parameters = tuple(one for one in prediction.parameters if one.tolerance > 0)
    names, L = tuple(one.name for one in parameters), wrong.spread(parameters, offer.moved)
    begin = np.array([there.offsets.get(name, 0.0) for name in names])

    def normal(z: Array) -> Normal:
        offsets = {**there.offsets, **dict(zip(names, map(float, begin + L @ z), strict=True))}
        predicted = prediction.at(offsets, lines, derivatives=frozenset(names))
        found = likelihood.total(likelihood.normals(seen, predicted, names, FLOOR).values(), len(names))
        gradient, matrix = L.T @ found.gradient, L.T @ found.matrix @ L
        return Normal(cost=worth * found.cost, gradient=worth * gradient, matrix=worth * matrix)

    nothing = np.zeros(L.shape[1])
    return minimise(normal, nothing, lambda z: (z, np.eye(len(z))), close=ROUGHLY, most=MOST).normal.cost
