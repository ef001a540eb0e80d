"""How far the paper's peak-reference-hold misses a lightly damped resonance, measured on a sweep whose answer is known.

    python examples/peak_hold_bias.py [PICTURE] [RESONANCE_HZ] [DAMPING_RATIO]

Prints the error of both kinds of spectra at the resonance and away from it, and draws it (``out/peak-hold-bias.png``).
"""

import json
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from identification.spectra.peak_hold import SweepBias, sweep_bias
from validation.report.charts.identification import draw_bias

LINES = 4 + 0.05 * np.arange(561)
"""[Hz] The paper's grid."""

AWAY = 0.1
"""Relative distance from the resonance beyond which a line counts as away from it."""

NOTE = "2 oct/min, 564 samples a second, blocks of 8192 samples with 90 % overlap; integrated at 32 times that rate"


def figures(found: SweepBias, resonance: float) -> dict[str, dict[str, float]]:
    """Relative errors by kind of spectrum: at the line of the resonance, the median and the largest away from it."""
    away = np.abs(found.frequency / resonance - 1) > AWAY
    at = int(np.argmin(np.abs(found.frequency - resonance)))
    return {
        name: {"at": float(error[at]), "away": float(np.median(error[away])), "largest_away": float(error[away].max())}
        for name, error in ((which, found.error(which)) for which in ("peak_hold", "full_record"))
    }


def main(console: Console, arguments: Sequence[str]) -> None:
    """Measure, print, draw."""
    path, resonance, damping = (given or usual for given, usual in zip((*arguments, "", "", "")[:3], USUAL, strict=True))
    f, zeta = float(resonance), float(damping)
    found = sweep_bias(f, zeta, frequency=LINES)
    errors = figures(found, f)
    table = Table(title=f"Error of H, mode at {f:g} Hz of {100 * zeta:g} % damping")
    for heading in ("spectrum", "at the resonance", "median 10 % away and more", "largest there"):
        table.add_column(heading)
    for name, row in errors.items():
        table.add_row(name.replace("_", " "), *(f"{100 * value:.2g} %" for value in row.values()))
    console.print(table)
    draw_bias(found, f"A mode at {f:g} Hz, {100 * zeta:g} % damping, in a sweep", Path(path), NOTE, json.dumps(errors))
    console.print(f"Drawn: {path}")


USUAL = ("out/peak-hold-bias.png", "12.3", "0.0035")

if __name__ == "__main__":
    main(Console(), sys.argv[1:])
