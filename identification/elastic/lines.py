"""`Lines`: a measured dynamic mass as weighted data: symmetric, with standard deviations, thinned where nothing happens.

A gain, an angle or a cross-talk of a sensor that is off makes an error in proportion to what else that row and that column carry,
alike at neighbouring lines. So the model-error floor is a share of the level of row and column at the line, and lines away from
resonances, which repeat the same error, count once in a quarter of a hertz.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array, Integers
from geometry.dynamic_mass import ComplexArray, DynamicMass
from geometry.errors import BadInput
from identification.elastic.model import SCALE, UPPER

APART = 0.25
"""Distance [Hz] of lines that are kept where the dynamic mass is smooth."""

CHANGE = 0.03
"""Change of an entry, in its level, from which the next line is kept too."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Lines:
    """Upper triangles of H, the two measured halves averaged by their weights.

    Attributes
    ----------
    frequency : (n,) [Hz]
    values : (n, 21) complex, order of `model.UPPER`
    deviation : (n, 21) standard deviation of the complex error, noise and floor together
    asymmetry : (2,) chi² of the differences of the two halves, which no symmetric model explains, and their number
    """

    frequency: Array
    values: ComplexArray
    deviation: Array
    asymmetry: tuple[float, int]

    @property
    def count(self) -> int:
        """Real numbers in the data."""
        return 2 * self.values.size

    def at(self, chosen: npt.ArrayLike) -> Lines:
        """The lines that `chosen` (mask or indices) picks."""
        k = np.asarray(chosen)
        return Lines(frequency=self.frequency[k], values=self.values[k], deviation=self.deviation[k], asymmetry=self.asymmetry)


def lines_of(measured: DynamicMass, noise: npt.ArrayLike | None, floor: float, band: tuple[float, float] | None) -> Lines:
    """All lines of `measured` in `band`.

    Parameters
    ----------
    noise : (n, 6, 6) standard deviation of the complex noise of H, in its units; none when None
    floor : model error as a share of the level of row and column

    Raises
    ------
    BadInput : no lines in the band, noise of another shape, a deviation that is not above zero.
    """
    low, high = band or (-np.inf, np.inf)
    inside = (measured.frequency >= low - 1e-9) & (measured.frequency <= high + 1e-9) & (measured.frequency > 0)
    if np.sum(inside) < 2:
        raise _refused("band", f"at least two lines are needed, found {np.sum(inside)} in {low:g} to {high:g} Hz", "Widen it")
    H = measured.matrix[inside]
    sd = floor * levels(H)
    if noise is not None:
        given = np.asarray(noise, dtype=np.float64)
        if given.shape != measured.matrix.shape or not np.all(given >= 0):
            problem = f"one standard deviation for each entry {measured.matrix.shape} is needed, found {given.shape}"
            raise _refused("weights", problem, "Give those of the dynamic mass, at least 0")
        sd = np.hypot(sd, given[inside])
    if not np.all(sd > 0):
        raise _refused("floor", "without noise a floor above zero is needed to weigh entries", "Leave the default, 0.002")
    return _halves(measured.frequency[inside], H, sd)


def levels(H: ComplexArray) -> Array:
    """(n, 6, 6) in the units of H: root mean square of its row and its column, rotations divided by their nominal length."""
    scale = np.outer(SCALE, SCALE)
    power = np.abs(H / scale) ** 2
    return np.asarray(scale * np.sqrt((power.sum(axis=2)[:, :, None] + power.sum(axis=1)[:, None, :]) / 2))


def kept(lines: Lines, measured: ComplexArray | None = None) -> Integers:
    """Indices of lines that say something new: `APART`, or where an entry changed by `CHANGE` of its level."""
    H = full(lines.values) if measured is None else measured
    values = (H / levels(H))[:, UPPER[0], UPPER[1]]
    chosen = [0]
    for k in range(1, len(values)):
        last = chosen[-1]
        moved = np.abs(values[k] - values[last]).max() >= CHANGE
        if moved or lines.frequency[k] - lines.frequency[last] >= APART - 1e-9 or k == len(values) - 1:
            chosen.append(k)
    return np.array(chosen)


def full(upper: ComplexArray) -> ComplexArray:
    """(n, 6, 6) symmetric from (n, 21)."""
    H = np.zeros((len(upper), 6, 6), dtype=np.complex128)
    H[:, UPPER[0], UPPER[1]] = H[:, UPPER[1], UPPER[0]] = upper
    return H


def _halves(frequency: Array, H: ComplexArray, sd: Array) -> Lines:
    i, j = UPPER
    off = i != j
    a, b, va, vb = H[:, i, j], H[:, j, i], sd[:, i, j] ** 2, sd[:, j, i] ** 2
    values = np.where(off, (a * vb + b * va) / (va + vb), a)
    variance = np.where(off, va * vb / (va + vb), va)
    chi2 = float(np.sum(2 * np.abs(a - b)[:, off] ** 2 / (va + vb)[:, off]))
    return Lines(
        frequency=frequency, values=values, deviation=np.sqrt(variance), asymmetry=(chi2, 2 * len(frequency) * int(np.sum(off)))
    )


def _refused(field: str, problem: str, remedy: str) -> BadInput:
    return BadInput(source="elastic fit", field=field, problem=problem, remedy=remedy)
