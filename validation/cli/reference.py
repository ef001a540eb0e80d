"""Commands about articles and classical measurements: reference, validate, weigh, cog, pendulum."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from geometry.errors import BadInput, CheckFailed
from validation.cli import options

if TYPE_CHECKING:
    from geometry.frames import Pose
    from validation.reference.reference import ArticleOptions, CrossCheck, ReferenceTable, StatedResult
    from validation.reference.statement import Statement


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
def reference_command(
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
    from validation.output import counted
    from validation.reference.reference import DEFAULT_ARTICLES, reference_table, require_use
    from validation.reference.statement import read_frame

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


def _result(identified: str, names: Sequence[str], pose: Pose | None) -> StatedResult:
    from validation.reference.reference import read_result

    if len(names) > 1:
        raise BadInput(
            source="--identified",
            problem=f"a result is about one article, found {len(names)}",
            remedy="Name the one that was identified: massline reference ARTICLE --identified RESULT",
        )
    return read_result(identified, article=names[0], frame=pose)


def _completed(table: ReferenceTable, result: StatedResult | None, pose: Pose | None, frame: str | None) -> ReferenceTable:
    """`table` in the user's frame, with the user's result."""
    from validation.reference.reference import IDENTIFIED, seen

    if pose is not None:
        table = replace(
            seen(table, pose), footnotes=(*table.footnotes, f"Origin and axes: --frame {frame}, in the article's frame.")
        )
    return table if result is None else replace(table, columns={**table.columns, IDENTIFIED: result.statement})


def _json(tables: Sequence[ReferenceTable], warnings: Sequence[str]) -> str:
    from validation.output import json_text
    from validation.report import reference

    articles = {table.article: reference.render(table) for table in tables}
    return json_text({"articles": articles, "warnings": list(warnings)}) + "\n"


def _text(tables: Sequence[ReferenceTable], form: str, *, to_file: bool) -> str:
    from validation.report import document

    if form == "csv":
        return document.render(tables)
    if form == "latex":
        return document.document([document.latex_render(table) for table in tables])
    if form == "markdown":
        return "\n".join(document.markdown_render(table) for table in tables)
    width = document.WIDTH if to_file else None  # a file does not depend on the terminal that it was written from
    return "\n".join(document.text_render(table, width) for table in tables)


def _write(text: str, out: Path | None) -> None:
    from geometry.atomic import write_text

    if out is None:
        click.echo(text, nl=False)
    else:
        write_text(out, text)
        click.echo(f"massline: wrote {out}.", err=True)


def _pictures(names: Sequence[str], asked: ArticleOptions, *, quiet: bool) -> None:
    from validation.output import counted
    from validation.report.reference import draw

    for name in counted(names, "picture", quiet=quiet):
        click.echo(f"massline: wrote {draw(name, asked)}.", err=True)


# `massline cog`: CoG height by crane and balance.


@click.command("cog")
@options.measurement
def cog_command(file: str, against: str | None, as_json: bool) -> None:
    """Reduce the crane-and-balance test in FILE: CoG height with its tolerance, itemised.

    FILE is a path or the name of a file that ships with massline, for example clumod-4-cog.
    """
    from validation.classical import weigh
    from validation.classical.files import readings_or_results
    from validation.report.reference import show

    show(readings_or_results(file, "crane-cog", weigh.reduce_cog, ("cog_x", "cog_y", "cog_z")), against, as_json)


# `massline pendulum`: moments of inertia from pendulum periods.


@click.command("pendulum")
@options.measurement
@click.option("--without", "off", multiple=True, metavar="TERM", help="Leave out a correction: amplitude, damping or rope-mass.")
def pendulum_command(file: str, against: str | None, off: tuple[str, ...], as_json: bool) -> None:
    """Reduce the pendulum periods in FILE: moments of inertia with tolerance, itemised.

    FILE is a path or the name of a file that ships with massline, for example clumod-4-pendulum.

    Exit code 1 when no body can have the moments that come out.
    """
    from functools import partial

    from validation.classical import pendulum
    from validation.classical.files import readings_or_results
    from validation.classical.pendulum import require_terms
    from validation.report.reference import show

    reduce = partial(pendulum.reduce, off=require_terms(off))
    show(readings_or_results(file, "pendulum", reduce, ("Ixx", "Iyy", "Izz")), against, as_json)


# ``massline validate``: anyone's identified ten parameters against the reference, row by row.


REFERENCES = ("occ", "trimesh", "pinocchio", "published", "measured")


@click.command("validate")
@click.argument("result", metavar="RESULT")
@click.option("--against", "article", metavar="ARTICLE", required=True, help="The article that RESULT is about.")
@click.option(
    "--reference",
    "choice",
    type=click.Choice(REFERENCES),
    metavar="COLUMN",
    help="What RESULT is held against: a route (occ, the default; trimesh, the default for a mesh; or pinocchio), or what is "
    "published or measured. A route counts as no more certain than the published values.",
)
@options.JSON
@options.FRAME
@options.asked
def validate_command(
    result: str,
    article: str,
    choice: str | None,
    as_json: bool,
    frame: str | None,
    chord: str | None,
    unit: str | None,
    material: str | None,
    settings: tuple[str, ...],
) -> None:
    """Anyone's identified ten parameters against the reference of ARTICLE.

    RESULT is a TOML or JSON file as in docs/reference-tables.md, any INERTIA that --json prints, or clumod-1-table2, the paper's
    own. It states its reference point, sign of products and frame. Rows are printed in --frame, which is also the frame of a
    RESULT that states none.

    Exit code 0 when every stated value lies within the combined tolerance of result and reference; 1 when one does not, or when
    no body can have these parameters.
    """
    from geometry.frames import Pose
    from validation.output import shown
    from validation.reference.reference import (
        IDENTIFIED,
        changes_note,
        cross_check,
        read_result,
        reference,
        require_use,
        summary,
    )
    from validation.reference.statement import read_frame

    options.require_articles([article])
    pose = None if frame is None else read_frame(frame)
    said = read_result(result, article=article, frame=pose)
    asked = options.reading(chord, unit, material, settings)
    require_use([article], asked)
    with shown(f"reference of {article}", quiet=as_json):
        chosen, known = reference(article, choice, asked, pose or Pose())
    check = cross_check(said.statement, known)
    words = summary(check, f"{article} ({chosen})")
    note = changes_note(article, asked)
    if as_json:
        tolerances = {"result": said.statement.tolerance_note, "reference": known.tolerance_note}
        more = {
            "article": article,
            "reference": chosen,
            "tolerance_note": tolerances,
            "warnings": said.warnings,
            "changes": asked.changes,
        }
        _print_json(check, words, more)
    else:
        _print(
            f"{said.statement.source} against {article} ({chosen})",
            {chosen: known, IDENTIFIED: said.statement},
            check,
            [note.removesuffix("."), *said.warnings] if note else said.warnings,
        )
    if not check.passed:
        raise CheckFailed(words)
    if not as_json:
        click.echo(f"{words}.")


def _print(title: str, columns: dict[str, Statement], check: CrossCheck, warnings: Sequence[str]) -> None:
    from validation.reference.reference import ReferenceTable
    from validation.report import document

    odd = [f"Not stated by the result: {', '.join(check.not_stated)}."] if check.not_stated else []
    odd += [f"Nothing to hold against: {', '.join(check.not_known)}."] if check.not_known else []
    odd += [f"{check.physics[0].upper()}{check.physics[1:]}.", *(f"{words}." for words in warnings)]
    click.echo(document.text_render(ReferenceTable(article=title, columns=columns, footnotes=tuple(odd))))


def _print_json(check: CrossCheck, words: str, more: dict[str, Any]) -> None:
    from validation.output import print_json
    from validation.reference.statement import rows_json

    print_json(
        {
            "rows": [{**line, "deviation": row.deviation} for row in check.rows for line in rows_json([row])],
            "passed": check.passed,
            "text": words,
            "physical": check.physical,
            "physics": check.physics,
            "not_stated": list(check.not_stated),
            "not_known": list(check.not_known),
            **more,
        }
    )


# `massline weigh`: mass from readings of a balance.


@click.command("weigh")
@options.measurement
def weigh_command(file: str, against: str | None, as_json: bool) -> None:
    """Reduce the weighing in FILE: mass with its tolerance, itemised.

    FILE is a path or the name of a file that ships with massline, for example clumod-4-weighing.
    """
    from validation.classical import weigh
    from validation.classical.files import readings_or_results
    from validation.report.reference import show

    show(readings_or_results(file, "weighing", weigh.reduce, ("mass",)), against, as_json)
