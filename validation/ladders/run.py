"""`massline add`, `massline ladder` and `massline undo` from options to output."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from geometry.errors import BadInput
from validation.ladders import as_json as written
from validation.ladders import file, table
from validation.ladders.climbing import Standing, gone_to, standing, undone
from validation.output import json_text
from validation.progress import shown, stages
from validation.tables.text import page

if TYPE_CHECKING:
    from validation.ladders.adding import Asked


def add(asked: Asked, *, as_json: bool) -> None:
    """Add what is `asked`, and print the errors before and after.

    Raises
    ------
    BadInput : something that was asked cannot be used.
    CheckFailed : a fit of the model as it was does not converge.
    """
    from validation.ladders.adding import added
    from validation.ladders.verdict import sentence

    with stages(f"adding {asked.effect}", quiet=as_json) as told:
        step = added(asked, told)
    if as_json:
        click.echo(json_text(written.of_step(step.at, step.before, step.after, step.said)))
        return
    title = f"{asked.model.name}: {step.after.effect} added, rung {step.after.number} on rung {step.before.number}"
    click.echo(page(title, table.of_step(step.before, step.after), (*step.after.verdict, *map(sentence, step.said))), nl=False)


def ladder(path: Path, *, go: int | None, as_json: bool, folder: Path | None) -> None:
    """Print the ladder of the model at `path`, and draw it into `folder` (None: nowhere); after going to the rung `go`.

    Raises
    ------
    BadInput : there is no ladder, or none that can be read; no such rung.
    OSError : a file cannot be written.
    """
    at = standing(path)
    if go is not None:
        at = gone_to(at, go)
    _show(at, as_json=as_json)
    if folder is not None:
        _draw(at, folder, quiet=as_json)


def undo(path: Path, *, as_json: bool) -> None:
    """Put the model at `path` on the parent of its rung.

    Raises
    ------
    BadInput : there is no ladder, or nothing below.
    OSError : a file cannot be written.
    """
    _show(undone(standing(path)), as_json=as_json)


def _show(at: Standing, *, as_json: bool) -> None:
    if not at.ladder.rungs:
        problem = f"it has no ladder: there is no {file.beside(at.path).name} beside it"
        raise BadInput(source=str(at.path), problem=problem, remedy="`massline add MODEL EFFECT DATA ...` makes one")
    click.echo(json_text(written.of_ladder(at)) if as_json else text(at), nl=as_json)


def text(at: Standing) -> str:
    """The page of a ladder."""
    rungs = f"{len(at.ladder.rungs)} rung{'s' if len(at.ladder.rungs) > 1 else ''}"
    where = "edited by hand since" if at.rung is None else f"it stands on rung {at.rung.number}"
    return page(f"{at.path.name}: {rungs}, {where}", table.of_ladder(at), table.notes(at))


def _draw(at: Standing, folder: Path, *, quiet: bool) -> None:
    from validation.ladders.drawn import draw

    with shown(f"pictures of {at.path.name}", quiet=quiet):
        paths = draw(at, folder)
    for path in paths:
        click.echo(f"massline: wrote {path}.", err=True)
