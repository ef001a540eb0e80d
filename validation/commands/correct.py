"""`massline correct`: a copy of a campaign without a fault of its measurement."""

from __future__ import annotations

from pathlib import Path

import click

from validation.commands import options


@click.command("correct")
@click.argument("campaign", metavar="CAMPAIGN")
@click.argument("effects", nargs=-1, required=True, metavar="EFFECT[=VALUE] ...")
@click.option("--out", type=click.Path(path_type=Path), required=True, metavar="DIR", help="The new campaign folder.")
@click.option("--force", is_flag=True, help="Replace the campaign in DIR if there is one.")
@options.effects_from
@options.JSON
def command(campaign: str, effects: tuple[str, ...], out: Path, force: bool, as_json: bool) -> None:
    """Write a copy of CAMPAIGN from which EFFECT is taken out; CAMPAIGN itself is only read.

    The value is the fault, with the sign of the catalogue: force-gain:fmd-z2=0.08 says that fmd-z2 reads 8 % too much. Gains,
    units, polarities, swapped channels, delays, a high-pass, places and directions of accelerometers and a shunt can be taken
    out of a record; for everything else the command says why not.
    """
    from validation.correcting.command import correct

    correct(campaign, effects, out, force=force, as_json=as_json)
