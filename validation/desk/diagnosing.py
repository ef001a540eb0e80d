"""What the model as it stands is missing: diagnosed once, kept in the desk; and one effect explained to a person."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from validation.desk.desk import Desk

Progress = Callable[[str, float], None]


@dataclass(frozen=True, kw_only=True)
class Shown:
    """One size of an effect.

    Attributes
    ----------
    key : empty for the one that stands alone
    value, low, high : SI; the last two a 90 % interval, equal to the value where it was not fitted
    unit : SI
    text : value and half-width in words, "+7.9 ± 0.2 %"
    """

    key: str
    value: float
    low: float
    high: float
    unit: str
    text: str


@dataclass(frozen=True, eq=False, kw_only=True)
class Explained:
    """One effect, for somebody who never heard of it.

    Attributes
    ----------
    id : ``family:target``
    written : with its size, as `massline add` takes it
    what : in a few words
    text : what it means here
    equation, reference : of the catalogue
    sizes : as the diagnosis found them; none of one that it did not try
    evidence : [nats]; None where it was not tried
    aliases : ids that these data cannot tell from it
    mistaken_for : ids or families that look like it
    confirmed_by : what would confirm it in the laboratory
    separating : measurements that would tell it from its aliases, the best first, in words
    note : what the data say of it beyond its size
    """

    id: str
    written: str
    what: str
    text: str
    equation: str
    reference: str
    sizes: tuple[Shown, ...]
    evidence: float | None
    aliases: tuple[str, ...]
    mistaken_for: tuple[str, ...]
    confirmed_by: str
    separating: tuple[str, ...]
    note: str


def diagnosed(of: Desk, candidates: Sequence[str] = (), progress: Progress | None = None) -> Mapping[str, Any]:
    """The diagnosis of the model of the desk, kept: the object of `massline diagnose --json`.

    Takes from seconds to minutes: `validation.desk.jobs.start(desk, "diagnose")` does it in a worker.

    Raises
    ------
    BadInput : model or data that cannot be used, a candidate that could not act on them.
    CheckFailed : the model with all its tolerances does not converge.
    """
    raise NotImplementedError


def diagnosis(of: Desk) -> Mapping[str, Any] | None:
    """That of the model as it stands, if it was made; quick."""
    raise NotImplementedError


def explained(of: Desk, effect: str) -> Explained:
    """`effect` (an id, or with its size) as the diagnosis and the catalogue speak of it. Its curves: `whatif.what_if`.

    Raises
    ------
    BadInput : no such effect, with the nearest.
    """
    raise NotImplementedError
