"""``make demo``: everything massline shows, in order, each step the very command that a user would type.

A step is a title and a command line. Whatever is new appends its own to `STEPS`; nothing here computes anything.
"""

from __future__ import annotations

import shlex
import sys
from dataclasses import dataclass

import click

from validation.cli import DONE, run


@dataclass(frozen=True, kw_only=True)
class Step:
    """One thing to see: a `title` and the `command` line behind ``massline`` that shows it."""

    title: str
    command: str


STEPS = (
    Step(
        title="The four articles, Clumod in both configurations: three routes beside published and measured values",
        command="reference cuboid disc fmd clumod-1 clumod-4",
    ),
)

WHERE = "Every table above is one command; `massline COMMAND --help` says more, and --json gives the same figures to a program."


def main() -> int:
    """Run every step and stop at the first that fails; its exit code is the demo's."""
    for number, step in enumerate(STEPS, start=1):
        click.secho(f"\n{number}/{len(STEPS)}  {step.title}", bold=True)
        click.echo(f"$ massline {step.command}\n")
        code = run(shlex.split(step.command))
        if code != DONE:
            click.echo(f"The demo stops here: `massline {step.command}` ended with exit code {code}.", err=True)
            return code
    click.echo(f"\n{WHERE}")
    return DONE


if __name__ == "__main__":
    sys.exit(main())
