"""`massline simulate`: a virtual test on the shaker, a campaign folder with its truth beside it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from validation.commands import options


@click.command("simulate")
@click.argument("articles", nargs=-1, required=True, metavar="ARTICLE ...")
@options.JSON
@click.option("--out", type=click.Path(path_type=Path), required=True, metavar="DIR", help="The new campaign folder.")
@click.option(
    "--effect", "effects", multiple=True, metavar="ID=VALUE", help="Plant an effect: force-gain:fmd-z2=0.08, polarity:fmd-z1."
)
@click.option(
    "--list-effects",
    is_flag=True,
    expose_value=False,
    callback=lambda ctx, _, asked: _list(ctx, asked),
    help="List the effects that can be planted, and stop.",
)
@options.effects_from
@click.option(
    "--seed", type=int, default=0, show_default=True, metavar="N", help="Of all that is drawn; one seed is one laboratory."
)
@click.option(
    "--levels", default="1", show_default=True, metavar="L,L", help="Factors on the nominal level: 1,0.5 drives all runs twice."
)
@click.option(
    "--sealed",
    type=click.Path(path_type=Path),
    metavar="PATH",
    help="Where the truth goes, instead of beside DIR; nothing of it is shown.",
)
@click.option(
    "--pattern",
    default="sweep",
    show_default=True,
    metavar="PATTERN",
    help="sweep, diagonal (and six of two axes at once) or multi (six at once).",
)
@click.option("--runs", type=int, metavar="N", help="12 sweeps instead of 6, the others a quarter period later.")
@click.option("--band", nargs=2, type=float, default=(4.0, 32.0), show_default=True, metavar="LO HI", help="Frequencies [Hz].")
@click.option("--octaves-per-minute", type=float, default=2.0, show_default=True, metavar="RATE", help="Rate of the sweeps.")
@click.option("--cross", type=float, default=0.03, show_default=True, metavar="SHARE", help="Cross motion of the table.")
@click.option(
    "--tolerances",
    default="1",
    show_default=True,
    metavar="FACTOR",
    help="On the ordinary tolerances of laboratory and structure, or off.",
)
@click.option("--noise", default="1", show_default=True, metavar="FACTOR", help="On the ordinary noise of the channels, or off.")
@click.option("--mains", default="1", show_default=True, metavar="FACTOR", help="On the ordinary hum of the mains, or off.")
@click.option(
    "--model", default="beam", show_default=True, metavar="MODEL", help="beam, or rigid for an article that does not give."
)
@click.option(
    "--damping", "damping_ratio", type=float, metavar="RATIO", help="Damping ratio of every mode, instead of the model's own."
)
@click.option("--rate", type=float, default=564.0, show_default=True, metavar="HZ", help="Sampling rate of the records.")
@click.option(
    "--format", "form", default="h5", show_default=True, metavar="FORMAT", help="Of the signal files: h5, uff, csv or mat."
)
@click.option(
    "--unit", "units", multiple=True, metavar="UNIT", help="Of the signal files where it is not SI: g, kN ... May be repeated."
)
@options.SET
def command(articles: tuple[str, ...], out: Path, as_json: bool, **given: Any) -> None:
    """Simulate ARTICLE on the multi-axis shaker, as six sweeps would have recorded it: 22 channels, tolerances, noise, hum.

    ARTICLE is a stack on the force measurement device, such as fmd+disc+cuboid or fmd+clumod-1. Several are a series that
    shares FMD and sensors, a folder each below DIR; so are tests of one seed. The truth goes beside a campaign, DIR.truth.json.
    """
    from validation.virtual_test.asked import question
    from validation.virtual_test.command import simulate

    simulate(question(articles=articles, out=out, **given), as_json=as_json)


def _list(ctx: click.Context, asked: bool) -> None:
    """Answer ``--list-effects`` before ARTICLE and --out are missed, and after ``--effects-from``."""
    if not asked:
        return
    from validation.virtual_test.effects.listed import page_of_effects

    click.echo(page_of_effects(), nl=False)
    ctx.exit()
