"""How a family is planted in a virtual test: ``plant=at("signals", "saturation")``.

The makers of the package are named, not imported: `validation.virtual_test` needs the catalogue to read what it is asked for.
"""

from collections.abc import Callable
from functools import partial
from importlib import import_module
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from validation.effects.catalogue import Named
    from validation.virtual_test.plan import PlantedEffect


Place = Literal["chain", "parts", "rig", "signals", "record"]
"""Those of `validation.virtual_test.plan.PlantedEffect`."""

Maker = Callable[["Named"], Callable[[Any], Any]]
"""Given the effect with its size, the change at its place."""


def at(place: Place, maker: Maker | str) -> "Callable[[Named], PlantedEffect]":
    """The plant that changes a virtual test at `place`.

    Parameters
    ----------
    maker : a function that makes the change, or the name of one in `validation.virtual_test.planted`, ``change(named, stage)``
    """
    return partial(_planted, place, maker)


def _planted(place: Place, maker: Maker | str, named: "Named") -> "PlantedEffect":
    from validation.virtual_test.plan import PlantedEffect

    if isinstance(maker, str):
        change: Any = partial(getattr(import_module("validation.virtual_test.planted"), maker), named)
    else:
        change = maker(named)
    changes: dict[str, Any] = {place: change}
    return PlantedEffect(id=named.id, value=dict(named.values), **changes)
