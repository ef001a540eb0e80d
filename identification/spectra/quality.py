"""How much of what the channels read one rigid base motion and one load explain: a coherence of a single run.

A coherence function takes averages over many records; a sweep is driven once. What takes its place is redundancy: eight
accelerometers read six motions, eight load-cell channels six resultants. The quality of a line is

    min( 1 - |y_a - G u|² / |y_a|²,   1 - |V y_f|² / |y_f|² )

the smaller of the share of the accelerations that a rigid motion explains and the share of the forces that cells of equal
stiffness explain (V: the orthonormal combinations that must balance). It is 1 where nothing is redundant: then nothing is tested.
Cells whose stiffnesses differ by 5 % cost about 0.001, noise of 1 % of the signal 0.0001 or less, an inverted channel a tenth
and more.
"""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from identification.base_motion import base_motion
from identification.resultants import resultants
from identification.spectra.line_spectra import Spectra


def of_lines(spectra: Spectra, *, gravity: float) -> Array:
    """The quality (r, n) [0 to 1] of every run and line; 1 where the channels hold nothing redundant."""
    return np.minimum(_of_accelerations(spectra, gravity), _of_forces(spectra))


def _of_accelerations(spectra: Spectra, gravity: float) -> Array:
    try:
        motion = base_motion(spectra, gravity=gravity)
    except BadInput:
        return np.ones(spectra.values.shape[:2])
    return _explained(motion.residual, _readings(spectra, motion.channels))


def _of_forces(spectra: Spectra) -> Array:
    try:
        loads = resultants(spectra)
    except BadInput:
        return np.ones(spectra.values.shape[:2])
    orthonormal = np.linalg.svd(loads.combinations, full_matrices=False)[2]
    readings = _readings(spectra, loads.channels)
    return _explained(readings @ orthonormal.T, readings)


def _readings(spectra: Spectra, names: tuple[str, ...]) -> ComplexArray:
    return spectra.values[:, :, [spectra.table.names.index(name) for name in names]]


def _explained(residual: ComplexArray, readings: ComplexArray) -> Array:
    whole = np.sum(np.abs(readings) ** 2, axis=2)
    left = np.sum(np.abs(residual) ** 2, axis=2)
    return np.asarray(np.clip(1 - left / np.where(whole > 0, whole, 1.0), 0.0, 1.0))
