"""What the dynamic mass at 561 lines costs: from modes, by direct solution, and by pyyeti on the same reduced matrices.

Modes and matrices are made before the clock starts. The direct solution is of the same model without reduction, so the ratio
says what modes are worth for every further question. pyyeti's base-driven Craig-Bampton is called as its manual asks: once an axis,
with its own store of what repeats.
"""

from collections.abc import Callable

import numpy as np

from benchmarks.ratios import measure, show
from fem import beam, dynamic_mass, reduction
from fem.damping import Damping
from fem.dynamic_mass import LINES
from fem.modes import fixed_base
from geometry.dynamic_mass import ComplexArray

ARTICLE = "clumod-4"
COUNT = 30


def callables() -> tuple[dict[str, Callable[[], object]], dict[str, str]]:
    """Every way, with damping per mode and per part, and beside each its deviation from the direct solution of its damping."""
    structure = beam.structure(ARTICLE)
    ways: dict[str, Callable[[], object]] = {}
    notes = {}
    for label, damping in (("per mode", Damping(ratio=0.003)), ("per part", None)):
        modes = fixed_base(structure, COUNT, damping=damping)
        reduced = reduction.of_modes(modes, structure.rigid)
        own = {
            f"modal, {label}": lambda modes=modes: dynamic_mass.modal(modes).matrix,
            f"pyyeti, {label}": lambda reduced=reduced: by_pyyeti(reduced),
            f"direct, {label}": lambda damping=damping, modes=modes: (
                dynamic_mass.direct(structure, LINES, damping, modes=modes).matrix
            ),
        }
        ways |= own
        exact = own[f"direct, {label}"]()
        for name, way in own.items():
            notes[name] = f"{np.abs(way() - exact).max() / np.abs(exact).max():.1e}"
    return ways, notes


def by_pyyeti(reduced: reduction.Reduced) -> ComplexArray:
    """The six columns of H (lines, 6, 6), without residual: pyyeti knows none here."""
    from pyyeti import cb

    stored: dict[str, object] = {}
    K = reduced.stiffness + 1j * reduced.structural
    columns = [cb.cbtf(reduced.mass, reduced.viscous, K, axis, LINES, np.arange(6), stored).frc for axis in np.eye(6)]
    return np.asarray(columns).transpose(2, 1, 0)


if __name__ == "__main__":
    ways, notes = callables()
    title = f"Dynamic mass of {ARTICLE} at {LINES.size} lines, {COUNT} modes (deviation from the direct solution)"
    show(title, measure(ways, rounds=3), base="modal, per mode", notes=notes)
