"""Whether a family that somebody brings is whole: all that every command needs, and an equation that keeps its promises."""

from __future__ import annotations

import re
from collections.abc import Mapping
from math import isfinite

from geometry.errors import BadInput
from geometry.keys import nearest
from validation.effects import nothing
from validation.effects.family import OPENED, SIDES, STAGES, Family, Size
from validation.effects.form import require_form
from validation.effects.targets import ACCELEROMETER, CHANNEL, FIXED, FORCE, PART, PLACE

WORDS = {
    "what": "say in a few words what it is",
    "sentence": "say what it means to somebody who never heard of it; {target} stands for its target",
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
    require_form(family, source)
    _require_name(family.name, known, sources, source)
    for field, remedy in WORDS.items():
        if not getattr(family, field).strip():
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
    from validation.effects.trial import Trial, require_kept

    try:
        example = parse(family.example.split(", or ")[0])
    except BadInput as error:
        raise _refused(source, "example", f"{family.example!r} cannot be typed: {error.problem}", error.remedy) from None
    if example.family != family.name:
        raise _refused(source, "example", f"is one of {example.family}", f"Write one of {family.name}")
    if family.change is None:
        return
    trial = Trial(change=family.change, example=example, source=source)
    require_kept(trial, family.stage, nothing.null_values(family, example.targets, example.values))


def _require_name(name: str, known: Mapping[str, Family], sources: Mapping[str, str], source: str) -> None:
    if not NAME.fullmatch(name):
        raise _refused(source, "name", f"must be lower-case words joined by -, found {name!r}", "Write for example rope-slack")
    if name in known:
        where = sources.get(name, "massline itself")
        raise _refused(source, "name", f"an effect called {name!r} is there already, from {where}", "Choose another name")


def _require_word(word: str, words: tuple[str, ...], field: str, source: str) -> None:
    if word not in words:
        remedy = f"{nearest(word, words)}Known are {', '.join(words)}"
        raise _refused(source, field, f"must be one of those known, found {word!r}", remedy)


def _require_size(size: Size, source: str) -> None:
    what = f"sizes ({size.key})" if size.key else "sizes"
    if not size.unit.strip():
        raise _refused(source, what, "its unit is missing", 'Give it in SI, "1" for a ratio')
    if not (isfinite(size.low) and isfinite(size.high) and size.low < size.high):
        raise _refused(source, what, f"low must lie below high, found {size.low:g} and {size.high:g}", "Correct them")
    if not (isfinite(size.plausible) and size.plausible >= 0):
        raise _refused(source, what, f"plausible must be 0 or more, found {size.plausible:g}", "It is a standard deviation")


def _require_equation(family: Family, source: str) -> None:
    if family.stage == OPENED:
        problem = "is opened, and no parameter of a laboratory has its name"
        raise _refused(source, "stage", problem, f"Name what it changes, one of {', '.join(STAGES[:-1])}, and give `change`")
    if family.change is None:
        raise _refused(source, "change", "is missing", "Write change(stage, targets, values) and return the changed stage")


def _refused(source: str, field: str, problem: str, remedy: str) -> BadInput:
    return BadInput(source=source, field=field, problem=problem, remedy=remedy)
