"""`massline diagnose` where no campaign is among the data, from options to output."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from geometry.atomic import write_text
from geometry.errors import BadInput
from validation.diagnosing.asked import Asked
from validation.diagnosing.classical import table
from validation.diagnosing.classical.as_json import as_json as written
from validation.diagnosing.swings import only_classical
from validation.ladders.own_effects import reminded
from validation.models import reading
from validation.output import json_text
from validation.progress import stages
from validation.tables.text import page

RESULT = "diagnose.json"
"""The file of a diagnosis in its folder."""


def answer(asked: Asked, files: Sequence[str], *, auto: bool, as_json: bool, folder: Path | None) -> None:
    """Diagnose by the measurement `files` alone, print it, and write JSON into `folder` (None: nowhere).

    Raises
    ------
    BadInput : a model or a file that cannot be used, or an option that asks for a campaign.
    """
    _require_nothing_of_spectra(asked, auto=auto)
    with reminded(asked.model):
        model = reading.read(str(asked.model))
    with stages("diagnosing", quiet=as_json) as told:
        found = only_classical(model, files, lambda share: told("effects", share), only=asked.candidates)
    whole = {"model": str(asked.model), "data": list(files), **written(found)}
    if as_json:
        click.echo(json_text(whole))
    else:
        named = table.title(asked.model.name, files)
        click.echo(page(named, table.grids(found), table.notes(found), opening=table.opening(found)), nl=False)
    if folder is not None:
        write_text(folder / RESULT, json_text(whole) + "\n")
        click.echo(f"massline: wrote {folder / RESULT}.", err=True)


def _require_nothing_of_spectra(asked: Asked, *, auto: bool) -> None:
    """Refuse options that mean nothing without a campaign.

    Raises
    ------
    BadInput : names the option.
    """
    given = {"--auto": auto, "--hold-out": bool(asked.hold_out), "--band": asked.band is not None}
    for option, there in given.items():
        if there:
            problem = "there is no campaign among DATA: weights and periods alone are neither held out nor climbed on"
            raise BadInput(source=option, problem=problem, remedy="Leave it out, or name a campaign folder, too")
