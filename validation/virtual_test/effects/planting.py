"""From a named effect to the changes that it makes in a virtual test."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from geometry.errors import BadInput
from validation.effects.catalogue import FAMILIES
from validation.effects.family import PENDULUM
from validation.effects.identifiers import Named
from validation.virtual_test.effects import of_chain, of_signals, of_structure
from validation.virtual_test.hooks import Effect

Maker = Callable[[Named], Callable[[Any], Any]]

PLANTS: Mapping[str, tuple[str, Maker]] = {
    "point-mass": ("rig", of_structure.point_mass),
    "rigid-inertia": ("rig", of_structure.rigid_inertia),
    "modulus": ("parts", of_structure.modulus),
    "joint-compliance": ("rig", of_structure.joint),
    "structural-damping": ("parts", of_structure.damping),
    "layer-damping": ("parts", of_structure.layer_damping),
    "appendage": ("rig", of_structure.appendage),
    "absorber": ("rig", of_structure.absorber),
    "slosh": ("rig", of_structure.slosh),
    "cable": ("rig", of_structure.cable),
    "orientation": ("rig", of_structure.orientation),
    "mounting-offset": ("rig", of_structure.offset),
    "gravity": ("chain", of_chain.gravity),
    "force-gain": ("chain", of_chain.gain),
    "load-path-shunt": ("chain", of_chain.shunt),
    "force-delay": ("chain", of_chain.delay),
    "board-delay": ("chain", of_chain.board_delay),
    "force-highpass": ("signals", of_signals.highpass),
    "force-crosstalk": ("chain", of_chain.crosstalk),
    "force-plane-offset": ("chain", of_chain.plane_offset),
    "fmd-compliance": ("chain", of_chain.compliance),
    "cell-stiffness": ("chain", of_chain.cell_stiffness),
    "accelerometer-gain": ("chain", of_chain.gain),
    "accelerometer-delay": ("chain", of_chain.delay),
    "accelerometer-position": ("chain", of_chain.position),
    "accelerometer-misalignment": ("chain", of_chain.misalignment),
    "accelerometer-tilt": ("chain", of_chain.tilt),
    "cover-plate-flexibility": ("signals", of_signals.flexible_cover),
    "polarity": ("chain", of_chain.polarity),
    "channel-swap": ("record", of_signals.swap),
    "unit": ("record", of_signals.unit),
    "friction": ("rig", of_structure.friction),
    "gap": ("rig", of_structure.gap),
    "saturation": ("signals", of_signals.saturation),
    "noise": ("chain", of_chain.noise),
    "mains": ("chain", of_chain.mains),
}
"""By family: which of the places of `hooks.Effect` it changes, and how."""

ELSEWHERE = (
    "it arises where spectra are made of a record, which holds nothing of it",
    'Plant nothing, and evaluate the campaign with [processing] method = "peak-reference-hold"',
)
OF_A_PENDULUM = ("it is an error of a pendulum, and a shaker has none", "Simulate a pendulum with `massline swing`")
"""Why a family is planted by no virtual test, and what to do."""


def planted(effects: Sequence[Named]) -> tuple[Effect, ...]:
    """The changes that `effects` make, in their order.

    Raises
    ------
    BadInput : one of them cannot be planted in a virtual test; why, and what can.
    """
    return tuple(_planted(named) for named in effects)


def _planted(named: Named) -> Effect:
    if named.family not in PLANTS:
        raise _refused(named)
    where, maker = PLANTS[named.family]
    return Effect(id=named.id, value=dict(named.values), **{where: maker(named)})


def _refused(named: Named) -> BadInput:
    problem, remedy = OF_A_PENDULUM if FAMILIES[named.family].side == PENDULUM else ELSEWHERE
    return BadInput(source="--effect", field=named.id, problem=problem, remedy=remedy)
