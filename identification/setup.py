"""The whole set-up of one campaign - FMD and what stands on it - by the paper's equations: the plain way, the start of fits.

Base motion and resultants (Eqs. 2, 3, 6, 7), dynamic mass (Eqs. 9 to 11), then ten parameters and the modal terms of Eq. 8b, its
entries weighed by the noise of the channels where that is known. Where noise of the motions would make least squares of many
runs too small, they are corrected for it. Beside this the ten follow from the raw spectra, which hide nothing in an H.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from geometry.dynamic_mass import ComplexArray
from geometry.errors import CheckFailed
from geometry.frames import Array
from identification import rigid_body
from identification.base_motion import RunNoise, base_motion
from identification.dynamic_mass import Estimate, bias, corrected, covariance, deviation, from_runs
from identification.elastic.fit import Fitted, fit, levels
from identification.elastic.model import ElasticTerms
from identification.request import Settings
from identification.resultants import resultants
from identification.spectra.line_spectra import Spectra

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
    moved, loaded = base_motion(spectra, gravity=settings.gravity), resultants(spectra)
    motion, load = moved.values, loaded.values
    known = np.all(np.isfinite(spectra.noise)) and np.all(spectra.noise > 0)
    noise = RunNoise(load=loaded.covariance, motion=moved.covariance) if known else None
    estimate = from_runs(load, motion, spectra.frequency, spectra.table.origin)
    spread = None if noise is None else deviation(covariance(estimate, noise))
    estimate, notes = _unbiased(estimate, motion, load, noise)
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


def _unbiased(
    estimate: Estimate, motion: ComplexArray, load: ComplexArray, noise: RunNoise | None
) -> tuple[Estimate, tuple[str, ...]]:
    """The estimate by errors in variables where noise of the motions matters, and what is to be said of it."""
    expected = 0.0 if noise is None else float(bias(estimate, noise).max())
    if noise is None or expected <= BIAS * CHAIN_ERROR:
        return estimate, ()
    low = f"noise of the accelerometers makes least squares of H up to {100 * expected:.2g} % too low"
    try:
        mass, _ = corrected(load, motion, noise, estimate)
    except CheckFailed:
        return estimate, (f"{low}; the correction does not settle and is left out",)
    return replace(estimate, dynamic_mass=mass), (f"{low}; corrected as errors in variables",)
