"""What of the page the next reload finds again."""

from __future__ import annotations

from validation.app.bench import Bench
from validation.desk import desk as desks

KEPT = ("campaign", "load", "motion", "marked", "map_kind", "run", "tab", "scheme", "mode", "part")
"""State of the page, by name."""


def keep(bench: Bench) -> None:
    """Keep it in the desk."""
    if bench.desk is not None:
        desks.keep_view(bench.desk, {**{key: bench.state[key] for key in KEPT}, "effect": _chosen(bench)})


def kept(bench: Bench) -> str | None:
    """Put back what was kept; the effect that was chosen, with its size, comes back to be chosen again."""
    if bench.desk is None:
        return None
    found = desks.view(bench.desk)
    bench.state.update({key: found[key] for key in KEPT if key in found})
    effect = found.get("effect")
    return effect if isinstance(effect, str) else None


def _chosen(bench: Bench) -> str | None:
    if bench.state.effect is None:
        return None
    known = bench.effects.get(bench.state.effect["id"])
    return bench.wanted if known is None else known.written(bench.sizes)
