"""`MultiAxis`: several patterns at the same time, and six runs of them that are linearly independent."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem.base_excitation.patterns.jet import Jet
from fem.base_excitation.patterns.pattern import Clock, Pattern, sampled
from fem.base_excitation.patterns.sweep import Sweep
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput


@dataclass(frozen=True, eq=False, kw_only=True)
class MultiAxis:
    """All of `patterns` at once: sweeps of several axes with phases and delays of their own, noise on one and a sweep on another.

    Attributes
    ----------
    patterns : at least one; where two drive the same axis they add up
    title : what it is called; by default the labels of its patterns

    Raises
    ------
    BadInput : no pattern.
    """

    patterns: tuple[Pattern, ...]
    title: str = ""

    def __post_init__(self) -> None:
        if not self.patterns:
            raise BadInput(source="multi-axis excitation", field="patterns", problem="is empty", remedy="Name at least one")

    @property
    def label(self) -> str:
        """What is driven, in words."""
        return self.title or " together with ".join(pattern.label for pattern in self.patterns)

    @property
    def driven(self) -> float:
        """[s] until the last pattern has come to rest."""
        return max(pattern.driven for pattern in self.patterns)

    @property
    def highest(self) -> float:
        """[Hz] of all patterns."""
        return max(pattern.highest for pattern in self.patterns)

    def signals(self, clock: Clock) -> Mapping[str, Jet]:
        """Displacement [m, rad] of every axis that is driven, with its derivatives, at the instants of `clock`."""
        total: dict[str, Jet] = {}
        for pattern in self.patterns:
            for axis, jet in pattern.signals(clock).items():
                total[axis] = total[axis] + jet if axis in total else jet
        return total

    motion = sampled


def phased_sweeps(level: float = 1.0, **changes: Any) -> tuple[MultiAxis, ...]:
    """Six runs that sweep all six axes at once, each at `level` times its nominal level; `changes` are fields of `Sweep`.

    In run r the axis k leads by 2 pi r k / 6. At every frequency of the band the six columns of the paper's S_u are then those of
    a discrete Fourier transform: in units of the nominal levels they are orthogonal, the best condition that six runs can have.

    Raises
    ------
    BadInput : what `Sweep` refuses.
    """
    return tuple(
        MultiAxis(
            title=f"sine sweep of all six axes at once, run {run + 1} of 6",
            patterns=tuple(
                Sweep(axis=axis, level=level, phase=2 * np.pi * run * k / 6, **changes) for k, axis in enumerate(MOTIONS)
            ),
        )
        for run in range(6)
    )
