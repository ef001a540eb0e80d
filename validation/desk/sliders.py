"""Every effect of the catalogue that reaches these data, and the sliders that move it."""

from __future__ import annotations

from dataclasses import dataclass

from validation.desk.whatif import Table


@dataclass(frozen=True, kw_only=True)
class Slider:
    """One size of an effect.

    Attributes
    ----------
    key : as in ``key:number``; empty for the one that stands alone
    label : what it is, in words
    unit : SI; "1" for a ratio
    low, high : ends of the slider, SI, within what the catalogue allows
    start : where it begins: no effect where that is a size
    null : the size at which there is no effect; NaN for a resonator's frequency and damping
    logarithmic : whether equal steps are equal factors; then `low` is above zero
    whole : a switch between `low` and `high`
    """

    key: str
    label: str
    unit: str
    low: float
    high: float
    start: float
    null: float
    logarithmic: bool
    whole: bool


@dataclass(frozen=True, eq=False, kw_only=True)
class Effect:
    """An effect that can be tried.

    Attributes
    ----------
    id : ``family:target``
    family, side : of the catalogue; sides are its headings
    what : in a few words
    sliders : none of a mistake that is there or not
    campaigns : names of those that it reaches
    """

    id: str
    family: str
    side: str
    what: str
    sliders: tuple[Slider, ...]
    campaigns: tuple[str, ...]


def reaching(of: Table) -> tuple[Effect, ...]:
    """All that act on these data, in the order of the catalogue; those of the model are among them."""
    raise NotImplementedError
