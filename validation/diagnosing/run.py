"""`massline diagnose` from options to output: read, diagnose, show; with `--auto`, climb."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from geometry.atomic import probe, write_text
from validation.comparing.gathered import only_files
from validation.diagnosing import as_json as written
from validation.diagnosing import automatic, diagnosed, table
from validation.diagnosing.asked import Asked, of_levels, ready
from validation.diagnosing.bench import Bench
from validation.diagnosing.classical import run as classical
from validation.diagnosing.levels import require_levels
from validation.ladders import run as ladders
from validation.ladders.nouns import Rung
from validation.output import json_text
from validation.progress import percent, stages
from validation.tables.text import page

if TYPE_CHECKING:
    from validation.diagnosing.diagnosis import Diagnosis

Progress = Callable[[str, float], None]

RESULT = "diagnose.json"
"""The file of a diagnosis in its folder."""


def answer(asked: Asked, *, auto: bool, as_json: bool, folder: Path | None) -> None:
    """Diagnose what is `asked`, print it, and write JSON and pictures into `folder` (None: nowhere); where `auto`, climb.

    Raises
    ------
    BadInput : something that was asked cannot be used.
    CheckFailed : a baseline that does not converge.
    OSError : with `auto`, the model file cannot be written.
    """
    if files := only_files(asked.data):
        classical.answer(asked, files, auto=auto, as_json=as_json, folder=folder)
        return
    if auto and asked.model.is_file():
        probe(asked.model)  # what cannot be written at the end is said before minutes are spent
    bench = prepared(asked, quiet=as_json)
    found, more = (_climbed if auto else _diagnosed)(asked, bench, as_json=as_json)
    whole = {**of_asked(asked, bench), **written.as_json(found), **more}
    if as_json:
        click.echo(json_text(whole))
    if folder is not None:
        write(found, bench, whole, folder, quiet=as_json)


def prepared(asked: Asked, *, quiet: bool = True) -> Bench:
    """The bench that `asked` leads to.

    Raises
    ------
    BadInput : something that was asked cannot be used.
    """
    with stages("reading", quiet=quiet) as told:
        model, data = ready(asked, told)
        made = diagnosed.bench(model, data, hold_out=asked.hold_out, band=asked.band, method=asked.method, progress=told)
    for text in of_levels(asked):
        require_levels(made, text)
    return made


def diagnosis(asked: Asked, bench: Bench, progress: Progress | None = None) -> Diagnosis:
    """What is missing on `bench`.

    Raises
    ------
    CheckFailed : a baseline that does not converge.
    """
    return diagnosed.diagnosed(bench, only=asked.candidates, progress=progress)


def _diagnosed(asked: Asked, bench: Bench, *, as_json: bool) -> tuple[Diagnosis, dict[str, Any]]:
    """The diagnosis, printed; there is nothing more to say in JSON."""
    with stages("diagnosing", quiet=as_json) as told:
        found = diagnosis(asked, bench, told)
    if not as_json:
        click.echo(text(asked, bench, found), nl=False)
    return found, {}


def _climbed(asked: Asked, bench: Bench, *, as_json: bool) -> tuple[Diagnosis, dict[str, Any]]:
    """The first diagnosis of a climb, and what JSON has of the others and of the ladder; the rest is printed as it comes."""
    pages = 0

    def first(found: Diagnosis) -> None:
        nonlocal pages
        if not pages and not as_json:
            click.echo(text(asked, bench, found))
        pages += 1

    def added(rung: Rung) -> None:
        if not as_json:
            click.echo(page(f"Rung {rung.number}: {rung.effect} added", (), rung.verdict))

    with stages("climbing", quiet=as_json) as told:
        heard = automatic.Heard(diagnosed=first, added=added, progress=told)
        found = automatic.climb(asked, bench, lambda at: diagnosis(asked, at, told), heard)
    if not as_json:
        click.echo(f"The climb ends: {found.ended}.\n")
        click.echo(ladders.text(found.at) if found.at.ladder.rungs else "", nl=False)
    return found.rounds[0], automatic.as_json(found)


def text(asked: Asked, bench: Bench, found: Diagnosis) -> str:
    """The page of a diagnosis."""
    named = table.title(asked.model.name, data_sets(bench))
    return page(named, table.grids(found), table.notes(found), opening=table.opening(found))


def data_sets(bench: Bench) -> tuple[str, ...]:
    """Names of the campaigns."""
    return tuple(one.measured.name for one in bench.made)


def of_asked(asked: Asked, bench: Bench) -> dict[str, Any]:
    """What was asked, as JSON."""
    return {
        "model": str(asked.model),
        "data": list(asked.data),
        "campaigns": list(data_sets(bench)),
        "hold_out": list(asked.hold_out),
        "band_hz": None if asked.band is None else list(asked.band),
        "method": asked.method,
        "candidates": list(asked.candidates),
    }


def write(found: Diagnosis, bench: Bench, whole: dict[str, Any], folder: Path, *, quiet: bool) -> None:
    """`diagnose.json` and the pictures, into `folder`; of what is left over a map of each campaign, too."""
    from validation.diagnosing.drawn import draw
    from validation.diagnosing.left import draw_left

    write_text(folder / RESULT, json_text(whole) + "\n")
    click.echo(f"massline: wrote {folder / RESULT}.", err=True)
    with percent("pictures", quiet=quiet) as told:
        paths = draw(found, folder)
        if found.leftover is not None:
            paths += draw_left(found, bench, folder, told)
    for path in paths:
        click.echo(f"massline: wrote {path}.", err=True)
