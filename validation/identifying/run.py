"""`massline identify` from options to output: read, identify, show."""

from __future__ import annotations

from pathlib import Path

import click

from geometry.atomic import write_text
from geometry.consistency import judge
from geometry.errors import CheckFailed
from identification.identify import identify
from identification.quality import impossible
from validation.frame_text import read_frame
from validation.identifying import as_json as written
from validation.identifying import table
from validation.identifying.asked import Asked, ready
from validation.identifying.band import studied
from validation.identifying.findings import Findings
from validation.identifying.gathered import gathered
from validation.output import json_text
from validation.progress import percent, shown, stages
from validation.tables.text import page

RESULT = "identify.json"
"""The file of a result in its folder."""


def answer(asked: Asked, frame: str | None, *, as_json: bool, folder: Path | None, keep: bool) -> None:
    """Identify what is `asked`, print it, and draw it into `folder` (None: nowhere); `keep` writes the JSON there, too.

    Raises
    ------
    BadInput : something that was asked cannot be used.
    CheckFailed : no body can have what comes out; raised when everything is printed.
    """
    found = identified(asked, frame, quiet=as_json)
    if as_json:
        click.echo(json_text(written.as_json(found)))
    else:
        click.echo(page(table.title(found), table.grids(found), table.notes(found)), nl=False)
    if folder is not None:
        _write(found, folder, keep=keep, quiet=as_json)
    if impossible(found.result.quality):
        raise CheckFailed(_impossible(found))


def _impossible(found: Findings) -> str:
    said = f"no body can have the {found.result.identified.way} result: {judge(found.result.inertia).text}"
    if found.request.modes == 0:
        return f"{said}. The article was taken for rigid: allow for elastic terms, --modes auto"
    return f"{said}. Look at the checks on the page, and drive the sweeps lower or at a higher level"


def identified(asked: Asked, frame: str | None = None, *, quiet: bool = True) -> Findings:
    """The findings that `asked` leads to, reported in `frame`, the user's own seen from the article's.

    Raises
    ------
    BadInput : something that was asked cannot be used.
    CheckFailed : an estimate that does not settle, or without positive mass.
    """
    pose = None if frame is None else read_frame(frame)
    with stages("reading", quiet=quiet) as told:
        made = ready(asked, told)
    with percent(f"identifying {made.request.campaign.article}", quiet=quiet) as share:
        found = identify(made.request, share)
    if not made.request.study:
        return gathered(made, found, pose)
    with percent("band study", quiet=quiet) as share:
        of = studied(found, share)
    return gathered(made, found, pose, of)


def _write(found: Findings, folder: Path, *, keep: bool, quiet: bool) -> None:
    from validation.identifying.drawn import draw

    if keep:
        write_text(folder / RESULT, json_text(written.as_json(found)) + "\n")
        click.echo(f"massline: wrote {folder / RESULT}.", err=True)
    with shown(f"pictures of {found.article}", quiet=quiet):
        paths = draw(found, folder)
    for path in paths:
        click.echo(f"massline: wrote {path}.", err=True)
