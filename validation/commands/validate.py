"""``massline validate``: anyone's identified ten parameters against the reference, row by row."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from geometry.errors import CheckFailed
from validation.commands import options

if TYPE_CHECKING:
    from validation.cross_check import CrossCheck
    from validation.statement import Statement

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
def command(
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
    from validation.article_reference import changes_note, reference, require_use
    from validation.cross_check import cross_check, summary
    from validation.frame_text import read_frame
    from validation.progress import shown
    from validation.reference_table import IDENTIFIED
    from validation.result_file import read

    options.require_articles([article])
    pose = None if frame is None else read_frame(frame)
    said = read(result, article=article, frame=pose)
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
    from validation.reference_table import ReferenceTable
    from validation.tables import text

    odd = [f"Not stated by the result: {', '.join(check.not_stated)}."] if check.not_stated else []
    odd += [f"Nothing to hold against: {', '.join(check.not_known)}."] if check.not_known else []
    odd += [f"{check.physics[0].upper()}{check.physics[1:]}.", *(f"{words}." for words in warnings)]
    click.echo(text.render(ReferenceTable(article=title, columns=columns, footnotes=tuple(odd))))


def _print_json(check: CrossCheck, words: str, more: dict[str, Any]) -> None:
    from validation.output import print_json
    from validation.rows import rows_json

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
