"""How far the eigenfrequencies of a solid model are from the limit of ever finer meshes.

    python examples/convergence.py                             a steel plate, seconds
    python examples/convergence.py clumod-1 5 45 35 25         five modes, cells of 45, 35 and 25 mm: minutes, 6 GB

Each line is a mode: its frequency at every size, the rate p of f(h) = f + C h^p that three sizes show, the limit f, and how far
the coarsest and the finest mesh are from it, beside what is allowed (blades 0.2 %, all else 0.1 %).
"""

import sys
from collections.abc import Sequence

import numpy as np
from rich.console import Console
from rich.table import Table

from fem.solid import model
from fem.solid.model import BLADE_BAR, Convergence, convergence_study
from geometry.article import Article, Box, Part, Shape, material, upright
from geometry.articles import built_in

BLADES = ("plate", "lower", "upper")
QUICK = ("plate", "2", "20", "13", "8.5")


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
