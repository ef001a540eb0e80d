"""Options that several commands share, so that they read the same everywhere."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

import click

from geometry.errors import BadInput
from geometry.mesh import DEFAULT_CHORD

if TYPE_CHECKING:
    from validation.flexible import model
    from validation.reference.reference import ArticleOptions


Command = TypeVar("Command", bound=Callable[..., Any])

CHORDS = (1e-7, 0.1)
"""Smallest and largest chord error of a mesh [m]: finer, OCC's own tolerance is reached; coarser, no round body is left."""

ELEMENT_SIZES = (1e-4, 1.0)
"""Smallest and largest element size of a solid model [m]: finer, no machine holds it; coarser, no article has room for it."""

FRAME = click.option(
    "--frame",
    metavar="FRAME",
    help='Your own frame, seen from the article\'s: origin, then turns, "0 0 45 mm; z 90 deg"; or a TOML file with [frame].',
)
JSON = click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead.")

SET = click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="KEY=VALUE",
    help="Your own dimension of a built-in part, in the unit of its file in geometry/articles, such as "
    "fmd.load_cell.moving_fraction=0.6. May be repeated.",
)
METHODS = ("full-record", "peak-reference-hold")

BAND = click.option(
    "--band", nargs=2, type=float, metavar="LO HI", help="Frequencies [Hz] to use.  [default: what all runs drive]"
)
EFFECTS_FROM = click.option("--effects-from", multiple=True, metavar="DIR", help="A folder of your own effects. May be repeated.")
"""Hands the folders to the command, which must know them later."""


def _with(command: Command, *added: Callable[[Command], Command]) -> Command:
    """`command` with options in the order in which its help lists them."""
    for option in reversed(added):
        command = option(command)
    return command


def study(command: Command) -> Command:
    """How a model is held against data: ``--hold-out``, ``--band``, ``--method``."""
    return _with(
        command,
        click.option(
            "--hold-out",
            multiple=True,
            metavar="NAME",
            help="A run, campaign or file used only for checking, never fitted. Repeatable.  [default: each run in turn]",
        ),
        BAND,
        click.option("--method", type=click.Choice(METHODS), default=METHODS[0], show_default=True, help="How spectra are made."),
    )


def _load_effects(ctx: click.Context, _: click.Parameter, folders: Sequence[str]) -> None:
    if folders and not ctx.resilient_parsing:
        from validation.effects import catalogue

        for folder in folders:
            catalogue.load(folder)


effects_from = click.option(
    "--effects-from",
    multiple=True,
    is_eager=True,
    expose_value=False,
    callback=_load_effects,
    metavar="DIR",
    help="Your own effects: a folder of files, each with a FAMILY. They take part in everything. May be repeated.",
)
"""Puts a user's effects into the catalogue before any other option is read; the command itself gets nothing."""


def measurement(command: Command) -> Command:
    """What a measurement file is reduced with: FILE, ``--against``, ``--json``."""
    return _with(
        command,
        click.argument("file"),
        click.option("--against", metavar="ARTICLE", help="Set the result beside what is published about ARTICLE."),
        JSON,
    )


UNIT = click.option("--unit", metavar="UNIT", help="Unit of length of your own mesh file, for example mm.")


def asked(command: Command) -> Command:
    """How articles are read: ``--set``, ``--chord``, ``--unit``, ``--material``, ``--repair``."""
    return _with(
        command,
        SET,
        click.option(
            "--chord",
            metavar="LENGTH",
            help=f"Chord error of the mesh route.  [default: {DEFAULT_CHORD * 1e6:g} um; in your own STEP 1e-4 of a body's size]",
        ),
        UNIT,
        click.option("--material", metavar="NAME", help="Material or density of your own file, for every body that has none."),
        click.option(
            "--repair",
            is_flag=True,
            help="Mend what is safe in your own mesh, say each step, and estimate one that is no skin of a body all the same.",
        ),
    )


def flexible(command: Command) -> Command:
    """How a flexible model is made: ``--model``, ``--damping``, ``--size``, ``--joints``, ``--cells``, ``--set`` and others."""
    return _with(
        command,
        click.option(
            "--model",
            metavar="MODEL",
            help="beam (milliseconds; the default), solid (meshed CAD) or exudyn (solved by exudyn itself).",
        ),
        click.option(
            "--damping",
            "damping_ratio",
            type=float,
            metavar="RATIO",
            help="Damping ratio of every mode, instead of the model's own.",
        ),
        click.option("--size", metavar="LENGTH", help='Element size of the solid model, for example "20 mm".'),
        click.option("--joints", is_flag=True, help="Correct Clumod's beams by local solid models of its joints (beam, exudyn)."),
        click.option("--cells", is_flag=True, help="The FMD's load cells as springs of assumed stiffness (beam, exudyn)."),
        SET,
        UNIT,
        click.option("--material", metavar="NAME", help="Material of your own CAD file, for every body that has none."),
    )


def flexible_asked(
    *,
    count: int,
    counted: str,
    damping_ratio: float | None,
    size: str | None,
    joints: bool,
    cells: bool,
    settings: Sequence[str],
    unit: str | None,
    material: str | None,
) -> "model.FlexibleOptions":
    """The options of `flexible`, checked; `counted` is the option that `count` was given as.

    Raises
    ------
    BadInput : one of them is out of its range, or no length.
    """
    from fem.damping import Damping
    from validation.flexible.model import FlexibleOptions, require_count
    from validation.reference import reference

    require_count(count, counted)
    return FlexibleOptions(
        count=count,
        damping=None if damping_ratio is None else Damping(ratio=damping_ratio),
        size=None if size is None else _length(size, "--size", ELEMENT_SIZES, '"20 mm"'),
        joints=joints,
        cells=cells,
        changes=reference.read(settings),
        unit=unit,
        material=material,
    )


def reading(
    chord: str | None, unit: str | None, material: str | None, settings: Sequence[str], repair: bool = False
) -> "ArticleOptions":
    """The options, checked.

    Raises
    ------
    BadInput : the chord error is no length within `CHORDS`, or a setting is not of the form KEY=VALUE with a number.
    """
    from validation.reference import reference

    return reference.ArticleOptions(
        chord=None if chord is None else _length(chord, "--chord", CHORDS, '"2 um"'),
        unit=unit,
        material=material,
        repair=repair,
        changes=reference.read(settings),
    )


def require_articles(names: Sequence[str]) -> None:
    """Refuse a name that is neither a file or folder nor a built-in article, before anything is said about its options.

    Raises
    ------
    BadInput : such a name, with the nearest.
    """
    from geometry.articles import dimension_files
    from validation.model.setups import is_file

    for name in names:
        if not is_file(name):
            dimension_files(name)


def _length(text: str, option: str, limits: tuple[float, float], example: str) -> float:
    """A length [m] within `limits`."""
    from geometry.toml_file import quantity

    def refused(problem: str) -> BadInput:
        return BadInput(option, "", problem, f"Write for example {example}")

    try:
        size = float(quantity(text, "length", source=option, field="").nominal_value)
    except BadInput as error:
        raise refused(error.problem) from None
    if size <= 0:
        raise refused(f"must be positive, found {text}")
    if not limits[0] * (1 - 1e-9) <= size <= limits[1] * (1 + 1e-9):  # whichever way 0.1 um and 100 mm are rounded
        raise refused(f"must be from {limits[0] * 1e6:g} um to {limits[1]:g} m, found {text}")
    return size
