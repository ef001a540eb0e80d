"""`Family`: one physical effect as data, with its equation as a change of the prediction. One small file each in `families/`.

A prediction is made in stages, and an effect changes one of them (`validation.effects.stages`):

    STRUCTURE_STAGE   reduced matrices of what stands on its base: masses, springs, losses, resonators
    BODY_STAGE        dynamic mass of the article: where it stands, on what joint, what hangs beside it
    CHANNEL_STAGE     what every channel reads for a unit of each input
    NOISE_STAGE       how much noise is expected on a channel
    PERIOD_STAGE      the period of a pendulum
    OPENED            no equation of its own: a parameter of the laboratory or of the structure that bears the effect's id leaves
                      its tolerance (`identification.measurement_chain`, moduli of the parts)

The equation gets the stage, the targets and the values in SI by key, and returns the changed stage; at the `null` sizes it
changes nothing. Equations of structure add, those of channels are linear in what they get, so that derivatives pass through.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

STRUCTURE, FORCES, ACCELERATIONS, MISTAKE, AMPLITUDE, PROCESSING, PENDULUM = SIDES = (
    "structure",
    "force side",
    "acceleration side",
    "discrete mistake",
    "amplitude-dependent",
    "processing",
    "pendulum",
)

STRUCTURE_STAGE, BODY_STAGE, CHANNEL_STAGE, NOISE_STAGE, PERIOD_STAGE, OPENED = STAGES = (
    "structure",
    "dynamic mass",
    "channels",
    "noise",
    "period",
    "opened",
)

Values = Mapping[str, float]
"""Sizes in SI by key, the empty key for the one that stands alone."""

Change = Callable[[Any, tuple[str, ...], Values], Any]
"""``change(stage, targets, values) -> stage``."""


@dataclass(frozen=True, kw_only=True)
class Size:
    """One number that says how large an effect is.

    Attributes
    ----------
    unit : SI; "1" for a ratio
    low, high : beyond is no physics of a test, or a unit was mistaken
    key : by which it is written, ``key:number``; empty for the one that stands alone
    default : what holds where it is not written; None for one that must be
    whole : whether it is a whole number, as a switch is
    null : the size at which there is no effect
    plausible : standard deviation of a fault before anything was measured, of the logarithm where `logarithmic`; 0 for a size
        that is not fitted
    logarithmic : whether it is fitted by its logarithm: positive, and known to a factor
    """

    unit: str
    low: float
    high: float
    key: str = ""
    default: float | None = None
    whole: bool = False
    null: float = 0.0
    plausible: float = 0.0
    logarithmic: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class Family:
    """A family of effects.

    Attributes
    ----------
    name : the part of the identifier before the first colon
    side : of `SIDES`, the heading under which the catalogue lists it
    what : in a few words
    targets : kind of each target, in the order of the identifier
    optional : whether the last of them may be left out
    sizes : what its value holds; nothing for a mistake that is there or not
    varying : the sizes that depend on the first target, by that
    example : one that can be typed
    stage : of `STAGES`, what it changes
    change : its equation; None where a parameter of its name is opened
    tolerance : what a careful laboratory admits of it, one standard deviation in its unit; 0 for nothing
    equation : in one line, as in a paper
    mistaken_for : ids or families that look like it
    confirmed_by : what would confirm it in the laboratory
    reference : where the equation comes from
    sentence : what it means, for somebody who never heard of it; ``{target}`` stands for the first of its targets, ``{targets}``
        for all of them
    plant : makes it happen in a virtual test, ``plant(named) -> validation.virtual_test.hooks.Effect``; None for one that no
        virtual test knows
    """

    name: str
    side: str
    what: str
    targets: tuple[str, ...] = ()
    optional: bool = False
    sizes: tuple[Size, ...] = ()
    varying: Mapping[str, tuple[Size, ...]] = field(default_factory=dict)
    example: str
    stage: str = OPENED
    change: Change | None = None
    tolerance: float = 0.0
    equation: str = ""
    mistaken_for: tuple[str, ...] = ()
    confirmed_by: str = ""
    reference: str = ""
    sentence: str = ""
    plant: Callable[[Any], Any] | None = None

    def sizes_at(self, targets: tuple[str, ...]) -> tuple[Size, ...]:
        """What the value holds of an effect on `targets`."""
        return self.varying.get(targets[0], self.sizes) if targets else self.sizes
