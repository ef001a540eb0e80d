"""`massline report`: one page of all that is known of a model and its measurements, to be read, printed and signed."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path

import click

from validation.commands import options


@click.command("report")
@click.argument("model", metavar="MODEL")
@click.argument("data", nargs=-1, required=True, metavar="DATA ...")
@options.HOLD_OUT
@options.BAND
@options.METHOD
@options.effects_from
@click.option("--no-diagnosis", is_flag=True, help="Do not look for what is missing, which takes longest.")
@click.option("--pdf", is_flag=True, help="Print it to a PDF beside it as well, by Chromium or what MASSLINE_BROWSER names.")
@click.option("--by", default="", metavar="NAME", help="Who made it: stands above the first signature line.")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    metavar="FILE.html",
    help="Where the page goes.  [default: out/, named after MODEL]",
)
def command(
    model: str,
    data: tuple[str, ...],
    hold_out: tuple[str, ...],
    band: tuple[float, float] | None,
    method: str,
    no_diagnosis: bool,
    pdf: bool,
    by: str,
    out: Path | None,
) -> None:
    """A report of MODEL and DATA as one HTML file that needs no network: figures to look into, tables that copy, room to sign.

    DATA are the campaign folders of one series, and weigh, cog and pendulum files with them. The report compares, identifies and
    diagnoses as the commands of these names do, shows the model's ladder, and says where every figure comes from. docs/report.md
    shows a page.

    Exit code 0 whatever it finds; 1 when a fit does not converge or nothing is printed; 2 when the input cannot be used.
    """
    from validation.comparing.asked import Asked as Compared
    from validation.report.run import Asked, answer

    asked = Compared(model=model, data=data, hold_out=hold_out, band=band, method=method)
    line = shlex.join(["massline", *sys.argv[1:]])
    answer(Asked(compared=asked, diagnosis=not no_diagnosis, out=out, pdf=pdf, by=by, command=line))
