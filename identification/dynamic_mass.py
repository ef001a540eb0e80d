"""The dynamic mass of a structure from measured spectra: six runs that tell six base motions apart, the paper's Eqs. 9 to 11.

Columns of S_f and S_u are runs, rows are loads and base motions about one reference point, and at every line

    S_f = H S_u,   so   H = S_f S_u^-1                                            (Eqs. 10, 11)

With more than six runs the same is solved by least squares, each run with its weight. How well six motions are told apart is the
condition of S_u (`identification.excitation`); what noise does to H, and what to do about noise of the motions,
`identification.errors_in_variables`; what the simple quotient of the driven axis costs, `identification.cross_motion`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.dynamic_mass import LEVELS, MOTIONS, ComplexArray, DynamicMass
from geometry.errors import BadInput
from identification import excitation
from identification.excitation import Excitation, Exclusions


@dataclass(frozen=True, eq=False, kw_only=True)
class Estimate:
    """A dynamic mass from runs.

    Attributes
    ----------
    dynamic_mass : H about the reference point of the spectra
    excitation : how well the runs tell the six base motions apart, line by line
    inverse : (n, r, 6) the pseudo-inverse of S_u: H = S_f inverse, and an error of loads reaches H through it
    """

    dynamic_mass: DynamicMass
    excitation: Excitation
    inverse: ComplexArray

    @property
    def condition(self) -> Array:
        """(n,) condition number [1] of the base motions at each line, every axis divided by its nominal level."""
        return self.excitation.condition


def from_runs(
    load: npt.ArrayLike,
    motion: npt.ArrayLike,
    frequency: npt.ArrayLike,
    reference_point: npt.ArrayLike = (0.0, 0.0, 0.0),
    *,
    levels: Mapping[str, float] = LEVELS,
    weights: npt.ArrayLike | None = None,
) -> Estimate:
    """H from the spectra of six runs or more (Eqs. 9 to 11; least squares of all runs at each line).

    Parameters
    ----------
    load : (r, n, 6) spectra of forces and moments of the table on the structure about the reference point, run by run
    motion : (r, n, 6) spectra of the base acceleration about the same point
    frequency : (n,) lines [Hz]
    reference_point : (3,) [m]
    levels : nominal acceleration of each axis, by which it is scaled for condition and solution
    weights : (r,) or (r, n) one over the standard deviation of the loads of a run, in any unit; all alike by default

    Raises
    ------
    BadInput : fewer than six runs, shapes that do not fit, weights that are not positive, or base motions that are linearly
        dependent at a line; the combination is named.
    """
    F, U, lines = _fitting(load, motion, frequency)
    excited = excitation.of_runs(U, lines, levels)
    excitation.require_driven(excited)
    scale = np.array([levels[axis] for axis in MOTIONS])
    w = _weights(weights, F.shape[:2]).T  # (n, r)
    columns = (U / scale).transpose(1, 2, 0) * w[:, None, :]
    inverted = np.linalg.inv(columns) if len(U) == 6 else np.linalg.pinv(columns)
    inverse = np.asarray(w[:, :, None] * inverted / scale, dtype=np.complex128)
    H = F.transpose(1, 2, 0) @ inverse
    mass = DynamicMass(frequency=lines, matrix=H, reference_point=np.asarray(reference_point, dtype=np.float64))
    return Estimate(dynamic_mass=mass, excitation=excited, inverse=inverse)


def exclusions(estimate: Estimate, limit: float) -> Exclusions:
    """Lines with a scaled condition number above `limit` are left out; the reasons name what moves together there."""
    return excitation.exclusions(estimate.excitation, limit)


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


def _weights(weights: npt.ArrayLike | None, shape: tuple[int, ...]) -> Array:
    if weights is None:
        return np.ones(shape)
    w = np.asarray(weights, dtype=np.float64)
    w = np.broadcast_to(w[:, None] if w.shape == shape[:1] else w, shape) if w.shape in (shape, shape[:1]) else np.zeros(1)
    if not np.all((w > 0) & np.isfinite(w)):
        raise _refused("weights", f"one positive number for each of {shape[0]} runs, or for each run and line, is needed")
    return w


def _refused(field: str, problem: str) -> BadInput:
    return BadInput(
        source="dynamic mass from runs",
        field=field,
        problem=problem,
        remedy="Give the spectra of every run on the same lines, each of the six axes driven in a run of its own",
    )
