"""`massline cog`: CoG height by crane and balance."""

from __future__ import annotations

import click


@click.command("cog", short_help="Reduce a crane-and-balance test.")
@click.argument("file")
@click.option("--against", metavar="ARTICLE", help="Set the result beside what is published about ARTICLE.")
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
def command(file: str, against: str | None, as_json: bool) -> None:
    """Reduce the crane-and-balance test in FILE: CoG height with its tolerance, itemised.

    FILE is a path or the name of a file that ships with massline, for example clumod-4-cog.
    """
    from validation import crane_cog, results_file
    from validation.measurement_file import read
    from validation.reduction_output import show

    fields = read(file, ("crane-cog", "results"))
    published = fields.text("kind") == "results"
    show(results_file.reduce(fields, ("cog_x", "cog_y", "cog_z")) if published else crane_cog.reduce(fields), against, as_json)
