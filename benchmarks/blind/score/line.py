"""One case of a development draw in one line: truth, verdict, ranking, misfit, price, time."""

from __future__ import annotations

from benchmarks.blind.names import Json

SHOWN = 4
"""Causes of a ranking that are shown."""


def line(truth: Json, answer: Json) -> str:
    """What was planted, and what was said."""
    planted = " + ".join(_effect(one["id"], one["sizes"]) for one in truth["planted"]) or "nothing"
    return f"{truth['name']} [{planted}] {_said(answer)}"


def _said(answer: Json) -> str:
    if "verdict" not in answer:
        return " ".join(str(answer.get("refused") or answer.get("broken", "")).split())[-300:]
    claimed = ", ".join(_claim(one) for one in answer["accepted"]) or "-"
    alike = ", ".join(answer["equivalence_class"]) or "-"
    tried = ", ".join(f"{one['id']} {_nats(one)}" for one in answer["ranking"][:SHOWN]) or "-"
    seconds = answer["seconds"]["diagnosis"]
    return f"{answer['verdict'].upper()} {claimed} | class {alike} | tried {tried} | {_fits(answer)} | {seconds:.1f} s"


def _fits(answer: Json) -> str:
    before, after = (answer[when]["fitted"] for when in ("before", "after"))
    misfit = f"misfit {before['chi2_per_dof']:.3f} -> {after['chi2_per_dof']:.3f}"
    return f"{misfit}, z2 {before['tolerance_z2']:.0f} -> {after['tolerance_z2']:.0f} of {after['tolerances']}"


def _claim(one: Json) -> str:
    return f"{one['id']}={','.join(_size(size) for size in one['values'])} ({_nats(one)} nats)"


def _size(size: Json) -> str:
    key = f"{size['key']}:" if size["key"] else ""
    return f"{key}{size['value']:.3g} {_interval(*size['interval90'])}"


def _nats(one: Json) -> str:
    return "-" if one["evidence_nats"] is None else f"{one['evidence_nats']:.3g}"


def _interval(low: float, high: float) -> str:
    return f"[{low:.3g}, {high:.3g}]"


def _effect(id: str, sizes: dict[str, float]) -> str:
    written = ",".join(f"{key}{':' if key else ''}{value:.3g}" for key, value in sizes.items())
    return f"{id}={written}" if written else id
