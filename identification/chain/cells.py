"""The load cells as springs: how they share a load between them, and how far the cover plate moves on them.

With B a row of [G] for every sensing element and K_c their stiffness, a load F about the reference point moves the cover plate by
K^-1 F, K = B^T K_c B, so that the elements carry

    K_c B K^-1 F.

Only the relative stiffness matters for that; the absolute one, known less well, tells table from cover plate: K^-1.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array, frozen
from identification.chain.parameter import Offsets

ELEMENT = "cell-stiffness"
COMPLIANCE = "fmd-compliance"


@dataclass(frozen=True, eq=False, kw_only=True)
class Springs:
    """Springs between table and cover plate.

    Attributes
    ----------
    names : (e,) of the elements, ``1x`` and so on; they are the targets of `cell-stiffness`
    rows : (e, 6) B, translations [1], rotations [m], about the reference point
    stiffness : (e,) nominal [N/m], or [N m] where a row is a rotation
    shares : by target of `fmd-compliance` (e,), which share of an element's compliance it scales, 0 to 1
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
        for name in ("rows", "stiffness"):
            object.__setattr__(self, name, frozen(getattr(self, name), np.shape(getattr(self, name)), name))

    @property
    def complete(self) -> bool:
        """Whether the elements alone carry all six loads."""
        scale = np.linalg.norm(self.rows, axis=0)
        return bool(np.all(scale > 0) and np.linalg.matrix_rank(self.rows / scale, tol=1e-6) == 6)

    def relative(self, x: Offsets) -> Array:
        """(e,) stiffness of the elements, each with its own deviation."""
        return np.asarray(self.stiffness * np.exp([x.get(f"{ELEMENT}:{name}", 0.0) for name in self.names]))

    def absolute(self, x: Offsets) -> Array:
        """(e,) the same, softened by the common factors on the compliance."""
        softer = sum(
            (share * x.get(f"{COMPLIANCE}:{name}", 0.0) for name, share in self.shares.items()), np.zeros(len(self.names))
        )
        return np.asarray(self.relative(x) * np.exp(-softer))

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

    def compliance(self, x: Offsets) -> Array:
        """(6, 6) K^-1: motion of the cover plate below the table's for a unit load."""
        return np.zeros((6, 6)) if self.rigid else np.asarray(np.linalg.inv(self._total(self.absolute(x))))

    def compliance_changes(self, x: Offsets) -> Iterator[tuple[str, Array]]:
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

    def _total(self, k: Array) -> Array:
        return np.asarray(self.rows.T @ (k[:, None] * self.rows))
