"""`massline pretest`: before a test, what it would tell, and where pick-ups belong."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from validation.commands import options


@click.command("pretest")
@click.argument("article")
@options.JSON
@click.option("--tare", default="fmd+disc+cuboid", show_default=True, metavar="ARTICLE", help="Of known inertia, or none.")
@click.option("--sensors", type=click.Path(path_type=Path), metavar="CAMPAIGN", help="Channels of a campaign.toml of your own.")
@click.option("--pattern", default="sweep", show_default=True, metavar="PATTERN", help="sweep, diagonal or multi.")
@click.option("--runs", type=int, metavar="N", help="12 sweeps instead of 6, the others a quarter period later.")
@click.option("--level", type=float, default=1.0, show_default=True, metavar="L", help="Factor on the nominal level.")
@click.option("--band", nargs=2, type=float, default=(4.0, 32.0), show_default=True, metavar="LO HI", help="Frequencies [Hz].")
@click.option("--octaves-per-minute", type=float, default=2.0, show_default=True, metavar="RATE", help="Rate of the sweeps.")
@click.option("--cross", type=float, default=0.03, show_default=True, metavar="SHARE", help="Cross motion of the table.")
@click.option("--seed", type=int, default=0, show_default=True, metavar="N", help="Of the cross motion.")
@click.option(
    "--tolerance",
    "tolerances",
    multiple=True,
    metavar="KEY=VALUE",
    help="Of the laboratory, one standard deviation: gain=0.2%, angle=0.2deg. May be repeated.",
)
@click.option("--noise", default="1", show_default=True, metavar="FACTOR", help="On the noise of the channels, or off.")
@click.option("--damping", "damping_ratio", type=float, metavar="RATIO", help="Of every mode, instead of the model's own.")
@click.option(
    "--condition-limit", type=float, default=100.0, show_default=True, metavar="C", help="Above it a line is of no use."
)
@click.option(
    "--rigid", "rigid_percent", type=float, default=1.0, show_default=True, metavar="PERCENT", help="Elastic motion allowed."
)
@click.option("--lost/--no-lost", default=True, show_default=True, help="Leave out every channel in turn.")
@click.option("--plot", is_flag=True, help="Draw it, under out/.")
@click.option("--out", type=click.Path(path_type=Path), metavar="DIR", help="A folder for the JSON and the pictures.")
@options.SET
def command(article: str, as_json: bool, plot: bool, out: Path | None, **given: Any) -> None:
    """Say what six sweeps of ARTICLE on the force measurement device would tell, before anything is mounted.

    ARTICLE is a stack of built-in parts, such as clumod-1 or fmd+clumod-1. Condition number of the planned base motions, expected
    95 % intervals of mass, CoG and inertia by both ways of identification, what dominates them, what the loss of each
    channel costs, and where on the article a pick-up moves with the base.
    """
    from validation.pretest.asked import question
    from validation.pretest.run import answer

    answer(question(article=article, **given), as_json=as_json, plot=plot, out=out)
