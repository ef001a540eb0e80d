"""Where effects are found: the files of `validation/effects/families`, entry points ``massline.effects``, folders of a user.

What opens a parameter that a model has already is a table of their ``opened.toml``; what changes an equation has a `FAMILY`.
The catalogue of a process only grows: `load` adds what a user brings.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from inspect import getsourcefile, ismodule
from math import isfinite
from pathlib import Path
from types import MappingProxyType

import numpy as np

from geometry.cache import content
from geometry.errors import BadInput
from geometry.toml_file import nearest
from validation.effects import effect as effect_types
from validation.effects import own
from validation.effects.stages import Matrices

GROUP = "massline.effects"
"""Of the entry points by which an installed package brings families: modules with a `FAMILY`, or families themselves."""

ORDER = [
    *("point-mass", "rigid-inertia", "modulus", "mass", "thickness", "support-stiffness", "connection-compliance"),
    *("gravity-stiffness", "joint-compliance", "structural-damping", "layer-damping", "appendage", "absorber", "slosh"),
    *("cable", "orientation", "mounting-offset", "gravity", "force-gain", "load-path-shunt", "force-delay"),
    *("board-delay", "force-highpass", "force-crosstalk", "force-plane-offset", "force-misalignment", "force-position"),
    *("fmd-compliance", "cell-stiffness", "accelerometer-gain", "accelerometer-delay", "accelerometer-position"),
    *("accelerometer-misalignment", "accelerometer-tilt", "cover-plate-flexibility", "transducer-mass"),
    *("exponential-window", "leakage", "polarity", "channel-swap", "unit", "wrong-direction", "wrong-place"),
    *("wrong-reference", "friction", "gap", "saturation", "sweep-bias", "noise", "mains", "pendulum-amplitude"),
    *("pendulum-damping", "rope-mass", "rope-elasticity", "air-inertia", "off-centre-suspension"),
]
"""Of the catalogue's page; what is not in it follows."""


_found: dict[str, effect_types.Family] = {}

FAMILIES: Mapping[str, effect_types.Family] = MappingProxyType(_found)
"""Every family by name, in the order of the catalogue."""

_sources: dict[str, str] = {}

SOURCES: Mapping[str, str] = MappingProxyType(_sources)
"""By name of a family that the package does not bring: the file or the entry point that it came from."""

_files: dict[Path, str] = {}


def load(directory: str | Path) -> tuple[effect_types.Family, ...]:
    """The families in the files of `directory`, from now on in the catalogue. A file that was read before is not read again.

    What begins with an underscore is no effect.

    Raises
    ------
    BadInput : no such folder, a file without a family, or one that is not whole (see `own.require_whole`, `own.require_usable`);
        then none of the folder's is added.
    """
    folder = Path(directory)
    if not folder.is_dir():
        problem = "it is a file" if folder.exists() else "there is no such folder"
        raise BadInput(str(folder), "--effects-from", problem, "Name a folder of effects")
    paths = sorted(path.resolve() for path in folder.glob("*.py") if not path.name.startswith("_"))
    if not paths:
        problem = "it holds no file of an effect, *.py"
        raise BadInput(str(folder), "--effects-from", problem, "Write one: docs/effects.md shows how, examples/effects holds two")
    found = [(path, own.read(path)) for path in paths if path not in _files]
    added: list[Path] = []
    try:
        for path, family in found:
            _add(family, str(path))
            _files[path] = family.name
            added.append(path)
    except BaseException:
        for path in added:
            _forget(_files.pop(path))
        raise
    return tuple(_found[_files[path]] for path in paths)


def _add(family: effect_types.Family, source: str) -> None:
    own.require_whole(family, FAMILIES, SOURCES, source)
    _found[family.name], _sources[family.name] = family, source
    try:
        require_usable(family, source)
    except BaseException:
        _forget(family.name)
        raise


def _forget(name: str) -> None:
    del _found[name], _sources[name]


def require_usable(family: effect_types.Family, source: str) -> None:
    """Refuse a family of the catalogue whose example cannot be typed, or whose equation breaks a promise.

    Raises
    ------
    BadInput : as in `validation.effects.own.require_whole`, or as `validation.effects.own.require_usable`.
    """
    try:
        example = parse(family.example.split(", or ")[0])
    except BadInput as error:
        raise own.unsound(source, "example", f"{family.example!r} cannot be typed: {error.problem}", error.remedy) from None
    if example.family != family.name:
        raise own.unsound(source, "example", f"is one of {example.family}", f"Write one of {family.name}")
    own.require_usable(family, example.targets, example.values, source)


def code_of_families(folders: Iterable[str]) -> str:
    """Digest of what families do that come from elsewhere: all in the `folders` of a user's own, and which others there are."""
    beside = {Path(one).parent for one in SOURCES.values() if Path(one).is_file()}
    files = [file for folder in sorted(beside) for file in sorted(folder.glob("*.py"))]
    return content([*folders, *files]) + "".join(f"{name} {source};" for name, source in sorted(SOURCES.items()))


def add_installed(points: Iterator[EntryPoint]) -> None:
    """The families of entry points, into the catalogue.

    Raises
    ------
    BadInput : one of them cannot be imported, or is not whole.
    """
    for point in points:
        package = f"{point.dist.name} {point.dist.version}" if point.dist else "a package"
        source = f"entry point {point.name} = {point.value} of {package}"
        try:
            value = point.load()
        except Exception as error:
            raise own.in_words(error, source, GROUP) from None
        file = (getsourcefile(value) if ismodule(value) else None) or source
        _add(own.of(getattr(value, "FAMILY", value), file), source)


_opened = import_module("validation.effects.families.opened").FAMILIES
for _name in ORDER:
    _file = f"validation.effects.families.{_name.replace('-', '_')}"
    _found[_name] = _opened[_name] if _name in _opened else import_module(_file).FAMILY
add_installed(iter(entry_points(group=GROUP)))


# ``ID=VALUE`` and ``ID=key:number,key:number``: an effect as a user writes it, checked against the catalogue.
#
# parse("force-gain:fmd-z2=0.08")
# parse("accelerometer-position:cover-z3:x=0.01")
# parse("appendage:z=m:0.05,f:21,zeta:0.01")
# parse("polarity:fmd-z2")


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
    def sizes(self) -> tuple[effect_types.SizeSpec, ...]:
        """What the catalogue says of its values."""
        return FAMILIES[self.family].sizes_at(self.targets)

    @property
    def fitted_sizes(self) -> tuple[effect_types.SizeSpec, ...]:
        """Those of them that a fit looks for."""
        return tuple(size for size in self.sizes if size.plausible > 0)

    @property
    def unit(self) -> str:
        """Of the number that stands alone; empty where there is none."""
        return next((size.unit for size in self.sizes if not size.key), "")

    def __str__(self) -> str:
        written = ",".join(f"{key}:{value:.9g}" if key else f"{value:.9g}" for key, value in self.values.items())
        return f"{self.id}={written}" if written else self.id


def parse(text: str, words: effect_types.Vocabulary | None = None, *, source: str = "--effect") -> Named:
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
    words = effect_types.Vocabulary(places=effect_types.built_in_places()) if words is None else words
    name, equals, value = (part.strip() for part in text.partition("="))
    family, *targets = (part.strip() for part in name.split(":"))
    if family not in FAMILIES:
        remedy = f"{nearest(family, FAMILIES)}`massline effects` lists all of them; your own come with --effects-from DIR"
        raise BadInput(source, family, f"no effect is called {family!r}", remedy)
    known = FAMILIES[family]
    kinds = known.targets
    if not len(kinds) - known.optional <= len(targets) <= len(kinds):
        wanted = " and ".join(kinds) or "no target"
        raise _refused(source, name, f"it acts on {wanted}, found {':'.join(targets) or 'none'}", known)
    for kind, target in zip(kinds, targets, strict=False):
        legal = words.legal(kind)
        if kind == effect_types.PLACE and legal is None and target.startswith(effect_types.AT):
            if effect_types.position(target) is None:
                remedy = f"Write for example {family}:{effect_types.at_position((0.1, 0, 0.25))}"
                raise BadInput(source, name, f"{target!r} is no x,y,z in metres", remedy)
        elif legal is not None and target not in legal:
            remedy = f"{nearest(target, legal)}Known are {', '.join(legal)}" if legal else "Leave it out"
            raise BadInput(source, name, f"no {kind} is called {target!r}", remedy)
    if len(set(targets)) < len(targets) and len(set(kinds)) < len(kinds):
        raise _refused(source, name, f"{targets[0]} is named twice", known)
    sizes = known.sizes_at(tuple(targets))
    if equals and not value:
        raise _refused(source, name, "its value is missing", known)
    if family == MISTAKEN_UNIT and value:
        value = _as_factor(value, targets[0], words, name, source)
    values = _values(name, value, known, sizes, source)
    return Named(family=family, targets=tuple(targets), values=values)


def parse_all(texts: Sequence[str], words: effect_types.Vocabulary | None = None) -> tuple[Named, ...]:
    """The effects that `texts` name, each one once.

    Raises
    ------
    BadInput : see `parse`; one of them stands there twice.
    """
    found: dict[str, Named] = {}
    for text in texts:
        effect = parse(text, words)
        if effect.id in found:
            raise BadInput("--effect", effect.id, "is given twice", "Keep one of them, with the whole size")
        found[effect.id] = effect
    return tuple(found.values())


def _values(
    name: str, text: str, family: effect_types.Family, sizes: tuple[effect_types.SizeSpec, ...], source: str
) -> dict[str, float]:
    by_key = {size.key: size for size in sizes}
    values: dict[str, float] = {}
    for part in text.split(",") if text else ():
        key, colon, number = (piece.strip() for piece in part.rpartition(":"))
        if key not in by_key or bool(colon) != bool(key):
            keys = ", ".join(f"{key}:number" if key else "a number" for key in by_key)
            right = f"its value is {keys}" if by_key else "it is there or not and has no value"
            raise _refused(source, name, f"{right}, found {part.strip()!r}", family)
        if key in values:
            raise _refused(source, name, f"{key or 'its value'} is given twice", family)
        size = by_key[key]
        try:
            value = float(number)
        except ValueError:
            raise _refused(source, name, f"a number in SI units is expected, found {number!r}", family) from None
        what = f"{size.key} [{size.unit}]" if size.key else f"its size [{size.unit}]"
        if not isfinite(value) or (size.whole and value != round(value)) or not size.low <= value <= size.high:
            limits = f"{size.low:g} or {size.high:g}" if size.whole else f"between {size.low:g} and {size.high:g}"
            problem = f"{what} must be {limits}, found {number}"
            raise BadInput(source, name, problem, f"Check its unit; for example {family.example}")
        values[key] = value
    missing = [size for size in sizes if size.key not in values and size.default is None]
    if missing:
        raise _refused(source, name, f"its {missing[0].key or 'value'} [{missing[0].unit}] is missing", family)
    return {size.key: values.get(size.key, size.default or 0.0) for size in sizes}


def _as_factor(text: str, channel: str, words: effect_types.Vocabulary, name: str, source: str) -> str:
    """`text`, and where it is a unit of what `channel` measures, the factor by which numbers in it differ from SI."""
    from identification.campaign import UNITS

    measured = ("force", "moment") if channel in (words.forces or ()) else ("acceleration",)
    quantities = measured if words.forces is not None else tuple(UNITS)
    sizes = {unit: size for quantity in quantities for unit, size in UNITS[quantity].items()}
    if text in sizes:
        return repr(1 / sizes[text])
    if text[:1].isalpha() and not text.lower().startswith(("nan", "inf")):
        problem = f"neither a factor nor a unit of {channel}, found {text!r}"
        raise BadInput(source, name, problem, f"{nearest(text, sizes)}Known are {', '.join(sizes)}")
    return text


def _refused(source: str, name: str, problem: str, family: effect_types.Family) -> BadInput:
    return BadInput(source, name, problem, f"Write for example {family.example}")


# Where an effect acts: a structural one wherever its part or its place exists, and nowhere else.
#
# Virtual tests and predictions ask the same rule, so that what a model leaves out is what nobody planted.


OF_PARTS = (effect_types.PART, "part with a layer")
LOCAL = (*OF_PARTS, effect_types.PLACE, effect_types.SUPPORT, effect_types.BETWEEN)
"""Kinds of target that a structure has or has not."""

OF_TESTS = ("transducer-mass", "exponential-window", "leakage", "wrong-direction", "wrong-place", "wrong-reference")
"""Families of tests of a structure by itself, which have no meaning for one on a base that moves."""


@dataclass(frozen=True, kw_only=True)
class There:
    """What one set-up has.

    Attributes
    ----------
    article : the structure that is tested; empty for an FMD alone
    parts : of it, supports and joints among them; none of a rigid one
    bodies : further parts, which have a mass and do not give
    places : by name, on it
    channels : that were recorded; None where all that an effect can name are
    supports, joints : those parts that are springs to the ground, and between two others
    base : whether it stands on a base whose motion is measured
    rigid : whether it can move as a rigid body
    weighed : whether the stiffness that its weight gives it is known
    drives : points at which it was struck or shaken
    """

    article: str = ""
    parts: tuple[str, ...] = ()
    bodies: tuple[str, ...] = ()
    places: tuple[str, ...] = ()
    channels: tuple[str, ...] | None = None
    supports: tuple[str, ...] = ()
    joints: tuple[str, ...] = ()
    base: bool = True
    rigid: bool = True
    weighed: bool = False
    drives: tuple[str, ...] = ()


def there(article: str, matrices: Matrices, channels: tuple[str, ...] | None = None) -> There:
    """What the structure with these `matrices` has."""
    several = [effect_types.EVERY] if len(matrices.joints) > 1 else []
    if several and any(one.startswith(effect_types.TOGETHER) for one in matrices.joints):
        several.append(effect_types.TOGETHER + effect_types.EVERY)
    return There(
        article=article,
        parts=tuple(matrices.parts),
        bodies=matrices.bodies,
        places=tuple(matrices.places),
        channels=channels,
        supports=matrices.supports,
        joints=(*matrices.joints, *several),
        base=matrices.base > 0,
        rigid=bool(np.any(matrices.rigid)),
        weighed=bool(matrices.geometric.size),
    )


def words_of(found: Iterable[There], words: effect_types.Vocabulary) -> effect_types.Vocabulary:
    """`words` with the targets that the structures `found` have wherever any name would do; what has none gets none."""
    stands, made = tuple(found), {}
    for kind in ("places", "parts", "supports", "joints", "drives"):
        if getattr(words, kind) is None:
            also = [name for one in stands for name in one.bodies] if kind == "parts" else []
            made[kind] = tuple(dict.fromkeys([*(name for one in stands for name in getattr(one, kind)), *also]))
    return replace(words, **made)


def acts(named: Named, there: There) -> bool:
    """Whether the effect `named` has something to act on; one whose place may be left out, and is, acts on all."""
    family = FAMILIES[named.family]
    if is_local(named):
        return named.target in known(named, there) if named.targets else bool(known(named, there))
    if family.stage == effect_types.BODY_STAGE and not there.base:
        return False
    if not {"rigid-inertia": there.rigid, "gravity-stiffness": there.weighed}.get(named.family, True):
        return False
    pairs = zip(family.targets, named.targets, strict=False)
    asked = [target for kind, target in pairs if kind in (effect_types.CHANNEL, effect_types.FORCE, effect_types.ACCELEROMETER)]
    is_recorded = there.channels is None or all(target in there.channels for target in asked)
    if (family.targets[:1] == (effect_types.DRIVE,) and named.target not in there.drives) or (
        family.name in OF_TESTS and there.base
    ):
        return False
    return is_recorded and (not on_article(named) or bool(there.article))


def known(named: Named, there: There) -> tuple[str, ...]:
    """What `named` could act on, of a family that acts on something of the structure."""
    kind = FAMILIES[named.family].targets[0]
    by_kind = {effect_types.PLACE: there.places, effect_types.SUPPORT: there.supports, effect_types.BETWEEN: there.joints}
    return by_kind.get(kind, (*there.parts, *there.bodies) if named.family == "mass" else there.parts)


def is_local(named: Named) -> bool:
    """Whether it acts on a part, a place, a support or a joint between parts."""
    return FAMILIES[named.family].targets[:1] in {(kind,) for kind in LOCAL}


def of_parts(named: Named) -> bool:
    """Whether it acts on a part of the structure."""
    return FAMILIES[named.family].targets[:1] in {(kind,) for kind in OF_PARTS}


def on_article(named: Named) -> bool:
    """Whether it needs something that stands on the cover plate."""
    return (FAMILIES[named.family].side == effect_types.STRUCTURE and named.family != "gravity") or named.family == "friction"
