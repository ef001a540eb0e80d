"""What `massline diagnose --json` prints where there is no campaign: the contract's keys, and every number beside them."""

from __future__ import annotations

from typing import Any

from validation.diagnosing.classical.nouns import Beside, Needed, Reading, SwingAnswer
from validation.diagnosing.diagnosis import Cause


def as_json(found: SwingAnswer) -> dict[str, Any]:
    """The answer as one object. There are no spectra, and so no errors of them."""
    return {
        "verdict": found.verdict,
        "text": found.text,
        "accepted": [_effect(one) for one in found.accepted],
        "ranking": [_effect(one) for one in found.ranking],
        "equivalence_class": list(found.equivalence_class),
        "next_measurement": found.next_measurement,
        "leftover": None if found.leftover is None else found.leftover.text,
        "errors": None,
        "model": found.source,
        "chi2": found.chi2,
        "measurements": found.measurements,
        "classical": [_beside(one) for one in found.facts],
        "needed": [_needed(one) for one in found.needed],
        "readings": [_reading(one) for one in found.readings],
        "advice": [
            {"test": one.test, "expected_evidence_nats": one.gain, "separates": list(one.separates)} for one in found.advice
        ],
        "detectable": [{"id": one.id, "size": one.size, "unit": one.unit, "at": one.at or None} for one in found.detectable],
        "warnings": list(found.remarks),
        "settings": dict(found.settings),
    }


def _effect(one: Cause) -> dict[str, Any]:
    """EFFECT of the output contract."""
    (size,) = one.sizes
    return {
        "id": one.id,
        "value": size.value,
        "unit": size.unit,
        "interval90": [size.low, size.high],
        "evidence_nats": one.evidence,
        "text": one.text,
        "chi2_per_dof": one.misfit,
        "as_where_nothing_is_missing": one.null,
        "mistaken_for": list(one.mistaken_for),
        "confirmed_by": one.confirmed_by,
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
