"""`massline app`: the workbench in the browser."""

from __future__ import annotations

import click

from validation.app.asked import LINGER
from validation.commands import options


@click.command("app")
@click.argument("model", required=False, metavar="[MODEL]")
@click.argument("data", nargs=-1, metavar="[DATA ...]")
@click.option("--example", metavar="NAME", help="Begin with a built-in example; the page lists them, too.")
@click.option(
    "--port", type=click.IntRange(0, 65535), default=0, metavar="N", help="Port to serve on.  [default: one that is free]"
)
@click.option("--host", default="127.0.0.1", show_default=True, metavar="ADDRESS", help="Address to serve on: others reach it.")
@click.option("--no-browser", is_flag=True, help="Print the address, open nothing.")
@click.option(
    "--linger",
    type=click.FloatRange(0, 86400),
    default=LINGER,
    show_default=True,
    metavar="SECONDS",
    help="How long to wait, when the last page is closed, for it to be opened again.",
)
@click.option("--stay", is_flag=True, help="Keep serving when the last page is closed.")
@options.HOLD_OUT
@options.BAND
@options.METHOD
@click.option("--effects-from", multiple=True, metavar="DIR", help="A folder of your own effects. May be repeated.")
def command(
    model: str | None,
    data: tuple[str, ...],
    example: str | None,
    port: int,
    host: str,
    no_browser: bool,
    linger: float,
    stay: bool,
    hold_out: tuple[str, ...],
    band: tuple[float, float] | None,
    method: str,
    effects_from: tuple[str, ...],
) -> None:
    """The workbench in the browser: compare, diagnose, add, undo, what if.

    Without arguments the page begins empty: drag a folder onto it, or pick an example. MODEL and DATA are those of `massline
    compare`. Your files are read, and written only where you save.

    The address that is printed is good once, in one browser, on this machine. Every window has a process of its own; closing the
    last page ends all of them, and Ctrl-C does.

    Exit code 0 at the end; 2 when the input cannot be used.
    """
    from validation.app import door
    from validation.app.asked import Asked, opened

    begun = opened(example, model, data, hold_out=hold_out, band=band, method=method, effects_from=effects_from)
    door.run(Asked(opened=begun, port=port, host=host, browser=not no_browser, linger=None if stay else linger), click.echo)
