"""`Prediction` and `Fact`: the two protocols through which the engine sees a model.

At one line of one run the channels read ``y = A u + noise``: A (c, k) is predicted, the inputs u (k,) are known or latent. A fact
is a single number that another measurement says: a weight, a centre of gravity, a period.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Protocol, Self

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from validation.engine.measured import Measured
from validation.engine.parameter import Parameter

Lines = npt.NDArray[np.int64]

Wanted = bool | Collection[str]
"""Whether derivatives are wanted, or of which parameters; others may be left out."""

Offsets = Mapping[str, float]
"""Offsets of parameters by name; one that is not in it stands at 0."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Change:
    """How a prediction answers to one parameter.

    Attributes
    ----------
    channels : indices of the channels that change; no other does
    rows : (n, len(channels), k) complex, or (r, n, len(channels), k) where runs differ: d rows / d offset
    """

    channels: tuple[int, ...]
    rows: ComplexArray


@dataclass(frozen=True, eq=False, kw_only=True)
class Conveyed:
    """The same of a parameter that all channels see through the same few quantities, such as the loads of what is carried.

    Attributes
    ----------
    channels : indices of the channels that change; no other does
    through : (n, len(channels), j) what the channels read of these quantities; the same array of all parameters that go this way
    quantities : (n, j, k) d quantities / d offset
    """

    channels: tuple[int, ...]
    through: ComplexArray
    quantities: ComplexArray

    @property
    def rows(self) -> ComplexArray:
        """(n, len(channels), k) d rows / d offset."""
        return np.asarray(self.through @ self.quantities)


@dataclass(frozen=True, eq=False, kw_only=True)
class Predicted:
    """What the channels read for a unit of every input, and how that changes.

    Attributes
    ----------
    rows : (n, c, k) complex, or (r, n, c, k) where runs differ
    changes : by name of the parameters that act here; empty where derivatives were not asked for
    noise : (r, n, c) in place of that of the data where an effect on noise acts; None for the data's own
    """

    rows: ComplexArray
    changes: Mapping[str, Change | Conveyed] = field(default_factory=lambda: MappingProxyType({}))
    noise: Array | None = None


class Prediction(Protocol):
    """A model of one data set."""

    @property
    def measured(self) -> Measured:
        """The data."""

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """All that may move here. Predictions of a series share parameters by name, and then agree about them."""

    def on(self, runs: Sequence[str]) -> Self:
        """The same model of the runs named alone."""

    def at(self, offsets: Offsets, lines: Lines | None = None, *, derivatives: Wanted = True) -> Predicted:
        """The prediction at `offsets` and the lines with these indices; all lines by default.

        Raises
        ------
        numpy.linalg.LinAlgError, ValueError, FloatingPointError : the model breaks down there; a fit then steps back.
        """


class Fact(Protocol):
    """One number of another measurement."""

    @property
    def name(self) -> str:
        """Where it comes from and what it is, for messages and tables."""

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """All that may move it."""

    def residual(self, offsets: Offsets) -> tuple[float, Mapping[str, float]]:
        """(predicted - measured) / standard deviation, and its derivatives by offset of the parameters that act."""
