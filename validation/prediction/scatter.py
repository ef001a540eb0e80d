"""Noise of lines that brought no records along, from the lines themselves.

First, what is left when each line is compared with the mean of its neighbours. A response function is smooth over three lines
but for its resonances, noise is not: of y_k - (y_k-1 + y_k+1) / 2 noise of variance sd² makes 3/2 sd². The median over a stretch
of lines does not notice a resonance that is narrow beside it; the bent skirts of a high one make the noise look larger there, not
smaller. A complex normal number has the median modulus sd sqrt(ln 2) (Hampel, J. Am. Stat. Assoc. 69, 1974, for such medians).

Second, how far readings repeat: a linear structure answers at i to a force at j as it answers at j to one at i (Rayleigh, The
Theory of Sound, 1877, chapter 5), so that two runs measured the same number. What they differ by grows with what is read.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array

AROUND = 1.0
"""[Hz] to either side of a line over which the median is taken; a resonance is far narrower."""

FEWEST = 7
"""Lines that such a stretch must hold."""

_OF_MEDIAN = 1 / np.sqrt(1.5 * np.log(2))


def repeatability(accelerances: npt.ArrayLike) -> float:
    """Standard deviation of a reading as a share of it, from `accelerances` (r, n, r), run j driven where channel j reads.

    Raises
    ------
    ValueError : another shape, or one run alone.
    """
    A = np.asarray(accelerances, dtype=np.complex128)
    r = len(A)
    if A.ndim != 3 or A.shape[2] != r or r < 2:
        raise ValueError(f"`accelerances` must be (r, n, r) with two runs or more, found {A.shape}")
    pairs = [(A[j, :, i], A[i, :, j]) for i in range(r) for j in range(i)]
    apart = [np.abs(one - other) / np.hypot(np.abs(one), np.abs(other)) for one, other in pairs]
    return float(np.median(np.concatenate(apart)) / np.sqrt(np.log(2)))


def noise(frequency: npt.ArrayLike, values: npt.ArrayLike, around: float = AROUND) -> Array:
    """Standard deviation (r, n, c) of the complex noise of `values` (r, n, c) at `frequency` (n,) [Hz], E|noise|² = sd².

    Raises
    ------
    ValueError : fewer than `FEWEST` lines lie within `around` of some line.
    """
    from scipy.ndimage import median_filter

    f, y = np.asarray(frequency, dtype=np.float64), np.asarray(values, dtype=np.complex128)
    width = 2 * round(around / float(np.median(np.diff(f)))) + 1 if len(f) > 1 else 1
    if width < FEWEST or len(f) < width:
        raise ValueError(f"`frequency` must hold {FEWEST} lines within {around:g} Hz of each line, found a spacing for {width}")
    left = np.abs(y[:, 1:-1] - (y[:, :-2] + y[:, 2:]) / 2)
    left = np.concatenate([left[:, :1], left, left[:, -1:]], axis=1)
    return np.asarray(_OF_MEDIAN * median_filter(left, size=(1, width, 1), mode="nearest"))
