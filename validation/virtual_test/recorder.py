"""What a recorder adds: noise of every channel and the mains' hum, at the rate of the record."""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from validation.virtual_test.chain_truth import ChainTruth
from validation.virtual_test.plan import Plan
from validation.virtual_test.streams import stream

MAINS = 50.0
"""[Hz]."""

DRIFT = 0.02
"""[Hz] by which the mains' frequency differs from run to run, standard deviation."""

HARMONICS = {1: 1.0, 3: 0.3, 5: 0.1}
"""Amplitude of each harmonic over that of the fundamental."""


def disturbed(values: Array, names: tuple[str, ...], chain: ChainTruth, plan: Plan, run: str) -> Array:
    """`values` (m, c) with the noise and the hum of this article's `run`."""
    time = np.arange(len(values)) / plan.rate
    hum = stream(plan.seed, "mains", plan.article, run)
    waves = _waves(time, MAINS + DRIFT * hum.standard_normal(), plan.rate)
    found = np.array(values, order="F")
    for k, name in enumerate(names):
        phases = np.exp(1j * hum.uniform(0.0, 2 * np.pi, len(HARMONICS)))
        found[:, k] += _noise(name, len(time), chain, plan, run)
        found[:, k] += chain.mains.get(name, 0.0) * (phases @ waves).imag
    return found


def _noise(name: str, count: int, chain: ChainTruth, plan: Plan, run: str) -> Array | float:
    rms = chain.noise_rms.get(name, 0.0)
    return rms * stream(plan.seed, "noise", plan.article, run, name).standard_normal(count) if rms else 0.0


def _waves(time: Array, frequency: float, rate: float) -> ComplexArray:
    """(h, m) rotating phasors of unit mains and its harmonics; zero for those that a record of `rate` [Hz] cannot hold."""
    phasor = np.exp(2j * np.pi * frequency * time)
    return np.array([share * phasor**order if order * frequency < rate / 2 else 0 * phasor for order, share in HARMONICS.items()])
