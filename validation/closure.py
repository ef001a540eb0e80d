"""Closure: a model is shaken, and what is identified from the time histories must be the model again.

Runs of a simulated test go the way of a measured one - spectra of whole records, Eqs. 10 and 11 - and end in a dynamic mass,
which is held against the one that the model has by itself, in the frequency domain. Nothing of the model is known on the way.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from fem.base_excitation.response import Response
from geometry.arrays import Array
from geometry.dynamic_mass import MOTIONS, ComplexArray, DynamicMass
from identification.dynamic_mass import Estimate, from_runs
from identification.spectra.full_record import full_record

BANDWIDTHS = 5.0
"""A line is at a resonance when it lies within so many half-power half-widths zeta f of it."""

Above = Literal["table", "cover"]
"""What is taken for the base: the table, below the load cells, or the cover plate above them."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Deviation:
    """How far a dynamic mass that was identified lies from the model's own, on the diagonal.

    Attributes
    ----------
    off, at : (6,) largest share, axis by axis, off the resonances and at them; 0 where there is no such line
    """

    off: Array
    at: Array

    def by_axis(self) -> dict[str, tuple[float, float]]:
        """Both by the name of the axis."""
        return {name: (float(a), float(b)) for name, a, b in zip(MOTIONS, self.off, self.at, strict=True)}


def identified(runs: Iterable[Response], lines: Array, base: Above = "table") -> Estimate:
    """The dynamic mass of what stands on `base` from `runs`, one after the other, at `lines` (n,) [Hz].

    Raises
    ------
    BadInput : lines beyond Nyquist, fewer than six runs, a base motion that none of them drives.
    """
    loads: list[ComplexArray] = []
    motions: list[ComplexArray] = []
    point = np.zeros(3)
    for run in runs:
        point = run.reference_point
        loads.append(full_record(run.load, run.sampling_rate, lines))
        motions.append(full_record(getattr(run, base), run.sampling_rate, lines))
    return from_runs(np.array(loads), np.array(motions), lines, point)


def deviation(found: DynamicMass, model: DynamicMass, frequency: Array, damping_ratio: Array) -> Deviation:
    """Differences on the diagonal of `found` as shares of `model` at the same lines.

    A share is of the entry itself, or of the one at the first line where that is larger, since an antiresonance is no reason to
    divide by nothing.

    Parameters
    ----------
    frequency, damping_ratio : (m,) [Hz], [1] of the modes of the blocked structure
    """
    H, lines = np.einsum("nkk->nk", model.matrix), model.frequency
    scale = np.maximum(np.abs(H), np.abs(H[0]))
    share = np.abs(np.einsum("nkk->nk", found.matrix) - H) / scale
    near = np.abs(lines[:, None] - frequency) <= BANDWIDTHS * damping_ratio * frequency
    resonant = near.any(axis=1)
    return Deviation(off=share[~resonant].max(axis=0, initial=0.0), at=share[resonant].max(axis=0, initial=0.0))
