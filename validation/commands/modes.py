"""`massline modes`: eigenfrequencies, damping and effective masses of an article, and its mode shapes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from validation.commands import options

if TYPE_CHECKING:
    from validation.flexible.mode_comparison import Comparison
    from validation.flexible.model import Flexible


@click.command("modes")
@click.argument("article")
@options.JSON
@options.flexible
@click.option("--against", metavar="MODEL", help="Set another model of the same article beside it: frequencies, MAC, masses.")
@click.option("--count", type=int, default=20, show_default=True, metavar="N", help="How many modes.")
@click.option("--shapes", is_flag=True, help="Also draw the first 11 modes on one sheet under out/.")
@click.option("--mode", "moving", type=int, metavar="N", help="Also write mode N moving: a GIF and an animated glTF under out/.")
def command(
    article: str,
    as_json: bool,
    model: str | None,
    against: str | None,
    count: int,
    shapes: bool,
    moving: int | None,
    **asked: Any,
) -> None:
    """Eigenfrequencies of ARTICLE with its base held, damping, effective masses about its origin, and what moves in each mode.

    ARTICLE is a built-in part or a stack of them (clumod-4, fmd+clumod-1), a STEP file or article.toml of your own (solid
    model), or your own FE model (.h5, .npz, .op4 ... or its .toml), which may stand beside a built-in one too: --against FILE.
    """
    from validation.flexible.chosen import chosen
    from validation.flexible.model import flexible, require_model, require_used
    from validation.flexible.shapes import require_drawable, require_mode
    from validation.progress import shown

    models = chosen(article, model, against)
    names = [require_model(article, m, option) for m, option in zip(models, ("--model", "--against"), strict=False)]
    question = options.flexible_asked(count=count, counted="--count", **asked)
    require_used(article, names, question)
    if shapes or moving is not None:
        require_drawable(article, names[0])
    if moving is not None:
        require_mode(moving, count)
    found = []
    for name, which in zip(names, models, strict=True):
        with shown(f"modes of {article}, {name} model", quiet=as_json):
            found.append(flexible(article, which, question))
    _print(found[0], _compared(found), as_json)
    if shapes or moving is not None:
        _draw(found[0], shapes, moving, quiet=as_json)


def _compared(found: list[Flexible]) -> Comparison | None:
    from validation.flexible.mode_comparison import compared

    return compared(found[0], found[1]) if len(found) == 2 else None


def _print(model: Flexible, comparison: Comparison | None, as_json: bool) -> None:
    from validation.flexible import comparison_table, modes_table
    from validation.output import print_json
    from validation.tables.text import page

    if as_json:
        beside = {} if comparison is None else {"against": comparison_table.as_json(comparison)}
        print_json(modes_table.as_json(model) | beside)
        return
    printed = modes_table.published(model)
    grids = [modes_table.grid(model), *([printed] if printed else [])]
    click.echo(page(f"{model.article}: {model.model} model", grids, modes_table.notes(model)), nl=False)
    if comparison is not None:
        title = f"{model.article}: {comparison.second.model} beside {model.model}"
        click.echo("\n" + page(title, comparison_table.grids(comparison), comparison_table.notes(comparison)), nl=False)


def _draw(model: Flexible, shapes: bool, moving: int | None, *, quiet: bool) -> None:
    from validation.flexible.shapes import draw_moving, draw_sheet
    from validation.progress import shown

    folder = Path("out")
    with shown(f"shapes of {model.article}", quiet=quiet):
        written = [draw_sheet(model, folder)] if shapes else []
        written += draw_moving(model, moving, folder) if moving is not None else []
    for path in written:
        click.echo(f"massline: wrote {path}.", err=True)
