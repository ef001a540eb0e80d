"""`massline undo`: back to the rung below."""

from __future__ import annotations

from pathlib import Path

import click

from validation.commands import options


@click.command("undo")
@click.argument("model", type=click.Path(path_type=Path), metavar="MODEL")
@options.JSON
def command(model: Path, as_json: bool) -> None:
    """Put MODEL back as it was on the rung below, byte by byte; the rung that it leaves is kept.

    `massline ladder MODEL --go RUNG` goes to any other. Adding an effect after that branches.
    """
    from validation.ladders.run import undo

    undo(model, as_json=as_json)
