"""Whether a family that somebody brings is whole: all that every command needs, and an equation that keeps its promises."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from math import isfinite
from typing import Any

import numpy as np

from geometry.errors import BadInput
from geometry.keys import nearest
from validation.effects import nothing
from validation.effects.family import CHANNEL_STAGE, OPENED, SIDES, STAGES, STRUCTURE_STAGE, Family, Size
from validation.effects.targets import ACCELEROMETER, CHANNEL, FIXED, FORCE, PART, PLACE

WORDS = {
    "what": "say in a few words what it is",
    "sentence": "say what it means to somebody who never heard of it; {target} stands for where it acts",
    "equation": "write it in one line, as in a paper",
    "confirmed_by": "say what would confirm it in the laboratory",
    "reference": "say where the equation comes from",
}
"""What every family must say, and how."""

KINDS = (*FIXED, CHANNEL, FORCE, ACCELEROMETER, PLACE, PART)
NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")


def require_whole(family: Family, known: Mapping[str, Family], sources: Mapping[str, str], source: str) -> None:
    """Refuse a family that lacks something, or has a name that is taken.

    Raises
    ------
    BadInput : its file (`source`), the field, what was found, and what to write.
    """
    _require_name(family.name, known, sources, source)
    for field, remedy in WORDS.items():
        if not str(getattr(family, field) or "").strip():
            raise _refused(source, field, "is missing", f"{field}=...: {remedy}")
    _require_word(family.side, SIDES, "side", source)
    _require_word(family.stage, STAGES, "stage", source)
    for kind in family.targets:
        _require_word(kind, KINDS, "targets", source)
    for size in dict.fromkeys((*family.sizes, *(one for sizes in family.varying.values() for one in sizes))):
        _require_size(size, source)
    _require_equation(family, source)


def require_usable(family: Family, source: str) -> None:
    """Refuse a family of the catalogue whose example cannot be typed, or whose equation breaks a promise.

    Raises
    ------
    BadInput : as in `require_whole`.
    """
    from validation.effects.identifiers import parse

    try:
        example = parse(family.example.split(", or ")[0])
    except BadInput as error:
        raise _refused(source, "example", f"{family.example!r} cannot be typed: {error.problem}", error.remedy) from None
    if example.family != family.name:
        raise _refused(source, "example", f"is one of {example.family}", f"Write one of {family.name}")
    if family.change is None:
        return
    before = nothing.tried(family.stage)
    after = _changed(family, before, example.targets, example.values, source)
    null = nothing.null_values(family, example.targets, example.values)
    if null is not None:
        same = _changed(family, before, example.targets, null, source)
        if not nothing.unchanged(before, same):
            sizes = ", ".join(f"{key or 'size'} {value:g}" for key, value in null.items())
            raise _refused(source, "change", f"changes something at {sizes}, where there is no effect", "Correct it, or `null`")
    if family.stage == CHANNEL_STAGE:
        _require_linear(family, before, after, example.targets, example.values, source)
    if family.stage == STRUCTURE_STAGE:
        _require_adding(family, before, after, example.targets, example.values, source)


def _require_name(name: str, known: Mapping[str, Family], sources: Mapping[str, str], source: str) -> None:
    if not isinstance(name, str) or not NAME.fullmatch(name):
        raise _refused(source, "name", f"must be lower-case words joined by -, found {name!r}", "Write for example rope-slack")
    if name in known:
        where = sources.get(name, "massline itself")
        raise _refused(source, "name", f"an effect called {name!r} is there already, from {where}", "Choose another name")


def _require_word(word: str, words: tuple[str, ...], field: str, source: str) -> None:
    if word not in words:
        remedy = f"{nearest(str(word), words)}Known are {', '.join(words)}"
        raise _refused(source, field, f"must be one of those known, found {word!r}", remedy)


def _require_size(size: object, source: str) -> None:
    if not isinstance(size, Size):
        raise _refused(source, "sizes", f"must be Size(...), found {size!r}", "Write sizes=(Size(unit=..., low=..., high=...),)")
    what = f"sizes ({size.key})" if size.key else "sizes"
    if not str(size.unit or "").strip():
        raise _refused(source, what, "its unit is missing", 'Give it in SI, "1" for a ratio')
    if not (isfinite(size.low) and isfinite(size.high) and size.low < size.high):
        raise _refused(source, what, f"low must lie below high, found {size.low:g} and {size.high:g}", "Correct them")
    if not (isfinite(size.plausible) and size.plausible >= 0):
        raise _refused(source, what, f"plausible must be 0 or more, found {size.plausible:g}", "It is a standard deviation")


def _require_equation(family: Family, source: str) -> None:
    if family.stage == OPENED:
        problem = "is opened, and no parameter of a laboratory has its name"
        raise _refused(source, "stage", problem, f"Name what it changes, one of {', '.join(STAGES[:-1])}, and give `change`")
    if not callable(family.change):
        problem = "is missing" if family.change is None else f"must be a function, found {family.change!r}"
        raise _refused(source, "change", problem, "Write change(stage, targets, values) and return the changed stage")


def _changed(family: Family, stage: Any, targets: tuple[str, ...], values: Mapping[str, float], source: str) -> Any:
    if family.change is None:
        return stage
    found = family.change(stage, targets, values)
    if type(found) is not type(stage):
        problem = f"must return the changed {type(stage).__name__}, found {type(found).__name__}"
        raise _refused(source, "change", problem, "Return dataclasses.replace(stage, ...)")
    return found


def _require_linear(
    family: Family, before: Any, after: Any, targets: tuple[str, ...], values: Mapping[str, float], source: str
) -> None:
    """Channels: twice the rows must become twice what they became, since derivatives take the same way."""
    turned = np.exp(0.7j) * 2.0
    twice = _changed(family, replace(before, rows=turned * before.rows), targets, values, source)
    if not np.allclose(twice.rows, turned * after.rows, rtol=0, atol=1e-9 * float(np.max(np.abs(after.rows)))):
        problem = "is not linear in `rows`: derivatives could not pass through it"
        raise _refused(source, "change", problem, "Multiply rows, or add one to another; take levels from `amplitude`")


def _require_adding(
    family: Family, before: Any, after: Any, targets: tuple[str, ...], values: Mapping[str, float], source: str
) -> None:
    """Structures: what is added may not depend on the matrices that it is added to, since their derivatives pass unchanged."""
    names = ("mass", "stiffness", "viscous", "structural")
    more = replace(before, **{name: 1.5 * getattr(before, name) for name in names})
    other = _changed(family, more, targets, values, source)
    for name in names:
        was, n = getattr(before, name), len(before.mass)
        shift = getattr(other, name)[:n, :n] - getattr(after, name)[:n, :n]
        if not np.allclose(shift, 0.5 * was, rtol=0, atol=1e-9 * float(np.max(np.abs(was)))):
            problem = f"adds to `{name}` what depends on the matrices that are there: derivatives could not pass through it"
            raise _refused(source, "change", problem, "Build what is added of `places`, `parts` and `cog`")


def _refused(source: str, field: str, problem: str, remedy: str) -> BadInput:
    return BadInput(source=source, field=field, problem=problem, remedy=remedy)
