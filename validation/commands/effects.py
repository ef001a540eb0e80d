"""`massline effects`: the physical effects that massline knows, or one of them in full."""

from __future__ import annotations

import click

from validation.commands import options


@click.command("effects")
@click.argument("names", nargs=-1, metavar="[ID ...]")
@options.JSON
@options.effects_from
def command(names: tuple[str, ...], as_json: bool) -> None:
    """List the effects that massline can simulate, compare, add and look for; with ID say all about these.

    ID is a family such as force-gain, or an effect such as force-gain:fmd-z2. Tolerance is what a careful laboratory admits,
    plausible what a fault may be, one standard deviation each.
    """
    from validation.effects import described, listing
    from validation.output import print_json

    found = listing.chosen(names)
    if as_json:
        print_json({"effects": [described.as_json(family) for family, _ in found]})
    elif names:
        click.echo("\n".join(listing.whole(family, target) for family, target in found), nl=False)
    else:
        click.echo(listing.table(), nl=False)
