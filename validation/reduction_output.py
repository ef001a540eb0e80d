"""How `weigh`, `cog` and `pendulum` answer: a table with its budgets, or the JSON object of the output contract."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from geometry.errors import CheckFailed
from validation.output import print_json
from validation.reduction import Reduction
from validation.results_file import reference

if TYPE_CHECKING:
    from uncertainties import UFloat

PIPED_WIDTH = 130
"""Columns of what goes to a file or a pipe, where nobody's window is narrower."""


def show(reduction: Reduction, against: str | None, as_json: bool) -> None:
    """Print `reduction` beside what is published about the article `against` (None: beside nothing).

    Raises
    ------
    BadInput : nothing is published about `against`.
    CheckFailed : no body has these moments; raised when everything is printed.
    """
    published = reference(against) if against else None
    if as_json:
        print_json(reduction.json(published))
    else:
        _print(reduction, published)
    if reduction.impossible:
        raise CheckFailed(reduction.impossible)


def _print(reduction: Reduction, published: Mapping[str, UFloat] | None) -> None:
    from rich.console import Console

    # Nothing that a user wrote is markup: [kg] and :name: are printed as they are.
    console = Console(markup=False, emoji=False, highlight=False)
    if not console.is_terminal:
        console.width = max(console.width, PIPED_WIDTH)
    for page in reduction.pages(published):
        console.print(page)
