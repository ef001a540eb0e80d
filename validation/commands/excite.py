"""`massline excite`: an article on a table that is driven in time; loads, load cells and resonances passed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from validation.commands import options


@click.command("excite")
@click.argument("article")
@options.JSON
@options.flexible
@click.option(
    "--axis", "axes", multiple=True, metavar="AXIS", help="x, y, z, alpha, beta or gamma. May be repeated.  [default: x]"
)
@click.option("--all", "every", is_flag=True, help="All six axes, a run each.")
@click.option("--pattern", default="sweep", show_default=True, metavar="PATTERN", help="sweep, random, burst or multi.")
@click.option("--band", nargs=2, type=float, default=(4.0, 32.0), show_default=True, metavar="LO HI", help="Frequencies [Hz].")
@click.option("--octaves-per-minute", type=float, default=2.0, show_default=True, metavar="RATE", help="Rate of a sweep.")
@click.option("--duration", metavar="TIME", help='Of random (90 s) and burst (4 s), for example "30 s".')
@click.option("--level", type=float, default=1.0, show_default=True, metavar="FACTOR", help="On the nominal level of each axis.")
@click.option("--cross", type=float, default=0.03, show_default=True, metavar="SHARE", help="Cross motion of the table.")
@click.option("--seed", type=int, default=0, show_default=True, metavar="N", help="Of cross motion, noise and bursts.")
@click.option("--ring-down", default="auto", show_default=True, metavar="TIME", help='Record after the drive: auto, or "5 s".')
@click.option(
    "--route", metavar="ROUTE", help="linear, exudyn or large (a base that really turns).  [default: what the rig needs]"
)
@click.option("--rate", type=float, default=1024.0, show_default=True, metavar="HZ", help="Sampling rate of the result.")
@click.option(
    "--modes", "count", type=int, metavar="N", help="How many modes to keep.  [default: 30, of those that the step follows]"
)
@click.option(
    "--preload", multiple=True, metavar="FORCE", help='Of the cells, which then lift off: "2 kN", or "3=500 N" for one.'
)
@click.option("--flange", multiple=True, metavar="KEY=VALUE", help="Compliance: lateral, vertical, rotation, torsion=1e-6.")
@click.option("--friction", multiple=True, metavar="AXIS=N", help="A loose part on the flange: x=3 N, or x=3,mass:2.")
@click.option("--cable", multiple=True, metavar="LOC=K", help="Spring to the ground: mast-top=1000, mast-top:lateral=1000 N/m.")
@click.option("--damper", multiple=True, metavar="LOC=C", help="Damper to the table: mast-top=20 N s/m.")
@click.option("--out", type=click.Path(path_type=Path), metavar="FILE", help="Also write signals: .uff, .h5, .csv, .mat or .npz.")
@click.option("--plot", is_flag=True, help="Also draw loads over time and over frequency under out/.")
@click.option("--animate", is_flag=True, help="Also draw the article passing its largest resonance, a GIF under out/.")
def command(article: str, as_json: bool, model: str | None, out: Path | None, plot: bool, animate: bool, **given: Any) -> None:
    """Drive the base of ARTICLE in time, and record the loads of the table on it, its load cells and its resonances.

    ARTICLE is a built-in part or a stack of them (clumod-1, fmd+clumod-1), a STEP file of your own (--model solid) or your own FE
    model (.h5, .npz, .op4 ... or its .toml). Nominal levels are 2.5 m/s² along x, y, z, 3 rad/s² about x, y and 6 rad/s² about z.
    """
    from validation.excitation.command import Wanted, excite

    question = _question(article, model, given)
    excite(question, Wanted(out=out, plot=plot, animate=animate, as_json=as_json))


def _question(article: str, model: str | None, given: dict[str, Any]) -> Any:
    from validation.excitation.asked import Question, drive, require_rate, require_route
    from validation.excitation.attached import attached

    require_route(given["route"])
    require_rate(given["rate"])
    count = given["count"]
    driven = ("axes", "every", "pattern", "band", "octaves_per_minute", "duration", "level", "cross", "seed", "ring_down")
    fastened = ("cells", "preload", "flange", "friction", "cable", "damper")
    made = ("damping_ratio", "size", "joints", "settings", "unit", "material")
    return Question(
        article=article,
        model=model,
        asked=options.flexible_asked(
            count=30 if count is None else count, counted="--modes", cells=False, **{name: given[name] for name in made}
        ),
        attached=attached(**{name: given[name] for name in fastened}),
        drive=drive(**{name: given[name] for name in driven}),
        route=given["route"],
        rate=given["rate"],
        every_mode=count is not None,
    )
