"""Adding an effect to the working copy, and going down again: the ladder of a desk."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from validation.desk.desk import Desk
from validation.ladders.climbing import Standing

Progress = Callable[[str, float], None]


def added(
    of: Desk, effect: str, *, fixed: bool = False, alias_ok: bool = False, progress: Progress | None = None
) -> Mapping[str, Any]:
    """`effect` (``ID[=VALUE]``) added to the working copy as its next rung, and the comparison of the new model kept.

    Takes from seconds to minutes: `validation.desk.jobs.start(desk, "add", effect=...)` does it in a worker.

    Returns
    -------
    The object of `massline add --json`: "errors" before and after, "verdict", "before" and "after" with "inertia".

    Raises
    ------
    BadInput, CheckFailed : see `validation.ladders.adding.added`.
    """
    raise NotImplementedError


def ladder(of: Desk) -> Standing:
    """The working copy and all its rungs, with errors, identified inertia, verdicts; `.rung` is the one it stands on. Quick."""
    raise NotImplementedError


def undone(of: Desk) -> Standing:
    """The working copy one rung down; what was computed for that rung is there at once.

    Raises
    ------
    BadInput : there is nothing below.
    """
    raise NotImplementedError


def gone_to(of: Desk, number: int) -> Standing:
    """The working copy on the rung `number`.

    Raises
    ------
    BadInput : there is no such rung.
    """
    raise NotImplementedError
