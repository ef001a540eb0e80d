"""From a drive to runs: what the table does in each, by the patterns of `fem.base_excitation`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fem.base_excitation.base_motion import BaseMotion
from geometry.arrays import Array
from geometry.dynamic_mass import MOTIONS
from validation.excitation.asked import BURST, MULTI, RANDOM, Drive

if TYPE_CHECKING:
    from fem.base_excitation.patterns import CrossMotion, Pattern, Sweep


@dataclass(frozen=True, eq=False, kw_only=True)
class Run:
    """One run, before it is driven.

    Attributes
    ----------
    name : of its axis, or of its number where several are driven
    axes : indices of the axes driven on purpose
    pattern : what is driven
    sweep : the sweep whose frequency is that of the moment; None where there are many at once
    levels : (6,) acceleration asked for [m/s², rad/s²]: amplitude of a sine, root mean square of noise; 0 where nothing is driven
    """

    name: str
    axes: tuple[int, ...]
    pattern: Pattern
    sweep: Sweep | None
    levels: Array

    def motion(self, rate: float, ring_down: float, cross: CrossMotion | None) -> BaseMotion:
        """The run sampled at `rate` [Hz], with `ring_down` [s] of rest after it."""
        found: BaseMotion = self.pattern.motion(rate, ring_down=ring_down, cross=cross)  # type: ignore[attr-defined]
        return found


def runs(drive: Drive) -> tuple[Run, ...]:
    """The runs of `drive`, in the order in which they were asked for.

    Raises
    ------
    BadInput : a band, a rate or a duration that the pattern cannot have.
    """
    makers: dict[str, Callable[[Drive], tuple[Run, ...]]] = {RANDOM: _noises, BURST: _bursts, MULTI: _together}
    return makers.get(drive.pattern, _sweeps)(drive)


def cross_motion(drive: Drive) -> CrossMotion | None:
    """What the table does besides, the same in every run; None for a table that does nothing else."""
    from fem.base_excitation.patterns import drawn

    return drawn(np.random.default_rng(drive.seed), drive.cross) if drive.cross else None


def _sweeps(drive: Drive) -> tuple[Run, ...]:
    from fem.base_excitation.patterns import Sweep

    found = [Sweep(axis=axis, level=drive.level, **_swept(drive)) for axis in drive.axes]
    return tuple(_run(sweep.axis, (sweep.axis,), sweep, drive.level, sweep) for sweep in found)


def _together(drive: Drive) -> tuple[Run, ...]:
    """All six axes in six runs whose phases differ, or in one run the axes that were named."""
    from fem.base_excitation.patterns import MultiAxis, Sweep, phased_sweeps

    if drive.every:
        phased = phased_sweeps(drive.level, **_swept(drive))
        return tuple(_run(f"multi-{k}", MOTIONS, one, drive.level, one.patterns[0]) for k, one in enumerate(phased, start=1))
    phases = 2 * np.pi * np.arange(len(drive.axes)) / len(drive.axes)
    each = tuple(
        Sweep(axis=axis, level=drive.level, phase=float(phase), **_swept(drive))
        for axis, phase in zip(drive.axes, phases, strict=True)
    )
    return (_run("multi", drive.axes, MultiAxis(patterns=each), drive.level, each[0]),)


def _noises(drive: Drive) -> tuple[Run, ...]:
    from fem.base_excitation.patterns import LEVELS, Random

    made = ((axis, Random(rms={axis: drive.level * LEVELS[axis]}, seed=drive.seed, **_lasting(drive))) for axis in drive.axes)
    return tuple(_run(axis, (axis,), noise, drive.level, None) for axis, noise in made)


def _bursts(drive: Drive) -> tuple[Run, ...]:
    from fem.base_excitation.patterns import LEVELS, Burst

    made = ((axis, Burst(level={axis: drive.level * LEVELS[axis]}, seed=drive.seed, **_lasting(drive))) for axis in drive.axes)
    return tuple(_run(axis, (axis,), burst, drive.level, None) for axis, burst in made)


def _swept(drive: Drive) -> dict[str, Any]:
    return {"start": drive.band[0], "stop": drive.band[1], "rate": drive.octaves_per_minute}


def _lasting(drive: Drive) -> dict[str, Any]:
    given = {} if drive.duration is None else {"duration": drive.duration}
    return {"start": drive.band[0], "stop": drive.band[1], **given}


def _run(name: str, axes: tuple[str, ...], pattern: Pattern, level: float, sweep: Any) -> Run:
    from fem.base_excitation.patterns import LEVELS

    levels = np.array([level * LEVELS[axis] if axis in axes else 0.0 for axis in MOTIONS])
    return Run(name=name, axes=tuple(MOTIONS.index(axis) for axis in axes), pattern=pattern, sweep=sweep, levels=levels)
