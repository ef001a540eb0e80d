"""The FMD's load cells as springs: which there are, how they share a load, and how far the cover plate moves on them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import log
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry.article import rectangle
from geometry.articles.parts import load
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.frames import Array, freeze, frozen, rigid_transformation_6
from geometry.sensors import Place, row

Offsets = Mapping[str, float]
"""Of the open parameters by name, from nominal, where a parameter stands that is not in it; stiffnesses by their logarithm."""

# The load cells as springs: how they share a load between them, and how far the cover plate moves on them.
#
# With B a row of [G] for every sensing element and K_c their stiffness, a load F about the reference point moves the cover plate
# by K^-1 F, K = B^T K_c B, so that the elements carry
#
#     K_c B K^-1 F.
#
# Only the relative stiffness matters for that; the absolute one, known less well, tells table from cover plate: K^-1, with
# k (1 + i eta) where the cells lose: near the frequency at which what they carry swings on them.

ELEMENT = "cell-stiffness"
COMPLIANCE = "fmd-compliance"
LOSS = "cell-loss"


@dataclass(frozen=True, eq=False, kw_only=True)
class Springs:
    """Springs between table and cover plate.

    Attributes
    ----------
    names : (e,) of the elements, ``1x`` and so on; they are the targets of `cell-stiffness`
    rows : (e, 6) B, translations [1], rotations [m], about the reference point
    stiffness : (e,) nominal [N/m], or [N m] where a row is a rotation
    shares : by target of `fmd-compliance` and `cell-loss` (e,), which share of an element they act on, 0 to 1
    rigid : whether the cover plate does not move on the cells
    of_cells : whether the rows are those of sensing elements; otherwise they stand for cells of which nothing is known
    """

    names: tuple[str, ...]
    rows: Array
    stiffness: Array
    shares: dict[str, Array]
    rigid: bool = False
    of_cells: bool = True

    def __post_init__(self) -> None:
        freeze(self, "rows", "stiffness")

    @property
    def complete(self) -> bool:
        """Whether the elements alone carry all six loads."""
        scale = np.linalg.norm(self.rows, axis=0)
        return bool(np.all(scale > 0) and np.linalg.matrix_rank(self.rows / scale, tol=1e-6) == 6)

    def relative(self, x: Offsets) -> Array:
        """(e,) stiffness of the elements, each with its own deviation."""
        return np.asarray(self.stiffness * np.exp([x.get(f"{ELEMENT}:{name}", 0.0) for name in self.names]))

    def absolute(self, x: Offsets) -> npt.NDArray[Any]:
        """(e,) the same, softened by the common factors on the compliance, complex where it loses."""
        softer, eta = (
            sum((share * x.get(f"{family}:{name}", 0.0) for name, share in self.shares.items()), np.zeros(len(self.names)))
            for family in (COMPLIANCE, LOSS)
        )
        k = self.relative(x) * np.exp(-softer)
        return k * (1 + 1j * eta) if eta.any() else np.asarray(k)

    def sharing(self, x: Offsets) -> Array:
        """(e, 6) load of every element for a unit load about the reference point."""
        k = self.relative(x)
        return np.asarray(k[:, None] * np.linalg.solve(self._total(k), self.rows.T).T)

    def sharing_changes(self, x: Offsets) -> Iterator[tuple[str, Array]]:
        """d `sharing` / d offset (e, 6) by open parameter: a stiffer element takes load from all others."""
        R = self.sharing(x)
        loss = np.eye(len(self.names)) - R @ self.rows.T
        for e, name in enumerate(self.names):
            if (key := f"{ELEMENT}:{name}") in x:
                yield key, np.outer(loss[:, e], R[e])

    def compliance(self, x: Offsets) -> npt.NDArray[Any]:
        """(6, 6) K^-1: motion of the cover plate below the table's for a unit load."""
        return np.zeros((6, 6)) if self.rigid else np.asarray(np.linalg.inv(self._total(self.absolute(x))))

    def compliance_changes(self, x: Offsets) -> Iterator[tuple[str, npt.NDArray[Any]]]:
        """d `compliance` / d offset (6, 6) by open parameter."""
        if self.rigid:
            return
        k, C = self.absolute(x), self.compliance(x)
        for e, name in enumerate(self.names):
            if (key := f"{ELEMENT}:{name}") in x:
                yield key, -k[e] * np.outer(C @ self.rows[e], self.rows[e] @ C)
        for name, share in self.shares.items():
            if (key := f"{COMPLIANCE}:{name}") in x:
                yield key, np.asarray(C @ self._total(share * k) @ C)
            if (key := f"{LOSS}:{name}") in x:
                yield key, np.asarray(C @ self._total(-1j * share * k.real) @ C)

    def _total(self, k: npt.NDArray[Any]) -> npt.NDArray[Any]:
        return np.asarray(self.rows.T @ (k[:, None] * self.rows))


# The FMD's load cells as a channel table tells of them: which elements there are, in which cell, and how stiff.
#
# Elements at one place are one cell; cells are numbered counter-clockwise from +x +y, as in the paper, and an element is called
# after its cell and the axis along which it senses: ``1x``. Where the elements do not carry all six loads by themselves - the
# campaign gives moments, or loads that somebody has already added up - nothing is known of the cells, and the cover plate is
# taken to stand on one spring for each of the six motions.

ASSUMED = log(5.0)
"""Standard deviation of ln(compliance) where no stiffness is stated: quartz cells with their bolts differ by such a factor."""

STATED = 0.3
"""The same where the laboratory states a stiffness: that of a data sheet, without bolts, plates and contact."""

LOSES = 0.01
"""Standard deviation of the loss factor of cells with their bolts. Held by virtual_test/test_structures.py."""

ALIGNED = 1e-6
"""How far from 1 the cosine of an element to its axis may lie to be called after it alone."""


def assumed_stiffness() -> Array:
    """(3,) [N/m] of one cell along x, y, z: that of the reconstructed FMD."""
    cell = load("fmd")["load_cell"]
    lateral = cell["lateral_stiffness_N_m"]
    return np.array([lateral, lateral, cell["axial_stiffness_N_m"]])


def cell_springs(elements: Sequence[Place], point: Array, stiffness: npt.ArrayLike | None) -> Springs:
    """Load cells of `stiffness` (3,) [N/m] along x, y, z each; None takes `assumed_stiffness`, infinity is a rigid FMD.

    Raises
    ------
    BadInput : `stiffness` is not three positive numbers, or infinite along some axes only.
    """
    j = np.asarray(assumed_stiffness() if stiffness is None else stiffness, dtype=np.float64)
    if j.shape == () and np.isinf(j):
        k, rigid = assumed_stiffness(), True
    else:
        if j.shape != (3,) or not np.all(np.isfinite(j)) or np.any(j <= 0):
            problem = f"three positive numbers are needed, along x, y and z of one cell, found {np.asarray(stiffness).tolist()}"
            raise BadInput("measurement chain", "stiffness", problem, "Give N/m, infinity for a rigid FMD, or leave it out")
        k, rigid = frozen(j, (3,), "stiffness"), False
    squares = np.array([place.direction**2 for place in elements]).reshape(-1, 3)
    made = Springs(
        names=names(elements, point),
        rows=np.array([row(place, point) for place in elements]).reshape(-1, 6),
        stiffness=squares @ k,
        shares={"lateral": squares[:, 0] + squares[:, 1], "vertical": squares[:, 2]},
        rigid=rigid,
    )
    if made.complete:
        return made
    # One spring for each motion, as stiff as four cells on the reconstructed FMD's square around the reference point
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
