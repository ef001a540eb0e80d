"""Noise of one level over a band as a sum of equally strong lines of random phase, evaluated by FFT with exact derivatives."""

from __future__ import annotations

from math import ceil

import numpy as np

from fem.base_excitation.patterns.jet import Jet
from fem.base_excitation.patterns.pattern import Clock
from geometry.arrays import Array
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput


def period(duration: float) -> int:
    """[s] after which noise repeats itself: whole seconds, so that its lines are the same at every whole sampling rate."""
    return max(1, ceil(duration - 1e-9))


def numbers(start: float, stop: float, duration: float) -> Array:
    """Those multiples of 1 / `period` that lie between `start` and `stop` [Hz], both included; (k,)."""
    first, last = ends(start, stop, duration)
    return np.arange(first, last + 1, dtype=np.float64)


def ends(start: float, stop: float, duration: float) -> tuple[int, int]:
    """The first and the last of `numbers`; the last is below the first when there are none."""
    T = period(duration)
    return ceil(start * T - 1e-9), int(stop * T + 1e-9)


def phases(generator: np.random.Generator, lines: Array) -> dict[str, Array]:
    """Phase [rad] of every line, for every axis whether it is driven or not: the axes of a pattern do not shift each other's."""
    return {axis: generator.uniform(0.0, 2 * np.pi, lines.size) for axis in MOTIONS}


def noise(clock: Clock, lines: Array, phase: Array, duration: float, rms: float) -> Jet:
    """Displacement whose acceleration has the root mean square `rms` over a period, at the instants of `clock`.

    a = A sum_k cos(omega_k t + phi_k) with A = `rms` sqrt(2 / number of lines), and u of every line is -1/omega² of its a.

    Raises
    ------
    BadInput : a sampling rate at which the period has no whole number of samples.
    """
    T = period(duration)
    omega = 2 * np.pi * lines / T
    acceleration = rms * np.sqrt(2 / lines.size) * np.exp(1j * (phase - omega * clock.late))
    return Jet(*(_sampled(acceleration * (1j * omega) ** (order - 2), lines, clock, T) for order in range(3)))


def _sampled(amplitude: Array, lines: Array, clock: Clock, T: int) -> Array:
    """The real part of the sum over lines of amplitude exp(i omega t), one period by FFT and then repeated."""
    n = round(T * clock.sampling_rate)
    if abs(n - T * clock.sampling_rate) > 1e-6:
        problem = f"noise of a period of {T} s needs a whole number of samples in it, found {T * clock.sampling_rate:.6g}"
        remedy = "Sample at a whole number of hertz"
        raise BadInput(source="noise", field="sampling_rate", problem=problem, remedy=remedy)
    spectrum = np.zeros(n // 2 + 1, dtype=np.complex128)
    spectrum[lines.astype(np.intp)] = amplitude * n / 2
    return np.resize(np.fft.irfft(spectrum, n), clock.count)
