"""Options that several commands share, so that they read the same everywhere."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import click

from geometry.errors import BadInput
from geometry.routes import DEFAULT_CHORD
from validation import changed
from validation.article_reference import Asked, is_file

Command = TypeVar("Command", bound=Callable[..., Any])

CHORDS = (1e-7, 0.1)
"""Smallest and largest chord error of a mesh [m]: finer, OCC's own tolerance is reached; coarser, no round body is left."""

FRAME = click.option(
    "--frame",
    metavar="FRAME",
    help='Your own frame, seen from the article\'s: origin, then turns, "0 0 45 mm; z 90 deg"; or a TOML file with [frame].',
)
JSON = click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead.")


def measurement(command: Command) -> Command:
    """What a measurement file is reduced with: FILE, ``--against``, ``--json``."""
    for option in (
        JSON,
        click.option("--against", metavar="ARTICLE", help="Set the result beside what is published about ARTICLE."),
        click.argument("file"),
    ):
        command = option(command)
    return command


def asked(command: Command) -> Command:
    """How articles are read: ``--set``, ``--chord``, ``--unit``, ``--material``."""
    for option in (
        click.option("--material", metavar="NAME", help="Material or density of your own file, for every body that has none."),
        click.option("--unit", metavar="UNIT", help="Unit of length of your own mesh file, for example mm."),
        click.option(
            "--chord",
            metavar="LENGTH",
            help=f"Chord error of the mesh route.  [default: {DEFAULT_CHORD * 1e6:g} um; in your own STEP 1e-4 of a body's size]",
        ),
        click.option(
            "--set",
            "settings",
            multiple=True,
            metavar="KEY=VALUE",
            help="Your own dimension of a built-in part, in the unit of its file in geometry/articles, such as "
            "fmd.load_cell.moving_fraction=0.6. May be repeated.",
        ),
    ):
        command = option(command)
    return command


def reading(chord: str | None, unit: str | None, material: str | None, settings: Sequence[str]) -> Asked:
    """The four options, checked.

    Raises
    ------
    BadInput : the chord error is no length within `CHORDS`, or a setting is not of the form KEY=VALUE with a number.
    """
    return Asked(chord=None if chord is None else _chord(chord), unit=unit, material=material, changes=changed.read(settings))


def require_articles(names: Sequence[str]) -> None:
    """Refuse a name that is neither a file or folder nor a built-in article, before anything is said about its options.

    Raises
    ------
    BadInput : such a name, with the nearest.
    """
    from geometry.articles import dimension_files

    for name in names:
        if not is_file(name):
            dimension_files(name)


def _chord(text: str) -> float:
    from geometry.quantities import quantity

    try:
        size = float(quantity(text, "length", source="--chord", field="").nominal_value)
    except BadInput as error:
        raise _no_chord(error.problem) from None
    if size <= 0:
        raise _no_chord(f"must be positive, found {text}")
    if not CHORDS[0] * (1 - 1e-9) <= size <= CHORDS[1] * (1 + 1e-9):  # 0.1 um and 100 mm, whichever way they are rounded
        raise _no_chord(f"must be from {CHORDS[0] * 1e6:g} um to {CHORDS[1]:g} m, found {text}")
    return size


def _no_chord(problem: str) -> BadInput:
    return BadInput(source="--chord", problem=problem, remedy='Write for example "2 um"')
