"""The run of `massline excite`: ask, drive, write files and pictures run by run, and print what came of it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import click

from validation.excitation import signals
from validation.excitation.asked import Question
from validation.excitation.runs import Done, Ready, done, ready
from validation.progress import shown

FOLDER = Path("out")


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """What is wanted of the runs beside their figures.

    Attributes
    ----------
    out : file for the signals; one for each run where there are several
    plot, animate : pictures
    as_json : one object instead of tables, and no progress
    """

    out: Path | None
    plot: bool
    animate: bool
    as_json: bool


def excite(question: Question, wanted: Wanted) -> None:
    """Answer `question`, write what is `wanted`, and print.

    Raises
    ------
    BadInput : something in `question` cannot be, a file that cannot be written so; before anything is computed.
    CheckFailed : a route failed.
    """
    from validation.excitation import as_json, table
    from validation.output import print_json

    _require_writable(wanted)
    made = ready(question, quiet=wanted.as_json)
    if wanted.animate:
        from validation.excitation.moving import require_animable

        require_animable(made)
    outcomes, files = [], []
    for one in done(made, keep_coordinates=wanted.animate, quiet=wanted.as_json):
        files.append(_written(made, one, wanted))
        outcomes.append(one.outcome)
        for warning in one.outcome.warnings:
            click.echo(f"massline: {one.run.name}: {warning}", err=True)
    if wanted.as_json:
        print_json(as_json.of(made, outcomes, files))
    else:
        click.echo(table.page_of(made, outcomes), nl=False)
    for path in (path for paths in files for path in paths):
        click.echo(f"massline: wrote {path}.", err=True)


def _require_writable(wanted: Wanted) -> None:
    from validation.output import require_file, require_folder

    if wanted.out is not None:
        signals.require_ending(wanted.out)
        require_file(wanted.out, "--out")
    for option, drawn in (("--plot", wanted.plot), ("--animate", wanted.animate)):
        if drawn:
            require_folder(FOLDER, option)


def _written(made: Ready, one: Done, wanted: Wanted) -> list[Path]:
    """The files of one run."""
    written: list[Path] = []
    if wanted.out is not None:
        path = wanted.out if len(made.runs) == 1 else wanted.out.with_stem(f"{wanted.out.stem}-{one.run.name}")
        with shown(f"{one.run.name}: writing {path}", quiet=wanted.as_json):
            signals.write(path, one.response, f"{made.question.article}: {one.run.pattern.label}")
        written.append(path)
    if wanted.plot:
        from validation.excitation.plots import draw

        with shown(f"{one.run.name}: drawing", quiet=wanted.as_json):
            written.append(draw(made, one, FOLDER))
    if wanted.animate:
        from validation.excitation.moving import animate

        with shown(f"{one.run.name}: drawing the passage of a resonance", quiet=wanted.as_json):
            moving = animate(made, one, FOLDER)
        if moving is None:
            click.echo(f"massline: {one.run.name}: no resonance was passed, and nothing is animated.", err=True)
        else:
            written.append(moving)
    return written
