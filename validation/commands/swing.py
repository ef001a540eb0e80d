"""`massline swing`: an article on ropes, simulated by exudyn, recorded and reduced as a measured pendulum."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from geometry.errors import BadInput
from validation.commands import options

if TYPE_CHECKING:
    from validation.swing.shifts import Simulated


@click.command("swing")
@click.argument("article")
@options.JSON
@options.SET
@click.option("--unit", metavar="UNIT", help="Unit of length of your own mesh file, for example mm.")
@click.option("--material", metavar="NAME", help="Material of your own file, for every body that has none.")
@click.option("--animate", is_flag=True, help="Also write the swing as a GIF under out/, or where --out says.")
@click.option("--plot", is_flag=True, help="Also draw the pendulum and its signal under out/; --out does so anyway.")
@click.option("--out", type=click.Path(path_type=Path), metavar="FOLDER", help="Write record, measurement file and picture.")
@click.option("--step", metavar="TIME", help="Step of the integration.  [default: a thousandth of the period or finer]")
@click.option("--gravity", metavar="G", help='[default: "9.80665 m/s^2"]')
@click.option("--seed", type=int, default=0, show_default=True, metavar="N", help="Of the noise.")
@click.option("--noise", metavar="ANGLE", help='Standard deviation of the recorder\'s noise, for example "1 mrad".')
@click.option("--rate", type=float, default=50.0, show_default=True, metavar="HZ", help="Of the recorder.")
@click.option("--cycles", type=float, default=20.0, show_default=True, metavar="N", help="To record.")
@click.option("--start", type=click.Choice(["twist", "push"]), default="twist", show_default=True, help="Let go, or pushed.")
@click.option("--unequal", metavar="LENGTH", help="By which the first rope is longer than the others.")
@click.option("--off-centre", metavar="LENGTH[,LENGTH]", help="From where the CoG is thought to be to where it is, on x and y.")
@click.option("--rope-stiffness", metavar="FORCE", help='EA of each rope, for example "1e6 N"; ropes do not stretch without.')
@click.option("--links", type=int, metavar="N", help="Of which a rope with mass is made.  [default: 8]")
@click.option("--rope-mass", metavar="MASS", help="Of all ropes together.")
@click.option("--damping", metavar="RATIO", help='Viscous, of the twist: 0.01 or "1 %".')
@click.option("--amplitude", default="0.1 rad", show_default=True, metavar="ANGLE", help="Twist at the start.")
@click.option("--height", metavar="LENGTH", help="Of the ropes' feet above the CoG.  [default: 100 mm]")
@click.option("--along", metavar="AXIS", help="The article's axis that lies along two ropes.  [default: z, or x with z upright]")
@click.option("--axis", default="z", show_default=True, metavar="AXIS", help="The article's axis that is upright: x, y or z.")
@click.option("--length", default="2 m", show_default=True, metavar="LENGTH", help="Of the ropes, unloaded.")
@click.option("--s2", metavar="LENGTH", help="From the CoG to the second of two ropes.")
@click.option("--s1", metavar="LENGTH", help="From the CoG to the first of two ropes.")
@click.option("--radius", metavar="LENGTH", help="Of the circle of three ropes about the CoG.  [default: 300 mm]")
@click.option("--ropes", type=int, metavar="N", help="2 or 3.  [default: 3, or 2 with --s1 and --s2]")
def command(
    article: str,
    as_json: bool,
    settings: tuple[str, ...],
    unit: str | None,
    material: str | None,
    animate: bool,
    plot: bool,
    out: Path | None,
    **words: Any,
) -> None:
    """ARTICLE on two or three ropes, let swing by exudyn, recorded, and reduced by Eq. 5 as a measured pendulum would be.

    Prints the period beside that of Eq. 5, what every effect alone does to it, and the inertia that comes out beside that of the
    article. With --out FOLDER the record goes through `massline pendulum FOLDER/pendulum.toml` like any other.
    """
    from validation.output import require_folder
    from validation.swing.asked import as_option, setup
    from validation.swing.shifts import simulated

    options.require_articles([article])
    asked = options.reading(None, unit, material, settings)
    question = setup(article, _words(words), asked)
    for option, folder in _folders(out, plot=plot, animate=animate).items():
        require_folder(folder, option)
    try:
        found = simulated(question, _watched(as_json))
    except BadInput as error:
        raise as_option(error) from None
    _write(found, out)
    _print(found, out, as_json)
    for folder in set(_folders(out, plot=plot, animate=animate).values()):
        _draw(found, asked, folder, animate=animate, quiet=as_json)


def _folders(out: Path | None, *, plot: bool, animate: bool) -> dict[str, Path]:
    """The folder that something is written into, by the option that asked for it; empty where nothing is."""
    if out is not None:
        return {"--out": out}
    return {option: Path("out") for option, wanted in (("--plot", plot), ("--animate", animate)) if wanted}


def _words(words: dict[str, Any]) -> Any:
    from validation.swing.asked import OPTIONS, Words

    texts = {name: words.pop(name) for name in OPTIONS}
    return Words(texts=texts, **words)


def _watched(quiet: bool) -> Any:
    from functools import partial

    from validation.progress import percent

    return partial(percent, quiet=quiet)


def _write(found: Simulated, out: Path | None) -> None:
    from validation.swing.record import write

    if out is not None:
        record = found.record
        path = write(out, record.setup, record.swing, record.signal, record.decay)
        click.echo(f"massline: wrote {path} and its record. Reduce it with `massline pendulum {path}`.", err=True)


def _print(found: Simulated, out: Path | None, as_json: bool) -> None:
    from validation.output import print_json
    from validation.swing import report

    if as_json:
        print_json(report.as_json(found, out))
    else:
        click.echo(report.text(found), nl=False)


def _draw(found: Simulated, asked: Any, folder: Path, *, animate: bool, quiet: bool) -> None:
    from validation.progress import shown
    from validation.swing.drawing import draw, in_the_way

    with shown("pictures of the swing", quiet=quiet):
        written = draw(found, asked, folder, animate=animate)
        said = in_the_way(found.record.setup, asked)
    for path in written:
        click.echo(f"massline: wrote {path}.", err=True)
    if said:
        click.echo(f"massline: {said}", err=True)
