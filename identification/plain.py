"""The paper's way, whole: base motion, resultants, dynamic mass (Eqs. 6 to 11), ten parameters, tare taken off.

Its interval is honest, too: noise *and* every tolerance of the measurement chain are propagated through the same estimator. An
error of the chain acts on article and tare alike; what it does to their difference is what is left of it.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from weakref import WeakKeyDictionary

import numpy as np

from geometry.dynamic_mass import ComplexArray, DynamicMass
from geometry.errors import CheckFailed
from geometry.frames import Array
from geometry.inertia import Inertia
from identification import rigid_body
from identification.base_motion import RunNoise, base_motion, resultants
from identification.chain import Chain, chain
from identification.dynamic_mass import Estimate, bias, corrected, covariance, deviation, from_runs
from identification.elastic import model
from identification.elastic.fit import Fitted, fit, kept, levels, lines_of
from identification.elastic.model import UPPER, ElasticTerms
from identification.request import WITHOUT_TARE, Evidence, Identified, Settings, TareSpectra, hardware_groups
from identification.self_calibration.solve import inverse
from identification.spectra.line_spectra import Spectra

# The whole set-up of one campaign - FMD and what stands on it: the plain estimate, and the start of joint fits.
#
# Base motion and resultants (Eqs. 2, 3, 6, 7), dynamic mass (Eqs. 9 to 11), then ten parameters and the modal terms of Eq. 8b,
# its entries weighed by the noise of the channels where that is known. Where noise of the motions would make least squares of
# many runs too small, they are corrected for it. Beside this the ten follow from the raw spectra, which hide nothing in an H.

CHAIN_ERROR = 0.02
"""Error of a plain dynamic mass by gains, angles and positions, as a share of its level: a pole must lower more than that."""

BIAS = 0.1
"""Share of `CHAIN_ERROR` from which the noise of the motions is corrected for."""

LIMITED = "huber"
"""How a robust fit limits what single entries of H may say."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Setup:
    """What Eqs. 6 to 11 and 8b say of one campaign.

    Attributes
    ----------
    motion, load : (r, n, 6) of the reference point F
    estimate : dynamic mass and condition number
    fitted : ten parameters and elastic terms
    noise : (n, 6, 6) standard deviation of each entry of H by noise; None where that of a channel is not known
    raw : (10,) about F from the raw spectra instead of H, the same elastic terms taken off
    notes : what was done about noise, sentences without their full stop
    """

    motion: ComplexArray
    load: ComplexArray
    estimate: Estimate
    fitted: Fitted
    noise: Array | None
    raw: Array
    notes: tuple[str, ...] = ()

    @property
    def ten(self) -> Array:
        """(10,) of everything above the force plane, about F."""
        return self.fitted.parameters

    @property
    def terms(self) -> ElasticTerms:
        """Elastic terms; none at all for a rigid set-up."""
        return self.fitted.terms


def setup(spectra: Spectra, settings: Settings) -> Setup:
    """The set-up of `spectra`, rigid or with elastic terms as `settings.modes` asks.

    Raises
    ------
    BadInput : channels or runs that do not tell six motions and six loads.
    """
    known = _KNOWN.get(spectra)
    if known is None or known[0] is not settings:
        known = _KNOWN[spectra] = (settings, _setup(spectra, settings))  # the plain and the joint way begin with it
    return known[1]


_KNOWN: "WeakKeyDictionary[Spectra, tuple[Settings, Setup]]" = WeakKeyDictionary()


def _setup(spectra: Spectra, settings: Settings) -> Setup:
    moved, loaded = base_motion(spectra, gravity=settings.gravity), resultants(spectra)
    motion, load = moved.values, loaded.values
    known = np.all(np.isfinite(spectra.noise)) and np.all(spectra.noise > 0)
    noise = RunNoise(load=loaded.covariance, motion=moved.covariance) if known else None
    estimate = from_runs(load, motion, spectra.frequency, spectra.table.origin)
    spread = None if noise is None else deviation(covariance(estimate, noise))
    notes: tuple[str, ...] = ()
    expected = 0.0 if noise is None else float(bias(estimate, noise).max())
    if noise is not None and expected > BIAS * CHAIN_ERROR:  # errors in variables where noise of the motions matters
        low = f"noise of the accelerometers makes least squares of H up to {100 * expected:.2g} % too low"
        try:
            estimate = replace(estimate, dynamic_mass=corrected(load, motion, noise, estimate)[0])
            notes = (f"{low}; corrected as errors in variables",)
        except CheckFailed:
            notes = (f"{low}; the correction does not settle and is left out",)
    fitted = fit(estimate.dynamic_mass, weights=spread, modes=settings.modes, floor=CHAIN_ERROR)
    limit = LIMITED if settings.robust else ""
    raw = rigid_body.from_spectra(motion, load, spectra.frequency, spectra.table.origin, robust=limit, elastic=fitted.terms)
    if settings.robust:
        # (10,) from all entries of H with the elastic terms taken off; those that do not fit lose their say
        H = estimate.dynamic_mass
        floor = CHAIN_ERROR * levels(H.matrix)
        weights = 1 / (floor if spread is None else np.hypot(floor, spread))
        limited = rigid_body.fit(H, weights=weights, robust=LIMITED, elastic=fitted.terms).inertia.parameters
        fitted = replace(fitted, parameters=limited)
    return Setup(
        motion=motion, load=load, estimate=estimate, fitted=fitted, noise=spread, raw=raw.inertia.parameters, notes=notes
    )


# What a rigid-body fit of an elastic structure is off by: how far it moves when only the lowest lines are left.
#
# A rigid body has the same ten parameters in every band, with the same errors of the measurement chain. Elasticity grows with
# omega² below the first resonance and has any size beyond, so that the fit over the band differs from that over its low end. The
# difference is taken for one standard deviation, in the direction in which it points, where it exceeds the scatter of the low
# end.

LOW_END_SHARE = 0.1
"""Share of the band that is its low end."""

LOW_END_LINES = 5
"""Lines at least that make a low end."""

SIGNIFICANT = 18.3
"""Square of the difference in its scatter, 95th percentile of ten."""


def drift(dynamic_mass: DynamicMass, floor: float) -> Array:
    """(10,) rigid fit over all lines of `dynamic_mass` less that over its low end; zero where noise alone differs as much."""
    f = dynamic_mass.frequency
    high = max(float(f[0] + LOW_END_SHARE * (f[-1] - f[0])), float(f[min(LOW_END_LINES, len(f)) - 1]))
    whole, low = (fit(dynamic_mass, modes=0, floor=floor, band=band) for band in (None, (float(f[0]), high)))
    moved = np.asarray(whole.parameters - low.parameters)
    scatter = low.covariance * min(low.misfit, 1.0)
    size = np.sqrt(np.maximum(np.diag(scatter), np.finfo(np.float64).tiny))
    distance = moved / size @ np.linalg.pinv(scatter / np.outer(size, size), hermitian=True) @ (moved / size)
    return moved if distance > SIGNIFICANT else np.zeros(10)


# How the plain estimate of a set-up answers to errors of its channels: to first order, in every step of Eqs. 6 to 11 and 8b.
#
# A channel that is off by dy changes motion and load by dU = T dy and dF = R dy, the dynamic mass by
#
#     dH = (dF - H dU) S_u^-1                                                       (from Eq. 10)
#
# and the ten parameters by the gain of the weighted fit. Errors of the measurement chain give dy = dA u; noise is independent
# from channel to channel, line to line and run to run.


def sensitivity(spectra: Spectra, found: Setup, chain: Chain) -> tuple[Array, Array]:
    """What errors of the channels do to the plain estimate `found` from `spectra`.

    Returns
    -------
    (10, p) d ten / d offset of each of the parameters of `chain`; (10, 10) the covariance that the noise of the channels gives
    """
    data = lines_of(found.estimate.dynamic_mass, found.noise, CHAIN_ERROR, None)
    chosen = kept(data)
    gain = _gain(found, data.at(chosen).frequency, data.at(chosen).deviation)
    thin = spectra.at(chosen)
    H = model.dynamic_mass(Inertia(parameters=found.ten).mass_matrix, found.terms, thin.frequency)
    inverse_motion = np.asarray(np.linalg.pinv(found.motion[:, chosen].transpose(1, 2, 0)), dtype=np.complex128)  # (n, r, 6)
    offsets = np.zeros(len(chain.parameters))
    left = _left_of_each(thin, H)
    every = chain.derivatives(offsets, thin.frequency, H)
    changed = np.zeros((*thin.values.shape[:2], len(thin.table), len(every)), dtype=np.complex128)  # (r, n, c, p)
    for k, change in enumerate(every):
        columns = [chain.columns[channel] for channel in change.channels]
        changed[:, :, columns, k] = (change.rows @ found.motion[:, chosen, :, None])[..., 0]
    # dH (p, n, 6, 6) of all of them at once
    by_run = (left.transpose(1, 2, 3, 0) @ changed).transpose(3, 1, 2, 0)  # (p, n, 6, r)
    sensed = (gain.reshape(10, -1) @ (by_run @ inverse_motion).reshape(len(every), -1).T).real
    return sensed, _noise(thin, left, inverse_motion, gain)


def _gain(found: Setup, frequency: Array, deviation: Array) -> ComplexArray:
    """(10, n, 6, 6) complex: d ten = Re sum gain * dH of the weighted fit at its end."""
    layout = found.fitted.layout
    dH = model.upper_derivatives(found.terms, frequency, layout)
    J = (dH * np.sqrt(2) / deviation).reshape(len(dH), -1)
    covariance = inverse((J @ J.conj().T).real)
    scale = model.pack(np.ones(10), type(found.terms)(), model.ElasticLayout(modes=0))[:10]
    upper = (covariance[:10] @ (J.conj() * (np.sqrt(2) / deviation).ravel())).reshape(10, -1, 21) / scale[:, None, None]
    full = np.zeros((10, len(frequency), 6, 6), dtype=np.complex128)
    full[:, :, UPPER[0], UPPER[1]] += upper / 2  # the fit sees the mean of both halves
    full[:, :, UPPER[1], UPPER[0]] += upper / 2
    return full


def _left_of_each(spectra: Spectra, H: ComplexArray) -> ComplexArray:
    """(c, r, n, 6) dF - H dU of a unit error of every channel alone."""
    count, unit = len(spectra.table), np.zeros((len(spectra.table), *spectra.values.shape), dtype=np.complex128)
    for k, values in enumerate(unit):
        values[:, :, k] = 1.0
    stacked = replace(
        spectra,
        values=unit.reshape(-1, *spectra.values.shape[1:]),
        noise=np.concatenate([spectra.noise] * count),
        quality=np.concatenate([spectra.quality] * count),
        runs=spectra.runs * count,
        axes=spectra.axes * count,
    )
    dU, dF = base_motion(stacked).values, resultants(stacked).values
    return np.asarray(dF - (H @ dU[..., None])[..., 0]).reshape(count, -1, len(H), 6)


def _noise(spectra: Spectra, left: ComplexArray, inverse_motion: ComplexArray, gain: ComplexArray) -> Array:
    """(10, 10): unit errors of every channel, weighed by the variance of its noise at each line and run."""
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

    def less(self, fmd: "Difference") -> "Difference":
        """What is left without `fmd`; what is common to both of an error of the chain goes with it."""
        chain, parts = (np.zeros(10), np.zeros((10, 10)))
        return Difference(
            ten=self.ten - fmd.ten,
            raw=self.raw - fmd.raw,
            chain={k: self.chain.get(k, chain) - fmd.chain.get(k, chain) for k in {**self.chain, **fmd.chain}},
            parts={k: self.parts.get(k, parts) + fmd.parts.get(k, parts) for k in {**self.parts, **fmd.parts}},
        )


def plain(evidence: Evidence, settings: Settings = _DEFAULT, *, progress: Callable[[float], None] | None = None) -> Identified:
    """The article's ten parameters about F by Eqs. 6 to 11 and the modal terms of Eq. 8b, minus the FMD of the tares.

    Raises
    ------
    BadInput : as `identification.self_calibration.fit`.
    """
    groups, warnings = hardware_groups(evidence, settings)
    tell = progress or (lambda share: None)
    found = setup(evidence.article, settings)
    tell(0.4)
    whole = _of_setup(evidence.article, found, settings)
    tell(0.6)
    tares = [tare for tare, group in zip(evidence.tares, groups, strict=True) if group == 0]
    fmd = of_tares(tares, settings) if tares else None
    if (known := evidence.fmd) is not None and fmd is None:
        fmd = Difference(ten=known.inertia.parameters, raw=known.inertia.parameters, chain={}, parts={"tare": known.covariance})
    tell(1.0)
    said = [*warnings, *found.notes, *([WITHOUT_TARE] if fmd is None else []), *([FACTS_LEFT_OUT] if evidence.facts else [])]
    of = whole if fmd is None else whole.less(fmd)
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
    sensed, noise = sensitivity(spectra, found, of)
    # The floor of the fit stands for errors of the chain, which count on their own; the misfit says what it really is.
    elastic = found.fitted.covariance * min(found.fitted.misfit, 1.0)
    if settings.modes == 0:
        moved = drift(found.estimate.dynamic_mass, CHAIN_ERROR)
        elastic = np.outer(moved, moved)
    return Difference(
        ten=found.ten,
        raw=found.raw,
        chain={one.name: column for one, column in zip(of.parameters, sensed.T, strict=True)},
        parts={"noise": noise, "elasticity": elastic},
    )
