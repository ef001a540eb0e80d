"""`massline compare`: where a model fails, in per cent, in sigmas and in words."""

from __future__ import annotations

from pathlib import Path

import click

from validation.commands import options


@click.command("compare")
@click.argument("model", metavar="MODEL")
@click.argument("data", nargs=-1, required=True, metavar="DATA ...")
@options.HOLD_OUT
@options.BAND
@options.METHOD
@options.effects_from
@options.JSON
@click.option("--out", type=click.Path(path_type=Path), metavar="DIR", help="Write compare.json and the pictures into DIR.")
def command(
    model: str,
    data: tuple[str, ...],
    hold_out: tuple[str, ...],
    band: tuple[float, float] | None,
    method: str,
    as_json: bool,
    out: Path | None,
) -> None:
    """Where MODEL fails: four errors with their verdicts, the ten worst spots in words, maps over frequency.

    DATA are the campaign folders of one series, and weigh, cog and pendulum files with them. Spots are told in standard
    deviations of what noise and tolerances let expect, and in per cent of the dynamic mass; docs/compare.md says how to read
    them.

    Exit code 0 whatever it finds; 1 when a fit does not converge; 2 when the input cannot be used.
    """
    from validation.comparing.asked import Asked
    from validation.comparing.run import answer
    from validation.output import require_folder

    if out is not None:
        require_folder(out, "--out")
    asked = Asked(model=model, data=data, hold_out=hold_out, band=band, method=method)
    answer(asked, as_json=as_json, folder=out)
