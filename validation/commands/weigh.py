"""`massline weigh`: mass from readings of a balance."""

from __future__ import annotations

import click

from validation.commands import options


@click.command("weigh")
@options.measurement
def command(file: str, against: str | None, as_json: bool) -> None:
    """Reduce the weighing in FILE: mass with its tolerance, itemised.

    FILE is a path or the name of a file that ships with massline, for example clumod-4-weighing.
    """
    from validation import weighing
    from validation.reduction_output import show
    from validation.results_file import readings_or_results

    show(readings_or_results(file, "weighing", weighing.reduce, ("mass",)), against, as_json)
