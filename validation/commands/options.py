"""Options that several commands share, so that they read the same everywhere."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import click

from geometry.errors import BadInput
from geometry.routes import DEFAULT_CHORD
from validation.article_reference import Asked

Command = TypeVar("Command", bound=Callable[..., Any])

FRAME = click.option(
    "--frame",
    metavar="ORIGIN[; TURNS]",
    help='Your own frame, seen from the article\'s: origin and turns, "0 0 45 mm; z 90 deg", or a TOML file with [frame].',
)
JSON = click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output, nothing else.")


def asked(command: Command) -> Command:
    """How articles are read: ``--chord``, ``--unit``, ``--material``."""
    for option in (
        click.option("--material", help="Material or density of your own file, for every body that has none."),
        click.option("--unit", help="Unit of length of your own mesh file, for example mm."),
        click.option("--chord", default=f"{DEFAULT_CHORD * 1e6:g} um", show_default=True, help="Chord error of the mesh route."),
    ):
        command = option(command)
    return command


def reading(chord: str, unit: str | None, material: str | None) -> Asked:
    """The three options, checked.

    Raises
    ------
    BadInput : the chord error is no positive length.
    """
    from geometry.quantities import quantity

    size = float(quantity(chord, "length", source="--chord", field="chord").nominal_value)
    if size <= 0:
        raise BadInput(source="--chord", problem=f"must be positive, found {chord}", remedy='Write for example "2 um"')
    return Asked(chord=size, unit=unit, material=material)
