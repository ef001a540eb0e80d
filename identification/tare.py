"""The FMD from campaigns on known articles, with its covariance, to be carried into later results."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from geometry.errors import BadInput
from geometry.inertia import Inertia
from identification.evidence import Known, Settings, TareSpectra
from identification.plain import covariance_of, of_tares, tolerances_of
from identification.self_calibration.assembly import of_fmd
from identification.self_calibration.calibrated import fitted
from identification.self_calibration.result import identified

_DEFAULT = Settings()


def fmd(
    tares: Sequence[TareSpectra],
    settings: Settings = _DEFAULT,
    *,
    self_calibrated: bool = True,
    progress: Callable[[float], None] | None = None,
) -> Known:
    """The FMD's ten parameters about F from `tares`, self-calibrated or by Eqs. 6 to 11, with their covariance.

    Raises
    ------
    BadInput : no tare, or tares of different hardware.
    """
    if not tares:
        raise BadInput(source="tare", field="tares", problem="the FMD needs a campaign on a known article", remedy="Add one")
    _require_one_hardware(tares)
    if not self_calibrated:
        by_paper = of_tares(list(tares), settings)
        covariance = covariance_of(by_paper, tolerances_of(tares[0].spectra, settings))
        return Known(inertia=Inertia(parameters=by_paper.ten), covariance=covariance)
    problem = of_fmd(tares, settings)
    found = identified(problem, fitted(problem, settings, progress=progress), settings)
    return Known(inertia=found.inertia, covariance=found.covariance)


def _require_one_hardware(tares: Sequence[TareSpectra]) -> None:
    stated = sorted({tare.hardware for tare in tares if tare.hardware})
    if len(stated) > 1:
        raise BadInput(
            source="tare",
            field="campaign.hardware",
            problem=f"one FMD is asked for, found campaigns of {', '.join(stated)}",
            remedy="Give those of one hardware",
        )
