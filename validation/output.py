"""What goes to standard output: one JSON object whose keys end in their unit, or pages for a reader, as wide as he can see."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from geometry.atomic import probe, probe_folder
from geometry.errors import BadInput
from geometry.inertia import Inertia

if TYPE_CHECKING:
    from rich.console import RenderableType


PIPED_WIDTH = 132
"""Columns of what goes to a file or a pipe, where nobody's window is narrower."""

UNBOUNDED = 10_000
"""Columns in which every table finds room, to see how few it needs."""


def page_width() -> int:
    """Columns of a page: what COLUMNS says, else the terminal's, else `PIPED_WIDTH`."""
    from rich.console import Console

    asked = os.environ.get("COLUMNS", "")
    if asked.isdecimal() and int(asked) > 0:
        return int(asked)
    terminal = Console()
    return terminal.width if terminal.is_terminal else PIPED_WIDTH


def print_pages(pages: Iterable[RenderableType]) -> None:
    """Print `pages` in `page_width` columns, a table that needs more in as many as it needs: its figures are never cut.

    Nothing that a user wrote is markup: [kg] and :name: are printed as they are. No line of a file or a pipe ends in spaces.
    """
    from rich.console import Console

    console = Console(markup=False, emoji=False, highlight=False)
    width = page_width()
    for page in pages:
        console.width = UNBOUNDED
        console.width = max(width, console.measure(page).minimum)
        with console.capture() as capture:
            console.print(page)
        lines = capture.get().splitlines()
        shown = lines if console.is_terminal else [line.rstrip() for line in lines]
        click.echo("\n".join(shown), color=console.is_terminal or None)


def print_json(value: dict[str, Any]) -> None:
    """Print `value` as the one JSON object of a command."""
    click.echo(json_text(value))


def json_text(value: dict[str, Any]) -> str:
    """`value` as one JSON object; NaN and infinity are refused, they are not JSON."""
    return json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False)


def plain_unit(unit: str) -> str:
    """`unit` in ASCII (kg m^2), as a model file writes it: for programs, and for spreadsheets that are not told of UTF-8."""
    return unit.replace("²", "^2").replace("³", "^3")


def inertia_json(inertia: Inertia) -> dict[str, Any]:
    """INERTIA of the output contract: CoG [mm] in the body's frame, moments and products [kg m²] about the CoG."""
    return {
        "mass_kg": inertia.mass,
        "cog_mm": (1e3 * inertia.cog).tolist(),
        "moi_cog_kgm2": inertia.moments_cog.tolist(),
        "poi_cog_kgm2": inertia.products_cog.tolist(),
        "about": "cog",
    }


def require_ending(path: Path, endings: Sequence[str], what: str, example: str) -> None:
    """Refuse, before anything is computed, a file of ``--out`` whose ending chooses none of the formats of `what`.

    Raises
    ------
    BadInput : no file is named, or its ending is not one of `endings`; `example` is one that is.
    """
    if not path.name:
        raise BadInput(source="--out", problem="no file is named", remedy=f"Give one, such as {example}, or leave it out")
    if path.suffix.lower() not in endings:
        problem = f"{what} is written as {', '.join(endings)}, found {path.suffix or 'no ending'}"
        remedy = "Name the file so, the ending chooses the format"
        raise BadInput(source=str(path), field="--out", problem=problem, remedy=remedy)


def require_file(path: Path, option: str) -> None:
    """Refuse, before anything is computed, a file named by `option` that could not be written.

    Raises
    ------
    BadInput : a device, a folder instead of a file, a folder that is not there or where nothing can be written.
    """
    _tried(probe, path, option)


def require_folder(folder: Path, option: str) -> None:
    """The same of a folder into which `option` writes; it may be missing when the one that it lies in is there.

    Raises
    ------
    BadInput : see `require_file`.
    """
    _tried(probe_folder, folder, option)


def _tried(attempt: Callable[[Path], None], path: Path, option: str) -> None:
    try:
        attempt(path)
    except OSError as error:
        problem = f"{path} cannot be written: {error.strerror}"
        remedy = "Name a folder that is there and may be written to"
        raise BadInput(source=option, problem=problem, remedy=remedy) from None


# Progress on standard error for work over a second: what is being done now, silent where nobody watches.


@contextmanager
def shown(words: str, *, quiet: bool = False) -> Iterator[None]:
    """Show `words` with a spinner while the block runs, if standard error is a terminal and not `quiet`."""
    if quiet or not sys.stderr.isatty():
        yield
        return
    from rich.console import Console

    with Console(stderr=True).status(words):
        yield


def counted(items: Iterable[str], words: str, *, quiet: bool = False) -> Iterator[str]:
    """`items` one after the other, each announced as ``words: item (2 of 5)`` while the caller works on it."""
    listed = list(items)
    for number, item in enumerate(listed, start=1):
        with shown(f"{words}: {item} ({number} of {len(listed)})", quiet=quiet):
            yield item


@contextmanager
def percent(words: str, *, quiet: bool = False) -> Iterator[Callable[[float], None]]:
    """Show `words` with the share done while the block runs, as `shown` does; it is told by calling what the block is given."""
    if quiet or not sys.stderr.isatty():
        yield lambda share: None
        return
    from rich.console import Console

    with Console(stderr=True).status(words) as status:
        yield lambda share: status.update(f"{words}: {100 * min(max(share, 0.0), 1.0):.0f} %")


@contextmanager
def stages(words: str, *, quiet: bool = False) -> Iterator[Callable[[str, float], None]]:
    """The same for work of several stages: what the block is given hears the name of the stage and the share of it."""
    if quiet or not sys.stderr.isatty():
        yield lambda stage, share: None
        return
    from rich.console import Console

    with Console(stderr=True).status(words) as status:
        yield lambda stage, share: status.update(f"{words}: {stage} {100 * min(max(share, 0.0), 1.0):.0f} %")
