"""What the simple quotient of the driven axis costs beside six runs solved together.

The quotient (Eq. 8a) takes every load in the run of axis k for an answer to the motion along k. The table moves along the other
five axes, too, and what these do is in the quotient: beside H from all runs (Eqs. 9 to 11) it is off by the sum of H_jl u_l / u_k
over these five.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array, frozen
from geometry.dynamic_mass import LEVELS, MOTIONS, ComplexArray
from geometry.errors import BadInput
from identification.dynamic_mass import Estimate, quotient


@dataclass(frozen=True, eq=False, kw_only=True)
class CrossMotion:
    """The quotient beside H, axis by axis.

    Attributes
    ----------
    quotient : (n, 6, 6) complex, its columns by single runs, about the reference point of H
    cross_motion : (6,) rms of the other five motions over the driven one, every axis divided by its nominal level
    diagonal : (6,) rms over the lines of what the quotient is off on the diagonal, as a share of the diagonal's rms
    column : (6,) the same for the largest load of the other five, as a share of the rms of sqrt(|H_jj H_kk|)
    text : (6,) a sentence for each axis
    """

    quotient: ComplexArray
    cross_motion: Array
    diagonal: Array
    column: Array
    text: tuple[str, ...]

    def __post_init__(self) -> None:
        for name in ("cross_motion", "diagonal", "column"):
            object.__setattr__(self, name, frozen(getattr(self, name), (6,), name))


def cost(load: npt.ArrayLike, motion: npt.ArrayLike, axes: Sequence[str], estimate: Estimate) -> CrossMotion:
    """What cross motion costs the quotient, from the first run of each axis.

    Parameters
    ----------
    load, motion : (r, n, 6) spectra about the reference point of `estimate`
    axes : (r,) driven axis of each run, empty for a pattern of several

    Raises
    ------
    BadInput : an axis that no run drives alone; a pattern of several axes has no quotient.
    """
    F, U = np.asarray(load, dtype=np.complex128), np.asarray(motion, dtype=np.complex128)
    lacking = [axis for axis in MOTIONS if axis not in axes]
    if lacking:
        problem = f"no run drives {', '.join(lacking)} alone"
        raise BadInput(source="quotient of the driven axis", field="runs", problem=problem, remedy="Use all runs together")
    runs = [list(axes).index(axis) for axis in MOTIONS]
    columns = np.stack([quotient(F[run], U[run], axis) for run, axis in zip(runs, MOTIONS, strict=True)], axis=2)
    H = estimate.dynamic_mass.matrix
    off, own = _rms(columns - H), _rms(np.sqrt(np.abs(np.einsum("nj,nk->njk", *2 * [np.diagonal(H, axis1=1, axis2=2)]))))
    share = off / own
    others = share - np.diag(np.diag(share))
    crossed = _crossed(U[runs])
    text = tuple(_said(*figures) for figures in zip(MOTIONS, crossed, np.diag(share), others.max(axis=0), strict=True))
    return CrossMotion(quotient=columns, cross_motion=crossed, diagonal=np.diag(share), column=others.max(axis=0), text=text)


def _crossed(U: ComplexArray) -> Array:
    scaled = _rms(U.transpose(1, 0, 2)) / np.array([LEVELS[axis] for axis in MOTIONS])
    driven = np.diag(scaled)
    return np.asarray(np.linalg.norm(scaled - np.diag(driven), axis=1) / driven)


def _rms(values: npt.NDArray[np.complex128] | Array) -> Array:
    """Over the first axis."""
    return np.asarray(np.sqrt(np.mean(np.abs(values) ** 2, axis=0)))


def _said(axis: str, crossed: float, diagonal: float, column: float) -> str:
    return (
        f"{axis}: the other five axes move {100 * crossed:.2g} % as much; the quotient is {100 * diagonal:.2g} % off on the "
        f"diagonal and up to {100 * column:.2g} % beside it"
    )
