"""`Check`: one row of the verification table - a reference with where it comes from, a way to find the value, and a bar."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import Enum
from functools import cache, wraps
from importlib import import_module
from typing import Any, NamedTuple, ParamSpec, TypeVar

from validation.output import counted, plain_unit

P = ParamSpec("P")
T = TypeVar("T")

_FORGET: list[Callable[[], None]] = []


class Error(Enum):
    """How a value is held against its reference."""

    RELATIVE = "relative"
    ABSOLUTE = "absolute"


class Mesh(Enum):
    """How fine the meshes of a run are."""

    FAST = "fast"
    FINE = "fine"


class Found(NamedTuple):
    """What a check found: the reference and the value, both in the check's unit."""

    reference: float
    value: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Check:
    """One row, as it stands before anything is computed.

    Attributes
    ----------
    family : heading that it is printed under
    what : what is checked
    source : where the reference comes from
    unit : of value, reference and, where the error is absolute, of error and bar; empty for a pure number
    bar : largest error that passes
    error : relative to the reference, or absolute where that is zero or an order of convergence
    find : gives reference and value on a mesh as fine as asked for
    """

    family: str
    what: str
    source: str
    unit: str
    bar: float
    find: Callable[[Mesh], Found]
    error: Error = Error.RELATIVE


@dataclass(frozen=True, eq=False, kw_only=True)
class CheckResult:
    """A check with what it found."""

    check: Check
    found: Found

    @property
    def error(self) -> float:
        """Size of the error, relative or absolute as the check asks; infinite where the value is no number."""
        reference, value = self.found
        size = float(abs(value - reference))
        relative = self.check.error is Error.RELATIVE
        return size / abs(reference) if relative and reference else size if math.isfinite(size) else math.inf

    @property
    def passed(self) -> bool:
        """Whether the error stays at or below the bar; what is no number never does."""
        return bool(self.error <= self.check.bar)

    def json(self) -> dict[str, Any]:
        """The row as the output contract has it; a value that is no number is null."""
        reference, value = (number if math.isfinite(number) else None for number in self.found)
        return {
            "family": self.check.family,
            "what": self.check.what,
            "reference": reference,
            "source": self.check.source,
            "value": value,
            "unit": plain_unit(self.check.unit),
            "error": self.error if math.isfinite(self.error) else None,
            "error_is": self.check.error.value,
            "bar": self.check.bar,
            "pass": self.passed,
        }


def run(checks: Iterable[Check], mesh: Mesh = Mesh.FAST, *, quiet: bool = True) -> list[CheckResult]:
    """Every check done, in order. What several of them share is computed once, and computed anew in the next run."""
    listed = list(checks)
    announced = counted([check.what for check in listed], "checking", quiet=quiet)
    forget()
    try:
        return [CheckResult(check=check, found=check.find(mesh)) for check, _ in zip(listed, announced, strict=True)]
    finally:
        forget()


def once(function: Callable[P, T]) -> Callable[P, T]:
    """`function`, whose results are kept for the other rows of the same run."""
    kept = cache(function)
    _FORGET.append(kept.cache_clear)

    @wraps(function)
    def remembered(*args: P.args, **kwargs: P.kwargs) -> T:
        return kept(*args, **kwargs)  # type: ignore[arg-type]  # every argument of a row is hashable

    return remembered


def forget() -> None:
    """Drop everything that `once` has kept."""
    for clear in _FORGET:
        clear()


def order(sizes: Iterable[float], errors: Iterable[float]) -> float:
    """Observed order of convergence: slope of log error over log element size, fitted to all of them."""
    import numpy as np

    return float(np.polyfit(np.log(list(sizes)), np.log(np.abs(list(errors))), 1)[0])


FAMILIES = {
    "beams": "beam elements",
    "sandwich": "sandwich beam",
    "solids": "solid elements",
    "essentials": "patch test, rigid body, units",
    "plates": "NAFEMS plates",
    "rods": "an article meshed by gmsh",
    "dynamic-mass": "dynamic mass",
    "exudyn": "exudyn's own beams",
    "time": "base excitation in time",
    "pendulum": "rope pendulum",
}
"""Families by the name that the command takes, in the order of the table."""

_ROWS = {
    "essentials": "solids.ESSENTIALS_CHECKS",
    "beams": "beams.CHECKS",
    "sandwich": "beams.SANDWICH_CHECKS",
    "exudyn": "beams.EXUDYN_BEAMS_CHECKS",
    "solids": "solids.CHECKS",
    "plates": "solids.PLATES_CHECKS",
    "rods": "solids.RODS_CHECKS",
    "dynamic-mass": "dynamics.CHECKS",
    "time": "dynamics.DRIVEN_BASE_CHECKS",
    "pendulum": "dynamics.ROPE_PENDULUM_CHECKS",
}
"""Module of this package and name of its rows, by family."""


def checks(*families: str) -> tuple[Check, ...]:
    """The rows of `families`, of all when none is named."""
    chosen = families or tuple(FAMILIES)
    return tuple(check for family in chosen for check in _rows(family))


def _rows(family: str) -> tuple[Check, ...]:
    module, _, name = _ROWS[family].partition(".")
    rows: tuple[Check, ...] = getattr(import_module(f"validation.verification.{module}"), name)
    return rows
