"""What a seed draws: the errors of the measurement chain, the FMD that is on the shaker, the parts of the structure.

Every figure has a stream of its own name, so that it is the same for every article, and grows with its tolerance alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.inertia import Inertia
from geometry.sensors import Channel
from validation.virtual_test.chain_truth import CELLS, ChainTruth
from validation.virtual_test.layout import Layout
from validation.virtual_test.plan import Plan
from validation.virtual_test.streams import stream

LIGHTEST = 0.1
"""Least share that a draw leaves of a mass or of a second moment: a body stays a body whatever the tolerance."""


@dataclass(frozen=True, kw_only=True)
class Part:
    """Relative changes of the moduli and of the loss factor of a part of the structure, and what an effect adds to the latter."""

    modulus: float
    loss: float
    added_loss: float = 0.0


def chain(plan: Plan, layout: Layout) -> ChainTruth:
    """The measurement chain of `plan.seed`."""
    of, channels = plan.tolerances, layout.table.channels
    accelerometers = [channel for channel in channels if channel.quantity == "acceleration"]
    crosstalk = of.crosstalk * _normal(plan, "crosstalk", size=(3, 3))
    return ChainTruth(
        gain={c.name: (of.table_gain if c.group == "table" else of.gain) * _one(plan, "gain", c.name) for c in channels},
        delay={c.name: of.delay * _one(plan, "delay", c.name) for c in channels},
        position={c.name: of.position * _normal(plan, "position", c.name, size=3) for c in accelerometers},
        angle={c.name: of.angle * _across(plan, c) for c in accelerometers},
        cell_stiffness=np.maximum(of.cell_stiffness * _normal(plan, "cell-stiffness", size=(CELLS, 3)), LIGHTEST - 1),
        crosstalk=crosstalk * (1 - np.eye(3)),
        noise_rms={c.name: plan.noise_rms[c.quantity] for c in channels},
        mains={c.name: plan.mains[c.quantity] for c in channels},
    )


def moving_part(plan: Plan, nominal: Inertia) -> Inertia:
    """The FMD's moving part about F that is on the shaker: `nominal` with other mass, CoG and second moments.

    Second moments are drawn and not moments of inertia, which would break the triangle inequality: the FMD is nearly a plate.
    """
    of = plan.tolerances.fmd_inertia
    second = 0.5 * np.trace(nominal.tensor_cog) * np.eye(3) - nominal.tensor_cog
    factors = np.sqrt(np.maximum(1 + of * _normal(plan, "fmd-second-moments", size=3), LIGHTEST))
    drawn = factors[:, None] * second * factors
    return Inertia.from_cog(
        nominal.mass * max(1 + of * _one(plan, "fmd-mass"), LIGHTEST),
        nominal.cog + plan.scatter.fmd_cog * _normal(plan, "fmd-cog", size=3),
        np.trace(drawn) * np.eye(3) - drawn,
    )


def part(plan: Plan, name: str) -> Part:
    """What is drawn for the structure's part `name`; the same in every article that has it."""
    modulus, loss = (
        float(np.expm1(sd * _one(plan, what, name)))
        for sd, what in ((plan.scatter.modulus, "modulus"), (plan.scatter.damping, "loss-factor"))
    )
    return Part(modulus=modulus, loss=loss)


def damping_factors(plan: Plan, count: int) -> Array:
    """(count,) factors on the damping ratios of an article's modes, where they are stated by mode."""
    names = [f"{plan.on_fmd} mode {number}" for number in range(1, count + 1)]
    return np.exp([plan.scatter.damping * _one(plan, "damping-ratio", name) for name in names])


def _across(plan: Plan, channel: Channel) -> Array:
    """(3,) a standard rotation about the two axes across the direction of an accelerometer."""
    direction = channel.places[0].direction
    vector = _normal(plan, "angle", channel.name, size=3)
    return np.asarray(vector - direction * (direction @ vector))


def _one(plan: Plan, *names: str) -> float:
    return float(stream(plan.seed, *names).standard_normal())


def _normal(plan: Plan, *names: str, size: int | tuple[int, ...]) -> Array:
    return np.asarray(stream(plan.seed, *names).standard_normal(size))
