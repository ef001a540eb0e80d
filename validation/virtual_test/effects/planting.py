"""From a named effect to the changes that it makes in a virtual test."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from geometry.errors import BadInput
from validation.effects.catalogue import FAMILIES
from validation.effects.family import PENDULUM, PROCESSING, Family
from validation.effects.identifiers import Named
from validation.effects.plants import Place, at
from validation.virtual_test.hooks import Effect

STRUCTURAL: Mapping[str, tuple[Place, str]] = {
    "point-mass": ("rig", "of_structure.point_mass"),
    "rigid-inertia": ("rig", "of_structure.rigid_inertia"),
    "modulus": ("parts", "of_structure.modulus"),
    "joint-compliance": ("rig", "of_structure.joint"),
    "structural-damping": ("parts", "of_structure.damping"),
    "layer-damping": ("parts", "of_structure.layer_damping"),
    "appendage": ("rig", "of_structure.appendage"),
    "absorber": ("rig", "of_structure.absorber"),
    "slosh": ("rig", "of_structure.slosh"),
    "cable": ("rig", "of_structure.cable"),
    "orientation": ("rig", "of_structure.orientation"),
    "mounting-offset": ("rig", "of_structure.offset"),
    "gravity": ("chain", "of_chain.gravity"),
    "friction": ("rig", "of_structure.friction"),
}

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


def plant_of(family: Family) -> Callable[[Named], Effect] | None:
    """What makes an effect of `family` happen; None for one that no virtual test knows."""
    return at(*STRUCTURAL[family.name]) if family.name in STRUCTURAL else family.plant


def _planted(named: Named) -> Effect:
    plant = plant_of(FAMILIES[named.family])
    if plant is None:
        raise _refused(named)
    return plant(named)


def _refused(named: Named) -> BadInput:
    known = {PENDULUM: OF_A_PENDULUM, PROCESSING: ELSEWHERE}
    problem, remedy = known.get(FAMILIES[named.family].side, UNPLANTED)
    return BadInput(source="--effect", field=named.id, problem=problem, remedy=remedy)
