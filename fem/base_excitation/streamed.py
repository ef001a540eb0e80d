"""A linear rig driven by a pattern, block by block: as `linear.respond`, and nothing of the run is kept but what is asked for.

The motion of every block is a closed form, the state of the rig is all that passes from one to the next, and how long the record
goes on after the drive is decided when it ends: until what still rings is nothing (`ring_down`), and some quiet after that.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from fem.base_excitation.driven_states import Channels, driven, load, require_bounded, seen, stacked
from fem.base_excitation.linear import require_fine
from fem.base_excitation.patterns.cross_motion import CrossMotion
from fem.base_excitation.patterns.pattern import Clock, Pattern, at, require_below_nyquist
from fem.base_excitation.recursion import solver
from fem.base_excitation.rig import Rig
from fem.base_excitation.rig_structure import TABLE, RigStructure, matrices
from fem.base_excitation.ring_down import SHARE, lasting_from, size
from geometry.arrays import Array
from geometry.errors import CheckFailed

BLOCK = 16_384
"""Samples that are answered at a time."""

LONGEST = 600.0
"""[s] that a record may go on after the drive."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Piece:
    """Some samples of a run.

    Attributes
    ----------
    motion : (3, 6, k) displacement, velocity and acceleration of the table
    values : (o, k) the channels that were asked for
    """

    motion: Array
    values: Array


def streamed(
    rig: Rig,
    pattern: Pattern,
    sampling_rate: float,
    channels: Callable[[RigStructure], Channels],
    *,
    cross: CrossMotion | None = None,
    quiet: float = 0.0,
    share: float = SHARE,
) -> Iterator[Piece]:
    """What `channels` show while `pattern` drives `rig`, from rest to rest.

    Parameters
    ----------
    sampling_rate : [Hz]
    channels : what is wanted of the equations of the rig
    cross : what the table does besides
    quiet : [s] of record after the ringing
    share : of the greatest load, below which ringing is nothing

    Raises
    ------
    BadInput : a rig that is not linear or cannot be built, a sampling rate too coarse for the pattern or for a kept mode.
    CheckFailed : something swings freely, the answer grows beyond all numbers, or it rings for more than `LONGEST`.
    """
    require_below_nyquist(pattern, sampling_rate)
    require_fine(rig.article, sampling_rate)
    structure = matrices(rig)
    system, wanted = driven(structure), stacked([load(structure), channels(structure)])
    outputs = seen(wanted, system)
    solve = solver(system, outputs.of_states, sampling_rate)
    end = pattern.driven + (cross.delay if cross else 0.0)
    start, stop, greatest = 0, int(np.ceil(end * sampling_rate)) + 1, 0.0
    rung_down = False
    while start < stop:
        count = min(BLOCK, stop - start)
        around = _motion(pattern, cross, start, count, sampling_rate, end)
        inputs = _inputs(structure, around)
        with np.errstate(over="ignore", invalid="ignore"):  # said below, in words
            found, state = solve(_straightened(inputs).T)
            values = found.T + outputs.of_inputs @ inputs[:, 1:-1]
        require_bounded(values.T, wanted.names, start, sampling_rate)
        greatest = max(greatest, float(size(structure, values[:TABLE]).max()))
        yield Piece(motion=around[:, :, 1:-1], values=values[TABLE:])
        start += count
        if start >= stop and not rung_down:
            rest = lasting_from(structure, system, state, greatest, share)
            stop, rung_down = start + int(np.ceil((_bearable(rest, pattern) + quiet) * sampling_rate)), True


def _motion(pattern: Pattern, cross: CrossMotion | None, start: int, count: int, rate: float, end: float) -> Array:
    """(3, 6, count + 2) motion of the table, from the sample before `start` on."""
    clock = Clock(sampling_rate=rate, count=count + 2, late=-(start - 1) / rate)
    return np.zeros((3, 6, count + 2)) if (start - 1) / rate > end else at(pattern, clock, cross)


def _inputs(structure: RigStructure, motion: Array) -> Array:
    """(p, k) what drives `structure`: accelerations of the table, then, where it is tied down, velocities and displacements."""
    return np.vstack([motion[2], motion[1], motion[0]]) if structure.grounded else motion[2]


def _straightened(inputs: Array) -> Array:
    """The inner of the samples (p, k + 2) lifted as `recursion.straightened` does: (p, k)."""
    return np.asarray(inputs[:, 1:-1] * (7 / 6) - (inputs[:, :-2] + inputs[:, 2:]) / 12)


def _bearable(rest: float, pattern: Pattern) -> float:
    if rest <= LONGEST:
        return rest
    raise CheckFailed(
        f"After the {pattern.label} the article rings for {rest:.3g} s, more than {LONGEST:g} s. Give it damping.", seconds=rest
    )
