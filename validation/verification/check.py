"""`Check`: one row of the verification table - a reference with where it comes from, a way to find the value, and a bar."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import Enum
from functools import cache, partial, wraps
from importlib import import_module
from operator import attrgetter
from typing import NamedTuple, ParamSpec, TypeVar

from validation.output import counted, derived, entry, plain_unit

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


Find = TypeVar("Find", bound=Callable[..., Found])


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
    """A check with what it found; see `Check`."""

    family: str
    what: str
    reference: float
    source: str
    value: float
    unit: str = entry(write=plain_unit)
    error_is: Error = entry(write=attrgetter("value"), read=Error)
    bar: float

    @property
    @derived("error", before="error_is")
    def error(self) -> float:
        """Size of the error, relative or absolute as the check asks; infinite where the value is no number."""
        size = float(abs(self.value - self.reference))
        relative = self.error_is is Error.RELATIVE
        return size / abs(self.reference) if relative and self.reference else size if math.isfinite(size) else math.inf

    @property
    @derived("pass")
    def passed(self) -> bool:
        """Whether the error stays at or below the bar; what is no number never does."""
        return bool(self.error <= self.bar)


class Rows:
    """The rows of a family in their order, each of which stands above the function that finds its value."""

    def __init__(self, family: str) -> None:
        self.family = family
        self.checks: list[Check] = []

    def relative(self, what: str, source: str, unit: str, bar: float, *given: object) -> Callable[[Find], Find]:
        """A row whose error is a share of the reference; the function has `given` before the mesh."""
        return self._row(what, source, unit, bar, Error.RELATIVE, given)

    def absolute(self, what: str, source: str, bar: float, *given: object, unit: str = "") -> Callable[[Find], Find]:
        """A row whose reference is zero, or whose error is to be seen in its own unit."""
        return self._row(what, source, unit, bar, Error.ABSOLUTE, given)

    def _row(
        self, what: str, source: str, unit: str, bar: float, error: Error, given: tuple[object, ...]
    ) -> Callable[[Find], Find]:
        def put(find: Find) -> Find:
            found = partial(find, *given)
            self.checks.append(Check(family=self.family, what=what, source=source, unit=unit, bar=bar, find=found, error=error))
            return find

        return put


def run(checks: Iterable[Check], mesh: Mesh = Mesh.FAST, *, quiet: bool = True) -> list[CheckResult]:
    """Every check done, in order. What several of them share is computed once, and computed anew in the next run."""
    listed = list(checks)
    announced = counted([check.what for check in listed], "checking", quiet=quiet)
    forget()
    try:
        return [result(check, check.find(mesh)) for check, _ in zip(listed, announced, strict=True)]
    finally:
        forget()


def result(check: Check, found: Found) -> CheckResult:
    """`check` with what it `found`."""
    return CheckResult(
        family=check.family,
        what=check.what,
        reference=found.reference,
        source=check.source,
        value=found.value,
        unit=check.unit,
        error_is=check.error,
        bar=check.bar,
    )


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


_TOLD = {
    "beams": ("beam elements", "beams.BARS"),
    "sandwich": ("sandwich beam", "beams.SANDWICH"),
    "solids": ("solid elements", "solids.SOLIDS"),
    "essentials": ("patch test, rigid body, units", "solids.ESSENTIALS"),
    "plates": ("NAFEMS plates", "solids.PLATES"),
    "rods": ("an article meshed by gmsh", "solids.RODS"),
    "dynamic-mass": ("dynamic mass", "dynamics.DYNAMIC_MASS"),
    "exudyn": ("exudyn's own beams", "beams.EXUDYN_BEAMS"),
    "time": ("base excitation in time", "dynamics.DRIVEN_BASE"),
    "pendulum": ("rope pendulum", "dynamics.ROPE_PENDULUM"),
}

FAMILIES = {name: words for name, (words, _) in _TOLD.items()}
"""Families by the name that the command takes, in the order of the table."""

_ROWS = {name: rows for name, (_, rows) in _TOLD.items()}
"""Module of this package and name of its rows, by family."""


def checks(*families: str) -> tuple[Check, ...]:
    """The rows of `families`, of all when none is named."""
    found: list[Check] = []
    for family in families or tuple(FAMILIES):
        module, _, name = _ROWS[family].partition(".")
        found += getattr(import_module(f"validation.verification.{module}"), name).checks
    return tuple(found)
