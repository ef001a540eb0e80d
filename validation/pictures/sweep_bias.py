"""The bias of peak-reference-hold near a lightly damped mode: the response function as it is and as spectra tell it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from identification.spectra.sweep_bias import SweepBias
from validation.pictures.curves import CURVES, finish, grid_lines, new_figure
from validation.pictures.files import require_format
from validation.pictures.palette import FAINT, INK

CLOSE = 0.04
"""Share of the resonance to both sides that the left half shows."""

SMALLEST = 1e-7
"""Error below which nothing is drawn."""


def draw_bias(found: SweepBias, title: str, path: Path, note: str = "", about: str = "") -> None:
    """Write a picture: |H| around the resonance on the left, the relative error over the band on the right.

    A PNG carries the words `about`.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    from matplotlib.ticker import NullFormatter, ScalarFormatter

    require_format(path)
    figure = new_figure(13.0, 5.6)
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
        grid_lines(axes)
    finish(figure, title, note, path, about)
