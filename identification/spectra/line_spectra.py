"""`Spectra`: complex lines of every channel in every run, and how far each can be trusted."""

from dataclasses import dataclass, replace
from math import ceil, log2

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array, freeze, frozen
from geometry.sensors import ChannelTable


@dataclass(frozen=True, eq=False, kw_only=True)
class Spectra:
    """Spectra of a campaign on one grid of lines.

    Attributes
    ----------
    table : channels, in the order of the last axis, and the reference point
    frequency : (n,) [Hz], ascending
    values : (r, n, c) complex, in the channel's SI unit per Hz of a full record, in the SI unit itself of peak-reference-hold
    noise : (r, n, c) standard deviation of the complex noise, E|noise|² = sd², in the unit of `values`; 0 where nothing is known
    quality : (r, n) share [0 to 1] of what the channels read that one rigid base motion and one resultant load explain
    runs : (r,) names
    axes : (r,) of `MOTIONS`, empty for a pattern of several axes
    method : "full-record", "peak-reference-hold", or "spectra" where the files held spectra
    noise_scatter : relative standard deviation of the noise's power at one line; 0 where it is not known
    noise_spread : relative standard deviation of the noise's power, all channels and lines together; 0 where it is not known
    warnings : sentences
    """

    table: ChannelTable
    frequency: Array
    values: ComplexArray
    noise: Array
    quality: Array
    runs: tuple[str, ...]
    axes: tuple[str, ...]
    method: str = "full-record"
    noise_scatter: float = 0.0
    noise_spread: float = 0.0
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        shape = (len(self.runs), len(self.frequency), len(self.table))
        freeze(self, frequency=shape[1:2], noise=shape, quality=shape[:2])
        object.__setattr__(self, "values", frozen(self.values, shape, "values", np.complex128))

    def at(self, lines: npt.ArrayLike) -> "Spectra":
        """The same on some of the lines alone, (n,) bool or their indices."""
        chosen = np.asarray(lines)
        return replace(
            self,
            frequency=self.frequency[chosen],
            values=self.values[:, chosen],
            noise=self.noise[:, chosen],
            quality=self.quality[:, chosen],
        )


# From time histories to complex spectra: the Fourier integral of the whole record, at whatever lines are asked for.
#
# A sweep is a transient. When its record begins before the drive and ends after the ring-down, the integral over all of it
#
#     X(f) = sum_k x_k exp(-2 pi i f k / rate) / rate
#
# is free of leakage, and the quotient of two such spectra is the response function at the line - for light damping too, where a
# block that is shorter than the ring-down is wrong by tens of per cent. It needs no window and no bins: lines lie where they are
# wanted (Bluestein's chirp transform; Rabiner, Schafer & Rader, IEEE Trans. Audio 17, 1969).

EVEN = 1e-9
"""How far lines may lie from an even grid, relative to their distance, and still be evenly spaced."""


def full_record(signals: npt.ArrayLike, sampling_rate: float, frequency: npt.ArrayLike, source: str = "record") -> ComplexArray:
    """Spectra of whole records [unit / Hz].

    Parameters
    ----------
    signals : (n, ...) equally sampled, any unit, first sample at time 0
    sampling_rate : [Hz]
    frequency : (m,) lines [Hz], ascending, up to half the sampling rate
    source : what the record is called in messages

    Returns
    -------
    (m, ...) complex

    Raises
    ------
    BadInput : lines beyond Nyquist, a record with NaN or infinity or of fewer than two samples.
    """
    x, lines = np.asarray(signals, dtype=np.float64), np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    if x.ndim < 1 or len(x) < 2 or not np.all(np.isfinite(x)):
        found = f"{len(x)} samples" if x.ndim and len(x) < 2 else "NaN or infinity"
        raise BadInput(source, "signals", f"a record of finite samples is needed, found {found}", "Check it")
    if not np.all((lines >= 0) & (lines <= sampling_rate / 2)):
        problem = f"lines end at half the sampling rate, {sampling_rate / 2:g} Hz, found {lines.min():g} to {lines.max():g} Hz"
        raise BadInput(source, "frequency", problem, "Ask for lines within, or record faster")
    steps = np.diff(lines)
    even = len(lines) > 2 and bool(np.all(np.abs(steps - steps.mean()) <= EVEN * steps.mean()))
    if even and (folded := _folded(x.reshape(len(x), -1), lines, steps.mean(), sampling_rate)) is not None:
        return np.asarray(folded.reshape(len(lines), *x.shape[1:]) / sampling_rate)
    if even:
        made = _chirp_transform(x.reshape(len(x), -1).T, lines[0] / sampling_rate, steps.mean() / sampling_rate, len(lines))
        return np.asarray(made.T.reshape(len(lines), *x.shape[1:]) / sampling_rate)
    k = np.arange(len(x))
    turning = (np.exp(-2j * np.pi * f / sampling_rate * k) for f in lines)
    return np.asarray(np.stack([np.tensordot(turn, x, axes=1) for turn in turning]) / sampling_rate)


def _folded(x: Array, lines: Array, step: float, sampling_rate: float) -> ComplexArray | None:
    """(m, c) sum_k x_k exp(-2 pi i f k) of x (n, c) at `lines` that are multiples of their `step`, of which a whole number is the
    `sampling_rate`: after so many samples all of them turn anew, so that the record may be laid upon itself. None of others."""
    size, first = round(sampling_rate / step), round(lines[0] / step)
    away = max(abs(sampling_rate / step - size) * (first + len(lines)) / size, abs(lines[0] / step - first))
    if away * step * len(x) / sampling_rate > EVEN:  # [turns] that a line is off at the end of the record
        return None
    sheet = np.array(x[:size]) if len(x) >= size else np.concatenate([x, np.zeros((size - len(x), x.shape[1]))])
    for start in range(size, len(x), size):
        piece = x[start : start + size]
        sheet[: len(piece)] += piece
    return np.asarray(np.fft.rfft(sheet.T)[:, first : first + len(lines)].T)


PIECE = 4
"""[count] of times as long as the lines are many that a piece of a record is at most: pieces that fit a processor's cache are
transformed faster than a whole record, and their lines add."""


def _chirp_transform(x: Array, first: float, step: float, count: int) -> ComplexArray:
    """(c, m) sum_k x_k exp(-2 pi i f k) of x (c, n) at the `count` frequencies f = `first` + j `step` [1/sample].

    With k j = (k² + j² - (j - k)²) / 2 it is a convolution with a chirp (Bluestein).
    """
    size = 2 ** ceil(log2(min(x.shape[1], max(PIECE * count, 1024)) + count))
    length = min(size - count + 1, x.shape[1])
    k, j = np.arange(length), np.arange(count)
    chirp = np.fft.fft(np.exp(1j * np.pi * step * np.square(np.arange(1 - length, count))), size)
    before, after = np.exp(-2j * np.pi * first * k - 1j * np.pi * step * k**2), np.exp(-1j * np.pi * step * j**2)
    lines, found = first + step * j, np.zeros((len(x), count), dtype=np.complex128)
    for start in range(0, x.shape[1], length):
        piece = x[:, start : start + length]
        moved = np.fft.fft(piece * before[: piece.shape[1]], size)
        moved *= chirp
        turned = np.exp(-2j * np.pi * np.remainder(lines * start, 1.0)) * after
        found += np.fft.ifft(moved)[:, length - 1 : length - 1 + count] * turned
    return found


def without_straight_line(samples: Array) -> Array:
    """`samples` (n, c) less the straight line that fits each channel best."""
    t = np.arange(len(samples)) - (len(samples) - 1) / 2
    slope = (t @ samples) / max(float(t @ t), np.finfo(np.float64).tiny)
    line = np.multiply(t[:, None], slope, out=np.empty_like(samples, dtype=np.float64))  # as `samples` lie in memory
    line += samples.mean(axis=0)
    return np.asarray(np.subtract(samples, line, out=line))


def hann(size: int) -> Array:
    """The periodic Hann window (size,)."""
    return 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(size) / size)
