"""``ID=VALUE`` and ``ID=key:number,key:number``: an effect as a user writes it, checked against the catalogue.

parse("force-gain:fmd-z2=0.08")
parse("accelerometer-position:cover-z3:x=0.01")
parse("appendage:z=m:0.05,f:21,zeta:0.01")
parse("polarity:fmd-z2")
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from types import MappingProxyType

from geometry.errors import BadInput
from geometry.keys import nearest
from validation.effects.catalogue import FAMILIES
from validation.effects.family import Family, Size
from validation.effects.targets import Vocabulary, built_in_places

MISTAKEN_UNIT = "unit"
"""The family whose value may be a word."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Named:
    """An effect of the catalogue by its name, with its size.

    Attributes
    ----------
    family : a key of `FAMILIES`
    targets : where it acts, in the order of the identifier
    values : in SI by key, the empty key for a number that stands alone; empty for a mistake that has no size
    """

    family: str
    targets: tuple[str, ...] = ()
    values: Mapping[str, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "targets", tuple(self.targets))
        object.__setattr__(self, "values", MappingProxyType(dict(self.values)))

    @property
    def id(self) -> str:
        """``family:target``, as in the catalogue."""
        return ":".join((self.family, *self.targets))

    @property
    def target(self) -> str:
        """The first target; empty where there is none."""
        return self.targets[0] if self.targets else ""

    @property
    def value(self) -> float:
        """The number that stands alone; 1 for a mistake that has no size."""
        return self.values.get("", 1.0)

    @property
    def what(self) -> str:
        """The family in a few words."""
        return FAMILIES[self.family].what

    @property
    def sizes(self) -> tuple[Size, ...]:
        """What the catalogue says of its values."""
        return FAMILIES[self.family].sizes_at(self.targets)

    @property
    def fitted_sizes(self) -> tuple[Size, ...]:
        """Those of them that a fit looks for."""
        return tuple(size for size in self.sizes if size.plausible > 0)

    @property
    def unit(self) -> str:
        """Of the number that stands alone; empty where there is none."""
        return next((size.unit for size in self.sizes if not size.key), "")

    def __str__(self) -> str:
        written = ",".join(f"{key}:{value:.9g}" if key else f"{value:.9g}" for key, value in self.values.items())
        return f"{self.id}={written}" if written else self.id


def parse(text: str, words: Vocabulary | None = None, *, source: str = "--effect") -> Named:
    """The effect that `text` names.

    Parameters
    ----------
    words : channels and places that there are; those of the virtual tests where nothing is said
    source : where the text stands, for messages

    Raises
    ------
    BadInput : an unknown family or target, with the nearest; a target too many or too few; a value that is missing, surplus, no
        number, or of a size that is no physics.
    """
    words = Vocabulary(places=built_in_places()) if words is None else words
    name, equals, value = (part.strip() for part in text.partition("="))
    family, *targets = (part.strip() for part in name.split(":"))
    known = _family(family, source)
    _require_targets(known, name, targets, words, source)
    sizes = known.sizes_at(tuple(targets))
    if equals and not value:
        raise _refused(source, name, "its value is missing", known)
    if family == MISTAKEN_UNIT and value:
        value = _as_factor(value, targets[0], words, name, source)
    values = _values(name, value, known, sizes, source)
    return Named(family=family, targets=tuple(targets), values=values)


def parse_all(texts: Sequence[str], words: Vocabulary | None = None, *, source: str = "--effect") -> tuple[Named, ...]:
    """The effects that `texts` name, each one once.

    Raises
    ------
    BadInput : see `parse`; one of them stands there twice.
    """
    found: dict[str, Named] = {}
    for text in texts:
        effect = parse(text, words, source=source)
        if effect.id in found:
            problem = "is given twice"
            raise BadInput(source=source, field=effect.id, problem=problem, remedy="Keep one of them, with the whole size")
        found[effect.id] = effect
    return tuple(found.values())


def _family(name: str, source: str) -> Family:
    if name not in FAMILIES:
        remedy = f"{nearest(name, FAMILIES)}`massline effects` lists all of them; your own come with --effects-from DIR"
        raise BadInput(source=source, field=name, problem=f"no effect is called {name!r}", remedy=remedy)
    return FAMILIES[name]


def _require_targets(family: Family, name: str, targets: list[str], words: Vocabulary, source: str) -> None:
    kinds = family.targets
    if not len(kinds) - family.optional <= len(targets) <= len(kinds):
        wanted = " and ".join(kinds) or "no target"
        raise _refused(source, name, f"it acts on {wanted}, found {':'.join(targets) or 'none'}", family)
    for kind, target in zip(kinds, targets, strict=False):
        legal = words.legal(kind)
        if legal is not None and target not in legal:
            _refuse_target(family, name, kind, target, legal, source)
    if len(set(targets)) < len(targets) and len(set(kinds)) < len(kinds):
        raise _refused(source, name, f"{targets[0]} is named twice", family)


def _refuse_target(family: Family, name: str, kind: str, target: str, legal: tuple[str, ...], source: str) -> None:
    near = nearest(target, legal)
    remedy = f"{near}Known are {', '.join(legal)}" if legal else "Leave it out"
    raise BadInput(source=source, field=name, problem=f"no {kind} is called {target!r}", remedy=remedy)


def _values(name: str, text: str, family: Family, sizes: tuple[Size, ...], source: str) -> dict[str, float]:
    by_key = {size.key: size for size in sizes}
    values: dict[str, float] = {}
    for part in text.split(",") if text else ():
        key, colon, number = (piece.strip() for piece in part.rpartition(":"))
        if key not in by_key or bool(colon) != bool(key):
            raise _refused(source, name, _surplus(part.strip(), by_key), family)
        if key in values:
            raise _refused(source, name, f"{key or 'its value'} is given twice", family)
        values[key] = _sane(source, name, number, by_key[key], family)
    missing = [size for size in sizes if size.key not in values and size.default is None]
    if missing:
        raise _refused(source, name, f"its {missing[0].key or 'value'} [{missing[0].unit}] is missing", family)
    return {size.key: values.get(size.key, size.default or 0.0) for size in sizes}


def _surplus(part: str, sizes: Mapping[str, Size]) -> str:
    if not sizes:
        return f"it is there or not and has no value, found {part!r}"
    expected = ", ".join(f"{key}:number" if key else "a number" for key in sizes)
    return f"its value is {expected}, found {part!r}"


def _sane(source: str, name: str, text: str, size: Size, family: Family) -> float:
    try:
        value = float(text)
    except ValueError:
        raise _refused(source, name, f"a number in SI units is expected, found {text!r}", family) from None
    what = f"{size.key} [{size.unit}]" if size.key else f"its size [{size.unit}]"
    if not isfinite(value) or (size.whole and value != round(value)) or not size.low <= value <= size.high:
        limits = f"{size.low:g} or {size.high:g}" if size.whole else f"between {size.low:g} and {size.high:g}"
        problem = f"{what} must be {limits}, found {text}"
        raise BadInput(source=source, field=name, problem=problem, remedy=f"Check its unit; for example {family.example}")
    return value


def _as_factor(text: str, channel: str, words: Vocabulary, name: str, source: str) -> str:
    """`text`, and where it is a unit of what `channel` measures, the factor by which numbers in it differ from SI."""
    from identification.units import UNITS

    measured = ("force", "moment") if channel in (words.forces or ()) else ("acceleration",)
    quantities = measured if words.forces is not None else tuple(UNITS)
    sizes = {unit: size for quantity in quantities for unit, size in UNITS[quantity].items()}
    if text in sizes:
        return repr(1 / sizes[text])
    if text[:1].isalpha() and not text.lower().startswith(("nan", "inf")):
        problem = f"neither a factor nor a unit of {channel}, found {text!r}"
        raise BadInput(source=source, field=name, problem=problem, remedy=f"{nearest(text, sizes)}Known are {', '.join(sizes)}")
    return text


def _refused(source: str, name: str, problem: str, family: Family) -> BadInput:
    return BadInput(source=source, field=name, problem=problem, remedy=f"Write for example {family.example}")
