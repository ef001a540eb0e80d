"""Checks that need no model of the structure: what any dynamic mass on stiff plates must satisfy, and which channel breaks it.

At the lowest lines every structure is nearly a rigid body, and its dynamic mass nearly the matrix of Eq. 1: symmetric - that one
at every line -, one mass along x, y and z, a skew coupling of forces and rotations, a positive diagonal, no phase. Departures
are told in tolerances: what an ordinary laboratory does not know of its sensors, put through Eqs. 6 to 11. What elasticity adds
is allowed for by the way H grows over the same lines. Redundant accelerometers and force channels must agree, too. Where
something does not hold, mistakes are tried one by one (`identification.mistakes`).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.dynamic_mass import MOTIONS, ComplexArray, DynamicMass
from geometry.errors import BadInput
from geometry.observability import LOADS
from geometry.tolerances import Tolerances
from identification.base_motion import STANDARD_GRAVITY, base_motion
from identification.dynamic_mass import from_runs
from identification.mistakes import LIMIT, Suspect, suspects
from identification.resultants import resultants
from identification.self_consistency import Readings, deviation, elasticity, misfit, readings
from identification.spectra.line_spectra import Spectra

ORDINARY = Tolerances()

Departure = tuple[str, npt.NDArray[np.complexfloating[Any, Any]], Array]
"""A name, how far something is from what it should be (n,), and the tolerance (n,) of that."""


@dataclass(frozen=True, kw_only=True)
class Finding:
    """One check.

    Attributes
    ----------
    name : "symmetry", "equal masses", "coupling", "diagonal", "phase", "redundancy", "parity" or "channels"
    holds : whether it is satisfied
    value : the worst departure [tolerances]
    text : the finding in words
    suspects : mistakes of "channels", the most likely first
    """

    name: str
    holds: bool
    value: float
    text: str
    suspects: tuple[Suspect, ...] = ()


def checks(
    dynamic_mass: DynamicMass, spectra: Spectra, tolerances: Tolerances = ORDINARY, *, gravity: float = STANDARD_GRAVITY
) -> tuple[Finding, ...]:
    """All checks of a dynamic mass and of the spectra that it came from.

    Parameters
    ----------
    dynamic_mass : about the reference point of the spectra, at their lines
    gravity : [m/s²], for channels that do not feel a tilt

    Raises
    ------
    BadInput : the dynamic mass has other lines than the spectra.
    """
    if dynamic_mass.frequency.shape != spectra.frequency.shape or np.any(dynamic_mass.frequency != spectra.frequency):
        problem = f"the dynamic mass has {len(dynamic_mass.frequency)} lines, the spectra have {len(spectra.frequency)} others"
        raise BadInput(source="closed checks", field="frequency", problem=problem, remedy="Give it at the lines of the spectra")
    of = readings(spectra, tolerances, gravity)
    H, sd = dynamic_mass.matrix[of.lines], deviation(of)
    rigid = np.hypot(sd, elasticity(of, H))
    return (
        _symmetry(H, sd),
        _masses(H, rigid),
        _coupling(H, rigid),
        _diagonal(H, sd),
        _phase(H, rigid),
        *_agreement(of),
        _channels(of),
    )


def of_spectra(spectra: Spectra, tolerances: Tolerances = ORDINARY, *, gravity: float = STANDARD_GRAVITY) -> tuple[Finding, ...]:
    """All checks of `spectra`; without those of the dynamic mass where their runs tell none.

    Raises
    ------
    BadInput : pick-ups or load cells that tell no base motion or no resultants.
    """
    motion, load = base_motion(spectra, gravity=gravity), resultants(spectra)
    try:
        estimate = from_runs(load.values, motion.values, spectra.frequency, spectra.table.origin)
    except BadInput:
        of = readings(spectra, tolerances, gravity)
        return (*_agreement(of), _channels(of))
    return checks(estimate.dynamic_mass, spectra, tolerances, gravity=gravity)


def _worst(departures: Iterable[Departure]) -> tuple[str, float]:
    """The name and the size in tolerances of the largest of (name, departure (n,), tolerance (n,))."""
    sizes = {name: float(np.max(np.abs(departure) / tolerance)) for name, departure, tolerance in departures}
    name = max(sizes, key=sizes.__getitem__)
    return name, sizes[name]


def _finding(name: str, sound: str, broken: str, departures: Iterable[Departure]) -> Finding:
    where, value = _worst(departures)
    holds = value**2 <= LIMIT
    said = sound if holds else broken.format(where)
    return Finding(name=name, holds=holds, value=value, text=f"{said} (worst {where}: {value:.2g} tolerances)")


def _pairs(indices: range) -> list[tuple[int, int]]:
    return [(j, k) for j in indices for k in indices if j < k]


def _symmetry(H: ComplexArray, sd: Array) -> Finding:
    departures = [
        (f"{LOADS[j]} by {MOTIONS[k]}", H[:, j, k] - H[:, k, j], np.hypot(sd[:, j, k], sd[:, k, j])) for j, k in _pairs(range(6))
    ]
    return _finding("symmetry", "the dynamic mass is symmetric", "the dynamic mass is not symmetric in {}", departures)


def _masses(H: ComplexArray, sd: Array) -> Finding:
    departures = [
        (f"{MOTIONS[j]} and {MOTIONS[k]}", H[:, j, j] - H[:, k, k], np.hypot(sd[:, j, j], sd[:, k, k]))
        for j, k in _pairs(range(3))
    ]
    departures += [(f"{LOADS[j]} by {MOTIONS[k]}", H[:, j, k], sd[:, j, k]) for j in range(3) for k in range(3) if j != k]
    sound = "the masses along x, y and z are one and do not couple"
    return _finding("equal masses", sound, "the masses along x, y and z are not one, or they couple: {}", departures)


def _coupling(H: ComplexArray, sd: Array) -> Finding:
    own = [(f"{LOADS[j]} by {MOTIONS[j + 3]}", H[:, j, j + 3], sd[:, j, j + 3]) for j in range(3)]
    skew = [
        (
            f"{LOADS[j]} by {MOTIONS[k + 3]} and {LOADS[k]} by {MOTIONS[j + 3]}",
            H[:, j, k + 3] + H[:, k, j + 3],
            np.hypot(sd[:, j, k + 3], sd[:, k, j + 3]),
        )
        for j, k in _pairs(range(3))
    ]
    return _finding("coupling", "the coupling of forces and rotations is skew", "the coupling is not skew in {}", [*own, *skew])


def _diagonal(H: ComplexArray, sd: Array) -> Finding:
    lowest = np.diagonal(H[0]).real / np.diagonal(sd[0])
    negative = [MOTIONS[k] for k in np.flatnonzero(lowest <= 0).tolist()]
    text = f"the diagonal is negative for {', '.join(negative)}" if negative else "the diagonal is positive"
    return Finding(name="diagonal", holds=not negative, value=float(max(0.0, -lowest.min())), text=text)


def _phase(H: ComplexArray, sd: Array) -> Finding:
    departures = [(f"{LOADS[k]} by {MOTIONS[k]}", np.asarray(1j * H[:, k, k].imag), sd[:, k, k]) for k in range(6)]
    sound = "loads are in phase with the motions at low frequency"
    return _finding("phase", sound, "loads are out of phase with the motions at low frequency: {}", departures)


def _agreement(of: Readings) -> tuple[Finding, Finding]:
    found = misfit(of, of.values[None], of.noise[None])
    return (
        _agreed(
            "redundancy",
            found.redundancy,
            "the accelerometers of table and cover plate {} one base motion",
            ("tell", "do not tell"),
        ),
        _agreed("parity", found.parity, "the redundant force channels {}", ("agree", "contradict each other")),
    )


def _agreed(name: str, square: Array, sentence: str, words: tuple[str, str]) -> Finding:
    value, holds = float(np.sqrt(square[0])), bool(square[0] <= LIMIT)
    return Finding(name=name, holds=holds, value=value, text=f"{sentence.format(words[not holds])} ({value:.2g} tolerances rms)")


def _channels(of: Readings) -> Finding:
    found, total = suspects(of), misfit(of, of.values[None], of.noise[None])
    value = float(np.sqrt(total.worst[0]))
    if not found:
        text = (
            "no channel is suspected" if value**2 <= LIMIT else "something is wrong that no wrong sign, exchange or unit explains"
        )
        return Finding(name="channels", holds=value**2 <= LIMIT, value=value, text=text)
    words = " or ".join(one.text for one in found)
    enough = "" if found[0].explains else ", which is not enough: look for more behind it"
    return Finding(name="channels", holds=False, value=value, text=f"it looks as if {words}{enough}", suspects=found)
