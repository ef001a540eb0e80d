"""``python -m benchmarks.blind.score [--draw development|test] [--seed N] [--code HASH] [--page]``: truths against answers.

Looking at the test draw is written into the ledger. The program ends with 1 where a bar is missed, where nothing is there to be
scored, and where a draw is called a test that is none any more.
"""

from __future__ import annotations

import sys

import click
from rich.console import Console

from benchmarks.blind import ledger
from benchmarks.blind.keeping import Kept, present_code
from benchmarks.blind.score import page, printed
from benchmarks.blind.score import structures as of_structures
from benchmarks.blind.score.families import by_family
from benchmarks.blind.score.outcome import outcome
from benchmarks.blind.score.rows import rows

TEST = "test"


@click.command()
@click.option("--draw", "which", type=click.Choice(("development", TEST)), default=TEST, show_default=True)
@click.option("--seed", type=int, help="Of a draw that is no test any more; the newest for development by default.")
@click.option("--code", help="Hash of the code whose results are meant; that of the present code by default.")
@click.option("--structures", is_flag=True, help="Of random structures.")
@click.option("--page", "to_page", is_flag=True, help="Write the table into docs/diagnosis-proven-blind.md, too.")
def main(which: str, seed: int | None, code: str | None, structures: bool, to_page: bool) -> None:
    """Print the table of bars and one row a family."""
    console, book = Console(), ledger.read()
    chosen = (book.structures if structures else book.test) if which == TEST else seed or book.development[-1]
    kept = Kept(seed=chosen, code=code or present_code(), what="structures" if structures else "")
    if structures:
        _of_structures(console, kept, which == TEST, to_page)
    outcomes = [outcome(truth, answer) for truth, answer in kept.pairs()]
    if not outcomes:
        console.print(f"nothing is there of draw {chosen} by code {kept.code}; `python -m benchmarks.blind` makes it")
        sys.exit(1)
    if which == TEST:
        book = ledger.look(chosen, kept.code, len(outcomes))
    found, families = rows(outcomes), by_family(outcomes)
    heading = printed.heading(chosen, kept.code, outcomes, book)
    console.print(printed.bars(found, heading))
    console.print(printed.families(families))
    if to_page:
        page.write(page.text(found, families, heading))
    blind = which != TEST or book.blind(chosen, kept.code)
    sys.exit(0 if blind and all(one.met is not False for one in found) else 1)


def _of_structures(console: Console, kept: Kept, tested: bool, to_page: bool) -> None:
    """Print the table of bars, and one row a kind of structure and of effect; ends the program."""
    found = [of_structures.structure_outcome(truth, answer) for truth, answer in kept.pairs()]
    if not found:
        console.print(f"nothing is there of draw {kept.seed} by code {kept.code}; `make blind ARGS=--structures` makes it")
        sys.exit(1)
    book = ledger.look(kept.seed, kept.code, len(found)) if tested else ledger.read()
    table = of_structures.rows(found)
    heading, groups = printed.heading(kept.seed, kept.code, [one.of for one in found], book), of_structures.by_group(found)
    console.print(printed.bars(table, heading))
    console.print(printed.groups(groups))
    if to_page:
        page.write(page.text_of_structures(table, groups, heading), which=page.STRUCTURES)
    sys.exit(0 if all(one.met is not False for one in table) else 1)


if __name__ == "__main__":
    main()
