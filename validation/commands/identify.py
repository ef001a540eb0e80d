"""`massline identify`: ten inertia parameters from a recorded campaign, with intervals and verdicts."""

from __future__ import annotations

from pathlib import Path

import click

from validation.commands import options
from validation.commands.options import METHODS


@click.command("identify")
@click.argument("campaign", metavar="CAMPAIGN")
@click.option(
    "--tare",
    "tares",
    multiple=True,
    metavar="CAMPAIGN",
    help="A campaign of a known article on the same hardware, from which the FMD is learnt. May be repeated.",
)
@click.option(
    "--known",
    multiple=True,
    metavar="ARTICLE",
    help="What stands on the FMD in the tare, for each tare; its drawing gives its inertia.  [default: what the tare says it is]",
)
@click.option(
    "--known-tolerance",
    default="0.03 %",
    show_default=True,
    metavar="SHARE",
    help="How well that inertia is known, one standard deviation; more where bolts and holes are not as drawn.",
)
@click.option(
    "--classical",
    multiple=True,
    metavar="FILE",
    help="A weighing, CoG, pendulum or results file about the article, taken as data with its tolerance. May be repeated.",
)
@click.option("--band", nargs=2, type=float, metavar="LO HI", help="Frequencies [Hz] to use.  [default: the campaign's]")
@click.option("--spectra", type=click.Choice(METHODS), default=METHODS[0], show_default=True, help="How spectra are made.")
@click.option("--modes", default="auto", show_default=True, metavar="N", help="Elastic terms; 0 takes the article for rigid.")
@click.option(
    "--condition-limit", type=float, default=100.0, show_default=True, metavar="X", help="Leave out lines conditioned worse."
)
@click.option(
    "--tolerance",
    "tolerances",
    multiple=True,
    metavar="KEY=VALUE",
    help='Your own tolerance of the measurement chain, one standard deviation: gain="0.2 %", position="0.3 mm", angle, delay, '
    "table_gain, cell_stiffness, crosstalk, fmd_inertia. May be repeated.",
)
@click.option(
    "--cell-stiffness", nargs=3, type=float, metavar="KX KY KZ", help="Stiffness [N/m] of one load cell, where it is known."
)
@click.option("--fmd", metavar="FILE", help="What is known beforehand of the FMD's moving part: a result file about fmd.")
@click.option("--any-hardware", is_flag=True, help="Allow a tare of different hardware, say so, and take no FMD off.")
@click.option("--robust", is_flag=True, help="Limit what single lines may say in the plain fit.")
@click.option("--study/--no-study", default=True, show_default=True, help="The result over start and stop frequency.")
@click.option("--plot", is_flag=True, help="Also draw condition, dynamic mass, stability, residuals and shares, under out/.")
@click.option("--out", type=click.Path(path_type=Path), metavar="DIR", help="Write identify.json and the pictures into DIR.")
@options.JSON
@options.FRAME
def command(
    campaign: str,
    tares: tuple[str, ...],
    known: tuple[str, ...],
    known_tolerance: str,
    classical: tuple[str, ...],
    band: tuple[float, float] | None,
    spectra: str,
    modes: str,
    condition_limit: float,
    tolerances: tuple[str, ...],
    cell_stiffness: tuple[float, float, float] | None,
    fmd: str | None,
    any_hardware: bool,
    robust: bool,
    study: bool,
    plot: bool,
    out: Path | None,
    as_json: bool,
    frame: str | None,
) -> None:
    """Mass, CoG, moments and products of inertia of the article of CAMPAIGN, with 95 % intervals and a verdict on each.

    Plain results (Eqs. 6 to 11, then 1 and 4) and self-calibrated ones, in which every tolerance of sensors and load cells is
    estimated over article and tare, stand side by side; docs/identification.md says how to read them. Without --tare the FMD's
    moving part is in the result.

    Exit code 0 when it is done, whatever the verdicts; 1 when no body can have what comes out; 2 when the input cannot be used.
    """
    from validation.identifying.asked import Asked
    from validation.identifying.run import answer
    from validation.output import require_folder

    if out is not None:
        require_folder(out, "--out")
    asked = Asked(
        campaign=campaign,
        tares=tares,
        known=known,
        known_tolerance=known_tolerance,
        classical=classical,
        band=band,
        spectra=spectra,
        modes=modes,
        condition_limit=condition_limit,
        tolerances=tolerances,
        cell_stiffness=cell_stiffness,
        fmd=fmd,
        any_hardware=any_hardware,
        robust=robust,
        study=study,
    )
    folder = out if out is not None else Path("out") if plot else None
    answer(asked, frame, as_json=as_json, folder=folder, keep=out is not None)
