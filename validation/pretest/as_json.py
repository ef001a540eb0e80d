"""What `massline pretest --json` prints; keys end in their unit."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from geometry.arrays import Array
from identification.classical import QUANTITIES
from validation.identifying.reported import Reported
from validation.output import inertia_json
from validation.pretest.findings import Findings


def as_json(found: Findings) -> dict[str, Any]:
    """The findings as one object."""
    question, plan = found.question, found.question.plan
    return {
        "article": plan.article,
        "tare": None if question.tare is None else question.tare.article,
        "origin": "article",
        "runs": list(found.spectra.runs),
        "frequency_hz": found.spectra.frequency.tolist(),
        "condition": found.condition.tolist(),
        "condition_limit": question.condition_limit,
        "lines_left_out": int(np.sum(found.left_out)),
        "inertia": inertia_json(found.best.inertia),
        "self_calibrated": _way(found.best),
        "plain": _way(found.plain),
        "without_tare": None if found.untared is None else {"half_width95": _half(found.untared)},
        "without": {name: {"half_width95": _half(half), "plain_loses": found.lost[name]} for name, half in found.without.items()},
        "rigid_share": question.rigid,
        "rigid_height_m": found.rigid_height,
        "places": [
            {
                "name": one.name,
                "position_m": one.position.tolist(),
                "elastic_share_at_start": one.at_start,
                "elastic_share": one.largest,
                "axis": one.axis,
                "frequency_hz": one.frequency,
                "rigid_up_to_hz": one.up_to,
                "share_of_lines": one.within,
            }
            for one in found.places
        ],
        "tolerances": asdict(question.tolerances),
        "warnings": list(found.warnings),
    }


def _way(one: Reported) -> dict[str, Any]:
    shares = one.quality.shares
    return {
        "half_width95": _half(one.half_width),
        "shares": {name: dict(zip(QUANTITIES, share.tolist(), strict=True)) for name, share in shares.items()},
        "verdict": {name: one.quality.verdict[name] for name in QUANTITIES},
    }


def _half(half: Array) -> dict[str, Any]:
    return {
        "mass_kg": float(half[0]),
        "cog_mm": (1e3 * half[1:4]).tolist(),
        "moi_cog_kgm2": half[4:7].tolist(),
        "poi_cog_kgm2": half[7:].tolist(),
    }
