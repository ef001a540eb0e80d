"""`Layout`: the one vector of everything that is estimated, in blocks, and what is known of it beforehand.

Knowledge is whitened rows, each a measurement with standard deviation 1: ``rows @ x = values``. Data and knowledge add, and the
posterior covariance C = (J^T J + sum A_b^T A_b)^-1 splits into the part of every input: C J^T J C + sum C A_b^T A_b C = C.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array, frozen


@dataclass(frozen=True, eq=False, kw_only=True)
class Block:
    """Parameters that belong together.

    Attributes
    ----------
    name : unique in a layout
    names : (k,) of the parameters
    start : (k,) where the iteration begins
    rows : (p, k) whitened
    values : (p,)
    families : (p,) the input that each row belongs to
    """

    name: str
    names: tuple[str, ...]
    start: Array
    rows: Array
    values: Array
    families: tuple[str, ...]

    def __post_init__(self) -> None:
        k, p = len(self.names), len(self.families)
        for name, shape in {"start": (k,), "rows": (p, k), "values": (p,)}.items():
            object.__setattr__(self, name, frozen(getattr(self, name), shape, name))

    def __len__(self) -> int:
        return len(self.names)


def block(
    name: str,
    names: Sequence[str],
    start: npt.ArrayLike,
    *,
    deviation: npt.ArrayLike = np.inf,
    mean: npt.ArrayLike = 0.0,
    families: Sequence[str] | str = "",
) -> Block:
    """A block whose parameters are known one by one: `mean` (k,) within `deviation` (k,), infinite where one is free."""
    k = len(names)
    sd, mu = np.broadcast_to(np.asarray(deviation, dtype=np.float64), k), np.broadcast_to(np.asarray(mean, dtype=np.float64), k)
    known = np.flatnonzero(np.isfinite(sd))
    called = (families,) * k if isinstance(families, str) else tuple(families)
    return Block(
        name=name,
        names=tuple(names),
        start=np.asarray(start, dtype=np.float64),
        rows=np.eye(k)[known] / sd[known, None],
        values=mu[known] / sd[known],
        families=tuple(called[i] for i in known),
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class Layout:
    """Blocks one after the other."""

    blocks: tuple[Block, ...]

    def __len__(self) -> int:
        return sum(len(one) for one in self.blocks)

    def at(self, name: str) -> slice:
        """Where the block `name` stands in the vector.

        Raises
        ------
        KeyError : there is none.
        """
        begin = 0
        for one in self.blocks:
            if one.name == name:
                return slice(begin, begin + len(one))
            begin += len(one)
        raise KeyError(name)

    def block(self, name: str) -> Block:
        """The block `name`."""
        return next(one for one in self.blocks if one.name == name)

    @property
    def owners(self) -> tuple[str, ...]:
        """(k,) name of the block of every parameter."""
        return tuple(one.name for one in self.blocks for _ in one.names)

    @property
    def start(self) -> Array:
        """(k,) of all blocks."""
        return np.concatenate([one.start for one in self.blocks])

    @property
    def knowledge(self) -> tuple[Array, Array, tuple[str, ...]]:
        """Rows (p, k), values (p,) and families (p,) of all blocks."""
        rows = np.zeros((sum(len(one.families) for one in self.blocks), len(self)))
        begin = 0
        for one in self.blocks:
            rows[begin : begin + len(one.families), self.at(one.name)] = one.rows
            begin += len(one.families)
        values = np.concatenate([one.values for one in self.blocks])
        return rows, values, tuple(family for one in self.blocks for family in one.families)
