"""Where effects are found: the files of `validation/effects/families`, entry points ``massline.effects``, folders of a user.

A file is a family when it holds a `FAMILY`. The catalogue of a process only grows: `load` adds what a user brings.
"""

import re
import sys
import tokenize
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import redirect_stdout
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import cache, wraps
from hashlib import sha256
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from inspect import getsourcefile, ismodule
from linecache import getline
from math import isfinite, isnan
from pathlib import Path
from traceback import extract_tb
from types import MappingProxyType, ModuleType
from typing import Any

import numpy as np

from geometry.cache import content
from geometry.errors import BadInput
from geometry.toml_file import nearest
from validation.effects import effect as effect_types
from validation.effects.stages import ChannelResponse, JointSprings, Matrices, MountedDynamicMass, NoiseModel, PendulumSwing

# A user's own effects: a folder of small files, each with a `FAMILY`, read without a trace in the folder.
#
# What a user's code does wrong is said in words, with the line of the user's file that did it - when the file is read and
# whenever its equation is asked.


def own_family(path: Path) -> effect_types.Family:
    """The `FAMILY` of the file at `path`, whose code runs once; its equation and plant answer in words when they fail.

    Raises
    ------
    BadInput : it is no Python, it fails, or it holds no `Family` of that name.
    """
    # The module at `path`. Compiled here, since an import would leave its cache in the folder.
    file = str(path)
    name = f"massline_effect_{sha256(file.encode()).hexdigest()[:12]}"
    module = ModuleType(name)
    module.__file__ = file
    sys.modules[name] = module
    try:
        with tokenize.open(file) as source:
            code = compile(source.read(), file, "exec", dont_inherit=True)
        with redirect_stdout(sys.stderr):  # standard output belongs to the command
            exec(code, module.__dict__)
    except OSError:
        del sys.modules[name]
        raise
    except (Exception, SystemExit) as error:
        del sys.modules[name]
        raise in_words(error, file, "") from None
    if not hasattr(module, "FAMILY"):
        raise BadInput(source=str(path), field="FAMILY", problem="is missing", remedy="Write FAMILY = Family(name=..., ...)")
    return of(module.FAMILY, str(path))


def of(value: object, file: str) -> effect_types.Family:
    """`value`, which must be a family, with the functions of `file` guarded.

    Raises
    ------
    BadInput : it is something else.
    """
    if not isinstance(value, effect_types.Family):
        problem = f"must be a validation.effects.effect.Family, found {type(value).__name__}"
        raise BadInput(source=file, field="FAMILY", problem=problem, remedy="Write FAMILY = Family(name=..., ...)")
    change = value.change if value.change is None else guarded(value.change, file, "change")
    plant = value.plant if value.plant is None else _guarded_plant(value.plant, file)
    return replace(value, change=change, plant=plant)


def guarded(function: Callable[..., Any], file: str, what: str) -> Callable[..., Any]:
    """`function` of the user's `file`, whose errors become words; `what` is the field that holds it."""

    @wraps(function)
    def call(*arguments: Any) -> Any:
        try:
            return function(*arguments)
        except BadInput:
            raise
        except Exception as error:
            raise in_words(error, file, what) from None

    return call


def in_words(error: BaseException, file: str, what: str) -> BadInput:
    """`error` that code of `file` raised, with the line where it happened."""
    said = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
    if isinstance(error, SyntaxError) and error.filename == file:
        line = error.lineno or 0
    else:
        line = next((one.lineno or 0 for one in reversed(extract_tb(error.__traceback__)) if one.filename == file), 0)
    number = f"line {line}, `{getline(file, line).strip()}`, " if line else ""
    return BadInput(source=file, field=what, problem=f"{number}raised {said}", remedy="Correct the file")


def _guarded_plant(plant: Callable[[Any], Any], file: str) -> Callable[[Any], Any]:
    planted = guarded(plant, file, "plant")

    def call(named: Any) -> Any:
        effect = planted(named)
        if not is_dataclass(effect) or isinstance(effect, type):
            problem = f"must return an Effect of validation.virtual_test.plan, found {type(effect).__name__}"
            raise BadInput(source=file, field="plant", problem=problem, remedy="Write plant=at(...) of validation.effects.plants")
        made = {one.name: getattr(effect, one.name) for one in fields(effect)}
        return replace(effect, **{name: guarded(one, file, "plant") for name, one in made.items() if callable(one)})

    return call


GROUP = "massline.effects"
"""Of the entry points by which an installed package brings families: modules with a `FAMILY`, or families themselves."""

ORDER = [
    "point-mass",
    "rigid-inertia",
    "modulus",
    "mass",
    "thickness",
    "support-stiffness",
    "connection-compliance",
    "gravity-stiffness",
    "joint-compliance",
    "structural-damping",
    "layer-damping",
    "appendage",
    "absorber",
    "slosh",
    "cable",
    "orientation",
    "mounting-offset",
    "gravity",
    "force-gain",
    "load-path-shunt",
    "force-delay",
    "board-delay",
    "force-highpass",
    "force-crosstalk",
    "force-plane-offset",
    "force-misalignment",
    "force-position",
    "fmd-compliance",
    "cell-stiffness",
    "accelerometer-gain",
    "accelerometer-delay",
    "accelerometer-position",
    "accelerometer-misalignment",
    "accelerometer-tilt",
    "cover-plate-flexibility",
    "transducer-mass",
    "exponential-window",
    "leakage",
    "polarity",
    "channel-swap",
    "unit",
    "wrong-direction",
    "wrong-place",
    "wrong-reference",
    "friction",
    "gap",
    "saturation",
    "sweep-bias",
    "noise",
    "mains",
    "pendulum-amplitude",
    "pendulum-damping",
    "rope-mass",
    "rope-elasticity",
    "air-inertia",
    "off-centre-suspension",
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
    BadInput : no such folder, a file without a family, or one that is not whole (see `require_whole`, `require_usable`);
        then none of the folder's is added.
    """
    folder = Path(directory)
    if not folder.is_dir():
        problem = "it is a file" if folder.exists() else "there is no such folder"
        raise BadInput(source=str(folder), field="--effects-from", problem=problem, remedy="Name a folder of effects")
    paths = sorted(path.resolve() for path in folder.glob("*.py") if not path.name.startswith("_"))
    if not paths:
        problem = "it holds no file of an effect, *.py"
        remedy = "Write one: docs/effects.md shows how, examples/effects holds two"
        raise BadInput(source=str(folder), field="--effects-from", problem=problem, remedy=remedy)
    found = [(path, own_family(path)) for path in paths if path not in _files]
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
    require_whole(family, FAMILIES, SOURCES, source)
    _found[family.name], _sources[family.name] = family, source
    try:
        require_usable(family, source)
    except BaseException:
        _forget(family.name)
        raise


def _forget(name: str) -> None:
    del _found[name], _sources[name]


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
            raise in_words(error, source, GROUP) from None
        file = (getsourcefile(value) if ismodule(value) else None) or source
        _add(of(getattr(value, "FAMILY", value), file), source)


for _name in ORDER:
    _found[_name] = import_module(f"validation.effects.families.{_name.replace('-', '_')}").FAMILY
add_installed(iter(entry_points(group=GROUP)))


# Whether the fields of a family that somebody brings hold what they must: words, numbers, tuples, functions.


Rule = tuple[Callable[[Any], bool], str]
"""What a field must be, and how that is said."""


def _number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and not isnan(value)


def _sizes(value: Any) -> bool:
    return isinstance(value, tuple) and all(isinstance(one, effect_types.SizeSpec) for one in value)


TEXT: Rule = (lambda value: isinstance(value, str), "text")
FLAG: Rule = (lambda value: isinstance(value, bool), "True or False")
NUMBER: Rule = (_number, "a number")
FUNCTION: Rule = (lambda value: value is None or callable(value), "a function")
TEXTS: Rule = (
    lambda value: isinstance(value, tuple) and all(isinstance(one, str) and one for one in value),
    'a tuple of texts, ("one",) where there is one',
)

OF_FAMILY: Mapping[str, Rule] = MappingProxyType(
    {
        **dict.fromkeys(("name", "side", "what", "example", "stage", "equation", "confirmed_by", "reference", "sentence"), TEXT),
        **dict.fromkeys(("targets", "mistaken_for"), TEXTS),
        "optional": FLAG,
        "sizes": (_sizes, "a tuple of SizeSpec, (SizeSpec(...),) where there is one"),
        "varying": (
            lambda value: isinstance(value, Mapping) and all(isinstance(one, str) and _sizes(value[one]) for one in value),
            "a mapping from a target to a tuple of SizeSpec",
        ),
        "tolerance": NUMBER,
        **dict.fromkeys(("change", "plant"), FUNCTION),
    }
)

OF_SIZE: Mapping[str, Rule] = MappingProxyType(
    {
        **dict.fromkeys(("unit", "key"), TEXT),
        **dict.fromkeys(("low", "high", "null", "plausible"), NUMBER),
        **dict.fromkeys(("default", "stated"), (lambda value: value is None or _number(value), "a number, or None")),
        **dict.fromkeys(("whole", "logarithmic"), FLAG),
    }
)


def _require(noun: Any, rules: Mapping[str, Rule], where: str, source: str) -> None:
    for field, (holds, words) in rules.items():
        value = getattr(noun, field)
        if not holds(value):
            raise BadInput(
                source=source, field=f"{where}{field}", problem=f"must be {words}, found {value!r}", remedy="Correct it"
            )


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
        raise BadInput(source=source, field=family, problem=f"no effect is called {family!r}", remedy=remedy)
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
                raise BadInput(source=source, field=name, problem=f"{target!r} is no x,y,z in metres", remedy=remedy)
        elif legal is not None and target not in legal:
            remedy = f"{nearest(target, legal)}Known are {', '.join(legal)}" if legal else "Leave it out"
            raise BadInput(source=source, field=name, problem=f"no {kind} is called {target!r}", remedy=remedy)
    if len(set(targets)) < len(targets) and len(set(kinds)) < len(kinds):
        raise _refused(source, name, f"{targets[0]} is named twice", known)
    sizes = known.sizes_at(tuple(targets))
    if equals and not value:
        raise _refused(source, name, "its value is missing", known)
    if family == MISTAKEN_UNIT and value:
        value = _as_factor(value, targets[0], words, name, source)
    values = _values(name, value, known, sizes, source)
    return Named(family=family, targets=tuple(targets), values=values)


def parse_all(
    texts: Sequence[str], words: effect_types.Vocabulary | None = None, *, source: str = "--effect"
) -> tuple[Named, ...]:
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
            raise BadInput(source=source, field=name, problem=problem, remedy=f"Check its unit; for example {family.example}")
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
        raise BadInput(source=source, field=name, problem=problem, remedy=f"{nearest(text, sizes)}Known are {', '.join(sizes)}")
    return text


def _refused(source: str, name: str, problem: str, family: effect_types.Family) -> BadInput:
    return BadInput(source=source, field=name, problem=problem, remedy=f"Write for example {family.example}")


# Stages to try an equation on, and the sizes at which it must change nothing.
#
# The stages are those of no test: small, of figures that were drawn once, with every name that the catalogue knows.


BASE, OWN, LINES = 6, 3, 5
OF_ONE_ARTICLE = ("upper-short-silicone", "bolt")
"""Parts that examples name and no list has."""

ROUNDING = 1e-12
"""Relative, of the largest entry: what an equation may change by rounding alone."""


def unchanged(before: Any, after: Any) -> bool:
    """Whether two stages are alike to rounding; coordinates that were added may stand there, if nothing drives them."""
    return all(_alike(getattr(before, one.name), getattr(after, one.name)) for one in fields(before))


def _alike(before: Any, after: Any) -> bool:
    if isinstance(before, Mapping):
        return before.keys() == after.keys() and all(_alike(before[key], after[key]) for key in before)
    if isinstance(before, tuple):
        return len(before) == len(after) and all(_alike(one, other) for one, other in zip(before, after, strict=True))
    if is_dataclass(before):
        return unchanged(before, after)
    if not isinstance(before, np.ndarray):
        return bool(before == after or np.isclose(before, after, rtol=ROUNDING, atol=0))
    there = np.asarray(after)
    if there.ndim != before.ndim or any(n < m for n, m in zip(there.shape, before.shape, strict=True)):
        return False
    padded = np.zeros(there.shape, dtype=np.result_type(there, before))
    inside = tuple(slice(n) for n in before.shape)
    padded[inside] = before
    grown = np.array(there)
    if there.shape != before.shape and there.ndim == 2:
        own = [k for k in range(max(there.shape)) if k >= max(before.shape) and k < min(there.shape)]
        grown[own, own] = 0.0  # what an added coordinate is by itself
    return bool(np.allclose(grown, padded, rtol=0, atol=ROUNDING * max(float(np.max(np.abs(padded), initial=0.0)), 1e-300)))


def _drawn(*shape: int) -> Any:
    return _frozen(np.random.default_rng(sum(shape)).standard_normal(shape))


def _complex(*shape: int) -> Any:
    return _frozen(_drawn(*shape) + 1j * _drawn(*shape, 1)[..., 0])


def _frozen(values: Any) -> Any:
    made = np.array(values)
    made.setflags(write=False)
    return made


def _positive(n: int, scale: float) -> Any:
    A = _drawn(n, n)
    return _frozen(scale * (A @ A.T + n * np.eye(n)))


@cache
def trials() -> Mapping[str, Any]:
    """By kind, a stage to try an equation on; its arrays cannot be written to."""
    n, channels, frequency = (
        BASE + OWN,
        (*effect_types.TABLE, *effect_types.COVER, *effect_types.FMD),
        _frozen(np.linspace(10.0, 11.0, LINES)),
    )
    held = np.zeros((n, n))
    held[BASE:, BASE:] = _positive(OWN, 1e5)
    return {
        effect_types.STRUCTURE_STAGE: Matrices(
            base=BASE,
            mass=_positive(n, 2.0),
            stiffness=held,
            viscous=1e-3 * held,
            structural=1e-2 * held,
            places={name: _frozen(_drawn(3, n) + k) for k, name in enumerate(effect_types.built_in_places())},
            parts={name: _frozen(held / len(effect_types.PARTS)) for name in (*effect_types.PARTS, *OF_ONE_ARTICLE)},
            cog=np.array([0.01, -0.02, 0.3]),
            joints={"bolt": JointSprings(loads=1e4 * _drawn(6, n), stiffness=np.full(6, 1e6), trace=float(np.trace(held)))},
            geometric=_frozen(-1e-2 * held),
        ),
        effect_types.BODY_STAGE: MountedDynamicMass(
            frequency=frequency,
            matrix=_complex(LINES, 6, 6),
            seat=_frozen([0.01, 0.02, 0.05]),
            cog=_frozen([0.01, -0.02, 0.3]),
            amplitude=_frozen([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
            sweep_rate=2 / 60,
            block=14.5,
        ),
        effect_types.CHANNEL_STAGE: ChannelResponse(
            frequency=frequency,
            channels=channels,
            rows=_complex(LINES, len(channels), 6),
            amplitude=_frozen(1.0 + np.abs(_drawn(LINES, len(channels)))),
            peak=_frozen(np.full(len(channels), 5.0)),
        ),
        effect_types.NOISE_STAGE: NoiseModel(
            frequency=frequency,
            channels=channels,
            quantities=tuple("force" if name in effect_types.FMD else "acceleration" for name in channels),
            deviation=_frozen(np.full((LINES, len(channels)), 0.1)),
            per_rms=_frozen(np.full(len(channels), 0.5)),
            hum=_frozen(np.full((LINES, len(channels)), 0.01)),
        ),
        effect_types.PERIOD_STAGE: PendulumSwing(
            period=2.1, mass=47.0, inertia=2.3, ropes=3, length=2.0, radii=_frozen([0.3, 0.3, 0.3])
        ),
    }


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


# Whether a family that somebody brings is whole: all that every command needs, and an equation that keeps its promises.


WORDS = {
    "what": "say in a few words what it is",
    "sentence": "say what it means to somebody who never heard of it; {target} stands for its target",
    "equation": "write it in one line, as in a paper",
    "confirmed_by": "say what would confirm it in the laboratory",
    "reference": "say where the equation comes from",
}
"""What every family must say, and how."""

KINDS = (
    *effect_types.FIXED,
    effect_types.CHANNEL,
    effect_types.FORCE,
    effect_types.ACCELEROMETER,
    effect_types.PLACE,
    effect_types.PART,
    effect_types.SUPPORT,
    effect_types.BETWEEN,
    effect_types.CABLE,
    effect_types.DRIVE,
)
NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")


def require_whole(
    family: effect_types.Family, known: Mapping[str, effect_types.Family], sources: Mapping[str, str], source: str
) -> None:
    """Refuse a family that lacks something, or has a name that is taken.

    Raises
    ------
    BadInput : its file (`source`), the field, what was found, and what to write.
    """
    _require(family, OF_FAMILY, "", source)
    for sizes in (family.sizes, *family.varying.values()):
        for size in sizes:
            _require(size, OF_SIZE, "sizes.", source)
        if len({size.key for size in sizes}) < len(sizes):
            raise _unsound(source, "sizes", "two of them have the same key", 'Give each its own, Size(key="m", ...)')
    name = family.name
    if not NAME.fullmatch(name):
        raise _unsound(source, "name", f"must be lower-case words joined by -, found {name!r}", "Write for example rope-slack")
    if name in known:
        where = sources.get(name, "massline itself")
        raise _unsound(source, "name", f"an effect called {name!r} is there already, from {where}", "Choose another name")
    for field, remedy in WORDS.items():
        if not getattr(family, field).strip():
            raise _unsound(source, field, "is missing", f"{field}=...: {remedy}")
    _require_word(family.side, effect_types.SIDES, "side", source)
    _require_word(family.stage, effect_types.STAGES, "stage", source)
    for kind in family.targets:
        _require_word(kind, KINDS, "targets", source)
    for size in dict.fromkeys((*family.sizes, *(one for sizes in family.varying.values() for one in sizes))):
        what = f"sizes ({size.key})" if size.key else "sizes"
        if not size.unit.strip():
            raise _unsound(source, what, "its unit is missing", 'Give it in SI, "1" for a ratio')
        if not (isfinite(size.low) and isfinite(size.high) and size.low < size.high):
            raise _unsound(source, what, f"low must lie below high, found {size.low:g} and {size.high:g}", "Correct them")
        if not (isfinite(size.plausible) and size.plausible >= 0):
            raise _unsound(source, what, f"plausible must be 0 or more, found {size.plausible:g}", "It is a standard deviation")
    if family.stage == effect_types.OPENED:
        remedy = f"Name what it changes, one of {', '.join(effect_types.STAGES[:-1])}, and give `change`"
        raise _unsound(source, "stage", "is opened, and no parameter of a laboratory has its name", remedy)
    if family.change is None:
        raise _unsound(source, "change", "is missing", "Write change(stage, targets, values) and return the changed stage")


def _require_word(word: str, words: tuple[str, ...], field: str, source: str) -> None:
    if word not in words:
        remedy = f"{nearest(word, words)}Known are {', '.join(words)}"
        raise _unsound(source, field, f"must be one of those known, found {word!r}", remedy)


def _unsound(source: str, field: str, problem: str, remedy: str) -> BadInput:
    return BadInput(source=source, field=field, problem=problem, remedy=remedy)


# An equation tried before it is taken: what kind of stage it returns, of what shape, and whether it keeps its promises.
#
# At the null size it changes nothing. On channels it is linear in the rows; what it adds to matrices does not depend on them.
# Derivatives by all other parameters pass through it on the strength of that.


ADDED_TO = ("mass", "stiffness", "viscous", "structural")
SAME = 1e-9
"""Relative, of the largest entry: rounding of a product."""


@dataclass(frozen=True, eq=False, kw_only=True)
class FamilyTrial:
    """The equation of a family at its example.

    Attributes
    ----------
    change : the equation
    example : targets and sizes
    source : the file, for messages
    """

    change: effect_types.Change
    example: Named
    source: str

    def on(self, stage: Any, values: Mapping[str, float] | None = None) -> Any:
        """What the equation makes of `stage`, at the example's sizes or at others.

        Raises
        ------
        BadInput : it is no stage of that kind, or does not fit the one that came in.
        """
        found = self.change(stage, self.example.targets, self.example.values if values is None else values)
        if type(found) is not type(stage):
            problem = f"must return the changed {type(stage).__name__}, found {type(found).__name__}"
            raise self.refused(problem, "Return dataclasses.replace(stage, ...)")
        pairs = [(one.name, getattr(stage, one.name), getattr(found, one.name)) for one in fields(stage)]
        inner = [
            (f"{name}[{key!r}]", one[key], now.get(key)) for name, one, now in pairs if isinstance(one, Mapping) for key in one
        ]
        for name, was, now in (*pairs, *inner):
            if not isinstance(was, np.ndarray) or was.dtype.kind not in "fc":
                continue
            # `was.shape` with the coordinates that matrices have gained; nothing else may grow
            if not isinstance(stage, Matrices):
                needed = was.shape
            else:
                k = len(stage.mass)
                needed = tuple(len(found.mass) if n == k else n for n in was.shape)
            if np.shape(now) != needed:
                problem = f"leaves `{name}` of shape {np.shape(now)}, where {needed} is needed"
                raise self.refused(problem, "Return arrays of the shape that came in")
            if not np.all(np.isfinite(now)):
                raise self.refused(f"leaves values in `{name}` that are no numbers", "Correct the equation")
        return found

    def refused(self, problem: str, remedy: str) -> BadInput:
        """What is wrong with the equation."""
        return BadInput(source=self.source, field="change", problem=problem, remedy=remedy)


def require_usable(family: effect_types.Family, source: str) -> None:
    """Refuse a family of the catalogue whose example cannot be typed, or whose equation breaks a promise.

    Raises
    ------
    BadInput : as in `require_whole`; as `FamilyTrial.on`, or which promise is broken.
    """
    try:
        example = parse(family.example.split(", or ")[0])
    except BadInput as error:
        raise _unsound(source, "example", f"{family.example!r} cannot be typed: {error.problem}", error.remedy) from None
    if example.family != family.name:
        raise _unsound(source, "example", f"is one of {example.family}", f"Write one of {family.name}")
    if family.change is None:
        return
    trial, stage = FamilyTrial(change=family.change, example=example, source=source), family.stage
    if stage not in effect_types.STAGES[:-1]:
        raise trial.refused(f"changes {stage!r}, which is no stage", f"Known are {', '.join(effect_types.STAGES[:-1])}")
    before = trials()[stage]
    after = trial.on(before)
    if sizes := example.sizes:  # no effect: the first at its `null`, all others as in the example
        null = {**example.values, sizes[0].key: sizes[0].null}
        if not unchanged(before, trial.on(before, null)):
            at = ", ".join(f"{key or 'size'} {value:g}" for key, value in null.items())
            raise trial.refused(f"changes something at {at}, where there is no effect", "Correct it, or `null`")
    if stage == effect_types.CHANNEL_STAGE:
        turned = 2.0 * np.exp(0.7j)
        twice = trial.on(replace(before, rows=turned * before.rows))
        if not _behave_alike(twice.rows, turned * after.rows):
            problem = "is not linear in `rows`: derivatives could not pass through it"
            raise trial.refused(problem, "Multiply rows, or add one to another; take levels from `amplitude`")
    if stage == effect_types.STRUCTURE_STAGE:
        other = trial.on(replace(before, **{name: 1.5 * getattr(before, name) for name in ADDED_TO}))
        n = len(before.mass)
        for name in ADDED_TO:
            was, shift = getattr(before, name), getattr(other, name) - getattr(after, name)
            if not _behave_alike(shift[:n, :n], 0.5 * was):
                problem = f"adds to `{name}` what depends on the matrices that are there: derivatives could not pass it"
                raise trial.refused(problem, "Build what is added of `places`, `parts` and `cog`")


def _behave_alike(found: Any, expected: Any) -> bool:
    return bool(np.allclose(found, expected, rtol=0, atol=SAME * float(np.max(np.abs(expected)))))
