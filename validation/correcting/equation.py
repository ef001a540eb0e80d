"""The inverse of an effect that has an equation of the channels: what a user's own families are corrected with.

Such an equation is linear in the rows that it gets, so what it makes of the unit matrix is what it makes of any channels,

    y' = R(f) y,

and a record is rid of it by the inverse of R, line by line.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from validation.correcting.signals import Response
from validation.effects.catalogue import FAMILIES
from validation.effects.family import AMPLITUDE, CHANNEL_STAGE
from validation.effects.identifiers import Named
from validation.effects.stages import Reading

WORST = 1e4
"""Condition number beyond which noise would be blown up out of all proportion."""


def has_inverse(named: Named) -> bool:
    """Whether the equation of `named` is one of the channels that does not ask how the run was driven."""
    family = FAMILIES[named.family]
    return family.stage == CHANNEL_STAGE and family.change is not None and family.side != AMPLITUDE


def touched(named: Named, channels: tuple[str, ...], frequency: Array) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Which of `channels` the equation changes at `frequency` (n,) [Hz], and which it needs to: these and those that leak in."""
    change = np.abs(_matrix(named, channels, frequency) - np.eye(len(channels))).max(axis=0) > 0
    changed, leaking = change.any(axis=1), change.any(axis=0)
    return tuple(map(int, np.flatnonzero(changed))), tuple(map(int, np.flatnonzero(changed | leaking)))


def inverse(named: Named, channels: tuple[str, ...], chosen: Sequence[int], held: float) -> Response:
    """R^-1 of the `chosen` of `channels`, (n, k, k); below `held` [Hz] that of this frequency."""

    def response(frequency: Array) -> ComplexArray:
        lines = np.maximum(frequency, held)
        matrix = _matrix(named, channels, lines)[:, chosen][:, :, chosen]
        _require_invertible(named, matrix, lines)
        return np.asarray(np.linalg.inv(matrix))

    return response


def _matrix(named: Named, channels: tuple[str, ...], frequency: Array) -> ComplexArray:
    """(n, c, c) R."""
    change = FAMILIES[named.family].change
    if change is None:
        raise ValueError(f"`named` must have an equation, found {named.family}")
    rows = np.broadcast_to(np.eye(len(channels), dtype=np.complex128), (len(frequency), len(channels), len(channels)))
    return np.asarray(change(Reading(frequency=frequency, channels=channels, rows=rows), named.targets, named.values).rows)


def _require_invertible(named: Named, matrix: ComplexArray, frequency: Array) -> None:
    singular = np.linalg.svd(matrix, compute_uv=False)
    lost = np.flatnonzero(~(singular[:, -1] * WORST > singular[:, 0]))
    if len(lost):
        problem = f"cannot be taken out of a record: at {frequency[lost[0]]:.4g} Hz its equation leaves nothing of the signal"
        raise BadInput(source=named.id, problem=problem, remedy=f"Add it to the model instead: massline add MODEL {named}")
