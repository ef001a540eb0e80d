"""What is kept of a diagnosis: all that a score needs, as JSON values."""

from __future__ import annotations

from benchmarks.blind.names import Json
from validation.diagnosing.diagnosis import Cause, Diagnosis
from validation.engine.evaluation import Evaluation

TRIED = 12
"""Causes of a ranking that are kept."""


def stated(found: Diagnosis) -> Json:
    """`found` as JSON values."""
    return {
        "verdict": found.verdict,
        "text": found.text,
        "accepted": [_cause(one) for one in found.accepted],
        "ranking": [_cause(one) for one in found.ranking[:TRIED]],
        "equivalence_class": list(found.equivalence_class),
        "next_measurement": found.next_measurement,
        "leftover": None if found.leftover is None else found.leftover.text,
        "detectable": {f"{one.id} {one.at}".strip(): one.size for one in found.detectable},
        "before": _errors(found.before),
        "after": _errors(found.after),
        "steps": [{"added": one.added, "misfit": one.misfit, "price": one.price, "text": one.text} for one in found.steps],
        "remarks": list(found.remarks),
    }


def _cause(one: Cause) -> Json:
    return {
        "id": one.id,
        "evidence_nats": one.evidence,
        "misfit": one.misfit,
        "price": one.price,
        "null": one.null,
        "sizes": [{"key": size.key, "value": size.value, "low": size.low, "high": size.high} for size in one.sizes],
    }


def _errors(of: Evaluation) -> Json:
    return {
        "plain_percent": of.plain.percent,
        "held_out_percent": None if of.held_out is None else of.held_out.percent,
        "misfit": of.fitted.chi2 / of.fitted.degrees_of_freedom,
        "tolerance_z2": of.fitted.tolerance_z2,
        "tolerances": of.fitted.tolerances,
    }
