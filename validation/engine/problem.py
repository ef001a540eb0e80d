"""`Problem`: predictions of several data sets that share parameters by name, and facts of other measurements."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType

import numpy as np

from validation.engine.parameter import Parameter
from validation.engine.prediction import Fact, Lines, Prediction

ALL_LINES: Mapping[str, Lines] = MappingProxyType({})

FEWEST = 20
"""Lines of a data set below which none is left out."""

AGREED = ("unit", "kind", "logarithmic", "tolerance", "nominal", "start", "within", "low", "high")
"""What two predictions must say alike of a parameter that they share."""


@dataclass(frozen=True, eq=False)
class Problem:
    """What is compared: ``Problem(predictions, facts)``.

    Attributes
    ----------
    predictions : one a data set
    facts : single numbers of other measurements
    lines : by data set the indices of the lines that fits use; all where nothing is said
    """

    predictions: tuple[Prediction, ...]
    facts: tuple[Fact, ...] = ()
    lines: Mapping[str, Lines] = field(default_factory=lambda: ALL_LINES, kw_only=True)

    def __post_init__(self) -> None:
        object.__setattr__(self, "predictions", tuple(self.predictions))
        object.__setattr__(self, "facts", tuple(self.facts))
        names = [one.measured.name for one in self.predictions]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"`predictions` must be of different data sets, found {name!r} twice: name them apart")
        _ = self.parameters

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """The union of all, by name.

        Raises
        ------
        ValueError : two data sets or facts say different things of the same parameter; names both.
        """
        found: dict[str, tuple[Parameter, str]] = {}
        sources = [(one.measured.name, one.parameters) for one in self.predictions]
        for source, parameters in (*sources, *((one.name, one.parameters) for one in self.facts)):
            for parameter in parameters:
                first, said_by = found.setdefault(parameter.name, (parameter, source))
                _require_agreement(first, said_by, parameter, source)
        return tuple(parameter for parameter, _ in found.values())

    @cached_property
    def by_name(self) -> dict[str, Parameter]:
        """The parameters by name."""
        return {one.name: one for one in self.parameters}

    @cached_property
    def start(self) -> dict[str, float]:
        """Offsets at which the model stands as it was given."""
        return {one.name: one.start for one in self.parameters}

    def free(self, kinds: Sequence[str]) -> tuple[Parameter, ...]:
        """The parameters of `kinds` that may move at all."""
        return tuple(one for one in self.parameters if one.kind in kinds and one.tolerance > 0)

    def lines_of(self, prediction: Prediction) -> Lines:
        """(m,) indices of the lines of a data set that fits use."""
        chosen = self.lines.get(prediction.measured.name)
        return np.arange(len(prediction.measured.frequency), dtype=np.int64) if chosen is None else chosen

    def thinned(self) -> Problem:
        """The same with fewer lines for its fits where there are many, see `validation.engine.thinning`."""
        from validation.engine.thinning import chosen

        return replace(self, lines={one.measured.name: chosen(one.measured) for one in self.predictions})

    def sparser(self, step: int) -> Problem:
        """The same with every so many lines of its fits, where that leaves `FEWEST`."""
        lines = {one.measured.name: self.lines_of(one) for one in self.predictions}
        return replace(self, lines={name: of[::step] if len(of) >= step * FEWEST else of for name, of in lines.items()})


def _require_agreement(first: Parameter, said_by: str, second: Parameter, source: str) -> None:
    for what in AGREED:
        if getattr(first, what) != getattr(second, what):
            raise ValueError(
                f"parameter {first.name!r} must be the same in all data sets: its {what} is {getattr(first, what)!r} in "
                f"{said_by} and {getattr(second, what)!r} in {source}; give them one value or two names"
            )
