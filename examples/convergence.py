"""How far the eigenfrequencies of a solid model are from the limit of ever finer meshes.

    python examples/convergence.py                             a steel plate, seconds
    python examples/convergence.py clumod-1 5 45 35 25         five modes, cells of 45, 35 and 25 mm: minutes, 6 GB

Each line is a mode: its frequency at every size, the rate p of f(h) = f + C h^p that three sizes show, the limit f, and how far
the coarsest and the finest mesh are from it, beside what is allowed (blades 0.2 %, all else 0.1 %).
"""

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from rich.console import Console
from rich.table import Table

from fem.solid import model
from fem.structure import Structure
from geometry.article import Article, Box, Part, Shape, material, upright
from geometry.articles import built_in
from geometry.errors import BadInput
from geometry.frames import Array

BLADES = ("plate", "lower", "upper")
QUICK = ("plate", "2", "20", "13", "8.5")


# Mesh convergence: how far the finest mesh is from what ever finer ones would give.
#
# Eigenfrequencies of a conforming family of meshes fall towards their limits as f(h) = f + C h^p, each in its place of the
# ordered list (the min-max principle). Three sizes give p, the observed rate, and f by Richardson's extrapolation; smooth modes
# of quadratic elements have p = 4 and re-entrant edges pull it down to about 1. Where three values show no such fall, no rate
# is claimed and the distance is estimated with p = 1, on the safe side (Roache, Verification and Validation in Computational
# Science and Engineering, chapter 5).

BAR = 1e-3
"""Relative distance from the limit that a mode may have, where no other is given for its part."""

BLADE_BAR = 2e-3
"""Of the bending modes of thin blades."""

RATES = (0.2, 8.0)
"""Rates that can be told from three sizes; beyond, something else than h is changing."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Convergence:
    """Eigenfrequencies over the size of the elements.

    Attributes
    ----------
    size : (k,) [m], or any measure in proportion to it, from coarse to fine
    unknowns : (k,) degrees of freedom of the structures
    frequency : (k, n) [Hz]
    rate : (n,) observed p of the three finest; NaN where they show none
    extrapolated : (n,) [Hz]
    distance : (n,) relative distance of the finest from the extrapolated
    bar : (n,) what it may be
    part : part with the largest share of the strain energy, mode by mode
    """

    size: Array
    unknowns: tuple[int, ...]
    frequency: Array
    rate: Array
    extrapolated: Array
    distance: Array
    bar: Array
    part: tuple[str, ...]

    @property
    def converged(self) -> bool:
        """Whether every mode is within its bar."""
        return bool(np.all(self.distance <= self.bar))

    @property
    def verdict(self) -> str:
        """In a sentence."""
        worst = int(np.argmax(self.distance / self.bar))
        mode = f"mode {worst + 1} at {self.frequency[-1, worst]:.4g} Hz ({self.part[worst] or 'no part'})"
        found = f"is {self.distance[worst]:.2%} from its limit, {self.bar[worst]:.2%} allowed"
        beyond = int(np.sum(self.distance > self.bar))
        if not beyond:
            return f"converged: all {len(self.bar)} modes are within their bars; the worst, {mode}, {found}"
        count = f"{beyond} of {len(self.bar)} modes are beyond their bars"
        return f"not converged: {count}; the worst, {mode}, {found}; take a finer mesh"


def convergence_study(
    structure_of: Callable[[float], Structure],
    sizes: Sequence[float],
    count: int = 10,
    bars: Mapping[str, float] = MappingProxyType({}),
) -> Convergence:
    """Frequencies of `structure_of` at every one of `sizes`, which it is called with from coarse to fine.

    Parameters
    ----------
    structure_of : structure of a given element size, tetrahedra or hexahedra
    sizes : at least three, each smaller than the one before
    count : of modes
    bars : allowed distance of modes that strain this part most; `BAR` for all others

    Raises
    ------
    BadInput : fewer than three sizes, or not descending.
    """
    h = np.asarray(sizes, dtype=np.float64)
    if len(h) < 3 or np.any(np.diff(h) >= 0) or h[-1] <= 0:
        problem = f"needs three or more positive sizes, from coarse to fine, found {h.tolist()}"
        raise BadInput("convergence study", "sizes", problem, "Give for example 30, 20 and 14 mm")
    frequency, unknowns = [], []
    for size in h:
        structure = structure_of(float(size))
        modes = model.fixed_base(structure, count)
        frequency.append(modes.frequency)
        unknowns.append(len(structure.free))
    # The part that each mode strains most; empty names for a structure without parts
    if not structure.part_stiffness:
        parts = tuple("" for _ in modes.frequency)
    else:
        names = tuple(structure.part_stiffness)
        energy = [np.einsum("ij,ij->j", modes.shapes, K @ modes.shapes) for K in structure.part_stiffness.values()]
        parts = tuple(names[int(k)] for k in np.argmax(np.array(energy), axis=0))
    return assessed(h, tuple(unknowns), np.array(frequency), parts, bars)


def assessed(
    size: Array, unknowns: tuple[int, ...], frequency: Array, part: tuple[str, ...], bars: Mapping[str, float]
) -> Convergence:
    """The study of known frequencies (k, n) at `size` (k,)."""
    found = [extrapolation(size[-3:], values) for values in frequency[-3:].T]
    rate, limit, error = (np.array(column) for column in zip(*found, strict=True))
    bar = np.array([bars.get(name, BAR) for name in part])
    return Convergence(
        size=size,
        unknowns=unknowns,
        frequency=frequency,
        rate=rate,
        extrapolated=limit,
        distance=error / limit,
        bar=bar,
        part=part,
    )


def extrapolation(size: Array, value: Array) -> tuple[float, float, float]:
    """Rate, limit and distance of the last of three values from it, for three descending sizes."""
    from scipy.optimize import brentq

    h1, h2, h3 = size / size[-1]
    coarse, fine = value[0] - value[1], value[1] - value[2]

    def ratio(p: float) -> float:
        return float((h1**p - h2**p) / (h2**p - h3**p) * fine - coarse)

    p = brentq(ratio, *RATES) if fine and ratio(RATES[0]) * ratio(RATES[1]) < 0 else np.nan
    error = abs(fine) / (h2 ** (1.0 if np.isnan(p) else p) - 1)
    return float(p), float(value[2] - np.copysign(error, fine)), float(error)


def article(name: str) -> Article:
    """The built-in article `name`, or a steel plate of 20 x 5 x 400 mm on its narrow side."""
    if name != "plate":
        return built_in(name)
    shape = Shape(solids=(upright(Box(size=np.array([0.02, 0.005, 0.4])), bottom=0.0),))
    return Article(name=name, parts=(Part(name=name, material=material("steel"), shape=shape),))


def studied(name: str, count: int, sizes: Sequence[float]) -> Convergence:
    """`count` modes of the article `name` at `sizes` [m], from coarse to fine."""
    chosen = article(name)
    bars = {part.name: BLADE_BAR for part in chosen.parts if part.name.startswith(BLADES)}
    return convergence_study(lambda size: model.structure(chosen, size=size), sizes, count, bars=bars)


def table(name: str, found: Convergence) -> Table:
    """One line a mode."""
    shown = Table(title=f"{name}: {', '.join(f'{n:,}' for n in found.unknowns)} unknowns")
    sizes = [f"{1e3 * size:g} mm" for size in found.size]
    for column in ("mode", "part", *sizes, "rate", "limit", sizes[0], sizes[-1], "allowed"):
        shown.add_column(column, justify="left" if column == "part" else "right")
    for k, limit in enumerate(found.extrapolated):
        frequencies = [f"{f:.4f}" for f in found.frequency[:, k]]
        distances = [f"{abs(f / limit - 1):.3%}" for f in found.frequency[[0, -1], k]]
        rate = "none" if found.rate[k] != found.rate[k] else f"{found.rate[k]:.1f}"
        shown.add_row(str(k + 1), found.part[k], *frequencies, rate, f"{limit:.4f}", *distances, f"{found.bar[k]:.1%}")
    return shown


def main(console: Console, arguments: Sequence[str] = QUICK) -> None:
    name, count, *sizes = arguments
    found = studied(name, int(count), [float(size) / 1e3 for size in sizes])
    console.print(table(name, found))
    console.print(found.verdict)


if __name__ == "__main__":
    main(Console(), sys.argv[1:] or QUICK)
