"""The measurement chain of one campaign as a model knows it, in the engine's words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from identification.campaign import Campaign
from identification.chain.parameter import Parameter as OfChain
from identification.measurement_chain import Chain, chain
from validation.engine.parameter import SENSOR, Parameter
from validation.models.model import Added, Model
from validation.prediction.acting import is_opened
from validation.prediction.opened import plausible

HELD = 1.0
"""Standard deviation with which a parameter is opened that is then held at its size: any will do."""


def laboratory(model: Model, campaign: Campaign, effects: Sequence[Added]) -> Chain:
    """The chain of `campaign`, with every parameter open that `effects` need.

    Raises
    ------
    BadInput : as `identification.measurement_chain.chain`.
    """
    drawn = _chain(model, campaign, {})
    needed = {one.named.id: plausible(one) or HELD for one in effects if is_opened(one)}
    overrides = {name: sd for name, sd in needed.items() if name in drawn.possible}
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
        kind=SENSOR,
        nominal=1.0 if one.logarithmic else one.nominal,
        logarithmic=one.logarithmic,
        above=one.nominal - 1.0 if one.logarithmic else 0.0,
    )
