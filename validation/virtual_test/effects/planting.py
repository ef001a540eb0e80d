"""From a named effect to the changes that it makes in a virtual test."""

from __future__ import annotations

from collections.abc import Sequence

from geometry.errors import BadInput
from validation.effects.catalogue import FAMILIES, SOURCES
from validation.effects.family import PENDULUM, PROCESSING
from validation.effects.identifiers import Named
from validation.virtual_test.hooks import Effect

ELSEWHERE = (
    "it arises where spectra are made of a record, which holds nothing of it",
    'Plant nothing, and evaluate the campaign with [processing] method = "peak-reference-hold"',
)
OF_A_PENDULUM = ("it is an error of a pendulum, and a shaker has none", "Simulate a pendulum with `massline swing`")
UNPLANTED = ("its family says no `plant`", "Write plant=at(...) of validation.effects.plants in its file")
"""Why a family is planted by no virtual test, and what to do."""


def planted(effects: Sequence[Named]) -> tuple[Effect, ...]:
    """The changes that `effects` make, in their order.

    Raises
    ------
    BadInput : one of them cannot be planted in a virtual test; why, and what can.
    """
    return tuple(_planted(named) for named in effects)


def _planted(named: Named) -> Effect:
    plant = FAMILIES[named.family].plant
    if plant is None:
        raise _refused(named)
    effect: Effect = plant(named)
    return effect


def _refused(named: Named) -> BadInput:
    known = {PENDULUM: OF_A_PENDULUM, PROCESSING: ELSEWHERE} if named.family not in SOURCES else {}
    problem, remedy = known.get(FAMILIES[named.family].side, UNPLANTED)
    return BadInput(source="--effect", field=named.id, problem=problem, remedy=remedy)
