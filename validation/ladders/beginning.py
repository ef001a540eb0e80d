"""Where the fit of an effect begins that no fit finds from afar: a resonator by its frequency, a part by its modulus.

A resonator answers at its own frequency only. A fit that begins a few of its widths beside it sees nothing of it, and one that a
user takes from a spectrum is soon that far off. So its frequency is looked for where the data are, or around what the user says,
at the solution of the model without it; its mass is what the data want there, and its damping ratio is modest.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from geometry.arrays import Array
from validation.effects.family import Size
from validation.effects.identifiers import Named
from validation.engine.parameter import EFFECT, Parameter
from validation.engine.prediction import Offsets
from validation.engine.problem import Problem
from validation.engine.starting import start
from validation.models.model import Added

MASS, FREQUENCY, DAMPING = RESONATOR = ("m", "f", "zeta")
"""Keys of the sizes by which a family is a resonator."""

MODEST = 0.02
"""Damping ratio at which a resonator is looked for of which nothing is said."""

AROUND = 1.5
"""Factor either way within which a frequency is looked for that the user says."""

SPACING = 0.035
"""From one frequency to the next, as a share: less than twice the width of a resonance of `MODEST` damping."""


def begun(
    added: Added, left: Sequence[str], problem: Problem, base: Offsets, progress: Callable[[float], None] | None = None
) -> Added:
    """`added` with the sizes at which its fit begins.

    Parameters
    ----------
    left : keys of the sizes of which the user said nothing
    problem : of the model with it
    base : the plain fit of the model without it
    """
    named = added.named
    free = {size.key: one for size in named.sizes if (one := _parameter(problem, named, size.key)) is not None}
    if added.fixed:
        return added
    if set(RESONATOR) <= set(free):
        places = _dictionary(free, left, problem)
        found = start(problem, tuple(places), base=base, places=places, amplitude=free[MASS].name, progress=progress)
        return _at(added, free, found)
    far = {key: one for key, one in free.items() if key in left and _is_far(named, key)}
    return _at(added, far, start(problem, [one.name for one in far.values()], base=base, progress=progress)) if far else added


def _dictionary(free: Mapping[str, Parameter], left: Sequence[str], problem: Problem) -> dict[str, Array]:
    """By name of frequency and damping ratio, the offsets at which a resonator is looked for."""
    lines = np.concatenate([one.measured.frequency for one in problem.predictions])
    own = free[FREQUENCY].nominal
    low, high = (lines.min(), lines.max()) if FREQUENCY in left else (own / AROUND, own * AROUND)
    low = max(float(low), float(high) / 1e3)
    along = np.geomspace(low, high, 2 + int(np.log(high / low) / SPACING))
    ratio = MODEST if DAMPING in left else free[DAMPING].nominal
    return {
        free[FREQUENCY].name: np.array([free[FREQUENCY].offset(f) for f in along]),
        free[DAMPING].name: np.array([free[DAMPING].offset(ratio)]),
    }


def _at(added: Added, free: Mapping[str, Parameter], found: Offsets) -> Added:
    """`added` at the offsets `found` of the parameters `free`, by key, within what its family allows."""
    values = dict(added.named.values)
    for size in added.named.sizes:
        if size.key in free:
            one = free[size.key]
            values[size.key] = min(max(one.value(found.get(one.name, one.start)), size.low), size.high)
    return replace(added, named=replace(added.named, values=values))


def _parameter(problem: Problem, named: Named, key: str) -> Parameter | None:
    one = problem.by_name.get(f"{named.id}[{key}]" if key else named.id)
    return one if one is not None and one.kind == EFFECT else None


def _is_far(named: Named, key: str) -> bool:
    """Whether a fit cannot find it from afar: a corner or a resonance, the modulus of a part."""
    return _is_frequency(next(size for size in named.sizes if size.key == key)) or named.family == "modulus"


def _is_frequency(size: Size) -> bool:
    return size.unit == "Hz" and size.logarithmic
