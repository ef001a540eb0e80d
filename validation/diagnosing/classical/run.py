"""`massline diagnose` without a campaign, from file names to output."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from geometry.atomic import write_text
from validation.diagnosing.classical import table
from validation.diagnosing.classical.as_json import as_json as written
from validation.diagnosing.classical.nouns import SwingAnswer
from validation.diagnosing.swings import only_classical
from validation.models.model import Model
from validation.output import json_text
from validation.progress import stages
from validation.tables.text import page

RESULT = "diagnose.json"
"""The file of a diagnosis in its folder."""


def answer(model: Model, files: Sequence[str], *, as_json: bool, folder: Path | None) -> SwingAnswer:
    """Diagnose `model` by the measurement `files` alone, print it, and write JSON into `folder` (None: nowhere).

    Raises
    ------
    BadInput : a file that cannot be used.
    """
    with stages("diagnosing", quiet=as_json) as told:
        found = only_classical(model, files, lambda share: told("effects", share))
    if as_json:
        click.echo(json_text(written(found)))
    else:
        click.echo(page(table.title(found), table.grids(found), table.notes(found)), nl=False)
    if folder is not None:
        write_text(folder / RESULT, json_text(written(found)) + "\n")
        click.echo(f"massline: wrote {folder / RESULT}.", err=True)
    return found
