"""What the limit of small motion costs: exudyn turns the table for real, and the linear equations are held against it.

    python examples/large_motion.py [ARTICLE ...]

Every article is driven by a sine at 4 Hz, where the angles of the paper's tests are largest, at 1, 3, 10 and 30 times the
nominal levels: about one axis, along and about an axis at once, about all three. The table shows what share of the load the
linear equations leave out, and with which power of the level it grows. An article called NAME:rigid is taken as one rigid body.

The linear response to a motion is that of the same model at a level so small that nothing but it is left, scaled up. What
remains of the full one is compared with it in one figure for all six components, the size of a load,

    |f|² = f^T M^-1 f,

with M the rigid mass matrix about the reference point. Force and moment so have one unit, and for a rigid body turning about
one axis there is a bound: |M a| is the norm of the field of accelerations, weighed with the mass. Tangential accelerations
omega' r and centripetal ones omega² r belong to the same radii, and the load has only the share of them that a rigid motion
can have, so that at any instant

    share left out <= largest omega² / largest omega',

which for a sine is its angle. It is proportional to the level, and lies at rest and at twice the driven frequency; at the
driven frequency itself there is nothing of it. An elastic article answers to it at these other frequencies, which may come
nearer to a resonance than the driven one, and turns second order into third at the driven one. The record of a sweep as a
whole has no such separation: the line f also holds twice the frequency that was driven at f / 2.

Where an axis is driven along and another about at once, the load also turns away from the prescribed acceleration, by the
angle. Whoever measures it on the table does not see that: accelerometers and load cells turn together.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from rich.console import Console
from rich.table import Table

from fem.base_excitation.patterns import BaseMotion, Jet, Sweep, sine, window
from fem.base_excitation.response import LIMIT
from fem.beam.frame import Plan, assemble
from fem.exudyn.large_motion import Conditions, plan_of, respond_of_plan
from geometry.dynamic_mass import LEVELS, MOTIONS, ComplexArray
from geometry.frames import Array
from validation.output import counted

ARTICLES = ("cuboid:rigid", "clumod-1:rigid", "clumod-1")
DRIVEN = (("alpha",), ("beta",), ("gamma",), ("x", "gamma"), ("alpha", "beta", "gamma"))
COARSE = 1
"""Elements in a half-blade; the share that is left out does not ask for more."""
NOTHING = 1e-9
"""Share that is rounding: about an axis through the CoG a balanced body pulls at nothing."""

AS_IT_STANDS = Conditions()
FACTORS = (1.0, 3.0, 10.0, 30.0)
"""Times the nominal levels: from angles of some milliradians to some tenths of a radian."""

SMALL = 1e-4
"""Times the nominal level: what is of second order is then below the seventh digit."""

RISE, STEADY = 2, 4
"""Cycles of a sine in which it rises and in which it stays."""

TINY = 1e-300
"""Where a logarithm is still a number."""

STEPS = 64
"""Of the integration in a cycle of the sine; its own error is that of the linear response too, and cancels."""


@dataclass(frozen=True, kw_only=True)
class Cost:
    """What the linear equations leave out of one run.

    Attributes
    ----------
    factor : on the nominal level
    angle : [rad] largest
    rate : [rad/s] largest
    peak : largest share of the load that is left out [1], over the largest load
    rms : the same of the root mean squares over the record
    at_line : the same at the driven frequency alone
    """

    factor: float
    angle: float
    rate: float
    peak: float
    rms: float
    at_line: float


def of_a_sine(
    plan: Plan,
    axes: Sequence[str],
    factors: Sequence[float] = FACTORS,
    conditions: Conditions = AS_IT_STANDS,
    *,
    frequency: float = 4.0,
    progress: Callable[[float], None] | None = None,
) -> tuple[Cost, ...]:
    """The costs of a sine at `frequency` [Hz] of all `axes` at once, in phase, at `factors` times their nominal levels.

    Raises
    ------
    BadInput, CheckFailed : as `fem.exudyn.large_motion.respond`.
    """
    weight, levels = size_of(plan), {axis: LEVELS[axis] for axis in axes}
    small = _load(plan, sine_of({axis: SMALL * level for axis, level in levels.items()}, frequency), conditions) / SMALL
    found = []
    for number, factor in enumerate(factors):
        motion = sine_of({axis: factor * level for axis, level in levels.items()}, frequency)
        found.append(_cost(factor, motion, _load(plan, motion, conditions) - factor * small, factor * small, weight, frequency))
        if progress is not None:
            progress((number + 1) / len(factors))
    return tuple(found)


def of_a_sweep(plan: Plan, axis: str, factor: float = 1.0, *, rate: float = 30.0, sampling_rate: float = 512.0) -> Array:
    """(n, 2) lines [Hz] of the band of a sweep and the share of the load left out at each, in the spectrum of the whole record.

    Parameters
    ----------
    rate : [octaves per minute]; a slow sweep and a fast one have the same shares, as both pass a line and its half alike
    """
    sweep = Sweep(axis=axis, level=factor, rate=rate)
    motions = [Sweep(axis=axis, level=k, rate=rate).motion(sampling_rate, ring_down=1.0) for k in (factor, factor * SMALL)]
    full, small = (_load(plan, motion, AS_IT_STANDS) for motion in motions)
    linear, weight = small / SMALL, size_of(plan)
    lines = np.fft.rfftfreq(len(full), 1 / sampling_rate)
    band = (lines >= sweep.start) & (lines <= sweep.stop)
    sizes = [_size(np.fft.rfft(load, axis=0)[band], weight) for load in (full - linear, linear)]
    return np.column_stack([lines[band], sizes[0] / sizes[1]])


def exponents(costs: Sequence[Cost]) -> Mapping[str, float]:
    """With which power of the level each share grows: 1 for what is of second order in the motion, 2 for third."""
    grown = np.log([cost.factor for cost in costs])
    shares = {name: np.log([max(getattr(cost, name), TINY) for cost in costs]) for name in ("peak", "rms", "at_line")}
    return {name: float(np.polyfit(grown, share, 1)[0]) for name, share in shares.items()}


def size_of(plan: Plan) -> Array:
    """M^-1 (6, 6) of the whole about the origin, which makes one size of forces and moments."""
    frame = assemble(plan)
    return np.asarray(np.linalg.inv(frame.rigid.T @ frame.mass @ frame.rigid), dtype=np.float64)


def _load(plan: Plan, motion: BaseMotion, conditions: Conditions) -> Array:
    return respond_of_plan(plan, motion, conditions).load


def sine_of(levels: Mapping[str, float], frequency: float) -> BaseMotion:
    """A sine of all axes in phase that rises to `levels` [m/s², rad/s²] in `RISE` cycles and stays there for `STEADY`."""
    omega, rate = 2 * np.pi * frequency, STEPS * frequency
    time = np.arange((RISE + STEADY) * STEPS + 1) / rate
    end = float(time[-1])
    angle = Jet(omega * time, np.full_like(time, omega), np.zeros_like(time))
    jet = omega**-2 * (window(time, 0.0, RISE / frequency, 2 * end, 3 * end) * sine(angle))
    level = [-levels.get(axis, 0.0) for axis in MOTIONS]
    displacement, velocity, acceleration = (np.outer(x, level) for x in (jet.value, jet.first, jet.second))
    return BaseMotion(
        sampling_rate=rate,
        displacement=displacement,
        velocity=velocity,
        acceleration=acceleration,
        driven=end,
        label=f"sine {frequency:g} Hz, {' and '.join(levels)}",
    )


def _cost(factor: float, motion: BaseMotion, left: Array, linear: Array, weight: Array, frequency: float) -> Cost:
    over_time = [_size(load, weight) for load in (left, linear)]
    at_line = [float(_size(_line(load, motion, frequency), weight)[0]) for load in (left, linear)]
    angle, rate = (float(np.linalg.norm(x[:, 3:], axis=1).max()) for x in (motion.displacement, motion.velocity))
    return Cost(
        factor=factor,
        angle=angle,
        rate=rate,
        peak=float(over_time[0].max() / over_time[1].max()),
        rms=float(np.linalg.norm(over_time[0]) / np.linalg.norm(over_time[1])),
        at_line=at_line[0] / at_line[1],
    )


def _line(load: Array, motion: BaseMotion, frequency: float) -> ComplexArray:
    """(1, 6) of whole steady cycles under a Hann window, which lets nothing in from rest and from twice the frequency."""
    steady = slice(RISE * STEPS, -1)
    turn = np.hanning(STEADY * STEPS + 1)[:-1] * np.exp(-2j * np.pi * frequency * motion.time[steady])
    return np.asarray(turn @ load[steady])[None, :]


def _size(loads: Array | ComplexArray, weight: Array) -> Array:
    """(n,) of loads (n, 6), real or complex."""
    return np.asarray(np.sqrt(np.einsum("ni,ij,nj->n", loads.conj(), weight, loads).real))


def studied(name: str, driven: Sequence[str]) -> tuple[Cost, ...]:
    """The costs of one article driven along and about the axes `driven`."""
    article, _, rigid = name.partition(":")
    return of_a_sine(plan_of(article, elements=None if rigid else COARSE), driven)


def table(names: Sequence[str], driven: Sequence[Sequence[str]]) -> Table:
    shown = Table(title="Share of the load that the linear equations leave out, sine at 4 Hz")
    for column in ("article", "driven", "level", "angle [mrad]", "rate [rad/s]", "peak", "rms", "at 4 Hz"):
        shown.add_column(column, justify="left" if column in ("article", "driven") else "right", no_wrap=True)
    for name in names:
        listed = {" + ".join(axes): axes for axes in driven}
        for words in counted(listed, f"Driving {name} along and about"):
            _add(shown, name, words, studied(name, listed[words]))
    return shown


def sweeps(name: str) -> str:
    """What the spectrum of a whole sweep leaves out, at nominal level."""
    article = plan_of(name.partition(":")[0])
    worst = {}
    for axis in ("alpha", "beta", "gamma"):
        found = of_a_sweep(article, axis)
        line, share = found[found[:, 1].argmax()]
        worst[axis] = f"{axis} {share:.2%} at {line:.1f} Hz"
    return f"In the spectrum of a whole sweep of {name} at nominal level, at most: {', '.join(worst.values())}."


def _add(shown: Table, name: str, driven: str, costs: Sequence[Cost]) -> None:
    for each in costs:
        shares = [_share(x) for x in (each.peak, each.rms, each.at_line)]
        shown.add_row(name, driven, f"{each.factor:g}", f"{1e3 * each.angle:.1f}", f"{each.rate:.3g}", *shares)
    grown = exponents(costs)
    powers = ["" if getattr(costs[0], x) < NOTHING else f"^{grown[x]:.1f}" for x in ("peak", "rms", "at_line")]
    shown.add_row("", "grows with level", "", "", "", *powers, end_section=True)


def _share(value: float) -> str:
    return "none" if value < NOTHING else f"{value:.2e}"


def main(console: Console, names: Sequence[str] = ARTICLES, driven: Sequence[Sequence[str]] = DRIVEN) -> None:
    console.print(table(names, driven))
    console.print(sweeps(names[0]))
    console.print(f"The limit of small motion, omega² / omega' and the angle below {LIMIT:g}, bounds the peak.")


if __name__ == "__main__":
    main(Console(), sys.argv[1:] or ARTICLES)
