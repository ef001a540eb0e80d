"""What every pattern of excitation is, and how it becomes a `BaseMotion`: sampled, with cross motion, and a rest at its end."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import ceil
from typing import Protocol

import numpy as np
import numpy.typing as npt

from fem.base_excitation.base_motion import BaseMotion
from fem.base_excitation.patterns.cross_motion import CrossMotion
from fem.base_excitation.patterns.jet import Jet
from fem.base_excitation.patterns.levels import require_not_negative, require_positive
from geometry.arrays import Array
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput

RAMP_CYCLES = 3.0
"""A soft start or stop lasts at least as many cycles of the lowest frequency driven then."""

MOST_SAMPLES = 20_000_000
"""Of one motion: 40 minutes at 8 kHz, and 3 GB."""


@dataclass(frozen=True, kw_only=True)
class Clock:
    """Equally spaced instants: the sample j is at j / `sampling_rate` - `late` [s]."""

    sampling_rate: float
    count: int
    late: float = 0.0

    @property
    def time(self) -> Array:
        """(count,) [s]."""
        return np.arange(self.count) / self.sampling_rate - self.late


class Pattern(Protocol):
    """A closed form of what the table does."""

    @property
    def label(self) -> str:
        """What is driven, in words."""

    @property
    def driven(self) -> float:
        """[s] from the first motion to the last; the table is at rest before and after."""

    @property
    def highest(self) -> float:
        """[Hz] the highest frequency that is driven on purpose, soft start and stop included."""

    def signals(self, clock: Clock) -> Mapping[str, Jet]:
        """Displacement [m, rad] of every axis that is driven, with its derivatives, at the instants of `clock`."""


def sampled(
    pattern: Pattern,
    sampling_rate: float,
    *,
    ring_down: float,
    cross: CrossMotion | None = None,
    reference_point: npt.ArrayLike = (0.0, 0.0, 0.0),
) -> BaseMotion:
    """`pattern` at `sampling_rate` [Hz], followed by `ring_down` [s] of rest, as motion about `reference_point` (3,) [m].

    Every pattern has it as its method `motion`.

    Raises
    ------
    BadInput : a sampling rate or ring-down that cannot be, a pattern beyond the Nyquist frequency, a record of more than
        `MOST_SAMPLES`.
    """
    require_positive(sampling_rate, "sampling_rate", pattern.label, "Hz")
    require_not_negative(ring_down, "ring_down", pattern.label, "s")
    require_below_nyquist(pattern, sampling_rate)
    driven = pattern.driven + (cross.delay if cross else 0.0)
    clock = Clock(sampling_rate=sampling_rate, count=_count((driven + ring_down) * sampling_rate, pattern.label))
    displacement, velocity, acceleration = at(pattern, clock, cross).transpose(0, 2, 1)
    return BaseMotion(
        sampling_rate=sampling_rate,
        displacement=displacement,
        velocity=velocity,
        acceleration=acceleration,
        driven=driven,
        reference_point=np.asarray(reference_point, dtype=np.float64),
        label=pattern.label,
    )


def at(pattern: Pattern, clock: Clock, cross: CrossMotion | None = None) -> Array:
    """Displacement, velocity and acceleration of the table at the instants of `clock`: (3, 6, n)."""
    motion = np.zeros((3, 6, clock.count))
    _add(motion, pattern.signals(clock), cross.at_once if cross else np.eye(6))
    if cross:
        _add(motion, pattern.signals(replace(clock, late=clock.late + cross.delay)), cross.delayed)
    return motion


def _add(motion: Array, signals: Mapping[str, Jet], transfer: Array) -> None:
    """Add `signals`, passed on from their axes (columns of `transfer`) to all (rows), to `motion` (3, 6, n) in place."""
    for axis, jet in signals.items():
        for row, share in enumerate(transfer[:, MOTIONS.index(axis)]):
            if share:
                for total, part in zip(motion, (jet.value, jet.first, jet.second), strict=True):
                    total[row] += share * part


def require_below_nyquist(pattern: Pattern, sampling_rate: float) -> None:
    """Refuse a rate that cannot hold what is driven.

    Raises
    ------
    BadInput : `pattern` goes beyond half of `sampling_rate` [Hz].
    """
    if pattern.highest >= sampling_rate / 2:
        raise BadInput(
            source=pattern.label,
            field="sampling_rate",
            problem=f"must be above twice the highest frequency driven, {pattern.highest:.4g} Hz, found {sampling_rate:g} Hz",
            remedy="Sample faster or stop the excitation lower",
        )


def _count(samples: float, source: str) -> int:
    if samples > MOST_SAMPLES:
        problem = f"the record would have {samples:.3g} samples, more than {MOST_SAMPLES:.3g}"
        raise BadInput(source=source, problem=problem, remedy="Sweep faster, shorten the record or sample slower")
    return ceil(samples - 1e-6) + 1
