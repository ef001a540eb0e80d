"""How long a record must go on after the drive ends, so that what still rings is nothing that a spectrum would miss.

At the end of the drive every mode has a state, from which it decays with its own pole. The record is long enough when each of
them loads the table by less than a share of the greatest load of the run, a moment counting as the force that makes it at the
radius of gyration.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fem.base_excitation.base_motion import BaseMotion
from fem.base_excitation.driven_states import Run, driven, load, run, seen
from fem.base_excitation.recursion import States, poles
from fem.base_excitation.rig import Rig
from fem.base_excitation.rig_structure import TABLE, RigStructure, matrices
from geometry.arrays import Array

SHARE = 1e-4
"""Share of the greatest load below which what is left of a mode does no harm."""

HAIR = 0.01
"""Share of a ring-down by which a record may be short without a word: its length may come from another sampling rate."""

UNDAMPED = 1e-14
"""Decay as a share of the highest frequency that is nothing but rounding."""


def needed(rig: Rig, motion: BaseMotion, share: float = SHARE) -> float:
    """Length [s] that the record of `motion` must have, from its first sample; infinite when a driven mode has no damping.

    A rig with friction or cells that can lift off is taken as it is while nothing slips or lifts, loose parts left out.

    Raises
    ------
    BadInput : a rig that cannot be built.
    CheckFailed : something on the table swings freely, or the answer grows beyond all numbers.
    """
    structure = matrices(_linear(rig))
    system = driven(structure)
    return motion.driven + lasting(structure, system, run(structure, system, load(structure), motion), share)


def warning(rig: Rig, motion: BaseMotion) -> str:
    """A sentence when the record of `motion` is cut while `rig` still rings, with the length that it needs; else empty.

    Raises
    ------
    BadInput, CheckFailed : as `needed`.
    """
    return judged(needed(rig, motion), motion)


def judged(length: float, motion: BaseMotion) -> str:
    """The sentence of `warning`, from the `length` [s] that is needed."""
    if motion.duration + 1 / motion.sampling_rate >= length - HAIR * (length - motion.driven):
        return ""
    cut = f"The record ends at {motion.duration:.4g} s"
    if not np.isfinite(length):
        return f"{cut}, but a driven mode has no damping and never stops ringing. Give it damping"
    rest = "before the drive has" if motion.duration < motion.driven else "while the article still rings"
    after = max(motion.duration - motion.driven, 0.0)
    return (
        f"{cut}, {rest}: after the drive {length - motion.driven:.4g} s are needed until no mode loads the table by more than "
        f"{SHARE:g} of the greatest load, found {after:.4g} s"
    )


def lasting(structure: RigStructure, system: States, done: Run, share: float = SHARE) -> float:
    """[s] after the drive until every mode's load has fallen below `share` of the greatest; `done` begins with the load."""
    greatest = size(structure, done.samples[:, :TABLE].T).max()
    return lasting_from(structure, system, done.state, float(greatest), share)


def lasting_from(structure: RigStructure, system: States, state: Array, greatest: float, share: float = SHARE) -> float:
    """[s] of rest from `state` (2 n,) on until every mode's load has fallen below `share` of the `greatest`, a `size` [N]."""
    uncoupled, wanted = poles(system), seen(load(structure), system).of_states
    if uncoupled is None:  # modes that cannot be told apart: all together, with the slowest decay
        decay = -np.array([np.linalg.eigvals(system.A).real.max()])
        loads = np.linalg.norm(wanted, axis=1)[:, None] * np.linalg.norm(state)
    else:
        decay, loads = -uncoupled.pole.real, np.abs((wanted @ uncoupled.shape) * (uncoupled.project @ state))
    left = size(structure, loads)
    rings = left > share * greatest
    if np.any(decay[rings] <= UNDAMPED * np.linalg.norm(system.A, 2)):
        return float("inf")
    return float(np.max(np.log(left[rings] / (share * greatest)) / decay[rings], initial=0.0))


def size(structure: RigStructure, loads: Array) -> Array:
    """(k,) [N] size of `loads` (6, k), moments over the radius of gyration about F."""
    M = np.diag(structure.mass)[:TABLE]
    return np.asarray(np.sqrt((loads[:3] ** 2).sum(axis=0) + (loads[3:] ** 2).sum(axis=0) * M[:3].sum() / M[3:].sum()))


def _linear(rig: Rig) -> Rig:
    return rig if rig.linear else replace(rig, frictions=(), cells=tuple(replace(cell, preload=None) for cell in rig.cells))
