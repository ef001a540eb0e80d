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
    tried = ", ".join(f"{one['id']} {one['evidence_nats']:.3g}" for one in answer["ranking"][:SHOWN])
    before, after = answer["before"], answer["after"]
    return (
        f"{answer['verdict'].upper()} {claimed} | class {', '.join(answer['equivalence_class']) or '-'} | tried {tried or '-'} | "
        f"misfit {before['misfit']:.3f} -> {after['misfit']:.3f}, z2 {before['tolerance_z2']:.0f} -> {after['tolerance_z2']:.0f} "
        f"of {after['tolerances']} | {answer['seconds']['diagnosis']:.1f} s"
    )


def _claim(one: Json) -> str:
    sizes = ",".join(
        f"{s['key']}{':' if s['key'] else ''}{s['value']:.3g} [{s['low']:.3g}, {s['high']:.3g}]" for s in one["sizes"]
    )
    return f"{one['id']}={sizes} ({one['evidence_nats']:.3g} nats)"


def _effect(id: str, sizes: dict[str, float]) -> str:
    written = ",".join(f"{key}{':' if key else ''}{value:.3g}" for key, value in sizes.items())
    return f"{id}={written}" if written else id
