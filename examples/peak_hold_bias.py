"""How far the paper's peak-reference-hold misses a lightly damped resonance, measured on a sweep whose answer is known.

    python examples/peak_hold_bias.py [PICTURE] [RESONANCE_HZ] [DAMPING_RATIO]

Prints the error of both kinds of spectra at the resonance and away from it, and draws it (``out/peak-hold-bias.png``).
"""

import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array
from identification.spectra.line_spectra import full_record
from identification.spectra.peak_hold import BLOCK_SIZE, OVERLAP, peak_reference_hold
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

# By how much peak-reference-hold and full-record spectra miss the response function of a lightly damped mode in a sweep.
#
# A mass on a spring and a dashpot stands on a table that sweeps. The load on the table per acceleration is
#
#     H = m (1 + omega² / (omega_r² - omega² + 2 i zeta omega_r omega))
#
# The mode is integrated in time with a step so short that its own error (the drive taken for piecewise linear, relative (omega
# dt)² / 12) is a millionth, brought to the campaign's rate by leaving samples out, and both kinds of spectra are divided by
# those of the drive.

REST = 1.0
"""[s] before the drive."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SweepBias:
    """Measured bias.

    Attributes
    ----------
    frequency : (n,) [Hz]
    exact : (n,) complex, the response function [1] for m = 1 kg
    peak_hold, full_record : (n,) complex, what the spectra say
    """

    frequency: Array
    exact: ComplexArray
    peak_hold: ComplexArray
    full_record: ComplexArray

    def error(self, which: str) -> Array:
        """(n,) |found - exact| / |exact| of "peak_hold" or "full_record"."""
        found: ComplexArray = getattr(self, which)
        return np.asarray(np.abs(found - self.exact) / np.abs(self.exact))


def sweep_bias(
    resonance: float,
    damping_ratio: float,
    *,
    frequency: Array,
    rate: float = 564.0,
    finer: int = 32,
    start: float = 4.0,
    stop: float = 32.0,
    octaves_per_minute: float = 2.0,
    ring_down: float | None = None,
    block_size: int = BLOCK_SIZE,
    overlap: float = OVERLAP,
) -> SweepBias:
    """The bias at the lines `frequency` (n,) [Hz] of a mode at `resonance` [Hz].

    Parameters
    ----------
    resonance, damping_ratio : [Hz], [1], of the mode
    rate : [Hz] of the campaign; the integration takes `finer` steps a sample
    start, stop, octaves_per_minute : of the sweep [Hz], [Hz]
    ring_down : [s] recorded behind the drive; by default until e^-14, a millionth, of the mode is left
    block_size, overlap : of peak-reference-hold
    """
    from scipy.signal import cont2discrete, lfilter

    decay = 2 * np.pi * resonance * damping_ratio
    fine = rate * finer
    drive = _sweep(fine, start, stop, octaves_per_minute, 14 / decay if ring_down is None else ring_down)
    # The acceleration (n,) of the mass relative to the table, exact for a piecewise linear drive
    omega_r = 2 * np.pi * resonance
    system = ([-1.0, 0.0, 0.0], [1.0, 2 * damping_ratio * omega_r, omega_r**2])
    numerator, denominator, _ = cont2discrete(system, 1 / fine, method="foh")
    relative = np.asarray(lfilter(np.squeeze(numerator), denominator, drive), dtype=np.float64)
    load = drive + relative
    pair = np.column_stack([drive, load])[::finer]
    held = peak_reference_hold(pair, rate, pair[:, 0], frequency, block_size=block_size, overlap=overlap)
    full = full_record(pair, rate, frequency)
    omega = 2 * np.pi * frequency
    exact = np.asarray(1 + omega**2 / (omega_r**2 - omega**2 + 2j * damping_ratio * omega_r * omega), dtype=np.complex128)
    return SweepBias(frequency=frequency, exact=exact, peak_hold=held[:, 1] / held[:, 0], full_record=full[:, 1] / full[:, 0])


def _sweep(rate: float, start: float, stop: float, octaves_per_minute: float, after: float) -> Array:
    """A logarithmic sweep of amplitude 1 behind a rest, faded in and out over a period, with `after` seconds of silence."""
    k = octaves_per_minute / 60 * np.log(2)  # f = start exp(k t)
    duration = np.log(stop / start) / k
    t = np.arange(round(duration * rate)) / rate
    fade = np.minimum(1.0, np.minimum(t * start, (duration - t) * stop))
    wave = np.sin(2 * np.pi * start / k * np.expm1(k * t)) * np.sin(np.pi / 2 * np.clip(fade, 0, 1)) ** 2
    return np.concatenate([np.zeros(round(REST * rate)), wave, np.zeros(round(after * rate))])


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
