"""`massline pretest` from options to output."""

from __future__ import annotations

from pathlib import Path

import click

from geometry.atomic import write_text
from validation.output import json_text, require_folder
from validation.pretest import as_json as written
from validation.pretest import table
from validation.pretest.asked import Question
from validation.pretest.findings import Findings, findings
from validation.progress import percent, shown
from validation.tables.text import page

RESULT = "pretest.json"


def answer(question: Question, *, as_json: bool, plot: bool, out: Path | None) -> None:
    """Find out what is asked, print it, and draw it into `out`, or into ``out/`` where only `plot` is asked for.

    Raises
    ------
    BadInput : something that was asked cannot be used.
    CheckFailed : nothing can be rendered on this machine.
    """
    if out is not None:
        require_folder(out, "--out")
    with percent(f"pretest of {question.plan.article}", quiet=as_json) as told:
        found = findings(question, told)
    if as_json:
        click.echo(json_text(written.as_json(found)))
    else:
        click.echo(page(table.title(found), table.grids(found), table.notes(found)), nl=False)
    if out is not None:
        write_text(out / RESULT, json_text(written.as_json(found)) + "\n")
        click.echo(f"massline: wrote {out / RESULT}.", err=True)
    if plot or out is not None:
        _draw(found, out or Path("out"), quiet=as_json)


def _draw(found: Findings, folder: Path, *, quiet: bool) -> None:
    from validation.pretest.drawn import draw

    with shown(f"pictures of {found.question.plan.article}", quiet=quiet):
        paths = draw(found, folder)
    for path in paths:
        click.echo(f"massline: wrote {path}.", err=True)
