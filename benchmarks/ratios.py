"""How many times longer does one thing take than another, within one run?

Times belong to a machine; ratios of times taken in turns on one machine at one moment belong to the code. So a benchmark
names its callables, this module runs them round and round (a slow spell then hits all of them), keeps the fastest round of
each - the one that was disturbed least - and divides by one of them. Times are shown on the screen and kept nowhere.

A new benchmark is a file ``benchmarks/bench_*.py`` that ends in

    if __name__ == "__main__":
        show("Routes", measure({"import": ..., "occ": ..., "trimesh": ...}), base="import")

and is run by ``make bench``, or alone: ``python -m benchmarks.bench_routes --json``.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from rich.console import Console
from rich.table import Table


@dataclass(frozen=True, kw_only=True)
class Timing:
    """Time of one callable [s]: the `fastest` of its rounds and the `median` of them."""

    fastest: float
    median: float


def measure(
    callables: Mapping[str, Callable[[], object]], rounds: int = 5, clock: Callable[[], float] = time.perf_counter
) -> dict[str, Timing]:
    """Run every callable once in each of `rounds` rounds and return the timing of each by name.

    Raises
    ------
    ValueError : fewer than one round.
    """
    if rounds < 1:
        raise ValueError(f"`rounds` must be at least 1, found {rounds}")
    seconds: dict[str, list[float]] = {name: [] for name in callables}
    for _ in range(rounds):
        for name, call in callables.items():
            start = clock()
            call()
            seconds[name].append(clock() - start)
    return {name: Timing(fastest=min(taken), median=sorted(taken)[len(taken) // 2]) for name, taken in seconds.items()}


def ratios(timings: Mapping[str, Timing], base: str) -> dict[str, float]:
    """Fastest time of each over that of `base`, by name.

    Raises
    ------
    ValueError : `base` was not measured.
    """
    if base not in timings:
        raise ValueError(f"`base` must be one of {', '.join(timings)}, found {base!r}")
    return {name: timing.fastest / timings[base].fastest for name, timing in timings.items()}


def show(title: str, timings: Mapping[str, Timing], *, base: str, notes: Mapping[str, str] | None = None) -> None:
    """Print the ratios to `base` as a table, or with ``--json`` on the command line as one JSON object.

    `notes` are figures that belong beside a time, an error for example, by the names of the callables.
    """
    over = ratios(timings, base)
    if "--json" in sys.argv[1:]:
        sys.stdout.write(json.dumps({"title": title, "base": base, "ratios": over, "notes": dict(notes or {})}, indent=2) + "\n")
        return
    table = Table(title=title, title_justify="left", title_style="bold")
    table.add_column("what")
    for heading in (f"times {base}", "ms", "median ms"):
        table.add_column(heading, justify="right")
    if notes:
        table.add_column("note")
    for name, timing in timings.items():
        figures = (f"{over[name]:.3g}", f"{1e3 * timing.fastest:.3g}", f"{1e3 * timing.median:.3g}")
        table.add_row(name, *figures, *([notes.get(name, "")] if notes else []))
    Console().print(table)
