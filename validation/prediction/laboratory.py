"""The measurement chain of one campaign as a model knows it, in the engine's words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf

from identification.campaign import Campaign
from identification.chain.parameter import Parameter as OfChain
from identification.measurement_chain import Chain, chain
from validation.effects.catalogue import FAMILIES
from validation.effects.family import OPENED
from validation.engine.parameter import DECLARED, IDENTIFIED, SENSOR, WITHIN, Parameter
from validation.models.model import Added, Model

HELD = 1.0
"""Standard deviation by which the chain opens what an effect needs; `validation.prediction.applied.opened` says which it has."""


KINDS = {"fmd-compliance": IDENTIFIED, "cell-stiffness": DECLARED}
"""What is of the FMD and not of a sensor, like its inertia: every laboratory that calibrates an FMD learns how its cells share a
load and how far they give; the former within what is declared of the cells."""


def laboratory(model: Model, campaign: Campaign, effects: Sequence[Added]) -> Chain:
    """The chain of `campaign`, with every parameter open that `effects` need.

    Raises
    ------
    BadInput : as `identification.measurement_chain.chain`.
    """
    drawn = _chain(model, campaign, {})
    needed = [one.named.id for one in effects if FAMILIES[one.named.family].stage == OPENED]
    overrides = {name: HELD for name in needed if name in drawn.possible}
    return _chain(model, campaign, overrides) if overrides else drawn


def parameters(of: Chain) -> tuple[Parameter, ...]:
    """What may move of a chain. What is offset by its logarithm is 1 + its relative change there."""
    return tuple(_parameter(one) for one in of.parameters)


def _chain(model: Model, campaign: Campaign, overrides: Mapping[str, float]) -> Chain:
    return chain(campaign.table, model.tolerances, stiffness=model.cell_stiffness, gravity=campaign.gravity, overrides=overrides)


def _parameter(one: OfChain) -> Parameter:
    return Parameter(
        name=one.name,
        unit=one.unit,
        tolerance=one.tolerance,
        kind=KINDS.get(one.family, SENSOR),
        within=WITHIN * one.tolerance if KINDS.get(one.family) == DECLARED else inf,
        nominal=1.0 if one.logarithmic else one.nominal,
        logarithmic=one.logarithmic,
        above=one.nominal - 1.0 if one.logarithmic else 0.0,
    )
