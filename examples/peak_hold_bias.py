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
from validation.report.charts import static
from validation.report.charts.spec import CURVES, FAINT, INK

LINES = 4 + 0.05 * np.arange(561)
"""[Hz] The paper's grid."""

AWAY = 0.1
"""Relative distance from the resonance beyond which a line counts as away from it."""

CLOSE = 0.04
"""Share of the resonance to both sides that the left half shows."""

SMALLEST = 1e-7
"""Error below which nothing is drawn."""

NOTE = "2 oct/min, 564 samples a second, blocks of 8192 samples with 90 % overlap; integrated at 32 times that rate"


def figures(found: SweepBias, resonance: float) -> dict[str, dict[str, float]]:
    """Relative errors by kind of spectrum: at the line of the resonance, the median and the largest away from it."""
    away = np.abs(found.frequency / resonance - 1) > AWAY
    at = int(np.argmin(np.abs(found.frequency - resonance)))
    return {
        name: {"at": float(error[at]), "away": float(np.median(error[away])), "largest_away": float(error[away].max())}
        for name, error in ((which, found.error(which)) for which in ("peak_hold", "full_record"))
    }


def draw_bias(found: SweepBias, title: str, path: Path, note: str = "", about: str = "") -> None:
    """Write a picture: |H| around the resonance on the left, the relative error over the band on the right.

    A PNG carries the words `about`.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    from matplotlib.ticker import NullFormatter, ScalarFormatter

    static.require_format(path)
    figure = static.new_figure(13.0, 5.6)
    near, band = figure.subplots(1, 2, gridspec_kw={"left": 0.075, "right": 0.985, "top": 0.83, "bottom": 0.14, "wspace": 0.17})
    f = found.frequency
    at = f[int(np.argmax(np.abs(found.exact)))]
    shown = np.abs(f / at - 1) < CLOSE
    drawn = {"peak-reference-hold": (found.peak_hold, CURVES[1]), "full record": (found.full_record, CURVES[0])}
    near.semilogy(f[shown], np.abs(found.exact[shown]), color=INK, linewidth=5, alpha=0.25, label="exact")
    for (name, (values, colour)), which in zip(drawn.items(), ("peak_hold", "full_record"), strict=True):
        near.semilogy(f[shown], np.abs(values[shown]), color=colour, linewidth=1.5, marker=".", markersize=4, label=name)
        error = np.maximum(found.error(which), SMALLEST)
        band.semilogy(f, 100 * error, color=colour, linewidth=1.3, label=f"{name}: {100 * error.max():.2g} % at most")
    near.set_ylabel("|H| / m", fontsize=10)
    near.yaxis.set_major_formatter(ScalarFormatter())
    near.yaxis.set_minor_formatter(NullFormatter())
    near.set_yticks([10, 20, 50, 100, 200, 500])
    near.set_ylim(np.abs(found.exact[shown]).min() * 0.9, np.abs(found.exact).max() * 1.2)
    band.set_ylabel("|error of H| / |H|  [%]", fontsize=10)
    band.axvline(at, color=FAINT, linewidth=0.8, linestyle=":")
    for axes in (near, band):
        axes.set_xlabel("frequency [Hz]", fontsize=10)
        axes.legend(fontsize=9, framealpha=0.9)
        axes.margins(x=0)
        static.grid_lines(axes)
    static.finish(figure, title, note, path, about)


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
