"""What ropes bear before anything swings: their shares of the weight, and the suspensions that no rope could bear."""

from __future__ import annotations

import numpy as np

from fem.flexible_body.rope_pendulum.suspension import MOST_STRAIN, Suspension, refused
from geometry.arrays import Array

IN_LINE = 1e-12
"""Twice the area [m²] between three feet below which they are in one line."""


def shares(feet: Array) -> Array:
    """Share of the weight on every rope (n,) of a level body whose CoG is the origin; negative where it would have to push."""
    lever = np.vstack([np.ones(len(feet)), feet[:, :2].T])
    return np.asarray(np.linalg.lstsq(lever, np.array([1.0, 0.0, 0.0]), rcond=None)[0])


def require_pull(suspension: Suspension, weight: float) -> None:
    """Pass ropes that all pull on a body of `weight` [N], do not lie in one line, and do not let it tip over.

    Raises
    ------
    BadInput : they do not.
    """
    feet = suspension.feet
    share = shares(feet)
    if share.min() <= 0:
        worst = int(share.argmin())
        problem = f"the CoG is not between the ropes: rope {worst + 1} would have to push with {-share[worst] * weight:.4g} N"
        raise refused("off_centre", problem, "Hang the body so that its CoG lies between them")
    lever = feet[:, :2] - feet[0, :2]
    if len(feet) == 3 and abs(np.linalg.det(lever[1:])) < IN_LINE:
        raise refused("feet", "three ropes in one line hold nothing more than two", "Set them on a circle")
    if len(feet) == 2 and feet[:, 2].min() <= 0:
        problem = f"on two ropes whose feet are {feet[:, 2].min():.4g} m above the CoG the body tips over"
        raise refused("height", problem, "Tie them above the CoG")


def require_light(suspension: Suspension, mass: float) -> None:
    """Pass ropes that are no heavier than the body of `mass` [kg].

    Raises
    ------
    BadInput : they are.
    """
    if suspension.rope_mass > mass:
        problem = f"ropes of {suspension.rope_mass:.4g} kg are heavier than the body of {mass:.4g} kg: they swing it, not it them"
        raise refused("rope_mass", problem, f"Give {np.floor(1000 * mass) / 1000:g} kg or less for all ropes together")


def require_stiff(suspension: Suspension, weight: float, ropes: float) -> None:
    """Pass ropes that stretch no further than `MOST_STRAIN` under the `weight` [N] of the body and of all `ropes`.

    Raises
    ------
    BadInput : they do.
    """
    if suspension.stiffness is None:
        return
    load = float(shares(suspension.feet).max()) * weight + ropes / suspension.ropes
    strain = load / suspension.stiffness
    if strain > MOST_STRAIN:
        problem = f"a rope would stretch by {100 * strain:.3g} % under {load:.4g} N, more than {100 * MOST_STRAIN:g} %"
        raise refused("stiffness", problem, f"Use an EA of {1.01 * load / MOST_STRAIN:.3g} N or more")
