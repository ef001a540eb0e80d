"""How long a record must go on after the drive ends, so that what still rings is nothing that a spectrum would miss.

At the end of the drive every mode has a state, from which it decays with its own pole. The record is long enough when each of
them loads the table by less than a share of the greatest load of the run, forces and moments apart.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fem.base_excitation import recursion
from fem.base_excitation.base_motion import BaseMotion
from fem.base_excitation.driven_states import driven, inputs, load, seen
from fem.base_excitation.recursion import States, poles
from fem.base_excitation.rig import Rig
from fem.base_excitation.rig_structure import matrices
from geometry.arrays import Array

SHARE = 1e-4
"""Share of the greatest load below which what is left of a mode does no harm."""


def needed(rig: Rig, motion: BaseMotion, share: float = SHARE) -> float:
    """Length [s] that the record of `motion` must have, from its first sample; infinite when a driven mode has no damping.

    A rig with friction or cells that can lift off is taken as it is while nothing slips or lifts, loose parts left out.

    Raises
    ------
    BadInput : a rig that cannot be built.
    CheckFailed : something on the table swings freely.
    """
    structure = matrices(_linear(rig))
    system, samples = driven(structure), inputs(structure, motion)
    wanted, last = seen(load(structure), system), drive_end(motion)
    peak, state = np.zeros(2), np.zeros(len(system.A))
    for block in recursion.answer(system, wanted.of_states, samples, motion.sampling_rate, stop=last):
        found = block.outputs + samples[block.samples] @ wanted.of_inputs.T
        peak = np.maximum(peak, greatest(found))
        if block.samples.stop == last + 1:
            state = block.state
    return motion.driven + lasting(system, wanted.of_states, state, peak, share)


def warning(rig: Rig, motion: BaseMotion) -> str:
    """A sentence when the record of `motion` is cut while `rig` still rings, with the length that it needs; else empty.

    Raises
    ------
    BadInput, CheckFailed : as `needed`.
    """
    return judged(needed(rig, motion), motion)


def judged(length: float, motion: BaseMotion) -> str:
    """The sentence of `warning`, from the `length` [s] that is needed."""
    if motion.duration + 1 / motion.sampling_rate >= length:
        return ""
    cut = f"The record ends at {motion.duration:.4g} s"
    if not np.isfinite(length):
        return f"{cut}, but a driven mode has no damping and never stops ringing. Give it damping"
    rest = "before the drive has" if motion.duration < motion.driven else "while the article still rings"
    return f"{cut}, {rest}: {length:.4g} s are needed until no mode loads the table by more than {SHARE:g} of the greatest load"


def drive_end(motion: BaseMotion) -> int:
    """The sample at which the drive has ended, or the last one of the record."""
    return min(int(np.ceil(motion.driven * motion.sampling_rate - 1e-6)), len(motion.acceleration) - 1)


def greatest(loads: Array) -> Array:
    """(2,) greatest force [N] and moment [N m] among `loads` (k, 6)."""
    return np.array([np.linalg.norm(part, axis=1).max() for part in (loads[:, :3], loads[:, 3:])])


def lasting(system: States, wanted: Array, state: Array, peak: Array, share: float = SHARE) -> float:
    """[s] until every mode's load, `wanted` (6, 2 n) @ z from `state` (2 n,), has fallen below `share` of `peak` (2,)."""
    uncoupled = poles(system)
    if uncoupled is None:  # modes that cannot be told apart: all together, with the slowest decay
        pole = np.array([np.linalg.eigvals(system.A).real.max()])
        loads = np.linalg.norm(wanted, axis=1)[:, None] * np.linalg.norm(state)
    else:
        pole, loads = uncoupled.pole.real, np.abs((wanted @ uncoupled.shape) * (uncoupled.project @ state))
    left = np.array([np.linalg.norm(part, axis=0) for part in (loads[:3], loads[3:])])
    over = np.max(left / np.maximum(share * peak, np.finfo(np.float64).tiny)[:, None], axis=0, initial=0.0)
    rings = over > 1
    if np.any(pole[rings] >= 0):
        return float("inf")
    return float(np.max(np.log(over[rings]) / -pole[rings], initial=0.0))


def _linear(rig: Rig) -> Rig:
    return rig if rig.linear else replace(rig, frictions=(), cells=tuple(replace(cell, preload=None) for cell in rig.cells))
