"""`Laboratory`: what a plan puts on the shaker - nominal layout, drawn chain and rig, effects in both."""

from __future__ import annotations

from dataclasses import dataclass

from fem.base_excitation.rig import Rig
from validation.virtual_test import drawn
from validation.virtual_test.chain_truth import ChainTruth
from validation.virtual_test.effects.reach import require_planted
from validation.virtual_test.hooks import changed_chain, changed_rig
from validation.virtual_test.layout import Layout, mavis
from validation.virtual_test.plan import Plan
from validation.virtual_test.sensors import Sensors, sensors
from validation.virtual_test.set_up import SetUp, middles_of_cells, require_stack, set_up


@dataclass(frozen=True, eq=False, kw_only=True)
class Laboratory:
    """What is on the shaker.

    Attributes
    ----------
    layout : channels as the file states them
    chain : as it is
    made : what stands on the table before effects change it
    rig : what is driven
    sensors : of `chain`
    """

    layout: Layout
    chain: ChainTruth
    made: SetUp
    rig: Rig
    sensors: Sensors


def laboratory(plan: Plan) -> Laboratory:
    """What `plan` has on the shaker.

    Raises
    ------
    BadInput : an article that does not stand on the FMD or cannot be built; an effect at a place or part that it has not.
    """
    require_stack(plan.article)
    require_planted(plan)
    layout = mavis(middles_of_cells(plan), plan.noise_rms)
    chain = changed_chain(drawn.chain(plan, layout), plan.effects)
    made = set_up(plan, chain)
    rig = changed_rig(made.rig, plan.effects)
    return Laboratory(layout=layout, chain=chain, made=made, rig=rig, sensors=sensors(layout, chain, plan.gravity))
