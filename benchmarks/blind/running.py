"""Every case of a draw: simulated into a scratch folder, diagnosed by a process that gets that folder alone, and cleaned away.

Several are done side by side by processes here, or by the workers of a scheduler. A case that breaks down is an answer, which
counts as a miss. What an interruption ends leaves nothing; what was finished before stays.
"""

from __future__ import annotations

import json
import os
import resource
import signal
import subprocess
import sys
import traceback
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from benchmarks.blind.drawing.case import Case
from benchmarks.blind.keeping import Kept
from benchmarks.blind.names import ANSWER, Json
from benchmarks.blind.sealing import sealed
from benchmarks.blind.sealing import truth as truth_of
from benchmarks.blind.structures import sealing as structures
from benchmarks.blind.structures.drawing import StructureCase
from benchmarks.cross_check_proof import SWEEPS
from geometry import parallel
from identification.campaign import Processing

PATIENCE = 900
"""Seconds of processor time that a diagnosis may take before it counts as broken: a busy machine makes no answer wrong."""

THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS")

LAST = 2000
"""Characters of what a broken process said that are kept."""


AnyCase = Case | StructureCase


class Interrupted(Exception):
    """A case was ended from outside; it has no answer."""


def finished(cases: Sequence[AnyCase], kept: Kept, jobs: int, scheduler: str = "") -> Iterator[AnyCase]:
    """The `cases` as they are finished, those first that were finished before.

    Parameters
    ----------
    jobs, scheduler : how many at a time, or who does them; see `geometry.parallel.finished`
    """
    missing = [one for one in cases if not kept.finished(one.name)]
    yield from (one for one in cases if one not in missing)
    for one, found in parallel.finished(solved, missing, processes=jobs, scheduler=scheduler):
        if isinstance(found, parallel.WorkerLost):
            found = _without_drawn(one), {"broken": str(found)}
        truth, answer = found
        kept.keep_truth(one.name, truth)
        kept.keep_answer(one.name, answer)
        yield one


def solved(case: AnyCase, *, driven: Mapping[str, Any] = SWEEPS, processing: Processing | None = None) -> tuple[Json, Json]:
    """Truth and answer of `case`.

    Parameters
    ----------
    driven, processing : see `benchmarks.blind.sealing.sealed`

    Raises
    ------
    Interrupted : the diagnosis was interrupted.
    """
    with TemporaryDirectory(prefix="massline-blind-") as scratch:
        folder = Path(scratch) / "series"
        try:
            if isinstance(case, StructureCase):
                truth = structures.sealed(case, folder)
            else:
                truth = sealed(case, folder, driven=driven, processing=processing)
        except Exception:
            return _without_drawn(case), {"broken": traceback.format_exc()[-LAST:]}
        return truth, _diagnosed(folder)


def _without_drawn(case: AnyCase) -> Json:
    """Its truth without the sizes that were to be drawn."""
    return structures.truth(case, (), {}) if isinstance(case, StructureCase) else truth_of(case, {})


def _diagnosed(folder: Path) -> Json:
    """What a process of its own says of `folder`."""
    command = [sys.executable, "-P", "-m", "benchmarks.blind.answering", str(folder)]
    done = subprocess.run(
        command,
        cwd=folder,
        env=_environment(),
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (PATIENCE, PATIENCE + 1)),
    )
    if done.returncode == -signal.SIGXCPU:
        return {"broken": f"no answer within {PATIENCE} seconds of processor time"}
    if done.returncode == -signal.SIGINT:
        raise Interrupted
    answer = folder / ANSWER
    if not answer.exists():
        return {"broken": done.stderr[-LAST:] or f"ended with {done.returncode}"}
    found: Json = json.loads(answer.read_text(encoding="utf-8"))
    return found


def _environment() -> dict[str, str]:
    """Of the process: one thread, and this repository behind whatever it would import first."""
    paths = [os.environ.get("PYTHONPATH", ""), str(Path(__file__).parents[2])]
    return {**os.environ, **dict.fromkeys(THREADS, "1"), "PYTHONPATH": os.pathsep.join(filter(None, paths))}
