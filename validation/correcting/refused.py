"""Why an effect cannot be taken out of a record, and what to do instead."""

from __future__ import annotations

from geometry.errors import BadInput
from validation.effects.catalogue import FAMILIES
from validation.effects.family import AMPLITUDE, PENDULUM, STRUCTURE
from validation.effects.identifiers import Named

ADD = "Add it to the model instead: massline add MODEL {named}"

OF_SIDE = {
    STRUCTURE: ("it changes the structure, and what the structure does is what was measured", ADD),
    AMPLITUDE: ("it depends on how far the structure moved, and a record is not linear in it", ADD),
    PENDULUM: (
        "it is an error of a pendulum's period, and a campaign has none",
        "Correct the pendulum's file: massline pendulum",
    ),
}

SHARING = "which of the cells carried what must be known to take it apart, and only a fit of the whole chain tells"

OF_FAMILY = {
    "force-crosstalk": (SHARING, ADD),
    "force-plane-offset": (SHARING, ADD),
    "cell-stiffness": (SHARING, ADD),
    "fmd-compliance": ("how far the cells gave depends on the load on them, which only a model tells", ADD),
    "cover-plate-flexibility": ("how far the plate gave depends on the load on it, which only a model tells", ADD),
    "accelerometer-tilt": (
        "what a tilt adds depends on the motion of the whole plate",
        "Say senses_gravity = true or false of the channel in campaign.toml",
    ),
    "saturation": ("what was lost depends on the peak of a signal that was never recorded", "Repeat the run at half the level"),
    "noise": ("it is random, and nothing tells what it was", "Repeat the run, or say noise_rms of the channel in campaign.toml"),
    "mains": ("its phase differs from run to run", "Leave the line and its harmonics out of the band: massline identify --band"),
    "sweep-bias": (
        "it arises where spectra are made of a record, which holds nothing of it",
        'Evaluate with [processing] method = "full-record"',
    ),
}


def refused(named: Named) -> BadInput:
    """The refusal of `named`, ready to be raised."""
    fallback = ("no inverse of its equation is known", ADD)
    why, remedy = OF_FAMILY.get(named.family) or OF_SIDE.get(FAMILIES[named.family].side) or fallback
    return BadInput(source=named.id, problem=f"cannot be taken out of a record: {why}", remedy=remedy.format(named=named))
