"""`massline diagnose`: which effect a model is missing, that nothing is missing, or that it is none of those known."""

from __future__ import annotations

from pathlib import Path

import click

from validation.commands import options


@click.command("diagnose")
@click.argument("model", type=click.Path(path_type=Path), metavar="MODEL")
@click.argument("data", nargs=-1, required=True, metavar="DATA ...")
@options.HOLD_OUT
@options.BAND
@options.METHOD
@click.option(
    "--candidate",
    "candidates",
    multiple=True,
    metavar="FAMILY[:TARGET]",
    help="Look for this effect, or this family, only. May be repeated.  [default: all that could act on DATA]",
)
@click.option("--effects-from", multiple=True, metavar="DIR", help="A folder of your own effects. May be repeated.")
@click.option("--auto", is_flag=True, help="Add what is found to MODEL, rung by rung, until the rules say stop.")
@options.JSON
@click.option("--out", type=click.Path(path_type=Path), metavar="DIR", help="Write diagnose.json and the pictures into DIR.")
def command(
    model: Path,
    data: tuple[str, ...],
    hold_out: tuple[str, ...],
    band: tuple[float, float] | None,
    method: str,
    candidates: tuple[str, ...],
    effects_from: tuple[str, ...],
    auto: bool,
    as_json: bool,
    out: Path | None,
) -> None:
    """Which physical effect MODEL is missing, how surely, and what would confirm it; that nothing is; or that it is unknown.

    DATA are the campaign folders of one series, and weigh, cog and pendulum files with them. With --auto every effect that is
    found becomes a rung of MODEL's ladder, as `massline add` would make it; each is kept at once, and the same command goes on
    where an interruption fell. docs/diagnose.md says how to read the page.

    Exit code 0 whatever it finds; 1 when the model with all its tolerances does not converge; 2 when the input cannot be used.
    """
    from validation.diagnosing.asked import Asked
    from validation.diagnosing.run import answer
    from validation.effects import catalogue
    from validation.output import require_folder

    if out is not None:
        require_folder(out, "--out")
    for folder in effects_from:
        catalogue.load(folder)
    asked = Asked(
        model=model,
        data=data,
        hold_out=hold_out,
        band=band,
        method=method,
        candidates=candidates,
        effects_from=effects_from,
    )
    answer(asked, auto=auto, as_json=as_json, folder=out)
