"""``massline verify``: the prediction side against closed forms, second sources and rates of convergence, row by row."""

from __future__ import annotations

import click

from geometry.errors import CheckFailed
from validation.commands import options
from validation.verification import FAMILIES


@click.command("verify", epilog="Families: " + ", ".join(f"{name} ({words})" for name, words in FAMILIES.items()) + ".")
@click.argument("families", metavar="[FAMILY]...", nargs=-1, type=click.Choice(tuple(FAMILIES)))
@click.option("--fine", is_flag=True, help="Finer meshes, a few minutes.")
@click.option("--markdown", "as_markdown", is_flag=True, help="Print the table in Markdown instead.")
@options.JSON
def command(families: tuple[str, ...], fine: bool, as_markdown: bool, as_json: bool) -> None:
    """Check elements, modes and dynamic mass against closed forms, published benchmarks and rates of convergence.

    Each row: the reference and where it comes from, the value found, the error and the bar that it has to stay within. Without
    FAMILY, all of them.

    Exit code 0 when every check passes, 1 when one does not.
    """
    from validation.output import print_json, print_pages
    from validation.verification import checks
    from validation.verification.check import Mesh, run
    from validation.verification.table import markdown, pages, summary

    results = run(checks(*families), Mesh.FINE if fine else Mesh.FAST, quiet=as_json)
    passed = all(result.passed for result in results)
    if as_json:
        print_json({"rows": [result.json() for result in results], "pass": passed, "text": summary(results)})
    elif as_markdown:
        click.echo(markdown(results))
    else:
        print_pages(pages(results))
    if not passed:
        raise CheckFailed(summary(results))
    if not as_json and not as_markdown:
        click.echo(summary(results))
