"""`massline model`: a commented model file to start from."""

from __future__ import annotations

from pathlib import Path

import click

from validation.commands import options


@click.command("model")
@click.argument("article", metavar="ARTICLE")
@click.option("--out", type=click.Path(path_type=Path), metavar="FILE", help="Write it there instead of to standard output.")
@click.option("--force", is_flag=True, help="Replace FILE if it is there.")
@options.effects_from
def command(article: str, out: Path | None, force: bool) -> None:
    """Write a commented model file for ARTICLE: laboratory, structure, tolerances, and place for effects.

    ARTICLE is a built-in stack on the force measurement device, such as fmd+clumod-1; a file of your own - FE model, STEP or
    mesh - which is put on it; or a model file, which is checked and written anew. docs/model-file.md explains every key.
    """
    from validation.models.command import model

    model(article, out, force=force)
