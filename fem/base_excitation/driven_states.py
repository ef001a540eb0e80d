"""A rig on a driven table in first-order form: what drives it, and what is seen of it.

The inputs are the accelerations of the table, joined by its velocities and displacements where something is tied to the ground.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.base_excitation.base_motion import BaseMotion
from fem.base_excitation.recursion import Progress, States, answer, states, straightened
from fem.base_excitation.rig_structure import TABLE, RigStructure
from geometry.arrays import Array
from geometry.dynamic_mass import MOTIONS
from geometry.errors import CheckFailed

BEYOND = 1e100
"""What no channel reaches in any unit; the square of it is still a number."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Channels:
    """Channels as weighted sums of accelerations, velocities and displacements of a rig's coordinates: (o, 6 + n) each.

    `names` (o) say which is which.
    """

    names: tuple[str, ...]
    acceleration: Array
    velocity: Array
    displacement: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class Outputs:
    """The same channels from the states (o, 2 n) and the inputs (o, p)."""

    of_states: Array
    of_inputs: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class Run:
    """Channels over time, `samples` (N, o), and the `state` (2 n,) of the system when the drive has ended."""

    samples: Array
    state: Array


def driven(structure: RigStructure) -> States:
    """States of what moves on the table, driven by accelerations (and more) of the table.

    Raises
    ------
    CheckFailed : something swings freely.
    """
    y, t = slice(TABLE, None), slice(None, TABLE)
    M, C, K = structure.mass, structure.viscous, structure.stiffness
    loads = [M[y, t], C[y, t], K[y, t]] if structure.grounded else [M[y, t]]
    return states(M[y, y], C[y, y], K[y, y], -np.hstack(loads))


def run(structure: RigStructure, system: States, channels: Channels, motion: BaseMotion, progress: Progress | None = None) -> Run:
    """What `channels` show of `system`, at rest at the first sample, while the table makes `motion`.

    Raises
    ------
    CheckFailed : the answer grows beyond all numbers; with the first channel and time at which it does.
    """
    wanted, samples, last = seen(channels, system), _inputs(structure, motion), drive_end(motion)
    found, state = np.empty((len(wanted.of_states), len(samples))).T, np.zeros(len(system.A))  # a channel lies in one piece
    straight = straightened(samples) if len(system.A) else samples
    with np.errstate(over="ignore", invalid="ignore"):  # said below, in words
        for block in answer(system, wanted.of_states, straight, motion.sampling_rate, stop=last, progress=progress):
            np.add(block.outputs.T, wanted.of_inputs @ samples[block.samples].T, out=found[block.samples].T)
            require_bounded(found[block.samples], channels.names, block.samples.start, motion.sampling_rate)
            if block.samples.stop == last + 1:
                state = block.state
    return Run(samples=found, state=state)


def require_bounded(samples: Array, names: tuple[str, ...], start: int, sampling_rate: float) -> None:
    """Refuse `samples` (k, o) of channels `names` that have grown beyond all numbers; the first is the sample `start` of the run.

    Raises
    ------
    CheckFailed : with channel and time.
    """
    bounded = np.abs(samples) < BEYOND
    if bounded.all():
        return
    sample, channel = (int(i) for i in np.argwhere(~bounded)[0])
    time, name = (start + sample) / sampling_rate, names[channel]
    raise CheckFailed(
        f"The exact recursion lost the rig at {time:.6g} s: its {name} has grown beyond {BEYOND:g}. "
        "Look for a damping or stiffness that feeds energy in.",
        route="recursion",
        time=time,
        channel=name,
    )


def drive_end(motion: BaseMotion) -> int:
    """The sample at which the drive has ended, or the last one of the record."""
    return min(int(np.ceil(motion.driven * motion.sampling_rate - 1e-6)), len(motion.acceleration) - 1)


def _inputs(structure: RigStructure, motion: BaseMotion) -> Array:
    """(N, p) what drives `structure`: accelerations of the table, then, where it is tied down, velocities and displacements."""
    if not structure.grounded:
        return motion.acceleration
    return np.hstack([motion.acceleration, motion.velocity, motion.displacement])


def load(structure: RigStructure) -> Channels:
    """Force and moment of the table on all that stands on it, about F: the base row of the equations of motion."""
    t = slice(None, TABLE)
    return Channels(
        names=tuple(f"load {axis}" for axis in MOTIONS),
        acceleration=structure.mass[t],
        velocity=structure.viscous[t],
        displacement=structure.stiffness[t],
    )


def accelerations(rows: Array, name: str) -> Channels:
    """Acceleration of what moves as `rows` (o, 6 + n) say; `name` says whose it is."""
    names = tuple(f"acceleration {axis} of {name}" for axis in MOTIONS[: len(rows)])
    return Channels(names=names, acceleration=rows, velocity=np.zeros_like(rows), displacement=np.zeros_like(rows))


def cell_forces(structure: RigStructure) -> Channels:
    """(3 c) forces of the table on the cover plate through one cell after the other, along x, y, z."""
    c, size = len(structure.cells), structure.mass.shape[0]
    k, d = (values[:, :, None] * structure.cells for values in (structure.cell_stiffness, structure.cell_damping))
    nothing = np.zeros((3 * c, size))
    names = tuple(f"force of cell {cell} along {axis}" for cell in range(1, c + 1) for axis in "xyz")
    return Channels(names=names, acceleration=nothing, velocity=-d.reshape(3 * c, size), displacement=-k.reshape(3 * c, size))


def relative(structure: RigStructure) -> Channels:
    """The coordinates themselves, those of the table left out."""
    rows = np.eye(structure.mass.shape[0])[TABLE:]
    names = tuple(f"coordinate {row + 1}" for row in range(len(rows)))
    return Channels(names=names, acceleration=np.zeros_like(rows), velocity=np.zeros_like(rows), displacement=rows)


def stacked(parts: list[Channels]) -> Channels:
    """All of them, one under the other."""
    return Channels(
        names=tuple(name for part in parts for name in part.names),
        acceleration=np.vstack([part.acceleration for part in parts]),
        velocity=np.vstack([part.velocity for part in parts]),
        displacement=np.vstack([part.displacement for part in parts]),
    )


def seen(channels: Channels, system: States) -> Outputs:
    """`channels` from states and inputs of `system`."""
    y, t = slice(TABLE, None), slice(None, TABLE)
    second, first, none = channels.acceleration, channels.velocity, channels.displacement
    of_states = second[:, y] @ system.acceleration + first[:, y] @ system.velocity + none[:, y] @ system.displacement
    table = np.hstack([second[:, t], first[:, t], none[:, t]])[:, : system.B.shape[1]]
    return Outputs(of_states=of_states, of_inputs=second[:, y] @ system.direct + table)
