"""``massline reference``: the reference table of one or more articles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from geometry.errors import BadInput, CheckFailed
from validation.commands import options

if TYPE_CHECKING:
    from geometry.frames import Pose
    from validation.article_reference import Asked
    from validation.reference_table import ReferenceTable
    from validation.result_file import Result

FORMATS = ("text", "markdown", "csv", "latex")


@click.command("reference")
@click.argument("articles", nargs=-1, metavar="[ARTICLE ...]")
@options.JSON
@click.option(
    "--format", "form", type=click.Choice(FORMATS), default="text", metavar="FORM", help="text (default), markdown, csv or latex."
)
@click.option(
    "--out", type=click.Path(path_type=Path), metavar="FILE", help="Write there instead of on the screen, whole or not at all."
)
@click.option("--view", is_flag=True, help="Also write a picture of every article under out/.")
@click.option("--identified", metavar="RESULT", help="Result file for the identified column (see massline validate).")
@options.FRAME
@options.asked
def command(
    articles: tuple[str, ...],
    as_json: bool,
    form: str,
    out: Path | None,
    view: bool,
    identified: str | None,
    frame: str | None,
    chord: str | None,
    unit: str | None,
    material: str | None,
    settings: tuple[str, ...],
) -> None:
    """Mass, CoG and inertia of articles by three routes, beside published, measured and identified values.

    ARTICLE is a built-in part (cuboid, disc, fmd, clumod-1, clumod-4), a stack of them from bottom to top (fmd+disc+cuboid), or a
    STEP, STL, PLY, OBJ or article.toml file or folder of your own. Without any, all five built-in parts.

    Exit code 1 when the routes of an article disagree by more than their stated errors.
    """
    from validation.article_reference import DEFAULT_ARTICLES, reference_table, require_use
    from validation.frame_text import read_frame
    from validation.progress import counted

    names = list(dict.fromkeys(articles)) or list(DEFAULT_ARTICLES)
    asked = options.reading(chord, unit, material, settings)
    options.require_articles(names)
    require_use(names, asked)
    pose = None if frame is None else read_frame(frame)
    result = None if identified is None else _result(identified, names, pose)
    tables = [
        _completed(reference_table(name, asked), result, pose, frame) for name in counted(names, "three routes", quiet=as_json)
    ]
    warnings = () if result is None else result.warnings
    in_sight = form == "text" and out is None and not as_json  # the tables' footnotes say them already
    for warning in (*warnings, *(() if in_sight else _warnings(tables))):
        click.echo(f"massline: {warning}.", err=True)
    _write(_json(tables, warnings) if as_json else _text(tables, form, to_file=out is not None), out)
    if view:
        _pictures(names, asked, quiet=as_json)
    apart = [f"{table.article}: {table.agreement}" for table in tables if not table.agree]
    if apart:
        raise CheckFailed("; ".join(apart))


def _warnings(tables: Sequence[ReferenceTable]) -> tuple[str, ...]:
    """Everything noticed about the articles, each with the file that it is about."""
    pairs = [(table.article, said) for table in tables for said in table.warnings]
    return tuple(said if said.startswith(article) else f"{article}: {said}" for article, said in pairs)


def _result(identified: str, names: Sequence[str], pose: Pose | None) -> Result:
    from validation.result_file import read

    if len(names) > 1:
        raise BadInput(
            source="--identified",
            problem=f"a result is about one article, found {len(names)}",
            remedy="Name the one that was identified: massline reference ARTICLE --identified RESULT",
        )
    return read(identified, article=names[0], frame=pose)


def _completed(table: ReferenceTable, result: Result | None, pose: Pose | None, frame: str | None) -> ReferenceTable:
    """`table` in the user's frame, with the user's result."""
    from validation.reference_table import IDENTIFIED, seen

    if pose is not None:
        table = replace(
            seen(table, pose), footnotes=(*table.footnotes, f"Origin and axes: --frame {frame}, in the article's frame.")
        )
    return table if result is None else replace(table, columns={**table.columns, IDENTIFIED: result.statement})


def _json(tables: Sequence[ReferenceTable], warnings: Sequence[str]) -> str:
    from validation.output import json_text
    from validation.tables import as_json

    articles = {table.article: as_json.render(table) for table in tables}
    return json_text({"articles": articles, "warnings": list(warnings)}) + "\n"


def _text(tables: Sequence[ReferenceTable], form: str, *, to_file: bool) -> str:
    from validation.tables import comma_separated, latex, markdown, text

    if form == "csv":
        return comma_separated.render(tables)
    if form == "latex":
        return latex.document([latex.render(table) for table in tables])
    if form == "markdown":
        return "\n".join(markdown.render(table) for table in tables)
    width = text.WIDTH if to_file else None  # a file does not depend on the terminal that it was written from
    return "\n".join(text.render(table, width) for table in tables)


def _write(text: str, out: Path | None) -> None:
    from geometry.atomic import write_text

    if out is None:
        click.echo(text, nl=False)
    else:
        write_text(out, text)
        click.echo(f"massline: wrote {out}.", err=True)


def _pictures(names: Sequence[str], asked: Asked, *, quiet: bool) -> None:
    from validation.article_reference import draw
    from validation.progress import counted

    for name in counted(names, "picture", quiet=quiet):
        click.echo(f"massline: wrote {draw(name, asked)}.", err=True)
