"""The dynamic mass of a structure from measured spectra: six runs that tell six base motions apart, the paper's Eqs. 9 to 11.

Columns of S_f and S_u are runs, rows are loads and base motions about one reference point, and at every line

    S_f = H S_u,   so   H = S_f S_u^-1                                            (Eqs. 10, 11)

With more than six runs the same is solved by least squares. The quotient of the driven axis alone (Eq. 8a) takes all that
the table does on the other five axes for an answer of the structure to the driven one.

How well six motions are told apart is the condition of S_u. It would depend on units - metres beside radians - so every motion is
divided by its nominal level before.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array, frozen
from geometry.dynamic_mass import LEVELS, MOTIONS, ComplexArray, DynamicMass
from geometry.errors import BadInput

SINGULAR = 1e9
"""Condition number of the scaled base motions from which runs do not tell six motions apart: what is left is rounding."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Estimate:
    """A dynamic mass from runs.

    Attributes
    ----------
    dynamic_mass : H about the reference point of the spectra
    condition : (n,) condition number [1] of the base motions at each line, every axis divided by its nominal level
    """

    dynamic_mass: DynamicMass
    condition: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "condition", frozen(self.condition, self.dynamic_mass.frequency.shape, "condition"))


def from_runs(
    load: npt.ArrayLike,
    motion: npt.ArrayLike,
    frequency: npt.ArrayLike,
    reference_point: npt.ArrayLike = (0.0, 0.0, 0.0),
    *,
    levels: Mapping[str, float] = LEVELS,
) -> Estimate:
    """H from the spectra of six runs or more (Eqs. 9 to 11; least squares of all runs at each line).

    Parameters
    ----------
    load : (r, n, 6) spectra of forces and moments of the table on the structure about the reference point, run by run
    motion : (r, n, 6) spectra of the base acceleration about the same point
    frequency : (n,) lines [Hz]
    reference_point : (3,) [m]
    levels : nominal acceleration of each axis, by which it is scaled for condition and solution

    Raises
    ------
    BadInput : fewer than six runs, shapes that do not fit, or motions that runs leave undriven at a line.
    """
    F, U, lines = _fitting(load, motion, frequency)
    scale = np.array([levels[axis] for axis in MOTIONS])
    columns = (U / scale).transpose(1, 2, 0)  # (n, 6, r)
    singular = np.linalg.svd(columns, compute_uv=False)
    condition = singular[:, 0] / np.maximum(singular[:, -1], np.finfo(np.float64).tiny)
    _require_driven(columns, condition, lines)
    H = np.asarray(F.transpose(1, 2, 0) @ np.linalg.pinv(columns) / scale, dtype=np.complex128)
    mass = DynamicMass(frequency=lines, matrix=H, reference_point=np.asarray(reference_point, dtype=np.float64))
    return Estimate(dynamic_mass=mass, condition=condition)


def quotient(load: npt.ArrayLike, motion: npt.ArrayLike, axis: str) -> ComplexArray:
    """The column (n, 6) of H by dividing one run's loads (n, 6) by the driven motion alone (Eq. 8a); `motion` (n, 6) spectra."""
    return np.asarray(np.asarray(load) / np.asarray(motion)[:, [MOTIONS.index(axis)]], dtype=np.complex128)


def _fitting(load: npt.ArrayLike, motion: npt.ArrayLike, frequency: npt.ArrayLike) -> tuple[ComplexArray, ComplexArray, Array]:
    F, U = np.asarray(load, dtype=np.complex128), np.asarray(motion, dtype=np.complex128)
    lines = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    if F.shape != U.shape or F.shape[1:] != (len(lines), 6):
        raise _refused(
            "load", f"spectra of six loads and six motions at {len(lines)} lines are needed, found {F.shape} and {U.shape}"
        )
    if len(F) < 6:
        raise _refused("runs", f"six linearly independent base motions take at least six runs, found {len(F)}")
    return F, U, lines


def _require_driven(columns: ComplexArray, condition: Array, lines: Array) -> None:
    worst = int(np.argmax(condition))
    if condition[worst] < SINGULAR:
        return
    U, _, _ = np.linalg.svd(columns[worst])
    axis = MOTIONS[int(np.argmax(np.abs(U[:, -1])))]
    raise _refused(
        "runs", f"the runs leave the base motion {axis} undriven at {lines[worst]:g} Hz (condition number {condition[worst]:.1e})"
    )


def _refused(field: str, problem: str) -> BadInput:
    return BadInput(
        source="dynamic mass from runs",
        field=field,
        problem=problem,
        remedy="Drive every one of the six axes in a run of its own",
    )
