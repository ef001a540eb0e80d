"""`massline pendulum`: moments of inertia from pendulum periods."""

from __future__ import annotations

import click


@click.command("pendulum", short_help="Reduce pendulum periods.")
@click.argument("file")
@click.option("--against", metavar="ARTICLE", help="Set the result beside what is published about ARTICLE.")
@click.option("--without", "off", multiple=True, metavar="TERM", help="Leave out a correction: amplitude, damping or rope-mass.")
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
def command(file: str, against: str | None, off: tuple[str, ...], as_json: bool) -> None:
    """Reduce the pendulum periods in FILE: moments of inertia with tolerance, itemised.

    FILE is a path or the name of a file that ships with massline, for example clumod-4-pendulum.
    """
    from validation import pendulum_file, results_file
    from validation.measurement_file import read
    from validation.pendulum_corrections import require_terms
    from validation.reduction_output import show

    fields = read(file, ("pendulum", "results"))
    published = fields.text("kind") == "results"
    keys = ("Ixx", "Iyy", "Izz")
    show(results_file.reduce(fields, keys) if published else pendulum_file.reduce(fields, require_terms(off)), against, as_json)
