"""`massline diagnose` from options to output: read, diagnose, show; with `--auto`, climb."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from geometry.atomic import write_text
from validation.diagnosing import as_json as written
from validation.diagnosing import table
from validation.diagnosing.asked import Asked, ready
from validation.output import json_text
from validation.progress import shown, stages
from validation.tables.text import page

if TYPE_CHECKING:
    from validation.diagnosing.diagnosis import Diagnosis

RESULT = "diagnose.json"
"""The file of a diagnosis in its folder."""


def answer(asked: Asked, *, as_json: bool, folder: Path | None) -> None:
    """Diagnose what is `asked`, print it, and write JSON and pictures into `folder` (None: nowhere).

    Raises
    ------
    BadInput : something that was asked cannot be used.
    CheckFailed : a baseline that does not converge.
    """
    found, data_sets = diagnosis(asked, quiet=as_json)
    whole = {**of_asked(asked, data_sets), **written.as_json(found)}
    click.echo(json_text(whole) if as_json else text(asked, data_sets, found), nl=as_json)
    if folder is not None:
        write(found, whole, folder, quiet=as_json)


def diagnosis(asked: Asked, *, quiet: bool = True) -> tuple[Diagnosis, tuple[str, ...]]:
    """The diagnosis that `asked` leads to, and the names of its data sets.

    Raises
    ------
    BadInput, CheckFailed : see `answer`.
    """
    from validation.diagnosing.diagnosed import bench, diagnosed

    with stages("reading", quiet=quiet) as told:
        model, data = ready(asked, told)
    with stages("diagnosing", quiet=quiet) as told:
        ready_made = bench(model, data, hold_out=asked.hold_out, band=asked.band, method=asked.method, progress=told)
        found = diagnosed(ready_made, only=asked.candidates, progress=told)
    return found, tuple(one.measured.name for one in ready_made.made)


def text(asked: Asked, data_sets: tuple[str, ...], found: Diagnosis) -> str:
    """The page of a diagnosis."""
    return page(table.title(asked.model.name, data_sets), table.grids(found), table.notes(found), opening=table.opening(found))


def of_asked(asked: Asked, data_sets: tuple[str, ...]) -> dict[str, Any]:
    """What was asked, as JSON."""
    return {
        "model": str(asked.model),
        "data": list(asked.data),
        "campaigns": list(data_sets),
        "hold_out": list(asked.hold_out),
        "band_hz": None if asked.band is None else list(asked.band),
        "method": asked.method,
        "candidates": list(asked.candidates),
    }


def write(found: Diagnosis, whole: dict[str, Any], folder: Path, *, quiet: bool) -> None:
    """`diagnose.json` and the pictures, into `folder`."""
    from validation.diagnosing.drawn import draw

    write_text(folder / RESULT, json_text(whole) + "\n")
    click.echo(f"massline: wrote {folder / RESULT}.", err=True)
    with shown("pictures", quiet=quiet):
        paths = draw(found, folder)
    for path in paths:
        click.echo(f"massline: wrote {path}.", err=True)
