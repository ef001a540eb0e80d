"""Whether the losses of a structure follow its displacement or its velocity: nobody knows, and beside a resonance it matters.

Structural damping S and viscous damping that is equal to it at every resonance, C_rs = S_rs / sqrt(omega_r omega_s), take the
same off every peak, and differ by (1 - omega / omega_r) of themselves beside it. Real joints and layers lie in between (L. Gaul,
Mechanical Systems and Signal Processing 13 (1999), 473). So a share p of what is structural is taken for viscous:

    S' = (1 - p) S ,        C' = C + p W S W ,        W = diag(omega_r^-1/2) of the nominal modes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from geometry.arrays import Array
from validation.effects.stages import Matrices
from validation.engine.parameter import DECLARED, WITHIN, Parameter
from validation.engine.prediction import Offsets
from validation.prediction.tangent import Tangent, of_arrays

NAME = "damping-law"
"""Of the share; one for all structures of a series."""


def parameter(tolerance: float) -> Parameter:
    """The share p, which is 0 in the model as it stands."""
    return Parameter(name=NAME, unit="1", tolerance=tolerance, kind=DECLARED, within=WITHIN * tolerance)


def applied(
    matrices: Matrices, tangents: Mapping[str, Tangent], nominal: Matrices, offsets: Offsets, *, derivatives: bool
) -> tuple[Matrices, dict[str, Tangent]]:
    """`matrices` with the share of `offsets`, their `tangents` behind it, and that by the share.

    Parameters
    ----------
    nominal : the matrices at offset 0 and without effects, whose modes say at which frequency the two dampings agree
    derivatives : whether any are wanted
    """
    share, W = offsets.get(NAME, 0.0), _weights(nominal, len(matrices.mass))
    turned = W[:, None] * matrices.structural * W
    found = dict(tangents)
    if share:
        found = {name: _behind(tangent, share, W) for name, tangent in found.items()}
    if derivatives:
        found[NAME] = of_arrays(len(W), viscous=turned, structural=-matrices.structural * _own(W, W))
    left = matrices.structural * (1 - share * _own(W, W))
    return replace(matrices, structural=left, viscous=matrices.viscous + share * turned), found


def _weights(nominal: Matrices, size: int) -> Array:
    """(size,) omega^-1/2 of every coordinate; 0 of the base and of what effects append, which brings its own losses."""
    W, own = np.zeros(size), slice(nominal.base, len(nominal.mass))
    square = np.diag(nominal.stiffness)[own] / np.diag(nominal.mass)[own]
    W[own] = np.where(square > 0, square, np.inf) ** -0.25
    return W


def _behind(tangent: Tangent, share: float, W: Array) -> Tangent:
    if not np.any(tangent.structural):
        return tangent
    at = W[tangent.at]
    left = tangent.structural * (1 - share * _own(at, at))
    return replace(tangent, structural=left, viscous=tangent.viscous + share * at[:, None] * tangent.structural * at)


def _own(one: Array, other: Array) -> Array:
    """1 where both coordinates lose by this law, 0 elsewhere."""
    return np.outer(one > 0, other > 0).astype(np.float64)
