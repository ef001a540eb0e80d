"""What is missing, as the page tells it: the verdict, and causes as bars of evidence with the intervals of their sizes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from validation.app.bench import Bench
from validation.app.trying import sized
from validation.desk import diagnosing
from validation.diagnosing import figures
from validation.plots.evidence import ACCEPTED, ALIKE, LESS, TOO_MUCH_LEFT, place

SHOWN = 12
"""Causes in the list."""


async def shown(bench: Bench) -> None:
    """Bring verdict and ranking to the diagnosis of the model as it stands, where it was made."""
    found = None if bench.desk is None else await bench.away(diagnosing.diagnosis, bench.desk)
    state = bench.state
    if found is None:
        state.verdict, state.ranking = None, []
        return
    state.verdict = {
        "headline": found["headline"],
        "text": found["text"],
        "next": found["next_measurement"] or "",
        "leftover": found["leftover"] or "",
        "detectable": [{"id": one["id"], "size": _size(one)} for one in found["detectable"] if one["size"] is not None],
    }
    state.ranking = _ranking(found)


def _ranking(found: Mapping[str, Any]) -> list[dict[str, Any]]:
    """What was accepted, then what was ranked last, then what earlier steps had ranked; each once, with the step it is from."""
    accepted = {one["id"] for one in found["accepted"]}
    first: dict[str, Mapping[str, Any]] = {}
    step_of: dict[str, int] = {}
    for one in (*found["accepted"], *found["ranking"]):
        first.setdefault(one["id"], one)
    for number, step in enumerate(found["steps"], start=1):
        for one in step["ranking"]:
            if one["id"] not in first:
                first[one["id"]], step_of[one["id"]] = one, number
    order = list(first.values())[:SHOWN]
    nats = np.array([one["evidence_nats"] if one["evidence_nats"] is not None else np.inf for one in order], dtype=float)
    finite = place(np.minimum(nats, 1e9))
    most = max(float(finite.max(initial=0.0)), 1e-9)
    causes = [_cause(one, found, accepted, 100 * max(at, 0.0) / most) for one, at in zip(order, finite, strict=True)]
    return [one | {"step": step_of.get(one["id"])} for one in causes]


def _cause(one: Mapping[str, Any], found: Mapping[str, Any], accepted: set[str], share: float) -> dict[str, Any]:
    family, nats = one["id"].partition(":")[0], one["evidence_nats"]
    sizes = [sized(family, each["key"], each["unit"], each["value"], *each["interval90"]) for each in one["values"]]
    standing, tone = _standing(one, found, accepted)
    return {
        "id": one["id"],
        "written": one["written"],
        "standing": standing,
        "tone": tone,
        "size": "; ".join(sizes),
        "nats": "more than can be counted" if nats is None else f"{nats:+.1f}",
        "share": round(share, 1),
        "interval": _interval(one),
    }


def _standing(one: Mapping[str, Any], found: Mapping[str, Any], accepted: set[str]) -> tuple[str, str]:
    alike = one["id"] in found["equivalence_class"] and len(found["equivalence_class"]) > 1
    if one["id"] in accepted:
        return (ACCEPTED + (", as one of several that the data cannot tell apart" if alike else "")), "doubt" if alike else "good"
    if alike:
        return ALIKE, "doubt"
    return (LESS, "faint") if one["as_where_nothing_is_missing"] else (TOO_MUCH_LEFT, "bad")


def _interval(one: Mapping[str, Any]) -> dict[str, Any] | None:
    """Where the 90 % interval of its first size lies on a line that holds no effect, too: in per cent, and in words."""
    if not one["values"]:
        return None
    low, high = one["values"][0]["interval90"]
    if low == high:
        return None
    left, right = min(low, 0.0), max(high, 0.0)
    room = 0.06 * (right - left)
    left, width = left - room, right - left + 2 * room
    return {
        "left": round(100 * (low - left) / width, 2),
        "width": round(100 * (high - low) / width, 2),
        "zero": round(100 * (0.0 - left) / width, 2),
        "words": "holds 0" if low <= 0.0 <= high else "clear of 0",
    }


def _size(one: Mapping[str, Any]) -> str:
    return figures.one(one["id"].partition(":")[0], "", one["unit"], one["size"])
