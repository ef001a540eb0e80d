"""What `massline add`, `massline ladder` and `massline undo` print with ``--json``; keys end in their unit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from identification.quality import NORMAL_90
from validation.ladders import file
from validation.ladders.climbing import Standing
from validation.ladders.nouns import Body, Errors, Rung, Size
from validation.ladders.verdict import worth


def of_ladder(at: Standing) -> dict[str, Any]:
    """The ladder and where its model stands; null where that was edited by hand."""
    return {
        "model": str(at.path),
        "ladder": str(file.beside(at.path)),
        "current": None if at.rung is None else at.rung.number,
        "edited": at.edited,
        "rungs": [of_rung(one) for one in at.ladder.rungs],
    }


def of_rung(one: Rung) -> dict[str, Any]:
    """A rung without its model and its tolerances, which the ladder's file holds."""
    return {
        "number": one.number,
        "parent": one.parent,
        "cause": one.cause,
        "effect": one.effect or None,
        "effects": [effect(one, name) for name in one.effects],
        "errors": None if one.errors is None else file.errors_json(one.errors),
        "evidence_gain_nats": file.finite(one.gain),
        "inertia": [_body(body) for body in one.bodies],
        "verdict": list(one.verdict),
        "worth_a_parameter": worth(one) if one.effect else None,
        "data": [source.path for source in one.conditions.data],
        "when": one.when,
    }


def of_step(at: Standing, before: Rung, after: Rung, said: Sequence[str]) -> dict[str, Any]:
    """What adding an effect did; `said` is what was warned of."""
    return {
        "model": str(at.path),
        "ladder": str(file.beside(at.path)),
        "rung": after.number,
        "parent": before.number,
        "effect": effect(after, after.effect),
        "errors": _both(before.errors, after.errors),
        "evidence_gain_nats": file.finite(after.gain),
        "verdict": list(after.verdict),
        "worth_a_parameter": worth(after),
        "before": of_rung(before),
        "after": of_rung(after),
        "warnings": list(said),
    }


def effect(one: Rung, name: str) -> dict[str, Any]:
    """EFFECT of the output contract; of an effect with several sizes `values` holds them, and `value` is null."""
    sizes = one.effects.get(name, ())
    alone = sizes[0] if len(sizes) == 1 else None
    return {
        "id": name,
        "value": None if alone is None else alone.value,
        "unit": None if alone is None else alone.unit,
        "interval90": None if alone is None else _interval(alone),
        "evidence_nats": file.finite(one.gain) if name == one.effect else None,
        "text": " ".join(one.verdict) if name == one.effect else "",
        "values": {size.key: {"value": size.value, "unit": size.unit, "interval90": _interval(size)} for size in sizes},
    }


def _interval(size: Size) -> list[float] | None:
    if size.deviation is None:
        return None
    half = NORMAL_90 * size.deviation
    return [size.value - half, size.value + half]


def _both(before: Errors | None, after: Errors | None) -> dict[str, Any]:
    return {
        "plain_before_percent": None if before is None else before.plain,
        "plain_after_percent": None if after is None else after.plain,
        "heldout_before_percent": None if before is None else before.held_out,
        "heldout_after_percent": None if after is None else after.held_out,
    }


def _body(body: Body) -> dict[str, Any]:
    return {
        "article": body.article,
        "identified": file.ten_json(body.values),
        "half_width95": file.ten_json(body.half_width),
        "reference": file.ten_json(body.reference),
        "distance": {"cog_mm": body.shown[1:4].tolist(), "percent": body.shown[[0, *range(4, 10)]].tolist()},
        "sigma": body.sigmas.tolist(),
        "converged": body.converged,
    }
