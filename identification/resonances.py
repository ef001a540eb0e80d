"""Resonances that response functions show by themselves: frequencies and shapes, picked before any model is fitted.

Functions are looked at beside the imaginary axis, at s = i omega + sigma, where a lightly damped resonance is as wide as one is
that has the damping ratio sigma / omega more. What is measured on the axis is brought there by the integral of Poisson,

    H(s) = 1/pi  int  H(i w) sigma / (sigma² + (w - omega)²) dw ,

exact for functions without a pole to the right of the axis, as those of anything that is stable are (P. L. Duren, Theory of H^p
Spaces, 1970, chapter 11); of a band its part within it. Peaks are broad there, noise is averaged, and a few lines hold all.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array, freeze
from identification.spectra.peak_hold import lone_mode

WIDTH = 0.03
"""[1] sigma / omega at which resonances are looked for: those of ordinary structures are narrower, and nearer ones than that are
one. Held by test_resonances.py."""

PROMINENT = 2.0
"""[factor] by which a resonance stands above the saddles beside it. Held by test_resonances.py."""

ABOVE_NOISE = 5.0
"""[factor] by which it stands above the noise. Held by test_resonances.py."""

NEXT_TO_NOTHING = 1e-9
"""[share] of the largest that a reading of zero is taken for. By definition."""

PER_OCTAVE = 96
"""[count] of lines in an octave at which they are looked for: several in each `WIDTH`. By definition."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Resonances:
    """Resonances as they are read from functions.

    Attributes
    ----------
    frequency : (m,) [Hz], ascending
    damping_ratio : (m,) [1]
    shapes : (m, c) real at the channels, each up to a factor, of largest component 1
    """

    frequency: Array
    damping_ratio: Array
    shapes: Array

    def __post_init__(self) -> None:
        m = len(self.frequency)
        freeze(self, frequency=(m,), damping_ratio=(m,), shapes=(m, self.shapes.shape[1]))


def beside_axis(frequency: Array, values: npt.ArrayLike, at: Array, width: float) -> ComplexArray:
    """(r, m, c) functions (r, n, c) at the lines `frequency` (n,) [Hz], at s = (i + `width`) 2 pi `at` (m,) [Hz]."""
    return np.asarray(np.einsum("mn,rnc->rmc", _weights(frequency, at, width), np.asarray(values)))


def noise_beside_axis(frequency: Array, noise: Array, at: Array, width: float) -> Array:
    """(r, m, c) standard deviation of the same, of functions whose lines have the independent `noise` (r, n, c)."""
    return np.asarray(np.sqrt(np.einsum("mn,rnc->rmc", _weights(frequency, at, width) ** 2, noise**2)))


def _weights(frequency: Array, at: Array, width: float) -> Array:
    """(m, n) shares of the lines, which need not be evenly spaced, by the trapezoidal rule."""
    sigma = (width * at)[:, None]
    kernel = np.gradient(frequency) * sigma / ((frequency - at[:, None]) ** 2 + sigma**2)
    return np.asarray(kernel / kernel.sum(axis=1, keepdims=True))


def resonances(frequency: Array, values: ComplexArray, noise: Array) -> Resonances:
    """Those that accelerances (r, n, c) with standard deviations `noise` (r, n, c) show at the lines `frequency` (n,) [Hz].

    One peak of all functions together is one resonance; its frequency, damping and residues are those of a mode by itself beside
    it, and its shape is what the residues of all runs have in common.
    """
    from scipy.signal import find_peaks

    at = np.geomspace(frequency[0], frequency[-1], max(int(PER_OCTAVE * np.log2(frequency[-1] / frequency[0])), 3))
    seen, scatter = beside_axis(frequency, values, at, WIDTH), noise_beside_axis(frequency, noise, at, WIDTH)
    level = 0.5 * np.log(np.sum(np.abs(seen) ** 2, axis=(0, 2)))
    clear = level > 0.5 * np.log(np.sum(scatter**2, axis=(0, 2)) + np.finfo(np.float64).tiny) + np.log(ABOVE_NOISE)
    peaks, _ = find_peaks(level, prominence=np.log(PROMINENT))
    found = []
    for peak in at[peaks[clear[peaks]]]:
        near = np.abs(frequency / peak - 1) < 2 * WIDTH
        if near.sum() < 4:  # three unknowns and the constant beside them
            continue
        readings = values[:, near].transpose(1, 0, 2).reshape(near.sum(), -1)
        readings = np.where(readings == 0, NEXT_TO_NOTHING * np.abs(readings).max(), readings)  # errors are relative
        mode = lone_mode(frequency[near], readings, float(peak), WIDTH / 3)
        residues = (mode.residues * np.exp(-1j * mode.turn)).real.reshape(len(values), -1)
        shape = np.linalg.svd(residues)[2][0]
        if abs(mode.frequency / peak - 1) < 2 * WIDTH:
            found.append((mode.frequency, mode.damping_ratio, shape / shape[np.argmax(np.abs(shape))]))
    found.sort(key=lambda one: one[0])
    frequencies, ratios, shapes = ([one[k] for one in found] for k in range(3))
    return Resonances(
        frequency=np.array(frequencies),
        damping_ratio=np.array(ratios),
        shapes=np.array(shapes).reshape(len(found), values.shape[2]),
    )
