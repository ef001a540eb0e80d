"""How the plain estimate of a set-up answers to errors of its channels: to first order, in every step of Eqs. 6 to 11 and 8b.

A channel that is off by dy changes motion and load by dU = T dy and dF = R dy, the dynamic mass by

    dH = (dF - H dU) S_u^-1                                                       (from Eq. 10)

and the ten parameters by the gain of the weighted fit. Errors of the measurement chain give dy = dA u; noise is independent from
channel to channel, line to line and run to run.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from geometry.inertia import Inertia
from identification.base_motion import base_motion
from identification.elastic import model
from identification.elastic.lines import kept, lines_of
from identification.elastic.model import UPPER
from identification.measurement_chain import Chain
from identification.resultants import resultants
from identification.self_calibration.solve import inverse
from identification.setup import CHAIN_ERROR, Setup
from identification.spectra.line_spectra import Spectra


@dataclass(frozen=True, eq=False, kw_only=True)
class Sensitivity:
    """What errors of the channels do to the ten parameters of a set-up.

    Attributes
    ----------
    names : (p,) parameters of the chain
    chain : (10, p) d ten / d offset of each
    noise : (10, 10) covariance that the noise of the channels gives
    """

    names: tuple[str, ...]
    chain: Array
    noise: Array


def sensitivity(spectra: Spectra, found: Setup, chain: Chain) -> Sensitivity:
    """The sensitivity of the plain estimate `found` from `spectra` to the parameters of `chain` and to noise."""
    data = lines_of(found.estimate.dynamic_mass, found.noise, CHAIN_ERROR, None)
    chosen = kept(data)
    gain = _gain(found, data.at(chosen).frequency, data.at(chosen).deviation)
    thin = spectra.at(chosen)
    H = model.dynamic_mass(Inertia(parameters=found.ten).mass_matrix, found.terms, thin.frequency)
    inverse_motion = np.asarray(np.linalg.pinv(found.motion[:, chosen].transpose(1, 2, 0)), dtype=np.complex128)  # (n, r, 6)
    offsets = np.zeros(len(chain.parameters))
    changed = []
    for change in chain.derivatives(offsets, thin.frequency, H):
        dy = np.zeros(thin.values.shape, dtype=np.complex128)
        columns = [chain.columns[k] for k in change.channels]
        dy[:, :, columns] = (change.rows @ found.motion[:, chosen, :, None])[..., 0]
        changed.append(dy)
    dH = _dynamic_mass(_stacked(thin, changed), H, inverse_motion, len(spectra.runs))
    sensed = (gain.reshape(10, -1) @ dH.reshape(len(dH), -1).T).real
    noise = _noise(thin, H, inverse_motion, gain)
    return Sensitivity(names=tuple(one.name for one in chain.parameters), chain=sensed, noise=noise)


def _gain(found: Setup, frequency: Array, deviation: Array) -> ComplexArray:
    """(10, n, 6, 6) complex: d ten = Re sum gain * dH of the weighted fit at its end."""
    layout = found.fitted.layout
    dH = model.derivatives(found.terms, frequency, layout)[:, :, UPPER[0], UPPER[1]]
    J = (dH * np.sqrt(2) / deviation).reshape(len(dH), -1)
    covariance = inverse((J @ J.conj().T).real)
    scale = model.pack(np.ones(10), type(found.terms)(), model.Layout(modes=0))[:10]
    upper = (covariance[:10] @ (J.conj() * (np.sqrt(2) / deviation).ravel())).reshape(10, len(frequency), 21) / scale[
        :, None, None
    ]
    full = np.zeros((10, len(frequency), 6, 6), dtype=np.complex128)
    full[:, :, UPPER[0], UPPER[1]] += upper / 2  # the fit sees the mean of both halves
    full[:, :, UPPER[1], UPPER[0]] += upper / 2
    return full


def _stacked(spectra: Spectra, values: list[ComplexArray]) -> Spectra:
    """Several sets of values as so many times the runs of `spectra`, so that linear operators take them all at once."""
    count = len(values)
    return replace(
        spectra,
        values=np.concatenate(values) if count else spectra.values[:0],
        noise=np.concatenate([spectra.noise] * count) if count else spectra.noise[:0],
        quality=np.concatenate([spectra.quality] * count) if count else spectra.quality[:0],
        runs=spectra.runs * count,
        axes=spectra.axes * count,
    )


def _dynamic_mass(changed: Spectra, H: ComplexArray, inverse_motion: ComplexArray, runs: int) -> ComplexArray:
    """(p, n, 6, 6) dH of stacked changes of the channels."""
    if not changed.runs:
        return np.zeros((0, *H.shape), dtype=np.complex128)
    dU, dF = base_motion(changed).values, resultants(changed).values
    left = dF - (H @ dU[..., None])[..., 0]
    by_run = left.reshape(-1, runs, *left.shape[1:]).transpose(0, 2, 3, 1)  # (p, n, 6, r)
    return np.asarray(by_run @ inverse_motion)


def _noise(spectra: Spectra, H: ComplexArray, inverse_motion: ComplexArray, gain: ComplexArray) -> Array:
    """(10, 10): unit errors of every channel, weighed by the variance of its noise at each line and run."""
    channels = len(spectra.table)
    runs = len(spectra.runs)
    unit = [np.zeros(spectra.values.shape, dtype=np.complex128) for _ in range(channels)]
    for k, values in enumerate(unit):
        values[:, :, k] = 1.0
    stacked = _stacked(spectra, unit)
    dU, dF = base_motion(stacked).values, resultants(stacked).values
    left = (dF - (H @ dU[..., None])[..., 0]).reshape(channels, runs, len(H), 6)
    # g[k, n, c, r] = sum_ij gain[k, n, i, j] left[c, r, n, i] inverse_motion[n, r, j]
    g = np.einsum("knij,crni,nrj->kncr", gain, left, inverse_motion, optimize=True)
    weighted = g * (spectra.noise.transpose(1, 2, 0) / np.sqrt(2))
    flat = weighted.reshape(10, -1)
    return np.asarray((flat @ flat.conj().T).real)
