"""`massline add`: an effect fitted and added to a model, with the errors before and after."""

from __future__ import annotations

from pathlib import Path

import click

from validation.commands import options
from validation.commands.options import METHODS


@click.command("add")
@click.argument("model", type=click.Path(path_type=Path), metavar="MODEL")
@click.argument("effect", metavar="EFFECT[=VALUE]")
@click.argument("data", nargs=-1, metavar="[DATA ...]")
@click.option(
    "--hold-out",
    multiple=True,
    metavar="NAME",
    help="A run, campaign or file that is predicted and never fitted. May be repeated.  [default: each run in turn]",
)
@click.option("--band", nargs=2, type=float, metavar="LO HI", help="Frequencies [Hz] to use.  [default: what all runs drive]")
@click.option("--method", type=click.Choice(METHODS), help=f"How spectra are made.  [default: {METHODS[0]}]")
@click.option("--effects-from", multiple=True, metavar="DIR", help="A folder of your own effects. May be repeated.")
@click.option("--fixed", is_flag=True, help="Keep the effect at VALUE instead of fitting it.")
@click.option(
    "--alias-ok", is_flag=True, help="Add it though these data cannot tell it from what the model has; the rung says so."
)
@options.JSON
def command(
    model: Path,
    effect: str,
    data: tuple[str, ...],
    hold_out: tuple[str, ...],
    band: tuple[float, float] | None,
    method: str | None,
    effects_from: tuple[str, ...],
    fixed: bool,
    alias_ok: bool,
    as_json: bool,
) -> None:
    """Add EFFECT to MODEL: fit it, print the errors before and after, and keep both as rungs of the model's ladder.

    EFFECT is an id of the catalogue, such as force-gain:fmd-z2; with =VALUE its fit begins there. DATA are the campaign folders
    of one series, and weigh, cog and pendulum files with them; they may be left out once the ladder knows them. MODEL is
    rewritten with the effect, its size and standard deviation; the ladder beside it, MODEL.ladder.json, keeps every version. A
    wrong effect is added all the same: the ladder shows that nothing fell. docs/ladder.md says how to read it.

    Exit code 0 whatever comes out; 1 when the model as it was cannot be fitted; 2 when the input cannot be used.
    """
    from validation.ladders.adding import Asked
    from validation.ladders.run import add

    asked = Asked(
        model=model,
        effect=effect,
        data=data,
        hold_out=hold_out,
        band=band,
        method=method,
        effects_from=effects_from,
        fixed=fixed,
        alias_ok=alias_ok,
    )
    add(asked, as_json=as_json)
