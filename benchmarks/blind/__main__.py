"""``python -m benchmarks.blind [--draw development|test] [--seed N] [--kinds nulls,singles,...] [--cases N]``.

Draws, seals and diagnoses; `python -m benchmarks.blind.score` says what came of it. Of a development draw every answer is told
beside its truth; of the test draw nothing but how far it is.
"""

from __future__ import annotations

import sys
from pathlib import Path

import click
from rich.console import Console

from benchmarks.blind import ledger
from benchmarks.blind.drawing.case import KINDS
from benchmarks.blind.drawing.draw import draw
from benchmarks.blind.keeping import Kept, present_code
from benchmarks.blind.running import finished
from benchmarks.blind.score.line import line
from benchmarks.blind.structures import drawing as structure_drawing
from benchmarks.blind.structures.drawing import STRUCTURES

DEVELOPMENT, TEST = DRAWS = ("development", "test")


@click.command()
@click.option("--draw", "which", type=click.Choice(DRAWS), default=TEST, show_default=True)
@click.option("--seed", type=int, help="Of a development draw; the newest by default.")
@click.option("--kinds", default=",".join(KINDS), show_default=True)
@click.option("--cases", type=click.IntRange(min=1), help="Of every kind; all by default.")
@click.option("--only", default="", help="Cases of a development draw by name, separated by commas.")
@click.option("--structures", type=click.IntRange(min=1), flag_value=STRUCTURES, is_flag=False, help="Random structures instead.")
@click.option("--jobs", type=click.IntRange(min=1), default=1, show_default=True, help="Series at a time.")
@click.option("--scheduler", default="", metavar="ADDRESS", help="Of Dask, whose workers do them instead.")
def main(
    which: str, seed: int | None, kinds: str, cases: int | None, only: str, structures: int | None, jobs: int, scheduler: str
) -> None:
    """Diagnose the cases of a draw; what is finished is kept, and not done again by the same code."""
    if jobs > 1 and scheduler:
        raise click.BadParameter("the workers of --scheduler do the work, and how many they are is their own; leave out --jobs")
    console, book = Console(stderr=True), ledger.read()
    chosen = book.structures if structures and which == TEST and seed is None else _seed(which, seed, book)
    wanted = tuple(one.strip() for one in kinds.split(","))
    if unknown := set(wanted) - set(KINDS):
        raise click.BadParameter(f"no kind is called {', '.join(sorted(unknown))}; there are {', '.join(KINDS)}")
    names = {one.strip() for one in only.split(",") if one.strip()}
    every = structure_drawing.draw(chosen, wanted, structures) if structures else draw(chosen, wanted, cases)
    drawn = [one for one in every if not names or one.name in names]
    kept = Kept(seed=chosen, code=present_code(), what="structures" if structures else "")
    console.print(f"{len(drawn)} series of the {which} draw, code {kept.code}", style="dim")
    try:
        for number, case in enumerate(finished(drawn, kept, jobs, scheduler), start=1):
            console.print(
                f"{number} of {len(drawn)}{': ' + line(*kept.pair(case.name)) if which == DEVELOPMENT else ''}", style="dim"
            )
    except KeyboardInterrupt:
        console.print("interrupted; what was finished is kept, and the same command goes on from there")
        sys.exit(130)


def _seed(which: str, seed: int | None, book: ledger.Ledger) -> int:
    """The seed that is meant; of the test draw nobody chooses it."""
    if which == TEST:
        if seed is not None:
            raise click.BadParameter("the seed of the test draw stands in the ledger; leave out --seed")
        return book.test
    if seed is not None and seed not in book.development:
        raise click.BadParameter(f"{seed} is not for development; there are {', '.join(map(str, book.development))}")
    return book.development[-1] if seed is None else seed


if __name__ == "__main__":
    if not Path("benchmarks/blind").is_dir():
        Console(stderr=True).print("run it in the folder of the project: results belong to the code that lies there")
        sys.exit(2)
    main()
