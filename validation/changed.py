"""The user's own dimensions of built-in articles, ``--set KEY=VALUE``: read, and said wherever a figure rests on them."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence

import numpy as np

from geometry import keys
from geometry.agreement import rounding
from geometry.articles import built_in, changes_of, dimension_files
from geometry.errors import BadInput

OPTION = "--set"

LARGEST = 1e6
"""In the dimension files' own units (mm, degrees, counts): a kilometre."""


def read(settings: Sequence[str]) -> dict[str, float]:
    """The changes that ``KEY=VALUE`` texts ask for, by key, in the unit of the dimension file; keys are not checked here.

    Raises
    ------
    BadInput : no "=", a value that is no finite number of a thinkable size, a key that is set twice.
    """
    changes: dict[str, float] = {}
    for text in settings:
        key, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not key:
            raise _refused("", f"KEY=VALUE is expected, found {text!r}", "Write for example fmd.load_cell.moving_fraction=0.6")
        if key in changes:
            raise _refused(key, f"it is set twice, to {changes[key]:g} and {value}", "Keep one of them")
        changes[key] = _number(key, value)
    return changes


def require_used(names: Collection[str], changes: Mapping[str, float]) -> None:
    """Refuse a change that speaks of a part that none of the built-in articles `names` has.

    Raises
    ------
    BadInput : such a change, or an article that does not exist.
    """
    known = sorted({file for name in names for file in dimension_files(name)})
    for key in changes:
        file = key.split(".")[0]
        if file not in known:
            remedy = f"{keys.nearest(file, known)}Keys begin with {', '.join(known)}" if known else "Name a built-in article"
            raise _refused(key, f"no article here has a part {file!r}", remedy)


def footnote(name: str, changes: Mapping[str, float], in_print: bool) -> str:
    """A sentence on what `changes` do to the article `name`, of which something is published or not; empty without any."""
    own = changes_of(name, changes)
    if not own:
        return ""
    idle = [key for key in own if not _acts(name, own, key)]
    words = [f"Dimensions changed: {', '.join(f'{key} = {value:g}' for key, value in own.items())}"]
    words += [f"without effect on its inertia: {', '.join(idle)}"] if idle else []
    words += ["published and measured values are those of the unchanged article"] if in_print else []
    return f"{'; '.join(words)}."


def _acts(name: str, changes: Mapping[str, float], key: str) -> bool:
    from geometry import multibody

    without = multibody.inertia(built_in(name, {k: v for k, v in changes.items() if k != key}))
    difference = np.abs(multibody.inertia(built_in(name, changes)).parameters - without.parameters)
    return bool(np.any(difference > rounding(without)))


def _number(key: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise _refused(key, f"a number is expected, found {text!r}", "Write it alone, in the unit that the key names") from None
    if not math.isfinite(value) or abs(value) > LARGEST:
        raise _refused(key, f"no dimension has this size, found {text}", "Check the number and the unit that the key names")
    return value


def _refused(key: str, problem: str, remedy: str) -> BadInput:
    return BadInput(source=OPTION, field=key, problem=problem, remedy=remedy)
