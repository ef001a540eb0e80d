"""The paper's peak-reference-hold spectra, and the same operator on a model.

A record is cut into overlapping blocks behind a Hann window. Of each line of the native grid the block counts in which the
*reference* channel is largest - for a sweep the one that passes the line - and *all* channels are taken from that block.
Neighbouring lines come from different blocks, whose phases have nothing to do with each other; so every line is turned until the
reference is real, and only then interpolated to the grid that is asked for. Spectra are amplitudes [unit], not densities: a
sine of amplitude 1 reads 1.

A block of 15 s holds neither the run-up of a lightly damped resonance nor its ring-down, so the quotient of two such spectra
is not the response function near it (`identification.spectra.sweep_bias` measures by how much). Data that exist only
in this form are compared with a model that went through the same operator: `applied`.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray, DynamicMass
from geometry.errors import BadInput

BLOCK_SIZE, OVERLAP = 8192, 0.9
"""The paper's settings."""

SILENT = 1e-12
"""Share of its largest line below which the reference says nothing about a line."""


def peak_reference_hold(
    signals: npt.ArrayLike,
    rate: float,
    reference: npt.ArrayLike,
    frequency: npt.ArrayLike,
    *,
    block_size: int = BLOCK_SIZE,
    overlap: float = OVERLAP,
    source: str = "record",
) -> ComplexArray:
    """Peak-reference-hold spectra [unit], phases relative to the reference.

    Parameters
    ----------
    signals : (n, c) equally sampled
    rate : [Hz]
    reference : (n,) the channel that chooses the block and gives the phase
    frequency : (m,) lines [Hz], ascending, up to half the sampling rate
    block_size : samples
    overlap : share of a block, from 0 to below 1
    source : what the record is called in messages

    Returns
    -------
    (m, c) complex

    Raises
    ------
    BadInput : a record shorter than a block, lines beyond Nyquist or below the second native line, a silent reference.
    """
    x, r = np.asarray(signals, dtype=np.float64), np.asarray(reference, dtype=np.float64)
    lines = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    native = _native(len(x), rate, lines, block_size, overlap, source)
    window, held, peak = hann(block_size), np.zeros((len(native), x.shape[1]), dtype=np.complex128), np.zeros(len(native))
    first = round(native[0] * block_size / rate)
    for start in _starts(len(x), block_size, overlap):
        block = _lines_of(r[start : start + block_size], window, first, len(native))
        larger = np.abs(block) > peak
        if not larger.any():
            continue
        every = _lines_of(x[start : start + block_size], window, first, len(native))
        turn = np.abs(block[larger]) / block[larger]
        held[larger], peak[larger] = every[larger] * turn[:, None], np.abs(block[larger])
    if not np.all(peak > SILENT * peak.max()):
        raise _refused(source, "reference", "the reference channel is silent at some of the lines", "Choose a driven one")
    return np.stack([np.interp(lines, native, column) for column in held.T], axis=1)


def applied(
    dynamic_mass: DynamicMass,
    motion: npt.ArrayLike,
    rate: float,
    reference: npt.ArrayLike,
    frequency: npt.ArrayLike,
    *,
    block_size: int = BLOCK_SIZE,
    overlap: float = OVERLAP,
) -> ComplexArray:
    """The load spectra that a model predicts for a recorded base motion, through the same operator.

    Parameters
    ----------
    dynamic_mass : the model, at the lines of `model_lines`; beyond them the predicted load is left out
    motion : (n, 6) recorded accelerations of its reference point, order of `MOTIONS`
    rate : [Hz]
    reference : (n,) the recorded reference channel: the same blocks count for data and model
    frequency, block_size, overlap : as in `peak_reference_hold`

    Returns
    -------
    (m, 6) complex loads

    Raises
    ------
    BadInput : the model is not at the lines of the record, and as in `peak_reference_hold`.
    """
    u = np.asarray(motion, dtype=np.float64)
    length = _padded(len(u))
    every = np.fft.rfftfreq(length, 1 / rate)
    at = np.searchsorted(every, dynamic_mass.frequency - rate / length / 2)
    if at[-1] >= len(every) or not np.allclose(every[at], dynamic_mass.frequency, rtol=0, atol=1e-6 * rate / length):
        raise _refused("model", "frequency", "the dynamic mass is not given at the lines of the record", "Take `model_lines`")
    U = np.fft.rfft(u, length, axis=0)
    F = np.zeros_like(U)
    F[at] = np.einsum("nij,nj->ni", dynamic_mass.matrix, U[at])
    loads = np.fft.irfft(F, length, axis=0)[: len(u)]
    return peak_reference_hold(loads, rate, reference, frequency, block_size=block_size, overlap=overlap, source="model")


def model_lines(samples: int, rate: float, band: tuple[float, float]) -> Array:
    """Lines (n,) [Hz] within `band` at which `applied` needs the model: those of the record, padded to twice its length."""
    every = np.fft.rfftfreq(_padded(samples), 1 / rate)
    return np.asarray(every[(every >= band[0]) & (every <= band[1])], dtype=np.float64)


def hann(size: int) -> Array:
    """The periodic Hann window (size,)."""
    return 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(size) / size)


def _padded(samples: int) -> int:
    from scipy.fft import next_fast_len

    return int(next_fast_len(2 * samples, real=True))


def _starts(samples: int, block_size: int, overlap: float) -> Iterator[int]:
    hop = max(round(block_size * (1 - overlap)), 1)
    yield from range(0, samples - block_size + 1, hop)


def _lines_of(block: Array, window: Array, first: int, count: int) -> ComplexArray:
    """Amplitude spectrum of one block (b, ...) at `count` native lines from `first`."""
    shaped = window.reshape(-1, *(1,) * (block.ndim - 1))
    return np.asarray(2 / window.sum() * np.fft.rfft(block * shaped, axis=0)[first : first + count], dtype=np.complex128)


def _native(samples: int, rate: float, lines: Array, block_size: int, overlap: float, source: str) -> Array:
    """The native lines that enclose `lines`."""
    if not (0 <= overlap < 1 and block_size >= 16):
        found = f"found a block of {block_size} samples and an overlap of {overlap:g}"
        raise _refused(source, "processing", f"blocks of 16 samples or more overlap by 0 to below 1, {found}", "Correct it")
    if samples < block_size:
        remedy = "Take a smaller block_size, or full-record spectra"
        raise _refused(source, "block_size", f"the record of {samples} samples is shorter than a block of {block_size}", remedy)
    step = rate / block_size
    if lines[0] < 2 * step or lines[-1] > rate / 2:
        problem = f"lines from {2 * step:g} to {rate / 2:g} Hz can be told, found {lines[0]:g} to {lines[-1]:g} Hz"
        raise _refused(source, "frequency", problem, "Ask for lines within, or take longer blocks")
    first, last = int(np.floor(lines[0] / step)), int(np.ceil(lines[-1] / step))
    return np.asarray(np.arange(first, min(last, block_size // 2) + 1) * step, dtype=np.float64)


def _refused(source: str, field: str, problem: str, remedy: str) -> BadInput:
    return BadInput(source=source, field=field, problem=problem, remedy=remedy)
