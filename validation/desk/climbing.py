"""Adding an effect to the working copy, and going down again: the ladder of a desk."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from validation.desk import comparing
from validation.desk.desk import Desk, digest
from validation.ladders import adding
from validation.ladders import climbing as ladders
from validation.ladders.as_json import of_step
from validation.ladders.climbing import Standing, standing

Progress = Callable[[str, float], None]


def added(of: Desk, effect: str, progress: Progress | None = None) -> Mapping[str, Any]:
    """`effect` (``ID[=VALUE]``) added to the working copy as its next rung, and the comparison of the new model kept.

    Takes from seconds to minutes: `validation.desk.jobs.start(desk, "add", effect=...)` does it in a worker.

    Returns
    -------
    The object of `massline add --json`: "errors" before and after, "verdict", "before" and "after" with "inertia".

    Raises
    ------
    BadInput, CheckFailed : see `validation.ladders.adding.added`.
    """
    asked = of.asked
    step = adding.added(
        adding.Asked(
            model=of.model,
            effect=effect,
            data=asked.data,
            hold_out=asked.hold_out,
            band=asked.band,
            method=asked.method,
            effects_from=asked.effects_from,
        ),
        progress,
    )
    comparing.compared(of, progress)
    return of_step(step.at, step.before, step.after, step.said)


def ladder(of: Desk) -> Standing:
    """The working copy and all its rungs, with errors, identified inertia, verdicts; `.rung` is the one it stands on. Quick.

    Raises
    ------
    BadInput : the working copy or its ladder cannot be read.
    """
    return standing(of.model)


def undone(of: Desk) -> Standing:
    """The working copy one rung down; what was computed for that rung is there at once.

    Raises
    ------
    BadInput : there is nothing below.
    """
    return ladders.undone(ladder(of))


def put_back(of: Desk, before: str) -> str:
    """The working copy on the rung whose text has the digest `before` again, and a sentence on that.

    For a rung that was written by work that did not come to its end. It stays on the ladder, beside the way. Nothing is done, and
    nothing said, where the working copy is as it was.

    Raises
    ------
    BadInput, OSError : see `gone_to`.
    """
    at = ladder(of)
    below = next((one for one in at.ladder.rungs if digest(one.model) == before), None)
    if digest(at.text) == before or below is None:
        return ""
    ladders.gone_to(at, below.number)
    new = "" if at.rung is None else f"rung {at.rung.number} was written already and stays on the ladder; "
    return f"{new}the model is back on rung {below.number}"


def gone_to(of: Desk, number: int) -> Standing:
    """The working copy on the rung `number`.

    Raises
    ------
    BadInput : there is no such rung.
    """
    return ladders.gone_to(ladder(of), number)
