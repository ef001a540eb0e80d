"""Exact answer of a linear system to piecewise linear input, sample by sample (first-order hold).

    M y'' + C y' + K y = B p(t)

With the undamped modes y = Phi eta and the state z = (omega eta, eta'), which measures energy, the system is z' = A z + ... with
a matrix A that is nearly skew, so that its eigenvectors are well conditioned whatever the damping couples: clusters, overdamped
pairs, damping beside the diagonal. Each first-order equation w' = lambda w + b p then has the exact solution over a step h

    w(t + h) = exp(s) w(t) + h (phi1(s) - phi2(s)) b p(t) + h phi2(s) b p(t + h),   s = lambda h,
    phi1(s) = (exp(s) - 1) / s,   phi2(s) = (exp(s) - 1 - s) / s²

(Hochbruck & Ostermann, Acta Numerica 19, 2010). Where eigenvectors coincide (critical damping) the matrix exponential steps all
states together: as exact, and slower.

Motion that is smooth between its samples is not piecewise linear: at frequency f the answer comes out too small by the factor
sinc²(f h), that is by x²/12 with x = omega h; what the corners excite besides, at the sampling rate and above, counts only for
modes up there. `straightened` lifts the samples beforehand, p - (p(t + h) - 2 p(t) + p(t - h)) / 12, which leaves x⁴/90: 2e-9
instead of 4e-5 at 28 Hz and 8192 Hz.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import factorial

import numpy as np

from fem.base_excitation.patterns import BaseMotion
from fem.base_excitation.rig import TABLE, RigStructure
from geometry.dynamic_mass import MOTIONS, ComplexArray
from geometry.errors import CheckFailed
from geometry.frames import Array, freeze

Progress = Callable[[float], None]
"""Called with the share done, 0 to 1; it may raise to end the run."""

WELL_CONDITIONED = 1e6
"""Condition of the eigenvectors up to which rounding stays below 1e-9 of the answer."""

BLOCK = 32_768
"""Samples that are answered at a time, to spare memory."""

TOGETHER = 64
"""Samples that are stepped through one by one, in as many rows at once: states of some dozens of modes then stay in the cache."""

SMALL = 0.1
"""Below this size of s a series gives phi1 and phi2, where their closed form would lose digits."""

TERMS = 12


@dataclass(frozen=True, eq=False, kw_only=True)
class States:
    """First-order form z' = A z + B p of a second-order system.

    Attributes
    ----------
    A : (2 n, 2 n) on z = (omega eta, eta') [rad/s]
    B : (2 n, p)
    displacement, velocity : (n, 2 n) y and y' from z
    acceleration, direct : (n, 2 n) and (n, p), y'' = acceleration @ z + direct @ p
    """

    A: Array
    B: Array
    displacement: Array
    velocity: Array
    acceleration: Array
    direct: Array

    def __post_init__(self) -> None:
        freeze(self, "A", "B", "displacement", "velocity", "acceleration", "direct")


@dataclass(frozen=True, eq=False, kw_only=True)
class Poles:
    """The same system, uncoupled: w' = pole w + drive p, z = Re(shape @ w), w = project @ z.

    Attributes
    ----------
    pole : (m,) complex [rad/s], of each conjugate pair the one above the real axis, and the real ones
    drive : (m, p) complex
    shape : (2 n, m) complex, doubled for a pair, so that the other of the two is counted
    project : (m, 2 n) complex
    """

    pole: ComplexArray
    drive: ComplexArray
    shape: ComplexArray
    project: ComplexArray


@dataclass(frozen=True, eq=False, kw_only=True)
class Block:
    """Some samples of an answer.

    Attributes
    ----------
    samples : which, k of them
    outputs : (k, o)
    state : (2 n,) z at the last of them
    """

    samples: slice
    outputs: Array
    state: Array


def states(mass: Array, viscous: Array, stiffness: Array, input_matrix: Array) -> States:
    """First-order form of M y'' + C y' + K y = B p; `input_matrix` (n, p).

    Raises
    ------
    CheckFailed : a mass or stiffness that is not positive definite: something moves freely.
    """
    from scipy.linalg import LinAlgError, eigh

    n = len(mass)
    if not n:
        none, square = np.zeros((0, input_matrix.shape[1])), np.zeros((0, 0))
        return States(A=square, B=none, displacement=square, velocity=square, acceleration=square, direct=none)
    try:
        squares, Phi = eigh(stiffness, mass)
    except LinAlgError:
        raise CheckFailed("The mass matrix of what moves on the table is not positive definite.") from None
    if squares[0] <= np.finfo(np.float64).eps * squares[-1]:
        said = (
            f"Something on the table swings freely: its lowest squared frequency is {squares[0]:.3g} (rad/s)², nothing but "
            f"rounding beside the highest of {squares[-1]:.3g}. Hold it, or soften what is stiffest."
        )
        raise CheckFailed(said, squared_frequency=float(squares[0]), greatest=float(squares[-1]))
    omega, C = np.sqrt(squares), Phi.T @ viscous @ Phi
    zero = np.zeros((n, n))
    B = np.vstack([np.zeros((n, input_matrix.shape[1])), Phi.T @ input_matrix])
    lower = np.hstack([-np.diag(omega), -(C + C.T) / 2])
    return States(
        A=np.vstack([np.hstack([zero, np.diag(omega)]), lower]),
        B=B,
        displacement=np.hstack([Phi / omega, zero]),
        velocity=np.hstack([zero, Phi]),
        acceleration=Phi @ lower,
        direct=Phi @ B[n:],
    )


def poles(system: States) -> Poles | None:
    """`system` uncoupled, or None when its eigenvectors are too close to one another."""
    value, V = (np.asarray(found, dtype=np.complex128) for found in np.linalg.eig(system.A))
    if value.size and np.linalg.cond(V) > WELL_CONDITIONED:
        return None
    one, project = value.imag >= 0, np.asarray(np.linalg.inv(V), dtype=np.complex128)
    return Poles(
        pole=value[one],
        drive=(project @ system.B)[one],
        shape=V[:, one] * np.where(value[one].imag > 0, 2.0, 1.0),
        project=project[one],
    )


def answer(
    system: States,
    outputs: Array,
    samples: Array,
    sampling_rate: float,
    *,
    stop: int | None = None,
    progress: Progress | None = None,
) -> Iterator[Block]:
    """`outputs` (o, 2 n) @ z of `system`, at rest at the first sample, block after block.

    Parameters
    ----------
    samples : (N, p) input, between samples along straight lines
    sampling_rate : [Hz]
    stop : a sample at which one block ends, whose state is wanted
    """
    solve = solver(system, outputs, sampling_rate)
    edges = {*range(0, len(samples), BLOCK), len(samples)}
    if stop is not None:
        edges.add(min(stop + 1, len(samples)))
    for start, end in pairwise(sorted(edges)):
        found, state = solve(samples[start:end])
        yield Block(samples=slice(start, end), outputs=found, state=state)
        if progress is not None:
            progress(end / len(samples))


def solver(system: States, outputs: Array, sampling_rate: float) -> Callable[[Array], tuple[Array, Array]]:
    """What answers block after block of samples (k, p), at rest at the first: `outputs` (k, o), and state (2 n,) at the end."""
    uncoupled, step = poles(system), 1 / sampling_rate
    return _by_stepping(system, outputs, step) if uncoupled is None else _by_poles(uncoupled, outputs, step)


def straightened(samples: Array) -> Array:
    """Input (N, p) to which straight lines between samples answer as a smooth motion through `samples` (N, p) would.

    Before the first sample there is none, and after the last one it goes on as it is.
    """
    lifted = samples * (7 / 6)
    lifted[1:] -= samples[:-1] / 12
    lifted[:-1] -= samples[1:] / 12
    lifted[-1:] -= samples[-1:] / 12
    return np.asarray(lifted)


def _by_poles(uncoupled: Poles, outputs: Array, step: float) -> Callable[[Array], tuple[Array, Array]]:
    """What answers the next block of samples, from where the last one ended: outputs (k, o), state (2 n,) at the end."""
    growth, now, ahead = held(uncoupled.pole * step)
    # A complex number lies in memory as its two parts, side by side: all products are real ones, those of BLAS and half as many
    pushing = np.ascontiguousarray(np.vstack([step * share * uncoupled.drive.T for share in (ahead, now)])).view(np.float64)
    seen = np.ascontiguousarray((outputs @ uncoupled.shape).conj()).view(np.float64)
    before, state = np.full(uncoupled.drive.shape[1], np.nan), np.zeros(len(growth), dtype=np.complex128)

    def solve(samples: Array) -> tuple[Array, Array]:
        nonlocal before, state
        if len(samples) > TOGETHER**2:
            pieces = [solve(samples[k : k + TOGETHER**2]) for k in range(0, len(samples), TOGETHER**2)]
            return np.hstack([found.T for found, _ in pieces]).T, pieces[-1][1]
        # Input now and one sample before
        inputs = np.hstack([samples, np.vstack([before, samples[:-1]])])
        if np.any(np.isnan(before)):
            inputs[0] = 0.0  # at rest at the first sample
        w = carried((inputs @ pushing).view(np.complex128), growth, state)
        before, state = samples[-1].copy(), w[-1].copy()
        return (seen @ w.view(np.float64).T).T, np.asarray((uncoupled.shape @ state).real)

    return solve


def carried(pushed: ComplexArray, growth: ComplexArray, state: ComplexArray) -> ComplexArray:
    """States (n, m) w_k = growth w_(k-1) + pushed_k of (n, m) that are `pushed`, from `state` (m,) on."""
    count, rows = len(pushed), -(-len(pushed) // TOGETHER)
    whole = np.zeros((rows * TOGETHER, len(growth)), dtype=np.complex128)
    whole[:count] = pushed
    # In rows of `TOGETHER` samples, which are answered from rest all at once; then what every row begins with, and its trace
    w, powers = whole.reshape(rows, TOGETHER, -1).transpose(1, 0, 2), growth ** np.arange(1, TOGETHER + 1)[:, None]
    for k in range(1, TOGETHER):
        w[k] += growth * w[k - 1]
    start = np.empty((rows, len(growth)), dtype=np.complex128)
    for k in range(rows):
        start[k], state = state, w[-1, k] + powers[-1] * state
    for k in range(TOGETHER):
        w[k] += powers[k] * start
    return whole[:count]


def stepped(uncoupled: Poles, step: float, inputs: int, length: int) -> list[ComplexArray]:
    """States k = 0 to `length` samples after one, each (m, m + `inputs` (`length` + 3)): by the states there, and by every one of
    `inputs`, the first of which drive, `length` + 3 samples of it from the one before on, `straightened` here."""
    growth, now, ahead = held(uncoupled.pole * step)
    m, p = uncoupled.drive.shape
    lifted = step * uncoupled.drive[:, :, None] * np.array([-1.0, 14.0, -1.0]) / 12
    found = [np.eye(m, m + inputs * (length + 3), dtype=np.complex128)]
    for k in range(length):
        found.append(growth[:, None] * found[-1])
        driven = found[-1][:, m:].reshape(m, inputs, length + 3)[:, :p]
        driven[:, :, k : k + 3] += now[:, None, None] * lifted
        driven[:, :, k + 1 : k + 4] += ahead[:, None, None] * lifted
    return found


def _by_stepping(system: States, outputs: Array, step: float) -> Callable[[Array], tuple[Array, Array]]:
    """The same by the matrix exponential, all states together."""
    from scipy.linalg import expm

    # growth, first and last of the whole system, from one matrix exponential (Van Loan, IEEE Trans. Autom. Control 23, 1978)
    n, p = system.B.shape
    whole = np.zeros((n + 2 * p, n + 2 * p))
    whole[:n, :n], whole[:n, n : n + p] = step * system.A, step * system.B
    whole[n : n + p, n + p :] = np.eye(p)
    E = expm(whole)
    growth, last = E[:n, :n], E[:n, n + p :]
    first = E[:n, n : n + p] - last
    state = np.zeros(len(system.A))
    before: Array | None = None

    def solve(samples: Array) -> tuple[Array, Array]:
        nonlocal state, before
        z = np.empty((len(samples), len(state)))
        for k, forces in enumerate(samples):
            if before is not None:
                state = growth @ state + first @ before + last @ forces
            z[k], before = state, forces
        return z @ outputs.T, state

    return solve


def held(s: ComplexArray) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """exp(s), phi1(s) - phi2(s) and phi2(s): what the state before, the input before and the input now are multiplied by."""
    near = np.abs(s) < SMALL
    far = np.where(near, 1.0, s)
    phi1 = np.where(near, _series(s, 1), np.expm1(far) / far)
    phi2 = np.where(near, _series(s, 2), (np.expm1(far) - far) / far**2)
    return np.exp(s), phi1 - phi2, phi2


def _series(s: ComplexArray, order: int) -> ComplexArray:
    """sum over k of s^k / (k + order)!, by Horner."""
    total = np.zeros_like(s)
    for k in reversed(range(TERMS)):
        total = total * s + 1 / factorial(k + order)
    return total


# A rig on a driven table in first-order form: what drives it, and what is seen of it.
#
# The inputs are the accelerations of the table, joined by its velocities and displacements where something is tied to the ground.

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
    """The same channels from the states (o, 2 n), and from accelerations, velocities and displacements of the table (o, 18)."""

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
    # The sample at which the drive has ended, or the last one of the record
    wanted = seen(channels, system)
    # (N, p) what drives `structure`: accelerations of the table, then, where it is tied down, velocities and displacements
    if not structure.grounded:
        samples = motion.acceleration
    else:
        samples = np.hstack([motion.acceleration, motion.velocity, motion.displacement])
    of_inputs = wanted.of_inputs[:, : samples.shape[1]]
    last = min(int(np.ceil(motion.driven * motion.sampling_rate - 1e-6)), len(motion.acceleration) - 1)
    found, state = np.empty((len(wanted.of_states), len(samples))).T, np.zeros(len(system.A))  # a channel lies in one piece
    straight = straightened(samples) if len(system.A) else samples
    with np.errstate(over="ignore", invalid="ignore"):  # said below, in words
        for block in answer(system, wanted.of_states, straight, motion.sampling_rate, stop=last, progress=progress):
            np.add(block.outputs.T, of_inputs @ samples[block.samples].T, out=found[block.samples].T)
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
    said = (
        f"The exact recursion lost the rig at {time:.6g} s: its {name} has grown beyond {BEYOND:g}. "
        "Look for a damping or stiffness that feeds energy in."
    )
    raise CheckFailed(said, route="recursion", time=time, channel=name)


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
    of_inputs = np.hstack([second[:, t], first[:, t], none[:, t]])
    of_inputs[:, : system.B.shape[1]] += second[:, y] @ system.direct
    return Outputs(of_states=of_states, of_inputs=of_inputs)
