"""`massline pendulum`: moments of inertia from pendulum periods."""

from __future__ import annotations

import click

from validation.commands import options


@click.command("pendulum")
@options.measurement
@click.option("--without", "off", multiple=True, metavar="TERM", help="Leave out a correction: amplitude, damping or rope-mass.")
def command(file: str, against: str | None, off: tuple[str, ...], as_json: bool) -> None:
    """Reduce the pendulum periods in FILE: moments of inertia with tolerance, itemised.

    FILE is a path or the name of a file that ships with massline, for example clumod-4-pendulum.

    Exit code 1 when no body can have the moments that come out.
    """
    from functools import partial

    from validation import pendulum_file
    from validation.pendulum_corrections import require_terms
    from validation.reduction_output import show
    from validation.results_file import readings_or_results

    reduce = partial(pendulum_file.reduce, off=require_terms(off))
    show(readings_or_results(file, "pendulum", reduce, ("Ixx", "Iyy", "Izz")), against, as_json)
