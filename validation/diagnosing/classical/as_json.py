"""What `massline diagnose --json` prints where there is no campaign: the contract's keys, and every number beside them."""

from __future__ import annotations

from typing import Any

from validation.diagnosing.as_json import advice, detectable, effect, leftover
from validation.diagnosing.classical.nouns import Beside, Needed, Reading, SwingAnswer


def as_json(found: SwingAnswer) -> dict[str, Any]:
    """The answer as one object. There are no spectra, and so no errors of them."""
    return {
        "verdict": found.verdict,
        "text": found.text,
        "accepted": [effect(one) for one in found.accepted],
        "ranking": [effect(one) for one in found.ranking],
        "equivalence_class": list(found.equivalence_class),
        "next_measurement": found.next_measurement,
        "advice": [advice(one) for one in found.advice],
        "leftover": None if found.leftover is None else found.leftover.text,
        "leftover_described": None if found.leftover is None else leftover(found.leftover),
        "errors": None,
        "detectable": [detectable(one) for one in found.detectable],
        "chi2": found.chi2,
        "measurements": found.measurements,
        "classical": [_beside(one) for one in found.facts],
        "needed": [_needed(one) for one in found.needed],
        "readings": [_reading(one) for one in found.readings],
        "warnings": list(found.remarks),
        "settings": dict(found.settings),
    }


def _beside(one: Beside) -> dict[str, Any]:
    return {
        "name": one.name,
        "sigma": one.sigma,
        "unit": one.unit,
        "predicted": one.predicted,
        "measured": one.measured,
        "tolerance": one.deviation,
        "period_s": one.period or None,
        "period_shift_percent": 100 * one.period_shift if one.period else None,
    }


def _needed(one: Needed) -> dict[str, Any]:
    return {
        "id": one.id,
        "value": one.value,
        "unit": one.unit,
        "plausible": one.plausible,
        "possible": one.possible,
        "explains": one.fits,
        "evidence_nats": one.evidence,
        "text": one.text,
    }


def _reading(one: Reading) -> dict[str, Any]:
    return {
        "input": one.name,
        "value_si": one.value,
        "change_si": one.change,
        "tolerances": one.tolerances,
        "of": list(one.of),
    }
