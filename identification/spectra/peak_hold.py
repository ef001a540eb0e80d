"""The paper's peak-reference-hold spectra, and the same operator on a model.

A record is cut into overlapping blocks behind a Hann window. Of each line of the native grid the block counts in which the
*reference* channel is largest - for a sweep the one that passes the line - and *all* channels are taken from that block.
Neighbouring lines come from different blocks, whose phases have nothing to do with each other; so every line is turned until the
reference is real, and only then interpolated to the grid that is asked for. Spectra are amplitudes [unit], not densities: a
sine of amplitude 1 reads 1.

A block of 15 s holds neither the run-up of a lightly damped resonance nor its ring-down, so the quotient of two such spectra
is not the response function near it (`examples/peak_hold_bias.py` measures by how much). Data that exist only
in this form are compared with a model that went through the same operator: `applied`.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import ComplexArray, DynamicMass
from geometry.errors import BadInput
from geometry.frames import Array
from identification.campaign import Campaign, block_length, block_rms
from identification.spectra.line_spectra import hann

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
    if not (0 <= overlap < 1 and block_size >= 16):
        found = f"found a block of {block_size} samples and an overlap of {overlap:g}"
        raise _refused(source, "processing", f"blocks of 16 samples or more overlap by 0 to below 1, {found}", "Correct it")
    if len(x) < block_size:
        remedy = "Take a smaller block_size, or full-record spectra"
        raise _refused(source, "block_size", f"the record of {len(x)} samples is shorter than a block of {block_size}", remedy)
    step = rate / block_size
    if lines[0] < 2 * step or lines[-1] > rate / 2:
        problem = f"lines from {2 * step:g} to {rate / 2:g} Hz can be resolved, found {lines[0]:g} to {lines[-1]:g} Hz"
        raise _refused(source, "frequency", problem, "Ask for lines within, or take longer blocks")
    first, last = int(np.floor(lines[0] / step)), int(np.ceil(lines[-1] / step))
    native = np.arange(first, min(last, block_size // 2) + 1) * step  # the native lines that enclose `lines`
    window, held, peak = hann(block_size), np.zeros((len(native), x.shape[1]), dtype=np.complex128), np.zeros(len(native))
    for start in range(0, len(x) - block_size + 1, max(round(block_size * (1 - overlap)), 1)):
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


def _padded(samples: int) -> int:
    from scipy.fft import next_fast_len

    return int(next_fast_len(2 * samples, real=True))


def _lines_of(block: Array, window: Array, first: int, count: int) -> ComplexArray:
    """Amplitude spectrum of one block (b, ...) at `count` native lines from `first`."""
    shaped = window.reshape(-1, *(1,) * (block.ndim - 1))
    return np.asarray(2 / window.sum() * np.fft.rfft(block * shaped, axis=0)[first : first + count], dtype=np.complex128)


def _refused(source: str, field: str, problem: str, remedy: str) -> BadInput:
    return BadInput(source, field, problem, remedy)


# A mode that still rings when its record ends: what the cut makes of its resonance, and how to look at it by itself.
#
# The response to a blow holds exp(lambda t), lambda = -zeta omega_1 + i omega_1 to first order in zeta. Its transform over T
# seconds is that of the whole decay times 1 - exp((lambda - i omega) T), and at the lines k / T that is one number, the same at
# all of them: the resonance keeps its shape, is too high or too low, and is turned. A fit that knows nothing of it takes it for
# mass.

WIDEST = 0.5
"""Damping ratio beyond which no resonance is left to fit."""


@dataclass(frozen=True, eq=False, kw_only=True)
class LoneMode:
    """One mode of several accelerances, fitted by itself.

    Attributes
    ----------
    frequency : [Hz]
    damping_ratio : [1]
    residues : (k,) complex; real for a mode of a lightly damped structure that was recorded to its end
    """

    frequency: float
    damping_ratio: float
    residues: ComplexArray

    @property
    def turn(self) -> float:
        """Angle [rad] by which the residues are turned from the real axis, their mean on the unit circle, in -pi/2 ... pi/2."""
        return float(np.angle(np.sum((self.residues / np.abs(self.residues)) ** 2)) / 2)


def lone_mode(frequency: npt.ArrayLike, accelerances: npt.ArrayLike, near: float, damping_ratio: float = 0.002) -> LoneMode:
    """The mode that `accelerances` (n, k) at the lines `frequency` (n,) [Hz] show around it, beside a constant for all others.

    Every line counts relative to what it reads: the skirts, where leakage is least, as much as the peak.

    Parameters
    ----------
    near : [Hz] where to begin, within half its width
    damping_ratio : to begin with
    """
    from scipy.optimize import least_squares

    omega, y = 2 * np.pi * np.asarray(frequency, dtype=np.float64), np.asarray(accelerances, dtype=np.complex128)

    def left(x: Array) -> Array:
        error = _fitted(omega, y, x)[1].ravel()
        return np.concatenate([error.real, error.imag])

    limits = ([0.0, np.log(1e-6)], [np.inf, np.log(WIDEST)])
    found = least_squares(left, [near, np.log(damping_ratio)], x_scale=[1e-3 * near, 0.1], bounds=limits).x
    return LoneMode(frequency=float(found[0]), damping_ratio=float(np.exp(found[1])), residues=_fitted(omega, y, found)[0])


def _fitted(omega: Array, y: ComplexArray, x: Array) -> tuple[ComplexArray, ComplexArray]:
    """Residues (k,) at frequency x[0] [Hz] and damping exp(x[1]), and relative errors (n, k)."""
    own, zeta = 2 * np.pi * x[0], np.exp(x[1])
    basis = np.column_stack([omega**2 / (omega**2 - own**2 - 2j * zeta * own * omega), np.ones_like(omega)])
    weight = 1 / np.abs(y)
    found = [np.linalg.lstsq(w[:, None] * basis, w * one, rcond=None)[0] for w, one in zip(weight.T, y.T, strict=True)]
    return np.array(found)[:, 0], np.asarray((basis @ np.array(found).T - y) * weight)


# Records that begin or end in motion: what the Fourier integral of a whole record cannot know.
#
# The integral is free of leakage only when the record holds everything from rest to rest. Half a second of missing ring-down is
# visible as misfit at the sweep's end.

IN_MOTION = 2.0
"""How far above its noise a channel reads when it still moves."""

JERK = 6.0
"""How far above its noise the very first sample lies when the record begins in motion: a drive that starts from rest does not."""

UNKNOWN = 0.01
"""Share of its largest block above which a channel still moves, where its noise is not known."""

NEGLIGIBLE = 1e-4
"""Share of its largest block below which a channel counts as still whatever its noise: records without noise ring for ever."""

NAMED = 3
"""How many channels a warning names."""


def warnings(campaign: Campaign, floors: Array) -> tuple[str, ...]:
    """Sentences about runs of time histories that do not begin or end at rest; `floors` (r, c) as of `noise.OfLines`."""
    found = []
    for run, floor in zip(campaign.runs, floors, strict=True):
        recorded = campaign.recordings[run.name]
        if recorded.sampling_rate is None:
            continue
        values, rms = recorded.values, recorded.rms
        if len(rms) < 2:
            continue
        last = block_rms(values[::-1][: block_length(recorded.sampling_rate)], recorded.sampling_rate)
        level = rms.max(axis=0)
        still = np.where(floor > 0, np.maximum(IN_MOTION * floor, NEGLIGIBLE * level), UNKNOWN * level)
        first = np.abs(values[0] - values.mean(axis=0))
        begins = (rms[0] > still) & (first > JERK / IN_MOTION * still)
        began = "begins in motion", "what went before is missing from its spectra", "Start recording before the drive"
        ended = "ends before the ring-down", "what would have followed is missing from its spectra", "Record longer"
        found.append(_said(run.name, recorded.names, rms[0], level, begins, began))
        found.append(_said(run.name, recorded.names, last[0], level, last[0] > still, ended))
    return tuple(text for text in found if text)


def _said(run: str, names: tuple[str, ...], rms: Array, level: Array, moving: np.ndarray, words: tuple[str, str, str]) -> str:
    if not moving.any():
        return ""
    share = np.where(moving, rms / np.where(level > 0, level, 1.0), 0.0)
    worst = [int(k) for k in np.argsort(-share, kind="stable")[:NAMED] if moving[k]]
    which = ", ".join(f"{names[k]} at {100 * share[k]:.2g} %" for k in worst)
    more = f" and {int(moving.sum()) - len(worst)} more" if moving.sum() > len(worst) else ""
    what, why, remedy = words
    return f"run {run} {what} ({which}{more} of its largest half second): {why}. {remedy}"
