"""`massline compare` from options to output: read, fit, map, show."""

from __future__ import annotations

from pathlib import Path

import click

from geometry.atomic import write_text
from validation.comparing import as_json as written
from validation.comparing import table
from validation.comparing.asked import Asked, ready
from validation.comparing.compared import compared
from validation.comparing.comparison import Comparison
from validation.output import json_text
from validation.progress import shown, stages
from validation.tables.text import page

RESULT = "compare.json"
"""The file of a comparison in its folder."""


def answer(asked: Asked, *, as_json: bool, folder: Path | None) -> None:
    """Compare what is `asked`, print it, and write JSON and pictures into `folder` (None: nowhere).

    Raises
    ------
    BadInput : something that was asked cannot be used.
    CheckFailed : a fit that does not converge.
    """
    found = comparison(asked, quiet=as_json)
    if as_json:
        click.echo(json_text(written.as_json(found)))
    else:
        click.echo(page(table.title(found), table.grids(found), table.notes(found)), nl=False)
    if folder is not None:
        _write(found, folder, quiet=as_json)


def comparison(asked: Asked, *, quiet: bool = True) -> Comparison:
    """The comparison that `asked` leads to.

    Raises
    ------
    BadInput, CheckFailed : see `answer`.
    """
    with stages("reading", quiet=quiet) as told:
        model, data = ready(asked, told)
    with stages("comparing", quiet=quiet) as told:
        return compared(model, data, asked.hold_out, told, band=asked.band, method=asked.method)


def _write(found: Comparison, folder: Path, *, quiet: bool) -> None:
    from validation.comparing.drawn import draw

    write_text(folder / RESULT, json_text(written.as_json(found)) + "\n")
    click.echo(f"massline: wrote {folder / RESULT}.", err=True)
    with shown("pictures", quiet=quiet):
        paths = draw(found, folder)
    for path in paths:
        click.echo(f"massline: wrote {path}.", err=True)
