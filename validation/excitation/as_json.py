"""The JSON object of `massline excite`, a stable contract: keys end in their unit, loads act on the article."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fem.flexible_body.running import exudyn_version
from geometry.dynamic_mass import MOTIONS
from validation.excitation import words
from validation.excitation.asked import LINEAR
from validation.excitation.figures import CellLoad, Level, LoosePart, Outcome
from validation.excitation.passage import Passed
from validation.excitation.runs import Ready
from validation.excitation.signals import LOAD_UNITS, LOADS

ACCELERATION = ("m_s2",) * 3 + ("rad_s2",) * 3
LOAD_KEYS = tuple(f"{name}_{unit.replace(' ', '')}" for name, unit in zip(LOADS, LOAD_UNITS, strict=True))
"""fx_N ... mx_Nm."""


def of(made: Ready, outcomes: Sequence[Outcome], files: Sequence[Sequence[Path]]) -> dict[str, Any]:
    """All that is printed, and more digits of it; `files` were written for each run."""
    question, rig = made.question, made.mounted.rig
    drive = question.drive
    return {
        "article": question.article,
        "model": None if made.mounted.model is None else made.mounted.model.model,
        "route": made.route.name,
        "route_why": made.route.why,
        "exudyn": None if made.route.name == LINEAR else exudyn_version(),
        "about": "article" if rig.cover is None and made.mounted.model is not None else "F",
        "sampling_rate_hz": question.rate,
        "drive": {
            "pattern": drive.pattern,
            "band_hz": list(drive.band),
            "octaves_per_minute": drive.octaves_per_minute,
            "level": drive.level,
            "cross": drive.cross,
            "seed": drive.seed,
        },
        "rig": {
            "text": list(words.rig(made.mounted, made.modes)),
            "linear": rig.linear,
            "mass_kg": float(made.modes.rigid_mass[0, 0]),
            "modes_kept": len(rig.article.kept),
            "frequency_hz": made.modes.frequency.tolist(),
            "resonance": list(made.modes.resonance),
            "damping_ratio": made.modes.damping_ratio.tolist(),
        },
        "runs": [_run(one, paths) for one, paths in zip(outcomes, files, strict=True)],
    }


def _run(one: Outcome, files: Sequence[Path]) -> dict[str, Any]:
    return {
        "name": one.name,
        "label": one.label,
        "duration_s": one.duration,
        "driven_s": one.driven,
        "level": [_level(level) for level in one.levels],
        "cross": one.cross,
        "small_motion": {
            "angle_rad": one.small.angle,
            "rate_rad_s": one.small.rate,
            "left_out": one.small.left_out,
            "limit": one.small.limit,
            "within": one.small.within,
            "text": one.small.text,
        },
        "peak_load": dict(zip(LOAD_KEYS, one.peak_load.tolist(), strict=True)),
        "peak_load_at_s": one.peak_time.tolist(),
        "resonances": [_passed(p) for p in one.passed],
        "ring_down": {
            "kept_s": one.ring_down.kept,
            "needed_s": one.ring_down.needed,
            "sufficient": one.ring_down.sufficient,
        },
        "cells": [_cell(number, cell) for number, cell in enumerate(one.cells, start=1)],
        "loose_parts": [_loose(part) for part in one.loose],
        "step_s": one.step,
        "settings": dict(one.settings),
        "warnings": list(one.warnings),
        "files": [str(path) for path in files],
    }


def _level(level: Level) -> dict[str, Any]:
    unit = ACCELERATION[level.axis]
    return {
        "axis": MOTIONS[level.axis],
        f"asked_{unit}": level.asked,
        f"realised_{unit}": level.realised,
        f"peak_{unit}": level.peak,
    }


def _passed(p: Passed) -> dict[str, Any]:
    return {
        "mode": p.mode,
        "frequency_hz": p.frequency,
        "damping_ratio": p.damping_ratio,
        "load": LOADS[p.axis],
        "passed_at_s": p.time,
        "amplification": p.amplification,
        "largest_at_s": p.peak_time,
        "largest_at_hz": p.peak_frequency,
    }


def _cell(number: int, cell: CellLoad) -> dict[str, Any]:
    return {
        "cell": number,
        "z_lowest_N": cell.lowest,
        "z_highest_N": cell.highest,
        "lateral_N": cell.lateral,
        "preload_N": cell.preload,
        "share_lifted": cell.share_lifted,
    }


def _loose(part: LoosePart) -> dict[str, Any]:
    return {
        "axis": part.axis,
        "mass_kg": part.mass,
        "slip_force_N": part.slip_force,
        "share_slipping": part.share_slipping,
    }
