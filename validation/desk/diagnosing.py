"""What the model as it stands is missing: diagnosed once, kept in the desk, read again after a reload."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from geometry.atomic import write_text
from validation.desk import retold
from validation.desk.desk import Desk
from validation.diagnosing import as_json as written
from validation.diagnosing import run
from validation.diagnosing.asked import Asked
from validation.diagnosing.diagnosis import Diagnosis
from validation.output import json_text

Progress = Callable[[str, float], None]

FILE, BESIDE = "diagnose.json", "diagnose.tolerances.json"


def diagnosed(of: Desk, candidates: Sequence[str] = (), progress: Progress | None = None) -> Mapping[str, Any]:
    """The diagnosis of the model of the desk, kept: the object of `massline diagnose --json`.

    Takes from seconds to minutes: `validation.desk.jobs.start(desk, "diagnose")` does it in a worker.

    Parameters
    ----------
    candidates : families and ids that alone are looked for; all where nothing is said

    Raises
    ------
    BadInput : model or data that cannot be used, a candidate that could not act on them.
    CheckFailed : the model with all its tolerances does not converge.
    OSError : a file cannot be read or written.
    """
    folder, asked, tell = of.found, _asked(of, candidates), progress or (lambda what, share: None)
    tell("reading", 0.0)
    bench = run.prepared(asked)
    found = run.diagnosis(asked, bench, tell)
    whole = {**run.of_asked(asked, bench), **written.as_json(found)}
    write_text(folder / BESIDE, json_text(retold.tolerances(found)))
    write_text(folder / FILE, json_text(whole))
    return whole


def diagnosis(of: Desk) -> Mapping[str, Any] | None:
    """That of the model as it stands, if it was made; quick."""
    try:
        found = json.loads((of.found / FILE).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return found if isinstance(found, dict) else None


def noun(of: Desk) -> Diagnosis | None:
    """The same as the noun that `validation.plots` and reports take; quick."""
    said = diagnosis(of)
    if said is None:
        return None
    try:
        return retold.diagnosis(said, json.loads((of.found / BESIDE).read_text(encoding="utf-8")))
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _asked(of: Desk, candidates: Sequence[str]) -> Asked:
    asked = of.asked
    return Asked(
        model=Path(of.model),
        data=asked.data,
        hold_out=asked.hold_out,
        band=asked.band,
        method=asked.method,
        candidates=tuple(candidates),
        effects_from=asked.effects_from,
    )
