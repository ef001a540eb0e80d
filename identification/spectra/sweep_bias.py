"""By how much peak-reference-hold and full-record spectra miss the response function of a lightly damped mode in a sweep.

A mass on a spring and a dashpot stands on a table that sweeps. The load on the table per acceleration is

    H = m (1 + omega² / (omega_r² - omega² + 2 i zeta omega_r omega))

The mode is integrated in time with a step so short that its own error (the drive taken for piecewise linear, relative
(omega dt)² / 12) is a millionth, brought to the campaign's rate by leaving samples out, and both kinds of spectra are divided by
those of the drive.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from identification.spectra.full_record import full_record
from identification.spectra.peak_hold import BLOCK_SIZE, OVERLAP, peak_reference_hold

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
    decay = 2 * np.pi * resonance * damping_ratio
    fine = rate * finer
    drive = _sweep(fine, start, stop, octaves_per_minute, 14 / decay if ring_down is None else ring_down)
    load = drive + _relative(drive, fine, resonance, damping_ratio)
    pair = np.column_stack([drive, load])[::finer]
    held = peak_reference_hold(pair, rate, pair[:, 0], frequency, block_size=block_size, overlap=overlap)
    full = full_record(pair, rate, frequency)
    omega, omega_r = 2 * np.pi * frequency, 2 * np.pi * resonance
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


def _relative(drive: Array, rate: float, resonance: float, damping_ratio: float) -> Array:
    """The acceleration (n,) of the mass relative to the table, exact for a piecewise linear drive."""
    from scipy.signal import cont2discrete, lfilter

    omega = 2 * np.pi * resonance
    system = ([-1.0, 0.0, 0.0], [1.0, 2 * damping_ratio * omega, omega**2])
    numerator, denominator, _ = cont2discrete(system, 1 / rate, method="foh")
    return np.asarray(lfilter(np.squeeze(numerator), denominator, drive), dtype=np.float64)
