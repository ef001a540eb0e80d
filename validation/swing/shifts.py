"""What moves the period away from Eq. 5: every effect alone, each in a short run of its own, and all of them in the record."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace

from validation.period import LEAST_SAMPLES
from validation.swing.record import Record, recorded
from validation.swing.setup import Setup

CYCLES = 8.0
"""Cycles of a run that shows one effect."""

SAMPLES = 10 * LEAST_SAMPLES
"""Samples a cycle of such a run."""

Watched = Callable[[str], AbstractContextManager[Callable[[float], None] | None]]
"""Given what is being simulated, a block that shows how far it has come: `validation.progress.percent`."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Shift:
    """One effect alone, on ropes that are ideal otherwise.

    Attributes
    ----------
    name : one of `validation.swing.setup.EFFECTS`
    period : change of the period, relative to Eq. 5
    plain, corrected : error of the reduced moment of inertia, relative, without and with corrections
    """

    name: str
    period: float
    plain: float
    corrected: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Simulated:
    """The record, and every effect alone."""

    record: Record
    shifts: tuple[Shift, ...]

    @property
    def plain(self) -> float:
        """Error of the record's moment of inertia by Eq. 5 alone, relative."""
        return self.record.plain / self.record.setup.reference - 1

    @property
    def corrected(self) -> float:
        """The same with every correction."""
        return self.record.corrected / self.record.setup.reference - 1


def simulated(setup: Setup, watched: Watched = lambda words: nullcontext()) -> Simulated:
    """`setup` recorded, and every effect in it alone.

    Raises
    ------
    BadInput, CheckFailed : see `validation.swing.record.recorded`.
    """
    with watched("swinging, all effects") as progress:
        record = recorded(setup, progress)
    return Simulated(record=record, shifts=tuple(shift(setup, effect, watched) for effect in setup.effects))


def shift(setup: Setup, effect: str, watched: Watched = lambda words: nullcontext()) -> Shift:
    """What `effect` alone does to `setup`.

    Raises
    ------
    BadInput, CheckFailed : see `validation.swing.record.recorded`.
    """
    alone = replace(setup.alone(effect), cycles=CYCLES, rate=SAMPLES / setup.ideal_period)
    with watched(f"swinging, {effect} alone") as progress:
        found = recorded(alone, progress)
    plain, corrected = (inertia / setup.reference - 1 for inertia in (found.plain, found.corrected))
    return Shift(name=effect, period=found.shift, plain=plain, corrected=corrected)
