"""`massline weigh`: mass from readings of a balance."""

from __future__ import annotations

import click


@click.command("weigh", short_help="Reduce a weighing.")
@click.argument("file")
@click.option("--against", metavar="ARTICLE", help="Set the result beside what is published about ARTICLE.")
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
def command(file: str, against: str | None, as_json: bool) -> None:
    """Reduce the weighing in FILE: mass with its tolerance, itemised.

    FILE is a path or the name of a file that ships with massline, for example clumod-4-weighing.
    """
    from validation import results_file, weighing
    from validation.measurement_file import read
    from validation.reduction_output import show

    fields = read(file, ("weighing", "results"))
    published = fields.text("kind") == "results"
    show(results_file.reduce(fields, ("mass",)) if published else weighing.reduce(fields), against, as_json)
