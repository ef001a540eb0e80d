"""Masses, springs and resonators on reduced matrices: what several families of the structure have in common."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from geometry.arrays import Array
from validation.effects.family import Values
from validation.effects.stages import Matrices

ALONG = {"": (0, 1, 2), "lateral": (0, 1), "vertical": (2,)}
"""Which of x, y, z a direction means."""

BASE = 6


def heavier(stage: Matrices, mass: Array) -> Matrices:
    """`stage` with `mass` (k, k) more."""
    return replace(stage, mass=stage.mass + mass)


def with_resonators(stage: Matrices, place: str, axes: tuple[int, ...], values: Values) -> Matrices:
    """`stage` with a resonator along each of `axes` at `place`: mass ``m``, frequency ``f``, damping ratio ``zeta``."""
    for axis in axes:
        stage = _with_resonator(stage, stage.places[place][axis], values)
    return stage


def _with_resonator(stage: Matrices, row: Array, values: Values) -> Matrices:
    """One more coordinate, the motion of a mass on a spring relative to ``row @ x``, on which it rides."""
    m, omega = values["m"], 2 * np.pi * values["f"]
    rides = np.append(row, 1.0)
    mass, stiffness, viscous, structural = (_grown(a, 1) for a in (stage.mass, stage.stiffness, stage.viscous, stage.structural))
    mass += m * np.outer(rides, rides)
    stiffness[-1, -1] = omega**2 * m
    viscous[-1, -1] = 2 * values["zeta"] * omega * m
    return replace(
        stage,
        mass=mass,
        stiffness=stiffness,
        viscous=viscous,
        structural=structural,
        places={name: _grown(rows, 0) for name, rows in stage.places.items()},
        parts={name: _grown(share, 1) for name, share in stage.parts.items()},
    )


def _grown(matrix: Array, rows: int) -> Array:
    """`matrix` with a column of zeros more, and with `rows` rows of them: hundreds of resonators find `numpy.pad` slow."""
    n, m = matrix.shape
    found = np.zeros((n + rows, m + 1))
    found[:n, :m] = matrix
    return found
