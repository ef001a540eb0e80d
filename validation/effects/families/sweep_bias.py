from dataclasses import replace
from functools import lru_cache

import numpy as np

from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array
from validation.effects.effect import BODY_STAGE, PROCESSING, Family, Values
from validation.effects.stages import MountedDynamicMass

# What blocks of a Hann window make of a dynamic mass while a sweep passes (peak-reference-hold).
#
# Around the moment at which a logarithmic sweep passes f it is a chirp of s = f ln 2 rate [Hz/s], with the spectrum
# exp(-i pi (nu - f)² / s) by stationary phase. A block of length T around that moment reads at f, of a load H u,
#
#     H'(f) = int H(nu) W(f - nu) exp(-i pi (nu - f)² / s) dnu / the same without H,
#
# W the transform of the window, real for a window that is even about its middle. Linear in H, so derivatives pass through it.
# Between lines H is interpolated by cubic splines: they must lie closer than a third of the half-power width of what is to be
# seen.


LOBES = 12.0
"""Widths 1 / T of the window to either side that count: beyond, its transform has fallen to 1e-4."""

FINER = 16
"""Points of the kernel for every width 1 / T."""


def change(mounted: MountedDynamicMass, targets: tuple[str, ...], values: Values) -> MountedDynamicMass:
    """`mounted` as peak-reference-hold shows it; unchanged where the run states no blocks or no sweep."""
    if mounted.block <= 0 or mounted.sweep_rate <= 0 or len(mounted.frequency) < 2:
        return mounted
    S = _operator(mounted.frequency.tobytes(), mounted.sweep_rate, mounted.block)
    return replace(mounted, matrix=np.einsum("nm,mij->nij", S, mounted.matrix))


@lru_cache(maxsize=8)
def _operator(frequency: bytes, rate: float, block: float) -> ComplexArray:
    return operator(np.frombuffer(frequency), rate, block)


def operator(frequency: Array, rate: float, block: float) -> ComplexArray:
    """(n, n) from H at the lines `frequency` (n,) [Hz] to what blocks of `block` [s] read in a sweep of `rate` [octaves/s].

    Beyond the first and the last line H is taken to stay as it is there.
    """
    from scipy.interpolate import CubicSpline

    n = len(frequency)
    offsets = np.arange(-LOBES * FINER, LOBES * FINER + 1) / (FINER * block)
    kernel = window(offsets * block) * np.exp(-1j * np.pi * offsets**2 / (frequency[:, None] * np.log(2) * rate))
    kernel /= kernel.sum(axis=1, keepdims=True)
    at = np.clip(frequency[:, None] + offsets, frequency[0], frequency[-1])
    interval = np.clip(np.searchsorted(frequency, at, side="right") - 1, 0, n - 2)
    where, away = (np.arange(n)[:, None] * (n - 1) + interval).ravel(), at - frequency[interval]
    moments = np.empty((n, n - 1, 4), dtype=np.complex128)  # of the kernel over every interval between two lines
    for k, weights in enumerate((kernel * away**power).ravel() for power in (3, 2, 1, 0)):
        for part in ("real", "imag"):
            getattr(moments, part)[..., k] = np.bincount(where, getattr(weights, part), n * (n - 1)).reshape(n, n - 1)
    pieces = CubicSpline(frequency, np.eye(n), bc_type="not-a-knot" if n > 3 else "natural").c  # (4, n - 1, n)
    return np.asarray(np.tensordot(moments, pieces, axes=([2, 1], [0, 1])), dtype=np.complex128)


def window(x: Array) -> Array:
    """Transform of a Hann window of length 1, over that at 0, at x = f T: sinc x / (1 - x²)."""
    at_one = np.isclose(np.abs(x), 1.0)
    apart = np.where(at_one, 0.0, x)
    return np.asarray(np.where(at_one, 0.5, np.sinc(apart) / (1 - apart**2)))


FAMILY = Family(
    name="sweep-bias",
    side=PROCESSING,
    what="peak-hold near a lightly damped mode",
    example="sweep-bias",
    stage=BODY_STAGE,
    change=change,
    equation="H'(f) = ∫ H(ν) k(ν) dν / ∫ k(ν) dν, k = W(f - ν) exp(-i π (ν - f)² / s), s the sweep rate in Hz/s, "
    "W of the block's Hann window",
    mistaken_for=("structural-damping", "layer-damping", "accelerometer-gain"),
    confirmed_by="the full-record spectrum of the same run; longer blocks. A slower sweep does not help",
    reference="short-time spectrum of a linear chirp by stationary phase; Harris, Proc. IEEE 66 (1978) 51-83, for the window",
    sentence="Peak-hold spectra cut the record into blocks, and a lightly damped mode rings on from one into the next: its peak "
    "looks lower and wider than it is, up to 44 % at 0.35 % damping. Nothing is wrong with the structure.",
)
