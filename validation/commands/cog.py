"""`massline cog`: CoG height by crane and balance."""

from __future__ import annotations

import click

from validation.commands import options


@click.command("cog")
@options.measurement
def command(file: str, against: str | None, as_json: bool) -> None:
    """Reduce the crane-and-balance test in FILE: CoG height with its tolerance, itemised.

    FILE is a path or the name of a file that ships with massline, for example clumod-4-cog.
    """
    from validation import crane_cog
    from validation.reduction_output import show
    from validation.results_file import readings_or_results

    show(readings_or_results(file, "crane-cog", crane_cog.reduce, ("cog_x", "cog_y", "cog_z")), against, as_json)
