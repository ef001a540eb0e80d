"""What the dynamic mass at 561 lines costs: from modes, by direct solution, and by pyyeti on the same reduced matrices.

Modes and matrices are made before the clock starts. The direct solution is of the same model without reduction, so the ratio
says what modes are worth for every further question. pyyeti's base-driven Craig-Bampton is called as its manual asks: once an
axis, with its own store of what repeats.
"""

from collections.abc import Callable
from functools import partial

import numpy as np

from benchmarks.ratios import measure, show
from fem import dynamic_mass
from fem.beam import articles
from fem.damping import Damping
from fem.dynamic_mass import LINES
from fem.modes import Reduced, craig_bampton, fixed_base
from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array

ARTICLE = "clumod-4"
COUNT = 30


DAMPING = {"per mode": Damping(ratio=0.003), "per part": None}


def ways(damping: Damping | None) -> dict[str, Callable[[Array], ComplexArray]]:
    """Every way to the dynamic mass at given lines."""
    structure = articles.structure(ARTICLE)
    modes = fixed_base(structure, COUNT, damping=damping)
    matrices = craig_bampton(modes, structure.rigid)
    return {
        "modal": lambda lines: dynamic_mass.modal(modes, lines).matrix,
        "pyyeti": lambda lines: by_pyyeti(matrices, lines),
        "direct": lambda lines: dynamic_mass.direct(structure, lines, damping, modes=modes).matrix,
    }


def deviation(one: ComplexArray, other: ComplexArray) -> str:
    """Largest difference over the largest entry."""
    return f"{np.abs(one - other).max() / np.abs(other).max():.1e}"


def by_pyyeti(reduced: Reduced, lines: Array) -> ComplexArray:
    """The six columns of H (lines, 6, 6), without residual: pyyeti knows none here."""
    from pyyeti import cb

    stored: dict[str, object] = {}
    K = reduced.stiffness + 1j * reduced.structural
    columns = [cb.cbtf(reduced.mass, reduced.viscous, K, axis, lines, np.arange(6), stored).frc for axis in np.eye(6)]
    return np.asarray(columns).transpose(2, 1, 0)


if __name__ == "__main__":
    few = LINES[::40]
    for label, damping in DAMPING.items():
        of = ways(damping)
        notes = {name: deviation(way(few), of["direct"](few)) for name, way in of.items()}
        timings = measure({name: partial(way, LINES) for name, way in of.items() if name != "direct"}, rounds=5)
        timings |= measure({"direct": partial(of["direct"], LINES)}, rounds=1)
        title = f"Dynamic mass of {ARTICLE}, {LINES.size} lines, {COUNT} modes, damping {label} (deviation from direct)"
        show(title, timings, base="modal", notes=notes)
