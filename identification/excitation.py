"""How well the runs tell six base motions apart, line by line, and in words where they do not.

Columns of S_u are runs. Every row is divided by the nominal level of its axis, so that metres stand beside radians; the condition
number of what is left does not know units. The left singular vector of the smallest singular value is the combination of base
motions that the runs drive least: where it holds one motion alone, that one is hardly driven; where it holds several, they move
together in every run and cannot be told apart.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from geometry.arrays import Array, frozen
from geometry.dynamic_mass import MOTIONS, ComplexArray
from geometry.errors import BadInput
from geometry.observability import combination

SINGULAR = 1e9
"""Condition number of the scaled base motions from which runs do not tell six motions apart: what is left is rounding."""

SHARE = 0.1
"""Share of the largest from which a base motion counts as part of the combination that is driven least."""

IN_PHASE = 0.1
"""Imaginary share of a combination from which its motions do not move in phase."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Excitation:
    """What the runs drive.

    Attributes
    ----------
    frequency : (n,) [Hz]
    singular : (n, 6) singular values of the base motions, every axis divided by its nominal level; descending
    directions : (n, 6, 6) complex: column k is the combination of scaled base motions that belongs to the k-th of them
    """

    frequency: Array
    singular: Array
    directions: ComplexArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "frequency", frozen(self.frequency, self.frequency.shape, "frequency"))
        object.__setattr__(self, "singular", frozen(self.singular, (*self.frequency.shape, 6), "singular"))

    @property
    def condition(self) -> Array:
        """(n,) condition number [1] of the scaled base motions; up to 1e16, where rounding is all that is left."""
        largest = np.maximum(self.singular[:, 0], np.finfo(np.float64).tiny)
        return np.asarray(1 / np.maximum(self.singular[:, -1] / largest, 1e-16))

    def weak(self, line: int, limit: float) -> ComplexArray:
        """(6, k) combinations of the scaled base motions at `line` that are driven less than 1 / `limit` of the strongest."""
        open_ = self.singular[line] * limit <= self.singular[line, 0]
        return np.asarray(self.directions[line][:, open_ if open_.any() else [-1]])


@dataclass(frozen=True, eq=False, kw_only=True)
class Exclusions:
    """Which lines are left out, and why.

    Attributes
    ----------
    kept : (n,) bool
    reasons : sentences, one for each stretch of neighbouring lines that are left out for the same reason
    """

    kept: np.ndarray[tuple[int], np.dtype[np.bool_]]
    reasons: tuple[str, ...]


def of_runs(motion: ComplexArray, frequency: Array, levels: Mapping[str, float]) -> Excitation:
    """The excitation by base motions (r, n, 6) at `frequency` (n,) [Hz], every axis scaled by its level."""
    scaled = (motion / np.array([levels[axis] for axis in MOTIONS])).transpose(1, 2, 0)
    directions, found, _ = np.linalg.svd(scaled)
    singular = np.zeros((len(frequency), 6))
    singular[:, : found.shape[1]] = found
    return Excitation(frequency=frequency, singular=singular, directions=directions)


def exclusions(excitation: Excitation, limit: float) -> Exclusions:
    """Lines whose condition number exceeds `limit` are left out; the reason names the base motions that move together there."""
    kept = excitation.condition <= limit
    out = [(k, names(excitation.weak(k, limit))) for k in np.flatnonzero(~kept).tolist()]
    # Neighbours with the same motions share a sentence: index minus rank is constant in a run of neighbours.
    stretches = groupby(enumerate(out), key=lambda item: (item[1][0] - item[0], item[1][1]))
    chosen = [[k for _, (k, _) in stretch] for _, stretch in stretches]
    return Exclusions(kept=kept, reasons=tuple(_reason(excitation, lines, limit) for lines in chosen))


def require_driven(excitation: Excitation) -> None:
    """Six base motions must be told apart at every line.

    Raises
    ------
    BadInput : the runs leave a combination of base motions undriven; it is named.
    """
    worst = int(np.argmax(excitation.condition))
    if excitation.condition[worst] < SINGULAR:
        return
    where = f"at {excitation.frequency[worst]:g} Hz (condition number {excitation.condition[worst]:.1e})"
    raise BadInput(
        source="dynamic mass from runs",
        field="runs",
        problem=f"the base motions are linearly dependent {where}: {said(excitation.weak(worst, SINGULAR))}",
        remedy="Drive every one of the six axes in a run of its own",
    )


def names(weak: ComplexArray) -> tuple[str, ...]:
    """The base motions that take part in the combinations `weak` (6, k)."""
    size = np.linalg.norm(weak, axis=1)
    return tuple(name for name, part in zip(MOTIONS, size, strict=True) if part >= SHARE * size.max())


def said(weak: ComplexArray) -> str:
    """What it means that the combinations `weak` (6, k) of scaled base motions are not driven."""
    involved = names(weak)
    listed = " and ".join(part for part in (", ".join(involved[:-1]), involved[-1]) if part)
    if len(involved) == weak.shape[1]:  # the axes themselves span what is not driven
        return f"hardly any run drives {listed}"
    if weak.shape[1] > 1:
        return f"{listed} move together so that {weak.shape[1]} combinations of them hardly move in any run"
    return f"{listed} move together: {_combined(weak[:, 0])} hardly moves in any run (every motion as a share of its level)"


def _combined(weak: ComplexArray) -> str:
    """The combination that stands still. It is v^H u, so shares are conjugate; the largest is real."""
    size = np.abs(weak)
    largest = weak[int(np.argmax(size))]
    share = np.where(size >= SHARE * size.max(), np.conj(weak) * largest / np.abs(largest), 0)
    lag = ", partly out of phase," if np.abs(share.imag).max() > IN_PHASE * size.max() else ""
    return combination(share.real, MOTIONS) + lag


def _reason(excitation: Excitation, lines: list[int], limit: float) -> str:
    f, condition = excitation.frequency[lines], excitation.condition[lines]
    where = f"{f[0]:g} Hz is" if len(f) == 1 else f"{f[0]:g} to {f[-1]:g} Hz ({len(f)} lines) are"
    worst = excitation.weak(lines[int(np.argmax(condition))], limit)
    return f"{where} left out, condition number up to {condition.max():.3g} where {limit:g} is allowed: {said(worst)}"
