"""The tables [[effect]] of a model file: an id of the catalogue, its value, what a fit left of its uncertainty.

[[effect]]
id = "appendage:z"
value = { m = 0.05, f = 21.0, zeta = 0.01 }     # or one number, or text as on the command line
sd = { m = 0.004 }                              # in the unit of the value
fixed = false
"""

from __future__ import annotations

from collections.abc import Mapping

from geometry.errors import BadInput
from validation.effects.catalogue import FAMILIES
from validation.effects.identifiers import Named, parse
from validation.effects.targets import Vocabulary, built_in_places
from validation.measurement_file import Fields
from validation.models.model import Added
from validation.models.notation import number, string
from validation.models.numbers import LARGEST, checked

EFFECT = ("id", "value", "sd", "fixed")


def effects_of(whole: Fields, *, anywhere: bool) -> tuple[Added, ...]:
    """The effects of the file, in its order; `anywhere` allows places and parts that no built-in article has.

    Channels are those of a campaign, of which the file knows nothing: any name will do here.

    Raises
    ------
    BadInput : an unknown key or id, with the nearest; a size that is no physics; an id that stands there twice.
    """
    if "effect" not in whole.table or whole.table["effect"] == []:
        return ()
    words = words_of(anywhere=anywhere)
    found: dict[str, Added] = {}
    for entry in whole.each("effect"):
        added = _effect(entry, words)
        if added.named.id in found:
            problem = f"{added.named.id} stands there twice"
            raise entry.refused("id", problem, "Keep one of them, with the whole size")
        found[added.named.id] = added
    return tuple(found.values())


def words_of(*, anywhere: bool) -> Vocabulary:
    """What an effect of a model file may act on."""
    if anywhere:
        return Vocabulary(accelerometers=None, forces=None, places=None, parts=None)
    return Vocabulary(accelerometers=None, forces=None, places=built_in_places())


def effect_text(added: Added) -> str:
    """The table [[effect]] of `added`, the family in words above it."""
    what = f"# {FAMILIES[added.named.family].what}"
    return "\n".join([what, "[[effect]]", *(f"{key} = {value}" for key, value in entries(added).items())])


def entries(added: Added) -> dict[str, str]:
    """By key, what [[effect]] says of `added`."""
    found = {"id": string(added.named.id)}
    for key, values in (("value", added.named.values), ("sd", added.deviation)):
        if values:
            found[key] = _values(values)
    return found | ({"fixed": "true"} if added.fixed else {})


def _values(values: Mapping[str, float]) -> str:
    if tuple(values) == ("",):
        return number(values[""])
    if "" in values:  # a number of its own and others with a name: as on the command line
        return string(",".join(f"{key}:{number(one)}" if key else number(one) for key, one in values.items()))
    return "{ " + ", ".join(f"{key} = {number(one)}" for key, one in values.items()) + " }"


def _effect(entry: Fields, words: Vocabulary) -> Added:
    entry.only(EFFECT)
    name = entry.text("id")
    if not name or "=" in name:
        problem = "is missing" if not name else f"an id without its value is expected, found {name!r}"
        raise entry.refused("id", problem, 'Write for example id = "force-gain:fmd-z2" and value = 0.08')
    value = _written(entry, "value")
    try:
        named = parse(f"{name}={value}" if value else name, words, source=entry.source)
    except BadInput as error:
        at = f"{entry.path('value' if name == error.field and value else 'id')}, {name}"
        raise BadInput(source=entry.source, field=at, problem=error.problem, remedy=error.remedy) from None
    return Added(named=named, deviation=_deviation(entry, named), fixed=entry.switch("fixed", False))


def _written(entry: Fields, key: str) -> str:
    """The value under `key` as it is typed on the command line; empty where there is none."""
    value = entry.table.get(key, "")
    if isinstance(value, str):
        return value
    if isinstance(value, dict):
        return ",".join(f"{inner}:{_typed(entry, key, one)}" for inner, one in value.items())
    return _typed(entry, key, value)


def _typed(entry: Fields, key: str, value: object) -> str:
    return repr(checked(entry, key, value, low=-LARGEST, high=LARGEST))


def _deviation(entry: Fields, named: Named) -> Mapping[str, float]:
    text = _written(entry, "sd")
    found: dict[str, float] = {}
    for part in text.split(",") if text else ():
        key, _, size = (piece.strip() for piece in part.rpartition(":"))
        if key not in named.values or key in found:
            known = ", ".join(one or "a number" for one in named.values) or "none"
            raise entry.refused("sd", f"it goes with the value, which has {known}, found {part.strip()!r}", "Correct it")
        try:
            found[key] = checked(entry, "sd", float(size), low=0.0, high=LARGEST)
        except ValueError as error:
            if isinstance(error, BadInput):
                raise
            raise entry.refused("sd", f"a number is expected, found {size!r}", "Write it in the unit of the value") from None
    return found
