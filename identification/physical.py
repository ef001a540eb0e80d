"""The nearest parameters that a body can have, in units of what the data can tell.

Least squares knows nothing of positive density. Where its answer breaks the triangle inequality, the one that a body can have and
that the data like best is the minimum of (p - p0)^T C^-1 (p - p0) over all positive pseudo-inertias, for which the log-Cholesky
coordinates are free of constraints (`geometry.multibody`). Where least squares lies outside, that minimum lies on the boundary -
a body without thickness - which logarithms approach and never reach: what is returned is a body, by a hair.
"""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array
from geometry.consistency import Kind, judge
from geometry.errors import CheckFailed
from geometry.inertia import Inertia
from geometry.multibody import from_log_cholesky, log_cholesky

INSIDE = 1e-3
"""How far inside the boundary, relative to the trace of the pseudo-inertia, the search starts."""


def nearest_body(inertia: Inertia, covariance: Array) -> Inertia:
    """`inertia` where a body can have it, else the nearest body in the metric of `covariance` (10, 10), about the same point.

    Raises
    ------
    CheckFailed : the mass is not positive, so that there is no body near.
    """
    from scipy.optimize import least_squares

    if judge(inertia).kind is Kind.BODY:
        return inertia
    if inertia.mass <= 0:
        raise CheckFailed(f"No body is near parameters of negative mass, found {inertia.mass:.6g} kg", mass=inertia.mass)
    whiten = np.linalg.inv(np.linalg.cholesky(covariance))

    def misfit(coordinates: Array) -> Array:
        return np.asarray(whiten @ (_of(coordinates, inertia).parameters - inertia.parameters))

    found = least_squares(misfit, log_cholesky(_inside(inertia)), x_scale="jac", xtol=1e-12, ftol=1e-12, gtol=1e-12)
    return _of(found.x, inertia)


def _of(coordinates: Array, like: Inertia) -> Inertia:
    """The body with log-Cholesky coordinates about the reference point of `like`, which stands for the frame's origin there."""
    return Inertia(parameters=from_log_cholesky(coordinates).parameters, reference_point=like.reference_point)


def _inside(inertia: Inertia) -> Inertia:
    """A body near `inertia`, about the origin: second moments of its density about its CoG lifted to be positive."""
    about = Inertia(parameters=inertia.parameters)
    values, axes = np.linalg.eigh(about.tensor_cog)
    sigma = values.sum() / 2 - values
    lifted = np.maximum(sigma, INSIDE * np.abs(sigma).max())
    tensor = axes @ np.diag(lifted.sum() - lifted) @ axes.T
    return Inertia.from_cog(mass=about.mass, cog=about.cog, tensor=tensor)
