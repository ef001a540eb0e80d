"""The FMD's load cells as a channel table tells of them: which elements there are, in which cell, and how stiff.

Elements at one place are one cell; cells are numbered counter-clockwise from +x +y, as in the paper, and an element is called
after its cell and the axis along which it senses: ``1x``. Where the elements do not carry all six loads by themselves - the
campaign gives moments, or loads that somebody has already added up - nothing is known of the cells, and the cover plate is taken
to stand on one spring for each of the six motions.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import log

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array, frozen
from geometry.articles.dimensions import load
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.frames import rigid_transformation_6
from geometry.sensors import Place, row
from geometry.shapes import rectangle
from identification.chain.cells import Springs

ASSUMED = log(5.0)
"""Standard deviation of ln(compliance) where no stiffness is stated: quartz cells with their bolts differ by such a factor."""

STATED = 0.3
"""The same where the laboratory states a stiffness: that of a data sheet, without bolts, plates and contact."""

ALIGNED = 1e-6
"""How far from 1 the cosine of an element to its axis may lie to be called after it alone."""


def assumed_stiffness() -> Array:
    """(3,) [N/m] of one cell along x, y, z: that of the reconstructed FMD."""
    cell = load("fmd")["load_cell"]
    lateral = cell["lateral_stiffness_N_m"]
    return np.array([lateral, lateral, cell["axial_stiffness_N_m"]])


def springs(elements: Sequence[Place], point: Array, stiffness: npt.ArrayLike | None) -> Springs:
    """Load cells of `stiffness` (3,) [N/m] along x, y, z each; None takes `assumed_stiffness`, infinity is a rigid FMD.

    Raises
    ------
    BadInput : `stiffness` is not three positive numbers, or infinite along some axes only.
    """
    k, rigid = _stated(stiffness)
    squares = np.array([place.direction**2 for place in elements]).reshape(-1, 3)
    made = Springs(
        names=names(elements, point),
        rows=np.array([row(place, point) for place in elements]).reshape(-1, 6),
        stiffness=squares @ k,
        shares={"lateral": squares[:, 0] + squares[:, 1], "vertical": squares[:, 2]},
        rigid=rigid,
    )
    return made if made.complete else _six(k, rigid)


def names(elements: Sequence[Place], point: Array) -> tuple[str, ...]:
    """Of `elements`: number of the cell and axis, ``1x``; slanted elements get letters from ``a``."""
    at = [place.position - point for place in elements]
    cells = list(dict.fromkeys(sorted((_around(one), *np.round(one, 9)) for one in at)))
    called: list[str] = []
    for place, one in zip(elements, at, strict=True):
        number = cells.index((_around(one), *np.round(one, 9))) + 1
        axis = int(np.argmax(np.abs(place.direction)))
        slanted = abs(place.direction[axis]) < 1 - ALIGNED
        letters = ("" if slanted else "xyz"[axis]) + "abcdefghijklmnopqrstuvw"
        called.append(next(name for letter in letters if (name := f"{number}{letter}") not in called))
    return tuple(called)


def _around(at: Array) -> float:
    """Angle counter-clockwise from the x axis [rad], 0 to 2 pi, by which cells are numbered."""
    angle = float(np.arctan2(at[1], at[0])) if np.hypot(at[0], at[1]) > 0 else 0.0
    return round(angle % (2 * np.pi), 9) % round(2 * np.pi, 9)


def _six(k: Array, rigid: bool) -> Springs:
    """One spring for each motion, as stiff as four cells on the reconstructed FMD's square around the reference point."""
    square = load("fmd")["load_cell"]["square"]
    K = np.zeros((6, 6))
    for x, y in rectangle(square, square):
        G = rigid_transformation_6(np.array([x, y, 0.0]))[:3]
        K += G.T @ (k[:, None] * G)
    shares = {
        "lateral": [1, 1, 0, 0, 0, 0],
        "vertical": [0, 0, 1, 0, 0, 0],
        "rotation": [0, 0, 0, 1, 1, 0],
        "torsion": [0] * 5 + [1],
    }
    return Springs(
        names=MOTIONS,
        rows=np.eye(6),
        stiffness=np.diag(K),
        shares={name: np.array(share, dtype=np.float64) for name, share in shares.items()},
        rigid=rigid,
        of_cells=False,
    )


def _stated(stiffness: npt.ArrayLike | None) -> tuple[Array, bool]:
    k = np.asarray(assumed_stiffness() if stiffness is None else stiffness, dtype=np.float64)
    if k.shape == () and np.isinf(k):
        return assumed_stiffness(), True
    if k.shape != (3,) or not np.all(np.isfinite(k)) or np.any(k <= 0):
        problem = f"three positive numbers are needed, along x, y and z of one cell, found {np.asarray(stiffness).tolist()}"
        remedy = "Give N/m, infinity for a rigid FMD, or leave it out"
        raise BadInput(source="measurement chain", field="stiffness", problem=problem, remedy=remedy)
    return frozen(k, (3,), "stiffness"), False
