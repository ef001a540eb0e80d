"""Signals with a delay or a high-pass taken out: time histories by their Fourier transform, spectra line by line.

A record is no period of anything. Before the transform it is continued beyond both ends by its own mirror image through the end
point, so that value and slope go on, and faded to a constant there: what the transform wraps round meets nothing. What a shift
brings in from beyond an end was never recorded, and is of that continuation.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from identification.recording import Recording

Samples = npt.NDArray[Any]
Response = Callable[[Array], ComplexArray]
"""By frequency (n,) [Hz], from 0 on, what a line is multiplied with: (n,), or (n, k, k) where k channels mix."""

MARGIN = 4096
"""Samples of the continuation at each end, or as many as the record has."""


def filtered(recording: Recording, columns: Sequence[int], response: Response) -> Recording:
    """`recording` with `columns` through a filter of this frequency response."""
    values = np.array(recording.values)
    if recording.frequency is not None:
        values[:, columns] = _times(response(recording.frequency), values[:, columns])
    elif recording.sampling_rate is not None:
        values[:, columns] = through(values[:, columns], recording.sampling_rate, response)
    return replace(recording, values=values)


def through(values: Samples, rate: float, response: Response) -> Array:
    """Time histories `values` (n, k) at `rate` [Hz] through the filter."""
    from scipy.fft import irfft, next_fast_len, rfft, rfftfreq

    n = len(values)
    margin = min(n - 1, MARGIN)
    length = next_fast_len(n + 2 * margin, real=True)
    continued = _continued(values, margin, length - n - margin)
    spectra = _times(response(rfftfreq(length, 1 / rate)), rfft(continued, axis=0))
    return np.asarray(irfft(spectra, n=length, axis=0)[margin : margin + n])


def advanced(seconds: float) -> Response:
    """What comes so many seconds earlier: ``e^{i omega tau}``."""
    return lambda frequency: np.asarray(np.exp(2j * np.pi * seconds * frequency), dtype=np.complex128)


def without_highpass(corner: float, held: float = 0.0) -> Response:
    """``1 - i f_c / f``, the inverse of a first-order high-pass of this `corner` [Hz]; 1 at 0 Hz, of which nothing is left.

    Its gain grows without end towards 0 Hz, where a record has drift and offset. Below the frequency `held` [Hz] it is held back,
    ``1 - i f_c f / (f² + held²)``.
    """

    def response(frequency: Array) -> ComplexArray:
        square = frequency**2 + held**2
        share = np.divide(frequency, square, out=np.zeros_like(square), where=square > 0)
        return np.asarray(1 - 1j * corner * share, dtype=np.complex128)

    return response


def _times(factors: ComplexArray, spectra: ComplexArray) -> ComplexArray:
    if factors.ndim == 1:
        return np.asarray(factors[:, None] * spectra)
    return np.asarray((factors @ spectra[:, :, None])[:, :, 0])


def _continued(values: Samples, before: int, after: int) -> Array:
    """`values` (n, k) with `before` and `after` samples beyond its ends."""
    mean = values.mean(axis=0)
    head = 2 * values[0] - values[before:0:-1]
    short = min(after, len(values) - 1)
    tail = np.full((after, values.shape[1]), mean)
    tail[:short] = (2 * values[-1] - values[-2 : -2 - short : -1] - mean) * _fading(short)[:, None] + mean
    return np.concatenate([(head - mean) * _fading(before)[::-1, None] + mean, values, tail])


def _fading(count: int) -> Array:
    """(count,) from nearly 1 to nearly 0, even at both ends."""
    return np.asarray(0.5 * (1 + np.cos(np.pi * (np.arange(count) + 1) / (count + 1))))
