"""What `massline identify --json` prints: the contract's keys, and more beside them. Keys end in their unit."""

from __future__ import annotations

from importlib.metadata import version
from math import isfinite
from typing import Any

from geometry.arrays import Array
from geometry.frames import Pose
from geometry.inertia import PARAMETERS
from identification.classical import QUANTITIES
from identification.elastic.terms import ElasticTerms
from identification.request import Request
from validation.campaigns.summary_json import check
from validation.identifying.findings import Findings, Lines, Study
from validation.identifying.reported import Reported
from validation.output import inertia_json

LIBRARIES = ("massline", "numpy", "scipy", "pin")
"""Whose versions stand in the settings."""


def as_json(found: Findings) -> dict[str, Any]:
    """The findings as one object."""
    best = found.result
    return {
        "article": found.article,
        "origin": found.origin,
        "frequency_band_hz": list(best.identified.band),
        "inertia": inertia_json(best.inertia),
        "interval95": _interval(best),
        "verdict": {name: found.verdict.get(name, "") for name in PARAMETERS},
        "doubts": list(found.doubts),
        "warnings": [*found.doubts, *found.warnings],
        "result": best.identified.way,
        **{one.identified.way.replace("-", "_"): _way(one) for one in found.results},
        "checks": [check(one) for one in found.checks],
        "cross_motion": [] if found.crossed is None else list(found.crossed.text),
        "lines": None if found.lines is None else _lines(found.lines),
        "study": None if found.study is None else _study(found.study),
        "frame": None if found.frame is None else _frame(found.frame),
        "settings": _settings(found.request),
    }


def _interval(one: Reported) -> dict[str, Any]:
    pairs = one.quality.intervals
    return {
        "mass_kg": pairs[0].tolist(),
        "cog_mm": (1e3 * pairs[1:4]).tolist(),
        "moi_cog_kgm2": pairs[4:7].tolist(),
        "poi_cog_kgm2": pairs[7:].tolist(),
    }


def _way(one: Reported) -> dict[str, Any]:
    found = one.identified
    return {
        "inertia": inertia_json(one.inertia),
        "interval95": _interval(one),
        "about_f": {
            "parameters": dict(zip(PARAMETERS, found.inertia.parameters.tolist(), strict=True)),
            "covariance": found.covariance.tolist(),
            "reference_point_m": found.inertia.reference_point.tolist(),
        },
        "shares_about_f": {name: dict(zip(PARAMETERS, share.tolist(), strict=True)) for name, share in found.shares.items()},
        "shares": {name: dict(zip(QUANTITIES, share.tolist(), strict=True)) for name, share in one.quality.shares.items()},
        "narrowed_by": {name: dict(zip(PARAMETERS, times.tolist(), strict=True)) for name, times in found.gained.items()},
        "bootstrap_sd_about_f": None if found.resampled is None else found.resampled.tolist(),
        "modes": 0 if found.elastic is None else len(found.elastic.frequency),
        "elastic": None if found.elastic is None else _elastic(found.elastic),
        "chi2_per_dof": found.misfit if isfinite(found.misfit) else None,
        "tolerance_z2": found.surprise,
        "tolerances": found.tolerances,
        "converged": found.converged,
        "warnings": list(found.warnings),
    }


def _elastic(terms: ElasticTerms) -> dict[str, Any]:
    return {
        "frequency_hz": terms.frequency.tolist(),
        "damping_ratio": terms.damping_ratio.tolist(),
        "damping_rad_s": terms.damping.tolist(),
        "participation": terms.participation.tolist(),
        "residual": terms.residual.tolist(),
    }


def _lines(lines: Lines) -> dict[str, Any]:
    return {
        "frequency_hz": lines.frequency.tolist(),
        "condition": lines.condition.tolist(),
        "condition_limit": lines.limit,
        "used": [bool(one) for one in lines.kept],
        "left_out": list(lines.reasons),
    }


def _study(study: Study) -> dict[str, Any]:
    return {
        "start_hz": study.start.tolist(),
        "stop_hz": study.stop.tolist(),
        "maps": {
            what: {
                "mass_kg": _nulled(values[..., 0]),
                "cog_mm": _nulled(1e3 * values[..., 1:4]),
                "moi_cog_kgm2": _nulled(values[..., 4:7]),
                "poi_cog_kgm2": _nulled(values[..., 7:]),
            }
            for what, values in study.maps.items()
        },
    }


def _frame(frame: Pose) -> dict[str, Any]:
    """As a result file states a frame, so that the result can be read again."""
    return {"origin": " ".join(f"{x:.15g}" for x in frame.position) + " m", "rotation": frame.rotation.tolist()}


def _nulled(values: Array) -> Any:
    """Nested lists with null for NaN, which is no JSON."""
    if values.ndim == 0:
        return float(values) if isfinite(float(values)) else None
    return [_nulled(one) for one in values]


def _settings(request: Request) -> dict[str, Any]:
    tolerances = request.tolerances
    return {
        "campaign": request.campaign.source,
        "campaign_article": request.campaign.article,
        "hardware": request.campaign.hardware,
        "tares": [
            {
                "campaign": tare.campaign.source,
                "campaign_article": tare.campaign.article,
                "hardware": tare.campaign.hardware,
                "known": None if tare.known is None else inertia_json(tare.known),
                "known_relative_sd": tare.relative_sd,
            }
            for tare in request.tares
        ],
        "facts": [
            {"quantity": fact.quantity, "value_si": fact.value, "sd_si": fact.sd, "source": fact.source} for fact in request.facts
        ],
        "band_hz": None if request.band is None else list(request.band),
        "spectra": request.method,
        "modes": "auto" if request.modes is None else request.modes,
        "condition_limit": request.condition_limit,
        "any_hardware": request.any_hardware,
        "robust": request.robust,
        "study": request.study,
        "tolerances_si": {name: getattr(tolerances, name) for name in tolerances.__dataclass_fields__},
        "fmd": None if request.fmd is None else inertia_json(request.fmd),
        "cell_stiffness_n_m": None if request.cell_stiffness is None else request.cell_stiffness.tolist(),
        "versions": {name: version(name) for name in LIBRARIES},
    }
