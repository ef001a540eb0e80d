"""How much of the cores at hand diagnoses of a fleet use, beside one process after the other, and whether they answer the same.

Efficiency is the time of a plain loop over cores times the time of the processes. On a machine that others use, too, both are
taken as time of the processor, and what the processes stood idle between the first task and the last is taken off.
"""

from __future__ import annotations

import os
import resource
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import click
from joblib import cpu_count
from rich.console import Console

from geometry import parallel
from identification import campaign_file
from validation.diagnose.diagnose import diagnosed
from validation.model import model_file
from validation.output import json_text, to_json
from validation.study import Study
from validation.virtual_test.plan import Plan
from validation.virtual_test.simulate import simulate

ARTICLE = "fmd+cuboid"
OCTAVES_PER_MINUTE = 60.0
BAR = 0.8
"""[share] of the cores that the issue asks for."""


@dataclass(frozen=True, kw_only=True)
class Timed:
    """An answer as text, and when it was begun and ended [s], of the clock of the machine."""

    answer: str
    begun: float
    ended: float


def timed(task: tuple[str, str]) -> Timed:
    """A diagnosis of the campaign beside the model."""
    begun = time.time()
    model, campaign = task
    found = diagnosed(Study.open(model, [campaign]), only=["force-gain", "point-mass"])
    return Timed(answer=json_text(to_json(found)), begun=begun, ended=time.time())


def spent() -> float:
    """[s] of the processor, of this process and of those that it has ended."""
    both = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(one.ru_utime + one.ru_stime for one in both)


@click.command()
@click.option("--articles", type=click.IntRange(min=2), default=12, show_default=True)
@click.option("--processes", type=click.IntRange(min=2), default=max(cpu_count(), 2), show_default=True)
def main(articles: int, processes: int) -> None:
    """Print the efficiency; exit code 1 below the bar or where answers differ."""
    console = Console()
    with TemporaryDirectory() as scratch:
        model = Path(scratch) / "model.toml"
        model.write_text(model_file.text(model_file.of_text(f'format = 1\n[model]\narticle = "{ARTICLE}"\n', "bench")))
        tasks = []
        for seed in range(articles):
            folder = Path(scratch) / f"sn-{seed}"
            campaign_file.write(
                folder, simulate(Plan(article=ARTICLE, seed=seed, octaves_per_minute=OCTAVES_PER_MINUTE)).campaign, ending=".h5"
            )
            tasks.append((str(model), str(folder)))
        timed(tasks[0])  # what is imported and cached once
        begun, alone = spent(), dict(parallel.finished(timed, tasks, processes=1))
        loop = spent() - begun
        begun = spent()
        many = dict(parallel.finished(timed, tasks, processes=processes))
        total = spent() - begun
    done = {task: one for task, one in many.items() if isinstance(one, Timed)}
    whole = max(one.ended for one in done.values()) - min(one.begun for one in done.values())
    busy = sum(one.ended - one.begun for one in done.values()) / (processes * whole)
    same = len(done) == articles and all(
        isinstance(one, Timed) and one.answer == done[task].answer for task, one in alone.items()
    )
    share = loop / total * busy
    console.print(f"{articles} diagnoses by {processes} processes on {os.cpu_count()} cores")
    console.print(f"processor: {total / loop:.2f} of a plain loop's, start of the processes included; busy {100 * busy:.0f} %")
    console.print(f"efficiency {100 * share:.0f} %, bar {100 * BAR:.0f} %: {'met' if share >= BAR else 'missed'}")
    console.print(f"answers {'are the same to the last digit' if same else 'DIFFER'}")
    sys.exit(0 if share >= BAR and same else 1)


if __name__ == "__main__":
    from benchmarks import bench_fleet  # a process finds its functions under their names

    bench_fleet.main()
