"""`massline modes`: eigenfrequencies, damping and effective masses of an article, and its mode shapes."""

from __future__ import annotations

from typing import Any

import click

from validation.commands import options


@click.command("modes")
@click.argument("article")
@options.JSON
@click.option("--count", type=int, default=20, show_default=True, metavar="N", help="How many modes.")
@options.flexible
def command(article: str, as_json: bool, model: str, count: int, **asked: Any) -> None:
    """Eigenfrequencies of ARTICLE with its base held, damping, effective masses about its origin, and what moves in each mode."""
    from validation.flexible import modes_table
    from validation.flexible.model import flexible
    from validation.output import print_json
    from validation.progress import shown
    from validation.tables.text import page

    with shown(f"modes of {article}, {model} model", quiet=as_json):
        found = flexible(article, model, options.flexible_asked(count=count, **asked))
    if as_json:
        print_json(modes_table.as_json(found))
        return
    printed = modes_table.published(found)
    grids = [modes_table.grid(found), *([printed] if printed else [])]
    click.echo(page(f"{article}: {found.model} model", grids, modes_table.notes(found)), nl=False)
