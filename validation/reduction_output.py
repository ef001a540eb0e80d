"""How `weigh`, `cog` and `pendulum` answer: a table with its budgets, or the JSON object of the output contract."""

from __future__ import annotations

from geometry.errors import CheckFailed
from validation.output import print_json, print_pages
from validation.reduction import Reduction
from validation.results_file import reference


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
        print_pages(reduction.pages(published))
    if reduction.impossible:
        raise CheckFailed(reduction.impossible)
