"""Evidence: how probable the data are under a model whatever its parameters, by Laplace's approximation.

    log Z = -cost - 1/2 log det(S N S) ,   S = diag(tolerance)

N is the matrix of second derivatives of the cost, knowledge beforehand included; S N S is 1 in every direction of which the
data say nothing, so that a useless parameter costs nothing and one that is told pays for the width that it had before
(MacKay, Information Theory, Inference, and Learning Algorithms, ch. 28). What is left out is the same for all models of the
same data, lines and floor. Where an effect changes the noise, so does the normalisation of the likelihood: its ratio to that
of the data's own noise, latent inputs marginalised, is in.
"""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from identification.self_calibration.elimination import Normal
from validation.engine.cost import Cost


def log_evidence(cost: Cost, x: Array, whole: Normal) -> float:
    """At the minimum `x` (p,) where `whole` was found [nats], up to a constant of the data."""
    scale = np.array([one.tolerance if np.isfinite(one.tolerance) else 1.0 for one in cost.free])
    _, logdet = np.linalg.slogdet(scale[:, None] * whole.matrix * scale)
    return float(-whole.cost - 0.5 * logdet + _normalisation(cost, x))


def _normalisation(cost: Cost, x: Array) -> float:
    """Of the noise at `x` against that of the data."""
    found = 0.0
    for seen, predicted in cost.predicted(x):
        if predicted.noise is None:
            continue
        new, old = seen.weight(cost.floor, predicted.noise), seen.weight(cost.floor)
        found += 2 * float(np.sum(np.log(new / old)))
        if seen.inputs is None:
            rows = np.broadcast_to(predicted.rows, (len(seen.runs), *predicted.rows.shape[-3:]))
            found -= _determinant(new[..., None] * rows) - _determinant(old[..., None] * rows)
    return found


def _determinant(A: ComplexArray) -> float:
    """log det(A^H A) over all lines, of A (r, m, c, k)."""
    R = np.linalg.qr(A, mode="r")
    return 2 * float(np.sum(np.log(np.abs(np.diagonal(R, axis1=-2, axis2=-1)))))
