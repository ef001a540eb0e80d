"""The paper's way, whole: base motion, resultants, dynamic mass (Eqs. 6 to 11), ten parameters, tare taken off.

Its interval is honest, too: noise *and* every tolerance of the measurement chain are propagated through the same estimator. An
error of the chain acts on article and tare alike; what it does to their difference is what is left of it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.inertia import Inertia
from identification.drift import drift
from identification.evidence import Evidence, Known, Settings, TareSpectra
from identification.identified import Identified
from identification.measurement_chain import chain
from identification.self_calibration import hardware
from identification.self_calibration.assembly import WITHOUT_TARE
from identification.sensitivity import Sensitivity, sensitivity
from identification.setup import CHAIN_ERROR, Setup, setup
from identification.spectra.line_spectra import Spectra

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
    BadInput : as `identification.self_calibration.calibrated`.
    """
    groups, warnings = hardware.groups(evidence, settings)
    tell = progress or (lambda share: None)
    found = setup(evidence.article, settings)
    tell(0.4)
    whole = _of_setup(evidence.article, found, settings)
    tell(0.6)
    tares = [tare for tare, group in zip(evidence.tares, groups, strict=True) if group == 0]
    fmd = of_tares(tares, settings) if tares else _known(evidence.fmd)
    tell(1.0)
    said = [*warnings, *found.notes, *([WITHOUT_TARE] if fmd is None else []), *([FACTS_LEFT_OUT] if evidence.facts else [])]
    return _identified(whole if fmd is None else _less(whole, fmd), found, evidence.article, settings, tuple(said))


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


def _identified(of: Difference, found: Setup, spectra: Spectra, settings: Settings, warnings: tuple[str, ...]) -> Identified:
    tolerances = tolerances_of(spectra, settings)
    parts = dict(of.parts)
    for name, row in of.chain.items():
        family = name.partition(":")[0]
        parts[family] = parts.get(family, np.zeros((10, 10))) + np.outer(row, row) * tolerances[name] ** 2
    covariance = covariance_of(of, tolerances)
    whole = np.maximum(np.diag(covariance), np.finfo(np.float64).tiny)
    kept = {name: part for name, part in parts.items() if np.any(np.diag(part) > 0)}
    return Identified(
        way="plain",
        inertia=Inertia(parameters=of.ten),
        covariance=covariance,
        band=found.fitted.band,
        elastic=found.terms if settings.modes != 0 else None,
        shares={name: np.diag(part) / whole for name, part in kept.items()},
        parts=kept,
        misfit=found.fitted.misfit,
        converged=found.fitted.converged,
        raw=of.raw,
        warnings=warnings,
    )
