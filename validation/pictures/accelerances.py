"""Accelerances of a test beside those of models: at every drive point the reading there, and the error of all readings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from validation.engine.measured import Measured
from validation.pictures.curves import Axes, finish, grid_lines, new_figure
from validation.pictures.files import require_format
from validation.pictures.palette import INK

COLOURS = ("#9aa0a6", "#d9541e", "#1f8a4c", "#2456c4", "#8e6fc0", "#c9a227")
SMOOTHED = 0.2
"""[Hz] to either side over which errors are averaged."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnModel:
    """One model.

    Attributes
    ----------
    name : for the legend
    rows : (r, n, c) accelerances that it predicts
    """

    name: str
    rows: ComplexArray


def draw_accelerances(
    title: str, measured: Measured, models: Sequence[DrawnModel], path: Path, note: str = "", about: str = ""
) -> None:
    """Write a picture with one column a run; the reading that is drawn is the largest of its channels above all resonances.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    figure = new_figure(16.0, 9.2)
    room = {"left": 0.055, "right": 0.985, "top": 0.86, "bottom": 0.1, "hspace": 0.09, "wspace": 0.09}
    panels = figure.subplots(2, len(measured.runs), sharex=True, sharey="row", squeeze=False, gridspec_kw=room)
    for run, name in enumerate(measured.runs):
        upper, lower = panels[:, run]
        _readings(upper, measured, models, run)
        _errors(lower, measured, models, run)
        upper.set_title(name, fontsize=12, loc="left", color=INK)
        lower.set_xlabel("frequency [Hz]", fontsize=10)
    panels[0, 0].set_ylabel("|acceleration / force| [1/kg]", fontsize=10)
    panels[1, 0].set_ylabel("error of all readings [%]", fontsize=10)
    handles, labels = panels[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, fontsize=10, frameon=False, loc="upper right", bbox_to_anchor=(0.985, 0.95), ncols=len(labels))
    finish(figure, title, note, path, about)


def _readings(axes: Axes, measured: Measured, models: Sequence[DrawnModel], run: int) -> None:
    f, values = measured.frequency, measured.values[run]
    channel = int(np.argmax(np.abs(values[-len(f) // 10 :]).mean(axis=0)))
    axes.loglog(f, np.abs(values[:, channel]), color=INK, linewidth=4, alpha=0.25, label="measured")
    for model, colour in zip(models, COLOURS, strict=False):
        axes.loglog(f, np.abs(model.rows[run][:, channel]), color=colour, linewidth=1.2, label=model.name)
    _dress(axes, f)


def _errors(axes: Axes, measured: Measured, models: Sequence[DrawnModel], run: int) -> None:
    f, values = measured.frequency, measured.values[run]
    for model, colour in zip(models, COLOURS, strict=False):
        error = np.sum(np.abs(values - model.rows[run]) ** 2, axis=1) / np.sum(np.abs(values) ** 2, axis=1)
        axes.loglog(f, 100 * np.sqrt(_smoothed(f, error)), color=colour, linewidth=1.2)
    _dress(axes, f)


def _smoothed(f: Array, values: Array) -> Array:
    width = max(1, round(2 * SMOOTHED / float(f[1] - f[0])))
    around = np.convolve(values, np.ones(width), mode="same")
    return np.asarray(around / np.convolve(np.ones_like(values), np.ones(width), mode="same"))


def _dress(axes: Axes, f: Array) -> None:
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter

    axes.set_xlim(f[0], f[-1])
    axes.xaxis.set_major_locator(FixedLocator([one for one in (1, 2, 3, 5, 10, 20, 30, 50, 100) if f[0] <= one <= f[-1]]))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    grid_lines(axes)
