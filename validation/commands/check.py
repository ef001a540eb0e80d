"""`massline check`: what is in a campaign folder, and what is wrong with it."""

from __future__ import annotations

from pathlib import Path

import click

from validation.commands import options


@click.command("check")
@click.argument("campaign")
@options.JSON
@click.option("--view", is_flag=True, help="Also draw pick-ups and load cells on the article, under out/.")
@click.option("--quick", is_flag=True, help="Do not hold the channels against each other, which takes spectra of every run.")
@click.pass_context
def command(ctx: click.Context, campaign: str, as_json: bool, view: bool, quick: bool) -> None:
    """What the folder CAMPAIGN holds: channels, runs, levels, noise, which motions and forces can be told. And all that is wrong,
    a channel with a wrong sign, a wrong unit or the plug of another among it: redundant channels must agree, and so must the
    dynamic mass with that of a body.

    Exit code 0 when nothing is wrong, 1 when the data can be used but there are warnings to read, 2 when they cannot be used as
    they are.
    """
    from validation.campaigns import summary_json, summary_table
    from validation.campaigns.summary import summary
    from validation.cli import BAD_INPUT, FAILED_CHECK
    from validation.output import print_json
    from validation.progress import shown
    from validation.tables.text import page

    with shown(f"reading and checking {campaign}", quiet=as_json):
        found = summary(campaign, closed=not quick)
    if found.campaign is None and len(found.problems) == 1:
        raise found.problems[0]
    if as_json:
        print_json(summary_json.as_json(found))
    else:
        click.echo(page(summary_table.title(found), summary_table.grids(found), summary_table.notes(found)), nl=False)
    if view and found.campaign is not None:
        from validation.campaigns.sensor_map import draw

        with shown(f"sensor map of {campaign}", quiet=as_json):
            path = draw(found.campaign, Path("out"))
        click.echo(f"massline: wrote {path}.", err=True)
    if not found.usable:
        ctx.exit(BAD_INPUT)
    if found.warnings:
        ctx.exit(FAILED_CHECK)
