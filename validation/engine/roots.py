"""The root of a covariance whose parameters are of any unit."""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array


def root(covariance: Array) -> Array:
    """(p, p) R with R R^T = `covariance`, whose parameters may stand still.

    It is taken of the correlations: beside a variance in (N/m)², what is known of a position to the micrometre is rounding.
    """
    sd = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    scale = np.where(sd > 0, sd, 1.0)
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    return np.asarray(scale[:, None] * vectors * np.sqrt(np.maximum(values, 0.0)))
