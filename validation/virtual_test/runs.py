"""The runs of a plan: what is driven in each, by which name, and how the campaign file states it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from geometry.dynamic_mass import LEVELS, MOTIONS
from identification.campaign import Excitation
from validation.virtual_test.plan import DIAGONAL, MULTI, TWICE, Plan
from validation.virtual_test.streams import stream

if TYPE_CHECKING:
    from fem.base_excitation.patterns import CrossMotion, Pattern, Sweep

DIAGONALS = (("x", "y"), ("y", "z"), ("z", "x"), ("alpha", "beta"), ("beta", "gamma"), ("gamma", "alpha"))
"""Axes that are driven together, in phase, each at 1 / sqrt(2) of its level."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DrivenRun:
    """One run before it is driven.

    Attributes
    ----------
    name : unique in the campaign
    axis : of `MOTIONS`; empty where several are driven
    pattern : what the table is driven with
    excitation : the same as the campaign file states it
    level : factor on the nominal one
    """

    name: str
    axis: str
    pattern: Pattern
    excitation: Excitation
    level: float = 1.0


def runs(plan: Plan) -> tuple[DrivenRun, ...]:
    """All runs of `plan`, level by level.

    Raises
    ------
    BadInput : a band or a rate that no sweep can have.
    """
    found: list[DrivenRun] = []
    for level in plan.levels:
        ending = "" if level == plan.levels[0] else f"-at-{level:g}"
        found += [replace(run, name=f"{run.name}{ending}", level=level) for run in _of_level(plan, level)]
    return tuple(found)


def cross_motion(plan: Plan, run: str) -> CrossMotion | None:
    """What the table does besides in `run`; None for a table that does nothing else."""
    from fem.base_excitation.patterns import drawn

    return drawn(stream(plan.seed, "cross-motion", plan.article, run), plan.cross) if plan.cross else None


def _of_level(plan: Plan, level: float) -> list[DrivenRun]:
    further: Mapping[str, Callable[[Plan, float], list[DrivenRun]]] = {TWICE: _again, DIAGONAL: _diagonals}
    if plan.pattern == MULTI:
        return _together(plan, level)
    first = [_sweep(plan, level, axis, axis) for axis in MOTIONS]
    return first + (further[plan.pattern](plan, level) if plan.pattern in further else [])


def _again(plan: Plan, level: float) -> list[DrivenRun]:
    return [_sweep(plan, level, axis, f"{axis}-2", phase=np.pi / 2) for axis in MOTIONS]


def _sweep(plan: Plan, level: float, axis: str, name: str, phase: float = 0.0) -> DrivenRun:
    from fem.base_excitation.patterns import Sweep

    sweep = Sweep(axis=axis, level=level, phase=phase, **_swept(plan))
    return DrivenRun(name=name, axis=axis, pattern=sweep, excitation=_stated("sine-sweep", plan, level=sweep.amplitude))


def _diagonals(plan: Plan, level: float) -> list[DrivenRun]:
    from fem.base_excitation.patterns import MultiAxis, Sweep

    found = []
    for axes in DIAGONALS:
        sweeps = tuple(Sweep(axis=axis, level=level / np.sqrt(2), **_swept(plan)) for axis in axes)
        found.append(_several(plan, "-".join(axes), MultiAxis(patterns=sweeps), sweeps))
    return found


def _together(plan: Plan, level: float) -> list[DrivenRun]:
    from fem.base_excitation.patterns import phased_sweeps

    phased = phased_sweeps(level, **_swept(plan))
    return [_several(plan, f"multi-{k}", one, one.patterns) for k, one in enumerate(phased, start=1)]


def _several(plan: Plan, name: str, pattern: Pattern, sweeps: tuple[Any, ...]) -> DrivenRun:
    driven: dict[str, Sweep] = {sweep.axis: sweep for sweep in sweeps}
    levels = tuple(float(driven[axis].level * LEVELS[axis]) if axis in driven else 0.0 for axis in MOTIONS)
    return DrivenRun(name=name, axis="", pattern=pattern, excitation=_stated("multi-axis", plan, levels=levels))


def _swept(plan: Plan) -> dict[str, Any]:
    return {"start": plan.band[0], "stop": plan.band[1], "rate": plan.octaves_per_minute, "delay": plan.quiet}


def _stated(kind: str, plan: Plan, **more: float | tuple[float, ...]) -> Excitation:
    start, stop = plan.band
    figures = {"start_hz": start, "stop_hz": stop, "octaves_per_minute": plan.octaves_per_minute, **more}
    return Excitation(kind=kind, figures=figures)
