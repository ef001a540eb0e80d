"""`massline ladder`: every version of a model, and how its errors fell."""

from __future__ import annotations

from pathlib import Path

import click

from validation.commands import options


@click.command("ladder")
@click.argument("model", type=click.Path(path_type=Path), metavar="MODEL")
@click.option("--go", type=int, metavar="RUNG", help="Go to this rung first: MODEL is rewritten as it was there.")
@click.option("--plot/--no-plot", default=True, show_default=True, help="Draw the falling errors and the inertia.")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("out"),
    show_default=True,
    metavar="DIR",
    help="Where the pictures go.",
)
@options.JSON
def command(model: Path, go: int | None, plot: bool, out: Path, as_json: bool) -> None:
    """The rungs of MODEL as a tree, with their errors on data that were fitted and held out, and the way of its inertia.

    The rung on which MODEL stands is marked. docs/ladder.md says how to read it.
    """
    from validation.ladders.run import ladder
    from validation.output import require_folder

    if plot:
        require_folder(out, "--out")
    ladder(model, go=go, as_json=as_json, folder=out if plot else None)
