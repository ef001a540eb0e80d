"""Families that somebody brings: read from a file of theirs, asked whether they are whole, and their equation tried.

What a user's code does wrong is said in words, with the line of the user's file that did it - when the file is read and
whenever its equation is asked.
"""

import re
import sys
import tokenize
from collections.abc import Callable, Mapping
from contextlib import redirect_stdout
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import cache, wraps
from hashlib import sha256
from linecache import getline
from math import isfinite, isnan
from pathlib import Path
from traceback import extract_tb
from types import MappingProxyType, ModuleType
from typing import Any

import numpy as np

from geometry.errors import BadInput
from geometry.toml_file import is_number, nearest
from validation.effects import effect as effect_types
from validation.effects.stages import ChannelResponse, JointSprings, Matrices, MountedDynamicMass, NoiseModel, PendulumSwing


def read(path: Path) -> effect_types.Family:
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
        raise BadInput(str(path), "FAMILY", "is missing", "Write FAMILY = Family(name=..., ...)")
    return of(module.FAMILY, str(path))


def of(value: object, file: str) -> effect_types.Family:
    """`value`, which must be a family, with the functions of `file` guarded.

    Raises
    ------
    BadInput : it is something else.
    """
    if not isinstance(value, effect_types.Family):
        problem = f"must be a validation.effects.effect.Family, found {type(value).__name__}"
        raise BadInput(file, "FAMILY", problem, "Write FAMILY = Family(name=..., ...)")
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
    return BadInput(file, what, f"{number}raised {said}", "Correct the file")


def _guarded_plant(plant: Callable[[Any], Any], file: str) -> Callable[[Any], Any]:
    planted = guarded(plant, file, "plant")

    def call(named: Any) -> Any:
        effect = planted(named)
        if not is_dataclass(effect) or isinstance(effect, type):
            problem = f"must return an Effect of validation.virtual_test.plan, found {type(effect).__name__}"
            raise BadInput(file, "plant", problem, "Write plant=at(...) of validation.effects.plants")
        made = {one.name: getattr(effect, one.name) for one in fields(effect)}
        return replace(effect, **{name: guarded(one, file, "plant") for name, one in made.items() if callable(one)})

    return call


# Whether the fields of a family that somebody brings hold what they must: words, numbers, tuples, functions.


Rule = tuple[Callable[[Any], bool], str]
"""What a field must be, and how that is said."""


def _number(value: Any) -> bool:
    return is_number(value) and not isnan(value)


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
            raise BadInput(source, f"{where}{field}", f"must be {words}, found {value!r}", "Correct it")


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
    n = BASE + OWN
    channels = (*effect_types.TABLE, *effect_types.COVER, *effect_types.FMD)
    frequency = _frozen(np.linspace(10.0, 11.0, LINES))
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
            raise unsound(source, "sizes", "two of them have the same key", 'Give each its own, Size(key="m", ...)')
    name = family.name
    if not NAME.fullmatch(name):
        raise unsound(source, "name", f"must be lower-case words joined by -, found {name!r}", "Write for example rope-slack")
    if name in known:
        where = sources.get(name, "massline itself")
        raise unsound(source, "name", f"an effect called {name!r} is there already, from {where}", "Choose another name")
    for field, remedy in WORDS.items():
        if not getattr(family, field).strip():
            raise unsound(source, field, "is missing", f"{field}=...: {remedy}")
    _require_word(family.side, effect_types.SIDES, "side", source)
    _require_word(family.stage, effect_types.STAGES, "stage", source)
    for kind in family.targets:
        _require_word(kind, KINDS, "targets", source)
    for size in dict.fromkeys((*family.sizes, *(one for sizes in family.varying.values() for one in sizes))):
        what = f"sizes ({size.key})" if size.key else "sizes"
        if not size.unit.strip():
            raise unsound(source, what, "its unit is missing", 'Give it in SI, "1" for a ratio')
        if not (isfinite(size.low) and isfinite(size.high) and size.low < size.high):
            raise unsound(source, what, f"low must lie below high, found {size.low:g} and {size.high:g}", "Correct them")
        if not (isfinite(size.plausible) and size.plausible >= 0):
            raise unsound(source, what, f"plausible must be 0 or more, found {size.plausible:g}", "It is a standard deviation")
    if family.stage == effect_types.OPENED:
        remedy = f"Name what it changes, one of {', '.join(effect_types.STAGES[:-1])}, and give `change`"
        raise unsound(source, "stage", "is opened, and no parameter of a laboratory has its name", remedy)
    if family.change is None:
        raise unsound(source, "change", "is missing", "Write change(stage, targets, values) and return the changed stage")


def _require_word(word: str, words: tuple[str, ...], field: str, source: str) -> None:
    if word not in words:
        remedy = f"{nearest(word, words)}Known are {', '.join(words)}"
        raise unsound(source, field, f"must be one of those known, found {word!r}", remedy)


def unsound(source: str, field: str, problem: str, remedy: str) -> BadInput:
    return BadInput(source, field, problem, remedy)


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
    targets, values : of the example
    source : the file, for messages
    """

    change: effect_types.Change
    targets: tuple[str, ...]
    values: Mapping[str, float]
    source: str

    def on(self, stage: Any, values: Mapping[str, float] | None = None) -> Any:
        """What the equation makes of `stage`, at the example's sizes or at others.

        Raises
        ------
        BadInput : it is no stage of that kind, or does not fit the one that came in.
        """
        found = self.change(stage, self.targets, self.values if values is None else values)
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
        return BadInput(self.source, "change", problem, remedy)


def require_usable(family: effect_types.Family, targets: tuple[str, ...], values: Mapping[str, float], source: str) -> None:
    """Refuse a family whose equation, at the `targets` and `values` of its example, breaks a promise.

    Raises
    ------
    BadInput : as `FamilyTrial.on`, or which promise is broken.
    """
    if family.change is None:
        return
    trial, stage = FamilyTrial(change=family.change, targets=targets, values=values, source=source), family.stage
    if stage not in effect_types.STAGES[:-1]:
        raise trial.refused(f"changes {stage!r}, which is no stage", f"Known are {', '.join(effect_types.STAGES[:-1])}")
    before = trials()[stage]
    after = trial.on(before)
    if sizes := family.sizes_at(targets):  # no effect: the first at its `null`, all others as in the example
        null = {**values, sizes[0].key: sizes[0].null}
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
