"""Effects without an equation: the parameter of their name leaves its tolerance.

Its knowledge beforehand widens from what is admitted of every laboratory and structure to a plausible fault, it counts as an
effect, and a fit starts at the size of the model file. One whose size is given stands there and is no parameter any more.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf

from validation.engine.parameter import EFFECT, Parameter
from validation.engine.prediction import Offsets
from validation.models.model import Added
from validation.prediction.acting import is_opened


def opened(parameters: Sequence[Parameter], effects: Sequence[Added]) -> tuple[tuple[Parameter, ...], Offsets]:
    """`parameters` with those that `effects` open, and the offsets of those whose size is given.

    Raises
    ------
    BadInput : a size that the parameter cannot have.
    """
    by_name = {one.named.id: one for one in effects if is_opened(one)}
    given = {
        one.name: one.offset(by_name[one.name].named.value)
        for one in parameters
        if one.name in by_name and not moves(by_name[one.name])
    }
    left = tuple(_opened(one, by_name.get(one.name)) for one in parameters if one.name not in given)
    return left, given


def moves(added: Added) -> bool:
    """Whether the size of an effect that opens a parameter is to be fitted."""
    return not added.fixed and plausible(added) > 0


def plausible(added: Added) -> float:
    """Standard deviation of a fault of this kind before anything was measured."""
    return added.named.sizes[0].plausible


def _opened(one: Parameter, effect: Added | None) -> Parameter:
    if effect is None:
        return one
    start = one.offset(effect.named.value)
    return replace(one, tolerance=plausible(effect), kind=EFFECT, start=start, within=inf)
