"""The paper's way, whole: base motion, resultants, dynamic mass (Eqs. 6 to 11), ten parameters, tare taken off.

Its interval is honest, too: noise *and* every tolerance of the measurement chain are propagated through the same estimator. An
error of the chain acts on article and tare alike; what it does to their difference is what is left of it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array
from geometry.inertia import Inertia
from identification.base_motion import base_motion
from identification.chain import Chain, chain
from identification.elastic import model
from identification.elastic.fit import kept, lines_of
from identification.elastic.model import UPPER
from identification.request import Evidence, Identified, Known, Settings, TareSpectra
from identification.resultants import resultants
from identification.rigid_band import drift
from identification.self_calibration import problem
from identification.self_calibration.problem import WITHOUT_TARE
from identification.self_calibration.solve import inverse
from identification.setup import CHAIN_ERROR, Setup, setup
from identification.spectra.line_spectra import Spectra

# How the plain estimate of a set-up answers to errors of its channels: to first order, in every step of Eqs. 6 to 11 and 8b.
#
# A channel that is off by dy changes motion and load by dU = T dy and dF = R dy, the dynamic mass by
#
#     dH = (dF - H dU) S_u^-1                                                       (from Eq. 10)
#
# and the ten parameters by the gain of the weighted fit. Errors of the measurement chain give dy = dA u; noise is independent
# from channel to channel, line to line and run to run.


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
    scale = model.pack(np.ones(10), type(found.terms)(), model.ElasticLayout(modes=0))[:10]
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


_DEFAULT = Settings()

FACTS_LEFT_OUT = "the plain way takes no classical facts; see the self-calibrated result"


@dataclass(frozen=True, eq=False, kw_only=True)
class Difference:
    """A sum of set-ups, each with its sign: the article less the FMD, or the FMD itself.

    Attributes
    ----------
    ten : (10,) about F
    raw : (10,) the same from raw spectra instead of dynamic masses
    chain : by parameter of the chain (10,) d ten / d offset
    parts : by input (10, 10) covariance that is not of the chain
    """

    ten: Array
    raw: Array
    chain: dict[str, Array]
    parts: dict[str, Array]


def plain(evidence: Evidence, settings: Settings = _DEFAULT, *, progress: Callable[[float], None] | None = None) -> Identified:
    """The article's ten parameters about F by Eqs. 6 to 11 and the modal terms of Eq. 8b, minus the FMD of the tares.

    Raises
    ------
    BadInput : as `identification.self_calibration.fit`.
    """
    groups, warnings = problem.hardware_groups(evidence, settings)
    tell = progress or (lambda share: None)
    found = setup(evidence.article, settings)
    tell(0.4)
    whole = _of_setup(evidence.article, found, settings)
    tell(0.6)
    tares = [tare for tare, group in zip(evidence.tares, groups, strict=True) if group == 0]
    fmd = of_tares(tares, settings) if tares else _known(evidence.fmd)
    tell(1.0)
    said = [*warnings, *found.notes, *([WITHOUT_TARE] if fmd is None else []), *([FACTS_LEFT_OUT] if evidence.facts else [])]
    of = whole if fmd is None else _less(whole, fmd)
    tolerances = tolerances_of(evidence.article, settings)
    parts = dict(of.parts)
    for name, row in of.chain.items():
        family = name.partition(":")[0]
        parts[family] = parts.get(family, np.zeros((10, 10))) + np.outer(row, row) * tolerances[name] ** 2
    covariance = covariance_of(of, tolerances)
    variance = np.maximum(np.diag(covariance), np.finfo(np.float64).tiny)
    kept = {name: part for name, part in parts.items() if np.any(np.diag(part) > 0)}
    return Identified(
        way="plain",
        inertia=Inertia(parameters=of.ten),
        covariance=covariance,
        band=found.fitted.band,
        elastic=found.terms if settings.modes != 0 else None,
        shares={name: np.diag(part) / variance for name, part in kept.items()},
        parts=kept,
        misfit=found.fitted.misfit,
        converged=found.fitted.converged,
        raw=of.raw,
        warnings=tuple(said),
    )


def of_tares(tares: list[TareSpectra], settings: Settings) -> Difference:
    """The FMD: the mean of what every tare leaves when the known article is taken off."""
    singles = [_of_setup(tare.spectra, setup(tare.spectra, settings), settings) for tare in tares]
    n = len(tares)
    names = {name for one in singles for name in one.chain}
    known = np.sum([tare.known.covariance for tare in tares], axis=0) / n**2
    of_known = np.mean([tare.known.inertia.parameters for tare in tares], axis=0)
    parts = {name: np.sum([one.parts[name] for one in singles], axis=0) / n**2 for name in singles[0].parts}
    return Difference(
        ten=np.mean([one.ten for one in singles], axis=0) - of_known,
        raw=np.mean([one.raw for one in singles], axis=0) - of_known,
        chain={name: np.sum([one.chain.get(name, np.zeros(10)) for one in singles], axis=0) / n for name in sorted(names)},
        parts={**parts, "tare": known},
    )


def covariance_of(of: Difference, tolerances: dict[str, float]) -> Array:
    """(10, 10) with every tolerance in it."""
    chain_part = np.sum([np.outer(row, row) * tolerances[name] ** 2 for name, row in of.chain.items()], axis=0)
    return np.asarray(np.sum(list(of.parts.values()), axis=0) + chain_part)


def tolerances_of(spectra: Spectra, settings: Settings) -> dict[str, float]:
    """By parameter of the chain, its standard deviation."""
    of = chain(spectra.table, settings.tolerances, stiffness=settings.stiffness, gravity=settings.gravity)
    return {one.name: one.tolerance for one in of.parameters}


def _of_setup(spectra: Spectra, found: Setup, settings: Settings) -> Difference:
    of = chain(spectra.table, settings.tolerances, stiffness=settings.stiffness, gravity=settings.gravity)
    answer: Sensitivity = sensitivity(spectra, found, of)
    # The floor of the fit stands for errors of the chain, which count on their own; the misfit says what it really is.
    elastic = found.fitted.covariance * min(found.fitted.misfit, 1.0)
    if settings.modes == 0:
        moved = drift(found.estimate.dynamic_mass, CHAIN_ERROR)
        elastic = np.outer(moved, moved)
    return Difference(
        ten=found.ten,
        raw=found.raw,
        chain=dict(zip(answer.names, answer.chain.T, strict=True)),
        parts={"noise": answer.noise, "elasticity": elastic},
    )


def _known(fmd: Known | None) -> Difference | None:
    return (
        None
        if fmd is None
        else Difference(ten=fmd.inertia.parameters, raw=fmd.inertia.parameters, chain={}, parts={"tare": fmd.covariance})
    )


def _less(whole: Difference, fmd: Difference) -> Difference:
    names = {**whole.chain, **fmd.chain}
    nothing = np.zeros(10)
    kinds = {**whole.parts, **fmd.parts}
    return Difference(
        ten=whole.ten - fmd.ten,
        raw=whole.raw - fmd.raw,
        chain={name: whole.chain.get(name, nothing) - fmd.chain.get(name, nothing) for name in names},
        parts={name: whole.parts.get(name, np.zeros((10, 10))) + fmd.parts.get(name, np.zeros((10, 10))) for name in kinds},
    )
