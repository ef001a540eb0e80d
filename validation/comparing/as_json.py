"""What `massline compare --json` prints: the contract's keys, and more beside them. Keys end in their unit."""

from __future__ import annotations

from typing import Any

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import MOTIONS
from geometry.observability import LOADS
from validation.comparing.comparison import Beside, Comparison, worst_pairs
from validation.comparing.maps import Map
from validation.comparing.modes import NamedMode
from validation.comparing.spots import Spot
from validation.comparing.verdicts import Told, Tolerance, expected_z2, misfit
from validation.comparing.words import text
from validation.engine.evaluation import Fit, Share
from validation.output import plain_unit

PAIRS = 10


def as_json(found: Comparison) -> dict[str, Any]:
    """The comparison as one object."""
    of = found.evaluation
    return {
        "model": found.source,
        "title": found.title,
        "effects": list(found.effects),
        "plain_error_percent": of.plain.percent,
        "fitted_chi2_per_dof": misfit(of.fitted),
        "tolerance_z2": of.fitted.tolerance_z2,
        "worst": [_spot(one, len(found.maps)) for one in found.worst],
        "nominal_error_percent": of.nominal.percent,
        "held_out_error_percent": _percent(of.held_out),
        "held_out_nominal_error_percent": _percent(of.held_out_nominal),
        "held_out_configurations_error_percent": _percent(of.held_out_configurations),
        "held_out_configurations_nominal_error_percent": _percent(of.held_out_configurations_nominal),
        "held_out": list(of.held_out_names),
        "explained_error_percent": found.explained.measurement,
        "explained_error_with_modes_percent": found.explained.with_modes,
        "tolerances": of.fitted.tolerances,
        "tolerance_z2_expected": expected_z2(of.fitted),
        "evidence_nats": of.fitted.log_evidence,
        "converged": of.plain_fit.converged and of.fitted.converged,
        "errors": [_told(one) for one in found.errors],
        "error_percent": {"nominal": _share(of.nominal), "plain": _share(of.plain), "held_out": _share(of.held_out)},
        "absurd_tolerances": [_tolerance(one) for one in found.absurd],
        "parameters": {"plain": parameters(of.plain_fit), "fitted": parameters(of.fitted)},
        "worst_pairs": [
            {
                "campaign": one.data_set,
                "load": LOADS[one.load],
                "motion": MOTIONS[one.motion],
                "frequency_hz": one.frequency,
                "sigma": one.sigma,
                "percent": one.percent,
            }
            for one in worst_pairs(found.maps, PAIRS)
        ],
        "maps": [_map(one, modes) for one, modes in zip(found.maps, found.modes, strict=True)],
        "classical": [_fact(one) for one in found.facts],
        "warnings": list(found.remarks),
    }


def _spot(one: Spot, count: int) -> dict[str, Any]:
    return {
        "campaign": one.data_set,
        "run": one.run,
        "channel": one.row,
        "frequency_hz": one.frequency,
        "sigma": one.sigma,
        "text": text(one, count),
        "band_hz": list(one.band),
        "percent": one.percent,
        "follows": one.course or None,
        "also_in_channels": list(one.others),
        "also_in": [{"campaign": data_set, "run": run, "sigma": sigma} for data_set, run, sigma in one.elsewhere],
    }


def _told(one: Told) -> dict[str, Any]:
    return {"name": one.name, "figure": one.figure, "meaning": one.meaning, "verdict": one.verdict or None, "text": one.text}


def _percent(of: Share | None) -> float | None:
    return None if of is None else of.percent


def _share(of: Share | None) -> dict[str, Any] | None:
    if of is None:
        return None
    return {
        "percent": of.percent,
        "by_channel": dict(of.by_channel),
        "by_run": dict(of.by_run),
        "by_campaign": dict(of.by_data_set),
        "by_what_was_held_out": dict(of.by_fold),
    }


def _tolerance(one: Tolerance) -> dict[str, Any]:
    return {"name": one.parameter.name, "z": one.z, "offset_si": one.offset, "tolerance_si": one.parameter.tolerance}


def parameters(of: Fit) -> dict[str, Any]:
    """Every parameter of a fit by its name."""
    sd = np.sqrt(np.maximum(np.diag(of.covariance), 0.0))
    return {
        one.name: {"value_si": one.value(float(x)), "offset": float(x), "sd": float(s), "kind": one.kind}
        for one, x, s in zip(of.parameters, of.offsets, sd, strict=True)
    }


def _map(of: Map, modes: tuple[NamedMode, ...]) -> dict[str, Any]:
    """A map without its lines: every row's peak in every run. The pictures show the rest."""
    sigma = of.sigma
    return {
        "campaign": of.data_set,
        "article": of.configuration,
        "runs": list(of.runs),
        "channels": list(of.rows),
        "frequency_band_hz": [float(of.frequency[0]), float(of.frequency[-1])],
        "peak_sigma": sigma.max(axis=1).tolist(),
        "peak_frequency_hz": of.frequency[sigma.argmax(axis=1)].tolist(),
        "rms_sigma": np.sqrt(np.mean(sigma**2, axis=1)).tolist(),
        "chi2_per_dof_by_run": of.misfit.mean(axis=1).tolist(),
        "pairs_peak_sigma": None if of.pairs is None else _peak(of.pairs.sigma),
        "pairs_peak_percent": None if of.pairs is None else _peak(of.pairs.percent),
        "modes": [{"name": one.name, "frequency_hz": one.frequency, "damping_ratio": one.damping_ratio} for one in modes],
    }


def _peak(values: Array) -> Any:
    return values.max(axis=0).tolist()


def _fact(one: Beside) -> dict[str, Any]:
    return {
        "name": one.name,
        "sigma": one.sigma,
        "nominal_sigma": one.nominal_sigma,
        "unit": plain_unit(one.unit),
        "predicted": one.predicted,
        "measured": one.measured,
        "tolerance": one.tolerance,
    }
