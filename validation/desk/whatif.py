"""What if: the predicted curves of one entry with an effect at any size, while a slider is dragged.

Nothing is fitted: every other parameter stands where the comparison left it, so that what moves is the effect alone. It is an
illustration of its size and no "after" of adding it; `validation.desk.climbing.added` fits.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from validation.desk.desk import Desk


@dataclass(frozen=True, eq=False, kw_only=True)
class Table:
    """Predictions that stand ready; made once a model, in a second or few.

    Attributes
    ----------
    campaigns : names
    at : "the plain fit", or "the model as it stands, nothing fitted" before there is a comparison
    """

    campaigns: tuple[str, ...]
    at: str


@dataclass(frozen=True, eq=False, kw_only=True)
class Trace:
    """The predicted entry of one campaign.

    Attributes
    ----------
    campaign : data set
    frequency : (m,) [Hz]; fewer than the data have while dragging
    before, after : (m,) complex, without and with the effect, in `unit`
    unit : kg, kg m or kg m²
    reached : whether the effect acts on this campaign at all
    """

    campaign: str
    frequency: Array
    before: ComplexArray
    after: ComplexArray
    unit: str
    reached: bool


@dataclass(frozen=True, eq=False, kw_only=True)
class WhatIf:
    """What an effect of that size would do.

    Attributes
    ----------
    written : the effect with its size
    traces : one a campaign that tells a dynamic mass
    plain_percent : plain error with it, over all runs, told at some lines; nothing refitted
    before_percent : the same without it, at the same lines
    facts : by name of a weighing or period, (before, after) in standard deviations
    exact : whether every line was computed
    note : a sentence, such as that noise alone changes and no curve does
    """

    written: str
    traces: tuple[Trace, ...]
    plain_percent: float
    before_percent: float
    facts: Mapping[str, tuple[float, float]]
    exact: bool
    note: str


def table(of: Desk) -> Table:
    """Predictions of the data by the model as it stands, at the plain fit where there is a comparison.

    Raises
    ------
    BadInput : model or data that cannot be used.
    """
    raise NotImplementedError


def what_if(of: Table, effect: str, load: int, motion: int, *, exact: bool = True) -> WhatIf:
    """The entry with `effect` (``ID=VALUE``, ``ID=key:number,...``) in the model.

    Parameters
    ----------
    load, motion : the entry shown, 0 to 5
    exact : every line, as `validation.prediction` has it (when a slider is released); else as many as 200 ms allow

    Raises
    ------
    BadInput : no such effect, a size that is no physics.
    CheckFailed : the model breaks down at that size.
    """
    raise NotImplementedError
