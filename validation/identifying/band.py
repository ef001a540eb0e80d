"""The band study of an identification: does the result know where its band begins and ends?"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import DynamicMass
from geometry.frames import Pose
from geometry.inertia import PARAMETERS, Inertia
from identification.classical import QUANTITIES
from identification.elastic.fit import fit
from identification.elastic.study import LIMIT, NARROWEST, BandStudy, study
from identification.identify import Identification
from identification.quality import half_widths
from identification.setup import CHAIN_ERROR
from validation.identifying.findings import Study
from validation.statement import about_cog

RIGID = "no elastic terms"

FITTED = 0.3
"""Share of the work that is done with the fit of the whole band."""


def studied(found: Identification, progress: Callable[[float], None]) -> BandStudy | None:
    """Every band and number of poles, on the lines that are used; with as many poles as were asked for, or as the data want.

    None where the lines that a rigid body was left with are too few to vary the band.
    """
    H = found.estimate.dynamic_mass
    kept = np.asarray(found.exclusions.kept, dtype=bool)
    used = DynamicMass(frequency=H.frequency[kept], matrix=H.matrix[kept], reference_point=H.reference_point)
    if found.request.band is None and used.frequency[-1] < NARROWEST * used.frequency[0]:
        return None
    whole = fit(used, modes=found.request.modes or None, floor=CHAIN_ERROR, progress=lambda share: progress(FITTED * share))
    return study(used, fitted=whole, floor=CHAIN_ERROR, progress=lambda share: progress(FITTED + (1 - FITTED) * share))


def maps(found: Identification, of: BandStudy, frame: Pose) -> Study:
    """The study as it is drawn: of the article in `frame`, seen from F, the FMD taken off as the plain way did."""
    parameters, rigid = of.map(), found.request.modes == 0
    whole = parameters[0, -1, 0] if rigid else of.fitted.parameters
    fmd = whole - found.plain.inertia.parameters
    drawn = {RIGID: _reported(parameters[:, :, 0] - fmd, frame)}
    spread = of.map("covariance")
    known = {RIGID: _half_widths(parameters[:, :, 0] - fmd, spread[:, :, 0], frame)}
    counts = [] if rigid else sorted(filter(None, of.counts), key=lambda count: abs(count - of.fitted.modes))
    for count in counts[:1]:
        elastic = parameters[:, :, of.counts.index(count)]
        what = f"{count} elastic terms"
        drawn = {what: _reported(elastic - fmd, frame), **drawn}
        known = {what: _half_widths(elastic - fmd, spread[:, :, of.counts.index(count)], frame), **known}
    return Study(start=of.starts, stop=of.stops, maps=drawn, half_widths=known, chosen=of.fitted.band)


def _reported(parameters: Array, frame: Pose) -> Array:
    """(a, b, 10) as a statement has them; NaN where there is no fit, or none with a positive mass."""
    values = np.full(parameters.shape, np.nan)
    for at in np.argwhere(parameters[..., 0] > 0):
        values[tuple(at)] = about_cog(Inertia(parameters=parameters[tuple(at)]).placed(frame.inverse))
    return values


def _half_widths(parameters: Array, covariance: Array, frame: Pose) -> Array:
    """(a, b, 10) of the 95 % intervals of `_reported`, from noise and model error alone; NaN where there is no result."""
    values = np.full(parameters.shape, np.nan)
    for at in np.argwhere(parameters[..., 0] > 0):
        here = parameters[tuple(at)]
        values[tuple(at)] = half_widths(Inertia(parameters=here), covariance[tuple(at)], frame)
    return values


def verdicts(told: Mapping[str, str], of: BandStudy, *, rigid: bool) -> dict[str, str]:
    """The verdicts `told` of a result; where fits of the plain way over narrower bands lead elsewhere, they say so."""
    shares = of.spread(rigid=rigid) / of.scale
    moved = {name: float(share) for names in (PARAMETERS, QUANTITIES) for name, share in zip(names, shares, strict=True)}
    return {name: f"{said}; {_moved(moved[name])}" if moved[name] > LIMIT else said for name, said in told.items()}


def _moved(share: float) -> str:
    return f"plain fits over narrower bands and with other numbers of terms move it by {100 * share:.2g} % of that size"
