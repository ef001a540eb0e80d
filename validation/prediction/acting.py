"""`Acting`: an effect of a model at the sizes of one evaluation, and which of them a fit may move.

A model's effect has a parameter for every size that can be fitted: its id where it has one size, ``ID[key]`` where it has several.
The knowledge beforehand lies about the size at which there is no effect, and a fit starts at the size of the model file. A size
that is fitted by its logarithm has no such place: its knowledge lies about what the file says, by a factor.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType

from validation.effects.catalogue import FAMILIES
from validation.effects.family import OPENED, Size
from validation.effects.identifiers import Named
from validation.engine.parameter import EFFECT, Parameter
from validation.engine.prediction import Offsets
from validation.models.model import Added


@dataclass(frozen=True, eq=False, kw_only=True)
class Acting:
    """One effect as an equation takes it.

    Attributes
    ----------
    named : with its values at these offsets, SI
    moving : by name of the parameters that a fit may move, the key of the size that each is, and d size / d offset
    """

    named: Named
    moving: Mapping[str, tuple[str, float]] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def stage(self) -> str:
        """Of `validation.effects.family.STAGES`."""
        return FAMILIES[self.named.family].stage


def acting(effects: Sequence[Added], offsets: Offsets) -> tuple[Acting, ...]:
    """`effects` that have an equation, in their order, with their sizes at `offsets`."""
    return tuple(_at(one, offsets) for one in effects if not is_opened(one))


def is_opened(added: Added) -> bool:
    """Whether it has no equation but opens a parameter of its name."""
    return FAMILIES[added.named.family].stage == OPENED


def parameters(added: Added) -> tuple[Parameter, ...]:
    """What a fit may move of an effect that has an equation; nothing of one whose size is given."""
    return tuple(_by_key(added).values())


def parameter_name(named: Named, size: Size) -> str:
    """What the parameter of `size` is called."""
    return f"{named.id}[{size.key}]" if len(named.sizes) > 1 else named.id


def _by_key(added: Added) -> dict[str, Parameter]:
    if added.fixed:
        return {}
    return {size.key: _parameter(added, size) for size in added.named.sizes if size.plausible > 0}


def _parameter(added: Added, size: Size) -> Parameter:
    value = added.named.values[size.key]
    made = Parameter(
        name=parameter_name(added.named, size),
        unit=size.unit,
        tolerance=size.plausible,
        kind=EFFECT,
        nominal=value if size.logarithmic else size.null,
        logarithmic=size.logarithmic,
    )
    return replace(made, start=made.offset(value))


def _at(added: Added, offsets: Offsets) -> Acting:
    by_key = _by_key(added)
    at = {key: offsets.get(one.name, 0.0) for key, one in by_key.items()}
    values = {key: one.value(at[key]) for key, one in by_key.items()}
    moving = {one.name: (key, one.slope(at[key])) for key, one in by_key.items()}
    return Acting(named=replace(added.named, values={**added.named.values, **values}), moving=MappingProxyType(moving))
