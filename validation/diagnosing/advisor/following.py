"""How far the wrong explanation can follow what the right one says a test would read: it is fitted to that.

The linear forecast of `expected` takes the derivatives where the fit of the present data ended. Where a resonance has moved by
more than its width they say nothing of what a fit would do. So the few tests that look best are gone through: by the same descent
as any fit, within the same bounds, with what the present data have told as knowledge beforehand, though only as far as a forecast
needs.
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

STIFF = 1e-12
"""Relative variance of a direction below which it does not move."""

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
    lines, worth = lines_of(test, measured)
    seen = likelihood.observed(measured, lines)
    prediction = test.prediction.with_effects(there.effects)
    moving = tuple(one for one in prediction.parameters if one.tolerance > 0)
    spread = wrong.spread(moving, offer.moved)
    free = np.flatnonzero(np.any(spread != 0, axis=1))
    names, bounds = tuple(moving[k].name for k in free), np.array([moving[k].bounds(plain=False) for k in free])
    whitening, begin = _whitening(spread[free]), np.array([there.offsets.get(name, 0.0) for name in names])

    def data(x: Array) -> Normal:
        offsets = {**there.offsets, **dict(zip(names, map(float, x), strict=True))}
        predicted = prediction.at(offsets, lines, derivatives=frozenset(names))
        found = likelihood.total(likelihood.normals(seen, predicted, names, FLOOR).values(), len(names))
        return Normal(cost=worth * found.cost, gradient=worth * found.gradient, matrix=worth * found.matrix)

    def knowledge(x: Array) -> tuple[Array, Array]:
        return whitening @ (x - begin), whitening

    low, high = bounds.T
    found = minimise(data, begin, knowledge, close=ROUGHLY, most=MOST, bounds=(np.minimum(low, begin), np.maximum(high, begin)))
    return found.normal.cost


def _whitening(spread: Array) -> Array:
    """(p, p) W with W spread spread^T W^T = 1, of parameters (p,) of any unit; a direction that does not move resists."""
    covariance = spread @ spread.T
    scale = np.sqrt(np.diag(covariance))
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    return np.asarray((vectors / np.sqrt(np.maximum(values, STIFF * values[-1]))).T / scale)
