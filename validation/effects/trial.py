"""An equation tried before it is taken: what kind of stage it returns, of what shape, and whether it keeps its promises.

At the null size it changes nothing. On channels it is linear in the rows; what it adds to matrices does not depend on them.
Derivatives by all other parameters pass through it on the strength of that.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from geometry.errors import BadInput
from validation.effects import nothing
from validation.effects.family import CHANNEL_STAGE, STAGES, STRUCTURE_STAGE, Change
from validation.effects.identifiers import Named
from validation.effects.stages import Matrices

ADDED_TO = ("mass", "stiffness", "viscous", "structural")
SAME = 1e-9
"""Relative, of the largest entry: rounding of a product."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Trial:
    """The equation of a family at its example.

    Attributes
    ----------
    change : the equation
    example : targets and sizes
    source : the file, for messages
    """

    change: Change
    example: Named
    source: str

    def on(self, stage: Any, values: Mapping[str, float] | None = None) -> Any:
        """What the equation makes of `stage`, at the example's sizes or at others.

        Raises
        ------
        BadInput : it is no stage of that kind, or does not fit the one that came in.
        """
        found = self.change(stage, self.example.targets, self.example.values if values is None else values)
        if type(found) is not type(stage):
            problem = f"must return the changed {type(stage).__name__}, found {type(found).__name__}"
            raise self.refused(problem, "Return dataclasses.replace(stage, ...)")
        for name, was, now in nothing.arrays(stage, found):
            needed = _grown(was.shape, stage, found)
            if np.shape(now) != needed:
                problem = f"leaves `{name}` of shape {np.shape(now)}, where {needed} is needed"
                raise self.refused(problem, "Return arrays of the shape that came in")
            if not np.all(np.isfinite(now)):
                raise self.refused(f"leaves values in `{name}` that are no numbers", "Correct the equation")
        return found

    def refused(self, problem: str, remedy: str) -> BadInput:
        """What is wrong with the equation."""
        return BadInput(source=self.source, field="change", problem=problem, remedy=remedy)


def require_kept(trial: Trial, stage: str, null: Mapping[str, float] | None) -> None:
    """Refuse an equation of `stage` that breaks a promise; `null` are the sizes of no effect.

    Raises
    ------
    BadInput : as `Trial.on`, or which promise is broken.
    """
    if stage not in STAGES[:-1]:
        raise trial.refused(f"changes {stage!r}, which is no stage", f"Known are {', '.join(STAGES[:-1])}")
    before = nothing.tried(stage)
    after = trial.on(before)
    if null is not None and not nothing.unchanged(before, trial.on(before, null)):
        sizes = ", ".join(f"{key or 'size'} {value:g}" for key, value in null.items())
        raise trial.refused(f"changes something at {sizes}, where there is no effect", "Correct it, or `null`")
    if stage == CHANNEL_STAGE:
        _require_linear(trial, before, after)
    if stage == STRUCTURE_STAGE:
        _require_adding(trial, before, after)


def _require_linear(trial: Trial, before: Any, after: Any) -> None:
    turned = 2.0 * np.exp(0.7j)
    twice = trial.on(replace(before, rows=turned * before.rows))
    if not _alike(twice.rows, turned * after.rows):
        problem = "is not linear in `rows`: derivatives could not pass through it"
        raise trial.refused(problem, "Multiply rows, or add one to another; take levels from `amplitude`")


def _require_adding(trial: Trial, before: Any, after: Any) -> None:
    other = trial.on(replace(before, **{name: 1.5 * getattr(before, name) for name in ADDED_TO}))
    n = len(before.mass)
    for name in ADDED_TO:
        was, shift = getattr(before, name), getattr(other, name) - getattr(after, name)
        if not _alike(shift[:n, :n], 0.5 * was):
            problem = f"adds to `{name}` what depends on the matrices that are there: derivatives could not pass it"
            raise trial.refused(problem, "Build what is added of `places`, `parts` and `cog`")


def _alike(found: Any, expected: Any) -> bool:
    return bool(np.allclose(found, expected, rtol=0, atol=SAME * float(np.max(np.abs(expected)))))


def _grown(shape: tuple[int, ...], before: Any, after: Any) -> tuple[int, ...]:
    """`shape` with the coordinates that matrices have gained; nothing else may grow."""
    if not isinstance(before, Matrices):
        return shape
    k = len(before.mass)
    return tuple(len(after.mass) if n == k else n for n in shape)
