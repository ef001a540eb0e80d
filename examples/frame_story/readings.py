"""What the readings say before anything is fitted: eigenfrequencies, the mass line, and how long the first mode rings."""

from __future__ import annotations

import numpy as np

from geometry.frames import Array
from identification.spectra.peak_hold import kept, lone_mode
from validation.prediction.response_functions import ResponseFunctionTest

RESONANCES = ((4.0, 12.0), (12.0, 22.0), (22.0, 40.0))
MASS_LINE = (60.0, 90.0)
AROUND_FIRST = (5.5, 7.5)
"""[Hz] Where each resonance is looked for; the mass line; where the first mode is looked at."""


def resonances(test: ResponseFunctionTest) -> Array:
    """Measured eigenfrequencies (3,) [Hz]: the lines at which all readings together are largest."""
    f, level = test.measured.frequency, np.sum(np.abs(test.measured.values) ** 2, axis=(0, 2))
    return np.array([f[np.argmax(np.where((f > low) & (f < high), level, 0.0))] for low, high in RESONANCES])


def by_frequencies(test: ResponseFunctionTest, mass: float) -> dict[str, float]:
    """What the frequencies alone say of storeys of `mass` [kg]: the one factor on all that fits best, and what it leaves."""
    found, drawn = resonances(test), test.structure.frequency
    factor = float(np.mean(drawn / found) / np.mean((drawn / found) ** 2))  # least squares of factor * drawn / found - 1
    left = float(np.sqrt(np.mean((factor * drawn / found - 1) ** 2)))
    return {"mass_kg": mass * (1 / factor**2 - 1), "stiffness_percent": 100 * (factor**2 - 1), "rms_percent": 100 * left}


def mass_line(test: ResponseFunctionTest) -> dict[str, Array]:
    """Mass [kg] of every floor on the mass line: of each drive point by itself, and of all three runs as one matrix.

    By itself a drive point reads 1 / A_jj, as if no spring held the floor; the inverse of all nine accelerances is
    M - K / omega², and its part that does not change with frequency is the mass.
    """
    f, A = test.measured.frequency, test.measured.values.transpose(1, 2, 0)
    there = (f > MASS_LINE[0]) & (f < MASS_LINE[1])
    alone = [1 / np.mean(A[there, j, j].real) for j in range(3)]
    whole = np.linalg.inv(A[there]).real.reshape(-1, 9)
    terms = np.column_stack([np.ones(int(there.sum())), -1 / (2 * np.pi * f[there]) ** 2])
    return {"alone": np.array(alone), "together": np.linalg.lstsq(terms, whole, rcond=None)[0][0].reshape(3, 3).diagonal()}


def ringing(test: ResponseFunctionTest, damping_ratio: float) -> dict[str, float]:
    """The first mode by itself, and what the end of a record of one over the spacing of the lines makes of it.

    `damping_ratio` is where its fit begins.
    """
    f, values = test.measured.frequency, test.measured.values
    near = (f > AROUND_FIRST[0]) & (f < AROUND_FIRST[1])
    readings = values[:, near].transpose(1, 0, 2).reshape(int(near.sum()), -1)
    mode = lone_mode(f[near], readings, near=float(resonances(test)[0]), damping_ratio=damping_ratio)
    cut = kept(mode.frequency, mode.damping_ratio, 1 / float(f[1] - f[0]))
    return {
        "left_percent": 100 * abs(1 - cut),
        "lifted_percent": 100 * (abs(cut) - 1),
        "turned_deg": float(np.degrees(np.angle(cut))),
        "measured_turn_deg": float(np.degrees(mode.turn)),
    }
