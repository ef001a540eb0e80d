"""The FMD's moving part as parameters: ten of them about F, known beforehand to a share.

A share of an inertia means the same for all ten when it is that of the pseudo-inertia P (4x4), whose diagonal holds the mass and
the three second moments: the standard deviation of an entry P_ij is the share times sqrt(P_ii P_jj), so that a mass known to 5 %
goes with a centre of gravity known to 5 % of the radius of gyration.

The moving part is nearly a plate: its second moment across the plane is a small difference of moments that are known to 5 % of
their own. So a fit may pass through what no density has (P not definite); only a mass matrix that does not resist is refused.
No fit goes `FARTHEST` beyond what is known beforehand: where a grave fault would have the FMD swallow it, the FMD would end as no
body at all, and a fit on the brink of that finds no way down.
"""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array
from geometry.inertia import PARAMETERS, UNITS, Inertia
from validation.engine.parameter import IDENTIFIED, Parameter
from validation.engine.prediction import Offsets

FMD = "fmd"

FARTHEST = 5.0
"""Standard deviations."""


def names() -> tuple[str, ...]:
    """Of the ten parameters."""
    return tuple(f"{FMD}:{one}" for one in PARAMETERS)


def parameters(nominal: Inertia, tolerance: float) -> tuple[Parameter, ...]:
    """The ten, of a moving part that is `nominal` about F within `tolerance`; none of one that is known exactly."""
    if tolerance == 0:
        return ()
    ten = zip(names(), UNITS, nominal.parameters.tolist(), (tolerance * scales(nominal)).tolist(), strict=True)
    return tuple(
        Parameter(name=name, unit=unit, tolerance=sd, kind=IDENTIFIED, nominal=value, low=-FARTHEST * sd, high=FARTHEST * sd)
        for name, unit, value, sd in ten
    )


def scales(nominal: Inertia) -> Array:
    """(10,) of each parameter: what a share of it is a share of."""
    m, xx, yy, zz = (nominal.pseudo_inertia[k, k] for k in (3, 0, 1, 2))
    first = np.sqrt(m * np.array([xx, yy, zz]))
    moments = np.hypot.reduce(np.array([[yy, zz, 0.0], [xx, zz, 0.0], [xx, yy, 0.0]]), axis=1)
    return np.concatenate([[m], first, moments, np.sqrt([xx * yy, xx * zz, yy * zz])])


def at(nominal: Inertia, offsets: Offsets) -> Inertia:
    """The moving part at `offsets`, about F.

    Raises
    ------
    numpy.linalg.LinAlgError : its mass matrix is not positive definite; a fit then steps back.
    """
    ten = nominal.parameters + np.array([offsets.get(name, 0.0) for name in names()])
    made = Inertia(parameters=ten)
    np.linalg.cholesky(made.mass_matrix)
    return made
