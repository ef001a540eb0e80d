"""Where an unknown effect shows: the map of what is left once everything that was accepted acts."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from validation.article_reference import file_name
from validation.comparing.compared import mapped_all, modes_of
from validation.comparing.drawn import draw_channels
from validation.diagnosing.bench import Bench
from validation.diagnosing.diagnosis import Diagnosis
from validation.engine.hold_out import named, without
from validation.ladders.judging import at_offsets, kept_offsets
from validation.models.model import Added


def draw_left(found: Diagnosis, bench: Bench, folder: Path, progress: Callable[[float], None]) -> tuple[Path, ...]:
    """Write a map of each campaign into `folder`: channels and loads in sigmas, at the plain fit with what was accepted."""
    whole = bench.whole([Added(named=one.named) for one in found.accepted])
    known = without(whole, named(whole, bench.hold_out)) if bench.hold_out else whole
    plain = at_offsets(kept_offsets(found.after.plain_fit), whole)
    made = [one.with_effects((*bench.model.effects, *(Added(named=each.named) for each in found.accepted))) for one in bench.made]
    paths = []
    for of, one in zip(mapped_all(made, whole, known.thinned(), plain, progress), made, strict=True):
        paths.append(folder / f"{file_name(f'diagnose-left-{of.data_set}')}.png")
        draw_channels(of, modes_of(one, {**whole.start, **plain.by_name}), paths[-1])
    return tuple(paths)
