"""`massline dynamic-mass`: the blocked 6x6 dynamic mass of an article over frequency."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from validation.commands import options


@click.command("dynamic-mass")
@click.argument("article")
@options.JSON
@options.flexible
@click.option("--against", metavar="MODEL", help="Set another model of the same article beside it.")
@click.option("--band", nargs=2, type=float, default=(4.0, 32.0), show_default=True, metavar="LO HI", help="Frequencies [Hz].")
@click.option("--step", type=float, default=0.05, show_default=True, metavar="HZ", help="Distance of two lines.")
@click.option("--modes", "count", type=int, default=30, show_default=True, metavar="N", help="How many modes to keep.")
@click.option(
    "--about", default="article", show_default=True, metavar="POINT", help='F, article (its origin) or a point, "0 0 45 mm".'
)
@click.option("--plot", is_flag=True, help="Also draw diagonal and full 6x6 grid under out/.")
@click.option("--out", type=click.Path(path_type=Path), metavar="FILE", help="Also write all entries to a .csv or .npz file.")
def command(
    article: str,
    as_json: bool,
    model: str | None,
    against: str | None,
    band: tuple[float, float],
    step: float,
    count: int,
    about: str,
    plot: bool,
    out: Path | None,
    **asked: Any,
) -> None:
    """The blocked dynamic mass of ARTICLE: loads of the table on it for unit base acceleration, all six axes prescribed.

    A rigid body has the flat line of its mass matrix; flexible ones leave it at their resonances.
    """
    from validation.flexible import curves_file
    from validation.flexible.chosen import chosen
    from validation.flexible.curves import Question, curves, report

    if out is not None:
        curves_file.require_ending(out)
    question = Question(
        article=article,
        models=chosen(article, model, against),
        band=band,
        step=step,
        about=about,
        asked=options.flexible_asked(count=count, counted="--modes", **asked),
    )
    found = curves(question, quiet=as_json)
    for warning in found.warnings:
        click.echo(f"massline: {warning}.", err=True)
    report(found, as_json=as_json)
    if out is not None:
        curves_file.write(out, found.masses[0], article)
        click.echo(f"massline: wrote {out}.", err=True)
    if plot:
        from validation.flexible.plots import draw

        for path in draw(found, Path("out")):
            click.echo(f"massline: wrote {path}.", err=True)
