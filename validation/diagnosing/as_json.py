"""What `massline diagnose --json` prints: the contract's keys, and every number beside them. Keys end in their unit."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Any

from validation.comparing.as_json import parameters
from validation.comparing.verdicts import expected_z2, largest_z, misfit
from validation.diagnosing import words
from validation.diagnosing.diagnosis import Advice, Cause, Detectable, Diagnosis, Leftover, Level, Size, Step
from validation.engine.evaluation import Evaluation, Fit, Share


def as_json(found: Diagnosis) -> dict[str, Any]:
    """The diagnosis as one object."""
    return {
        "verdict": found.verdict,
        "text": found.text or words.headline(found),
        "headline": words.headline(found),
        "accepted": [effect(one) for one in found.accepted],
        "ranking": [effect(one) for one in found.ranking],
        "equivalence_class": list(found.equivalence_class),
        "next_measurement": found.next_measurement,
        "advice": [advice(one) for one in found.advice],
        "leftover": None if found.leftover is None else found.leftover.text,
        "leftover_described": None if found.leftover is None else leftover(found.leftover),
        "errors": _errors(found.before, found.after),
        "detectable": [detectable(one) for one in found.detectable],
        "levels": [_level(one) for one in found.levels],
        "steps": [_step(one) for one in found.steps],
        "held_out": list(found.hold_out),
        "warnings": list(found.remarks),
        "before": _evaluation(found.before),
        "after": _evaluation(found.after),
        "settings": plain(found.settings),
    }


def effect(one: Cause) -> dict[str, Any]:
    """EFFECT of the output contract. Its value is that of the first size; `values` holds all."""
    first = one.sizes[0] if one.sizes else None
    return {
        "id": one.id,
        "value": None if first is None else first.value,
        "unit": None if first is None else first.unit,
        "interval90": None if first is None else [first.low, first.high],
        "evidence_nats": finite(one.evidence),
        "text": one.text,
        "written": str(one.named),
        "what": one.named.what,
        "values": [_size(size) for size in one.sizes],
        "chi2_per_dof": finite(one.misfit),
        "price": finite(one.price),
        "as_where_nothing_is_missing": one.null,
        "note": one.note or None,
        "mistaken_for": list(one.mistaken_for),
        "confirmed_by": one.confirmed_by,
    }


def plain(value: Any) -> Any:
    """`value` as JSON has it: mappings and sequences of texts, numbers, truths and nothing; what else there is by its words."""
    if isinstance(value, Mapping):
        return {str(key): plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [plain(one) for one in value]
    if value is None or isinstance(value, bool | str):
        return value
    if hasattr(value, "__index__"):
        return int(value)
    return finite(float(value)) if hasattr(value, "__float__") else str(value)


def finite(value: float) -> float | None:
    """JSON knows no infinity."""
    return float(value) if isfinite(value) else None


def _size(one: Size) -> dict[str, Any]:
    return {"key": one.key, "value": one.value, "unit": one.unit, "interval90": [one.low, one.high]}


def advice(one: Advice) -> dict[str, Any]:
    """A measurement that would decide."""
    return {
        "test": one.test,
        "expected_evidence_nats": finite(one.gain),
        "separates": list(one.separates),
        "hours": one.hours or None,
    }


def leftover(one: Leftover) -> dict[str, Any]:
    """What no effect explains."""
    return {
        "text": one.text,
        "looks_like": one.looks_like,
        "load": one.load or None,
        "motion": one.motion or None,
        "channels": list(one.channels),
        "frequency_hz": one.frequency,
        "share": one.share,
        "size": one.size,
        "unit": one.unit or None,
    }


def detectable(one: Detectable) -> dict[str, Any]:
    """The smallest size that would have been named."""
    return {"id": one.id, "size": finite(one.size), "unit": one.unit, "at": one.at or None}


def _level(one: Level) -> dict[str, Any]:
    return {
        "campaign": one.data_set,
        "runs": list(one.runs),
        "axis": one.axis,
        "channels": list(one.channels),
        "frequency_hz": one.frequency,
        "sigma": one.sigma,
    }


def _step(one: Step) -> dict[str, Any]:
    return {
        "added": one.added or None,
        "text": one.text,
        "chi2_per_dof": finite(one.misfit),
        "price": finite(one.price),
        "ranking": [effect(cause) for cause in one.ranking],
    }


def _errors(before: Evaluation, after: Evaluation) -> dict[str, Any]:
    """The contract's four, and the others beside them."""
    found: dict[str, Any] = {}
    for when, of in (("before", before), ("after", after)):
        found |= {
            f"plain_{when}_percent": of.plain.percent,
            f"heldout_{when}_percent": _percent(of.held_out),
            f"nominal_{when}_percent": of.nominal.percent,
            f"heldout_nominal_{when}_percent": _percent(of.held_out_nominal),
            f"heldout_configurations_{when}_percent": _percent(of.held_out_configurations),
        }
    return found


def _evaluation(of: Evaluation) -> dict[str, Any]:
    return {
        "plain_percent_by_channel": dict(of.plain.by_channel),
        "plain_percent_by_run": dict(of.plain.by_run),
        "heldout_percent_by_fold": {} if of.held_out is None else dict(of.held_out.by_fold),
        "held_out": list(of.held_out_names),
        "fitted": _fit(of.fitted),
        "plain": _fit(of.plain_fit),
    }


def _fit(of: Fit) -> dict[str, Any]:
    return {
        "chi2": finite(of.chi2),
        "degrees_of_freedom": of.degrees_of_freedom,
        "chi2_per_dof": finite(misfit(of)),
        "tolerance_z2": finite(of.tolerance_z2),
        "tolerance_z2_expected": expected_z2(of),
        "largest_z": largest_z(of),
        "tolerances": of.tolerances,
        "log_evidence_nats": finite(of.log_evidence),
        "converged": of.converged,
        "parameters": parameters(of),
    }


def _percent(of: Share | None) -> float | None:
    return None if of is None else of.percent
