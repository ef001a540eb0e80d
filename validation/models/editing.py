"""The text of a model file with an effect more or less: every other line, and every comment, stays as its author wrote it.

An effect is its ``[[effect]]`` line, the comment right above it, and all down to its last key. What an edit came to is read
again and held against what was meant, so that a layout that these lines do not foresee is refused and never damaged.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from geometry.errors import BadInput
from geometry.keys import nearest
from validation.models import reading
from validation.models.effects import effect_text, entries
from validation.models.model import Added, Model

HEADER = re.compile(r"\s*\[\[\s*(effect|'effect'|\"effect\")\s*\]\]")
INNER = re.compile(r"\s*\[\s*effect\s*\.")
TABLE = re.compile(r"\s*\[")
KEY = re.compile(r"(?P<key>\s*(?P<name>value|sd|fixed)\s*=\s*)(?P<value>[^#]*?)(?P<rest>\s*(?:#.*)?)$")
EDITED = ("value", "sd", "fixed")
SOURCE = "model file"


def with_effect(text: str, added: Added, source: str = SOURCE) -> str:
    """`text` of the file `source` with `added`: in the place of the effect of the same id, else as the last one.

    Raises
    ------
    BadInput : `text` is no model file, or its effects do not stand as [[effect]].
    """
    before = _read(text, source)
    ids = [one.named.id for one in before.effects]
    if added.named.id not in ids:
        return _verified(f"{text.rstrip()}\n\n{effect_text(added)}\n", [*before.effects, added], before)
    place = ids.index(added.named.id)
    meant = [*before.effects[:place], added, *before.effects[place + 1 :]]
    lines = text.split("\n")
    _, header, end = _span(lines, place, before)
    for body in (_changed(lines[header:end], entries(added)), effect_text(added).splitlines()[1:]):
        edited = "\n".join([*lines[:header], *body, *lines[end:]])
        if _says(edited, meant, before):
            return edited
    raise _laid_out_otherwise(before.source)


def without_effect(text: str, id: str, source: str = SOURCE) -> str:
    """`text` of the file `source` without the effect `id`.

    Raises
    ------
    BadInput : `text` is no model file, has no such effect, or its effects do not stand as [[effect]].
    """
    before = _read(text, source)
    ids = [one.named.id for one in before.effects]
    if id not in ids:
        known = f"it has {', '.join(ids)}" if ids else "it has none"
        raise BadInput(source=source, field=id, problem="the model has no such effect", remedy=f"{nearest(id, ids)}{known}")
    place = ids.index(id)
    lines = text.split("\n")
    first, _, end = _span(lines, place, before)
    if first and not lines[first - 1].strip():  # one empty line between what stays is enough
        first -= 1
    edited = "\n".join([*lines[:first], *lines[end:]])
    return _verified(edited, [*before.effects[:place], *before.effects[place + 1 :]], before)


def _read(text: str, source: str) -> Model:
    if source.lower().endswith(".json"):
        problem = "it is JSON, which is read but not edited: it has no comments to keep"
        raise BadInput(source=source, problem=problem, remedy=f"massline model {source} --out FILE.toml writes it as TOML")
    return reading.of_text(text, source)


def _span(lines: Sequence[str], place: int, before: Model) -> tuple[int, int, int]:
    """Of the effect at `place`: its first line of comment, its header, and the line after its last key."""
    headers = [k for k, line in enumerate(lines) if HEADER.match(line)]
    if len(headers) != len(before.effects):
        raise _laid_out_otherwise(before.source)
    first = header = headers[place]
    while first and lines[first - 1].lstrip().startswith("#"):
        first -= 1
    following = (k for k in range(header + 1, len(lines)) if TABLE.match(lines[k]) and not INNER.match(lines[k]))
    end = next(following, len(lines))
    while not lines[end - 1].strip() or lines[end - 1].lstrip().startswith("#"):
        end -= 1
    return first, header, end


def _changed(body: Sequence[str], says: Mapping[str, str]) -> list[str]:
    """The lines of one effect with its value, sd and fixed replaced, their comments kept; what is new comes last."""
    left = {key: says[key] for key in EDITED if key in says}
    lines: list[str] = []
    for line in body:
        found = KEY.match(line)
        if found is None:
            lines.append(line)
        elif found["name"] in left:
            lines.append(f"{found['key']}{left.pop(found['name'])}{found['rest']}")
        elif found["name"] == "fixed":
            lines.append(f"{found['key']}false{found['rest']}")
    return [*lines, *(f"{key} = {value}" for key, value in left.items())]


def _verified(text: str, meant: Sequence[Added], before: Model) -> str:
    if not _says(text, meant, before):
        raise _laid_out_otherwise(before.source)
    return text


def _says(text: str, meant: Sequence[Added], before: Model) -> bool:
    """Whether `text` is the model `before` with the effects that were `meant`."""
    try:
        after = reading.of_text(text, before.source)
    except BadInput:
        return False
    return _facts(after, after.effects) == _facts(before, meant)


def _facts(model: Model, effects: Sequence[Added]) -> tuple[object, ...]:
    """All that a model says, in a form that can be compared."""
    stiffness = None if model.cell_stiffness is None else tuple(model.cell_stiffness)
    fmd = None if model.fmd is None else tuple(model.fmd.parameters)
    same = (model.title, model.article, model.hardware, model.gravity, model.fmd_tolerance, model.tolerances, model.structure)
    more = (model.kind, model.modes, model.damping_ratio, dict(model.changes), dict(model.own), stiffness, fmd)
    added = [(one.named.id, dict(one.named.values), dict(one.deviation), one.fixed) for one in effects]
    return (*same, *more, added)


def _laid_out_otherwise(source: str) -> BadInput:
    problem = "its effects are not laid out so that one can be changed alone"
    return BadInput(source=source, field="effect", problem=problem, remedy="Write each as a table of its own, [[effect]]")
